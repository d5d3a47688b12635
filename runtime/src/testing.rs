//! Hand-written mechanisms with closed-form solutions, for the tests of this crate.

use crate::__private::{ball_integrate, ball_tangent_rate, constant, free_integrate, free_tangent_rate};
use crate::integrate::Hooks;
use crate::{Mechanism, Real, Scleronomic};
use nalgebra::{SMatrix, SVector, Vector3};

/// Test mechanism with one coordinate of the inertia `inertia` under the damped force `force(q)`. The input
/// is a force on the coordinate.
pub(crate) struct OneDof<T> {
    pub(crate) inertia: T,
    pub(crate) damping: T,
    pub(crate) force: fn(T) -> T,
    pub(crate) energy: fn(T) -> T,
}

/// Returns the harmonic oscillator `q̈ = −q` as a test mechanism.
pub(crate) fn harmonic_oscillator<T: Real>() -> OneDof<T> {
    let half_square = |q: T| q * q * constant(0.5);
    OneDof { inertia: T::one(), damping: T::zero(), force: |q| -q, energy: half_square }
}

/// Returns a pendulum of unit mass and length under unit gravity.
pub(crate) fn unit_pendulum() -> OneDof<f64> {
    OneDof { inertia: 1.0, damping: 0.0, force: |q| -q.sin(), energy: |q| 1.0 - q.cos() }
}

/// Returns a ball of unit mass above the floor under unit gravity.
pub(crate) fn falling_ball() -> OneDof<f64> {
    OneDof { inertia: 1.0, damping: 0.0, force: |_| -1.0, energy: |q| q }
}

type TestVector<T, const N: usize> = SVector<T, N>;

impl<T: Real> Hooks<T, 1, 1, 1> for OneDof<T> {}

impl<T: Real> Scleronomic for OneDof<T> {}

impl<T: Real> Mechanism<1, 1, 1> for OneDof<T> {
    type Scalar = T;
    const CONFIGURATION: [&'static str; 1] = ["q"];
    const VELOCITIES: [&'static str; 1] = ["q"];
    const INPUTS: [&'static str; 1] = ["push"];

    fn neutral(&self) -> TestVector<T, 1> {
        SVector::zeros()
    }
    fn difference(&self, from: &TestVector<T, 1>, to: &TestVector<T, 1>) -> TestVector<T, 1> {
        to - from
    }

    fn integrate(&self, q: &TestVector<T, 1>, dv: &TestVector<T, 1>) -> TestVector<T, 1> {
        q + dv
    }
    fn tangent_rate(&self, _dv: &TestVector<T, 1>, v: &TestVector<T, 1>) -> TestVector<T, 1> {
        *v
    }
    fn mass_matrix(&self, _t: T, _q: &TestVector<T, 1>) -> SMatrix<T, 1, 1> {
        SMatrix::from([self.inertia])
    }
    fn bias_forces(&self, t: T, q: &TestVector<T, 1>, v: &TestVector<T, 1>) -> TestVector<T, 1> {
        -self.momentum_rate(t, q, v)
    }
    fn inverse_dynamics(
        &self,
        t: T,
        q: &TestVector<T, 1>,
        v: &TestVector<T, 1>,
        a: &TestVector<T, 1>,
    ) -> TestVector<T, 1> {
        a * self.inertia + self.bias_forces(t, q, v)
    }
    fn forward_dynamics(
        &self,
        t: T,
        q: &TestVector<T, 1>,
        v: &TestVector<T, 1>,
        tau: &TestVector<T, 1>,
    ) -> TestVector<T, 1> {
        (tau - self.bias_forces(t, q, v)) / self.inertia
    }
    fn generalized_forces(
        &self,
        _t: T,
        _q: &TestVector<T, 1>,
        _v: &TestVector<T, 1>,
        u: &TestVector<T, 1>,
    ) -> TestVector<T, 1> {
        *u
    }
    fn kinetic_energy(&self, _t: T, _q: &TestVector<T, 1>, v: &TestVector<T, 1>) -> T {
        self.inertia * v[0] * v[0] * constant(0.5)
    }
    fn potential_energy(&self, _t: T, q: &TestVector<T, 1>) -> T {
        (self.energy)(q[0])
    }
    fn generalized_momentum(&self, _t: T, _q: &TestVector<T, 1>, v: &TestVector<T, 1>) -> TestVector<T, 1> {
        v * self.inertia
    }
    fn momentum_rate(&self, _t: T, q: &TestVector<T, 1>, v: &TestVector<T, 1>) -> TestVector<T, 1> {
        SVector::from([(self.force)(q[0]) - self.damping * v[0]])
    }
}

/// A body that rotates about its fixed centre of mass: a ball joint. The input is a torque in the body frame.
pub(crate) struct SpinningTop<T> {
    pub(crate) inertia: Vector3<T>,
}

impl<T: Real> Hooks<T, 4, 3, 3> for SpinningTop<T> {}

impl<T: Real> Scleronomic for SpinningTop<T> {}

impl<T: Real> Mechanism<4, 3, 3> for SpinningTop<T> {
    type Scalar = T;
    const CONFIGURATION: [&'static str; 4] = ["qx", "qy", "qz", "qw"];
    const VELOCITIES: [&'static str; 3] = ["wx", "wy", "wz"];
    const INPUTS: [&'static str; 3] = ["x", "y", "z"];

    fn neutral(&self) -> TestVector<T, 4> {
        SVector::from([T::zero(), T::zero(), T::zero(), T::one()])
    }
    fn difference(&self, from: &TestVector<T, 4>, to: &TestVector<T, 4>) -> TestVector<T, 3> {
        TestVector::from(crate::lie::ball_difference(from.data.0[0], to.data.0[0]))
    }

    fn integrate(&self, q: &TestVector<T, 4>, dv: &TestVector<T, 3>) -> TestVector<T, 4> {
        ball_integrate((*q).into(), (*dv).into()).into()
    }
    fn tangent_rate(&self, dv: &TestVector<T, 3>, v: &TestVector<T, 3>) -> TestVector<T, 3> {
        ball_tangent_rate((*dv).into(), (*v).into()).into()
    }
    fn mass_matrix(&self, _t: T, _q: &TestVector<T, 4>) -> SMatrix<T, 3, 3> {
        SMatrix::from_diagonal(&self.inertia)
    }
    fn bias_forces(&self, _t: T, _q: &TestVector<T, 4>, v: &TestVector<T, 3>) -> TestVector<T, 3> {
        v.cross(&self.inertia.component_mul(v))
    }
    fn inverse_dynamics(
        &self,
        t: T,
        q: &TestVector<T, 4>,
        v: &TestVector<T, 3>,
        a: &TestVector<T, 3>,
    ) -> TestVector<T, 3> {
        self.inertia.component_mul(a) + self.bias_forces(t, q, v)
    }
    fn forward_dynamics(
        &self,
        t: T,
        q: &TestVector<T, 4>,
        v: &TestVector<T, 3>,
        tau: &TestVector<T, 3>,
    ) -> TestVector<T, 3> {
        (tau - self.bias_forces(t, q, v)).component_div(&self.inertia)
    }
    fn generalized_forces(
        &self,
        _t: T,
        _q: &TestVector<T, 4>,
        _v: &TestVector<T, 3>,
        u: &TestVector<T, 3>,
    ) -> TestVector<T, 3> {
        *u
    }
    fn kinetic_energy(&self, _t: T, _q: &TestVector<T, 4>, v: &TestVector<T, 3>) -> T {
        self.inertia.component_mul(v).dot(v) * constant(0.5)
    }
    fn potential_energy(&self, _t: T, _q: &TestVector<T, 4>) -> T {
        T::zero()
    }
    fn generalized_momentum(&self, _t: T, _q: &TestVector<T, 4>, v: &TestVector<T, 3>) -> TestVector<T, 3> {
        self.inertia.component_mul(v)
    }
    fn momentum_rate(&self, t: T, q: &TestVector<T, 4>, v: &TestVector<T, 3>) -> TestVector<T, 3> {
        -self.bias_forces(t, q, v)
    }
}

/// Returns the vector `a` rotated by the quaternion `q` (x y z w).
pub(crate) fn rotate_vector(q: [f64; 4], a: Vector3<f64>) -> Vector3<f64> {
    let [x, y, z, w] = q;
    let u = Vector3::new(x, y, z);
    a + u.cross(&(u.cross(&a) + a * w)) * 2.0
}

/// A free body with its centre of mass at the origin, under gravity along −z.
pub(crate) struct FreeBody {
    pub(crate) mass: f64,
    pub(crate) inertia: Vector3<f64>,
    pub(crate) gravity: f64,
}

/// Splits a velocity into its linear and angular parts.
fn split_twist(v: &TestVector<f64, 6>) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5]))
}

fn join_twist(a: Vector3<f64>, b: Vector3<f64>) -> TestVector<f64, 6> {
    SVector::from([a.x, a.y, a.z, b.x, b.y, b.z])
}

impl Hooks<f64, 7, 6, 0> for FreeBody {}

impl Scleronomic for FreeBody {}

impl Mechanism<7, 6, 0> for FreeBody {
    type Scalar = f64;
    const CONFIGURATION: [&'static str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];
    const VELOCITIES: [&'static str; 6] = ["vx", "vy", "vz", "wx", "wy", "wz"];
    const INPUTS: [&'static str; 0] = [];

    fn neutral(&self) -> TestVector<f64, 7> {
        SVector::from([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    }
    fn difference(&self, from: &TestVector<f64, 7>, to: &TestVector<f64, 7>) -> TestVector<f64, 6> {
        TestVector::from(crate::lie::free_difference(from.data.0[0], to.data.0[0]))
    }

    fn integrate(&self, q: &TestVector<f64, 7>, dv: &TestVector<f64, 6>) -> TestVector<f64, 7> {
        free_integrate((*q).into(), (*dv).into()).into()
    }
    fn tangent_rate(&self, dv: &TestVector<f64, 6>, v: &TestVector<f64, 6>) -> TestVector<f64, 6> {
        free_tangent_rate((*dv).into(), (*v).into()).into()
    }
    fn mass_matrix(&self, _t: f64, _q: &TestVector<f64, 7>) -> SMatrix<f64, 6, 6> {
        SMatrix::from_diagonal(&join_twist(Vector3::repeat(self.mass), self.inertia))
    }
    fn bias_forces(&self, t: f64, q: &TestVector<f64, 7>, v: &TestVector<f64, 6>) -> TestVector<f64, 6> {
        -self.momentum_rate(t, q, v)
    }
    fn inverse_dynamics(
        &self,
        t: f64,
        q: &TestVector<f64, 7>,
        v: &TestVector<f64, 6>,
        a: &TestVector<f64, 6>,
    ) -> TestVector<f64, 6> {
        self.mass_matrix(t, q) * a + self.bias_forces(t, q, v)
    }
    fn forward_dynamics(
        &self,
        t: f64,
        q: &TestVector<f64, 7>,
        v: &TestVector<f64, 6>,
        tau: &TestVector<f64, 6>,
    ) -> TestVector<f64, 6> {
        (tau - self.bias_forces(t, q, v)).component_div(&self.mass_matrix(t, q).diagonal())
    }
    fn generalized_forces(
        &self,
        _t: f64,
        _q: &TestVector<f64, 7>,
        _v: &TestVector<f64, 6>,
        _u: &TestVector<f64, 0>,
    ) -> TestVector<f64, 6> {
        SVector::zeros()
    }
    fn kinetic_energy(&self, t: f64, q: &TestVector<f64, 7>, v: &TestVector<f64, 6>) -> f64 {
        (self.mass_matrix(t, q) * v).dot(v) * 0.5
    }
    fn potential_energy(&self, _t: f64, q: &TestVector<f64, 7>) -> f64 {
        self.mass * self.gravity * q[2]
    }
    fn generalized_momentum(
        &self,
        t: f64,
        q: &TestVector<f64, 7>,
        v: &TestVector<f64, 6>,
    ) -> TestVector<f64, 6> {
        self.mass_matrix(t, q) * v
    }
    fn momentum_rate(&self, _t: f64, q: &TestVector<f64, 7>, v: &TestVector<f64, 6>) -> TestVector<f64, 6> {
        let (linear, angular) = split_twist(v);
        let weight = Vector3::new(0.0, 0.0, -self.mass * self.gravity);
        let weight = rotate_vector([-q[3], -q[4], -q[5], q[6]], weight);
        let spin = self.inertia.component_mul(&angular);
        join_twist(linear.cross(&angular) * self.mass + weight, spin.cross(&angular))
    }
}

/// Returns attitude and angular velocity in the body frame of the symmetric free top `inertia = (a, a, c)` at
/// time `t`, which starts at the ground's attitude with the velocity `w`: `R = exp(t L/a) exp(t (w₃ − L₃/a)
/// e₃)`.
pub(crate) fn symmetric_top_motion(
    inertia: Vector3<f64>,
    w: Vector3<f64>,
    t: f64,
) -> ([f64; 4], Vector3<f64>) {
    let momentum = inertia.component_mul(&w) / inertia.x;
    let rate = w.z - momentum.z;
    let nutation = (momentum * t).into();
    let attitude = ball_integrate([0.0, 0.0, 0.0, 1.0], nutation);
    let attitude = ball_integrate(attitude, [0.0, 0.0, rate * t]);
    let (sin, cos) = (rate * t).sin_cos();
    let w = Vector3::new(cos * w.x + sin * w.y, cos * w.y - sin * w.x, w.z);
    (attitude, w)
}

/// Returns the period of the pendulum of [`pendulum`] with the amplitude `angle`: `2π / agm(1,
/// cos(angle/2))`.
pub(crate) fn pendulum_period(angle: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (angle / 2.0).cos());
    for _ in 0..8 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    2.0 * core::f64::consts::PI / a
}
