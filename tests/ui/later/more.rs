//! What is not yet supported.

mod holonomic {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[constraint(rail)]
        thing: Holonomic,
    }
}

mod nonholonomic {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[constraint(rate(rail))]
        thing: Nonholonomic,
    }
}

mod rolling {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[constraint(rolls(cart.circle(1, y), ground.plane(z)))]
        thing: Rolling,
    }
}

fn main() {}
