//! Quantities from which loops of the runtime (`runtime/src/chains.rs`) compute the derivatives of inverse
//! dynamics. They are in the axes of the root and about its origin, so that the loops add up
//! quantities of several links without transforming them.

use super::ForceDerivatives;
use super::symbolic;
use crate::expr::{Expr, Vec3};
use crate::kinematics::{Dof, Joint, SpatialVector};
use crate::mechanism::{BLOCK_LENGTH, Inertia, LINK_QUANTITIES, LinkBlock, MASS_PROPERTIES, Model, Motion};

/// Number of velocities of a free root link.
const FREE_VELOCITIES: usize = 6;

/// Links in blocks, with the quantities that the loops need.
pub struct LinkBlocks<'g> {
    /// Blocks, parents first.
    pub blocks: Vec<LinkBlock>,
    /// True if the first block is a free root link.
    pub free: bool,
    /// For each block the quantities of its links, then for each block their mass properties; the lanes of a
    /// quantity are adjacent. The last three are the acceleration opposite to gravity in the axes of the
    /// root.
    pub quantities: Vec<Expr<'g>>,
    /// Derivatives of passive forces that are not zero: whether with respect to `v` instead of `q`, row,
    /// column, value.
    pub passive: Vec<(bool, usize, usize, Expr<'g>)>,
}

/// Returns the blocks of a mechanism at the accelerations `a`; `None` if the loops do not support it: a joint
/// has several degrees of freedom and is not that of a free root link, or velocities are shared by
/// joints or not in the order of the links.
pub fn link_blocks<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    a: &[Expr<'g>],
) -> Option<LinkBlocks<'g>> {
    let free = matches!(model.links.first()?.motion, Motion::Free { .. });
    let blocks = divide_links(joints, free, model.nv())?;
    let placements = placements_from_root(model, joints, free);
    let mut quantities = Vec::new();
    let zero = model.graph.zero();
    let mut push_lanes = |lanes: Vec<Vec<Expr<'g>>>, count: usize| {
        for k in 0..count {
            quantities.extend((0..BLOCK_LENGTH).map(|lane| lanes.get(lane).map_or(zero, |lane| lane[k])));
        }
    };
    for block in &blocks {
        push_lanes(
            links_and_dofs_of_block(block, joints)
                .map(|(link, dof)| link_quantities_in_root_axes(&placements[link], dof, [v, a]))
                .collect(),
            LINK_QUANTITIES,
        );
    }
    for block in &blocks {
        let lanes = links_and_dofs_of_block(block, joints).enumerate();
        let mass_properties_of_lane = |(lane, (link, _)): (usize, (usize, &Dof<'g>))| {
            // The mass properties of a free link are in its last lane only, which all others include.
            let counted = joints[link].dofs.len() == 1 || lane + 1 == block.count;
            let inertia = if counted { model.links[link].inertia } else { Inertia::zero(model.graph) };
            flattened_mass_properties(&inertia)
        };
        push_lanes(lanes.map(mass_properties_of_lane).collect(), MASS_PROPERTIES);
    }
    let upward = -model.gravity;
    let ground = if free { joints[0].rotation.vector_in_child_axes(upward) } else { upward };
    quantities.extend(ground.0);
    Some(LinkBlocks { blocks, free, quantities, passive: nonzero_passive_force_derivatives(model) })
}

/// Divides the links into blocks; `None` if the loops do not support their joints.
fn divide_links(joints: &[Joint<'_>], free: bool, nv: usize) -> Option<Vec<LinkBlock>> {
    let mut children = vec![0; joints.len()];
    joints.iter().filter_map(|joint| joint.parent).for_each(|p| children[p.0] += 1);
    let mut blocks: Vec<LinkBlock> = Vec::new();
    let mut block_of_link: Vec<usize> = Vec::new();
    let mut next = 0;
    for (k, joint) in joints.iter().enumerate() {
        let count = if free && k == 0 { FREE_VELOCITIES } else { 1 };
        let indices = joint.dofs.iter().map(|dof| dof.index);
        if !indices.eq(next..next + count) || joint.limbs != 1 || joint.drift.is_some() {
            return None;
        }
        let parent = joint.parent.map(|p| p.0);
        let follows = k > 0 && parent == Some(k - 1) && children[k - 1] == 1 && !(free && k == 1);
        match blocks.last_mut().filter(|block| follows && block.count < BLOCK_LENGTH) {
            Some(block) => block.count += count,
            None => {
                let parent = parent.map(|p| block_of_link[p]);
                let above = parent.and_then(|p| Some((p, blocks.get(p)?)));
                let ancestors = above.map_or_else(Vec::new, |(p, b)| [b.ancestors.as_slice(), &[p]].concat());
                let own = blocks.len();
                ancestors.iter().for_each(|b| blocks[*b].descendants.push(own));
                let descendants = Vec::new();
                blocks.push(LinkBlock { link: k, first: next, count, parent, ancestors, descendants });
            }
        }
        block_of_link.push(blocks.len() - 1);
        next += count;
    }
    (next == nv).then_some(blocks)
}

/// Returns link and degree of freedom of each lane of a block.
fn links_and_dofs_of_block<'a, 'g>(
    block: &LinkBlock,
    joints: &'a [Joint<'g>],
) -> impl Iterator<Item = (usize, &'a Dof<'g>)> {
    let joints = joints.iter().enumerate().skip(block.link);
    joints.flat_map(|(link, joint)| joint.dofs.iter().map(move |dof| (link, dof))).take(block.count)
}

/// Placement of a link in the axes of the root.
struct PlacementFromRoot<'g> {
    /// Rows of the rotation matrix.
    rows: [Vec3<'g>; 3],
    /// Position of the link's origin.
    position: Vec3<'g>,
}

/// Returns the placements of all links relative to a free root link, otherwise to the ground.
fn placements_from_root<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    free: bool,
) -> Vec<PlacementFromRoot<'g>> {
    let root_placement = || PlacementFromRoot {
        rows: [0, 1, 2].map(|k| Vec3::coordinate_axis(model.graph, k)),
        position: Vec3::zero(model.graph),
    };
    let ground = root_placement();
    let mut all: Vec<PlacementFromRoot<'g>> = Vec::with_capacity(joints.len());
    for joint in joints {
        let placed = match joint.parent {
            None if free => root_placement(),
            parent => {
                let above = parent.map_or(&ground, |p| &all[p.0]);
                PlacementFromRoot {
                    rows: above.rows.map(|row| joint.rotation.vector_in_child_axes(row)),
                    position: above.position + rotate_to_root_axes(&above.rows, joint.translation),
                }
            }
        };
        all.push(placed);
    }
    all
}

/// Returns a vector in the axes of the root, given the rows of the rotation matrix of its frame.
fn rotate_to_root_axes<'g>(rows: &[Vec3<'g>; 3], x: Vec3<'g>) -> Vec3<'g> {
    Vec3(rows.map(|row| row.dot(x)))
}

fn link_quantities_in_root_axes<'g>(
    place: &PlacementFromRoot<'g>,
    dof: &Dof<'g>,
    [v, a]: [&[Expr<'g>]; 2],
) -> Vec<Expr<'g>> {
    let SpatialVector { linear, angular } = dof.subspace.times_scalar(place.position[0].num(dof.ratio));
    let axis = rotate_to_root_axes(&place.rows, angular);
    let linear = rotate_to_root_axes(&place.rows, linear) + place.position.cross(axis);
    let rotation = place.rows.iter().flat_map(|row| row.0);
    let joint = [v[dof.index], a[dof.index]];
    linear.0.into_iter().chain(axis.0).chain(rotation).chain(place.position.0).chain(joint).collect()
}

fn flattened_mass_properties<'g>(inertia: &Inertia<'g>) -> Vec<Expr<'g>> {
    let [xy, xz, yz] = inertia.tensor.off;
    let own = [inertia.mass].into_iter().chain(inertia.moment.0);
    own.chain(inertia.tensor.diagonal).chain([yz, xz, xy]).collect()
}

fn nonzero_passive_force_derivatives<'g>(model: &Model<'g>) -> Vec<(bool, usize, usize, Expr<'g>)> {
    let ForceDerivatives { by_q, by_v } = symbolic::passive_force_state_derivatives(model);
    let mut all = Vec::new();
    for (by_velocity, matrix) in [(false, by_q), (true, by_v)] {
        for (i, row) in matrix.into_iter().enumerate() {
            let entries = row.into_iter().enumerate().filter(|(_, entry)| !entry.is_zero());
            all.extend(entries.map(|(j, entry)| (by_velocity, i, j, entry)));
        }
    }
    all
}
