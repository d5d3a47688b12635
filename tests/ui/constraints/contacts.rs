//! Surfaces that cannot roll or slip as they are told to.

mod says_too_little {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = sphere(1, 1))]
        ball: Body,
        #[joint(ground -> ball)]
        pose: Free,
        #[constraint(slips(ball.sphere(1), ground.plane(z)))]
        smooth: Slipping,
        #[constraint(slips(ball.sphere(1), ground.plane(z)), mu = 0.3)]
        misnamed: Slipping,
        #[constraint(friction = 0.3)]
        nothing: Slipping,
        #[constraint(slips(ball.sphere(1), ground.plane(z)) = 0, friction = 0.3)]
        equation: Slipping,
        #[constraint(rolls(ball.sphere(1), ground.plane(z)), friction = 0.3)]
        rolling: Rolling,
    }
}

mod is_no_pair {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = cone(1, 1, 1, z))]
        body: Body,
        #[joint(ground -> body)]
        pose: Free,
        #[constraint(rolls(body.sphere(1), ground.plane(z)), friction = 0.3)]
        other_word: Slipping,
        #[constraint(slips(body, ground.plane(z)), friction = 0.3)]
        no_surface: Slipping,
        #[constraint(slips(body.sphere(1, z), ground.plane(z)), friction = 0.3)]
        too_many: Slipping,
        #[constraint(slips(body.circle(1, z), ground.bowl(3)), friction = 0.3)]
        unknown_pair: Slipping,
        #[constraint(slips(body.cone(0.5, z), ground.plane(z)), friction = 0.3)]
        along_a_line: Slipping,
        #[constraint(slips(body.sphere(pose), ground.plane(z)), friction = 0.3)]
        not_constant: Slipping,
        #[constraint(slips(body.sphere(1), ground.plane(z)), friction = -0.3, speed = 0)]
        negative: Slipping,
    }
}

mod has_other_units {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[unit(N)]
        friction: f64,
        #[unit(rad / s)]
        speed: f64,
        #[body(mass = 1, inertia = sphere(1, 1))]
        ball: Body,
        #[joint(ground -> ball)]
        pose: Free,
        #[constraint(slips(ball.sphere(1), ground.plane(z)), friction = friction, speed = speed)]
        contact: Slipping,
    }
}

mod is_held_already {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = disk(1, 1, z))]
        wheel: Body,
        #[joint(ground -> wheel, about = z)]
        axle: Pin,
        #[constraint(slips(wheel.circle(1, z), ground.at(-y).plane(y)), friction = 0.3)]
        brake: Slipping,
    }
}

mod has_independent_speeds {
    use linkwork::prelude::*;

    #[mechanism(formulation = speeds)]
    struct Machine {
        #[body(mass = 1, inertia = sphere(1, 1))]
        ball: Body,
        #[joint(ground -> ball)]
        pose: Free,
        #[constraint(slips(ball.sphere(1), ground.plane(z)), friction = 0.3)]
        contact: Slipping,
    }
}

mod is_no_surface {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        u: Coordinate,
        w: Coordinate,
        height: Coordinate,
        #[body(mass = 1, inertia = cone(1, 1, 1, z))]
        body: Body,
        #[joint(ground -> body)]
        pose: Free,
        #[constraint(rolls(body.sphere(1), ground.surface(u * x + w * y)))]
        no_coordinates: Rolling,
        #[constraint(rolls(body.sphere(1), ground.surface(u, v, u * x + w * y)))]
        unknown: Rolling,
        #[constraint(rolls(body.sphere(1), ground.surface(u, w, u * x + w * y + height * z)))]
        of_another: Rolling,
        #[constraint(rolls(body.sphere(1), ground.surface(u, w, u * x + u * y)))]
        a_line: Rolling,
        #[constraint(rolls(body.cone(0.5, z), ground.surface(u, w, u * x + w * y)))]
        under_a_cone: Rolling,
        #[constraint(rolls(body.sphere(1), ground.surface(u, w, u)))]
        no_point: Rolling,
    }
}

mod has_no_inertia {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        u: Coordinate,
        w: Coordinate,
        idle: Coordinate,
        #[body(mass = 1, inertia = sphere(1, 1))]
        ball: Body,
        #[joint(ground -> ball)]
        pose: Free,
        #[constraint(rolls(ball.sphere(1), ground.surface(u, w, u * x + w * y)))]
        contact: Rolling,
    }
}

fn main() {}
