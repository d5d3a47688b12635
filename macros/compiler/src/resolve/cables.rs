//! Lengths of cables that wrap around spheres and cylinders.

use super::call::Call;
use super::scope::{AllowedQuantities, Context, PlacedElement, Scope, Value};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Extreme, Function, Vec3};
use crate::language::{BodyOrInertiaMethod, SurfaceId};
use crate::mechanism::Rule;
use crate::syntax::{self, ExprKind};
use std::f64::consts::PI;

const SPHERE: Option<BodyOrInertiaMethod> = Some(BodyOrInertiaMethod::Surface(SurfaceId::Sphere));
const CYLINDER: Option<BodyOrInertiaMethod> = Some(BodyOrInertiaMethod::Surface(SurfaceId::Cylinder));
const DRUM: Option<BodyOrInertiaMethod> = Some(BodyOrInertiaMethod::Surface(SurfaceId::Drum));

impl<'g> Scope<'_, 'g> {
    /// Resolves `cable(a / b, drum.cylinder(radius, axis))` and `cable(a / b, ball.sphere(radius))`: the
    /// length of a taut cable between two points, wrapped around the surface if the surface is in its path.
    ///
    /// A cable around a cylinder winds about the axis from `a` to `b`, by less than a full revolution. The
    /// points have the distances `d_a` and `d_b` from the axis and the angle `θ` between them. The angle of
    /// contact is `φ = θ − acos(R / d_a) − acos(R / d_b)`. If it is positive, the cable consists of tangents
    /// and a helix, which is straight on the unrolled cylinder; otherwise the cable is straight.
    pub fn resolve_cable_length(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [points, surface] = call.take_arguments(cx)?;
        let ends = call.take_operands::<2>(points, cx)?;
        if !self.check_allowed_quantity(AllowedQuantities::Placement, "`cable(…)`", call.place, cx) {
            return None;
        }
        let (frame, radius, axis) = self.pose_radius_and_axis_of_surface(surface, cx)?;
        let [a, b] = ends.map(|end| self.placement_of_moving_point(end, cx));
        let (a, b) = (a?, b?);
        let kinematics = &self.kinematics;
        let position_from_center = |p: &PlacedElement<'g>| {
            kinematics.components_in_link_axes(
                &kinematics.position_between(p, &frame),
                frame.link,
                Vec3::zero(self.graph),
            )
        };
        let (a, b) = (position_from_center(&a), position_from_center(&b));
        let (across, rise) = match axis {
            None => ([a, b], self.graph.zero()),
            Some(n) => {
                let n = frame.pose.rotation.vector_in_parent_axes(n);
                let across = [a, b].map(|p| p + -(n * p.dot(n)));
                (across, a.dot(n) - b.dot(n))
            }
        };
        for (end, p) in ends.into_iter().zip(across) {
            report_cable_end_inside(end, p, radius, axis.is_some(), cx)?;
        }
        let [a, b] = across;
        let (sine, cosine) = match axis {
            None => (a.cross(b).regularised_norm(), a.dot(b)),
            Some(n) => (frame.pose.rotation.vector_in_parent_axes(n).dot(a.cross(b)), a.dot(b)),
        };
        // Around a cylinder, between zero and a full revolution.
        let angle = match axis {
            None => sine.atan2(cosine),
            Some(_) => (-sine).atan2(-cosine) + self.graph.num(PI),
        };
        let square = radius.square();
        let tangents = [a, b].map(|p| (p.dot(p) - square).sqrt());
        let contact_angle = tangents.iter().fold(angle, |angle, t| angle - t.atan2(radius));
        let wrapped = tangents[0] + tangents[1] + radius * contact_angle;
        let straight = (a - b).regularised_norm();
        // One if the cable touches, otherwise zero. The derivative is zero.
        let touches = contact_angle
            .apply_function(Function::Signum)
            .minimum_or_maximum(Extreme::Max, self.graph.zero());
        let flat = straight + touches * (wrapped - straight);
        let length = if rise.is_zero() { flat } else { (flat.square() + rise.square()).sqrt() };
        Some(Value::Scalar(length))
    }

    /// Returns the pose, the radius and the axis of a sphere or cylinder; a sphere has no axis.
    fn pose_radius_and_axis_of_surface(
        &self,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<(PlacedElement<'g>, Expr<'g>, Option<Vec3<'g>>)> {
        let ExprKind::Method(base, word, arguments) = &e.kind else {
            cx.report_error(e.place.clone(), "expected a sphere or a cylinder")
                .add_help("write `drum.cylinder(radius, axis)` or `ball.sphere(radius)`");
            return None;
        };
        let (radius, axis) = match (word.id, arguments.as_slice()) {
            (SPHERE, [radius]) => (radius, None),
            (CYLINDER, [radius, axis]) => (radius, Some(axis)),
            (SPHERE, _) => {
                cx.report_error(word.place.clone(), "`sphere` takes 1 argument")
                    .add_help("write `sphere(a)`");
                return None;
            }
            (CYLINDER | DRUM, _) => {
                cx.report_error(
                    word.place.clone(),
                    "a cylinder that a cable wraps around is written `cylinder(radius, axis)`",
                )
                .add_help(
                    "the cable wraps about the axis by the right-hand rule, from the first point to the \
                     second",
                );
                return None;
            }
            _ => {
                cx.report_error(word.place.clone(), format!("a cable cannot wrap around a `{}`", word.text))
                    .add_help("it wraps around a `sphere(radius)` or a `cylinder(radius, axis)`");
                return None;
            }
        };
        let frame = self.resolve_placement(base, cx);
        let constant_context = || Context::new(AllowedQuantities::Constant, None);
        let value = self.call_in_context(constant_context(), |s| s.resolve_scalar(radius, cx))?;
        if let Some(n) = value.constant_value().filter(|n| *n <= 0.0) {
            cx.report_error(radius.place.clone(), format!("this length must be positive, but it is {n}"))
                .add_help("the direction of the axis selects the side of the cable");
            return None;
        }
        self.record_parameter_condition(
            Rule::Positive,
            || format!("the radius of a {}", word.text),
            &[value],
        );
        let axis = match axis {
            Some(axis) => {
                Some(self.call_in_context(constant_context(), |s| s.resolve_unit_vector(axis, false, cx))?)
            }
            None => None,
        };
        Some((frame?, value, axis))
    }
}

/// Reports an end of a cable that lies inside the surface in all configurations.
fn report_cable_end_inside(
    end: &syntax::Expr,
    across: Vec3<'_>,
    radius: Expr<'_>,
    is_cylinder: bool,
    cx: &mut Diagnostics,
) -> Option<()> {
    let (Some(square), Some(radius)) = (across.dot(across).constant_value(), radius.constant_value()) else {
        return Some(());
    };
    if square >= radius * radius {
        return Some(());
    }
    let (surface, middle) = if is_cylinder { ("cylinder", "axis") } else { ("sphere", "centre") };
    cx.report_error(end.place.clone(), format!("this end of the cable lies inside of the {surface}"))
        .add_help(format!("it is {:.4} m from the {middle}, and the radius is {radius} m", square.sqrt()));
    None
}
