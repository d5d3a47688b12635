//! Linear systems of mechanisms, and the equilibria and steady motions about which they are linearised.
//!
//! A [`StateSpace`] has the matrices A, B, C, D and the names and units of its states, inputs and outputs. It
//! is computed from a mechanism ([`mechanism`]) or constructed from matrices. Its analyses are
//! [modes](StateSpace::modes), [zeros](StateSpace::zeros), [transfer
//! functions](StateSpace::transfer_function), [responses](StateSpace::step_response) over time and
//! [frequency](StateSpace::frequency_response), [margins](StateSpace::margins), [regulators](StateSpace::lqr)
//! and [estimators](StateSpace::kalman). [`picture`] draws the results. [`steady`] finds equilibria and trims
//! motions by names. [`flight`] classifies the modes of aircraft and computes their derivatives.
//!
//! The [guide] shows all of these for one aircraft.

pub use discretize::Hold;
pub use error::Error;
pub use frequency::{FrequencyMap, FrequencyResponse, logarithmic};
pub use margins::{GainMargin, Margins, PhaseMargin, StabilityMargin};
pub use modes::Mode;
/// Linear algebra library, in the version that this crate depends on.
pub use nalgebra;
pub use norms::PeakGain;
pub use polynomial::Polynomial;
pub use regulator::{Kalman, Noise};
pub use response::Response;
pub use root_locus::RootLocus;
pub use routh::{GainRange, Routh, Special};
pub use second_order::SecondOrderForm;
pub use state_space::{Port, Signal, StateSpace};
pub use step::{StepFigures, StepLimits};
pub use structure::{KalmanRanks, Staircase};
pub use transfer::{TransferFunction, ZerosPolesGain};

mod connect;
mod crossings;
mod discretize;
mod double_double;
mod error;
pub mod flight;
mod frequency;
mod loop_polynomials;
mod margins;
pub mod matrices;
pub mod mechanism;
mod modal_sum;
mod modes;
mod norms;

pub mod picture;
mod placement;
mod polynomial;
mod regulator;
mod response;
mod root_locus;
mod routh;
mod second_order;
mod state_space;
pub mod steady;
mod step;
mod structure;
mod transfer;
mod zeros;

#[cfg(any(doc, doctest))]
#[doc = include_str!("../guide.md")]
pub mod guide {}
