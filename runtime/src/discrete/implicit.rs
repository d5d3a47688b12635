//! Derivatives of steps that are implicit in momenta, from the implicit function theorem.
//!
//! With the velocity `w` of the midpoint `q_m = q ⊕ (h/2) w` and momenta `p(q, v) = M v + …`, whose rates are
//! `f`, a step is `p(q_m, w) = p₀ + Jᵀ(q) λ + (h/2) f(q_m, w)`, `q⁺ = q ⊕ h w`, `p(q⁺, v⁺) = p(q_m, w) +
//! (h/2) f(q_m, w) + Jᵀ(q⁺) μ`, with constraints on configurations enforced at `q⁺`, constraints on
//! velocities enforced at the midpoint, and the rates of all constraints enforced at the end
//! ([`ImplicitMidpoint`](crate::integrate::ImplicitMidpoint)).

use super::projected::StepCorrections;
use super::{DifferentiableStep, Transition, state_after_step};
use crate::constraint::{
    ConstrainedDerivatives, column_or_zeros, matrix_from_column_function, multipliers_from_constraint_forces,
};
use crate::derivatives::{ByMotion, Derivatives};
use crate::integrate::{Error, ImplicitMidpoint, SemiImplicitEuler};
use crate::private::{constant, epsilon};
use crate::speeds::{
    mechanism_displacement_given_final_velocity, midpoint_velocity, reached_configuration_derivatives,
};
use crate::{Real, at};
use nalgebra::{SMatrix, SVector};

/// Returns the derivatives of the momentum with respect to configuration and velocity.
fn momentum_derivatives<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
) -> (SMatrix<T, NV, NV>, SMatrix<T, NV, NV>)
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    // With feedback the velocity replaces the momentum.
    if m.features().feedback {
        return (SMatrix::zeros(), SMatrix::identity());
    }
    (m.generalized_momentum_derivatives(t, q, v), m.mass_matrix(t, q))
}

/// Returns the derivatives of the momentum's rate under inputs.
fn momentum_rate_derivatives<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
) -> ByMotion<T, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    if m.features().feedback {
        let motion = at(m, t).linear_motion(q, v, u);
        return (motion.by_q, motion.by_v, motion.by_u);
    }
    let (by_q, by_v) = m.momentum_rate_derivatives(t, q, v);
    let (force_by_q, force_by_v, by_u) = m.generalized_forces_derivatives(t, q, v, u);
    (by_q + force_by_q, by_v + force_by_v, by_u)
}

/// Returns the derivatives of the velocity-dependent part of the momentum's rate.
fn velocity_dependent_momentum_rate_derivatives<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
) -> ByMotion<T, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    let (by_q, by_v) = m.momentum_rate_derivatives(t, q, v);
    (by_q - m.momentum_rate_derivatives(t, q, &SVector::zeros()).0, by_v, SMatrix::zeros())
}

/// Data of a completed implicit step: the state before it, its period, the velocity of its midpoint, and the
/// derivatives of the momentum's rate at the midpoint and of the momentum at the start.
struct ImplicitStepData<'a, M, T, const NQ: usize, const NV: usize, const NU: usize> {
    m: &'a M,
    t: T,
    h: T,
    q: &'a SVector<T, NQ>,
    w: SVector<T, NV>,
    /// Configuration at the midpoint of the step.
    middle: SVector<T, NQ>,
    /// Derivatives of the configurations at the midpoint and at the end, with respect to the configuration
    /// before the step and to the velocity of the midpoint.
    led: [(SMatrix<T, NV, NV>, SMatrix<T, NV, NV>); 2],
    end: (SVector<T, NQ>, SVector<T, NV>),
    rate: ByMotion<T, NV, NU>,
    start: ByMotion<T, NV, NU>,
    /// Momentum at the midpoint, before half a step of the momentum's rate is added.
    kick: SVector<T, NV>,
}

/// Linear solutions of the equations of the midpoint and of the end for given perturbations.
trait StepPerturbationSolver<T, const NV: usize> {
    /// Returns the change of the midpoint's velocity due to forces and to the configuration at the start.
    fn midpoint_velocity_change<const C: usize>(
        &self,
        force: &SMatrix<T, NV, C>,
        by_q: &SMatrix<T, NV, C>,
    ) -> SMatrix<T, NV, C>;
    /// Returns the change of the velocity at the end due to momenta and to the configuration at the end.
    fn end_velocity_change<const C: usize>(
        &self,
        p: &SMatrix<T, NV, C>,
        by_q: &SMatrix<T, NV, C>,
    ) -> SMatrix<T, NV, C>;
}

/// Linear solver for perturbations of an implicit step, for mechanisms without constraints.
struct UnconstrainedPerturbationSolver<T, const NV: usize> {
    matrix: SMatrix<T, NV, NV>,
    mass: SMatrix<T, NV, NV>,
    momentum_by_q: SMatrix<T, NV, NV>,
}

impl<T: Real, const NV: usize> StepPerturbationSolver<T, NV> for UnconstrainedPerturbationSolver<T, NV> {
    fn midpoint_velocity_change<const C: usize>(
        &self,
        force: &SMatrix<T, NV, C>,
        _by_q: &SMatrix<T, NV, C>,
    ) -> SMatrix<T, NV, C> {
        eliminate_with_pivoting(self.matrix, *force)
    }

    fn end_velocity_change<const C: usize>(
        &self,
        p: &SMatrix<T, NV, C>,
        by_q: &SMatrix<T, NV, C>,
    ) -> SMatrix<T, NV, C> {
        eliminate_with_pivoting(self.mass, p - self.momentum_by_q * by_q)
    }
}

/// Linear solver for perturbations of an implicit step, for mechanisms with constraints.
struct ConstrainedPerturbationSolver<'a, M, T, const NQ: usize, const NV: usize, const NC: usize> {
    m: &'a M,
    matrix: SMatrix<T, NV, NV>,
    /// Derivatives of the midpoint's velocity with respect to constraint impulses at the start.
    pushed: SMatrix<T, NV, NC>,
    /// Derivatives of the constraint impulses at the start with respect to the configuration.
    pushes_by_q: SMatrix<T, NV, NV>,
    /// Derivatives of the constraints that the step enforces, with respect to the velocity of the midpoint
    /// and to the configuration at the start.
    by_w: SMatrix<T, NC, NV>,
    by_q: SMatrix<T, NC, NV>,
    /// Time and configuration of the end, and the derivatives with respect to that configuration of the
    /// momentum minus the constraint impulses, and of the constraint rates.
    t: T,
    end: &'a SVector<T, NQ>,
    balance_by_q: SMatrix<T, NV, NV>,
    rates_by_q: SMatrix<T, NC, NV>,
}

/// Linear solver [`Held`] with the number of constraints as const parameter.
struct ConstrainedSolverWithCount<
    'a,
    'b,
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(&'b ConstrainedPerturbationSolver<'a, M, T, NQ, NV, NC>);

impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>
    StepPerturbationSolver<T, NV> for ConstrainedSolverWithCount<'_, '_, M, T, NQ, NV, NU, NH, NC>
where
    T: Real,
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    fn midpoint_velocity_change<const C: usize>(
        &self,
        force: &SMatrix<T, NV, C>,
        by_q: &SMatrix<T, NV, C>,
    ) -> SMatrix<T, NV, C> {
        let held = self.0;
        let free = eliminate_with_pivoting(held.matrix, force + held.pushes_by_q * by_q);
        let lacking = held.by_q * by_q + held.by_w * free;
        free - held.pushed * eliminate_with_pivoting(held.by_w * held.pushed, lacking)
    }

    fn end_velocity_change<const C: usize>(
        &self,
        p: &SMatrix<T, NV, C>,
        by_q: &SMatrix<T, NV, C>,
    ) -> SMatrix<T, NV, C> {
        let held = self.0;
        let (forces, gaps) = (p - held.balance_by_q * by_q, held.rates_by_q * by_q);
        matrix_from_column_function(|j| {
            held.m.constraint_response(
                held.t,
                held.end,
                &column_or_zeros(&forces, j),
                &column_or_zeros(&gaps, j),
            )
        })
    }
}

impl<'a, M, T, const NQ: usize, const NV: usize, const NU: usize> ImplicitStepData<'a, M, T, NQ, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    fn half_step_length(&self) -> T {
        self.h * constant(0.5)
    }

    /// Returns the derivative of the residual of the midpoint's equation with respect to the midpoint's
    /// velocity.
    fn residual_derivative(&self) -> SMatrix<T, NV, NV> {
        let half = self.half_step_length();
        let (by_q, by_v) = momentum_derivatives(self.m, self.t + half, &self.middle, &self.w);
        let moves = self.led[0].1;
        by_v - self.rate.1 * half + (by_q - self.rate.0 * half) * moves * half
    }

    /// Returns the changes of configuration and velocity after the step, due to changes of the configuration
    /// before it, of the momentum at the start and of the momentum's rate.
    fn changes_after_step<const C: usize>(
        &self,
        answer: &impl StepPerturbationSolver<T, NV>,
        by_q: &SMatrix<T, NV, C>,
        start: &SMatrix<T, NV, C>,
        rate: &SMatrix<T, NV, C>,
    ) -> (SMatrix<T, NV, C>, SMatrix<T, NV, C>) {
        let half = self.half_step_length();
        let (p_by_q, mass) = momentum_derivatives(self.m, self.t + half, &self.middle, &self.w);
        let [(turned, moves), end] = self.led;
        let force = start + rate * half - (p_by_q - self.rate.0 * half) * turned * by_q;
        let w = answer.midpoint_velocity_change(&force, by_q);
        let middle = turned * by_q + moves * w * half;
        let p = (p_by_q + self.rate.0 * half) * middle + (mass + self.rate.1 * half) * w + rate * half;
        let (turned, moves) = end;
        let end = turned * by_q + moves * w * self.h;
        (end, answer.end_velocity_change(&p, &end))
    }

    fn transition_of_step(&self, answer: &impl StepPerturbationSolver<T, NV>) -> Transition<T, NQ, NV, NU> {
        let none = SMatrix::zeros();
        let (q_by_q, v_by_q) = self.changes_after_step(answer, &SMatrix::identity(), &self.start.0, &none);
        let (q_by_v, v_by_v) = self.changes_after_step(answer, &none, &self.start.1, &none);
        let (q_by_u, v_by_u) =
            self.changes_after_step(answer, &SMatrix::zeros(), &self.start.2, &self.rate.2);
        let (q, v) = self.end;
        Transition { q, v, q_by_q, q_by_v, q_by_u, v_by_q, v_by_v, v_by_u, chained: None }
    }

    fn transition_without_constraints(&self) -> Transition<T, NQ, NV, NU> {
        let (q, v) = &self.end;
        let (momentum_by_q, mass) = momentum_derivatives(self.m, self.t + self.h, q, v);
        self.transition_of_step(&UnconstrainedPerturbationSolver {
            matrix: self.residual_derivative(),
            mass,
            momentum_by_q,
        })
    }

    fn constrained_transition<const NH: usize, const NC: usize>(
        &self,
        gain: &SVector<T, NV>,
    ) -> Result<Transition<T, NQ, NV, NU>, Error>
    where
        M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        let (m, t, h, half, still) = (self.m, self.t, self.h, self.half_step_length(), SVector::zeros());
        let (middle, (end, after)) = (self.middle, &self.end);
        m.check_full_rank(t, self.q)?;
        m.check_full_rank(t + h, end)?;
        let matrix = self.residual_derivative();
        let own = m.generalized_momentum(t + half, &middle, &self.w);
        let lambda = multipliers_from_constraint_forces(m, t, self.q, &(own - self.kick - gain));
        let jacobian = m.constraint_jacobian(t, self.q);
        // Constraints on configurations at the end, divided by the period; constraints on velocities at the
        // midpoint.
        let (mut by_w, mut by_q) = (SMatrix::<T, NC, NV>::zeros(), SMatrix::<T, NC, NV>::zeros());
        let at_end = m.constraint_jacobian(t + h, end);
        let [half_way, (turned, moves)] = self.led;
        let (of_w, of_q) = (at_end * moves, at_end * turned / h);
        let (turned, moves) = half_way;
        let rates = m.equation_derivatives(t + half, &middle, &self.w, &still, &SVector::zeros()).rates_by_q;
        let on_w = rates * moves * half + m.constraint_jacobian(t + half, &middle);
        let on_q = rates * turned;
        for k in 0..NC {
            let (w, q) = if k < NH { (of_w.row(k), of_q.row(k)) } else { (on_w.row(k), on_q.row(k)) };
            by_w.set_row(k, &w);
            by_q.set_row(k, &q);
        }
        let p = own + gain;
        let mu = multipliers_from_constraint_forces(
            m,
            t + h,
            end,
            &(m.generalized_momentum(t + h, end, after) - p),
        );
        let held = ConstrainedPerturbationSolver {
            m,
            matrix,
            pushed: eliminate_with_pivoting(matrix, jacobian.transpose()),
            pushes_by_q: -m.correction_equation_derivatives(t, self.q, &still, &lambda).0,
            by_w,
            by_q,
            t: t + h,
            end,
            balance_by_q: momentum_derivatives(m, t + h, end, after).0
                + m.correction_equation_derivatives(t + h, end, &still, &mu).0,
            rates_by_q: m.equation_derivatives(t + h, end, after, &still, &SVector::zeros()).rates_by_q,
        };
        Ok(self.transition_of_step(&ConstrainedSolverWithCount::<M, T, NQ, NV, NU, NH, NC>(&held)))
    }
}

impl<T: Real> DifferentiableStep<T> for ImplicitMidpoint<T> {
    const IN_MOMENTA: [bool; 2] = [true; 2];

    fn step_length(&self) -> T {
        self.nominal_step_length()
    }

    fn differentiate_into<M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        m: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
        into: &mut Transition<T, NQ, NV, NU>,
    ) -> Result<(), Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        *into = self.compute_step_data(m, t, q, v, u)?.transition_without_constraints();
        Ok(())
    }

    fn differentiate_held<
        M,
        const NQ: usize,
        const NV: usize,
        const NU: usize,
        const NH: usize,
        const NC: usize,
    >(
        &self,
        m: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
    ) -> Result<Transition<T, NQ, NV, NU>, Error>
    where
        M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        let made = self.compute_step_data(m, t, q, v, u)?;
        let (now, middle) = (t + made.half_step_length(), made.middle);
        let force = m.momentum_rate(now, &middle, &made.w) + m.generalized_forces(now, &middle, &made.w, u);
        made.constrained_transition(&(force * made.half_step_length()))
    }
}

impl<T: Real> ImplicitMidpoint<T> {
    fn compute_step_data<'a, M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        m: &'a M,
        t: T,
        q: &'a SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
    ) -> Result<ImplicitStepData<'a, M, T, NQ, NV, NU>, Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let h = self.nominal_step_length();
        let (end, mean) = state_after_step(m, self, t, q, v, u, h)?;
        let half = h * constant(0.5);
        let w = midpoint_velocity(m, q, mean, half);
        let (by_q, by_v) = momentum_derivatives(m, t, q, v);
        let middle = m.integrate(q, &mechanism_displacement_given_final_velocity(m, q, &w, half));
        Ok(ImplicitStepData {
            led: reached_configuration_derivatives(m, q, &w, half),
            middle,
            m,
            t,
            h,
            q,
            w,
            end,
            rate: momentum_rate_derivatives(m, t + half, &middle, &w, u),
            start: (by_q, by_v, SMatrix::zeros()),
            kick: m.generalized_momentum(t, q, v),
        })
    }
}

/// Returns a constrained semi-implicit Euler step with its Jacobians. Forces are evaluated at the start of
/// the step, inertial terms at the midpoint.
pub(super) fn constrained_semi_implicit_transition<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    method: &SemiImplicitEuler<T>,
    m: &M,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
) -> Result<Transition<T, NQ, NV, NU>, Error>
where
    T: Real,
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    let (h, still) = (method.nominal_step_length(), SVector::zeros());
    let (end, mean) = state_after_step(m, method, t, q, v, u, h)?;
    let half = h * constant(0.5);
    let w = midpoint_velocity(m, q, mean, half);
    let (by_q, by_v) = momentum_derivatives(m, t, q, v);
    let (force_by_q, force_by_v, force_by_u) = m.generalized_forces_derivatives(t, q, v, u);
    let rest_by_q = m.momentum_rate_derivatives(t, q, &still).0;
    let middle = m.integrate(q, &mechanism_displacement_given_final_velocity(m, q, &w, half));
    let force = m.momentum_rate(t, q, &still) + m.generalized_forces(t, q, v, u);
    let made = ImplicitStepData {
        led: reached_configuration_derivatives(m, q, &w, half),
        middle,
        m,
        t,
        h,
        q,
        w,
        end,
        rate: velocity_dependent_momentum_rate_derivatives(m, t + half, &middle, &w),
        start: (by_q + (force_by_q + rest_by_q) * h, by_v + force_by_v * h, force_by_u * h),
        kick: m.generalized_momentum(t, q, v) + force * h,
    };
    let rest = m.momentum_rate(t + half, &middle, &still);
    let gain = m.momentum_rate(t + half, &middle, &w) - rest;
    made.constrained_transition(&(gain * half))
}

/// Solves `m x = b` by Gaussian elimination with complete pivoting. Unknowns whose pivots are below rounding
/// error are set to zero.
pub fn eliminate_with_pivoting<T: Real, const N: usize, const C: usize>(
    mut m: SMatrix<T, N, N>,
    mut b: SMatrix<T, N, C>,
) -> SMatrix<T, N, C> {
    let mut order: [usize; N] = core::array::from_fn(|k| k);
    let least = epsilon::<T>().sqrt() * constant(1e-2) * m.amax();
    let mut rank = 0;
    for k in 0..N {
        let (mut row, mut chosen) = (k, k);
        for j in k..N {
            for i in k..N {
                if m[(i, j)].abs() > m[(row, chosen)].abs() {
                    (row, chosen) = (i, j);
                }
            }
        }
        if m[(row, chosen)].abs() <= least {
            break;
        }
        m.swap_rows(k, row);
        b.swap_rows(k, row);
        m.swap_columns(k, chosen);
        order.swap(k, chosen);
        for i in k + 1..N {
            let factor = m[(i, k)] / m[(k, k)];
            for j in k..N {
                let own = m[(k, j)];
                m[(i, j)] -= factor * own;
            }
            for j in 0..C {
                let own = b[(k, j)];
                b[(i, j)] -= factor * own;
            }
        }
        rank = k + 1;
    }
    let mut x = SMatrix::zeros();
    for j in 0..C {
        for k in (0..rank).rev() {
            let rest = (k + 1..rank).fold(b[(k, j)], |sum, i| sum - m[(k, i)] * x[(order[i], j)]);
            x[(order[k], j)] = rest / m[(k, k)];
        }
    }
    x
}
