//! Ordinary differential equations of any size, by the pair of Dormand and Prince, *A family of embedded Runge–Kutta formulae*
//! (1980), with steps as large as a tolerance lets them be.

/// Stages: when, and the weights of those before.
const STAGES: [(f64, &[f64]); 6] = [
    (1.0 / 5.0, &[1.0 / 5.0]),
    (3.0 / 10.0, &[3.0 / 40.0, 9.0 / 40.0]),
    (4.0 / 5.0, &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0]),
    (8.0 / 9.0, &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0]),
    (1.0, &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0]),
    (1.0, &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0]),
];
/// Weights of the difference between the fifth and the fourth order.
const DIFFERENCE: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];
/// Steps from one sample to the next, before it is given up.
const MAX_STEPS: usize = 1_000_000;

/// A system: the rates of its state, and what is done to a state at the end of a step, which tells whether there is one.
pub struct System<'a> {
    /// Of time and state.
    pub rates: &'a dyn Fn(f64, &[f64]) -> Vec<f64>,
    /// Of time, and the state that it changes.
    pub settle: &'a dyn Fn(f64, &mut Vec<f64>) -> bool,
}

/// Goes from one time to another; `step` is the size of a step, which is kept for the next call. Tells when it cannot go on.
pub fn advance(
    system: &System<'_>,
    (from, to): (f64, f64),
    y: &mut Vec<f64>,
    step: &mut f64,
    tolerance: f64,
) -> Result<(), f64> {
    let mut t = from;
    for _ in 0..MAX_STEPS {
        if t >= to {
            return Ok(());
        }
        let left = to - t;
        let h = if *step >= left * (1.0 - 1e-12) { left } else { *step };
        if h <= 1e-14 * t.abs().max(1e-3) {
            return Err(t);
        }
        let (mut next, error) = attempt(system.rates, t, y, h, tolerance);
        let good = error <= 1.0 && next.iter().all(|x| x.is_finite()) && (system.settle)(t + h, &mut next);
        let factor = if error.is_finite() { 0.9 * error.max(1e-10).powf(-0.2) } else { 0.1 };
        if good {
            t = if h == left { to } else { t + h };
            *y = next;
            // One that ends at a sample says nothing of the largest.
            let grown = h * factor.clamp(0.2, 5.0);
            *step = if h < left { grown } else { step.max(grown) };
        } else {
            *step = h * factor.clamp(0.1, 0.5);
        }
    }
    Err(t)
}

/// A step, and its error in parts of the tolerance.
fn attempt(
    rates: &dyn Fn(f64, &[f64]) -> Vec<f64>,
    t: f64,
    y: &[f64],
    h: f64,
    tolerance: f64,
) -> (Vec<f64>, f64) {
    let mut slopes = vec![rates(t, y)];
    let mut at = y.to_vec();
    for (when, weights) in STAGES {
        for (k, x) in at.iter_mut().enumerate() {
            *x = y[k] + h * weights.iter().zip(&slopes).map(|(w, slope)| w * slope[k]).sum::<f64>();
        }
        slopes.push(rates(t + when * h, &at));
    }
    let error = |k: usize| {
        let off = h * DIFFERENCE.iter().zip(&slopes).map(|(w, slope)| w * slope[k]).sum::<f64>();
        off.abs() / (tolerance * (1.0 + y[k].abs().max(at[k].abs())))
    };
    let largest =
        (0..y.len()).map(error).fold(0.0, |most: f64, x| if x > most || x.is_nan() { x } else { most });
    (at, largest)
}

#[cfg(test)]
mod tests {
    use super::{System, advance};

    /// `y'' = −y` has circles.
    #[test]
    fn a_circle_closes() {
        let rates = |_: f64, y: &[f64]| vec![y[1], -y[0]];
        let system = System { rates: &rates, settle: &|_, _| true };
        let (mut y, mut step) = (vec![1.0, 0.0], 0.1);
        let turn = 2.0 * std::f64::consts::PI;
        for k in 0..100 {
            let from = turn * f64::from(k) / 100.0;
            assert!(advance(&system, (from, from + turn / 100.0), &mut y, &mut step, 1e-10).is_ok());
        }
        assert!((y[0] - 1.0).abs() < 1e-8 && y[1].abs() < 1e-8, "{y:?}");
    }

    /// `y' = y²` ends at `t = 1`.
    #[test]
    fn an_end_is_told() {
        let (mut y, mut step) = (vec![1.0], 0.1);
        let system = System { rates: &|_, y| vec![y[0] * y[0]], settle: &|_, _| true };
        let end = advance(&system, (0.0, 2.0), &mut y, &mut step, 1e-8);
        assert!(end.is_err_and(|t| (t - 1.0).abs() < 1e-3));
    }
}
