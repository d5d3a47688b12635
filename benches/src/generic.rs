//! Hand-written reference implementation: rigid-body dynamics of any tree of links, read at run time.
//!
//! The algorithms are the recursive ones of Featherstone, *Rigid Body Dynamics Algorithms* (2008), ch. 5–7,
//! in link axes, with nalgebra's fixed 3-vectors and 3×3 matrices. All intermediate results are in a
//! [`Workspace`] that is allocated once, so that no function allocates. It does not use the compiler's crates
//! and is therefore also an oracle for the generated code.

mod spatial;
mod urdf;

pub use spatial::{ArticulatedInertia, Inertia, Placement, SpatialVector};
pub use urdf::Options;

use nalgebra::{DMatrix, Matrix3, Matrix6xX, Quaternion, Unit, UnitQuaternion, Vector3, Vector6};

/// Motion that a joint allows for a link relative to its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointMotion {
    /// Rotation of the link about an axis.
    Turn(Unit<Vector3<f64>>),
    /// Translation of the link along an axis.
    Slide(Unit<Vector3<f64>>),
    /// Free motion: q = position, quaternion x y z w; v = linear, angular velocity in link axes.
    Free,
}

impl JointMotion {
    /// Returns the number of entries of `q` and of `v`.
    fn entry_counts_of_q_and_v(self) -> (usize, usize) {
        match self {
            JointMotion::Turn(_) | JointMotion::Slide(_) => (1, 1),
            JointMotion::Free => (7, 6),
        }
    }

    /// Returns column `k` of the motion subspace of a joint.
    fn subspace_column(self, k: usize) -> SpatialVector {
        match self {
            JointMotion::Turn(axis) => SpatialVector::new(Vector3::zeros(), *axis),
            JointMotion::Slide(axis) => SpatialVector::new(*axis, Vector3::zeros()),
            JointMotion::Free => SpatialVector::unit_vector(k),
        }
    }

    /// Returns the joint twist: the motion subspace times the joint velocities.
    fn twist_from_rates(self, rates: &[f64]) -> SpatialVector {
        match self {
            JointMotion::Turn(axis) => SpatialVector::new(Vector3::zeros(), *axis * rates[0]),
            JointMotion::Slide(axis) => SpatialVector::new(*axis * rates[0], Vector3::zeros()),
            JointMotion::Free => SpatialVector::from_slice(rates),
        }
    }

    /// Returns the placement of the link in the joint's frame.
    fn placement_in_joint_frame(self, q: &[f64]) -> Placement {
        match self {
            JointMotion::Turn(axis) => Placement::new(rotation_about_axis(&axis, q[0]), Vector3::zeros()),
            JointMotion::Slide(axis) => Placement::new(Matrix3::identity(), *axis * q[0]),
            JointMotion::Free => {
                let quaternion = Quaternion::new(q[6], q[3], q[4], q[5]);
                let rotation = UnitQuaternion::new_unchecked(quaternion).to_rotation_matrix();
                Placement::new(rotation.into_inner(), Vector3::new(q[0], q[1], q[2]))
            }
        }
    }
}

/// Returns the rotation matrix about the axis `n` by Rodrigues's formula.
fn rotation_about_axis(n: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    let (u, k) = (n * s, n * (1.0 - c));
    Matrix3::new(
        c + k.x * n.x,
        k.x * n.y - u.z,
        k.x * n.z + u.y,
        k.y * n.x + u.z,
        c + k.y * n.y,
        k.y * n.z - u.x,
        k.z * n.x - u.y,
        k.z * n.y + u.x,
        c + k.z * n.z,
    )
}

/// Moving link of the robot, including all links that are rigidly fixed to it.
#[derive(Clone, Debug)]
pub struct Link {
    /// Index of the parent link, which is smaller; `None` for the ground.
    pub parent: Option<usize>,
    /// Placement of the joint's frame in the frame of the parent link.
    pub placement: Placement,
    /// Type of motion of the link relative to the joint's frame.
    pub motion: JointMotion,
    /// Index in `q` of the link's first coordinate.
    pub q: usize,
    /// Index in `v` of the link's first velocity.
    pub v: usize,
    /// Rigid-body inertia of the link about its origin.
    pub inertia: Inertia,
}

/// Named frame, fixed to a link or to the ground.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Name of the frame in the URDF file.
    pub name: String,
    /// Index of the link to which the frame is attached; `None` for the ground.
    pub link: Option<usize>,
    /// Placement of the frame relative to its link.
    pub placement: Placement,
}

/// Robot of a generic implementation: tree of links with named frames and gravity.
#[derive(Clone, Debug)]
pub struct Model {
    /// Links of the robot, parents before children.
    pub links: Vec<Link>,
    /// Named frames of the robot.
    pub frames: Vec<Frame>,
    /// Gravitational acceleration in ground axes, m/s².
    pub gravity: Vector3<f64>,
    /// Number of entries of the configuration `q`.
    pub nq: usize,
    /// Number of entries of the velocity `v`.
    pub nv: usize,
}

/// Intermediate results of the recursive algorithms for one link.
#[derive(Clone, Debug)]
struct LinkIntermediateResults {
    placement: Placement,
    twist: SpatialVector,
    acceleration: SpatialVector,
    wrench: SpatialVector,
    composite: Inertia,
    articulated: ArticulatedInertia,
    /// `U = IA s`, `1 / D` and `u = τ − s · pA` of a joint with one degree of freedom.
    column: SpatialVector,
    inverse: f64,
    force: f64,
}

/// Working storage of the recursive algorithms, one entry for each link.
#[derive(Clone, Debug)]
pub struct Workspace(Vec<LinkIntermediateResults>);

impl Model {
    /// Reads a URDF file.
    pub fn from_urdf(text: &str, options: &Options<'_>) -> Result<Model, String> {
        urdf::read_urdf(text, options)
    }

    /// Allocates the working storage of the recursive algorithms.
    pub fn allocate_workspace(&self) -> Workspace {
        let initial_link_data = |link: &Link| LinkIntermediateResults {
            placement: link.placement,
            twist: SpatialVector::zero(),
            acceleration: SpatialVector::zero(),
            wrench: SpatialVector::zero(),
            composite: link.inertia,
            articulated: ArticulatedInertia::from_rigid_inertia(&link.inertia),
            column: SpatialVector::zero(),
            inverse: 0.0,
            force: 0.0,
        };
        Workspace(self.links.iter().map(initial_link_data).collect())
    }

    fn compute_placements(&self, data: &mut Workspace, q: &[f64]) {
        for (link, d) in self.links.iter().zip(&mut data.0) {
            d.placement = link.placement.compose_with(&link.motion.placement_in_joint_frame(&q[link.q..]));
        }
    }

    /// Computes inverse dynamics `τ = M a + h` (only the bias `h` without accelerations) by the recursive
    /// Newton–Euler algorithm.
    pub fn inverse_dynamics(
        &self,
        data: &mut Workspace,
        q: &[f64],
        v: &[f64],
        a: Option<&[f64]>,
        tau: &mut [f64],
    ) {
        self.compute_placements(data, q);
        self.propagate_outward(data, v, a);
        for (k, link) in self.links.iter().enumerate().rev() {
            let d = &data.0[k];
            let (wrench, placement) = (d.wrench, d.placement);
            for dof in 0..link.motion.entry_counts_of_q_and_v().1 {
                tau[link.v + dof] = link.motion.subspace_column(dof).dot(&wrench);
            }
            if let Some(p) = link.parent {
                data.0[p].wrench += placement.wrench_to_parent(&wrench);
            }
        }
    }

    /// Computes twists, accelerations and inertial wrenches of the links, from the base outwards.
    fn propagate_outward(&self, data: &mut Workspace, v: &[f64], a: Option<&[f64]>) {
        for (k, link) in self.links.iter().enumerate() {
            let nv = link.motion.entry_counts_of_q_and_v().1;
            let (before, rest) = data.0.split_at_mut(k);
            let d = &mut rest[0];
            let own = link.motion.twist_from_rates(&v[link.v..link.v + nv]);
            let (parent_twist, parent_acceleration) = match link.parent {
                Some(p) => (before[p].twist, before[p].acceleration),
                None => (SpatialVector::zero(), SpatialVector::new(-self.gravity, Vector3::zeros())),
            };
            d.twist = d.placement.twist_to_child(&parent_twist) + own;
            d.acceleration = d.placement.twist_to_child(&parent_acceleration) + d.twist.cross(&own);
            if let Some(a) = a {
                d.acceleration += link.motion.twist_from_rates(&a[link.v..link.v + nv]);
            }
            let momentum = link.inertia.momentum_of_twist(&d.twist);
            d.wrench = link.inertia.momentum_of_twist(&d.acceleration) + d.twist.cross_force(&momentum);
        }
    }

    /// Computes the mass matrix, both triangles, by the composite-rigid-body algorithm.
    pub fn mass_matrix(&self, data: &mut Workspace, q: &[f64], m: &mut DMatrix<f64>) {
        self.compute_placements(data, q);
        for (link, d) in self.links.iter().zip(&mut data.0) {
            d.composite = link.inertia;
        }
        for (k, link) in self.links.iter().enumerate().rev() {
            if let Some(p) = link.parent {
                let moved = data.0[k].composite.inertia_in_parent(&data.0[k].placement);
                data.0[p].composite += moved;
            }
        }
        m.fill(0.0);
        for (k, link) in self.links.iter().enumerate() {
            for dof in 0..link.motion.entry_counts_of_q_and_v().1 {
                let mut wrench = data.0[k].composite.momentum_of_twist(&link.motion.subspace_column(dof));
                let row = link.v + dof;
                let mut at = k;
                loop {
                    let other = &self.links[at];
                    let count = if at == k { dof + 1 } else { other.motion.entry_counts_of_q_and_v().1 };
                    for c in 0..count {
                        let entry = other.motion.subspace_column(c).dot(&wrench);
                        m[(row, other.v + c)] = entry;
                        m[(other.v + c, row)] = entry;
                    }
                    let Some(parent) = other.parent else { break };
                    wrench = data.0[at].placement.wrench_to_parent(&wrench);
                    at = parent;
                }
            }
        }
    }

    /// Computes forward dynamics `v̇ = M⁻¹ (τ − h)` by the articulated-body algorithm.
    pub fn forward_dynamics(&self, data: &mut Workspace, q: &[f64], v: &[f64], tau: &[f64], a: &mut [f64]) {
        self.compute_placements(data, q);
        for (k, link) in self.links.iter().enumerate() {
            let own = link.motion.twist_from_rates(&v[link.v..]);
            let parent = link.parent.map_or(SpatialVector::zero(), |p| data.0[p].twist);
            let d = &mut data.0[k];
            d.twist = d.placement.twist_to_child(&parent) + own;
            d.acceleration = d.twist.cross(&own);
            d.articulated = ArticulatedInertia::from_rigid_inertia(&link.inertia);
            d.wrench = d.twist.cross_force(&link.inertia.momentum_of_twist(&d.twist));
        }
        for (k, link) in self.links.iter().enumerate().rev() {
            let d = &mut data.0[k];
            let (inertia, wrench) = match link.motion {
                // A free joint transmits no force, so that the parent has no articulated inertia of this
                // link.
                JointMotion::Free => (None, SpatialVector::from_slice(&tau[link.v..])),
                JointMotion::Turn(_) | JointMotion::Slide(_) => {
                    let s = link.motion.subspace_column(0);
                    d.column = d.articulated.wrench_of_acceleration(&s);
                    d.inverse = 1.0 / s.dot(&d.column);
                    d.force = tau[link.v] - s.dot(&d.wrench);
                    let reduced = d.articulated.inertia_after_joint_elimination(&d.column, d.inverse);
                    let wrench = d.wrench
                        + reduced.wrench_of_acceleration(&d.acceleration)
                        + d.column * (d.force * d.inverse);
                    (Some(reduced), wrench)
                }
            };
            let placement = d.placement;
            if let Some(p) = link.parent {
                let parent = &mut data.0[p];
                parent.wrench += placement.wrench_to_parent(&wrench);
                if let Some(inertia) = inertia {
                    parent.articulated += inertia.inertia_in_parent(&placement);
                }
            }
        }
        for (k, link) in self.links.iter().enumerate() {
            let (before, rest) = data.0.split_at_mut(k);
            let d = &mut rest[0];
            let parent = match link.parent {
                Some(p) => before[p].acceleration,
                None => SpatialVector::new(-self.gravity, Vector3::zeros()),
            };
            let carried = d.placement.twist_to_child(&parent) + d.acceleration;
            match link.motion {
                JointMotion::Free => {
                    let force = SpatialVector::from_slice(&tau[link.v..]) - d.wrench;
                    d.acceleration = d.articulated.acceleration_from_wrench(&force);
                    let own: Vector6<f64> = (d.acceleration - carried).as_six_vector();
                    a[link.v..link.v + 6].copy_from_slice(own.as_slice());
                }
                JointMotion::Turn(_) | JointMotion::Slide(_) => {
                    let own = (d.force - d.column.dot(&carried)) * d.inverse;
                    a[link.v] = own;
                    d.acceleration = carried + link.motion.subspace_column(0) * own;
                }
            }
        }
    }

    /// Returns the kinetic energy, J.
    pub fn kinetic_energy(&self, data: &mut Workspace, q: &[f64], v: &[f64]) -> f64 {
        self.compute_placements(data, q);
        let mut twice = 0.0;
        for (k, link) in self.links.iter().enumerate() {
            let parent = link.parent.map_or(SpatialVector::zero(), |p| data.0[p].twist);
            let d = &mut data.0[k];
            d.twist = d.placement.twist_to_child(&parent) + link.motion.twist_from_rates(&v[link.v..]);
            twice += d.twist.dot(&link.inertia.momentum_of_twist(&d.twist));
        }
        0.5 * twice
    }

    /// Returns the index of the frame with a name.
    pub fn index_of_frame(&self, name: &str) -> Option<usize> {
        self.frames.iter().position(|frame| frame.name == name)
    }

    /// Writes the Jacobian of a frame: velocity of its origin, then angular velocity, in ground axes.
    pub fn frame_jacobian(
        &self,
        data: &mut Workspace,
        frame: usize,
        q: &[f64],
        jacobian: &mut Matrix6xX<f64>,
    ) {
        jacobian.fill(0.0);
        let frame = &self.frames[frame];
        // Ancestors from the frame inwards, relative to the frame and in its axes …
        let mut seen = frame.placement.inverse_placement();
        let mut at = frame.link;
        while let Some(k) = at {
            let link = &self.links[k];
            let d = &mut data.0[k];
            d.placement = link.placement.compose_with(&link.motion.placement_in_joint_frame(&q[link.q..]));
            for dof in 0..link.motion.entry_counts_of_q_and_v().1 {
                let column = seen.twist_to_parent(&link.motion.subspace_column(dof));
                jacobian.set_column(link.v + dof, &column.as_six_vector());
            }
            seen = seen.compose_with(&d.placement.inverse_placement());
            at = link.parent;
        }
        // … then all columns in ground axes.
        let axes = seen.rotation.transpose();
        at = frame.link;
        while let Some(k) = at {
            let link = &self.links[k];
            for column in link.v..link.v + link.motion.entry_counts_of_q_and_v().1 {
                let turned = SpatialVector::from_slice(jacobian.column(column).as_slice())
                    .map_linear_and_angular(|v| axes * v);
                jacobian.set_column(column, &turned.as_six_vector());
            }
            at = link.parent;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::pairs;

    /// Generated and generic code are independent implementations of the same robots, and agree.
    #[test]
    fn generated_and_generic_dynamics_agree() {
        for robot in pairs::compared_robots() {
            for mut pair in robot.pairs {
                let error = (0..crate::states::STATES).map(|k| (pair.difference)(k)).fold(0.0, f64::max);
                println!("{}, {}: {error:.1e}", robot.name, pair.function);
                assert!(error <= 1e-9, "{}, {}: {error:e}", robot.name, pair.function);
            }
        }
    }
}
