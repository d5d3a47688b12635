//! Comparison of computed numbers with reference values, for tests.

use linkwork::Mechanism;
use linkwork::nalgebra::SVector;
use std::fmt::Display;

use crate::random::Random;

/// Panics unless every entry satisfies `|actual − expected| ≤ tolerance · (1 + |expected|)`. NaN fails.
#[track_caller]
pub fn assert_close(what: impl Display, actual: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(actual.len(), expected.len(), "{what}: number of entries");
    for (i, (a, e)) in actual.iter().zip(expected).enumerate() {
        let error = (a - e).abs() / (1.0 + e.abs());
        assert!(
            error <= tolerance,
            "{what}, entry {i} (column by column): {a:e} is not {e:e}; relative error {error:.2e}, allowed \
             {tolerance:.0e}"
        );
    }
}

/// Panics unless all entries agree with the expected ones, with errors relative to the largest expected
/// entry.
#[track_caller]
pub fn assert_close_relative_to_largest(what: &str, actual: &[f64], expected: &[f64], tolerance: f64) {
    let scale = expected.iter().fold(1.0_f64, |m, e| m.max(e.abs()));
    let divide_by_scale = |x: &[f64]| x.iter().map(|x| x / scale).collect::<Vec<_>>();
    assert_close(what, &divide_by_scale(actual), &divide_by_scale(expected), tolerance);
}

/// Panics unless two mechanisms with the same coordinates have the same equations of motion and energies, to
/// `tolerance`, at `states` random states.
#[track_caller]
pub fn assert_same_dynamics<A, B, const NQ: usize, const NV: usize, const NA: usize, const NB: usize>(
    one: &A,
    other: &B,
    states: usize,
    tolerance: f64,
) where
    A: Mechanism<NQ, NV, NA, Scalar = f64>,
    B: Mechanism<NQ, NV, NB, Scalar = f64>,
{
    assert_close("neutral", one.neutral().as_slice(), other.neutral().as_slice(), 0.0);
    let mut random = Random::new(1);
    for _ in 0..states {
        let q = random.random_configuration(one);
        let [v, a, tau, dv] = [
            random.random_vector(2.0),
            random.random_vector(2.0),
            random.random_vector(5.0),
            random.random_vector(0.5),
        ];
        let assert_close_entries = |what: &str, a: &[f64], b: &[f64]| assert_close(what, a, b, tolerance);
        let assert_close_vectors = |what: &str, a: SVector<f64, NV>, b: SVector<f64, NV>| {
            assert_close_entries(what, a.as_slice(), b.as_slice())
        };

        assert_close_entries(
            "mass matrix",
            one.mass_matrix(0.0, &q).as_slice(),
            other.mass_matrix(0.0, &q).as_slice(),
        );
        assert_close_vectors("bias forces", one.bias_forces(0.0, &q, &v), other.bias_forces(0.0, &q, &v));
        assert_close_vectors(
            "inverse dynamics",
            one.inverse_dynamics(0.0, &q, &v, &a),
            other.inverse_dynamics(0.0, &q, &v, &a),
        );
        // The condition of M enters: the comparison is of the forces that correspond to the difference of
        // accelerations.
        let acceleration = other.forward_dynamics(0.0, &q, &v, &tau);
        assert_close_vectors("forward dynamics", one.inverse_dynamics(0.0, &q, &v, &acceleration), tau);
        assert_close_vectors(
            "forward dynamics",
            one.forward_dynamics(0.0, &q, &v, &one.inverse_dynamics(0.0, &q, &v, &a)),
            a,
        );
        assert_close_vectors(
            "momentum",
            one.generalized_momentum(0.0, &q, &v),
            other.generalized_momentum(0.0, &q, &v),
        );
        assert_close_vectors(
            "momentum rate",
            one.momentum_rate(0.0, &q, &v),
            other.momentum_rate(0.0, &q, &v),
        );
        assert_close_vectors("tangent rate", one.tangent_rate(&dv, &v), other.tangent_rate(&dv, &v));
        assert_close_entries(
            "kinetic energy",
            &[one.kinetic_energy(0.0, &q, &v)],
            &[other.kinetic_energy(0.0, &q, &v)],
        );
        assert_close_entries(
            "potential energy",
            &[one.potential_energy(0.0, &q)],
            &[other.potential_energy(0.0, &q)],
        );
        assert_close_entries(
            "integrate",
            one.integrate(&q, &dv).as_slice(),
            other.integrate(&q, &dv).as_slice(),
        );
    }
}
