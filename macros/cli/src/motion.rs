//! Initial state of a motion, and its simulation.

use crate::Stop;
use crate::evaluate::{Evaluated, Values};
use crate::grid::{self, Grid, Looked};
use crate::integrate::{Integrator, System};
use crate::table::Table;
use clap::ArgMatches;
use linkwork_compiler::Source;
use linkwork_compiler::derive::Output;
use linkwork_compiler::diag::nearest;
use linkwork_compiler::mechanism::Model;
use std::path::PathBuf;

/// State at one instant of a motion.
pub struct Sample {
    /// Time, s.
    pub t: f64,
    /// Configuration.
    pub q: Vec<f64>,
    /// Velocity.
    pub v: Vec<f64>,
    /// States of first order.
    pub x: Vec<f64>,
    /// Inputs.
    pub u: Vec<f64>,
}

/// Mechanism with its parameters, initial state and initial inputs.
pub struct Start<'a, 'g> {
    /// Mechanism with its parameters.
    pub mechanism: Evaluated<'a, 'g>,
    /// Configuration.
    pub q: Vec<f64>,
    v: Vec<f64>,
    /// States of first order.
    pub x: Vec<f64>,
    u: Vec<f64>,
    /// Whether each entry of the configuration and of the velocity was specified.
    given: [Vec<bool>; 2],
    /// Whether a guess was specified for some entries of the configuration.
    is_guessed: bool,
}

/// Ratio of singular values below which declared speeds are singular at the beginning.
const SINGULAR: f64 = 1e-10;
/// Ratio of singular values below which declared speeds are reported as the reason why an integration stops.
const NEARLY_SINGULAR: f64 = 1e-3;
/// Minimum relative change of an initial value that is reported, m and rad.
const TOLD: f64 = 1e-6;
/// Change of a specified value above which it is not explained by rounding, m and rad, or per second. The
/// simulation is then rejected.
const FAR: f64 = 0.05;
/// Maximum number of samples of a motion.
const MAX_SAMPLES: f64 = 1e7;

impl<'a, 'g> Start<'a, 'g> {
    /// Reads the parameters, the initial state and the inputs from `--set`, `--guess` and `--table`.
    pub fn new(
        source: &Source,
        model: &'a Model<'g>,
        output: &'a Output,
        matches: &ArgMatches,
    ) -> Result<Start<'a, 'g>, Stop> {
        let names = |list: &[(String, linkwork_compiler::diag::Place)]| -> Vec<String> {
            list.iter().map(|(name, _)| format!("v.{name}")).collect()
        };
        let velocities = names(&model.velocities);
        let configuration: Vec<String> = model.configuration.iter().map(|name| format!("q.{name}")).collect();
        let inputs: Vec<String> = model.inputs.iter().map(|(name, _)| format!("u.{name}")).collect();
        let mut parameters = vec![None; model.parameters.len()];
        let states: Vec<(String, usize)> =
            source.mechanism.description.states.iter().map(|(name, k)| (name.text.clone(), *k)).collect();
        // States of first order are zero by default, as coordinates are.
        states.iter().for_each(|(_, k)| parameters[*k] = Some(0.0));
        let of_states: Vec<String> = states.iter().map(|(name, _)| format!("x.{name}")).collect();
        let empty = Evaluated::new(model, output, Vec::new(), Vec::new(), states.clone());
        let (mut q, mut v, mut u) = (empty.neutral(), vec![0.0; model.nv()], vec![0.0; model.nu()]);
        let mut known = [vec![false; q.len()], vec![false; v.len()]];
        for (name, value) in values("set", matches)? {
            let place = |list: &[String]| list.iter().position(|known| known == name);
            if let Some(k) = place(&model.parameters) {
                parameters[k] = Some(value);
            } else if let Some(k) = place(&of_states) {
                parameters[states[k].1] = Some(value);
            } else if let Some(k) = place(&configuration) {
                (q[k], known[0][k]) = (value, true);
            } else if let Some(k) = place(&velocities) {
                (v[k], known[1][k]) = (value, true);
            } else if let Some(k) = place(&inputs) {
                u[k] = value;
            } else {
                let is_state = |name: &&String| states.iter().any(|(state, _)| state == *name);
                let own: Vec<String> =
                    model.parameters.iter().filter(|name| !is_state(name)).cloned().collect();
                let known = [own, configuration, velocities, of_states, inputs].concat();
                let meant = nearest(name, &known.iter().map(String::as_str).collect::<Vec<_>>());
                let meant = meant.map_or(String::new(), |meant| format!("; did you mean `{meant}`?"));
                let known = known.join(", ");
                return Err(Stop::Failure(format!("`--set`: there is no `{name}`, but {known}{meant}")));
            }
        }
        let is_guessed = matches.contains_id("guess");
        for (name, value) in values("guess", matches)? {
            let Some(k) = configuration.iter().position(|known| known == name) else {
                let known = configuration.join(", ");
                return Err(Stop::Failure(format!("`--guess`: there is no `{name}`, but {known}")));
            };
            if known[0][k] {
                return Err(Stop::Failure(format!("`{name}` is given by `--set` and by `--guess`")));
            }
            q[k] = value;
        }
        let missing: Vec<String> = (model.parameters.iter().zip(&parameters))
            .filter(|(_, value)| value.is_none())
            .map(|(name, _)| format!("--set {name}=…"))
            .collect();
        if !missing.is_empty() {
            return Err(Stop::Failure(format!("parameters without a value: {}", missing.join(" "))));
        }
        let tables: Result<Vec<Looked>, _> =
            grid::given(matches, &source.tables())?.iter().map(Grid::looked).collect();
        let parameters: Vec<f64> = parameters.into_iter().flatten().collect();
        let x = states.iter().map(|(_, k)| parameters[*k]).collect();
        let mechanism = Evaluated::new(model, output, parameters, tables?, states);
        mechanism.validate()?;
        mechanism.normalise(&mut q)?;
        Ok(Start { mechanism, q, v, x, u, given: known, is_guessed })
    }

    /// Simulates the motion and returns its samples.
    pub fn run(&self, matches: &ArgMatches) -> Result<Vec<Sample>, Stop> {
        if let Some(why) = self.mechanism.obstacle(matches.get_flag("without-contacts")) {
            return Err(Stop::Failure(format!(
                "`{}` cannot be simulated here: {why}",
                self.mechanism.model.name
            )));
        }
        let positive = |name: &str, usual: f64| match matches.get_one::<f64>(name) {
            Some(x) if !(*x > 0.0 && x.is_finite()) => {
                Err(Stop::Failure(format!("`--{name}`: expected a number above zero, found {x}")))
            }
            given => Ok(given.copied().unwrap_or(usual)),
        };
        let (duration, every) = (positive("duration", 10.0)?, positive("every", 1.0 / 60.0)?);
        let tolerance = positive("tolerance", 1e-8)?.max(1e-13);
        if duration / every > MAX_SAMPLES {
            return Err(Stop::Failure(format!("more than {MAX_SAMPLES} samples: choose a larger `--every`")));
        }
        let inputs = self.inputs(matches)?;
        // Inputs at a time. At a jump, the limit before or after it.
        let given = |t: f64, is_before: bool| -> Vec<f64> {
            let at = |k: usize| match inputs
                .as_ref()
                .and_then(|(table, columns)| Some((table, columns[k].as_ref()?)))
            {
                Some((table, values)) if is_before => table.before(values, t),
                Some((table, values)) => table.at(values, t),
                None => self.u[k],
            };
            (0..self.u.len()).map(at).collect()
        };
        self.mechanism.require_dynamics()?;
        let (nq, nv) = (self.q.len(), self.v.len());
        let begin = match self.mechanism.is_constrained() {
            true => self.begin()?,
            false => [self.q.clone(), self.v.clone()].concat(),
        };
        let mut y = [begin, self.x.clone()].concat();
        let count = (duration / every * (1.0 + 1e-12)).floor() as usize;
        let mut times: Vec<f64> = (0..=count).map(|k| k as f64 * every).collect();
        if times[count] < duration * (1.0 - 1e-9) {
            times.push(duration);
        }
        // Steps end at kinks and jumps of the inputs.
        let mut kinks = inputs.iter().flat_map(|(table, _)| &table.times).copied().peekable();
        let settle = |t: f64, y: &mut Vec<f64>| {
            let (mut q, mut v) = (y[..nq].to_vec(), y[nq..nq + nv].to_vec());
            let is_there = self.mechanism.settle(t, &mut q, &mut v).is_some();
            *y = [q, v, y[nq + nv..].to_vec()].concat();
            is_there
        };
        let mut integrator = Integrator::new(every.min(1e-3), tolerance);
        let (mut samples, mut at, mut is_told) = (Vec::with_capacity(times.len()), 0.0, false);
        for t in times {
            while at < t {
                while kinks.next_if(|kink| *kink <= at).is_some() {}
                let stop = kinks.peek().copied().filter(|kink| *kink < t).unwrap_or(t);
                let rates = |t: f64, y: &[f64]| {
                    let (q, v, x) = (&y[..nq], &y[nq..nq + nv], &y[nq + nv..]);
                    let u = if t < stop { given(t, false) } else { given(stop, true) };
                    let mut rates = self.mechanism.rates(q, v);
                    let state = Values { t, q, v, x, u: &u, ..Values::default() };
                    rates.extend(self.mechanism.accelerations(state));
                    rates
                };
                let system = System { rates: &rates, settle: &settle };
                integrator.advance(&system, (at, stop), &mut y).map_err(|t| {
                    let why = match self.mechanism.has_singular_speeds(&y[..nq], NEARLY_SINGULAR) {
                        true => "declared speeds are singular there",
                        false => "it is singular there, or too stiff",
                    };
                    Stop::Failure(format!("the motion cannot be continued beyond {t} s: {why}"))
                })?;
                if let Some(t) = integrator.stiff_from.take_if(|_| !is_told) {
                    is_told = true;
                    crate::note!(
                        "linkwork: the motion is stiff: from {t:.3} s on it is integrated by an implicit method (RODAS)"
                    );
                }
                self.mechanism.normalise(&mut y[..nq])?;
                at = stop;
            }
            let (q, v, x) = (y[..nq].to_vec(), y[nq..nq + nv].to_vec(), y[nq + nv..].to_vec());
            samples.push(Sample { t, q, v, x, u: given(t, false) });
        }
        Ok(samples)
    }

    /// Returns an initial state that satisfies the constraints: with the specified entries unchanged if
    /// possible, otherwise the nearest one. Prints the changes.
    fn begin(&self) -> Result<Vec<f64>, Stop> {
        let (m, [in_q, in_v]) = (&self.mechanism, &self.given);
        if !m.has_inertia(&self.q) && !m.has_singular_speeds(&self.q, SINGULAR) {
            return Err(Stop::Failure(format!(
                "the mass matrix of `{}` is singular at the beginning: with these parameters something that moves has no inertia",
                m.model.name
            )));
        }
        // Entries that no constraint affects remain unchanged.
        let [apart, still] = m.unreached(0.0, &self.q);
        let in_v: Vec<bool> = in_v.iter().zip(&still).map(|(given, still)| *given || *still).collect();
        let moving: Vec<bool> =
            m.moving(in_q).iter().zip(&apart).map(|(given, apart)| *given || *apart).collect();
        let near = match self.is_guessed {
            true => self.q.clone(),
            false => m.led(0.0, &self.q, in_q, &apart, &moving),
        };
        let from = (&near[..], &self.q[..]);
        let held = m.assembled(0.0, from, &m.entries(&moving), &moving);
        let mut kept = held.is_some();
        let q = held.or_else(|| m.assembled(0.0, from, &m.entries(&apart), &apart));
        let q = q.ok_or_else(|| {
            Stop::Failure(format!(
                "`{}` cannot be assembled: no configuration near the beginning fulfils the constraints; give another by `--set` or `--guess q.NAME=VALUE`",
                m.model.name
            ))
        })?;
        if m.has_singular_speeds(&q, SINGULAR) {
            let names: Vec<String> = m.model.configuration.iter().map(|name| format!("q.{name}")).collect();
            return Err(Stop::Failure(format!(
                "the speeds of `{}` are singular at the beginning: there they do not determine the rates of all coordinates; begin elsewhere (`--set` with {})",
                m.model.name,
                names.join(", ")
            )));
        }
        let mut v = self.v.clone();
        if m.move_along(0.0, &q, &mut v, &in_v).is_none() {
            kept = false;
            v.clone_from(&self.v);
            m.move_along(0.0, &q, &mut v, &still).ok_or_else(|| {
                Stop::Failure(format!("`{}` has constraints that contradict each other", m.model.name))
            })?;
        }
        let begins = [q, v].concat();
        let moves = self.moves(&begins);
        let some = self.given.iter().flatten().any(|given| *given);
        let given = self.given.iter().flatten().zip(self.q.iter().chain(&self.v).zip(&begins));
        let is_far = |(is_given, (wanted, is)): (&bool, (&f64, &f64))| *is_given && (wanted - is).abs() > FAR;
        if !kept && given.into_iter().any(is_far) {
            return Err(Stop::Failure(format!(
                "what is given does not fulfil the constraints: give less of it (`--guess q.NAME=VALUE` gives what is only about so), or what is nearest: {moves}"
            )));
        }
        let why = match (kept, some) {
            (true, true) => "what is given is kept, and the constraints put the rest",
            (false, _) => "what is given does not fulfil the constraints; the motion begins near it,",
            (true, false) => "zero does not fulfil the constraints; the motion begins near it,",
        };
        if !moves.is_empty() {
            let held = if kept { &moving } else { &apart };
            let mode = m.assembly_mode(0.0, &begins[..self.q.len()], held).map_or(String::new(), |mode| {
                format!(
                    "; this is assembly mode {mode}, and `--guess q.NAME=VALUE` near another begins there"
                )
            });
            crate::note!("linkwork: {why} at {moves}{mode}");
        }
        Ok(begins)
    }

    /// Formats the entries of the initial state that differ from the requested values.
    fn moves(&self, begins: &[f64]) -> String {
        let wanted = self.q.iter().chain(&self.v);
        let names = self.mechanism.model.configuration.iter().map(|name| format!("q.{name}"));
        let names = names.chain(self.mechanism.model.velocities.iter().map(|(name, _)| format!("v.{name}")));
        let moved: Vec<String> = names
            .zip(wanted.zip(begins))
            .filter(|(_, (wanted, is))| (*wanted - *is).abs() > TOLD * (1.0 + wanted.abs()))
            .map(|(name, (_, is))| format!("{name} = {is:.6}"))
            .collect();
        moved.join(", ")
    }

    /// Returns the inputs of a file, by their indices.
    #[expect(clippy::type_complexity, reason = "it is taken apart where it is made")]
    fn inputs(&self, matches: &ArgMatches) -> Result<Option<(Table, Vec<Option<Vec<f64>>>)>, Stop> {
        let Some(path) = matches.get_one::<PathBuf>("inputs") else { return Ok(None) };
        let table = Table::read(path)?;
        let names: Vec<String> =
            self.mechanism.model.inputs.iter().map(|(name, _)| format!("u.{name}")).collect();
        // Other columns of a log are ignored.
        let unknown = table.columns.iter().find(|(name, _)| name.starts_with("u.") && !names.contains(name));
        if let Some((name, _)) = unknown {
            let known = names.join(", ");
            return Err(Stop::Failure(format!(
                "{}: there is no input `{name}`, but {known}",
                path.display()
            )));
        }
        let columns: Vec<_> = names.iter().map(|name| table.column(name).map(<[f64]>::to_vec)).collect();
        let is_column =
            |(name, _): &(&str, f64)| names.iter().any(|n| n == name) && table.column(name).is_some();
        if let Some((name, _)) = values("set", matches)?.into_iter().find(is_column) {
            let path = path.display();
            return Err(Stop::Failure(format!("{path}: `{name}` is a column here and given by `--set`")));
        }
        if columns.iter().all(Option::is_none) {
            let expected = match names.is_empty() {
                true => format!("`{}` has no inputs", self.mechanism.model.name),
                false => format!("there is no column of an input: expected {}", names.join(", ")),
            };
            return Err(Stop::Failure(format!("{}: {expected}", path.display())));
        }
        Ok(Some((table, columns)))
    }
}

/// Returns the names with their values that an option gives; a name that is given twice is an error.
pub fn values<'a>(option: &str, matches: &'a ArgMatches) -> Result<Vec<(&'a str, f64)>, Stop> {
    let mut found: Vec<(&str, f64)> = Vec::new();
    for given in matches.get_many::<String>(option).into_iter().flatten() {
        let one = parse(&format!("--{option}"), given)?;
        if found.iter().any(|(known, _)| *known == one.0) {
            return Err(Stop::Failure(format!("`--{option}`: `{}` is given twice", one.0)));
        }
        found.push(one);
    }
    Ok(found)
}

/// Parses the `NAME=VALUE` of an option.
fn parse<'a>(option: &str, given: &'a str) -> Result<(&'a str, f64), Stop> {
    let fail =
        |what: &str, found: &str| Stop::Failure(format!("`{option}`: expected {what}, found `{found}`"));
    let (name, value) = given.split_once('=').ok_or_else(|| fail("NAME=VALUE", given))?;
    let number: Option<f64> = value.trim().parse().ok();
    let number = number.filter(|number| number.is_finite());
    let what = format!("a number for `{}`", name.trim());
    Ok((name.trim(), number.ok_or_else(|| fail(&what, value.trim()))?))
}
