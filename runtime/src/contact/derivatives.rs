//! Derivatives of the motion with respect to state and forces while given contacts stay closed.

use super::held::accelerations_and_responses;
use super::layout::ContactLayout;
use super::parameters::ContactsByParameters;
use super::problem::{ContactProblem, entry_or_zero};
use super::{Contacts, Rows, Touch};
use crate::blocks::{
    add_multiple, add_product, add_product_of_some, product, transpose_into, transposed, zeros,
};
use crate::constraint::ConstraintError;
use crate::derivatives::{ByMotion, LinearMotion, convert_to_input_derivatives};
use crate::{Derivatives, Real};
use core::ops::Range;
use nalgebra::{ArrayStorage, SMatrix, SVector};

/// Mechanisms with first derivatives of their contact forces and contact accelerations.
/// `#[mechanism(…, derivatives)]` implements this trait for mechanisms with contacts.
///
/// A derivative by `q` is along motions of the configuration, whether contacts allow them or not: column `i`
/// is along `q ⊕ ε eᵢ`, for ball and free joints in body axes. Time `t` as for [`Contacts`].
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no derivatives of its contacts",
    note = "add the option to the attribute of a mechanism with contacts: `#[mechanism(…, derivatives)]`"
)]
pub trait ContactDerivatives<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>: Contacts<NQ, NV, NU, NK, NR> + Derivatives<NQ, NV, NU>
{
    /// Returns the derivatives of the generalized contact forces `Gᵀ f`, of the contact accelerations
    /// `G a + b` and of the contact velocities, for any accelerations `a` and contact forces `f`, N and N·m.
    fn contact_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        forces: &SVector<Self::Scalar, NR>,
    ) -> FirstOrder<Self::Scalar, NV, NR>;

    /// Returns the derivatives of contacts that depend on the inputs directly, at constant contact forces;
    /// `None` if no contact does. Inputs that are parameters change contacts.
    #[doc(hidden)]
    fn contact_derivatives_by_inputs(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NV>,
        _forces: &SVector<Self::Scalar, NR>,
    ) -> Option<ContactsByParameters<Self::Scalar, NV, NU, NK, NR>> {
        None
    }

    /// Returns the derivatives of the momentum `M δv` of a constant change of the velocity with respect to
    /// the inputs; `None` if the mass matrix does not depend on them.
    #[doc(hidden)]
    fn momentum_change_by_inputs(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _change: &SVector<Self::Scalar, NV>,
    ) -> Option<SMatrix<Self::Scalar, NV, NU>> {
        None
    }
}

/// First derivatives of generalized contact forces `Gᵀ f`, contact accelerations `G a + b` and contact
/// velocities, with the contact Jacobian `G`, its bias `b` and the contact forces `f`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrder<T, const NV: usize, const NR: usize> {
    /// `∂(Gᵀ f)/∂q`: derivatives of the generalized contact forces at constant contact forces `f`.
    pub forces_by_q: SMatrix<T, NV, NV>,
    /// `∂(G a + b)/∂q`: derivatives of the contact accelerations with respect to the configuration.
    pub accelerations_by_q: SMatrix<T, NR, NV>,
    /// `∂(G a + b)/∂v`: derivatives of the contact accelerations with respect to the velocity.
    pub accelerations_by_v: SMatrix<T, NR, NV>,
    /// Derivatives of the contact velocities ([`contact_rates`](Contacts::contact_rates)) with respect to
    /// `q`. Those with respect to `v` are the contact Jacobian `G`.
    pub rates_by_q: SMatrix<T, NR, NV>,
}

/// Derivatives of contacts ([`FirstOrder`]) as lists of columns, the form in which generated code returns
/// them.
#[derive(Clone, Copy, Debug)]
pub struct Columns<T, const NV: usize, const NR: usize> {
    /// Columns of `∂(Gᵀ f)/∂q`, the derivatives of the generalized contact forces.
    pub forces_by_q: [[T; NV]; NV],
    /// Columns of `∂(G a + b)/∂q`, the derivatives of the contact accelerations.
    pub accelerations_by_q: [[T; NR]; NV],
    /// Columns of `∂(G a + b)/∂v`, the derivatives of the contact accelerations.
    pub accelerations_by_v: [[T; NR]; NV],
    /// Columns of the derivatives of the contact velocities with respect to `q`.
    pub rates_by_q: [[T; NR]; NV],
}

impl<T, const NV: usize, const NR: usize> From<Columns<T, NV, NR>> for FirstOrder<T, NV, NR> {
    fn from(parts: Columns<T, NV, NR>) -> Self {
        Self {
            forces_by_q: SMatrix::from_array_storage(ArrayStorage(parts.forces_by_q)),
            accelerations_by_q: SMatrix::from_array_storage(ArrayStorage(parts.accelerations_by_q)),
            accelerations_by_v: SMatrix::from_array_storage(ArrayStorage(parts.accelerations_by_v)),
            rates_by_q: SMatrix::from_array_storage(ArrayStorage(parts.rates_by_q)),
        }
    }
}

/// Accelerations and contact forces while given contacts stay closed, with their first derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldDerivatives<T, const NV: usize, const NR: usize> {
    /// Generalized accelerations, m/s² and rad/s².
    pub a: SVector<T, NV>,
    /// Contact forces, N and N·m, in the order of [`Held`](super::Held).
    pub forces: SVector<T, NR>,
    /// `∂v̇/∂q`: derivatives of the accelerations with respect to the configuration.
    pub by_q: SMatrix<T, NV, NV>,
    /// `∂v̇/∂v`: derivatives of the accelerations with respect to the velocity.
    pub by_v: SMatrix<T, NV, NV>,
    /// `∂v̇/∂τ`: derivatives of the accelerations with respect to the generalized forces.
    pub by_tau: SMatrix<T, NV, NV>,
    /// `∂f/∂q`: derivatives of the contact forces with respect to the configuration.
    pub forces_by_q: SMatrix<T, NR, NV>,
    /// `∂f/∂v`: derivatives of the contact forces with respect to the velocity.
    pub forces_by_v: SMatrix<T, NR, NV>,
    /// `∂f/∂τ`: derivatives of the contact forces with respect to the generalized forces.
    pub forces_by_tau: SMatrix<T, NR, NV>,
}

impl<T: Real, const NV: usize, const NR: usize> HeldDerivatives<T, NV, NR> {
    /// Returns zero accelerations, forces and derivatives, as workspace for
    /// [`Holding::held_derivatives_into`](super::Holding::held_derivatives_into).
    pub fn zeros() -> Self {
        Self {
            a: zeros(),
            forces: zeros(),
            by_q: zeros(),
            by_v: zeros(),
            by_tau: zeros(),
            forces_by_q: zeros(),
            forces_by_v: zeros(),
            forces_by_tau: zeros(),
        }
    }
}

/// Returns the accelerations and contact forces of [`forward_dynamics`](super::forward_dynamics) with given
/// contacts closed, and their first derivatives with respect to configuration, velocity and generalized
/// forces.
///
/// Differentiating the equations of motion, and those that hold the contacts, gives with the free response
/// `∂v̇/∂x` under the forces `τ + Gᵀ f`
///
/// ```text
/// G M⁻¹ Gᵀ δf = −(∂(G v̇ + b) + G ∂v̇),   δv̇ = ∂v̇ + M⁻¹ Gᵀ δf,
/// ```
///
/// along the normals alone where surfaces slip, with `δfₜ` from Coulomb's law, whose direction turns with the
/// slip (Mastalli et al., *Crocoddyl: An Efficient and Versatile Framework for Multi-Contact Optimal
/// Control*, 2020, without slip). Constraints of the mechanism are in the free response. A derivative by `q`
/// is along motions that the contacts need not allow; of forces that are shared by more contacts than the
/// motion can tell apart it is that of least norm, and only along motions that keep them shared.
///
/// ```
/// use linkwork::contact::{self, Touch};
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * z, derivatives)]
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
/// let (q, v) = (Block {}.neutral(), [1.0, 0.0, 0.0, 0.0, 0.0, 0.0].into());
/// let tau = [3.0, 0.0, 0.0, 0.0, 0.0, 0.0].into();
/// // What presses the block down brakes it: friction takes half of it.
/// let slips = contact::forward_dynamics_derivatives(&Block {}, 0.0, &q, &v, &tau, &[Touch::Slips])?;
/// assert!((slips.by_tau[(0, 0)] - 0.5).abs() < 1e-12 && (slips.by_tau[(0, 2)] - 0.25).abs() < 1e-12);
/// // Slip to the side turns friction: 0.5 · 2 · 9.81 N at 1 m/s.
/// assert!((slips.by_v[(1, 1)] + 0.5 * 9.81).abs() < 1e-12);
/// // Where it sticks, no force but torques move it, about its foot.
/// let sticks = contact::forward_dynamics_derivatives(&Block {}, 0.0, &q, &v, &tau, &[Touch::Sticks])?;
/// assert!(sticks.by_tau.fixed_view::<3, 6>(0, 0).amax() < 1e-12);
/// assert!((sticks.forces_by_tau[(0, 2)] + 1.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// The errors of [`forward_dynamics`](super::forward_dynamics).
pub fn forward_dynamics_derivatives<
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
) -> Result<HeldDerivatives<T, NV, NR>, ConstraintError>
where
    T: Real,
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
{
    contact_derivatives_with_gains(mechanism, t, (q, v), tau, touches, [T::zero(); 2])
}

/// Computes [`Contacts::held_derivatives`] for mechanisms that implement [`ContactDerivatives`].
pub fn held_derivatives<
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
    u: &SVector<T, NU>,
    touches: &[Touch; NK],
    gains: [T; 2],
) -> Option<ByMotion<T, NV, NU>>
where
    T: Real,
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let tau = mechanism.generalized_forces(t, q, v, u);
    let found = contact_derivatives_with_gains(mechanism, t, (q, v), &tau, touches, gains).ok()?;
    let by_force = (found.by_q, found.by_v, found.by_tau);
    Some(convert_to_input_derivatives(by_force, &mechanism.generalized_forces_derivatives(t, q, v, u)))
}

/// Returns [`forward_dynamics_derivatives`] with gains by which gaps and contact velocities of enforced
/// contacts decay.
pub(super) fn contact_derivatives_with_gains<
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
    gains: [T; 2],
) -> Result<HeldDerivatives<T, NV, NR>, ConstraintError>
where
    T: Real,
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let mut found = HeldDerivatives::zeros();
    write_held_derivatives(mechanism, t, (q, v), tau, touches, gains, &mut found)?;
    Ok(found)
}

/// Writes accelerations, contact forces and their derivatives into `result`, overwriting any content.
#[allow(clippy::too_many_arguments, reason = "a state, what acts, and what is told of contacts")]
pub(super) fn write_held_derivatives<
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
    gains: [T; 2],
    found: &mut HeldDerivatives<T, NV, NR>,
) -> Result<(), ConstraintError>
where
    T: Real,
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let along = mechanism.contact_rates(t, q, v);
    let (held, responses) = accelerations_and_responses(mechanism, t, (q, v), tau, touches, (&along, gains))?;
    let jacobian = mechanism.contact_jacobian(t, q);
    let acting = tau + jacobian.tr_mul(&held.forces);
    (found.a, found.forces) = (held.a, held.forces);
    (found.by_q, found.by_v, found.by_tau) = (zeros(), zeros(), zeros());
    let HeldDerivatives { by_q, by_v, by_tau, .. } = &mut *found;
    mechanism.forward_dynamics_derivatives_into(t, q, v, &acting, by_q, by_v, by_tau);
    let Some(responses) = responses else {
        (found.forces_by_q, found.forces_by_v, found.forces_by_tau) = (zeros(), zeros(), zeros());
        return Ok(());
    };
    let laws = mechanism.contact_laws();
    let layout = ContactLayout::of_mechanism(mechanism);
    let mut parts = mechanism.contact_derivatives(t, q, v, &held.a, &held.forces);
    add_gain_terms(&mut parts, &jacobian, layout, gains);
    // How friction turns with the slip while the normal forces stay.
    let turned = touches.contains(&Touch::Slips).then(|| {
        let mut turned = [zeros::<T, NR, NV>(); 2];
        for (k, law) in laws.iter().enumerate().filter(|(k, _)| touches.get(*k) == Some(&Touch::Slips)) {
            let normal = law.friction * entry_or_zero(&held.forces, layout.bounding_contact(k).1);
            for (turned, rates) in turned.iter_mut().zip([&parts.rates_by_q, &jacobian]) {
                write_friction_derivative(turned, layout.tangent_rows(k), normal, &along, rates);
            }
        }
        turned
    });
    if let Some([by_q, by_v]) = &turned {
        let across = transposed(&jacobian);
        add_product(&mut parts.forces_by_q, &across, by_q);
        add_product(&mut found.by_v, &found.by_tau, &product(&across, by_v));
    }
    add_product(&mut found.by_q, &found.by_tau, &parts.forces_by_q);
    let closed = touches.map(|touch| touch != Touch::Open);
    let mut problem = ContactProblem::new(layout, &laws, &closed, &SVector::zeros());
    problem.copy_closed_contact_weights(&responses.rates);
    // How the forces answer to the rates, which all of the derivatives share; those of contacts that are open
    // do nothing.
    let answer = problem.force_derivatives(touches, &along);
    let (places, count) = closed_rows::<NK, NR>(layout, &closed);
    let places = places.get(..count).unwrap_or(&[]);
    // What forces do to the rates is what impulses at the contacts do to the velocities, unless forces depend
    // on the motion.
    let mut pushed = zeros();
    match mechanism.features().feedback {
        true => add_product(&mut pushed, &jacobian, &found.by_tau),
        false => transpose_into(&responses.velocities, &mut pushed),
    }
    add_product(&mut parts.accelerations_by_q, &jacobian, &found.by_q);
    add_product(&mut parts.accelerations_by_v, &jacobian, &found.by_v);
    let HeldDerivatives { by_q, by_v, by_tau, forces_by_q, forces_by_v, forces_by_tau, .. } = &mut *found;
    for (motion, forces, rates) in [
        (by_q, forces_by_q, &parts.accelerations_by_q),
        (by_v, forces_by_v, &parts.accelerations_by_v),
        (by_tau, forces_by_tau, &pushed),
    ] {
        *forces = zeros();
        add_product_of_some(forces, places, &answer, rates);
        add_product_of_some(motion, places, &responses.velocities, forces);
    }
    if let Some([by_q, by_v]) = &turned {
        add_multiple(&mut found.forces_by_q, T::one(), by_q);
        add_multiple(&mut found.forces_by_v, T::one(), by_v);
    }
    Ok(())
}

/// Returns the rows of the contact velocities of closed contacts, and their number.
fn closed_rows<const NK: usize, const NR: usize>(
    layout: ContactLayout<NK>,
    closed: &[bool; NK],
) -> ([usize; NR], usize) {
    let (mut places, mut count) = ([0; NR], 0);
    for (k, _) in closed.iter().enumerate().filter(|(_, is_closed)| **is_closed) {
        let Rows { first, count: more } = layout.rows(k);
        for (place, row) in places.iter_mut().skip(count).zip(first..first + more) {
            *place = row;
        }
        count += more;
    }
    (places, count)
}

/// Adds to the derivatives of the contact accelerations the terms of the gains, `kᵥ u + kₚ g`, for gaps
/// `g` and contact velocities `u` of enforced contacts.
fn add_gain_terms<T: Real, const NV: usize, const NK: usize, const NR: usize>(
    parts: &mut FirstOrder<T, NV, NR>,
    jacobian: &SMatrix<T, NR, NV>,
    layout: ContactLayout<NK>,
    [position, velocity]: [T; 2],
) {
    if velocity != T::zero() {
        add_multiple(&mut parts.accelerations_by_q, velocity, &parts.rates_by_q);
        add_multiple(&mut parts.accelerations_by_v, velocity, jacobian);
    }
    if position != T::zero() {
        for (_, first) in layout.gap_contacts() {
            for (change, by_q) in parts.accelerations_by_q.data.0.iter_mut().zip(&jacobian.data.0) {
                if let (Some(change), Some(by_q)) = (change.get_mut(first), by_q.get(first)) {
                    *change += *by_q * position;
                }
            }
        }
    }
}

/// Writes the derivative of the friction force `−μ fₙ u / |u|` of a sliding contact with respect to the slip
/// velocity, into the rows of its tangents. `friction` is `μ fₙ`.
fn write_friction_derivative<T: Real, const NV: usize, const NR: usize>(
    turned: &mut SMatrix<T, NR, NV>,
    tangents: Range<usize>,
    friction: T,
    rates: &SVector<T, NR>,
    changes: &SMatrix<T, NR, NV>,
) {
    let speed = tangents
        .clone()
        .fold(T::zero(), |sum, i| sum + entry_or_zero(rates, i) * entry_or_zero(rates, i))
        .sqrt();
    if speed == T::zero() {
        return;
    }
    for j in 0..NV {
        let slip_velocity_derivative_at_row = |i: usize| changes.get((i, j)).copied().unwrap_or(T::zero());
        let faster = tangents
            .clone()
            .fold(T::zero(), |sum, i| sum + entry_or_zero(rates, i) * slip_velocity_derivative_at_row(i))
            / speed;
        for i in tangents.clone() {
            if let Some(turned) = turned.get_mut((i, j)) {
                *turned = -(slip_velocity_derivative_at_row(i) - entry_or_zero(rates, i) / speed * faster)
                    * (friction / speed);
            }
        }
    }
}

/// Returns the motion under the inputs `u` to first order while given contacts stay closed, the counterpart
/// of [`linear_motion`](crate::Derivatives::linear_motion) for mechanisms with contacts.
///
/// # Errors
///
/// The errors of [`forward_dynamics`](super::forward_dynamics).
pub fn linear_motion<
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
    u: &SVector<T, NU>,
    touches: &[Touch; NK],
) -> Result<LinearMotion<T, NV, NU>, ConstraintError>
where
    T: Real,
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let tau = mechanism.generalized_forces(t, q, v, u);
    let held = forward_dynamics_derivatives(mechanism, t, q, v, &tau, touches)?;
    let (force_by_q, force_by_v, force_by_u) = mechanism.generalized_forces_derivatives(t, q, v, u);
    Ok(LinearMotion {
        acceleration: held.a,
        by_q: held.by_q + product(&held.by_tau, &force_by_q),
        by_v: held.by_v + product(&held.by_tau, &force_by_v),
        by_u: product(&held.by_tau, &force_by_u),
        turning: mechanism.turning(q, v),
    })
}
