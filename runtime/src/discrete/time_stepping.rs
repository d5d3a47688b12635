//! Derivatives of steps of [`TimeStepping`]: the motion without contact impulses at the end, and
//! displacements and transported velocities. Derivatives of the impulses are in `contact`.

use super::explicit::{DifferentiatedStart, VectorWithDerivatives};
use super::{DifferentiableStep, Transition, projected};
use crate::Real;
use crate::blocks::{NearlyIdentity, add_multiple, add_product, add_product_of_some, is_zero, scale, zeros};
use crate::constraint::{ConstrainedDerivatives, ConstraintError};
use crate::contact::{Contacts, Visitor};
use crate::derivatives::Derivatives;
use crate::integrate::{Error, TimeStepping};
use crate::private::{constant, to_f64};
use nalgebra::{SMatrix, SVector};

/// Configuration manifold of a mechanism.
#[derive(Clone, Copy)]
pub(crate) struct ConfigurationManifold<'a, M, const NV: usize> {
    mechanism: &'a M,
    /// Indices of all velocities, and the half-open range of those of ball and free joints.
    indices: [usize; NV],
    rotating: (usize, usize),
}

impl<'a, M, const NV: usize> ConfigurationManifold<'a, M, NV> {
    /// Returns the manifold of a mechanism.
    pub(crate) fn new<T: Real, const NQ: usize, const NU: usize>(mechanism: &'a M) -> Self
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let is_plain = mechanism.features().is_plain();
        let rotating = if is_plain { (0, 0) } else { M::TURNED.unwrap_or((0, NV)) };
        Self { mechanism, indices: core::array::from_fn(|i| i), rotating }
    }

    /// Whether no joint has rotating axes.
    fn has_fixed_axes(&self) -> bool {
        self.rotating.0 >= self.rotating.1
    }

    /// Returns the indices of the velocities of ball and free joints.
    fn rotating_indices(&self) -> &[usize] {
        self.indices.get(self.rotating.0..self.rotating.1).unwrap_or(&[])
    }

    /// Adds a matrix, which is zero outside of the rows and columns of ball and free joints, times the
    /// derivatives of a vector.
    fn add_mapped<T: Real, const NU: usize>(
        &self,
        sum: &mut VectorWithDerivatives<T, NV, NU>,
        by: &SMatrix<T, NV, NV>,
        of: &VectorWithDerivatives<T, NV, NU>,
    ) {
        let places = self.rotating_indices();
        add_product_of_some(&mut sum.by_q, places, by, &of.by_q);
        add_product_of_some(&mut sum.by_v, places, by, &of.by_v);
        if !is_zero(&of.by_u) {
            add_product_of_some(&mut sum.by_u, places, by, &of.by_u);
        }
    }

    /// Multiplies derivatives from the left by a matrix that is the identity outside of the rows and columns
    /// of ball and free joints.
    fn multiply_from_left<T: Real, const NU: usize>(
        &self,
        by: &SMatrix<T, NV, NV>,
        of: &mut VectorWithDerivatives<T, NV, NU>,
    ) {
        let by = NearlyIdentity::with_range(by, self.rotating);
        by.lead(&mut of.by_q);
        by.lead(&mut of.by_v);
        by.lead(&mut of.by_u);
    }

    /// Returns the derivatives of the displaced configuration with respect to the configuration before and to
    /// the displacement.
    fn displacement_derivatives<T: Real, const NQ: usize, const NU: usize>(
        &self,
        q: &SVector<T, NQ>,
        dv: &SVector<T, NV>,
    ) -> (SMatrix<T, NV, NV>, SMatrix<T, NV, NV>)
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        match self.has_fixed_axes() {
            true => (SMatrix::identity(), SMatrix::identity()),
            false => self.mechanism.integrate_derivatives_at(q, dv),
        }
    }

    /// Returns the configuration after a displacement, with derivatives. `motion` has the derivatives of the
    /// configuration before the displacement.
    pub(crate) fn displaced_configuration<T: Real, const NQ: usize, const NU: usize>(
        &self,
        (q, motion): (&SVector<T, NQ>, &VectorWithDerivatives<T, NV, NU>),
        by: &VectorWithDerivatives<T, NV, NU>,
    ) -> (SVector<T, NQ>, VectorWithDerivatives<T, NV, NU>)
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let to = self.mechanism.integrate(q, &by.value);
        if self.has_fixed_axes() {
            return (to, motion.plus_scaled(T::one(), by));
        }
        let (by_q, by_dv) = self.mechanism.integrate_derivatives_at(q, &by.value);
        let (mut turned, mut way) = (*motion, *by);
        self.multiply_from_left(&by_q, &mut turned);
        self.multiply_from_left(&by_dv, &mut way);
        (to, turned.plus_scaled(T::one(), &way))
    }

    /// Returns the velocity `v` at the configuration `q`, in the axes after a displacement `by`, with its
    /// derivatives ([`carry`](crate::integrate::Hooks::carry)). The derivatives of `q` do not affect it.
    pub(crate) fn transported_velocity<T: Real, const NQ: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        by: &VectorWithDerivatives<T, NV, NU>,
        v: &VectorWithDerivatives<T, NV, NU>,
    ) -> VectorWithDerivatives<T, NV, NU>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        if self.has_fixed_axes() {
            return *v;
        }
        let (_, by_dv) = self.mechanism.integrate_derivatives_at(q, &by.value);
        let mut end = *by;
        self.multiply_from_left(&by_dv, &mut end);
        self.transport_to_end(t, q, (&by.value, &end), v)
    }

    /// Returns a velocity in the axes after a displacement `dv` from `q`, with its derivatives. `end` has the
    /// derivatives of the displaced configuration relative to `q`.
    pub(crate) fn transport_to_end<T: Real, const NQ: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        (dv, end): (&SVector<T, NV>, &VectorWithDerivatives<T, NV, NU>),
        v: &VectorWithDerivatives<T, NV, NU>,
    ) -> VectorWithDerivatives<T, NV, NU>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        if self.has_fixed_axes() {
            return *v;
        }
        let m = self.mechanism;
        let value = m.carry(t, q, dv, &v.value);
        let mut carried = VectorWithDerivatives { value, ..*v };
        let unit =
            |k: usize, length: T| SVector::<T, NV>::from_fn(|i, _| if i == k { length } else { T::zero() });
        let (mut axes, mut rotation) = (SMatrix::<T, NV, NV>::identity(), SMatrix::<T, NV, NV>::zeros());
        let right_angle = constant::<T>(core::f64::consts::FRAC_PI_2);
        for k in self.rotating_indices() {
            if let Some(column) = axes.data.0.get_mut(*k) {
                *column = m.carry(t, q, dv, &unit(*k, T::one())).data.0[0];
            }
            // By Rodrigues' formula, half the difference of a vector rotated by right angles in both
            // directions is its cross product with the axis: the derivative of a rotation about it.
            let rotated_value = |angle: T| m.carry(t, q, &unit(*k, angle), &value);
            if let Some(column) = rotation.data.0.get_mut(*k) {
                *column = ((rotated_value(right_angle) - rotated_value(-right_angle)) * constant::<T>(0.5))
                    .data
                    .0[0];
            }
        }
        self.multiply_from_left(&axes, &mut carried);
        self.add_mapped(&mut carried, &rotation, end);
        carried
    }

    /// Returns the velocity `v` at the configuration `from`, in the axes of the configuration `to`, with its
    /// derivatives. `motion` has the derivatives of `to`; `from` is the start of the derivatives.
    pub(crate) fn transport_between<T: Real, const NQ: usize, const NU: usize>(
        &self,
        t: T,
        (from, v): (&SVector<T, NQ>, &VectorWithDerivatives<T, NV, NU>),
        (to, motion): (&SVector<T, NQ>, &VectorWithDerivatives<T, NV, NU>),
    ) -> VectorWithDerivatives<T, NV, NU>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        if self.has_fixed_axes() {
            return *v;
        }
        let way = self.mechanism.difference(from, to);
        let (by_q, _) = self.mechanism.integrate_derivatives_at(from, &way);
        let relative = VectorWithDerivatives { by_q: motion.by_q - by_q, ..*motion };
        self.transport_to_end(t, from, (&way, &relative), v)
    }
}

/// End of a step before the impulses of its contacts, with derivatives.
pub(crate) struct SmoothMotion<T, const NQ: usize, const NV: usize, const NU: usize> {
    pub(crate) q: (SVector<T, NQ>, VectorWithDerivatives<T, NV, NU>),
    /// Velocity at the end of the step, including the contribution of the assumed contact forces.
    pub(crate) v: VectorWithDerivatives<T, NV, NU>,
    /// Contribution of the assumed contact forces to the velocity.
    pub(crate) given: Option<VectorWithDerivatives<T, NV, NU>>,
}

/// Returns the motion in a step with the accelerations `before` at its start, under contact forces that add
/// `rate` to the velocity per second.
pub(crate) fn smooth_motion<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    method: &TimeStepping<T>,
    start: &DifferentiatedStart<'_, M, T, NQ, NV, NU>,
    v: &VectorWithDerivatives<T, NV, NU>,
    before: &VectorWithDerivatives<T, NV, NU>,
    rate: Option<&VectorWithDerivatives<T, NV, NU>>,
) -> SmoothMotion<T, NQ, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    match method.has_four_stages() {
        true => four_stage_motion(start, method.nominal_step_length(), v, before, rate),
        false => midpoint_motion(start, method.nominal_step_length(), v, before, rate),
    }
}

fn midpoint_motion<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    start: &DifferentiatedStart<'_, M, T, NQ, NV, NU>,
    h: T,
    v: &VectorWithDerivatives<T, NV, NU>,
    before: &VectorWithDerivatives<T, NV, NU>,
    rate: Option<&VectorWithDerivatives<T, NV, NU>>,
) -> SmoothMotion<T, NQ, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    let (half, manifold) = (h * constant(0.5), ConfigurationManifold::new(start.mechanism));
    let way = v.value * half;
    let q = start.mechanism.integrate(start.q, &way);
    let mean = rate.map_or(*before, |rate| before.plus_scaled(T::one(), rate));
    let mut change = start.acceleration_in_state(half, (&q, &(v.value + mean.value * half)));
    let (by_place, mut by_velocity) = (change.by_q, change.by_v);
    scale(&mut by_velocity, half);
    // Only the configuration and the velocity at the start move the middle.
    let (mut by_q, mut by_way) = (by_place, by_place);
    let mut motion = VectorWithDerivatives { value: way, by_q: zeros(), by_v: zeros(), by_u: zeros() };
    (motion.by_q, motion.by_v) = manifold.displacement_derivatives(start.q, &way);
    if !manifold.has_fixed_axes() {
        NearlyIdentity::with_range(&motion.by_q, manifold.rotating).follow(&mut by_q);
        NearlyIdentity::with_range(&motion.by_v, manifold.rotating).follow(&mut by_way);
    }
    scale(&mut motion.by_v, half);
    change.by_q = by_q;
    add_multiple(&mut change.by_v, half, &by_way);
    add_product(&mut change.by_q, &by_velocity, &mean.by_q);
    add_product(&mut change.by_v, &by_velocity, &mean.by_v);
    add_product(&mut change.by_u, &by_velocity, &mean.by_u);
    let carried_rate = |h: T| {
        rate.map(|rate| manifold.transported_velocity(start.t, start.q, &v.scaled_derivatives(h), rate))
    };
    if let Some(rate) = carried_rate(half) {
        change = change.plus_scaled(T::one(), &rate);
    }
    let end = v.plus_scaled(h, &change);
    let q = manifold.displaced_configuration((&q, &motion), &end.scaled_derivatives(half));
    SmoothMotion { q, v: end, given: carried_rate(h).map(|rate| rate.scaled_derivatives(h)) }
}

fn four_stage_motion<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    start: &DifferentiatedStart<'_, M, T, NQ, NV, NU>,
    h: T,
    v: &VectorWithDerivatives<T, NV, NU>,
    before: &VectorWithDerivatives<T, NV, NU>,
    rate: Option<&VectorWithDerivatives<T, NV, NU>>,
) -> SmoothMotion<T, NQ, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    type StageRates<T, const NV: usize, const NU: usize> =
        (VectorWithDerivatives<T, NV, NU>, VectorWithDerivatives<T, NV, NU>);
    let (half, manifold) = (h * constant(0.5), ConfigurationManifold::new(start.mechanism));
    let is_plain = start.mechanism.features().is_plain();
    let stage_state = |after: T, (rates, acceleration): &StageRates<T, NV, NU>| {
        let (way, v) = (rates.scaled_derivatives(after), v.plus_scaled(after, acceleration));
        let mut acceleration = start.acceleration_after(after, &start.displace_configuration(&way), &v);
        let carried = rate.map(|rate| manifold.transported_velocity(start.t, start.q, &way, rate));
        if let Some(carried) = &carried {
            acceleration = acceleration.plus_scaled(T::one(), carried);
        }
        if is_plain {
            return ((v, acceleration), carried);
        }
        let (_, by_dv, by_v) = start.mechanism.displacement_rate_derivatives(start.q, &way.value, &v.value);
        let value = start.mechanism.displacement_rate(start.q, &way.value, &v.value);
        (
            (VectorWithDerivatives::compose_derivatives(value, (&by_dv, &way), (&by_v, &v)), acceleration),
            carried,
        )
    };
    let k1 = (*v, rate.map_or(*before, |rate| before.plus_scaled(T::one(), rate)));
    let (k2, _) = stage_state(half, &k1);
    let (k3, _) = stage_state(half, &k2);
    let (k4, at_end) = stage_state(h, &k3);
    let (two, sixth) = (constant::<T>(2.0), h / constant(6.0));
    let way =
        k1.0.plus_scaled(two, &k2.0)
            .plus_scaled(two, &k3.0)
            .plus_scaled(T::one(), &k4.0)
            .scaled_derivatives(sixth);
    let change =
        k1.1.plus_scaled(two, &k2.1)
            .plus_scaled(two, &k3.1)
            .plus_scaled(T::one(), &k4.1)
            .scaled_derivatives(sixth);
    SmoothMotion {
        q: start.displace_configuration(&way),
        v: v.plus_scaled(T::one(), &change),
        given: at_end.map(|rate| rate.scaled_derivatives(h)),
    }
}

/// Arguments of a step of a mechanism with contacts.
struct ContactTransitionVisitor<'a, T, const NQ: usize, const NV: usize, const NU: usize> {
    method: &'a TimeStepping<T>,
    t: T,
    state: (&'a SVector<T, NQ>, &'a SVector<T, NV>),
    u: &'a SVector<T, NU>,
    into: &'a mut Transition<T, NQ, NV, NU>,
}

impl<T: Real, const NQ: usize, const NV: usize, const NU: usize> Visitor<T, NQ, NV, NU>
    for ContactTransitionVisitor<'_, T, NQ, NV, NU>
{
    type Output = Result<(), Error>;

    fn visit<M, const NK: usize, const NR: usize>(self, mechanism: &M) -> Self::Output
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let Self { method, t, state, u, into } = self;
        let constraint = M::CONTACTS.first().copied().unwrap_or_default();
        let absent =
            Error::Constraint { t: to_f64(t), reason: ConstraintError::NoDerivatives { constraint } };
        mechanism.differentiate_step(method, t, state, u, into).unwrap_or(Err(absent))
    }
}

impl<T: Real> DifferentiableStep<T> for TimeStepping<T> {
    const IN_MOMENTA: [bool; 2] = [false; 2];

    fn differentiate_step<M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
    ) -> Result<Transition<T, NQ, NV, NU>, Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let mut step = Transition::zeros();
        self.differentiate_into(mechanism, t, q, v, u, &mut step)?;
        Ok(step)
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
        let step = ContactTransitionVisitor { method: self, t, state: (q, v), u, into: &mut *into };
        if let Some(done) = mechanism.visit_contacts(step) {
            return done;
        }
        let (start, v) =
            (DifferentiatedStart { mechanism, t, q, u }, VectorWithDerivatives::start_velocity(v));
        let before = start.acceleration_in_state(T::zero(), (q, &v.value));
        let motion = smooth_motion(self, &start, &v, &before, None);
        *into = Transition::from_sensitive(&motion.q, &motion.v);
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
        projected::project_step(
            mechanism,
            t + self.nominal_step_length(),
            self.differentiate_step(mechanism, t, q, v, u)?,
        )
    }
}
