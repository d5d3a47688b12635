//! Tests of second derivatives of mechanisms with declared generalized speeds.

use super::check_second_derivatives;
use linkwork::prelude::*;
use support::mechanisms::SatelliteInSpeeds;

/// Body on Cardan angles with forces along its axes. The generalized speeds are the angular velocity in body
/// axes.
#[mechanism(gravity = -9.81 * z, second_derivatives)]
struct Gimbal {
    #[body(mass = 0, inertia = 0)]
    first: Body,
    #[body(mass = 0, inertia = 0)]
    second: Body,
    #[body(mass = 2, com = 0.3 * z + 0.1 * x, inertia = diagonal(0.2, 0.3, 0.45))]
    top: Body,
    #[joint(ground -> first, about = z)]
    psi: Pin,
    #[joint(first -> second, about = y)]
    theta: Pin,
    #[joint(second -> top, about = x)]
    phi: Pin,
    #[acts(on = top.at(0.2 * y), along = ground.x)]
    push: Force,
    #[acts(on = top.at(0.1 * z), value = -0.8 * v(top.at(0.1 * z) / ground / ground))]
    drag: Force,
    #[speed(dot(omega(top / ground), top.x))]
    wx: Speed,
    #[speed(dot(omega(top / ground), top.y))]
    wy: Speed,
    #[speed(dot(omega(top / ground), top.z))]
    wz: Speed,
}

/// Sleigh with a blade that a driven point pulls sideways. The generalized speeds are the velocities along
/// and across the blade.
#[mechanism(second_derivatives)]
struct Sleigh {
    #[body(mass = 3, com = 0.2 * x, inertia = diagonal(0.3, 0.3, 0.4))]
    sleigh: Body,
    #[joint(ground -> sleigh, about = z)]
    pose: Planar,
    #[constraint(dot(v(sleigh / ground / ground), sleigh.y) = 0.1 * sin(t))]
    blade: Nonholonomic,
    #[acts(between = (ground.at(2 * x), sleigh.at(0.3 * y)), stiffness = 5, free_length = 0.5)]
    cord: Spring,
    #[acts(on = sleigh.at(0.4 * x), along = y)]
    push: Force,
    #[speed(dot(v(sleigh / ground / ground), sleigh.x))]
    along: Speed,
    #[speed(dot(v(sleigh / ground / ground), sleigh.y))]
    across: Speed,
}

#[test]
fn second_derivatives_in_speeds_agree_with_differences() {
    check_second_derivatives("gimbal", &Gimbal {}, 3.0);
    check_second_derivatives("satellite", &SatelliteInSpeeds {}, 3.0);
    check_second_derivatives("sleigh", &Sleigh {}, 3.0);
}
