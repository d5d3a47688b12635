//! What the tests of the mechanisms share.

use linkwork::integrate::DormandPrince;
use linkwork::nalgebra::{Isometry3, Rotation3, SMatrix, SVector, Translation3, Vector3};
use linkwork::prelude::{Constrained, Error, Mechanism, Rk4, Sample, simulate};
use std::f64::consts::FRAC_PI_2;

/// Holds what was generated against the closed form: relative to the largest entry, or absolute below one.
#[track_caller]
pub fn assert_near<const R: usize, const C: usize>(
    found: SMatrix<f64, R, C>,
    expected: SMatrix<f64, R, C>,
    tolerance: f64,
) {
    let error = (found - expected).amax() / expected.amax().max(1.0);
    assert!(error <= tolerance, "error {error:e}: found {found} expected {expected}");
}

/// Holds a number that was generated against the closed form: relative to it, or absolute below one.
#[track_caller]
pub fn assert_close(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    assert!(error <= tolerance, "error {error:e}: found {found}, expected {expected}");
}

/// Integration to nearly all digits.
pub fn precisely() -> DormandPrince<f64> {
    DormandPrince::new().tolerance(1e-12, 1e-12)
}

/// Takes steps of `Rk4`, and holds the constraints after every one to the tolerance of the projection: 16 times the
/// machine's precision, relative to entries of the state beyond one. Gives the largest change of the energy, in a first
/// tenth and in all, J.
pub fn drift<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    h: f64,
    steps: usize,
) -> Result<[f64; 2], Error>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64> + Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let energy = |q: &_, v: &_| Mechanism::kinetic_energy(m, q, v) + Mechanism::potential_energy(m, q);
    let start = energy(q, v);
    let run = simulate(m).from(*q, *v).method(Rk4::step(h)).duration(h * steps as f64).sample_every(h);
    let (mut changes, mut count) = ([0.0_f64; 2], 0);
    for sample in run {
        let Sample { t, q, v, .. } = sample?;
        let rounding = 16.0 * f64::EPSILON;
        let (residual, rate) = (m.constraint_residuals(t, &q).amax(), m.constraint_rates(t, &q, &v).amax());
        assert!(residual <= rounding * q.amax().max(1.0), "{residual:e} in step {count}");
        assert!(rate <= rounding * v.amax().max(1.0), "{rate:e} in step {count}");
        let change = (energy(&q, &v) - start).abs();
        changes[1] = changes[1].max(change);
        if 10 * count <= steps {
            changes[0] = changes[0].max(change);
        }
        count += 1;
    }
    assert_eq!(count, steps + 1);
    Ok(changes)
}

/// Complete elliptic integral of the first kind by the arithmetic–geometric mean: `K(k) = ½π / agm(1, √(1 − k²))`,
/// given `k²`.
pub fn elliptic(k2: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k2).sqrt());
    while (a - b).abs() > 1e-15 * a {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    FRAC_PI_2 / a
}

/// A turn about z and a displacement along it: one half of a Denavit–Hartenberg step.
pub fn about_z(angle: f64, d: f64) -> Isometry3<f64> {
    placed(Vector3::z(), angle, d)
}

/// A turn about x and a displacement along it: the other half of a Denavit–Hartenberg step.
pub fn about_x(angle: f64, a: f64) -> Isometry3<f64> {
    placed(Vector3::x(), angle, a)
}

fn placed(axis: Vector3<f64>, angle: f64, distance: f64) -> Isometry3<f64> {
    let turn = Rotation3::new(axis * angle);
    Isometry3::from_parts(Translation3::from(axis * distance), turn.into())
}
