//! Physical matrices (second-order tensors, such as inertia matrices) by their entries in the axes of a link.

use crate::expr::{Expr, Mat3, Vec3};
use crate::mechanism::LinkId;

/// A matrix with the link in whose axes its entries are.
#[derive(Clone, Copy, Debug)]
pub struct ResolvedMatrix<'g> {
    /// Link in whose axes the entries are; `None` for the ground.
    pub link: Option<LinkId>,
    /// Entries of the matrix in the axes of its frame.
    pub entries: Mat3<'g>,
}

impl<'g> ResolvedMatrix<'g> {
    /// Returns the matrix with a function applied to all entries.
    pub fn map(self, mut f: impl FnMut(Expr<'g>) -> Expr<'g>) -> ResolvedMatrix<'g> {
        ResolvedMatrix { entries: Mat3::from_fn(|i, j| f(self.entries.0[i][j])), ..self }
    }

    /// Returns `R M Rᵀ`, the matrix in the axes of `link`; `rotate` transforms the components of vectors.
    pub fn rotated_to_link_axes(
        self,
        link: Option<LinkId>,
        rotate: impl Fn(Vec3<'g>) -> Vec3<'g>,
    ) -> ResolvedMatrix<'g> {
        let columns = [0, 1, 2].map(|k| rotate(self.entries.column(k)));
        let half = Mat3::from_fn(|i, j| columns[j][i]);
        let rows = [0, 1, 2].map(|k| rotate(half.row(k)));
        ResolvedMatrix { link, entries: Mat3::from_fn(|i, j| rows[i][j]) }
    }
}
