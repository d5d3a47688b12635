//! Derivatives of motions with fixed contact modes, against differences of the motion itself.

use linkwork::contact::{self, ContactDerivatives, Touch};
use linkwork::discrete;
use linkwork::integrate::ImplicitMidpoint;
use linkwork::nalgebra::SMatrix;
use linkwork::prelude::*;

/// Quadruped, with its own coefficient of friction for each foot.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, gravity = -9.81 * z, derivatives)]
pub struct Solo {
    #[contact(FL_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    front_left: Contact,
    #[contact(FR_FOOT.sphere(0.016), ground.plane(z), friction = 0.3)]
    front_right: Contact,
    #[contact(HL_FOOT.sphere(0.016), ground.plane(z), friction = 0.8)]
    hind_left: Contact,
    #[contact(HR_FOOT.sphere(0.016), ground.plane(z))]
    hind_right: Contact,
}

/// Ball in a hollow, in wind that changes with time.
#[mechanism(gravity = -9.81 * z, derivatives)]
pub struct BallInHollow {
    #[body(mass = 0.5, inertia = sphere(0.5, 0.1))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[acts(on = ball, value = sin(7 * t) * x - 0.3 * v(ball / ground / ground))]
    wind: Force,
    #[contact(ball.sphere(0.1), ground.terrain(0.2 * u * u + 0.1 * u * w + 0.3 * w * w), friction = 0.4)]
    rest: Contact,
}

/// Slider-crank whose crank pushes a piston onto a stop.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct SliderCrankWithStop {
    #[body(mass = 2, com = 0.02 * x, inertia = rod(2, 0.04, x))]
    crank: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[body(mass = 0.8, com = 0.06 * x, inertia = rod(0.8, 0.13, x))]
    rod: Body,
    #[joint(crank.at(0.04 * x) -> rod, about = z)]
    big_end: Pin,
    #[body(mass = 0.5, inertia = diagonal(0.001, 0.001, 0.001))]
    piston: Body,
    #[joint(rod.at(0.13 * x) -> piston, about = z)]
    small_end: Pin,
    #[constraint(dot(r(piston / ground), ground.y) = 0)]
    bore: Holonomic,
    #[contact(piston.sphere(0.02), ground.at(0.2 * x).plane(-x))]
    stop: Contact,
    #[acts(on = main)]
    motor: Torque,
}

/// Returns the derivative of a function at zero by central differences of sixth order.
fn derivative_at_zero<const N: usize>(f: impl Fn(f64) -> SVector<f64, N>) -> SVector<f64, N> {
    let h = 2e-3;
    let central_difference = |k: f64| f(k * h) - f(-k * h);
    (central_difference(1.0) * 45.0 - central_difference(2.0) * 9.0 + central_difference(3.0)) / (60.0 * h)
}

/// Checks every column of every contact derivative against finite differences.
pub fn check_contact_derivatives<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    m: &M,
    t: f64,
    (q, v): (&SVector<f64, NQ>, &SVector<f64, NV>),
    tau: &SVector<f64, NV>,
    touches: &[Touch; NK],
) where
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = f64>,
{
    let found = contact::forward_dynamics_derivatives(m, t, q, v, tau, touches).unwrap();
    let contact_forward_dynamics = |q: &SVector<f64, NQ>, v: &SVector<f64, NV>, tau: &SVector<f64, NV>| {
        contact::forward_dynamics(m, t, q, v, tau, touches).unwrap()
    };
    let held = contact_forward_dynamics(q, v, tau);
    assert!(found.a == held.a && found.forces == held.forces);
    for k in 0..NV {
        let unit_direction_times = |s: f64| SVector::<f64, NV>::from_fn(|i, _| if i == k { s } else { 0.0 });
        let motion_at_displacement =
            |s: f64| contact_forward_dynamics(&m.integrate(q, &unit_direction_times(s)), v, tau);
        let motion_at_velocity_step =
            |s: f64| contact_forward_dynamics(q, &(v + unit_direction_times(s)), tau);
        let motion_at_force_step = |s: f64| contact_forward_dynamics(q, v, &(tau + unit_direction_times(s)));
        for (what, expected, column) in [
            ("∂v̇/∂q", derivative_at_zero(|s| motion_at_displacement(s).a), found.by_q.column(k)),
            ("∂v̇/∂v", derivative_at_zero(|s| motion_at_velocity_step(s).a), found.by_v.column(k)),
            ("∂v̇/∂τ", derivative_at_zero(|s| motion_at_force_step(s).a), found.by_tau.column(k)),
        ] {
            let off = (column - expected).amax();
            assert!(off < 1e-9 * (1.0 + held.a.amax() + expected.amax()), "{what}, {k}: {off:e}");
        }
        for (what, expected, column) in [
            ("∂f/∂q", derivative_at_zero(|s| motion_at_displacement(s).forces), found.forces_by_q.column(k)),
            ("∂f/∂v", derivative_at_zero(|s| motion_at_velocity_step(s).forces), found.forces_by_v.column(k)),
            ("∂f/∂τ", derivative_at_zero(|s| motion_at_force_step(s).forces), found.forces_by_tau.column(k)),
        ] {
            let off = (column - expected).amax();
            assert!(off < 1e-9 * (1.0 + held.forces.amax() + expected.amax()), "{what}, {k}: {off:e}");
        }
    }
}

/// Returns a configuration and velocity of the quadruped, and joint torques.
pub fn quadruped_state_and_torques() -> (SVector<f64, 19>, SVector<f64, 18>, SVector<f64, 18>) {
    let mut q = Solo {}.neutral();
    q[2] = 0.26;
    q = Solo {}.integrate(&q, &SVector::from_fn(|k, _| if k < 3 { 0.0 } else { 0.1 * k as f64 - 0.35 }));
    for leg in 0..4 {
        let k = f64::from(leg as u32);
        (q[7 + 3 * leg], q[8 + 3 * leg], q[9 + 3 * leg]) = (0.1 - 0.05 * k, 0.8 + 0.1 * k, -1.6 + 0.07 * k);
    }
    let v = SVector::from_fn(|k, _| 0.3 * (1.7 * k as f64 + 0.4).sin());
    let tau = SVector::from_fn(|k, _| if k < 6 { 0.0 } else { 0.5 * (0.9 * k as f64).cos() });
    (q, v, tau)
}

#[test]
fn standing_quadruped_contact_derivatives_match_differences() {
    use Touch::{Open, Slips, Sticks};
    let (q, v, tau) = quadruped_state_and_torques();
    for touches in [
        [Sticks, Open, Open, Sticks],
        [Sticks, Sticks, Sticks, Open],
        [Slips, Sticks, Open, Slips],
        [Slips, Slips, Slips, Slips],
        [Open; 4],
    ] {
        check_contact_derivatives(&Solo {}, 0.0, (&q, &v), &tau, &touches);
    }
}

/// Derivatives on curved ground, with forces that depend on time.
#[test]
fn contact_derivatives_in_windy_hollow_match_differences() {
    let m = BallInHollow {};
    let mut q = m.neutral();
    (q[0], q[1], q[2]) = (0.3, 0.2, 0.13);
    let v = SVector::from_fn(|k, _| 0.5 + 0.3 * k as f64);
    let tau = SVector::from_fn(|k, _| 0.2 - 0.1 * k as f64);
    for touch in [Touch::Sticks, Touch::Slips] {
        check_contact_derivatives(&m, 0.3, (&q, &v), &tau, &[touch]);
    }
}

/// Derivatives of the contact force on a piston act through a closed loop.
#[test]
fn contact_derivatives_act_through_closed_loop() {
    let m = SliderCrankWithStop {};
    let q = m.assemble(&[0.6, -0.8, 0.2].into(), &[0]).unwrap();
    let v = m.complete_velocity(&q, &[3.0, 0.0, 5.0].into(), &[0, 2]).unwrap();
    for touch in [Touch::Sticks, Touch::Open] {
        check_contact_derivatives(&m, 0.0, (&q, &v), &[1.5, 0.0, 0.1].into(), &[touch]);
    }
}

/// Derivatives with respect to inputs follow from the chain rule.
#[test]
fn input_derivatives_under_contact_follow_the_chain_rule() {
    #[mechanism(gravity = -9.81 * y, derivatives)]
    struct Cart {
        #[body(mass = 3)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[body(mass = 1, com = -0.3 * y, inertia = rod(1, 0.6, y))]
        arm: Body,
        #[joint(cart -> arm, about = z)]
        hinge: Pin,
        #[acts(on = rail)]
        motor: Force,
        #[contact(arm.at(-0.6 * y), ground.at(-0.5 * y).plane(y), friction = 0.6)]
        tip: Contact,
    }
    let (q, v, u) = ([0.1, 0.4].into(), [0.3, -1.2].into(), [4.0].into());
    let acceleration_with_input = |u: SVector<f64, 1>| {
        let tau = Cart {}.generalized_forces(&q, &u);
        contact::forward_dynamics(&Cart {}, 0.0, &q, &v, &tau, &[Touch::Slips]).unwrap().a
    };
    let linear = contact::linear_motion(&Cart {}, 0.0, &q, &v, &u, &[Touch::Slips]).unwrap();
    assert_eq!(linear.acceleration, acceleration_with_input(u));
    let expected = derivative_at_zero(|s| acceleration_with_input(u.add_scalar(s)));
    assert!((linear.by_u - expected).amax() < 1e-10, "{expected}");
    assert!(linear.by_u.amax() > 0.1, "the motor moves it");
}

/// Checks a table on four contact points, whose twelve force components exceed the six that determine the
/// motion. Their effect on the motion is still unique.
#[test]
fn redundant_contact_forces_of_a_table_have_derivatives() {
    #[mechanism(gravity = -9.81 * z, derivatives)]
    struct Table {
        #[body(mass = 4, com = 0.1 * x + 0.2 * z, inertia = cuboid(4, 0.6, 0.4, 0.1))]
        table: Body,
        #[joint(ground -> table)]
        pose: Free,
        #[body(mass = 1, com = -0.2 * z, inertia = rod(1, 0.4, z))]
        lamp: Body,
        #[joint(table -> lamp, about = x)]
        hinge: Pin,
        #[contact(table.at(0.3 * x + 0.2 * y), ground.plane(z), friction = 0.5)]
        a: Contact,
        #[contact(table.at(0.3 * x - 0.2 * y), ground.plane(z), friction = 0.5)]
        b: Contact,
        #[contact(table.at(-0.3 * x + 0.2 * y), ground.plane(z), friction = 0.5)]
        c: Contact,
        #[contact(table.at(-0.3 * x - 0.2 * y), ground.plane(z), friction = 0.5)]
        d: Contact,
    }
    let m = Table {};
    let q = m.integrate(&m.neutral(), &SVector::from_fn(|k, _| 0.2 - 0.05 * k as f64));
    // All four points can stick only if the table does not rotate.
    let v = SVector::from_fn(|k, _| if k == 6 { 2.0 } else { 0.0 });
    let tau = SVector::from_fn(|k, _| 0.3 * k as f64 - 1.0);
    let touches = [Touch::Sticks; 4];
    let found = contact::forward_dynamics_derivatives(&m, 0.0, &q, &v, &tau, &touches).unwrap();
    let acceleration_on_table =
        |q, v, tau| contact::forward_dynamics(&m, 0.0, &q, &v, &tau, &touches).unwrap().a;
    for k in 0..7 {
        let unit_direction_times = |s: f64| SVector::<f64, 7>::from_fn(|i, _| if i == k { s } else { 0.0 });
        let mut columns = vec![
            (
                derivative_at_zero(|s| {
                    acceleration_on_table(m.integrate(&q, &unit_direction_times(s)), v, tau)
                }),
                found.by_q.column(k),
            ),
            (
                derivative_at_zero(|s| acceleration_on_table(q, v, tau + unit_direction_times(s))),
                found.by_tau.column(k),
            ),
        ];
        if !(3..6).contains(&k) {
            columns.push((
                derivative_at_zero(|s| acceleration_on_table(q, v + unit_direction_times(s), tau)),
                found.by_v.column(k),
            ));
        }
        for (expected, column) in columns {
            let off = (column - expected).amax();
            assert!(off < 1e-7 * (1.0 + found.a.amax() + expected.amax()), "{k}: {off:e}");
        }
    }
}

/// Quadruped with points as feet, a contact that other engines support, too.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, gravity = -9.81 * z, derivatives)]
pub struct QuadrupedOnPointFeet {
    #[contact(FL_FOOT, ground.plane(z), friction = 0.8)]
    front_left: Contact,
    #[contact(HR_FOOT, ground.plane(z), friction = 0.8)]
    hind_right: Contact,
}

/// Compares derivatives along the direction `wₖ = cos(0.7 k + 0.3)` of all coordinates with Pinocchio 3.4.0:
/// `computeConstraintDynamicsDerivatives` with two contacts `CONTACT_3D`, `LOCAL_WORLD_ALIGNED`, without
/// correctors, in the state of `stance`.
#[test]
fn quadruped_contact_derivatives_agree_with_pinocchio() {
    let (q, v, tau) = quadruped_state_and_torques();
    let m = QuadrupedOnPointFeet {};
    let touches = [Touch::Sticks; 2];
    let found = contact::forward_dynamics_derivatives(&m, 0.0, &q, &v, &tau, &touches).unwrap();
    let w = SVector::<f64, 18>::from_fn(|k, _| (0.7 * k as f64 + 0.3).cos());
    let assert_close_entries = |what: &str, found: &[f64], expected: &[f64]| {
        let most = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9 * most, "{what}: {found} instead of {expected}");
        }
    };
    let expected = [
        0.752720604,
        -1.541096802,
        -10.734367453,
        23.811331744,
        1.559749983,
        -12.781374936,
        -1.353156697,
        42.274515311,
        -62.47660505,
        -9.527163733,
        19.292407748,
        -867.423158299,
        -2.708694421,
        -113.891300479,
        1068.638228395,
        -36.182512905,
        67.390730087,
        -110.137521312,
    ];
    assert_close_entries("v̇", found.a.as_slice(), &expected);
    let expected = [
        -13.828883153,
        10.026874698,
        1.132675467,
        1.019474489,
        4.9119119,
        29.234859982,
        -102.22430089,
        -26.808564515,
        -79.988509142,
        -55.811254877,
        -53.466535211,
        106.324101256,
        114.774221767,
        126.470923772,
        -260.093146959,
        -32.200270239,
        2.53633402,
        -25.8521223,
    ];
    assert_close_entries("∂v̇/∂q", (found.by_q * w).as_slice(), &expected);
    let expected = [
        -0.268296624,
        0.109501004,
        0.418740644,
        0.350255166,
        0.200724727,
        0.014533704,
        0.442796072,
        -1.000458212,
        1.930128965,
        -0.260762219,
        0.336556244,
        -0.417879959,
        -0.406389599,
        -0.859452079,
        -0.240474152,
        -0.48137914,
        -0.696063872,
        -0.010691094,
    ];
    assert_close_entries("∂v̇/∂v", (found.by_v * w).as_slice(), &expected);
    let expected = [
        2.701384752,
        -0.673243399,
        3.849970587,
        -26.297291356,
        -22.35188282,
        -47.199305998,
        67.653007102,
        28.95612525,
        81.130761157,
        668.182567958,
        412.716462879,
        -813.639454069,
        -534.013505074,
        190.349617214,
        -1681.078525449,
        -31.625203235,
        -22.350708841,
        34.316775057,
    ];
    assert_close_entries("∂v̇/∂τ", (found.by_tau * w).as_slice(), &expected);
    let forces = found.forces;
    assert_close_entries("f", &[forces[0], forces[3]], &[0.843975116, -2.168646151]);
    let forces = found.forces_by_q * w;
    assert_close_entries("∂f/∂q", &[forces[0], forces[3]], &[2.228905258, 0.487937632]);
    let forces = found.forces_by_v * w;
    assert_close_entries("∂f/∂v", &[forces[0], forces[3]], &[-0.008074612, 0.002499599]);
    let forces = found.forces_by_tau * w;
    assert_close_entries("∂f/∂τ", &[forces[0], forces[3]], &[5.929825685, 4.95663259]);
}

/// Steps with fixed contact modes have Jacobians that agree with differences, for explicit and implicit
/// steps, with and without feedback.
#[test]
fn steps_with_fixed_contact_modes_have_exact_jacobians() {
    use discrete::DifferentiableStep;
    let (q, v, _) = quadruped_state_and_torques();
    let m = QuadrupedOnPointFeet {};
    let touches = [Touch::Sticks, Touch::Slips];
    // The state is that after a touchdown: sticking points have no velocity.
    let mut q = q;
    let v = contact::impact(&m, 0.0, &q, &v).unwrap().v;
    q[2] += 0.01;

    fn check_step_derivatives<S: DifferentiableStep<f64>>(
        m: &contact::Holding<'_, QuadrupedOnPointFeet, f64, 2, 6>,
        method: &S,
        (q, v): (&SVector<f64, 19>, &SVector<f64, 18>),
    ) {
        let u = SVector::<f64, 12>::from_fn(|k, _| 0.4 * (0.9 * k as f64).cos());
        let next = discrete::transition(m, method, 0.0, q, v, &u).unwrap();
        let displacement_from_next_and_velocity =
            |q: &SVector<f64, 19>, v: &SVector<f64, 18>, u: &SVector<f64, 12>| {
                let (q, v) = discrete::step(m, method, 0.0, q, v, u).unwrap();
                let moved = QuadrupedOnPointFeet {}.difference(&next.q, &q);
                SVector::<f64, 36>::from_fn(|k, _| if k < 18 { moved[k] } else { v[k - 18] })
            };
        let (a, b) = (next.a::<36>(), next.b::<36>());
        for k in 0..36 {
            let unit_direction_times = |s: f64, first: usize| {
                SVector::<f64, 18>::from_fn(|i, _| if i + first == k { s } else { 0.0 })
            };
            let expected = derivative_at_zero(|s| {
                displacement_from_next_and_velocity(
                    &QuadrupedOnPointFeet {}.integrate(q, &unit_direction_times(s, 0)),
                    &(v + unit_direction_times(s, 18)),
                    &u,
                )
            });
            let off = (a.column(k) - expected).amax();
            assert!(off < 1e-7 * (1.0 + expected.amax()), "{k}: {off:e}");
        }
        for k in 0..12 {
            let expected = derivative_at_zero(|s| {
                displacement_from_next_and_velocity(
                    q,
                    v,
                    &SVector::from_fn(|i, _| if i == k { u[i] + s } else { u[i] }),
                )
            });
            let off = (b.column(k) - expected).amax();
            assert!(off < 1e-7 * (1.0 + expected.amax()), "{k}: {off:e}");
        }
    }
    let held = contact::hold(&m, touches);
    for held in [held, held.stabilized(30.0), held.with_gains(0.0, 50.0), held.with_gains(700.0, 0.0)] {
        check_step_derivatives(&held, &Rk4::step(2e-3), (&q, &v));
        check_step_derivatives(&held, &ImplicitMidpoint::step(2e-3), (&q, &v));
    }
}

/// Touchdown with given contact modes has derivatives, also through a closed loop.
#[test]
fn touchdown_has_exact_derivatives() {
    fn check_touchdown_derivatives<
        M,
        const NQ: usize,
        const NV: usize,
        const NU: usize,
        const NK: usize,
        const NR: usize,
    >(
        m: &M,
        (q, v): (&SVector<f64, NQ>, &SVector<f64, NV>),
        touches: &[Touch; NK],
    ) where
        M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = f64>,
    {
        let found = contact::land_derivatives(m, 0.0, q, v, touches).unwrap();
        let velocity_after_touchdown =
            |q: &SVector<f64, NQ>, v: &SVector<f64, NV>| contact::land(m, 0.0, q, v, touches).unwrap();
        // Balance of momentum, and velocities of closed contacts after the touchdown.
        let step = found.transition::<NQ, NU>(q);
        assert!(step.q == *q && step.v == found.v && step.v_by_q == found.by_q && step.v_by_v == found.by_v);
        assert!(
            step.q_by_q == SMatrix::<f64, NV, NV>::identity()
                && step.q_by_v.amax() + step.v_by_u.amax() == 0.0
        );
        let balance =
            m.mass_matrix(0.0, q) * (found.v - v) - m.contact_jacobian(0.0, q).transpose() * found.impulses;
        assert!(M::CONSTRAINED || balance.amax() < 1e-10, "{balance}");
        for k in 0..NV {
            let unit_direction_times =
                |s: f64| SVector::<f64, NV>::from_fn(|i, _| if i == k { s } else { 0.0 });
            let touchdown_at_displacement =
                |s: f64| velocity_after_touchdown(&m.integrate(q, &unit_direction_times(s)), v);
            let touchdown_at_velocity_step =
                |s: f64| velocity_after_touchdown(q, &(v + unit_direction_times(s)));
            let of_velocity = [
                (derivative_at_zero(|s| touchdown_at_displacement(s).v), found.by_q.column(k)),
                (derivative_at_zero(|s| touchdown_at_velocity_step(s).v), found.by_v.column(k)),
            ];
            let of_impulses = [
                (
                    derivative_at_zero(|s| touchdown_at_displacement(s).impulses),
                    found.impulses_by_q.column(k),
                ),
                (
                    derivative_at_zero(|s| touchdown_at_velocity_step(s).impulses),
                    found.impulses_by_v.column(k),
                ),
            ];
            for (expected, column) in of_velocity {
                assert!((column - expected).amax() < 1e-8 * (1.0 + expected.amax()), "{k}: {expected}");
            }
            for (expected, column) in of_impulses {
                assert!((column - expected).amax() < 1e-8 * (1.0 + expected.amax()), "{k}: {expected}");
            }
        }
    }
    let (q, v, _) = quadruped_state_and_torques();
    use Touch::{Open, Slips, Sticks};
    check_touchdown_derivatives(&Solo {}, (&q, &v), &[Sticks, Open, Slips, Sticks]);
    let m = SliderCrankWithStop {};
    let q = m.assemble(&[0.6, -0.8, 0.2].into(), &[0]).unwrap();
    let v = m.complete_velocity(&q, &[3.0, 0.0, 5.0].into(), &[0, 2]).unwrap();
    check_touchdown_derivatives(&m, (&q, &v), &[Sticks]);
}
