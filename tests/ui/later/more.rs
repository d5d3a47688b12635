//! What is not yet supported.

mod coordinate {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        theta: Coordinate,
    }
}

mod frame {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[frame(ground, z(1))]
        thing: Frame,
    }
}

mod friction {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail, force = 1)]
        thing: Friction,
    }
}

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

mod inerter {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail, inertance = 1)]
        thing: Inerter,
    }
}

mod input {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        throttle: Input,
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

mod point {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[point(on = cart, at = x)]
        thing: Point,
    }
}

mod potential {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[energy(1)]
        thing: Potential,
    }
}

mod rayleigh {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[dissipation(1)]
        thing: Rayleigh,
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

mod scalar {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[output(rail)]
        thing: Scalar,
    }
}

mod time {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        spin: f64,
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts(on = hinge, stiffness = sin(spin * t))]
        coil: Spring,
    }
}

mod use_of_an_element_to_come {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        theta: Coordinate,
        #[particle(mass = 1, at = ground.at(sin(theta) * x))]
        bead: Particle,
    }
}

mod value {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = cart, value = 2 * x)]
        thing: Force,
    }
}

mod vector {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[define(r(cart / ground))]
        thing: Vector,
    }
}

fn main() {}
