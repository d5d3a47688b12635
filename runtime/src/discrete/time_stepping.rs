//! Derivatives of steps of [`TimeStepping`]: the motion without contact impulses at the end, and
//! displacements and transported velocities. Derivatives of the impulses are in `contact`.

use super::explicit::{DifferentiatedStepStart, VectorWithDerivatives, runge_kutta_change};
use super::{DifferentiableStep, Transition};
use crate::Real;
use crate::blocks::{NearlyIdentity, add_product, add_product_of_some, is_zero, scale};
use crate::constraint::ConstraintError;
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
    fn ball_and_free_velocity_indices(&self) -> &[usize] {
        self.indices.get(self.rotating.0..self.rotating.1).unwrap_or(&[])
    }

    /// Adds a matrix, which is zero outside of the rows and columns of ball and free joints, times the
    /// derivatives of a vector.
    fn add_rotational_block_product<T: Real, const NU: usize>(
        &self,
        sum: &mut VectorWithDerivatives<T, NV, NU>,
        by: &SMatrix<T, NV, NV>,
        of: &VectorWithDerivatives<T, NV, NU>,
    ) {
        let places = self.ball_and_free_velocity_indices();
        add_product_of_some(&mut sum.by_q, places, by, &of.by_q);
        add_product_of_some(&mut sum.by_v, places, by, &of.by_v);
        if !is_zero(&of.by_u) {
            add_product_of_some(&mut sum.by_u, places, by, &of.by_u);
        }
    }

    /// Multiplies derivatives from the left by a matrix that is the identity outside of the rows and columns
    /// of ball and free joints.
    fn multiply_derivatives_from_left<T: Real, const NU: usize>(
        &self,
        by: &SMatrix<T, NV, NV>,
        of: &mut VectorWithDerivatives<T, NV, NU>,
    ) {
        let by = NearlyIdentity::with_range(by, self.rotating);
        by.lead(&mut of.by_q);
        by.lead(&mut of.by_v);
        by.lead(&mut of.by_u);
    }

    /// Returns a configuration after a displacement, with the derivatives of its motion. Those of the
    /// configuration before are `motion`.
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
        self.multiply_derivatives_from_left(&by_q, &mut turned);
        self.multiply_derivatives_from_left(&by_dv, &mut way);
        (to, turned.plus_scaled(T::one(), &way))
    }

    /// Returns [`displaced_configuration`](Self::displaced_configuration) for a displacement during which the
    /// origins of free bodies move along straight lines.
    fn displaced_along_straight_lines<T: Real, const NQ: usize, const NU: usize>(
        &self,
        t: T,
        from: (&SVector<T, NQ>, &VectorWithDerivatives<T, NV, NU>),
        by: &VectorWithDerivatives<T, NV, NU>,
    ) -> (SVector<T, NQ>, VectorWithDerivatives<T, NV, NU>)
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let is_linear = self.mechanism.translation(t, &SVector::repeat(T::one()));
        if is_linear.iter().all(|x| *x == T::zero()) {
            return self.displaced_configuration(from, by);
        }
        let mut translation =
            VectorWithDerivatives { value: self.mechanism.translation(t, &by.value), ..*by };
        translation.zero_other_derivatives(|k| is_linear.get(k) == Some(&T::one()));
        let remainder = by.plus_scaled(-T::one(), &translation);
        let (q, motion) = self.displaced_configuration(from, &translation);
        self.displaced_configuration((&q, &motion), &remainder)
    }

    /// Returns a velocity in the axes after a displacement `by` from the configuration `q`, with its
    /// derivatives ([`carry`](crate::integrate::Hooks::carry)). The motion of `q` does not affect it.
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
        self.multiply_derivatives_from_left(&by_dv, &mut end);
        self.transport_to_end(t, q, (&by.value, &end), v)
    }

    /// Returns [`transported_velocity`](Self::transported_velocity), or with declared generalized speeds the
    /// same speeds.
    fn transported_or_same_speeds<T: Real, const NQ: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        by: &VectorWithDerivatives<T, NV, NU>,
        v: &VectorWithDerivatives<T, NV, NU>,
    ) -> VectorWithDerivatives<T, NV, NU>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        if self.mechanism.features().speeds { *v } else { self.transported_velocity(t, q, by, v) }
    }

    /// Returns an acceleration at the velocity `v`, with its derivatives with respect to the state, without
    /// the rotation of the axes of ball and free joints.
    fn acceleration_without_axis_rotation<T: Real, const NQ: usize, const NU: usize>(
        &self,
        mut acceleration: VectorWithDerivatives<T, NV, NU>,
        (t, v): (T, &SVector<T, NV>),
    ) -> VectorWithDerivatives<T, NV, NU>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let m = self.mechanism;
        acceleration.value -= m.carry_rate(t, v, v);
        for k in self.ball_and_free_velocity_indices() {
            let unit = SVector::<T, NV>::from_fn(|i, _| if i == *k { T::one() } else { T::zero() });
            // The rate is bilinear.
            let change = m.carry_rate(t, &unit, v) + m.carry_rate(t, v, &unit);
            if let Some(column) = acceleration.by_v.data.0.get_mut(*k) {
                column.iter_mut().zip(&change).for_each(|(entry, change)| *entry -= *change);
            }
        }
        acceleration
    }

    /// Returns a velocity in the axes after a displacement `dv` from `q`, given the derivatives of the motion
    /// of the displaced configuration relative to `q`.
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
        for k in self.ball_and_free_velocity_indices() {
            if let Some(column) = axes.data.0.get_mut(*k) {
                *column = m.carry(t, q, dv, &unit(*k, T::one())).data.0[0];
            }
            // By Rodrigues' formula, half the difference of a vector rotated by right angles in both
            // directions is its cross product with the axis: the derivative of a rotation about it.
            let transported_by_rotation = |angle: T| m.carry(t, q, &unit(*k, angle), &value);
            if let Some(column) = rotation.data.0.get_mut(*k) {
                *column = ((transported_by_rotation(right_angle) - transported_by_rotation(-right_angle))
                    * constant::<T>(0.5))
                .data
                .0[0];
            }
        }
        self.multiply_derivatives_from_left(&axes, &mut carried);
        self.add_rotational_block_product(&mut carried, &rotation, end);
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
pub(crate) struct StepBeforeImpulses<T, const NQ: usize, const NV: usize, const NU: usize> {
    pub(crate) q: (SVector<T, NQ>, VectorWithDerivatives<T, NV, NU>),
    /// Velocity at the end of the step, including the contribution of the assumed contact forces.
    pub(crate) v: VectorWithDerivatives<T, NV, NU>,
    /// Contribution of the assumed contact forces to the velocity.
    pub(crate) given: Option<VectorWithDerivatives<T, NV, NU>>,
}

/// Returns the acceleration without contacts at the start of a step, with the velocity `v`, as
/// [`motion_under_contact_forces`] takes it.
pub(crate) fn smooth_acceleration_at_start<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    method: &TimeStepping<T>,
    start: &DifferentiatedStepStart<'_, M, T, NQ, NV, NU>,
    v: &SVector<T, NV>,
) -> VectorWithDerivatives<T, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    let acceleration = start.acceleration_with_derivatives(T::zero(), (start.q, v));
    match method.has_four_stages() {
        true => acceleration,
        false => ConfigurationManifold::new(start.mechanism)
            .acceleration_without_axis_rotation(acceleration, (start.t, v)),
    }
}

/// Returns the motion in a step with the accelerations `before` at its start, under contact forces that add
/// `rate` to the velocity per second.
pub(crate) fn motion_under_contact_forces<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    method: &TimeStepping<T>,
    start: &DifferentiatedStepStart<'_, M, T, NQ, NV, NU>,
    v: &VectorWithDerivatives<T, NV, NU>,
    before: &VectorWithDerivatives<T, NV, NU>,
    rate: Option<&VectorWithDerivatives<T, NV, NU>>,
) -> StepBeforeImpulses<T, NQ, NV, NU>
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
    start: &DifferentiatedStepStart<'_, M, T, NQ, NV, NU>,
    h: T,
    v: &VectorWithDerivatives<T, NV, NU>,
    before: &VectorWithDerivatives<T, NV, NU>,
    rate: Option<&VectorWithDerivatives<T, NV, NU>>,
) -> StepBeforeImpulses<T, NQ, NV, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    let (half, manifold) = (h * constant(0.5), ConfigurationManifold::new(start.mechanism));
    let to_middle = v.scaled_derivatives(half);
    // Only the configuration and the velocity at the start move the middle.
    let (middle, motion) = manifold.displaced_along_straight_lines(
        start.t,
        (start.q, &VectorWithDerivatives::zero_displacement_with_derivatives()),
        &to_middle,
    );
    let velocity_at_midpoint_axes = |x: &VectorWithDerivatives<T, NV, NU>| {
        manifold.transported_or_same_speeds(start.t, start.q, &to_middle, x)
    };
    let rate = rate.map(|rate| manifold.transported_velocity(start.t, start.q, &to_middle, rate));
    let velocity_with_contact_rate = |v: VectorWithDerivatives<T, NV, NU>, h: T| match &rate {
        Some(rate) => v.plus_scaled(h, rate),
        None => v,
    };
    let velocity = velocity_with_contact_rate(velocity_at_midpoint_axes(&v.plus_scaled(half, before)), half);
    let own = start.acceleration_with_derivatives(half, (&middle, &velocity.value));
    let own = manifold.acceleration_without_axis_rotation(own, (start.t + half, &velocity.value));
    let mut acceleration =
        VectorWithDerivatives { value: own.value, by_q: own.by_q, by_v: own.by_q, by_u: own.by_u };
    if !manifold.has_fixed_axes() {
        NearlyIdentity::with_range(&motion.by_q, manifold.rotating).follow(&mut acceleration.by_q);
        let by_displacement = motion.by_v * (T::one() / half);
        NearlyIdentity::with_range(&by_displacement, manifold.rotating).follow(&mut acceleration.by_v);
    }
    scale(&mut acceleration.by_v, half);
    add_product(&mut acceleration.by_q, &own.by_v, &velocity.by_q);
    add_product(&mut acceleration.by_v, &own.by_v, &velocity.by_v);
    add_product(&mut acceleration.by_u, &own.by_v, &velocity.by_u);
    let in_axes_of_middle =
        velocity_with_contact_rate(velocity_at_midpoint_axes(v).plus_scaled(h, &acceleration), h);
    let to_end = in_axes_of_middle.scaled_derivatives(half);
    let end = manifold.transported_or_same_speeds(start.t + half, &middle, &to_end, &in_axes_of_middle);
    let given = rate.map(|rate| {
        manifold.transported_velocity(start.t + half, &middle, &to_end, &rate).scaled_derivatives(h)
    });
    let q = manifold.displaced_along_straight_lines(start.t + half, (&middle, &motion), &to_end);
    StepBeforeImpulses { q, v: end, given }
}

fn four_stage_motion<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    start: &DifferentiatedStepStart<'_, M, T, NQ, NV, NU>,
    h: T,
    v: &VectorWithDerivatives<T, NV, NU>,
    before: &VectorWithDerivatives<T, NV, NU>,
    rate: Option<&VectorWithDerivatives<T, NV, NU>>,
) -> StepBeforeImpulses<T, NQ, NV, NU>
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
    let (way, change) = runge_kutta_change(
        h,
        [&k1, &k2, &k3, &k4],
        VectorWithDerivatives::plus_scaled,
        VectorWithDerivatives::scaled_derivatives,
    );
    StepBeforeImpulses {
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
        let step = ContactTransitionVisitor { method: self, t, state: (q, v), u, into: &mut *into };
        if let Some(done) = mechanism.visit_contacts(step) {
            return done;
        }
        let (start, v) = (
            DifferentiatedStepStart { mechanism, t, q, u },
            VectorWithDerivatives::start_velocity_with_derivatives(v),
        );
        let before = smooth_acceleration_at_start(self, &start, &v.value);
        let motion = motion_under_contact_forces(self, &start, &v, &before, None);
        *into = Transition::from_differentiated_state(&motion.q, &motion.v);
        Ok(())
    }
}
