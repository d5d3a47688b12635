//! Line diagrams of arbitrary curves.

use super::panel::{self, Curve, Panel};
use crate::Error;

/// Chart of curves, such as simulated, measured or computed values over time or over another quantity.
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
    /// Creates a diagram without curves. The labels of the axes contain name and unit.
    pub fn new(title: impl Into<String>, x: impl Into<String>, y: impl Into<String>) -> Self {
        let panel = Panel { title: title.into(), x: x.into(), y: y.into(), ..Panel::default() };
        Self { panel, size: (720, 360) }
    }

    /// Creates a diagram without curves whose horizontal axis is time in seconds.
    pub fn over_time(title: impl Into<String>, y: impl Into<String>) -> Self {
        Self::new(title, "time, s", y)
    }

    /// Makes the vertical axis of the diagram logarithmic. Absolute values are drawn, and zeros are omitted.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.panel.decades = true;
        self
    }

    /// Makes the horizontal axis of the diagram logarithmic. Points whose first coordinate is not positive
    /// are omitted.
    #[must_use]
    pub fn logarithmic_along(mut self) -> Self {
        self.panel.logarithmic = true;
        self
    }

    /// Gives both axes of the diagram the same scale, as needed for a path in a plane.
    #[must_use]
    pub fn equal(mut self) -> Self {
        self.panel.equal = true;
        self
    }

    /// Sets the size of the diagram in pixels, which is 720 by 360 by default and at least 200 by 160.
    #[must_use]
    pub fn sized(mut self, width: u32, height: u32) -> Self {
        self.size = (width.max(200), height.max(160));
        self
    }

    /// Adds a curve through these points to the diagram. The name is shown above the diagram; an empty name
    /// omits it. Points that are not finite interrupt the curve.
    #[must_use]
    pub fn curve(mut self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.panel.curves.push(Curve { name: name.into(), points: points.into_iter().collect() });
        self
    }

    /// Adds a vertical dashed line with a label to the diagram.
    #[must_use]
    pub fn instant(mut self, at: f64, word: impl Into<String>) -> Self {
        self.panel.instants.push((at, word.into()));
        self
    }

    /// Returns the diagram as SVG text.
    ///
    /// # Errors
    ///
    /// [`Error::Picture`] if no point is finite.
    pub fn svg(self) -> Result<String, Error> {
        let Self { mut panel, size } = self;
        let logarithm_or_nan = |x: f64| if x > 0.0 { x.log10() } else { f64::NAN };
        let (along, upward) = (panel.logarithmic, panel.decades);
        for (x, y) in panel.curves.iter_mut().flat_map(|curve| &mut curve.points) {
            *x = if along { logarithm_or_nan(*x) } else { *x };
            *y = if upward { logarithm_or_nan(y.abs()) } else { *y };
        }
        for (x, _) in panel.instants.iter_mut().filter(|_| along) {
            *x = logarithm_or_nan(*x);
        }
        panel::draw(&[panel], size)
    }
}
