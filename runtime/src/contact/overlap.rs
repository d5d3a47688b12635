//! Surfaces that overlap where a motion is to begin: refused, or taken apart.

use super::layout::Layout;
use super::problem::{Problem, entry, put};
use super::{Contacts, Law, Restitution, touching_distance};
use crate::Real;
use crate::constraint::ConstraintError;
use crate::private::{constant, to_f64};
use nalgebra::SVector;

/// Most displacements of a projection; two or three bring the surfaces of boxes apart.
const MOST_STEPS: usize = 30;

/// The deepest overlap: its contact, and the gap.
fn deepest<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
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

/// Refuses a configuration in which surfaces overlap, as simulations do where they start
/// ([`Simulation::overlaps`](crate::simulate::Simulation::overlaps)).
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
    let (constraint, gap) = deepest::<M, T, NQ, NV, NU, NK, NR>(&mechanism.contact_gaps(t, q))?;
    match gap >= -touching_distance::<T>() {
        true => Ok(()),
        false => Err(ConstraintError::Overlap { constraint, depth: to_f64(-gap) }),
    }
}

/// A configuration near `q` in which no surfaces overlap, through the constraints of the mechanism. Bodies
/// move in proportion to how easily they do: the displacement is `M⁻¹ Gᵀ Λ` with `Λ ≥ 0` where gaps are zero
/// and none elsewhere, found by linear steps for the gaps that overlap, that are pushed open and that might
/// close on the way. Without overlaps nothing moves.
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
    let layout = Layout::of(mechanism);
    let hypothesis = Restitution::Newton;
    let smooth = [Law { friction: T::zero(), stiction: T::zero(), restitution: T::zero(), hypothesis }; NK];
    let enough = touching_distance::<T>() * constant(1e-2);
    let (mut q, mut pushes) = (*q, SVector::<T, NR>::zeros());
    for step in 0.. {
        let gaps = mechanism.contact_gaps(t, &q);
        let (constraint, gap) = deepest::<M, T, NQ, NV, NU, NK, NR>(&gaps)?;
        let overlaps = gap < -enough;
        let left = ConstraintError::Overlap { constraint, depth: to_f64(-gap) };
        // What was pushed too far goes back.
        let is_pushed = |k: usize| entry(&pushes, layout.pressing(k).1) > T::zero();
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
        layout.gaps().for_each(|(k, first)| put(&mut free, first, entry(&gaps, k) - entry(&moved, first)));
        let mut problem = Problem::new(layout, &smooth, &closed, &free);
        problem.weigh(&responses.rates);
        let found = problem.solve().map_err(|_| left)?;
        let all = problem.spread(&found);
        q = mechanism.integrate(&q, &(responses.velocities * (all - pushes)));
        pushes = all;
        if mechanism.features().constrained {
            q = mechanism.project(t, &q, &SVector::zeros())?.0;
        }
    }
    Ok(q)
}

/// The configuration that a simulation starts from: [`project`]'s where surfaces are to be taken apart, else
/// this one if [`check`] does not refuse it. As generated code calls it.
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
