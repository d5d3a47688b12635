//! Sines and cosines of angles that are known from the start: printers evaluate several at a time.

use super::{Op, Operand, Program};
use crate::expr::{Function as Elementary, Symbol};
use std::cmp::Reverse;

/// Sine and cosine of one angle: the instructions that compute them.
pub struct Angle {
    /// The angle.
    pub angle: Operand,
    /// The instruction that computes its sine.
    pub sine: Option<usize>,
    /// The instruction that computes its cosine.
    pub cosine: Option<usize>,
}

/// The angles that can be evaluated together at the start: arithmetic of the arguments.
pub struct Angles {
    /// The angles.
    pub list: Vec<Angle>,
    /// By instruction: it is one of their sines or cosines.
    pub covered: Vec<bool>,
    /// By instruction: an angle needs it.
    pub before: Vec<bool>,
}

impl Angles {
    /// Those of a program.
    pub fn find(program: &Program) -> Angles {
        let n = program.instructions.len();
        let mut angles = Angles { list: Vec::new(), covered: vec![false; n], before: vec![false; n] };
        let mut plain = vec![false; n];
        for (k, op) in program.instructions.iter().enumerate() {
            let mut all = true;
            op.operands(|o| all &= !matches!(o, Operand::Value(j) if !plain[j]));
            plain[k] = all && !matches!(op, Op::Call(..) | Op::Atan2(..) | Op::Pow(..) | Op::Table(..));
            if let Op::Call(f @ (Elementary::Sin | Elementary::Cos), angle) = *op
                && all
            {
                angles.covered[k] = true;
                angles.add(f, angle, k);
            }
        }
        for angle in &angles.list {
            if let Operand::Value(j) = angle.angle {
                angles.before[j] = true;
            }
        }
        for k in (0..n).rev().filter(|k| plain[*k]) {
            if angles.before[k] {
                program.instructions[k].operands(|o| {
                    if let Operand::Value(j) = o {
                        angles.before[j] = true;
                    }
                });
            }
        }
        angles
    }

    fn add(&mut self, f: Elementary, angle: Operand, k: usize) {
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
    /// The angles, those with most lanes first; numbers in the order of the inputs that they come from.
    pub fn widest_first(&self, program: &Program, lanes: impl Fn(Operand) -> usize) -> Vec<&Angle> {
        let mut list: Vec<&Angle> = self.list.iter().collect();
        list.sort_by_key(|angle| (Reverse(lanes(angle.angle)), input(program, angle.angle)));
        list
    }
}

/// The first input of an angle: of one plus a constant at least.
fn input(program: &Program, angle: Operand) -> Option<Symbol> {
    let mut first = None;
    let mut note = |o: Operand| {
        if let Operand::Symbol(s) = o {
            first = first.or(Some(s));
        }
    };
    match angle {
        Operand::Value(k) => program.instructions[k].operands(&mut note),
        own => note(own),
    }
    first
}
