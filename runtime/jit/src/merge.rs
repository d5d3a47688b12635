//! Concatenation of programs, each of which may use results of the previous ones.

use linkwork_compiler::expr::Symbol;
use linkwork_compiler::lower::{Op, Operand, Program};
use std::collections::HashMap;

/// Program under construction, with replacements of symbols in the programs that are appended.
#[derive(Default)]
pub(crate) struct ProgramMerger {
    program: Program,
    bound: HashMap<Symbol, Operand>,
    /// Calls of elementary functions, which several programs may have in common.
    calls: Vec<(Op, Operand)>,
}

impl ProgramMerger {
    /// Appends the instructions of a program; returns the outputs of that program.
    pub fn append_program(&mut self, program: &Program) -> Vec<Operand> {
        let mut values: Vec<Operand> = Vec::with_capacity(program.instructions.len());
        for op in &program.instructions {
            let op = op.map_operands(|operand| self.renamed_operand(operand, &values));
            let known = self.calls.iter().find(|(known, _)| *known == op).map(|(_, value)| *value);
            values.push(known.unwrap_or_else(|| {
                let value = self.push(op);
                if matches!(op, Op::Call(..)) {
                    self.calls.push((op, value));
                }
                value
            }));
        }
        program.outputs.iter().map(|output| self.renamed_operand(*output, &values)).collect()
    }

    fn renamed_operand(&self, operand: Operand, values: &[Operand]) -> Operand {
        match operand {
            Operand::Symbol(symbol) => self.bound.get(&symbol).copied().unwrap_or(operand),
            other => other.operand_in_other_program(values),
        }
    }

    /// Replaces a symbol in the programs that are appended after this call.
    pub fn bind_symbol(&mut self, symbol: Symbol, operand: Operand) {
        self.bound.insert(symbol, operand);
    }

    /// Appends an instruction to the program; returns its value as an operand.
    pub fn push(&mut self, op: Op) -> Operand {
        self.program.instructions.push(op);
        Operand::Value(self.program.instructions.len() - 1)
    }

    /// Completes the merged program with the given outputs.
    pub fn finish(mut self, outputs: Vec<Operand>) -> Program {
        self.program.outputs = outputs;
        self.program.remove_unused_instructions();
        self.program
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linkwork_compiler::expr::Graph;
    use linkwork_compiler::lower::lower;
    use linkwork_compiler::mechanism::{Quantity, SuppliedQuantity};

    /// Checks that a program `2 x`, followed by a program `sin(y)` whose `y` is bound to its result, is
    /// `sin(2 x)`.
    #[test]
    fn bound_symbols_are_replaced_by_results() {
        let graph = Graph::new();
        let (x, y) = (Quantity::Configuration(0), Quantity::Given(SuppliedQuantity::Parent, 0));
        let twice = lower(&[x.expr(&graph) * graph.num(2.0)]);
        let sine = lower(&[y.expr(&graph).sin()]);
        let mut merged = ProgramMerger::default();
        let outputs = merged.append_program(&twice);
        merged.bind_symbol(y.symbol(), outputs[0]);
        let outputs = merged.append_program(&sine);
        let program = merged.finish(outputs);
        let found = program.interpret_program(&|symbol| if symbol == x.symbol() { 0.3 } else { f64::NAN });
        assert_eq!(found, [0.6_f64.sin()]);
    }
}
