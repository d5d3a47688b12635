//! Plastic impacts after which given contacts are closed, even if an impulse would have to pull.

use super::coefficients::checked_contact_laws;
use super::derivatives::ContactDerivatives;
use super::layout::ContactLayout;
use super::light::velocity_change_for_sticking;
use super::problem::ContactProblem;
use super::{Contacts, Solved, Touch, unsolved_contact_error};
use crate::Real;
use crate::blocks::{add_product, product};
use crate::constraint::ConstraintError;
use crate::discrete::Transition;
use nalgebra::{SMatrix, SVector};

/// Returns the velocity and the impulses after a plastic impact in which given contacts close simultaneously.
///
/// ```text
/// M (v⁺ − v) = Gᵀ Λ + Jᵀ λ,   G v⁺ = 0
/// ```
///
/// Both hold where surfaces stick; where they slip, along the normals alone and without friction. This is the
/// touchdown between two phases of a gait whose contacts are known ([`hold`](super::hold)). Gaps are not
/// looked at, and impulses may pull: [`impact`](super::impact) finds out itself which contacts act.
///
/// ```
/// use linkwork::contact::{self, Touch};
/// use linkwork::prelude::*;
///
/// #[mechanism]
/// struct Rod {
///     #[body(mass = 3, inertia = rod(3, 2, x))]
///     rod: Body,
///     #[joint(ground -> rod, about = z)]
///     pose: Planar,
///     #[contact(rod.at(x), ground.plane(y), friction = 1)]
///     end: Contact,
/// }
/// # fn main() -> Result<(), ConstraintError> {
/// // A level rod that falls on one end keeps a quarter of its momentum: Λ = m v / 4.
/// let falling = [0.0, -2.0, 0.0].into();
/// let after = contact::land(&Rod {}, 0.0, &Rod {}.neutral(), &falling, &[Touch::Sticks])?;
/// assert!((after.impulses[0] - 3.0 * 2.0 / 4.0).abs() < 1e-12);
/// assert!((after.v[1] + after.v[2]).abs() < 1e-12 && (after.v[2] - 1.5).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// [`ConstraintError::Contact`] with a contact that cannot stay closed, as constraints or other contacts
/// forbid it.
pub fn land<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    touches: &[Touch; NK],
) -> Result<Solved<T, NV, NR>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    touchdown_with_responses(mechanism, t, (q, v), touches).map(|(solved, ..)| solved)
}

/// Computes the impact of [`land`], and also returns the factorised equations and the responses to impulses.
#[allow(clippy::type_complexity, reason = "sizes of arrays")]
fn touchdown_with_responses<
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
    touches: &[Touch; NK],
) -> Result<(Solved<T, NV, NR>, ContactProblem<T, NK, NR>, SMatrix<T, NV, NR>), ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let closed = touches.map(|touch| touch != Touch::Open);
    let free = mechanism.contact_rates(t, q, v);
    if free.iter().any(|rate| !rate.is_finite()) {
        return Err(ConstraintError::NotFinite);
    }
    let layout = ContactLayout::of_mechanism(mechanism);
    let laws = checked_contact_laws(mechanism)?;
    let mut problem = ContactProblem::new(layout, &laws, &closed, &free);
    let responses = mechanism.contact_responses(t, q, &closed);
    problem.copy_closed_contact_weights(&responses.rates);
    let mut has_ill_conditioned_factors = false;
    let found = problem.forces_in_modes(touches, &SVector::zeros(), &mut has_ill_conditioned_factors);
    if has_ill_conditioned_factors
        && let Some((change, impulses)) =
            velocity_change_for_sticking(mechanism, t, q, (touches, &laws), &-free)
    {
        return Ok((Solved { v: v + change, impulses }, problem, responses.velocities));
    }
    let impulses = problem
        .impulses_at_mechanism_rows(&found.map_err(unsolved_contact_error::<M, T, NQ, NV, NU, NK, NR>)?);
    let v = v + responses.velocities * impulses;
    Ok((Solved { v, impulses }, problem, responses.velocities))
}

/// Velocity and impulses of a plastic impact ([`land`]) with their first derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandedDerivatives<T, const NV: usize, const NR: usize> {
    /// Generalized velocity after the impact, m/s and rad/s.
    pub v: SVector<T, NV>,
    /// Contact impulses, N·s and N·m·s, in the order of [`Solved`].
    pub impulses: SVector<T, NR>,
    /// `∂v⁺/∂q`: derivatives of the velocity after the impact with respect to the configuration.
    pub by_q: SMatrix<T, NV, NV>,
    /// `∂v⁺/∂v`: derivatives of the velocity after the impact with respect to the velocity before it.
    pub by_v: SMatrix<T, NV, NV>,
    /// `∂Λ/∂q`: derivatives of the contact impulses with respect to the configuration.
    pub impulses_by_q: SMatrix<T, NR, NV>,
    /// `∂Λ/∂v`: derivatives of the contact impulses with respect to the velocity before the impact.
    pub impulses_by_v: SMatrix<T, NR, NV>,
}

impl<T: Real, const NV: usize, const NR: usize> LandedDerivatives<T, NV, NR> {
    /// Returns the touchdown at a configuration as a step of zero duration, for
    /// [`optimal::backward`](crate::optimal::backward): only the velocity changes, and inputs have no effect.
    pub fn transition<const NQ: usize, const NU: usize>(
        &self,
        q: &SVector<T, NQ>,
    ) -> Transition<T, NQ, NV, NU> {
        let q_by_q = SMatrix::identity();
        Transition { q: *q, v: self.v, q_by_q, v_by_q: self.by_q, v_by_v: self.by_v, ..Transition::zeros() }
    }
}

/// Returns the velocity and impulses of [`land`] with their first derivatives with respect to configuration
/// and velocity, including the constraints of the mechanism. A derivative with respect to `q` may be along a
/// displacement that violates the contacts.
///
/// # Errors
///
/// The errors of [`land`].
pub fn land_derivatives<
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
    touches: &[Touch; NK],
) -> Result<LandedDerivatives<T, NV, NR>, ConstraintError>
where
    T: Real,
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let (Solved { v: after, impulses }, problem, velocities) =
        touchdown_with_responses(mechanism, t, (q, v), touches)?;
    let still = SVector::zeros();
    let jacobian = mechanism.contact_jacobian(t, q);
    let parts = mechanism.contact_derivatives(t, q, &after, &still, &impulses);
    // The change of velocity is the acceleration from rest under the impulses, without what acts anyway.
    let bias = mechanism.bias_forces(t, q, &still);
    let struck = bias + jacobian.tr_mul(&impulses);
    let (mut by_q, _, response) = mechanism.forward_dynamics_derivatives(t, q, &still, &struck);
    by_q -= mechanism.forward_dynamics_derivatives(t, q, &still, &bias).0;
    add_product(&mut by_q, &response, &parts.forces_by_q);
    let answer = problem.force_derivatives(touches, &SVector::zeros());
    let mut gaps = parts.rates_by_q;
    add_product(&mut gaps, &jacobian, &by_q);
    let (impulses_by_q, impulses_by_v) = (product(&answer, &gaps), product(&answer, &jacobian));
    add_product(&mut by_q, &velocities, &impulses_by_q);
    let mut by_v = SMatrix::identity();
    add_product(&mut by_v, &velocities, &impulses_by_v);
    Ok(LandedDerivatives { v: after, impulses, by_q, by_v, impulses_by_q, impulses_by_v })
}
