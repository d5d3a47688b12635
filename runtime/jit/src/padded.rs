//! Adapters that pass loaded mechanisms to the runtime's integrators and other code that is generic over
//! mechanisms.

/// Passes functions on to the robot without contacts.
macro_rules! forward {
    ($($name:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {$(
        #[inline]
        fn $name(&self, $($argument: $type),*) -> $result {
            self.plain.$name($($argument),*)
        }
    )*};
}

mod constraints;
mod contact_derivatives;
mod contacts;
mod derivatives;
mod second;

pub use contacts::PaddedContacts;

use crate::error::Error;
use crate::internal::InternalFunction;
use crate::names::{NameListKind, placeholder_numbers};
use crate::robot::{Robot, State};
use linkwork::constraint::Projected;
use linkwork::integrate::{Features, Hooks};
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{ByMotion, Constrained, ConstraintError, Mechanism};
use std::borrow::Borrow;

/// Robot as a [`Mechanism`] of constant dimensions, for integrators and other code that is generic over
/// mechanisms.
///
/// The dimensions are at least those of the robot. Further coordinates have unit inertia, and only
/// generalized forces act on them; further inputs have no effect. With equal dimensions nothing is padded.
/// States of first order are the last velocities, as in [`Extended`](linkwork::Extended). Constraints are
/// those of [`Constrained`], of which a robot has `NV` at most; further ones are always satisfied.
///
/// Derivatives are those of the option `derivatives`, second derivatives those of `second_derivatives`;
/// without the option they are NaN. Contacts are those of [`PaddedContacts`].
///
/// Two designs were weighed: dimensions as associated types of the traits, so that loaded mechanisms have
/// dynamic vectors, and this one, a capacity. Associated types change every signature of the runtime, and
/// dynamic vectors allocate in every stage of an integrator. With a capacity, mechanisms of the attribute
/// lose nothing; its costs are additional entries of the vectors of a stage, not of the generated code.
///
/// ```
/// use linkwork::prelude::simulate;
/// use linkwork_jit::declare;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let pendulum = declare(
///     "#[mechanism(gravity = -9.81 * y)]
///     struct Pendulum {
///         #[body(mass = 2, com = -0.5 * y, inertia = rod(2, 1, y))]
///         rod: Body,
///         #[joint(ground -> rod, about = z)]
///         hinge: Pin,
///     }",
/// )?;
/// let exact = pendulum.padded::<1, 1, 0>()?;
/// let padded = pendulum.padded::<4, 4, 2>()?;
/// let end = simulate(&exact).from([0.5], [0.0]).duration(1.0).finish()?;
/// let q = [0.5, 0.0, 0.0, 0.0];
/// let same = simulate(&padded).from(q, [0.0; 4]).duration(1.0).finish()?;
/// assert!(end.q[0] == same.q[0] && same.q[1] == 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Padded<const NQ: usize, const NV: usize, const NU: usize, R = Robot> {
    robot: R,
}

impl Robot {
    /// Returns the robot as a mechanism of constant dimensions. Its parameters cannot be changed afterwards.
    ///
    /// # Errors
    ///
    /// A dimension is smaller than that of the robot, a parameter has no value, or the robot has no inertia,
    /// or contacts ([`padded_contacts`](Self::padded_contacts)).
    pub fn padded<const NQ: usize, const NV: usize, const NU: usize>(
        &self,
    ) -> Result<Padded<NQ, NV, NU>, Error> {
        if !self.shared.contacts.is_empty() {
            let name = self.name();
            return Err(Error::Value(format!("`{name}` has contacts: call `padded_contacts` instead")));
        }
        self.validate()?;
        Padded::new(self.clone())
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>> Padded<NQ, NV, NU, R> {
    /// Returns the robot padded to constant dimensions, or an error if it is too large or has no dynamics.
    /// Contacts of the robot have no effect.
    pub(crate) fn new(robot: R) -> Result<Self, Error> {
        let own: &Robot = robot.borrow();
        let velocities = own.nv() + own.shared.states.len();
        let rows = own.shared.constraints.names.len();
        for (name, own_count, capacity) in [
            ("NQ", own.nq(), NQ),
            ("NV", velocities, NV),
            ("NU", own.nu(), NU),
            ("NV for the constraints", rows, NV),
        ] {
            own.check_length(name, own_count, own_count.min(capacity))?;
        }
        match own.shared.kinematic {
            true => Err(Error::Value(format!(
                "`{}` has no masses (`inertia = none`), so that nothing determines how it moves",
                own.name()
            ))),
            false => Ok(Padded { robot }),
        }
    }

    /// Returns the robot that has been padded to constant dimensions.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        self.robot.borrow()
    }

    /// Returns the number of velocities, and the number of velocities and first-order states together.
    fn velocity_and_extended_velocity_counts(&self) -> [usize; 2] {
        let robot = self.robot();
        [robot.nv(), robot.nv() + robot.shared.states.len()]
    }

    fn configuration_entries<'a>(&self, q: &'a SVector<f64, NQ>) -> &'a [f64] {
        &q.as_slice()[..self.robot().nq()]
    }

    fn velocity_entries<'a>(&self, v: &'a SVector<f64, NV>) -> &'a [f64] {
        &v.as_slice()[..self.robot().nv()]
    }

    fn state_without_velocity<'a>(&self, t: f64, q: &'a SVector<f64, NQ>) -> State<'a> {
        State { t: Some(t), q: self.configuration_entries(q), ..State::default() }
    }

    fn state_with_velocity<'a>(&self, t: f64, q: &'a SVector<f64, NQ>, v: &'a SVector<f64, NV>) -> State<'a> {
        let [n, all] = self.velocity_and_extended_velocity_counts();
        State { v: self.velocity_entries(v), x: &v.as_slice()[n..all], ..self.state_without_velocity(t, q) }
    }

    /// Returns whether the robot has a function.
    fn has_function(&self, f: InternalFunction) -> bool {
        self.robot().shared.internal[f as usize].is_some()
    }

    /// Evaluates a function of the robot. After an error, such as an absent function, the results are NaN.
    fn call_function(&self, f: InternalFunction, state: State<'_>, out: &mut [f64]) {
        self.robot().call_internal_function(f, state, out);
    }

    /// Returns a vector whose first `count` entries are the results of a function, and whose other entries
    /// are those of `all`.
    fn vector_with_results<const N: usize>(
        &self,
        f: InternalFunction,
        state: State<'_>,
        count: usize,
        mut all: SVector<f64, N>,
    ) -> SVector<f64, N> {
        self.call_function(f, state, &mut all.as_mut_slice()[..count]);
        all
    }

    /// Returns a matrix whose first rows and columns are the results of a function, and whose other entries
    /// are those of `all`, which is zero or the identity.
    fn matrix_with_results<const N: usize, const M: usize>(
        &self,
        f: InternalFunction,
        state: State<'_>,
        (rows, columns): (usize, usize),
        mut all: SMatrix<f64, N, M>,
    ) -> SMatrix<f64, N, M> {
        let entries = all.as_mut_slice();
        self.call_function(f, state, &mut entries[..rows * columns]);
        // The last columns first: no entry is overwritten before it is moved.
        for j in (1..columns).rev() {
            entries.copy_within(j * rows..(j + 1) * rows, j * N);
        }
        for column in entries.chunks_exact_mut(N.max(1)).take(columns) {
            column[rows..].fill(0.0);
        }
        all
    }

    /// Adds the rates of the first-order states under inputs, times a factor, to the entries behind the
    /// velocities.
    fn add_state_rates(&self, state: State<'_>, factor: f64, to: &mut SVector<f64, NV>) {
        let robot = self.robot();
        let n = robot.nv();
        for (k, one) in robot.shared.states.iter().enumerate() {
            let mut rate = [f64::NAN];
            if let Some(index) = one.rate {
                let _ = robot.call_with_state_into(index, state, &mut rate);
            }
            to[n + k] += factor * rate[0];
        }
    }

    /// Adds the rates of the first-order states without inputs, times a factor, to the entries behind the
    /// velocities.
    fn add_state_rates_without_inputs(&self, state: State<'_>, factor: f64, to: &mut SVector<f64, NV>) {
        if !self.robot().shared.states.is_empty() {
            let u = SVector::<f64, NU>::zeros();
            self.add_state_rates(State { u: self.input_entries(&u), ..state }, factor, to);
        }
    }

    fn input_entries<'a>(&self, u: &'a SVector<f64, NU>) -> &'a [f64] {
        &u.as_slice()[..self.robot().nu()]
    }
}

/// Writes the columns of a block with this number of rows to the first rows and columns of a matrix.
fn write_block<const N: usize, const M: usize>(all: &mut SMatrix<f64, N, M>, rows: usize, block: &[f64]) {
    for (j, column) in block.chunks_exact(rows.max(1)).enumerate() {
        all.as_mut_slice()[j * N..j * N + rows].copy_from_slice(column);
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>> Hooks<f64, NQ, NV, NU>
    for Padded<NQ, NV, NU, R>
{
    #[inline]
    fn features(&self) -> Features {
        let (robot, [_, velocities]) = (self.robot(), self.velocity_and_extended_velocity_counts());
        let shared = &robot.shared;
        Features {
            constrained: !shared.constraints.names.is_empty(),
            slipping: !shared.constraints.slipping.is_empty(),
            feedback: shared.has_feedback,
            speeds: shared.has_speeds,
            dimensions: [robot.nq(), velocities],
        }
    }

    fn project(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
    ) -> Result<Projected<f64, NQ, NV>, ConstraintError> {
        match self.is_constrained() {
            true => Constrained::<NQ, NV, NU, NV, NV>::project_state(self, t, q, v),
            false => Ok((*q, *v)),
        }
    }

    fn velocity_change_by_impulse(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        h: f64,
        p: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        match self.is_constrained() {
            true => Constrained::<NQ, NV, NU, NV, NV>::constrained_impulse(self, t, q, v, h, p),
            false => self.forward_dynamics(t, q, v, &(self.bias_forces(t, q, v) + p)),
        }
    }

    fn is_nearly_singular(&self, t: f64, q: &SVector<f64, NQ>, dv: &SVector<f64, NV>) -> bool {
        self.is_constrained() && self.are_constraints_nearly_singular(t, q, dv)
    }

    fn acceleration_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        u: &SVector<f64, NU>,
    ) -> Option<ByMotion<f64, NV, NU>> {
        let available = self.robot().shared.states.is_empty() && self.has_derivatives();
        available.then(|| linkwork::__private::acceleration_derivatives(self, t, q, v, u)).flatten()
    }

    fn carry(
        &self,
        _t: f64,
        q: &SVector<f64, NQ>,
        dv: &SVector<f64, NV>,
        v: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        let charts = &self.robot().shared.charts;
        let mut out = *v;
        if !self.robot().shared.has_speeds {
            crate::configuration_space::transport_velocity(
                charts,
                dv.as_slice(),
                v.as_slice(),
                out.as_mut_slice(),
            );
            return out;
        }
        let n = self.robot().nv();
        let at = State { q: self.configuration_entries(q), ..State::default() };
        let coordinate_rates = |state: State<'_>, v: &SVector<f64, NV>| {
            self.vector_with_results(
                InternalFunction::RatesOfSpeeds,
                State { v: self.velocity_entries(v), ..state },
                n,
                *v,
            )
        };
        let way = coordinate_rates(at, dv);
        let mut there = *q;
        crate::configuration_space::integrate(charts, q.as_slice(), way.as_slice(), there.as_mut_slice());
        crate::configuration_space::transport_velocity(
            charts,
            way.as_slice(),
            coordinate_rates(at, v).as_slice(),
            out.as_mut_slice(),
        );
        let at = State { q: self.configuration_entries(&there), ..State::default() };
        self.vector_with_results(
            InternalFunction::SpeedsOfRates,
            State { v: self.velocity_entries(&out), ..at },
            n,
            out,
        )
    }

    fn carry_rate(&self, _t: f64, dv: &SVector<f64, NV>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        let mut out = SVector::<f64, NV>::zeros();
        if !self.robot().shared.has_speeds {
            let charts = &self.robot().shared.charts;
            crate::configuration_space::write_transported_velocity_rate(
                charts,
                dv.as_slice(),
                v.as_slice(),
                out.as_mut_slice(),
            );
        }
        out
    }

    fn translation(&self, _t: f64, dv: &SVector<f64, NV>) -> SVector<f64, NV> {
        let mut out = SVector::<f64, NV>::zeros();
        if !self.robot().shared.has_speeds {
            crate::configuration_space::copy_linear_velocities(
                &self.robot().shared.charts,
                dv.as_slice(),
                out.as_mut_slice(),
            );
        }
        out
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>> Mechanism<NQ, NV, NU>
    for Padded<NQ, NV, NU, R>
{
    type Scalar = f64;

    const CONFIGURATION: [&'static str; NQ] = placeholder_numbers(NameListKind::Configuration);
    const VELOCITIES: [&'static str; NV] = placeholder_numbers(NameListKind::Velocities);
    const INPUTS: [&'static str; NU] = placeholder_numbers(NameListKind::Inputs);

    fn neutral(&self) -> SVector<f64, NQ> {
        self.vector_with_results(
            InternalFunction::Neutral,
            State::default(),
            self.robot().nq(),
            SVector::zeros(),
        )
    }

    fn integrate(&self, q: &SVector<f64, NQ>, dv: &SVector<f64, NV>) -> SVector<f64, NQ> {
        let (nq, [_, nv]) = (self.robot().nq(), self.velocity_and_extended_velocity_counts());
        let mut all = *q;
        for (to, by) in all.iter_mut().skip(nq).zip(dv.iter().skip(nv)) {
            *to += by;
        }
        if !self.robot().shared.has_speeds {
            let charts = &self.robot().shared.charts;
            crate::configuration_space::integrate(charts, q.as_slice(), dv.as_slice(), all.as_mut_slice());
            return all;
        }
        let state = State {
            q: self.configuration_entries(q),
            v: self.velocity_entries(dv),
            other: &[self.velocity_entries(dv)],
            ..State::default()
        };
        self.vector_with_results(InternalFunction::Integrate, state, nq, all)
    }

    fn difference(&self, from: &SVector<f64, NQ>, to: &SVector<f64, NQ>) -> SVector<f64, NV> {
        let (nq, [n, nv]) = (self.robot().nq(), self.velocity_and_extended_velocity_counts());
        let mut all = SVector::<f64, NV>::zeros();
        for (entry, (to, from)) in all.iter_mut().skip(nv).zip(to.iter().zip(from).skip(nq)) {
            *entry = to - from;
        }
        let other = &[self.configuration_entries(from), self.configuration_entries(to)];
        self.vector_with_results(InternalFunction::Difference, State { other, ..State::default() }, n, all)
    }

    fn tangent_rate(&self, dv: &SVector<f64, NV>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        let mut all = *v;
        match self.robot().shared.has_speeds {
            true => all.fill(f64::NAN),
            false => {
                let charts = &self.robot().shared.charts;
                crate::configuration_space::tangent_rate(
                    charts,
                    dv.as_slice(),
                    v.as_slice(),
                    all.as_mut_slice(),
                );
            }
        }
        all
    }

    fn displacement_rate(
        &self,
        q: &SVector<f64, NQ>,
        dv: &SVector<f64, NV>,
        v: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        if !self.robot().shared.has_speeds {
            return self.tangent_rate(dv, v);
        }
        let state = State {
            q: self.configuration_entries(q),
            v: self.velocity_entries(v),
            other: &[self.velocity_entries(dv)],
            ..State::default()
        };
        self.vector_with_results(InternalFunction::DisplacementRate, state, self.robot().nv(), *v)
    }

    fn mass_matrix(&self, t: f64, q: &SVector<f64, NQ>) -> SMatrix<f64, NV, NV> {
        let n = self.robot().nv();
        self.matrix_with_results(
            InternalFunction::MassMatrix,
            self.state_without_velocity(t, q),
            (n, n),
            SMatrix::identity(),
        )
    }

    fn bias_forces(&self, t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        let state = self.state_with_velocity(t, q, v);
        let mut all = self.vector_with_results(
            InternalFunction::BiasForces,
            state,
            self.robot().nv(),
            SVector::zeros(),
        );
        self.add_state_rates_without_inputs(state, -1.0, &mut all);
        all
    }

    fn inverse_dynamics(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        a: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        let state = State { a: self.velocity_entries(a), ..self.state_with_velocity(t, q, v) };
        let mut all =
            self.vector_with_results(InternalFunction::InverseDynamics, state, self.robot().nv(), *a);
        self.add_state_rates_without_inputs(state, -1.0, &mut all);
        all
    }

    fn forward_dynamics(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        tau: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        if self.is_constrained() {
            return Constrained::<NQ, NV, NU, NV, NV>::constrained_dynamics(self, t, q, v, tau).0;
        }
        let state = State { tau: self.velocity_entries(tau), ..self.state_with_velocity(t, q, v) };
        let mut all =
            self.vector_with_results(InternalFunction::ForwardDynamics, state, self.robot().nv(), *tau);
        self.add_state_rates_without_inputs(state, 1.0, &mut all);
        all
    }

    fn try_forward_dynamics(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        tau: &SVector<f64, NV>,
    ) -> Result<SVector<f64, NV>, ConstraintError> {
        match self.robot().shared.constraints.slipping.is_empty() {
            true => Ok(self.forward_dynamics(t, q, v, tau)),
            false => self.slipping_dynamics(t, q, v, tau).map(|(a, _)| a),
        }
    }

    fn generalized_forces(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        u: &SVector<f64, NU>,
    ) -> SVector<f64, NV> {
        let mut all = SVector::zeros();
        if self.robot().nu() == 0 {
            return all;
        }
        let state = State { u: self.input_entries(u), ..self.state_with_velocity(t, q, v) };
        all = self.vector_with_results(InternalFunction::GeneralizedForces, state, self.robot().nv(), all);
        if !self.robot().shared.states.is_empty() {
            self.add_state_rates(state, 1.0, &mut all);
            self.add_state_rates_without_inputs(state, -1.0, &mut all);
        }
        all
    }

    fn kinetic_energy(&self, t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> f64 {
        let further: f64 =
            v.iter().skip(self.velocity_and_extended_velocity_counts()[1]).map(|v| 0.5 * v * v).sum();
        let mut energy = [f64::NAN];
        self.call_function(InternalFunction::KineticEnergy, self.state_with_velocity(t, q, v), &mut energy);
        energy[0] + further
    }

    fn potential_energy(&self, t: f64, q: &SVector<f64, NQ>) -> f64 {
        let mut energy = [f64::NAN];
        self.call_function(InternalFunction::PotentialEnergy, self.state_without_velocity(t, q), &mut energy);
        energy[0]
    }

    fn generalized_momentum(&self, t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        self.vector_with_results(
            InternalFunction::GeneralizedMomentum,
            self.state_with_velocity(t, q, v),
            self.robot().nv(),
            *v,
        )
    }

    fn momentum_rate(&self, t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> SVector<f64, NV> {
        let state = self.state_with_velocity(t, q, v);
        let mut all = self.vector_with_results(
            InternalFunction::MomentumRate,
            state,
            self.robot().nv(),
            SVector::zeros(),
        );
        self.add_state_rates_without_inputs(state, 1.0, &mut all);
        all
    }
}
