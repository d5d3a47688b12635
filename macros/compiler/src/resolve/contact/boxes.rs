//! Contact points of two boxes, and of a sphere or capsule on a box.
//!
//! Two boxes are separated if a plane lies between them whose normal is a face normal of either box, or is
//! perpendicular to an edge of each (Gottschalk, Lin and Manocha, *OBBTree*, 1996). Of these fifteen
//! directions, the one with the largest separation (or the smallest overlap) determines the contact. If it is
//! a face normal, the opposite face of the other box is clipped by the sides of the first face. The candidate
//! points are the ends of its clipped edges, and the corners of the first face that lie within the other. If
//! the direction is perpendicular to two edges, the contact is at the closest points of these edges.
//!
//! The axis of a capsule is treated as an edge with a radius; the ends of a capsule are spheres.
//!
//! The gap of a candidate point that does not belong to the determining direction is increased by the
//! difference of the separations. If two edges of a face share a point, it counts once; the gap of the
//! duplicate is the size of the boxes.

use super::cylinders::{Drum, unbounded_cylinder_box_contacts};
use super::geometry::{
    PointContact, clamp, closest_positions_on_segments, directions_to_rim_points, indicator_of_positive,
};
use super::pair::{SurfacePair, sphere_contact};
use super::surface::SurfaceForm;
use crate::expr::{Expr, Extreme, Function, Vec3};

/// Amount by which the separation along a later direction must exceed that of an earlier one to replace it,
/// relative to the size of the boxes.
const TIE_TOLERANCE: f64 = 1e-9;
/// Squared sine of the angle below which edges are treated as parallel; faces then determine the contact.
const PARALLEL: f64 = 1e-10;
/// Generic direction that orders boxes of equal size by their positions. Boxes placed on purpose rarely have
/// equal components along it.
const TIE_BREAK: [f64; 3] = [0.2113, 0.3779, 0.9014];
/// Smallest slope of an edge against a side that is not treated as parallel to it.
pub(super) const MIN_SLOPE: f64 = 1e-12;

/// A box: its axes, half its lengths along them, and its centre.
#[derive(Clone, Copy)]
pub(super) struct OrientedBox<'g> {
    pub(super) axes: [Vec3<'g>; 3],
    pub(super) half: [Expr<'g>; 3],
    center: Vec3<'g>,
}

/// Candidate direction along which two boxes may be separated.
#[derive(Clone, Copy)]
struct SeparatingDirection<'g> {
    /// Separation of the boxes along the direction, negative if they overlap.
    distance: Expr<'g>,
    /// Selectors, one entry equal to one, of the axis of each box that defines the direction. For a face
    /// normal both are the face's axis.
    first: [Expr<'g>; 3],
    second: [Expr<'g>; 3],
}

/// Two boxes with the cosines between their axes.
struct BoxPair<'g> {
    a: OrientedBox<'g>,
    b: OrientedBox<'g>,
    cosines: [[Expr<'g>; 3]; 3],
    size: Expr<'g>,
}

/// Returns `first` if `which` is one, `second` if it is zero.
fn select_by_indicator<'g>(which: Expr<'g>, first: Expr<'g>, second: Expr<'g>) -> Expr<'g> {
    first * which + second * (which.num(1.0) - which)
}

fn select_vector_by_indicator<'g>(which: Expr<'g>, first: Vec3<'g>, second: Vec3<'g>) -> Vec3<'g> {
    Vec3(std::array::from_fn(|k| select_by_indicator(which, first[k], second[k])))
}

fn absolute(x: Expr<'_>) -> Expr<'_> {
    x.apply_function(Function::Abs)
}

fn maximum<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    a.minimum_or_maximum(Extreme::Max, b)
}

fn minimum<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    a.minimum_or_maximum(Extreme::Min, b)
}

/// Returns the one of three values that a selector (0 or 1 for each) picks.
fn select_one_of_three<'g>(which: &[Expr<'g>; 3], values: [Expr<'g>; 3]) -> Expr<'g> {
    values[0] * which[0] + values[1] * which[1] + values[2] * which[2]
}

fn select_axis<'g>(which: &[Expr<'g>; 3], axes: &[Vec3<'g>; 3]) -> Vec3<'g> {
    axes[0] * which[0] + axes[1] * which[1] + axes[2] * which[2]
}

/// Returns the selector of the cyclically next of three axes.
fn next_axis_selector<'g>(which: &[Expr<'g>; 3]) -> [Expr<'g>; 3] {
    let [a, b, c] = *which;
    [c, a, b]
}

/// Multiplies the three entries of a selector by a factor.
fn scale_selector<'g>(which: [Expr<'g>; 3], factor: Expr<'g>) -> [Expr<'g>; 3] {
    which.map(|x| x * factor)
}

impl<'g> SurfacePair<'_, 'g> {
    /// Returns the contacts of a sphere, a capsule, a cylinder or a box with a box. `c` leads from the centre
    /// of the latter to that of the former.
    pub(super) fn contacts_with_box(&self, lengths: &[Expr<'g>; 3], c: Vec3<'g>) -> Vec<PointContact<'g>> {
        let g = self.expression_graph();
        let oriented_box_from_lengths =
            |lengths: &[Expr<'g>; 3], center, rotate: &dyn Fn(Vec3<'g>) -> Vec3<'g>| OrientedBox {
                axes: std::array::from_fn(|k| rotate(Vec3::coordinate_axis(g, k))),
                half: lengths.map(|length| length * 0.5),
                center,
            };
        let (first_surface_to_common_axes, second_surface_to_common_axes) =
            (|v| self.direction_of_first_body(v).value, |v| self.direction_of_second_body(v).value);
        let target = oriented_box_from_lengths(lengths, Vec3::zero(g), &second_surface_to_common_axes);
        let sphere_box_contact = |radius: Expr<'g>, place: Vec3<'g>| {
            let inner = (0..3).fold(Vec3::zero(g), |sum, k| {
                sum + target.axes[k] * clamp(target.axes[k].dot(place), target.half[k])
            });
            sphere_contact(
                radius,
                &SurfaceForm::Sphere(g.zero()),
                place - inner,
                &second_surface_to_common_axes,
            )
        };
        match &self.a.form {
            SurfaceForm::Sphere(radius) => sphere_box_contact(*radius, c).into_iter().collect(),
            SurfaceForm::Capsule(radius, length, axis) => {
                let (own, reach) = (first_surface_to_common_axes(*axis), *length * 0.5);
                let contact_of_end_sphere = |side: f64| {
                    let place = own * (reach * side);
                    sphere_box_contact(*radius, c + place)
                        .map(|touch| PointContact { point: touch.point + place, ..touch })
                };
                let ends = [-1.0, 1.0].into_iter().filter_map(contact_of_end_sphere);
                ends.chain(capsule_axis_contacts(*radius, (own, reach), &target, c)).collect()
            }
            SurfaceForm::Cuboid(own) => box_contact_candidates(
                &oriented_box_from_lengths(own, c, &first_surface_to_common_axes),
                &target,
            ),
            SurfaceForm::Cylinder(radius, axis) => {
                unbounded_cylinder_box_contacts(*radius, first_surface_to_common_axes(*axis), &target, c)
            }
            SurfaceForm::Drum(radius, length, axis) => {
                let drum =
                    Drum { radius: *radius, half: *length * 0.5, axis: first_surface_to_common_axes(*axis) };
                drum.contacts_with_box(&target, c, &|normal| {
                    directions_to_rim_points(*axis, normal, &first_surface_to_common_axes)
                })
            }
            _ => Vec::new(),
        }
    }
}

/// Returns the points where two boxes may touch, relative to the centre of the first box, which is at `c`
/// from that of the second. All directions are in the same axes.
fn box_contact_candidates<'g>(a: &OrientedBox<'g>, b: &OrientedBox<'g>) -> Vec<PointContact<'g>> {
    let size = a.half.into_iter().chain(b.half).fold(a.half[0].zero(), |sum, half| sum + half);
    let cosines = a.axes.map(|own| b.axes.map(|other| own.dot(other)));
    let boxes = BoxPair { a: *a, b: *b, cosines, size };
    let (face, face_is_second) = boxes.face_of_largest_separation();
    let edge = boxes.best_edge_pair();
    let by_edges = indicator_of_positive(edge.distance - face.distance - size * TIE_TOLERANCE);
    let (holder, other) = boxes.order_by_face_owner(face_is_second);
    let mut points = face_contacts(&holder, &other, &face.first, size);
    for point in &mut points {
        // The point belongs to both bodies; the normal points towards the first one.
        point.point -= a.center;
        let side = face_is_second * 2.0 - face_is_second.num(1.0);
        point.axes[0].1 = point.axes[0].1 * side;
        let other = maximum(point.gap, edge.distance - face.distance);
        point.gap = select_by_indicator(by_edges, other, point.gap);
    }
    let crossing = boxes.edge_contact(&edge);
    let other = maximum(crossing.gap, face.distance - edge.distance);
    points.push(PointContact { gap: select_by_indicator(by_edges, crossing.gap, other), ..crossing });
    points
}

impl<'g> BoxPair<'g> {
    fn center_offset(&self) -> Vec3<'g> {
        self.a.center - self.b.center
    }

    /// Returns the face along whose normal the boxes have the largest separation, and one if it belongs to
    /// the second box (otherwise zero). Between equal separations, a face of the larger box is chosen; for
    /// boxes of equal size, of the lower one along a fixed direction. The order in which the boxes are
    /// written has no effect.
    fn face_of_largest_separation(&self) -> (SeparatingDirection<'g>, Expr<'g>) {
        let (zero, one) = (self.size.zero(), self.size.num(1.0));
        let [first, second] = [false, true].map(|is_second| self.best_separating_face(is_second));
        let half_sum_of_lengths =
            |block: &OrientedBox<'g>| block.half.into_iter().fold(zero, |sum, half| sum + half);
        let size_difference = half_sum_of_lengths(&self.a) - half_sum_of_lengths(&self.b);
        let same = one - indicator_of_positive(absolute(size_difference) - self.size * TIE_TOLERANCE);
        let c = self.center_offset();
        let lower = -(c[0] * TIE_BREAK[0] + c[1] * TIE_BREAK[1] + c[2] * TIE_BREAK[2]);
        let preference = (select_by_indicator(same, lower, size_difference)).apply_function(Function::Signum);
        let is_first =
            indicator_of_positive(first.distance - second.distance + preference * self.size * TIE_TOLERANCE);
        let which = std::array::from_fn(|k| select_by_indicator(is_first, first.first[k], second.first[k]));
        let distance = select_by_indicator(is_first, first.distance, second.distance);
        (SeparatingDirection { distance, first: which, second: which }, one - is_first)
    }

    /// Returns the face of one box along whose normal the other is farthest from it.
    fn best_separating_face(&self, is_second: bool) -> SeparatingDirection<'g> {
        let (zero, one) = (self.size.zero(), self.size.num(1.0));
        let c = self.center_offset();
        let (own, other) = if is_second { (&self.b, &self.a) } else { (&self.a, &self.b) };
        let separation_along_axis = |k: usize| {
            let along: [Expr<'g>; 3] = std::array::from_fn(|i| match is_second {
                true => self.cosines[i][k],
                false => self.cosines[k][i],
            });
            let reach = (0..3).fold(zero, |sum, k| sum + other.half[k] * absolute(along[k]));
            absolute(own.axes[k].dot(c)) - own.half[k] - reach
        };
        let selector_of_axis = |k: usize| std::array::from_fn(|i| if i == k { one } else { zero });
        let mut best = SeparatingDirection {
            distance: separation_along_axis(0),
            first: selector_of_axis(0),
            second: selector_of_axis(0),
        };
        for k in [1, 2] {
            let found = separation_along_axis(k);
            let better = indicator_of_positive(found - best.distance - self.size * TIE_TOLERANCE);
            let which =
                std::array::from_fn(|i| select_by_indicator(better, selector_of_axis(k)[i], best.first[i]));
            let distance = select_by_indicator(better, found, best.distance);
            best = SeparatingDirection { distance, first: which, second: which };
        }
        best
    }

    /// Returns the pair of edges along whose common normal the boxes have the largest separation.
    fn best_edge_pair(&self) -> SeparatingDirection<'g> {
        let zero = self.size.zero();
        let c = self.center_offset();
        let on_a = self.a.axes.map(|axis| axis.dot(c));
        let mut best = SeparatingDirection { distance: -self.size, first: [zero; 3], second: [zero; 3] };
        for i in 0..3 {
            for j in 0..3 {
                let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
                let r = &self.cosines;
                let square = r[i1][j] * r[i1][j] + r[i2][j] * r[i2][j];
                let sine = maximum(square, zero.num(PARALLEL)).sqrt();
                let along = absolute(on_a[i2] * r[i1][j] - on_a[i1] * r[i2][j]);
                let reach = self.a.half[i1] * absolute(r[i2][j])
                    + self.a.half[i2] * absolute(r[i1][j])
                    + self.b.half[j1] * absolute(r[i][j2])
                    + self.b.half[j2] * absolute(r[i][j1]);
                let distance = (along - reach) / sine;
                let better = indicator_of_positive(distance - best.distance - self.size * TIE_TOLERANCE)
                    * indicator_of_positive(square - zero.num(PARALLEL));
                let other = better.num(1.0) - better;
                let selector_choosing_index_if_better = |known: [Expr<'g>; 3], k: usize| {
                    let mut which = scale_selector(known, other);
                    which[k] += better;
                    which
                };
                best = SeparatingDirection {
                    distance: select_by_indicator(better, distance, best.distance),
                    first: selector_choosing_index_if_better(best.first, i),
                    second: selector_choosing_index_if_better(best.second, j),
                };
            }
        }
        best
    }

    /// Returns the box that has the determining face, and the other box.
    fn order_by_face_owner(&self, face_is_second: Expr<'g>) -> (OrientedBox<'g>, OrientedBox<'g>) {
        let choose_between_boxes = |first: &OrientedBox<'g>, second: &OrientedBox<'g>| OrientedBox {
            axes: std::array::from_fn(|k| {
                select_vector_by_indicator(face_is_second, first.axes[k], second.axes[k])
            }),
            half: std::array::from_fn(|k| select_by_indicator(face_is_second, first.half[k], second.half[k])),
            center: select_vector_by_indicator(face_is_second, first.center, second.center),
        };
        (choose_between_boxes(&self.b, &self.a), choose_between_boxes(&self.a, &self.b))
    }

    /// Returns the contact between an edge of each box.
    fn edge_contact(&self, edge: &SeparatingDirection<'g>) -> PointContact<'g> {
        let (c, one) = (self.center_offset(), self.size.num(1.0));
        let own = select_axis(&edge.first, &self.a.axes);
        let axis = select_axis(&edge.second, &self.b.axes);
        let across = own.cross(axis);
        let length = maximum(across.dot(across), one * PARALLEL).sqrt();
        let normal = across * (c.dot(across).apply_function(Function::Signum) / length);
        let (on_a, on_b) = (
            farthest_edge_center(&self.a, &edge.first, -normal),
            farthest_edge_center(&self.b, &edge.second, normal),
        );
        let reach =
            [select_one_of_three(&edge.first, self.a.half), select_one_of_three(&edge.second, self.b.half)];
        let offset = c + on_a - on_b;
        let (near, far) = closest_positions_on_segments(offset, (own, reach[0]), (axis, reach[1]));
        let separation = offset + own * near - axis * far;
        let excess = separation.norm() - absolute(edge.distance);
        PointContact {
            gap: edge.distance + excess,
            point: on_a + own * near - separation * (one * 0.5),
            axes: [("normal", normal), ("first", own), ("second", normal.cross(own))],
            conditions: Vec::new(),
        }
    }
}

/// A face of a box, with its normal and the directions of its sides.
pub(super) struct Face<'g> {
    /// Outward normal of the face, and directions of its sides.
    pub(super) axes: [Vec3<'g>; 3],
    /// Distance of the face from the centre of the box, and of the sides from the centre of the face.
    pub(super) half: [Expr<'g>; 3],
    /// Length scale of the two boxes, m.
    size: Expr<'g>,
}

impl<'g> Face<'g> {
    /// Returns the face of a box normal to the selected axis, on the side of `c`, a position relative to its
    /// centre.
    pub(super) fn face_on_side_of_position(
        holder: &OrientedBox<'g>,
        which: &[Expr<'g>; 3],
        c: Vec3<'g>,
        size: Expr<'g>,
    ) -> Self {
        let [next, last] = [next_axis_selector(which), next_axis_selector(&next_axis_selector(which))];
        let normal = select_axis(which, &holder.axes);
        let normal = normal * normal.dot(c).apply_function(Function::Signum);
        let sides = [&next, &last].map(|which| select_axis(which, &holder.axes));
        let half = [which, &next, &last].map(|which| select_one_of_three(which, holder.half));
        Face { axes: [normal, sides[0], sides[1]], half, size }
    }

    /// Returns the components of a vector along the normal and the sides.
    pub(super) fn components_along_face_axes(&self, v: Vec3<'g>) -> [Expr<'g>; 3] {
        self.axes.map(|axis| v.dot(axis))
    }

    /// Returns the range of `t` within −1 and 1 for which `start + t direction` is within the sides. If the
    /// range is empty, its end is less than its beginning.
    pub(super) fn clip_line_to_face_sides(
        &self,
        start: &[Expr<'g>; 3],
        direction: &[Expr<'g>; 3],
    ) -> [Expr<'g>; 2] {
        let one = self.size.num(1.0);
        let (mut from, mut to) = (-one, one);
        for k in [1, 2] {
            let slope = maximum(absolute(direction[k]), self.size * MIN_SLOPE);
            let inverse_slope = direction[k].apply_function(Function::Signum) / slope;
            let (center, reach) = (-(start[k] * inverse_slope), self.half[k] * (1.0 + TIE_TOLERANCE) / slope);
            (from, to) = (maximum(from, center - reach), minimum(to, center + reach));
        }
        [from, to]
    }

    /// Returns a contact midway between the face and a position relative to the centre of the box, at this
    /// distance from the face.
    fn contact_midway_to_face(&self, gap: Expr<'g>, place: Vec3<'g>, distance: Expr<'g>) -> PointContact<'g> {
        self.contact_at_position(gap, place - self.axes[0] * (distance * 0.5))
    }

    /// Returns a contact at a position relative to the centre of the box.
    pub(super) fn contact_at_position(&self, gap: Expr<'g>, place: Vec3<'g>) -> PointContact<'g> {
        let [normal, first, second] = self.axes;
        let axes = [("normal", normal), ("first", first), ("second", second)];
        PointContact { gap, point: place, axes, conditions: Vec::new() }
    }
}

/// Returns the contacts of the nearest face of `other` with the selected face of `holder`. Each edge of the
/// nearest face, clipped by the sides of the selected face, gives its end, and its beginning if that is cut
/// off. The corners of the selected face within the nearest face follow. Positions are relative to the origin
/// of the centres.
fn face_contacts<'g>(
    holder: &OrientedBox<'g>,
    other: &OrientedBox<'g>,
    which: &[Expr<'g>; 3],
    size: Expr<'g>,
) -> Vec<PointContact<'g>> {
    let one = size.num(1.0);
    let c = other.center - holder.center;
    let face = Face::face_on_side_of_position(holder, which, c, size);
    // The face of the other box that is opposite to this one.
    let cosines = other.axes.map(|axis| axis.dot(face.axes[0]));
    let [x, y, z] = cosines.map(absolute);
    let third = indicator_of_positive(z - maximum(x, y) - one * TIE_TOLERANCE);
    let second = indicator_of_positive(y - x - one * TIE_TOLERANCE) * (one - third);
    let facing = [one - second - third, second, third];
    let outward = select_one_of_three(&facing, cosines).apply_function(Function::Signum);
    let facing_axis = select_axis(&facing, &other.axes);
    let middle = c - facing_axis * (select_one_of_three(&facing, other.half) * outward);
    let side_axes = [next_axis_selector(&facing), next_axis_selector(&next_axis_selector(&facing))];
    let [h1, h2] = [0, 1].map(|k| select_one_of_three(&side_axes[k], other.half));
    let (d1, d2) =
        (select_axis(&side_axes[0], &other.axes) * h1, select_axis(&side_axes[1], &other.axes) * h2);
    let (f, e1, e2) = (
        face.components_along_face_axes(middle),
        face.components_along_face_axes(d1),
        face.components_along_face_axes(d2),
    );
    let [height, hu, hw] = face.half;
    let smallest = minimum(h1, h2);
    let mut points = Vec::new();
    // Around the face: each edge begins where the previous one ends.
    for (off, along, side, sense) in [
        ((d2, e2), (d1, e1), 1.0, -1.0),
        ((d1, e1), (d2, e2), -1.0, -1.0),
        ((d2, e2), (d1, e1), -1.0, 1.0),
        ((d1, e1), (d2, e2), 1.0, 1.0),
    ] {
        let start: [Expr<'g>; 3] = std::array::from_fn(|k| f[k] + off.1[k] * side);
        let direction = along.1.map(|x| x * sense);
        let [from, to] = face.clip_line_to_face_sides(&start, &direction);
        let outside = minimum((from - to) * smallest, size);
        let is_cut = indicator_of_positive(from + one * (1.0 - TIE_TOLERANCE));
        for (t, counts) in [(maximum(to, -one), one), (minimum(from, one), is_cut)] {
            let distance = start[0] + direction[0] * t - height;
            let place = middle + off.0 * (one * side) + along.0 * (t * sense);
            let gap = select_by_indicator(counts, maximum(distance, outside), size);
            points.push(face.contact_midway_to_face(gap, holder.center + place, distance));
        }
    }
    let determinant = e1[1] * e2[2] - e1[2] * e2[1];
    for (su, sw) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
        let (x, y) = (hu * su - f[1], hw * sw - f[2]);
        let first = (x * e2[2] - y * e2[1]) / determinant;
        let second = (e1[1] * y - e1[2] * x) / determinant;
        let outside = (maximum(absolute(first), absolute(second)) - one * (1.0 + TIE_TOLERANCE)) * smallest;
        let distance = f[0] + first * e1[0] + second * e2[0] - height;
        let place = holder.center + middle + d1 * first + d2 * second;
        points.push(face.contact_midway_to_face(maximum(distance, outside), place, distance));
    }
    points
}

/// Returns the contacts of the axis of a capsule with a box: where the axis is cut off by the sides of a
/// face, and where it crosses an edge. The axis extends from its centre by `reach` in both directions of
/// `own`. `c` leads from the centre of the box to that of the capsule; positions are relative to the latter.
/// The ends of the capsule are spheres and are not included.
pub(super) fn capsule_axis_contacts<'g>(
    radius: Expr<'g>,
    (own, reach): (Vec3<'g>, Expr<'g>),
    block: &OrientedBox<'g>,
    c: Vec3<'g>,
) -> Vec<PointContact<'g>> {
    let (zero, one) = (reach.zero(), reach.num(1.0));
    let size = block.half.into_iter().fold(reach + radius, |sum, half| sum + half);
    let cosines = block.axes.map(|axis| own.dot(axis));
    let center_offsets = block.axes.map(|axis| axis.dot(c));
    let selector_of_axis = |k: usize| std::array::from_fn(|i| if i == k { one } else { zero });
    let separation_along_axis =
        |k: usize| absolute(center_offsets[k]) - block.half[k] - reach * absolute(cosines[k]);
    let (mut face_distance, mut which) = (separation_along_axis(0), selector_of_axis(0));
    for k in [1, 2] {
        let better = indicator_of_positive(separation_along_axis(k) - face_distance - size * TIE_TOLERANCE);
        face_distance = select_by_indicator(better, separation_along_axis(k), face_distance);
        which = std::array::from_fn(|i| select_by_indicator(better, selector_of_axis(k)[i], which[i]));
    }
    let (mut edge_distance, mut edge) = (-size, [zero; 3]);
    for j in 0..3 {
        let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
        let square = cosines[j1] * cosines[j1] + cosines[j2] * cosines[j2];
        let sine = maximum(square, one * PARALLEL).sqrt();
        let along = absolute(center_offsets[j1] * cosines[j2] - center_offsets[j2] * cosines[j1]);
        let halves = block.half[j1] * absolute(cosines[j2]) + block.half[j2] * absolute(cosines[j1]);
        let found = (along - halves) / sine;
        let better = indicator_of_positive(found - edge_distance - size * TIE_TOLERANCE)
            * indicator_of_positive(square - one * PARALLEL);
        edge_distance = select_by_indicator(better, found, edge_distance);
        edge = std::array::from_fn(|i| select_by_indicator(better, selector_of_axis(j)[i], edge[i]));
    }
    let by_edges = indicator_of_positive(edge_distance - face_distance - size * TIE_TOLERANCE);
    let face = Face::face_on_side_of_position(block, &which, c, size);
    let (start, direction) =
        (face.components_along_face_axes(c), face.components_along_face_axes(own * reach));
    let [from, to] = face.clip_line_to_face_sides(&start, &direction);
    let outside = minimum((from - to) * reach, size);
    let mut points = Vec::new();
    for t in [minimum(from, one), maximum(to, -one)] {
        let gap = maximum(start[0] + direction[0] * t - face.half[0] - radius, outside);
        let gap = select_by_indicator(by_edges, maximum(gap, edge_distance - face_distance), gap);
        points.push(face.contact_at_position(gap, own * (reach * t) - face.axes[0] * radius));
    }
    let axis = select_axis(&edge, &block.axes);
    let across = own.cross(axis);
    let length = maximum(across.dot(across), one * PARALLEL).sqrt();
    let normal = across * (c.dot(across).apply_function(Function::Signum) / length);
    let middle = farthest_edge_center(block, &edge, normal);
    let (near, far) = closest_positions_on_segments(
        c - middle,
        (own, reach),
        (axis, select_one_of_three(&edge, block.half)),
    );
    // If an end of the axis or of the edge is nearest, it touches as a sphere or as a corner.
    let separation = c - middle + own * near - axis * far;
    let length = separation.norm();
    let gap = edge_distance + length - absolute(edge_distance) - radius;
    let towards =
        separation * (edge_distance.apply_function(Function::Signum) / maximum(length, size * TIE_TOLERANCE));
    let normal =
        select_vector_by_indicator(indicator_of_positive(length - size * TIE_TOLERANCE), towards, normal);
    points.push(PointContact {
        gap: select_by_indicator(by_edges, gap, maximum(gap, face_distance - edge_distance)),
        point: own * near - normal * radius,
        axes: [("normal", normal), ("first", own), ("second", normal.cross(own))],
        conditions: Vec::new(),
    });
    points
}

/// Returns the centre, relative to that of the box, of the edge along the selected axis that is farthest
/// along `n`.
fn farthest_edge_center<'g>(block: &OrientedBox<'g>, which: &[Expr<'g>; 3], n: Vec3<'g>) -> Vec3<'g> {
    let one = which[0].num(1.0);
    (0..3).fold(Vec3::zero(one.graph()), |sum, k| {
        let towards = block.axes[k].dot(n).apply_function(Function::Signum);
        sum + block.axes[k] * (block.half[k] * towards * (one - which[k]))
    })
}
