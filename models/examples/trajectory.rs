//! Swing-up of a cart-pole along an optimal trajectory. It is found by an iterative linear-quadratic
//! regulator (iLQR) and by differential dynamic programming (DDP), with generated first and second
//! derivatives of the discrete step.
//!
//! ```text
//! cargo run --release --example trajectory -p linkwork-models
//! ```

use linkwork::discrete;
use linkwork::optimal::{Policy, Quadratic, Value, backward};
use linkwork::prelude::*;
use std::f64::consts::PI;

/// Test mechanism of the optimisation: cart on a rail, with a pole that hangs down at zero.
#[mechanism(gravity = -9.81 * y, second_derivatives)]
struct HangingCartPole {
    #[body(mass = 1)]
    cart: Body,
    #[body(mass = 0.3, com = -0.4 * y, inertia = rod(0.3, 0.8, y))]
    pole: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    hinge: Pin,
    #[acts(on = rail)]
    push: Force,
}

/// Position of the cart, m, and angle of the pole, rad; or the rates of these two.
type CartPoleVector = SVector<f64, 2>;
type PushForce = SVector<f64, 1>;
/// Feedback policies of all steps of the trajectory.
type Policies = [Policy<f64, 2, 1>; STEPS];

/// Number of steps of the trajectory, and the period of each, s.
const STEPS: usize = 60;
const PERIOD: f64 = 0.03;
/// Runge–Kutta method that integrates one period of the trajectory.
const METHOD: Rk4<f64> = Rk4::step(PERIOD);

/// Trajectory: all states including the initial one, and the inputs between them.
#[derive(Clone)]
struct PlannedTrajectory {
    states: [(CartPoleVector, CartPoleVector); STEPS + 1],
    inputs: [PushForce; STEPS],
}

/// Returns the final configuration: the cart at its initial position, the pole upright.
fn goal_configuration() -> CartPoleVector {
    [0.0, PI].into()
}

/// Returns the cost of a step, to second order in the input force, which is the only running cost.
fn step_costs(u: &PushForce) -> Quadratic<f64, 2, 1> {
    let weight = 0.02 * PERIOD;
    Quadratic { u: u * weight, uu: [weight].into(), ..Quadratic::zeros() }
}

/// Returns the cost of the final state to second order.
fn terminal_cost_to_go(q: &CartPoleVector, v: &CartPoleVector) -> Value<f64, 2> {
    let weight = SMatrix::from_diagonal_element(100.0);
    Value { q: (q - goal_configuration()) * 100.0, v: v * 100.0, qq: weight, vv: weight, ..Value::zeros() }
}

impl PlannedTrajectory {
    fn total_costs(&self) -> f64 {
        let pushes: f64 = self.inputs.iter().map(|u| step_costs(u).u.dot(u) / 2.0).sum();
        let (q, v) = self.states[STEPS];
        pushes + 50.0 * ((q - goal_configuration()).norm_squared() + v.norm_squared())
    }

    /// Returns the trajectory from the same initial state under feedback policies about this one, with the
    /// step length `α` of their changes.
    fn follow_policies(&self, policies: &Policies, length: f64) -> Result<Self, Error> {
        let mut next = self.clone();
        for (k, policy) in policies.iter().enumerate() {
            let ((q, v), (old_q, old_v)) = (next.states[k], self.states[k]);
            next.inputs[k] = self.inputs[k] + policy.inputs(length, &(q - old_q), &(v - old_v));
            next.states[k + 1] = discrete::step(&HangingCartPole {}, &METHOD, 0.0, &q, &v, &next.inputs[k])?;
        }
        Ok(next)
    }

    /// Returns the optimal policies to second order about this trajectory, and the expected reduction of the
    /// cost; `None` if the cost is not convex in an input. DDP includes the curvature of the dynamics, iLQR
    /// does not.
    fn optimal_policies(&self, ddp: bool, regularisation: f64) -> Result<Option<(Policies, f64)>, Error> {
        let none = Policy {
            change: SVector::zeros(),
            by_q: SMatrix::zeros(),
            by_v: SMatrix::zeros(),
            expected: [0.0; 2],
        };
        let (m, mut policies, mut saved) = (HangingCartPole {}, [none; STEPS], 0.0);
        let (q, v) = self.states[STEPS];
        let mut to_go = terminal_cost_to_go(&q, &v);
        for k in (0..STEPS).rev() {
            let ((q, v), u) = (&self.states[k], &self.inputs[k]);
            let step = discrete::transition(&m, &METHOD, 0.0, q, v, u)?;
            let mut costs = step_costs(u);
            if ddp {
                let factors = (&to_go.q, &to_go.v);
                let curvature = discrete::second_order(&m, &METHOD, 0.0, q, v, u, factors)?;
                costs = costs.with_curvature(&curvature);
            }
            let Ok((policy, before)) = backward(&step, &costs, &to_go, regularisation) else {
                return Ok(None);
            };
            (policies[k], to_go) = (policy, before);
            saved -= policy.expected[0] + policy.expected[1];
        }
        Ok(Some((policies, saved)))
    }
}

/// Trajectory that an optimisation method has found, with the largest change of the force in each iteration,
/// N.
struct OptimisedTrajectory {
    best: PlannedTrajectory,
    changes: Vec<f64>,
}

/// Improves a trajectory until its forces converge.
fn optimise_trajectory(start: &PlannedTrajectory, ddp: bool) -> Result<OptimisedTrajectory, Error> {
    let (mut best, mut regularisation, mut changes) = (start.clone(), 1e-3, Vec::new());
    for _ in 0..500 {
        let Some((policies, saved)) = best.optimal_policies(ddp, regularisation)? else {
            regularisation = (4.0 * regularisation).max(1e-6);
            continue;
        };
        // Line search: the step length is halved until the cost decreases by a fraction of the expected
        // reduction. Near the optimum rounding errors exceed the reduction. Much too long steps lead to
        // states that are not finite.
        let lengths = (0..10).map(|k| 0.5_f64.powi(k));
        let mut tried = lengths.filter_map(|length| best.follow_policies(&policies, length).ok());
        let has_sufficient_decrease = |next: &PlannedTrajectory| {
            saved < 1e-11 || next.total_costs() < best.total_costs() - 1e-4 * saved
        };
        let Some(next) = tried.find(has_sufficient_decrease) else {
            regularisation = (4.0 * regularisation).max(1e-6);
            continue;
        };
        let moved = next.inputs.iter().zip(&best.inputs).map(|(new, old)| (new - old).amax());
        changes.push(moved.fold(0.0, f64::max));
        best = next;
        regularisation = if regularisation < 1e-7 { 0.0 } else { regularisation / 4.0 };
        if changes.last() < Some(&1e-7) {
            break;
        }
    }
    Ok(OptimisedTrajectory { best, changes })
}

fn main() -> Result<(), Error> {
    // Initial guess: the pole hangs, and the cart is pushed back and forth slightly.
    let mut start = PlannedTrajectory {
        states: [(CartPoleVector::zeros(), CartPoleVector::zeros()); STEPS + 1],
        inputs: [PushForce::zeros(); STEPS],
    };
    for (k, u) in start.inputs.iter_mut().enumerate() {
        u[0] = 2.0 * (4.0 * PERIOD * k as f64).sin();
        let (q, v) = start.states[k];
        start.states[k + 1] = discrete::step(&HangingCartPole {}, &METHOD, 0.0, &q, &v, u)?;
    }
    let [ilqr, ddp] = [optimise_trajectory(&start, false)?, optimise_trajectory(&start, true)?];

    println!("time, s   cart, m   pole, rad   push, N");
    for k in (0..STEPS).step_by(6) {
        let ((q, _), u) = (ddp.best.states[k], ddp.best.inputs[k]);
        println!("{:7.2} {:9.3} {:11.3} {:9.2}", PERIOD * k as f64, q[0], q[1], u[0]);
    }
    println!("\nlargest change of a push, N, in the last iterations");
    for (name, found) in [("iLQR", &ilqr), ("DDP", &ddp)] {
        let (count, costs) = (found.changes.len(), found.best.total_costs());
        let last = found.changes[count - 6..].iter().map(|change| format!("{change:.1e}"));
        println!("{name:5} {count:3} iterations, costs {costs:.6}: {}", last.collect::<Vec<_>>().join(" "));
    }

    // Both methods have the same final state, with the pole upright.
    let (end, _) = ddp.best.states[STEPS];
    assert!((end - goal_configuration()).amax() < 0.05, "it is swung up");
    for (a, b) in ilqr.best.inputs.iter().zip(&ddp.best.inputs) {
        assert!((a - b).amax() < 1e-5, "one trajectory is the best");
    }
    // Near the optimum an iteration of DDP squares the error, and one of iLQR reduces it by a factor.
    for pair in ddp.changes[ddp.changes.len() - 3..].windows(2) {
        assert!(pair[1] < 2.0 * pair[0] * pair[0], "quadratic convergence");
    }
    for pair in ilqr.changes[ilqr.changes.len() - 6..].windows(2) {
        assert!(pair[1] > 0.5 * pair[0], "linear convergence");
    }
    Ok(())
}

#[test]
fn swing_up_reaches_upright() -> Result<(), Error> {
    main()
}
