//! Sharing of identical partial velocities. Particles whose positions are sums over the preceding coordinates
//! have the same partial velocities. Wrenches and inertias of such links are summed before they are
//! multiplied with the partial velocity: `Σ sᵀ Wₖ = sᵀ Σ Wₖ`, and `Σ sᵀ Iₖ r = sᵀ (Σ Iₖ) r`. The mass matrix
//! of a chain of `n` then takes `n²` operations instead of `n³`.

use super::crba::{Matrix, momentum};
use crate::expr::{Expr, Id, Sym3};
use crate::kinematics::{Joint, SpatialVector};
use crate::mechanism::{Inertia, Model, Motion};
use std::collections::BTreeMap;

/// Partial velocities of links that are placed by expressions, for links that share at least one partial
/// velocity with another link. A shared partial velocity is stored once. The list is empty if no two links
/// share one.
pub struct SharedPartialVelocities<'g> {
    motions: Vec<SharedPartialVelocity<'g>>,
    /// True for each link that shares a partial velocity with another link.
    concerned: Vec<bool>,
}

/// Partial velocity of some links for an entry of `v`, or the time derivative of that partial velocity. Its
/// components are the same in the axes of each of these links.
struct SharedPartialVelocity<'g> {
    index: usize,
    ratio: f64,
    along: SpatialVector<'g>,
    /// Links in descending order, so that sums over the last links are partial sums of other sums.
    links: Vec<usize>,
}

impl<'g> SharedPartialVelocities<'g> {
    /// Collects the motion subspaces that several links share.
    pub fn new(model: &Model<'g>, joints: &[Joint<'g>]) -> SharedPartialVelocities<'g> {
        SharedPartialVelocities::collect_shared_partial_velocities(model, joints, |joint, dof| {
            Some(joint.dofs[dof].subspace)
        })
    }

    /// Collects the time derivatives of motion subspaces that several links share.
    pub fn shared_subspace_rates(model: &Model<'g>, joints: &[Joint<'g>]) -> SharedPartialVelocities<'g> {
        SharedPartialVelocities::collect_shared_partial_velocities(model, joints, |joint, dof| {
            joint.drift.as_ref()?.subspace_rates.get(dof).copied()
        })
    }

    fn collect_shared_partial_velocities(
        model: &Model<'g>,
        joints: &[Joint<'g>],
        along: impl Fn(&Joint<'g>, usize) -> Option<SpatialVector<'g>>,
    ) -> SharedPartialVelocities<'g> {
        let mut motions: Vec<SharedPartialVelocity<'g>> = Vec::new();
        let mut known: BTreeMap<(usize, u64, Vec<Id>), usize> = BTreeMap::new();
        // Wrenches of links with a parent are transmitted to the parent, and identical limbs are summed in
        // that step. Such links are left out here.
        let is_placed_relative_to_ground = |k: usize| {
            let (link, joint) = (&model.links[k], &joints[k]);
            matches!(link.motion, Motion::Placed) && joint.parent.is_none() && joint.limbs == 1
        };
        for (k, joint) in joints.iter().enumerate().rev().filter(|(k, _)| is_placed_relative_to_ground(*k)) {
            for (place, dof) in joint.dofs.iter().enumerate() {
                let Some(along) = along(joint, place) else { continue };
                let ids = along.linear.0.iter().chain(&along.angular.0).map(|e| e.id()).collect();
                let next = motions.len();
                match *known.entry((dof.index, dof.ratio.to_bits(), ids)).or_insert(next) {
                    motion if motion < next => motions[motion].links.push(k),
                    _ => motions.push(SharedPartialVelocity {
                        index: dof.index,
                        ratio: dof.ratio,
                        along,
                        links: vec![k],
                    }),
                }
            }
        }
        let mut concerned = vec![false; joints.len()];
        for motion in motions.iter().filter(|motion| motion.links.len() > 1) {
            motion.links.iter().for_each(|k| concerned[*k] = true);
        }
        motions.iter_mut().for_each(|motion| motion.links.retain(|k| concerned[*k]));
        motions.retain(|motion| !motion.links.is_empty());
        SharedPartialVelocities { motions, concerned }
    }

    /// Returns true for a link whose partial velocities are stored in this collection.
    pub fn shares_partial_velocity(&self, link: usize) -> bool {
        self.concerned[link]
    }

    /// Adds the generalized forces of the wrenches on these links along their shared partial velocities.
    pub fn add_generalized_forces_of_wrenches(&self, wrenches: &[SpatialVector<'g>], out: &mut [Expr<'g>]) {
        for motion in &self.motions {
            let all = motion.links.iter().map(|k| wrenches[*k]).reduce(|sum, wrench| sum.plus(&wrench));
            if let Some(all) = all {
                let force = motion.along.dot(&all);
                out[motion.index] += force * force.num(motion.ratio);
            }
        }
    }

    /// Adds the entries of the mass matrix between the partial velocities of these links, given all links'
    /// inertias.
    pub fn add_mass_matrix_entries(&self, inertias: &[Inertia<'g>], m: &mut Matrix<'g>) {
        let mut sums: BTreeMap<Vec<usize>, Inertia<'g>> = BTreeMap::new();
        for (k, one) in self.motions.iter().enumerate() {
            for other in &self.motions[..=k] {
                let common = common_elements(&one.links, &other.links);
                let Some((first, rest)) = common.split_first() else { continue };
                let sum = sums.entry(common.clone()).or_insert_with(|| {
                    rest.iter().fold(inertias[*first], |sum, k| sum_of_inertias(&sum, &inertias[*k]))
                });
                let entry = other.along.dot(&momentum(sum, &one.along));
                let entry = entry * entry.num(one.ratio * other.ratio);
                m[one.index][other.index] += entry;
                if !std::ptr::eq(one, other) {
                    m[other.index][one.index] += entry;
                }
            }
        }
    }
}

/// Returns the common elements of two lists in descending order.
fn common_elements(a: &[usize], b: &[usize]) -> Vec<usize> {
    let mut b = b.iter().copied().peekable();
    let is_in_second_list = |k: &usize| {
        while b.next_if(|other| other > k).is_some() {}
        b.peek() == Some(k)
    };
    a.iter().copied().filter(is_in_second_list).collect()
}

/// Returns the component-wise sum; both inertias refer to the same point and axes.
fn sum_of_inertias<'g>(a: &Inertia<'g>, b: &Inertia<'g>) -> Inertia<'g> {
    let add_vectors = |a: [Expr<'g>; 3], b: [Expr<'g>; 3]| std::array::from_fn(|k| a[k] + b[k]);
    Inertia {
        mass: a.mass + b.mass,
        moment: a.moment + b.moment,
        tensor: Sym3 {
            diagonal: add_vectors(a.tensor.diagonal, b.tensor.diagonal),
            off: add_vectors(a.tensor.off, b.tensor.off),
        },
    }
}
