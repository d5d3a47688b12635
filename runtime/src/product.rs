//! The inverse of a mass matrix and products with it, for generated code. They never allocate, as nalgebra's own do for large
//! matrices, and skip what is known to be zero.

mod column;
pub(crate) use column::{part, put};
mod inverse;

use crate::Real;
use crate::arithmetic::Arithmetic;
use crate::lanes::Work;
use column::{Column, Columns, Source};
pub use column::{eights, fours};
use core::marker::PhantomData;
pub use inverse::{complete, invert};
use nalgebra::SMatrix;

/// So many numbers fill several registers of eight.
const fn is_long(numbers: usize) -> bool {
    eights(numbers, true) > 1
}

/// How many of so many rows of a matrix are calculated together: all if they leave registers for several columns.
#[must_use]
pub const fn rows(numbers: usize, wide: bool) -> usize {
    let most = if wide { 48 } else { 24 };
    if numbers <= most {
        return numbers;
    }
    let blocks = numbers.div_ceil(most / 2);
    numbers.div_ceil(blocks).next_multiple_of(4)
}

/// How many registers hold sums at a time. The others are for what is added.
const fn sums(wide: bool) -> usize {
    if wide { 24 } else { 12 }
}

/// Neighbouring rows or columns, from one up to another.
type Range = (usize, usize);

/// Neighbouring columns, the rows of the trunk where their factors are not zero, and the place of the first one's factors.
pub type Run = (Range, Range, usize);

/// A matrix with which another is multiplied; column and row of what has to be made zero in it; and its columns, from one up to
/// another, outside whose given rows there are zeros. All other columns are zero.
pub type Factor<'a, T, const N: usize, const M: usize> =
    (&'a mut SMatrix<T, N, M>, &'a [(usize, usize)], &'a [(Range, &'a [usize])]);

/// Puts minus the products of a matrix with others in the place of these.
#[inline]
pub fn minus_products<
    A: Arithmetic,
    T: Real,
    P: Parts<T, N>,
    const N: usize,
    const M: usize,
    const COUNT: usize,
>(
    matrix: &SMatrix<T, N, N>,
    factors: [Factor<'_, T, N, M>; COUNT],
) {
    A::within(Products::<T, P, N, M, COUNT> { matrix, factors, parts: PhantomData });
}

struct Products<'a, T, P, const N: usize, const M: usize, const COUNT: usize> {
    matrix: &'a SMatrix<T, N, N>,
    factors: [Factor<'a, T, N, M>; COUNT],
    parts: PhantomData<P>,
}

impl<T: Real, P: Parts<T, N>, const N: usize, const M: usize, const COUNT: usize> Work
    for Products<'_, T, P, N, M, COUNT>
{
    const LONG: bool = is_long(N);

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        for (b, zeros, groups) in self.factors {
            clear(b, zeros);
            for ((first, end), rows) in groups {
                let some = b.data.0.get_mut(*first..*end).unwrap_or(&mut []);
                P::multiply::<A>(self.matrix, some, rows);
            }
        }
    }
}

/// How the columns of a matrix are read.
pub trait Parts<T: Real, const N: usize> {
    /// Puts minus the products of a matrix with columns in the place of these, outside whose given rows there are zeros.
    fn multiply<A: Arithmetic>(matrix: &SMatrix<T, N, N>, columns: &mut [[T; N]], rows: &[usize]);

    /// Adds to each of some columns its multiples of vectors, or subtracts them; of the vectors and their factors only some
    /// neighbouring ones are taken.
    fn add_multiples<A: Arithmetic, const V: usize, const W: usize, const MINUS: bool>(
        sums: &mut [[T; N]],
        vectors: &[[T; N]; W],
        factors: &[[T; V]],
        range: Range,
    );

    /// Adds the products of columns `vectors` with rows `factors`, some neighbouring ones of both. `N` is a multiple of four.
    fn add_products<A: Arithmetic, const W: usize>(
        sums: &mut [[T; N]; N],
        vectors: &[[T; N]; W],
        factors: &[[T; N]; W],
        range: Range,
    );

    /// Does what [`complete`] says.
    fn complete<A: Arithmetic, const K: usize, const V: usize>(
        matrix: &mut SMatrix<T, N, N>,
        trunk: [usize; K],
        factors: &[[T; V]],
        runs: &[Run],
    );

    /// Puts the inverse of a symmetric positive definite matrix of `K` rows, which begins the columns, in its place.
    fn invert<A: Arithmetic, const K: usize>(columns: &mut [[T; N]; N]);
}

/// `R` rows at a time, in `E` registers of eight numbers and `F` of four.
#[derive(Clone, Copy, Debug)]
pub struct Rows<const R: usize, const E: usize, const F: usize>;

impl<T: Real, const R: usize, const E: usize, const F: usize, const N: usize> Parts<T, N> for Rows<R, E, F> {
    #[inline(always)]
    fn multiply<A: Arithmetic>(matrix: &SMatrix<T, N, N>, columns: &mut [[T; N]], rows: &[usize]) {
        let some = multiply::<A, T, R, E, F, N, 4>(matrix, columns, rows);
        let some = multiply::<A, T, R, E, F, N, 3>(matrix, some, rows);
        let some = multiply::<A, T, R, E, F, N, 2>(matrix, some, rows);
        multiply::<A, T, R, E, F, N, 1>(matrix, some, rows);
    }

    #[inline(always)]
    fn add_multiples<A: Arithmetic, const V: usize, const W: usize, const MINUS: bool>(
        sums: &mut [[T; N]],
        vectors: &[[T; N]; W],
        factors: &[[T; V]],
        range: Range,
    ) {
        add_all::<A, T, _, E, F, N, V, MINUS>(sums, vectors, factors, range);
    }

    #[inline(always)]
    fn add_products<A: Arithmetic, const W: usize>(
        sums: &mut [[T; N]; N],
        vectors: &[[T; N]; W],
        factors: &[[T; N]; W],
        range: Range,
    ) {
        add_products::<A, T, E, F, N, W, 4>(sums, vectors, factors, range);
    }

    #[inline(always)]
    fn complete<A: Arithmetic, const K: usize, const V: usize>(
        matrix: &mut SMatrix<T, N, N>,
        trunk: [usize; K],
        factors: &[[T; V]],
        runs: &[Run],
    ) {
        let mut known = Columns::<A, T, E, F, K>::zero();
        for (t, k) in trunk.into_iter().enumerate() {
            if let Some(column) = matrix.data.0.get(k) {
                known.set(t, column);
            }
        }
        for ((first, end), range, place) in runs {
            let columns = matrix.data.0.get_mut(*first..*end).unwrap_or(&mut []);
            let factors = factors.get(*place..).unwrap_or(&[]);
            add_all::<A, T, _, E, F, N, V, false>(columns, &known, factors, *range);
        }
    }

    #[inline(always)]
    fn invert<A: Arithmetic, const K: usize>(columns: &mut [[T; N]; N]) {
        inverse::eliminate::<A, T, E, F, N, K>(columns);
    }
}

/// The first where registers hold eight numbers, else the second.
impl<T: Real, Wide: Parts<T, N>, Narrow: Parts<T, N>, const N: usize> Parts<T, N> for (Wide, Narrow) {
    #[inline(always)]
    fn multiply<A: Arithmetic>(matrix: &SMatrix<T, N, N>, columns: &mut [[T; N]], rows: &[usize]) {
        if A::WIDE {
            Wide::multiply::<A>(matrix, columns, rows);
        } else {
            Narrow::multiply::<A>(matrix, columns, rows);
        }
    }

    #[inline(always)]
    fn add_multiples<A: Arithmetic, const V: usize, const W: usize, const MINUS: bool>(
        sums: &mut [[T; N]],
        vectors: &[[T; N]; W],
        factors: &[[T; V]],
        range: Range,
    ) {
        if A::WIDE {
            Wide::add_multiples::<A, V, W, MINUS>(sums, vectors, factors, range);
        } else {
            Narrow::add_multiples::<A, V, W, MINUS>(sums, vectors, factors, range);
        }
    }

    #[inline(always)]
    fn add_products<A: Arithmetic, const W: usize>(
        sums: &mut [[T; N]; N],
        vectors: &[[T; N]; W],
        factors: &[[T; N]; W],
        range: Range,
    ) {
        if A::WIDE {
            Wide::add_products::<A, W>(sums, vectors, factors, range);
        } else {
            Narrow::add_products::<A, W>(sums, vectors, factors, range);
        }
    }

    #[inline(always)]
    fn complete<A: Arithmetic, const K: usize, const V: usize>(
        matrix: &mut SMatrix<T, N, N>,
        trunk: [usize; K],
        factors: &[[T; V]],
        runs: &[Run],
    ) {
        if A::WIDE {
            Wide::complete::<A, K, V>(matrix, trunk, factors, runs);
        } else {
            Narrow::complete::<A, K, V>(matrix, trunk, factors, runs);
        }
    }

    #[inline(always)]
    fn invert<A: Arithmetic, const K: usize>(columns: &mut [[T; N]; N]) {
        if A::WIDE {
            Wide::invert::<A, K>(columns);
        } else {
            Narrow::invert::<A, K>(columns);
        }
    }
}

/// Makes entries zero.
#[inline(always)]
fn clear<T: Real, const N: usize, const M: usize>(matrix: &mut SMatrix<T, N, M>, zeros: &[(usize, usize)]) {
    for (column, row) in zeros {
        if let Some(entry) = matrix.data.0.get_mut(*column).and_then(|column| column.get_mut(*row)) {
            *entry = T::zero();
        }
    }
}

/// Puts minus the products of a matrix with columns in the place of these, `C` at a time if there are registers enough; returns
/// those that are left. A single sum has to wait for every addition.
#[inline(always)]
fn multiply<
    'a,
    A: Arithmetic,
    T: Real,
    const R: usize,
    const E: usize,
    const F: usize,
    const N: usize,
    const C: usize,
>(
    matrix: &SMatrix<T, N, N>,
    columns: &'a mut [[T; N]],
    rows: &[usize],
) -> &'a mut [[T; N]] {
    if C > 1 && C * (E + F) > sums(A::WIDE) {
        return columns;
    }
    let (some, rest) = columns.as_chunks_mut::<C>();
    for some in some {
        if R >= N {
            let sums = minus_sums::<A, T, R, E, F, N, C>(matrix, some, rows, 0);
            write::<A, T, E, F, N, C, R>(&sums, some, 0);
            continue;
        }
        let given = *some;
        for block in 0..N.div_ceil(R) {
            let first = (block * R).min(N - R);
            let sums = minus_sums::<A, T, R, E, F, N, C>(matrix, &given, rows, first);
            write::<A, T, E, F, N, C, R>(&sums, some, first);
        }
    }
    rest
}

/// Minus the rows from one on of the products with columns.
#[inline(always)]
fn minus_sums<
    A: Arithmetic,
    T: Real,
    const R: usize,
    const E: usize,
    const F: usize,
    const N: usize,
    const C: usize,
>(
    matrix: &SMatrix<T, N, N>,
    columns: &[[T; N]; C],
    rows: &[usize],
    first: usize,
) -> [Column<A, T, E, F>; C] {
    let mut sums = [Column::<A, T, E, F>::zero(); C];
    for &k in rows {
        let Some(from) = matrix.data.0.get(k) else { continue };
        let Some(from) = from.get(first..).and_then(<[T]>::first_chunk::<R>) else { continue };
        let from = Column::read(from);
        for (sums, column) in sums.iter_mut().zip(columns) {
            let Some(factor) = column.get(k) else { continue };
            sums.add_multiple::<true>(*factor, &from);
        }
    }
    sums
}

/// Reads columns.
#[inline(always)]
fn read_each<A: Arithmetic, T: Real, const E: usize, const F: usize, const N: usize, const C: usize>(
    columns: &[[T; N]; C],
) -> [Column<A, T, E, F>; C] {
    let mut all = [Column::zero(); C];
    for (place, column) in all.iter_mut().zip(columns) {
        *place = Column::read(column);
    }
    all
}

/// Writes sums to the rows of columns from one on.
#[inline(always)]
fn write<
    A: Arithmetic,
    T: Real,
    const E: usize,
    const F: usize,
    const N: usize,
    const C: usize,
    const R: usize,
>(
    sums: &[Column<A, T, E, F>; C],
    columns: &mut [[T; N]; C],
    first: usize,
) {
    for (sums, column) in sums.iter().zip(columns) {
        if let Some(rows) = column.get_mut(first..).and_then(<[T]>::first_chunk_mut::<R>) {
            sums.write(rows);
        }
    }
}

/// Adds multiples to columns, or subtracts them, `C` at a time if there are registers enough.
#[inline(always)]
fn add_all<
    A: Arithmetic,
    T: Real,
    S: Source<A, T, E, F>,
    const E: usize,
    const F: usize,
    const N: usize,
    const V: usize,
    const MINUS: bool,
>(
    sums: &mut [[T; N]],
    source: &S,
    factors: &[[T; V]],
    range: Range,
) {
    let (sums, factors) = add::<A, T, S, E, F, N, V, MINUS, 4>(sums, source, factors, range);
    let (sums, factors) = add::<A, T, S, E, F, N, V, MINUS, 3>(sums, source, factors, range);
    let (sums, factors) = add::<A, T, S, E, F, N, V, MINUS, 2>(sums, source, factors, range);
    add::<A, T, S, E, F, N, V, MINUS, 1>(sums, source, factors, range);
}

/// The same for as many columns as are left to be taken so many at a time; returns the others with their factors.
#[inline(always)]
fn add<
    'a,
    'b,
    A: Arithmetic,
    T: Real,
    S: Source<A, T, E, F>,
    const E: usize,
    const F: usize,
    const N: usize,
    const V: usize,
    const MINUS: bool,
    const C: usize,
>(
    columns: &'a mut [[T; N]],
    source: &S,
    factors: &'b [[T; V]],
    (first, end): Range,
) -> (&'a mut [[T; N]], &'b [[T; V]]) {
    if C > 1 && C * (E + F) > sums(A::WIDE) {
        return (columns, factors);
    }
    let (columns, columns_left) = columns.as_chunks_mut::<C>();
    let mut factors_left = factors;
    for columns in columns {
        let Some((factors, left)) = factors_left.split_first_chunk::<C>() else { break };
        factors_left = left;
        let mut sums = read_each::<A, T, E, F, N, C>(columns);
        for k in first..end.min(V).min(S::COUNT) {
            let from = source.column(k);
            for (sums, factors) in sums.iter_mut().zip(factors) {
                let Some(factor) = factors.get(k) else { continue };
                sums.add_multiple::<MINUS>(*factor, &from);
            }
        }
        write::<A, T, E, F, N, C, N>(&sums, columns, 0);
    }
    (columns_left, factors_left)
}

/// Adds products of columns and rows, to so many columns at a time.
#[inline(always)]
fn add_products<
    A: Arithmetic,
    T: Real,
    const E: usize,
    const F: usize,
    const N: usize,
    const W: usize,
    const C: usize,
>(
    sums: &mut [[T; N]; N],
    vectors: &[[T; N]; W],
    factors: &[[T; N]; W],
    (first, end): Range,
) {
    for (place, columns) in sums.as_chunks_mut::<C>().0.iter_mut().enumerate() {
        let mut sums = read_each::<A, T, E, F, N, C>(columns);
        for k in first..end.min(W) {
            let Some(factors) = factors[k].as_chunks::<C>().0.get(place) else { continue };
            let from = Column::read(&vectors[k]);
            for (sums, factor) in sums.iter_mut().zip(factors) {
                sums.add_multiple::<false>(*factor, &from);
            }
        }
        write::<A, T, E, F, N, C, N>(&sums, columns, 0);
    }
}

#[cfg(test)]
mod testing {
    use nalgebra::SMatrix;

    pub fn numbers<const N: usize, const M: usize>(seed: f64) -> SMatrix<f64, N, M> {
        SMatrix::from_fn(|i, j| (seed + (i * 7 + 5 * j) as f64).sin())
    }

    /// So many rows at a time, for registers of eight numbers or for those of four.
    macro_rules! rows_of {
        ($rows:expr, $wide:literal) => {
            Rows<{ $rows }, { eights($rows, $wide) }, { fours($rows, $wide) }>
        };
    }

    /// Calls a function for the compilation's target, with both ways to read a matrix, and for what the processor has.
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
}

#[cfg(test)]
mod tests {
    use super::testing::{everywhere, numbers, rows_of};
    use super::*;
    use crate::arithmetic::Compiled;

    /// Compares two products with minus one that is given.
    fn product<A: Arithmetic, P: Parts<f64, N>, const N: usize, const M: usize>(
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
        everywhere!(product by N, (&a, &b, &[((0, 3), &rows), ((3, 10), &rows)], &(a * b)));
    }

    #[test]
    fn rows_are_taken_in_parts() {
        const N: usize = 29;
        let (a, b) = (numbers::<N, N>(0.0), numbers::<N, 7>(1.0));
        let rows: [usize; N] = core::array::from_fn(|k| k);
        everywhere!(product by 12, (&a, &b, &[((0, 7), &rows)], &(a * b)));
        for n in 1..300 {
            for rows in [true, false].map(|wide| super::rows(n, wide)) {
                assert!(rows <= n && (rows == n || rows.is_multiple_of(4)), "{n}");
            }
        }
    }

    #[test]
    fn small_matrices_do_not_fill_a_register() {
        let (a, b) = (numbers::<3, 3>(0.0), numbers::<3, 7>(1.0));
        everywhere!(product by 3, (&a, &b, &[((0, 7), &[0, 1, 2])], &(a * b)));
    }

    #[test]
    fn rows_that_are_not_named_are_skipped() {
        let (a, mut b) = (numbers::<7, 7>(2.0), numbers::<7, 3>(3.0));
        let mut given = b;
        given.column_mut(1).fill(0.0);
        b.view_mut((2, 0), (2, 1)).fill(0.0);
        b.column_mut(1).fill(0.0);
        b.view_mut((0, 2), (6, 1)).fill(0.0);
        everywhere!(product by 7, (&a, &given, &[((0, 1), &[0, 1, 4, 5, 6]), ((2, 3), &[6])], &(a * b)));
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
}
