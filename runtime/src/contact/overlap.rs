//! Overlapping surfaces at the start of a motion: rejection with an error, or projection onto a configuration
//! without overlaps.

use super::layout::ContactLayout;
use super::problem::{ContactProblem, entry_or_zero, set_entry};
use super::{Contacts, Law, Restitution, touching_distance};
use crate::Real;
use crate::constraint::ConstraintError;
use crate::private::{constant, to_f64};
use nalgebra::SVector;

/// Maximum number of displacements in a projection. Boxes need two or three.
const MOST_STEPS: usize = 30;

/// Returns the name of the contact with the deepest overlap, and its gap.
fn deepest_overlapping_contact<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    gaps: &SVector<T, NK>,
) -> Result<(&'static str, T), ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let mut found = ("", T::zero());
    for (gap, name) in gaps.iter().zip(M::CONTACTS) {
        if !gap.is_finite() {
            return Err(ConstraintError::NotFinite);
        }
        if *gap < found.1 {
            found = (name, *gap);
        }
    }
    Ok(found)
}

/// Returns an error for a configuration in which surfaces overlap. Simulations check their initial
/// configuration likewise ([`Simulation::overlaps`](crate::simulate::Simulation::overlaps)).
///
/// # Errors
///
/// [`ConstraintError::Overlap`] with the contact whose surfaces overlap most, where that is more than `1e-8`
/// m or rad (`2.3e-4` with `f32`); [`ConstraintError::NotFinite`].
pub fn check<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
) -> Result<(), ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let (constraint, gap) =
        deepest_overlapping_contact::<M, T, NQ, NV, NU, NK, NR>(&mechanism.contact_gaps(t, q))?;
    match gap >= -touching_distance::<T>() {
        true => Ok(()),
        false => Err(ConstraintError::Overlap { constraint, depth: to_f64(-gap) }),
    }
}

/// Returns a configuration near `q` in which no surfaces overlap and the constraints hold. The displacement
/// is `M⁻¹ Gᵀ Λ` with impulses `Λ ≥ 0` that are nonzero only where gaps become zero, so that light bodies
/// move more than heavy ones. Each iteration linearises the gaps of contacts that overlap or might close. If
/// nothing overlaps, the result is `q`.
///
/// ```
/// use linkwork::contact;
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * z)]
/// struct Ball {
///     #[body(mass = 0.5, inertia = sphere(0.5, 0.1))]
///     ball: Body,
///     #[joint(ground -> ball)]
///     pose: Free,
///     #[contact(ball.sphere(0.1), ground.plane(z))]
///     floor: Contact,
/// }
///
/// # fn main() -> Result<(), ConstraintError> {
/// let mut q = Ball {}.neutral();
/// q[2] = 0.07;
/// let refused = contact::check(&Ball {}, 0.0, &q).unwrap_err();
/// assert!(matches!(refused, ConstraintError::Overlap { constraint: "floor", depth } if (depth - 0.03).abs() < 1e-15));
/// let q = contact::project(&Ball {}, 0.0, &q)?;
/// assert!((q[2] - 0.1).abs() < 1e-10);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// [`ConstraintError::Overlap`] with the contact whose surfaces overlap most after 30 displacements, or where
/// no displacement opens it (a ball between walls that are nearer to each other than it is wide); those of
/// projections onto constraints.
pub fn project<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
) -> Result<SVector<T, NQ>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let layout = ContactLayout::of_mechanism(mechanism);
    let hypothesis = Restitution::Newton;
    let smooth = [Law { friction: T::zero(), stiction: T::zero(), restitution: T::zero(), hypothesis }; NK];
    let enough = touching_distance::<T>() * constant(1e-2);
    let (mut q, mut pushes) = (*q, SVector::<T, NR>::zeros());
    for step in 0.. {
        let gaps = mechanism.contact_gaps(t, &q);
        let (constraint, gap) = deepest_overlapping_contact::<M, T, NQ, NV, NU, NK, NR>(&gaps)?;
        let overlaps = gap < -enough;
        let left = ConstraintError::Overlap { constraint, depth: to_f64(-gap) };
        // What was pushed too far goes back.
        let is_pushed = |k: usize| entry_or_zero(&pushes, layout.bounding_contact(k).1) > T::zero();
        let parted = gaps.iter().enumerate().any(|(k, gap)| *gap > enough && is_pushed(k));
        match step == MOST_STEPS {
            _ if !overlaps && !parted => break,
            true if overlaps => return Err(left),
            true => break,
            false => {}
        }
        // What is no farther apart than others overlap may come to overlap as these open.
        let mut closed: [bool; NK] = gaps.data.0[0].map(|other| other <= -gap);
        closed.iter_mut().enumerate().for_each(|(k, closed)| *closed |= is_pushed(k));
        let responses = mechanism.contact_responses(t, &q, &closed);
        let moved = responses.rates * pushes;
        let mut free = SVector::<T, NR>::zeros();
        layout.gap_contacts().for_each(|(k, first)| {
            set_entry(&mut free, first, entry_or_zero(&gaps, k) - entry_or_zero(&moved, first))
        });
        let mut problem = ContactProblem::new(layout, &smooth, &closed, &free);
        problem.copy_closed_contact_weights(&responses.rates);
        let found = problem.solve_impulses().map_err(|_| left)?;
        let all = problem.impulses_at_mechanism_rows(&found);
        q = mechanism.integrate(&q, &(responses.velocities * (all - pushes)));
        pushes = all;
        if mechanism.features().constrained {
            q = mechanism.project(t, &q, &SVector::zeros())?.0;
        }
    }
    Ok(q)
}

/// Returns the initial configuration of a simulation: that of [`project`] if overlaps are to be removed
/// (`parts`), otherwise `q`, or the error of [`check`]. Generated code calls this function.
///
/// # Errors
///
/// The errors of [`project`] and [`check`].
#[doc(hidden)]
pub fn start<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
    parts: bool,
) -> Result<SVector<T, NQ>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    if parts { project(mechanism, t, q) } else { check(mechanism, t, q).map(|()| *q) }
}
