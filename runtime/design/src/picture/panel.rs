//! Panels with axes, curves and marks, by plotters.

use crate::Error;
use crate::polynomial::number;
use plotters::prelude::*;

/// Colours that are told apart by those who see few.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 90, 160),
    RGBColor(213, 94, 0),
    RGBColor(0, 140, 100),
    RGBColor(170, 60, 130),
    RGBColor(200, 150, 0),
    RGBColor(90, 90, 90),
];
const FONT: &str = "sans-serif";

#[derive(Clone, Copy)]
pub enum Mark {
    Cross,
    Circle,
}

/// A curve; without a name it is not in the legend.
pub struct Curve {
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

#[derive(Default)]
pub struct Panel {
    pub title: String,
    pub x: String,
    pub y: String,
    /// The first coordinates are logarithms.
    pub logarithmic: bool,
    /// Both axes have one scale.
    pub equal: bool,
    pub curves: Vec<Curve>,
    /// Thin grey lines.
    pub lines: Vec<Vec<(f64, f64)>>,
    pub marks: Vec<(Mark, f64, f64)>,
}

type Range = (f64, f64);

fn range(values: impl Iterator<Item = f64>, margin: f64) -> Option<Range> {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return None;
    }
    let width = if high - low > 1e-12 * (1.0 + high.abs()) { high - low } else { 1.0 + high.abs() };
    Some((low - margin * width, high + margin * width))
}

impl Panel {
    fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        let curves = self.curves.iter().flat_map(|c| c.points.iter().copied());
        let lines = self.lines.iter().flatten().copied();
        curves.chain(lines).chain(self.marks.iter().map(|(_, x, y)| (*x, *y)))
    }

    /// Ranges of both axes; with one scale the smaller one is widened to `width / height` of the other.
    fn ranges(&self, (width, height): (u32, u32)) -> Option<(Range, Range)> {
        let along = if self.logarithmic || !self.equal { 0.0 } else { 0.06 };
        let (mut x, mut y) =
            (range(self.points().map(|p| p.0), along)?, range(self.points().map(|p| p.1), 0.06)?);
        if self.equal {
            // What labels take away.
            let shape = (f64::from(width) - 90.0) / (f64::from(height) - 95.0);
            let (have_x, have_y) = (x.1 - x.0, y.1 - y.0);
            let (want_x, want_y) = (have_x.max(have_y * shape), have_y.max(have_x / shape));
            x = (x.0 - 0.5 * (want_x - have_x), x.1 + 0.5 * (want_x - have_x));
            y = (y.0 - 0.5 * (want_y - have_y), y.1 + 0.5 * (want_y - have_y));
        }
        Some((x, y))
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, plotters::coord::Shift>) -> Result<(), Error> {
        let Some((x, y)) = self.ranges(area.dim_in_pixel()) else {
            return Err(Error::Picture("nothing to draw that is finite".into()));
        };
        let mut builder = ChartBuilder::on(area);
        builder.margin(10).x_label_area_size(40).y_label_area_size(64);
        if !self.title.is_empty() {
            builder.caption(&self.title, (FONT, 16));
        }
        let mut chart = builder.build_cartesian_2d(x.0..x.1, y.0..y.1).map_err(failed)?;
        let label = |x: &f64| if self.logarithmic { number(10f64.powf(*x)) } else { number(clean(*x)) };
        let decades = (x.1 - x.0).ceil().max(3.0) as usize + 1;
        chart
            .configure_mesh()
            .x_desc(&self.x)
            .y_desc(&self.y)
            .axis_desc_style((FONT, 14))
            .label_style((FONT, 12))
            .light_line_style(TRANSPARENT)
            .x_labels(if self.logarithmic { decades } else { 9 })
            .y_labels(8)
            .x_label_formatter(&label)
            .y_label_formatter(&|y| number(clean(*y)))
            .draw()
            .map_err(failed)?;
        for line in &self.lines {
            let grey = RGBColor(140, 140, 140);
            chart.draw_series(LineSeries::new(line.iter().copied(), &grey)).map_err(failed)?;
        }
        for (curve, colour) in self.curves.iter().zip(COLOURS.iter().cycle()) {
            let points = curve.points.iter().copied().filter(|p| p.0.is_finite() && p.1.is_finite());
            let drawn = chart.draw_series(LineSeries::new(points, colour.stroke_width(2))).map_err(failed)?;
            if !curve.name.is_empty() {
                let sample =
                    move |(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], colour.stroke_width(2));
                drawn.label(&curve.name).legend(sample);
            }
        }
        let style = BLACK.stroke_width(2);
        for (mark, x, y) in &self.marks {
            match mark {
                Mark::Cross => chart.draw_series([Cross::new((*x, *y), 5, style)]),
                Mark::Circle => chart.draw_series([Circle::new((*x, *y), 6, style)]),
            }
            .map_err(failed)?;
        }
        if self.curves.iter().any(|c| !c.name.is_empty()) {
            let mut legend = chart.configure_series_labels();
            legend
                .label_font((FONT, 13))
                .background_style(WHITE.mix(0.85))
                .border_style(RGBColor(200, 200, 200));
            legend.draw().map_err(failed)?;
        }
        Ok(())
    }
}

/// Ticks that are rounding off zero.
fn clean(x: f64) -> f64 {
    if x.abs() < 1e-12 { 0.0 } else { x }
}

fn failed(error: impl std::fmt::Display) -> Error {
    Error::Picture(error.to_string())
}

/// Panels below each other.
pub fn draw(panels: &[Panel], size: (u32, u32)) -> Result<String, Error> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        for (panel, area) in panels.iter().zip(root.split_evenly((panels.len().max(1), 1))) {
            panel.draw(&area)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(text)
}
