//! General registers of machine code: addresses of constants, workspace, inputs and results.

use super::encoding::*;
use super::{FRAME, Writer};

/// General registers of a function.
#[derive(Clone, Copy)]
pub struct GeneralRegisterRoles {
    /// Address of the constants, plus [`BIAS`] bytes.
    pub constants: u8,
    pub more: u8,
    pub results: u8,
    pub inputs: u8,
    pub tables: u8,
    /// Registers that hold the addresses of inputs.
    pub pointers: &'static [u8],
    /// Registers whose values calls preserve, in the order in which they are pushed.
    pub saved: &'static [u8],
}

/// Registers of functions that call others: values that are needed after a call are in registers that calls
/// preserve.
pub const CALLING: GeneralRegisterRoles = GeneralRegisterRoles {
    constants: RBX,
    more: 12,
    results: 13,
    inputs: 14,
    tables: 15,
    pointers: &[RAX, RCX, RDX, RSI, RDI, 8, 9, 10, 11],
    saved: &[RBX, FRAME, 12, 13, 14, 15],
};
/// Registers of functions that call none, except for large angles: the arguments stay where they are.
pub const LEAF: GeneralRegisterRoles = GeneralRegisterRoles {
    constants: RSI,
    more: 8,
    results: RCX,
    inputs: RDI,
    tables: RDX,
    pointers: &[RAX, RDX, 9, 10, 11],
    saved: &[FRAME],
};

impl GeneralRegisterRoles {
    /// Returns the registers that calls may change and whose values are needed afterwards: an even number,
    /// which leaves the stack aligned.
    pub fn registers_to_save_around_calls(self) -> &'static [u8] {
        if self.inputs == LEAF.inputs { &[RSI, 8, RCX, RDI] } else { &[] }
    }
}

/// Address of an input in a register.
pub struct InputAddressInRegister {
    /// Index of the input.
    pub slot: usize,
    /// Number of the last use of the address.
    pub last: usize,
}

impl Writer<'_> {
    /// Returns the general register with the address of an input, which is loaded if it is in no register.
    /// If there are too few registers, the least recently used address is overwritten: those of the operands
    /// of one instruction stay.
    pub fn register_with_input_address(&mut self, slot: usize) -> u8 {
        let GeneralRegisterRoles { pointers, inputs, .. } = self.registers;
        let known = self.pointers.iter().position(|known| known.slot == slot);
        let at = known.unwrap_or_else(|| {
            let count = self.pointers.len();
            let at = match count < pointers.len() {
                true => count,
                false => (0..count).min_by_key(|k| self.pointers[*k].last).unwrap_or(0),
            };
            self.code.write_general_register_load(pointers[at], inputs, 8 * slot as i32);
            at
        });
        self.uses += 1;
        let pointer = InputAddressInRegister { slot, last: self.uses };
        match self.pointers.get_mut(at) {
            Some(known) => *known = pointer,
            None => self.pointers.push(pointer),
        }
        pointers[at]
    }
}
