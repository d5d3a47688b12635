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

use super::surface::Form;
use super::unilateral::{nearest, within};
use super::{Contact, Pair, sphere_contact};
use crate::expr::{Expr, Extreme, Function, Vec3};
use crate::resolve::builder::Builder;

/// Amount by which the separation along a later direction must exceed that of an earlier one to replace it,
/// relative to the size of the boxes.
const SAME: f64 = 1e-9;
/// Squared sine of the angle below which edges are treated as parallel; faces then determine the contact.
const PARALLEL: f64 = 1e-10;
/// Generic direction that orders boxes of equal size by their positions. Boxes placed on purpose rarely have
/// equal components along it.
const LEANING: [f64; 3] = [0.2113, 0.3779, 0.9014];
/// Smallest slope of an edge against a side that is not treated as parallel to it.
const LEVEL: f64 = 1e-12;

/// A box: its axes, half its lengths along them, and its centre.
#[derive(Clone, Copy)]
struct Block<'g> {
    axes: [Vec3<'g>; 3],
    half: [Expr<'g>; 3],
    center: Vec3<'g>,
}

/// A candidate separating direction of two boxes.
#[derive(Clone, Copy)]
struct Apart<'g> {
    /// Separation of the boxes along the direction, negative if they overlap.
    distance: Expr<'g>,
    /// Selectors, one entry equal to one, of the axis of each box that defines the direction. For a face
    /// normal both are the face's axis.
    first: [Expr<'g>; 3],
    second: [Expr<'g>; 3],
}

/// Two boxes with the cosines between their axes.
struct Boxes<'g> {
    a: Block<'g>,
    b: Block<'g>,
    cosines: [[Expr<'g>; 3]; 3],
    size: Expr<'g>,
}

/// Returns one if `x` is positive, zero if it is negative.
fn is_positive(x: Expr<'_>) -> Expr<'_> {
    (x.call(Function::Signum) + x.num(1.0)) * 0.5
}

/// Returns `first` if `which` is one, `second` if it is zero.
fn either<'g>(which: Expr<'g>, first: Expr<'g>, second: Expr<'g>) -> Expr<'g> {
    first * which + second * (which.num(1.0) - which)
}

fn either_vector<'g>(which: Expr<'g>, first: Vec3<'g>, second: Vec3<'g>) -> Vec3<'g> {
    Vec3(std::array::from_fn(|k| either(which, first[k], second[k])))
}

fn absolute(x: Expr<'_>) -> Expr<'_> {
    x.call(Function::Abs)
}

fn larger<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    a.extreme(Extreme::Max, b)
}

fn smaller<'g>(a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
    a.extreme(Extreme::Min, b)
}

/// Returns the value that a selector of three selects.
fn chosen<'g>(which: &[Expr<'g>; 3], of: [Expr<'g>; 3]) -> Expr<'g> {
    of[0] * which[0] + of[1] * which[1] + of[2] * which[2]
}

fn chosen_vector<'g>(which: &[Expr<'g>; 3], of: &[Vec3<'g>; 3]) -> Vec3<'g> {
    of[0] * which[0] + of[1] * which[1] + of[2] * which[2]
}

/// Returns the selector of the cyclically next axis.
fn after<'g>(which: &[Expr<'g>; 3]) -> [Expr<'g>; 3] {
    let [a, b, c] = *which;
    [c, a, b]
}

/// Multiplies a selector by a factor.
fn times<'g>(which: [Expr<'g>; 3], factor: Expr<'g>) -> [Expr<'g>; 3] {
    which.map(|x| x * factor)
}

impl<'g> Builder<'_, 'g> {
    /// Returns the contacts of a sphere, a capsule or a box with a box whose centre is `c` away from theirs.
    pub(super) fn on_box(&self, pair: &Pair<'g>, lengths: &[Expr<'g>; 3], c: Vec3<'g>) -> Vec<Contact<'g>> {
        let g = self.scope.graph;
        let block = |lengths: &[Expr<'g>; 3], center, turned: &dyn Fn(Vec3<'g>) -> Vec3<'g>| Block {
            axes: std::array::from_fn(|k| turned(Vec3::axis(g, k))),
            half: lengths.map(|length| length * 0.5),
            center,
        };
        let (turned_a, turned_b) = (|v| self.of_first(pair, v).value, |v| self.of_second(pair, v).value);
        let on = block(lengths, Vec3::zero(g), &turned_b);
        let ball = |radius: Expr<'g>, place: Vec3<'g>| {
            let inner = (0..3)
                .fold(Vec3::zero(g), |sum, k| sum + on.axes[k] * within(on.axes[k].dot(place), on.half[k]));
            sphere_contact(radius, &Form::Sphere(g.zero()), place - inner, &turned_b)
        };
        match &pair.a.form {
            Form::Sphere(radius) => ball(*radius, c).into_iter().collect(),
            Form::Capsule(radius, length, axis) => {
                let (own, reach) = (turned_a(*axis), *length * 0.5);
                let end = |side: f64| {
                    let place = own * (reach * side);
                    ball(*radius, c + place).map(|touch| Contact { point: touch.point + place, ..touch })
                };
                let ends = [-1.0, 1.0].into_iter().filter_map(end);
                ends.chain(crossed(*radius, (own, reach), &on, c)).collect()
            }
            Form::Cuboid(own) => touches(&block(own, c, &turned_a), &on),
            _ => Vec::new(),
        }
    }
}

/// Returns the points where two boxes may touch, relative to the centre of the first box, which is at `c`
/// from that of the second. All directions are in the same axes.
fn touches<'g>(a: &Block<'g>, b: &Block<'g>) -> Vec<Contact<'g>> {
    let size = a.half.into_iter().chain(b.half).fold(a.half[0].zero(), |sum, half| sum + half);
    let cosines = a.axes.map(|own| b.axes.map(|other| own.dot(other)));
    let boxes = Boxes { a: *a, b: *b, cosines, size };
    let (face, of_second) = boxes.face();
    let edge = boxes.edges();
    let by_edges = is_positive(edge.distance - face.distance - size * SAME);
    let (holder, other) = boxes.roles(of_second);
    let mut points = faces(&holder, &other, &face.first, size);
    for point in &mut points {
        // The point belongs to both bodies; the normal points towards the first one.
        point.point -= a.center;
        let side = of_second * 2.0 - of_second.num(1.0);
        point.axes[0].1 = point.axes[0].1 * side;
        let other = larger(point.gap, edge.distance - face.distance);
        point.gap = either(by_edges, other, point.gap);
    }
    let crossing = boxes.crossing(&edge);
    let other = larger(crossing.gap, face.distance - edge.distance);
    points.push(Contact { gap: either(by_edges, crossing.gap, other), ..crossing });
    points
}

impl<'g> Boxes<'g> {
    fn away(&self) -> Vec3<'g> {
        self.a.center - self.b.center
    }

    /// Returns the face along whose normal the boxes have the largest separation, and one if it belongs to
    /// the second box (otherwise zero). Between equal separations, a face of the larger box is chosen; for
    /// boxes of equal size, of the lower one along a fixed direction. The order in which the boxes are
    /// written has no effect.
    fn face(&self) -> (Apart<'g>, Expr<'g>) {
        let (zero, one) = (self.size.zero(), self.size.num(1.0));
        let [first, second] = [false, true].map(|is_second| self.face_of(is_second));
        let sum = |block: &Block<'g>| block.half.into_iter().fold(zero, |sum, half| sum + half);
        let larger = sum(&self.a) - sum(&self.b);
        let same = one - is_positive(absolute(larger) - self.size * SAME);
        let c = self.away();
        let lower = -(c[0] * LEANING[0] + c[1] * LEANING[1] + c[2] * LEANING[2]);
        let leads = (either(same, lower, larger)).call(Function::Signum);
        let is_first = is_positive(first.distance - second.distance + leads * self.size * SAME);
        let which = std::array::from_fn(|k| either(is_first, first.first[k], second.first[k]));
        let distance = either(is_first, first.distance, second.distance);
        (Apart { distance, first: which, second: which }, one - is_first)
    }

    /// Returns the face of one box along whose normal the other is farthest from it.
    fn face_of(&self, is_second: bool) -> Apart<'g> {
        let (zero, one) = (self.size.zero(), self.size.num(1.0));
        let c = self.away();
        let (own, other) = if is_second { (&self.b, &self.a) } else { (&self.a, &self.b) };
        let distance = |k: usize| {
            let along: [Expr<'g>; 3] = std::array::from_fn(|i| match is_second {
                true => self.cosines[i][k],
                false => self.cosines[k][i],
            });
            let reach = (0..3).fold(zero, |sum, k| sum + other.half[k] * absolute(along[k]));
            absolute(own.axes[k].dot(c)) - own.half[k] - reach
        };
        let unit = |k: usize| std::array::from_fn(|i| if i == k { one } else { zero });
        let mut best = Apart { distance: distance(0), first: unit(0), second: unit(0) };
        for k in [1, 2] {
            let found = distance(k);
            let better = is_positive(found - best.distance - self.size * SAME);
            let which = std::array::from_fn(|i| either(better, unit(k)[i], best.first[i]));
            let distance = either(better, found, best.distance);
            best = Apart { distance, first: which, second: which };
        }
        best
    }

    /// Returns the pair of edges along whose common normal the boxes have the largest separation.
    fn edges(&self) -> Apart<'g> {
        let zero = self.size.zero();
        let c = self.away();
        let on_a = self.a.axes.map(|axis| axis.dot(c));
        let mut best = Apart { distance: -self.size, first: [zero; 3], second: [zero; 3] };
        for i in 0..3 {
            for j in 0..3 {
                let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
                let r = &self.cosines;
                let square = r[i1][j] * r[i1][j] + r[i2][j] * r[i2][j];
                let sine = larger(square, zero.num(PARALLEL)).sqrt();
                let along = absolute(on_a[i2] * r[i1][j] - on_a[i1] * r[i2][j]);
                let reach = self.a.half[i1] * absolute(r[i2][j])
                    + self.a.half[i2] * absolute(r[i1][j])
                    + self.b.half[j1] * absolute(r[i][j2])
                    + self.b.half[j2] * absolute(r[i][j1]);
                let distance = (along - reach) / sine;
                let better = is_positive(distance - best.distance - self.size * SAME)
                    * is_positive(square - zero.num(PARALLEL));
                let other = better.num(1.0) - better;
                let keep = |known: [Expr<'g>; 3], k: usize| {
                    let mut which = times(known, other);
                    which[k] += better;
                    which
                };
                best = Apart {
                    distance: either(better, distance, best.distance),
                    first: keep(best.first, i),
                    second: keep(best.second, j),
                };
            }
        }
        best
    }

    /// Returns the box that has the determining face, and the other box.
    fn roles(&self, of_second: Expr<'g>) -> (Block<'g>, Block<'g>) {
        let mixed = |first: &Block<'g>, second: &Block<'g>| Block {
            axes: std::array::from_fn(|k| either_vector(of_second, first.axes[k], second.axes[k])),
            half: std::array::from_fn(|k| either(of_second, first.half[k], second.half[k])),
            center: either_vector(of_second, first.center, second.center),
        };
        (mixed(&self.b, &self.a), mixed(&self.a, &self.b))
    }

    /// Returns the contact of two edges.
    fn crossing(&self, edge: &Apart<'g>) -> Contact<'g> {
        let (c, one) = (self.away(), self.size.num(1.0));
        let own = chosen_vector(&edge.first, &self.a.axes);
        let axis = chosen_vector(&edge.second, &self.b.axes);
        let across = own.cross(axis);
        let length = larger(across.dot(across), one * PARALLEL).sqrt();
        let normal = across * (c.dot(across).call(Function::Signum) / length);
        let (on_a, on_b) =
            (edge_middle(&self.a, &edge.first, -normal), edge_middle(&self.b, &edge.second, normal));
        let reach = [chosen(&edge.first, self.a.half), chosen(&edge.second, self.b.half)];
        let between = c + on_a - on_b;
        let (near, far) = nearest(between, (own, reach[0]), (axis, reach[1]));
        let apart = between + own * near - axis * far;
        let left = apart.norm() - absolute(edge.distance);
        Contact {
            gap: edge.distance + left,
            point: on_a + own * near - apart * (one * 0.5),
            axes: [("normal", normal), ("first", own), ("second", normal.cross(own))],
            conditions: Vec::new(),
        }
    }
}

/// A face of a box, with its normal and the directions of its sides.
struct Face<'g> {
    /// Outward normal, and directions of the sides.
    axes: [Vec3<'g>; 3],
    /// Distance of the face from the centre of the box, and of the sides from the centre of the face.
    half: [Expr<'g>; 3],
    /// Size of the boxes.
    size: Expr<'g>,
}

impl<'g> Face<'g> {
    /// Returns the face of a box normal to the selected axis, on the side of `c`, a position relative to its
    /// centre.
    fn of(holder: &Block<'g>, which: &[Expr<'g>; 3], c: Vec3<'g>, size: Expr<'g>) -> Self {
        let [next, last] = [after(which), after(&after(which))];
        let normal = chosen_vector(which, &holder.axes);
        let normal = normal * normal.dot(c).call(Function::Signum);
        let sides = [&next, &last].map(|which| chosen_vector(which, &holder.axes));
        let half = [which, &next, &last].map(|which| chosen(which, holder.half));
        Face { axes: [normal, sides[0], sides[1]], half, size }
    }

    /// Returns the components of a vector along the normal and the sides.
    fn seen(&self, v: Vec3<'g>) -> [Expr<'g>; 3] {
        self.axes.map(|axis| v.dot(axis))
    }

    /// Returns the range of `t` within −1 and 1 for which `start + t direction` is within the sides. If the
    /// range is empty, its end is less than its beginning.
    fn clipped(&self, start: &[Expr<'g>; 3], direction: &[Expr<'g>; 3]) -> [Expr<'g>; 2] {
        let one = self.size.num(1.0);
        let (mut from, mut to) = (-one, one);
        for k in [1, 2] {
            let slope = larger(absolute(direction[k]), self.size * LEVEL);
            let turned = direction[k].call(Function::Signum) / slope;
            let (center, reach) = (-(start[k] * turned), self.half[k] * (1.0 + SAME) / slope);
            (from, to) = (larger(from, center - reach), smaller(to, center + reach));
        }
        [from, to]
    }

    /// Returns a contact midway between a position relative to the centre of the box and the face; `over` is
    /// the distance between them.
    fn between(&self, gap: Expr<'g>, place: Vec3<'g>, over: Expr<'g>) -> Contact<'g> {
        self.contact(gap, place - self.axes[0] * (over * 0.5))
    }

    /// Returns a contact at a position relative to the centre of the box.
    fn contact(&self, gap: Expr<'g>, place: Vec3<'g>) -> Contact<'g> {
        let [normal, first, second] = self.axes;
        let axes = [("normal", normal), ("first", first), ("second", second)];
        Contact { gap, point: place, axes, conditions: Vec::new() }
    }
}

/// Returns the contacts of the nearest face of `other` with the selected face of `holder`. Each edge of the
/// nearest face, clipped by the sides of the selected face, gives its end, and its beginning if that is cut
/// off. The corners of the selected face within the nearest face follow. Positions are relative to the origin
/// of the centres.
fn faces<'g>(
    holder: &Block<'g>,
    other: &Block<'g>,
    which: &[Expr<'g>; 3],
    size: Expr<'g>,
) -> Vec<Contact<'g>> {
    let one = size.num(1.0);
    let c = other.center - holder.center;
    let face = Face::of(holder, which, c, size);
    // The face of the other box that is opposite to this one.
    let cosines = other.axes.map(|axis| axis.dot(face.axes[0]));
    let [x, y, z] = cosines.map(absolute);
    let third = is_positive(z - larger(x, y) - one * SAME);
    let second = is_positive(y - x - one * SAME) * (one - third);
    let facing = [one - second - third, second, third];
    let outward = chosen(&facing, cosines).call(Function::Signum);
    let facing_axis = chosen_vector(&facing, &other.axes);
    let middle = c - facing_axis * (chosen(&facing, other.half) * outward);
    let beside = [after(&facing), after(&after(&facing))];
    let [h1, h2] = [0, 1].map(|k| chosen(&beside[k], other.half));
    let (d1, d2) = (chosen_vector(&beside[0], &other.axes) * h1, chosen_vector(&beside[1], &other.axes) * h2);
    let (f, e1, e2) = (face.seen(middle), face.seen(d1), face.seen(d2));
    let [height, hu, hw] = face.half;
    let smallest = smaller(h1, h2);
    let mut points = Vec::new();
    // Around the face: each edge begins where the previous one ends.
    for (off, along, side, way) in [
        ((d2, e2), (d1, e1), 1.0, -1.0),
        ((d1, e1), (d2, e2), -1.0, -1.0),
        ((d2, e2), (d1, e1), -1.0, 1.0),
        ((d1, e1), (d2, e2), 1.0, 1.0),
    ] {
        let start: [Expr<'g>; 3] = std::array::from_fn(|k| f[k] + off.1[k] * side);
        let direction = along.1.map(|x| x * way);
        let [from, to] = face.clipped(&start, &direction);
        let outside = smaller((from - to) * smallest, size);
        let is_cut = is_positive(from + one * (1.0 - SAME));
        for (t, counts) in [(larger(to, -one), one), (smaller(from, one), is_cut)] {
            let over = start[0] + direction[0] * t - height;
            let place = middle + off.0 * (one * side) + along.0 * (t * way);
            let gap = either(counts, larger(over, outside), size);
            points.push(face.between(gap, holder.center + place, over));
        }
    }
    let determinant = e1[1] * e2[2] - e1[2] * e2[1];
    for (su, sw) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
        let (x, y) = (hu * su - f[1], hw * sw - f[2]);
        let first = (x * e2[2] - y * e2[1]) / determinant;
        let second = (e1[1] * y - e1[2] * x) / determinant;
        let outside = (larger(absolute(first), absolute(second)) - one * (1.0 + SAME)) * smallest;
        let over = f[0] + first * e1[0] + second * e2[0] - height;
        let place = holder.center + middle + d1 * first + d2 * second;
        points.push(face.between(larger(over, outside), place, over));
    }
    points
}

/// Returns the contacts of the axis of a capsule with a box: where the axis is cut off by the sides of a
/// face, and where it crosses an edge. The axis extends from its centre by `reach` in both directions of
/// `own`. `c` leads from the centre of the box to that of the capsule; positions are relative to the latter.
/// The ends of the capsule are spheres and are not included.
fn crossed<'g>(
    radius: Expr<'g>,
    (own, reach): (Vec3<'g>, Expr<'g>),
    block: &Block<'g>,
    c: Vec3<'g>,
) -> Vec<Contact<'g>> {
    let (zero, one) = (reach.zero(), reach.num(1.0));
    let size = block.half.into_iter().fold(reach + radius, |sum, half| sum + half);
    let cosines = block.axes.map(|axis| own.dot(axis));
    let away = block.axes.map(|axis| axis.dot(c));
    let unit = |k: usize| std::array::from_fn(|i| if i == k { one } else { zero });
    let distance = |k: usize| absolute(away[k]) - block.half[k] - reach * absolute(cosines[k]);
    let (mut face_distance, mut which) = (distance(0), unit(0));
    for k in [1, 2] {
        let better = is_positive(distance(k) - face_distance - size * SAME);
        face_distance = either(better, distance(k), face_distance);
        which = std::array::from_fn(|i| either(better, unit(k)[i], which[i]));
    }
    let (mut edge_distance, mut edge) = (-size, [zero; 3]);
    for j in 0..3 {
        let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
        let square = cosines[j1] * cosines[j1] + cosines[j2] * cosines[j2];
        let sine = larger(square, one * PARALLEL).sqrt();
        let along = absolute(away[j1] * cosines[j2] - away[j2] * cosines[j1]);
        let halves = block.half[j1] * absolute(cosines[j2]) + block.half[j2] * absolute(cosines[j1]);
        let found = (along - halves) / sine;
        let better = is_positive(found - edge_distance - size * SAME) * is_positive(square - one * PARALLEL);
        edge_distance = either(better, found, edge_distance);
        edge = std::array::from_fn(|i| either(better, unit(j)[i], edge[i]));
    }
    let by_edges = is_positive(edge_distance - face_distance - size * SAME);
    let face = Face::of(block, &which, c, size);
    let (start, direction) = (face.seen(c), face.seen(own * reach));
    let [from, to] = face.clipped(&start, &direction);
    let outside = smaller((from - to) * reach, size);
    let mut points = Vec::new();
    for t in [smaller(from, one), larger(to, -one)] {
        let gap = larger(start[0] + direction[0] * t - face.half[0] - radius, outside);
        let gap = either(by_edges, larger(gap, edge_distance - face_distance), gap);
        points.push(face.contact(gap, own * (reach * t) - face.axes[0] * radius));
    }
    let axis = chosen_vector(&edge, &block.axes);
    let across = own.cross(axis);
    let length = larger(across.dot(across), one * PARALLEL).sqrt();
    let normal = across * (c.dot(across).call(Function::Signum) / length);
    let middle = edge_middle(block, &edge, normal);
    let (near, far) = nearest(c - middle, (own, reach), (axis, chosen(&edge, block.half)));
    // If an end of the axis is nearest, it touches as a sphere.
    let left = (c - middle + own * near - axis * far).norm() - absolute(edge_distance);
    let gap = edge_distance + left - radius;
    points.push(Contact {
        gap: either(by_edges, gap, larger(gap, face_distance - edge_distance)),
        point: own * near - normal * radius,
        axes: [("normal", normal), ("first", own), ("second", normal.cross(own))],
        conditions: Vec::new(),
    });
    points
}

/// Returns the centre, relative to that of the box, of the edge along the selected axis that is farthest
/// along `n`.
fn edge_middle<'g>(block: &Block<'g>, which: &[Expr<'g>; 3], n: Vec3<'g>) -> Vec3<'g> {
    let one = which[0].num(1.0);
    (0..3).fold(Vec3::zero(one.graph()), |sum, k| {
        let towards = block.axes[k].dot(n).call(Function::Signum);
        sum + block.axes[k] * (block.half[k] * towards * (one - which[k]))
    })
}
