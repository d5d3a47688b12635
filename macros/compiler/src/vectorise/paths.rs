//! What degrees of freedom bring to their ancestors. What those propagate that follow each other on a path to the root pass
//! the same joints once the last of them is passed: several at once, as the lanes of one.

use crate::expr::{Expr, Vec3};
use crate::kinematics::{Joint, Spatial};

/// What a degree of freedom propagates to the root.
pub trait Propagated<'g>: Sized {
    /// It with all expressions replaced by what is made of them and of those of another.
    fn with(&self, other: &Self, f: &dyn Fn(Expr<'g>, Expr<'g>) -> Expr<'g>) -> Self;
    /// About the parent's origin, in its axes.
    fn moved(&self, joint: &Joint<'g>) -> Self;
}

/// What is done on the way.
pub trait Visitor<'g> {
    /// What is propagated.
    type Item: Propagated<'g>;
    /// What a degree of freedom propagates, on its own link.
    fn start(&mut self, dof: usize) -> Self::Item;
    /// A group has come to another link.
    fn visit(&mut self, group: &LaneGroup<Self::Item>);
}

/// What several degrees of freedom propagate, side by side.
pub struct LaneGroup<T> {
    /// Where it is: a link.
    pub link: usize,
    /// What is propagated, in lanes if there are several.
    pub item: T,
    /// Whose they are; none where lanes are filled up.
    members: Vec<Option<usize>>,
    /// How many limbs are side by side in each.
    width: usize,
    /// How many are in the expressions of the link.
    here: usize,
}

/// Degrees of freedom on their paths to the root.
pub struct Paths<'a, 'g> {
    joints: &'a [Joint<'g>],
    /// By link: how many limbs are side by side in its expressions.
    widths: Vec<usize>,
    /// The link of each degree of freedom, parents first.
    links: Vec<usize>,
    /// Degrees of freedom that are propagated together, from the leaves to the root.
    groups: Vec<Vec<usize>>,
}

impl<'a, 'g> Paths<'a, 'g> {
    /// For all degrees of freedom, joint by joint; in up to `most` lanes, one for none.
    pub fn of(joints: &'a [Joint<'g>], most: usize) -> Paths<'a, 'g> {
        let mut widths: Vec<usize> = Vec::with_capacity(joints.len());
        for joint in joints {
            let above = joint.parent.map_or(1, |p| widths[p.0]);
            widths.push(above.max(joint.limbs));
        }
        let links = joints.iter().enumerate().flat_map(|(k, joint)| joint.dofs.iter().map(move |_| k));
        let mut paths = Paths { joints, widths, links: links.collect(), groups: Vec::new() };
        paths.groups = match most {
            1 => (0..paths.links.len()).map(|dof| vec![dof]).collect(),
            _ => paths.groups_of(most),
        };
        paths
    }

    /// The link of each degree of freedom.
    pub fn links(&self) -> &[usize] {
        &self.links
    }

    fn groups_of(&self, most: usize) -> Vec<Vec<usize>> {
        let mut groups = Vec::new();
        for run in self.runs().iter().filter(|run| !run.is_empty()) {
            let width = self.widths[self.links[run[0]]];
            let together = if width.is_power_of_two() { (most / width).max(1) } else { 1 };
            groups.extend(run.chunks(together).map(<[usize]>::to_vec));
        }
        groups
    }

    /// The degrees of freedom between a branch or a leaf and the next branch, towards the root.
    fn runs(&self) -> Vec<Vec<usize>> {
        let mut children = vec![0; self.joints.len()];
        self.joints.iter().filter_map(|joint| joint.parent).for_each(|p| children[p.0] += 1);
        let mut runs: Vec<Vec<usize>> = Vec::new();
        // By link: the run that it continues.
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

    /// Propagates everything to the root.
    pub fn propagate<V: Visitor<'g>>(&self, visitor: &mut V) {
        for group in &self.groups {
            let lanes = self.together(group, visitor);
            self.moved(lanes, None, visitor);
        }
    }

    /// What a group propagates, on the link of the last.
    fn together<V: Visitor<'g>>(&self, group: &[usize], visitor: &mut V) -> LaneGroup<V::Item> {
        if let [dof] = *group {
            let link = self.links[dof];
            let (width, item) = (self.widths[link], visitor.start(dof));
            return LaneGroup { link, item, members: vec![Some(dof)], width, here: width };
        }
        let half = group.len().next_power_of_two() / 2;
        let (far, near) = group.split_at(group.len() - half);
        let far = self.together(far, visitor);
        let near = self.together(near, visitor);
        let mut far = self.moved(far, Some(near.link), visitor);
        while far.members.len() < half {
            far.item = far.joined(&far);
            far.members.resize(2 * far.members.len(), None);
        }
        LaneGroup { item: near.joined(&far), members: [near.members, far.members].concat(), ..near }
    }

    /// A group on a link nearer to the root, or on the root.
    fn moved<V: Visitor<'g>>(
        &self,
        mut group: LaneGroup<V::Item>,
        to: Option<usize>,
        visitor: &mut V,
    ) -> LaneGroup<V::Item> {
        while Some(group.link) != to
            && let Some(parent) = self.joints[group.link].parent
        {
            group.item = group.item.moved(&group.spread_joint(&self.joints[group.link]));
            (group.link, group.here) = (parent.0, self.widths[parent.0]);
            visitor.visit(&group);
        }
        group
    }
}

impl<T> LaneGroup<T> {
    /// An expression of the link for every member.
    pub fn spread<'g>(&self, e: Expr<'g>) -> Expr<'g> {
        let mut e = e;
        // What is the same for all limbs is so for all members.
        if self.here > 1 {
            for k in 0..self.members.len().trailing_zeros() {
                e = e.joined(self.here << k, e);
            }
        }
        e
    }

    fn spread_joint<'g>(&self, joint: &Joint<'g>) -> Joint<'g> {
        if self.members.len() == 1 || self.here == 1 {
            return joint.clone();
        }
        Joint {
            rotation: joint.rotation.map(&|e| self.spread(e)),
            translation: joint.translation.map(|c| self.spread(c)),
            ..joint.clone()
        }
    }

    /// Its lanes, then those of another.
    fn joined<'g>(&self, other: &LaneGroup<T>) -> T
    where
        T: Propagated<'g>,
    {
        let lanes = self.members.len() * self.width;
        self.item.with(&other.item, &|a, b| a.joined(lanes, b))
    }

    /// The members, each with what of an expression is its own.
    pub fn parts<'g>(&self, e: Expr<'g>) -> impl Iterator<Item = (usize, Expr<'g>)> {
        let (alone, width) = (self.members.len() == 1, self.width);
        let part = move |k: usize| if alone { e } else { lanes(e, k * width, width) };
        self.members.iter().enumerate().filter_map(move |(k, member)| Some(((*member)?, part(k))))
    }
}

/// So many lanes of an expression, a power of two.
fn lanes(e: Expr<'_>, first: usize, count: usize) -> Expr<'_> {
    match count {
        1 => e.lane(first),
        _ => lanes(e, first, count / 2).joined(count / 2, lanes(e, first + count / 2, count / 2)),
    }
}

impl<'g> Propagated<'g> for Spatial<'g> {
    fn with(&self, other: &Self, f: &dyn Fn(Expr<'g>, Expr<'g>) -> Expr<'g>) -> Self {
        Spatial { linear: self.linear.with(&other.linear, f), angular: self.angular.with(&other.angular, f) }
    }

    fn moved(&self, joint: &Joint<'g>) -> Self {
        joint.wrench_to_parent(self)
    }
}

impl<'g> Propagated<'g> for Vec3<'g> {
    fn with(&self, other: &Self, f: &dyn Fn(Expr<'g>, Expr<'g>) -> Expr<'g>) -> Self {
        Vec3(std::array::from_fn(|k| f(self[k], other[k])))
    }

    fn moved(&self, joint: &Joint<'g>) -> Self {
        joint.rotation.to_parent(*self)
    }
}
