//! Further arrangements that are no tree.

mod end_is_no_body {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(0 -> cart, along = x)]
        rail: Sleeve,
    }
}

mod fixed_particle_as_child {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[particle(mass = 1, at = arm.at(x))]
        bob: Particle,
        #[joint(arm -> bob, along = x)]
        rail: Sleeve,
    }
}

mod ground_twice {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[joint(ground -> ground)]
        base: Weld,
    }
}

mod joint_of_joints {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[body(mass = 1, com = y)]
        pole: Body,
        #[joint(rail -> pole, about = z)]
        hinge: Pin,
    }
}

mod too_many_freedoms {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = sphere(1, 1))]
        b0: Body,
        #[joint(ground -> b0)]
        j0: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b1: Body,
        #[joint(ground -> b1)]
        j1: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b2: Body,
        #[joint(ground -> b2)]
        j2: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b3: Body,
        #[joint(ground -> b3)]
        j3: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b4: Body,
        #[joint(ground -> b4)]
        j4: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b5: Body,
        #[joint(ground -> b5)]
        j5: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b6: Body,
        #[joint(ground -> b6)]
        j6: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b7: Body,
        #[joint(ground -> b7)]
        j7: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b8: Body,
        #[joint(ground -> b8)]
        j8: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b9: Body,
        #[joint(ground -> b9)]
        j9: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b10: Body,
        #[joint(ground -> b10)]
        j10: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b11: Body,
        #[joint(ground -> b11)]
        j11: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b12: Body,
        #[joint(ground -> b12)]
        j12: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b13: Body,
        #[joint(ground -> b13)]
        j13: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b14: Body,
        #[joint(ground -> b14)]
        j14: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b15: Body,
        #[joint(ground -> b15)]
        j15: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b16: Body,
        #[joint(ground -> b16)]
        j16: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b17: Body,
        #[joint(ground -> b17)]
        j17: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b18: Body,
        #[joint(ground -> b18)]
        j18: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b19: Body,
        #[joint(ground -> b19)]
        j19: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b20: Body,
        #[joint(ground -> b20)]
        j20: Free,
        #[body(mass = 1, inertia = sphere(1, 1))]
        b21: Body,
        #[joint(ground -> b21)]
        j21: Free,
    }
}

mod two_cycles {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        a: Body,
        #[body(mass = 1)]
        b: Body,
        #[body(mass = 1)]
        c: Body,
        #[body(mass = 1)]
        d: Body,
        #[joint(a -> b, along = x)]
        ab: Sleeve,
        #[joint(b -> a, along = x)]
        ba: Sleeve,
        #[joint(c -> d, along = x)]
        cd: Sleeve,
        #[joint(d -> c, along = x)]
        dc: Sleeve,
    }
}

fn main() {}
