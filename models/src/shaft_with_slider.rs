use linkwork::mechanism;

/// A slider on a rotating shaft: an arm turns about a vertical pin and carries a sleeve that slides freely along it,
/// outwards, as in a centrifugal governor.
///
/// Source: Meriam and Kraige, *Engineering Mechanics: Dynamics* (2012), ch. 2 (polar coordinates); Landau and Lifshitz,
/// *Mechanics* (1976), §39 (centrifugal force).
///
/// - Coordinates: `bearing`, the shaft's angle `θ`, rad, about the vertical z; `sleeve`, the slider's distance `r` from
///   the axis, m. Input: `motor`, a torque on the shaft, N·m.
/// - Equations of motion: `(J + m r²) θ̈ + 2 m r ṙ θ̇ = τ`, `r̈ = r θ̇²`.
/// - Without a torque the angular momentum `(J + m r²) θ̇` is conserved; at constant `θ̇ = ω`, `r = r₀ cosh ωt`.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftWithSlider {
    /// Moment of inertia of the shaft about its bearing, kg·m².
    pub inertia: f64,
    /// Mass of the slider, kg.
    pub mass: f64,

    #[body(inertia = diagonal(0, inertia, inertia))]
    shaft: Body,
    #[body(mass = mass)]
    slider: Body,
    #[joint(ground -> shaft, about = z)]
    bearing: Pin,
    #[joint(shaft -> slider, along = x)]
    sleeve: Sleeve,
    #[acts(on = bearing)]
    motor: Torque,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near};
    use linkwork::prelude::*;

    const S: ShaftWithSlider = ShaftWithSlider { inertia: 0.4, mass: 0.7 };

    #[test]
    fn equations_of_motion() {
        let (q, v) = (SVector::from([1.1, 0.6]), SVector::from([2.0, -0.5]));
        let mass = SMatrix::<f64, 2, 2>::new(0.4 + 0.7 * 0.36, 0.0, 0.0, 0.7);
        assert_near(S.mass_matrix(&q), mass, 1e-15);
        let bias = [2.0 * 0.7 * 0.6 * -0.5 * 2.0, -0.7 * 0.6 * 4.0];
        assert_near(S.bias_forces(&q, &v), SVector::from(bias), 1e-15);
    }

    #[test]
    fn angular_momentum_is_conserved() -> Result<(), Error> {
        let start = (0.4 + 0.7 * 0.01) * 10.0;
        let run = simulate(&S).from([0.0, 0.1], [10.0, 0.0]).method(ImplicitMidpoint::step(0.001));
        for sample in run.duration(2.0).sample_every(0.1) {
            let Sample { q, v, .. } = sample?;
            assert_close(S.generalized_momentum(&q, &v)[0], start, 1e-12);
        }
        Ok(())
    }

    #[test]
    fn slides_out_as_cosh_at_constant_speed() -> Result<(), Error> {
        let omega = 3.0;
        let end = simulate(&S)
            .from([0.0, 0.1], [omega, 0.0])
            .inputs(|_, q, v| SVector::from([2.0 * S.mass * q[1] * v[1] * v[0]]))
            .method(DormandPrince::new().tolerance(1e-12, 1e-12))
            .duration(1.0)
            .finish()?;
        assert_close(end.q[1], 0.1 * omega.cosh(), 1e-9);
        assert_close(end.q[0], omega, 1e-9);
        Ok(())
    }
}
