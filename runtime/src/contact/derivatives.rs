//! Derivatives of the motion while given contacts stay closed.

use super::held::held;
use super::layout::Layout;
use super::problem::{Problem, entry};
use super::{Contacts, Rows, Touch};
use crate::blocks::{
    add_multiple, add_product, add_product_of_some, product, transpose_into, transposed, zeros,
};
use crate::constraint::ConstraintError;
use crate::derivatives::{ByMotion, LinearMotion, under_inputs};
use crate::{Derivatives, Real};
use core::ops::Range;
use nalgebra::{ArrayStorage, SMatrix, SVector};

/// First derivatives of what contacts do. `#[mechanism(…, derivatives)]` implements it for mechanisms with
/// contacts.
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
    /// Derivatives of `Gᵀ f`, of `G a + b` and of the rates, at any accelerations `a` and forces `f` of the
    /// contacts, N and N·m.
    fn contact_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        forces: &SVector<Self::Scalar, NR>,
    ) -> FirstOrder<Self::Scalar, NV, NR>;
}

/// First derivatives of what contacts do, with their Jacobian `G`, their bias `b` and their forces `f`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrder<T, const NV: usize, const NR: usize> {
    /// `∂(Gᵀ f)/∂q`: how the generalized forces of the contacts change.
    pub forces_by_q: SMatrix<T, NV, NV>,
    /// `∂(G a + b)/∂q`.
    pub accelerations_by_q: SMatrix<T, NR, NV>,
    /// `∂(G a + b)/∂v`.
    pub accelerations_by_v: SMatrix<T, NR, NV>,
    /// Derivatives of [`contact_rates`](Contacts::contact_rates) by `q`; those by `v` are `G`.
    pub rates_by_q: SMatrix<T, NR, NV>,
}

/// [`FirstOrder`] as lists of columns, as generated code makes it.
#[derive(Clone, Copy, Debug)]
pub struct Columns<T, const NV: usize, const NR: usize> {
    /// `∂(Gᵀ f)/∂q`.
    pub forces_by_q: [[T; NV]; NV],
    /// `∂(G a + b)/∂q`.
    pub accelerations_by_q: [[T; NR]; NV],
    /// `∂(G a + b)/∂v`.
    pub accelerations_by_v: [[T; NR]; NV],
    /// Derivatives of the rates by `q`.
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

/// Accelerations and forces of contacts, with their derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldDerivatives<T, const NV: usize, const NR: usize> {
    /// The accelerations.
    pub a: SVector<T, NV>,
    /// The forces of the contacts, as in [`Held`](super::Held).
    pub forces: SVector<T, NR>,
    /// `∂v̇/∂q`.
    pub by_q: SMatrix<T, NV, NV>,
    /// `∂v̇/∂v`.
    pub by_v: SMatrix<T, NV, NV>,
    /// `∂v̇/∂τ`.
    pub by_tau: SMatrix<T, NV, NV>,
    /// `∂f/∂q`.
    pub forces_by_q: SMatrix<T, NR, NV>,
    /// `∂f/∂v`.
    pub forces_by_v: SMatrix<T, NR, NV>,
    /// `∂f/∂τ`.
    pub forces_by_tau: SMatrix<T, NR, NV>,
}

impl<T: Real, const NV: usize, const NR: usize> HeldDerivatives<T, NV, NR> {
    /// Nothing but zeros, for [`Holding::held_derivatives_into`](super::Holding::held_derivatives_into).
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

/// The accelerations and contact forces of [`forward_dynamics`](super::forward_dynamics) with given contacts
/// closed, and their first derivatives by configuration, velocity and generalized forces.
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
    derivatives(mechanism, t, (q, v), tau, touches, [T::zero(); 2])
}

/// [`Contacts::held_derivatives`] of mechanisms with derivatives.
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
    let found = derivatives(mechanism, t, (q, v), &tau, touches, gains).ok()?;
    let by_force = (found.by_q, found.by_v, found.by_tau);
    Some(under_inputs(by_force, &mechanism.generalized_forces_derivatives(t, q, v, u)))
}

/// [`forward_dynamics_derivatives`] where gaps and rates of what is held decay.
pub(super) fn derivatives<
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
    derivatives_into(mechanism, t, (q, v), tau, touches, gains, &mut found)?;
    Ok(found)
}

/// [`derivatives`] into what is there, whatever is in it.
#[allow(clippy::too_many_arguments, reason = "a state, what acts, and what is told of contacts")]
pub(super) fn derivatives_into<
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
    let (held, responses) = held(mechanism, t, (q, v), tau, touches, (&along, gains))?;
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
    let layout = Layout::of(mechanism);
    let mut parts = mechanism.contact_derivatives(t, q, v, &held.a, &held.forces);
    damp(&mut parts, &jacobian, layout, gains);
    // How friction turns with the slip while the normal forces stay.
    let turned = touches.contains(&Touch::Slips).then(|| {
        let mut turned = [zeros::<T, NR, NV>(); 2];
        for (k, law) in laws.iter().enumerate().filter(|(k, _)| touches.get(*k) == Some(&Touch::Slips)) {
            let normal = law.friction * entry(&held.forces, layout.pressing(k).1);
            for (turned, rates) in turned.iter_mut().zip([&parts.rates_by_q, &jacobian]) {
                turn(turned, layout.tangents(k), normal, &along, rates);
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
    let mut problem = Problem::new(layout, &laws, &closed, &SVector::zeros());
    problem.weigh(&responses.rates);
    // How the forces answer to the rates, which all of the derivatives share; those of contacts that are open
    // do nothing.
    let answer = problem.answers(touches, &along);
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

/// The places of the rates of contacts that are closed, and how many there are.
fn closed_rows<const NK: usize, const NR: usize>(
    layout: Layout<NK>,
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

/// Adds what the accelerations of contacts that are held are to make of gaps and rates.
fn damp<T: Real, const NV: usize, const NK: usize, const NR: usize>(
    parts: &mut FirstOrder<T, NV, NR>,
    jacobian: &SMatrix<T, NR, NV>,
    layout: Layout<NK>,
    [position, velocity]: [T; 2],
) {
    if velocity != T::zero() {
        add_multiple(&mut parts.accelerations_by_q, velocity, &parts.rates_by_q);
        add_multiple(&mut parts.accelerations_by_v, velocity, jacobian);
    }
    if position != T::zero() {
        for (_, first) in layout.gaps() {
            for (change, by_q) in parts.accelerations_by_q.data.0.iter_mut().zip(&jacobian.data.0) {
                if let (Some(change), Some(by_q)) = (change.get_mut(first), by_q.get(first)) {
                    *change += *by_q * position;
                }
            }
        }
    }
}

/// Puts in the change of friction of a contact that slips along `rates`, under a normal force times its
/// coefficient: that of `−μ fₙ u / |u|`.
fn turn<T: Real, const NV: usize, const NR: usize>(
    turned: &mut SMatrix<T, NR, NV>,
    tangents: Range<usize>,
    friction: T,
    rates: &SVector<T, NR>,
    changes: &SMatrix<T, NR, NV>,
) {
    let speed = tangents.clone().fold(T::zero(), |sum, i| sum + entry(rates, i) * entry(rates, i)).sqrt();
    if speed == T::zero() {
        return;
    }
    for j in 0..NV {
        let change = |i: usize| changes.get((i, j)).copied().unwrap_or(T::zero());
        let faster = tangents.clone().fold(T::zero(), |sum, i| sum + entry(rates, i) * change(i)) / speed;
        for i in tangents.clone() {
            if let Some(turned) = turned.get_mut((i, j)) {
                *turned = -(change(i) - entry(rates, i) / speed * faster) * (friction / speed);
            }
        }
    }
}

/// The motion under the inputs `u` to first order while given contacts stay closed: what
/// [`linear_motion`](crate::Derivatives::linear_motion) is without contacts.
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
