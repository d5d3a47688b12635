//! Redundant rows of constraints, such as those of spatial joints in a planar mechanism or of loops that
//! share a condition. They are found in random configurations and in some that satisfy the constraints, for
//! random parameters, so that only rows that are redundant in every configuration are recognised.

use super::mobility::ConfigurationSample;
use super::rows::{CompiledConstraintRows, random_configuration, symbol_value_at_rest};
use crate::diag::Diagnostics;
use crate::expr::eval::Tape;
use crate::mechanism::{Constraint, Model};

/// A row counts as a linear combination of others if its relative remainder is below this tolerance.
const TOLERANCE: f64 = 1e-9;
/// Number of random configurations in which redundancy is tested.
const SAMPLES: u64 = 3;

/// Rounding error of a row that is zero, relative to the other rows of the same vector.
const NOISE: f64 = 1e-12;
/// Rounding error of a row that is zero, relative to all rows, whose units may differ.
const ROUNDING: f64 = 1e-15;

/// Returns for each row whether no velocity influences it in any configuration, up to rounding. An example is
/// the height of a wheel whose axle has a constant height.
pub fn velocity_independent_row_flags(model: &Model<'_>, rows: &CompiledConstraintRows<'_>) -> Vec<bool> {
    let sample_jacobian = |seed| rows.jacobian(&random_configuration(model, seed), seed);
    let samples: Vec<Vec<Vec<f64>>> = (0..SAMPLES).map(sample_jacobian).collect();
    let group_of_row = |row: usize| model.constraints[row].group;
    let is_negligible_row = |sizes: &[f64], row: usize| {
        let all = sizes.iter().copied().fold(0.0, f64::max);
        let own = (0..sizes.len())
            .filter(|k| group_of_row(*k) == group_of_row(row))
            .map(|k| sizes[k])
            .fold(0.0, f64::max);
        sizes[row] <= NOISE * own || sizes[row] <= ROUNDING * all
    };
    let sizes: Vec<Vec<f64>> =
        samples.iter().map(|j| j.iter().map(|row| dot(row, row).sqrt()).collect()).collect();
    let sample_zero_rows = |seed| rows.numerically_zero_row_flags(&random_configuration(model, seed), seed);
    let zeros: Vec<Vec<bool>> = (0..SAMPLES).map(sample_zero_rows).collect();
    let has_zero_jacobian_row = |row| {
        rows.is_velocity_independent(row)
            || zeros.iter().all(|zeros| zeros[row])
            || sizes.iter().all(|sizes| is_negligible_row(sizes, row))
    };
    (0..model.constraints.len()).map(has_zero_jacobian_row).collect()
}

/// Reports rows that no velocity influences and that are violated: they have the same value in every
/// configuration.
pub fn report_violated_constant_rows(model: &Model<'_>, constant: &[bool], cx: &mut Diagnostics) {
    let all = model.constraints.iter().zip(constant);
    let constant: Vec<&Constraint<'_>> = all.filter(|(_, constant)| **constant).map(|(c, _)| c).collect();
    let tape = Tape::new(&constant.iter().map(|c| c.residual.unwrap_or(c.rate)).collect::<Vec<_>>());
    let sample_gap_values = |seed| {
        let q = random_configuration(model, seed);
        tape.evaluate_at(&|s| symbol_value_at_rest(s, &q, seed))
    };
    let is_violated = |gap: f64| gap.abs() > TOLERANCE || gap.is_nan();
    for ((c, gap), again) in constant.iter().zip(sample_gap_values(0)).zip(sample_gap_values(1)) {
        if gap.is_nan() && again.is_nan() {
            let message = format!("`{}` is undefined in every configuration", c.name);
            cx.report_error(c.place.clone(), message).add_help(
                "one of its lengths or directions is always zero: for a circle on a plane, for example, the \
                 axes must differ",
            );
        } else if is_violated(gap) && is_violated(again) {
            cx.report_error(
                c.place.clone(),
                format!("`{}` cannot be satisfied: its residual is at least {gap}", c.name),
            )
            .add_help("no configuration closes this loop: check the lengths and axes along it");
        }
    }
}

/// Removes rows that depend on the others in every configuration, including constant ones. Returns true if
/// there are such rows.
///
/// If the other rows leave no degree of freedom, every further row depends on them, whether or not it is
/// compatible. In this case rows are removed only if a configuration is known that satisfies all of them.
pub fn prune_redundant_rows(
    model: &mut Model<'_>,
    rows: &CompiledConstraintRows<'_>,
    constant: &[bool],
    samples: &[ConfigurationSample],
) -> bool {
    let random = (0..SAMPLES).map(|seed| (random_configuration(model, seed), seed));
    let all = random.chain(samples.iter().cloned());
    let jacobians: Vec<Vec<Vec<f64>>> = all.map(|(q, seed)| rows.jacobian(&q, seed)).collect();
    let mut bases: Vec<OrthonormalRowBasis> =
        jacobians.iter().map(|_| OrthonormalRowBasis::default()).collect();
    let mut kept: Vec<usize> = Vec::new();
    for row in (0..model.constraints.len()).filter(|row| !constant[*row]) {
        if !jacobians.iter().zip(&bases).all(|(j, basis)| basis.spans_row(&j[row], TOLERANCE)) {
            kept.push(row);
            bases
                .iter_mut()
                .zip(&jacobians)
                .for_each(|(basis, j)| basis.add_independent_row(&j[row], TOLERANCE));
        }
    }
    if samples.is_empty() && bases.iter().all(|basis| basis.rank() == model.nv()) {
        kept = (0..model.constraints.len()).filter(|row| !constant[*row]).collect();
    }
    let all = std::mem::take(&mut model.constraints);
    for (row, constraint) in all.into_iter().enumerate() {
        match kept.contains(&row) {
            true => model.constraints.push(constraint),
            false => model.redundant.push(constraint.name),
        }
    }
    !model.redundant.is_empty()
}

/// Orthonormal basis of the span of Jacobian rows.
#[derive(Default)]
pub struct OrthonormalRowBasis(Vec<Vec<f64>>);

impl OrthonormalRowBasis {
    /// Returns the number of independent rows in the basis.
    pub fn rank(&self) -> usize {
        self.0.len()
    }

    /// Adds a row, unless it is a combination of the previous rows up to a relative tolerance.
    pub fn add_independent_row(&mut self, row: &[f64], tolerance: f64) {
        let rest = self.orthogonal_component(row);
        let size = dot(&rest, &rest).sqrt();
        if size > tolerance * dot(row, row).sqrt().max(tolerance) {
            self.0.push(rest.iter().map(|x| x / size).collect());
        }
    }

    /// Returns true for a row that is zero or a combination of the previous rows; false for a row with NaN
    /// entries.
    fn spans_row(&self, row: &[f64], tolerance: f64) -> bool {
        let rest = self.orthogonal_component(row);
        dot(&rest, &rest).sqrt() <= tolerance * dot(row, row).sqrt().max(tolerance)
    }

    /// Returns the component of a row that is orthogonal to the basis.
    fn orthogonal_component(&self, row: &[f64]) -> Vec<f64> {
        let mut rest = row.to_vec();
        // Projected out twice, since the first projection leaves its rounding error.
        for b in self.0.iter().chain(&self.0) {
            let part = dot(&rest, b);
            rest.iter_mut().zip(b).for_each(|(x, b)| *x -= part * b);
        }
        rest
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
