use linkwork::mechanism;

/// Kapitza's pendulum: its pivot is shaken up and down so fast that it stands upside down.
///
/// Source: Kapitza, *Dynamic stability of a pendulum when its point of suspension vibrates* (1951); Landau and
/// Lifshitz, *Mechanics* (1976), §30, problem 1.
///
/// - Coordinate: `pin`, the angle `θ` from the vertical, hanging, rad, counter-clockwise seen from +z; y points up. The
///   pivot is at `a cos Ωt` above the origin, so the functions take the time first.
/// - Equation of motion: `m l² θ̈ + m l (g − a Ω² cos Ωt) sin θ = 0`.
/// - Averaged over a fast vibration of small amplitude: `l² θ̈ + g l sin θ + ½ a² Ω² sin θ cos θ = 0`. Upright is
///   stable if `a² Ω² > 2 g l`; it then swings about it with the frequency `√(a² Ω² / (2 l²) − g / l)`.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KapitzaPendulum {
    /// Acceleration of free fall, m/s².
    pub g: f64,
    /// Mass of the particle, kg.
    pub mass: f64,
    /// Length of the rod, m.
    pub length: f64,
    /// Amplitude of the pivot's vibration, m.
    pub amplitude: f64,
    /// Angular frequency of the pivot's vibration, rad/s.
    pub frequency: f64,

    #[point(at = amplitude * cos(frequency * t) * y)]
    pivot: Point,
    #[body]
    rod: Body,
    #[particle(mass = mass, at = rod.at(-length * y))]
    bob: Particle,
    #[joint(pivot -> rod, about = z)]
    pin: Pin,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near};
    use linkwork::prelude::*;
    use std::f64::consts::{PI, TAU};

    const P: KapitzaPendulum =
        KapitzaPendulum { g: 9.81, mass: 0.2, length: 0.5, amplitude: 0.01, frequency: 1000.0 };

    #[test]
    fn equation_of_motion() {
        let (t, theta, rate) = (0.0023, 0.9_f64, -1.7);
        let shaken = P.g - P.amplitude * P.frequency * P.frequency * (P.frequency * t).cos();
        let ml = P.mass * P.length;
        let (q, v) = (SVector::from([theta]), SVector::from([rate]));
        assert_near(P.mass_matrix(t, &q), SMatrix::<f64, 1, 1>::new(ml * P.length), 1e-15);
        assert_near(P.bias_forces(t, &q, &v), SVector::from([ml * shaken * theta.sin()]), 1e-12);
    }

    #[test]
    fn stands_upright() -> Result<(), Error> {
        let (a, l) = (P.amplitude * P.frequency, P.length);
        let slow = (a * a / (2.0 * l * l) - P.g / l).sqrt();
        let method = DormandPrince::new().tolerance(1e-9, 1e-9);
        let run = simulate(&P).from([PI + 0.05], [0.0]).method(method);
        // The ripple on the averaged motion is a / l = 0.02 of it, and so is what the start adds to its amplitude.
        for sample in run.duration(TAU / slow).sample_every(TAU / slow / 16.0) {
            let Sample { t, q, .. } = sample?;
            assert_close((q[0] - PI) / 0.05, (slow * t).cos(), 0.06);
        }
        Ok(())
    }

    #[test]
    fn falls_if_shaken_too_slowly() -> Result<(), Error> {
        let weak = KapitzaPendulum { frequency: 0.9 * (2.0 * P.g * P.length).sqrt() / P.amplitude, ..P };
        let end = simulate(&weak).from([PI + 0.05], [0.0]).until(|_, q, _| q[0] - 1.5 * PI);
        assert!(end.duration(5.0).finish()?.t < 5.0);
        Ok(())
    }
}
