//! Loops that are not solved in closed form.

mod unknown_branch {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        crank: Body,
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        rod: Body,
        #[body(mass = 1)]
        piston: Body,
        #[joint(ground -> crank, about = z)]
        main: Pin,
        #[joint(crank.at(x) -> rod, about = z)]
        big_end: Pin,
        #[joint(ground -> piston, along = x)]
        cylinder: Sleeve,
        #[joint(rod.at(2 * x) -> piston, about = z, branch = 2)]
        small_end: Pin,
    }
}

mod closes_nothing {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        crank: Body,
        #[joint(ground -> crank, about = z, branch = 1)]
        main: Pin,
    }
}

mod not_in_a_plane {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        crank: Body,
        #[body(mass = 1, com = x, inertia = rod(1, 1, x))]
        rod: Body,
        #[body(mass = 1)]
        piston: Body,
        #[joint(ground -> crank, about = z)]
        main: Pin,
        #[joint(crank.at(x) -> rod, about = z)]
        big_end: Pin,
        #[joint(ground -> piston, along = z)]
        cylinder: Sleeve,
        #[joint(rod.at(2 * x) -> piston, about = z, branch = 1)]
        small_end: Pin,
    }
}

mod another_joint {
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
        #[joint(rod.at(2 * x) -> ground, along = x, about = z, branch = 1)]
        small_end: Slot,
    }
}

fn main() {}
