//! The walk over an expression: what its parts are, and what must be alike.

use super::infer::{Inference, Meaning, Origin, Reason};
use super::ratio::Ratio;
use super::si::{
    ACCELERATION, ANGULAR_MOMENTUM, DENSITY, ENERGY, FORCE, INERTIA, LENGTH, MOMENTUM, PLAIN, POWER,
    PRESSURE, RATE, RATE_OF_RATE, SPEED, TIME,
};
use super::unify::{Dimension, Variable};
use super::value::{Anchor, Value, product};
use crate::expr::Function;
use crate::syntax::{BinaryOp, Expr, ExprKind, IF, Name};

impl<'a> Inference<'a> {
    /// The dimension of an expression.
    pub fn value(&mut self, e: &'a Expr) -> Value {
        match &e.kind {
            ExprKind::Number(n) => Value::Number(*n),
            ExprKind::Name(name) => self.name(name),
            ExprKind::Field(inner, member) => self.member(inner, member),
            ExprKind::Neg(inner) => self.value(inner).negated(),
            ExprKind::Binary(BinaryOp::Mul | BinaryOp::Div, ..) => self.product(e),
            ExprKind::Binary(..) => self.sum(e, None),
            ExprKind::Call(function, arguments) => self.call(function, arguments),
            ExprKind::Array(items) => self.all_alike(items, Reason::Components),
            ExprKind::Method(..) | ExprKind::Tuple(_) => Value::Unknown,
        }
    }

    fn name(&self, name: &str) -> Value {
        if let Some((_, dimension)) = self.locals.iter().find(|(local, _)| *local == name) {
            return Value::quantity(dimension.clone());
        }
        match (name, self.names.get(name)) {
            (_, Some(Meaning::Named(v, anchor))) => {
                Value::Quantity { dimension: Dimension::variable(*v), anchor: *anchor }
            }
            ("x" | "y" | "z", _) => Value::Direction,
            ("pi", _) => Value::Number(std::f64::consts::PI),
            ("t", _) => Value::quantity(TIME),
            (_, Some(Meaning::Moving(dimension, anchor))) => {
                Value::Quantity { dimension: dimension.clone(), anchor: *anchor }
            }
            _ => Value::Unknown,
        }
    }

    /// A coordinate of a joint, or the axis of a frame.
    fn member(&self, inner: &Expr, member: &Name) -> Value {
        let ExprKind::Name(joint) = &inner.kind else { return Value::Unknown };
        match self.names.get(&format!("{joint}.{}", member.text)) {
            Some(Meaning::Moving(dimension, _)) => Value::quantity(dimension.clone()),
            _ => Value::Direction,
        }
    }

    /// Demands that two values are alike; returns what they are.
    fn alike(&mut self, a: Value, b: Value, origin: Origin<'a>) -> Value {
        let (Value::Quantity { dimension, anchor }, Value::Quantity { dimension: other, anchor: second }) =
            (&a, &b)
        else {
            return a.or(b);
        };
        match self.equate(other, dimension, origin) {
            true => Value::Quantity { dimension: dimension.clone(), anchor: *anchor.max(second) },
            false => Value::Unknown,
        }
    }

    /// The common dimension of several expressions.
    fn all_alike(&mut self, items: &'a [Expr], reason: Reason<'a>) -> Value {
        let mut first: Option<&Expr> = None;
        let mut common = Value::Number(0.0);
        for item in items {
            let value = self.value(item);
            let is_quantity = matches!(value, Value::Quantity { .. });
            common = self.alike(common, value, Origin { reason, at: item, like: first });
            first = first.or(is_quantity.then_some(item));
        }
        match common {
            Value::Number(_) => Value::Number(f64::NAN),
            other => other,
        }
    }

    /// A sum of any number of terms. If a term has a parameter or an input, terms of open dimension take the
    /// expected one, so that the error points at the other term.
    pub fn sum(&mut self, e: &'a Expr, expected: Option<&Dimension>) -> Value {
        let mut written = Vec::new();
        let mut at = e;
        while let ExprKind::Binary(op @ (BinaryOp::Add | BinaryOp::Sub), left, right, _) = &at.kind {
            written.push((Some((Reason::Sum(*op), at)), &**right));
            at = left;
        }
        written.push((None, at));
        let terms: Vec<_> =
            written.into_iter().rev().map(|(sum, term)| (sum, term, self.value(term))).collect();
        let is_anchored = terms.iter().any(|(.., value)| value.anchor() > Anchor::Motion);
        for (_, term, value) in &terms {
            if let (Value::Quantity { dimension, .. }, Some(expected), true) = (value, expected, is_anchored)
                && self.system.resolve(dimension).is_some_and(|d| !d.is_known())
            {
                self.equate(dimension, expected, Origin { reason: Reason::Place, at: term, like: None });
            }
        }
        let mut terms = terms.into_iter();
        let first = terms.next().map_or(Value::Unknown, |(.., value)| value);
        let total = terms.fold(first, |total, (sum, term, value)| {
            let (reason, at) = sum.unwrap_or((Reason::Place, term));
            self.alike(total, value, Origin { reason, at, like: None })
        });
        match total {
            Value::Number(_) => Value::Number(f64::NAN),
            other => other,
        }
    }

    /// A product or quotient of any number of factors, those in parentheses among them: `a / (2 * b)` is
    /// `a / 2 / b`.
    fn product(&mut self, e: &'a Expr) -> Value {
        let mut factors = Vec::new();
        let mut rest = vec![(false, e)];
        while let Some((below, at)) = rest.pop() {
            match &at.kind {
                ExprKind::Binary(op @ (BinaryOp::Mul | BinaryOp::Div), left, right, _) => {
                    rest.push((below != (*op == BinaryOp::Div), &**right));
                    rest.push((below, &**left));
                }
                _ => factors.push((below, self.value(at))),
            }
        }
        let value = self.multiply(&factors);
        // `sin(angle) * x` is a metre along `x` where a length is expected, as `x` is.
        let has_direction = factors.iter().any(|(_, factor)| matches!(factor, Value::Direction));
        match &value {
            Value::Quantity { dimension, anchor: Anchor::Motion }
                if has_direction && self.system.resolve(dimension).is_some_and(|d| d.is_plain()) =>
            {
                Value::Direction
            }
            _ => value,
        }
    }

    /// The product of factors; those marked divide.
    fn multiply(&mut self, factors: &[(bool, Value)]) -> Value {
        let (value, free) = product(factors);
        let is_gravity = factors.iter().any(|(_, factor)| match factor {
            Value::Number(g) => self.gravity.contains(&g.abs()),
            _ => false,
        });
        let (Value::Quantity { dimension, anchor }, true) = (&value, free || is_gravity) else {
            return value;
        };
        let number = Dimension::variable(self.system.variable());
        self.wish(number.clone());
        match dimension.times(&number) {
            Some(dimension) => Value::Quantity { dimension, anchor: *anchor },
            None => Value::Unknown,
        }
    }

    /// The value of a function: tables first, then what the language knows, then elementary functions.
    fn call(&mut self, function: &'a Name, arguments: &'a [Expr]) -> Value {
        let text = function.text.as_str();
        if let Some(unknown) = self.tables.get(text).cloned() {
            return self.lookup(&unknown, arguments);
        }
        let known = self
            .arithmetic(text, arguments)
            .or_else(|| self.vector_algebra(text, arguments))
            .or_else(|| self.matrix_algebra(text, arguments))
            .or_else(|| self.calculus(text, arguments))
            .or_else(|| self.motion(text, arguments))
            .or_else(|| self.masses(text, arguments))
            .or_else(|| self.flight(text, arguments));
        match (known, arguments) {
            (Some(value), _) => value,
            (None, [a]) => self.elementary(text, a),
            (None, _) => Value::Unknown,
        }
    }

    /// Functions of numbers.
    fn arithmetic(&mut self, text: &'a str, arguments: &'a [Expr]) -> Option<Value> {
        Some(match (text, arguments) {
            ("abs", [a]) => self.value(a),
            ("signum", [a]) => {
                self.value(a);
                Value::quantity(PLAIN)
            }
            ("sqrt", [a]) => match self.value(a) {
                Value::Number(value) => Value::Number(value.sqrt()),
                other => other.power(Ratio::new(1, 2)),
            },
            ("pow", [a, n]) => self.power(a, n),
            (IF, [_, _, _, _]) => {
                let (compared, pieces) = arguments.split_at(2);
                self.all_alike(compared, Reason::Alike(text));
                self.all_alike(pieces, Reason::Pieces)
            }
            ("min" | "max", _) => self.all_alike(arguments, Reason::Alike(text)),
            ("atan2", _) => match self.all_alike(arguments, Reason::Alike(text)) {
                Value::Quantity { .. } => Value::quantity(PLAIN),
                _ => Value::Number(f64::NAN),
            },
            _ => return None,
        })
    }

    /// Products, sizes and directions of vectors.
    fn vector_algebra(&mut self, text: &str, arguments: &'a [Expr]) -> Option<Value> {
        Some(match (text, arguments) {
            ("dot" | "cross", _) => {
                let factors: Vec<_> = arguments.iter().map(|a| (false, self.value(a))).collect();
                match self.multiply(&factors) {
                    Value::Direction if text == "dot" => Value::quantity(PLAIN),
                    product => product,
                }
            }
            ("norm", [a]) => match self.value(a) {
                Value::Direction => Value::quantity(PLAIN),
                other => other,
            },
            ("project", [a, n]) => {
                self.value(n);
                self.value(a)
            }
            ("unit", [a]) => {
                self.value(a);
                Value::Direction
            }
            ("angle", _) => {
                arguments.iter().for_each(|a| drop(self.value(a)));
                Value::quantity(PLAIN)
            }
            _ => return None,
        })
    }

    /// Matrices and what is made of them.
    fn matrix_algebra(&mut self, text: &str, arguments: &'a [Expr]) -> Option<Value> {
        Some(match (text, arguments) {
            ("skew" | "transpose" | "trace", [a]) => self.value(a),
            ("outer", [a, b]) => {
                let factors = [(false, self.value(a)), (false, self.value(b))];
                self.multiply(&factors)
            }
            ("projector", [a]) => {
                self.value(a);
                Value::quantity(PLAIN)
            }
            ("rotation", _) | ("identity", _) => Value::quantity(PLAIN),
            _ => return None,
        })
    }

    /// Derivatives by time, by length and along curves.
    fn calculus(&mut self, text: &str, arguments: &'a [Expr]) -> Option<Value> {
        Some(match (text, arguments) {
            // Of a vector, as seen from a frame, whose name has no dimension.
            ("rate", [Expr { kind: ExprKind::Binary(BinaryOp::Div, of, frame, _), .. }])
                if self.is_frame(frame) =>
            {
                match self.value(of) {
                    Value::Direction => Value::quantity(RATE),
                    other => quotient(other, &TIME),
                }
            }
            ("rate", [a]) => quotient(self.value(a), &TIME),
            ("curvature" | "torsion", [curve, _]) => self.value(curve).power(Some(Ratio::integer(-1))),
            ("gradient", [Expr { kind: ExprKind::Binary(_, field, ..), .. }]) => match self.value(field) {
                value @ Value::Quantity { .. } => quotient(value, &LENGTH),
                _ => Value::Unknown,
            },
            _ => return None,
        })
    }

    /// Places, velocities and accelerations, and what is measured between places.
    fn motion(&mut self, text: &str, arguments: &'a [Expr]) -> Option<Value> {
        Some(match (text, arguments) {
            ("r" | "v" | "a" | "omega" | "alpha", [a]) => self.slash(text, a),
            (
                "center_of_mass" | "instant_center" | "acceleration_center" | "screw_axis" | "screw_pitch",
                [of],
            ) => self.slash("r", of),
            ("center_of_percussion", [of, axis]) => {
                self.value(axis);
                self.slash("r", of)
            }
            ("cable", [of, surface]) => {
                self.slash("r", of);
                let ExprKind::Method(base, _, arguments) = &surface.kind else {
                    return Some(Value::Unknown);
                };
                self.point(base);
                let radius =
                    arguments.first().map(|radius| self.expect(radius, &LENGTH, "m", Reason::Argument));
                Value::Quantity { dimension: LENGTH, anchor: radius.map_or(Anchor::Motion, |r| r.anchor()) }
            }
            _ => return None,
        })
    }

    /// Momenta, energies, inertias and forces.
    fn masses(&mut self, text: &str, arguments: &'a [Expr]) -> Option<Value> {
        Some(match (text, arguments) {
            ("momentum" | "angular_momentum" | "kinetic_energy", [a]) => {
                self.slash("r", a);
                Value::quantity(match text {
                    "momentum" => MOMENTUM,
                    "angular_momentum" => ANGULAR_MOMENTUM,
                    _ => ENERGY,
                })
            }
            ("power", _) => Value::quantity(POWER),
            ("inertia", [of]) => {
                self.slash("r", of);
                Value::quantity(INERTIA)
            }
            ("moment_of_inertia", [of, directions @ ..]) => {
                self.slash("r", of);
                let directions: Vec<Value> = directions.iter().map(|a| self.value(a)).collect();
                match directions.iter().all(|direction| matches!(direction, Value::Direction)) {
                    true => Value::quantity(INERTIA),
                    // Vectors that have a unit count with it.
                    false => Value::Unknown,
                }
            }
            ("reaction_force" | "contact_force", _) => Value::quantity(FORCE),
            ("reaction_torque" | "contact_moment", _) => Value::quantity(ENERGY),
            _ => return None,
        })
    }

    /// The atmosphere, and angles of flight.
    fn flight(&mut self, text: &str, arguments: &'a [Expr]) -> Option<Value> {
        Some(match (text, arguments) {
            ("density" | "pressure" | "temperature" | "speed_of_sound", [height]) => {
                self.expect(height, &LENGTH, "m", Reason::Argument);
                match text {
                    "density" => Value::quantity(DENSITY),
                    "pressure" => Value::quantity(PRESSURE),
                    "speed_of_sound" => Value::quantity(SPEED),
                    // There are no temperatures among the units.
                    _ => Value::Unknown,
                }
            }
            ("stability_axes" | "wind_axes", [_, velocity, components]) => {
                self.value(velocity);
                self.value(components)
            }
            (
                "angle_of_attack" | "sideslip" | "heading" | "elevation" | "bank" | "course" | "flight_path",
                _,
            ) => {
                arguments.iter().filter(|a| a.name().is_none()).for_each(|a| drop(self.value(a)));
                Value::quantity(PLAIN)
            }
            _ => return None,
        })
    }

    /// True for the name of a body or a frame, which is no quantity.
    fn is_frame(&self, e: &Expr) -> bool {
        let is_value = |name: &str| {
            self.names.contains_key(name)
                || matches!(name, "x" | "y" | "z" | "pi" | "t")
                || self.locals.iter().any(|(local, _)| *local == name)
        };
        e.name().is_some_and(|name| !is_value(name))
    }

    /// The value of a table, whose variables have the units of their axes wherever it is called.
    fn lookup(&mut self, unknown: &[Variable], arguments: &'a [Expr]) -> Value {
        let Some((value, variables)) = unknown.split_last() else { return Value::Unknown };
        for (argument, variable) in arguments.iter().zip(variables) {
            self.expect(argument, &Dimension::variable(*variable), "", Reason::Argument);
        }
        Value::Quantity { dimension: Dimension::variable(*value), anchor: Anchor::Parameter }
    }

    /// A function of a plain number.
    fn elementary(&mut self, text: &str, a: &'a Expr) -> Value {
        let Some((_, f)) = Function::ALL.iter().find(|(name, _)| *name == text) else {
            return Value::Unknown;
        };
        let unit = if matches!(text, "sin" | "cos" | "tan") { "rad" } else { "1" };
        match self.expect(a, &PLAIN, unit, Reason::Argument) {
            Value::Number(value) => Value::Number(f.apply(value)),
            Value::Direction => Value::Unknown,
            _ => Value::quantity(PLAIN),
        }
    }

    /// A power: with an exponent that is no number, nothing is known of it unless its base is plain in the
    /// end.
    fn power(&mut self, a: &'a Expr, n: &'a Expr) -> Value {
        let base = self.value(a);
        let exponent = self.expect(n, &PLAIN, "1", Reason::Argument);
        match (base, exponent) {
            (Value::Number(value), Value::Number(n)) => Value::Number(value.powf(n)),
            (Value::Number(_), _) => Value::quantity(PLAIN),
            (base, Value::Number(n)) => base.power(Ratio::of(n)),
            (Value::Quantity { dimension, anchor }, _) => {
                let power = Dimension::variable(self.system.variable());
                self.wishes.push((dimension, Some(power.clone())));
                Value::Quantity { dimension: power, anchor }
            }
            _ => Value::Unknown,
        }
    }

    /// `r(y / x)` and its kin; the points in it may be placed by vectors.
    fn slash(&mut self, text: &str, e: &'a Expr) -> Value {
        let mut at = e;
        while let ExprKind::Binary(BinaryOp::Div, left, right, _) = &at.kind {
            self.point(right);
            at = left;
        }
        self.point(at);
        Value::quantity(match text {
            "r" => LENGTH,
            "v" => SPEED,
            "a" => ACCELERATION,
            "omega" => RATE,
            _ => RATE_OF_RATE,
        })
    }

    /// A place: `body.at(vector)`.
    pub fn point(&mut self, e: &'a Expr) {
        if let ExprKind::Method(base, _, arguments) = &e.kind {
            self.point(base);
            for argument in arguments {
                self.expect(argument, &LENGTH, "m", Reason::Place);
            }
        }
    }
}

/// A quantity divided by one of this dimension; anything else as it is.
fn quotient(value: Value, by: &Dimension) -> Value {
    match value {
        Value::Quantity { dimension, anchor } => match dimension.over(by) {
            Some(dimension) => Value::Quantity { dimension, anchor },
            None => Value::Unknown,
        },
        other => other,
    }
}
