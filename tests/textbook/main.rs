//! Checks of textbook problems in their usual formulation: free coordinates, moving frames, force laws,
//! potentials and outputs, each against its closed-form solution. Mechanisms are taken from the gallery if it
//! contains them.

mod coordinates;
mod curves;
mod driven;
mod elements;
mod gravity;
mod machines;
mod matrices;
mod motions;
mod orientations;

/// Tolerance of identities, which hold up to rounding.
const EXACT: f64 = 1e-13;
/// Tolerance of motions that are integrated numerically.
const MOTION: f64 = 1e-10;
