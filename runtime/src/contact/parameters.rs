//! Derivatives of a step with contacts with respect to the parameters of a mechanism.
//!
//! Derivatives with respect to parameters are those with respect to inputs of a mechanism whose inputs are
//! the parameters: the force of such an input is the change of the generalized forces minus that of the
//! inverse dynamics. Contacts also depend on parameters directly ([`ContactSensitivities`]).

use super::derivatives::{ContactDerivatives, FirstOrder};
use super::sensitivity::differentiate_step;
use super::{Contacts, Law, Responses, Rows};
use crate::blocks::zeros;
use crate::constraint::Visitor;
use crate::derivatives::ByMotion;
use crate::discrete::Transition;
use crate::forward::each_function;
use crate::integrate::{Error, Features, Hooks, TimeStepping};
use crate::{Derivatives, Mechanism, Real, Sensitivities};
use nalgebra::{SMatrix, SVector};

/// Mechanisms whose contacts have derivatives with respect to the parameters. `#[mechanism(…, derivatives,
/// sensitivities)]` implements this trait for mechanisms with contacts, parameters, and neither constraints
/// nor declared speeds.
pub trait ContactSensitivities<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NP: usize,
    const NK: usize,
    const NR: usize,
>: ContactDerivatives<NQ, NV, NU, NK, NR> + Sensitivities<NQ, NV, NU, NP>
{
    /// Returns the derivatives of the contacts with respect to the parameters, at constant configuration,
    /// velocity and contact forces `forces`, N and N·m. Time `t` as for [`Contacts`].
    fn contact_derivatives_by_parameters(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        forces: &SVector<Self::Scalar, NR>,
    ) -> ContactsByParameters<Self::Scalar, NV, NP, NK, NR>;
}

/// Derivatives of contacts with respect to parameters, one column for each parameter, at constant
/// configuration, velocity and contact forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactsByParameters<T, const NV: usize, const NP: usize, const NK: usize, const NR: usize> {
    /// Derivatives of the generalized contact forces `Gᵀ f`.
    pub forces: SMatrix<T, NV, NP>,
    /// Derivatives of the contact velocities.
    pub rates: SMatrix<T, NR, NP>,
    /// Derivatives of the gaps.
    pub gaps: SMatrix<T, NK, NP>,
    /// Derivatives of the coefficients of kinetic friction.
    pub friction: SMatrix<T, NK, NP>,
    /// Derivatives of the coefficients of restitution.
    pub restitution: SMatrix<T, NK, NP>,
}

impl<T: Real, const NV: usize, const NP: usize, const NK: usize, const NR: usize>
    ContactsByParameters<T, NV, NP, NK, NR>
{
    /// Returns the derivatives from a list of all entries, one parameter after another. Generated code calls
    /// this function.
    #[doc(hidden)]
    pub fn from_list<const N: usize>(list: &[T; N]) -> Self {
        let mut found =
            Self { forces: zeros(), rates: zeros(), gaps: zeros(), friction: zeros(), restitution: zeros() };
        let mut values = list.iter();
        for k in 0..NP {
            for column in [
                found.forces.data.0.get_mut(k).map(<[T; NV]>::as_mut_slice),
                found.rates.data.0.get_mut(k).map(<[T; NR]>::as_mut_slice),
                found.gaps.data.0.get_mut(k).map(<[T; NK]>::as_mut_slice),
                found.friction.data.0.get_mut(k).map(<[T; NK]>::as_mut_slice),
                found.restitution.data.0.get_mut(k).map(<[T; NK]>::as_mut_slice),
            ] {
                let entries = column.unwrap_or_default().iter_mut();
                entries.zip(values.by_ref()).for_each(|(entry, value)| *entry = *value);
            }
        }
        found
    }
}

/// Returns the derivatives of configuration and velocity after a time-stepping step with respect to the
/// parameters. Generated code calls this function.
///
/// # Errors
///
/// The errors of [`discrete::transition`](crate::discrete::transition).
#[allow(clippy::type_complexity, reason = "two matrices")]
pub fn differentiate_step_by_parameters<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NP: usize,
    const NK: usize,
    const NR: usize,
>(
    mechanism: &M,
    method: &TimeStepping<T>,
    t: T,
    state: (&SVector<T, NQ>, &SVector<T, NV>),
    u: &SVector<T, NU>,
) -> Result<(SMatrix<T, NV, NP>, SMatrix<T, NV, NP>), Error>
where
    T: Real,
    M: ContactSensitivities<NQ, NV, NU, NP, NK, NR, Scalar = T>,
{
    let mut step = Transition::<T, NQ, NV, NP>::zeros();
    differentiate_step(&ParametersAsInputs { mechanism, u }, method, t, state, &SVector::zeros(), &mut step)?;
    Ok((step.q_by_u, step.v_by_u))
}

/// Mechanism under constant inputs `u`, whose parameters take the place of the inputs.
pub(crate) struct ParametersAsInputs<'a, M, T, const NU: usize> {
    pub(crate) mechanism: &'a M,
    pub(crate) u: &'a SVector<T, NU>,
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NP: usize> Mechanism<NQ, NV, NP>
    for ParametersAsInputs<'_, M, T, NU>
where
    T: Real,
    M: Sensitivities<NQ, NV, NU, NP, Scalar = T>,
{
    type Scalar = T;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NV] = M::VELOCITIES;
    const INPUTS: [&'static str; NP] = M::PARAMETERS;
    const VELOCITY_UNITS: [&'static str; NV] = M::VELOCITY_UNITS;
    const INPUT_UNITS: [&'static str; NP] = [""; NP];

    each_function!(space, plain Mechanism, self => self.mechanism);
    each_function!(inputless_dynamics, pass Mechanism, self => self.mechanism);
    each_function!(accelerations, pass Mechanism, self => self.mechanism);

    fn generalized_forces(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        _parameters: &SVector<T, NP>,
    ) -> SVector<T, NV> {
        self.mechanism.generalized_forces(t, q, v, self.u)
    }
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NP: usize> Hooks<T, NQ, NV, NP>
    for ParametersAsInputs<'_, M, T, NU>
where
    T: Real,
    M: Sensitivities<NQ, NV, NU, NP, Scalar = T>,
{
    const CONSTRAINED: bool = M::CONSTRAINED;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = M::FEEDBACK;
    const CONTACTING: bool = M::CONTACTING;
    const LOCATABLE: bool = false;
    const FIRST_ORDER: usize = M::FIRST_ORDER;
    const SPEEDS: bool = M::SPEEDS;

    #[inline(always)]
    fn features(&self) -> Features {
        self.mechanism.features()
    }

    each_function!(contact_methods, [T] pass Hooks, self => self.mechanism);
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NP: usize> Derivatives<NQ, NV, NP>
    for ParametersAsInputs<'_, M, T, NU>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T> + Sensitivities<NQ, NV, NU, NP, Scalar = T>,
{
    const MOMENTUM_DERIVATIVES: bool = M::MOMENTUM_DERIVATIVES;
    const DIRECT_INPUTS: Option<[usize; NP]> = None;
    const TURNED: Option<(usize, usize)> = M::TURNED;

    each_function!(tangent, plain Derivatives, self => self.mechanism);
    each_function!(inputless_derivatives, pass Derivatives, self => self.mechanism);
    each_function!(acceleration_derivatives, pass Derivatives, self => self.mechanism);

    fn generalized_forces_derivatives(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        _parameters: &SVector<T, NP>,
    ) -> ByMotion<T, NV, NP> {
        let (m, u) = (self.mechanism, self.u);
        let (by_q, by_v, _) = m.generalized_forces_derivatives(t, q, v, u);
        let a = m.forward_dynamics(t, q, v, &m.generalized_forces(t, q, v, u));
        let by_parameters =
            m.generalized_forces_by_parameters(t, q, v, u) - m.inverse_dynamics_by_parameters(t, q, v, &a);
        (by_q, by_v, by_parameters)
    }

    fn visit_constraints<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: Visitor<T, NQ, NV, NP>,
    {
        None
    }

    fn linear_motion(
        &self,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        parameters: &SVector<T, NP>,
    ) -> crate::LinearMotion<T, NV, NP>
    where
        Self: crate::Scleronomic,
    {
        crate::derivatives::linear_motion(self, q, v, parameters)
    }
}

impl<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NP: usize,
    const NK: usize,
    const NR: usize,
> Contacts<NQ, NV, NP, NK, NR> for ParametersAsInputs<'_, M, T, NU>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T> + Sensitivities<NQ, NV, NU, NP, Scalar = T>,
{
    const CONTACTS: [&'static str; NK] = M::CONTACTS;
    const CONTACT_ROWS: [Rows; NK] = M::CONTACT_ROWS;
    const PRESSED_BY: [usize; NK] = M::PRESSED_BY;

    #[inline(always)]
    fn contact_tables(&self) -> ([Rows; NK], [usize; NK]) {
        self.mechanism.contact_tables()
    }

    #[inline(always)]
    fn contact_columns(&self) -> [(usize, usize); NK] {
        self.mechanism.contact_columns()
    }

    #[inline(always)]
    fn contacts_drift(&self) -> bool {
        self.mechanism.contacts_drift()
    }

    #[inline(always)]
    fn contact_gaps(&self, t: T, q: &SVector<T, NQ>) -> SVector<T, NK> {
        self.mechanism.contact_gaps(t, q)
    }

    #[inline(always)]
    fn contact_rates(&self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NR> {
        self.mechanism.contact_rates(t, q, v)
    }

    #[inline(always)]
    fn contact_jacobian(&self, t: T, q: &SVector<T, NQ>) -> SMatrix<T, NR, NV> {
        self.mechanism.contact_jacobian(t, q)
    }

    #[inline(always)]
    fn contact_bias(&self, t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NR> {
        self.mechanism.contact_bias(t, q, v)
    }

    #[inline(always)]
    fn contact_responses(&self, t: T, q: &SVector<T, NQ>, closed: &[bool; NK]) -> Responses<T, NV, NR> {
        self.mechanism.contact_responses(t, q, closed)
    }

    #[inline(always)]
    fn contact_laws(&self) -> [Law<T>; NK] {
        self.mechanism.contact_laws()
    }
}

impl<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NP: usize,
    const NK: usize,
    const NR: usize,
> ContactDerivatives<NQ, NV, NP, NK, NR> for ParametersAsInputs<'_, M, T, NU>
where
    T: Real,
    M: ContactSensitivities<NQ, NV, NU, NP, NK, NR, Scalar = T>,
{
    fn contact_derivatives(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        a: &SVector<T, NV>,
        forces: &SVector<T, NR>,
    ) -> FirstOrder<T, NV, NR> {
        self.mechanism.contact_derivatives(t, q, v, a, forces)
    }

    fn contact_derivatives_by_inputs(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        forces: &SVector<T, NR>,
    ) -> Option<ContactsByParameters<T, NV, NP, NK, NR>> {
        Some(self.mechanism.contact_derivatives_by_parameters(t, q, v, forces))
    }

    fn momentum_change_by_inputs(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        change: &SVector<T, NV>,
    ) -> Option<SMatrix<T, NV, NP>> {
        let (m, still) = (self.mechanism, SVector::zeros());
        let at_rest = m.inverse_dynamics_by_parameters(t, q, &still, &still);
        Some(m.inverse_dynamics_by_parameters(t, q, &still, change) - at_rest)
    }
}
