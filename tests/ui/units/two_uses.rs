use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * y)]
struct Pole {
    m: f64,
    l: f64,
    #[body(mass = m, com = l / 2 * y, inertia = rod(l, m, y))]
    pole: Body,
    #[joint(ground -> pole, about = z)]
    hinge: Pin,
}

fn main() {}
