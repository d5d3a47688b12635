//! The command `linkwork check`: lists every error with its location.

use crate::Stop;
use crate::input::{MechanismInput, SourceError};
use clap::ArgMatches;
use linkwork_compiler::compile;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use serde_json::{Value, json};

pub fn run_check(matches: &ArgMatches) -> Result<(), Stop> {
    let as_json = matches.get_flag("json");
    let inputs = match MechanismInput::select_mechanisms(matches) {
        Err(Stop::Syntax(error)) if as_json => {
            crate::say!("{:#}", json!({ "messages": [error_as_json(&error)] }));
            return Err(Stop::Errors);
        }
        inputs => inputs?,
    };
    let (mut all, mut good) = (Vec::new(), true);
    for input in &inputs {
        let cx = &mut Diagnostics::new();
        if let Some(source) = input.parse_source(cx) {
            compile(&source, &Graph::new(), cx);
        }
        good &= cx.is_empty();
        if as_json {
            all.extend(cx.distinct_errors().map(|one| error_as_json(&input.error_with_location(one))));
        } else if cx.is_empty() {
            crate::say!("{}: `{}` has no errors", input.file.display(), input.declaration.name);
        } else {
            input.report_errors(cx);
        }
    }
    if as_json {
        crate::say!("{:#}", json!({ "messages": all }));
    }
    if good { Ok(()) } else { Err(Stop::Errors) }
}

fn error_as_json(error: &SourceError) -> Value {
    json!({
        "level": "error",
        "mechanism": error.mechanism,
        "file": error.file,
        "line": error.at.map(|at| at.0),
        "column": error.at.map(|at| at.1),
        "message": error.message,
        "notes": error.notes,
        "help": error.help_lines,
    })
}
