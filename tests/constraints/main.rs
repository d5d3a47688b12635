//! Mechanisms with constraints.

mod counts;
mod formulations;
mod invariants;
mod reactions;
