//! Entries of the derivatives: inner products of motions with wrenches and momenta.

use super::lanes::{Eight, Rows, WIDTH, read};
use super::sums::{FIRST_ANGULAR, LINK_ROWS, MOMENTUM, RATE_ANGULAR, RATE_LINEAR, SECOND, WRENCHES, Work};
use super::{Block, LinkQuantityLanes};
use crate::Real;
use crate::arithmetic::Arithmetic;
use nalgebra::SMatrix;

/// Factors of a column of both derivatives.
struct Factors<T> {
    /// Wrenches that displacement and velocity cause, for rows above the diagonal.
    wrenches: [[T; 6]; 2],
    /// Changes of the acceleration with displacement and velocity, each followed by the angular component of
    /// the change of the twist, for rows below the diagonal.
    changes: [[T; 9]; 2],
}

impl<T: Real> Factors<T> {
    /// Reads the factors of the column of a lane.
    #[inline(always)]
    fn read(rows: &Rows<T, LINK_ROWS>, link: &LinkQuantityLanes<T>, lane: usize) -> Self {
        let row_entry_in_lane = |k: usize| rows[k].0.get(lane).copied().unwrap_or(T::zero());
        let link_entry_in_lane = |k: usize| link[k].0.get(lane).copied().unwrap_or(T::zero());
        let mut factors = Factors { wrenches: [[T::zero(); 6]; 2], changes: [[T::zero(); 9]; 2] };
        for k in 0..6 {
            factors.wrenches[0][k] = row_entry_in_lane(WRENCHES + k);
            factors.wrenches[1][k] = row_entry_in_lane(WRENCHES + 6 + k);
            factors.changes[0][k] = row_entry_in_lane(SECOND + k);
        }
        for k in 0..3 {
            factors.changes[0][6 + k] = row_entry_in_lane(FIRST_ANGULAR + k);
            factors.changes[1][k] = row_entry_in_lane(RATE_LINEAR + k);
            factors.changes[1][3 + k] = row_entry_in_lane(RATE_ANGULAR + k);
            factors.changes[1][6 + k] = link_entry_in_lane(3 + k);
        }
        factors
    }

    /// Returns the entries of the column in the rows of ancestors, for both derivatives.
    #[inline(always)]
    fn entries_of_ancestors<A: Arithmetic>(&self, ancestors: &LinkQuantityLanes<T>) -> [Eight<A, T>; 2] {
        weighted_row_sums(ancestors, 0, &self.wrenches)
    }

    /// Returns the entries of the column in the rows of descendants, for both derivatives.
    #[inline(always)]
    fn entries_of_descendants<A: Arithmetic>(&self, descendants: &Rows<T, LINK_ROWS>) -> [Eight<A, T>; 2] {
        weighted_row_sums(descendants, MOMENTUM, &self.changes)
    }
}

/// Returns sums of products of rows from `first` on with two lists of factors.
#[inline(always)]
fn weighted_row_sums<A: Arithmetic, T: Real, const K: usize, const M: usize>(
    rows: &Rows<T, K>,
    first: usize,
    [a, b]: &[[T; M]; 2],
) -> [Eight<A, T>; 2] {
    let row = read::<A, T, K>(rows, first);
    let (mut by_q, mut by_v) = (row * A::splat(a[0]), row * A::splat(b[0]));
    for k in 1..M {
        let row = read::<A, T, K>(rows, first + k);
        by_q = A::mul_add(row, A::splat(a[k]), by_q);
        by_v = A::mul_add(row, A::splat(b[k]), by_v);
    }
    [by_q, by_v]
}

/// Writes the columns of the links of block `b`. Rows are written in ascending order, eight at a time: zeros
/// of unused lanes are overwritten by the next block, if the column has entries there.
#[inline(always)]
pub fn write_columns_of_block<A: Arithmetic, T: Real, const N: usize, const B: usize>(
    (b, block): (usize, &Block<'_>),
    blocks: &[Block<'_>; B],
    links: &[LinkQuantityLanes<T>; B],
    work: &Work<T, B>,
    by_q: &mut SMatrix<T, N, N>,
    by_v: &mut SMatrix<T, N, N>,
    free: bool,
) {
    let (Some(link), Some(rows)) = (links.get(b), work.links.get(b)) else { return };
    let columns = by_q.data.0.iter_mut().zip(&mut by_v.data.0).skip(block.first).take(block.count.min(WIDTH));
    for (lane, (by_q, by_v)) in columns.enumerate() {
        let factors = Factors::read(rows, link, lane);
        for k in block.ancestors {
            let (Some(at), Some(link)) = (blocks.get(*k), links.get(*k)) else { continue };
            let [q, v] = factors.entries_of_ancestors::<A>(link);
            write_eight_rows(by_q, at.first, &q);
            write_eight_rows(by_v, at.first, &v);
        }
        let [mut q, mut v] = factors.entries_of_ancestors::<A>(link);
        if !free {
            let below = factors.entries_of_descendants::<A>(rows);
            q = rows_above_then_below(&q, &below[0], lane);
            v = rows_above_then_below(&v, &below[1], lane);
        }
        write_eight_rows(by_q, block.first, &q);
        write_eight_rows(by_v, block.first, &v);
        for k in block.descendants {
            let (Some(at), Some(rows)) = (blocks.get(*k), work.links.get(*k)) else { continue };
            let [q, v] = factors.entries_of_descendants::<A>(rows);
            write_eight_rows(by_q, at.first, &q);
            write_eight_rows(by_v, at.first, &v);
        }
    }
}

/// Returns the lanes of `above` up to `lane`, and those of `below` after it.
#[inline(always)]
fn rows_above_then_below<A: Arithmetic, T: Real>(
    above: &Eight<A, T>,
    below: &Eight<A, T>,
    lane: usize,
) -> Eight<A, T> {
    let mut numbers = *above.lane_numbers();
    for (k, (number, below)) in numbers.iter_mut().zip(below.lane_numbers()).enumerate() {
        *number = if k > lane { *below } else { *number };
    }
    A::lanes(numbers)
}

/// Writes eight rows of a column from row `first` on, or fewer at the end of the column.
#[inline(always)]
fn write_eight_rows<A: Arithmetic, T: Real, const N: usize>(
    column: &mut [T; N],
    first: usize,
    x: &Eight<A, T>,
) {
    let rest = column.get_mut(first..).unwrap_or(&mut []);
    if let Some(all) = rest.first_chunk_mut() {
        *all = *x.lane_numbers();
    } else {
        for (place, x) in rest.iter_mut().zip(x.lane_numbers()) {
            *place = *x;
        }
    }
}
