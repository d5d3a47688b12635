//! Instants of samples, control periods and the end of a run, counted with integers.
//!
//! Steps are not added up. The `k`-th instant is `k` periods after the start, computed in double precision
//! for any scalar type of the mechanism, and steps between two instants count time from their own start. In
//! single precision, a period of a millisecond is therefore accurate after hours, too.

use crate::Real;
use crate::private::{constant, epsilon, to_f64};

/// Maximum denominator of a ratio of two periods that is recognised as rational.
const MOST_PARTS: u32 = 64;

/// Times of samples and control instants of a run, in seconds after its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct RunTimes {
    end: Option<f64>,
    every: Option<f64>,
    period: Option<f64>,
    /// Indices of the sample and of the control instant that coincide with the end of the run; `None` if none
    /// does.
    last: [Option<u64>; 2],
    /// Ratio `period / every` of control period to sample interval, as numerator and denominator, if it is a
    /// ratio of small integers.
    ratio: Option<[u64; 2]>,
}

/// Returns the quotient `a / b` as numerator and denominator, if it equals a ratio of small integers up to
/// rounding; otherwise `None`.
fn ratio_of_small_integers(a: f64, b: f64, rounding: f64) -> Option<[u64; 2]> {
    let fraction_with_small_denominator = |x: f64| {
        (1..=MOST_PARTS).find_map(|parts| {
            let scaled = x * f64::from(parts);
            // Rounded to the nearest integer; for very large values, neighbouring integers cannot be
            // distinguished.
            let whole = (scaled + 0.5) as u64;
            let exact = whole > 0 && (scaled - whole as f64).abs() <= rounding * scaled;
            exact.then_some([whole, u64::from(parts)])
        })
    };
    if a >= b {
        fraction_with_small_denominator(a / b)
    } else {
        fraction_with_small_denominator(b / a).map(|[whole, parts]| [parts, whole])
    }
}

impl RunTimes {
    /// Creates the clock of a run with this duration and these intervals of samples and control instants.
    pub(super) fn new<T: Real>(duration: Option<T>, every: Option<T>, period: Option<T>) -> Self {
        let rounding = 8.0 * to_f64(epsilon::<T>());
        let [end, every, period] = [duration, every, period].map(|time| time.map(to_f64));
        let whole_interval_count = |interval: Option<f64>| {
            let [count, parts] = ratio_of_small_integers(end?, interval?, rounding)?;
            (parts == 1).then_some(count)
        };
        let last = [whole_interval_count(every), whole_interval_count(period)];
        let ratio =
            every.zip(period).and_then(|(every, period)| ratio_of_small_integers(period, every, rounding));
        Self { end, every, period, last, ratio }
    }

    /// Returns the duration of the run, s; `None` if it is unlimited.
    pub(super) fn run_duration(&self) -> Option<f64> {
        self.end
    }

    /// Returns the instant of a sample, at most the end of the run; `None` if every step is a sample.
    pub(super) fn sample_instant(&self, count: u64) -> Option<f64> {
        // Counts are exact up to 2⁵³.
        let due = self.every? * count as f64;
        Some(self.end.filter(|end| due > *end || self.last[0] == Some(count)).unwrap_or(due))
    }

    /// Returns the instant of a control period. If it coincides with a sample or the end of the run, both are
    /// exactly equal.
    pub(super) fn control_instant(&self, count: u64) -> Option<f64> {
        let plain = self.period? * count as f64;
        if self.last[1] == Some(count) {
            return self.end;
        }
        let on_sample = self.ratio.and_then(|[samples, periods]| {
            let parts = count.checked_mul(samples)?;
            if parts.checked_rem(periods)? == 0 {
                self.sample_instant(parts.checked_div(periods)?)
            } else {
                None
            }
        });
        Some(on_sample.unwrap_or(plain))
    }
}

/// Returns the time of the run `elapsed` seconds after its start.
pub(super) fn time_after_start<T: Real>(start: T, elapsed: f64) -> T {
    start + constant::<T>(elapsed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks ten million sample instants at intervals of a millisecond in single precision: none is missing
    /// or repeated.
    #[test]
    fn sample_instants_are_complete() {
        let clock = RunTimes::new::<f32>(Some(10_000.0), Some(1e-3), Some(1e-3));
        let mut last = -1.0;
        let mut count = 0;
        loop {
            let t = clock.sample_instant(count).expect("there are samples");
            assert!(t > last, "{count}: {t}");
            assert_eq!(clock.control_instant(count), Some(t));
            (last, count) = (t, count + 1);
            if clock.run_duration() == Some(t) {
                break;
            }
        }
        assert_eq!(count, 10_000_001);
    }

    #[test]
    fn coinciding_instants_are_equal() {
        let clock = RunTimes::new(Some(0.9), Some(0.1), Some(0.3));
        assert_eq!(
            [clock.control_instant(1), clock.control_instant(2), clock.control_instant(3)],
            [clock.sample_instant(3), clock.sample_instant(6), Some(0.9)]
        );
        let clock = RunTimes::new(Some(10.0), Some(0.05), Some(0.02));
        assert_eq!(
            (clock.control_instant(5), clock.control_instant(1)),
            (clock.sample_instant(2), Some(0.02))
        );
        // Periods without a rational ratio are not adjusted.
        let clock = RunTimes::new(None, Some(1.0), Some(core::f64::consts::SQRT_2));
        assert_eq!(clock.control_instant(3), Some(3.0 * core::f64::consts::SQRT_2));
    }
}
