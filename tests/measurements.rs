//! Checks of outputs as sensor measurements: partial derivatives and total derivatives along the motion
//! against finite differences, and all outputs as one vector.

use linkwork::prelude::*;
use linkwork::{Derivatives, OutputDerivatives, Outputs, index_of};
use support::differences;
use support::random::Random;
use support::with_common_fields;

/// Flying body with a load on a ball joint, with a gyroscope, an accelerometer, an altimeter, a current and a
/// camera.
#[mechanism(gravity = -9.81 * z, derivatives, sensitivities, batch, prepare)]
struct FlyingBodyWithSensors {
    mass: f64,
    reach: f64,
    #[body(
        mass = mass, com = 0.02 * z,
        inertia = diagonal(mass * gyration, 1.2 * mass * gyration, 2 * mass * gyration)
    )]
    frame: Body,
    #[define(0.01)]
    gyration: Scalar,
    #[body(mass = 0.3, com = -reach * z, inertia = diagonal(0.004, 0.005, 0.001))]
    load: Body,
    #[joint(ground -> frame)]
    flight: Free,
    #[joint(frame.at(-0.05 * z) -> load)]
    hook: Ball,
    #[acts(on = frame.at(0.2 * x), along = frame.z)]
    front: Force,
    #[acts(on = frame, about = frame.z)]
    drag: Torque,
    #[output(omega(frame / ground), resolved_in = frame)]
    gyroscope: Vector,
    #[output(a(frame.at(0.1 * y) / ground / ground) + 9.81 * z, resolved_in = frame)]
    accelerometer: Vector,
    #[output(dot(r(load.at(-reach * z) / ground), z))]
    altitude: Scalar,
    #[output(2 * front + drag * drag)]
    current: Scalar,
    #[output(v(load.at(-reach * z) / frame / frame), resolved_in = frame)]
    camera: Vector,
}

/// Pendulum on a driven pivot, with a rate gyroscope on its bob.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct PendulumOnDrivenPivot {
    rate: f64,
    #[point(at = 0.1 * sin(rate * t) * y)]
    pivot: Point,
    #[body(mass = 0.7, com = -0.3 * y, inertia = diagonal(0.01, 0.01, 0.02))]
    bob: Body,
    #[joint(pivot -> bob, about = z)]
    hinge: Pin,
    #[acts(on = hinge)]
    motor: Torque,
    #[output(dot(a(bob.at(-0.5 * y) / ground / ground), bob.x))]
    swing: Scalar,
    #[output(sin(rate * t) * rate(hinge))]
    mixed: Scalar,
}

/// Carrier with a turntable on a driven arm and a bead, whose outputs are momenta and energies of single
/// bodies.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct CarrierWithBodyOutputs {
    mass: f64,
    #[body(mass = 3, com = 0.1 * x - 0.2 * y, inertia = [[0.3, 0.02, 0], [0.02, 0.4, 0.01], [0, 0.01, 0.5]])]
    hull: Body,
    #[body(mass = mass, com = 0.2 * z, inertia = diagonal(0.1, 0.2, gyration * mass))]
    table: Body,
    #[define(0.15)]
    gyration: Scalar,
    #[joint(ground -> hull)]
    flight: Free,
    #[joint(hull.at(0.3 * x).rotated(y(0.4)) -> table.at(0.1 * y), about = z)]
    axle: Pin,
    s: Coordinate,
    #[particle(mass = 0.5, at = table.at(s * x + s * s * y))]
    bead: Particle,
    #[output(momentum(hull) + momentum(table) + momentum(bead))]
    linear: Vector,
    #[output(
        angular_momentum(hull / ground) + angular_momentum(table / ground) + angular_momentum(bead / ground)
    )]
    angular: Vector,
    #[output(kinetic_energy(hull) + kinetic_energy(table) + kinetic_energy(bead))]
    energy: Scalar,
    #[output(angular_momentum(table / table.at(0.2 * z)), resolved_in = table)]
    own: Vector,
    #[output(omega(table / ground), resolved_in = table)]
    turning: Vector,
    #[output(moment_of_inertia(hull / ground, ground.x) + moment_of_inertia(table / ground, ground.x)
        + moment_of_inertia(bead / ground, ground.x))]
    about_x: Scalar,
    #[output(moment_of_inertia(hull / ground, ground.x, ground.y) + moment_of_inertia(table / ground, ground.x, ground.y)
        + moment_of_inertia(bead / ground, ground.x, ground.y))]
    of_x_and_y: Scalar,
    #[output(moment_of_inertia(table / table.at(0.3 * x - 0.1 * y), table.z))]
    beside: Scalar,
}

/// Checks moments of inertia by energies: all bodies, rotated as one rigid body about a line through the
/// ground's origin, have the kinetic energy `½ ω² J`. Rotations about two axes determine products of inertia,
/// and the parallel-axis theorem gives the moment about another line.
#[test]
fn moments_of_inertia_agree_with_kinetic_energies() {
    let (m, mut random) = (CarrierWithBodyOutputs { mass: 1.7 }, Random::new(15));
    let assert_close_values = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{found} {expected}")
    };
    for _ in 0..5 {
        let q: SVector<f64, 9> = random.random_configuration(&m);
        let place = m.frame_placement(frame!(CarrierWithBodyOutputs, "hull"), &q);
        let energy_of_rotation = |w: [f64; 3]| {
            let w = linkwork::nalgebra::Vector3::from(w);
            let (own, v) =
                (place.rotation.inverse() * w, place.rotation.inverse() * w.cross(&place.translation.vector));
            let v = SVector::from([v.x, v.y, v.z, own.x, own.y, own.z, 0.0, 0.0]);
            m.kinetic_energy(&q, &v)
        };
        let (x, y, both) = (
            energy_of_rotation([1.0, 0.0, 0.0]),
            energy_of_rotation([0.0, 1.0, 0.0]),
            energy_of_rotation([1.0, 1.0, 0.0]),
        );
        assert_close_values(m.about_x(&q), 2.0 * x);
        assert_close_values(m.of_x_and_y(&q), both - x - y);
        assert_close_values(m.beside(&q), 0.15 * m.mass + m.mass * (0.3 * 0.3 + 0.1 * 0.1));
    }
}

/// Checks that momenta and energies of the bodies add up to those of the whole mechanism. About its own
/// centre of mass, a body has the angular momentum `I ω`.
#[test]
fn body_momenta_and_energies_add_up() {
    let (m, mut random) = (CarrierWithBodyOutputs { mass: 1.7 }, Random::new(5));
    for _ in 0..5 {
        let (q, v): (SVector<f64, 9>, SVector<f64, 8>) =
            (random.random_configuration(&m), random.random_vector(2.0));
        let whole = m.momentum(&q, &v);
        let (linear, spin) = (whole.fixed_rows::<3>(0).into_owned(), whole.fixed_rows::<3>(3).into_owned());
        assert!((m.linear(&q, &v) - linear).amax() < 1e-12);
        assert!((m.angular(&q, &v) - spin - m.center_of_mass(&q).cross(&linear)).amax() < 1e-11);
        assert!((m.energy(&q, &v) - m.kinetic_energy(&q, &v)).abs() < 1e-11);
        let w = m.turning(&q, &v);
        let expected = SVector::from([0.1 * w[0], 0.2 * w[1], 0.15 * 1.7 * w[2]]);
        assert!((m.own(&q, &v) - expected).amax() < 1e-13);
        // The Jacobian of the linear momentum maps the velocities to it.
        assert!((m.linear_jacobian(&q, &v) * v - linear).amax() < 1e-11);
    }
}

const TOLERANCE: f64 = 1e-9;

/// Returns the derivatives of a function along each entry of its argument, a column for each.
fn derivative_columns<const N: usize, const NY: usize>(
    of: impl Fn(&SVector<f64, N>) -> SVector<f64, NY>,
) -> SMatrix<f64, NY, N> {
    differences::derivative_columns([1.5e-3; N], |d| of(&d))
}

fn assert_close_matrices<const R: usize, const C: usize>(
    what: &str,
    found: &SMatrix<f64, R, C>,
    expected: &SMatrix<f64, R, C>,
) {
    let scale = expected.amax().max(1.0);
    assert!((found - expected).amax() <= TOLERANCE * scale, "{what}: {found}{expected}");
}

fn check_output_derivatives<M, const NQ: usize, const NV: usize, const NU: usize, const NY: usize>(m: &M)
where
    M: Derivatives<NQ, NV, NU, Scalar = f64> + OutputDerivatives<NQ, NV, NU, NY, Scalar = f64>,
    M: Outputs<NQ, NV, NU, NY, Scalar = f64>,
{
    for seed in 0..3 {
        let mut random = Random::new(seed);
        let q = m.integrate(&m.neutral(), &random.random_vector(1.2));
        let (v, a, u) = (random.random_vector(2.0), random.random_vector(3.0), random.random_vector(4.0));
        let t = random.uniform_number(1.0);
        let found = m.output_derivatives(t, &q, &v, &a, &u);
        assert_close_matrices(
            "by q",
            &found.by_q,
            &derivative_columns(|d| m.outputs(t, &m.integrate(&q, d), &v, &a, &u)),
        );
        assert_close_matrices(
            "by v",
            &found.by_v,
            &derivative_columns(|d| m.outputs(t, &q, &(v + d), &a, &u)),
        );
        assert_close_matrices(
            "by a",
            &found.by_a,
            &derivative_columns(|d| m.outputs(t, &q, &v, &(a + d), &u)),
        );
        assert_close_matrices(
            "by u",
            &found.by_u,
            &derivative_columns(|d| m.outputs(t, &q, &v, &a, &(u + d))),
        );

        // In the total derivatives, accelerations are functions of state and inputs.
        let now = at(m, t);
        let outputs_at_motion_acceleration = |q: &_, v: &_, u: &_| {
            let tau = Mechanism::generalized_forces(&now, 0.0, q, v, u);
            m.outputs(t, q, v, &Mechanism::forward_dynamics(&now, 0.0, q, v, &tau), u)
        };
        let motion = now.linear_motion(&q, &v, &u);
        let found = m.output_derivatives(t, &q, &v, &motion.acceleration, &u).in_motion(&motion);
        assert_close_matrices(
            "by q in motion",
            &found.by_q,
            &derivative_columns(|d| outputs_at_motion_acceleration(&m.integrate(&q, d), &v, &u)),
        );
        assert_close_matrices(
            "by v in motion",
            &found.by_v,
            &derivative_columns(|d| outputs_at_motion_acceleration(&q, &(v + d), &u)),
        );
        assert_close_matrices(
            "by u in motion",
            &found.by_u,
            &derivative_columns(|d| outputs_at_motion_acceleration(&q, &v, &(u + d))),
        );
        assert!(found.by_a.amax() == 0.0);
    }
}

#[test]
fn measurement_derivatives_agree_with_differences() {
    let carrier = FlyingBodyWithSensors { mass: 1.3, reach: 0.4 };
    check_output_derivatives(&carrier);
    check_output_derivatives(&carrier.prepare());
    check_output_derivatives(&PendulumOnDrivenPivot { rate: 3.0 });
}

#[test]
fn measurement_parameter_derivatives_agree_with_differences() {
    let mut random = Random::new(5);
    let m = FlyingBodyWithSensors { mass: 1.3, reach: 0.4 };
    let q = m.integrate(&FlyingBodyWithSensors::neutral(&m), &random.random_vector(1.0));
    let (v, a) = (random.random_vector(1.0), random.random_vector(1.0));
    assert_eq!(FlyingBodyWithSensors::PARAMETERS, ["mass", "reach"]);
    let perturbed_mechanism =
        |d: &SVector<f64, 2>| FlyingBodyWithSensors { mass: m.mass + d[0], reach: m.reach + d[1] };
    assert_close_matrices(
        "altitude",
        &m.altitude_by_parameters(&q),
        &derivative_columns(|d| SVector::from([perturbed_mechanism(d).altitude(&q)])),
    );
    assert_close_matrices(
        "camera",
        &m.camera_by_parameters(&q, &v),
        &derivative_columns(|d| perturbed_mechanism(d).camera(&q, &v)),
    );
    assert_close_matrices(
        "accelerometer",
        &m.accelerometer_by_parameters(&q, &v, &a),
        &derivative_columns(|d| perturbed_mechanism(d).accelerometer(&q, &v, &a)),
    );
}

#[test]
fn output_vector_contains_all_outputs() {
    type All = [&'static str; 11];
    const NAMES: All = <FlyingBodyWithSensors as Outputs<11, 9, 2, 11>>::OUTPUTS;
    assert_eq!(NAMES[0], "gyroscope.x");
    assert_eq!(index_of(&NAMES, "current"), Some(7));
    let mut random = Random::new(6);
    let m = FlyingBodyWithSensors { mass: 1.3, reach: 0.4 };
    let q = m.integrate(&FlyingBodyWithSensors::neutral(&m), &random.random_vector(1.0));
    let (v, a, u) = (random.random_vector(1.0), random.random_vector(1.0), random.random_vector(1.0));
    let all: SVector<f64, 11> = m.outputs(0.0, &q, &v, &a, &u);
    assert_eq!(all.fixed_rows::<3>(3), m.accelerometer(&q, &v, &a));
    assert_eq!(all[6], m.altitude(&q));
    assert_eq!(all[7], m.current(&q, &u));
}

with_common_fields! {
    {
        #[body(mass = 2)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[body(mass = 1, com = 0.4 * x, inertia = diagonal(0.01, 0.05, 0.06))]
        first: Body,
        #[joint(cart -> first)]
        ball: Ball,
        #[body(mass = 0.5, com = 0.3 * y, inertia = diagonal(0.02, 0.01, 0.03))]
        second: Body,
        #[joint(first.at(0.8 * x) -> second, about = z)]
        hinge: Pin,
    }

    /// Two rods on a cart with force elements of every kind.
    #[mechanism(gravity = -9.81 * y)]
    struct CartWithAllForceElements {
        #[acts(on = rail, stiffness = 30, free_length = 0.2)]
        coil: Spring,
        #[acts(between = (ground.at(2 * y), second.at(0.6 * y)), stiffness = 12, free_length = 0.5)]
        rope: Spring,
        #[acts(on = hinge, damping = 0.7)]
        grease: Dashpot,
        #[acts(between = (cart, second), damping = 0.4)]
        damper: Dashpot,
        #[acts(on = hinge, coulomb = 0.3, speed = 0.1)]
        rubbing: Friction,
        #[acts(on = second.at(0.6 * y), value = (2 + sin(hinge)) * ground.x)]
        wind: Force,
        #[acts(on = first, value = -0.2 * omega(first / ground))]
        drag: Torque,
        #[acts(between = (ground.at(3 * z), first.at(0.8 * x)), strength = 1.5)]
        pull: Attraction,
        #[acts(on = hinge)]
        motor: Torque,
        #[acts(on = first.at(0.5 * x), along = y)]
        jet: Force,
        #[acts(on = second, about = z)]
        wheel: Torque,
        #[acts(between = (ground, second.at(0.6 * y)))]
        cylinder: Force,
        #[output(power(coil) + power(rope) + power(pull))]
        stored: Scalar,
        #[output(power(grease) + power(damper) + power(rubbing))]
        lost: Scalar,
        #[output(power(wind) + power(drag))]
        applied: Scalar,
        #[output(power(motor) + power(jet) + power(wheel) + power(cylinder))]
        controlled: Scalar,
        #[output(power(grease))]
        of_grease: Scalar,
    }

    /// Two rods on a cart, without force elements.
    #[mechanism(gravity = -9.81 * y)]
    struct ForceFreeCart {}
}

/// The power of the elements equals their contribution to the rate of the kinetic energy, found from the bias
/// forces with and without elements times the velocities. For each group of elements it is the power balance
/// of the whole.
#[test]
fn element_powers_equal_energy_rates() {
    let mut random = Random::new(25);
    for _ in 0..20 {
        let (q, v): (SVector<f64, 6>, SVector<f64, 5>) =
            (random.random_configuration(&CartWithAllForceElements {}), random.random_vector(2.0));
        let u = random.random_vector(3.0);
        let m = CartWithAllForceElements {};
        let assert_close_values = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-10 * (1.0 + expected.abs()), "{found} {expected}");
        };
        let passive = v.dot(&(ForceFreeCart {}.bias_forces(&q, &v) - m.bias_forces(&q, &v)));
        assert_close_values(m.stored(&q, &v) + m.lost(&q, &v) + m.applied(&q, &v), passive);
        assert_close_values(m.controlled(&q, &v, &u), v.dot(&m.generalized_forces(&q, &u)));
        assert_close_values(m.lost(&q, &v), -m.dissipated_power(&q, &v));
        assert_close_values(m.applied(&q, &v), m.disturbance_power(&q, &v));
        assert_close_values(m.of_grease(&q, &v), -0.7 * v[4] * v[4]);
        // Potential energy decreases along the motion by the power that springs deliver.
        let configuration_after = |h: f64| m.integrate(&q, &(v * h));
        let energy_of_elements =
            |q: &SVector<f64, 6>| m.potential_energy(q) - ForceFreeCart {}.potential_energy(q);
        let h = 1e-5;
        let slope = (energy_of_elements(&configuration_after(h))
            - energy_of_elements(&configuration_after(-h)))
            / (2.0 * h);
        assert!((m.stored(&q, &v) + slope).abs() < 1e-6 * (1.0 + slope.abs()));
    }
}

/// Bracket welded to a wall: a mechanism without degrees of freedom.
#[mechanism(gravity = -9.81 * y, second_derivatives, momentum_derivatives, batch)]
struct WeldedBracket {
    #[body(mass = 2, com = 0.5 * x, inertia = rod(2, 1, x))]
    arm: Body,
    #[joint(ground -> arm)]
    wall: Weld,
    #[output(reaction_torque(wall))]
    moment: Vector,
}

/// A mechanism without degrees of freedom has no derivatives with respect to velocities, and the wall
/// supports the weight.
#[test]
fn welded_mechanism_has_reactions_without_motion() {
    let none = SVector::<f64, 0>::zeros();
    let moment = WeldedBracket {}.moment(&none, &none);
    assert!((moment - SVector::from([0.0, 0.0, 2.0 * 9.81 * 0.5])).amax() < 1e-12, "{moment}");
    let (a, b) = WeldedBracket {}.linearize(&none, &none, &none);
    assert_eq!((a.shape(), b.shape()), ((0, 0), (0, 0)));
    let (by_q, ..) = WeldedBracket {}.forward_dynamics_derivatives(&none, &none, &none);
    assert_eq!(by_q.shape(), (0, 0));
}
