//! Pictures of mode shapes as rotating phasors.

use crate::{Error, Mode};
use std::fmt::Write;

const COLOURS: [&str; 6] = ["#005aa0", "#d55e00", "#008c64", "#aa3c82", "#c89600", "#5a5a5a"];
const ROW: f64 = 170.0;
const RADIUS: f64 = 62.0;
/// Duration of one revolution of the animated phasors, s, if the period of the mode is not between 0.5 s and
/// 20 s.
const TURN: f64 = 4.0;

fn escape_markup(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Draws modes, one per row. A row has the components of the mode shape as phasors, relative to the largest
/// component regardless of their units, and lists the states of the largest participation. Viewers that
/// animate SVG rotate the phasors of an oscillation, and shrink or grow the components of a real mode.
///
/// # Errors
///
/// [`Error::Picture`] for an empty list.
pub fn modes(modes: &[Mode]) -> Result<String, Error> {
    let all: Vec<(&str, &Mode)> = modes.iter().map(|mode| ("", mode)).collect();
    named_modes(&all)
}

/// Draws mode shapes as [`modes`] does, with a name before each, as returned by
/// [`FlightModes::named_modes`](crate::flight::FlightModes::named_modes).
///
/// # Errors
///
/// [`Error::Picture`] for an empty list.
pub fn named_modes(modes: &[(&str, &Mode)]) -> Result<String, Error> {
    if modes.is_empty() {
        return Err(Error::Picture("there are no modes".into()));
    }
    let height = ROW * modes.len() as f64 + 10.0;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"720\" height=\"{height}\" viewBox=\"0 0 720 \
         {height}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"720\" height=\"{height}\" \
             fill=\"white\"/>\n"
    );
    for (k, (name, mode)) in modes.iter().enumerate() {
        write_mode_svg(&mut out, name, mode, ROW * (k as f64 + 0.5) + 5.0);
    }
    out.push_str("</svg>\n");
    Ok(out)
}

fn write_mode_svg(out: &mut String, name: &str, mode: &Mode, y: f64) {
    let x = 90.0;
    let _ = writeln!(
        out,
        "<circle cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\" fill=\"none\" stroke=\"#ccc\"/>\n<g \
         transform=\"translate({x} {y})\"><g>"
    );
    let largest = mode.shape.iter().map(|s| s.norm()).fold(0.0, f64::max);
    for (k, part) in mode.shape.iter().enumerate().filter(|_| largest > 0.0) {
        let (px, py) = (RADIUS * part.re / largest, -RADIUS * part.im / largest);
        let colour = COLOURS[k % COLOURS.len()];
        let _ = writeln!(
            out,
            "<line x2=\"{px:.2}\" y2=\"{py:.2}\" stroke=\"{colour}\" stroke-width=\"3\" \
             stroke-linecap=\"round\"/>"
        );
    }
    write_mode_animation(out, mode);
    out.push_str("</g></g>\n");
    let write_text_row = |out: &mut String, row: f64, colour: &str, words: &str| {
        let place = y - 45.0 + 19.0 * row;
        let _ = writeln!(
            out,
            "<text x=\"180\" y=\"{place:.1}\" fill=\"{colour}\">{}</text>",
            escape_markup(words)
        );
    };
    let text = mode.to_string();
    let heading = text.rsplit_once(": ").map_or(text.as_str(), |(heading, _)| heading);
    let before = if name.is_empty() { String::new() } else { format!("{name}: ") };
    write_text_row(out, 0.0, "#000", &format!("{before}{heading}"));
    for (row, (name, part)) in mode.participants().into_iter().take(5).enumerate() {
        let place = mode.state_index_or_zero(name);
        let shape = mode.shape.get(place).copied().unwrap_or_default();
        let unit = mode.unit_of_state(name).map_or(String::new(), |unit| format!(" {unit}"));
        let words = format!(
            "{name}: takes part {:.1} %, phasor {}{unit} at {:.0}°",
            100.0 * part,
            format_three_significant_digits(shape.norm()),
            shape.arg().to_degrees()
        );
        write_text_row(out, row as f64 + 1.2, COLOURS[place % COLOURS.len()], &words);
    }
}

/// Formats a number with three significant digits.
fn format_three_significant_digits(x: f64) -> String {
    let decimals = if x > 0.0 { (2.0 - x.log10().floor()).clamp(0.0, 9.0) as usize } else { 0 };
    format!("{x:.decimals$}")
}

/// Writes the animation of a mode: a revolution per period if it is between 0.5 s and 20 s, or an exponential
/// decay or growth of fixed duration for a real mode.
fn write_mode_animation(out: &mut String, mode: &Mode) {
    match mode.period() {
        Some(period) => {
            let time = if (0.5..20.0).contains(&period) { period } else { TURN };
            let _ = writeln!(
                out,
                "<animateTransform attributeName=\"transform\" type=\"rotate\" from=\"0\" to=\"-360\" \
                 dur=\"{time:.3}s\" \
                 repeatCount=\"indefinite\"/>"
            );
        }
        None => {
            let sizes: Vec<String> =
                (0..=12).map(|k| format!("{:.3}", (-0.25 * f64::from(k)).exp())).collect();
            let ordered: Vec<String> =
                if mode.is_stable() { sizes } else { sizes.into_iter().rev().collect() };
            let _ = writeln!(
                out,
                "<animateTransform attributeName=\"transform\" type=\"scale\" values=\"{}\" dur=\"{TURN}s\" \
                 repeatCount=\"indefinite\"/>",
                ordered.join(";")
            );
        }
    }
}
