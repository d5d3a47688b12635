//! Rigid motions as Taylor series in time, and inertial forces of moving bodies. All vectors are in ground
//! axes.

use crate::jet::{
    C, Jet, Matrix, Vector, complex_from_real, constant_vector, cross, identity_matrix, matrix_product,
    rotated_vector, sum_of_vectors, transposed_matrix,
};
use std::array::from_fn;

/// Pose of a rigid body as Taylor series in time: rotation matrix and position.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    pub r: Matrix,
    pub p: Vector,
}

impl Pose {
    /// Returns the identity pose, at rest.
    pub fn identity_pose() -> Pose {
        Pose { r: identity_matrix(), p: constant_vector([0.0; 3]) }
    }
}

/// Rigid body with its mass, inertia and motion in ground axes.
pub struct MovingBody {
    pub mass: f64,
    /// Inertia of the body about its centre of mass, in body axes.
    pub inertia: [[f64; 3]; 3],
    /// Rotation matrix of the body axes relative to the ground.
    pub r: Matrix,
    /// Position of the body's centre of mass in ground axes.
    pub p: Vector,
}

impl MovingBody {
    /// Returns the product of the inertia in ground axes and a vector.
    fn inertia_times_vector(&self, x: [C; 3]) -> [C; 3] {
        let r: [[C; 3]; 3] = from_fn(|i| from_fn(|j| self.r[i][j].0[0]));
        let own: [C; 3] = from_fn(|i| (0..3).map(|j| r[j][i] * x[j]).sum());
        let product: [C; 3] = from_fn(|i| (0..3).map(|j| own[j] * self.inertia[i][j]).sum());
        from_fn(|i| (0..3).map(|j| r[i][j] * product[j]).sum())
    }

    /// Returns the generalized inertial force, including gravity, for the partial velocity of `moved`.
    pub fn generalized_inertial_force(&self, moved: &MovingBody, gravity: [f64; 3]) -> C {
        let force: [C; 3] = from_fn(|i| (self.p[i].second_time_derivative() - gravity[i]) * self.mass);
        let (w, alpha) = angular_motion(&self.r);
        let (first, second) = (self.inertia_times_vector(alpha), cross(w, self.inertia_times_vector(w)));
        let torque: [C; 3] = from_fn(|i| first[i] + second[i]);
        complex_dot(force, velocity_of_position(moved.p)) + complex_dot(torque, angular_motion(&moved.r).0)
    }

    /// Returns the kinetic energy of the body.
    pub fn kinetic_energy(&self) -> C {
        let (v, (w, _)) = (velocity_of_position(self.p), angular_motion(&self.r));
        (complex_dot(v, v) * self.mass + complex_dot(w, self.inertia_times_vector(w))) * 0.5
    }
}

/// Composes two poses; `b` is relative to `a`.
pub fn compose_poses(a: &Pose, b: &Pose) -> Pose {
    Pose { r: matrix_product(&a.r, &b.r), p: sum_of_vectors(a.p, rotated_vector(&a.r, b.p)) }
}

/// Returns the inverse of a pose.
pub fn inverse_pose(pose: &Pose) -> Pose {
    let r = transposed_matrix(&pose.r);
    Pose { r, p: rotated_vector(&r, pose.p).map(|x| -x) }
}

/// Returns the rotation matrix of a quaternion (x, y, z, w).
pub fn rotation_of_quaternion(q: &[C]) -> [[C; 3]; 3] {
    let (x, y, z, w) = (q[0], q[1], q[2], q[3]);
    let two = complex_from_real(2.0);
    let one = complex_from_real(1.0);
    [
        [one - two * (y * y + z * z), two * (x * y - z * w), two * (x * z + y * w)],
        [two * (x * y + z * w), one - two * (x * x + z * z), two * (y * z - x * w)],
        [two * (x * z - y * w), two * (y * z + x * w), one - two * (x * x + y * y)],
    ]
}

/// Returns `R (1 + [w] t + ([w'] + [w]²) t²/2)`: an orientation that rotates with angular velocity `w` and
/// its rate in body axes.
pub fn rotating_orientation(q: &[C], w: [C; 3], rate: [C; 3]) -> Matrix {
    let r0 = rotation_of_quaternion(q);
    let skew_matrix = |w: [C; 3]| {
        let o = complex_from_real(0.0);
        [[o, -w[2], w[1]], [w[2], o, -w[0]], [-w[1], w[0], o]]
    };
    let (k, l) = (skew_matrix(w), skew_matrix(rate));
    from_fn(|i| {
        from_fn(|j| {
            let first: C = (0..3).map(|m| r0[i][m] * k[m][j]).sum();
            let second: C = (0..3)
                .map(|m| {
                    let square: C = (0..3).map(|n| k[m][n] * k[n][j]).sum();
                    r0[i][m] * (l[m][j] + square)
                })
                .sum();
            Jet([r0[i][j], first, second * 0.5])
        })
    })
}

/// Returns a position that moves with a velocity in body axes.
pub fn position_moving_with_velocity(p: &[C], r: &Matrix, v: [C; 3], w: [C; 3], rate: [C; 3]) -> Vector {
    let spin = cross(w, v);
    from_fn(|i| {
        let first: C = (0..3).map(|j| r[i][j].0[0] * v[j]).sum();
        let second: C = (0..3).map(|j| r[i][j].0[0] * (rate[j] + spin[j])).sum();
        Jet([p[i], first, second * 0.5])
    })
}

/// Returns the angular velocity and angular acceleration of a rotation matrix in ground axes, from `R' Rᵀ`
/// and its time derivative.
pub fn angular_motion(r: &Matrix) -> ([C; 3], [C; 3]) {
    let sum_of_derivative_products = |order: (usize, usize), i: usize, j: usize| -> C {
        (0..3).map(|k| r[i][k].0[order.0] * r[j][k].0[order.1]).sum()
    };
    // The coefficient of t² is half the second derivative.
    let angular_velocity_entry = |i: usize, j: usize| sum_of_derivative_products((1, 0), i, j);
    let angular_acceleration_entry = |i: usize, j: usize| {
        sum_of_derivative_products((2, 0), i, j) * 2.0 + sum_of_derivative_products((1, 1), i, j)
    };
    (
        [angular_velocity_entry(2, 1), angular_velocity_entry(0, 2), angular_velocity_entry(1, 0)],
        [
            angular_acceleration_entry(2, 1),
            angular_acceleration_entry(0, 2),
            angular_acceleration_entry(1, 0),
        ],
    )
}

/// Returns the velocity, which is the first derivative of a position series.
pub fn velocity_of_position(p: Vector) -> [C; 3] {
    p.map(Jet::first_time_derivative)
}

/// Returns the product `a · b` of complex vectors, without conjugation.
pub fn complex_dot(a: [C; 3], b: [C; 3]) -> C {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
