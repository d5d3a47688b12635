//! Computation of a function's results for one state.

use super::{ConstraintSolverFunction, EvaluationMethod, FunctionDefinition, Output};
use linkwork_jit::{Error, Stepper};

/// Computation of a function's results for one state, with its workspace.
pub(super) enum Evaluator {
    Generated(linkwork_jit::Robot, linkwork_jit::Function),
    Placement(linkwork_jit::Robot, linkwork_jit::Function),
    Step(Box<Stepper>, bool),
    Derivatives(linkwork_jit::Robot, bool),
    Constraint(linkwork_jit::Robot, ConstraintSolverFunction),
}

impl FunctionDefinition {
    /// Returns the computation of results, for the given frame if the function takes a frame.
    pub(super) fn evaluator(&self, robot: &linkwork_jit::Robot, frame: usize) -> Result<Evaluator, Error> {
        let cloned_robot = || robot.clone();
        Ok(match &self.kind {
            EvaluationMethod::Generated(f) => Evaluator::Generated(cloned_robot(), f.clone()),
            EvaluationMethod::Frames(all) => Evaluator::Generated(cloned_robot(), all[frame].clone()),
            EvaluationMethod::Placements(all) => Evaluator::Placement(cloned_robot(), all[frame].clone()),
            EvaluationMethod::Step => Evaluator::Step(Box::new(Stepper::new(&cloned_robot())?), false),
            EvaluationMethod::Transition => Evaluator::Step(Box::new(Stepper::new(&cloned_robot())?), true),
            EvaluationMethod::IntegrateDerivatives => Evaluator::Derivatives(cloned_robot(), false),
            EvaluationMethod::TangentRateDerivatives => Evaluator::Derivatives(cloned_robot(), true),
            EvaluationMethod::Constraint(which) => Evaluator::Constraint(cloned_robot(), *which),
        })
    }

    /// Returns the number of entries of all results.
    pub(super) fn length(&self) -> usize {
        self.results.iter().map(Output::length).sum()
    }
}

impl Evaluator {
    /// Returns the robot, whose parameters and time may be set.
    pub(super) fn robot_mut(&mut self) -> &mut linkwork_jit::Robot {
        match self {
            Evaluator::Generated(robot, _)
            | Evaluator::Placement(robot, _)
            | Evaluator::Derivatives(robot, _)
            | Evaluator::Constraint(robot, _) => robot,
            Evaluator::Step(stepper, _) => stepper.robot_mut(),
        }
    }

    /// Writes the results of the function one after the other, matrices by columns.
    pub(super) fn evaluate(&mut self, arguments: &[&[f64]], out: &mut [f64]) -> Result<(), Error> {
        match self {
            Evaluator::Generated(robot, f) => robot.evaluate_into(f, arguments, out),
            Evaluator::Placement(robot, f) => placement(robot, f, arguments, out),
            Evaluator::Step(stepper, jacobians) => {
                write_runge_kutta_step(stepper, *jacobians, arguments, out)
            }
            Evaluator::Constraint(robot, which) => {
                write_constraint_satisfying_state(robot, *which, arguments, out)
            }
            Evaluator::Derivatives(robot, of_rate) => {
                let found = match *of_rate {
                    true => robot.tangent_rate_derivatives(arguments[0], arguments[1])?,
                    false => robot.integrate_derivatives(arguments[1])?,
                };
                let entries = found.iter().flat_map(|matrix| matrix.as_slice());
                out.iter_mut().zip(entries).for_each(|(to, from)| *to = *from);
                Ok(())
            }
        }
    }
}

/// Writes the placement of a frame as a 4 × 4 matrix by rows.
pub(super) fn placement(
    robot: &linkwork_jit::Robot,
    f: &linkwork_jit::Function,
    arguments: &[&[f64]],
    out: &mut [f64],
) -> Result<(), Error> {
    let mut values = [0.0; 12];
    robot.evaluate_into(f, arguments, &mut values)?;
    for (k, (column, own)) in out.chunks_exact_mut(4).zip(values.chunks_exact(3)).enumerate() {
        column[..3].copy_from_slice(own);
        column[3] = f64::from(u8::from(k == 3));
    }
    Ok(())
}

/// Writes a configuration or velocity that satisfies the constraints.
fn write_constraint_satisfying_state(
    robot: &mut linkwork_jit::Robot,
    which: ConstraintSolverFunction,
    arguments: &[&[f64]],
    out: &mut [f64],
) -> Result<(), Error> {
    let mut rest = arguments;
    if robot.depends_on_time() {
        robot.set_time(arguments[0][0]);
        rest = &arguments[1..];
    }
    let nonzero_indices = |list: &[f64]| (0..list.len()).filter(|k| list[*k] != 0.0).collect::<Vec<usize>>();
    let found = match (which, rest) {
        (ConstraintSolverFunction::Assemble, [q, held]) => robot.assemble(q, &nonzero_indices(held)),
        (ConstraintSolverFunction::ProjectConfiguration, [q]) => robot.project_configuration(q),
        (ConstraintSolverFunction::ProjectVelocity, [q, v]) => robot.project_velocity(q, v),
        (ConstraintSolverFunction::CompleteVelocity, [q, v, held]) => {
            robot.complete_velocity(q, v, &nonzero_indices(held))
        }
        _ => Err(Error::Internal("the arguments of a function of constraints".to_string())),
    }?;
    out.copy_from_slice(found.as_slice());
    Ok(())
}

/// Writes the state after a Runge–Kutta step, and the Jacobians of the step if requested.
fn write_runge_kutta_step(
    stepper: &mut Stepper,
    jacobians: bool,
    arguments: &[&[f64]],
    out: &mut [f64],
) -> Result<(), Error> {
    let (t, rest) = match arguments {
        [t, rest @ ..] if rest.len() == 4 => (t[0], rest),
        rest => (0.0, rest),
    };
    let [q, v, u, h] = rest else {
        return Err(Error::Internal("the arguments of a step".to_string()));
    };
    let (end_q, rest) = out.split_at_mut(q.len());
    let (end_v, rest) = rest.split_at_mut(v.len());
    if !jacobians {
        return stepper.step(t, [q, v, u], h[0], [end_q, end_v]);
    }
    let found = stepper.differentiate(t, [q, v, u], h[0], [end_q, end_v])?;
    let entries = found.q.iter().chain(&found.v).flat_map(|matrix| matrix.as_slice());
    rest.iter_mut().zip(entries).for_each(|(to, from)| *to = *from);
    Ok(())
}
