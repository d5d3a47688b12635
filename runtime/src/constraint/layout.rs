//! Structs with named fields in which generated functions return their results to the runtime. Generated code
//! fills them field by field, so that neither side depends on positions in arrays.

use crate::Real;

/// Result of the elimination that solves for accelerations and constraint multipliers, with pivots to judge
/// its accuracy.
#[derive(Clone, Copy, Debug)]
pub struct Elimination<T, const NV: usize, const NC: usize> {
    /// Accelerations that the elimination found, one per velocity.
    pub accelerations: [T; NV],
    /// Multipliers that the elimination found, one per constraint.
    pub multipliers: [T; NC],
    /// Pivot of each constraint in the elimination, as a measure of its independence.
    pub pivots: [T; NC],
    /// Diagonal entry of each constraint before the elimination of other constraints, to which its pivot is
    /// compared.
    pub before: [T; NC],
}

/// Data for accelerations and multipliers of mechanisms with redundant constraints.
#[derive(Clone, Copy, Debug)]
pub struct Responses<T, const NV: usize, const NC: usize> {
    /// Accelerations that the forces would cause if all constraint multipliers were zero.
    pub free: [T; NV],
    /// Negative constraint accelerations `−(J a + b)` at the accelerations without multipliers.
    pub lacking: [T; NC],
    /// Rows of the matrix `J M⁻¹ Jᵀ` (Delassus matrix) of the constraints.
    pub gram: [[T; NC]; NC],
    /// Accelerations due to a unit of each multiplier, one list per constraint.
    pub given: [[T; NV]; NC],
}

/// Derivatives of the equations of constrained motion at fixed accelerations and multipliers. Matrices are
/// arrays of columns.
#[derive(Clone, Copy, Debug)]
pub struct MotionDerivatives<T, const NV: usize, const NC: usize> {
    /// Derivatives of `M a + h − Jᵀ λ` with respect to `q`.
    pub forces_by_q: [[T; NV]; NV],
    /// Derivatives of `M a + h − Jᵀ λ` with respect to `v`.
    pub forces_by_v: [[T; NV]; NV],
    /// Derivatives of `J a + b` with respect to `q`.
    pub bias_by_q: [[T; NC]; NV],
    /// Derivatives of `J a + b` with respect to `v`.
    pub bias_by_v: [[T; NC]; NV],
    /// Derivatives of the constraint rates with respect to `q`.
    pub rates_by_q: [[T; NC]; NV],
    /// Columns of the matrix `δq × v` that maps displacements of ball and free joints to their own rates;
    /// zero otherwise.
    pub turning: [[T; NV]; NV],
}

/// Second derivatives of the contracted equations `−λᵀ J w + zᵀ (J a + b) + yᵀ (J v + …)` of constrained
/// motion. Matrices are arrays of columns.
#[derive(Clone, Copy, Debug)]
pub struct ConstraintCurvature<T, const NV: usize, const NC: usize> {
    /// Block of the Hessian: second derivatives with respect to `q`.
    pub qq: [[T; NV]; NV],
    /// Block of the Hessian: derivatives with respect to `q` (rows) and `v` (columns).
    pub qv: [[T; NV]; NV],
    /// Block of the Hessian: second derivatives with respect to `v`.
    pub vv: [[T; NV]; NV],
    /// Block of the Hessian: derivatives with respect to `q` (rows) and the accelerations `a` (columns).
    pub qa: [[T; NV]; NV],
    /// Block of the Hessian: derivatives with respect to `q` (rows) and the multipliers `λ` (columns).
    pub q_lambda: [[T; NV]; NC],
}

/// Generalized forces of the inputs with their derivatives. Matrices are arrays of columns.
#[derive(Clone, Copy, Debug)]
pub struct InputDerivatives<T, const NV: usize, const NU: usize> {
    /// Generalized forces `τ` that the inputs exert.
    pub forces: [T; NV],
    /// Derivatives of the forces with respect to `q`.
    pub by_q: [[T; NV]; NV],
    /// Derivatives of the forces with respect to `v`.
    pub by_v: [[T; NV]; NV],
    /// Derivatives of the forces with respect to `u`.
    pub by_u: [[T; NV]; NU],
}

impl<T: Real, const NV: usize, const NC: usize> MotionDerivatives<T, NV, NC> {
    /// Returns the derivatives of the equations with the forces of the inputs included, which may depend on
    /// the state.
    pub fn with_inputs<const NU: usize>(mut self, inputs: &InputDerivatives<T, NV, NU>) -> Self {
        let subtract_matrix = |from: &mut [[T; NV]; NV], what: &[[T; NV]; NV]| {
            for (entry, other) in from.iter_mut().flatten().zip(what.iter().flatten()) {
                *entry -= *other;
            }
        };
        subtract_matrix(&mut self.forces_by_q, &inputs.by_q);
        subtract_matrix(&mut self.forces_by_v, &inputs.by_v);
        self
    }
}
