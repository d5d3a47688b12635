use linkwork::mechanism;

/// The gyroscope: a rotor in two massless gimbals, hung off its centre if wanted.
///
/// Source: Goldstein, Poole and Safko, *Classical Mechanics* (2002), §5.7; Magnus, *Kreisel* (1971).
///
/// - Coordinates: Euler's angles `precession` about the vertical z, `nutation` about the line of nodes, `spin` about
///   the rotor's axis: `φ`, `θ`, `ψ`, rad. The gimbals are massless, so the mass matrix is singular where the axis is
///   vertical (`θ = 0`: gimbal lock).
/// - Steady precession at constant `θ`, with `A` the transverse moment of inertia about the pivot, `C` the axial one
///   and the total spin `n = ψ̇ + φ̇ cos θ`: `A φ̇² cos θ − C n φ̇ + m g h = 0`. For a fast rotor `φ̇ ≈ m g h / (C n)`.
/// - Output: `rotor_rate`, the angular velocity of the rotor in the axes of the inner gimbal, `(θ̇, φ̇ sin θ, n)`.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyroscope {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the rotor, kg.
    pub mass: f64,
    /// Distance of its centre of mass from the pivot along its axis, m.
    pub offset: f64,
    /// Moment of inertia about its axis, kg·m².
    pub axial: f64,
    /// Moment of inertia across its axis, about the centre of mass, kg·m².
    pub transverse: f64,

    #[body]
    outer: Body,
    #[body]
    inner: Body,
    #[body(mass = mass, com = offset * z, inertia = diagonal(transverse, transverse, axial))]
    rotor: Body,
    #[joint(ground -> outer, about = z)]
    precession: Pin,
    #[joint(outer -> inner, about = x)]
    nutation: Pin,
    #[joint(inner -> rotor, about = z)]
    spin: Pin,
    #[output(omega(rotor / ground), resolved_in = inner)]
    rotor_rate: Vector,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_near;
    use linkwork::prelude::*;

    const G: Gyroscope = Gyroscope { g: 9.81, mass: 0.5, offset: 0.08, axial: 0.002, transverse: 0.0013 };

    #[test]
    fn steady_precession() {
        let across = G.transverse + G.mass * G.offset * G.offset;
        let (theta, rate) = (0.6_f64, 2.5_f64);
        let total = (across * rate * rate * theta.cos() + G.mass * G.g * G.offset) / (G.axial * rate);
        let q = SVector::from([0.3, theta, 1.0]);
        let v = SVector::from([rate, 0.0, total - rate * theta.cos()]);
        assert_near(G.forward_dynamics(&q, &v, &SVector::zeros()), SVector::zeros(), 1e-11);
    }

    #[test]
    fn mass_matrix() {
        let across = G.transverse + G.mass * G.offset * G.offset;
        let (s, c) = 0.7_f64.sin_cos();
        let m = G.mass_matrix(&SVector::from([0.4, 0.7, 2.0]));
        let spin = G.axial * c;
        let expected = SMatrix::<f64, 3, 3>::new(
            across * s * s + G.axial * c * c,
            0.0,
            spin, //
            0.0,
            across,
            0.0, //
            spin,
            0.0,
            G.axial,
        );
        assert_near(m, expected, 1e-16);
    }

    #[test]
    fn angular_velocity_by_eulers_angles() {
        let (theta, [precession, nutation, spin]) = (0.7_f64, [1.3, -0.4, 20.0]);
        let found = G.rotor_rate(&[0.2, theta, 2.0].into(), &[precession, nutation, spin].into());
        let expected = [nutation, precession * theta.sin(), spin + precession * theta.cos()];
        assert_near(found, SVector::from(expected), 1e-14);
    }
}
