//! Curves and fields: what follows from derivatives of an expression by a coordinate or a place.

use super::quantities::{flatten, in_links, vector};
use super::scope::{Allowed, Context, Placed, Scope, Value};
use crate::diag::Diagnostics;
use crate::expr::diff::Derivative;
use crate::expr::replace::replace;
use crate::expr::sample::always;
use crate::expr::{Expr, Mat3, Rotation, Vec3};
use crate::kinematics::symbols_in;
use crate::mechanism::{Coordinate, LinkId, Pose, Quantity};
use crate::syntax::{self, ExprKind, Name};

/// Frames that follow from a vector or a curve, as the first rotation of a `Frame`.
pub const FRAMES: [&str; 3] = ["cylindrical", "spherical", "frenet"];

/// The first number that a point is moved by, beyond those of laws such as `stretch`.
const MOVES: usize = 1 << 19;

impl<'g> Scope<'_, 'g> {
    /// The axes that a vector or a curve gives, in those of a place: `cylindrical(vector)`,
    /// `spherical(vector)`, `frenet(curve, coordinate)`.
    pub fn natural_axes(
        &self,
        step: &syntax::Expr,
        start: &Placed<'g>,
        cx: &mut Diagnostics,
    ) -> Option<Rotation<'g>> {
        let ExprKind::Call(word, arguments) = &step.kind else { return None };
        let context = Context::new(Allowed::Placement, Some((start.link, start.pose.clone())));
        self.in_context(context, |scope| match (word.text.as_str(), arguments.as_slice()) {
            ("frenet", [curve, along]) => scope.frenet(curve, along, start, cx),
            ("cylindrical" | "spherical", [of]) => {
                let terms = scope.terms(of, cx)?;
                let v = scope.kinematics.borrow().resolve(&terms, start.link, Vec3::zero(scope.graph));
                let [x, y, z] = start.pose.rotation.to_child(v).0;
                if always(x.square() + y.square(), 0.0) {
                    cx.error(
                        of.place.clone(),
                        format!("this vector lies on the z axis, where `{}` has no directions", word.text),
                    )
                    .help("the axes follow from a vector that leaves the z axis of the frame it starts from");
                    return None;
                }
                let about = Rotation::about_axis(2, y.atan2(x));
                Some(match word.text.as_str() {
                    "spherical" => {
                        let elevation = z.atan2((x.square() + y.square()).sqrt());
                        about.then(&Rotation::about_axis(1, -elevation))
                    }
                    _ => about,
                })
            }
            ("frenet", _) => {
                cx.error(word.place.clone(), "`frenet` takes a curve and the coordinate along it")
                    .help("write `frenet(curve, s)`, a vector that depends on a coordinate `s`");
                None
            }
            _ => {
                cx.error(word.place.clone(), format!("`{}` takes a vector", word.text))
                    .help(format!("write `{}(r(point / ground))`", word.text));
                None
            }
        })
    }

    /// Tangent, normal and binormal of a curve (Frenet and Serret) in the axes of a place.
    fn frenet(
        &self,
        curve: &syntax::Expr,
        along: &syntax::Expr,
        start: &Placed<'g>,
        cx: &mut Diagnostics,
    ) -> Option<Rotation<'g>> {
        let ([first, second, _], link) = self.derivatives_along("frenet", curve, along, cx)?;
        let binormal = first.cross(second);
        if binormal.0.iter().all(|c| always(*c, 0.0)) {
            cx.error(curve.place.clone(), "this curve is straight, and has no normal")
                .help("its tangent is `unit(…)` of its direction; curvature and torsion are zero");
            return None;
        }
        let unit = |v: Vec3<'g>| {
            let length = v.norm();
            v.map(|c| c / length)
        };
        let (t, b) = (unit(first), unit(binormal));
        let axes = [t, b.cross(t), b].map(|axis| {
            let here =
                self.kinematics.borrow().resolve(&vec![(link, axis)], start.link, Vec3::zero(self.graph));
            start.pose.rotation.to_child(here)
        });
        Some(Rotation::from_matrix(Mat3::from_fn(|i, j| axes[j][i])))
    }

    /// `curvature(curve, s)` is `|r′ × r″| / |r′|³`, `torsion(curve, s)` is `(r′ × r″)·r‴ / |r′ × r″|²`, of a
    /// curve `r` that depends on a coordinate.
    pub fn bend(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let text = function.text.as_str();
        let [curve, along] = arguments else {
            cx.error(function.place.clone(), format!("`{text}` takes a curve and the coordinate along it"))
                .help(format!("write `{text}(curve, s)`, a vector that depends on a coordinate `s`"));
            return None;
        };
        if !self.check_allowed(Allowed::Placement, &format!("`{text}(…)`"), &function.place, cx) {
            return None;
        }
        let ([first, second, third], _) = self.derivatives_along(text, curve, along, cx)?;
        let normal = first.cross(second);
        let straight = normal.0.iter().all(|c| always(*c, 0.0));
        Some(Value::Scalar(match (text, straight) {
            ("curvature", true) => self.graph.zero(),
            ("curvature", false) => {
                let speed = first.norm();
                normal.length() / (speed * speed * speed)
            }
            (_, true) => {
                cx.error(curve.place.clone(), "this curve is straight, and has no torsion")
                    .help("its curvature is zero: it has no normal that could turn");
                return None;
            }
            _ => normal.dot(third) / normal.dot(normal),
        }))
    }

    /// Three derivatives of a vector by a coordinate, in the axes of a link that do not depend on it.
    fn derivatives_along(
        &self,
        text: &str,
        curve: &syntax::Expr,
        along: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<([Vec3<'g>; 3], Option<LinkId>)> {
        let c = self.named_coordinate(text, along, cx)?;
        let symbol = Quantity::Configuration(c.q.0).symbol();
        let terms = in_links(self.vector(curve, cx)?);
        let kinematics = self.kinematics.borrow();
        let zero = Vec3::zero(self.graph);
        let turns = |link: Option<LinkId>| {
            let axes =
                (0..3).map(|k| kinematics.resolve(&vec![(link, Vec3::axis(self.graph, k))], None, zero));
            axes.into_iter().any(|axis| symbols_in(&axis.0).contains(&symbol))
        };
        let link = terms.first().and_then(|(link, _)| *link);
        let link = if turns(link) { None } else { link };
        let at = kinematics.resolve(&terms, link, zero);
        let mut derivative = Derivative::with_respect_to(symbol, self.graph);
        let scale = self.graph.num(1.0 / c.ratio);
        let mut next = |v: Vec3<'g>| v.map(|c| derivative.of(c) * scale);
        let first = next(at);
        if first.is_zero() {
            cx.error(curve.place.clone(), format!("this vector does not depend on `{}`", along.spelt()))
                .help(format!("write `{text}(curve, s)`, a vector that depends on a coordinate `s`"));
            return None;
        }
        let second = next(first);
        Some(([first, second, next(second)], link))
    }

    /// A plain coordinate by its name.
    fn named_coordinate(&self, text: &str, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Coordinate> {
        let name = e.spelt();
        let kinematics = self.kinematics.borrow();
        if let Some((_, c, _)) = kinematics.coordinates.iter().find(|(known, ..)| *known == name) {
            return Some(*c);
        }
        let known: Vec<&str> = kinematics.coordinates.iter().map(|(known, ..)| known.as_str()).collect();
        let error = cx.error(
            e.place.clone(),
            format!("`{text}` takes a coordinate, along which the curve is run through"),
        );
        error.suggest(&name, known);
        if error.is_bare() {
            error.help("a coordinate is a joint with one degree of freedom, `joint.x` of one with several, or a `Coordinate`");
        }
        None
    }

    /// `gradient(field / point)`: how a scalar changes with the place of a point, all else held.
    pub fn gradient(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let parts = if let [one] = arguments { flatten(one) } else { Vec::new() };
        let (Some((at, field)), [whole]) = (parts.split_last(), arguments) else {
            return self.no_gradient(function, cx);
        };
        let ExprKind::Binary(_, of, ..) = &whole.kind else { return self.no_gradient(function, cx) };
        if field.is_empty() {
            return self.no_gradient(function, cx);
        }
        if !self.check_allowed(Allowed::Placement, "`gradient(…)`", &function.place, cx) {
            return None;
        }
        let placed = self.place(at, cx)?;
        let Some(name) = at.name().filter(|name| *name != syntax::GROUND) else {
            cx.error(at.place.clone(), "expected the name of a point")
                .help("name a `Point`, a particle or a body");
            return None;
        };
        // The point is moved by three numbers, and the field differentiated by them.
        let moves = [0, 1, 2].map(|k| Quantity::Given(MOVES + k).symbol());
        let by = Vec3(moves.map(|s| self.graph.symbol(s)));
        let pose = Pose { translation: placed.pose.translation + by, ..placed.pose.clone() };
        let moved = Placed { pose, ..placed.clone() };
        self.known.borrow_mut().clear();
        self.kinematics.borrow_mut().places.insert(name.to_string(), moved);
        let value = self.scalar(of, cx);
        self.kinematics.borrow_mut().places.insert(name.to_string(), placed.clone());
        self.known.borrow_mut().clear();
        let value = value?;
        let back = |e: Expr<'g>| replace(e, &|s| moves.contains(&s).then(|| self.graph.zero()));
        let gradient = Vec3(moves.map(|s| back(Derivative::with_respect_to(s, self.graph).of(value))));
        if gradient.is_zero() {
            cx.error(of.place.clone(), format!("this does not depend on the place of `{name}`"))
                .help(format!("a field is an expression of `r({name} / ground)`"));
            return None;
        }
        Some(vector(vec![(placed.link, gradient)]))
    }

    fn no_gradient(&self, function: &Name, cx: &mut Diagnostics) -> Option<Value<'g>> {
        cx.error(function.place.clone(), "`gradient` takes a scalar and a point")
            .help("write `gradient(field / point)`, an expression of `r(point / ground)`");
        None
    }
}
