//! Matrix exponential.

use super::{checked_square_size, norm_one, solve_linear_system};
use crate::Error;
use nalgebra::DMatrix;

/// One-norm below which the Padé approximation of degree 13 is exact to rounding.
const LARGEST: f64 = 5.371920351148152;

/// Computes `e^A` by scaling, the Padé approximation of degree 13, and squaring (Higham, *The scaling and
/// squaring method for the matrix exponential revisited*, 2005).
///
/// ```
/// use linkwork_design::matrices::exponential;
/// use nalgebra::dmatrix;
///
/// let turn = exponential(&dmatrix![0.0, -1.0; 1.0, 0.0])?;
/// assert!((turn[(1, 0)] - 1.0_f64.sin()).abs() < 1e-15);
/// # Ok::<(), linkwork_design::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Shape`] and [`Error::NotFinite`] for a matrix that is not square or not finite,
/// [`Error::NotFinite`] also for a result that overflows.
pub fn exponential(a: &DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    const B: [f64; 14] = [
        64764752532480000.0,
        32382376266240000.0,
        7771770303897600.0,
        1187353796428800.0,
        129060195264000.0,
        10559470521600.0,
        670442572800.0,
        33522128640.0,
        1323241920.0,
        40840800.0,
        960960.0,
        16380.0,
        182.0,
        1.0,
    ];
    let n = checked_square_size("A", a)?;
    if n == 0 {
        return Ok(a.clone());
    }
    let squarings = (norm_one(a) / LARGEST).log2().ceil().max(0.0);
    if squarings > 1000.0 {
        return Err(Error::NotFinite { what: "the exponential" });
    }
    let a = a * (-squarings).exp2();
    let identity = DMatrix::<f64>::identity(n, n);
    let a2 = &a * &a;
    let a4 = &a2 * &a2;
    let a6 = &a2 * &a4;
    let low_order_sum = |low: [f64; 4]| &a6 * low[3] + &a4 * low[2] + &a2 * low[1] + &identity * low[0];
    let high_order_sum = |b: [f64; 3]| &a6 * (&a6 * b[2] + &a4 * b[1] + &a2 * b[0]);
    let odd = &a * (high_order_sum([B[9], B[11], B[13]]) + low_order_sum([B[1], B[3], B[5], B[7]]));
    let even = high_order_sum([B[8], B[10], B[12]]) + low_order_sum([B[0], B[2], B[4], B[6]]);
    let mut e = solve_linear_system("the exponential's denominator", &(&even - &odd), &(&even + &odd))?;
    for _ in 0..squarings as usize {
        e = &e * &e;
    }
    if e.iter().all(|x| x.is_finite()) { Ok(e) } else { Err(Error::NotFinite { what: "the exponential" }) }
}
