//! Programs with lanes: which values have some, and what a program costs with them and without.

use super::{Op, Operand, Program};
use crate::expr::{Graph, Id, Node};
use crate::machine::{
    CACHED_INSTRUCTIONS, CALL_COST, FETCH_COST, GATHER_COST, LANE_COST, SUM_COST, cost_of_lanes,
};

/// Lanes of the values of a program that is being written.
#[derive(Default)]
pub(super) struct Lanes {
    /// By value: how many, one for none.
    widths: Vec<usize>,
    gathers: Vec<usize>,
    tuples: Vec<usize>,
}

impl Lanes {
    /// For a program with the constants and inputs of another.
    pub(super) fn of_inputs(program: &Program) -> Lanes {
        let gathers = program.gathers.iter().map(Vec::len).collect();
        Lanes { widths: Vec::new(), gathers, tuples: program.tuples.iter().map(Vec::len).collect() }
    }

    /// The operand that a node is without an instruction of its own.
    pub(super) fn leaf(
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
                program.tuples.push(graph.tuple(k));
                self.tuples.push(graph.tuple(k).len());
                Operand::Tuple(program.tuples.len() - 1)
            }
            Node::Gather(k) => {
                program.gathers.push(graph.gather(k));
                self.gathers.push(graph.gather(k).len());
                Operand::Gather(program.gathers.len() - 1)
            }
            Node::Lane(_, a) if self.width(at(a)) == 1 => at(a),
            _ => return None,
        })
    }

    /// The sum of `n` lanes of an operand.
    pub(super) fn sum(&self, n: usize, a: Operand) -> Op {
        match self.width(a) {
            1 => Op::Mul(Operand::Const(n as f64), a),
            _ => Op::Sum(n, a),
        }
    }

    /// Notes what the next instruction has.
    pub(super) fn push(&mut self, op: &Op) {
        let width = self.width_of(op);
        self.widths.push(width);
    }

    fn width_of(&self, op: &Op) -> usize {
        let mut width = 1;
        if let Op::Join(n, ..) = op {
            return 2 * n;
        }
        if !matches!(op, Op::Sum(..) | Op::Lane(..)) {
            op.operands(|o| width = width.max(self.width(o)));
        }
        width
    }

    /// Lanes of an operand.
    pub(super) fn width(&self, o: Operand) -> usize {
        match o {
            Operand::Const(_) | Operand::Symbol(_) => 1,
            Operand::Value(k) => self.widths[k],
            Operand::Tuple(k) => self.tuples[k],
            Operand::Gather(k) => self.gathers[k],
        }
    }
}

impl Program {
    /// The same with the cheapest of some programs that compute it with lanes, if that is cheaper.
    pub fn or_in_lanes(mut self, candidates: impl IntoIterator<Item = Program>) -> Program {
        let costs = candidates.into_iter().map(|program| (program.cost(), program));
        let best = costs.min_by_key(|(cost, _)| *cost);
        self.simd = best.filter(|(cost, _)| *cost < self.cost()).map(|(_, program)| Box::new(program));
        self
    }

    /// What it costs, roughly, in tenths of an instruction of one lane.
    pub fn cost(&self) -> usize {
        let gathers: usize = self.gathers.iter().map(|g| GATHER_COST * g.len()).sum();
        // A product that will fuse costs nothing beside its sum.
        let fuses = self.products_to_fuse();
        let all = self.instructions.iter().zip(self.lanes()).zip(&fuses);
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

    /// By value: how many lanes it has, one for none.
    pub fn lanes(&self) -> Vec<usize> {
        let mut lanes = Lanes::of_inputs(self);
        for op in &self.instructions {
            lanes.push(op);
        }
        lanes.widths
    }
}
