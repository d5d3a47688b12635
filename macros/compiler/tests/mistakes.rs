//! Typical errors of users who know other tools or a textbook. Each causes one error, whose help names the
//! correct expression. Each row of a table contains the source text, the first line of the message and a part
//! of the help.

use linkwork_compiler::check_mechanism;
use std::path::Path;

#[path = "mistakes/angles.rs"]
mod angles;
#[path = "mistakes/arguments.rs"]
mod arguments;
#[path = "mistakes/attributes.rs"]
mod attributes;
#[path = "mistakes/elements.rs"]
mod elements;
#[path = "mistakes/equilibria.rs"]
mod equilibria;
#[path = "mistakes/expressions.rs"]
mod expressions;
#[path = "mistakes/figures.rs"]
mod figures;
#[path = "mistakes/files.rs"]
mod files;
#[path = "mistakes/forms.rs"]
mod forms;
#[path = "mistakes/grammar.rs"]
mod grammar;
#[path = "mistakes/idle.rs"]
mod idle;
#[path = "mistakes/joints.rs"]
mod joints;
#[path = "mistakes/motions.rs"]
mod motions;
#[path = "mistakes/options.rs"]
mod options;
#[path = "mistakes/rounds.rs"]
mod rounds;
#[path = "mistakes/several.rs"]
mod several;
#[path = "mistakes/slips.rs"]
mod slips;
#[path = "mistakes/speeds.rs"]
mod speeds;
#[path = "mistakes/tables.rs"]
mod tables;

/// Source text, first line of the message and part of the help.
type ErrorRow = (&'static str, &'static str, &'static str);

/// Function that inserts a source text into the arguments of the attribute or the fields.
type SourceInserter = fn(&str) -> (String, String);

/// Test mechanism: a single arm on a hinge.
const ARM: &str = "#[body(mass = 1, com = -y, inertia = sphere(1, 0.1))] arm: Body,
    #[joint(ground -> arm, about = z)] hinge: Pin,";

/// Test mechanism: a cart that slides along a rail.
const CART: &str = "#[body(mass = 1)] cart: Body, #[joint(ground -> cart, along = x)] rail: Sleeve,";

/// Returns the error messages of the compiler for a mechanism.
fn compiler_messages(attribute: &str, fields: &str) -> Vec<String> {
    let struct_ = format!("struct Machine {{ {fields} }}");
    match (attribute.parse(), struct_.parse()) {
        (Ok(attribute), Ok(item)) => check_mechanism(attribute, item, Path::new(env!("CARGO_TARGET_TMPDIR"))),
        _ => vec!["these are no tokens".to_string()],
    }
}

/// Checks that the mechanism of each table row causes exactly the expected error.
fn check_error_rows(setting: SourceInserter, rows: &[ErrorRow]) {
    let mut wrong = Vec::new();
    for (said, message, help) in rows {
        let (attribute, fields) = setting(said);
        let found = compiler_messages(&attribute, &fields);
        let good = match found.as_slice() {
            [one] => {
                let (first, rest) = one.split_once('\n').unwrap_or((one, ""));
                first == *message && rest.contains("= help: ") && rest.contains(help)
            }
            _ => false,
        };
        if !good {
            wrong
                .push(format!("{said}\nexpected {message}\n  with {help}\nfound {}", found.join("\n  and ")));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n\n{}", wrong.len(), rows.len(), wrong.join("\n\n"));
}

/// Checks the number of errors that the mechanism of each table row causes.
fn check_error_counts(rows: &[(&str, &str, usize)]) {
    for (attribute, fields, count) in rows {
        let found = compiler_messages(attribute, fields);
        assert!(found.len() == *count, "{fields}\nexpected {count} errors, found\n{}", found.join("\n"));
    }
}
