//! A convex body that rolls or slips on a surface of any form, given by its points: `surface(u, w, point)`.
//! Where they touch does not follow in closed form, so the surface's parameters `u` and `w` are coordinates,
//! which move no mass: the constraints put them where the body's farthest point against the normal is that
//! point of the surface.

use super::surface::Sheet;
use super::{Contact, Pair, farthest};
use crate::diag::Diagnostics;
use crate::expr::Vec3;
use crate::expr::diff::Derivative;
use crate::kinematics::symbols_in;
use crate::mechanism::{Coordinate, Quantity};
use crate::resolve::builder::Builder;
use crate::resolve::scope::{Allowed, Context, Placed};
use crate::syntax;

impl<'g> Builder<'_, 'g> {
    /// The points of a surface, in the axes of its body, with the two coordinates that name them.
    pub(super) fn sheet(
        &self,
        frame: &Placed<'g>,
        [u, w, point]: [&syntax::Expr; 3],
        cx: &mut Diagnostics,
    ) -> Option<Sheet<'g>> {
        let (first, second) = (self.parameter(u, cx), self.parameter(w, cx));
        let context = Context::new(Allowed::Placement, Some((frame.link, frame.pose.clone())));
        let terms = self.scope.in_context(context, |scope| scope.terms(point, cx));
        let (first, second, terms) = (first?, second?, terms?);
        let zero = Vec3::zero(self.scope.graph);
        let in_link = self.scope.kinematics.borrow().resolve(&terms, frame.link, zero);
        let at = frame.pose.rotation.to_child(in_link);
        let own = |q: Quantity| match q {
            Quantity::Configuration(k) => k == first.q.0 || k == second.q.0,
            q => matches!(q, Quantity::Parameter(_)),
        };
        if !symbols_in(&at.0).into_iter().all(|s| own(Quantity::of(s))) {
            cx.error(point.place.clone(), "the points of a surface depend on its two coordinates alone")
                .help("parameters may stand there as well, and the axes of the surface's own body");
            return None;
        }
        let along = |c: &Coordinate| {
            let mut d =
                Derivative::with_respect_to(Quantity::Configuration(c.q.0).symbol(), self.scope.graph);
            at.map(|e| d.differentiate(e))
        };
        let tangents = [along(&first), along(&second)];
        if tangents[0].cross(tangents[1]).is_zero() {
            cx.error(point.place.clone(), "these points are no surface: they do not move with both coordinates")
                .help("write the points by two coordinates, as in `surface(u, w, u * x + w * y + u * w / size * z)`");
            return None;
        }
        Some(Sheet { at, tangents })
    }

    /// A coordinate of its own, by name.
    fn parameter(&self, e: &syntax::Expr, cx: &mut Diagnostics) -> Option<Coordinate> {
        let kinematics = self.scope.kinematics.borrow();
        let known = || self.description.coordinates.iter().map(|c| c.name.text.as_str());
        let name = e.name().unwrap_or("");
        let found = kinematics.coordinates.iter().find(|(n, ..)| n == name && known().any(|k| k == name));
        if found.is_none() && (name.is_empty() || self.scope.is_news(name, cx)) {
            cx.error(e.place.clone(), "expected a coordinate of the surface")
                .suggest(name, known())
                .help("declare it as a field of its own: `u: Coordinate`");
        }
        found.map(|(_, c, _)| *c)
    }

    /// Where a convex body touches, with the distances that put the coordinates of the surface there.
    pub(super) fn contact_point(&self, pair: &Pair<'g>, sheet: &Sheet<'g>) -> Option<Contact<'g>> {
        let of_surface = |v| self.of_second(pair, v).value;
        let [u, w] = sheet.tangents.map(of_surface);
        let first = u.map(|x| x / u.norm());
        let across = u.cross(w);
        let normal = across.map(|x| x / across.norm());
        let second = normal.cross(first);
        let point = -farthest(&pair.a.form, normal, 0.0, &|v| self.of_first(pair, v).value)?;
        let apart = pair.center.value - pair.base.value + point - of_surface(sheet.at);
        Some(Contact {
            gap: normal.dot(apart),
            point,
            axes: [("normal", normal), ("first", first), ("second", second)],
            conditions: vec![("foot_first", first.dot(apart)), ("foot_second", second.dot(apart))],
        })
    }
}
