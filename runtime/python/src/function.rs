//! Functions of mechanisms as methods of Python classes.

use crate::arrays;
use crate::error::python_exception_of_error;
use crate::robot::{Robot, set_parameters};
use crate::shared::{FirstFailedState, process_shares_in_parallel};
use numpy::{PyArray1, PyReadonlyArrayDyn, PyReadwriteArrayDyn, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyString, PyTuple, PyType};
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

mod adjoint;
mod evaluator;
mod signatures;

use evaluator::placement;

/// Maximum number of arguments of a function.
const ARGUMENTS: usize = 12;

/// Argument of a mechanism's function, as Python sees it.
#[derive(Clone)]
struct Argument {
    name: String,
    /// Number of entries of a vector; `None` for a number.
    length: Option<usize>,
}

impl Argument {
    fn length(&self) -> usize {
        self.length.unwrap_or(1)
    }
}

/// Result of a mechanism's function, as Python sees it.
#[derive(Clone)]
struct Output {
    name: String,
    /// Length of each dimension of the result array.
    shape: Vec<usize>,
}

impl Output {
    fn length(&self) -> usize {
        self.shape.iter().product()
    }
}

/// Method by which the results of a function are computed.
#[derive(Clone)]
enum EvaluationMethod {
    Generated(linkwork_jit::Function),
    /// Function of a frame: one compiled function for each frame.
    Frames(Vec<linkwork_jit::Function>),
    /// Placement of a frame as a 4 × 4 matrix: one compiled function for each frame.
    Placements(Vec<linkwork_jit::Function>),
    Step,
    Transition,
    IntegrateDerivatives,
    TangentRateDerivatives,
    Constraint(ConstraintSolverFunction),
}

/// Function that finds a configuration or velocity which satisfies the constraints.
#[derive(Clone, Copy)]
pub enum ConstraintSolverFunction {
    Assemble,
    ProjectConfiguration,
    ProjectVelocity,
    CompleteVelocity,
}

/// Name, documentation, arguments, results and computation of a function, which its objects share.
struct FunctionDefinition {
    name: String,
    documentation: String,
    arguments: Vec<Argument>,
    results: Vec<Output>,
    /// Index of each frame by its name; empty if the function takes no frame.
    frames: HashMap<String, usize>,
    kind: EvaluationMethod,
}

/// Function of a mechanism, which is a method of the mechanism's Python class.
#[pyclass(frozen, dict, module = "linkwork._native")]
pub struct Function {
    signature: Arc<FunctionDefinition>,
}

// A function of a mechanism with values of its parameters. Its documentation is that of the function.
#[pyclass(frozen, module = "linkwork._native")]
pub struct BoundFunction {
    signature: Arc<FunctionDefinition>,
    function: Py<Function>,
    robot: Py<Robot>,
    class: Py<PyType>,
}

thread_local! {
    /// Results of the last call of the thread.
    static RESULTS: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

impl BoundFunction {
    /// Evaluates the function for one state if all arrays can be used without conversion; returns `None`
    /// otherwise.
    fn evaluate_single_state<'py>(
        &self,
        py: Python<'py>,
        given: &Bound<'py, PyTuple>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let signature = &*self.signature;
        let robot = &self.robot.get();
        let takes_frame = usize::from(!signature.frames.is_empty());
        let count = signature.arguments.len();
        if robot.sets.is_some() || given.len() != count + takes_frame || count > ARGUMENTS {
            return Ok(None);
        }
        let mut frame = 0;
        if takes_frame == 1 {
            let name = given.get_borrowed_item(0)?;
            let Ok(name) = name.cast::<PyString>() else { return Ok(None) };
            match signature.frames.get(name.to_str()?) {
                Some(index) => frame = *index,
                None => return Ok(None),
            }
        }
        let mut arrays: [Option<Bound<'py, PyArray1<f64>>>; ARGUMENTS] = [const { None }; ARGUMENTS];
        let mut numbers = [[0.0]; ARGUMENTS];
        for (k, argument) in signature.arguments.iter().enumerate() {
            let value = given.get_borrowed_item(takes_frame + k)?;
            match argument.length {
                None => match value.cast::<PyFloat>() {
                    Ok(number) => numbers[k][0] = number.value(),
                    Err(_) => return Ok(None),
                },
                Some(length) => match value.cast_exact::<PyArray1<f64>>() {
                    Ok(array) if array.len() == length && array.is_c_contiguous() => {
                        arrays[k] = Some(array.to_owned());
                    }
                    _ => return Ok(None),
                },
            }
        }
        let mut slices: [&[f64]; ARGUMENTS] = [&[]; ARGUMENTS];
        for ((slice, array), number) in slices.iter_mut().zip(&arrays).zip(&numbers).take(count) {
            *slice = match array {
                Some(array) => arrays::entries(array)?,
                None => number,
            };
        }
        let slices = &slices[..count];
        let length = signature.length();
        RESULTS.with_borrow_mut(|results| {
            if results.len() < length {
                results.resize(length, 0.0);
            }
            let results = &mut results[..length];
            let done = match &signature.kind {
                EvaluationMethod::Generated(f) => robot.robot.evaluate_into(f, slices, results),
                EvaluationMethod::Frames(all) => robot.robot.evaluate_into(&all[frame], slices, results),
                EvaluationMethod::Placements(all) => placement(&robot.robot, &all[frame], slices, results),
                _ => signature.evaluator(&robot.robot, frame).and_then(|mut e| e.evaluate(slices, results)),
            };
            done.map_err(|error| python_exception_of_error(py, &error, None))?;
            let mut first = 0;
            let mut next = |output: &Output| {
                let own = &results[first..first + output.length()];
                first += output.length();
                python_object_of_values(py, &output.shape, own)
            };
            match signature.results.as_slice() {
                [one] => Ok(Some(next(one))),
                all => Ok(Some(PyTuple::new(py, all.iter().map(next))?.into_any())),
            }
        })
    }
}

/// Returns a number, vector or matrix as an object of Python.
fn python_object_of_values<'py>(py: Python<'py>, shape: &[usize], values: &[f64]) -> Bound<'py, PyAny> {
    match *shape {
        [] => PyFloat::new(py, values[0]).into_any(),
        [_] => PyArray1::from_slice(py, values).into_any(),
        [rows, columns, ..] => arrays::matrix(py, rows, columns, values).into_any(),
    }
}

#[pymethods]
impl Function {
    /// Returns the name and the documentation of the function.
    #[getter]
    fn name_and_documentation(&self) -> (&str, &str) {
        (&self.signature.name, &self.signature.documentation)
    }

    /// Returns the name and shape of each argument of the function. An argument that names a frame has `None`
    /// instead of a shape.
    #[getter]
    fn arguments(&self) -> Vec<(&str, Option<Vec<usize>>)> {
        let frame = (!self.signature.frames.is_empty()).then_some(("frame", None));
        let others = self.signature.arguments.iter();
        let others = others.map(|a| (a.name.as_str(), Some(a.length.into_iter().collect())));
        frame.into_iter().chain(others).collect()
    }

    /// Returns name and shape of each result of the function.
    #[getter]
    fn results(&self) -> Vec<(&str, &[usize])> {
        self.signature.results.iter().map(|result| (result.name.as_str(), &*result.shape)).collect()
    }

    /// Binds the function to a mechanism when Python reads it as an attribute; the mechanism then stores the
    /// bound function.
    fn __get__<'py>(
        slf: &Bound<'py, Self>,
        instance: &Bound<'py, PyAny>,
        _owner: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        if instance.is_none() {
            return Ok(slf.clone().into_any());
        }
        let robot = instance.getattr(intern!(py, "_robot"))?.cast_into::<Robot>()?.unbind();
        let signature = slf.get().signature.clone();
        let (function, class) = (slf.clone().unbind(), instance.get_type().unbind());
        let name = PyString::new(py, &signature.name);
        let bound = Bound::new(py, BoundFunction { signature, function, robot, class })?.into_any();
        instance.setattr(name, &bound)?;
        Ok(bound)
    }

    #[pyo3(signature = (*_given, **_named))]
    fn __call__(&self, _given: &Bound<'_, PyTuple>, _named: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        Err(pyo3::exceptions::PyTypeError::new_err(format!(
            "{} is a function of a mechanism, not of its class: make one first, with values of its \
             parameters",
            self.signature.name
        )))
    }

    /// Writes derivatives of a weighted sum of the results, with a factor for each: with respect to the
    /// arguments of each state, then with respect to the parameters. Factors of matrices are stored by
    /// columns.
    #[pyo3(signature = (robot, frame, arguments, factors, out, states, threads))]
    #[allow(clippy::too_many_arguments, reason = "arguments of Python")]
    fn pull_back(
        &self,
        py: Python<'_>,
        robot: &Robot,
        frame: usize,
        arguments: Vec<PyReadonlyArrayDyn<'_, f64>>,
        factors: PyReadonlyArrayDyn<'_, f64>,
        mut out: PyReadwriteArrayDyn<'_, f64>,
        states: usize,
        threads: usize,
    ) -> PyResult<()> {
        let signature = &*self.signature;
        let lists = arguments.iter().map(|array| array.as_slice()).collect::<Result<Vec<_>, _>>()?;
        let (factors, mut rest) = (factors.as_slice()?, out.as_slice_mut()?);
        let width = rest.len() / states.max(1);
        let failed = py.detach(|| {
            let split_leading_states = |count: usize| {
                let (own, others) = std::mem::take(&mut rest).split_at_mut(count * width);
                rest = others;
                own
            };
            process_shares_in_parallel(states, threads, split_leading_states, |first, count, own| {
                signature.differentiate(robot, frame, &lists, first..first + count, factors, own)
            })
        });
        failed.map_or(Ok(()), |(state, error)| {
            Err(python_exception_of_error(py, &error, (states > 1).then_some(state)))
        })
    }

    /// Evaluates the function for many states. Arguments and results are contiguous arrays. An argument with
    /// the entries of one state is common to all states. Matrices are stored by columns.
    #[pyo3(signature = (robot, frame, arguments, results, states, threads))]
    #[expect(clippy::too_many_arguments, reason = "they are the arguments of a function for Python")]
    fn evaluate(
        &self,
        py: Python<'_>,
        robot: &Robot,
        frame: usize,
        arguments: Vec<PyReadonlyArrayDyn<'_, f64>>,
        mut results: Vec<PyReadwriteArrayDyn<'_, f64>>,
        states: usize,
        threads: usize,
    ) -> PyResult<()> {
        let signature = &*self.signature;
        let lists = arguments.iter().map(|array| array.as_slice()).collect::<Result<Vec<_>, _>>()?;
        let mut outs = results.iter_mut().map(|array| array.as_slice_mut()).collect::<Result<Vec<_>, _>>()?;
        let lengths: Vec<usize> = signature.results.iter().map(Output::length).collect();
        let evaluate_states = |first: usize, count: usize, mut outs: Vec<&mut [f64]>| -> FirstFailedState {
            signature.evaluate_state_range(robot, frame, &lists, first..first + count, &mut outs, &lengths)
        };
        let failed = py.detach(|| {
            let split_leading_states = |count: usize| {
                let each = outs.iter_mut().zip(&lengths);
                each.map(|(out, length)| {
                    let (own, rest) = std::mem::take(out).split_at_mut(count * length);
                    *out = rest;
                    own
                })
                .collect::<Vec<_>>()
            };
            process_shares_in_parallel(states, threads, split_leading_states, evaluate_states)
        });
        failed.map_or(Ok(()), |(state, error)| {
            Err(python_exception_of_error(py, &error, (states > 1).then_some(state)))
        })
    }
}

impl FunctionDefinition {
    /// Evaluates the function for a range of consecutive states.
    fn evaluate_state_range(
        &self,
        robot: &Robot,
        frame: usize,
        lists: &[&[f64]],
        states: Range<usize>,
        outs: &mut [&mut [f64]],
        lengths: &[usize],
    ) -> FirstFailedState {
        let mut evaluator = match self.evaluator(&robot.robot, frame) {
            Ok(evaluator) => evaluator,
            Err(error) => return Some((states.start, error)),
        };
        let total: usize = lengths.iter().sum();
        let mut values = vec![0.0; total];
        let mut failed: FirstFailedState = None;
        let mut slices: [&[f64]; ARGUMENTS] = [&[]; ARGUMENTS];
        let count = self.arguments.len();
        for (k, state) in states.enumerate() {
            for ((slice, list), argument) in slices.iter_mut().zip(lists).zip(&self.arguments) {
                let length = argument.length();
                let at = if list.len() == length { 0 } else { state * length };
                *slice = &list[at..at + length];
            }
            let set = set_parameters(evaluator.robot_mut(), robot.sets.as_ref(), state);
            let done = match &mut *outs {
                [out] => {
                    let own = &mut out[k * total..(k + 1) * total];
                    set.and_then(|()| evaluator.evaluate(&slices[..count], own))
                }
                outs => {
                    let done = set.and_then(|()| evaluator.evaluate(&slices[..count], &mut values));
                    let mut rest = &values[..];
                    for (out, length) in outs.iter_mut().zip(lengths) {
                        let (own, others) = rest.split_at(*length);
                        out[k * length..(k + 1) * length].copy_from_slice(own);
                        rest = others;
                    }
                    done
                }
            };
            if let Err(error) = done {
                outs.iter_mut().zip(lengths).for_each(|(out, n)| out[k * n..(k + 1) * n].fill(f64::NAN));
                failed.get_or_insert((state, error));
            }
        }
        failed
    }
}

#[pymethods]
impl BoundFunction {
    #[getter]
    fn __self__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.class.bind(py).call_method1(intern!(py, "_of"), (&self.robot,))
    }

    #[getter]
    fn __func__(&self, py: Python<'_>) -> Py<Function> {
        self.function.clone_ref(py)
    }

    #[getter]
    fn __doc__(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.function.getattr(py, intern!(py, "__doc__"))
    }

    /// Returns attributes that a bound function does not define from the unbound function.
    fn __getattr__(&self, py: Python<'_>, name: &Bound<'_, PyString>) -> PyResult<Py<PyAny>> {
        self.function.getattr(py, name)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<function {} of {}>", self.signature.name, self.__self__(py)?.repr()?))
    }

    #[pyo3(signature = (*given, **named))]
    fn __call__<'py>(
        &self,
        py: Python<'py>,
        given: &Bound<'py, PyTuple>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if named.is_none()
            && let Some(found) = self.evaluate_single_state(py, given)?
        {
            return Ok(found);
        }
        // The package converts arguments, and calls `evaluate`.
        let general = py.import(intern!(py, "linkwork._functions"))?.getattr(intern!(py, "call"))?;
        general.call1((&self.function, self.__self__(py)?, given, named))
    }
}
