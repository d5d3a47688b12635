//! Convex hulls of points in space: at most [`MAX_VERTICES`] of the points, with faces and edges.
//!
//! A hull grows by the point that is farthest outside of its faces (Barber, Dobkin and Huhdanpaa, *The
//! quickhull algorithm for convex hulls*, 1996), so that its first vertices matter most. Faces and edges are
//! found among all planes through three vertices: with few vertices this is fast, and independent of the
//! rounding errors that coplanar points cause in incremental algorithms.

/// Point in space.
pub type Point = [f64; 3];

/// Maximum number of vertices of a convex hull.
pub const MAX_VERTICES: usize = 32;

/// Distance below which a point is treated as part of a face, relative to the size of the hull.
const FLAT: f64 = 1e-6;

/// Distance below which vertices are treated as coplanar, relative to the size of the hull.
const COPLANAR: f64 = 1e-7;

/// Twice the area below which a triangle does not determine a plane, relative to the squared size.
const SLENDER: f64 = 1e-8;

/// Convex hull of points: vertices, faces and edges.
#[derive(Clone, Debug)]
pub struct Hull {
    /// Vertices of the hull, a subset of the given points.
    pub vertices: Vec<Point>,
    /// Planes of the faces of the hull.
    pub faces: Vec<HullFace>,
    /// Edges of the hull, as pairs of indices of vertices.
    pub edges: Vec<[usize; 2]>,
    /// Largest extent of the hull along a coordinate axis.
    pub size: f64,
    /// Maximum distance of a given point from the hull.
    pub error: f64,
}

/// Face of a convex hull, by its plane.
#[derive(Clone, Copy, Debug)]
pub struct HullFace {
    /// Outward unit normal of the face.
    pub normal: Point,
    /// Distance of the plane from the origin along the normal.
    pub offset: f64,
    /// Set of its vertices; bit `k` is set for vertex `k`.
    corners: u32,
}

/// Reason why a set of points has no convex hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HullError {
    /// A coordinate of a point is infinite or not a number.
    NotFinite,
    /// The number of distinct points is less than four.
    TooFew(usize),
    /// All points are in one plane.
    Coplanar,
}

impl HullFace {
    /// Returns the indices of the vertices of the face, in increasing order.
    pub fn corner_indices(&self) -> Vec<usize> {
        (0..MAX_VERTICES).filter(|k| self.corners >> k & 1 == 1).collect()
    }

    /// Returns the distance of a point from the plane, positive outside of the hull.
    fn distance_from_plane(&self, p: Point) -> f64 {
        dot(self.normal, p) - self.offset
    }
}

impl Hull {
    /// Returns the hull of points with at most `maximum` vertices, a number from 4 to [`MAX_VERTICES`].
    pub fn new(points: &[Point], maximum: usize) -> Result<Hull, HullError> {
        if points.iter().flatten().any(|x| !x.is_finite()) {
            return Err(HullError::NotFinite);
        }
        let mut outside = points.to_vec();
        outside.sort_by(|a, b| a.partial_cmp(b).unwrap_or(core::cmp::Ordering::Equal));
        outside.dedup();
        let size = largest_extent(&outside);
        let mut vertices = initial_tetrahedron_vertices(&outside, size)?;
        let maximum = maximum.clamp(4, MAX_VERTICES);
        // After superfluous vertices are removed, others may take their place.
        for _ in 0..3 {
            add_farthest_points(&mut vertices, &mut outside, maximum, size);
            let before = vertices.len();
            remove_vertices_within_hull(&mut vertices, size);
            if vertices.len() == before || outside.is_empty() {
                break;
            }
        }
        let faces = hull_faces(&vertices, size);
        let edges = hull_edges(&vertices, &faces);
        let mut hull = Hull { vertices, faces, edges, size, error: 0.0 };
        hull.error = outside.iter().map(|p| hull.signed_distance_of_point(*p)).fold(0.0, f64::max);
        Ok(hull)
    }

    /// Returns the distance of a point from the hull; negative inside.
    pub fn signed_distance_of_point(&self, p: Point) -> f64 {
        let Some((face, height)) = face_farthest_below_point(&self.faces, p) else { return f64::NAN };
        let foot = sub(p, face.normal.map(|x| x * height));
        if self.faces.iter().all(|face| face.distance_from_plane(foot) <= FLAT * self.size) {
            return height;
        }
        let distance_to_edge = |edge: &[usize; 2]| distance_from_segment(p, edge.map(|k| self.vertices[k]));
        self.edges.iter().map(distance_to_edge).fold(f64::INFINITY, f64::min)
    }
}

/// Returns the largest extent of a set of points along a coordinate axis.
fn largest_extent(points: &[Point]) -> f64 {
    let extent_along_axis = |k: usize| {
        let bound_of_coordinate =
            |f: fn(f64, f64) -> f64, from: f64| points.iter().map(|p| p[k]).fold(from, f);
        bound_of_coordinate(f64::max, f64::NEG_INFINITY) - bound_of_coordinate(f64::min, f64::INFINITY)
    };
    (0..3).map(extent_along_axis).fold(0.0, f64::max)
}

/// Returns four points that are not coplanar, each as far as possible from the hull of the previous ones.
fn initial_tetrahedron_vertices(points: &[Point], size: f64) -> Result<Vec<Point>, HullError> {
    let [a, _, _, _, ..] = points else { return Err(HullError::TooFew(points.len())) };
    let farthest_point = |distance: &dyn Fn(Point) -> f64| {
        let found = points.iter().copied().max_by(|p, q| distance(*p).total_cmp(&distance(*q)));
        found.filter(|p| distance(*p) > FLAT * size).ok_or(HullError::Coplanar)
    };
    let b = farthest_point(&|p| norm(sub(p, *a)))?;
    let along = sub(b, *a).map(|x| x / norm(sub(b, *a)));
    let c = farthest_point(&|p| norm(cross(along, sub(p, *a))))?;
    let normal = cross(along, sub(c, *a));
    let normal = normal.map(|x| x / norm(normal));
    let d = farthest_point(&|p| dot(normal, sub(p, *a)).abs())?;
    Ok(vec![*a, b, c, d])
}

/// Adds the points that are farthest outside, and removes points inside of the hull from `outside`.
fn add_farthest_points(vertices: &mut Vec<Point>, outside: &mut Vec<Point>, maximum: usize, size: f64) {
    loop {
        let faces = hull_faces(vertices, size);
        let height_above_hull =
            |p: &Point| face_farthest_below_point(&faces, *p).map_or(0.0, |(_, height)| height);
        let mut next: Option<(f64, Point)> = None;
        outside.retain(|p| {
            let height = height_above_hull(p);
            if height > FLAT * size && next.is_none_or(|(known, _)| height > known) {
                next = Some((height, *p));
            }
            height > FLAT * size
        });
        match next {
            Some((_, p)) if vertices.len() < maximum => vertices.push(p),
            _ => return,
        }
    }
}

/// Removes vertices that are within the hull of the others, as points on an edge or a face are.
fn remove_vertices_within_hull(vertices: &mut Vec<Point>, size: f64) {
    let mut k = 0;
    while k < vertices.len() && vertices.len() > 4 {
        let p = vertices.remove(k);
        let faces = hull_faces(vertices, size);
        // Coplanar vertices have no faces or faces on both sides.
        let is_inside =
            faces.len() > 3 && faces.iter().all(|face| face.distance_from_plane(p) <= FLAT * size);
        if !is_inside {
            vertices.insert(k, p);
            k += 1;
        }
    }
}

/// Returns the planes through three vertices or more that have no vertex outside of them.
fn hull_faces(vertices: &[Point], size: f64) -> Vec<HullFace> {
    let tolerance = COPLANAR * size;
    let mut found: Vec<HullFace> = Vec::new();
    for (i, a) in vertices.iter().enumerate() {
        for (j, b) in vertices.iter().enumerate().skip(i + 1) {
            for (k, c) in vertices.iter().enumerate().skip(j + 1) {
                let three = 1_u32 << i | 1 << j | 1 << k;
                let across = cross(sub(*b, *a), sub(*c, *a));
                let length = norm(across);
                let is_known = found.iter().any(|face| face.corners & three == three);
                if is_known || length <= SLENDER * size * size {
                    continue;
                }
                let normal = across.map(|x| x / length);
                found.extend([normal, normal.map(|x| -x)].into_iter().find_map(|normal| {
                    let mut face = HullFace { normal, offset: dot(normal, *a), corners: 0 };
                    for (k, p) in vertices.iter().enumerate() {
                        match face.distance_from_plane(*p) {
                            height if height > tolerance => return None,
                            height if height >= -tolerance => face.corners |= 1 << k,
                            _ => {}
                        }
                    }
                    Some(face)
                }));
            }
        }
    }
    found
}

/// Returns the edges between pairs of faces: the two common vertices that are farthest apart.
fn hull_edges(vertices: &[Point], faces: &[HullFace]) -> Vec<[usize; 2]> {
    let mut found: Vec<[usize; 2]> = Vec::new();
    for (k, face) in faces.iter().enumerate() {
        for other in &faces[k + 1..] {
            let both = face.corners & other.corners;
            let shared: Vec<usize> = (0..vertices.len()).filter(|k| both >> k & 1 == 1).collect();
            let pairs = shared.iter().flat_map(|i| shared.iter().map(move |j| [*i, *j]));
            let edge_length = |[i, j]: &[usize; 2]| norm(sub(vertices[*i], vertices[*j]));
            let longest =
                pairs.filter(|[i, j]| i < j).max_by(|a, b| edge_length(a).total_cmp(&edge_length(b)));
            found.extend(longest.filter(|edge| !found.contains(edge)));
        }
    }
    found
}

/// Returns the face whose plane is farthest below a point, with the height of the point above it.
fn face_farthest_below_point(faces: &[HullFace], p: Point) -> Option<(HullFace, f64)> {
    let heights = faces.iter().map(|face| (*face, face.distance_from_plane(p)));
    heights.max_by(|(_, a), (_, b)| a.total_cmp(b))
}

fn distance_from_segment(p: Point, [a, b]: [Point; 2]) -> f64 {
    let (along, offset) = (sub(b, a), sub(p, a));
    let t = (dot(offset, along) / dot(along, along)).clamp(0.0, 1.0);
    norm(sub(offset, along.map(|x| x * t)))
}

fn sub(a: Point, b: Point) -> Point {
    core::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn norm(a: Point) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the points of a grid in a box with these edges, with `n` points along each.
    fn box_grid_points(edges: Point, n: usize) -> Vec<Point> {
        let grid_coordinate = |k: usize, edge: f64| edge * (k as f64 / (n - 1) as f64 - 0.5);
        (0..n * n * n)
            .map(|k| {
                [
                    grid_coordinate(k % n, edges[0]),
                    grid_coordinate(k / n % n, edges[1]),
                    grid_coordinate(k / n / n, edges[2]),
                ]
            })
            .collect()
    }

    /// Returns points on a sphere of radius one, evenly distributed.
    fn sphere_points(count: usize) -> Vec<Point> {
        let spiral_point = |k: usize| {
            let z = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
            let (sine, cosine) = (k as f64 * 2.399_963_229_728_653).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            [radius * cosine, radius * sine, z]
        };
        (0..count).map(spiral_point).collect()
    }

    #[test]
    fn hull_of_a_grid_is_its_box() {
        for (edges, n) in [([2.0, 3.0, 4.0], 5), ([0.1, 0.1, 0.1], 2), ([1e-3, 1.0, 2.0], 4)] {
            let hull = Hull::new(&box_grid_points(edges, n), 32).expect("a hull");
            assert_eq!((hull.vertices.len(), hull.faces.len(), hull.edges.len()), (8, 6, 12), "{hull:?}");
            assert!(hull.error < 1e-6 * hull.size);
            let corner = edges.map(|x| x / 2.0);
            for (out, distance) in
                [([1.0, 0.0, 0.0], 1.0), ([1.0, 1.0, 0.0], 2_f64.sqrt()), ([1.0; 3], 3_f64.sqrt())]
            {
                let p = core::array::from_fn(|k| if out[k] > 0.0 { corner[k] + 1.0 } else { 0.0 });
                assert!((hull.signed_distance_of_point(p) - distance).abs() < 1e-12, "{p:?}");
            }
            let depth = edges.iter().copied().fold(f64::INFINITY, f64::min) / 2.0;
            assert!((hull.signed_distance_of_point([0.0; 3]) + depth).abs() < 1e-12);
        }
    }

    #[test]
    fn reduced_hulls_report_their_error() {
        let points = sphere_points(2000);
        for (count, largest) in [(12, 0.42), (32, 0.13)] {
            let hull = Hull::new(&points, count).expect("a hull");
            assert_eq!(hull.vertices.len(), count);
            assert!(hull.error < largest, "{}", hull.error);
            // Every point of the sphere is within the stated distance, and some point is at this distance.
            let worst = points.iter().map(|p| hull.signed_distance_of_point(*p)).fold(0.0, f64::max);
            assert!((hull.error - worst).abs() < 1e-12, "{} {worst}", hull.error);
            // Euler's formula for a polyhedron of triangles.
            assert_eq!((hull.faces.len(), hull.edges.len()), (2 * count - 4, 3 * count - 6));
        }
    }

    #[test]
    fn degenerate_points_have_no_hull() {
        let flat = box_grid_points([1.0, 1.0, 0.0], 3);
        for (points, expected) in [
            (&[[0.0; 3]; 5][..], HullError::TooFew(1)),
            (&[[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]], HullError::Coplanar),
            (&flat, HullError::Coplanar),
            (&[[f64::NAN; 3]; 4], HullError::NotFinite),
        ] {
            assert_eq!(Hull::new(points, 32).err(), Some(expected));
        }
    }
}
