//! Events: zero crossings of functions of time and state, located on the path of a step.

use crate::Real;
use crate::integrate::State;
use crate::private::{constant, epsilon};
use core::cmp::Ordering;
use nalgebra::SVector;

/// Direction in which the event function must cross zero for an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// The event function crosses zero from negative to positive.
    Rising,
    /// The event function crosses zero from positive to negative.
    Falling,
    /// The event function crosses zero in either direction.
    Either,
}

impl Crossing {
    fn matches_crossing(self, before: Ordering, after: Ordering) -> bool {
        match before {
            Ordering::Less => after != Ordering::Less && self != Self::Falling,
            Ordering::Greater => after != Ordering::Greater && self != Self::Rising,
            // The side from which the motion comes is unknown until it has left the surface.
            Ordering::Equal => false,
        }
    }
}

/// Event that was found on a step: its position and its index.
#[derive(Clone, Copy, Debug)]
pub struct EventHit<T> {
    /// Position on the step at or just after the crossing, 0 at the start and 1 at the end.
    pub theta: T,
    /// Index of the event, in the order of declaration.
    pub index: usize,
}

/// Reason why the search for events on a step failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventSearchError {
    /// The function of the event with this index is NaN.
    Value(usize),
    /// The motion continues through the surface of the event with this index, although its impact should
    /// prevent this.
    Through(usize),
}

/// Effect that an event has on the continuation of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventOutcome {
    /// The event ends the run.
    Stop,
    /// The run continues with unchanged velocity.
    Go,
    /// The run continues with a velocity that the event has changed.
    Jump,
}

/// Effect of an event on the state and the run; only the velocity may change.
pub trait Action<T, const NQ: usize, const NV: usize> {
    /// Whether an event with this effect ends the run of a simulation.
    const STOPS: bool;

    /// Applies the effect of an event to the state, and returns how the run continues.
    fn act(&mut self, state: &mut State<T, NQ, NV>) -> EventOutcome;
}

/// Effect of an event that ends the run.
#[derive(Clone, Copy, Debug)]
pub struct Stop;

impl<T, const NQ: usize, const NV: usize> Action<T, NQ, NV> for Stop {
    const STOPS: bool = true;

    fn act(&mut self, _state: &mut State<T, NQ, NV>) -> EventOutcome {
        EventOutcome::Stop
    }
}

/// Effect of an event that only emits a sample; the run continues.
#[derive(Clone, Copy, Debug)]
pub struct Report;

impl<T, const NQ: usize, const NV: usize> Action<T, NQ, NV> for Report {
    const STOPS: bool = false;

    fn act(&mut self, _state: &mut State<T, NQ, NV>) -> EventOutcome {
        EventOutcome::Go
    }
}

/// Effect of an event that emits a sample and changes the velocity to the result of a function
/// `(t, q, v) → v`.
#[derive(Clone, Copy, Debug)]
pub struct Impact<F>(pub F);

impl<T, F, const NQ: usize, const NV: usize> Action<T, NQ, NV> for Impact<F>
where
    T: Real,
    F: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NV>,
{
    const STOPS: bool = false;

    fn act(&mut self, state: &mut State<T, NQ, NV>) -> EventOutcome {
        state.v = (self.0)(state.t, &state.q, &state.v);
        EventOutcome::Jump
    }
}

/// Events of a run, as a list of nested types `((NoEvents, Event), Event)` that requires no allocation.
pub trait Events<T: Real, const NQ: usize, const NV: usize> {
    /// Number of events in the list.
    const COUNT: usize;
    /// Whether any event in the list ends the run.
    const STOPS: bool;

    /// Records the signs of the event functions at the initial state.
    ///
    /// # Errors
    ///
    /// [`EventSearchError::Value`] if a function is NaN.
    fn begin(&mut self, state: &State<T, NQ, NV>) -> Result<(), EventSearchError>;

    /// Returns the first event between `from` and `to` on a step. Every event that is not later than the
    /// first one, up to rounding, stores its own position.
    ///
    /// # Errors
    ///
    /// [`EventSearchError`] if a function is NaN, or if an impact has not separated the colliding bodies.
    fn locate<P: Fn(T) -> State<T, NQ, NV>>(
        &mut self,
        path: &P,
        from: T,
        to: T,
    ) -> Result<Option<EventHit<T>>, EventSearchError>;

    /// Adopts the signs of the event functions at the end of the last searched range, which contained no
    /// event.
    fn pass(&mut self);

    /// Returns the index of the first event, from the index `from` on, that is not later than `limit` on the
    /// step.
    fn due(&self, from: usize, limit: T) -> Option<usize>;

    /// Applies the effect of the event with index `index` to the state. `later` returns the state shortly
    /// after a given one, with the same velocity.
    fn act<P: Fn(&State<T, NQ, NV>) -> State<T, NQ, NV>>(
        &mut self,
        index: usize,
        state: &mut State<T, NQ, NV>,
        later: &P,
    ) -> EventOutcome;

    /// Marks the signs of event functions as unknown for events up to the position `limit`, because the
    /// velocity has changed.
    fn rebound(&mut self, limit: T);
}

/// Returns the distance on a step below which events coincide up to rounding.
pub(super) fn coincidence_threshold<T: Real>() -> T {
    epsilon::<T>() * constant(8.0)
}

/// Empty list of events.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoEvents;

impl<T: Real, const NQ: usize, const NV: usize> Events<T, NQ, NV> for NoEvents {
    const COUNT: usize = 0;
    const STOPS: bool = false;

    fn begin(&mut self, _state: &State<T, NQ, NV>) -> Result<(), EventSearchError> {
        Ok(())
    }

    fn locate<P: Fn(T) -> State<T, NQ, NV>>(
        &mut self,
        _path: &P,
        _from: T,
        _to: T,
    ) -> Result<Option<EventHit<T>>, EventSearchError> {
        Ok(None)
    }

    fn pass(&mut self) {}

    fn due(&self, _from: usize, _limit: T) -> Option<usize> {
        None
    }

    fn act<P: Fn(&State<T, NQ, NV>) -> State<T, NQ, NV>>(
        &mut self,
        _index: usize,
        _state: &mut State<T, NQ, NV>,
        _later: &P,
    ) -> EventOutcome {
        EventOutcome::Go
    }

    fn rebound(&mut self, _limit: T) {}
}

/// Event: function, directions of crossings, effect, and state of the search.
#[derive(Clone, Copy, Debug)]
pub struct Event<T, G, A> {
    function: G,
    crossing: Crossing,
    action: A,
    /// Sign of the event function at the current position of the search. The field `ahead` is the sign at the
    /// end of the range searched last.
    side: Ordering,
    ahead: Ordering,
    /// Position of the event on the step, if it was found.
    found: Option<T>,
    /// Sign of the event function that the motion must not have after an impact.
    closed: Ordering,
}

impl<T, G, A> Event<T, G, A> {
    pub(super) fn new(function: G, crossing: Crossing, action: A) -> Self {
        let unknown = Ordering::Equal;
        Self { function, crossing, action, side: unknown, ahead: unknown, found: None, closed: unknown }
    }

    /// Returns the value of the event function at a state.
    fn value_of_function<const NQ: usize, const NV: usize>(&mut self, state: &State<T, NQ, NV>) -> T
    where
        T: Real,
        G: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> T,
    {
        (self.function)(state.t, &state.q, &state.v)
    }
}

/// Ratio of the speeds after and before an impact below which the motion has stopped.
const STOPPED: f64 = 1e-6;

/// Returns the sign of a number; `Equal` for zero and NaN.
fn sign_of_value<T: Real>(value: T) -> Ordering {
    value.partial_cmp(&T::zero()).unwrap_or(Ordering::Equal)
}

impl<T, E, G, A, const NQ: usize, const NV: usize> Events<T, NQ, NV> for (E, Event<T, G, A>)
where
    T: Real,
    E: Events<T, NQ, NV>,
    G: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> T,
    A: Action<T, NQ, NV>,
{
    const COUNT: usize = E::COUNT + 1;
    const STOPS: bool = E::STOPS || A::STOPS;

    fn begin(&mut self, state: &State<T, NQ, NV>) -> Result<(), EventSearchError> {
        self.0.begin(state)?;
        let value = self.1.value_of_function(state);
        if value.partial_cmp(&value).is_none() {
            return Err(EventSearchError::Value(E::COUNT));
        }
        self.1.side = sign_of_value(value);
        Ok(())
    }

    fn locate<P: Fn(T) -> State<T, NQ, NV>>(
        &mut self,
        path: &P,
        mut from: T,
        to: T,
    ) -> Result<Option<EventHit<T>>, EventSearchError> {
        let earlier = self.0.locate(path, from, to)?;
        // Slightly farther, so that coincident events are found in any order.
        let to = earlier.map_or(to, |hit| (hit.theta + coincidence_threshold()).min(to));
        let event = &mut self.1;
        event.found = None;
        let end = event.value_of_function(&path(to));
        if end.partial_cmp(&end).is_none() {
            return Err(EventSearchError::Value(E::COUNT));
        }
        event.ahead = sign_of_value(end);
        if event.side == Ordering::Equal {
            (from, event.side) =
                position_and_sign_after_zero(&mut |theta| event.value_of_function(&path(theta)), [from, to]);
            match event.side {
                // Still on the surface.
                Ordering::Equal => event.ahead = Ordering::Equal,
                side if side == event.closed => return Err(EventSearchError::Through(E::COUNT)),
                _ => event.closed = Ordering::Equal,
            }
        }
        if !event.crossing.matches_crossing(event.side, event.ahead) {
            return Ok(earlier);
        }
        let sign = if event.side == Ordering::Less { T::one() } else { -T::one() };
        let theta = sign_change_position(
            |theta| event.value_of_function(&path(theta)) * sign,
            [from, to],
            end * sign,
        );
        event.found = Some(theta);
        if earlier.is_some_and(|hit| hit.theta <= theta) {
            return Ok(earlier);
        }
        Ok(Some(EventHit { theta, index: E::COUNT }))
    }

    fn pass(&mut self) {
        self.0.pass();
        if self.1.ahead != Ordering::Equal {
            self.1.side = self.1.ahead;
        }
    }

    fn due(&self, from: usize, limit: T) -> Option<usize> {
        let index_of_found_event =
            || self.1.found.filter(|found| *found <= limit && from <= E::COUNT).map(|_| E::COUNT);
        self.0.due(from, limit).or_else(index_of_found_event)
    }

    fn act<P: Fn(&State<T, NQ, NV>) -> State<T, NQ, NV>>(
        &mut self,
        index: usize,
        state: &mut State<T, NQ, NV>,
        later: &P,
    ) -> EventOutcome {
        if index != E::COUNT {
            return self.0.act(index, state, later);
        }
        let event = &mut self.1;
        let before = event.value_of_function(&later(state)) - event.value_of_function(state);
        let flow = event.action.act(state);
        let beyond = event.side.reverse();
        event.side = beyond;
        if flow == EventOutcome::Jump {
            let after = event.value_of_function(&later(state)) - event.value_of_function(state);
            // Motion in the same direction passes the surface; any other motion has been stopped or reversed
            // by it.
            let passes = after * before > T::zero() && after.abs() > before.abs() * constant(STOPPED);
            event.closed = if passes { Ordering::Equal } else { beyond };
        }
        flow
    }

    fn rebound(&mut self, limit: T) {
        self.0.rebound(limit);
        if self.1.found.is_some_and(|found| found <= limit) {
            self.1.side = Ordering::Equal;
        }
    }
}

/// Returns a position between `a` and `b` at which the function `f` differs from zero by more than rounding,
/// and the sign of `f` there. The function is zero at `a` up to rounding, and may be zero again before `b`.
fn position_and_sign_after_zero<T: Real>(f: &mut impl FnMut(T) -> T, [a, b]: [T; 2]) -> (T, Ordering) {
    let rounding = f(a).abs() * constant(4.0);
    for part in [1.5e-8, 1e-6, 6e-5, 4e-3, 0.1, 1.0] {
        let x = a + (b - a) * constant(part);
        let value = f(x);
        if value.abs() > rounding {
            return (x, sign_of_value(value));
        }
    }
    (a, Ordering::Equal)
}

/// Returns the position of the sign change of the function `f`, from negative to the non-negative value `end`
/// at `b`. The position is bracketed to rounding error, and the result is the non-negative end of the
/// bracket. The ITP method takes at most one evaluation more than bisection, and much fewer for smooth
/// functions (Oliveira and Takahashi, ACM Trans. Math. Softw. 47, 2020).
fn sign_change_position<T: Real>(mut f: impl FnMut(T) -> T, [mut a, mut b]: [T; 2], end: T) -> T {
    let zero = T::zero();
    let (half, two) = (constant::<T>(0.5), constant::<T>(2.0));
    let (mut below, mut above) = (f(a), end);
    if below >= zero {
        return a;
    }
    let tolerance = epsilon::<T>();
    let truncation = constant::<T>(0.2) / (b - a);
    let mut reach = b - a;
    while b - a > two * tolerance {
        let middle = (a + b) * half;
        let secant = (above * a - below * b) / (above - below);
        let shift = truncation * (b - a) * (b - a);
        let towards = if middle >= secant { T::one() } else { -T::one() };
        let inner = if shift <= (middle - secant).abs() { secant + towards * shift } else { middle };
        let slack = reach - (b - a) * half;
        let x = if (inner - middle).abs() <= slack { inner } else { middle - towards * slack };
        let x = if x > a && x < b { x } else { middle };
        if x <= a || x >= b {
            break;
        }
        let value = f(x);
        if value >= zero {
            (b, above) = (x, value);
        } else {
            (a, below) = (x, value);
        }
        reach *= half;
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the position of the sign change of `f` between 0 and 1, and the number of evaluations of `f`.
    fn sign_change_with_evaluation_count(f: impl Fn(f64) -> f64) -> (f64, usize) {
        let mut count = 0;
        let evaluate_and_count = |x| {
            count += 1;
            f(x)
        };
        let x = sign_change_position(evaluate_and_count, [0.0, 1.0], f(1.0));
        (x, count)
    }

    #[test]
    fn sign_changes_are_found_to_rounding() {
        let (x, count) = sign_change_with_evaluation_count(|x| x * x - 0.5);
        assert!((x - core::f64::consts::FRAC_1_SQRT_2).abs() < 5e-16 && count < 16, "{count}");
        let (x, count) = sign_change_with_evaluation_count(|x| if x < 0.3 { -1e-3 } else { 1e3 });
        assert!((x - 0.3).abs() < 5e-16 && count < 60, "{count}");
        let (x, count) = sign_change_with_evaluation_count(|x| (x - 0.7).powi(9));
        assert!((x - 0.7).abs() < 5e-16 && count < 60, "{count}");
        assert_eq!(sign_change_with_evaluation_count(|x| x).0, 0.0);
    }

    #[test]
    fn crossings_count_by_direction() {
        use Ordering::{Equal, Greater, Less};
        assert!(
            Crossing::Rising.matches_crossing(Less, Greater)
                && Crossing::Rising.matches_crossing(Less, Equal)
        );
        assert!(
            !Crossing::Rising.matches_crossing(Greater, Less)
                && !Crossing::Falling.matches_crossing(Less, Greater)
        );
        assert!(
            Crossing::Either.matches_crossing(Greater, Less)
                && Crossing::Either.matches_crossing(Less, Greater)
        );
        assert!(
            !Crossing::Either.matches_crossing(Equal, Greater)
                && !Crossing::Either.matches_crossing(Less, Less)
        );
    }
}
