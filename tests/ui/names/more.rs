//! Further names that are not there.

mod axis_of_body {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts(on = arm, along = ground.w)]
        push: Force,
    }
}

mod body_called_ground {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        ground: Body,
        #[joint(ground -> ground, along = x)]
        rail: Sleeve,
    }
}

mod body_of_axes {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts(on = arm, along = grund.x)]
        push: Force,
    }
}

mod capital {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        M: f64,
        #[body(mass = m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod element_type_of_another_trade {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Prismatic,
    }
}

mod function_of_rust {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        length: f64,
        #[body(mass = 1, com = -length.sqrt() * y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod joint_of_coordinate {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = sphere(1, 1))]
        block: Body,
        #[joint(ground -> block, along = x, about = z)]
        slot: Slot,
        #[acts(on = slit.turn, damping = 1)]
        friction: Dashpot,
    }
}

mod method {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground.ad(x) -> cart, along = x)]
        rail: Sleeve,
    }
}

mod nothing_like_it {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = hovercraft)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod option {
    use linkwork::prelude::*;

    #[mechanism(gravty = -9.81 * y)]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod parameter_called_t {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        t: f64,
        #[body(mass = t)]
        cart: Body,
        #[joint(ground -> cart, along = y)]
        rail: Sleeve,
    }
}

mod parameter_called_x {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        x: f64,
        #[body(mass = x)]
        cart: Body,
        #[joint(ground -> cart, along = y)]
        rail: Sleeve,
    }
}

mod parent {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[body(mass = 1, com = y)]
        pole: Body,
        #[joint(chart -> pole, about = z)]
        hinge: Pin,
    }
}

mod particle_body {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[particle(mass = 1, at = arn.at(-y))]
        bob: Particle,
    }
}

mod required_argument {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts(on = hinge, stifness = 1)]
        coil: Spring,
    }
}

fn main() {}
