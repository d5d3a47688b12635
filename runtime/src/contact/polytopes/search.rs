//! Search for the direction with the largest separation of two convex bodies.
//!
//! The distance of separated bodies is found by the algorithm of Gilbert, Johnson and Keerthi (*A fast
//! procedure for computing the distance between complex objects in three-dimensional space*, IEEE Journal of
//! Robotics and Automation 4, 1988). Bodies that overlap are moved apart along a direction first. The
//! direction of their closest points has at least the same separation (a proximal point method); repetitions
//! lead to a maximum.

use super::{PlacedPolytope, constant};
use crate::Real;
use nalgebra::Vector3;

/// Displacement that moves bodies apart, relative to their size, and its growth until they are separated.
const MARGIN: f64 = 1e-6;
const GROWTH: f64 = 8.0;
/// Maximum number of repetitions, and increase of the separation, relative to the size, below which they end.
const REPETITIONS: usize = 24;
const LEAST_INCREASE: f64 = 1e-9;
/// Maximum number of support points of a distance.
const SUPPORTS: usize = 40;
/// Relative accuracy of the square of a distance.
const ACCURACY: f64 = 1e-13;

/// Returns the separation of two bodies along a unit vector towards the first.
pub(super) fn separation_along_normal<T: Real>(
    first: &PlacedPolytope<'_, T>,
    second: &PlacedPolytope<'_, T>,
    normal: &Vector3<T>,
) -> T {
    normal.dot(&(first.support(&-normal) - second.support(normal)))
}

/// Returns a direction with a local maximum of the separation, and the separation. Of separated bodies it is
/// the global maximum.
pub(super) fn climb_to_separation_maximum<T: Real>(
    first: &PlacedPolytope<'_, T>,
    second: &PlacedPolytope<'_, T>,
    start: Vector3<T>,
    size: T,
) -> (T, Vector3<T>) {
    let mut best = (separation_along_normal(first, second, &start), start);
    let margin = size * constant(MARGIN);
    let mut shift = margin;
    for _ in 0..REPETITIONS {
        if best.0 > margin {
            shift = T::zero();
        }
        let connection = shortest_connection(first, second, &(best.1 * shift));
        let norm = connection.norm();
        let next = if norm > T::zero() { connection / norm } else { best.1 };
        let value = separation_along_normal(first, second, &next);
        if value + shift * next.dot(&best.1) <= T::zero() {
            // The bodies still overlap.
            shift *= constant(GROWTH);
            continue;
        }
        let increase = value - best.0;
        if increase > T::zero() {
            best = (value, next);
        }
        if increase <= size * constant(LEAST_INCREASE) || shift <= T::zero() {
            break;
        }
    }
    best
}

/// Returns the vector from the second body to the first, displaced by `shift`, between their closest points.
fn shortest_connection<T: Real>(
    first: &PlacedPolytope<'_, T>,
    second: &PlacedPolytope<'_, T>,
    shift: &Vector3<T>,
) -> Vector3<T> {
    let mut simplex = Simplex { points: [Vector3::zeros(); 4], count: 0 };
    let mut connection = first.center() + shift - second.center();
    let mut least: Option<T> = None;
    for _ in 0..SUPPORTS {
        let support = first.support(&-connection) + shift - second.support(&connection);
        let square = connection.norm_squared();
        if least.is_some() && square - connection.dot(&support) <= square * constant(ACCURACY) {
            break;
        }
        let (point, reduced) = simplex.nearest_to_origin_with(support);
        let next = point.norm_squared();
        if least.is_some_and(|least| next >= least) {
            break;
        }
        (simplex, connection, least) = (reduced, point, Some(next));
    }
    connection
}

/// Points whose convex hull contains the point nearest to the origin.
struct Simplex<T> {
    points: [Vector3<T>; 4],
    count: usize,
}

impl<T: Real> Simplex<T> {
    /// Returns the point nearest to the origin of the simplex with another point, and the simplex with this
    /// point in its interior. The origin is outside, and the nearest point is not in the old simplex.
    fn nearest_to_origin_with(&self, newest: Vector3<T>) -> (Vector3<T>, Simplex<T>) {
        let points = self.points.get(..self.count).unwrap_or(&[]);
        let simplex_from_points = |points: [Vector3<T>; 3], count| Simplex {
            points: [points[0], points[1], points[2], Vector3::zeros()],
            count,
        };
        let zero = Vector3::zeros();
        let mut best = (newest, simplex_from_points([newest, zero, zero], 1));
        let (inside, one) = (T::zero(), T::one());
        for (k, point) in points.iter().enumerate() {
            let side = point - newest;
            let t = -newest.dot(&side) / side.norm_squared();
            let nearest = newest + side * t;
            if t > inside && t < one && nearest.norm_squared() < best.0.norm_squared() {
                best = (nearest, simplex_from_points([newest, *point, zero], 2));
            }
            for other in points.iter().skip(k + 1) {
                let next = other - newest;
                let (x, y, z) = (side.norm_squared(), next.norm_squared(), side.dot(&next));
                let determinant = x * y - z * z;
                let (a, b) = (newest.dot(&side), newest.dot(&next));
                let (s, t) = ((z * b - y * a) / determinant, (z * a - x * b) / determinant);
                let nearest = newest + side * s + next * t;
                let is_inside = determinant > inside && s > inside && t > inside && s + t < one;
                if is_inside && nearest.norm_squared() < best.0.norm_squared() {
                    best = (nearest, simplex_from_points([newest, *point, *other], 3));
                }
            }
        }
        best
    }
}
