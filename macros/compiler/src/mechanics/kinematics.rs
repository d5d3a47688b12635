//! Joint transforms and motion subspaces; velocities of the links.

use super::{Spatial, position, rate};
use crate::expr::{Expr, Rotation, Vec3};
use crate::model::{Coordinate, LinkId, Model, Motion, Quantity};

/// One degree of freedom of a joint: a column of its motion subspace, constant in link axes.
#[derive(Clone, Debug)]
pub struct Dof<'g> {
    /// Entry of `v`.
    pub index: usize,
    /// Joint rate per entry of `v`.
    pub ratio: f64,
    /// Twist of the link per unit of joint rate, in link axes.
    pub subspace: Spatial<'g>,
}

/// A link's joint at a configuration: where the link is in its parent, and how it can move.
#[derive(Clone, Debug)]
pub struct Joint<'g> {
    /// Parent link.
    pub parent: Option<LinkId>,
    /// Orientation of the link in the parent link.
    pub rotation: Rotation<'g>,
    /// Origin of the link in the parent link.
    pub translation: Vec3<'g>,
    /// Degrees of freedom, parent side first.
    pub dofs: Vec<Dof<'g>>,
}

impl<'g> Joint<'g> {
    /// A wrench on the link, about the parent's origin in parent axes.
    pub fn wrench_to_parent(&self, w: &Spatial<'g>) -> Spatial<'g> {
        let force = self.rotation.to_parent(w.linear);
        let moment = self.rotation.to_parent(w.angular) + self.translation.cross(force);
        Spatial { linear: force, angular: moment }
    }

    /// The parent's twist, at the link's origin in link axes.
    pub fn twist_to_child(&self, parent: &Spatial<'g>) -> Spatial<'g> {
        Spatial {
            linear: self.rotation.to_child(parent.linear + parent.angular.cross(self.translation)),
            angular: self.rotation.to_child(parent.angular),
        }
    }

    /// The joint's own twist for given rates (by entry of `v`).
    pub fn relative(&self, model: &Model<'g>, rates: &[Expr<'g>]) -> Spatial<'g> {
        let mut sum = Spatial::zero(model);
        for dof in &self.dofs {
            sum = sum.plus(&dof.subspace.times(rates[dof.index] * model.graph.num(dof.ratio)));
        }
        sum
    }
}

/// The joints of all links, at the configuration `q`.
pub fn joints<'g>(model: &Model<'g>) -> Vec<Joint<'g>> {
    model.links.iter().map(|link| joint(model, link)).collect()
}

fn joint<'g>(model: &Model<'g>, link: &crate::model::Link<'g>) -> Joint<'g> {
    let g = model.graph;
    let zero = Vec3::zero(g);
    let q = |k: usize| Quantity::Configuration(k).expr(g);
    let single = |c: &Coordinate, linear, angular| {
        vec![Dof { index: c.v, ratio: c.ratio, subspace: Spatial { linear, angular } }]
    };
    let (motion, shift, dofs) = match &link.motion {
        Motion::Turn { axis, coordinate } => {
            (Rotation::eigenaxis(*axis, position(model, coordinate)), zero, single(coordinate, zero, *axis))
        }
        Motion::Slide { axis, coordinate } => {
            (Rotation::identity(g), *axis * position(model, coordinate), single(coordinate, *axis, zero))
        }
        Motion::Helix { axis, pitch, coordinate } => {
            let angle = position(model, coordinate);
            let shift = *axis * (*pitch * angle);
            (Rotation::eigenaxis(*axis, angle), shift, single(coordinate, *axis * *pitch, *axis))
        }
        Motion::Ball { q: first, v } => {
            let rotation = Rotation::quaternion([q(*first), q(first + 1), q(first + 2), q(first + 3)]);
            let dofs = (0..3).map(|k| unit_dof(model, v + k, None, Some(k))).collect();
            (rotation, zero, dofs)
        }
        Motion::Free { q: first, v } => {
            let rotation = Rotation::quaternion([q(first + 3), q(first + 4), q(first + 5), q(first + 6)]);
            let dofs = (0..6).map(|k| match k {
                0..3 => unit_dof(model, v + k, Some(k), None),
                _ => unit_dof(model, v + k, None, Some(k - 3)),
            });
            (rotation, Vec3([q(*first), q(first + 1), q(first + 2)]), dofs.collect())
        }
    };
    Joint {
        parent: link.parent,
        translation: link.placement.point(shift),
        rotation: link.placement.rotation.clone().then(&motion),
        dofs,
    }
}

fn unit_dof<'g>(model: &Model<'g>, index: usize, linear: Option<usize>, angular: Option<usize>) -> Dof<'g> {
    let axis = |k: Option<usize>| k.map_or(Vec3::zero(model.graph), |k| Vec3::axis(model.graph, k));
    Dof { index, ratio: 1.0, subspace: Spatial { linear: axis(linear), angular: axis(angular) } }
}

/// Twists of all links (velocity of the origin, angular velocity; link axes) for rates `v`.
pub fn twists<'g>(model: &Model<'g>, joints: &[Joint<'g>], v: &[Expr<'g>]) -> Vec<Spatial<'g>> {
    let mut twists: Vec<Spatial<'g>> = Vec::with_capacity(joints.len());
    for joint in joints {
        let own = joint.relative(model, v);
        twists.push(match joint.parent {
            None => own,
            Some(p) => joint.twist_to_child(&twists[p.0]).plus(&own),
        });
    }
    twists
}

/// Sum of the generalized forces of springs, dashpots and friction, with the sign of `h`: what resists motion is positive.
pub fn resistance<'g>(model: &Model<'g>, with_velocity: bool) -> Vec<Expr<'g>> {
    let g = model.graph;
    let mut h = vec![g.zero(); model.nv()];
    for spring in &model.springs {
        let stretch = position(model, &spring.on) - spring.free;
        h[spring.on.v] += spring.stiffness * stretch * g.num(spring.on.ratio);
    }
    if with_velocity {
        for dashpot in &model.dashpots {
            h[dashpot.on.v] += dashpot.damping * rate(model, &dashpot.on) * g.num(dashpot.on.ratio);
        }
        for dry in &model.frictions {
            let slip = (rate(model, &dry.on) / model.friction_speed).call(crate::expr::Function::Tanh);
            h[dry.on.v] += dry.friction * slip * g.num(dry.on.ratio);
        }
    }
    h
}
