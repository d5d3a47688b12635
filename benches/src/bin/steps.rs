//! Compares a step of the classical Runge-Kutta method with its Jacobians to C that CasADi generates
//! (`benches/peers/run steps`), and second derivatives to first ones, which needs no peer.

use linkwork::nalgebra::SMatrix;
use linkwork::prelude::*;
use linkwork::{Derivatives, SecondDerivatives, discrete};
use linkwork_benches::generic::{Model, Options};
use linkwork_benches::peers::contender::{Contender, ContenderOwner, MeasuredFunction};
use linkwork_benches::peers::library::{self, StateRows};
use linkwork_benches::peers::own::{GeneratedContender, MechanismCall, ToNumberList};
use linkwork_benches::peers::turns::{TOLERANCE, measure_in_turns, remove_disagreeing_contenders};
use linkwork_benches::states::{STATES, State, random_states};
use std::path::Path;
use std::rc::Rc;

/// Step size of the measured integration steps, s.
const PERIOD: f64 = 0.01;
/// Processor time spent on the measurement of each implementation, s.
const BUDGET: f64 = 0.2;

#[mechanism(urdf = "../models/urdf/ur5.urdf", passive = ignore, second_derivatives)]
#[derive(Clone, Copy)]
struct Ur5;

#[mechanism(
    urdf = "../models/urdf/panda.urdf",
    lock = ["panda_finger_joint1", "panda_finger_joint2"],
    passive = ignore,
    second_derivatives
)]
#[derive(Clone, Copy)]
struct PandaArm;

/// Returns `[A B]` of a step under joint torques: the columns of `q`, `v` and `τ`.
fn step_jacobian<M, const N: usize>(m: &M, s: &State<N, N>) -> [[SMatrix<f64, N, N>; 2]; 3]
where
    M: Derivatives<N, N, N, Scalar = f64>,
{
    let found = discrete::transition(m, &Rk4::step(PERIOD), 0.0, &s.q, &s.v, &s.tau).expect("it moves");
    [[found.q_by_q, found.v_by_q], [found.q_by_v, found.v_by_v], [found.q_by_u, found.v_by_u]]
}

/// Blocks in a column, as a list of matrix columns.
struct StepJacobianBlocks<const N: usize>([[SMatrix<f64, N, N>; 2]; 3]);

impl<const N: usize> ToNumberList for StepJacobianBlocks<N> {
    fn flatten(&self) -> Vec<f64> {
        let columns = self.0.iter().flat_map(|[q, v]| q.column_iter().zip(v.column_iter()));
        columns.flat_map(|(q, v)| q.iter().chain(v.iter()).copied().collect::<Vec<f64>>()).collect()
    }
}

/// Returns an integration step of Linkwork as a contender of the comparison.
fn linkwork_contender<M: Copy + 'static, R: ToNumberList + 'static, const N: usize>(
    mechanism: M,
    states: &Rc<Vec<State<N, N>>>,
    call: MechanismCall<M, R, N, N>,
) -> Box<dyn Contender> {
    let (owner, name, states) =
        (ContenderOwner::Linkwork, MeasuredFunction::Step.generated_function_name(), states.clone());
    Box::new(GeneratedContender { owner, mechanism, states, name, call })
}

/// Result of a contender whose values are not compared with those of the others.
struct UncomparedResult<R>(R);

impl<R> ToNumberList for UncomparedResult<R> {
    fn flatten(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// Returns the times per call of each function, ns, measured in turns.
fn nanoseconds_per_call(mut of: Vec<Box<dyn Contender>>) -> Vec<f64> {
    measure_in_turns(&mut of, STATES, BUDGET).iter().map(|measured| measured.time).collect()
}

fn measure_robot_steps<M, const N: usize>(
    name: &str,
    m: M,
    model: &Model,
    folder: Option<&Path>,
) -> Result<(), String>
where
    M: Copy + SecondDerivatives<N, N, N, Scalar = f64> + 'static,
{
    let states: Rc<Vec<State<N, N>>> = Rc::new(random_states(model));
    if let Some(folder) = folder {
        let numbers: Vec<f64> = states.iter().flat_map(State::concatenated_state_numbers).collect();
        let rows = StateRows { nq: N, nv: N, numbers: numbers.leak() };
        let mut all = Vec::new();
        for file in ["plain.exact", "plain.fast", "shared.exact", "shared.fast"] {
            let path = folder.join(name).join(format!("step_{file}.so"));
            all.extend(library::load_casadi_function(&path, MeasuredFunction::Step, rows));
        }
        all.push(linkwork_contender(m, &states, |m, s| StepJacobianBlocks(step_jacobian(m, s))));
        let wrong = remove_disagreeing_contenders(&mut all, name, (2 * N, STATES), TOLERANCE);
        if !wrong.is_empty() {
            return Err(wrong.join("\n"));
        }
        let measured = measure_in_turns(&mut all, STATES, BUDGET);
        let shortest_time_of_owner = |owner| {
            measured.iter().filter(|m| m.owner == owner).map(|m| m.time).fold(f64::INFINITY, f64::min)
        };
        let (ours, theirs) = (
            shortest_time_of_owner(ContenderOwner::Linkwork),
            shortest_time_of_owner(ContenderOwner::Casadi),
        );
        println!(
            "| {name} | step with Jacobians | {ours:.0} | CasADi C | {theirs:.0} | {:.1} × |",
            theirs / ours
        );
    }
    let found = nanoseconds_per_call(vec![
        linkwork_contender(m, &states, |m, s| {
            UncomparedResult(m.inverse_dynamics_derivatives(0.0, &s.q, &s.v, &s.a))
        }),
        linkwork_contender(m, &states, |m, s| {
            UncomparedResult(m.inverse_dynamics_second_derivatives(0.0, &s.q, &s.v, &s.a, &s.tau))
        }),
        linkwork_contender(m, &states, |m, s| {
            UncomparedResult(m.forward_dynamics_derivatives(0.0, &s.q, &s.v, &s.tau))
        }),
        linkwork_contender(m, &states, |m, s| {
            UncomparedResult(m.forward_dynamics_second_derivatives(0.0, &s.q, &s.v, &s.tau, &s.a))
        }),
        linkwork_contender(m, &states, |m, s| UncomparedResult(step_jacobian(m, s))),
        linkwork_contender(m, &states, |m, s| {
            let factors = (&s.a, &s.tau);
            UncomparedResult(discrete::second_order(m, &Rk4::step(PERIOD), 0.0, &s.q, &s.v, &s.tau, factors))
        }),
    ]);
    for (what, pair) in ["inverse dynamics", "forward dynamics", "step"].iter().zip(found.chunks_exact(2)) {
        let (first, second) = (pair[0], pair[1]);
        println!(
            "| {name} | {what}, second derivatives | {second:.0} | first | {first:.0} | {:.1} × as long |",
            second / first
        );
    }
    Ok(())
}

fn main() -> Result<(), String> {
    let folder = std::env::args().nth(1);
    let folder = folder.as_deref().map(Path::new);
    println!("| robot | function | ns | next to | ns | ratio |");
    println!("| --- | --- | ---: | --- | ---: | ---: |");
    let read_fixed_base_urdf = |text: &str, lock| Model::from_urdf(text, &Options { free: false, lock });
    measure_robot_steps(
        "ur5",
        Ur5,
        &read_fixed_base_urdf(include_str!("../../../models/urdf/ur5.urdf"), &[])?,
        folder,
    )?;
    let locked = &["panda_finger_joint1", "panda_finger_joint2"];
    let panda = read_fixed_base_urdf(include_str!("../../../models/urdf/panda.urdf"), locked)?;
    measure_robot_steps("panda_arm", PandaArm, &panda, folder)
}
