//! Propagation from degrees of freedom to the root, several at a time as SIMD lanes. Degrees of freedom on
//! one path to the root are transformed by the same joints from the innermost of them on.

use crate::expr::{Expr, Vec3};
use crate::kinematics::{Joint, SpatialVector};

/// A quantity that a degree of freedom propagates to the root.
pub trait PropagatedQuantity<'g>: Sized {
    /// Combines the expressions of two propagated quantities entry by entry.
    fn zip_with(&self, other: &Self, f: &dyn Fn(Expr<'g>, Expr<'g>) -> Expr<'g>) -> Self;
    /// Transforms the propagated quantity to the parent's origin and axes.
    fn to_parent(&self, joint: &Joint<'g>) -> Self;
}

/// Algorithm that processes quantities while they are propagated from degrees of freedom to the root.
pub trait RootPropagationVisitor<'g> {
    /// Type of the quantity that is propagated from the links to the root.
    type Propagated: PropagatedQuantity<'g>;
    /// Returns the quantity that a degree of freedom propagates, in the frame of its own link.
    fn initial_quantity_of_dof(&mut self, dof: usize) -> Self::Propagated;
    /// Processes a group of degrees of freedom that has been transformed to another link.
    fn process_transformed_group(&mut self, group: &LaneGroup<Self::Propagated>);
}

/// Propagated quantities of several degrees of freedom, as SIMD lanes.
pub struct LaneGroup<T> {
    /// Index of the link that the quantities are given in.
    pub link: usize,
    /// Propagated quantities, in SIMD lanes if there are several.
    pub item: T,
    /// Degree of freedom of each quantity; `None` for a filler.
    members: Vec<Option<usize>>,
    /// Number of limbs that each propagated quantity covers as SIMD lanes.
    width: usize,
    /// Number of identical limbs in the expressions of the link.
    link_width: usize,
}

/// Paths from the links of the degrees of freedom to the root, with the groups that are propagated together.
pub struct PathsToRoot<'a, 'g> {
    joints: &'a [Joint<'g>],
    /// Number of identical limbs in the expressions of each link.
    widths: Vec<usize>,
    /// Link of each degree of freedom, parents first.
    links: Vec<usize>,
    /// Degrees of freedom that are propagated together, from the leaves to the root.
    groups: Vec<Vec<usize>>,
}

impl<'a, 'g> PathsToRoot<'a, 'g> {
    /// Returns the propagation paths of all degrees of freedom, in groups of at most `max_lanes` SIMD lanes;
    /// one lane disables grouping.
    pub fn new(joints: &'a [Joint<'g>], max_lanes: usize) -> PathsToRoot<'a, 'g> {
        let mut widths: Vec<usize> = Vec::with_capacity(joints.len());
        for joint in joints {
            let above = joint.parent.map_or(1, |p| widths[p.0]);
            widths.push(above.max(joint.limbs));
        }
        let links = joints.iter().enumerate().flat_map(|(k, joint)| joint.dofs.iter().map(move |_| k));
        let mut paths = PathsToRoot { joints, widths, links: links.collect(), groups: Vec::new() };
        paths.groups = match max_lanes {
            1 => (0..paths.links.len()).map(|dof| vec![dof]).collect(),
            _ => paths.dof_groups(max_lanes),
        };
        paths
    }

    /// Returns the link of each degree of freedom.
    pub fn links_of_freedoms(&self) -> &[usize] {
        &self.links
    }

    /// Divides the runs of degrees of freedom between branches into groups that are propagated together, in
    /// at most `max_lanes` SIMD lanes.
    fn dof_groups(&self, max_lanes: usize) -> Vec<Vec<usize>> {
        let mut groups = Vec::new();
        for run in self.dof_runs_between_branches().iter().filter(|run| !run.is_empty()) {
            let width = self.widths[self.links[run[0]]];
            let size = if width.is_power_of_two() { (max_lanes / width).max(1) } else { 1 };
            groups.extend(run.chunks(size).map(<[usize]>::to_vec));
        }
        groups
    }

    /// Returns runs of degrees of freedom from a leaf or a branch to the next branch, towards the root.
    fn dof_runs_between_branches(&self) -> Vec<Vec<usize>> {
        let mut children = vec![0; self.joints.len()];
        self.joints.iter().filter_map(|joint| joint.parent).for_each(|p| children[p.0] += 1);
        let mut runs: Vec<Vec<usize>> = Vec::new();
        // Run that each link continues.
        let mut run_of: Vec<Option<usize>> = vec![None; self.joints.len()];
        for (link, joint) in self.joints.iter().enumerate().rev() {
            let run = run_of[link].unwrap_or_else(|| {
                runs.push(Vec::new());
                runs.len() - 1
            });
            let first = self.links.partition_point(|l| *l < link);
            runs[run].extend((first..first + joint.dofs.len()).rev());
            if let Some(parent) = joint.parent
                && children[parent.0] == 1
                && self.widths[parent.0] == self.widths[link]
            {
                run_of[parent.0] = Some(run);
            }
        }
        runs
    }

    /// Propagates the quantities of all degrees of freedom to the root.
    pub fn propagate_to_root<V: RootPropagationVisitor<'g>>(&self, visitor: &mut V) {
        for group in &self.groups {
            let lanes = self.gather_group_quantities(group, visitor);
            self.transform_group_to_ancestor(lanes, None, visitor);
        }
    }

    /// Returns the quantities of a group in the frame of the link of its last degree of freedom.
    fn gather_group_quantities<V: RootPropagationVisitor<'g>>(
        &self,
        group: &[usize],
        visitor: &mut V,
    ) -> LaneGroup<V::Propagated> {
        if let [dof] = *group {
            let link = self.links[dof];
            let (width, item) = (self.widths[link], visitor.initial_quantity_of_dof(dof));
            return LaneGroup { link, item, members: vec![Some(dof)], width, link_width: width };
        }
        let half = group.len().next_power_of_two() / 2;
        let (far, near) = group.split_at(group.len() - half);
        let far = self.gather_group_quantities(far, visitor);
        let near = self.gather_group_quantities(near, visitor);
        let mut far = self.transform_group_to_ancestor(far, Some(near.link), visitor);
        while far.members.len() < half {
            far.item = far.concatenate_group_lanes(&far);
            far.members.resize(2 * far.members.len(), None);
        }
        LaneGroup {
            item: near.concatenate_group_lanes(&far),
            members: [near.members, far.members].concat(),
            ..near
        }
    }

    /// Transforms a group link by link to a link nearer to the root, or to the root.
    fn transform_group_to_ancestor<V: RootPropagationVisitor<'g>>(
        &self,
        mut group: LaneGroup<V::Propagated>,
        to: Option<usize>,
        visitor: &mut V,
    ) -> LaneGroup<V::Propagated> {
        while Some(group.link) != to
            && let Some(parent) = self.joints[group.link].parent
        {
            group.item = group.item.to_parent(&group.repeat_joint_for_members(&self.joints[group.link]));
            (group.link, group.link_width) = (parent.0, self.widths[parent.0]);
            visitor.process_transformed_group(&group);
        }
        group
    }
}

impl<T> LaneGroup<T> {
    /// Repeats an expression of the link for every member of the group.
    pub fn repeat_for_group_members<'g>(&self, e: Expr<'g>) -> Expr<'g> {
        let mut e = e;
        // An expression without lanes holds for all members.
        if self.link_width > 1 {
            for k in 0..self.members.len().trailing_zeros() {
                e = e.append_lanes(self.link_width << k, e);
            }
        }
        e
    }

    fn repeat_joint_for_members<'g>(&self, joint: &Joint<'g>) -> Joint<'g> {
        if self.members.len() == 1 || self.link_width == 1 {
            return joint.clone();
        }
        Joint {
            rotation: joint.rotation.map(&|e| self.repeat_for_group_members(e)),
            translation: joint.translation.map(|c| self.repeat_for_group_members(c)),
            ..joint.clone()
        }
    }

    /// Concatenates the SIMD lanes of two groups.
    fn concatenate_group_lanes<'g>(&self, other: &LaneGroup<T>) -> T
    where
        T: PropagatedQuantity<'g>,
    {
        let lanes = self.members.len() * self.width;
        self.item.zip_with(&other.item, &|a, b| a.append_lanes(lanes, b))
    }

    /// Returns the degree of freedom of each member with its lanes of an expression.
    pub fn lanes_of_members<'g>(&self, e: Expr<'g>) -> impl Iterator<Item = (usize, Expr<'g>)> {
        let (alone, width) = (self.members.len() == 1, self.width);
        let lanes_of_member = move |k: usize| if alone { e } else { lane_range(e, k * width, width) };
        self.members.iter().enumerate().filter_map(move |(k, member)| Some(((*member)?, lanes_of_member(k))))
    }
}

/// Returns `count` lanes of an expression, from lane `first` on; `count` is a power of two.
fn lane_range(e: Expr<'_>, first: usize, count: usize) -> Expr<'_> {
    match count {
        1 => e.lane(first),
        _ => lane_range(e, first, count / 2)
            .append_lanes(count / 2, lane_range(e, first + count / 2, count / 2)),
    }
}

impl<'g> PropagatedQuantity<'g> for SpatialVector<'g> {
    fn zip_with(&self, other: &Self, f: &dyn Fn(Expr<'g>, Expr<'g>) -> Expr<'g>) -> Self {
        SpatialVector {
            linear: self.linear.zip_with(&other.linear, f),
            angular: self.angular.zip_with(&other.angular, f),
        }
    }

    fn to_parent(&self, joint: &Joint<'g>) -> Self {
        joint.wrench_to_parent(self)
    }
}

impl<'g> PropagatedQuantity<'g> for Vec3<'g> {
    fn zip_with(&self, other: &Self, f: &dyn Fn(Expr<'g>, Expr<'g>) -> Expr<'g>) -> Self {
        Vec3(std::array::from_fn(|k| f(self[k], other[k])))
    }

    fn to_parent(&self, joint: &Joint<'g>) -> Self {
        joint.rotation.vector_in_parent_axes(*self)
    }
}
