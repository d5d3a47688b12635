//! Everything that can be generated for a mechanism, a row for each function: its name, arguments, result and documentation,
//! what it needs, and whether it belongs to the trait. What is generated, what is missing and why, which names are taken
//! and what stands in for the functions of a mechanism with a mistake all follow from these rows. `derive` has the equations
//! of each by its [`Id`], without an arm for the rest: a row without equations does not compile.

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

pub use constants::{absent_constants, is_constant};
pub use facts::{ConstraintFacts, ContactSizes, Facts, Need};
pub use outputs::{BY_PARAMETERS, DERIVATIVES, JACOBIAN, REACTION, TOUCHED, output, reaction, touched};
pub use row::{Declaration, Declared, Id, Made, Row};
pub use shape::{Argument, CONTACT_FORCES, Called, InverseForm, Record, RecordField, Shape, Structure};

/// The rows in the order in which functions are generated: outputs come between both lists.
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

/// How many of the tables stand before the outputs.
const BEFORE_OUTPUTS: usize = 5;

/// All rows.
pub fn rows() -> impl Iterator<Item = &'static Row> {
    TABLES.into_iter().flatten()
}

fn declared(tables: &[&'static [Row]], facts: &Facts) -> Vec<Declared> {
    let present = tables.iter().copied().flatten().filter(|row| row.lacks(facts).is_none());
    let derived = present.filter_map(|row| match row.made {
        Made::Derived(id) => Some(row.declared(id, facts)),
        Made::Written => None,
    });
    derived.collect()
}

/// The functions of a mechanism whose bodies follow from equations: those that stand before its outputs.
pub fn before_outputs(facts: &Facts) -> Vec<Declared> {
    declared(&TABLES[..BEFORE_OUTPUTS], facts)
}

/// The functions of a mechanism whose bodies follow from equations: those that stand after its outputs.
pub fn after_outputs(facts: &Facts) -> Vec<Declared> {
    declared(&TABLES[BEFORE_OUTPUTS..], facts)
}

/// The functions of the runtime's trait of mechanisms that depend on the state, with their arguments there and their results.
pub fn of_trait() -> impl Iterator<Item = (&'static Row, &'static [Argument])> {
    dynamics::ROWS.iter().filter_map(|row| Some((row, row.in_trait?)))
}

/// What a mechanism with these facts lacks, by what it would need for it, in the order of the needs.
pub fn absent(facts: &Facts) -> Vec<(Need, Vec<&'static Row>)> {
    let of = |need: Need| {
        // Another row may have the function after all.
        let is_there = |row: &Row| rows().any(|r| r.name == row.name && r.lacks(facts).is_none());
        let all = rows().filter(|row| !row.is_hidden() && row.lacks(facts) == Some(need) && !is_there(row));
        let mut found: Vec<&'static Row> = Vec::new();
        for row in all {
            if found.iter().all(|known| known.name != row.name) {
                found.push(row);
            }
        }
        (need, found)
    };
    Need::all().map(of).collect()
}

/// The functions that are written for several states, too.
pub fn written_in_lanes(facts: &Facts) -> impl Iterator<Item = &'static str> {
    let written = rows().filter(|row| row.batched && matches!(row.made, Made::Written));
    written.filter(|row| row.lacks(facts).is_none()).map(|row| row.name)
}

/// True if a mechanism with these facts has a function of this name beside its outputs.
pub fn has(name: &str, facts: &Facts) -> bool {
    let mut present = rows().filter(|row| row.lacks(facts).is_none());
    let one = name.strip_suffix("_lanes").filter(|_| facts.requests.batch);
    present.any(|row| row.name == name || (row.batched && Some(row.name) == one))
}
