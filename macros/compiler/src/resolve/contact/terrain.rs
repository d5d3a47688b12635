//! Ground whose height is an expression of the place: `terrain(height)`, with `u` and `w` for the place along
//! x and y.

use super::{Contact, tangents_of};
use crate::diag::Diagnostics;
use crate::expr::diff::Derivative;
use crate::expr::replace::replace_all;
use crate::expr::{Expr, Extreme, Vec3};
use crate::kinematics::symbols_in;
use crate::mechanism::Quantity;
use crate::resolve::builder::Builder;
use crate::resolve::scope::{Allowed, Context};
use crate::syntax;

/// The coordinates of the place, as the height names them.
pub const PLACE: [&str; 2] = ["u", "w"];

/// How often the place under a sphere is mended; each time doubles its digits.
const MENDED: usize = 3;

/// Of the distance at which a sphere touches, the part above which it is taken to be that near.
const NEAR: f64 = 1.25;

/// A height over x and y, with its first and second derivatives: xx, xy, yy.
#[derive(Clone)]
pub struct Terrain<'g> {
    pub(super) height: Expr<'g>,
    slopes: [Expr<'g>; 2],
    curvatures: [Expr<'g>; 3],
}

/// A terrain at a place.
struct Local<'g> {
    height: Expr<'g>,
    slopes: [Expr<'g>; 2],
    curvatures: [Expr<'g>; 3],
}

impl<'g> Builder<'_, 'g> {
    /// The terrain with this height.
    pub(super) fn terrain(&self, height: &syntax::Expr, cx: &mut Diagnostics) -> Option<Terrain<'g>> {
        let g = self.scope.graph;
        let symbols = [0, 1].map(|k| Quantity::Given(k).symbol());
        let [u, w] = PLACE;
        let locals = vec![(u, g.symbol(symbols[0])), (w, g.symbol(symbols[1]))];
        let context = Context::new(Allowed::Constant, None).with_locals(locals);
        let height_of = self.scope.in_context(context, |s| s.scalar(height, cx))?;
        if !symbols_in(&[height_of]).into_iter().any(|s| symbols.contains(&s)) {
            cx.error(height.place.clone(), "this height is the same everywhere")
                .help("write it by `u` and `w`, the place along the body's x and y, as in `0.1 * sin(3 * u)`; where it is level, a plane will do");
            return None;
        }
        let along = |e: Expr<'g>, k: usize| Derivative::with_respect_to(symbols[k], g).differentiate(e);
        let slopes = [along(height_of, 0), along(height_of, 1)];
        let curvatures = [along(slopes[0], 0), along(slopes[0], 1), along(slopes[1], 1)];
        Some(Terrain { height: height_of, slopes, curvatures })
    }
}

impl<'g> Terrain<'g> {
    fn at(&self, [x, y]: [Expr<'g>; 2]) -> Local<'g> {
        let place = [(Quantity::Given(0).symbol(), x), (Quantity::Given(1).symbol(), y)];
        let all = [&[self.height][..], &self.slopes, &self.curvatures].concat();
        let found = replace_all(&all, &|s| place.iter().find(|(known, _)| *known == s).map(|(_, e)| *e));
        let entry = |k: usize| found.get(k).copied().unwrap_or(self.height);
        Local { height: entry(0), slopes: [entry(1), entry(2)], curvatures: [entry(3), entry(4), entry(5)] }
    }

    /// The contact with a sphere around `c`, a place in the terrain's axes; a point is one without a radius.
    pub(super) fn contact(
        &self,
        radius: Expr<'g>,
        c: Vec3<'g>,
        turned: &dyn Fn(Vec3<'g>) -> Vec3<'g>,
    ) -> Contact<'g> {
        let below = self.at([c[0], c[1]]);
        let nearest = self.nearest(radius, c, &below);
        let normal = turned(nearest.normal);
        let (first, second) = tangents_of(normal);
        Contact {
            gap: nearest.distance - radius,
            point: -(normal * radius),
            axes: [("normal", normal), ("first", first), ("second", second)],
            conditions: Vec::new(),
        }
    }

    /// The nearest place of the terrain. From straight below Newton's method leads there; spheres far above,
    /// for which other places might be nearer, are taken to be near, and what that leaves out of the distance
    /// is added to it.
    fn nearest(&self, radius: Expr<'g>, c: Vec3<'g>, below: &Local<'g>) -> Nearest<'g> {
        let above = c[2] - below.height;
        if radius.is_zero() {
            return Nearest { normal: below.normal(), distance: above / below.size() };
        }
        let near = above.extreme(Extreme::Min, radius * below.size() * NEAR);
        let z = below.height + near;
        let mut place = [c[0], c[1]];
        for _ in 0..MENDED {
            let Local { height, slopes: [hx, hy], curvatures: [xx, xy, yy] } = self.at(place);
            let down = height - z;
            let (fx, fy) = (place[0] - c[0] + down * hx, place[1] - c[1] + down * hy);
            let one = radius.num(1.0);
            let (a, b, d) = (one + hx * hx + down * xx, hx * hy + down * xy, one + hy * hy + down * yy);
            let determinant = a * d - b * b;
            place = [place[0] - (d * fx - b * fy) / determinant, place[1] - (a * fy - b * fx) / determinant];
        }
        let found = self.at(place);
        let normal = found.normal();
        let apart = Vec3([c[0] - place[0], c[1] - place[1], z - found.height]);
        Nearest { normal, distance: normal.dot(apart) + (above - near) / below.size() }
    }
}

/// The nearest place of a terrain: its normal, and the distance from there.
struct Nearest<'g> {
    normal: Vec3<'g>,
    distance: Expr<'g>,
}

impl<'g> Local<'g> {
    /// The length of the normal whose height is one.
    fn size(&self) -> Expr<'g> {
        let [hx, hy] = self.slopes;
        (hx.num(1.0) + hx * hx + hy * hy).sqrt()
    }

    fn normal(&self) -> Vec3<'g> {
        let ([hx, hy], size) = (self.slopes, self.size());
        Vec3([-hx / size, -hy / size, hx.num(1.0) / size])
    }
}
