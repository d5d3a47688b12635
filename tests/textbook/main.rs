//! Textbook problems in the terms in which they are stated: free coordinates, moving frames, force laws,
//! potentials and outputs, each against its closed-form solution. Mechanisms that the gallery contains are
//! used from there.

mod coordinates;
mod curves;
mod driven;
mod elements;
mod gravity;
mod machines;
mod matrices;
mod motions;
mod orientations;

/// Tolerance of identities.
const EXACT: f64 = 1e-13;
/// Tolerance of integrated motions.
const MOTION: f64 = 1e-10;
