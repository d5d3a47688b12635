//! Mechanisms with constraints.

mod contacts;
mod counts;
mod embedded;
mod formulations;
mod invariants;
mod reactions;
mod slipping;
