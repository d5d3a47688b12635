//! Reduction of all Euler-angle sequences to two standard ones: body-xyz or body-xyx in axes that depend on
//! the sequence.

use super::sequence::{Axis, EulerSequence, FixedIn};
use crate::Real;
use crate::private::{constant, epsilon};
use core::ops::Neg;
use nalgebra::{Matrix3, Vector3};

/// Sequence of Euler angles, expressed as body-xyz (asymmetric) or body-xyx (symmetric) in its own axes: the
/// first and the second axis of the body-fixed sequence, and their cross product.
///
/// Space-fixed sequences are body-fixed ones in reverse order. If the third axis is opposite to the cross
/// product, the third angle changes sign.
#[derive(Clone, Copy)]
pub(super) struct StandardSequence {
    first: Axis,
    second: Axis,
    pub(super) symmetric: bool,
    pub(super) reversed: bool,
}

impl StandardSequence {
    pub(super) fn new(sequence: EulerSequence) -> Self {
        let reversed = sequence.fixed_in() == FixedIn::Space;
        let [a, second, c] = sequence.axes();
        let first = if reversed { c } else { a };
        Self { first, second, symmetric: sequence.is_symmetric(), reversed }
    }

    /// Whether the cross product of the first and the second axis is a positive coordinate axis.
    fn is_cyclic(self) -> bool {
        matches!((self.first, self.second), (Axis::X, Axis::Y) | (Axis::Y, Axis::Z) | (Axis::Z, Axis::X))
    }

    /// Negates the third value if the third rotation axis is opposite to the cross product of the first two.
    fn with_third_axis_sign_applied<V: Neg<Output = V>>(self, [a, b, c]: [V; 3]) -> [V; 3] {
        if self.symmetric || self.is_cyclic() { [a, b, c] } else { [a, b, -c] }
    }

    /// Converts Euler angles or their rates from the given sequence to the standard sequence.
    pub(super) fn to_standard_sequence<V: Neg<Output = V>>(self, [a, b, c]: [V; 3]) -> [V; 3] {
        self.with_third_axis_sign_applied(if self.reversed { [c, b, a] } else { [a, b, c] })
    }

    /// Converts Euler angles, their rates, or the columns that multiply rates, from the standard sequence to
    /// the given sequence.
    pub(super) fn reorder_from_standard<V: Neg<Output = V>>(self, standard: [V; 3]) -> [V; 3] {
        let [a, b, c] = self.with_third_axis_sign_applied(standard);
        if self.reversed { [c, b, a] } else { [a, b, c] }
    }

    /// Returns the axes of the standard sequence as columns: a right-handed signed permutation, so products
    /// with it are exact.
    pub(super) fn standard_axes_as_columns<T: Real>(self) -> Matrix3<T> {
        let [first, second] = [self.first, self.second].map(|axis| match axis {
            Axis::X => Vector3::new(T::one(), T::zero(), T::zero()),
            Axis::Y => Vector3::new(T::zero(), T::one(), T::zero()),
            Axis::Z => Vector3::new(T::zero(), T::zero(), T::one()),
        });
        Matrix3::from_columns(&[first, second, first.cross(&second)])
    }
}

/// Returns the sine of the angle between first and third axis below which the axes count as parallel (gimbal
/// lock): the rounding error of a zero in a rotation matrix.
pub(super) fn parallel_axes_threshold<T: Real>() -> T {
    constant::<T>(4.0) * epsilon::<T>()
}
