//! Surfaces of bodies, as contacts name them: `body.form(arguments)`.

use super::terrain::Terrain;
use crate::diag::{Diagnostics, all_of};
use crate::expr::{Expr, Vec3};
use crate::mechanism::Rule;
use crate::resolve::builder::Builder;
use crate::resolve::scope::{Allowed, Context, Placed};
use crate::syntax::{self, ExprKind, GROUND};
use std::f64::consts::FRAC_PI_2;

/// A surface of a body; vectors and lengths in body axes.
#[derive(Clone)]
pub enum Form<'g> {
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
    /// A cylinder with two ends: radius, length, axis.
    Drum(Expr<'g>, Expr<'g>, Vec3<'g>),
    /// The inside of a cylinder: radius, axis.
    Tube(Expr<'g>, Vec3<'g>),
    /// The outside of a cone: half angle, axis from the apex into the cone.
    Cone(Expr<'g>, Vec3<'g>),
    /// The inside of a cone: half angle, axis from the apex to the releasing.
    Funnel(Expr<'g>, Vec3<'g>),
    /// A surface given by its points.
    Sheet(Sheet<'g>),
    /// A height over x and y.
    Terrain(Box<Terrain<'g>>),
    /// A point, which can only be in contact.
    Point,
    /// A box: its lengths along the body's axes.
    Cuboid([Expr<'g>; 3]),
    /// A cylinder between two halves of a sphere: radius, distance of their centres, axis.
    Capsule(Expr<'g>, Expr<'g>, Vec3<'g>),
}

/// Points of a surface as expressions of two coordinates, in body axes from its place.
#[derive(Clone)]
pub struct Sheet<'g> {
    /// The point.
    pub at: Vec3<'g>,
    /// Its derivatives; their cross product points to what rolls.
    pub tangents: [Vec3<'g>; 2],
}

/// A surface where it is.
#[derive(Clone)]
pub struct Surface<'g> {
    /// Its centre, apex or a point of it.
    pub frame: Placed<'g>,
    /// Its form.
    pub form: Form<'g>,
}

/// The surfaces with their arguments.
const FORMS: [(&str, &[&str]); 15] = [
    ("circle", &["radius", "axis"]),
    ("torus", &["radius", "tube_radius", "axis"]),
    ("sphere", &["radius"]),
    ("ellipsoid", &["a", "b", "c"]),
    ("plane", &["normal"]),
    ("bowl", &["radius"]),
    ("cylinder", &["radius", "axis"]),
    ("cylinder", &["radius", "length", "axis"]),
    ("tube", &["radius", "axis"]),
    ("cone", &["half_angle", "axis"]),
    ("funnel", &["half_angle", "axis"]),
    ("surface", &["u", "w", "point"]),
    ("terrain", &["height"]),
    ("cuboid", &["a", "b", "c"]),
    ("capsule", &["radius", "length", "axis"]),
];

/// Names of the arguments of a form, one with as many of them if there is one.
pub fn arguments_of(word: &str, count: usize) -> Option<&'static [&'static str]> {
    let named = || FORMS.iter().filter(|(known, _)| *known == word).map(|(_, names)| *names);
    named().find(|names| names.len() == count).or_else(|| named().next())
}

impl<'g> Builder<'_, 'g> {
    /// `body.form(arguments)`; `example` is how a pair is written.
    pub fn surface(&self, e: &syntax::Expr, example: &str, cx: &mut Diagnostics) -> Option<Surface<'g>> {
        let ExprKind::Method(base, word, arguments) = &e.kind else {
            let error = cx.error(e.place.clone(), "expected a surface");
            match e.name() {
                Some(GROUND) => error.help("write `ground.plane(z)`"),
                Some(name) => {
                    error.help(format!("write `{name}.circle(radius, y)`, `{name}.sphere(radius)`, …"))
                }
                None => error.help(example),
            };
            return None;
        };
        let Some(names) = arguments_of(&word.text, arguments.len()) else {
            let error = cx.error(word.place.clone(), format!("unknown surface `{}`", word.text));
            error.suggest(&word.text, FORMS.iter().map(|(word, _)| *word));
            if error.is_bare() {
                let mut list: Vec<String> = FORMS.iter().map(|(word, _)| format!("`{word}`")).collect();
                list.dedup();
                error.help(format!("the surfaces are {}", all_of(&list)));
            }
            return None;
        };
        let frame = self.scope.place(base, cx);
        if arguments.len() != names.len() {
            let usage = format!("this surface is written `{}({})`", word.text, names.join(", "));
            cx.error(word.place.clone(), usage)
                .help("lengths are in m, angles in rad, axes in those of the body");
            return None;
        }
        if let ("surface", [u, w, point]) = (word.text.as_str(), arguments.as_slice()) {
            let frame = frame?;
            let form = Form::Sheet(self.sheet(&frame, [u, w, point], cx)?);
            return Some(Surface { frame, form });
        }
        if let ("terrain", [height]) = (word.text.as_str(), arguments.as_slice()) {
            let terrain = self.terrain(height, cx);
            return Some(Surface { frame: frame?, form: Form::Terrain(Box::new(terrain?)) });
        }
        let (mut numbers, mut axis) = (Vec::new(), None);
        for (argument, name) in arguments.iter().zip(names) {
            let context = Context::new(Allowed::Constant, None);
            match *name {
                "axis" | "normal" => {
                    axis = self.scope.in_context(context, |s| s.unit_vector(argument, false, cx));
                }
                _ => {
                    let value = self.scope.in_context(context, |s| s.scalar(argument, cx))?;
                    if !check_size(name, argument, value, cx) {
                        return None;
                    }
                    let rule = if *name == "half_angle" { Rule::HalfAngle } else { Rule::Positive };
                    let figure = || format!("the {} of a {}", name.replace('_', " "), word.text);
                    self.scope.require(rule, figure, &[value]);
                    numbers.push(value);
                }
            }
        }
        let form = match (word.text.as_str(), numbers.as_slice(), axis) {
            ("circle", [r], Some(n)) => Form::Circle(*r, n),
            ("torus", [r, tube], Some(n)) => Form::Torus(*r, *tube, n),
            ("sphere", [r], _) => Form::Sphere(*r),
            ("ellipsoid", [a, b, c], _) => Form::Ellipsoid([*a, *b, *c]),
            ("plane", _, Some(n)) => Form::Plane(n),
            ("bowl", [r], _) => Form::Bowl(*r),
            ("cylinder", [r], Some(n)) => Form::Cylinder(*r, n),
            ("cylinder", [r, length], Some(n)) => Form::Drum(*r, *length, n),
            ("tube", [r], Some(n)) => Form::Tube(*r, n),
            ("cone", [angle], Some(n)) => Form::Cone(*angle, n),
            ("funnel", [angle], Some(n)) => Form::Funnel(*angle, n),
            ("cuboid", [a, b, c], _) => Form::Cuboid([*a, *b, *c]),
            ("capsule", [r, length], Some(n)) => Form::Capsule(*r, *length, n),
            _ => return None,
        };
        Some(Surface { frame: frame?, form })
    }
}

/// Reports a length that is not positive, and a half angle that is not between zero and a right one.
fn check_size(name: &str, e: &syntax::Expr, value: Expr<'_>, cx: &mut Diagnostics) -> bool {
    let Some(n) = value.value() else { return true };
    if name == "half_angle" {
        if n <= 0.0 || n >= FRAC_PI_2 {
            cx.error(e.place.clone(), format!("this half angle is not between 0 and π/2: it is {n}"))
                .help("it is the angle between the axis and the surface, rad");
            return false;
        }
    } else if n <= 0.0 {
        cx.error(e.place.clone(), format!("this length must be positive, but it is {n}"))
            .help("the axis and the side of a surface are said by its form");
        return false;
    }
    true
}
