//! Axis and angle of a rotation. By Euler's theorem every rotation is a rotation about one axis.

use super::euler_parameters::quaternion_of_rotation;
use super::rotation_vector::RotationVector;
use crate::Real;
use crate::private::constant;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Returns the rotation by `angle`, rad, about an axis (the same in space and in body axes): Rodrigues's
/// formula `R = 1 + sin θ [n]ₓ + (1 − cos θ) [n]ₓ²`. Never singular.
///
/// Kane, Likins and Levinson, §1.1; Bernstein, Goel and Ansari, ch. 2. `1 − cos θ` is taken as `2 sin²(θ/2)`,
/// so small angles lose no digits.
pub fn rodrigues<T: Real>(axis: &Unit<Vector3<T>>, angle: T) -> Rotation3<T> {
    let cross = axis.cross_matrix();
    let (sine, versine) = sine_and_versine(angle);
    Rotation3::from_matrix_unchecked(Matrix3::identity() + cross * sine + cross * cross * versine)
}

/// Returns a vector rotated by `angle`, rad, about an axis: `v + sin θ n × v + (1 − cos θ) n × (n × v)`.
pub fn rotate_about<T: Real>(axis: &Unit<Vector3<T>>, angle: T, v: &Vector3<T>) -> Vector3<T> {
    let (sine, versine) = sine_and_versine(angle);
    let first = axis.cross(v);
    v + first * sine + axis.cross(&first) * versine
}

fn sine_and_versine<T: Real>(angle: T) -> (T, T) {
    let half_sine = (angle * constant(0.5)).sin();
    (angle.sin(), constant::<T>(2.0) * half_sine * half_sine)
}

/// Returns the axis and the angle, in (0, π] rad, of a rotation; `None` for the identity, which has no axis.
/// For the angle π the sign of the axis is arbitrary.
pub fn eigenaxis<T: Real>(rotation: &Rotation3<T>) -> Option<(Unit<Vector3<T>>, T)> {
    let q = quaternion_of_rotation(rotation);
    let u = q.imag();
    // Scaled first, so that squares do not underflow.
    let largest = u.amax();
    if largest > T::zero() {
        Some((Unit::new_normalize(u / largest), RotationVector::from_quaternion(&q).angle()))
    } else {
        None
    }
}

/// Returns the angle of the rotation from one orientation to another, in [0, π] rad, accurate also near 0 and
/// π.
pub fn angle_between<T: Real>(from: &Rotation3<T>, to: &Rotation3<T>) -> T {
    RotationVector::from_rotation(&(from.inverse() * to)).angle()
}
