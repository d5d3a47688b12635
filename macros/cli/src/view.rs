//! `linkwork view`: writes an HTML page that shows a motion.

use crate::Stop;
use crate::input::{LoadedMechanism, MechanismInput};
use crate::library::doc_paragraphs;
use crate::live;
use crate::motion::{MotionStart, normalise_quaternions};
use crate::table::TimeSeriesTable;
use clap::ArgMatches;
use linkwork_compiler::export::without_doc_links;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism;
use linkwork_view::{Figure, Motion, Page};
use std::path::{Path, PathBuf};

/// Plotted state: time, configuration, states of first order, and inputs if they are recorded.
type PlottedState = (f64, Vec<f64>, Vec<f64>, Vec<f64>);

/// Maximum number of coordinates that are plotted by default.
const PLOTTED: usize = 12;

pub fn run_view(matches: &ArgMatches) -> Result<(), Stop> {
    let (name, page) = mechanism_name_and_page(matches)?;
    let out = matches.get_one("out").cloned().unwrap_or_else(|| PathBuf::from(format!("{name}.html")));
    match matches.get_flag("fragment") {
        true => std::fs::write(&out, page.embedded())?,
        false => page.write(&out)?,
    }
    crate::say!("{}", out.display());
    Ok(())
}

/// Returns the name of the mechanism and the HTML page that shows it.
pub fn mechanism_name_and_page(matches: &ArgMatches) -> Result<(String, Page), Stop> {
    let mut input = MechanismInput::select_one_mechanism(matches)?;
    if !input.declaration.arguments.clone().into_iter().any(|token| token.to_string() == "drawing") {
        input.declaration.append_attribute_arguments(quote::quote!(drawing));
    }
    let graph = Graph::new();
    let loaded = input.load_mechanism(&graph)?;
    let LoadedMechanism { source, model, .. } = &loaded;
    let start = MotionStart::new(&loaded, matches)?;
    let about = without_doc_links(&doc_paragraphs(&source.mechanism.shell.attributes).join("\n\n"));
    let page = Page::new(&input.declaration.name).text(&about);
    let figure = add_meshes(declared_drawing(&start, model), &input, matches)?;
    let page = match matches.get_flag("live") {
        true => page.equations(&loaded.equations).motion(live::live_motion(&start, figure)?),
        false => page.motion(recorded_or_simulated_motion(&start, figure, matches)?),
    };
    Ok((input.declaration.name, page))
}

/// Returns the recorded motion of a log file, or the motion of a simulation.
fn recorded_or_simulated_motion(
    start: &MotionStart<'_, '_>,
    figure: Figure,
    matches: &ArgMatches,
) -> Result<Motion, Stop> {
    let model = start.model;
    let states = match matches.get_one::<PathBuf>("motion") {
        Some(path) => states_of_log(path, start)?,
        None => match start.reason_without_motion() {
            Some(why) if matches.get_one::<f64>("duration").is_none() => {
                crate::note!("linkwork: the page shows one configuration: {why}");
                vec![(0.0, start.q.clone(), start.x.clone(), Vec::new())]
            }
            _ => start.simulate_motion(matches)?.into_iter().map(|s| (s.t, s.q, s.x, s.u)).collect(),
        },
    };
    let times = states.iter().map(|(t, ..)| *t).collect();
    let placements = states.iter().map(|(t, q, x, _)| start.frame_placements(*t, q, x));
    let placements = placements.collect::<Result<Vec<_>, Stop>>()?;
    let terrain_height_at = |number: usize, place: [f64; 2]| {
        let heights = start.robot.terrain_heights(place)?;
        heights.get(number).copied()
    };
    let mut motion = Motion::from_placements("", figure, times, placements)?.terrain(terrain_height_at);
    if states.len() > 1 && model.nq() <= PLOTTED {
        let values_of_coordinate = |k: usize| states.iter().map(|(_, q, ..)| q[k]).collect();
        motion = motion.plots(
            "Coordinates",
            named_curves(&model.configuration, &model.units.configuration, values_of_coordinate),
        )?;
    }
    if states.len() > 1 && model.nu() <= PLOTTED {
        // Constant inputs are not plotted.
        let values_of_input =
            |k: usize| states.iter().map(|(.., u)| u.get(k).copied().unwrap_or(0.0)).collect();
        let curves =
            named_curves(model.inputs.iter().map(|(name, _)| name), &model.units.inputs, values_of_input);
        if curves.iter().any(|(.., values)| values.iter().any(|value| *value != values[0])) {
            motion = motion.plots("Inputs", curves)?;
        }
    }
    Ok(motion)
}

/// Returns the drawing with the meshes that are found, and prints the paths of the others.
fn add_meshes(mut figure: Figure, input: &MechanismInput, matches: &ArgMatches) -> Result<Figure, Stop> {
    let beside = input.file.parent().map(Path::to_path_buf);
    match matches.get_one::<PathBuf>("meshes") {
        Some(folder) => {
            let read = figure.meshes(folder);
            figure = read.map_err(|error| Stop::Failure(format!("`--meshes`: {error}")))?;
        }
        // Without the option, only meshes that can be read are used.
        None => {
            if let Some(folder) = beside.filter(|_| input.is_robot) {
                let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder };
                figure = figure.clone().meshes(folder).unwrap_or_else(|error| {
                    crate::note!("linkwork: meshes are not drawn: {error}");
                    figure
                });
            }
        }
    }
    let missing = figure.missing_meshes();
    if !missing.is_empty() {
        crate::note!(
            "linkwork: bodies are drawn by their mass properties where these meshes are not found (`--meshes \
             FOLDER` says where they are): {}",
            missing.join(", ")
        );
    }
    Ok(figure)
}

/// Reads the states of a log: times, configurations, first-order states and inputs.
fn states_of_log(path: &Path, start: &MotionStart<'_, '_>) -> Result<Vec<PlottedState>, Stop> {
    let table = TimeSeriesTable::read_table(path)?;
    let column_of_coordinate = |name: &String| {
        let name = format!("q.{name}");
        let found = table.column_by_name(&name);
        found.ok_or_else(|| Stop::Failure(format!("{}: there is no column `{name}`", path.display())))
    };
    let columns =
        start.model.configuration.iter().map(column_of_coordinate).collect::<Result<Vec<_>, Stop>>()?;
    // Inputs, and states, are used if the log has all of them; some of them alone are an error.
    let columns_if_all_present = |names: Vec<String>| {
        let found: Vec<Option<&[f64]>> = names.iter().map(|name| table.column_by_name(name)).collect();
        match found.iter().position(Option::is_none).filter(|_| found.iter().any(Option::is_some)) {
            Some(k) => Err(Stop::Failure(format!("{}: there is no column `{}`", path.display(), names[k]))),
            None => Ok(found.into_iter().collect::<Option<Vec<&[f64]>>>()),
        }
    };
    let inputs = start.model.inputs.iter().map(|(name, _)| format!("u.{name}"));
    let inputs = columns_if_all_present(inputs.collect())?.unwrap_or_default();
    let states = columns_if_all_present(start.states.iter().map(|name| format!("x.{name}")).collect())?;
    let state_of_log_row = |(k, t): (usize, &f64)| {
        let mut q: Vec<f64> = columns.iter().map(|column| column[k]).collect();
        normalise_quaternions(start.model, &mut q)?;
        let u = inputs.iter().map(|column| column[k]).collect();
        let x = states
            .as_ref()
            .map_or(start.x.clone(), |columns| columns.iter().map(|column| column[k]).collect());
        Ok((*t, q, x, u))
    };
    table.times.iter().enumerate().map(state_of_log_row).collect()
}

/// Returns the curves of a plot with their units and names.
fn named_curves<'n>(
    names: impl IntoIterator<Item = &'n String>,
    units: &'n [String],
    values: impl Fn(usize) -> Vec<f64>,
) -> Vec<(&'n str, &'n str, Vec<f64>)> {
    let unit_at_index = |k: usize| units.get(k).map_or("", String::as_str);
    names.into_iter().enumerate().map(|(k, name)| (unit_at_index(k), name.as_str(), values(k))).collect()
}

/// Returns the declared drawing with the values of the parameters.
fn declared_drawing(start: &MotionStart<'_, '_>, model: &mechanism::Model<'_>) -> Figure {
    let (mut pieces, mut numbers) = (Vec::new(), Vec::new());
    for piece in &model.drawing {
        pieces.push(linkwork_jit::convert_piece(piece, numbers.len()));
        numbers.extend(piece.numbers.iter().map(|e| start.evaluate_expression(*e)));
    }
    let frames = model.frames.iter().map(|frame| frame.name.clone()).collect();
    Figure::from_pieces(frames, &pieces, &numbers)
}
