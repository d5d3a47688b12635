//! Three-dimensional vectors and matrices of expressions.

use super::diff::TINY;
use super::node::Function;
use super::{Expr, Graph};
use std::ops::{Add, AddAssign, Index, Mul, Neg, Sub, SubAssign};

/// Vector of three expressions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<'g>(pub [Expr<'g>; 3]);

impl<'g> Vec3<'g> {
    /// Returns the zero vector.
    pub fn zero(g: &'g Graph) -> Vec3<'g> {
        Vec3([g.zero(); 3])
    }

    /// Returns the unit vector along coordinate axis `k`.
    pub fn coordinate_axis(g: &'g Graph, k: usize) -> Vec3<'g> {
        Vec3(std::array::from_fn(|i| if i == k { g.one() } else { g.zero() }))
    }

    /// Returns a vector of constant expressions.
    pub fn vector_from_constants(g: &'g Graph, v: [f64; 3]) -> Vec3<'g> {
        Vec3(v.map(|c| g.num(c)))
    }

    /// Applies a function to every component of the vector.
    pub fn map(self, f: impl FnMut(Expr<'g>) -> Expr<'g>) -> Vec3<'g> {
        Vec3(self.0.map(f))
    }

    /// Returns true if every component is the constant zero.
    pub fn is_zero(self) -> bool {
        self.0.iter().all(|c| c.is_zero())
    }

    /// Returns the components of the vector as numbers if all of them are constant.
    pub fn constant_components(self) -> Option<[f64; 3]> {
        Some([self.0[0].constant_value()?, self.0[1].constant_value()?, self.0[2].constant_value()?])
    }

    /// Returns the dot product of two vectors.
    pub fn dot(self, b: Vec3<'g>) -> Expr<'g> {
        self.0[0] * b.0[0] + self.0[1] * b.0[1] + self.0[2] * b.0[2]
    }

    /// Returns the cross product of two vectors.
    pub fn cross(self, b: Vec3<'g>) -> Vec3<'g> {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, b.0);
        Vec3([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
    }

    /// Returns the Euclidean norm of the vector.
    pub fn norm(self) -> Expr<'g> {
        self.dot(self).sqrt()
    }

    /// Returns the Euclidean norm of a vector that may pass through zero. A [`TINY`] constant under the root,
    /// below the resolution of any other length, makes its derivatives at zero vanish, where they would
    /// otherwise be NaN.
    pub fn regularised_norm(self) -> Expr<'g> {
        let mut parts = self.0.into_iter().filter(|c| !c.is_zero());
        match (parts.next(), parts.next(), self.constant_components()) {
            (Some(only), None, _) => only.apply_function(Function::Abs),
            (None, ..) | (.., Some(_)) => self.norm(),
            _ => (self.dot(self) + self[0].num(TINY)).sqrt(),
        }
    }
}

impl<'g> Index<usize> for Vec3<'g> {
    type Output = Expr<'g>;
    fn index(&self, k: usize) -> &Expr<'g> {
        &self.0[k]
    }
}

impl<'g> Add for Vec3<'g> {
    type Output = Vec3<'g>;
    fn add(self, b: Vec3<'g>) -> Vec3<'g> {
        Vec3([self[0] + b[0], self[1] + b[1], self[2] + b[2]])
    }
}

impl<'g> Sub for Vec3<'g> {
    type Output = Vec3<'g>;
    fn sub(self, b: Vec3<'g>) -> Vec3<'g> {
        Vec3([self[0] - b[0], self[1] - b[1], self[2] - b[2]])
    }
}

impl<'g> Neg for Vec3<'g> {
    type Output = Vec3<'g>;
    fn neg(self) -> Vec3<'g> {
        self.map(|c| -c)
    }
}

impl<'g> Mul<Expr<'g>> for Vec3<'g> {
    type Output = Vec3<'g>;
    fn mul(self, s: Expr<'g>) -> Vec3<'g> {
        self.map(|c| s * c)
    }
}

impl<'g> AddAssign for Vec3<'g> {
    fn add_assign(&mut self, b: Vec3<'g>) {
        *self = *self + b;
    }
}

impl<'g> SubAssign for Vec3<'g> {
    fn sub_assign(&mut self, b: Vec3<'g>) {
        *self = *self - b;
    }
}

/// Matrix of 3×3 expressions, stored by rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mat3<'g>(pub [[Expr<'g>; 3]; 3]);

impl<'g> Mat3<'g> {
    /// Returns the zero matrix.
    pub fn zero(g: &'g Graph) -> Mat3<'g> {
        Mat3([[g.zero(); 3]; 3])
    }

    /// Returns the identity matrix.
    pub fn identity(g: &'g Graph) -> Mat3<'g> {
        Mat3(std::array::from_fn(|i| Vec3::coordinate_axis(g, i).0))
    }

    /// Returns the matrix with the entries `f(i, j)`.
    pub fn from_fn(mut f: impl FnMut(usize, usize) -> Expr<'g>) -> Mat3<'g> {
        Mat3(std::array::from_fn(|i| std::array::from_fn(|j| f(i, j))))
    }

    /// Returns the cross-product matrix `[a]×`, with `[a]× b = a × b`.
    pub fn skew(a: Vec3<'g>) -> Mat3<'g> {
        let ([x, y, z], o) = (a.0, a[0].zero());
        Mat3([[o, -z, y], [z, o, -x], [-y, x, o]])
    }

    /// Returns row `i` of the matrix.
    pub fn row(&self, i: usize) -> Vec3<'g> {
        Vec3(self.0[i])
    }

    /// Returns column `j` of the matrix.
    pub fn column(&self, j: usize) -> Vec3<'g> {
        Vec3([self.0[0][j], self.0[1][j], self.0[2][j]])
    }

    /// Returns the transpose of the matrix.
    pub fn transpose(self) -> Mat3<'g> {
        Mat3::from_fn(|i, j| self.0[j][i])
    }

    /// Returns the entries of the matrix as numbers if all of them are constant.
    pub fn entries_if_all_constant(self) -> Option<[[f64; 3]; 3]> {
        let mut out = [[0.0; 3]; 3];
        for i in 0..3 {
            out[i] = self.row(i).constant_components()?;
        }
        Some(out)
    }
}

impl<'g> Add for Mat3<'g> {
    type Output = Mat3<'g>;
    fn add(self, b: Mat3<'g>) -> Mat3<'g> {
        Mat3::from_fn(|i, j| self.0[i][j] + b.0[i][j])
    }
}

impl<'g> Sub for Mat3<'g> {
    type Output = Mat3<'g>;
    fn sub(self, b: Mat3<'g>) -> Mat3<'g> {
        Mat3::from_fn(|i, j| self.0[i][j] - b.0[i][j])
    }
}

impl<'g> Mul for Mat3<'g> {
    type Output = Mat3<'g>;
    fn mul(self, b: Mat3<'g>) -> Mat3<'g> {
        Mat3::from_fn(|i, j| self.row(i).dot(b.column(j)))
    }
}

impl<'g> Mul<Vec3<'g>> for Mat3<'g> {
    type Output = Vec3<'g>;
    fn mul(self, v: Vec3<'g>) -> Vec3<'g> {
        Vec3([self.row(0).dot(v), self.row(1).dot(v), self.row(2).dot(v)])
    }
}

/// Symmetric 3×3 matrix of expressions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sym3<'g> {
    /// Diagonal entries xx, yy and zz of the symmetric matrix.
    pub diagonal: [Expr<'g>; 3],
    /// Off-diagonal entries xy, xz and yz of the symmetric matrix.
    pub off: [Expr<'g>; 3],
}

impl<'g> Sym3<'g> {
    /// Returns the zero matrix.
    pub fn zero(g: &'g Graph) -> Sym3<'g> {
        Sym3 { diagonal: [g.zero(); 3], off: [g.zero(); 3] }
    }

    /// Returns a multiple of the identity matrix.
    pub fn multiple_of_identity(s: Expr<'g>) -> Sym3<'g> {
        Sym3 { diagonal: [s; 3], off: [s.zero(); 3] }
    }

    /// Returns the symmetric matrix with the upper triangle of `m`.
    pub fn from_upper(m: &Mat3<'g>) -> Sym3<'g> {
        let m = &m.0;
        Sym3 { diagonal: [m[0][0], m[1][1], m[2][2]], off: [m[0][1], m[0][2], m[1][2]] }
    }

    /// Applies a function to every entry of the symmetric matrix.
    pub fn map(self, mut f: impl FnMut(Expr<'g>) -> Expr<'g>) -> Sym3<'g> {
        Sym3 { diagonal: self.diagonal.map(&mut f), off: self.off.map(f) }
    }

    /// Returns entry `(i, j)` of the symmetric matrix.
    pub fn entry(&self, i: usize, j: usize) -> Expr<'g> {
        if i == j { self.diagonal[i] } else { self.off[i + j - 1] }
    }

    /// Returns the symmetric matrix as a full matrix.
    pub fn full_matrix(&self) -> Mat3<'g> {
        Mat3::from_fn(|i, j| self.entry(i, j))
    }

    /// Returns the inertia `s (|a|² 1 − a aᵀ)` of a point mass `s` at `a`.
    pub fn point_mass_inertia(s: Expr<'g>, a: Vec3<'g>) -> Sym3<'g> {
        let [x, y, z] = a.0;
        let (sx, sy, sz) = (s * x, s * y, s * z);
        let (xx, yy, zz) = (sx * x, sy * y, sz * z);
        Sym3 { diagonal: [yy + zz, xx + zz, xx + yy], off: [-(sx * y), -(sx * z), -(sy * z)] }
    }
}

impl<'g> Add for Sym3<'g> {
    type Output = Sym3<'g>;
    fn add(self, b: Sym3<'g>) -> Sym3<'g> {
        Sym3 {
            diagonal: std::array::from_fn(|k| self.diagonal[k] + b.diagonal[k]),
            off: std::array::from_fn(|k| self.off[k] + b.off[k]),
        }
    }
}

impl<'g> Sub for Sym3<'g> {
    type Output = Sym3<'g>;
    fn sub(self, b: Sym3<'g>) -> Sym3<'g> {
        Sym3 {
            diagonal: std::array::from_fn(|k| self.diagonal[k] - b.diagonal[k]),
            off: std::array::from_fn(|k| self.off[k] - b.off[k]),
        }
    }
}

impl<'g> Mul<Vec3<'g>> for Sym3<'g> {
    type Output = Vec3<'g>;
    fn mul(self, v: Vec3<'g>) -> Vec3<'g> {
        self.full_matrix() * v
    }
}
