//! Shared parts of the programs that compare generated functions with other libraries: in one process,
//! interleaved, on the same states.

pub mod clock;
mod code;
pub mod contender;
#[expect(unsafe_code, reason = "the peers are shared libraries with C interfaces")]
pub mod library;
pub mod own;
pub mod turns;
