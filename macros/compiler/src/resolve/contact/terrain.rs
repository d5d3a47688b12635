//! Ground whose height is an expression of the position: `terrain(height)`, where `u` and `w` are the
//! coordinates along x and y.

use super::geometry::{PointContact, tangents_of};
use crate::diag::Diagnostics;
use crate::expr::diff::DirectionalDerivative;
use crate::expr::replace::substitute_symbols_in_all;
use crate::expr::{Expr, Extreme, Vec3};
use crate::kinematics::symbols_in;
use crate::mechanism::{Quantity, SuppliedQuantity};
use crate::resolve::scope::{AllowedQuantities, Context, Scope};
use crate::syntax;

/// Names of the coordinates in the expression of the height.
pub const TERRAIN_COORDINATES: [&str; 2] = ["u", "w"];

/// Number of Newton iterations for the nearest point to a sphere; each doubles the number of correct digits.
const NEWTON_STEPS: usize = 3;

/// Maximum distance at which the nearest point is computed, relative to the distance at which a sphere
/// touches.
const NEAR_RATIO: f64 = 1.25;

/// Height as a function of x and y, with its first derivatives and its second derivatives xx, xy and yy.
#[derive(Clone)]
pub struct Terrain<'g> {
    pub(super) height: Expr<'g>,
    slopes: [Expr<'g>; 2],
    curvatures: [Expr<'g>; 3],
}

/// Height of a terrain with its derivatives at a position.
struct TerrainPoint<'g> {
    height: Expr<'g>,
    slopes: [Expr<'g>; 2],
    curvatures: [Expr<'g>; 3],
}

/// Parses a terrain with this height.
pub(super) fn read_terrain<'g>(
    scope: &Scope<'_, 'g>,
    height: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<Terrain<'g>> {
    let g = scope.graph;
    let symbols = [0, 1].map(|k| Quantity::Given(SuppliedQuantity::Position, k).symbol());
    let [u, w] = TERRAIN_COORDINATES;
    let locals = vec![(u, g.symbol(symbols[0])), (w, g.symbol(symbols[1]))];
    let context = Context::new(AllowedQuantities::Constant, None).with_locals(locals);
    let height_of = scope.call_in_context(context, |s| s.resolve_scalar(height, cx))?;
    if !symbols_in(&[height_of]).into_iter().any(|s| symbols.contains(&s)) {
        cx.report_error(height.place.clone(), "this height is constant").add_help(
            "write it as a function of `u` and `w`, the positions along the body's x and y axes, as in \
             `0.1 * sin(3 * u)`; level ground is a `plane`",
        );
        return None;
    }
    let derivative =
        |e: Expr<'g>, k: usize| DirectionalDerivative::with_respect_to(symbols[k], g).differentiate(e);
    let slopes = [derivative(height_of, 0), derivative(height_of, 1)];
    let curvatures = [derivative(slopes[0], 0), derivative(slopes[0], 1), derivative(slopes[1], 1)];
    Some(Terrain { height: height_of, slopes, curvatures })
}

impl<'g> Terrain<'g> {
    fn evaluate(&self, [x, y]: [Expr<'g>; 2]) -> TerrainPoint<'g> {
        let place =
            [(0, x), (1, y)].map(|(k, e)| (Quantity::Given(SuppliedQuantity::Position, k).symbol(), e));
        let all = [&[self.height][..], &self.slopes, &self.curvatures].concat();
        let found = substitute_symbols_in_all(&all, &|s| {
            place.iter().find(|(known, _)| *known == s).map(|(_, e)| *e)
        });
        let evaluated_entry_at = |k: usize| found.get(k).copied().unwrap_or(self.height);
        TerrainPoint {
            height: evaluated_entry_at(0),
            slopes: [evaluated_entry_at(1), evaluated_entry_at(2)],
            curvatures: [evaluated_entry_at(3), evaluated_entry_at(4), evaluated_entry_at(5)],
        }
    }

    /// Returns the contact with a sphere around `c`, a position in the terrain's axes. A point is a sphere of
    /// radius zero.
    pub(super) fn sphere_contact(
        &self,
        radius: Expr<'g>,
        c: Vec3<'g>,
        rotate: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
    ) -> PointContact<'g> {
        let below = self.evaluate([c[0], c[1]]);
        let nearest = self.nearest_terrain_point(radius, c, &below);
        let normal = rotate(nearest.normal);
        let (first, second) = tangents_of(normal);
        PointContact {
            gap: nearest.distance - radius,
            point: -(normal * radius),
            axes: [("normal", normal), ("first", first), ("second", second)],
            conditions: Vec::new(),
        }
    }

    /// Returns the nearest point of the terrain, by Newton's method from the point straight below. The
    /// nearest point of a sphere far above may be ambiguous. Such a sphere is lowered for the iteration, and
    /// the omitted height is added to the distance.
    fn nearest_terrain_point(
        &self,
        radius: Expr<'g>,
        c: Vec3<'g>,
        below: &TerrainPoint<'g>,
    ) -> NearestTerrainPoint<'g> {
        let above = c[2] - below.height;
        if radius.is_zero() {
            return NearestTerrainPoint { normal: below.normal(), distance: above / below.normal_length() };
        }
        let near = above.minimum_or_maximum(Extreme::Min, radius * below.normal_length() * NEAR_RATIO);
        let z = below.height + near;
        let mut place = [c[0], c[1]];
        for _ in 0..NEWTON_STEPS {
            let TerrainPoint { height, slopes: [hx, hy], curvatures: [xx, xy, yy] } = self.evaluate(place);
            let down = height - z;
            let (fx, fy) = (place[0] - c[0] + down * hx, place[1] - c[1] + down * hy);
            let one = radius.num(1.0);
            let (a, b, d) = (one + hx * hx + down * xx, hx * hy + down * xy, one + hy * hy + down * yy);
            let determinant = a * d - b * b;
            place = [place[0] - (d * fx - b * fy) / determinant, place[1] - (a * fy - b * fx) / determinant];
        }
        let found = self.evaluate(place);
        let normal = found.normal();
        let offset = Vec3([c[0] - place[0], c[1] - place[1], z - found.height]);
        NearestTerrainPoint { normal, distance: normal.dot(offset) + (above - near) / below.normal_length() }
    }
}

/// Nearest point of a terrain: the normal there, and the distance.
struct NearestTerrainPoint<'g> {
    normal: Vec3<'g>,
    distance: Expr<'g>,
}

impl<'g> TerrainPoint<'g> {
    /// Returns the length of the normal vector whose z component is one.
    fn normal_length(&self) -> Expr<'g> {
        let [hx, hy] = self.slopes;
        (hx.num(1.0) + hx * hx + hy * hy).sqrt()
    }

    fn normal(&self) -> Vec3<'g> {
        let ([hx, hy], size) = (self.slopes, self.normal_length());
        Vec3([-hx / size, -hy / size, hx.num(1.0) / size])
    }
}
