#![doc = include_str!("../README.md")]

mod about;
mod adjoint;
mod adjoint_steps;
mod assemble;
mod capacity;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod code;
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
#[path = "no_code.rs"]
mod code;
mod configuration_space;
mod constrained;
mod drawing;
mod error;
mod frames;
mod functions;
mod independent;
mod internal;
mod inverse;
mod kernels;
mod layout;
mod load;
mod merge;
mod methods;
mod names;
mod padded;
mod polytopes;
mod robot;
mod roll_out;
mod routine;
mod separate;
mod shared;
mod simulate;
mod steps;
mod table;
mod web;

pub use adjoint::VectorJacobian;
pub use adjoint_steps::{AdjointStepper, Sensitivity};
pub use drawing::Drawing;
#[doc(hidden)]
pub use drawing::convert_piece;
pub use error::Error;
pub use functions::Matrix;
pub use independent::IndependentMotion;
pub use linkwork::simulate::Overlaps;
pub use load::{Loader, declare, load};
#[doc(hidden)]
pub use load::{compiled, parse_source_and_separate_contacts, remove_rust_only_options};
pub use padded::{Padded, PaddedContacts};
pub use robot::{Function, Limit, Robot};
pub use shared::Quantity;
pub use simulate::{Controller, Inputs, Method, Run, Sample, Simulation};
pub use steps::{Jacobians, Stepper};
pub use table::AnyTable;
#[doc(hidden)]
pub use web::WebStart;
