use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::prelude::*;
use linkwork_models::RollerOnIncline;

#[test]
fn roller_has_textbook_accelerations_and_forces() {
    assert_eq!((RollerOnIncline::NC, RollerOnIncline::NH, RollerOnIncline::NS), (2, 1, 1));
    for (shape, part) in [(0.4, 5.0 / 7.0), (0.5, 2.0 / 3.0), (1.0, 0.5)] {
        let (g, mass, slope) = (9.81, 0.8, 0.35_f64);
        let body = RollerOnIncline { g, mass, radius: 0.15, shape, slope };
        let (s, c) = slope.sin_cos();
        let q = SVector::from([0.15 * s, 0.15 * c, 0.4]);
        let v = SVector::from([1.3 * c, -1.3 * s, -1.3 / 0.15]);
        assert!(body.constraint_residuals(&q).amax() < 1e-16);
        assert!(body.constraint_rates(&q, &v).amax() < 1e-15);
        let (a, forces) = body.constrained_dynamics(&q, &v, &SVector::zeros());
        let down = part * g * s;
        assert_matrix_close(a, [down * c, -down * s, -down / 0.15].into(), 1e-14);
        assert_number_close(forces[0], mass * g * c, 1e-14);
        assert_number_close(forces[1].abs(), (1.0 - part) * mass * g * s, 1e-14);
    }
}
