//! Products compared with nalgebra's, for all register widths.

use super::testing::{everywhere, numbers, rows_of};
use super::*;
use crate::arithmetic::Compiled;

/// Compares minus the product of two matrices with nalgebra's.
fn check_negated_product<A: Arithmetic, P: Tiling<f64, N>, const N: usize, const M: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SMatrix<f64, N, M>,
    groups: &[(Range, &[usize])],
    expected: &SMatrix<f64, N, M>,
) {
    let (mut found, mut other) = (*b, *b);
    minus_products::<A, _, P, N, M, 2>(a, [(&mut found, &[], groups), (&mut other, &[], groups)]);
    assert_eq!(found, other);
    assert!((found + expected).amax() < 1e-13);
}

#[test]
fn the_product_is_nalgebras() {
    const N: usize = 19;
    let (a, b) = (numbers::<N, N>(0.0), numbers::<N, 10>(1.0));
    let rows: [usize; N] = core::array::from_fn(|k| k);
    everywhere!(check_negated_product by N, (&a, &b, &[((0, 3), &rows), ((3, 10), &rows)], &(a * b)));
}

#[test]
fn rows_are_taken_in_parts() {
    const N: usize = 29;
    let (a, b) = (numbers::<N, N>(0.0), numbers::<N, 7>(1.0));
    let rows: [usize; N] = core::array::from_fn(|k| k);
    everywhere!(check_negated_product by 12, (&a, &b, &[((0, 7), &rows)], &(a * b)));
    for n in 1..300 {
        for rows in [true, false].map(|wide| super::rows(n, wide)) {
            assert!(rows <= n && (rows == n || rows.is_multiple_of(4)), "{n}");
        }
    }
}

#[test]
fn small_matrices_do_not_fill_a_register() {
    let (a, b) = (numbers::<3, 3>(0.0), numbers::<3, 7>(1.0));
    everywhere!(check_negated_product by 3, (&a, &b, &[((0, 7), &[0, 1, 2])], &(a * b)));
}

#[test]
fn rows_that_are_not_named_are_skipped() {
    let (a, mut b) = (numbers::<7, 7>(2.0), numbers::<7, 3>(3.0));
    let mut given = b;
    given.column_mut(1).fill(0.0);
    b.view_mut((2, 0), (2, 1)).fill(0.0);
    b.column_mut(1).fill(0.0);
    b.view_mut((0, 2), (6, 1)).fill(0.0);
    everywhere!(check_negated_product by 7, (&a, &given, &[((0, 1), &[0, 1, 4, 5, 6]), ((2, 3), &[6])], &(a * b)));
}

#[test]
fn entries_are_made_zero() {
    let (a, b) = (numbers::<7, 7>(2.0), numbers::<7, 3>(3.0));
    let (mut found, mut given) = (b, b);
    let groups: [(Range, &[usize]); 1] = [((0, 3), &[0, 1, 2, 3, 4, 5, 6])];
    minus_products::<Compiled, _, (rows_of!(7, true), rows_of!(7, false)), 7, 3, 1>(
        &a,
        [(&mut found, &[(1, 4), (2, 0)], &groups)],
    );
    (given[(4, 1)], given[(0, 2)]) = (0.0, 0.0);
    assert!((found + a * given).amax() < 1e-13);
}
