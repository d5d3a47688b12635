//! Checks of energies, motion and derivatives of a trampoline, a deck on many springs.

use super::{STEP, potential_gradient, unit_vector};
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use support::compare::{assert_close, assert_close_relative_to_largest, assert_same_dynamics};
use support::differences::derivative_at_zero;
use support::random::Random;

/// Deck on springs and dashpots around it, with a swinging arm.
#[mechanism(gravity = -9.81 * z, derivatives, prepare)]
struct Trampoline<T> {
    k: T,
    c: T,
    #[body(mass = 4, inertia = cuboid(4, 1, 0.8, 0.1))]
    deck: Body,
    #[body(mass = 1, com = 0.2 * x, inertia = rod(1, 0.4, x))]
    arm: Body,
    #[joint(ground -> deck)]
    pose: Free,
    #[joint(deck.at(0.1 * z) -> arm, about = y)]
    hinge: Pin,
    #[acts(on = hinge)]
    motor: Torque,
    #[acts(between = (ground.at(x + z), deck.at(0.5 * x)), damping = c)]
    first: Dashpot,
    #[acts(between = (ground.at(y - z), arm.at(0.4 * x)), damping = 2 * c)]
    second: Dashpot,
    #[acts(
        between = (ground.at([1.50, 0.00, -0.40]), deck.at([0.57, 0.15, 0.00])), stiffness = k * 1.0,
        free_length = 0.50
    )]
    spring0: Spring,
    #[acts(
        between = (ground.at([1.49, 0.14, -0.45]), deck.at([0.55, 0.20, 0.10])), stiffness = k * 1.1,
        free_length = 0.52
    )]
    spring1: Spring,
    #[acts(
        between = (ground.at([1.46, 0.28, -0.50]), deck.at([0.52, 0.25, 0.00])), stiffness = k * 1.2,
        free_length = 0.54
    )]
    spring2: Spring,
    #[acts(
        between = (ground.at([1.41, 0.41, -0.40]), deck.at([0.48, 0.30, 0.10])), stiffness = k * 1.3,
        free_length = 0.56
    )]
    spring3: Spring,
    #[acts(
        between = (ground.at([1.34, 0.54, -0.45]), deck.at([0.43, 0.35, 0.00])), stiffness = k * 1.4,
        free_length = 0.58
    )]
    spring4: Spring,
    #[acts(
        between = (ground.at([1.25, 0.66, -0.50]), deck.at([0.38, 0.39, 0.10])), stiffness = k * 1.0,
        free_length = 0.60
    )]
    spring5: Spring,
    #[acts(
        between = (ground.at([1.15, 0.77, -0.40]), deck.at([0.33, 0.42, 0.00])), stiffness = k * 1.1,
        free_length = 0.62
    )]
    spring6: Spring,
    #[acts(
        between = (ground.at([1.03, 0.87, -0.45]), deck.at([0.26, 0.45, 0.10])), stiffness = k * 1.2,
        free_length = 0.50
    )]
    spring7: Spring,
    #[acts(
        between = (ground.at([0.90, 0.96, -0.50]), deck.at([0.20, 0.47, 0.00])), stiffness = k * 1.3,
        free_length = 0.52
    )]
    spring8: Spring,
    #[acts(
        between = (ground.at([0.75, 1.04, -0.40]), deck.at([0.13, 0.49, 0.10])), stiffness = k * 1.4,
        free_length = 0.54
    )]
    spring9: Spring,
    #[acts(
        between = (ground.at([0.59, 1.10, -0.45]), deck.at([0.06, 0.50, 0.00])), stiffness = k * 1.0,
        free_length = 0.56
    )]
    spring10: Spring,
    #[acts(
        between = (ground.at([0.43, 1.15, -0.50]), deck.at([-0.01, 0.50, 0.10])), stiffness = k * 1.1,
        free_length = 0.58
    )]
    spring11: Spring,
    #[acts(
        between = (ground.at([0.26, 1.18, -0.40]), deck.at([-0.08, 0.50, 0.00])), stiffness = k * 1.2,
        free_length = 0.60
    )]
    spring12: Spring,
    #[acts(
        between = (ground.at([0.09, 1.20, -0.45]), deck.at([-0.14, 0.49, 0.10])), stiffness = k * 1.3,
        free_length = 0.62
    )]
    spring13: Spring,
    #[acts(
        between = (ground.at([-0.09, 1.20, -0.50]), deck.at([-0.21, 0.47, 0.00])), stiffness = k * 1.4,
        free_length = 0.50
    )]
    spring14: Spring,
    #[acts(
        between = (ground.at([-0.26, 1.18, -0.40]), deck.at([-0.27, 0.44, 0.10])), stiffness = k * 1.0,
        free_length = 0.52
    )]
    spring15: Spring,
    #[acts(
        between = (ground.at([-0.43, 1.15, -0.45]), deck.at([-0.33, 0.42, 0.00])), stiffness = k * 1.1,
        free_length = 0.54
    )]
    spring16: Spring,
    #[acts(
        between = (ground.at([-0.59, 1.10, -0.50]), deck.at([-0.39, 0.38, 0.10])), stiffness = k * 1.2,
        free_length = 0.56
    )]
    spring17: Spring,
    #[acts(
        between = (ground.at([-0.75, 1.04, -0.40]), deck.at([-0.44, 0.34, 0.00])), stiffness = k * 1.3,
        free_length = 0.58
    )]
    spring18: Spring,
    #[acts(
        between = (ground.at([-0.90, 0.96, -0.45]), deck.at([-0.48, 0.29, 0.10])), stiffness = k * 1.4,
        free_length = 0.60
    )]
    spring19: Spring,
    #[acts(
        between = (ground.at([-1.03, 0.87, -0.50]), deck.at([-0.52, 0.25, 0.00])), stiffness = k * 1.0,
        free_length = 0.62
    )]
    spring20: Spring,
    #[acts(
        between = (ground.at([-1.15, 0.77, -0.40]), deck.at([-0.55, 0.19, 0.10])), stiffness = k * 1.1,
        free_length = 0.50
    )]
    spring21: Spring,
    #[acts(
        between = (ground.at([-1.25, 0.66, -0.45]), deck.at([-0.58, 0.14, 0.00])), stiffness = k * 1.2,
        free_length = 0.52
    )]
    spring22: Spring,
    #[acts(
        between = (ground.at([-1.34, 0.54, -0.50]), deck.at([-0.59, 0.08, 0.10])), stiffness = k * 1.3,
        free_length = 0.54
    )]
    spring23: Spring,
    #[acts(
        between = (ground.at([-1.41, 0.41, -0.40]), deck.at([-0.60, 0.02, 0.00])), stiffness = k * 1.4,
        free_length = 0.56
    )]
    spring24: Spring,
    #[acts(
        between = (ground.at([-1.46, 0.28, -0.45]), deck.at([-0.60, -0.03, 0.10])), stiffness = k * 1.0,
        free_length = 0.58
    )]
    spring25: Spring,
    #[acts(
        between = (ground.at([-1.49, 0.14, -0.50]), deck.at([-0.59, -0.09, 0.00])), stiffness = k * 1.1,
        free_length = 0.60
    )]
    spring26: Spring,
    #[acts(
        between = (ground.at([-1.50, 0.00, -0.40]), deck.at([-0.57, -0.15, 0.10])), stiffness = k * 1.2,
        free_length = 0.62
    )]
    spring27: Spring,
    #[acts(
        between = (ground.at([-1.49, -0.14, -0.45]), deck.at([-0.55, -0.20, 0.00])), stiffness = k * 1.3,
        free_length = 0.50
    )]
    spring28: Spring,
    #[acts(
        between = (ground.at([-1.46, -0.28, -0.50]), deck.at([-0.52, -0.25, 0.10])), stiffness = k * 1.4,
        free_length = 0.52
    )]
    spring29: Spring,
    #[acts(
        between = (ground.at([-1.41, -0.41, -0.40]), deck.at([-0.48, -0.30, 0.00])), stiffness = k * 1.0,
        free_length = 0.54
    )]
    spring30: Spring,
    #[acts(
        between = (ground.at([-1.34, -0.54, -0.45]), deck.at([-0.43, -0.35, 0.10])), stiffness = k * 1.1,
        free_length = 0.56
    )]
    spring31: Spring,
    #[acts(
        between = (ground.at([-1.25, -0.66, -0.50]), deck.at([-0.38, -0.39, 0.00])), stiffness = k * 1.2,
        free_length = 0.58
    )]
    spring32: Spring,
    #[acts(
        between = (ground.at([-1.15, -0.77, -0.40]), deck.at([-0.33, -0.42, 0.10])), stiffness = k * 1.3,
        free_length = 0.60
    )]
    spring33: Spring,
    #[acts(
        between = (ground.at([-1.03, -0.87, -0.45]), deck.at([-0.26, -0.45, 0.00])), stiffness = k * 1.4,
        free_length = 0.62
    )]
    spring34: Spring,
    #[acts(
        between = (ground.at([-0.90, -0.96, -0.50]), deck.at([-0.20, -0.47, 0.10])), stiffness = k * 1.0,
        free_length = 0.50
    )]
    spring35: Spring,
    #[acts(
        between = (ground.at([-0.75, -1.04, -0.40]), deck.at([-0.13, -0.49, 0.00])), stiffness = k * 1.1,
        free_length = 0.52
    )]
    spring36: Spring,
    #[acts(
        between = (ground.at([-0.59, -1.10, -0.45]), deck.at([-0.06, -0.50, 0.10])), stiffness = k * 1.2,
        free_length = 0.54
    )]
    spring37: Spring,
    #[acts(
        between = (ground.at([-0.43, -1.15, -0.50]), deck.at([0.01, -0.50, 0.00])), stiffness = k * 1.3,
        free_length = 0.56
    )]
    spring38: Spring,
    #[acts(
        between = (ground.at([-0.26, -1.18, -0.40]), deck.at([0.08, -0.50, 0.10])), stiffness = k * 1.4,
        free_length = 0.58
    )]
    spring39: Spring,
    #[acts(
        between = (ground.at([-0.09, -1.20, -0.45]), deck.at([0.14, -0.49, 0.00])), stiffness = k * 1.0,
        free_length = 0.60
    )]
    spring40: Spring,
    #[acts(
        between = (ground.at([0.09, -1.20, -0.50]), deck.at([0.21, -0.47, 0.10])), stiffness = k * 1.1,
        free_length = 0.62
    )]
    spring41: Spring,
    #[acts(
        between = (ground.at([0.26, -1.18, -0.40]), deck.at([0.27, -0.44, 0.00])), stiffness = k * 1.2,
        free_length = 0.50
    )]
    spring42: Spring,
    #[acts(
        between = (ground.at([0.43, -1.15, -0.45]), deck.at([0.33, -0.42, 0.10])), stiffness = k * 1.3,
        free_length = 0.52
    )]
    spring43: Spring,
    #[acts(
        between = (ground.at([0.59, -1.10, -0.50]), deck.at([0.39, -0.38, 0.00])), stiffness = k * 1.4,
        free_length = 0.54
    )]
    spring44: Spring,
    #[acts(
        between = (ground.at([0.75, -1.04, -0.40]), deck.at([0.44, -0.34, 0.10])), stiffness = k * 1.0,
        free_length = 0.56
    )]
    spring45: Spring,
    #[acts(
        between = (ground.at([0.90, -0.96, -0.45]), deck.at([0.48, -0.29, 0.00])), stiffness = k * 1.1,
        free_length = 0.58
    )]
    spring46: Spring,
    #[acts(
        between = (ground.at([1.03, -0.87, -0.50]), deck.at([0.52, -0.25, 0.10])), stiffness = k * 1.2,
        free_length = 0.60
    )]
    spring47: Spring,
    #[acts(
        between = (ground.at([1.15, -0.77, -0.40]), deck.at([0.55, -0.19, 0.00])), stiffness = k * 1.3,
        free_length = 0.62
    )]
    spring48: Spring,
    #[acts(
        between = (ground.at([1.25, -0.66, -0.45]), deck.at([0.58, -0.14, 0.10])), stiffness = k * 1.4,
        free_length = 0.50
    )]
    spring49: Spring,
    #[acts(
        between = (ground.at([1.34, -0.54, -0.50]), deck.at([0.59, -0.08, 0.00])), stiffness = k * 1.0,
        free_length = 0.52
    )]
    spring50: Spring,
    #[acts(
        between = (ground.at([1.41, -0.41, -0.40]), deck.at([0.60, -0.02, 0.10])), stiffness = k * 1.1,
        free_length = 0.54
    )]
    spring51: Spring,
    #[acts(
        between = (ground.at([1.46, -0.28, -0.45]), deck.at([0.60, 0.03, 0.00])), stiffness = k * 1.2,
        free_length = 0.56
    )]
    spring52: Spring,
    #[acts(
        between = (ground.at([1.49, -0.14, -0.50]), deck.at([0.59, 0.09, 0.10])), stiffness = k * 1.3,
        free_length = 0.58
    )]
    spring53: Spring,
}

fn sample_trampoline() -> Trampoline<f64> {
    Trampoline { k: 30.0, c: 0.7 }
}

#[test]
fn spring_forces_are_gradients_of_the_stored_energy() {
    let m = sample_trampoline();
    let mut random = Random::new(31);
    for _ in 0..5 {
        let q = random.random_configuration(&m);
        let v: SVector<f64, 7> = random.random_vector(2.0);
        assert_close_relative_to_largest(
            "∂U/∂q",
            m.bias_forces(&q, &SVector::zeros()).as_slice(),
            potential_gradient(&m, &q).as_slice(),
            1e-9,
        );
        // Only the damping forces are odd in the velocities.
        let odd = (m.bias_forces(&q, &v) - m.bias_forces(&q, &-v)) * 0.5;
        assert_close("power", &[v.dot(&odd)], &[m.dissipated_power(&q, &v)], 1e-10);
        // The shared function of passive forces agrees.
        let passive = (m.__passive_forces(&q, &v) - m.__passive_forces(&q, &-v)) * 0.5;
        assert_close("dashpots", passive.as_slice(), odd.as_slice(), 1e-10);
    }
}

#[test]
fn all_functions_agree_for_many_springs() {
    let m = sample_trampoline();
    let mut random = Random::new(32);
    for _ in 0..5 {
        let q = random.random_configuration(&m);
        let [v, tau]: [SVector<f64, 7>; 2] = [random.random_vector(2.0), random.random_vector(3.0)];
        let a = m.forward_dynamics(&q, &v, &tau);
        assert_close("τ", (m.mass_matrix(&q) * a + m.bias_forces(&q, &v)).as_slice(), tau.as_slice(), 1e-9);
        assert_close("τ", m.inverse_dynamics(&q, &v, &a).as_slice(), tau.as_slice(), 1e-9);
        let rate = derivative_at_zero(STEP, |s| {
            m.generalized_momentum(&m.integrate(&q, &(v * s + a * (s * s / 2.0))), &(v + a * s))
        });
        assert_close_relative_to_largest(
            "ṗ",
            (m.momentum_rate(&q, &v) + tau).as_slice(),
            rate.as_slice(),
            1e-6,
        );
    }
}

#[test]
fn derivatives_include_the_dependencies_of_passive_forces() {
    let m = sample_trampoline();
    let mut random = Random::new(33);
    for _ in 0..3 {
        let q = random.random_configuration(&m);
        let [v, a]: [SVector<f64, 7>; 2] = [random.random_vector(1.0), random.random_vector(1.0)];
        let tau = m.inverse_dynamics(&q, &v, &a);
        let (by_q, by_v) = m.inverse_dynamics_derivatives(&q, &v, &a);
        let (of_a_by_q, of_a_by_v, _) = m.forward_dynamics_derivatives(&q, &v, &tau);
        for i in 0..7 {
            let displaced_configuration = |s: f64| m.integrate(&q, &(unit_vector::<7>(i) * s));
            let perturbed_velocity = |s: f64| v + unit_vector::<7>(i) * s;
            let columns = [
                (
                    "∂τ/∂q",
                    by_q.column(i),
                    derivative_at_zero(STEP, |s| m.inverse_dynamics(&displaced_configuration(s), &v, &a)),
                ),
                (
                    "∂τ/∂v",
                    by_v.column(i),
                    derivative_at_zero(STEP, |s| m.inverse_dynamics(&q, &perturbed_velocity(s), &a)),
                ),
                (
                    "∂v̇/∂q",
                    of_a_by_q.column(i),
                    derivative_at_zero(STEP, |s| m.forward_dynamics(&displaced_configuration(s), &v, &tau)),
                ),
                (
                    "∂v̇/∂v",
                    of_a_by_v.column(i),
                    derivative_at_zero(STEP, |s| m.forward_dynamics(&q, &perturbed_velocity(s), &tau)),
                ),
            ];
            for (what, column, expected) in columns {
                assert_close_relative_to_largest(what, column.as_slice(), expected.as_slice(), 1e-8);
            }
        }
        let u = SVector::from([0.3]);
        let (state, _) = m.linearize(&q, &v, &u);
        let (by_q, by_v, _) = m.forward_dynamics_derivatives(&q, &v, &m.generalized_forces(&q, &u));
        assert_close(
            "∂q of A",
            state.fixed_view::<7, 7>(7, 0).clone_owned().as_slice(),
            by_q.as_slice(),
            1e-9,
        );
        assert_close(
            "∂v of A",
            state.fixed_view::<7, 7>(7, 7).clone_owned().as_slice(),
            by_v.as_slice(),
            1e-9,
        );
    }
}

#[test]
fn prepared_trampoline_equals_the_trampoline() {
    assert_same_dynamics(&sample_trampoline().prepare(), &sample_trampoline(), 5, 1e-10);
    let single = Trampoline::<f32> { k: 30.0, c: 0.7 };
    let h = single.bias_forces(&single.neutral(), &SVector::from_element(0.1));
    let exact = sample_trampoline().bias_forces(&sample_trampoline().neutral(), &SVector::from_element(0.1));
    assert_close_relative_to_largest("single precision", h.cast::<f64>().as_slice(), exact.as_slice(), 1e-5);
}
