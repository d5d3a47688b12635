//! HTML pages that show motions of mechanisms.

use crate::error::{python_error_from_message, python_exception_of_error};
use crate::robot::{Robot, loader};
use linkwork::nalgebra::IsometryMatrix3;
use linkwork_jit::{Error, Quantity};
use linkwork_view::{Figure, Motion, Page};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Maximum number of coordinates, or inputs, that are plotted.
const PLOTTED: usize = 12;

/// Writes an HTML page that shows a motion. The arrays have one row for each sample.
#[pyfunction]
#[pyo3(signature = (robot, source, *, is_file, options, name, folder, meshes, times, q, u, path))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn write_page(
    py: Python<'_>,
    robot: &Robot,
    source: &str,
    is_file: bool,
    options: &str,
    name: Option<&str>,
    folder: Option<&str>,
    meshes: Option<PathBuf>,
    times: Vec<f64>,
    q: PyReadonlyArray2<'_, f64>,
    u: PyReadonlyArray2<'_, f64>,
    path: PathBuf,
) -> PyResult<()> {
    let (q, u) = (q.as_slice()?, u.as_slice()?);
    let loader = loader(source, is_file, options, name, folder);
    let robot = &robot.robot;
    let written = py.detach(|| -> Result<Result<(), linkwork_view::Error>, Error> {
        let drawing = loader.drawing()?;
        let numbers = drawing.numbers(robot);
        let mut figure = Figure::from_pieces(robot.frames().to_vec(), drawing.pieces(), &numbers);
        if let Some(folder) = meshes {
            // Meshes that cannot be read are drawn by the mass properties of their bodies.
            figure = figure.clone().meshes(folder).unwrap_or(figure);
        }
        let mut placements = Vec::with_capacity(times.len());
        let mut timed = robot.clone();
        for (k, t) in times.iter().enumerate() {
            timed.set_time(*t);
            let row = &q[k * robot.nq()..(k + 1) * robot.nq()];
            let all = robot.frames().iter().map(|frame| placement(&timed, frame, row));
            placements.push(all.collect::<Result<Vec<_>, Error>>()?);
        }
        let terrain_height = |terrain: usize, at: [f64; 2]| drawing.heights(robot, at).get(terrain).copied();
        let many = times.len() > 1;
        let write_motion = || -> Result<(), linkwork_view::Error> {
            let mut motion = Motion::from_placements("", figure, times, placements)?.terrain(terrain_height);
            for (title, list, values) in
                [("Coordinates", robot.configuration(), q), ("Inputs", robot.inputs(), u)]
            {
                if many && list.len() <= PLOTTED {
                    motion = motion.plots(title, quantity_curves(list, values))?;
                }
            }
            Page::new(robot.name()).text(robot.documentation()).motion(motion).write(&path)
        };
        Ok(write_motion())
    });
    let written = written.map_err(|error| python_exception_of_error(py, &error, None))?;
    written.map_err(|error| python_error_from_message(py, error.to_string()))
}

fn placement(robot: &linkwork_jit::Robot, frame: &str, q: &[f64]) -> Result<IsometryMatrix3<f64>, Error> {
    let found = robot.frame_placement(frame, q)?;
    Ok(IsometryMatrix3::from_parts(found.translation, found.rotation.to_rotation_matrix()))
}

/// Returns the unit, the name and the values of each quantity, as curves of a plot.
fn quantity_curves<'a>(list: &'a [Quantity], values: &[f64]) -> Vec<(&'a str, &'a str, Vec<f64>)> {
    let column_of_values =
        |k: usize| values.iter().skip(k).step_by(list.len()).copied().collect::<Vec<f64>>();
    let all = list
        .iter()
        .enumerate()
        .map(|(k, entry)| (entry.unit.as_str(), entry.name.as_str(), column_of_values(k)));
    all.collect()
}
