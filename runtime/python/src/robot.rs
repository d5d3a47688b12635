//! Loaded mechanisms as Python objects.

use crate::error::{python_error_from_message, python_exception_of_error};
use crate::function::Function;
use crate::shared::{FirstFailedState, process_shares_in_parallel};
use linkwork_jit::{AdjointStepper, AnyTable, Error, Loader, Quantity, Sensitivity, Stepper};
use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyReadwriteArray2,
    PyReadwriteArray3,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Loaded mechanism with the values of its parameters, or with one set of values for each state of a batch.
#[pyclass(frozen, module = "linkwork._native")]
pub struct Robot {
    pub robot: linkwork_jit::Robot,
    /// Number of parameter sets, and their values one set after the other; `None` for a single set.
    pub sets: Option<(usize, Vec<f64>)>,
}

/// Returns the loader for a mechanism in a file or a text.
pub fn loader(
    source: &str,
    is_file: bool,
    options: &str,
    name: Option<&str>,
    folder: Option<&str>,
) -> Loader {
    let mut loader = if is_file { Loader::file(source) } else { Loader::text(source) }.options(options);
    if let Some(name) = name {
        loader = loader.name(name);
    }
    if let Some(folder) = folder {
        loader = loader.folder(folder);
    }
    loader
}

/// Loads a mechanism from a file or a text.
#[pyfunction]
#[pyo3(signature = (source, *, is_file, options, name, folder, equations = false))]
pub fn load(
    py: Python<'_>,
    source: &str,
    is_file: bool,
    options: &str,
    name: Option<&str>,
    folder: Option<&str>,
    equations: bool,
) -> PyResult<Robot> {
    let mut loader = loader(source, is_file, options, name, folder);
    if equations {
        loader = loader.readable_equations();
    }
    let robot = py.detach(|| loader.load()).map_err(|error| python_exception_of_error(py, &error, None))?;
    Ok(Robot { robot, sets: None })
}

/// Returns the names and units of a list of quantities.
fn names_and_units(list: &[Quantity]) -> Vec<(&str, &str)> {
    list.iter().map(|entry| (entry.name.as_str(), entry.unit.as_str())).collect()
}

/// Limits of a coordinate: the index of its velocity, then the lower, upper, velocity and effort limit.
type LimitValues = (usize, f64, f64, f64, f64);

#[pymethods]
impl Robot {
    /// Returns the names, units and sizes of all quantities of the mechanism.
    fn describe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (robot, about) = (&self.robot, PyDict::new(py));
        about.set_item("name", robot.name())?;
        about.set_item("documentation", robot.documentation())?;
        about.set_item("configuration", names_and_units(robot.configuration()))?;
        about.set_item("velocities", names_and_units(robot.velocities()))?;
        about.set_item("inputs", names_and_units(robot.inputs()))?;
        about.set_item("parameters", names_and_units(robot.parameters()))?;
        about.set_item("outputs", names_and_units(robot.outputs()))?;
        about.set_item("tables", robot.tables().to_vec())?;
        about.set_item("frames", robot.frames())?;
        about.set_item("time", robot.depends_on_time())?;
        about.set_item("constraints", robot.constraints())?;
        about.set_item("contacts", robot.contacts())?;
        about.set_item("states", robot.states())?;
        Ok(about)
    }

    /// Returns the functions of the mechanism as Python methods.
    fn functions(&self) -> Vec<Function> {
        Function::all(&self.robot)
    }

    /// Returns the equations of motion as text.
    #[getter]
    fn equations(&self) -> &str {
        self.robot.equations()
    }

    /// Returns the limits of each limited coordinate: the index of its velocity, then the lower, upper,
    /// velocity and effort limit.
    fn limits(&self, py: Python<'_>) -> PyResult<Vec<LimitValues>> {
        let limits = self.robot.limits().map_err(|error| python_exception_of_error(py, &error, None))?;
        let tuple_of_limit = |limit: linkwork_jit::Limit| {
            (limit.index, limit.lower, limit.upper, limit.velocity, limit.effort)
        };
        Ok(limits.into_iter().map(tuple_of_limit).collect())
    }

    /// Returns the number of parameter sets, if each state of a batch has its own values of the parameters.
    #[getter]
    fn parameter_set_count(&self) -> Option<usize> {
        self.sets.as_ref().map(|(count, _)| *count)
    }

    /// Returns the values of the parameters, one row for each set; NaN for parameters without a value.
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let own = self.robot.parameter_values();
        let (count, values) = match &self.sets {
            Some((count, values)) => (*count, values.as_slice()),
            None => (1, own),
        };
        PyArray1::from_slice(py, values).reshape([count, own.len()])
    }

    /// Returns the mechanism with new values of the parameters: one set, or one set for each state of a
    /// batch.
    fn with_parameters(
        &self,
        py: Python<'_>,
        sets: PyReadonlyArray2<'_, f64>,
        many: bool,
    ) -> PyResult<Robot> {
        let values = sets.as_slice()?;
        let count = sets.as_array().nrows();
        let mut robot = self.robot.clone();
        let width = robot.parameters().len();
        for state in 0..count {
            let set = robot.set_parameters(&values[state * width..(state + 1) * width]);
            set.and_then(|()| robot.validate())
                .map_err(|error| python_exception_of_error(py, &error, many.then_some(state)))?;
        }
        let sets = many.then(|| (count, values.to_vec()));
        Ok(Robot { robot, sets })
    }

    /// Returns the mechanism with values for an interpolation table: grid points of each axis, and function
    /// values with the last axis contiguous.
    fn with_table(
        &self,
        py: Python<'_>,
        name: &str,
        axes: Vec<Vec<f64>>,
        values: Vec<f64>,
        smooth: bool,
        extrapolated: bool,
    ) -> PyResult<Robot> {
        let mut robot = self.robot.clone();
        let table = AnyTable::from_grid(&axes, &values)
            .map_err(|error| python_error_from_message(py, format!("table {name:?}: {error}")))?;
        let table = if smooth { table.smooth() } else { table };
        let table = if extrapolated { table.extrapolated() } else { table };
        robot.set_table(name, table).map_err(|error| python_exception_of_error(py, &error, None))?;
        Ok(Robot { robot, sets: self.sets.clone() })
    }

    /// Advances states by steps of the classical Runge–Kutta method, or by time stepping at contacts. The
    /// arrays of configurations and velocities initially contain the initial states.
    #[pyo3(signature = (q, v, inputs, *, start, h, threads))]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn roll_out(
        &self,
        py: Python<'_>,
        mut q: PyReadwriteArray3<'_, f64>,
        mut v: PyReadwriteArray3<'_, f64>,
        inputs: Option<PyReadonlyArray3<'_, f64>>,
        start: f64,
        h: f64,
        threads: usize,
    ) -> PyResult<()> {
        let (nq, nv, nu) = (self.robot.nq(), self.robot.nv(), self.robot.nu());
        let (states, rows) = (q.as_array().shape()[0], q.as_array().shape()[1]);
        let own = inputs.as_ref().is_some_and(|inputs| inputs.as_array().shape()[0] > 1);
        let inputs = inputs.as_ref().map_or(Ok(&[][..]), |inputs| inputs.as_slice())?;
        let (mut q, mut v) = (q.as_slice_mut()?, v.as_slice_mut()?);
        // Steps between constraints and contacts are those of simulations.
        let is_free = self.robot.constraints() == 0 && self.robot.contacts() == 0;
        let stepper = is_free.then(|| Stepper::new(&self.robot)).transpose();
        let stepper = stepper.map_err(|error| python_exception_of_error(py, &error, None))?;
        let sets = self.sets.as_ref();
        let zeros = vec![0.0; nu];
        let simulate_states =
            |first: usize, _: usize, (q, v): (&mut [f64], &mut [f64])| -> FirstFailedState {
                let (mut stepper, mut robot) = (stepper.clone(), self.robot.clone());
                let mut failed = None;
                let states =
                    q.chunks_exact_mut((rows * nq).max(1)).zip(v.chunks_exact_mut((rows * nv).max(1)));
                for (k, (q, v)) in states.enumerate() {
                    let state = first + k;
                    let set =
                        set_parameters(stepper.as_mut().map_or(&mut robot, Stepper::robot_mut), sets, state);
                    let motion = set.and_then(|()| {
                        let Some(stepper) = &mut stepper else {
                            let row = if own { state * (rows - 1) } else { 0 };
                            let inputs = inputs.get(row * nu..(row + rows - 1) * nu).unwrap_or(&[]);
                            return robot.roll_out(start, h, inputs, [q, v]);
                        };
                        for step in 0..rows - 1 {
                            let row = if own { state * (rows - 1) + step } else { step };
                            let u = inputs.get(row * nu..(row + 1) * nu).unwrap_or(&zeros);
                            let (q, next_q) = q[step * nq..].split_at_mut(nq);
                            let (v, next_v) = v[step * nv..].split_at_mut(nv);
                            let end = [&mut next_q[..nq], &mut next_v[..nv]];
                            let done = stepper.step(start + step as f64 * h, [q, v, u], h, end);
                            if done.is_err() {
                                next_q.fill(f64::NAN);
                                next_v.fill(f64::NAN);
                                return done;
                            }
                        }
                        Ok(())
                    });
                    if let Err(error) = motion {
                        failed.get_or_insert((state, error));
                    }
                }
                failed
            };
        let failed = py.detach(|| {
            let split_leading_states = |count: usize| {
                let (own_q, rest_q) = std::mem::take(&mut q).split_at_mut(count * rows * nq);
                let (own_v, rest_v) = std::mem::take(&mut v).split_at_mut(count * rows * nv);
                (q, v) = (rest_q, rest_v);
                (own_q, own_v)
            };
            process_shares_in_parallel(states, threads, split_leading_states, simulate_states)
        });
        failed.map_or(Ok(()), |(state, error)| Err(python_exception_of_error(py, &error, Some(state))))
    }
}

/// Writes derivatives of a function of rollouts with respect to inputs and parameters. The arrays of
/// derivatives with respect to the states of the motions are overwritten: their first rows become the
/// derivatives with respect to the initial states.
#[pyfunction]
#[pyo3(signature = (robot, q, v, inputs, by_q, by_v, by_inputs, by_parameters, *, start, h, threads))]
#[allow(clippy::too_many_arguments, reason = "arguments of Python")]
pub fn roll_back(
    py: Python<'_>,
    robot: &Robot,
    q: PyReadonlyArray3<'_, f64>,
    v: PyReadonlyArray3<'_, f64>,
    inputs: PyReadonlyArray3<'_, f64>,
    mut by_q: PyReadwriteArray3<'_, f64>,
    mut by_v: PyReadwriteArray3<'_, f64>,
    mut by_inputs: PyReadwriteArray3<'_, f64>,
    mut by_parameters: PyReadwriteArray2<'_, f64>,
    start: f64,
    h: f64,
    threads: usize,
) -> PyResult<()> {
    let jit = &robot.robot;
    let (nq, nv, nu, np) = (jit.nq(), jit.nv(), jit.nu(), jit.parameters().len());
    let (states, rows) = (q.as_array().shape()[0], q.as_array().shape()[1]);
    let steps = rows - 1;
    let (q, v, inputs) = (q.as_slice()?, v.as_slice()?, inputs.as_slice()?);
    let mut rest = (
        by_q.as_slice_mut()?,
        by_v.as_slice_mut()?,
        by_inputs.as_slice_mut()?,
        by_parameters.as_slice_mut()?,
    );
    type GradientShare<'a> = (&'a mut [f64], &'a mut [f64], &'a mut [f64], &'a mut [f64]);
    let pull_back_states = |first: usize,
                            count: usize,
                            (by_q, by_v, by_u, by_p): GradientShare<'_>|
     -> FirstFailedState {
        let mut stepper = match AdjointStepper::new(jit) {
            Ok(stepper) => stepper,
            Err(error) => return Some((first, error)),
        };
        for k in 0..count {
            let state = first + k;
            let own_q = &mut by_q[k * rows * nq..(k + 1) * rows * nq];
            let own_v = &mut by_v[k * rows * nv..(k + 1) * rows * nv];
            let own_p = &mut by_p[k * np..(k + 1) * np];
            let mut done = set_parameters(stepper.robot_mut(), robot.sets.as_ref(), state);
            let (mut at_q, mut at_v) = (own_q[steps * nq..].to_vec(), own_v[steps * nv..].to_vec());
            for step in (0..steps).rev() {
                let row = state * rows + step;
                let u = (k * steps + step) * nu;
                let at = (state * steps + step) * nu;
                let start_of_step =
                    [&q[row * nq..(row + 1) * nq], &v[row * nv..(row + 1) * nv], &inputs[at..at + nu]];
                let mut derivatives =
                    Sensitivity { q: &mut at_q, v: &mut at_v, u: &mut by_u[u..u + nu], parameters: own_p };
                done = done.and_then(|()| {
                    let t = start + step as f64 * h;
                    stepper.step(t, start_of_step, h, &mut derivatives).map(|_| ())
                });
                let add_entries =
                    |to: &mut [f64], more: &[f64]| to.iter_mut().zip(more).for_each(|(a, b)| *a += b);
                add_entries(&mut at_q, &own_q[step * nq..(step + 1) * nq]);
                add_entries(&mut at_v, &own_v[step * nv..(step + 1) * nv]);
            }
            own_q[..nq].copy_from_slice(&at_q);
            own_v[..nv].copy_from_slice(&at_v);
            if let Err(error) = done {
                return Some((state, error));
            }
        }
        None
    };
    let failed = py.detach(|| {
        let split_leading_states = |count: usize| {
            let (q, other_q) = std::mem::take(&mut rest.0).split_at_mut(count * rows * nq);
            let (v, other_v) = std::mem::take(&mut rest.1).split_at_mut(count * rows * nv);
            let (u, other_u) = std::mem::take(&mut rest.2).split_at_mut(count * steps * nu);
            let (p, other_p) = std::mem::take(&mut rest.3).split_at_mut(count * np);
            rest = (other_q, other_v, other_u, other_p);
            (q, v, u, p)
        };
        process_shares_in_parallel(states, threads, split_leading_states, pull_back_states)
    });
    failed.map_or(Ok(()), |(state, error)| Err(python_exception_of_error(py, &error, Some(state))))
}

/// Sets the parameters of the mechanism to those of one state of a batch, if each state has its own.
pub fn set_parameters(
    robot: &mut linkwork_jit::Robot,
    sets: Option<&(usize, Vec<f64>)>,
    state: usize,
) -> Result<(), Error> {
    let Some((count, values)) = sets else { return Ok(()) };
    let width = values.len() / (*count).max(1);
    let first = if *count == 1 { 0 } else { state * width };
    robot.set_parameters(&values[first..first + width])
}
