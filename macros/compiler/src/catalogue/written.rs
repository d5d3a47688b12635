//! Catalogue rows of handwritten functions, which call other generated functions and the runtime.

use super::facts::FunctionNeed;
use super::row::Row;
use crate::syntax::RequestOption;

const ASKED: &[FunctionNeed] = &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives)];
const ASKED_WITHOUT_SPEEDS: &[FunctionNeed] =
    &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives), FunctionNeed::NoSpeeds];
const SOLVED: &[FunctionNeed] = &[FunctionNeed::Constraints, FunctionNeed::Inertia];

/// Rows of the catalogue for constrained dynamics, assembly and projection.
pub const CONSTRAINED: &[Row] = &[
    Row::handwritten_row("forward_dynamics", &[FunctionNeed::Inertia, FunctionNeed::Constraints])
        .with_batched_variant(),
    Row::handwritten_row(
        "forward_dynamics_derivatives",
        &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives), FunctionNeed::Constraints],
    ),
    Row::handwritten_row(
        "linearize",
        &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Derivatives), FunctionNeed::Constraints],
    ),
    Row::handwritten_row(
        "multiplier_derivatives",
        &[
            FunctionNeed::Inertia,
            FunctionNeed::Asks(RequestOption::Derivatives),
            FunctionNeed::Constraints,
            FunctionNeed::NoSlipping,
        ],
    ),
    Row::handwritten_row("assemble", &[FunctionNeed::Constraints]),
    Row::handwritten_row("assemble_in_mode", &[FunctionNeed::Constraints]),
    Row::handwritten_row("assembly_mode", &[FunctionNeed::Constraints]),
    Row::handwritten_row("complete_acceleration", SOLVED),
    Row::handwritten_row("complete_velocity", SOLVED),
    Row::handwritten_row(
        "constrained_inverse_dynamics",
        &[FunctionNeed::Constraints, FunctionNeed::Inertia, FunctionNeed::NoSlipping],
    ),
    Row::handwritten_row("constrained_dynamics", SOLVED),
    Row::handwritten_row("constraint_correction", SOLVED),
    Row::handwritten_row("__constraint_solution", SOLVED),
    Row::handwritten_row("project_configuration", SOLVED),
    Row::handwritten_row("project_velocity", SOLVED),
    Row::handwritten_row(
        "try_constrained_dynamics",
        &[FunctionNeed::Constraints, FunctionNeed::Inertia, FunctionNeed::Slipping],
    ),
];

/// Rows of the configuration space, frames, and the prepared mechanism.
pub const ROWS: &[Row] = &[
    Row::handwritten_row("difference", &[]).with_batched_variant(),
    Row::handwritten_row("integrate", &[]).with_batched_variant(),
    Row::handwritten_row("displacement_rate", &[FunctionNeed::Speeds]).with_batched_variant(),
    Row::handwritten_row("tangent_rate", &[FunctionNeed::NoSpeeds]).with_batched_variant(),
    Row::handwritten_row("generalized_forces_derivatives", ASKED),
    Row::handwritten_row(
        "forward_dynamics_second_derivatives",
        &[
            FunctionNeed::Inertia,
            FunctionNeed::Asks(RequestOption::SecondDerivatives),
            FunctionNeed::NoSlipping,
        ],
    ),
    Row::handwritten_row("integrate_derivatives", ASKED_WITHOUT_SPEEDS),
    Row::handwritten_row("tangent_rate_derivatives", ASKED_WITHOUT_SPEEDS),
    Row::handwritten_row("frame_acceleration", &[]),
    Row::handwritten_row("frame_index", &[]),
    Row::handwritten_row("frame_jacobian", &[]),
    Row::handwritten_row("frame_placement", &[]),
    Row::handwritten_row("frame_placements", &[]),
    Row::handwritten_row("frame_velocity", &[]),
    Row::handwritten_row("validate", &[FunctionNeed::Parameters]),
    Row::handwritten_row("from_file", &[FunctionNeed::FileParameters]),
    Row::handwritten_row("inertials", &[FunctionNeed::FileInertials]),
    Row::handwritten_row("set_inertials", &[FunctionNeed::FileInertials]),
    Row::handwritten_row(
        "set_base_parameters",
        &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Regressor), FunctionNeed::FileInertials],
    ),
    Row::handwritten_row("prepare", &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Prepare)]),
];
