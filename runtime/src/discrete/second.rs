//! Second derivatives of steps, contracted with factors: the curvature that differential dynamic programming
//! adds to the costs.

use super::curvature::{SecondOrderDisplacement, TwoVectorSecondDerivatives};
use super::explicit::{DifferentiatedStepStart, VectorWithDerivatives};
use super::{ConstrainedStepVisitor, DifferentiableStep, projection};
use crate::constraint::{ConstrainedSecondDerivatives, ConstraintError, CurvatureVisitor};
use crate::derivatives::LinearMotion;
use crate::integrate::{Error, Rk4, SemiImplicitEuler};
use crate::private::{constant, to_f64};
use crate::{At, Derivatives, InputSecondOrder, Real, SecondDerivatives, at};
use nalgebra::{SMatrix, SVector};

/// Returns the second derivatives of `λᵀ x⁺` with respect to state and inputs, with `x⁺` the state after a
/// step ([`transition`](super::transition)): `(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂u, ∂²/∂v∂u, ∂²/∂u∂u)`, exact
/// to rounding. `factors` multiply the configuration and the velocity after the step.
///
/// Displacements of ball and free joints are in body axes, before and after the step. A displacement `x` of
/// the state before the step displaces the state after it by `A x + ½ xᵀ H x`, as measured by
/// [`difference`](crate::Mechanism::difference). The function returns `H` contracted with the factors. The
/// cost-to-go of [`optimal`](crate::optimal) is a function of the same displacements. Mechanisms with
/// declared generalized speeds do not compile here. Under constraints only [`Rk4`] is supported, and the
/// derivatives are those of the whole step, including the final projection.
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
/// [`Error::InvalidStep`] for a period that is zero, negative or not finite, [`Error::NotFinite`] for a state
/// that is not, [`Error::Constraint`] where constraints lose rank or cannot be satisfied.
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
    M: SecondDerivatives<NQ, NV, NU, Scalar = T>,
    S: TwiceDifferentiableStep<T>,
{
    const {
        assert!(
            !M::SPEEDS,
            "a step with second derivatives needs joint velocities: displacements of declared speeds have \
             only first derivatives; declare no speeds, or take `transition`"
        );
        assert!(
            !M::CONTACTING,
            "a step with second derivatives needs a mechanism without contacts that open and close: ignore \
             them by `contact::apart`"
        );
        assert!(
            !M::CONSTRAINED || S::UNDER_CONSTRAINTS,
            "under constraints steps of this method have no second derivatives: take `Rk4`"
        );
    }
    method.check()?;
    let found = if M::CONSTRAINED {
        let undetermined = Error::Constraint { t: to_f64(t), reason: ConstraintError::Singular };
        let through =
            ConstrainedHessianArguments { through: ConstrainedStepVisitor { method, t, q, v, u }, factors };
        mechanism.visit_constraint_curvature(through).unwrap_or(Err(undetermined))?
    } else {
        method.differentiate_twice(mechanism, t, q, v, u, factors)
    };
    let finite = found.0.iter().chain(found.2.iter()).chain(found.5.iter()).all(|x| x.is_finite());
    if finite { Ok(found) } else { Err(Error::NotFinite { t: to_f64(t) }) }
}

/// Arguments of a step with constraints, and the factors of the state after it in the contracted second
/// derivatives.
struct ConstrainedHessianArguments<'a, S, T, const NQ: usize, const NV: usize, const NU: usize> {
    through: ConstrainedStepVisitor<'a, S, T, NQ, NV, NU>,
    factors: (&'a SVector<T, NV>, &'a SVector<T, NV>),
}

impl<S, T, const NQ: usize, const NV: usize, const NU: usize> CurvatureVisitor<T, NQ, NV, NU>
    for ConstrainedHessianArguments<'_, S, T, NQ, NV, NU>
where
    T: Real,
    S: TwiceDifferentiableStep<T>,
{
    type Output = Result<InputSecondOrder<T, NV, NU>, Error>;

    /// Adds the curvature of the projection, along the Jacobians of the unprojected step, to the curvature of
    /// that step.
    fn visit<M, const NH: usize, const NC: usize>(self, mechanism: &M) -> Self::Output
    where
        M: ConstrainedSecondDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        let ConstrainedStepVisitor { method, t, q, v, u } = self.through;
        let free = method.differentiate_step(mechanism, t, q, v, u)?;
        let end = t + method.step_length();
        let added = projection::curvature_of_projection(mechanism, end, (&free.q, &free.v), self.factors)?;
        let mut sum =
            method.differentiate_twice(mechanism, t, q, v, u, (&added.gradient.0, &added.gradient.1));
        let new_vector_with_derivatives =
            |value, by_q, by_v, by_u| VectorWithDerivatives { value, by_q, by_v, by_u };
        let displacement =
            new_vector_with_derivatives(SVector::zeros(), free.q_by_q, free.q_by_v, free.q_by_u);
        let velocity = new_vector_with_derivatives(free.v, free.v_by_q, free.v_by_v, free.v_by_u);
        added.second.add_second_derivatives_to(&mut sum, &displacement, &velocity);
        Ok(sum)
    }
}

/// Integration methods for whose steps second derivatives are available.
#[diagnostic::on_unimplemented(
    message = "steps of `{Self}` have no second derivatives",
    note = "those of `Rk4` and `SemiImplicitEuler` have"
)]
pub trait TwiceDifferentiableStep<T: Real>: DifferentiableStep<T> {
    /// Whether constrained steps have second derivatives. They do if the method takes an unconstrained step
    /// and projects its end onto the constraints.
    const UNDER_CONSTRAINTS: bool;

    /// Returns the second derivatives of a step before its projection onto constraints.
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
        M: SecondDerivatives<NQ, NV, NU, Scalar = T>;
}

impl<T: Real> TwiceDifferentiableStep<T> for SemiImplicitEuler<T> {
    const UNDER_CONSTRAINTS: bool = false;

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
        M: SecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        // q⁺ = q ⊕ h v⁺, v⁺ = v + h v̇.
        let (h, now) = (self.nominal_step_length(), at(mechanism, t));
        if NQ == NV {
            return now.second_order_motion(q, v, u, &((by_v + by_q * h) * h));
        }
        let motion = Derivatives::linear_motion(&now, q, v, u);
        let first = VectorWithDerivatives::start_velocity_with_derivatives(v);
        let change = VectorWithDerivatives {
            value: motion.acceleration,
            by_q: motion.by_q,
            by_v: motion.by_v,
            by_u: motion.by_u,
        };
        let displacement = first.plus_scaled(h, &change).scaled_with_derivatives(h);
        let moved = SecondOrderDisplacement::new(mechanism, &displacement.value);
        let of_displacement = moved.by_dv.tr_mul(by_q);
        let mut sum = now.second_order_motion(q, v, u, &((by_v + of_displacement * h) * h));
        moved.curvature_of_displacement(mechanism, by_q).add_second_derivatives_to(
            &mut sum,
            &VectorWithDerivatives::zero_displacement_with_derivatives(),
            &displacement,
        );
        sum
    }
}

/// Stage of a step: its time and displacement after the start, the state of evaluation, and the linearised
/// motion in that state.
struct DifferentiatedStage<T, const NQ: usize, const NV: usize, const NU: usize> {
    after: T,
    displacement: VectorWithDerivatives<T, NV, NU>,
    q: (SVector<T, NQ>, VectorWithDerivatives<T, NV, NU>),
    v: VectorWithDerivatives<T, NV, NU>,
    motion: LinearMotion<T, NV, NU>,
}

impl<T: Real> TwiceDifferentiableStep<T> for Rk4<T> {
    const UNDER_CONSTRAINTS: bool = true;

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
        M: SecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        let (h, start) = (self.nominal_step_length(), DifferentiatedStepStart { mechanism, t, q, u });
        let half = h * constant(0.5);
        let first = VectorWithDerivatives::start_velocity_with_derivatives(v);
        let begin =
            DifferentiatedStage::new(&start, T::zero(), first.scaled_with_derivatives(T::zero()), first);
        let next_stage = |after: T, stage: &DifferentiatedStage<T, NQ, NV, NU>| {
            let v = first.plus_scaled(after, &stage.stage_acceleration());
            DifferentiatedStage::new(
                &start,
                after,
                stage.displacement_rate(&start).scaled_with_derivatives(after),
                v,
            )
        };
        let second = next_stage(half, &begin);
        let third = next_stage(half, &second);
        let fourth = next_stage(h, &third);
        let (sixth, third_part) = (h / constant(6.0), h / constant(3.0));
        let mut sum = zero_second_order();
        let mut of_end = *by_q;
        if NQ != NV {
            let two = constant::<T>(2.0);
            let [k1, k2, k3, k4] =
                [&begin, &second, &third, &fourth].map(|stage| stage.displacement_rate(&start));
            let displacement = k1
                .plus_scaled(two, &k2)
                .plus_scaled(two, &k3)
                .plus_scaled(T::one(), &k4)
                .scaled_with_derivatives(sixth);
            of_end = add_displacement_second_derivatives(mechanism, &displacement, by_q, &mut sum);
        }
        // Backwards: factors of each stage's rates, from the end of the step and from later stages.
        let (mut of_displacement, mut of_v) = (SVector::zeros(), SVector::zeros());
        for (stage, weight, reach) in [
            (&fourth, sixth, T::zero()),
            (&third, third_part, h),
            (&second, third_part, half),
            (&begin, sixth, half),
        ] {
            let (rate, acceleration) =
                (of_end * weight + of_displacement * reach, by_v * weight + of_v * reach);
            stage.add_stage_second_derivatives(&start, &acceleration, &mut sum);
            of_displacement = stage.motion.by_q.tr_mul(&acceleration);
            of_v = stage.motion.by_v.tr_mul(&acceleration);
            if NQ == NV {
                of_v += rate;
                continue;
            }
            let (way, v) = (&stage.displacement, &stage.v);
            of_displacement = add_displacement_second_derivatives(mechanism, way, &of_displacement, &mut sum);
            let (by_way, by_v) = mechanism.tangent_rate_derivatives(&way.value, &v.value);
            of_displacement += by_way.tr_mul(&rate);
            of_v += by_v.tr_mul(&rate);
            let (twice, mixed) = mechanism.tangent_rate_second_derivatives(&way.value, &v.value, &rate);
            TwoVectorSecondDerivatives { first: Some(twice), mixed, second: None }
                .add_second_derivatives_to(&mut sum, way, v);
        }
        sum
    }
}

/// Adds the second derivatives of `λᵀ ξ`, with `ξ` the motion of a configuration displaced from the start.
/// Returns the gradient with respect to the displacement.
fn add_displacement_second_derivatives<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    displacement: &VectorWithDerivatives<T, NV, NU>,
    lambda: &SVector<T, NV>,
    sum: &mut InputSecondOrder<T, NV, NU>,
) -> SVector<T, NV>
where
    T: Real,
    M: SecondDerivatives<NQ, NV, NU, Scalar = T>,
{
    let moved = SecondOrderDisplacement::new(mechanism, &displacement.value);
    moved.curvature_of_displacement(mechanism, lambda).add_second_derivatives_to(
        sum,
        &VectorWithDerivatives::zero_displacement_with_derivatives(),
        displacement,
    );
    moved.by_dv.tr_mul(lambda)
}

fn zero_second_order<T: Real, const NV: usize, const NU: usize>() -> InputSecondOrder<T, NV, NU> {
    let (state, mixed) = (SMatrix::zeros(), SMatrix::zeros());
    (state, state, state, mixed, mixed, SMatrix::zeros())
}

impl<T: Real, const NQ: usize, const NV: usize, const NU: usize> DifferentiatedStage<T, NQ, NV, NU> {
    fn new<M>(
        start: &DifferentiatedStepStart<'_, M, T, NQ, NV, NU>,
        after: T,
        displacement: VectorWithDerivatives<T, NV, NU>,
        v: VectorWithDerivatives<T, NV, NU>,
    ) -> Self
    where
        M: SecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        let (now, q): (At<'_, M, T>, _) =
            (at(start.mechanism, start.t + after), start.displace_configuration(&displacement));
        let motion = now.linear_motion(&q.0, &v.value, start.u);
        Self { after, displacement, q, v, motion }
    }

    /// Returns the rate of displacements from the start, with its derivatives with respect to the start of
    /// the step.
    fn displacement_rate<M>(
        &self,
        start: &DifferentiatedStepStart<'_, M, T, NQ, NV, NU>,
    ) -> VectorWithDerivatives<T, NV, NU>
    where
        M: SecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        if NQ == NV {
            return self.v;
        }
        let (way, v) = (&self.displacement, &self.v);
        let (by_way, by_v) = start.mechanism.tangent_rate_derivatives(&way.value, &v.value);
        let value = start.mechanism.tangent_rate(&way.value, &v.value);
        VectorWithDerivatives::compose_derivatives(value, (&by_way, way), (&by_v, v))
    }

    /// Returns the acceleration, with its derivatives with respect to the start of the step.
    fn stage_acceleration(&self) -> VectorWithDerivatives<T, NV, NU> {
        let LinearMotion { acceleration, by_q, by_v, by_u, .. } = &self.motion;
        let found =
            VectorWithDerivatives::compose_derivatives(*acceleration, (by_q, &self.q.1), (by_v, &self.v));
        VectorWithDerivatives { by_u: found.by_u + by_u, ..found }
    }

    /// Adds the second derivatives of `λᵀ v̇` at this stage with respect to the start of the step.
    fn add_stage_second_derivatives<M>(
        &self,
        start: &DifferentiatedStepStart<'_, M, T, NQ, NV, NU>,
        lambda: &SVector<T, NV>,
        sum: &mut InputSecondOrder<T, NV, NU>,
    ) where
        M: SecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        let now: At<'_, M, T> = at(start.mechanism, start.t + self.after);
        let (qq, qv, vv, qu, vu, uu) = now.second_order_motion(&self.q.0, &self.v.value, start.u, lambda);
        // Inputs are the same in all stages.
        let (q, v) = (&self.q.1, &self.v);
        sum.3 += q.by_q.tr_mul(&qu) + v.by_q.tr_mul(&vu);
        sum.4 += q.by_v.tr_mul(&qu) + v.by_v.tr_mul(&vu);
        let crossed = qu.tr_mul(&q.by_u) + vu.tr_mul(&v.by_u);
        sum.5 += crossed + crossed.transpose() + uu;
        TwoVectorSecondDerivatives { first: Some(qq), mixed: qv, second: Some(vv) }
            .add_second_derivatives_to(sum, q, v);
    }
}
