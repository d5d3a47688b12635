//! The Dormand–Prince pair of orders 5 and 4 with adaptive steps.

use super::adaptive::{AdaptiveMemory, AdaptiveSettings, StepControl, adaptive};
use super::{Dynamics, Error, Jump, Method, State, Step};
use crate::Real;

mod stages;

use stages::dormand_prince_step;

/// Constants of the step-size controller of DOPRI5.
const CONTROL: StepControl = StepControl { exponent: 0.2 - 0.75 * 0.04, beta: 0.04, factors: [10.0, 5.0] };

/// The Dormand–Prince method of order 5 with an error estimate of order 4, adaptive steps and interpolation
/// of order 4.
///
/// A step is accepted when the root mean square over `φ` and `v` of `error / (absolute + relative · size)` is
/// at most one. The size of a coordinate is its magnitude; where quaternions occur it is 1 rad or 1 m for all
/// coordinates. Six evaluations of the dynamics per step; proportional–integral step control.
///
/// ```
/// # use linkwork::prelude::*;
/// let method = DormandPrince::new().tolerance(1e-10, 1e-12).max_step(0.1);
/// # let _: DormandPrince<f64> = method;
/// ```
///
/// Sources: Dormand and Prince, *A family of embedded Runge–Kutta formulae*, J. Comp. Appl. Math. 6 (1980);
/// Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I* (1993), II.4–6 and the program
/// DOPRI5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DormandPrince<T> {
    settings: AdaptiveSettings<T>,
}

adaptive!(DormandPrince, CONTROL, |system, attempt, _| dormand_prince_step(system, attempt));
