//! Rows of the catalogue for the associated constants of generated types.

use super::facts::{Facts, Need};
use crate::syntax::Word;

/// Names of the associated constants of mechanisms, with the requirements of each.
const CONSTANTS: [(&str, &[Need]); 28] = [
    ("BASE_PARAMETERS", &[Need::Inertia, Need::Asks(Word::Regressor)]),
    ("BODIES", &[Need::Inertia, Need::Asks(Word::Regressor)]),
    ("CONFIGURATION", &[]),
    ("CONSERVED", &[Need::Inertia, Need::Asks(Word::Conserved)]),
    ("CONSTRAINTS", &[Need::Constraints]),
    ("CONTACTS", &[Need::Contacts]),
    ("CONTACT_ROWS", &[Need::Contacts]),
    ("CYCLIC", &[Need::Inertia, Need::Asks(Word::Routh), Need::NoConstraints]),
    ("DRAWING", &[Need::Asks(Word::Drawing)]),
    ("EQUATIONS", &[]),
    ("EQUATIONS_LATEX", &[]),
    ("EQUILIBRIA", &[Need::Inertia, Need::Equilibria]),
    ("FILE", &[Need::FileParameters]),
    ("FRAMES", &[]),
    ("INPUTS", &[]),
    ("LINEAR_EQUATIONS", &[Need::Inertia, Need::Equilibria]),
    ("LINEAR_EQUATIONS_LATEX", &[Need::Inertia, Need::Equilibria]),
    ("LINKS", &[Need::FileInertials]),
    ("MASS_MATRIX_ENTRIES", &[Need::Inertia, Need::Asks(Word::Packed)]),
    ("NC", &[Need::Constraints]),
    ("NH", &[Need::Constraints]),
    ("NP", &[Need::Constraints]),
    ("NQ", &[]),
    ("NS", &[Need::Constraints]),
    ("NU", &[]),
    ("NV", &[]),
    ("PARAMETERS", &[Need::Inertia, Need::Asks(Word::Sensitivities)]),
    ("VELOCITIES", &[]),
];

/// Returns true for the name of a constant that a mechanism may have.
pub fn is_constant(name: &str) -> bool {
    CONSTANTS.iter().any(|(known, _)| *known == name)
}

/// Returns the constants that a mechanism with these facts lacks because of a need.
pub fn absent_constants(need: Need, facts: &Facts) -> Vec<&'static str> {
    let first_unmet_need = |needs: &[Need]| needs.iter().copied().find(|need| !facts.meets_need(*need));
    CONSTANTS
        .iter()
        .filter(|(_, needs)| first_unmet_need(needs) == Some(need))
        .map(|(name, _)| *name)
        .collect()
}
