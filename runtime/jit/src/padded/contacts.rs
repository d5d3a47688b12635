//! Adapters for the unilateral contacts of robots that are padded to constant dimensions.

use super::{Padded, write_block};
use crate::error::Error;
use crate::internal::InternalFunction;
use crate::names::{NameListKind, contact_placeholder, placeholder_numbers};
use crate::robot::{Robot, State};
use crate::separate::{EvaluatedContacts, NearContacts, TOUCHING};
use linkwork::__private::{differentiate_step, held_derivatives};
use linkwork::constraint::Projected;
use linkwork::contact::{
    self, Assumed, Impulses, Law, Responses, Restitution, Rows, Touch, Touched, Visitor,
};
use linkwork::discrete::Transition;
use linkwork::integrate::{self, Features, Hooks, TimeStepping};
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{ByMotion, ConstraintError, Contacts, Mechanism};
use std::borrow::Borrow;
use std::sync::Arc;

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
    /// Contacts that are mechanisms of their own, if the robot has such contacts.
    separate: Option<Arc<EvaluatedContacts>>,
    /// Separate contacts that take part in a step.
    near: Option<Arc<NearContacts>>,
}

impl Robot {
    /// Returns the robot with its contacts as a mechanism of constant dimensions, see
    /// [`padded`](Self::padded).
    ///
    /// # Errors
    ///
    /// As [`padded`](Self::padded); the robot has more than `NK` contacts or `NR` rates of contacts, or more
    /// than 128 contact points, which only [`simulate`](Self::simulate) takes.
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
        if !self.shared.separate.is_empty() {
            return Err(Error::Value(format!(
                "`{}` has more contact points than a padded robot: simulate it with `simulate()`",
                self.name()
            )));
        }
        PaddedContacts::new(self.clone())
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize, R: Borrow<Robot>>
    PaddedContacts<NQ, NV, NU, NK, NR, R>
{
    pub(crate) fn new(robot: R) -> Result<Self, Error> {
        let own: &Robot = robot.borrow();
        let separate = EvaluatedContacts::of_robot(own)?.map(Arc::new);
        if separate.is_none() {
            let (contacts, rates) = (own.shared.contacts.len(), own.shared.contact_rates);
            own.check_length("NK", contacts, contacts.min(NK))?;
            own.check_length("NR", rates, rates.min(NR))?;
        }
        Ok(PaddedContacts { plain: Padded::new(robot)?, separate, near: None })
    }

    /// Returns the separate contacts with those that take part in a step; `None` for a robot without separate
    /// contacts.
    fn near_contacts(&self) -> Option<(&EvaluatedContacts, &NearContacts)> {
        self.separate.as_deref().zip(self.near.as_deref())
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

/// Distance up to which separate contacts of bodies at rest take part in a step, m.
const REACH: f64 = 1e-6;
/// Maximum number of projections of a start onto configurations without overlaps, each with the contacts that
/// are near at its beginning.
const PROJECTIONS: usize = 8;

impl<const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize, R>
    PaddedContacts<NQ, NV, NU, NK, NR, R>
where
    R: Borrow<Robot> + Clone,
{
    /// Returns the robot with the contacts that are near each other in one of the states, or may be at a
    /// state between them.
    ///
    /// # Errors
    ///
    /// More contacts touch than the arrays hold.
    fn with_near_contacts(
        &self,
        separate: &EvaluatedContacts,
        states: &[State<'_>],
        reach: f64,
    ) -> Result<Self, ConstraintError> {
        let near = separate.near_contacts(self.robot(), states, reach, [NK, NR]);
        let near =
            near.map_err(|contact| ConstraintError::Contact { constraint: contact_placeholder(contact) })?;
        Ok(PaddedContacts { near: Some(Arc::new(near)), ..self.clone() })
    }

    /// Returns the robot with all its separate contacts, as if they were near each other.
    #[cfg(test)]
    pub(crate) fn with_all_contacts(&self, q: &Vector<NQ>) -> Result<Self, ConstraintError> {
        let separate = self.separate.as_ref().ok_or(ConstraintError::NotFinite)?;
        self.with_near_contacts(separate, &[self.plain.state_without_velocity(0.0, q)], f64::INFINITY)
    }

    /// Replaces the number of a near contact in an error by that of the contact in the mechanism.
    fn error_of_mechanism(&self, error: ConstraintError) -> ConstraintError {
        let mechanism_contact = |constraint: &'static str| {
            let near = self.near.as_ref().zip(constraint.parse::<usize>().ok());
            let contact = near.and_then(|(near, k)| near.contacts.get(k).copied());
            contact.map_or(constraint, contact_placeholder)
        };
        match error {
            ConstraintError::Contact { constraint } => {
                ConstraintError::Contact { constraint: mechanism_contact(constraint) }
            }
            ConstraintError::Overlap { constraint, depth } => {
                ConstraintError::Overlap { constraint: mechanism_contact(constraint), depth }
            }
            other => other,
        }
    }

    /// Returns the initial configuration of a simulation, as [`contact::start`] does.
    fn start_with_separate_contacts(
        &self,
        separate: &EvaluatedContacts,
        t: f64,
        q: &Vector<NQ>,
        parts: bool,
    ) -> Result<Vector<NQ>, ConstraintError> {
        let mut q = *q;
        for _ in 0..PROJECTIONS {
            let state = self.plain.state_without_velocity(t, &q);
            let gaps = separate.all_gaps(self.robot(), state);
            if gaps.iter().any(|gap| gap.is_nan()) {
                return Err(ConstraintError::NotFinite);
            }
            let deepest = gaps.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
            let overlap = deepest.filter(|(_, gap)| **gap < -TOUCHING);
            let Some((contact, gap)) = overlap else { return Ok(q) };
            if !parts {
                let constraint = contact_placeholder(contact);
                return Err(ConstraintError::Overlap { constraint, depth: -gap });
            }
            // What is no farther apart than others overlap may come to overlap as these open.
            let near = self.with_near_contacts(separate, &[state], -2.0 * gap)?;
            q = contact::start(&near, t, &q, true).map_err(|error| near.error_of_mechanism(error))?;
        }
        self.start_with_separate_contacts(separate, t, &q, false)
    }

    /// Applies the contact impulses of a step, as [`contact::step`] does.
    fn step_with_separate_contacts(
        &self,
        separate: &EvaluatedContacts,
        t: f64,
        (start, v): (&Vector<NQ>, &Vector<NV>),
        (q, free): (&Vector<NQ>, &Vector<NV>),
        (given, impulses): Assumed<'_, f64, NV>,
        h: f64,
    ) -> Result<Touched<f64, NQ, NV>, ConstraintError> {
        let states =
            [self.plain.state_without_velocity(t - h, start), self.plain.state_without_velocity(t, q)];
        // The assumed contact forces have displaced bodies by half of this.
        let held = given.iter().fold(0.0_f64, |most, given| most.max((given * h).abs()));
        let near = self.with_near_contacts(separate, &states, REACH + 4.0 * held)?;
        let own = near.near.as_deref().map(|near| near.contacts.as_slice()).unwrap_or_default();
        let recalled = renumbered(impulses, |contact| own.binary_search(&contact).ok());
        contact::step(&near, t, (start, v), (q, free), (given, &recalled), h)
            .map(|touched| Touched {
                impulses: renumbered(&touched.impulses, |k| own.get(k).copied()),
                ..touched
            })
            .map_err(|error| near.error_of_mechanism(error))
    }
}

/// Returns the stored impulses of contacts with other numbers. Contacts without a number are stored for a
/// contact that does not exist.
fn renumbered<const NV: usize>(
    impulses: &Impulses<f64, NV>,
    number: impl Fn(usize) -> Option<usize>,
) -> Impulses<f64, NV> {
    // An entry is the number of a contact plus one, or zero.
    let renumbered_entry = |entry: f64| match entry > 0.0 {
        true => number(entry as usize - 1).map_or(f64::from(u32::MAX), |k| k as f64 + 1.0),
        false => entry,
    };
    Impulses::from_lists(|[i, j]| {
        let list = impulses.list([i, j]);
        if j == 0 { list.map(renumbered_entry) } else { list }
    })
}

impl<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    R: Borrow<Robot> + Clone,
> Mechanism<NQ, NV, NU> for PaddedContacts<NQ, NV, NU, NK, NR, R>
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
impl<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    R: Borrow<Robot> + Clone,
> Hooks<f64, NQ, NV, NU> for PaddedContacts<NQ, NV, NU, NK, NR, R>
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
        match &self.separate {
            Some(separate) => self.start_with_separate_contacts(separate, t, q, parts),
            None => contact::start(self, t, q, parts),
        }
    }

    fn contact_step(
        &self,
        t: f64,
        start: (&Vector<NQ>, &Vector<NV>),
        end: (&Vector<NQ>, &Vector<NV>),
        given: Assumed<'_, f64, NV>,
        h: f64,
    ) -> Result<Touched<f64, NQ, NV>, ConstraintError> {
        match &self.separate {
            Some(separate) => self.step_with_separate_contacts(separate, t, start, end, given, h),
            None => contact::step(self, t, start, end, given, h),
        }
    }

    fn visit_contacts<V: Visitor<f64, NQ, NV, NU>>(&self, visitor: V) -> Option<V::Output> {
        // Events of separate contacts are not located; simulations refuse them before.
        self.separate.is_none().then(|| visitor.visit(self))
    }
}

impl<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
    R: Borrow<Robot> + Clone,
> Contacts<NQ, NV, NU, NK, NR> for PaddedContacts<NQ, NV, NU, NK, NR, R>
{
    const CONTACTS: [&'static str; NK] = placeholder_numbers(NameListKind::Contacts);
    const CONTACT_ROWS: [Rows; NK] = [Rows { first: NR, count: 0 }; NK];

    fn contact_tables(&self) -> ([Rows; NK], [usize; NK]) {
        if let Some((_, near)) = self.near_contacts() {
            let rows_of_contact = |k: usize| near.rows.get(k).copied().unwrap_or([NR, 0]);
            return (
                std::array::from_fn(|k| Rows { first: rows_of_contact(k)[0], count: rows_of_contact(k)[1] }),
                std::array::from_fn(|k| near.pressed_by.get(k).copied().unwrap_or(k)),
            );
        }
        let contacts = &self.robot().shared.contacts;
        let rows_of_contact = |k: usize| contacts.get(k).map_or([NR, 0], |contact| contact.rows);
        (
            std::array::from_fn(|k| Rows { first: rows_of_contact(k)[0], count: rows_of_contact(k)[1] }),
            std::array::from_fn(|k| contacts.get(k).map_or(k, |contact| contact.pressed_by)),
        )
    }

    fn contact_columns(&self) -> [(usize, usize); NK] {
        if let Some((_, near)) = self.near_contacts() {
            return std::array::from_fn(|k| near.columns.get(k).copied().unwrap_or((0, 0)));
        }
        let contacts = &self.robot().shared.contacts;
        std::array::from_fn(|k| contacts.get(k).map_or((0, 0), |contact| contact.dependence.columns))
    }

    fn contacts_drift(&self) -> bool {
        let shared = &self.robot().shared;
        match self.separate {
            Some(_) => shared.time,
            None => shared.contacts.iter().any(|contact| contact.dependence.drifts),
        }
    }

    fn contact_gaps(&self, t: f64, q: &Vector<NQ>) -> Vector<NK> {
        if let Some((separate, near)) = self.near_contacts() {
            let (mut gaps, state) = (Vector::<NK>::repeat(FAR), self.plain.state_without_velocity(t, q));
            separate.write_gaps(self.robot(), near, state, gaps.as_mut_slice());
            return gaps;
        }
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
        if let Some((separate, near)) = self.near_contacts() {
            let mut rates = Vector::<NR>::zeros();
            separate.write_rates(self.robot(), near, state, rates.as_mut_slice());
            return rates;
        }
        self.plain.vector_with_results(
            InternalFunction::ContactRates,
            state,
            self.contact_rate_count(),
            SVector::zeros(),
        )
    }

    fn contact_jacobian(&self, t: f64, q: &Vector<NQ>) -> SMatrix<f64, NR, NV> {
        if let Some((separate, near)) = self.near_contacts() {
            let mut all = SMatrix::<f64, NR, NV>::zeros();
            let state = self.plain.state_without_velocity(t, q);
            separate.write_jacobian(self.robot(), near, state, (all.as_mut_slice(), NR));
            return all;
        }
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
        let hypothesis = Restitution::Newton;
        let none = Law { friction: 0.0, restitution: 0.0, stiction: 0.0, hypothesis };
        if let Some((separate, near)) = self.near_contacts() {
            let law_of_contact = |contact: &usize| separate.contact_law(*contact);
            return std::array::from_fn(|k| near.contacts.get(k).and_then(law_of_contact).unwrap_or(none));
        }
        let laws = self.robot().contact_laws();
        std::array::from_fn(|k| laws.get(k).copied().unwrap_or(none))
    }
}
