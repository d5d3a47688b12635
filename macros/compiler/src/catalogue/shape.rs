//! Types of the arguments and results of generated functions.

use crate::mechanism::{Quantity, SuppliedQuantity};

/// Argument of a generated function, identified by its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// Time `t`, s.
    T,
    /// Configuration `q`, with `NQ` entries.
    Q,
    /// Velocity `v`, with `NV` entries.
    V,
    /// Acceleration `a`, with `NV` entries.
    A,
    /// Generalized force `tau`, with `NV` entries.
    Tau,
    /// Inputs `u`, with `NU` entries.
    U,
    /// A vector of program inputs, with the name of the argument and its length.
    Given(&'static str, SuppliedQuantity, usize),
    /// A vector of standard inertial parameters, with its length.
    Standard(usize),
    /// A square matrix to which the result is written: name of the argument and number of rows.
    Into(&'static str, usize),
    /// Factors `lambda`, one for each velocity, with which forces or accelerations are contracted.
    Factors(usize),
    /// Generalized momenta `p`, one for each velocity.
    Momenta(usize),
    /// Results of another function that the body calls first. Does not occur in the signature.
    Called(CalledFunction),
}

/// A function that other functions call first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalledFunction {
    /// The generated function that computes the passive forces.
    PassiveForces,
    /// The generated function that computes the derivatives of the passive forces.
    PassiveDerivatives,
    /// The generated function that returns the features of polytopes in contact.
    ContactFeatures,
}

impl CalledFunction {
    /// All functions that other generated functions call.
    pub const ALL: [CalledFunction; 3] =
        [CalledFunction::PassiveForces, CalledFunction::PassiveDerivatives, CalledFunction::ContactFeatures];

    /// Returns the name of the called function.
    pub const fn function_name(self) -> &'static str {
        match self {
            CalledFunction::PassiveForces => "__passive_forces",
            CalledFunction::PassiveDerivatives => "__passive_derivatives",
            CalledFunction::ContactFeatures => "__contact_features",
        }
    }

    /// Returns the arguments of the called function, except time.
    pub const fn arguments(self) -> &'static [Argument] {
        match self {
            CalledFunction::PassiveForces | CalledFunction::PassiveDerivatives => &[Argument::Q, Argument::V],
            CalledFunction::ContactFeatures => &[Argument::Q],
        }
    }
}

impl Argument {
    /// Returns the number of values of the argument, given `NQ`, `NV` and `NU`. Zero for results of other
    /// functions and for matrices that receive results.
    pub fn argument_length(self, [nq, nv, nu]: [usize; 3]) -> usize {
        match self {
            Argument::T => 1,
            Argument::Q => nq,
            Argument::V | Argument::A | Argument::Tau => nv,
            Argument::U => nu,
            Argument::Given(_, _, n)
            | Argument::Standard(n)
            | Argument::Factors(n)
            | Argument::Momenta(n) => n,
            Argument::Into(..) | Argument::Called(_) => 0,
        }
    }

    /// Returns the name of the argument in the generated signature.
    pub fn argument_name(self) -> &'static str {
        match self {
            Argument::T => "t",
            Argument::Q => "q",
            Argument::V => "v",
            Argument::A => "a",
            Argument::Tau => "tau",
            Argument::U => "u",
            Argument::Given(name, ..) | Argument::Into(name, _) => name,
            Argument::Standard(_) => "standard",
            Argument::Factors(_) => "lambda",
            Argument::Momenta(_) => "p",
            Argument::Called(CalledFunction::PassiveForces) => "passive",
            Argument::Called(CalledFunction::PassiveDerivatives) => "change",
            Argument::Called(CalledFunction::ContactFeatures) => "feature",
        }
    }

    /// Returns the index in the argument of the quantity of a symbol, `None` if the argument does not contain
    /// it.
    pub fn index_of_quantity(self, quantity: Quantity) -> Option<usize> {
        match (self, quantity) {
            (Argument::Q, Quantity::Configuration(k))
            | (Argument::V, Quantity::Velocity(k))
            | (Argument::A, Quantity::Acceleration(k))
            | (Argument::Tau, Quantity::Force(k))
            | (Argument::U, Quantity::Input(k)) => Some(k),
            (Argument::Given(_, known, _), Quantity::Given(block, k)) if known == block => Some(k),
            (Argument::Given(_, SuppliedQuantity::ContactForces, _), Quantity::ContactForce(k))
            | (Argument::Standard(_), Quantity::Given(SuppliedQuantity::Inertia, k))
            | (Argument::Factors(_), Quantity::Given(SuppliedQuantity::Factor, k))
            | (Argument::Momenta(_), Quantity::Momentum(k))
            | (Argument::Called(CalledFunction::PassiveForces), Quantity::PassiveForce(k))
            | (Argument::Called(CalledFunction::PassiveDerivatives), Quantity::PassiveDerivative(k))
            | (Argument::Called(CalledFunction::ContactFeatures), Quantity::ContactFeature(k)) => Some(k),
            _ => None,
        }
    }
}

/// Result of a generated function, and how it is assembled from the outputs of its program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shape {
    /// A scalar result.
    #[default]
    Scalar,
    /// A column vector as result, with its length.
    Vector(usize),
    /// A square matrix, whose columns are the outputs one after another.
    Square(usize),
    /// A matrix, whose columns are the outputs one after another.
    Matrix(usize, usize),
    /// Two square matrices as result, with their number of rows.
    Pair(usize),
    /// Four square matrices of second derivatives: by configuration twice, by configuration and velocity, by
    /// velocity twice, and by configuration and acceleration.
    Hessian(usize),
    /// Second derivatives of the forces of inputs: by configuration twice, by configuration and velocity, by
    /// velocity twice, by configuration and input, by velocity and input, and by input twice.
    InputPowerHessian(usize, usize),
    /// Derivatives of an output by configuration, velocity, acceleration and input. The sizes are the numbers
    /// of output rows, velocities and inputs.
    Jacobians(usize, usize, usize),
    /// The inverse mass matrix `M⁻¹`. [`InverseForm`] describes the outputs.
    Inverse(usize),
    /// Derivatives of forward dynamics. The outputs are the derivatives of the forces by `q` and `v`, or
    /// those columns of the derivatives of the accelerations that are already computed, followed by the
    /// outputs of `Inverse` and the accelerations. The latter are returned if the derivatives are written to
    /// matrix arguments.
    Forward(usize),
    /// A linear system in `q` and `v` with inputs. The outputs are derivatives of forces, the full inverse,
    /// the derivatives by the inputs, and the matrix `T` in the rate `ξ̇ = δv + T ξ` of displacements `ξ`.
    Linear(usize, usize),
    /// Accelerations, with `M⁻¹` written to a matrix argument. The outputs are the accelerations, or `M`
    /// times the accelerations if the inverse is factored, followed by the outputs of `Inverse`.
    Accelerated(usize),
    /// Derivatives of forward dynamics that call other functions. The outputs are the columns that are
    /// already computed.
    ForwardDerivativesByCalls(usize),
    /// A linear system assembled from the derivatives of forward dynamics. The outputs are the forces of the
    /// inputs, their derivatives by `q`, `v` and the inputs, and the matrix `T` in the rate `ξ̇ = δv + T ξ`
    /// of displacements `ξ`.
    CalledLinear(usize, usize),
    /// A plain array as result, with its length.
    Array(usize),
    /// A struct of the runtime as result.
    Record(Record),
    /// A symmetric matrix written to a matrix argument, with its number of rows. Each output is written to
    /// both sides of the diagonal.
    Symmetric(usize),
}

impl Shape {
    /// Returns name, rows and columns of the arrays that a function writes outside of Rust; none for a single
    /// number and for results of hidden functions.
    pub fn result_arrays(self) -> Vec<(&'static str, usize, usize)> {
        match self {
            Shape::Record(Record::InputDerivatives(n, m)) => {
                vec![("by_q", n, n), ("by_v", n, n), ("by_u", n, m)]
            }
            Shape::Record(record @ Record::MotionDerivatives(..)) => record
                .record_fields()
                .into_iter()
                .map(|field| (field.name, field.rows, field.columns.unwrap_or(1)))
                .collect(),
            Shape::Scalar | Shape::Record(_) | Shape::Symmetric(_) => Vec::new(),
            Shape::Vector(n) | Shape::Array(n) => vec![("result", n, 1)],
            Shape::Square(n) | Shape::Inverse(n) => vec![("result", n, n)],
            Shape::Matrix(m, n) => vec![("result", m, n)],
            Shape::Pair(n) => vec![("by_q", n, n), ("by_v", n, n)],
            Shape::Forward(n) | Shape::ForwardDerivativesByCalls(n) => {
                vec![("by_q", n, n), ("by_v", n, n), ("by_tau", n, n)]
            }
            Shape::Linear(n, m) | Shape::CalledLinear(n, m) => {
                vec![("by_state", 2 * n, 2 * n), ("by_input", 2 * n, m)]
            }
            Shape::Jacobians(rows, n, m) => {
                vec![("by_q", rows, n), ("by_v", rows, n), ("by_a", rows, n), ("by_u", rows, m)]
            }
            Shape::Hessian(n) => vec![("by_qq", n, n), ("by_qv", n, n), ("by_vv", n, n), ("by_qa", n, n)],
            Shape::InputPowerHessian(n, m) => vec![
                ("by_qq", n, n),
                ("by_qv", n, n),
                ("by_vv", n, n),
                ("by_qu", n, m),
                ("by_vu", n, m),
                ("by_uu", m, m),
            ],
            Shape::Accelerated(n) => vec![("result", n, 1), ("inverse", n, n)],
        }
    }

    /// Returns true for a result that is assembled from results of other functions.
    pub fn is_assembled_from_calls(self) -> bool {
        matches!(self, Shape::ForwardDerivativesByCalls(_) | Shape::CalledLinear(..))
    }

    /// Returns the number of outputs of a program for this result.
    pub fn output_count(self, structure: &MatrixStructure) -> usize {
        let border_entry_count = |n: usize| n * structure.inverse.extra_values_per_velocity();
        match self {
            Shape::Scalar => 1,
            Shape::Vector(n) | Shape::Array(n) => n,
            Shape::Square(n) => n * n,
            Shape::Matrix(m, n) => m * n,
            Shape::Pair(n) => 2 * n * n,
            Shape::Hessian(n) => 4 * n * n,
            Shape::Jacobians(rows, n, m) => rows * (3 * n + m),
            Shape::InputPowerHessian(n, m) => 3 * n * n + 2 * n * m + m * m,
            Shape::Inverse(n) => n * n + border_entry_count(n),
            Shape::Forward(n) => 3 * n * n + border_entry_count(n) + n,
            Shape::Linear(n, m) => 4 * n * n + n * m,
            Shape::Accelerated(n) => n + n * n + border_entry_count(n),
            Shape::ForwardDerivativesByCalls(n) => n * structure.known.iter().map(Vec::len).sum::<usize>(),
            Shape::CalledLinear(n, m) => n + 3 * n * n + n * m,
            Shape::Symmetric(_) => structure.entries.len(),
            Shape::Record(record) => record.record_fields().iter().map(|field| field.field_length()).sum(),
        }
    }
}

/// A struct of the runtime that a generated function returns. The outputs are its fields in order. The sizes
/// in each variant are given in its description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record {
    /// Result of the elimination of constraints. Sizes: velocities, constraints.
    Elimination(usize, usize),
    /// Quantities from which the runtime solves for accelerations and multipliers of redundant constraints.
    /// Sizes: velocities, constraints.
    Responses(usize, usize),
    /// Derivatives at given accelerations and multipliers. Sizes: velocities, constraints.
    MotionDerivatives(usize, usize),
    /// Forces of the inputs and their derivatives. Sizes: velocities, inputs.
    InputDerivatives(usize, usize),
    /// Derivatives of the generalized forces `Gᵀ f` of given contact forces, of the contact accelerations `G
    /// a + b` at given accelerations, and of the contact velocities. Sizes: velocities, contact velocities.
    ContactDerivatives(usize, usize),
    /// Second derivatives of the constraint terms of the equations, contracted with given factors. Sizes:
    /// velocities, constraints.
    ConstraintCurvature(usize, usize),
}

/// A field of a record: an array, or a list of arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordField {
    /// Name of the field of the runtime's struct.
    pub name: &'static str,
    /// Length of each array in the field.
    pub rows: usize,
    /// Number of arrays in a list, `None` for a single array.
    pub columns: Option<usize>,
}

impl RecordField {
    /// Returns the number of values that the field contains.
    pub fn field_length(&self) -> usize {
        self.rows * self.columns.unwrap_or(1)
    }
}

impl Record {
    /// Returns the name of the struct and its two sizes.
    pub fn struct_name_and_sizes(self) -> (&'static str, [usize; 2]) {
        match self {
            Record::Elimination(nv, nc) => ("Elimination", [nv, nc]),
            Record::Responses(nv, nc) => ("Responses", [nv, nc]),
            Record::MotionDerivatives(nv, nc) => ("MotionDerivatives", [nv, nc]),
            Record::InputDerivatives(nv, nu) => ("InputDerivatives", [nv, nu]),
            Record::ContactDerivatives(nv, nr) => ("ContactDerivatives", [nv, nr]),
            Record::ConstraintCurvature(nv, nc) => ("ConstraintCurvature", [nv, nc]),
        }
    }

    /// Returns the fields of the runtime's struct, in the order of the program's outputs.
    pub fn record_fields(self) -> Vec<RecordField> {
        let vector_record_field = |name, rows| RecordField { name, rows, columns: None };
        let matrix_record_field = |name, rows, columns| RecordField { name, rows, columns: Some(columns) };
        match self {
            Record::Elimination(nv, nc) => vec![
                vector_record_field("accelerations", nv),
                vector_record_field("multipliers", nc),
                vector_record_field("pivots", nc),
                vector_record_field("before", nc),
            ],
            Record::Responses(nv, nc) => {
                vec![
                    vector_record_field("free", nv),
                    vector_record_field("lacking", nc),
                    matrix_record_field("gram", nc, nc),
                    matrix_record_field("given", nv, nc),
                ]
            }
            Record::MotionDerivatives(nv, nc) => vec![
                matrix_record_field("forces_by_q", nv, nv),
                matrix_record_field("forces_by_v", nv, nv),
                matrix_record_field("bias_by_q", nc, nv),
                matrix_record_field("bias_by_v", nc, nv),
                matrix_record_field("rates_by_q", nc, nv),
                matrix_record_field("turning", nv, nv),
            ],
            Record::InputDerivatives(nv, nu) => {
                vec![
                    vector_record_field("forces", nv),
                    matrix_record_field("by_q", nv, nv),
                    matrix_record_field("by_v", nv, nv),
                    matrix_record_field("by_u", nv, nu),
                ]
            }
            Record::ContactDerivatives(nv, nr) => vec![
                matrix_record_field("forces_by_q", nv, nv),
                matrix_record_field("accelerations_by_q", nr, nv),
                matrix_record_field("accelerations_by_v", nr, nv),
                matrix_record_field("rates_by_q", nr, nv),
            ],
            Record::ConstraintCurvature(nv, nc) => {
                let [qq, qv, vv, qa] = ["qq", "qv", "vv", "qa"].map(|name| matrix_record_field(name, nv, nv));
                vec![qq, qv, vv, qa, matrix_record_field("q_lambda", nv, nc)]
            }
        }
    }
}

/// Representation of the inverse mass matrix by the outputs of a program.
#[derive(Clone, Debug, Default)]
pub enum InverseForm {
    /// Inverse mass matrix whose columns are outputs of the program.
    #[default]
    Explicit,
    /// Columns, followed by a row of factors for each velocity, in the order of the given trunk velocities.
    /// The product of these factors with the columns of the trunk velocities is added to the columns.
    LowRankUpdate(Vec<usize>),
    /// Columns, of which those of limbs are the inverses of their blocks, followed by a row for each
    /// velocity: its entries of the mass matrix in the rows of the trunk.
    BlockArrow {
        /// Velocities of the trunk, in the order of the entries.
        trunk: Vec<usize>,
        /// Indices of the velocities of each limb, in order.
        limbs: Vec<Vec<usize>>,
    },
}

impl InverseForm {
    /// Returns the number of values per velocity that the outputs contain in addition to the columns of the
    /// inverse: one for each velocity of the trunk.
    fn extra_values_per_velocity(&self) -> usize {
        match self {
            InverseForm::Explicit => 0,
            InverseForm::LowRankUpdate(trunk) | InverseForm::BlockArrow { trunk, .. } => trunk.len(),
        }
    }
}

/// Structure of the matrices that a generated function returns.
#[derive(Clone, Debug, Default)]
pub struct MatrixStructure {
    /// Form in which the inverse mass matrix is returned.
    pub inverse: InverseForm,
    /// Row and column of the outputs that are entries of a matrix, none of them above the diagonal.
    pub entries: Vec<(usize, usize)>,
    /// For each entry of `∂τ/∂q` and then of `∂τ/∂v`, column by column: whether it is structurally zero.
    /// Empty if unknown.
    pub zeros: Vec<bool>,
    /// Columns of `∂v̇/∂q` and of `∂v̇/∂v` that are outputs themselves, instead of columns of derivatives of
    /// forces.
    pub known: [Vec<usize>; 2],
}
