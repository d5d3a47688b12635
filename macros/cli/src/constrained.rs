//! Constrained motion: accelerations by Gauss's principle of least constraint, and projection of states onto
//! the constraints after every step. Both use the metric of the mass matrix, as simulations in Rust do.

/// Mass matrix with its Cholesky factor: `M = L Lᵀ`, stored row by row below the diagonal.
pub struct Metric {
    n: usize,
    factor: Vec<f64>,
}

/// Constraint directions whose norm is below this fraction of the largest are redundant.
const REDUNDANT: f64 = 1e-9;

impl Metric {
    /// Factorises a matrix in column-major order; `None` if it is not positive definite.
    pub fn of(matrix: &[f64], n: usize) -> Option<Metric> {
        let mut factor = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
                let left = matrix[j * n + i] - known;
                factor[i * n + j] = match i == j {
                    true if left > 0.0 => left.sqrt(),
                    true => return None,
                    false => left / factor[j * n + j],
                };
            }
        }
        Some(Metric { n, factor })
    }

    /// Computes `L⁻¹ x`.
    fn lower(&self, mut x: Vec<f64>) -> Vec<f64> {
        for i in 0..self.n {
            let known: f64 = (0..i).map(|k| self.factor[i * self.n + k] * x[k]).sum();
            x[i] = (x[i] - known) / self.factor[i * self.n + i];
        }
        x
    }

    /// Computes `L⁻ᵀ x`.
    fn upper(&self, mut x: Vec<f64>) -> Vec<f64> {
        for i in (0..self.n).rev() {
            let known: f64 = (i + 1..self.n).map(|k| self.factor[k * self.n + i] * x[k]).sum();
            x[i] = (x[i] - known) / self.factor[i * self.n + i];
        }
        x
    }

    /// Returns the vector `a` nearest to `M⁻¹ force` with `jacobian a = target`, for a Jacobian in
    /// column-major order, and the largest residual of these equations, which is large only if constraints
    /// contradict each other.
    pub fn nearest(&self, force: Vec<f64>, jacobian: &[f64], target: &[f64]) -> (Vec<f64>, f64) {
        let (n, m) = (self.n, target.len());
        let mut z = self.lower(force);
        let rows: Vec<Vec<f64>> =
            (0..m).map(|i| self.lower((0..n).map(|k| jacobian[k * m + i]).collect())).collect();
        let (mut left, mut open) = (rows.clone(), (0..m).collect::<Vec<_>>());
        let largest = rows.iter().map(|row| dot(row, row)).fold(0.0, f64::max);
        // The direction with the largest component orthogonal to the previous ones comes first.
        while let Some(at) = (0..open.len()).max_by(|a, b| {
            let size = |k: usize| dot(&left[open[k]], &left[open[k]]);
            size(*a).total_cmp(&size(*b))
        }) {
            let i = open.swap_remove(at);
            let size = dot(&left[i], &left[i]).sqrt();
            if size * size <= REDUNDANT * REDUNDANT * largest || size == 0.0 {
                break;
            }
            let direction: Vec<f64> = left[i].iter().map(|x| x / size).collect();
            let gap = (target[i] - dot(&rows[i], &z)) / dot(&direction, &rows[i]);
            z.iter_mut().zip(&direction).for_each(|(z, d)| *z += gap * d);
            for k in &open {
                // Two orthogonalisations suffice (Parlett, The Symmetric Eigenvalue Problem, § 6.9).
                for _ in 0..2 {
                    let along = dot(&left[*k], &direction);
                    left[*k].iter_mut().zip(&direction).for_each(|(x, d)| *x -= along * d);
                }
            }
        }
        let off = (0..m).map(|i| (target[i] - dot(&rows[i], &z)).abs()).fold(0.0, f64::max);
        (self.upper(z), off)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::Metric;

    /// Checks that two connected masses share a force in the ratio of their masses, and that repeating the
    /// constraint changes nothing.
    #[test]
    fn redundant_constraints_change_nothing() {
        let metric = Metric::of(&[2.0, 0.0, 0.0, 3.0], 2).expect("it is positive definite");
        for (jacobian, target) in [(vec![1.0, -1.0], vec![0.0]), (vec![1.0, 2.0, -1.0, -2.0], vec![0.0, 0.0])]
        {
            let (a, off) = metric.nearest(vec![10.0, 0.0], &jacobian, &target);
            assert!((a[0] - 2.0).abs() < 1e-14 && (a[1] - 2.0).abs() < 1e-14 && off < 1e-14, "{a:?} {off}");
        }
    }

    /// Checks that the contradiction of `x = 0` and `x = 1` is reported.
    #[test]
    fn contradictions_are_told() {
        let metric = Metric::of(&[2.0], 1).expect("it is positive definite");
        assert!(metric.nearest(vec![0.0], &[1.0, 1.0], &[0.0, 1.0]).1 > 0.5);
        assert!(Metric::of(&[0.0], 1).is_none());
    }
}
