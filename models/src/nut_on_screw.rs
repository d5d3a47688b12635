use linkwork::mechanism;

/// A heavy nut on an upright screw without friction: its weight turns it as it comes down.
///
/// Source: Ball, *A Treatise on the Theory of Screws* (1900); Bernstein, Goel and Ansari, *Geometry, Kinematics,
/// Statics, and Dynamics*, on the screw joint.
///
/// - Coordinate: `thread`, the angle `θ` of the nut, rad; it rises by the pitch `p` each radian, `2π p` each turn.
///   Input: `spanner`, a torque on the nut, N·m.
/// - Equation of motion, with the nut's moment of inertia `J` about the screw: `(J + m p²) θ̈ + m g p = τ`. It falls
///   with the constant acceleration `g / (1 + J / (m p²))`, and is held by the torque `m g p`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NutOnScrew {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the nut, kg.
    pub mass: f64,
    /// Radius of the nut, a uniform disk, m.
    pub radius: f64,
    /// Rise in a radian, m.
    pub pitch: f64,

    #[body(mass = mass, inertia = disk(mass, radius, z))]
    nut: Body,
    #[joint(ground -> nut, about = z, pitch = pitch)]
    thread: Screw,
    #[acts(on = thread)]
    spanner: Torque,
    #[output(dot(r(nut / ground), z))]
    height: Scalar,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, precisely};
    use linkwork::prelude::*;
    use std::f64::consts::TAU;

    const N: NutOnScrew = NutOnScrew { g: 9.81, mass: 0.6, radius: 0.03, pitch: 0.008 };

    #[test]
    fn equation_of_motion() {
        let p = N.pitch;
        let inertia = N.mass * N.radius * N.radius / 2.0 + N.mass * p * p;
        let tau = N.inverse_dynamics(&[1.2].into(), &[3.0].into(), &[0.7].into());
        assert_close(tau[0], inertia * 0.7 + N.mass * N.g * p, 1e-15);
        assert_close(N.height(&[TAU].into()), TAU * p, 1e-15);
        let held = N.generalized_forces(&[1.2].into(), &[N.mass * N.g * p].into());
        assert_close(N.forward_dynamics(&[1.2].into(), &[0.0].into(), &held)[0], 0.0, 1e-12);
    }

    #[test]
    fn comes_down_steadily_faster() -> Result<(), Error> {
        let p = N.pitch;
        let fall = N.g / (1.0 + N.radius * N.radius / (2.0 * p * p));
        let end = simulate(&N).method(precisely()).duration(1.5).finish()?;
        assert_close(N.height(&end.q), -fall * 1.5 * 1.5 / 2.0, 1e-11);
        Ok(())
    }
}
