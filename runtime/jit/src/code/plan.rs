//! Translation of programs to steps on registers and memory, from which machine code is generated.
//!
//! There are few registers and many values. Instructions come in an order with few live values. If there is
//! no register for a value, the one whose next use is last goes to memory (Belady 1966), from where
//! instructions read it. Inputs, constants, sines and cosines are always in memory.

mod angles;
mod registers;

use super::pieces::ProgramInPieces;
use crate::layout::InputLayout;
pub use angles::AngleGroup;
use linkwork_compiler::expr::Function;
use linkwork_compiler::lower::{Angles, Op, Operand, Program};
use std::collections::{BTreeMap, HashMap};

/// Maximum number of lanes of a register.
pub const WIDEST: usize = 4;

/// Location of a number in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryLocation {
    /// Entry of an input: the index of the input, and the index of the entry in it.
    Input(usize, usize),
    /// Constant with this index.
    Constant(usize),
    /// Entry of the array of angles, sines and cosines, which is laid out by groups: see [`AngleGroup`].
    Angle(usize),
    /// Output with this index.
    Output(usize),
    /// Entry of the workspace with this index.
    Work(usize),
}

/// Location of a number, in a register or in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Register with this index, counted from zero.
    Register(u8),
    /// Location in memory.
    Memory(MemoryLocation),
}

#[cfg(any(test, target_arch = "aarch64"))]
impl Place {
    /// Returns the place of the number `k` places further on in memory.
    fn offset_place(self, k: usize) -> Place {
        match self {
            Place::Memory(MemoryLocation::Input(slot, index)) => {
                Place::Memory(MemoryLocation::Input(slot, index + k))
            }
            other => other,
        }
    }
}

/// A step of machine code. The numbers of lanes are one, two or four.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// Loads numbers into the lanes of a register: register, memory, and number of lanes.
    Load(u8, MemoryLocation, usize),
    /// Stores the first lanes of a register: register, memory, and number of lanes.
    Store(u8, MemoryLocation, usize),
    /// Stores the second lane of a register.
    StoreSecond(u8, MemoryLocation),
    /// Copies numbers from memory to memory, with their count.
    Copy(MemoryLocation, MemoryLocation, usize),
    /// Copies a constant to consecutive outputs: the constant, the first output, and their number.
    Fill(usize, usize, usize),
    /// An operation on places with its number of lanes. The result is in a register, also in that of an
    /// operand. No other register has a value if the operation is a call.
    Operation(Op, u8, [Place; 3], usize),
    /// Computes sines and cosines of all groups of angles. No register has a value except angles.
    Sines,
}

/// Whether machine code calls a function for this operation.
pub fn needs_function_call(op: &Op) -> bool {
    match op {
        Op::Call(f, _) => !matches!(f, Function::Sqrt | Function::Abs),
        Op::Atan2(..) | Op::Pow(..) | Op::Extreme(..) | Op::Table(..) => true,
        _ => false,
    }
}

/// Plan of a program: its steps, and the memory that they use.
pub struct ProgramPlan {
    pub steps: Vec<Step>,
    pub constants: Vec<f64>,
    /// Minimum length of each input of the program.
    pub lengths: Vec<usize>,
    /// Number of lookup tables of the program.
    pub tables: usize,
    /// Number of outputs of the program.
    pub outputs: usize,
    /// Groups of angles whose sines and cosines the program needs.
    pub angles: Vec<AngleGroup>,
    /// Number of entries of the program's workspace.
    pub work: usize,
}

impl ProgramPlan {
    /// Plans a program whose first `results` outputs are its results, for a number of registers.
    pub fn new(
        pieces: ProgramInPieces,
        layout: &InputLayout,
        results: usize,
        registers: u8,
    ) -> Result<ProgramPlan, String> {
        // The results of derivatives are two matrices, whose corresponding entries share most values.
        let halves = [results / 2, results - results / 2];
        let ProgramInPieces { program, widths } = &pieces.with_few_live_values(&halves);
        let n = program.instructions.len();
        let mut planner = Planner {
            program,
            widths,
            layout,
            plan: ProgramPlan {
                steps: Vec::new(),
                constants: Vec::new(),
                lengths: vec![0; layout.len()],
                tables: 0,
                outputs: program.outputs.len(),
                angles: Vec::new(),
                work: 0,
            },
            known: HashMap::new(),
            sines: HashMap::new(),
            uses: vec![Vec::new(); n],
            values: vec![None; registers.into()],
            places: vec![None; n],
            free: Default::default(),
        };
        let angles = Angles::find_angles(program);
        planner.plan_angles(&angles)?;
        planner.plan_outputs(results)?;
        // The angles follow the work space.
        planner.plan.work = planner.plan.work.next_multiple_of(WIDEST);
        Ok(planner.plan)
    }

    /// Returns the number of angles, including padding.
    pub fn angle_count(&self) -> usize {
        self.angles.iter().map(AngleGroup::width).sum()
    }
}

struct Planner<'a> {
    program: &'a Program,
    /// Number of lanes of each value.
    widths: &'a [usize],
    layout: &'a InputLayout,
    plan: ProgramPlan,
    /// Indices of the constants, by the bits of their lanes.
    known: HashMap<Vec<u64>, usize>,
    /// Positions of sines and cosines that are computed together, and of their lanes.
    sines: HashMap<usize, usize>,
    /// Indices of the instructions that use each value, the last one first.
    uses: Vec<Vec<usize>>,
    /// Index of the value in each register, if any.
    values: Vec<Option<usize>>,
    /// Register, and location in memory, of each value.
    places: Vec<Option<Residence>>,
    /// Entries of the work space without a value, by their numbers of lanes.
    free: BTreeMap<usize, Vec<usize>>,
}

/// Store of lanes of a value.
#[derive(Clone, Copy)]
enum LaneStore {
    /// Stores the first lanes, with their number.
    First(MemoryLocation, usize),
    /// Stores the second lane.
    Second(MemoryLocation),
}

/// Register and location in memory of a value; at least one of them exists.
#[derive(Clone, Copy, Default)]
struct Residence {
    register: Option<u8>,
    memory: Option<MemoryLocation>,
}

impl Planner<'_> {
    /// Plans the outputs.
    fn plan_outputs(&mut self, results: usize) -> Result<(), String> {
        let (program, n) = (self.program, self.program.instructions.len());
        let mut stores = vec![Vec::new(); n];
        let mut live = vec![false; n];
        let is_operand = self.operand_flags_of_values();
        for (k, output) in program.outputs.iter().enumerate() {
            match *output {
                Operand::Value(at) if !self.sines.contains_key(&at) => {
                    let (at, target) = match program.instructions[at] {
                        Op::Lane(1, Operand::Value(whole)) if !is_operand[at] => {
                            (whole, LaneStore::Second(MemoryLocation::Output(k)))
                        }
                        _ => (at, LaneStore::First(MemoryLocation::Output(k), 1)),
                    };
                    stores[at].push(target);
                    live[at] = true;
                }
                Operand::Const(c) => {
                    let constant = self.find_or_add_constants(&[c]);
                    match self.plan.steps.last_mut() {
                        // Results and further outputs are not adjacent.
                        Some(Step::Fill(known, first, count))
                            if *known == constant && *first + *count == k && k != results =>
                        {
                            *count += 1;
                        }
                        _ => self.plan.steps.push(Step::Fill(constant, k, 1)),
                    }
                }
                other => {
                    let from = self.memory_of_leaf_operand(other)?;
                    self.plan.steps.push(Step::Copy(from, MemoryLocation::Output(k), 1));
                }
            }
        }
        for k in (0..n).rev() {
            live[k] &= !self.sines.contains_key(&k);
            if live[k] {
                program.instructions[k].visit_operands(|operand| {
                    if let Operand::Value(j) = operand {
                        live[j] = true;
                    }
                });
            }
        }
        stores.iter_mut().for_each(|targets| join_adjacent_stores(targets, results));
        self.plan_instructions(&live, &stores)
    }

    /// Returns for each value whether an instruction uses it.
    fn operand_flags_of_values(&self) -> Vec<bool> {
        let mut is_operand = vec![false; self.program.instructions.len()];
        for op in &self.program.instructions {
            op.visit_operands(|operand| {
                if let Operand::Value(k) = operand {
                    is_operand[k] = true;
                }
            });
        }
        is_operand
    }

    /// Plans instructions and the stores of their values.
    fn plan_instructions(&mut self, live: &[bool], stores: &[Vec<LaneStore>]) -> Result<(), String> {
        let n = self.program.instructions.len();
        self.places.fill(None);
        for k in (0..n).rev().filter(|k| live[*k]) {
            for j in self.values_used_by_instruction(k) {
                self.uses[j].push(k);
            }
        }
        for k in (0..n).filter(|k| live[*k]) {
            self.plan_instruction(k, &stores[k])?;
        }
        Ok(())
    }

    /// Returns the values that an instruction uses, without sines and cosines, which are computed before.
    fn values_used_by_instruction(&self, k: usize) -> Vec<usize> {
        let mut list = Vec::with_capacity(3);
        self.program.instructions[k].visit_operands(|operand| {
            if let Operand::Value(j) = operand
                && !self.sines.contains_key(&j)
                && !list.contains(&j)
            {
                list.push(j);
            }
        });
        list
    }
}

/// Joins the stores of a value's first and second lane in adjacent outputs.
fn join_adjacent_stores(targets: &mut Vec<LaneStore>, results: usize) {
    let seconds: Vec<usize> = (targets.iter())
        .filter_map(|target| match target {
            LaneStore::Second(MemoryLocation::Output(k)) => Some(*k),
            _ => None,
        })
        .collect();
    let mut joined = Vec::new();
    for target in targets.iter_mut() {
        if let LaneStore::First(MemoryLocation::Output(k), width @ 1) = target
            && *k + 1 != results
            && seconds.contains(&(*k + 1))
        {
            *width = 2;
            joined.push(*k + 1);
        }
    }
    targets.retain(
        |target| !matches!(target, LaneStore::Second(MemoryLocation::Output(k)) if joined.contains(k)),
    );
}
