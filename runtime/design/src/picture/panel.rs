//! Panels of a diagram with axes, curves and marks, drawn by plotters.

use super::axis::{Axis, TickedAxis};
use crate::Error;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Colours of the curves in diagrams, which colour-blind readers can distinguish.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 90, 160),
    RGBColor(213, 94, 0),
    RGBColor(0, 140, 100),
    RGBColor(170, 60, 130),
    RGBColor(200, 150, 0),
    RGBColor(90, 90, 90),
];
const GREY: RGBColor = RGBColor(140, 140, 140);
const FONT: &str = "sans-serif";
/// Number of drawing units per pixel. Plotters rounds coordinates to whole units.
const UNITS: u32 = 10;
/// Height of the title, and of the row of names, in a diagram, pixels.
const HEADING: u32 = 26;
const NAMES: u32 = 22;
/// Maximum number of points drawn per curve: more would be closer together than a pixel.
const MAX_POINTS: usize = 3000;

fn drawing_units_from_pixels(pixels: u32) -> u32 {
    pixels * UNITS
}

fn text_style(size: u32) -> TextStyle<'static> {
    (FONT, drawing_units_from_pixels(size)).into_font().color(&BLACK)
}

#[derive(Clone, Copy, PartialEq)]
pub enum Mark {
    Cross,
    Circle,
}

/// Curve of a panel. A curve without a name is not listed in the legend above the panel.
pub struct Curve {
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

#[derive(Default)]
pub struct Panel {
    pub title: String,
    pub x: String,
    pub y: String,
    /// Whether horizontal coordinates of the panel are decimal logarithms.
    pub logarithmic: bool,
    /// Whether vertical coordinates of the panel are decimal logarithms.
    pub decades: bool,
    /// Whether both axes of the panel have the same scale.
    pub equal: bool,
    /// Limits of the horizontal and vertical axis, if the panel does not show all points; curves are clipped
    /// there.
    pub window: Option<[(f64, f64); 2]>,
    pub curves: Vec<Curve>,
    /// Polylines that are drawn as thin grey lines.
    pub lines: Vec<Vec<(f64, f64)>>,
    pub marks: Vec<(Mark, f64, f64)>,
    /// Meaning of each kind of mark, for the legend.
    pub mark_names: Vec<(Mark, &'static str)>,
    /// Vertical lines of the panel: horizontal coordinate and label.
    pub instants: Vec<(f64, String)>,
}

impl Panel {
    fn all_points(&self) -> impl Iterator<Item = (f64, f64)> {
        let curves = self.curves.iter().flat_map(|c| c.points.iter().copied());
        let lines = self.lines.iter().flatten().copied();
        curves.chain(lines).chain(self.marks.iter().map(|(_, x, y)| (*x, *y)))
    }

    /// Returns both axes of the panel for a drawing area of this size. With equal scales, the shorter axis is
    /// extended to the aspect ratio of the area.
    fn axes_for_area(&self, (width, height): (u32, u32)) -> Option<(Axis, Axis)> {
        let window_predicate = |k: usize| {
            let window = self.window.map(|window| window[k]);
            move |v: f64| window.is_none_or(|(low, high)| (low..=high).contains(&v))
        };
        let along = if self.equal { 0.06 } else { 0.0 };
        let (in_x, in_y) = (window_predicate(0), window_predicate(1));
        let shown: Vec<_> = self.all_points().filter(|(x, y)| in_x(*x) && in_y(*y)).collect();
        let x = Axis::fit(shown.iter().map(|p| p.0), along, self.logarithmic)?;
        let y = Axis::fit(shown.iter().map(|p| p.1), 0.06, self.decades)?;
        if !self.equal {
            return Some((x, y));
        }
        let shape = f64::from(width) / f64::from(height.max(1));
        let (have_x, have_y) = (x.high - x.low, y.high - y.low);
        Some((x.widened_axis(have_x.max(have_y * shape)), y.widened_axis(have_y.max(have_x / shape))))
    }

    fn draw_panel<DB: DrawingBackend>(&self, area: DrawingArea<DB, Shift>) -> Result<(), Error> {
        let mut area = area;
        if !self.title.is_empty() {
            let (top, rest) = area.split_vertically(drawing_units_from_pixels(HEADING));
            let middle = (
                i32::try_from(top.dim_in_pixel().0).unwrap_or(0) / 2,
                as_i32(drawing_units_from_pixels(HEADING / 2 + 2)),
            );
            let style = text_style(16).pos(Pos::new(HPos::Center, VPos::Center));
            top.draw_text(&self.title, &style, middle).map_err(drawing_error)?;
            area = rest;
        }
        if self.curves.iter().any(|c| !c.name.is_empty()) || !self.mark_names.is_empty() {
            let (top, rest) = area.split_vertically(drawing_units_from_pixels(NAMES));
            self.draw_legend(&top)?;
            area = rest;
        }
        let (width, height) = area.dim_in_pixel();
        let (left, below, border) =
            (drawing_units_from_pixels(74), drawing_units_from_pixels(46), drawing_units_from_pixels(10));
        let inner = (
            width.saturating_sub(left + border + drawing_units_from_pixels(24)),
            height.saturating_sub(below + 2 * border),
        );
        let Some((x, y)) = self.axes_for_area(inner) else {
            return Err(Error::Picture("no finite values to draw".into()));
        };
        let most_x =
            (inner.0 / drawing_units_from_pixels(if self.logarithmic { 60 } else { 80 })).max(2) as usize;
        let most_y = (inner.1 / drawing_units_from_pixels(36)).max(2) as usize;
        let (across, up) = (x.clone(), y.clone());
        let mut chart = ChartBuilder::on(&area)
            .margin(border)
            .margin_right(drawing_units_from_pixels(24))
            .x_label_area_size(below)
            .y_label_area_size(left)
            .build_cartesian_2d(
                TickedAxis { axis: x.clone(), most: most_x },
                TickedAxis { axis: y.clone(), most: most_y },
            )
            .map_err(drawing_error)?;
        chart
            .configure_mesh()
            .x_desc(&self.x)
            .y_desc(&self.y)
            .axis_desc_style(text_style(14))
            .label_style(text_style(13))
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 228, 232).stroke_width(UNITS))
            .axis_style(GREY.stroke_width(UNITS))
            .set_all_tick_mark_size(drawing_units_from_pixels(4))
            .x_labels(100)
            .y_labels(100)
            .x_label_formatter(&|v| across.label(*v, most_x))
            .y_label_formatter(&|v| up.label(*v, most_y))
            .draw()
            .map_err(drawing_error)?;
        for line in &self.lines {
            for run in clip_curve(line, &x, &y) {
                chart.draw_series(LineSeries::new(run, GREY.stroke_width(UNITS))).map_err(drawing_error)?;
            }
        }
        for (at, word) in self.instants.iter().filter(|(at, _)| (x.low..=x.high).contains(at)) {
            let line = [(*at, y.low), (*at, y.high)];
            let dashed = DashedLineSeries::new(
                line,
                drawing_units_from_pixels(4) as i32,
                drawing_units_from_pixels(4) as i32,
                GREY.stroke_width(UNITS),
            );
            chart.draw_series(dashed).map_err(drawing_error)?;
            let place = (at + 0.008 * (x.high - x.low), y.high - 0.03 * (y.high - y.low));
            chart.draw_series([Text::new(word.clone(), place, text_style(13))]).map_err(drawing_error)?;
        }
        for (curve, colour) in self.curves.iter().zip(COLOURS.iter().cycle()) {
            for run in clip_curve(&thin_out_points(&curve.points), &x, &y) {
                let series = LineSeries::new(run, colour.stroke_width(2 * UNITS));
                chart.draw_series(series).map_err(drawing_error)?;
            }
        }
        let style = BLACK.stroke_width(2 * UNITS);
        for (mark, x, y) in &self.marks {
            match mark {
                Mark::Cross => chart.draw_series([Cross::new((*x, *y), drawing_units_from_pixels(5), style)]),
                Mark::Circle => {
                    chart.draw_series([Circle::new((*x, *y), drawing_units_from_pixels(6), style)])
                }
            }
            .map_err(drawing_error)?;
        }
        Ok(())
    }

    /// Draws the legend: the names of curves and marks in a row.
    fn draw_legend<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Result<(), Error> {
        let (mut x, y) =
            (as_i32(drawing_units_from_pixels(84)), as_i32(drawing_units_from_pixels(NAMES / 2 + 2)));
        let style = text_style(14).pos(Pos::new(HPos::Left, VPos::Center));
        let draw_legend_name = |x: &mut i32, word: &str| {
            let place = (*x + as_i32(drawing_units_from_pixels(26)), y);
            *x += as_i32(drawing_units_from_pixels(26 + 20))
                + (word.chars().count() * drawing_units_from_pixels(8) as usize) as i32;
            area.draw_text(word, &style, place).map_err(drawing_error)
        };
        let end_of_legend_line = |x: i32| x + as_i32(drawing_units_from_pixels(20));
        for (curve, colour) in self.curves.iter().zip(COLOURS.iter().cycle()) {
            if !curve.name.is_empty() {
                let line =
                    PathElement::new([(x, y), (end_of_legend_line(x), y)], colour.stroke_width(2 * UNITS));
                area.draw(&line).map_err(drawing_error)?;
                draw_legend_name(&mut x, &curve.name)?;
            }
        }
        let thick = BLACK.stroke_width(2 * UNITS);
        for (mark, name) in &self.mark_names {
            let middle = (x + as_i32(drawing_units_from_pixels(12)), y);
            match mark {
                Mark::Cross => area.draw(&Cross::new(middle, drawing_units_from_pixels(5), thick)),
                Mark::Circle => area.draw(&Circle::new(middle, drawing_units_from_pixels(6), thick)),
            }
            .map_err(drawing_error)?;
            draw_legend_name(&mut x, name)?;
        }
        Ok(())
    }
}

fn as_i32(n: u32) -> i32 {
    i32::try_from(n).unwrap_or(i32::MAX)
}

/// Reduces the number of points of a curve. The lowest and the highest point of each group remain, so that
/// peaks are preserved.
fn thin_out_points(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= MAX_POINTS {
        return points.to_vec();
    }
    let mut out = Vec::with_capacity(MAX_POINTS + 2);
    for bunch in points.chunks(2 * points.len().div_ceil(MAX_POINTS)) {
        let compare_heights = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        if let (Some(low), Some(high)) =
            (bunch.iter().min_by(compare_heights), bunch.iter().max_by(compare_heights))
        {
            let (first, second) = if low.0 < high.0 { (low, high) } else { (high, low) };
            out.extend([*first, *second]);
        }
    }
    out
}

/// Clips a curve to the axes and returns its visible pieces. Points that are not finite interrupt the curve.
fn clip_curve(points: &[(f64, f64)], x: &Axis, y: &Axis) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut open = false;
    for pair in points.windows(2) {
        let Some((from, to)) = clipped_segment(pair[0], pair[1], x, y) else {
            open = false;
            continue;
        };
        match runs.last_mut().filter(|_| open) {
            Some(run) => run.push(to),
            None => runs.push(vec![from, to]),
        }
        open = to == pair[1];
    }
    runs
}

/// Returns the part of a line segment that lies within the axes (Liang and Barsky).
fn clipped_segment(a: (f64, f64), b: (f64, f64), x: &Axis, y: &Axis) -> Option<((f64, f64), (f64, f64))> {
    if ![a.0, a.1, b.0, b.1].iter().all(|v| v.is_finite()) {
        return None;
    }
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (rate, room) in [(-dx, a.0 - x.low), (dx, x.high - a.0), (-dy, a.1 - y.low), (dy, y.high - a.1)] {
        if rate == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if rate < 0.0 {
            first = first.max(room / rate);
        } else {
            last = last.min(room / rate);
        }
    }
    let point_on_segment = |part: f64| (a.0 + part * dx, a.1 + part * dy);
    let from = if first > 0.0 { point_on_segment(first) } else { a };
    (first <= last).then(|| (from, if last < 1.0 { point_on_segment(last) } else { b }))
}

fn drawing_error(error: impl std::fmt::Display) -> Error {
    Error::Picture(error.to_string())
}

/// Draws panels below each other; the size is in pixels.
pub fn draw(panels: &[Panel], (width, height): (u32, u32)) -> Result<String, Error> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(
            &mut svg,
            (drawing_units_from_pixels(width), drawing_units_from_pixels(height)),
        )
        .into_drawing_area();
        root.fill(&WHITE).map_err(drawing_error)?;
        for (panel, area) in panels.iter().zip(root.split_evenly((panels.len().max(1), 1))) {
            panel.draw_panel(area)?;
        }
        root.present().map_err(drawing_error)?;
    }
    let size_attributes = |width: u32, height: u32| format!("width=\"{width}\" height=\"{height}\"");
    Ok(svg.replacen(
        &size_attributes(drawing_units_from_pixels(width), drawing_units_from_pixels(height)),
        &size_attributes(width, height),
        1,
    ))
}
