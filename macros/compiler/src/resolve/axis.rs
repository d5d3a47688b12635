//! Directions: checks for unit length, and alignment of constant joint axes with coordinate axes.

use super::scope::Scope;
use crate::diag::Diagnostics;
use crate::expr::sample::always_equals_number;
use crate::expr::{Graph, Mat3, Rotation, Vec3};
use crate::syntax;

impl<'g> Scope<'_, 'g> {
    /// Returns a direction: a vector of unit length. If `normalise` is set, a constant vector is normalised.
    pub fn resolve_unit_vector(
        &self,
        e: &syntax::Expr,
        normalise: bool,
        cx: &mut Diagnostics,
    ) -> Option<Vec3<'g>> {
        if let Some(n) = e.literal_number().filter(|n| *n != 0.0) {
            let sign = if n < 0.0 { "-" } else { "" };
            cx.report_error(e.place.clone(), "expected a direction, found a number").add_help(format!(
                "an axis is `{sign}x`, `{sign}y` or `{sign}z`, or a vector of unit length"
            ));
            return None;
        }
        let v = self.resolve_own_axes_vector(e, cx)?;
        let v = v.constant_components().map_or(v, |n| Vec3::vector_from_constants(self.graph, n));
        let squared = v.dot(v);
        if v.is_zero() || always_equals_number(squared, 0.0) {
            cx.report_error(e.place.clone(), "this axis has no direction: it is zero")
                .add_help("write `x`, `y`, `z` or another vector of unit length");
            return None;
        }
        if always_equals_number(squared, 1.0) {
            return Some(v);
        }
        if normalise && let Some(n) = v.constant_components() {
            return Some(Vec3::vector_from_constants(self.graph, normalise_vector(n)));
        }
        let diagnostic = cx.report_error(e.place.clone(), "this axis is not of unit length");
        match v.constant_components() {
            Some(n) => diagnostic.add_help(format!("its length is {}; write `unit(…)` around it", length(n))),
            None => diagnostic.add_help("write `unit(…)` around it"),
        };
        None
    }
}

fn length(v: [f64; 3]) -> f64 {
    libm::hypot(libm::hypot(v[0], v[1]), v[2])
}

/// Divides a vector by its length; components that are exactly ±1 are preserved.
fn normalise_vector(v: [f64; 3]) -> [f64; 3] {
    let norm = length(v);
    v.map(|c| c / norm)
}

/// Returns the coordinate axis nearest to a constant axis, and the rotation from that coordinate axis to the
/// axis. The joint then rotates about the coordinate axis, which is cheap, and the rotation is constant. An
/// axis that is not constant is returned with the identity.
pub fn nearest_axis_and_rotation<'g>(graph: &'g Graph, axis: Vec3<'g>) -> (Vec3<'g>, Rotation<'g>) {
    let identity = Rotation::identity(graph);
    let Some(n) = axis.constant_components() else {
        return (axis, identity);
    };
    let k = (0..3).max_by(|a, b| n[*a].abs().total_cmp(&n[*b].abs())).unwrap_or(0);
    let mut nearest = [0.0; 3];
    nearest[k] = n[k].signum();
    if nearest == n {
        return (axis, identity);
    }
    // R = 1 + [w]× + [w]×² / (1 + c), w = near × n, c = near · n.
    let w = [
        nearest[1] * n[2] - nearest[2] * n[1],
        nearest[2] * n[0] - nearest[0] * n[2],
        nearest[0] * n[1] - nearest[1] * n[0],
    ];
    let c = nearest[k] * n[k];
    let skew = [[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]];
    let matrix = Mat3::from_fn(|i, j| {
        let square: f64 = (0..3).map(|l| skew[i][l] * skew[l][j]).sum();
        graph.num(f64::from(u8::from(i == j)) + skew[i][j] + square / (1.0 + c))
    });
    (Vec3::vector_from_constants(graph, nearest), Rotation::from_matrix(matrix))
}
