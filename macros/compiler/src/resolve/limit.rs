//! Conversion of limits to bounds of the entries of `q` and `v`. All limits of one entry apply
//! simultaneously.

use super::scope::Scope;
use super::target::resolve_limited_coordinate;
use crate::diag::Diagnostics;
use crate::expr::{Expr as Value, Extreme};
use crate::language::Key;
use crate::mechanism::{Coordinate, CoordinateLimits, Model};
use crate::syntax;

/// Returns the bounds of all limits.
pub fn resolve_limits<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    cx: &mut Diagnostics,
) -> Vec<CoordinateLimits<'g>> {
    let (mut limits, mut known) = (Vec::new(), Vec::new());
    for limit in &scope.description.limits {
        if scope.is_moving_expression(&limit.on) {
            report_stop_errors(scope, limit, cx);
            continue;
        }
        let Some((coordinate, angle)) = resolve_limited_coordinate(scope, &limit.on, cx) else { continue };
        let bounds = resolve_limit_bounds(scope, limit, angle == Some(true), cx)
            .filter(|bounds| check_bounds(limit, bounds, cx));
        if let Some(bounds) = bounds {
            let found = coordinate_limit_from_bounds(scope, &coordinate, bounds);
            add_coordinate_bounds((&mut limits, model), limit, found, &known, cx);
            known.push((limit, found));
        }
    }
    limits
}

/// Adds bounds of a coordinate, and reports bounds that contradict one of the `earlier` limits.
fn add_coordinate_bounds<'g>(
    (limits, model): (&mut Vec<CoordinateLimits<'g>>, &Model<'g>),
    limit: &syntax::Limit,
    found: CoordinateLimits<'g>,
    earlier: &[(&syntax::Limit, CoordinateLimits<'g>)],
    cx: &mut Diagnostics,
) {
    let Some(known) = limits.iter_mut().find(|known| known.v == found.v) else {
        limits.push(found);
        return;
    };
    let both = tighter_bounds(known, &found);
    let is_range_nonempty =
        |limit: &CoordinateLimits<'_>| range_width(limit).is_none_or(|range_width| range_width > 0.0);
    if is_range_nonempty(known) && is_range_nonempty(&found) && !is_range_nonempty(&both) {
        let name = model.velocities.get(found.v.0).map_or("", |(name, _)| name.as_str());
        let contradicts_found_limit = |(_, other): &&(&syntax::Limit, CoordinateLimits<'g>)| {
            other.v == found.v && !is_range_nonempty(&tighter_bounds(other, &found))
        };
        let other = earlier.iter().find(contradicts_found_limit).map(|(other, _)| *other);
        // If both limits are from a file, the one that does not belong to the coordinate itself is
        // reported.
        let own = limit.name.text == name;
        let follower = if own { other.unwrap_or(limit) } else { limit };
        let place = if limit.on.place.file.is_some() { &follower.name.place } else { &limit.on.place };
        let error = cx.report_error(place.clone(), format!("the limits of `{name}` exclude every value"));
        match follower.name.text == name || limit.on.place.file.is_none() {
            true => error.add_help("all limits of a coordinate apply, including those of a file"),
            false => error.add_help(format!(
                "`{}` follows it and has its own limits; to ignore limits, write `#[mechanism(…, limits \
                 = ignore)]`",
                follower.name.text
            )),
        };
    }
    *known = both;
}

/// Reads the limit of an expression, which is a stop, only to report its errors.
fn report_stop_errors<'g>(scope: &Scope<'_, 'g>, limit: &syntax::Limit, cx: &mut Diagnostics) {
    let given = &limit.arguments;
    if let Some((key, e)) =
        [Key::MaxSpeed, Key::MaxEffort].iter().find_map(|key| Some((key, given.expression_of_key(*key)?)))
    {
        let name = key.name();
        let message = format!("`{name}` applies to a coordinate, but this is an expression");
        cx.report_error(e.place.clone(), message).add_help("write it in a limit of the joint");
    } else if given.expression_of_key(Key::Restitution).is_none() {
        cx.report_error(limit.on.place.clone(), "a limit of an expression is a stop and needs a restitution").add_help(
            "add `restitution = e`, from 0 to 1: the ratio of the speeds after and before the impact on the bound",
        );
    } else if let Some(bounds) = resolve_limit_bounds(scope, limit, false, cx) {
        check_bounds(limit, &bounds, cx);
    }
}

/// Returns the values of the four bounds; `None` after an error.
fn resolve_limit_bounds<'g>(
    scope: &Scope<'_, 'g>,
    limit: &syntax::Limit,
    angle: bool,
    cx: &mut Diagnostics,
) -> Option<[Option<Value<'g>>; 4]> {
    let mut good = true;
    let bounds = [Key::From, Key::To, Key::MaxSpeed, Key::MaxEffort].map(|key| {
        let e = limit.arguments.expression_of_key(key)?;
        let angle = angle && matches!(key, Key::From | Key::To);
        // Angles in a file are in radians, without a limit on revolutions.
        let value = match angle && e.place.file.is_none() {
            true => scope.resolve_angle_in_radians(e, cx),
            false => scope.resolve_scalar(e, cx),
        };
        good &= value.is_some();
        value
    });
    good.then_some(bounds)
}

/// Converts bounds of `ratio × q + offset` to bounds of the coordinate `q`.
fn coordinate_limit_from_bounds<'g>(
    scope: &Scope<'_, 'g>,
    c: &Coordinate,
    [from, to, speed, effort]: [Option<Value<'g>>; 4],
) -> CoordinateLimits<'g> {
    let number_expression = |x: f64| scope.graph.num(x);
    let convert_bound_to_coordinate =
        |bound: Value<'g>| (bound - number_expression(c.offset)) / number_expression(c.ratio);
    let (from, to) = (from.map(convert_bound_to_coordinate), to.map(convert_bound_to_coordinate));
    let (lower, upper) = if c.ratio < 0.0 { (to, from) } else { (from, to) };
    let speed = speed.map(|speed| speed / number_expression(c.ratio.abs()));
    let effort = effort.map(|effort| effort * number_expression(c.ratio.abs()));
    CoordinateLimits { q: c.q, v: c.v, lower, upper, speed, effort }
}

/// Returns the tighter bounds of two limits of one coordinate.
fn tighter_bounds<'g>(known: &CoordinateLimits<'g>, found: &CoordinateLimits<'g>) -> CoordinateLimits<'g> {
    let tighter_bound = |which: Extreme, a: Option<Value<'g>>, b: Option<Value<'g>>| match (a, b) {
        (Some(a), Some(b)) => Some(a.minimum_or_maximum(which, b)),
        (a, b) => a.or(b),
    };
    CoordinateLimits {
        lower: tighter_bound(Extreme::Max, known.lower, found.lower),
        upper: tighter_bound(Extreme::Min, known.upper, found.upper),
        speed: tighter_bound(Extreme::Min, known.speed, found.speed),
        effort: tighter_bound(Extreme::Min, known.effort, found.effort),
        ..*found
    }
}

/// Returns the distance between the bounds of a coordinate, if both are constant.
fn range_width(limit: &CoordinateLimits<'_>) -> Option<f64> {
    Some(limit.upper?.constant_value()? - limit.lower?.constant_value()?)
}

/// Reports bounds of a limit that no motion satisfies. Returns false in that case.
fn check_bounds(limit: &syntax::Limit, bounds: &[Option<Value<'_>>; 4], cx: &mut Diagnostics) -> bool {
    let [from, to, speed, effort] = bounds.map(|bound| bound.and_then(|bound| bound.constant_value()));
    if let (Some(low), Some(high), Some(e)) = (from, to, limit.arguments.expression_of_key(Key::To))
        && low > high
    {
        cx.report_error(e.place.clone(), format!("`to` is {high}, less than `from`, which is {low}"))
            .add_help("`from` is the lower bound, `to` the upper one");
        return false;
    }
    for (key, value) in [(Key::MaxSpeed, speed), (Key::MaxEffort, effort)] {
        let written = limit.arguments.expression_of_key(key);
        if let (Some(value), Some(e)) = (value.filter(|value| *value < 0.0), written) {
            cx.report_error(
                e.place.clone(),
                format!("a `{}` cannot be negative, but it is {value}", key.name()),
            )
            .add_help("it bounds both directions: write its magnitude");
            return false;
        }
    }
    true
}
