//! Exponential and logarithm of rotations, and rates of rotation vectors.

use super::euler_parameters::quaternion_of_rotation;
use super::singular::Singular;
use super::standard::parallel_axes_threshold;
use crate::Real;
use crate::lie::{ball_tangent_rate, left_jacobian_factors, quaternion_exponential, quaternion_logarithm};
use crate::private::constant;
use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};

/// Rotation vector `φ = θ n`, rad: eigenaxis times angle, of any magnitude; the same in space and in body
/// axes.
///
/// Source: Shuster. Vectors longer than π are rotations by more than half a revolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotationVector<T>(pub Vector3<T>);

impl<T: Real> RotationVector<T> {
    /// Returns the rotation matrix, the exponential of `[φ]ₓ`: `1 + (sin θ / θ) [φ]ₓ + ((1 − cos θ) / θ²)
    /// [φ]ₓ²`.
    ///
    /// It is computed through the Euler parameters, and accurate near zero, where their factor is a series.
    /// Never singular.
    pub fn rotation(&self) -> Rotation3<T> {
        self.quaternion().to_rotation_matrix()
    }

    /// Returns the Euler parameters `(n sin(θ/2), cos(θ/2))`, with `w < 0` for `θ` between π and 3π.
    pub fn quaternion(&self) -> UnitQuaternion<T> {
        let [x, y, z, w] = quaternion_exponential(self.0.into());
        UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
    }

    /// Returns the shortest rotation vector of a rotation matrix, `|φ| ≤ π`: its logarithm.
    ///
    /// It is computed through the Euler parameters, and therefore accurate near zero and near π, where the
    /// skew-symmetric part of the matrix contains no information. For an angle of π, either of two opposite
    /// vectors is returned.
    pub fn from_rotation(rotation: &Rotation3<T>) -> Self {
        Self::from_quaternion(&quaternion_of_rotation(rotation))
    }

    /// Returns the shortest rotation vector of Euler parameters, `|φ| ≤ π`; `q` and `−q` yield the same
    /// vector, except for an angle of π.
    pub fn from_quaternion(q: &UnitQuaternion<T>) -> Self {
        let u = q.imag();
        Self(quaternion_logarithm([u.x, u.y, u.z, q.w]).into())
    }

    /// Returns the magnitude `|φ|`, rad: the rotation angle.
    pub fn angle(&self) -> T {
        let largest = self.0.amax();
        if largest > T::zero() { (self.0 / largest).norm() * largest } else { T::zero() }
    }

    /// Returns the rotation vector of the same rotation in the opposite direction, `φ (1 − 2π / |φ|)`, whose
    /// quaternion is the antipode. If this vector is shorter than 2π, the result is the only other one
    /// shorter than 2π.
    ///
    /// # Errors
    ///
    /// [`Singular::FullTurn`] for the zero vector, whose shadow is a rotation by 2π about any axis.
    pub fn shadow(&self) -> Result<Self, Singular> {
        let angle = self.angle();
        if angle > T::zero() {
            // The direction is computed first, because 2π / |φ| may be infinite.
            let direction = self.0 / angle;
            Ok(Self(direction * (angle - T::two_pi())))
        } else {
            Err(Singular::FullTurn)
        }
    }

    /// Returns the rate `φ̇ = ω + ½ φ × ω + ((1 − (θ/2) cot(θ/2)) / θ²) φ × (φ × ω)`, rad/s, for an angular
    /// velocity in body axes, rad/s.
    ///
    /// Source: Shuster (Bortz's equation). The factor is a series near zero.
    ///
    /// # Errors
    ///
    /// [`Singular::FullTurn`] if `|φ|` is a nonzero multiple of 2π, to rounding.
    pub fn rate_from_body(&self, omega: &Vector3<T>) -> Result<Vector3<T>, Singular> {
        let half = self.angle() * constant(0.5);
        if half > T::one() && half.sin().abs() <= parallel_axes_threshold::<T>() * half {
            return Err(Singular::FullTurn);
        }
        Ok(ball_tangent_rate(self.0.into(), (*omega).into()).into())
    }

    /// Returns the rate of the rotation vector, `φ̇ = ω − ½ φ × ω + …` (as in body axes with the opposite
    /// sign of the second term), rad/s, for an angular velocity in space axes, rad/s.
    ///
    /// # Errors
    ///
    /// The errors of [`Self::rate_from_body`].
    pub fn rate_from_space(&self, omega: &Vector3<T>) -> Result<Vector3<T>, Singular> {
        // The inverse rotation −φ has the angular velocity −ω in its body axes.
        Ok(-Self(-self.0).rate_from_body(&-omega)?)
    }

    /// Returns the angular velocity in body axes, rad/s: `ω = φ̇ − ((1 − cos θ) / θ²) φ × φ̇ + ((θ − sin θ) /
    /// θ³) φ × (φ × φ̇)`. Never singular.
    pub fn omega_body(&self, rate: &Vector3<T>) -> Vector3<T> {
        -Self(-self.0).omega_space(&-rate)
    }

    /// Returns the angular velocity in space axes, rad/s: `ω = φ̇ + ((1 − cos θ) / θ²) φ × φ̇ + ((θ − sin θ)
    /// / θ³) φ × (φ × φ̇)`. Never singular.
    pub fn omega_space(&self, rate: &Vector3<T>) -> Vector3<T> {
        let [versine, cubic] = left_jacobian_factors(self.0.norm_squared());
        let first = self.0.cross(rate);
        rate + first * versine + self.0.cross(&first) * cubic
    }
}
