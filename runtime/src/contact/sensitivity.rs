//! Derivatives of a step with contacts.
//!
//! Each quantity of a step has its derivatives with respect to the state before the step and to the inputs.
//! The impulses are differentiated implicitly: the contact modes are those that the step has found, and the
//! conditions that hold with equality in these modes are linearised. The effect of constant impulses `Λ`
//! changes with the configuration by `M⁻¹ (∂(Gᵀ Λ)/∂q − ∂(M a)/∂q)` with `a = M⁻¹ Gᵀ Λ`.

use super::derivatives::ContactDerivatives;
use super::impulses::Impulses;
use super::observer::{GapClosingDisplacement, ImpulseObserver};
use super::problem::{ImpulseEquations, LinearisedImpulses};
use super::response::CholeskyFactor;
use super::selection::ContactSelection;
use super::solution::ContactsWithImpulses;
use super::stepping::observed_step;
use super::{Touched, touching_distance};
use crate::blocks::{add_multiple, add_product, zeros};
use crate::constraint::ConstraintError;
use crate::discrete::{
    ConfigurationManifold, DifferentiatedStepStart, Transition, VectorWithDerivatives,
    motion_under_contact_forces, smooth_acceleration_at_start,
};
use crate::integrate::{Error, TimeStepping};
use crate::private::{constant, to_f64};
use crate::{Derivatives, Real};
use nalgebra::{SMatrix, SVector};

/// Writes a time-stepping step of a mechanism with contacts, with its first derivatives. The mechanism
/// implements [`ContactDerivatives`](super::ContactDerivatives). Generated code calls this function.
///
/// # Errors
///
/// The errors of [`discrete::transition`](crate::discrete::transition).
pub fn differentiate_step<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    mechanism: &M,
    method: &TimeStepping<T>,
    t: T,
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    u: &SVector<T, NU>,
    into: &mut Transition<T, NQ, NV, NU>,
) -> Result<(), Error>
where
    T: Real,
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
{
    let as_step_error = |reason| match reason {
        ConstraintError::NotFinite => Error::NotFinite { t: to_f64(t) },
        reason => Error::Constraint { t: to_f64(t), reason },
    };
    let h = method.nominal_step_length();
    let (start, velocity) = (
        DifferentiatedStepStart { mechanism, t, q, u },
        VectorWithDerivatives::start_velocity_with_derivatives(v),
    );
    let before = smooth_acceleration_at_start(method, &start, v);
    let contacts =
        ContactStepStart { mechanism, manifold: ConfigurationManifold::new(mechanism), start: (q, v) };
    let free = velocity.plus_scaled(h, &before);
    let at_start = ContactInstant { t, h: T::zero(), q, motion: None, free: &free, given: None };
    let (after, held) =
        contacts.differentiate_impulses(&at_start, &Impulses::none()).map_err(as_step_error)?;
    let rate = after.map(|(after, _)| after.plus_scaled(-T::one(), &free).scaled_derivatives(T::one() / h));
    let motion = motion_under_contact_forces(method, &start, &velocity, &before, rate.as_ref());
    let (given, (q, moved)) = (motion.given.as_ref(), &motion.q);
    let free = given.map_or(motion.v, |given| motion.v.plus_scaled(-T::one(), given));
    let at_end = ContactInstant { t: t + h, h, q, motion: Some(moved), free: &free, given };
    let (after, end) = contacts.differentiate_impulses(&at_end, &held.impulses).map_err(as_step_error)?;
    let state = after.and_then(|(_, state)| state);
    let (place, v) = state.unwrap_or_else(|| contacts.state_after_contact_impulses(&at_end, &free));
    *into = Transition::from_differentiated_state(
        &(end.q, place.1),
        &VectorWithDerivatives { value: end.v, ..v },
    );
    Ok(())
}

/// Configuration and the derivatives of its displacement.
type ConfigurationWithDerivatives<T, const NQ: usize, const NV: usize, const NU: usize> =
    (SVector<T, NQ>, VectorWithDerivatives<T, NV, NU>);

/// State with its derivatives.
type StateWithDerivatives<T, const NQ: usize, const NV: usize, const NU: usize> =
    (ConfigurationWithDerivatives<T, NQ, NV, NU>, VectorWithDerivatives<T, NV, NU>);

/// Velocity after the contact impulses, in the axes of the configuration where they act, and the state at the
/// end of a step.
type PostImpulseState<T, const NQ: usize, const NV: usize, const NU: usize> =
    (VectorWithDerivatives<T, NV, NU>, Option<StateWithDerivatives<T, NQ, NV, NU>>);

/// Mechanism, with the state at the start of a step in which contacts act.
struct ContactStepStart<'a, M, T, const NQ: usize, const NV: usize> {
    mechanism: &'a M,
    manifold: ConfigurationManifold<'a, M, NV>,
    start: (&'a SVector<T, NQ>, &'a SVector<T, NV>),
}

/// Instant at which contacts act, after a motion of `h` seconds.
struct ContactInstant<'a, T, const NQ: usize, const NV: usize, const NU: usize> {
    t: T,
    h: T,
    q: &'a SVector<T, NQ>,
    /// Derivatives of the displacement of the configuration since the start of the step; `None` at the start
    /// of the step.
    motion: Option<&'a VectorWithDerivatives<T, NV, NU>>,
    /// Velocity without contact impulses, with its derivatives.
    free: &'a VectorWithDerivatives<T, NV, NU>,
    /// Change of the velocity by the assumed contact forces, with its derivatives; `None` if no forces were
    /// assumed.
    given: Option<&'a VectorWithDerivatives<T, NV, NU>>,
}

impl<M, T: Real, const NQ: usize, const NV: usize> ContactStepStart<'_, M, T, NQ, NV> {
    /// Computes the contact impulses at an instant, and returns the velocity and state after them with
    /// derivatives, if any contact is loaded.
    #[allow(clippy::type_complexity, reason = "sizes of arrays")]
    fn differentiate_impulses<const NU: usize, const NK: usize, const NR: usize>(
        &self,
        at: &ContactInstant<'_, T, NQ, NV, NU>,
        impulses: &Impulses<T, NV>,
    ) -> Result<(Option<PostImpulseState<T, NQ, NV, NU>>, Touched<T, NQ, NV>), ConstraintError>
    where
        M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let mut observer =
            ImpulseDifferentiator::<_, _, NQ, NV, NU, NK, NR> { contacts: self, at, found: None };
        let given = at.given.map_or(SVector::zeros(), |given| given.value);
        let state = (at.q, &at.free.value);
        let touched =
            observed_step(self.mechanism, at.t, self.start, state, (&given, impulses), at.h, &mut observer)?;
        Ok((observer.found.transpose()?, touched))
    }

    /// Returns the state at the end of a step with the velocity `after` the impulses. Position changes as if
    /// the impulses acted in the middle of the step.
    fn state_after_contact_impulses<const NU: usize>(
        &self,
        at: &ContactInstant<'_, T, NQ, NV, NU>,
        after: &VectorWithDerivatives<T, NV, NU>,
    ) -> StateWithDerivatives<T, NQ, NV, NU>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let mut change = after.plus_scaled(-T::one(), at.free);
        if let Some(given) = at.given {
            change = change.plus_scaled(-T::one(), given);
        }
        let here = VectorWithDerivatives::zero_displacement_with_derivatives();
        let place = (at.q, at.motion.unwrap_or(&here));
        self.displaced_state((at.t, place), &change.scaled_derivatives(at.h * constant(0.5)), after)
    }

    /// Returns the state after a displacement, with the velocity in the axes there.
    fn displaced_state<const NU: usize>(
        &self,
        (t, place): (T, (&SVector<T, NQ>, &VectorWithDerivatives<T, NV, NU>)),
        by: &VectorWithDerivatives<T, NV, NU>,
        v: &VectorWithDerivatives<T, NV, NU>,
    ) -> StateWithDerivatives<T, NQ, NV, NU>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        (
            self.manifold.displaced_configuration(place, by),
            self.manifold.transported_velocity(t, place.0, by, v),
        )
    }
}

/// Observer that differentiates the impulses of a step.
struct ImpulseDifferentiator<
    'a,
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
> {
    contacts: &'a ContactStepStart<'a, M, T, NQ, NV>,
    at: &'a ContactInstant<'a, T, NQ, NV, NU>,
    found: Option<Result<PostImpulseState<T, NQ, NV, NU>, ConstraintError>>,
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>
    ImpulseObserver<T, NV> for ImpulseDifferentiator<'_, M, T, NQ, NV, NU, NK, NR>
where
    T: Real,
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
{
    fn observe<const CK: usize, const CR: usize>(
        &mut self,
        acted: &ContactsWithImpulses<T, NV, CK, CR>,
        closing: Option<&GapClosingDisplacement<T, CK, CR>>,
    ) {
        if !acted.is_loaded() {
            return;
        }
        let responses = acted.velocity_responses();
        let underivable_contact_error = |contact| {
            let index = acted.selection.index_of_contact(contact);
            let constraint = M::CONTACTS.get(index).copied().unwrap_or_default();
            ConstraintError::NoDerivatives { constraint }
        };
        let regular = acted.problem.check_derivatives(&acted.impulses).map_err(underivable_contact_error);
        self.found = Some(regular.map(|()| {
            let closed = ClosedContacts::new(self.contacts, self.at, acted, &responses);
            let after = closed.velocity_after_impulses();
            let Some(closing) = closing else { return (after, None) };
            let (place, v) = self.contacts.state_after_contact_impulses(self.at, &after);
            let end = match closed.closing_displacement(closing, &place) {
                Some(by) => self.contacts.displaced_state((self.at.t, (&place.0, &place.1)), &by, &v),
                None => (place, v),
            };
            (after, Some(end))
        }));
    }
}

/// Closed contacts at the configuration where their impulses act. Matrices have the rows of these contacts
/// alone.
struct ClosedContacts<
    'a,
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    const CK: usize,
    const CR: usize,
> {
    contacts: &'a ContactStepStart<'a, M, T, NQ, NV>,
    at: &'a ContactInstant<'a, T, NQ, NV, NU>,
    acted: &'a ContactsWithImpulses<T, NV, CK, CR>,
    /// Velocity changes by unit impulses, `M⁻¹ Gᵀ`.
    responses: &'a SMatrix<T, NV, CR>,
    /// Contact Jacobian `G` of the closed contacts.
    jacobian: SMatrix<T, CR, NV>,
    /// Factor of the mass matrix; `None` if forces depend on accelerations.
    factor: Option<CholeskyFactor<T, NV>>,
}

/// Derivatives with respect to the configuration: of the velocity change by constant impulses, and of the
/// contact velocities at a constant velocity.
struct ContactConfigurationDerivatives<T, const NV: usize, const CR: usize> {
    velocities: SMatrix<T, NV, NV>,
    rates: SMatrix<T, CR, NV>,
}

/// Derivatives of values at the rows of contacts, with respect to configuration, velocity and inputs before
/// the step.
#[derive(Clone, Copy)]
struct ContactRowDerivatives<T, const CR: usize, const NV: usize, const NU: usize> {
    by_q: SMatrix<T, CR, NV>,
    by_v: SMatrix<T, CR, NV>,
    by_u: SMatrix<T, CR, NU>,
}

impl<T: Real, const CR: usize, const NV: usize, const NU: usize> ContactRowDerivatives<T, CR, NV, NU> {
    fn zeros() -> Self {
        Self { by_q: zeros(), by_v: zeros(), by_u: zeros() }
    }

    /// Adds a matrix times the derivatives of a vector.
    fn add_product(&mut self, by: &SMatrix<T, CR, NV>, of: &VectorWithDerivatives<T, NV, NU>) {
        add_product(&mut self.by_q, by, &of.by_q);
        add_product(&mut self.by_v, by, &of.by_v);
        add_product(&mut self.by_u, by, &of.by_u);
    }

    /// Adds the product of a matrix `by` and the derivatives `of`, whose rows belong to contact velocities.
    fn add_rows(&mut self, by: &SMatrix<T, CR, CR>, of: &Self) {
        add_product(&mut self.by_q, by, &of.by_q);
        add_product(&mut self.by_v, by, &of.by_v);
        add_product(&mut self.by_u, by, &of.by_u);
    }

    /// Returns all derivatives, multiplied by a number.
    fn scaled_row_derivatives(&self, s: T) -> Self {
        Self { by_q: self.by_q * s, by_v: self.by_v * s, by_u: self.by_u * s }
    }

    /// Returns the derivatives of the impulses, if `self` holds the derivatives of the contact velocities
    /// without impulses.
    fn impulse_derivatives(&self, equations: &LinearisedImpulses<T, CR>) -> Self {
        let Self { by_q, by_v, by_u } = self;
        Self {
            by_q: equations.impulse_changes(by_q),
            by_v: equations.impulse_changes(by_v),
            by_u: equations.impulse_changes(by_u),
        }
    }

    /// Adds the velocity change that these impulses cause.
    fn add_velocity_change(&self, responses: &SMatrix<T, NV, CR>, to: &mut VectorWithDerivatives<T, NV, NU>) {
        add_product(&mut to.by_q, responses, &self.by_q);
        add_product(&mut to.by_v, responses, &self.by_v);
        add_product(&mut to.by_u, responses, &self.by_u);
    }
}

impl<
    'a,
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    const CK: usize,
    const CR: usize,
> ClosedContacts<'a, M, T, NQ, NV, NU, NK, NR, CK, CR>
where
    T: Real,
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
{
    fn new(
        contacts: &'a ContactStepStart<'a, M, T, NQ, NV>,
        at: &'a ContactInstant<'a, T, NQ, NV, NU>,
        acted: &'a ContactsWithImpulses<T, NV, CK, CR>,
        responses: &'a SMatrix<T, NV, CR>,
    ) -> Self {
        let (m, q) = (contacts.mechanism, at.q);
        let jacobian = selected_contact_rows(&acted.selection, &m.contact_jacobian(at.t, q));
        let factor = if m.features().feedback {
            None
        } else {
            CholeskyFactor::cholesky_of_mass_matrix(&m.mass_matrix(at.t, q))
        };
        Self { contacts, at, acted, responses, jacobian, factor }
    }

    /// Returns two derivatives with respect to the configuration: of the velocity change by `impulses`, and
    /// of the contact velocities at the velocity `v`.
    fn configuration_derivatives(
        &self,
        v: &SVector<T, NV>,
        impulses: &SVector<T, CR>,
    ) -> ContactConfigurationDerivatives<T, NV, CR> {
        let (m, t, q) = (self.contacts.mechanism, self.at.t, self.at.q);
        let (still, effect) = (SVector::zeros(), self.responses * impulses);
        let parts = m.contact_derivatives(
            t,
            q,
            v,
            &still,
            &self.acted.selection.impulses_at_mechanism_rows(impulses),
        );
        let rates = selected_contact_rows(&self.acted.selection, &parts.rates_by_q);
        let mut velocities;
        match &self.factor {
            Some(factor) => {
                let mass_times_derivative =
                    |a: &SVector<T, NV>| m.inverse_dynamics_derivatives(t, q, &still, a).0;
                velocities = factor.solve_all_columns(
                    &(parts.forces_by_q - mass_times_derivative(&effect) + mass_times_derivative(&still)),
                );
            }
            None => {
                let bias = m.bias_forces(t, q, &still);
                let loaded = bias + self.jacobian.tr_mul(impulses);
                let (by_q, _, response) = m.forward_dynamics_derivatives(t, q, &still, &loaded);
                velocities = by_q - m.forward_dynamics_derivatives(t, q, &still, &bias).0;
                add_product(&mut velocities, &response, &parts.forces_by_q);
            }
        }
        ContactConfigurationDerivatives { velocities, rates }
    }

    /// Returns the derivatives of [`configuration_derivatives`](Self::configuration_derivatives) for a
    /// displacement `v` instead of a velocity: contact velocities of prescribed motions are left out.
    fn displacement_derivatives(
        &self,
        v: &SVector<T, NV>,
        impulses: &SVector<T, CR>,
    ) -> ContactConfigurationDerivatives<T, NV, CR> {
        let found = self.configuration_derivatives(v, impulses);
        let still = self.contact_velocity_derivatives(&SVector::zeros());
        ContactConfigurationDerivatives { rates: found.rates - still, ..found }
    }

    /// Returns the derivatives of contact velocities at the velocity `v` with respect to the configuration.
    fn contact_velocity_derivatives(&self, v: &SVector<T, NV>) -> SMatrix<T, CR, NV> {
        let (m, t, q) = (self.contacts.mechanism, self.at.t, self.at.q);
        let parts = m.contact_derivatives(t, q, v, &SVector::zeros(), &SVector::zeros());
        selected_contact_rows(&self.acted.selection, &parts.rates_by_q)
    }

    /// Adds to a velocity the change that follows from the displacement of the configuration.
    fn add_velocity_change_by_displacement(
        &self,
        sum: &mut VectorWithDerivatives<T, NV, NU>,
        by_place: &SMatrix<T, NV, NV>,
    ) {
        let Some(motion) = self.at.motion else { return add_multiple(&mut sum.by_q, T::one(), by_place) };
        add_product(&mut sum.by_q, by_place, &motion.by_q);
        add_product(&mut sum.by_v, by_place, &motion.by_v);
        add_product(&mut sum.by_u, by_place, &motion.by_u);
    }

    /// Adds to contact velocities the change that follows from the displacement of the configuration.
    fn add_contact_velocity_by_displacement(
        &self,
        sum: &mut ContactRowDerivatives<T, CR, NV, NU>,
        by_place: &SMatrix<T, CR, NV>,
    ) {
        match self.at.motion {
            Some(motion) => sum.add_product(by_place, motion),
            None => add_multiple(&mut sum.by_q, T::one(), by_place),
        }
    }

    /// Returns the velocity after the impulses, with its derivatives.
    fn velocity_after_impulses(&self) -> VectorWithDerivatives<T, NV, NU> {
        let ContactsWithImpulses { problem, impulses, free: corrected, .. } = self.acted;
        let (equations, is_whole) = problem.linearised_impulse_equations(impulses);
        let impulses = problem.impulses_at_mechanism_rows(impulses);
        let mut after = *self.at.free;
        after.value = corrected + self.responses * impulses;
        let (mut acting, is_corrected) = (impulses, *corrected != self.at.free.value);
        let transport = self.at.given.filter(|_| is_corrected).map(|given| {
            let half =
                VectorWithDerivatives { value: after.value, ..after.plus_scaled(constant(0.5), given) };
            after = half;
            let transport = self.impulses_of_rotation_correction(given, is_whole);
            acting += transport.0;
            transport.1
        });
        let by_place = self.configuration_derivatives(&after.value, &acting);
        self.add_velocity_change_by_displacement(&mut after, &by_place.velocities);
        if let Some(Some(transported)) = transport {
            transported.add_velocity_change(self.responses, &mut after);
        }
        let mut rates = ContactRowDerivatives::zeros();
        self.add_contact_velocity_by_displacement(&mut rates, &by_place.rates);
        rates.add_product(&self.jacobian, &after);
        self.subtract_restitution_derivatives(&mut rates);
        rates.impulse_derivatives(&equations).add_velocity_change(self.responses, &mut after);
        after
    }

    /// Returns the impulses that the correction for rotating contact forces adds, apart from half of `given`,
    /// and their derivatives. If all contacts stick (`is_whole`), the impulses of the step contain these
    /// derivatives.
    fn impulses_of_rotation_correction(
        &self,
        given: &VectorWithDerivatives<T, NV, NU>,
        is_whole: bool,
    ) -> (SVector<T, CR>, Option<ContactRowDerivatives<T, CR, NV, NU>>) {
        let (problem, half) = (&self.acted.problem, constant::<T>(0.5));
        let (start, is_regular) = problem
            .impulses_for_contact_changes(&(self.jacobian * given.value), &mut ImpulseEquations::new());
        let start = problem.impulses_without_compression(&start);
        if is_whole {
            return (start * -half, None);
        }
        let left = given.value - self.responses * start;
        let by_place = self.displacement_derivatives(&left, &start);
        let mut effect = VectorWithDerivatives { value: SVector::zeros(), ..*given };
        self.add_velocity_change_by_displacement(&mut effect, &(-by_place.velocities));
        let mut rates = ContactRowDerivatives::zeros();
        self.add_contact_velocity_by_displacement(&mut rates, &by_place.rates);
        rates.add_product(&self.jacobian, &effect);
        let starts = rates
            .impulse_derivatives(&problem.velocity_preserving_equations(&problem.chosen_rows_with_impulses()))
            .scaled_row_derivatives(-T::one());
        let (mut offset, mut derivatives) = (start * -half, starts.scaled_row_derivatives(-half));
        if is_regular {
            let slipping = self.at.free.plus_scaled(T::one(), given);
            let m = self.contacts.mechanism;
            let slip = self.acted.selection.selected_contact_rates(&m.contact_rates(
                self.at.t,
                self.at.q,
                &slipping.value,
            ));
            let rotated = problem.friction_correction_for_rotation(&start, &slip);
            offset += rotated.impulses;
            let mut slips = ContactRowDerivatives::zeros();
            self.add_contact_velocity_by_displacement(
                &mut slips,
                &self.contact_velocity_derivatives(&slipping.value),
            );
            slips.add_product(&self.jacobian, &slipping);
            derivatives.add_rows(&rotated.by_impulses, &starts);
            derivatives.add_rows(&rotated.by_slip, &slips);
        }
        (offset, Some(derivatives))
    }

    /// Subtracts the derivatives of the normal velocities that restitution demands.
    fn subtract_restitution_derivatives(&self, rates: &mut ContactRowDerivatives<T, CR, NV, NU>) {
        let ContactsWithImpulses { problem, selection, .. } = self.acted;
        if !problem.demands_restitution() {
            return;
        }
        let (ContactStepStart { mechanism: m, manifold, start }, at) = (self.contacts, self.at);
        let velocity = VectorWithDerivatives::start_velocity_with_derivatives(start.1);
        let carried = match at.motion {
            None => velocity,
            Some(motion) => manifold.transport_between(at.t, (start.0, &velocity), (at.q, motion)),
        };
        let before = selection.selected_contact_rates(&m.contact_rates(at.t, at.q, &carried.value));
        let factors = problem.restitution_derivatives(&before);
        let mut before = ContactRowDerivatives::zeros();
        self.add_contact_velocity_by_displacement(
            &mut before,
            &self.contact_velocity_derivatives(&carried.value),
        );
        before.add_product(&self.jacobian, &carried);
        rates.add_rows(&SMatrix::from_diagonal(&-factors), &before);
    }

    /// Returns the displacement that closes gaps at the end of a step, with its derivatives; `None` if there
    /// is no such displacement. `q` is the configuration before the displacement.
    fn closing_displacement(
        &self,
        closing: &GapClosingDisplacement<T, CK, CR>,
        (q, motion): &ConfigurationWithDerivatives<T, NQ, NV, NU>,
    ) -> Option<VectorWithDerivatives<T, NV, NU>> {
        let ContactsWithImpulses { problem, selection, impulses, .. } = self.acted;
        let GapClosingDisplacement { gaps, reach, pushes, part } = closing;
        if *part == T::zero() {
            return None;
        }
        let (closed, kept) =
            problem.closed_rows(impulses, (gaps, touching_distance(), *reach), pushes.as_ref());
        let jacobian =
            selected_contact_rows(selection, &self.contacts.mechanism.contact_jacobian(self.at.t, q));
        let mut rates = ContactRowDerivatives::zeros();
        rates.add_product(&jacobian, motion);
        let mut rows = problem.indicator_matrix_of_rows(&closed);
        let mut by = VectorWithDerivatives { value: zeros(), by_q: zeros(), by_v: zeros(), by_u: zeros() };
        // The gaps of these contacts stay the same.
        let mut all = ContactRowDerivatives::zeros();
        all.add_rows(&rows, &rates);
        if let Some(pushes) = pushes {
            by.value = self.responses * pushes;
            let by_place = self.displacement_derivatives(&by.value, pushes);
            self.add_velocity_change_by_displacement(&mut by, &by_place.velocities);
            let mut more = ContactRowDerivatives::zeros();
            self.add_contact_velocity_by_displacement(&mut more, &by_place.rates);
            more.add_product(&self.jacobian, &by);
            rows += problem.indicator_matrix_of_rows(&kept);
            all.add_rows(&rows, &more);
        }
        let mut held = closed;
        held.iter_mut().zip(kept.iter()).for_each(|(held, kept)| *held |= *kept);
        all.impulse_derivatives(&problem.velocity_preserving_equations(&held))
            .add_velocity_change(self.responses, &mut by);
        Some(by.scaled_derivatives(*part))
    }
}

/// Returns the rows of selected contacts.
fn selected_contact_rows<T: Real, const NV: usize, const NR: usize, const CK: usize, const CR: usize>(
    selection: &ContactSelection<CK, CR>,
    all: &SMatrix<T, NR, NV>,
) -> SMatrix<T, CR, NV> {
    let mut rows = zeros::<T, CR, NV>();
    for (to, from) in rows.data.0.iter_mut().zip(&all.data.0) {
        *to = selection.selected_contact_rates(&SVector::from(*from)).data.0[0];
    }
    rows
}
