//! Coefficients that follow from parameters.

use super::Contacts;
use crate::Real;
use crate::constraint::ConstraintError;
use crate::private::to_f64;

/// Coefficients of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law<T> {
    /// Coefficient of friction `μ` while surfaces slide, zero or more. Of a friction moment the largest moment
    /// per unit of normal force, m.
    pub friction: T,
    /// Coefficient of friction `μₛ` of surfaces at rest: `friction`, or more where that is positive.
    pub stiction: T,
    /// Of restitution, `e`: from zero, where surfaces stay together, to one, where they part as fast as they
    /// met.
    pub restitution: T,
    /// What it is a ratio of.
    pub hypothesis: Restitution,
}

/// What a coefficient of restitution is a ratio of. Both are the same where slip keeps its direction in an
/// impact, or where there is no friction and one contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Restitution {
    /// Of velocities along the normal, after an impact and before it.
    #[default]
    Newton,
    /// Of impulses along the normal, of restitution and of compression.
    Poisson,
}

/// The coefficients of all contacts.
///
/// # Errors
///
/// [`ConstraintError::Coefficient`] for the first invalid coefficient: friction that is negative or not
/// finite, static friction below kinetic friction or beside none, restitution outside of zero to one.
pub(super) fn lawful<
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
