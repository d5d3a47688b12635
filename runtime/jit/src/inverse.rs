//! Assembly of inverse mass matrices from the parts that programs compute.

use crate::kernels::{self, Kernel, add_multiple};
use linkwork_compiler::catalogue::InverseForm;
use std::cmp::Ordering;

/// Assembly of an inverse mass matrix from the outputs of a program: columns, then a row of further values
/// for each velocity.
pub(crate) struct Inverse {
    n: usize,
    trunk: Vec<usize>,
    /// Limb of each velocity, `None` for velocities of the trunk; no list for an update of low rank.
    limbs: Option<Vec<Option<usize>>>,
}

impl Inverse {
    pub fn new(form: &InverseForm, n: usize) -> Inverse {
        match form {
            InverseForm::Explicit => Inverse { n, trunk: Vec::new(), limbs: None },
            InverseForm::LowRankUpdate(trunk) => Inverse { n, trunk: trunk.clone(), limbs: None },
            InverseForm::BlockArrow { trunk, limbs } => {
                let limb_of_velocity = |k: usize| limbs.iter().position(|limb| limb.contains(&k));
                Inverse { n, trunk: trunk.clone(), limbs: Some((0..n).map(limb_of_velocity).collect()) }
            }
        }
    }

    /// Returns the number of the program's outputs after the columns.
    pub fn output_count_after_columns(&self) -> usize {
        self.n * self.trunk.len()
    }

    /// Returns the number of workspace values that operations with the inverse mass matrix need.
    pub fn work_space_size(&self) -> usize {
        let width = self.trunk.len();
        self.n * width + width * width + 2 * self.n
    }

    /// Completes the inverse mass matrix from the columns that the program has computed and its further
    /// outputs.
    pub fn complete(&self, matrix: &mut [f64], trunk_factors: &[f64], work: &mut [f64]) {
        if !self.trunk.is_empty() || self.limbs.is_some() {
            kernels::run_kernel(self.n, InverseCompletion { inverse: self, matrix, trunk_factors, work });
        }
    }

    /// Adds to every column of the inverse its combination of the columns of the trunk.
    #[inline(always)]
    fn add_trunk_columns(
        &self,
        matrix: &mut [f64],
        factors: &[f64],
        mul_add: impl Fn(f64, f64, f64) -> f64 + Copy,
    ) {
        let (n, width) = (self.n, self.trunk.len());
        for j in 0..n {
            for (trunk, by) in self.trunk.iter().zip(&factors[j * width..]).filter(|(_, by)| **by != 0.0) {
                let (before, after) = matrix.split_at_mut(j * n);
                let (column, after) = after.split_at_mut(n);
                let other = match trunk.cmp(&j) {
                    Ordering::Less => &before[trunk * n..(trunk + 1) * n],
                    Ordering::Greater => &after[(trunk - j - 1) * n..(trunk - j) * n],
                    // The columns of the trunk are complete.
                    Ordering::Equal => continue,
                };
                add_multiple(*by, other, column, mul_add);
            }
        }
    }

    /// Inverts a mass matrix of a trunk and limbs. On entry, the matrix contains the inverse of the block of
    /// each limb, and `borders` the rows of the trunk.
    #[inline(always)]
    fn invert_with_limbs(
        &self,
        limbs: &[Option<usize>],
        matrix: &mut [f64],
        borders: &[f64],
        work: &mut [f64],
        mul_add: impl Fn(f64, f64, f64) -> f64 + Copy,
    ) {
        let (n, width) = (self.n, self.trunk.len());
        let (g, rest) = work.split_at_mut(n * width);
        let inner = &mut rest[..width * width];
        for (c, trunk) in self.trunk.iter().enumerate() {
            inner[c * width..(c + 1) * width].copy_from_slice(&borders[trunk * width..(trunk + 1) * width]);
        }
        g.fill(0.0);
        for (k, limb) in limbs.iter().enumerate().filter(|(_, limb)| limb.is_some()) {
            let own = &mut g[k * width..(k + 1) * width];
            for (j, _) in limbs.iter().enumerate().filter(|(_, other)| *other == limb) {
                let by = -matrix[k * n + j];
                add_multiple(by, &borders[j * width..(j + 1) * width], own, mul_add);
            }
            for (column, by) in inner.chunks_exact_mut(width).zip(&*own) {
                add_multiple(*by, &borders[k * width..(k + 1) * width], column, mul_add);
            }
        }
        invert_positive_definite(width, inner, mul_add);
        for (c, trunk) in self.trunk.iter().enumerate() {
            for i in 0..n {
                let products = g[i * width..].iter().zip(&inner[c * width..(c + 1) * width]);
                matrix[trunk * n + i] = products.map(|(a, b)| a * b).sum();
            }
            for (t, row) in self.trunk.iter().enumerate() {
                matrix[trunk * n + row] = inner[c * width + t];
            }
        }
        let g = &work[..n * width];
        self.add_trunk_columns(matrix, g, mul_add);
    }

    /// Converts a column of generalized forces to accelerations in place, if the program computes forces, as
    /// it does for mechanisms with limbs in SIMD lanes.
    pub fn solve(&self, inverse: &[f64], trunk_factors: &[f64], column: &mut [f64], work: &mut [f64]) {
        if let Some(limbs) = &self.limbs {
            kernels::run_kernel(
                self.n,
                AccelerationComputation {
                    inverse: self,
                    limbs,
                    matrix: inverse,
                    trunk_factors,
                    column,
                    work,
                },
            );
        }
    }
}

/// Completion of an inverse mass matrix from the columns that a program computes.
struct InverseCompletion<'a> {
    inverse: &'a Inverse,
    matrix: &'a mut [f64],
    trunk_factors: &'a [f64],
    work: &'a mut [f64],
}

impl Kernel for InverseCompletion<'_> {
    #[inline(always)]
    fn run(self, mul_add: impl Fn(f64, f64, f64) -> f64 + Copy) {
        let InverseCompletion { inverse, matrix, trunk_factors, work } = self;
        match &inverse.limbs {
            None => inverse.add_trunk_columns(matrix, trunk_factors, mul_add),
            Some(limbs) => inverse.invert_with_limbs(limbs, matrix, trunk_factors, work, mul_add),
        }
    }
}

/// Computation of accelerations from generalized forces by the inverse mass matrix.
struct AccelerationComputation<'a> {
    inverse: &'a Inverse,
    limbs: &'a [Option<usize>],
    matrix: &'a [f64],
    trunk_factors: &'a [f64],
    column: &'a mut [f64],
    work: &'a mut [f64],
}

impl Kernel for AccelerationComputation<'_> {
    #[inline(always)]
    fn run(self, mul_add: impl Fn(f64, f64, f64) -> f64 + Copy) {
        let AccelerationComputation { inverse, limbs, matrix, trunk_factors, column, work } = self;
        let (n, width) = (inverse.n, inverse.trunk.len());
        let (x, rest) = work[..2 * n].split_at_mut(n);
        rest.copy_from_slice(column);
        column.fill(0.0);
        // One correction where there are no limbs: the inverse of an ill-conditioned matrix is exact enough
        // for it.
        let passes = if limbs.iter().any(Option::is_some) { 1 } else { 2 };
        for _ in 0..passes {
            x.fill(0.0);
            for (by, own) in rest.iter().zip(matrix.chunks_exact(n)) {
                add_multiple(*by, own, x, mul_add);
            }
            column.iter_mut().zip(&*x).for_each(|(a, x)| *a += x);
            for k in 0..n {
                for (t, trunk) in inverse.trunk.iter().enumerate() {
                    rest[*trunk] -= x[k] * trunk_factors[k * width + t];
                }
            }
        }
    }
}

/// Inverts a symmetric positive definite matrix in place by Gauss–Jordan elimination without interchanges
/// (Golub and Van Loan 2013, section 3.2).
#[inline(always)]
fn invert_positive_definite(n: usize, m: &mut [f64], mul_add: impl Fn(f64, f64, f64) -> f64 + Copy) {
    for k in 0..n {
        let by = 1.0 / m[k * n + k];
        m[k * n + k] = 1.0;
        m[k * n..(k + 1) * n].iter_mut().for_each(|entry| *entry *= by);
        for i in (0..n).filter(|i| *i != k) {
            let factor = -m[i * n + k];
            m[i * n + k] = 0.0;
            let (before, after) = m.split_at_mut(i.max(k) * n);
            let (first, last) = (&mut before[i.min(k) * n..][..n], &mut after[..n]);
            let (pivot, own) = if k < i { (&*first, last) } else { (&*last, first) };
            add_multiple(factor, pivot, own, mul_add);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the inversion of a block-arrow matrix with a trunk of one velocity and two limbs of one
    /// velocity each. Initially, the columns of the limbs hold the inverses of their blocks, and the borders
    /// hold the row of the trunk.
    #[test]
    fn block_arrow_matrix_is_inverted() {
        let form = InverseForm::BlockArrow { trunk: vec![0], limbs: vec![vec![1], vec![2]] };
        let inverse = Inverse::new(&form, 3);
        let mass = [4.0, 1.0, 2.0, 1.0, 2.0, 0.0, 2.0, 0.0, 5.0];
        let mut matrix = [0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.2];
        let borders = [4.0, 1.0, 2.0];
        let mut work = vec![0.0; inverse.work_space_size()];
        inverse.complete(&mut matrix, &borders, &mut work);
        for j in 0..3 {
            for i in 0..3 {
                let entry: f64 = (0..3).map(|k| mass[k * 3 + i] * matrix[j * 3 + k]).sum();
                assert!((entry - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        let mut column = [7.0, 3.0, 7.0];
        inverse.solve(&matrix, &borders, &mut column, &mut work);
        assert!(column.iter().all(|a| (a - 1.0).abs() < 1e-14), "{column:?}");
    }
}
