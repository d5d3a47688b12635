//! Declared equilibria, with the values of all coordinates, inputs and states. The equations of motion are
//! checked elsewhere.

use crate::diag::Diagnostics;
use crate::expr::Expr as Value;
use crate::mechanism::{DRY_FRICTION, Equilibrium, FirstOrderStateAtEquilibrium, Model};
use crate::resolve::scope::{AllowedQuantities, Context, Scope};
use crate::syntax::{self, Action, Expr, ForceKind, RATE_OF_STATE};
use std::collections::BTreeSet;

/// Variable whose value at the equilibrium is declared, by its index.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum EquilibriumVariable {
    Coordinate(usize),
    Input(usize),
    State(usize),
}

/// Returns all declared equilibria.
pub fn resolve_equilibria<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    cx: &mut Diagnostics,
) -> Vec<Equilibrium<'g>> {
    let mut equilibria = Vec::new();
    let is_friction = |action: &Action| action.kind == ForceKind::Friction;
    let dry = scope.description.actions.iter().any(is_friction);
    for declared in &scope.description.equilibria {
        if dry {
            cx.report_error(
                declared.name.place.clone(),
                format!("dry friction cannot be linearised about `{}`", declared.name.text),
            )
            .add_help(DRY_FRICTION);
        } else if model.kinematic {
            cx.report_error(declared.name.place.clone(), "linear equations of motion need inertia").add_help(
                "remove the equilibrium, or `inertia = none`: without inertia there are no dynamics",
            );
        } else if let Some(found) = resolve_equilibrium(scope, model, declared, cx) {
            equilibria.push(found);
        }
    }
    equilibria
}

fn resolve_equilibrium<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    declared: &syntax::Equilibrium,
    cx: &mut Diagnostics,
) -> Option<Equilibrium<'g>> {
    let g = scope.graph;
    let mut found = Equilibrium {
        name: declared.name.text.clone(),
        place: declared.name.place.clone(),
        configuration: vec![g.zero(); model.nq()],
        inputs: vec![g.zero(); model.nu()],
        states: first_order_states_at_zero(scope, model),
    };
    for chart in &model.charts {
        if let Some(first) = chart.first_quaternion_index() {
            found.configuration[first.0 + 3] = g.one();
        }
    }
    let before = cx.len();
    let mut given = BTreeSet::new();
    for (place, value) in &declared.values {
        let Some(variable) = resolve_variable(scope, model, place, cx) else { continue };
        if !given.insert(variable) {
            cx.report_error(place.place.clone(), format!("`{}` is given twice", place.short_source_text()))
                .add_help("remove one of the two");
            continue;
        }
        let Some(value) = value_at_equilibrium(scope, model, variable, value, cx) else { continue };
        match variable {
            EquilibriumVariable::Coordinate(k) => found.configuration[k] = value,
            EquilibriumVariable::Input(k) => found.inputs[k] = value,
            EquilibriumVariable::State(k) => found.states[k].value = value,
        }
    }
    (cx.len() == before).then_some(found)
}

/// Returns the states of first order with the value zero.
fn first_order_states_at_zero<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
) -> Vec<FirstOrderStateAtEquilibrium<'g>> {
    let g = scope.graph;
    let rate_of_state = |name: &str| {
        let rate = format!("{name}{RATE_OF_STATE}");
        let output = model.outputs.iter().find(|output| output.name == rate);
        output.and_then(|output| output.values.first().copied()).unwrap_or(g.zero())
    };
    let states = scope.description.states.iter();
    states
        .map(|(name, parameter)| FirstOrderStateAtEquilibrium {
            parameter: *parameter,
            value: g.zero(),
            rate: rate_of_state(&name.text),
        })
        .collect()
}

/// Returns the value of a variable, an expression of the parameters.
fn value_at_equilibrium<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    variable: EquilibriumVariable,
    value: &Expr,
    cx: &mut Diagnostics,
) -> Option<Value<'g>> {
    let name = match variable {
        EquilibriumVariable::Coordinate(k) => model.configuration.get(k)?,
        EquilibriumVariable::Input(_) | EquilibriumVariable::State(_) => "",
    };
    let coordinates = &scope.kinematics.coordinates;
    let angle = coordinates.iter().any(|(known, _, angle)| known == name && *angle);
    scope.call_in_context(Context::new(AllowedQuantities::Constant, None), |scope| match angle {
        true => scope.resolve_angle_in_radians(value, cx),
        false => scope.resolve_scalar(value, cx),
    })
}

/// Returns the variable with this name, or reports an error.
fn resolve_variable<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    place: &Expr,
    cx: &mut Diagnostics,
) -> Option<EquilibriumVariable> {
    let text = place.short_source_text();
    let coordinate = model.configuration.iter().position(|name| *name == text);
    let find_input =
        || model.inputs.iter().position(|(name, _)| *name == text).map(EquilibriumVariable::Input);
    let state = || {
        scope
            .description
            .states
            .iter()
            .position(|(name, _)| name.text == text)
            .map(EquilibriumVariable::State)
    };
    let found = coordinate.map(EquilibriumVariable::Coordinate).or_else(find_input).or_else(state);
    if found.is_none() {
        report_place_without_variable(scope, model, place, &text, cx);
    }
    found
}

fn report_place_without_variable<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    place: &Expr,
    text: &str,
    cx: &mut Diagnostics,
) {
    let own: Vec<&str> = model
        .configuration
        .iter()
        .filter(|name| name.strip_prefix(text).is_some_and(|rest| rest.starts_with('.')))
        .map(String::as_str)
        .collect();
    let states = scope.description.states.iter().map(|(name, _)| name.text.as_str());
    let inputs = model.inputs.iter().map(|(name, _)| name.as_str());
    let known: Vec<&str> =
        model.configuration.iter().map(String::as_str).chain(inputs).chain(states).collect();
    let follows = scope.description.joints.iter().any(|joint| joint.name.text == text);
    let what = scope.kind_of_name(text);
    let error = cx.report_error(place.place.clone(), format!("`{text}` cannot have a value at rest"));
    match (own.as_slice(), what) {
        ([first, ..], _) => error.add_help(format!("give its coordinates values: write `{first} = …`")),
        (_, Some("a parameter")) => error.add_help(
            "parameters have their values in the struct; values here can be expressions of parameters",
        ),
        _ if follows => {
            error.add_help("it has no coordinate: it is welded, closes a loop, or follows others")
        }
        _ => error.suggest_name(text, known),
    };
    if error.has_no_help() {
        error.add_help("coordinates, inputs and states have values: `#[equilibrium(joint = angle)]`");
    }
}
