//! Handwritten functions, which call other generated functions and the runtime.

use super::facts::Need;
use super::row::Row;
use crate::syntax::Word;

const ASKED: &[Need] = &[Need::Inertia, Need::Asks(Word::Derivatives)];
const ASKED_WITHOUT_SPEEDS: &[Need] = &[Need::Inertia, Need::Asks(Word::Derivatives), Need::NoSpeeds];
const SOLVED: &[Need] = &[Need::Constraints, Need::Inertia];

/// Rows of the catalogue for constrained dynamics, assembly and projection.
pub const CONSTRAINED: &[Row] = &[
    Row::written("forward_dynamics", &[Need::Inertia, Need::Constraints]).and_batched(),
    Row::written(
        "forward_dynamics_derivatives",
        &[Need::Inertia, Need::Asks(Word::Derivatives), Need::Constraints],
    ),
    Row::written("linearize", &[Need::Inertia, Need::Asks(Word::Derivatives), Need::Constraints]),
    Row::written(
        "multiplier_derivatives",
        &[Need::Inertia, Need::Asks(Word::Derivatives), Need::Constraints, Need::NoSlipping],
    ),
    Row::written("assemble", &[Need::Constraints]),
    Row::written("assemble_in_mode", &[Need::Constraints]),
    Row::written("assembly_mode", &[Need::Constraints]),
    Row::written("complete_acceleration", SOLVED),
    Row::written("complete_velocity", SOLVED),
    Row::written("constrained_inverse_dynamics", &[Need::Constraints, Need::Inertia, Need::NoSlipping]),
    Row::written("constrained_dynamics", SOLVED),
    Row::written("constraint_correction", SOLVED),
    Row::written("__constraint_solution", SOLVED),
    Row::written("project_configuration", SOLVED),
    Row::written("project_velocity", SOLVED),
    Row::written("try_constrained_dynamics", &[Need::Constraints, Need::Inertia, Need::Slipping]),
];

/// Rows of the configuration space, frames, and the prepared mechanism.
pub const ROWS: &[Row] = &[
    Row::written("difference", &[]).and_batched(),
    Row::written("integrate", &[]).and_batched(),
    Row::written("displacement_rate", &[Need::Speeds]).and_batched(),
    Row::written("tangent_rate", &[Need::NoSpeeds]).and_batched(),
    Row::written("generalized_forces_derivatives", ASKED),
    Row::written(
        "forward_dynamics_second_derivatives",
        &[Need::Inertia, Need::Asks(Word::SecondDerivatives), Need::NoSlipping],
    ),
    Row::written("integrate_derivatives", ASKED_WITHOUT_SPEEDS),
    Row::written("tangent_rate_derivatives", ASKED_WITHOUT_SPEEDS),
    Row::written("frame_acceleration", &[]),
    Row::written("frame_index", &[]),
    Row::written("frame_jacobian", &[]),
    Row::written("frame_placement", &[]),
    Row::written("frame_placements", &[]),
    Row::written("frame_velocity", &[]),
    Row::written("validate", &[Need::Parameters]),
    Row::written("from_file", &[Need::FileParameters]),
    Row::written("inertials", &[Need::FileInertials]),
    Row::written("set_inertials", &[Need::FileInertials]),
    Row::written("set_base_parameters", &[Need::Inertia, Need::Asks(Word::Regressor), Need::FileInertials]),
    Row::written("prepare", &[Need::Inertia, Need::Asks(Word::Prepare)]),
];
