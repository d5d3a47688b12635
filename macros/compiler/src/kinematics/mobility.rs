//! Degrees of freedom. A configuration that satisfies the constraints is searched numerically, with the
//! mechanism's constants and samples of its parameters, and the independent rows are counted there. If none
//! is found, Grübler's count is used, which assumes that all rows are independent.

use super::redundancy::OrthonormalRowBasis;
use super::rows::{CompiledConstraintRows, random_configuration};
use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::expr::replace::symbols_in;
use crate::mechanism::{Chart, ConstraintPivot, DegreeOfFreedomCounts, InV, Model, Quantity};

/// Random starts of the search; a third of them if parameters are sampled, whose values may be incompatible.
const STARTS: u64 = 24;
/// Number of configurations that must agree before a mechanism is reported as immobile.
const WITNESSES: usize = 3;
/// Approximate bound on the operations of the search: large mechanisms are searched from fewer starts.
const WORK: u64 = 40_000_000;
/// Maximum number of Newton steps for closing the loops from each start.
const STEPS: u64 = 60;
/// Residual below which the loop constraints count as satisfied.
const CLOSED: f64 = 1e-11;
/// Residuals above this, m or rad, are not reduced to zero by more steps.
const OPEN: f64 = 1e-4;

/// Pivots below this fraction of the largest entry count as zero.
const SMALL_PIVOT: f64 = 1e-6;

/// A configuration, with the seed of the parameters for which it satisfies the constraints.
pub type ConfigurationSample = (Vec<f64>, u64);

/// Returns some configurations that satisfy the constraints, the first near the configuration with all
/// coordinates zero if possible. Reports loops that cannot be closed if all their values are constant.
pub fn sample_feasible_configurations(
    model: &Model<'_>,
    rows: &CompiledConstraintRows<'_>,
    cx: &mut Diagnostics,
) -> Vec<ConfigurationSample> {
    let mut found: Vec<ConfigurationSample> = Vec::new();
    let mut worst: Option<(usize, f64)> = None;
    let wanted = if residuals_depend_only_on_configuration(model) { STARTS } else { STARTS / 3 };
    let possible = WORK / rows.evaluation_cost().max(1);
    let starts = wanted.min(possible / STEPS).max(1);
    let steps = STEPS.min(possible);
    for seed in 0..starts {
        match close_loops(model, rows, seed, steps) {
            Ok(q) => found.push((q, seed)),
            Err(open) if worst.is_none_or(|(_, best)| open.1 < best) => worst = Some(open),
            Err(_) => {}
        }
        if found.len() == WITNESSES {
            return found;
        }
    }
    if let Some((row, open)) = worst.filter(|(_, open)| *open > OPEN && found.is_empty() && starts == STARTS)
    {
        let c = &model.constraints[row];
        cx.report_error(c.place.clone(), format!("no configuration was found that satisfies `{}`", c.name))
            .add_help(format!("the smallest residual is {open:.3}: check the lengths and axes"));
    }
    found
}

/// Returns true if no residual depends on a parameter or on time.
fn residuals_depend_only_on_configuration(model: &Model<'_>) -> bool {
    let residuals: Vec<Expr<'_>> = model.constraints.iter().filter_map(|c| c.residual).collect();
    symbols_in(&residuals)
        .into_iter()
        .all(|s| !matches!(Quantity::from_symbol(s), Quantity::Parameter(_) | Quantity::Time))
}

/// Counts the degrees of freedom, of configurations and of velocities, in the assembly mode of the first
/// sample that can move. Linkages can have other assembly modes, in which links fold onto each other, with
/// more degrees of freedom. Reports a mechanism that cannot move. A mechanism driven in time moves even
/// without a degree of freedom.
pub fn degrees_of_freedom(
    model: &Model<'_>,
    rows: &CompiledConstraintRows<'_>,
    samples: &[ConfigurationSample],
    cx: &mut Diagnostics,
) -> DegreeOfFreedomCounts {
    let (nv, nc) = (model.nv(), model.constraints.len());
    let dof_count_at_sample = |(q, seed): &ConfigurationSample, count: usize| {
        let mut basis = OrthonormalRowBasis::default();
        rows.jacobian(q, *seed)[..count].iter().for_each(|row| basis.add_independent_row(row, 1e-7));
        nv - basis.rank()
    };
    // The first sample that can move; others may be locked.
    let sample = samples.iter().find(|w| dof_count_at_sample(w, nc) > 0).or(samples.first());
    let dof_count_with_first_rows =
        |rank: usize| sample.map_or(nv.saturating_sub(rank), |w| dof_count_at_sample(w, rank));
    let freedom = DegreeOfFreedomCounts {
        coordinates: dof_count_with_first_rows(model.holonomic_count()),
        velocities: dof_count_with_first_rows(nc),
    };
    let is_mechanism_undriven = || samples.iter().all(|sample| !moves_at_zero_velocity(model, rows, sample));
    if freedom.velocities == 0 && !samples.is_empty() && is_mechanism_undriven() {
        let place = model.constraints.last().map_or(&model.place, |c| &c.place);
        cx.report_error(place.clone(), "this mechanism cannot move").add_help(format!(
            "its {nv} coordinates are fixed by {nc} constraints: remove a joint or a constraint"
        ));
    }
    freedom
}

/// Returns true if the mechanism moves at zero velocities: frames depend on time, or the rate of a constraint
/// has a velocity-free term.
fn moves_at_zero_velocity(
    model: &Model<'_>,
    rows: &CompiledConstraintRows<'_>,
    (q, seed): &ConfigurationSample,
) -> bool {
    let placements: Vec<Expr<'_>> =
        model.links.iter().flat_map(|link| link.placement.all_expressions()).collect();
    rows.is_violated_at_zero_velocity(q, *seed)
        || symbols_in(&placements).into_iter().any(|s| Quantity::from_symbol(s) == Quantity::Time)
}

/// Returns a pivot for each constraint among the velocities that need not be independent, in the order of an
/// elimination that is well-conditioned at a sample. Returns `None` if some constraint has no pivot.
pub fn pivot_velocity_per_constraint(
    model: &Model<'_>,
    rows: &CompiledConstraintRows<'_>,
    samples: &[ConfigurationSample],
    independent: &[usize],
) -> Option<Vec<ConstraintPivot>> {
    let (q, seed) = samples.first()?;
    let mut rows = rows.jacobian(q, *seed);
    let largest = rows.iter().flatten().fold(0.0_f64, |a, b| a.max(b.abs()));
    let mut pivots: Vec<ConstraintPivot> = Vec::new();
    while pivots.len() < rows.len() {
        let open = (0..rows.len()).filter(|i| pivots.iter().all(|pivot| pivot.constraint != *i));
        let all = open.flat_map(|i| (0..model.nv()).map(move |j| (i, j)));
        let allowed = all.filter(|(_, j)| !independent.contains(j));
        let (row, column) = allowed.max_by(|a, b| rows[a.0][a.1].abs().total_cmp(&rows[b.0][b.1].abs()))?;
        let pivot = rows[row][column];
        if pivot.abs() <= SMALL_PIVOT * largest {
            return None;
        }
        pivots.push(ConstraintPivot { constraint: row, velocity: InV(column) });
        let own = rows[row].clone();
        for (i, other) in rows.iter_mut().enumerate() {
            if i != row {
                let factor = other[column] / pivot;
                other.iter_mut().zip(&own).for_each(|(x, o)| *x -= factor * o);
            }
        }
    }
    Some(pivots)
}

/// Closes the loops by the Levenberg–Marquardt method from a random configuration. On failure, returns the
/// row with the largest residual, and the residual.
fn close_loops(
    model: &Model<'_>,
    rows: &CompiledConstraintRows<'_>,
    seed: u64,
    steps: u64,
) -> Result<Vec<f64>, (usize, f64)> {
    let spread = [0.2, 1.0, 3.0][(seed % 3) as usize];
    let mut q = random_configuration(model, seed);
    for chart in &model.charts {
        if let Chart::Plain(k, _) = chart {
            q[k.0] *= spread;
        }
    }
    let sum_of_squares = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let mut r = rows.residuals(&q, seed);
    let mut damping = 1e-3;
    for _ in 0..steps {
        if sum_of_squares(&r) <= CLOSED * CLOSED || !sum_of_squares(&r).is_finite() {
            break;
        }
        let jacobian = &rows.jacobian(&q, seed)[..r.len()];
        let step = damped_least_squares_step(jacobian, &r, damping);
        let next = displaced_configuration(model, &q, &step);
        let trial = rows.residuals(&next, seed);
        if sum_of_squares(&trial) < sum_of_squares(&r) {
            (q, r, damping) = (next, trial, damping * 0.1);
        } else {
            damping *= 10.0;
        }
    }
    let worst = r.iter().map(|r| r.abs()).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    match worst {
        Some((row, open)) if open > CLOSED || open.is_nan() => Err((row, open)),
        _ => Ok(q),
    }
}

/// Returns the damped least-squares step `−Jᵀ (J Jᵀ + damping)⁻¹ r` by elimination.
fn damped_least_squares_step(rows: &[Vec<f64>], r: &[f64], damping: f64) -> Vec<f64> {
    let n = rows.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut m: Vec<Vec<f64>> = rows.iter().map(|a| rows.iter().map(|b| dot(a, b)).collect()).collect();
    let mut y = r.to_vec();
    for (k, row) in m.iter_mut().enumerate() {
        row[k] = row[k] * (1.0 + damping) + 1e-12;
    }
    for k in 0..n {
        for i in k + 1..n {
            let factor = m[i][k] / m[k][k];
            for j in k..n {
                m[i][j] -= factor * m[k][j];
            }
            y[i] -= factor * y[k];
        }
    }
    for k in (0..n).rev() {
        let rest: f64 = (k + 1..n).map(|j| m[k][j] * y[j]).sum();
        y[k] = (y[k] - rest) / m[k][k];
    }
    let columns = rows.first().map_or(0, Vec::len);
    (0..columns).map(|j| -(0..n).map(|i| rows[i][j] * y[i]).sum::<f64>()).collect()
}

/// Returns `q ⊕ dv`, to first order for free joints.
fn displaced_configuration(model: &Model<'_>, q: &[f64], dv: &[f64]) -> Vec<f64> {
    let mut out = q.to_vec();
    for chart in &model.charts {
        match *chart {
            Chart::Plain(k, v) => out[k.0] += dv[v.0],
            Chart::Ball(k, v) => {
                rotate_quaternion(&mut out[k.range_of_entries(4)], &dv[v.range_of_entries(3)])
            }
            Chart::Free(k, v) => {
                let shift = rotate_vector(&q[(k + 3).range_of_entries(4)], &dv[v.range_of_entries(3)]);
                out[k.range_of_entries(3)].iter_mut().zip(shift).for_each(|(x, by)| *x += by);
                rotate_quaternion(&mut out[(k + 3).range_of_entries(4)], &dv[(v + 3).range_of_entries(3)]);
            }
        }
    }
    out
}

/// Rotates a quaternion x y z w by a small rotation vector in body axes.
fn rotate_quaternion(q: &mut [f64], w: &[f64]) {
    let [x, y, z, s] = [q[0], q[1], q[2], q[3]];
    let [a, b, c] = [w[0] / 2.0, w[1] / 2.0, w[2] / 2.0];
    let next = [
        x + s * a + y * c - z * b,
        y + s * b + z * a - x * c,
        z + s * c + x * b - y * a,
        s - x * a - y * b - z * c,
    ];
    let norm = next.iter().map(|c| c * c).sum::<f64>().sqrt();
    q.iter_mut().zip(next).for_each(|(q, next)| *q = next / norm);
}

/// Rotates a vector by a quaternion x y z w.
fn rotate_vector(q: &[f64], v: &[f64]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let (u, v) = ([q[0], q[1], q[2]], [v[0], v[1], v[2]]);
    let once = cross(u, v);
    let twice = cross(u, once);
    std::array::from_fn(|k| v[k] + 2.0 * (q[3] * once[k] + twice[k]))
}
