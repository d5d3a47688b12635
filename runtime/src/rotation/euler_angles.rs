//! Conversions between Euler angles and rotations.

use super::sequence::EulerSequence;
use super::standard::{StandardSequence, parallel_axes_threshold};
use crate::Real;
use crate::private::constant;
use nalgebra::{ArrayStorage, Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

/// Euler angles of a rotation, with a flag for gimbal lock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles<T> {
    /// Angles in the order of the rotations, rad.
    pub angles: [T; 3],
    /// Whether the first and the third axis are parallel, so that only the sum or the difference of their
    /// angles is determined; the third angle is then set to zero.
    pub singular: bool,
}

impl EulerSequence {
    pub(super) fn standard_sequence(self) -> StandardSequence {
        StandardSequence::new(self)
    }

    /// Returns the rotation matrix of Euler angles `[t₁, t₂, t₃]`, rad, of any magnitude.
    ///
    /// body-abc: `R_a(t₁) R_b(t₂) R_c(t₃)`; space-abc: `R_c(t₃) R_b(t₂) R_a(t₁)`. Columns are the body axes
    /// in space axes. Kane, Likins and Levinson, appendix I. Never singular.
    pub fn rotation<T: Real>(self, angles: [T; 3]) -> Rotation3<T> {
        let standard = self.standard_sequence();
        let [(sa, ca), (sb, cb), (sc, cc)] = standard.to_standard_sequence(angles).map(|t| t.sin_cos());
        // Stored by columns.
        let own = if standard.symmetric {
            [
                [cb, sa * sb, -ca * sb],
                [sb * sc, ca * cc - sa * cb * sc, sa * cc + ca * cb * sc],
                [sb * cc, -ca * sc - sa * cb * cc, ca * cb * cc - sa * sc],
            ]
        } else {
            [
                [cb * cc, ca * sc + sa * sb * cc, sa * sc - ca * sb * cc],
                [-cb * sc, ca * cc - sa * sb * sc, sa * cc + ca * sb * sc],
                [sb, -sa * cb, ca * cb],
            ]
        };
        let axes = standard.standard_axes_as_columns::<T>();
        Rotation3::from_matrix_unchecked(axes * Matrix3::from(own) * axes.transpose())
    }

    /// Returns the Euler parameters of Euler angles, rad, of any magnitude: the product of the half-angle
    /// quaternions of the three rotations. They are continuous in the angles, so that `w` has either sign.
    ///
    /// Source: Shuster. Never singular.
    pub fn quaternion<T: Real>(self, angles: [T; 3]) -> UnitQuaternion<T> {
        let standard = self.standard_sequence();
        let half = constant::<T>(0.5);
        let [a, b, c] = standard.to_standard_sequence(angles).map(|t| t * half);
        let (sb, cb) = b.sin_cos();
        let (own, w) = if standard.symmetric {
            let ((s_sum, c_sum), (s_difference, c_difference)) = ((a + c).sin_cos(), (a - c).sin_cos());
            ([cb * s_sum, sb * c_difference, sb * s_difference], cb * c_sum)
        } else {
            let ((sa, ca), (sc, cc)) = (a.sin_cos(), c.sin_cos());
            (
                [sa * cb * cc + ca * sb * sc, ca * sb * cc - sa * cb * sc, ca * cb * sc + sa * sb * cc],
                ca * cb * cc - sa * sb * sc,
            )
        };
        let u = standard.standard_axes_as_columns::<T>() * Vector3::from(own);
        UnitQuaternion::new_unchecked(Quaternion::from_parts(w, u))
    }

    /// Returns the Euler angles of a rotation, rad: the inverse of [`Self::rotation`].
    ///
    /// - Ranges: first and third angle in [−π, π]; middle angle in [−π/2, π/2] (asymmetric) or [0, π]
    ///   (symmetric). [`Self::other_angles`] gives the second solution.
    /// - Singular at the ends of the middle range, where the first and the third axis are parallel within 4
    ///   ε: the third angle is zero, the first is the whole rotation about both axes, and `singular` is set.
    /// - Accuracy: the angles reproduce the rotation to rounding everywhere. Close to the singularity the
    ///   errors of the first and the third angle are ε / sin(angle between their axes), but they cancel: the
    ///   third angle is computed from the rotation with the first one removed.
    pub fn angles<T: Real>(self, rotation: &Rotation3<T>) -> Angles<T> {
        let standard = self.standard_sequence();
        let axes = standard.standard_axes_as_columns::<T>();
        let own = axes.transpose() * rotation.matrix() * axes;
        let ArrayStorage([[r00, r10, r20], [_, r11, r21], [r02, r12, r22]]) = own.data;
        // Numerator and denominator of the first angle, then sine and cosine of the middle one.
        let (y, x) = if standard.symmetric { (r10, -r20) } else { (-r12, r22) };
        let distance = (y * y + x * x).sqrt();
        let middle = if standard.symmetric { distance.atan2(r00) } else { r02.atan2(distance) };
        let singular = distance <= parallel_axes_threshold();
        let [a, c] = if !singular {
            let first = y.atan2(x);
            let (s, c) = first.sin_cos();
            let (across, along) = (c * r11 + s * r21, s * r20 + c * r10);
            let sine = if standard.symmetric { -(c * r12 + s * r22) } else { along };
            [first, sine.atan2(across)]
        } else if standard.reversed {
            let sine = if standard.symmetric { -r12 } else { r10 };
            [T::zero(), sine.atan2(r11)]
        } else {
            [r21.atan2(r11), T::zero()]
        };
        Angles { angles: standard.reorder_from_standard([a, middle, c]), singular }
    }

    /// Returns the other Euler angles of the same rotation, rad: `[t₁ ± π, ±π − t₂, t₃ ± π]` (asymmetric) or
    /// `[t₁ ± π, −t₂, t₃ ± π]` (symmetric).
    ///
    /// From angles in [−π, π] the results are in [−π, π] too. There are no solutions other than these two, up
    /// to multiples of 2π, unless [`Angles::singular`] is set.
    pub fn other_angles<T: Real>(self, [a, b, c]: [T; 3]) -> [T; 3] {
        let opposite_angle = |t: T| if t > T::zero() { t - T::pi() } else { t + T::pi() };
        let middle = if self.is_symmetric() { -b } else { -opposite_angle(b) };
        [opposite_angle(a), middle, opposite_angle(c)]
    }
}
