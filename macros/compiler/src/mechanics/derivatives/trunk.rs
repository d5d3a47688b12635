//! Partition of a tree into a trunk and limbs, and the inverse of its mass matrix. With the trunk's
//! velocities first, the mass matrix is `M = [A B; Bᵀ C]`, where `C` has a block for each limb. With
//! `W = C⁻¹ Bᵀ`, `S = A − B W` and `G = [1; −W]`
//!
//! `M⁻¹ = [0 0; 0 C⁻¹] + H Gᵀ`, `H = G S⁻¹`
//!
//! (the inverse of a partitioned matrix; Golub and Van Loan, *Matrix Computations*, 2013, ch. 3). The columns
//! of `H` are the trunk's columns of `M⁻¹`. The first term is sparse: it has a block for each limb.

use super::super::crba::Matrix;
use super::super::ldl::order_from_leaves_to_root;
use super::factor::MatrixFactorisation;
use crate::expr::Expr;
use crate::kinematics::Joint;

/// Partition of the velocities into those of the trunk and those of each limb, which the mass matrix couples
/// only through the trunk.
#[derive(Clone, Debug)]
pub struct TrunkLimbPartition {
    /// Velocities of the trunk, from the leaves to the root.
    pub velocities: Vec<usize>,
    limbs: Vec<Limb>,
}

/// Limb: velocities that the mass matrix couples only with each other and with velocities of the trunk.
#[derive(Clone, Debug)]
struct Limb {
    /// Velocities of the limb, from the leaves to the root.
    velocities: Vec<usize>,
    /// Number of identical limbs in the SIMD lanes of the expressions.
    identical: usize,
}

impl TrunkLimbPartition {
    /// Returns for each velocity whether its link, or a descendant of the link, has more than one child. A
    /// group of limbs in SIMD lanes is not divided further.
    pub fn branching_descendant_flags(joints: &[Joint<'_>], nv: usize) -> Vec<bool> {
        let mut children = vec![0; joints.len()];
        let mut branches = vec![false; joints.len()];
        for (k, joint) in joints.iter().enumerate().rev() {
            branches[k] |= children[k] > 1;
            if let Some(parent) = joint.parent {
                children[parent.0] += joint.limbs;
                branches[parent.0] |= branches[k] && joint.limbs == 1;
            }
        }
        let mut velocities = vec![false; nv];
        for (k, joint) in joints.iter().enumerate() {
            let inside = joint.limbs > 1 || joint.parent.is_some_and(|p| !branches[p.0]);
            branches[k] &= !inside;
            if branches[k] {
                joint.dofs.iter().for_each(|dof| velocities[dof.index] = true);
            }
        }
        velocities
    }

    /// Returns the partition with the given trunk, or `None` if there is only one limb or the mass matrix
    /// couples different limbs.
    pub fn new(joints: &[Joint<'_>], mass: &Matrix<'_>, is_trunk: &[bool]) -> Option<TrunkLimbPartition> {
        let order = order_from_leaves_to_root(joints, mass.len());
        let mut limbs: Vec<Limb> = Vec::new();
        let mut limb_of_joint: Vec<Option<usize>> = Vec::with_capacity(joints.len());
        let mut limb_of = vec![None; mass.len()];
        for joint in joints {
            let carried = joint.parent.and_then(|p| limb_of_joint[p.0]);
            let limb = match joint.dofs.iter().all(|dof| is_trunk[dof.index]) {
                true => carried,
                false => Some(carried.unwrap_or_else(|| {
                    limbs.push(Limb { velocities: Vec::new(), identical: joint.limbs });
                    limbs.len() - 1
                })),
            };
            limb_of_joint.push(limb);
            for dof in joint.dofs.iter().filter(|dof| !is_trunk[dof.index]) {
                limb_of[dof.index] = limb;
            }
        }
        for &k in &order {
            if let Some(limb) = limb_of[k] {
                limbs[limb].velocities.push(k);
            }
        }
        let has_no_mass_coupling = |i: usize, j: usize| {
            limb_of[i] == limb_of[j] || is_trunk[i] || is_trunk[j] || mass[i][j].is_zero()
        };
        let n = mass.len();
        let velocities = order.into_iter().filter(|k| is_trunk[*k]).collect();
        let several = limbs.iter().map(|limb| limb.identical).sum::<usize>() > 1;
        (several && (0..n).all(|i| (0..i).all(|j| has_no_mass_coupling(i, j))))
            .then_some(TrunkLimbPartition { velocities, limbs })
    }

    /// Returns the partition in which all velocities belong to the trunk.
    pub fn partition_with_trunk_only(joints: &[Joint<'_>], nv: usize) -> TrunkLimbPartition {
        TrunkLimbPartition { velocities: order_from_leaves_to_root(joints, nv), limbs: Vec::new() }
    }

    /// Returns the velocities of each limb in ascending order.
    pub fn velocity_indices_of_limbs(&self) -> Vec<Vec<usize>> {
        let sorted_velocities_of_limb = |limb: &Limb| {
            let mut velocities = limb.velocities.clone();
            velocities.sort_unstable();
            velocities
        };
        self.limbs.iter().map(sorted_velocities_of_limb).filter(|limb| !limb.is_empty()).collect()
    }
}

impl Limb {
    /// Returns the sum over all identical limbs in the SIMD lanes.
    fn lane_sum<'g>(&self, e: Expr<'g>) -> Expr<'g> {
        if self.identical == 1 { e } else { e.lane_sum(self.identical) }
    }
}

/// Returns the terms of `M⁻¹` that remain to be computed if runtime loops do the remainder: `C⁻¹` in the
/// columns of the limbs, and the trunk's columns of `M` in the order of the trunk's velocities.
pub fn inverse_terms_for_runtime_loops<'g>(mass: &Matrix<'g>, trunk: &TrunkLimbPartition) -> [Matrix<'g>; 2] {
    let zero_row = |row: &Vec<Expr<'g>>| row.iter().map(|e| e.zero()).collect();
    let mut inverses: Matrix<'g> = mass.iter().map(zero_row).collect();
    for limb in &trunk.limbs {
        let inverse = MatrixFactorisation::factorise_from_leaves_to_root(mass, &limb.velocities).inverse();
        for &i in &limb.velocities {
            inverses[i].clone_from_slice(&inverse[i]);
        }
    }
    let borders = mass.iter().map(|row| trunk.velocities.iter().map(|&t| row[t]).collect()).collect();
    [inverses, borders]
}

/// Inverse mass matrix `M⁻¹`, computed by blocks of the trunk and the limbs.
pub struct BlockInverseMassMatrix<'a, 'g> {
    trunk: &'a TrunkLimbPartition,
    /// `C⁻¹` among the limbs, `S⁻¹` in the trunk, `W` in the rows of the limbs and the columns of the trunk.
    parts: Matrix<'g>,
}

impl<'a, 'g> BlockInverseMassMatrix<'a, 'g> {
    /// Computes the blocks of the inverse mass matrix for trunk and limbs.
    pub fn new(mass: &Matrix<'g>, trunk: &'a TrunkLimbPartition) -> BlockInverseMassMatrix<'a, 'g> {
        let n = mass.len();
        let Some(zero) = mass.first().and_then(|row| row.first()).map(|e| e.zero()) else {
            return BlockInverseMassMatrix { trunk, parts: Vec::new() };
        };
        let mut parts = vec![vec![zero; n]; n];
        let mut rest = mass.clone();
        for limb in &trunk.limbs {
            let inverse =
                MatrixFactorisation::factorise_from_leaves_to_root(mass, &limb.velocities).inverse();
            for &i in &limb.velocities {
                parts[i].clone_from_slice(&inverse[i]);
                for &t in &trunk.velocities {
                    parts[i][t] = sum_of_products(&limb.velocities, |k| (inverse[i][k], mass[k][t]), zero);
                }
            }
            for (step, &i) in trunk.velocities.iter().enumerate() {
                for &j in &trunk.velocities[..=step] {
                    let taken = sum_of_products(&limb.velocities, |k| (mass[i][k], parts[k][j]), zero);
                    rest[i][j] -= limb.lane_sum(taken);
                    rest[j][i] = rest[i][j];
                }
            }
        }
        let inverse = MatrixFactorisation::factorise_from_leaves_to_root(&rest, &trunk.velocities).inverse();
        for &t in &trunk.velocities {
            parts[t].clone_from_slice(&inverse[t]);
        }
        BlockInverseMassMatrix { trunk, parts }
    }

    /// Returns the product `M⁻¹ r` from the blocks for trunk and limbs.
    pub fn solve_by_trunk_and_limbs(&self, r: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let (parts, trunk) = (&self.parts, &self.trunk.velocities);
        let mut x = r.to_vec();
        for limb in &self.trunk.limbs {
            for &t in trunk {
                let taken = sum_of_products(&limb.velocities, |k| (parts[k][t], r[k]), r[t].zero());
                x[t] -= limb.lane_sum(taken);
            }
        }
        let forces: Vec<Expr<'g>> = x.clone();
        for &t in trunk {
            x[t] = sum_of_products(trunk, |k| (parts[t][k], forces[k]), r[t].zero());
        }
        for limb in &self.trunk.limbs {
            for &i in &limb.velocities {
                let own = sum_of_products(&limb.velocities, |k| (parts[i][k], r[k]), r[i].zero());
                x[i] = own - sum_of_products(trunk, |t| (parts[i][t], x[t]), r[i].zero());
            }
        }
        x
    }

    /// Returns a matrix with the columns of `H` for the trunk and the columns of `C⁻¹` for the limbs.
    pub fn trunk_and_limb_inverse_columns(&self) -> Matrix<'g> {
        let (parts, trunk) = (&self.parts, &self.trunk.velocities);
        let mut columns = parts.clone();
        for &i in self.trunk.limbs.iter().flat_map(|limb| &limb.velocities) {
            for &t in trunk {
                columns[i][t] = -sum_of_products(trunk, |k| (parts[i][k], parts[k][t]), parts[i][t].zero());
            }
        }
        columns
    }

    /// Returns the rows of `G` for the limbs, with zero rows for the trunk. The columns are in the order of
    /// the trunk's velocities.
    pub fn limb_to_trunk_factors(&self) -> Matrix<'g> {
        let mut factors: Matrix<'g> =
            self.parts.iter().map(|row| vec![row[0].zero(); self.trunk.velocities.len()]).collect();
        for &i in self.trunk.limbs.iter().flat_map(|limb| &limb.velocities) {
            for (column, &t) in self.trunk.velocities.iter().enumerate() {
                factors[i][column] = -self.parts[i][t];
            }
        }
        factors
    }
}

/// Returns the sum of products of two lists over some indices.
fn sum_of_products<'g>(
    over: &[usize],
    of: impl Fn(usize) -> (Expr<'g>, Expr<'g>),
    zero: Expr<'g>,
) -> Expr<'g> {
    over.iter().fold(zero, |sum, &k| {
        let (a, b) = of(k);
        sum + a * b
    })
}
