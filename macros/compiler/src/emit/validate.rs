//! The generated function that checks parameters.

use super::interface::Interface;
use crate::mechanism::{Model, Requirement};
use std::fmt::Write;

/// A condition on values that depend on parameters.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name of the condition in the runtime.
    rule: &'static str,
    /// Description of the values.
    name: String,
    /// Names of the parameters on which the values depend.
    parameters: Vec<String>,
}

impl Figure {
    /// Returns all conditions of a model, in the order of the values of the hidden function `__figures`.
    pub fn from_model(model: &Model<'_>) -> Vec<Figure> {
        let name = |k: &usize| model.parameters.get(*k).cloned();
        let figure = |requirement: &Requirement<'_>| Figure {
            rule: requirement.rule.name(),
            name: requirement.figure.clone(),
            parameters: requirement.parameters.iter().filter_map(name).collect(),
        };
        model.requirements.iter().map(figure).collect()
    }
}

/// Writes `validate`. For a mechanism that failed to compile its body never returns.
pub fn write_method(out: &mut String, i: &Interface<'_>, failed: bool) {
    if i.facts.parameters == 0 {
        return;
    }
    out.push_str(
        "/// Whether a mechanism with these parameters can be: whether they are finite, masses, sizes and coefficients are not
        /// negative, and bodies can have their inertias (none of the principal moments exceeds the sum of the others). What is
        /// an error of the compiler in a number is one here in a parameter. No other function looks at it: call it where
        /// parameters are loaded, estimated or drawn at random. Of lanes, all must be sound. A parameter whose name begins
        /// with `_` and which nothing uses may be what it likes.
        ///
        /// # Errors
        ///
        /// The first figure that is not sound, with the parameters that it follows from.
        #[inline(never)]\npub fn validate(&self) -> ::core::result::Result<(), ::linkwork::ParameterError> {\n",
    );
    if failed {
        out.push_str("loop {}\n}\n");
        return;
    }
    out.push_str("use ::linkwork::__private::{Figure, Rule};\nconst FIGURES: &[Figure] = &[\n");
    for figure in &i.figures {
        let _ = writeln!(
            out,
            "Figure {{ rule: Rule::{}, name: {:?}, parameters: &{:?} }},",
            figure.rule, figure.name, figure.parameters
        );
    }
    out.push_str("];\n::linkwork::__private::validate(FIGURES, &self.__figures())\n}\n");
}
