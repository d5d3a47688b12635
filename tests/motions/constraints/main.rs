//! Long motions of mechanisms with constraints, near singular configurations and through them.

mod branches;
mod lanes;
mod long_runs;
mod singular;
