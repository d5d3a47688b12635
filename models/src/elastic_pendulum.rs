use linkwork::mechanism;

/// The elastic pendulum, or swinging spring: a particle on a coil spring, in a vertical plane.
///
/// Source: Vitt and Gorelik, *Oscillations of an elastic pendulum* (1933); Lynch, *Resonant motions of the
/// three-dimensional elastic pendulum*, Int. J. Non-Linear Mech. 37 (2002).
///
/// - Coordinates: `length` of the spring, `r`, m; `theta`, its angle `θ` from the vertical, rad, counter-clockwise seen
///   from +z; y points up.
/// - Equations of motion: `m r̈ − m r θ̇² − m g cos θ + k (r − l) = 0`, `m r² θ̈ + 2 m r ṙ θ̇ + m g r sin θ = 0`.
/// - At rest `r₀ = l + m g / k`. For small motions it bounces with `√(k/m)` and swings with `√(g/r₀)`; where the first
///   is twice the second, bouncing turns into swinging and back.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticPendulum {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the particle, kg.
    pub mass: f64,
    /// Stiffness of the spring, N/m.
    pub stiffness: f64,
    /// Free length of the spring, m.
    pub free_length: f64,

    length: Coordinate,
    theta: Coordinate,
    #[particle(mass = mass, at = length * (sin(theta) * x - cos(theta) * y))]
    bob: Particle,
    #[energy(stiffness / 2 * pow(length - free_length, 2))]
    coil: Potential,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near, precisely};
    use linkwork::prelude::*;
    use std::f64::consts::TAU;

    const P: ElasticPendulum = ElasticPendulum { g: 9.81, mass: 0.5, stiffness: 40.0, free_length: 0.8 };

    #[test]
    fn equations_of_motion() {
        let (r, theta, dr, dtheta) = (0.9, 0.7_f64, -0.4, 1.3);
        let (q, v) = (SVector::from([r, theta]), SVector::from([dr, dtheta]));
        let ElasticPendulum { g, mass: m, stiffness: k, free_length: l } = P;
        assert_near(P.mass_matrix(&q), SMatrix::<f64, 2, 2>::new(m, 0.0, 0.0, m * r * r), 1e-15);
        let h1 = -m * r * dtheta * dtheta - m * g * theta.cos() + k * (r - l);
        let h2 = 2.0 * m * r * dr * dtheta + m * g * r * theta.sin();
        assert_near(P.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-14);
    }

    #[test]
    fn bounces_harmonically_where_it_hangs() -> Result<(), Error> {
        let rest = P.free_length + P.mass * P.g / P.stiffness;
        let omega = (P.stiffness / P.mass).sqrt();
        let run = simulate(&P).from([rest + 0.1, 0.0], [0.0, 0.0]).method(precisely());
        for sample in run.duration(2.0).sample_every(0.25) {
            let Sample { t, q, .. } = sample?;
            assert_near(q, SVector::from([rest + 0.1 * (omega * t).cos(), 0.0]), 1e-10);
        }
        Ok(())
    }

    #[test]
    fn period_of_small_swings() -> Result<(), Error> {
        let rest = P.free_length + P.mass * P.g / P.stiffness;
        let end = simulate(&P)
            .from([rest, 1e-4], [0.0, 0.0])
            .method(precisely())
            .until_crossing(Crossing::Falling, |_, _, v| v[1])
            .finish()?;
        assert_close(end.t, TAU * (rest / P.g).sqrt(), 1e-6);
        Ok(())
    }
}
