//! Rows of the catalogue for the associated constants of generated types.

use super::facts::{Facts, FunctionNeed};
use crate::syntax::RequestOption;

/// Names of the associated constants of mechanisms, with the requirements of each.
const CONSTANTS: [(&str, &[FunctionNeed]); 28] = [
    ("BASE_PARAMETERS", &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Regressor)]),
    ("BODIES", &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Regressor)]),
    ("CONFIGURATION", &[]),
    ("CONSERVED", &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Conserved)]),
    ("CONSTRAINTS", &[FunctionNeed::Constraints]),
    ("CONTACTS", &[FunctionNeed::Contacts]),
    ("CONTACT_ROWS", &[FunctionNeed::Contacts]),
    (
        "CYCLIC",
        &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Routh), FunctionNeed::NoConstraints],
    ),
    ("DRAWING", &[FunctionNeed::Asks(RequestOption::Drawing)]),
    ("EQUATIONS", &[]),
    ("EQUATIONS_LATEX", &[]),
    ("EQUILIBRIA", &[FunctionNeed::Inertia, FunctionNeed::Equilibria]),
    ("FILE", &[FunctionNeed::FileParameters]),
    ("FRAMES", &[]),
    ("INPUTS", &[]),
    ("LINEAR_EQUATIONS", &[FunctionNeed::Inertia, FunctionNeed::Equilibria]),
    ("LINEAR_EQUATIONS_LATEX", &[FunctionNeed::Inertia, FunctionNeed::Equilibria]),
    ("LINKS", &[FunctionNeed::FileInertials]),
    ("MASS_MATRIX_ENTRIES", &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Packed)]),
    ("NC", &[FunctionNeed::Constraints]),
    ("NH", &[FunctionNeed::Constraints]),
    ("NP", &[FunctionNeed::Constraints]),
    ("NQ", &[]),
    ("NS", &[FunctionNeed::Constraints]),
    ("NU", &[]),
    ("NV", &[]),
    ("PARAMETERS", &[FunctionNeed::Inertia, FunctionNeed::Asks(RequestOption::Sensitivities)]),
    ("VELOCITIES", &[]),
];

/// Returns true for the name of a constant that a mechanism may have.
pub fn is_known_constant_name(name: &str) -> bool {
    CONSTANTS.iter().any(|(known, _)| *known == name)
}

/// Returns the constants that a mechanism with these facts lacks because of a need.
pub fn absent_constants(need: FunctionNeed, facts: &Facts) -> Vec<&'static str> {
    let first_unmet_need =
        |needs: &[FunctionNeed]| needs.iter().copied().find(|need| !facts.meets_need(*need));
    CONSTANTS
        .iter()
        .filter(|(_, needs)| first_unmet_need(needs) == Some(need))
        .map(|(name, _)| *name)
        .collect()
}
