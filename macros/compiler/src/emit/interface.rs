//! What the outside sees of a mechanism, and what stands around generated implementations.

use super::constraints::Constraints;
use super::contacts::Touching;
use super::limits::Limited;
use super::signature::Signature;
use super::validate::Figure;
use crate::catalogue::{Argument, Facts, Row};
use crate::mechanism::{Diagram, Units};
use crate::syntax::{ScalarType, Shell};
use quote::ToTokens;

/// Names and types that the outside sees.
pub struct Interface<'a> {
    /// The struct.
    pub shell: &'a Shell,
    /// Its scalar type.
    pub scalar: ScalarType,
    /// Name of every entry of `q`.
    pub configuration: Vec<String>,
    /// Name of every entry of `v`.
    pub velocities: Vec<String>,
    /// Name of every entry of `u`.
    pub inputs: Vec<String>,
    /// Names of the frames.
    pub frames: Vec<String>,
    /// One line for each joint: what it joins.
    pub structure: Vec<String>,
    /// The constraints.
    pub constraints: Constraints,
    /// Contacts that open and close.
    pub contacts: Vec<Touching>,
    /// The limits of coordinates.
    pub limits: Vec<Limited>,
    /// What figures that follow from parameters fulfil.
    pub figures: Vec<Figure>,
    /// States of first order, each with its index among the parameters.
    pub states: Vec<(String, usize)>,
    /// Names of the outputs.
    pub outputs: Vec<String>,
    /// The free-body diagrams among them.
    pub diagrams: Vec<(String, Diagram)>,
    /// Units of all of these and of the parameters.
    pub units: Units,
    /// The files that were read: when one changes, the crate is compiled again.
    pub files: Vec<String>,
    /// What signatures depend on.
    pub facts: Facts,
    /// Large functions choose their arithmetic at run time.
    pub detect: bool,
    /// Numbers of the file that were rounded.
    pub snapped: &'a [String],
    /// What is in the file and not in the mechanism.
    pub left_out: &'a [String],
    /// What the mechanism does not have, and why.
    pub absent: Vec<Absent>,
}

/// Functions and constants that are not there, all for one reason.
#[derive(Clone, Debug)]
pub struct Absent {
    /// The trait of the runtime that says why.
    pub reason: &'static str,
    /// Names of the functions.
    pub functions: Vec<String>,
    /// Names of the constants.
    pub constants: Vec<&'static str>,
}

/// What stands before generated implementations.
pub const ALLOW: &str = "#[automatically_derived]\n#[allow(unused, non_snake_case, clippy::all, clippy::pedantic, clippy::nursery, reason = \"generated code\")]\n";

/// Generics of the struct's implementations as text.
pub struct Head {
    /// `<T: …>`
    pub generics: String,
    /// `<T>`
    pub arguments: String,
    /// `where …`
    pub bounds: String,
}

impl Head {
    /// Those of the struct, with the scalar's own bound.
    pub fn new(i: &Interface<'_>, s: &Signature<'_>) -> Head {
        let (impl_generics, ty_generics, where_clause) = i.shell.generics.split_for_impl();
        let spell = |tokens: &dyn ToTokens| tokens.to_token_stream().to_string();
        let mut bounds = spell(&where_clause);
        if s.scalar.is_generic() {
            let start = if bounds.is_empty() { "where" } else { bounds.trim_end().trim_end_matches(',') };
            let comma = if bounds.is_empty() { "" } else { "," };
            bounds = format!("{start}{comma} {}: ::linkwork::Real", s.scalar.one());
        }
        Head { generics: spell(&impl_generics), arguments: spell(&ty_generics), bounds }
    }
}

/// The arguments that the inherent function takes of those of the trait's.
pub fn needed(row: &Row, i: &Interface<'_>) -> Vec<Argument> {
    (row.declare)(&i.facts).arguments
}
