//! Machine code for x86-64 with AVX2 and FMA, in the calling convention of System V.

use super::plan::{Allocation, Memory, Place, Step, is_call};
use linkwork_compiler::expr::{Extreme, Function as Elementary};
use linkwork_compiler::lower::Op;

/// Number of registers for values of a plan. The last of the sixteen holds operands that cannot be in memory.
pub const REGISTERS: u8 = 15;
const SCRATCH: u8 = 15;

/// Whether the host has the instructions AVX2 and FMA.
pub fn is_supported() -> bool {
    std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
}

/// Function that returns the address of a function by name, for calls from generated code.
type Helpers = fn(&str) -> Option<*const u8>;

// General registers. Addresses with the first eight take fewer bytes; those from `RBX` survive calls.
const RAX: u8 = 0;
const RSP: u8 = 4;
const RBP: u8 = 5;
const RDX: u8 = 2;
const RSI: u8 = 6;
const RDI: u8 = 7;
/// Register with the address of the constants, plus [`BIAS`] bytes.
const CONSTANTS: u8 = 3;
/// Register with the address of workspace and angles, plus [`BIAS`] bytes.
const FRAME: u8 = RBP;
const MORE: u8 = 12;
const RESULTS: u8 = 13;
const INPUTS: u8 = 14;
const TABLES: u8 = 15;
/// Registers whose values calls preserve, in the order in which they are pushed.
const SAVED: [u8; 6] = [CONSTANTS, FRAME, MORE, RESULTS, INPUTS, TABLES];
/// Registers that hold the addresses of inputs.
const POINTERS: [u8; 9] = [0, 1, 2, 6, 7, 8, 9, 10, 11];

/// Distance of an address register's value from the start of its memory, bytes: displacements of one byte are
/// signed, so that this centres their range.
const BIAS: i32 = 128;
/// Maximum distance, bytes, between stores to a stack that grows page by page.
const PAGE: i32 = 4096;

/// Operand of an instruction: a vector register, or memory at a general register and an offset.
#[derive(Clone, Copy)]
enum Rm {
    Register(u8),
    Memory(u8, i32),
}

/// Encoding of an instruction: opcode, map of opcodes, prefix, and the bits W and L.
#[derive(Clone, Copy)]
struct Encoding {
    opcode: u8,
    map: u8,
    prefix: u8,
    wide: bool,
    long: bool,
}

/// Returns the encoding of an instruction on one number.
const fn scalar(opcode: u8) -> Encoding {
    Encoding { opcode, map: 1, prefix: 3, wide: false, long: false }
}

/// Returns the encoding of an instruction on the bits of a register.
const fn packed(opcode: u8) -> Encoding {
    Encoding { opcode, map: 1, prefix: 1, wide: false, long: false }
}

/// Returns the encoding of a fused multiply-add instruction.
const fn fused(opcode: u8) -> Encoding {
    Encoding { opcode, map: 2, prefix: 1, wide: true, long: false }
}

const LOAD: Encoding = scalar(0x10);
const STORE: Encoding = scalar(0x11);
const ADD: Encoding = scalar(0x58);
const MULTIPLY: Encoding = scalar(0x59);
const SUBTRACT: Encoding = scalar(0x5C);
const DIVIDE: Encoding = scalar(0x5E);
const SQUARE_ROOT: Encoding = scalar(0x51);
const MOVE: Encoding = packed(0x28);
const AND: Encoding = packed(0x54);
const XOR: Encoding = packed(0x57);
const BROADCAST: Encoding = Encoding { opcode: 0x19, map: 2, prefix: 1, wide: false, long: true };
const STORE_FOUR: Encoding = Encoding { opcode: 0x11, map: 1, prefix: 1, wide: false, long: true };

/// Writes the machine code of a plan. Further constants are appended to those of the plan.
pub fn write(plan: &mut Allocation, results: usize, helpers: Helpers) -> Result<Vec<u8>, String> {
    // Masks of the sign and of everything else, for whole registers.
    let masks = plan.constants.len();
    plan.constants.extend([1 << 63, 1 << 63, !(1 << 63), !(1 << 63)].map(f64::from_bits));
    if plan.constants.len().max(plan.outputs) > 1 << 24 {
        return Err("a program is too long".to_string());
    }
    let plan = &*plan;
    let mut writer = Writer { bytes: Vec::new(), plan, results, masks, helpers, pointers: Vec::new() };
    let frame = writer.enter()?;
    let mut steps = plan.steps.iter().peekable();
    while let Some(step) = steps.next() {
        writer.step(*step)?;
        if matches!(step, Step::Fill(..)) && !matches!(steps.peek(), Some(Step::Fill(..))) {
            writer.bytes.extend([0xC5, 0xF8, 0x77]); // vzeroupper
        }
    }
    writer.leave(frame);
    Ok(writer.bytes)
}

struct Writer<'a> {
    bytes: Vec<u8>,
    plan: &'a Allocation,
    results: usize,
    /// Index of the sign masks among the constants.
    masks: usize,
    helpers: Helpers,
    /// Inputs whose addresses are in registers, in the order of [`POINTERS`].
    pointers: Vec<usize>,
}

impl Writer<'_> {
    /// Writes the prologue of the function. Returns the size of its stack frame, bytes.
    fn enter(&mut self) -> Result<i32, String> {
        for register in SAVED {
            self.general(0x50, register);
        }
        let numbers = self.plan.work + 3 * self.plan.angles;
        // Six registers and the address of the caller: eight bytes more align the stack.
        let frame = i32::try_from((8 * numbers).next_multiple_of(16) + 8);
        let frame = frame.ok().filter(|frame| *frame < 1 << 20).ok_or("a program has too many values")?;
        for _ in 0..frame / PAGE {
            self.add_to_stack(-PAGE);
            self.bytes.extend([0x89, 0x04, 0x24]); // mov [rsp], eax
        }
        self.add_to_stack(-(frame % PAGE));
        self.address_of(FRAME, RSP, BIAS);
        self.address_of(CONSTANTS, RSI, BIAS);
        self.copy(RESULTS, 1); // rcx
        self.copy(MORE, 8);
        self.copy(INPUTS, RDI);
        self.copy(TABLES, RDX);
        Ok(frame)
    }

    fn leave(&mut self, frame: i32) {
        self.add_to_stack(frame);
        for register in SAVED.into_iter().rev() {
            self.general(0x58, register);
        }
        self.bytes.push(0xC3);
    }

    fn step(&mut self, step: Step) -> Result<(), String> {
        match step {
            Step::Load(to, from) => {
                let from = self.memory(from);
                self.load(to, from);
            }
            Step::Store(from, to) => self.store(from, to),
            Step::Copy(from, to) => {
                let from = self.memory(from);
                self.load(SCRATCH, from);
                self.store(SCRATCH, to);
            }
            Step::Fill(constant, first, count) => self.fill(constant, first, count),
            Step::Operation(op, to, places) if is_call(&op) => self.call_of(op, to, places)?,
            Step::Operation(op, to, places) => {
                let places = places.map(|place| match place {
                    Place::Register(register) => Rm::Register(register),
                    Place::Memory(memory) => self.memory(memory),
                });
                self.operation(op, to, places)?;
            }
            Step::Sines => {
                let Rm::Memory(base, at) = self.memory(Memory::Angle(0)) else { return Ok(()) };
                self.address_of(RDI, base, at);
                self.immediate(RSI, self.plan.angles as u64);
                self.call("sines")?;
            }
        }
        Ok(())
    }

    fn operation(&mut self, op: Op, to: u8, [a, b, c]: [Rm; 3]) -> Result<(), String> {
        match op {
            Op::Add(..) => self.commutative(ADD, to, a, b),
            Op::Mul(..) => self.commutative(MULTIPLY, to, a, b),
            Op::Sub(..) => self.ordered(SUBTRACT, to, a, b),
            Op::Div(..) => self.ordered(DIVIDE, to, a, b),
            Op::Neg(_) => self.commutative(XOR, to, a, constant(self.masks)),
            Op::Call(Elementary::Abs, _) => self.commutative(AND, to, a, constant(self.masks + 2)),
            Op::Call(Elementary::Sqrt, _) => {
                let other = if let Rm::Register(register) = a { register } else { to };
                self.instruction(SQUARE_ROOT, to, other, a);
            }
            // The opcodes of the forms differ by constants.
            Op::MulAdd(..) => self.product(0x99, to, [a, b, c]),
            Op::MulSub(..) => self.product(0x9B, to, [a, b, c]),
            Op::NegMulAdd(..) => self.product(0x9D, to, [a, b, c]),
            _ => return Err("an operation has no instruction".to_string()),
        }
        Ok(())
    }

    /// Writes an instruction whose two operands can be exchanged.
    fn commutative(&mut self, code: Encoding, to: u8, a: Rm, b: Rm) {
        match (a, b) {
            (Rm::Register(a), b) => self.instruction(code, to, a, b),
            (a, Rm::Register(b)) => self.instruction(code, to, b, a),
            (a, b) => {
                self.load(to, a);
                self.instruction(code, to, to, b);
            }
        }
    }

    fn ordered(&mut self, code: Encoding, to: u8, a: Rm, b: Rm) {
        let first = match a {
            Rm::Register(a) => a,
            Rm::Memory(..) => {
                self.load(SCRATCH, a);
                SCRATCH
            }
        };
        self.instruction(code, to, first, b);
    }

    /// Writes a fused multiply-add instruction. `first` is the opcode of the form with the order 132 of its
    /// operands; the opcode is larger by 16 for the order 213 and by 32 for the order 231.
    fn product(&mut self, first: u8, to: u8, [a, b, c]: [Rm; 3]) {
        use Rm::{Memory, Register};
        let [exchanged, product, sum] = [0, 16, 32].map(|more| fused(first + more));
        let is_to = |rm: Rm| matches!(rm, Register(register) if register == to);
        // A factor in the result's register, or otherwise one in memory, comes first.
        let [a, b] = match (a, b) {
            (a, b) if is_to(b) && !is_to(a) => [b, a],
            (Register(_), Memory(..)) if !is_to(a) => [b, a],
            factors => [factors.0, factors.1],
        };
        let keeps_sum = is_to(c) || !is_to(a) && matches!(c, Memory(..));
        if keeps_sum || matches!((a, b), (Register(first), Register(second)) if first != to && second != to) {
            if !is_to(c) {
                self.load(to, c);
            }
            match (a, b) {
                (a, Register(b)) => self.instruction(sum, to, b, a),
                (a, b) => {
                    self.load(SCRATCH, a);
                    self.instruction(sum, to, SCRATCH, b);
                }
            }
            return;
        }
        if !is_to(a) {
            self.load(to, a);
        }
        match (b, c) {
            (Register(b), c) => self.instruction(product, to, b, c),
            (b, Register(c)) => self.instruction(exchanged, to, c, b),
            (b, c) => {
                self.load(SCRATCH, b);
                self.instruction(product, to, SCRATCH, c);
            }
        }
    }

    /// Writes a call of a function whose arguments are numbers in memory.
    fn call_of(&mut self, op: Op, to: u8, places: [Place; 3]) -> Result<(), String> {
        let (name, count) = match op {
            Op::Call(f, _) => (f.function_name(), 1),
            Op::Atan2(..) => ("atan2", 2),
            Op::Pow(..) => ("pow", 2),
            Op::Extreme(Extreme::Min, ..) => ("min", 2),
            Op::Extreme(Extreme::Max, ..) => ("max", 2),
            Op::Table(lookup, ..) => {
                self.copy(RDI, TABLES);
                self.immediate(RSI, lookup.table_index() as u64);
                let orders = (0..lookup.variable_count())
                    .fold(0, |all, k| all | lookup.derivative_order(k) << (2 * k));
                self.immediate(RDX, orders as u64);
                ("lookup", 3)
            }
            _ => return Err("an operation calls nothing".to_string()),
        };
        self.pointers.clear();
        self.pointers.extend([usize::MAX; 5]);
        for (register, place) in (0..).zip(&places[..count]) {
            let from = match *place {
                Place::Register(register) => Rm::Register(register),
                Place::Memory(memory) => self.memory(memory),
            };
            self.load(register, from);
        }
        self.call(name)?;
        if to != 0 {
            self.load(to, Rm::Register(0));
        }
        Ok(())
    }

    /// Writes a call of a function, after which no address of an input is in a register.
    fn call(&mut self, name: &str) -> Result<(), String> {
        let address = (self.helpers)(name).ok_or("a function is missing")?;
        self.immediate(RAX, address as u64);
        self.bytes.extend([0xFF, 0xD0]);
        self.pointers.clear();
        Ok(())
    }

    fn fill(&mut self, constant_: usize, first: usize, count: usize) {
        let long = count >= 4;
        let code = if long { BROADCAST } else { LOAD };
        let from = self.memory(Memory::Constant(constant_));
        self.instruction(code, SCRATCH, 0, from);
        let mut at = first;
        while at < first + count {
            let rest = first + count - at;
            let to = self.memory(Memory::Output(at));
            let code = if rest >= 4 { STORE_FOUR } else { STORE };
            self.instruction(code, SCRATCH, 0, to);
            at += if rest >= 4 { 4 } else { 1 };
        }
    }

    /// Returns the address operand of a number in memory; loads the address of an input that is in no
    /// register.
    fn memory(&mut self, memory: Memory) -> Rm {
        let offset = |index: usize| 8 * index as i32;
        match memory {
            Memory::Constant(k) => constant(k),
            Memory::Work(k) => Rm::Memory(FRAME, offset(k) - BIAS),
            Memory::Angle(k) => Rm::Memory(FRAME, offset(self.plan.work + k) - BIAS),
            Memory::Output(k) if k < self.results => Rm::Memory(RESULTS, offset(k)),
            Memory::Output(k) => Rm::Memory(MORE, offset(k - self.results)),
            Memory::Input(slot, index) => {
                let known = self.pointers.iter().position(|known| *known == slot);
                let at = known.unwrap_or_else(|| {
                    // The last register is overwritten if there are too few.
                    let at = self.pointers.len().min(POINTERS.len() - 1);
                    self.pointers.truncate(at);
                    self.pointers.push(slot);
                    self.load_general(POINTERS[at], INPUTS, offset(slot));
                    at
                });
                Rm::Memory(POINTERS[at], offset(index))
            }
        }
    }

    /// Writes the load of a number from memory, or the copy of a register.
    fn load(&mut self, to: u8, from: Rm) {
        match from {
            Rm::Register(register) if register == to => {}
            Rm::Register(_) => self.instruction(MOVE, to, 0, from),
            Rm::Memory(..) => self.instruction(LOAD, to, 0, from),
        }
    }

    fn store(&mut self, from: u8, to: Memory) {
        let to = self.memory(to);
        self.instruction(STORE, from, 0, to);
    }

    /// Writes an instruction with the prefix VEX: result register, first and second operand.
    fn instruction(&mut self, code: Encoding, register: u8, first: u8, second: Rm) {
        let Encoding { opcode, map, prefix, wide, long } = code;
        let base = match second {
            Rm::Register(base) | Rm::Memory(base, _) => base,
        };
        let short = map == 1 && !wide && base < 8;
        let high = |register: u8| if register < 8 { 0x80 } else { 0 };
        let last = (!first & 15) << 3 | u8::from(long) << 2 | prefix;
        match short {
            true => self.bytes.extend([0xC5, high(register) | last]),
            false => {
                let extensions = high(register) | 0x40 | high(base) >> 2;
                self.bytes.extend([0xC4, extensions | map, u8::from(wide) << 7 | last]);
            }
        }
        self.bytes.push(opcode);
        self.operand(register, second);
    }

    /// Writes the bytes of an instruction that address its operands.
    fn operand(&mut self, register: u8, second: Rm) {
        let fields = (register & 7) << 3;
        match second {
            Rm::Register(other) => self.bytes.push(0xC0 | fields | other & 7),
            Rm::Memory(base, offset) => {
                let short = i8::try_from(offset);
                let kind = match short {
                    Ok(0) if base & 7 != RBP => 0,
                    Ok(_) => 0x40,
                    Err(_) => 0x80,
                };
                self.bytes.push(kind | fields | base & 7);
                if base & 7 == RSP {
                    self.bytes.push(0x24);
                }
                match short {
                    Ok(offset) if kind == 0x40 => self.bytes.push(offset as u8),
                    Ok(_) => {}
                    Err(_) => self.bytes.extend(offset.to_le_bytes()),
                }
            }
        }
    }

    /// Writes an instruction with an opcode of one byte for a general-purpose register.
    fn general(&mut self, opcode: u8, register: u8) {
        if register >= 8 {
            self.bytes.push(0x41);
        }
        self.bytes.push(opcode | register & 7);
    }

    /// Writes an instruction on a general-purpose register and memory, 64 bits wide.
    fn load_general(&mut self, to: u8, base: u8, offset: i32) {
        self.wide(0x8B, to, base);
        self.operand(to, Rm::Memory(base, offset));
    }

    fn address_of(&mut self, to: u8, base: u8, offset: i32) {
        self.wide(0x8D, to, base);
        self.operand(to, Rm::Memory(base, offset));
    }

    fn copy(&mut self, to: u8, from: u8) {
        self.wide(0x8B, to, from);
        self.operand(to, Rm::Register(from));
    }

    fn wide(&mut self, opcode: u8, register: u8, base: u8) {
        self.bytes.extend([0x48 | (register >> 3) << 2 | base >> 3, opcode]);
    }

    fn immediate(&mut self, to: u8, value: u64) {
        self.bytes.extend([0x48 | to >> 3, 0xB8 | to & 7]);
        self.bytes.extend(value.to_le_bytes());
    }

    fn add_to_stack(&mut self, bytes: i32) {
        if bytes != 0 {
            self.bytes.extend([0x48, 0x81, 0xC4]);
            self.bytes.extend(bytes.to_le_bytes());
        }
    }
}

fn constant(index: usize) -> Rm {
    Rm::Memory(CONSTANTS, 8 * index as i32 - BIAS)
}
