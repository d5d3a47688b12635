//! Fused multiply-add: a product whose only use is a sum becomes one instruction with it.

use super::{Op, Program};

impl Program {
    /// The same program with products fused into sums. The generated code computes them fused where the hardware can,
    /// and as product and sum elsewhere.
    pub fn fused(self) -> Program {
        self.chained().with_fused_products()
    }

    /// The same without another order of sums.
    pub(super) fn with_fused_products(mut self) -> Program {
        let counts = self.counts;
        for k in 0..self.instructions.len() {
            if let Some(op) = self.fuse(k) {
                self.instructions[k] = op;
            }
        }
        self.sweep();
        self.counts = counts;
        self
    }

    fn fuse(&self, k: usize) -> Option<Op> {
        match self.instructions[k] {
            Op::Add(a, b) => {
                // Of two products the later one is fused: the earlier is ready when it is needed.
                let (first, second) = match (self.lone_product(a), self.lone_product(b)) {
                    (Some(_), Some(_)) if a.number() > b.number() => (a, b),
                    (Some(_), None) => (a, b),
                    _ => (b, a),
                };
                let (x, y) = self.lone_product(first)?;
                Some(Op::MulAdd(x, y, second))
            }
            Op::Sub(a, b) => {
                if let Some((x, y)) = self.lone_product(b) {
                    return Some(Op::NegMulAdd(x, y, a));
                }
                let (x, y) = self.lone_product(a)?;
                Some(Op::MulSub(x, y, b))
            }
            _ => None,
        }
    }
}
