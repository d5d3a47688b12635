use linkwork::mechanism;

/// The rattleback, or celt: a half ellipsoid whose heavy axes are turned against those of its shape. Spun one way it begins
/// to rattle, stops and turns the other way.
///
/// Source: Kane and Levinson, *Realistic mathematical modeling of the rattleback*, Int. J. Non-Linear Mech. 17 (1982);
/// Walker, *On a dynamical top*, Q. J. Pure Appl. Math. 28 (1896). [`BENCHMARK`](Self::BENCHMARK) has the figures of the
/// first.
///
/// - Configuration: place and unit quaternion of `pose`; velocity: linear and angular, in the body's axes, which are those
///   of the ellipsoid `x²/a² + y²/b² + z²/c² = 1`. z points up; the centre of mass is below its middle.
/// - It touches the table at `−(a² n₁, b² n₂, c² n₃) / √(a² n₁² + b² n₂² + c² n₃²)` from the middle, where `n` are the
///   components of the upward normal, and that point is at rest.
/// - Nothing dissipates: the energy is constant.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rattleback {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Semi-axis of the ellipsoid along x, m.
    pub a: f64,
    /// Semi-axis of the ellipsoid along y, m.
    pub b: f64,
    /// Semi-axis of the ellipsoid along z, m.
    pub c: f64,
    /// Depth of the centre of mass below the ellipsoid's middle, m.
    pub depth: f64,
    /// Moment of inertia about x, kg·m².
    pub ixx: f64,
    /// Moment of inertia about y, kg·m².
    pub iyy: f64,
    /// Moment of inertia about z, kg·m².
    pub izz: f64,
    /// Product of inertia (entry of the matrix), kg·m².
    pub ixy: f64,

    #[body(mass = mass, com = -depth * z, inertia = [[ixx, ixy, 0], [ixy, iyy, 0], [0, 0, izz]])]
    stone: Body,
    #[joint(ground -> stone)]
    pose: Free,
    #[constraint(rolls(stone.ellipsoid(a, b, c), ground.plane(z)))]
    contact: Rolling,
}

impl Rattleback {
    /// The stone of Kane and Levinson.
    pub const BENCHMARK: Rattleback = Rattleback {
        g: 9.81,
        mass: 1.0,
        a: 0.2,
        b: 0.03,
        c: 0.02,
        depth: 0.01,
        ixx: 2e-4,
        iyy: 1.6e-3,
        izz: 1.7e-3,
        ixy: -2e-5,
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near, precisely};
    use linkwork::nalgebra::{UnitQuaternion, Vector3};
    use linkwork::prelude::*;

    const R: Rattleback = Rattleback::BENCHMARK;

    /// Touching the table in an attitude, with an angular velocity in the body's axes.
    fn state(turn: UnitQuaternion<f64>, w: Vector3<f64>) -> (SVector<f64, 7>, SVector<f64, 6>) {
        let n = turn.inverse() * Vector3::z();
        let squares = Vector3::new(R.a * R.a, R.b * R.b, R.c * R.c);
        let size = squares.dot(&n.component_mul(&n)).sqrt();
        let contact = -squares.component_mul(&n) / size;
        let v = -w.cross(&contact);
        ([0.0, 0.0, size, turn.i, turn.j, turn.k, turn.w].into(), [v.x, v.y, v.z, w.x, w.y, w.z].into())
    }

    #[test]
    fn the_point_that_touches_is_at_rest() {
        assert_eq!((Rattleback::NC, Rattleback::NH, Rattleback::NS), (3, 1, 3));
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.2, 1.1);
        let (q, v) = state(turn, Vector3::new(0.4, -1.0, 3.0));
        assert!(R.constraint_residuals(&q).amax() < 1e-16);
        assert!(R.constraint_rates(&q, &v).amax() < 1e-15);
        let projected = R.project_velocity(&q, &v).expect("regular");
        assert_near(projected, v, 1e-14);
    }

    /// Spun backwards with a tilt of half a degree it comes to turn forwards; spun forwards it keeps turning.
    #[test]
    fn turns_back() -> Result<(), Error> {
        let tilt = 0.5_f64.to_radians();
        for (spin, turns_back) in [(-5.0, true), (5.0, false)] {
            let turn = UnitQuaternion::from_euler_angles(tilt, tilt, 0.0);
            let (q, v) = state(turn, Vector3::new(0.0, 0.0, spin));
            let energy = |q: &_, v: &_| R.kinetic_energy(q, v) + R.potential_energy(q);
            let end = simulate(&R).from(q, v).method(precisely()).duration(6.0).finish()?;
            assert_eq!(end.v[5] / spin < -0.5, turns_back, "{} to {}", spin, end.v[5]);
            assert_eq!(end.v[5] / spin > 0.5, !turns_back, "{} to {}", spin, end.v[5]);
            assert_close(energy(&end.q, &end.v), energy(&q, &v), 1e-10);
            assert!(R.constraint_residuals(&end.q).amax() < 1e-14);
            assert!(R.constraint_rates(&end.q, &end.v).amax() < 1e-13);
        }
        Ok(())
    }
}
