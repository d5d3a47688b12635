//! Numeric vectors, rotations and mass properties, with values at rounding level replaced by zero.

use crate::expr::{Graph, Mat3, Rotation, Sym3, Vec3};
use crate::mechanism::{Inertia, Pose};

/// Vector of three constant numbers.
pub type Vector = [f64; 3];
/// Matrix of 3×3 constant numbers, stored by rows.
pub type Matrix = [[f64; 3]; 3];

/// Relative rounding error of a few operations, below which differences are ignored.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Returns a number, or zero if it is the rounding error of terms of magnitude `scale`.
pub fn round_noise_to_zero(x: f64, scale: f64) -> f64 {
    if x.abs() <= ROUNDING * scale { 0.0 } else { x }
}

/// Returns an entry of a rotation matrix, rounded to 0 or ±1 if it is next to it.
fn round_rotation_entry(x: f64) -> f64 {
    if (x.abs() - 1.0).abs() <= ROUNDING { x.signum() } else { round_noise_to_zero(x, 1.0) }
}

/// Returns the scalar product of two vectors.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the vector product of two vectors.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns the length of a vector.
pub fn norm(a: Vector) -> f64 {
    libm::hypot(libm::hypot(a[0], a[1]), a[2])
}

/// Returns the vector `s a + b`.
pub fn add_scaled_vector(s: f64, a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| s * a[k] + b[k])
}

/// Returns the unit vector along coordinate axis `k`.
pub fn unit_axis(k: usize) -> Vector {
    std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 })
}

/// Returns column `j` of a matrix.
pub fn column(m: &Matrix, j: usize) -> Vector {
    [m[0][j], m[1][j], m[2][j]]
}

/// Returns the product of a matrix and a vector.
pub fn matrix_times_vector(m: &Matrix, v: Vector) -> Vector {
    m.map(|row| dot(row, v))
}

/// Returns the product `mᵀ v` of a transposed matrix with a vector.
pub fn multiply_transposed(m: &Matrix, v: Vector) -> Vector {
    std::array::from_fn(|j| dot(column(m, j), v))
}

/// Returns the product of two matrices.
pub fn matrix_product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| dot(a[i], column(b, j))))
}

/// Returns the transpose of a matrix.
pub fn transpose(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| column(m, i))
}

/// Identity matrix.
pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Returns the matrix of the rotation by an angle about coordinate axis `k`.
pub fn axis_rotation(k: usize, angle: f64) -> Matrix {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let (sin, cos) = libm::sincos(angle);
    let (sin, cos) = (round_rotation_entry(sin), round_rotation_entry(cos));
    let mut m = IDENTITY;
    (m[i][i], m[i][j], m[j][i], m[j][j]) = (cos, -sin, sin, cos);
    m
}

/// Rounds the entries of a rotation matrix that are within rounding errors of 0 or ±1.
pub fn clean_rotation(m: &Matrix) -> Matrix {
    m.map(|row| row.map(round_rotation_entry))
}

/// Frame with numeric pose relative to another frame.
#[derive(Clone, Copy, Debug)]
pub struct NumericFrame {
    /// Rotation matrix whose columns are the axes of the frame.
    pub rotation: Matrix,
    /// Position of the frame's origin, m.
    pub translation: Vector,
}

impl NumericFrame {
    /// Frame that coincides with its reference frame.
    pub const IDENTITY: NumericFrame = NumericFrame { rotation: IDENTITY, translation: [0.0; 3] };

    /// Returns a numeric pose whose rotation is orthogonal up to rounding, or `None`.
    pub fn from_pose(pose: &Pose<'_>) -> Option<NumericFrame> {
        let rotation = clean_rotation(&pose.rotation.rotation_matrix().entries_if_all_constant()?);
        let square = matrix_product(&transpose(&rotation), &rotation);
        let orthogonality_error = |i: usize, j: usize| (square[i][j] - IDENTITY[i][j]).abs();
        if (0..9).any(|k| orthogonality_error(k / 3, k % 3) > 4.0 * ROUNDING) {
            return None;
        }
        Some(NumericFrame {
            rotation,
            translation: zero_rounding_errors_of_vector(pose.translation.constant_components()?),
        })
    }

    /// Converts the numeric frame to a pose of expressions.
    pub fn frame_to_pose<'g>(&self, g: &'g Graph) -> Pose<'g> {
        let matrix = Mat3::from_fn(|i, j| g.num(self.rotation[i][j]));
        Pose {
            rotation: Rotation::from_matrix(matrix),
            translation: Vec3::vector_from_constants(g, self.translation),
        }
    }

    /// Returns the frame transformation `other⁻¹ self next`.
    pub fn placement_in_changed_frames(&self, other: &NumericFrame, next: &NumericFrame) -> NumericFrame {
        let rotation =
            matrix_product(&transpose(&other.rotation), &matrix_product(&self.rotation, &next.rotation));
        let ahead = matrix_times_vector(&self.rotation, next.translation);
        let scale = norm(self.translation) + norm(ahead) + norm(other.translation);
        let from = std::array::from_fn(|k| {
            round_noise_to_zero(self.translation[k] + ahead[k] - other.translation[k], scale)
        });
        let translation = multiply_transposed(&other.rotation, from).map(|c| round_noise_to_zero(c, scale));
        NumericFrame { rotation: clean_rotation(&rotation), translation }
    }
}

/// Replaces components of a vector that are rounding errors by zero.
fn zero_rounding_errors_of_vector(v: Vector) -> Vector {
    let scale = norm(v);
    v.map(|c| round_noise_to_zero(c, scale))
}

/// Mass properties of a link as constant numbers.
#[derive(Clone, Copy, Debug)]
pub struct NumericMassProperties {
    /// Mass of the link, kg.
    pub mass: f64,
    /// First moment of the link about the frame's origin, kg·m.
    pub moment: Vector,
    /// Inertia tensor of the link about the frame's origin, kg·m².
    pub tensor: Matrix,
}

impl NumericMassProperties {
    /// Returns the mass properties as numbers, if all of them are numeric.
    pub fn from_inertia(inertia: &Inertia<'_>) -> Option<NumericMassProperties> {
        Some(NumericMassProperties {
            mass: inertia.mass.constant_value()?,
            moment: inertia.moment.constant_components()?,
            tensor: inertia.tensor.full_matrix().entries_if_all_constant()?,
        })
    }

    /// Returns the root mean square distance of the mass from the origin; zero without mass.
    pub fn root_mean_square_radius(&self) -> f64 {
        let polar = 0.5 * (self.tensor[0][0] + self.tensor[1][1] + self.tensor[2][2]);
        if self.mass > 0.0 { (polar.max(0.0) / self.mass).sqrt() } else { 0.0 }
    }

    /// Converts the numeric mass properties to expressions.
    pub fn inertia_expressions<'g>(&self, g: &'g Graph) -> Inertia<'g> {
        Inertia {
            mass: g.num(self.mass),
            moment: Vec3::vector_from_constants(g, self.moment),
            tensor: Sym3::from_upper(&Mat3::from_fn(|i, j| g.num(self.tensor[i][j]))),
        }
    }

    /// Returns the mass properties about the origin `p` of another frame, in its axes. With the first
    /// moment `h`, the tensor is reduced by `2 (p · h) 1 − p hᵀ − h pᵀ` and increased by `m (|p|² 1 − p pᵀ)`.
    pub fn mass_properties_in_frame(&self, place: &NumericFrame) -> NumericMassProperties {
        let (r, p, h) = (&place.rotation, place.translation, self.moment);
        let diagonal = self.mass * dot(p, p) - 2.0 * dot(p, h);
        let tensor: Matrix = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let unit = if i == j { diagonal } else { 0.0 };
                self.tensor[i][j] + unit + p[i] * h[j] + h[i] * p[j] - self.mass * p[i] * p[j]
            })
        });
        let tensor = matrix_product(&transpose(r), &matrix_product(&tensor, r));
        let moment = multiply_transposed(r, add_scaled_vector(-self.mass, p, h));
        NumericMassProperties { mass: self.mass, moment, tensor }.round_moment_noise_to_zero()
    }

    /// Returns the mass properties together with a point mass at `p`.
    pub fn plus_point_mass(&self, mass: f64, p: Vector) -> NumericMassProperties {
        let square = dot(p, p);
        let entry_of_point_inertia =
            |i: usize, j: usize| if i == j { square - p[i] * p[j] } else { -p[i] * p[j] };
        let tensor = std::array::from_fn(|i| {
            std::array::from_fn(|j| self.tensor[i][j] + mass * entry_of_point_inertia(i, j))
        });
        NumericMassProperties {
            mass: self.mass + mass,
            moment: add_scaled_vector(mass, p, self.moment),
            tensor,
        }
    }

    /// Replaces first moments and products of inertia at rounding level by zero.
    fn round_moment_noise_to_zero(&self) -> NumericMassProperties {
        let size = self.tensor.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        let cleaned_tensor_entry = |i: usize, j: usize| match i == j {
            true => self.tensor[i][j],
            false => round_noise_to_zero(self.tensor[i][j], size),
        };
        NumericMassProperties {
            mass: self.mass,
            moment: zero_rounding_errors_of_vector(self.moment),
            tensor: std::array::from_fn(|i| std::array::from_fn(|j| cleaned_tensor_entry(i, j))),
        }
    }
}
