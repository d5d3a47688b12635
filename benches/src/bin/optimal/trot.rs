//! Trot with a prescribed contact sequence: phases in which feet stick, separated by touchdowns. The gait and
//! its costs are those of Crocoddyl's example `crocoddyl.utils.quadruped.SimpleQuadrupedalGaitProblem`.

use super::{ITERATIONS, State, minimum_time_per_node};
use linkwork::contact::{self, Held, HeldDerivatives, Touch};
use linkwork::nalgebra::{DMatrix, SMatrix, SVector};
use linkwork::optimal::{Policy, Quadratic, Value, backward_into};
use linkwork::prelude::*;
use linkwork::{ConstraintError, discrete};
use std::hint::black_box;

#[mechanism(
    urdf = "../models/urdf/solo12.urdf",
    base = free,
    gravity = -9.81 * z,
    passive = ignore,
    limits = ignore,
    derivatives,
    centroidal
)]
struct Walker {
    #[contact(FL_FOOT, ground.plane(z), friction = 0.7)]
    front_left: Contact,
    #[contact(FR_FOOT, ground.plane(z), friction = 0.7)]
    front_right: Contact,
    #[contact(HL_FOOT, ground.plane(z), friction = 0.7)]
    hind_left: Contact,
    #[contact(HR_FOOT, ground.plane(z), friction = 0.7)]
    hind_right: Contact,
    #[output(r(FL_FOOT / ground))]
    front_left_foot: Vector,
    #[output(r(FR_FOOT / ground))]
    front_right_foot: Vector,
    #[output(r(HL_FOOT / ground))]
    hind_left_foot: Vector,
    #[output(r(HR_FOOT / ground))]
    hind_right_foot: Vector,
}

type SpacePosition = SVector<f64, 3>;
type Configuration = SVector<f64, 19>;
type VelocityVector = SVector<f64, 18>;
type Inputs = SVector<f64, 12>;
type Transition = discrete::Transition<f64, 19, 18, 12>;
type TrotStepCost = Quadratic<f64, 18, 12>;

const PERIOD: f64 = 0.01;
/// Number of nodes of a swing phase.
const SWING: usize = 25;
/// Number of nodes of the stance on four feet before a swing phase.
const STAND: usize = 2;
/// Step length of a swinging foot, m.
const REACH: f64 = 0.1;
/// Maximum height of a swinging foot, m.
const LIFT: f64 = 0.05;
const FRICTION: f64 = 0.7;
/// Gain of the constraint stabilization, by which velocities of sticking feet decay, 1/s.
const DAMPING: f64 = 50.0;
/// Weights of the errors of the centre of mass, of feet in the air, and of feet at touchdown.
const OF_CENTRE: f64 = 1e6;
const OF_FEET: f64 = 1e6;
const OF_LANDINGS: f64 = 1e7;
/// Weights of forces outside of their friction cones, of states, and of inputs.
const OF_CONES: f64 = 1e1;
const OF_STATES: f64 = 1e1;
const OF_INPUTS: f64 = 1e-1;

/// Node of the gait: contact states and targets at one instant.
struct GaitNode {
    touches: [Touch; 4],
    /// Target position of the centre of mass at this node, if any.
    centre: Option<SpacePosition>,
    /// Target positions of the feet at this node.
    feet: [Option<SpacePosition>; 4],
    /// Whether swinging feet touch down at this node.
    lands: bool,
}

/// Returns the position of foot `k` in ground axes.
fn position_of_foot(k: usize, q: &Configuration) -> SpacePosition {
    let m = Walker {};
    match k {
        0 => m.front_left_foot(q),
        1 => m.front_right_foot(q),
        2 => m.hind_left_foot(q),
        _ => m.hind_right_foot(q),
    }
}

fn foot_jacobian(k: usize, q: &Configuration) -> SMatrix<f64, 3, 18> {
    let m = Walker {};
    match k {
        0 => m.front_left_foot_jacobian(q),
        1 => m.front_right_foot_jacobian(q),
        2 => m.hind_left_foot_jacobian(q),
        _ => m.hind_right_foot_jacobian(q),
    }
}

/// Returns two steps of diagonal pairs of feet; the first step has half the length.
fn trot_gait_nodes(start: &Configuration) -> Vec<GaitNode> {
    let mut feet: [SpacePosition; 4] = std::array::from_fn(|k| position_of_foot(k, start));
    let mut centre: SpacePosition = feet.iter().sum::<SpacePosition>() / 4.0;
    centre.z = Walker {}.center_of_mass(start).z;
    let standing_phase =
        || GaitNode { touches: [Touch::Sticks; 4], centre: None, feet: [None; 4], lands: false };
    let mut all = Vec::new();
    for (pair, reach) in [([1, 2], REACH / 2.0), ([0, 3], REACH)] {
        all.extend((0..STAND).map(|_| standing_phase()));
        let held: [bool; 4] = std::array::from_fn(|k| !pair.contains(&k));
        let contact_modes_of_legs =
            |held: [bool; 4]| held.map(|held| if held { Touch::Sticks } else { Touch::Open });
        let mut aimed = [None; 4];
        for k in 0..SWING {
            let (half, part) = (SWING as f64 / 2.0, (k + 1) as f64 / SWING as f64);
            let height = LIFT * if k as f64 <= half { k as f64 / half } else { 2.0 - k as f64 / half };
            let forward = SpacePosition::new(reach * part, 0.0, height);
            pair.iter().for_each(|foot| aimed[*foot] = Some(feet[*foot] + forward));
            let centre = Some(centre + SpacePosition::new(reach * part / 2.0, 0.0, 0.0));
            all.push(GaitNode { touches: contact_modes_of_legs(held), centre, feet: aimed, lands: false });
        }
        all.push(GaitNode {
            touches: contact_modes_of_legs(held.map(|held| !held)),
            centre: None,
            feet: aimed,
            lands: true,
        });
        centre.x += reach / 2.0;
        pair.iter().for_each(|foot| feet[*foot].x += reach);
    }
    all.push(standing_phase());
    all
}

/// Returns the inputs that hold the robot at rest on its feet, up to the wrench that two feet cannot
/// transmit.
fn quasi_static_inputs(q: &Configuration, phase: &GaitNode) -> Inputs {
    let m = Walker {};
    let bias = m.bias_forces(q, &VelocityVector::zeros());
    let jacobian = m.contact_jacobian(q);
    let rows: Vec<usize> = (0..12).filter(|row| phase.touches[row / 3] != Touch::Open).collect();
    let base = DMatrix::from_fn(6, rows.len(), |i, j| jacobian[(rows[j], i)]);
    let wrench = DMatrix::from_fn(6, 1, |i, _| bias[i]);
    let forces = base.svd(true, true).solve(&wrench, 1e-6).expect("both sides were asked for");
    Inputs::from_fn(|i, _| {
        let held: f64 =
            rows.iter().enumerate().map(|(k, row)| jacobian[(*row, 6 + i)] * forces[(k, 0)]).sum();
        bias[6 + i] - held
    })
}

/// Returns the columns of the joints, on which the inputs act.
fn actuated_joint_columns<const R: usize>(by_tau: &SMatrix<f64, R, 18>) -> SMatrix<f64, R, 12> {
    let mut by_u = SMatrix::zeros();
    by_u.data.0.copy_from_slice(&by_tau.data.0[6..]);
    by_u
}

/// Returns the violated rows of the friction cone as coefficients of the normal and tangential forces, each
/// with its violation.
fn violated_cone_rows(force: [f64; 3]) -> impl Iterator<Item = ([f64; 3], f64)> {
    let sides = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]].map(|[x, y]| [-FRICTION, x, y]);
    let [normal, x, y] = force;
    let past = sides.into_iter().map(move |row| (row, row[0] * normal + row[1] * x + row[2] * y));
    let pulls = ([1.0, 0.0, 0.0], normal.min(0.0));
    past.filter(|(_, off)| *off > 0.0).chain(Some(pulls).filter(|(_, off)| *off < 0.0))
}

/// Returns the weights of squares of configuration and velocity in a phase.
fn state_cost_weights(phase: &GaitNode) -> [VelocityVector; 2] {
    let base_and_joint_weights = |base: [f64; 2], joints: f64| {
        VelocityVector::from_fn(|k, _| OF_STATES * if k < 6 { base[k / 3] } else { joints }.powi(2))
    };
    match phase.lands {
        true => [base_and_joint_weights([1.0, 1.0], 10.0), base_and_joint_weights([10.0, 10.0], 10.0)],
        false => [base_and_joint_weights([0.0, 500.0], 0.01), base_and_joint_weights([10.0, 10.0], 1.0)],
    }
}

/// Node of a trajectory: its step to first order and its cost to second order, with working storage.
struct LinearisedTrajectoryNode {
    step: Transition,
    cost: TrotStepCost,
    held: HeldDerivatives<f64, 18, 12>,
    /// Whether the cost has second derivatives that couple configuration, velocity and inputs.
    is_mixed: bool,
}

impl LinearisedTrajectoryNode {
    fn zero_node() -> Self {
        let (step, cost, held) = (Transition::zeros(), Quadratic::zeros(), HeldDerivatives::zeros());
        Self { step, cost, held, is_mixed: false }
    }
}

/// Gait from an initial configuration, which is also the reference of the state costs.
struct TrotGait {
    start: Configuration,
    phases: Vec<GaitNode>,
    weights: Vec<[VelocityVector; 2]>,
}

/// Trajectory with its feedback policies.
struct TrajectoryWithPolicies {
    states: Vec<State<19, 18>>,
    inputs: Vec<Inputs>,
    policies: Vec<Policy<f64, 18, 12>>,
}

impl TrotGait {
    /// Returns the cost of a state and of its contact forces in a node.
    fn cost_of_node(&self, k: usize, (q, v): &State<19, 18>, forces: Option<&SVector<f64, 12>>) -> f64 {
        let (phase, [of_q, of_v]) = (&self.phases[k], &self.weights[k]);
        let off = Walker {}.difference(&self.start, q);
        let mut sum = off.component_mul(&off).dot(of_q) + v.component_mul(v).dot(of_v);
        if let Some(centre) = phase.centre {
            sum += OF_CENTRE * (Walker {}.center_of_mass(q) - centre).norm_squared();
        }
        let of_feet = if phase.lands { OF_LANDINGS } else { OF_FEET };
        for (k, aim) in phase.feet.iter().enumerate() {
            sum += aim.map_or(0.0, |aim| of_feet * (position_of_foot(k, q) - aim).norm_squared());
        }
        for force in forces.map_or(&[][..], |all| all.as_slice().as_chunks::<3>().0) {
            sum += violated_cone_rows(*force).map(|(_, off)| OF_CONES * off * off).sum::<f64>();
        }
        sum / 2.0
    }

    /// Writes the gradients and Hessians of the state's cost, times a factor.
    fn write_cost_derivatives(&self, k: usize, (q, v): &State<19, 18>, factor: f64, cost: &mut TrotStepCost) {
        let (phase, [of_q, of_v]) = (&self.phases[k], &self.weights[k]);
        let off = Walker {}.difference(&self.start, q);
        let (of_q, of_v) = (of_q * factor, of_v * factor);
        (cost.q, cost.v) = (off.component_mul(&of_q), v.component_mul(&of_v));
        cost.qq.set_diagonal(&of_q);
        cost.vv.set_diagonal(&of_v);
        // Jacobian of the difference: the identity except for the base.
        let (_, changes) = Walker {}.tangent_rate_derivatives(&off, v);
        let mut gradient = [0.0; 6];
        for (j, (column, sum)) in changes.data.0.iter().zip(&mut gradient).enumerate() {
            *sum = (0..6).fold(0.0, |sum, i| sum + column[i] * cost.q[i]);
            let weighed: [f64; 6] = std::array::from_fn(|i| column[i] * of_q.data.0[0][i]);
            for (entry, other) in cost.qq.data.0[j].iter_mut().zip(&changes.data.0).take(6) {
                *entry = (0..6).fold(0.0, |sum, i| sum + other[i] * weighed[i]);
            }
        }
        cost.q.data.0[0][..6].copy_from_slice(&gradient);
        if let Some(centre) = phase.centre {
            let by_q = Walker {}.centroidal_momentum_matrix(q).fixed_rows::<3>(0) / Walker {}.total_mass();
            let off = Walker {}.center_of_mass(q) - centre;
            cost.add_squares_of_configuration(OF_CENTRE * factor, &off, &by_q);
        }
        let of_feet = factor * if phase.lands { OF_LANDINGS } else { OF_FEET };
        for (k, aim) in phase.feet.iter().enumerate() {
            if let Some(aim) = aim {
                let off = position_of_foot(k, q) - aim;
                cost.add_squares_of_configuration(of_feet, &off, &foot_jacobian(k, q));
            }
        }
    }

    /// Evaluates a node to first order, with its cost to second order.
    fn linearise_node(
        &self,
        k: usize,
        state: &State<19, 18>,
        u: &Inputs,
        node: &mut LinearisedTrajectoryNode,
    ) -> Result<(), ConstraintError> {
        let ((q, v), phase) = (state, &self.phases[k]);
        let LinearisedTrajectoryNode { step, cost, held: found, is_mixed } = node;
        (cost.qq, cost.vv, cost.uu, cost.u) = Default::default();
        if *is_mixed {
            (cost.qv, cost.qu, cost.vu, *is_mixed) = Default::default();
        }
        if phase.lands {
            *step = contact::land_derivatives(&Walker {}, 0.0, q, v, &phase.touches)?.transition(q);
            self.write_cost_derivatives(k, state, 1.0, cost);
            // Inputs have no effect at a touchdown: with this cost they are zero.
            cost.uu.fill_diagonal(1.0);
            return Ok(());
        }
        self.write_cost_derivatives(k, state, PERIOD, cost);
        let held = contact::hold(&Walker {}, phase.touches).with_gains(0.0, DAMPING);
        held.held_derivatives_into(0.0, q, v, &Walker {}.generalized_forces(q, u), found)?;
        let by_u = actuated_joint_columns(&found.by_tau);
        let by = (&found.by_q, &found.by_v, &by_u);
        discrete::semi_implicit_into(&held, PERIOD, (q, v), &found.a, by, step);
        cost.u = u * (OF_INPUTS * PERIOD);
        cost.uu.fill_diagonal(OF_INPUTS * PERIOD);
        let (mut gradient, mut hessian) = (SVector::<f64, 12>::zeros(), SMatrix::<f64, 12, 12>::zeros());
        for (k, force) in found.forces.as_slice().as_chunks::<3>().0.iter().enumerate() {
            for (row, off) in violated_cone_rows(*force) {
                *is_mixed = true;
                for (i, x) in row.iter().enumerate() {
                    gradient[3 * k + i] += OF_CONES * PERIOD * off * x;
                    row.iter()
                        .enumerate()
                        .for_each(|(j, y)| hessian[(3 * k + i, 3 * k + j)] += OF_CONES * PERIOD * x * y);
                }
            }
        }
        if *is_mixed {
            let by = (&found.forces_by_q, &found.forces_by_v, &actuated_joint_columns(&found.forces_by_tau));
            cost.add_costs_of(&gradient, &hessian, by);
        }
        Ok(())
    }

    /// Returns the cost of the last state and its derivatives.
    fn final_state_cost(&self, state: &State<19, 18>) -> Value<f64, 18> {
        let mut cost = Quadratic::zeros();
        self.write_cost_derivatives(self.phases.len() - 1, state, 1.0, &mut cost);
        let Quadratic { q, v, qq, qv, vv, .. } = cost;
        Value { q, v, qq, qv, vv }
    }

    /// Linearises the trajectory and runs the backward recursion. Returns the coefficients of the step
    /// length, and of its square, in the expected change of the cost.
    fn backward_sweep(&self, plan: &mut TrajectoryWithPolicies) -> [f64; 2] {
        let mut node = LinearisedTrajectoryNode::zero_node();
        let mut to_go = self.final_state_cost(&plan.states[plan.inputs.len()]);
        let mut expected = [0.0; 2];
        for (k, policy) in plan.policies.iter_mut().enumerate().rev() {
            self.linearise_node(k, &plan.states[k], &plan.inputs[k], &mut node).expect("feet hold");
            backward_into(&node.step, &node.cost, 0.0, policy, &mut to_go).expect("it is convex");
            expected.iter_mut().zip(policy.expected).for_each(|(sum, more)| *sum += more);
        }
        expected
    }

    /// Simulates the motion under the policies, and returns its cost.
    fn cost_of_simulated_policies(
        &self,
        plan: &TrajectoryWithPolicies,
        length: f64,
        next: &mut (Vec<State<19, 18>>, Vec<Inputs>),
    ) -> f64 {
        let (m, mut state, mut sum) = (Walker {}, plan.states[0], 0.0);
        next.0.clear();
        next.1.clear();
        for (k, policy) in plan.policies.iter().enumerate() {
            let (old, phase) = (&plan.states[k], &self.phases[k]);
            let off = m.difference(&old.0, &state.0);
            let u = plan.inputs[k] + policy.inputs(length, &off, &(state.1 - old.1));
            next.0.push(state);
            next.1.push(u);
            let (q, v) = &state;
            if phase.lands {
                sum += self.cost_of_node(k, &state, None);
                let landed = contact::land(&m, 0.0, q, v, &phase.touches).expect("feet hold");
                state.1 = landed.v;
                continue;
            }
            let held = contact::hold(&m, phase.touches).with_gains(0.0, DAMPING);
            let Held { a, forces } = held.held(0.0, q, v, &m.generalized_forces(q, &u)).expect("feet hold");
            sum +=
                (self.cost_of_node(k, &state, Some(&forces)) + OF_INPUTS * u.norm_squared() / 2.0) * PERIOD;
            let v = v + a * PERIOD;
            state = (m.integrate(q, &(v * PERIOD)), v);
        }
        next.0.push(state);
        sum + self.cost_of_node(plan.inputs.len(), &state, None)
    }

    /// Returns the gait as JSON, for an external program that solves the problem with the same costs.
    fn gait_as_json(&self) -> String {
        let point_or_null_text = |place: &Option<SpacePosition>| {
            place.map_or("null".to_owned(), |place| format!("{:?}", place.as_slice()))
        };
        let phases = self.phases.iter().map(|phase| {
            let feet = phase.feet.each_ref().map(point_or_null_text).join(", ");
            let holds = phase.touches.map(|touch| touch != Touch::Open);
            format!(
                "{{\"holds\": {holds:?}, \"centre\": {}, \"feet\": [{feet}], \"lands\": {}}}",
                point_or_null_text(&phase.centre),
                phase.lands
            )
        });
        format!("[{}]", phases.collect::<Vec<_>>().join(", "))
    }
}

/// Runs the iterations from the inputs of the robot at rest, with the line search of Crocoddyl's `SolverDDP`.
/// Returns the results as JSON.
pub fn measure_trot() -> String {
    let mut start = Walker {}.neutral();
    start[2] = 0.235;
    for (k, angles) in
        [(0, [0.1, 0.8, -1.6]), (1, [-0.1, 0.8, -1.6]), (2, [0.1, -0.8, 1.6]), (3, [-0.1, -0.8, 1.6])]
    {
        start.fixed_rows_mut::<3>(7 + 3 * k).copy_from_slice(&angles);
    }
    let phases = trot_gait_nodes(&start);
    let trot = TrotGait { start, weights: phases.iter().map(state_cost_weights).collect(), phases };
    let nodes = trot.phases.len() - 1;
    let mut plan = TrajectoryWithPolicies {
        states: vec![(start, VelocityVector::zeros()); nodes + 1],
        inputs: trot.phases[..nodes]
            .iter()
            .map(|phase| match phase.lands {
                true => Inputs::zeros(),
                false => quasi_static_inputs(&start, phase),
            })
            .collect(),
        policies: vec![Policy::zeros(); nodes],
    };
    let inputs: Vec<_> = plan.inputs.iter().map(|u| u.as_slice().to_vec()).collect();
    let mut next = (Vec::with_capacity(nodes + 1), Vec::with_capacity(nodes));
    let mut cost = trot.cost_of_simulated_policies(&plan, 1.0, &mut next);
    (plan.states, plan.inputs) = next.clone();
    let mut costs = Vec::new();
    for _ in 0..ITERATIONS {
        let [linear, quadratic] = trot.backward_sweep(&mut plan);
        let lengths = (0..10).map(|k| 0.5_f64.powi(k));
        let shorter =
            lengths.map(|length| (length, trot.cost_of_simulated_policies(&plan, length, &mut next)));
        let mut shorter = shorter.collect::<Vec<_>>().into_iter();
        let found = shorter
            .find(|(length, found)| cost - found > -0.1 * (length * linear + length * length * quadratic));
        let Some((length, found)) = found else { break };
        cost = trot.cost_of_simulated_policies(&plan, length, &mut next);
        assert_eq!(cost, found);
        costs.push(cost);
        (plan.states, plan.inputs) = next.clone();
    }
    let mut node = LinearisedTrajectoryNode::zero_node();
    let linearise = minimum_time_per_node(nodes, || {
        for k in 0..nodes {
            trot.linearise_node(k, &plan.states[k], &plan.inputs[k], &mut node).expect("feet hold");
            black_box(&node);
        }
    });
    let mut kept = Vec::new();
    for k in 0..nodes {
        trot.linearise_node(k, &plan.states[k], &plan.inputs[k], &mut node).expect("feet hold");
        kept.push((node.step, node.cost));
    }
    let last = trot.final_state_cost(&plan.states[nodes]);
    let backwards = minimum_time_per_node(nodes, || {
        let mut to_go = last;
        for (policy, (step, cost)) in plan.policies.iter_mut().zip(&kept).rev() {
            backward_into(step, cost, 0.0, policy, &mut to_go).expect("it is convex");
        }
    });
    let sweep = minimum_time_per_node(nodes, || {
        black_box(trot.backward_sweep(&mut plan));
    });
    let rollout = minimum_time_per_node(nodes, || {
        black_box(trot.cost_of_simulated_policies(&plan, 1.0, &mut next));
    });
    format!(
        "\"trot\": {{\"linearise\": {linearise}, \"backward\": {backwards}, \"sweep\": {sweep}, \"rollout\": \
         {rollout}, \"costs\": {costs:?}, \"start\": {:?}, \"inputs\": {inputs:?}, \"phases\": {}}}",
        start.as_slice(),
        trot.gait_as_json()
    )
}
