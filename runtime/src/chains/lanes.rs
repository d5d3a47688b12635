//! Vectors, matrices and inertias of eight links in the lanes of SIMD registers.

use crate::Real;
use crate::arithmetic::{Arithmetic, Vector};

/// Number of links in the lanes of a register.
pub const WIDTH: usize = 8;

/// One quantity of eight links, aligned to a cache line.
#[repr(align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<T>(
    /// Values of the links.
    pub [T; WIDTH],
);

/// Several quantities of eight links.
pub type Rows<T, const K: usize> = [Row<T>; K];

/// One quantity of eight links in a register.
pub type Eight<A, T> = Vector<A, T, WIDTH>;
/// Vectors in space, one of each link.
pub type Vectors<A, T> = [Eight<A, T>; 3];
/// Matrices by rows, one of each link.
pub type Matrices<A, T> = [Vectors<A, T>; 3];

/// Spatial vectors, one of each link: a twist (velocity of the origin, angular velocity), or a wrench (force,
/// moment about the origin).
#[derive(Clone, Copy)]
pub struct Spatials<A, T> {
    /// Velocities of the origin, or forces.
    pub linear: Vectors<A, T>,
    /// Angular velocities, or moments about the origin.
    pub angular: Vectors<A, T>,
}

/// Reads row `k`; zeros if there is no such row.
#[inline(always)]
pub fn read<A: Arithmetic, T: Real, const K: usize>(rows: &Rows<T, K>, k: usize) -> Eight<A, T> {
    A::lanes(rows.get(k).map_or([T::zero(); WIDTH], |row| row.0))
}

/// Reads three rows from `k` on.
#[inline(always)]
pub fn read_vectors<A: Arithmetic, T: Real, const K: usize>(rows: &Rows<T, K>, k: usize) -> Vectors<A, T> {
    [read::<A, T, K>(rows, k), read::<A, T, K>(rows, k + 1), read::<A, T, K>(rows, k + 2)]
}

/// Writes row `k`, if it exists.
#[inline(always)]
pub fn write<A: Arithmetic, T: Real, const K: usize>(rows: &mut Rows<T, K>, k: usize, x: Eight<A, T>) {
    if let Some(row) = rows.get_mut(k) {
        row.0 = *x.lane_numbers();
    }
}

/// Writes three rows from `k` on.
#[inline(always)]
pub fn write_vectors<A: Arithmetic, T: Real, const K: usize>(
    rows: &mut Rows<T, K>,
    k: usize,
    x: &Vectors<A, T>,
) {
    write::<A, T, K>(rows, k, x[0]);
    write::<A, T, K>(rows, k + 1, x[1]);
    write::<A, T, K>(rows, k + 2, x[2]);
}

/// Returns the cross products `a × b`.
#[inline(always)]
pub fn cross<A: Arithmetic, T: Real>(a: &Vectors<A, T>, b: &Vectors<A, T>) -> Vectors<A, T> {
    [
        A::mul_sub(a[1], b[2], a[2] * b[1]),
        A::mul_sub(a[2], b[0], a[0] * b[2]),
        A::mul_sub(a[0], b[1], a[1] * b[0]),
    ]
}

/// Returns `a × b + c`.
#[inline(always)]
pub fn cross_add<A: Arithmetic, T: Real>(
    a: &Vectors<A, T>,
    b: &Vectors<A, T>,
    c: &Vectors<A, T>,
) -> Vectors<A, T> {
    [
        A::mul_add(a[1], b[2], A::neg_mul_add(a[2], b[1], c[0])),
        A::mul_add(a[2], b[0], A::neg_mul_add(a[0], b[2], c[1])),
        A::mul_add(a[0], b[1], A::neg_mul_add(a[1], b[0], c[2])),
    ]
}

/// Returns the vectors multiplied by scalars.
#[inline(always)]
pub fn scale<A: Arithmetic, T: Real>(a: &Vectors<A, T>, s: Eight<A, T>) -> Vectors<A, T> {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// Returns `s a + c`.
#[inline(always)]
pub fn scale_add<A: Arithmetic, T: Real>(
    a: &Vectors<A, T>,
    s: Eight<A, T>,
    c: &Vectors<A, T>,
) -> Vectors<A, T> {
    [A::mul_add(a[0], s, c[0]), A::mul_add(a[1], s, c[1]), A::mul_add(a[2], s, c[2])]
}

/// Returns `a + b`.
#[inline(always)]
pub fn add<A: Arithmetic, T: Real>(a: &Vectors<A, T>, b: &Vectors<A, T>) -> Vectors<A, T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Returns `a − b`.
#[inline(always)]
pub fn subtract<A: Arithmetic, T: Real>(a: &Vectors<A, T>, b: &Vectors<A, T>) -> Vectors<A, T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns the inner products `a · b`.
#[inline(always)]
pub fn dot<A: Arithmetic, T: Real>(a: &Vectors<A, T>, b: &Vectors<A, T>) -> Eight<A, T> {
    A::mul_add(a[2], b[2], A::mul_add(a[1], b[1], a[0] * b[0]))
}

/// Returns the products `m x`.
#[inline(always)]
pub fn transform<A: Arithmetic, T: Real>(m: &Matrices<A, T>, x: &Vectors<A, T>) -> Vectors<A, T> {
    [dot(&m[0], x), dot(&m[1], x), dot(&m[2], x)]
}

/// Returns `m x + c`.
#[inline(always)]
pub fn transform_add<A: Arithmetic, T: Real>(
    m: &Matrices<A, T>,
    x: &Vectors<A, T>,
    c: &Vectors<A, T>,
) -> Vectors<A, T> {
    let mut sums = *c;
    for (sum, row) in sums.iter_mut().zip(m) {
        *sum = A::mul_add(row[2], x[2], A::mul_add(row[1], x[1], A::mul_add(row[0], x[0], *sum)));
    }
    sums
}

/// Returns the transposed matrices.
#[inline(always)]
pub fn transpose<A: Copy, T: Copy>(m: &Matrices<A, T>) -> Matrices<A, T> {
    [[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]]
}

/// Returns the symmetric matrices with the entries xx, yy, zz, yz, zx, xy.
#[inline(always)]
pub fn symmetric<A: Copy, T: Copy>(x: &[Eight<A, T>; 6]) -> Matrices<A, T> {
    [[x[0], x[5], x[4]], [x[5], x[1], x[3]], [x[4], x[3], x[2]]]
}

/// Returns in each lane the sum of this lane and all earlier lanes.
#[inline(always)]
pub fn prefix_sums<A: Arithmetic, T: Real>(x: Eight<A, T>) -> Eight<A, T> {
    let o = T::zero();
    let n = *x.lane_numbers();
    let x = x + A::lanes([o, n[0], n[1], n[2], n[3], n[4], n[5], n[6]]);
    let n = *x.lane_numbers();
    let x = x + A::lanes([o, o, n[0], n[1], n[2], n[3], n[4], n[5]]);
    let n = *x.lane_numbers();
    x + A::lanes([o, o, o, o, n[0], n[1], n[2], n[3]])
}

/// Returns in each lane the sum of this lane and all later lanes.
#[inline(always)]
pub fn suffix_sums<A: Arithmetic, T: Real>(x: Eight<A, T>) -> Eight<A, T> {
    let o = T::zero();
    let n = *x.lane_numbers();
    let x = x + A::lanes([n[1], n[2], n[3], n[4], n[5], n[6], n[7], o]);
    let n = *x.lane_numbers();
    let x = x + A::lanes([n[2], n[3], n[4], n[5], n[6], n[7], o, o]);
    let n = *x.lane_numbers();
    x + A::lanes([n[4], n[5], n[6], n[7], o, o, o, o])
}

/// Mass properties about the root's origin: mass, first moment, inertia tensor.
pub struct Inertias<A, T> {
    /// Masses, kg.
    pub mass: Eight<A, T>,
    /// First moments: mass times centre of mass, kg·m.
    pub moment: Vectors<A, T>,
    /// Inertia tensors, kg·m².
    pub tensor: Matrices<A, T>,
}

impl<A: Arithmetic, T: Real> Inertias<A, T> {
    /// Returns the momenta at the given twists: linear, and angular about the root's origin.
    #[inline(always)]
    pub fn momenta(&self, x: &Spatials<A, T>) -> Spatials<A, T> {
        Spatials {
            linear: cross_add(&x.angular, &self.moment, &scale(&x.linear, self.mass)),
            angular: cross_add(&self.moment, &x.linear, &transform(&self.tensor, &x.angular)),
        }
    }

    /// Returns the sums of the momenta at the given twists and the wrenches `c`.
    #[inline(always)]
    pub fn momenta_add(&self, x: &Spatials<A, T>, c: &Spatials<A, T>) -> Spatials<A, T> {
        Spatials {
            linear: cross_add(&x.angular, &self.moment, &scale_add(&x.linear, self.mass, &c.linear)),
            angular: cross_add(&self.moment, &x.linear, &transform_add(&self.tensor, &x.angular, &c.angular)),
        }
    }
}

impl<A: Arithmetic, T: Real> Spatials<A, T> {
    /// Reads six rows from `k` on: linear, then angular components.
    #[inline(always)]
    pub fn read<const K: usize>(rows: &Rows<T, K>, k: usize) -> Self {
        Spatials { linear: read_vectors::<A, T, K>(rows, k), angular: read_vectors::<A, T, K>(rows, k + 3) }
    }

    /// Writes six rows from `k` on: linear, then angular components.
    #[inline(always)]
    pub fn write<const K: usize>(&self, rows: &mut Rows<T, K>, k: usize) {
        write_vectors::<A, T, K>(rows, k, &self.linear);
        write_vectors::<A, T, K>(rows, k + 3, &self.angular);
    }

    /// Returns the spatial vectors with the same components in every lane.
    #[inline(always)]
    pub fn splat(x: &[T; 6]) -> Self {
        let [a, b, c, d, e, f] = x.map(|x| A::splat(x));
        Spatials { linear: [a, b, c], angular: [d, e, f] }
    }

    /// Returns the spatial vectors multiplied by scalars.
    #[inline(always)]
    pub fn scale(&self, s: Eight<A, T>) -> Self {
        Spatials { linear: scale(&self.linear, s), angular: scale(&self.angular, s) }
    }

    /// Returns `s x + c` for these spatial vectors `x`.
    #[inline(always)]
    pub fn scale_add(&self, s: Eight<A, T>, c: &Self) -> Self {
        Spatials {
            linear: scale_add(&self.linear, s, &c.linear),
            angular: scale_add(&self.angular, s, &c.angular),
        }
    }

    /// Returns the sums of two spatial vectors.
    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        Spatials { linear: add(&self.linear, &other.linear), angular: add(&self.angular, &other.angular) }
    }

    /// Returns the differences of two spatial vectors.
    #[inline(always)]
    pub fn minus(&self, other: &Self) -> Self {
        Spatials {
            linear: subtract(&self.linear, &other.linear),
            angular: subtract(&self.angular, &other.angular),
        }
    }

    /// Returns `V × x`: the change of motions `x` that move with these twists `V`.
    #[inline(always)]
    pub fn cross_motion(&self, x: &Self) -> Self {
        Spatials {
            linear: cross_add(&self.angular, &x.linear, &cross(&self.linear, &x.angular)),
            angular: cross(&self.angular, &x.angular),
        }
    }

    /// Returns `V ×* f + c`: the change of wrenches `f` that move with these twists `V`, plus `c`.
    #[inline(always)]
    pub fn cross_force_add(&self, f: &Self, c: &Self) -> Self {
        let angular = cross_add(&self.linear, &f.linear, &c.angular);
        Spatials {
            linear: cross_add(&self.angular, &f.linear, &c.linear),
            angular: cross_add(&self.angular, &f.angular, &angular),
        }
    }

    /// Returns in each lane the sums of this lane and all earlier lanes.
    #[inline(always)]
    pub fn prefix_sums(&self) -> Self {
        let [a, b, c] = self.linear;
        let [d, e, f] = self.angular;
        Spatials {
            linear: [prefix_sums(a), prefix_sums(b), prefix_sums(c)],
            angular: [prefix_sums(d), prefix_sums(e), prefix_sums(f)],
        }
    }

    /// Returns the components of the last lane.
    #[inline(always)]
    pub fn last(&self) -> [T; 6] {
        let ([a, b, c], [d, e, f]) = (&self.linear, &self.angular);
        [a, b, c, d, e, f].map(|x| x.lane_numbers()[WIDTH - 1])
    }
}
