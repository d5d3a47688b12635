//! What the compiler takes for granted about processors. Every number that was tuned by measuring stands here, with how it was
//! found; nothing else in the compiler knows a processor.
//! Latencies are usual figures of processors with fused operations; limits were tuned on the robots of `benches`, on x86-64
//! processors with 512-bit registers.

/// In how many parts a cycle is counted, and how many operations are begun in one.
pub const CYCLE: u32 = 3;
/// How long an addition takes.
pub const ADD: u32 = 3 * CYCLE;
/// How long a multiplication takes, and a product with its sum.
pub const MULTIPLY: u32 = 4 * CYCLE;
/// How long a division takes.
pub const DIVIDE: u32 = 13 * CYCLE;
/// How long a negation takes.
pub const NEGATE: u32 = CYCLE;
/// How long moving a number between lanes takes.
pub const MOVE_LANE: u32 = 2 * CYCLE;
/// How long adding the upper half of a vector's lanes to the lower takes: a move and an addition.
pub const HALVE: u32 = 5 * CYCLE;
/// How long sines and cosines take: those of all angles are evaluated as lanes at the beginning.
pub const SINE: u32 = 60 * CYCLE;
/// How long other elementary functions take, which are calls.
pub const CALL: u32 = 50 * CYCLE;

/// Most instructions for each cycle of the longest chain that are put in another order. Where there are more, the processor
/// never lacks something to do, and another order only keeps more values waiting.
pub const MOST_PARALLELISM: f64 = 5.0;

/// About how many instructions the first cache holds: those of a larger program have to be
/// fetched each time, however many lanes they have.
pub const CACHED_INSTRUCTIONS: usize = 4000;

/// What an instruction costs, in tenths of one of a single lane, by the number of lanes. Eight
/// lanes take two registers where there are none of 512 bits.
pub fn cost_of_lanes(lanes: usize) -> usize {
    match lanes {
        0..=2 => 10,
        3..=4 => 15,
        _ => 25,
    }
}
/// What gathering a lane of an input costs, in tenths of an instruction.
pub const GATHER_COST: usize = 8;
/// What taking a lane out costs.
pub const LANE_COST: usize = 5;
/// What summing lanes costs, for each of them.
pub const SUM_COST: usize = 10;
/// What a call costs, for each lane.
pub const CALL_COST: usize = 20;
/// What fetching an instruction costs that the first cache does not hold.
pub const FETCH_COST: usize = 15;

/// Fewest operations of a function that chooses its arithmetic at run time. The choice costs about two nanoseconds, and a function
/// that is called cannot be inlined.
pub const DISPATCHED_OPERATIONS: usize = 60;

/// Fewest instructions of a function that is written once for matrices that are given and for those it returns. Rustc reads half as
/// much, and a humanoid's takes 2961 ns instead of 3260: filling matrices with zeros is quicker than storing zeros one by one.
pub const FILLING_INSTRUCTIONS: usize = 3000;

/// Fewest operations of what springs, dashpots and applied forces between points store, dissipate and act by, from which on their
/// generalized forces are a function that the others call. A call costs a few nanoseconds and computes placements twice, which is
/// less than a hundredth of the time of so many operations; without it rustc reads each of them in every function.
pub const CALLED_OPERATIONS: usize = 1000;

/// Up to how many velocities functions are derived from frames of several kinds, and both algorithms of forward dynamics, and
/// compared.
pub const COMPARED_VELOCITIES: usize = 18;
/// Up to how many operations of mass matrix and inverse dynamics together they are compared whatever they cost: beyond, frames that
/// are worse at first sight are left out, and articulated bodies are taken. The largest quadruped has 1940, 16 spatial pins 2635,
/// whose frames differ by 6 to 9 in 100, and the factorisation takes twice the operations.
pub const COMPARED_OPERATIONS: usize = 2000;

/// Up to how many velocities every form of a model is tried for derivatives, and each of them is written out.
pub const DERIVATIVES_COMPARED: usize = 10;
/// Up to how many velocities the derivatives of forward dynamics of mechanisms that branch are written out. What stands in a single
/// function needs stack where it is not optimised.
pub const DERIVATIVES_WRITTEN_OUT: usize = 24;
/// Up to how many velocities of a trunk, or of a mechanism that does not branch, the inverse of the mass matrix is written out.
/// Beyond it is quicker in loops: of chains of pins, 12 are as fast, 16 take 776 ns instead of 1105, 24 take 2376 instead of 5079.
pub const INVERSE_WRITTEN_OUT: usize = 12;

/// Up to how many statements results of alike limbs are stored at the end, column by column: then the lanes of several are turned
/// round in registers and stored together.
pub const TURNED_STATEMENTS: usize = 300;
/// How many statements after one vector another may be known whose lanes are stored together with its own. More would make the
/// first wait in memory, for few pairs: from 60 to 200 a humanoid's mass matrix gains 15 stores.
pub const NEAR_STATEMENTS: usize = 60;
/// How many zeros a column may have in the rows of its neighbours to be multiplied together with them.
pub const FILLED_ZEROS: usize = 2;
