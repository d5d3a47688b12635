//! Quantities that bound stack use and execution time: live values and branches of a program.

use super::{Op, Operand, Program};
use crate::expr::Function;

impl Program {
    /// Returns the maximum number of live values: values that are computed and will still be used or
    /// returned. Each lane counts; arguments and constants do not.
    pub fn max_live(&self) -> usize {
        let end = self.instructions.len();
        let mut last = vec![0; end];
        for (k, op) in self.instructions.iter().enumerate() {
            op.visit_operands(|o| {
                if let Operand::Value(a) = o {
                    last[a] = k;
                }
            });
        }
        for output in &self.outputs {
            if let Operand::Value(a) = output {
                last[*a] = end;
            }
        }
        let lanes = self.lane_counts();
        let mut released = vec![0; end + 1];
        last.iter().zip(&lanes).for_each(|(last, lanes)| released[*last] += lanes);
        let (mut held, mut most) = (0, 0);
        for (lanes, released) in lanes.iter().zip(&released) {
            // The result may need storage of its own while the operands are live.
            held += lanes;
            most = most.max(held);
            held -= released;
        }
        most
    }

    /// Returns the number of instructions that may branch: table lookups, which search their grid, and
    /// functions of the math library. All sines and cosines count once, since large angles fall back to the
    /// library. Square roots, magnitudes, signs, minima and maxima do not branch.
    pub fn possibly_branching_instruction_count(&self) -> usize {
        let is_sine_or_cosine = |op: &&Op| matches!(op, Op::Call(Function::Sin | Function::Cos, _));
        let others = self.instructions.iter().filter(|op| match op {
            Op::Call(
                Function::Sin | Function::Cos | Function::Sqrt | Function::Abs | Function::Signum,
                _,
            ) => false,
            Op::Call(..) | Op::Atan2(..) | Op::Pow(..) | Op::Table(..) => true,
            _ => false,
        });
        others.count() + usize::from(self.instructions.iter().any(|op| is_sine_or_cosine(&op)))
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Graph, Symbol};
    use crate::lower::lower;

    #[test]
    fn values_are_live_until_their_last_use() {
        let g = Graph::new();
        let [a, b, c, d] = std::array::from_fn(|k| g.symbol(Symbol(k as u32)));
        // Live at once: the partial sum, the next product, and their sum.
        let chain = a * b + b * c + c * d;
        assert_eq!(lower(&[chain]).max_live(), 2 + 1);
        // Live at once: both sums and their quotient.
        assert_eq!(lower(&[(a + b) / (c + d)]).max_live(), 3);
        // Outputs stay live to the end.
        assert_eq!(lower(&[a + b, c + d, a * c]).max_live(), 3);
    }

    #[test]
    fn only_angles_tables_and_library_calls_contain_branches() {
        let g = Graph::new();
        let [a, b] = std::array::from_fn(|k| g.symbol(Symbol(k as u32)));
        assert_eq!(lower(&[(a * b).sqrt() + a / b]).possibly_branching_instruction_count(), 0);
        assert_eq!(lower(&[a.sin() * b.cos(), b.sin()]).possibly_branching_instruction_count(), 1);
        assert_eq!(
            lower(&[a.sin() + b.apply_function(crate::expr::Function::Exp)])
                .possibly_branching_instruction_count(),
            2
        );
    }
}
