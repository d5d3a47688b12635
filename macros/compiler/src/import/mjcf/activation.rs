//! Laws of actuators with states of first order or with several inputs, as expressions.

use super::defaults::ElementWithDefaults;
use super::formula::ActuatorLawExpression;
use crate::diag::Place;
use crate::import::context::{Cx, quote_word};
use crate::import::imported::Located;
use crate::syntax::FileForceQuantity;

pub(super) const OTHER_INPUTS: &str =
    "to ignore the actuators of the file, write `#[mechanism(…, inputs = joints)]`, or `none`";

/// Smallest positive divisor in MuJoCo's actuator laws.
pub(super) const TINY: f64 = 1e-15;

/// Force as an expression of inputs, states, length and rate.
pub(super) struct SymbolicActuatorLaw {
    place: Place,
    actuator: String,
    /// Inputs: the word that distinguishes each from the others of this actuator, and its unit.
    pub(super) inputs: Vec<(String, &'static str)>,
    /// States of first order of the actuator.
    pub(super) states: Vec<ActuatorState>,
    /// Force of the actuator as an expression.
    pub(super) force: ActuatorLawExpression,
    /// Maximum magnitude of the actuator's force, if it is limited.
    pub(super) limit: Option<Located<f64>>,
}

/// State of first order of an actuator.
pub(super) struct ActuatorState {
    /// Name of the struct field for the state.
    pub(super) ident: String,
    /// Documentation of the state.
    pub(super) about: String,
    /// Unit of the actuator's state, as text.
    pub(super) unit: &'static str,
    /// Time derivative of the state as an expression.
    pub(super) rate: ActuatorLawExpression,
}

/// Name of an actuator, of its inputs and of its states.
pub(super) struct ActuatorNames<'n> {
    /// Name of the actuator in the file.
    pub(super) actuator: &'n str,
    /// Unit of the actuator length, as text.
    pub(super) length: &'static str,
    /// Closure that returns the name of the struct field for a state.
    pub(super) field: &'n dyn Fn(&str) -> String,
    /// Returns the name of an input; the word is empty if the actuator has a single input.
    pub(super) input: &'n dyn Fn(&str) -> String,
}

impl SymbolicActuatorLaw {
    /// Returns an actuator law without force, inputs and states.
    pub(super) fn new(named: &ActuatorNames<'_>, place: &Place) -> SymbolicActuatorLaw {
        SymbolicActuatorLaw {
            place: place.clone(),
            actuator: named.actuator.to_string(),
            inputs: Vec::new(),
            states: Vec::new(),
            force: ActuatorLawExpression::number_literal(0.0, place),
            limit: None,
        }
    }

    /// Returns a constant as an expression of the actuator law.
    pub(super) fn constant_formula(&self, value: f64) -> ActuatorLawExpression {
        ActuatorLawExpression::number_literal(value, &self.place)
    }

    /// Returns the actuator length as an expression.
    pub(super) fn actuator_length_formula(&self) -> ActuatorLawExpression {
        ActuatorLawExpression::formula_of_name(
            FileForceQuantity::Length.file_force_quantity_name(&self.actuator),
            &self.place,
        )
    }

    /// Returns the time derivative of the actuator length as an expression.
    pub(super) fn actuator_length_rate_formula(&self) -> ActuatorLawExpression {
        ActuatorLawExpression::formula_of_name(
            FileForceQuantity::Rate.file_force_quantity_name(&self.actuator),
            &self.place,
        )
    }

    /// Adds an input to the actuator and returns its value as an expression.
    pub(super) fn add_input(
        &mut self,
        word: &str,
        unit: &'static str,
        named: &ActuatorNames<'_>,
    ) -> ActuatorLawExpression {
        let name = (named.input)(word);
        self.inputs.push((name.clone(), unit));
        ActuatorLawExpression::formula_of_name(
            FileForceQuantity::Input.file_force_quantity_name(&name),
            &self.place,
        )
    }

    /// Returns the value of an actuator state as an expression.
    pub(super) fn actuator_state_formula(
        &self,
        word: &str,
        named: &ActuatorNames<'_>,
    ) -> ActuatorLawExpression {
        ActuatorLawExpression::formula_of_name((named.field)(word), &self.place)
    }

    /// Adds a state of first order to the actuator, with its time derivative.
    pub(super) fn add_actuator_state(
        &mut self,
        word: &str,
        what: &str,
        unit: &'static str,
        rate: ActuatorLawExpression,
        named: &ActuatorNames<'_>,
    ) {
        let comma = if unit == "1" || unit == "any" { String::new() } else { format!(", {unit}") };
        let about = format!("{what} of the actuator `{}`{comma}.", named.actuator);
        self.states.push(ActuatorState { ident: (named.field)(word), about, unit, rate });
    }

    /// Returns the affine force law `b₀ + b₁ length + b₂ rate` of an actuator.
    pub(super) fn affine_formula(&self, prm: &[f64; 10]) -> ActuatorLawExpression {
        let [b0, b1, b2, ..] = *prm;
        self.actuator_length_formula() * b1 + self.actuator_length_rate_formula() * b2 + b0
    }
}

/// Inputs of a controller in MuJoCo's order, each with its word.
pub(super) const CONTROLS: [&str; 4] = ["pos", "vel", "ff", "voltage"];

/// Returns the requested inputs of a controller. The order is MuJoCo's.
pub(super) fn requested_controller_inputs(
    actuator: &ElementWithDefaults<'_>,
    usual: &'static str,
    known: &[&'static str],
    cx: &mut Cx<'_>,
) -> Option<Vec<&'static str>> {
    let text = actuator.trimmed_attribute_text("input").filter(|text| !text.is_empty()).unwrap_or(usual);
    let mut found: Vec<&'static str> = Vec::new();
    for word in text.split_ascii_whitespace() {
        let control_word_index = |word: &str| CONTROLS.iter().position(|known| *known == word);
        let in_order = found.last().is_none_or(|last| control_word_index(last) < control_word_index(word));
        match known.iter().find(|known| **known == word) {
            Some(known) if in_order => found.push(known),
            _ => {
                let message = format!("`input` {} is not a list of inputs", quote_word(text));
                let help = format!("expected some of `{}`, in this order", known.join("`, `"));
                cx.report_error(&actuator.place_of_attribute_value("input", cx), message, |d| {
                    d.add_help(help)
                });
                return None;
            }
        }
    }
    Some(found)
}

/// Reports a nonzero limit of a controller that depends on the length of MuJoCo's time step or is not
/// continuous.
pub(super) fn report_unsupported_controller_limit(
    actuator: &ElementWithDefaults<'_>,
    attribute: &str,
    what: &str,
    value: f64,
    cx: &mut Cx<'_>,
) -> Option<()> {
    if value <= 0.0 {
        return Some(());
    }
    let message = format!("{what} is not supported: the rate of its state is not continuous");
    cx.report_error(&actuator.place_of_attribute_value(attribute, cx), message, |d| {
        d.add_help("write `0`, and limit the command in your program").add_help(OTHER_INPUTS)
    });
    None
}
