//! Residuals, rates and Jacobians of the constraints, and the eliminations for constrained dynamics.

use super::facts::{ConstraintFacts, Facts, FunctionNeed};
use super::row::{Declaration, GeneratedId, Row};
use super::shape::Argument::{Q, Tau, V};
use super::shape::{Argument, Record, Shape};
use crate::mechanism::SuppliedQuantity;

const SOLVED: &[FunctionNeed] = &[FunctionNeed::Constraints, FunctionNeed::Inertia];

/// Rows of the functions of mechanisms with constraints that are derived from equations.
pub const ROWS: &[Row] = &[
    Row::derived_row(
        GeneratedId::ConstraintResiduals,
        "constraint_residuals",
        &[FunctionNeed::Constraints],
        |f| Declaration {
            arguments: vec![Q],
            shape: Shape::Vector(constraint_facts(f).holonomic),
            docs: vec![
                "Residuals `φ(q)` of the holonomic constraints, m and rad: zero if the constraints are \
             satisfied.",
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(GeneratedId::ConstraintRates, "constraint_rates", &[FunctionNeed::Constraints], |f| {
        Declaration {
            arguments: vec![Q, V],
            shape: Shape::Vector(constraint_facts(f).all),
            docs: vec![
                "Velocities `J(q) v + …` of all constraints, m/s and rad/s: zero if the constraints are \
             satisfied.",
            ],
            ..Declaration::default()
        }
    }),
    Row::derived_row(
        GeneratedId::ConstraintJacobian,
        "constraint_jacobian",
        &[FunctionNeed::Constraints],
        |f| Declaration {
            arguments: vec![Q],
            shape: Shape::Matrix(constraint_facts(f).all, f.nv),
            docs: vec![
                "Jacobian `J(q)` of the constraints: derivatives of the constraint velocities with respect to \
             `v`.",
            ],
            ..Declaration::default()
        },
    ),
    Row::derived_row(GeneratedId::ConstraintBias, "constraint_bias", &[FunctionNeed::Constraints], |f| {
        Declaration {
            arguments: vec![Q, V],
            shape: Shape::Vector(constraint_facts(f).all),
            docs: vec![
                "Bias `b(q, v)` of the constraints, m/s² and rad/s²: the time derivative of the constraint \
             velocities is `J v̇ + b`.",
            ],
            ..Declaration::default()
        }
    }),
    Row::derived_row(GeneratedId::ConstraintResponse, "__constraint_correction", SOLVED, |f| Declaration {
        arguments: vec![Q, force_argument(f), bias_argument(f)],
        shape: constrained_solution_shape(f),
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(GeneratedId::ConstrainedDynamics, "__constrained_dynamics", SOLVED, |f| Declaration {
        arguments: [vec![Q, V, Tau], sliding_signs_argument(f)].concat(),
        shape: constrained_solution_shape(f),
        ..Declaration::default()
    })
    .without_batched_variant(),
    Row::derived_row(
        GeneratedId::SlippingResponse,
        "__slipping_response",
        &[FunctionNeed::Constraints, FunctionNeed::Inertia, FunctionNeed::Slipping],
        |f| Declaration {
            arguments: [vec![Q, V, force_argument(f), bias_argument(f)], sliding_signs_argument(f)].concat(),
            shape: constrained_solution_shape(f),
            ..Declaration::default()
        },
    )
    .without_batched_variant(),
];

fn constraint_facts(f: &Facts) -> ConstraintFacts {
    f.constraints.unwrap_or_default()
}

fn force_argument(f: &Facts) -> Argument {
    Argument::Given("force", SuppliedQuantity::Force, f.nv)
}

fn bias_argument(f: &Facts) -> Argument {
    Argument::Given("bias", SuppliedQuantity::Bias, constraint_facts(f).all)
}

/// Returns the argument with the signs of the normal forces of sliding contacts; an empty list without such
/// contacts.
fn sliding_signs_argument(f: &Facts) -> Vec<Argument> {
    let slipping = constraint_facts(f).slipping;
    if slipping > 0 { vec![Argument::Given("sides", SuppliedQuantity::Side, slipping)] } else { Vec::new() }
}

/// Returns the shape of the constrained dynamics: accelerations and multipliers with measures of their
/// reliability, or for redundant constraints the quantities from which the runtime solves for them.
fn constrained_solution_shape(f: &Facts) -> Shape {
    let (nv, nc) = (f.nv, constraint_facts(f).all);
    Shape::Record(match constraint_facts(f).overdetermined {
        true => Record::Responses(nv, nc),
        false => Record::Elimination(nv, nc),
    })
}
