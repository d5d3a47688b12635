use linkwork::mechanism;

/// A round body on an incline, as [`DiskOnIncline`](crate::DiskOnIncline), but free in the plane: that it rolls is a
/// constraint, whose multipliers are the forces of the contact.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), §2.4.
///
/// - Coordinates: `pose.x`, `pose.y` of the centre, m, and the angle `pose.angle` about z, rad; x points level towards
///   the downhill side, y up.
/// - The acceleration down the incline is `g sin α / (1 + κ)` with `J = κ m R²`: `5/7`, `2/3`, `1/2` of `g sin α` for a
///   ball, a disk and a hoop. The normal force is `m g cos α`, friction holds `κ / (1 + κ) m g sin α`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollerOnIncline {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Radius, m.
    pub radius: f64,
    /// Moment of inertia about the axis, in units of mass times squared radius.
    pub shape: f64,
    /// Angle of the incline from the level, rad.
    pub slope: f64,

    #[body(
        mass = mass,
        inertia = diagonal(
            shape * mass * pow(radius, 2) / 2,
            shape * mass * pow(radius, 2) / 2,
            shape * mass * pow(radius, 2)
        )
    )]
    roller: Body,
    #[joint(ground -> roller, about = z)]
    pose: Planar,
    #[constraint(rolls(roller.circle(radius, z), ground.plane(sin(slope) * x + cos(slope) * y)))]
    contact: Rolling,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near};
    use linkwork::prelude::*;

    #[test]
    fn accelerations_and_contact_forces() {
        assert_eq!((RollerOnIncline::NC, RollerOnIncline::NH, RollerOnIncline::NS), (2, 1, 1));
        for (shape, part) in [(0.4, 5.0 / 7.0), (0.5, 2.0 / 3.0), (1.0, 0.5)] {
            let (g, mass, slope) = (9.81, 0.8, 0.35_f64);
            let body = RollerOnIncline { g, mass, radius: 0.15, shape, slope };
            let (s, c) = slope.sin_cos();
            let q = SVector::from([0.15 * s, 0.15 * c, 0.4]);
            let v = SVector::from([1.3 * c, -1.3 * s, -1.3 / 0.15]);
            assert!(body.constraint_residuals(&q).amax() < 1e-16);
            assert!(body.constraint_rates(&q, &v).amax() < 1e-15);
            let (a, forces) = body.constrained_dynamics(&q, &v, &SVector::zeros());
            let down = part * g * s;
            assert_near(a, [down * c, -down * s, -down / 0.15].into(), 1e-14);
            assert_close(forces[0], mass * g * c, 1e-14);
            assert_close(forces[1].abs(), (1.0 - part) * mass * g * s, 1e-14);
        }
    }
}
