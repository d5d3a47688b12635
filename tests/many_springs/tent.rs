//! Tent: constraints, and springs whose ends are driven as functions of time.

use super::potential_gradient;
use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork::{Mechanism, at};
use support::compare::{assert_close, assert_close_relative_to_largest};
use support::random::Random;

/// Planar four-bar linkage with springs whose ends lie outside its plane, and a torque that depends on time.
#[mechanism(gravity = -9.81 * y)]
struct DrivenBarsWithSpatialSprings {
    k: f64,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    crank: Body,
    #[body(mass = 2, com = x, inertia = rod(2, 2, x))]
    coupler: Body,
    #[body(mass = 2, com = x, inertia = rod(2, 2, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    input: Pin,
    #[joint(crank.at(x) -> coupler, about = z)]
    middle: Pin,
    #[joint(ground.at(2 * x) -> rocker, about = z)]
    output: Pin,
    #[joint(coupler.at(2 * x) -> rocker.at(2 * x), about = z)]
    last: Pin,
    #[acts(on = input, value = 3 * sin(t))]
    drive: Torque,
    #[acts(
        between = (ground.at([1.50, 0.00, -0.40]), coupler.at([0.57, 0.15, 0.00])), stiffness = k * 1.0,
        free_length = 0.50
    )]
    spring0: Spring,
    #[acts(
        between = (ground.at([1.50, 0.08, -0.45]), coupler.at([0.56, 0.18, 0.10])), stiffness = k * 1.1,
        free_length = 0.52
    )]
    spring1: Spring,
    #[acts(
        between = (ground.at([1.49, 0.17, -0.50]), coupler.at([0.54, 0.21, 0.00])), stiffness = k * 1.2,
        free_length = 0.54
    )]
    spring2: Spring,
    #[acts(
        between = (ground.at([1.47, 0.25, -0.40]), coupler.at([0.52, 0.24, 0.10])), stiffness = k * 1.3,
        free_length = 0.56
    )]
    spring3: Spring,
    #[acts(
        between = (ground.at([1.44, 0.33, -0.45]), coupler.at([0.50, 0.27, 0.00])), stiffness = k * 1.4,
        free_length = 0.58
    )]
    spring4: Spring,
    #[acts(
        between = (ground.at([1.41, 0.41, -0.50]), coupler.at([0.48, 0.30, 0.10])), stiffness = k * 1.0,
        free_length = 0.60
    )]
    spring5: Spring,
    #[acts(
        between = (ground.at([1.37, 0.49, -0.40]), coupler.at([0.45, 0.33, 0.00])), stiffness = k * 1.1,
        free_length = 0.62
    )]
    spring6: Spring,
    #[acts(
        between = (ground.at([1.32, 0.56, -0.45]), coupler.at([0.42, 0.35, 0.10])), stiffness = k * 1.2,
        free_length = 0.50
    )]
    spring7: Spring,
    #[acts(
        between = (ground.at([1.27, 0.64, -0.50]), coupler.at([0.39, 0.38, 0.00])), stiffness = k * 1.3,
        free_length = 0.52
    )]
    spring8: Spring,
    #[acts(
        between = (ground.at([1.21, 0.71, -0.40]), coupler.at([0.36, 0.40, 0.10])), stiffness = k * 1.4,
        free_length = 0.54
    )]
    spring9: Spring,
    #[acts(
        between = (ground.at([1.15, 0.77, -0.45]), coupler.at([0.33, 0.42, 0.00])), stiffness = k * 1.0,
        free_length = 0.56
    )]
    spring10: Spring,
    #[acts(
        between = (ground.at([1.08, 0.83, -0.50]), coupler.at([0.29, 0.44, 0.10])), stiffness = k * 1.1,
        free_length = 0.58
    )]
    spring11: Spring,
    #[acts(
        between = (ground.at([1.00, 0.89, -0.40]), coupler.at([0.25, 0.45, 0.00])), stiffness = k * 1.2,
        free_length = 0.60
    )]
    spring12: Spring,
    #[acts(
        between = (ground.at([0.92, 0.95, -0.45]), coupler.at([0.21, 0.47, 0.10])), stiffness = k * 1.3,
        free_length = 0.62
    )]
    spring13: Spring,
    #[acts(
        between = (ground.at([0.84, 0.99, -0.50]), coupler.at([0.17, 0.48, 0.00])), stiffness = k * 1.4,
        free_length = 0.50
    )]
    spring14: Spring,
    #[acts(
        between = (ground.at([0.75, 1.04, -0.40]), coupler.at([0.13, 0.49, 0.10])), stiffness = k * 1.0,
        free_length = 0.52
    )]
    spring15: Spring,
    #[acts(
        between = (ground.at([0.66, 1.08, -0.45]), coupler.at([0.09, 0.49, 0.00])), stiffness = k * 1.1,
        free_length = 0.54
    )]
    spring16: Spring,
    #[acts(
        between = (ground.at([0.56, 1.11, -0.50]), coupler.at([0.05, 0.50, 0.10])), stiffness = k * 1.2,
        free_length = 0.56
    )]
    spring17: Spring,
    #[acts(
        between = (ground.at([0.46, 1.14, -0.40]), coupler.at([0.01, 0.50, 0.00])), stiffness = k * 1.3,
        free_length = 0.58
    )]
    spring18: Spring,
    #[acts(
        between = (ground.at([0.36, 1.16, -0.45]), coupler.at([-0.03, 0.50, 0.10])), stiffness = k * 1.4,
        free_length = 0.60
    )]
    spring19: Spring,
    #[acts(
        between = (ground.at([0.26, 1.18, -0.50]), coupler.at([-0.08, 0.50, 0.00])), stiffness = k * 1.0,
        free_length = 0.62
    )]
    spring20: Spring,
    #[acts(
        between = (ground.at([0.16, 1.19, -0.40]), coupler.at([-0.12, 0.49, 0.10])), stiffness = k * 1.1,
        free_length = 0.50
    )]
    spring21: Spring,
    #[acts(
        between = (ground.at([0.05, 1.20, -0.45]), coupler.at([-0.16, 0.48, 0.00])), stiffness = k * 1.2,
        free_length = 0.52
    )]
    spring22: Spring,
    #[acts(
        between = (ground.at([-0.05, 1.20, -0.50]), coupler.at([-0.20, 0.47, 0.10])), stiffness = k * 1.3,
        free_length = 0.54
    )]
    spring23: Spring,
    #[acts(
        between = (ground.at([-0.16, 1.19, -0.40]), coupler.at([-0.24, 0.46, 0.00])), stiffness = k * 1.4,
        free_length = 0.56
    )]
    spring24: Spring,
    #[acts(
        between = (ground.at([-0.26, 1.18, -0.45]), coupler.at([-0.27, 0.44, 0.10])), stiffness = k * 1.0,
        free_length = 0.58
    )]
    spring25: Spring,
    #[acts(
        between = (ground.at([-0.36, 1.16, -0.50]), coupler.at([-0.31, 0.43, 0.00])), stiffness = k * 1.1,
        free_length = 0.60
    )]
    spring26: Spring,
    #[acts(
        between = (ground.at([-0.46, 1.14, -0.40]), coupler.at([-0.35, 0.41, 0.10])), stiffness = k * 1.2,
        free_length = 0.62
    )]
    spring27: Spring,
    #[acts(
        between = (ground.at([-0.56, 1.11, -0.45]), coupler.at([-0.38, 0.39, 0.00])), stiffness = k * 1.3,
        free_length = 0.50
    )]
    spring28: Spring,
    #[acts(
        between = (ground.at([-0.66, 1.08, -0.50]), coupler.at([-0.41, 0.36, 0.10])), stiffness = k * 1.4,
        free_length = 0.52
    )]
    spring29: Spring,
    #[acts(
        between = (ground.at([-0.75, 1.04, -0.40]), coupler.at([-0.44, 0.34, 0.00])), stiffness = k * 1.0,
        free_length = 0.54
    )]
    spring30: Spring,
    #[acts(
        between = (ground.at([-0.84, 0.99, -0.45]), coupler.at([-0.47, 0.31, 0.10])), stiffness = k * 1.1,
        free_length = 0.56
    )]
    spring31: Spring,
    #[acts(
        between = (ground.at([-0.92, 0.95, -0.50]), coupler.at([-0.49, 0.29, 0.00])), stiffness = k * 1.2,
        free_length = 0.58
    )]
    spring32: Spring,
    #[acts(
        between = (ground.at([-1.00, 0.89, -0.40]), coupler.at([-0.52, 0.26, 0.10])), stiffness = k * 1.3,
        free_length = 0.60
    )]
    spring33: Spring,
    #[acts(
        between = (ground.at([-1.08, 0.83, -0.45]), coupler.at([-0.54, 0.23, 0.00])), stiffness = k * 1.4,
        free_length = 0.62
    )]
    spring34: Spring,
    #[acts(
        between = (ground.at([-1.15, 0.77, -0.50]), coupler.at([-0.55, 0.19, 0.10])), stiffness = k * 1.0,
        free_length = 0.50
    )]
    spring35: Spring,
    #[acts(
        between = (ground.at([-1.21, 0.71, -0.40]), coupler.at([-0.57, 0.16, 0.00])), stiffness = k * 1.1,
        free_length = 0.52
    )]
    spring36: Spring,
    #[acts(
        between = (ground.at([-1.27, 0.64, -0.45]), coupler.at([-0.58, 0.13, 0.10])), stiffness = k * 1.2,
        free_length = 0.54
    )]
    spring37: Spring,
    #[acts(
        between = (ground.at([-1.32, 0.56, -0.50]), coupler.at([-0.59, 0.09, 0.00])), stiffness = k * 1.3,
        free_length = 0.56
    )]
    spring38: Spring,
    #[acts(
        between = (ground.at([-1.37, 0.49, -0.40]), coupler.at([-0.60, 0.06, 0.10])), stiffness = k * 1.4,
        free_length = 0.58
    )]
    spring39: Spring,
    #[acts(
        between = (ground.at([-1.41, 0.41, -0.45]), coupler.at([-0.60, 0.02, 0.00])), stiffness = k * 1.0,
        free_length = 0.60
    )]
    spring40: Spring,
    #[acts(
        between = (ground.at([-1.44, 0.33, -0.50]), coupler.at([-0.60, -0.01, 0.10])), stiffness = k * 1.1,
        free_length = 0.62
    )]
    spring41: Spring,
    #[acts(
        between = (ground.at([-1.47, 0.25, -0.40]), coupler.at([-0.60, -0.05, 0.00])), stiffness = k * 1.2,
        free_length = 0.50
    )]
    spring42: Spring,
    #[acts(
        between = (ground.at([-1.49, 0.17, -0.45]), coupler.at([-0.59, -0.08, 0.10])), stiffness = k * 1.3,
        free_length = 0.52
    )]
    spring43: Spring,
    #[acts(
        between = (ground.at([-1.50, 0.08, -0.50]), coupler.at([-0.58, -0.11, 0.00])), stiffness = k * 1.4,
        free_length = 0.54
    )]
    spring44: Spring,
    #[acts(
        between = (ground.at([-1.50, 0.00, -0.40]), coupler.at([-0.57, -0.15, 0.10])), stiffness = k * 1.0,
        free_length = 0.56
    )]
    spring45: Spring,
    #[acts(
        between = (ground.at([-1.50, -0.08, -0.45]), coupler.at([-0.56, -0.18, 0.00])), stiffness = k * 1.1,
        free_length = 0.58
    )]
    spring46: Spring,
    #[acts(
        between = (ground.at([-1.49, -0.17, -0.50]), coupler.at([-0.54, -0.21, 0.10])), stiffness = k * 1.2,
        free_length = 0.60
    )]
    spring47: Spring,
    #[acts(
        between = (ground.at([-1.47, -0.25, -0.40]), coupler.at([-0.52, -0.24, 0.00])), stiffness = k * 1.3,
        free_length = 0.62
    )]
    spring48: Spring,
    #[acts(
        between = (ground.at([-1.44, -0.33, -0.45]), coupler.at([-0.50, -0.27, 0.10])), stiffness = k * 1.4,
        free_length = 0.50
    )]
    spring49: Spring,
    #[acts(
        between = (ground.at([-1.41, -0.41, -0.50]), coupler.at([-0.48, -0.30, 0.00])), stiffness = k * 1.0,
        free_length = 0.52
    )]
    spring50: Spring,
    #[acts(
        between = (ground.at([-1.37, -0.49, -0.40]), coupler.at([-0.45, -0.33, 0.10])), stiffness = k * 1.1,
        free_length = 0.54
    )]
    spring51: Spring,
    #[acts(
        between = (ground.at([-1.32, -0.56, -0.45]), coupler.at([-0.42, -0.35, 0.00])), stiffness = k * 1.2,
        free_length = 0.56
    )]
    spring52: Spring,
    #[acts(
        between = (ground.at([-1.27, -0.64, -0.50]), coupler.at([-0.39, -0.38, 0.10])), stiffness = k * 1.3,
        free_length = 0.58
    )]
    spring53: Spring,
    #[acts(
        between = (ground.at([-1.21, -0.71, -0.40]), coupler.at([-0.36, -0.40, 0.00])), stiffness = k * 1.4,
        free_length = 0.60
    )]
    spring54: Spring,
    #[acts(
        between = (ground.at([-1.15, -0.77, -0.45]), coupler.at([-0.33, -0.42, 0.10])), stiffness = k * 1.0,
        free_length = 0.62
    )]
    spring55: Spring,
    #[acts(
        between = (ground.at([-1.08, -0.83, -0.50]), coupler.at([-0.29, -0.44, 0.00])), stiffness = k * 1.1,
        free_length = 0.50
    )]
    spring56: Spring,
    #[acts(
        between = (ground.at([-1.00, -0.89, -0.40]), coupler.at([-0.25, -0.45, 0.10])), stiffness = k * 1.2,
        free_length = 0.52
    )]
    spring57: Spring,
    #[acts(
        between = (ground.at([-0.92, -0.95, -0.45]), coupler.at([-0.21, -0.47, 0.00])), stiffness = k * 1.3,
        free_length = 0.54
    )]
    spring58: Spring,
    #[acts(
        between = (ground.at([-0.84, -0.99, -0.50]), coupler.at([-0.17, -0.48, 0.10])), stiffness = k * 1.4,
        free_length = 0.56
    )]
    spring59: Spring,
    #[acts(
        between = (ground.at([-0.75, -1.04, -0.40]), coupler.at([-0.13, -0.49, 0.00])), stiffness = k * 1.0,
        free_length = 0.58
    )]
    spring60: Spring,
    #[acts(
        between = (ground.at([-0.66, -1.08, -0.45]), coupler.at([-0.09, -0.49, 0.10])), stiffness = k * 1.1,
        free_length = 0.60
    )]
    spring61: Spring,
    #[acts(
        between = (ground.at([-0.56, -1.11, -0.50]), coupler.at([-0.05, -0.50, 0.00])), stiffness = k * 1.2,
        free_length = 0.62
    )]
    spring62: Spring,
    #[acts(
        between = (ground.at([-0.46, -1.14, -0.40]), coupler.at([-0.01, -0.50, 0.10])), stiffness = k * 1.3,
        free_length = 0.50
    )]
    spring63: Spring,
    #[acts(
        between = (ground.at([-0.36, -1.16, -0.45]), coupler.at([0.03, -0.50, 0.00])), stiffness = k * 1.4,
        free_length = 0.52
    )]
    spring64: Spring,
    #[acts(
        between = (ground.at([-0.26, -1.18, -0.50]), coupler.at([0.08, -0.50, 0.10])), stiffness = k * 1.0,
        free_length = 0.54
    )]
    spring65: Spring,
    #[acts(
        between = (ground.at([-0.16, -1.19, -0.40]), coupler.at([0.12, -0.49, 0.00])), stiffness = k * 1.1,
        free_length = 0.56
    )]
    spring66: Spring,
    #[acts(
        between = (ground.at([-0.05, -1.20, -0.45]), coupler.at([0.16, -0.48, 0.10])), stiffness = k * 1.2,
        free_length = 0.58
    )]
    spring67: Spring,
    #[acts(
        between = (ground.at([0.05, -1.20, -0.50]), coupler.at([0.20, -0.47, 0.00])), stiffness = k * 1.3,
        free_length = 0.60
    )]
    spring68: Spring,
    #[acts(
        between = (ground.at([0.16, -1.19, -0.40]), coupler.at([0.24, -0.46, 0.10])), stiffness = k * 1.4,
        free_length = 0.62
    )]
    spring69: Spring,
    #[acts(
        between = (ground.at([0.26, -1.18, -0.45]), coupler.at([0.27, -0.44, 0.00])), stiffness = k * 1.0,
        free_length = 0.50
    )]
    spring70: Spring,
    #[acts(
        between = (ground.at([0.36, -1.16, -0.50]), coupler.at([0.31, -0.43, 0.10])), stiffness = k * 1.1,
        free_length = 0.52
    )]
    spring71: Spring,
    #[acts(
        between = (ground.at([0.46, -1.14, -0.40]), coupler.at([0.35, -0.41, 0.00])), stiffness = k * 1.2,
        free_length = 0.54
    )]
    spring72: Spring,
    #[acts(
        between = (ground.at([0.56, -1.11, -0.45]), coupler.at([0.38, -0.39, 0.10])), stiffness = k * 1.3,
        free_length = 0.56
    )]
    spring73: Spring,
    #[acts(
        between = (ground.at([0.66, -1.08, -0.50]), coupler.at([0.41, -0.36, 0.00])), stiffness = k * 1.4,
        free_length = 0.58
    )]
    spring74: Spring,
    #[acts(
        between = (ground.at([0.75, -1.04, -0.40]), coupler.at([0.44, -0.34, 0.10])), stiffness = k * 1.0,
        free_length = 0.60
    )]
    spring75: Spring,
    #[acts(
        between = (ground.at([0.84, -0.99, -0.45]), coupler.at([0.47, -0.31, 0.00])), stiffness = k * 1.1,
        free_length = 0.62
    )]
    spring76: Spring,
    #[acts(
        between = (ground.at([0.92, -0.95, -0.50]), coupler.at([0.49, -0.29, 0.10])), stiffness = k * 1.2,
        free_length = 0.50
    )]
    spring77: Spring,
    #[acts(
        between = (ground.at([1.00, -0.89, -0.40]), coupler.at([0.52, -0.26, 0.00])), stiffness = k * 1.3,
        free_length = 0.52
    )]
    spring78: Spring,
    #[acts(
        between = (ground.at([1.08, -0.83, -0.45]), coupler.at([0.54, -0.23, 0.10])), stiffness = k * 1.4,
        free_length = 0.54
    )]
    spring79: Spring,
    #[acts(
        between = (ground.at([1.15, -0.77, -0.50]), coupler.at([0.55, -0.19, 0.00])), stiffness = k * 1.0,
        free_length = 0.56
    )]
    spring80: Spring,
    #[acts(
        between = (ground.at([1.21, -0.71, -0.40]), coupler.at([0.57, -0.16, 0.10])), stiffness = k * 1.1,
        free_length = 0.58
    )]
    spring81: Spring,
    #[acts(
        between = (ground.at([1.27, -0.64, -0.45]), coupler.at([0.58, -0.13, 0.00])), stiffness = k * 1.2,
        free_length = 0.60
    )]
    spring82: Spring,
    #[acts(
        between = (ground.at([1.32, -0.56, -0.50]), coupler.at([0.59, -0.09, 0.10])), stiffness = k * 1.3,
        free_length = 0.62
    )]
    spring83: Spring,
    #[acts(
        between = (ground.at([1.37, -0.49, -0.40]), coupler.at([0.60, -0.06, 0.00])), stiffness = k * 1.4,
        free_length = 0.50
    )]
    spring84: Spring,
    #[acts(
        between = (ground.at([1.41, -0.41, -0.45]), coupler.at([0.60, -0.02, 0.10])), stiffness = k * 1.0,
        free_length = 0.52
    )]
    spring85: Spring,
    #[acts(
        between = (ground.at([1.44, -0.33, -0.50]), coupler.at([0.60, 0.01, 0.00])), stiffness = k * 1.1,
        free_length = 0.54
    )]
    spring86: Spring,
    #[acts(
        between = (ground.at([1.47, -0.25, -0.40]), coupler.at([0.60, 0.05, 0.10])), stiffness = k * 1.2,
        free_length = 0.56
    )]
    spring87: Spring,
    #[acts(
        between = (ground.at([1.49, -0.17, -0.45]), coupler.at([0.59, 0.08, 0.00])), stiffness = k * 1.3,
        free_length = 0.58
    )]
    spring88: Spring,
    #[acts(
        between = (ground.at([1.50, -0.08, -0.50]), coupler.at([0.58, 0.11, 0.10])), stiffness = k * 1.4,
        free_length = 0.60
    )]
    spring89: Spring,
}

#[test]
fn constraints_hold_under_many_springs_at_any_time() {
    let tent = DrivenBarsWithSpatialSprings { k: 20.0 };
    let mut random = Random::new(35);
    for t in [0.0, 0.4, 2.0] {
        let m = at(&tent, t);
        let q = tent.project_configuration(t, &SVector::from([1.2, -0.7, 1.9])).expect("the bars close");
        let mut pull = tent.bias_forces(t, &q, &SVector::zeros());
        pull[0] += 3.0 * f64::sin(t);
        assert_close_relative_to_largest(
            "∂U/∂q",
            pull.as_slice(),
            potential_gradient(&m, &q).as_slice(),
            1e-9,
        );
        let [v, tau]: [SVector<f64, 3>; 2] = [random.random_vector(1.0), random.random_vector(1.0)];
        let (a, lambda) = tent.constrained_dynamics(t, &q, &v, &tau);
        let forces = tent.mass_matrix(t, &q) * a + tent.bias_forces(t, &q, &v);
        let given = tau + tent.constraint_jacobian(t, &q).transpose() * lambda;
        assert_close("M a + h", forces.as_slice(), given.as_slice(), 1e-9);
        assert_eq!(Mechanism::bias_forces(&tent, t, &q, &v), tent.bias_forces(t, &q, &v));
    }
}
