//! Simulations, and states that satisfy the constraints, as functions of C.

use crate::{Failure, LwRobot, raw, run_guarded, value_or_fallback};
use linkwork_jit::{Error, Inputs, Method, Overlaps, Robot};
use std::ffi::{c_char, c_int, c_void};

/// Settings of a simulation, as the header has them.
#[repr(C)]
pub struct LwSimulation {
    start: f64,
    duration: f64,
    every: f64,
    method: *const c_char,
    setting: f64,
    control: Option<raw::Control>,
    user: *mut c_void,
    period: f64,
    without_contacts: c_int,
    overlaps: c_int,
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_sample(robot: *const LwRobot) -> usize {
    // SAFETY: a robot of this library, as the header says.
    value_or_fallback(0, || Ok(values_per_sample(&unsafe { raw::shared(robot) }?.robot)))
}

fn values_per_sample(robot: &Robot) -> usize {
    1 + robot.nq() + robot.nv() + robot.states() + robot.nu()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_simulate(
    robot: *const LwRobot,
    q: *const f64,
    v: *const f64,
    settings: *const LwSimulation,
    samples: *mut f64,
    rows: usize,
    count: *mut usize,
) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library, and variables of the caller, as the header says.
        let (robot, settings, count) = unsafe {
            (&raw::shared(robot)?.robot, raw::shared(settings)?, raw::mutable_reference_from_pointer(count)?)
        };
        let width = values_per_sample(robot);
        *count = 0;
        // SAFETY: arrays of these lengths, as the header says.
        let (q, v, samples) = unsafe {
            (
                raw::array(q, robot.nq())?,
                raw::array(v, robot.nv())?,
                raw::array_mut(samples, rows.checked_mul(width).ok_or(Failure::Index(rows))?)?,
            )
        };
        // SAFETY: a text of the caller, as the header says.
        let name = match settings.method.is_null() {
            true => "automatic",
            false => unsafe { raw::text(settings.method) }?,
        };
        let nonzero_setting = |x: f64| (x != 0.0).then_some(x);
        let method = Method::from_name(name, nonzero_setting(settings.setting))?;
        let control = settings.control.map(|control| raw::Controller { control, user: settings.user });
        let mut call_controller_if_given = |t: f64, q: &[f64], v: &[f64], u: &mut [f64]| match &control {
            Some(control) => control.call(t, q, v, u),
            None => Ok(()),
        };
        let inputs = match (&control, nonzero_setting(settings.period)) {
            (None, _) => Inputs::Zero,
            (Some(_), None) => Inputs::Function(&mut call_controller_if_given),
            (Some(_), Some(period)) => Inputs::Sampled(period, &mut call_controller_if_given),
        };
        let run = robot.simulate().start_at(settings.start).from(q, v).inputs(inputs).method(method);
        let run = run.duration(settings.duration);
        let run = match nonzero_setting(settings.every) {
            Some(every) => run.sample_every(every),
            None => run,
        };
        let run = if settings.without_contacts != 0 { run.without_contacts() } else { run };
        let run = run.overlaps(match settings.overlaps {
            0 => Overlaps::Refuse,
            1 => Overlaps::Part,
            2 => Overlaps::Keep,
            other => return Err(Error::Value(format!("`overlaps` is 0, 1 or 2, not {other}")).into()),
        });
        let mut places = samples.chunks_exact_mut(width);
        let ended = run.each(&mut |sample| {
            *count += 1;
            let Some(place) = places.next() else { return };
            let all = std::iter::once(&sample.t).chain(&sample.q).chain(&sample.v).chain(&sample.u);
            place.iter_mut().zip(all).for_each(|(to, from)| *to = *from);
        });
        ended?;
        match *count <= rows {
            true => Ok(()),
            false => {
                let (of, name) = ("lw_simulate".to_string(), "samples".to_string());
                Err(Error::Length { of, name, expected: *count * width, found: rows * width }.into())
            }
        }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_assemble(
    robot: *const LwRobot,
    q: *const f64,
    held: *const usize,
    count: usize,
    result: *mut f64,
) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library, as the header says.
        let robot = &unsafe { raw::shared(robot) }?.robot;
        // SAFETY: arrays of these lengths, as the header says.
        let (q, held, to) = unsafe {
            (raw::array(q, robot.nq())?, raw::array(held, count)?, raw::array_mut(result, robot.nq())?)
        };
        to.copy_from_slice(robot.assemble(q, held)?.as_slice());
        Ok(())
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_complete_velocity(
    robot: *const LwRobot,
    q: *const f64,
    v: *const f64,
    held: *const usize,
    count: usize,
    result: *mut f64,
) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library, as the header says.
        let robot = &unsafe { raw::shared(robot) }?.robot;
        // SAFETY: arrays of these lengths, as the header says.
        let (q, v, held, to) = unsafe {
            (
                raw::array(q, robot.nq())?,
                raw::array(v, robot.nv())?,
                raw::array(held, count)?,
                raw::array_mut(result, robot.nv())?,
            )
        };
        to.copy_from_slice(robot.complete_velocity(q, v, held)?.as_slice());
        Ok(())
    })
}
