//! Curves and fields: derivatives of an expression by a coordinate or a position.

use super::call::Call;
use super::quantities::{vector_terms_by_link, vector_value_from_terms};
use super::scope::{AllowedQuantities, Context, PlacedElement, Scope, Value};
use crate::diag::Diagnostics;
use crate::expr::diff::DirectionalDerivative;
use crate::expr::replace::substitute_symbols;
use crate::expr::sample::always_equals_number;
use crate::expr::{Expr, Mat3, Rotation, Vec3};
use crate::kinematics::symbols_in;
use crate::language;
use crate::mechanism::{Coordinate, LinkId, Pose, Quantity};
use crate::syntax::{self, BinaryOp, Callee, ExprKind};

impl<'g> Scope<'_, 'g> {
    /// Returns the axes defined by a vector or a curve, relative to the axes of a frame:
    /// `cylindrical(vector)`, `spherical(vector)`, `frenet(curve, coordinate)`.
    pub fn resolve_curvilinear_axes(
        &self,
        (rotation, name): (language::Rotation, &Callee),
        arguments: &[syntax::Expr],
        start: &PlacedElement<'g>,
        cx: &mut Diagnostics,
    ) -> Option<Rotation<'g>> {
        let context = Context::new(AllowedQuantities::Placement, Some((start.link, start.pose.clone())));
        self.call_in_context(context, |scope| match (rotation, arguments) {
            (language::Rotation::Frenet, [curve, along]) => scope.frenet_frame(curve, along, start, cx),
            (language::Rotation::Frenet, _) => {
                cx.report_error(name.place.clone(), "`frenet` takes a curve and the coordinate along it")
                    .add_help("write `frenet(curve, s)`, a vector that depends on a coordinate `s`");
                None
            }
            (_, [argument]) => {
                let terms = scope.resolve_vector_terms(argument, cx)?;
                let v = scope.kinematics.components_in_link_axes(&terms, start.link, Vec3::zero(scope.graph));
                let [x, y, z] = start.pose.rotation.vector_in_child_axes(v).0;
                if always_equals_number(x.square() + y.square(), 0.0) {
                    cx.report_error(
                        argument.place.clone(),
                        format!("this vector lies on the z axis, on which `{}` has no directions", name.text),
                    )
                    .add_help(
                        "the axes are determined by a vector that is not on the z axis of the frame in which \
                         it starts",
                    );
                    return None;
                }
                let about = Rotation::rotation_about_coordinate_axis(2, y.atan2(x));
                if rotation != language::Rotation::Spherical {
                    return Some(about);
                }
                let elevation = z.atan2((x.square() + y.square()).sqrt());
                Some(about.compose_with(&Rotation::rotation_about_coordinate_axis(1, -elevation)))
            }
            _ => {
                cx.report_error(name.place.clone(), format!("`{}` takes a vector", name.text))
                    .add_help(format!("write `{}(r(point / ground))`", name.text));
                None
            }
        })
    }

    /// Returns tangent, normal and binormal of a curve (Frenet and Serret), in the axes of a frame.
    fn frenet_frame(
        &self,
        curve: &syntax::Expr,
        along: &syntax::Expr,
        start: &PlacedElement<'g>,
        cx: &mut Diagnostics,
    ) -> Option<Rotation<'g>> {
        let ([first, second, _], link) = self.curve_derivatives_by_coordinate("frenet", curve, along, cx)?;
        let binormal = first.cross(second);
        if binormal.0.iter().all(|c| always_equals_number(*c, 0.0)) {
            cx.report_error(curve.place.clone(), "this curve is straight, and has no normal")
                .add_help("its tangent is `unit(…)` of its direction; curvature and torsion are zero");
            return None;
        }
        let normalised_vector = |v: Vec3<'g>| {
            let length = v.norm();
            v.map(|c| c / length)
        };
        let (t, b) = (normalised_vector(first), normalised_vector(binormal));
        let axes = [t, b.cross(t), b].map(|axis| {
            let here = self.kinematics.components_in_link_axes(
                &vec![(link, axis)],
                start.link,
                Vec3::zero(self.graph),
            );
            start.pose.rotation.vector_in_child_axes(here)
        });
        Some(Rotation::from_matrix(Mat3::from_fn(|i, j| axes[j][i])))
    }

    /// Resolves `curvature(curve, s)`: `|r′ × r″| / |r′|³` of a curve `r` that depends on a coordinate.
    pub fn resolve_curvature(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [first, second, _] = self.curve_derivatives(call, cx)?;
        let normal = first.cross(second);
        if normal.0.iter().all(|c| always_equals_number(*c, 0.0)) {
            return Some(Value::Scalar(self.graph.zero()));
        }
        let speed = first.norm();
        Some(Value::Scalar(normal.regularised_norm() / (speed * speed * speed)))
    }

    /// Resolves `torsion(curve, s)`: `(r′ × r″)·r‴ / |r′ × r″|²` of a curve `r` that depends on a coordinate.
    pub fn resolve_torsion(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [first, second, third] = self.curve_derivatives(call, cx)?;
        let normal = first.cross(second);
        if normal.0.iter().all(|c| always_equals_number(*c, 0.0)) {
            cx.report_error(call.arguments[0].place.clone(), "this curve is straight, and has no torsion")
                .add_help("its curvature is zero: it has no normal");
            return None;
        }
        Some(Value::Scalar(normal.dot(third) / normal.dot(normal)))
    }

    /// Returns the first three derivatives of a function's curve argument by its coordinate argument.
    fn curve_derivatives(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<[Vec3<'g>; 3]> {
        let [curve, along] = call.take_arguments(cx)?;
        let text = call.function_name();
        if !self.check_allowed_quantity(AllowedQuantities::Placement, &format!("`{text}(…)`"), call.place, cx)
        {
            return None;
        }
        Some(self.curve_derivatives_by_coordinate(text, curve, along, cx)?.0)
    }

    /// Returns the first three derivatives of a vector by a coordinate. They are in the axes of the returned
    /// link, which do not depend on the coordinate.
    fn curve_derivatives_by_coordinate(
        &self,
        text: &str,
        curve: &syntax::Expr,
        along: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<([Vec3<'g>; 3], Option<LinkId>)> {
        let c = self.curve_coordinate(text, along, cx)?;
        let symbol = Quantity::Configuration(c.q.0).symbol();
        let terms = vector_terms_by_link(self.resolve_vector(curve, cx)?);
        let kinematics = &self.kinematics;
        let zero = Vec3::zero(self.graph);
        let link_rotates_with_parameter = |link: Option<LinkId>| {
            let axes = (0..3).map(|k| {
                kinematics.components_in_link_axes(
                    &vec![(link, Vec3::coordinate_axis(self.graph, k))],
                    None,
                    zero,
                )
            });
            axes.into_iter().any(|axis| symbols_in(&axis.0).contains(&symbol))
        };
        let link = terms.first().and_then(|(link, _)| *link);
        let link = if link_rotates_with_parameter(link) { None } else { link };
        let position = kinematics.components_in_link_axes(&terms, link, zero);
        let mut derivative = DirectionalDerivative::with_respect_to(symbol, self.graph);
        let scale = self.graph.num(1.0 / c.ratio);
        let mut next_derivative = |v: Vec3<'g>| v.map(|c| derivative.differentiate(c) * scale);
        let first = next_derivative(position);
        if first.is_zero() {
            cx.report_error(
                curve.place.clone(),
                format!("this vector does not depend on `{}`", along.short_source_text()),
            )
            .add_help(format!("write `{text}(curve, s)`, a vector that depends on a coordinate `s`"));
            return None;
        }
        let second = next_derivative(first);
        Some(([first, second, next_derivative(second)], link))
    }

    /// Returns the coordinate with this name as the parameter of a curve.
    fn curve_coordinate(&self, text: &str, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Coordinate> {
        let name = e.short_source_text();
        let kinematics = &self.kinematics;
        if let Some((_, c, _)) = kinematics.coordinates.iter().find(|(known, ..)| *known == name) {
            return Some(*c);
        }
        let known: Vec<&str> = kinematics.coordinates.iter().map(|(known, ..)| known.as_str()).collect();
        let error = cx.report_error(
            e.place.clone(),
            format!("`{text}` takes the coordinate that parametrises the curve"),
        );
        error.suggest_name(&name, known);
        if error.has_no_help() {
            error.add_help(
                "a coordinate is a joint with one degree of freedom, `joint.x` of one with several, or a \
                 `Coordinate`",
            );
        }
        None
    }

    /// Resolves `gradient(field / point)`: the derivative of a scalar by the position of a point; all other
    /// quantities are constant.
    pub fn resolve_gradient(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [whole] = call.take_arguments(cx)?;
        let ExprKind::Binary(BinaryOp::Div, field, point, _) = &whole.kind else {
            return call.report_wrong_arguments(cx);
        };
        if !self.check_allowed_quantity(AllowedQuantities::Placement, "`gradient(…)`", call.place, cx) {
            return None;
        }
        let placed = self.resolve_placement(point, cx)?;
        let Some(name) = point.as_name().filter(|name| *name != syntax::GROUND) else {
            cx.report_error(point.place.clone(), "expected the name of a point")
                .add_help("name a `Point`, a particle or a body");
            return None;
        };
        // The point is displaced by three symbols, and the field is differentiated by them.
        let moves = [0, 1, 2].map(|k| Quantity::Displacement(k).symbol());
        let displacement = Vec3(moves.map(|s| self.graph.symbol(s)));
        let pose = Pose { translation: placed.pose.translation + displacement, ..placed.pose.clone() };
        let moved = PlacedElement { pose, ..placed.clone() };
        self.records.borrow_mut().definition_values.clear();
        self.records.borrow_mut().displaced.push((name.to_string(), moved));
        let value = self.resolve_scalar(field, cx);
        self.records.borrow_mut().displaced.pop();
        self.records.borrow_mut().definition_values.clear();
        let value = value?;
        let set_coordinates_to_zero =
            |e: Expr<'g>| substitute_symbols(e, &|s| moves.contains(&s).then(|| self.graph.zero()));
        let gradient = Vec3(moves.map(|s| {
            set_coordinates_to_zero(
                DirectionalDerivative::with_respect_to(s, self.graph).differentiate(value),
            )
        }));
        if gradient.is_zero() {
            cx.report_error(field.place.clone(), format!("this does not depend on the position of `{name}`"))
                .add_help(format!("a field is an expression of `r({name} / ground)`"));
            return None;
        }
        Some(vector_value_from_terms(vec![(placed.link, gradient)]))
    }
}
