//! Functions that only call a generated one, so that the machine code of each generated function can be
//! inspected separately. The mechanisms are declared here instead of in `linkwork-models`, since all code
//! that a function calls must be in the assembly of this package.
#![forbid(unsafe_code)]

use linkwork::prelude::*;

/// Panda robot arm of Franka Emika without its fingers: seven revolute joints in series.
#[mechanism(
    urdf = "../../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"], derivatives,
    packed
)]
pub struct Panda;

/// Solo 12 quadruped: free base with four identical legs of three joints each.
#[mechanism(urdf = "../../models/urdf/solo12.urdf", base = free, derivatives, packed)]
pub struct Solo12;

/// Humanoid robot with 35 velocities: a free base and 29 joints.
#[mechanism(urdf = "../../models/urdf/simple_humanoid.urdf", base = free, derivatives, packed)]
pub struct Humanoid;

/// Cart with a pole and parameters. Its functions are too small for a selection of instructions at run time.
#[mechanism(gravity = -9.81 * y, derivatives, packed)]
pub struct CartPole {
    /// Mass of the cart, kg.
    pub cart_mass: f64,
    /// Mass of the pole, kg.
    pub pole_mass: f64,
    /// Length of the pole, m.
    pub pole_length: f64,
    #[body(mass = cart_mass)]
    cart: Body,
    #[body(mass = pole_mass, com = pole_length / 2 * y, inertia = rod(pole_mass, pole_length, y))]
    pole: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    hinge: Pin,
    #[acts(on = cart, along = x)]
    push: Force,
}

/// Slider-crank: crank, rod and piston, which form a closed loop.
#[mechanism(gravity = -9.81 * y)]
pub struct SliderCrank {
    /// Radius of the crank, m.
    pub r: f64,
    /// Length of the rod, m.
    pub l: f64,
    #[body(mass = 0.5, com = r / 2 * x, inertia = rod(0.5, r, x))]
    crank: Body,
    #[body(mass = 0.5, com = l / 2 * x, inertia = rod(0.5, l, x))]
    rod: Body,
    #[body(mass = 0.5)]
    piston: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(r * x) -> rod, about = z)]
    big_end: Pin,
    #[joint(ground -> piston, along = x)]
    cylinder: Sleeve,
    #[joint(rod.at(l * x) -> piston, about = z)]
    small_end: Pin,
    #[acts(on = main)]
    motor: Torque,
}

/// Declares a function that calls the generated function of the same name, with its arguments and its result.
macro_rules! call {
    ($type:ident, $function:ident($($argument:ident),+) -> $result:ty) => {
        #[doc = concat!("`", stringify!($type), "::", stringify!($function), "`.")]
        #[inline(never)]
        pub fn $function(mechanism: &$type, $($argument: &vector!($type, $argument)),+) -> $result {
            mechanism.$function($($argument),+)
        }
    };
}

/// Declares a function that calls the generated function of the same name, which writes its results to
/// matrices.
macro_rules! call_into {
    ($type:ident, $function:ident($($argument:ident),+; $($matrix:ident),+)) => {
        #[doc = concat!("`", stringify!($type), "::", stringify!($function), "`.")]
        #[inline(never)]
        pub fn $function(
            mechanism: &$type,
            $($argument: &vector!($type, $argument)),+,
            $($matrix: &mut SMatrix<f64, { $type::NV }, { $type::NV }>),+
        ) {
            mechanism.$function($($argument),+, $($matrix),+);
        }
    };
}

/// Expands to the vector type of the argument with this name.
macro_rules! vector {
    ($type:ident, q) => {
        SVector<f64, { $type::NQ }>
    };
    ($type:ident, $argument:ident) => {
        SVector<f64, { $type::NV }>
    };
}

/// Declares the functions of a mechanism in a module of this name.
macro_rules! functions {
    ($module:ident, $type:ident) => {
        #[doc = concat!("[`", stringify!($type), "`].")]
        pub mod $module {
            use super::*;

            type Vector = SVector<f64, { $type::NV }>;
            type Matrix = SMatrix<f64, { $type::NV }, { $type::NV }>;

            call!($type, mass_matrix(q) -> Matrix);
            call!($type, bias_forces(q, v) -> Vector);
            call!($type, inverse_dynamics(q, v, a) -> Vector);
            call!($type, forward_dynamics(q, v, tau) -> Vector);
            call!($type, kinetic_energy(q, v) -> f64);
            call!($type, inverse_dynamics_derivatives(q, v, a) -> (Matrix, Matrix));
            call!($type, forward_dynamics_derivatives(q, v, tau) -> (Matrix, Matrix, Matrix));
            call_into!($type, mass_matrix_into(q; m));
            call_into!($type, inverse_dynamics_derivatives_into(q, v, a; by_q, by_v));
            call_into!($type, forward_dynamics_derivatives_into(q, v, tau; by_q, by_v, inverse));
        }
    };
}

functions!(cart_pole, CartPole);
functions!(panda, Panda);
functions!(solo12, Solo12);
functions!(humanoid, Humanoid);

/// Functions that call the generated functions of [`SliderCrank`].
pub mod slider_crank {
    use super::*;

    type Vector = SVector<f64, { SliderCrank::NV }>;
    type Multipliers = SVector<f64, { SliderCrank::NC }>;

    call!(SliderCrank, constrained_dynamics(q, v, tau) -> (Vector, Multipliers));
    call!(SliderCrank, constraint_bias(q, v) -> Multipliers);
}
