//! Jacobians of explicit integration steps, computed by propagating derivatives forwards through the stages.

use super::{ConfigurationVelocityRelation, DifferentiableStep, Transition, implicit, plain};
use crate::Real;
use crate::blocks::{
    NearlyIdentity, add_multiple, add_product, product, scale, write_multiple, write_scaled_sum, zeros,
};
use crate::constraint::ConstrainedDerivatives;
use crate::derivatives::{Derivatives, write_acceleration_derivatives};
use crate::integrate::{Error, Rk4, SemiImplicitEuler};
use crate::private::constant;
use nalgebra::{SMatrix, SVector};

/// Vector of the tangent space with its derivatives with respect to the state at the start of a step and to
/// the inputs.
#[derive(Clone, Copy)]
pub(crate) struct VectorWithDerivatives<T, const NV: usize, const NU: usize> {
    pub(crate) value: SVector<T, NV>,
    pub(crate) by_q: SMatrix<T, NV, NV>,
    pub(crate) by_v: SMatrix<T, NV, NV>,
    pub(crate) by_u: SMatrix<T, NV, NU>,
}

impl<T: Real, const NV: usize, const NU: usize> VectorWithDerivatives<T, NV, NU> {
    /// Returns the velocity at the start of the step, with its derivatives: the identity with respect to
    /// itself, otherwise zero.
    pub(crate) fn start_velocity_with_derivatives(v: &SVector<T, NV>) -> Self {
        let (by_q, by_u) = (SMatrix::zeros(), SMatrix::zeros());
        Self { value: *v, by_q, by_v: SMatrix::identity(), by_u }
    }

    /// Returns the zero displacement of the configuration at the start, which moves with that configuration.
    pub(crate) fn zero_displacement_with_derivatives() -> Self {
        let (by_v, by_u) = (SMatrix::zeros(), SMatrix::zeros());
        Self { value: SVector::zeros(), by_q: SMatrix::identity(), by_v, by_u }
    }

    /// Returns the vector `self + s other` together with its derivatives.
    pub(crate) fn plus_scaled(&self, s: T, other: &Self) -> Self {
        let mut sum =
            Self { value: self.value + other.value * s, by_q: zeros(), by_v: zeros(), by_u: zeros() };
        write_scaled_sum(&self.by_q, s, &other.by_q, &mut sum.by_q);
        write_scaled_sum(&self.by_v, s, &other.by_v, &mut sum.by_v);
        write_scaled_sum(&self.by_u, s, &other.by_u, &mut sum.by_u);
        sum
    }

    /// Adds `s other` to the vector, with its derivatives.
    pub(crate) fn add_scaled(&mut self, s: T, other: &Self) {
        self.value += other.value * s;
        add_multiple(&mut self.by_q, s, &other.by_q);
        add_multiple(&mut self.by_v, s, &other.by_v);
        add_multiple(&mut self.by_u, s, &other.by_u);
    }

    pub(crate) fn scaled_with_derivatives(&self, s: T) -> Self {
        let mut multiple = Self { value: self.value * s, by_q: zeros(), by_v: zeros(), by_u: zeros() };
        write_multiple(s, &self.by_q, &mut multiple.by_q);
        write_multiple(s, &self.by_v, &mut multiple.by_v);
        write_multiple(s, &self.by_u, &mut multiple.by_u);
        multiple
    }

    /// Returns a function of two vectors with derivatives, by the chain rule; `by_a` and `by_b` are the
    /// Jacobians of the function.
    pub(crate) fn compose_derivatives(
        value: SVector<T, NV>,
        (by_a, a): (&SMatrix<T, NV, NV>, &Self),
        (by_b, b): (&SMatrix<T, NV, NV>, &Self),
    ) -> Self {
        let mut sum = Self { value, by_q: zeros(), by_v: zeros(), by_u: zeros() };
        for (by, part) in [(by_a, a), (by_b, b)] {
            add_product(&mut sum.by_q, by, &part.by_q);
            add_product(&mut sum.by_v, by, &part.by_v);
            add_product(&mut sum.by_u, by, &part.by_u);
        }
        sum
    }
}

/// Returns the displacement and the change of the velocity in a Runge–Kutta step of `h` seconds: weighted
/// means of the rates at its four stages, formed by the given sum and multiple.
pub(super) fn runge_kutta_change<T: Real, V>(
    h: T,
    [k1, k2, k3, k4]: [&(V, V); 4],
    plus_scaled: impl Fn(&V, T, &V) -> V,
    scaled: impl Fn(&V, T) -> V,
) -> (V, V) {
    let (two, sixth) = (constant::<T>(2.0), h / constant(6.0));
    let weighted_stage_sum = |a: &V, b: &V, c: &V, d: &V| {
        scaled(&plus_scaled(&plus_scaled(&plus_scaled(a, two, b), two, c), T::one(), d), sixth)
    };
    (weighted_stage_sum(&k1.0, &k2.0, &k3.0, &k4.0), weighted_stage_sum(&k1.1, &k2.1, &k3.1, &k4.1))
}

/// Start of a step: mechanism, time, configuration and inputs.
pub(crate) struct DifferentiatedStepStart<'a, M, T, const NQ: usize, const NV: usize, const NU: usize> {
    pub(crate) mechanism: &'a M,
    pub(crate) t: T,
    pub(crate) q: &'a SVector<T, NQ>,
    pub(crate) u: &'a SVector<T, NU>,
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize> DifferentiatedStepStart<'_, M, T, NQ, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    /// Returns the configuration `q ⊕ displacement`, and the displacement of that configuration with
    /// derivatives with respect to the start and the inputs.
    pub(crate) fn displace_configuration(
        &self,
        displacement: &VectorWithDerivatives<T, NV, NU>,
    ) -> (SVector<T, NQ>, VectorWithDerivatives<T, NV, NU>) {
        let q = self.mechanism.integrate(self.q, &displacement.value);
        if self.mechanism.features().is_plain() {
            // In coordinates that are a vector space, displacements are added.
            let by_q = displacement.by_q + SMatrix::<T, NV, NV>::identity();
            return (q, VectorWithDerivatives { by_q, ..*displacement });
        }
        let (by_q, by_dv) = self.mechanism.integrate_derivatives_at(self.q, &displacement.value);
        if let Some(rotating) = M::TURNED {
            let (turning, mut motion) = (NearlyIdentity::with_range(&by_dv, rotating), *displacement);
            turning.left_multiply(&mut motion.by_q);
            turning.left_multiply(&mut motion.by_v);
            turning.left_multiply(&mut motion.by_u);
            add_multiple(&mut motion.by_q, T::one(), &by_q);
            return (q, motion);
        }
        let mut motion = VectorWithDerivatives {
            value: displacement.value,
            by_q,
            by_v: product(&by_dv, &displacement.by_v),
            by_u: product(&by_dv, &displacement.by_u),
        };
        add_product(&mut motion.by_q, &by_dv, &displacement.by_q);
        (q, motion)
    }

    /// Returns the acceleration at a time `h` after the start, with its derivatives with respect to the start
    /// of the step.
    pub(crate) fn acceleration_after_time(
        &self,
        h: T,
        (q, motion): &(SVector<T, NQ>, VectorWithDerivatives<T, NV, NU>),
        v: &VectorWithDerivatives<T, NV, NU>,
    ) -> VectorWithDerivatives<T, NV, NU> {
        let own = self.acceleration_with_derivatives(h, (q, &v.value));
        let mut found =
            VectorWithDerivatives::compose_derivatives(own.value, (&own.by_q, motion), (&own.by_v, v));
        add_multiple(&mut found.by_u, T::one(), &own.by_u);
        found
    }

    /// Returns the acceleration at a time `h` after the start, in a given state, with its derivatives with
    /// respect to that state and to the inputs.
    pub(crate) fn acceleration_with_derivatives(
        &self,
        h: T,
        state: (&SVector<T, NQ>, &SVector<T, NV>),
    ) -> VectorWithDerivatives<T, NV, NU> {
        let mut found = VectorWithDerivatives { value: zeros(), by_q: zeros(), by_v: zeros(), by_u: zeros() };
        let VectorWithDerivatives { value, by_q, by_v, by_u } = &mut found;
        *value =
            write_acceleration_derivatives(self.mechanism, self.t + h, state, self.u, (by_q, by_v, by_u));
        found
    }

    /// Returns the state after a step with a given displacement and final velocity.
    pub(crate) fn transition_at_step_end(
        &self,
        displacement: &VectorWithDerivatives<T, NV, NU>,
        v: &VectorWithDerivatives<T, NV, NU>,
    ) -> Transition<T, NQ, NV, NU> {
        Transition::from_differentiated_state(&self.displace_configuration(displacement), v)
    }

    /// Returns the configuration at the start; its derivative with respect to itself is the identity.
    pub(crate) fn start_configuration(&self) -> (SVector<T, NQ>, VectorWithDerivatives<T, NV, NU>) {
        (*self.q, VectorWithDerivatives::zero_displacement_with_derivatives())
    }
}

/// Writes a step of [`SemiImplicitEuler`] of `h` seconds, given the accelerations and their derivatives with
/// respect to configuration, velocity and inputs. It serves mechanisms whose contacts are enforced as
/// bilateral constraints: [`Holding::held_derivatives`](crate::contact::Holding::held_derivatives) returns
/// their accelerations together with the derivatives of the contact forces, which costs need and a step does
/// not return.
///
/// The step is not projected onto constraints.
pub fn semi_implicit_into<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    h: T,
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    acceleration: &SVector<T, NV>,
    (by_q, by_v, by_u): (&SMatrix<T, NV, NV>, &SMatrix<T, NV, NV>, &SMatrix<T, NV, NU>),
    into: &mut Transition<T, NQ, NV, NU>,
) where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    write_multiple(h, by_q, &mut into.v_by_q);
    write_multiple(h, by_v, &mut into.v_by_v);
    write_multiple(h, by_u, &mut into.v_by_u);
    complete_step_by_chain_rule(mechanism, h, (q, v), acceleration, into);
}

/// Completes a step whose derivatives of the change of velocity are already in `step`.
fn complete_step_by_chain_rule<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    h: T,
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    acceleration: &SVector<T, NV>,
    step: &mut Transition<T, NQ, NV, NU>,
) where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    for (j, column) in step.v_by_v.data.0.iter_mut().enumerate() {
        column.iter_mut().skip(j).take(1).for_each(|x| *x += T::one());
    }
    step.v = v + acceleration * h;
    let displacement = step.v * h;
    step.q = mechanism.integrate(q, &displacement);
    // q ⊕ h v⁺; in coordinates that are a vector space, displacements are added.
    let is_plain = mechanism.features().is_plain();
    let (by_q, by_displacement) = match is_plain {
        true => (SMatrix::identity(), SMatrix::identity()),
        false => mechanism.integrate_derivatives_at(q, &displacement),
    };
    let others = if is_plain { Some((0, 0)) } else { M::TURNED };
    let Transition { v_by_q, v_by_v, v_by_u, q_by_q, q_by_v, q_by_u, chained, .. } = step;
    let chain = chained.insert(match others {
        Some(others) => {
            ConfigurationVelocityRelation { period: h, by_q, by_displacement, others: [others; 2] }
        }
        None => ConfigurationVelocityRelation::new(h, by_q, by_displacement),
    });
    let [_, d] = chain.nearly_identity_matrices();
    d.write_scaled_left_product(h, v_by_q, q_by_q);
    d.write_scaled_left_product(h, v_by_v, q_by_v);
    d.write_scaled_left_product(h, v_by_u, q_by_u);
    add_multiple(q_by_q, T::one(), &chain.by_q);
}

impl<T: Real> DifferentiableStep<T> for SemiImplicitEuler<T> {
    const IN_MOMENTA: [bool; 2] = [false, true];

    fn step_length(&self) -> T {
        self.nominal_step_length()
    }

    fn differentiate_into<M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
        step: &mut Transition<T, NQ, NV, NU>,
    ) -> Result<(), Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let h = self.nominal_step_length();
        let Transition { v_by_q, v_by_v, v_by_u, .. } = &mut *step;
        (*v_by_q, *v_by_v) = (zeros(), zeros());
        let acceleration = write_acceleration_derivatives(mechanism, t, (q, v), u, (v_by_q, v_by_v, v_by_u));
        scale(v_by_q, h);
        scale(v_by_v, h);
        scale(v_by_u, h);
        complete_step_by_chain_rule(mechanism, h, (q, v), &acceleration, step);
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
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
    ) -> Result<Transition<T, NQ, NV, NU>, Error>
    where
        M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        implicit::constrained_semi_implicit_transition(self, mechanism, t, q, v, u)
    }
}

impl<T: Real> DifferentiableStep<T> for Rk4<T> {
    const IN_MOMENTA: [bool; 2] = [false; 2];

    fn step_length(&self) -> T {
        self.nominal_step_length()
    }

    fn differentiate_into<M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
        into: &mut Transition<T, NQ, NV, NU>,
    ) -> Result<(), Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let (h, start) = (self.nominal_step_length(), DifferentiatedStepStart { mechanism, t, q, u });
        if mechanism.features().is_plain() {
            *into = plain::runge_kutta_transition(&start, v, h);
            return Ok(());
        }
        let v = VectorWithDerivatives::start_velocity_with_derivatives(v);
        let stage_rates_with_derivatives = |h: T,
                                            (rate, acceleration): &(
            VectorWithDerivatives<T, NV, NU>,
            VectorWithDerivatives<T, NV, NU>,
        )| {
            let (displacement, v) = (rate.scaled_with_derivatives(h), v.plus_scaled(h, acceleration));
            let (by_q, by_dv, by_v) =
                mechanism.displacement_rate_derivatives(q, &displacement.value, &v.value);
            let value = mechanism.displacement_rate(q, &displacement.value, &v.value);
            let mut rate =
                VectorWithDerivatives::compose_derivatives(value, (&by_dv, &displacement), (&by_v, &v));
            if mechanism.features().speeds {
                rate.by_q += by_q;
            }
            (rate, start.acceleration_after_time(h, &start.displace_configuration(&displacement), &v))
        };
        let half = h * constant(0.5);
        let k1 = (v, start.acceleration_after_time(T::zero(), &start.start_configuration(), &v));
        let k2 = stage_rates_with_derivatives(half, &k1);
        let k3 = stage_rates_with_derivatives(half, &k2);
        let k4 = stage_rates_with_derivatives(h, &k3);
        let (displacement, change) = runge_kutta_change(
            h,
            [&k1, &k2, &k3, &k4],
            VectorWithDerivatives::plus_scaled,
            VectorWithDerivatives::scaled_with_derivatives,
        );
        *into = start.transition_at_step_end(&displacement, &v.plus_scaled(T::one(), &change));
        Ok(())
    }
}
