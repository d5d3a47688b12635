//! Machine code for x86-64 with AVX2 and FMA, in the calling convention of System V.

mod encoding;
mod general;
mod sines;

use super::plan::{MemoryLocation, Place, ProgramPlan, Step, needs_function_call};
use encoding::*;
use general::{CALLING, GeneralRegisterRoles, InputAddressInRegister, LEAF};
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
type HelperLookup = fn(&str) -> Option<*const u8>;

/// Register with the address of workspace and angles, plus [`BIAS`] bytes.
const FRAME: u8 = RBP;

/// Distance of an address register's value from the start of its memory, bytes: displacements of one byte are
/// signed, so that this centres their range.
const BIAS: i32 = 128;
/// Alignment of the work space, of which [`BIAS`] is a multiple.
const ALIGNMENT: i32 = 32;
/// Distance of stores to a stack that may grow.
const PAGE: i32 = 4096;

/// Writes the code of a plan. Further constants are appended to those of the plan.
pub fn write(plan: &mut ProgramPlan, results: usize, helpers: HelperLookup) -> Result<Vec<u8>, String> {
    // Masks of the sign and of everything else, for whole registers.
    let masks = plan.constants.len().next_multiple_of(4);
    plan.constants.resize(masks, 0.0);
    plan.constants.extend([1 << 63; 4].map(f64::from_bits));
    plan.constants.extend([!(1 << 63); 4].map(f64::from_bits));
    if !plan.angles.is_empty() {
        plan.constants.extend(sines::constants());
    }
    if plan.constants.len().max(plan.outputs) > 1 << 24 {
        return Err("a program is too long".to_string());
    }
    let plan = &*plan;
    let is_call_step = |step: &Step| matches!(step, Step::Operation(op, _, _, 1) if needs_function_call(op));
    let registers = if plan.steps.iter().any(is_call_step) { CALLING } else { LEAF };
    let (code, pointers) = (Assembler::default(), Vec::new());
    let mut writer = Writer { code, plan, results, masks, helpers, registers, pointers, uses: 0, slow: None };
    let frame = writer.write_prologue()?;
    plan.steps.iter().try_for_each(|step| writer.write_step(*step))?;
    writer.write_epilogue(frame);
    writer.write_large_angle_code()?;
    Ok(writer.code.bytes)
}

struct Writer<'a> {
    code: Assembler,
    plan: &'a ProgramPlan,
    results: usize,
    /// Index of the sign masks among the constants.
    masks: usize,
    helpers: HelperLookup,
    registers: GeneralRegisterRoles,
    /// Inputs whose addresses are in registers, in the order of [`GeneralRegisterRoles::pointers`].
    pointers: Vec<InputAddressInRegister>,
    /// Number of addresses of inputs that were used.
    uses: usize,
    /// Jump to the code for large angles, which follows that of the function.
    slow: Option<sines::LargeAngleJump>,
}

impl Writer<'_> {
    /// Writes the prologue of the function. Returns the size of its stack frame, bytes.
    fn write_prologue(&mut self) -> Result<i32, String> {
        let GeneralRegisterRoles { constants, more, results, inputs, tables, saved, .. } = self.registers;
        saved.iter().for_each(|register| self.code.write_general_register_instruction(0x50, *register));
        let numbers = self.plan.work + 3 * self.plan.angle_count();
        // The saved registers and the address of the caller: with them the stack is aligned to 16 bytes. The
        // work space in it is aligned to registers.
        let odd = 8 * (1 + saved.len()) % 16;
        let frame = i32::try_from((8 * numbers).next_multiple_of(16) + ALIGNMENT as usize + odd);
        let frame = frame.ok().filter(|frame| *frame < 1 << 20).ok_or("a program has too many values")?;
        for _ in 0..frame / PAGE {
            self.code.add_to_stack_pointer(-PAGE);
            self.code.bytes.extend([0x89, 0x04, 0x24]); // mov [rsp], eax
        }
        self.code.add_to_stack_pointer(-(frame % PAGE));
        self.code.write_effective_address_load(FRAME, RSP, BIAS + ALIGNMENT - 1);
        self.code.bytes.extend([0x48, 0x83, 0xE5, -ALIGNMENT as i8 as u8]); // and rbp, -32
        self.code.write_effective_address_load(constants, RSI, BIAS);
        for (to, from) in [(results, RCX), (more, 8), (inputs, RDI), (tables, RDX)] {
            if to != from {
                self.code.write_general_register_copy(to, from);
            }
        }
        Ok(frame)
    }

    fn write_epilogue(&mut self, frame: i32) {
        self.code.write_vzeroupper();
        self.code.add_to_stack_pointer(frame);
        self.registers
            .saved
            .iter()
            .rev()
            .for_each(|register| self.code.write_general_register_instruction(0x58, *register));
        self.code.bytes.push(0xC3);
    }

    fn write_step(&mut self, step: Step) -> Result<(), String> {
        match step {
            Step::Load(to, from, width) => {
                let from = self.memory(from);
                self.code.load(to, from, width);
            }
            Step::Store(from, to, width) => self.store(from, to, width),
            Step::StoreSecond(from, to) => {
                let to = self.memory(to);
                self.code.write_vex_instruction(STORE_SECOND, from, 0, to);
            }
            Step::Copy(from, to, width) => {
                let from = self.memory(from);
                self.code.load(SCRATCH, from, width);
                self.store(SCRATCH, to, width);
            }
            Step::Fill(constant, first, count) => self.store_constant_repeatedly(constant, first, count),
            Step::Operation(op, to, places, 1) if needs_function_call(&op) => {
                self.write_function_call(op, to, places)?
            }
            Step::Operation(op, to, places, width) => {
                let places = places.map(|place| self.operand(place));
                self.write_inline_operation(op, to, places, width)?;
            }
            Step::Sines => self.write_sines()?,
        }
        Ok(())
    }

    fn write_inline_operation(
        &mut self,
        op: Op,
        to: u8,
        [a, b, c]: [Rm; 3],
        width: usize,
    ) -> Result<(), String> {
        match op {
            Op::Add(..) => self.write_commutative(ADD, to, a, b, width),
            Op::Mul(..) => self.write_commutative(MULTIPLY, to, a, b, width),
            Op::Sub(..) => self.write_noncommutative(SUBTRACT, to, a, b, width),
            Op::Div(..) => self.write_noncommutative(DIVIDE, to, a, b, width),
            Op::Neg(_) => self.write_commutative(XOR, to, a, self.constant(self.masks), width),
            Op::Call(Elementary::Abs, _) => {
                self.write_commutative(AND, to, a, self.constant(self.masks + 4), width)
            }
            Op::Call(Elementary::Sqrt, _) => {
                let other = match a {
                    // The form on lanes has no second operand.
                    _ if width > 1 => 0,
                    Rm::Register(register) => register,
                    Rm::Memory(..) => to,
                };
                self.code.write_vex_instruction(encoding_on_lanes(SQUARE_ROOT, width), to, other, a);
            }
            // The opcodes of the forms differ by constants.
            Op::MulAdd(..) => self.write_fused_product(0x99, to, [a, b, c], width),
            Op::MulSub(..) => self.write_fused_product(0x9B, to, [a, b, c], width),
            Op::NegMulAdd(..) => self.write_fused_product(0x9D, to, [a, b, c], width),
            Op::Lane(k, _) => self.write_lane_move(k, to, a, width),
            Op::Join(1, ..) => self.write_join_of_numbers(to, a, b),
            Op::Join(2, ..) => self.write_join_of_pairs(to, a, b),
            _ => return Err("an operation has no instruction".to_string()),
        }
        Ok(())
    }

    /// Writes the move of the lanes from lane `k` on, or of the first lane to all lanes.
    fn write_lane_move(&mut self, k: usize, to: u8, from: Rm, width: usize) {
        match (k, from) {
            (0, from) => match width {
                2 => self.code.write_vex_instruction(COPY_TO_TWO, to, 0, from),
                _ => self.code.write_vex_instruction(BROADCAST, to, 0, from),
            },
            (k, Rm::Memory(base, offset)) => {
                self.code.load(to, Rm::Memory(base, offset + 8 * k as i32), width)
            }
            (1, Rm::Register(register)) => self.code.write_vex_instruction(SECOND_LANES, to, register, from),
            (_, Rm::Register(register)) => {
                self.code.write_vex_instruction(EXTRACT_UPPER, register, 0, Rm::Register(to));
                self.code.bytes.push(1);
            }
        }
    }

    /// Writes the join of two numbers.
    fn write_join_of_numbers(&mut self, to: u8, a: Rm, b: Rm) {
        match (a, b) {
            (Rm::Register(first), Rm::Register(_)) => {
                self.code.write_vex_instruction(FIRST_LANES, to, first, b)
            }
            (Rm::Memory(..), Rm::Register(_)) => {
                self.code.load(SCRATCH, a, 1);
                self.code.write_vex_instruction(FIRST_LANES, to, SCRATCH, b);
            }
            (Rm::Register(first), Rm::Memory(..)) => {
                self.code.write_vex_instruction(LOAD_SECOND, to, first, b)
            }
            (Rm::Memory(..), Rm::Memory(..)) => {
                self.code.load(to, a, 1);
                self.code.write_vex_instruction(LOAD_SECOND, to, to, b);
            }
        }
    }

    /// Writes the join of two pairs of numbers.
    fn write_join_of_pairs(&mut self, to: u8, a: Rm, b: Rm) {
        let first = match a {
            Rm::Register(first) => first,
            Rm::Memory(..) => {
                self.code.load(SCRATCH, a, 2);
                SCRATCH
            }
        };
        self.code.write_vex_instruction(INSERT_UPPER, to, first, b);
        self.code.bytes.push(1);
    }

    /// Writes an instruction whose operands can be exchanged.
    fn write_commutative(&mut self, code: Encoding, to: u8, a: Rm, b: Rm, width: usize) {
        let code = encoding_on_lanes(code, width);
        match (a, b) {
            (Rm::Register(a), b) => self.code.write_vex_instruction(code, to, a, b),
            (a, Rm::Register(b)) => self.code.write_vex_instruction(code, to, b, a),
            (a, b) => {
                self.code.load(to, a, width);
                self.code.write_vex_instruction(code, to, to, b);
            }
        }
    }

    fn write_noncommutative(&mut self, code: Encoding, to: u8, a: Rm, b: Rm, width: usize) {
        let code = encoding_on_lanes(code, width);
        let first = match a {
            Rm::Register(a) => a,
            Rm::Memory(..) => {
                self.code.load(SCRATCH, a, width);
                SCRATCH
            }
        };
        self.code.write_vex_instruction(code, to, first, b);
    }

    /// Writes a fused product and sum. `first` is the opcode of the form with the factor and the sum in
    /// exchanged places (132); 16 more is that of a product with the result's register (213), 32 more of a
    /// sum in the result's register (231).
    fn write_fused_product(&mut self, first: u8, to: u8, [a, b, c]: [Rm; 3], width: usize) {
        use Rm::{Memory, Register};
        let [exchanged, product, sum] =
            [0, 16, 32].map(|more| encoding_on_lanes(fused_encoding(first + more), width));
        let is_destination_register = |rm: Rm| matches!(rm, Register(register) if register == to);
        // A factor in the result's register, or otherwise one in memory, comes first.
        let [a, b] = match (a, b) {
            (a, b) if is_destination_register(b) && !is_destination_register(a) => [b, a],
            (Register(_), Memory(..)) if !is_destination_register(a) => [b, a],
            factors => [factors.0, factors.1],
        };
        let keeps_sum = is_destination_register(c) || !is_destination_register(a) && matches!(c, Memory(..));
        if keeps_sum || matches!((a, b), (Register(first), Register(second)) if first != to && second != to) {
            if !is_destination_register(c) {
                self.code.load(to, c, width);
            }
            match (a, b) {
                (a, Register(b)) => self.code.write_vex_instruction(sum, to, b, a),
                (a, b) => {
                    self.code.load(SCRATCH, a, width);
                    self.code.write_vex_instruction(sum, to, SCRATCH, b);
                }
            }
            return;
        }
        if !is_destination_register(a) {
            self.code.load(to, a, width);
        }
        match (b, c) {
            (Register(b), c) => self.code.write_vex_instruction(product, to, b, c),
            (b, Register(c)) => self.code.write_vex_instruction(exchanged, to, c, b),
            (b, c) => {
                self.code.load(SCRATCH, b, width);
                self.code.write_vex_instruction(product, to, SCRATCH, c);
            }
        }
    }

    /// Writes a call of a function whose arguments are numbers in memory.
    fn write_function_call(&mut self, op: Op, to: u8, places: [Place; 3]) -> Result<(), String> {
        let (name, count) = match op {
            Op::Call(f, _) => (f.function_name(), 1),
            Op::Atan2(..) => ("atan2", 2),
            Op::Pow(..) => ("pow", 2),
            Op::Extreme(Extreme::Min, ..) => ("min", 2),
            Op::Extreme(Extreme::Max, ..) => ("max", 2),
            Op::Table(lookup, ..) => {
                self.code.write_general_register_copy(RDI, self.registers.tables);
                self.code.write_move_immediate(RSI, lookup.table_index() as u64);
                let orders = (0..lookup.variable_count())
                    .fold(0, |all, k| all | lookup.derivative_order(k) << (2 * k));
                self.code.write_move_immediate(RDX, orders as u64);
                ("lookup", 3)
            }
            _ => return Err("an operation calls nothing".to_string()),
        };
        self.pointers.clear();
        // The registers of the arguments hold no addresses.
        self.pointers.extend([(); 5].map(|()| InputAddressInRegister { slot: usize::MAX, last: usize::MAX }));
        for (register, place) in (0..).zip(&places[..count]) {
            let from = self.operand(*place);
            self.code.load(register, from, 1);
        }
        self.write_helper_call(name)?;
        if to != 0 {
            self.code.load(to, Rm::Register(0), 1);
        }
        Ok(())
    }

    /// Writes a call of a function, after which no address of an input is in a register.
    fn write_helper_call(&mut self, name: &str) -> Result<(), String> {
        let address = (self.helpers)(name).ok_or("a function is missing")?;
        self.code.write_vzeroupper();
        self.code.write_move_immediate(RAX, address as u64);
        self.code.bytes.extend([0xFF, 0xD0]);
        self.pointers.clear();
        Ok(())
    }

    fn store_constant_repeatedly(&mut self, constant_: usize, first: usize, count: usize) {
        let long = count >= 4;
        let code = if long { BROADCAST } else { LOAD };
        let from = self.memory(MemoryLocation::Constant(constant_));
        self.code.write_vex_instruction(code, SCRATCH, 0, from);
        let mut at = first;
        while at < first + count {
            let rest = first + count - at;
            let to = self.memory(MemoryLocation::Output(at));
            let code = if rest >= 4 { STORE_FOUR } else { STORE };
            self.code.write_vex_instruction(code, SCRATCH, 0, to);
            at += if rest >= 4 { 4 } else { 1 };
        }
    }

    /// Returns the operand of an instruction for a place.
    fn operand(&mut self, place: Place) -> Rm {
        match place {
            Place::Register(register) => Rm::Register(register),
            Place::Memory(memory) => self.memory(memory),
        }
    }

    /// Returns the address operand of a number in memory; loads the address of an input that is in no
    /// register.
    fn memory(&mut self, memory: MemoryLocation) -> Rm {
        let byte_offset = |index: usize| 8 * index as i32;
        match memory {
            MemoryLocation::Constant(k) => self.constant(k),
            MemoryLocation::Work(k) => Rm::Memory(FRAME, byte_offset(k) - BIAS),
            MemoryLocation::Angle(k) => Rm::Memory(FRAME, byte_offset(self.plan.work + k) - BIAS),
            MemoryLocation::Output(k) if k < self.results => {
                Rm::Memory(self.registers.results, byte_offset(k))
            }
            MemoryLocation::Output(k) => Rm::Memory(self.registers.more, byte_offset(k - self.results)),
            MemoryLocation::Input(slot, index) => {
                Rm::Memory(self.register_with_input_address(slot), byte_offset(index))
            }
        }
    }

    fn store(&mut self, from: u8, to: MemoryLocation, width: usize) {
        let to = self.memory(to);
        self.code.write_vex_instruction(encoding_on_lanes(STORE, width), from, 0, to);
    }

    fn constant(&self, index: usize) -> Rm {
        Rm::Memory(self.registers.constants, 8 * index as i32 - BIAS)
    }
}
