//! Iterations of an iterative linear-quadratic regulator (iLQR) on an arm and on a free quadruped: nanoseconds a node of their
//! parts, and the costs of the iterates, as JSON for `benches/peers/optimal.py`, which has the same problems for Crocoddyl.

use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::optimal::{Policy, Quadratic, Value, backward};
use linkwork::prelude::*;
use linkwork::{RheonomicDerivatives, discrete};
use rustix::time::{ClockId, clock_gettime};

#[mechanism(
    urdf = "../models/urdf/panda.urdf",
    lock = ["panda_finger_joint1", "panda_finger_joint2"],
    passive = ignore,
    derivatives
)]
struct Panda;

#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, gravity = 0 * z, passive = ignore, derivatives)]
struct Solo;

const NODES: usize = 100;
const PERIOD: f64 = 0.01;
const ITERATIONS: usize = 8;
const REPEATS: usize = 300;

/// Nanoseconds of the process in one call of a function a node: the least of many.
fn least(mut f: impl FnMut()) -> f64 {
    let now = || {
        let time = clock_gettime(ClockId::ProcessCPUTime);
        time.tv_sec as f64 * 1e9 + time.tv_nsec as f64
    };
    let times = (0..REPEATS).map(|_| {
        let begin = now();
        f();
        now() - begin
    });
    times.fold(f64::INFINITY, f64::min) / NODES as f64
}

type State<const NQ: usize, const NV: usize> = (SVector<f64, NQ>, SVector<f64, NV>);

struct Problem<'m, M, const NQ: usize> {
    mechanism: &'m M,
    method: SemiImplicitEuler<f64>,
    goal: SVector<f64, NQ>,
}

/// A trajectory with everything that an iteration makes of it: one allocation each.
struct Trajectory<const NQ: usize, const NV: usize, const NU: usize> {
    states: Vec<State<NQ, NV>>,
    inputs: Vec<SVector<f64, NU>>,
    nodes: Vec<(discrete::Transition<f64, NQ, NV, NU>, Quadratic<f64, NV, NU>)>,
    policies: Vec<Policy<f64, NV, NU>>,
}

impl<M, const NQ: usize> Problem<'_, M, NQ> {
    /// The costs of a state: half of the weighted squares of what is left to the goal, and of the velocity.
    fn of_state<const NV: usize, const NU: usize>(&self, (q, v): &State<NQ, NV>, weights: [f64; 2]) -> f64
    where
        M: RheonomicDerivatives<NQ, NV, NU, Scalar = f64>,
    {
        let off = self.mechanism.difference(&self.goal, q);
        0.5 * (weights[0] * off.norm_squared() + weights[1] * v.norm_squared())
    }

    /// The same to second order, without the curvature of the difference (Gauss and Newton).
    fn model<const NV: usize, const NU: usize>(
        &self,
        (q, v): &State<NQ, NV>,
        [of_q, of_v]: [f64; 2],
    ) -> Value<f64, NV>
    where
        M: RheonomicDerivatives<NQ, NV, NU, Scalar = f64>,
    {
        let off = self.mechanism.difference(&self.goal, q);
        let mut model = Value { v: v * of_v, vv: SMatrix::identity() * of_v, ..Value::zeros() };
        if NQ == NV {
            (model.q, model.qq) = (off * of_q, SMatrix::identity() * of_q);
            return model;
        }
        // How the difference changes: the inverse of how `goal ⊕ off` does, which is the identity but for the base.
        let (_, by_off) = self.mechanism.integrate_derivatives(&off);
        let mut jacobian = SMatrix::<f64, NV, NV>::identity();
        let base = by_off.fixed_view::<6, 6>(0, 0).into_owned().try_inverse().unwrap_or_default();
        jacobian.fixed_view_mut::<6, 6>(0, 0).copy_from(&base);
        model.q = jacobian.tr_mul(&off) * of_q;
        model.qq = jacobian.tr_mul(&jacobian) * of_q;
        model
    }

    fn linearise<const NV: usize, const NU: usize>(&self, all: &mut Trajectory<NQ, NV, NU>) -> Value<f64, NV>
    where
        M: RheonomicDerivatives<NQ, NV, NU, Scalar = f64>,
    {
        all.nodes.clear();
        for (state, u) in all.states.iter().zip(&all.inputs) {
            let step = discrete::transition(self.mechanism, &self.method, 0.0, &state.0, &state.1, u);
            let Value { q, v, qq, vv, .. } = self.model(state, [PERIOD, 0.1 * PERIOD]);
            let (effort, one) = (1e-2 * PERIOD, SMatrix::<f64, NU, NU>::identity());
            let cost = Quadratic { q, v, qq, vv, u: u * effort, uu: one * effort, ..Quadratic::zeros() };
            all.nodes.push((step.expect("it moves"), cost));
        }
        self.model(&all.states[NODES], [100.0, 1.0])
    }

    fn backward<const NV: usize, const NU: usize>(
        &self,
        all: &mut Trajectory<NQ, NV, NU>,
        last: &Value<f64, NV>,
    ) {
        let mut to_go = *last;
        for ((step, cost), policy) in all.nodes.iter().zip(&mut all.policies).rev() {
            (*policy, to_go) = backward(step, cost, &to_go, 0.0).expect("it is convex");
        }
    }

    /// The motion with the policies, and its costs.
    fn rollout<const NV: usize, const NU: usize>(
        &self,
        all: &Trajectory<NQ, NV, NU>,
        next: &mut (Vec<State<NQ, NV>>, Vec<SVector<f64, NU>>),
    ) -> f64
    where
        M: RheonomicDerivatives<NQ, NV, NU, Scalar = f64>,
    {
        let (mut state, mut costs) = (all.states[0], 0.0);
        next.0.clear();
        next.1.clear();
        for ((policy, u), old) in all.policies.iter().zip(&all.inputs).zip(&all.states) {
            let off = self.mechanism.difference(&old.0, &state.0);
            let u = u + policy.change + policy.by_q * off + policy.by_v * (state.1 - old.1);
            costs += self.of_state(&state, [PERIOD, 0.1 * PERIOD]) + 0.5 * 1e-2 * PERIOD * u.norm_squared();
            next.0.push(state);
            next.1.push(u);
            state =
                discrete::step(self.mechanism, &self.method, 0.0, &state.0, &state.1, &u).expect("it moves");
        }
        next.0.push(state);
        costs + self.of_state(&state, [100.0, 1.0])
    }
}

fn measure<M, const NQ: usize, const NV: usize, const NU: usize>(name: &str, mechanism: &M) -> String
where
    M: RheonomicDerivatives<NQ, NV, NU, Scalar = f64>,
{
    // A flying body moves its legs and turns by it.
    let base = if NQ == NV { 0 } else { 6 };
    let at = |x: f64| {
        let displacement = SVector::from_fn(|k, _| if k < base { 0.0 } else { x });
        mechanism.integrate(&mechanism.neutral(), &displacement)
    };
    let problem = Problem { mechanism, method: SemiImplicitEuler::step(PERIOD), goal: at(-0.2) };
    let held = mechanism.inverse_dynamics(0.0, &at(0.1), &SVector::zeros(), &SVector::zeros());
    let none = Policy {
        change: SVector::zeros(),
        by_q: SMatrix::zeros(),
        by_v: SMatrix::zeros(),
        expected: [0.0; 2],
    };
    let mut all = Trajectory {
        states: vec![(at(0.1), SVector::zeros()); NODES + 1],
        // What holds an arm still where it begins; nothing holds a flying body.
        inputs: vec![SVector::from_fn(|k, _| if NU == NV { held[k] } else { 0.0 }); NODES],
        nodes: Vec::with_capacity(NODES),
        policies: vec![none; NODES],
    };
    let mut next = (Vec::with_capacity(NODES + 1), Vec::with_capacity(NODES));
    problem.rollout(&all, &mut next);
    (all.states, all.inputs) = next.clone();
    let mut costs = Vec::new();
    for _ in 0..ITERATIONS {
        let last = problem.linearise(&mut all);
        problem.backward(&mut all, &last);
        costs.push(problem.rollout(&all, &mut next));
        (all.states, all.inputs) = next.clone();
    }
    let linearise = least(|| {
        std::hint::black_box(problem.linearise(&mut all));
    });
    let last = problem.linearise(&mut all);
    let backward = least(|| problem.backward(&mut all, &last));
    let rollout = least(|| {
        std::hint::black_box(problem.rollout(&all, &mut next));
    });
    format!(
        "\"{name}\": {{\"linearise\": {linearise}, \"backward\": {backward}, \"rollout\": {rollout}, \"costs\": {costs:?}}}"
    )
}

fn main() {
    println!("{{{}, {}}}", measure("panda", &Panda), measure("solo", &Solo));
}
