//! Distribution of the states of a batch over threads.

use linkwork_jit::Error;
use std::any::Any;

/// First state of a batch that failed: its index, and the error.
pub type FirstFailedState = Option<(usize, Error)>;

/// Returns the number of states per thread: equal shares of all states. Zero threads mean as many as the
/// machine has processors.
fn states_per_worker_thread(states: usize, threads: usize) -> usize {
    let count_processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if threads == 0 { count_processors() } else { threads };
    states.div_ceil(threads.clamp(1, states.max(1))).max(1)
}

/// Splits the states of a batch into shares with `split`, which takes the number of states of a share, and
/// works on the shares in parallel: `work` takes the index of the first state, the number of states, and the
/// share.
pub fn process_shares_in_parallel<P: Send>(
    states: usize,
    threads: usize,
    mut split: impl FnMut(usize) -> P,
    work: impl Fn(usize, usize, P) -> FirstFailedState + Sync,
) -> FirstFailedState {
    let states_per_worker_thread = states_per_worker_thread(states, threads);
    let mut shares = Vec::new();
    let mut first = 0;
    while first < states {
        let count = states_per_worker_thread.min(states - first);
        shares.push((first, count, split(count)));
        first += count;
    }
    if shares.len() == 1 {
        return shares.pop().and_then(|(first, count, own)| work(first, count, own));
    }
    let work = &work;
    std::thread::scope(|scope| {
        let all: Vec<_> = shares
            .into_iter()
            .map(|(first, count, own)| scope.spawn(move || work(first, count, own)))
            .collect();
        let ends = all.into_iter().map(|thread| {
            thread.join().unwrap_or_else(|panic| Some((0, Error::Internal(panic_message(&*panic)))))
        });
        ends.collect::<Vec<_>>().into_iter().flatten().min_by_key(|(state, _)| *state)
    })
}

/// Returns the message of a caught panic.
fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic".to_string())
}
