//! Residuals, rates and Jacobians of the constraints, and the eliminations for constrained dynamics.

use super::facts::{ConstraintFacts, Facts, Need};
use super::row::{Declaration, Id, Row};
use super::shape::Argument::{Q, Tau, V};
use super::shape::{Argument, Record, Shape};
use crate::mechanism::Supplied;

const SOLVED: &[Need] = &[Need::Constraints, Need::Inertia];

/// Rows of the functions of mechanisms with constraints that are derived from equations.
pub const ROWS: &[Row] = &[
    Row::derived(Id::ConstraintResiduals, "constraint_residuals", &[Need::Constraints], |f| Declaration {
        arguments: vec![Q],
        shape: Shape::Vector(constraint_facts(f).holonomic),
        docs: vec![
            "Residuals `φ(q)` of the holonomic constraints, m and rad: zero if the constraints are \
             satisfied.",
        ],
        ..Declaration::default()
    }),
    Row::derived(Id::ConstraintRates, "constraint_rates", &[Need::Constraints], |f| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Vector(constraint_facts(f).all),
        docs: vec![
            "Velocities `J(q) v + …` of all constraints, m/s and rad/s: zero if the constraints are \
             satisfied.",
        ],
        ..Declaration::default()
    }),
    Row::derived(Id::ConstraintJacobian, "constraint_jacobian", &[Need::Constraints], |f| Declaration {
        arguments: vec![Q],
        shape: Shape::Matrix(constraint_facts(f).all, f.nv),
        docs: vec![
            "Jacobian `J(q)` of the constraints: derivatives of the constraint velocities with respect to \
             `v`.",
        ],
        ..Declaration::default()
    }),
    Row::derived(Id::ConstraintBias, "constraint_bias", &[Need::Constraints], |f| Declaration {
        arguments: vec![Q, V],
        shape: Shape::Vector(constraint_facts(f).all),
        docs: vec![
            "Bias `b(q, v)` of the constraints, m/s² and rad/s²: the time derivative of the constraint \
             velocities is `J v̇ + b`.",
        ],
        ..Declaration::default()
    }),
    Row::derived(Id::ConstraintResponse, "__constraint_correction", SOLVED, |f| Declaration {
        arguments: vec![Q, force(f), bias(f)],
        shape: solution(f),
        ..Declaration::default()
    })
    .unbatched(),
    Row::derived(Id::ConstrainedDynamics, "__constrained_dynamics", SOLVED, |f| Declaration {
        arguments: [vec![Q, V, Tau], sides(f)].concat(),
        shape: solution(f),
        ..Declaration::default()
    })
    .unbatched(),
    Row::derived(
        Id::SlippingResponse,
        "__slipping_response",
        &[Need::Constraints, Need::Inertia, Need::Slipping],
        |f| Declaration {
            arguments: [vec![Q, V, force(f), bias(f)], sides(f)].concat(),
            shape: solution(f),
            ..Declaration::default()
        },
    )
    .unbatched(),
];

fn constraint_facts(f: &Facts) -> ConstraintFacts {
    f.constraints.unwrap_or_default()
}

fn force(f: &Facts) -> Argument {
    Argument::Given("force", Supplied::Force, f.nv)
}

fn bias(f: &Facts) -> Argument {
    Argument::Given("bias", Supplied::Bias, constraint_facts(f).all)
}

/// Returns the argument with the signs of the normal forces of sliding contacts; the list is empty without
/// such contacts.
fn sides(f: &Facts) -> Vec<Argument> {
    let slipping = constraint_facts(f).slipping;
    if slipping > 0 { vec![Argument::Given("sides", Supplied::Side, slipping)] } else { Vec::new() }
}

/// Returns the shape of the constrained dynamics: accelerations and multipliers with measures of their
/// reliability, or for redundant constraints the quantities from which the runtime solves for them.
fn solution(f: &Facts) -> Shape {
    let (nv, nc) = (f.nv, constraint_facts(f).all);
    Shape::Record(match constraint_facts(f).overdetermined {
        true => Record::Responses(nv, nc),
        false => Record::Elimination(nv, nc),
    })
}
