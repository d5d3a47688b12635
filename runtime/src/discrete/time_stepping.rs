//! Derivatives of steps of [`TimeStepping`]: the motion without contact impulses at the end, and
//! displacements and transported velocities. Derivatives of the impulses are in `contact`.

use super::explicit::{DifferentiatedStepStart, VectorWithDerivatives, runge_kutta_change};
use super::{DifferentiableStep, Transition};
use crate::Real;
use crate::blocks::{NearlyIdentity, add_multiple, add_product, add_product_of_some, is_zero, scale, zeros};
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
    /// Indices of all velocities.
    indices: [usize; NV],
    /// Half-open range of the velocities of ball and free joints; empty without such joints.
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

    /// Returns true if no velocity belongs to a ball or free joint, so that displacements add like vectors.
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
        by.left_multiply(&mut of.by_q);
        by.left_multiply(&mut of.by_v);
        by.left_multiply(&mut of.by_u);
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
        turned.add_scaled(T::one(), &way);
        (to, turned)
    }

    /// Returns the configuration after a displacement during which the origins of free bodies move along
    /// straight lines, and its derivatives with respect to the configuration before and to the displacement.
    fn displacement_along_straight_lines<T: Real, const NQ: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        dv: &SVector<T, NV>,
    ) -> (SVector<T, NQ>, [SMatrix<T, NV, NV>; 2])
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let m = self.mechanism;
        if self.has_fixed_axes() {
            return (m.integrate(q, dv), [SMatrix::identity(); 2]);
        }
        let is_linear = m.translation(t, &SVector::repeat(T::one()));
        if is_linear.iter().all(|x| *x == T::zero()) {
            let (by_q, by_dv) = m.integrate_derivatives_at(q, dv);
            return (m.integrate(q, dv), [by_q, by_dv]);
        }
        let translation = m.translation(t, dv);
        let (translated, rotation) = (m.integrate(q, &translation), dv - translation);
        let (mut by_q, mut by_dv) = m.integrate_derivatives_at(q, &translation);
        let (rotated_by_q, rotated_by_dv) = m.integrate_derivatives_at(&translated, &rotation);
        let rotated = NearlyIdentity::with_range(&rotated_by_q, self.rotating);
        rotated.left_multiply(&mut by_q);
        rotated.left_multiply(&mut by_dv);
        let columns = by_dv.data.0.iter_mut().zip(&rotated_by_dv.data.0).zip(&is_linear);
        for ((column, rotated), _) in columns.filter(|(_, is_linear)| **is_linear != T::one()) {
            *column = *rotated;
        }
        (m.integrate(&translated, &rotation), [by_q, by_dv])
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
        self.transport_velocity_to_end(t, q, (&by.value, &end), v)
    }

    /// Returns the axes of ball and free joints after a displacement `dv` from `q`.
    fn axes_after_displacement<T: Real, const NQ: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        dv: &SVector<T, NV>,
    ) -> DisplacedAxes<T, NV>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        if self.keeps_velocity_components() {
            return DisplacedAxes { dv: *dv, axes: SMatrix::identity(), by_dv: SMatrix::zeros() };
        }
        let (_, by_dv) = self.mechanism.integrate_derivatives_at(q, dv);
        DisplacedAxes { dv: *dv, axes: self.transport_matrix(t, q, dv), by_dv }
    }

    /// Whether velocities have the same components in all configurations.
    fn keeps_velocity_components<T: Real, const NQ: usize, const NU: usize>(&self) -> bool
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        self.has_fixed_axes() || self.mechanism.features().speeds
    }

    /// Returns a velocity in the axes after a displacement, and the derivative of its components with respect
    /// to the displacement.
    fn velocity_in_displaced_axes<T: Real, const NQ: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        displaced: &DisplacedAxes<T, NV>,
        v: &SVector<T, NV>,
    ) -> (SVector<T, NV>, SMatrix<T, NV, NV>)
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let mut by_dv = SMatrix::zeros();
        if self.keeps_velocity_components() {
            return (*v, by_dv);
        }
        let value = self.mechanism.carry(t, q, &displaced.dv, v);
        let rotation = self.velocity_derivative_by_rotation(t, q, &value);
        add_product_of_some(&mut by_dv, self.ball_and_free_velocity_indices(), &rotation, &displaced.by_dv);
        (value, by_dv)
    }

    /// Returns the matrix that expresses velocities in the axes after a displacement `dv` from `q`.
    fn transport_matrix<T: Real, const NQ: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        dv: &SVector<T, NV>,
    ) -> SMatrix<T, NV, NV>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let mut axes = SMatrix::<T, NV, NV>::identity();
        for k in self.ball_and_free_velocity_indices() {
            if let Some(column) = axes.data.0.get_mut(*k) {
                *column = self.mechanism.carry(t, q, dv, &vector_with_single_entry(*k, T::one())).data.0[0];
            }
        }
        axes
    }

    /// Returns the derivative of the components of a velocity with respect to rotations of the axes.
    fn velocity_derivative_by_rotation<T: Real, const NQ: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> SMatrix<T, NV, NV>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let (mut rotation, right_angle) =
            (SMatrix::<T, NV, NV>::zeros(), constant::<T>(core::f64::consts::FRAC_PI_2));
        for k in self.ball_and_free_velocity_indices() {
            // By Rodrigues' formula, half the difference of a vector rotated by right angles in both
            // directions is its cross product with the axis: the derivative of a rotation about it.
            let transported_by_rotation =
                |angle: T| self.mechanism.carry(t, q, &vector_with_single_entry(*k, angle), v);
            if let Some(column) = rotation.data.0.get_mut(*k) {
                *column = ((transported_by_rotation(right_angle) - transported_by_rotation(-right_angle))
                    * constant::<T>(0.5))
                .data
                .0[0];
            }
        }
        rotation
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
            let unit = vector_with_single_entry(*k, T::one());
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
    pub(crate) fn transport_velocity_to_end<T: Real, const NQ: usize, const NU: usize>(
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
        let value = self.mechanism.carry(t, q, dv, &v.value);
        let mut carried = VectorWithDerivatives { value, ..*v };
        self.multiply_derivatives_from_left(&self.transport_matrix(t, q, dv), &mut carried);
        self.add_rotational_block_product(
            &mut carried,
            &self.velocity_derivative_by_rotation(t, q, &value),
            end,
        );
        carried
    }

    /// Returns the velocity `v` at the configuration `from`, in the axes of the configuration `to`, with its
    /// derivatives. `motion` has the derivatives of `to`; `from` is the start of the derivatives.
    pub(crate) fn transport_velocity_between_configurations<T: Real, const NQ: usize, const NU: usize>(
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
        self.transport_velocity_to_end(t, from, (&way, &relative), v)
    }
}

/// Axes of ball and free joints after a displacement.
struct DisplacedAxes<T, const NV: usize> {
    /// Displacement.
    dv: SVector<T, NV>,
    /// Matrix that expresses velocities in the axes after the displacement.
    axes: SMatrix<T, NV, NV>,
    /// Derivative of the motion of the axes with respect to the displacement.
    by_dv: SMatrix<T, NV, NV>,
}

/// Returns a vector whose only nonzero entry is `length`, at index `k`.
fn vector_with_single_entry<T: Real, const NV: usize>(k: usize, length: T) -> SVector<T, NV> {
    SVector::from_fn(|i, _| if i == k { length } else { T::zero() })
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
    let way = v.value * half;
    // Only the configuration and the velocity at the start move the middle.
    let (middle, [by_q, by_way]) = manifold.displacement_along_straight_lines(start.t, start.q, &way);
    let axes = manifold.axes_after_displacement(start.t, start.q, &way);
    let transported_to_middle = |x: &VectorWithDerivatives<T, NV, NU>| {
        let (value, by_way) = manifold.velocity_in_displaced_axes(start.t, start.q, &axes, &x.value);
        let mut transported = VectorWithDerivatives { value, ..*x };
        manifold.multiply_derivatives_from_left(&axes.axes, &mut transported);
        add_multiple(&mut transported.by_v, half, &by_way);
        transported
    };
    let rate = rate.map(transported_to_middle);
    let (value, turned) = manifold.velocity_in_displaced_axes(start.t, start.q, &axes, &v.value);
    let mut at_middle = VectorWithDerivatives { value, by_q: zeros(), by_v: axes.axes, by_u: zeros() };
    add_multiple(&mut at_middle.by_v, half, &turned);
    let mut velocity = transported_to_middle(before);
    if let Some(rate) = &rate {
        velocity.add_scaled(T::one(), rate);
    }
    velocity = at_middle.plus_scaled(half, &velocity);
    let own = start.acceleration_with_derivatives(half, (&middle, &velocity.value));
    let own = manifold.acceleration_without_axis_rotation(own, (start.t + half, &velocity.value));
    let mut acceleration =
        VectorWithDerivatives { value: own.value, by_q: own.by_q, by_v: own.by_q, by_u: own.by_u };
    NearlyIdentity::with_range(&by_q, manifold.rotating).right_multiply(&mut acceleration.by_q);
    NearlyIdentity::with_range(&by_way, manifold.rotating).right_multiply(&mut acceleration.by_v);
    scale(&mut acceleration.by_v, half);
    add_product(&mut acceleration.by_q, &own.by_v, &velocity.by_q);
    add_product(&mut acceleration.by_v, &own.by_v, &velocity.by_v);
    add_product(&mut acceleration.by_u, &own.by_v, &velocity.by_u);
    if let Some(rate) = &rate {
        acceleration.add_scaled(T::one(), rate);
    }
    at_middle.add_scaled(h, &acceleration);
    // The second half of the step, with the velocity at its end in the axes of the middle.
    let way = at_middle.value * half;
    let (q, [to_by_q, to_by_way]) = manifold.displacement_along_straight_lines(start.t + half, &middle, &way);
    let axes = manifold.axes_after_displacement(start.t + half, &middle, &way);
    let mut motion = at_middle.scaled_with_derivatives(half);
    let given = rate.map(|mut rate| {
        let (value, by_way) =
            manifold.velocity_in_displaced_axes(start.t + half, &middle, &axes, &rate.value);
        manifold.multiply_derivatives_from_left(&axes.axes, &mut rate);
        manifold.add_rotational_block_product(&mut rate, &by_way, &motion);
        VectorWithDerivatives { value, ..rate }.scaled_with_derivatives(h)
    });
    manifold.multiply_derivatives_from_left(&to_by_way, &mut motion);
    let [mut from_q, mut from_v] = [by_q, by_way];
    let to = NearlyIdentity::with_range(&to_by_q, manifold.rotating);
    to.left_multiply(&mut from_q);
    to.left_multiply(&mut from_v);
    add_multiple(&mut motion.by_q, T::one(), &from_q);
    add_multiple(&mut motion.by_v, half, &from_v);
    let (value, by_way) =
        manifold.velocity_in_displaced_axes(start.t + half, &middle, &axes, &at_middle.value);
    let mut by_end = axes.axes;
    add_multiple(&mut by_end, half, &by_way);
    manifold.multiply_derivatives_from_left(&by_end, &mut at_middle);
    StepBeforeImpulses { q: (q, motion), v: VectorWithDerivatives { value, ..at_middle }, given }
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
    let stage_rates = |after: T, (rates, acceleration): &StageRates<T, NV, NU>| {
        let (way, v) = (rates.scaled_with_derivatives(after), v.plus_scaled(after, acceleration));
        let mut acceleration = start.acceleration_after_time(after, &start.displace_configuration(&way), &v);
        let carried = rate.map(|rate| manifold.transported_velocity(start.t, start.q, &way, rate));
        if let Some(carried) = &carried {
            acceleration = acceleration.plus_scaled(T::one(), carried);
        }
        if is_plain {
            return ((v, acceleration), carried);
        }
        let (_, by_dv, by_v) = start.mechanism.displacement_rate_derivatives(start.q, &way.value, &v.value);
        let value = start.mechanism.displacement_rate(start.q, &way.value, &v.value);
        let mut rates = VectorWithDerivatives { value, ..v };
        manifold.multiply_derivatives_from_left(&by_v, &mut rates);
        manifold.add_rotational_block_product(&mut rates, &by_dv, &way);
        ((rates, acceleration), carried)
    };
    let k1 = (*v, rate.map_or(*before, |rate| before.plus_scaled(T::one(), rate)));
    let (k2, _) = stage_rates(half, &k1);
    let (k3, _) = stage_rates(half, &k2);
    let (k4, at_end) = stage_rates(h, &k3);
    let (way, change) = runge_kutta_change(
        h,
        [&k1, &k2, &k3, &k4],
        VectorWithDerivatives::plus_scaled,
        VectorWithDerivatives::scaled_with_derivatives,
    );
    StepBeforeImpulses {
        q: start.displace_configuration(&way),
        v: v.plus_scaled(T::one(), &change),
        given: at_end.map(|rate| rate.scaled_with_derivatives(h)),
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
