//! Encoding of instructions for x86-64 with AVX2 and FMA.

// General registers. Addresses with the first eight take fewer bytes.
pub const RAX: u8 = 0;
pub const RCX: u8 = 1;
pub const RDX: u8 = 2;
pub const RBX: u8 = 3;
pub const RSP: u8 = 4;
pub const RBP: u8 = 5;
pub const RSI: u8 = 6;
pub const RDI: u8 = 7;

/// Operand of an instruction: a vector register, or memory at a general register and an offset.
#[derive(Clone, Copy)]
pub enum Rm {
    Register(u8),
    Memory(u8, i32),
}

/// Encoding of an instruction: opcode, map of opcodes, prefix, and the bits W and L.
#[derive(Clone, Copy)]
pub struct Encoding {
    pub opcode: u8,
    map: u8,
    prefix: u8,
    wide: bool,
    long: bool,
}

/// An instruction on one number.
const fn scalar_encoding(opcode: u8) -> Encoding {
    Encoding { opcode, map: 1, prefix: 3, wide: false, long: false }
}

/// An instruction on the bits of a register.
const fn packed_encoding(opcode: u8) -> Encoding {
    Encoding { opcode, map: 1, prefix: 1, wide: false, long: false }
}

/// A fused product and sum.
pub const fn fused_encoding(opcode: u8) -> Encoding {
    Encoding { opcode, map: 2, prefix: 1, wide: true, long: false }
}

pub const LOAD: Encoding = scalar_encoding(0x10);
pub const STORE: Encoding = scalar_encoding(0x11);
pub const ADD: Encoding = scalar_encoding(0x58);
pub const MULTIPLY: Encoding = scalar_encoding(0x59);
pub const SUBTRACT: Encoding = scalar_encoding(0x5C);
pub const DIVIDE: Encoding = scalar_encoding(0x5E);
pub const SQUARE_ROOT: Encoding = scalar_encoding(0x51);
pub const MOVE: Encoding = packed_encoding(0x28);
pub const AND: Encoding = packed_encoding(0x54);
pub const XOR: Encoding = packed_encoding(0x57);
pub const OR: Encoding = packed_encoding(0x56);
/// Comparison of lanes, followed by a byte for the kind of comparison.
pub const COMPARE: Encoding = packed_encoding(0xC2);
/// Shift of whole lanes by a constant, followed by a byte. The field of the register is part of the opcode.
pub const SHIFT: Encoding = packed_encoding(0x73);
/// Sets the flag of zero if no bit of both operands is set.
pub const TEST: Encoding = Encoding { opcode: 0x17, map: 2, prefix: 1, wide: false, long: false };
/// Lanes of the second operand where the sign of a mask is set, otherwise of the first; followed by a byte
/// with the mask's register.
pub const BLEND: Encoding = Encoding { opcode: 0x4B, map: 3, prefix: 1, wide: false, long: false };
/// Moves of lanes: copies of a number to two lanes, and to four.
pub const COPY_TO_TWO: Encoding = Encoding { opcode: 0x12, map: 1, prefix: 3, wide: false, long: false };
/// Second lanes of two registers, and first lanes.
pub const SECOND_LANES: Encoding = packed_encoding(0x15);
pub const FIRST_LANES: Encoding = packed_encoding(0x14);
/// Replaces the second lane by a number in memory, and stores the second lane.
pub const LOAD_SECOND: Encoding = packed_encoding(0x16);
pub const STORE_SECOND: Encoding = packed_encoding(0x17);
/// Moves to and from the upper two of four lanes, followed by a byte.
pub const INSERT_UPPER: Encoding = Encoding { opcode: 0x18, map: 3, prefix: 1, wide: false, long: true };
pub const EXTRACT_UPPER: Encoding = Encoding { opcode: 0x19, map: 3, prefix: 1, wide: false, long: true };
pub const BROADCAST: Encoding = Encoding { opcode: 0x19, map: 2, prefix: 1, wide: false, long: true };
pub const STORE_FOUR: Encoding = Encoding { opcode: 0x11, map: 1, prefix: 1, wide: false, long: true };

/// Returns the form of an instruction on a number of lanes.
pub fn encoding_on_lanes(code: Encoding, width: usize) -> Encoding {
    match width {
        1 => code,
        // The opcodes of fused products, which alone have the bit W, differ by one.
        _ => Encoding { opcode: code.opcode - u8::from(code.wide), prefix: 1, long: width == 4, ..code },
    }
}

/// Machine code under construction.
#[derive(Default)]
pub struct Assembler {
    pub bytes: Vec<u8>,
    /// Whether upper halves of registers were written since they were cleared.
    long: bool,
}

impl Assembler {
    /// Clears the upper halves of registers, which would slow other code down.
    pub fn write_vzeroupper(&mut self) {
        if std::mem::take(&mut self.long) {
            self.bytes.extend([0xC5, 0xF8, 0x77]); // vzeroupper
        }
    }

    /// Loads numbers into lanes, or copies a register.
    pub fn load(&mut self, to: u8, from: Rm, width: usize) {
        match from {
            Rm::Register(register) if register == to => {}
            Rm::Register(_) => self.write_vex_instruction(encoding_on_lanes(MOVE, width), to, 0, from),
            Rm::Memory(..) => self.write_vex_instruction(encoding_on_lanes(LOAD, width), to, 0, from),
        }
    }

    /// Writes an instruction with a prefix VEX: result, first and second operand.
    pub fn write_vex_instruction(&mut self, code: Encoding, register: u8, first: u8, second: Rm) {
        let Encoding { opcode, map, prefix, wide, long } = code;
        self.long |= long;
        let base = match second {
            Rm::Register(base) | Rm::Memory(base, _) => base,
        };
        let short = map == 1 && !wide && base < 8;
        let inverted_register_bit = |register: u8| if register < 8 { 0x80 } else { 0 };
        let last = (!first & 15) << 3 | u8::from(long) << 2 | prefix;
        match short {
            true => self.bytes.extend([0xC5, inverted_register_bit(register) | last]),
            false => {
                let extensions = inverted_register_bit(register) | 0x40 | inverted_register_bit(base) >> 2;
                self.bytes.extend([0xC4, extensions | map, u8::from(wide) << 7 | last]);
            }
        }
        self.bytes.push(opcode);
        self.write_operand_address(register, second);
    }

    /// Writes the bytes that address operands.
    fn write_operand_address(&mut self, register: u8, second: Rm) {
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

    /// Writes an instruction of one byte for a general register.
    pub fn write_general_register_instruction(&mut self, opcode: u8, register: u8) {
        if register >= 8 {
            self.bytes.push(0x41);
        }
        self.bytes.push(opcode | register & 7);
    }

    /// Writes an instruction on a general register and memory, 64 bits wide.
    pub fn write_general_register_load(&mut self, to: u8, base: u8, offset: i32) {
        self.write_wide_opcode(0x8B, to, base);
        self.write_operand_address(to, Rm::Memory(base, offset));
    }

    pub fn write_effective_address_load(&mut self, to: u8, base: u8, offset: i32) {
        self.write_wide_opcode(0x8D, to, base);
        self.write_operand_address(to, Rm::Memory(base, offset));
    }

    pub fn write_general_register_copy(&mut self, to: u8, from: u8) {
        self.write_wide_opcode(0x8B, to, from);
        self.write_operand_address(to, Rm::Register(from));
    }

    fn write_wide_opcode(&mut self, opcode: u8, register: u8, base: u8) {
        self.bytes.extend([0x48 | (register >> 3) << 2 | base >> 3, opcode]);
    }

    pub fn write_move_immediate(&mut self, to: u8, value: u64) {
        self.bytes.extend([0x48 | to >> 3, 0xB8 | to & 7]);
        self.bytes.extend(value.to_le_bytes());
    }

    pub fn add_to_stack_pointer(&mut self, bytes: i32) {
        if bytes != 0 {
            self.bytes.extend([0x48, 0x81, 0xC4]);
            self.bytes.extend(bytes.to_le_bytes());
        }
    }
}
