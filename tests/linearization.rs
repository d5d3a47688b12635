//! First derivatives and the linearised motion against differences and closed-form solutions.

use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{Mechanism, at, mechanism};
use support::compare::{assert_close, assert_close_relative_to_largest};
use support::differences::{derivative_at_zero, derivative_columns};
use support::random::Random;

/// Tolerance of derivatives against finite differences.
const DIFFERENCE: f64 = 1e-8;

const STEP: f64 = 5e-4;

/// Checks that each column of a matrix is the derivative of `f` along one unit vector, by finite differences.
#[track_caller]
fn check_derivative_columns<const R: usize, const C: usize>(
    what: &str,
    matrix: &SMatrix<f64, R, C>,
    f: impl Fn(SVector<f64, C>) -> SVector<f64, R>,
) {
    let expected = derivative_columns([STEP; C], f);
    assert_close_relative_to_largest(what, matrix.as_slice(), expected.as_slice(), DIFFERENCE);
}

/// Checks all derivatives of a mechanism against finite differences. For a mechanism that depends on time,
/// `$t` is the time.
macro_rules! check_differences {
    ($mechanism:expr, $type:ident, $at:ident => $instant:expr $(, $t:expr)?) => {{
        const NV: usize = $type::NV;
        const NU: usize = $type::NU;
        const TWICE: usize = 2 * NV;
        let $at = $mechanism;
        let m = &$instant;
        let mut random = Random::new(21);
        for _ in 0..3 {
            let q = random.random_configuration(m);
            let (v, a, tau): (SVector<f64, NV>, SVector<f64, NV>, SVector<f64, NV>) =
                (random.random_vector(1.0), random.random_vector(1.0), random.random_vector(1.0));
            let u: SVector<f64, NU> = random.random_vector(1.0);

            let inverse_dynamics = |q: &_, v: &_| Mechanism::inverse_dynamics(m, 0.0, q, v, &a);
            let forward_dynamics = |q: &_, v: &_, tau: &_| Mechanism::forward_dynamics(m, 0.0, q, v, tau);
            let accelerations_under_inputs = |q: &_, v: &_, u: &_| {
                forward_dynamics(q, v, &Mechanism::generalized_forces(m, 0.0, q, v, u))
            };

            let (by_q, by_v) = $at.inverse_dynamics_derivatives($($t,)? &q, &v, &a);
            check_derivative_columns("∂τ/∂q", &by_q, |d| inverse_dynamics(&m.integrate(&q, &d), &v));
            check_derivative_columns("∂τ/∂v", &by_v, |d| inverse_dynamics(&q, &(v + d)));

            let (by_q, by_v, inverse) = $at.forward_dynamics_derivatives($($t,)? &q, &v, &tau);
            check_derivative_columns("∂v̇/∂q", &by_q, |d| forward_dynamics(&m.integrate(&q, &d), &v, &tau));
            check_derivative_columns("∂v̇/∂v", &by_v, |d| forward_dynamics(&q, &(v + d), &tau));
            check_derivative_columns("∂v̇/∂τ", &inverse, |d| forward_dynamics(&q, &v, &(tau + d)));
            assert_close("M⁻¹", $at.mass_matrix_inverse($($t,)? &q).as_slice(), inverse.as_slice(), 1e-9);

            let (state, input) = $at.linearize($($t,)? &q, &v, &u);
            check_derivative_columns("B", &input, |d| {
                let change = accelerations_under_inputs(&q, &v, &(u + d));
                SVector::<f64, TWICE>::from_fn(|i, _| if i < NV { 0.0 } else { change[i - NV] })
            });
            check_derivative_columns("A", &state, |d| {
                let (dq, dv) = (SVector::from_fn(|i, _| d[i]), SVector::from_fn(|i, _| d[NV + i]));
                let (start, w) = (m.integrate(&q, &dq), v + dv);
                // Rate of change of the displacement from one motion to the other.
                let displacement_after =
                    |t: f64| m.difference(&m.integrate(&q, &(v * t)), &m.integrate(&start, &(w * t)));
                let apart = derivative_at_zero(STEP, displacement_after);
                let change = accelerations_under_inputs(&start, &w, &u);
                SVector::<f64, TWICE>::from_fn(|i, _| if i < NV { apart[i] } else { change[i - NV] })
            });
        }
    }};
}

/// Joints of seven kinds, springs, a dashpot, friction, and inputs on coordinates and bodies; some of the
/// values are parameters.
#[mechanism(gravity = 0.3 * x - 0.4 * y - 9.7 * z, derivatives)]
struct MechanismOfAllJoints {
    mass: f64,
    #[body(mass = 3 * mass, com = 0.05 * x, inertia = cuboid(3 * mass, 0.4, 0.3, 0.5))]
    hub: Body,
    #[body(mass = 0.4, com = 0.3 * x, inertia = rod(0.4, 0.6, x))]
    boom: Body,
    #[body(mass = 0.6, com = 0.1 * z - 0.05 * x, inertia = disk(0.6, 0.2, z))]
    mirror: Body,
    #[body(mass = 0.3, com = 0.02 * y, inertia = sphere(0.3, 0.05))]
    weight: Body,
    #[body(mass = 0.5, com = 0.1 * y, inertia = diagonal(0.01, 0.02, 0.015))]
    nut: Body,
    #[body(mass = 0.7, com = 0.1 * y - 0.1 * z, inertia = diagonal(0.02, 0.02, 0.015))]
    cross: Body,
    #[body(mass = 0.2, com = 0.1 * x, inertia = diagonal(0.01, 0.01, 0.015))]
    puck: Body,
    #[joint(ground -> hub)]
    pose: Free,
    #[joint(hub.at(0.2 * x) -> boom, about = [0.6, 0, -0.8])]
    hinge: Pin,
    #[joint(hub.at(-0.15 * y) -> mirror.at(0.02 * y))]
    bearing: Ball,
    #[joint(boom.at(0.6 * x) -> weight, along = y, about = x)]
    rail: Slot,
    #[joint(mirror.at(0.1 * z) -> nut, about = z, pitch = 0.05)]
    thread: Screw,
    #[joint(boom.at(0.3 * x + 0.1 * y) -> cross, about = (x, y))]
    gimbal: Universal,
    #[joint(nut.rotated(x(0.3)) -> puck, about = z)]
    plane: Planar,
    #[acts(on = hinge, stiffness = 2, free_angle = 0.5)]
    spring: Spring,
    #[acts(between = (hub.at(0.3 * z), weight.at(0.01 * x)), stiffness = 40, free_length = 0.1)]
    band: Spring,
    #[acts(on = thread, damping = 0.4)]
    dashpot: Dashpot,
    #[acts(on = rail.slide, coulomb = 0.7, speed = 0.5)]
    friction: Friction,
    #[acts(on = hinge)]
    motor: Torque,
    #[acts(on = cross.at(0.1 * y + 0.05 * z), along = x)]
    thrust: Force,
    #[acts(on = weight, about = ground.z)]
    gust: Torque,
}

#[test]
fn linearisation_covers_every_joint_and_load() {
    check_differences!(MechanismOfAllJoints { mass: 1.1 }, MechanismOfAllJoints, m => m);
}

/// Bodies placed by expressions of coordinates, and an inerter: the recursive algorithms do not apply.
#[mechanism(gravity = -9.7 * y, derivatives)]
struct BodiesPlacedByCoordinates {
    length: f64,
    phi: Coordinate,
    s: Coordinate,
    #[frame(ground, z(phi * phi / 2))]
    turned: Frame,
    #[body(
        at = length * turned.x + s * s * turned.y, frame = turned, mass = 1.3, com = 0.1 * y,
        inertia = diagonal(0.1, 0.2, 0.3)
    )]
    block: Body,
    #[body(mass = 0.4, com = 0.2 * x, inertia = rod(0.4, 0.4, x))]
    arm: Body,
    #[joint(block.at(0.1 * x) -> arm, about = z)]
    pin: Pin,
    #[acts(between = (ground.at(2 * y), arm.at(0.4 * x)), inertance = 0.3)]
    inerter: Inerter,
    #[acts(between = (ground.at(2 * x), arm.at(0.4 * x)), damping = 0.3)]
    damper: Dashpot,
    #[acts(on = pin)]
    motor: Torque,
}

#[test]
fn linearisation_covers_placed_bodies() {
    check_differences!(BodiesPlacedByCoordinates { length: 0.8 }, BodiesPlacedByCoordinates, m => m);
}

/// Pendulum with a driven pivot: every function has the time as its first argument.
#[mechanism(gravity = -9.7 * y, derivatives)]
struct PendulumOnDrivenPivot {
    amplitude: f64,
    #[point(at = amplitude * cos(3 * t) * y)]
    pivot: Point,
    #[body(mass = 0.7, com = 0.3 * x, inertia = rod(0.7, 0.6, x))]
    upper: Body,
    #[body(mass = 0.3, com = 0.2 * x - 0.05 * z, inertia = diagonal(0.01, 0.02, 0.03))]
    lower: Body,
    #[joint(pivot -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(0.6 * x) -> lower)]
    elbow: Ball,
    #[acts(on = shoulder)]
    motor: Torque,
}

#[test]
fn linearisation_covers_a_driven_pivot() {
    check_differences!(PendulumOnDrivenPivot { amplitude: 0.2 }, PendulumOnDrivenPivot, m => at(&m,
        0.4_f64), 0.4);
}

/// Panda robot arm whose second finger follows the first.
#[mechanism(urdf = "../models/urdf/panda.urdf", derivatives)]
struct PandaMimic;

#[test]
fn linearisation_covers_coupled_joints() {
    check_differences!(PandaMimic, PandaMimic, m => m);
}

// ---- Closed
// forms ------------------------------------------------------------------------------------------------

/// Particle on a massless rod with a motor.
#[mechanism(gravity = -g * y, derivatives)]
struct Pendulum {
    g: f64,
    mass: f64,
    length: f64,
    damping: f64,
    #[body]
    rod: Body,
    #[particle(mass = mass, at = rod.at(-length * y))]
    bob: Particle,
    #[joint(ground -> rod, about = z)]
    pin: Pin,
    #[acts(on = pin, damping = damping)]
    friction: Dashpot,
    #[acts(on = pin)]
    motor: Torque,
}

#[test]
fn linearised_pendulum_has_its_natural_frequency() {
    let p = Pendulum { g: 9.81, mass: 0.7, length: 0.4, damping: 0.03 };
    for angle in [0.0, 0.4, 3.0] {
        let (a, b) = p.linearize(&SVector::from([angle]), &SVector::from([0.3]), &SVector::from([0.1]));
        let inertia = p.mass * p.length * p.length;
        let expected =
            SMatrix::<f64, 2, 2>::new(0.0, 1.0, -p.g / p.length * angle.cos(), -p.damping / inertia);
        assert_close("A", a.as_slice(), expected.as_slice(), 1e-14);
        assert_close("B", b.as_slice(), &[0.0, 1.0 / inertia], 1e-14);
    }
}

/// Cart on a rail with a particle on a massless pole that is upright at zero.
#[mechanism(gravity = -g * y, derivatives)]
struct CartAndPole {
    g: f64,
    cart_mass: f64,
    mass: f64,
    length: f64,
    #[body(mass = cart_mass)]
    cart: Body,
    #[body]
    pole: Body,
    #[particle(mass = mass, at = pole.at(length * y))]
    bob: Particle,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    pin: Pin,
    #[acts(on = rail)]
    push: Force,
}

/// Checks the linearisation of a cart with a pole in the upright position: `(m_c + m) ẍ − m l θ̈ = u` and
/// `l θ̈ − ẍ = g θ`, with the angle counter-clockwise seen from +z.
#[test]
fn linearised_cart_pole_has_the_textbook_matrices() {
    let c = CartAndPole { g: 9.81, cart_mass: 1.2, mass: 0.3, length: 0.5 };
    let zero = SVector::zeros();
    let (a, b) = c.linearize(&zero, &zero, &SVector::zeros());
    let (mass, l) = (c.cart_mass, c.length);
    let expected = SMatrix::<f64, 4, 4>::from_row_slice(&[
        0.0,
        0.0,
        1.0,
        0.0, //
        0.0,
        0.0,
        0.0,
        1.0, //
        0.0,
        c.mass * c.g / mass,
        0.0,
        0.0, //
        0.0,
        (mass + c.mass) * c.g / (mass * l),
        0.0,
        0.0,
    ]);
    assert_close("A", a.as_slice(), expected.as_slice(), 1e-13);
    assert_close("B", b.as_slice(), &[0.0, 0.0, 1.0 / mass, 1.0 / (mass * l)], 1e-13);
}

/// Pendulum that is generic over the scalar type.
#[mechanism(gravity = -g * y, derivatives)]
struct GenericScalarPendulum<T> {
    g: T,
    length: T,
    #[body(mass = 1, com = -length * y, inertia = cuboid(1, 0.1, length, 0.1))]
    rod: Body,
    #[joint(ground -> rod)]
    ball: Ball,
    #[acts(on = rod.at(-length * y), along = ground.x)]
    push: Force,
}

#[test]
fn linearisation_agrees_for_all_scalar_types() {
    let (narrow, wide) = (
        GenericScalarPendulum { g: 9.81_f32, length: 0.4 },
        GenericScalarPendulum { g: 9.81_f64, length: 0.4 },
    );
    let mut random = Random::new(22);
    let q = random.random_configuration(&wide);
    let (v, u) = (random.random_vector::<3>(1.0), random.random_vector::<1>(1.0));
    let (a, b) = narrow.linearize(&q.map(|x| x as f32), &v.map(|x| x as f32), &u.map(|x| x as f32));
    let expected = wide.linearize(&q, &v, &u);
    assert_close_relative_to_largest("A", a.map(f64::from).as_slice(), expected.0.as_slice(), 1e-5);
    assert_close_relative_to_largest("B", b.map(f64::from).as_slice(), expected.1.as_slice(), 1e-5);
}
