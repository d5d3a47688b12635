//! Processor model of the compiler: latencies, costs, and limits that depend on the processor. Latencies are
//! typical values of processors with fused operations; limits were tuned on the robots of `benches`, on
//! x86-64 processors with 512-bit registers.
//!
//! Other constants are defined in the stage that uses them: limits of the effort of a pass (`lower`,
//! `vectorise`), costs of link frames in operations (`passes::cost`), tolerances of rounding, and limits of
//! the size of mechanisms (`resolve`).

/// Time units per cycle, and operations issued per cycle.
pub const CYCLE: u32 = 3;
/// Latency of an addition, in the time unit of the schedule.
pub const ADD: u32 = 3 * CYCLE;
/// Latency of a multiplication or a fused multiply-add.
pub const MULTIPLY: u32 = 4 * CYCLE;
/// Latency of a division, in time units.
pub const DIVIDE: u32 = 13 * CYCLE;
/// Latency of a negation, in time units.
pub const NEGATE: u32 = CYCLE;
/// Latency of moving a value between SIMD lanes, in time units.
pub const MOVE_LANE: u32 = 2 * CYCLE;
/// Latency of adding the upper half of a vector's lanes to the lower half: a move and an addition.
pub const HALVE: u32 = 5 * CYCLE;
/// Latency of sines and cosines, which are evaluated in lanes for all angles at the start.
pub const SINE: u32 = 60 * CYCLE;
/// Latency of elementary functions that are library calls, in time units.
pub const CALL: u32 = 50 * CYCLE;

/// Maximum number of instructions per cycle of the critical path for which a program is scheduled. With more
/// parallelism the processor is busy in any order, and scheduling only increases register pressure.
pub const MOST_PARALLELISM: f64 = 5.0;

/// Approximate number of instructions that the first-level cache holds. Instructions of a larger program are
/// fetched on each call.
pub const CACHED_INSTRUCTIONS: usize = 4000;

/// Returns the cost of an instruction with this number of lanes, in tenths of an instruction on one lane.
/// Eight lanes take two registers on processors without 512-bit registers.
pub fn cost_of_lanes(lanes: usize) -> usize {
    match lanes {
        0..=2 => 10,
        3..=4 => 15,
        _ => 25,
    }
}
/// Cost of gathering one SIMD lane of an input, in tenths of an instruction.
pub const GATHER_COST: usize = 8;
/// Cost of extracting a SIMD lane, in tenths of an instruction.
pub const LANE_COST: usize = 5;
/// Cost of summing SIMD lanes, per lane, in tenths of an instruction.
pub const SUM_COST: usize = 10;
/// Cost of a library call, per SIMD lane, in tenths of an instruction.
pub const CALL_COST: usize = 20;
/// Cost of fetching an instruction that is not in the first-level cache.
pub const FETCH_COST: usize = 15;

/// Minimum number of operations of a function that chooses its instruction set at run time. The choice costs
/// about two nanoseconds and prevents inlining.
pub const DISPATCHED_OPERATIONS: usize = 60;

/// Minimum number of instructions of a function that is emitted once, for matrices of the caller, and wrapped
/// for returned matrices. rustc reads half as much, and a humanoid's derivatives take 2961 ns instead of
/// 3260, because clearing a matrix is faster than storing single zeros.
pub const FILLING_INSTRUCTIONS: usize = 3000;

/// Minimum number of operations of passive forces for which the generalized passive forces are a separate
/// function. The call costs a few nanoseconds and computes placements twice, which is less than a hundredth
/// of the time of that many operations; otherwise rustc would read these operations in every function.
pub const CALLED_OPERATIONS: usize = 1000;

/// Maximum number of velocities for which candidates with several choices of link frames, and both algorithms
/// of forward dynamics, are derived and compared.
pub const COMPARED_VELOCITIES: usize = 18;
/// Maximum number of operations of mass matrix and inverse dynamics together for which all candidates are
/// compared. Beyond it, candidates with more operations in a first estimate are dropped, and forward dynamics
/// uses articulated bodies. The largest quadruped has 1940 operations; a chain of 16 spatial pins has 2635,
/// its frames differ by 6 to 9 per cent, and the factorisation takes twice the operations.
pub const COMPARED_OPERATIONS: usize = 2000;

/// Maximum number of velocities for which every variant of a model is tried for derivatives, expanded to
/// scalars.
pub const DERIVATIVES_COMPARED: usize = 10;
/// Maximum number of velocities for which derivatives of forward dynamics of branching mechanisms are
/// expanded to scalars. A single large function needs much stack in unoptimised builds.
pub const DERIVATIVES_WRITTEN_OUT: usize = 24;
/// Maximum number of velocities of a trunk, or of a mechanism without branches, for which the inverse of the
/// mass matrix is expanded to scalars. Beyond it loops are faster: for chains of 12 pins both take the same
/// time; 16 pins take 776 ns in loops instead of 1105, 24 pins 2376 instead of 5079.
pub const INVERSE_WRITTEN_OUT: usize = 12;

/// Maximum number of statements for which results of identical limbs are stored at the end, column by column:
/// lanes of several results are then transposed in registers and stored together.
pub const TRANSPOSED_STATEMENTS: usize = 300;
/// Maximum distance in statements between two vectors whose lanes are stored together. With a larger distance
/// the first one would be spilled to memory, for few additional pairs: from 60 to 200 a humanoid's mass
/// matrix saves 15 stores.
pub const NEAR_STATEMENTS: usize = 60;
/// Maximum number of zeros of a column, in the rows of its neighbours, for which it is multiplied together
/// with them.
pub const FILLED_ZEROS: usize = 2;

/// Minimum number of velocities for which loops over blocks of links are a candidate for the derivatives of
/// inverse dynamics.
pub const BLOCKED_VELOCITIES: usize = 10;
/// Cost of the loops of the derivatives of inverse dynamics for a block of links, in tenths of an
/// instruction: 140 ns, where straight-line code of a chain of 16 links takes 10 ns for a cost of 920.
pub const BLOCK_COST: usize = 12_000;
/// Cost of these loops for a column of the derivatives and a block of rows, in tenths of an instruction:
/// 3 ns.
pub const BLOCK_COLUMN_COST: usize = 270;
