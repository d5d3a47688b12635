//! Rotation that is nearest to a given matrix.

use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::{ArrayStorage, Matrix3, Quaternion, Rotation3, UnitQuaternion};

/// Returns the rotation nearest to a matrix `M`, in the sum of squares of the entries of `R − M`. It
/// orthonormalises a rotation matrix with noise or integration drift, and solves Wahba's problem for `M = Σ
/// aₖ v_space v_bodyᵀ`.
///
/// - Method: `R` maximises `tr(Mᵀ R)`, a quadratic form in the Euler parameters, which are therefore the
///   eigenvector of its largest eigenvalue (Davenport's q-method; Shuster and Oh, Journal of Guidance and
///   Control 4 (1981) 70). The eigenvector is computed by Jacobi's method. `M` may contain reflections and
///   scalings.
/// - `None` if the entries are not finite, or if the nearest rotation is not unique to rounding: with the
///   singular values `s₁ ≥ s₂ ≥ s₃`, if `s₂ + s₃ sign(det M)` is zero, as for matrices of rank one and for
///   reflections.
/// - Accuracy: a few ε (s₁ / (s₂ ± s₃)).
pub fn nearest_rotation<T: Real>(matrix: &Matrix3<T>) -> Option<Rotation3<T>> {
    let scale = matrix.amax();
    if !matrix.iter().all(|x| x.is_finite()) || scale == T::zero() {
        return None;
    }
    let ArrayStorage([[xx, yx, zx], [xy, yy, zy], [xz, yz, zz]]) = (matrix / scale).data;
    let form = [
        [xx - yy - zz, xy + yx, zx + xz, zy - yz],
        [xy + yx, yy - xx - zz, yz + zy, xz - zx],
        [zx + xz, yz + zy, zz - xx - yy, yx - xy],
        [zy - yz, xz - zx, yx - xy, xx + yy + zz],
    ];
    let ([x, y, z, w], gap) = dominant_eigenvector(form);
    let unit = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    // A gap of NaN fails the test.
    if gap > constant::<T>(32.0) * epsilon::<T>() { Some(unit.to_rotation_matrix()) } else { None }
}

/// Number of sweeps of Jacobi's method. It converges quadratically, in about six sweeps for `f64`.
const SWEEPS: usize = 16;

/// Returns the eigenvector of the largest eigenvalue of a symmetric matrix, and the distance to the next
/// eigenvalue.
fn dominant_eigenvector<T: Real>(mut form: [[T; 4]; 4]) -> ([T; 4], T) {
    let (o, i) = (T::zero(), T::one());
    let mut vectors = [[i, o, o, o], [o, i, o, o], [o, o, i, o], [o, o, o, i]];
    for _ in 0..SWEEPS {
        annihilate_off_diagonal::<T, 0, 1>(&mut form, &mut vectors);
        annihilate_off_diagonal::<T, 2, 3>(&mut form, &mut vectors);
        annihilate_off_diagonal::<T, 0, 2>(&mut form, &mut vectors);
        annihilate_off_diagonal::<T, 1, 3>(&mut form, &mut vectors);
        annihilate_off_diagonal::<T, 0, 3>(&mut form, &mut vectors);
        annihilate_off_diagonal::<T, 1, 2>(&mut form, &mut vectors);
    }
    let [[a, ..], [_, b, ..], [_, _, c, _], [.., d]] = form;
    let [mut best, others @ ..] = [a, b, c, d];
    let [mut vector, other_vectors @ ..] = vectors;
    // Lower bound of the eigenvalues of the form of a matrix with entries in [−1, 1].
    let mut next = constant::<T>(-16.0);
    for (value, candidate) in others.into_iter().zip(other_vectors) {
        if value > best {
            (next, best, vector) = (best, value, candidate);
        } else {
            next = next.max(value);
        }
    }
    (vector, best - next)
}

/// Rotates the rows and columns `P` and `Q` of a symmetric matrix so that their common off-diagonal entry
/// vanishes. The eigenvectors are the rows of `vectors`.
///
/// Golub and Van Loan, *Matrix Computations* (2013), §8.5.
fn annihilate_off_diagonal<T: Real, const P: usize, const Q: usize>(
    form: &mut [[T; 4]; 4],
    vectors: &mut [[T; 4]; 4],
) {
    let entry = form[P][Q];
    // Negligible in a matrix with eigenvalues of order one.
    if entry.abs() <= epsilon::<T>() * epsilon() {
        return;
    }
    let cotangent = (form[Q][Q] - form[P][P]) / (entry + entry);
    let magnitude = T::one() / (cotangent.abs() + (T::one() + cotangent * cotangent).sqrt());
    let tangent = if cotangent < T::zero() { -magnitude } else { magnitude };
    let c = T::one() / (T::one() + tangent * tangent).sqrt();
    let s = tangent * c;
    for row in form.iter_mut() {
        (row[P], row[Q]) = (c * row[P] - s * row[Q], s * row[P] + c * row[Q]);
    }
    for rows in [form, vectors] {
        let (p, q) = (rows[P], rows[Q]);
        (rows[P], rows[Q]) = (linear_combination(c, p, -s, q), linear_combination(s, p, c, q));
    }
}

/// Returns the linear combination `a p + b q` of two quaternions.
fn linear_combination<T: Real>(a: T, [p0, p1, p2, p3]: [T; 4], b: T, [q0, q1, q2, q3]: [T; 4]) -> [T; 4] {
    [a * p0 + b * q0, a * p1 + b * q1, a * p2 + b * q2, a * p3 + b * q3]
}
