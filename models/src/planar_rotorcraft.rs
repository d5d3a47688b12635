use linkwork::mechanism;

/// Rotorcraft with two propellers that flies in a vertical plane.
///
/// Source: Hauser, Sastry and Meyer, *Nonlinear control design for slightly non-minimum phase systems:
/// application to V/STOL aircraft*, Automatica 28 (1992); Tedrake, *Underactuated Robotics*, ch. 3.
///
/// - Coordinates: `flight.x`, `flight.y`, m, with y up, and `flight.angle`, `θ`, rad, counter-clockwise.
///   Inputs: `left` and `right`, the thrusts along the hull's y at `∓l`, N.
/// - Equations of motion: `m ẍ = −(u₁ + u₂) sin θ`, `m ÿ = (u₁ + u₂) cos θ − m g`, `J θ̈ = l (u₂ − u₁)`.
/// - It hovers at `u₁ = u₂ = ½ m g`, `θ = 0`. Without thrust it moves on a parabola with constant angular
///   velocity.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarRotorcraft {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the rotorcraft, kg.
    pub mass: f64,
    /// Moment of inertia of the rotorcraft about the axis across the plane, kg·m².
    pub inertia: f64,
    /// Distance of the propellers from the centre of mass, m.
    pub arm: f64,

    #[body(mass = mass, inertia = diagonal(inertia / 2, inertia / 2, inertia))]
    hull: Body,
    #[joint(ground -> hull, about = z)]
    flight: Planar,
    #[acts(on = hull.at(-arm * x), along = y)]
    left: Force,
    #[acts(on = hull.at(arm * x), along = y)]
    right: Force,
}
