//! Constraints that cannot be, or say nothing.

mod closes_nothing {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[joint(ground -> cart)]
        again: Free,
    }
}

mod never_closes {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        crank: Body,
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        rod: Body,
        #[joint(ground -> crank, about = z)]
        main: Pin,
        #[joint(crank.at(x) -> rod, about = z)]
        big_end: Pin,
        #[joint(rod.at(x) -> ground.at(x + 0.1 * z), about = z)]
        closing: Pin,
    }
}

mod too_long {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        crank: Body,
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        rod: Body,
        #[joint(ground -> crank, about = z)]
        main: Pin,
        #[joint(crank.at(x) -> rod, about = z)]
        big_end: Pin,
        #[joint(ground -> rod.at(x), along = x)]
        locked: Sleeve,
        #[joint(rod.at(x) -> ground.at(3 * x), about = z)]
        closing: Pin,
    }
}

mod immobile {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        crank: Body,
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        rod: Body,
        #[joint(ground -> crank, about = z)]
        main: Pin,
        #[joint(crank.at(x) -> rod, about = z)]
        big_end: Pin,
        #[joint(rod.at(x) -> ground.at(1.5 * x), about = z)]
        closing: Pin,
    }
}

mod says_nothing {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[constraint]
        nothing: Holonomic,
        #[constraint(2 = 3)]
        numbers: Holonomic,
        #[constraint(rail = 1)]
        position: Nonholonomic,
        #[constraint(rate(rail) = 1)]
        speed: Holonomic,
    }
}

mod not_linear {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = (x, y))]
        table: Stage,
        #[constraint(rate(table.x) * rate(table.x) + rate(table.y) * rate(table.y) = 1)]
        speed: Nonholonomic,
    }
}

mod no_rolling_pair {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = disk(1, 1, y))]
        disk: Body,
        #[joint(ground -> disk)]
        pose: Free,
        #[constraint(disk.circle(1, y))]
        alone: Rolling,
        #[constraint(rolls(disk.circle(1, y), ground))]
        no_surface: Rolling,
        #[constraint(rolls(disk.cirle(1, y), ground.plane(z)))]
        misspelt: Rolling,
        #[constraint(rolls(disk.circle(1), ground.plane(z)))]
        no_axis: Rolling,
        #[constraint(rolls(disk.circle(1, y), ground.cylinder(1, x)))]
        unknown_pair: Rolling,
        #[constraint(rolls(disk.sphere(-1), ground.plane(z)))]
        negative: Rolling,
        #[constraint(rolls(ground.sphere(1), ground.plane(z)))]
        both_still: Rolling,
    }
}

mod rolling_is_no_equation {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = disk(1, 1, y))]
        disk: Body,
        #[joint(ground -> disk)]
        pose: Free,
        #[constraint(rolls(disk.circle(1, y), ground.plane(z)) = 0)]
        equation: Rolling,
    }
}

mod cones {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = cone(1, 1, 1, z))]
        cone: Body,
        #[joint(ground -> cone)]
        pose: Free,
        #[constraint(rolls(cone.cone(30, z), ground.plane(z)))]
        degrees: Rolling,
        #[constraint(rolls(cone.cone(z), ground.plane(z)))]
        no_angle: Rolling,
        #[constraint(rolls(cone.cone(0.6, z), ground.funnel(0.4, z)))]
        too_wide: Rolling,
        #[constraint(rolls(cone.cone(0.5, z), ground.cylinder(1, z)))]
        on_a_cylinder: Rolling,
        #[constraint(rolls(cone.funnel(0.5, z), ground.plane(z)))]
        funnel_on_a_plane: Rolling,
    }
}

mod units_of_surfaces {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[unit(m)]
        angle: f64,
        #[unit(rad)]
        radius: f64,
        #[body(mass = 1, inertia = cone(1, 1, 1, z))]
        cone: Body,
        #[joint(ground -> cone)]
        pose: Free,
        #[constraint(rolls(cone.cone(angle, z), ground.plane(z)))]
        wide: Rolling,
        #[constraint(rolls(cone.sphere(radius), ground.plane(z)))]
        round: Rolling,
    }
}

mod off_the_plane {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = disk(1, 1, y))]
        disk: Body,
        #[joint(ground -> disk, along = (x, y))]
        pose: Stage,
        #[constraint(rolls(disk.circle(1, y), ground.plane(z)))]
        contact: Rolling,
    }
}

fn main() {}
