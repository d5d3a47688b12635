//! Names, arguments and results of the functions of a robot.

use super::{Argument, ConstraintSolverFunction, EvaluationMethod, Function, FunctionDefinition, Output};
use linkwork_jit::{Error, Stepper};
use std::collections::HashMap;
use std::sync::Arc;

/// Documentation and names of the functions of all frames.
const FRAMES: [(&str, &str); 4] = [
    (
        "frame_placement",
        "Placement of a frame in the ground: a matrix of four rows and columns with its axes and its origin, \
         m.",
    ),
    (
        "frame_velocity",
        "Velocity of a frame: of its origin, m/s, then angular, rad/s; relative to the ground, in ground \
         axes.",
    ),
    (
        "frame_acceleration",
        "Acceleration of a frame: of its origin, m/s², then angular, rad/s²; relative to the ground, in \
         ground axes; without gravity.",
    ),
    (
        "frame_jacobian",
        "Jacobian of a frame: its product with `v` is the velocity of the frame, except for motions \
         prescribed in time.",
    ),
];

fn arguments(f: &linkwork_jit::Function) -> Vec<Argument> {
    let argument_of_function = |(name, length): (&str, usize)| Argument {
        name: name.to_string(),
        length: (name != "t").then_some(length),
    };
    f.arguments().into_iter().map(argument_of_function).collect()
}

fn results(f: &linkwork_jit::Function) -> Vec<Output> {
    let output_of_matrix = |m: &linkwork_jit::Matrix| Output {
        name: m.name.to_string(),
        shape: match f.rank() {
            0 => Vec::new(),
            1 => vec![m.rows],
            _ => vec![m.rows, m.columns],
        },
    };
    f.results().iter().map(output_of_matrix).collect()
}

fn vector_argument(name: &str, length: usize) -> Argument {
    Argument { name: name.to_string(), length: Some(length) }
}

fn matrix_output(name: &str, rows: usize, columns: usize) -> Output {
    Output { name: name.to_string(), shape: vec![rows, columns] }
}

impl Function {
    fn new(
        name: &str,
        documentation: &str,
        arguments: Vec<Argument>,
        results: Vec<Output>,
        kind: EvaluationMethod,
    ) -> Function {
        let (name, documentation) = (name.to_string(), documentation.to_string());
        let frames = HashMap::new();
        Function {
            signature: Arc::new(FunctionDefinition { name, documentation, arguments, results, frames, kind }),
        }
    }

    /// Returns all functions of a mechanism as Python methods.
    pub fn all(robot: &linkwork_jit::Robot) -> Vec<Function> {
        let plain = robot.functions().filter(|f| !f.name().contains('('));
        let mut all: Vec<Function> = plain
            .map(|f| {
                let (arguments, results) = (arguments(&f), results(&f));
                Function::new(
                    f.name(),
                    f.documentation(),
                    arguments,
                    results,
                    EvaluationMethod::Generated(f.clone()),
                )
            })
            .collect();
        all.extend(
            FRAMES
                .iter()
                .filter_map(|(name, documentation)| function_with_frame_argument(robot, name, documentation)),
        );
        let has_function = |name: &str| robot.function(name).is_ok();
        if Stepper::new(robot).is_ok_or_lacks_parameters() {
            all.extend(runge_kutta_step_functions(
                robot,
                has_function("linearize") && has_function("tangent_rate"),
            ));
        }
        if robot.constraints() > 0 {
            all.extend(constraint_solver_functions(robot));
        }
        if has_function("tangent_rate") {
            let n = robot.nv();
            all.push(Function::new(
                "integrate_derivatives",
                "Derivatives of `integrate(q, dv)` by displacements of `q` and by `dv`.",
                vec![vector_argument("q", robot.nq()), vector_argument("dv", n)],
                vec![matrix_output("by_q", n, n), matrix_output("by_dv", n, n)],
                EvaluationMethod::IntegrateDerivatives,
            ));
            all.push(Function::new(
                "tangent_rate_derivatives",
                "Derivatives of `tangent_rate(dv, v)` by `dv` and by `v`.",
                vec![vector_argument("dv", n), vector_argument("v", n)],
                vec![matrix_output("by_dv", n, n), matrix_output("by_v", n, n)],
                EvaluationMethod::TangentRateDerivatives,
            ));
        }
        all
    }
}

/// Whether a result is available, or will be once all parameters have values.
trait OkOrLacksParameters {
    fn is_ok_or_lacks_parameters(&self) -> bool;
}

impl<T> OkOrLacksParameters for Result<T, Error> {
    fn is_ok_or_lacks_parameters(&self) -> bool {
        matches!(self, Ok(_) | Err(Error::Missing(_)))
    }
}

/// Returns the function that takes the name of a frame, if the mechanism has frames.
fn function_with_frame_argument(
    robot: &linkwork_jit::Robot,
    name: &str,
    documentation: &str,
) -> Option<Function> {
    let names = robot.frames();
    let own = names.iter().map(|frame| robot.function(&format!("{name}({frame})")).ok());
    let own = own.collect::<Option<Vec<_>>>()?;
    let first = own.first()?;
    let (arguments, mut results) = (arguments(first), results(first));
    let kind = match name {
        "frame_placement" => {
            results = vec![matrix_output("result", 4, 4)];
            EvaluationMethod::Placements(own)
        }
        _ => EvaluationMethod::Frames(own),
    };
    let frames = names.iter().enumerate().map(|(k, name)| (name.clone(), k)).collect();
    let (name, documentation) = (name.to_string(), documentation.to_string());
    Some(Function {
        signature: Arc::new(FunctionDefinition { name, documentation, arguments, results, frames, kind }),
    })
}

/// Returns the functions that compute steps of the classical Runge–Kutta method.
fn runge_kutta_step_functions(robot: &linkwork_jit::Robot, with_jacobians: bool) -> Vec<Function> {
    let [nq, nv, nu] = [robot.nq(), robot.nv(), robot.nu()];
    let scalar_argument = |name: &str| Argument { name: name.to_string(), length: None };
    let time = robot.depends_on_time().then(|| scalar_argument("t"));
    let state =
        [vector_argument("q", nq), vector_argument("v", nv), vector_argument("u", nu), scalar_argument("h")];
    let arguments: Vec<Argument> = time.into_iter().chain(state).collect();
    let vector_output = |name: &str, n: usize| Output { name: name.to_string(), shape: vec![n] };
    let state = vec![vector_output("q", nq), vector_output("v", nv)];
    let mut jacobians = state.clone();
    for of in ["q", "v"] {
        for (by, columns) in [("q", nv), ("v", nv), ("u", nu)] {
            jacobians.push(matrix_output(&format!("{of}_by_{by}"), nv, columns));
        }
    }
    let step = Function::new(
        "step",
        "One step of the classical Runge–Kutta method, `h` seconds long, under inputs `u` that are constant: \
         the state after it.",
        arguments.clone(),
        state,
        EvaluationMethod::Step,
    );
    let transition_function_signature = || {
        Function::new(
            "transition",
            "One step of the classical Runge–Kutta method with its Jacobians: derivatives of configuration \
             and velocity after the step by those before it and by the inputs. Changes of configurations are \
             displacements, as `integrate` takes them.",
            arguments,
            jacobians,
            EvaluationMethod::Transition,
        )
    };
    if with_jacobians { vec![step, transition_function_signature()] } else { vec![step] }
}

/// Returns the functions that find states which satisfy the constraints.
fn constraint_solver_functions(robot: &linkwork_jit::Robot) -> [Function; 4] {
    let [nq, nv] = [robot.nq(), robot.nv()];
    let (q, v, held) = (vector_argument("q", nq), vector_argument("v", nv), vector_argument(HELD, nv));
    let number = Argument { name: "t".to_string(), length: None };
    let time_argument = || robot.depends_on_time().then(|| number.clone());
    let with_time_argument =
        |rest: &[&Argument]| time_argument().into_iter().chain(rest.iter().map(|a| (*a).clone())).collect();
    let single_vector_output = |n: usize| vec![Output { name: "result".to_string(), shape: vec![n] }];
    [
        Function::new(
            "assemble",
            "Configuration near `q` that satisfies the constraints. Coordinates of the velocities `held` do \
             not change.",
            with_time_argument(&[&q, &held]),
            single_vector_output(nq),
            EvaluationMethod::Constraint(ConstraintSolverFunction::Assemble),
        ),
        Function::new(
            "project_configuration",
            "Configuration nearest to `q` that satisfies the constraints, in the metric of the kinetic \
             energy.",
            with_time_argument(&[&q]),
            single_vector_output(nq),
            EvaluationMethod::Constraint(ConstraintSolverFunction::ProjectConfiguration),
        ),
        Function::new(
            "project_velocity",
            "Velocity nearest to `v` that satisfies the constraints, in the metric of the kinetic energy.",
            with_time_argument(&[&q, &v]),
            single_vector_output(nv),
            EvaluationMethod::Constraint(ConstraintSolverFunction::ProjectVelocity),
        ),
        Function::new(
            "complete_velocity",
            "Velocity with the entries `held` of `v` that satisfies the constraints.",
            with_time_argument(&[&q, &v, &held]),
            single_vector_output(nv),
            EvaluationMethod::Constraint(ConstraintSolverFunction::CompleteVelocity),
        ),
    ]
}

/// Name of the argument whose nonzero entries mark velocities that the search for a consistent state holds
/// fixed.
const HELD: &str = "held";
