//! Pairs of surfaces: their motions relative to the link that carries both, and the point where they touch.

use super::geometry::{PointContact, tangents_of};
use super::surface::{Surface, SurfaceForm};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Graph, Vec3};
use crate::kinematics::jet::{self, MovingVector, RelativeLinkMotion};
use crate::kinematics::perpendicular_directions;
use crate::mechanism::Model;
use crate::resolve::scope::{PlacedElements, Scope, VectorTerms};
use crate::syntax;

/// Two surfaces with the motions of their bodies relative to the link that carries both, in the axes of that
/// link.
pub(super) struct SurfacePair<'s, 'g> {
    kinematics: &'s PlacedElements<'g>,
    /// First surface: the one that rolls on, or collides with, the other.
    pub(super) a: Surface<'g>,
    pub(super) b: Surface<'g>,
    pub(super) on_a: RelativeLinkMotion<'g>,
    pub(super) on_b: RelativeLinkMotion<'g>,
    /// Position of the first surface.
    pub(super) center: MovingVector<'g>,
    /// Position of the second surface.
    pub(super) base: MovingVector<'g>,
    /// Whether the second surface is written before the first.
    swapped: bool,
}

/// Returns two surfaces with their motions, in the order that `is_known` accepts.
pub(super) fn surfaces_in_accepted_order<'s, 'g>(
    scope: &'s Scope<'_, 'g>,
    model: &Model<'g>,
    mut a: Surface<'g>,
    mut b: Surface<'g>,
    is_known: fn(&SurfaceForm<'g>, &SurfaceForm<'g>) -> bool,
    second: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<SurfacePair<'s, 'g>> {
    if a.frame.link == b.frame.link {
        cx.report_error(second.place.clone(), "these two surfaces do not move relative to each other")
            .add_help("a contact is between surfaces of bodies that move relative to each other");
        return None;
    }
    let swapped = !is_known(&a.form, &b.form);
    if swapped {
        std::mem::swap(&mut a, &mut b);
    }
    let joints = &scope.kinematics.joints;
    let (on_a, on_b) = (
        jet::relative_motion(model, joints, a.frame.link, b.frame.link),
        jet::relative_motion(model, joints, b.frame.link, a.frame.link),
    );
    let center = jet::motion_of_point(joints, &on_a, a.frame.pose.translation);
    let base = jet::motion_of_point(joints, &on_b, b.frame.pose.translation);
    Some(SurfacePair { kinematics: &scope.kinematics, a, b, on_a, on_b, center, base, swapped })
}

impl<'g> SurfacePair<'_, 'g> {
    /// Returns the graph that owns the expressions.
    pub(super) fn expression_graph(&self) -> &'g Graph {
        self.center.value[0].graph()
    }

    /// Returns the surfaces in the order in which they are written.
    pub(super) fn written_surfaces(&self) -> Vec<Surface<'g>> {
        let (a, b) = (self.a.clone(), self.b.clone());
        if self.swapped { vec![b, a] } else { vec![a, b] }
    }

    /// Returns the position of a point given relative to the centre of the first surface.
    pub(super) fn contact_position(&self, point: Vec3<'g>) -> VectorTerms<'g> {
        let frame = &self.a.frame;
        let mut place = self.kinematics.position_of_point(frame.link, frame.pose.translation);
        place.push((self.on_a.ancestor, point));
        place
    }

    /// Returns a direction of the first body, with its rate, in the common axes.
    pub(super) fn direction_of_first_body(&self, v: Vec3<'g>) -> MovingVector<'g> {
        jet::motion_of_direction(
            &self.kinematics.joints,
            &self.on_a,
            self.a.frame.pose.rotation.vector_in_parent_axes(v),
        )
    }

    /// Returns a direction of the second body, with its rate, in the common axes.
    pub(super) fn direction_of_second_body(&self, v: Vec3<'g>) -> MovingVector<'g> {
        jet::motion_of_direction(
            &self.kinematics.joints,
            &self.on_b,
            self.b.frame.pose.rotation.vector_in_parent_axes(v),
        )
    }

    /// Returns the velocity of the first body relative to the second at a point given relative to the centre
    /// of the first surface.
    pub(super) fn slip(&self, point: Vec3<'g>) -> Vec3<'g> {
        let SurfacePair { center, base, .. } = self;
        let [w_a, w_b] = self.angular_velocities();
        let arm = center.value + point - base.value;
        center.rate + w_a.cross(point) - (base.rate + w_b.cross(arm))
    }

    /// Returns the angular velocities of both bodies relative to their common link.
    pub(super) fn angular_velocities(&self) -> [Vec3<'g>; 2] {
        [&self.on_a, &self.on_b]
            .map(|on| jet::direction_in_ancestor(&self.kinematics.joints, on, on.twist.angular))
    }

    /// Returns the contact of a pair; `None` for pairs that touch along a line.
    pub(super) fn contact_of_pair(&self) -> Option<PointContact<'g>> {
        let first_surface_to_common_axes = |v| self.direction_of_first_body(v).value;
        let second_surface_to_common_axes = |v| self.direction_of_second_body(v).value;
        let c = self.center.value - self.base.value;
        match (&self.a.form, &self.b.form) {
            (_, SurfaceForm::ParametricSurface(sheet)) => self.contact_of_convex_body(sheet),
            (a, SurfaceForm::Plane(n)) => {
                let [(first, e1), (second, e2)] =
                    perpendicular_directions(*n).map(|(word, e)| (word, second_surface_to_common_axes(e)));
                let normal = second_surface_to_common_axes(*n);
                let point = -support_point(a, normal, 0.0, &first_surface_to_common_axes)?;
                let gap = normal.dot(c + point);
                Some(PointContact {
                    gap,
                    point,
                    axes: [("normal", normal), (first, e1), (second, e2)],
                    conditions: Vec::new(),
                })
            }
            (SurfaceForm::Sphere(radius), b) => sphere_contact(*radius, b, c, &second_surface_to_common_axes),
            _ => None,
        }
    }
}

/// Returns the contact of a sphere whose centre is at `c` relative to the centre or apex of the other
/// surface.
pub(super) fn sphere_contact<'g>(
    radius: Expr<'g>,
    b: &SurfaceForm<'g>,
    c: Vec3<'g>,
    second_surface_to_common_axes: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
) -> Option<PointContact<'g>> {
    let inside = matches!(b, SurfaceForm::Bowl(_) | SurfaceForm::Tube(..) | SurfaceForm::Funnel(..));
    let reverse_if_inside = |x: Expr<'g>| if inside { -x } else { x };
    let (normal, distance, tangents) = match b {
        SurfaceForm::Sphere(r) | SurfaceForm::Bowl(r) => {
            let size = c.norm();
            let normal = c.map(|x| reverse_if_inside(x / size));
            let (first, second) = tangents_of(normal);
            (normal, reverse_if_inside(size - *r), [("first", first), ("second", second)])
        }
        SurfaceForm::Cylinder(r, u) | SurfaceForm::Tube(r, u) => {
            let axis = second_surface_to_common_axes(*u);
            let outward = c - axis * axis.dot(c);
            let size = outward.norm();
            let normal = outward.map(|x| reverse_if_inside(x / size));
            (normal, reverse_if_inside(size - *r), [("along", axis), ("around", normal.cross(axis))])
        }
        SurfaceForm::Cone(half, u) | SurfaceForm::Funnel(half, u) => {
            let (sine, cosine) = (half.sin(), half.cos());
            let axis = second_surface_to_common_axes(*u);
            let height = axis.dot(c);
            let outward = c - axis * height;
            let size = outward.norm();
            let radial = outward.map(|x| x / size);
            let normal = (radial * cosine - axis * sine).map(reverse_if_inside);
            let along = radial * sine + axis * cosine;
            let distance = reverse_if_inside(size * cosine - height * sine);
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
pub(super) fn support_point<'g>(
    form: &SurfaceForm<'g>,
    n: Vec3<'g>,
    min_sine_squared: f64,
    rotate: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
) -> Option<Vec3<'g>> {
    let unit_vector_across_axis = |axis: Vec3<'g>| {
        let a = rotate(axis);
        let cosine = a.dot(n);
        let sine = (cosine.num(1.0 + min_sine_squared) - cosine.square()).sqrt();
        (n - a * cosine).map(|x| x / sine)
    };
    Some(match form {
        SurfaceForm::Circle(r, axis) => unit_vector_across_axis(*axis) * *r,
        SurfaceForm::Torus(r, tube, axis) => unit_vector_across_axis(*axis) * *r + n * *tube,
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
