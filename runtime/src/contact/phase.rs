//! What contacts do between events: which of them hold, how the mechanism moves meanwhile, and how far the
//! next event is.

use super::held::held;
use super::lawful::lawful;
use super::layout::Layout;
use super::problem::{Problem, entry, put};
use super::total::Total;
use super::{Contacts, Law, Touch, impact, touching_distance};
use crate::constraint::ConstraintError;
use crate::forward::{constants, each_function};
use crate::integrate::{Features, Hooks};
use crate::private::{constant, epsilon};
use crate::{Mechanism, Real};
use core::ops::Range;
use nalgebra::SVector;

/// Of a mechanism with `NK` contacts and `NR` rates, what each does until the next event.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Phase<T, const NK: usize, const NR: usize> {
    touches: [Touch; NK],
    /// Of contacts that slip the way, as a unit vector at the places of their rates.
    along: SVector<T, NR>,
    /// The motion cannot tell the forces of contacts apart, so that those that hold are not the only ones.
    redundant: bool,
    /// Of contacts that are open the flight, where it is so low that gaps cannot show its end.
    flights: [Option<Flight<T>>; NK],
}

/// A flight which begins with a gap `gap`, its rate and the rate of that.
#[derive(Clone, Copy, Debug)]
struct Flight<T> {
    gap: T,
    rate: T,
    acceleration: T,
}

impl<T: Real> Flight<T> {
    /// When it ends, if it goes on as it has begun.
    fn duration(&self) -> Option<T> {
        let two = constant::<T>(2.0);
        let square = self.rate * self.rate - self.acceleration * self.gap * two;
        let time = if self.acceleration < T::zero() {
            (self.rate + square.sqrt()) / -self.acceleration
        } else {
            self.gap * two / (square.sqrt() - self.rate)
        };
        (time.is_finite() && time > T::zero()).then_some(time)
    }

    /// The gap after `s` seconds, by its rates at both ends and theirs.
    fn gap(&self, s: T, rate: T, acceleration: T) -> T {
        let mean = (self.rate + rate) * constant(0.5);
        self.gap + s * (mean + s * (self.acceleration - acceleration) * constant(1.0 / 12.0))
    }
}

/// Rates that rounding leaves of none, m/s: those of surfaces that rest on each other.
fn still<T: Real, const NR: usize>(rates: &SVector<T, NR>) -> T {
    let most = rates.iter().fold(T::one(), |most, rate| most.max(rate.abs()));
    most * epsilon::<T>() * constant(512.0)
}

/// Adds the slip of contacts, divided by a time so short that friction does not stop it, to their
/// accelerations `free`.
pub(super) fn sustain_slip<T: Real, const NK: usize, const NR: usize>(
    free: &mut SVector<T, NR>,
    rates: &SVector<T, NR>,
    layout: Layout<NK>,
) {
    let still = still(rates) * constant(2.0);
    let most = free.iter().fold(T::zero(), |most, a| most.max(a.abs()));
    for tangents in (0..NK).map(|k| layout.tangents(k)) {
        let slip = length(rates, tangents.clone());
        if slip > still {
            let size = (slip / epsilon::<T>().powf(constant(0.75))).min(most * constant(1e6));
            for i in tangents {
                put(free, i, entry(free, i) + entry(rates, i) / slip * size);
            }
        }
    }
}

/// Returns the first contact that sticks by friction although its surfaces slip with these rates.
pub(super) fn stopped_contact<T: Real, const NK: usize, const NR: usize>(
    rates: &SVector<T, NR>,
    touches: &[Touch; NK],
    laws: &[Law<T>; NK],
    layout: Layout<NK>,
) -> Option<usize> {
    let slips = |k: usize| length(rates, layout.tangents(k)) > touching_distance();
    let mut sticks =
        touches.iter().zip(laws).map(|(touch, law)| *touch == Touch::Sticks && law.friction > T::zero());
    (0..NK).find(|k| sticks.next() == Some(true) && slips(*k))
}

/// The length of a part of a vector.
pub(super) fn length<T: Real, const N: usize>(vector: &SVector<T, N>, part: Range<usize>) -> T {
    part.fold(T::zero(), |sum, i| sum + entry(vector, i) * entry(vector, i)).sqrt()
}

/// Gaps of surfaces that rest on each other, m: what rounding and a step may leave of none.
fn resting<T: Real, const NQ: usize>(q: &SVector<T, NQ>) -> T {
    let size = q.iter().fold(T::one(), |size, q| size.max(q.abs()));
    size * epsilon::<T>().powf(constant(0.75))
}

/// Gaps that rounding leaves of none, m.
fn touching<T: Real, const NQ: usize>(q: &SVector<T, NQ>) -> T {
    let size = q.iter().fold(T::one(), |size, q| size.max(q.abs()));
    size * epsilon::<T>() * constant(16.0)
}

/// The velocity after what strikes has struck.
pub(crate) fn separated<
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
    let (touching, still) = (touching(q), still(&rates));
    let strikes = Layout::of(mechanism)
        .gaps()
        .any(|(k, first)| entry(&gaps, k) <= touching && entry(&rates, first) < -still);
    if strikes { impact(mechanism, t, q, v).map(|solved| solved.v) } else { Ok(*v) }
}

impl<T: Real, const NK: usize, const NR: usize> Phase<T, NK, NR> {
    /// What contacts do in a state under the generalized forces `tau`, and the accelerations. None strikes.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Contact`] where no forces fulfil the laws of contacts.
    pub(crate) fn of<M, const NQ: usize, const NV: usize, const NU: usize>(
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
        let (still, resting) = (still(&rates), resting(q));
        let layout = Layout::of(mechanism);
        let mut closed = [false; NK];
        for (k, (closed, gap)) in closed.iter_mut().zip(&gaps).enumerate() {
            *closed = *gap <= resting && entry(&rates, layout.pressing(k).1).abs() <= still;
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
            let laws = lawful(mechanism)?;
            let mut problem = Problem::new(layout, &laws, &closed, &free);
            problem.stick(&laws, |k| length(&rates, layout.tangents(k)) <= still * constant(2.0));
            problem.weigh(&responses.rates);
            let forces = problem.solve_sticking().map_err(|k| ConstraintError::Contact {
                constraint: M::CONTACTS.get(k).copied().unwrap_or_default(),
            })?;
            let (touches, along) = problem.touches(&forces);
            if let Some(k) = stopped_contact(&rates, &touches, &mechanism.contact_laws(), layout) {
                // No forces let it slip on (Painlevé's paradox): it stops at once.
                return Err(ConstraintError::Contact {
                    constraint: M::CONTACTS.get(k).copied().unwrap_or_default(),
                });
            }
            phase = Self { touches, along, redundant: problem.is_redundant(&touches), ..open };
            a += responses.velocities * problem.spread(&forces);
        }
        let bent = mechanism.contact_rates(t, q, &a) - driven + bias;
        let touching = touching(q);
        let states = gaps.iter().zip(closed).zip(phase.flights.iter_mut()).enumerate();
        for (k, ((gap, closed), flight)) in states.filter(|(k, _)| layout.is_gap(*k)) {
            let (_, first) = layout.pressing(k);
            let (gap, rate, acceleration) = (*gap, entry(&rates, first), entry(&bent, first));
            if closed || gap > touching_distance() {
                continue;
            }
            let gap = if gap > touching { gap } else { T::zero() };
            let rise =
                if rate > T::zero() { -rate * rate / (acceleration * constant(2.0)) } else { T::zero() };
            let falls = rate < T::zero() || acceleration < T::zero();
            if falls && gap + rise <= touching_distance() {
                *flight = Some(Flight { gap, rate, acceleration });
            }
        }
        Ok((phase, a))
    }

    /// The rates along which slip is braked: those that there are, or where a contact is only about to slip
    /// or has slipped too far the way it slips.
    fn braked(&self, rates: &SVector<T, NR>, layout: Layout<NK>) -> SVector<T, NR> {
        let mut braked = *rates;
        let slips = self.touches.iter().enumerate().filter(|(_, touch)| **touch == Touch::Slips);
        for tangents in slips.map(|(k, _)| layout.tangents(k)) {
            if self.slip(rates, tangents.clone()) <= T::zero() {
                tangents.for_each(|i| put(&mut braked, i, entry(&self.along, i)));
            }
        }
        braked
    }

    /// The slip of a contact the way it slips.
    fn slip(&self, rates: &SVector<T, NR>, tangents: Range<usize>) -> T {
        tangents.fold(T::zero(), |sum, i| sum + entry(&self.along, i) * entry(rates, i))
    }

    /// Whether contacts slip whose forces the motion does not tell apart.
    pub(crate) fn is_shared(&self) -> bool {
        self.redundant && self.touches.contains(&Touch::Slips)
    }

    /// When the first of the low flights ends, if it goes on as it has begun.
    pub(crate) fn landing(&self) -> Option<T> {
        let landings = self.flights.iter().flatten().filter_map(Flight::duration);
        landings.fold(None, |first, time| Some(first.map_or(time, |first: T| first.min(time))))
    }
}

/// A mechanism that moves as its contacts do in a phase.
pub(crate) struct Phased<'m, M, T, const NK: usize, const NR: usize> {
    /// The mechanism.
    pub(crate) mechanism: &'m M,
    /// What its contacts do.
    pub(crate) phase: Phase<T, NK, NR>,
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>
    Mechanism<NQ, NV, NU> for Phased<'_, M, T, NK, NR>
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
        let layout = Layout::of(*mechanism);
        let along = phase.braked(&mechanism.contact_rates(t, q, v), layout);
        held(*mechanism, t, (q, v), tau, &phase.touches, (&along, [T::zero(); 2])).map(|(held, _)| held.a)
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>
    Hooks<T, NQ, NV, NU> for Phased<'_, M, T, NK, NR>
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

/// Where a step of a phase has led, `s` seconds after its start.
pub(crate) struct Watch<'a, T, const NQ: usize, const NV: usize> {
    pub(crate) s: T,
    pub(crate) t: T,
    pub(crate) q: &'a SVector<T, NQ>,
    pub(crate) v: &'a SVector<T, NV>,
    pub(crate) tau: &'a SVector<T, NV>,
}

impl<T: Real, const NQ: usize, const NV: usize> Watch<'_, T, NQ, NV> {
    /// What is left until the first event of the phase: of gaps that close, forces that press, friction that
    /// holds, and slip; negative where one is past.
    pub(crate) fn left<M, const NU: usize, const NK: usize, const NR: usize>(
        &self,
        phased: &Phased<'_, M, T, NK, NR>,
    ) -> T
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let Self { s, t, q, v, tau } = *self;
        let Phased { mechanism, phase } = phased;
        let rates = mechanism.contact_rates(t, q, v);
        let layout = Layout::of(*mechanism);
        let along = phase.braked(&rates, layout);
        let past = -T::one();
        let along = (&along, [T::zero(); 2]);
        let Ok((held, _)) = held(*mechanism, t, (q, v), tau, &phase.touches, along) else { return past };
        let bent = || {
            let driven = mechanism.contact_rates(t, q, &SVector::zeros());
            mechanism.contact_rates(t, q, &held.a) - driven + mechanism.contact_bias(t, q, v)
        };
        let bent = if phase.flights.iter().any(Option::is_some) { bent() } else { SVector::zeros() };
        let (gaps, still) = (mechanism.contact_gaps(t, q), still(&rates));
        let rounding = held.forces.iter().fold(T::zero(), |most, f| most.max(f.abs()));
        let rounding = rounding * epsilon::<T>() * constant(64.0);
        let stiction = mechanism.contact_laws().map(|Law { stiction, .. }| stiction);
        let mut moving = constant::<T>(1.0);
        let mut forces = moving;
        let contacts = phase.touches.into_iter().zip(phase.flights).zip(gaps.iter().zip(stiction));
        for (k, ((touch, flight), (gap, stiction))) in contacts.enumerate() {
            let ((_, first), tangents) = (layout.pressing(k), layout.tangents(k));
            let (rate, normal) = (entry(&rates, first), entry(&held.forces, first));
            let least = match touch {
                // Moments of friction close and open with their contact.
                Touch::Open if !layout.is_gap(k) => T::one(),
                Touch::Open => {
                    let gap = flight.map_or(*gap, |flight| flight.gap(s, rate, entry(&bent, first)));
                    if gap < T::zero() && rate >= -still { T::one() } else { gap }
                }
                Touch::Slips => self::still(&rates) + phase.slip(&rates, tangents.clone()),
                Touch::Sticks => T::one(),
            };
            moving = moving.min(least);
            if touch != Touch::Open {
                forces = forces.min(normal + rounding);
            }
            if touch == Touch::Sticks && !tangents.is_empty() && stiction > T::zero() {
                let size = length(&held.forces, tangents);
                forces = forces.min(stiction * normal - size + rounding);
            }
        }
        let numbers = moving.is_finite() && forces.is_finite();
        if !numbers {
            return past;
        }
        if forces < T::zero() && phase.redundant && self.is_shared(*mechanism, &held.a) {
            forces = T::one();
        }
        moving.min(forces)
    }

    /// Whether contacts give these accelerations by other forces that fulfil their laws.
    fn is_shared<M, const NU: usize, const NK: usize, const NR: usize>(
        &self,
        mechanism: &M,
        a: &SVector<T, NV>,
    ) -> bool
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let Ok((_, found)) = Phase::of(mechanism, self.t, self.q, self.v, self.tau) else { return false };
        let size = |x: &SVector<T, NV>| x.iter().fold(T::zero(), |most, x| most.max(x.abs()));
        size(&(found - a)) <= (size(a) + T::one()) * epsilon::<T>().powf(constant(0.625))
    }
}

/// A configuration and velocity brought back to where the contacts of a phase hold them.
pub(crate) fn settled<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    phased: &Phased<'_, M, T, NK, NR>,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
) -> (SVector<T, NQ>, SVector<T, NV>)
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let Phased { mechanism, phase } = phased;
    let closed = phase.touches.map(|touch| touch != Touch::Open);
    if !closed.contains(&true) {
        return (*q, *v);
    }
    let rates = mechanism.contact_rates(t, q, v);
    let layout = Layout::of(*mechanism);
    let stops = still(&rates) * constant(2.0);
    let mut laws = mechanism.contact_laws();
    for (k, (law, touch)) in laws.iter_mut().zip(phase.touches).enumerate() {
        if touch == Touch::Slips && phase.slip(&rates, layout.tangents(k)) > stops {
            law.friction = T::zero();
        }
    }
    let responses = mechanism.contact_responses(t, q, &closed);
    let undone = |left: &SVector<T, NR>, laws: &[Law<T>; NK]| -> SVector<T, NV> {
        let mut problem = Problem::new(layout, laws, &closed, left);
        problem.weigh(&responses.rates);
        responses.velocities * problem.spread(&problem.together(&Total::repeat(true)))
    };
    let (gaps, mut left) = (mechanism.contact_gaps(t, q), SVector::<T, NR>::zeros());
    for (k, first) in layout.gaps() {
        put(&mut left, first, entry(&gaps, k));
    }
    let push = undone(&left, &laws.map(|law| Law { friction: T::zero(), ..law }));
    let (q, v) = (mechanism.integrate(q, &push), mechanism.carry(t, q, &push, v));
    let v = v + undone(&mechanism.contact_rates(t, &q, &v), &laws);
    (q, v)
}
