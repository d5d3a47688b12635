//! Balancing by diagonal scaling with powers of two, which has no rounding errors.

use nalgebra::DMatrix;

/// Maximum number of balancing sweeps; three are usual.
const MAX_SWEEPS: usize = 40;

/// Returns the balanced matrix `D⁻¹ A D`, whose rows and columns have similar norms, and the diagonal of `D`
/// (Parlett and Reinsch, *Balancing a matrix for calculation of eigenvalues and eigenvectors*, 1969).
pub(crate) fn balance_matrix(a: &DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
    let n = a.nrows();
    let empty = (DMatrix::zeros(n, 0), DMatrix::zeros(0, n));
    let (a, _, _, d) = balance_system(a, &empty.0, &empty.1);
    (a, d)
}

/// Returns the balanced system `D⁻¹ A D`, `D⁻¹ B`, `C D`, and the diagonal of `D`. The scales in `D` balance,
/// for each state, its row in `A` and `B` with its column in `A` and `C`.
pub(crate) fn balance_system(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    c: &DMatrix<f64>,
) -> (DMatrix<f64>, DMatrix<f64>, DMatrix<f64>, Vec<f64>) {
    let (mut a, mut b, mut c) = (a.clone(), b.clone(), c.clone());
    let mut d = vec![1.0; a.nrows()];
    for _ in 0..MAX_SWEEPS {
        let mut settled = true;
        for i in 0..d.len() {
            let own = a[(i, i)].abs();
            let row = a.row(i).iter().chain(b.row(i).iter()).map(|x| x.abs()).sum::<f64>() - own;
            let column = a.column(i).iter().chain(c.column(i).iter()).map(|x| x.abs()).sum::<f64>() - own;
            if row <= f64::MIN_POSITIVE || column <= f64::MIN_POSITIVE {
                continue;
            }
            let factor = (0.5 * (row / column).log2()).round().clamp(-200.0, 200.0).exp2();
            if column * factor + row / factor < 0.95 * (column + row) {
                settled = false;
                d[i] *= factor;
                a.row_mut(i).scale_mut(1.0 / factor);
                b.row_mut(i).scale_mut(1.0 / factor);
                a.column_mut(i).scale_mut(factor);
                c.column_mut(i).scale_mut(factor);
            }
        }
        if settled {
            break;
        }
    }
    (a, b, c, d)
}
