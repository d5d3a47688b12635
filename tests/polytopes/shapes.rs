//! Points of hulls, random numbers, and distances of convex hulls by enumeration.

use linkwork::nalgebra::{Matrix3, UnitQuaternion, Vector3};

pub type Point = Vector3<f64>;

/// Vertices of an irregular hull with seven vertices.
pub const STONE: [[f64; 3]; 7] = [
    [0.11, 0.02, -0.03],
    [-0.07, 0.09, 0.01],
    [-0.08, -0.06, -0.05],
    [0.03, -0.1, 0.02],
    [0.01, 0.03, 0.12],
    [0.02, 0.07, -0.09],
    [0.06, -0.03, 0.08],
];

/// Vertices of an icosahedron.
pub const GEM: [[f64; 3]; 12] = [
    [0.0, 0.05, 0.08],
    [0.0, 0.05, -0.08],
    [0.0, -0.05, 0.08],
    [0.0, -0.05, -0.08],
    [0.05, 0.08, 0.0],
    [0.05, -0.08, 0.0],
    [-0.05, 0.08, 0.0],
    [-0.05, -0.08, 0.0],
    [0.08, 0.0, 0.05],
    [0.08, 0.0, -0.05],
    [-0.08, 0.0, 0.05],
    [-0.08, 0.0, -0.05],
];

/// Vertices of a triangular prism.
pub const WEDGE: [[f64; 3]; 6] = [
    [0.1, 0.08, -0.04],
    [0.1, -0.08, -0.04],
    [-0.1, 0.08, -0.04],
    [-0.1, -0.08, -0.04],
    [0.0, 0.08, 0.08],
    [0.0, -0.08, 0.08],
];

/// Linear congruential generator.
pub struct Random(pub u64);

impl Random {
    /// Returns a number between −1 and 1.
    pub fn next_random_number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }

    pub fn random_point(&mut self) -> Point {
        Point::new(self.next_random_number(), self.next_random_number(), self.next_random_number())
    }

    pub fn random_rotation(&mut self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.random_point() * 3.0)
    }
}

/// Returns points in the pose of their body.
pub fn points_in_pose(points: &[[f64; 3]], turn: &UnitQuaternion<f64>, place: Point) -> Vec<Point> {
    points.iter().map(|p| turn * Point::from(*p) + place).collect()
}

/// Returns the corners of a box.
pub fn box_corners(lengths: [f64; 3]) -> Vec<[f64; 3]> {
    let corner =
        |k: usize| core::array::from_fn(|axis| lengths[axis] * if k >> axis & 1 == 0 { -0.5 } else { 0.5 });
    (0..8).map(corner).collect()
}

/// Returns the signed distance of the convex hulls of two sets of points: the distance of their nearest
/// simplices, or the negative of the shortest translation that separates them.
pub fn signed_distance(a: &[Point], b: &[Point]) -> f64 {
    let separation = largest_separation(a, b);
    if separation <= 0.0 { separation } else { least_distance(a, b) }
}

fn point_pairs(points: &[Point]) -> Vec<[Point; 2]> {
    let ends = (0..points.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    ends.map(|(i, j)| [points[i], points[j]]).collect()
}

fn point_triples(points: &[Point]) -> Vec<[Point; 3]> {
    let ends = (0..points.len()).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k))));
    ends.map(|(i, j, k)| [points[i], points[j], points[k]]).collect()
}

/// Returns the largest separation along the normals of all planes through three points of a set, and along
/// the common normals of all lines through two points of each. A facet of the Minkowski difference of two
/// hulls has one of these normals.
fn largest_separation(a: &[Point], b: &[Point]) -> f64 {
    let normals =
        point_triples(a).into_iter().chain(point_triples(b)).map(|[p, q, r]| (q - p).cross(&(r - p)));
    let line_directions =
        |points: &[Point]| point_pairs(points).into_iter().map(|[p, q]| q - p).collect::<Vec<_>>();
    let (own, other) = (line_directions(a), line_directions(b));
    let common = own.iter().flat_map(|x| other.iter().map(move |y| x.cross(y)));
    let all = normals.chain(common).filter(|n| n.norm() > 1e-9).map(|n| n.normalize());
    let separation = |n: Point| {
        let projection_bound = |points: &[Point], f: fn(f64, f64) -> f64, from: f64| {
            points.iter().map(|p| n.dot(p)).fold(from, f)
        };
        let (low, high) =
            (projection_bound(b, f64::min, f64::INFINITY), projection_bound(a, f64::max, f64::NEG_INFINITY));
        let (other_low, other_high) =
            (projection_bound(a, f64::min, f64::INFINITY), projection_bound(b, f64::max, f64::NEG_INFINITY));
        (low - high).max(other_low - other_high)
    };
    all.map(separation).fold(f64::NEG_INFINITY, f64::max)
}

/// Returns the least distance of a point of one set from a triangle of the other, or of two lines between
/// points of each set.
fn least_distance(a: &[Point], b: &[Point]) -> f64 {
    let least_height_above_triangles = |points: &[Point], others: &[Point]| {
        let all = point_triples(points).into_iter().flat_map(|t| others.iter().map(move |p| (t, *p)));
        all.filter_map(|(t, p)| height_above_triangle(p, t)).fold(f64::INFINITY, f64::min)
    };
    let lines =
        point_pairs(a).into_iter().flat_map(|own| point_pairs(b).into_iter().map(move |other| (own, other)));
    let of_lines = lines.map(|(own, other)| distance_of_segments(own, other)).fold(f64::INFINITY, f64::min);
    least_height_above_triangles(a, b).min(least_height_above_triangles(b, a)).min(of_lines)
}

/// Returns the distance of a point from the plane of a triangle, if its foot is within the triangle.
fn height_above_triangle(p: Point, [a, b, c]: [Point; 3]) -> Option<f64> {
    let n = (b - a).cross(&(c - a));
    let at = Matrix3::from_columns(&[b - a, c - a, n]).try_inverse()? * (p - a);
    (at[0] >= 0.0 && at[1] >= 0.0 && at[0] + at[1] <= 1.0).then(|| at[2].abs() * n.norm())
}

fn distance_of_segments([a, b]: [Point; 2], [c, d]: [Point; 2]) -> f64 {
    let distance_to_segment = |p: Point, a: Point, b: Point| {
        let t = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
        (p - a - (b - a) * t).norm()
    };
    let ends = distance_to_segment(a, c, d)
        .min(distance_to_segment(b, c, d))
        .min(distance_to_segment(c, a, b))
        .min(distance_to_segment(d, a, b));
    let n = (b - a).cross(&(d - c));
    let crossing = Matrix3::from_columns(&[b - a, c - d, n]).try_inverse().and_then(|inverse| {
        let at = inverse * (c - a);
        ((0.0..=1.0).contains(&at[0]) && (0.0..=1.0).contains(&at[1])).then(|| at[2].abs() * n.norm())
    });
    crossing.map_or(ends, |crossing| crossing.min(ends))
}
