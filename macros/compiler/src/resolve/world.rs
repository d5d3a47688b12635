//! What names mean once bodies are placed: axes of bodies and frames, points, coordinates, time, inputs, and the
//! kinematic quantities in slash notation: `r(y / x)`, `v(y / x / A)`, `omega(B / A)`.

use super::expression::{Axes, Scope, Value};
use super::tree::GROUND;
use crate::diag::{Diagnostics, Place};
use crate::expr::{Expr, Rotation, Vec3};
use crate::kinematics::{Joint, Spatial, change_axes, position_in};
use crate::mechanism::{Coordinate, LinkId, Pose, Quantity};
use crate::syntax::{self, BinaryOp, ExprKind, Name, words};
use std::collections::BTreeMap;

/// What an expression may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Parameters alone.
    Constant,
    /// Coordinates and time too.
    Placement,
    /// Rates, velocities and inputs too.
    Motion,
    /// Accelerations too.
    Acceleration,
    /// Reactions of joints too.
    Reaction,
}

/// Where an expression stands.
#[derive(Clone, Debug)]
pub struct View<'g> {
    /// What it may depend on.
    pub level: Level,
    /// The link and placement whose axes `x`, `y` and `z` are; none where they are the attribute's own.
    pub home: Option<(Option<LinkId>, Pose<'g>)>,
    /// Names of the place, such as `stretch`.
    pub locals: Vec<(&'static str, Expr<'g>)>,
    /// Definitions that are being looked up.
    defining: Vec<String>,
}

impl<'g> View<'g> {
    /// A view without names of its own.
    pub fn new(level: Level, home: Option<(Option<LinkId>, Pose<'g>)>) -> View<'g> {
        View { level, home, locals: Vec::new(), defining: Vec::new() }
    }

    /// The same with names of its own.
    pub fn with_locals(mut self, locals: Vec<(&'static str, Expr<'g>)>) -> View<'g> {
        self.locals = locals;
        self
    }
}

/// What can be placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlacedKind {
    /// A body: axes and origin.
    Body,
    /// A particle or a point: an origin, with the axes of what carries it.
    Point,
    /// A frame: axes.
    Frame,
}

/// A placed thing: the link it is fixed in (the ground if none) and where.
#[derive(Clone, Debug)]
pub struct Placed<'g> {
    /// The link.
    pub link: Option<LinkId>,
    /// Its placement in the link.
    pub pose: Pose<'g>,
    /// What it is.
    pub kind: PlacedKind,
}

/// What is placed so far, and how it moves.
#[derive(Debug, Default)]
pub struct World<'g> {
    /// By name.
    pub places: BTreeMap<String, Placed<'g>>,
    /// Plain coordinates by full name; true for an angle.
    pub coordinates: Vec<(String, Coordinate, bool)>,
    /// Kinematics of the links.
    pub joints: Vec<Joint<'g>>,
    /// Twists of the links, once all are there.
    pub twists: Vec<Spatial<'g>>,
    /// By joint: its number, and the axes of its frame on the parent, in which its reactions are resolved.
    pub transmissions: BTreeMap<String, (usize, Option<LinkId>, Rotation<'g>)>,
    /// Accelerations of the links, once all are there.
    pub accelerations: Vec<Spatial<'g>>,
}

/// A vector as a sum over the axes of links.
pub type Terms<'g> = Vec<(Option<LinkId>, Vec3<'g>)>;

impl<'g> World<'g> {
    /// The components of a sum in the axes of one link.
    pub fn resolve(&self, terms: &Terms<'g>, link: Option<LinkId>, zero: Vec3<'g>) -> Vec3<'g> {
        terms.iter().fold(zero, |sum, (from, v)| sum + change_axes(&self.joints, *v, *from, link))
    }

    /// The position of a point from the ground's origin.
    pub fn position(&self, link: Option<LinkId>, p: Vec3<'g>) -> Terms<'g> {
        let mut terms = vec![(link, p)];
        let mut at = link;
        while let Some(l) = at {
            let joint = &self.joints[l.0];
            terms.push((joint.parent, joint.translation));
            at = joint.parent;
        }
        terms
    }

    /// `r(y / x)`, with what both share left out.
    pub fn between(&self, y: &Placed<'g>, x: &Placed<'g>) -> Terms<'g> {
        let mut sum = self.position(y.link, y.pose.translation);
        for (axes, v) in self.position(x.link, x.pose.translation) {
            match sum.iter_mut().find(|(known, _)| *known == axes) {
                Some((_, total)) => *total -= v,
                None => sum.push((axes, -v)),
            }
        }
        sum.retain(|(_, v)| !v.is_zero());
        sum
    }

    /// Velocity of a point relative to the ground.
    pub fn velocity(&self, p: &Placed<'g>) -> Terms<'g> {
        p.link.map_or(Vec::new(), |l| {
            let t = &self.twists[l.0];
            vec![(p.link, t.linear + t.angular.cross(p.pose.translation))]
        })
    }

    /// Acceleration of a point relative to the ground.
    pub fn acceleration(&self, p: &Placed<'g>) -> Terms<'g> {
        p.link.map_or(Vec::new(), |l| {
            let (t, a, r) = (&self.twists[l.0], &self.accelerations[l.0], p.pose.translation);
            vec![(p.link, a.linear + a.angular.cross(r) + t.angular.cross(t.angular.cross(r)))]
        })
    }
}

impl<'g> Scope<'_, 'g> {
    /// Evaluates with another view.
    pub fn with_view<T>(&self, view: View<'g>, f: impl FnOnce(&Self) -> T) -> T {
        let before = self.view.replace(view);
        let result = f(self);
        self.view.replace(before);
        result
    }

    /// What expressions may depend on here.
    pub fn level(&self) -> Level {
        self.view.borrow().level
    }

    /// A vector given in the axes `x`, `y`, `z` of the place where the expression stands.
    pub fn own_axes(&self, v: Vec3<'g>) -> Value<'g> {
        Value::Vector(vec![match &self.view.borrow().home {
            None => (Axes::Own, v),
            Some((link, pose)) => (Axes::Link(*link), pose.rotation.to_parent(v)),
        }])
    }

    /// A vector given in the axes of a body or a frame.
    pub fn named_axes(&self, name: &str, v: Vec3<'g>, at: &Place, cx: &mut Diagnostics) -> Option<Value<'g>> {
        if self.view.borrow().home.is_none() {
            return Some(Value::Vector(vec![(Axes::Of(name.to_string()), v)]));
        }
        if name == GROUND {
            return Some(Value::Vector(vec![(Axes::Link(None), v)]));
        }
        match self.world.borrow().places.get(name) {
            Some(p) => Some(Value::Vector(vec![(Axes::Link(p.link), p.pose.rotation.to_parent(v))])),
            None => {
                cx.error(at.clone(), format!("`{name}` is not placed"));
                None
            }
        }
    }

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
        if self.view.borrow().home.is_none() {
            let all: Vec<_> = read.into_iter().map(|(e, terms)| self.own_sum(terms, e, cx)).collect();
            return Some((Axes::Own, all.into_iter().collect::<Option<_>>()?));
        }
        let links = |terms: Vec<(Axes, Vec3<'g>)>| -> Terms<'g> {
            terms.into_iter().map(|(axes, v)| (link_of(&axes), v)).collect()
        };
        let all: Vec<Terms<'g>> = read.into_iter().map(|(_, terms)| links(terms)).collect();
        let link = all.iter().flatten().next().and_then(|(link, _)| *link);
        let world = self.world.borrow();
        let zero = Vec3::zero(self.graph);
        Some((Axes::Link(link), all.iter().map(|t| world.resolve(t, link, zero)).collect()))
    }

    /// The value of a name that moves: a coordinate, time, an input, a definition. `None` if it is none of these.
    pub fn moving_name(
        &self,
        name: &str,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Option<Value<'g>>> {
        if let Some((_, value)) = self.view.borrow().locals.iter().find(|(local, _)| *local == name) {
            return Some(Some(Value::Scalar(*value)));
        }
        if name == "t" {
            let here = self.allowed(Level::Placement, "time", &e.place, cx);
            return Some(here.then(|| Value::Scalar(Quantity::Time.expr(self.graph))));
        }
        let coordinate = self.world.borrow().coordinates.iter().find(|(n, ..)| n == name).map(|(_, c, _)| *c);
        if let Some(c) = coordinate {
            let here = self.allowed(Level::Placement, &format!("the coordinate `{name}`"), &e.place, cx);
            return Some(here.then(|| Value::Scalar(position_in(self.graph, &c))));
        }
        if let Some(k) = self.inputs.iter().position(|i| i.text == name) {
            let here = self.allowed(Level::Motion, &format!("the input `{name}`"), &e.place, cx);
            return Some(here.then(|| Value::Scalar(Quantity::Input(self.driven + k).expr(self.graph))));
        }
        let definition = self.definitions.iter().find(|d| d.name.text == name)?;
        Some(self.definition(definition, e, cx))
    }

    fn definition(
        &self,
        d: &syntax::Definition,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let name = &d.name.text;
        if cx.is_read() && self.failed.borrow().contains(name) {
            return None;
        }
        let outermost = self.view.borrow().defining.is_empty();
        let key = {
            let view = self.view.borrow();
            (name.clone(), view.level, view.home.is_some())
        };
        if outermost {
            self.known.borrow_mut().clear();
        } else if let Some(known) = self.known.borrow().get(&key) {
            return known.clone();
        }
        let before = cx.len();
        let value = self.define(d, e, cx);
        if value.is_none() && cx.is_read() && cx.len() > before {
            self.failed.borrow_mut().insert(name.clone());
        }
        self.known.borrow_mut().insert(key, value.clone());
        value
    }

    fn define(&self, d: &syntax::Definition, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let name = &d.name.text;
        if self.view.borrow().defining.contains(name) {
            cx.error(d.name.place.clone(), format!("`{name}` is defined by itself"))
                .help("a definition stands for an expression of others");
            return None;
        }
        if self.view.borrow().defining.len() > 64 {
            cx.error(d.name.place.clone(), "definitions are nested too deeply")
                .help("write some of them out");
            return None;
        }
        // Directions without a name are the ground's, wherever the definition is used.
        let mut view = self.view.borrow().clone();
        view.defining.push(name.clone());
        view.locals.clear();
        view.home = view.home.map(|_| (None, Pose::identity(self.graph)));
        let value = self.with_view(view, |scope| scope.value(&d.value, cx))?;
        match (&value, d.vector) {
            (Value::Scalar(_), false) | (Value::Vector(_), true) => Some(value),
            (_, vector) => {
                let (is, said) = if vector { ("a scalar", "Vector") } else { ("a vector", "Scalar") };
                let other = if vector { "Scalar" } else { "Vector" };
                cx.error(e.place.clone(), format!("`{name}` is {is}, but it is declared as a {said}"))
                    .help(format!("declare it as a `{other}`"));
                None
            }
        }
    }

    /// `joint.coordinate`; `None` if there is no such coordinate and no joint of that name.
    pub fn coordinate_member(
        &self,
        joint: &str,
        member: &Name,
        cx: &mut Diagnostics,
    ) -> Option<Option<Value<'g>>> {
        let full = format!("{joint}.{}", member.text);
        let c = self.world.borrow().coordinates.iter().find(|(n, ..)| *n == full).map(|(_, c, _)| *c)?;
        let here = self.allowed(Level::Placement, &format!("the coordinate `{full}`"), &member.place, cx);
        Some(here.then(|| Value::Scalar(position_in(self.graph, &c))))
    }

    /// Reports what may not stand here.
    pub fn allowed(&self, needed: Level, what: &str, place: &Place, cx: &mut Diagnostics) -> bool {
        if self.level() >= needed {
            return true;
        }
        if needed == Level::Reaction {
            cx.error(place.clone(), format!("{what} cannot stand here"))
                .help("reactions stand in outputs: `#[output(reaction_force(joint))]`");
            return false;
        }
        let motion = matches!(needed, Level::Motion | Level::Acceleration);
        if self.level() == Level::Placement && motion && self.constrains.get() {
            cx.error(place.clone(), format!("{what} cannot stand here"))
                .help("a constraint on velocities is a `Nonholonomic`");
            return false;
        }
        let only = match self.level() {
            Level::Constant => "only numbers and parameters",
            Level::Placement => "only numbers, parameters, coordinates and time",
            _ => "no accelerations",
        };
        cx.error(place.clone(), format!("{what} cannot stand here")).help(format!("this place takes {only}"));
        false
    }

    /// `rate(coordinate)`.
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
        let world = self.world.borrow();
        let Some((_, c, _)) = world.coordinates.iter().find(|(n, ..)| *n == name) else {
            let known = world.coordinates.iter().map(|(n, ..)| n.as_str());
            let known: Vec<&str> = known.collect();
            let error = cx.error(argument.place.clone(), "`rate` takes a coordinate");
            match &argument.kind {
                ExprKind::Call(inner, _) if matches!(inner.text.as_str(), "rate" | "r" | "v") => {
                    error.help("velocities and accelerations of points are `v(point / point / frame)` and `a(point / point / frame)`");
                }
                _ => drop(error.suggest(&name, known)),
            }
            if error.is_bare() {
                error.help("a coordinate is a joint with one degree of freedom, `joint.x` of one with several, or a `Coordinate`");
            }
            return None;
        };
        if !self.allowed(Level::Motion, &format!("the rate of `{name}`"), &function.place, cx) {
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
            Some(n) => normal.dot(super::expression::unit(*n)),
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
            ExprKind::Name(name) => match self.world.borrow().places.get(name) {
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
                let view = View::new(Level::Constant, None);
                let at = self.with_view(view, |scope| scope.own_vector(&arguments[0], cx))?;
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
        let world = self.world.borrow();
        let known: Vec<&str> = world.places.keys().map(String::as_str).chain([GROUND]).collect();
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
        match self.world.borrow().places.get(name) {
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
                let world = self.world.borrow();
                let known: Vec<&str> = world.places.keys().map(String::as_str).chain([GROUND]).collect();
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
        let level = match text {
            "r" => Level::Placement,
            "v" | "omega" => Level::Motion,
            _ => Level::Acceleration,
        };
        if !self.allowed(level, &format!("`{text}(…)`"), &function.place, cx) {
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
        let world = self.world.borrow();
        let zero = Vec3::zero(self.graph);
        let of = |all: &[Spatial<'g>], link: Option<LinkId>| link.map_or(zero, |l| all[l.0].angular);
        let difference =
            |all: &[Spatial<'g>]| vec![(frames[0], of(all, frames[0])), (frames[1], -of(all, frames[1]))];
        if text == "omega" {
            return Some(vector(difference(&world.twists)));
        }
        let mut terms = difference(&world.accelerations);
        let w = world.resolve(&difference(&world.twists), frames[2], zero);
        terms.push((frames[2], -of(&world.twists, frames[2]).cross(w)));
        Some(vector(terms))
    }

    /// Relative position, velocity and acceleration. Seen from a frame A that turns with `ω` and `α`:
    /// `v_A = v − ω × r`, `a_A = a − α × r − ω × (ω × r) − 2 ω × v_A`.
    fn moving(&self, text: &str, parts: &[&syntax::Expr], cx: &mut Diagnostics) -> Option<Value<'g>> {
        let (y, x) = (self.place(parts[0], cx), self.place(parts[1], cx));
        let frame = parts.get(2).map(|e| self.frame(e, cx));
        let (y, x) = (y?, x?);
        let world = self.world.borrow();
        let r = world.between(&y, &x);
        let Some(frame) = frame else { return Some(vector(r)) };
        let frame = frame?;
        let zero = Vec3::zero(self.graph);
        let minus = |terms: Terms<'g>| terms.into_iter().map(|(l, v)| (l, -v)).collect::<Terms<'g>>();
        let mut v = world.velocity(&y);
        v.extend(minus(world.velocity(&x)));
        if let Some(l) = frame {
            let w = world.twists[l.0].angular;
            v.push((frame, -w.cross(world.resolve(&r, frame, zero))));
        }
        if text == "v" {
            return Some(vector(v));
        }
        let mut a = world.acceleration(&y);
        a.extend(minus(world.acceleration(&x)));
        if let Some(l) = frame {
            let (w, dw) = (world.twists[l.0].angular, world.accelerations[l.0].angular);
            let (r, v) = (world.resolve(&r, frame, zero), world.resolve(&v, frame, zero));
            let coriolis = w.cross(v);
            a.push((frame, -(dw.cross(r) + w.cross(w.cross(r)) + coriolis + coriolis)));
        }
        Some(vector(a))
    }
}

fn vector<'g>(terms: Terms<'g>) -> Value<'g> {
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
fn flatten(e: &syntax::Expr) -> Vec<&syntax::Expr> {
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
