//! Functions of a loaded mechanism: their signatures, and the computation of their results by programs.

use crate::configuration_space::ConfigurationSpaceFunction;
use crate::constrained::ConstrainedDynamicsFunction;
use crate::frames::FrameQuantity;
use crate::inverse::Inverse;
use crate::kernels::{self, ColumnGroup};
use crate::merge::ProgramMerger;
use crate::polytopes::takes_features;
use crate::routine::{Routine, Values};
use crate::separate::SeparateContactFunction;
use crate::shared::SharedMechanism;
use linkwork_compiler::catalogue::{Argument, CalledFunction, GeneratedId, REACTION, Record, Shape};
use linkwork_compiler::derive::{self, DerivationOutput};
use linkwork_compiler::lower::{Operand, Program};
use linkwork_compiler::mechanism::{Model, Quantity, SuppliedQuantity};
use linkwork_compiler::syntax::RATE_OF_STATE;

/// Result of a function: a matrix, which is stored by columns behind the previous results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Matrix {
    /// Name of the result, which is a matrix.
    pub name: &'static str,
    /// Number of rows of the result matrix.
    pub rows: usize,
    /// Number of columns of the result matrix; one for a vector.
    pub columns: usize,
}

impl Matrix {
    /// Returns the number of entries of the result matrix.
    #[must_use]
    pub fn length(&self) -> usize {
        self.rows * self.columns
    }
}

/// Function of a loaded mechanism: signature, documentation, and plan of its evaluation.
pub(crate) struct LoadedFunction {
    pub name: String,
    pub documentation: String,
    /// Whether the function is hidden from callers and only called by other functions.
    pub hidden: bool,
    pub arguments: Vec<Argument>,
    /// Number of values of each argument, set when the mechanism has been loaded completely.
    pub lengths: Vec<usize>,
    pub results: Vec<Matrix>,
    /// Number of dimensions of the results: zero for scalars, one for vectors, two for matrices.
    pub rank: usize,
    /// Total number of entries of all results of the function.
    pub length: usize,
    /// Number of values in the workspace that an evaluation of the function needs.
    pub work: usize,
    /// Whether the programs take features of polytopes in contact as their last input.
    pub takes_features: bool,
    pub plan: ResultAssembly,
}

/// Method by which the results of a function are assembled from the outputs of programs.
pub(crate) enum ResultAssembly {
    /// The results are the outputs of one program.
    Program(Routine),
    /// The results are the outputs of a program that is composed of the steps of links between the ground and
    /// a frame.
    Frame(FrameQuantity, usize, Routine),
    Inverse(Routine, Inverse),
    Forward {
        routine: Routine,
        inverse: Inverse,
        columns: [Vec<ColumnGroup>; 2],
        n: usize,
    },
    ForwardDerivativesByCalls(Box<ForwardDerivativesByCalls>),
    Linear {
        routine: Routine,
        columns: [Vec<ColumnGroup>; 3],
        n: usize,
        m: usize,
    },
    CalledLinear {
        routine: Routine,
        derivatives: usize,
        columns: [Vec<ColumnGroup>; 3],
        n: usize,
        m: usize,
    },
    ConfigurationSpaceFunction(ConfigurationSpaceFunction),
    /// The results are computed by the runtime, for a mechanism with constraints.
    Constrained(ConstrainedDynamicsFunction),
    /// The results are those of separate contacts.
    SeparateContacts(SeparateContactFunction),
}

/// Computation of the derivatives of forward dynamics by calls of other functions.
pub(crate) struct ForwardDerivativesByCalls {
    /// Program that computes the accelerations and the data for completing the inverse mass matrix.
    accelerations: Routine,
    inverse: Inverse,
    /// Index of the function that computes the derivatives of inverse dynamics.
    forces: usize,
    /// Program that computes the columns of the derivatives that need no product with the inverse mass
    /// matrix.
    known: Routine,
    /// Index of each column that needs no matrix product, in `∂v̇/∂q`, then in `∂v̇/∂v`.
    places: Vec<usize>,
    columns: [Vec<ColumnGroup>; 2],
    n: usize,
}

impl ResultAssembly {
    /// Returns the compiled programs that the plan evaluates.
    pub fn routines(&self) -> Vec<&Routine> {
        match self {
            ResultAssembly::Program(routine)
            | ResultAssembly::Frame(_, _, routine)
            | ResultAssembly::Inverse(routine, _)
            | ResultAssembly::Forward { routine, .. }
            | ResultAssembly::Linear { routine, .. }
            | ResultAssembly::CalledLinear { routine, .. } => vec![routine],
            ResultAssembly::ForwardDerivativesByCalls(called) => vec![&called.accelerations, &called.known],
            ResultAssembly::ConfigurationSpaceFunction(_)
            | ResultAssembly::Constrained(_)
            | ResultAssembly::SeparateContacts(_) => Vec::new(),
        }
    }

    /// Returns the indices of the functions that the plan calls.
    pub fn called_function_indices(&self) -> Vec<usize> {
        match self {
            ResultAssembly::ForwardDerivativesByCalls(called) => vec![called.forces],
            ResultAssembly::CalledLinear { derivatives, .. } => vec![*derivatives],
            ResultAssembly::ConfigurationSpaceFunction(space) => space.called_function_indices(),
            _ => Vec::new(),
        }
    }
}

impl LoadedFunction {
    /// Selects the entries of each argument that belong to state `k` of a batch. An argument with the entries
    /// of one state is common to all states.
    pub fn select_state_arguments<'a>(&self, k: usize, arguments: &[&'a [f64]], to: &mut [&'a [f64]]) {
        for ((to, list), length) in to.iter_mut().zip(arguments).zip(&self.lengths) {
            *to = if list.len() == *length { list } else { &list[k * length..(k + 1) * length] };
        }
    }

    /// Evaluates the function and writes its results to `out`. The lengths of all slices must be correct.
    pub fn run(&self, shared: &SharedMechanism, values: Values<'_>, out: &mut [f64], work: &mut [f64]) {
        match self.takes_features {
            true => shared.call_with_polytope_features(values, &self.arguments, |values| {
                self.run_plan(shared, values, out, work);
            }),
            false => self.run_plan(shared, values, out, work),
        }
    }

    fn run_plan(&self, shared: &SharedMechanism, values: Values<'_>, out: &mut [f64], work: &mut [f64]) {
        match &self.plan {
            ResultAssembly::Program(routine) => routine.run(values, out, &mut []),
            ResultAssembly::Frame(access, frame, routine) => {
                routine.build_program_once(|| shared.frames.program(*access, *frame));
                routine.run(values, out, &mut []);
            }
            ResultAssembly::Inverse(routine, inverse) => {
                let (beside, work) = work.split_at_mut(inverse.output_count_after_columns());
                routine.run(values, out, beside);
                inverse.complete(out, beside, work);
            }
            ResultAssembly::Forward { routine, inverse, columns, n } => {
                let (more, work) = work.split_at_mut(inverse.output_count_after_columns());
                routine.run(values, out, more);
                let (forces, matrix) = out.split_at_mut(2 * n * n);
                inverse.complete(matrix, more, work);
                solve_for_acceleration_derivatives(*n, matrix, forces, columns, work);
            }
            ResultAssembly::ForwardDerivativesByCalls(called) => {
                called.run_forward_dynamics_derivatives(shared, values, &self.arguments, out, work)
            }
            ResultAssembly::Linear { routine, columns, n, m } => {
                let (all, work) = work.split_at_mut(4 * n * n + n * m);
                routine.run(values, all, &mut []);
                let (forces, rest) = all.split_at_mut(2 * n * n);
                let (inverse, rest) = rest.split_at_mut(n * n);
                let (inputs, turning) = rest.split_at_mut(n * m);
                let (by_q, by_v) = forces.split_at_mut(n * n);
                let matrices = [&mut *by_q, &mut *by_v, &mut *inputs];
                kernels::replace_by_negative_products(*n, inverse, matrices, columns, work);
                assemble_linearized_system(*n, *m, [by_q, by_v, inputs, turning], out);
            }
            ResultAssembly::CalledLinear { routine, derivatives, columns, n, m } => {
                let square = n * n;
                let (all, rest) = work.split_at_mut(n + 3 * square + n * m);
                let (found, work) = rest.split_at_mut(3 * square);
                routine.run(values, all, &mut []);
                let (tau, rest) = all.split_at_mut(*n);
                let (forces, rest) = rest.split_at_mut(2 * square);
                let (inputs, turning) = rest.split_at_mut(n * m);
                shared.call(*derivatives, values, &self.arguments, &[(Argument::Tau, tau)], found, work);
                let (by, inverse) = found.split_at_mut(2 * square);
                let (by_q, by_v) = forces.split_at_mut(square);
                let matrices = [&mut *by_q, &mut *by_v, &mut *inputs];
                kernels::replace_by_negative_products(*n, inverse, matrices, columns, work);
                by.iter_mut().zip(&*forces).for_each(|(by, more)| *by -= more);
                let (by_q, by_v) = by.split_at(square);
                assemble_linearized_system(*n, *m, [by_q, by_v, inputs, turning], out);
            }
            ResultAssembly::ConfigurationSpaceFunction(space) => {
                space.evaluate(shared, values, &self.arguments, out, work)
            }
            // The robot calls these functions itself.
            ResultAssembly::Constrained(_) | ResultAssembly::SeparateContacts(_) => out.fill(f64::NAN),
        }
    }
}

impl ForwardDerivativesByCalls {
    fn run_forward_dynamics_derivatives(
        &self,
        shared: &SharedMechanism,
        values: Values<'_>,
        arguments: &[Argument],
        out: &mut [f64],
        work: &mut [f64],
    ) {
        let n = self.n;
        let (a, rest) = work.split_at_mut(n);
        let (more, rest) = rest.split_at_mut(n * n + self.inverse.output_count_after_columns());
        let (forces, matrix) = out.split_at_mut(2 * n * n);
        self.accelerations.run(values, a, more);
        let (columns, beside) = more.split_at_mut(n * n);
        matrix.copy_from_slice(columns);
        self.inverse.complete(matrix, beside, rest);
        self.inverse.solve(matrix, beside, a, rest);
        shared.call(self.forces, values, arguments, &[(Argument::A, a)], forces, rest);
        solve_for_acceleration_derivatives(n, matrix, forces, &self.columns, rest);
        let known = &mut rest[..n * self.places.len()];
        self.known.run(values, known, &mut []);
        for (column, place) in known.chunks_exact(n).zip(&self.places) {
            forces[place * n..(place + 1) * n].copy_from_slice(column);
        }
    }
}

/// Replaces derivatives of generalized forces by derivatives of accelerations, by products with the inverse
/// mass matrix.
fn solve_for_acceleration_derivatives(
    n: usize,
    inverse: &[f64],
    forces: &mut [f64],
    columns: &[Vec<ColumnGroup>; 2],
    work: &mut [f64],
) {
    let (by_q, by_v) = forces.split_at_mut(n * n);
    kernels::replace_by_negative_products(n, inverse, [by_q, by_v], columns, work);
}

/// Assembles the matrices `A` and `B` of a linearised system. The inputs are the derivatives of the
/// accelerations with respect to `q` and `v`, minus those with respect to the inputs, and the matrix that
/// multiplies the rates of displacements.
fn assemble_linearized_system(
    n: usize,
    m: usize,
    [by_q, by_v, inputs, turning]: [&[f64]; 4],
    out: &mut [f64],
) {
    let (state, by_input) = out.split_at_mut(4 * n * n);
    for j in 0..n {
        let (first, second) = (2 * n * j, 2 * n * (n + j));
        state[first..first + n].copy_from_slice(&turning[n * j..n * (j + 1)]);
        state[first + n..first + 2 * n].copy_from_slice(&by_q[n * j..n * (j + 1)]);
        state[second..second + n].fill(0.0);
        state[second + j] = 1.0;
        state[second + n..second + 2 * n].copy_from_slice(&by_v[n * j..n * (j + 1)]);
    }
    for j in 0..m {
        let column = &mut by_input[2 * n * j..2 * n * (j + 1)];
        column[..n].fill(0.0);
        for (to, from) in column[n..].iter_mut().zip(&inputs[n * j..]) {
            *to = -from;
        }
    }
}

/// Builder of the callable functions of a mechanism.
pub(crate) struct CallableFunctionBuilder<'a, 'g> {
    pub model: &'a Model<'g>,
    pub output: &'a DerivationOutput,
    pub entries: Vec<LoadedFunction>,
}

impl CallableFunctionBuilder<'_, '_> {
    fn find_function(&self, id: GeneratedId) -> Option<&derive::Function> {
        self.output.functions.iter().find(|f| f.id == id)
    }

    /// Returns the index of the function with this name among the added ones; `None` for an unknown name.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.entries.iter().position(|entry| entry.name == name)
    }

    /// Adds the functions that the compiler has derived to the callable functions.
    pub fn add_derived_functions(&mut self) {
        let output = self.output;
        for f in &output.functions {
            let made = self.callable_function_entry(f);
            self.entries.extend(made);
        }
    }

    /// Returns the name by which callers find a derived function; `None` for a function that callers cannot
    /// call.
    fn callable_name_of_function<'f>(&self, f: &'f derive::Function) -> Option<&'f str> {
        match f.id {
            GeneratedId::InputDerivatives => Some("generalized_forces_derivatives"),
            // Variants that write to several matrices: here all functions do.
            GeneratedId::InverseDynamicsDerivativesInto | GeneratedId::ForwardDynamicsDerivativesInto => None,
            GeneratedId::Neutral => Some("neutral"),
            GeneratedId::Limits | GeneratedId::Figures => Some(f.name.trim_start_matches('_')),
            _ if is_internal(f.id) => Some(&f.name),
            _ if f.is_hidden() && f.name.ends_with(RATE_OF_STATE) => Some(&f.name),
            _ if f.is_hidden() || f.name.starts_with("__") => None,
            _ => Some(&f.name),
        }
    }

    /// Returns the callable function for a derived function; `None` for a function that callers cannot call.
    fn callable_function_entry(&self, f: &derive::Function) -> Option<LoadedFunction> {
        let hidden = is_internal(f.id);
        let has_dynamics = self.find_function(GeneratedId::ForwardDynamics).is_some();
        if f.id == GeneratedId::Reaction
            && has_dynamics
            && !f.arguments.iter().any(is_contact_forces_argument)
        {
            return self.reaction_output_entry(f);
        }
        let name = self.callable_name_of_function(f)?;
        let arguments: Vec<Argument> = f.arguments.iter().copied().filter(is_passed).collect();
        let (n, m) = (self.model.nv(), self.model.nu());
        let program = self.prepend_passive_forces(&f.program);
        let takes_features = takes_features(&program);
        let features = takes_features.then_some(Argument::Called(CalledFunction::ContactFeatures));
        let inputs: Vec<Argument> = arguments.iter().copied().chain(features).collect();
        let routine_with_result_count = |results: usize| Routine::new(program.clone(), &inputs, results);
        let outputs = program.outputs.len();
        let inverse_assembly_of_function = || Inverse::new(&f.structure.inverse, n);
        let zero_entry_predicate = |first: usize| {
            let program = &program;
            move |j: usize, i: usize| program.outputs[first + j * n + i] == Operand::Const(0.0)
        };
        // Columns of derivatives by `q`, `v` and `u` that begin at these outputs.
        let columns_by_q_v_and_u = |[q, v, u]: [usize; 3]| {
            [(n, q), (n, v), (m, u)].map(|(count, first)| {
                ColumnGroup::group_columns(n, &(0..count).collect::<Vec<_>>(), zero_entry_predicate(first))
            })
        };
        let (plan, work) = match f.shape {
            Shape::Inverse(_) => {
                let inverse = inverse_assembly_of_function();
                let work = inverse.output_count_after_columns() + inverse.work_space_size();
                (ResultAssembly::Inverse(routine_with_result_count(n * n)?, inverse), work)
            }
            Shape::Forward(_) => {
                let inverse = inverse_assembly_of_function();
                let work = inverse.output_count_after_columns()
                    + inverse.work_space_size().max(kernels::work_space_size(n));
                let columns = self.columns_multiplied_by_inverse(f, &zero_entry_predicate(0));
                // The accelerations, which come last, have a function of their own.
                let kept: Vec<usize> = (0..3 * n * n + inverse.output_count_after_columns()).collect();
                let routine = Routine::new(program.clone().with_selected_outputs(&kept), &inputs, 3 * n * n)?;
                (ResultAssembly::Forward { routine, inverse, columns, n }, work)
            }
            Shape::Accelerated(_) | Shape::Symmetric(_) => return None,
            Shape::ForwardDerivativesByCalls(_) => {
                let accelerations = self.find_function(GeneratedId::AccelerationsAndInverse)?;
                let inverse = Inverse::new(&accelerations.structure.inverse, n);
                let forces = self.index("inverse_dynamics_derivatives")?;
                let known = f.structure.known.iter().zip([0, n]);
                let places: Vec<usize> =
                    known.flat_map(|(known, first)| known.iter().map(move |k| first + k)).collect();
                let columns = self.columns_multiplied_by_inverse(f, &|_, _| false);
                let rest = inverse.work_space_size().max(kernels::work_space_size(n)).max(n * places.len());
                let work =
                    n + n * n + inverse.output_count_after_columns() + rest.max(self.entries[forces].work);
                let called = ForwardDerivativesByCalls {
                    accelerations: Routine::new(
                        self.prepend_passive_forces(&accelerations.program),
                        &arguments,
                        n,
                    )?,
                    inverse,
                    forces,
                    known: routine_with_result_count(outputs)?,
                    places,
                    columns,
                    n,
                };
                (ResultAssembly::ForwardDerivativesByCalls(Box::new(called)), work)
            }
            Shape::Linear(..) => {
                let columns = columns_by_q_v_and_u([0, n * n, 3 * n * n]);
                let work = 4 * n * n + n * m + kernels::work_space_size(n);
                (ResultAssembly::Linear { routine: routine_with_result_count(outputs)?, columns, n, m }, work)
            }
            Shape::CalledLinear(..) => {
                let columns = columns_by_q_v_and_u([n, n + n * n, n + 2 * n * n]);
                let derivatives = self.index("forward_dynamics_derivatives")?;
                let rest = kernels::work_space_size(n).max(self.entries[derivatives].work);
                let work = n + 6 * n * n + n * m + rest;
                (
                    ResultAssembly::CalledLinear {
                        routine: routine_with_result_count(outputs)?,
                        derivatives,
                        columns,
                        n,
                        m,
                    },
                    work,
                )
            }
            Shape::Record(Record::InputDerivatives(..)) => {
                // The forces have a function of their own.
                let program = program.clone().with_selected_outputs(&(n..outputs).collect::<Vec<_>>());
                (ResultAssembly::Program(Routine::new(program, &inputs, outputs - n)?), 0)
            }
            _ => (ResultAssembly::Program(routine_with_result_count(outputs)?), 0),
        };
        let results = result_matrix_shapes(f.shape, outputs);
        let documentation = f.docs.join("\n\n");
        let rank = rank_of_shape(f.shape);
        let entry = LoadedFunction::new(name, documentation, arguments, results, plan);
        Some(LoadedFunction { hidden, work, rank, takes_features, ..entry })
    }

    /// Returns the columns of `∂τ/∂q` and `∂τ/∂v` that are multiplied by the inverse mass matrix.
    fn columns_multiplied_by_inverse(
        &self,
        f: &derive::Function,
        is_zero: &dyn Fn(usize, usize) -> bool,
    ) -> [Vec<ColumnGroup>; 2] {
        let n = self.model.nv();
        let zeros = &f.structure.zeros;
        [0, 1].map(|k| {
            let known = &f.structure.known[k];
            let columns: Vec<usize> = (0..n).filter(|j| !known.contains(j)).collect();
            ColumnGroup::group_columns(n, &columns, |j, i| match zeros.get((k * n + j) * n + i) {
                Some(zero) => *zero,
                None => is_zero(k * n + j, i),
            })
        })
    }

    /// Returns a program preceded by the programs of the passive forces that it uses. A program without them
    /// keeps its variant with lanes.
    pub fn prepend_passive_forces(&self, program: &Program) -> Program {
        let symbols = program.used_symbols();
        let takes_called_argument = |called: CalledFunction| {
            symbols.iter().any(|symbol| {
                Argument::Called(called).index_of_quantity(Quantity::from_symbol(*symbol)).is_some()
            })
        };
        let mut merged = ProgramMerger::default();
        for (called, id, quantity) in [
            (
                CalledFunction::PassiveForces,
                GeneratedId::PassiveForces,
                Quantity::PassiveForce as fn(usize) -> Quantity,
            ),
            (
                CalledFunction::PassiveDerivatives,
                GeneratedId::PassiveDerivatives,
                Quantity::PassiveDerivative,
            ),
        ] {
            let Some(f) = self.find_function(id).filter(|_| takes_called_argument(called)) else { continue };
            for (k, output) in merged.append_program(&f.program).into_iter().enumerate() {
                merged.bind_symbol(quantity(k).symbol(), output);
            }
        }
        let outputs = merged.append_program(program);
        let calls_others = CalledFunction::ALL.into_iter().any(takes_called_argument);
        Program { simd: program.simd.clone().filter(|_| !calls_others), ..merged.finish(outputs) }
    }

    /// Returns the function of an output that contains joint reactions, for the motion that state and inputs
    /// determine.
    fn reaction_output_entry(&self, f: &derive::Function) -> Option<LoadedFunction> {
        let name = f.name.strip_prefix(REACTION)?;
        let mut merged = ProgramMerger::default();
        let inputs = self.find_function(GeneratedId::GeneralizedForces).filter(|_| self.model.nu() > 0);
        let n = self.model.nv();
        let tau = match inputs {
            Some(f) => merged.append_program(&self.prepend_passive_forces(&f.program)),
            None => vec![Operand::Const(0.0); n],
        };
        (0..n).zip(tau).for_each(|(k, tau)| merged.bind_symbol(Quantity::Force(k).symbol(), tau));
        let a = merged.append_program(
            &self.prepend_passive_forces(&self.find_function(GeneratedId::ForwardDynamics)?.program),
        );
        (0..n).zip(a).for_each(|(k, a)| merged.bind_symbol(Quantity::Acceleration(k).symbol(), a));
        let outputs = merged.append_program(&self.prepend_passive_forces(&f.program));
        let time = self.model.time.then_some(Argument::T);
        let u = (self.model.nu() > 0).then_some(Argument::U);
        let arguments: Vec<Argument> = time.into_iter().chain([Argument::Q, Argument::V]).chain(u).collect();
        let length = outputs.len();
        let routine = Routine::new(merged.finish(outputs), &arguments, length)?;
        let documentation = format!("Output `{name}` of the motion that state and inputs determine.");
        let entry = LoadedFunction::new(
            name,
            documentation,
            arguments,
            result_matrix_shapes(f.shape, length),
            ResultAssembly::Program(routine),
        );
        Some(LoadedFunction { rank: rank_of_shape(f.shape), ..entry })
    }
}

impl LoadedFunction {
    /// Returns a callable function without workspace, whose results are vectors.
    pub fn new(
        name: &str,
        documentation: String,
        arguments: Vec<Argument>,
        results: Vec<Matrix>,
        plan: ResultAssembly,
    ) -> LoadedFunction {
        let length = results.iter().map(Matrix::length).sum();
        LoadedFunction {
            name: name.to_string(),
            documentation,
            hidden: false,
            arguments,
            lengths: Vec::new(),
            results,
            rank: 1,
            length,
            work: 0,
            takes_features: false,
            plan,
        }
    }
}

/// Returns names and dimensions of the results of a function. Scalars and plain arrays are named `result`.
fn result_matrix_shapes(shape: Shape, outputs: usize) -> Vec<Matrix> {
    let arrays = shape.result_arrays();
    match arrays.is_empty() {
        true => vec![Matrix { name: "result", rows: outputs, columns: 1 }],
        false => arrays.into_iter().map(|(name, rows, columns)| Matrix { name, rows, columns }).collect(),
    }
}

/// Whether only the runtime calls the function.
fn is_internal(id: GeneratedId) -> bool {
    matches!(
        id,
        GeneratedId::Limits
            | GeneratedId::Figures
            | GeneratedId::ConstrainedDynamics
            | GeneratedId::ConstraintResponse
            | GeneratedId::SlippingResponse
            | GeneratedId::MotionDerivatives
            | GeneratedId::ContactLaws
            | GeneratedId::ContactResponses
            | GeneratedId::ContactDerivatives
            | GeneratedId::ContactDerivativesByParameters
            | GeneratedId::ConstraintCurvature
            | GeneratedId::PolytopePoses
            | GeneratedId::RateMatrix
            | GeneratedId::SpeedMatrix
            | GeneratedId::RateChanges
            | GeneratedId::Turning
            | GeneratedId::Heights
    )
}

/// Returns the number of dimensions of a function's results: zero for scalars, one for vectors, two for
/// matrices.
fn rank_of_shape(shape: Shape) -> usize {
    match shape {
        Shape::Scalar => 0,
        Shape::Vector(_) | Shape::Array(_) => 1,
        Shape::Record(Record::InputDerivatives(..)) => 2,
        Shape::Record(_) => 1,
        _ => 2,
    }
}

/// Whether callers pass this argument.
pub(crate) fn is_passed(argument: &Argument) -> bool {
    !matches!(argument, Argument::Into(..) | Argument::Called(_))
}

fn is_contact_forces_argument(argument: &Argument) -> bool {
    matches!(argument, Argument::Given(_, SuppliedQuantity::ContactForces, _))
}
