//! Characteristic points of a motion: instantaneous centres, the screw axis, the centre of percussion. Each
//! is a vector from the origin of the body or a point of it.

use super::call::Call;
use super::quantities::vector_value_from_terms;
use super::scope::{AllowedQuantities, PlacedElement, PlacedElementKind, Scope, Value, VectorTerms};
use crate::diag::Diagnostics;
use crate::expr::sample::always_equals_number;
use crate::expr::{Expr, Vec3};
use crate::mechanism::{LinkId, Pose};
use crate::syntax;

/// Motion of a body relative to a frame, in the axes of the body's link.
struct RelativeMotion<'g> {
    link: Option<LinkId>,
    /// Velocity of the origin of the body, m/s.
    v: Vec3<'g>,
    /// Angular velocity of the body, rad/s.
    w: Vec3<'g>,
    /// Acceleration of the body's origin and angular acceleration, if requested.
    rates: Option<[Vec3<'g>; 2]>,
}

impl<'g> Scope<'_, 'g> {
    /// Resolves `instant_center(body / frame)`: the vector from the body's origin to the point at rest,
    /// `ω × v / ω²`, with the velocity `v` of the origin.
    pub fn instant_center(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let RelativeMotion { link, v, w, .. } = self.relative_motion(call, AllowedQuantities::Motion, cx)?;
        let square = w.dot(w);
        if !always_equals_number(w.dot(v), 0.0) {
            cx.report_error(
                call.place.clone(),
                "this body can slide along its axis of rotation: it has no point at rest",
            )
            .add_help(
                "the nearest point of that axis is `screw_axis(body / frame)`, and `screw_pitch(body / \
                 frame)` is the advance along it",
            );
            return None;
        }
        Some(vector_value_from_terms(vec![(link, w.cross(v).map(|c| c / square))]))
    }

    /// Resolves `screw_axis(body / frame)`: the vector from the body's origin to the nearest point of the
    /// screw axis (Mozzi, Chasles), `ω × v / ω²`.
    pub fn screw_axis(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let RelativeMotion { link, v, w, .. } = self.relative_motion(call, AllowedQuantities::Motion, cx)?;
        let square = w.dot(w);
        Some(vector_value_from_terms(vec![(link, w.cross(v).map(|c| c / square))]))
    }

    /// Resolves `screw_pitch(body / frame)`: the advance along the screw axis per radian, `ω·v / ω²`.
    pub fn screw_pitch(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let RelativeMotion { v, w, .. } = self.relative_motion(call, AllowedQuantities::Motion, cx)?;
        let square = w.dot(w);
        Some(Value::Scalar(w.dot(v) / square))
    }

    /// Resolves `acceleration_center(body / frame)`: the vector from the origin of a body in planar motion to
    /// the point without acceleration, `(ω² a + α × a) / (ω⁴ + α²)`.
    pub fn acceleration_center(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let RelativeMotion { link, w, rates, .. } =
            self.relative_motion(call, AllowedQuantities::Acceleration, cx)?;
        let [a, alpha] = rates?;
        let square = w.dot(w);
        if !(is_always_zero(w.cross(alpha)) && always_equals_number(w.dot(a), 0.0)) {
            cx.report_error(call.place.clone(), "this body does not move in a plane").add_help(
                "an acceleration centre is that of a motion in a plane; accelerations of points are `a(point \
                 / point / frame)`",
            );
            return None;
        }
        let center = (a * square + alpha.cross(a)).map(|c| c / (square.square() + alpha.dot(alpha)));
        Some(vector_value_from_terms(vec![(link, center)]))
    }

    /// Returns the motion of a body that rotates relative to a frame, with accelerations if `allowed`
    /// includes them.
    fn relative_motion(
        &self,
        call: &Call<'_>,
        allowed: AllowedQuantities,
        cx: &mut Diagnostics,
    ) -> Option<RelativeMotion<'g>> {
        let Ok([body, frame]) = <[_; 2]>::try_from(call.slash_operands()) else {
            return call.report_wrong_arguments(cx);
        };
        if !self.check_allowed_quantity(allowed, &format!("`{}(…)`", call.function_name()), call.place, cx)
        {
            return None;
        }
        let motion =
            self.motion_relative_to_frame(body, frame, allowed == AllowedQuantities::Acceleration, cx)?;
        if motion.w.is_zero() {
            cx.report_error(
                body.place.clone(),
                format!(
                    "`{}` does not rotate with respect to `{}`",
                    body.short_source_text(),
                    frame.short_source_text()
                ),
            )
            .add_help("a body in pure translation has no centre: all its points have the same velocity");
            return None;
        }
        Some(motion)
    }

    fn motion_relative_to_frame(
        &self,
        body: &syntax::Expr,
        frame: &syntax::Expr,
        accelerates: bool,
        cx: &mut Diagnostics,
    ) -> Option<RelativeMotion<'g>> {
        let (body_link, frame_link) = (self.resolve_frame_link(body, cx), self.resolve_frame_link(frame, cx));
        let place = self.resolve_placement(body, cx);
        let (_, frame_link, place) = (body_link?, frame_link?, place?);
        let kinematics = &self.kinematics;
        let (link, zero) = (place.link, Vec3::zero(self.graph));
        // Any point fixed in the frame.
        let from = PlacedElement {
            link: frame_link,
            pose: Pose::identity(self.graph),
            kind: PlacedElementKind::Body,
        };
        let resolve_in_link_axes =
            |terms: &VectorTerms<'g>| kinematics.components_in_link_axes(terms, link, zero);
        let rates = accelerates.then(|| {
            let a = kinematics.relative_acceleration_in_frame(&place, &from, frame_link, self.graph);
            [
                resolve_in_link_axes(&a),
                resolve_in_link_axes(
                    &kinematics.angular_acceleration_in_frame(link, frame_link, frame_link, self.graph),
                ),
            ]
        });
        Some(RelativeMotion {
            link,
            v: resolve_in_link_axes(
                &kinematics.relative_velocity_in_frame(&place, &from, frame_link, self.graph),
            ),
            w: resolve_in_link_axes(&kinematics.angular_velocity_in_frame(link, frame_link, self.graph)),
            rates,
        })
    }

    /// Resolves `center_of_percussion(body / point, axis)`: the vector from the point to the centre of
    /// percussion of a body that rotates about an axis through the point. An impulse there, perpendicular to
    /// the arm to the centre of mass, leaves the point at rest. With the arm `r` perpendicular to the axis
    /// `n` and the moment of inertia `J` about the axis it is `J r / (m r²)`.
    pub fn center_of_percussion(&self, call: &Call<'_>, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let [operands, axis] = call.take_arguments(cx)?;
        let [body, about] = call.take_operands(operands, cx)?;
        if !self.check_allowed_quantity(
            AllowedQuantities::Placement,
            "`center_of_percussion(…)`",
            call.place,
            cx,
        ) {
            return None;
        }
        let body_with_mass = self.resolve_body_with_mass(body, cx)?;
        let about = self.placement_of_moving_point(about, cx)?;
        let n = self.resolve_vector_terms(axis, cx)?;
        let kinematics = &self.kinematics;
        let (placed, (mass, com, central)) = &body_with_mass;
        if mass.is_zero() {
            cx.report_error(body.place.clone(), format!("`{}` has no mass", body.short_source_text()))
                .add_help("name a body with a `mass`");
            return None;
        }
        let (link, zero) = (placed.link, Vec3::zero(self.graph));
        let length = kinematics.components_in_link_axes(&n, link, zero).regularised_norm();
        let n: VectorTerms<'g> = n.into_iter().map(|(link, n)| (link, n.map(|c| c / length))).collect();
        let pose = Pose { translation: placed.pose.transform_point(*com), ..placed.pose.clone() };
        let offset = kinematics.position_between(&PlacedElement { pose, ..placed.clone() }, &about);
        let [axis_here, arm] =
            [&n, &offset].map(|terms| kinematics.components_in_link_axes(terms, link, zero));
        let arm = arm + -(axis_here * axis_here.dot(arm));
        if is_always_zero(arm) {
            cx.report_error(
                call.place.clone(),
                format!("the centre of mass of `{}` lies on this axis", body.short_source_text()),
            )
            .add_help(
                "there is no centre of percussion then: a pure torque rotates the body without a force at \
                 the axis",
            );
            return None;
        }
        let central = placed.pose.rotation.symmetric_tensor_in_parent_axes(*central);
        if !is_always_zero((central * axis_here).cross(axis_here)) {
            cx.report_error(
                axis.place.clone(),
                format!("this axis is not a principal axis of inertia of `{}`", body.short_source_text()),
            )
            .add_help("every impulse then loads the bearings: there is no centre of percussion");
            return None;
        }
        let moment = self.moment_of_inertia_about_point(&body_with_mass, &about, [&n, &n]);
        let share: Expr<'g> = moment / (*mass * arm.dot(arm));
        Some(vector_value_from_terms(vec![(link, arm * share)]))
    }
}

/// Returns whether a vector is zero for all values of its symbols.
fn is_always_zero(v: Vec3<'_>) -> bool {
    v.0.iter().all(|c| always_equals_number(*c, 0.0))
}
