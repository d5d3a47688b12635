//! The product of matrices for generated code. It never allocates, as nalgebra's own does for large matrices.

use crate::Real;
use crate::private::neg_mul_add;
use nalgebra::SMatrix;

/// `−a b`.
#[inline]
pub fn minus_product<T: Real, const N: usize, const M: usize>(
    a: &SMatrix<T, N, N>,
    b: &SMatrix<T, N, M>,
) -> SMatrix<T, N, M> {
    let mut product = SMatrix::<T, N, M>::zeros();
    for (result, column) in product.data.0.iter_mut().zip(&b.data.0) {
        // A column of its own stays in registers.
        let mut sums = [T::zero(); N];
        for (left, factor) in a.data.0.iter().zip(column) {
            for (sum, left) in sums.iter_mut().zip(left) {
                *sum = neg_mul_add(*left, *factor, *sum);
            }
        }
        *result = sums;
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_nalgebras_product() {
        let a = SMatrix::<f64, 7, 7>::from_fn(|i, j| (i * 7 + j) as f64);
        let b = SMatrix::<f64, 7, 9>::from_fn(|i, j| i as f64 - 2.0 * j as f64);
        assert_eq!(minus_product(&a, &b), -(a * b));
    }
}
