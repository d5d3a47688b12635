//! A motion: where the frames of a figure are at each instant, and what is plotted beside it.

use crate::encode::Stream;
use crate::figure::{Figure, plain};
use crate::scene::Scene;
use crate::{Error, text};
use linkwork::nalgebra::{IsometryMatrix3, Matrix3, Rotation3, UnitQuaternion, Vector3};
use linkwork::simulate::Sample;
use linkwork::{Drawn, Rheonomic};

/// Steps of quaternions.
const TURN: f64 = 1.0 / 16384.0;
/// Steps of time, s.
const TICK: f64 = 1e-5;
/// Steps of what is plotted, of its range.
const LEVELS: f64 = 4000.0;
/// Parts of the size of the figure that places are rounded to.
const PARTS: f64 = 10_000.0;
/// More samples per second than this are not shown of a motion that has more than [`SHOWN`] of them.
const RATE: f64 = 60.0;
/// Of a shorter motion, which one looks at slowly, as many samples are shown.
const SHOWN: f64 = 600.0;
/// Coordinates that are plotted of their own accord.
const PLOTTED: usize = 12;

/// A motion of a figure: placements of its frames at instants, plots of anything beside them.
///
/// [`Motion::of`] takes a mechanism with the word `drawing` and samples of `linkwork::simulate`.
#[derive(Clone, Debug)]
pub struct Motion {
    title: String,
    figure: Figure,
    times: Vec<f64>,
    /// Sample by sample, frame by frame.
    placements: Vec<Vec<IsometryMatrix3<f64>>>,
    /// Sample by sample.
    inputs: Vec<Vec<f64>>,
    plots: Vec<Plot>,
    trails: Vec<(usize, [f64; 3], f64)>,
    arrows: Vec<Arrow>,
    captions: Vec<(f64, String)>,
    live: bool,
}

/// A vector over time.
#[derive(Clone, Debug)]
struct Arrow {
    kind: &'static str,
    frame: Option<usize>,
    point: [f64; 3],
    /// Sample by sample, in the ground's axes.
    values: Vec<[f64; 3]>,
}

/// Curves over time.
#[derive(Clone, Debug)]
struct Plot {
    title: String,
    unit: String,
    curves: Vec<(String, Vec<f64>)>,
}

impl Motion {
    /// The motion that samples tell. Up to twelve coordinates are plotted, those of each unit together.
    /// Terrain that contacts touch is drawn as far as the motion goes.
    ///
    /// # Errors
    ///
    /// If there are no samples, times decrease, or a placement is not finite.
    pub fn of<M, const NQ: usize, const NV: usize, const NU: usize>(
        title: &str,
        mechanism: &M,
        samples: &[Sample<<M as Rheonomic<NQ, NV, NU>>::Scalar, NQ, NV, NU>],
    ) -> Result<Motion, Error>
    where
        M: Rheonomic<NQ, NV, NU> + Drawn<NQ, NV, Scalar = <M as Rheonomic<NQ, NV, NU>>::Scalar>,
    {
        let placements = samples.iter().map(|s| {
            let frames = 0..M::FRAMES.len();
            frames.filter_map(|k| Some(as_plain(&mechanism.placement_of(k, s.t, &s.q)?))).collect()
        });
        let times = samples.iter().map(|s| plain(s.t)).collect();
        let mut motion = Motion::from_placements(title, Figure::of(mechanism), times, placements.collect())?;
        motion.inputs = samples.iter().map(|s| s.u.iter().map(|u| plain(*u)).collect()).collect();
        if NQ > 0 && NQ <= PLOTTED {
            let units = units(&M::CONFIGURATION, if M::SPEEDS { &[] } else { &M::VELOCITY_UNITS });
            let values = |k: usize| samples.iter().map(|s| plain(s.q[k])).collect();
            motion =
                motion.plots("Coordinates", (0..NQ).map(|k| (units[k], M::CONFIGURATION[k], values(k))))?;
        }
        Ok(motion.terrain(|number, place| {
            let place = place.map(linkwork::nalgebra::convert);
            let heights = mechanism.drawing_heights(&place);
            heights.as_ref().get(number).map(|height| plain(*height))
        }))
    }

    /// Placements of all frames of a figure at each time, s: of what moves by other means than generated
    /// code.
    ///
    /// # Errors
    ///
    /// As those of [`of`](Self::of), and if the lists do not fit.
    pub fn from_placements(
        title: &str,
        figure: Figure,
        times: Vec<f64>,
        placements: Vec<Vec<IsometryMatrix3<f64>>>,
    ) -> Result<Motion, Error> {
        let motion = || title.to_string();
        check_times(title, times.iter().copied())?;
        check(&format!("the placements of `{title}`"), times.len(), placements.len())?;
        for (sample, list) in placements.iter().enumerate() {
            check(
                &format!("the placements of sample {sample} of `{title}`"),
                figure.frames.len(),
                list.len(),
            )?;
            let numbers = |p: &IsometryMatrix3<f64>| p.to_homogeneous().iter().all(|x| x.is_finite());
            if let Some(k) = list.iter().position(|p| !numbers(p)) {
                return Err(Error::NotFinite { motion: motion(), sample, frame: figure.frames[k].clone() });
            }
        }
        let inputs = vec![Vec::new(); times.len()];
        let (plots, trails, arrows, captions) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let live = false;
        Ok(Motion {
            title: motion(),
            figure,
            times,
            placements,
            inputs,
            plots,
            trails,
            arrows,
            captions,
            live,
        })
    }

    /// Draws this figure, which has the same frames: with further pieces, or with meshes.
    ///
    /// # Errors
    ///
    /// If its number of frames is another one.
    pub fn figure(mut self, figure: Figure) -> Result<Motion, Error> {
        check(&format!("the frames of `{}`", self.title), self.figure.frames.len(), figure.frames.len())?;
        self.figure = figure;
        Ok(self)
    }

    /// What is drawn, to be changed and given back to [`figure`](Self::figure).
    pub fn drawn(&self) -> Figure {
        self.figure.clone()
    }

    /// Draws the terrains of the figure ([`Kind::Terrain`](linkwork::drawing::Kind::Terrain)) as far as the
    /// motion goes, and beyond by the size of the mechanism: `height` gives, by the number of a terrain, its
    /// height at a place along its first two axes, m. One without a finite height everywhere there is left
    /// out.
    pub fn terrain(mut self, height: impl Fn(usize, [f64; 2]) -> Option<f64>) -> Motion {
        let size = Scene::of(&self.figure, &self.placements, &self.shown()).size;
        self.figure.raise(&self.placements, size, height);
        self
    }

    /// Adds a plot over time: curves with a name and a value for each sample. Values that are not finite
    /// leave gaps.
    ///
    /// # Errors
    ///
    /// If a curve has another number of values than there are samples.
    pub fn plot<N: Into<String>>(
        mut self,
        title: &str,
        unit: &str,
        curves: impl IntoIterator<Item = (N, Vec<f64>)>,
    ) -> Result<Motion, Error> {
        let curves: Vec<(String, Vec<f64>)> =
            curves.into_iter().map(|(n, values)| (n.into(), values)).collect();
        for (name, values) in &curves {
            check(&format!("the curve `{name}` of `{title}`"), self.times.len(), values.len())?;
        }
        self.plots.push(Plot { title: title.to_string(), unit: unit.to_string(), curves });
        Ok(self)
    }

    /// Adds a plot for each unit: curves with their unit, a name, and a value for each sample.
    ///
    /// # Errors
    ///
    /// As those of [`plot`](Self::plot).
    pub fn plots<U: Into<String>, N: Into<String>>(
        mut self,
        title: &str,
        curves: impl IntoIterator<Item = (U, N, Vec<f64>)>,
    ) -> Result<Motion, Error> {
        let mut plots: Vec<Plot> = Vec::new();
        for (unit, name, values) in curves {
            let (unit, curve) = (unit.into(), (name.into(), values));
            match plots.iter_mut().find(|plot| plot.unit == unit) {
                Some(plot) => plot.curves.push(curve),
                None => plots.push(Plot { title: title.to_string(), unit, curves: vec![curve] }),
            }
        }
        for Plot { title, unit, curves } in plots {
            self = self.plot(&title, &unit, curves)?;
        }
        Ok(self)
    }

    /// Removes all plots: those of coordinates as well.
    pub fn without_plots(mut self) -> Motion {
        self.plots.clear();
        self
    }

    /// A point of a frame, m in its axes, leaves a trail of so many seconds.
    ///
    /// # Errors
    ///
    /// If there is no such frame.
    pub fn trail(mut self, frame: &str, point: [f64; 3], seconds: f64) -> Result<Motion, Error> {
        let frame = self.figure.frame(frame)?;
        self.trails.push((frame, point, seconds));
        Ok(self)
    }

    /// Draws a force as an arrow that begins at a point of a frame, m in its axes, or of the ground if there
    /// is no name: for each sample its vector in the ground's axes. The longest force of the motion has half
    /// the length of the mechanism.
    ///
    /// What contacts exert is the output `contact_force(…)` of the mechanism:
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
    /// If there is no such frame, or another number of vectors than of samples.
    pub fn force(self, frame: Option<&str>, point: [f64; 3], values: Vec<[f64; 3]>) -> Result<Motion, Error> {
        self.arrow("Force", frame, point, values)
    }

    /// Draws a torque as an arrow that turns, with all else as for a [`force`](Self::force).
    ///
    /// # Errors
    ///
    /// If there is no such frame, or another number of vectors than of samples.
    pub fn torque(
        self,
        frame: Option<&str>,
        point: [f64; 3],
        values: Vec<[f64; 3]>,
    ) -> Result<Motion, Error> {
        self.arrow("Torque", frame, point, values)
    }

    fn arrow(
        mut self,
        kind: &'static str,
        frame: Option<&str>,
        point: [f64; 3],
        values: Vec<[f64; 3]>,
    ) -> Result<Motion, Error> {
        let frame = frame.map(|frame| self.figure.frame(frame)).transpose()?;
        check(&format!("the arrows of a {}", kind.to_lowercase()), self.times.len(), values.len())?;
        self.arrows.push(Arrow { kind, frame, point, values });
        Ok(self)
    }

    /// Words that stand below the title from a time on, s.
    pub fn caption(mut self, time: f64, words: &str) -> Motion {
        self.captions.push((time, words.to_string()));
        self
    }

    /// The samples that are shown: of those that follow each other faster than a screen shows, some are left
    /// out.
    fn shown(&self) -> Vec<usize> {
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

    /// Paths of meshes of the mechanism that were not read.
    pub(crate) fn missing_meshes(&self) -> Vec<&str> {
        self.figure.missing_meshes()
    }

    /// The frames that something moves with, by number.
    pub(crate) fn used(&self) -> Vec<usize> {
        let mut used = self.figure.used();
        used.extend(self.trails.iter().map(|(frame, ..)| *frame));
        used.extend(self.arrows.iter().filter_map(|arrow| arrow.frame));
        used.sort_unstable();
        used.dedup();
        used
    }

    /// How many numbers are plotted, and how many inputs there are.
    pub(crate) fn curves(&self) -> [usize; 2] {
        let inputs = self.inputs.first().map_or(0, Vec::len);
        [self.plots.iter().map(|plot| plot.curves.len()).sum(), inputs]
    }

    /// Its samples come from a control loop while it is shown.
    pub(crate) fn live(mut self) -> Motion {
        self.live = true;
        self
    }

    /// The motion as data of a page.
    pub(crate) fn json(&self) -> String {
        let used = self.used();
        let renumber = |k: usize| used.iter().position(|known| *known == k).unwrap_or(0);
        let shown = self.shown();
        let scene = Scene::of(&self.figure, &self.placements, &shown);
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
            let turns = continuous(&placements);
            for entry in 0..4 {
                stream.channel(turns.iter().map(|q| q[entry]), TURN);
            }
        }
        let plots: Vec<String> = self.plots.iter().map(|plot| plot.json(&shown, &mut stream)).collect();
        let count = self.inputs.iter().map(Vec::len).min().unwrap_or(0);
        let inputs =
            (0..count).map(|k| curve_json("", shown.iter().map(|s| self.inputs[*s][k]), &mut stream));
        let inputs: Vec<String> = inputs.collect();
        let arrows = self.arrows.iter().map(|arrow| arrow.json(&shown, renumber, &mut stream));
        let arrows: Vec<String> = arrows.collect();
        let trails = self.trails.iter().map(|(frame, point, seconds)| {
            text::list([renumber(*frame).to_string(), text::numbers(point), text::number(*seconds)])
        });
        let captions =
            self.captions.iter().map(|(t, words)| text::list([text::number(t - start), text::json(words)]));
        let shapes = self.figure.shown();
        let fields = [
            ("title", text::json(&self.title)),
            ("frames", text::list(used.iter().map(|k| text::json(&self.figure.frames[*k])))),
            ("pieces", text::list(shapes.map(|shape| shape.json(renumber)))),
            ("count", shown.len().to_string()),
            ("start", text::number(start)),
            ("tick", text::number(TICK)),
            ("quantum", text::number(quantum)),
            ("turn", text::number(TURN)),
            ("scene", scene.json()),
            ("plots", text::list(plots)),
            ("inputs", text::list(inputs)),
            ("arrows", text::list(arrows)),
            ("trails", text::list(trails)),
            ("captions", text::list(captions)),
            ("live", self.live.to_string()),
            ("data", text::json(&stream.text())),
        ];
        let fields: Vec<String> =
            fields.into_iter().map(|(name, value)| format!("{}:{value}", text::json(name))).collect();
        format!("{{{}}}", fields.join(","))
    }
}

impl Arrow {
    fn json(&self, shown: &[usize], renumber: impl Fn(usize) -> usize, stream: &mut Stream) -> String {
        let frame = self.frame.map_or("-1".to_string(), |frame| renumber(frame).to_string());
        let curves: Vec<String> =
            (0..3).map(|k| curve_json("", shown.iter().map(|s| self.values[*s][k]), stream)).collect();
        text::list([text::json(self.kind), frame, text::numbers(&self.point), text::list(curves)])
    }
}

impl Plot {
    fn json(&self, shown: &[usize], stream: &mut Stream) -> String {
        let curves = self
            .curves
            .iter()
            .map(|(name, values)| curve_json(name, shown.iter().map(|k| values[*k]), stream));
        let curves = text::list(curves.collect::<Vec<_>>());
        text::list([text::json(&self.title), text::json(&self.unit), curves])
    }
}

/// A curve: its name, where it begins, the size of a step. A gap is the step −1.
fn curve_json(name: &str, values: impl Iterator<Item = f64> + Clone, stream: &mut Stream) -> String {
    let finite = || values.clone().filter(|x| x.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let low = if low.is_finite() { low } else { 0.0 };
    let step = ((high - low) / LEVELS).max(f64::MIN_POSITIVE);
    let step = if high > low && step.is_finite() { step } else { 1.0 };
    stream.channel(values.map(|x| if x.is_finite() { (x - low) / step } else { -1.0 }), 1.0);
    text::list([text::json(name), exact(low), exact(step)])
}

/// All digits of a number.
fn exact(x: f64) -> String {
    format!("{x:e}")
}

/// Units of coordinates, of those of their rates: a quaternion has none and moves with three velocities.
fn units(names: &[&str], of_rates: &[&'static str]) -> Vec<&'static str> {
    let (mut units, mut rates) = (Vec::new(), of_rates.iter());
    for name in names {
        let is_turn = [".qx", ".qy", ".qz", ".qw"].iter().any(|end| name.ends_with(end));
        let rate = if name.ends_with(".qw") { "" } else { rates.next().copied().unwrap_or("") };
        units.push(rate.strip_suffix("/s").filter(|unit| !is_turn && *unit != "1").unwrap_or(""));
    }
    units
}

/// Checks that there are times, which are finite and do not decrease.
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

fn check(what: &str, expected: usize, found: usize) -> Result<(), Error> {
    match found == expected {
        true => Ok(()),
        false => Err(Error::Count { what: what.to_string(), expected, found }),
    }
}

pub(crate) fn as_plain<T: linkwork::Real>(p: &IsometryMatrix3<T>) -> IsometryMatrix3<f64> {
    let matrix = Matrix3::from_fn(|i, j| plain(p.rotation.matrix()[(i, j)]));
    let at = Vector3::from_fn(|i, _| plain(p.translation.vector[i]));
    IsometryMatrix3::from_parts(at.into(), Rotation3::from_matrix_unchecked(matrix))
}

/// Quaternions x y z w, each of the sign that is nearer to the one before.
fn continuous(placements: &[&IsometryMatrix3<f64>]) -> Vec<[f64; 4]> {
    let mut before = [0.0, 0.0, 0.0, 1.0];
    let next = |p: &&IsometryMatrix3<f64>| {
        let q = UnitQuaternion::from_rotation_matrix(&p.rotation).into_inner().coords;
        let q = [q.x, q.y, q.z, q.w];
        let dot: f64 = q.iter().zip(&before).map(|(a, b)| a * b).sum();
        before = if dot < 0.0 { q.map(|x| -x) } else { q };
        before
    };
    placements.iter().map(next).collect()
}
