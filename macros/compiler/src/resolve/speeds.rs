//! Generalized speeds declared by the user: invertible linear combinations of the joint velocities.

use super::scope::{AllowedQuantities, Context, Scope};
use crate::diag::{Diagnostics, Place, join_names_with_and};
use crate::expr::Expr;
use crate::expr::replace::substitute_symbols;
use crate::kinematics::{speeds, symbols_in, velocity_gradient};
use crate::language::Key;
use crate::mechanism::{InV, Model, Pose, Quantity, Speeds};
use crate::syntax::{self, ExprKind, Name};

/// Declared generalized speed, with its coefficients of all velocities.
struct DeclaredSpeed<'a, 'g> {
    name: &'a Name,
    value: &'a syntax::Expr,
    row: Vec<Expr<'g>>,
}

/// Resolves the declared generalized speeds. Returns them with the velocities of the model that they replace,
/// renamed; `None` after an error.
pub fn resolve_speeds<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    cx: &mut Diagnostics,
) -> Option<(Speeds<'g>, Vec<(String, Place)>)> {
    let d = scope.description;
    let declared: Vec<DeclaredSpeed<'_, 'g>> = d
        .speeds
        .iter()
        .filter_map(|name| {
            let definition = d.definitions.iter().find(|definition| definition.name.text == name.text)?;
            let row = speed_coefficients(scope, model, name, &definition.value, cx)?;
            Some(DeclaredSpeed { name, value: &definition.value, row })
        })
        .collect();
    if !cx.is_empty() {
        return None;
    }
    replace_velocities(model, &declared, cx)
}

/// Returns the speeds, and the velocities of the model with the names of the speeds.
fn replace_velocities<'g>(
    model: &Model<'g>,
    declared: &[DeclaredSpeed<'_, 'g>],
    cx: &mut Diagnostics,
) -> Option<(Speeds<'g>, Vec<(String, Place)>)> {
    let rows: Vec<Vec<Expr<'g>>> = declared.iter().map(|speed| speed.row.clone()).collect();
    let columns = speeds::nonzero_columns(model, &rows);
    if !check_speeds(model, declared, &rows, &columns, cx) {
        return None;
    }
    let nv = model.nv();
    let block: Vec<Vec<Expr<'g>>> =
        rows.iter().map(|row| columns.iter().map(|k| row[*k]).collect()).collect();
    let Some(inverse) = speeds::inverse_of_speed_matrix(model, &block) else {
        let limit = speeds::MOST_COUPLED;
        cx.report_error(
            declared[0].value.place.clone(),
            format!("more than {limit} of these speeds depend on each other"),
        )
        .add_help("choose speeds that contain few rates each");
        return None;
    };
    let g = model.graph;
    let identity_entry = |i: usize, j: usize| if i == j { g.one() } else { g.zero() };
    let embed_block_in_identity = |block: &[Vec<Expr<'g>>]| -> Vec<Vec<Expr<'g>>> {
        let position_among_columns = |k: usize| columns.iter().position(|n| *n == k);
        let entry_of_velocity_matrix =
            |i: usize, j: usize| match (position_among_columns(i), position_among_columns(j)) {
                (Some(i), Some(j)) => block[i][j],
                _ => identity_entry(i, j),
            };
        (0..nv).map(|i| (0..nv).map(|j| entry_of_velocity_matrix(i, j)).collect()).collect()
    };
    let mut renamed = model.velocities.clone();
    for (k, speed) in columns.iter().zip(declared) {
        renamed[*k] = (speed.name.text.clone(), speed.name.place.clone());
    }
    let (velocity_to_speed_matrix, rates) =
        (embed_block_in_identity(&block), embed_block_in_identity(&inverse));
    let replaced = columns.into_iter().map(InV).collect();
    let velocities = model.velocities.clone();
    Some((Speeds { velocity_to_speed_matrix, rates, replaced, velocities }, renamed))
}

/// Returns the coefficients of a speed; `None` if it is not a linear combination of rates.
fn speed_coefficients<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    name: &Name,
    value: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<Vec<Expr<'g>>> {
    let g = scope.graph;
    let context = Context::new(AllowedQuantities::Motion, Some((None, Pose::identity(g))));
    let name_expression = syntax::Expr { kind: ExprKind::Name(name.text.clone()), place: name.place.clone() };
    let e = scope.call_in_context(context, |scope| scope.resolve_scalar(&name_expression, cx))?;
    let source_place_of_value = || value.place.clone();
    let mut row = vec![g.zero(); model.nv()];
    velocity_gradient(e).into_iter().for_each(|(k, d)| row[k] = d);
    if row.iter().all(|d| d.is_zero()) {
        cx.report_error(source_place_of_value(), "this speed contains no rate").add_help(
            "a speed is a combination of rates: `rate(psi) * sin(theta)`, `dot(omega(body / ground), \
             body.x)`",
        );
        return None;
    }
    let state_name_of_parameter = |k: usize| {
        scope.description.states.iter().find(|(_, parameter)| *parameter == k).map(|(name, _)| &name.text)
    };
    for symbol in symbols_in(&row) {
        let (what, help) = match Quantity::from_symbol(symbol) {
            Quantity::Velocity(_) => (
                "a speed is linear in the rates".to_string(),
                "their coefficients are functions of coordinates and parameters",
            ),
            Quantity::Time => (
                "the coefficients of rates in a speed cannot depend on time".to_string(),
                "displacements, steps and linear systems are measured in the speeds: an `#[output(…)]` \
                 may contain time",
            ),
            Quantity::Input(k) => (
                format!("a speed cannot depend on the input `{}`", model.inputs[k].0),
                "it is a linear combination of rates whose coefficients depend on coordinates and \
                 parameters",
            ),
            Quantity::Parameter(k) => match state_name_of_parameter(k) {
                Some(state) => (
                    format!("a speed cannot depend on the state `{state}`"),
                    "it is a linear combination of rates whose coefficients depend on coordinates and \
                     parameters",
                ),
                None => continue,
            },
            _ => continue,
        };
        cx.report_error(source_place_of_value(), what).add_help(help);
        return None;
    }
    let at_rest = substitute_symbols(e, &|s| {
        matches!(Quantity::from_symbol(s), Quantity::Velocity(_)).then(|| g.zero())
    });
    let remainder = [vec![at_rest]];
    if !at_rest.is_zero() && !speeds::nonzero_columns(model, &remainder.to_vec()).is_empty() {
        cx.report_error(source_place_of_value(), "a speed cannot have a term without rates").add_help(
            "speeds are velocities and zero at rest: take the rates relative to the moving frame, or \
             declare an `#[output(…)]`",
        );
        return None;
    }
    Some(row)
}

/// Returns whether the speeds are independent and as many as the velocities that they replace; reports an
/// error otherwise.
fn check_speeds<'g>(
    model: &Model<'g>,
    declared: &[DeclaredSpeed<'_, 'g>],
    rows: &Vec<Vec<Expr<'g>>>,
    columns: &[usize],
    cx: &mut Diagnostics,
) -> bool {
    let list_velocity_names = |indices: &[usize]| {
        let names: Vec<String> = indices.iter().map(|k| format!("`{}`", model.velocities[*k].0)).collect();
        join_names_with_and(&names)
    };
    let (count, all) = (declared.len(), columns.len());
    let last = &declared[count - 1];
    if let Some(k) = speeds::index_of_first_dependent_row(model, rows) {
        let speed = &declared[k];
        let what = match k {
            0 => format!("the speed `{}` is zero in every motion", speed.name.text),
            _ => format!("the speed `{}` depends on the speeds before it", speed.name.text),
        };
        cx.report_error(speed.value.place.clone(), what)
            .add_help("speeds are independent combinations of the rates, which determine the rates");
        return false;
    }
    if count < all {
        let verb = if count == 1 { "names" } else { "name" };
        let subject = if count == 1 { "one speed" } else { &format!("{count} speeds") };
        let rate = &model.velocities[columns[all - 1]].0;
        cx.report_error(
            last.name.place.clone(),
            format!("{subject} {verb} {all} velocities: {}", list_velocity_names(columns)),
        )
        .add_help(format!(
            "speeds replace all velocities that they contain: declare the same number of speeds, for \
             example one for `{rate}` itself, `#[speed(rate({rate}))] {}_rate: Speed`",
            rate.replace('.', "_")
        ));
        return false;
    }
    let bounded = model.limits.iter().find_map(|limit| {
        let key = limit.speed.map(|_| Key::MaxSpeed).or(limit.effort.map(|_| Key::MaxEffort))?;
        columns.contains(&limit.v.0).then_some((limit.v.0, key))
    });
    if let Some((k, key)) = bounded {
        let (rate, what) = (
            list_velocity_names(&[k]),
            if key == Key::MaxSpeed { "the rate" } else { "the force on the rate" },
        );
        cx.report_error(
            declared[0].name.place.clone(),
            format!("speeds replace the rate of {rate}, which has a `{}`", key.name()),
        )
        .add_help(format!(
            "it bounds {what} of {rate}, which is no longer a velocity: remove it, or choose speeds that \
             keep this rate; bounds `from` and `to` of the coordinate are allowed"
        ));
        return false;
    }
    true
}
