//! Numeric vectors, rotations, poses and symmetric matrices for robot files.

use std::f64::consts::FRAC_PI_2;

/// Vector with three components.
pub(in crate::import) type Vector = [f64; 3];

/// Matrix stored by rows. The columns of a rotation matrix are the axes of the rotated frame.
pub(in crate::import) type Matrix = [[f64; 3]; 3];

/// Identity matrix, as the axes of a frame that is not rotated.
pub(in crate::import) const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Maximum magnitude of a number that is taken for a rounding error of zero.
const ROUNDING: f64 = 1e-15;

/// Pose of a frame relative to a reference frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::import) struct NumericPose {
    /// Origin of the frame, in the axes of the reference frame.
    pub(in crate::import) at: Vector,
    /// Rotation matrix; its columns are the axes of the frame.
    pub(in crate::import) axes: Matrix,
}

impl NumericPose {
    /// Pose of a frame that coincides with its reference frame.
    pub(in crate::import) const ZERO: NumericPose = NumericPose { at: [0.0; 3], axes: IDENTITY };

    /// Returns the inverse: the pose of the reference frame relative to this frame.
    pub(in crate::import) fn inverse_pose(&self) -> NumericPose {
        let axes = transpose(&self.axes);
        NumericPose { at: vector_times_scalar(matrix_times_vector(&axes, self.at), -1.0), axes }
    }

    /// Composes two poses. `inner` is relative to this frame, the result to the reference frame.
    pub(in crate::import) fn compose_with(&self, inner: &NumericPose) -> NumericPose {
        NumericPose {
            at: vector_sum(self.at, matrix_times_vector(&self.axes, inner.at)),
            axes: matrix_product(&self.axes, &inner.axes),
        }
    }

    /// Returns the coordinates of a free joint in this pose: the position and the quaternion (x, y, z, w).
    /// Empty for the identity, which is the neutral configuration.
    pub(in crate::import) fn free_joint_coordinates(&self) -> Vec<f64> {
        if *self == NumericPose::ZERO {
            return Vec::new();
        }
        let [w, x, y, z] = quaternion_of_rotation(&self.axes);
        self.at.into_iter().chain([x, y, z, w]).collect()
    }
}

/// Returns the sum of two numeric vectors.
pub(in crate::import) fn vector_sum(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] + b[k])
}

/// Returns a vector times a scalar.
pub(in crate::import) fn vector_times_scalar(a: Vector, factor: f64) -> Vector {
    a.map(|x| x * factor)
}

/// Returns the dot product of two numeric vectors.
pub(in crate::import) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the cross product of two numeric vectors.
pub(in crate::import) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns the Euclidean norm of a vector.
pub(in crate::import) fn vector_norm(a: Vector) -> f64 {
    libm::hypot(libm::hypot(a[0], a[1]), a[2])
}

/// Returns the product of a matrix and a vector.
pub(in crate::import) fn matrix_times_vector(m: &Matrix, v: Vector) -> Vector {
    m.map(|row| dot(row, v))
}

/// Returns the product of two matrices.
pub(in crate::import) fn matrix_product(a: &Matrix, b: &Matrix) -> Matrix {
    let columns = transpose(b);
    a.map(|row| columns.map(|column| dot(row, column)))
}

/// Returns the transpose of a matrix.
pub(in crate::import) fn transpose(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

/// Transforms a symmetric matrix with the rotation `m`: `m s mᵀ`.
pub(in crate::import) fn rotated_tensor(m: &Matrix, s: &Matrix) -> Matrix {
    matrix_product(&matrix_product(m, s), &transpose(m))
}

/// Returns the unit quaternion (w, x, y, z) of a rotation matrix. The largest component is the square root of
/// its square and positive; the others follow from it by division (S. W. Shepperd, *Quaternion from rotation
/// matrix*, Journal of Guidance and Control 1, 1978).
pub(in crate::import) fn quaternion_of_rotation(r: &Matrix) -> [f64; 4] {
    let trace = r[0][0] + r[1][1] + r[2][2];
    // Four times the products of each pair of components.
    let squares =
        [1.0 + trace, 1.0 + 2.0 * r[0][0] - trace, 1.0 + 2.0 * r[1][1] - trace, 1.0 + 2.0 * r[2][2] - trace];
    let [wx, wy, wz] = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]];
    let [xy, xz, yz] = [r[1][0] + r[0][1], r[0][2] + r[2][0], r[2][1] + r[1][2]];
    let products = [
        [squares[0], wx, wy, wz],
        [wx, squares[1], xy, xz],
        [wy, xy, squares[2], yz],
        [wz, xz, yz, squares[3]],
    ];
    let largest = (0..4).max_by(|a, b| squares[*a].total_cmp(&squares[*b])).unwrap_or(0);
    let scale = products[largest].iter().map(|x| x * x).sum::<f64>().sqrt();
    products[largest].map(|x| x / scale)
}

/// Returns the rotation matrix of a unit quaternion (w, x, y, z).
pub(in crate::import) fn rotation_of_quaternion([w, x, y, z]: [f64; 4]) -> Matrix {
    [
        [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
}

/// Returns the rotation matrix about a unit axis; the angle is in radians.
pub(in crate::import) fn axis_rotation(axis: Vector, angle: f64) -> Matrix {
    let (s, c) = sin_cos(angle);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let skew = if i == j {
                0.0
            } else if (i + 1) % 3 == j {
                -axis[3 - i - j]
            } else {
                axis[3 - i - j]
            };
            let unit = if i == j { c } else { 0.0 };
            unit + s * skew + (1.0 - c) * axis[i] * axis[j]
        })
    })
}

/// Returns sine and cosine, exact at multiples of a right angle.
fn sin_cos(angle: f64) -> (f64, f64) {
    let (s, c) = libm::sincos(angle);
    let round_noise_to_zero = |x: f64| if x.abs() < ROUNDING { 0.0 } else { x };
    (round_noise_to_zero(s), round_noise_to_zero(c))
}

/// Returns the smallest rotation that maps the z axis to `direction`.
pub(in crate::import) fn rotation_from_z(direction: Vector) -> Matrix {
    let axis = cross([0.0, 0.0, 1.0], direction);
    let size = vector_norm(axis);
    let axis = if size < 1e-10 { [1.0, 0.0, 0.0] } else { vector_times_scalar(axis, 1.0 / size) };
    axis_rotation(axis, libm::atan2(size, direction[2]))
}

/// Returns roll, pitch and yaw of a rotation: `R = R_z(yaw) R_y(pitch) R_x(roll)`. The rotations are removed
/// one after the other, which stays accurate at the singularity (pitch ±90°).
pub(in crate::import) fn roll_pitch_yaw(m: &Matrix) -> Vector {
    let mut m = m.map(|row| row.map(|x| if x.abs() < ROUNDING { 0.0 } else { x }));
    let upright = libm::hypot(m[0][0], m[1][0]) < 1e-12;
    let yaw = if upright { 0.0 } else { round_to_right_angle(libm::atan2(m[1][0], m[0][0])) };
    m = matrix_product(&axis_rotation([0.0, 0.0, 1.0], -yaw), &m);
    let pitch = round_to_right_angle(libm::atan2(-m[2][0], m[0][0]));
    m = matrix_product(&axis_rotation([0.0, 1.0, 0.0], -pitch), &m);
    let roll = round_to_right_angle(libm::atan2(m[2][1], m[1][1]));
    [roll, pitch, yaw]
}

/// Rounds an angle that is within rounding error of a multiple of a right angle.
fn round_to_right_angle(angle: f64) -> f64 {
    let right = (angle / FRAC_PI_2).round() * FRAC_PI_2;
    // Adding zero converts −0 to 0.
    if (angle - right).abs() < ROUNDING { right + 0.0 } else { angle }
}

/// Returns the eigenvalues of a symmetric matrix, and its eigenvectors as columns (Jacobi's method).
pub(in crate::import) fn eigen_decomposition(s: &Matrix) -> (Vector, Matrix) {
    let (mut s, mut axes) = (*s, IDENTITY);
    for _ in 0..64 {
        let largest = [(0, 1), (0, 2), (1, 2)]
            .into_iter()
            .max_by(|a, b| s[a.0][a.1].abs().total_cmp(&s[b.0][b.1].abs()));
        let Some((i, j)) = largest.filter(|(i, j)| s[*i][*j] != 0.0) else { break };
        let angle = 0.5 * libm::atan2(2.0 * s[i][j], s[j][j] - s[i][i]);
        let (sin, cos) = libm::sincos(angle);
        let mut turn = IDENTITY;
        (turn[i][i], turn[j][j], turn[i][j], turn[j][i]) = (cos, cos, sin, -sin);
        s = matrix_product(&matrix_product(&transpose(&turn), &s), &turn);
        (s[i][j], s[j][i]) = (0.0, 0.0);
        axes = matrix_product(&axes, &turn);
    }
    ([s[0][0], s[1][1], s[2][2]], axes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_close(a: &Matrix, b: &Matrix) -> bool {
        a.iter().flatten().zip(b.iter().flatten()).all(|(x, y)| (x - y).abs() < 4e-15)
    }

    fn rotation_of_rpy([roll, pitch, yaw]: Vector) -> Matrix {
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        matrix_product(
            &matrix_product(&axis_rotation(z, yaw), &axis_rotation(y, pitch)),
            &axis_rotation(x, roll),
        )
    }

    #[test]
    fn euler_angles_reproduce_rotations_in_gimbal_lock() {
        let angles = [0.0, 1e-9, 0.3, FRAC_PI_2 - 1e-9, FRAC_PI_2, 2.5, -FRAC_PI_2, -3.0];
        for roll in angles {
            for pitch in angles {
                for yaw in angles {
                    let m = rotation_of_rpy([roll, pitch, yaw]);
                    assert!(is_close(&rotation_of_rpy(roll_pitch_yaw(&m)), &m), "{roll} {pitch} {yaw}");
                }
            }
        }
        assert_eq!(
            roll_pitch_yaw(&rotation_of_quaternion([0.5, 0.5, 0.5, 0.5])),
            [FRAC_PI_2, 0.0, FRAC_PI_2]
        );
    }

    #[test]
    fn quaternions_of_rotations_reproduce_them() {
        let angles = [0.0, 1e-9, 0.3, FRAC_PI_2, 2.5, std::f64::consts::PI, -FRAC_PI_2, -3.0];
        for roll in angles {
            for pitch in angles {
                for yaw in angles {
                    let m = rotation_of_rpy([roll, pitch, yaw]);
                    let quaternion = quaternion_of_rotation(&m);
                    assert!((quaternion.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15);
                    assert!(is_close(&rotation_of_quaternion(quaternion), &m), "{roll} {pitch} {yaw}");
                }
            }
        }
    }

    #[test]
    fn quaternions_equal_rotations_about_an_axis() {
        let (axis, angle) = (vector_times_scalar([1.0, 2.0, -2.0], 1.0 / 3.0), 0.7_f64);
        let [x, y, z] = vector_times_scalar(axis, (angle / 2.0).sin());
        assert!(is_close(
            &axis_rotation(axis, angle),
            &rotation_of_quaternion([(angle / 2.0).cos(), x, y, z])
        ));
        assert!((matrix_times_vector(&rotation_from_z(axis), [0.0, 0.0, 1.0])[1] - axis[1]).abs() < 1e-15);
    }

    #[test]
    fn principal_axes_diagonalise_the_inertia() {
        let s = [[3.0, 0.4, -0.2], [0.4, 2.0, 0.1], [-0.2, 0.1, 5.0]];
        let (values, axes) = eigen_decomposition(&s);
        let diagonal: Matrix =
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { values[i] } else { 0.0 }));
        assert!(is_close(&rotated_tensor(&axes, &diagonal), &s));
    }
}
