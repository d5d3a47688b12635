//! Joints of links: pose of a link relative to its parent, motion subspace, and the transformation of twists,
//! wrenches and mass properties across the joint. The motion subspace of a joint that is placed by
//! expressions of coordinates and time depends on these, and its motion may be prescribed in time.

use super::rates::{CachedDerivatives, coordinate_as_expression};
use super::spatial::{SpatialVector, map_spatial};
use crate::expr::replace::substitute_symbols;
use crate::expr::replace::symbols_in;
use crate::expr::{Expr, Graph, Rotation, Symbol, Vec3};
use crate::mechanism::{ConfigurationSpace, Coordinate, InQ, Inertia, Link, LinkId, Model, Motion, Quantity};

/// One degree of freedom of a joint: a column of its motion subspace, in link axes, which is constant except
/// for links placed by expressions.
#[derive(Clone, Debug)]
pub struct Dof<'g> {
    /// Index of the degree of freedom in `v`.
    pub index: usize,
    /// Joint velocity per unit of the entry of `v` that drives it.
    pub ratio: f64,
    /// Twist of the link per unit of joint velocity, in link axes.
    pub subspace: SpatialVector<'g>,
}

/// Joint of a link at a configuration: pose of the link relative to its parent, and motion subspace.
#[derive(Clone, Debug)]
pub struct Joint<'g> {
    /// Parent link; `None` for the ground.
    pub parent: Option<LinkId>,
    /// Orientation of the link relative to the parent link.
    pub rotation: Rotation<'g>,
    /// Origin of the link, in the parent's frame.
    pub translation: Vec3<'g>,
    /// Degrees of freedom of the joint, parent side first.
    pub dofs: Vec<Dof<'g>>,
    /// Additional motion of a link placed by expressions, whose motion subspace is not constant or which is
    /// driven in time.
    pub drift: Option<JointDrift<'g>>,
    /// Number of identical limbs that this joint connects to the parent, one in each SIMD lane of its
    /// expressions; one for an ordinary joint.
    pub limbs: usize,
}

/// Motion of a link in addition to the velocities of its coordinates, in link axes.
#[derive(Clone, Debug)]
pub struct JointDrift<'g> {
    /// Twist at zero velocities, different from zero if the link is driven in time.
    pub twist: SpatialVector<'g>,
    /// Time derivative of the components of the joint's twist at constant `v`.
    pub acceleration: SpatialVector<'g>,
    /// Time derivative of the components of each degree of freedom's subspace.
    pub subspace_rates: Vec<SpatialVector<'g>>,
}

impl<'g> Joint<'g> {
    /// Transforms a wrench on the link to the parent's origin and axes.
    pub fn wrench_to_parent(&self, w: &SpatialVector<'g>) -> SpatialVector<'g> {
        let force = self.rotation.vector_in_parent_axes(w.linear);
        let moment = self.rotation.vector_in_parent_axes(w.angular) + self.translation.cross(force);
        SpatialVector { linear: force, angular: moment }
    }

    /// Adds the wrench on the link to that on the parent, summed over identical limbs in lanes.
    pub fn add_wrench_to_parent(
        &self,
        parent: &SpatialVector<'g>,
        link: &SpatialVector<'g>,
    ) -> SpatialVector<'g> {
        let wrench = self.wrench_to_parent(link);
        parent.plus(&map_spatial(&wrench, |c| self.sum_over_limb_lanes(c)))
    }

    /// Returns the sum of an expression over identical limbs in SIMD lanes.
    pub fn sum_over_limb_lanes(&self, e: Expr<'g>) -> Expr<'g> {
        if self.limbs == 1 { e } else { e.lane_sum(self.limbs) }
    }

    /// Returns the combined mass properties of the parent and of the link, or of all identical limbs in SIMD
    /// lanes.
    pub fn add_inertia_to_parent(&self, parent: &Inertia<'g>, link: &Inertia<'g>) -> Inertia<'g> {
        if self.limbs == 1 {
            return parent.sum_with_placed_inertia(link, &self.rotation, self.translation);
        }
        let alone = Inertia::zero(parent.mass.graph()).sum_with_placed_inertia(
            link,
            &self.rotation,
            self.translation,
        );
        parent.plus(&Inertia {
            mass: self.sum_over_limb_lanes(alone.mass),
            moment: alone.moment.map(|c| self.sum_over_limb_lanes(c)),
            tensor: alone.tensor.map(|c| self.sum_over_limb_lanes(c)),
        })
    }

    /// Returns the parent's twist at the link's origin in link axes.
    pub fn twist_to_child(&self, parent: &SpatialVector<'g>) -> SpatialVector<'g> {
        SpatialVector {
            linear: self
                .rotation
                .vector_in_child_axes(parent.linear + parent.angular.cross(self.translation)),
            angular: self.rotation.vector_in_child_axes(parent.angular),
        }
    }

    /// Returns the joint's relative twist for the velocities `rates` (by entry of `v`), without motion
    /// prescribed in time.
    pub fn relative_twist(&self, model: &Model<'g>, rates: &[Expr<'g>]) -> SpatialVector<'g> {
        let mut sum = SpatialVector::zero(model);
        for dof in &self.dofs {
            sum = sum.plus(&dof.subspace.times_scalar(rates[dof.index] * model.graph.num(dof.ratio)));
        }
        sum
    }
}

impl<'g> Joint<'g> {
    /// Returns the joint's relative twist for the velocities `v`, including motion prescribed in time.
    pub fn twist_with_prescribed_motion(&self, model: &Model<'g>, v: &[Expr<'g>]) -> SpatialVector<'g> {
        let relative = self.relative_twist(model, v);
        self.drift.as_ref().map_or(relative, |drift| relative.plus(&drift.twist))
    }

    /// Returns the link's acceleration from its parent's twist and acceleration (`None` for the ground).
    pub fn link_acceleration(
        &self,
        model: &Model<'g>,
        parent: Option<(&SpatialVector<'g>, &SpatialVector<'g>)>,
        v: &[Expr<'g>],
        a: &[Expr<'g>],
    ) -> SpatialVector<'g> {
        let (rate, mut own) = (self.twist_with_prescribed_motion(model, v), self.relative_twist(model, a));
        if let Some(drift) = &self.drift {
            own = own.plus(&drift.acceleration);
        }
        let turning = rate.angular.cross(rate.linear);
        let Some((twist, parent)) = parent else {
            return SpatialVector { linear: own.linear + turning, angular: own.angular };
        };
        let w = self.rotation.vector_in_child_axes(twist.angular);
        let p = self.translation;
        let carried = parent.linear + parent.angular.cross(p) + twist.angular.cross(twist.angular.cross(p));
        SpatialVector {
            linear: self.rotation.vector_in_child_axes(carried)
                + (w + w).cross(rate.linear)
                + turning
                + own.linear,
            angular: self.rotation.vector_in_child_axes(parent.angular) + w.cross(rate.angular) + own.angular,
        }
    }
}

/// Returns the joints of all links at the configuration `q`.
pub fn joints_of_model<'g>(model: &Model<'g>) -> Vec<Joint<'g>> {
    let mut partials = CachedDerivatives::default();
    model.links.iter().map(|link| joint_of_link(model.configuration_space(), link, &mut partials)).collect()
}

/// Returns the joint of a link; `partials` caches derivatives of the preceding links.
pub fn joint_of_link<'g>(
    space: ConfigurationSpace<'_, 'g>,
    link: &Link<'g>,
    partials: &mut CachedDerivatives<'g>,
) -> Joint<'g> {
    let g = space.graph;
    let zero = Vec3::zero(g);
    let quaternion_components = |first: InQ| [0, 1, 2, 3].map(|k| (first + k).expr(g));
    let single_dof_list = |c: &Coordinate, linear, angular| {
        vec![Dof { index: c.v.0, ratio: c.ratio, subspace: SpatialVector { linear, angular } }]
    };
    let (motion, shift, dofs) = match &link.motion {
        Motion::Turn { axis, coordinate } => (
            Rotation::rotation_about_axis(*axis, coordinate_as_expression(g, coordinate)),
            zero,
            single_dof_list(coordinate, zero, *axis),
        ),
        Motion::Slide { axis, coordinate } => (
            Rotation::identity(g),
            *axis * coordinate_as_expression(g, coordinate),
            single_dof_list(coordinate, *axis, zero),
        ),
        Motion::Helix { axis, pitch, coordinate } => {
            let angle = coordinate_as_expression(g, coordinate);
            let shift = *axis * (*pitch * angle);
            (
                Rotation::rotation_about_axis(*axis, angle),
                shift,
                single_dof_list(coordinate, *axis * *pitch, *axis),
            )
        }
        Motion::Ball { q, v } => {
            let rotation = Rotation::from_quaternion(quaternion_components(*q));
            let dofs = (0..3).map(|k| axis_aligned_dof(g, v.0 + k, None, Some(k))).collect();
            (rotation, zero, dofs)
        }
        Motion::Free { q, v } => {
            let rotation = Rotation::from_quaternion(quaternion_components(*q + 3));
            let dofs = (0..6).map(|k| match k {
                0..3 => axis_aligned_dof(g, v.0 + k, Some(k), None),
                _ => axis_aligned_dof(g, v.0 + k, None, Some(k - 3)),
            });
            (rotation, Vec3([0, 1, 2].map(|k| (*q + k).expr(g))), dofs.collect())
        }
        Motion::Placed => return joint_from_placement(space, link, partials),
    };
    Joint {
        parent: link.parent,
        translation: link.placement.transform_point(shift),
        rotation: link.placement.rotation.clone().compose_with(&motion),
        dofs,
        drift: None,
        limbs: 1,
    }
}

/// Returns the joint of a link whose placement is an expression of coordinates and time. Its twist is the
/// time derivative of the placement, and its subspace consists of the derivatives of the twist with respect
/// to the velocities.
fn joint_from_placement<'g>(
    space: ConfigurationSpace<'_, 'g>,
    link: &Link<'g>,
    partials: &mut CachedDerivatives<'g>,
) -> Joint<'g> {
    let place = &link.placement;
    let twist = twist_of_placement(space, &place.rotation, place.translation, partials);
    let acceleration = map_spatial(&twist, |c| partials.time_derivative(space, c));
    let mut dofs = Vec::new();
    let mut subspace_rates = Vec::new();
    // The twist is linear in the velocities, so its value at zero velocities is the motion prescribed in
    // time.
    let drift = map_spatial(&twist, |c| substitute_zero_velocities(space.graph, c));
    for index in velocity_indices_in_twist(&twist) {
        let subspace = map_spatial(&twist, |c| partials.derivative(Quantity::Velocity(index).symbol(), c));
        subspace_rates.push(map_spatial(&subspace, |c| partials.time_derivative(space, c)));
        dofs.push(Dof { index, ratio: 1.0, subspace });
    }
    Joint {
        parent: link.parent,
        rotation: place.rotation.clone(),
        translation: place.translation,
        dofs,
        drift: Some(JointDrift { twist: drift, acceleration, subspace_rates }),
        limbs: 1,
    }
}

/// Returns the twist of a frame from the time derivatives of its placement, in the frame's axes: `Rᵀ ṗ`, and
/// `[ω]× = Rᵀ Ṙ`.
fn twist_of_placement<'g>(
    space: ConfigurationSpace<'_, 'g>,
    rotation: &Rotation<'g>,
    translation: Vec3<'g>,
    partials: &mut CachedDerivatives<'g>,
) -> SpatialVector<'g> {
    let angular = rotation.angular_velocity(&mut |e| partials.time_derivative(space, e));
    SpatialVector {
        linear: rotation.vector_in_child_axes(translation.map(|c| partials.time_derivative(space, c))),
        angular,
    }
}

fn velocity_indices_in_twist(twist: &SpatialVector<'_>) -> Vec<usize> {
    let all: Vec<Expr<'_>> = twist.linear.0.iter().chain(&twist.angular.0).copied().collect();
    let velocity_index_of_symbol = |s: Symbol| match Quantity::from_symbol(s) {
        Quantity::Velocity(k) => Some(k),
        _ => None,
    };
    symbols_in(&all).into_iter().filter_map(velocity_index_of_symbol).collect()
}

/// Returns an expression with all velocity symbols set to zero.
fn substitute_zero_velocities<'g>(graph: &'g Graph, e: Expr<'g>) -> Expr<'g> {
    substitute_symbols(e, &|s| {
        matches!(Quantity::from_symbol(s), Quantity::Velocity(_)).then(|| graph.zero())
    })
}

fn axis_aligned_dof<'g>(
    g: &'g Graph,
    index: usize,
    linear: Option<usize>,
    angular: Option<usize>,
) -> Dof<'g> {
    let axis_or_zero = |k: Option<usize>| k.map_or(Vec3::zero(g), |k| Vec3::coordinate_axis(g, k));
    Dof {
        index,
        ratio: 1.0,
        subspace: SpatialVector { linear: axis_or_zero(linear), angular: axis_or_zero(angular) },
    }
}
