use linkwork::prelude::*;

#[mechanism]
struct Pendulum {
    #[body(mass = 1, com = -y)]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
}

fn main() {
    let _ = Pendulum.mass_matrix(&SVector::<f64, 2>::zeros());
}
