//! Translation of programs to steps on registers and memory, from which machine code is generated.
//!
//! There are few registers and many values. Instructions come in an order with few live values. If there is
//! no register for a value, the one whose next use is last goes to memory (Belady 1966), from where
//! instructions read it. Inputs, constants, sines and cosines are always in memory.

use crate::layout::Layout;
use linkwork_compiler::expr::{Function, Symbol};
use linkwork_compiler::lower::{Angles, Op, Operand, Program};
use std::collections::HashMap;

/// Maximum distance, in instructions, to the next use of a value in memory for which it is loaded into a
/// register.
const SOON: usize = 12;
/// Number of angles whose sines and cosines are computed together.
pub const TOGETHER: usize = 8;

/// Location of a number in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Memory {
    /// Entry of an input: the index of the input, and the index of the entry in it.
    Input(usize, usize),
    /// Constant with this index.
    Constant(usize),
    /// Entry of the array of angles, which are followed by their sines, then their cosines.
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
    Memory(Memory),
}

/// Step of machine code on registers and memory.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// Loads a number from memory into a register.
    Load(u8, Memory),
    /// Stores a register to memory.
    Store(u8, Memory),
    /// Copies a number from memory to memory.
    Copy(Memory, Memory),
    /// Copies a constant to consecutive outputs: the constant, the first output, and their number.
    Fill(usize, usize, usize),
    /// Performs an operation on the numbers at these locations. Its result is in a register, which may be
    /// that of an operand. No other register has a value if the operation is a call.
    Operation(Op, u8, [Place; 3]),
    /// Computes the sines and cosines of all angles.
    Sines,
}

/// Whether machine code calls a function for this operation.
pub fn is_call(op: &Op) -> bool {
    match op {
        Op::Call(f, _) => !matches!(f, Function::Sqrt | Function::Abs),
        Op::Atan2(..) | Op::Pow(..) | Op::Extreme(..) | Op::Table(..) => true,
        _ => false,
    }
}

/// Returns the number of angles, including padding, whose sines and cosines are computed for `count` angles.
pub fn padded(count: usize) -> usize {
    match count {
        0..=2 => count,
        3..=4 => 4,
        _ => count.next_multiple_of(TOGETHER),
    }
}

/// Plan of a program: its steps, and the memory that they use.
pub struct Allocation {
    pub steps: Vec<Step>,
    pub constants: Vec<f64>,
    /// Minimum length of each input of the program.
    pub lengths: Vec<usize>,
    /// Number of lookup tables of the program.
    pub tables: usize,
    /// Number of outputs of the program.
    pub outputs: usize,
    /// Number of angles whose sines and cosines the program needs.
    pub angles: usize,
    /// Number of entries of the program's workspace.
    pub work: usize,
}

impl Allocation {
    /// Plans a program whose first `results` outputs are its results, for processors with this number of
    /// registers.
    pub fn new(
        program: &Program,
        layout: &Layout,
        results: usize,
        registers: u8,
    ) -> Result<Allocation, String> {
        // The results of derivatives are two matrices, whose corresponding entries share most values.
        let halves = [results / 2, results - results / 2];
        let program = &program.clone().with_few_live_values(&halves);
        let n = program.instructions.len();
        let mut planner = Planner {
            program,
            layout,
            plan: Allocation {
                steps: Vec::new(),
                constants: Vec::new(),
                lengths: vec![0; layout.len()],
                tables: 0,
                outputs: program.outputs.len(),
                angles: 0,
                work: 0,
            },
            known: HashMap::new(),
            sines: HashMap::new(),
            uses: vec![Vec::new(); n],
            values: vec![None; registers.into()],
            places: vec![None; n],
            free: Vec::new(),
        };
        let angles = Angles::find_angles(program);
        planner.angles(&angles)?;
        planner.body(&angles, results)?;
        Ok(planner.plan)
    }
}

struct Planner<'a> {
    program: &'a Program,
    layout: &'a Layout,
    plan: Allocation,
    /// Index of each constant, by the bits of its value.
    known: HashMap<u64, usize>,
    /// Index of each value that is a sine or cosine among those that are computed together.
    sines: HashMap<usize, usize>,
    /// Indices of the instructions that use each value, the last one first.
    uses: Vec<Vec<usize>>,
    /// Index of the value in each register, if any.
    values: Vec<Option<usize>>,
    /// Register, and location in memory, of each value.
    places: Vec<Option<Residence>>,
    /// Entries of the workspace that contain no value.
    free: Vec<usize>,
}

/// Register and location in memory of a value; at least one of them exists.
#[derive(Clone, Copy, Default)]
struct Residence {
    register: Option<u8>,
    memory: Option<Memory>,
}

impl Planner<'_> {
    /// Plans the computation of the angles, their sines and cosines.
    fn angles(&mut self, angles: &Angles) -> Result<(), String> {
        let list = angles.widest_first(self.program, |_| 1);
        let count = padded(list.len());
        if count == 0 {
            return Ok(());
        }
        let mut stores = vec![Vec::new(); self.program.instructions.len()];
        for at in 0..count {
            // Padding repeats the first angle: no exceptional value slows the others down.
            let to = Memory::Angle(at);
            match list[if at < list.len() { at } else { 0 }].angle {
                Operand::Value(k) => stores[k].push(to),
                other => {
                    let from = self.leaf(other)?;
                    self.plan.steps.push(Step::Copy(from, to));
                }
            }
        }
        self.run(&angles.before, &stores)?;
        self.plan.steps.push(Step::Sines);
        self.plan.angles = count;
        for k in (0..self.program.instructions.len()).filter(|k| angles.covered[*k]) {
            let Op::Call(f, operand) = self.program.instructions[k] else { continue };
            let at = list.iter().position(|angle| angle.angle == operand).ok_or("an angle is missing")?;
            self.sines.insert(k, if f == Function::Sin { count + at } else { 2 * count + at });
        }
        Ok(())
    }

    /// Plans the computation of the outputs.
    fn body(&mut self, angles: &Angles, results: usize) -> Result<(), String> {
        let (program, n) = (self.program, self.program.instructions.len());
        let mut stores = vec![Vec::new(); n];
        let mut live = vec![false; n];
        for (k, output) in program.outputs.iter().enumerate() {
            match *output {
                Operand::Value(at) if !angles.covered[at] => {
                    stores[at].push(Memory::Output(k));
                    live[at] = true;
                }
                Operand::Const(c) => {
                    let constant = self.constant(c);
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
                    let from = self.leaf(other)?;
                    self.plan.steps.push(Step::Copy(from, Memory::Output(k)));
                }
            }
        }
        for k in (0..n).rev() {
            live[k] &= !angles.covered[k];
            if live[k] {
                program.instructions[k].visit_operands(|operand| {
                    if let Operand::Value(j) = operand {
                        live[j] = true;
                    }
                });
            }
        }
        self.run(&live, &stores)
    }

    /// Plans the instructions that are needed (`live`) and the stores of their values.
    fn run(&mut self, live: &[bool], stores: &[Vec<Memory>]) -> Result<(), String> {
        let n = self.program.instructions.len();
        self.places.fill(None);
        for k in (0..n).rev().filter(|k| live[*k]) {
            for j in self.operands(k) {
                self.uses[j].push(k);
            }
        }
        for k in (0..n).filter(|k| live[*k]) {
            self.instruction(k, &stores[k])?;
        }
        Ok(())
    }

    /// Returns the values that an instruction uses, without sines and cosines, which are computed before.
    fn operands(&self, k: usize) -> Vec<usize> {
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

    fn instruction(&mut self, k: usize, stores: &[Memory]) -> Result<(), String> {
        let op = self.program.instructions[k];
        let operands = self.operands(k);
        if is_call(&op) {
            (0..self.values.len()).for_each(|register| self.release(register));
        } else {
            for j in &operands {
                self.load_if_needed_soon(*j, k);
            }
        }
        if let Op::Table(lookup, ..) = op {
            self.plan.tables = self.plan.tables.max(lookup.table_index() + 1);
        }
        let places = self.places_of(op)?;
        // Their memory is not overwritten before the operation.
        let mut ended = Vec::new();
        for j in operands {
            self.uses[j].pop();
            if self.uses[j].is_empty() {
                ended.extend(self.forget(j));
            }
        }
        // The result replaces an operand that is not used again, preferably an addend.
        let dying = places.iter().rev().find_map(|place| match place {
            Place::Register(register) if self.values[usize::from(*register)].is_none() => Some(*register),
            _ => None,
        });
        let to = dying.unwrap_or_else(|| self.take());
        self.plan.steps.push(Step::Operation(op, to, places));
        self.free.extend(ended);
        let mut residence = Residence { register: Some(to), memory: None };
        for memory in stores {
            self.plan.steps.push(Step::Store(to, *memory));
            residence.memory.get_or_insert(*memory);
        }
        if !self.uses[k].is_empty() {
            self.values[usize::from(to)] = Some(k);
            self.places[k] = Some(residence);
        }
        Ok(())
    }

    /// Returns the locations of the operands of an operation. A missing operand repeats the first one.
    fn places_of(&mut self, op: Op) -> Result<[Place; 3], String> {
        let mut list = Vec::with_capacity(3);
        op.visit_operands(|operand| list.push(operand));
        let mut places = Vec::with_capacity(3);
        for operand in list {
            places.push(match operand {
                Operand::Value(k) if !self.sines.contains_key(&k) => {
                    let Residence { register, memory } =
                        self.places[k].ok_or("a value is used before it is computed")?;
                    match register {
                        Some(register) => Place::Register(register),
                        None => Place::Memory(memory.ok_or("a value is nowhere")?),
                    }
                }
                other => Place::Memory(self.leaf(other)?),
            });
        }
        let first = *places.first().ok_or("an operand is missing")?;
        Ok(std::array::from_fn(|k| places.get(k).copied().unwrap_or(first)))
    }

    /// Returns the location in memory of an operand that is not the value of an instruction of the body.
    fn leaf(&mut self, operand: Operand) -> Result<Memory, String> {
        match operand {
            Operand::Const(c) => Ok(Memory::Constant(self.constant(c))),
            Operand::Symbol(symbol) => self.input(symbol),
            Operand::Value(k) => match self.sines.get(&k) {
                Some(at) => Ok(Memory::Angle(*at)),
                None => Err("a value is used before it is computed".to_string()),
            },
            Operand::Tuple(_) | Operand::Gather(_) => Err("a program has lanes".to_string()),
        }
    }

    fn constant(&mut self, c: f64) -> usize {
        let next = self.plan.constants.len();
        let at = *self.known.entry(c.to_bits()).or_insert(next);
        if at == next {
            self.plan.constants.push(c);
        }
        at
    }

    fn input(&mut self, symbol: Symbol) -> Result<Memory, String> {
        let (slot, index) = self.layout.locate(symbol).ok_or("a program reads what it is not given")?;
        self.plan.lengths[slot] = self.plan.lengths[slot].max(index + 1);
        Ok(Memory::Input(slot, index))
    }

    /// Loads a value in memory into a register if an instruction soon after instruction `now` uses it again.
    fn load_if_needed_soon(&mut self, k: usize, now: usize) {
        let next = self.uses[k].iter().rev().nth(1);
        let Some(Residence { register: None, memory: Some(memory) }) = self.places[k] else { return };
        if next.is_some_and(|next| *next <= now + SOON) {
            let register = self.take();
            self.plan.steps.push(Step::Load(register, memory));
            self.values[usize::from(register)] = Some(k);
            self.places[k] = Some(Residence { register: Some(register), memory: Some(memory) });
        }
    }

    /// Returns a free register. If all registers have values, the one whose next use is last is moved to
    /// memory.
    fn take(&mut self) -> u8 {
        let next = |value: Option<usize>| value.and_then(|k| self.uses[k].last().copied());
        let free = self.values.iter().position(Option::is_none);
        let register = free.unwrap_or_else(|| {
            (0..self.values.len()).max_by_key(|register| next(self.values[*register])).unwrap_or(0)
        });
        self.release(register);
        register as u8
    }

    /// Removes the value from a register, and moves it to memory if it is used again.
    fn release(&mut self, register: usize) {
        let Some(k) = self.values[register].take() else { return };
        let Some(residence) = &mut self.places[k] else { return };
        residence.register = None;
        if residence.memory.is_none() {
            let at = self.free.pop().unwrap_or_else(|| {
                self.plan.work += 1;
                self.plan.work - 1
            });
            residence.memory = Some(Memory::Work(at));
            self.plan.steps.push(Step::Store(register as u8, Memory::Work(at)));
        }
    }

    /// Frees the register of a value that is not used again, and returns its entry of the workspace.
    fn forget(&mut self, k: usize) -> Option<usize> {
        let Residence { register, memory } = self.places[k].take()?;
        if let Some(register) = register {
            self.values[usize::from(register)] = None;
        }
        match memory {
            Some(Memory::Work(at)) => Some(at),
            _ => None,
        }
    }
}
