//! Named frames: the trait that generated code implements once for each of them, and what those implementations call.

mod unknown;

pub use unknown::Message;

use crate::Real;
use nalgebra::{
    ArrayStorage, Isometry, IsometryMatrix3, Matrix3, Rotation3, SMatrix, SVector, Translation3, Vector3,
};

/// The name of a frame, checked at compile time: made by [`frame!`](crate::frame!).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameIndex<const I: usize>;

/// Names a frame of a mechanism, checked at compile time: `frame!(Panda, "panda_link8")`.
///
/// Bodies, particles and points are frames; a name that the mechanism does not have does not compile. For a generic mechanism any scalar type will do: `frame!(Arm<f64>, "hand")`.
#[macro_export]
macro_rules! frame {
    ($mechanism:ty, $name:expr) => {
        $crate::FrameIndex::<
            {
                match <$mechanism>::frame_index($name) {
                    Some(index) => index,
                    None => panic!(
                        "{}",
                        $crate::__private::Message::unknown_frame(
                            stringify!($mechanism),
                            &<$mechanism>::FRAMES,
                            $name
                        )
                        .text()
                    ),
                }
            },
        >
    };
}

/// Frame number `I` of a mechanism with `NQ` configuration numbers and `NV` velocities. Implemented by generated code;
/// `t` counts only for a mechanism that is driven in time. Its figures are reached through `frame_placement`,
/// `frame_velocity`, `frame_acceleration` and `frame_jacobian`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no such frame",
    label = "this frame is another mechanism's",
    note = "name a frame of the mechanism itself: `frame!({Self}, \"…\")`"
)]
pub trait NamedFrame<const I: usize, const NQ: usize, const NV: usize> {
    /// The scalar type.
    type Scalar: Real;

    /// Rotation matrix by rows (columns are the frame's axes in ground axes), then the position of the origin, m.
    fn placement(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> [Self::Scalar; 12];

    /// Velocity of the origin (m/s), then angular velocity (rad/s), in ground axes.
    fn twist(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> [Self::Scalar; 6];

    /// Acceleration of the origin (m/s²), then angular acceleration (rad/s²), in ground axes, without gravity.
    fn acceleration(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> [Self::Scalar; 6];

    /// Twist per unit of each velocity, 6 × `NV`.
    fn jacobian(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> SMatrix<Self::Scalar, 6, NV>;
}

/// The index of a name in a list.
pub const fn frame_index(names: &[&str], name: &str) -> Option<usize> {
    let mut k = 0;
    while k < names.len() {
        if same(names[k].as_bytes(), name.as_bytes()) {
            return Some(k);
        }
        k += 1;
    }
    None
}

const fn same(a: &[u8], b: &[u8]) -> bool {
    if a.len() != b.len() {
        return false;
    }
    let mut k = 0;
    while k < a.len() {
        if a[k] != b[k] {
            return false;
        }
        k += 1;
    }
    true
}

/// A placement as nalgebra's type.
#[inline(always)]
pub fn placement<T: Real>(p: &[T; 12]) -> IsometryMatrix3<T> {
    let [a, b, c, d, e, f, g, h, i, x, y, z] = *p;
    let matrix = Matrix3::from_array_storage(ArrayStorage([[a, d, g], [b, e, h], [c, f, i]]));
    Isometry::from_parts(
        Translation3 { vector: Vector3::from_array_storage(ArrayStorage([[x, y, z]])) },
        Rotation3::from_matrix_unchecked(matrix),
    )
}

/// The placement of the ground in itself.
#[inline(always)]
pub fn identity_placement<T: Real>() -> [T; 12] {
    let (o, i) = (T::zero(), T::one());
    [i, o, o, o, i, o, o, o, i, o, o, o]
}

/// The position of a placement.
#[inline(always)]
pub fn origin<T: Real>(p: &[T; 12]) -> [T; 3] {
    let [.., x, y, z] = *p;
    [x, y, z]
}

/// Six numbers as nalgebra's type.
#[inline(always)]
pub fn six<T: Real>(s: [T; 6]) -> SVector<T, 6> {
    SVector::from_array_storage(ArrayStorage([s]))
}

/// Two arrays one after the other; `N` is the sum of their lengths.
#[inline(always)]
pub fn join<T: Real, const A: usize, const B: usize, const N: usize>(a: &[T; A], b: &[T; B]) -> [T; N] {
    let mut out = [T::zero(); N];
    for (to, from) in out.iter_mut().zip(a.iter().chain(b)) {
        *to = *from;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_and_arrays_joined() {
        assert_eq!(frame_index(&["a", "bc"], "bc"), Some(1));
        assert_eq!(frame_index(&["a", "bc"], "b"), None);
        assert_eq!(join::<f64, 2, 1, 3>(&[1.0, 2.0], &[3.0]), [1.0, 2.0, 3.0]);
        let p = placement(&identity_placement::<f64>());
        assert_eq!(p, IsometryMatrix3::identity());
    }
}
