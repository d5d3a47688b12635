//! Axes of diagrams: ranges, ticks at round numbers, and labels.

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use std::ops::Range;

/// Range of an axis of a diagram, whose coordinates are numbers or their decimal logarithms.
#[derive(Clone)]
pub struct Axis {
    pub low: f64,
    pub high: f64,
    logarithmic: bool,
}

impl Axis {
    /// Returns the axis that spans all finite values, extended at both ends by the fraction `margin` of its
    /// length; `None` if no value is finite.
    pub fn fit(values: impl Iterator<Item = f64>, margin: f64, logarithmic: bool) -> Option<Self> {
        let (low, high) = values
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return None;
        }
        let width = if high - low > 1e-9 * (low.abs().max(high.abs()) + 1e-300) {
            high - low
        } else {
            // A constant value is centred.
            let width = if logarithmic || low == 0.0 { 1.0 } else { low.abs() };
            return Some(Self { low: low - 0.5 * width, high: high + 0.5 * width, logarithmic });
        };
        Some(Self { low: low - margin * width, high: high + margin * width, logarithmic })
    }

    /// Returns the axis with the length `width` and the same centre.
    pub fn widened_axis(&self, width: f64) -> Self {
        let more = 0.5 * (width - (self.high - self.low));
        Self { low: self.low - more, high: self.high + more, ..*self }
    }

    /// Returns the positions of about `most` ticks at round numbers.
    pub fn ticks(&self, most: usize) -> Vec<f64> {
        let width = self.high - self.low;
        let rough = width / most.max(2) as f64;
        if self.logarithmic && width >= 1.0 {
            let every = rough.ceil().max(1.0);
            return multiples_of_step(self.low, self.high, every);
        }
        if self.logarithmic {
            let decades = multiples_of_step(self.low.floor(), self.high.ceil(), 1.0);
            let within = decades.iter().flat_map(|k| [1.0, 2.0, 5.0].map(|m: f64| k + m.log10()));
            return within.filter(|x| (self.low..=self.high).contains(x)).collect();
        }
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= rough * 0.999);
        multiples_of_step(self.low, self.high, step.unwrap_or(rough))
    }

    /// Returns the label of a tick, with the number of decimals that the distance of the ticks requires.
    pub fn label(&self, x: f64, most: usize) -> String {
        if self.logarithmic {
            let nearest = x.round();
            return match (x - nearest).abs() < 1e-9 && nearest.abs() > 3.0 {
                true => format!("10{}", superscript_number(nearest as i64)),
                false => format_decimal(10f64.powf(x), 10f64.powf(x)),
            };
        }
        let ticks = self.ticks(most);
        let step = ticks.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let largest = ticks.iter().map(|x| x.abs()).fold(0.0, f64::max);
        let x = if x.abs() < 1e-9 * largest { 0.0 } else { x };
        if largest >= 1e5 || (largest < 1e-3 && largest > 0.0) {
            return format_scientific(x, step);
        }
        format_decimal(x, step)
    }
}

fn multiples_of_step(low: f64, high: f64, step: f64) -> Vec<f64> {
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    let count = (last - first).clamp(-1.0, 100.0) as i64;
    (0..=count).map(|k| (first + k as f64) * step).collect()
}

/// Formats a number with the number of decimals that the step requires.
fn format_decimal(x: f64, step: f64) -> String {
    let decimals = (-(step * 1.0001).log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{x:.decimals$}").replace('-', "−")
}

fn format_scientific(x: f64, step: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let power = x.abs().log10().floor();
    let part = format_decimal(x / 10f64.powf(power), step / 10f64.powf(power));
    format!("{part}·10{}", superscript_number(power as i64))
}

fn superscript_number(k: i64) -> String {
    let superscript_digit = |c: char| match c.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    k.to_string().chars().map(superscript_digit).collect()
}

/// Axis with a maximum number of ticks, for plotters.
pub struct TickedAxis {
    pub axis: Axis,
    pub most: usize,
}

impl Ranged for TickedAxis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let part = (value - self.axis.low) / (self.axis.high - self.axis.low);
        (f64::from(from) + part * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.axis.ticks(self.most) }
    }

    fn range(&self) -> Range<f64> {
        self.axis.low..self.axis.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tick_positions_are_round() {
        let tick_labels = |axis: &Axis, most| -> Vec<String> {
            axis.ticks(most).into_iter().map(|x| axis.label(x, most)).collect()
        };
        let axis_between = |low, high, logarithmic| Axis { low, high, logarithmic };
        assert_eq!(
            tick_labels(&axis_between(-0.26, 0.31, false), 6),
            ["−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3"]
        );
        assert_eq!(
            tick_labels(&axis_between(0.0, 61.0, false), 7),
            ["0", "10", "20", "30", "40", "50", "60"]
        );
        assert_eq!(tick_labels(&axis_between(-2.0, 1.0, true), 8), ["0.01", "0.1", "1", "10"]);
        assert_eq!(tick_labels(&axis_between(-0.1, 0.8, true), 8), ["1", "2", "5"]);
        assert_eq!(tick_labels(&axis_between(-16.0, -4.0, true), 3), ["10⁻¹⁶", "10⁻¹²", "10⁻⁸", "10⁻⁴"]);
        assert_eq!(tick_labels(&axis_between(0.0, 4e6, false), 4), ["0", "1·10⁶", "2·10⁶", "3·10⁶", "4·10⁶"]);
        // The range of a constant value is not empty.
        let flat = Axis::fit([3.0, 3.0].into_iter(), 0.06, false).unwrap();
        assert!(flat.low < 3.0 && flat.high > 3.0 && !flat.ticks(6).is_empty());
        assert!(Axis::fit([f64::NAN].into_iter(), 0.0, false).is_none());
    }
}
