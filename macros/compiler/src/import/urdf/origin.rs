//! `<origin xyz="…" rpy="…"/>` → a vector and rotations.

use crate::import::context::Cx;
use crate::import::element::{Node, check_attributes, numbers, place};
use crate::import::imported::Placed;
use crate::syntax::Expr;

/// A frame as URDF places it.
pub(super) struct Origin {
    /// Its origin.
    pub(super) xyz: Placed<[f64; 3]>,
    /// Roll, pitch and yaw: turns about the fixed x, y and z in this order.
    pub(super) rpy: Placed<[f64; 3]>,
}

impl Origin {
    /// The position, unless it is zero.
    pub(super) fn at(&self) -> Option<Expr> {
        (self.xyz.value != [0.0; 3]).then(|| Expr::vector(self.xyz.value, &self.xyz.place))
    }

    /// The turns that are not zero, about carried axes. Turns about fixed axes in one order are turns about
    /// carried axes in the opposite order: `R = R_z(yaw) R_y(pitch) R_x(roll)`.
    pub(super) fn rotated(&self) -> Vec<Expr> {
        let [roll, pitch, yaw] = self.rpy.value;
        let turns = [("z", yaw), ("y", pitch), ("x", roll)].into_iter().filter(|(_, angle)| *angle != 0.0);
        turns.map(|(axis, angle)| turn(axis, angle, self)).collect()
    }

    /// A vector of the origin's axes, in the axes that it is placed in.
    pub(super) fn rotate(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [(sr, cr), (sp, cp), (sy, cy)] = self.rpy.value.map(f64::sin_cos);
        let (y, z) = (cr * y - sr * z, sr * y + cr * z);
        let (x, z) = (cp * x + sp * z, cp * z - sp * x);
        [cy * x - sy * y, sy * x + cy * y, z]
    }
}

fn turn(axis: &str, angle: f64, origin: &Origin) -> Expr {
    let place = &origin.rpy.place;
    Expr::call(axis, vec![Expr::number(angle, place)], place)
}

/// Reads the `<origin>` of `owner`; without one, the frames coincide.
pub(super) fn read_origin(node: Option<Node<'_>>, owner: Node<'_>, cx: &mut Cx<'_>) -> Origin {
    let zero = |node| Placed { value: [0.0; 3], place: place(node, cx) };
    let Some(node) = node else {
        return Origin { xyz: zero(owner), rpy: zero(owner) };
    };
    let (no_xyz, no_rpy) = (zero(node), zero(node));
    check_attributes(node, &[], &["xyz", "rpy"], cx);
    if let Some(found) = node.attribute_node("quat_xyzw") {
        let place = cx.place(found.range().start);
        cx.error(&place, "`quat_xyzw` is not supported", |d| d.help("expected `rpy=\"roll pitch yaw\"`"));
    }
    let xyz = numbers(node, "xyz", cx).unwrap_or(no_xyz);
    let rpy = numbers(node, "rpy", cx).unwrap_or(no_rpy);
    Origin { xyz, rpy }
}
