//! Signatures of generated functions: arguments, and the type of the result by its shape. The module
//! `matrices` composes the results.

use super::scalar::ScalarSpelling;
use crate::catalogue::{Argument, GeneratedId, Shape};
use crate::derive::Function;
use crate::machine::FILLING_INSTRUCTIONS;
use std::fmt::Write;

/// Returns the names of the matrix arguments to which a function writes its results.
pub fn result_matrix_names(f: &Function) -> Vec<&'static str> {
    let matrix_argument_name =
        |a: &Argument| if let Argument::Into(name, _) = a { Some(*name) } else { None };
    f.arguments.iter().filter_map(matrix_argument_name).collect()
}

/// Returns the number of matrix arguments of the variant that the body of `f` calls, or `None` if `f` has a
/// body of its own. The call avoids two copies of a long body, which rustc would have to process.
pub fn variant_matrix_argument_count(f: &Function) -> Option<usize> {
    let has_variant = f.id == GeneratedId::InverseDynamicsDerivatives;
    match f.shape {
        _ if !result_matrix_names(f).is_empty() => None,
        Shape::ForwardDerivativesByCalls(_) => Some(3),
        Shape::Pair(_) if has_variant && f.loops.is_some() => Some(2),
        Shape::Pair(_) if has_variant && f.program.instructions.len() >= FILLING_INSTRUCTIONS => Some(2),
        _ => None,
    }
}

/// Dimensions and names that occur in the signatures of a mechanism.
#[derive(Clone, Copy)]
pub struct SignatureContext<'a> {
    /// Spelling of scalar types and operations.
    pub scalar: &'a ScalarSpelling,
    /// Number of coordinates, `NQ`.
    pub nq: usize,
    /// Number of velocities, `NV`.
    pub nv: usize,
    /// Number of inputs, `NU`.
    pub nu: usize,
    /// True if functions take time as their first argument.
    pub time: bool,
}

impl SignatureContext<'_> {
    /// Returns the Rust type of a function's result.
    pub fn result_type(&self, f: &Function) -> String {
        match f.shape {
            Shape::Accelerated(n) => self.vector_type(n),
            Shape::Forward(n) | Shape::ForwardDerivativesByCalls(n) if !result_matrix_names(f).is_empty() => {
                self.vector_type(n)
            }
            shape if result_matrix_names(f).is_empty() => self.shape_type(shape),
            _ => "()".to_string(),
        }
    }

    /// Returns the Rust type of a function argument.
    pub fn argument_type(&self, a: Argument) -> String {
        let n = match a {
            Argument::T => return self.scalar.scalar_name().to_string(),
            Argument::Q => self.nq,
            Argument::V | Argument::A | Argument::Tau => self.nv,
            Argument::U => self.nu,
            Argument::Standard(n) | Argument::Factors(n) | Argument::Momenta(n) => n,
            Argument::Given(_, _, count) => return format!("&[{}; {count}]", self.scalar.scalar_name()),
            Argument::Into(_, n) => return format!("&mut {}", self.shape_type(Shape::Square(n))),
            Argument::Called(_) => return String::new(),
        };
        format!("&{}", self.vector_type(n))
    }

    /// Returns the Rust type of a column vector with `n` entries.
    pub fn vector_type(&self, n: usize) -> String {
        format!("::linkwork::nalgebra::SVector<{}, {n}>", self.scalar.scalar_name())
    }

    /// Returns the Rust type of a result of this shape.
    pub fn shape_type(&self, shape: Shape) -> String {
        let s = self.scalar.scalar_name();
        match shape {
            Shape::Scalar => s.to_string(),
            Shape::Vector(n) => self.vector_type(n),
            Shape::Square(n) | Shape::Inverse(n) => {
                format!("::linkwork::nalgebra::SMatrix<{s}, {n}, {n}>")
            }
            Shape::Matrix(m, n) => format!("::linkwork::nalgebra::SMatrix<{s}, {m}, {n}>"),
            Shape::Array(n) => format!("[{s}; {n}]"),
            Shape::Record(record) => {
                let (name, [m, n]) = record.struct_name_and_sizes();
                format!("::linkwork::__private::{name}<{s}, {m}, {n}>")
            }
            Shape::Pair(_)
            | Shape::Hessian(_)
            | Shape::Jacobians(..)
            | Shape::InputPowerHessian(..)
            | Shape::Forward(_)
            | Shape::Linear(..)
            | Shape::Accelerated(_)
            | Shape::ForwardDerivativesByCalls(_)
            | Shape::CalledLinear(..)
            | Shape::Symmetric(_) => result_type_of_several_matrices(shape, self),
        }
    }

    /// Returns the arguments of a function, preceded by time if functions take time.
    pub fn with_time_argument(&self, arguments: &[Argument]) -> Vec<Argument> {
        self.time.then_some(Argument::T).into_iter().chain(arguments.iter().copied()).collect()
    }

    /// Returns the text after a function's name in its definition: for several states the suffix and the
    /// const parameter, otherwise nothing.
    pub fn lanes_suffix_and_generics(&self) -> &'static str {
        if self.scalar.uses_batch_lanes() { "_lanes<const LANES: usize>" } else { "" }
    }

    /// Returns the suffix of a function's name in calls.
    pub fn lane_function_suffix(&self) -> &'static str {
        if self.scalar.uses_batch_lanes() { "_lanes" } else { "" }
    }

    /// Returns the parameter list `&self, q: …, v: …`.
    pub fn parameter_list(&self, arguments: &[Argument]) -> String {
        let mut text = "&self".to_string();
        for a in arguments {
            let _ = write!(text, ", {}: {}", a.argument_name(), self.argument_type(*a));
        }
        text
    }
}

/// Returns the type of a result of several matrices.
fn result_type_of_several_matrices(shape: Shape, s: &SignatureContext<'_>) -> String {
    let square_matrix_type = |n| s.shape_type(Shape::Square(n));
    match shape {
        Shape::Pair(n) => format!("({0}, {0})", square_matrix_type(n)),
        Shape::Jacobians(rows, n, m) => {
            format!("::linkwork::OutputJacobians<{}, {rows}, {n}, {m}>", s.scalar.scalar_name())
        }
        Shape::Hessian(n) => format!("({0}, {0}, {0}, {0})", square_matrix_type(n)),
        Shape::InputPowerHessian(n, m) => {
            let mixed = s.shape_type(Shape::Matrix(n, m));
            format!("({0}, {0}, {0}, {mixed}, {mixed}, {1})", square_matrix_type(n), square_matrix_type(m))
        }
        Shape::Forward(n) | Shape::ForwardDerivativesByCalls(n) => {
            format!("({0}, {0}, {0})", square_matrix_type(n))
        }
        Shape::Accelerated(n) => s.vector_type(n),
        Shape::Linear(n, m) | Shape::CalledLinear(n, m) => {
            format!("({}, {})", square_matrix_type(2 * n), s.shape_type(Shape::Matrix(2 * n, m)))
        }
        _ => String::new(),
    }
}
