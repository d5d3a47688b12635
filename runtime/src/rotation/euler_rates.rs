//! Conversions between Euler angle rates and angular velocity.

use super::sequence::EulerSequence;
use super::singular::Singular;
use super::standard::parallel_axes_threshold;
use crate::Real;
use nalgebra::{Matrix3, RowVector3, Vector3};

impl EulerSequence {
    /// Returns the matrix `B` with `ω_body = B (ṫ₁, ṫ₂, ṫ₃)` at these angles, rad: the axes of the three
    /// rotations, resolved in body axes.
    ///
    /// Kane, Likins and Levinson, appendix II. If the first and the third axis are parallel, the matrix is
    /// correct, but has no inverse.
    pub fn body_rate_matrix<T: Real>(self, angles: [T; 3]) -> Matrix3<T> {
        let standard = self.standard_sequence();
        let [_, (sb, cb), (sc, cc)] = standard.to_standard_sequence(angles).map(|t| t.sin_cos());
        let (o, i) = (T::zero(), T::one());
        let columns = if standard.symmetric {
            [Vector3::new(cb, sb * sc, sb * cc), Vector3::new(o, cc, -sc), Vector3::new(i, o, o)]
        } else {
            [Vector3::new(cb * cc, -cb * sc, sb), Vector3::new(sc, cc, o), Vector3::new(o, o, i)]
        };
        standard.standard_axes_as_columns::<T>()
            * Matrix3::from_columns(&standard.reorder_from_standard(columns))
    }

    /// Returns the matrix `B` with `ω_space = B (ṫ₁, ṫ₂, ṫ₃)` at these angles, rad: the axes of the three
    /// rotations, resolved in space axes.
    ///
    /// Source and singular case as for [`Self::body_rate_matrix`].
    pub fn space_rate_matrix<T: Real>(self, angles: [T; 3]) -> Matrix3<T> {
        let standard = self.standard_sequence();
        let [(sa, ca), (sb, cb), _] = standard.to_standard_sequence(angles).map(|t| t.sin_cos());
        let (o, i) = (T::zero(), T::one());
        let third = if standard.symmetric { [cb, sa * sb, -ca * sb] } else { [sb, -sa * cb, ca * cb] };
        let columns = [Vector3::new(i, o, o), Vector3::new(o, ca, sa), Vector3::from(third)];
        standard.standard_axes_as_columns::<T>()
            * Matrix3::from_columns(&standard.reorder_from_standard(columns))
    }

    /// Returns the inverse of [`Self::body_rate_matrix`]: `(ṫ₁, ṫ₂, ṫ₃) = B⁻¹ ω_body`.
    ///
    /// # Errors
    ///
    /// [`Singular::ParallelAxes`] where `cos t₂` (asymmetric) or `sin t₂` (symmetric) is below 4 ε max(1,
    /// |t₂|): zero to the rounding of the angle.
    pub fn inverse_body_rate_matrix<T: Real>(self, angles: [T; 3]) -> Result<Matrix3<T>, Singular> {
        let standard = self.standard_sequence();
        let [_, b, c] = standard.to_standard_sequence(angles);
        let ((sb, cb), (sc, cc)) = (b.sin_cos(), c.sin_cos());
        let (o, i) = (T::zero(), T::one());
        let rows = if standard.symmetric {
            let sine = nonzero_sine(sb, b)?;
            let first = RowVector3::new(o, sc, cc) / sine;
            [first, RowVector3::new(o, cc, -sc), RowVector3::new(i, o, o) - first * cb]
        } else {
            let sine = nonzero_sine(cb, b)?;
            let first = RowVector3::new(cc, -sc, o) / sine;
            [first, RowVector3::new(sc, cc, o), RowVector3::new(o, o, i) - first * sb]
        };
        Ok(Matrix3::from_rows(&standard.reorder_from_standard(rows))
            * standard.standard_axes_as_columns::<T>().transpose())
    }

    /// Returns the inverse of [`Self::space_rate_matrix`]: `(ṫ₁, ṫ₂, ṫ₃) = B⁻¹ ω_space`.
    ///
    /// # Errors
    ///
    /// The errors of [`Self::inverse_body_rate_matrix`].
    pub fn inverse_space_rate_matrix<T: Real>(self, angles: [T; 3]) -> Result<Matrix3<T>, Singular> {
        let standard = self.standard_sequence();
        let [a, b, _] = standard.to_standard_sequence(angles);
        let ((sa, ca), (sb, cb)) = (a.sin_cos(), b.sin_cos());
        let (o, i) = (T::zero(), T::one());
        let (third, along) = if standard.symmetric {
            (RowVector3::new(o, sa, -ca) / nonzero_sine(sb, b)?, cb)
        } else {
            (RowVector3::new(o, -sa, ca) / nonzero_sine(cb, b)?, sb)
        };
        let rows = [RowVector3::new(i, o, o) - third * along, RowVector3::new(o, ca, sa), third];
        Ok(Matrix3::from_rows(&standard.reorder_from_standard(rows))
            * standard.standard_axes_as_columns::<T>().transpose())
    }

    /// Returns the angular velocity in body axes, rad/s, at these angles, rad, and rates, rad/s.
    pub fn omega_body<T: Real>(self, angles: [T; 3], rates: [T; 3]) -> Vector3<T> {
        self.body_rate_matrix(angles) * Vector3::from(rates)
    }

    /// Returns the angular velocity in space axes, rad/s, at these angles, rad, and rates, rad/s.
    pub fn omega_space<T: Real>(self, angles: [T; 3], rates: [T; 3]) -> Vector3<T> {
        self.space_rate_matrix(angles) * Vector3::from(rates)
    }

    /// Returns the rates of the angles, rad/s, at these angles, rad, for an angular velocity in body axes,
    /// rad/s.
    ///
    /// # Errors
    ///
    /// The errors of [`Self::inverse_body_rate_matrix`].
    pub fn rates_from_body<T: Real>(self, angles: [T; 3], omega: &Vector3<T>) -> Result<[T; 3], Singular> {
        Ok((self.inverse_body_rate_matrix(angles)? * omega).into())
    }

    /// Returns the rates of the angles, rad/s, at these angles, rad, for an angular velocity in space axes,
    /// rad/s.
    ///
    /// # Errors
    ///
    /// The errors of [`Self::inverse_body_rate_matrix`].
    pub fn rates_from_space<T: Real>(self, angles: [T; 3], omega: &Vector3<T>) -> Result<[T; 3], Singular> {
        Ok((self.inverse_space_rate_matrix(angles)? * omega).into())
    }
}

/// Returns `sine`, the sine of the angle between the first and the third axis of Euler angles, or an error if
/// it is zero to the rounding of the middle angle.
fn nonzero_sine<T: Real>(sine: T, middle: T) -> Result<T, Singular> {
    // NaN passes this test: it comes from the caller and is not a singularity.
    if sine.abs() <= parallel_axes_threshold::<T>() * middle.abs().max(T::one()) {
        Err(Singular::ParallelAxes)
    } else {
        Ok(sine)
    }
}
