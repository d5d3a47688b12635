//! Sines and cosines of small angles in registers, by the operations of the runtime's `trigonometry` in their
//! order. Larger angles are left to the runtime.

use super::encoding::*;
use super::{MemoryLocation, Writer};
use crate::code::plan::{AngleGroup, WIDEST};
use linkwork::__private::{COSINE, LARGEST_ANGLE, QUARTER_TURN, ROUND, SINE};
use linkwork_compiler::lower::{Op, Operand};
use std::f64::consts::FRAC_2_PI;

/// Jump to the code for large angles: the index of its distance in the code, and the inputs whose addresses
/// are in registers.
pub struct LargeAngleJump {
    distance: usize,
    pointers: Vec<usize>,
}

/// Kind of a comparison: greater, and not NaN.
const GREATER: u8 = 30;

/// Returns the constants of the computation, each in all lanes.
pub fn constants() -> impl Iterator<Item = f64> {
    let first = [LARGEST_ANGLE, FRAC_2_PI, ROUND];
    let all = first.into_iter().chain(QUARTER_TURN).chain(SINE).chain(COSINE).chain([-0.5, 1.0]);
    all.flat_map(|constant| [constant; WIDEST])
}

// Registers of the computation. Those of the sine and the cosine also contain parts of them. No angle of a
// plan is in the first two.
const ANGLE: u8 = 14;
const UPPER: u8 = 13;
const SHIFTED: u8 = 1;
const REDUCED: u8 = 2;
const LOW: u8 = 3;
const SQUARE: u8 = 4;
const FOURTH: u8 = 5;
const EIGHTH: u8 = 6;
const OTHER: u8 = 7;
const SIN: u8 = 8;
const COS: u8 = 9;
/// Lanes of angles that are large, of all groups.
const LARGE: u8 = 10;

// Operations of the computation, whose operands are places of the machine code.
const NONE: Operand = Operand::Const(0.0);
const SUM: Op = Op::Add(NONE, NONE);
const DIFFERENCE: Op = Op::Sub(NONE, NONE);
const PRODUCT: Op = Op::Mul(NONE, NONE);
const PRODUCT_AND_SUM: Op = Op::MulAdd(NONE, NONE, NONE);
const PRODUCT_MINUS: Op = Op::MulSub(NONE, NONE, NONE);
const SUM_MINUS_PRODUCT: Op = Op::NegMulAdd(NONE, NONE, NONE);

impl Writer<'_> {
    /// Returns the address operand of constant `k` of [`constants`], in all lanes.
    fn operand_for_sine_constant(&self, k: usize) -> Rm {
        self.constant(self.masks + (2 + k) * WIDEST)
    }

    /// Writes the computation of the sines and cosines of all groups of angles.
    pub(super) fn write_sines(&mut self) -> Result<(), String> {
        let plan = self.plan;
        // The first group is computed first, and stays in its register.
        for (k, group) in plan.angles.iter().enumerate().rev() {
            self.join_angles(group);
            self.store(ANGLE, memory_of_group_angles(k), group.width());
        }
        for (k, group) in plan.angles.iter().enumerate() {
            if k > 0 {
                let from = self.memory(memory_of_group_angles(k));
                self.code.load(ANGLE, from, group.width());
            }
            self.write_large_angle_comparison(k == 0, packed_width(group));
            self.write_reduced_sines(packed_width(group))?;
            self.write_quadrant_change(k, group.width());
        }
        let widest = plan.angles.first().map_or(1, packed_width);
        self.code.write_vex_instruction(encoding_on_lanes(TEST, widest), LARGE, 0, Rm::Register(LARGE));
        self.code.bytes.extend([0x0F, 0x85]); // jne
        let pointers = self.pointers.iter().map(|pointer| pointer.slot).collect();
        self.slow = Some(LargeAngleJump { distance: self.code.bytes.len(), pointers });
        self.code.bytes.extend([0; 4]);
        Ok(())
    }

    /// Writes the moves of the angles of a group into the lanes of a register.
    fn join_angles(&mut self, group: &AngleGroup) {
        let sources: Vec<(Rm, usize)> =
            group.sources.iter().map(|(place, width)| (self.operand(*place), *width)).collect();
        let rest = match sources[..] {
            [(a, 1), (b, 1), ref rest @ ..] => {
                self.write_join_of_numbers(ANGLE, a, b);
                rest
            }
            [(a, width), ref rest @ ..] => {
                self.code.load(ANGLE, a, width);
                rest
            }
            [] => return,
        };
        let upper = match *rest {
            [(c, _), (d, _)] => {
                self.write_join_of_numbers(UPPER, c, d);
                Rm::Register(UPPER)
            }
            [(c, _)] => c,
            _ => return,
        };
        self.code.write_vex_instruction(INSERT_UPPER, ANGLE, ANGLE, upper);
        self.code.bytes.push(1);
    }

    /// Writes the comparison of the angles' magnitudes with the largest one for which the reduction is exact.
    fn write_large_angle_comparison(&mut self, is_first: bool, width: usize) {
        let to = if is_first { LARGE } else { OTHER };
        self.code.write_vex_instruction(
            encoding_on_lanes(AND, width),
            OTHER,
            ANGLE,
            self.constant(self.masks + WIDEST),
        );
        let largest = self.operand_for_sine_constant(0);
        self.code.write_vex_instruction(encoding_on_lanes(COMPARE, width), to, OTHER, largest);
        self.code.bytes.push(GREATER);
        if !is_first {
            self.code.write_vex_instruction(encoding_on_lanes(OR, WIDEST), LARGE, LARGE, Rm::Register(OTHER));
        }
    }

    /// Writes sine and cosine of the reduced angle: the function `reduced_sine_and_cosine` of the runtime,
    /// with fused products and sums.
    fn write_reduced_sines(&mut self, width: usize) -> Result<(), String> {
        let r = Rm::Register;
        let sine_constant_operand = |k: usize| self.operand_for_sine_constant(k);
        let ([per_angle, round], [minus_half, one]) =
            ([1, 2].map(sine_constant_operand), [18, 19].map(sine_constant_operand));
        let quarter: [Rm; 3] = std::array::from_fn(|k| sine_constant_operand(3 + k));
        let sine: [Rm; 6] = std::array::from_fn(|k| sine_constant_operand(6 + k));
        let cosine: [Rm; 6] = std::array::from_fn(|k| sine_constant_operand(12 + k));
        let steps = [
            (PRODUCT_AND_SUM, SHIFTED, [r(ANGLE), per_angle, round]),
            (DIFFERENCE, OTHER, [r(SHIFTED), round, r(OTHER)]),
            (SUM_MINUS_PRODUCT, ANGLE, [r(OTHER), quarter[0], r(ANGLE)]),
            (SUM_MINUS_PRODUCT, REDUCED, [r(OTHER), quarter[1], r(ANGLE)]),
            (DIFFERENCE, LOW, [r(ANGLE), r(REDUCED), r(LOW)]),
            (SUM_MINUS_PRODUCT, LOW, [r(OTHER), quarter[1], r(LOW)]),
            (SUM_MINUS_PRODUCT, LOW, [r(OTHER), quarter[2], r(LOW)]),
            (PRODUCT, SQUARE, [r(REDUCED), r(REDUCED), r(SQUARE)]),
            (PRODUCT, FOURTH, [r(SQUARE), r(SQUARE), r(FOURTH)]),
            (PRODUCT, EIGHTH, [r(FOURTH), r(FOURTH), r(EIGHTH)]),
            // The sine's polynomial.
            (PRODUCT_AND_SUM, SIN, [r(SQUARE), sine[4], sine[3]]),
            (PRODUCT_AND_SUM, OTHER, [r(SQUARE), sine[2], sine[1]]),
            (PRODUCT_AND_SUM, SIN, [r(SIN), r(FOURTH), r(OTHER)]),
            (PRODUCT_AND_SUM, SIN, [r(EIGHTH), sine[5], r(SIN)]),
            (PRODUCT_AND_SUM, SIN, [r(SQUARE), r(SIN), sine[0]]),
            // The cosine's polynomial.
            (PRODUCT_AND_SUM, COS, [r(SQUARE), cosine[3], cosine[2]]),
            (PRODUCT_AND_SUM, OTHER, [r(SQUARE), cosine[1], cosine[0]]),
            (PRODUCT_AND_SUM, COS, [r(COS), r(FOURTH), r(OTHER)]),
            (PRODUCT_AND_SUM, OTHER, [r(SQUARE), cosine[5], cosine[4]]),
            (PRODUCT_AND_SUM, COS, [r(EIGHTH), r(OTHER), r(COS)]),
            // Sine and cosine.
            (PRODUCT, OTHER, [r(REDUCED), r(SQUARE), r(OTHER)]),
            (PRODUCT_AND_SUM, SIN, [r(OTHER), r(SIN), r(LOW)]),
            (SUM, SIN, [r(REDUCED), r(SIN), r(OTHER)]),
            (PRODUCT_AND_SUM, COS, [r(SQUARE), r(COS), minus_half]),
            (PRODUCT_MINUS, COS, [r(REDUCED), r(COS), r(LOW)]),
            (PRODUCT_AND_SUM, COS, [r(REDUCED), r(COS), one]),
        ];
        steps
            .into_iter()
            .try_for_each(|(op, to, operands)| self.write_inline_operation(op, to, operands, width))
    }

    /// Writes the change of sine and cosine of the reduced angle into those of the angle, and their stores.
    /// The last bit of the quadrant exchanges them, the bit before is their sign.
    fn write_quadrant_change(&mut self, group: usize, width: usize) {
        let packed = width.max(2);
        let (register, exchange, sign) = (Rm::Register, OTHER, EIGHTH);
        for (to, bits) in [(exchange, 63), (sign, 62)] {
            self.code.write_vex_instruction(encoding_on_lanes(SHIFT, packed), 6, to, register(SHIFTED));
            self.code.bytes.push(bits);
        }
        for (to, even, odd) in [(LOW, SIN, COS), (SQUARE, COS, SIN)] {
            self.code.write_vex_instruction(encoding_on_lanes(BLEND, packed), to, even, register(odd));
            self.code.bytes.push(exchange << 4);
        }
        self.code.write_vex_instruction(
            encoding_on_lanes(AND, packed),
            sign,
            sign,
            self.constant(self.masks),
        );
        self.code.write_vex_instruction(encoding_on_lanes(XOR, packed), exchange, exchange, register(sign));
        for (result, sign, at) in [(LOW, sign, width), (SQUARE, exchange, 2 * width)] {
            self.code.write_vex_instruction(encoding_on_lanes(XOR, packed), result, result, register(sign));
            self.store(result, MemoryLocation::Angle(3 * WIDEST * group + at), width);
        }
    }

    /// Writes the code for large angles, behind that of the function: a call of the runtime for all angles.
    pub(super) fn write_large_angle_code(&mut self) -> Result<(), String> {
        let Some(LargeAngleJump { distance, pointers }) = self.slow.take() else { return Ok(()) };
        let back = distance + 4;
        self.write_jump_distance(distance, self.code.bytes.len())?;
        let saved = self.registers.registers_to_save_around_calls();
        saved.iter().for_each(|register| self.code.write_general_register_instruction(0x50, *register));
        if let Rm::Memory(base, at) = self.memory(MemoryLocation::Angle(0)) {
            self.code.write_effective_address_load(RDI, base, at);
        }
        self.code.write_move_immediate(RSI, self.plan.angle_count() as u64);
        self.write_helper_call("sines")?;
        saved.iter().rev().for_each(|register| self.code.write_general_register_instruction(0x58, *register));
        for slot in pointers {
            self.register_with_input_address(slot);
        }
        self.code.bytes.push(0xE9); // jmp
        let distance = self.code.bytes.len();
        self.code.bytes.extend([0; 4]);
        self.write_jump_distance(distance, back)
    }

    /// Writes the distance of a jump, which counts from the end of the distance.
    fn write_jump_distance(&mut self, at: usize, target: usize) -> Result<(), String> {
        let distance = i32::try_from(target as i64 - (at as i64 + 4)).map_err(|_| "a program is too long")?;
        self.code.bytes[at..at + 4].copy_from_slice(&distance.to_le_bytes());
        Ok(())
    }
}

/// Returns the location of the angles of a group in the array.
fn memory_of_group_angles(group: usize) -> MemoryLocation {
    MemoryLocation::Angle(3 * WIDEST * group)
}

/// Returns the number of lanes of the instructions for a group.
fn packed_width(group: &AngleGroup) -> usize {
    group.width().max(2)
}
