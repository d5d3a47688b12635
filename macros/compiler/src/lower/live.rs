//! What a worst case is reckoned from: how many numbers a program holds at once, and where it may branch.

use super::{Op, Operand, Program};
use crate::expr::Function;

impl Program {
    /// The most numbers that are held at once, each lane one: computed, and still to be used or returned. Arguments and constants
    /// are not among them.
    pub fn most_live(&self) -> usize {
        let end = self.instructions.len();
        let mut last = vec![0; end];
        for (k, op) in self.instructions.iter().enumerate() {
            op.operands(|o| {
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
        let lanes = self.lanes();
        let mut released = vec![0; end + 1];
        last.iter().zip(&lanes).for_each(|(last, lanes)| released[*last] += lanes);
        let (mut held, mut most) = (0, 0);
        for (lanes, released) in lanes.iter().zip(&released) {
            // A result may take the place of an operand, but need not.
            held += lanes;
            most = most.max(held);
            held -= released;
        }
        most
    }

    /// How many instructions may branch: all angles together once, where one is so large that the library's functions are called;
    /// tables, which look for a place in their grid; and functions of the library. Square roots, magnitudes, signs, and the smaller
    /// or larger of two numbers do not.
    pub fn branches(&self) -> usize {
        let is_angle = |op: &&Op| matches!(op, Op::Call(Function::Sin | Function::Cos, _));
        let others = self.instructions.iter().filter(|op| match op {
            Op::Call(
                Function::Sin | Function::Cos | Function::Sqrt | Function::Abs | Function::Signum,
                _,
            ) => false,
            Op::Call(..) | Op::Atan2(..) | Op::Pow(..) | Op::Table(..) => true,
            _ => false,
        });
        others.count() + usize::from(self.instructions.iter().any(|op| is_angle(&op)))
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Graph, Symbol};
    use crate::lower::lower;

    #[test]
    fn numbers_are_held_until_their_last_use() {
        let g = Graph::new();
        let [a, b, c, d] = std::array::from_fn(|k| g.symbol(Symbol(k as u32)));
        // One product after the other is added: the sum, and the product that is to be added.
        let chain = a * b + b * c + c * d;
        assert_eq!(lower(&[chain]).most_live(), 2 + 1);
        // Both sums are there when they are divided, and so is the quotient.
        assert_eq!(lower(&[(a + b) / (c + d)]).most_live(), 3);
        // What is returned is held to the end.
        assert_eq!(lower(&[a + b, c + d, a * c]).most_live(), 3);
    }

    #[test]
    fn only_angles_tables_and_the_library_branch() {
        let g = Graph::new();
        let [a, b] = std::array::from_fn(|k| g.symbol(Symbol(k as u32)));
        assert_eq!(lower(&[(a * b).sqrt() + a / b]).branches(), 0);
        assert_eq!(lower(&[a.sin() * b.cos(), b.sin()]).branches(), 1);
        assert_eq!(lower(&[a.sin() + b.call(crate::expr::Function::Exp)]).branches(), 2);
    }
}
