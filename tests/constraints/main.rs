//! Mechanisms with constraints. Tests of their long motions are in `motions/constraints`.

mod contacts;
mod counts;
mod embedded;
mod formulations;
mod impacts;
mod invariants;
mod massless;
mod overdetermined;
mod planar;
mod reactions;
mod slipping;
