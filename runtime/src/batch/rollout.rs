//! Motions of many states over a fixed number of steps.

use super::columns::{OutputColumns, count_states_in_first_argument};
use super::{Batch, Error, Lanewise};
use crate::integrate::{self, ContinuousInputs, Method, Rk4, SemiImplicitEuler, State, System};
use crate::lanes::{lane, lane_by_lane};
use crate::private::to_f64;
use crate::{Lanes, Real};
use core::ops::ControlFlow;
use nalgebra::{ComplexField, SVector};

/// Integration method whose sequence of operations does not depend on the values, so that several states can
/// be advanced together in SIMD lanes: fixed steps and no iteration.
pub trait Lockstep<T: Real>: Method<T> {
    /// Whether steps of constrained mechanisms iterate. Their states are then advanced one by one.
    const ITERATES_CONSTRAINTS: bool = false;

    /// Same integration method with SIMD lanes as its scalar type.
    type MethodInLanes<const L: usize>: Method<Lanes<T, L>>;

    /// Returns the method with SIMD lanes as its scalar type, and the same step size in all lanes.
    fn in_lanes<const L: usize>(&self) -> Self::MethodInLanes<L>;
}

impl<T: Real> Lockstep<T> for Rk4<T> {
    type MethodInLanes<const L: usize> = Rk4<Lanes<T, L>>;

    fn in_lanes<const L: usize>(&self) -> Self::MethodInLanes<L> {
        Rk4::step(Lanes::splat(self.nominal_step_length()))
    }
}

impl<T: Real> Lockstep<T> for SemiImplicitEuler<T> {
    const ITERATES_CONSTRAINTS: bool = true;

    type MethodInLanes<const L: usize> = SemiImplicitEuler<Lanes<T, L>>;

    fn in_lanes<const L: usize>(&self) -> Self::MethodInLanes<L> {
        SemiImplicitEuler::step(Lanes::splat(self.nominal_step_length()))
    }
}

/// Method, number of steps and start time of a rollout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rollout<T, S> {
    method: S,
    steps: usize,
    start: T,
}

impl<T: Real, S: Lockstep<T>> Rollout<T, S> {
    /// Returns a rollout of `steps` steps of a method, from time zero: `Rollout::new(Rk4::step(1e-3), 500)`.
    pub fn new(method: S, steps: usize) -> Self {
        Self { method, steps, start: T::zero() }
    }

    /// Sets the initial time `t` of the rollout, s.
    #[must_use]
    pub fn from_time(self, t: T) -> Self {
        Self { start: t, ..self }
    }
}

/// Progress of a rollout: how many states are done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Number of states that are done.
    pub done: usize,
    /// Total number of states in the rollout.
    pub count: usize,
}

/// Ignores the progress of a rollout and never cancels it.
pub fn unwatched(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Outcome of a rollout for a range of states.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RolloutTally {
    /// Number of states in the range that are done, including failed ones.
    pub(super) done: usize,
    /// Number of states in the range that failed.
    pub(super) failed: usize,
    /// Index of the first state that failed, and the error.
    pub(super) first: Option<(usize, integrate::Error)>,
    /// Whether the caller cancelled the rollout.
    pub(super) cancelled: bool,
}

impl RolloutTally {
    /// Returns the combined outcome of this range and the range `behind` it.
    pub(super) fn combine_tallies(self, behind: RolloutTally) -> RolloutTally {
        RolloutTally {
            done: self.done + behind.done,
            failed: self.failed + behind.failed,
            first: self.first.or(behind.first),
            cancelled: self.cancelled || behind.cancelled,
        }
    }

    pub(super) fn rollout_result(self) -> Result<(), Error> {
        match self.first {
            _ if self.cancelled => Err(Error::Cancelled { done: self.done }),
            Some((state, source)) => Err(Error::Motion { state, count: self.failed, source }),
            None => Ok(()),
        }
    }
}

/// Range of the states to be rolled out.
pub(super) struct StateRange<'a, T, const NQ: usize, const NV: usize> {
    /// Index of the first state of the range among all states.
    pub(super) first: usize,
    pub(super) q: OutputColumns<'a, T, NQ, 1>,
    pub(super) v: OutputColumns<'a, T, NV, 1>,
    pub(super) count: usize,
}

impl<'a, T: Real, const NQ: usize, const NV: usize> StateRange<'a, T, NQ, NV> {
    /// Returns the range of all states, or an error if the slices have different numbers of states.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] and [`Error::Method`].
    pub(super) fn range_of_all_states<S: Lockstep<T>>(
        rollout: &Rollout<T, S>,
        q: &'a mut [T],
        v: &'a mut [T],
    ) -> Result<Self, Error> {
        let count = count_states_in_first_argument(q.len(), NQ);
        let (q, v) = (OutputColumns::new("q", q, count)?, OutputColumns::new("v", v, count)?);
        rollout.method.check().map_err(Error::Method)?;
        Ok(Self { first: 0, q, v, count })
    }
}

#[cfg(feature = "rayon")]
impl<T: Real, const NQ: usize, const NV: usize> StateRange<'_, T, NQ, NV> {
    /// Splits the range into the states before index `at` and the states from `at` on.
    pub(super) fn split_at_state(self, at: usize) -> (Self, Self) {
        let ((q, other_q), (v, other_v)) = (self.q.split_at_state(at), self.v.split_at_state(at));
        let front = Self { first: self.first, q, v, count: at };
        (front, Self { first: self.first + at, q: other_q, v: other_v, count: self.count - at })
    }
}

/// Group of lanes after its last step, with the errors of the lanes that failed.
struct FinishedGroup<T, const L: usize, const NQ: usize, const NV: usize> {
    end: State<Lanes<T, L>, NQ, NV>,
    failures: [Option<integrate::Error>; L],
}

impl<M, const L: usize> Lanewise<'_, M, L> {
    /// Rolls out many states: advances each by the given number of steps of the method and overwrites it with
    /// its final state. No memory is allocated. Penetration of contact surfaces at the start is not checked,
    /// because rollouts may continue others ([`contact::check`](crate::contact::check)).
    ///
    /// - `q`, `v`: the states, a structure of arrays: entry `i` of state `k` of `count` is at index `i *
    ///   count + k`.
    /// - `control(k, t, q, v)`: returns the inputs `u` of the states in the lanes, the first of which has
    ///   index `k`. At the end of the arrays, unused lanes contain the last state. Called at each evaluation
    ///   of the dynamics.
    /// - `watch`: called after every group of states with the number of states that are done;
    ///   `ControlFlow::Break(())` cancels. Pass [`unwatched`] to ignore the progress.
    ///
    /// The result of a state does not depend on the other states, on their number or on `L`, provided that
    /// `control` computes each lane independently.
    ///
    /// # Errors
    ///
    /// [`Error::Length`] and [`Error::Method`] before anything is written; [`Error::Motion`] if some motion
    /// does not remain finite or on its constraints; [`Error::Cancelled`].
    pub fn roll_out<S, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        rollout: &Rollout<M::Scalar, S>,
        q: &mut [M::Scalar],
        v: &mut [M::Scalar],
        control: impl Fn(
            usize,
            Lanes<M::Scalar, L>,
            &SVector<Lanes<M::Scalar, L>, NQ>,
            &SVector<Lanes<M::Scalar, L>, NV>,
        ) -> SVector<Lanes<M::Scalar, L>, NU>,
        mut watch: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), Error>
    where
        M: Batch<NQ, NV, NU>,
        S: Lockstep<M::Scalar>,
    {
        let mut part = StateRange::range_of_all_states(rollout, q, v)?;
        let count = part.count;
        self.roll_out_range_of_states(rollout, &mut part, &control, |done| watch(Progress { done, count }))
            .rollout_result()
    }

    /// Rolls out a range of states, one group of lanes after another. `watch` receives the number of states
    /// of the range that are done.
    pub(super) fn roll_out_range_of_states<S, C, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        rollout: &Rollout<M::Scalar, S>,
        part: &mut StateRange<'_, M::Scalar, NQ, NV>,
        control: &C,
        mut watch: impl FnMut(usize) -> ControlFlow<()>,
    ) -> RolloutTally
    where
        M: Batch<NQ, NV, NU>,
        S: Lockstep<M::Scalar>,
        C: Fn(
            usize,
            Lanes<M::Scalar, L>,
            &SVector<Lanes<M::Scalar, L>, NQ>,
            &SVector<Lanes<M::Scalar, L>, NV>,
        ) -> SVector<Lanes<M::Scalar, L>, NU>,
    {
        let mut tally = RolloutTally::default();
        for state in (0..part.count).step_by(L.max(1)) {
            let (q, v) = (part.q.load_states::<L>(state), part.v.load_states::<L>(state));
            let start = State { t: Lanes::splat(rollout.start), q: q.0, v: v.0 };
            let group = self.roll_out_group(rollout, part.first + state, start, control);
            let present = L.min(part.count - state);
            for (k, failure) in group.failures.iter().enumerate().take(present) {
                let failed = failure.map(|error| (part.first + state + k, error));
                tally = tally.combine_tallies(RolloutTally {
                    done: 1,
                    failed: failed.iter().count(),
                    first: failed,
                    cancelled: false,
                });
                if failed.is_none() {
                    part.q.store_state_of_lane(state + k, &group.end.q, k);
                    part.v.store_state_of_lane(state + k, &group.end.v, k);
                }
            }
            if watch(tally.done).is_break() {
                // A completed rollout cannot be cancelled.
                tally.cancelled = tally.done < part.count;
                return tally;
            }
        }
        tally
    }

    fn roll_out_group<S, C, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        rollout: &Rollout<M::Scalar, S>,
        first: usize,
        start: State<Lanes<M::Scalar, L>, NQ, NV>,
        control: &C,
    ) -> FinishedGroup<M::Scalar, L, NQ, NV>
    where
        M: Batch<NQ, NV, NU>,
        S: Lockstep<M::Scalar>,
        C: Fn(
            usize,
            Lanes<M::Scalar, L>,
            &SVector<Lanes<M::Scalar, L>, NQ>,
            &SVector<Lanes<M::Scalar, L>, NV>,
        ) -> SVector<Lanes<M::Scalar, L>, NU>,
    {
        if M::CONSTRAINED && S::ITERATES_CONSTRAINTS {
            return self.roll_out_one_by_one(rollout, first, start, control);
        }
        let inputs = ContinuousInputs(|t, q: &SVector<_, NQ>, v: &SVector<_, NV>| control(first, t, q, v));
        let mut system: System<'_, Self, _, NU> = System::new(self, inputs);
        let method = rollout.method.in_lanes::<L>();
        let mut memory = method.initial_memory();
        let mut group = FinishedGroup { end: start, failures: [None; L] };
        for _ in 0..rollout.steps {
            let begin = group.end;
            match method.advance(&mut memory, &mut system, &begin, None, false) {
                Ok(step) => group.end = step.end,
                Err(error) => {
                    // The step has failed for all lanes that had not failed before.
                    group.failures = group.failures.map(|failure| failure.or(Some(error)));
                    return group;
                }
            }
            let lanes = nan_mask(&group.end).0.into_iter().zip(begin.t.0);
            for (failure, (mask, t)) in group.failures.iter_mut().zip(lanes) {
                if failure.is_none() && !mask.is_finite() {
                    *failure = Some(integrate::Error::NotFinite { t: to_f64(t) });
                }
            }
        }
        group
    }

    /// Advances the states of a group one after another, instead of together in lanes.
    fn roll_out_one_by_one<S, C, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        rollout: &Rollout<M::Scalar, S>,
        first: usize,
        start: State<Lanes<M::Scalar, L>, NQ, NV>,
        control: &C,
    ) -> FinishedGroup<M::Scalar, L, NQ, NV>
    where
        M: Batch<NQ, NV, NU>,
        S: Lockstep<M::Scalar>,
        C: Fn(
            usize,
            Lanes<M::Scalar, L>,
            &SVector<Lanes<M::Scalar, L>, NQ>,
            &SVector<Lanes<M::Scalar, L>, NV>,
        ) -> SVector<Lanes<M::Scalar, L>, NU>,
    {
        let mut failures = [None; L];
        let ends: [_; L] = core::array::from_fn(|k| {
            // `control` computes lanes independently, so the contents of the other lanes do not matter.
            let inputs = ContinuousInputs(|t, q: &SVector<_, NQ>, v: &SVector<_, NV>| {
                lane(&control(first, Lanes::splat(t), &q.map(Lanes::splat), &v.map(Lanes::splat)), k)
            });
            let mut system: System<'_, M, _, NU> = System::new(self.mechanism, inputs);
            let mut memory = rollout.method.initial_memory();
            let mut state = State { t: start.t.0[k], q: lane(&start.q, k), v: lane(&start.v, k) };
            for _ in 0..rollout.steps {
                match system.advance_step(&rollout.method, &mut memory, nalgebra::zero(), &state, None, false)
                {
                    Ok(step) => state = step.end,
                    Err(error) => {
                        failures[k] = Some(error);
                        break;
                    }
                }
            }
            state
        });
        let end = State {
            t: Lanes(core::array::from_fn(|k| ends[k].t)),
            q: lane_by_lane(|k| ends[k].q),
            v: lane_by_lane(|k| ends[k].v),
        };
        FinishedGroup { end, failures }
    }
}

/// Returns zero in the lanes whose state is finite, and NaN in the others.
fn nan_mask<T: Real, const L: usize, const NQ: usize, const NV: usize>(
    state: &State<Lanes<T, L>, NQ, NV>,
) -> Lanes<T, L> {
    state.q.iter().chain(state.v.iter()).fold(Lanes::default(), |sum, x| sum + *x * T::zero())
}
