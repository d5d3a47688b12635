//! Derivatives of steps with respect to the parameters of a mechanism.

use super::explicit::runge_kutta_change;
use super::{DifferentiableStep, FixedStep, Transition};
use crate::blocks::{add_product, product};
use crate::contact::ParametersAsInputs;
use crate::integrate::{Error, Rk4, SemiImplicitEuler, TimeStepping};
use crate::private::{constant, to_f64};
use crate::{Derivatives, Real, Sensitivities, at};
use nalgebra::{SMatrix, SVector};

/// Returns the derivatives of configuration and velocity after a step with respect to the parameters,
/// `(∂q⁺/∂p, ∂v⁺/∂p)`, with one column for each of [`PARAMETERS`](Sensitivities::PARAMETERS), exact to
/// rounding. The step is that of [`transition`](super::transition), which returns the Jacobians with respect
/// to state and inputs. Changes of the configuration are displacements, in body axes for ball and free
/// joints. Parameter estimation and design optimisation over many steps accumulate `x_p⁺ = A x_p + ∂x⁺/∂p`.
///
/// The mechanism has the options `derivatives` and `sensitivities`, and no constraints.
///
/// Steps of [`TimeStepping`] of a mechanism with [contacts](crate::contact) are differentiated in the contact
/// modes that the step has found, as [`transition`](super::transition) does. Parameters are masses, sizes of
/// bodies and of surfaces, heights of the ground, coefficients of friction and restitution, and all others.
/// Derivatives are one-sided where modes change: for a coefficient of restitution of zero towards positive
/// values. A coefficient of friction of zero stays zero, so that its derivative is zero; identification
/// begins at a positive value. Coefficients of static friction affect modes only.
///
/// ```
/// use linkwork::discrete;
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * y, derivatives, sensitivities)]
/// struct Pendulum {
///     length: f64,
///     #[body(mass = 2, com = -length * y)]
///     bob: Body,
///     #[joint(ground -> bob, about = z)]
///     hinge: Pin,
///     #[acts(on = hinge)]
///     motor: Torque,
/// }
///
/// # fn main() -> Result<(), Error> {
/// let (method, q, v, u) = (SemiImplicitEuler::step(0.01), [0.3].into(), [0.0].into(), [0.0].into());
/// let (_, by_length) = discrete::by_parameters(&Pendulum { length: 0.5 }, &method, 0.0, &q, &v, &u)?;
/// // v⁺ = −h g / l sin q.
/// assert!((by_length[0] - 0.01 * 9.81 / 0.25 * 0.3_f64.sin()).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// ```
/// use linkwork::discrete;
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * z, derivatives, sensitivities)]
/// struct Block {
///     friction: f64,
///     #[body(mass = 2)]
///     block: Body,
///     #[joint(ground -> block, along = (x, z))]
///     place: Stage,
///     #[contact(block, ground.plane(z), friction = friction)]
///     foot: Contact,
/// }
///
/// # fn main() -> Result<(), Error> {
/// let (method, q, v) = (TimeStepping::step(0.01), [0.0, 0.0].into(), [1.0, 0.0].into());
/// let (_, by_friction) =
///     discrete::by_parameters(&Block { friction: 0.3 }, &method, 0.0, &q, &v, &[].into())?;
/// // v⁺ = v − μ g h while the block slides.
/// assert!((by_friction[0] + 9.81 * 0.01).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// [`Error::InvalidStep`] for a period that is zero, negative or not finite, [`Error::NotFinite`] for a state
/// that is not; with contacts the errors of [`transition`](super::transition).
#[allow(clippy::type_complexity, reason = "two matrices")]
pub fn by_parameters<M, T, S, const NQ: usize, const NV: usize, const NU: usize, const NP: usize>(
    mechanism: &M,
    method: &S,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
) -> Result<(SMatrix<T, NV, NP>, SMatrix<T, NV, NP>), Error>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T> + Sensitivities<NQ, NV, NU, NP, Scalar = T>,
    S: StepByParameters<T>,
{
    const {
        assert!(
            !M::CONSTRAINED,
            "a step with derivatives with respect to parameters needs a mechanism without constraints"
        );
        assert!(
            !M::CONTACTING || S::CONTACTS,
            "a step with derivatives with respect to parameters of a mechanism with contacts that open and \
             close needs the method `TimeStepping`"
        );
        assert!(
            !M::CONTACTING || M::LOCATABLE && !M::SPEEDS,
            "a step with derivatives with respect to parameters of a mechanism with contacts that open and \
             close needs a mechanism without declared speeds and states of first order"
        );
    }
    method.check()?;
    let (by_q, by_v) = method.differentiate_by_parameters(mechanism, t, (q, v), u)?;
    let finite = by_q.iter().chain(by_v.iter()).all(|x| x.is_finite());
    if finite { Ok((by_q, by_v)) } else { Err(Error::NotFinite { t: to_f64(t) }) }
}

/// Methods whose steps have derivatives with respect to parameters.
#[diagnostic::on_unimplemented(
    message = "steps of `{Self}` have no derivatives by parameters",
    note = "those of `Rk4`, `SemiImplicitEuler` and `TimeStepping` have"
)]
pub trait StepByParameters<T: Real>: FixedStep<T> {
    /// Returns the derivatives of a step of a mechanism without constraints; called by [`by_parameters`].
    ///
    /// # Errors
    ///
    /// The errors of [`transition`](super::transition).
    #[allow(clippy::type_complexity, reason = "two matrices")]
    fn differentiate_by_parameters<M, const NQ: usize, const NV: usize, const NU: usize, const NP: usize>(
        &self,
        mechanism: &M,
        t: T,
        state: (&SVector<T, NQ>, &SVector<T, NV>),
        u: &SVector<T, NU>,
    ) -> Result<(SMatrix<T, NV, NP>, SMatrix<T, NV, NP>), Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T> + Sensitivities<NQ, NV, NU, NP, Scalar = T>;
}

/// Vector of the tangent space with its derivatives with respect to the parameters.
#[derive(Clone, Copy)]
struct VectorWithParameterDerivatives<T, const NV: usize, const NP: usize> {
    value: SVector<T, NV>,
    by: SMatrix<T, NV, NP>,
}

impl<T: Real, const NV: usize, const NP: usize> VectorWithParameterDerivatives<T, NV, NP> {
    fn parameter_independent(value: &SVector<T, NV>) -> Self {
        Self { value: *value, by: SMatrix::zeros() }
    }

    /// Returns the vector `self + s other` together with its parameter derivatives.
    fn plus_scaled(&self, s: T, other: &Self) -> Self {
        Self { value: self.value + other.value * s, by: self.by + other.by * s }
    }

    fn scaled_with_derivatives(&self, s: T) -> Self {
        Self { value: self.value * s, by: self.by * s }
    }
}

/// Returns the acceleration with its parameter derivatives at a stage of a step: `h` seconds after the start
/// at time `t` with the configuration `q`, for a displacement and a velocity.
fn acceleration_at_stage<M, T, const NQ: usize, const NV: usize, const NU: usize, const NP: usize>(
    m: &M,
    t: T,
    (q, displacement): (&SVector<T, NQ>, &VectorWithParameterDerivatives<T, NV, NP>),
    v: &VectorWithParameterDerivatives<T, NV, NP>,
    u: &SVector<T, NU>,
) -> VectorWithParameterDerivatives<T, NV, NP>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T> + Sensitivities<NQ, NV, NU, NP, Scalar = T>,
{
    let here = m.integrate(q, &displacement.value);
    let derivatives = configuration_derivatives(m, q, displacement);
    let motion = at(m, t).linear_motion(&here, &v.value, u);
    let tau = m.generalized_forces(t, &here, &v.value, u);
    let mut by = m.forward_dynamics_by_parameters(t, &here, &v.value, &tau);
    let pushes = m.generalized_forces_by_parameters(t, &here, &v.value, u);
    if pushes.iter().any(|x| *x != T::zero()) {
        let (.., inverse) = m.forward_dynamics_derivatives(t, &here, &v.value, &tau);
        add_product(&mut by, &inverse, &pushes);
    }
    add_product(&mut by, &motion.by_q, &derivatives);
    add_product(&mut by, &motion.by_v, &v.by);
    VectorWithParameterDerivatives { value: motion.acceleration, by }
}

/// Returns the derivatives of the configuration after a displacement with respect to the parameters.
fn configuration_derivatives<M, T, const NQ: usize, const NV: usize, const NU: usize, const NP: usize>(
    m: &M,
    q: &SVector<T, NQ>,
    displacement: &VectorWithParameterDerivatives<T, NV, NP>,
) -> SMatrix<T, NV, NP>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    if NQ == NV && !M::SPEEDS {
        displacement.by
    } else {
        product(&m.integrate_derivatives_at(q, &displacement.value).1, &displacement.by)
    }
}

impl<T: Real> StepByParameters<T> for SemiImplicitEuler<T> {
    fn differentiate_by_parameters<M, const NQ: usize, const NV: usize, const NU: usize, const NP: usize>(
        &self,
        m: &M,
        t: T,
        (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
        u: &SVector<T, NU>,
    ) -> Result<(SMatrix<T, NV, NP>, SMatrix<T, NV, NP>), Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T> + Sensitivities<NQ, NV, NU, NP, Scalar = T>,
    {
        let (h, v) = (self.nominal_step_length(), VectorWithParameterDerivatives::parameter_independent(v));
        let after = v.plus_scaled(
            h,
            &acceleration_at_stage(
                m,
                t,
                (q, &VectorWithParameterDerivatives::parameter_independent(&SVector::zeros())),
                &v,
                u,
            ),
        );
        Ok((configuration_derivatives(m, q, &after.scaled_with_derivatives(h)), after.by))
    }
}

impl<T: Real> StepByParameters<T> for Rk4<T> {
    fn differentiate_by_parameters<M, const NQ: usize, const NV: usize, const NU: usize, const NP: usize>(
        &self,
        m: &M,
        t: T,
        (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
        u: &SVector<T, NU>,
    ) -> Result<(SMatrix<T, NV, NP>, SMatrix<T, NV, NP>), Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T> + Sensitivities<NQ, NV, NU, NP, Scalar = T>,
    {
        let (h, v) = (self.nominal_step_length(), VectorWithParameterDerivatives::parameter_independent(v));
        let half = h * constant(0.5);
        let stage_rates_with_derivatives = |after: T,
                                            (rate, change): &(
            VectorWithParameterDerivatives<T, NV, NP>,
            VectorWithParameterDerivatives<T, NV, NP>,
        )| {
            let (displacement, v) = (rate.scaled_with_derivatives(after), v.plus_scaled(after, change));
            let (_, by_dv, by_v) = m.displacement_rate_derivatives(q, &displacement.value, &v.value);
            let value = m.displacement_rate(q, &displacement.value, &v.value);
            let mut by = product(&by_v, &v.by);
            add_product(&mut by, &by_dv, &displacement.by);
            (
                VectorWithParameterDerivatives { value, by },
                acceleration_at_stage(m, t + after, (q, &displacement), &v, u),
            )
        };
        let k1 = (
            v,
            acceleration_at_stage(
                m,
                t,
                (q, &VectorWithParameterDerivatives::parameter_independent(&SVector::zeros())),
                &v,
                u,
            ),
        );
        let k2 = stage_rates_with_derivatives(half, &k1);
        let k3 = stage_rates_with_derivatives(half, &k2);
        let k4 = stage_rates_with_derivatives(h, &k3);
        let (displacement, change) = runge_kutta_change(
            h,
            [&k1, &k2, &k3, &k4],
            VectorWithParameterDerivatives::plus_scaled,
            VectorWithParameterDerivatives::scaled_with_derivatives,
        );
        Ok((configuration_derivatives(m, q, &displacement), change.by))
    }
}

impl<T: Real> StepByParameters<T> for TimeStepping<T> {
    fn differentiate_by_parameters<M, const NQ: usize, const NV: usize, const NU: usize, const NP: usize>(
        &self,
        m: &M,
        t: T,
        (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
        u: &SVector<T, NU>,
    ) -> Result<(SMatrix<T, NV, NP>, SMatrix<T, NV, NP>), Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T> + Sensitivities<NQ, NV, NU, NP, Scalar = T>,
    {
        if let Some(found) = m.differentiate_contact_step_by_parameters(self, t, (q, v), u) {
            return found;
        }
        let mut step = Transition::<T, NQ, NV, NP>::zeros();
        let by_parameters = ParametersAsInputs { mechanism: m, u };
        self.differentiate_into(&by_parameters, t, q, v, &SVector::zeros(), &mut step)?;
        Ok((step.q_by_u, step.v_by_u))
    }
}
