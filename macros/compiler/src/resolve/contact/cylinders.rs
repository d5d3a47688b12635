//! Contact points of spheres, capsules and boxes with cylinders that have end faces.
//!
//! The distance of a point from a cylinder with two ends has a closed form. A capsule touches it at spheres
//! around points of its axis: the nearest point, and the ends of the parts of the axis that are next to the
//! side and above an end. The distance from a convex body along a line is a convex function, whose minimum is
//! found by bisection and the method of false position, with a fixed number of steps.
//!
//! A box touches a cylinder with two ends at points of both bodies. Points of the cylinder on the nearest
//! face of the box are the ends of its lowest line, where the sides of the face cut it off, and the rim of
//! the lower end. Points of the box on the cylinder are those of the edges of a face that is opposite to an
//! end, and the nearest points of the edges at the nearest corner. An unbounded cylinder is treated as a
//! capsule longer than the box.

use super::boxes::{Face, MIN_SLOPE, OrientedBox, capsule_axis_contacts};
use super::geometry::{PointContact, clamp, indicator_of_positive, tangents_of};
use super::pair::sphere_contact;
use super::surface::SurfaceForm;
use crate::expr::{Expr, Extreme, Function, Vec3};

/// Distance below which a point is treated as part of the surface, relative to the radius.
const ON_SURFACE: f64 = 1e-9;
/// Number of bisections for the nearest point of a line.
const BISECTIONS: usize = 24;
/// Number of steps of the false position method after the bisections.
const FALSE_POSITIONS: usize = 2;

/// Smallest difference of slopes in false position, which excludes a division by zero.
const LEAST_RISE: f64 = 1e-30;
/// Number of alternating projections that determine the nearest corner of a box.
const PROJECTIONS: usize = 6;

/// Cylinder with two end faces, in common axes of both bodies.
#[derive(Clone, Copy)]
pub(super) struct Drum<'g> {
    pub(super) radius: Expr<'g>,
    /// Half of the cylinder's length, m.
    pub(super) half: Expr<'g>,
    pub(super) axis: Vec3<'g>,
}

/// Position of a point relative to a cylinder's side and end faces.
struct DistancesFromCylinder<'g> {
    /// Signed distances from the side and from the nearer end.
    side: Expr<'g>,
    end: Expr<'g>,
    /// Outward normals of the cylinder's side and end at the point.
    radial: Vec3<'g>,
    axial: Vec3<'g>,
}

impl<'g> DistancesFromCylinder<'g> {
    /// Returns the position relative to the nearest point of the cylinder; zero inside.
    fn offset_from_nearest_point(&self) -> Vec3<'g> {
        let positive_part = |distance: Expr<'g>| distance.minimum_or_maximum(Extreme::Max, distance.zero());
        self.radial * positive_part(self.side) + self.axial * positive_part(self.end)
    }
}

impl<'g> Drum<'g> {
    fn locate_relative_to_cylinder(&self, p: Vec3<'g>) -> DistancesFromCylinder<'g> {
        let height = self.axis.dot(p);
        let outward = p - self.axis * height;
        let least = self.radius * ON_SURFACE;
        let size = outward.dot(outward).minimum_or_maximum(Extreme::Max, least.square()).sqrt();
        DistancesFromCylinder {
            side: size - self.radius,
            end: height.apply_function(Function::Abs) - self.half,
            radial: outward.map(|x| x / size),
            axial: self.axis * height.apply_function(Function::Signum),
        }
    }

    /// Returns the signed distance of a point, relative to the centre, and the outward normal at the nearest
    /// point of the surface.
    fn distance_and_normal(&self, p: Vec3<'g>) -> (Expr<'g>, Vec3<'g>) {
        let DistancesFromCylinder { side, end, radial, axial } = self.locate_relative_to_cylinder(p);
        let (zero, least) = (side.zero(), self.radius * ON_SURFACE);
        let (over, beyond) =
            (side.minimum_or_maximum(Extreme::Max, zero), end.minimum_or_maximum(Extreme::Max, zero));
        let distance =
            (over.square() + beyond.square()).minimum_or_maximum(Extreme::Max, least.square()).sqrt();
        let outside = (radial * over + axial * beyond).map(|x| x / distance);
        let inside = radial + (axial - radial) * indicator_of_positive(end - side);
        let (depth, is_outside) =
            (side.minimum_or_maximum(Extreme::Max, end), indicator_of_positive(distance - least * 1.5));
        (depth + (distance - depth) * is_outside, inside + (outside - inside) * is_outside)
    }

    /// Returns the position of the nearest point of a segment, which extends from `c` by `reach` in both
    /// directions of the unit vector `own`.
    fn nearest_position_on_segment(&self, c: Vec3<'g>, own: Vec3<'g>, reach: Expr<'g>) -> Expr<'g> {
        // The derivative of the signed distance, which increases along the line.
        let distance_slope_along_line = |t: Expr<'g>| self.distance_and_normal(c + own * t).1.dot(own);
        let (mut low, mut high) = (-reach, reach);
        let narrow_bracket = |low: &mut Expr<'g>, high: &mut Expr<'g>, t: Expr<'g>| {
            let is_beyond = indicator_of_positive(distance_slope_along_line(t));
            *high += (t - *high) * is_beyond;
            *low = t + (*low - t) * is_beyond;
        };
        for _ in 0..BISECTIONS {
            let middle = (low + high) * 0.5;
            narrow_bracket(&mut low, &mut high, middle);
        }
        let mut t = low;
        for _ in 0..FALSE_POSITIONS {
            let (first, last) = (distance_slope_along_line(low), distance_slope_along_line(high));
            let rise = (last - first).minimum_or_maximum(Extreme::Max, reach.num(LEAST_RISE));
            t = low - first * ((high - low) / rise);
            t = t.minimum_or_maximum(Extreme::Max, low).minimum_or_maximum(Extreme::Min, high);
            narrow_bracket(&mut low, &mut high, t);
        }
        t
    }

    /// Returns the positions on a segment where its line crosses the unbounded side; if it does not, twice
    /// the position nearest to the axis. Positions beyond the segment are replaced by its ends.
    fn crossings_of_cylinder_side(&self, c: Vec3<'g>, own: Vec3<'g>, reach: Expr<'g>) -> [Expr<'g>; 2] {
        let normal_to_axis = |v: Vec3<'g>| v - self.axis * self.axis.dot(v);
        let (start, direction) = (normal_to_axis(c), normal_to_axis(own));
        let a = direction.dot(direction).minimum_or_maximum(Extreme::Max, reach.num(MIN_SLOPE));
        let b = start.dot(direction);
        let discriminant = b.square() - a * (start.dot(start) - self.radius.square());
        let least = a * (self.radius * ON_SURFACE).square();
        let root = discriminant.minimum_or_maximum(Extreme::Max, least).sqrt();
        [-root, root].map(|root| clamp((root - b) / a, reach))
    }

    /// Returns the positions on a segment where its line crosses the planes of both ends. Positions beyond
    /// the segment are replaced by its ends.
    fn end_plane_crossings_of_segment(&self, c: Vec3<'g>, own: Vec3<'g>, reach: Expr<'g>) -> [Expr<'g>; 2] {
        let (height, rise) = (self.axis.dot(c), self.axis.dot(own));
        let slope = rise.apply_function(Function::Abs).minimum_or_maximum(Extreme::Max, reach.num(MIN_SLOPE));
        let inverse = rise.apply_function(Function::Signum) / slope;
        [-self.half, self.half].map(|end| clamp((end - height) * inverse, reach))
    }

    /// Returns the contact of a sphere whose centre is at `c` relative to that of the cylinder.
    pub(super) fn sphere_contact(&self, radius: Expr<'g>, c: Vec3<'g>) -> PointContact<'g> {
        let (distance, normal) = self.distance_and_normal(c);
        contact_from_gap_and_normal(distance - radius, -(normal * radius), normal)
    }

    /// Returns the contacts of a capsule whose centre is at `c` relative to that of the cylinder.
    pub(super) fn capsule_contacts_with_cylinder(
        &self,
        radius: Expr<'g>,
        (own, reach): (Vec3<'g>, Expr<'g>),
        c: Vec3<'g>,
    ) -> Vec<PointContact<'g>> {
        let crossings = self
            .end_plane_crossings_of_segment(c, own, reach)
            .into_iter()
            .chain(self.crossings_of_cylinder_side(c, own, reach));
        let places = crossings.chain([self.nearest_position_on_segment(c, own, reach)]);
        let touches = places.map(|t| {
            let touch = self.sphere_contact(radius, c + own * t);
            PointContact { point: touch.point + own * t, ..touch }
        });
        touches.collect()
    }

    /// Returns the contacts with a box. `c` leads from the centre of the box to that of the cylinder; points
    /// are relative to the latter. `rim` returns the directions of four points of a rim, beginning with the
    /// lowest along a normal.
    pub(super) fn contacts_with_box(
        &self,
        block: &OrientedBox<'g>,
        c: Vec3<'g>,
        rim: &dyn Fn(Vec3<'g>) -> [Vec3<'g>; 4],
    ) -> Vec<PointContact<'g>> {
        let mut points = self.cylinder_contacts_on_box_face(block, c, rim);
        let contact_of_box_edge_point = |e: Vec3<'g>| {
            let (distance, normal) = self.distance_and_normal(e - c);
            contact_from_gap_and_normal(distance, e - c, -normal)
        };
        // The edges of the face that is opposite to an end.
        let cosines = block.axes.map(|axis| axis.dot(self.axis).apply_function(Function::Abs));
        let facing = selector_of_largest(cosines);
        let face = Face::face_on_side_of_position(block, &facing, c, self.half);
        let [_, first, second] = face.axes;
        let middle = face.axes[0] * face.half[0];
        for (along, across, reach, offset) in
            [(first, second, face.half[1], face.half[2]), (second, first, face.half[2], face.half[1])]
        {
            for side in [-1.0, 1.0] {
                let middle = middle + across * (offset * side);
                let crossings = self.crossings_of_cylinder_side(middle - c, along, reach);
                points.extend(crossings.map(|t| contact_of_box_edge_point(middle + along * t)));
            }
        }
        // The edges at the corner that is nearest to the cylinder.
        let sides = self.vectors_to_nearest_box_faces(block, c);
        for k in 0..3 {
            let middle = sides[(k + 1) % 3] + sides[(k + 2) % 3];
            let (along, reach) = (block.axes[k], block.half[k]);
            points.push(contact_of_box_edge_point(
                middle + along * self.nearest_position_on_segment(middle - c, along, reach),
            ));
        }
        points
    }

    /// Returns the contacts of points of the cylinder with the nearest face of a box.
    fn cylinder_contacts_on_box_face(
        &self,
        block: &OrientedBox<'g>,
        c: Vec3<'g>,
        rim: &dyn Fn(Vec3<'g>) -> [Vec3<'g>; 4],
    ) -> Vec<PointContact<'g>> {
        let (zero, one) = (self.half.zero(), self.half.num(1.0));
        let separations = std::array::from_fn(|k| {
            let axis = block.axes[k];
            let cosine = axis.dot(self.axis);
            let sine = (one - cosine.square()).minimum_or_maximum(Extreme::Max, zero.num(MIN_SLOPE)).sqrt();
            let reach = self.half * cosine.apply_function(Function::Abs) + self.radius * sine;
            axis.dot(c).apply_function(Function::Abs) - block.half[k] - reach
        });
        let face = Face::face_on_side_of_position(block, &selector_of_largest(separations), c, self.half);
        let normal = face.axes[0];
        let directions = rim(normal);
        let (down, along) = (directions[0] * self.radius, self.axis * self.half);
        let (start, direction) =
            (face.components_along_face_axes(c + down), face.components_along_face_axes(along));
        let [from, to] = face.clip_line_to_face_sides(&start, &direction);
        let outside = ((from - to) * self.half).minimum_or_maximum(Extreme::Min, self.half);
        let line = [from.minimum_or_maximum(Extreme::Min, one), to.minimum_or_maximum(Extreme::Max, -one)]
            .map(|t| {
                let height = start[0] + direction[0] * t - face.half[0];
                face.contact_at_position(height.minimum_or_maximum(Extreme::Max, outside), down + along * t)
            });
        let lower = along * -(self.axis.dot(normal).apply_function(Function::Signum));
        let rim = directions[1..].iter().map(|direction| {
            let point = lower + *direction * self.radius;
            let at = face.components_along_face_axes(c + point);
            let distance_beyond_half_width = |k: usize| at[k].apply_function(Function::Abs) - face.half[k];
            let outside =
                distance_beyond_half_width(1).minimum_or_maximum(Extreme::Max, distance_beyond_half_width(2));
            face.contact_at_position((at[0] - face.half[0]).minimum_or_maximum(Extreme::Max, outside), point)
        });
        line.into_iter().chain(rim).collect()
    }

    /// Returns vectors from the centre of a box to the three faces at the corner that is nearest to the
    /// cylinder, by alternating projections on both.
    fn vectors_to_nearest_box_faces(&self, block: &OrientedBox<'g>, c: Vec3<'g>) -> [Vec3<'g>; 3] {
        let nearest_point_in_block = |v: Vec3<'g>| {
            let clamped_axis_component =
                |k: usize| block.axes[k] * clamp(block.axes[k].dot(v), block.half[k]);
            clamped_axis_component(0) + clamped_axis_component(1) + clamped_axis_component(2)
        };
        let mut point = nearest_point_in_block(c);
        for _ in 0..PROJECTIONS {
            point = nearest_point_in_block(
                point - self.locate_relative_to_cylinder(point - c).offset_from_nearest_point(),
            );
        }
        std::array::from_fn(|k| {
            let axis = block.axes[k];
            axis * (block.half[k] * axis.dot(point).apply_function(Function::Signum))
        })
    }
}

/// Returns the contacts of an unbounded cylinder with a box, which touches it as a capsule that is longer
/// than the box. `c` leads from the centre of the box to that of the cylinder; points are relative to the
/// latter.
pub(super) fn unbounded_cylinder_box_contacts<'g>(
    radius: Expr<'g>,
    axis: Vec3<'g>,
    block: &OrientedBox<'g>,
    c: Vec3<'g>,
) -> Vec<PointContact<'g>> {
    let shift = axis * -axis.dot(c);
    let [a, b, d] = block.half;
    let mut points = capsule_axis_contacts(radius, (axis, a + b + d), block, c + shift);
    points.iter_mut().for_each(|touch| touch.point += shift);
    points
}

/// Returns the contacts of a capsule with an unbounded cylinder: its ends, and the point of its axis that is
/// nearest to that of the cylinder. `c` is the centre of the capsule relative to that of the cylinder.
pub(super) fn capsule_unbounded_cylinder_contacts<'g>(
    radius: Expr<'g>,
    (own, reach): (Vec3<'g>, Expr<'g>),
    pipe: &SurfaceForm<'g>,
    axis: Vec3<'g>,
    c: Vec3<'g>,
    rotate: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
) -> Vec<PointContact<'g>> {
    let across = own - axis * axis.dot(own);
    let square = across.dot(across).minimum_or_maximum(Extreme::Max, reach.num(MIN_SLOPE));
    let near = clamp(-(c.dot(across) / square), reach);
    let touches = [-reach, near, reach].into_iter().filter_map(|t| {
        let touch = sphere_contact(radius, pipe, c + own * t, rotate)?;
        Some(PointContact { point: touch.point + own * t, ..touch })
    });
    touches.collect()
}

/// Returns a candidate contact with this gap, point and normal.
fn contact_from_gap_and_normal<'g>(gap: Expr<'g>, point: Vec3<'g>, normal: Vec3<'g>) -> PointContact<'g> {
    let (first, second) = tangents_of(normal);
    let axes = [("normal", normal), ("first", first), ("second", second)];
    PointContact { gap, point, axes, conditions: Vec::new() }
}

/// Returns the selector (0 or 1 for each) of the largest of three values.
fn selector_of_largest(values: [Expr<'_>; 3]) -> [Expr<'_>; 3] {
    let [x, y, z] = values;
    let one = x.num(1.0);
    let third = indicator_of_positive(z - x.minimum_or_maximum(Extreme::Max, y));
    let second = indicator_of_positive(y - x) * (one - third);
    [one - second - third, second, third]
}
