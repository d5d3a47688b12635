//! Effects of contacts in a step: impulses, and displacements that remove penetrations.

use super::layout::ContactLayout;
use super::observer::{GapClosingDisplacement, ImpulseObserver, NoImpulseObserver};
use super::problem::{ContactProblem, ImpulseEquations, entry_or_zero, set_entry};
use super::selection::{ContactSelection, FEW};
use super::total::TotalArray;
use super::velocities::ContactVelocities;
use super::{
    Assumed, Contacts, ContactsWithImpulses, Impulses, Law, Rows, Touched, compute_closed_contact_impulses,
    touching_distance,
};
use crate::Real;
use crate::constraint::ConstraintError;
use crate::private::{constant, epsilon, positive_part};
use core::cell::Cell;
use nalgebra::SVector;

/// Maximum number of scalings of a displacement by the energy that it may add.
const PARTS: usize = 4;

/// Sizes of the arrays for closed contacts of mechanisms that have more contact velocities.
pub(super) const SMALL: usize = FEW;
const MEDIUM: usize = 72;
pub(super) const LARGE: usize = 144;
const LARGEST: usize = 576;

/// Start of a step.
pub(super) struct StepStart<'a, T, const NQ: usize, const NV: usize> {
    /// Configuration and velocity at the start of the step.
    start: (&'a SVector<T, NQ>, &'a SVector<T, NV>),
    /// Velocity of the start in the axes at the end of the step
    /// ([`transport_velocity_to_end`](Self::transport_velocity_to_end)), evaluated on demand.
    carried: Cell<Option<SVector<T, NV>>>,
    /// Duration of the step.
    h: T,
    /// Displacement by the contact forces that were assumed.
    held: SVector<T, NV>,
}

impl<'a, T: Real, const NQ: usize, const NV: usize> StepStart<'a, T, NQ, NV> {
    /// Returns the start of a step of `h` seconds from a state, with the displacement `held` by the assumed
    /// contact forces.
    pub(super) fn start_from_state(
        start: (&'a SVector<T, NQ>, &'a SVector<T, NV>),
        h: T,
        held: SVector<T, NV>,
    ) -> Self {
        Self { start, carried: Cell::new(None), h, held }
    }

    /// Returns the initial velocity in the configuration `q` at the end of the step. Impulses act there;
    /// restitution and the work of impulses are about the same directions as they are.
    pub(super) fn transport_velocity_to_end<M, const NU: usize, const NK: usize, const NR: usize>(
        &self,
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
    ) -> SVector<T, NV>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        if let Some(carried) = self.carried.get() {
            return carried;
        }
        let (start, v) = self.start;
        let carried = match self.h == T::zero() {
            true => *v,
            false => mechanism.carry(t, start, &mechanism.difference(start, q), v),
        };
        self.carried.set(Some(carried));
        carried
    }
}

/// Returns the contacts that are closed after a motion to the configuration `q` and velocity `free`; `None`
/// if there are none. Closed are contacts with a gap of zero, with or without the assumed contact forces, and
/// contacts that were closed at the start and did not separate.
#[allow(clippy::type_complexity, reason = "sizes of arrays")]
pub(super) fn closed_contacts<
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
    (q, free): (&SVector<T, NQ>, &SVector<T, NV>),
    came: Option<(&StepStart<'_, T, NQ, NV>, &ContactVelocities<'_, M, T, NQ, NV, NR>)>,
) -> Result<Option<[bool; NK]>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let gaps = mechanism.contact_gaps(t, q);
    if gaps.iter().any(|gap| !gap.is_finite()) || free.iter().any(|x| !x.is_finite()) {
        return Err(ConstraintError::NotFinite);
    }
    let mut closed: [bool; NK] = gaps.data.0[0].map(|gap| gap <= touching_distance());
    let has_open_contact = |closed: &[bool; NK]| closed.iter().any(|is_closed| !is_closed);
    if let Some((came, velocities)) = came.filter(|(came, _)| came.h > T::zero() && has_open_contact(&closed))
    {
        let (h, held, still) = (&came.h, &came.held, SVector::<T, NV>::zeros());
        let starts = mechanism.contact_gaps(t - *h, came.start.0);
        let is_held = *held != still;
        let touched =
            closed.iter().zip(&starts).any(|(is_closed, start)| !is_closed && *start <= touching_distance());
        if !is_held && !touched {
            return Ok(closed.contains(&true).then_some(closed));
        }
        let layout = ContactLayout::of_mechanism(mechanism);
        let carried = came.transport_velocity_to_end(mechanism, t, q);
        let (rate, after) =
            (velocities.rate_function_of_velocity(&carried), velocities.rate_function_of_velocity(free));
        let displacement = velocities.rate_change_function(held);
        for (k, (closed, (gap, start))) in closed.iter_mut().zip(gaps.iter().zip(&starts)).enumerate() {
            if *closed || (!is_held && *start > touching_distance()) {
                continue;
            }
            let (by, place) = layout.bounding_contact(k);
            let apart = if is_held { displacement(by, place) } else { T::zero() };
            *closed = *gap - apart <= touching_distance();
            if *closed || *start > touching_distance() {
                continue;
            }
            let parts = positive_part(rate(by, place) * *h);
            // Where faces and edges take turns a contact may be at another place than before.
            let Rows { first, count } = layout.rows(by);
            let ways = (first..first + count)
                .fold(apart.abs(), |sum, i| sum + (rate(by, i).abs() + after(by, i).abs()) * *h);
            *closed = *start + parts <= touching_distance() && *gap <= touching_distance::<T>() + ways;
        }
    }
    Ok(closed.contains(&true).then_some(closed))
}

/// Applies the contact impulses of a step of `h` seconds, for methods of integration. The motion without
/// contact impulses from `start` has led to a configuration and a velocity, to which contact forces that were
/// assumed have added `given`. With `h = 0` no body moves.
///
/// # Errors
///
/// The errors of [`impact`].
#[doc(hidden)]
pub fn step<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    (start, v): (&SVector<T, NQ>, &SVector<T, NV>),
    (q, free): (&SVector<T, NQ>, &SVector<T, NV>),
    given: Assumed<'_, T, NV>,
    h: T,
) -> Result<Touched<T, NQ, NV>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    observed_step(mechanism, t, (start, v), (q, free), given, h, &mut NoImpulseObserver)
}

/// Computes [`step`], and passes the impulses of the contacts to an observer.
///
/// # Errors
///
/// The errors of [`impact`](super::impact).
pub(super) fn observed_step<
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
    (start, v): (&SVector<T, NQ>, &SVector<T, NV>),
    (q, free): (&SVector<T, NQ>, &SVector<T, NV>),
    (given, impulses): Assumed<'_, T, NV>,
    h: T,
    observer: &mut impl ImpulseObserver<T, NV>,
) -> Result<Touched<T, NQ, NV>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let half = h * constant(0.5);
    let came = StepStart::start_from_state((start, v), h, given * half);
    // What impulses do to the velocity they do in the mean of the step.
    let state_after_impulses = |after: &SVector<T, NV>, by_contacts: &SVector<T, NV>| {
        let moved = (after - free - given) * half;
        // Smooth forces move it by so little that their axes stay the same.
        Touched {
            q: mechanism.integrate(q, &moved),
            v: mechanism.carry(t, q, &moved, after),
            held: *by_contacts,
            impulses: Impulses::none(),
            violation: T::zero(),
        }
    };
    let still = SVector::<T, NV>::zeros();
    let velocities = ContactVelocities::unevaluated_in_configuration(mechanism, t, q);
    let Some(closed) = closed_contacts(mechanism, t, (q, free), Some((&came, &velocities)))? else {
        let is_led = h != T::zero() && *given != still;
        return Ok(if is_led {
            state_after_impulses(free, &still)
        } else {
            Touched::state_without_contacts(*q, *free)
        });
    };
    let (rows, _) = mechanism.contact_tables();
    let rows = rows.iter().zip(&closed).filter(|(_, is_closed)| **is_closed);
    let rows = rows.fold(0, |sum, (rows, _)| sum + rows.count);
    let run = (&came, (start, v), (q, free), (given, impulses));
    let at_end = (t, &velocities);
    // Matrices of few closed contacts are small, however many contacts a mechanism has. The arrays have few
    // different sizes, so that mechanisms with many contacts share most of the compiled code.
    macro_rules! act_in_arrays {
        ($contacts:ident, $rows:ident) => {
            apply_contact_impulses::<M, T, NQ, NV, NU, NK, NR, $contacts, $rows>(
                mechanism,
                at_end,
                run,
                &closed,
                state_after_impulses,
                observer,
            )
        };
    }
    if const { NR <= SMALL } {
        act_in_arrays!(NK, NR)
    } else if rows <= SMALL {
        act_in_arrays!(SMALL, SMALL)
    } else if const { NR <= MEDIUM } || rows <= MEDIUM {
        act_in_arrays!(MEDIUM, MEDIUM)
    } else if const { NR <= LARGE } || rows <= LARGE {
        act_in_arrays!(LARGE, LARGE)
    } else if const { NR > LARGEST } && rows <= LARGEST {
        act_in_arrays!(LARGEST, LARGEST)
    } else {
        act_in_arrays!(NK, NR)
    }
}

/// Start of a step, its end without contacts, and the velocity change by the assumed contact forces.
type StepWithoutContacts<'a, T, const NQ: usize, const NV: usize> = (
    &'a StepStart<'a, T, NQ, NV>,
    (&'a SVector<T, NQ>, &'a SVector<T, NV>),
    (&'a SVector<T, NQ>, &'a SVector<T, NV>),
    Assumed<'a, T, NV>,
);

/// Applies the impulses of closed contacts at the end of a step, in arrays for up to `CK` contacts with `CR`
/// contact velocities.
#[inline(never)]
fn apply_contact_impulses<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    const CK: usize,
    const CR: usize,
>(
    mechanism: &M,
    (t, velocities): (T, &ContactVelocities<'_, M, T, NQ, NV, NR>),
    (came, (start, v), (q, free), (given, recorded)): StepWithoutContacts<'_, T, NQ, NV>,
    closed: &[bool; NK],
    led: impl Fn(&SVector<T, NV>, &SVector<T, NV>) -> Touched<T, NQ, NV>,
    observer: &mut impl ImpulseObserver<T, NV>,
) -> Result<Touched<T, NQ, NV>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let (h, still) = (came.h, SVector::<T, NV>::zeros());
    let selection =
        ContactSelection::<CK, CR>::select_closed_contacts(ContactLayout::of_mechanism(mechanism), closed);
    let mut acted = ContactsWithImpulses::contacts_without_impulses(selection, true);
    let contact_velocities_at_step_end = || {
        let carried = came.transport_velocity_to_end(mechanism, t, q);
        velocities.selected_rates(&selection, &carried)
    };
    let moves_farther_than = |far: T| v.iter().any(|v| v.abs() * h > far);
    let is_moving = moves_farther_than(touching_distance::<T>() * constant(10.0));
    let assumed = Some(((given, recorded), is_moving));
    let after = compute_closed_contact_impulses(
        mechanism,
        (t, velocities),
        (q, free),
        closed,
        (contact_velocities_at_step_end, assumed),
        &mut acted,
    )?
    .v;
    if h == T::zero() {
        observer.observe(&acted, None);
        let (held, violation) = (after - free, acted.problem.largest_violation());
        let impulses = Impulses::impulses_of_selected_contacts(
            &selection,
            &acted.problem.impulses_at_mechanism_rows(&acted.impulses),
        );
        return Ok(Touched { q: *q, v: after, held, impulses, violation });
    }
    if !acted.is_loaded() {
        return Ok(led(&after, &still));
    }
    let corrected = acted.free;
    let mut touched = led(&after, &(after - corrected));
    // The energy without what contacts have done: they have worked along the mean of the velocities.
    let allowed_energy = || {
        let mean = (came.transport_velocity_to_end(mechanism, t, q) + free + given) * constant::<T>(0.5);
        let work = mechanism.generalized_momentum(t, q, &mean).dot(given);
        total_energy(mechanism, t, &Touched::state_without_contacts(*q, free + given)) - work
    };
    if acted.problem.demands_restitution() {
        let state_with_contact_velocity =
            |by_contacts: &SVector<T, NV>| led(&(corrected + by_contacts), by_contacts);
        let laws = selection.selected_laws(&mechanism.contact_laws());
        if let Some(less) = state_with_restitution(
            mechanism,
            t,
            (&mut acted, &laws, &contact_velocities_at_step_end()),
            &state_with_contact_velocity,
            (&touched, allowed_energy()),
        ) {
            (touched, acted.impulses) = less;
        }
    }
    let (problem, impulses) = (&acted.problem, &acted.impulses);
    touched.violation = problem.largest_violation();
    touched.impulses =
        Impulses::impulses_of_selected_contacts(&selection, &problem.impulses_at_mechanism_rows(impulses));
    if !is_moving && !moves_farther_than(touching_distance::<T>() * constant(1e-3)) {
        let states = ((start, v), &touched, &after);
        let creep = creep_reversing_impulses(mechanism, (t, velocities), states, h, (problem, &selection));
        if let Some(creep) = creep {
            touched.q = mechanism.integrate(&touched.q, &acted.velocity_change(&creep));
        }
    }
    let gaps = mechanism.contact_gaps(t, &touched.q);
    let largest_contact_velocity = || {
        let velocities = contact_velocities_at_step_end();
        velocities.iter().fold(problem.largest_free_contact_velocity(), |most, rate| most.max(rate.abs()))
    };
    let mut closing =
        gap_closing_displacement(&acted, selection.selected_gaps(&gaps), (h, largest_contact_velocity));
    if let Some(pushes) = &closing.pushes {
        let push = acted.velocity_change(pushes);
        (touched, closing.part) =
            displaced_within_energy(mechanism, t, (&touched, &gaps), &push, allowed_energy);
    }
    observer.observe(&acted, Some(&closing));
    Ok(touched)
}

/// Returns the displacement that closes the gaps of the selected contacts at the end of a step of `h`
/// seconds, whose contact velocities are at most `largest_contact_velocity` in magnitude.
fn gap_closing_displacement<T: Real, const NV: usize, const CK: usize, const CR: usize>(
    acted: &ContactsWithImpulses<T, NV, CK, CR>,
    gaps: SVector<T, CK>,
    (h, largest_contact_velocity): (T, impl FnOnce() -> T),
) -> GapClosingDisplacement<T, CK, CR> {
    let (problem, impulses) = (&acted.problem, &acted.impulses);
    let mut closing =
        GapClosingDisplacement { gaps, reach: touching_distance(), pushes: None, part: T::one() };
    if !problem.are_gaps_closed(&gaps, touching_distance()) {
        closing.reach += largest_contact_velocity() * h;
        closing.pushes = problem.gap_closing_impulses(impulses, &gaps, (touching_distance(), closing.reach));
    }
    closing
}

/// Returns impulses that, applied as displacements, reverse the creep of sticking contacts in a step, if the
/// bodies of the mechanism are at rest. The creep results from constant forces in a step whose loads vary.
/// Returns `None` if nothing has crept.
#[allow(clippy::type_complexity, reason = "states at both ends of the step")]
fn creep_reversing_impulses<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    const CK: usize,
    const CR: usize,
>(
    mechanism: &M,
    (t, velocities): (T, &ContactVelocities<'_, M, T, NQ, NV, NR>),
    ((start, v), touched, after): ((&SVector<T, NQ>, &SVector<T, NV>), &Touched<T, NQ, NV>, &SVector<T, NV>),
    h: T,
    (problem, selection): (&ContactProblem<T, CK, CR>, &ContactSelection<CK, CR>),
) -> Option<SVector<T, CR>>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let half = h * constant(0.5);
    // At rest, the axes of the middle of the step are those of its start.
    let mean = (v + mechanism.carry(t, &touched.q, &(after * -half), after)) * half;
    let translation = mechanism.translation(t, &mean);
    let expected = mechanism.integrate(&mechanism.integrate(start, &translation), &(mean - translation));
    let excess = mechanism.difference(&expected, &touched.q);
    let largest_magnitude = |x: &SVector<T, NV>| x.iter().fold(T::zero(), |most, x| most.max(x.abs()));
    if largest_magnitude(&excess) <= largest_magnitude(&touched.held) * h * epsilon::<T>().sqrt() {
        return None;
    }
    let crept = velocities.selected_rate_changes(selection, &excess);
    let slip = velocities.selected_rates(selection, after);
    let (layout, mut back) = (selection.contact_layout(), SVector::<T, CR>::zeros());
    for tangents in (0..CK).map(|k| layout.tangent_rows(k)) {
        if tangents
            .clone()
            .all(|i| entry_or_zero(&slip, i).abs() <= touching_distance::<T>() * touching_distance())
        {
            tangents.for_each(|i| set_entry(&mut back, i, -entry_or_zero(&crept, i)));
        }
    }
    Some(problem.mechanism_impulses_for_contact_changes(&back))
}

/// Returns a state with the largest fraction of the restitution, common to all contacts, after which the
/// energy is at most `most`, and the impulses that lead there. Returns `None` if the full restitution already
/// satisfies this.
#[allow(clippy::type_complexity, reason = "sizes of arrays")]
fn state_with_restitution<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    const CK: usize,
    const CR: usize,
>(
    mechanism: &M,
    t: T,
    (acted, laws, before): (&mut ContactsWithImpulses<T, NV, CK, CR>, &[Law<T>; CK], &SVector<T, CR>),
    led: &impl Fn(&SVector<T, NV>) -> Touched<T, NQ, NV>,
    (all, most): (&Touched<T, NQ, NV>, T),
) -> Option<(Touched<T, NQ, NV>, TotalArray<T, CR>)>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let most = most + energy_rounding_error(most);
    if total_energy(mechanism, t, all) <= most {
        return None;
    }
    let (mut found, mut least, mut step) = (None, T::zero(), T::one());
    let (mut equations, mut violation) = (ImpulseEquations::new(), acted.problem.largest_violation());
    let mut start = Some(acted.problem.impulses_plus_base(&acted.impulses));
    for round in 0..=acted.problem.max_restitution_bisections() {
        if found.is_some() && !acted.problem.may_refine_restitution() {
            break;
        }
        // None of it, then a bit of the part each.
        let part = if round == 0 { T::zero() } else { least + step };
        acted.problem.set_restitution_demands(laws, before, part);
        if let Ok(impulses) = acted.problem.solve_impulses_from_start(start.as_ref(), &mut equations) {
            start = Some(acted.problem.impulses_plus_base(&impulses));
            let touched = led(&acted.velocity_change(&acted.problem.impulses_at_mechanism_rows(&impulses)));
            if round == 0 || total_energy(mechanism, t, &touched) <= most {
                (found, least) = (Some((touched, impulses)), part);
                violation = acted.problem.largest_violation();
            }
        }
        step *= constant(0.5);
    }
    acted.problem.set_restitution_demands(laws, before, least);
    acted.problem.set_violation(violation);
    found
}

/// Returns the rounding error of an energy.
fn energy_rounding_error<T: Real>(energy: T) -> T {
    energy.abs() * epsilon() * constant(8.0)
}

fn total_energy<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    t: T,
    Touched { q, v, .. }: &Touched<T, NQ, NV>,
) -> T
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    mechanism.kinetic_energy(t, q, v) + mechanism.potential_energy(t, q)
}

/// Returns the state after a displacement, and the fraction of the displacement that was applied. The energy
/// after it is at most `most`, which is evaluated only if the energy grows, or the energy before it. If
/// surfaces overlap before, with the gaps `gaps`, none overlap more deeply afterwards than the deepest did,
/// including those of contacts that were open.
fn displaced_within_energy<
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
    (from, gaps): (&Touched<T, NQ, NV>, &SVector<T, NK>),
    push: &SVector<T, NV>,
    most: impl Fn() -> T,
) -> (Touched<T, NQ, NV>, T)
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let before = total_energy(mechanism, t, from);
    let (mut part, mut allowed) = (T::one(), None);
    let deepest = gaps.iter().fold(T::zero(), |deepest, gap| deepest.min(*gap));
    for _ in 0..PARTS {
        let push = push * part;
        let to = Touched {
            q: mechanism.integrate(&from.q, &push),
            v: mechanism.carry(t, &from.q, &push, &from.v),
            ..*from
        };
        // Without overlaps there is little to be pushed.
        if deepest < -touching_distance::<T>()
            && mechanism.contact_gaps(t, &to.q).iter().any(|gap| *gap < deepest - touching_distance::<T>())
        {
            part *= constant(0.5);
            continue;
        }
        let after = total_energy(mechanism, t, &to);
        if after <= before + energy_rounding_error(before) {
            return (to, part);
        }
        let most = *allowed.get_or_insert_with(&most);
        if after <= most + energy_rounding_error(before) {
            return (to, part);
        }
        if most <= before {
            break;
        }
        // The energy is about linear.
        part *= (most - before) / (after - before) * constant(0.98);
    }
    (*from, T::zero())
}
