//! Printing of programs as text, with one line per instruction, such as `t3 = x0 * t1`.

use super::{Op, Operand, Program};
use crate::expr::Symbol;
use std::fmt::Write;

impl Program {
    /// Returns the instructions and outputs as text, with names for symbols.
    pub fn program_text(&self, name: &dyn Fn(Symbol) -> String) -> String {
        let mut text = String::new();
        let format_operand = |o: Operand| self.operand_text(o, name);
        for (k, op) in self.instructions.iter().enumerate() {
            let _ = writeln!(text, "t{k} = {}", op_text(op, &format_operand));
        }
        let outputs: Vec<String> = self.outputs.iter().map(|o| format_operand(*o)).collect();
        let _ = writeln!(text, "-> {}", outputs.join(", "));
        text
    }

    fn operand_text(&self, o: Operand, name: &dyn Fn(Symbol) -> String) -> String {
        match o {
            Operand::Const(c) => format!("{c}"),
            Operand::Symbol(s) => name(s),
            Operand::Value(k) => format!("t{k}"),
            Operand::Tuple(k) => format!("{:?}", self.tuples[k]),
            Operand::Gather(k) => {
                let names: Vec<String> = self.gathers[k].iter().map(|s| name(*s)).collect();
                format!("[{}]", names.join(", "))
            }
        }
    }
}

fn op_text(op: &Op, at: &dyn Fn(Operand) -> String) -> String {
    match *op {
        Op::Neg(a) => format!("-{}", at(a)),
        Op::Add(a, b) => format!("{} + {}", at(a), at(b)),
        Op::Sub(a, b) => format!("{} - {}", at(a), at(b)),
        Op::Mul(a, b) => format!("{} * {}", at(a), at(b)),
        Op::Div(a, b) => format!("{} / {}", at(a), at(b)),
        Op::MulAdd(a, b, c) => format!("fused {} * {} + {}", at(a), at(b), at(c)),
        Op::MulSub(a, b, c) => format!("fused {} * {} - {}", at(a), at(b), at(c)),
        Op::NegMulAdd(a, b, c) => format!("fused {} - {} * {}", at(c), at(a), at(b)),
        Op::Call(f, a) => format!("{}({})", f.function_name(), at(a)),
        Op::Atan2(a, b) => format!("atan2({}, {})", at(a), at(b)),
        Op::Pow(a, b) => format!("pow({}, {})", at(a), at(b)),
        Op::Extreme(f, a, b) => format!("{}({}, {})", f.function_name(), at(a), at(b)),
        Op::Table(lookup, a, b, c) => {
            let x: Vec<String> = [a, b, c].into_iter().take(lookup.variable_count()).map(at).collect();
            format!("table{}{:?}({})", lookup.table_index(), lookup.derivative_orders(), x.join(", "))
        }
        Op::Sum(n, a) => format!("sum of {n} lanes of {}", at(a)),
        Op::Lane(k, a) => format!("lane {k} of {}", at(a)),
        Op::Join(n, a, b) => format!("{n} lanes each of {} and {}", at(a), at(b)),
    }
}
