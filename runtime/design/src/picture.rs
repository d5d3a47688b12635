//! Pictures as SVG: Bode and Nyquist diagrams, root loci, poles and zeros, time histories and modes. Drawn
//! with the plotters crate, and labelled with names and units.
//!
//! ```
//! use linkwork_design::{TransferFunction, picture};
//!
//! let open = TransferFunction::new([2.0], [1.0, 2.0, 3.0, 4.0])?.state_space()?;
//! let response = open.frequency_response(0, 0, &open.natural_frequencies(300)?)?;
//! let svg = picture::bode(&response)?;
//! assert!(svg.starts_with("<svg") && svg.contains("phase, deg"));
//! assert!(picture::root_locus(&open.root_locus(&open.locus_gains()?)?)?.contains("imaginary part"));
//! # Ok::<(), linkwork_design::Error>(())
//! ```

use crate::matrices::C;
use crate::{Error, FrequencyResponse, Response, RootLocus, StateSpace};
use panel::{Curve, Mark, Panel};
use std::f64::consts::TAU;

mod axis;
mod chart;
mod modes;
mod panel;

pub use chart::Chart;
pub use modes::{modes, named_modes};

fn frequency_response_title(response: &FrequencyResponse) -> String {
    format!("from {} to {}", response.input.name, response.output.name)
}

/// Draws a Bode diagram: magnitude in decibels and continuous phase in degrees over the frequency on a
/// logarithmic axis.
///
/// # Errors
///
/// [`Error::Picture`] for an empty response or values that are not finite.
pub fn bode(response: &FrequencyResponse) -> Result<String, Error> {
    let points_on_log_axis = |values: Vec<f64>| -> Vec<(f64, f64)> {
        let points = response.frequencies.iter().copied().zip(values);
        points.filter(|(w, _)| *w > 0.0).map(|(w, y)| (w.log10(), y)).collect()
    };
    let bode_panel = |heading: String, y: &str, values: Vec<f64>| Panel {
        title: heading,
        x: "frequency, rad/s".into(),
        y: y.into(),
        logarithmic: true,
        curves: vec![Curve { name: String::new(), points: points_on_log_axis(values) }],
        ..Panel::default()
    };
    let above = bode_panel(
        format!("Bode diagram, {}", frequency_response_title(response)),
        "magnitude, dB",
        response.decibels(),
    );
    panel::draw(&[above, bode_panel(String::new(), "phase, deg", response.degrees())], (720, 560))
}

/// Draws a Nyquist diagram: the response in the complex plane, its mirror image for negative frequencies, and
/// the point −1. Both axes are limited to ±10 times the median magnitude (at least ±10); curves are clipped
/// there.
///
/// # Errors
///
/// [`Error::Picture`] for an empty response or values that are not finite.
pub fn nyquist(response: &FrequencyResponse) -> Result<String, Error> {
    let mut sizes: Vec<f64> = response.values.iter().map(|x| x.norm()).filter(|x| x.is_finite()).collect();
    if sizes.is_empty() {
        return Err(Error::Picture("no finite values to draw".into()));
    }
    sizes.sort_by(f64::total_cmp);
    let typical = sizes.get(sizes.len() / 2).copied().unwrap_or(1.0).max(1.0);
    let reach = (-10.0 * typical, 10.0 * typical);
    let smooth = spline_through_values(&response.values);
    let nyquist_points = |sign: f64| smooth.iter().map(|x| (x.re, sign * x.im)).collect();
    let panel = Panel {
        title: format!("Nyquist diagram, {}", frequency_response_title(response)),
        x: "real part".into(),
        y: "imaginary part".into(),
        equal: true,
        window: Some([reach, reach]),
        curves: vec![
            Curve { name: "ω > 0".into(), points: nyquist_points(1.0) },
            Curve { name: "ω < 0".into(), points: nyquist_points(-1.0) },
        ],
        marks: vec![(Mark::Cross, -1.0, 0.0)],
        mark_names: vec![(Mark::Cross, "−1")],
        ..Panel::default()
    };
    panel::draw(&[panel], (640, 640))
}

/// Interpolates values by a smooth curve with eight segments per interval. The curve is a centripetal
/// Catmull–Rom spline: its knots are spaced by the square roots of the chords, which avoids sharp bends for
/// unevenly spaced points (Barry and Goldman, *SIGGRAPH*, 1988).
fn spline_through_values(values: &[C]) -> Vec<C> {
    const PARTS: u32 = 8;
    let mut all = Vec::with_capacity(values.len() * PARTS as usize);
    for (k, pair) in values.windows(2).enumerate() {
        let [from, to] = [pair[0], pair[1]];
        let before = k.checked_sub(1).and_then(|k| values.get(k)).copied().unwrap_or(from * 2.0 - to);
        let after = values.get(k + 2).copied().unwrap_or(to * 2.0 - from);
        let points = [before, from, to, after];
        let mut knots = [0.0; 4];
        for i in 1..4 {
            knots[i] = knots[i - 1] + (points[i] - points[i - 1]).norm().sqrt();
        }
        all.push(from);
        if !knots.windows(2).all(|pair| pair[1] > pair[0]) {
            continue;
        }
        for part in 1..PARTS {
            let t = knots[1] + (knots[2] - knots[1]) * f64::from(part) / f64::from(PARTS);
            let mut row = points;
            for level in 1..4 {
                for i in 0..4 - level {
                    // The middle level interpolates between the inner knots.
                    let (low, high) = if level == 2 {
                        (i, i + 2)
                    } else if level == 1 {
                        (i, i + 1)
                    } else {
                        (1, 2)
                    };
                    let share = (t - knots[low]) / (knots[high] - knots[low]);
                    row[i] = row[i] * (1.0 - share) + row[i + 1] * share;
                }
            }
            all.push(row[0]);
        }
    }
    all.extend(values.last());
    all
}

/// Returns the points of the stability boundary in the complex plane: the imaginary axis, or the unit circle
/// for a discrete system.
fn stability_boundary_outline(period: Option<f64>, reach: f64) -> Vec<(f64, f64)> {
    match period {
        Some(_) => (0..=180).map(|k| (TAU * f64::from(k) / 180.0).sin_cos()).collect(),
        None => vec![(0.0, -reach), (0.0, reach)],
    }
}

const MARKS: [(Mark, &str); 2] = [(Mark::Cross, "poles"), (Mark::Circle, "zeros")];

fn marks_of_roots(mark: Mark, roots: &[C]) -> impl Iterator<Item = (Mark, f64, f64)> {
    roots.iter().map(move |x| (mark, x.re, x.im))
}

fn reach_around_roots(roots: &[C]) -> f64 {
    1.3 * roots.iter().map(|x| x.norm()).fold(0.0, f64::max).max(1e-3)
}

fn complex_plane_panel(heading: &str, period: Option<f64>) -> Panel {
    let unit = if period.is_some() { "" } else { ", 1/s" };
    Panel {
        title: heading.into(),
        x: format!("real part{unit}"),
        y: format!("imaginary part{unit}"),
        equal: true,
        ..Panel::default()
    }
}

/// Draws poles (crosses) and zeros (circles) of a system in the complex plane, with the stability boundary.
///
/// # Errors
///
/// [`Error::Picture`], [`Error::NotConverged`].
pub fn poles_and_zeros(system: &StateSpace) -> Result<String, Error> {
    let (poles, zeros) = (system.poles()?, system.zeros()?);
    let all = [poles.clone(), zeros.clone()].concat();
    let panel = Panel {
        lines: vec![stability_boundary_outline(system.period(), reach_around_roots(&all))],
        marks: marks_of_roots(Mark::Cross, &poles).chain(marks_of_roots(Mark::Circle, &zeros)).collect(),
        mark_names: MARKS.into(),
        ..complex_plane_panel("Poles and zeros", system.period())
    };
    panel::draw(&[panel], (640, 640))
}

/// Draws a root locus: branches from poles (crosses) to zeros (circles), with the stability boundary.
///
/// # Errors
///
/// [`Error::Picture`] for an empty locus or values that are not finite.
pub fn root_locus(locus: &RootLocus) -> Result<String, Error> {
    let all = [locus.poles.clone(), locus.zeros.clone()].concat();
    let far = 2.0 * reach_around_roots(&all);
    let curve_of_branch = |branch: &Vec<C>| Curve {
        name: String::new(),
        points: branch.iter().take_while(|x| x.norm() <= far).map(|x| (x.re, x.im)).collect(),
    };
    let panel = Panel {
        curves: locus.branches.iter().map(curve_of_branch).collect(),
        lines: vec![stability_boundary_outline(locus.period, reach_around_roots(&all))],
        marks: marks_of_roots(Mark::Cross, &locus.poles)
            .chain(marks_of_roots(Mark::Circle, &locus.zeros))
            .collect(),
        mark_names: MARKS.into(),
        ..complex_plane_panel("Root locus", locus.period)
    };
    panel::draw(&[panel], (640, 640))
}

/// Unit of a panel, and the output signals that have this unit, with their indices.
type SignalsOfUnit<'a> = (&'a str, Vec<(&'a crate::Signal, usize)>);

/// Draws the outputs of a time response over time, in one panel per unit.
///
/// # Errors
///
/// [`Error::Picture`] for an empty response or values that are not finite.
pub fn history(response: &Response, heading: &str) -> Result<String, Error> {
    let mut panels: Vec<SignalsOfUnit<'_>> = Vec::new();
    for (k, signal) in response.output_signals.iter().enumerate() {
        match panels.iter_mut().find(|(unit, _)| *unit == signal.unit) {
            Some((_, signals)) => signals.push((signal, k)),
            None => panels.push((&signal.unit, vec![(signal, k)])),
        }
    }
    let panel_of_unit = |(place, (unit, signals)): (usize, &SignalsOfUnit<'_>)| {
        // A single curve is named at the axis.
        let (y, alone) = match signals.as_slice() {
            [(signal, _)] => (signal.to_string(), true),
            _ if unit.is_empty() => ("value".to_owned(), false),
            _ => ((*unit).to_owned(), false),
        };
        let curve_of_signal = |(signal, k): &(&crate::Signal, usize)| Curve {
            name: if alone { String::new() } else { signal.name.clone() },
            points: response.times.iter().copied().zip(response.outputs.row(*k).iter().copied()).collect(),
        };
        Panel {
            title: if place == 0 { heading.into() } else { String::new() },
            x: "time, s".into(),
            y,
            curves: signals.iter().map(curve_of_signal).collect(),
            ..Panel::default()
        }
    };
    let panels: Vec<Panel> = panels.iter().enumerate().map(panel_of_unit).collect();
    let height = 60 + 240 * u32::try_from(panels.len()).unwrap_or(1);
    panel::draw(&panels, (720, height))
}
