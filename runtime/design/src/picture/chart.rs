//! Curves of one's own.

use super::panel::{self, Curve, Panel};
use crate::Error;

/// A picture of curves: what was simulated, measured or computed, over time or over anything else.
///
/// ```
/// use linkwork_design::picture::Chart;
///
/// let times = (0..200).map(|k| 0.05 * f64::from(k));
/// let falls = times.clone().map(|t| (t, 2.0 * (-t).exp()));
/// let swings = times.map(|t| (t, (-0.3 * t).exp() * (2.0 * t).cos()));
/// let svg = Chart::over_time("Two ways to rest", "angle, rad")
///     .curve("falls", falls)
///     .curve("swings", swings)
///     .instant(5.0, "caught")
///     .svg()?;
/// assert!(svg.contains("time, s") && svg.contains("angle, rad") && svg.contains("swings"));
/// # Ok::<(), linkwork_design::Error>(())
/// ```
pub struct Chart {
    panel: Panel,
    size: (u32, u32),
}

impl Chart {
    /// No curves yet, with the labels of both axes: a name and a unit each.
    pub fn new(title: impl Into<String>, x: impl Into<String>, y: impl Into<String>) -> Self {
        let panel = Panel { title: title.into(), x: x.into(), y: y.into(), ..Panel::default() };
        Self { panel, size: (720, 360) }
    }

    /// Over time in seconds.
    pub fn over_time(title: impl Into<String>, y: impl Into<String>) -> Self {
        Self::new(title, "time, s", y)
    }

    /// With powers of ten upward: magnitudes are drawn, and zeros are left out.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.panel.decades = true;
        self
    }

    /// With powers of ten along: of first coordinates, which are to be positive.
    #[must_use]
    pub fn logarithmic_along(mut self) -> Self {
        self.panel.logarithmic = true;
        self
    }

    /// One scale along and upward, as a path in a plane wants it.
    #[must_use]
    pub fn equal(mut self) -> Self {
        self.panel.equal = true;
        self
    }

    /// Of another size than 720 by 360 pixels.
    #[must_use]
    pub fn sized(mut self, width: u32, height: u32) -> Self {
        self.size = (width.max(200), height.max(160));
        self
    }

    /// One more curve through these points, with its name above; without a name where the axis says what it
    /// is. Points that are not finite interrupt it.
    #[must_use]
    pub fn curve(mut self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.panel.curves.push(Curve { name: name.into(), points: points.into_iter().collect() });
        self
    }

    /// A line across, with a word.
    #[must_use]
    pub fn instant(mut self, at: f64, word: impl Into<String>) -> Self {
        self.panel.instants.push((at, word.into()));
        self
    }

    /// The picture.
    ///
    /// # Errors
    ///
    /// [`Error::Picture`] where nothing is finite.
    pub fn svg(self) -> Result<String, Error> {
        let Self { mut panel, size } = self;
        let logarithm = |x: f64| if x > 0.0 { x.log10() } else { f64::NAN };
        let (along, upward) = (panel.logarithmic, panel.decades);
        for (x, y) in panel.curves.iter_mut().flat_map(|curve| &mut curve.points) {
            *x = if along { logarithm(*x) } else { *x };
            *y = if upward { logarithm(y.abs()) } else { *y };
        }
        for (x, _) in panel.instants.iter_mut().filter(|_| along) {
            *x = logarithm(*x);
        }
        panel::draw(&[panel], size)
    }
}
