//! Functions of mechanisms with constraints, for which the runtime computes accelerations and multipliers.

use crate::capacity::Visitor;
use crate::error::Error;
use crate::functions::{Entry, Maker, Matrix, Plan};
use crate::padded::Padded;
use crate::robot::Robot;
use linkwork::nalgebra::SVector;
use linkwork::{Constrained, Derivatives};
use linkwork_compiler::catalogue::{Argument, Id};

/// Function of a constrained mechanism that the runtime evaluates, instead of a compiled program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ConstrainedFunction {
    /// Function that returns the accelerations under generalized forces and constraint forces.
    Accelerations,
    /// Function that returns the accelerations and constraint multipliers.
    Dynamics,
    /// Function that returns the derivatives of the accelerations of constrained motion.
    Derivatives,
}

/// Adds the functions of constrained dynamics to those of a mechanism, if it has constraints and dynamics.
pub(crate) fn add(maker: &mut Maker<'_, '_>) {
    let has_function = |id: Id| maker.output.functions.iter().any(|f| f.id == id);
    if !has_function(Id::ConstrainedDynamics) {
        return;
    }
    let has_derivatives = has_function(Id::MotionDerivatives);
    let (nv, nc) = (maker.model.nv(), maker.model.constraints.len());
    let time = maker.model.time.then_some(Argument::T);
    let arguments: Vec<Argument> =
        time.into_iter().chain([Argument::Q, Argument::V, Argument::Tau]).collect();
    let result_matrix = |name, rows, columns| Matrix { name, rows, columns };
    let functions = [
        (
            ConstrainedFunction::Accelerations,
            "forward_dynamics",
            "Accelerations under the generalized forces `tau` and the forces of the constraints; NaN where \
             friction jams.",
            vec![result_matrix("result", nv, 1)],
        ),
        (
            ConstrainedFunction::Dynamics,
            "constrained_dynamics",
            "Accelerations under the generalized forces `tau`, and the multipliers of the constraints.",
            vec![result_matrix("accelerations", nv, 1), result_matrix("multipliers", nc, 1)],
        ),
        (
            ConstrainedFunction::Derivatives,
            "forward_dynamics_derivatives",
            "Derivatives of the accelerations under the constraints with respect to `q`, `v` and `tau`.",
            vec![
                result_matrix("by_q", nv, nv),
                result_matrix("by_v", nv, nv),
                result_matrix("by_tau", nv, nv),
            ],
        ),
    ];
    for (kind, name, documentation, results) in functions {
        if kind != ConstrainedFunction::Derivatives || has_derivatives {
            let plan = Plan::Constrained(kind);
            let rank = if kind == ConstrainedFunction::Derivatives { 2 } else { 1 };
            let entry = Entry::new(name, documentation.to_string(), arguments.clone(), results, plan);
            maker.entries.push(Entry { rank, ..entry });
        }
    }
}

impl Robot {
    /// Evaluates a function of constrained dynamics with the arguments `t` (if the mechanism depends on it),
    /// `q`, `v` and `tau`.
    pub(crate) fn call_constrained(
        &self,
        kind: ConstrainedFunction,
        arguments: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Error> {
        let [time @ .., q, v, tau] = arguments else { return Ok(()) };
        let t = time.first().and_then(|t| t.first()).copied().unwrap_or_default();
        self.visit_padded_robot(Call { kind, t, q, v, tau, out })
    }
}

/// Call of a function of constrained dynamics, with its arguments and results.
struct Call<'a> {
    kind: ConstrainedFunction,
    t: f64,
    q: &'a [f64],
    v: &'a [f64],
    tau: &'a [f64],
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
        if self.kind == ConstrainedFunction::Derivatives {
            let (by_q, by_v, by_tau) = m.forward_dynamics_derivatives(self.t, &q, &v, &tau);
            for (to, from) in self.out.chunks_exact_mut(n * n).zip([by_q, by_v, by_tau]) {
                for (to, from) in to.chunks_exact_mut(n).zip(from.column_iter()) {
                    to.copy_from_slice(&from.as_slice()[..n]);
                }
            }
            return;
        }
        let (a, lambda) = Constrained::<N, N, N, N, N>::constrained_dynamics(m, self.t, &q, &v, &tau);
        let (accelerations, multipliers) = self.out.split_at_mut(n);
        accelerations.copy_from_slice(&a.as_slice()[..n]);
        let count = multipliers.len();
        multipliers.copy_from_slice(&lambda.as_slice()[..count]);
    }
}
