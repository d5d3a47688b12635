//! Numbers of SIMD lanes of a program's values, and cost estimates of programs with and without lanes.

use super::{Op, Operand, Program};
use crate::expr::{Graph, Id, Node};
use crate::machine::{
    CACHED_INSTRUCTIONS, CALL_COST, FETCH_COST, GATHER_COST, LANE_COST, SUM_COST, cost_of_lanes,
};

/// Numbers of SIMD lanes of the values of a program that is being written.
#[derive(Default)]
pub(super) struct ValueLaneCounts {
    /// Number of SIMD lanes of each value; one for scalars.
    widths: Vec<usize>,
    gathers: Vec<usize>,
    tuples: Vec<usize>,
}

impl ValueLaneCounts {
    /// Returns the numbers of lanes of a program's constants and inputs. Those of instructions are added
    /// later.
    pub(super) fn program_input_lane_counts(program: &Program) -> ValueLaneCounts {
        let gathers = program.gathers.iter().map(Vec::len).collect();
        ValueLaneCounts { widths: Vec::new(), gathers, tuples: program.tuples.iter().map(Vec::len).collect() }
    }

    /// Returns the operand of a node that needs no instruction.
    pub(super) fn operand_of_leaf_node(
        &mut self,
        graph: &Graph,
        node: Node,
        program: &mut Program,
        at: &dyn Fn(Id) -> Operand,
    ) -> Option<Operand> {
        Some(match node {
            Node::Const(c) => Operand::Const(c),
            Node::Symbol(s) => Operand::Symbol(s),
            Node::Tuple(k) => {
                program.tuples.push(graph.lanes_of_tuple(k));
                self.tuples.push(graph.lanes_of_tuple(k).len());
                Operand::Tuple(program.tuples.len() - 1)
            }
            Node::Gather(k) => {
                program.gathers.push(graph.symbols_of_gather(k));
                self.gathers.push(graph.symbols_of_gather(k).len());
                Operand::Gather(program.gathers.len() - 1)
            }
            Node::Lane(_, a) if self.lane_count(at(a)) == 1 => at(a),
            _ => return None,
        })
    }

    /// Returns the operation that sums `n` SIMD lanes of an operand.
    pub(super) fn lane_sum_operation(&self, n: usize, a: Operand) -> Op {
        match self.lane_count(a) {
            1 => Op::Mul(Operand::Const(n as f64), a),
            _ => Op::Sum(n, a),
        }
    }

    /// Records the number of SIMD lanes of the next instruction.
    pub(super) fn record_lane_count(&mut self, op: &Op) {
        let width = self.width_of_operation(op);
        self.widths.push(width);
    }

    fn width_of_operation(&self, op: &Op) -> usize {
        let mut width = 1;
        if let Op::Join(n, ..) = op {
            return 2 * n;
        }
        if !matches!(op, Op::Sum(..) | Op::Lane(..)) {
            op.visit_operands(|o| width = width.max(self.lane_count(o)));
        }
        width
    }

    /// Returns the number of SIMD lanes of an operand.
    pub(super) fn lane_count(&self, o: Operand) -> usize {
        match o {
            Operand::Const(_) | Operand::Symbol(_) => 1,
            Operand::Value(k) => self.widths[k],
            Operand::Tuple(k) => self.tuples[k],
            Operand::Gather(k) => self.gathers[k],
        }
    }
}

impl Program {
    /// Adds the cheapest candidate with SIMD lanes as variant, if it is cheaper than the program itself.
    pub fn with_cheapest_lane_variant(mut self, candidates: impl IntoIterator<Item = Program>) -> Program {
        let costs = candidates.into_iter().map(|program| (program.estimated_cost(), program));
        let best = costs.min_by_key(|(cost, _)| *cost);
        self.simd =
            best.filter(|(cost, _)| *cost < self.estimated_cost()).map(|(_, program)| Box::new(program));
        self
    }

    /// Returns the estimated cost of the program, in tenths of an instruction on one lane.
    pub fn estimated_cost(&self) -> usize {
        let gathers: usize = self.gathers.iter().map(|g| GATHER_COST * g.len()).sum();
        // A product that will be fused costs nothing in addition to its sum.
        let fuses = self.fused_product_flags();
        let all = self.instructions.iter().zip(self.lane_counts()).zip(&fuses);
        let instructions: usize = all
            .map(|((op, lanes), fuses)| match op {
                _ if *fuses => 0,
                Op::Lane(..) => LANE_COST,
                Op::Sum(n, _) => SUM_COST * n,
                Op::Call(..) | Op::Atan2(..) | Op::Pow(..) | Op::Table(..) => CALL_COST * lanes,
                _ => cost_of_lanes(lanes),
            })
            .sum();
        let count = fuses.iter().filter(|fuses| !**fuses).count();
        let fetched = if count > CACHED_INSTRUCTIONS { FETCH_COST * count } else { 0 };
        gathers + instructions.max(fetched)
    }

    /// Returns the number of SIMD lanes of each value; one for scalars.
    pub fn lane_counts(&self) -> Vec<usize> {
        let mut lanes = ValueLaneCounts::program_input_lane_counts(self);
        for op in &self.instructions {
            lanes.record_lane_count(op);
        }
        lanes.widths
    }
}
