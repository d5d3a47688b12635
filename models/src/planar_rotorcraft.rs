use linkwork::mechanism;

/// A rotorcraft with two propellers that flies in a vertical plane.
///
/// Source: Hauser, Sastry and Meyer, *Nonlinear control design for slightly non-minimum phase systems: application to
/// V/STOL aircraft*, Automatica 28 (1992); Tedrake, *Underactuated Robotics*, ch. 3.
///
/// - Coordinates: `flight.x`, `flight.y`, m, with y up, and `flight.angle`, `θ`, rad, counter-clockwise.
///   Inputs: `left` and `right`, the thrusts along the hull's y at `∓l`, N.
/// - Equations of motion: `m ẍ = −(u₁ + u₂) sin θ`, `m ÿ = (u₁ + u₂) cos θ − m g`, `J θ̈ = l (u₂ − u₁)`.
/// - It hovers at `u₁ = u₂ = ½ m g`, `θ = 0`. Without thrust it flies along a parabola, turning steadily.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarRotorcraft {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Moment of inertia about the axis across the plane, kg·m².
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_near, precisely};
    use linkwork::prelude::*;

    const R: PlanarRotorcraft = PlanarRotorcraft { g: 9.81, mass: 0.5, inertia: 0.003, arm: 0.17 };

    #[test]
    fn equations_of_motion() {
        let theta = 0.4_f64;
        let (q, v) = (SVector::from([1.0, 2.0, theta]), SVector::from([0.5, -0.3, 1.2]));
        let tau = R.generalized_forces(&q, &SVector::from([2.0, 3.1]));
        let x = -5.1 * theta.sin() / R.mass;
        let y = 5.1 * theta.cos() / R.mass - R.g;
        let turn = R.arm * 1.1 / R.inertia;
        assert_near(R.forward_dynamics(&q, &v, &tau), SVector::from([x, y, turn]), 1e-13);
    }

    #[test]
    fn hovers_or_falls() -> Result<(), Error> {
        let hover = SVector::from([R.mass * R.g / 2.0; 2]);
        let q = SVector::from([0.3, 1.0, 0.0]);
        let held = simulate(&R).from(q, [0.0; 3]).inputs(|_, _, _| hover).duration(1.0).finish()?;
        assert_near(held.q, q, 1e-12);
        let thrown = simulate(&R).from(q, [2.0, 5.0, -3.0]).method(precisely()).duration(0.8).finish()?;
        let expected = [0.3 + 1.6, 1.0 + 4.0 - R.g * 0.32, -2.4];
        assert_near(thrown.q, SVector::from(expected), 1e-12);
        Ok(())
    }
}
