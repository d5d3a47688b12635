//! Functions that do nothing but call a generated one, so that the machine code of each can be looked at by
//! itself. The mechanisms are declared here and not taken from `linkwork-models`, where a part of their code
//! would be compiled: all that a function calls must be in the assembly of this package.
#![forbid(unsafe_code)]

use linkwork::prelude::*;

/// The Panda of Franka Emika without its fingers: seven axes, all in a row.
#[mechanism(urdf = "../../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"], derivatives, packed)]
pub struct Panda;

/// Solo 12: a free body with four alike legs.
#[mechanism(urdf = "../../models/urdf/solo12.urdf", base = free, derivatives, packed)]
pub struct Solo12;

/// A humanoid with 35 velocities.
#[mechanism(urdf = "../../models/urdf/simple_humanoid.urdf", base = free, derivatives, packed)]
pub struct Humanoid;

/// A cart with a pole, with parameters: its functions are too small to choose their instructions.
#[mechanism(gravity = -9.81 * y, derivatives, packed)]
pub struct CartPole {
    /// Mass of the cart.
    pub cart_mass: f64,
    /// Mass of the pole.
    pub pole_mass: f64,
    /// Length of the pole.
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

/// A crank, a rod and a piston: a loop.
#[mechanism(gravity = -9.81 * y)]
pub struct SliderCrank {
    /// Radius of the crank.
    pub r: f64,
    /// Length of the rod.
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

/// A function that calls the one of the same name: its arguments and its result.
macro_rules! call {
    ($type:ident, $function:ident($($argument:ident),+) -> $result:ty) => {
        #[doc = concat!("`", stringify!($type), "::", stringify!($function), "`.")]
        #[inline(never)]
        pub fn $function(mechanism: &$type, $($argument: &vector!($type, $argument)),+) -> $result {
            mechanism.$function($($argument),+)
        }
    };
}

/// The same for a function whose results go into matrices.
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

/// The type of an argument.
macro_rules! vector {
    ($type:ident, q) => {
        SVector<f64, { $type::NQ }>
    };
    ($type:ident, $argument:ident) => {
        SVector<f64, { $type::NV }>
    };
}

/// The functions of a mechanism, in a module of this name.
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

/// [`SliderCrank`].
pub mod slider_crank {
    use super::*;

    type Vector = SVector<f64, { SliderCrank::NV }>;
    type Multipliers = SVector<f64, { SliderCrank::NC }>;

    call!(SliderCrank, constrained_dynamics(q, v, tau) -> (Vector, Multipliers));
    call!(SliderCrank, constraint_bias(q, v) -> Multipliers);
}
