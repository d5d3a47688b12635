//! Forms of the struct that the attribute `#[mechanism]` accepts.

#![deny(warnings)]
#![deny(missing_docs)]

use linkwork::prelude::*;

/// Mechanism without parameters, whose struct has no fields left.
#[mechanism]
pub struct MechanismWithoutParameters {
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
}

/// Mechanism that has all attributes and visibilities which Rust allows on a struct and its fields.
#[mechanism(gravity = [0, -9.81, 0],)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
#[non_exhaustive]
#[must_use]
pub struct CartWithAllAttributes {
    /// Mass of the cart, kg.
    #[doc(alias = "weight")]
    pub mass: f64,
    /// Parameter that no element uses; the leading underscore marks it as intentional.
    pub(crate) _serial: f64,
    /// Cart with a mass that is a parameter.
    #[doc(hidden)]
    #[allow(dead_code, reason = "only its form counts")]
    #[body(mass = mass, inertia = 0, com = 0,)]
    pub cart: linkwork::elements::Body,
    /// Prismatic joint along a diagonal direction.
    #[joint(ground.at(2.5 * x).rotated(z(pi / 2)) -> cart, along = unit(x + y),)]
    pub rail: linkwork::elements::Sleeve,
}

/// Mechanism whose scalar type is `f32`.
#[mechanism(scalar = f32)]
struct SinglePrecisionCart {
    #[body(mass = 0.1)]
    cart: Body,
    #[joint(ground -> cart, along = -x)]
    rail: Sleeve,
}

/// Mechanism that is generic over any scalar type, with additional bounds.
#[mechanism(gravity = -g * y)]
#[derive(Clone, Copy, Debug)]
pub struct Generic<Scalar: Copy>
where
    Scalar: core::fmt::Debug,
{
    /// Gravitational acceleration, m/s², as a parameter.
    pub g: Scalar,
    #[body(mass = 2, com = 1e-3 * y, inertia = sphere(2, 1))]
    cart: Body,
    #[joint(ground -> cart, about = (x, y))]
    cross: Universal,
}

#[test]
fn all_struct_forms_compile() {
    let adorned = CartWithAllAttributes { mass: 2.0, _serial: 7.0 };
    assert_eq!(adorned.total_mass() + adorned._serial, 9.0);
    assert_eq!(MechanismWithoutParameters.total_mass(), 1.0);
    assert_eq!(SinglePrecisionCart {}.total_mass(), 0.1_f32);
    let generic = Generic { g: 9.81_f32 };
    assert_eq!(generic.total_mass(), 2.0_f32);
}
