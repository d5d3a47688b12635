//! Derivatives of inverse dynamics for mechanisms with long chains of links, in loops over blocks of links.
//! Straight-line code of these derivatives would exceed the processor's instruction fetch rate.
//!
//! A block is a chain of at most eight links, each of which is the parent of the next. Its links are the
//! lanes of SIMD registers. All quantities are in the axes of the root and about its origin, so that they are
//! summed along the tree without transformation. The equations are those of
//! `mechanics/derivatives/analytic.rs` of the compiler (Singh, Russell and Wensing, *Efficient analytical
//! derivatives of rigid-body dynamics using spatial vector algebra*, 2022). The loops compute, in this order:
//!
//! 1. outward, the motion of each link, and the inertia, momentum, wrench and velocity map of its body;
//! 2. inward, the sums of the last four over each link with its descendants, and the wrenches that the
//!    displacement and the velocity of its joint cause;
//! 3. for each column of the derivatives, the inner products of these wrenches with the motions of the
//!    ancestors' joints in the rows above the diagonal, and likewise of the momenta below it.

mod entries;
mod lanes;
mod sums;
#[cfg(test)]
mod tests;

use crate::Real;
use crate::arithmetic::Arithmetic;
use crate::lanes::VectorLoop;
use crate::multiplication::clear_entries;
pub use lanes::Row;
use lanes::Rows;
use nalgebra::SMatrix;
use sums::Work;

/// Chain of at most eight links, each of which is the parent of the next.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// Velocity of the first link. The other velocities follow.
    pub first: usize,
    /// Number of velocities.
    pub count: usize,
    /// Block whose last link is the parent of the first link; `None` if the ground is.
    pub parent: Option<usize>,
    /// Indices of the blocks on the path from this block to the root, in ascending order.
    pub ancestors: &'a [usize],
    /// Indices of the blocks whose path to the root contains this block, in ascending order.
    pub descendants: &'a [usize],
}

/// Quantities of the links of a block, in the axes of the root: motion subspace of the joint about the root's
/// origin (linear, then angular component), rotation matrix by rows, position of the link's origin, velocity
/// and acceleration of the joint. Unused lanes are zero.
pub type LinkQuantityLanes<T> = Rows<T, 20>;

/// Mass properties of the bodies of a block, about the link's origin in its axes: mass, first moment, entries
/// xx, yy, zz, yz, zx, xy of the inertia tensor. Unused lanes are zero.
pub type MassPropertyLanes<T> = Rows<T, 10>;

/// Index of the rotation matrix in [`LinkQuantityLanes`].
const ROTATION: usize = 6;
/// Index of the position in [`LinkQuantityLanes`].
const POSITION: usize = 15;
/// Index of the joint velocity in [`LinkQuantityLanes`], followed by the joint acceleration.
const RATES: usize = 18;

/// Writes the derivatives `∂τ/∂q` and `∂τ/∂v` of inverse dynamics, without those of passive forces, and sets
/// the entries `zeros` (column and row) to zero. Rows and columns of links on different branches may be set
/// to zero as well. `ground` is the acceleration opposite to gravity in the axes of the root. Parents have
/// smaller velocities than their children. If `FREE` is true, the first block is a free root link with six
/// velocities, whose mass properties are in lane 5; its motion subspaces are the six unit vectors.
#[inline]
pub fn chain_derivatives<A: Arithmetic, T: Real, const N: usize, const B: usize, const FREE: bool>(
    blocks: &[Block<'_>; B],
    links: &[LinkQuantityLanes<T>; B],
    inertias: &[MassPropertyLanes<T>; B],
    ground: &[T; 3],
    matrices: [&mut SMatrix<T, N, N>; 2],
    zeros: [&[(usize, usize)]; 2],
) {
    A::run_loop(DerivativeLoop::<T, N, B, FREE> { blocks, links, inertias, ground, matrices, zeros });
}

struct DerivativeLoop<'a, T, const N: usize, const B: usize, const FREE: bool> {
    blocks: &'a [Block<'a>; B],
    links: &'a [LinkQuantityLanes<T>; B],
    inertias: &'a [MassPropertyLanes<T>; B],
    ground: &'a [T; 3],
    matrices: [&'a mut SMatrix<T, N, N>; 2],
    zeros: [&'a [(usize, usize)]; 2],
}

impl<T: Real, const N: usize, const B: usize, const FREE: bool> VectorLoop
    for DerivativeLoop<'_, T, N, B, FREE>
{
    const IS_LONG: bool = true;

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        let DerivativeLoop { blocks, links, inertias, ground, matrices: [by_q, by_v], zeros } = self;
        let mut work = Work::<T, B>::new();
        for (b, ((block, link), inertia)) in blocks.iter().zip(links).zip(inertias).enumerate() {
            work.propagate_outward::<A>(b, block, link, inertia, ground, FREE && b == 0);
        }
        for (b, (block, link)) in blocks.iter().zip(links).enumerate().rev() {
            work.sum_inward::<A>(b, block, link, FREE && b == 0);
        }
        for (b, block) in blocks.iter().enumerate() {
            let free = FREE && b == 0;
            entries::write_columns_of_block::<A, T, N, B>((b, block), blocks, links, &work, by_q, by_v, free);
        }
        for (matrix, zeros) in [by_q, by_v].into_iter().zip(zeros) {
            clear_entries(matrix, zeros);
        }
    }
}
