//! Mechanisms with constraints.

mod branches;
mod contacts;
mod counts;
mod embedded;
mod formulations;
mod impacts;
mod invariants;
mod lanes;
mod long_runs;
mod massless;
mod overdetermined;
mod planar;
mod reactions;
mod singular;
mod slipping;
