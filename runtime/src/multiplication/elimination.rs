//! Gauss–Jordan elimination of several pivots at a time.

use super::column::Column;
use super::kernels::{load_columns_into_registers, write};
use crate::Real;
use crate::arithmetic::Arithmetic;

/// Number of pivots that are eliminated together. Columns are then read and written once for four pivots: a
/// matrix of 16 rows is inverted in less than two thirds of the time.
const PANEL: usize = 4;

/// Repeats a block for each index below `$end` as a constant; a loop would not always be unrolled.
macro_rules! for_each_index {
    ($index:ident in 0..$end:ident $block:block) => {
        for_each_index!($index in 0..$end $block, 0 1 2 3)
    };
    ($index:ident in 0..$end:ident $block:block, $($value:literal)*) => {$(
        if $value < $end {
            const $index: usize = $value;
            $block
        }
    )*};
}

/// Inverts in place the symmetric positive definite matrix in the leading columns, by Gauss–Jordan
/// elimination without interchanges (Golub and Van Loan 2013, ch. 3.2). Rows are divided by their pivots at
/// the end, so that all rows are treated equally during the elimination.
#[inline(always)]
pub fn eliminate_leading_columns<
    A: Arithmetic,
    T: Real,
    const E: usize,
    const F: usize,
    const N: usize,
    const K: usize,
>(
    columns: &mut [[T; N]; N],
) {
    let columns = columns.split_at_mut(K.min(N)).0;
    let mut divisors = [T::zero(); N];
    let panels = columns.len() / PANEL;
    for k in 0..panels {
        eliminate_pivots::<A, T, E, F, N, PANEL>(columns, k * PANEL, &mut divisors);
    }
    for k in panels * PANEL..columns.len() {
        eliminate_pivots::<A, T, E, F, N, 1>(columns, k, &mut divisors);
    }
    let divisors = Column::<A, T, E, F>::read(&divisors);
    for column in columns {
        let mut sum = Column::read(column);
        sum.multiply(&divisors);
        sum.write(column);
    }
}

/// Eliminates `P` pivots from index `first` on, at most [`PANEL`], and stores their reciprocals in
/// `divisors`.
#[inline(always)]
fn eliminate_pivots<
    A: Arithmetic,
    T: Real,
    const E: usize,
    const F: usize,
    const N: usize,
    const P: usize,
>(
    columns: &mut [[T; N]],
    first: usize,
    divisors: &mut [T; N],
) {
    let Some((before, rest)) = columns.split_at_mut_checked(first) else { return };
    let Some((panel, after)) = rest.split_first_chunk_mut::<P>() else { return };
    let Some(divisors) = divisors.get_mut(first..).and_then(<[T]>::first_chunk_mut::<P>) else { return };
    let Some(pivots) = PivotColumnMultiples::<A, T, E, F, P>::eliminate_panel(panel, first, divisors) else {
        return;
    };
    for column in before.iter_mut().chain(after) {
        pivots.eliminate_column(column, first);
    }
}

/// Multiples of the columns of `P` pivots that the elimination adds to the other columns.
struct PivotColumnMultiples<A, T, const E: usize, const F: usize, const P: usize> {
    columns: [Column<A, T, E, F>; P],
    /// Entries of the columns in the rows of the pivots.
    block: [[T; P]; P],
}

impl<A: Arithmetic, T: Real, const E: usize, const F: usize, const P: usize>
    PivotColumnMultiples<A, T, E, F, P>
{
    /// Eliminates the pivots in their own columns, and stores the reciprocals of the pivots. The rows of the
    /// pivots are eliminated as scalars, too: the division by a pivot then does not wait for whole columns.
    #[inline(always)]
    fn eliminate_panel<const N: usize>(
        panel: &mut [[T; N]; P],
        first: usize,
        divisors: &mut [T; P],
    ) -> Option<Self> {
        let block = &mut [[T::zero(); P]; P];
        for_each_index!(J in 0..P {
            block[J] = *panel[J].get(first..).and_then(<[T]>::first_chunk::<P>)?;
        });
        // A one among zeros: reading from an earlier index yields a unit vector of a later row.
        let mut one = [[T::zero(); N]; 2];
        *one[1].first_mut()? = T::one();
        let mut columns = load_columns_into_registers::<A, T, E, F, N, P>(panel);
        let mut taken = PivotColumnMultiples { columns: [Column::zero(); P], block: [[T::zero(); P]; P] };
        for_each_index!(K in 0..P {
            let unit = Column::<A, T, E, F>::read(one.as_flattened().get(N.saturating_sub(first + K)..)?);
            let by = T::one() / block[K][K];
            divisors[K] = by;
            taken.columns[K] = columns[K];
            taken.columns[K].multiply(&unit.one_minus_entries());
            taken.columns[K].multiply(&Column::all(-by));
            for_each_index!(I in 0..P {
                taken.block[K][I] = if I == K { T::zero() } else { block[K][I] * -by };
            });
            for_each_index!(J in 0..P {
                if J != K {
                    let factor = block[J][K];
                    columns[J].add_multiple::<false>(factor, &taken.columns[K]);
                    for_each_index!(I in 0..P {
                        if I != K {
                            block[J][I] = A::mul_add(factor, taken.block[K][I], block[J][I]);
                        }
                    });
                }
            });
            columns[K] = taken.columns[K];
            columns[K].add_multiple::<false>(T::one(), &unit);
            block[K] = taken.block[K];
            block[K][K] = T::one();
        });
        write::<A, T, E, F, N, P, N>(&columns, panel, 0);
        Some(taken)
    }

    /// Eliminates the pivots in another column.
    #[inline(always)]
    fn eliminate_column<const N: usize>(&self, column: &mut [T; N], first: usize) {
        let Some(rows) = column.get(first..).and_then(<[T]>::first_chunk::<P>) else { return };
        let mut factors = *rows;
        let mut sum = Column::read(column);
        for_each_index!(K in 0..P {
            let factor = factors[K];
            for_each_index!(I in 0..P {
                if (K + 1..P).contains(&I) {
                    factors[I] = A::mul_add(factor, self.block[K][I], factors[I]);
                }
            });
            sum.add_multiple::<false>(factor, &self.columns[K]);
        });
        sum.write(column);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{everywhere, pseudorandom_matrix, rows_of};
    use super::super::{Tile, Tiling, registers_of_eight, registers_of_four};
    use super::*;
    use crate::arithmetic::Compiled;
    use nalgebra::SMatrix;

    const N: usize = 12;

    fn check_inverted_leading_block<A: Arithmetic, P: Tiling<f64, N>, const N: usize, const K: usize>(
        matrix: &SMatrix<f64, N, N>,
        block: &SMatrix<f64, K, K>,
    ) {
        let mut found = *matrix;
        P::invert_leading_block::<A, K>(&mut found.data.0);
        let found: SMatrix<f64, K, K> = found.fixed_view::<K, K>(0, 0).into_owned();
        assert!((found * block - SMatrix::<f64, K, K>::identity()).amax() < 1e-13);
    }

    #[test]
    fn leading_blocks_of_all_sizes_are_inverted() {
        let factor = pseudorandom_matrix::<N, N>(3.0);
        let matrix = factor * factor.transpose() + SMatrix::<f64, N, N>::identity() * 4.0;
        macro_rules! check_sizes {
            ($($size:literal)*) => {$({
                let block: SMatrix<f64, $size, $size> = matrix.fixed_view::<$size, $size>(0, 0).into_owned();
                everywhere!(check_inverted_leading_block by N, (&matrix, &block));
            })*};
        }
        check_sizes!(1 2 3 4 5 6 7 8 9 10 11 12);
    }
}
