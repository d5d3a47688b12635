//! `linkwork simulate`: a motion as comma-separated values.

use crate::Stop;
use crate::export::put;
use crate::input::{Compiled, Input};
use crate::motion::{Sample, Start};
use clap::ArgMatches;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Model;

pub fn run(matches: &ArgMatches) -> Result<(), Stop> {
    let input = Input::one(matches)?;
    let graph = Graph::new();
    let Compiled { source, model, output } = input.compiled(&graph)?;
    let samples = Start::new(&source, &model, &output, matches)?.run(matches)?;
    put(matches, &csv(&model, &samples))
}

fn csv(model: &Model<'_>, samples: &[Sample]) -> String {
    let mut head = vec!["t".to_string()];
    head.extend(model.configuration.iter().map(|name| format!("q.{name}")));
    head.extend(model.velocities.iter().map(|(name, _)| format!("v.{name}")));
    head.extend(model.inputs.iter().map(|(name, _)| format!("u.{name}")));
    let quoted = |name: &String| match name.contains([',', '"']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.clone(),
    };
    let mut text = head.iter().map(quoted).collect::<Vec<_>>().join(",");
    text.push_str("\r\n");
    for sample in samples {
        let numbers = std::iter::once(&sample.t).chain(&sample.q).chain(&sample.v).chain(&sample.u);
        text.push_str(&numbers.map(f64::to_string).collect::<Vec<_>>().join(","));
        text.push_str("\r\n");
    }
    text
}
