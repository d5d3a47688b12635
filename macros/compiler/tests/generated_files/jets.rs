//! Polynomials of second degree in time: a value with its first two derivatives. Vectors and matrices of them.

use std::ops::{Add, Mul, Sub};

/// `c₀ + c₁ t + c₂ t²`.
#[derive(Clone, Copy, Debug)]
pub struct Jet([f64; 3]);

pub type Vector = [Jet; 3];
/// By rows.
pub type Matrix = [Vector; 3];

impl Jet {
    pub fn constant(value: f64) -> Jet {
        Jet([value, 0.0, 0.0])
    }

    /// With these derivatives.
    pub fn new(value: f64, first: f64, second: f64) -> Jet {
        Jet([value, first, second / 2.0])
    }

    pub fn value(self) -> f64 {
        self.0[0]
    }

    pub fn first(self) -> f64 {
        self.0[1]
    }

    pub fn second(self) -> f64 {
        2.0 * self.0[2]
    }

    /// Sine and cosine.
    pub fn sin_cos(self) -> (Jet, Jet) {
        let ((s, c), [_, d, e]) = (self.0[0].sin_cos(), self.0);
        (Jet([s, c * d, c * e - s * d * d / 2.0]), Jet([c, -s * d, -s * e - c * d * d / 2.0]))
    }
}

impl Add for Jet {
    type Output = Jet;
    fn add(self, b: Jet) -> Jet {
        Jet(std::array::from_fn(|k| self.0[k] + b.0[k]))
    }
}

impl Sub for Jet {
    type Output = Jet;
    fn sub(self, b: Jet) -> Jet {
        Jet(std::array::from_fn(|k| self.0[k] - b.0[k]))
    }
}

impl Mul for Jet {
    type Output = Jet;
    fn mul(self, Jet(b): Jet) -> Jet {
        let Jet(a) = self;
        Jet([a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[1] * b[1] + a[2] * b[0]])
    }
}

pub fn constant(matrix: [[f64; 3]; 3]) -> Matrix {
    matrix.map(|row| row.map(Jet::constant))
}

pub fn plus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|k| a[k] + b[k])
}

pub fn times(m: &Matrix, v: &Vector) -> Vector {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| times(a, &b.map(|row| row[j]))[i]))
}

/// A turn about a unit axis by an angle (Rodrigues).
pub fn turn(n: [f64; 3], angle: Jet) -> Matrix {
    let (sin, cos) = angle.sin_cos();
    let one = Jet::constant(1.0);
    let across = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let same = if i == j { cos } else { Jet::constant(0.0) };
            same + Jet::constant(n[i] * n[j]) * (one - cos) + Jet::constant(across[i][j]) * sin
        })
    })
}

/// The rotation of a unit quaternion x y z w that turns with `w` and its rate, both in its own axes.
pub fn spin([x, y, z, s]: [f64; 4], w: [f64; 3], rate: [f64; 3]) -> Matrix {
    let rotation = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * s), 2.0 * (x * z + y * s)],
        [2.0 * (x * y + z * s), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * s)],
        [2.0 * (x * z - y * s), 2.0 * (y * z + x * s), 1.0 - 2.0 * (x * x + y * y)],
    ];
    // exp(ŵ t + ŵ' t²/2) to second degree.
    let hat = |a: [f64; 3]| [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]];
    let (first, second) = (hat(w), hat(rate));
    let motion: Matrix = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let square: f64 = (0..3).map(|k| first[i][k] * first[k][j]).sum();
            Jet::new(f64::from(u8::from(i == j)), first[i][j], square + second[i][j])
        })
    });
    product(&constant(rotation), &motion)
}

/// Angular velocity and acceleration in the axes of the ground: `Ṙ Rᵀ` and its rate.
pub fn turning(r: &Matrix) -> ([f64; 3], [f64; 3]) {
    let entry = |i: usize, j: usize| {
        let first: f64 = (0..3).map(|k| r[i][k].first() * r[j][k].value()).sum();
        let second: f64 =
            (0..3).map(|k| r[i][k].second() * r[j][k].value() + r[i][k].first() * r[j][k].first()).sum();
        (first, second)
    };
    let all = [entry(2, 1), entry(0, 2), entry(1, 0)];
    (all.map(|e| e.0), all.map(|e| e.1))
}

/// `R I Rᵀ w`.
pub fn inertia(r: &Matrix, inertia: &[[f64; 3]; 3], w: [f64; 3]) -> [f64; 3] {
    let own: [f64; 3] = std::array::from_fn(|j| (0..3).map(|i| r[i][j].value() * w[i]).sum());
    let turned: [f64; 3] = std::array::from_fn(|i| dot(inertia[i], own));
    std::array::from_fn(|i| (0..3).map(|j| r[i][j].value() * turned[j]).sum())
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + b[k])
}

pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
