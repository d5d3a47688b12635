//! Expressions as written → expressions of the graph: names are looked up, scalars and vectors told apart.

use super::axis::check_rotation_matrix;
use super::slips::{
    DOMAIN, MATRIX, VECTOR, check_angle, degrees, is_rotation, report_matrix, report_rotation, wrong_count,
};
use super::tree::GROUND;
use super::world::{Level, View, World};
use crate::diag::Diagnostics;
use crate::expr::diff::TINY;
use crate::expr::{Expr, Extreme, Function, Graph, Mat3, Rotation, Vec3};
use crate::mechanism::{LinkId, Quantity};
use crate::syntax::{self, BinaryOp, ExprKind, Name, words};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// What names mean where an expression stands.
pub struct Scope<'a, 'g> {
    /// Owner of the expressions.
    pub graph: &'g Graph,
    /// Parameters of the struct.
    pub parameters: &'a [Name],
    /// Whether each parameter was used.
    pub used: std::cell::RefCell<Vec<bool>>,
    /// Names of bodies and particles.
    pub bodies: Vec<String>,
    /// Names of frames.
    pub frames: Vec<String>,
    /// Names of joints.
    pub joints: Vec<String>,
    /// Names of force elements.
    pub actions: Vec<String>,
    /// Names of inputs, in order, after those of driven joints.
    pub inputs: &'a [Name],
    /// How many joints are driven by inputs of their own.
    pub driven: usize,
    /// Names for expressions.
    pub definitions: &'a [syntax::Definition],
    /// What expressions may depend on, and what `x`, `y` and `z` alone mean.
    pub view: RefCell<View<'g>>,
    /// What is placed so far, and how it moves.
    pub world: RefCell<World<'g>>,
    /// Names without a value that were told: each once, most likely a declaration is missing.
    pub unknown: RefCell<BTreeSet<String>>,
    /// Numbers are `f32`.
    pub single: bool,
    /// Definitions whose mistakes were told.
    pub failed: RefCell<BTreeSet<String>>,
    /// A constraint on configurations is being read.
    pub constrains: std::cell::Cell<bool>,
    /// Definitions that were looked up for the one whose value is asked for: each once, however often the others name it.
    pub known: RefCell<Known<'g>>,
}

/// Values of definitions, by name, by what they may depend on, and by whether `x`, `y` and `z` alone are the ground's; `None`
/// for those with mistakes.
pub type Known<'g> = BTreeMap<(String, Level, bool), Option<Value<'g>>>;

/// The axes that a vector is given in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Those of the frame that the attribute belongs to.
    Own,
    /// Those of a named body (or `ground`), where the links are not yet known.
    Of(String),
    /// Those of a link, or of the ground.
    Link(Option<LinkId>),
}

/// A value: a scalar, or a vector as a sum over axes.
#[derive(Clone, Debug)]
pub enum Value<'g> {
    /// A number.
    Scalar(Expr<'g>),
    /// A physical vector.
    Vector(Vec<(Axes, Vec3<'g>)>),
}

impl Value<'_> {
    fn word(&self) -> &'static str {
        match self {
            Value::Scalar(_) => "a scalar",
            Value::Vector(_) => "a vector",
        }
    }
}

/// Names with a value in every expression.
const CONSTANTS: [(&str, f64); 1] = [("pi", std::f64::consts::PI)];

/// Functions of the language beside the elementary ones.
const FUNCTIONS: [&str; 19] = [
    "atan2",
    "degrees",
    "pow",
    "min",
    "max",
    "dot",
    "cross",
    "norm",
    "unit",
    "r",
    "v",
    "a",
    "omega",
    "alpha",
    "rate",
    "angle",
    "project",
    "reaction_force",
    "reaction_torque",
];

impl<'a, 'g> Scope<'a, 'g> {
    /// What a known name stands for, with its article.
    pub fn what(&self, name: &str) -> Option<&'static str> {
        let is = |list: &[String]| list.iter().any(|known| known == name);
        match name {
            _ if self.parameters.iter().any(|p| p.text == name) => Some("a parameter"),
            _ if is(&self.frames) => Some("a frame"),
            _ if name == GROUND || is(&self.bodies) => Some("a body"),
            _ if is(&self.joints) => Some("a joint"),
            _ if self.inputs.iter().any(|i| i.text == name) => Some("an input"),
            _ if self.definitions.iter().any(|d| d.name.text == name) => Some("a definition"),
            _ if is(&self.actions) => Some("a force element"),
            "x" | "y" | "z" => Some("a direction"),
            "pi" => Some("a number"),
            _ => None,
        }
    }

    /// True where a name that is not known is met for the first time: later it is no news.
    pub fn is_news(&self, name: &str, cx: &Diagnostics) -> bool {
        !cx.is_read() || self.unknown.borrow_mut().insert(name.to_string())
    }

    /// A scalar.
    pub fn scalar(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Expr<'g>> {
        match self.value(e, cx)? {
            Value::Scalar(s) => Some(s),
            Value::Vector(_) => {
                cx.error(e.place.clone(), "expected a scalar, found a vector")
                    .help("its length is `norm(v)`, its component along a direction `dot(v, x)`");
                None
            }
        }
    }

    /// A vector in the attribute's own axes.
    pub fn own_vector(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Vec3<'g>> {
        self.vector(e, cx).and_then(|terms| self.own_sum(terms, e, cx))
    }

    /// The sum of a vector's terms, all in the attribute's own axes.
    pub fn own_sum(
        &self,
        terms: Vec<(Axes, Vec3<'g>)>,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Vec3<'g>> {
        let mut sum = Vec3::zero(self.graph);
        for (axes, v) in terms {
            if let Axes::Of(body) = axes {
                cx.error(e.place.clone(), format!("this vector is given in the axes of `{body}`"))
                    .help("here only the frame's own axes `x`, `y` and `z` can stand");
                return None;
            }
            sum += v;
        }
        Some(sum)
    }

    /// A vector as a sum over axes.
    pub fn vector(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Vec<(Axes, Vec3<'g>)>> {
        self.vector_or(e, "multiply it by a direction, as in `length * y`", cx)
    }

    /// A vector as a sum over axes, with the help for a scalar in its place. What is in `e` is read once, however deep
    /// expressions are nested.
    pub fn vector_or(
        &self,
        e: &syntax::Expr,
        help: &str,
        cx: &mut Diagnostics,
    ) -> Option<Vec<(Axes, Vec3<'g>)>> {
        match self.value(e, cx)? {
            Value::Vector(v) => Some(v),
            // The number zero is the zero vector too.
            Value::Scalar(s) if s.is_zero() => Some(vec![(Axes::Own, Vec3::zero(self.graph))]),
            Value::Scalar(_) => {
                cx.error(e.place.clone(), "expected a vector, found a scalar").help(help);
                None
            }
        }
    }

    /// Successive rotations about carried axes.
    pub fn rotation(&self, steps: &[syntax::Expr], cx: &mut Diagnostics) -> Option<Rotation<'g>> {
        let mut whole = Some(Rotation::identity(self.graph));
        for step in steps {
            if !is_rotation(step) {
                report_rotation(step, cx);
                return None;
            }
            let next = self.rotation_step(step, cx);
            whole = whole.zip(next).map(|(whole, next)| whole.then(&next));
        }
        whole
    }

    fn rotation_step(&self, step: &syntax::Expr, cx: &mut Diagnostics) -> Option<Rotation<'g>> {
        match &step.kind {
            ExprKind::Call(axis, arguments) => {
                let k = ["x", "y", "z"].iter().position(|a| *a == axis.text);
                match (k, axis.text.as_str(), arguments.as_slice()) {
                    (Some(k), _, [angle]) => {
                        return Some(Rotation::about_axis(k, self.plane_angle(angle, cx)?));
                    }
                    (_, "eigenaxis", [n, angle]) => {
                        let n = self.unit_vector(n, false, cx);
                        let angle = self.plane_angle(angle, cx);
                        return Some(Rotation::eigenaxis(n?, angle?));
                    }
                    (_, "quaternion", [x, y, z, w]) => {
                        let parts: Vec<_> = [x, y, z, w].iter().map(|e| self.scalar(e, cx)).collect();
                        let q = [parts[0]?, parts[1]?, parts[2]?, parts[3]?];
                        let square = q.iter().fold(self.graph.zero(), |sum, c| sum + c.square());
                        if square.value().is_some_and(|n| (n - 1.0).abs() > 1e-9) {
                            cx.error(step.place.clone(), "this quaternion is not of unit length")
                                .help("its four numbers are x, y, z, w, and their squares add up to one");
                            return None;
                        }
                        return Some(Rotation::quaternion(q));
                    }
                    _ => {}
                }
            }
            ExprKind::Array(_) => {
                let matrix = self.matrix(step, cx)?;
                return check_rotation_matrix(&matrix, &step.place, cx)
                    .then(|| Rotation::from_matrix(matrix));
            }
            _ => {}
        }
        report_rotation(step, cx);
        None
    }

    /// An angle, rad. A plain number beyond a full turn is most likely meant in degrees.
    pub fn plane_angle(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Expr<'g>> {
        if check_angle(e, cx) { self.scalar(e, cx) } else { None }
    }

    /// A 3×3 matrix written as an array of rows.
    pub fn matrix(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Mat3<'g>> {
        let mut m = Mat3::zero(self.graph);
        let rows = match &e.kind {
            ExprKind::Array(rows) if rows.len() == 3 => rows,
            _ => {
                report_matrix(e, cx);
                return None;
            }
        };
        if rows.iter().all(|row| !matches!(row.kind, ExprKind::Array(_) | ExprKind::Tuple(_))) {
            report_matrix(e, cx);
            return None;
        }
        for (i, row) in rows.iter().enumerate() {
            match &row.kind {
                ExprKind::Array(entries) if entries.len() == 3 => {
                    for (j, entry) in entries.iter().enumerate() {
                        m.0[i][j] = self.scalar(entry, cx)?;
                    }
                }
                _ => {
                    cx.error(row.place.clone(), "expected a row of three numbers").help(MATRIX);
                    return None;
                }
            }
        }
        Some(m)
    }

    /// The value of an expression; a number that is not finite is a mistake.
    pub fn value(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let value = self.any_value(e, cx)?;
        let infinite = |s: &Expr<'g>| s.value().is_some_and(|n| !n.is_finite());
        let bad = match &value {
            Value::Scalar(s) => infinite(s),
            Value::Vector(terms) => terms.iter().any(|(_, v)| v.0.iter().any(infinite)),
        };
        if bad {
            cx.error(e.place.clone(), "the value of this is not a finite number")
                .help("the largest number is about 1e308: use smaller figures");
            return None;
        }
        Some(value)
    }

    fn any_value(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
        match &e.kind {
            ExprKind::Number(n) => {
                let small = *n != 0.0 && n.abs() < f64::from(f32::MIN_POSITIVE);
                if self.single && (small || n.abs() > f64::from(f32::MAX)) {
                    let what = if small { "small" } else { "large" };
                    cx.error(e.place.clone(), format!("this number is too {what} for `f32`: {n:e}"))
                        .help("use `f64`, or other units");
                    return None;
                }
                Some(Value::Scalar(self.graph.num(*n)))
            }
            ExprKind::Name(name) => self.name(name, e, cx),
            ExprKind::Field(inner, member) => self.member(inner, member, cx),
            ExprKind::Neg(inner) => Some(match self.value(inner, cx)? {
                Value::Scalar(s) => Value::Scalar(-s),
                Value::Vector(v) => Value::Vector(v.into_iter().map(|(a, v)| (a, -v)).collect()),
            }),
            ExprKind::Binary(op, left, right, _) => {
                let (left, right) = (self.value(left, cx), self.value(right, cx));
                self.binary(*op, left?, right?, e, cx)
            }
            ExprKind::Call(function, arguments) => self.call(function, arguments, cx),
            ExprKind::Array(items) if items.len() == 3 => {
                let parts: Vec<Option<Expr<'g>>> = items.iter().map(|i| self.scalar(i, cx)).collect();
                let vector = Vec3([parts[0]?, parts[1]?, parts[2]?]);
                Some(self.own_axes(vector))
            }
            ExprKind::Method(_, method, _) => {
                self.report_method(e, method, cx);
                None
            }
            ExprKind::Array(items) => {
                cx.error(e.place.clone(), format!("a vector has three components, found {}", items.len()))
                    .help(VECTOR);
                None
            }
            ExprKind::Tuple(items) => {
                let error = cx.error(e.place.clone(), "expected a scalar or a vector, found a list");
                match items.as_slice() {
                    [a, b, c] => error.help(format!(
                        "write `[{}, {}, {}]` for a vector",
                        a.spelt(),
                        b.spelt(),
                        c.spelt()
                    )),
                    _ => error.help(VECTOR),
                };
                None
            }
        }
    }

    fn name(&self, name: &str, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
        // A parameter cannot have the name of an axis, which was told: which of them is meant is not known.
        let taken = ["x", "y", "z"].contains(&name) && self.parameters.iter().any(|p| p.text == name);
        if taken {
            return None;
        }
        if let Some(k) = ["x", "y", "z"].iter().position(|a| *a == name) {
            return Some(self.own_axes(Vec3::axis(self.graph, k)));
        }
        if let Some(k) = self.parameters.iter().position(|p| p.text == name) {
            self.used.borrow_mut()[k] = true;
            return Some(Value::Scalar(Quantity::Parameter(k).expr(self.graph)));
        }
        if let Some((_, value)) = CONSTANTS.iter().find(|(c, _)| *c == name) {
            return Some(Value::Scalar(self.graph.num(*value)));
        }
        if let Some(value) = self.moving_name(name, e, cx) {
            return value;
        }
        if self.bodies.iter().any(|b| b == name) || name == GROUND {
            cx.error(e.place.clone(), format!("`{name}` is a body, not a value"))
                .help(format!("its axes are `{name}.x`, `{name}.y` and `{name}.z`"));
        } else if let Some(what) = self.what(name) {
            cx.error(e.place.clone(), format!("`{name}` is {what}, which has no value here"))
                .help("an expression is made of parameters, numbers and directions");
        } else {
            let world = self.world.borrow();
            let mut known: Vec<&str> = self.parameters.iter().map(|p| p.text.as_str()).collect();
            if self.level() >= Level::Placement {
                known.extend(world.coordinates.iter().map(|(name, ..)| name.as_str()));
                known.extend(self.definitions.iter().map(|d| d.name.text.as_str()));
            }
            if self.level() >= Level::Motion {
                known.extend(self.inputs.iter().map(|i| i.text.as_str()));
            }
            if !self.is_news(name, cx) {
                return None;
            }
            let rates: Vec<&str> = world.coordinates.iter().map(|(name, ..)| name.as_str()).collect();
            known.extend(["x", "y", "z", "pi"]);
            let error = cx.error(e.place.clone(), format!("unknown name `{name}`"));
            words::point_name(error, name, &known, &rates);
        }
        None
    }

    fn member(&self, inner: &syntax::Expr, member: &Name, cx: &mut Diagnostics) -> Option<Value<'g>> {
        if let ExprKind::Name(joint) = &inner.kind
            && let Some(value) = self.coordinate_member(joint, member, cx)
        {
            return value;
        }
        let ExprKind::Name(body) = &inner.kind else {
            let diagnostic = cx.error(member.place.clone(), format!("`.{}` has no value here", member.text));
            let axis = ["x", "y", "z"].into_iter().find(|axis| *axis == member.text).unwrap_or("x");
            diagnostic.help(format!("a component of a vector is `dot(vector, {axis})`"));
            return None;
        };
        if body == "self" {
            cx.error(inner.place.clone(), "parameters are named without `self`")
                .help(format!("write `{}`", member.text));
            return None;
        }
        if body != GROUND && !self.bodies.contains(body) {
            if self.report_joint_member(body, inner, member, cx) {
                return None;
            }
            if let Some(what) = self.what(body) {
                cx.error(inner.place.clone(), format!("`{body}` is {what} and has no axes"))
                    .help("write `x`, `y`, `z` for the axes at hand, or `body.x` for those of a body");
                return None;
            }
            let known = self.bodies.iter().map(String::as_str).chain([GROUND]);
            let known: Vec<&str> = known.collect();
            if !self.is_news(body, cx) {
                return None;
            }
            let error = cx.error(inner.place.clone(), format!("unknown body `{body}`"));
            if matches!(body.as_str(), "body" | "this" | "own" | "local" | "frame" | "me") {
                error.help("`x`, `y` and `z` alone are the axes of the frame at hand");
                return None;
            }
            words::point(error, words::BODIES, body, &known);
            return None;
        }
        let Some(k) = ["x", "y", "z"].iter().position(|a| *a == member.text) else {
            let help = match member.text.as_str() {
                "position" | "pos" | "r" | "origin" | "p" => format!("its place is `r({body} / ground)`"),
                "velocity" | "vel" | "v" | "speed" => {
                    format!("its velocity is `v({body} / ground / ground)`")
                }
                "acceleration" | "acc" => format!("its acceleration is `a({body} / ground / ground)`"),
                "omega" | "w" | "angular_velocity" | "rate" if body != GROUND => {
                    format!("it turns by `omega({body} / ground)`")
                }
                "mass" | "m" | "inertia" | "com" | "length" | "radius" | "l" | "I" | "height" | "width" => {
                    "its figures have no names here: name the parameter that it is".to_string()
                }
                _ => "its axes are `x`, `y` and `z`, and `body.at(vector)` is a place".to_string(),
            };
            cx.error(member.place.clone(), format!("a body has no `{}`", member.text)).help(help);
            return None;
        };
        self.named_axes(body, Vec3::axis(self.graph, k), &inner.place, cx)
    }

    fn binary(
        &self,
        op: BinaryOp,
        left: Value<'g>,
        right: Value<'g>,
        e: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        use Value::{Scalar, Vector};
        Some(match (op, left, right) {
            (BinaryOp::Add, Scalar(a), Scalar(b)) => Scalar(a + b),
            (BinaryOp::Sub, Scalar(a), Scalar(b)) => Scalar(a - b),
            (BinaryOp::Mul, Scalar(a), Scalar(b)) => Scalar(a * b),
            (BinaryOp::Div, _, Scalar(b)) if b.is_zero() => {
                cx.error(e.place.clone(), "division by zero")
                    .help("the divisor is the number zero, or cancels to it");
                return None;
            }
            (BinaryOp::Div, Scalar(a), Scalar(b)) => Scalar(a / b),
            (BinaryOp::Add, Vector(a), Vector(b)) => Vector(sum(a, b)),
            (BinaryOp::Sub, Vector(a), Vector(b)) => {
                Vector(sum(a, b.into_iter().map(|(axes, v)| (axes, -v)).collect()))
            }
            (BinaryOp::Mul, Scalar(s), Vector(v)) | (BinaryOp::Mul, Vector(v), Scalar(s)) => {
                Vector(v.into_iter().map(|(a, v)| (a, v * s)).collect())
            }
            (BinaryOp::Div, Vector(v), Scalar(s)) => {
                Vector(v.into_iter().map(|(a, v)| (a, v.map(|c| c / s))).collect())
            }
            (BinaryOp::Mul, Vector(_), Vector(_)) => {
                cx.error(e.place.clone(), "the product of two vectors is not defined")
                    .help("write `dot(a, b)` or `cross(a, b)`");
                return None;
            }
            (BinaryOp::Div, left, Vector(_)) => {
                cx.error(e.place.clone(), format!("{} cannot be divided by a vector", left.word()))
                    .help("divide by its length, `norm(v)`");
                return None;
            }
            (_, left, right) => {
                let verb = if op == BinaryOp::Add { "added to" } else { "subtracted from" };
                let (what, from) = if op == BinaryOp::Add { (&left, &right) } else { (&right, &left) };
                cx.error(e.place.clone(), format!("{} cannot be {verb} {}", what.word(), from.word()))
                    .help("multiply the scalar by a direction, as in `length * y`");
                return None;
            }
        })
    }

    fn call(&self, function: &Name, arguments: &[syntax::Expr], cx: &mut Diagnostics) -> Option<Value<'g>> {
        let text = function.text.as_str();
        if let Some((_, f)) = Function::ALL.iter().find(|(name, _)| *name == text) {
            let [argument] = arguments else {
                return wrong_count(function, 1, cx);
            };
            let turns = matches!(f, Function::Sin | Function::Cos | Function::Tan);
            if turns && !check_angle(argument, cx) {
                return None;
            }
            let s = self.scalar(argument, cx)?.call(*f);
            if let crate::expr::Node::Call(f, inner) = s.node()
                && let Some(number) = self.graph.expr(inner).value()
            {
                let what = if f.apply(number).is_nan() { "not defined" } else { "infinite" };
                cx.error(argument.place.clone(), format!("`{}` is {what} at {number}", f.name()))
                    .help(DOMAIN);
                return None;
            }
            return Some(Value::Scalar(s));
        }
        let two_scalars = |cx: &mut Diagnostics| match arguments {
            [a, b] => self.scalar(a, cx).zip(self.scalar(b, cx)),
            _ => wrong_count(function, 2, cx),
        };
        match text {
            "degrees" => match arguments {
                [angle] => self.scalar(angle, cx).map(|angle| Value::Scalar(degrees(angle))),
                _ => wrong_count(function, 1, cx),
            },
            "atan2" => two_scalars(cx).map(|(y, x)| Value::Scalar(y.atan2(x))),
            "pow" => two_scalars(cx).map(|(a, b)| Value::Scalar(a.pow(b))),
            "min" => two_scalars(cx).map(|(a, b)| Value::Scalar(a.extreme(Extreme::Min, b))),
            "max" => two_scalars(cx).map(|(a, b)| Value::Scalar(a.extreme(Extreme::Max, b))),
            "dot" | "cross" | "project" => {
                let [a, b] = arguments else {
                    return wrong_count(function, 2, cx);
                };
                let (axes, v) = self.common_axes(&[a, b], cx)?;
                let (a, b) = (v[0], v[1]);
                Some(match text {
                    "dot" => Value::Scalar(a.dot(b)),
                    "cross" => Value::Vector(vec![(axes, a.cross(b))]),
                    _ => Value::Vector(vec![(axes, b * (a.dot(b) / b.dot(b)))]),
                })
            }
            "norm" | "unit" => {
                let [a] = arguments else {
                    return wrong_count(function, 1, cx);
                };
                let help = if text == "norm" {
                    "the size of a scalar is `abs(a)`"
                } else {
                    "a scalar has no direction"
                };
                let vector = self.vector_or(a, help, cx)?;
                let (axes, v) = self.in_common_axes(vec![(a, vector)], cx)?;
                if text == "norm" {
                    return Some(Value::Scalar(v[0].length()));
                }
                if v[0].is_zero() {
                    cx.error(a.place.clone(), "the zero vector has no direction")
                        .help("a direction is a vector of some length");
                    return None;
                }
                Some(Value::Vector(vec![(axes, unit(v[0]))]))
            }
            "angle" => self.angle(function, arguments, cx),
            "r" | "v" | "a" | "omega" | "alpha" => self.slash(function, arguments, cx),
            "reaction_force" | "reaction_torque" => self.reaction(function, arguments, cx),
            "rate" => self.rate_of(function, arguments, cx),
            _ => {
                let known: Vec<&str> = Function::ALL.iter().map(|(name, _)| *name).chain(FUNCTIONS).collect();
                let error = cx.error(function.place.clone(), format!("unknown function `{text}`"));
                let greek = words::spelt_otherwise(text, &known);
                match (greek, super::inertia::SOLIDS.iter().any(|(solid, _)| *solid == text)) {
                    (Some(name), _) => drop(error.help(format!("did you mean `{name}`?"))),
                    (_, true) => drop(error.help(format!("`{text}` is a solid: it stands in `inertia = …`"))),
                    _ => words::point(error, words::FUNCTIONS, text, &known),
                }
                if error.is_bare() {
                    error.help("known are the elementary functions and those of vectors: `sin`, `sqrt`, `pow`, `min`, `dot`, `cross`, `norm`, …");
                }
                None
            }
        }
    }
}

/// True for a function of the language that has a value.
pub fn is_function(name: &str) -> bool {
    FUNCTIONS.contains(&name) || Function::ALL.iter().any(|(known, _)| *known == name)
}

fn sum<'g>(mut a: Vec<(Axes, Vec3<'g>)>, b: Vec<(Axes, Vec3<'g>)>) -> Vec<(Axes, Vec3<'g>)> {
    for (axes, v) in b {
        match a.iter_mut().find(|(known, _)| *known == axes) {
            Some((_, sum)) => *sum += v,
            None => a.push((axes, v)),
        }
    }
    a
}

/// A vector divided by its length. The zero vector has no direction; the result is zero then, not NaN.
pub fn unit(v: Vec3<'_>) -> Vec3<'_> {
    match v.values() {
        Some(_) => v.map(|c| c / v.norm()),
        None => {
            let length = (v.dot(v) + v[0].num(TINY)).sqrt();
            v.map(|c| c / length)
        }
    }
}
