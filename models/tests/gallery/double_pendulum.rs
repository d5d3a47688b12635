use crate::testing::assert_matrix_close;
use linkwork::prelude::*;
use linkwork_models::DoublePendulum;

#[test]
fn double_pendulum_mass_and_bias_match_formulas() {
    let DoublePendulum { g, m1, m2, l1, l2 } = DoublePendulum { g: 9.81, m1: 1.2, m2: 0.7, l1: 0.9, l2: 0.6 };
    let p = DoublePendulum { g, m1, m2, l1, l2 };
    for (a, b, da, db) in [(0.4, -1.1, 2.0, -0.5), (2.9, 1.3, -0.7, 3.1)] {
        let (q, v) = (SVector::from([a, b]), SVector::from([da, db]));
        let (c, s) = (f64::cos(b), f64::sin(b));
        let m22 = m2 * l2 * l2 / 3.0;
        let m12 = m22 + m2 * l1 * l2 * c / 2.0;
        let m11 = (m1 / 3.0 + m2) * l1 * l1 + m22 + m2 * l1 * l2 * c;
        assert_matrix_close(p.mass_matrix(&q), SMatrix::<f64, 2, 2>::new(m11, m12, m12, m22), 1e-14);
        let lower = m2 * g * l2 / 2.0 * f64::sin(a + b);
        let h1 = -m2 * l1 * l2 * s * (da + db / 2.0) * db + (m1 / 2.0 + m2) * g * l1 * f64::sin(a) + lower;
        let h2 = m2 * l1 * l2 / 2.0 * s * da * da + lower;
        assert_matrix_close(p.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-14);
    }
}
