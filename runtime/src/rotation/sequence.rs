//! The 24 sequences of Euler angles, as values.

use crate::Real;
use core::fmt;
use nalgebra::{Matrix3, Rotation3};

/// Coordinate axis of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// First coordinate axis.
    X,
    /// Second coordinate axis.
    Y,
    /// Third coordinate axis.
    Z,
}

impl Axis {
    /// Returns the elementary rotation `R_axis(angle)` about this axis, rad, right-handed: an Euler rotation.
    pub fn rotation<T: Real>(self, angle: T) -> Rotation3<T> {
        let (s, c) = angle.sin_cos();
        let (o, i) = (T::zero(), T::one());
        Rotation3::from_matrix_unchecked(match self {
            Self::X => Matrix3::new(i, o, o, o, c, -s, o, s, c),
            Self::Y => Matrix3::new(c, o, s, o, i, o, -s, o, c),
            Self::Z => Matrix3::new(c, -s, o, s, c, o, o, o, i),
        })
    }

    const fn is_equal_to(self, other: Self) -> bool {
        self as u8 == other as u8
    }
}

/// Frame in which the rotation axes of a sequence are fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FixedIn {
    /// The rotation axes are fixed in the body, which the previous rotations have rotated.
    Body,
    /// The rotation axes are fixed in space.
    Space,
}

/// Sequence of three rotations about coordinate axes, no two successive ones equal: one of twelve about body
/// axes and twelve about space axes.
///
/// With the angles `t₁, t₂, t₃`, rad, in the order of the rotations and of the name:
///
/// - body-abc: `R = R_a(t₁) R_b(t₂) R_c(t₃)`;
/// - space-abc: `R = R_c(t₃) R_b(t₂) R_a(t₁)`, which is body-cba with the angles in reverse order.
///
/// A sequence is *asymmetric* with three different axes (Tait–Bryan, Cardan angles), *symmetric* if the first
/// is repeated (proper Euler angles). Source: Kane, Likins and Levinson, §1.7 and appendix I.
/// [`Self::BODY_ZYX`] is yaw, pitch and roll, the 3–2–1 angles of flight dynamics; [`Self::BODY_ZXZ`]
/// precession, nutation and spin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct EulerSequence {
    fixed_in: FixedIn,
    axes: [Axis; 3],
}

macro_rules! sequences {
    ($($body:ident $space:ident = $a:ident $b:ident $c:ident;)+) => {
        /// The twelve sequences of body axes, each followed by the sequence of space axes with the same
        /// letters.
        impl EulerSequence {
            $(
                #[doc = concat!(
                    "Body axes: `R = R_", stringify!($a), "(t₁) R_", stringify!($b), "(t₂) R_", stringify!($c), "(t₃)`."
                )]
                pub const $body: Self =
                    Self { fixed_in: FixedIn::Body, axes: [Axis::$a, Axis::$b, Axis::$c] };
                #[doc = concat!(
                    "Space axes: `R = R_", stringify!($c), "(t₃) R_", stringify!($b), "(t₂) R_", stringify!($a), "(t₁)`."
                )]
                pub const $space: Self =
                    Self { fixed_in: FixedIn::Space, axes: [Axis::$a, Axis::$b, Axis::$c] };
            )+

            /// All 24 Euler-angle sequences.
            pub const ALL: [Self; 24] = [$(Self::$body, Self::$space),+];
        }
    };
}

sequences! {
    BODY_XYX SPACE_XYX = X Y X;
    BODY_XYZ SPACE_XYZ = X Y Z;
    BODY_XZX SPACE_XZX = X Z X;
    BODY_XZY SPACE_XZY = X Z Y;
    BODY_YXY SPACE_YXY = Y X Y;
    BODY_YXZ SPACE_YXZ = Y X Z;
    BODY_YZX SPACE_YZX = Y Z X;
    BODY_YZY SPACE_YZY = Y Z Y;
    BODY_ZXY SPACE_ZXY = Z X Y;
    BODY_ZXZ SPACE_ZXZ = Z X Z;
    BODY_ZYX SPACE_ZYX = Z Y X;
    BODY_ZYZ SPACE_ZYZ = Z Y Z;
}

impl EulerSequence {
    /// Returns the Euler-angle sequence with these axes. Returns `None` if two successive axes are equal,
    /// because such angles do not represent every rotation.
    pub const fn new(fixed_in: FixedIn, axes: [Axis; 3]) -> Option<Self> {
        let [first, second, third] = axes;
        if first.is_equal_to(second) || second.is_equal_to(third) {
            None
        } else {
            Some(Self { fixed_in, axes })
        }
    }

    /// Returns the frame in which the rotation axes are fixed.
    pub const fn fixed_in(self) -> FixedIn {
        self.fixed_in
    }

    /// Returns the axes in the order of the rotations.
    pub const fn axes(self) -> [Axis; 3] {
        self.axes
    }

    /// Whether the third axis equals the first one. Symmetric sequences are singular at the middle angles 0
    /// and π, others at ±π/2.
    pub const fn is_symmetric(self) -> bool {
        let [first, _, third] = self.axes;
        first.is_equal_to(third)
    }
}

impl fmt::Display for EulerSequence {
    /// Writes the name of the sequence of Euler angles, such as `body-zyx`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.fixed_in {
            FixedIn::Body => "body-",
            FixedIn::Space => "space-",
        })?;
        self.axes.iter().try_for_each(|axis| {
            f.write_str(match axis {
                Axis::X => "x",
                Axis::Y => "y",
                Axis::Z => "z",
            })
        })
    }
}
