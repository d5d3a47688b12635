//! Accelerations of mechanisms with constraints.

use crate::functions::{Entry, Maker, Matrix, Plan};
use crate::routine::{Routine, Values};
use crate::shared::Shared;
use linkwork_compiler::catalogue::{Argument, Id, Record, Shape};
use nalgebra::{DMatrix, DVector};

/// Accelerations and multipliers: by a program that eliminates the constraints if their pivots are safe, else by
/// a decomposition that finds dependent constraints.
pub(crate) struct Constrained {
    pub elimination: Routine,
    /// Whether the program eliminates all constraints; else constraints are redundant.
    eliminates: bool,
    /// Indices of `mass_matrix`, `bias_forces`, `constraint_jacobian` and `constraint_bias`.
    functions: [usize; 4],
    nv: usize,
    nc: usize,
    /// Whether the multipliers are results.
    multipliers: bool,
}

/// Singular values below this part of the greatest one are zero.
const RANK: f64 = 1e-9;
/// Accelerations that miss a constraint by this part contradict it.
const CONTRADICTION: f64 = 1e-6;

impl Constrained {
    /// Adds the functions to those of a mechanism, if it has constraints and dynamics.
    pub fn add(maker: &mut Maker<'_, '_>) {
        let Some(f) = maker.output.functions.iter().find(|f| f.id == Id::ConstrainedDynamics) else { return };
        // Friction of sliding contacts depends on the signs of multipliers.
        if maker.model.constraints.iter().any(|constraint| !constraint.friction.is_empty()) {
            return;
        }
        let eliminates = matches!(f.shape, Shape::Record(Record::Elimination(..)));
        let names = ["mass_matrix", "bias_forces", "constraint_jacobian", "constraint_bias"];
        let [Some(a), Some(b), Some(c), Some(d)] = names.map(|name| maker.index(name)) else { return };
        let (nv, nc) = (maker.model.nv(), maker.model.constraints.len());
        let time = maker.model.time.then_some(Argument::T);
        let arguments: Vec<Argument> =
            time.into_iter().chain([Argument::Q, Argument::V, Argument::Tau]).collect();
        let program = maker.whole(&f.program);
        let outputs = program.outputs.len();
        let called = [a, b, c, d].map(|k| maker.entries[k].work).into_iter().max().unwrap_or_default();
        let accelerations = Matrix { name: "result", rows: nv, columns: 1 };
        let both = [
            Matrix { name: "accelerations", rows: nv, columns: 1 },
            Matrix { name: "multipliers", rows: nc, columns: 1 },
        ];
        for (name, documentation, results) in [
            (
                "forward_dynamics",
                "Accelerations under the generalized forces `tau` and the forces of the constraints; NaN where the constraints contradict each other.",
                vec![accelerations],
            ),
            (
                "constrained_dynamics",
                "Accelerations under the generalized forces `tau`, and the multipliers of the constraints.",
                both.to_vec(),
            ),
        ] {
            let Some(elimination) = Routine::new(program.clone(), &arguments, outputs) else { continue };
            let plan = Plan::Constrained(Box::new(Constrained {
                elimination,
                eliminates,
                functions: [a, b, c, d],
                nv,
                nc,
                multipliers: results.len() > 1,
            }));
            let entry = Entry::new(name, documentation.to_string(), arguments.clone(), results, plan);
            maker.entries.push(Entry { work: outputs + called, ..entry });
        }
    }

    /// Returns the indices of the functions that are called.
    pub fn calls(&self) -> Vec<usize> {
        self.functions.to_vec()
    }

    /// Evaluates the function.
    pub fn run(
        &self,
        shared: &Shared,
        values: Values<'_>,
        arguments: &[Argument],
        out: &mut [f64],
        work: &mut [f64],
    ) {
        let (nv, nc) = (self.nv, self.nc);
        if self.eliminates {
            let found = &mut work[..nv + 3 * nc];
            self.elimination.run(values, found, &mut []);
            let (pivots, before) = found[nv + nc..].split_at(nc);
            let least = f64::EPSILON.sqrt().sqrt();
            if pivots.iter().zip(before).all(|(pivot, before)| *pivot > least * before) {
                let length = out.len();
                out.copy_from_slice(&found[..length]);
                return;
            }
        }
        let found = self.solve(shared, values, arguments, work);
        match found {
            Some((a, lambda)) => {
                out[..nv].copy_from_slice(a.as_slice());
                if self.multipliers {
                    out[nv..].copy_from_slice(lambda.as_slice());
                }
            }
            None => out.fill(f64::NAN),
        }
    }

    /// Solves for the accelerations that satisfy the constraints and are nearest to the free ones, in the
    /// metric of the mass matrix.
    fn solve(
        &self,
        shared: &Shared,
        values: Values<'_>,
        arguments: &[Argument],
        work: &mut [f64],
    ) -> Option<(DVector<f64>, DVector<f64>)> {
        let (nv, nc) = (self.nv, self.nc);
        let mut called = |function: usize, rows, columns| {
            let mut matrix = DMatrix::zeros(rows, columns);
            shared.call(function, values, arguments, &[], matrix.as_mut_slice(), work);
            matrix
        };
        let [mass, bias, jacobian, target] = self.functions;
        let mass = called(mass, nv, nv).cholesky()?;
        let (bias, jacobian, target) = (called(bias, nv, 1), called(jacobian, nc, nv), called(target, nc, 1));
        let at = arguments.iter().position(|argument| *argument == Argument::Tau)?;
        let force = DVector::from_column_slice(values.inputs[1 + at]) - bias.column(0);
        let free = mass.solve(&force);
        let response = mass.solve(&jacobian.transpose());
        let missing = -target.column(0) - &jacobian * &free;
        let decomposed = (&jacobian * &response).svd(true, true);
        let greatest = decomposed.singular_values.max();
        let lambda = decomposed.solve(&missing, RANK * greatest).ok()?;
        let a = free + response * &lambda;
        let miss = (&jacobian * &a + target.column(0)).amax();
        let scale = target.amax().max(a.amax()).max(1.0);
        (miss <= CONTRADICTION * scale).then_some((a, lambda))
    }
}
