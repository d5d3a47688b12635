//! Computation of vector–Jacobian products for Python.

use super::{ARGUMENTS, Argument, EvaluationMethod, FunctionDefinition};
use crate::robot::{Robot, set_parameters};
use crate::shared::FirstFailedState;
use linkwork_jit::{AdjointStepper, Error, Sensitivity, VectorJacobian};
use std::ops::Range;

/// Vector–Jacobian product for one state: derivatives with respect to the arguments in order, then the
/// parameters.
enum VectorJacobianComputation {
    Product(linkwork_jit::Robot, VectorJacobian),
    /// Derivatives of a frame's placement as a matrix of four rows, whose last row is constant.
    Placement(linkwork_jit::Robot, VectorJacobian),
    Step(Box<AdjointStepper>),
}

impl VectorJacobianComputation {
    fn robot_mut(&mut self) -> &mut linkwork_jit::Robot {
        match self {
            VectorJacobianComputation::Product(robot, _) | VectorJacobianComputation::Placement(robot, _) => {
                robot
            }
            VectorJacobianComputation::Step(stepper) => stepper.robot_mut(),
        }
    }

    fn evaluate(&mut self, arguments: &[&[f64]], factors: &[f64], out: &mut [f64]) -> Result<(), Error> {
        match self {
            VectorJacobianComputation::Product(robot, product) => {
                product.evaluate_into(robot, arguments, factors, out)
            }
            VectorJacobianComputation::Placement(robot, product) => {
                let mut own = [0.0; 12];
                for (column, factors) in own.chunks_exact_mut(3).zip(factors.chunks_exact(4)) {
                    column.copy_from_slice(&factors[..3]);
                }
                product.evaluate_into(robot, arguments, &own, out)
            }
            VectorJacobianComputation::Step(stepper) => {
                let (t, rest, first) = match arguments {
                    [t, rest @ ..] if rest.len() == 4 => (t[0], rest, 1),
                    rest => (0.0, rest, 0),
                };
                let [q, v, u, h] = rest else {
                    return Err(Error::Internal("the arguments of a step".to_string()));
                };
                out.fill(0.0);
                let (time, own) = out.split_at_mut(first);
                let (by_q, rest) = own.split_at_mut(q.len());
                let (by_v, rest) = rest.split_at_mut(v.len());
                let (by_u, rest) = rest.split_at_mut(u.len());
                by_q.copy_from_slice(&factors[..q.len()]);
                by_v.copy_from_slice(&factors[q.len()..]);
                let (length, parameters) = rest.split_at_mut(1);
                let mut derivatives = Sensitivity { q: by_q, v: by_v, u: by_u, parameters };
                let [by_t, by_h] = stepper.step(t, [q, v, u], h[0], &mut derivatives)?;
                time.fill(by_t);
                length.fill(by_h);
                Ok(())
            }
        }
    }
}

impl FunctionDefinition {
    /// Writes the vector–Jacobian products of consecutive states.
    pub(super) fn differentiate(
        &self,
        robot: &Robot,
        frame: usize,
        lists: &[&[f64]],
        states: Range<usize>,
        factors: &[f64],
        out: &mut [f64],
    ) -> FirstFailedState {
        let mut adjoint = match self.adjoint(&robot.robot, frame) {
            Ok(adjoint) => adjoint,
            Err(error) => return Some((states.start, error)),
        };
        let length = self.length();
        let width =
            robot.robot.parameters().len() + self.arguments.iter().map(Argument::length).sum::<usize>();
        let mut slices: [&[f64]; ARGUMENTS] = [&[]; ARGUMENTS];
        let mut failed = None;
        for (k, state) in states.enumerate() {
            for ((slice, list), argument) in slices.iter_mut().zip(lists).zip(&self.arguments) {
                let length = argument.length();
                let at = if list.len() == length { 0 } else { state * length };
                *slice = &list[at..at + length];
            }
            let own = &mut out[k * width..(k + 1) * width];
            let set = set_parameters(adjoint.robot_mut(), robot.sets.as_ref(), state);
            let factors = &factors[state * length..(state + 1) * length];
            let done = set.and_then(|()| adjoint.evaluate(&slices[..self.arguments.len()], factors, own));
            if let Err(error) = done {
                failed.get_or_insert((state, error));
            }
        }
        failed
    }

    /// Returns the computation of derivatives, for the given frame if the function takes a frame.
    fn adjoint(&self, robot: &linkwork_jit::Robot, frame: usize) -> Result<VectorJacobianComputation, Error> {
        Ok(match &self.kind {
            EvaluationMethod::Generated(f) => {
                VectorJacobianComputation::Product(robot.clone(), f.vector_jacobian()?)
            }
            EvaluationMethod::Frames(all) => {
                VectorJacobianComputation::Product(robot.clone(), all[frame].vector_jacobian()?)
            }
            EvaluationMethod::Placements(all) => {
                VectorJacobianComputation::Placement(robot.clone(), all[frame].vector_jacobian()?)
            }
            EvaluationMethod::Step => VectorJacobianComputation::Step(Box::new(AdjointStepper::new(robot)?)),
            _ => return Err(Error::Value(format!("`{}` has no vector–Jacobian product", self.name))),
        })
    }
}
