//! Mechanisms with constraints.

mod counts;
mod embedded;
mod formulations;
mod invariants;
mod reactions;
