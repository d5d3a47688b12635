//! Inverse dynamics by the recursive Newton–Euler algorithm (Luh, Walker and Paul 1980; Featherstone 2008,
//! ch. 5). The acceleration of the points of a link is given by one matrix, `U = [ẇ]× + [w]×[w]×`
//! (Balafoutis, Patel and Misra 1988): a point at `r` has the acceleration `a + U r`.

use super::shared_motions::SharedPartialVelocities;
use super::{added_mass, inertances};
use crate::expr::{Expr, Function, Mat3, Sym3, Vec3};
use crate::kinematics::{Joint, SpatialVector};
use crate::mechanics::passive::passive_forces;
use crate::mechanism::{Inertia, Model, Pose};

/// Returns `τ = M a + h`, or the bias `h` if `a` is `None`.
pub fn inverse_dynamics<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    a: Option<&[Expr<'g>]>,
) -> Vec<Expr<'g>> {
    let mut wrenches = link_wrenches(model, joints, v, a);
    let mut tau = passive_forces(model, true);
    inertances::add_inerter_forces(model, a, &mut tau);
    if let Some(a) = a {
        added_mass::subtract_acceleration_forces(model, a, &mut tau);
    }
    let shared = SharedPartialVelocities::new(model, joints);
    for (k, joint) in joints.iter().enumerate().rev() {
        let wrench = wrenches[k];
        for dof in joint.dofs.iter().filter(|_| !shared.shares_partial_velocity(k)) {
            tau[dof.index] += dof.subspace.dot(&wrench) * model.graph.num(dof.ratio);
        }
        if let Some(parent) = joint.parent {
            wrenches[parent.0] = joint.add_wrench_to_parent(&wrenches[parent.0], &wrench);
        }
    }
    shared.add_generalized_forces_of_wrenches(&wrenches, &mut tau);
    tau
}

/// Returns the wrench that produces the acceleration of each link, including its weight. If `a` is `None`,
/// the joint accelerations are zero.
pub fn link_wrenches<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    a: Option<&[Expr<'g>]>,
) -> Vec<SpatialVector<'g>> {
    let states = link_motions(model, joints, v, a);
    model.links.iter().zip(&states).map(|(link, state)| newton_euler_wrench(&link.inertia, state)).collect()
}

/// Motion of a link: angular velocity, its products, angular acceleration, `U`, acceleration of the origin.
#[derive(Clone, Copy)]
pub(super) struct LinkMotionState<'g> {
    w: Vec3<'g>,
    /// Squares `wx²`, `wy²`, `wz²` of the angular velocity.
    squares: Vec3<'g>,
    /// Products `wy wz`, `wz wx`, `wx wy` of the angular velocity.
    products: Vec3<'g>,
    dw: Vec3<'g>,
    u: Mat3<'g>,
    a: Vec3<'g>,
}

impl<'g> LinkMotionState<'g> {
    fn new(w: Vec3<'g>, dw: Vec3<'g>, a: Vec3<'g>) -> LinkMotionState<'g> {
        let [x, y, z] = w.0;
        let (xx, yy, zz) = (x * x, y * y, z * z);
        let products = Vec3([y * z, z * x, x * y]);
        let [yz, zx, xy] = products.0;
        let u = Mat3([
            [-(yy + zz), xy - dw[2], zx + dw[1]],
            [xy + dw[2], -(xx + zz), yz - dw[0]],
            [zx - dw[1], yz + dw[0], -(xx + yy)],
        ]);
        LinkMotionState { w, squares: Vec3([xx, yy, zz]), products, dw, u, a }
    }

    /// Returns the motion of a frame that is fixed in the link.
    pub(super) fn motion_of_fixed_frame(&self, pose: &Pose<'g>) -> LinkMotionState<'g> {
        let vector_in_child = |v| pose.rotation.vector_in_child_axes(v);
        LinkMotionState::new(
            vector_in_child(self.w),
            vector_in_child(self.dw),
            vector_in_child(self.a + self.u * pose.translation),
        )
    }
}

/// Returns the motions of all links by the outward recursion. Gravity is included as an upward acceleration
/// of the ground.
pub(super) fn link_motions<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    a: Option<&[Expr<'g>]>,
) -> Vec<LinkMotionState<'g>> {
    let zero = Vec3::zero(model.graph);
    let ground = LinkMotionState::new(zero, zero, -model.gravity);
    let mut states: Vec<LinkMotionState<'g>> = Vec::with_capacity(joints.len());
    for joint in joints {
        let parent = joint.parent.map_or(ground, |p| states[p.0]);
        let rate = joint.twist_with_prescribed_motion(model, v);
        let w_parent = joint.rotation.vector_in_child_axes(parent.w);
        let mut dw = joint.rotation.vector_in_child_axes(parent.dw) + w_parent.cross(rate.angular);
        // Translation in the joint: Coriolis acceleration, and the rotation of a velocity given in link axes.
        let mut origin = joint.rotation.vector_in_child_axes(parent.a + parent.u * joint.translation)
            + (w_parent + w_parent + rate.angular).cross(rate.linear);
        if let Some(drift) = &joint.drift {
            dw += drift.acceleration.angular;
            origin += drift.acceleration.linear;
        }
        if let Some(a) = a {
            let own = joint.relative_twist(model, a);
            dw += own.angular;
            origin += own.linear;
        }
        states.push(LinkMotionState::new(w_parent + rate.angular, dw, origin));
    }
    states
}

/// Returns the wrench that produces a body's acceleration, about the link's origin.
pub(super) fn newton_euler_wrench<'g>(inertia: &Inertia<'g>, s: &LinkMotionState<'g>) -> SpatialVector<'g> {
    let (i, u) = (&inertia.tensor, &s.u.0);
    // Component k of I ẇ + w × I w, collected by the entries of I; (k, l, m) cyclic.
    let mut moment = inertia.moment.cross(s.a);
    for k in 0..3 {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        moment.0[k] += euler_moment_component(i, s, k) + i.entry(l, m) * (s.squares[l] - s.squares[m])
            - i.entry(k, l) * u[m][k]
            + i.entry(k, m) * u[l][k];
    }
    SpatialVector { linear: s.a * inertia.mass + s.u * inertia.moment, angular: moment }
}

/// Returns `I_kk ẇ_k + (I_mm − I_ll) w_l w_m`. In terms of the second moments `P` of mass this is
/// `P_ll U_ml − P_mm U_lm`. The form with fewer terms is used.
fn euler_moment_component<'g>(i: &Sym3<'g>, s: &LinkMotionState<'g>, k: usize) -> Expr<'g> {
    let (l, m) = ((k + 1) % 3, (k + 2) % 3);
    let [own, next, last] = [k, l, m].map(|k| i.diagonal[k]);
    if own.is_constant() && next.is_constant() && last.is_constant() {
        let size = [own, next, last].map(|x| x.apply_function(Function::Abs));
        let rounding = (size[0] + size[1] + size[2]) * (4.0 * f64::EPSILON);
        let second = [(own + last - next) * 0.5, (own + next - last) * 0.5];
        let [p, q] = second.map(|x| if x.is_magnitude_within_bound(rounding) { x.zero() } else { x });
        let terms = usize::from(!own.is_zero()) + usize::from(next != last);
        if usize::from(!p.is_zero()) + usize::from(!q.is_zero()) < terms {
            return p * s.u.0[m][l] - q * s.u.0[l][m];
        }
    }
    own * s.dw[k] + (last - next) * s.products[k]
}
