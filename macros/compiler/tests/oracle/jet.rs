//! Truncated Taylor series in time over complex numbers. A series contains position, velocity and
//! acceleration; an imaginary step gives derivatives with respect to the state without cancellation (Squire
//! and Trapp, *Using complex variables to estimate derivatives of real functions*, SIAM Review 40, 1998).

use num_complex::Complex;
use std::array::from_fn;
use std::ops::{Add, Mul, Neg, Sub};

/// Complex number whose imaginary part contains a derivative.
pub type C = Complex<f64>;

/// Returns a real number as a complex number.
pub fn complex_from_real(x: f64) -> C {
    C::new(x, 0.0)
}

/// Taylor series `x₀ + x₁ t + x₂ t²` in time with complex coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Jet(pub [C; 3]);

impl Jet {
    /// Returns the Taylor series of a constant.
    pub fn constant_series(x: f64) -> Jet {
        Jet([complex_from_real(x), complex_from_real(0.0), complex_from_real(0.0)])
    }

    /// Returns the square root of a positive series.
    pub fn sqrt(self) -> Jet {
        let [a, b, c] = self.0;
        let root = a.sqrt();
        let first = b / (root * 2.0);
        Jet([root, first, (c - first * first) / (root * 2.0)])
    }

    /// Returns sine and cosine of a Taylor series.
    pub fn sin_cos(self) -> (Jet, Jet) {
        let [a, b, c] = self.0;
        let (s, k) = (a.sin(), a.cos());
        let half = b * b * 0.5;
        (Jet([s, k * b, k * c - s * half]), Jet([k, -s * b, -s * c - k * half]))
    }

    /// Returns the angle of the point `(cosine, sine)`, which need not be normalised, between −π and π.
    pub fn atan2(sine: Jet, cosine: Jet) -> Jet {
        let ([s, ds, dds], [c, dc, ddc]) = (sine.0, cosine.0);
        let square = s * s + c * c;
        // The imaginary part is a step whose square is negligible.
        let angle = C::new(s.re.atan2(c.re), (c.re * s.im - s.re * c.im) / square.re);
        let first = (c * ds - s * dc) / square;
        Jet([angle, first, (c * dds - s * ddc - first * (c * dc + s * ds)) / square])
    }

    /// Returns the first time derivative of the Taylor series.
    pub fn first_time_derivative(self) -> C {
        self.0[1]
    }

    /// Returns the second time derivative of the Taylor series.
    pub fn second_time_derivative(self) -> C {
        self.0[2] * 2.0
    }
}

impl Add for Jet {
    type Output = Jet;
    fn add(self, other: Jet) -> Jet {
        Jet(from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl Sub for Jet {
    type Output = Jet;
    fn sub(self, other: Jet) -> Jet {
        Jet(from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl Neg for Jet {
    type Output = Jet;
    fn neg(self) -> Jet {
        Jet(self.0.map(|x| -x))
    }
}

impl Mul for Jet {
    type Output = Jet;
    fn mul(self, other: Jet) -> Jet {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Jet([a * x, a * y + b * x, a * z + b * y + c * x])
    }
}

/// Vector of three Taylor series in time.
pub type Vector = [Jet; 3];
/// Rotation matrix of Taylor series in time, stored by rows.
pub type Matrix = [[Jet; 3]; 3];

/// Returns a constant vector as Taylor series in time.
pub fn constant_vector(v: [f64; 3]) -> Vector {
    v.map(Jet::constant_series)
}

/// Returns the sum `a + b` of two vectors.
pub fn sum_of_vectors(a: Vector, b: Vector) -> Vector {
    from_fn(|i| a[i] + b[i])
}

/// Returns the difference `a − b` of two vectors.
pub fn difference_of_vectors(a: Vector, b: Vector) -> Vector {
    from_fn(|i| a[i] - b[i])
}

/// Returns a constant vector times a Taylor series, `s v`.
pub fn scaled_vector(s: Jet, v: [f64; 3]) -> Vector {
    v.map(|x| s * Jet::constant_series(x))
}

/// Returns the dot product `a · b`.
pub fn dot(a: Vector, b: Vector) -> Jet {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the product `R v` of a rotation matrix and a vector.
pub fn rotated_vector(r: &Matrix, v: Vector) -> Vector {
    r.map(|row| dot(row, v))
}

/// Returns the product `A B` of two matrices.
pub fn matrix_product(a: &Matrix, b: &Matrix) -> Matrix {
    let columns = transposed_matrix(b);
    a.map(|row| columns.map(|column| dot(row, column)))
}

/// Returns the transpose `Aᵀ` of a matrix.
pub fn transposed_matrix(a: &Matrix) -> Matrix {
    from_fn(|i| from_fn(|j| a[j][i]))
}

/// Returns the identity matrix with Taylor series as entries.
pub fn identity_matrix() -> Matrix {
    from_fn(|i| from_fn(|j| Jet::constant_series(if i == j { 1.0 } else { 0.0 })))
}

/// Returns the rotation about a fixed unit vector (Rodrigues' formula).
pub fn rotation_about_axis(axis: [f64; 3], angle: Jet) -> Matrix {
    let (s, c) = angle.sin_cos();
    let rest = Jet::constant_series(1.0) - c;
    let k = constant_vector(axis);
    let cross = [[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]];
    from_fn(|i| {
        from_fn(|j| {
            let diagonal = if i == j { c } else { Jet::constant_series(0.0) };
            diagonal + rest * k[i] * k[j] + s * Jet::constant_series(cross[i][j])
        })
    })
}

/// Returns the cross product `a × b`.
pub fn cross<T: Copy + Mul<Output = T> + Sub<Output = T>>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}
