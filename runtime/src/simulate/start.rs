//! Types that are accepted as initial values of a simulation.

use crate::Real;
use nalgebra::SVector;

/// `N` initial values of a simulation: a vector, a reference to a vector (as functions of mechanisms take),
/// or an array.
///
/// ```
/// use linkwork::prelude::*;
///
/// #[mechanism]
/// struct Cart {
///     #[body(mass = 1)]
///     cart: Body,
///     #[joint(ground -> cart, along = x)]
///     rail: Sleeve,
/// }
///
/// let (q, v) = (Cart.neutral(), SVector::from([1.0]));
/// for run in [
///     simulate(&Cart).from(&q, &v),
///     simulate(&Cart).from(q, v),
///     simulate(&Cart).from([0.0], [1.0]),
///     simulate(&Cart).from(&[0.0].into(), &[1.0].into()),
/// ] {
///     assert!((run.duration(2.0).finish()?.q[0] - 2.0).abs() < 1e-9);
/// }
/// # Ok::<(), Error>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an initial state of a simulation",
    label = "expected {N} numbers of type `{T}`",
    note = "they may be an array, an `SVector` (of `linkwork::nalgebra`), or a reference to one"
)]
pub trait Start<T, const N: usize> {
    /// Returns the initial values as a vector.
    fn vector(self) -> SVector<T, N>;
}

impl<T: Real, const N: usize> Start<T, N> for SVector<T, N> {
    fn vector(self) -> SVector<T, N> {
        self
    }
}

impl<T: Real, const N: usize> Start<T, N> for &SVector<T, N> {
    fn vector(self) -> SVector<T, N> {
        *self
    }
}

impl<T: Real, const N: usize> Start<T, N> for [T; N] {
    fn vector(self) -> SVector<T, N> {
        self.into()
    }
}
