//! A struct with a generic scalar type gets the same messages.

use linkwork::prelude::*;

#[mechanism(prepare)]
struct Pendulum<T> {
    mass: T,
    #[body(mass = mass, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn inverse<T: Real>(pendulum: &Pendulum<T>, q: &SVector<T, 1>) -> SMatrix<T, 1, 1> {
    pendulum.mass_matrix_inverse(q)
}

fn main() {
    let pendulum = Pendulum { mass: 1.0 };
    let _ = inverse(&pendulum, &[0.0].into());
    let prepared = pendulum.prepare();
    let _ = prepared.coriolis_matrix(&[0.0].into(), &[0.0].into());
    let _ = prepared.frame_placement(frame!(Pendulum<f64>, "arm"), &[0.0].into());
}
