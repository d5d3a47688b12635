//! Random rotations and error measures for the tests of rotations.

mod angles;
mod nearest;
mod parameters;
mod rates;
mod table;

use crate::Real;
use nalgebra::{Matrix3, Quaternion, Rotation3, SMatrix, UnitQuaternion, Vector3};

/// SplitMix64 generator (Steele, Lea and Flood), with the same numbers on every run.
struct RandomNumbers(u64);

impl RandomNumbers {
    /// Returns a pseudorandom number uniform in [−1, 1).
    fn random_number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn random_numbers<const N: usize>(&mut self) -> [f64; N] {
        core::array::from_fn(|_| self.random_number())
    }

    fn random_vector(&mut self) -> Vector3<f64> {
        self.random_numbers().into()
    }

    /// Returns a quaternion uniform over all rotations, with `w` of either sign.
    fn random_quaternion(&mut self) -> UnitQuaternion<f64> {
        loop {
            let q = Quaternion::from(self.random_numbers::<4>());
            if (0.01..1.0).contains(&q.norm()) {
                return UnitQuaternion::new_normalize(q);
            }
        }
    }

    fn random_rotation(&mut self) -> Rotation3<f64> {
        self.random_quaternion().to_rotation_matrix()
    }

    fn random_axis(&mut self) -> Vector3<f64> {
        self.random_quaternion() * Vector3::x()
    }
}

/// Returns the largest magnitude of the differences between the entries of two matrices; infinite if an entry
/// is NaN.
fn largest_entry_difference<const N: usize, const M: usize>(
    a: &SMatrix<f64, N, M>,
    b: &SMatrix<f64, N, M>,
) -> f64 {
    (a - b).iter().fold(0.0, |far: f64, x| if x.is_nan() { f64::INFINITY } else { far.max(x.abs()) })
}

/// Returns the largest difference between three angles and three others, rad, modulo 2π.
fn largest_euler_angle_difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    largest_entry_difference(&Vector3::from(a), &Vector3::from(b))
}

/// Returns the largest magnitude of the entries of `Rᵀ R − 1`, which is zero for a rotation matrix `R`.
fn orthogonality_error(rotation: &Rotation3<f64>) -> f64 {
    largest_entry_difference(&(rotation.matrix().transpose() * rotation.matrix()), &Matrix3::identity())
}

/// Returns the derivative of `f` at zero by central differences of order eight. The error is about 1e-13 if
/// `f` and its derivatives are of order one.
fn derivative_at_zero<const N: usize, const M: usize>(
    f: impl Fn(f64) -> SMatrix<f64, N, M>,
) -> SMatrix<f64, N, M> {
    let h = 0.01;
    [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0]
        .iter()
        .zip(1_u8..)
        .fold(SMatrix::zeros(), |sum, (weight, k)| {
            sum + (f(f64::from(k) * h) - f(-f64::from(k) * h)) * (weight / h)
        })
}

/// Asserts that an error is at most a bound. The panic message contains `place`, which identifies the case.
fn assert_error_below_bound(error: f64, bound: f64, place: impl core::fmt::Debug) {
    assert!(error <= bound, "{error:e} > {bound:e} at {place:?}");
}

/// Returns a constant of type `T`, for tests of `f32` and of generic code.
fn convert_number<T: Real>(x: f64) -> T {
    crate::private::constant(x)
}
