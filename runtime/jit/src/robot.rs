//! Robot: a loaded mechanism with values of its parameters.

use crate::AnyTable;
use crate::error::Error;
use crate::functions::{LoadedFunction, Matrix, ResultAssembly};
use crate::internal::InternalFunction;
use crate::layout::InputLayout;
use crate::routine::Values;
use crate::shared::{Contact, Quantity, SharedMechanism};
use linkwork::__private::{Figure, validate};
use linkwork::contact::{Law, Restitution};
use linkwork_compiler::catalogue::Argument;
use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;

/// A mechanism that was loaded at run time, with values of its parameters.
///
/// Copies are cheap and share the machine code; each has parameters of its own. Threads may call the
/// functions of one robot at the same time.
#[derive(Clone)]
pub struct Robot {
    pub(crate) shared: Arc<SharedMechanism>,
    parameters: Vec<f64>,
    tables: Vec<AnyTable>,
    /// Number of parameters and tables of the robot that have no value yet.
    missing: usize,
    time: f64,
    interpreted: bool,
}

impl fmt::Debug for Robot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (nq, nv, nu) = (self.nq(), self.nv(), self.nu());
        write!(f, "Robot({}: {nq} coordinates, {nv} velocities, {nu} inputs)", self.name())
    }
}

/// Function of a robot, looked up by its name once and then called without a search.
#[derive(Clone)]
pub struct Function {
    shared: Arc<SharedMechanism>,
    index: usize,
}

impl fmt::Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Function({})", self.name())
    }
}

impl Function {
    pub(crate) fn shared_mechanism(&self) -> &Arc<SharedMechanism> {
        &self.shared
    }

    pub(crate) fn index(&self) -> usize {
        self.index
    }

    /// Returns the name of the function.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.shared.entries[self.index].name
    }

    /// Returns the documentation of the function.
    #[must_use]
    pub fn documentation(&self) -> &str {
        &self.shared.entries[self.index].documentation
    }

    /// Returns the name and length of each argument of the function, in order.
    #[must_use]
    pub fn arguments(&self) -> Vec<(&'static str, usize)> {
        let entry = &self.shared.entries[self.index];
        entry.arguments.iter().map(|a| (a.argument_name(), self.shared.sizes.length(*a))).collect()
    }

    /// Returns the results of the function: names and dimensions. Their values are written one after the
    /// other, matrices by columns.
    #[must_use]
    pub fn results(&self) -> &[Matrix] {
        &self.shared.entries[self.index].results
    }

    /// Returns the number of dimensions of the function's results: zero for scalars, one for vectors, two for
    /// matrices.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.shared.entries[self.index].rank
    }

    /// Returns the total number of values of the function's results.
    #[must_use]
    pub fn length(&self) -> usize {
        self.shared.entries[self.index].length
    }

    /// Generates the machine code of the function now instead of at the first call. Returns false if the
    /// function is interpreted: on processors without code generator, and if the code would be too long.
    pub fn compile(&self) -> bool {
        self.shared.compile_with_called_functions(self.index)
    }
}

/// Limits of a coordinate, its velocity and the generalized force on it; infinite if unlimited.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Index of the velocity of the limited coordinate.
    pub index: usize,
    /// Minimum value of the limited coordinate.
    pub lower: f64,
    /// Maximum value of the limited coordinate.
    pub upper: f64,
    /// Maximum magnitude of the velocity of the limited coordinate.
    pub velocity: f64,
    /// Maximum magnitude of the generalized force on the limited coordinate.
    pub effort: f64,
}

/// State, accelerations, forces and inputs that are passed to a function called by its index.
#[derive(Clone, Copy, Default)]
pub(crate) struct State<'a> {
    /// Time at which the function is evaluated; if absent, that of the robot.
    pub t: Option<f64>,
    pub q: &'a [f64],
    pub v: &'a [f64],
    /// First-order states; if empty, those stored among the parameters are used.
    pub x: &'a [f64],
    pub a: &'a [f64],
    pub tau: &'a [f64],
    pub u: &'a [f64],
    pub other: &'a [&'a [f64]],
}

thread_local! {
    static WORK: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

impl Robot {
    pub(crate) fn new(shared: Arc<SharedMechanism>, interpreted: bool) -> Robot {
        let parameters = shared.defaults.clone();
        let tables = vec![AnyTable::Missing; shared.tables.len()];
        let missing = parameters.iter().filter(|value| value.is_nan()).count() + tables.len();
        Robot { shared, parameters, tables, missing, time: 0.0, interpreted }
    }

    /// Returns the name of the mechanism.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.shared.name
    }

    /// Returns the number of entries of the configuration.
    #[must_use]
    pub fn nq(&self) -> usize {
        self.shared.sizes.nq
    }

    /// Returns the number of velocities.
    #[must_use]
    pub fn nv(&self) -> usize {
        self.shared.sizes.nv
    }

    /// Returns the number of inputs.
    #[must_use]
    pub fn nu(&self) -> usize {
        self.shared.sizes.nu
    }

    /// Returns the number of first-order states, which are parameters as well.
    #[must_use]
    pub fn states(&self) -> usize {
        self.shared.states.len()
    }

    /// Returns the name and unit of each entry of the configuration.
    #[must_use]
    pub fn configuration(&self) -> &[Quantity] {
        &self.shared.configuration
    }

    /// Returns the name and unit of each velocity. Accelerations and generalized forces have the same order.
    #[must_use]
    pub fn velocities(&self) -> &[Quantity] {
        &self.shared.velocities
    }

    /// Returns the name and unit of each input.
    #[must_use]
    pub fn inputs(&self) -> &[Quantity] {
        &self.shared.inputs
    }

    /// Returns the name and unit of each parameter.
    #[must_use]
    pub fn parameters(&self) -> &[Quantity] {
        &self.shared.parameters
    }

    /// Returns the values of the parameters, with NaN for parameters that have no value yet.
    #[must_use]
    pub fn parameter_values(&self) -> &[f64] {
        &self.parameters
    }

    /// Returns the interpolation tables of the mechanism, in the order of their declaration.
    pub(crate) fn interpolation_tables(&self) -> &[AnyTable] {
        &self.tables
    }

    /// Returns the name of each interpolation table, and its number of variables.
    #[must_use]
    pub fn tables(&self) -> &[(String, usize)] {
        &self.shared.tables
    }

    /// Returns the names of the frames of the mechanism.
    #[must_use]
    pub fn frames(&self) -> &[String] {
        &self.shared.frames.names
    }

    /// Returns the equations of motion as text, if the loader was set to produce them; otherwise an empty
    /// text.
    #[must_use]
    pub fn equations(&self) -> &str {
        &self.shared.equations
    }

    /// Whether the functions of the mechanism have time as their first argument.
    #[must_use]
    pub fn depends_on_time(&self) -> bool {
        self.shared.time
    }

    /// Returns all functions that callers may call.
    pub fn functions(&self) -> impl Iterator<Item = Function> {
        let all = self.shared.entries.iter().enumerate().filter(|(_, entry)| !entry.hidden);
        all.map(|(index, _)| Function { shared: self.shared.clone(), index })
    }

    /// Returns a function by its name. Functions of frames have the frame in parentheses:
    /// `frame_jacobian(hand)`.
    ///
    /// # Errors
    ///
    /// The mechanism has no such function.
    pub fn function(&self, name: &str) -> Result<Function, Error> {
        let index = self.shared.index.get(name).copied();
        let index = index.filter(|index| !self.shared.entries[*index].hidden);
        let index = index.ok_or_else(|| Error::unknown_name_error("function", name, self.shared.names()))?;
        Ok(Function { shared: self.shared.clone(), index })
    }

    /// Returns the value of a parameter by its name.
    ///
    /// # Errors
    ///
    /// The mechanism has no such parameter.
    pub fn parameter(&self, name: &str) -> Result<f64, Error> {
        Ok(self.parameters[self.parameter_index(name)?])
    }

    fn parameter_index(&self, name: &str) -> Result<usize, Error> {
        let known = &self.shared.parameters;
        known.iter().position(|parameter| parameter.name == name).ok_or_else(|| {
            Error::unknown_name_error("parameter", name, known.iter().map(|p| p.name.as_str()))
        })
    }

    /// Sets the value of a parameter by its name.
    ///
    /// # Errors
    ///
    /// The mechanism has no such parameter, or the value is not finite.
    pub fn set_parameter(&mut self, name: &str, value: f64) -> Result<(), Error> {
        let index = self.parameter_index(name)?;
        self.set_parameter_at(index, value)
    }

    fn set_parameter_at(&mut self, index: usize, value: f64) -> Result<(), Error> {
        if !value.is_finite() {
            let name = &self.shared.parameters[index].name;
            return Err(Error::Value(format!("the parameter `{name}` must be finite, but it is {value}")));
        }
        let before = std::mem::replace(&mut self.parameters[index], value);
        self.missing -= usize::from(before.is_nan());
        Ok(())
    }

    /// Sets the values of all parameters, in their order.
    ///
    /// # Errors
    ///
    /// The number of values is wrong, or one of them is not finite.
    pub fn set_parameters(&mut self, values: &[f64]) -> Result<(), Error> {
        self.check_length("parameters", self.parameters.len(), values.len())?;
        (0..values.len()).try_for_each(|k| self.set_parameter_at(k, values[k]))
    }

    /// Sets parameters by their names, and returns the robot.
    ///
    /// # Errors
    ///
    /// The mechanism lacks one of the parameters, or a value is not finite.
    pub fn with_parameters(mut self, values: &[(&str, f64)]) -> Result<Robot, Error> {
        values.iter().try_for_each(|(name, value)| self.set_parameter(name, *value))?;
        Ok(self)
    }

    /// Sets a table: an [`AnyTable`], or a `Table<1>`, `Table<2>` or `Table<3>`. The memory of the replaced
    /// table is returned when no other robot uses it.
    ///
    /// # Errors
    ///
    /// The mechanism has no such table, or it has another number of variables.
    pub fn set_table(&mut self, name: &str, table: impl Into<AnyTable>) -> Result<(), Error> {
        let (table, known) = (table.into(), &self.shared.tables);
        let index = known.iter().position(|(known, _)| known == name).ok_or_else(|| {
            Error::unknown_name_error("table", name, known.iter().map(|(name, _)| name.as_str()))
        })?;
        self.check_length(name, known[index].1, table.variables())?;
        let before = std::mem::replace(&mut self.tables[index], table);
        self.missing -= usize::from(before == AnyTable::Missing);
        Ok(())
    }

    /// Checks whether a physical mechanism can have the values of the parameters.
    ///
    /// # Errors
    ///
    /// The first value that none can have.
    pub fn validate(&self) -> Result<(), Error> {
        self.check_no_values_missing()?;
        let Some(index) = self.shared.index.get("figures") else { return Ok(()) };
        let values = self.call_function_at_state(*index, State::default())?;
        let mut rest = values.as_slice();
        for requirement in &self.shared.requirements {
            let (own, others) = rest.split_at(requirement.count.min(rest.len()));
            rest = others;
            // The message of the runtime begins with the name of the value, which it takes as a constant.
            let figure = Figure { rule: requirement.rule, name: "", parameters: &[] };
            validate(&[figure], own).map_err(|error| {
                let parameters = requirement.parameters.join("`, `");
                let names = match requirement.parameters.len() {
                    0 => String::new(),
                    1 => format!(" (by the parameter `{parameters}`)"),
                    _ => format!(" (by the parameters `{parameters}`)"),
                };
                Error::Value(format!("{}{error}{names}", requirement.figure))
            })?;
        }
        Ok(())
    }

    /// Returns the limits of the coordinates.
    ///
    /// # Errors
    ///
    /// A parameter has no value.
    pub fn limits(&self) -> Result<Vec<Limit>, Error> {
        let Some(index) = self.shared.index.get("limits") else { return Ok(Vec::new()) };
        let mut values = self.call_function_at_state(*index, State::default())?.into_iter();
        let mut next_bound_or_default = |present: bool, default: f64| match present {
            true => values.next().unwrap_or(default),
            false => default,
        };
        let limits = self.shared.limits.iter().map(|(index, [lower, upper, velocity, effort])| Limit {
            index: *index,
            lower: next_bound_or_default(*lower, f64::NEG_INFINITY),
            upper: next_bound_or_default(*upper, f64::INFINITY),
            velocity: next_bound_or_default(*velocity, f64::INFINITY),
            effort: next_bound_or_default(*effort, f64::INFINITY),
        });
        Ok(limits.collect())
    }

    /// Returns the time of the functions of [`Robot`] that take a state: zero until it is set.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Sets the time of the functions of [`Robot`] that take a state.
    pub fn set_time(&mut self, time: f64) {
        self.time = time;
    }

    /// Evaluates a function and writes its results one after the other, matrices by columns. The arguments
    /// are in the order of the function. Allocates nothing after the first call of a thread.
    ///
    /// # Errors
    ///
    /// A slice has the wrong length, a parameter has no value, or the function belongs to another mechanism.
    pub fn evaluate_into(&self, f: &Function, arguments: &[&[f64]], out: &mut [f64]) -> Result<(), Error> {
        let entry = self.entry_of_function(f)?;
        self.call_entry(entry, &self.parameters, arguments, out)
    }

    /// Evaluates a function and returns its results; see [`evaluate_into`](Self::evaluate_into).
    ///
    /// # Errors
    ///
    /// As [`evaluate_into`](Self::evaluate_into).
    pub fn evaluate(&self, f: &Function, arguments: &[&[f64]]) -> Result<Vec<f64>, Error> {
        let mut out = vec![0.0; f.length()];
        self.evaluate_into(f, arguments, &mut out)?;
        Ok(out)
    }

    /// Evaluates a function for `count` sets of arguments. Each argument has the values of all sets one after
    /// the other, or those of one set, which is used for all.
    ///
    /// # Errors
    ///
    /// As [`evaluate_into`](Self::evaluate_into).
    pub fn evaluate_many_into(
        &self,
        f: &Function,
        count: usize,
        arguments: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Error> {
        let entry = self.entry_of_function(f)?;
        let has_length_of_argument =
            |(list, length): (&&[f64], &usize)| list.len() == *length || list.len() == length * count;
        let fit = arguments.len() == entry.lengths.len()
            && arguments.iter().zip(&entry.lengths).all(has_length_of_argument)
            && out.len() == entry.length * count;
        if !fit || self.missing > 0 {
            return Err(self.call_error(entry, count, arguments, out.len()));
        }
        let mut lists: [&[f64]; InputLayout::MOST] = [&[]; InputLayout::MOST];
        (0..count).try_for_each(|k| {
            entry.select_state_arguments(k, arguments, &mut lists);
            let out = &mut out[k * entry.length..(k + 1) * entry.length];
            self.run_entry(entry, &self.parameters, &lists[..arguments.len()], out)
        })
    }

    /// Returns the entry of a function of this mechanism.
    #[inline]
    fn entry_of_function(&self, f: &Function) -> Result<&LoadedFunction, Error> {
        match Arc::ptr_eq(&self.shared, &f.shared) {
            true => Ok(&self.shared.entries[f.index]),
            false => Err(Error::OtherMechanism(f.name().to_string())),
        }
    }

    /// Evaluates a function for one set of arguments.
    #[inline]
    fn call_entry(
        &self,
        entry: &LoadedFunction,
        parameters: &[f64],
        arguments: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Error> {
        // Most functions are one program with machine code.
        if let ResultAssembly::Program(routine) = &entry.plan
            && let Some(code) = routine.code()
            && out.len() == entry.length
            && self.missing == 0
            && !self.interpreted
            && !entry.takes_features
            && code.call_if_lengths_match(parameters, arguments, &entry.lengths, &self.tables, out)
        {
            return Ok(());
        }
        self.check_and_run_entry(entry, parameters, arguments, out)
    }

    /// Evaluates a function for one set of arguments, after a check of their lengths.
    #[inline(never)]
    fn check_and_run_entry(
        &self,
        entry: &LoadedFunction,
        parameters: &[f64],
        arguments: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Error> {
        let has_length_of_argument = |(list, length): (&&[f64], &usize)| list.len() == *length;
        let fit = arguments.len() == entry.lengths.len()
            && arguments.iter().zip(&entry.lengths).all(has_length_of_argument)
            && out.len() == entry.length;
        if !fit || self.missing > 0 {
            return Err(self.call_error(entry, 1, arguments, out.len()));
        }
        self.run_entry(entry, parameters, arguments, out)
    }

    /// Evaluates a function whose arguments and results have the right lengths.
    fn run_entry(
        &self,
        entry: &LoadedFunction,
        parameters: &[f64],
        arguments: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Error> {
        let values = Values { parameters, arguments, tables: &self.tables, interpreted: self.interpreted };
        match &entry.plan {
            ResultAssembly::Program(routine) if !entry.takes_features => routine.run(values, out, &mut []),
            ResultAssembly::Constrained(kind) => return self.call_constrained(*kind, arguments, out),
            ResultAssembly::SeparateContacts(function) => {
                return self.call_separate_contacts(*function, arguments, out);
            }
            _ => WORK.with_borrow_mut(|work| {
                if work.len() < entry.work {
                    work.resize(entry.work, 0.0);
                }
                entry.run(&self.shared, values, out, work);
            }),
        }
        Ok(())
    }

    /// Returns the error for a call with missing values, or with arguments or results of the wrong length.
    #[cold]
    fn call_error(&self, entry: &LoadedFunction, count: usize, arguments: &[&[f64]], out: usize) -> Error {
        let missing = self.check_no_values_missing().err();
        missing.unwrap_or_else(|| argument_length_error(entry, count, arguments, out))
    }

    /// Evaluates a function that the runtime calls. After an error, such as an absent function, the results
    /// are NaN.
    pub(crate) fn call_internal_function(&self, f: InternalFunction, state: State<'_>, out: &mut [f64]) {
        let index = self.shared.internal[f as usize];
        if index.is_none_or(|index| self.call_with_state_into(index, state, out).is_err()) {
            out.fill(f64::NAN);
        }
    }

    /// Returns the coefficients of the contacts; NaN if they cannot be evaluated.
    pub(crate) fn contact_laws(&self) -> Vec<Law<f64>> {
        let contacts = &self.shared.contacts;
        let mut values = vec![f64::NAN; 3 * contacts.len()];
        self.call_internal_function(InternalFunction::ContactLaws, State::default(), &mut values);
        let law_of_contact = |(contact, values): (&Contact, &[f64])| Law {
            friction: values[0],
            restitution: values[1],
            stiction: values[2],
            hypothesis: if contact.of_impulses { Restitution::Poisson } else { Restitution::Newton },
        };
        contacts.iter().zip(values.chunks_exact(3)).map(law_of_contact).collect()
    }

    /// Evaluates a function, given by its index, with the arguments that it takes from the state.
    pub(crate) fn call_with_state_into(
        &self,
        index: usize,
        state: State<'_>,
        out: &mut [f64],
    ) -> Result<(), Error> {
        let entry = &self.shared.entries[index];
        let time = [state.t.unwrap_or(self.time)];
        let mut arguments: [&[f64]; InputLayout::MOST] = [&[]; InputLayout::MOST];
        let mut others = state.other.iter().copied();
        for (list, argument) in arguments.iter_mut().zip(&entry.arguments) {
            *list = match argument {
                Argument::T => &time,
                Argument::Q => state.q,
                Argument::V => state.v,
                Argument::A => state.a,
                Argument::Tau => state.tau,
                Argument::U => state.u,
                _ => others.next().unwrap_or(&[]),
            };
        }
        let arguments = &arguments[..entry.arguments.len()];
        if state.x.is_empty() {
            return self.call_entry(entry, &self.parameters, arguments, out);
        }
        let mut parameters = self.parameters.clone();
        for (value, one) in state.x.iter().zip(&self.shared.states) {
            parameters[one.parameter] = *value;
        }
        self.call_entry(entry, &parameters, arguments, out)
    }

    pub(crate) fn call_function_at_state(&self, index: usize, state: State<'_>) -> Result<Vec<f64>, Error> {
        let mut out = vec![0.0; self.shared.entries[index].length];
        self.call_with_state_into(index, state, &mut out)?;
        Ok(out)
    }

    pub(crate) fn check_length(&self, name: &str, expected: usize, found: usize) -> Result<(), Error> {
        match expected == found {
            true => Ok(()),
            false => {
                Err(Error::Length { of: self.shared.name.clone(), name: name.to_string(), expected, found })
            }
        }
    }

    pub(crate) fn check_no_values_missing(&self) -> Result<(), Error> {
        if self.missing == 0 {
            return Ok(());
        }
        let parameters = self.shared.parameters.iter().zip(&self.parameters);
        let parameters = parameters.filter(|(_, value)| value.is_nan()).map(|(p, _)| format!("`{}`", p.name));
        let tables = self.shared.tables.iter().zip(&self.tables);
        let tables = tables
            .filter(|(_, table)| **table == AnyTable::Missing)
            .map(|((name, _), _)| format!("`{name}`"));
        Err(Error::Missing(parameters.chain(tables).collect()))
    }
}

/// Returns the error for a call whose arguments or results have the wrong length.
#[cold]
fn argument_length_error(entry: &LoadedFunction, count: usize, arguments: &[&[f64]], out: usize) -> Error {
    let of = entry.name.clone();
    if arguments.len() != entry.arguments.len() {
        let expected = entry.arguments.iter().map(|argument| argument.argument_name()).collect();
        return Error::Arguments { of, expected, found: arguments.len() };
    }
    let lists = entry.arguments.iter().zip(arguments).zip(&entry.lengths);
    for ((argument, list), length) in lists {
        if list.len() != *length && list.len() != length * count {
            let name = argument.argument_name().to_string();
            return Error::Length { of, name, expected: length * count, found: list.len() };
        }
    }
    Error::Length { of, name: "the result".to_string(), expected: entry.length * count, found: out }
}
