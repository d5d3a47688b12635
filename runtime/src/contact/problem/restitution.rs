//! What is left of an impact after compression, and the energy of both.

use super::super::{Law, Restitution, Rows};
use super::{List, Problem, ROUNDINGS, entry};
use crate::Real;
use crate::private::{constant, epsilon, positive_part};
use nalgebra::SVector;

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// Finds the impulses of compression, where surfaces approached each other whose restitution is a ratio
    /// of them.
    ///
    /// # Errors
    ///
    /// As [`solve`](Self::solve).
    pub(in super::super) fn compress(
        &mut self,
        laws: &[Law<T>; NK],
        before: &SVector<T, NR>,
    ) -> Result<(), usize> {
        let bounces = |k: usize| {
            let (contact, Rows { first, .. }) = self.contacts[k];
            let poisson =
                |law: &Law<T>| law.hypothesis == Restitution::Poisson && law.restitution > T::zero();
            laws.get(contact).is_some_and(poisson) && entry(before, first) < T::zero()
        };
        if !(0..self.count).any(|k| self.is_gap(k) && bounces(k)) {
            return Ok(());
        }
        let places = self.places;
        for i in 0..self.size {
            self.free[i] = entry(before, places[i]);
        }
        let found = self.solve();
        self.free = self.given;
        self.compression = self.relaxed(found)?;
        self.is_compressed = true;
        Ok(())
    }

    /// What contacts do after compression: this `part` of the restitution. Normal rates are at least that of
    /// those before, and no less than zero, or normal impulses that of those of compression.
    pub(in super::super) fn aim(&mut self, laws: &[Law<T>; NK], before: &SVector<T, NR>, part: T) {
        let none = T::zero();
        self.base = self.compression;
        for k in (0..self.count).filter(|k| self.pressed_by[*k] == *k) {
            let (contact, Rows { first, .. }) = self.contacts[k];
            let law = laws
                .get(contact)
                .map_or((none, Restitution::Newton), |law| (law.restitution, law.hypothesis));
            let n = self.rows[k].first;
            (self.least[k], self.floor[k]) = match law {
                (e, Restitution::Newton) => ((-(e * part * entry(before, first))).max(none), none),
                (e, Restitution::Poisson) => (none, e * part * self.compression[n]),
            };
            self.base[n] += self.floor[k];
        }
        if self.is_compressed {
            self.free = self.given;
            self.free = self.rates(&self.base);
        }
    }

    /// The normal impulse that bounds friction, if `normal` is that beside what acts anyway.
    pub(super) fn bearing(&self, k: usize, normal: T) -> T {
        positive_part(normal) + self.floor[self.pressed_by[k]]
    }

    /// Whether restitution is asked for.
    pub(in super::super) fn rebounds(&self) -> bool {
        let asked = self.least.iter().zip(self.floor.iter()).take(self.count);
        asked.fold(false, |any, (least, floor)| any || *least > T::zero() || *floor > T::zero())
    }

    /// Whether impulses give energy: their work is that of the mean rates.
    pub(in super::super) fn gains(&self, impulses: &List<T, NR>) -> bool {
        if !self.rebounds() {
            return false;
        }
        let rates = self.rates(impulses);
        let (mut work, mut size) = (T::zero(), T::zero());
        for i in 0..self.size {
            let impulse = self.base[i] + impulses[i];
            work += impulse * (rates[i] + self.given[i]);
            size += (impulse * (rates[i].abs() + self.given[i].abs())).abs();
        }
        work > size * epsilon::<T>() * constant(ROUNDINGS)
    }
}
