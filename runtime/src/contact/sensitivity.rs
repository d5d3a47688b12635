//! Derivatives of a step with contacts.
//!
//! Each quantity of a step has its derivatives with respect to the state before the step and to the inputs.
//! The impulses are differentiated implicitly: the contact modes are those that the step has found, and the
//! conditions that hold with equality in these modes are linearised. The effect of constant impulses `Λ`
//! changes with the configuration by `M⁻¹ (∂(Gᵀ Λ)/∂q − ∂(M a)/∂q)` with `a = M⁻¹ Gᵀ Λ`.

mod rows;

use super::derivatives::ContactDerivatives;
use super::impulses::Impulses;
use super::observer::{GapClosingDisplacement, ImpulseObserver};
use super::problem::ImpulseEquations;
use super::response::CholeskyFactor;
use super::solution::ContactsWithImpulses;
use super::stepping::observed_step;
use super::{Touched, touching_distance};
use crate::blocks::{add_multiple, add_product, product, zeros};
use crate::constraint::ConstraintError;
use crate::discrete::{
    ConfigurationManifold, DifferentiatedStepStart, Transition, VectorWithDerivatives,
    motion_under_contact_forces, smooth_acceleration_at_start,
};
use crate::integrate::{Error, TimeStepping};
use crate::private::{constant, to_f64};
use crate::{Derivatives, Real};
use nalgebra::{SMatrix, SVector};
use rows::{ContactRowDerivatives, add_scaled_rows, copy_row, selected_contact_rows};

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
    let rate =
        after.map(|(after, _)| after.plus_scaled(-T::one(), &free).scaled_with_derivatives(T::one() / h));
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
        self.displaced_state((at.t, place), &change.scaled_with_derivatives(at.h * constant(0.5)), after)
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
            let index = acted.selection.mechanism_index_of_contact(contact);
            let constraint = M::CONTACTS.get(index).copied().unwrap_or_default();
            ConstraintError::NoDerivatives { constraint }
        };
        let regular = acted
            .problem
            .check_impulses_are_differentiable(&acted.impulses)
            .map_err(underivable_contact_error);
        self.found = Some(regular.map(|()| {
            let closed = ClosedContacts::new(self.contacts, self.at, acted, &responses);
            let after = closed.velocity_after_impulses();
            let Some(closing) = closing else { return (after, None) };
            let (place, v) = self.contacts.state_after_contact_impulses(self.at, &after);
            let end = match closed.differentiated_gap_closing_displacement(closing, &place) {
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
    inertia: InertiaAtImpulses<T, NV>,
}

/// Effect of generalized impulses on velocities.
enum InertiaAtImpulses<T, const NV: usize> {
    /// Factor of the mass matrix, and the derivative of the forces at rest with respect to the configuration.
    MassMatrix(CholeskyFactor<T, NV>, SMatrix<T, NV, NV>),
    /// Forces depend on accelerations: forces at rest without acceleration, the derivatives of the
    /// accelerations under these forces with respect to the configuration and to forces.
    Response(SVector<T, NV>, SMatrix<T, NV, NV>, SMatrix<T, NV, NV>),
}

/// Derivatives with respect to the configuration, and to inputs that act directly: of the velocity change by
/// constant impulses, and of the contact velocities at a constant velocity.
struct DerivativesAtConstantImpulses<T, const NV: usize, const NU: usize, const CR: usize> {
    velocities: SMatrix<T, NV, NV>,
    velocities_by_u: Option<SMatrix<T, NV, NU>>,
    rates: ContactVelocityDerivatives<T, NV, NU, CR>,
}

/// Derivatives of the contact velocities at a constant velocity with respect to the configuration, and to
/// inputs that act directly.
struct ContactVelocityDerivatives<T, const NV: usize, const NU: usize, const CR: usize> {
    by_q: SMatrix<T, CR, NV>,
    by_u: Option<SMatrix<T, CR, NU>>,
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
        let (m, t, q, still) = (contacts.mechanism, at.t, at.q, SVector::zeros());
        let jacobian = selected_contact_rows(&acted.selection, &m.contact_jacobian(t, q));
        let factor = if m.features().feedback {
            None
        } else {
            CholeskyFactor::cholesky_of_mass_matrix(&m.mass_matrix(t, q))
        };
        let inertia = match factor {
            Some(factor) => {
                InertiaAtImpulses::MassMatrix(factor, m.inverse_dynamics_derivatives(t, q, &still, &still).0)
            }
            None => {
                let bias = m.bias_forces(t, q, &still);
                let (by_q, _, response) = m.forward_dynamics_derivatives(t, q, &still, &bias);
                InertiaAtImpulses::Response(bias, by_q, response)
            }
        };
        Self { contacts, at, acted, responses, jacobian, inertia }
    }

    /// Returns the derivatives of the velocity change by `impulses`, and of the contact velocities at the
    /// velocity `v`.
    fn derivatives_at_constant_impulses(
        &self,
        v: &SVector<T, NV>,
        impulses: &SVector<T, CR>,
    ) -> DerivativesAtConstantImpulses<T, NV, NU, CR> {
        let (m, t, q) = (self.contacts.mechanism, self.at.t, self.at.q);
        let (still, effect) = (SVector::zeros(), self.responses * impulses);
        let (selection, all) =
            (&self.acted.selection, self.acted.selection.impulses_at_mechanism_rows(impulses));
        let parts = m.contact_derivatives(t, q, v, &still, &all);
        let by_inputs = m.contact_derivatives_by_inputs(t, q, v, &all);
        let by_u = by_inputs.as_ref().map(|parts| selected_contact_rows(selection, &parts.rates));
        let rates =
            ContactVelocityDerivatives { by_q: selected_contact_rows(selection, &parts.rates_by_q), by_u };
        let mut momenta_by_u = by_inputs.map(|parts| parts.forces);
        if let (Some(momenta), Some(change)) = (&mut momenta_by_u, m.momentum_change_by_inputs(t, q, &effect))
        {
            *momenta -= change;
        }
        let mut velocities;
        match &self.inertia {
            InertiaAtImpulses::MassMatrix(factor, at_rest) => {
                let mut momenta = m.inverse_dynamics_derivatives(t, q, &still, &effect).0;
                momenta = parts.forces_by_q - momenta + at_rest;
                velocities = factor.solve_all_columns(&momenta);
            }
            InertiaAtImpulses::Response(bias, at_rest, response) => {
                let loaded = bias + self.jacobian.tr_mul(impulses);
                velocities = m.forward_dynamics_derivatives(t, q, &still, &loaded).0 - at_rest;
                add_product(&mut velocities, response, &parts.forces_by_q);
            }
        }
        let velocities_by_u = momenta_by_u.map(|momenta| match &self.inertia {
            InertiaAtImpulses::MassMatrix(factor, _) => factor.solve_all_columns(&momenta),
            InertiaAtImpulses::Response(.., response) => product(response, &momenta),
        });
        DerivativesAtConstantImpulses { velocities, velocities_by_u, rates }
    }

    /// Returns [`derivatives_at_constant_impulses`](Self::derivatives_at_constant_impulses) for a
    /// displacement `v` instead of a velocity: contact velocities of prescribed motions are left out.
    fn derivatives_at_constant_displacement(
        &self,
        v: &SVector<T, NV>,
        impulses: &SVector<T, CR>,
    ) -> DerivativesAtConstantImpulses<T, NV, NU, CR> {
        let mut found = self.derivatives_at_constant_impulses(v, impulses);
        if self.contacts.mechanism.contacts_drift() {
            let still = self.contact_velocity_derivatives(&SVector::zeros());
            found.rates.by_q -= still.by_q;
            if let (Some(by_u), Some(still)) = (&mut found.rates.by_u, still.by_u) {
                *by_u -= still;
            }
        }
        found
    }

    /// Returns the derivatives of contact velocities at the velocity `v`.
    fn contact_velocity_derivatives(&self, v: &SVector<T, NV>) -> ContactVelocityDerivatives<T, NV, NU, CR> {
        let (m, t, q, none) = (self.contacts.mechanism, self.at.t, self.at.q, SVector::zeros());
        let parts = m.contact_derivatives(t, q, v, &SVector::zeros(), &none);
        let by_inputs = m.contact_derivatives_by_inputs(t, q, v, &none);
        let selection = &self.acted.selection;
        ContactVelocityDerivatives {
            by_q: selected_contact_rows(selection, &parts.rates_by_q),
            by_u: by_inputs.map(|parts| selected_contact_rows(selection, &parts.rates)),
        }
    }

    /// Returns the derivatives of the coefficients of friction with respect to the inputs at the rows of
    /// friction, and of those of restitution at the normal rows; `None` if no contact depends on inputs.
    fn coefficient_derivatives(&self) -> Option<[SMatrix<T, CR, NU>; 2]> {
        let none = SVector::zeros();
        let (m, selection) = (self.contacts.mechanism, &self.acted.selection);
        let parts = m.contact_derivatives_by_inputs(self.at.t, self.at.q, &SVector::zeros(), &none)?;
        let (layout, mut rows) = (selection.contact_layout(), [zeros(); 2]);
        let [friction, restitution] = &mut rows;
        for k in 0..selection.contact_count() {
            let contact = selection.mechanism_index_of_contact(k);
            layout.tangent_rows(k).for_each(|i| copy_row(&parts.friction, contact, friction, i));
            copy_row(&parts.restitution, contact, restitution, layout.rows(k).first);
        }
        Some(rows)
    }

    /// Adds to a velocity the change that follows from the displacement of the configuration and from inputs
    /// that act directly, multiplied by a number.
    fn add_direct_velocity_change(
        &self,
        sum: &mut VectorWithDerivatives<T, NV, NU>,
        direct: &DerivativesAtConstantImpulses<T, NV, NU, CR>,
        factor: T,
    ) {
        if let Some(by_u) = &direct.velocities_by_u {
            add_multiple(&mut sum.by_u, factor, by_u);
        }
        let Some(motion) = self.at.motion else {
            return add_multiple(&mut sum.by_q, factor, &direct.velocities);
        };
        let by_place = direct.velocities * factor;
        add_product(&mut sum.by_q, &by_place, &motion.by_q);
        add_product(&mut sum.by_v, &by_place, &motion.by_v);
        add_product(&mut sum.by_u, &by_place, &motion.by_u);
    }

    /// Adds to contact velocities the change that follows from the displacement of the configuration and from
    /// inputs that act directly.
    fn add_direct_contact_velocity(
        &self,
        sum: &mut ContactRowDerivatives<T, CR, NV, NU>,
        direct: &ContactVelocityDerivatives<T, NV, NU, CR>,
    ) {
        if let Some(by_u) = &direct.by_u {
            add_multiple(&mut sum.by_u, T::one(), by_u);
        }
        match self.at.motion {
            Some(motion) => sum.add_matrix_product(&direct.by_q, motion),
            None => add_multiple(&mut sum.by_q, T::one(), &direct.by_q),
        }
    }

    /// Returns the velocity after the impulses, with its derivatives.
    fn velocity_after_impulses(&self) -> VectorWithDerivatives<T, NV, NU> {
        let ContactsWithImpulses { problem, impulses, free: corrected, .. } = self.acted;
        let (equations, is_whole) = problem.linearised_impulse_equations(impulses);
        let impulses = problem.impulses_at_mechanism_rows(impulses);
        let mut after = *self.at.free;
        after.value = corrected + self.responses * impulses;
        let coefficients = self.coefficient_derivatives();
        let friction = coefficients.as_ref().map(|[friction, _]| friction);
        let (mut acting, is_corrected) = (impulses, *corrected != self.at.free.value);
        let transport = self.at.given.filter(|_| is_corrected).map(|given| {
            let half =
                VectorWithDerivatives { value: after.value, ..after.plus_scaled(constant(0.5), given) };
            after = half;
            let transport = self.impulses_of_rotation_correction(given, is_whole, friction);
            acting += transport.0;
            transport.1
        });
        let direct = self.derivatives_at_constant_impulses(&after.value, &acting);
        self.add_direct_velocity_change(&mut after, &direct, T::one());
        if let Some(Some(transported)) = transport {
            transported.add_velocity_change(self.responses, &mut after);
        }
        let mut rates = ContactRowDerivatives::zeros();
        self.add_direct_contact_velocity(&mut rates, &direct.rates);
        rates.add_matrix_product(&self.jacobian, &after);
        let restitution = coefficients.as_ref().map(|[_, restitution]| restitution);
        self.subtract_restitution_derivatives(&mut rates, restitution);
        rates.impulse_derivatives(&equations, friction).add_velocity_change(self.responses, &mut after);
        after
    }

    /// Returns the impulses that the correction for rotating contact forces adds, apart from half of `given`,
    /// and their derivatives. If all contacts stick (`is_whole`), the impulses of the step contain these
    /// derivatives.
    fn impulses_of_rotation_correction(
        &self,
        given: &VectorWithDerivatives<T, NV, NU>,
        is_whole: bool,
        friction: Option<&SMatrix<T, CR, NU>>,
    ) -> (SVector<T, CR>, Option<ContactRowDerivatives<T, CR, NV, NU>>) {
        let (problem, half) = (&self.acted.problem, constant::<T>(0.5));
        let (start, is_regular) = problem
            .impulses_for_contact_changes(&(self.jacobian * given.value), &mut ImpulseEquations::new());
        let start = problem.impulses_without_compression(&start);
        if is_whole {
            return (start * -half, None);
        }
        let left = given.value - self.responses * start;
        let direct = self.derivatives_at_constant_displacement(&left, &start);
        let mut effect = VectorWithDerivatives { value: SVector::zeros(), ..*given };
        self.add_direct_velocity_change(&mut effect, &direct, -T::one());
        let mut rates = ContactRowDerivatives::zeros();
        self.add_direct_contact_velocity(&mut rates, &direct.rates);
        rates.add_matrix_product(&self.jacobian, &effect);
        let starts = rates
            .impulse_derivatives(
                &problem.velocity_preserving_equations(&problem.possible_impulse_row_mask()),
                None,
            )
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
            self.add_direct_contact_velocity(&mut slips, &self.contact_velocity_derivatives(&slipping.value));
            slips.add_matrix_product(&self.jacobian, &slipping);
            derivatives.add_row_matrix_product(&rotated.by_impulses, &starts);
            derivatives.add_row_matrix_product(&rotated.by_slip, &slips);
            if let Some(friction) = friction {
                add_scaled_rows(&mut derivatives.by_u, &rotated.by_friction, friction);
            }
        }
        (offset, Some(derivatives))
    }

    /// Subtracts the derivatives of the normal velocities that restitution demands. `restitution` holds the
    /// derivatives of the coefficients with respect to the inputs, if there are any.
    fn subtract_restitution_derivatives(
        &self,
        rates: &mut ContactRowDerivatives<T, CR, NV, NU>,
        restitution: Option<&SMatrix<T, CR, NU>>,
    ) {
        let ContactsWithImpulses { problem, selection, .. } = self.acted;
        if !problem.demands_restitution() && restitution.is_none() {
            return;
        }
        let (ContactStepStart { mechanism: m, manifold, start }, at) = (self.contacts, self.at);
        let velocity = VectorWithDerivatives::start_velocity_with_derivatives(start.1);
        let carried = match at.motion {
            None => velocity,
            Some(motion) => {
                manifold.transport_velocity_between_configurations(at.t, (start.0, &velocity), (at.q, motion))
            }
        };
        let before = selection.selected_contact_rates(&m.contact_rates(at.t, at.q, &carried.value));
        if let Some(restitution) = restitution {
            let laws = selection.selected_laws(&m.contact_laws());
            let factors = problem.demand_derivatives_by_restitution(&laws, &before);
            add_scaled_rows(&mut rates.by_u, &-factors, restitution);
        }
        if !problem.demands_restitution() {
            return;
        }
        let factors = problem.demand_derivatives_by_velocity(&before);
        let mut before = ContactRowDerivatives::zeros();
        self.add_direct_contact_velocity(&mut before, &self.contact_velocity_derivatives(&carried.value));
        before.add_matrix_product(&self.jacobian, &carried);
        rates.add_scaled_rows(&-factors, &before);
    }

    /// Returns the displacement that closes gaps at the end of a step, with its derivatives; `None` if there
    /// is no such displacement. `q` is the configuration before the displacement.
    fn differentiated_gap_closing_displacement(
        &self,
        closing: &GapClosingDisplacement<T, CK, CR>,
        (q, motion): &ConfigurationWithDerivatives<T, NQ, NV, NU>,
    ) -> Option<VectorWithDerivatives<T, NV, NU>> {
        let ContactsWithImpulses { problem, selection, impulses, .. } = self.acted;
        let GapClosingDisplacement { gaps, reach, pushes, part } = closing;
        if *part == T::zero() {
            return None;
        }
        let (closed, kept) = problem.closed_and_limited_gap_rows(
            impulses,
            (gaps, touching_distance(), *reach),
            pushes.as_ref(),
        );
        let m = self.contacts.mechanism;
        let jacobian = selected_contact_rows(selection, &m.contact_jacobian(self.at.t, q));
        let mut rates = ContactRowDerivatives::zeros();
        rates.add_matrix_product(&jacobian, motion);
        let none = SVector::zeros();
        if let Some(parts) = m.contact_derivatives_by_inputs(self.at.t, q, &SVector::zeros(), &none) {
            let (layout, mut gaps) = (selection.contact_layout(), zeros::<T, CR, NU>());
            for k in 0..selection.contact_count() {
                copy_row(
                    &parts.gaps,
                    selection.mechanism_index_of_contact(k),
                    &mut gaps,
                    layout.rows(k).first,
                );
            }
            rates.by_u += gaps;
        }
        let mut rows = problem.indicator_of_rows(&closed);
        let mut by = VectorWithDerivatives { value: zeros(), by_q: zeros(), by_v: zeros(), by_u: zeros() };
        // The gaps of these contacts stay the same.
        let mut all = ContactRowDerivatives::zeros();
        all.add_scaled_rows(&rows, &rates);
        if let Some(pushes) = pushes {
            by.value = self.responses * pushes;
            let direct = self.derivatives_at_constant_displacement(&by.value, pushes);
            self.add_direct_velocity_change(&mut by, &direct, T::one());
            let mut more = ContactRowDerivatives::zeros();
            self.add_direct_contact_velocity(&mut more, &direct.rates);
            more.add_matrix_product(&self.jacobian, &by);
            rows += problem.indicator_of_rows(&kept);
            all.add_scaled_rows(&rows, &more);
        }
        let mut held = closed;
        held.iter_mut().zip(kept.iter()).for_each(|(held, kept)| *held |= *kept);
        all.impulse_derivatives(&problem.velocity_preserving_equations(&held), None)
            .add_velocity_change(self.responses, &mut by);
        Some(by.scaled_with_derivatives(*part))
    }
}
