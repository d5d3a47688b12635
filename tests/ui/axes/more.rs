//! Further axes and placements that are none.

mod axes_of_another {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x + y + z)]
        arm: Body,
        #[joint(ground -> arm, about = ground.z)]
        hinge: Pin,
    }
}

mod capital {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x + y + z)]
        arm: Body,
        #[joint(ground -> arm, about = Z)]
        hinge: Pin,
    }
}

mod no_rotation {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = y)]
        arm: Body,
        #[joint(ground.rotated(pi / 2) -> arm, about = z)]
        hinge: Pin,
    }
}

mod not_unit_array {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x + y + z)]
        arm: Body,
        #[joint(ground -> arm, about = [0, 0, 2])]
        hinge: Pin,
    }
}

mod place_after_rotation {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = y)]
        arm: Body,
        #[joint(ground.rotated(z(1)).at(x) -> arm, about = z)]
        hinge: Pin,
    }
}

mod place_of_numbers {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = y)]
        arm: Body,
        #[joint(ground.at(0, 1, 0) -> arm, about = z)]
        hinge: Pin,
    }
}

mod planar_normal {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x, inertia = sphere(1, 1))]
        block: Body,
        #[joint(ground -> block, along = (x, y), about = y)]
        table: Planar,
    }
}

mod planar_not_orthogonal {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x, inertia = sphere(1, 1))]
        block: Body,
        #[joint(ground -> block, along = (x, unit(x + y)))]
        table: Planar,
    }
}

mod quoted {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x + y + z)]
        arm: Body,
        #[joint(ground -> arm, about = "z")]
        hinge: Pin,
    }
}

mod reflection {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = y)]
        arm: Body,
        #[joint(ground.rotated([[1, 0, 0], [0, 1, 0], [0, 0, -1]]) -> arm, about = z)]
        hinge: Pin,
    }
}

mod rotation_of_nothing {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = y)]
        arm: Body,
        #[joint(ground.rotated() -> arm, about = z)]
        hinge: Pin,
    }
}

mod scalar {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x + y + z)]
        arm: Body,
        #[joint(ground -> arm, about = 1)]
        hinge: Pin,
    }
}

mod stage_of_parallel_axes {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1)]
        block: Body,
        #[joint(ground -> block, along = (x, x))]
        table: Stage,
    }
}

mod two_numbers {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x + y + z)]
        arm: Body,
        #[joint(ground -> arm, about = [0, 1])]
        hinge: Pin,
    }
}

mod unit_of_zero {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x + y + z)]
        arm: Body,
        #[joint(ground -> arm, about = unit(x - x))]
        hinge: Pin,
    }
}

mod universal_of_parallel_axes {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, inertia = sphere(1, 1))]
        block: Body,
        #[joint(ground -> block, about = (x, -x))]
        cross: Universal,
    }
}

mod zero_by_parameter {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        n: f64,
        #[body(mass = 1, com = x + y + z)]
        arm: Body,
        #[joint(ground -> arm, about = n * z - n * z)]
        hinge: Pin,
    }
}

mod zero_number {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = x + y + z)]
        arm: Body,
        #[joint(ground -> arm, about = 0)]
        hinge: Pin,
    }
}

fn main() {}
