//! Coefficients that follow from parameters.

use super::{Contacts, Law};
use crate::Real;
use crate::constraint::ConstraintError;
use crate::private::to_f64;

/// The coefficients of all contacts.
///
/// # Errors
///
/// [`ConstraintError::Coefficient`] for the first that is none: friction that is negative or not finite, restitution beside zero to one.
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
    for (Law { friction, restitution }, constraint) in laws.iter().zip(M::CONTACTS) {
        let rubs = *friction >= T::zero() && friction.is_finite();
        let bounces = *restitution >= T::zero() && *restitution <= T::one();
        if !(rubs && bounces) {
            let value = to_f64(if rubs { *restitution } else { *friction });
            return Err(ConstraintError::Coefficient { constraint, value });
        }
    }
    Ok(laws)
}
