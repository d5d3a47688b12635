use linkwork::prelude::*;

#[mechanism(derivatives)]
struct Machine {
    #[body(mass = 1, inertia = sphere(1, 1))]
    disk: Body,
    #[joint(ground -> disk, about = z)]
    turn: Pin,
    #[output(turn)]
    NV: Scalar,
    #[output(turn)]
    r#type: Scalar,
    #[output(turn)]
    __accelerations: Scalar,
    #[output(turn)]
    linearize: Scalar,
}

fn main() {}
