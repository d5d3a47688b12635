//! Tests that compare matrix products with those of nalgebra, for all register widths.

use super::testing::{everywhere, pseudorandom_matrix, rows_of};
use super::*;
use crate::arithmetic::Compiled;

/// Checks that the negative product of two matrices equals that of nalgebra.
fn check_negated_product<A: Arithmetic, P: Tiling<f64, N>, const N: usize, const M: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SMatrix<f64, N, M>,
    groups: &[(IndexRange, &[usize])],
    expected: &SMatrix<f64, N, M>,
) {
    let (mut found, mut other) = (*b, *b);
    replace_by_negative_products::<A, _, P, N, M, 2>(
        a,
        [(&mut found, &[], groups), (&mut other, &[], groups)],
    );
    assert_eq!(found, other);
    assert!((found + expected).amax() < 1e-13);
}

#[test]
fn product_matches_nalgebra() {
    const N: usize = 19;
    let (a, b) = (pseudorandom_matrix::<N, N>(0.0), pseudorandom_matrix::<N, 10>(1.0));
    let rows: [usize; N] = core::array::from_fn(|k| k);
    everywhere!(check_negated_product by N, (&a, &b, &[((0, 3), &rows), ((3, 10), &rows)], &(a * b)));
}

#[test]
fn row_group_products_are_correct() {
    const N: usize = 29;
    let (a, b) = (pseudorandom_matrix::<N, N>(0.0), pseudorandom_matrix::<N, 7>(1.0));
    let rows: [usize; N] = core::array::from_fn(|k| k);
    everywhere!(check_negated_product by 12, (&a, &b, &[((0, 7), &rows)], &(a * b)));
    for n in 1..300 {
        for rows in [true, false].map(|wide| super::rows(n, wide)) {
            assert!(rows <= n && (rows == n || rows.is_multiple_of(4)), "{n}");
        }
    }
}

#[test]
fn products_smaller_than_register_are_correct() {
    let (a, b) = (pseudorandom_matrix::<3, 3>(0.0), pseudorandom_matrix::<3, 7>(1.0));
    everywhere!(check_negated_product by 3, (&a, &b, &[((0, 7), &[0, 1, 2])], &(a * b)));
}

#[test]
fn unlisted_rows_are_skipped() {
    let (a, mut b) = (pseudorandom_matrix::<7, 7>(2.0), pseudorandom_matrix::<7, 3>(3.0));
    let mut given = b;
    given.column_mut(1).fill(0.0);
    b.view_mut((2, 0), (2, 1)).fill(0.0);
    b.column_mut(1).fill(0.0);
    b.view_mut((0, 2), (6, 1)).fill(0.0);
    everywhere!(check_negated_product by 7, (&a, &given, &[((0, 1), &[0, 1, 4, 5, 6]), ((2, 3), &[6])], &(a * b)));
}

#[test]
fn product_zeroes_listed_factor_entries() {
    let (a, b) = (pseudorandom_matrix::<7, 7>(2.0), pseudorandom_matrix::<7, 3>(3.0));
    let (mut found, mut given) = (b, b);
    let groups: [(IndexRange, &[usize]); 1] = [((0, 3), &[0, 1, 2, 3, 4, 5, 6])];
    replace_by_negative_products::<Compiled, _, (rows_of!(7, true), rows_of!(7, false)), 7, 3, 1>(
        &a,
        [(&mut found, &[(1, 4), (2, 0)], &groups)],
    );
    (given[(4, 1)], given[(0, 2)]) = (0.0, 0.0);
    assert!((found + a * given).amax() < 1e-13);
}
