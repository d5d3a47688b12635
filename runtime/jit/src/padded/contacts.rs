//! Adapters for the unilateral contacts of robots that are padded to constant dimensions.

use super::{Padded, write_block};
use crate::error::Error;
use crate::internal::InternalFunction;
use crate::names::{NameListKind, placeholder_numbers};
use crate::robot::{Robot, State};
use linkwork::__private::{differentiate_step, held_derivatives};
use linkwork::constraint::Projected;
use linkwork::contact::{self, Assumed, Law, Responses, Restitution, Rows, Touch, Touched, Visitor};
use linkwork::discrete::Transition;
use linkwork::integrate::{self, Features, Hooks, TimeStepping};
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{ByMotion, ConstraintError, Contacts, Mechanism};
use std::borrow::Borrow;

/// Gap of a contact that is padding, m: so large that the contact never closes.
const FAR: f64 = 1e30;

/// Robot with contacts as a [`Mechanism`] of constant dimensions: a [`Padded`] with at most `NK` contacts
/// that have `NR` contact velocities.
#[derive(Clone, Debug)]
pub struct PaddedContacts<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    R = Robot,
> {
    pub(super) plain: Padded<NQ, NV, NU, R>,
}

impl Robot {
    /// Returns the robot with its contacts as a mechanism of constant dimensions, see
    /// [`padded`](Self::padded).
    ///
    /// # Errors
    ///
    /// As [`padded`](Self::padded); the robot has more than `NK` contacts or `NR` rates of contacts.
    pub fn padded_contacts<
        const NQ: usize,
        const NV: usize,
        const NU: usize,
        const NK: usize,
        const NR: usize,
    >(
        &self,
    ) -> Result<PaddedContacts<NQ, NV, NU, NK, NR>, Error> {
        self.validate()?;
        PaddedContacts::new(self.clone())
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize, R: Borrow<Robot>>
    PaddedContacts<NQ, NV, NU, NK, NR, R>
{
    pub(crate) fn new(robot: R) -> Result<Self, Error> {
        let own: &Robot = robot.borrow();
        let (contacts, rates) = (own.shared.contacts.len(), own.shared.contact_rates);
        own.check_length("NK", contacts, contacts.min(NK))?;
        own.check_length("NR", rates, rates.min(NR))?;
        Ok(PaddedContacts { plain: Padded::new(robot)? })
    }

    /// Returns the robot that has been padded to constant dimensions.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        self.plain.robot()
    }

    fn contact_rate_count(&self) -> usize {
        self.robot().shared.contact_rates
    }
}

type Vector<const N: usize> = SVector<f64, N>;

impl<const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize, R: Borrow<Robot>>
    Mechanism<NQ, NV, NU> for PaddedContacts<NQ, NV, NU, NK, NR, R>
{
    type Scalar = f64;

    const CONFIGURATION: [&'static str; NQ] = placeholder_numbers(NameListKind::Configuration);
    const VELOCITIES: [&'static str; NV] = placeholder_numbers(NameListKind::Velocities);
    const INPUTS: [&'static str; NU] = placeholder_numbers(NameListKind::Inputs);

    forward! {
        neutral() -> Vector<NQ>;
        integrate(q: &Vector<NQ>, dv: &Vector<NV>) -> Vector<NQ>;
        difference(from: &Vector<NQ>, to: &Vector<NQ>) -> Vector<NV>;
        tangent_rate(dv: &Vector<NV>, v: &Vector<NV>) -> Vector<NV>;
        displacement_rate(q: &Vector<NQ>, dv: &Vector<NV>, v: &Vector<NV>) -> Vector<NV>;
        mass_matrix(t: f64, q: &Vector<NQ>) -> SMatrix<f64, NV, NV>;
        bias_forces(t: f64, q: &Vector<NQ>, v: &Vector<NV>) -> Vector<NV>;
        inverse_dynamics(t: f64, q: &Vector<NQ>, v: &Vector<NV>, a: &Vector<NV>) -> Vector<NV>;
        forward_dynamics(t: f64, q: &Vector<NQ>, v: &Vector<NV>, tau: &Vector<NV>) -> Vector<NV>;
        try_forward_dynamics(t: f64, q: &Vector<NQ>, v: &Vector<NV>, tau: &Vector<NV>)
            -> Result<Vector<NV>, ConstraintError>;
        generalized_forces(t: f64, q: &Vector<NQ>, v: &Vector<NV>, u: &Vector<NU>) -> Vector<NV>;
        kinetic_energy(t: f64, q: &Vector<NQ>, v: &Vector<NV>) -> f64;
        potential_energy(t: f64, q: &Vector<NQ>) -> f64;
        generalized_momentum(t: f64, q: &Vector<NQ>, v: &Vector<NV>) -> Vector<NV>;
        momentum_rate(t: f64, q: &Vector<NQ>, v: &Vector<NV>) -> Vector<NV>;
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize, R: Borrow<Robot>>
    Hooks<f64, NQ, NV, NU> for PaddedContacts<NQ, NV, NU, NK, NR, R>
{
    const CONTACTING: bool = true;
    const LOCATABLE: bool = true;

    forward! {
        features() -> Features;
        project(t: f64, q: &Vector<NQ>, v: &Vector<NV>) -> Result<Projected<f64, NQ, NV>, ConstraintError>;
        velocity_change_by_impulse(t: f64, q: &Vector<NQ>, v: &Vector<NV>, h: f64, p: &Vector<NV>)
            -> Vector<NV>;
        is_nearly_singular(t: f64, q: &Vector<NQ>, dv: &Vector<NV>) -> bool;
        acceleration_derivatives(t: f64, q: &Vector<NQ>, v: &Vector<NV>, u: &Vector<NU>)
            -> Option<ByMotion<f64, NV, NU>>;
        carry(t: f64, q: &Vector<NQ>, dv: &Vector<NV>, v: &Vector<NV>) -> Vector<NV>;
        carry_rate(t: f64, dv: &Vector<NV>, v: &Vector<NV>) -> Vector<NV>;
        translation(t: f64, dv: &Vector<NV>) -> Vector<NV>;
    }

    fn contact_start(&self, t: f64, q: &Vector<NQ>, parts: bool) -> Result<Vector<NQ>, ConstraintError> {
        contact::start(self, t, q, parts)
    }

    fn contact_step(
        &self,
        t: f64,
        start: (&Vector<NQ>, &Vector<NV>),
        end: (&Vector<NQ>, &Vector<NV>),
        given: Assumed<'_, f64, NV>,
        h: f64,
    ) -> Result<Touched<f64, NQ, NV>, ConstraintError> {
        contact::step(self, t, start, end, given, h)
    }

    fn visit_contacts<V: Visitor<f64, NQ, NV, NU>>(&self, visitor: V) -> Option<V::Output> {
        Some(visitor.visit(self))
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize, R: Borrow<Robot>>
    Contacts<NQ, NV, NU, NK, NR> for PaddedContacts<NQ, NV, NU, NK, NR, R>
{
    const CONTACTS: [&'static str; NK] = placeholder_numbers(NameListKind::Contacts);
    const CONTACT_ROWS: [Rows; NK] = [Rows { first: NR, count: 0 }; NK];

    fn contact_tables(&self) -> ([Rows; NK], [usize; NK]) {
        let contacts = &self.robot().shared.contacts;
        let rows_of_contact = |k: usize| contacts.get(k).map_or([NR, 0], |contact| contact.rows);
        (
            std::array::from_fn(|k| Rows { first: rows_of_contact(k)[0], count: rows_of_contact(k)[1] }),
            std::array::from_fn(|k| contacts.get(k).map_or(k, |contact| contact.pressed_by)),
        )
    }

    fn contact_columns(&self) -> [(usize, usize); NK] {
        let contacts = &self.robot().shared.contacts;
        std::array::from_fn(|k| contacts.get(k).map_or((0, 0), |contact| contact.dependence.columns))
    }

    fn contacts_drift(&self) -> bool {
        self.robot().shared.contacts.iter().any(|contact| contact.dependence.drifts)
    }

    fn contact_gaps(&self, t: f64, q: &Vector<NQ>) -> Vector<NK> {
        let count = self.robot().shared.contacts.len();
        self.plain.vector_with_results(
            InternalFunction::ContactGaps,
            self.plain.state_without_velocity(t, q),
            count,
            SVector::repeat(FAR),
        )
    }

    fn contact_rates(&self, t: f64, q: &Vector<NQ>, v: &Vector<NV>) -> Vector<NR> {
        let state = self.plain.state_with_velocity(t, q, v);
        self.plain.vector_with_results(
            InternalFunction::ContactRates,
            state,
            self.contact_rate_count(),
            SVector::zeros(),
        )
    }

    fn contact_jacobian(&self, t: f64, q: &Vector<NQ>) -> SMatrix<f64, NR, NV> {
        let size = (self.contact_rate_count(), self.robot().nv());
        self.plain.matrix_with_results(
            InternalFunction::ContactJacobian,
            self.plain.state_without_velocity(t, q),
            size,
            SMatrix::zeros(),
        )
    }

    fn contact_bias(&self, t: f64, q: &Vector<NQ>, v: &Vector<NV>) -> Vector<NR> {
        let state = self.plain.state_with_velocity(t, q, v);
        self.plain.vector_with_results(
            InternalFunction::ContactBias,
            state,
            self.contact_rate_count(),
            SVector::zeros(),
        )
    }

    fn contact_responses(&self, t: f64, q: &Vector<NQ>, closed: &[bool; NK]) -> Responses<f64, NV, NR> {
        if !self.plain.has_function(InternalFunction::ContactResponses) {
            return contact::responses(self, t, q, closed);
        }
        let (n, rates) = (self.robot().nv(), self.contact_rate_count());
        let mut found = vec![0.0; rates * (n + rates)];
        self.plain.call_function(
            InternalFunction::ContactResponses,
            self.plain.state_without_velocity(t, q),
            &mut found,
        );
        let mut all = Responses { velocities: SMatrix::zeros(), rates: SMatrix::zeros() };
        write_block(&mut all.velocities, n, &found[..n * rates]);
        write_block(&mut all.rates, rates, &found[n * rates..]);
        all
    }

    fn held_derivatives(
        &self,
        t: f64,
        state: (&Vector<NQ>, &Vector<NV>),
        u: &Vector<NU>,
        touches: &[Touch; NK],
        gains: [f64; 2],
    ) -> Option<ByMotion<f64, NV, NU>> {
        match self.plain.has_contact_derivatives() {
            true => held_derivatives(self, t, state, u, touches, gains),
            false => None,
        }
    }

    fn differentiate_step(
        &self,
        method: &TimeStepping<f64>,
        t: f64,
        state: (&Vector<NQ>, &Vector<NV>),
        u: &Vector<NU>,
        into: &mut Transition<f64, NQ, NV, NU>,
    ) -> Option<Result<(), integrate::Error>> {
        let is_available = self.plain.has_contact_derivatives();
        is_available.then(|| differentiate_step(self, method, t, state, u, into))
    }

    fn contact_laws(&self) -> [Law<f64>; NK] {
        let contacts = &self.robot().shared.contacts;
        let mut laws = vec![0.0; 3 * contacts.len()];
        self.plain.call_function(InternalFunction::ContactLaws, State::default(), &mut laws);
        std::array::from_fn(|k| {
            let contact_coefficient = |i: usize| laws.get(3 * k + i).copied().unwrap_or(0.0);
            let by_impulses = contacts.get(k).is_some_and(|contact| contact.of_impulses);
            Law {
                friction: contact_coefficient(0),
                restitution: contact_coefficient(1),
                stiction: contact_coefficient(2),
                hypothesis: if by_impulses { Restitution::Poisson } else { Restitution::Newton },
            }
        })
    }
}
