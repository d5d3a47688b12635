//! Variables of an FMU, in the order of their value references.

use super::super::mechanism::ExportedMechanism;
use super::super::names::replace_invalid_characters;
use super::units;
use super::values::StartValues;
use crate::mechanism::Model;

/// Role of a scalar variable in the FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VariableRole {
    Time,
    State,
    /// Time derivative of the state with this value reference.
    Rate(usize),
    Input,
    Parameter,
    Output,
    Indicator,
}

/// Scalar variable of an FMU.
#[derive(Clone, Debug)]
pub struct ScalarVariable {
    pub name: String,
    /// Unit of the FMU variable; `any` if it is unknown.
    pub unit: String,
    pub role: VariableRole,
    /// Start value of the FMU variable, for states, inputs and parameters.
    pub start: f64,
}

/// Output variables of the FMU with the C functions that compute them.
#[derive(Clone, Debug)]
pub struct OutputFunction {
    /// Name of the C function for the output.
    pub name: String,
    /// Number of values of the output.
    pub size: usize,
    /// Whether there are C functions for the derivatives of the output.
    pub is_differentiable: bool,
}

impl OutputFunction {
    /// Finds the functions of an output, with those of its derivatives by parameters if others have them.
    fn new(name: &str, signatures: &ExportedMechanism<'_>, has_sensitivities: bool) -> OutputFunction {
        let find_function = |name: &str| signatures.functions.iter().find(|f| f.name == name);
        let size = find_function(name).map_or(0, |f| f.results.iter().map(|array| array.length()).sum());
        let has_parameters = signatures.parameters.is_empty()
            || !has_sensitivities
            || find_function(&format!("{name}_by_parameters")).is_some();
        let is_differentiable = find_function(&format!("{name}_derivatives")).is_some() && has_parameters;
        OutputFunction { name: name.to_string(), size, is_differentiable }
    }
}

/// All variables of an FMU.
pub struct FmuVariables {
    /// All variables, in the order of their value references.
    pub all: Vec<ScalarVariable>,
    /// C functions for the rates of states of first order.
    pub rates: Vec<OutputFunction>,
    /// Outputs in the order of the FMU variables: outputs with derivatives first.
    pub outputs: Vec<OutputFunction>,
    /// Indices of the parameters that are not states of first order.
    pub parameters: Vec<usize>,
    /// Whether derivatives of rates and outputs are available.
    pub is_differentiable: bool,
    /// Whether generated functions give the derivatives by configuration, velocity and inputs. Otherwise they
    /// are differences.
    pub has_generated_derivatives: bool,
    /// Whether generated functions give the derivatives by states of first order and parameters too.
    pub has_generated_sensitivities: bool,
    /// Whether states may change at events and after initialization.
    pub is_projected: bool,
    /// Whether constraints determine some start values.
    pub is_constrained: bool,
    /// Whether the FMU is for model exchange too, and has rates and event indicators.
    pub has_model_exchange: bool,
}

/// Names of the energy variables, which follow the outputs.
pub const ENERGIES: [&str; 2] = ["kinetic_energy", "potential_energy"];

impl FmuVariables {
    /// Lists the variables of a mechanism, with or without derivatives.
    pub fn new(
        model: &Model<'_>,
        signatures: &ExportedMechanism<'_>,
        start: &StartValues,
        is_differentiable: bool,
    ) -> FmuVariables {
        let has_function = |name: &str| signatures.functions.iter().any(|f| f.name == name);
        let is_constrained = has_function("constraint_jacobian");
        let has_generated_sensitivities =
            signatures.parameters.is_empty() || has_function("forward_dynamics_by_parameters");
        let output_function =
            |name: &String| OutputFunction::new(name, signatures, has_generated_sensitivities);
        let name_of_state_rate = |k: &usize| format!("{}_rate", signatures.parameters[*k]);
        let rates: Vec<OutputFunction> =
            start.states.iter().map(|k| output_function(&name_of_state_rate(k))).collect();
        let mut outputs: Vec<OutputFunction> =
            signatures.output_names().iter().map(output_function).collect();
        outputs.retain(|output| rates.iter().all(|rate| rate.name != output.name));
        outputs.sort_by_key(|output| !output.is_differentiable);
        let accelerations =
            if is_constrained { "motion_derivatives" } else { "forward_dynamics_derivatives" };
        let has_generated_derivatives = has_function(accelerations)
            && (model.nu() == 0 || has_function("generalized_forces_derivatives"))
            && rates.iter().all(|rate| rate.is_differentiable)
            && model.contacts.is_empty()
            && model.speeds.is_none();
        let has_quaternions = model.charts.iter().any(|chart| chart.first_quaternion_index().is_some());
        let parameters: Vec<usize> =
            (0..model.parameters.len()).filter(|k| !start.states.contains(k)).collect();
        let mut variables = FmuVariables {
            all: Vec::new(),
            rates,
            outputs,
            parameters,
            is_differentiable,
            has_generated_derivatives,
            has_generated_sensitivities,
            is_projected: has_quaternions || is_constrained || !model.contacts.is_empty(),
            is_constrained,
            has_model_exchange: true,
        };
        variables.list_variables(model, start);
        variables
    }

    /// Lists the variables of a mechanism that the run-time library simulates: no rates and event indicators.
    pub fn library_variables(
        model: &Model<'_>,
        outputs: Vec<OutputFunction>,
        start: &StartValues,
    ) -> FmuVariables {
        let parameters = (0..model.parameters.len()).filter(|k| !start.states.contains(k)).collect();
        let mut variables = FmuVariables {
            all: Vec::new(),
            rates: Vec::new(),
            outputs,
            parameters,
            is_differentiable: false,
            has_generated_derivatives: false,
            has_generated_sensitivities: false,
            is_projected: false,
            is_constrained: !model.constraints.is_empty(),
            has_model_exchange: false,
        };
        variables.list_variables(model, start);
        variables
    }

    /// Lists all variables in the order of their value references.
    fn list_variables(&mut self, model: &Model<'_>, start: &StartValues) {
        let u = &model.units;
        self.add_variable("time".to_string(), "s", VariableRole::Time, 0.0);
        for (k, name) in model.configuration.iter().enumerate() {
            self.add_variable(
                format!("q.{name}"),
                unit_at_index(&u.configuration, k),
                VariableRole::State,
                start.q[k],
            );
        }
        for (k, (name, _)) in model.velocities.iter().enumerate() {
            self.add_variable(
                format!("v.{name}"),
                unit_at_index(&u.velocities, k),
                VariableRole::State,
                start.v[k],
            );
        }
        for &k in &start.states {
            self.add_variable(
                format!("x.{}", model.parameters[k]),
                unit_at_index(&u.parameters, k),
                VariableRole::State,
                start.parameters[k],
            );
        }
        let states = if self.has_model_exchange { self.all.len() } else { 0 };
        for state in 1..states {
            let ScalarVariable { name, unit, .. } = self.all[state].clone();
            self.add_variable(
                format!("der({name})"),
                &units::unit_of_rate(&unit),
                VariableRole::Rate(state),
                0.0,
            );
        }
        for (k, (name, _)) in model.inputs.iter().enumerate() {
            self.add_variable(
                format!("u.{name}"),
                unit_at_index(&u.inputs, k),
                VariableRole::Input,
                start.u[k],
            );
        }
        for k in self.parameters.clone() {
            self.add_variable(
                model.parameters[k].clone(),
                unit_at_index(&u.parameters, k),
                VariableRole::Parameter,
                start.parameters[k],
            );
        }
        for output in self.outputs.clone() {
            let at =
                model.outputs.iter().position(|known| replace_invalid_characters(&known.name) == output.name);
            let unit = at.map_or("any", |at| unit_at_index(&u.outputs, at));
            let name = at.map_or(&output.name, |at| &model.outputs[at].name);
            for k in 0..output.size {
                let name = if output.size == 1 { name.clone() } else { format!("{name}[{}]", k + 1) };
                self.add_variable(name, unit, VariableRole::Output, 0.0);
            }
        }
        ENERGIES
            .iter()
            .for_each(|name| self.add_variable((*name).to_string(), "J", VariableRole::Output, 0.0));
        let contacts = if self.has_model_exchange { &model.contacts[..] } else { &[] };
        for contact in contacts {
            self.add_variable(format!("event.{}", contact.name), "any", VariableRole::Indicator, 0.0);
        }
    }

    /// Adds a variable. A name that is taken gets a number.
    fn add_variable(&mut self, name: String, unit: &str, role: VariableRole, start: f64) {
        let mut free = name.clone();
        let mut number = 2_usize;
        while self.all.iter().any(|known| known.name == free) {
            free = format!("{name}_{number}");
            number += 1;
        }
        self.all.push(ScalarVariable { name: free, unit: unit.to_string(), role, start });
    }

    /// Returns the number of outputs whose derivatives are finite differences.
    pub fn count_differenced_outputs(&self) -> usize {
        let outputs = self.outputs.iter().filter(|output| !output.is_differentiable);
        ENERGIES.len() + outputs.map(|output| output.size).sum::<usize>()
    }
}

fn unit_at_index(units: &[String], k: usize) -> &str {
    units.get(k).map_or("any", String::as_str)
}
