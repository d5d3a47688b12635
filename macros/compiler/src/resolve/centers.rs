//! Points that a motion singles out: instantaneous centres, the screw axis, the centre of percussion. Each is
//! a vector from a place of the body.

use super::quantities::{flatten, vector};
use super::scope::{Allowed, Placed, PlacedKind, Scope, Terms, Value};
use crate::diag::Diagnostics;
use crate::expr::sample::always;
use crate::expr::{Expr, Vec3};
use crate::mechanism::{LinkId, Pose};
use crate::syntax::{self, Name};

/// The motion of a body with respect to a frame, in the axes of the body's link.
struct Relative<'g> {
    link: Option<LinkId>,
    /// Velocity of the body's origin.
    v: Vec3<'g>,
    /// Angular velocity.
    w: Vec3<'g>,
    /// Acceleration of the body's origin, and angular acceleration, where they are asked for.
    rates: Option<[Vec3<'g>; 2]>,
}

impl<'g> Scope<'_, 'g> {
    /// With the velocity `v` of a body's origin and its angular velocity `ω`, both with respect to a frame:
    ///
    /// - `screw_axis(body / frame)` and `instant_center(body / frame)`: `ω × v / ω²`, from the origin to the
    ///   nearest point of the screw axis (Mozzi, Chasles), which rests where the body does not slide along
    ///   it;
    /// - `screw_pitch(body / frame)`: `ω·v / ω²`, how far the body slides along the axis while it turns by 1
    ///   rad;
    /// - `acceleration_center(body / frame)`: `(ω² a + α × a) / (ω⁴ + α²)`, from the origin to the point of a
    ///   body that moves in a plane whose acceleration is zero.
    pub fn center(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let text = function.text.as_str();
        let parts = if let [one] = arguments { flatten(one) } else { Vec::new() };
        let [body, frame] = parts.as_slice() else {
            cx.error(function.place.clone(), format!("`{text}` takes a body and a frame"))
                .help(format!("write `{text}(body / frame)`"));
            return None;
        };
        let accelerates = text == "acceleration_center";
        let allowed = if accelerates { Allowed::Acceleration } else { Allowed::Motion };
        if !self.check_allowed(allowed, &format!("`{text}(…)`"), &function.place, cx) {
            return None;
        }
        let motion = self.relative(body, frame, accelerates, cx)?;
        let Relative { link, v, w, rates } = motion;
        if w.is_zero() {
            cx.error(
                body.place.clone(),
                format!("`{}` does not turn with respect to `{}`", body.spelt(), frame.spelt()),
            )
            .help("what moves without turning has no centre: all its points move alike");
            return None;
        }
        let square = w.dot(w);
        let found = match (text, rates) {
            ("screw_pitch", _) => return Some(Value::Scalar(w.dot(v) / square)),
            ("acceleration_center", Some([a, alpha])) => {
                if !(vanishes(w.cross(alpha)) && always(w.dot(a), 0.0)) {
                    cx.error(function.place.clone(), "this body does not move in a plane")
                        .help("an acceleration centre is that of a motion in a plane; accelerations of points are `a(point / point / frame)`");
                    return None;
                }
                (a * square + alpha.cross(a)).map(|c| c / (square.square() + alpha.dot(alpha)))
            }
            _ => {
                if text == "instant_center" && !always(w.dot(v), 0.0) {
                    cx.error(function.place.clone(), "this body may slide along the axis that it turns about: no point of it rests")
                        .help("the nearest point of that axis is `screw_axis(body / frame)`, and `screw_pitch(body / frame)` tells how it slides");
                    return None;
                }
                w.cross(v).map(|c| c / square)
            }
        };
        Some(vector(vec![(link, found)]))
    }

    fn relative(
        &self,
        body: &syntax::Expr,
        frame: &syntax::Expr,
        accelerates: bool,
        cx: &mut Diagnostics,
    ) -> Option<Relative<'g>> {
        let (of, by) = (self.frame(body, cx), self.frame(frame, cx));
        let place = self.place(body, cx);
        let (_, by, place) = (of?, by?, place?);
        let kinematics = self.kinematics.borrow();
        let (link, zero) = (place.link, Vec3::zero(self.graph));
        // Any point that the frame carries.
        let from = Placed { link: by, pose: Pose::identity(self.graph), kind: PlacedKind::Body };
        let here = |terms: &Terms<'g>| kinematics.resolve(terms, link, zero);
        let rates = accelerates.then(|| {
            let a = kinematics.acceleration_in(&place, &from, by, self.graph);
            [here(&a), here(&kinematics.turning_rate(link, by, by, self.graph))]
        });
        Some(Relative {
            link,
            v: here(&kinematics.velocity_in(&place, &from, by, self.graph)),
            w: here(&kinematics.turning_in(link, by, self.graph)),
            rates,
        })
    }

    /// `center_of_percussion(body / point, axis)`: the vector from a point, about which a body turns, to
    /// where a blow across the arm to its centre of mass leaves the point at rest. With the arm `r` across
    /// the axis `n` and the moment of inertia `J` about the axis it is `J r / (m r²)`.
    pub fn center_of_percussion(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let (parts, axis) = match arguments {
            [of, axis] => (flatten(of), Some(axis)),
            _ => (Vec::new(), None),
        };
        let ([body, about], Some(axis)) = (parts.as_slice(), axis) else {
            cx.error(function.place.clone(), "`center_of_percussion` takes a body, a point and an axis")
                .help("write `center_of_percussion(body / point, z)`: the body turns about the axis through the point");
            return None;
        };
        if !self.check_allowed(Allowed::Placement, "`center_of_percussion(…)`", &function.place, cx) {
            return None;
        }
        let heavy = self.heavy(body, cx)?;
        let about = self.place_now(about, cx)?;
        let n = self.terms(axis, cx)?;
        let kinematics = self.kinematics.borrow();
        let (placed, (mass, com, central)) = &heavy;
        if mass.is_zero() {
            cx.error(body.place.clone(), format!("`{}` has no mass", body.spelt()))
                .help("name a body with a `mass`");
            return None;
        }
        let (link, zero) = (placed.link, Vec3::zero(self.graph));
        let length = kinematics.resolve(&n, link, zero).length();
        let n: Terms<'g> = n.into_iter().map(|(link, n)| (link, n.map(|c| c / length))).collect();
        let pose = Pose { translation: placed.pose.point(*com), ..placed.pose.clone() };
        let between = kinematics.between(&Placed { pose, ..placed.clone() }, &about);
        let [axis_here, arm] = [&n, &between].map(|terms| kinematics.resolve(terms, link, zero));
        drop(kinematics);
        let arm = arm + -(axis_here * axis_here.dot(arm));
        if vanishes(arm) {
            cx.error(
                function.place.clone(),
                format!("the centre of mass of `{}` lies on this axis", body.spelt()),
            )
            .help(
                "there is no centre of percussion then: a couple turns the body without a force at the axis",
            );
            return None;
        }
        let central = placed.pose.rotation.sym_to_parent(*central);
        if !vanishes((central * axis_here).cross(axis_here)) {
            cx.error(
                axis.place.clone(),
                format!("this axis is no principal axis of inertia of `{}`", body.spelt()),
            )
            .help(
                "a blow then pushes against the bearings wherever it falls: there is no centre of percussion",
            );
            return None;
        }
        let moment = self.inertia_about(&heavy, &about, [&n, &n]);
        let share: Expr<'g> = moment / (*mass * arm.dot(arm));
        Some(vector(vec![(link, arm * share)]))
    }
}

/// True for a vector that is zero for all values of what it depends on.
fn vanishes(v: Vec3<'_>) -> bool {
    v.0.iter().all(|c| always(*c, 0.0))
}
