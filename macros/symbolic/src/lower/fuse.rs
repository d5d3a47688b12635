//! Fusion of multiplications and additions: a product whose only use is a sum becomes one instruction
//! together with the sum.

use super::{Op, Operand, Program};

impl Program {
    /// Returns the number of instructions after products are fused into sums.
    pub fn instruction_count_after_fusion(&self) -> usize {
        let fused = (0..self.instructions.len()).filter(|k| self.product_to_fuse(*k).is_some());
        self.instructions.len() - fused.count()
    }

    /// Returns for each instruction whether it is a product that will be fused.
    pub(super) fn fused_product_flags(&self) -> Vec<bool> {
        let mut fuses = vec![false; self.instructions.len()];
        for product in (0..self.instructions.len()).filter_map(|k| self.product_to_fuse(k)) {
            fuses[product.instruction_index()] = true;
        }
        fuses
    }

    /// Returns a copy with products fused into sums, for cost estimates.
    pub(super) fn copy_with_fused_products(&self) -> Program {
        Program { simd: None, ..self.clone() }.with_fused_products()
    }

    /// Fuses products into sums. Generated code uses the hardware's fused operation where it exists, and a
    /// product and a sum elsewhere.
    pub(super) fn with_fused_products(mut self) -> Program {
        let counts = self.counts;
        for k in 0..self.instructions.len() {
            if let Some(op) = self.fused_operation(k) {
                self.instructions[k] = op;
            }
        }
        self.remove_unused_instructions();
        self.counts = counts;
        self
    }

    fn fused_operation(&self, k: usize) -> Option<Op> {
        let product = self.product_to_fuse(k)?;
        let (x, y) = self.factors_of_single_use_product(product)?;
        match self.instructions[k] {
            Op::Add(a, b) => Some(Op::MulAdd(x, y, if product == a { b } else { a })),
            Op::Sub(a, b) if product == b => Some(Op::NegMulAdd(x, y, a)),
            Op::Sub(_, b) => Some(Op::MulSub(x, y, b)),
            _ => None,
        }
    }

    /// Returns the product that fuses into the sum of instruction `k`.
    fn product_to_fuse(&self, k: usize) -> Option<Operand> {
        let is_unshared_product = |o: Operand| self.factors_of_single_use_product(o).is_some();
        let product = match self.instructions[k] {
            // Of two products the later one is fused, because the earlier one is ready by then.
            Op::Add(a, b)
                if is_unshared_product(a)
                    && (!is_unshared_product(b) || a.instruction_index() > b.instruction_index()) =>
            {
                a
            }
            Op::Sub(a, b) if !is_unshared_product(b) => a,
            Op::Add(_, b) | Op::Sub(_, b) => b,
            _ => return None,
        };
        Some(product).filter(|product| is_unshared_product(*product))
    }

    /// Moves each product that will be fused directly before its sum.
    pub(super) fn move_products_next_to_sums(self) -> Program {
        let n = self.instructions.len();
        let waits = self.fused_product_flags();
        let index_of_product_to_fuse = |k: usize| self.product_to_fuse(k).map(Operand::instruction_index);
        let order: Vec<usize> = (0..n)
            .filter(|k| !waits[*k])
            .flat_map(|k| index_of_product_to_fuse(k).into_iter().chain([k]))
            .collect();
        match order.iter().enumerate().all(|(place, k)| place == *k) {
            true => self,
            false => self.reorder_instructions(&order),
        }
    }
}
