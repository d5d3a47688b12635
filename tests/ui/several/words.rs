//! Terms of other tools, and the tokens that the messages point at.

mod degrees {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(ground.rotated(z(90)) -> arm, about = z)]
        hinge: Pin,
    }
}

mod ends {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        #[body(mass = 1, com = -y)]
        arm: Body,
        #[joint(parent = ground, child = arm, about = z)]
        hinge: Pin,
    }
}

mod figures {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        #[body(mass = 1e308, com = -y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod no_comma {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y)]
    struct Machine {
        #[body(mass = 1 com = -y)]
        arm: Body,
        #[joint(ground --> arm, about = z)]
        hinge: Pin,
    }
}

mod no_file {
    use linkwork::prelude::*;

    #[mechanism(urdf = "urdf/slip.urdf")]
    struct Robot;

    fn placements(robot: &Robot) {
        let q = robot.neutral();
        let _ = robot.frame_placement(frame!(Robot, "hand"), &q);
        let _ = robot.frame_jacobian(frame!(Robot, "elbow"), &q);
    }
}

mod two_things {
    use linkwork::prelude::*;

    #[mechanism(gravity = -9.81 * y, derivatives = true)]
    struct Machine {
        l: f64,
        #[body(mass = l, com = -l * y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[acts(on = (ground, arm), stiffness = 1)]
        coil: Spring,
    }
}

fn main() {}
