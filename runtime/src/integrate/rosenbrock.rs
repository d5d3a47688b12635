//! Linearly implicit (Rosenbrock) integration method for stiff mechanisms.

use super::{
    Dynamics, Error, Jump, Method, State, Step, check_positive, equal_step_length_and_end,
    project_end_of_step,
};
use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use nalgebra::{SMatrix, SVector};

/// The Rosenbrock method ROS2 with fixed steps: order 2, and stable for any stiffness of springs and
/// dashpots.
///
/// `(1 − γ h J) k₁ = f(y₀)`, `(1 − γ h J) k₂ = f(y₀ + h k₁) − 2 k₁`, `y₁ = y₀ + (3 k₁ + k₂) h / 2` with `γ =
/// 1 + 1/√2`. The method is L-stable, and of order 2 for any matrix `J`: without the option `derivatives`,
/// `J` is computed from finite differences of the accelerations. A step costs three evaluations of the
/// dynamics, their derivatives (or `2 NV` further evaluations) and one factorisation of a matrix of size
/// `NV`. Fast stiff modes are damped out; slow modes lose energy, too. Constraints are enforced as by the
/// other methods; where they nearly lose rank, the derivatives are those of the previous step, or zero.
/// Derivatives are taken along the displacements that the constraints allow. Source: Verwer, Spee, Blom and
/// Hundsdorfer, *A second-order Rosenbrock method applied to photochemical dispersion problems*, SIAM J. Sci.
/// Comput. 20 (1999).
///
/// [`Error::NotConverged`] means that the matrix of a step is singular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rosenbrock<T> {
    step: T,
}

impl<T: Real> Rosenbrock<T> {
    /// Returns the Rosenbrock method with steps of `step` seconds. Steps are slightly shorter where they must
    /// end on a sample time.
    pub const fn step(step: T) -> Self {
        Self { step }
    }
}

/// Derivatives of the acceleration with respect to displacement, velocity and time.
#[derive(Clone, Copy, Debug)]
pub struct AccelerationJacobian<T, const NV: usize> {
    pub(super) by_q: SMatrix<T, NV, NV>,
    pub(super) by_v: SMatrix<T, NV, NV>,
    pub(super) by_t: SVector<T, NV>,
}

impl<T: Real, const NV: usize> AccelerationJacobian<T, NV> {
    pub(super) fn zero_jacobian() -> Self {
        Self { by_q: SMatrix::zeros(), by_v: SMatrix::zeros(), by_t: SVector::zeros() }
    }
}

/// Directions of displacement for which a linearly implicit method differentiates the accelerations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum JacobianDirections {
    /// Displacements that the constraints allow: for methods whose order does not depend on the matrix.
    Allowed,
    /// All displacements, including those that constraints forbid: for methods whose order requires the exact
    /// Jacobian. The stages of such methods violate the constraints, because of curvature and centripetal
    /// accelerations.
    All,
}

/// Returns the derivatives at the start of a step, with a zero time derivative. `None` in and near singular
/// configurations, where branches of the motion intersect.
pub(super) fn acceleration_jacobian_at_start<
    T: Real,
    D: Dynamics<T, NQ, NV>,
    const NQ: usize,
    const NV: usize,
>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    acceleration: &SVector<T, NV>,
    h: T,
    along: JacobianDirections,
) -> Option<AccelerationJacobian<T, NV>> {
    let State { t, q, v } = start;
    if system.is_nearly_singular(*t, q, &(v * h)) {
        return None;
    }
    let mut out = AccelerationJacobian::<T, NV>::zero_jacobian();
    let known = system.acceleration_derivatives(*t, q, v);
    let is_part = along == JacobianDirections::Allowed && system.is_constrained();
    if let Some((by_q, by_v)) = known
        && !is_part
    {
        return Some(AccelerationJacobian { by_q, by_v, ..out });
    }
    let root = epsilon::<T>().sqrt();
    let momentum = system.momentum(*t, q, v);
    for k in 0..system.dimensions()[1].min(NV) {
        let mut direction = SVector::<T, NV>::zeros();
        direction[k] = T::one();
        if is_part {
            // The component of the direction that the constraints allow: elsewhere, other branches of the
            // motion diverge from the actual one.
            let p = system.momentum(*t, q, &(v + direction)) - momentum;
            direction = system.velocity_change_by_impulse(*t, q, v, T::zero(), &p);
        }
        let (by_q, by_v) = if let Some((by_q, by_v)) = known {
            (by_q * direction, by_v * direction)
        } else {
            let moved = system.acceleration(*t, &system.integrate(q, &(direction * root)), v);
            let size = root * v[k].abs().max(T::one());
            let faster = system.acceleration(*t, q, &(v + direction * size));
            ((moved - acceleration) / root, (faster - acceleration) / size)
        };
        out.by_q.set_column(k, &by_q);
        out.by_v.set_column(k, &by_v);
    }
    Some(out)
}

/// Returns the delay after the start of a step of `h` seconds at which time derivatives are sampled: a
/// thousandth of the step, and at least several rounding units of the run's clock.
pub(super) fn time_derivative_sampling_delay<
    T: Real,
    D: Dynamics<T, NQ, NV>,
    const NQ: usize,
    const NV: usize,
>(
    system: &D,
    start: T,
    h: T,
) -> T {
    let tick = system.time(start).abs() * epsilon::<T>();
    (h * constant(1e-3)).max(tick * constant(8.0)).min(h * constant(0.5))
}

/// Returns the time from the start of a step to `later`, rounded as on the run's clock, of which
/// accelerations are functions.
pub(super) fn elapsed_time_on_run_clock<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    start: T,
    later: T,
) -> T {
    system.time(start + later) - system.time(start)
}

/// Solves `m x = b` by Gaussian elimination with row pivoting; `None` for a singular matrix.
fn solve_linear_system<T: Real, const N: usize>(
    mut m: SMatrix<T, N, N>,
    mut b: SVector<T, N>,
) -> Option<SVector<T, N>> {
    for k in 0..N {
        let best = (k..N).max_by(|i, j| {
            let order = m[(*i, k)].abs().partial_cmp(&m[(*j, k)].abs());
            order.unwrap_or(core::cmp::Ordering::Equal)
        })?;
        m.swap_rows(k, best);
        b.swap_rows(k, best);
        let pivot = m[(k, k)];
        if !pivot.is_finite() || pivot == T::zero() {
            return None;
        }
        for i in k + 1..N {
            let factor = m[(i, k)] / pivot;
            for j in k..N {
                let own = m[(k, j)];
                m[(i, j)] -= factor * own;
            }
            let own = b[k];
            b[i] -= factor * own;
        }
    }
    for k in (0..N).rev() {
        let rest = (k + 1..N).fold(b[k], |sum, j| sum - m[(k, j)] * b[j]);
        b[k] = rest / m[(k, k)];
    }
    Some(b)
}

impl<T: Real> Method<T> for Rosenbrock<T> {
    /// Acceleration derivatives of the previous step, if available.
    type Memory<const NV: usize> = Option<AccelerationJacobian<T, NV>>;

    const FIXED: bool = true;

    fn check(&self) -> Result<(), Error> {
        check_positive("the step", self.step)
    }

    fn initial_memory<const NV: usize>(&self) -> Self::Memory<NV> {
        None
    }

    fn discard_memory_after_jump<const NV: usize>(&self, memory: &mut Self::Memory<NV>, jump: Jump) {
        if jump == Jump::State {
            *memory = None;
        }
    }

    fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
        &self,
        memory: &mut Self::Memory<NV>,
        system: &mut D,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        dense: bool,
    ) -> Result<Step<T, NQ, NV>, Error> {
        let (h, t) = equal_step_length_and_end(self.step, start.t, until)?;
        let before = system.acceleration(start.t, &start.q, &start.v);
        let mut slopes =
            acceleration_jacobian_at_start(system, start, &before, h, JacobianDirections::Allowed)
                .or(*memory)
                .unwrap_or(AccelerationJacobian::zero_jacobian());
        let later = time_derivative_sampling_delay(system, start.t, h);
        let passed = elapsed_time_on_run_clock(system, start.t, later);
        if passed > T::zero() {
            slopes.by_t = (system.acceleration(start.t + later, &start.q, &start.v) - before) / passed;
        }
        let gamma = constant::<T>(1.0 + core::f64::consts::FRAC_1_SQRT_2);
        let part = gamma * h;
        // (1 − γhJ) (kφ, kv) = (a, b) with J = [0 1; Fφ Fv] reduces to kφ = a + γh kv and one system for kv.
        let matrix = SMatrix::identity() - slopes.by_v * part - slopes.by_q * (part * part);
        let solve_rosenbrock_stage = |a: SVector<T, NV>, b: SVector<T, NV>| {
            let kv = solve_linear_system(matrix, b + slopes.by_q * a * part)?;
            Some((a + kv * part, kv))
        };
        let singular = Error::NotConverged { t: to_f64(start.t), iterations: 0 };
        let first = solve_rosenbrock_stage(start.v, before + slopes.by_t * part).ok_or(singular)?;
        let (moved, v) = (first.0 * h, start.v + first.1 * h);
        let q = system.integrate(&start.q, &moved);
        let two = constant::<T>(2.0);
        let rate = system.displacement_rate(&start.q, &moved, &v) - first.0 * two;
        let force = system.acceleration(t, &q, &v) - slopes.by_t * part - first.1 * two;
        let second = solve_rosenbrock_stage(rate, force).ok_or(singular)?;
        let (three, half) = (constant::<T>(3.0), h * constant(0.5));
        let displacement = (first.0 * three + second.0) * half;
        let v = start.v + (first.1 * three + second.1) * half;
        let end = State { t, q: system.integrate(&start.q, &displacement), v };
        let end = project_end_of_step(system, end, start.t)?;
        *memory = Some(slopes);
        let step = Step::linear(*start, end, displacement);
        if !dense {
            return Ok(step);
        }
        let after = system.acceleration(end.t, &end.q, &end.v);
        Ok(step.cubic(system, &displacement, [before, after]))
    }
}
