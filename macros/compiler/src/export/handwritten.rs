//! Functions that are written by hand and not derived, with their signatures and documentation: of the
//! configuration manifold, of steps, of named frames and of limits.

use super::mechanism::ExportedMechanism;
use super::signatures::{ArrayArgument, ExportedSignature, reaction_signature};
use crate::catalogue::Argument;

/// Integration methods of steps, with descriptions for the documentation.
pub const METHODS: [(&str, &str); 2] = [
    (
        "semi_implicit_euler",
        "the semi-implicit Euler method, which updates the velocity with the accelerations at the start, \
         then the configuration with the new velocity",
    ),
    ("rk4", "the classical method of Runge and Kutta"),
];

/// Function that is written by hand and not derived.
struct HandwrittenFunction {
    name: &'static str,
    /// Names of the arguments and of the results, which determine their sizes.
    arguments: &'static str,
    results: &'static str,
    docs: &'static str,
}

/// Functions of the configuration manifold.
const MANIFOLD: [HandwrittenFunction; 3] = [
    HandwrittenFunction {
        name: "integrate",
        arguments: "q dv",
        results: "result",
        docs: "The configuration that is reached from `q` with the constant velocity `dv` in one unit of \
               time, with normalised quaternions. The result may be stored in `q`.",
    },
    HandwrittenFunction {
        name: "difference",
        arguments: "from to",
        results: "result",
        docs: "The velocity that leads from one configuration to another in one unit of time.",
    },
    HandwrittenFunction {
        name: "tangent_rate",
        arguments: "dv v",
        results: "result",
        docs: "Rate of `dv` for which `integrate(q, dv)` moves with velocity `v`.",
    },
];

/// Derivatives of functions of the configuration manifold.
const MANIFOLD_DERIVATIVES: [HandwrittenFunction; 2] = [
    HandwrittenFunction {
        name: "integrate_derivatives",
        arguments: "dv",
        results: "by_q by_dv",
        docs: "Derivatives of the result of `integrate` by `q` and `dv`, which are the same for all `q`, \
               with displacements of ball and free joints in body axes; identities for plain coordinates.",
    },
    HandwrittenFunction {
        name: "tangent_rate_derivatives",
        arguments: "dv v",
        results: "by_dv by_v",
        docs: "Derivatives of `tangent_rate`; zero and the identity for plain coordinates.",
    },
];

/// Functions of the configuration manifold in declared generalized speeds.
const SPEEDS: [HandwrittenFunction; 3] = [
    HandwrittenFunction {
        docs: "The configuration that is reached from `q` in one unit of time with the constant joint \
               velocities to which the generalized speeds `dv` correspond at `q`, with normalised \
               quaternions. The result may be stored in `q`.",
        ..MANIFOLD[0]
    },
    HandwrittenFunction {
        docs: "The generalized speeds, at `from`, that lead from one configuration to another in one unit of \
               time.",
        ..MANIFOLD[1]
    },
    HandwrittenFunction {
        name: "displacement_rate",
        arguments: "q dv v",
        results: "result",
        docs: "Rate of `dv` for which `integrate(q, dv)` moves with the speeds `v`, from `q`.",
    },
];

/// Derivatives of functions of the configuration manifold in declared generalized speeds.
const SPEED_DERIVATIVES: [HandwrittenFunction; 2] = [
    HandwrittenFunction {
        arguments: "q dv",
        docs: "Derivatives of the result of `integrate` by `q` and `dv`, in generalized speeds at the \
               result.",
        ..MANIFOLD_DERIVATIVES[0]
    },
    HandwrittenFunction {
        name: "displacement_rate_derivatives",
        arguments: "q dv v",
        results: "by_q by_dv by_v",
        docs: "Derivatives of `displacement_rate`.",
    },
];

/// Functions of named frames.
const FRAMES: [HandwrittenFunction; 4] = [
    HandwrittenFunction {
        name: "frame_placement",
        arguments: "t q",
        results: "result",
        docs: "Placement of a frame in the ground: the rotation matrix column by column (the frame's axes in \
               ground axes), then the position of its origin, m.",
    },
    HandwrittenFunction {
        name: "frame_velocity",
        arguments: "t q v",
        results: "result",
        docs: "Velocity of a frame relative to the ground, in ground axes: velocity of its origin, m/s, then \
               angular velocity, rad/s.",
    },
    HandwrittenFunction {
        name: "frame_acceleration",
        arguments: "t q v a",
        results: "result",
        docs: "Acceleration of a frame relative to the ground, in ground axes, without gravity: acceleration \
               of its origin, m/s^2, then angular acceleration, rad/s^2.",
    },
    HandwrittenFunction {
        name: "frame_jacobian",
        arguments: "t q",
        results: "result",
        docs: "Jacobian of a frame: the velocity of the frame is this matrix times `v`.",
    },
];

/// Function that returns the limits of the joints.
pub const LIMITS: &str = "limits";

/// Returns the signatures of all functions that a program can call.
pub fn callable_function_signatures(i: &ExportedMechanism<'_>) -> Vec<ExportedSignature> {
    let mut functions: Vec<ExportedSignature> =
        i.public.iter().map(|f| ExportedSignature::from_function(f, i)).collect();
    functions.extend(i.reactions.iter().map(|f| reaction_signature(f, i)));
    if i.limits.is_some() {
        let docs = "Limits of the coordinates, and maximum magnitudes of velocities and forces, in the order \
                    of v; infinite for a missing limit.";
        let limits =
            HandwrittenFunction { name: LIMITS, arguments: "", results: "lower upper speed effort", docs };
        functions.push(limits.signature(i));
    }
    let [plain, derivatives] = match i.has_generalized_speeds() {
        true => [&SPEEDS[..], &SPEED_DERIVATIVES],
        false => [&MANIFOLD[..], &MANIFOLD_DERIVATIVES],
    };
    let derivatives = derivatives.iter().filter(|_| i.has_derivatives());
    functions.extend(plain.iter().chain(derivatives).map(|f| f.signature(i)));
    for (method, about) in METHODS.iter().filter(|_| i.has_steps) {
        functions.push(integration_step_signature(method, about, i));
        functions.extend(i.has_transitions.then(|| state_transition_signature(method, i)));
    }
    if !i.output.frames.is_empty() {
        functions.extend(FRAMES.iter().map(|f| ExportedSignature { of_frame: true, ..f.signature(i) }));
    }
    functions
}

/// Returns the signature of an internal function of joint velocities, if speeds are declared: the functions
/// of the manifold under other names.
pub fn joint_manifold_signatures(i: &ExportedMechanism<'_>) -> Vec<ExportedSignature> {
    let derivatives = MANIFOLD_DERIVATIVES.iter().filter(|_| i.has_derivatives());
    let prefix_name_with_joints =
        |f: ExportedSignature| ExportedSignature { name: format!("joints_{}", f.name), ..f };
    MANIFOLD.iter().chain(derivatives).map(|f| prefix_name_with_joints(f.signature(i))).collect()
}

impl HandwrittenFunction {
    fn signature(&self, i: &ExportedMechanism<'_>) -> ExportedSignature {
        let arguments = self.arguments.split_whitespace().filter(|name| *name != "t" || i.model.time);
        ExportedSignature {
            name: self.name.to_string(),
            arguments: arguments.map(|name| argument_array(name, i)).collect(),
            results: self.results.split_whitespace().map(|name| self.c_array_of_result(name, i)).collect(),
            returns: false,
            of_frame: false,
            docs: vec![self.docs.to_string()],
        }
    }

    fn c_array_of_result(&self, name: &str, i: &ExportedMechanism<'_>) -> ArrayArgument {
        let (n, m) = (i.nv(), i.nu());
        match (self.name, name) {
            ("integrate", _) | (_, "next_q") => ArrayArgument::vector(name, i.nq()),
            ("frame_placement", _) => ArrayArgument::vector(name, 12),
            ("frame_jacobian", _) => ArrayArgument::matrix(name, 6, n),
            ("frame_velocity" | "frame_acceleration", _) => ArrayArgument::vector(name, 6),
            (_, "by_state") => ArrayArgument::matrix(name, 2 * n, 2 * n),
            (_, "by_input") => ArrayArgument::matrix(name, 2 * n, m),
            (_, "by_h") => ArrayArgument::vector(name, 2 * n),
            (_, "by_q" | "by_dv" | "by_v") => ArrayArgument::matrix(name, n, n),
            _ => ArrayArgument::vector(name, n),
        }
    }
}

/// Returns the array of an argument of a function that is written by hand.
fn argument_array(name: &str, i: &ExportedMechanism<'_>) -> ArrayArgument {
    let argument = match name {
        "t" => Argument::T,
        "q" => Argument::Q,
        "v" => Argument::V,
        "a" => Argument::A,
        "u" => Argument::U,
        "h" => return ArrayArgument::scalar_value("h", "step size, s"),
        "from" | "to" => return ArrayArgument::vector(name, i.nq()),
        _ => return ArrayArgument::vector(name, i.nv()),
    };
    ArrayArgument::from_argument(argument, i)
}

fn integration_step_signature(method: &str, about: &str, i: &ExportedMechanism<'_>) -> ExportedSignature {
    let docs = format!(
        "One step of {about}, of `h` seconds, with constant inputs `u`: configuration and velocity after it. \
         The results may be stored in `q` and `v`."
    );
    let step = HandwrittenFunction { name: "", arguments: "t q v u h", results: "next_q next_v", docs: "" };
    ExportedSignature { name: format!("{method}_step"), docs: vec![docs], ..step.signature(i) }
}

fn state_transition_signature(method: &str, i: &ExportedMechanism<'_>) -> ExportedSignature {
    let [results, by_h] = match i.model.time {
        true => ["next_q next_v by_state by_input", ""],
        false => [
            "next_q next_v by_state by_input by_h",
            ", and `by_h` is its derivative by the length of the step",
        ],
    };
    let docs = format!(
        "The step of `{method}_step` with its Jacobians, exact to rounding: with `x` the displacement of the \
         configuration (as `integrate` takes it), then the change of the velocity, `x` at the end is \
         `by_state` times `x` at the start plus `by_input` times the change of the inputs{by_h}."
    );
    let transition = HandwrittenFunction { name: "", arguments: "t q v u h", results, docs: "" };
    ExportedSignature { name: format!("{method}_transition"), docs: vec![docs], ..transition.signature(i) }
}
