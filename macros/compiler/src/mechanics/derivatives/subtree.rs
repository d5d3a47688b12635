//! Sums over a link and all its descendants, about its origin in its axes: inertia, wrench, and the linear
//! map `X ↦ −I (V × X) + X ×* I V + V ×* I X` that gives the change of the forces with the velocity.
//!
//! The map depends only on the angular component `x` of `X`. For particles of mass `m` at `r` with velocity
//! `u` it is `−2 Σ m (u × x, r × (u × x))`: force `−2 p × x` with `p = Σ m u`, moment `−2 (K − tr K) x` with
//! `K = Σ m u rᵀ`.

use super::super::crba;
use crate::expr::{Mat3, Sym3, Vec3};
use crate::kinematics::{Joint, SpatialVector};
use crate::mechanism::{Inertia, Model};

/// Sums of mass properties and wrenches over one link and its descendants.
#[derive(Clone, Copy)]
pub struct SubtreeMassAndWrench<'g> {
    /// Mass properties of the link and its descendants, about the link's origin in its axes.
    pub inertia: Inertia<'g>,
    /// Wrench that produces the accelerations of the link and its descendants, about the link's origin in its
    /// axes.
    pub wrench: SpatialVector<'g>,
    /// Multiple of `p`; the factor is the argument `multiple` of `subtrees`.
    momentum: Vec3<'g>,
    /// Multiple of `K`; the factor is the argument `multiple` of `subtrees`.
    moments: Mat3<'g>,
}

impl<'g> SubtreeMassAndWrench<'g> {
    /// Returns the velocity map of a motion `x`: a force and a moment.
    pub fn velocity_derivative_wrench(&self, x: &SpatialVector<'g>) -> SpatialVector<'g> {
        SpatialVector {
            linear: x.angular.cross(self.momentum),
            angular: minus_trace(&self.moments) * -x.angular,
        }
    }

    /// Returns the transposed velocity map of a motion `x`. It is a moment; the corresponding force is zero.
    pub fn transposed_velocity_derivative_moment(&self, x: &SpatialVector<'g>) -> Vec3<'g> {
        self.momentum.cross(x.linear) + minus_trace(&self.moments.transpose()) * -x.angular
    }
}

/// Returns the matrix minus its trace times the identity, `K − tr K`.
fn minus_trace<'g>(k: &Mat3<'g>) -> Mat3<'g> {
    let sum_of_other_diagonals = |i: usize| k.0[(i + 1) % 3][(i + 1) % 3] + k.0[(i + 2) % 3][(i + 2) % 3];
    Mat3::from_fn(|i, j| if i == j { -sum_of_other_diagonals(i) } else { k.0[i][j] })
}

/// Returns the sums of all links for the given twists and wrenches. The velocity map is multiplied by
/// `multiple / 2`.
pub fn subtree_sums<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    twists: &[SpatialVector<'g>],
    wrenches: &[SpatialVector<'g>],
    multiple: f64,
) -> Vec<SubtreeMassAndWrench<'g>> {
    let inertias = crba::composite_inertias(model, joints);
    let bodies = model.links.iter().map(|link| &link.inertia);
    let mut sums: Vec<SubtreeMassAndWrench<'g>> =
        bodies.zip(twists).map(|(body, twist)| sums_of_single_body(body, twist, multiple)).collect();
    for (sum, (inertia, wrench)) in sums.iter_mut().zip(inertias.into_iter().zip(wrenches)) {
        (sum.inertia, sum.wrench) = (inertia, *wrench);
    }
    for (k, joint) in joints.iter().enumerate().rev() {
        if let Some(parent) = joint.parent {
            let child = sums[k];
            let sum = &mut sums[parent.0];
            sum.wrench = joint.add_wrench_to_parent(&sum.wrench, &child.wrench);
            let momentum = joint.rotation.vector_in_parent_axes(child.momentum);
            let moments = joint.rotation.tensor_in_parent_axes(child.moments)
                + outer_product(momentum, joint.translation);
            sum.momentum += momentum.map(|c| joint.sum_over_limb_lanes(c));
            sum.moments = sum.moments + Mat3(moments.0.map(|row| row.map(|c| joint.sum_over_limb_lanes(c))));
        }
    }
    sums
}

/// Returns the sums of a single body, without wrench. With its first moment `h` and `J = Σ m r rᵀ`:
/// `p = m v + w × h`, `K = v hᵀ + [w]× J`.
pub fn sums_of_single_body<'g>(
    body: &Inertia<'g>,
    twist: &SpatialVector<'g>,
    multiple: f64,
) -> SubtreeMassAndWrench<'g> {
    let second = second_moments(&body.tensor);
    let (mass, h) = (body.mass * multiple, body.moment.map(|c| c * multiple));
    let j = Mat3::from_fn(|i, k| second.entry(i, k) * multiple);
    let zero = Vec3::zero(body.mass.graph());
    SubtreeMassAndWrench {
        inertia: *body,
        wrench: SpatialVector { linear: zero, angular: zero },
        momentum: twist.linear * mass + twist.angular.cross(h),
        moments: outer_product(twist.linear, h) + Mat3::skew(twist.angular) * j,
    }
}

/// Returns the second moments of mass `J = ½ tr(I) − I` for the inertia tensor `I`.
fn second_moments<'g>(tensor: &Sym3<'g>) -> Sym3<'g> {
    let [x, y, z] = tensor.diagonal;
    let half = (x + y + z) * 0.5;
    Sym3 { diagonal: [half - x, half - y, half - z], off: tensor.off.map(|c| -c) }
}

fn outer_product<'g>(a: Vec3<'g>, b: Vec3<'g>) -> Mat3<'g> {
    Mat3::from_fn(|i, j| a[i] * b[j])
}
