use linkwork::mechanism;

/// Two carts with springs, a dashpot and an inerter: a mass that is kept quiet by another one tuned to the disturbance.
///
/// Source: Den Hartog, *Mechanical Vibrations* (1956), ch. 3 (tuned absorber); Smith, *Synthesis of mechanical
/// networks: the inerter*, IEEE Trans. Automatic Control 47 (2002).
///
/// - Coordinates: `rail1` and `rail2`, the displacements of the carts, `x₁` and `x₂`, m; all springs are slack at zero.
///   Input: `shaker`, a force on the first cart, N.
/// - Equations of motion: `M = [[m₁ + b, −b], [−b, m₂ + b]]`, `C = c [[1, −1], [−1, 1]]`,
///   `K = [[k₁ + k₂, −k₂], [−k₂, k₂]]`: the inerter adds to the mass matrix as a spring does to the stiffness.
/// - Without the dashpot and shaken with `ω = √(k₂ / (m₂ + b))` the first cart stands still, while the second moves by
///   `F / (ω² b − k₂)`.
#[mechanism]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TunedSuspension {
    /// Mass of the first cart, kg.
    pub m1: f64,
    /// Mass of the second cart, kg.
    pub m2: f64,
    /// Stiffness between wall and first cart, N/m.
    pub k1: f64,
    /// Stiffness between the carts, N/m.
    pub k2: f64,
    /// Coefficient of the dashpot between the carts, N·s/m.
    pub damping: f64,
    /// Inertance of the inerter between the carts, kg.
    pub inertance: f64,

    #[body(mass = m1)]
    first: Body,
    #[body(mass = m2)]
    second: Body,
    #[joint(ground -> first, along = x)]
    rail1: Sleeve,
    #[joint(ground -> second, along = x)]
    rail2: Sleeve,
    #[acts(between = (ground, first), stiffness = k1)]
    anchor: Spring,
    #[acts(between = (first, second), stiffness = k2)]
    coil: Spring,
    #[acts(between = (first, second), damping = damping)]
    damper: Dashpot,
    #[acts(between = (first, second), inertance = inertance)]
    inerter: Inerter,
    #[acts(on = rail1)]
    shaker: Force,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_close, assert_near, precisely};
    use linkwork::prelude::*;

    const S: TunedSuspension =
        TunedSuspension { m1: 10.0, m2: 0.8, k1: 900.0, k2: 120.0, damping: 3.0, inertance: 0.5 };

    #[test]
    fn equations_of_motion() {
        let matrix = |a, b, c| SMatrix::<f64, 2, 2>::new(a, b, b, c);
        assert_near(S.mass_matrix(&SVector::zeros()), matrix(10.5, -0.5, 1.3), 1e-14);
        let (q, v) = (SVector::from([0.02, -0.05]), SVector::from([0.7, 0.3]));
        let bias = matrix(1020.0, -120.0, 120.0) * q + matrix(3.0, -3.0, 3.0) * v;
        assert_near(S.bias_forces(&q, &v), bias, 1e-13);
        let energy = 450.0 * q[0] * q[0] + 60.0 * (q[0] - q[1]).powi(2);
        assert_close(S.potential_energy(&q), energy, 1e-14);
    }

    #[test]
    fn shaken_cart_stands_still() -> Result<(), Error> {
        let tuned = TunedSuspension { damping: 0.0, ..S };
        let omega = (tuned.k2 / (tuned.m2 + tuned.inertance)).sqrt();
        let swing = 2.0 / (omega * omega * tuned.inertance - tuned.k2);
        let run = simulate(&tuned)
            .from([0.0, swing], [0.0, 0.0])
            .inputs(|t, _, _| SVector::from([2.0 * (omega * t).cos()]))
            .method(precisely());
        for sample in run.duration(3.0).sample_every(0.3) {
            let Sample { t, q, .. } = sample?;
            assert_near(q, SVector::from([0.0, swing * (omega * t).cos()]), 1e-9);
        }
        Ok(())
    }
}
