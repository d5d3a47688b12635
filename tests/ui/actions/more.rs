//! Further force elements that act on nothing.

mod about_for_along {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = cart, about = x)]
        acting: Force,
    }
}

mod coordinate_of_a_body {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = cart.x)]
        acting: Force,
    }
}

mod dashpot_on_a_body {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = cart, damping = 1)]
        acting: Dashpot,
    }
}

mod direction_on_a_joint {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail, along = x)]
        acting: Force,
    }
}

mod fixed_body {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        post: Body,
        #[joint(ground -> post)]
        footing: Weld,
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = post, along = x)]
        acting: Force,
    }
}

mod free_angle_of_a_length {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail, stiffness = 1, free_angle = 1)]
        acting: Spring,
    }
}

mod free_length_of_an_angle {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts(on = hinge, stiffness = 1, free_length = 1)]
        acting: Spring,
    }
}

mod ground {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = ground, along = x)]
        acting: Force,
    }
}

mod joint_without_plain_coordinates {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = sphere(1, 1))]
        ball: Body,
        #[joint(ground -> ball)]
        socket: Ball,
        #[acts(on = socket, damping = 1)]
        acting: Dashpot,
    }
}

mod negative_damping {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail, damping = -1)]
        acting: Dashpot,
    }
}

mod no_torque_direction {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts(on = arm)]
        acting: Torque,
    }
}

mod on_a_number {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = 1)]
        acting: Force,
    }
}

mod on_a_parameter {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = m)]
        acting: Force,
    }
}

mod on_itself {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = acting)]
        acting: Force,
    }
}

mod point_of_a_joint {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail.at(x))]
        acting: Force,
    }
}

mod point_of_the_ground {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = ground.at(x), along = x)]
        acting: Force,
    }
}

mod two_free_lengths {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail, stiffness = 1, free_length = 1, free_angle = 1)]
        acting: Spring,
    }
}

mod vector_stiffness {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail, stiffness = x)]
        acting: Spring,
    }
}

mod weld {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        post: Body,
        #[joint(ground -> post)]
        footing: Weld,
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = footing, damping = 1)]
        acting: Dashpot,
    }
}

mod zero_direction {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = cart, along = 0 * x)]
        acting: Force,
    }
}

fn main() {}
