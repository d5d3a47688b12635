//! Catalogue of everything that can be generated for a mechanism, with one row per function: name, arguments,
//! result, documentation, requirements, and whether it belongs to the trait. The rows determine which
//! functions are generated, which are absent and why, which names are reserved, and the placeholders that are
//! generated for a mechanism with an error. `derive` has the equations of each row by its [`GeneratedId`],
//! without a default arm: a row without equations does not compile.

mod constants;
mod constraints;
mod contacts;
mod derivatives;
mod dynamics;
mod facts;
mod outputs;
mod requested;
mod row;
mod shape;
mod speeds;
mod written;

pub use constants::{absent_constants, is_known_constant_name};
pub use facts::{ConstraintFacts, ContactCounts, Facts, FunctionNeed};
pub use outputs::{
    BY_PARAMETERS, DERIVATIVES, JACOBIAN, REACTION, TOUCHED, contact_force_output_function, output_functions,
    reaction_output_function,
};
pub use row::{Declaration, DeclaredFunction, FunctionBodyOrigin, GeneratedId, Row};
pub use shape::{Argument, CalledFunction, InverseForm, MatrixStructure, Record, RecordField, Shape};

/// The rows, in the order in which functions are generated. The functions of the outputs are generated after
/// the first [`BEFORE_OUTPUTS`] tables.
const TABLES: [&[Row]; 13] = [
    dynamics::ROWS,
    speeds::ROWS,
    constraints::ROWS,
    contacts::ROWS,
    requested::CENTROIDAL,
    derivatives::ROWS,
    speeds::DERIVATIVES,
    derivatives::MOMENTUM_ROWS,
    derivatives::SECOND_ROWS,
    requested::CANONICAL,
    requested::ROWS,
    written::CONSTRAINED,
    written::ROWS,
];

/// Number of tables whose functions are generated before the outputs.
const BEFORE_OUTPUTS: usize = 5;

/// Returns all rows of the catalogue.
pub fn function_catalogue_rows() -> impl Iterator<Item = &'static Row> {
    TABLES.into_iter().flatten()
}

fn declared_functions(tables: &[&'static [Row]], facts: &Facts) -> Vec<DeclaredFunction> {
    let present = tables.iter().copied().flatten().filter(|row| row.first_unmet_need(facts).is_none());
    let is_requested = |id: &GeneratedId| !facts.requests.separate_contact || contacts::SEPARATE.contains(id);
    let derived = present.filter_map(|row| match row.made {
        FunctionBodyOrigin::Derived(id) if is_requested(&id) => Some(row.declare_function(id, facts)),
        FunctionBodyOrigin::Derived(_) => None,
        FunctionBodyOrigin::Written => None,
    });
    derived.collect()
}

/// Returns the functions of a mechanism that are derived from equations and generated before its outputs.
pub fn functions_derived_before_outputs(facts: &Facts) -> Vec<DeclaredFunction> {
    declared_functions(&TABLES[..BEFORE_OUTPUTS], facts)
}

/// Returns the functions of a mechanism that are derived from equations and generated after its outputs.
pub fn functions_derived_after_outputs(facts: &Facts) -> Vec<DeclaredFunction> {
    declared_functions(&TABLES[BEFORE_OUTPUTS..], facts)
}

/// Returns the state-dependent functions of the runtime's mechanism trait, with their arguments in the trait.
pub fn mechanism_trait_rows() -> impl Iterator<Item = (&'static Row, &'static [Argument])> {
    dynamics::ROWS.iter().filter_map(|row| Some((row, row.in_trait?)))
}

/// Returns the functions that a mechanism with these facts lacks, grouped by the first need that is not met,
/// in the order of the needs.
pub fn absent_functions(facts: &Facts) -> Vec<(FunctionNeed, Vec<&'static Row>)> {
    let rows_absent_for_need = |need: FunctionNeed| {
        // Another row of the same name may be present.
        let is_row_present = |row: &Row| {
            function_catalogue_rows().any(|r| r.name == row.name && r.first_unmet_need(facts).is_none())
        };
        let all = function_catalogue_rows().filter(|row| {
            !row.is_hidden() && row.first_unmet_need(facts) == Some(need) && !is_row_present(row)
        });
        let mut found: Vec<&'static Row> = Vec::new();
        for row in all {
            if found.iter().all(|known| known.name != row.name) {
                found.push(row);
            }
        }
        (need, found)
    };
    FunctionNeed::needs_in_reporting_order().map(rows_absent_for_need).collect()
}

/// Returns the names of the functions with handwritten bodies that also have a batched variant.
pub fn handwritten_batched_functions(facts: &Facts) -> impl Iterator<Item = &'static str> {
    let written = function_catalogue_rows()
        .filter(|row| row.batched && matches!(row.made, FunctionBodyOrigin::Written));
    written.filter(|row| row.first_unmet_need(facts).is_none()).map(|row| row.name)
}

/// Returns true if a mechanism with these facts has a function of this name that is not an output.
pub fn has_function(name: &str, facts: &Facts) -> bool {
    let mut present = function_catalogue_rows().filter(|row| row.first_unmet_need(facts).is_none());
    let one = name.strip_suffix("_lanes").filter(|_| facts.requests.batch);
    present.any(|row| row.name == name || (row.batched && Some(row.name) == one))
}
