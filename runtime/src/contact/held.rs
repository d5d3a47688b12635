//! Accelerations and contact forces while given contacts are enforced as bilateral constraints, even if a
//! normal force would have to pull.

use super::coefficients::checked_contact_laws;
use super::layout::ContactLayout;
use super::light::velocity_change_for_sticking;
use super::problem::{ContactProblem, entry_or_zero, set_entry};
use super::{Contacts, Responses, Touch, unsolved_contact_error};
use crate::Real;
use crate::constraint::ConstraintError;
use nalgebra::SVector;

/// Accelerations and contact forces while given contacts stay closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held<T, const NV: usize, const NR: usize> {
    /// Generalized accelerations, m/s² and rad/s².
    pub a: SVector<T, NV>,
    /// Contact forces, N, or N·m for stops of revolute joints: for each contact the normal force, positive in
    /// compression, then the tangential forces.
    pub forces: SVector<T, NR>,
}

/// Returns the accelerations under the generalized forces `tau` and the contact forces, while the contact
/// modes `touches` are enforced.
///
/// ```text
/// M v̇ + h = τ + Gᵀ f + Jᵀ λ,   G v̇ + b = 0 where surfaces stick, and along the normals where they slip with fₜ = −μ fₙ uₜ / |uₜ|
/// ```
///
/// Controllers of legged robots and estimators that know their contacts need it (Featherstone, *Rigid Body
/// Dynamics Algorithms*, 2008, ch. 11). Gaps are not looked at; forces may pull, and leave the cone of
/// friction: who chooses contacts checks what it takes to hold them. [`acting`](super::acting) finds out
/// itself which of them hold. Forces that are shared by more contacts than the motion can tell apart are
/// those of least norm where no surfaces slip.
///
/// ```
/// use linkwork::contact::{self, Touch};
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * z)]
/// struct Block {
///     #[body(mass = 2, inertia = cuboid(2, 0.3, 0.3, 0.3))]
///     block: Body,
///     #[joint(ground -> block)]
///     pose: Free,
///     #[contact(block, ground.plane(z), friction = 0.5)]
///     foot: Contact,
/// }
///
/// # fn main() -> Result<(), ConstraintError> {
/// // Pushed with 3 N along x through its foot, which here is its centre.
/// let (q, v) = (Block {}.neutral(), [1.0, 0.0, 0.0, 0.0, 0.0, 0.0].into());
/// let tau = [3.0, 0.0, 0.0, 0.0, 0.0, 0.0].into();
/// let sticks = contact::forward_dynamics(&Block {}, 0.0, &q, &v, &tau, &[Touch::Sticks])?;
/// assert!(sticks.a.amax() < 1e-12 && (sticks.forces[0] - 2.0 * 9.81).abs() < 1e-12);
/// let slips = contact::forward_dynamics(&Block {}, 0.0, &q, &v, &tau, &[Touch::Slips])?;
/// assert!((slips.a[0] - (3.0 - 0.5 * 2.0 * 9.81) / 2.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// [`ConstraintError::Contact`] with a contact that cannot stay closed, as constraints or other contacts
/// forbid it; those of the accelerations of a mechanism with constraints.
pub fn forward_dynamics<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    tau: &SVector<T, NV>,
    touches: &[Touch; NK],
) -> Result<Held<T, NV, NR>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let rates = mechanism.contact_rates(t, q, v);
    accelerations_and_responses(mechanism, t, (q, v), tau, touches, (&rates, [T::zero(); 2]))
        .map(|(held, _)| held)
}

/// Computes [`forward_dynamics`] for slip velocities `along`, which friction opposes, and also returns the
/// responses to impulses if any contact is closed. Gaps `g` and contact velocities `u` of enforced contacts
/// decay with the gains `kₚ`, 1/s², and `kᵥ`, 1/s: `G v̇ + b = −kᵥ u − kₚ g`.
#[allow(clippy::type_complexity, reason = "sizes of arrays")]
pub(super) fn accelerations_and_responses<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    mechanism: &M,
    t: T,
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    tau: &SVector<T, NV>,
    touches: &[Touch; NK],
    (along, [position, velocity]): (&SVector<T, NR>, [T; 2]),
) -> Result<(Held<T, NV, NR>, Option<Responses<T, NV, NR>>), ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let a = mechanism.try_forward_dynamics(t, q, v, tau)?;
    let closed = touches.map(|touch| touch != Touch::Open);
    if closed.iter().all(|is_closed| !is_closed) {
        return Ok((Held { a, forces: SVector::zeros() }, None));
    }
    let layout = ContactLayout::of_mechanism(mechanism);
    let moved = mechanism.contact_rates(t, q, &a) - mechanism.contact_rates(t, q, &SVector::zeros());
    let mut free = moved + mechanism.contact_bias(t, q, v);
    if velocity != T::zero() {
        free += mechanism.contact_rates(t, q, v) * velocity;
    }
    if position != T::zero() {
        let gaps = mechanism.contact_gaps(t, q);
        for (k, first) in layout.gap_contacts() {
            let rate = entry_or_zero(&free, first);
            set_entry(&mut free, first, rate + entry_or_zero(&gaps, k) * position);
        }
    }
    if free.iter().any(|rate| !rate.is_finite()) {
        return Err(ConstraintError::NotFinite);
    }
    let responses = mechanism.contact_responses(t, q, &closed);
    let laws = checked_contact_laws(mechanism)?;
    let mut problem = ContactProblem::new(layout, &laws, &closed, &free);
    problem.copy_closed_contact_weights(&responses.rates);
    let mut has_ill_conditioned_factors = false;
    let found = problem.forces_in_modes(touches, along, &mut has_ill_conditioned_factors);
    if has_ill_conditioned_factors
        && let Some((change, forces)) =
            velocity_change_for_sticking(mechanism, t, q, (touches, &laws), &-free)
    {
        return Ok((Held { a: a + change, forces }, Some(responses)));
    }
    let forces = problem
        .impulses_at_mechanism_rows(&found.map_err(unsolved_contact_error::<M, T, NQ, NV, NU, NK, NR>)?);
    Ok((Held { a: a + responses.velocities * forces, forces }, Some(responses)))
}
