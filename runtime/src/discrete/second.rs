//! Second derivatives of steps, contracted with factors: the curvature that differential dynamic programming adds to costs.

use super::DifferentiableStep;
use super::explicit::{Sensitive, Start};
use crate::derivatives::LinearMotion;
use crate::integrate::{Error, Rk4, SemiImplicitEuler};
use crate::private::constant;
use crate::{At, InputSecondOrder, Real, RheonomicSecondDerivatives, SecondDerivatives, at};
use nalgebra::{SMatrix, SVector};

/// The second derivatives of `λᵀ x⁺` by state and inputs, with `x⁺` the state after a step
/// ([`transition`](super::transition)): `(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂u, ∂²/∂v∂u, ∂²/∂u∂u)`, exact to rounding. The factors
/// are those of the configuration and of the velocity after the step.
///
/// All coordinates of the mechanism are plain (`NQ` is `NV`: no ball and free joints), and it has no constraints; others do not
/// compile here.
///
/// ```
/// use linkwork::discrete;
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * y, second_derivatives)]
/// struct Pendulum {
///     #[body(mass = 2, com = -0.5 * y)]
///     bob: Body,
///     #[joint(ground -> bob, about = z)]
///     hinge: Pin,
///     #[acts(on = hinge)]
///     motor: Torque,
/// }
///
/// # fn main() -> Result<(), Error> {
/// let (method, q, v, u) = (SemiImplicitEuler::step(0.01), [0.3].into(), [0.0].into(), [0.1].into());
/// let (qq, ..) = discrete::second_order(&Pendulum {}, &method, 0.0, &q, &v, &u, (&[0.0].into(), &[1.0].into()))?;
/// // v⁺ = v − h g / l sin q + …
/// assert!((qq[0] - 0.01 * 9.81 / 0.5 * 0.3_f64.sin()).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// [`Error::InvalidStep`] for a period that is zero, negative or not finite, [`Error::NotFinite`] for a state that is not.
pub fn second_order<M, T, S, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    method: &S,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
    factors: (&SVector<T, NV>, &SVector<T, NV>),
) -> Result<InputSecondOrder<T, NV, NU>, Error>
where
    T: Real,
    M: RheonomicSecondDerivatives<NQ, NV, NU, Scalar = T>,
    S: TwiceDifferentiableStep<T>,
{
    const { assert!(!M::CONSTRAINED, "a step with derivatives is one of a mechanism without constraints") };
    const { assert!(NQ == NV, "a step with second derivatives is one in plain coordinates") };
    method.check()?;
    let found = method.differentiate_twice(mechanism, t, q, v, u, factors);
    let finite = found.0.iter().chain(found.2.iter()).chain(found.5.iter()).all(|x| x.is_finite());
    if finite { Ok(found) } else { Err(Error::NotFinite { t: crate::private::to_f64(t) }) }
}

/// A method whose steps have second derivatives.
pub trait TwiceDifferentiableStep<T: Real>: DifferentiableStep<T> {
    /// The second derivatives of a step of a mechanism with plain coordinates, without constraints.
    fn differentiate_twice<M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
        factors: (&SVector<T, NV>, &SVector<T, NV>),
    ) -> InputSecondOrder<T, NV, NU>
    where
        M: RheonomicSecondDerivatives<NQ, NV, NU, Scalar = T>;
}

impl<T: Real> TwiceDifferentiableStep<T> for SemiImplicitEuler<T> {
    fn differentiate_twice<M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
        (by_q, by_v): (&SVector<T, NV>, &SVector<T, NV>),
    ) -> InputSecondOrder<T, NV, NU>
    where
        M: RheonomicSecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        // q⁺ = q + h v⁺, v⁺ = v + h v̇.
        let h = self.length();
        at(mechanism, t).second_order_motion(q, v, u, &((by_v + by_q * h) * h))
    }
}

/// A stage of a step: where it is evaluated, and the acceleration there.
struct Stage<T, const NQ: usize, const NV: usize, const NU: usize> {
    after: T,
    q: (SVector<T, NQ>, Sensitive<T, NV, NU>),
    v: Sensitive<T, NV, NU>,
    motion: LinearMotion<T, NV, NU>,
}

impl<T: Real> TwiceDifferentiableStep<T> for Rk4<T> {
    fn differentiate_twice<M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
        (by_q, by_v): (&SVector<T, NV>, &SVector<T, NV>),
    ) -> InputSecondOrder<T, NV, NU>
    where
        M: RheonomicSecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        let (h, start) = (self.length(), Start { mechanism, t, q, u });
        let half = h * constant(0.5);
        let first = Sensitive::velocity(v);
        let begin = Stage::new(&start, T::zero(), start.here(), first);
        let next = |after: T, stage: &Stage<T, NQ, NV, NU>| {
            let v = first.plus(after, &stage.acceleration());
            Stage::new(&start, after, start.moved(&stage.v.scaled(after)), v)
        };
        let second = next(half, &begin);
        let third = next(half, &second);
        let fourth = next(h, &third);
        // Backwards: what the end takes of each stage's rates, and what later stages do.
        let (sixth, third_part) = (h / constant(6.0), h / constant(3.0));
        let mut sum = zeros();
        let (mut of_q, mut of_v) = (SVector::zeros(), SVector::zeros());
        for (stage, weight, reach) in [
            (&fourth, sixth, T::zero()),
            (&third, third_part, h),
            (&second, third_part, half),
            (&begin, sixth, half),
        ] {
            let (rate, acceleration) = (by_q * weight + of_q * reach, by_v * weight + of_v * reach);
            stage.add_curvature(&start, &acceleration, &mut sum);
            of_q = stage.motion.by_q.tr_mul(&acceleration);
            of_v = stage.motion.by_v.tr_mul(&acceleration) + rate;
        }
        sum
    }
}

fn zeros<T: Real, const NV: usize, const NU: usize>() -> InputSecondOrder<T, NV, NU> {
    let (state, mixed) = (SMatrix::zeros(), SMatrix::zeros());
    (state, state, state, mixed, mixed, SMatrix::zeros())
}

impl<T: Real, const NQ: usize, const NV: usize, const NU: usize> Stage<T, NQ, NV, NU> {
    fn new<M>(
        start: &Start<'_, M, T, NQ, NV, NU>,
        after: T,
        q: (SVector<T, NQ>, Sensitive<T, NV, NU>),
        v: Sensitive<T, NV, NU>,
    ) -> Self
    where
        M: RheonomicSecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        use crate::Derivatives;
        let now: At<'_, M, T> = at(start.mechanism, start.t + after);
        let motion = now.linear_motion(&q.0, &v.value, start.u);
        Self { after, q, v, motion }
    }

    /// The acceleration, and how it changes with the start of the step.
    fn acceleration(&self) -> Sensitive<T, NV, NU> {
        let LinearMotion { acceleration, by_q, by_v, by_u, .. } = &self.motion;
        let found = Sensitive::of(*acceleration, (by_q, &self.q.1), (by_v, &self.v));
        Sensitive { by_u: found.by_u + by_u, ..found }
    }

    /// Adds the second derivatives of `λᵀ v̇` at this stage, by the start of the step.
    fn add_curvature<M>(
        &self,
        start: &Start<'_, M, T, NQ, NV, NU>,
        lambda: &SVector<T, NV>,
        sum: &mut InputSecondOrder<T, NV, NU>,
    ) where
        M: RheonomicSecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        let now: At<'_, M, T> = at(start.mechanism, start.t + self.after);
        let (qq, qv, vv, qu, vu, uu) = now.second_order_motion(&self.q.0, &self.v.value, start.u, lambda);
        let (q, v) = (&self.q.1, &self.v);
        // Rows of H D, with D the derivatives of the stage by the start; inputs are the same in all stages.
        let rows = |by: &SMatrix<T, NV, NV>, velocity: &SMatrix<T, NV, NV>| {
            (qq * by + qv * velocity, qv.tr_mul(by) + vv * velocity)
        };
        let (q_by_q, v_by_q) = rows(&q.by_q, &v.by_q);
        let (q_by_v, v_by_v) = rows(&q.by_v, &v.by_v);
        let q_by_u = qq * q.by_u + qv * v.by_u + qu;
        let v_by_u = qv.tr_mul(&q.by_u) + vv * v.by_u + vu;
        let u_by_u = qu.tr_mul(&q.by_u) + vu.tr_mul(&v.by_u) + uu;
        sum.0 += q.by_q.tr_mul(&q_by_q) + v.by_q.tr_mul(&v_by_q);
        sum.1 += q.by_q.tr_mul(&q_by_v) + v.by_q.tr_mul(&v_by_v);
        sum.2 += q.by_v.tr_mul(&q_by_v) + v.by_v.tr_mul(&v_by_v);
        sum.3 += q.by_q.tr_mul(&q_by_u) + v.by_q.tr_mul(&v_by_u);
        sum.4 += q.by_v.tr_mul(&q_by_u) + v.by_v.tr_mul(&v_by_u);
        sum.5 += q.by_u.tr_mul(&q_by_u) + v.by_u.tr_mul(&v_by_u) + u_by_u;
    }
}
