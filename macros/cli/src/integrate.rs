//! Integration of ordinary differential equations with adaptive steps. The method is the pair of Dormand and
//! Prince, *A family of embedded Runge–Kutta formulae* (1980). If the equations are stiff, so that it needs
//! too many steps, the linearly implicit method RODAS takes over (Hairer and Wanner, *Solving Ordinary
//! Differential Equations II*, 1996, § VI.4).

use linkwork::__private::rodas::{ADDED, GAMMA, IN_TIME, STARTS, TIMES};

/// Stages of the Dormand–Prince method: their times, as fractions of the step, and the weights of the earlier
/// stages.
const STAGES: [(f64, &[f64]); 6] = [
    (1.0 / 5.0, &[1.0 / 5.0]),
    (3.0 / 10.0, &[3.0 / 40.0, 9.0 / 40.0]),
    (4.0 / 5.0, &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0]),
    (8.0 / 9.0, &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0]),
    (1.0, &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0]),
    (1.0, &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0]),
];
/// Weights of the difference between the solutions of orders five and four.
const DIFFERENCE: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Maximum number of steps from one stop to the next.
const MAX_STEPS: usize = 1_000_000;
/// Number of implicit steps whose cost, in evaluations of the rates, is observed before the other method is
/// tried.
const OBSERVED: usize = 30;
/// Maximum number of observations between two trials of the other method.
const LONGEST_WAIT: usize = 64;

/// System of equations: the rates of its state, and the correction of the state at the end of a step.
pub struct System<'a> {
    /// Rates as a function of time and state.
    pub rates: &'a dyn Fn(f64, &[f64]) -> Vec<f64>,
    /// Projects the state at a time onto the constraints; `false` if no such state is near.
    pub settle: &'a dyn Fn(f64, &mut Vec<f64>) -> bool,
}

/// Integration method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Method {
    /// Dormand–Prince method.
    Explicit,
    /// RODAS method.
    Implicit,
}

impl Method {
    fn other(self) -> Method {
        match self {
            Method::Explicit => Method::Implicit,
            Method::Implicit => Method::Explicit,
        }
    }

    /// Returns the exponent of the error in the formula for the next step size.
    fn exponent(self) -> f64 {
        match self {
            Method::Explicit => -0.2,
            Method::Implicit => -0.25,
        }
    }

    /// Returns the number of evaluations of the rates per step, for a system of `n` equations.
    fn cost(self, n: usize) -> usize {
        match self {
            Method::Explicit => 7,
            Method::Implicit => n + 10,
        }
    }
}

/// Integration between successive stop times. It begins with the explicit method, and switches if a trial
/// shows that the other method needs less than half the number of evaluations.
pub struct Integrator {
    tolerance: f64,
    method: Method,
    /// Step sizes of the explicit and of the implicit method.
    steps: [f64; 2],
    /// Number of evaluations of the rates since the last observation, and the time that they covered.
    observed: (usize, f64),
    /// Number of observations before the next trial, and between the trials after it.
    wait: [usize; 2],
    /// Total number of evaluations of the rates.
    pub evaluations: usize,
    /// Time at which the implicit method was first used.
    pub stiff_from: Option<f64>,
}

impl Integrator {
    /// Creates an integration with an initial step and a tolerance for the relative and absolute error of a
    /// step.
    pub fn new(step: f64, tolerance: f64) -> Integrator {
        Integrator {
            tolerance,
            method: Method::Explicit,
            steps: [step; 2],
            observed: (0, 0.0),
            wait: [1, 1],
            evaluations: 0,
            stiff_from: None,
        }
    }

    /// Integrates from one time to another. The error is the time at which the integration could not
    /// continue.
    pub fn advance(
        &mut self,
        system: &System<'_>,
        (from, to): (f64, f64),
        y: &mut Vec<f64>,
    ) -> Result<(), f64> {
        let mut t = from;
        for _ in 0..MAX_STEPS {
            // Stop times that differ by rounding coincide.
            if to - t <= least_step(t) {
                return Ok(());
            }
            if let Some(end) = self.tried(system, (t, to), y) {
                t = end;
                continue;
            }
            let before = self.evaluations;
            let end = self.step(self.method, system, (t, to), y, usize::MAX).ok_or(t)?;
            self.observed.0 += self.evaluations - before;
            self.observed.1 += end - t;
            t = end;
        }
        Err(t)
    }

    /// Tries the other method when the waiting time is over. If it needs less than half the number of
    /// evaluations that the current method needed for the same time, switches to it and returns the time
    /// reached.
    fn tried(&mut self, system: &System<'_>, (t, to): (f64, f64), y: &mut Vec<f64>) -> Option<f64> {
        let (evaluations, time) = self.observed;
        let other = self.method.other();
        if evaluations < OBSERVED * Method::Implicit.cost(y.len()) {
            return None;
        }
        if self.wait[0] > 0 {
            self.observed = (0, 0.0);
            self.wait[0] -= 1;
            return None;
        }
        let end = (t + time).min(to);
        let budget = (0.5 * evaluations as f64 * (end - t) / time) as usize;
        if budget < 3 * other.cost(y.len()) {
            return None;
        }
        let (last, mut state, mut at) = (self.evaluations + budget, y.clone(), t);
        if other == Method::Implicit {
            self.steps[1] = end - t;
        }
        while at < end && self.evaluations < last {
            let left = last - self.evaluations;
            let Some(next) = self.step(other, system, (at, end), &mut state, left) else { break };
            at = next;
        }
        self.observed = (0, 0.0);
        if at < end {
            self.wait = [self.wait[1], (2 * self.wait[1]).min(LONGEST_WAIT)];
            return None;
        }
        self.wait = [1, 1];
        self.method = other;
        if other == Method::Implicit {
            self.stiff_from.get_or_insert(t);
        }
        *y = state;
        Some(end)
    }

    /// Takes one step towards a time and returns the time reached. `None` if no step is possible, or none
    /// within a number of evaluations.
    fn step(
        &mut self,
        method: Method,
        system: &System<'_>,
        (t, to): (f64, f64),
        y: &mut Vec<f64>,
        budget: usize,
    ) -> Option<f64> {
        let at = method as usize;
        let (mut spent, mut linear, first) = (0, None, (system.rates)(t, y));
        self.evaluations += 1;
        loop {
            let left = to - t;
            let step = self.steps[at];
            let h = if step >= left * (1.0 - 1e-12) { left } else { step };
            if h <= least_step(t) || spent > budget {
                return None;
            }
            let (result, evaluations) = match method {
                Method::Explicit => (Some(explicit(system.rates, t, y, &first, h)), 6),
                Method::Implicit => {
                    let evaluations = if linear.is_none() { y.len() + 7 } else { 5 };
                    let linear =
                        linear.get_or_insert_with(|| Linear::derivatives(system.rates, t, y, &first, h));
                    (implicit(system.rates, t, y, &first, linear, h), evaluations)
                }
            };
            self.evaluations += evaluations;
            spent += evaluations;
            let (mut next, error) = result.unwrap_or_else(|| (y.clone(), vec![f64::NAN; y.len()]));
            let scaled = (0..y.len())
                .map(|k| error[k].abs() / (self.tolerance * (1.0 + y[k].abs().max(next[k].abs()))))
                .fold(0.0, |largest: f64, x| if x > largest || x.is_nan() { x } else { largest });
            let good =
                scaled <= 1.0 && next.iter().all(|x| x.is_finite()) && (system.settle)(t + h, &mut next);
            let factor =
                if scaled.is_finite() { 0.9 * scaled.max(1e-10).powf(method.exponent()) } else { 0.1 };
            if good {
                *y = next;
                // A step that ends at a stop does not limit the next one.
                let grown = h * factor.clamp(0.2, 5.0);
                self.steps[at] = if h < left { grown } else { step.max(grown) };
                return Some(if h == left { to } else { t + h });
            }
            self.steps[at] = h * factor.clamp(0.1, 0.5);
        }
    }
}

/// Returns the step size below which a step is lost in rounding.
fn least_step(t: f64) -> f64 {
    1e-14 * t.abs().max(1e-3)
}

/// Takes a Dormand–Prince step and returns the state and the error.
fn explicit(
    rates: &dyn Fn(f64, &[f64]) -> Vec<f64>,
    t: f64,
    y: &[f64],
    first: &[f64],
    h: f64,
) -> (Vec<f64>, Vec<f64>) {
    let mut slopes = vec![first.to_vec()];
    let mut at = y.to_vec();
    for (when, weights) in STAGES {
        for (k, x) in at.iter_mut().enumerate() {
            *x = y[k] + h * weights.iter().zip(&slopes).map(|(w, slope)| w * slope[k]).sum::<f64>();
        }
        slopes.push(rates(t + when * h, &at));
    }
    let error = |k: usize| h * DIFFERENCE.iter().zip(&slopes).map(|(w, slope)| w * slope[k]).sum::<f64>();
    let error = (0..y.len()).map(error).collect();
    (at, error)
}

/// Derivatives of the rates, by finite differences.
struct Linear {
    /// Derivatives of the rates with respect to the state, column by column.
    by_state: Vec<Vec<f64>>,
    by_time: Vec<f64>,
}

impl Linear {
    fn derivatives(
        rates: &dyn Fn(f64, &[f64]) -> Vec<f64>,
        t: f64,
        y: &[f64],
        first: &[f64],
        h: f64,
    ) -> Linear {
        let column = |k: usize| {
            let mut moved = y.to_vec();
            moved[k] += f64::EPSILON.sqrt() * y[k].abs().max(1.0);
            let size = moved[k] - y[k];
            rates(t, &moved).iter().zip(first).map(|(a, b)| (a - b) / size).collect()
        };
        let by_state = (0..y.len()).map(column).collect();
        let size = 1e-3 * h;
        let (near, far) = (rates(t + size, y), rates(t + 2.0 * size, y));
        let by_time =
            (0..y.len()).map(|k| (4.0 * near[k] - far[k] - 3.0 * first[k]) / (2.0 * size)).collect();
        Linear { by_state, by_time }
    }
}

/// Takes a RODAS step and returns the state and the error; `None` if its matrix is singular.
fn implicit(
    rates: &dyn Fn(f64, &[f64]) -> Vec<f64>,
    t: f64,
    y: &[f64],
    first: &[f64],
    linear: &Linear,
    h: f64,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let n = y.len();
    let entry = |i: usize, j: usize| {
        let diagonal = if i == j { 1.0 / (h * GAMMA) } else { 0.0 };
        diagonal - linear.by_state[j][i]
    };
    let matrix = Factored::eliminate((0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect())?;
    let mut stages: Vec<Vec<f64>> = Vec::new();
    let sum = |weights: &[f64], stages: &[Vec<f64>], k: usize| -> f64 {
        weights.iter().zip(stages).map(|(w, stage)| w * stage[k]).sum()
    };
    let mut at = y.to_vec();
    for (stage, when) in TIMES.iter().enumerate() {
        at = (0..n).map(|k| y[k] + sum(STARTS[stage], &stages, k)).collect();
        let slope = if stage == 0 { first.to_vec() } else { rates(t + when * h, &at) };
        let right =
            |k: usize| slope[k] + sum(ADDED[stage], &stages, k) / h + h * IN_TIME[stage] * linear.by_time[k];
        stages.push(matrix.solve((0..n).map(right).collect()));
    }
    let error = stages.pop()?;
    at.iter_mut().zip(&error).for_each(|(x, e)| *x += e);
    Some((at, error))
}

/// Matrix after Gaussian elimination with row pivoting.
struct Factored {
    /// Rows of both triangular factors, with the multipliers below the diagonal.
    rows: Vec<Vec<f64>>,
    /// Original index of each row.
    order: Vec<usize>,
}

impl Factored {
    /// Factorises a matrix; `None` if it is singular or not finite.
    fn eliminate(mut rows: Vec<Vec<f64>>) -> Option<Factored> {
        let n = rows.len();
        let mut order: Vec<usize> = (0..n).collect();
        for k in 0..n {
            let best = (k..n).max_by(|i, j| rows[*i][k].abs().total_cmp(&rows[*j][k].abs()))?;
            rows.swap(k, best);
            order.swap(k, best);
            let (above, below) = rows.split_at_mut(k + 1);
            let pivot = &above[k];
            if pivot[k] == 0.0 || !pivot[k].is_finite() {
                return None;
            }
            for row in below {
                let factor = row[k] / pivot[k];
                row[k] = factor;
                if factor != 0.0 {
                    (k + 1..n).for_each(|j| row[j] -= factor * pivot[j]);
                }
            }
        }
        Some(Factored { rows, order })
    }

    fn solve(&self, b: Vec<f64>) -> Vec<f64> {
        let n = b.len();
        let mut x: Vec<f64> = self.order.iter().map(|k| b[*k]).collect();
        for i in 0..n {
            let known: f64 = (0..i).map(|j| self.rows[i][j] * x[j]).sum();
            x[i] -= known;
        }
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|j| self.rows[i][j] * x[j]).sum();
            x[i] = (x[i] - known) / self.rows[i][i];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::{Integrator, System};

    /// Integrates from zero to an end time, with stops at every tenth of it.
    fn integrated(
        rates: &dyn Fn(f64, &[f64]) -> Vec<f64>,
        end: f64,
        y: &mut Vec<f64>,
    ) -> (Integrator, Result<(), f64>) {
        let system = System { rates, settle: &|_, _| true };
        let mut integrator = Integrator::new(end.min(1e-3), 1e-10);
        let at = |k: i32| end * f64::from(k) / 10.0;
        let done = (0..10).try_for_each(|k| integrator.advance(&system, (at(k), at(k + 1)), y));
        (integrator, done)
    }

    /// Checks `y'' = −y`, whose solutions are circles.
    #[test]
    fn a_circle_closes() {
        let mut y = vec![1.0, 0.0];
        let (integrator, done) = integrated(&|_, y| vec![y[1], -y[0]], 20.0 * std::f64::consts::PI, &mut y);
        assert!(done.is_ok() && (y[0] - 1.0).abs() < 1e-7 && y[1].abs() < 1e-7, "{y:?}");
        assert_eq!(integrator.stiff_from, None);
    }

    /// Checks that stop times which differ only by rounding are no failure.
    #[test]
    fn stops_that_nearly_coincide_are_passed() {
        let system = System { rates: &|_, _| vec![1.0], settle: &|_, _| true };
        let (mut y, mut integrator) = (vec![0.0], Integrator::new(1e-3, 1e-10));
        for (from, to) in [(0.0, 2.499_999_999_999_999_6), (2.499_999_999_999_999_6, 2.5), (2.5, 3.0)] {
            assert!(integrator.advance(&system, (from, to), &mut y).is_ok());
        }
        assert!((y[0] - 3.0).abs() < 1e-12);
    }

    /// Checks that the singularity of `y' = y²` at `t = 1` is reported.
    #[test]
    fn an_end_is_reported() {
        let (_, done) = integrated(&|_, y| vec![y[0] * y[0]], 2.0, &mut vec![1.0]);
        assert!(done.is_err_and(|t| (t - 1.0).abs() < 1e-3));
    }

    /// Checks `x' = −10⁶ (x − cos t)`, `y'' = −x`, whose solution is within 10⁻⁶ of `x = cos t + 10⁻⁶ sin t`
    /// and `y = cos t`. Few evaluations are needed; an explicit method takes two million per second of
    /// simulated time.
    #[test]
    fn stiff_equations_are_solved_by_the_implicit_method() {
        let rates = |t: f64, y: &[f64]| vec![-1e6 * (y[0] - t.cos()), y[2], -y[0]];
        let mut y = vec![1.0, 1.0, 0.0];
        let (integrator, done) = integrated(&rates, 10.0, &mut y);
        let (t, e) = (10.0_f64, 1e-6);
        assert!(done.is_ok() && integrator.stiff_from.is_some_and(|t| t < 0.1));
        assert!((y[0] - (t.cos() + e * t.sin()) / (1.0 + e * e)).abs() < 1e-8, "{y:?}");
        // The double integral of the exact solution: the transient contributes less than 10⁻¹¹.
        let exact = (t.cos() + e * t.sin() - e * t) / (1.0 + e * e) + e * e;
        assert!((y[1] - exact).abs() < 1e-7, "{y:?} {exact}");
        assert!(integrator.evaluations < 100_000, "{}", integrator.evaluations);
    }
}
