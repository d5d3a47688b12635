//! Rollouts of many states on all processors.

use super::rollout::{RolloutTally, StateRange};
use super::{Batch, Error, Lanewise, Lockstep, Progress, Rollout};
use crate::Lanes;
use core::ops::ControlFlow;
use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use nalgebra::SVector;

/// Number of lane groups that one thread processes without splitting them among further threads.
const GRAIN: usize = 4;

/// Progress and cancellation flag of a rollout, shared by all threads.
struct SharedProgress<W> {
    watch: W,
    done: AtomicUsize,
    cancelled: AtomicBool,
    count: usize,
}

impl<M, const L: usize> Lanewise<'_, M, L> {
    /// Computes [`roll_out`](Self::roll_out) on the threads of rayon's pool: the pool in which it is called,
    /// or the global one. Results do not depend on the number of threads.
    ///
    /// Several threads call `control` and `watch` concurrently. Cancelling takes effect after each thread's
    /// current group of states.
    ///
    /// # Errors
    ///
    /// The errors of [`roll_out`](Self::roll_out); of several failures the first in the order of states.
    pub fn roll_out_in_parallel<S, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        rollout: &Rollout<M::Scalar, S>,
        q: &mut [M::Scalar],
        v: &mut [M::Scalar],
        control: impl Fn(
            usize,
            Lanes<M::Scalar, L>,
            &SVector<Lanes<M::Scalar, L>, NQ>,
            &SVector<Lanes<M::Scalar, L>, NV>,
        ) -> SVector<Lanes<M::Scalar, L>, NU>
        + Sync,
        watch: impl Fn(Progress) -> ControlFlow<()> + Sync,
    ) -> Result<(), Error>
    where
        M: Batch<NQ, NV, NU> + Sync,
        S: Lockstep<M::Scalar> + Sync,
    {
        let part = StateRange::range_of_all_states(rollout, q, v)?;
        let shared = SharedProgress {
            watch,
            done: AtomicUsize::new(0),
            cancelled: AtomicBool::new(false),
            count: part.count,
        };
        self.roll_out_halves_in_parallel(rollout, part, &control, &shared).rollout_result()
    }

    /// Splits the states into halves recursively, down to [`GRAIN`] groups.
    fn roll_out_halves_in_parallel<S, C, W, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        rollout: &Rollout<M::Scalar, S>,
        mut part: StateRange<'_, M::Scalar, NQ, NV>,
        control: &C,
        shared: &SharedProgress<W>,
    ) -> RolloutTally
    where
        M: Batch<NQ, NV, NU> + Sync,
        S: Lockstep<M::Scalar> + Sync,
        W: Fn(Progress) -> ControlFlow<()> + Sync,
        C: Fn(
                usize,
                Lanes<M::Scalar, L>,
                &SVector<Lanes<M::Scalar, L>, NQ>,
                &SVector<Lanes<M::Scalar, L>, NV>,
            ) -> SVector<Lanes<M::Scalar, L>, NU>
            + Sync,
    {
        let groups = part.count.div_ceil(L.max(1));
        if groups > GRAIN {
            let (front, back) = part.split_at_state(groups / 2 * L);
            let (front, back) = rayon::join(
                || self.roll_out_halves_in_parallel(rollout, front, control, shared),
                || self.roll_out_halves_in_parallel(rollout, back, control, shared),
            );
            return front.combine_tallies(back);
        }
        if shared.cancelled.load(Ordering::Relaxed) {
            return RolloutTally { cancelled: true, ..RolloutTally::default() };
        }
        let mut before = 0;
        self.roll_out_range_of_states(rollout, &mut part, control, |here| {
            let done = shared.done.fetch_add(here - before, Ordering::Relaxed) + (here - before);
            before = here;
            let stop = (shared.watch)(Progress { done, count: shared.count }).is_break();
            if stop || shared.cancelled.load(Ordering::Relaxed) {
                shared.cancelled.store(true, Ordering::Relaxed);
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })
    }
}
