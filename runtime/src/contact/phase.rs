//! Contact modes between two events, the motion in these modes, and the distance to the next event.

use super::coefficients::checked_contact_laws;
use super::held::accelerations_and_responses;
use super::layout::ContactLayout;
use super::problem::{ContactProblem, entry_or_zero, set_entry};
use super::total::TotalArray;
use super::{Contacts, Law, Touch, impact, touching_distance};
use crate::constraint::ConstraintError;
use crate::forward::{constants, each_function};
use crate::integrate::{Features, Hooks};
use crate::private::{constant, epsilon};
use crate::{Mechanism, Real};
use core::ops::Range;
use nalgebra::SVector;

/// Contact modes of a mechanism with `NK` contacts and `NR` contact velocities, constant until the next
/// event.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactPhase<T, const NK: usize, const NR: usize> {
    touches: [Touch; NK],
    /// Unit slip direction of each sliding contact, stored at that contact's rows.
    along: SVector<T, NR>,
    /// Whether the contact forces are not unique, because the accelerations do not determine them.
    redundant: bool,
    /// Flight of each separated contact that is so close that the sign of its gap cannot show the end of the
    /// flight.
    flights: [Option<SeparatedGapMotion<T>>; NK],
}

/// Motion of a separated contact, with the gap, its velocity and its acceleration at the start.
#[derive(Clone, Copy, Debug)]
struct SeparatedGapMotion<T> {
    gap: T,
    rate: T,
    acceleration: T,
}

impl<T: Real> SeparatedGapMotion<T> {
    /// Returns the time until the gap is zero if the acceleration stays constant.
    fn time_until_touchdown(&self) -> Option<T> {
        let two = constant::<T>(2.0);
        let square = self.rate * self.rate - self.acceleration * self.gap * two;
        let time = if self.acceleration < T::zero() {
            (self.rate + square.sqrt()) / -self.acceleration
        } else {
            self.gap * two / (square.sqrt() - self.rate)
        };
        (time.is_finite() && time > T::zero()).then_some(time)
    }

    /// Returns the gap after `s` seconds by the trapezoidal rule with end correction, from velocities and
    /// accelerations at the start and the end.
    fn gap_after(&self, s: T, rate: T, acceleration: T) -> T {
        let mean = (self.rate + rate) * constant(0.5);
        self.gap + s * (mean + s * (self.acceleration - acceleration) * constant(1.0 / 12.0))
    }
}

/// Returns the contact velocity, m/s, below which resting surfaces are considered at rest: the rounding error
/// of the given contact velocities.
fn resting_velocity_threshold<T: Real, const NR: usize>(rates: &SVector<T, NR>) -> T {
    let most = rates.iter().fold(T::one(), |most, rate| most.max(rate.abs()));
    most * epsilon::<T>() * constant(512.0)
}

/// Adds a large acceleration in the slip direction to the contact accelerations `free` of sliding contacts,
/// as if the slip velocity were reached in a very short time. Therefore the solution does not stop their
/// slip.
pub(super) fn sustain_slip<T: Real, const NK: usize, const NR: usize>(
    free: &mut SVector<T, NR>,
    rates: &SVector<T, NR>,
    layout: ContactLayout<NK>,
) {
    let still = resting_velocity_threshold(rates) * constant(2.0);
    let most = free.iter().fold(T::zero(), |most, a| most.max(a.abs()));
    for tangents in (0..NK).map(|k| layout.tangent_rows(k)) {
        let slip = norm_of_range(rates, tangents.clone());
        if slip > still {
            let size = (slip / epsilon::<T>().powf(constant(0.75))).min(most * constant(1e6));
            for i in tangents {
                set_entry(free, i, entry_or_zero(free, i) + entry_or_zero(rates, i) / slip * size);
            }
        }
    }
}

/// Returns the first contact that sticks by friction in the modes `touches`, although the contact velocities
/// `rates` contain slip.
pub(super) fn sticking_contact_with_slip<T: Real, const NK: usize, const NR: usize>(
    rates: &SVector<T, NR>,
    touches: &[Touch; NK],
    laws: &[Law<T>; NK],
    layout: ContactLayout<NK>,
) -> Option<usize> {
    let has_slip = |k: usize| norm_of_range(rates, layout.tangent_rows(k)) > touching_distance();
    let mut sticks =
        touches.iter().zip(laws).map(|(touch, law)| *touch == Touch::Sticks && law.friction > T::zero());
    (0..NK).find(|k| sticks.next() == Some(true) && has_slip(*k))
}

/// Returns the Euclidean norm of a range of entries of a vector.
pub(super) fn norm_of_range<T: Real, const N: usize>(vector: &SVector<T, N>, part: Range<usize>) -> T {
    part.fold(T::zero(), |sum, i| sum + entry_or_zero(vector, i) * entry_or_zero(vector, i)).sqrt()
}

/// Returns the gap, m, up to which surfaces count as resting on each other: rounding and integration errors
/// of one step.
fn resting_gap_threshold<T: Real, const NQ: usize>(q: &SVector<T, NQ>) -> T {
    let size = q.iter().fold(T::one(), |size, q| size.max(q.abs()));
    size * epsilon::<T>().powf(constant(0.75))
}

/// Returns the rounding error of gaps, m.
fn gap_rounding_error<T: Real, const NQ: usize>(q: &SVector<T, NQ>) -> T {
    let size = q.iter().fold(T::one(), |size, q| size.max(q.abs()));
    size * epsilon::<T>() * constant(16.0)
}

/// Returns the velocity after an impact if closed contacts approach each other, otherwise the velocity
/// unchanged.
pub(crate) fn velocity_after_impact<
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
) -> Result<SVector<T, NV>, ConstraintError>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let (gaps, rates) = (mechanism.contact_gaps(t, q), mechanism.contact_rates(t, q, v));
    let (touching, still) = (gap_rounding_error(q), resting_velocity_threshold(&rates));
    let strikes = ContactLayout::of_mechanism(mechanism)
        .gap_contacts()
        .any(|(k, first)| entry_or_zero(&gaps, k) <= touching && entry_or_zero(&rates, first) < -still);
    if strikes { impact(mechanism, t, q, v).map(|solved| solved.v) } else { Ok(*v) }
}

impl<T: Real, const NK: usize, const NR: usize> ContactPhase<T, NK, NR> {
    /// Returns the contact modes in a state under the generalized forces `tau`, and the accelerations. No
    /// contact may have an impact in this state.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Contact`] where no forces fulfil the laws of contacts.
    pub(crate) fn contact_phase_of_state<M, const NQ: usize, const NV: usize, const NU: usize>(
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
    ) -> Result<(Self, SVector<T, NV>), ConstraintError>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let (gaps, rates) = (mechanism.contact_gaps(t, q), mechanism.contact_rates(t, q, v));
        let (still, resting) = (resting_velocity_threshold(&rates), resting_gap_threshold(q));
        let layout = ContactLayout::of_mechanism(mechanism);
        let mut closed = [false; NK];
        for (k, (closed, gap)) in closed.iter_mut().zip(&gaps).enumerate() {
            *closed = *gap <= resting && entry_or_zero(&rates, layout.bounding_contact(k).1).abs() <= still;
        }
        let mut a = mechanism.try_forward_dynamics(t, q, v, tau)?;
        let driven = mechanism.contact_rates(t, q, &SVector::zeros());
        let bias = mechanism.contact_bias(t, q, v);
        let mut free = mechanism.contact_rates(t, q, &a) - driven + bias;
        let open = Self {
            touches: [Touch::Open; NK],
            along: SVector::zeros(),
            redundant: false,
            flights: [None; NK],
        };
        let mut phase = open;
        if closed.contains(&true) {
            sustain_slip(&mut free, &rates, layout);
            if free.iter().any(|rate| !rate.is_finite()) {
                return Err(ConstraintError::NotFinite);
            }
            let responses = mechanism.contact_responses(t, q, &closed);
            let laws = checked_contact_laws(mechanism)?;
            let mut problem = ContactProblem::new(layout, &laws, &closed, &free);
            problem.set_static_friction(&laws, |k| {
                norm_of_range(&rates, layout.tangent_rows(k)) <= still * constant(2.0)
            });
            problem.copy_closed_contact_weights(&responses.rates);
            let forces = problem.solve_with_static_friction().map_err(|k| ConstraintError::Contact {
                constraint: M::CONTACTS.get(k).copied().unwrap_or_default(),
            })?;
            let (touches, along) = problem.contact_modes(&forces);
            if let Some(k) = sticking_contact_with_slip(&rates, &touches, &mechanism.contact_laws(), layout) {
                // No forces let it slip on (Painlevé's paradox): it stops at once.
                return Err(ConstraintError::Contact {
                    constraint: M::CONTACTS.get(k).copied().unwrap_or_default(),
                });
            }
            phase =
                Self { touches, along, redundant: problem.has_nonunique_contact_forces(&touches), ..open };
            a += responses.velocities * problem.impulses_at_mechanism_rows(&forces);
        }
        let bent = mechanism.contact_rates(t, q, &a) - driven + bias;
        let touching = gap_rounding_error(q);
        let states = gaps.iter().zip(closed).zip(phase.flights.iter_mut()).enumerate();
        for (k, ((gap, closed), flight)) in states.filter(|(k, _)| layout.has_gap_function(*k)) {
            let (_, first) = layout.bounding_contact(k);
            let (gap, rate, acceleration) = (*gap, entry_or_zero(&rates, first), entry_or_zero(&bent, first));
            if closed || gap > touching_distance() {
                continue;
            }
            let gap = if gap > touching { gap } else { T::zero() };
            let rise =
                if rate > T::zero() { -rate * rate / (acceleration * constant(2.0)) } else { T::zero() };
            let falls = rate < T::zero() || acceleration < T::zero();
            if falls && gap + rise <= touching_distance() {
                *flight = Some(SeparatedGapMotion { gap, rate, acceleration });
            }
        }
        Ok((phase, a))
    }

    /// Returns the slip velocities that friction opposes: the actual ones, or the stored slip direction for
    /// contacts that begin to slip or whose slip has reversed within a step.
    fn slip_opposed_by_friction(&self, rates: &SVector<T, NR>, layout: ContactLayout<NK>) -> SVector<T, NR> {
        let mut braked = *rates;
        let slips = self.touches.iter().enumerate().filter(|(_, touch)| **touch == Touch::Slips);
        for tangents in slips.map(|(k, _)| layout.tangent_rows(k)) {
            if self.slip_velocity_along_direction(rates, tangents.clone()) <= T::zero() {
                tangents.for_each(|i| set_entry(&mut braked, i, entry_or_zero(&self.along, i)));
            }
        }
        braked
    }

    /// Returns the slip velocity of a contact along its stored slip direction.
    fn slip_velocity_along_direction(&self, rates: &SVector<T, NR>, tangents: Range<usize>) -> T {
        tangents.fold(T::zero(), |sum, i| sum + entry_or_zero(&self.along, i) * entry_or_zero(rates, i))
    }

    /// Whether contacts slide and the contact forces are not unique.
    pub(crate) fn has_nonunique_sliding_forces(&self) -> bool {
        self.redundant && self.touches.contains(&Touch::Slips)
    }

    /// Returns the time until the first of the low flights ends, if accelerations stay constant.
    pub(crate) fn time_to_first_touchdown(&self) -> Option<T> {
        let landings = self.flights.iter().flatten().filter_map(SeparatedGapMotion::time_until_touchdown);
        landings.fold(None, |first, time| Some(first.map_or(time, |first: T| first.min(time))))
    }
}

/// Mechanism that moves in the contact modes of a phase.
pub(crate) struct PhasedMechanism<'m, M, T, const NK: usize, const NR: usize> {
    /// The mechanism.
    pub(crate) mechanism: &'m M,
    /// Contact modes between two events.
    pub(crate) phase: ContactPhase<T, NK, NR>,
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>
    Mechanism<NQ, NV, NU> for PhasedMechanism<'_, M, T, NK, NR>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    type Scalar = T;
    constants!(names, M);

    each_function!(space, plain Mechanism, self => self.mechanism);
    each_function!(dynamics, pass Mechanism, self => self.mechanism);

    fn forward_dynamics(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.try_forward_dynamics(t, q, v, tau).unwrap_or_else(|_| SVector::repeat(constant(f64::NAN)))
    }

    fn try_forward_dynamics(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
    ) -> Result<SVector<T, NV>, ConstraintError> {
        let Self { mechanism, phase } = self;
        let layout = ContactLayout::of_mechanism(*mechanism);
        let along = phase.slip_opposed_by_friction(&mechanism.contact_rates(t, q, v), layout);
        accelerations_and_responses(*mechanism, t, (q, v), tau, &phase.touches, (&along, [T::zero(); 2]))
            .map(|(held, _)| held.a)
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>
    Hooks<T, NQ, NV, NU> for PhasedMechanism<'_, M, T, NK, NR>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    const CONSTRAINED: bool = M::CONSTRAINED;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = M::FEEDBACK;
    const CONTACTING: bool = false;
    const LOCATABLE: bool = false;
    const FIRST_ORDER: usize = M::FIRST_ORDER;
    const SPEEDS: bool = M::SPEEDS;

    #[inline(always)]
    fn features(&self) -> Features {
        self.mechanism.features()
    }

    each_function!(methods, [T] pass Hooks, self => self.mechanism);

    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: super::Visitor<T, NQ, NV, NU>,
    {
        None
    }
}

/// State after `s` seconds in a phase.
pub(crate) struct PhaseState<'a, T, const NQ: usize, const NV: usize> {
    pub(crate) s: T,
    pub(crate) t: T,
    pub(crate) q: &'a SVector<T, NQ>,
    pub(crate) v: &'a SVector<T, NV>,
    pub(crate) tau: &'a SVector<T, NV>,
}

impl<T: Real, const NQ: usize, const NV: usize> PhaseState<'_, T, NQ, NV> {
    /// Returns the margin to the first event of the phase: the minimum of gaps of separated contacts, normal
    /// forces, remaining friction of sticking contacts, and slip velocities of sliding contacts. It is
    /// negative past an event.
    pub(crate) fn smallest_event_function_value<M, const NU: usize, const NK: usize, const NR: usize>(
        &self,
        phased: &PhasedMechanism<'_, M, T, NK, NR>,
    ) -> T
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let Self { s, t, q, v, tau } = *self;
        let PhasedMechanism { mechanism, phase } = phased;
        let rates = mechanism.contact_rates(t, q, v);
        let layout = ContactLayout::of_mechanism(*mechanism);
        let along = phase.slip_opposed_by_friction(&rates, layout);
        let past = -T::one();
        let along = (&along, [T::zero(); 2]);
        let Ok((held, _)) = accelerations_and_responses(*mechanism, t, (q, v), tau, &phase.touches, along)
        else {
            return past;
        };
        let contact_accelerations = || {
            let driven = mechanism.contact_rates(t, q, &SVector::zeros());
            mechanism.contact_rates(t, q, &held.a) - driven + mechanism.contact_bias(t, q, v)
        };
        let bent = if phase.flights.iter().any(Option::is_some) {
            contact_accelerations()
        } else {
            SVector::zeros()
        };
        let (gaps, still) = (mechanism.contact_gaps(t, q), resting_velocity_threshold(&rates));
        let rounding = held.forces.iter().fold(T::zero(), |most, f| most.max(f.abs()));
        let rounding = rounding * epsilon::<T>() * constant(64.0);
        let stiction = mechanism.contact_laws().map(|Law { stiction, .. }| stiction);
        let mut moving = constant::<T>(1.0);
        let mut forces = moving;
        let contacts = phase.touches.into_iter().zip(phase.flights).zip(gaps.iter().zip(stiction));
        for (k, ((touch, flight), (gap, stiction))) in contacts.enumerate() {
            let ((_, first), tangents) = (layout.bounding_contact(k), layout.tangent_rows(k));
            let (rate, normal) = (entry_or_zero(&rates, first), entry_or_zero(&held.forces, first));
            let least = match touch {
                // Moments of friction close and open with their contact.
                Touch::Open if !layout.has_gap_function(k) => T::one(),
                Touch::Open => {
                    let gap =
                        flight.map_or(*gap, |flight| flight.gap_after(s, rate, entry_or_zero(&bent, first)));
                    if gap < T::zero() && rate >= -still { T::one() } else { gap }
                }
                Touch::Slips => {
                    self::resting_velocity_threshold(&rates)
                        + phase.slip_velocity_along_direction(&rates, tangents.clone())
                }
                Touch::Sticks => T::one(),
            };
            moving = moving.min(least);
            if touch != Touch::Open {
                forces = forces.min(normal + rounding);
            }
            if touch == Touch::Sticks && !tangents.is_empty() && stiction > T::zero() {
                let size = norm_of_range(&held.forces, tangents);
                forces = forces.min(stiction * normal - size + rounding);
            }
        }
        let numbers = moving.is_finite() && forces.is_finite();
        if !numbers {
            return past;
        }
        if forces < T::zero() && phase.redundant && self.is_force_ambiguous(*mechanism, &held.a) {
            forces = T::one();
        }
        moving.min(forces)
    }

    /// Whether other contact forces that satisfy the contact conditions produce these accelerations.
    fn is_force_ambiguous<M, const NU: usize, const NK: usize, const NR: usize>(
        &self,
        mechanism: &M,
        a: &SVector<T, NV>,
    ) -> bool
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let Ok((_, found)) =
            ContactPhase::contact_phase_of_state(mechanism, self.t, self.q, self.v, self.tau)
        else {
            return false;
        };
        let largest_magnitude = |x: &SVector<T, NV>| x.iter().fold(T::zero(), |most, x| most.max(x.abs()));
        largest_magnitude(&(found - a))
            <= (largest_magnitude(a) + T::one()) * epsilon::<T>().powf(constant(0.625))
    }
}

/// Returns the configuration and velocity projected onto the closed contacts of a phase.
pub(crate) fn state_projected_onto_contacts<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    phased: &PhasedMechanism<'_, M, T, NK, NR>,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
) -> (SVector<T, NQ>, SVector<T, NV>)
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let PhasedMechanism { mechanism, phase } = phased;
    let closed = phase.touches.map(|touch| touch != Touch::Open);
    if !closed.contains(&true) {
        return (*q, *v);
    }
    let rates = mechanism.contact_rates(t, q, v);
    let layout = ContactLayout::of_mechanism(*mechanism);
    let stops = resting_velocity_threshold(&rates) * constant(2.0);
    let mut laws = mechanism.contact_laws();
    for (k, (law, touch)) in laws.iter_mut().zip(phase.touches).enumerate() {
        if touch == Touch::Slips
            && phase.slip_velocity_along_direction(&rates, layout.tangent_rows(k)) > stops
        {
            law.friction = T::zero();
        }
    }
    let responses = mechanism.contact_responses(t, q, &closed);
    let gap_correcting_velocity_change = |left: &SVector<T, NR>, laws: &[Law<T>; NK]| -> SVector<T, NV> {
        let mut problem = ContactProblem::new(layout, laws, &closed, left);
        problem.copy_closed_contact_weights(&responses.rates);
        responses.velocities
            * problem.impulses_at_mechanism_rows(
                &problem.impulses_enforcing_contacts(&TotalArray::repeat_entry(true)),
            )
    };
    let (gaps, mut left) = (mechanism.contact_gaps(t, q), SVector::<T, NR>::zeros());
    for (k, first) in layout.gap_contacts() {
        set_entry(&mut left, first, entry_or_zero(&gaps, k));
    }
    let push = gap_correcting_velocity_change(&left, &laws.map(|law| Law { friction: T::zero(), ..law }));
    let (q, v) = (mechanism.integrate(q, &push), mechanism.carry(t, q, &push, v));
    let v = v + gap_correcting_velocity_change(&mechanism.contact_rates(t, &q, &v), &laws);
    (q, v)
}
