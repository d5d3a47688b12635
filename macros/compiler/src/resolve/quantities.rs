//! Kinematic quantities of placed elements: vectors in axes of bodies and frames, points, and slash notation
//! such as `r(y / x)`, `v(y / x / A)` and `omega(B / A)`.

use super::call::Call;
use super::scope::{
    AllowedQuantities, Axes, Context, PlacedElement, PlacedElementKind, PlacedElements, Scope, Value,
    VectorTerms,
};
use crate::diag::{Diagnostics, Place};
use crate::expr::{Graph, Vec3};
use crate::kinematics::normalised_or_zero;
use crate::language::{BodyOrInertiaMethod, FunctionId};
use crate::mechanism::{LinkId, Pose};
use crate::syntax::{self, BinaryOp, ExprKind, GROUND, words};

impl<'g> Scope<'_, 'g> {
    /// Returns a vector as a sum over the axes of links. All links must be resolved.
    pub fn resolve_vector_terms(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<VectorTerms<'g>> {
        self.resolve_vector(e, cx).map(vector_terms_by_link)
    }

    /// Resolves several vectors and expresses them in the axes of a common frame.
    pub fn resolve_in_common_axes(
        &self,
        e: &[&syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<(Axes, Vec<Vec3<'g>>)> {
        let all: Vec<_> = e.iter().map(|e| Some((*e, self.resolve_vector(e, cx)?))).collect();
        self.express_in_common_axes(all.into_iter().collect::<Option<_>>()?, cx)
    }

    /// Expresses several resolved vectors in the axes of a common frame.
    pub fn express_in_common_axes(
        &self,
        read: Vec<(&syntax::Expr, Vec<(Axes, Vec3<'g>)>)>,
        cx: &mut Diagnostics,
    ) -> Option<(Axes, Vec<Vec3<'g>>)> {
        if self.context.borrow().axes.is_none() {
            let all: Vec<_> = read.into_iter().map(|(e, terms)| self.own_axes_sum(terms, e, cx)).collect();
            return Some((Axes::Own, all.into_iter().collect::<Option<_>>()?));
        }
        let all: Vec<VectorTerms<'g>> =
            read.into_iter().map(|(_, terms)| vector_terms_by_link(terms)).collect();
        let link = all.iter().flatten().next().and_then(|(link, _)| *link);
        let kinematics = &self.kinematics;
        let zero = Vec3::zero(self.graph);
        Some((
            Axes::Link(link),
            all.iter().map(|t| kinematics.components_in_link_axes(t, link, zero)).collect(),
        ))
    }

    /// Resolves `rate(coordinate)`, or the rate of an expression of coordinates, velocities and time.
    pub fn resolve_rate(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [argument] = call.arguments else {
            let first =
                call.arguments.first().map_or("coordinate".to_string(), syntax::Expr::short_source_text);
            cx.report_error(call.place.clone(), "`rate` takes one coordinate")
                .add_help(format!("write `rate({first})`"));
            return None;
        };
        let name = match &argument.kind {
            ExprKind::Name(name) => name.clone(),
            ExprKind::Field(inner, member) => match &inner.kind {
                ExprKind::Name(joint) => format!("{joint}.{}", member.text),
                _ => String::new(),
            },
            _ => String::new(),
        };
        if let ExprKind::Binary(BinaryOp::Div, vector, frame, _) = &argument.kind
            && let Some(name) = frame.as_name()
            && (name == GROUND || self.bodies.iter().any(|body| body == name))
        {
            return self.resolve_rate_in_frame(call.place, vector, frame, cx);
        }
        let kinematics = &self.kinematics;
        let Some((_, c, _)) = kinematics.coordinates.iter().find(|(n, ..)| *n == name) else {
            if self.is_moving_expression(argument) {
                return self.resolve_time_derivative(call.place, argument, cx).map(Value::Scalar);
            }
            if matches!(argument.kind, ExprKind::Name(_)) && !self.record_first_report(&name, cx) {
                return None;
            }
            let known = kinematics.coordinates.iter().map(|(n, ..)| n.as_str());
            let known: Vec<&str> = known.collect();
            let error = cx.report_error(argument.place.clone(), "`rate` takes a coordinate");
            error.suggest_name(&name, known);
            if error.has_no_help() {
                error.add_help(
                    "a coordinate is a joint with one degree of freedom, `joint.x` of one with several, or a \
                     `Coordinate`",
                );
            }
            return None;
        };
        if !self.check_allowed_quantity(
            AllowedQuantities::Motion,
            &format!("the rate of `{name}`"),
            call.place,
            cx,
        ) {
            return None;
        }
        Some(Value::Scalar(c.v.expr(self.graph) * self.graph.num(c.ratio)))
    }

    /// Resolves `angle(a, b)` in 0…π, or `angle(a, b, n)`, signed about `n`, in −π…π.
    pub fn resolve_angle(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let all: Vec<&syntax::Expr> = call.arguments.iter().collect();
        if !(2..=3).contains(&all.len()) {
            return call.report_wrong_arguments(cx);
        }
        let (_, v) = self.resolve_in_common_axes(&all, cx)?;
        let normal = v[0].cross(v[1]);
        let sine = match v.get(2) {
            Some(n) => normal.dot(normalised_or_zero(*n)),
            None => normal.regularised_norm(),
        };
        Some(Value::Scalar(sine.atan2(v[0].dot(v[1]))))
    }

    /// Returns the placement of an element with a position: a body, a point, a particle, `body.at(vector)` or
    /// the ground.
    pub fn resolve_placement(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<PlacedElement<'g>> {
        match &e.kind {
            ExprKind::Name(name) if name == GROUND => Some(PlacedElement {
                link: None,
                pose: Pose::identity(self.graph),
                kind: PlacedElementKind::Body,
            }),
            ExprKind::Name(name) => match self.placement_of_element(name) {
                Some(p) if p.kind != PlacedElementKind::Frame => Some(p),
                Some(_) => {
                    cx.report_error(
                        e.place.clone(),
                        format!("`{name}` is a frame, which has axes but no position"),
                    )
                    .add_help("name a body, a particle or a point");
                    None
                }
                None => {
                    self.report_unknown_position(name, &e.place, cx);
                    None
                }
            },
            ExprKind::Method(base, method, arguments)
                if method.id == Some(BodyOrInertiaMethod::At) && arguments.len() == 1 =>
            {
                let base = self.resolve_placement(base, cx)?;
                let context = Context::new(AllowedQuantities::Constant, None);
                let offset =
                    self.call_in_context(context, |scope| scope.resolve_own_axes_vector(&arguments[0], cx))?;
                let pose =
                    Pose { translation: base.pose.transform_point(offset), rotation: base.pose.rotation };
                Some(PlacedElement { link: base.link, pose, kind: PlacedElementKind::Point })
            }
            _ => {
                cx.report_error(e.place.clone(), "expected a point")
                    .add_help("name a body, a particle or a point, or write `body.at(length * x)`");
                None
            }
        }
    }

    fn report_unknown_position(&self, name: &str, place: &Place, cx: &mut Diagnostics) {
        if let Some(what) = self.kind_of_name(name).filter(|w| *w != "a body") {
            cx.report_error(place.clone(), format!("`{name}` is {what}, which has no position"))
                .add_help("name a body, a particle or a point");
            return;
        }
        if !self.record_first_report(name, cx) {
            return;
        }
        let kinematics = &self.kinematics;
        let known: Vec<&str> = kinematics.places.keys().map(String::as_str).chain([GROUND]).collect();
        let error = cx.report_error(place.clone(), format!("unknown point `{name}`"));
        words::suggest_meaning_or_known_word(error, words::BODIES, name, &known);
        if error.has_no_help() {
            error.add_help("name a body, a particle or a point, or write `body.at(length * x)`");
        }
    }

    /// Returns the placement of an element with a position, or of a point that may move on its body:
    /// `body.at(vector)` with a vector of any axes and coordinates. Velocity and acceleration of such a point
    /// are those of the body at that position.
    pub fn placement_of_moving_point(
        &self,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<PlacedElement<'g>> {
        match &e.kind {
            ExprKind::Method(base, method, arguments)
                if method.id == Some(BodyOrInertiaMethod::At) && arguments.len() == 1 =>
            {
                let base = self.placement_of_moving_point(base, cx)?;
                let axes = Some((base.link, base.pose.clone()));
                let context = Context::new(AllowedQuantities::Placement, axes);
                let offset =
                    self.call_in_context(context, |scope| scope.resolve_vector_terms(&arguments[0], cx))?;
                let offset =
                    self.kinematics.components_in_link_axes(&offset, base.link, Vec3::zero(self.graph));
                let pose = Pose { translation: base.pose.translation + offset, rotation: base.pose.rotation };
                Some(PlacedElement { link: base.link, pose, kind: PlacedElementKind::Point })
            }
            _ => self.resolve_placement(e, cx),
        }
    }

    /// Returns the link of an element with axes: a body or a frame.
    pub fn resolve_frame_link(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Option<LinkId>> {
        let ExprKind::Name(name) = &e.kind else {
            cx.report_error(e.place.clone(), "expected a frame").add_help("name a body or a frame");
            return None;
        };
        if name == GROUND {
            return Some(None);
        }
        match self.placement_of_element(name) {
            Some(p) if p.kind != PlacedElementKind::Point => Some(p.link),
            Some(_) => {
                cx.report_error(e.place.clone(), format!("`{name}` is a point, which has no axes"))
                    .add_help("name a body or a frame");
                None
            }
            None => {
                if !self.record_first_report(name, cx) {
                    return None;
                }
                let kinematics = &self.kinematics;
                let known: Vec<&str> = kinematics.places.keys().map(String::as_str).chain([GROUND]).collect();
                let error = cx.report_error(e.place.clone(), format!("unknown frame `{name}`"));
                words::suggest_meaning_or_known_word(error, words::BODIES, name, &known);
                if error.has_no_help() {
                    error.add_help("name a body or a frame");
                }
                None
            }
        }
    }

    /// Returns the operands between the slashes of a kinematic quantity, or reports an error.
    fn operands_of_kinematic_quantity<'e, const N: usize>(
        &self,
        call: &Call<'e>,
        allowed: AllowedQuantities,
        cx: &mut Diagnostics,
    ) -> Option<[&'e syntax::Expr; N]> {
        let (text, parts) = (call.function_name(), call.slash_operands());
        let of_point = matches!(call.id, FunctionId::Velocity | FunctionId::Acceleration);
        let message = match of_point && parts.len() == 2 {
            true => format!("`{text}` needs the frame with respect to which it is taken"),
            false => format!("`{text}` is written with slashes"),
        };
        let Ok(parts) = parts.try_into() else {
            cx.report_error(call.place.clone(), message).add_help(call.id.row().usage);
            return None;
        };
        self.check_allowed_quantity(allowed, &format!("`{text}(…)`"), call.place, cx).then_some(parts)
    }

    /// Resolves `r(y / x)`, the position of `y` relative to `x`.
    pub fn resolve_relative_position(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [y, x] = self.operands_of_kinematic_quantity(call, AllowedQuantities::Placement, cx)?;
        let (y, x) = (self.placement_of_moving_point(y, cx), self.placement_of_moving_point(x, cx));
        Some(vector_value_from_terms(self.kinematics.position_between(&y?, &x?)))
    }

    /// Resolves `v(y / x / A)`: the velocity of `y` relative to `x` in a frame A that rotates with `ω`:
    /// `v − ω × r`.
    pub fn resolve_relative_velocity(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [y, x, frame] = self.operands_of_kinematic_quantity(call, AllowedQuantities::Motion, cx)?;
        let (y, x) = (self.placement_of_moving_point(y, cx), self.placement_of_moving_point(x, cx));
        let frame = self.resolve_frame_link(frame, cx);
        Some(vector_value_from_terms(
            self.kinematics.relative_velocity_in_frame(&y?, &x?, frame?, self.graph),
        ))
    }

    /// Resolves `a(y / x / A)`: the acceleration of `y` relative to `x` in a frame A that rotates with `ω`
    /// and `α`: `a − α × r − ω × (ω × r) − 2 ω × v`.
    pub fn resolve_relative_acceleration(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [y, x, frame] = self.operands_of_kinematic_quantity(call, AllowedQuantities::Acceleration, cx)?;
        let (y, x) = (self.placement_of_moving_point(y, cx), self.placement_of_moving_point(x, cx));
        let frame = self.resolve_frame_link(frame, cx);
        Some(vector_value_from_terms(
            self.kinematics.relative_acceleration_in_frame(&y?, &x?, frame?, self.graph),
        ))
    }

    /// Resolves `omega(B / A)`, the angular velocity of B relative to A.
    pub fn resolve_angular_velocity(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let frames: [_; 2] = self.operands_of_kinematic_quantity(call, AllowedQuantities::Motion, cx)?;
        let [b, a] = frames.map(|e| self.resolve_frame_link(e, cx));
        Some(vector_value_from_terms(self.kinematics.angular_velocity_in_frame(b?, a?, self.graph)))
    }

    /// Resolves `alpha(B / A / C)`, the angular acceleration of B relative to A in C.
    pub fn resolve_angular_acceleration(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let frames: [_; 3] =
            self.operands_of_kinematic_quantity(call, AllowedQuantities::Acceleration, cx)?;
        let [b, a, c] = frames.map(|e| self.resolve_frame_link(e, cx));
        Some(vector_value_from_terms(self.kinematics.angular_acceleration_in_frame(b?, a?, c?, self.graph)))
    }
}

impl<'g> PlacedElements<'g> {
    /// Resolves a call of `v(y / x / frame)`.
    pub fn relative_velocity_in_frame(
        &self,
        y: &PlacedElement<'g>,
        x: &PlacedElement<'g>,
        frame: Option<LinkId>,
        graph: &'g Graph,
    ) -> VectorTerms<'g> {
        let mut v = self.velocity_of_point(y);
        v.extend(negate_terms(self.velocity_of_point(x)));
        if let Some(l) = frame {
            let r = self.components_in_link_axes(&self.position_between(y, x), frame, Vec3::zero(graph));
            v.push((frame, -self.twists[l.0].angular.cross(r)));
        }
        v
    }

    /// Resolves a call of `a(y / x / frame)`.
    pub fn relative_acceleration_in_frame(
        &self,
        y: &PlacedElement<'g>,
        x: &PlacedElement<'g>,
        frame: Option<LinkId>,
        graph: &'g Graph,
    ) -> VectorTerms<'g> {
        let mut a = self.acceleration_of_point(y);
        a.extend(negate_terms(self.acceleration_of_point(x)));
        if let Some(l) = frame {
            let zero = Vec3::zero(graph);
            let (w, dw) = (self.twists[l.0].angular, self.accelerations[l.0].angular);
            let r = self.components_in_link_axes(&self.position_between(y, x), frame, zero);
            let v = self.components_in_link_axes(
                &self.relative_velocity_in_frame(y, x, frame, graph),
                frame,
                zero,
            );
            let coriolis = w.cross(v);
            a.push((frame, -(dw.cross(r) + w.cross(w.cross(r)) + coriolis + coriolis)));
        }
        a
    }

    /// Resolves a call of `omega(body / frame)`.
    pub fn angular_velocity_in_frame(
        &self,
        body: Option<LinkId>,
        frame: Option<LinkId>,
        graph: &'g Graph,
    ) -> VectorTerms<'g> {
        let angular_velocity_of_link =
            |link: Option<LinkId>| link.map_or(Vec3::zero(graph), |l| self.twists[l.0].angular);
        vec![(body, angular_velocity_of_link(body)), (frame, -angular_velocity_of_link(frame))]
    }

    /// Returns `alpha(b / a / c)`. With each frame's `α` relative to the ground it is
    /// `α_b − α_a − ω_c × (ω_b − ω_a)`.
    pub fn angular_acceleration_in_frame(
        &self,
        b: Option<LinkId>,
        a: Option<LinkId>,
        c: Option<LinkId>,
        graph: &'g Graph,
    ) -> VectorTerms<'g> {
        let zero = Vec3::zero(graph);
        let angular_acceleration_of_link =
            |link: Option<LinkId>| link.map_or(zero, |l| self.accelerations[l.0].angular);
        let w = self.components_in_link_axes(&self.angular_velocity_in_frame(b, a, graph), c, zero);
        let turns = c.map_or(zero, |l| self.twists[l.0].angular);
        vec![
            (b, angular_acceleration_of_link(b)),
            (a, -angular_acceleration_of_link(a)),
            (c, -turns.cross(w)),
        ]
    }
}

fn negate_terms<'g>(terms: VectorTerms<'g>) -> VectorTerms<'g> {
    terms.into_iter().map(|(l, v)| (l, -v)).collect()
}

pub(super) fn vector_value_from_terms<'g>(terms: VectorTerms<'g>) -> Value<'g> {
    Value::Vector(terms.into_iter().map(|(link, v)| (Axes::Link(link), v)).collect())
}

/// Converts a vector to a sum over the axes of links.
pub(super) fn vector_terms_by_link<'g>(terms: Vec<(Axes, Vec3<'g>)>) -> VectorTerms<'g> {
    terms.into_iter().map(|(axes, v)| (link_of_axes(&axes), v)).collect()
}

/// Returns the link of axes; unresolved axes belong to the ground.
fn link_of_axes(axes: &Axes) -> Option<LinkId> {
    match axes {
        Axes::Link(link) => *link,
        Axes::Own | Axes::Of(_) => None,
    }
}
