use linkwork::mechanism;

/// A disk, hoop, cylinder or ball that rolls down an incline without slipping.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), §2.4; Galilei, *Discorsi* (1638).
///
/// - Coordinate: `s`, the way down the incline, m; place and attitude of the disk follow from it, so that rolling
///   without slip needs no constraint. x points level towards the downhill side, y up.
/// - Equation of motion: `(m + J/R²) s̈ = m g sin α`. With `J = κ m R²` the acceleration is `g sin α / (1 + κ)`: `κ` is
///   1 for a hoop, ½ for a disk or a solid cylinder, ⅔ for a shell and ⅖ for a solid ball, whatever its mass and size.
/// - Output: `rim`, the velocity of that point of the rim which touches the incline at `s = 0`, m/s.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiskOnIncline {
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

    s: Coordinate,
    #[frame(ground, z(-slope))]
    incline: Frame,
    #[frame(incline, z(-s / radius))]
    turned: Frame,
    #[body(
        mass = mass,
        inertia = diagonal(
            shape * mass * pow(radius, 2) / 2,
            shape * mass * pow(radius, 2) / 2,
            shape * mass * pow(radius, 2)
        ),
        at = s * incline.x + radius * incline.y,
        frame = turned
    )]
    disk: Body,
    #[output(v(disk.at(-radius * y) / ground / ground))]
    rim: Vector,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near};
    use linkwork::prelude::*;

    #[test]
    fn accelerations_of_round_bodies() {
        for (shape, part) in [(1.0, 1.0 / 2.0), (0.5, 2.0 / 3.0), (2.0 / 3.0, 3.0 / 5.0), (0.4, 5.0 / 7.0)] {
            let body = DiskOnIncline { g: 9.81, mass: 0.8, radius: 0.15, shape, slope: 0.35 };
            let a = body.forward_dynamics(&[0.7].into(), &[1.3].into(), &[0.0].into());
            assert_close(a[0], part * 9.81 * 0.35_f64.sin(), 1e-14);
        }
    }

    /// The point of the rim that touches the incline is at rest.
    #[test]
    fn rolls_without_slip() {
        let disk = DiskOnIncline { g: 9.81, mass: 0.8, radius: 0.15, shape: 0.5, slope: 0.35 };
        assert_near(disk.rim(&[0.0].into(), &[2.0].into()), SVector::zeros(), 1e-15);
        let turn = 0.15 * std::f64::consts::TAU;
        assert_near(disk.rim(&[turn].into(), &[2.0].into()), SVector::zeros(), 1e-14);
        // Half a turn later it is on top and goes twice as fast as the centre.
        let top = disk.rim(&[turn / 2.0].into(), &[2.0].into());
        assert_near(top, 4.0 * SVector::from([0.35_f64.cos(), -0.35_f64.sin(), 0.0]), 1e-14);
    }
}
