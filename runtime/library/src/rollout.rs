//! Rollouts of many states with a constant step size, under prescribed inputs.

use crate::call::states_per_thread;
use crate::{Entry, Failure, LANES, Number};
use linkwork::batch::{self, unwatched};
use linkwork::integrate::Rk4;
use linkwork::nalgebra::SVector;
use linkwork::{Batch, Lanes, Mechanism, discrete};

/// Rollout of many states with the same number of steps.
pub struct Rollout<'a, N> {
    /// Initial time of the rollout, s.
    pub start: N,
    /// Duration of one step of the rollout, s.
    pub step: N,
    /// Number of steps of the rollout.
    pub steps: usize,
    /// Number of threads of the rollout; zero for the number of processors.
    pub threads: usize,
    /// Configurations of all states after 0, 1, 2, … steps. The first ones, after 0 steps, are an argument;
    /// the others are results.
    pub q: &'a mut [N],
    /// Velocities of all states after 0, 1, 2, … steps, in the layout of the configurations.
    pub v: &'a mut [N],
    /// Inputs of every state during the first, second, … step, or inputs that all states have in common.
    /// Empty for zero inputs.
    pub inputs: &'a [N],
    /// Whether each state has inputs of its own; otherwise all states share them.
    pub own_inputs: bool,
}

/// Range of states in a rollout that one thread advances.
struct StateRange<'a, N> {
    first: usize,
    q: &'a mut [N],
    v: &'a mut [N],
    inputs: &'a [N],
}

/// Settings of a rollout that all threads use.
#[derive(Clone, Copy)]
struct RolloutPlan<N> {
    start: N,
    step: N,
    steps: usize,
    own_inputs: bool,
}

/// Index of the first state of the rollout that failed, and the reason.
type FailedState = Option<(usize, Failure)>;

/// Advances states by steps of the classical Runge–Kutta method, one state after another.
///
/// # Errors
///
/// The failure of the first state whose motion does not remain finite or on its constraints; the remainder of
/// its motion is NaN.
pub fn roll_out<M, N, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    rollout: Rollout<'_, N>,
) -> Result<(), Failure>
where
    M: Mechanism<NQ, NV, NU, Scalar = N> + Sync,
    N: Number + Entry<N>,
{
    distribute_states(rollout, [NQ, NV, NU], 1, |plan, part| {
        advance_one_by_one::<M, N, NQ, NV, NU>(m, plan, part)
    })
}

/// Advances states as [`roll_out`] does, eight at a time in SIMD lanes.
///
/// # Errors
///
/// As for [`roll_out`].
pub fn roll_out_in_lanes<M, N, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    rollout: Rollout<'_, N>,
) -> Result<(), Failure>
where
    M: Batch<NQ, NV, NU, Scalar = N> + Sync,
    N: Number + Entry<N>,
    Lanes<N, LANES>: Entry<N>,
{
    distribute_states(rollout, [NQ, NV, NU], LANES, |plan, part| {
        let (q, v, u) = (NQ * (plan.steps + 1), NV * (plan.steps + 1), NU * plan.steps);
        let count = part.q.len() / q.max(1);
        let whole = count - count % LANES;
        let mut failed = None;
        for at in (0..whole).step_by(LANES) {
            let own = if plan.own_inputs { &part.inputs[at * u..(at + LANES) * u] } else { part.inputs };
            let group = StateRange {
                first: part.first + at,
                q: &mut part.q[at * q..(at + LANES) * q],
                v: &mut part.v[at * v..(at + LANES) * v],
                inputs: own,
            };
            let found = advance_in_lanes::<M, N, NQ, NV, NU>(m, plan, group);
            failed = failed.or(found);
        }
        let own = if plan.own_inputs { &part.inputs[whole * u..] } else { part.inputs };
        let rest = StateRange {
            first: part.first + whole,
            q: &mut part.q[whole * q..],
            v: &mut part.v[whole * v..],
            inputs: own,
        };
        failed.or(advance_one_by_one::<M, N, NQ, NV, NU>(m, plan, rest))
    })
}

/// Distributes the states of a rollout over threads, after checking the lengths of the arrays.
fn distribute_states<N: Number>(
    rollout: Rollout<'_, N>,
    [nq, nv, nu]: [usize; 3],
    lanes: usize,
    work: impl Fn(RolloutPlan<N>, StateRange<'_, N>) -> FailedState + Sync,
) -> Result<(), Failure> {
    let Rollout { start, step, steps, threads, q, v, inputs, own_inputs } = rollout;
    let plan = RolloutPlan { start, step, steps, own_inputs };
    let (of_q, of_v, of_u) = (nq * (steps + 1), nv * (steps + 1), nu * steps);
    let states = if nq > 0 { q.len() / of_q } else { v.len().checked_div(of_v).unwrap_or(0) };
    let needed = match (inputs.is_empty(), own_inputs) {
        (true, _) => 0,
        (_, true) => states * of_u,
        (_, false) => of_u,
    };
    if q.len() != states * of_q || v.len() != states * of_v || inputs.len() != needed {
        return Err(Failure::new("the arrays do not have the lengths that the rollout needs"));
    }
    let own_inputs = own_inputs && !inputs.is_empty();
    let plan = RolloutPlan { own_inputs, ..plan };
    let share = states_per_thread(states, threads, lanes);
    let mut parts = Vec::new();
    let (mut q, mut v, mut first) = (q, v, 0);
    while first < states {
        let count = share.min(states - first);
        let (front_q, behind_q) = q.split_at_mut(count * of_q);
        let (front_v, behind_v) = v.split_at_mut(count * of_v);
        (q, v) = (behind_q, behind_v);
        let own = if own_inputs { &inputs[first * of_u..(first + count) * of_u] } else { inputs };
        parts.push(StateRange { first, q: front_q, v: front_v, inputs: own });
        first += count;
    }
    let work = &work;
    let failed = match parts.len() {
        0 => None,
        1 => parts.into_iter().find_map(|part| work(plan, part)),
        _ => std::thread::scope(|scope| {
            let all: Vec<_> = parts.into_iter().map(|part| scope.spawn(move || work(plan, part))).collect();
            let ends = all.into_iter().map(|thread| {
                thread.join().unwrap_or_else(|panic| Some((0, Failure::failure_from_panic(panic.as_ref()))))
            });
            ends.flatten().min_by_key(|(state, _)| *state)
        }),
    };
    match failed {
        None => Ok(()),
        Some((state, Failure(why))) => Err(Failure(format!("state {state}: {why}"))),
    }
}

/// Returns the time at the start of a step of the rollout, s.
fn time_of_step<N: Number>(plan: &RolloutPlan<N>, step: usize) -> N {
    plan.start + plan.step * linkwork::nalgebra::convert::<f64, N>(step as f64)
}

fn advance_one_by_one<M, N, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    plan: RolloutPlan<N>,
    part: StateRange<'_, N>,
) -> FailedState
where
    M: Mechanism<NQ, NV, NU, Scalar = N>,
    N: Number + Entry<N>,
{
    let method = Rk4::step(plan.step);
    let rows = part.q.chunks_exact_mut((NQ * (plan.steps + 1)).max(1));
    let rows = rows.zip(part.v.chunks_exact_mut((NV * (plan.steps + 1)).max(1)));
    let mut failed = None;
    for (state, (all_q, all_v)) in rows.enumerate() {
        let mut q = SVector::<N, NQ>::from_fn(|i, _| all_q[i]);
        let mut v = SVector::<N, NV>::from_fn(|i, _| all_v[i]);
        for step in 0..plan.steps {
            let from = if plan.own_inputs { (state * plan.steps + step) * NU } else { step * NU };
            let u = SVector::<N, NU>::from_fn(|i, _| part.inputs.get(from + i).copied().unwrap_or_default());
            match discrete::step(m, &method, time_of_step(&plan, step), &q, &v, &u) {
                Ok(end) => (q, v) = end,
                Err(error) => {
                    failed.get_or_insert((part.first + state, Failure::new(error)));
                    all_q[(step + 1) * NQ..].fill(N::NAN);
                    all_v[(step + 1) * NV..].fill(N::NAN);
                    break;
                }
            }
            all_q[(step + 1) * NQ..(step + 2) * NQ].copy_from_slice(q.as_slice());
            all_v[(step + 1) * NV..(step + 2) * NV].copy_from_slice(v.as_slice());
        }
    }
    failed
}

/// Advances eight states together, one in each SIMD lane.
fn advance_in_lanes<M, N, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    plan: RolloutPlan<N>,
    part: StateRange<'_, N>,
) -> FailedState
where
    M: Batch<NQ, NV, NU, Scalar = N>,
    N: Number,
    Lanes<N, LANES>: Entry<N>,
{
    let lanes = m.lanes::<LANES>();
    let (of_q, of_v) = (NQ * (plan.steps + 1), NV * (plan.steps + 1));
    // Interleaved layout: entry i of all states, then entry i + 1.
    let mut q: Vec<N> = (0..NQ * LANES).map(|k| part.q[k % LANES * of_q + k / LANES]).collect();
    let mut v: Vec<N> = (0..NV * LANES).map(|k| part.v[k % LANES * of_v + k / LANES]).collect();
    let mut failed: FailedState = None;
    for step in 0..plan.steps {
        let stride = if plan.own_inputs { plan.steps * NU } else { 0 };
        let u = SVector::<Lanes<N, LANES>, NU>::from_fn(|i, _| {
            Lanes::from_fn(|k| part.inputs.get(k * stride + step * NU + i).copied().unwrap_or_default())
        });
        let one = batch::Rollout::new(Rk4::step(plan.step), 1).from_time(time_of_step(&plan, step));
        if let Err(error) = lanes.roll_out(&one, &mut q, &mut v, |_, _, _, _| u, unwatched) {
            let (state, why) = match error {
                batch::Error::Motion { state, source, .. } => (state, Failure::new(source)),
                other => (0, Failure::new(other)),
            };
            failed.get_or_insert((part.first + state, why));
        }
        for k in 0..LANES {
            for i in 0..NQ {
                part.q[k * of_q + (step + 1) * NQ + i] = q[i * LANES + k];
            }
            for i in 0..NV {
                part.v[k * of_v + (step + 1) * NV + i] = v[i * LANES + k];
            }
        }
    }
    failed
}
