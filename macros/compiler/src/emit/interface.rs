//! Public interface of a mechanism, and the heads of generated implementations.

use super::constraints::Constraints;
use super::contacts::UnilateralContact;
use super::limits::CoordinateLimitIndices;
use super::polytopes::ContactPolytopes;
use super::signature::SignatureContext;
use super::validate::ParameterCondition;
use crate::catalogue::{Argument, Facts, Row};
use crate::mechanism::{FreeBodyDiagram, Units};
use crate::syntax::{GeneratedStruct, ScalarType};
use quote::ToTokens;

/// Names and types of the public interface of a mechanism.
pub struct Interface<'a> {
    /// Declaration of the mechanism's struct.
    pub shell: &'a GeneratedStruct,
    /// Scalar type of the mechanism.
    pub scalar: ScalarType,
    /// Name of every entry of `q`.
    pub configuration: Vec<String>,
    /// Name of every entry of `v`.
    pub velocities: Vec<String>,
    /// Name of every entry of `u`.
    pub inputs: Vec<String>,
    /// Names of the mechanism's named frames.
    pub frames: Vec<String>,
    /// Documentation lines of the joints, each with the bodies that the joint connects.
    pub structure: Vec<String>,
    /// Constraints of the mechanism, as data for code generation.
    pub constraints: Constraints,
    /// Unilateral contacts.
    pub contacts: Vec<UnilateralContact>,
    /// Polytopes whose features determine contacts.
    pub polytopes: ContactPolytopes,
    /// Limits of the coordinates.
    pub limits: Vec<CoordinateLimitIndices>,
    /// Conditions that values of the parameters must satisfy.
    pub figures: Vec<ParameterCondition>,
    /// States of first order, each with its index among the parameters.
    pub states: Vec<(String, usize)>,
    /// Names of the mechanism's outputs.
    pub outputs: Vec<String>,
    /// Free-body diagrams, with the names of their outputs.
    pub diagrams: Vec<(String, FreeBodyDiagram)>,
    /// Units of coordinates, inputs, outputs, constraints and parameters.
    pub units: Units,
    /// Paths of imported files, whose changes cause a new compilation of the crate.
    pub files: Vec<String>,
    /// Facts of the mechanism on which signatures depend.
    pub facts: Facts,
    /// True if large functions select their arithmetic at run time.
    pub detect: bool,
    /// Descriptions of rounded numbers of the file.
    pub snapped: &'a [String],
    /// Descriptions of elements of the file that are omitted from the mechanism.
    pub left_out: &'a [String],
    /// Functions and constants that the mechanism does not have, by reason.
    pub absent: Vec<AbsentFunctions>,
}

/// Functions and constants that a mechanism lacks for one reason.
#[derive(Clone, Debug)]
pub struct AbsentFunctions {
    /// Trait of the runtime whose error message explains the reason.
    pub reason: &'static str,
    /// Names of the generated functions.
    pub functions: Vec<String>,
    /// Names of the generated constants.
    pub constants: Vec<&'static str>,
}

/// Lint attributes of the generated implementations.
pub const ALLOW: &str = "#[automatically_derived]\n#[allow(unused, non_snake_case, clippy::all, \
                         clippy::pedantic, clippy::nursery, reason = \"generated code\")]\n";

/// Generics of the struct's implementations, as source text.
pub struct ImplGenerics {
    /// Generic parameters with their bounds: `<T: …>`.
    pub generics: String,
    /// Generic arguments: `<T>`.
    pub arguments: String,
    /// Bounds of the generic parameters: `where …`.
    pub bounds: String,
}

impl ImplGenerics {
    /// Returns the generics of the struct, with the bound of a generic scalar added.
    pub fn new(i: &Interface<'_>, s: &SignatureContext<'_>) -> ImplGenerics {
        let (impl_generics, ty_generics, where_clause) = i.shell.generics.split_for_impl();
        let spell_tokens = |tokens: &dyn ToTokens| tokens.to_token_stream().to_string();
        let mut bounds = spell_tokens(&where_clause);
        if s.scalar.is_generic() {
            let start = if bounds.is_empty() { "where" } else { bounds.trim_end().trim_end_matches(',') };
            let comma = if bounds.is_empty() { "" } else { "," };
            bounds = format!("{start}{comma} {}: ::linkwork::Real", s.scalar.single_lane_scalar_type());
        }
        ImplGenerics { generics: spell_tokens(&impl_generics), arguments: spell_tokens(&ty_generics), bounds }
    }
}

/// Returns the arguments of the trait function that the inherent function takes.
pub fn inherent_function_arguments(row: &Row, i: &Interface<'_>) -> Vec<Argument> {
    (row.declare)(&i.facts).arguments
}
