//! What is known of the derivatives of forward dynamics without any product: how a mechanism with a free base moves in the
//! axes of the base depends neither on where the base is, nor on its velocity (Galilei), and on its orientation only in that
//! uniform gravity has other components. With the linear and angular velocity `v` and `ω` of the base and gravity `g`, all in
//! its axes, all accelerations are those without gravity, but that of the base, `v̇ = … + g − ω × v`. A rotation `φ` of the
//! base in its axes changes `g` by `g × φ`, so that `∂v̇/∂φ = [g]×` and `∂v̇/∂v = −[ω]×`; those of all other accelerations are
//! zero. Springs, loads and the like may forbid this.

use super::{ForceDerivatives, symbolic};
use crate::expr::{Expr, Mat3, Vec3};
use crate::mechanics::Joint;
use crate::model::{Model, Motion, Quantity};

/// Columns that are known, with their indices.
type Columns<'g> = Vec<(usize, Vec<Expr<'g>>)>;

/// The columns of `∂v̇/∂q` and `∂v̇/∂v` that are known.
#[derive(Default)]
pub struct Known<'g> {
    /// Of `∂v̇/∂q`.
    pub by_q: Columns<'g>,
    /// Of `∂v̇/∂v`.
    pub by_v: Columns<'g>,
}

/// Finds them.
pub fn known<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Known<'g> {
    let mut found = Known::default();
    let others = symbolic::of_resistance(model);
    for (link, joint) in model.links.iter().zip(joints) {
        let (None, Motion::Free { v, .. }) = (link.parent, &link.motion) else { continue };
        let columns = |first: usize, block: Mat3<'g>| {
            (0..3).map(move |k| {
                let mut column = vec![model.graph.zero(); model.nv()];
                for (i, entry) in column[*v..*v + 3].iter_mut().enumerate() {
                    *entry = block.0[i][k];
                }
                (first + k, column)
            })
        };
        let is_free = |of: &[Vec<Expr<'g>>], first: usize| {
            of.iter().all(|row| row[first..first + 3].iter().all(|e| e.is_zero()))
        };
        if is_free(&others.by_q, v + 3) {
            found.by_q.extend(columns(v + 3, Mat3::skew(joint.rotation.to_child(model.gravity))));
        }
        if is_free(&others.by_v, *v) {
            let w = Vec3([3, 4, 5].map(|k| Quantity::Velocity(v + k).expr(model.graph)));
            found.by_v.extend(columns(*v, Mat3::skew(-w)));
        }
    }
    found
}

impl<'g> Known<'g> {
    /// Puts them in the place of the derivatives of forces from which the others follow.
    pub fn replace(&self, forces: &mut ForceDerivatives<'g>) {
        for (to, from) in [(&mut forces.by_q, &self.by_q), (&mut forces.by_v, &self.by_v)] {
            for (k, column) in from {
                for (row, entry) in to.iter_mut().zip(column) {
                    row[*k] = *entry;
                }
            }
        }
    }

    /// All of them, one after another.
    pub fn all(&self) -> Vec<Expr<'g>> {
        self.by_q.iter().chain(&self.by_v).flat_map(|(_, column)| column.iter().copied()).collect()
    }

    /// The indices of those of `∂v̇/∂q` and of `∂v̇/∂v`.
    pub fn indices(&self) -> [Vec<usize>; 2] {
        [&self.by_q, &self.by_v].map(|columns| columns.iter().map(|(k, _)| *k).collect())
    }
}
