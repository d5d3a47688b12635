//! Bodies, joints and forces: the types of the fields of a `#[mechanism]` struct.
//!
//! A field's type says what it is, its attribute how it is placed; [`mechanism`](macro@crate::mechanism) shows an example.
//! The compiler reads these types and removes the fields: there are no values of them.
//!
//! | what | types |
//! | --- | --- |
//! | bodies | [`Body`], [`Particle`] |
//! | joints with one degree of freedom | [`Pin`] (revolute), [`Sleeve`] (prismatic), [`Screw`] (helical) |
//! | joints with two | [`Collar`] (cylindrical), [`Slot`], [`Universal`], [`Stage`] |
//! | joints with three | [`Ball`] (spherical), [`Planar`], [`Stage`] |
//! | joints with six, with none | [`Free`] (floating), [`Weld`] (fixed) |
//! | force elements | [`Spring`], [`Dashpot`] (damper), [`Inerter`], [`Friction`], [`Gravity`], [`Attraction`] |
//! | inputs, and forces with a value | [`Force`], [`Torque`], [`Input`] |
//! | constraints | [`Holonomic`], [`Nonholonomic`], [`Rolling`], [`Slipping`] |
//! | contacts that open and close | [`Contact`] |
//! | bounds, stops | [`Limit`] |
//! | states of first order | [`State`] |
//! | configurations at rest | [`Equilibrium`] |
//! | places | [`Point`], [`Frame`], [`Coordinate`] |
//! | expressions | [`Scalar`], [`Vector`], [`Matrix`], [`FreeBody`], [`Potential`], [`Rayleigh`], [`Speed`] |
//!
//! # Vectors and places
//!
//! In the attributes, vectors are written with the axes `x`, `y`, `z` of the frame that the attribute belongs to: the
//! body's own in `#[body(…)]` and `.at(…)`, the parent's for a joint's axis, the ground's for gravity. `cart.x` is an axis
//! of `cart`. Joints and force elements are attached to bodies, to the `ground`, or to places on them:
//! `body.at(l / 2 * y)`, or with axes of its own `body.at(l * x).rotated(z(angle), x(tilt))`; rotations are carried out in
//! order, each about an axis that the earlier ones have turned.
//!
//! # Joints
//!
//! A joint carries its child. A joint to a body that another one carries already closes a loop: it has no coordinate, and its
//! constraints are solved with multipliers, or with `#[mechanism(formulation = speeds)]` (or `independent = (joint, …)`) in
//! independent speeds. In a plane, a Pin that closes a loop between two bodies on Pins, or on a Pin and a Sleeve, may
//! say `branch = 1` or `branch = -1`: then its loop is solved in closed form, and the dependent coordinates drop out.
//! `reaction_force(joint)` and `reaction_torque(joint)` in an output are what the joint's parent exerts on its child.
//!
//! # Units
//!
//! Units are SI, angles in radians, or `degrees(90)`. Units of parameters are inferred: `mass = m` makes `m` a mass, `com = l / 2 * y` makes
//! `l` a length, and a parameter that would have to be two things at once is a compile error. A number has any unit:
//! `-9.81 * y` is an acceleration, `l + 0.1` a length. But ½, 2 or π beside a parameter are plain factors, and an expression
//! without parameters is held to nothing. `#[unit(N * m / rad)]` on a parameter says its unit where nothing else does. The
//! struct's documentation lists all.

/// There are no values to clone, compare or show. A `#[derive(…)]` above `#[mechanism]` asks for that all the same: with
/// these it is told that it stands in the wrong place, and nothing else.
macro_rules! derivable {
    ($($element:ident)*) => { $(
        #[doc(hidden)]
        impl Clone for $element {
            fn clone(&self) -> Self {
                *self
            }
        }
        #[doc(hidden)]
        impl Copy for $element {}
        #[doc(hidden)]
        impl core::fmt::Debug for $element {
            fn fmt(&self, _: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match *self {}
            }
        }
        #[doc(hidden)]
        impl PartialEq for $element {
            fn eq(&self, _: &Self) -> bool {
                match *self {}
            }
        }
        #[doc(hidden)]
        impl Eq for $element {}
    )* };
}

mod bodies;
mod constraints;
mod expressions;
mod forces;
mod joints;

pub use bodies::*;
pub use constraints::*;
pub use expressions::*;
pub use forces::*;
pub use joints::*;
