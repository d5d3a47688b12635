//! Pairs of surfaces in contact. Surfaces of a rolling pair have equal velocities at the contact; those of a
//! slipping pair do not. The contact point has a closed form. A convex body touches a plane at its farthest
//! point along the normal (its support function). A sphere touches along the normal through its centre. Cones
//! touch along a line. On a surface given by its points, two coordinates determine the contact point.

mod boxes;
mod collision;
mod cones;
mod contact_point;
mod cylinders;
mod drawing;
mod force;
mod geometry;
mod hull;
mod slipping;
mod soft;
mod stops;
mod surface;
pub use force::has_consistent_forces;
mod terrain;
mod unilateral;

pub use slipping::check_pressed;
pub use terrain::TERRAIN_COORDINATES;

use super::builder::Builder;
use super::rows::ConstraintRows;
use super::scope::Terms;
use crate::diag::Diagnostics;
use crate::expr::{Expr, Function, Vec3};
use crate::kinematics::jet::{Moving, Relative};
use crate::kinematics::{perpendicular_directions, time_derivative};
use crate::language::Callable;
use crate::mechanism::{Constraint, FrictionTerm, Measure};
use crate::syntax::{self, ExprKind};
use surface::{Surface, SurfaceForm};

/// A contact at a point, in the axes of the link that carries both bodies.
struct PointContact<'g> {
    /// Signed distance of the two surfaces, m.
    gap: Expr<'g>,
    /// Contact point, relative to the centre of the first surface.
    point: Vec3<'g>,
    /// Normal and two tangents of the contact, with their names.
    axes: [(&'static str, Vec3<'g>); 3],
    /// Distances that vanish when the coordinates of a surface given by its points are those of the contact,
    /// with their names.
    conditions: Vec<(&'static str, Expr<'g>)>,
}

/// Two surfaces with the motions of their bodies relative to the link that carries both, in the axes of that
/// link.
struct SurfacePair<'g> {
    a: Surface<'g>,
    b: Surface<'g>,
    on_a: Relative<'g>,
    on_b: Relative<'g>,
    /// Position of the reference point of the first surface.
    center: Moving<'g>,
    /// Position of the reference point of the second surface.
    base: Moving<'g>,
}

const SUPPORTED_PAIRS: &str = "supported are a circle, a torus, a sphere, an ellipsoid or a cone on a plane; \
                               all but the cone on a surface given by its points; a sphere also on a sphere, \
                               a cylinder or a cone, or inside of a bowl, a tube or a funnel; a cone also on \
                               a cone or inside of a funnel";

impl<'g> Builder<'_, 'g> {
    /// Returns the constraint rows of a rolling pair; `None` after an error.
    pub fn rolling_rows(
        &self,
        constraint: &syntax::Constraint,
        cx: &mut Diagnostics,
    ) -> Option<ConstraintRows<'g>> {
        let pair = self.pair(constraint, cx)?;
        if let SurfaceForm::Cone(..) = pair.a.form {
            return self.rolling_cone_rows(constraint, &pair, cx);
        }
        let contact = self.contact(&pair)?;
        let slip = self.slip(&pair, contact.point);
        let mut rows = self.contact_rows(constraint, &contact, slip, Vec::new());
        let [_, tangents @ ..] = contact.axes;
        for (word, e) in tangents {
            let name = format!("{}.{word}", constraint.name.text);
            rows.push(self.constraint_row(
                (name, &constraint.name.place),
                Measure::Length,
                None,
                e.dot(slip),
            ));
        }
        let contact_point = Some(self.contact_position(&pair, contact.point));
        Some(ConstraintRows { rows, contact_point, ..ConstraintRows::default() })
    }

    /// Returns the rows that keep a pair in contact: the distance, with the friction caused by its normal
    /// force, and the conditions for the contact coordinates of a surface given by its points.
    fn contact_rows(
        &self,
        constraint: &syntax::Constraint,
        contact: &PointContact<'g>,
        slip: Vec3<'g>,
        friction: Vec<FrictionTerm<'g>>,
    ) -> Vec<Constraint<'g>> {
        let ((word, normal), place) = (contact.axes[0], &constraint.name.place);
        // The normal of a surface given by its points depends on the contact coordinates. Away from the
        // contact, their velocities change the distance as well.
        let rate = match contact.conditions.is_empty() {
            true => normal.dot(slip),
            false => time_derivative(self.model.configuration_space(), contact.gap),
        };
        let name = |word| (format!("{}.{word}", constraint.name.text), place);
        let distance = self.constraint_row(name(word), Measure::Length, Some(contact.gap), rate);
        let conditions = contact.conditions.iter().map(|(word, distance)| {
            let rate = time_derivative(self.model.configuration_space(), *distance);
            let row = self.constraint_row(name(word), Measure::Length, Some(*distance), rate);
            Constraint { determines: true, ..row }
        });
        [Constraint { friction, ..distance }].into_iter().chain(conditions).collect()
    }

    /// Returns the position of a point given relative to the centre of the first surface.
    fn contact_position(&self, pair: &SurfacePair<'g>, point: Vec3<'g>) -> Terms<'g> {
        let frame = &pair.a.frame;
        let mut place = self.scope.kinematics.position_of_point(frame.link, frame.pose.translation);
        place.push((pair.on_a.ancestor, point));
        place
    }

    /// Parses the pair of surfaces of a constraint only to report its errors.
    pub fn check_pair(&self, constraint: &syntax::Constraint, cx: &mut Diagnostics) {
        let _ = self.pair(constraint, cx);
    }

    /// Parses `rolls(surface, surface)` or `slips(surface, surface)`. The first surface of the result is the
    /// one that rolls.
    fn pair(&self, constraint: &syntax::Constraint, cx: &mut Diagnostics) -> Option<SurfacePair<'g>> {
        let e = &constraint.value;
        let kind = constraint.kind.surface_pair_function();
        let known = kind.map_or("", Callable::contact_verb);
        let example = format!("write `{known}(disk.circle(radius, y), ground.plane(z))`");
        let (first, second) = match &e.kind {
            ExprKind::Call(word, pair) if word.id == kind && pair.len() == 2 => (&pair[0], &pair[1]),
            _ => {
                cx.report_error(e.place.clone(), format!("expected a pair that {known}")).add_help(example);
                return None;
            }
        };
        let a = self.surface(first, &example, cx);
        // Two bodies written instead of two surfaces are one error.
        if a.is_none() && !matches!(second.kind, ExprKind::Method(..)) {
            return None;
        }
        let b = self.surface(second, &example, cx);
        let pair = self.ordered_pair(a?, b?, SurfaceForm::rolls_on, second, cx)?;
        if !pair.a.form.rolls_on(&pair.b.form) {
            cx.report_error(e.place.clone(), "the contact point of these surfaces is not supported")
                .add_help(SUPPORTED_PAIRS);
            return None;
        }
        Some(pair)
    }

    /// Returns two surfaces with their motions, in the order that `is_known` accepts.
    fn ordered_pair(
        &self,
        mut a: Surface<'g>,
        mut b: Surface<'g>,
        is_known: fn(&SurfaceForm<'g>, &SurfaceForm<'g>) -> bool,
        second: &syntax::Expr,
        cx: &mut Diagnostics,
    ) -> Option<SurfacePair<'g>> {
        if a.frame.link == b.frame.link {
            cx.report_error(second.place.clone(), "these two surfaces do not move relative to each other")
                .add_help("a contact is between surfaces of bodies that move relative to each other");
            return None;
        }
        if !is_known(&a.form, &b.form) {
            std::mem::swap(&mut a, &mut b);
        }
        let (on_a, on_b) = (
            self.relative_motion(a.frame.link, b.frame.link),
            self.relative_motion(b.frame.link, a.frame.link),
        );
        let center = self.motion_of_point(&on_a, a.frame.pose.translation);
        let base = self.motion_of_point(&on_b, b.frame.pose.translation);
        Some(SurfacePair { a, b, on_a, on_b, center, base })
    }

    /// Returns a direction of the first body, with its rate, in the common axes.
    fn first_direction(&self, pair: &SurfacePair<'g>, v: Vec3<'g>) -> Moving<'g> {
        self.motion_of_direction(&pair.on_a, pair.a.frame.pose.rotation.to_parent(v))
    }

    /// Returns a direction of the second body, with its rate, in the common axes.
    fn second_direction(&self, pair: &SurfacePair<'g>, v: Vec3<'g>) -> Moving<'g> {
        self.motion_of_direction(&pair.on_b, pair.b.frame.pose.rotation.to_parent(v))
    }

    /// Returns the velocity of the first body relative to the second at a point given relative to the centre
    /// of the first surface.
    fn slip(&self, pair: &SurfacePair<'g>, point: Vec3<'g>) -> Vec3<'g> {
        let SurfacePair { center, base, .. } = pair;
        let [w_a, w_b] = self.angular_velocities(pair);
        let arm = center.value + point - base.value;
        center.rate + w_a.cross(point) - (base.rate + w_b.cross(arm))
    }

    /// Returns the angular velocities of both bodies relative to their common link.
    fn angular_velocities(&self, pair: &SurfacePair<'g>) -> [Vec3<'g>; 2] {
        [&pair.on_a, &pair.on_b].map(|on| self.direction_out(on, on.twist.angular))
    }

    /// Returns the contact of a pair; `None` for pairs that touch along a line.
    fn contact(&self, pair: &SurfacePair<'g>) -> Option<PointContact<'g>> {
        let rotate_a = |v| self.first_direction(pair, v).value;
        let rotate_b = |v| self.second_direction(pair, v).value;
        let c = pair.center.value - pair.base.value;
        match (&pair.a.form, &pair.b.form) {
            (_, SurfaceForm::Sheet(sheet)) => self.contact_point(pair, sheet),
            (a, SurfaceForm::Plane(n)) => {
                let [(first, e1), (second, e2)] =
                    perpendicular_directions(*n).map(|(word, e)| (word, rotate_b(e)));
                let normal = rotate_b(*n);
                let point = -support_point(a, normal, 0.0, &rotate_a)?;
                let gap = normal.dot(c + point);
                Some(PointContact {
                    gap,
                    point,
                    axes: [("normal", normal), (first, e1), (second, e2)],
                    conditions: Vec::new(),
                })
            }
            (SurfaceForm::Sphere(radius), b) => sphere_contact(*radius, b, c, &rotate_b),
            _ => None,
        }
    }
}

impl<'g> SurfaceForm<'g> {
    /// Whether the surface can roll on the other surface.
    fn rolls_on(&self, b: &SurfaceForm<'g>) -> bool {
        let rollers = b.id().map_or(&[][..], |id| id.row().rollers);
        self.id().is_some_and(|id| rollers.contains(&id))
    }
}

/// Returns the contact of a sphere whose centre is at `c` relative to the centre or apex of the other
/// surface.
fn sphere_contact<'g>(
    radius: Expr<'g>,
    b: &SurfaceForm<'g>,
    c: Vec3<'g>,
    rotate_b: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
) -> Option<PointContact<'g>> {
    let inside = matches!(b, SurfaceForm::Bowl(_) | SurfaceForm::Tube(..) | SurfaceForm::Funnel(..));
    let side = |x: Expr<'g>| if inside { -x } else { x };
    let (normal, distance, tangents) = match b {
        SurfaceForm::Sphere(r) | SurfaceForm::Bowl(r) => {
            let size = c.norm();
            let normal = c.map(|x| side(x / size));
            let (first, second) = tangents_of(normal);
            (normal, side(size - *r), [("first", first), ("second", second)])
        }
        SurfaceForm::Cylinder(r, u) | SurfaceForm::Tube(r, u) => {
            let axis = rotate_b(*u);
            let outward = c - axis * axis.dot(c);
            let size = outward.norm();
            let normal = outward.map(|x| side(x / size));
            (normal, side(size - *r), [("along", axis), ("around", normal.cross(axis))])
        }
        SurfaceForm::Cone(half, u) | SurfaceForm::Funnel(half, u) => {
            let (sine, cosine) = (half.sin(), half.cos());
            let axis = rotate_b(*u);
            let height = axis.dot(c);
            let outward = c - axis * height;
            let size = outward.norm();
            let radial = outward.map(|x| x / size);
            let normal = (radial * cosine - axis * sine).map(side);
            let along = radial * sine + axis * cosine;
            let distance = side(size * cosine - height * sine);
            (normal, distance, [("along", along), ("around", normal.cross(along))])
        }
        _ => return None,
    };
    let [first, second] = tangents;
    let axes = [("normal", normal), first, second];
    Some(PointContact { gap: distance - radius, point: -(normal * radius), axes, conditions: Vec::new() })
}

/// Returns the farthest point of a convex body along `n`, relative to its centre.
///
/// If `n` is the axis of a rim, all its points are equally far. With a positive `min_sine_squared`, a lower
/// bound on the squared sine of the angle between axis and `n`, the centre of the rim is returned then.
fn support_point<'g>(
    form: &SurfaceForm<'g>,
    n: Vec3<'g>,
    min_sine_squared: f64,
    rotate: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
) -> Option<Vec3<'g>> {
    let across = |axis: Vec3<'g>| {
        let a = rotate(axis);
        let cosine = a.dot(n);
        let sine = (cosine.num(1.0 + min_sine_squared) - cosine.square()).sqrt();
        (n - a * cosine).map(|x| x / sine)
    };
    Some(match form {
        SurfaceForm::Circle(r, axis) => across(*axis) * *r,
        SurfaceForm::Torus(r, tube, axis) => across(*axis) * *r + n * *tube,
        SurfaceForm::Sphere(r) => n * *r,
        SurfaceForm::Ellipsoid(half) => {
            let g = n[0].graph();
            let axes: [Vec3<'g>; 3] = std::array::from_fn(|k| rotate(Vec3::coordinate_axis(g, k)));
            let parts: [Expr<'g>; 3] = std::array::from_fn(|k| half[k] * axes[k].dot(n));
            let size = Vec3(parts).norm();
            (0..3).fold(Vec3::zero(g), |sum, k| sum + axes[k] * (half[k] * parts[k] / size))
        }
        _ => return None,
    })
}

/// Returns two unit tangents for a unit normal of any direction (Duff et al., *Building an orthonormal basis,
/// revisited*, 2017).
fn tangents_of(n: Vec3<'_>) -> (Vec3<'_>, Vec3<'_>) {
    let [x, y, z] = n.0;
    let sign = z.apply_function(Function::Signum);
    let a = -((sign + z).num(1.0) / (sign + z));
    let b = x * y * a;
    let one = z.num(1.0);
    (Vec3([one + sign * x * x * a, sign * b, -(sign * x)]), Vec3([b, sign + y * y * a, -y]))
}
