//! What generated functions hand to the runtime, with a name for each part. Generated code makes these
//! structs field by field, so that neither side counts numbers.

use crate::Real;

/// What elimination finds for accelerations and multipliers, with what tells whether they can be trusted.
#[derive(Clone, Copy, Debug)]
pub struct Elimination<T, const NV: usize, const NC: usize> {
    /// Accelerations.
    pub accelerations: [T; NV],
    /// Multipliers of the constraints.
    pub multipliers: [T; NC],
    /// The pivot of each constraint.
    pub pivots: [T; NC],
    /// What each pivot was before other constraints took their part.
    pub before: [T; NC],
}

/// What accelerations and multipliers follow from where some constraints always follow from others.
#[derive(Clone, Copy, Debug)]
pub struct Responses<T, const NV: usize, const NC: usize> {
    /// Accelerations without multipliers.
    pub free: [T; NV],
    /// What the constraints lack of zero under those.
    pub lacking: [T; NC],
    /// Rows of `J M⁻¹ Jᵀ`.
    pub gram: [[T; NC]; NC],
    /// The accelerations that a unit of each multiplier gives.
    pub given: [[T; NV]; NC],
}

/// Derivatives at given accelerations and multipliers. Matrices are lists of columns.
#[derive(Clone, Copy, Debug)]
pub struct MotionDerivatives<T, const NV: usize, const NC: usize> {
    /// Derivatives of `M a + h − Jᵀ λ` by `q`.
    pub forces_by_q: [[T; NV]; NV],
    /// Derivatives of `M a + h − Jᵀ λ` by `v`.
    pub forces_by_v: [[T; NV]; NV],
    /// Derivatives of `J a + b` by `q`.
    pub bias_by_q: [[T; NC]; NV],
    /// Derivatives of `J a + b` by `v`.
    pub bias_by_v: [[T; NC]; NV],
    /// Derivatives of the constraints' rates by `q`.
    pub rates_by_q: [[T; NC]; NV],
    /// What turns displacements that are measured in turning axes.
    pub turning: [[T; NV]; NV],
}

/// Second derivatives of `−λᵀ J w + zᵀ (J a + b) + yᵀ (J v + …)`. Matrices are lists of columns.
#[derive(Clone, Copy, Debug)]
pub struct ConstraintCurvature<T, const NV: usize, const NC: usize> {
    /// By `q` twice.
    pub qq: [[T; NV]; NV],
    /// By `q` (rows) and `v`.
    pub qv: [[T; NV]; NV],
    /// By `v` twice.
    pub vv: [[T; NV]; NV],
    /// By `q` (rows) and `a`.
    pub qa: [[T; NV]; NV],
    /// By `q` (rows) and `λ`.
    pub q_lambda: [[T; NV]; NC],
}

/// The generalized forces of the inputs with their derivatives. Matrices are lists of columns.
#[derive(Clone, Copy, Debug)]
pub struct InputDerivatives<T, const NV: usize, const NU: usize> {
    /// The forces `τ`.
    pub forces: [T; NV],
    /// Derivatives of the forces by `q`.
    pub by_q: [[T; NV]; NV],
    /// Derivatives of the forces by `v`.
    pub by_v: [[T; NV]; NV],
    /// Derivatives of the forces by `u`.
    pub by_u: [[T; NV]; NU],
}

impl<T: Real, const NV: usize, const NC: usize> MotionDerivatives<T, NV, NC> {
    /// Derivatives with the forces of inputs among those that act: these may depend on the state.
    pub fn under<const NU: usize>(mut self, inputs: &InputDerivatives<T, NV, NU>) -> Self {
        let subtract = |from: &mut [[T; NV]; NV], what: &[[T; NV]; NV]| {
            for (entry, other) in from.iter_mut().flatten().zip(what.iter().flatten()) {
                *entry -= *other;
            }
        };
        subtract(&mut self.forces_by_q, &inputs.by_q);
        subtract(&mut self.forces_by_v, &inputs.by_v);
        self
    }
}
