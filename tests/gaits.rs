//! Checks of optimal control with a prescribed sequence of contacts: one leg hops from stance through flight
//! and touchdown back to stance.

use linkwork::contact::{self, HeldDerivatives, Touch};
use linkwork::discrete::{self, Transition};
use linkwork::optimal::{Policy, Quadratic, Value, backward_into};
use linkwork::prelude::*;

/// Trunk that stays upright, on a leg that swings and telescopes.
#[mechanism(gravity = -9.81 * y, derivatives)]
struct Hopper {
    #[body(mass = 5)]
    trunk: Body,
    #[joint(ground -> trunk, along = (x, y))]
    air: Stage,
    #[body(mass = 0.4, com = -0.1 * y, inertia = rod(0.4, 0.2, y))]
    thigh: Body,
    #[joint(trunk -> thigh, about = z)]
    hip: Pin,
    #[body(mass = 0.2, com = -0.1 * y, inertia = rod(0.2, 0.2, y))]
    shank: Body,
    #[joint(thigh.at(-0.2 * y) -> shank, along = y)]
    knee: Sleeve,
    #[acts(on = hip)]
    motor: Torque,
    #[acts(on = knee)]
    piston: Force,
    #[contact(shank.at(-0.2 * y), ground.plane(y), friction = 0.9)]
    foot: Contact,
}

type State = (SVector<f64, 4>, SVector<f64, 4>);
type Inputs = SVector<f64, 2>;

const PERIOD: f64 = 0.01;
/// Index of the first node in flight, index of the touchdown, and the number of nodes.
const LEAVES: usize = 12;
const LANDS: usize = 24;
const NODES: usize = 34;
/// Weights of inputs, of ground forces, of the foot's height at touchdown, and of the last state.
const EFFORT: f64 = 1e-3;
const FORCES: f64 = 1e-5;
const HEIGHT: f64 = 1e4;
const LAST: f64 = 200.0;

/// Returns the contact mode in a node, `None` at the touchdown.
fn contact_mode_of_node(k: usize) -> Option<Touch> {
    match k {
        LANDS => None,
        k if (LEAVES..LANDS).contains(&k) => Some(Touch::Open),
        _ => Some(Touch::Sticks),
    }
}

/// Returns the state after a node, and the cost of the node.
fn state_and_cost_after_node(k: usize, (q, v): &State, u: &Inputs) -> (State, f64) {
    let m = Hopper {};
    let effort = EFFORT / 2.0 * u.norm_squared();
    let Some(touch) = contact_mode_of_node(k) else {
        let landed = contact::land(&m, 0.0, q, v, &[Touch::Sticks]).expect("the foot can land");
        return ((*q, landed.v), effort + HEIGHT / 2.0 * m.contact_gaps(q).norm_squared());
    };
    let held = contact::hold(&m, [touch]).with_gains(0.0, 50.0);
    let found = held.held(0.0, q, v, &m.generalized_forces(q, u)).expect("it moves");
    let v = v + found.a * PERIOD;
    ((m.integrate(q, &(v * PERIOD)), v), effort + FORCES / 2.0 * found.forces.norm_squared())
}

/// Returns the cost of the last state and its derivatives. The goal is 0.3 m ahead, upright and at rest.
fn terminal_cost((q, v): &State) -> (f64, Value<f64, 4>) {
    let (off, one) = (q - SVector::from([0.3, 0.4, 0.0, 0.0]), SMatrix::identity() * LAST);
    let costs = LAST / 2.0 * (off.norm_squared() + v.norm_squared());
    (costs, Value { q: off * LAST, v: v * LAST, qq: one, vv: one, ..Value::zeros() })
}

/// Returns the states of the motion from the start, and its total cost.
fn states_and_total_cost(start: &State, inputs: &[Inputs]) -> (Vec<State>, f64) {
    let (mut states, mut sum) = (vec![*start], 0.0);
    for (k, u) in inputs.iter().enumerate() {
        let (next, cost) = state_and_cost_after_node(k, &states[k], u);
        states.push(next);
        sum += cost;
    }
    let end = terminal_cost(&states[inputs.len()]).0;
    (states, sum + end)
}

/// Returns the transition of a node to first order, and its cost to second order.
fn transition_and_cost(
    k: usize,
    (q, v): &State,
    u: &Inputs,
    found: &mut HeldDerivatives<f64, 4, 2>,
) -> (Transition<f64, 4, 4, 2>, Quadratic<f64, 4, 2>) {
    let m = Hopper {};
    let mut cost = Quadratic { u: u * EFFORT, uu: SMatrix::identity() * EFFORT, ..Quadratic::zeros() };
    let Some(touch) = contact_mode_of_node(k) else {
        let landed = contact::land_derivatives(&m, 0.0, q, v, &[Touch::Sticks]).expect("the foot can land");
        let rise = m.contact_jacobian(q).fixed_rows::<1>(0).into_owned();
        cost.add_squares_of_configuration(HEIGHT, &m.contact_gaps(q), &rise);
        return (landed.transition(q), cost);
    };
    let held = contact::hold(&m, [touch]).with_gains(0.0, 50.0);
    let (tau, mut step) = (m.generalized_forces(q, u), Transition::zeros());
    held.held_derivatives_into(0.0, q, v, &tau, found).expect("it moves");
    let by_u = found.by_tau.fixed_columns::<2>(2).into_owned();
    discrete::semi_implicit_into(
        &held,
        PERIOD,
        (q, v),
        &found.a,
        (&found.by_q, &found.by_v, &by_u),
        &mut step,
    );
    let forces_by_u = found.forces_by_tau.fixed_columns::<2>(2).into_owned();
    cost.add_squares(FORCES, &found.forces, (&found.forces_by_q, &found.forces_by_v, &forces_by_u));
    (step, cost)
}

/// Returns the largest derivative of the total cost with respect to an input, by differences of sixth order
/// of the whole motion.
fn largest_input_cost_derivative(start: &State, inputs: &[Inputs]) -> f64 {
    let mut most = 0.0_f64;
    for k in 0..NODES {
        for i in 0..2 {
            let cost_with_changed_input = |s: f64| {
                let mut moved = inputs.to_vec();
                moved[k][i] += s;
                states_and_total_cost(start, &moved).1
            };
            let h = 1e-2;
            let central_difference =
                |n: f64| cost_with_changed_input(n * h) - cost_with_changed_input(-n * h);
            most = most.max(
                ((45.0 * central_difference(1.0) - 9.0 * central_difference(2.0) + central_difference(3.0))
                    / (60.0 * h))
                    .abs(),
            );
        }
    }
    most
}

/// The iterative linear-quadratic regulator finds a motion whose cost is stationary with respect to every
/// input. Differences of the whole motion, which use no derivatives, confirm that.
#[test]
fn optimised_hop_is_stationary_in_every_input() {
    let start: State = ([0.0, 0.38, 0.1, 0.02].into(), SVector::zeros());
    // All inputs of the initial guess are zero.
    let mut inputs = vec![SVector::from([0.0, 0.0]); NODES];
    let (mut states, mut cost) = states_and_total_cost(&start, &inputs);
    let (first, begin) = (cost, largest_input_cost_derivative(&start, &inputs));
    let mut found = HeldDerivatives::zeros();
    for _ in 0..400 {
        let mut policies = vec![Policy::zeros(); NODES];
        let mut to_go = terminal_cost(&states[NODES]).1;
        for k in (0..NODES).rev() {
            let (step, costs) = transition_and_cost(k, &states[k], &inputs[k], &mut found);
            backward_into(&step, &costs, 0.0, &mut policies[k], &mut to_go).expect("it is convex");
        }
        let tried = (0..20).map(|halved| 0.5_f64.powi(halved)).find_map(|length| {
            let (mut next, mut changed, mut sum) = (vec![start], Vec::new(), 0.0);
            for (k, policy) in policies.iter().enumerate() {
                let (q, v) = next[k];
                let u = inputs[k] + policy.inputs(length, &(q - states[k].0), &(v - states[k].1));
                let (state, cost) = state_and_cost_after_node(k, &next[k], &u);
                next.push(state);
                changed.push(u);
                sum += cost;
            }
            sum += terminal_cost(&next[NODES]).0;
            (sum < cost).then_some((next, changed, sum))
        });
        let Some((next, changed, less)) = tried else { break };
        let settled = cost - less < 1e-13 * cost;
        (states, inputs, cost) = (next, changed, less);
        if settled {
            break;
        }
    }
    let end = largest_input_cost_derivative(&start, &inputs);
    assert!(end < 1e-6 * begin, "{begin:e} {end:e}");
    assert!(cost < 0.1 * first, "{first} {cost}");
    // The foot leaves the ground and touches down at the prescribed node.
    let m = Hopper {};
    let gaps: Vec<f64> = states.iter().map(|(q, _)| m.contact_gaps(q)[0]).collect();
    assert!(gaps[LANDS].abs() < 5e-3, "{gaps:?}");
    let slip = m.contact_rates(&states[NODES].0, &states[NODES].1).amax();
    assert!(slip < 1e-2, "{slip}");
}
