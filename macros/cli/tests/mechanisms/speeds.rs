//! Mechanism with declared generalized speeds that the command reads from this file, and that the tests
//! compile in Rust.

use linkwork::prelude::*;

/// Free body with velocities along the ground axes as speeds, and an arm on Cardan angles whose speeds
/// combine both rates.
#[mechanism(gravity = -9.81 * z, derivatives)]
pub struct Juggler {
    pub axial: f64,
    #[body(mass = 2, com = 0.1 * x, inertia = diagonal(0.2, 0.3, axial))]
    hull: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[body(mass = 0.1, inertia = sphere(0.1, 0.1))]
    first: Body,
    #[joint(hull.at(0.2 * y) -> first, about = z)]
    psi: Pin,
    #[body(mass = 0.5, com = -0.4 * z, inertia = diagonal(0.03, 0.04, 0.02))]
    hand: Body,
    #[joint(first -> hand, about = y)]
    theta: Pin,
    #[acts(on = theta, damping = 0.1)]
    friction: Dashpot,
    #[acts(on = hull.at(0.1 * y), along = x)]
    thrust: Force,
    #[output(reaction_force(psi))]
    pull: Vector,
    #[speed(dot(v(hull / ground / ground), x))]
    ux: Speed,
    #[speed(dot(v(hull / ground / ground), y))]
    uy: Speed,
    #[speed(dot(v(hull / ground / ground), z))]
    uz: Speed,
    #[speed(dot(omega(hull / ground), x))]
    wx: Speed,
    #[speed(dot(omega(hull / ground), y))]
    wy: Speed,
    #[speed(dot(omega(hull / ground), z))]
    wz: Speed,
    #[speed(rate(psi) * cos(theta) + 0.2 * rate(theta))]
    swing: Speed,
    #[speed(rate(theta) - 0.1 * sin(psi) * rate(psi))]
    bend: Speed,
}
