//! Rolling pairs: two surfaces touch, and their points at the contact have one velocity. The contact is found in closed
//! form: where a convex body touches a plane is its point farthest along the normal (its support function), and a
//! sphere touches along the line through its centre.

use super::build::Builder;
use super::constraint::{Moving, perpendicular};
use super::world::{Level, Placed, View};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Function, Vec3};
use crate::syntax::{self, ExprKind};

/// A surface of a body; `vectors` and lengths in body axes.
enum Form<'g> {
    /// The rim of a disk: radius, axis.
    Circle(Expr<'g>, Vec3<'g>),
    /// A tyre: radius of its centre line, radius of its section, axis.
    Torus(Expr<'g>, Expr<'g>, Vec3<'g>),
    /// Radius.
    Sphere(Expr<'g>),
    /// Semi-axes along the body's axes.
    Ellipsoid([Expr<'g>; 3]),
    /// Normal, towards what rolls on it.
    Plane(Vec3<'g>),
    /// The inside of a sphere: radius.
    Bowl(Expr<'g>),
    /// The outside of a cylinder: radius, axis.
    Cylinder(Expr<'g>, Vec3<'g>),
    /// The inside of a cylinder: radius, axis.
    Tube(Expr<'g>, Vec3<'g>),
}

/// The surfaces with their arguments.
const FORMS: [(&str, &str); 8] = [
    ("circle", "circle(radius, axis)"),
    ("torus", "torus(radius, tube_radius, axis)"),
    ("sphere", "sphere(radius)"),
    ("ellipsoid", "ellipsoid(a, b, c)"),
    ("plane", "plane(normal)"),
    ("bowl", "bowl(radius)"),
    ("cylinder", "cylinder(radius, axis)"),
    ("tube", "tube(radius, axis)"),
];

/// A surface where it is.
struct Surface<'g> {
    home: Placed<'g>,
    form: Form<'g>,
}

/// A contact, in the axes of the link that carries both.
struct Contact<'g> {
    /// Distance of the surfaces.
    gap: Expr<'g>,
    /// The point of the first body.
    point: Vec3<'g>,
    /// Normal and two tangents, with their names.
    axes: [(&'static str, Vec3<'g>); 3],
}

const EXAMPLE: &str = "write `rolls(disk.circle(radius, y), ground.plane(z))`";

impl<'g> Builder<'_, 'g> {
    /// Adds the three rows of a rolling pair.
    pub fn add_rolling(&mut self, constraint: &syntax::Constraint, cx: &mut Diagnostics) {
        let (first, second) = match &constraint.value.kind {
            ExprKind::Call(word, pair) if word.text == "rolls" && pair.len() == 2 => (&pair[0], &pair[1]),
            _ => {
                cx.error(constraint.value.place.clone(), "expected a rolling pair").help(EXAMPLE);
                return;
            }
        };
        let (a, b) = (self.surface(first, cx), self.surface(second, cx));
        let (Some(mut a), Some(mut b)) = (a, b) else { return };
        if a.home.link == b.home.link {
            cx.error(second.place.clone(), "these two surfaces do not move relative to each other")
                .help("let bodies roll that move relative to each other");
            return;
        }
        if !b.form.carries() || (a.form.carries() && !matches!(a.form, Form::Sphere(_))) {
            std::mem::swap(&mut a, &mut b);
        }
        let (on_a, on_b) = (self.relative(a.home.link, b.home.link), self.relative(b.home.link, a.home.link));
        let (center, base) =
            (self.point(&on_a, a.home.pose.translation), self.point(&on_b, b.home.pose.translation));
        let turned_a = |v| self.direction(&on_a, a.home.pose.rotation.to_parent(v)).value;
        let turned_b = |v| self.direction(&on_b, b.home.pose.rotation.to_parent(v)).value;
        let Some(contact) = contact(&a.form, &b.form, center.value - base.value, &turned_a, &turned_b) else {
            cx.error(constraint.value.place.clone(), "this pair is not known to roll").help(
                "a circle, a torus, a sphere or an ellipsoid rolls on a plane; a sphere also on a sphere or a cylinder, or inside of a bowl or a tube",
            );
            return;
        };
        // Both bodies' velocities at the same point.
        let (w_a, w_b) = (self.spin(&on_a), self.spin(&on_b));
        let arm = contact.point;
        let velocity = |m: &Moving<'g>, w: Vec3<'g>, r: Vec3<'g>| m.rate + w.cross(r);
        let slip = velocity(&center, w_a, arm) - velocity(&base, w_b, center.value + arm - base.value);
        let (name, place) = (&constraint.name.text, constraint.name.place.clone());
        for (k, (word, e)) in contact.axes.into_iter().enumerate() {
            let residual = (k == 0).then_some(contact.gap);
            self.push_rate(format!("{name}.{word}"), &place, residual, e.dot(slip));
        }
    }

    /// Angular velocity relative to the link that carries both, in its axes.
    fn spin(&self, on: &super::constraint::Relative<'g>) -> Vec3<'g> {
        self.direction_out(on, on.twist.angular)
    }

    /// `body.form(arguments)`.
    fn surface(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Surface<'g>> {
        let words = || FORMS.iter().map(|(word, _)| *word);
        let ExprKind::Method(base, word, arguments) = &e.kind else {
            cx.error(e.place.clone(), "expected a surface").help(EXAMPLE);
            return None;
        };
        let Some((_, usage)) = FORMS.iter().find(|(known, _)| *known == word.text) else {
            cx.error(word.place.clone(), format!("unknown surface `{}`", word.text))
                .suggest(&word.text, words());
            return None;
        };
        let home = self.scope.place(base, cx);
        let view = || View::new(Level::Constant, None);
        let mut length = |k: usize| self.scope.with_view(view(), |s| s.scalar(arguments.get(k)?, cx));
        let (first, second, third) = match word.text.as_str() {
            "plane" => (None, None, None),
            "torus" => (length(0), length(1), None),
            "ellipsoid" => (length(0), length(1), length(2)),
            _ => (length(0), None, None),
        };
        let expected = usage.matches(',').count() + 1;
        if arguments.len() != expected {
            cx.error(word.place.clone(), format!("this surface is written `{usage}`"));
            return None;
        }
        for (k, value) in [first, second, third].into_iter().enumerate() {
            if let Some(n) = value.and_then(|v| v.value()).filter(|n| *n <= 0.0) {
                cx.error(arguments[k].place.clone(), format!("this length must be positive, but it is {n}"));
            }
        }
        let axis = match word.text.as_str() {
            "circle" | "torus" | "plane" | "cylinder" | "tube" => {
                let last = arguments.last()?;
                Some(self.scope.with_view(view(), |s| s.unit_vector(last, false, cx))?)
            }
            _ => None,
        };
        let form = match (word.text.as_str(), first, axis) {
            ("circle", Some(r), Some(n)) => Form::Circle(r, n),
            ("torus", Some(r), Some(n)) => Form::Torus(r, second?, n),
            ("sphere", Some(r), _) => Form::Sphere(r),
            ("ellipsoid", Some(a), _) => Form::Ellipsoid([a, second?, third?]),
            ("plane", _, Some(n)) => Form::Plane(n),
            ("bowl", Some(r), _) => Form::Bowl(r),
            ("cylinder", Some(r), Some(n)) => Form::Cylinder(r, n),
            ("tube", Some(r), Some(n)) => Form::Tube(r, n),
            _ => return None,
        };
        Some(Surface { home: home?, form })
    }
}

impl Form<'_> {
    /// True for a surface that others roll on.
    fn carries(&self) -> bool {
        !matches!(self, Form::Circle(..) | Form::Torus(..) | Form::Ellipsoid(_))
    }
}

/// The contact of a body with its centre at `c` from the origin of the other one; `None` for pairs without a closed form.
fn contact<'g>(
    a: &Form<'g>,
    b: &Form<'g>,
    c: Vec3<'g>,
    turned_a: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
    turned_b: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
) -> Option<Contact<'g>> {
    if let Form::Plane(n) = b {
        let [(first, e1), (second, e2)] = perpendicular(*n).map(|(word, e)| (word, turned_b(e)));
        let normal = turned_b(*n);
        let point = -farthest(a, normal, turned_a)?;
        let gap = normal.dot(c + point);
        return Some(Contact { gap, point, axes: [("normal", normal), (first, e1), (second, e2)] });
    }
    let Form::Sphere(radius) = a else { return None };
    let (outward, reach, inside, tangents) = match b {
        Form::Sphere(r) => (c, *r + *radius, false, None),
        Form::Bowl(r) => (c, *r - *radius, true, None),
        Form::Cylinder(r, u) | Form::Tube(r, u) => {
            let axis = turned_b(*u);
            let inside = matches!(b, Form::Tube(..));
            let reach = if inside { *r - *radius } else { *r + *radius };
            (c - axis * axis.dot(c), reach, inside, Some(axis))
        }
        _ => return None,
    };
    let distance = outward.norm();
    let direction = outward.map(|x| x / distance);
    let (normal, gap) = match inside {
        false => (direction, distance - reach),
        true => (-direction, reach - distance),
    };
    let axes = match tangents {
        Some(axis) => [("normal", normal), ("along", axis), ("around", normal.cross(axis))],
        None => {
            let (first, second) = tangents_of(normal);
            [("normal", normal), ("first", first), ("second", second)]
        }
    };
    Some(Contact { gap, point: -(normal * *radius), axes })
}

/// The point of a convex body that is farthest along `n`, from its centre.
fn farthest<'g>(form: &Form<'g>, n: Vec3<'g>, turned: &dyn Fn(Vec3<'g>) -> Vec3<'g>) -> Option<Vec3<'g>> {
    let across = |axis: Vec3<'g>| {
        let a = turned(axis);
        let cosine = a.dot(n);
        let sine = (cosine.num(1.0) - cosine.square()).sqrt();
        (n - a * cosine).map(|x| x / sine)
    };
    Some(match form {
        Form::Circle(r, axis) => across(*axis) * *r,
        Form::Torus(r, tube, axis) => across(*axis) * *r + n * *tube,
        Form::Sphere(r) => n * *r,
        Form::Ellipsoid(half) => {
            let g = n[0].graph();
            let axes: [Vec3<'g>; 3] = std::array::from_fn(|k| turned(Vec3::axis(g, k)));
            let parts: [Expr<'g>; 3] = std::array::from_fn(|k| half[k] * axes[k].dot(n));
            let size = Vec3(parts).norm();
            (0..3).fold(Vec3::zero(g), |sum, k| sum + axes[k] * (half[k] * parts[k] / size))
        }
        _ => return None,
    })
}

/// Two tangents for a normal of any direction (Duff et al., *Building an orthonormal basis, revisited*, 2017).
fn tangents_of(n: Vec3<'_>) -> (Vec3<'_>, Vec3<'_>) {
    let [x, y, z] = n.0;
    let sign = z.call(Function::Signum);
    let a = -((sign + z).num(1.0) / (sign + z));
    let b = x * y * a;
    let one = z.num(1.0);
    (Vec3([one + sign * x * x * a, sign * b, -(sign * x)]), Vec3([b, sign + y * y * a, -y]))
}
