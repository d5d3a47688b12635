//! Bodies, joints and forces: the types of the fields of a `#[mechanism]` struct.
//!
//! The type of a field defines the kind of element, its attribute the placement and properties;
//! [`mechanism`](macro@crate::mechanism) shows an example. The compiler reads these types and removes the
//! fields: the types have no values.
//!
//! | kind | types |
//! | --- | --- |
//! | bodies | [`Body`], [`Particle`] |
//! | joints with one degree of freedom | [`Pin`] (revolute), [`Sleeve`] (prismatic), [`Screw`] (helical) |
//! | joints with two | [`Collar`] (cylindrical), [`Slot`], [`Universal`], [`Stage`] |
//! | joints with three | [`Ball`] (spherical), [`Planar`], [`Stage`] |
//! | joints with six, with none | [`Free`] (floating), [`Weld`] (fixed) |
//! | force elements | [`Spring`], [`Dashpot`] (damper), [`Inerter`], [`Friction`], [`Gravity`], [`Attraction`] |
//! | inputs, and forces with a value | [`Force`], [`Torque`], [`Input`] |
//! | constraints | [`Holonomic`], [`Nonholonomic`], [`Rolling`], [`Slipping`] |
//! | unilateral contacts | [`Contact`] |
//! | bounds, stops | [`Limit`] |
//! | first-order states | [`State`] |
//! | equilibria | [`Equilibrium`] |
//! | points, frames, coordinates | [`Point`], [`Frame`], [`Coordinate`] |
//! | expressions | [`Scalar`], [`Vector`], [`Matrix`], [`FreeBody`], [`Potential`], [`Rayleigh`], [`Speed`] |
//!
//! # Vectors and points
//!
//! In the attributes, vectors are written with the axes `x`, `y`, `z` of the frame that the attribute belongs
//! to: the body's own in `#[body(…)]` and `.at(…)`, the parent's for a joint's axis, the ground's for
//! gravity. `cart.x` is an axis of `cart`. Joints and force elements are attached to bodies, to the `ground`,
//! or to points on them: `body.at(l / 2 * y)`, or with rotated axes `body.at(l * x).rotated(z(angle),
//! x(tilt))`. Rotations are applied in order, each about an axis of the frame that the earlier ones have
//! rotated.
//!
//! # Joints
//!
//! A joint moves its child relative to its parent. A joint whose child already is the child of another joint
//! closes a kinematic loop: it has no coordinate. Its constraints are solved with multipliers, or with
//! `#[mechanism(formulation = speeds)]` (or `independent = (joint, …)`) in independent speeds. In a plane, a
//! Pin that closes a loop between two bodies on Pins, or on a Pin and a Sleeve, may have the option `branch =
//! 1` or `branch = -1`, which selects the assembly mode: the loop is then solved in closed form, and the
//! dependent coordinates are eliminated. In an output, `reaction_force(joint)` and `reaction_torque(joint)`
//! are the force and torque of the joint's parent on its child.
//!
//! # Units
//!
//! Units are SI, angles in radians, or `degrees(90)`. Units of parameters are inferred: `mass = m` makes `m`
//! a mass, `com = l / 2 * y` makes `l` a length, and a parameter with contradictory units is a compile error.
//! A number may have any unit: `-9.81 * y` is an acceleration, `l + 0.1` a length. However, factors such as
//! ½, 2 or π of a parameter are dimensionless, and expressions without parameters are not checked.
//! `#[unit(N * m / rad)]` on a parameter specifies a unit that cannot be inferred. The documentation of the
//! struct lists all units.

/// Implements derivable traits for types without values. Without these implementations, a `#[derive(…)]`
/// placed above `#[mechanism]` would report missing traits of the elements in addition to the error about the
/// order of the attributes.
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
pub(crate) mod forces;
pub(crate) mod joints;

pub use bodies::*;
pub use constraints::*;
pub use expressions::*;
pub use forces::*;
pub use joints::*;
