#![doc = include_str!("../README.md")]

mod call;
mod motion;
mod numbers;
pub mod raw;
mod rollout;

pub use call::{Batch, Body, Failure, Function, LANES, call};
pub use linkwork;
pub use motion::{Control, Every, Motion, Way, simulate, simulate_with_contacts};
pub use numbers::{Argument, Entry, Given, Marked, Number, Results, Sink, given};
pub use rollout::{Rollout, roll_out, roll_out_in_lanes};

use std::ffi::CStr;

/// A mechanism with a table of its functions, as `linkwork export library` writes it.
pub trait Library: Sized + Sync + 'static {
    /// The numbers of all arrays: `f64` or `f32`.
    type Number: Number;
    /// How many parameters there are.
    const PARAMETERS: usize;
    /// Names, shapes, units and documentation of everything, as JSON.
    const DESCRIPTION: &'static CStr;
    /// The functions, in the order of the description.
    const FUNCTIONS: &'static [Function<Self>];

    /// The mechanism with these parameters, in the order of the description.
    fn with(parameters: &[Self::Number]) -> Self;

    /// Why no mechanism can have these parameters, if so.
    ///
    /// # Errors
    ///
    /// That of the mechanism's `validate`.
    fn check(&self) -> Result<(), Failure>;

    /// Simulates, and writes a sample in every row of `samples`.
    ///
    /// # Errors
    ///
    /// Those of the method of integration, and of the controller.
    fn simulate(&self, motion: &mut Motion<'_, Self::Number>) -> Result<(), Failure>;

    /// Takes many states through many steps.
    ///
    /// # Errors
    ///
    /// The first motion, in the order of states, that does not stay finite or on its constraints.
    fn roll_out(&self, rollout: Rollout<'_, Self::Number>) -> Result<(), Failure>;
}
