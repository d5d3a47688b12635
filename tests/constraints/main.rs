//! Mechanisms with constraints, held to published and recomputed results.

mod linkages;
mod rolling;
mod skates;
