//! Simulations of mechanisms for Python.

use crate::error::python_exception_of_error;
use crate::robot::Robot;
use linkwork::simulate::Overlaps;
use linkwork_jit::{Inputs, Method, Sample};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use std::sync::Mutex;

/// Simulates a motion for Python. Returns the samples, the reason why they end, and an exception of the
/// controller. A row of samples is time, configuration, velocity, first-order states, and inputs.
#[pyfunction]
#[pyo3(signature = (robot, q, v, *, start, duration, every, method, setting, period, inputs, control))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
#[allow(clippy::type_complexity, reason = "a tuple of Python")]
pub fn simulate<'py>(
    py: Python<'py>,
    robot: &Robot,
    q: Vec<f64>,
    v: Vec<f64>,
    start: f64,
    duration: f64,
    every: f64,
    method: &str,
    setting: f64,
    period: Option<f64>,
    inputs: Vec<f64>,
    control: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Option<String>, Option<PyErr>)> {
    let robot = &robot.robot;
    let method = Method::from_name(method, Some(setting))
        .map_err(|error| python_exception_of_error(py, &error, None))?;
    let overlaps = match method {
        Method::TimeStepping(_) | Method::TimeSteppingMidpoint(_) | Method::TimeSteppingLeapfrog(_) => {
            Overlaps::Keep
        }
        _ => Overlaps::Refuse,
    };
    let mut rows: Vec<f64> = Vec::new();
    let raised = Mutex::new(None);
    let store_raised_error = |error: PyErr| {
        let mut raised = raised.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        raised.get_or_insert(error);
        Err("an exception".to_string())
    };
    let mut calls = 0_u64;
    let mut controller = |t: f64, q: &[f64], v: &[f64], u: &mut [f64]| -> Result<(), String> {
        let Some(control) = &control else {
            u.copy_from_slice(&inputs);
            // An interrupt of the user ends the run.
            calls += 1;
            if calls.is_multiple_of(1024) {
                return Python::attach(|py| py.check_signals()).or_else(store_raised_error);
            }
            return Ok(());
        };
        let found: PyResult<Vec<f64>> = Python::attach(|py| {
            py.check_signals()?;
            let (q, v) = (PyArray1::from_slice(py, q), PyArray1::from_slice(py, &v[..robot.nv()]));
            control.call1(py, (t, q, v))?.extract(py)
        });
        match found {
            Ok(found) => {
                u.iter_mut().zip(found).for_each(|(to, from)| *to = from);
                Ok(())
            }
            Err(error) => store_raised_error(error),
        }
    };
    let mut collect = |sample: Sample| {
        rows.push(sample.t);
        rows.extend(sample.q.iter().chain(&sample.v).chain(&sample.u));
    };
    let ended = py.detach(|| {
        let inputs = match period {
            Some(period) => Inputs::Sampled(period, &mut controller),
            None => Inputs::Function(&mut controller),
        };
        let run = robot.simulate().from(&q, &v).start_at(start).duration(duration).sample_every(every);
        run.method(method).overlaps(overlaps).inputs(inputs).each(&mut collect)
    });
    let raised = raised.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    let reason = ended.err().map(|error| error.to_string());
    let width = 1 + robot.nq() + robot.nv() + robot.states() + robot.nu();
    let count = rows.len() / width;
    let samples = PyArray1::from_vec(py, rows).reshape([count, width])?;
    Ok((samples, reason, raised))
}
