//! Named frames: the trait that generated code implements for each frame, and functions that these
//! implementations call.

mod unknown;

pub use unknown::Message;

use crate::Real;
use nalgebra::{
    ArrayStorage, Isometry, IsometryMatrix3, Matrix3, Rotation3, SMatrix, SVector, Translation3,
    UnitQuaternion, Vector3,
};

/// Index of a frame, checked at compile time: made by [`frame!`](crate::frame!).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameIndex<const I: usize>;

/// Returns the index of a frame by name, checked at compile time: `frame!(Panda, "panda_link8")`.
///
/// Bodies, particles and points are frames. A name that the mechanism does not have is a compile error. For a
/// generic mechanism, any scalar type may be used: `frame!(Arm<f64>, "hand")`.
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

/// Returns the index of an entry of `q`, `v`, `u` or of another list of names, checked at compile time:
/// `index!(Panda::VELOCITIES, "panda_joint4")`. A name that the list does not contain is a compile error, and
/// the message lists the most similar names. Editors and `cargo check` report the error if the index is a
/// constant; builds always report it, also in generic functions.
///
/// ```
/// use linkwork::{index, prelude::*};
///
/// #[mechanism(gravity = -9.81 * y)]
/// struct CartPole {
///     #[body(mass = 1)]
///     cart: Body,
///     #[body(mass = 0.1, com = 0.5 * y)]
///     pole: Body,
///     #[joint(ground -> cart, along = x)]
///     rail: Sleeve,
///     #[joint(cart -> pole, about = z)]
///     hinge: Pin,
/// }
///
/// const HINGE: usize = index!(CartPole::CONFIGURATION, "hinge");
/// assert_eq!(HINGE, 1);
/// ```
///
/// ```compile_fail
/// # use linkwork::{index, prelude::*};
/// # #[mechanism]
/// # struct Wheel {
/// #     #[body(mass = 1, inertia = diagonal(1, 1, 1))]
/// #     rim: Body,
/// #     #[joint(ground -> rim, about = z)]
/// #     axle: Pin,
/// # }
/// // `Wheel::VELOCITIES` has no entry `axel`; did you mean `axle`?
/// let axle = index!(Wheel::VELOCITIES, "axel");
/// ```
#[macro_export]
macro_rules! index {
    ($names:expr, $name:expr) => {
        $crate::__private::Index::<
            {
                match $crate::index_of(&$names, $name) {
                    Some(index) => index,
                    None => panic!(
                        "{}",
                        $crate::__private::Message::message_for_unknown_name(
                            stringify!($names),
                            &$names,
                            $name
                        )
                        .text()
                    ),
                }
            },
        >::VALUE
    };
}

/// Index computed at compile time, made by [`index!`](crate::index!). As a const argument of a type, the
/// index is evaluated by `cargo check` too, unlike a constant expression in a function.
pub struct Index<const I: usize>;

impl<const I: usize> Index<I> {
    /// Value of the frame index as a constant.
    pub const VALUE: usize = I;
}

/// Frame number `I` of a mechanism with `NQ` configuration numbers and `NV` velocities. Generated code
/// implements the trait; `t` matters only for driven motion. Users call `frame_placement`, `frame_velocity`,
/// `frame_acceleration` and `frame_jacobian` instead.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no such frame",
    label = "this frame is another mechanism's",
    note = "name a frame of the mechanism itself: `frame!({Self}, \"…\")`"
)]
pub trait NamedFrame<const I: usize, const NQ: usize, const NV: usize> {
    /// Scalar type of the mechanism to which the frame belongs.
    type Scalar: Real;

    /// Returns the placement of the frame in the ground frame: the rotation matrix by rows (columns are the
    /// frame's axes in ground axes), then the position of the origin, m.
    fn placement(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> [Self::Scalar; 12];

    /// Returns the twist of the frame: the velocity of its origin (m/s), then its angular velocity (rad/s),
    /// in ground axes.
    fn twist(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> [Self::Scalar; 6];

    /// Returns the acceleration of the frame's origin (m/s²), then its angular acceleration (rad/s²), in
    /// ground axes, without gravity.
    fn acceleration(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> [Self::Scalar; 6];

    /// Returns the Jacobian of the frame: its twist per unit of each velocity, 6 × `NV`.
    fn jacobian(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> SMatrix<Self::Scalar, 6, NV>;
}

/// Name of a frame of the mechanism `M`, made by [`frame!`](crate::frame!).
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a frame of `{M}`",
    label = "a frame is named by `frame!`",
    note = "write `frame!({M}, \"tool\")`; for a name that is known at run time alone, `index_of` and the \
            trait `Frames`"
)]
pub trait FrameName<M, const NQ: usize, const NV: usize> {
    /// Scalar type of the mechanism to which the frame belongs.
    type Scalar: Real;

    /// Returns the placement of the frame in the ground frame: its axes and its origin, m.
    fn placement(
        self,
        m: &M,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
    ) -> IsometryMatrix3<Self::Scalar>;

    /// Returns the velocity of the frame's origin (m/s), then its angular velocity (rad/s), in ground axes.
    fn velocity(
        self,
        m: &M,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, 6>;

    /// Returns the acceleration of the frame's origin (m/s²), then its angular acceleration (rad/s²), in
    /// ground axes, without gravity.
    fn acceleration(
        self,
        m: &M,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, 6>;

    /// Returns the Jacobian of the frame: its twist per unit of each velocity, 6 × `NV`.
    fn jacobian(self, m: &M, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> SMatrix<Self::Scalar, 6, NV>;
}

impl<M, const I: usize, const NQ: usize, const NV: usize> FrameName<M, NQ, NV> for FrameIndex<I>
where
    M: NamedFrame<I, NQ, NV>,
{
    type Scalar = M::Scalar;

    #[inline(always)]
    fn placement(self, m: &M, t: M::Scalar, q: &SVector<M::Scalar, NQ>) -> IsometryMatrix3<M::Scalar> {
        placement(&m.placement(t, q))
    }

    #[inline(always)]
    fn velocity(
        self,
        m: &M,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
    ) -> SVector<M::Scalar, 6> {
        six(m.twist(t, q, v))
    }

    #[inline(always)]
    fn acceleration(
        self,
        m: &M,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NV>,
        a: &SVector<M::Scalar, NV>,
    ) -> SVector<M::Scalar, 6> {
        six(m.acceleration(t, q, v, a))
    }

    #[inline(always)]
    fn jacobian(self, m: &M, t: M::Scalar, q: &SVector<M::Scalar, NQ>) -> SMatrix<M::Scalar, 6, NV> {
        m.jacobian(t, q)
    }
}

/// Frames of a mechanism with `NQ` configuration numbers and `NV` velocities, accessed by index, for programs
/// that select the frame at run time, for example from a configuration file. Index `k` is the frame
/// `FRAMES[k]`, and [`index_of`] finds an index by name. For names known at compile time,
/// [`frame!`](crate::frame!) is shorter and checked.
///
/// Time `t`, s, matters only for driven motion. The functions return `None` if the index is out of range.
///
/// ```
/// use linkwork::prelude::*;
/// use linkwork::{Frames, index_of};
///
/// /// Height of a frame.
/// fn height<M, const NQ: usize, const NV: usize>(m: &M, name: &str, q: &SVector<f64, NQ>) -> Option<f64>
/// where
///     M: Frames<NQ, NV, Scalar = f64>,
/// {
///     Some(m.placement_of(index_of(M::FRAMES, name)?, 0.0, q)?.translation.y)
/// }
///
/// #[mechanism(gravity = -9.81 * y)]
/// struct Arm {
///     #[body(mass = 1, com = x)]
///     upper: Body,
///     #[joint(ground -> upper, about = z)]
///     shoulder: Pin,
///     #[particle(mass = 0.5, at = upper.at(2 * x))]
///     hand: Particle,
/// }
///
/// let raised = [std::f64::consts::FRAC_PI_6].into();
/// assert!((height(&Arm {}, "hand", &raised).unwrap() - 1.0).abs() < 1e-12);
/// assert_eq!(height(&Arm {}, "foot", &raised), None);
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no frames",
    note = "a mechanism is a struct with the attribute `#[mechanism(…)]`; its prepared form has no frames"
)]
pub trait Frames<const NQ: usize, const NV: usize> {
    /// Scalar type of the mechanism to which the frames belong.
    type Scalar: Real;

    /// Names of the frames, in the order of their indices.
    const FRAMES: &'static [&'static str];

    /// Returns the placement of a frame in the ground frame: its axes and its origin, m.
    fn placement_of(
        &self,
        frame: usize,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
    ) -> Option<IsometryMatrix3<Self::Scalar>>;

    /// Returns the velocity of the frame's origin (m/s), then its angular velocity (rad/s), relative to the
    /// ground, in ground axes.
    fn velocity_of(
        &self,
        frame: usize,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Option<SVector<Self::Scalar, 6>>;

    /// Returns the acceleration of the frame's origin (m/s²), then its angular acceleration (rad/s²),
    /// relative to the ground, in ground axes, without gravity. With zero `a` the result is `J̇ v`, the
    /// contribution of the Jacobian's rate.
    fn acceleration_of(
        &self,
        frame: usize,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> Option<SVector<Self::Scalar, 6>>;

    /// Returns the Jacobian `J` of the frame: its velocity is `J v`, plus the velocity of the driven motion,
    /// if any.
    fn jacobian_of(
        &self,
        frame: usize,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
    ) -> Option<SMatrix<Self::Scalar, 6, NV>>;
}

/// Returns the difference between two placements: the displacement of the origin, m, then the rotation
/// vector, rad, in ground axes. Order and axes are those of a frame's velocity and Jacobian: to first order,
/// a displacement `dq` yields `J dq`. Pose controllers use this difference as their error.
///
/// The result is exact to rounding for angles of any magnitude, including small ones, which are inaccurate if
/// computed from the trace of the rotation matrix. The rotation is the one by at most π.
///
/// ```
/// use linkwork::placement_difference;
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * y)]
/// struct Arm {
///     #[body(mass = 1, com = x)]
///     upper: Body,
///     #[joint(ground -> upper.at(-x), about = z)]
///     shoulder: Pin,
/// }
///
/// let (hand, q, turned) = (frame!(Arm, "upper"), [0.3].into(), [0.3 + 1e-9].into());
/// let moved = placement_difference(&Arm {}.frame_placement(hand, &q), &Arm {}.frame_placement(hand, &turned));
/// assert!((moved - Arm {}.frame_jacobian(hand, &q).column(0) * 1e-9).amax() < 1e-15);
/// ```
pub fn placement_difference<T: Real>(from: &IsometryMatrix3<T>, to: &IsometryMatrix3<T>) -> SVector<T, 6> {
    let way = to.translation.vector - from.translation.vector;
    let turn = UnitQuaternion::from_rotation_matrix(&(to.rotation * from.rotation.inverse())).scaled_axis();
    six([way.x, way.y, way.z, turn.x, turn.y, turn.z])
}

/// Returns the index of a name in a list of names, at run time or in a constant:
/// `index_of(&Panda::VELOCITIES, name)` for a name from a configuration file. [`index!`](crate::index!)
/// checks a name that is a literal.
///
/// ```
/// use linkwork::index_of;
///
/// let names = ["shoulder", "elbow"];
/// assert_eq!(index_of(&names, "elbow"), Some(1));
/// assert_eq!(index_of(&names, "knee"), None);
/// ```
pub const fn index_of(names: &[&str], name: &str) -> Option<usize> {
    let mut k = 0;
    while k < names.len() {
        if has_same_bytes(names[k].as_bytes(), name.as_bytes()) {
            return Some(k);
        }
        k += 1;
    }
    None
}

const fn has_same_bytes(a: &[u8], b: &[u8]) -> bool {
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

/// Converts a placement from twelve numbers (rotation matrix by rows, then position) to nalgebra's type.
#[inline(always)]
pub fn placement<T: Real>(p: &[T; 12]) -> IsometryMatrix3<T> {
    let [a, b, c, d, e, f, g, h, i, x, y, z] = *p;
    let matrix = Matrix3::from_array_storage(ArrayStorage([[a, d, g], [b, e, h], [c, f, i]]));
    Isometry::from_parts(
        Translation3 { vector: Vector3::from_array_storage(ArrayStorage([[x, y, z]])) },
        Rotation3::from_matrix_unchecked(matrix),
    )
}

/// Returns the identity placement, that of the ground.
#[inline(always)]
pub fn identity_placement<T: Real>() -> [T; 12] {
    let (o, i) = (T::zero(), T::one());
    [i, o, o, o, i, o, o, o, i, o, o, o]
}

/// Returns the position of the origin of a placement, which is given as twelve numbers.
#[inline(always)]
pub fn origin<T: Real>(p: &[T; 12]) -> [T; 3] {
    let [.., x, y, z] = *p;
    [x, y, z]
}

/// Returns the twist of a frame's motion, the first six of twelve numbers; the last six are its acceleration.
#[inline(always)]
pub fn twist<T: Real>(motion: &[T; 12]) -> [T; 6] {
    let [a, b, c, d, e, f, ..] = *motion;
    [a, b, c, d, e, f]
}

/// Returns the sum of two twists or accelerations of six numbers each.
#[inline(always)]
pub fn sum<T: Real>(a: &[T; 6], b: &[T; 6]) -> [T; 6] {
    let ([a0, a1, a2, a3, a4, a5], [b0, b1, b2, b3, b4, b5]) = (*a, *b);
    [a0 + b0, a1 + b1, a2 + b2, a3 + b3, a4 + b4, a5 + b5]
}

/// Converts an array of six numbers to nalgebra's vector type.
#[inline(always)]
pub fn six<T: Real>(s: [T; 6]) -> SVector<T, 6> {
    SVector::from_array_storage(ArrayStorage([s]))
}

/// Concatenates two arrays; `N` is the sum of their lengths.
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
    fn frame_names_are_found_and_arrays_joined() {
        assert_eq!(index_of(&["a", "bc"], "bc"), Some(1));
        assert_eq!(index_of(&["a", "bc"], "b"), None);
        assert_eq!(join::<f64, 2, 1, 3>(&[1.0, 2.0], &[3.0]), [1.0, 2.0, 3.0]);
        let p = placement(&identity_placement::<f64>());
        assert_eq!(p, IsometryMatrix3::identity());
    }
}
