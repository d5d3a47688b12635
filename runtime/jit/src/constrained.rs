//! Functions that the runtime computes: accelerations, multipliers and their derivatives of mechanisms with
//! constraints, and second derivatives of accelerations.

use crate::capacity::Visitor;
use crate::error::Error;
use crate::functions::{CallableFunctionBuilder, LoadedFunction, Matrix, ResultAssembly};
use crate::padded::Padded;
use crate::robot::Robot;
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{Constrained, Derivatives, SecondDerivatives};
use linkwork_compiler::catalogue::{Argument, GeneratedId};

/// Function of a constrained mechanism that the runtime evaluates, instead of a compiled program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ConstrainedDynamicsFunction {
    /// Function that returns the accelerations under generalized forces and constraint forces.
    Accelerations,
    /// Function that returns the accelerations and constraint multipliers.
    Dynamics,
    /// Function that returns the derivatives of the accelerations of constrained motion.
    Derivatives,
    /// Function that returns the second derivatives of the accelerations, contracted with factors, with and
    /// without constraints.
    SecondDerivatives,
}

/// Adds the functions of constrained dynamics to those of a mechanism, if it has constraints and dynamics,
/// and the second derivatives of its accelerations, if they are requested.
pub(crate) fn add(maker: &mut CallableFunctionBuilder<'_, '_>) {
    let has_function = |id: GeneratedId| maker.output.functions.iter().any(|f| f.id == id);
    let (nv, nc) = (maker.model.nv(), maker.model.constraints.len());
    let is_constrained = has_function(GeneratedId::ConstrainedDynamics);
    let time = maker.model.time.then_some(Argument::T);
    let arguments: Vec<Argument> =
        time.into_iter().chain([Argument::Q, Argument::V, Argument::Tau]).collect();
    let square_matrix_shape = |name| Matrix { name, rows: nv, columns: nv };
    let vector_shape = |name, rows| Matrix { name, rows, columns: 1 };
    let mut functions = Vec::new();
    if is_constrained {
        functions.push((
            ConstrainedDynamicsFunction::Accelerations,
            "forward_dynamics",
            "Accelerations under the generalized forces `tau` and the forces of the constraints; NaN where \
             friction jams.",
            vec![vector_shape("result", nv)],
        ));
        functions.push((
            ConstrainedDynamicsFunction::Dynamics,
            "constrained_dynamics",
            "Accelerations under the generalized forces `tau`, and the multipliers of the constraints.",
            vec![vector_shape("accelerations", nv), vector_shape("multipliers", nc)],
        ));
    }
    if is_constrained && has_function(GeneratedId::MotionDerivatives) {
        functions.push((
            ConstrainedDynamicsFunction::Derivatives,
            "forward_dynamics_derivatives",
            "Derivatives of the accelerations under the constraints with respect to `q`, `v` and `tau`.",
            ["by_q", "by_v", "by_tau"].map(square_matrix_shape).to_vec(),
        ));
    }
    if has_function(GeneratedId::InverseDynamicsSecondDerivatives)
        && is_constrained == has_function(GeneratedId::ConstraintCurvature)
    {
        functions.push((
            ConstrainedDynamicsFunction::SecondDerivatives,
            "forward_dynamics_second_derivatives",
            "Second derivatives of the accelerations under the generalized forces `tau`, contracted with the \
             factors `lambda`. Rows of mixed derivatives belong to `q`; all others are zero.",
            ["by_qq", "by_qv", "by_vv", "by_qtau"].map(square_matrix_shape).to_vec(),
        ));
    }
    for (kind, name, documentation, results) in functions {
        let (rank, further) = match kind {
            ConstrainedDynamicsFunction::Accelerations | ConstrainedDynamicsFunction::Dynamics => (1, None),
            ConstrainedDynamicsFunction::Derivatives => (2, None),
            ConstrainedDynamicsFunction::SecondDerivatives => (2, Some(Argument::Factors(nv))),
        };
        let arguments = arguments.iter().copied().chain(further).collect();
        let plan = ResultAssembly::Constrained(kind);
        let entry = LoadedFunction::new(name, documentation.to_string(), arguments, results, plan);
        maker.entries.push(LoadedFunction { rank, ..entry });
    }
}

impl Robot {
    /// Evaluates a function of constrained dynamics with the arguments `t` (if the mechanism depends on it),
    /// `q`, `v`, `tau`, and `lambda` for second derivatives.
    pub(crate) fn call_constrained(
        &self,
        kind: ConstrainedDynamicsFunction,
        arguments: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Error> {
        let (arguments, lambda): (_, &[f64]) = match arguments {
            [others @ .., lambda] if kind == ConstrainedDynamicsFunction::SecondDerivatives => {
                (others, lambda)
            }
            _ => (arguments, &[]),
        };
        let [time @ .., q, v, tau] = arguments else { return Ok(()) };
        let t = time.first().and_then(|t| t.first()).copied().unwrap_or_default();
        self.visit_padded_robot(Call { kind, t, q, v, tau, lambda, out })
    }
}

/// Call of a function of constrained dynamics, with its arguments and results.
struct Call<'a> {
    kind: ConstrainedDynamicsFunction,
    t: f64,
    q: &'a [f64],
    v: &'a [f64],
    tau: &'a [f64],
    /// Factors of second derivatives.
    lambda: &'a [f64],
    out: &'a mut [f64],
}

impl Visitor for Call<'_> {
    type Output = ();

    fn visit<const N: usize>(self, m: &Padded<N, N, N, &Robot>) {
        let robot = m.robot();
        let padded_vector = |x: &[f64]| SVector::<f64, N>::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0));
        let (q, mut v, tau) = (padded_vector(self.q), padded_vector(self.v), padded_vector(self.tau));
        let n = robot.nv();
        for (k, one) in robot.shared.states.iter().enumerate() {
            v[n + k] = robot.parameter_values()[one.parameter];
        }
        match self.kind {
            ConstrainedDynamicsFunction::Accelerations | ConstrainedDynamicsFunction::Dynamics => {
                let (a, lambda) = Constrained::<N, N, N, N, N>::constrained_dynamics(m, self.t, &q, &v, &tau);
                let (accelerations, multipliers) = self.out.split_at_mut(n);
                accelerations.copy_from_slice(&a.as_slice()[..n]);
                let count = multipliers.len();
                multipliers.copy_from_slice(&lambda.as_slice()[..count]);
            }
            ConstrainedDynamicsFunction::Derivatives => {
                let (by_q, by_v, by_tau) = m.forward_dynamics_derivatives(self.t, &q, &v, &tau);
                write_matrices(n, &[by_q, by_v, by_tau], self.out);
            }
            ConstrainedDynamicsFunction::SecondDerivatives => {
                let lambda = padded_vector(self.lambda);
                let (qq, qv, vv, q_tau) =
                    m.forward_dynamics_second_derivatives(self.t, &q, &v, &tau, &lambda);
                write_matrices(n, &[qq, qv, vv, q_tau], self.out);
            }
        }
    }
}

/// Writes the first `n` rows and columns of each matrix, by columns one after the other.
fn write_matrices<const N: usize>(n: usize, matrices: &[SMatrix<f64, N, N>], out: &mut [f64]) {
    let columns = matrices.iter().flat_map(|matrix| matrix.column_iter().take(n));
    for (k, column) in columns.enumerate() {
        out[k * n..(k + 1) * n].copy_from_slice(&column.as_slice()[..n]);
    }
}
