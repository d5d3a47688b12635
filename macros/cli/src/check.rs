//! `linkwork check`: every mistake with its place.

use crate::Stop;
use crate::input::Input;
use clap::ArgMatches;
use linkwork_compiler::compile;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use serde_json::{Value, json};

pub fn run(matches: &ArgMatches) -> Result<(), Stop> {
    let inputs = Input::all(matches)?;
    let as_json = matches.get_flag("json");
    let (mut all, mut good) = (Vec::new(), true);
    for input in &inputs {
        let cx = &mut Diagnostics::new();
        if let Some(source) = input.read(cx) {
            compile(&source, &Graph::new(), cx);
        }
        good &= cx.is_empty();
        if as_json {
            all.extend(cx.distinct().map(|one| message(input, one)));
        } else if cx.is_empty() {
            crate::say!("{}: `{}` is in order", input.file.display(), input.name);
        } else {
            input.report(cx);
        }
    }
    if as_json {
        crate::say!("{:#}", json!({ "messages": all }));
    }
    if good { Ok(()) } else { Err(Stop::Mistakes) }
}

fn message(input: &Input, one: &linkwork_compiler::diag::Diagnostic) -> Value {
    let (file, line, column) = input.position(one);
    json!({
        "level": "error",
        "mechanism": input.name,
        "file": file,
        "line": line,
        "column": column,
        "message": one.message(),
        "notes": one.notes(),
        "help": one.helps(),
    })
}
