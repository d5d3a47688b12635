//! Expressions as written → expressions of the graph: names are looked up, scalars and vectors told apart.

use super::flight::{ANGLES, OF_HEIGHT};
use super::functions;
use super::scope::{Axes, Scope, Value};
use super::slips::{DOMAIN, VECTOR, check_angle, degrees, wrong_count};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Extreme, Function, Lookup, Vec3};
use crate::kinematics::unit;
use crate::syntax::{self, BinaryOp, ExprKind, IF, Name, words};

impl<'a, 'g> Scope<'a, 'g> {
    /// A scalar.
    pub fn scalar(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Expr<'g>> {
        match self.value(e, cx)? {
            Value::Scalar(s) => Some(s),
            Value::Vector(_) => {
                cx.error(e.place.clone(), "expected a scalar, found a vector")
                    .help("its length is `norm(v)`, its component along a direction `dot(v, x)`");
                None
            }
            Value::Matrix(_) => {
                cx.error(e.place.clone(), "expected a scalar, found a matrix")
                    .help("an entry of it is `dot(x, M * y)`, the sum of those of its diagonal `trace(M)`");
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

    /// A vector as a sum over axes, with the help for a scalar in its place. What is in `e` is read once,
    /// however deep expressions are nested.
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
            Value::Matrix(_) => {
                cx.error(e.place.clone(), "expected a vector, found a matrix")
                    .help("a matrix times a vector is one: `M * v`");
                None
            }
        }
    }

    /// Returns the value of an expression, or reports an error; a value that is not finite is an error as
    /// well.
    ///
    /// The left operands of a chain of operators, such as a long sum, are visited in a loop: the depth of the
    /// recursion is the nesting of brackets and signs, which `syntax::guard` bounds.
    pub fn value(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
        let mut operations = Vec::new();
        let mut first = e;
        while let ExprKind::Binary(op, left, right, _) = &first.kind
            && self.deciding(first).is_none()
        {
            operations.push((*op, &**right, first));
            first = left;
        }
        let mut value = self.operand(first, cx).and_then(|value| finite(value, first, cx));
        for (op, right, whole) in operations.into_iter().rev() {
            let right = self.value(right, cx);
            let both = value.zip(right);
            value = both.and_then(|(left, right)| self.binary(op, left, right, whole, cx));
            value = value.and_then(|value| finite(value, whole, cx));
        }
        value
    }

    /// Returns the value of an expression that is no binary operation.
    fn operand(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
        if let Some(symbol) = self.deciding(e) {
            return Some(Value::Scalar(symbol));
        }
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
                Value::Matrix(m) => Value::Matrix(m.map(|entry| -entry)),
            }),
            ExprKind::Binary(..) => self.value(e, cx),
            ExprKind::Call(function, arguments) => self.call(function, arguments, cx),
            ExprKind::Array(items)
                if !items.is_empty() && items.iter().all(|item| matches!(item.kind, ExprKind::Array(_))) =>
            {
                self.matrix_by_rows(e, cx)
            }
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
            (op, left @ Value::Matrix(_), right) | (op, left, right @ Value::Matrix(_)) => {
                return self.matrix_binary(op, left, right, e, cx);
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
            return self.elementary(*f, function, arguments, cx);
        }
        if let Some(k) = self.tables.iter().position(|table| table.name.text == text) {
            return self.lookup(k, function, arguments, cx);
        }
        let two_scalars = |cx: &mut Diagnostics| match arguments {
            [a, b] => self.scalar(a, cx).zip(self.scalar(b, cx)),
            _ => wrong_count(function, 2, cx),
        };
        match text {
            IF => self.pieces(arguments, cx).map(Value::Scalar),
            "degrees" => match arguments {
                [angle] => self.scalar(angle, cx).map(|angle| Value::Scalar(degrees(angle))),
                _ => wrong_count(function, 1, cx),
            },
            "atan2" => two_scalars(cx).map(|(y, x)| Value::Scalar(y.atan2(x))),
            "pow" => {
                let (base, exponent) = two_scalars(cx)?;
                check_power(function, base, exponent, cx).then(|| Value::Scalar(base.pow(exponent)))
            }
            "min" => two_scalars(cx).map(|(a, b)| Value::Scalar(a.extreme(Extreme::Min, b))),
            "max" => two_scalars(cx).map(|(a, b)| Value::Scalar(a.extreme(Extreme::Max, b))),
            "dot" | "cross" | "project" => self.vector_product(function, arguments, cx),
            "norm" | "unit" => self.size_or_direction(function, arguments, cx),
            "angle" => self.angle(function, arguments, cx),
            "r" | "v" | "a" | "omega" | "alpha" => self.slash(function, arguments, cx),
            "reaction_force" | "reaction_torque" => self.reaction(function, arguments, cx),
            "contact_force" | "contact_moment" => self.exerted(function, arguments, cx),
            "momentum" | "angular_momentum" | "kinetic_energy" => self.momentum(function, arguments, cx),
            "moment_of_inertia" => self.moment_of_inertia(function, arguments, cx),
            "center_of_mass" => self.center_of_mass(function, arguments, cx),
            "center_of_percussion" => self.center_of_percussion(function, arguments, cx),
            "instant_center" | "acceleration_center" | "screw_axis" | "screw_pitch" => {
                self.center(function, arguments, cx)
            }
            "projector" | "skew" | "outer" | "transpose" | "trace" | "rotation" | "inertia" | "identity" => {
                self.matrix_function(function, arguments, cx)
            }
            "curvature" | "torsion" => self.bend(function, arguments, cx),
            "cable" => self.cable(function, arguments, cx),
            "gradient" => self.gradient(function, arguments, cx),
            "power" => self.power(function, arguments, cx),
            "rate" => self.rate_of(function, arguments, cx),
            "stability_axes" | "wind_axes" => self.in_flight_axes(function, arguments, cx),
            _ if OF_HEIGHT.contains(&text) => self.air(function, arguments, cx),
            _ if ANGLES.contains(&text) => self.flight_angle(function, arguments, cx),
            _ => {
                self.report_function(function, cx);
                None
            }
        }
    }

    /// An elementary function of a number or an angle.
    fn elementary(
        &self,
        f: Function,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let [argument] = arguments else {
            return wrong_count(function, 1, cx);
        };
        let turns = matches!(f, Function::Sin | Function::Cos | Function::Tan);
        if turns && !check_angle(argument, cx) {
            return None;
        }
        let s = self.scalar(argument, cx)?.call(f);
        if let crate::expr::Node::Call(f, inner) = s.node()
            && let Some(number) = self.graph.expr(inner).value()
        {
            let what = if f.apply(number).is_nan() { "not defined" } else { "infinite" };
            cx.error(argument.place.clone(), format!("`{}` is {what} at {number}", f.name())).help(DOMAIN);
            return None;
        }
        Some(Value::Scalar(s))
    }

    /// `dot(a, b)`, `cross(a, b)`, `project(a, b)`.
    fn vector_product(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let [a, b] = arguments else {
            return wrong_count(function, 2, cx);
        };
        let (axes, v) = self.common_axes(&[a, b], cx)?;
        let (a, b) = (v[0], v[1]);
        Some(match function.text.as_str() {
            "dot" => Value::Scalar(a.dot(b)),
            "cross" => Value::Vector(vec![(axes, a.cross(b))]),
            _ => Value::Vector(vec![(axes, b * (a.dot(b) / b.dot(b)))]),
        })
    }

    /// `norm(a)`, `unit(a)`.
    fn size_or_direction(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let [a] = arguments else {
            return wrong_count(function, 1, cx);
        };
        let is_size = function.text == "norm";
        let help = if is_size { "the size of a scalar is `abs(a)`" } else { "a scalar has no direction" };
        let vector = self.vector_or(a, help, cx)?;
        let (axes, v) = self.in_common_axes(vec![(a, vector)], cx)?;
        if is_size {
            return Some(Value::Scalar(v[0].length()));
        }
        if v[0].is_zero() {
            cx.error(a.place.clone(), "the zero vector has no direction")
                .help("a direction is a vector of some length");
            return None;
        }
        Some(Value::Vector(vec![(axes, unit(v[0]))]))
    }

    /// Says that a function is not known, and which is meant.
    fn report_function(&self, function: &Name, cx: &mut Diagnostics) {
        let text = function.text.as_str();
        let own = self.tables.iter().map(|table| table.name.text.as_str());
        let known = Function::ALL.iter().map(|(name, _)| *name).chain(functions::names()).chain(own);
        let known: Vec<&str> = known.collect();
        let error = cx.error(function.place.clone(), format!("unknown function `{text}`"));
        let greek = words::spelt_otherwise(text, &known);
        match (greek, super::inertia::SOLIDS.iter().any(|(solid, ..)| *solid == text)) {
            (Some(name), _) => drop(error.help(format!("did you mean `{name}`?"))),
            (_, true) => drop(error.help(format!("`{text}` is a solid: it stands in `inertia = …`"))),
            _ => words::point(error, words::FUNCTIONS, text, &known),
        }
        if error.is_bare() {
            error.help("known are the elementary functions and those of vectors: `sin`, `sqrt`, `pow`, `min`, `dot`, `cross`, `norm`, …");
        }
    }
}

impl<'g> Scope<'_, 'g> {
    /// The value of a table.
    fn lookup(
        &self,
        k: usize,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let table = self.tables.get(k)?;
        let (found, expected) = (arguments.len(), table.variables);
        if found != expected {
            let plural = if expected == 1 { "" } else { "s" };
            cx.error(
                function.place.clone(),
                format!(
                    "`{}` is a table of {expected} variable{plural}, but {found} stand here",
                    function.text
                ),
            )
            .help(format!("it is declared as `Table<{expected}>`"));
            return None;
        }
        let values: Vec<Option<Expr<'g>>> = arguments.iter().map(|a| self.scalar(a, cx)).collect();
        let values = values.into_iter().collect::<Option<Vec<_>>>()?;
        if let Some(used) = self.used_tables.borrow_mut().get_mut(k) {
            *used = true;
        }
        let x = std::array::from_fn(|k| values.get(k).copied().unwrap_or(self.graph.zero()));
        Some(Value::Scalar(self.graph.lookup(Lookup::new(k, expected), x)))
    }
}

/// Reports powers that are no numbers whatever the state is.
fn check_power(function: &Name, base: Expr<'_>, exponent: Expr<'_>, cx: &mut Diagnostics) -> bool {
    let Some(x) = base.value() else { return true };
    let what = match exponent.value() {
        Some(n) if x.powf(n).is_finite() => return true,
        Some(n) if x.powf(n).is_nan() => format!("`pow` is not defined at {x} and {n}"),
        Some(n) => format!("`pow` is infinite at {x} and {n}"),
        None if x >= 0.0 => return true,
        None => format!("powers of {x} are defined for whole exponents alone"),
    };
    let help = "the first argument of `pow` is the base, the second the exponent: a base that may be negative takes a whole number";
    cx.error(function.place.clone(), what).help(help);
    false
}

/// Returns the value if it is finite, else reports an error at the expression.
fn finite<'g>(value: Value<'g>, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Value<'g>> {
    let is_finite = |s: &Expr<'g>| s.value().is_none_or(f64::is_finite);
    let is_valid = match &value {
        Value::Scalar(s) => is_finite(s),
        Value::Vector(terms) => terms.iter().all(|(_, v)| v.0.iter().all(is_finite)),
        Value::Matrix(m) => m.entries.0.iter().flatten().all(is_finite),
    };
    if !is_valid {
        cx.error(e.place.clone(), "the value of this is not a finite number")
            .help("the largest number is about 1e308: use smaller figures");
    }
    is_valid.then_some(value)
}

/// A sum of vectors by their axes.
pub fn sum<'g>(mut a: Vec<(Axes, Vec3<'g>)>, b: Vec<(Axes, Vec3<'g>)>) -> Vec<(Axes, Vec3<'g>)> {
    for (axes, v) in b {
        match a.iter_mut().find(|(known, _)| *known == axes) {
            Some((_, sum)) => *sum += v,
            None => a.push((axes, v)),
        }
    }
    a
}
