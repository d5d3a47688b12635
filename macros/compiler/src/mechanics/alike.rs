//! Links that coordinates move alike: particles placed by sums over the coordinates before them have the same partial velocities.
//! What they are multiplied with is summed over the links first: `Σ sᵀ Wₖ = sᵀ Σ Wₖ`, and `Σ sᵀ Iₖ r = sᵀ (Σ Iₖ) r`, so that a
//! chain of `n` takes `n²` operations for its mass matrix instead of `n³`.

use super::crba::{Matrix, momentum};
use crate::expr::{Expr, Id, Sym3};
use crate::kinematics::{Joint, Spatial};
use crate::mechanism::{Inertia, Model, Motion};
use std::collections::BTreeMap;

/// The motions of links that are placed by expressions, those once that several links share; none if no two do.
pub struct Alike<'g> {
    motions: Vec<SharedMotion<'g>>,
    /// By link: it has one that another has, too.
    concerned: Vec<bool>,
}

/// How an entry of `v` moves some links, or how that changes: in the axes of each of them.
struct SharedMotion<'g> {
    index: usize,
    ratio: f64,
    along: Spatial<'g>,
    /// From the last to the first: sums over links from one on are then partial sums of others.
    links: Vec<usize>,
}

impl<'g> Alike<'g> {
    /// By motion subspaces.
    pub fn of(model: &Model<'g>, joints: &[Joint<'g>]) -> Alike<'g> {
        Alike::by(model, joints, |joint, dof| Some(joint.dofs[dof].subspace))
    }

    /// By the rates of motion subspaces.
    pub fn by_rates(model: &Model<'g>, joints: &[Joint<'g>]) -> Alike<'g> {
        Alike::by(model, joints, |joint, dof| joint.drift.as_ref()?.subspace_rates.get(dof).copied())
    }

    fn by(
        model: &Model<'g>,
        joints: &[Joint<'g>],
        along: impl Fn(&Joint<'g>, usize) -> Option<Spatial<'g>>,
    ) -> Alike<'g> {
        let mut motions: Vec<SharedMotion<'g>> = Vec::new();
        let mut known: BTreeMap<(usize, u64, Vec<Id>), usize> = BTreeMap::new();
        // What hangs from other links is carried to them, and limbs side by side are summed on the way.
        let is_placed = |k: usize| {
            let (link, joint) = (&model.links[k], &joints[k]);
            matches!(link.motion, Motion::Placed) && joint.parent.is_none() && joint.limbs == 1
        };
        for (k, joint) in joints.iter().enumerate().rev().filter(|(k, _)| is_placed(*k)) {
            for (place, dof) in joint.dofs.iter().enumerate() {
                let Some(along) = along(joint, place) else { continue };
                let ids = along.linear.0.iter().chain(&along.angular.0).map(|e| e.id()).collect();
                let next = motions.len();
                match *known.entry((dof.index, dof.ratio.to_bits(), ids)).or_insert(next) {
                    motion if motion < next => motions[motion].links.push(k),
                    _ => motions.push(SharedMotion {
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
        Alike { motions, concerned }
    }

    /// True for a link whose motions stand here.
    pub fn has(&self, link: usize) -> bool {
        self.concerned[link]
    }

    /// Adds what wrenches on those links do along their motions.
    pub fn add_forces(&self, wrenches: &[Spatial<'g>], out: &mut [Expr<'g>]) {
        for motion in &self.motions {
            let all = motion.links.iter().map(|k| wrenches[*k]).reduce(|sum, wrench| sum.plus(&wrench));
            if let Some(all) = all {
                let force = motion.along.dot(&all);
                out[motion.index] += force * force.num(motion.ratio);
            }
        }
    }

    /// Adds the entries of the mass matrix between the motions of those links, which have these inertias.
    pub fn add_masses(&self, inertias: &[Inertia<'g>], m: &mut Matrix<'g>) {
        let mut sums: BTreeMap<Vec<usize>, Inertia<'g>> = BTreeMap::new();
        for (k, one) in self.motions.iter().enumerate() {
            for other in &self.motions[..=k] {
                let common = common(&one.links, &other.links);
                let Some((first, rest)) = common.split_first() else { continue };
                let sum = sums.entry(common.clone()).or_insert_with(|| {
                    rest.iter().fold(inertias[*first], |sum, k| plus(&sum, &inertias[*k]))
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

/// What two lists have in common that fall both.
fn common(a: &[usize], b: &[usize]) -> Vec<usize> {
    let mut b = b.iter().copied().peekable();
    let is_in_b = |k: &usize| {
        while b.next_if(|other| other > k).is_some() {}
        b.peek() == Some(k)
    };
    a.iter().copied().filter(is_in_b).collect()
}

/// The sum, number by number: nothing is moved.
fn plus<'g>(a: &Inertia<'g>, b: &Inertia<'g>) -> Inertia<'g> {
    let sums = |a: [Expr<'g>; 3], b: [Expr<'g>; 3]| std::array::from_fn(|k| a[k] + b[k]);
    Inertia {
        mass: a.mass + b.mass,
        moment: a.moment + b.moment,
        tensor: Sym3 {
            diagonal: sums(a.tensor.diagonal, b.tensor.diagonal),
            off: sums(a.tensor.off, b.tensor.off),
        },
    }
}
