//! Derivatives of the dynamics of robots that are padded to constant dimensions.

use super::{Padded, write_block};
use crate::internal::InternalFunction;
use crate::robot::{Robot, State};
use linkwork::__private::{
    MotionDerivatives, ball_integrate_derivatives, ball_tangent_rate_derivatives, constrained_derivatives,
    displacement_rate_derivatives_in_speeds, free_integrate_derivatives, free_tangent_rate_derivatives,
    integrate_derivatives_in_speeds, put_block, slipping_response,
};
use linkwork::constraint::Visitor;
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{ByMotion, Constrained, Derivatives, Mechanism};
use linkwork_compiler::mechanism::Chart;
use std::borrow::Borrow;

type Square<const N: usize> = SMatrix<f64, N, N>;

/// Returns `N` consecutive entries of a vector, from index `first` on.
pub(super) fn consecutive_entries<const N: usize, const NV: usize>(
    v: &SVector<f64, NV>,
    first: usize,
) -> [f64; N] {
    std::array::from_fn(|k| v[first + k])
}

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>> Padded<NQ, NV, NU, R> {
    /// Whether the robot was loaded with the option `derivatives`.
    pub(super) fn has_derivatives(&self) -> bool {
        self.has_function(InternalFunction::GeneralizedForcesDerivatives)
            && (self.has_function(InternalFunction::MotionDerivatives) || !self.is_constrained())
    }

    /// Evaluates a function whose results are matrices with as many rows as there are velocities.
    pub(super) fn evaluate_matrices<const K: usize>(
        &self,
        f: InternalFunction,
        state: State<'_>,
        columns: [usize; K],
    ) -> impl Iterator<Item = (usize, Vec<f64>)> + use<NQ, NV, NU, K, R> {
        let n = self.robot().nv();
        let mut found = vec![0.0; n * columns.iter().sum::<usize>()];
        self.call_function(f, state, &mut found);
        let mut first = 0;
        columns.into_iter().map(move |count| {
            let own = found[n * first..n * (first + count)].to_vec();
            first += count;
            (n, own)
        })
    }

    /// Evaluates a function whose results are square matrices, and writes them to the first rows and columns
    /// of the given larger matrices.
    pub(super) fn evaluate_square_matrices<const K: usize>(
        &self,
        f: InternalFunction,
        state: State<'_>,
        mut all: [Square<NV>; K],
    ) -> [Square<NV>; K] {
        let found = self.evaluate_matrices(f, state, [self.robot().nv(); K]);
        for (to, (n, block)) in all.iter_mut().zip(found) {
            write_block(to, n, &block);
        }
        all
    }

    /// Returns the derivatives of the displaced configuration `q ⊕ dv` for velocities that are joint
    /// velocities.
    fn joint_velocity_integrate_derivatives(&self, dv: &SVector<f64, NV>) -> (Square<NV>, Square<NV>) {
        let (mut first, mut second) = (Square::identity(), Square::identity());
        for chart in &self.robot().shared.charts {
            match *chart {
                Chart::Plain(..) => {}
                Chart::Ball(_, v) => {
                    let blocks = ball_integrate_derivatives(consecutive_entries(dv, v.0));
                    put_block(&mut first, v.0, &blocks.0);
                    put_block(&mut second, v.0, &blocks.1);
                }
                Chart::Free(_, v) => {
                    let blocks = free_integrate_derivatives(consecutive_entries(dv, v.0));
                    put_block(&mut first, v.0, &blocks.0);
                    put_block(&mut second, v.0, &blocks.1);
                }
            }
        }
        (first, second)
    }

    /// Returns the derivatives of the rate of a displacement for velocities that are joint velocities.
    fn joint_velocity_rate_derivatives(
        &self,
        dv: &SVector<f64, NV>,
        v: &SVector<f64, NV>,
    ) -> (Square<NV>, Square<NV>) {
        let (mut first, mut second) = (Square::zeros(), Square::identity());
        for chart in &self.robot().shared.charts {
            match *chart {
                Chart::Plain(..) => {}
                Chart::Ball(_, at) => {
                    let blocks = ball_tangent_rate_derivatives(
                        consecutive_entries(dv, at.0),
                        consecutive_entries(v, at.0),
                    );
                    put_block(&mut first, at.0, &blocks.0);
                    put_block(&mut second, at.0, &blocks.1);
                }
                Chart::Free(_, at) => {
                    let blocks = free_tangent_rate_derivatives(
                        consecutive_entries(dv, at.0),
                        consecutive_entries(v, at.0),
                    );
                    put_block(&mut first, at.0, &blocks.0);
                    put_block(&mut second, at.0, &blocks.1);
                }
            }
        }
        (first, second)
    }

    pub(super) fn has_speeds(&self) -> bool {
        self.robot().shared.has_speeds
    }

    /// Converts a velocity vector between generalized speeds and joint velocities, by the function `f`.
    fn convert_velocity(
        &self,
        f: InternalFunction,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
    ) -> SVector<f64, NV> {
        let state =
            State { q: self.configuration_entries(q), v: self.velocity_entries(v), ..State::default() };
        self.vector_with_results(f, state, self.robot().nv(), *v)
    }

    pub(crate) fn speed_matrix(&self, f: InternalFunction, q: &SVector<f64, NQ>) -> Square<NV> {
        let n = self.robot().nv();
        let state = State { q: self.configuration_entries(q), ..State::default() };
        self.matrix_with_results(f, state, (n, n), Square::identity())
    }

    fn velocity_configuration_derivatives(&self, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> Square<NV> {
        let n = self.robot().nv();
        let state =
            State { q: self.configuration_entries(q), v: self.velocity_entries(v), ..State::default() };
        self.matrix_with_results(InternalFunction::RateChanges, state, (n, n), Square::zeros())
    }

    /// Returns the displacement `dv` in joint velocities, and the displaced configuration.
    fn displacement_and_new_configuration(
        &self,
        q: &SVector<f64, NQ>,
        dv: &SVector<f64, NV>,
    ) -> (SVector<f64, NV>, SVector<f64, NQ>) {
        let way = self.convert_velocity(InternalFunction::RatesOfSpeeds, q, dv);
        let mut there = *q;
        let charts = &self.robot().shared.charts;
        crate::configuration_space::integrate(charts, q.as_slice(), way.as_slice(), there.as_mut_slice());
        (way, there)
    }

    /// Returns the derivatives of the equations of motion with constraints.
    pub(crate) fn motion_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        a: &SVector<f64, NV>,
        lambda: &SVector<f64, NV>,
    ) -> MotionDerivatives<f64, NV, NV> {
        let n = self.robot().nv();
        let rows = self.robot().shared.constraints.names.len();
        let state = State {
            a: self.velocity_entries(a),
            other: &[&lambda.as_slice()[..rows]],
            ..self.state_with_velocity(t, q, v)
        };
        let lengths = [n, n, rows, rows, rows, n];
        let mut found = vec![0.0; n * lengths.iter().sum::<usize>()];
        self.call_function(InternalFunction::MotionDerivatives, state, &mut found);
        let mut rest = &found[..];
        let take_padded_block = |rows: usize| {
            let (own, others) = rest.split_at(n * rows);
            rest = others;
            let mut all = Square::<NV>::zeros();
            write_block(&mut all, rows, own);
            all.data.0
        };
        let [forces_by_q, forces_by_v, bias_by_q, bias_by_v, rates_by_q, turning] =
            lengths.map(take_padded_block);
        MotionDerivatives { forces_by_q, forces_by_v, bias_by_q, bias_by_v, rates_by_q, turning }
    }

    /// Returns the derivatives of accelerations and multipliers of constrained motion.
    fn constrained_motion_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        tau: &SVector<f64, NV>,
    ) -> ByMotion<f64, NV, NV> {
        let (a, lambda) = Constrained::<NQ, NV, NU, NV, NV>::constrained_dynamics(self, t, q, v, tau);
        let parts = self.motion_derivatives(t, q, v, &a, &lambda);
        let constraints = &self.robot().shared.constraints;
        if constraints.slipping.is_empty() {
            return constrained_derivatives(&parts, |force, bias| {
                self.constrained_velocity_changes(t, q, force, bias)
            });
        }
        let (slipping, groups) = (self.sliding_rows(), self.constraint_groups());
        let (n, rows, sliding) = (self.robot().nv(), constraints.names.len(), constraints.slipping.len());
        let solve = slipping_response(&slipping, &groups, &lambda, |force, bias, sides| {
            let other = &[&force[..n], &bias[..rows], &sides[..sliding]];
            let state = State { other, ..self.state_with_velocity(t, q, v) };
            self.evaluate_constraint_elimination(
                InternalFunction::SlippingResponse,
                state,
                &SVector::from(*force),
            )
        });
        constrained_derivatives(&parts, solve)
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>> Derivatives<NQ, NV, NU>
    for Padded<NQ, NV, NU, R>
{
    fn integrate_derivatives(&self, dv: &SVector<f64, NV>) -> (Square<NV>, Square<NV>) {
        match self.has_speeds() {
            true => (Square::repeat(f64::NAN), Square::repeat(f64::NAN)),
            false => self.joint_velocity_integrate_derivatives(dv),
        }
    }

    fn tangent_rate_derivatives(
        &self,
        dv: &SVector<f64, NV>,
        v: &SVector<f64, NV>,
    ) -> (Square<NV>, Square<NV>) {
        match self.has_speeds() {
            true => (Square::repeat(f64::NAN), Square::repeat(f64::NAN)),
            false => self.joint_velocity_rate_derivatives(dv, v),
        }
    }

    fn integrate_derivatives_at(
        &self,
        q: &SVector<f64, NQ>,
        dv: &SVector<f64, NV>,
    ) -> (Square<NV>, Square<NV>) {
        if !self.has_speeds() {
            return self.joint_velocity_integrate_derivatives(dv);
        }
        let (way, there) = self.displacement_and_new_configuration(q, dv);
        integrate_derivatives_in_speeds(
            &self.speed_matrix(InternalFunction::RateMatrix, q),
            &self.speed_matrix(InternalFunction::SpeedMatrix, &there),
            &self.joint_velocity_integrate_derivatives(&way),
            &self.velocity_configuration_derivatives(q, dv),
        )
    }

    fn displacement_rate_derivatives(
        &self,
        q: &SVector<f64, NQ>,
        dv: &SVector<f64, NV>,
        v: &SVector<f64, NV>,
    ) -> ByMotion<f64, NV, NV> {
        if !self.has_speeds() {
            let (by_dv, by_v) = self.joint_velocity_rate_derivatives(dv, v);
            return (Square::zeros(), by_dv, by_v);
        }
        let (way, there) = self.displacement_and_new_configuration(q, dv);
        let rates = self.convert_velocity(InternalFunction::RatesOfSpeeds, &there, v);
        let found = self.displacement_rate(q, dv, v);
        displacement_rate_derivatives_in_speeds(
            [
                &self.speed_matrix(InternalFunction::SpeedMatrix, q),
                &self.speed_matrix(InternalFunction::RateMatrix, q),
                &self.speed_matrix(InternalFunction::RateMatrix, &there),
            ],
            &self.joint_velocity_rate_derivatives(&way, &rates),
            &self.integrate_derivatives_at(q, dv),
            [
                &self.velocity_configuration_derivatives(q, dv),
                &self.velocity_configuration_derivatives(q, &found),
                &self.velocity_configuration_derivatives(&there, v),
            ],
        )
    }

    fn turning(&self, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> Square<NV> {
        match self.has_speeds() {
            true => {
                let n = self.robot().nv();
                let state = State {
                    q: self.configuration_entries(q),
                    v: self.velocity_entries(v),
                    ..State::default()
                };
                self.matrix_with_results(InternalFunction::Turning, state, (n, n), Square::zeros())
            }
            false => self.joint_velocity_rate_derivatives(&SVector::zeros(), v).0 * 2.0,
        }
    }

    fn coriolis_matrix(&self, t: f64, q: &SVector<f64, NQ>, v: &SVector<f64, NV>) -> Square<NV> {
        let n = self.robot().nv();
        self.matrix_with_results(
            InternalFunction::CoriolisMatrix,
            self.state_with_velocity(t, q, v),
            (n, n),
            Square::zeros(),
        )
    }

    fn inverse_dynamics_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        a: &SVector<f64, NV>,
    ) -> (Square<NV>, Square<NV>) {
        let state = State { a: self.velocity_entries(a), ..self.state_with_velocity(t, q, v) };
        self.evaluate_square_matrices(
            InternalFunction::InverseDynamicsDerivatives,
            state,
            [Square::zeros(); 2],
        )
        .into()
    }

    fn forward_dynamics_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        tau: &SVector<f64, NV>,
    ) -> ByMotion<f64, NV, NV> {
        if self.is_constrained() {
            return self.constrained_motion_derivatives(t, q, v, tau);
        }
        let state = State { tau: self.velocity_entries(tau), ..self.state_with_velocity(t, q, v) };
        let padding = [Square::zeros(), Square::zeros(), Square::identity()];
        self.evaluate_square_matrices(InternalFunction::ForwardDynamicsDerivatives, state, padding).into()
    }

    fn generalized_forces_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        u: &SVector<f64, NU>,
    ) -> ByMotion<f64, NV, NU> {
        let (n, m) = (self.robot().nv(), self.robot().nu());
        let state = State { u: self.input_entries(u), ..self.state_with_velocity(t, q, v) };
        let mut all = (Square::zeros(), Square::zeros(), SMatrix::zeros());
        let mut found =
            self.evaluate_matrices(InternalFunction::GeneralizedForcesDerivatives, state, [n, n, m]);
        for to in [&mut all.0, &mut all.1] {
            if let Some((n, block)) = found.next() {
                write_block(to, n, &block);
            }
        }
        if let Some((n, block)) = found.next() {
            write_block(&mut all.2, n, &block);
        }
        all
    }

    fn generalized_momentum_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
    ) -> Square<NV> {
        let n = self.robot().nv();
        let state = self.state_with_velocity(t, q, v);
        self.matrix_with_results(
            InternalFunction::GeneralizedMomentumDerivatives,
            state,
            (n, n),
            Square::zeros(),
        )
    }

    fn momentum_rate_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
    ) -> (Square<NV>, Square<NV>) {
        self.evaluate_square_matrices(
            InternalFunction::MomentumRateDerivatives,
            self.state_with_velocity(t, q, v),
            [Square::zeros(); 2],
        )
        .into()
    }

    fn visit_constraints<V: Visitor<f64, NQ, NV, NU>>(&self, visitor: V) -> Option<V::Output> {
        let slips = !self.robot().shared.constraints.slipping.is_empty();
        let is_available = self.has_function(InternalFunction::MotionDerivatives) && !slips;
        is_available.then(|| visitor.visit(self))
    }
}
