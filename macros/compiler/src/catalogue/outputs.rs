//! Declarations of the functions of a mechanism's outputs.

use super::contacts::contact_force_argument;
use super::facts::Facts;
use super::row::{DeclaredFunction, GeneratedId};
use super::shape::Argument::{A, Q, T, U, V};
use super::shape::{Argument, Shape};
use crate::mechanism::{SuppliedQuantity, UsedQuantities};

/// Prefix of the hidden function of an output that contains reactions.
pub const REACTION: &str = "__reaction_";
/// Prefix of the hidden function of an output that contains contact forces.
pub const TOUCHED: &str = "__touched_";

/// Suffix of the name of an output's Jacobian.
pub const JACOBIAN: &str = "_jacobian";

/// Suffix of the name of an output's derivatives.
pub const DERIVATIVES: &str = "_derivatives";

/// Suffix of the parameter derivatives of an output.
pub const BY_PARAMETERS: &str = "_by_parameters";

/// Number of entries of a 3×3 rotation matrix.
const MATRIX: usize = 9;

fn shape_of_size(size: usize) -> Shape {
    match size {
        1 => Shape::Scalar,
        MATRIX => Shape::Matrix(3, 3),
        _ => Shape::Vector(size),
    }
}

fn declare_output_function(
    id: GeneratedId,
    name: String,
    arguments: &[Argument],
    shape: Shape,
    docs: Vec<String>,
    f: &Facts,
) -> DeclaredFunction {
    let arguments = f.time.then_some(T).into_iter().chain(arguments.iter().copied()).collect();
    DeclaredFunction { id, name, docs, arguments, shape }
}

/// Returns the functions of an output: its value, its Jacobian unless it depends on accelerations, and the
/// requested derivatives. A matrix output has its value alone, since the derivatives of products with vectors
/// serve the same purpose.
pub fn output_functions(name: &str, size: usize, uses: UsedQuantities, f: &Facts) -> Vec<DeclaredFunction> {
    let mut arguments = vec![Q];
    arguments.extend((uses.velocities || uses.accelerations).then_some(V));
    arguments.extend(uses.accelerations.then_some(A));
    arguments.extend(uses.inputs.then_some(U));
    let about = match uses.accelerations {
        true => format!(
            "The output `{name}`, for the accelerations `a`. The option `derivatives` adds functions for its \
             derivatives."
        ),
        false => format!("The output `{name}`."),
    };
    let mut functions = vec![declare_output_function(
        GeneratedId::Output,
        name.to_string(),
        &arguments,
        shape_of_size(size),
        vec![about],
        f,
    )];
    if size == MATRIX {
        return functions;
    }
    if !uses.accelerations {
        let what = match uses.velocities {
            true => "it changes with the velocities",
            false => "its rate is this times `v`",
        };
        let docs = vec![format!("Jacobian of the output `{name}`: {what}.")];
        let shape = Shape::Matrix(size, f.nv);
        functions.push(declare_output_function(
            GeneratedId::OutputJacobian,
            format!("{name}{JACOBIAN}"),
            &arguments,
            shape,
            docs,
            f,
        ));
    }
    if f.requests.derivatives {
        let docs = vec![
            format!(
                "Partial derivatives of the output `{name}` by configuration, velocity, acceleration and \
                 input."
            ),
            "Column `i` of the derivative by `q` is along `q ⊕ ε eᵢ` (see `integrate`); for ball and free \
             joints this is a motion in body axes."
                .to_string(),
        ];
        let shape = Shape::Jacobians(size, f.nv, f.nu);
        let name = format!("{name}{DERIVATIVES}");
        functions.push(declare_output_function(
            GeneratedId::OutputDerivatives,
            name,
            &arguments,
            shape,
            docs,
            f,
        ));
    }
    if f.requests.sensitivities {
        let docs = vec![format!(
            "Derivatives of the output `{name}` by the parameters: column `k` by the parameter \
             `PARAMETERS[k]`."
        )];
        let shape = Shape::Matrix(size, f.parameters);
        let name = format!("{name}{BY_PARAMETERS}");
        functions.push(declare_output_function(
            GeneratedId::OutputByParameters,
            name,
            &arguments,
            shape,
            docs,
            f,
        ));
    }
    functions
}

/// Returns the hidden function of an output that contains reactions. It takes the state, accelerations and
/// multipliers of the motion, and for a free-body diagram also the contact forces.
pub fn reaction_output_function(name: &str, size: usize, is_diagram: bool, f: &Facts) -> DeclaredFunction {
    let mut arguments = vec![Q, V, A];
    arguments.extend((f.nu > 0).then_some(U));
    arguments.extend(f.constraints.map(|c| Argument::Given("lambda", SuppliedQuantity::Multiplier, c.all)));
    let touched = is_diagram && f.contacts.count > 0;
    arguments.extend(touched.then_some(contact_force_argument(f)));
    declare_output_function(
        GeneratedId::Reaction,
        format!("{REACTION}{name}"),
        &arguments,
        shape_of_size(size),
        Vec::new(),
        f,
    )
}

/// Returns the hidden function of an output that contains contact forces. It takes the state, the inputs and
/// the forces of all contacts.
pub fn contact_force_output_function(name: &str, size: usize, f: &Facts) -> DeclaredFunction {
    let mut arguments = vec![Q, V];
    arguments.extend((f.nu > 0).then_some(U));
    arguments.push(contact_force_argument(f));
    declare_output_function(
        GeneratedId::Touched,
        format!("{TOUCHED}{name}"),
        &arguments,
        shape_of_size(size),
        Vec::new(),
        f,
    )
}
