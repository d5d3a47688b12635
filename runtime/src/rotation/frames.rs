//! Vectors and matrices in components: wedge products, vectorised matrices, frames whose axes are neither
//! perpendicular nor of unit length. For Kronecker products use nalgebra's `kronecker`.

use crate::Real;
use nalgebra::{ArrayStorage, Matrix3, SVector, Vector3};

/// Returns the wedge product `a ∧ b = b aᵀ − a bᵀ` as a matrix: the cross-product matrix of `a × b`, `(a ×
/// b)ₓ`.
///
/// ```
/// use linkwork::nalgebra::Vector3;
/// use linkwork::rotation::wedge;
///
/// let (a, b) = (Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.5, 4.0, -1.0));
/// assert_eq!(wedge(&a, &b), a.cross(&b).cross_matrix());
/// ```
pub fn wedge<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Matrix3<T> {
    b * a.transpose() - a * b.transpose()
}

/// Returns the columns of a matrix, one below the other: `vec M`, which satisfies `vec(A M B) = (Bᵀ ⊗ A) vec
/// M`.
///
/// ```
/// use linkwork::nalgebra::Matrix3;
/// use linkwork::rotation::{unvectorized, vectorized};
///
/// let m = Matrix3::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.5);
/// let (a, b) = (m * m - m.transpose(), m.transpose() + Matrix3::identity());
/// assert_eq!(vectorized(&m)[1], 4.0);
/// assert!((vectorized(&(a * m * b)) - b.transpose().kronecker(&a) * vectorized(&m)).amax() < 1e-10);
/// assert_eq!(unvectorized(&vectorized(&m)), m);
/// ```
pub fn vectorized<T: Real>(matrix: &Matrix3<T>) -> SVector<T, 9> {
    let ArrayStorage([[a, b, c], [d, e, f], [g, h, i]]) = matrix.data;
    SVector::from([a, b, c, d, e, f, g, h, i])
}

/// Returns the 3 × 3 matrix whose columns, one below the other, form a vector of nine numbers: the inverse of
/// [`vectorized`].
pub fn unvectorized<T: Real>(columns: &SVector<T, 9>) -> Matrix3<T> {
    let ArrayStorage([[a, b, c, d, e, f, g, h, i]]) = columns.data;
    Matrix3::from_array_storage(ArrayStorage([[a, b, c], [d, e, f], [g, h, i]]))
}

/// Returns the reciprocal frame of three vectors, the columns `f₁, f₂, f₃`: columns `g₁, g₂, g₃` with `gᵢ·fⱼ
/// = 1` for `i = j` and zero otherwise. The components of a vector `v` in the frame are `gᵢ·v`: `v = Σ (gᵢ·v)
/// fᵢ`. `None` for coplanar vectors.
///
/// ```
/// use linkwork::nalgebra::{Matrix3, Vector3};
/// use linkwork::rotation::reciprocal;
///
/// let frame = Matrix3::from_columns(&[Vector3::x(), Vector3::new(1.0, 2.0, 0.0), Vector3::new(0.0, 1.0, 3.0)]);
/// let g = reciprocal(&frame).unwrap();
/// assert!((g.transpose() * frame - Matrix3::identity()).amax() < 1e-15);
/// let v = Vector3::new(0.3, -2.0, 1.0);
/// assert!((frame * (g.transpose() * v) - v).amax() < 1e-15);
/// let flat: Matrix3<f64> = Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::x()]);
/// assert!(reciprocal(&flat).is_none());
/// ```
pub fn reciprocal<T: Real>(frame: &Matrix3<T>) -> Option<Matrix3<T>> {
    frame.try_inverse().map(|inverse| inverse.transpose())
}
