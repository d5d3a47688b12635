//! Line plots as SVG: axes with round ticks, units in the labels, a legend; linear or logarithmic upwards.

use std::fmt::Write;

/// A plot.
pub struct Plot {
    /// What it shows.
    pub title: &'static str,
    /// Label of the horizontal axis, with its unit.
    pub x: &'static str,
    /// Label of the vertical axis, with its unit.
    pub y: &'static str,
    /// Powers of ten upwards.
    pub logarithmic: bool,
    /// The curves.
    pub series: Vec<Series>,
    /// Instants worth a line and a word.
    pub marks: Vec<(f64, &'static str)>,
}

/// A curve.
pub struct Series {
    /// What the legend says.
    pub name: String,
    /// Its points, from left to right.
    pub points: Vec<[f64; 2]>,
}

impl Series {
    /// A named curve.
    pub fn new(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self { name: name.into(), points }
    }
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 330.0;
const LEFT: f64 = 66.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 38.0;
const BOTTOM: f64 = 46.0;
/// What is drawn of exact agreement on a logarithmic axis.
const FLOOR: f64 = 1e-17;
/// Points drawn of a curve at the most: more would be closer together than a pixel.
const MOST: usize = 900;

/// Lower and right edge of the plotting area.
const FOOT: f64 = HEIGHT - BOTTOM;
const END: f64 = WIDTH - RIGHT;

/// An axis: its range and its ticks, in the units of the plot (or their logarithms).
struct Axis {
    low: f64,
    high: f64,
    ticks: Vec<(f64, String)>,
}

/// A word: class of the style sheet, place, which end of it is there.
fn write_word(out: &mut String, class: &str, [x, y]: [f64; 2], anchor: &str, word: &str) {
    let _ = write!(out, "<text class='{class}' x='{x:.1}' y='{y:.1}' text-anchor='{anchor}'>{word}</text>");
}

impl Plot {
    /// The plot as an SVG element; colours and fonts come from the page's style sheet.
    pub fn svg(&self) -> String {
        let points = || self.series.iter().flat_map(|s| &s.points);
        let x = linear(points().map(|p| p[0]), false);
        let up = |y: f64| if self.logarithmic { y.abs().max(FLOOR).log10() } else { y };
        let y = match self.logarithmic {
            true => decades(points().map(|p| up(p[1]))),
            false => linear(points().map(|p| p[1]), true),
        };
        let at_x = |v: f64| LEFT + (v - x.low) / (x.high - x.low) * (END - LEFT);
        let at_y = |v: f64| FOOT - (v - y.low) / (y.high - y.low) * (FOOT - TOP);

        let mut out =
            format!("<svg viewBox='0 0 {WIDTH} {HEIGHT}' role='img' aria-label='{}'>\n", self.title);
        for (v, label) in &x.ticks {
            let px = at_x(*v);
            let _ = write!(out, "<path class='grid' d='M{px:.1} {TOP}V{FOOT}'/>");
            write_word(&mut out, "tick", [px, FOOT + 18.0], "middle", label);
        }
        for (v, label) in &y.ticks {
            let py = at_y(*v);
            let _ = write!(out, "<path class='grid' d='M{LEFT} {py:.1}H{END}'/>");
            write_word(&mut out, "tick", [LEFT - 8.0, py + 4.0], "end", label);
        }
        for (v, word) in &self.marks {
            let px = at_x(*v);
            let _ = write!(out, "<path class='mark' d='M{px:.1} {TOP}V{FOOT}'/>");
            write_word(&mut out, "tick", [px + 5.0, TOP + 13.0], "start", word);
        }
        for (k, series) in self.series.iter().enumerate() {
            let place = |[x, y]: [f64; 2]| format!("{:.1} {:.1}", at_x(x), at_y(up(y)));
            let path: Vec<String> = thin(&series.points).into_iter().map(place).collect();
            let _ = writeln!(out, "<path class='curve c{k}' d='M{}'/>", path.join("L"));
        }
        let _ = writeln!(out, "<path class='frame' d='M{LEFT} {TOP}V{FOOT}H{END}'/>");
        write_word(&mut out, "label", [(LEFT + END) / 2.0, HEIGHT - 8.0], "middle", self.x);
        let _ = write!(out, "<g transform='translate(14 {:.1}) rotate(-90)'>", (TOP + FOOT) / 2.0);
        write_word(&mut out, "label", [0.0, 0.0], "middle", self.y);
        out.push_str("</g>\n");
        self.write_legend(&mut out);
        out.push_str("</svg>\n");
        out
    }

    /// Names in a row above the plot.
    fn write_legend(&self, out: &mut String) {
        let mut px = LEFT;
        for (k, series) in self.series.iter().enumerate() {
            let _ = write!(out, "<path class='curve c{k}' d='M{px:.1} 18h20'/>");
            write_word(out, "legend", [px + 26.0, 22.0], "start", &series.name);
            px += 46.0 + 7.1 * series.name.chars().count() as f64;
        }
    }
}

/// Round ticks 1, 2 or 5 times a power of ten apart; with `margin` the range ends on ticks.
fn linear(values: impl Iterator<Item = f64>, margin: bool) -> Axis {
    let (mut low, mut high) = range(values);
    if low > 0.0 && low < 0.1 * high {
        low = 0.0;
    }
    if high - low < 1e-12 * (1.0 + high.abs()) {
        (low, high) = (low - 1.0, high + 1.0);
    }
    let rough = (high - low) / 5.0;
    let power = 10.0_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
    if margin {
        (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
    }
    let digits = (-step.log10().floor()).max(0.0) as usize;
    let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
    let tick = |k: i64| (k as f64 * step, format!("{:.digits$}", k as f64 * step).replace('-', "−"));
    Axis { low, high, ticks: (first..=last).map(tick).collect() }
}

/// Ticks at powers of ten, at most eight.
fn decades(logarithms: impl Iterator<Item = f64>) -> Axis {
    let (low, high) = range(logarithms);
    let (first, last) = (low.floor() as i64, (high.ceil() as i64).max(low.floor() as i64 + 1));
    let every = (last - first).div_euclid(8) + 1;
    let tick = |k: i64| (k as f64, format!("10{}", superscript(k)));
    let ticks = (first..=last).filter(|k| k.rem_euclid(every) == 0).map(tick).collect();
    Axis { low: first as f64, high: last as f64, ticks }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

fn superscript(k: i64) -> String {
    let raise = |c: char| match c {
        '-' => '⁻',
        _ => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][c as usize - '0' as usize],
    };
    k.to_string().chars().map(raise).collect()
}

/// The lowest and the highest of each bunch of points, so that thinning hides no peak.
fn thin(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() <= MOST {
        return points.to_vec();
    }
    let mut out = Vec::with_capacity(MOST + 2);
    for bunch in points.chunks(2 * points.len().div_ceil(MOST)) {
        let by_height = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
        if let (Some(low), Some(high)) = (bunch.iter().min_by(by_height), bunch.iter().max_by(by_height)) {
            let (first, second) = if low[0] < high[0] { (low, high) } else { (high, low) };
            out.extend([*first, *second]);
        }
    }
    out
}
