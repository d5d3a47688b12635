//! A generated function: its arguments, its result, and what it computes.

use super::body::{Build, write_body};
use super::matrices;
use super::scalar::ScalarSpelling;
use crate::lower::Program;
use crate::model::Quantity;
use std::fmt::Write;

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
        }
    }

    /// The index in this argument of what a symbol stands for.
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
            (Argument::Standard(_), Quantity::Given(k)) => Some(k),
            _ => None,
        }
    }
}

/// The result of a generated function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A number.
    Scalar,
    /// A column vector.
    Vector(usize),
    /// A square matrix; the outputs are its columns one after another.
    Square(usize),
    /// A matrix; the outputs are its columns one after another.
    Matrix(usize, usize),
    /// Two square matrices.
    Pair(usize),
    /// `M⁻¹`. The outputs are what [`Parted`] says.
    Inverse(usize),
    /// Derivatives of forward dynamics; the outputs are those of the forces by `q` and `v`, or what is known of the derivatives
    /// themselves, and those of `Inverse`.
    Forward(usize),
    /// A linear system in `q` and `v` with inputs; after the outputs of `Forward` come the derivatives by the inputs, and
    /// what turns displacements.
    Linear(usize, usize),
    /// Accelerations, with `M⁻¹` into a given matrix; the outputs are the accelerations, or `M` times them
    /// where the inverse is divided, and those of `Inverse`.
    Accelerated(usize),
    /// The same as `Forward`, by calls of other functions; the outputs are the columns that are known.
    CalledForward(usize),
    /// The same as `Linear`, from the derivatives of forward dynamics; the outputs are the forces of the inputs, their
    /// derivatives by `q`, `v` and the inputs, and what turns displacements.
    CalledLinear(usize, usize),
    /// A plain array.
    Array(usize),
    /// A square matrix of so many rows that is given: the outputs go to both sides of its diagonal.
    Symmetric(usize),
}

impl Shape {
    /// True for what is composed of other functions' results.
    pub fn calls(self) -> bool {
        matches!(self, Shape::CalledForward(_) | Shape::CalledLinear(..))
    }
}

/// A generated function.
pub struct Function {
    /// Its name.
    pub name: String,
    /// Documentation, a paragraph each; none for a hidden function.
    pub docs: Vec<String>,
    /// Arguments after `&self`.
    pub arguments: Vec<Argument>,
    /// Result.
    pub shape: Shape,
    /// What it computes.
    pub program: Program,
    /// What is known of its matrices.
    pub structure: Structure,
}

/// How the outputs make the inverse of a mass matrix.
#[derive(Clone, Debug, Default)]
pub enum Parted {
    /// They are its columns.
    #[default]
    Whole,
    /// After the columns comes for each velocity a row of factors, in the order of these velocities of the trunk, whose product
    /// with their columns is added.
    Trunk(Vec<usize>),
    /// After columns, of which those of limbs are the inverses of their blocks, comes for each velocity a row with its entries of
    /// the mass matrix in the rows of the trunk.
    Divided {
        /// Velocities of the trunk, in the order of the entries.
        trunk: Vec<usize>,
        /// Those of each limb, in their order.
        limbs: Vec<Vec<usize>>,
    },
}

/// What is known of the matrices of a function.
#[derive(Clone, Debug, Default)]
pub struct Structure {
    /// In which parts the inverse of the mass matrix is.
    pub inverse: Parted,
    /// Row and column of the outputs that go into a matrix, none of them above its diagonal.
    pub entries: Vec<(usize, usize)>,
    /// By entry of `∂τ/∂q`, then of `∂τ/∂v`, column by column: whether it is always zero. Empty if nothing is known.
    pub zeros: Vec<bool>,
    /// The columns of `∂v̇/∂q` and of `∂v̇/∂v` that are outputs themselves, not those of forces.
    pub known: [Vec<usize>; 2],
}

impl Function {
    /// The names of the matrices that results go into.
    pub fn given(&self) -> Vec<&'static str> {
        let given = |a: &Argument| if let Argument::Into(name, _) = a { Some(*name) } else { None };
        self.arguments.iter().filter_map(given).collect()
    }

    /// The type of what is returned.
    pub fn result(&self, s: &Signature<'_>) -> String {
        match self.shape {
            Shape::Accelerated(n) => s.vector(n),
            shape if self.given().is_empty() => s.shape(shape),
            _ => "()".to_string(),
        }
    }

    /// A hidden function without arguments that does nothing yet.
    pub fn new(shape: Shape) -> Function {
        Function {
            name: String::new(),
            docs: Vec::new(),
            arguments: Vec::new(),
            shape,
            program: Program::default(),
            structure: Structure::default(),
        }
    }
}

/// Dimensions and names that signatures need.
#[derive(Clone, Copy)]
pub struct Signature<'a> {
    /// Spelling of scalars.
    pub scalar: &'a ScalarSpelling,
    /// `NQ`.
    pub nq: usize,
    /// `NV`.
    pub nv: usize,
    /// `NU`.
    pub nu: usize,
    /// Functions take time first.
    pub time: bool,
}

impl Signature<'_> {
    /// The type of an argument.
    pub fn argument(&self, a: Argument) -> String {
        let n = match a {
            Argument::T => return self.scalar.name().to_string(),
            Argument::Q => self.nq,
            Argument::V | Argument::A | Argument::Tau => self.nv,
            Argument::U => self.nu,
            Argument::Standard(n) => n,
            Argument::Given(_, _, count) => return format!("&[{}; {count}]", self.scalar.name()),
            Argument::Into(_, n) => return format!("&mut {}", self.shape(Shape::Square(n))),
        };
        format!("&{}", self.vector(n))
    }

    /// A column vector's type.
    pub fn vector(&self, n: usize) -> String {
        format!("::linkwork::nalgebra::SVector<{}, {n}>", self.scalar.name())
    }

    /// A result's type.
    pub fn shape(&self, shape: Shape) -> String {
        let s = self.scalar.name();
        match shape {
            Shape::Scalar => s.to_string(),
            Shape::Vector(n) => self.vector(n),
            Shape::Square(n) | Shape::Inverse(n) => {
                format!("::linkwork::nalgebra::SMatrix<{s}, {n}, {n}>")
            }
            Shape::Matrix(m, n) => format!("::linkwork::nalgebra::SMatrix<{s}, {m}, {n}>"),
            Shape::Array(n) => format!("[{s}; {n}]"),
            Shape::Symmetric(_) => "()".to_string(),
            Shape::Pair(_)
            | Shape::Forward(_)
            | Shape::Linear(..)
            | Shape::Accelerated(_)
            | Shape::CalledForward(_)
            | Shape::CalledLinear(..) => matrices::several(shape, self),
        }
    }

    /// The arguments with time before them, where functions take it.
    pub fn timed(&self, arguments: &[Argument]) -> Vec<Argument> {
        self.time.then_some(Argument::T).into_iter().chain(arguments.iter().copied()).collect()
    }

    /// What stands after a function's name: nothing, or what tells it from the one of a single state.
    pub fn generics(&self) -> &'static str {
        if self.scalar.is_in_lanes() { "_lanes<const LANES: usize>" } else { "" }
    }

    /// What stands after a function's name where it is called.
    pub fn suffix(&self) -> &'static str {
        if self.scalar.is_in_lanes() { "_lanes" } else { "" }
    }

    /// `&self, q: …, v: …`.
    pub fn parameters(&self, arguments: &[Argument]) -> String {
        let mut text = "&self".to_string();
        for a in arguments {
            let _ = write!(text, ", {}: {}", a.name(), self.argument(*a));
        }
        text
    }
}

/// Writes what stands before a function's body, with the brace.
pub fn write_head(out: &mut String, f: &Function, s: &Signature<'_>) {
    if f.docs.is_empty() {
        out.push_str("#[doc(hidden)]\n");
    }
    if !f.docs.is_empty() {
        let _ = writeln!(out, "#[doc = {:?}]", format!(" {}", f.docs.join("\n\n ")));
    }
    let result = f.result(s);
    let must_use = if result == "()" { "" } else { "#[must_use]\n" };
    let _ = writeln!(
        out,
        "#[inline]\n{must_use}pub fn {}{}({}) -> {result} {{",
        f.name,
        s.generics(),
        s.parameters(&f.arguments),
    );
}

/// Writes a function; without a program its body never returns, for a mechanism that failed to compile.
pub fn write_function(out: &mut String, f: &Function, s: &Signature<'_>, stub: bool) {
    write_head(out, f, s);
    if stub {
        out.push_str("loop {}\n");
    } else {
        write_body(out, f, s, false, Build::Optimised);
    }
    out.push_str("}\n");
}
