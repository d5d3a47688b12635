//! Lengths and angles on which force elements act, and energies and dissipation functions given as
//! expressions.

use super::element_forces::ElementForces;
use super::scope::{AllowedQuantities, Context, Scope};
use crate::diag::Diagnostics;
use crate::expr::eval::eval;
use crate::expr::sample::sample_of_symbol;
use crate::expr::{Expr, Vec3};
use crate::kinematics::{coordinate_as_expression, symbols_in, time_derivative, velocity_gradient};
use crate::mechanism::{Coordinate, Model, Pose, Quantity};
use crate::syntax::{self, ExprKind};

/// Length or angle on which a force element acts, with its rate.
pub struct StretchWithRate<'g> {
    /// Value of the length or angle, m or rad.
    pub value: Expr<'g>,
    /// Rate of the length or angle, linear in the velocities.
    pub rate: Expr<'g>,
    /// Square of the length.
    pub square: Expr<'g>,
    /// Whether the value is the signed coordinate along a fixed line; the length is then its magnitude.
    pub signed: bool,
}

/// The length or the angle on which a force element acts.
pub struct ForceElementCoordinate<'g> {
    /// Value and rate of the length or the angle; `None` for a coordinate.
    pub stretch: Option<StretchWithRate<'g>>,
    /// Whether it is an angle; `None` if it may also be a length.
    pub angle: Option<bool>,
    /// Coordinate on which the element acts; `None` for a length.
    pub coordinate: Option<Coordinate>,
}

impl<'g> ForceElementCoordinate<'g> {
    /// Returns the value and the rate of the length or the angle.
    pub fn stretch(self, scope: &Scope<'_, 'g>) -> Option<StretchWithRate<'g>> {
        self.stretch.or_else(|| self.coordinate.map(|c| coordinate_stretch(scope, &c)))
    }
}

/// Resolves a potential energy given as an expression.
pub fn resolve_potential_energy<'g>(
    scope: &Scope<'_, 'g>,
    e: &syntax::Expr,
    cx: &mut Diagnostics,
) -> ElementForces<'g> {
    let context = Context::new(AllowedQuantities::Placement, Some((None, Pose::identity(scope.graph))));
    ElementForces::forces_of_potentials(scope.call_in_context(context, |scope| scope.resolve_scalar(e, cx)))
}

/// Resolves a dissipation function given as an expression.
pub fn resolve_dissipation<'g>(
    scope: &Scope<'_, 'g>,
    e: &syntax::Expr,
    cx: &mut Diagnostics,
) -> ElementForces<'g> {
    let context = Context::new(AllowedQuantities::Motion, Some((None, Pose::identity(scope.graph))));
    let function = scope.call_in_context(context, |scope| scope.resolve_scalar(e, cx));
    // Zero is not an error: the bodies may be welded together.
    if function.is_some_and(|f| !f.is_zero() && velocity_gradient(f).is_empty()) {
        cx.report_error(e.place.clone(), "this contains no velocity, and has no effect").add_help(
            "dissipation is a function of rates, half the dissipated power: `c / 2 * rate(hinge) * \
             rate(hinge)`",
        );
    }
    ElementForces { dissipations: function.into_iter().collect(), ..ElementForces::default() }
}

/// Reports errors of definitions, also of those without uses.
pub fn report_definition_errors(scope: &Scope<'_, '_>, cx: &mut Diagnostics) {
    for definition in &scope.description.definitions {
        let context = Context::new(AllowedQuantities::Reaction, Some((None, Pose::identity(scope.graph))));
        let name = ExprKind::Name(definition.name.text.clone());
        let e = syntax::Expr { kind: name, place: definition.name.place.clone() };
        let _ = scope.call_in_context(context, |scope| scope.resolve_value(&e, cx));
    }
}

/// Sets the quantities on which the signatures of the generated functions depend.
pub fn set_signature_dependencies(m: &mut Model<'_>) {
    let mut all: Vec<Expr<'_>> = m.potentials.iter().chain(&m.dissipations).copied().collect();
    all.extend(m.loads.iter().flat_map(|l| [l.rate, l.force]));
    all.extend(m.inertances.iter().flat_map(|i| [i.rate, i.inertance]));
    for force in &m.acceleration_forces {
        all.push(force.rate);
        all.extend(force.factors.iter().map(|(_, factor)| *factor));
    }
    all.extend(m.constraints.iter().flat_map(|c| c.residual.into_iter().chain([c.rate])));
    all.extend(m.constraints.iter().flat_map(|c| c.friction.iter().map(|d| d.share)));
    all.extend(m.outputs.iter().flat_map(|o| o.values.iter().copied()));
    all.extend(m.links.iter().flat_map(|link| link.placement.all_expressions()));
    let time = symbols_in(&all).into_iter().any(|s| Quantity::from_symbol(s) == Quantity::Time);
    let by_velocity = m.loads.iter().any(|load| {
        let symbols: Vec<Quantity> =
            symbols_in(&[load.force]).into_iter().map(Quantity::from_symbol).collect();
        symbols.iter().any(|q| matches!(q, Quantity::Input(_)))
            && symbols.iter().any(|q| matches!(q, Quantity::Velocity(_)))
    });
    m.time = time;
    m.velocity_inputs = by_velocity;
}

/// Returns the stretch of a coordinate.
pub fn coordinate_stretch<'g>(scope: &Scope<'_, 'g>, c: &Coordinate) -> StretchWithRate<'g> {
    let g = scope.graph;
    let value = coordinate_as_expression(g, c);
    StretchWithRate { value, square: value.square(), rate: c.v.expr(g) * g.num(c.ratio), signed: false }
}

/// Returns a length or an angle given by an expression of the coordinates, such as the length of a cable.
pub fn stretch_from_expression<'g>(
    scope: &Scope<'_, 'g>,
    e: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<StretchWithRate<'g>> {
    let stretch = value_and_rate_of_expression(scope, e, cx)?;
    if velocity_gradient(stretch.rate).is_empty() {
        let message = "this contains no coordinate: a force on it has no effect";
        cx.report_error(e.place.clone(), message).add_help(
            "an element acts on a length or an angle that changes with the motion, such as `norm(r(a / \
             b))`",
        );
        return None;
    }
    Some(stretch)
}

/// Returns the value and the rate of an expression of positions, which may be constant.
pub fn value_and_rate_of_expression<'g>(
    scope: &Scope<'_, 'g>,
    e: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<StretchWithRate<'g>> {
    let context = Context::new(AllowedQuantities::Placement, Some((None, Pose::identity(scope.graph))));
    let value = scope.call_in_context(context, |scope| scope.resolve_scalar(e, cx))?;
    let rate = time_derivative(scope.configuration_space(), value);
    Some(StretchWithRate { value, rate, square: value.square(), signed: false })
}

/// Returns the distance between two points. If they move along one line, the distance is the signed
/// coordinate along it, which is smooth where they coincide. Otherwise the direction of a zero distance
/// is the zero vector.
pub fn distance_between_points<'g>(
    scope: &Scope<'_, 'g>,
    a: &syntax::Expr,
    b: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<StretchWithRate<'g>> {
    let (first, second) = (scope.resolve_placement(a, cx), scope.resolve_placement(b, cx));
    let (first, second) = (first?, second?);
    if first.link == second.link {
        cx.report_error(b.place.clone(), "these two points do not move relative to each other")
            .add_help("let the element act between points of different bodies");
        return None;
    }
    let kinematics = &scope.kinematics;
    let zero = Vec3::zero(scope.graph);
    let terms = kinematics.position_between(&second, &first);
    let axes = terms.first().and_then(|(link, _)| *link);
    let r = kinematics.components_in_link_axes(&terms, axes, zero);
    // The test for a common line ignores released joints.
    let with_closed_joints = Vec3(scope.with_released_coordinates_zero(&r.0).try_into().unwrap_or(r.0));
    if is_zero_for_all_values(with_closed_joints) {
        cx.report_error(b.place.clone(), "these two points always coincide")
            .add_help("let the element act between points that move relative to each other");
        return None;
    }
    let mut v = kinematics.velocity_of_point(&second);
    v.extend(kinematics.velocity_of_point(&first).into_iter().map(|(link, v)| (link, -v)));
    if let Some(line) = constant_direction(with_closed_joints) {
        let e = Vec3::vector_from_constants(scope.graph, line);
        let rate = e.dot(kinematics.components_in_link_axes(&v, axes, zero));
        let value = r.dot(e);
        return Some(StretchWithRate { value, square: value.square(), rate, signed: true });
    }
    let length = r.regularised_norm();
    let n = r.map(|c| c / length);
    let rate = n.dot(kinematics.components_in_link_axes(&v, axes, zero));
    Some(StretchWithRate { value: length, square: r.dot(r), rate, signed: false })
}

/// Whether a vector is zero for all coordinates and parameters.
fn is_zero_for_all_values(r: Vec3<'_>) -> bool {
    r.is_zero()
        || (0..4).all(|seed| {
            eval(&r.0, &|s| 2.0 * sample_of_symbol(s, seed) - 1.7).iter().all(|c| c.abs() < 1e-14)
        })
}

/// Returns the direction of a vector, if it is the same for all coordinates and parameters.
fn constant_direction(r: Vec3<'_>) -> Option<[f64; 3]> {
    let vector_at_sample_values = |seed| eval(&r.0, &|s| 2.0 * sample_of_symbol(s, seed) - 1.7);
    let first = vector_at_sample_values(0);
    let norm = first.iter().map(|c| c * c).sum::<f64>().sqrt();
    let e = [first[0] / norm, first[1] / norm, first[2] / norm];
    let parallel = (1..5).all(|seed| {
        let v = vector_at_sample_values(seed);
        let along: f64 = (0..3).map(|k| v[k] * e[k]).sum();
        let size = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        (0..3).all(|k| (v[k] - along * e[k]).abs() <= 1e-12 * size)
    });
    // The first nonzero component of the direction is positive.
    let flip = e.iter().find(|c| c.abs() > 1e-9).is_some_and(|c| *c < 0.0);
    let snap_to_zero_or_unit = |c: f64| {
        if c.abs() < 1e-12 {
            0.0
        } else if (c.abs() - 1.0).abs() < 1e-12 {
            c.signum()
        } else {
            c
        }
    };
    (parallel && norm.is_finite() && norm > 0.0)
        .then(|| e.map(|c| snap_to_zero_or_unit(if flip { -c } else { c })))
}
