//! Conversion of constraints to scalar rows: joints that close loops, expressions that remain zero, rolling
//! and slipping pairs. Each row has its rate and the time derivative of the rate. Motions are relative to the
//! nearest link that carries both ends, so that their common motion cancels.

use super::contact::{report_surface_pair_errors, rolling_rows, slipping_rows};
use super::corrections;
use super::rows::{ConstraintRows, constraint_from_residual_and_rate};
use super::scope::{AllowedQuantities, Context, Scope, Value};
use crate::diag::Diagnostics;
use crate::expr::eval::eval_one;
use crate::expr::replace::substitute_symbols;
use crate::expr::sample::{always_equals_number, sample_of_symbol};
use crate::expr::{Expr, Vec3};
use crate::kinematics::{AXES, symbols_in, time_derivative, velocity_gradient};
use crate::language::{Callable, FunctionId};
use crate::mechanism::{MeasuredQuantity, Model, Pose, Quantity};
use crate::syntax::{self, ConstraintKind, ExprKind};

/// Returns the rows of a declared constraint, the `index`-th; `None` after an error.
pub fn resolve_constraint<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    (index, constraint): (usize, &syntax::Constraint),
    cx: &mut Diagnostics,
) -> Option<ConstraintRows<'g>> {
    let measure = MeasuredQuantity::Declared(index);
    match constraint.kind {
        ConstraintKind::Holonomic => holonomic_rows(scope, constraint, measure, cx),
        ConstraintKind::Nonholonomic => nonholonomic_rows(scope, constraint, measure, cx),
        ConstraintKind::Rolling => rolling_rows(scope, model, constraint, cx),
        ConstraintKind::Slipping => slipping_rows(scope, model, constraint, cx),
    }
}

/// Returns the rows of a constraint on configurations; `None` after an error.
fn holonomic_rows<'g>(
    scope: &Scope<'_, 'g>,
    constraint: &syntax::Constraint,
    measure: MeasuredQuantity,
    cx: &mut Diagnostics,
) -> Option<ConstraintRows<'g>> {
    scope.records.borrow_mut().in_holonomic_constraint = true;
    let rows = difference_of_constraint_sides(scope, constraint, AllowedQuantities::Placement, cx);
    scope.records.borrow_mut().in_holonomic_constraint = false;
    let (components, redundant) = split_off_vanishing_components(rows);
    let mut rows = Vec::new();
    for (name, residual) in components {
        if symbols_in(&[residual]).iter().all(|s| matches!(Quantity::from_symbol(*s), Quantity::Parameter(_)))
        {
            cx.report_error(constraint.value.place.clone(), "this does not constrain any coordinate")
                .add_help("a holonomic constraint sets an expression of coordinates to zero, or equal to another one");
            return None;
        }
        let rate = time_derivative(scope.configuration_space(), residual);
        rows.push(constraint_from_residual_and_rate(
            scope,
            (name, &constraint.name.place),
            measure,
            Some(residual),
            rate,
        ));
    }
    Some(ConstraintRows { rows, redundant, ..ConstraintRows::default() })
}

/// Resolves a constraint, only to report its errors.
pub fn report_constraint_errors<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    constraint: &syntax::Constraint,
    cx: &mut Diagnostics,
) {
    let holonomic = constraint.kind == ConstraintKind::Holonomic;
    match constraint.kind {
        ConstraintKind::Holonomic | ConstraintKind::Nonholonomic => {
            scope.records.borrow_mut().in_holonomic_constraint = holonomic;
            let allowed = if holonomic { AllowedQuantities::Placement } else { AllowedQuantities::Motion };
            let _ = difference_of_constraint_sides(scope, constraint, allowed, cx);
            scope.records.borrow_mut().in_holonomic_constraint = false;
        }
        ConstraintKind::Rolling | ConstraintKind::Slipping => {
            report_surface_pair_errors(scope, model, constraint, cx)
        }
    }
}

/// Returns the rows of a constraint on velocities; `None` after an error.
fn nonholonomic_rows<'g>(
    scope: &Scope<'_, 'g>,
    constraint: &syntax::Constraint,
    measure: MeasuredQuantity,
    cx: &mut Diagnostics,
) -> Option<ConstraintRows<'g>> {
    let (components, redundant) = split_off_vanishing_components(difference_of_constraint_sides(
        scope,
        constraint,
        AllowedQuantities::Motion,
        cx,
    ));
    let mut rows = Vec::new();
    for (name, rate) in components {
        let place = &constraint.value.place;
        let gradient = velocity_gradient(rate);
        let coefficients: Vec<Expr<'g>> = gradient.iter().map(|(_, c)| *c).collect();
        let uses_quantity_where = |e: &[Expr<'g>], f: fn(Quantity) -> bool| {
            symbols_in(e).into_iter().any(|s| f(Quantity::from_symbol(s)))
        };
        if gradient.is_empty() {
            cx.report_error(place.clone(), "this does not constrain any velocity")
                .add_help("a constraint on coordinates is a `Holonomic` one");
            return None;
        }
        if uses_quantity_where(&[rate], |q| matches!(q, Quantity::Input(_))) {
            cx.report_error(place.clone(), "a constraint contains no input")
                .add_help("a prescribed motion is an expression of time `t`");
            return None;
        }
        let linear = match uses_quantity_where(&coefficients, |q| matches!(q, Quantity::Velocity(_))) {
            true => remove_cancelling_velocities(rate, &gradient),
            false => Some(rate),
        };
        let Some(linear) = linear else {
            cx.report_error(place.clone(), "this constraint is not linear in the velocities").add_help(
                "each term contains at most one velocity, as in `dot(v(skate / ground / ground), \
                 sled.y)`",
            );
            return None;
        };
        rows.push(constraint_from_residual_and_rate(
            scope,
            (name, &constraint.name.place),
            measure,
            None,
            linear,
        ));
    }
    Some(ConstraintRows { rows, redundant, ..ConstraintRows::default() })
}

/// Returns the left side minus the right side: one component, or three with names.
fn difference_of_constraint_sides<'g>(
    scope: &Scope<'_, 'g>,
    constraint: &syntax::Constraint,
    allowed: AllowedQuantities,
    cx: &mut Diagnostics,
) -> Vec<(String, Expr<'g>)> {
    let name = &constraint.name.text;
    let ground_axes_context = || Context::new(allowed, Some((None, Pose::identity(scope.graph))));
    let is_angle_expression = |e: &syntax::Expr| match &e.kind {
        ExprKind::Call(word, _) => word.id == Some(Callable::Function(FunctionId::Angle)),
        _ => scope.is_angle(e),
    };
    let pair = [Some(&constraint.value), constraint.other.as_ref()];
    for (side, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
        if let (Some(side), Some(other)) = (side, other)
            && allowed == AllowedQuantities::Placement
            && is_angle_expression(side)
            && !corrections::check_angle(other, cx)
        {
            return Vec::new();
        }
    }
    let left =
        scope.call_in_context(ground_axes_context(), |scope| scope.resolve_value(&constraint.value, cx));
    if left.is_none() {
        // Report the errors of the other side as well.
        if let Some(other) = &constraint.other {
            let _ = scope.call_in_context(ground_axes_context(), |scope| scope.resolve_value(other, cx));
        }
        return Vec::new();
    }
    let vector = matches!(left, Some(Value::Vector(_)));
    let mut sides = vec![&constraint.value];
    sides.extend(&constraint.other);
    if !vector {
        let values: Vec<Option<Expr<'g>>> = sides
            .iter()
            .map(|e| scope.call_in_context(ground_axes_context(), |scope| scope.resolve_scalar(e, cx)))
            .collect();
        return match values.as_slice() {
            [Some(left), Some(right)] => vec![(name.clone(), *left - *right)],
            [Some(left)] => vec![(name.clone(), *left)],
            _ => Vec::new(),
        };
    }
    let terms: Vec<_> = sides
        .iter()
        .map(|e| scope.call_in_context(ground_axes_context(), |scope| scope.resolve_vector_terms(e, cx)))
        .collect();
    let Some(terms) = terms.into_iter().collect::<Option<Vec<_>>>() else { return Vec::new() };
    let kinematics = &scope.kinematics;
    let zero = Vec3::zero(scope.graph);
    let sides: Vec<Vec3<'g>> =
        terms.iter().map(|t| kinematics.components_in_link_axes(t, None, zero)).collect();
    let gap = sides.get(1).map_or(sides[0], |right| sides[0] - *right);
    (0..3).map(|k| (format!("{name}.{}", AXES[k]), gap[k])).collect()
}

/// Separates the components of a vector that vanish identically, such as the component normal to the plane of
/// a planar mechanism. Returns the other components and the names of the vanishing ones; if all vanish, all
/// are returned.
fn split_off_vanishing_components<'g>(
    rows: Vec<(String, Expr<'g>)>,
) -> (Vec<(String, Expr<'g>)>, Vec<String>) {
    let is_identically_zero = |e: &Expr<'g>| {
        let is_parameter = |q: Quantity| matches!(q, Quantity::Parameter(_));
        symbols_in(&[*e]).into_iter().all(|s| is_parameter(Quantity::from_symbol(s)))
            && always_equals_number(*e, 0.0)
    };
    let (vanishing, remaining): (Vec<_>, Vec<_>) =
        rows.into_iter().partition(|(_, e)| is_identically_zero(e));
    if remaining.is_empty() {
        return (vanishing, Vec::new());
    }
    (remaining, vanishing.into_iter().map(|(name, _)| name).collect())
}

/// Removes velocities from the coefficients of a linear constraint if the coefficients contain velocities but
/// do not depend on them. Returns `None` if they depend on velocities.
fn remove_cancelling_velocities<'g>(rate: Expr<'g>, gradient: &[(usize, Expr<'g>)]) -> Option<Expr<'g>> {
    // Signs and corner points of the velocities reveal sign changes, of all velocities together or of some.
    let evaluate_at_signed_velocities = |e: Expr<'g>, pattern: u64| {
        eval_one(e, &|s| match Quantity::from_symbol(s) {
            Quantity::Velocity(k) if pattern >> (k % 64) & 1 == 1 => -sample_of_symbol(s, pattern),
            Quantity::Velocity(_) => sample_of_symbol(s, pattern),
            _ => sample_of_symbol(s, 0),
        })
    };
    let is_independent_of_velocities = |e: Expr<'g>| {
        let first = evaluate_at_signed_velocities(e, 0);
        let is_close = |x: f64| (x - first).abs() <= 1e-9 * (1.0 + first.abs());
        first.is_finite()
            && [1, 2, 0x5555_5555, 0xAAAA_AAAA, u64::MAX]
                .iter()
                .all(|p| is_close(evaluate_at_signed_velocities(e, *p)))
    };
    let substitute_velocities = |e: Expr<'g>, value: f64| {
        substitute_symbols(e, &|s| {
            matches!(Quantity::from_symbol(s), Quantity::Velocity(_)).then(|| e.num(value))
        })
    };
    let remainder = substitute_velocities(rate, 0.0);
    if !gradient.iter().all(|(_, c)| is_independent_of_velocities(*c))
        || !evaluate_at_signed_velocities(remainder, 0).is_finite()
    {
        return None;
    }
    let g = rate.graph();
    Some(
        gradient.iter().fold(remainder, |sum, (k, c)| {
            sum + substitute_velocities(*c, 1.0) * Quantity::Velocity(*k).expr(g)
        }),
    )
}
