//! Slider-crank with a given speed of the crank, in four declarations, against d'Alembert's principle by
//! hand.

use linkwork::prelude::*;
use support::compare::assert_close;

const R: f64 = 0.04;
const L: f64 = 0.13;
const ROD: f64 = 0.8;
const PISTON: f64 = 0.5;
const CRANK: f64 = 1.2;
const G: f64 = 9.81;

macro_rules! slider_crank {
    ($name:ident, ($($words:tt)*), {$($fields:tt)*}) => {
        #[mechanism(gravity = -9.81 * y $($words)*)]
        struct $name {
            #[body(mass = 1.2, com = 0.02 * x, inertia = rod(1.2, 0.04, x))]
            crank: Body,
            #[body(mass = 0.8, com = 0.065 * x, inertia = rod(0.8, 0.13, x))]
            rod: Body,
            #[body(mass = 0.5)]
            piston: Body,
            #[joint(ground -> crank, about = z)]
            main: Pin,
            #[joint(crank.at(0.04 * x) -> rod, about = z)]
            big_end: Pin,
            #[joint(ground -> piston, along = x)]
            cylinder: Sleeve,
            #[joint(rod.at(0.13 * x) -> piston, about = z)]
            small_end: Pin,
            #[output(reaction_force(main))]
            bearing: Vector,
            #[output(reaction_torque(main))]
            turning: Vector,
            #[output(crank)]
            on_crank: FreeBody,
            #[output(dot(a(piston / ground / ground), x))]
            shaking: Scalar,
            $($fields)*
        }
    };
}

slider_crank!(Positioned, (, derivatives), {
    omega: f64,
    #[constraint(main = omega * t)]
    drive: Holonomic,
});
slider_crank!(Rated, (), {
    omega: f64,
    #[constraint(rate(main) = omega)]
    drive: Nonholonomic,
});
slider_crank!(Independent, (, formulation = speeds), {
    omega: f64,
    #[constraint(main = omega * t)]
    drive: Holonomic,
});
slider_crank!(Motorised, (), {});

slider_crank!(Twice, (), {
    omega: f64,
    #[constraint(main = omega * t)]
    drive: Holonomic,
    #[constraint(main = 2 * omega * t)]
    other: Holonomic,
});
slider_crank!(Whole, (, derivatives, second_derivatives, batch, prepare, sensitivities, drawing, regressor, centroidal), {
    omega: f64,
    stiffness: f64,
    #[constraint(main = omega * t)]
    drive: Holonomic,
    #[acts(on = cylinder, stiffness = stiffness)]
    coil: Spring,
    #[acts(on = cylinder)]
    gas: Force,
});

/// Declares a slider-crank whose crank is placed as a function of time. The arguments add options of its last
/// joint and further fields.
macro_rules! placed_by_time {
    ($(#[$about:meta])* $name:ident, ($($joint:tt)*), { $($more:tt)* }) => {
        $(#[$about])*
        #[mechanism(gravity = -9.81 * y)]
        struct $name {
            omega: f64,
            #[frame(ground, z(omega * t))]
            turned: Frame,
            #[body(mass = 1.2, com = 0.02 * x, inertia = rod(1.2, 0.04, x), frame = turned)]
            crank: Body,
            #[body(mass = 0.8, com = 0.065 * x, inertia = rod(0.8, 0.13, x))]
            rod: Body,
            #[body(mass = 0.5)]
            piston: Body,
            #[joint(crank.at(0.04 * x) -> rod, about = z)]
            big_end: Pin,
            #[joint(ground -> piston, along = x)]
            cylinder: Sleeve,
            #[joint(rod.at(0.13 * x) -> piston, about = z $($joint)*)]
            small_end: Pin,
            #[output(crank)]
            on_crank: FreeBody,
            $($more)*
        }
    };
}

placed_by_time!(
    /// Slider-crank with a driven crank, whose loop is closed by a constraint.
    Framed,
    (),
    {}
);
placed_by_time!(
    /// Slider-crank whose loop is solved in closed form: it has no coordinate.
    ClosedForm,
    (, branch = 1),
    {
        #[output(dot(r(piston / ground), x))]
        stroke: Scalar,
        #[output(reaction_force(small_end))]
        pin_force: Vector,
    }
);

/// Solution by hand at a constant speed of the crank. `rod` holds the rod's angle, angular velocity and
/// angular acceleration; `piston` holds the piston's position, velocity and acceleration. The other fields
/// are the torque on the crank and the force of the crank's bearing on it.
struct SolutionByHand {
    rod: [f64; 3],
    piston: [f64; 3],
    torque: f64,
    bearing: [f64; 2],
}

impl SolutionByHand {
    fn new(theta: f64, omega: f64) -> SolutionByHand {
        let (s, c) = theta.sin_cos();
        // The closure condition is r sin θ + l sin β = 0.
        let beta = (-R * s / L).asin();
        let (sb, cb) = beta.sin_cos();
        let by = -R * c / (L * cb);
        let rate = by * omega;
        let bend = (R * s * omega * omega + L * sb * rate * rate) / (L * cb);
        let piston = [
            R * c + L * cb,
            -R * s * omega - L * sb * rate,
            -R * c * omega * omega - L * (cb * rate * rate + sb * bend),
        ];
        // Acceleration of the rod's centre of mass, and derivative of its position with respect to the
        // crank's angle.
        let half = L / 2.0;
        let a = [
            -R * c * omega * omega - half * (cb * rate * rate + sb * bend),
            -R * s * omega * omega + half * (-sb * rate * rate + cb * bend),
        ];
        let d = [-R * s - half * sb * by, R * c + half * cb * by];
        let inertia = ROD * L * L / 12.0;
        let torque = ROD * (a[0] * d[0] + (a[1] + G) * d[1])
            + inertia * bend * by
            + PISTON * piston[2] * (-R * s - L * sb * by)
            + CRANK * G * R / 2.0 * c;
        // The cylinder's side force follows from the moments on the rod about the crank pin.
        let wall = {
            let moment = inertia * bend + ROD * half * (cb * (a[1] + G) - sb * a[0]);
            // Forces on the rod at the small end: −m a of the piston along x, and the side force across.
            (moment - L * sb * PISTON * piston[2]) / (L * cb)
        };
        let crank = [-R / 2.0 * c * omega * omega, -R / 2.0 * s * omega * omega];
        let bearing = [
            CRANK * crank[0] + ROD * a[0] + PISTON * piston[2],
            CRANK * (crank[1] + G) + ROD * (a[1] + G) - wall,
        ];
        SolutionByHand { rod: [beta - theta, rate - omega, bend], piston, torque, bearing }
    }
}

const OMEGA: f64 = 35.0;

/// Returns 24 instants over one revolution of the crank, s.
fn instants_of_revolution() -> impl Iterator<Item = f64> {
    (0..24).map(|k| f64::from(k) * std::f64::consts::TAU / OMEGA / 24.0)
}

macro_rules! check {
    ($m:expr, $t:expr) => {{
        let (m, t) = (&$m, $t);
        let hand = SolutionByHand::new(OMEGA * t, OMEGA);
        let guess = [OMEGA * t, hand.rod[0] + 0.2, hand.piston[0] - 0.02].into();
        let q = m.assemble(t, &guess, &[0]).unwrap();
        let v = m.complete_velocity(t, &q, &[OMEGA, 0.0, 0.0].into(), &[]).unwrap();
        let (a, lambda) = m.constrained_dynamics(t, &q, &v, &SVector::zeros());
        assert_close("q", &q.data.0[0], &[OMEGA * t, hand.rod[0], hand.piston[0]], 1e-11);
        assert_close("v", &v.data.0[0], &[OMEGA, hand.rod[1], hand.piston[1]], 1e-11);
        assert_close("a", &a.data.0[0], &[0.0, hand.rod[2], hand.piston[2]], 1e-9);
        let (tau, same) = m.constrained_inverse_dynamics(t, &q, &v, &a, &[]).unwrap();
        assert_eq!(tau, SVector::<f64, 3>::zeros());
        assert_close("multipliers", &same.data.0[0], &lambda.data.0[0], 1e-8);
        assert_close("torque of the drive", &[lambda[2]], &[hand.torque], 1e-9);
        assert_close("piston", &[-lambda[0].abs()], &[-(PISTON * hand.piston[2]).abs()], 1e-9);
        let bearing = m.bearing(t, &q, &v);
        assert_close("bearing", &bearing.data.0[0][..2], &hand.bearing, 1e-9);
        assert_close("turning", &[m.turning(t, &q, &v)[2]], &[hand.torque], 1e-9);
        assert_close("shaking", &[m.shaking(t, &q, &v, &a)], &[hand.piston[2]], 1e-9);
        // The sum of all forces and torques on the crank.
        let sum = m.on_crank(t, &q, &v);
        let crank =
            [-0.5 * R * OMEGA * OMEGA * (OMEGA * t).cos(), -0.5 * R * OMEGA * OMEGA * (OMEGA * t).sin()];
        assert_close("crank", &sum.force().data.0[0][..2], &crank.map(|a| CRANK * a), 1e-9);
        // The joint transmits the drive torque.
        let joint = sum.get("main").unwrap();
        assert_close("joint", &[joint.torque[2]], &[hand.torque], 1e-9);
    }};
}

#[test]
fn drive_torques_balance_inertia_over_a_revolution() {
    for t in instants_of_revolution() {
        check!(Positioned { omega: OMEGA }, t);
        check!(Independent { omega: OMEGA }, t);
    }
}

/// A rate that a parameter prescribes needs no time: functions have no time argument.
#[test]
fn rates_prescribed_by_parameters_need_no_time() {
    assert_eq!((Rated::NP, Rated::NS, Rated::NC), (1, 0, 3));
    let m = Rated { omega: OMEGA };
    for t in instants_of_revolution() {
        let hand = SolutionByHand::new(OMEGA * t, OMEGA);
        let q = m.assemble(&[OMEGA * t, hand.rod[0], hand.piston[0]].into(), &[0]).unwrap();
        let v = m.complete_velocity(&q, &SVector::zeros(), &[]).unwrap();
        assert_close("v", &v.data.0[0], &[OMEGA, hand.rod[1], hand.piston[1]], 1e-11);
        let (a, lambda) = m.constrained_dynamics(&q, &v, &SVector::zeros());
        assert_close("a", &a.data.0[0], &[0.0, hand.rod[2], hand.piston[2]], 1e-9);
        assert_close("torque", &[lambda[2]], &[hand.torque], 1e-9);
    }
}

/// Checks that inverse dynamics of a slider-crank with one degree of freedom returns the torque of its crank
/// for the motion.
#[test]
fn inverse_dynamics_returns_the_crank_torque() {
    let m = Motorised {};
    for t in instants_of_revolution() {
        let hand = SolutionByHand::new(OMEGA * t, OMEGA);
        let q = m.assemble(&[OMEGA * t, hand.rod[0], hand.piston[0]].into(), &[0]).unwrap();
        let v = m.complete_velocity(&q, &[OMEGA, 0.0, 0.0].into(), &[0]).unwrap();
        let a = m.complete_acceleration(&q, &v, &SVector::zeros(), &[0]).unwrap();
        assert_close("a", &a.data.0[0], &[0.0, hand.rod[2], hand.piston[2]], 1e-9);
        let (tau, lambda) = m.constrained_inverse_dynamics(&q, &v, &a, &[0]).unwrap();
        assert_close("torque", &tau.data.0[0], &[hand.torque, 0.0, 0.0], 1e-9);
        // This torque reproduces the motion.
        let (again, multipliers) = m.constrained_dynamics(&q, &v, &tau);
        assert_close("motion", &again.data.0[0], &a.data.0[0], 1e-8);
        assert_close("multipliers", &multipliers.data.0[0], &lambda.data.0[0], 1e-8);
    }
    let q = m.assemble(&[0.7, -0.9, 0.15].into(), &[0]).unwrap();
    let v = m.complete_velocity(&q, &[OMEGA, 0.0, 0.0].into(), &[0]).unwrap();
    let a = m.complete_acceleration(&q, &v, &SVector::zeros(), &[0]).unwrap();
    let inverse_dynamics = |v: &_, a: &_, driven: &[usize]| m.constrained_inverse_dynamics(&q, v, a, driven);
    assert!(matches!(inverse_dynamics(&v, &a, &[]), Err(ConstraintError::Undriven { .. })));
    assert!(matches!(
        inverse_dynamics(&v, &SVector::zeros(), &[0]),
        Err(ConstraintError::Acceleration { .. })
    ));
    assert!(matches!(
        inverse_dynamics(&[1.0, 1.0, 1.0].into(), &a, &[0]),
        Err(ConstraintError::Velocity { .. })
    ));
    assert_eq!(inverse_dynamics(&v, &a, &[3]), Err(ConstraintError::Held { index: 3, velocities: 3 }));
    // Crank or piston may be the actuated joint: the power is equal.
    let (by_crank, by_piston) =
        (inverse_dynamics(&v, &a, &[0]).unwrap().0, inverse_dynamics(&v, &a, &[2]).unwrap().0);
    assert_close("power", &[by_piston.dot(&v)], &[by_crank.dot(&v)], 1e-10);
    assert_eq!((by_piston[0], by_piston[1]), (0.0, 0.0));
}

#[test]
fn prescribed_frames_drive_loops() {
    assert_eq!((Framed::NV, Framed::NS), (2, 0));
    let m = Framed { omega: OMEGA };
    let closed = ClosedForm { omega: OMEGA };
    assert_eq!(ClosedForm::NV, 0);
    let (none, rest) = (SVector::<f64, 0>::zeros(), SVector::<f64, 0>::zeros());
    for t in instants_of_revolution() {
        let hand = SolutionByHand::new(OMEGA * t, OMEGA);
        let q = m.assemble(t, &[hand.rod[0] - 0.2, hand.piston[0]].into(), &[]).unwrap();
        let v = m.project_velocity(t, &q, &SVector::zeros()).unwrap();
        assert_close("q", &q.data.0[0], &[hand.rod[0], hand.piston[0]], 1e-10);
        assert_close("v", &v.data.0[0], &[hand.rod[1], hand.piston[1]], 1e-10);
        let a = m.forward_dynamics(t, &q, &v, &SVector::zeros());
        assert_close("a", &a.data.0[0], &[hand.rod[2], hand.piston[2]], 1e-9);
        let energy = m.kinetic_energy(t, &q, &v);
        assert_close("energies", &[closed.kinetic_energy(t, &none, &rest)], &[energy], 1e-10);
        for on_crank in [m.on_crank(t, &q, &v), closed.on_crank(t, &none, &rest)] {
            let place = on_crank.get("crank.place").unwrap();
            assert_close("torque", &[place.torque[2]], &[hand.torque], 1e-9);
            assert_close("bearing", &place.force.data.0[0][..2], &hand.bearing, 1e-9);
        }
        assert_close("stroke", &[closed.stroke(t, &none)], &[hand.piston[0]], 1e-12);
        assert_close("pin", &[closed.pin_force(t, &none, &rest)[0]], &[PISTON * hand.piston[2]], 1e-9);
    }
}

/// Simulations follow the prescribed motion, also without any coordinate to integrate.
#[test]
fn simulations_follow_the_prescribed_motion() {
    let end = 2.2 * std::f64::consts::TAU / OMEGA;
    let hand = SolutionByHand::new(OMEGA * end, OMEGA);
    let (start, m) = (SolutionByHand::new(0.0, OMEGA), Positioned { omega: OMEGA });
    let (q, v) = ([0.0, start.rod[0], start.piston[0]], [OMEGA, start.rod[1], start.piston[1]]);
    let found = simulate(&m).from(q, v).duration(end).finish().unwrap();
    let turned = OMEGA * end;
    assert_close("q", &found.q.data.0[0], &[turned, hand.rod[0], hand.piston[0]], 1e-8);
    assert_close("v", &found.v.data.0[0], &[OMEGA, hand.rod[1], hand.piston[1]], 1e-7);
    let wrong = simulate(&m).from(q, [0.9 * OMEGA, v[1], v[2]]).duration(end).finish();
    assert!(matches!(wrong, Err(Error::OffConstraints { .. })), "{wrong:?}");
    let closed = ClosedForm { omega: OMEGA };
    let found = simulate(&closed).from([], []).duration(end).finish().unwrap();
    assert_close("time", &[found.t], &[end], 1e-12);
    assert_close("stroke", &[closed.stroke(found.t, &found.q)], &[hand.piston[0]], 1e-12);
}

/// A mechanism without degrees of freedom has no independent states: its linear system has only inputs and
/// outputs.
#[test]
fn driven_mechanisms_have_linear_systems_without_states() {
    let m = Positioned { omega: OMEGA };
    let hand = SolutionByHand::new(0.6, OMEGA);
    let t = 0.6 / OMEGA;
    let q = m.assemble(t, &[0.6, hand.rod[0], hand.piston[0]].into(), &[0]).unwrap();
    let v = m.project_velocity(t, &q, &SVector::zeros()).unwrap();
    let linear = m.linearize(t, &q, &v, &SVector::zeros(), &[]).unwrap();
    assert_eq!(linear.a.shape(), (0, 0));
}

/// Checks two contradictory drives of one coordinate. They have a common configuration only at the time zero;
/// at other times an error reports them.
#[test]
fn contradictory_drives_are_reported() {
    assert_eq!((Twice::NC, Twice::NS), (4, 0));
    let m = Twice { omega: 3.0 };
    assert!(m.assemble(0.0, &[0.0, 0.0, 0.17].into(), &[]).is_ok());
    let found = m.assemble(0.2, &[0.6, -0.78, 0.16].into(), &[]);
    assert!(matches!(found, Err(ConstraintError::Configuration { .. })), "{found:?}");
}

/// Checks that options of generated functions work for a mechanism without degrees of freedom:
/// derivatives along a prescribed motion, and the force of a drive against a gas.
#[test]
fn optional_functions_work_without_degrees_of_freedom() {
    let m = Whole { omega: OMEGA, stiffness: 250.0 };
    let (t, hand) = (0.9 / OMEGA, SolutionByHand::new(0.9, OMEGA));
    let q = m.assemble(t, &[0.9, hand.rod[0], hand.piston[0]].into(), &[]).unwrap();
    let v = m.project_velocity(t, &q, &SVector::zeros()).unwrap();
    let u = [70.0].into();
    let tau = m.generalized_forces(t, &q, &u);
    let (a, lambda) = m.constrained_dynamics(t, &q, &v, &tau);
    assert_close("a", &a.data.0[0], &[0.0, hand.rod[2], hand.piston[2]], 1e-9);
    let by_crank = hand.piston[1] / OMEGA;
    let torque = hand.torque + (250.0 * hand.piston[0] - 70.0) * by_crank;
    assert_close("torque", &[lambda[2]], &[torque], 1e-9);
    let (by_q, by_v, by_tau) = m.forward_dynamics_derivatives(t, &q, &v, &tau);
    // Forces have no effect except on the multipliers.
    assert!(by_tau.amax() < 1e-9 && by_q.iter().chain(&by_v).all(|x| x.is_finite()));
    let by_gas = m.multiplier_derivatives(t, &q, &v, &tau).2 * SVector::from([0.0, 0.0, 1.0]);
    assert_close("torque by force", &[by_gas[2]], &[-by_crank], 1e-9);
}
