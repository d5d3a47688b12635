//! Calls that need an option of the attribute report this option; the user's own methods take precedence.

use linkwork::prelude::*;

#[mechanism]
struct Pendulum {
    mass: f64,
    #[body(mass = mass, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[output(dot(a(arm.at(-y) / ground / ground), y))]
    lift: Scalar,
}

impl Pendulum {
    fn mass_matrix_packed(&self) -> f64 {
        self.mass
    }
}

fn main() {
    let pendulum = Pendulum { mass: pendulum_mass() };
    let (q, v, a) = ([0.0].into(), [0.0].into(), [0.0].into());
    let _ = pendulum.mass_matrix_packed() + pendulum.lift(&q, &v, &a);

    let (_, _) = pendulum.linearize(&q, &v, &[].into());
    let _ = pendulum.centroidal_momentum_matrix(&q);
    let _ = pendulum.hamiltonian(&q, &v);
    let _ = pendulum.conserved(&q, &v);
    let _ = Pendulum::CONSERVED;
    let _ = pendulum.joint_torque_regressor(&q, &v, &a);
    let _ = pendulum.forward_dynamics_by_parameters(&q, &v, &a);
    let _ = Pendulum::MASS_MATRIX_ENTRIES;
    let _ = pendulum.prepare();
    let _ = pendulum.mass_matrix_lanes(&q);
    let _ = pendulum.assemble(&q, &[]);
    let _ = pendulum.lift_jacobian(&q, &v, &a);
    let _ = pendulum.linear_motion(&q, &v, &[].into());
}

fn pendulum_mass() -> f64 {
    1.0
}
