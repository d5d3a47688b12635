//! Iterations of an iterative linear-quadratic regulator (iLQR) on an arm, a flying quadruped and a trotting
//! one. Prints the nanoseconds per node of each phase and the costs of the iterates as JSON for
//! `benches/peers/optimal.py`, which has the same problems for Crocoddyl.

use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::optimal::{Policy, Quadratic, Value, backward_into};
use linkwork::prelude::*;
use linkwork::{Derivatives, discrete};
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;

mod trot;

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
/// Weights of configuration and velocity in the cost of the last state.
const LAST: [f64; 2] = [100.0, 1.0];
/// Weights of configuration and velocity in the other states, and of inputs, each per period.
const RUNNING: [f64; 2] = [PERIOD, 0.1 * PERIOD];
const EFFORT: f64 = 1e-2 * PERIOD;

/// Returns the processor time of a call, divided by the number of nodes, ns: the minimum over many
/// repetitions.
fn minimum_time_per_node(nodes: usize, mut f: impl FnMut()) -> f64 {
    let cpu_time_in_nanoseconds = || {
        let time = clock_gettime(ClockId::ProcessCPUTime);
        time.tv_sec as f64 * 1e9 + time.tv_nsec as f64
    };
    let times = (0..REPEATS).map(|_| {
        let begin = cpu_time_in_nanoseconds();
        f();
        cpu_time_in_nanoseconds() - begin
    });
    times.fold(f64::INFINITY, f64::min) / nodes as f64
}

type State<const NQ: usize, const NV: usize> = (SVector<f64, NQ>, SVector<f64, NV>);
type TransitionWithCosts<const NQ: usize, const NV: usize, const NU: usize> =
    (discrete::Transition<f64, NQ, NV, NU>, Quadratic<f64, NV, NU>);

/// Optimal-control problem: a mechanism with its integrator and its target state.
struct Problem<'m, M, const NQ: usize> {
    mechanism: &'m M,
    method: SemiImplicitEuler<f64>,
    goal: SVector<f64, NQ>,
}

/// Trajectory with the feedback policies of an iteration, each in one allocation.
struct Trajectory<const NQ: usize, const NV: usize, const NU: usize> {
    states: Vec<State<NQ, NV>>,
    inputs: Vec<SVector<f64, NU>>,
    policies: Vec<Policy<f64, NV, NU>>,
}

impl<M, const NQ: usize> Problem<'_, M, NQ> {
    /// Returns the cost of a state: half of the weighted squares of the distance to the goal and of the
    /// velocity.
    fn cost_of_state<const NV: usize, const NU: usize>(
        &self,
        (q, v): &State<NQ, NV>,
        weights: [f64; 2],
    ) -> f64
    where
        M: Derivatives<NQ, NV, NU, Scalar = f64>,
    {
        let off = self.mechanism.difference(&self.goal, q);
        0.5 * (weights[0] * off.norm_squared() + weights[1] * v.norm_squared())
    }

    /// Writes the gradients with respect to configuration and velocity, and the block of the Hessian that
    /// depends on the state, without the curvature of the difference (Gauss-Newton approximation).
    fn write_cost_derivatives<const NV: usize, const NU: usize>(
        &self,
        (q, v): &State<NQ, NV>,
        [of_q, of_v]: [f64; 2],
        [by_q, by_v]: [&mut SVector<f64, NV>; 2],
        qq: &mut SMatrix<f64, NV, NV>,
    ) where
        M: Derivatives<NQ, NV, NU, Scalar = f64>,
    {
        let off = self.mechanism.difference(&self.goal, q);
        (*by_v, *by_q) = (v * of_v, off * of_q);
        if NQ != NV {
            // Jacobian of the difference: the identity except for the base.
            let (_, changes) = self.mechanism.tangent_rate_derivatives(&off, v);
            let base = changes.fixed_view::<6, 6>(0, 0).into_owned();
            let gradient = base.tr_mul(&by_q.fixed_rows::<6>(0));
            by_q.fixed_rows_mut::<6>(0).copy_from(&gradient);
            qq.fixed_view_mut::<6, 6>(0, 0).copy_from(&(base.tr_mul(&base) * of_q));
        }
    }

    /// Returns the cost of the last state and its derivatives.
    fn final_state_cost<const NV: usize, const NU: usize>(&self, state: &State<NQ, NV>) -> Value<f64, NV>
    where
        M: Derivatives<NQ, NV, NU, Scalar = f64>,
    {
        let mut all = Value::zeros();
        let Value { q, v, qq, vv, .. } = &mut all;
        (*qq, *vv) = (SMatrix::identity() * LAST[0], SMatrix::identity() * LAST[1]);
        self.write_cost_derivatives(state, LAST, [q, v], qq);
        all
    }

    /// Writes the transition of a step with its Jacobians, and the cost of its initial state. The constant
    /// Hessians of the node are already set.
    fn linearise_node<const NV: usize, const NU: usize>(
        &self,
        state: &State<NQ, NV>,
        u: &SVector<f64, NU>,
        (step, cost): &mut TransitionWithCosts<NQ, NV, NU>,
    ) where
        M: Derivatives<NQ, NV, NU, Scalar = f64>,
    {
        discrete::transition_into(self.mechanism, &self.method, 0.0, &state.0, &state.1, u, step)
            .expect("it moves");
        let Quadratic { q, v, qq, .. } = cost;
        self.write_cost_derivatives(state, RUNNING, [q, v], qq);
        cost.u = u * EFFORT;
    }

    /// Evaluates all nodes from the last to the first, and passes each to `then`.
    fn evaluate_nodes_backwards<const NV: usize, const NU: usize>(
        &self,
        states: &[State<NQ, NV>],
        inputs: &[SVector<f64, NU>],
        mut then: impl FnMut(usize, &TransitionWithCosts<NQ, NV, NU>),
    ) where
        M: Derivatives<NQ, NV, NU, Scalar = f64>,
    {
        let (qq, vv) = (SMatrix::identity() * RUNNING[0], SMatrix::identity() * RUNNING[1]);
        let costs = Quadratic { qq, vv, uu: SMatrix::identity() * EFFORT, ..Quadratic::zeros() };
        let mut node = (discrete::Transition::zeros(), costs);
        for (k, (state, u)) in states.iter().zip(inputs).enumerate().rev() {
            self.linearise_node(state, u, &mut node);
            then(k, &node);
        }
    }

    /// Linearises and runs the backward recursion; of each node only the policy is stored.
    fn backward_sweep<const NV: usize, const NU: usize>(&self, all: &mut Trajectory<NQ, NV, NU>)
    where
        M: Derivatives<NQ, NV, NU, Scalar = f64>,
    {
        let Trajectory { states, inputs, policies } = all;
        let mut to_go = self.final_state_cost(&states[NODES]);
        self.evaluate_nodes_backwards(states, inputs, |k, (step, cost)| {
            backward_into(step, cost, 0.0, &mut policies[k], &mut to_go).expect("it is convex");
        });
    }

    /// Simulates the motion under the policies, and returns its cost.
    fn cost_of_simulated_policies<const NV: usize, const NU: usize>(
        &self,
        all: &Trajectory<NQ, NV, NU>,
        next: &mut (Vec<State<NQ, NV>>, Vec<SVector<f64, NU>>),
    ) -> f64
    where
        M: Derivatives<NQ, NV, NU, Scalar = f64>,
    {
        let (mut state, mut costs) = (all.states[0], 0.0);
        next.0.clear();
        next.1.clear();
        for ((policy, u), old) in all.policies.iter().zip(&all.inputs).zip(&all.states) {
            let off = self.mechanism.difference(&old.0, &state.0);
            let u = u + policy.inputs(1.0, &off, &(state.1 - old.1));
            costs += self.cost_of_state(&state, RUNNING) + 0.5 * EFFORT * u.norm_squared();
            next.0.push(state);
            next.1.push(u);
            state =
                discrete::step(self.mechanism, &self.method, 0.0, &state.0, &state.1, &u).expect("it moves");
        }
        next.0.push(state);
        costs + self.cost_of_state(&state, LAST)
    }

    fn measure_optimal_control<const NV: usize, const NU: usize>(
        &self,
        name: &str,
        start: SVector<f64, NQ>,
        inputs: Vec<SVector<f64, NU>>,
    ) -> String
    where
        M: Derivatives<NQ, NV, NU, Scalar = f64>,
    {
        let mut all = Trajectory {
            states: vec![(start, SVector::zeros()); NODES + 1],
            inputs,
            policies: vec![Policy::zeros(); NODES],
        };
        let mut next = (Vec::with_capacity(NODES + 1), Vec::with_capacity(NODES));
        let inputs: Vec<_> = all.inputs.iter().map(|u| u.as_slice().to_vec()).collect();
        self.cost_of_simulated_policies(&all, &mut next);
        (all.states, all.inputs) = next.clone();
        let mut costs = Vec::new();
        for _ in 0..ITERATIONS {
            self.backward_sweep(&mut all);
            costs.push(self.cost_of_simulated_policies(&all, &mut next));
            (all.states, all.inputs) = next.clone();
        }
        let linearise = minimum_time_per_node(NODES, || {
            self.evaluate_nodes_backwards(&all.states, &all.inputs, |_, node| {
                black_box(node);
            });
        });
        let mut kept = Vec::new();
        self.evaluate_nodes_backwards(&all.states, &all.inputs, |_, node| kept.push(*node));
        let last = self.final_state_cost(&all.states[NODES]);
        let backwards = minimum_time_per_node(NODES, || {
            let mut to_go = last;
            for (k, (step, cost)) in (0..NODES).rev().zip(&kept) {
                backward_into(step, cost, 0.0, &mut all.policies[k], &mut to_go).expect("it is convex");
            }
        });
        let sweep = minimum_time_per_node(NODES, || self.backward_sweep(&mut all));
        let rollout = minimum_time_per_node(NODES, || {
            black_box(self.cost_of_simulated_policies(&all, &mut next));
        });
        format!(
            "\"{name}\": {{\"linearise\": {linearise}, \"backward\": {backwards}, \"sweep\": {sweep}, \
             \"rollout\": {rollout}, \"costs\": {costs:?}, \"start\": {:?}, \"goal\": {:?}, \"inputs\": \
             {inputs:?}}}",
            start.as_slice(),
            self.goal.as_slice()
        )
    }
}

fn main() {
    let method = SemiImplicitEuler::step(PERIOD);
    let equal_joint_values = |x: f64| SVector::<f64, 7>::repeat(x);
    // Torques that hold the arm at rest in its initial configuration.
    let held = Panda.inverse_dynamics(&equal_joint_values(0.1), &SVector::zeros(), &SVector::zeros());
    let panda = Problem { mechanism: &Panda, method, goal: equal_joint_values(-0.2) }
        .measure_optimal_control("panda", equal_joint_values(0.1), vec![held; NODES]);

    // A flying body moves its legs and rotates by reaction.
    let neutral_with_joint_offset = |x: f64| {
        let displacement = SVector::from_fn(|k, _| if k < 6 { 0.0 } else { x });
        Solo.integrate(&Solo.neutral(), &displacement)
    };
    let solo = Problem { mechanism: &Solo, method, goal: neutral_with_joint_offset(-0.2) }
        .measure_optimal_control("solo", neutral_with_joint_offset(0.1), vec![SVector::zeros(); NODES]);
    println!("{{{panda}, {solo}, {}}}", trot::measure_trot());
}
