//! Checks of gallery mechanisms over a million steps, and of the longest gallery example.

#[path = "../../models/src/four_bar.rs"]
mod four_bar;
#[path = "../../models/examples/passive_walker.rs"]
mod passive_walker;
#[path = "../../models/src/rolling_disk.rs"]
mod rolling_disk;

use four_bar::FourBar;
use linkwork::prelude::*;
use rolling_disk::RollingDisk;

/// Integrates with `Rk4` and checks the constraints after each step to the tolerance of the projection: 16
/// times machine precision, relative to state entries above one. Returns the largest energy change in the
/// first tenth and in the whole run, J.
pub fn check_constraint_drift<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    h: f64,
    steps: usize,
) -> Result<[f64; 2], Error>
where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64> + Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let total_energy =
        |q: &_, v: &_| Mechanism::kinetic_energy(m, 0.0, q, v) + Mechanism::potential_energy(m, 0.0, q);
    let start = total_energy(q, v);
    let run = simulate(m).from(*q, *v).method(Rk4::step(h)).duration(h * steps as f64).sample_every(h);
    let (mut changes, mut count) = ([0.0_f64; 2], 0);
    for sample in run {
        let Sample { t, q, v, .. } = sample?;
        let rounding = 16.0 * f64::EPSILON;
        let (residual, rate) = (m.constraint_residuals(t, &q).amax(), m.constraint_rates(t, &q, &v).amax());
        assert!(residual <= rounding * q.amax().max(1.0), "{residual:e} in step {count}");
        assert!(rate <= rounding * v.amax().max(1.0), "{rate:e} in step {count}");
        let change = (total_energy(&q, &v) - start).abs();
        changes[1] = changes[1].max(change);
        if 10 * count <= steps {
            changes[0] = changes[0].max(change);
        }
        count += 1;
    }
    assert_eq!(count, steps + 1);
    Ok(changes)
}

/// Checks that the loop of a linkage is closed after a million steps as accurately as after the first. The
/// energy drifts linearly in time, and less with smaller steps, as the order of the method predicts.
#[test]
fn linkage_stays_closed_for_a_million_steps() -> Result<(), Error> {
    let m = FourBar { g: 9.81, density: 0.8, a: 0.3, b: 0.9, c: 0.7, d: 0.8 };
    let q = m.assemble(&[0.7, 0.2, 1.8].into(), &[0]).expect("the crank goes all the way round");
    let still = SVector::zeros();
    let [tenth, all] = check_constraint_drift(&m, &q, &still, 1e-3, 1_000_000)?;
    assert!(all < 12.0 * tenth && all < 1e-6, "{tenth:e} J, then {all:e} J");
    let [[_, coarse], [_, fine]] = [
        check_constraint_drift(&m, &q, &still, 8e-3, 5_000)?,
        check_constraint_drift(&m, &q, &still, 4e-3, 10_000)?,
    ];
    assert!(coarse > 15.0 * fine, "{coarse:e} J and {fine:e} J");
    Ok(())
}

/// A disk that nods about its steady circle keeps its contact with the table and does not slip for a million
/// steps.
#[test]
fn rolling_disk_does_not_slip_for_a_million_steps() -> Result<(), Error> {
    let m = RollingDisk { g: 9.81, m: 2.0, radius: 0.4 };
    // The angular velocity in the axes that lean but do not roll.
    let ((s, c), r, u) = (0.35_f64.sin_cos(), m.radius, [0.4, -1.5, 2.4]);
    let rates = [u[2] / c, u[0], u[1] - u[2] * s / c];
    let q = [0.0, 0.0, r * c, 0.0, 0.35, 0.7].into();
    let v = [r * u[1], -r * u[0] * c, -r * u[0] * s, rates[0], rates[1], rates[2]].into();
    let [tenth, all] = check_constraint_drift(&m, &q, &v, 1e-3, 1_000_000)?;
    assert!(all < 12.0 * tenth && all < 1e-6, "{tenth:e} J, then {all:e} J");
    let [[_, coarse], [_, fine]] =
        [check_constraint_drift(&m, &q, &v, 8e-3, 5_000)?, check_constraint_drift(&m, &q, &v, 4e-3, 10_000)?];
    assert!(coarse > 15.0 * fine, "{coarse:e} J and {fine:e} J");
    Ok(())
}
