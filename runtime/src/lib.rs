#![cfg_attr(not(feature = "std"), no_std)]
//! Linkwork compiles mechanisms: annotate a struct with bodies, joints, springs and inputs (or name a URDF file),
//! and the compiler derives its equations of motion and puts specialised, allocation-free Rust in its place.
//!
//! - [`prelude`]: everything that a program with a mechanism needs, in one import.
//! - [`elements`]: the words in which a mechanism is declared.
//! - [`Mechanism`]: what every compiled mechanism offers.
//! - [`Constrained`]: what those with closed loops, rolling or other constraints offer besides.
//! - [`lanes`]: numbers of several states side by side, for evaluating a mechanism many times.
//! - [`simulate()`]: its motion over time; [`integrate`] holds the methods.
//!
//! Nothing here allocates, nothing panics but indices of [`Lanes`] out of range, and nothing needs the standard library if the feature `libm` is chosen instead of
//! `std`.
//!
//! With `std`, release builds for x86-64 compile large generated functions twice and run them with AVX2 and FMA where the
//! processor has these: results are the same up to rounding. Products of large matrices take AVX-512 where it is.
//! `#[mechanism(processor = target)]` leaves that out.

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!("linkwork needs one of its features `std` and `libm` for the elementary functions");

#[allow(unused_extern_crates, reason = "generated code names this crate, also in its own tests")]
extern crate self as linkwork;
#[cfg(test)]
extern crate std;

pub use batch::Batch;
pub use constraint::{Constrained, ConstraintError};
pub use frame::{FrameIndex, NamedFrame};
pub use lanes::Lanes;
pub use linkwork_macros::mechanism;
pub use mechanism::{Mechanism, Real};
pub use nalgebra;
pub use rheonomic::{At, Rheonomic, at};
pub use simulate::simulate;

mod arithmetic;
pub mod batch;
pub mod constraint;
pub mod elements;
mod frame;
pub mod integrate;
pub mod lanes;
mod lie;
mod mechanism;
mod private;
mod product;
mod rheonomic;
pub mod rotation;
pub mod simulate;
mod trigonometry;

/// Everything that a program with a mechanism needs: `use linkwork::prelude::*;`.
pub mod prelude {
    pub use crate::elements::*;
    pub use crate::integrate::{DormandPrince, Error, ImplicitMidpoint, Rk4, Rosenbrock, SemiImplicitEuler};
    pub use crate::lanes::{Lanes, f32x8, f32x16, f64x4, f64x8};
    pub use crate::simulate::{Crossing, Sample, simulate};
    pub use crate::{Batch, Constrained, ConstraintError, Mechanism, Real, at, frame, mechanism};
    pub use nalgebra::{SMatrix, SVector};
}

/// What generated code calls; no part of the public interface.
#[doc(hidden)]
pub mod __private {
    pub use crate::arithmetic::dispatch::{Body, dispatch};
    pub use crate::arithmetic::{Arithmetic, Compiled};
    pub use crate::constraint::{
        Motion, columns, constrained_derivatives, least_multipliers, least_solution, pressing_solution,
        regular_solution, slipping_response, slipping_solution,
    };
    pub use crate::frame::{frame_index, identity_placement, join, origin, placement, six};
    pub use crate::lanes::{Lanes, lane, lane_by_lane, splat};
    pub use crate::lie::{
        ball_difference, ball_integrate, ball_tangent_rate, free_difference, free_integrate,
        free_tangent_rate,
    };
    pub use crate::private::constant;
    pub use crate::product::{Rows, complete, eights, fours, invert, minus_products, rows};
    pub use nalgebra::{
        ArrayStorage, IsometryMatrix3, Matrix3, Rotation3, SMatrix, SVector, Translation3, Vector3,
    };
}

#[cfg(test)]
mod testing;

/// The README's examples are tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
