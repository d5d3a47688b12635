//! Further slips in attributes.

mod argument_of_another_element {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts(on = hinge, damping = 1)]
        coil: Spring,
    }
}

mod arrow_to_the_left {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(cart <- ground, along = x)]
        rail: Sleeve,
    }
}

mod attribute_of_a_parameter {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        mass: f64,
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod attribute_of_rust {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[serde(skip)]
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod axis_of_a_ball {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = sphere(1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Ball,
    }
}

mod chain {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart -> cart, along = x)]
        rail: Sleeve,
    }
}

mod colon {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass: 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod condition {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[cfg(test)]
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod double_arrow {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground => cart, along = x)]
        rail: Sleeve,
    }
}

mod equals_instead_of_parentheses {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body = 1]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod friction_speed {
    use linkwork::prelude::*;

    #[mechanism(friction_speed = 0)]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod no_arguments {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts]
        friction: Dashpot,
    }
}

mod no_arrow {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground, cart, along = x)]
        rail: Sleeve,
    }
}

mod no_axis {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = y)]
        arm: Body,
        #[joint(ground -> arm)]
        hinge: Pin,
    }
}

mod no_comma {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1 com = y)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod no_damping {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts(on = hinge)]
        friction: Dashpot,
    }
}

mod no_mass {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[particle(at = arm.at(-y))]
        bob: Particle,
    }
}

mod no_name {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod no_pitch {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = sphere(1, 1))]
        nut: Body,
        #[joint(ground -> nut, about = z)]
        thread: Screw,
    }
}

mod no_target {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts(damping = 1)]
        friction: Dashpot,
    }
}

mod one_axis_of_two {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = y, inertia = sphere(1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        cross: Universal,
    }
}

mod option_twice {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y, gravity = -1.62 * y)]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod pitch_and_lead {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = sphere(1, 1))]
        nut: Body,
        #[joint(ground -> nut, about = z, pitch = 1, lead = 1)]
        thread: Screw,
    }
}

mod prescribed_motion {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(massive)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod relation_in_body {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(ground -> cart, mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod rotation {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x, rotation = z(pi / 2))]
        rail: Sleeve,
    }
}

mod scalar_gravity {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81)]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod text_for_a_number {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = "1 kg")]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod two_attributes {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        #[body(inertia = sphere(1, 1))]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod two_axes {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = y)]
        arm: Body,
        #[joint(ground -> arm, about = (y, z))]
        hinge: Pin,
    }
}

mod two_relations {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, cart -> ground, along = x)]
        rail: Sleeve,
    }
}

mod urdf_option_without_file {
    use linkwork::prelude::*;

    #[mechanism(base = free)]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

fn main() {}
