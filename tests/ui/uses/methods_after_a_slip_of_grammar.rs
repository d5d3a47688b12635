use linkwork::prelude::*;

#[mechanism]
struct Pendulum {
    mass: f64,
    #[body(mass = mass +, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[acts(on = hinge)]
    motor: Torque,
}

fn main() {
    let pendulum = Pendulum { mass: 1.0 };
    let q = pendulum.neutral();
    let v = pendulum.integrate(&q, &Default::default());
    let _ = pendulum.mass_matrix(&q) * pendulum.bias_forces(&q, &v);
    let _ = pendulum.forward_dynamics(&q, &v, &pendulum.generalized_forces(&q, &[0.0].into()));
    let _ = pendulum.kinetic_energy(&q, &v) + pendulum.potential_energy(&q);
    let _ = (Pendulum::NQ, Pendulum::NV, Pendulum::NU, Pendulum::VELOCITIES, Pendulum::INPUTS);
    let _ = pendulum.center_of_mass(&q) * pendulum.total_mass();
    let _ = pendulum.momentum(&q, &v);
    let _ = simulate(&pendulum);
}
