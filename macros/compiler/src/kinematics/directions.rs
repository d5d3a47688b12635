//! Unit vectors that are perpendicular to given vectors.

use crate::expr::Vec3;
use crate::expr::diff::TINY;
use crate::expr::eval::eval;
use crate::expr::sample::sample_of_symbol;

/// Names of the coordinate axes.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// Returns a vector divided by its length. The result for the zero vector is zero, not NaN.
pub fn normalised_or_zero(v: Vec3<'_>) -> Vec3<'_> {
    match v.constant_components() {
        Some(_) => v.map(|c| c / v.norm()),
        None => {
            let length = (v.dot(v) + v[0].num(TINY)).sqrt();
            v.map(|c| c / length)
        }
    }
}

/// Returns two directions orthogonal to an axis and to each other, with their names.
pub fn perpendicular_directions(axis: Vec3<'_>) -> [(&'static str, Vec3<'_>); 2] {
    let g = axis[0].graph();
    let words: [(&'static str, Vec3<'_>); 3] = [0, 1, 2].map(|k| (AXES[k], Vec3::coordinate_axis(g, k)));
    let is_along_coordinate_axis = |k: usize| axis.constant_components().is_some_and(|n| n[k].abs() == 1.0);
    if let Some(k) = (0..3).find(|k| is_along_coordinate_axis(*k)) {
        return [words[(k + 1) % 3], words[(k + 2) % 3]];
    }
    let [first, second] = match directions_in_plane(axis) {
        Some((first, second)) => [first, second],
        None => {
            // The coordinate axis farthest from the direction for sampled parameters.
            let at = eval(&axis.0, &|s| sample_of_symbol(s, 0));
            let far = (0..3).min_by(|a, b| at[*a].abs().total_cmp(&at[*b].abs())).unwrap_or(0);
            let first = normalised_or_zero(axis.cross(Vec3::coordinate_axis(g, far)));
            [first, axis.cross(first)]
        }
    };
    [("first", first), ("second", second)]
}

/// Returns two directions that form a right-handed frame with a normal, or `None` if the normal is not
/// constant. For the normal z they are x and y, and cyclically for x and y. For any other normal the first
/// direction is orthogonal to the coordinate axis that is farthest from the normal.
pub fn directions_in_plane(normal: Vec3<'_>) -> Option<(Vec3<'_>, Vec3<'_>)> {
    let graph = normal[0].graph();
    let n = normal.constant_components()?;
    if let Some(k) = (0..3).find(|k| n[*k] == 1.0) {
        return Some((Vec3::coordinate_axis(graph, (k + 1) % 3), Vec3::coordinate_axis(graph, (k + 2) % 3)));
    }
    let far = (0..3).min_by(|a, b| n[*a].abs().total_cmp(&n[*b].abs()))?;
    let raw = normal.cross(Vec3::coordinate_axis(graph, far));
    let first = raw.map(|c| c / raw.norm());
    Some((first, normal.cross(first)))
}
