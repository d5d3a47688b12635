use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::prelude::*;
use linkwork_models::CoplanarDoublePendulum;

const P: CoplanarDoublePendulum = CoplanarDoublePendulum { g: 9.81, m1: 1.2, m2: 0.7, l1: 0.9, l2: 0.6 };

#[test]
fn double_pendulum_matches_its_lagrangian() {
    let CoplanarDoublePendulum { g, m1, m2, l1, l2 } = P;
    let (a, b, da, db) = (0.7_f64, -1.2_f64, 1.4, 0.9);
    let (q, v) = (SVector::from([a, b]), SVector::from([da, db]));
    let (s, c) = (a - b).sin_cos();
    let kinetic =
        (m1 + m2) * l1 * l1 * da * da / 2.0 + m2 * l2 * l2 * db * db / 2.0 + m2 * l1 * l2 * da * db * c;
    assert_number_close(P.kinetic_energy(&q, &v), kinetic, 1e-14);
    let potential = -(m1 + m2) * g * l1 * a.cos() - m2 * g * l2 * b.cos();
    assert_number_close(P.potential_energy(&q), potential, 1e-14);
    // Lagrange's equations of the documented Lagrangian.
    let h1 = m2 * l1 * l2 * s * db * db + (m1 + m2) * g * l1 * a.sin();
    let h2 = -m2 * l1 * l2 * s * da * da + m2 * g * l2 * b.sin();
    assert_matrix_close(P.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-13);
}

/// Checks that a small deflection in a mode shape has an acceleration in the same shape.
#[test]
fn mode_shape_acceleration_has_the_same_shape() {
    let equal = CoplanarDoublePendulum { l2: P.l1, ..P };
    let (sum, l) = (P.m1 + P.m2, P.l1);
    for sign in [-1.0, 1.0] {
        let omega2 = P.g / l * (sum + sign * (sum * P.m2).sqrt()) / P.m1;
        // The first equation gives (m₁ + m₂) (g/l − ω²) φ₁ = m₂ ω² φ₂.
        let shape = SVector::from([P.m2 * omega2, sum * (P.g / l - omega2)]).normalize();
        let a = equal.forward_dynamics(&(1e-5 * shape), &SVector::zeros(), &SVector::zeros());
        assert_matrix_close(a / 1e-5, -omega2 * shape, 1e-8);
    }
}
