//! Further expressions of vectors that mean nothing.

mod acceleration_without_a_frame {
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
        #[output(a(bead / ground))]
        looked: Vector,
    }
}

mod alpha_of_two {
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
        #[output(alpha(arm / ground))]
        looked: Vector,
    }
}

mod angle_of_one {
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
        #[output(angle(arm.x))]
        looked: Scalar,
    }
}

mod angle_of_scalars {
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
        #[output(angle(a, 1))]
        looked: Scalar,
    }
}

mod axes_of_a_parameter {
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
        l: f64,
        #[output(l * l.x)]
        looked: Vector,
    }
}

mod division_by_zero {
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
        #[output(a / 0)]
        looked: Scalar,
    }
}

mod division_by_zero_of_a_vector {
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
        #[output(arm.x / (1 - 1))]
        looked: Vector,
    }
}

mod dot_of_one {
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
        #[output(dot(arm.x))]
        looked: Scalar,
    }
}

mod frame_of_a_velocity {
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
        #[output(v(bead / ground / bead))]
        looked: Vector,
    }
}

mod logarithm_of_zero {
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
        #[output(ln(0) * a)]
        looked: Scalar,
    }
}

mod norm_of_a_scalar {
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
        #[output(norm(a))]
        looked: Scalar,
    }
}

mod not_slashed {
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
        #[output(v(bead, ground, ground))]
        looked: Vector,
    }
}

mod omega_of_an_expression {
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
        #[output(omega(arm.at(x) / ground))]
        looked: Vector,
    }
}

mod projection_of_scalars {
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
        #[output(project(a, arm.x))]
        looked: Vector,
    }
}

mod rate_of_a_body {
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
        #[output(rate(arm))]
        looked: Scalar,
    }
}

mod rate_of_a_parameter {
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
        l: f64,
        #[output(l * rate(l))]
        looked: Scalar,
    }
}

mod root_of_a_negative {
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
        #[output(sqrt(-2) * a)]
        looked: Scalar,
    }
}

mod slash_of_a_joint {
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
        #[output(r(pin / ground))]
        looked: Vector,
    }
}

mod slip_in_a_point {
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
        #[output(r(beat / ground))]
        looked: Vector,
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
        #[output(omega(tilde / ground))]
        looked: Vector,
    }
}

mod too_many_parts {
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
        #[output(r(bead / ground / ground))]
        looked: Vector,
    }
}

mod unit_of_zero {
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
        #[output(unit(arm.x - arm.x))]
        looked: Vector,
    }
}

fn main() {}
