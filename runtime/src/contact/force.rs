//! Contact forces in a state, and mean contact forces over a time.

use super::layout::ContactLayout;
use super::problem::{ContactProblem, entry_or_zero};
use super::selection::ContactSelection;
use super::solution::{ContactsWithImpulses, compute_closed_contact_impulses};
use super::stepping::{StepStart, closed_contacts};
use super::velocities::ContactVelocities;
use super::{
    Contacts, Impulses, Touch, coefficients::checked_contact_laws, light, phase, touching_distance,
    unsolved_contact_error,
};
use crate::Real;
use crate::constraint::ConstraintError;
use crate::integrate::{
    ContinuousInputs, Dynamics, Error, State, System, acceleration_from_closed_contacts, check_positive,
    project_end_of_step, rk4_step_with_contacts,
};
use crate::private::{constant, epsilon, positive_part, to_f64};
use nalgebra::SVector;

/// Returns the mean contact forces over `h` seconds under constant inputs `u`, N, or N·m for stops of
/// revolute joints: for each contact the normal force, positive in compression, then the tangential forces.
/// If `h` is the step of a simulation by [`TimeStepping`](crate::integrate::TimeStepping), these are the
/// forces of that simulation. An impact contributes its impulse divided by `h`.
///
/// # Errors
///
/// [`Error::InvalidStep`] for a time that is zero, negative or not finite; [`Error::Constraint`] with the
/// errors of [`impact`](super::impact).
pub fn forces<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
    h: T,
) -> Result<SVector<T, NR>, Error>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    check_positive("the time", h)?;
    let add_time_to_error = |reason| Error::Constraint { t: to_f64(t), reason };
    let held = ContinuousInputs(|_: T, _: &SVector<T, NQ>, _: &SVector<T, NV>| *u);
    let mut system = System::new(mechanism, held);
    let start = State { t, q: *q, v: *v };
    let at_start = system.acceleration(t, q, v);
    let (rate, impulses) =
        acceleration_from_closed_contacts(&mut system, &start, &at_start, &Impulses::none(), h)
            .map_err(add_time_to_error)?;
    let (free, given) = rk4_step_with_contacts(&mut system, &start, (&at_start, &rate), h, t + h);
    let free = project_end_of_step(&system, free, t)?;
    let came = StepStart::start_from_state((q, v), h, given * (h * constant(0.5)));
    let end = free.v - given;
    let velocities = ContactVelocities::unevaluated_in_configuration(mechanism, t + h, &free.q);
    let closed = closed_contacts(mechanism, t + h, (&free.q, &end), Some((&came, &velocities)))
        .map_err(add_time_to_error)?;
    let Some(closed) = closed else { return Ok(SVector::zeros()) };
    let selection =
        ContactSelection::<NK, NR>::select_closed_contacts(ContactLayout::of_mechanism(mechanism), &closed);
    let mut acted = ContactsWithImpulses::contacts_without_impulses(selection, true);
    let carried = came.transport_velocity_to_end(mechanism, t + h, &free.q);
    let contact_velocities_before_impulses = || velocities.selected_rates(&selection, &carried);
    let solved = compute_closed_contact_impulses(
        mechanism,
        (t + h, &velocities),
        (&free.q, &end),
        &closed,
        (contact_velocities_before_impulses, Some(((&given, &impulses), true))),
        &mut acted,
    );
    Ok(solved.map_err(add_time_to_error)?.impulses / h)
}

/// Returns the contact forces in a state under inputs `u`, N, or N·m for stops of revolute joints: for each
/// contact the normal force, positive in compression, then the tangential forces. Surfaces that slip have
/// kinetic friction against the slip. Surfaces that do not slip have the friction that keeps them at rest, or
/// the friction at the beginning of the slip. Surfaces that approach each other are treated as if at rest,
/// because an impact has an impulse ([`impact`](super::impact)) and no finite force.
///
/// Outputs read these forces as `contact_force(name)`. They are mean forces over a short time: friction that
/// stops the slip within `1.5e-8` s (`3.5e-4` s with `f32`) acts as in a sticking contact.
///
/// # Errors
///
/// The errors of [`impact`](super::impact), and those of the accelerations of a mechanism with constraints;
/// [`ConstraintError::Contact`] for a contact that slips where no finite forces satisfy the contact
/// conditions (Painlevé's paradox).
pub fn acting<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
) -> Result<SVector<T, NR>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let gaps = mechanism.contact_gaps(t, q);
    let closed: [bool; NK] = gaps.data.0[0].map(|gap| gap <= touching_distance());
    if closed.iter().all(|is_closed| !is_closed) {
        return Ok(SVector::zeros());
    }
    let tau = mechanism.generalized_forces(t, q, v, u);
    let a = mechanism.try_forward_dynamics(t, q, v, &tau)?;
    let moved = mechanism.contact_rates(t, q, &a) - mechanism.contact_rates(t, q, &SVector::zeros());
    let h = epsilon::<T>().sqrt();
    let mut free = mechanism.contact_rates(t, q, v);
    let layout = ContactLayout::of_mechanism(mechanism);
    for (_, first) in layout.gap_contacts() {
        if let Some(rate) = free.get_mut(first) {
            *rate = positive_part(*rate);
        }
    }
    free += (moved + mechanism.contact_bias(t, q, v)) * h;
    if free.iter().any(|rate| !rate.is_finite()) {
        return Err(ConstraintError::NotFinite);
    }
    let laws = checked_contact_laws(mechanism)?;
    let responses = mechanism.contact_responses(t, q, &closed);
    let slip = mechanism.contact_rates(t, q, v);
    let solve_contacts = |free: &SVector<T, NR>| {
        let mut problem = ContactProblem::new(layout, &laws, &closed, free);
        problem.set_static_friction(&laws, |k| {
            phase::norm_of_range(&slip, layout.tangent_rows(k)) <= touching_distance()
        });
        problem.copy_closed_contact_weights(&responses.rates);
        let found = problem
            .solve_with_static_friction()
            .map_err(unsolved_contact_error::<M, T, NQ, NV, NU, NK, NR>)?;
        Ok((problem.impulses_at_mechanism_rows(&found), problem.contact_modes(&found).0))
    };
    // In this short time the contact velocities change by the accelerations of sticking contacts, if the
    // normal forces press and friction can hold the contacts.
    let sticking = closed.map(|is_closed| if is_closed { Touch::Sticks } else { Touch::Open });
    if phase::sticking_contact_with_slip(&slip, &sticking, &laws, layout).is_none()
        && let Some((_, impulses)) =
            light::velocity_change_for_sticking(mechanism, t, q, (&sticking, &laws), &-free)
    {
        let presses = (0..NK).filter(|k| closed.get(*k) == Some(&true)).all(|k| {
            let (_, first) = layout.bounding_contact(k);
            let largest = laws.get(k).map_or(T::zero(), |law| law.stiction) * entry_or_zero(&impulses, first);
            entry_or_zero(&impulses, first) >= T::zero()
                && phase::norm_of_range(&impulses, layout.tangent_rows(k)) <= largest
        });
        if presses {
            return Ok(impulses / h);
        }
    }
    let (impulses, touches) = solve_contacts(&free)?;
    let forces = impulses / h;
    if phase::sticking_contact_with_slip(&slip, &touches, &laws, layout).is_none() {
        return Ok(forces);
    }
    // Friction stops slip within this short time: it may be strong, or there is no finite force.
    let mut accelerations = mechanism.contact_bias(t, q, v) + moved;
    phase::sustain_slip(&mut accelerations, &slip, layout);
    let (lasting, touches) = solve_contacts(&accelerations)?;
    match phase::sticking_contact_with_slip(&slip, &touches, &laws, layout) {
        Some(contact) => Err(unsolved_contact_error::<M, T, NQ, NV, NU, NK, NR>(contact)),
        None if forces.amax() <= lasting.amax() * constant(2.0) => Ok(forces),
        None => Ok(lasting),
    }
}
