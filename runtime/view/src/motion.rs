//! Motions that a page shows: placements of the frames of a drawing at each instant, with plots.

use crate::encode::{Stream, base64};
use crate::figure::{DrawnShape, Figure, to_double};
use crate::scene::CameraView;
use crate::{Error, text};
use linkwork::nalgebra::{IsometryMatrix3, Matrix3, Rotation3, UnitQuaternion, Vector3};
use linkwork::simulate::Sample;
use linkwork::{Drawn, Mechanism};

/// Quantisation step of quaternion components in the data of a page.
const TURN: f64 = 1.0 / 16384.0;
/// Quantisation step of time in the data of a page, s.
const TICK: f64 = 1e-5;
/// Number of quantisation steps over the range of a plotted curve.
const LEVELS: f64 = 4000.0;
/// Number of quantisation steps of positions over the size of the mechanism.
const PARTS: f64 = 10_000.0;
/// Maximum number of shown samples per second for a motion with more than [`SHOWN`] samples.
const RATE: f64 = 60.0;
/// Number of samples up to which all are shown; a motion with fewer samples is usually watched in slow
/// motion.
const SHOWN: f64 = 600.0;
/// Maximum number of coordinates that are plotted by default.
const PLOTTED: usize = 12;

/// Motion of a drawing: placements of its frames at instants, with plots of arbitrary quantities.
///
/// [`Motion::of`] takes a mechanism with the option `drawing` and samples of `linkwork::simulate`.
#[derive(Clone, Debug)]
pub struct Motion {
    title: String,
    figure: Figure,
    times: Vec<f64>,
    /// Placements of the frames of the drawing, indexed by sample, then by frame.
    placements: Vec<Vec<IsometryMatrix3<f64>>>,
    /// Inputs of the mechanism, indexed by sample.
    inputs: Vec<Vec<f64>>,
    plots: Vec<PagePlot>,
    trails: Vec<(usize, [f64; 3], f64)>,
    arrows: Vec<PageArrow>,
    captions: Vec<(f64, String)>,
    live: bool,
    /// Data of the mechanism if the page simulates it.
    simulated: Option<SimulatedMechanism>,
}

/// Mechanism that the page simulates in the browser: its data as JSON, and its functions as a WebAssembly
/// module.
#[derive(Clone, Debug)]
struct SimulatedMechanism {
    data: String,
    module: Vec<u8>,
}

/// Vector over time, such as a force, that the page draws as an arrow.
#[derive(Clone, Debug)]
struct PageArrow {
    kind: &'static str,
    frame: Option<usize>,
    point: [f64; 3],
    /// Vectors that the arrow shows, indexed by sample, in the ground's axes.
    values: Vec<[f64; 3]>,
}

/// Plot of a page, with several curves over time.
#[derive(Clone, Debug)]
struct PagePlot {
    title: String,
    unit: String,
    curves: Vec<(String, Vec<f64>)>,
}

impl Motion {
    /// Creates a motion of a mechanism from samples. Up to twelve coordinates are plotted, with one plot per
    /// unit. Terrains with contacts are drawn over the region of the motion.
    ///
    /// # Errors
    ///
    /// [`Error::Empty`] without samples, [`Error::Time`] if times decrease, [`Error::NotFinite`] if a
    /// placement is not finite.
    pub fn of<M, const NQ: usize, const NV: usize, const NU: usize>(
        title: &str,
        mechanism: &M,
        samples: &[Sample<<M as Mechanism<NQ, NV, NU>>::Scalar, NQ, NV, NU>],
    ) -> Result<Motion, Error>
    where
        M: Mechanism<NQ, NV, NU> + Drawn<NQ, NV, Scalar = <M as Mechanism<NQ, NV, NU>>::Scalar>,
    {
        let placements = samples.iter().map(|s| {
            let frames = 0..M::FRAMES.len();
            frames.filter_map(|k| Some(placement_in_double(&mechanism.placement_of(k, s.t, &s.q)?))).collect()
        });
        let times = samples.iter().map(|s| to_double(s.t)).collect();
        let mut motion = Motion::from_placements(title, Figure::of(mechanism), times, placements.collect())?;
        motion.inputs = samples.iter().map(|s| s.u.iter().map(|u| to_double(*u)).collect()).collect();
        if NQ > 0 && NQ <= PLOTTED {
            let units = coordinate_units(&M::CONFIGURATION, if M::SPEEDS { &[] } else { &M::VELOCITY_UNITS });
            let coordinate_values = |k: usize| samples.iter().map(|s| to_double(s.q[k])).collect();
            motion = motion.plots(
                "Coordinates",
                (0..NQ).map(|k| (units[k], M::CONFIGURATION[k], coordinate_values(k))),
            )?;
        }
        Ok(motion.terrain(|number, place| {
            let place = place.map(linkwork::nalgebra::convert);
            let heights = mechanism.drawing_heights(&place);
            heights.as_ref().get(number).map(|height| to_double(*height))
        }))
    }

    /// Creates a motion from placements of all frames of a drawing at each time, s, for motions that are not
    /// computed by generated code.
    ///
    /// # Errors
    ///
    /// As for [`of`](Self::of), and [`Error::Count`] if the lengths of the lists differ.
    pub fn from_placements(
        title: &str,
        figure: Figure,
        times: Vec<f64>,
        placements: Vec<Vec<IsometryMatrix3<f64>>>,
    ) -> Result<Motion, Error> {
        let motion_title = || title.to_string();
        check_times(title, times.iter().copied())?;
        check_count_matches(&format!("the placements of `{title}`"), times.len(), placements.len())?;
        for (sample, list) in placements.iter().enumerate() {
            check_count_matches(
                &format!("the placements of sample {sample} of `{title}`"),
                figure.frames.len(),
                list.len(),
            )?;
            let has_finite_numbers =
                |p: &IsometryMatrix3<f64>| p.to_homogeneous().iter().all(|x| x.is_finite());
            if let Some(k) = list.iter().position(|p| !has_finite_numbers(p)) {
                return Err(Error::NotFinite {
                    motion: motion_title(),
                    sample,
                    frame: figure.frames[k].clone(),
                });
            }
        }
        let inputs = vec![Vec::new(); times.len()];
        let (plots, trails, arrows, captions) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (live, simulated) = (false, None);
        Ok(Motion {
            title: motion_title(),
            figure,
            times,
            placements,
            inputs,
            plots,
            trails,
            arrows,
            captions,
            live,
            simulated,
        })
    }

    /// Replaces the drawing of the motion by one with the same frames, which has further pieces or meshes.
    ///
    /// # Errors
    ///
    /// [`Error::Count`] if the number of frames differs.
    pub fn figure(mut self, figure: Figure) -> Result<Motion, Error> {
        check_count_matches(
            &format!("the frames of `{}`", self.title),
            self.figure.frames.len(),
            figure.frames.len(),
        )?;
        self.figure = figure;
        Ok(self)
    }

    /// Returns a copy of the drawing of the motion, to be modified and passed to [`figure`](Self::figure).
    pub fn drawn(&self) -> Figure {
        self.figure.clone()
    }

    /// Draws the terrains of the drawing ([`Kind::Terrain`](linkwork::drawing::Kind::Terrain)) over the
    /// region of the motion, extended by the size of the mechanism. `height` returns the height, m, of the
    /// terrain with this index at a position along its first two axes. Terrains whose height is not finite
    /// everywhere in the region are omitted.
    pub fn terrain(mut self, height: impl Fn(usize, [f64; 2]) -> Option<f64>) -> Motion {
        let size = CameraView::new(&self.figure, &self.placements, &self.shown_sample_indices()).size;
        self.figure.draw_terrains_as_surfaces(&self.placements, size, height);
        self
    }

    /// Adds a plot over time to the motion, with a name and one value per sample for each curve. Values that
    /// are not finite are gaps.
    ///
    /// # Errors
    ///
    /// [`Error::Count`] if the number of values of a curve differs from the number of samples.
    pub fn plot<N: Into<String>>(
        mut self,
        title: &str,
        unit: &str,
        curves: impl IntoIterator<Item = (N, Vec<f64>)>,
    ) -> Result<Motion, Error> {
        let curves: Vec<(String, Vec<f64>)> =
            curves.into_iter().map(|(n, values)| (n.into(), values)).collect();
        for (name, values) in &curves {
            check_count_matches(&format!("the curve `{name}` of `{title}`"), self.times.len(), values.len())?;
        }
        self.plots.push(PagePlot { title: title.to_string(), unit: unit.to_string(), curves });
        Ok(self)
    }

    /// Adds one plot per unit to the motion, for curves with a unit, a name, and one value per sample.
    ///
    /// # Errors
    ///
    /// As for [`plot`](Self::plot).
    pub fn plots<U: Into<String>, N: Into<String>>(
        mut self,
        title: &str,
        curves: impl IntoIterator<Item = (U, N, Vec<f64>)>,
    ) -> Result<Motion, Error> {
        let mut plots: Vec<PagePlot> = Vec::new();
        for (unit, name, values) in curves {
            let (unit, curve) = (unit.into(), (name.into(), values));
            match plots.iter_mut().find(|plot| plot.unit == unit) {
                Some(plot) => plot.curves.push(curve),
                None => plots.push(PagePlot { title: title.to_string(), unit, curves: vec![curve] }),
            }
        }
        for PagePlot { title, unit, curves } in plots {
            self = self.plot(&title, &unit, curves)?;
        }
        Ok(self)
    }

    /// Removes all plots from the motion, including those of the coordinates.
    pub fn without_plots(mut self) -> Motion {
        self.plots.clear();
        self
    }

    /// Adds a trail behind a point of a frame, m in its axes, that shows its path during the last `seconds`.
    ///
    /// # Errors
    ///
    /// [`Error::Frame`] for an unknown frame.
    pub fn trail(mut self, frame: &str, point: [f64; 3], seconds: f64) -> Result<Motion, Error> {
        let frame = self.figure.frame_index(frame)?;
        self.trails.push((frame, point, seconds));
        Ok(self)
    }

    /// Draws a force as an arrow that begins at a point of a frame, m in its axes, or of the ground if
    /// `frame` is `None`. `values` has one vector per sample, in the ground's axes. The largest force of the
    /// motion has half the length of the mechanism.
    ///
    /// Forces of contacts are available as the output `contact_force(…)` of the mechanism:
    ///
    /// ```
    /// use linkwork::prelude::*;
    /// use linkwork_view::Motion;
    ///
    /// #[mechanism(gravity = -9.81 * z, drawing)]
    /// struct Box {
    ///     #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    ///     block: Body,
    ///     #[joint(ground -> block, along = z)]
    ///     height: Sleeve,
    ///     #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z))]
    ///     floor: Contact,
    ///     #[output(contact_force(floor))]
    ///     load: Vector,
    /// }
    ///
    /// let fall = simulate(&Box {}).from([0.5], [0.0]).method(TimeStepping::step(0.01)).duration(1.0);
    /// let fall: Vec<_> = fall.collect::<Result<_, _>>()?;
    /// let loads = fall.iter().map(|s| Ok(Box {}.load(&s.q, &s.v)?.into())).collect::<Result<Vec<[f64; 3]>, ConstraintError>>()?;
    /// let motion = Motion::of("fall", &Box {}, &fall)?.force(Some("block"), [0.0, 0.0, -0.05], loads)?;
    /// # Ok::<(), std::boxed::Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Frame`] for an unknown frame, [`Error::Count`] if the number of vectors differs from the
    /// number of samples.
    pub fn force(self, frame: Option<&str>, point: [f64; 3], values: Vec<[f64; 3]>) -> Result<Motion, Error> {
        self.add_arrow("Force", frame, point, values)
    }

    /// Draws a torque as a circular arrow, with arguments as for a [`force`](Self::force).
    ///
    /// # Errors
    ///
    /// [`Error::Frame`] for an unknown frame, [`Error::Count`] if the number of vectors differs from the
    /// number of samples.
    pub fn torque(
        self,
        frame: Option<&str>,
        point: [f64; 3],
        values: Vec<[f64; 3]>,
    ) -> Result<Motion, Error> {
        self.add_arrow("Torque", frame, point, values)
    }

    fn add_arrow(
        mut self,
        kind: &'static str,
        frame: Option<&str>,
        point: [f64; 3],
        values: Vec<[f64; 3]>,
    ) -> Result<Motion, Error> {
        let frame = frame.map(|frame| self.figure.frame_index(frame)).transpose()?;
        check_count_matches(
            &format!("the arrows of a {}", kind.to_lowercase()),
            self.times.len(),
            values.len(),
        )?;
        self.arrows.push(PageArrow { kind, frame, point, values });
        Ok(self)
    }

    /// Adds a caption to the motion, which is shown below the title from the time `time` on, s.
    pub fn caption(mut self, time: f64, words: &str) -> Motion {
        self.captions.push((time, words.to_string()));
        self
    }

    /// Returns the indices of the samples that the page shows. Samples that follow each other faster than the
    /// screen refreshes are omitted.
    fn shown_sample_indices(&self) -> Vec<usize> {
        let last = self.times.len() - 1;
        let apart = (1.0 / RATE).min((self.times[last] - self.times[0]) / SHOWN);
        let mut shown = vec![0];
        for k in 1..last {
            let before = self.times[shown[shown.len() - 1]];
            if self.times[k] - before >= (1.0 - 1e-6) * apart {
                shown.push(k);
            }
        }
        shown.extend((last > 0).then_some(last));
        shown
    }

    /// Returns the paths of meshes of the mechanism that were not read.
    pub(crate) fn missing_meshes(&self) -> Vec<&str> {
        self.figure.missing_meshes()
    }

    /// Returns the indices of the frames in which pieces, trails or arrows of the motion are fixed.
    pub(crate) fn used_frames(&self) -> Vec<usize> {
        let mut used = self.figure.used_frames();
        used.extend(self.trails.iter().map(|(frame, ..)| *frame));
        used.extend(self.arrows.iter().filter_map(|arrow| arrow.frame));
        used.sort_unstable();
        used.dedup();
        used
    }

    /// Returns the number of plotted curves, and the number of inputs.
    pub(crate) fn curve_and_input_counts(&self) -> [usize; 2] {
        let inputs = self.inputs.first().map_or(0, Vec::len);
        [self.plots.iter().map(|plot| plot.curves.len()).sum(), inputs]
    }

    /// Marks the motion as live: its samples arrive from a control loop while it is shown.
    pub(crate) fn mark_as_live(mut self) -> Motion {
        self.live = true;
        self
    }

    /// Marks the motion as simulated in the page, from the first sample on. The plots then show the results
    /// of the page. `data` is a JSON object with the structure of the mechanism, and `module` the WebAssembly
    /// module of its functions, both as the command `linkwork view --live` writes them.
    #[doc(hidden)]
    pub fn simulated(mut self, data: String, module: Vec<u8>) -> Motion {
        self.simulated = Some(SimulatedMechanism { data, module });
        self.mark_as_live()
    }

    /// Returns whether the page simulates the mechanism in the browser.
    pub(crate) fn is_simulated_in_browser(&self) -> bool {
        self.simulated.is_some()
    }

    /// Returns a still picture of the motion's first sample as SVG.
    pub(crate) fn still_picture(&self) -> String {
        let scene = CameraView::new(&self.figure, &self.placements, &[0]);
        crate::picture::figure_svg(&self.figure, &self.placements[0], &scene)
    }

    /// Serialises the motion as the JSON data of a page.
    pub(crate) fn motion_json(&self) -> String {
        let used = self.used_frames();
        let index_of_used_frame = |k: usize| used.iter().position(|known| *known == k).unwrap_or(0);
        let shown = self.shown_sample_indices();
        let scene = CameraView::new(&self.figure, &self.placements, &shown);
        let quantum = scene.size / PARTS;
        let mut stream = Stream::default();
        let start = self.times[0];
        stream.channel(shown.iter().map(|k| self.times[*k] - start), TICK);
        for frame in &used {
            let placements: Vec<&IsometryMatrix3<f64>> =
                shown.iter().map(|k| &self.placements[*k][*frame]).collect();
            for axis in 0..3 {
                stream.channel(placements.iter().map(|p| p.translation.vector[axis]), quantum);
            }
            let turns = sign_continuous_quaternions(&placements);
            for entry in 0..4 {
                stream.channel(turns.iter().map(|q| q[entry]), TURN);
            }
        }
        let plots: Vec<String> = self.plots.iter().map(|plot| plot.plot_json(&shown, &mut stream)).collect();
        let count = self.inputs.iter().map(Vec::len).min().unwrap_or(0);
        let inputs = (0..count).map(|k| {
            append_curve_and_describe_as_json("", shown.iter().map(|s| self.inputs[*s][k]), &mut stream)
        });
        let inputs: Vec<String> = inputs.collect();
        let arrows =
            self.arrows.iter().map(|arrow| arrow.arrow_json(&shown, index_of_used_frame, &mut stream));
        let arrows: Vec<String> = arrows.collect();
        let trails = self.trails.iter().map(|(frame, point, seconds)| {
            text::list([
                index_of_used_frame(*frame).to_string(),
                text::numbers(point),
                text::number(*seconds),
            ])
        });
        let captions =
            self.captions.iter().map(|(t, words)| text::list([text::number(t - start), text::json(words)]));
        let shapes = self.figure.drawn_shapes();
        let fields = [
            ("title", text::json(&self.title)),
            ("frames", text::list(used.iter().map(|k| text::json(&self.figure.frames[*k])))),
            ("pieces", text::list(shapes.map(|shape| shape.shape_json(index_of_used_frame)))),
            ("count", shown.len().to_string()),
            ("start", text::number(start)),
            ("tick", text::number(TICK)),
            ("quantum", text::number(quantum)),
            ("turn", text::number(TURN)),
            ("scene", scene.scene_json()),
            ("plots", text::list(plots)),
            ("inputs", text::list(inputs)),
            ("arrows", text::list(arrows)),
            ("trails", text::list(trails)),
            ("captions", text::list(captions)),
            ("live", self.live.to_string()),
            ("data", text::json(&stream.text())),
        ];
        let range_in_declared_numbers_json = |shape: &DrawnShape| match shape.range_in_declared_numbers() {
            Some([first, count]) => format!("[{first},{count}]"),
            None => "null".to_string(),
        };
        let simulated = self.simulated.iter().flat_map(|SimulatedMechanism { data, module }| {
            [
                ("simulated", data.clone()),
                ("module", text::json(&base64(module))),
                ("used", text::list(used.iter().map(ToString::to_string))),
                ("sources", text::list(self.figure.drawn_shapes().map(range_in_declared_numbers_json))),
            ]
        });
        let fields: Vec<String> = fields
            .into_iter()
            .chain(simulated)
            .map(|(name, value)| format!("{}:{value}", text::json(name)))
            .collect();
        format!("{{{}}}", fields.join(","))
    }
}

impl PageArrow {
    fn arrow_json(&self, shown: &[usize], renumber: impl Fn(usize) -> usize, stream: &mut Stream) -> String {
        let frame = self.frame.map_or("-1".to_string(), |frame| renumber(frame).to_string());
        let curves: Vec<String> = (0..3)
            .map(|k| append_curve_and_describe_as_json("", shown.iter().map(|s| self.values[*s][k]), stream))
            .collect();
        text::list([text::json(self.kind), frame, text::numbers(&self.point), text::list(curves)])
    }
}

impl PagePlot {
    fn plot_json(&self, shown: &[usize], stream: &mut Stream) -> String {
        let curves = self.curves.iter().map(|(name, values)| {
            append_curve_and_describe_as_json(name, shown.iter().map(|k| values[*k]), stream)
        });
        let curves = text::list(curves.collect::<Vec<_>>());
        text::list([text::json(&self.title), text::json(&self.unit), curves])
    }
}

/// Appends a curve to the stream of encoded samples, and returns its name, lowest value and quantisation step
/// as JSON. A curve without finite values has the step −1.
fn append_curve_and_describe_as_json(
    name: &str,
    values: impl Iterator<Item = f64> + Clone,
    stream: &mut Stream,
) -> String {
    let finite_values = || values.clone().filter(|x| x.is_finite());
    let (low, high) =
        (finite_values().fold(f64::INFINITY, f64::min), finite_values().fold(f64::NEG_INFINITY, f64::max));
    let low = if low.is_finite() { low } else { 0.0 };
    let step = ((high - low) / LEVELS).max(f64::MIN_POSITIVE);
    let step = if high > low && step.is_finite() { step } else { 1.0 };
    stream.channel(values.map(|x| if x.is_finite() { (x - low) / step } else { -1.0 }), 1.0);
    text::list([text::json(name), format_full_precision(low), format_full_precision(step)])
}

/// Formats a number with full precision in scientific notation.
fn format_full_precision(x: f64) -> String {
    format!("{x:e}")
}

/// Returns the units of the configuration entries, derived from the units of the velocities. The four entries
/// of a quaternion are dimensionless and correspond to three velocities.
fn coordinate_units(names: &[&str], of_rates: &[&'static str]) -> Vec<&'static str> {
    let (mut units, mut rates) = (Vec::new(), of_rates.iter());
    for name in names {
        let is_turn = [".qx", ".qy", ".qz", ".qw"].iter().any(|end| name.ends_with(end));
        let rate = if name.ends_with(".qw") { "" } else { rates.next().copied().unwrap_or("") };
        units.push(rate.strip_suffix("/s").filter(|unit| !is_turn && *unit != "1").unwrap_or(""));
    }
    units
}

/// Checks that the list of times is not empty and that times are finite and do not decrease.
pub(crate) fn check_times(motion: &str, times: impl Iterator<Item = f64>) -> Result<(), Error> {
    let mut last = None;
    for (sample, t) in times.enumerate() {
        if !t.is_finite() || last.is_some_and(|last| t < last) {
            return Err(Error::Time { motion: motion.to_string(), sample });
        }
        last = Some(t);
    }
    last.map(|_| ()).ok_or(Error::Empty { motion: motion.to_string() })
}

fn check_count_matches(what: &str, expected: usize, found: usize) -> Result<(), Error> {
    match found == expected {
        true => Ok(()),
        false => Err(Error::Count { what: what.to_string(), expected, found }),
    }
}

pub(crate) fn placement_in_double<T: linkwork::Real>(p: &IsometryMatrix3<T>) -> IsometryMatrix3<f64> {
    let matrix = Matrix3::from_fn(|i, j| to_double(p.rotation.matrix()[(i, j)]));
    let at = Vector3::from_fn(|i, _| to_double(p.translation.vector[i]));
    IsometryMatrix3::from_parts(at.into(), Rotation3::from_matrix_unchecked(matrix))
}

/// Returns the orientations as quaternions x y z w. The sign of each quaternion is chosen so that it is
/// nearer to the previous one.
fn sign_continuous_quaternions(placements: &[&IsometryMatrix3<f64>]) -> Vec<[f64; 4]> {
    let mut before = [0.0, 0.0, 0.0, 1.0];
    let sign_continuous_quaternion = |p: &&IsometryMatrix3<f64>| {
        let q = UnitQuaternion::from_rotation_matrix(&p.rotation).into_inner().coords;
        let q = [q.x, q.y, q.z, q.w];
        let dot: f64 = q.iter().zip(&before).map(|(a, b)| a * b).sum();
        before = if dot < 0.0 { q.map(|x| -x) } else { q };
        before
    };
    placements.iter().map(sign_continuous_quaternion).collect()
}
