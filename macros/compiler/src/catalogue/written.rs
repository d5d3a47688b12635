//! Catalogue rows of handwritten functions, which call other generated functions and the runtime.

use super::facts::Need;
use super::row::Row;
use crate::syntax::Word;

const ASKED: &[Need] = &[Need::Inertia, Need::Asks(Word::Derivatives)];
const ASKED_WITHOUT_SPEEDS: &[Need] = &[Need::Inertia, Need::Asks(Word::Derivatives), Need::NoSpeeds];
const SOLVED: &[Need] = &[Need::Constraints, Need::Inertia];

/// Rows of the catalogue for constrained dynamics, assembly and projection.
pub const CONSTRAINED: &[Row] = &[
    Row::handwritten_row("forward_dynamics", &[Need::Inertia, Need::Constraints]).with_batched_variant(),
    Row::handwritten_row(
        "forward_dynamics_derivatives",
        &[Need::Inertia, Need::Asks(Word::Derivatives), Need::Constraints],
    ),
    Row::handwritten_row("linearize", &[Need::Inertia, Need::Asks(Word::Derivatives), Need::Constraints]),
    Row::handwritten_row(
        "multiplier_derivatives",
        &[Need::Inertia, Need::Asks(Word::Derivatives), Need::Constraints, Need::NoSlipping],
    ),
    Row::handwritten_row("assemble", &[Need::Constraints]),
    Row::handwritten_row("assemble_in_mode", &[Need::Constraints]),
    Row::handwritten_row("assembly_mode", &[Need::Constraints]),
    Row::handwritten_row("complete_acceleration", SOLVED),
    Row::handwritten_row("complete_velocity", SOLVED),
    Row::handwritten_row(
        "constrained_inverse_dynamics",
        &[Need::Constraints, Need::Inertia, Need::NoSlipping],
    ),
    Row::handwritten_row("constrained_dynamics", SOLVED),
    Row::handwritten_row("constraint_correction", SOLVED),
    Row::handwritten_row("__constraint_solution", SOLVED),
    Row::handwritten_row("project_configuration", SOLVED),
    Row::handwritten_row("project_velocity", SOLVED),
    Row::handwritten_row("try_constrained_dynamics", &[Need::Constraints, Need::Inertia, Need::Slipping]),
];

/// Rows of the configuration space, frames, and the prepared mechanism.
pub const ROWS: &[Row] = &[
    Row::handwritten_row("difference", &[]).with_batched_variant(),
    Row::handwritten_row("integrate", &[]).with_batched_variant(),
    Row::handwritten_row("displacement_rate", &[Need::Speeds]).with_batched_variant(),
    Row::handwritten_row("tangent_rate", &[Need::NoSpeeds]).with_batched_variant(),
    Row::handwritten_row("generalized_forces_derivatives", ASKED),
    Row::handwritten_row(
        "forward_dynamics_second_derivatives",
        &[Need::Inertia, Need::Asks(Word::SecondDerivatives), Need::NoSlipping],
    ),
    Row::handwritten_row("integrate_derivatives", ASKED_WITHOUT_SPEEDS),
    Row::handwritten_row("tangent_rate_derivatives", ASKED_WITHOUT_SPEEDS),
    Row::handwritten_row("frame_acceleration", &[]),
    Row::handwritten_row("frame_index", &[]),
    Row::handwritten_row("frame_jacobian", &[]),
    Row::handwritten_row("frame_placement", &[]),
    Row::handwritten_row("frame_placements", &[]),
    Row::handwritten_row("frame_velocity", &[]),
    Row::handwritten_row("validate", &[Need::Parameters]),
    Row::handwritten_row("from_file", &[Need::FileParameters]),
    Row::handwritten_row("inertials", &[Need::FileInertials]),
    Row::handwritten_row("set_inertials", &[Need::FileInertials]),
    Row::handwritten_row(
        "set_base_parameters",
        &[Need::Inertia, Need::Asks(Word::Regressor), Need::FileInertials],
    ),
    Row::handwritten_row("prepare", &[Need::Inertia, Need::Asks(Word::Prepare)]),
];
