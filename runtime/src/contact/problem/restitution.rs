//! Restitution phase of an impact after its compression phase, and the energy of both.

use super::super::{Law, Restitution, Rows};
use super::{ContactProblem, ROUNDINGS, RowList, entry_or_zero};
use crate::Real;
use crate::private::{constant, epsilon, positive_part};
use nalgebra::SVector;

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Computes the impulses of the compression phase, if any approaching contact has Poisson's coefficient
    /// of restitution.
    ///
    /// # Errors
    ///
    /// As [`solve`](Self::solve).
    pub(in super::super) fn compute_compression_impulses(
        &mut self,
        laws: &[Law<T>; NK],
        before: &SVector<T, NR>,
    ) -> Result<(), usize> {
        let has_poisson_restitution = |k: usize| {
            let (contact, Rows { first, .. }) = self.contacts[k];
            let poisson =
                |law: &Law<T>| law.hypothesis == Restitution::Poisson && law.restitution > T::zero();
            laws.get(contact).is_some_and(poisson) && entry_or_zero(before, first) < T::zero()
        };
        if !(0..self.count).any(|k| self.has_gap_function(k) && has_poisson_restitution(k)) {
            return Ok(());
        }
        let places = self.places;
        for i in 0..self.size {
            self.free[i] = entry_or_zero(before, places[i]);
        }
        let found = self.solve_impulses();
        self.free = self.given;
        self.compression = self.accept_best_if_relaxed(found)?;
        self.is_compressed = true;
        Ok(())
    }

    /// Sets the demands on contacts after compression, for the fraction `part` of the restitution. Newton's
    /// hypothesis demands a minimum normal velocity from the normal velocity before the impact; Poisson's
    /// adds a normal impulse in proportion to that of compression.
    pub(in super::super) fn set_restitution_demands(
        &mut self,
        laws: &[Law<T>; NK],
        before: &SVector<T, NR>,
        part: T,
    ) {
        let none = T::zero();
        self.base = self.compression;
        for k in (0..self.count).filter(|k| self.pressed_by[*k] == *k) {
            let (contact, Rows { first, .. }) = self.contacts[k];
            let law = laws
                .get(contact)
                .map_or((none, Restitution::Newton), |law| (law.restitution, law.hypothesis));
            let n = self.rows[k].first;
            (self.least[k], self.floor[k]) = match law {
                (e, Restitution::Newton) => ((-(e * part * entry_or_zero(before, first))).max(none), none),
                (e, Restitution::Poisson) => (none, e * part * self.compression[n]),
            };
            self.base[n] += self.floor[k];
        }
        if self.is_compressed {
            self.free = self.given;
            self.free = self.contact_velocities_after(&self.base);
        }
    }

    /// Returns the total normal impulse that bounds friction: the positive part of `normal`, and the impulse
    /// of restitution that acts in addition.
    pub(super) fn friction_bounding_impulse(&self, k: usize, normal: T) -> T {
        positive_part(normal) + self.floor[self.pressed_by[k]]
    }

    /// Whether any contact demands restitution.
    pub(in super::super) fn demands_restitution(&self) -> bool {
        let asked = self.least.iter().zip(self.floor.iter()).take(self.count);
        asked.fold(false, |any, (least, floor)| any || *least > T::zero() || *floor > T::zero())
    }

    /// Whether impulses increase the energy. Their work is the impulse times the mean of the contact
    /// velocities before and after.
    pub(in super::super) fn adds_energy(&self, impulses: &RowList<T, NR>) -> bool {
        if !self.demands_restitution() {
            return false;
        }
        let rates = self.contact_velocities_after(impulses);
        let (mut work, mut size) = (T::zero(), T::zero());
        for i in 0..self.size {
            let impulse = self.base[i] + impulses[i];
            work += impulse * (rates[i] + self.given[i]);
            size += (impulse * (rates[i].abs() + self.given[i].abs())).abs();
        }
        work > size * epsilon::<T>() * constant(ROUNDINGS)
    }
}
