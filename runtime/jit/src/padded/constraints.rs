//! Constraints of robots that are padded to constant dimensions.

use super::Padded;
use crate::internal::InternalFunction;
use crate::names::{NameListKind, placeholder_numbers};
use crate::robot::{Robot, State};
use linkwork::__private::{
    Elimination, Responses, Structure, careful_response, least_solution, nearly_singular,
    rank_revealing_dynamics, regular_solution, slipping_solution, solution_with_predetermined_pivots,
};
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{Constrained, ConstraintError};
use std::borrow::Borrow;

/// Accelerations, or changes of velocities, together with constraint multipliers.
pub(super) type AccelerationsAndMultipliers<const NV: usize> = (SVector<f64, NV>, SVector<f64, NV>);

/// Row index that marks a sliding contact as padding.
const NO_ROW: usize = usize::MAX;

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>> Padded<NQ, NV, NU, R> {
    pub(super) fn is_constrained(&self) -> bool {
        !self.robot().shared.constraints.names.is_empty()
    }

    /// Returns the number of constraints of the robot.
    fn constraint_count(&self) -> usize {
        self.robot().shared.constraints.names.len()
    }

    /// Returns the group of each constraint row; each row of the padding is a group of its own.
    pub(super) fn constraint_groups(&self) -> [usize; NV] {
        let groups = &self.robot().shared.constraints.groups;
        std::array::from_fn(|k| groups.get(k).copied().unwrap_or(NV + k))
    }

    /// Returns the constraint rows of sliding contacts.
    pub(super) fn sliding_rows(&self) -> [usize; NV] {
        let rows = &self.robot().shared.constraints.slipping;
        std::array::from_fn(|k| rows.get(k).copied().unwrap_or(NO_ROW))
    }

    fn constraint_structure(&self) -> Structure<'_, NV> {
        let constraints = &self.robot().shared.constraints;
        Structure {
            groups: self.constraint_groups(),
            determining: &constraints.determining,
            rank: constraints.rank,
        }
    }

    pub(super) fn are_constraints_nearly_singular(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        dv: &SVector<f64, NV>,
    ) -> bool {
        nearly_singular::<Self, f64, NQ, NV, NU, NV, NV>(self, &self.constraint_structure(), t, q, dv)
    }

    /// Evaluates an elimination of the constraint equations. Rows of the padding get pivots of one, and
    /// accelerations of the padding are taken from `more`.
    pub(super) fn evaluate_constraint_elimination(
        &self,
        f: InternalFunction,
        state: State<'_>,
        more: &SVector<f64, NV>,
    ) -> Elimination<f64, NV, NV> {
        let (n, rows) = (self.robot().nv(), self.constraint_count());
        let mut found = [0.0; 64];
        let mut heap = Vec::new();
        let length = n + 3 * rows;
        let found = match found.get_mut(..length) {
            Some(found) => found,
            None => {
                heap.resize(length, 0.0);
                &mut heap[..]
            }
        };
        self.call_function(f, state, found);
        let (accelerations, rest) = found.split_at(n);
        let padded_row_values = |first: usize, padding: f64| {
            std::array::from_fn(|k| if k < rows { rest[first * rows + k] } else { padding })
        };
        let mut all = Elimination {
            accelerations: more.data.0[0],
            multipliers: padded_row_values(0, 0.0),
            pivots: padded_row_values(1, 1.0),
            before: padded_row_values(2, 1.0),
        };
        all.accelerations[..n].copy_from_slice(accelerations);
        all
    }

    /// Evaluates the quantities from which accelerations under redundant constraints follow.
    fn evaluate_constraint_responses(
        &self,
        f: InternalFunction,
        state: State<'_>,
        more: &SVector<f64, NV>,
    ) -> Responses<f64, NV, NV> {
        let (n, rows) = (self.robot().nv(), self.constraint_count());
        let mut found = vec![0.0; n + rows + rows * rows + n * rows];
        self.call_function(f, state, &mut found);
        let mut all = Responses {
            free: more.data.0[0],
            lacking: [0.0; NV],
            gram: [[0.0; NV]; NV],
            given: [[0.0; NV]; NV],
        };
        let (free, rest) = found.split_at(n);
        let (lacking, rest) = rest.split_at(rows);
        let (gram, given) = rest.split_at(rows * rows);
        all.free[..n].copy_from_slice(free);
        all.lacking[..rows].copy_from_slice(lacking);
        for k in 0..rows {
            all.gram[k][..rows].copy_from_slice(&gram[k * rows..(k + 1) * rows]);
            all.given[k][..n].copy_from_slice(&given[k * n..(k + 1) * n]);
        }
        all
    }

    /// Returns accelerations and multipliers from an elimination; `None` if the elimination loses accuracy.
    fn accelerations_by_elimination(
        &self,
        f: InternalFunction,
        independent: bool,
        state: State<'_>,
        more: &SVector<f64, NV>,
    ) -> Option<AccelerationsAndMultipliers<NV>> {
        let constraints = &self.robot().shared.constraints;
        if constraints.overdetermined {
            return least_solution(
                &self.constraint_groups(),
                constraints.rank,
                &self.evaluate_constraint_responses(f, state, more),
            );
        }
        let found = self.evaluate_constraint_elimination(f, state, more);
        if independent {
            solution_with_predetermined_pivots(&found)
        } else {
            regular_solution(&self.constraint_groups(), &found)
        }
    }

    /// Returns the accelerations and multipliers of a mechanism with sliding contacts.
    pub(super) fn slipping_dynamics(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        tau: &SVector<f64, NV>,
    ) -> Result<AccelerationsAndMultipliers<NV>, ConstraintError> {
        let slipping = self.robot().shared.constraints.slipping.len();
        let state = State { tau: self.velocity_entries(tau), ..self.state_with_velocity(t, q, v) };
        let mut more = *tau;
        self.add_state_rates_without_inputs(state, 1.0, &mut more);
        let names = Self::CONSTRAINTS;
        slipping_solution(&self.sliding_rows(), &self.constraint_groups(), &names, |sides: &[f64; NV]| {
            let state = State { other: &[&sides[..slipping]], ..state };
            self.evaluate_constraint_elimination(InternalFunction::ConstrainedDynamics, state, &more)
        })
    }

    /// Returns the changes of velocities for generalized forces and constraint biases. Entries of the padding
    /// are those of the forces.
    pub(super) fn constrained_velocity_changes(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        force: &[f64; NV],
        bias: &[f64; NV],
    ) -> SVector<f64, NV> {
        let (n, rows) = (self.robot().nv(), self.constraint_count());
        let state = State { other: &[&force[..n], &bias[..rows]], ..self.state_without_velocity(t, q) };
        let more = SVector::from(*force);
        self.accelerations_by_elimination(InternalFunction::ConstraintCorrection, false, state, &more)
            .unwrap_or_else(|| {
                careful_response::<Self, f64, NQ, NV, NU, NV, NV>(
                    self,
                    &self.constraint_structure(),
                    t,
                    q,
                    force,
                    bias,
                )
            })
            .0
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>> Constrained<NQ, NV, NU, NV, NV>
    for Padded<NQ, NV, NU, R>
{
    const CONSTRAINTS: [&'static str; NV] = placeholder_numbers(NameListKind::Constraints);

    fn holonomic(&self) -> usize {
        self.robot().shared.constraints.holonomic
    }

    fn angles(&self) -> &[usize] {
        &self.robot().shared.constraints.angles
    }

    fn rotations(&self) -> [bool; NV] {
        let velocities = self.robot().velocities();
        std::array::from_fn(|k| velocities.get(k).is_some_and(|one| one.unit == "rad/s"))
    }

    fn constraint_residuals(&self, t: f64, q: &SVector<f64, NQ>) -> SVector<f64, NV> {
        let count = self.robot().shared.constraints.holonomic;
        match count {
            0 => SVector::zeros(),
            _ => self.vector_with_results(
                InternalFunction::ConstraintResiduals,
                self.state_without_velocity(t, q),
                count,
                SVector::zeros(),
            ),
        }
    }

    fn constraint_rates(&self, t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        self.vector_with_results(
            InternalFunction::ConstraintRates,
            self.state_with_velocity(t, q, v),
            self.constraint_count(),
            SVector::zeros(),
        )
    }

    fn constraint_jacobian(&self, t: f64, q: &SVector<f64, NQ>) -> SMatrix<f64, NV, NV> {
        let size = (self.constraint_count(), self.robot().nv());
        self.matrix_with_results(
            InternalFunction::ConstraintJacobian,
            self.state_without_velocity(t, q),
            size,
            SMatrix::zeros(),
        )
    }

    fn constraint_bias(&self, t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        self.vector_with_results(
            InternalFunction::ConstraintBias,
            self.state_with_velocity(t, q, v),
            self.constraint_count(),
            SVector::zeros(),
        )
    }

    fn constrained_dynamics(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        tau: &SVector<f64, NV>,
    ) -> AccelerationsAndMultipliers<NV> {
        let constraints = &self.robot().shared.constraints;
        if !constraints.slipping.is_empty() {
            let undetermined = SVector::repeat(f64::NAN);
            let found = self.slipping_dynamics(t, q, v, tau);
            return found.unwrap_or((undetermined, undetermined));
        }
        let state = State { tau: self.velocity_entries(tau), ..self.state_with_velocity(t, q, v) };
        let mut more = *tau;
        self.add_state_rates_without_inputs(state, 1.0, &mut more);
        self.accelerations_by_elimination(
            InternalFunction::ConstrainedDynamics,
            constraints.independent,
            state,
            &more,
        )
        .unwrap_or_else(|| {
            rank_revealing_dynamics::<Self, f64, NQ, NV, NU, NV, NV>(
                self,
                &self.constraint_structure(),
                t,
                q,
                v,
                tau,
            )
        })
    }

    fn constraint_correction(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        gap: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        self.constrained_velocity_changes(t, q, &[0.0; NV], &gap.data.0[0])
    }

    fn constraint_response(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        p: &SVector<f64, NV>,
        gap: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        self.constrained_velocity_changes(t, q, &p.data.0[0], &gap.data.0[0])
    }
}
