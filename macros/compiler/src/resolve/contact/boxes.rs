//! Where two boxes touch.
//!
//! Two boxes are apart if a plane is between them whose normal is that of a face of either, or is normal to
//! an edge of each (Gottschalk, Lin and Manocha, *OBBTree*, 1996). The one of these fifteen directions along
//! which they are farthest apart, or overlap least, says what touches. If it is a face's normal, what lies
//! before that face is the opposite face of the other box, clipped by the sides of the first: its edges
//! within these sides, by their ends, and the corners of the first within the other. If it is normal to two
//! edges, these touch where they are nearest to each other.
//!
//! A capsule on a box is such a line with a radius; its ends are spheres.
//!
//! Points that are not of what touches are apart by how much farther the boxes are apart along the direction
//! that says so. A point that two edges of a face have in common counts once; the other has the size of the
//! boxes for its distance.

use super::surface::Form;
use super::unilateral::{nearest, within};
use super::{Contact, Pair, sphere_contact};
use crate::expr::{Expr, Extreme, Function, Vec3};
use crate::resolve::builder::Builder;

/// How much farther apart along a direction later ones have to be for it to give way, by the size of the
/// boxes.
const SAME: f64 = 1e-9;
/// Square of the sine of an angle between edges that are parallel: faces say where such boxes touch.
const PARALLEL: f64 = 1e-10;
/// A direction in which two boxes of one size differ, wherever they are placed on purpose.
const LEANING: [f64; 3] = [0.2113, 0.3779, 0.9014];
/// Slope of an edge against a side that is none.
const LEVEL: f64 = 1e-12;

/// A box: its axes, half of its lengths along them, and its centre.
#[derive(Clone, Copy)]
struct Block<'g> {
    axes: [Vec3<'g>; 3],
    half: [Expr<'g>; 3],
    center: Vec3<'g>,
}

/// A direction between two boxes.
#[derive(Clone, Copy)]
struct Apart<'g> {
    /// How far they are apart along it.
    distance: Expr<'g>,
    /// Which axis of each it comes from: ones and zeros. Of a face's normal the first.
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

/// One where `x` is positive, else zero.
fn is_positive(x: Expr<'_>) -> Expr<'_> {
    (x.call(Function::Signum) + x.num(1.0)) * 0.5
}

/// The first where `which` is one, the second where it is zero.
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

/// What of three is chosen.
fn chosen<'g>(which: &[Expr<'g>; 3], of: [Expr<'g>; 3]) -> Expr<'g> {
    of[0] * which[0] + of[1] * which[1] + of[2] * which[2]
}

fn chosen_vector<'g>(which: &[Expr<'g>; 3], of: &[Vec3<'g>; 3]) -> Vec3<'g> {
    of[0] * which[0] + of[1] * which[1] + of[2] * which[2]
}

/// What comes after the one that is chosen, in a circle.
fn after<'g>(which: &[Expr<'g>; 3]) -> [Expr<'g>; 3] {
    let [a, b, c] = *which;
    [c, a, b]
}

/// All three times the same.
fn times<'g>(which: [Expr<'g>; 3], factor: Expr<'g>) -> [Expr<'g>; 3] {
    which.map(|x| x * factor)
}

impl<'g> Builder<'_, 'g> {
    /// Where a sphere, a capsule or a box touches a box.
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

/// The points where two boxes may touch, from the centre of the first, which is `c` from that of the second;
/// all directions in the same axes.
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
        // Both bodies have the point; the normal is towards the first one.
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

    /// The face along whose normal they are farthest apart, and whether it is one of the second box. Of faces
    /// that say the same it is that of the larger box, and of boxes of one size that of the lower one along
    /// some direction: which one was named first decides nothing.
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

    /// The face of one of them along whose normal the other is farthest from it.
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

    /// The pair of edges along whose common normal they are farthest apart.
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

    /// The box whose face it is, and the other one.
    fn roles(&self, of_second: Expr<'g>) -> (Block<'g>, Block<'g>) {
        let mixed = |first: &Block<'g>, second: &Block<'g>| Block {
            axes: std::array::from_fn(|k| either_vector(of_second, first.axes[k], second.axes[k])),
            half: std::array::from_fn(|k| either(of_second, first.half[k], second.half[k])),
            center: either_vector(of_second, first.center, second.center),
        };
        (mixed(&self.b, &self.a), mixed(&self.a, &self.b))
    }

    /// Where two edges touch.
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

/// A face of a box, in the directions of its normal and of its sides.
struct Face<'g> {
    /// Normal, and directions of the sides.
    axes: [Vec3<'g>; 3],
    /// Distance of the face from the centre, and of its sides from its middle.
    half: [Expr<'g>; 3],
    /// The size of the boxes.
    size: Expr<'g>,
}

impl<'g> Face<'g> {
    /// The face of a box across the axis `which` that is on the side of `c`, a place from its centre.
    fn of(holder: &Block<'g>, which: &[Expr<'g>; 3], c: Vec3<'g>, size: Expr<'g>) -> Self {
        let [next, last] = [after(which), after(&after(which))];
        let normal = chosen_vector(which, &holder.axes);
        let normal = normal * normal.dot(c).call(Function::Signum);
        let sides = [&next, &last].map(|which| chosen_vector(which, &holder.axes));
        let half = [which, &next, &last].map(|which| chosen(which, holder.half));
        Face { axes: [normal, sides[0], sides[1]], half, size }
    }

    /// The components of a vector.
    fn seen(&self, v: Vec3<'g>) -> [Expr<'g>; 3] {
        self.axes.map(|axis| v.dot(axis))
    }

    /// From where to where of `start + t direction`, with `t` from −1 to 1, is within the sides; the second
    /// is less than the first where nothing is.
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

    /// A contact in the middle between a place from the centre of the box and the face, which are `over`
    /// apart.
    fn between(&self, gap: Expr<'g>, place: Vec3<'g>, over: Expr<'g>) -> Contact<'g> {
        self.contact(gap, place - self.axes[0] * (over * 0.5))
    }

    /// A contact at a place from the centre of the box.
    fn contact(&self, gap: Expr<'g>, place: Vec3<'g>) -> Contact<'g> {
        let [normal, first, second] = self.axes;
        let axes = [("normal", normal), ("first", first), ("second", second)];
        Contact { gap, point: place, axes, conditions: Vec::new() }
    }
}

/// What of a box lies before the face of another across its axis `which`: of each edge of its nearest face,
/// within the sides of that one, the end, and the beginning if it is cut off there; and the corners of the
/// face before it. Places are from where the centres are given.
fn faces<'g>(
    holder: &Block<'g>,
    other: &Block<'g>,
    which: &[Expr<'g>; 3],
    size: Expr<'g>,
) -> Vec<Contact<'g>> {
    let one = size.num(1.0);
    let c = other.center - holder.center;
    let face = Face::of(holder, which, c, size);
    // The face of the other box that looks at this one.
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
    // Around the face, each from where the one before ends.
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

/// The points where the straight line in the middle of a capsule, which leads from its centre by `reach` both
/// ways along `own`, lies across a box: where it is cut off by the sides of a face, and where it crosses an
/// edge. `c` leads from the centre of the box to that of the capsule, and places are from there. Its ends are
/// spheres, and touch as such.
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
    // Where an end is nearest, it touches as a sphere.
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

/// The middle of the edge along the axis `which` of a box that is farthest along `n`, from its centre.
fn edge_middle<'g>(block: &Block<'g>, which: &[Expr<'g>; 3], n: Vec3<'g>) -> Vec3<'g> {
    let one = which[0].num(1.0);
    (0..3).fold(Vec3::zero(one.graph()), |sum, k| {
        let towards = block.axes[k].dot(n).call(Function::Signum);
        sum + block.axes[k] * (block.half[k] * towards * (one - which[k]))
    })
}
