//! A linearly implicit method of order 4 for stiff mechanisms, with adaptive steps.

use super::adaptive::{
    AdaptiveMemory, AdaptiveSettings, StepControl, TrialStepArguments, TrialStepResult, adaptive,
};
use super::rosenbrock::{
    AccelerationJacobian, JacobianDirections, acceleration_jacobian_at_start, elapsed_time_on_run_clock,
    time_derivative_sampling_delay,
};
use super::stages::RungeKuttaRates;
use super::{Dynamics, Error, Jump, Method, State, Step};
use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use nalgebra::{SMatrix, SVector};

/// Constants of the step-size controller of RODAS.
const CONTROL: StepControl = StepControl { exponent: 0.25, beta: 0.0, factors: [6.0, 5.0] };
/// Diagonal coefficient `γ` of the method, which multiplies the Jacobian in each stage.
const GAMMA: f64 = 0.25;
/// Times of the stages, as fractions of the step.
const TIMES: [f64; 6] = [0.0, 0.386, 0.21, 0.63, 1.0, 1.0];
/// Weights of the earlier stages in the state at which each stage of RODAS is evaluated. The last row also
/// gives the result, without its own last stages.
const STARTS: [&[f64]; 6] = [
    &[],
    &[1.544],
    &[0.946_678_528_081_582_6, 0.255_701_169_898_328_4],
    &[3.314_825_187_068_521, 2.896_124_015_972_201, 0.998_641_913_997_781_7],
    &[1.221_224_509_226_641, 6.019_134_481_288_629, 12.537_083_329_320_87, -0.687_886_036_105_895],
    &[1.221_224_509_226_641, 6.019_134_481_288_629, 12.537_083_329_320_87, -0.687_886_036_105_895, 1.0],
];
/// Weights of the earlier stages that RODAS adds to the rates of each stage, divided by the step.
const ADDED: [&[f64]; 6] = [
    &[],
    &[-5.6688],
    &[-2.430_093_356_833_875, -0.206_359_915_709_191_5],
    &[-0.107_352_905_815_137_5, -9.594_562_251_023_355, -20.470_286_148_096_16],
    &[7.496_443_313_967_647, -10.246_804_314_643_52, -33.999_903_528_199_05, 11.708_908_932_061_6],
    &[
        8.083_246_795_921_522,
        -7.981_132_988_064_893,
        -31.521_594_328_743_71,
        16.319_305_431_231_36,
        -6.058_818_238_834_054,
    ],
];
/// Weights of the time derivative of the rates in each stage of RODAS, times the step.
const IN_TIME: [f64; 6] = [0.25, -0.1043, 0.1035, -0.036_200_000_000_000_23, 0.0, 0.0];
/// Weights of the stages in the third and fourth coefficient of the interpolating polynomial of RODAS.
const TERMS: [[f64; 5]; 2] = [
    [
        10.126_235_083_445_86,
        -7.487_995_877_610_167,
        -34.800_918_615_557_47,
        -7.992_771_707_568_823,
        1.025_137_723_295_662,
    ],
    [
        -0.676_280_339_280_125_3,
        6.087_714_651_680_015,
        16.430_843_208_924_78,
        24.767_225_114_183_86,
        -6.594_389_125_716_872,
    ],
];

/// The Rosenbrock method RODAS of order 4 with an error estimate of order 3, for stiff mechanisms. Steps are
/// adaptive and independent of the stiffness of springs and dashpots; interpolation has order 3.
///
/// A step solves six linear systems with one matrix of size `NV`. It evaluates the dynamics eight times and
/// their derivatives once. The option `derivatives` generates these derivatives; otherwise they are finite
/// differences, with `2 NV` further evaluations. A trial repeated with a shorter step evaluates the dynamics
/// five times. The method is L-stable: fast stiff modes are damped out. The error norm is that of
/// [`DormandPrince`](super::DormandPrince), and constraints are enforced as by
/// [`Rosenbrock`](super::Rosenbrock), with derivatives along all displacements. The method suits tolerances
/// of about 1e-3 to 1e-8; explicit methods are faster for mechanisms that are not stiff.
///
/// [`Error::NotConverged`] means that the matrix of a step is singular.
///
/// ```
/// # use linkwork::integrate::Rodas;
/// let method = Rodas::new().tolerance(1e-6, 1e-9);
/// # let _: Rodas<f64> = method;
/// ```
///
/// Source: Hairer and Wanner, *Solving Ordinary Differential Equations II* (1996), IV.7 and VI.4, and the
/// program RODAS.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rodas<T> {
    settings: AdaptiveSettings<T>,
}

adaptive!(Rodas);

/// Memory of RODAS: data that one step passes to the next.
#[derive(Clone, Copy, Debug)]
pub struct RodasMemory<T, const NV: usize> {
    steps: AdaptiveMemory<T, NV>,
    /// Derivatives of the last step, used at configurations where branches of the motion intersect.
    slopes: Option<AccelerationJacobian<T, NV>>,
}

impl<T: Real> Method<T> for Rodas<T> {
    type Memory<const NV: usize> = RodasMemory<T, NV>;

    const FIXED: bool = false;

    fn check(&self) -> Result<(), Error> {
        self.settings.check()
    }

    fn initial_memory<const NV: usize>(&self) -> Self::Memory<NV> {
        RodasMemory { steps: AdaptiveMemory::new(self.settings.first), slopes: None }
    }

    fn discard_memory_after_jump<const NV: usize>(&self, memory: &mut Self::Memory<NV>, jump: Jump) {
        memory.steps.acceleration = None;
        if jump == Jump::State {
            memory.slopes = None;
        }
    }

    fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
        &self,
        memory: &mut Self::Memory<NV>,
        system: &mut D,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        _dense: bool,
    ) -> Result<Step<T, NQ, NV>, Error> {
        // All trials of a step use the same derivatives.
        let (mut found, before) = (None, memory.slopes);
        let advanced =
            self.settings.advance(&CONTROL, &mut memory.steps, system, start, until, |system, attempt| {
                let known = found.unwrap_or_else(|| linearize_step(system, attempt, before));
                found = Some(known);
                trial_step(system, attempt, &known)
                    .ok_or(Error::NotConverged { t: to_f64(start.t), iterations: 0 })
            });
        memory.slopes = found.map(|linear: LinearisedStep<T, NV>| linear.slopes).or(before);
        advanced
    }
}

/// Equations of motion linearised about the start of a step.
#[derive(Clone, Copy)]
struct LinearisedStep<T, const NV: usize> {
    slopes: AccelerationJacobian<T, NV>,
    /// Derivatives of the displacement's rate with respect to the displacement.
    turn: SMatrix<T, NV, NV>,
}

fn linearize_step<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    attempt: &TrialStepArguments<'_, T, NQ, NV>,
    before: Option<AccelerationJacobian<T, NV>>,
) -> LinearisedStep<T, NV> {
    let TrialStepArguments { start, acceleration, h, .. } = *attempt;
    let mut slopes = acceleration_jacobian_at_start(system, start, acceleration, h, JacobianDirections::All)
        .or(before)
        .unwrap_or(AccelerationJacobian::zero_jacobian());
    // Order 4 requires a better time derivative than a forward difference; inputs may jump at the start.
    let later = time_derivative_sampling_delay(system, start.t, h);
    let [first, second] = [later, later * constant(2.0)].map(|later| {
        let change = system.acceleration(start.t + later, &start.q, &start.v) - acceleration;
        (elapsed_time_on_run_clock(system, start.t, later), change)
    });
    let between = second.0 - first.0;
    if first.0 > T::zero() && between > T::zero() {
        let (near, far) = (first.1 / first.0, second.1 / second.0);
        slopes.by_t = (near * second.0 - far * first.0) / between;
    }
    let mut turn = SMatrix::<T, NV, NV>::zeros();
    let size: T = epsilon::<T>().powf(constant(1.0 / 3.0));
    for k in 0..NV {
        let mut direction = SVector::<T, NV>::zeros();
        direction[k] = size;
        let rate: SVector<T, NV> = system.displacement_rate(&start.q, &direction, &start.v)
            - system.displacement_rate(&start.q, &-direction, &start.v);
        turn.set_column(k, &(rate / (size * constant::<T>(2.0))));
    }
    LinearisedStep { slopes, turn }
}

/// Returns the weighted sum of the displacement and velocity increments of six stages.
fn weighted_sum_of_stages<T: Real, const NV: usize>(
    weights: &[f64],
    stages: &[RungeKuttaRates<T, NV>; 6],
) -> RungeKuttaRates<T, NV> {
    let mut total = RungeKuttaRates { displacement: SVector::zeros(), velocity: SVector::zeros() };
    for (weight, stage) in weights.iter().zip(stages) {
        total.displacement += stage.displacement * constant::<T>(*weight);
        total.velocity += stage.velocity * constant::<T>(*weight);
    }
    total
}

/// Returns a trial step of RODAS; `None` if the matrix of the step is singular.
fn trial_step<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    attempt: &TrialStepArguments<'_, T, NQ, NV>,
    linear: &LinearisedStep<T, NV>,
) -> Option<TrialStepResult<T, NQ, NV>> {
    let TrialStepArguments { start, acceleration, scale, h, t } = *attempt;
    let LinearisedStep { slopes, turn } = linear;
    // (c − P) a − b = r and (c − Fv) b − Fφ a = s are reduced to one system for a.
    let c = T::one() / (h * constant(GAMMA));
    let scaled = SMatrix::<T, NV, NV>::identity() * c;
    let (of_a, of_b) = (scaled - turn, scaled - slopes.by_v);
    let matrix = LuFactors::new(of_b * of_a - slopes.by_q)?;
    let mut u = [RungeKuttaRates { displacement: SVector::zeros(), velocity: SVector::zeros() }; 6];
    let mut change = u[0];
    for (k, part) in TIMES.iter().enumerate() {
        let (Some(starts), Some(added), Some(in_time)) = (STARTS.get(k), ADDED.get(k), IN_TIME.get(k)) else {
            break;
        };
        change = weighted_sum_of_stages(starts, &u);
        let (rate, force) = match k {
            0 => (start.v, *acceleration),
            _ => {
                let time = if *part == 1.0 { t } else { start.t + h * constant(*part) };
                let (q, v) = (system.integrate(&start.q, &change.displacement), start.v + change.velocity);
                (
                    system.displacement_rate(&start.q, &change.displacement, &v),
                    system.acceleration(time, &q, &v),
                )
            }
        };
        let added = weighted_sum_of_stages(added, &u);
        let r = rate + added.displacement / h;
        let s = force + added.velocity / h + slopes.by_t * (h * constant(*in_time));
        let a = matrix.solve_factorised(s + of_b * r);
        if let Some(place) = u.get_mut(k) {
            *place = RungeKuttaRates { displacement: a, velocity: of_a * a - r };
        }
    }
    let error = u[5];
    let displacement = change.displacement + error.displacement;
    let v = start.v + change.velocity + error.velocity;
    let end = State { t, q: system.integrate(&start.q, &displacement), v };
    let mut step = Step::linear(*start, end, displacement);
    let [square, cube] = TERMS.map(|weights| weighted_sum_of_stages(&weights, &u));
    step.displacement =
        step.displacement.with_coefficients_from_third([square.displacement, cube.displacement]);
    step.velocity = step.velocity.with_coefficients_from_third([square.velocity, cube.velocity]);
    let error = scale.relative_error(&step, &displacement, &error);
    Some(TrialStepResult { step, acceleration: None, error })
}

/// LU factorisation of a matrix with row pivoting.
struct LuFactors<T, const N: usize> {
    /// LU factors in one matrix: the upper triangle, and the elimination multipliers below the diagonal.
    both: SMatrix<T, N, N>,
    /// Index of the row with which each row was exchanged during the pivoting.
    exchanged: [usize; N],
}

impl<T: Real, const N: usize> LuFactors<T, N> {
    /// Factorises a matrix; `None` if it is singular or a pivot is not finite.
    fn new(mut both: SMatrix<T, N, N>) -> Option<Self> {
        let mut exchanged = [0; N];
        for (k, place) in exchanged.iter_mut().enumerate() {
            let pivot_magnitude = |i: &usize| both[(*i, k)].abs();
            let best = (k..N).max_by(|i, j| {
                pivot_magnitude(i).partial_cmp(&pivot_magnitude(j)).unwrap_or(core::cmp::Ordering::Equal)
            })?;
            *place = best;
            both.swap_rows(k, best);
            let pivot = both[(k, k)];
            if !pivot.is_finite() || pivot == T::zero() {
                return None;
            }
            for i in k + 1..N {
                let factor = both[(i, k)] / pivot;
                both[(i, k)] = factor;
                for j in k + 1..N {
                    let own = both[(k, j)];
                    both[(i, j)] -= factor * own;
                }
            }
        }
        Some(Self { both, exchanged })
    }

    fn solve_factorised(&self, mut b: SVector<T, N>) -> SVector<T, N> {
        for (k, with) in self.exchanged.iter().enumerate() {
            b.swap_rows(k, *with);
        }
        for i in 0..N {
            b[i] = (0..i).fold(b[i], |sum, j| sum - self.both[(i, j)] * b[j]);
        }
        for k in (0..N).rev() {
            let rest = (k + 1..N).fold(b[k], |sum, j| sum - self.both[(k, j)] * b[j]);
            b[k] = rest / self.both[(k, k)];
        }
        b
    }
}
