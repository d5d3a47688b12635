//! Compiled mechanisms with free bodies whose inertia depends on the ground's motion: their derivatives are
//! limits of differences, also with prepared parameters and in the linearisation.

use linkwork::mechanism;
use linkwork::nalgebra::{SMatrix, SVector};
use support::random::Random;

/// Free rigid body that an inerter connects to the ground.
#[mechanism(gravity = -9.81 * z, derivatives, prepare)]
struct BodyOnInerter {
    inertance: f64,
    #[body(mass = 1, inertia = diagonal(0.1, 0.2, 0.3))]
    hull: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[acts(between = (ground.at(2 * x), hull.at(0.3 * y)), inertance = inertance)]
    mooring: Inerter,
    #[acts(on = hull.at(0.2 * z), along = x)]
    engine: Force,
}

/// Particle on a body, placed along an axis of the ground.
#[mechanism(gravity = -9.81 * z, derivatives, prepare)]
struct BodyWithPlacedParticle {
    mass: f64,
    way: Coordinate,
    #[body(mass = 1, inertia = diagonal(0.1, 0.2, 0.3))]
    hull: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[particle(mass = mass, at = hull.at(way * ground.x + 0.3 * ground.y))]
    load: Particle,
    #[acts(on = way)]
    winch: Force,
}

/// Inerter between two bodies, large enough that generated functions call each other.
#[mechanism(gravity = -9.81 * z, derivatives, prepare)]
struct InerterBetweenBodies {
    inertance: f64,
    #[body(mass = 1, inertia = diagonal(0.1, 0.2, 0.3))]
    tug: Body,
    #[joint(ground -> tug)]
    course: Free,
    #[body(mass = 2, inertia = diagonal(0.4, 0.2, 0.3))]
    ship: Body,
    #[joint(ground.at(3 * y).rotated(x(0.4)) -> ship)]
    drift: Free,
    #[body(mass = 0.5, com = 0.2 * x, inertia = rod(0.5, 0.4, x))]
    crane: Body,
    #[joint(ship.at(0.3 * z) -> crane, about = z)]
    slewing: Pin,
    #[acts(between = (tug.at(0.2 * x), crane.at(0.3 * x)), inertance = inertance)]
    tow: Inerter,
    #[acts(on = slewing)]
    motor: Torque,
}

/// Returns the derivatives of `f` by differences, a column for each direction.
fn difference_columns<const N: usize>(f: impl Fn(&SVector<f64, N>) -> SVector<f64, N>) -> SMatrix<f64, N, N> {
    const STEP: f64 = 1e-5;
    let difference_column = |k: usize| {
        let step = SVector::from_fn(|i, _| if i == k { STEP } else { 0.0 });
        (f(&step) - f(&-step)) / (2.0 * STEP)
    };
    SMatrix::from_columns(&std::array::from_fn::<_, N, _>(difference_column))
}

macro_rules! free_body {
    ($test:ident, $mechanism:expr, $type:ident) => {
        #[test]
        fn $test() {
            const NV: usize = $type::NV;
            let (m, mut random) = ($mechanism, Random::new(11));
            let prepared = m.prepare();
            for _ in 0..5 {
                let q = random.random_configuration(&m);
                let (v, tau) = (random.random_vector::<NV>(1.0), random.random_vector::<NV>(2.0));
                let assert_near = |what: &str, found: &SMatrix<f64, NV, NV>, limit: &SMatrix<f64, NV, NV>| {
                    let error = (found - limit).amax() / (1.0 + limit.amax());
                    assert!(error < 1e-7, "{what}: off by {error:e}");
                };
                let by_q = difference_columns(|e| m.forward_dynamics(&m.integrate(&q, e), &v, &tau));
                let by_v = difference_columns(|e| m.forward_dynamics(&q, &(v + e), &tau));
                let found = m.forward_dynamics_derivatives(&q, &v, &tau);
                assert_near("∂v̇/∂q", &found.0, &by_q);
                assert_near("∂v̇/∂v", &found.1, &by_v);
                let found = prepared.forward_dynamics_derivatives(&q, &v, &tau);
                assert_near("∂v̇/∂q, prepared", &found.0, &by_q);
                assert_near("∂v̇/∂v, prepared", &found.1, &by_v);
                let u = random.random_vector::<{ $type::NU }>(2.0);
                let acceleration_at_state =
                    |q: &_, v: &_| m.forward_dynamics(q, v, &m.generalized_forces(q, &u));
                let by_q = difference_columns(|e| acceleration_at_state(&m.integrate(&q, e), &v));
                let by_v = difference_columns(|e| acceleration_at_state(&q, &(v + e)));
                let (a, _) = m.linearize(&q, &v, &u);
                let block_of_state_matrix = |column: usize| a.fixed_view::<NV, NV>(NV, column).into_owned();
                assert_near("linearised by q", &block_of_state_matrix(0), &by_q);
                assert_near("linearised by v", &block_of_state_matrix(NV), &by_v);
            }
        }
    };
}

free_body!(an_inerter_to_the_ground_sees_where_a_body_is, BodyOnInerter { inertance: 0.5 }, BodyOnInerter);
free_body!(
    a_particle_along_axes_of_the_ground_sees_how_a_body_turns,
    BodyWithPlacedParticle { mass: 0.7 },
    BodyWithPlacedParticle
);
free_body!(
    an_inerter_between_bodies_couples_them,
    InerterBetweenBodies { inertance: 0.6 },
    InerterBetweenBodies
);
