//! Tests that compare matrix products and solutions with those of nalgebra, for all register widths and
//! numbers of remaining rows.

use super::registers::MatrixProduct;
use super::solve::SymmetricSystem;
use super::*;
use crate::arithmetic::dispatch::Evaluate;
use crate::multiplication::testing::pseudorandom_matrix;

/// Checks the product of a matrix of `R` rows that is added to another matrix, and solutions of linear
/// systems for `R` right-hand sides.
fn check_product_and_solution<A: Arithmetic, const R: usize, const C: usize>() {
    let (a, b, start) = (
        pseudorandom_matrix::<R, 5>(0.0),
        pseudorandom_matrix::<5, C>(1.0),
        pseudorandom_matrix::<R, C>(2.0),
    );
    let mut found = start;
    MatrixProduct { a: &a, b: &b }.evaluate::<A>(&mut found);
    assert!((found - (start + a * b)).amax() < 1e-13, "{R} rows, {C} columns");

    let half = pseudorandom_matrix::<5, 5>(3.0);
    let matrix = half * half.transpose() + SMatrix::identity();
    let (l, inverse) = factors(&matrix, 0.25).expect("it is positive definite");
    let mut solved = zeros();
    SymmetricSystem { l: &l, inverse: &inverse, b: &a }.evaluate::<A>(&mut solved);
    let left = solved * (matrix + SMatrix::identity() * 0.25) + a;
    assert!(left.amax() < 1e-12, "{R} right-hand sides: {left}");
}

fn check_products_of_all_row_counts<A: Arithmetic>() {
    macro_rules! each {
        ($($columns:literal: $($rows:literal)*;)*) => {
            $($(check_product_and_solution::<A, $rows, $columns>();)*)*
        };
    }
    // All remainders of groups of four columns and of registers of rows.
    each! {
        4: 1 4 9 18 25 41;
        5: 1 4 9 18 25 41;
        18: 1 4 9 18 25 41;
        7: 1 2 3 4 5 6 7 8 9 10 11 12 13 15 16 17 18 20 21 23 24 25 28 29 32 35 36 40 41;
    }
}

#[test]
fn products_and_solutions_match_nalgebra() {
    check_products_of_all_row_counts::<Compiled>();
    #[cfg(all(
        feature = "std",
        target_arch = "x86_64",
        not(all(target_feature = "avx2", target_feature = "fma"))
    ))]
    {
        use crate::lanes::x86::{avx2, avx512};
        if avx2::is_available() {
            check_products_of_all_row_counts::<avx2::Avx2>();
        }
        if avx512::is_available() {
            check_products_of_all_row_counts::<avx512::Avx512>();
        }
    }
}
