//! First derivatives of the equations of constrained motion, of accelerations and multipliers, for generic
//! code.

use super::layout::MotionDerivatives;
use super::{Constrained, Solution};
use crate::blocks::zeros;
use crate::{At, ByMotion, Derivatives, Real};
use nalgebra::{ArrayStorage, SMatrix, SVector};

/// Derivatives `(∂λ/∂q, ∂λ/∂v, ∂λ/∂τ)` of the constraint multipliers, one row for each of the `NC`
/// constraints.
pub type MultiplierDerivatives<T, const NV: usize, const NC: usize> =
    (SMatrix<T, NC, NV>, SMatrix<T, NC, NV>, SMatrix<T, NC, NV>);

/// First derivatives of a mechanism's constrained equations. `#[mechanism(…, derivatives)]` implements it for
/// mechanisms with constraints but without sliding contacts.
///
/// Derivatives with respect to `q` are along displacements of the configuration, whether or not the
/// constraints permit them: column `i` is along `q ⊕ ε eᵢ`, in body axes for ball and free joints. Time `t`
/// is as in [`Constrained`].
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no derivatives of constrained motion",
    note = "enable them with the option: `#[mechanism(…, derivatives)]`; mechanisms without constraints and \
            those with contacts that slip have none"
)]
pub trait ConstrainedDerivatives<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>: Constrained<NQ, NV, NU, NH, NC> + Derivatives<NQ, NV, NU>
{
    /// Returns the derivatives of `M a + h − Jᵀ λ` (equations of motion), of `J a + b` (constraint
    /// accelerations) and of the constraint rates, for any accelerations `a` and multipliers `λ`.
    fn equation_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        lambda: &SVector<Self::Scalar, NC>,
    ) -> EquationDerivatives<Self::Scalar, NV, NC>;

    /// Returns the derivatives `(∂λ/∂q, ∂λ/∂v, ∂λ/∂τ)` of the multipliers of
    /// [`constrained_dynamics`](Constrained::constrained_dynamics), which have minimum norm for redundant
    /// constraints. They follow from the differentiated equations `M δv̇ − Jᵀ δλ = δτ − ∂(M a + h − Jᵀ λ)`
    /// and `J δv̇ = −∂(J a + b)`.
    fn multiplier_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> MultiplierDerivatives<Self::Scalar, NV, NC> {
        let [by_q, by_v, by_tau] = accelerations_with_derivatives(self, t, q, v, tau).by;
        (by_q.1, by_v.1, by_tau.1)
    }
}

/// First derivatives of the equations `M a + h − Jᵀ λ = τ` and `J a + b = 0`, and of the constraint rates `J
/// v + …`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquationDerivatives<T, const NV: usize, const NC: usize> {
    /// Derivative `∂(M a + h − Jᵀ λ)/∂q` of the equations of motion with respect to the configuration.
    pub forces_by_q: SMatrix<T, NV, NV>,
    /// Derivative `∂(M a + h − Jᵀ λ)/∂v` of the equations of motion with respect to the velocity.
    pub forces_by_v: SMatrix<T, NV, NV>,
    /// Derivative `∂(J a + b)/∂q` of the constraint accelerations.
    pub accelerations_by_q: SMatrix<T, NC, NV>,
    /// Derivative `∂(J a + b)/∂v` of the constraint accelerations.
    pub accelerations_by_v: SMatrix<T, NC, NV>,
    /// Derivative `∂(J v + …)/∂q` of the constraint velocities.
    pub rates_by_q: SMatrix<T, NC, NV>,
}

impl<T, const NV: usize, const NC: usize> From<MotionDerivatives<T, NV, NC>>
    for EquationDerivatives<T, NV, NC>
{
    fn from(parts: MotionDerivatives<T, NV, NC>) -> Self {
        Self {
            forces_by_q: SMatrix::from_array_storage(ArrayStorage(parts.forces_by_q)),
            forces_by_v: SMatrix::from_array_storage(ArrayStorage(parts.forces_by_v)),
            accelerations_by_q: SMatrix::from_array_storage(ArrayStorage(parts.bias_by_q)),
            accelerations_by_v: SMatrix::from_array_storage(ArrayStorage(parts.bias_by_v)),
            rates_by_q: SMatrix::from_array_storage(ArrayStorage(parts.rates_by_q)),
        }
    }
}

/// Derivatives of accelerations, and derivatives of constraint multipliers.
type SolutionDerivatives<T, const NV: usize, const NC: usize> = (SMatrix<T, NV, NV>, SMatrix<T, NC, NV>);

/// Accelerations and multipliers of constrained motion, with their derivatives.
pub(crate) struct ConstrainedMotionDerivatives<T, const NV: usize, const NC: usize> {
    pub(crate) a: SVector<T, NV>,
    pub(crate) lambda: SVector<T, NC>,
    /// Derivatives of accelerations and multipliers with respect to configuration, velocity and generalized
    /// force.
    pub(crate) by: [SolutionDerivatives<T, NV, NC>; 3],
}

/// Returns the accelerations and multipliers of [`constrained_dynamics`](Constrained::constrained_dynamics)
/// with their derivatives.
pub(crate) fn accelerations_with_derivatives<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    tau: &SVector<T, NV>,
) -> ConstrainedMotionDerivatives<T, NV, NC>
where
    T: Real,
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T> + ?Sized,
{
    let (a, lambda) = m.constrained_dynamics(t, q, v, tau);
    let parts = m.equation_derivatives(t, q, v, &a, &lambda);
    let mass = m.mass_matrix(t, q);
    let solve_derivative_columns = |forces: &SMatrix<T, NV, NV>, gaps: &SMatrix<T, NC, NV>| {
        let (mut changes, mut multipliers) = (zeros(), zeros());
        for j in 0..NV {
            let p = -column_or_zeros(forces, j);
            let change = m.constraint_response(t, q, &p, &column_or_zeros(gaps, j));
            // Residual forces of the velocity change, which are constraint forces.
            let held = tau + p - mass * change;
            set_column(&mut changes, j, &change);
            set_column(&mut multipliers, j, &(m.constrained_dynamics(t, q, v, &held).1 - lambda));
        }
        (changes, multipliers)
    };
    let by = [
        solve_derivative_columns(&parts.forces_by_q, &parts.accelerations_by_q),
        solve_derivative_columns(&parts.forces_by_v, &parts.accelerations_by_v),
        solve_derivative_columns(&-SMatrix::identity(), &SMatrix::zeros()),
    ];
    ConstrainedMotionDerivatives { a, lambda, by }
}

/// Returns the multipliers `μ` of constraint forces `p = Jᵀ μ`.
pub(crate) fn multipliers_from_constraint_forces<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    t: T,
    q: &SVector<T, NQ>,
    p: &SVector<T, NV>,
) -> SVector<T, NC>
where
    T: Real,
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    let still = SVector::zeros();
    let rest = m.bias_forces(t, q, &still);
    m.constrained_dynamics(t, q, &still, &(rest - p)).1 - m.constrained_dynamics(t, q, &still, &rest).1
}

/// Operation on a mechanism with any number of constraints, called by
/// [`visit_constraints`](crate::Derivatives::visit_constraints), so that generic code can use the constraints
/// without their number as a const parameter.
pub trait Visitor<T: Real, const NQ: usize, const NV: usize, const NU: usize> {
    /// Type of the result of the operation.
    type Output;

    /// Applies the operation to a mechanism with constraints.
    fn visit<M, const NH: usize, const NC: usize>(self, mechanism: &M) -> Self::Output
    where
        M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>;
}

/// Visitor that receives the mechanism at a fixed time.
pub(crate) struct FrozenTimeVisitor<V, T> {
    pub(crate) visitor: V,
    pub(crate) t: T,
}

impl<V, T, const NQ: usize, const NV: usize, const NU: usize> Visitor<T, NQ, NV, NU>
    for FrozenTimeVisitor<V, T>
where
    T: Real,
    V: Visitor<T, NQ, NV, NU>,
{
    type Output = V::Output;

    fn visit<M, const NH: usize, const NC: usize>(self, mechanism: &M) -> V::Output
    where
        M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        self.visitor.visit(&crate::at(mechanism, self.t))
    }
}

/// Implements the trait for a mechanism at a fixed time. The argument `t` of the functions is ignored.
#[diagnostic::do_not_recommend]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>
    Constrained<NQ, NV, NU, NH, NC> for At<'_, M, T>
where
    T: Real,
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = T>,
{
    const CONSTRAINTS: [&'static str; NC] = M::CONSTRAINTS;
    const ANGLES: &'static [usize] = M::ANGLES;

    fn holonomic(&self) -> usize {
        self.mechanism.holonomic()
    }

    fn angles(&self) -> &[usize] {
        self.mechanism.angles()
    }

    fn rotations(&self) -> [bool; NV] {
        self.mechanism.rotations()
    }

    fn constraint_residuals(&self, _t: T, q: &SVector<T, NQ>) -> SVector<T, NH> {
        self.mechanism.constraint_residuals(self.t, q)
    }

    fn constraint_rates(&self, _t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NC> {
        self.mechanism.constraint_rates(self.t, q, v)
    }

    fn constraint_jacobian(&self, _t: T, q: &SVector<T, NQ>) -> SMatrix<T, NC, NV> {
        self.mechanism.constraint_jacobian(self.t, q)
    }

    fn constraint_bias(&self, _t: T, q: &SVector<T, NQ>, v: &SVector<T, NV>) -> SVector<T, NC> {
        self.mechanism.constraint_bias(self.t, q, v)
    }

    fn constrained_dynamics(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
    ) -> Solution<T, NV, NC> {
        self.mechanism.constrained_dynamics(self.t, q, v, tau)
    }

    fn constraint_correction(&self, _t: T, q: &SVector<T, NQ>, gap: &SVector<T, NC>) -> SVector<T, NV> {
        self.mechanism.constraint_correction(self.t, q, gap)
    }

    fn constraint_response(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        p: &SVector<T, NV>,
        gap: &SVector<T, NC>,
    ) -> SVector<T, NV> {
        self.mechanism.constraint_response(self.t, q, p, gap)
    }

    fn stabilized_derivatives(
        &self,
        _t: T,
        state: (&SVector<T, NQ>, &SVector<T, NV>),
        u: &SVector<T, NU>,
        rate: T,
    ) -> Option<ByMotion<T, NV, NU>> {
        self.mechanism.stabilized_derivatives(self.t, state, u, rate)
    }
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>
    ConstrainedDerivatives<NQ, NV, NU, NH, NC> for At<'_, M, T>
where
    T: Real,
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    fn equation_derivatives(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        a: &SVector<T, NV>,
        lambda: &SVector<T, NC>,
    ) -> EquationDerivatives<T, NV, NC> {
        self.mechanism.equation_derivatives(self.t, q, v, a, lambda)
    }
}

/// Returns a column of a matrix; zeros if the index is out of range.
pub(crate) fn column_or_zeros<T: Real, const R: usize, const C: usize>(
    m: &SMatrix<T, R, C>,
    j: usize,
) -> SVector<T, R> {
    m.data.0.get(j).map_or_else(SVector::zeros, |column| SVector::from(*column))
}

/// Sets column `j` of a matrix; does nothing if the index is out of range.
pub(crate) fn set_column<T: Real, const R: usize, const C: usize>(
    m: &mut SMatrix<T, R, C>,
    j: usize,
    column: &SVector<T, R>,
) {
    if let Some(out) = m.data.0.get_mut(j) {
        *out = column.data.0[0];
    }
}

/// Returns the matrix whose columns are given by a function of the column index.
pub(crate) fn matrix_from_column_function<T: Real, const R: usize, const C: usize>(
    column: impl Fn(usize) -> SVector<T, R>,
) -> SMatrix<T, R, C> {
    let mut m = zeros();
    for (j, out) in m.data.0.iter_mut().enumerate() {
        *out = column(j).data.0[0];
    }
    m
}
