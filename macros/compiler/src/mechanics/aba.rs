//! Forward dynamics by the articulated-body algorithm (Featherstone 1983, 2008, ch. 7), on the part of the forces that
//! the bias does not balance: with `r = τ − h(q, v)`, the accelerations are those of the mechanism at rest without
//! gravity, so the recursion has no velocity terms.

use super::kinematics::{Dof, Joint};
use super::{Spatial, is_plain_tree};
use crate::expr::{Expr, Mat3, Sym3, Vec3};
use crate::model::{Inertia, Model};

/// `M⁻¹ r`. `None` for a mechanism with coupled coordinates.
pub fn accelerations<'g>(model: &Model<'g>, joints: &[Joint<'g>], r: &[Expr<'g>]) -> Option<Vec<Expr<'g>>> {
    if !is_plain_tree(model) {
        return None;
    }
    let mut inertias: Vec<Articulated<'g>> =
        model.links.iter().map(|l| Articulated::rigid(&l.inertia)).collect();
    let mut wrenches = vec![Spatial::zero(model); joints.len()];
    let mut handles: Vec<Vec<Handle<'g>>> = vec![Vec::new(); joints.len()];
    for (k, joint) in joints.iter().enumerate().rev() {
        let (mut inertia, mut wrench) = (inertias[k], wrenches[k]);
        for dof in joint.dofs.iter().rev() {
            let handle = Handle::new(dof, &inertia, &wrench, r[dof.index]);
            wrench = wrench.plus(&handle.column.times(handle.force * handle.inverse));
            // Nothing above the last degree of freedom needs what is left of the inertia of a root.
            inertia.eliminate(dof, &handle);
            handles[k].push(handle);
        }
        if let Some(parent) = joint.parent {
            inertias[parent.0] = inertias[parent.0].plus(&inertia.to_parent(joint));
            wrenches[parent.0] = wrenches[parent.0].plus(&joint.wrench_to_parent(&wrench));
        }
    }
    Some(outward(model, joints, &handles))
}

fn outward<'g>(model: &Model<'g>, joints: &[Joint<'g>], handles: &[Vec<Handle<'g>>]) -> Vec<Expr<'g>> {
    let mut result = vec![model.graph.zero(); model.nv()];
    let mut motions: Vec<Spatial<'g>> = Vec::with_capacity(joints.len());
    for (k, joint) in joints.iter().enumerate() {
        let mut motion = joint.parent.map_or(Spatial::zero(model), |p| joint.twist_to_child(&motions[p.0]));
        for (dof, handle) in joint.dofs.iter().zip(handles[k].iter().rev()) {
            let a = (handle.force - handle.column.dot(&motion)) * handle.inverse;
            result[dof.index] = a;
            motion = motion.plus(&dof.subspace.times(a));
        }
        motions.push(motion);
    }
    result
}

/// What is known of one degree of freedom once its handle is computed: `U = IA s`, `1 / D`, `u = r − s · pA`.
#[derive(Clone)]
struct Handle<'g> {
    column: Spatial<'g>,
    inverse: Expr<'g>,
    force: Expr<'g>,
}

impl<'g> Handle<'g> {
    fn new(dof: &Dof<'g>, inertia: &Articulated<'g>, wrench: &Spatial<'g>, r: Expr<'g>) -> Handle<'g> {
        let column = inertia.times(&dof.subspace);
        let d = dof.subspace.dot(&column);
        Handle { column, inverse: d.num(1.0) / d, force: r - dof.subspace.dot(wrench) }
    }
}

/// An articulated inertia: force `M a + Hᵀ w`, moment `H a + I w` for an acceleration `(a, w)` of the origin.
#[derive(Clone, Copy)]
struct Articulated<'g> {
    m: Sym3<'g>,
    h: Mat3<'g>,
    i: Sym3<'g>,
}

impl<'g> Articulated<'g> {
    fn rigid(inertia: &Inertia<'g>) -> Articulated<'g> {
        Articulated { m: Sym3::scalar(inertia.mass), h: Mat3::skew(inertia.moment), i: inertia.tensor }
    }

    fn plus(&self, b: &Articulated<'g>) -> Articulated<'g> {
        Articulated { m: self.m + b.m, h: self.h + b.h, i: self.i + b.i }
    }

    fn times(&self, s: &Spatial<'g>) -> Spatial<'g> {
        Spatial {
            linear: self.m * s.linear + self.h.transpose() * s.angular,
            angular: self.h * s.linear + self.i * s.angular,
        }
    }

    /// `IA − U Uᵀ / D`. Rows and columns of a coordinate axis that the joint leaves free are exactly zero then.
    fn eliminate(&mut self, dof: &Dof<'g>, handle: &Handle<'g>) {
        let (f, n) = (handle.column.linear, handle.column.angular);
        let (f_scaled, n_scaled) = (f * handle.inverse, n * handle.inverse);
        let outer = |a: Vec3<'g>, b: Vec3<'g>| Mat3::from_fn(|i, j| a[i] * b[j]);
        self.m = self.m - Sym3::from_upper(&outer(f_scaled, f));
        self.h = self.h - outer(n_scaled, f);
        self.i = self.i - Sym3::from_upper(&outer(n_scaled, n));
        let zero = handle.inverse.zero();
        if let Some(k) = coordinate_axis(dof.subspace.angular).filter(|_| dof.subspace.linear.is_zero()) {
            self.h.0[k] = [zero; 3];
            clear(&mut self.i, k);
        }
        if let Some(k) = coordinate_axis(dof.subspace.linear).filter(|_| dof.subspace.angular.is_zero()) {
            for row in &mut self.h.0 {
                row[k] = zero;
            }
            clear(&mut self.m, k);
        }
    }

    /// The same inertia about the parent's origin, in parent axes.
    ///
    /// `H' = H + [p]× M`, `I' = I + Y + Yᵀ` with `Y = −(H + H') [p / 2]×`.
    fn to_parent(self, joint: &Joint<'g>) -> Articulated<'g> {
        let m = joint.rotation.sym_to_parent(self.m);
        let h = joint.rotation.mat_to_parent(self.h);
        let i = joint.rotation.sym_to_parent(self.i);
        let p = joint.translation;
        if p.is_zero() {
            return Articulated { m, h, i };
        }
        let moved = h + Mat3::skew(p) * m.full();
        let both = h + moved;
        let half = Mat3::skew(p.map(|c| c * 0.5));
        let whole = Mat3::skew(p);
        let entry = |row: usize, column: usize, s: &Mat3<'g>| both.row(row).dot(s.column(column));
        let shift = Sym3 {
            diagonal: std::array::from_fn(|k| entry(k, k, &whole)),
            off: [(0, 1), (0, 2), (1, 2)].map(|(a, b)| entry(a, b, &half) + entry(b, a, &half)),
        };
        Articulated { m, h: moved, i: i - shift }
    }
}

/// The coordinate axis that a vector points along (either way), if it does.
fn coordinate_axis(v: Vec3<'_>) -> Option<usize> {
    let k = (0..3).find(|k| !v[*k].is_zero())?;
    let others = v[(k + 1) % 3].is_zero() && v[(k + 2) % 3].is_zero();
    others.then_some(k)
}

fn clear(s: &mut Sym3<'_>, k: usize) {
    let zero = s.diagonal[k].zero();
    s.diagonal[k] = zero;
    // Entries xy, xz, yz: those of axis k are all but the one whose indices are the other two.
    for (entry, (i, j)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        if i == k || j == k {
            s.off[entry] = zero;
        }
    }
}
