//! Contact forces that rotate in a step: corrections that make the impulses of a step of second order.

use super::super::Responses;
use super::linear::Equations;
use super::{List, Problem, entry};
use crate::Real;
use crate::private::constant;
use nalgebra::SVector;

/// Largest part of the impulses at the start that a correction may be: contact forces that rotate by more in
/// a step are not smooth.
const LARGEST: f64 = 0.125;

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// Corrects the velocity without impulses, so that impulses `Λ` at the end of a step act as in the mean
    /// of the step.
    ///
    /// The impulses `Λ₀` at its start have added `given` to the velocity, and `rates` to the rates. Contact
    /// forces rotate with the surfaces and with the slip; their impulse is
    /// `½ M⁻¹(q₀) G(q₀)ᵀ Λ₀ + ½ M⁻¹(q₁) G(q₁)ᵀ Λ` (trapezoidal rule). It differs from `M⁻¹(q₁) G(q₁)ᵀ Λ` by
    /// half of the part of `given` that impulses at the end cannot give, which changes no rate of a contact,
    /// and by half of the impulse across the slip at the end. Changes of `Λ` itself are found by the contact
    /// conditions. If `Λ₀` is not unique, it is the impulses `recorded` in the previous step, with the
    /// smallest change that gives `rates`.
    ///
    /// Returns impulses at the end of the step that change the rates as much as `Λ₀`, and the correction.
    pub(in super::super) fn transport<const NV: usize>(
        &mut self,
        given: &SVector<T, NV>,
        (rates, recorded): (&SVector<T, NR>, Option<&List<T, NR>>),
        responses: &Responses<T, NV, NR>,
        equations: &mut Equations<T, NR>,
    ) -> (List<T, NR>, SVector<T, NV>) {
        let half = constant::<T>(0.5);
        let (impulses, is_regular) = self.impulses_for(rates, equations);
        let mut correction = (given - responses.velocities * self.scatter(&impulses)) * half;
        let mut changes = List::<T, NR>::repeat(T::zero());
        if !is_regular {
            let changed = self.changes(&impulses);
            for i in 0..self.size {
                changes[i] = (entry(rates, self.places[i]) - changed[i]) * half;
            }
        }
        let at_start = if is_regular {
            Some(impulses)
        } else {
            let recorded = recorded.filter(|recorded| self.slip_correction(recorded, rates).is_some());
            recorded.map(|recorded| self.nearest(recorded, rates, equations))
        };
        if let Some(turned) = at_start.and_then(|at_start| self.slip_correction(&at_start, rates)) {
            correction += responses.velocities * self.scatter(&turned);
            changes = self.added(changes, &turned);
        }
        let size = |x: &SVector<T, NV>| x.iter().fold(T::zero(), |most, x| most.max(x.abs()));
        if size(&correction) <= size(given) * constant(LARGEST) {
            for i in 0..self.size {
                self.given[i] += changes[i];
                self.free[i] += changes[i];
            }
        } else {
            correction = SVector::zeros();
        }
        (impulses, correction)
    }

    /// Returns impulses near others that change the rates of the mechanism by `rates`.
    fn nearest(
        &self,
        others: &List<T, NR>,
        rates: &SVector<T, NR>,
        equations: &mut Equations<T, NR>,
    ) -> List<T, NR> {
        let missing = rates - self.scatter(&self.changes(others));
        let (mut all, _) = self.impulses_for(&missing, equations);
        all.iter_mut().zip(others.iter()).for_each(|(impulse, other)| *impulse += *other);
        all
    }

    /// Returns values at the rows of the mechanism at the rows of closed contacts.
    pub(in super::super) fn gather(&self, all: &SVector<T, NR>) -> List<T, NR> {
        let mut gathered = List::repeat(T::zero());
        gathered.iter_mut().zip(self.places.iter()).take(self.size).for_each(|(to, i)| *to = entry(all, *i));
        gathered
    }

    /// Impulses that change the rates of the mechanism by `changes`.
    pub(in super::super) fn displacements(&self, changes: &SVector<T, NR>) -> SVector<T, NR> {
        self.scatter(&self.impulses_for(changes, &mut Equations::new()).0)
    }

    /// Half of the difference of friction impulses from those against the slip at the end of the step, for
    /// contacts that slip on throughout it; none if there are no such contacts.
    fn slip_correction(&self, impulses: &List<T, NR>, rates: &SVector<T, NR>) -> Option<List<T, NR>> {
        let (mut turned, mut is_any) = (List::repeat(T::zero()), false);
        for k in (0..self.count).filter(|k| self.friction[*k] > T::zero()) {
            let (n, tangents) = self.of(k);
            let largest = self.friction[k] * impulses[n];
            let slip = |i: usize| self.free[i] + entry(rates, self.places[i]);
            let speed = tangents.clone().fold(T::zero(), |sum, i| sum + slip(i) * slip(i)).sqrt();
            // Friction of a step stops what is slower.
            let slides = largest > T::zero() && speed * self.step[k] > largest;
            if !slides {
                continue;
            }
            let across = |i: usize| impulses[i] + largest * slip(i) / speed;
            let size = tangents.clone().fold(T::zero(), |sum, i| sum + across(i) * across(i)).sqrt();
            if size <= largest * constant(LARGEST) {
                tangents.for_each(|i| turned[i] = across(i) * constant(0.5));
                is_any = true;
            }
        }
        is_any.then_some(turned)
    }
}
