//! Code generation for the function that validates parameters.

use super::interface::Interface;
use crate::mechanism::{Model, Requirement};
use std::fmt::Write;

/// Condition that values of the parameters must satisfy, such as a positive mass.
#[derive(Clone, Debug)]
pub struct ParameterCondition {
    /// Name of the condition in the runtime.
    rule: &'static str,
    /// Description of the values that must satisfy the condition.
    name: String,
    /// Names of the parameters on which the values depend.
    parameters: Vec<String>,
}

impl ParameterCondition {
    /// Returns all conditions of a model, in the order of the values of the hidden function `__figures`.
    pub fn conditions_of_model(model: &Model<'_>) -> Vec<ParameterCondition> {
        let parameter_name = |k: &usize| model.parameters.get(*k).cloned();
        let parameter_condition = |requirement: &Requirement<'_>| ParameterCondition {
            rule: requirement.rule.runtime_rule_name(),
            name: requirement.figure.clone(),
            parameters: requirement.parameters.iter().filter_map(parameter_name).collect(),
        };
        model.requirements.iter().map(parameter_condition).collect()
    }
}

/// Writes `validate`. For a mechanism that failed to compile its body never returns.
pub fn write_validate_method(out: &mut String, i: &Interface<'_>, failed: bool) {
    if i.facts.parameters == 0 {
        return;
    }
    out.push_str(
        "/// Checks that the parameters are physically valid: values are finite; masses, sizes and \
         coefficients are not negative;
        /// and no principal moment of inertia exceeds the sum of the other two. These are the conditions that
        /// the compiler checks for numbers. No other function checks them: call this one for parameters that
        /// are loaded, estimated or random. With lanes, the values of all lanes must be valid. Unused
        /// parameters whose names begin with `_` are not checked.
        ///
        /// # Errors
        ///
        /// The first invalid value, with the parameters on which it depends.
        #[inline(never)]\npub fn validate(&self) -> ::core::result::Result<(), ::linkwork::ParameterError> \
            {\n",
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
