//! Forward dynamics by the articulated-body algorithm (Featherstone 1983, 2008, ch. 7). The algorithm acts on
//! the forces that the bias does not balance: with `r = τ − h(q, v)`, the accelerations are those of the
//! mechanism at rest without gravity, so that the recursion has no velocity terms.

use super::ldl::inverse_of_second_ldl_pivot;
use super::supports_articulated_body_algorithm;
use crate::expr::{Expr, Mat3, Sym3, Vec3};
use crate::kinematics::{Dof, Joint, SpatialVector};
use crate::mechanics::passive::passive_forces;
use crate::mechanism::{Inertia, Model};

/// Returns `M⁻¹ r`, or `None` for a mechanism with coupled coordinates.
pub fn inverse_mass_times_vector<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    r: &[Expr<'g>],
) -> Option<Vec<Expr<'g>>> {
    solve_articulated(model, joints, vec![SpatialVector::zero(model); joints.len()], r)
}

/// Returns `v̇ = M⁻¹ (τ − h)`, or `None` for a mechanism with coupled coordinates.
///
/// `wrenches` holds the wrench that each link needs when all joint accelerations are zero (`rnea::wrenches`).
/// The inward pass of this recursion sums them, so no separate recursion computes the bias first.
pub fn forward_dynamics<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    wrenches: Vec<SpatialVector<'g>>,
    tau: &[Expr<'g>],
) -> Option<Vec<Expr<'g>>> {
    let r: Vec<Expr<'g>> = tau.iter().zip(passive_forces(model, true)).map(|(t, h)| *t - h).collect();
    solve_articulated(model, joints, wrenches, &r)
}

fn solve_articulated<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    mut wrenches: Vec<SpatialVector<'g>>,
    r: &[Expr<'g>],
) -> Option<Vec<Expr<'g>>> {
    if !supports_articulated_body_algorithm(model) {
        return None;
    }
    let mut inertias: Vec<ArticulatedInertia<'g>> =
        model.links.iter().map(|l| ArticulatedInertia::from_rigid_inertia(&l.inertia)).collect();
    let mut handles: Vec<Vec<EliminatedDof<'g>>> = vec![Vec::new(); joints.len()];
    for (k, joint) in joints.iter().enumerate().rev() {
        let (mut inertia, mut wrench) = (inertias[k], wrenches[k]);
        let mut inverse = None;
        for (place, dof) in joint.dofs.iter().enumerate().rev() {
            let next = place.checked_sub(1).map(|next| &joint.dofs[next]).filter(|_| inverse.is_none());
            let handle = EliminatedDof::new(dof, &inertia, &wrench, r[dof.index], inverse);
            inverse = next.and_then(|next| inertia.second_pivot_inverse(&dof.subspace, &next.subspace));
            // The reduced inertia after the last elimination of a root is used by no later step.
            inertia.eliminate_dof(&handle);
            wrench = handle.wrench_transmitted_to_parent(&wrench);
            handles[k].push(handle);
        }
        if let Some(parent) = joint.parent {
            inertias[parent.0] = inertia.add_to_parent(joint, &inertias[parent.0]);
            wrenches[parent.0] = joint.add_wrench_to_parent(&wrenches[parent.0], &wrench);
        }
    }
    Some(outward_recursion(model, joints, &handles))
}

fn outward_recursion<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    handles: &[Vec<EliminatedDof<'g>>],
) -> Vec<Expr<'g>> {
    let mut result = vec![model.graph.zero(); model.nv()];
    let mut motions: Vec<SpatialVector<'g>> = Vec::with_capacity(joints.len());
    for (k, joint) in joints.iter().enumerate() {
        let mut motion =
            joint.parent.map_or(SpatialVector::zero(model), |p| joint.twist_to_child(&motions[p.0]));
        for (dof, handle) in joint.dofs.iter().zip(handles[k].iter().rev()) {
            (result[dof.index], motion) = handle.acceleration_of_dof(&dof.subspace, &motion);
        }
        motions.push(motion);
    }
    result
}

/// Quantities of one eliminated degree of freedom (a *handle*): `U = IA s`, `U / D`, `u / D`, with
/// `D = s · U` and `u = r − s · pA`.
///
/// If `s` is one of the six coordinate axes, `U` is stored with a zero in the entry of this axis, which would
/// be `D`. The transmitted wrench has the entry `r` there, because `s · (pA + U u / D) = r`. The acceleration
/// along the axis is `(u − U · a) / D`, independent of the parent's acceleration along the axis.
#[derive(Clone)]
struct EliminatedDof<'g> {
    axis: Option<SpatialCoordinateAxis>,
    column: SpatialVector<'g>,
    scaled: SpatialVector<'g>,
    effort: Expr<'g>,
    r: Expr<'g>,
}

/// One of the six coordinate axes of spatial vectors, linear axes first, with its sign.
#[derive(Clone, Copy)]
struct SpatialCoordinateAxis {
    entry: usize,
    backwards: bool,
}

impl SpatialCoordinateAxis {
    fn coordinate_axis_of_subspace(s: &SpatialVector<'_>) -> Option<SpatialCoordinateAxis> {
        let mut nonzero = (0..6).filter(|e| !spatial_entry(s, *e).is_zero());
        let first = nonzero.next()?;
        let value = spatial_entry(s, first).constant_value().filter(|c| c.abs() == 1.0)?;
        nonzero.next().is_none().then_some(SpatialCoordinateAxis { entry: first, backwards: value < 0.0 })
    }

    fn apply_sign<'g>(self, e: Expr<'g>) -> Expr<'g> {
        if self.backwards { -e } else { e }
    }
}

fn spatial_entry<'g>(s: &SpatialVector<'g>, e: usize) -> Expr<'g> {
    if e < 3 { s.linear[e] } else { s.angular[e - 3] }
}

fn with_spatial_entry<'g>(mut s: SpatialVector<'g>, e: usize, value: Expr<'g>) -> SpatialVector<'g> {
    if e < 3 {
        s.linear.0[e] = value;
    } else {
        s.angular.0[e - 3] = value;
    }
    s
}

impl<'g> EliminatedDof<'g> {
    /// Eliminates one degree of freedom from an articulated inertia. `inverse` is `1 / D` if it has already
    /// been computed.
    fn new(
        dof: &Dof<'g>,
        inertia: &ArticulatedInertia<'g>,
        wrench: &SpatialVector<'g>,
        r: Expr<'g>,
        inverse: Option<Expr<'g>>,
    ) -> EliminatedDof<'g> {
        let axis = SpatialCoordinateAxis::coordinate_axis_of_subspace(&dof.subspace);
        let mut column = inertia.multiply_by_motion(&dof.subspace);
        let inverse = inverse.unwrap_or_else(|| r.num(1.0) / dof.subspace.dot(&column));
        if let Some(axis) = axis {
            column = with_spatial_entry(column, axis.entry, r.zero());
        }
        let effort = (r - dof.subspace.dot(wrench)) * inverse;
        EliminatedDof { axis, column, scaled: column.times_scalar(inverse), effort, r }
    }

    /// Returns the wrench that the joint transmits towards the parent.
    fn wrench_transmitted_to_parent(&self, wrench: &SpatialVector<'g>) -> SpatialVector<'g> {
        let sum = wrench.plus(&self.column.times_scalar(self.effort));
        self.axis.map_or(sum, |axis| with_spatial_entry(sum, axis.entry, axis.apply_sign(self.r)))
    }

    /// Returns the acceleration of the degree of freedom, and the link's motion including it.
    fn acceleration_of_dof(
        &self,
        subspace: &SpatialVector<'g>,
        motion: &SpatialVector<'g>,
    ) -> (Expr<'g>, SpatialVector<'g>) {
        let a = self.effort - self.scaled.dot(motion);
        match self.axis {
            Some(axis) => {
                let before = axis.apply_sign(spatial_entry(motion, axis.entry));
                (a - before, with_spatial_entry(*motion, axis.entry, axis.apply_sign(a)))
            }
            None => (a, motion.plus(&subspace.times_scalar(a))),
        }
    }
}

/// Articulated-body inertia: force `M a + Hᵀ w` and moment `H a + I w` for an acceleration `(a, w)` of the
/// origin.
#[derive(Clone, Copy)]
struct ArticulatedInertia<'g> {
    m: Sym3<'g>,
    h: Mat3<'g>,
    i: Sym3<'g>,
}

impl<'g> ArticulatedInertia<'g> {
    fn from_rigid_inertia(inertia: &Inertia<'g>) -> ArticulatedInertia<'g> {
        ArticulatedInertia {
            m: Sym3::multiple_of_identity(inertia.mass),
            h: Mat3::skew(inertia.moment),
            i: inertia.tensor,
        }
    }

    fn multiply_by_motion(&self, s: &SpatialVector<'g>) -> SpatialVector<'g> {
        SpatialVector {
            linear: self.m * s.linear + self.h.transpose() * s.angular,
            angular: self.h * s.linear + self.i * s.angular,
        }
    }

    /// Returns `1 / D` of the second degree of freedom after elimination of the first, or `None` if the
    /// inertia does not couple the two, see [`inverse_of_second_ldl_pivot`].
    fn second_pivot_inverse(
        &self,
        first: &SpatialVector<'g>,
        second: &SpatialVector<'g>,
    ) -> Option<Expr<'g>> {
        let column = self.multiply_by_motion(first);
        inverse_of_second_ldl_pivot(
            first.dot(&column),
            second.dot(&column),
            second.dot(&self.multiply_by_motion(second)),
        )
    }

    /// Subtracts `U Uᵀ / D`. If the joint leaves a coordinate axis free, the row and column of that axis are
    /// then exactly zero.
    fn eliminate_dof(&mut self, handle: &EliminatedDof<'g>) {
        let (f, n) = (handle.column.linear, handle.column.angular);
        let outer_product = |a: Vec3<'g>, b: Vec3<'g>| Mat3::from_fn(|i, j| a[i] * b[j]);
        self.m = self.m - Sym3::from_upper(&outer_product(handle.scaled.linear, f));
        self.h = self.h - outer_product(handle.scaled.angular, f);
        self.i = self.i - Sym3::from_upper(&outer_product(handle.scaled.angular, n));
        let zero = handle.r.zero();
        match handle.axis {
            Some(SpatialCoordinateAxis { entry: k @ 0..3, .. }) => {
                for row in &mut self.h.0 {
                    row[k] = zero;
                }
                clear_row_and_column(&mut self.m, k);
            }
            Some(SpatialCoordinateAxis { entry, .. }) => {
                self.h.0[entry - 3] = [zero; 3];
                clear_row_and_column(&mut self.i, entry - 3);
            }
            None => {}
        }
    }

    /// Adds the inertia, transformed to the parent's origin and axes, to `sum`.
    ///
    /// `H' = H + [p]× M`, `I' = I − H [p]× − (H' [p]×)ᵀ`.
    fn add_to_parent(self, joint: &Joint<'g>, sum: &ArticulatedInertia<'g>) -> ArticulatedInertia<'g> {
        let m = joint.rotation.symmetric_tensor_in_parent_axes(self.m);
        let h = joint.rotation.tensor_in_parent_axes(self.h);
        let i = joint.rotation.symmetric_tensor_in_parent_axes(self.i);
        let p = Mat3::skew(joint.translation);
        let moved = h + p * m.full_matrix();
        let entry_of_product = |h: &Mat3<'g>, row: usize, column: usize| h.row(row).dot(p.column(column));
        let both = h + moved;
        let shift = Sym3 {
            diagonal: std::array::from_fn(|k| entry_of_product(&both, k, k)),
            off: [(0, 1), (0, 2), (1, 2)]
                .map(|(a, b)| entry_of_product(&h, a, b) + entry_of_product(&moved, b, a)),
        };
        let sum_over_lanes = |e| joint.sum_over_limb_lanes(e);
        let moved = Mat3::from_fn(|i, j| sum_over_lanes(moved.0[i][j]));
        ArticulatedInertia {
            m: sum.m + m.map(sum_over_lanes),
            h: sum.h + moved,
            i: sum.i + (i - shift).map(sum_over_lanes),
        }
    }
}

fn clear_row_and_column(s: &mut Sym3<'_>, k: usize) {
    let zero = s.diagonal[k].zero();
    s.diagonal[k] = zero;
    // The off-diagonal entries are xy, xz, yz. Those of axis k are the two whose indices include k.
    for (entry, (i, j)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        if i == k || j == k {
            s.off[entry] = zero;
        }
    }
}
