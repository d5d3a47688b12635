//! Laws of actuators with states of first order or with several inputs, as expressions.

use super::defaults::Element;
use super::formula::Formula;
use crate::diag::Place;
use crate::import::context::{Cx, quote_word};
use crate::import::imported::Placed;
use crate::syntax::DriveQuantity;

pub(super) const OTHER_INPUTS: &str =
    "to ignore the actuators of the file, write `#[mechanism(…, inputs = joints)]`, or `none`";

/// Smallest positive divisor, as in MuJoCo.
pub(super) const TINY: f64 = 1e-15;

/// Force as an expression of inputs, states, length and rate.
pub(super) struct ActuatorLaw {
    place: Place,
    actuator: String,
    /// Inputs: the word that distinguishes each from the others of this actuator, and its unit.
    pub(super) inputs: Vec<(String, &'static str)>,
    /// States of first order.
    pub(super) states: Vec<ActuatorState>,
    /// Force.
    pub(super) force: Formula,
    /// Maximum force.
    pub(super) limit: Option<Placed<f64>>,
}

/// State of first order of an actuator.
pub(super) struct ActuatorState {
    /// Name of the state's field.
    pub(super) ident: String,
    /// Documentation.
    pub(super) about: String,
    /// Unit of the state.
    pub(super) unit: &'static str,
    /// Rate.
    pub(super) rate: Formula,
}

/// Name of an actuator, of its inputs and of its states.
pub(super) struct ActuatorNames<'n> {
    /// Name of the actuator.
    pub(super) actuator: &'n str,
    /// Unit of the length of the actuator.
    pub(super) length: &'static str,
    /// Returns the name of the field for a state.
    pub(super) field: &'n dyn Fn(&str) -> String,
    /// Returns the name of an input; the word is empty if the actuator has a single input.
    pub(super) input: &'n dyn Fn(&str) -> String,
}

impl ActuatorLaw {
    /// Returns a law without force.
    pub(super) fn new(named: &ActuatorNames<'_>, place: &Place) -> ActuatorLaw {
        ActuatorLaw {
            place: place.clone(),
            actuator: named.actuator.to_string(),
            inputs: Vec::new(),
            states: Vec::new(),
            force: Formula::number(0.0, place),
            limit: None,
        }
    }

    /// Returns a number.
    pub(super) fn number(&self, value: f64) -> Formula {
        Formula::number(value, &self.place)
    }

    /// Returns the length of the actuator.
    pub(super) fn length(&self) -> Formula {
        Formula::name(DriveQuantity::Length.name_for(&self.actuator), &self.place)
    }

    /// Returns the rate of the length.
    pub(super) fn rate(&self) -> Formula {
        Formula::name(DriveQuantity::Rate.name_for(&self.actuator), &self.place)
    }

    /// Adds an input, and returns its value.
    pub(super) fn input(&mut self, word: &str, unit: &'static str, named: &ActuatorNames<'_>) -> Formula {
        let name = (named.input)(word);
        self.inputs.push((name.clone(), unit));
        Formula::name(DriveQuantity::Input.name_for(&name), &self.place)
    }

    /// Returns the value of a state.
    pub(super) fn state(&self, word: &str, named: &ActuatorNames<'_>) -> Formula {
        Formula::name((named.field)(word), &self.place)
    }

    /// Adds a state with its rate.
    pub(super) fn add_state(
        &mut self,
        word: &str,
        what: &str,
        unit: &'static str,
        rate: Formula,
        named: &ActuatorNames<'_>,
    ) {
        let comma = if unit == "1" || unit == "any" { String::new() } else { format!(", {unit}") };
        let about = format!("{what} of the actuator `{}`{comma}.", named.actuator);
        self.states.push(ActuatorState { ident: (named.field)(word), about, unit, rate });
    }

    /// Returns `b₀ + b₁ length + b₂ rate`.
    pub(super) fn affine(&self, prm: &[f64; 10]) -> Formula {
        let [b0, b1, b2, ..] = *prm;
        self.length() * b1 + self.rate() * b2 + b0
    }
}

/// Inputs of a controller in MuJoCo's order, each with its word.
pub(super) const CONTROLS: [&str; 4] = ["pos", "vel", "ff", "voltage"];

/// Returns the requested inputs of a controller. The order is MuJoCo's.
pub(super) fn controls(
    actuator: &Element<'_>,
    usual: &'static str,
    known: &[&'static str],
    cx: &mut Cx<'_>,
) -> Option<Vec<&'static str>> {
    let text = actuator.text("input").filter(|text| !text.is_empty()).unwrap_or(usual);
    let mut found: Vec<&'static str> = Vec::new();
    for word in text.split_ascii_whitespace() {
        let place = |word: &str| CONTROLS.iter().position(|known| *known == word);
        let in_order = found.last().is_none_or(|last| place(last) < place(word));
        match known.iter().find(|known| **known == word) {
            Some(known) if in_order => found.push(known),
            _ => {
                let message = format!("`input` {} is not a list of inputs", quote_word(text));
                let help = format!("expected some of `{}`, in this order", known.join("`, `"));
                cx.report_error(&actuator.place("input", cx), message, |d| d.add_help(help));
                return None;
            }
        }
    }
    Some(found)
}

/// Reports a nonzero limit of a controller that depends on the length of MuJoCo's time step or is not
/// continuous.
pub(super) fn refuse_limit(
    actuator: &Element<'_>,
    attribute: &str,
    what: &str,
    value: f64,
    cx: &mut Cx<'_>,
) -> Option<()> {
    if value <= 0.0 {
        return Some(());
    }
    let message = format!("{what} is not supported: the rate of its state is not continuous");
    cx.report_error(&actuator.place(attribute, cx), message, |d| {
        d.add_help("write `0`, and limit the command in your program").add_help(OTHER_INPUTS)
    });
    None
}
