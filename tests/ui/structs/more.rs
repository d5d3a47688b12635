//! Further items that are no mechanism.

mod array_of_numbers {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        masses: [f64; 2],
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod constant_parameter {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine<const N: usize> {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod generic_element {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        tool: Body<f64>,
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod implementation {
    use linkwork::prelude::*;

    struct Machine;

    #[mechanism]
    impl Machine {}
}

mod integer {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        mass: i32,
        #[body(mass = mass)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod nothing {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine;
}

mod reference {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        mass: &f64,
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod scalar_option {
    use linkwork::prelude::*;

    #[mechanism(scalar = f32)]
    struct Machine {
        mass: f64,
        #[body(mass = mass)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod text {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        name: String,
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod tuple_field {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        masses: (f64, f64),
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod union {
    use linkwork::prelude::*;

    #[mechanism]
    union Machine {
        a: f64,
        b: f64,
    }
}

mod unknown_scalar {
    use linkwork::prelude::*;

    #[mechanism(scalar = f16)]
    struct Machine {
        #[body(mass = 1)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

fn main() {}
