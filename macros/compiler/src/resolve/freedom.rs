//! Degrees of freedom: removal of redundant rows, and choice of independent velocities.

use super::contact;
use crate::diag::Diagnostics;
use crate::kinematics::{CompiledConstraintRows, mobility, redundancy};
use crate::mechanism::Model;
use crate::syntax::{ExprKind, Formulation};

/// Removes redundant rows and counts the degrees of freedom.
pub fn remove_redundancy_and_check_mobility(
    model: &mut Model<'_>,
    formulation: &Formulation,
    cx: &mut Diagnostics,
) {
    let mut rows = CompiledConstraintRows::new(model);
    let constant = redundancy::velocity_independent_row_flags(model, &rows);
    redundancy::report_violated_constant_rows(model, &constant, cx);
    if !cx.is_empty() {
        return;
    }
    let samples = mobility::sample_feasible_configurations(model, &rows, cx);
    let before = model.constraints.clone();
    if redundancy::prune_redundant_rows(model, &rows, &constant, &samples) {
        contact::report_undetermined_normal_forces(&before, &model.redundant, cx);
        rows = CompiledConstraintRows::new(model);
    }
    model.freedom = mobility::degrees_of_freedom(model, &rows, &samples, cx);
    apply_independent_velocities(model, formulation, (&rows, &samples), cx);
}

/// Expresses the velocities in independent ones, if independent velocities are requested.
fn apply_independent_velocities(
    model: &mut Model<'_>,
    formulation: &Formulation,
    (rows, samples): (&CompiledConstraintRows<'_>, &[mobility::ConfigurationSample]),
    cx: &mut Diagnostics,
) {
    let Formulation::Speeds(names, place) = formulation else { return };
    if model.constraints.iter().any(|c| !c.friction.is_empty()) {
        cx.report_error(
            place.clone(),
            "independent speeds eliminate the normal force that friction depends on",
        )
        .add_help("a mechanism with slipping contacts is solved by multipliers: remove this argument");
        return;
    }
    let mut independent = Vec::new();
    for e in names {
        let name = match &e.kind {
            ExprKind::Field(joint, member) => joint.as_name().map(|joint| format!("{joint}.{}", member.text)),
            _ => e.as_name().map(str::to_string),
        };
        let velocity_names = || model.velocities.iter().map(|(name, _)| name.as_str());
        match velocity_names().position(|v| Some(v) == name.as_deref()) {
            Some(k) => independent.push(k),
            None => {
                cx.report_error(e.place.clone(), "expected a velocity")
                    .suggest_name(name.as_deref().unwrap_or(""), velocity_names());
                return;
            }
        }
    }
    let free = model.freedom.velocities;
    if !independent.is_empty() && independent.len() != free {
        cx.report_error(
            place.clone(),
            format!("{} independent speeds for {free} degrees of freedom", independent.len()),
        )
        .add_help(format!("name {free}, or remove `independent` to have them chosen"));
        return;
    }
    if !cx.is_empty() {
        return;
    }
    model.dependent = mobility::pivot_velocity_per_constraint(model, rows, samples, &independent);
    if model.dependent.is_none() {
        let diagnostic =
            cx.report_error(place.clone(), "the independent speeds do not determine the other velocities");
        diagnostic.add_help(
            "constraints are redundant, or these speeds depend on each other: use `formulation = \
             multipliers`, or others",
        );
    }
}
