//! After an error the mechanism has all functions, so that calls of them are not reported as well.

use linkwork::prelude::*;

macro_rules! call_functions {
    ($name:ident) => {
        let pendulum = $name { mass: 1.0 };
        let q = pendulum.neutral();
        let v = pendulum.integrate(&q, &Default::default());
        let _ = pendulum.mass_matrix(&q) * pendulum.bias_forces(&q, &v);
        let _ = pendulum.forward_dynamics(&q, &v, &pendulum.generalized_forces(&q, &[0.0].into()));
        let _ = pendulum.kinetic_energy(&q, &v) + pendulum.potential_energy(&q);
        let _ = ($name::NQ, $name::NV, $name::NU, $name::VELOCITIES, $name::INPUTS);
        let _ = pendulum.center_of_mass(&q) * pendulum.total_mass();
        let _ = pendulum.momentum(&q, &v);
        let _ = simulate(&pendulum);
    };
}

#[mechanism]
struct UnknownName {
    mass: f64,
    #[body(mass = mas, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[acts(on = hinge)]
    motor: Torque,
}

#[mechanism]
struct MissingOperand {
    mass: f64,
    #[body(mass = mass +, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[acts(on = hinge)]
    motor: Torque,
}

#[mechanism]
struct UnknownType {
    mass: f64,
    #[body(mass = mass, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pinn,
    #[acts(on = hinge)]
    motor: Torque,
}

fn main() {
    call_functions!(UnknownName);
    call_functions!(MissingOperand);
    call_functions!(UnknownType);
}
