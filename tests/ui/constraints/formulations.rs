//! Formulations that do not fit.

mod nothing_to_choose {
    use linkwork::prelude::*;

    #[mechanism(formulation = speeds)]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod too_many_speeds {
    use linkwork::prelude::*;

    #[mechanism(independent = (skate.x, skate.y, skate.angle))]
    struct Machine {
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        sled: Body,
        #[joint(ground -> sled, about = z)]
        skate: Planar,
        #[constraint(dot(v(sled / ground / ground), sled.y) = 0)]
        knife: Nonholonomic,
    }
}

mod unknown_speed {
    use linkwork::prelude::*;

    #[mechanism(independent = (skate.x, skat.angle))]
    struct Machine {
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        sled: Body,
        #[joint(ground -> sled, about = z)]
        skate: Planar,
        #[constraint(dot(v(sled / ground / ground), sled.y) = 0)]
        knife: Nonholonomic,
    }
}

mod dependent_speeds {
    use linkwork::prelude::*;

    #[mechanism(independent = (small, large))]
    struct Machine {
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        pinion: Body,
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        wheel: Body,
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> pinion, about = z)]
        small: Pin,
        #[joint(ground -> wheel, about = z)]
        large: Pin,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[constraint(small = -3 * large)]
        mesh: Holonomic,
    }
}

mod contradiction {
    use linkwork::prelude::*;

    #[mechanism(formulation = multipliers, independent = skate.x)]
    struct Machine {
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        sled: Body,
        #[joint(ground -> sled, about = z)]
        skate: Planar,
        #[constraint(dot(v(sled / ground / ground), sled.y) = 0)]
        knife: Nonholonomic,
    }
}

mod reactions {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[output(reaction_force(rial))]
        unknown: Vector,
        #[output(reaction_force(rail, cart))]
        two: Vector,
        #[acts(on = cart, value = reaction_force(rail))]
        friction: Force,
    }
}

fn main() {}
