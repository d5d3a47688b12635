use linkwork::prelude::*;

#[mechanism]
struct Pendulum {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {
    let pendulum = Pendulum;
    let _ = simulate(&pendulum).from([0.1, 0.2], [0.0]);
    let _ = pendulum.kinetic_energy(&SVector::from([0.1]), &SVector::from([0.1, 0.2]));
}
