//! Contacts that open and close: gaps, impacts, friction ([guide](crate::guide::contact)).
//!
//! A [`Contact`](crate::elements::Contact) or a [`Limit`](crate::elements::Limit) with `restitution` declares
//! one. The functions of the dynamics, such as `forward_dynamics`, ignore contacts.
//! [`TimeStepping`] simulates them with the functions [`impact`] and
//! [`solve`], and [`EventDriven`](crate::integrate::EventDriven) locates every event. Other integration
//! methods do not compile for a mechanism with contacts, so that none is ignored unnoticed; [`apart`] returns
//! the mechanism without contacts.
//!
//! # Contact conditions
//!
//! The gap `g` and the normal impulse `Λ` of a contact are not negative, and separating surfaces have no
//! impulse. After an impact the gap velocity is at least `−e` times that before it (Newton's law of
//! restitution). Friction is Coulomb's: the tangential impulse is at most `μ Λ` if surfaces stick, and
//! opposes the slip with `μ Λ` if they slip. All contacts, and all constraints of the mechanism, act at once:
//! with the contact velocities `u = G v`,
//!
//! ```text
//! M (v⁺ − v) = Gᵀ Λ + Jᵀ λ,   J v⁺ = 0,   0 ≤ u⁺ₙ + e u⁻ₙ  ⊥  Λₙ ≥ 0,   |Λₜ| ≤ μ Λₙ,  Λₜ = −μ Λₙ u⁺ₜ / |u⁺ₜ| where it slips
//! ```
//!
//! With Poisson's restitution (`restitution = poisson(e)`) an impact has two phases, each with Coulomb's law.
//! The impulses `Λᶜ` of compression are those without restitution, `0 ≤ uᶜₙ ⊥ Λᶜₙ ≥ 0`. The impulses of
//! restitution are at least `e Λᶜₙ`, and larger if surfaces would approach each other:
//! `0 ≤ u⁺ₙ ⊥ Λₙ − (1 + e) Λᶜₙ ≥ 0` (Glocker and Pfeiffer, *Multiple impacts with friction in rigid multibody
//! systems*, Nonlinear Dynamics 7, 1995). In a time step, compression starts from the velocity before the
//! step, so that resting bodies do not bounce.
//!
//! (Moreau, *Unilateral contact and dry friction in finite freedom dynamics*, 1988; Acary and Brogliato,
//! *Numerical Methods for Nonsmooth Dynamical Systems*, 2008).
//!
//! # Solution
//!
//! If more than 36 contact velocities are closed, contacts that no impulses couple form groups, and each
//! group is solved alone. Impulses are searched in four stages. A stage ends the search if its impulses
//! satisfy the conditions to rounding. All contacts take each iteration at once, so that the order of
//! declaration does not affect the result.
//!
//! 1. If all approaching contacts stick, the problem is linear. With more than 12 contact velocities, the
//!    impulses of the previous step come first if they nearly satisfy the conditions. A stack at rest then
//!    takes no iteration.
//! 2. Newton's method for the natural map (Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991)
//!    takes three to four iterations in most steps, and at most 16. Its linear system is that of the velocity
//!    change, with the rows of the contact velocities eliminated contact by contact. It is as large as the
//!    number of velocities of the bodies in contact, for any number of contact points, regular for redundant
//!    contacts, and assembled from blocks of the bodies of each contact, as in SAP (Castro, Permenter and
//!    Han, IEEE Trans. Robot. 39, 2023).
//! 3. A sequence of at most 16 convex problems, with at most 60 iterations of Newton's method in all. The
//!    conditions with friction are neither convex nor always solvable. They become a convex problem with
//!    exactly one solution if normal impulses are coupled to slip (Anitescu, Math. Program. 105, 2006), which
//!    Drake and MuJoCo solve; but then sliding surfaces separate. The sequence keeps the convexity and
//!    removes this error: each problem subtracts the separation that the slip of the previous problem would
//!    cause (Acary, Cadoux, Lemaréchal and Malick, ZAMM 91, 2011). Multipliers remove the regularisation, so
//!    that contacts stay rigid and redundant contacts do no harm. From two impulses of the sequence that
//!    nearly satisfy the conditions, the method of stage 2 is tried again. A pivoting method (Lemke) would
//!    need friction cones with edges, projected Gauss–Seidel (Siconos, ODE) depends on the order of contacts
//!    and converges slowly for large mass ratios, and ADMM (Pinocchio) needs tuned penalties.
//! 4. The method of stage 2 from the best impulses of the sequence.
//!
//! The first two stages are exact: one body on the ground neither creeps nor gains energy. In a step with
//! more than 12 contact velocities, a violation below `1e-8` of the largest contact velocity ends the search
//! where iterations hardly reduce it: velocities of redundant contacts contradict each other by rounding
//! errors. If no stage succeeds, a step of [`TimeStepping`] takes the
//! impulses that violate the conditions least, and reports the violation
//! ([`Sample::violation`](crate::simulate::Sample::violation)). The impulses of each convex problem dissipate
//! energy, so that such a step adds none either.
//!
//! Up to 24 contacts of single impacts ([`impact`] and [`solve`]) go on to an active set (without friction),
//! projected gradient steps with momentum (Nesterov; Mazhar et al., ACM Trans. Graph. 34, 2015), friction
//! that grows by degrees, and guesses of sticking contacts. So do steps with coefficients of friction above
//! 4. Steps with up to six contacts take three rounds of the gradient steps. Single impacts for which these
//! fail, too, are errors.
//!
//! After the impulses, displacements close gaps and penetrations of contacts that stay closed. Gaps can
//! contradict each other if a contact has moved to another edge of a body in the step. Contacts with open
//! gaps then stay open, and only penetrations are removed.
//!
//! Mechanisms with many contacts have matrices for their closed contacts only. If the motion does not
//! determine the impulses of redundant contacts (a table on four legs), they have the least norm if all
//! stick; if some slip there may be several solutions. Newton's law of restitution together with friction can
//! add energy (Kane's paradox), or have no solution. All coefficients of restitution are then reduced
//! together, to a fraction that is found by bisection. In a step, bisection ends after 128 iterations of
//! Newton's method.

use crate::blocks::zeros;
use crate::constraint::ConstraintError;
use crate::derivatives::ByMotion;
use crate::discrete::Transition;
use crate::integrate::{Error, TimeStepping};
use crate::private::{constant, epsilon};
use crate::{Mechanism, Real};
use nalgebra::{SMatrix, SVector};

mod apart;
mod coefficients;
mod derivatives;
mod force;
mod held;
mod holding;
mod impulses;
mod landing;
mod layout;
mod light;
mod observer;
mod overlap;
mod parameters;
mod phase;
mod polytopes;
mod problem;
mod response;
mod selection;
mod sensitivity;
mod solution;
mod stepping;
mod total;
mod velocities;

pub use apart::{Apart, apart};
use coefficients::checked_contact_laws;
pub use coefficients::{Law, Restitution};
#[doc(hidden)]
pub use derivatives::{Columns, held_derivatives};
pub use derivatives::{
    ContactDerivatives, FirstOrder, HeldDerivatives, forward_dynamics_derivatives, linear_motion,
};
pub use force::{acting, forces};
pub use held::{Held, forward_dynamics};
pub use holding::{Holding, hold};
#[doc(hidden)]
pub use impulses::{Assumed, Impulses};
pub use landing::{LandedDerivatives, land, land_derivatives};
use layout::ContactLayout;
#[doc(hidden)]
pub use overlap::start;
pub use overlap::{check, project};
pub(crate) use parameters::ParametersAsInputs;
#[doc(hidden)]
pub use parameters::differentiate_step_by_parameters;
pub use parameters::{ContactSensitivities, ContactsByParameters};
pub(crate) use phase::{
    ContactPhase, PhaseState, PhasedMechanism, state_projected_onto_contacts as kept, velocity_after_impact,
};
#[doc(hidden)]
pub use polytopes::{
    Polytope, PolytopeEdge, PolytopeFace, PolytopePair, contact_features, write_contact_features,
};
#[doc(hidden)]
pub use response::responses;
use selection::ContactSelection;
#[doc(hidden)]
pub use sensitivity::differentiate_step;
use solution::{ContactsWithImpulses, compute_closed_contact_impulses};
use stepping::closed_contacts;
#[doc(hidden)]
pub use stepping::step;
use velocities::ContactVelocities;

/// Indices of the contact velocities of one contact: the gap velocity first, then the slip velocities. Those
/// of a friction moment ([`PRESSED_BY`](Contacts::PRESSED_BY)) are relative angular velocities only, rad/s.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rows {
    /// Index of the gap velocity in the vector of contact velocities. For a friction moment, the index of its
    /// first relative angular velocity.
    pub first: usize,
    /// Number of contact velocities: one without friction, up to three with friction; one for a spin moment,
    /// up to two for a rolling moment.
    pub count: usize,
}

/// Contact mode that is assumed for a contact: open, sticking or sliding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// Open contact: no contact force acts.
    Open,
    /// Sticking contact: surfaces stay together without slip if there is friction. For a friction moment, the
    /// surfaces do not rotate relative to each other.
    Sticks,
    /// Sliding contact: surfaces stay together, and kinetic friction acts against the slip. At zero slip,
    /// friction has no direction and does not act.
    Slips,
}

/// Mechanism with `NK` unilateral contacts (counting friction moments) and `NR` contact velocities, for
/// generic code.
///
/// `#[mechanism]` implements the trait if a [`Contact`](crate::elements::Contact) or a
/// [`Limit`](crate::elements::Limit) with `restitution` is declared. Time `t` is in seconds; it has no effect
/// on mechanisms whose equations do not contain time.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no contacts that open and close",
    label = "expected a mechanism with contacts",
    note = "`#[contact(ball.sphere(radius), ground.plane(z))] bounce: Contact` declares one"
)]
pub trait Contacts<const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>:
    Mechanism<NQ, NV, NU>
{
    /// Names of all contacts, in the order of declaration.
    const CONTACTS: [&'static str; NK];
    /// Indices of the contact velocities of each contact.
    const CONTACT_ROWS: [Rows; NK];
    /// Index of the contact whose normal force limits the friction of each entry: the contact itself, except
    /// for friction moments. Spin and rolling moments such as `foot.spin` and `foot.roll` belong to the
    /// contact `foot` and share its gap; their contact velocities are relative angular velocities.
    const PRESSED_BY: [usize; NK] = layout::self_bounding_contact_table();

    /// Returns the tables [`CONTACT_ROWS`](Self::CONTACT_ROWS) and [`PRESSED_BY`](Self::PRESSED_BY). A
    /// mechanism that is loaded at run time returns tables of its own, in which a contact without rows is
    /// padding.
    #[doc(hidden)]
    #[inline(always)]
    fn contact_tables(&self) -> ([Rows; NK], [usize; NK]) {
        (Self::CONTACT_ROWS, Self::PRESSED_BY)
    }

    /// Returns a range of columns of the contact Jacobian for each contact: the first column, and the index
    /// behind the last. Outside of this range the rows of the contact are zero.
    #[doc(hidden)]
    #[inline(always)]
    fn contact_columns(&self) -> [(usize, usize); NK] {
        [(0, NV); NK]
    }

    /// Whether contact velocities may be nonzero at zero generalized velocity, because bodies have prescribed
    /// motions.
    #[doc(hidden)]
    #[inline(always)]
    fn contacts_drift(&self) -> bool {
        true
    }

    /// Returns the gap (signed distance) of each contact, m or rad: zero at touch, negative for overlapping
    /// surfaces.
    fn contact_gaps(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> SVector<Self::Scalar, NK>;

    /// Returns the contact velocities, m/s and rad/s: for each contact the gap velocity, then the slip
    /// velocities along its tangents. For a friction moment they are the relative angular velocities about
    /// the normal (spin) or about the tangents (rolling).
    fn contact_rates(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NR>;

    /// Returns the contact Jacobian `G(t, q)`, the derivative of the contact velocities with respect to the
    /// generalized velocities.
    fn contact_jacobian(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
    ) -> SMatrix<Self::Scalar, NR, NV>;

    /// Returns the contact bias `b(t, q, v)`, m/s² and rad/s²: the acceleration of closed contacts is
    /// `G v̇ + b`.
    fn contact_bias(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NR>;

    /// Returns the changes of velocities and contact velocities due to unit contact impulses, including the
    /// constraints of the mechanism. Only contacts marked as closed are computed; entries of other contacts
    /// may be zero.
    fn contact_responses(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        closed: &[bool; NK],
    ) -> Responses<Self::Scalar, NV, NR>
    where
        Self: Sized,
    {
        response::responses(self, t, q, closed)
    }

    /// Returns the derivatives of the accelerations in the contact modes `touches`, as
    /// [`acceleration_derivatives`](crate::integrate::Hooks::acceleration_derivatives) does without contacts.
    /// Gaps and contact velocities of enforced contacts decay with position and velocity gains, 1/s² and 1/s.
    /// Returns `None` for mechanisms without [`ContactDerivatives`].
    fn held_derivatives(
        &self,
        _t: Self::Scalar,
        _state: (&SVector<Self::Scalar, NQ>, &SVector<Self::Scalar, NV>),
        _u: &SVector<Self::Scalar, NU>,
        _touches: &[Touch; NK],
        _gains: [Self::Scalar; 2],
    ) -> Option<ByMotion<Self::Scalar, NV, NU>> {
        None
    }

    /// Writes a step of time stepping with its derivatives, for
    /// [`discrete::transition`](crate::discrete::transition). Returns `None` for mechanisms without
    /// [`ContactDerivatives`].
    #[doc(hidden)]
    fn differentiate_step(
        &self,
        _method: &TimeStepping<Self::Scalar>,
        _t: Self::Scalar,
        _state: (&SVector<Self::Scalar, NQ>, &SVector<Self::Scalar, NV>),
        _u: &SVector<Self::Scalar, NU>,
        _into: &mut Transition<Self::Scalar, NQ, NV, NU>,
    ) -> Option<Result<(), Error>> {
        None
    }

    /// Returns the coefficients of friction and restitution of every contact.
    fn contact_laws(&self) -> [Law<Self::Scalar>; NK];
}

/// Generic code for mechanisms with any number of contacts, called by
/// [`visit_contacts`](crate::integrate::Hooks::visit_contacts), which provides the trait [`Contacts`] with
/// the numbers of the mechanism.
pub trait Visitor<T: Real, const NQ: usize, const NV: usize, const NU: usize> {
    /// Type of the value that the visitor returns.
    type Output;

    /// Runs the generic code on a mechanism with contacts and returns the result.
    fn visit<M, const NK: usize, const NR: usize>(self, mechanism: &M) -> Self::Output
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>;
}

/// Instantaneous responses to unit contact impulses: the resulting changes of velocities and of contact
/// velocities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Responses<T, const NV: usize, const NR: usize> {
    /// Changes of the generalized velocities by unit impulses, `M⁻¹ Gᵀ` without constraints; with
    /// constraints, their reactions are included.
    pub velocities: SMatrix<T, NV, NR>,
    /// Changes of the contact velocities by unit impulses (1 N·s or 1 N·m·s), the Delassus matrix `G M⁻¹ Gᵀ`
    /// without constraints; with constraints, their reactions are included.
    pub rates: SMatrix<T, NR, NR>,
}

impl<T: Real, const NV: usize, const NR: usize> Responses<T, NV, NR> {
    /// Returns zero responses: impulses change no velocity.
    fn zero_responses() -> Self {
        Self { velocities: zeros::<T, NV, NR>(), rates: zeros::<T, NR, NR>() }
    }

    /// Returns the responses from a list of all matrix entries, column by column. Generated code calls this
    /// function.
    #[doc(hidden)]
    pub fn from_list<const N: usize>(list: &[T; N]) -> Self {
        let (mut velocities, mut rates) = (zeros::<T, NV, NR>(), zeros::<T, NR, NR>());
        // Two loops over lists alone become copies of whole matrices.
        let first = velocities.data.0.as_flattened_mut().iter_mut();
        first.zip(list).for_each(|(entry, value)| *entry = *value);
        let (entries, rest) = (rates.data.0.as_flattened_mut(), list.get(NV * NR..).unwrap_or(&[]));
        entries.iter_mut().zip(rest).for_each(|(entry, value)| *entry = *value);
        Self { velocities, rates }
    }
}

/// State at the end of a time step with contacts, with data for the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touched<T, const NQ: usize, const NV: usize> {
    /// Configuration at the end of the step.
    pub q: SVector<T, NQ>,
    /// Velocity at the end of the step.
    pub v: SVector<T, NV>,
    /// Change of the velocity by the contact impulses of the step, with the directions that contact forces
    /// have at the end of the step. Divided by the step size, it estimates the effect of contact forces at
    /// the start of the next step.
    pub held: SVector<T, NV>,
    /// Contact impulses with which the next step starts its iteration.
    #[doc(hidden)]
    pub impulses: Impulses<T, NV>,
    /// Largest violation of the contact conditions by the impulses, as a contact velocity.
    pub violation: T,
}

impl<T: Real, const NQ: usize, const NV: usize> Touched<T, NQ, NV> {
    /// Returns the end of a step on which no contact acted: state without impulses or violation.
    pub(crate) fn state_without_contacts(q: SVector<T, NQ>, v: SVector<T, NV>) -> Self {
        Self { q, v, held: SVector::zeros(), impulses: Impulses::none(), violation: T::zero() }
    }
}

/// Velocity after contact impulses have acted, with these impulses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved<T, const NV: usize, const NR: usize> {
    /// Generalized velocity after the contact impulses, m/s and rad/s.
    pub v: SVector<T, NV>,
    /// Contact impulses, N·s, or N·m·s for stops about an axis: for each contact the normal impulse, followed
    /// by those along its tangents.
    pub impulses: SVector<T, NR>,
}

/// Returns the gap below which surfaces count as touching, m: the rounding error of positions of some metres,
/// far below relevant distances.
fn touching_distance<T: Real>() -> T {
    epsilon::<T>().sqrt() * constant(0.67)
}

/// Returns the velocity after an impact in the configuration `q` at the velocity `v`, with the impulses of
/// all contacts, N·s, or N·m·s for stops of revolute joints, in the order of
/// [`contact_rates`](Contacts::contact_rates). If no surfaces approach each other, the velocity is unchanged
/// and the impulses are zero.
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
///     #[contact(ball.sphere(0.1), ground.plane(z), friction = 0.3, restitution = 0.8)]
///     bounce: Contact,
/// }
///
/// # fn main() -> Result<(), ConstraintError> {
/// let mut q = Ball {}.neutral();
/// q[2] = 0.1;
/// let falling = [1.0, 0.0, -2.0, 0.0, 0.0, 0.0].into();
/// let after = contact::impact(&Ball {}, 0.0, &q, &falling)?;
/// // It leaves with 0.8 of its speed, and rolls: the impulse of friction is less than 0.3 · 0.5 · 3.6 N·s.
/// assert!((after.v[2] - 1.6).abs() < 1e-12);
/// assert!((after.v[0] - 5.0 / 7.0).abs() < 1e-12 && (after.v[4] * 0.1 - after.v[0]).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// [`ConstraintError::Contact`] if no impulses satisfy the contact conditions, because constraints or
/// prescribed motions move surfaces towards each other; [`ConstraintError::Coefficient`] if a coefficient of
/// friction or restitution that depends on parameters has an invalid value.
pub fn impact<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
) -> Result<Solved<T, NV, NR>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    solve(mechanism, t, q, v, &mechanism.contact_rates(t, q, v))
}

/// Returns the velocity at the end of a short time, with the impulses of all contacts in this time, N·s, or
/// N·m·s for stops of revolute joints. The impulses divided by the time are the mean contact forces.
///
/// `free` is the velocity at the end without contacts (m/s and rad/s), `q` is the configuration at the end,
/// and `before` are the [`contact_rates`](Contacts::contact_rates) at the beginning, with which restitution
/// is computed. Contacts with a gap of zero or less are closed.
///
/// # Errors
///
/// The errors of [`impact`].
pub fn solve<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
    free: &SVector<T, NV>,
    before: &SVector<T, NR>,
) -> Result<Solved<T, NV, NR>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    match closed_contacts(mechanism, t, (q, free), None)? {
        Some(closed) => {
            let selection = ContactSelection::<NK, NR>::select_closed_contacts(
                ContactLayout::of_mechanism(mechanism),
                &closed,
            );
            let mut acted = ContactsWithImpulses::contacts_without_impulses(selection, false);
            let velocities = ContactVelocities::unevaluated_in_configuration(mechanism, t, q);
            let contact_velocities_before_impulses = || selection.selected_contact_rates(before);
            compute_closed_contact_impulses(
                mechanism,
                (t, &velocities),
                (q, free),
                &closed,
                (contact_velocities_before_impulses, None),
                &mut acted,
            )
        }
        None => Ok(Solved { v: *free, impulses: SVector::zeros() }),
    }
}

/// Returns the error for a contact whose conditions no impulses satisfy.
fn unsolved_contact_error<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    contact: usize,
) -> ConstraintError
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    ConstraintError::Contact { constraint: M::CONTACTS.get(contact).copied().unwrap_or_default() }
}
