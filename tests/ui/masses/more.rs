//! Further masses and inertias that no body has.

mod axis_first {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = rod(z, 1, 2))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod difference {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = sphere(2, 1) - sphere(1, 1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod figures_too_large {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1e200, com = 1e200 * x)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod flat_matrix {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = [1, 1, 1])]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod inertia_without_effect {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = rod(1, 1, z))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod negative_entry {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = diagonal(1, 1, -1))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod negative_size {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = sphere(1, -2))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod no_mass_at_all {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod not_square {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = [[1, 0], [0, 1]])]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod parameter_as_inertia {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        i: f64,
        #[body(mass = 1, inertia = i)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod particle_in_the_air {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[particle(mass = 1, at = -y)]
        bob: Particle,
    }
}

mod particle_on_a_ball {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[particle(mass = 1)]
        bob: Particle,
        #[joint(ground -> bob)]
        pose: Free,
    }
}

mod rotated_by_name {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = rod(1, 1, x).rotate(z(1)))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod scalar_com {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = 0.5)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod scalar_inertia {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = 2)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod two_free_arms {
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
}

mod vector_mass {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = x, com = y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod weightless_particle {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[particle(mass = 0, at = arm.at(-y))]
        bob: Particle,
    }
}

fn main() {}
