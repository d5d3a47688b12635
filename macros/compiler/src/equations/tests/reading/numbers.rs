//! Numerical linearisation by finite differences of Lagrange's equations, and roots of characteristic
//! polynomials.

use super::*;

/// Returns the roots of a polynomial by the Durand-Kerner (Weierstrass) iteration.
pub fn polynomial_roots(c: &[f64]) -> Vec<Complex<f64>> {
    let n = c.len() - 1;
    let monic: Vec<f64> = c.iter().map(|x| x / c[n]).collect();
    let size = 1.0 + monic[..n].iter().map(|x| x.abs()).fold(0.0, f64::max).powf(0.5);
    let initial_root_guess = |k: usize| Complex::from_polar(size, 0.4 + 2.0 * PI * k as f64 / n as f64);
    let mut found: Vec<Complex<f64>> = (0..n).map(initial_root_guess).collect();
    for _ in 0..500 {
        for k in 0..n {
            let x = found[k];
            let value = monic.iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * x + c);
            let others: Complex<f64> = (0..n).filter(|j| *j != k).map(|j| x - found[j]).product();
            found[k] -= value / others;
        }
    }
    found
}

/// Returns the eigenvalues of a matrix from its characteristic polynomial, by the Faddeev-LeVerrier
/// algorithm.
pub fn eigenvalues(a: &[Vec<f64>]) -> Vec<Complex<f64>> {
    let n = a.len();
    let mut c = vec![0.0; n + 1];
    c[n] = 1.0;
    let mut m = vec![vec![0.0; n]; n];
    for k in 1..=n {
        m = (0..n)
            .map(|i| {
                let entry_of_product = |j: usize| (0..n).map(|l| a[i][l] * m[l][j]).sum::<f64>();
                (0..n).map(|j| entry_of_product(j) + if i == j { c[n - k + 1] } else { 0.0 }).collect()
            })
            .collect();
        let trace: f64 = (0..n).map(|i| (0..n).map(|l| a[i][l] * m[l][i]).sum::<f64>()).sum();
        c[n - k] = -trace / k as f64;
    }
    polynomial_roots(&c)
}

/// Checks that two lists contain the same roots within a tolerance.
#[track_caller]
pub fn assert_same_roots(a: &[Complex<f64>], b: &[Complex<f64>], tolerance: f64) {
    assert_eq!(a.len(), b.len(), "{a:?} {b:?}");
    let mut left = b.to_vec();
    for root in a {
        let distance_to_root = |z: &Complex<f64>| (z - root).norm();
        let nearest = (0..left.len())
            .min_by(|x, y| distance_to_root(&left[*x]).total_cmp(&distance_to_root(&left[*y])));
        let nearest = left.remove(nearest.expect("as many"));
        assert!(distance_to_root(&nearest) < tolerance * (1.0 + root.norm()), "{a:?}\n{b:?}");
    }
}

/// A numerical model of a mechanism: accelerations of Lagrange's equations.
pub struct NumericalMechanism<'g> {
    nv: usize,
    forces: crate::expr::eval::Tape<'g>,
    quaternion: bool,
}

impl<'g> NumericalMechanism<'g> {
    pub fn new(model: &Model<'g>) -> NumericalMechanism<'g> {
        let joints = crate::kinematics::joints_of_model(model);
        let lagrange = lagrange::derive(model, &joints);
        let inputs = forces::generalized_forces_of_inputs(model, &joints);
        let mut all = lagrange.mass_matrix.concat();
        all.extend(inputs.iter().zip(&lagrange.bias).map(|(tau, bias)| *tau - *bias));
        let quaternion = model.nq() > model.nv();
        NumericalMechanism { nv: model.nv(), forces: crate::expr::eval::Tape::new(&all), quaternion }
    }

    pub fn accelerations(&self, q: &[f64], v: &[f64], u: &[f64], parameters: &[f64]) -> Vec<f64> {
        let values = self.forces.evaluate_at(&|s| match Quantity::from_symbol(s) {
            Quantity::Parameter(k) => parameters[k],
            Quantity::Configuration(k) => q[k],
            Quantity::Velocity(k) => v[k],
            Quantity::Input(k) => u[k],
            _ => 0.0,
        });
        let (mass, force) = values.split_at(self.nv * self.nv);
        let mut rows: Vec<Vec<f64>> =
            (0..self.nv).map(|i| [&mass[i * self.nv..][..self.nv], &force[i..=i]].concat()).collect();
        // The mass matrix is symmetric and positive definite: pivots along the diagonal.
        for k in 0..self.nv {
            let own: Vec<f64> = rows[k].iter().map(|x| x / rows[k][k]).collect();
            for (i, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
                let (_, factor) = (i, row[k]);
                row.iter_mut().zip(&own).for_each(|(x, own)| *x -= factor * own);
            }
            rows[k] = own;
        }
        rows.iter().map(|row| row[self.nv]).collect()
    }

    /// Returns the matrix of `ξ̇ = v`, `v̇ = a` about a state at rest, by finite differences. The orientation
    /// at rest is the identity.
    pub fn linear_system_matrix(&self, q: &[f64], u: &[f64], parameters: &[f64]) -> Vec<Vec<f64>> {
        let n = self.nv;
        let displaced_accelerations = |k: usize, h: f64| {
            let (mut q, mut v) = (q.to_vec(), vec![0.0; n]);
            match (k < n, self.quaternion && k >= 3) {
                (true, true) => (q[k], q[6]) = ((h / 2.0).sin(), (h / 2.0).cos()),
                (true, false) => q[k] += h,
                (false, _) => v[k - n] = h,
            }
            self.accelerations(&q, &v, u, parameters)
        };
        let h = 1e-3;
        let acceleration_derivatives = |k: usize| -> Vec<f64> {
            let ((a, b), (c, d)) = (
                (displaced_accelerations(k, h), displaced_accelerations(k, -h)),
                (displaced_accelerations(k, 2.0 * h), displaced_accelerations(k, -2.0 * h)),
            );
            (0..n).map(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h)).collect()
        };
        let columns: Vec<Vec<f64>> = (0..2 * n).map(acceleration_derivatives).collect();
        let upper = (0..n).map(|i| (0..2 * n).map(|k| f64::from(u8::from(k == n + i))).collect());
        upper.chain((0..n).map(|i| columns.iter().map(|column| column[i]).collect())).collect()
    }
}
