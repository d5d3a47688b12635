//! `linkwork simulate`: writes a motion as comma-separated values, or as an MCAP log.

use crate::Stop;
use crate::export::write_output;
use crate::input::MechanismInput;
use crate::motion::{MotionStart, Sample};
use clap::ArgMatches;
use linkwork_compiler::expr::Graph;
use linkwork_view::{Instant, Names, mcap_of};
use std::path::PathBuf;

pub fn run_simulate(matches: &ArgMatches) -> Result<(), Stop> {
    let input = MechanismInput::select_one_mechanism(matches)?;
    let graph = Graph::new();
    let loaded = input.load_mechanism(&graph)?;
    let start = MotionStart::new(&loaded, matches)?;
    let samples = start.simulate_motion(matches)?;
    match matches.get_one::<PathBuf>("out") {
        Some(path) if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap")) => {
            let log = mcap_log_bytes(&start, samples)?;
            std::fs::write(path, log)
                .map_err(|error| Stop::Failure(format!("cannot write {}: {error}", path.display())))
        }
        _ => write_output(matches, &csv_log_text(&start, &samples)),
    }
}

/// Returns the MCAP log of a motion with the placements of all frames.
fn mcap_log_bytes(start: &MotionStart<'_, '_>, samples: Vec<Sample>) -> Result<Vec<u8>, Stop> {
    let model = start.model;
    let frames: Vec<&str> = model.frames.iter().map(|frame| frame.name.as_str()).collect();
    let configuration: Vec<&str> = model.configuration.iter().map(String::as_str).collect();
    let velocities = model.velocities.iter().map(|(name, _)| name.as_str());
    // As in Rust, where states of first order are the last entries of the velocity of `extended()`.
    let states = start.states.iter().map(String::as_str);
    let velocities: Vec<&str> = velocities.chain(states).collect();
    let inputs: Vec<&str> = model.inputs.iter().map(|(name, _)| name.as_str()).collect();
    let names =
        Names { frames: &frames, configuration: &configuration, velocities: &velocities, inputs: &inputs };
    let instant_from_sample = |Sample { t, q, v, x, u }| {
        let placements = start.frame_placements(t, &q, &x)?;
        Ok(Instant { t, q, v: [v, x].concat(), u, placements })
    };
    let instants = samples.into_iter().map(instant_from_sample).collect::<Result<Vec<_>, Stop>>()?;
    Ok(mcap_of(&names, instants)?)
}

fn csv_log_text(start: &MotionStart<'_, '_>, samples: &[Sample]) -> String {
    let model = start.model;
    let mut head = vec!["t".to_string()];
    head.extend(model.configuration.iter().map(|name| format!("q.{name}")));
    head.extend(model.velocities.iter().map(|(name, _)| format!("v.{name}")));
    head.extend(start.states.iter().map(|name| format!("x.{name}")));
    head.extend(model.inputs.iter().map(|(name, _)| format!("u.{name}")));
    let quote_csv_cell = |name: &String| match name.contains([',', '"']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.clone(),
    };
    let mut text = head.iter().map(quote_csv_cell).collect::<Vec<_>>().join(",");
    text.push_str("\r\n");
    for sample in samples {
        let numbers = std::iter::once(&sample.t).chain(&sample.q).chain(&sample.v);
        let numbers = numbers.chain(&sample.x).chain(&sample.u);
        text.push_str(&numbers.map(f64::to_string).collect::<Vec<_>>().join(","));
        text.push_str("\r\n");
    }
    text
}
