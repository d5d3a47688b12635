//! Bodies and particles placed by `at` and `frame`: the forces that enforce their placement act on them and,
//! in reverse, on the bodies that carry them.

use super::check_free_body_diagram_sums;
use linkwork::free_body::Origin;
use linkwork::prelude::*;
use support::random::Random;

/// Arm with a bead that a coordinate moves along it, and a pendulum on the bead. A plate moves on a path that
/// depends on time and a coordinate, with a weight on it.
#[mechanism(gravity = -9.81 * z)]
struct BodiesPlacedByCoordinates {
    slide: Coordinate,
    turn: Coordinate,
    #[body(mass = 2, com = 0.3 * x, inertia = diagonal(0.05, 0.2, 0.2))]
    arm: Body,
    #[joint(ground -> arm, about = (y, z))]
    base: Universal,
    #[particle(mass = 0.7, at = arm.at((0.4 + slide) * x + 0.2 * slide * slide * z))]
    bead: Particle,
    #[body(mass = 0.4, com = -0.2 * z, inertia = rod(0.4, 0.4, z))]
    bob: Body,
    #[joint(bead -> bob, about = (x, y))]
    hook: Universal,
    #[acts(between = (ground.at(0.5 * z), bead), stiffness = 30, free_length = 0.2)]
    cord: Spring,
    #[frame(ground, z(turn), x(0.3 * sin(2 * t)))]
    axes: Frame,
    #[body(
        mass = 1.5, com = 0.1 * y, inertia = diagonal(0.02, 0.03, 0.04), frame = axes,
        at = cos(turn) * x + 0.3 * t * z
    )]
    plate: Body,
    #[particle(mass = 0.3, at = plate.at(0.2 * x))]
    weight: Particle,
    #[acts(on = plate.at(0.2 * y), along = x)]
    push: Force,

    #[output(arm)]
    on_arm: FreeBody,
    #[output(momentum(arm))]
    p_arm: Vector,
    #[output(angular_momentum(arm / ground))]
    h_arm: Vector,
    #[output(center_of_mass(arm / ground))]
    c_arm: Vector,
    #[output(bead)]
    on_bead: FreeBody,
    #[output(momentum(bead))]
    p_bead: Vector,
    #[output(angular_momentum(bead / ground))]
    h_bead: Vector,
    #[output(center_of_mass(bead / ground))]
    c_bead: Vector,
    #[output(plate)]
    on_plate: FreeBody,
    #[output(momentum((plate, weight)))]
    p_plate: Vector,
    #[output(angular_momentum((plate, weight) / ground))]
    h_plate: Vector,
    #[output(center_of_mass((plate, weight) / ground))]
    c_plate: Vector,
}

#[test]
fn free_body_diagrams_include_reactions_of_placed_elements() {
    let m = BodiesPlacedByCoordinates {};
    let mut random = Random::new(12);
    for t in [0.0, 0.4, 1.3] {
        let q = m.integrate(&m.neutral(), &random.random_vector(0.7));
        let (v, u) = (random.random_vector(1.5), random.random_vector(4.0));
        let a = m.forward_dynamics(t, &q, &v, &m.generalized_forces(t, &q, &u));
        let state_after = |h: f64| (m.integrate(&q, &(v * h + a * (0.5 * h * h))), v + a * h);
        check_free_body_diagram_sums(&m.on_arm(t, &q, &v, &u), |h| {
            let (q, v) = state_after(h);
            [m.p_arm(t + h, &q, &v), m.h_arm(t + h, &q, &v), m.c_arm(t + h, &q)]
        });
        check_free_body_diagram_sums(&m.on_bead(t, &q, &v, &u), |h| {
            let (q, v) = state_after(h);
            [m.p_bead(t + h, &q, &v), m.h_bead(t + h, &q, &v), m.c_bead(t + h, &q)]
        });
        check_free_body_diagram_sums(&m.on_plate(t, &q, &v, &u), |h| {
            let (q, v) = state_after(h);
            [m.p_plate(t + h, &q, &v), m.h_plate(t + h, &q, &v), m.c_plate(t + h, &q)]
        });
        let (on_arm, on_bead) = (m.on_arm(t, &q, &v, &u), m.on_bead(t, &q, &v, &u));
        let names_of_actions = |actions: &[linkwork::free_body::Action<f64>]| -> Vec<&str> {
            actions.iter().map(|action| action.name).collect()
        };
        assert_eq!(names_of_actions(&on_arm.actions), ["gravity", "base", "bead.place"]);
        assert_eq!(names_of_actions(&on_bead.actions), ["gravity", "cord", "hook", "bead.place"]);
        assert_eq!(names_of_actions(&m.on_plate(t, &q, &v, &u).actions), ["gravity", "push", "plate.place"]);
        // The bead's reaction on the arm is opposite to the arm's force on the bead; the placement of a point
        // has no torque.
        let (here, there) =
            (on_bead.get("bead.place").expect("it is held"), on_arm.get("bead.place").expect("it is held"));
        assert_eq!(here.origin, Origin::Constraint);
        assert!((here.force + there.force).norm() < 1e-9 && here.torque.norm() < 1e-9);
        // Along the bead's free direction the placement exerts no force.
        let bead_position =
            |x: f64| m.c_bead(t, &(q + SVector::from_fn(|k, _| if k == 0 { x } else { 0.0 })));
        let tangent = (bead_position(1e-5) - bead_position(-1e-5)).normalize();
        assert!(here.force.dot(&tangent).abs() < 1e-6 * (1.0 + here.force.norm()));
    }
}
