//! Problems of the textbooks in the words that they are stated in: free coordinates, moving frames, laws,
//! potentials and outputs, each against its closed form. Those that the gallery of ready-made mechanisms has
//! are taken from there.

mod coordinates;
mod curves;
mod driven;
mod elements;
mod gravity;
mod machines;
mod matrices;
mod motions;
mod orientations;

/// Identities.
const EXACT: f64 = 1e-13;
/// Motions.
const MOTION: f64 = 1e-10;
