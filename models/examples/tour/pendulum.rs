//! Pendulum over a thousand seconds: errors of energy and phase with three integrators.

use crate::report::{
    Picture, Section, Table, UpperBoundCheck, declaration_of_mechanism, format_number, pairs_of_curve,
};
use linkwork::integrate::Method;
use linkwork::prelude::*;
use linkwork_design::picture::Chart;
use linkwork_models::Pendulum;
use std::time::Instant;

const PENDULUM: Pendulum<f64> = Pendulum { g: 9.81, mass: 1.0, length: 1.0 };
const START: f64 = 2.5;
const DURATION: f64 = 1000.0;
/// Interval of samples, s, and width of the windows, s, in which the largest error is shown; a window is
/// longer than an oscillation.
const INTERVAL: f64 = 0.05;
const WINDOW: f64 = 5.0;

/// Errors and computing time of one integrator.
struct PendulumIntegratorRun {
    /// End time, s, of each time window, and the largest error of the energy in the window, relative to m g
    /// l.
    energy: Vec<[f64; 2]>,
    /// End time, s, of each time window, and the largest error of the angle in the window, rad.
    angle: Vec<[f64; 2]>,
    /// Computing time of the run, ms.
    cost: f64,
}

pub fn run_pendulum_tour() -> Result<Section, Box<dyn std::error::Error>> {
    let methods = [
        ("Runge–Kutta 4", "10 ms", simulate_swing(Rk4::step(0.01))?),
        ("implicit midpoint", "10 ms", simulate_swing(ImplicitMidpoint::step(0.01))?),
        ("Dormand–Prince", "adaptive", simulate_swing(DormandPrince::new())?),
    ];
    let table_row_of_method = |(name, step, run): &(&str, &str, PendulumIntegratorRun)| {
        vec![
            name.to_string(),
            step.to_string(),
            format_number(worst_error(&run.energy)),
            format_number(worst_error(&run.angle)),
            format!("{:.1} ms", run.cost),
        ]
    };
    let table = Table {
        head: vec!["integrator", "step", "energy error / mgl", "angle error, rad", "computing time"],
        rows: methods.iter().map(table_row_of_method).collect(),
    };
    let [rk4, midpoint, adaptive] = &methods;
    let growth = {
        let (early, late) = midpoint.2.energy.split_at(midpoint.2.energy.len() / 2);
        (worst_error(late) / worst_error(early) - 1.0).abs()
    };
    let checks = vec![
        UpperBoundCheck::new("Runge–Kutta: energy error after 1000 s", worst_error(&rk4.2.energy), 1e-5),
        UpperBoundCheck::new("implicit midpoint: energy error, second half over first", growth, 1e-2),
        UpperBoundCheck::new(
            "Dormand–Prince: energy error after 1000 s",
            worst_error(&adaptive.2.energy),
            1e-5,
        ),
        UpperBoundCheck::new(
            "Dormand–Prince: angle against Jacobi's elliptic function, rad",
            worst_error(&adaptive.2.angle),
            1e-2,
        ),
    ];
    let energy = Picture::over_time("Energy error of the pendulum", "|E − E₀| / mgl", |chart| {
        let add_energy_curve = |chart: Chart, (name, _, run): &(&str, &str, PendulumIntegratorRun)| {
            chart.curve(*name, pairs_of_curve(&run.energy))
        };
        methods.iter().fold(chart.logarithmic(), add_energy_curve)
    })?;
    let phase = Picture::over_time("Angle against the exact solution", "|θ − θ exact|, rad", |chart| {
        let add_angle_curve = |chart: Chart, (name, _, run): &(&str, &str, PendulumIntegratorRun)| {
            chart.curve(*name, pairs_of_curve(&run.angle))
        };
        methods.iter().fold(chart.logarithmic(), add_angle_curve)
    })?;
    Ok(Section {
        title: format!("A pendulum swings for {DURATION} s"),
        text: format!(
            "Released at rest {:.0}° from the vertical, without friction. Its exact motion is an elliptic \
             function, so \
             that both energy and angle can be held against the truth.",
            START.to_degrees()
        ),
        declaration: declaration_of_mechanism(include_str!("../../src/pendulum.rs"), "Pendulum"),
        equations: Pendulum::<f64>::EQUATIONS,
        tables: vec![table],
        checks,
        scenes: Vec::new(),
        pictures: vec![energy, phase],
    })
}

fn simulate_swing(method: impl Method<f64>) -> Result<PendulumIntegratorRun, Error> {
    let total_energy = |q: &SVector<f64, 1>, v: &SVector<f64, 1>| {
        PENDULUM.kinetic_energy(q, v) + PENDULUM.potential_energy(q)
    };
    let scale = PENDULUM.mass * PENDULUM.g * PENDULUM.length;
    let e0 = total_energy(&[START].into(), &[0.0].into());
    let start = Instant::now();
    let mut samples = Vec::new();
    for sample in
        simulate(&PENDULUM).from([START], [0.0]).method(method).duration(DURATION).sample_every(INTERVAL)
    {
        samples.push(sample?);
    }
    let cost = start.elapsed().as_secs_f64() * 1e3;

    let worst_errors_in_windows = |error: &dyn Fn(&Sample<f64, 1, 1, 0>) -> f64| {
        let worst_error_in_window = |samples: &[Sample<f64, 1, 1, 0>]| {
            let worst = samples.iter().map(error).fold(0.0, f64::max);
            [samples.last().map_or(0.0, |s| s.t), worst]
        };
        samples[1..]
            .chunks((WINDOW / INTERVAL).round() as usize)
            .map(worst_error_in_window)
            .collect::<Vec<_>>()
    };
    Ok(PendulumIntegratorRun {
        energy: worst_errors_in_windows(&|s| (total_energy(&s.q, &s.v) - e0).abs() / scale),
        angle: worst_errors_in_windows(&|s| (s.q[0] - exact_pendulum_angle(s.t)).abs()),
        cost,
    })
}

fn worst_error(errors: &[[f64; 2]]) -> f64 {
    errors.iter().map(|e| e[1]).fold(0.0, f64::max)
}

/// Returns the exact angle of the pendulum: `sin ½θ = k cd(ω t)` with `k = sin ½θ₀` and `ω² = g/l`. Jacobi's
/// functions follow by the descending Landen transformation (Abramowitz and Stegun, 16.4).
fn exact_pendulum_angle(t: f64) -> f64 {
    let k = (START / 2.0).sin();
    let (mut a, mut b) = (1.0, (START / 2.0).cos());
    let mut ratios = Vec::new();
    while a - b > 1e-16 * a {
        let next: (f64, f64) = ((a + b) / 2.0, f64::sqrt(a * b));
        ratios.push((a - b) / 2.0 / next.0);
        (a, b) = next;
        if ratios.len() > 8 {
            break;
        }
    }
    let mut phi = 2.0_f64.powi(ratios.len() as i32) * a * (PENDULUM.g / PENDULUM.length).sqrt() * t;
    for ratio in ratios.iter().rev() {
        phi = (phi + (ratio * phi.sin()).asin()) / 2.0;
    }
    let (sn, cn) = phi.sin_cos();
    2.0 * (k * cn / (1.0 - k * k * sn * sn).sqrt()).asin()
}
