//! Search for isomorphic limbs: subtrees on one link, or on the ground, with the same joints in the same
//! order.

use crate::expr::lanes::MAX_LANES;
use crate::kinematics::Joint;
use crate::mechanism::Model;
use std::collections::BTreeMap;

/// Set of isomorphic limbs that are evaluated in SIMD lanes.
#[derive(Clone, Debug)]
pub struct LimbGroup {
    /// Number of identical limbs in the group.
    pub limbs: usize,
    /// Corresponding links, one per lane, in the order of the first limb. The number of lanes is a power of
    /// two; the last limb fills the lanes beyond the number of limbs.
    pub rows: Vec<Vec<usize>>,
}

/// Shapes of subtrees: the kinds of their joints, link by link.
struct SubtreeShapes {
    children: Vec<Vec<usize>>,
    /// Shape of the subtree of each link: equal for isomorphic subtrees, zero for subtrees that cannot be
    /// limbs.
    shape: Vec<usize>,
}

/// Finds the groups of isomorphic limbs. No link is in two groups.
pub fn find_limb_groups(model: &Model<'_>, joints: &[Joint<'_>]) -> Vec<LimbGroup> {
    let shapes = SubtreeShapes::new(model, joints);
    let mut groups = Vec::new();
    let mut taken = vec![false; joints.len()];
    let roots: Vec<usize> = (0..joints.len()).filter(|k| joints[*k].parent.is_none()).collect();
    shapes.add_limb_groups(joints, &roots, &mut groups, &mut taken);
    for k in 0..joints.len() {
        if !taken[k] {
            shapes.add_limb_groups(joints, &shapes.children[k], &mut groups, &mut taken);
        }
    }
    groups
}

impl SubtreeShapes {
    fn new(model: &Model<'_>, joints: &[Joint<'_>]) -> SubtreeShapes {
        let mut children = vec![Vec::new(); joints.len()];
        for (k, joint) in joints.iter().enumerate() {
            if let Some(parent) = joint.parent {
                children[parent.0].push(k);
            }
        }
        let mut known: BTreeMap<(usize, Vec<usize>), usize> = BTreeMap::new();
        let mut shape = vec![0; joints.len()];
        for k in (0..joints.len()).rev() {
            let mut below: Vec<usize> = children[k].iter().map(|c| shape[*c]).collect();
            below.sort_unstable();
            let Some(kind) = model.links[k].motion.limb_motion_kind().filter(|_| !below.contains(&0)) else {
                continue;
            };
            let next = known.len() + 1;
            shape[k] = *known.entry((kind, below)).or_insert(next);
        }
        SubtreeShapes { children, shape }
    }

    /// Adds the groups of isomorphic limbs that begin at the children of one link.
    fn add_limb_groups(
        &self,
        joints: &[Joint<'_>],
        children: &[usize],
        groups: &mut Vec<LimbGroup>,
        taken: &mut [bool],
    ) {
        let mut left: Vec<usize> = children.iter().copied().filter(|k| self.shape[*k] != 0).collect();
        while let Some(&first) = left.first() {
            let mut roots: Vec<usize> = left
                .iter()
                .copied()
                .filter(|k| self.shape[*k] == self.shape[first])
                .take(MAX_LANES)
                .collect();
            left.retain(|k| !roots.contains(k));
            roots.retain(|k| is_uncoupled(joints, *k));
            if roots.len() < 2 {
                continue;
            }
            let mut rows = Vec::new();
            let limbs = roots.len();
            roots.resize(limbs.next_power_of_two(), roots[limbs - 1]);
            self.add_corresponding_links(roots, &mut rows);
            rows.iter().flatten().for_each(|k| taken[*k] = true);
            groups.push(LimbGroup { limbs, rows });
        }
    }

    /// Adds the rows of corresponding links of isomorphic subtrees, parents before their children. Each row
    /// has one link per subtree.
    fn add_corresponding_links(&self, roots: Vec<usize>, rows: &mut Vec<Vec<usize>>) {
        let mut todo = vec![roots];
        while let Some(row) = todo.pop() {
            let mut left: Vec<Vec<usize>> = row.iter().map(|k| self.children[*k].clone()).collect();
            let next = self.children[row[0]].iter().map(|child| {
                let corresponding = left.iter_mut().filter_map(|list| {
                    let at = list.iter().position(|c| self.shape[*c] == self.shape[*child])?;
                    Some(list.remove(at))
                });
                corresponding.collect()
            });
            let next: Vec<Vec<usize>> = next.collect();
            todo.extend(next.into_iter().rev());
            rows.push(row);
        }
    }
}

/// Returns true if no velocity of a limb moves a joint outside the limb.
fn is_uncoupled(joints: &[Joint<'_>], root: usize) -> bool {
    let mut inside = vec![false; joints.len()];
    inside[root] = true;
    for k in root + 1..joints.len() {
        inside[k] = joints[k].parent.is_some_and(|p| inside[p.0]);
    }
    let velocities_inside_or_outside = |is: bool| {
        let some = joints.iter().zip(&inside).filter(move |(_, inside)| **inside == is);
        some.flat_map(|(joint, _)| joint.dofs.iter().map(|d| d.index))
    };
    let own: Vec<usize> = velocities_inside_or_outside(true).collect();
    !velocities_inside_or_outside(false).any(|index| own.contains(&index))
}
