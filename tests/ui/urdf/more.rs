//! Further files and options that are refused.

mod choice_as_text {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/arm.urdf", mimic = "follow")]
    struct Robot;
}

mod entity_bomb {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/entity_bomb.urdf")]
    struct Robot;
}

mod infinite {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/infinite.urdf")]
    struct Robot;
}

mod lock_without_brackets {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/arm.urdf", lock = "elbow")]
    struct Robot;
}

mod massless_arm {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/massless_arm.urdf")]
    struct Robot;
}

mod massless_hand {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/massless_hand.urdf", base = free)]
    struct Robot;
}

mod name_of_a_link {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/arm.urdf")]
    struct Robot {
        #[body(mass = 1)]
        upper: Body,
        #[joint(lower -> upper)]
        flange: Weld,
    }
}

mod names_used_twice {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/names_used_twice.urdf")]
    struct Robot;
}

mod rounded_too_far {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/arm.urdf", snap = 0.5)]
    struct Robot;
}

mod negative_mass {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/negative_mass.urdf")]
    struct Robot;
}

mod nested {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/nested.urdf")]
    struct Robot;
}

mod not_a_number {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/not_a_number.urdf")]
    struct Robot;
}

mod other_format {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/other_format.urdf")]
    struct Robot;
}

mod path_without_quotes {
    use linkwork::prelude::*;

    #[mechanism(urdf = arm.urdf)]
    struct Robot;
}

mod slip_beside_a_file {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/arm.urdf")]
    struct Robot {
        #[acts(on = elbo, damping = 1)]
        friction: Dashpot,
    }
}

mod template {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/template.urdf")]
    struct Robot;
}

mod two_roots {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/two_roots.urdf")]
    struct Robot;
}

mod unknown_choice {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/arm.urdf", base = floating)]
    struct Robot;
}

mod unknown_joint_type {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/unknown_joint_type.urdf")]
    struct Robot;
}

mod unknown_option {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/arm.urdf", fix = ["elbow"])]
    struct Robot;
}

mod unknown_parent {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/unknown_parent.urdf")]
    struct Robot;
}

mod unused_parameter {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/arm.urdf")]
    struct Robot {
        mass: f64,
    }
}

fn main() {}
