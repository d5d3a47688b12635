//! Angles whose sines and cosines can be evaluated together at the start of a program, several at a time.

use super::{Op, Operand, Program};
use crate::expr::{Function as Elementary, Symbol};
use std::cmp::Reverse;

/// Angle of a program with the instructions that compute its sine and cosine.
pub struct Angle {
    /// Angle whose sine and cosine are computed.
    pub angle: Operand,
    /// Index of the instruction that computes the sine of the angle.
    pub sine: Option<usize>,
    /// Index of the instruction that computes the cosine of the angle.
    pub cosine: Option<usize>,
}

/// Angles of a program that are arithmetic expressions of the arguments alone.
pub struct Angles {
    /// Angles of the program whose sine or cosine is computed.
    pub list: Vec<Angle>,
    /// Whether each instruction is the sine or cosine of one of the angles.
    pub covered: Vec<bool>,
    /// Whether an angle depends on each instruction's value.
    pub before: Vec<bool>,
}

impl Angles {
    /// Finds the angles whose sines or cosines a program computes.
    pub fn find_angles(program: &Program) -> Angles {
        let n = program.instructions.len();
        let mut angles = Angles { list: Vec::new(), covered: vec![false; n], before: vec![false; n] };
        let mut plain = vec![false; n];
        for (k, op) in program.instructions.iter().enumerate() {
            let mut all = true;
            op.visit_operands(|o| all &= !matches!(o, Operand::Value(j) if !plain[j]));
            plain[k] = all && !matches!(op, Op::Call(..) | Op::Atan2(..) | Op::Pow(..) | Op::Table(..));
            if let Op::Call(f @ (Elementary::Sin | Elementary::Cos), angle) = *op
                && all
            {
                angles.covered[k] = true;
                angles.add_sine_or_cosine(f, angle, k);
            }
        }
        for angle in &angles.list {
            if let Operand::Value(j) = angle.angle {
                angles.before[j] = true;
            }
        }
        for k in (0..n).rev().filter(|k| plain[*k]) {
            if angles.before[k] {
                program.instructions[k].visit_operands(|o| {
                    if let Operand::Value(j) = o {
                        angles.before[j] = true;
                    }
                });
            }
        }
        angles
    }

    fn add_sine_or_cosine(&mut self, f: Elementary, angle: Operand, k: usize) {
        let known = self.list.iter().position(|a| a.angle == angle);
        let at = known.unwrap_or_else(|| {
            self.list.push(Angle { angle, sine: None, cosine: None });
            self.list.len() - 1
        });
        match f {
            Elementary::Sin => self.list[at].sine = Some(k),
            _ => self.list[at].cosine = Some(k),
        }
    }
}

impl Angles {
    /// Returns the angles in descending order of their lanes; angles with equally many lanes in the order of
    /// the inputs on which they depend.
    pub fn angles_by_descending_width(
        &self,
        program: &Program,
        lanes: impl Fn(Operand) -> usize,
    ) -> Vec<&Angle> {
        let mut list: Vec<&Angle> = self.list.iter().collect();
        list.sort_by_key(|angle| {
            (Reverse(lanes(angle.angle)), first_argument_symbol_of_angle(program, angle.angle))
        });
        list
    }
}

/// Returns the first input of an angle that is an input, or an operation on inputs.
fn first_argument_symbol_of_angle(program: &Program, angle: Operand) -> Option<Symbol> {
    let mut first = None;
    let mut keep_first_symbol = |o: Operand| {
        if let Operand::Symbol(s) = o {
            first = first.or(Some(s));
        }
    };
    match angle {
        Operand::Value(k) => program.instructions[k].visit_operands(&mut keep_first_symbol),
        own => keep_first_symbol(own),
    }
    first
}
