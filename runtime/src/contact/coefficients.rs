//! Coefficients of friction and restitution of contacts, which may depend on parameters, and their check.

use super::Contacts;
use crate::Real;
use crate::constraint::ConstraintError;
use crate::private::to_f64;

/// Coefficients of friction and restitution of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law<T> {
    /// Coefficient of kinetic friction `μ`, zero or more. For a friction moment, the largest moment per unit
    /// of normal force, m.
    pub friction: T,
    /// Coefficient of static friction `μₛ`: at least `friction`.
    pub stiction: T,
    /// Coefficient of restitution `e`, from zero (surfaces stay together) to one (the separation velocity
    /// equals the approach velocity).
    pub restitution: T,
    /// Hypothesis that defines the coefficient of restitution: a ratio of velocities or of impulses.
    pub hypothesis: Restitution,
}

/// Hypothesis of restitution. Both hypotheses agree if the slip direction is constant during the impact, or
/// if there is a single contact without friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Restitution {
    /// Newton's hypothesis: `e` is the ratio of normal velocities after and before the impact.
    #[default]
    Newton,
    /// Poisson's hypothesis: `e` is the ratio of normal impulses of restitution and compression.
    Poisson,
}

/// Returns the coefficients of all contacts, or an error if one of them is out of range.
///
/// # Errors
///
/// [`ConstraintError::Coefficient`] for the first invalid coefficient: friction that is negative or not
/// finite, static friction below kinetic friction or beside none, restitution outside of zero to one.
pub(super) fn checked_contact_laws<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    mechanism: &M,
) -> Result<[Law<T>; NK], ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let laws = mechanism.contact_laws();
    for (Law { friction, stiction, restitution, .. }, constraint) in laws.iter().zip(M::CONTACTS) {
        let rubs = *friction >= T::zero() && friction.is_finite();
        let bounces = *restitution >= T::zero() && *restitution <= T::one();
        let sticks =
            stiction == friction || *stiction > *friction && *friction > T::zero() && stiction.is_finite();
        if !(rubs && sticks && bounces) {
            let invalid = if !rubs {
                friction
            } else if !sticks {
                stiction
            } else {
                restitution
            };
            let value = to_f64(*invalid);
            return Err(ConstraintError::Coefficient { constraint, value });
        }
    }
    Ok(laws)
}
