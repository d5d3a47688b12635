//! Mechanisms written by macros of the user's.

use linkwork::mechanism;

/// An expression that a macro of the user's hands on keeps its parentheses, though they are not written.
#[test]
fn expressions_of_macros_stay_together() {
    macro_rules! pendulum {
        ($name:ident, $length:expr) => {
            #[mechanism(gravity = -9.81 * y)]
            struct $name {
                #[body(mass = 1, com = -2 * $length * y)]
                rod: Body,
                #[joint(ground -> rod, about = z)]
                pin: Pin,
            }
        };
    }
    pendulum!(Rod, 0.25 + 0.5);
    assert_eq!(Rod {}.mass_matrix(&Rod {}.neutral())[0], 1.5 * 1.5);
}
