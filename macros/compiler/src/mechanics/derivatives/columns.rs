//! Motion of the links, and its change with each degree of freedom (Singh, Russell and Wensing 2022): with
//! the twist `V` and the acceleration `A` of the parent, a degree of freedom `S` has `Ψ̇ = V × S` and
//! `Ψ̈ = A × S + V × Ψ̇`.

use crate::expr::{Expr, Mat3, Vec3};
use crate::kinematics::{Dof, Joint, SpatialVector};
use crate::mechanism::Model;

/// Motion of a frame in its own axes. Accelerations are classical (those of points), and gravity is included
/// as an upward acceleration of the ground.
#[derive(Clone, Copy)]
pub struct FrameMotion<'g> {
    /// Velocity of the frame's origin, in the frame's own axes.
    pub v: Vec3<'g>,
    /// Angular velocity of the frame, in the frame's own axes.
    pub w: Vec3<'g>,
    /// Angular acceleration of the frame, in the frame's own axes.
    pub dw: Vec3<'g>,
    /// Classical acceleration of the origin, minus gravity, in the frame's own axes.
    pub a: Vec3<'g>,
}

impl<'g> FrameMotion<'g> {
    /// Returns the state of the ground: no velocity, and the acceleration opposite to gravity.
    pub fn state_of_ground(model: &Model<'g>) -> FrameMotion<'g> {
        let zero = Vec3::zero(model.graph);
        FrameMotion { v: zero, w: zero, dw: zero, a: -model.gravity }
    }

    /// Returns `U = [ẇ]× + [w]×[w]×`: a point at `r` has the acceleration `a + U r`.
    pub fn angular_acceleration_tensor(&self) -> Mat3<'g> {
        let ([x, y, z], dw) = (self.w.0, self.dw);
        let (xx, yy, zz) = (x * x, y * y, z * z);
        let (yz, zx, xy) = (y * z, z * x, x * y);
        Mat3([
            [-(yy + zz), xy - dw[2], zx + dw[1]],
            [xy + dw[2], -(xx + zz), yz - dw[0]],
            [zx - dw[1], yz + dw[0], -(xx + yy)],
        ])
    }

    /// Returns the twist: velocity of the origin and angular velocity.
    pub fn twist(&self) -> SpatialVector<'g> {
        SpatialVector { linear: self.v, angular: self.w }
    }
}

/// Motion of a link, and of the parent's point at the link's origin, both in link axes.
#[derive(Clone, Copy)]
pub struct LinkMotion<'g> {
    /// Motion of the link's own frame.
    pub own: FrameMotion<'g>,
    /// Motion of the point of the parent that coincides with the link's origin.
    pub parent: FrameMotion<'g>,
}

/// Returns the motions of all links by the outward recursion.
pub fn link_motions<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    a: &[Expr<'g>],
) -> Vec<LinkMotion<'g>> {
    let mut motions: Vec<LinkMotion<'g>> = Vec::with_capacity(joints.len());
    for joint in joints {
        let above = joint.parent.map_or(FrameMotion::state_of_ground(model), |p| motions[p.0].own);
        let (turn, p) = (&joint.rotation, joint.translation);
        let parent = FrameMotion {
            v: turn.vector_in_child_axes(above.v + above.w.cross(p)),
            w: turn.vector_in_child_axes(above.w),
            dw: turn.vector_in_child_axes(above.dw),
            a: turn.vector_in_child_axes(above.a + above.angular_acceleration_tensor() * p),
        };
        let (rate, change) = (joint.twist_with_prescribed_motion(model, v), joint.relative_twist(model, a));
        let w = parent.w;
        let own = FrameMotion {
            v: parent.v + rate.linear,
            w: w + rate.angular,
            dw: parent.dw + w.cross(rate.angular) + change.angular,
            a: parent.a + (w + w + rate.angular).cross(rate.linear) + change.linear,
        };
        motions.push(LinkMotion { own, parent });
    }
    motions
}

/// A degree of freedom with the changes that its displacement and its velocity cause in the motion of the
/// link and all descendants.
#[derive(Clone, Copy)]
pub struct DofMotionChanges<'g> {
    /// Index in `v` of the degree of freedom to which the column belongs.
    pub index: usize,
    /// Joint velocity per unit of the entry of `v`.
    pub ratio: f64,
    /// Motion subspace `S`, in link axes.
    pub subspace: SpatialVector<'g>,
    /// Change `Ψ̇ = V × S` of the link's twist with a displacement, `V` of the parent.
    pub first: SpatialVector<'g>,
    /// Change `Ψ̈ = A × S + V × Ψ̇` of the link's acceleration with a displacement, `V` and `A` of the
    /// parent.
    pub second: SpatialVector<'g>,
    /// Change `Ψ̇ + Ṡ` of the link's acceleration with the velocity, where `Ṡ = V × S` with the link's own
    /// twist `V`.
    pub rate: SpatialVector<'g>,
}

impl<'g> DofMotionChanges<'g> {
    /// Applies a function to all expressions of a derivative column.
    pub fn map(&self, f: &dyn Fn(Expr<'g>) -> Expr<'g>) -> DofMotionChanges<'g> {
        let map_components =
            |s: &SpatialVector<'g>| SpatialVector { linear: s.linear.map(f), angular: s.angular.map(f) };
        DofMotionChanges {
            subspace: map_components(&self.subspace),
            first: map_components(&self.first),
            second: map_components(&self.second),
            rate: map_components(&self.rate),
            ..*self
        }
    }
}

/// Returns the columns of a link for the derivatives of inverse dynamics.
pub fn derivative_columns<'g>(joint: &Joint<'g>, motion: &LinkMotion<'g>) -> Vec<DofMotionChanges<'g>> {
    let (above, single) = (&motion.parent, joint.dofs.len() == 1);
    // The rotation about an axis changes neither the product of U with the axis nor V × S if S is the only
    // degree of freedom.
    let u =
        if single { motion.own.angular_acceleration_tensor() } else { above.angular_acceleration_tensor() };
    let derivative_column = |dof: &Dof<'g>| {
        let s = &dof.subspace;
        let first = cross(&above.twist(), s);
        let change = if single { first } else { cross(&motion.own.twist(), s) };
        let rate = first.plus(&change);
        // In terms of classical accelerations: A × S + V × Ψ̇ = (U s + a × r + 2 v × (w × r), U r) for S =
        // (s, r).
        let turning = above.w.cross(s.angular);
        let linear = u * s.linear + above.a.cross(s.angular) + above.v.cross(turning + turning);
        let second = SpatialVector { linear, angular: u * s.angular };
        DofMotionChanges { index: dof.index, ratio: dof.ratio, subspace: *s, first, second, rate }
    };
    joint.dofs.iter().map(derivative_column).collect()
}

/// Returns the columns of a link for the Coriolis matrix, with `Ṡ` in `rate` instead of `Ψ̇ + Ṡ`; the
/// displacement columns are zero.
pub fn coriolis_columns<'g>(
    model: &Model<'g>,
    joint: &Joint<'g>,
    twist: &SpatialVector<'g>,
) -> Vec<DofMotionChanges<'g>> {
    let zero = SpatialVector::zero(model);
    let jacobian_column_with_rate = |(k, dof): (usize, &Dof<'g>)| {
        let own = joint.drift.as_ref().and_then(|drift| drift.subspace_rates.get(k));
        let rate = own.unwrap_or(&zero).plus(&cross(twist, &dof.subspace));
        DofMotionChanges {
            index: dof.index,
            ratio: dof.ratio,
            subspace: dof.subspace,
            first: zero,
            second: zero,
            rate,
        }
    };
    joint.dofs.iter().enumerate().map(jacobian_column_with_rate).collect()
}

/// Returns `V × X`, the rate of a motion `X` that moves with the twist `V`.
pub fn cross<'g>(v: &SpatialVector<'g>, x: &SpatialVector<'g>) -> SpatialVector<'g> {
    SpatialVector {
        linear: v.angular.cross(x.linear) + v.linear.cross(x.angular),
        angular: v.angular.cross(x.angular),
    }
}
