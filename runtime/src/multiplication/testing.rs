//! Helpers common to the tests of products and inverses.

use nalgebra::SMatrix;

pub fn pseudorandom_matrix<const N: usize, const M: usize>(seed: f64) -> SMatrix<f64, N, M> {
    SMatrix::from_fn(|i, j| (seed + (i * 7 + 5 * j) as f64).sin())
}

/// Expands to the tile type for a given number of rows, in registers of eight numbers or of four.
macro_rules! rows_of {
    ($rows:expr, $wide:literal) => {
        Tile<{ $rows }, { registers_of_eight($rows, $wide) }, { registers_of_four($rows, $wide) }>
    };
}

/// Calls a test function with both tilings for the compilation target, and with the instruction sets of the
/// processor.
macro_rules! everywhere {
    ($function:ident by $rows:expr, $arguments:tt) => {
        $function::<Compiled, rows_of!($rows, true), _, _> $arguments;
        $function::<Compiled, rows_of!($rows, false), _, _> $arguments;
        #[cfg(all(
            feature = "std",
            target_arch = "x86_64",
            not(all(target_feature = "avx2", target_feature = "fma"))
        ))]
        {
            use crate::lanes::x86::{avx2, avx512};
            if avx2::is_available() {
                $function::<avx2::Avx2, rows_of!($rows, false), _, _> $arguments;
            }
            if avx512::is_available() {
                $function::<avx512::Avx512, rows_of!($rows, true), _, _> $arguments;
            }
        }
    };
}
pub(crate) use {everywhere, rows_of};
