//! Initial state of a motion, and the simulation from this state.

use crate::Stop;
use crate::assemble::MechanismAssembler;
use crate::grid;
use crate::input::LoadedMechanism;
use crate::table::TimeSeriesTable;
use clap::ArgMatches;
use linkwork::integrate;
use linkwork::nalgebra::IsometryMatrix3;
use linkwork::simulate::Overlaps;
use linkwork_compiler::diag::nearest_candidate;
use linkwork_compiler::expr::Expr;
use linkwork_compiler::expr::eval::eval_one;
use linkwork_compiler::mechanism::{Chart, Model, Quantity};
use linkwork_jit::{Error, Inputs, Method, Robot};
use std::path::PathBuf;

/// Sample of a motion: the state at one instant.
pub struct Sample {
    /// Time of the sample, s.
    pub t: f64,
    /// Configuration at the time of the sample.
    pub q: Vec<f64>,
    /// Velocity at the time of the sample.
    pub v: Vec<f64>,
    /// States of first order at the time of the sample.
    pub x: Vec<f64>,
    /// Inputs at the time of the sample.
    pub u: Vec<f64>,
}

/// Mechanism with its parameters, initial state and initial inputs.
pub struct MotionStart<'a, 'g> {
    /// Mechanism with the values of its parameters.
    pub robot: Robot,
    /// Model of the mechanism.
    pub model: &'a Model<'g>,
    /// Names of the mechanism's states of first order.
    pub states: Vec<String>,
    /// Initial configuration of the motion.
    pub q: Vec<f64>,
    v: Vec<f64>,
    /// Initial states of first order of the motion.
    pub x: Vec<f64>,
    /// Constant inputs of the motion.
    pub u: Vec<f64>,
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
/// Maximum number of samples of a simulated motion.
const MAX_SAMPLES: f64 = 1e7;

/// Normalises the quaternions of a configuration; a zero quaternion is an error.
pub fn normalise_quaternions(model: &Model<'_>, q: &mut [f64]) -> Result<(), Stop> {
    for first in model.charts.iter().filter_map(Chart::first_quaternion_index) {
        let quaternion = &mut q[first.range_of_entries(4)];
        let size = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
        if size < 1e-9 || !size.is_finite() {
            let names = model.configuration[first.range_of_entries(4)].join(", ");
            return Err(Stop::Failure(format!("the quaternion {names} is zero")));
        }
        quaternion.iter_mut().for_each(|x| *x /= size);
    }
    Ok(())
}

impl<'a, 'g> MotionStart<'a, 'g> {
    /// Reads the parameters, the initial state and the inputs from `--set`, `--guess` and `--table`.
    pub fn new(loaded: &'a LoadedMechanism<'g>, matches: &ArgMatches) -> Result<MotionStart<'a, 'g>, Stop> {
        let LoadedMechanism { source, model, robot, .. } = loaded;
        let mut robot = robot.clone();
        let prefixed_velocity_names = |list: &[(String, linkwork_compiler::diag::Place)]| -> Vec<String> {
            list.iter().map(|(name, _)| format!("v.{name}")).collect()
        };
        let velocities = prefixed_velocity_names(&model.velocities);
        let configuration: Vec<String> = model.configuration.iter().map(|name| format!("q.{name}")).collect();
        let inputs: Vec<String> = model.inputs.iter().map(|(name, _)| format!("u.{name}")).collect();
        let mut parameters = vec![None; model.parameters.len()];
        let states: Vec<(String, usize)> =
            source.mechanism.description.states.iter().map(|(name, k)| (name.text.clone(), *k)).collect();
        // States of first order are zero by default, as coordinates are.
        states.iter().for_each(|(_, k)| parameters[*k] = Some(0.0));
        let of_states: Vec<String> = states.iter().map(|(name, _)| format!("x.{name}")).collect();
        let mut q = model.initial_configuration.clone().unwrap_or_else(|| model.neutral_configuration());
        let (mut v, mut u) = (vec![0.0; model.nv()], vec![0.0; model.nu()]);
        let mut known = [vec![false; q.len()], vec![false; v.len()]];
        for (name, value) in named_option_values("set", matches)? {
            let index_of_name = |list: &[String]| list.iter().position(|known| known == name);
            if let Some(k) = index_of_name(&model.parameters) {
                parameters[k] = Some(value);
            } else if let Some(k) = index_of_name(&of_states) {
                parameters[states[k].1] = Some(value);
            } else if let Some(k) = index_of_name(&configuration) {
                (q[k], known[0][k]) = (value, true);
            } else if let Some(k) = index_of_name(&velocities) {
                (v[k], known[1][k]) = (value, true);
            } else if let Some(k) = index_of_name(&inputs) {
                u[k] = value;
            } else {
                let is_state = |name: &&String| states.iter().any(|(state, _)| state == *name);
                let own: Vec<String> =
                    model.parameters.iter().filter(|name| !is_state(name)).cloned().collect();
                let known = [own, configuration, velocities, of_states, inputs].concat();
                let meant = nearest_candidate(name, &known.iter().map(String::as_str).collect::<Vec<_>>());
                let meant = meant.map_or(String::new(), |meant| format!("; did you mean `{meant}`?"));
                let known = known.join(", ");
                return Err(Stop::Failure(format!("`--set`: there is no `{name}`, but {known}{meant}")));
            }
        }
        let is_guessed = matches.contains_id("guess");
        for (name, value) in named_option_values("guess", matches)? {
            let Some(k) = configuration.iter().position(|known| known == name) else {
                let known = configuration.join(", ");
                return Err(Stop::Failure(format!("`--guess`: there is no `{name}`, but {known}")));
            };
            if known[0][k] {
                return Err(Stop::Failure(format!("`{name}` is given by `--set` and by `--guess`")));
            }
            q[k] = value;
        }
        if matches.try_contains_id("live").unwrap_or(false) && matches.get_flag("live") {
            fill_missing_parameters(model, &mut parameters);
        }
        let missing: Vec<String> = (model.parameters.iter().zip(&parameters))
            .filter(|(_, value)| value.is_none())
            .map(|(name, _)| format!("--set {name}=…"))
            .collect();
        if !missing.is_empty() {
            return Err(Stop::Failure(format!("parameters without a value: {}", missing.join(" "))));
        }
        for ((name, _), grid) in source
            .tables_with_variable_counts()
            .iter()
            .zip(grid::tables_from_options(matches, &source.tables_with_variable_counts())?)
        {
            robot.set_table(name, grid.interpolation_table()?)?;
        }
        let parameters: Vec<f64> = parameters.into_iter().flatten().collect();
        let x = states.iter().map(|(_, k)| parameters[*k]).collect();
        robot.set_parameters(&parameters)?;
        robot.validate()?;
        normalise_quaternions(model, &mut q)?;
        let states = states.into_iter().map(|(name, _)| name).collect();
        Ok(MotionStart { robot, model, states, q, v, x, u, given: known, is_guessed })
    }

    /// Returns the reason why the mechanism has no motion, if any.
    pub fn reason_without_motion(&self) -> Option<&'static str> {
        self.model
            .kinematic
            .then_some("it has no masses (`inertia = none`), so it has no equations of motion")
    }

    /// Returns the placement of every frame for a time, a configuration and states of first order.
    ///
    /// # Errors
    ///
    /// An internal error.
    pub fn frame_placements(&self, t: f64, q: &[f64], x: &[f64]) -> Result<Vec<IsometryMatrix3<f64>>, Stop> {
        let mut robot = self.robot.clone();
        robot.set_time(t);
        for (name, value) in self.states.iter().zip(x) {
            robot.set_parameter(name, *value)?;
        }
        let placed = robot.frames().iter().map(|frame| robot.frame_placement(frame, q));
        let isometry_with_rotation_matrix = |placement: linkwork::nalgebra::Isometry3<f64>| {
            let rotation = placement.rotation.to_rotation_matrix();
            IsometryMatrix3::from_parts(placement.translation, rotation)
        };
        Ok(placed.map(|placement| placement.map(isometry_with_rotation_matrix)).collect::<Result<_, _>>()?)
    }

    /// Returns the value of an expression that depends on parameters alone.
    pub fn evaluate_expression(&self, e: Expr<'_>) -> f64 {
        let parameters = self.robot.parameter_values();
        eval_one(e, &|symbol| match Quantity::from_symbol(symbol) {
            Quantity::Parameter(k) => parameters.get(k).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        })
    }

    /// Returns the integration method that the options of the command select.
    fn integration_method(&self, matches: &ArgMatches, without_contacts: bool) -> Result<Method, Stop> {
        let read_positive_option = |name: &str| match matches.get_one::<f64>(name) {
            Some(x) if !(*x > 0.0 && x.is_finite()) => {
                Err(Stop::Failure(format!("`--{name}`: expected a number above zero, found {x}")))
            }
            given => Ok(given.copied()),
        };
        let (tolerance, step) = (read_positive_option("tolerance")?, read_positive_option("step")?);
        let has_contacts = !self.model.contacts.is_empty() && !without_contacts;
        let name = match matches.get_one::<String>("method").map(|name| name.replace('-', "_")) {
            None if has_contacts => "time_stepping".to_string(),
            name => name.unwrap_or_else(|| "automatic".to_string()),
        };
        let found = Method::NAMES.iter().find(|(known, ..)| *known == name);
        let (_, has_step, treats_contacts) = found.copied().unwrap_or(("automatic", false, true));
        if has_contacts && !treats_contacts {
            return Err(Stop::Failure(format!(
                "`{}` has contacts: `--method` time-stepping, time-stepping-midpoint, time-stepping-leapfrog or event-driven; or `--without-contacts` lets bodies pass through each other",
                self.model.name
            )));
        }
        if step.is_some() && !has_step && name != "automatic" {
            let method = name.replace('_', "-");
            return Err(Stop::Failure(format!(
                "`--step`: the method {method} chooses its steps (`--tolerance`)"
            )));
        }
        let setting = if has_step { step } else { Some(tolerance.unwrap_or(1e-8).max(1e-13)) };
        Ok(Method::from_name(&name, setting)?)
    }

    /// Simulates the motion that the options describe, and returns its samples.
    pub fn simulate_motion(&self, matches: &ArgMatches) -> Result<Vec<Sample>, Stop> {
        let name = &self.model.name;
        if let Some(why) = self.reason_without_motion() {
            return Err(Stop::Failure(format!("`{name}` cannot be simulated: {why}")));
        }
        let positive_option_or_default = |name: &str, usual: f64| match matches.get_one::<f64>(name) {
            Some(x) if !(*x > 0.0 && x.is_finite()) => {
                Err(Stop::Failure(format!("`--{name}`: expected a number above zero, found {x}")))
            }
            given => Ok(given.copied().unwrap_or(usual)),
        };
        let (duration, every) =
            (positive_option_or_default("duration", 10.0)?, positive_option_or_default("every", 1.0 / 60.0)?);
        if duration / every > MAX_SAMPLES {
            return Err(Stop::Failure(format!("more than {MAX_SAMPLES} samples: choose a larger `--every`")));
        }
        let without_contacts = matches.get_flag("without-contacts");
        let method = self.integration_method(matches, without_contacts)?;
        let (times, values) = self.read_inputs(matches)?;
        let (q, v) = self.initial_state()?;
        let state = [&v[..], &self.x].concat();
        let sampled_inputs = || Inputs::Samples { times: &times, values: &values };
        let simulate_from_state = |q: &'_ [f64], v: &'_ [f64], duration: f64, samples: &mut Vec<Sample>| {
            let run =
                self.robot.simulate().from(q, v).inputs(sampled_inputs()).method(method).duration(duration);
            let run = run.sample_every(every).overlaps(Overlaps::Part);
            let run = if without_contacts { run.without_contacts() } else { run };
            let count = self.v.len();
            run.each(&mut |sample| {
                let (v, x) = sample.v.split_at(count);
                let (v, x) = (v.to_vec(), x.to_vec());
                samples.push(Sample { t: sample.t, q: sample.q, v, x, u: sample.u });
            })
        };
        let mut samples = Vec::new();
        let ended = simulate_from_state(&q, &state, duration, &mut samples);
        if let Some(first) = samples.first_mut().filter(|_| self.robot.is_constrained()) {
            // The projection of the start changes rounding alone.
            (first.q, first.v) = (q.clone(), v.clone());
        } else if let Some(first) = samples.first() {
            let moved = self.format_state_changes(&first.q, &first.v);
            if !moved.is_empty() && !self.model.contacts.is_empty() {
                crate::note!(
                    "linkwork: surfaces overlap at the beginning; the motion begins near it, at {moved}"
                );
            }
        }
        match ended {
            Ok(Some(t)) => crate::note!(
                "linkwork: the motion is stiff: from {t:.3} s on it is integrated by an implicit method \
                 (RODAS)"
            ),
            Ok(None) => {}
            Err(error) => {
                // The state shortly before the failure.
                let last = samples.last().map(|last| (last.q.clone(), last.t));
                let mut before = Vec::new();
                let mut sample_shortly_before_failure = || {
                    let (_, from) = last.as_ref()?;
                    let t = time_of_failure(&error)?;
                    let to = from + (t - from) * (1.0 - 1e-3);
                    let _ = simulate_from_state(&q, &state, to, &mut before);
                    before.pop()
                };
                return Err(
                    self.motion_failure(&error, sample_shortly_before_failure().map(|sample| sample.q))
                );
            }
        }
        Ok(samples)
    }

    /// Returns the message of a motion that cannot be continued.
    fn motion_failure(&self, error: &Error, q: Option<Vec<f64>>) -> Stop {
        let Some(t) = time_of_failure(error) else { return Stop::Failure(error.to_string()) };
        let has_singular_speeds = q.is_some_and(|q| self.robot.regularity_of_speeds(&q) <= NEARLY_SINGULAR);
        let why = match has_singular_speeds {
            true => "declared speeds are singular there",
            false => "it is singular there, or too stiff",
        };
        Stop::Failure(format!("the motion cannot be continued beyond {t} s: {why}"))
    }

    /// Returns configuration and velocity at the beginning, which satisfy the constraints.
    ///
    /// # Errors
    ///
    /// The mechanism cannot be assembled.
    pub fn initial_state(&self) -> Result<(Vec<f64>, Vec<f64>), Stop> {
        match self.robot.is_constrained() {
            true => self.consistent_initial_state(),
            false => Ok((self.q.clone(), self.v.clone())),
        }
    }

    /// Returns the inputs at the start of the motion.
    pub fn inputs_at_start(&self) -> &[f64] {
        &self.u
    }

    /// Returns an initial state that satisfies the constraints: with the specified entries unchanged if
    /// possible, otherwise the nearest one. Prints the changes.
    fn consistent_initial_state(&self) -> Result<(Vec<f64>, Vec<f64>), Stop> {
        let m = MechanismAssembler { robot: &self.robot, model: self.model };
        let (name, [in_q, in_v]) = (&self.model.name, &self.given);
        let has_singular_speeds = |q: &[f64]| self.robot.regularity_of_speeds(q) <= SINGULAR;
        if !has_singular_speeds(&self.q) && !m.has_positive_definite_constrained_inertia(&self.q)? {
            return Err(Stop::Failure(format!(
                "the mass matrix of `{name}` is singular at the beginning: with these parameters a moving \
                 body has no inertia"
            )));
        }
        // Entries that no constraint affects remain unchanged.
        let [apart, still] = m.unconstrained_velocity_masks(&self.q);
        let in_v: Vec<bool> = in_v.iter().zip(&still).map(|(given, still)| *given || *still).collect();
        let moving: Vec<bool> = m
            .velocity_mask_of_entries(in_q)
            .iter()
            .zip(&apart)
            .map(|(given, apart)| *given || *apart)
            .collect();
        let near = match self.is_guessed {
            true => self.q.clone(),
            false => m.configuration_by_continuation(&self.q, in_q, &apart, &moving)?,
        };
        let held = m.assemble_near(&near, &self.q, &moving);
        let mut kept = held.is_some();
        let q = held.or_else(|| m.assemble_near(&near, &self.q, &apart));
        let q = q.ok_or_else(|| {
            Stop::Failure(format!(
                "`{name}` cannot be assembled: no configuration near the initial one satisfies the \
                 constraints; give another by `--set` or `--guess q.NAME=VALUE`"
            ))
        })?;
        if has_singular_speeds(&q) {
            let names: Vec<String> =
                self.model.configuration.iter().map(|name| format!("q.{name}")).collect();
            return Err(Stop::Failure(format!(
                "the speeds of `{name}` are singular at the beginning: there they do not determine the rates \
                 of all coordinates; start elsewhere (`--set` with {})",
                names.join(", ")
            )));
        }
        let v = m.complete_velocity_from_fixed_entries(&q, &self.v, &in_v).or_else(|| {
            kept = false;
            m.complete_velocity_from_fixed_entries(&q, &self.v, &still)
        });
        let v =
            v.ok_or_else(|| Stop::Failure(format!("`{name}` has constraints that contradict each other")))?;
        let moves = self.format_state_changes(&q, &v);
        let some = self.given.iter().flatten().any(|given| *given);
        let given = self.given.iter().flatten().zip(self.q.iter().chain(&self.v).zip(q.iter().chain(&v)));
        let is_far_from_given_value =
            |(is_given, (wanted, is)): (&bool, (&f64, &f64))| *is_given && (wanted - is).abs() > FAR;
        if !kept && given.into_iter().any(is_far_from_given_value) {
            return Err(Stop::Failure(format!(
                "the given values do not satisfy the constraints: give fewer (`--guess q.NAME=VALUE` gives \
                 an approximate value), or the nearest ones: {moves}"
            )));
        }
        let why = match (kept, some) {
            (true, true) => "the given values are kept, and the constraints determine the others",
            (false, _) => "the given values do not satisfy the constraints; the motion begins near them,",
            (true, false) => "zero does not satisfy the constraints; the motion begins near it,",
        };
        if !moves.is_empty() {
            let held = if kept { &moving } else { &apart };
            let mode = m.assembly_mode_of_configuration(&q, held).map_or(String::new(), |mode| {
                format!(
                    "; this is assembly mode {mode}, and `--guess q.NAME=VALUE` near another mode selects it"
                )
            });
            crate::note!("linkwork: {why} at {moves}{mode}");
        }
        Ok((q, v))
    }

    /// Formats the entries of the initial state that differ from the requested values.
    fn format_state_changes(&self, q: &[f64], v: &[f64]) -> String {
        let wanted = self.q.iter().chain(&self.v);
        let names = self.model.configuration.iter().map(|name| format!("q.{name}"));
        let names = names.chain(self.model.velocities.iter().map(|(name, _)| format!("v.{name}")));
        let moved: Vec<String> = names
            .zip(wanted.zip(q.iter().chain(v)))
            .filter(|(_, (wanted, is))| (*wanted - *is).abs() > TOLD * (1.0 + wanted.abs()))
            .map(|(name, (_, is))| format!("{name} = {is:.6}"))
            .collect();
        moved.join(", ")
    }

    /// Returns the times of the samples of an input file, and the inputs at each of them.
    fn read_inputs(&self, matches: &ArgMatches) -> Result<(Vec<f64>, Vec<f64>), Stop> {
        let Some(path) = matches.get_one::<PathBuf>("inputs") else { return Ok((vec![0.0], self.u.clone())) };
        let table = TimeSeriesTable::read_table(path)?;
        let names: Vec<String> = self.model.inputs.iter().map(|(name, _)| format!("u.{name}")).collect();
        // Other columns of a log are ignored.
        let unknown = table.columns.iter().find(|(name, _)| name.starts_with("u.") && !names.contains(name));
        if let Some((name, _)) = unknown {
            let known = names.join(", ");
            return Err(Stop::Failure(format!(
                "{}: there is no input `{name}`, but {known}",
                path.display()
            )));
        }
        let columns: Vec<Option<&[f64]>> = names.iter().map(|name| table.column_by_name(name)).collect();
        let is_column =
            |(name, _): &(&str, f64)| names.iter().any(|n| n == name) && table.column_by_name(name).is_some();
        if let Some((name, _)) = named_option_values("set", matches)?.into_iter().find(is_column) {
            let path = path.display();
            return Err(Stop::Failure(format!("{path}: `{name}` is a column here and given by `--set`")));
        }
        if columns.iter().all(Option::is_none) {
            let expected = match names.is_empty() {
                true => format!("`{}` has no inputs", self.model.name),
                false => format!("there is no column of an input: expected {}", names.join(", ")),
            };
            return Err(Stop::Failure(format!("{}: {expected}", path.display())));
        }
        let column_and_row_indices = |k: usize| (0..columns.len()).map(move |i| (i, k));
        let input_value_in_table_row =
            |(i, k): (usize, usize)| columns[i].map_or(self.u[i], |column| column[k]);
        let values =
            (0..table.times.len()).flat_map(column_and_row_indices).map(input_value_in_table_row).collect();
        Ok((table.times.clone(), values))
    }
}

/// Gives parameters without a value the value of a page's sliders: gravity on Earth, otherwise one.
fn fill_missing_parameters(model: &Model<'_>, parameters: &mut [Option<f64>]) {
    let mut chosen = Vec::new();
    for (k, value) in parameters.iter_mut().enumerate().filter(|(_, value)| value.is_none()) {
        let is_gravity = model.units.parameters.get(k).is_some_and(|unit| unit == "m/s²");
        *value = Some(if is_gravity { 9.81 } else { 1.0 });
        chosen.push(format!("{} = {}", model.parameters[k], if is_gravity { 9.81 } else { 1.0 }));
    }
    if !chosen.is_empty() {
        crate::note!("linkwork: parameters without a value begin at {}", chosen.join(", "));
    }
}

/// Returns the time at which a numerical error ended a motion.
fn time_of_failure(error: &Error) -> Option<f64> {
    use integrate::Error::{NotConverged, NotFinite, StepTooSmall, TooManySteps};
    let Error::Motion { reason, .. } = error else { return None };
    match *reason {
        NotFinite { t } | StepTooSmall { t, .. } | TooManySteps { t } | NotConverged { t, .. } => Some(t),
        _ => None,
    }
}

/// Returns the names with their values that an option gives; a name that is given twice is an error.
pub fn named_option_values<'a>(option: &str, matches: &'a ArgMatches) -> Result<Vec<(&'a str, f64)>, Stop> {
    let mut found: Vec<(&str, f64)> = Vec::new();
    for given in matches.get_many::<String>(option).into_iter().flatten() {
        let one = parse_assignment(&format!("--{option}"), given)?;
        if found.iter().any(|(known, _)| *known == one.0) {
            return Err(Stop::Failure(format!("`--{option}`: `{}` is given twice", one.0)));
        }
        found.push(one);
    }
    Ok(found)
}

/// Parses the value `NAME=VALUE` of a command-line option.
fn parse_assignment<'a>(option: &str, given: &'a str) -> Result<(&'a str, f64), Stop> {
    let option_error =
        |what: &str, found: &str| Stop::Failure(format!("`{option}`: expected {what}, found `{found}`"));
    let (name, value) = given.split_once('=').ok_or_else(|| option_error("NAME=VALUE", given))?;
    let number: Option<f64> = value.trim().parse().ok();
    let number = number.filter(|number| number.is_finite());
    let what = format!("a number for `{}`", name.trim());
    Ok((name.trim(), number.ok_or_else(|| option_error(&what, value.trim()))?))
}
