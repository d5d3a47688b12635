//! A mechanism with its inputs: the ordinary differential equation to be integrated.

use super::event_driven::{EventLocatedStepVisitor, Section};
use super::local::TimeShiftedSystem;
use super::{Error, Method, State, Step};
use crate::constraint::{ConstraintError, Projected};
use crate::contact::{Assumed, Touched};
use crate::private::{constant, epsilon, to_f64};
use crate::{Mechanism, Real};
use nalgebra::{SMatrix, SVector};

/// Inputs `u` of a mechanism over time, implemented for all input types that `simulate` accepts.
pub trait Inputs<T: Real, const NQ: usize, const NV: usize, const NU: usize> {
    /// Returns the inputs at a time and state.
    fn evaluate(&mut self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NU>;

    /// Returns the control period, s, of inputs that are constant within each period.
    fn period(&self) -> Option<T> {
        None
    }

    /// Notifies the inputs that a control period begins, so that a digital controller computes new values.
    fn renew(&mut self, _t: T, _q: &SVector<T, NQ>, _v: &SVector<T, NV>) {}
}

/// Inputs that are always zero.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoInputs;

impl<T: Real, const NQ: usize, const NV: usize, const NU: usize> Inputs<T, NQ, NV, NU> for NoInputs {
    fn evaluate(&mut self, _t: T, _q: &SVector<T, NQ>, _v: &SVector<T, NV>) -> SVector<T, NU> {
        SVector::zeros()
    }
}

/// Inputs as a function of time and state, evaluated at each evaluation of the dynamics.
#[derive(Clone, Copy, Debug)]
pub struct ContinuousInputs<F>(
    /// User function `|t, q, v| u`, which returns the inputs at a time and state.
    pub F,
);

impl<T, F, const NQ: usize, const NV: usize, const NU: usize> Inputs<T, NQ, NV, NU> for ContinuousInputs<F>
where
    T: Real,
    F: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NU>,
{
    fn evaluate(&mut self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NU> {
        (self.0)(t, q, v)
    }
}

/// Inputs of a digital controller: a function evaluated once per control period, with zero-order hold.
#[derive(Clone, Copy, Debug)]
pub struct SampledInputs<T, F, const NU: usize> {
    period: T,
    control: F,
    u: SVector<T, NU>,
}

impl<T: Real, F, const NU: usize> SampledInputs<T, F, NU> {
    /// Returns inputs that evaluate `control(t, q, v)` every `period` seconds.
    pub fn new(period: T, control: F) -> Self {
        Self { period, control, u: SVector::zeros() }
    }
}

impl<T, F, const NQ: usize, const NV: usize, const NU: usize> Inputs<T, NQ, NV, NU>
    for SampledInputs<T, F, NU>
where
    T: Real,
    F: FnMut(T, &SVector<T, NQ>, &SVector<T, NV>) -> SVector<T, NU>,
{
    fn evaluate(&mut self, _t: T, _q: &SVector<T, NQ>, _v: &SVector<T, NV>) -> SVector<T, NU> {
        self.u
    }

    fn period(&self) -> Option<T> {
        Some(self.period)
    }

    fn renew(&mut self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) {
        self.u = (self.control)(t, q, v);
    }
}

/// Functions of a mechanism under its inputs that integrators use. Shapes, units and frames as in
/// [`Mechanism`](crate::Mechanism).
pub trait Dynamics<T: Real, const NQ: usize, const NV: usize> {
    /// Returns the time of the simulation at the method's time `t`, which may count from another origin.
    fn time(&self, t: T) -> T {
        t
    }

    /// Returns the configuration `q ⊕ dv`: `q` displaced by the tangent vector `dv`.
    fn integrate(&self, q: &SVector<T, NQ>, dv: &SVector<T, NV>) -> SVector<T, NQ>;

    /// Returns the rate of the displacement `dv` for which the configuration `q ⊕ dv` moves with velocity
    /// `v`.
    fn tangent_rate(&self, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV>;

    /// Returns the rate of the displacement `dv` from `q` for which `q ⊕ dv` moves with velocity `v`. Equals
    /// [`tangent_rate`](Self::tangent_rate) unless the mechanism declares generalized speeds
    /// ([`Mechanism::displacement_rate`](crate::Mechanism::displacement_rate)).
    fn displacement_rate(
        &self,
        _q: &SVector<T, NQ>,
        dv: &SVector<T, NV>,
        v: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.tangent_rate(dv, v)
    }

    /// Whether generalized speeds are declared ([`SPEEDS`](crate::integrate::Hooks::SPEEDS)); a
    /// displacement with a constant velocity `v` then differs from `h v`.
    fn has_speeds(&self) -> bool {
        false
    }

    /// Returns the numbers of coordinates and velocities in use; further entries of vectors are padding.
    fn dimensions(&self) -> [usize; 2] {
        [NQ, NV]
    }

    /// Returns the acceleration `v̇` under the inputs at time `t`.
    fn acceleration(&mut self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NV>;

    /// Whether constraints restrict the state of the mechanism.
    fn is_constrained(&self) -> bool;

    /// Projects a state onto the constraints: returns the nearest state that satisfies them.
    ///
    /// # Errors
    ///
    /// [`ConstraintError`] if no such state is found.
    fn project(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> Result<Projected<T, NQ, NV>, ConstraintError>;

    /// Returns the generalized momentum `p`; for constraints enforced by feedback, the velocity.
    fn momentum(&self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NV>;

    /// Returns the rate of the generalized momentum, `ṗ`, under the inputs at time `t`. Constraint forces are
    /// not included, except if friction depends on them.
    fn momentum_rate(&mut self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NV>;

    /// Returns the part of the momentum rate `ṗ` that depends on the velocity, from inertia and dashpots,
    /// without inputs.
    fn velocity_dependent_momentum_rate(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> SVector<T, NV>;

    /// Returns the velocity for the generalized momentum `p`, refined from the estimate `v`: exact up to
    /// rounding for any estimate, most accurate for a close one. Constraint impulses make the velocity
    /// satisfy the constraints.
    fn velocity(&self, t: T, q: &SVector<T, NQ>, p: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV>;

    /// Returns the change of the velocity `v` due to the generalized impulse `p` and the constraint impulses.
    /// The constraints are satisfied to first order after the new velocity has lasted for `h` seconds
    /// ([`velocity_change_by_impulse`](crate::integrate::Hooks::velocity_change_by_impulse)).
    fn velocity_change_by_impulse(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        h: T,
        p: &SVector<T, NV>,
    ) -> SVector<T, NV>;

    /// Returns the change of the acceleration `v̇` due to additional generalized forces `p`. In singular
    /// configurations, the constraints are those of the motion with velocity `v` through the configuration.
    fn response(
        &mut self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        p: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.velocity_change_by_impulse(t, q, v, T::zero(), p)
    }

    /// Returns the velocity `v` expressed in the axes of ball and free joints after the displacement `dv`,
    /// for mechanisms with contacts.
    fn carry(&self, t: T, q: &SVector<T, NQ>, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV>;

    /// Returns the rate of [`carry`](Self::carry) for a displacement that grows at the rate `dv`
    /// ([`Hooks::carry_rate`](super::Hooks::carry_rate)).
    fn carry_rate(&self, t: T, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV>;

    /// Returns the part of a displacement that is linear velocities of free joints
    /// ([`Hooks::translation`](super::Hooks::translation)).
    fn translation(&self, t: T, dv: &SVector<T, NV>) -> SVector<T, NV>;

    /// Applies the contact impulses of a step of `h` seconds. The step starts at the configuration and
    /// velocity `start`; without contacts it ends at the configuration and velocity `end`, and during it
    /// contacts were assumed to add the first entry of `given` to the velocity.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Contact`] for mechanisms with contacts.
    fn contact_step(
        &self,
        t: T,
        start: (&SVector<T, NQ>, &SVector<T, NV>),
        end: (&SVector<T, NQ>, &SVector<T, NV>),
        given: Assumed<'_, T, NV>,
        h: T,
    ) -> Result<Touched<T, NQ, NV>, ConstraintError>;

    /// Advances a step of a mechanism with contacts and locates its events; `None` for mechanisms without
    /// contacts.
    fn follow(&mut self, _section: Section<'_, T, NQ, NV>) -> Option<Result<Step<T, NQ, NV>, Error>> {
        None
    }

    /// Whether constraints nearly lose rank at `q`, relative to their change over a displacement by `dv`
    /// ([`is_nearly_singular`](crate::integrate::Hooks::is_nearly_singular)).
    fn is_nearly_singular(&self, _t: T, _q: &SVector<T, NQ>, _dv: &SVector<T, NV>) -> bool {
        false
    }

    /// Returns `(∂v̇/∂q, ∂v̇/∂v)` under the inputs at time `t`, if the mechanism has generated derivatives;
    /// otherwise methods use finite differences. Derivatives with respect to `q` are along displacements of
    /// the configuration ([`Derivatives`](crate::Derivatives)).
    fn acceleration_derivatives(
        &mut self,
        _t: T,
        _q: &SVector<T, NQ>,
        _v: &SVector<T, NV>,
    ) -> Option<(SMatrix<T, NV, NV>, SMatrix<T, NV, NV>)> {
        None
    }
}

/// Mechanism together with its inputs, whose dynamics an integration method evaluates.
#[derive(Debug)]
pub struct System<'m, M, I, const NU: usize> {
    /// Mechanism to be integrated.
    pub mechanism: &'m M,
    /// Source of the inputs of the mechanism.
    pub inputs: I,
    /// Reason why the last requested acceleration is undetermined.
    undetermined: Option<ConstraintError>,
}

impl<M, I: Clone, const NU: usize> Clone for System<'_, M, I, NU> {
    fn clone(&self) -> Self {
        Self { inputs: self.inputs.clone(), ..*self }
    }
}

impl<'m, M, I, const NU: usize> System<'m, M, I, NU> {
    /// Returns the system of a mechanism and the source of its inputs.
    pub fn new(mechanism: &'m M, inputs: I) -> Self {
        Self { mechanism, inputs, undetermined: None }
    }

    /// Advances a step of a method, which counts time from `origin`, as do its start, its end and `until`;
    /// the times of errors count from zero. If the step fails because forces determine no acceleration, the
    /// error contains the reason.
    ///
    /// # Errors
    ///
    /// The errors of [`Method::advance`], and [`Error::Constraint`].
    pub(crate) fn advance_step<T: Real, S: Method<T>, const NQ: usize, const NV: usize>(
        &mut self,
        method: &S,
        memory: &mut S::Memory<NV>,
        origin: T,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        dense: bool,
    ) -> Result<Step<T, NQ, NV>, Error>
    where
        M: Mechanism<NQ, NV, NU, Scalar = T>,
        I: Inputs<T, NQ, NV, NU>,
    {
        const {
            assert!(
                !M::CONTACTING || S::CONTACTS,
                "this mechanism has contacts, which this method of integration does not support: simulate it \
                 with `.method(TimeStepping::step(1e-3))` or `.method(EventDriven::new())`, or without its \
                 contacts by `&contact::apart(&mechanism)`"
            );
            assert!(
                !(M::CONTACTING && S::LOCATES) || M::LOCATABLE,
                "events at the contacts of this mechanism cannot be located, as those of lanes, states of \
                 first order and stabilised constraints: simulate it with \
                 `.method(TimeStepping::step(1e-3))`"
            );
        }
        self.undetermined = None;
        let mut local = TimeShiftedSystem { system: &mut *self, origin };
        let step = method.advance(memory, &mut local, start, until, dense);
        step.map_err(|error| match (error.shift_time_origin(to_f64(origin)), self.undetermined) {
            (
                Error::NotFinite { t } | Error::StepTooSmall { t, .. } | Error::NotConverged { t, .. },
                Some(reason),
            ) => Error::Constraint { t, reason },
            (error, _) => error,
        })
    }

    fn input_forces<T: Real, const NQ: usize, const NV: usize>(
        &mut self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> SVector<T, NV>
    where
        M: Mechanism<NQ, NV, NU, Scalar = T>,
        I: Inputs<T, NQ, NV, NU>,
    {
        if NU == 0 {
            return SVector::zeros();
        }
        self.mechanism.generalized_forces(t, q, v, &self.inputs.evaluate(t, q, v))
    }
}

impl<T, M, I, const NQ: usize, const NV: usize, const NU: usize> Dynamics<T, NQ, NV> for System<'_, M, I, NU>
where
    T: Real,
    M: Mechanism<NQ, NV, NU, Scalar = T>,
    I: Inputs<T, NQ, NV, NU>,
{
    fn integrate(&self, q: &SVector<T, NQ>, dv: &SVector<T, NV>) -> SVector<T, NQ> {
        self.mechanism.integrate(q, dv)
    }

    fn tangent_rate(&self, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.mechanism.tangent_rate(dv, v)
    }

    fn displacement_rate(
        &self,
        q: &SVector<T, NQ>,
        dv: &SVector<T, NV>,
        v: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.mechanism.displacement_rate(q, dv, v)
    }

    fn has_speeds(&self) -> bool {
        self.mechanism.features().speeds
    }

    fn dimensions(&self) -> [usize; 2] {
        self.mechanism.features().dimensions
    }

    fn acceleration(&mut self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NV> {
        let tau = self.input_forces(t, q, v);
        self.mechanism.try_forward_dynamics(t, q, v, &tau).unwrap_or_else(|reason| {
            self.undetermined = Some(reason);
            SVector::repeat(constant(f64::NAN))
        })
    }

    fn is_constrained(&self) -> bool {
        self.mechanism.features().constrained
    }

    fn project(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> Result<Projected<T, NQ, NV>, ConstraintError> {
        self.mechanism.project(t, q, v)
    }

    fn momentum(&self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NV> {
        if self.mechanism.features().feedback { *v } else { self.mechanism.generalized_momentum(t, q, v) }
    }

    fn momentum_rate(&mut self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NV> {
        if self.mechanism.features().feedback {
            return self.acceleration(t, q, v);
        }
        let rate = self.mechanism.momentum_rate(t, q, v);
        if self.mechanism.features().slipping {
            // Forces at this acceleration: inputs, constraints, and the friction that depends on the
            // constraint forces.
            let acceleration = self.acceleration(t, q, v);
            return rate + self.mechanism.inverse_dynamics(t, q, v, &acceleration);
        }
        rate + self.input_forces(t, q, v)
    }

    fn velocity_dependent_momentum_rate(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.mechanism.momentum_rate(t, q, v) - self.mechanism.momentum_rate(t, q, &SVector::zeros())
    }

    fn velocity(&self, t: T, q: &SVector<T, NQ>, p: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        if self.mechanism.features().feedback {
            return *p;
        }
        // The momentum is M v + b: with τ = h + p − (M v + b) the equation of motion M a + h = τ has the
        // solution a = M⁻¹ (p − b) − v.
        let missing = p - self.mechanism.generalized_momentum(t, q, v);
        v + self.mechanism.velocity_change_by_impulse(t, q, v, T::zero(), &missing)
    }

    fn velocity_change_by_impulse(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        h: T,
        p: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.mechanism.velocity_change_by_impulse(t, q, v, h, p)
    }

    fn response(
        &mut self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        p: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        let mut acceleration_under_forces = |tau: &SVector<T, NV>| {
            self.mechanism.try_forward_dynamics(t, q, v, tau).unwrap_or_else(|reason| {
                self.undetermined = Some(reason);
                SVector::repeat(constant(f64::NAN))
            })
        };
        acceleration_under_forces(p) - acceleration_under_forces(&SVector::zeros())
    }

    fn carry(&self, t: T, q: &SVector<T, NQ>, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.mechanism.carry(t, q, dv, v)
    }

    fn carry_rate(&self, t: T, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.mechanism.carry_rate(t, dv, v)
    }

    fn translation(&self, t: T, dv: &SVector<T, NV>) -> SVector<T, NV> {
        self.mechanism.translation(t, dv)
    }

    fn contact_step(
        &self,
        t: T,
        start: (&SVector<T, NQ>, &SVector<T, NV>),
        end: (&SVector<T, NQ>, &SVector<T, NV>),
        given: Assumed<'_, T, NV>,
        h: T,
    ) -> Result<Touched<T, NQ, NV>, ConstraintError> {
        self.mechanism.contact_step(t, start, end, given, h)
    }

    fn follow(&mut self, section: Section<'_, T, NQ, NV>) -> Option<Result<Step<T, NQ, NV>, Error>> {
        self.mechanism.visit_contacts(EventLocatedStepVisitor { section, inputs: &mut self.inputs })
    }

    fn is_nearly_singular(&self, t: T, q: &SVector<T, NQ>, dv: &SVector<T, NV>) -> bool {
        self.mechanism.features().constrained && self.mechanism.is_nearly_singular(t, q, dv)
    }

    /// Returns the derivatives of the acceleration by the chain rule: only the inputs, which may depend on
    /// the state, are differentiated by finite differences.
    fn acceleration_derivatives(
        &mut self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> Option<(SMatrix<T, NV, NV>, SMatrix<T, NV, NV>)> {
        let u = if NU == 0 { SVector::zeros() } else { self.inputs.evaluate(t, q, v) };
        let (mut by_q, mut by_v, by_u) = self.mechanism.acceleration_derivatives(t, q, v, &u)?;
        if NU == 0 || self.inputs.period().is_some() {
            return Some((by_q, by_v));
        }
        let root = epsilon::<T>().sqrt();
        for k in 0..self.mechanism.features().dimensions[1].min(NV) {
            let size = root * v[k].abs().max(T::one());
            let step_along_coordinate =
                |size: T| SVector::<T, NV>::from_fn(|i, _| if i == k { size } else { T::zero() });
            let moved =
                self.inputs.evaluate(t, &self.mechanism.integrate(q, &step_along_coordinate(root)), v);
            let faster = self.inputs.evaluate(t, q, &(v + step_along_coordinate(size)));
            by_q.column_mut(k).gemv(T::one() / root, &by_u, &(moved - u), T::one());
            by_v.column_mut(k).gemv(T::one() / size, &by_u, &(faster - u), T::one());
        }
        Some((by_q, by_v))
    }
}
