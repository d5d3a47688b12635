//! Initial states that satisfy the constraints, with as many of the given entries as possible.

use crate::Stop;
use linkwork::nalgebra::DMatrix;
use linkwork_compiler::mechanism::{Chart, Model};
use linkwork_jit::Robot;
use std::f64::consts::PI;
use std::ops::Range;

/// Number of steps in which prescribed configuration entries move to their values.
const STEPS: u8 = 40;
/// Maximum difference of an angle from half a revolution that rounding explains, rad.
const ROUNDING: f64 = 1e-12;
/// Maximum residual of a configuration that satisfies the constraints, m and rad.
const SATISFIED: f64 = 1e-10;
/// Number of perturbed initial configurations from which a mechanism is assembled.
const ASSEMBLIES: u8 = 50;

/// Constraints of a mechanism, evaluated for its assembly.
pub struct MechanismAssembler<'a, 'g> {
    pub robot: &'a Robot,
    pub model: &'a Model<'g>,
}

/// Returns the indices of the marks that are true.
fn indices_of_true_values(marks: &[bool]) -> Vec<usize> {
    (0..marks.len()).filter(|k| marks[*k]).collect()
}

/// Returns a number from −1 to 1 of a sequence that does not repeat (multiples of irrational fractions).
fn perturbation_of_guess(attempt: u8, k: usize) -> f64 {
    2.0 * (f64::from(attempt) * 0.618 + k as f64 * 0.755).fract() - 1.0
}

impl MechanismAssembler<'_, '_> {
    /// Iterates over the ranges of configuration entries that change together, with their velocities: the
    /// entries of a rotation, or the position of a free body.
    fn coupled_entry_ranges(&self) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
        self.model
            .charts
            .iter()
            .flat_map(|chart| match *chart {
                Chart::Plain(at, from) => [Some((at.range_of_entries(1), from.range_of_entries(1))), None],
                Chart::Ball(at, from) => [Some((at.range_of_entries(4), from.range_of_entries(3))), None],
                Chart::Free(at, from) => [
                    Some((at.range_of_entries(3), from.range_of_entries(3))),
                    Some(((at + 3).range_of_entries(4), (from + 3).range_of_entries(3))),
                ],
            })
            .flatten()
    }

    /// Returns which velocities of joints change marked entries of a configuration, or entries that change
    /// together with them.
    pub fn velocity_mask_of_entries(&self, marks: &[bool]) -> Vec<bool> {
        let mut moving = vec![false; self.model.nv()];
        for (entries, velocities) in self.coupled_entry_ranges() {
            moving[velocities].fill(marks[entries].contains(&true));
        }
        moving
    }

    /// Returns which entries of a configuration are changed by marked velocities of joints only.
    fn entries_moved_only_by_marked(&self, marks: &[bool]) -> Vec<bool> {
        let mut found = vec![false; self.model.nq()];
        for (entries, velocities) in self.coupled_entry_ranges() {
            found[entries].fill(!marks[velocities].contains(&false));
        }
        found
    }

    fn evaluate_function(&self, name: &str, arguments: &[(&str, &[f64])]) -> Option<Vec<f64>> {
        let f = self.robot.function(name).ok()?;
        let time = [0.0];
        let values_of_argument = |(name, _): &(&str, usize)| match *name {
            "t" => Some(&time[..]),
            name => arguments.iter().find(|(known, _)| *known == name).map(|(_, values)| *values),
        };
        let arguments: Option<Vec<&[f64]>> = f.arguments().iter().map(values_of_argument).collect();
        self.robot.evaluate(&f, &arguments?).ok()
    }

    /// Returns true if every velocity that the constraints permit has a positive kinetic energy: if
    /// `M + Jᵀ J` is positive definite, with the mass matrix `M` and the Jacobian `J` of the constraints.
    ///
    /// # Errors
    ///
    /// The mass matrix cannot be evaluated.
    pub fn has_positive_definite_constrained_inertia(&self, q: &[f64]) -> Result<bool, Stop> {
        let matrix = self.robot.mass_matrix(q)?;
        let (rows, columns) = (self.model.constraints.len(), matrix.ncols());
        if matrix.clone().cholesky().is_some() {
            return Ok(true);
        }
        let jacobian = self.evaluate_function("constraint_jacobian", &[("q", q)]);
        let jacobian = jacobian.filter(|entries| entries.len() == rows * columns);
        let sum = jacobian.map(|entries| {
            let jacobian = DMatrix::from_vec(rows, columns, entries);
            matrix + jacobian.transpose() * jacobian
        });
        Ok(sum.is_some_and(|sum| sum.cholesky().is_some()))
    }

    /// Returns which velocities affect no constraint, at this configuration and near it. The first list has
    /// the velocities of the joints, the second the entries of `v`, which differ if generalized speeds are
    /// declared.
    pub fn unconstrained_velocity_masks(&self, q: &[f64]) -> [Vec<bool>; 2] {
        let n = self.model.nv();
        let mut unreached = [vec![true; n], vec![true; n]];
        for size in [0.0, 0.1] {
            let dv: Vec<f64> = (0..n).map(|k| size * perturbation_of_guess(1, k)).collect();
            let Ok(near) = self.robot.integrate(q, &dv) else { continue };
            let near = near.as_slice();
            let Some(jacobian) = self.evaluate_function("constraint_jacobian", &[("q", near)]) else {
                continue;
            };
            let rows = self.model.constraints.len();
            let jacobian_column = |k: usize| &jacobian[k * rows..(k + 1) * rows];
            for k in 0..n {
                unreached[1][k] &= jacobian_column(k).iter().all(|entry| *entry == 0.0);
                let unit: Vec<f64> = (0..n).map(|j| f64::from(u8::from(j == k))).collect();
                let speeds = match self.model.speeds.is_some() {
                    true => self
                        .evaluate_function("speeds_of_rates", &[("q", near), ("v", &unit), ("rates", &unit)]),
                    false => Some(unit),
                };
                let speeds = speeds.unwrap_or_else(|| vec![1.0; n]);
                let has_nonzero_velocity =
                    |i: usize| (0..n).map(|j| jacobian_column(j)[i] * speeds[j]).sum::<f64>() != 0.0;
                unreached[0][k] &= !(0..rows).any(has_nonzero_velocity);
            }
        }
        unreached
    }

    /// Returns a configuration with the given entries, reached in small steps from the configuration on the
    /// constraints that is nearest to the initial one, so that a loop stays in the assembly mode of that
    /// configuration. If the given entries contradict the constraints, the result violates them.
    pub fn configuration_by_continuation(
        &self,
        q: &[f64],
        given: &[bool],
        apart: &[bool],
        held: &[bool],
    ) -> Result<Vec<f64>, Stop> {
        let mut initial = self.robot.initial_configuration()?.as_slice().to_vec();
        let is_apart = self.entries_moved_only_by_marked(apart);
        for k in (0..q.len()).filter(|k| is_apart[*k]) {
            initial[k] = q[k];
        }
        let Some(begin) = self.assemble_near(&initial, &initial, apart) else { return Ok(q.to_vec()) };
        let (mut at, held) = (begin.clone(), indices_of_true_values(held));
        for step in 1..=STEPS {
            let part = f64::from(step) / f64::from(STEPS);
            for k in (0..q.len()).filter(|k| given[*k]) {
                at[k] = if step == STEPS { q[k] } else { begin[k] + (q[k] - begin[k]) * part };
            }
            if crate::motion::normalise_quaternions(self.model, &mut at).is_err() {
                return Ok(q.to_vec());
            }
            if let Ok(found) = self.robot.least_violation(&at, &held) {
                at = found.as_slice().to_vec();
            }
        }
        Ok(at)
    }

    /// Returns a configuration on the constraints near `q`, without a change of the coordinates whose
    /// velocities are held. The search starts from `q`, then from increasingly perturbed values of the other
    /// entries. The first result whose angles are within half a revolution of the guess is preferred.
    pub fn assemble_near(&self, q: &[f64], guess: &[f64], held: &[bool]) -> Option<Vec<f64>> {
        let (given, held) = (self.entries_moved_only_by_marked(held), indices_of_true_values(held));
        let mut far = None;
        let nearby = (0..=ASSEMBLIES).filter_map(|attempt| {
            let mut from = q.to_vec();
            let size = 0.02 * f64::from(attempt);
            for (k, x) in from.iter_mut().enumerate().filter(|(k, _)| !given[*k]) {
                *x += size * perturbation_of_guess(attempt, k);
            }
            crate::motion::normalise_quaternions(self.model, &mut from).ok()?;
            let found = self.robot.least_violation(&from, &held).ok()?.as_slice().to_vec();
            self.satisfies_constraints(&found).then_some(found)
        });
        let further = std::iter::once_with(|| self.robot.assemble(q, &held)).flatten();
        for found in nearby.chain(further.map(|found| found.as_slice().to_vec())) {
            let found = self.unwind_angles(guess, found);
            if self.angle_indices().all(|k| (found[k] - guess[k]).abs() <= PI + ROUNDING) {
                return Some(found);
            }
            far.get_or_insert(found);
        }
        far
    }

    /// Iterates over the indices of configuration entries that are angles.
    fn angle_indices(&self) -> impl Iterator<Item = usize> {
        let units = self.model.units.configuration.iter().enumerate();
        units.filter(|(_, unit)| *unit == "rad").map(|(k, _)| k)
    }

    /// Subtracts whole revolutions from angles that differ by more than half a revolution from the guess, if
    /// the constraints remain satisfied: from all angles together, or otherwise from each one separately.
    fn unwind_angles(&self, guess: &[f64], q: Vec<f64>) -> Vec<f64> {
        let unwind_angle = |mut q: Vec<f64>, k: usize| {
            q[k] -= 2.0 * PI * ((q[k] - guess[k]) / (2.0 * PI)).round();
            q
        };
        let all = self.angle_indices().fold(q.clone(), unwind_angle);
        if all == q || self.satisfies_constraints(&all) {
            return all;
        }
        self.angle_indices().fold(q, |q, k| {
            let next = unwind_angle(q.clone(), k);
            if self.satisfies_constraints(&next) { next } else { q }
        })
    }

    /// Whether a configuration satisfies the holonomic constraints.
    fn satisfies_constraints(&self, q: &[f64]) -> bool {
        let left = self.evaluate_function("constraint_residuals", &[("q", q)]);
        left.is_some_and(|left| left.iter().all(|x| x.abs() <= SATISFIED))
    }

    /// Returns the velocity with the held entries of `v` that satisfies the constraints; `None` if the held
    /// velocities contradict the constraints.
    pub fn complete_velocity_from_fixed_entries(
        &self,
        q: &[f64],
        v: &[f64],
        held: &[bool],
    ) -> Option<Vec<f64>> {
        let found = self.robot.complete_velocity(q, v, &indices_of_true_values(held)).ok()?;
        Some(found.as_slice().to_vec())
    }

    /// Returns the assembly mode of a configuration, see [`Robot::assembly_mode`].
    pub fn assembly_mode_of_configuration(&self, q: &[f64], held: &[bool]) -> Option<i8> {
        self.robot.assembly_mode(q, &indices_of_true_values(held)).ok().flatten()
    }
}
