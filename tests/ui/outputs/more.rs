//! Further outputs that cannot be looked at.

mod frame_function {
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
        #[output(a)]
        frame_velocity: Scalar,
    }
}

mod jacobian_of_frames {
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
        #[output(a)]
        frame: Scalar,
    }
}

mod nothing {
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
        #[output()]
        looked: Scalar,
    }
}

mod resolved_in_of_a_scalar {
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
        #[output(a, resolved_in = arm)]
        looked: Scalar,
    }
}

mod scalar_of_a_vector {
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
        #[output(arm.x)]
        looked: Scalar,
    }
}

mod two_attributes {
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
        #[output(a)]
        #[define(a)]
        looked: Scalar,
    }
}

mod unknown_key {
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
        #[output(a, axes = arm)]
        looked: Scalar,
    }
}

mod vector_of_a_scalar {
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
        #[output(a)]
        looked: Vector,
    }
}

fn main() {}
