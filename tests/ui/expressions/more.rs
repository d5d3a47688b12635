//! Further expressions that have no value.

mod array_of_two {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = [0, l])]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod block {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = { m })]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod body_as_value {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = arm * y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod cast {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m as f64)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod comparison {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m == 2)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod condition {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = if m { 1 } else { 2 })]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod cross_of_scalars {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = cross(l, x))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod division_by_nothing {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m / (2 - 2))]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod exclamation {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = !m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod implicit_product {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = 2 m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod integer_suffix {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m * 1u32)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod joint_as_value {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = hinge * y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod length_of_scalar {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = norm(l) * y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod logarithm_of_zero {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m * ln(0))]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod long_sum {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m + m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod macro_call {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = vec![m])]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod many_signs {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = ------------------------------------------------------------m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod method {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m.sqrt())]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod one_argument_for_two {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = atan2(l) * y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod own_field {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = self.m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod path {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = std::f64::consts::PI * m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod plus_sign {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = +m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod power {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m ^ 2)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod power_of_python {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m ** 2)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod product_too_large {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = 1e200 * 1e200 * m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod reference {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = &m)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod relative_velocity {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = v(arm / ground))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod remainder {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m % 2)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod root_of_a_negative_number {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m * sqrt(-1))]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod scalar_minus_vector {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = l * y - 1)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod sine_of_a_vector {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = sin(l * x) * y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod text {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m * "1")]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod time {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        #[body(mass = 1, com = sin(t) * y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod tuple {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = (0, l, 0))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod two_arguments_for_one {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = sin(l, l) * y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod unit_suffix {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        m: f64,
        #[body(mass = m * 1kg)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
    }
}

mod vector_by_vector {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = l * x / y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod vector_component {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = (l * y).y * y)]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

mod vectors_in_array {
    use linkwork::prelude::*;

    #[mechanism]
    struct Machine {
        l: f64,
        #[body(mass = 1, com = [l * x, l * y, l * z])]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
    }
}

fn main() {}
