use linkwork::prelude::*;

#[mechanism]
struct Machine {
    #[body]
    a: Body,
    #[body]
    b: Body,
    #[joint(ground -> a, about = z)]
    first: Pin,
    #[joint(a -> b, about = z)]
    second: Pin,
}

fn main() {}
