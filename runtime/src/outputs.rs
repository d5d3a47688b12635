//! Outputs of a mechanism, such as sensor measurements, and their derivatives, for generic code.

use crate::At;
use crate::{LinearMotion, Real};
use nalgebra::{SMatrix, SVector};

/// Vector of all `NY` outputs of a mechanism, except outputs that contain reactions. A generic estimator
/// compares this vector with measurements. `#[mechanism]` implements the trait for mechanisms with
/// `#[output(…)]`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no outputs, or another number of them",
    note = "`#[output(expression)] name: Scalar` declares one; reactions are left out"
)]
pub trait Outputs<const NQ: usize, const NV: usize, const NU: usize, const NY: usize> {
    /// Scalar type of the mechanism, and of its outputs.
    type Scalar: Real;

    /// Name of every entry: that of the output, with `.x`, `.y` and `.z` appended for the components of a
    /// vector.
    const OUTPUTS: [&'static str; NY];
    /// SI units of the entries of the output vector, inferred from the declaration, such as `m/s²`; `any` if
    /// undetermined, empty if unknown.
    const OUTPUT_UNITS: [&'static str; NY] = [""; NY];

    /// Returns the outputs in SI units, at time `t` (which matters only if a function of the mechanism
    /// depends on it), configuration `q`, velocity `v`, acceleration `a` and inputs `u`.
    fn outputs(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SVector<Self::Scalar, NY>;
}

/// Mechanisms with derivatives of all outputs. `#[mechanism(…, derivatives)]` implements this trait.
#[diagnostic::on_unimplemented(
    message = "the outputs of `{Self}` have no derivatives",
    note = "enable them with the option: `#[mechanism(…, derivatives)]`"
)]
pub trait OutputDerivatives<const NQ: usize, const NV: usize, const NU: usize, const NY: usize>:
    Outputs<NQ, NV, NU, NY>
{
    /// Returns the partial derivatives of [`outputs`](Outputs::outputs) with respect to each argument.
    fn output_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> OutputJacobians<Self::Scalar, NY, NV, NU>;
}

/// Implements the trait for a mechanism at a fixed time. The argument `t` of the functions is ignored.
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NY: usize> Outputs<NQ, NV, NU, NY>
    for At<'_, M, T>
where
    T: Real,
    M: Outputs<NQ, NV, NU, NY, Scalar = T>,
{
    type Scalar = T;
    const OUTPUTS: [&'static str; NY] = M::OUTPUTS;
    const OUTPUT_UNITS: [&'static str; NY] = M::OUTPUT_UNITS;

    fn outputs(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        a: &SVector<T, NV>,
        u: &SVector<T, NU>,
    ) -> SVector<T, NY> {
        self.mechanism.outputs(self.t, q, v, a, u)
    }
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NY: usize>
    OutputDerivatives<NQ, NV, NU, NY> for At<'_, M, T>
where
    T: Real,
    M: OutputDerivatives<NQ, NV, NU, NY, Scalar = T>,
{
    fn output_derivatives(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        a: &SVector<T, NV>,
        u: &SVector<T, NU>,
    ) -> OutputJacobians<T, NY, NV, NU> {
        self.mechanism.output_derivatives(self.t, q, v, a, u)
    }
}

/// Partial derivatives of `NY` outputs with respect to configuration, velocity, acceleration and inputs.
/// Column `i` of `by_q` is the derivative along `q ⊕ ε eᵢ`, in body axes for ball and free joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputJacobians<T, const NY: usize, const NV: usize, const NU: usize> {
    /// Partial derivative of the outputs with respect to the configuration, per m and rad.
    pub by_q: SMatrix<T, NY, NV>,
    /// Partial derivative of the outputs with respect to the velocity, per m/s and rad/s.
    pub by_v: SMatrix<T, NY, NV>,
    /// Partial derivative of the outputs with respect to the acceleration, per m/s² and rad/s².
    pub by_a: SMatrix<T, NY, NV>,
    /// Partial derivative of the outputs with respect to the inputs.
    pub by_u: SMatrix<T, NY, NU>,
}

impl<T: Real, const NY: usize, const NV: usize, const NU: usize> OutputJacobians<T, NY, NV, NU> {
    /// Returns output derivatives that are all zero.
    pub fn zeros() -> Self {
        let (state, by_u) = (SMatrix::zeros(), SMatrix::zeros());
        Self { by_q: state, by_v: state, by_a: state, by_u }
    }

    /// Writes the derivatives of other outputs to the rows from `first` on. Rows that do not fit are dropped.
    pub fn put_rows<const R: usize>(&mut self, first: usize, other: &OutputJacobians<T, R, NV, NU>) {
        crate::private::put_rows(&mut self.by_q, first, &other.by_q);
        crate::private::put_rows(&mut self.by_v, first, &other.by_v);
        crate::private::put_rows(&mut self.by_a, first, &other.by_a);
        crate::private::put_rows(&mut self.by_u, first, &other.by_u);
    }

    /// Returns the total derivatives of the outputs along the motion, `∂y/∂q + ∂y/∂a ∂v̇/∂q` and so on;
    /// `by_a` of the result is zero.
    ///
    /// ```
    /// use linkwork::prelude::*;
    ///
    /// /// A cart with an accelerometer, pushed by a force against a spring.
    /// #[mechanism(derivatives)]
    /// struct Cart {
    ///     #[body(mass = 2)]
    ///     cart: Body,
    ///     #[joint(ground -> cart, along = x)]
    ///     rail: Sleeve,
    ///     #[acts(on = rail, stiffness = 8)]
    ///     spring: Spring,
    ///     #[acts(on = rail)]
    ///     push: Force,
    ///     #[output(dot(a(cart / ground / ground), x))]
    ///     accelerometer: Scalar,
    /// }
    ///
    /// let (q, v, u) = ([0.1].into(), [0.0].into(), [1.0].into());
    /// let motion = Cart {}.linear_motion(&q, &v, &u);
    /// let measured = Cart {}.accelerometer_derivatives(&q, &v, &motion.acceleration).in_motion(&motion);
    /// // The derivatives are −k / m for the position and 1 / m for the force.
    /// assert!((measured.by_q[0] + 4.0).abs() < 1e-12 && (measured.by_u[0] - 0.5).abs() < 1e-12);
    /// ```
    pub fn in_motion(&self, motion: &LinearMotion<T, NV, NU>) -> Self {
        Self {
            by_q: self.by_q + self.by_a * motion.by_q,
            by_v: self.by_v + self.by_a * motion.by_v,
            by_a: SMatrix::zeros(),
            by_u: self.by_u + self.by_a * motion.by_u,
        }
    }

    /// Returns the matrix `C` of the linearised outputs `δy = C x + D δu`, where `x` has displacements, then
    /// velocity changes, and `D` is `by_u`. Call [`in_motion`](Self::in_motion) first to include derivatives
    /// of the acceleration. `NX` is `2 NV`, inferred from the requested type.
    pub fn c<const NX: usize>(&self) -> SMatrix<T, NY, NX> {
        const { assert!(NX == 2 * NV, "the matrix has twice as many columns as there are velocities") };
        SMatrix::from_fn(|i, j| {
            let entry = if j < NV { self.by_q.get((i, j)) } else { self.by_v.get((i, j - NV)) };
            entry.copied().unwrap_or(T::zero())
        })
    }
}
