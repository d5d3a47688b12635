//! Mechanisms with so many springs that their forces are a function that the others call: energies, powers and differences
//! know nothing of that.

use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use linkwork::{Rheonomic, at};
use linkwork_compiler::derive::Output;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Quantity;
use linkwork_compiler::{compile, expand, read};
use proc_macro2::TokenStream;
use std::ops::Range;
use std::path::Path;
use support::compare::{assert_close, assert_same_dynamics, assert_similar};
use support::random::Random;

/// A deck on springs and dashpots around it, with a swinging arm.
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
    #[acts(between = (ground.at([1.50, 0.00, -0.40]), deck.at([0.57, 0.15, 0.00])), stiffness = k * 1.0, free_length = 0.50)]
    spring0: Spring,
    #[acts(between = (ground.at([1.49, 0.14, -0.45]), deck.at([0.55, 0.20, 0.10])), stiffness = k * 1.1, free_length = 0.52)]
    spring1: Spring,
    #[acts(between = (ground.at([1.46, 0.28, -0.50]), deck.at([0.52, 0.25, 0.00])), stiffness = k * 1.2, free_length = 0.54)]
    spring2: Spring,
    #[acts(between = (ground.at([1.41, 0.41, -0.40]), deck.at([0.48, 0.30, 0.10])), stiffness = k * 1.3, free_length = 0.56)]
    spring3: Spring,
    #[acts(between = (ground.at([1.34, 0.54, -0.45]), deck.at([0.43, 0.35, 0.00])), stiffness = k * 1.4, free_length = 0.58)]
    spring4: Spring,
    #[acts(between = (ground.at([1.25, 0.66, -0.50]), deck.at([0.38, 0.39, 0.10])), stiffness = k * 1.0, free_length = 0.60)]
    spring5: Spring,
    #[acts(between = (ground.at([1.15, 0.77, -0.40]), deck.at([0.33, 0.42, 0.00])), stiffness = k * 1.1, free_length = 0.62)]
    spring6: Spring,
    #[acts(between = (ground.at([1.03, 0.87, -0.45]), deck.at([0.26, 0.45, 0.10])), stiffness = k * 1.2, free_length = 0.50)]
    spring7: Spring,
    #[acts(between = (ground.at([0.90, 0.96, -0.50]), deck.at([0.20, 0.47, 0.00])), stiffness = k * 1.3, free_length = 0.52)]
    spring8: Spring,
    #[acts(between = (ground.at([0.75, 1.04, -0.40]), deck.at([0.13, 0.49, 0.10])), stiffness = k * 1.4, free_length = 0.54)]
    spring9: Spring,
    #[acts(between = (ground.at([0.59, 1.10, -0.45]), deck.at([0.06, 0.50, 0.00])), stiffness = k * 1.0, free_length = 0.56)]
    spring10: Spring,
    #[acts(between = (ground.at([0.43, 1.15, -0.50]), deck.at([-0.01, 0.50, 0.10])), stiffness = k * 1.1, free_length = 0.58)]
    spring11: Spring,
    #[acts(between = (ground.at([0.26, 1.18, -0.40]), deck.at([-0.08, 0.50, 0.00])), stiffness = k * 1.2, free_length = 0.60)]
    spring12: Spring,
    #[acts(between = (ground.at([0.09, 1.20, -0.45]), deck.at([-0.14, 0.49, 0.10])), stiffness = k * 1.3, free_length = 0.62)]
    spring13: Spring,
    #[acts(between = (ground.at([-0.09, 1.20, -0.50]), deck.at([-0.21, 0.47, 0.00])), stiffness = k * 1.4, free_length = 0.50)]
    spring14: Spring,
    #[acts(between = (ground.at([-0.26, 1.18, -0.40]), deck.at([-0.27, 0.44, 0.10])), stiffness = k * 1.0, free_length = 0.52)]
    spring15: Spring,
    #[acts(between = (ground.at([-0.43, 1.15, -0.45]), deck.at([-0.33, 0.42, 0.00])), stiffness = k * 1.1, free_length = 0.54)]
    spring16: Spring,
    #[acts(between = (ground.at([-0.59, 1.10, -0.50]), deck.at([-0.39, 0.38, 0.10])), stiffness = k * 1.2, free_length = 0.56)]
    spring17: Spring,
    #[acts(between = (ground.at([-0.75, 1.04, -0.40]), deck.at([-0.44, 0.34, 0.00])), stiffness = k * 1.3, free_length = 0.58)]
    spring18: Spring,
    #[acts(between = (ground.at([-0.90, 0.96, -0.45]), deck.at([-0.48, 0.29, 0.10])), stiffness = k * 1.4, free_length = 0.60)]
    spring19: Spring,
    #[acts(between = (ground.at([-1.03, 0.87, -0.50]), deck.at([-0.52, 0.25, 0.00])), stiffness = k * 1.0, free_length = 0.62)]
    spring20: Spring,
    #[acts(between = (ground.at([-1.15, 0.77, -0.40]), deck.at([-0.55, 0.19, 0.10])), stiffness = k * 1.1, free_length = 0.50)]
    spring21: Spring,
    #[acts(between = (ground.at([-1.25, 0.66, -0.45]), deck.at([-0.58, 0.14, 0.00])), stiffness = k * 1.2, free_length = 0.52)]
    spring22: Spring,
    #[acts(between = (ground.at([-1.34, 0.54, -0.50]), deck.at([-0.59, 0.08, 0.10])), stiffness = k * 1.3, free_length = 0.54)]
    spring23: Spring,
    #[acts(between = (ground.at([-1.41, 0.41, -0.40]), deck.at([-0.60, 0.02, 0.00])), stiffness = k * 1.4, free_length = 0.56)]
    spring24: Spring,
    #[acts(between = (ground.at([-1.46, 0.28, -0.45]), deck.at([-0.60, -0.03, 0.10])), stiffness = k * 1.0, free_length = 0.58)]
    spring25: Spring,
    #[acts(between = (ground.at([-1.49, 0.14, -0.50]), deck.at([-0.59, -0.09, 0.00])), stiffness = k * 1.1, free_length = 0.60)]
    spring26: Spring,
    #[acts(between = (ground.at([-1.50, 0.00, -0.40]), deck.at([-0.57, -0.15, 0.10])), stiffness = k * 1.2, free_length = 0.62)]
    spring27: Spring,
    #[acts(between = (ground.at([-1.49, -0.14, -0.45]), deck.at([-0.55, -0.20, 0.00])), stiffness = k * 1.3, free_length = 0.50)]
    spring28: Spring,
    #[acts(between = (ground.at([-1.46, -0.28, -0.50]), deck.at([-0.52, -0.25, 0.10])), stiffness = k * 1.4, free_length = 0.52)]
    spring29: Spring,
    #[acts(between = (ground.at([-1.41, -0.41, -0.40]), deck.at([-0.48, -0.30, 0.00])), stiffness = k * 1.0, free_length = 0.54)]
    spring30: Spring,
    #[acts(between = (ground.at([-1.34, -0.54, -0.45]), deck.at([-0.43, -0.35, 0.10])), stiffness = k * 1.1, free_length = 0.56)]
    spring31: Spring,
    #[acts(between = (ground.at([-1.25, -0.66, -0.50]), deck.at([-0.38, -0.39, 0.00])), stiffness = k * 1.2, free_length = 0.58)]
    spring32: Spring,
    #[acts(between = (ground.at([-1.15, -0.77, -0.40]), deck.at([-0.33, -0.42, 0.10])), stiffness = k * 1.3, free_length = 0.60)]
    spring33: Spring,
    #[acts(between = (ground.at([-1.03, -0.87, -0.45]), deck.at([-0.26, -0.45, 0.00])), stiffness = k * 1.4, free_length = 0.62)]
    spring34: Spring,
    #[acts(between = (ground.at([-0.90, -0.96, -0.50]), deck.at([-0.20, -0.47, 0.10])), stiffness = k * 1.0, free_length = 0.50)]
    spring35: Spring,
    #[acts(between = (ground.at([-0.75, -1.04, -0.40]), deck.at([-0.13, -0.49, 0.00])), stiffness = k * 1.1, free_length = 0.52)]
    spring36: Spring,
    #[acts(between = (ground.at([-0.59, -1.10, -0.45]), deck.at([-0.06, -0.50, 0.10])), stiffness = k * 1.2, free_length = 0.54)]
    spring37: Spring,
    #[acts(between = (ground.at([-0.43, -1.15, -0.50]), deck.at([0.01, -0.50, 0.00])), stiffness = k * 1.3, free_length = 0.56)]
    spring38: Spring,
    #[acts(between = (ground.at([-0.26, -1.18, -0.40]), deck.at([0.08, -0.50, 0.10])), stiffness = k * 1.4, free_length = 0.58)]
    spring39: Spring,
    #[acts(between = (ground.at([-0.09, -1.20, -0.45]), deck.at([0.14, -0.49, 0.00])), stiffness = k * 1.0, free_length = 0.60)]
    spring40: Spring,
    #[acts(between = (ground.at([0.09, -1.20, -0.50]), deck.at([0.21, -0.47, 0.10])), stiffness = k * 1.1, free_length = 0.62)]
    spring41: Spring,
    #[acts(between = (ground.at([0.26, -1.18, -0.40]), deck.at([0.27, -0.44, 0.00])), stiffness = k * 1.2, free_length = 0.50)]
    spring42: Spring,
    #[acts(between = (ground.at([0.43, -1.15, -0.45]), deck.at([0.33, -0.42, 0.10])), stiffness = k * 1.3, free_length = 0.52)]
    spring43: Spring,
    #[acts(between = (ground.at([0.59, -1.10, -0.50]), deck.at([0.39, -0.38, 0.00])), stiffness = k * 1.4, free_length = 0.54)]
    spring44: Spring,
    #[acts(between = (ground.at([0.75, -1.04, -0.40]), deck.at([0.44, -0.34, 0.10])), stiffness = k * 1.0, free_length = 0.56)]
    spring45: Spring,
    #[acts(between = (ground.at([0.90, -0.96, -0.45]), deck.at([0.48, -0.29, 0.00])), stiffness = k * 1.1, free_length = 0.58)]
    spring46: Spring,
    #[acts(between = (ground.at([1.03, -0.87, -0.50]), deck.at([0.52, -0.25, 0.10])), stiffness = k * 1.2, free_length = 0.60)]
    spring47: Spring,
    #[acts(between = (ground.at([1.15, -0.77, -0.40]), deck.at([0.55, -0.19, 0.00])), stiffness = k * 1.3, free_length = 0.62)]
    spring48: Spring,
    #[acts(between = (ground.at([1.25, -0.66, -0.45]), deck.at([0.58, -0.14, 0.10])), stiffness = k * 1.4, free_length = 0.50)]
    spring49: Spring,
    #[acts(between = (ground.at([1.34, -0.54, -0.50]), deck.at([0.59, -0.08, 0.00])), stiffness = k * 1.0, free_length = 0.52)]
    spring50: Spring,
    #[acts(between = (ground.at([1.41, -0.41, -0.40]), deck.at([0.60, -0.02, 0.10])), stiffness = k * 1.1, free_length = 0.54)]
    spring51: Spring,
    #[acts(between = (ground.at([1.46, -0.28, -0.45]), deck.at([0.60, 0.03, 0.00])), stiffness = k * 1.2, free_length = 0.56)]
    spring52: Spring,
    #[acts(between = (ground.at([1.49, -0.14, -0.50]), deck.at([0.59, 0.09, 0.10])), stiffness = k * 1.3, free_length = 0.58)]
    spring53: Spring,
}

/// Four bars in a plane, held by springs out of it and driven in time.
#[mechanism(gravity = -9.81 * y)]
struct Tent {
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
    #[acts(between = (ground.at([1.50, 0.00, -0.40]), coupler.at([0.57, 0.15, 0.00])), stiffness = k * 1.0, free_length = 0.50)]
    spring0: Spring,
    #[acts(between = (ground.at([1.50, 0.08, -0.45]), coupler.at([0.56, 0.18, 0.10])), stiffness = k * 1.1, free_length = 0.52)]
    spring1: Spring,
    #[acts(between = (ground.at([1.49, 0.17, -0.50]), coupler.at([0.54, 0.21, 0.00])), stiffness = k * 1.2, free_length = 0.54)]
    spring2: Spring,
    #[acts(between = (ground.at([1.47, 0.25, -0.40]), coupler.at([0.52, 0.24, 0.10])), stiffness = k * 1.3, free_length = 0.56)]
    spring3: Spring,
    #[acts(between = (ground.at([1.44, 0.33, -0.45]), coupler.at([0.50, 0.27, 0.00])), stiffness = k * 1.4, free_length = 0.58)]
    spring4: Spring,
    #[acts(between = (ground.at([1.41, 0.41, -0.50]), coupler.at([0.48, 0.30, 0.10])), stiffness = k * 1.0, free_length = 0.60)]
    spring5: Spring,
    #[acts(between = (ground.at([1.37, 0.49, -0.40]), coupler.at([0.45, 0.33, 0.00])), stiffness = k * 1.1, free_length = 0.62)]
    spring6: Spring,
    #[acts(between = (ground.at([1.32, 0.56, -0.45]), coupler.at([0.42, 0.35, 0.10])), stiffness = k * 1.2, free_length = 0.50)]
    spring7: Spring,
    #[acts(between = (ground.at([1.27, 0.64, -0.50]), coupler.at([0.39, 0.38, 0.00])), stiffness = k * 1.3, free_length = 0.52)]
    spring8: Spring,
    #[acts(between = (ground.at([1.21, 0.71, -0.40]), coupler.at([0.36, 0.40, 0.10])), stiffness = k * 1.4, free_length = 0.54)]
    spring9: Spring,
    #[acts(between = (ground.at([1.15, 0.77, -0.45]), coupler.at([0.33, 0.42, 0.00])), stiffness = k * 1.0, free_length = 0.56)]
    spring10: Spring,
    #[acts(between = (ground.at([1.08, 0.83, -0.50]), coupler.at([0.29, 0.44, 0.10])), stiffness = k * 1.1, free_length = 0.58)]
    spring11: Spring,
    #[acts(between = (ground.at([1.00, 0.89, -0.40]), coupler.at([0.25, 0.45, 0.00])), stiffness = k * 1.2, free_length = 0.60)]
    spring12: Spring,
    #[acts(between = (ground.at([0.92, 0.95, -0.45]), coupler.at([0.21, 0.47, 0.10])), stiffness = k * 1.3, free_length = 0.62)]
    spring13: Spring,
    #[acts(between = (ground.at([0.84, 0.99, -0.50]), coupler.at([0.17, 0.48, 0.00])), stiffness = k * 1.4, free_length = 0.50)]
    spring14: Spring,
    #[acts(between = (ground.at([0.75, 1.04, -0.40]), coupler.at([0.13, 0.49, 0.10])), stiffness = k * 1.0, free_length = 0.52)]
    spring15: Spring,
    #[acts(between = (ground.at([0.66, 1.08, -0.45]), coupler.at([0.09, 0.49, 0.00])), stiffness = k * 1.1, free_length = 0.54)]
    spring16: Spring,
    #[acts(between = (ground.at([0.56, 1.11, -0.50]), coupler.at([0.05, 0.50, 0.10])), stiffness = k * 1.2, free_length = 0.56)]
    spring17: Spring,
    #[acts(between = (ground.at([0.46, 1.14, -0.40]), coupler.at([0.01, 0.50, 0.00])), stiffness = k * 1.3, free_length = 0.58)]
    spring18: Spring,
    #[acts(between = (ground.at([0.36, 1.16, -0.45]), coupler.at([-0.03, 0.50, 0.10])), stiffness = k * 1.4, free_length = 0.60)]
    spring19: Spring,
    #[acts(between = (ground.at([0.26, 1.18, -0.50]), coupler.at([-0.08, 0.50, 0.00])), stiffness = k * 1.0, free_length = 0.62)]
    spring20: Spring,
    #[acts(between = (ground.at([0.16, 1.19, -0.40]), coupler.at([-0.12, 0.49, 0.10])), stiffness = k * 1.1, free_length = 0.50)]
    spring21: Spring,
    #[acts(between = (ground.at([0.05, 1.20, -0.45]), coupler.at([-0.16, 0.48, 0.00])), stiffness = k * 1.2, free_length = 0.52)]
    spring22: Spring,
    #[acts(between = (ground.at([-0.05, 1.20, -0.50]), coupler.at([-0.20, 0.47, 0.10])), stiffness = k * 1.3, free_length = 0.54)]
    spring23: Spring,
    #[acts(between = (ground.at([-0.16, 1.19, -0.40]), coupler.at([-0.24, 0.46, 0.00])), stiffness = k * 1.4, free_length = 0.56)]
    spring24: Spring,
    #[acts(between = (ground.at([-0.26, 1.18, -0.45]), coupler.at([-0.27, 0.44, 0.10])), stiffness = k * 1.0, free_length = 0.58)]
    spring25: Spring,
    #[acts(between = (ground.at([-0.36, 1.16, -0.50]), coupler.at([-0.31, 0.43, 0.00])), stiffness = k * 1.1, free_length = 0.60)]
    spring26: Spring,
    #[acts(between = (ground.at([-0.46, 1.14, -0.40]), coupler.at([-0.35, 0.41, 0.10])), stiffness = k * 1.2, free_length = 0.62)]
    spring27: Spring,
    #[acts(between = (ground.at([-0.56, 1.11, -0.45]), coupler.at([-0.38, 0.39, 0.00])), stiffness = k * 1.3, free_length = 0.50)]
    spring28: Spring,
    #[acts(between = (ground.at([-0.66, 1.08, -0.50]), coupler.at([-0.41, 0.36, 0.10])), stiffness = k * 1.4, free_length = 0.52)]
    spring29: Spring,
    #[acts(between = (ground.at([-0.75, 1.04, -0.40]), coupler.at([-0.44, 0.34, 0.00])), stiffness = k * 1.0, free_length = 0.54)]
    spring30: Spring,
    #[acts(between = (ground.at([-0.84, 0.99, -0.45]), coupler.at([-0.47, 0.31, 0.10])), stiffness = k * 1.1, free_length = 0.56)]
    spring31: Spring,
    #[acts(between = (ground.at([-0.92, 0.95, -0.50]), coupler.at([-0.49, 0.29, 0.00])), stiffness = k * 1.2, free_length = 0.58)]
    spring32: Spring,
    #[acts(between = (ground.at([-1.00, 0.89, -0.40]), coupler.at([-0.52, 0.26, 0.10])), stiffness = k * 1.3, free_length = 0.60)]
    spring33: Spring,
    #[acts(between = (ground.at([-1.08, 0.83, -0.45]), coupler.at([-0.54, 0.23, 0.00])), stiffness = k * 1.4, free_length = 0.62)]
    spring34: Spring,
    #[acts(between = (ground.at([-1.15, 0.77, -0.50]), coupler.at([-0.55, 0.19, 0.10])), stiffness = k * 1.0, free_length = 0.50)]
    spring35: Spring,
    #[acts(between = (ground.at([-1.21, 0.71, -0.40]), coupler.at([-0.57, 0.16, 0.00])), stiffness = k * 1.1, free_length = 0.52)]
    spring36: Spring,
    #[acts(between = (ground.at([-1.27, 0.64, -0.45]), coupler.at([-0.58, 0.13, 0.10])), stiffness = k * 1.2, free_length = 0.54)]
    spring37: Spring,
    #[acts(between = (ground.at([-1.32, 0.56, -0.50]), coupler.at([-0.59, 0.09, 0.00])), stiffness = k * 1.3, free_length = 0.56)]
    spring38: Spring,
    #[acts(between = (ground.at([-1.37, 0.49, -0.40]), coupler.at([-0.60, 0.06, 0.10])), stiffness = k * 1.4, free_length = 0.58)]
    spring39: Spring,
    #[acts(between = (ground.at([-1.41, 0.41, -0.45]), coupler.at([-0.60, 0.02, 0.00])), stiffness = k * 1.0, free_length = 0.60)]
    spring40: Spring,
    #[acts(between = (ground.at([-1.44, 0.33, -0.50]), coupler.at([-0.60, -0.01, 0.10])), stiffness = k * 1.1, free_length = 0.62)]
    spring41: Spring,
    #[acts(between = (ground.at([-1.47, 0.25, -0.40]), coupler.at([-0.60, -0.05, 0.00])), stiffness = k * 1.2, free_length = 0.50)]
    spring42: Spring,
    #[acts(between = (ground.at([-1.49, 0.17, -0.45]), coupler.at([-0.59, -0.08, 0.10])), stiffness = k * 1.3, free_length = 0.52)]
    spring43: Spring,
    #[acts(between = (ground.at([-1.50, 0.08, -0.50]), coupler.at([-0.58, -0.11, 0.00])), stiffness = k * 1.4, free_length = 0.54)]
    spring44: Spring,
    #[acts(between = (ground.at([-1.50, 0.00, -0.40]), coupler.at([-0.57, -0.15, 0.10])), stiffness = k * 1.0, free_length = 0.56)]
    spring45: Spring,
    #[acts(between = (ground.at([-1.50, -0.08, -0.45]), coupler.at([-0.56, -0.18, 0.00])), stiffness = k * 1.1, free_length = 0.58)]
    spring46: Spring,
    #[acts(between = (ground.at([-1.49, -0.17, -0.50]), coupler.at([-0.54, -0.21, 0.10])), stiffness = k * 1.2, free_length = 0.60)]
    spring47: Spring,
    #[acts(between = (ground.at([-1.47, -0.25, -0.40]), coupler.at([-0.52, -0.24, 0.00])), stiffness = k * 1.3, free_length = 0.62)]
    spring48: Spring,
    #[acts(between = (ground.at([-1.44, -0.33, -0.45]), coupler.at([-0.50, -0.27, 0.10])), stiffness = k * 1.4, free_length = 0.50)]
    spring49: Spring,
    #[acts(between = (ground.at([-1.41, -0.41, -0.50]), coupler.at([-0.48, -0.30, 0.00])), stiffness = k * 1.0, free_length = 0.52)]
    spring50: Spring,
    #[acts(between = (ground.at([-1.37, -0.49, -0.40]), coupler.at([-0.45, -0.33, 0.10])), stiffness = k * 1.1, free_length = 0.54)]
    spring51: Spring,
    #[acts(between = (ground.at([-1.32, -0.56, -0.45]), coupler.at([-0.42, -0.35, 0.00])), stiffness = k * 1.2, free_length = 0.56)]
    spring52: Spring,
    #[acts(between = (ground.at([-1.27, -0.64, -0.50]), coupler.at([-0.39, -0.38, 0.10])), stiffness = k * 1.3, free_length = 0.58)]
    spring53: Spring,
    #[acts(between = (ground.at([-1.21, -0.71, -0.40]), coupler.at([-0.36, -0.40, 0.00])), stiffness = k * 1.4, free_length = 0.60)]
    spring54: Spring,
    #[acts(between = (ground.at([-1.15, -0.77, -0.45]), coupler.at([-0.33, -0.42, 0.10])), stiffness = k * 1.0, free_length = 0.62)]
    spring55: Spring,
    #[acts(between = (ground.at([-1.08, -0.83, -0.50]), coupler.at([-0.29, -0.44, 0.00])), stiffness = k * 1.1, free_length = 0.50)]
    spring56: Spring,
    #[acts(between = (ground.at([-1.00, -0.89, -0.40]), coupler.at([-0.25, -0.45, 0.10])), stiffness = k * 1.2, free_length = 0.52)]
    spring57: Spring,
    #[acts(between = (ground.at([-0.92, -0.95, -0.45]), coupler.at([-0.21, -0.47, 0.00])), stiffness = k * 1.3, free_length = 0.54)]
    spring58: Spring,
    #[acts(between = (ground.at([-0.84, -0.99, -0.50]), coupler.at([-0.17, -0.48, 0.10])), stiffness = k * 1.4, free_length = 0.56)]
    spring59: Spring,
    #[acts(between = (ground.at([-0.75, -1.04, -0.40]), coupler.at([-0.13, -0.49, 0.00])), stiffness = k * 1.0, free_length = 0.58)]
    spring60: Spring,
    #[acts(between = (ground.at([-0.66, -1.08, -0.45]), coupler.at([-0.09, -0.49, 0.10])), stiffness = k * 1.1, free_length = 0.60)]
    spring61: Spring,
    #[acts(between = (ground.at([-0.56, -1.11, -0.50]), coupler.at([-0.05, -0.50, 0.00])), stiffness = k * 1.2, free_length = 0.62)]
    spring62: Spring,
    #[acts(between = (ground.at([-0.46, -1.14, -0.40]), coupler.at([-0.01, -0.50, 0.10])), stiffness = k * 1.3, free_length = 0.50)]
    spring63: Spring,
    #[acts(between = (ground.at([-0.36, -1.16, -0.45]), coupler.at([0.03, -0.50, 0.00])), stiffness = k * 1.4, free_length = 0.52)]
    spring64: Spring,
    #[acts(between = (ground.at([-0.26, -1.18, -0.50]), coupler.at([0.08, -0.50, 0.10])), stiffness = k * 1.0, free_length = 0.54)]
    spring65: Spring,
    #[acts(between = (ground.at([-0.16, -1.19, -0.40]), coupler.at([0.12, -0.49, 0.00])), stiffness = k * 1.1, free_length = 0.56)]
    spring66: Spring,
    #[acts(between = (ground.at([-0.05, -1.20, -0.45]), coupler.at([0.16, -0.48, 0.10])), stiffness = k * 1.2, free_length = 0.58)]
    spring67: Spring,
    #[acts(between = (ground.at([0.05, -1.20, -0.50]), coupler.at([0.20, -0.47, 0.00])), stiffness = k * 1.3, free_length = 0.60)]
    spring68: Spring,
    #[acts(between = (ground.at([0.16, -1.19, -0.40]), coupler.at([0.24, -0.46, 0.10])), stiffness = k * 1.4, free_length = 0.62)]
    spring69: Spring,
    #[acts(between = (ground.at([0.26, -1.18, -0.45]), coupler.at([0.27, -0.44, 0.00])), stiffness = k * 1.0, free_length = 0.50)]
    spring70: Spring,
    #[acts(between = (ground.at([0.36, -1.16, -0.50]), coupler.at([0.31, -0.43, 0.10])), stiffness = k * 1.1, free_length = 0.52)]
    spring71: Spring,
    #[acts(between = (ground.at([0.46, -1.14, -0.40]), coupler.at([0.35, -0.41, 0.00])), stiffness = k * 1.2, free_length = 0.54)]
    spring72: Spring,
    #[acts(between = (ground.at([0.56, -1.11, -0.45]), coupler.at([0.38, -0.39, 0.10])), stiffness = k * 1.3, free_length = 0.56)]
    spring73: Spring,
    #[acts(between = (ground.at([0.66, -1.08, -0.50]), coupler.at([0.41, -0.36, 0.00])), stiffness = k * 1.4, free_length = 0.58)]
    spring74: Spring,
    #[acts(between = (ground.at([0.75, -1.04, -0.40]), coupler.at([0.44, -0.34, 0.10])), stiffness = k * 1.0, free_length = 0.60)]
    spring75: Spring,
    #[acts(between = (ground.at([0.84, -0.99, -0.45]), coupler.at([0.47, -0.31, 0.00])), stiffness = k * 1.1, free_length = 0.62)]
    spring76: Spring,
    #[acts(between = (ground.at([0.92, -0.95, -0.50]), coupler.at([0.49, -0.29, 0.10])), stiffness = k * 1.2, free_length = 0.50)]
    spring77: Spring,
    #[acts(between = (ground.at([1.00, -0.89, -0.40]), coupler.at([0.52, -0.26, 0.00])), stiffness = k * 1.3, free_length = 0.52)]
    spring78: Spring,
    #[acts(between = (ground.at([1.08, -0.83, -0.45]), coupler.at([0.54, -0.23, 0.10])), stiffness = k * 1.4, free_length = 0.54)]
    spring79: Spring,
    #[acts(between = (ground.at([1.15, -0.77, -0.50]), coupler.at([0.55, -0.19, 0.00])), stiffness = k * 1.0, free_length = 0.56)]
    spring80: Spring,
    #[acts(between = (ground.at([1.21, -0.71, -0.40]), coupler.at([0.57, -0.16, 0.10])), stiffness = k * 1.1, free_length = 0.58)]
    spring81: Spring,
    #[acts(between = (ground.at([1.27, -0.64, -0.45]), coupler.at([0.58, -0.13, 0.00])), stiffness = k * 1.2, free_length = 0.60)]
    spring82: Spring,
    #[acts(between = (ground.at([1.32, -0.56, -0.50]), coupler.at([0.59, -0.09, 0.10])), stiffness = k * 1.3, free_length = 0.62)]
    spring83: Spring,
    #[acts(between = (ground.at([1.37, -0.49, -0.40]), coupler.at([0.60, -0.06, 0.00])), stiffness = k * 1.4, free_length = 0.50)]
    spring84: Spring,
    #[acts(between = (ground.at([1.41, -0.41, -0.45]), coupler.at([0.60, -0.02, 0.10])), stiffness = k * 1.0, free_length = 0.52)]
    spring85: Spring,
    #[acts(between = (ground.at([1.44, -0.33, -0.50]), coupler.at([0.60, 0.01, 0.00])), stiffness = k * 1.1, free_length = 0.54)]
    spring86: Spring,
    #[acts(between = (ground.at([1.47, -0.25, -0.40]), coupler.at([0.60, 0.05, 0.10])), stiffness = k * 1.2, free_length = 0.56)]
    spring87: Spring,
    #[acts(between = (ground.at([1.49, -0.17, -0.45]), coupler.at([0.59, 0.08, 0.00])), stiffness = k * 1.3, free_length = 0.58)]
    spring88: Spring,
    #[acts(between = (ground.at([1.50, -0.08, -0.50]), coupler.at([0.58, 0.11, 0.10])), stiffness = k * 1.4, free_length = 0.60)]
    spring89: Spring,
}

/// Two links in a plane between springs out of it.
#[mechanism(derivatives, batch)]
struct Web {
    k: f64,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    upper: Body,
    #[body(mass = 2, com = 0.5 * x, inertia = rod(2, 1, x))]
    lower: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(x) -> lower, about = z)]
    elbow: Pin,
    #[acts(between = (ground.at([1.50, 0.00, -0.40]), lower.at([0.57, 0.15, 0.00])), stiffness = k * 1.0, free_length = 0.50)]
    spring0: Spring,
    #[acts(between = (ground.at([1.50, 0.08, -0.45]), lower.at([0.56, 0.18, 0.10])), stiffness = k * 1.1, free_length = 0.52)]
    spring1: Spring,
    #[acts(between = (ground.at([1.49, 0.17, -0.50]), lower.at([0.54, 0.21, 0.00])), stiffness = k * 1.2, free_length = 0.54)]
    spring2: Spring,
    #[acts(between = (ground.at([1.47, 0.25, -0.40]), lower.at([0.52, 0.24, 0.10])), stiffness = k * 1.3, free_length = 0.56)]
    spring3: Spring,
    #[acts(between = (ground.at([1.44, 0.33, -0.45]), lower.at([0.50, 0.27, 0.00])), stiffness = k * 1.4, free_length = 0.58)]
    spring4: Spring,
    #[acts(between = (ground.at([1.41, 0.41, -0.50]), lower.at([0.48, 0.30, 0.10])), stiffness = k * 1.0, free_length = 0.60)]
    spring5: Spring,
    #[acts(between = (ground.at([1.37, 0.49, -0.40]), lower.at([0.45, 0.33, 0.00])), stiffness = k * 1.1, free_length = 0.62)]
    spring6: Spring,
    #[acts(between = (ground.at([1.32, 0.56, -0.45]), lower.at([0.42, 0.35, 0.10])), stiffness = k * 1.2, free_length = 0.50)]
    spring7: Spring,
    #[acts(between = (ground.at([1.27, 0.64, -0.50]), lower.at([0.39, 0.38, 0.00])), stiffness = k * 1.3, free_length = 0.52)]
    spring8: Spring,
    #[acts(between = (ground.at([1.21, 0.71, -0.40]), lower.at([0.36, 0.40, 0.10])), stiffness = k * 1.4, free_length = 0.54)]
    spring9: Spring,
    #[acts(between = (ground.at([1.15, 0.77, -0.45]), lower.at([0.33, 0.42, 0.00])), stiffness = k * 1.0, free_length = 0.56)]
    spring10: Spring,
    #[acts(between = (ground.at([1.08, 0.83, -0.50]), lower.at([0.29, 0.44, 0.10])), stiffness = k * 1.1, free_length = 0.58)]
    spring11: Spring,
    #[acts(between = (ground.at([1.00, 0.89, -0.40]), lower.at([0.25, 0.45, 0.00])), stiffness = k * 1.2, free_length = 0.60)]
    spring12: Spring,
    #[acts(between = (ground.at([0.92, 0.95, -0.45]), lower.at([0.21, 0.47, 0.10])), stiffness = k * 1.3, free_length = 0.62)]
    spring13: Spring,
    #[acts(between = (ground.at([0.84, 0.99, -0.50]), lower.at([0.17, 0.48, 0.00])), stiffness = k * 1.4, free_length = 0.50)]
    spring14: Spring,
    #[acts(between = (ground.at([0.75, 1.04, -0.40]), lower.at([0.13, 0.49, 0.10])), stiffness = k * 1.0, free_length = 0.52)]
    spring15: Spring,
    #[acts(between = (ground.at([0.66, 1.08, -0.45]), lower.at([0.09, 0.49, 0.00])), stiffness = k * 1.1, free_length = 0.54)]
    spring16: Spring,
    #[acts(between = (ground.at([0.56, 1.11, -0.50]), lower.at([0.05, 0.50, 0.10])), stiffness = k * 1.2, free_length = 0.56)]
    spring17: Spring,
    #[acts(between = (ground.at([0.46, 1.14, -0.40]), lower.at([0.01, 0.50, 0.00])), stiffness = k * 1.3, free_length = 0.58)]
    spring18: Spring,
    #[acts(between = (ground.at([0.36, 1.16, -0.45]), lower.at([-0.03, 0.50, 0.10])), stiffness = k * 1.4, free_length = 0.60)]
    spring19: Spring,
    #[acts(between = (ground.at([0.26, 1.18, -0.50]), lower.at([-0.08, 0.50, 0.00])), stiffness = k * 1.0, free_length = 0.62)]
    spring20: Spring,
    #[acts(between = (ground.at([0.16, 1.19, -0.40]), lower.at([-0.12, 0.49, 0.10])), stiffness = k * 1.1, free_length = 0.50)]
    spring21: Spring,
    #[acts(between = (ground.at([0.05, 1.20, -0.45]), lower.at([-0.16, 0.48, 0.00])), stiffness = k * 1.2, free_length = 0.52)]
    spring22: Spring,
    #[acts(between = (ground.at([-0.05, 1.20, -0.50]), lower.at([-0.20, 0.47, 0.10])), stiffness = k * 1.3, free_length = 0.54)]
    spring23: Spring,
    #[acts(between = (ground.at([-0.16, 1.19, -0.40]), lower.at([-0.24, 0.46, 0.00])), stiffness = k * 1.4, free_length = 0.56)]
    spring24: Spring,
    #[acts(between = (ground.at([-0.26, 1.18, -0.45]), lower.at([-0.27, 0.44, 0.10])), stiffness = k * 1.0, free_length = 0.58)]
    spring25: Spring,
    #[acts(between = (ground.at([-0.36, 1.16, -0.50]), lower.at([-0.31, 0.43, 0.00])), stiffness = k * 1.1, free_length = 0.60)]
    spring26: Spring,
    #[acts(between = (ground.at([-0.46, 1.14, -0.40]), lower.at([-0.35, 0.41, 0.10])), stiffness = k * 1.2, free_length = 0.62)]
    spring27: Spring,
    #[acts(between = (ground.at([-0.56, 1.11, -0.45]), lower.at([-0.38, 0.39, 0.00])), stiffness = k * 1.3, free_length = 0.50)]
    spring28: Spring,
    #[acts(between = (ground.at([-0.66, 1.08, -0.50]), lower.at([-0.41, 0.36, 0.10])), stiffness = k * 1.4, free_length = 0.52)]
    spring29: Spring,
    #[acts(between = (ground.at([-0.75, 1.04, -0.40]), lower.at([-0.44, 0.34, 0.00])), stiffness = k * 1.0, free_length = 0.54)]
    spring30: Spring,
    #[acts(between = (ground.at([-0.84, 0.99, -0.45]), lower.at([-0.47, 0.31, 0.10])), stiffness = k * 1.1, free_length = 0.56)]
    spring31: Spring,
    #[acts(between = (ground.at([-0.92, 0.95, -0.50]), lower.at([-0.49, 0.29, 0.00])), stiffness = k * 1.2, free_length = 0.58)]
    spring32: Spring,
    #[acts(between = (ground.at([-1.00, 0.89, -0.40]), lower.at([-0.52, 0.26, 0.10])), stiffness = k * 1.3, free_length = 0.60)]
    spring33: Spring,
    #[acts(between = (ground.at([-1.08, 0.83, -0.45]), lower.at([-0.54, 0.23, 0.00])), stiffness = k * 1.4, free_length = 0.62)]
    spring34: Spring,
    #[acts(between = (ground.at([-1.15, 0.77, -0.50]), lower.at([-0.55, 0.19, 0.10])), stiffness = k * 1.0, free_length = 0.50)]
    spring35: Spring,
    #[acts(between = (ground.at([-1.21, 0.71, -0.40]), lower.at([-0.57, 0.16, 0.00])), stiffness = k * 1.1, free_length = 0.52)]
    spring36: Spring,
    #[acts(between = (ground.at([-1.27, 0.64, -0.45]), lower.at([-0.58, 0.13, 0.10])), stiffness = k * 1.2, free_length = 0.54)]
    spring37: Spring,
    #[acts(between = (ground.at([-1.32, 0.56, -0.50]), lower.at([-0.59, 0.09, 0.00])), stiffness = k * 1.3, free_length = 0.56)]
    spring38: Spring,
    #[acts(between = (ground.at([-1.37, 0.49, -0.40]), lower.at([-0.60, 0.06, 0.10])), stiffness = k * 1.4, free_length = 0.58)]
    spring39: Spring,
    #[acts(between = (ground.at([-1.41, 0.41, -0.45]), lower.at([-0.60, 0.02, 0.00])), stiffness = k * 1.0, free_length = 0.60)]
    spring40: Spring,
    #[acts(between = (ground.at([-1.44, 0.33, -0.50]), lower.at([-0.60, -0.01, 0.10])), stiffness = k * 1.1, free_length = 0.62)]
    spring41: Spring,
    #[acts(between = (ground.at([-1.47, 0.25, -0.40]), lower.at([-0.60, -0.05, 0.00])), stiffness = k * 1.2, free_length = 0.50)]
    spring42: Spring,
    #[acts(between = (ground.at([-1.49, 0.17, -0.45]), lower.at([-0.59, -0.08, 0.10])), stiffness = k * 1.3, free_length = 0.52)]
    spring43: Spring,
    #[acts(between = (ground.at([-1.50, 0.08, -0.50]), lower.at([-0.58, -0.11, 0.00])), stiffness = k * 1.4, free_length = 0.54)]
    spring44: Spring,
    #[acts(between = (ground.at([-1.50, 0.00, -0.40]), lower.at([-0.57, -0.15, 0.10])), stiffness = k * 1.0, free_length = 0.56)]
    spring45: Spring,
    #[acts(between = (ground.at([-1.50, -0.08, -0.45]), lower.at([-0.56, -0.18, 0.00])), stiffness = k * 1.1, free_length = 0.58)]
    spring46: Spring,
    #[acts(between = (ground.at([-1.49, -0.17, -0.50]), lower.at([-0.54, -0.21, 0.10])), stiffness = k * 1.2, free_length = 0.60)]
    spring47: Spring,
    #[acts(between = (ground.at([-1.47, -0.25, -0.40]), lower.at([-0.52, -0.24, 0.00])), stiffness = k * 1.3, free_length = 0.62)]
    spring48: Spring,
    #[acts(between = (ground.at([-1.44, -0.33, -0.45]), lower.at([-0.50, -0.27, 0.10])), stiffness = k * 1.4, free_length = 0.50)]
    spring49: Spring,
    #[acts(between = (ground.at([-1.41, -0.41, -0.50]), lower.at([-0.48, -0.30, 0.00])), stiffness = k * 1.0, free_length = 0.52)]
    spring50: Spring,
    #[acts(between = (ground.at([-1.37, -0.49, -0.40]), lower.at([-0.45, -0.33, 0.10])), stiffness = k * 1.1, free_length = 0.54)]
    spring51: Spring,
    #[acts(between = (ground.at([-1.32, -0.56, -0.45]), lower.at([-0.42, -0.35, 0.00])), stiffness = k * 1.2, free_length = 0.56)]
    spring52: Spring,
    #[acts(between = (ground.at([-1.27, -0.64, -0.50]), lower.at([-0.39, -0.38, 0.10])), stiffness = k * 1.3, free_length = 0.58)]
    spring53: Spring,
    #[acts(between = (ground.at([-1.21, -0.71, -0.40]), lower.at([-0.36, -0.40, 0.00])), stiffness = k * 1.4, free_length = 0.60)]
    spring54: Spring,
    #[acts(between = (ground.at([-1.15, -0.77, -0.45]), lower.at([-0.33, -0.42, 0.10])), stiffness = k * 1.0, free_length = 0.62)]
    spring55: Spring,
    #[acts(between = (ground.at([-1.08, -0.83, -0.50]), lower.at([-0.29, -0.44, 0.00])), stiffness = k * 1.1, free_length = 0.50)]
    spring56: Spring,
    #[acts(between = (ground.at([-1.00, -0.89, -0.40]), lower.at([-0.25, -0.45, 0.10])), stiffness = k * 1.2, free_length = 0.52)]
    spring57: Spring,
    #[acts(between = (ground.at([-0.92, -0.95, -0.45]), lower.at([-0.21, -0.47, 0.00])), stiffness = k * 1.3, free_length = 0.54)]
    spring58: Spring,
    #[acts(between = (ground.at([-0.84, -0.99, -0.50]), lower.at([-0.17, -0.48, 0.10])), stiffness = k * 1.4, free_length = 0.56)]
    spring59: Spring,
    #[acts(between = (ground.at([-0.75, -1.04, -0.40]), lower.at([-0.13, -0.49, 0.00])), stiffness = k * 1.0, free_length = 0.58)]
    spring60: Spring,
    #[acts(between = (ground.at([-0.66, -1.08, -0.45]), lower.at([-0.09, -0.49, 0.10])), stiffness = k * 1.1, free_length = 0.60)]
    spring61: Spring,
    #[acts(between = (ground.at([-0.56, -1.11, -0.50]), lower.at([-0.05, -0.50, 0.00])), stiffness = k * 1.2, free_length = 0.62)]
    spring62: Spring,
    #[acts(between = (ground.at([-0.46, -1.14, -0.40]), lower.at([-0.01, -0.50, 0.10])), stiffness = k * 1.3, free_length = 0.50)]
    spring63: Spring,
    #[acts(between = (ground.at([-0.36, -1.16, -0.45]), lower.at([0.03, -0.50, 0.00])), stiffness = k * 1.4, free_length = 0.52)]
    spring64: Spring,
    #[acts(between = (ground.at([-0.26, -1.18, -0.50]), lower.at([0.08, -0.50, 0.10])), stiffness = k * 1.0, free_length = 0.54)]
    spring65: Spring,
    #[acts(between = (ground.at([-0.16, -1.19, -0.40]), lower.at([0.12, -0.49, 0.00])), stiffness = k * 1.1, free_length = 0.56)]
    spring66: Spring,
    #[acts(between = (ground.at([-0.05, -1.20, -0.45]), lower.at([0.16, -0.48, 0.10])), stiffness = k * 1.2, free_length = 0.58)]
    spring67: Spring,
    #[acts(between = (ground.at([0.05, -1.20, -0.50]), lower.at([0.20, -0.47, 0.00])), stiffness = k * 1.3, free_length = 0.60)]
    spring68: Spring,
    #[acts(between = (ground.at([0.16, -1.19, -0.40]), lower.at([0.24, -0.46, 0.10])), stiffness = k * 1.4, free_length = 0.62)]
    spring69: Spring,
    #[acts(between = (ground.at([0.26, -1.18, -0.45]), lower.at([0.27, -0.44, 0.00])), stiffness = k * 1.0, free_length = 0.50)]
    spring70: Spring,
    #[acts(between = (ground.at([0.36, -1.16, -0.50]), lower.at([0.31, -0.43, 0.10])), stiffness = k * 1.1, free_length = 0.52)]
    spring71: Spring,
    #[acts(between = (ground.at([0.46, -1.14, -0.40]), lower.at([0.35, -0.41, 0.00])), stiffness = k * 1.2, free_length = 0.54)]
    spring72: Spring,
    #[acts(between = (ground.at([0.56, -1.11, -0.45]), lower.at([0.38, -0.39, 0.10])), stiffness = k * 1.3, free_length = 0.56)]
    spring73: Spring,
    #[acts(between = (ground.at([0.66, -1.08, -0.50]), lower.at([0.41, -0.36, 0.00])), stiffness = k * 1.4, free_length = 0.58)]
    spring74: Spring,
    #[acts(between = (ground.at([0.75, -1.04, -0.40]), lower.at([0.44, -0.34, 0.10])), stiffness = k * 1.0, free_length = 0.60)]
    spring75: Spring,
    #[acts(between = (ground.at([0.84, -0.99, -0.45]), lower.at([0.47, -0.31, 0.00])), stiffness = k * 1.1, free_length = 0.62)]
    spring76: Spring,
    #[acts(between = (ground.at([0.92, -0.95, -0.50]), lower.at([0.49, -0.29, 0.10])), stiffness = k * 1.2, free_length = 0.50)]
    spring77: Spring,
    #[acts(between = (ground.at([1.00, -0.89, -0.40]), lower.at([0.52, -0.26, 0.00])), stiffness = k * 1.3, free_length = 0.52)]
    spring78: Spring,
    #[acts(between = (ground.at([1.08, -0.83, -0.45]), lower.at([0.54, -0.23, 0.10])), stiffness = k * 1.4, free_length = 0.54)]
    spring79: Spring,
    #[acts(between = (ground.at([1.15, -0.77, -0.50]), lower.at([0.55, -0.19, 0.00])), stiffness = k * 1.0, free_length = 0.56)]
    spring80: Spring,
    #[acts(between = (ground.at([1.21, -0.71, -0.40]), lower.at([0.57, -0.16, 0.10])), stiffness = k * 1.1, free_length = 0.58)]
    spring81: Spring,
    #[acts(between = (ground.at([1.27, -0.64, -0.45]), lower.at([0.58, -0.13, 0.00])), stiffness = k * 1.2, free_length = 0.60)]
    spring82: Spring,
    #[acts(between = (ground.at([1.32, -0.56, -0.50]), lower.at([0.59, -0.09, 0.10])), stiffness = k * 1.3, free_length = 0.62)]
    spring83: Spring,
    #[acts(between = (ground.at([1.37, -0.49, -0.40]), lower.at([0.60, -0.06, 0.00])), stiffness = k * 1.4, free_length = 0.50)]
    spring84: Spring,
    #[acts(between = (ground.at([1.41, -0.41, -0.45]), lower.at([0.60, -0.02, 0.10])), stiffness = k * 1.0, free_length = 0.52)]
    spring85: Spring,
    #[acts(between = (ground.at([1.44, -0.33, -0.50]), lower.at([0.60, 0.01, 0.00])), stiffness = k * 1.1, free_length = 0.54)]
    spring86: Spring,
    #[acts(between = (ground.at([1.47, -0.25, -0.40]), lower.at([0.60, 0.05, 0.10])), stiffness = k * 1.2, free_length = 0.56)]
    spring87: Spring,
    #[acts(between = (ground.at([1.49, -0.17, -0.45]), lower.at([0.59, 0.08, 0.00])), stiffness = k * 1.3, free_length = 0.58)]
    spring88: Spring,
    #[acts(between = (ground.at([1.50, -0.08, -0.50]), lower.at([0.58, 0.11, 0.10])), stiffness = k * 1.4, free_length = 0.60)]
    spring89: Spring,
}

fn trampoline() -> Trampoline<f64> {
    Trampoline { k: 30.0, c: 0.7 }
}

/// Derivative at zero by central differences of fourth order.
fn slope<const R: usize>(f: impl Fn(f64) -> SVector<f64, R>) -> SVector<f64, R> {
    let h = 1e-3;
    ((f(h) - f(-h)) * 8.0 - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
}

fn unit<const N: usize>(i: usize) -> SVector<f64, N> {
    SVector::from_fn(|j, _| if i == j { 1.0 } else { 0.0 })
}

/// `∂U/∂q`, column by column.
fn gradient<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
) -> SVector<f64, NV>
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let along = |i: usize| slope(|s| [m.potential_energy(&m.integrate(q, &(unit::<NV>(i) * s)))].into())[0];
    SVector::from_fn(|i, _| along(i))
}

#[test]
fn springs_pull_against_the_energy_that_they_store() {
    let m = trampoline();
    let mut random = Random::new(31);
    for _ in 0..5 {
        let q = random.configuration(&m);
        let v: SVector<f64, 7> = random.vector(2.0);
        assert_similar(
            "∂U/∂q",
            m.bias_forces(&q, &SVector::zeros()).as_slice(),
            gradient(&m, &q).as_slice(),
            1e-9,
        );
        // What is odd in the velocities is damping alone.
        let odd = (m.bias_forces(&q, &v) - m.bias_forces(&q, &-v)) * 0.5;
        assert_close("power", &[v.dot(&odd)], &[m.dissipated_power(&q, &v)], 1e-10);
        // The function that the others call.
        let passive = (m.__passive_forces(&q, &v) - m.__passive_forces(&q, &-v)) * 0.5;
        assert_close("dashpots", passive.as_slice(), odd.as_slice(), 1e-10);
    }
}

#[test]
fn the_motion_of_many_springs_is_one_motion() {
    let m = trampoline();
    let mut random = Random::new(32);
    for _ in 0..5 {
        let q = random.configuration(&m);
        let [v, tau]: [SVector<f64, 7>; 2] = [random.vector(2.0), random.vector(3.0)];
        let a = m.forward_dynamics(&q, &v, &tau);
        assert_close("τ", (m.mass_matrix(&q) * a + m.bias_forces(&q, &v)).as_slice(), tau.as_slice(), 1e-9);
        assert_close("τ", m.inverse_dynamics(&q, &v, &a).as_slice(), tau.as_slice(), 1e-9);
        let rate =
            slope(|s| m.generalized_momentum(&m.integrate(&q, &(v * s + a * (s * s / 2.0))), &(v + a * s)));
        assert_similar("ṗ", (m.momentum_rate(&q, &v) + tau).as_slice(), rate.as_slice(), 1e-6);
    }
}

#[test]
fn derivatives_know_what_given_forces_depend_on() {
    let m = trampoline();
    let mut random = Random::new(33);
    for _ in 0..3 {
        let q = random.configuration(&m);
        let [v, a]: [SVector<f64, 7>; 2] = [random.vector(1.0), random.vector(1.0)];
        let tau = m.inverse_dynamics(&q, &v, &a);
        let (by_q, by_v) = m.inverse_dynamics_derivatives(&q, &v, &a);
        let (of_a_by_q, of_a_by_v, _) = m.forward_dynamics_derivatives(&q, &v, &tau);
        for i in 0..7 {
            let aside = |s: f64| m.integrate(&q, &(unit::<7>(i) * s));
            let faster = |s: f64| v + unit::<7>(i) * s;
            let columns = [
                ("∂τ/∂q", by_q.column(i), slope(|s| m.inverse_dynamics(&aside(s), &v, &a))),
                ("∂τ/∂v", by_v.column(i), slope(|s| m.inverse_dynamics(&q, &faster(s), &a))),
                ("∂v̇/∂q", of_a_by_q.column(i), slope(|s| m.forward_dynamics(&aside(s), &v, &tau))),
                ("∂v̇/∂v", of_a_by_v.column(i), slope(|s| m.forward_dynamics(&q, &faster(s), &tau))),
            ];
            for (what, column, expected) in columns {
                assert_similar(what, column.as_slice(), expected.as_slice(), 1e-8);
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
fn a_prepared_trampoline_is_the_trampoline() {
    assert_same_dynamics(&trampoline().prepare(), &trampoline(), 5, 1e-10);
    let single = Trampoline::<f32> { k: 30.0, c: 0.7 };
    let h = single.bias_forces(&single.neutral(), &SVector::from_element(0.1));
    let exact = trampoline().bias_forces(&trampoline().neutral(), &SVector::from_element(0.1));
    assert_similar("single precision", h.cast::<f64>().as_slice(), exact.as_slice(), 1e-5);
}

#[test]
fn several_states_call_the_function_in_lanes() {
    let m = Web { k: 20.0 };
    let mut random = Random::new(34);
    let states: [[SVector<f64, 2>; 3]; 4] =
        std::array::from_fn(|_| std::array::from_fn(|_| random.vector::<2>(2.0)));
    let lanes = |part: usize| SVector::<_, 2>::from_fn(|i, _| Lanes(states.map(|state| state[part][i])));
    let [q, v, tau] = [0, 1, 2].map(lanes);
    let (h, a) = (m.bias_forces_lanes(&q, &v), m.forward_dynamics_lanes(&q, &v, &tau));
    let (by_q, _, _) = m.forward_dynamics_derivatives_lanes(&q, &v, &tau);
    for (k, [q, v, tau]) in states.iter().enumerate() {
        assert_eq!(h.map(|x| x.0[k]), m.bias_forces(q, v));
        assert_eq!(a.map(|x| x.0[k]), m.forward_dynamics(q, v, tau));
        assert_eq!(by_q.map(|x| x.0[k]), m.forward_dynamics_derivatives(q, v, tau).0);
    }
}

#[test]
fn constraints_hold_against_many_springs_at_any_time() {
    let tent = Tent { k: 20.0 };
    let mut random = Random::new(35);
    for t in [0.0, 0.4, 2.0] {
        let m = at(&tent, t);
        let q = tent.project_configuration(t, &SVector::from([1.2, -0.7, 1.9])).expect("the bars close");
        let mut pull = tent.bias_forces(t, &q, &SVector::zeros());
        pull[0] += 3.0 * f64::sin(t);
        assert_similar("∂U/∂q", pull.as_slice(), gradient(&m, &q).as_slice(), 1e-9);
        let [v, tau]: [SVector<f64, 3>; 2] = [random.vector(1.0), random.vector(1.0)];
        let (a, lambda) = tent.constrained_dynamics(t, &q, &v, &tau);
        let forces = tent.mass_matrix(t, &q) * a + tent.bias_forces(t, &q, &v);
        let given = tau + tent.constraint_jacobian(t, &q).transpose() * lambda;
        assert_close("M a + h", forces.as_slice(), given.as_slice(), 1e-9);
        assert_eq!(Rheonomic::bias_forces(&tent, t, &q, &v), tent.bias_forces(t, &q, &v));
    }
}

/// An arm of three spatial pins with those springs of a row, and dashpots beside some.
fn arm(springs: Range<usize>) -> [TokenStream; 2] {
    let mut item = "struct Arm {".to_string();
    let mut parent = "ground".to_string();
    for (k, axis) in ["z", "y", "x"].into_iter().enumerate() {
        item += &format!(
            "#[body(mass = 2, com = 0.2 * z, inertia = diagonal(0.03, 0.04, 0.02))] link{k}: Body,
            #[joint({parent} -> link{k}, about = {axis})] joint{k}: Pin,"
        );
        parent = format!("link{k}.at(0.4 * z)");
    }
    for k in springs {
        let (x, y, z) = (0.1 + 0.01 * k as f64, 0.3 + 0.003 * k as f64, 0.1 + 0.002 * k as f64);
        item += &format!(
            "#[acts(between = (ground.at({x:.3} * x + {y:.3} * y), link{}.at({z:.3} * z)), stiffness = {}, free_length = 0.{})] spring{k}: Spring,",
            k % 3,
            10 + k,
            1 + k % 9
        );
        if k.is_multiple_of(5) {
            item += &format!(
                "#[acts(between = (ground.at({y:.3} * x), link2.at({z:.3} * x)), damping = 2)] dashpot{k}: Dashpot,"
            );
        }
    }
    item.push('}');
    ["gravity = -9.81 * z, derivatives", &item].map(|text| text.parse().expect("the source is Rust"))
}

fn compiled([arguments, item]: [TokenStream; 2]) -> Output {
    let (mut cx, graph) = (Diagnostics::new(), Graph::new());
    let source = read(arguments, item, Path::new(""), &mut cx);
    let Some((_, output)) = source.and_then(|source| compile(&source, &graph, &mut cx)) else {
        panic!("{}", cx.messages().join("\n"));
    };
    output
}

/// What a function gives at a state and an acceleration, with those that it calls.
fn run(output: &Output, name: &str, state: &[[f64; 3]; 3]) -> Option<Vec<f64>> {
    let f = output.functions.iter().find(|f| f.name == name)?;
    let called = ["__passive_forces", "__passive_derivatives"].map(|other| match other == name {
        true => Vec::new(),
        false if name.starts_with("__") => Vec::new(),
        false => run(output, other, state).unwrap_or_default(),
    });
    let at = |s| match Quantity::of(s) {
        Quantity::Configuration(k) => state[0][k],
        Quantity::Velocity(k) => state[1][k],
        Quantity::Acceleration(k) => state[2][k],
        Quantity::PassiveForce(k) => called[0][k],
        Quantity::PassiveDerivative(k) => called[1][k],
        _ => f64::NAN,
    };
    Some(f.program.run(&at))
}

/// Forces of springs add up: few of them stand in every function, all of them in one that the others call.
#[test]
fn many_springs_are_the_sum_of_few() {
    const EACH: usize = 20;
    let (whole, none) = (compiled(arm(0..5 * EACH)), compiled(arm(0..0)));
    let parts: Vec<Output> = (0..5).map(|k| compiled(arm(k * EACH..(k + 1) * EACH))).collect();
    let is_called = |output: &Output| output.functions.iter().any(|f| f.name == "__passive_forces");
    assert!(is_called(&whole) && !parts.iter().any(is_called), "what is compared is derived in two ways");
    let mut random = Random::new(36);
    for _ in 0..5 {
        let state: [[f64; 3]; 3] = std::array::from_fn(|_| random.vector::<3>(1.5).into());
        for name in ["bias_forces", "inverse_dynamics", "inverse_dynamics_derivatives", "momentum_rate"] {
            let of = |output: &Output| run(output, name, &state).expect("the function is there");
            let without = of(&none);
            let mut sum = without.clone();
            for part in &parts {
                for (k, x) in of(part).into_iter().enumerate() {
                    sum[k] += x - without[k];
                }
            }
            assert_similar(name, &of(&whole), &sum, 1e-11);
        }
    }
}

/// Twice as many springs are twice as many operations, and twice as much text: they stand once in the forces, once in their
/// derivatives and once in the energy.
#[test]
fn what_is_written_grows_as_springs_do() {
    let sizes = |springs: usize| {
        let output = compiled(arm(0..springs));
        let operations = |name: &str| {
            let f = output.functions.iter().find(|f| f.name == name).expect("the function is there");
            f.program.counts.total()
        };
        for name in
            ["bias_forces", "inverse_dynamics", "forward_dynamics", "momentum_rate", "coriolis_matrix"]
        {
            assert!(operations(name) < 200, "{name}: {}", operations(name));
        }
        for name in ["inverse_dynamics_derivatives", "forward_dynamics_derivatives", "linearize"] {
            assert!(operations(name) < 600, "{name}: {}", operations(name));
        }
        let all: usize = output.functions.iter().map(|f| f.program.counts.total()).sum();
        let [arguments, item] = arm(0..springs);
        [all, expand(arguments, item, Path::new("")).text.len()]
    };
    let (some, more) = (sizes(150), sizes(300));
    for (some, more) in some.into_iter().zip(more) {
        assert!(10 * more <= 21 * some, "{more} of twice as many springs instead of {some}");
    }
}
