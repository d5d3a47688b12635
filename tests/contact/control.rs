//! Optimal control through contacts without declared modes: a box is pushed to a place, and a body hops.

use linkwork::discrete;
use linkwork::nalgebra::SMatrix;
use linkwork::optimal::{Policy, Quadratic, Value, backward};
use linkwork::prelude::*;

/// Pusher on a rail, and a box on the ground, which it can push but not pull.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct PusherAndBox {
    #[particle(mass = 1)]
    pusher: Particle,
    #[joint(ground -> pusher, along = x)]
    rail: Sleeve,
    #[body(mass = 2)]
    load: Body,
    #[joint(ground -> load, along = (x, y))]
    place: Stage,
    #[acts(on = rail)]
    motor: Force,
    #[contact(pusher, load.plane(-x))]
    side: Contact,
    #[contact(load, ground.plane(y), friction = 0.3)]
    floor: Contact,
}

/// Trunk on a sprung leg with a motor.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct Hopper {
    #[particle(mass = 1)]
    trunk: Particle,
    #[joint(ground -> trunk, along = y)]
    height: Sleeve,
    #[particle(mass = 0.2)]
    toe: Particle,
    #[joint(ground -> toe, along = y)]
    lift: Sleeve,
    #[acts(between = (toe, trunk), stiffness = 200, free_length = 0.5)]
    leg: Spring,
    #[acts(between = (toe, trunk))]
    motor: Force,
    #[contact(toe, ground.plane(y))]
    foot: Contact,
}

type State<const N: usize> = (SVector<f64, N>, SVector<f64, N>);
type Input = SVector<f64, 1>;

/// Goal of a motion, with the weights of the configuration and the velocity at its end and of the inputs.
struct Task<const N: usize> {
    steps: usize,
    goal: SVector<f64, N>,
    weights: [SVector<f64, N>; 2],
    effort: f64,
}

impl<const N: usize> Task<N> {
    fn trajectory_cost(&self, (states, inputs): &(Vec<State<N>>, Vec<Input>)) -> f64 {
        let to_go = self.cost_to_go_at_end(&states[self.steps]);
        let off = states[self.steps].0 - self.goal;
        let effort: f64 = inputs.iter().map(|u| 0.5 * self.effort * u[0] * u[0]).sum();
        effort + 0.5 * (to_go.q.dot(&off) + to_go.v.dot(&states[self.steps].1))
    }

    fn cost_to_go_at_end(&self, (q, v): &State<N>) -> Value<f64, N> {
        let [by_q, by_v] = self.weights.map(|weights| SMatrix::from_diagonal(&weights));
        Value { q: by_q * (q - self.goal), v: by_v * v, qq: by_q, vv: by_v, ..Value::zeros() }
    }

    fn simulate_inputs<M>(
        &self,
        m: &M,
        start: State<N>,
        input: impl Fn(usize, &State<N>) -> Input,
    ) -> (Vec<State<N>>, Vec<Input>)
    where
        M: Derivatives<N, N, 1, Scalar = f64>,
    {
        let (mut states, mut inputs) = (vec![start], Vec::new());
        for k in 0..self.steps {
            let (q, v) = states[k];
            inputs.push(input(k, &states[k]));
            states.push(discrete::step(m, &METHOD, 0.0, &q, &v, &inputs[k]).expect("it moves"));
        }
        (states, inputs)
    }

    /// Improves a trajectory once by iLQR. Returns the trajectory and the predicted change of the cost.
    fn improve_trajectory<M>(
        &self,
        m: &M,
        (states, inputs): &(Vec<State<N>>, Vec<Input>),
    ) -> ((Vec<State<N>>, Vec<Input>), f64)
    where
        M: Derivatives<N, N, 1, Scalar = f64>,
    {
        let (mut to_go, mut predicted) = (self.cost_to_go_at_end(&states[self.steps]), 0.0);
        let mut policies: Vec<Policy<f64, N, 1>> = Vec::new();
        for ((q, v), u) in states.iter().zip(inputs).rev() {
            let step = discrete::transition(m, &METHOD, 0.0, q, v, u).expect("it moves");
            let mut cost = Quadratic::zeros();
            (cost.u, cost.uu[0]) = (u * self.effort, self.effort);
            let policy;
            (policy, to_go) = backward(&step, &cost, &to_go, 0.0).expect("it is convex");
            predicted += policy.expected[0] + policy.expected[1];
            policies.push(policy);
        }
        policies.reverse();
        let feedback_inputs = |k: usize, (q, v): &State<N>| {
            let (from, before) = &states[k];
            inputs[k] + policies[k].inputs(1.0, &(q - from), &(v - before))
        };
        (self.simulate_inputs(m, states[0], feedback_inputs), predicted)
    }

    /// Returns the trajectory after iterations that end with the exact optimum within its contact modes.
    fn optimise_trajectory<M>(&self, m: &M, start: State<N>, input: f64) -> (Vec<State<N>>, Vec<Input>)
    where
        M: Derivatives<N, N, 1, Scalar = f64>,
    {
        let mut trajectory = self.simulate_inputs(m, start, |_, _| [input].into());
        for iteration in 0..6 {
            let (next, predicted) = self.improve_trajectory(m, &trajectory);
            let change = self.trajectory_cost(&next) - self.trajectory_cost(&trajectory);
            assert!(change < 1e-12, "iteration {iteration} changes the cost by {change}");
            trajectory = next;
            if predicted.abs() < 1e-12 {
                return trajectory;
            }
        }
        panic!("it converges in six iterations")
    }
}

const METHOD: TimeStepping<f64> = TimeStepping::step(0.01).midpoint();

/// The box comes to rest near the goal: friction stops it, and the pusher stays in contact.
#[test]
fn box_is_pushed_to_its_goal() {
    let weights = [[0.0, 1e3, 0.0].into(), [0.0, 10.0, 0.0].into()];
    let task = Task { steps: 100, goal: [0.0, 0.5, 0.0].into(), weights, effort: 1e-3 };
    let (states, inputs) =
        task.optimise_trajectory(&PusherAndBox {}, (SVector::zeros(), SVector::zeros()), 7.0);
    let (q, v) = states[100];
    assert!((q[1] - 0.5).abs() < 6e-3 && v[1].abs() < 0.1, "{q} {v}");
    assert!((q[1] - q[0]).abs() < 1e-9 && q[2].abs() < 1e-9, "{q}");
    // Every state satisfies the equation of motion with the friction 0.3 · 2 · 9.81 N.
    for (k, u) in inputs.iter().enumerate() {
        let expected = (u[0] - 0.3 * 2.0 * 9.81) / 3.0;
        assert!((states[k + 1].1[1] - states[k].1[1] - 0.01 * expected).abs() < 1e-9, "{k}");
    }
}

/// The hopper leaves the ground, and its trunk reaches the height at which it is to turn round.
#[test]
fn hopper_reaches_the_required_height() {
    let task = Task {
        steps: 35,
        goal: [0.8, 0.0].into(),
        weights: [[1e3, 0.0].into(), [10.0, 0.0].into()],
        effort: 1e-3,
    };
    let (states, _) = task.optimise_trajectory(&Hopper {}, ([0.3, 0.0].into(), SVector::zeros()), 0.0);
    let (q, v) = states[35];
    assert!((q[0] - 0.8).abs() < 6e-3 && v[0].abs() < 0.02, "{q} {v}");
    assert!(states[5].0[1].abs() < 1e-9 && q[1] > 0.1, "it stands, and then flies");
}
