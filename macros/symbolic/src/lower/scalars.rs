//! Programs without SIMD lanes that compute the same bits as a program with lanes.

use super::{Op, Operand, Program};

impl Program {
    /// Returns the program with one instruction for every lane. Every operation of a lane has the same
    /// operands as in the program with lanes, and lanes are summed in the order of the runtime, so that the
    /// results have the same bits.
    #[must_use]
    pub fn expand_lanes(&self) -> Program {
        let mut expansion = ScalarisedProgram { program: self, instructions: Vec::new(), values: Vec::new() };
        for op in &self.instructions {
            let lanes = expansion.expand_operation(*op);
            expansion.values.push(lanes);
        }
        let outputs = self.outputs.iter().map(|o| expansion.lane_operand(*o, 0)).collect();
        let mut program = Program { instructions: expansion.instructions, outputs, ..Program::default() };
        program.remove_unused_instructions();
        program.counts = program.count_operations();
        program
    }
}

/// Program in which an instruction on SIMD lanes becomes one instruction per lane.
struct ScalarisedProgram<'a> {
    program: &'a Program,
    /// Scalar instructions written so far.
    instructions: Vec<Op>,
    /// Operands for the lanes of each value of the original program.
    values: Vec<Vec<Operand>>,
}

impl ScalarisedProgram<'_> {
    /// Appends the instructions of an operation, and returns the operands that hold its lanes.
    fn expand_operation(&mut self, op: Op) -> Vec<Operand> {
        match op {
            Op::Lane(k, a) => vec![self.lane_operand(a, k)],
            Op::Join(n, a, b) => {
                [a, b].iter().flat_map(|o| (0..n).map(|k| self.lane_operand(*o, k))).collect()
            }
            Op::Sum(n, a) => {
                let lanes = (0..n).map(|k| self.lane_operand(a, k)).collect();
                vec![self.append_sum_of_lanes(lanes)]
            }
            op => {
                let mut width = 1;
                op.visit_operands(|o| width = width.max(self.lane_count(o)));
                let lanes: Vec<Op> =
                    (0..width).map(|k| op.map_operands(|o| self.lane_operand(o, k))).collect();
                lanes.into_iter().map(|op| self.push_instruction(op)).collect()
            }
        }
    }

    /// Appends the instructions that sum SIMD lanes: the upper half is added to the lower half until one lane
    /// is left.
    fn append_sum_of_lanes(&mut self, mut lanes: Vec<Operand>) -> Operand {
        while lanes.len() > 1 {
            let half = lanes.len().div_ceil(2);
            for (k, upper) in lanes.split_off(half).into_iter().enumerate() {
                lanes[k] = self.push_instruction(Op::Add(lanes[k], upper));
            }
        }
        lanes.first().copied().unwrap_or(Operand::Const(0.0))
    }

    fn push_instruction(&mut self, op: Op) -> Operand {
        self.instructions.push(op);
        Operand::Value(self.instructions.len() - 1)
    }

    /// Returns the number of SIMD lanes of an operand.
    fn lane_count(&self, o: Operand) -> usize {
        match o {
            Operand::Const(_) | Operand::Symbol(_) => 1,
            Operand::Value(k) => self.values[k].len(),
            Operand::Tuple(k) => self.program.tuples[k].len(),
            Operand::Gather(k) => self.program.gathers[k].len(),
        }
    }

    /// Returns the scalar operand for a SIMD lane of a value. A scalar is the same in all lanes.
    fn lane_operand(&self, o: Operand, k: usize) -> Operand {
        match o {
            Operand::Const(_) | Operand::Symbol(_) => o,
            Operand::Value(v) => self.values[v][k.min(self.values[v].len() - 1)],
            Operand::Tuple(t) => Operand::Const(self.program.tuples[t][k]),
            Operand::Gather(g) => Operand::Symbol(self.program.gathers[g][k]),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::Symbol;
    use crate::lower::{Op, Operand, Program};

    /// `Σ cₖ xₖ` over five lanes, in the order of the runtime, and the last product.
    #[test]
    fn lane_sums_become_scalar_instructions() {
        let instructions = vec![
            Op::Mul(Operand::Tuple(0), Operand::Gather(0)),
            Op::Sum(5, Operand::Value(0)),
            Op::Lane(4, Operand::Value(0)),
        ];
        let outputs = vec![Operand::Value(1), Operand::Value(2)];
        let tuples = vec![vec![1e16, 1.0, -1e16, 1.0, 3.0]];
        let gathers = vec![(0..5).map(Symbol).collect()];
        let mut lanes = Program { instructions, outputs, tuples, gathers, ..Program::default() };
        lanes.remove_unused_instructions();
        let program = lanes.expand_lanes();
        assert!(program.tuples.is_empty() && program.gathers.is_empty());
        assert_eq!(program.instructions.len(), 9);
        // (x₀ + x₃, x₁ + x₄, x₂), then (x₀ + x₃ + x₂, x₁ + x₄), then the sum of both.
        assert_eq!(program.interpret_program(&|_| 1.0), [((1e16 + 1.0) + -1e16) + (1.0 + 3.0), 3.0]);
    }
}
