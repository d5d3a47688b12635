//! Further things that have no place.

mod coordinate_in_gravity_mass {
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
        #[particle(mass = 1 + a, at = arm.at(x))]
        other: Particle,
    }
}

mod coordinate_in_a_joint {
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
        #[body(mass = 1, inertia = diagonal(1, 1, 1))]
        other: Body,
        #[joint(arm.at(a * x) -> other, about = z)]
        hinge: Pin,
    }
}

mod coordinate_that_moves_nothing {
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
        b: Coordinate,
    }
}

mod coordinate_with_an_attribute {
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
        #[point(at = x)]
        b: Coordinate,
    }
}

mod frame_at_itself {
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
        #[frame(round, x(a))]
        round: Frame,
    }
}

mod frame_of_a_point {
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
        #[frame(bead, x(a))]
        round: Frame,
    }
}

mod frame_of_nothing {
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
        #[frame()]
        round: Frame,
    }
}

mod frame_turned_by_a_vector {
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
        #[frame(arm, x(arm.y))]
        round: Frame,
    }
}

mod input_in_a_place {
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
        push: Input,
        #[point(at = push * x)]
        hook: Point,
    }
}

mod parameter_called_t {
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
        t: f64,
        #[point(at = t * x)]
        hook: Point,
    }
}

mod place_that_is_a_scalar {
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
        #[point(at = a)]
        hook: Point,
    }
}

mod point_in_a_frame {
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
        #[point(on = tilted, at = x)]
        hook: Point,
    }
}

mod point_nowhere {
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
        #[point()]
        hook: Point,
    }
}

mod slip_in_a_frame {
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
        #[frame(art, x(a))]
        round: Frame,
    }
}

mod slip_in_a_particle {
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
        #[particle(mass = 1, at = beat.at(x))]
        other: Particle,
    }
}

mod definition_of_a_vector {
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
        #[define(a * x)]
        wide: Scalar,
        #[output(wide)]
        looked: Scalar,
    }
}

mod definition_of_a_scalar {
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
        #[define(2 * a)]
        wide: Vector,
        #[output(wide)]
        looked: Vector,
    }
}

mod definition_of_nothing {
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
        #[define()]
        wide: Scalar,
    }
}

mod definition_of_two {
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
        #[define(a, a)]
        wide: Scalar,
    }
}

mod unused_definition {
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
        #[define(2 * b)]
        wide: Scalar,
    }
}

fn main() {}
