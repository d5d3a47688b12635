//! Second derivatives of the dynamics of robots that are padded to constant dimensions.

use super::derivatives::consecutive_entries;
use super::{Padded, write_block};
use crate::internal::InternalFunction;
use crate::robot::{Robot, State};
use linkwork::__private::{
    ConstraintCurvature, ball_tangent_rate_second_derivatives, constrained_second_derivatives,
    forward_second_derivatives, free_tangent_rate_second_derivatives, put_block, with_curvature,
};
use linkwork::constraint::{CurvatureVisitor, EquationDerivatives, EquationSecondDerivatives};
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{
    ConstrainedDerivatives, ConstrainedSecondDerivatives, Derivatives, InputSecondOrder, Mechanism,
    SecondDerivatives, SecondOrder,
};
use linkwork_compiler::mechanism::Chart;
use std::borrow::Borrow;

type Square<const N: usize> = SMatrix<f64, N, N>;

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>>
    ConstrainedDerivatives<NQ, NV, NU, NV, NV> for Padded<NQ, NV, NU, R>
{
    fn equation_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        a: &SVector<f64, NV>,
        lambda: &SVector<f64, NV>,
    ) -> EquationDerivatives<f64, NV, NV> {
        self.motion_derivatives(t, q, v, a, lambda).into()
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>>
    ConstrainedSecondDerivatives<NQ, NV, NU, NV, NV> for Padded<NQ, NV, NU, R>
{
    fn equation_second_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        a: &SVector<f64, NV>,
        lambda: &SVector<f64, NV>,
        w: &SVector<f64, NV>,
        z: &SVector<f64, NV>,
        y: &SVector<f64, NV>,
    ) -> EquationSecondDerivatives<f64, NV, NV> {
        let (n, rows) = (self.robot().nv(), self.robot().shared.constraints.names.len());
        let [lambda, z, y] = [lambda, z, y].map(|list| &list.as_slice()[..rows]);
        let state = State {
            a: self.velocity_entries(a),
            other: &[lambda, self.velocity_entries(w), z, y],
            ..self.state_with_velocity(t, q, v)
        };
        let found = self.evaluate_matrices(InternalFunction::ConstraintCurvature, state, [n, n, n, n, rows]);
        let mut all = [Square::<NV>::zeros(); 5];
        for (to, (n, block)) in all.iter_mut().zip(found) {
            write_block(to, n, &block);
        }
        let [qq, qv, vv, qa, q_lambda] = all.map(|matrix| matrix.data.0);
        with_curvature(
            self.inverse_dynamics_second_derivatives(t, q, v, a, w),
            ConstraintCurvature { qq, qv, vv, qa, q_lambda },
        )
    }
}

impl<const NQ: usize, const NV: usize, const NU: usize, R: Borrow<Robot>> SecondDerivatives<NQ, NV, NU>
    for Padded<NQ, NV, NU, R>
{
    fn inverse_dynamics_second_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        a: &SVector<f64, NV>,
        lambda: &SVector<f64, NV>,
    ) -> SecondOrder<f64, NV> {
        let state = State {
            a: self.velocity_entries(a),
            other: &[self.velocity_entries(lambda)],
            ..self.state_with_velocity(t, q, v)
        };
        let f = InternalFunction::InverseDynamicsSecondDerivatives;
        self.evaluate_square_matrices(f, state, [Square::zeros(); 4]).into()
    }

    fn forward_dynamics_second_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        tau: &SVector<f64, NV>,
        lambda: &SVector<f64, NV>,
    ) -> SecondOrder<f64, NV> {
        if self.is_constrained() {
            return constrained_second_derivatives::<_, _, NQ, NV, NU, NV, NV>(self, t, q, v, tau, lambda);
        }
        let first = self.forward_dynamics_derivatives(t, q, v, tau);
        let a = self.forward_dynamics(t, q, v, tau);
        forward_second_derivatives(&first, lambda, |mu| {
            self.inverse_dynamics_second_derivatives(t, q, v, &a, mu)
        })
    }

    fn generalized_forces_second_derivatives(
        &self,
        t: f64,
        q: &SVector<f64, NQ>,
        v: &SVector<f64, NV>,
        u: &SVector<f64, NU>,
        lambda: &SVector<f64, NV>,
    ) -> InputSecondOrder<f64, NV, NU> {
        let (n, m) = (self.robot().nv(), self.robot().nu());
        let state = State {
            u: self.input_entries(u),
            other: &[self.velocity_entries(lambda)],
            ..self.state_with_velocity(t, q, v)
        };
        let mut found = vec![0.0; 3 * n * n + 2 * n * m + m * m];
        self.call_function(InternalFunction::GeneralizedForcesSecondDerivatives, state, &mut found);
        let (squares, rest) = found.split_at(3 * n * n);
        let (mixed, by_inputs) = rest.split_at(2 * n * m);
        let square_block = |k: usize| {
            let mut all = Square::zeros();
            write_block(&mut all, n, &squares[k * n * n..(k + 1) * n * n]);
            all
        };
        let mixed_block = |k: usize| {
            let mut all = SMatrix::zeros();
            write_block(&mut all, n, &mixed[k * n * m..(k + 1) * n * m]);
            all
        };
        let mut uu = SMatrix::zeros();
        write_block(&mut uu, m, by_inputs);
        (square_block(0), square_block(1), square_block(2), mixed_block(0), mixed_block(1), uu)
    }

    fn tangent_rate_second_derivatives(
        &self,
        dv: &SVector<f64, NV>,
        v: &SVector<f64, NV>,
        lambda: &SVector<f64, NV>,
    ) -> (Square<NV>, Square<NV>) {
        if self.has_speeds() {
            return (Square::repeat(f64::NAN), Square::repeat(f64::NAN));
        }
        let (mut first, mut second) = (Square::zeros(), Square::zeros());
        for chart in &self.robot().shared.charts {
            match *chart {
                Chart::Plain(..) => {}
                Chart::Ball(_, at) => {
                    let [dv, v, lambda] = [dv, v, lambda].map(|x| consecutive_entries(x, at.0));
                    let blocks = ball_tangent_rate_second_derivatives(dv, v, lambda);
                    put_block(&mut first, at.0, &blocks.0);
                    put_block(&mut second, at.0, &blocks.1);
                }
                Chart::Free(_, at) => {
                    let [dv, v, lambda] = [dv, v, lambda].map(|x| consecutive_entries(x, at.0));
                    let blocks = free_tangent_rate_second_derivatives(dv, v, lambda);
                    put_block(&mut first, at.0, &blocks.0);
                    put_block(&mut second, at.0, &blocks.1);
                }
            }
        }
        (first, second)
    }

    fn visit_constraint_curvature<V: CurvatureVisitor<f64, NQ, NV, NU>>(
        &self,
        visitor: V,
    ) -> Option<V::Output> {
        self.has_function(InternalFunction::ConstraintCurvature).then(|| visitor.visit(self))
    }
}
