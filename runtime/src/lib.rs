#![cfg_attr(not(feature = "std"), no_std)]
#![cfg_attr(docsrs, feature(doc_cfg))]
//! Linkwork compiles mechanisms. Annotate a struct with bodies, joints, springs and inputs, or name a URDF,
//! MJCF or SDF file: an attribute macro checks the mechanism, derives its equations of motion, and generates
//! functions for them, specialised for this one mechanism. They do not allocate, do not panic in release
//! builds, and need no standard library.
//!
//! The example declares a pendulum, computes the torque that holds it, and simulates its motion:
//!
//! ```
//! use linkwork::prelude::*;
//!
//! /// A rod on a hinge, with a motor.
//! #[mechanism(gravity = -9.81 * y)]
//! pub struct Pendulum {
//!     pub mass: f64,
//!     pub length: f64,
//!
//!     #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
//!     rod: Body,
//!     #[joint(ground -> rod, about = z)]
//!     hinge: Pin,
//!     #[acts(on = hinge)]
//!     motor: Torque,
//! }
//!
//! fn main() -> Result<(), Error> {
//!     let pendulum = Pendulum { mass: 2.0, length: 1.5 };
//!
//!     // Static torque in the horizontal position: weight times half the length.
//!     let (q, rest) = ([std::f64::consts::FRAC_PI_2].into(), [0.0].into());
//!     let tau = pendulum.inverse_dynamics(&q, &rest, &rest);
//!     assert!((tau[0] - 2.0 * 9.81 * 0.75).abs() < 1e-12);
//!
//!     // Released there, the pendulum swings until its velocity is zero again: on the other side,
//!     // at the same height.
//!     let run = simulate(&pendulum).from(q, rest);
//!     let end = run.until_crossing(Crossing::Rising, |_t, _q, v| v[0]).finish()?;
//!     assert!((end.q[0] + std::f64::consts::FRAC_PI_2).abs() < 1e-6);
//!     println!("{:.3} s", end.t);
//!     Ok(())
//! }
//! ```
//!
//! # Further reading
//!
//! The [guide](guide/index.html) has a chapter for each subject:
//!
//! - [first mechanism](guide/first_mechanism/index.html): a pendulum and a controlled cart-pole;
//! - [recipes](guide/recipes/index.html): short answers to frequent questions;
//! - [language](guide/language/index.html): all declarations of a mechanism's struct;
//! - [robots](guide/robots/index.html) from URDF, MJCF and SDF files;
//! - [constraints](guide/constraints/index.html): closed loops, gears, rolling and sliding;
//! - [contact](guide/contact/index.html): impacts, friction, joint stops;
//! - [functions](guide/functions/index.html) that are generated, and printed equations;
//! - [simulating](guide/simulating/index.html): integrators, inputs, events;
//! - [drives](guide/drives/index.html): motors, gears, series springs, delays, controllers, muscles;
//! - [control](guide/control/index.html): regulators, estimators, optimal control;
//! - [batches](guide/batches/index.html): many states at once;
//! - [live pages](guide/live/index.html): simulation in a browser;
//! - [without std](guide/without_std/index.html): microcontrollers;
//! - [Python](guide/python/index.html): mechanisms as classes of Python;
//! - [speed](guide/speed/index.html): release and debug builds, accuracy, stack;
//! - [from other tools](guide/from_other_tools/index.html): names in SymPy, Pinocchio, MuJoCo and Drake;
//! - [glossary](guide/glossary/index.html): terms and symbols.
//!
//! The main items of the crate:
//!
//! - [`prelude`]: all items that a program with a mechanism needs, in one import.
//! - [`mechanism`](macro@mechanism): the attribute and its arguments.
//! - [`elements`]: bodies, joints and forces, the types of a mechanism's fields.
//! - [`Mechanism`]: functions of every mechanism; [`Constrained`]: additional functions of mechanisms with
//!   constraints.
//! - [`Derivatives`]: first derivatives for generic code; [`discrete`]: single steps and their Jacobians, for
//!   estimators and optimal control.
//! - [`inverse_kinematics`]: configurations that reach target poses of frames; [`optimal`]: the recursion of
//!   optimal control.
//! - [`simulate()`]: motion over time; [`integrate`]: the integrators.
//! - [`identification`]: mass properties of a robot from identified base parameters.
//! - [`batch`]: many states of a mechanism at once, in [`Lanes`].
//! - [`rotation`]: Euler angles, quaternions and other parameters of rotations.
//!
//! # Features
//!
//! - `std` (default): elementary functions of the standard library. Release builds for x86-64 compile large
//!   functions also for AVX2 and FMA, and choose at run time ([speed](guide/speed/index.html)).
//! - `libm`: elementary functions of the crate `libm`, for targets without the standard library.
//! - `reproducible`: results of the whole program have the same bits on every machine
//!   ([speed](guide/speed/index.html)).
//! - `serde`: serialisation of `Inertial` and `Placement`, the fields of robots whose file values are
//!   parameters.
//! - `rayon`: rollouts of many states on all processors.

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!("linkwork needs one of its features `std` and `libm` for the elementary functions");

#[allow(unused_extern_crates, reason = "generated code names this crate, also in its own tests")]
extern crate self as linkwork;
#[cfg(test)]
extern crate std;

#[doc(inline)]
pub use batch::Batch;
#[doc(inline)]
pub use constraint::{Constrained, ConstrainedDerivatives, ConstrainedSecondDerivatives, ConstraintError};
pub use contact::Contacts;
pub use derivatives::{ByMotion, Derivatives, LinearMotion};
#[doc(inline)]
pub use drawing::Drawn;
pub use first_order::{Extended, FirstOrder, FirstOrderDerivatives, OutputsByStates, RateDerivatives};
pub use frame::{FrameIndex, FrameName, Frames, NamedFrame, index_of, placement_difference};
pub use inertial::{Inertial, Placement};
pub use instant::{At, at};
#[doc(inline)]
pub use lanes::Lanes;
pub use limits::Limits;
#[cfg(not(linkwork_expanded))]
pub use linkwork_macros::mechanism;
pub use mechanism::{Mechanism, Real, Scleronomic};
pub use nalgebra;
pub use outputs::{OutputDerivatives, OutputJacobians, Outputs};
pub use parameters::{Fault, ParameterError};
pub use second::{InputSecondOrder, SecondDerivatives, SecondOrder};
pub use sensitivities::Sensitivities;
#[doc(inline)]
pub use simulate::simulate;
pub use table::{Table, TableError};

#[doc(hidden)]
pub mod absent;
mod arithmetic;
mod atmosphere;
pub mod batch;
mod blocks;
mod chains;
pub mod constraint;
pub mod contact;
mod derivatives;
pub mod discrete;
pub mod drawing;
pub mod elements;
mod first_order;
mod forward;
mod frame;
pub mod free_body;
#[cfg(any(doc, doctest))]
pub mod guide;
pub mod identification;
mod inertial;
mod instant;
pub mod integrate;
pub mod inverse_kinematics;
pub mod lanes;
mod lie;
mod limits;
mod mechanism;
mod multiplication;
pub mod optimal;
mod outputs;
mod parameters;
mod private;
pub mod rotation;
mod second;
mod sensitivities;
pub mod simulate;
mod speeds;
mod table;
mod trigonometry;

/// Prelude of all items that a program with a mechanism needs: `use linkwork::prelude::*;`.
///
/// Local names and explicitly imported names take precedence over the prelude: a program may define an
/// `Error`, a `Sample` or a `Body` itself, or `use std::error::Error;`. [`mechanism`](macro@mechanism)
/// recognises elements whether they are imported or not. Elements that nalgebra defines as well, `Point`,
/// `Scalar` and `Vector`, are not in the prelude, so that `use linkwork::nalgebra::*;` can be used together
/// with it.
pub mod prelude {
    pub use crate::elements::{
        Body, Contact, Coordinate, Equilibrium, Frame, FreeBody, Holonomic, Limit, Nonholonomic, Particle,
        Rolling, Slipping, Speed, State,
    };
    pub use crate::elements::{forces::*, joints::*};
    pub use crate::integrate::{
        DormandPrince, DormandPrince8, Error, EventDriven, ImplicitMidpoint, Rk4, Rodas, Rosenbrock,
        SemiImplicitEuler, TimeStepping,
    };
    pub use crate::lanes::{Lanes, f32x8, f32x16, f64x4, f64x8};
    pub use crate::simulate::{Crossing, Sample, simulate};
    pub use crate::{
        Batch, Constrained, ConstraintError, Derivatives, FirstOrder, FirstOrderDerivatives, Limits,
        Mechanism, Real, SecondDerivatives, Table, at, frame, index,
    };
    #[cfg(not(linkwork_expanded))]
    pub use linkwork_macros::mechanism;
    pub use nalgebra::{SMatrix, SVector};
}

/// Items that generated code uses. They are not part of the public interface.
#[doc(hidden)]
pub mod __private {
    pub use crate::absent;
    pub use crate::arithmetic::dispatch::{Evaluate, dispatch, dispatch_in_any_build};
    pub use crate::arithmetic::{Arithmetic, Compiled, Vector};
    pub use crate::chains::{Block as LinkBlock, Row as LinkRow, chain_derivatives};
    pub use crate::constraint::{
        ConstraintCurvature, Elimination, InputDerivatives, Loops, Motion, MotionDerivatives, Responses,
        Structure, assemble, assembly_mode, careful_response, constrained_derivatives,
        constrained_second_derivatives, least_solution, least_violation, nearly_singular, pressing_solution,
        rank_revealing_dynamics, regular_solution, slipping_response, slipping_solution,
        solution_with_predetermined_pivots, stabilized_derivatives, with_curvature,
    };
    pub use crate::contact::Columns as ContactDerivatives;
    pub use crate::contact::{
        Polytope, PolytopeEdge, PolytopeFace, PolytopePair, contact_features, differentiate_step,
        differentiate_step_by_parameters, held_derivatives, write_contact_features,
    };
    pub use crate::derivatives::acceleration_derivatives;
    pub use crate::first_order::columns;
    pub use crate::frame::{Index, Message, identity_placement, join, origin, placement, six, sum, twist};
    pub use crate::lanes::{Lanes, lane, lane_by_lane, set_lane, splat};
    pub use crate::lie::curvature::{
        ball_tangent_rate_second_derivatives, free_tangent_rate_second_derivatives,
    };
    pub use crate::lie::jacobians::{
        ball_integrate_derivatives, ball_tangent_rate_derivatives, free_integrate_derivatives,
        free_tangent_rate_derivatives,
    };
    pub use crate::lie::{
        ball_carry, ball_carry_rate, ball_difference, ball_integrate, ball_tangent_rate, free_carry,
        free_carry_rate, free_difference, free_integrate, free_tangent_rate,
    };
    pub use crate::limits::{at_least, at_most};
    pub use crate::multiplication::{
        Tile, complete, invert, registers_of_eight, registers_of_four, replace_by_negative_products, rows,
    };
    pub use crate::parameters::{Figure, Rule, validate};
    pub use crate::private::{constant, put_block, put_rows};
    pub use crate::second::forward_second_derivatives;
    pub use crate::speeds::{displacement_rate_derivatives_in_speeds, integrate_derivatives_in_speeds};
    pub use crate::trigonometry::{COSINE, LARGEST as LARGEST_ANGLE, QUARTER_TURN, ROUND, SINE};
    pub use nalgebra::{
        ArrayStorage, IsometryMatrix3, Matrix3, Rotation3, SMatrix, SVector, Translation3, Vector3,
    };
}

#[cfg(test)]
mod testing;

/// Item whose documentation is the README, so that its examples are run as tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

/// Checks that the equations in the README are those of its example.
///
/// ```
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * y)]
/// pub struct CartPole {
///     pub cart_mass: f64,
///     pub pole_mass: f64,
///     pub pole_length: f64,
///     #[body(mass = cart_mass)]
///     cart: Body,
///     #[body(mass = pole_mass, com = pole_length / 2 * y, inertia = rod(pole_mass, pole_length, y))]
///     pole: Body,
///     #[joint(ground -> cart, along = x)]
///     rail: Sleeve,
///     #[joint(cart -> pole, about = z)]
///     hinge: Pin,
///     #[acts(on = cart, along = x)]
///     push: Force,
/// }
///
/// let readme = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../README.md"));
/// let equations: Vec<_> = CartPole::EQUATIONS.lines().take_while(|line| !line.starts_with("L is")).collect();
/// assert!(equations.len() > 6);
/// for line in equations {
///     assert!(readme.contains(line), "{line}");
/// }
/// ```
#[cfg(doctest)]
struct ReadmeEquations;
