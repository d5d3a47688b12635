//! Further elements that cannot act.

mod attraction_on_a_joint {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = pin, strength = 1)]
        pull: Attraction,
    }
}

mod between_one {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(between = bead, stiffness = 1)]
        spring: Spring,
    }
}

mod between_three {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(between = (ground, bead, arm), stiffness = 1)]
        spring: Spring,
    }
}

mod between_frames {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(between = (ground, tilted), stiffness = 1)]
        spring: Spring,
    }
}

mod direction_and_value {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = bead, along = x, value = a * x)]
        push: Force,
    }
}

mod energy_of_a_vector {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[energy(a * x)]
        store: Potential,
    }
}

mod energy_with_a_rate {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[energy(rate(a))]
        store: Potential,
    }
}

mod force_on_a_slip {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = beat, along = x)]
        push: Force,
    }
}

mod force_that_is_a_scalar {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = bead, value = a)]
        push: Force,
    }
}

mod force_with_an_acceleration {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = bead, value = a(bead / ground / ground))]
        push: Force,
    }
}

mod friction_between {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(between = (ground, bead), coulomb = 1)]
        rub: Friction,
    }
}

mod friction_with_half_a_law {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = pin, coulomb = 1, stiction = 2)]
        rub: Friction,
    }
}

mod gravity_of_a_point {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(between = (bead, arm.at(x)), constant = 1)]
        pull: Gravity,
    }
}

mod gravity_of_a_body_off_its_centre {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[body(mass = 1, com = x, inertia = diagonal(1, 1, 1))]
        other: Body,
        #[joint(arm.at(2 * x) -> other, about = z)]
        hinge: Pin,
        #[acts(between = (ground, other), mu = 1)]
        pull: Gravity,
    }
}

mod gravity_on_a_body {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = bead, mu = 1)]
        pull: Gravity,
    }
}

mod gravity_with_both {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(between = (ground, bead), constant = 1, mu = 1)]
        pull: Gravity,
    }
}

mod inertance_of_nothing {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = pin)]
        inerter: Inerter,
    }
}

mod negative_inertance {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = pin, inertance = -1)]
        inerter: Inerter,
    }
}

mod on_and_between {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = pin, between = (ground, bead), stiffness = 1)]
        spring: Spring,
    }
}

mod spring_with_a_free_angle {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(between = (ground, bead), stiffness = 1, free_angle = 1)]
        spring: Spring,
    }
}

mod spring_with_a_rate {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = pin, force = rate(pin))]
        spring: Spring,
    }
}

mod speed_in_a_spring {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = pin, force = speed)]
        spring: Spring,
    }
}

mod stretch_in_a_dashpot {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = pin, force = stretch)]
        damper: Dashpot,
    }
}

mod two_laws {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = pin, stiffness = 1, force = stretch)]
        spring: Spring,
    }
}

mod value_on_the_ground {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        a: Coordinate,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        pin: Pin,
        #[particle(mass = 1, at = arm.at(a * x))]
        bead: Particle,
        #[frame(arm, x(a))]
        tilted: Frame,
        #[acts(on = ground, value = a * x)]
        push: Force,
    }
}

mod friction_that_pushes {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail, coulomb = -0.3, viscous = -1, speed = 0)]
        first: Friction,
        #[acts(on = rail, coulomb = 1, stiction = -2, stribeck_speed = -0.1)]
        second: Friction,
    }
}

mod law_with_a_corner {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail, force = 10 * abs(stretch))]
        spring: Spring,
        #[acts(on = rail, force = 10 * max(stretch, -100))]
        buffer: Spring,
    }
}

fn main() {}
