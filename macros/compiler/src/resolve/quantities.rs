//! What names mean once bodies are placed: axes of bodies and frames, points, coordinates, time, inputs, and the
//! kinematic quantities in slash notation: `r(y / x)`, `v(y / x / A)`, `omega(B / A)`.

use super::scope::{Allowed, Axes, Context, Placed, PlacedKind, Scope, Terms, Value};
use crate::diag::{Diagnostics, Place};
use crate::expr::Vec3;
use crate::kinematics::{Spatial, unit};
use crate::mechanism::{LinkId, Pose, Quantity};
use crate::syntax::{self, BinaryOp, ExprKind, GROUND, Name, words};

impl<'g> Scope<'_, 'g> {
    /// A vector as a sum over the axes of links. Only where the links are known.
    pub fn terms(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Terms<'g>> {
        let terms = self.vector(e, cx)?;
        Some(terms.into_iter().map(|(axes, v)| (link_of(&axes), v)).collect())
    }

    /// Several vectors in common axes.
    pub fn common_axes(&self, e: &[&syntax::Expr], cx: &mut Diagnostics) -> Option<(Axes, Vec<Vec3<'g>>)> {
        let all: Vec<_> = e.iter().map(|e| Some((*e, self.vector(e, cx)?))).collect();
        self.in_common_axes(all.into_iter().collect::<Option<_>>()?, cx)
    }

    /// Several vectors that were read, in common axes.
    pub fn in_common_axes(
        &self,
        read: Vec<(&syntax::Expr, Vec<(Axes, Vec3<'g>)>)>,
        cx: &mut Diagnostics,
    ) -> Option<(Axes, Vec<Vec3<'g>>)> {
        if self.context.borrow().axes.is_none() {
            let all: Vec<_> = read.into_iter().map(|(e, terms)| self.own_sum(terms, e, cx)).collect();
            return Some((Axes::Own, all.into_iter().collect::<Option<_>>()?));
        }
        let links = |terms: Vec<(Axes, Vec3<'g>)>| -> Terms<'g> {
            terms.into_iter().map(|(axes, v)| (link_of(&axes), v)).collect()
        };
        let all: Vec<Terms<'g>> = read.into_iter().map(|(_, terms)| links(terms)).collect();
        let link = all.iter().flatten().next().and_then(|(link, _)| *link);
        let kinematics = self.kinematics.borrow();
        let zero = Vec3::zero(self.graph);
        Some((Axes::Link(link), all.iter().map(|t| kinematics.resolve(t, link, zero)).collect()))
    }

    /// `rate(coordinate)`, or the rate of what depends on coordinates, velocities and time.
    pub fn rate_of(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let [argument] = arguments else {
            let first = arguments.first().map_or("coordinate".to_string(), syntax::Expr::spelt);
            cx.error(function.place.clone(), "`rate` takes one coordinate")
                .help(format!("write `rate({first})`"));
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
        let kinematics = self.kinematics.borrow();
        let Some((_, c, _)) = kinematics.coordinates.iter().find(|(n, ..)| *n == name) else {
            if self.is_moving(argument) {
                drop(kinematics);
                return self.rate_of_value(function, argument, cx).map(Value::Scalar);
            }
            if matches!(argument.kind, ExprKind::Name(_)) && !self.is_news(&name, cx) {
                return None;
            }
            let known = kinematics.coordinates.iter().map(|(n, ..)| n.as_str());
            let known: Vec<&str> = known.collect();
            let error = cx.error(argument.place.clone(), "`rate` takes a coordinate");
            error.suggest(&name, known);
            if error.is_bare() {
                error.help("a coordinate is a joint with one degree of freedom, `joint.x` of one with several, or a `Coordinate`");
            }
            return None;
        };
        if !self.check_allowed(Allowed::Motion, &format!("the rate of `{name}`"), &function.place, cx) {
            return None;
        }
        Some(Value::Scalar(Quantity::Velocity(c.v).expr(self.graph) * self.graph.num(c.ratio)))
    }

    /// `angle(a, b)` in 0…π, or `angle(a, b, n)` directed about `n` in −π…π.
    pub fn angle(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let all: Vec<&syntax::Expr> = arguments.iter().collect();
        if !(2..=3).contains(&all.len()) {
            cx.error(
                function.place.clone(),
                "`angle` takes two vectors, and a third about which it is directed",
            )
            .help("write `angle(a, b)` or `angle(a, b, normal)`");
            return None;
        }
        let (_, v) = self.common_axes(&all, cx)?;
        let normal = v[0].cross(v[1]);
        let sine = match v.get(2) {
            Some(n) => normal.dot(unit(*n)),
            None => normal.length(),
        };
        Some(Value::Scalar(sine.atan2(v[0].dot(v[1]))))
    }

    /// Something with a place: a body, a point, a particle, `body.at(vector)`, the ground.
    pub fn place(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Placed<'g>> {
        match &e.kind {
            ExprKind::Name(name) if name == GROUND => {
                Some(Placed { link: None, pose: Pose::identity(self.graph), kind: PlacedKind::Body })
            }
            ExprKind::Name(name) => match self.kinematics.borrow().places.get(name) {
                Some(p) if p.kind != PlacedKind::Frame => Some(p.clone()),
                Some(_) => {
                    cx.error(e.place.clone(), format!("`{name}` is a frame, which has axes but no place"))
                        .help("name a body, a particle or a point");
                    None
                }
                None => {
                    self.unknown_place(name, &e.place, cx);
                    None
                }
            },
            ExprKind::Method(base, method, arguments) if method.text == "at" && arguments.len() == 1 => {
                let base = self.place(base, cx)?;
                let context = Context::new(Allowed::Constant, None);
                let at = self.in_context(context, |scope| scope.own_vector(&arguments[0], cx))?;
                let pose = Pose { translation: base.pose.point(at), rotation: base.pose.rotation };
                Some(Placed { link: base.link, pose, kind: PlacedKind::Point })
            }
            _ => {
                cx.error(e.place.clone(), "expected a point")
                    .help("name a body, a particle or a point, or write `body.at(length * x)`");
                None
            }
        }
    }

    fn unknown_place(&self, name: &str, place: &Place, cx: &mut Diagnostics) {
        if let Some(what) = self.what(name).filter(|w| *w != "a body") {
            cx.error(place.clone(), format!("`{name}` is {what}, which has no place"))
                .help("name a body, a particle or a point");
            return;
        }
        if !self.is_news(name, cx) {
            return;
        }
        let kinematics = self.kinematics.borrow();
        let known: Vec<&str> = kinematics.places.keys().map(String::as_str).chain([GROUND]).collect();
        let error = cx.error(place.clone(), format!("unknown point `{name}`"));
        words::point(error, words::BODIES, name, &known);
        if error.is_bare() {
            error.help("name a body, a particle or a point, or write `body.at(length * x)`");
        }
    }

    /// Something with axes: a body or a frame.
    fn frame(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Option<LinkId>> {
        let ExprKind::Name(name) = &e.kind else {
            cx.error(e.place.clone(), "expected a frame").help("name a body or a frame");
            return None;
        };
        if name == GROUND {
            return Some(None);
        }
        match self.kinematics.borrow().places.get(name) {
            Some(p) if p.kind != PlacedKind::Point => Some(p.link),
            Some(_) => {
                cx.error(e.place.clone(), format!("`{name}` is a point, which has no axes"))
                    .help("name a body or a frame");
                None
            }
            None => {
                if !self.is_news(name, cx) {
                    return None;
                }
                let kinematics = self.kinematics.borrow();
                let known: Vec<&str> = kinematics.places.keys().map(String::as_str).chain([GROUND]).collect();
                let error = cx.error(e.place.clone(), format!("unknown frame `{name}`"));
                words::point(error, words::BODIES, name, &known);
                if error.is_bare() {
                    error.help("name a body or a frame");
                }
                None
            }
        }
    }

    /// `r(y / x)`, `v(y / x / A)`, `a(y / x / A)`, `omega(B / A)`, `alpha(B / A / C)`.
    pub fn slash(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let text = function.text.as_str();
        let parts: Vec<&syntax::Expr> = match arguments {
            [one] => flatten(one),
            _ => Vec::new(),
        };
        let (count, form) = match text {
            "r" => (2, "r(point / point)"),
            "v" | "a" => (3, "(point / point / frame)"),
            "omega" => (2, "omega(frame / frame)"),
            _ => (3, "alpha(frame / frame / frame)"),
        };
        if parts.len() != count {
            let form =
                if text.len() == 1 && text != "r" { format!("{text}{form}") } else { form.to_string() };
            let missing = matches!(text, "v" | "a") && parts.len() == 2;
            cx.error(
                function.place.clone(),
                match missing {
                    true => format!("`{text}` needs the frame with respect to which it is taken"),
                    false => format!("`{text}` is written with slashes"),
                },
            )
            .help(format!("write `{form}`"));
            return None;
        }
        let allowed = match text {
            "r" => Allowed::Placement,
            "v" | "omega" => Allowed::Motion,
            _ => Allowed::Acceleration,
        };
        if !self.check_allowed(allowed, &format!("`{text}(…)`"), &function.place, cx) {
            return None;
        }
        match text {
            "omega" | "alpha" => self.turning(text, &parts, cx),
            _ => self.moving(text, &parts, cx),
        }
    }

    /// Relative angular velocity and acceleration. With `α` of each frame taken in the ground,
    /// `alpha(B / A / C) = α_B − α_A − ω_C × (ω_B − ω_A)`.
    fn turning(&self, text: &str, parts: &[&syntax::Expr], cx: &mut Diagnostics) -> Option<Value<'g>> {
        let frames: Vec<_> = parts.iter().map(|e| self.frame(e, cx)).collect();
        let frames = frames.into_iter().collect::<Option<Vec<_>>>()?;
        let kinematics = self.kinematics.borrow();
        let zero = Vec3::zero(self.graph);
        let of = |all: &[Spatial<'g>], link: Option<LinkId>| link.map_or(zero, |l| all[l.0].angular);
        let difference =
            |all: &[Spatial<'g>]| vec![(frames[0], of(all, frames[0])), (frames[1], -of(all, frames[1]))];
        if text == "omega" {
            return Some(vector(difference(&kinematics.twists)));
        }
        let mut terms = difference(&kinematics.accelerations);
        let w = kinematics.resolve(&difference(&kinematics.twists), frames[2], zero);
        terms.push((frames[2], -of(&kinematics.twists, frames[2]).cross(w)));
        Some(vector(terms))
    }

    /// Relative position, velocity and acceleration. Seen from a frame A that turns with `ω` and `α`:
    /// `v_A = v − ω × r`, `a_A = a − α × r − ω × (ω × r) − 2 ω × v_A`.
    fn moving(&self, text: &str, parts: &[&syntax::Expr], cx: &mut Diagnostics) -> Option<Value<'g>> {
        let (y, x) = (self.place(parts[0], cx), self.place(parts[1], cx));
        let frame = parts.get(2).map(|e| self.frame(e, cx));
        let (y, x) = (y?, x?);
        let kinematics = self.kinematics.borrow();
        let r = kinematics.between(&y, &x);
        let Some(frame) = frame else { return Some(vector(r)) };
        let frame = frame?;
        let zero = Vec3::zero(self.graph);
        let minus = |terms: Terms<'g>| terms.into_iter().map(|(l, v)| (l, -v)).collect::<Terms<'g>>();
        let mut v = kinematics.velocity(&y);
        v.extend(minus(kinematics.velocity(&x)));
        if let Some(l) = frame {
            let w = kinematics.twists[l.0].angular;
            v.push((frame, -w.cross(kinematics.resolve(&r, frame, zero))));
        }
        if text == "v" {
            return Some(vector(v));
        }
        let mut a = kinematics.acceleration(&y);
        a.extend(minus(kinematics.acceleration(&x)));
        if let Some(l) = frame {
            let (w, dw) = (kinematics.twists[l.0].angular, kinematics.accelerations[l.0].angular);
            let (r, v) = (kinematics.resolve(&r, frame, zero), kinematics.resolve(&v, frame, zero));
            let coriolis = w.cross(v);
            a.push((frame, -(dw.cross(r) + w.cross(w.cross(r)) + coriolis + coriolis)));
        }
        Some(vector(a))
    }
}

pub(super) fn vector<'g>(terms: Terms<'g>) -> Value<'g> {
    Value::Vector(terms.into_iter().map(|(link, v)| (Axes::Link(link), v)).collect())
}

/// The link of axes; what is not resolved to one belongs to the ground.
fn link_of(axes: &Axes) -> Option<LinkId> {
    match axes {
        Axes::Link(link) => *link,
        Axes::Own | Axes::Of(_) => None,
    }
}

/// The parts of `a / b / c`.
pub(super) fn flatten(e: &syntax::Expr) -> Vec<&syntax::Expr> {
    let mut parts = Vec::new();
    let mut at = e;
    while let ExprKind::Binary(BinaryOp::Div, left, right, _) = &at.kind {
        parts.push(&**right);
        at = left;
    }
    parts.push(at);
    parts.reverse();
    parts
}
