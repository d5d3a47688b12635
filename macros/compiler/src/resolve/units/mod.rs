//! Inference of units: the dimension of every parameter, coordinate, input and output follows from its use,
//! by unification over exponents of length, mass and time. Angles are plain numbers. The inference visits the
//! written expressions, because resolved values are simplified and have no source spans.

mod infer;
mod owner;
mod places;
mod report;
mod si;
mod unify;
mod value;
mod walk;

use crate::diag::Diagnostics;
use crate::language::dimension::{self, Dimension, UnknownDimensionIndex};
use crate::mechanism::{Chart, Constraint, Coordinate, InputEffect, MeasuredQuantity, Model, Units};
use crate::syntax::RATE_OF_STATE;
use crate::syntax::{Definition, Description, Expr, ExprKind, Rank};
use infer::{DimensionEqualityReason, EquationOrigin, Inference, UnitMeaningOfName};
use places::{DimensionedExpressions, ExpressionWithDimension};
use std::collections::{BTreeMap, BTreeSet};
use value::{InferredUnit, UnitSource};

/// Coordinates that expressions can name; the flag is true for an angle.
pub type NameableCoordinates = [(String, Coordinate, bool)];

/// Infers the units of a checked description, and reports contradictions.
pub fn infer_units(
    d: &Description,
    model: &Model<'_>,
    coordinates: &NameableCoordinates,
    cx: &mut Diagnostics,
) -> Units {
    let mut inference = Inference::new(d);
    let mut pinned = vec![None; d.parameters.len()];
    for (k, e) in &d.units {
        let Some((dimension, text)) = si::parse_unit(e, cx) else { continue };
        let origin =
            EquationOrigin { reason: DimensionEqualityReason::Unit, expression: e, compared_with: None };
        inference.equate_dimensions(&Dimension::unknown_dimension(*k), &dimension, origin);
        if let Some(slot) = pinned.get_mut(*k) {
            *slot = Some(text);
        }
    }
    let definitions = assign_dimensions_to_names(d, coordinates, &mut inference);
    let mut places = places::collect_dimensioned_expressions(d, &definitions, &mut inference);
    let outputs: Vec<UnknownDimensionIndex> =
        d.outputs.iter().map(|_| inference.system.add_unknown_dimension()).collect();
    for (output, v) in d.outputs.iter().zip(&outputs) {
        // The expression of a diagram is a body, without a dimension. Laws of a file contain numbers with
        // units that the file does not specify.
        if output.rank == Rank::FreeBody || output.value.place.file.is_some() {
            continue;
        }
        let (dimension, locals) = (Dimension::unknown_dimension(*v), Vec::new());
        places.tasks.push(ExpressionWithDimension { e: &output.value, dimension, unit: "", locals });
    }
    // The rate of a state is the state per second.
    for (name, parameter) in &d.states {
        let rate = format!("{}{RATE_OF_STATE}", name.text);
        let Some(output) = d.outputs.iter().find(|output| output.name.text == rate) else { continue };
        if output.value.place.file.is_some() {
            continue;
        }
        let Some(dimension) =
            Dimension::unknown_dimension(*parameter).dimension_of_quotient(&dimension::TIME)
        else {
            continue;
        };
        places.tasks.push(ExpressionWithDimension {
            e: &output.value,
            dimension,
            unit: "",
            locals: Vec::new(),
        });
    }
    let sides = std::mem::take(&mut places.sides);
    solve_dimensions(places, &mut inference);
    if inference.limit_exceeded {
        inference.mismatches.clear();
    }
    report::report_unit_contradictions(d, &mut inference, cx);
    inference.make_plain_numbers_dimensionless();
    let mut units =
        Units { outputs: Vec::new(), ..state_and_input_units(model, coordinates, &mut inference) };
    for (k, pinned) in pinned.into_iter().enumerate() {
        units.parameters.push(
            pinned.unwrap_or_else(|| {
                notation_of_dimension(&mut inference, &Dimension::unknown_dimension(k), k)
            }),
        );
    }
    for table in &d.tables {
        let unknown = inference.tables.get(&table.name.text).cloned().unwrap_or_default();
        let each = unknown
            .iter()
            .map(|v| notation_of_dimension(&mut inference, &Dimension::unknown_dimension(*v), *v));
        units.tables.push(each.collect());
    }
    // Inertial parameters of a file have known units, which cannot be inferred from their use.
    let of_file = units.parameters.iter_mut().rev().zip(d.file_units.iter().rev());
    of_file.for_each(|(unit, known)| *unit = known.to_string());
    for (output, v) in d.outputs.iter().zip(outputs) {
        let unit = notation_of_dimension(&mut inference, &Dimension::unknown_dimension(v), v);
        let energy = output.rank == Rank::Scalar && unit == "N·m";
        units.outputs.push(match output.rank {
            Rank::FreeBody => "N, N·m".to_string(),
            _ if energy => "J".to_string(),
            _ if output.value.place.file.is_some() => {
                unit_of_state_rate(d, &output.name.text, &units.parameters)
            }
            _ => unit,
        });
    }
    units.constraints =
        model.constraints.iter().map(|c| constraint_units(c, &sides, &mut inference)).collect();
    units
}

/// Returns the unit of the rate of a file's state.
fn unit_of_state_rate(d: &Description, rate: &str, parameters: &[String]) -> String {
    let state = d.states.iter().find(|(name, _)| format!("{}{RATE_OF_STATE}", name.text) == rate);
    match state.and_then(|(_, parameter)| parameters.get(*parameter)).map(String::as_str) {
        Some("any") | None => "any".to_string(),
        Some(unit) => format!("{unit}/s"),
    }
}

/// Assigns dimensions to coordinates, inputs and definitions. Returns the definitions, each after those that
/// it uses.
fn assign_dimensions_to_names<'a>(
    d: &'a Description,
    coordinates: &NameableCoordinates,
    inference: &mut Inference<'_>,
) -> Vec<&'a Definition> {
    for (name, _, angle) in coordinates {
        let dimension = if *angle { dimension::PLAIN } else { dimension::LENGTH };
        inference.names.insert(name.clone(), UnitMeaningOfName::Moving(dimension, UnitSource::Motion));
    }
    let acting: BTreeSet<&str> = d.actions.iter().map(|action| action.name.text.as_str()).collect();
    let free = d.coordinates.iter().map(|c| &c.name);
    for name in free.chain(&d.inputs) {
        let dimension = Dimension::unknown_dimension(inference.system.add_unknown_dimension());
        let anchor = if acting.contains(name.text.as_str()) { UnitSource::Input } else { UnitSource::Motion };
        inference.names.insert(name.text.clone(), UnitMeaningOfName::Moving(dimension, anchor));
    }
    let definitions = sort_by_dependency(&d.definitions);
    for definition in &definitions {
        let anchors = definition.value.all_subexpressions().into_iter().filter_map(|part| match &part.kind {
            ExprKind::Name(name) => match inference.names.get(name)? {
                UnitMeaningOfName::Named(_, anchor) | UnitMeaningOfName::Moving(_, anchor) => Some(*anchor),
            },
            ExprKind::Call(table, _) => inference.tables.get(&table.text).map(|_| UnitSource::Parameter),
            _ => None,
        });
        let anchor = anchors.max().unwrap_or(UnitSource::Motion);
        inference.assign_unknown_dimension(&definition.name.text, anchor);
    }
    definitions
}

/// Sorts definitions such that each is after those that it uses.
fn sort_by_dependency(definitions: &[Definition]) -> Vec<&Definition> {
    let numbers: BTreeMap<&str, usize> =
        definitions.iter().enumerate().map(|(k, d)| (d.name.text.as_str(), k)).collect();
    let mentioned_definitions = |d: &Definition| -> BTreeSet<usize> {
        let names = d.value.all_subexpressions().into_iter().filter_map(Expr::as_name);
        names.filter_map(|name| numbers.get(name).copied()).collect()
    };
    let mut missing: Vec<usize> = Vec::new();
    let mut uses: Vec<Vec<usize>> = vec![Vec::new(); definitions.len()];
    for (k, definition) in definitions.iter().enumerate() {
        let mentioned = mentioned_definitions(definition);
        missing.push(mentioned.len());
        for used in mentioned {
            if let Some(uses) = uses.get_mut(used) {
                uses.push(k);
            }
        }
    }
    let mut order: Vec<usize> = (0..definitions.len()).filter(|k| missing.get(*k) == Some(&0)).collect();
    let mut next = 0;
    while let Some(k) = order.get(next).copied() {
        next += 1;
        for user in uses.get(k).into_iter().flatten() {
            if let Some(count) = missing.get_mut(*user) {
                *count -= 1;
                if *count == 0 {
                    order.push(*user);
                }
            }
        }
    }
    order.into_iter().filter_map(|k| definitions.get(k)).collect()
}

/// Infers from all uses. Uses that determine the dimension of a single name are first; the others are then
/// compared with them.
fn solve_dimensions<'a>(places: DimensionedExpressions<'a>, inference: &mut Inference<'a>) {
    type Tasks<'a> = Vec<ExpressionWithDimension<'a>>;
    let partition_simple_tasks = |tasks: Tasks<'a>| -> (Tasks<'a>, Tasks<'a>) {
        tasks
            .into_iter()
            .partition(|task| task.locals.is_empty() && is_product_with_single_name(task.e, inference))
    };
    let ((mut first, definitions), (places_first, others)) =
        (partition_simple_tasks(places.definitions), partition_simple_tasks(places.tasks));
    first.extend(places_first);
    first.into_iter().chain(definitions).for_each(|task| infer_dimensions_of_task(task, inference));
    places.points.into_iter().for_each(|e| inference.infer_point(e));
    others.into_iter().for_each(|task| infer_dimensions_of_task(task, inference));
}

/// Infers dimensions from one expression and its expected dimension.
fn infer_dimensions_of_task<'a>(task: ExpressionWithDimension<'a>, inference: &mut Inference<'a>) {
    inference.locals = task.locals;
    let value = inference.equate_with_expected_dimension(
        task.e,
        &task.dimension,
        task.unit,
        DimensionEqualityReason::Place,
    );
    // A definition that is a number is plain, unless its uses require a unit.
    if !matches!(value, InferredUnit::Quantity { .. }) {
        inference.default_to_plain(task.dimension);
    }
    inference.locals.clear();
}

/// Whether an expression is a product with a single name that determines its dimension. Products with
/// coordinates or inputs are excluded.
fn is_product_with_single_name(e: &Expr, inference: &Inference<'_>) -> bool {
    let mut current = e;
    let mut name_count = 0;
    loop {
        let (factor, rest) = match &current.kind {
            ExprKind::Neg(inner) => (None, Some(&**inner)),
            ExprKind::Binary(crate::syntax::BinaryOp::Mul | crate::syntax::BinaryOp::Div, left, right, _) => {
                (Some(&**right), Some(&**left))
            }
            _ => (Some(current), None),
        };
        match factor.map(|f| &f.kind) {
            None | Some(ExprKind::Number(_) | ExprKind::Field(..)) => {}
            Some(ExprKind::Name(name)) => match inference.names.get(name) {
                Some(UnitMeaningOfName::Named(_, UnitSource::Motion | UnitSource::Input)) => return false,
                found => name_count += usize::from(found.is_some()),
            },
            Some(_) => return false,
        }
        match rest {
            Some(rest) => current = rest,
            None => return name_count == 1,
        }
    }
}

/// Returns the notation of a dimension: the notation that the source uses for the name by itself, or the
/// default one.
fn notation_of_dimension(
    inference: &mut Inference<'_>,
    dimension: &Dimension,
    v: UnknownDimensionIndex,
) -> String {
    let known = inference.system.substitute_solved_unknowns(dimension).filter(Dimension::is_known);
    match (known, inference.hints.get(&v)) {
        (None, _) => "any".to_string(),
        _ if inference.limit_exceeded => "any".to_string(),
        (Some(_), Some(hint)) => hint.clone(),
        (Some(dimension), None) => si::unit_of_dimension(&dimension),
    }
}

/// Returns the units of the entries of `q`, `v` and `u`.
fn state_and_input_units(
    model: &Model<'_>,
    coordinates: &NameableCoordinates,
    inference: &mut Inference<'_>,
) -> Units {
    let mut units = Units::default();
    let (q, v) = (&mut units.configuration, &mut units.velocities);
    let push_repeated_unit =
        |list: &mut Vec<String>, unit: &str, n| list.extend(std::iter::repeat_n(unit.to_string(), n));
    for chart in &model.charts {
        match *chart {
            Chart::Ball(..) => {
                push_repeated_unit(q, "1", 4);
                push_repeated_unit(v, "rad/s", 3);
            }
            Chart::Free(..) => {
                push_repeated_unit(q, "m", 3);
                push_repeated_unit(q, "1", 4);
                push_repeated_unit(v, "m/s", 3);
                push_repeated_unit(v, "rad/s", 3);
            }
            Chart::Plain(k, _) => {
                let angle = coordinates.iter().find(|(_, c, _)| c.q == k).is_some_and(|(.., angle)| *angle);
                let (unit, rate) = match inference.names.get(model.configuration.get(k.0).map_or("", |n| n)) {
                    Some(UnitMeaningOfName::Moving(dimension, _)) if !angle => {
                        coordinate_units(dimension.clone(), inference)
                    }
                    _ => ("rad".to_string(), "rad/s".to_string()),
                };
                push_repeated_unit(q, &unit, 1);
                push_repeated_unit(v, &rate, 1);
            }
        }
    }
    for k in model.speeds.iter().flat_map(|speeds| &speeds.replaced) {
        let name = model.velocities.get(k.0).map_or("", |(name, _)| name);
        if let (Some(UnitMeaningOfName::Named(v, _)), Some(unit)) =
            (inference.names.get(name), units.velocities.get_mut(k.0))
        {
            *unit = generalized_speed_unit(*v, inference);
        }
    }
    for (name, input) in &model.inputs {
        if let InputEffect::Sum(_, unit) = input {
            units.inputs.push(unit.to_string());
            continue;
        }
        let dimension = match inference.names.get(name) {
            Some(UnitMeaningOfName::Moving(dimension, _)) => dimension.clone(),
            _ => dimension::PLAIN,
        };
        units.inputs.push(input_unit(&dimension, inference));
    }
    units
}

/// Returns the units of a coordinate and of its rate.
fn coordinate_units(dimension: Dimension, inference: &mut Inference<'_>) -> (String, String) {
    let v = dimension.unknown.first().map_or(UnknownDimensionIndex::MAX, |(v, _)| *v);
    let unit = notation_of_dimension(inference, &dimension, v);
    let rate = match unit.as_str() {
        "any" => "any".to_string(),
        "rad" => "rad/s".to_string(),
        _ => {
            let rate = dimension
                .dimension_of_quotient(&dimension::TIME)
                .and_then(|rate| inference.system.substitute_solved_unknowns(&rate));
            rate.map_or("any".to_string(), |rate| si::unit_of_dimension(&rate))
        }
    };
    (unit, rate)
}

/// Returns the unit of a generalized speed as text.
fn generalized_speed_unit(v: UnknownDimensionIndex, inference: &mut Inference<'_>) -> String {
    let dimension = Dimension::unknown_dimension(v);
    match inference.system.substitute_solved_unknowns(&dimension) {
        Some(known) if known == dimension::RATE && !inference.limit_exceeded => "rad/s".to_string(),
        _ => notation_of_dimension(inference, &dimension, v),
    }
}

/// Returns the units of a constraint and of its multiplier. The product of multiplier and rate is a power.
fn constraint_units(c: &Constraint<'_>, sides: &[Dimension], inference: &mut Inference<'_>) -> [String; 2] {
    let configurations = c.residual.is_some();
    let (length, angle, work) = match configurations {
        true => (dimension::LENGTH, dimension::PLAIN, dimension::ENERGY),
        false => (dimension::SPEED, dimension::RATE, dimension::POWER),
    };
    let dimension = match c.measure {
        MeasuredQuantity::Length => Some(length),
        MeasuredQuantity::Angle => Some(angle.clone()),
        MeasuredQuantity::Declared(k) => {
            sides.get(k).and_then(|side| inference.system.substitute_solved_unknowns(side))
        }
    };
    let known = dimension.filter(|d| d.is_known() && !inference.limit_exceeded);
    let Some((dimension, multiplier)) =
        known.and_then(|d| Some((d.clone(), work.dimension_of_quotient(&d)?)))
    else {
        return ["any".to_string(), "any".to_string()];
    };
    let unit = match (dimension == angle, configurations) {
        (true, true) => "rad".to_string(),
        (true, false) => "rad/s".to_string(),
        _ => si::unit_of_dimension(&dimension),
    };
    [unit, si::unit_of_dimension(&multiplier)]
}

/// Returns the unit of an input; for a motor of a joint, that of its force or torque.
fn input_unit(dimension: &Dimension, inference: &mut Inference<'_>) -> String {
    match dimension.unknown.first() {
        Some((v, _)) => notation_of_dimension(inference, dimension, *v),
        None if dimension.is_plain() => "N·m".to_string(),
        None => "N".to_string(),
    }
}
