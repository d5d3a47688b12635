//! Arguments and results.

use crate::mechanism::Quantity;

/// The argument that has the forces at all contacts.
pub const CONTACT_FORCES: &str = "forces";

/// An argument of a generated function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// Time `t`.
    T,
    /// Configuration `q`.
    Q,
    /// Velocity `v`.
    V,
    /// Acceleration `a`.
    A,
    /// Generalized force `tau`.
    Tau,
    /// Inputs `u`.
    U,
    /// Given numbers: name of the argument, index of the first, how many.
    Given(&'static str, usize, usize),
    /// Parameters of mass properties, so many given numbers in a vector.
    Standard(usize),
    /// A square matrix of so many rows that a result goes into.
    Into(&'static str, usize),
    /// Factors `lambda`, one for each velocity, by which forces or accelerations are multiplied.
    Factors(usize),
    /// Generalized momenta `p`, one for each velocity.
    Momenta(usize),
    /// The results of another function, which a body calls: in no signature.
    Called(Called),
}

/// A function of configuration and velocity whose results bodies of others begin with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Called {
    /// The one for passive forces.
    PassiveForces,
    /// The one for their derivatives.
    PassiveDerivatives,
}

impl Called {
    /// All of them.
    pub const ALL: [Called; 2] = [Called::PassiveForces, Called::PassiveDerivatives];

    /// The function's name.
    pub const fn function(self) -> &'static str {
        match self {
            Called::PassiveForces => "__passive_forces",
            Called::PassiveDerivatives => "__passive_derivatives",
        }
    }
}

impl Argument {
    /// The name in the signature.
    pub fn name(self) -> &'static str {
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
            Argument::Called(Called::PassiveForces) => "passive",
            Argument::Called(Called::PassiveDerivatives) => "change",
        }
    }

    /// The index in it of what a symbol stands for.
    pub fn index(self, quantity: Quantity) -> Option<usize> {
        match (self, quantity) {
            (Argument::Q, Quantity::Configuration(k))
            | (Argument::V, Quantity::Velocity(k))
            | (Argument::A, Quantity::Acceleration(k))
            | (Argument::Tau, Quantity::Force(k))
            | (Argument::U, Quantity::Input(k)) => Some(k),
            (Argument::Given(_, first, count), Quantity::Given(k)) if (first..first + count).contains(&k) => {
                Some(k - first)
            }
            (Argument::Given(name, ..), Quantity::ContactForce(k)) if name == CONTACT_FORCES => Some(k),
            (Argument::Standard(_) | Argument::Factors(_) | Argument::Momenta(_), Quantity::Given(k))
            | (Argument::Called(Called::PassiveForces), Quantity::PassiveForce(k))
            | (Argument::Called(Called::PassiveDerivatives), Quantity::PassiveDerivative(k)) => Some(k),
            _ => None,
        }
    }
}

/// The result of a generated function, and how it is put together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shape {
    /// A number.
    #[default]
    Scalar,
    /// A column vector.
    Vector(usize),
    /// A square matrix; the outputs are its columns one after another.
    Square(usize),
    /// A matrix; the outputs are its columns one after another.
    Matrix(usize, usize),
    /// Two square matrices.
    Pair(usize),
    /// Second derivatives by configuration twice, configuration and velocity, velocity twice, and configuration and acceleration:
    /// four square matrices.
    Hessian(usize),
    /// Second derivatives of forces of inputs by configuration twice, configuration and velocity, velocity twice, configuration
    /// and input, velocity and input, input twice.
    InputHessian(usize, usize),
    /// Derivatives of an output of so many rows by configuration, velocity, acceleration and input.
    Jacobians(usize, usize, usize),
    /// `M⁻¹`. The outputs are what [`InverseForm`] says.
    Inverse(usize),
    /// Derivatives of forward dynamics; the outputs are those of the forces by `q` and `v`, or what is known of the derivatives
    /// themselves, those of `Inverse`, and the accelerations, which are returned where the derivatives go into given matrices.
    Forward(usize),
    /// A linear system in `q` and `v` with inputs; after derivatives of forces and the whole inverse come the derivatives by the
    /// inputs, and what turns displacements.
    Linear(usize, usize),
    /// Accelerations, with `M⁻¹` into a given matrix; the outputs are the accelerations, or `M` times them
    /// where the inverse is divided, and those of `Inverse`.
    Accelerated(usize),
    /// Derivatives of forward dynamics by calls of other functions; the outputs are the columns that are known.
    CalledForward(usize),
    /// A linear system from the derivatives of forward dynamics; the outputs are the forces of the inputs, their
    /// derivatives by `q`, `v` and the inputs, and what turns displacements.
    CalledLinear(usize, usize),
    /// A plain array.
    Array(usize),
    /// A struct of the runtime.
    Record(Record),
    /// A square matrix of so many rows that is given: the outputs go to both sides of its diagonal.
    Symmetric(usize),
}

impl Shape {
    /// True for what is composed of other functions' results.
    pub fn calls(self) -> bool {
        matches!(self, Shape::CalledForward(_) | Shape::CalledLinear(..))
    }

    /// How many outputs a program must have for this result.
    pub fn outputs(self, structure: &Structure) -> usize {
        let parts = |n: usize| n * structure.inverse.width();
        match self {
            Shape::Scalar => 1,
            Shape::Vector(n) | Shape::Array(n) => n,
            Shape::Square(n) => n * n,
            Shape::Matrix(m, n) => m * n,
            Shape::Pair(n) => 2 * n * n,
            Shape::Hessian(n) => 4 * n * n,
            Shape::Jacobians(rows, n, m) => rows * (3 * n + m),
            Shape::InputHessian(n, m) => 3 * n * n + 2 * n * m + m * m,
            Shape::Inverse(n) => n * n + parts(n),
            Shape::Forward(n) => 3 * n * n + parts(n) + n,
            Shape::Linear(n, m) => 4 * n * n + n * m,
            Shape::Accelerated(n) => n + n * n + parts(n),
            Shape::CalledForward(n) => n * structure.known.iter().map(Vec::len).sum::<usize>(),
            Shape::CalledLinear(n, m) => n + 3 * n * n + n * m,
            Shape::Symmetric(_) => structure.entries.len(),
            Shape::Record(record) => record.fields().iter().map(|field| field.length()).sum(),
        }
    }
}

/// What generated functions hand to the runtime: a struct of the runtime, whose fields are the outputs in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record {
    /// What elimination finds, of so many velocities and constraints.
    Elimination(usize, usize),
    /// What accelerations and multipliers follow from where constraints are redundant, of so many velocities and constraints.
    Responses(usize, usize),
    /// Derivatives at given accelerations and multipliers, of so many velocities and constraints.
    MotionDerivatives(usize, usize),
    /// Forces of the inputs and their derivatives, of so many velocities and inputs.
    InputDerivatives(usize, usize),
    /// Derivatives of what contacts do at given accelerations and forces, of so many velocities and rates.
    ContactDerivatives(usize, usize),
    /// Second derivatives of what constraints add to the equations, contracted, of so many velocities and constraints.
    ConstraintCurvature(usize, usize),
}

/// A field of a record: an array, or a list of so many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordField {
    /// Its name.
    pub name: &'static str,
    /// Length of an array.
    pub rows: usize,
    /// How many there are, of a list.
    pub columns: Option<usize>,
}

impl RecordField {
    /// How many numbers it holds.
    pub fn length(&self) -> usize {
        self.rows * self.columns.unwrap_or(1)
    }
}

impl Record {
    /// The struct's name, and its two sizes.
    pub fn name(self) -> (&'static str, [usize; 2]) {
        match self {
            Record::Elimination(nv, nc) => ("Elimination", [nv, nc]),
            Record::Responses(nv, nc) => ("Responses", [nv, nc]),
            Record::MotionDerivatives(nv, nc) => ("MotionDerivatives", [nv, nc]),
            Record::InputDerivatives(nv, nu) => ("InputDerivatives", [nv, nu]),
            Record::ContactDerivatives(nv, nr) => ("ContactDerivatives", [nv, nr]),
            Record::ConstraintCurvature(nv, nc) => ("ConstraintCurvature", [nv, nc]),
        }
    }

    /// The fields in the order of the outputs.
    pub fn fields(self) -> Vec<RecordField> {
        let array = |name, rows| RecordField { name, rows, columns: None };
        let list = |name, rows, columns| RecordField { name, rows, columns: Some(columns) };
        match self {
            Record::Elimination(nv, nc) => vec![
                array("accelerations", nv),
                array("multipliers", nc),
                array("pivots", nc),
                array("before", nc),
            ],
            Record::Responses(nv, nc) => {
                vec![array("free", nv), array("lacking", nc), list("gram", nc, nc), list("given", nv, nc)]
            }
            Record::MotionDerivatives(nv, nc) => vec![
                list("forces_by_q", nv, nv),
                list("forces_by_v", nv, nv),
                list("bias_by_q", nc, nv),
                list("bias_by_v", nc, nv),
                list("rates_by_q", nc, nv),
                list("turning", nv, nv),
            ],
            Record::InputDerivatives(nv, nu) => {
                vec![array("forces", nv), list("by_q", nv, nv), list("by_v", nv, nv), list("by_u", nv, nu)]
            }
            Record::ContactDerivatives(nv, nr) => vec![
                list("forces_by_q", nv, nv),
                list("accelerations_by_q", nr, nv),
                list("accelerations_by_v", nr, nv),
                list("rates_by_q", nr, nv),
            ],
            Record::ConstraintCurvature(nv, nc) => {
                let [qq, qv, vv, qa] = ["qq", "qv", "vv", "qa"].map(|name| list(name, nv, nv));
                vec![qq, qv, vv, qa, list("q_lambda", nv, nc)]
            }
        }
    }
}

/// How the outputs make the inverse of a mass matrix.
#[derive(Clone, Debug, Default)]
pub enum InverseForm {
    /// They are its columns.
    #[default]
    Explicit,
    /// After the columns comes for each velocity a row of factors, in the order of these velocities of the trunk, whose product
    /// with their columns is added.
    LowRankUpdate(Vec<usize>),
    /// After columns, of which those of limbs are the inverses of their blocks, comes for each velocity a row with its entries of
    /// the mass matrix in the rows of the trunk.
    BlockArrow {
        /// Velocities of the trunk, in the order of the entries.
        trunk: Vec<usize>,
        /// Velocities of each limb, in their order.
        limbs: Vec<Vec<usize>>,
    },
}

impl InverseForm {
    /// How many numbers come for each velocity after the columns.
    fn width(&self) -> usize {
        match self {
            InverseForm::Explicit => 0,
            InverseForm::LowRankUpdate(trunk) | InverseForm::BlockArrow { trunk, .. } => trunk.len(),
        }
    }
}

/// What is known of the matrices of a function.
#[derive(Clone, Debug, Default)]
pub struct Structure {
    /// In which parts the inverse of the mass matrix is.
    pub inverse: InverseForm,
    /// Row and column of the outputs that go into a matrix, none of them above its diagonal.
    pub entries: Vec<(usize, usize)>,
    /// By entry of `∂τ/∂q`, then of `∂τ/∂v`, column by column: whether it is always zero. Empty if nothing is known.
    pub zeros: Vec<bool>,
    /// The columns of `∂v̇/∂q` and of `∂v̇/∂v` that are outputs themselves, not those of forces.
    pub known: [Vec<usize>; 2],
}
