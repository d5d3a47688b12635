use crate::testing::assert_matrix_close;
use linkwork::prelude::*;
use linkwork_models::RemotelyDrivenArm;

const A: RemotelyDrivenArm =
    RemotelyDrivenArm { g: 9.81, m1: 2.0, m2: 1.3, l1: 0.6, l2: 0.5, rotor: 3e-5, ratio: 60.0 };

#[test]
fn remote_drive_has_textbook_dynamics() {
    let RemotelyDrivenArm { g, m1, m2, l1, l2, rotor, ratio } = A;
    let (p1, p2, d1, d2) = (0.4_f64, 1.5_f64, 2.0, -0.8);
    let (q, v) = (SVector::from([p1, p2]), SVector::from([d1, d2]));
    let geared = ratio * ratio * rotor;
    let (s, c) = (p2 - p1).sin_cos();
    let both = m2 * l1 * l2 / 2.0;
    let m11 = (m1 / 3.0 + m2) * l1 * l1 + geared;
    let m22 = m2 * l2 * l2 / 3.0 + geared;
    assert_matrix_close(A.mass_matrix(&q), SMatrix::<f64, 2, 2>::new(m11, both * c, both * c, m22), 1e-14);
    let h1 = -both * s * d2 * d2 + (m1 / 2.0 + m2) * g * l1 * p1.cos();
    let h2 = both * s * d1 * d1 + m2 * g * l2 / 2.0 * p2.cos();
    assert_matrix_close(A.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-13);
    let u = SVector::from([1.5, -0.7]);
    assert_matrix_close(A.generalized_forces(&q, &u), u, 1e-15);
    let hand = [l1 * p1.cos() + l2 * p2.cos(), l1 * p1.sin() + l2 * p2.sin(), 0.0];
    assert_matrix_close(A.hand(&q), SVector::from(hand), 1e-15);
}
