//! Data about a loaded mechanism that none of its functions needs.

use crate::robot::Robot;
use crate::shared::{Quantity, SharedMechanism};
use linkwork_compiler::ParsedSource;
use linkwork_compiler::export::without_doc_links;
use linkwork_compiler::mechanism::Model;

/// Documentation of a mechanism, and names and units of its outputs.
pub(crate) struct MechanismDocumentation {
    documentation: String,
    outputs: Vec<Quantity>,
}

impl MechanismDocumentation {
    /// Collects the documentation and the outputs of a mechanism.
    pub fn new(source: &ParsedSource, model: &Model<'_>) -> MechanismDocumentation {
        let outputs = model.outputs.iter().enumerate().map(|(k, output)| Quantity {
            name: output.name.clone(),
            unit: model.units.outputs.get(k).cloned().unwrap_or_default(),
        });
        MechanismDocumentation {
            documentation: without_doc_links(&source.mechanism.shell.documentation_lines()),
            outputs: outputs.collect(),
        }
    }
}

impl SharedMechanism {
    /// Returns the reason why a Runge–Kutta step needs more than the accelerations of the mechanism, such as
    /// constraints or contacts; `None` if it does not.
    pub fn step_obstacle(&self) -> Option<&'static str> {
        let reasons = [
            (self.kinematic, "it has no inertia"),
            (!self.constraints.names.is_empty(), "it has constraints"),
            (!self.contacts.is_empty(), "it has contacts"),
            (!self.states.is_empty(), "it has states of first order"),
        ];
        reasons.into_iter().find_map(|(is_so, reason)| is_so.then_some(reason))
    }
}

impl Robot {
    /// Returns the documentation of the declaration, empty for a robot file.
    #[must_use]
    pub fn documentation(&self) -> &str {
        &self.shared.about.documentation
    }

    /// Returns the name and unit of each output. The functions that compute the outputs have these names.
    #[must_use]
    pub fn outputs(&self) -> &[Quantity] {
        &self.shared.about.outputs
    }

    /// Returns the number of scalar constraints of the mechanism.
    #[must_use]
    pub fn constraints(&self) -> usize {
        self.shared.constraints.names.len()
    }

    /// Returns the number of unilateral contacts of the mechanism.
    #[must_use]
    pub fn contacts(&self) -> usize {
        self.shared.contacts.len()
    }
}
