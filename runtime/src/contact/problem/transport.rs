//! Contact forces that rotate in a step: corrections that make the impulses of a step of second order.

use super::super::response::{CholeskyFactor, ImpulseEffects};
use super::convex::{cholesky_in_place, solve_by_cholesky_factor};
use super::elimination::zero_matrix;
use super::linear::ImpulseEquations;
use super::{ContactProblem, RowList, entry_or_zero};
use crate::Real;
use crate::private::constant;
use nalgebra::SVector;

/// Largest part of the impulses at the start that a correction may be: contact forces that rotate by more in
/// a step are not smooth.
const LARGEST: f64 = 0.125;

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Corrects the velocity without impulses, so that adding impulses `Λ` at the end of the step gives the
    /// trapezoidal rule: half of the impulses act in the configuration at the start, half in that at the end.
    ///
    /// The impulses `Λ₀` at its start have added `given` to the generalized velocity, and `rates` to the
    /// contact velocities. Contact forces rotate with the surfaces and with the slip; their impulse is `½
    /// M⁻¹(q₀) G(q₀)ᵀ Λ₀ + ½ M⁻¹(q₁) G(q₁)ᵀ Λ` (trapezoidal rule). It differs from `M⁻¹(q₁) G(q₁)ᵀ Λ` by half
    /// of the part of `given` that impulses at the end cannot give, which changes no rate of a contact, and
    /// by half of the impulse across the slip at the end. Changes of `Λ` itself are found by the contact
    /// conditions. If `Λ₀` is not unique, it is the impulses `recorded` in the previous step, with the
    /// smallest change that gives `rates`.
    ///
    /// Returns impulses at the end of the step that change the contact velocities as much as `Λ₀`, and the
    /// correction. If the search has other impulses to begin at, they may be left out.
    pub(in super::super) fn correct_velocity_for_rotation<const NV: usize>(
        &mut self,
        given: &SVector<T, NV>,
        (rates, recorded): (&SVector<T, NR>, Option<&RowList<T, NR>>),
        effects: &ImpulseEffects<T, NV, NR>,
        equations: &mut ImpulseEquations<T, NR>,
    ) -> (Option<RowList<T, NR>>, SVector<T, NV>) {
        let half = constant::<T>(0.5);
        let mut impulses = None;
        let sliding =
            recorded.filter(|recorded| self.friction_correction_for_slip_change(recorded, rates).is_some());
        let has_nonunique_contact_forces = self.size > self.basis.column_count();
        let (mut correction, changes) = match effects {
            ImpulseEffects::Factor(factor)
                if recorded.is_some() && sliding.is_none() && has_nonunique_contact_forces =>
            {
                self.velocity_unreachable_by_impulses(given, factor)
            }
            _ => {
                let (found, is_regular) = self.impulses_for_contact_changes(rates, equations);
                impulses = Some(found);
                let velocity_by_impulses =
                    |impulses| effects.velocity_change(&self.basis, &self.values_at_mechanism_rows(impulses));
                let mut correction = (given - velocity_by_impulses(&found)) * half;
                let mut changes = RowList::<T, NR>::repeat_entry(T::zero());
                if !is_regular {
                    let changed = self.contact_velocity_changes(&found);
                    for i in 0..self.size {
                        changes[i] = (entry_or_zero(rates, self.places[i]) - changed[i]) * half;
                    }
                }
                let at_start = match is_regular {
                    true => Some(found),
                    false => {
                        sliding.map(|recorded| self.impulses_for_rate_change(recorded, rates, equations))
                    }
                };
                if let Some(turned) =
                    at_start.and_then(|at_start| self.friction_correction_for_slip_change(&at_start, rates))
                {
                    correction += velocity_by_impulses(&turned);
                    changes = self.add_contact_velocity_changes(changes, &turned);
                }
                (correction, changes)
            }
        };
        let largest_magnitude = |x: &SVector<T, NV>| x.iter().fold(T::zero(), |most, x| most.max(x.abs()));
        if largest_magnitude(&correction) <= largest_magnitude(given) * constant(LARGEST) {
            for i in 0..self.size {
                self.given[i] += changes[i];
                self.free[i] += changes[i];
            }
        } else {
            correction = SVector::zeros();
        }
        (impulses, correction)
    }

    /// Returns half of the component of a velocity that no contact impulses could give (outside of the range
    /// of `M⁻¹ Gᵀ`), and the contact velocities of this half.
    ///
    /// With `w = Lᵀ v`, what two passes of a regularised least-squares problem leave of it is
    /// `(1 + Bᵀ R⁻¹ B)⁻² w`, with the small regularisation `R` of dependent rows.
    fn velocity_unreachable_by_impulses<const NV: usize>(
        &self,
        v: &SVector<T, NV>,
        factor: &CholeskyFactor<T, NV>,
    ) -> (SVector<T, NV>, RowList<T, NR>) {
        let (rank, half) = (self.basis.column_count(), constant::<T>(0.5));
        let mut matrix = zero_matrix();
        self.fill_regularised_matrix(&mut matrix);
        cholesky_in_place(&mut matrix, rank);
        let mut all = factor.multiply_upper(&v.data.0[0]);
        let mut rest = self.basis.entries_at_basis_columns(&all);
        solve_by_cholesky_factor(&matrix, rank, &mut rest);
        solve_by_cholesky_factor(&matrix, rank, &mut rest);
        rest.iter_mut().take(rank).for_each(|x| *x *= half);
        all.iter_mut().for_each(|x| *x *= half);
        self.basis.scatter_basis_columns(&rest, &mut all);
        (SVector::from(factor.solve_upper(all)), self.basis.rates_of_velocity(&rest))
    }

    /// Returns contact impulses near others that change the contact velocities by `rates` (rows of the
    /// mechanism).
    fn impulses_for_rate_change(
        &self,
        others: &RowList<T, NR>,
        rates: &SVector<T, NR>,
        equations: &mut ImpulseEquations<T, NR>,
    ) -> RowList<T, NR> {
        let missing = rates - self.values_at_mechanism_rows(&self.contact_velocity_changes(others));
        let (mut all, _) = self.impulses_for_contact_changes(&missing, equations);
        all.iter_mut().zip(others.iter()).for_each(|(impulse, other)| *impulse += *other);
        all
    }

    /// Returns values at the rows of the mechanism at the rows of closed contacts.
    pub(in super::super) fn gather_closed_rows(&self, all: &SVector<T, NR>) -> RowList<T, NR> {
        let mut gathered = RowList::repeat_entry(T::zero());
        gathered
            .iter_mut()
            .zip(self.places.iter())
            .take(self.size)
            .for_each(|(to, i)| *to = entry_or_zero(all, *i));
        gathered
    }

    /// Returns contact impulses that change the contact velocities by `changes`; both have the rows of all
    /// contacts of the mechanism.
    pub(in super::super) fn mechanism_impulses_for_contact_changes(
        &self,
        changes: &SVector<T, NR>,
    ) -> SVector<T, NR> {
        self.values_at_mechanism_rows(
            &self.impulses_for_contact_changes(changes, &mut ImpulseEquations::new()).0,
        )
    }

    /// Half of the difference of friction impulses from those against the slip at the end of the step, for
    /// contacts that slip on throughout it; none if there are no such contacts.
    fn friction_correction_for_slip_change(
        &self,
        impulses: &RowList<T, NR>,
        rates: &SVector<T, NR>,
    ) -> Option<RowList<T, NR>> {
        let (mut turned, mut is_any) = (RowList::repeat_entry(T::zero()), false);
        for k in (0..self.count).filter(|k| self.friction[*k] > T::zero()) {
            let (n, tangents) = self.normal_and_friction_rows(k);
            let largest = self.friction[k] * impulses[n];
            let slip_at_end = |i: usize| self.free[i] + entry_or_zero(rates, self.places[i]);
            let speed =
                tangents.clone().fold(T::zero(), |sum, i| sum + slip_at_end(i) * slip_at_end(i)).sqrt();
            // Friction of a step stops what is slower.
            let slides = largest > T::zero() && speed * self.step[k] > largest;
            if !slides {
                continue;
            }
            let deviation_from_sliding_friction = |i: usize| impulses[i] + largest * slip_at_end(i) / speed;
            let size = tangents
                .clone()
                .fold(T::zero(), |sum, i| {
                    sum + deviation_from_sliding_friction(i) * deviation_from_sliding_friction(i)
                })
                .sqrt();
            if size <= largest * constant(LARGEST) {
                tangents.for_each(|i| turned[i] = deviation_from_sliding_friction(i) * constant(0.5));
                is_any = true;
            }
        }
        is_any.then_some(turned)
    }
}
