//! Contact points, and functions of expressions that contacts of several surfaces use.

use crate::expr::{Expr, Extreme, Function, Vec3};
use crate::kinematics::perpendicular_directions;
use crate::mechanism::LinkId;
use crate::resolve::scope::VectorTerms;

/// A contact at a point, in the axes of the link that carries both bodies.
pub(super) struct PointContact<'g> {
    /// Signed distance of the surfaces, m.
    pub(super) gap: Expr<'g>,
    /// Contact point, relative to the centre of the first surface.
    pub(super) point: Vec3<'g>,
    /// Normal and two tangents, with their names.
    pub(super) axes: [(&'static str, Vec3<'g>); 3],
    /// Distances that vanish when the coordinates of a surface given by its points are those of the contact,
    /// with their names.
    pub(super) conditions: Vec<(&'static str, Expr<'g>)>,
}

/// A point where two surfaces may touch.
pub(super) struct CandidatePoint<'g> {
    /// Signed distance, m.
    pub(super) gap: Expr<'g>,
    /// Normal and two tangents, towards the first surface, each with the velocity along it.
    pub(super) rates: [(Vec3<'g>, Expr<'g>); 3],
    /// Relative angular velocity about the normal and each tangent.
    pub(super) angular_rates: [Expr<'g>; 3],
    /// Link in whose axes the directions are expressed.
    pub(super) ancestor: Option<LinkId>,
    /// Position of the point.
    pub(super) place: VectorTerms<'g>,
}

/// Squared sine of the angle below which lines are treated as parallel.
const PARALLEL: f64 = 1e-12;

/// Squared sine of the angle below which a rim is treated as flat on a plane; its centre is then the contact.
pub(super) const FLAT_RIM: f64 = 1e-24;

/// Returns one if `x` is positive, zero if it is negative.
pub(super) fn indicator_of_positive(x: Expr<'_>) -> Expr<'_> {
    (x.apply_function(Function::Signum) + x.num(1.0)) * 0.5
}

/// Returns the directions from the centre of a rim to its lowest point over a plane and to the points 90°,
/// 180° and 270° further along the rim. If the rim lies flat, all its points are lowest; a fixed direction of
/// the body is then used.
pub(super) fn directions_to_rim_points<'g>(
    axis: Vec3<'g>,
    normal: Vec3<'g>,
    rotate: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
) -> [Vec3<'g>; 4] {
    let [(_, fixed), _] = perpendicular_directions(axis);
    let (a, fixed) = (rotate(axis), rotate(fixed));
    let cosine = a.dot(normal);
    let down = a * cosine - normal + fixed * cosine.num(FLAT_RIM.sqrt());
    let size = down.norm();
    let lowest = down.map(|x| x / size);
    let quarter = a.cross(lowest);
    [lowest, quarter, -lowest, -quarter]
}

/// Returns the norm of a vector; if its square is below `least_square`, the root of the latter.
pub(super) fn norm_bounded_below<'g>(v: Vec3<'g>, least_square: f64) -> Expr<'g> {
    let square = v.dot(v);
    square.minimum_or_maximum(Extreme::Max, square.num(1.0) * least_square).sqrt()
}

/// Clamps `x` to the interval from `-limit` to `limit`.
pub(super) fn clamp<'g>(x: Expr<'g>, limit: Expr<'g>) -> Expr<'g> {
    x.minimum_or_maximum(Extreme::Max, -limit).minimum_or_maximum(Extreme::Min, limit)
}

/// Returns the closest points of two line segments, as signed distances from their centres along their unit
/// axes. Each segment has an axis and half its length; `c` leads from the second centre to the first
/// (Ericson, *Real-Time Collision Detection*, 2005, § 5.1.9). For parallel segments, one of the many
/// solutions is returned.
pub(super) fn closest_positions_on_segments<'g>(
    c: Vec3<'g>,
    (own, own_reach): (Vec3<'g>, Expr<'g>),
    (axis, reach): (Vec3<'g>, Expr<'g>),
) -> (Expr<'g>, Expr<'g>) {
    let (cosine, first, second) = (own.dot(axis), own.dot(c), axis.dot(c));
    let one = cosine.num(1.0);
    let across = (one - cosine * cosine).minimum_or_maximum(Extreme::Max, cosine.num(PARALLEL));
    let guess = clamp((cosine * second - first) / across, own_reach);
    let far = clamp(second + cosine * guess, reach);
    (clamp(cosine * far - first, own_reach), far)
}

/// Returns two unit tangents for a unit normal of any direction (Duff et al., *Building an orthonormal basis,
/// revisited*, 2017).
pub(super) fn tangents_of(n: Vec3<'_>) -> (Vec3<'_>, Vec3<'_>) {
    let [x, y, z] = n.0;
    let sign = z.apply_function(Function::Signum);
    let a = -((sign + z).num(1.0) / (sign + z));
    let b = x * y * a;
    let one = z.num(1.0);
    (Vec3([one + sign * x * x * a, sign * b, -(sign * x)]), Vec3([b, sign + y * y * a, -y]))
}
