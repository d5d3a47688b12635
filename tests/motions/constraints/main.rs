//! Long motions of mechanisms with constraints, near singular positions and through them among them.

mod branches;
mod lanes;
mod long_runs;
mod singular;
