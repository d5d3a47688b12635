//! Programs with lanes, split into pieces that fit registers: one, two or four lanes.
//!
//! Three lanes are padded to four; more than four lanes are several pieces. Scalars in operations on lanes
//! are copied to all lanes first. Functions that have no instruction are called for one lane at a time.

use super::plan::needs_function_call;
use crate::layout::InputLayout;
use linkwork_compiler::expr::Symbol;
use linkwork_compiler::lower::{Angles, Op, Operand, Program};

/// Maximum number of lanes of a piece.
const WIDEST: usize = 4;

/// Program each of whose values has one, two or four lanes.
///
/// Operands of an operation have at least the lanes of its value; the first lanes count. The exceptions
/// are `Op::Lane(k, a)`, the lanes of `a` from lane `k` on, or copies of the first lane if `k` is zero; and
/// `Op::Join(n, a, b)`, the first `n` lanes of `a`, followed by those of `b`. There is no `Op::Sum`. Outputs
/// are first lanes.
pub struct ProgramInPieces {
    pub program: Program,
    /// Number of lanes of each value.
    pub widths: Vec<usize>,
}

impl ProgramInPieces {
    /// Splits each value of a program into pieces of one, two or four lanes, which fit a register. Inputs
    /// that are adjacent in memory are read together.
    pub fn split_program(program: &Program, layout: &InputLayout) -> Result<ProgramInPieces, String> {
        let covered = Angles::find_angles(program).covered;
        let mut splitter = LaneSplitter {
            from: program,
            layout,
            program: Program::default(),
            widths: Vec::new(),
            values: Vec::with_capacity(program.instructions.len()),
            moves: Vec::new(),
        };
        for (op, is_angle) in program.instructions.iter().zip(covered) {
            let value = splitter.split_operation(*op, is_angle)?;
            splitter.values.push(value);
        }
        splitter.program.outputs =
            program.outputs.iter().map(|output| splitter.lane(*output, 0)).collect::<Result<_, _>>()?;
        let LaneSplitter { program, widths, .. } = splitter;
        Ok(ProgramInPieces { program, widths }.without_unused_instructions())
    }

    /// Removes unused instructions.
    fn without_unused_instructions(mut self) -> ProgramInPieces {
        let mut used = vec![false; self.widths.len()];
        let mark_used = |operand: Operand, used: &mut [bool]| {
            if let Operand::Value(k) = operand {
                used[k] = true;
            }
        };
        self.program.outputs.iter().for_each(|output| mark_used(*output, &mut used));
        for k in (0..used.len()).rev() {
            if used[k] {
                self.program.instructions[k].visit_operands(|operand| mark_used(operand, &mut used));
            }
        }
        self.program.remove_unused_instructions();
        self.widths =
            self.widths.iter().zip(used).filter_map(|(width, used)| used.then_some(*width)).collect();
        self
    }

    /// Reorders the instructions so that few values are live at once: see [`Program::with_few_live_values`].
    pub fn with_few_live_values(self, arrays: &[usize]) -> ProgramInPieces {
        let order = self.program.order_with_few_live_values(arrays);
        let widths = order.iter().map(|k| self.widths[*k]).collect();
        ProgramInPieces { program: self.program.reorder_instructions(&order), widths }
    }
}

/// Returns the number of lanes of piece `k` of a value with `lanes` lanes.
fn width_of_piece(lanes: usize, k: usize) -> usize {
    match lanes.saturating_sub(WIDEST * k) {
        0 | 1 => 1,
        2 => 2,
        _ => WIDEST,
    }
}

/// Whether operands are equal, and zeros have the same sign.
fn is_same_operand(a: Operand, b: Operand) -> bool {
    match (a, b) {
        (Operand::Const(a), Operand::Const(b)) => a.to_bits() == b.to_bits(),
        (a, b) => a == b,
    }
}

/// Returns the bits of the constants of an operation.
fn bits_of_operation_constants(op: &Op) -> Vec<u64> {
    let mut bits = Vec::new();
    op.visit_operands(|operand| {
        if let Operand::Const(c) = operand {
            bits.push(c.to_bits());
        }
    });
    bits
}

/// Value of the program with lanes: its number of lanes, and its pieces.
struct SplitValue {
    lanes: usize,
    pieces: Vec<Operand>,
}

struct LaneSplitter<'a> {
    from: &'a Program,
    layout: &'a InputLayout,
    program: Program,
    widths: Vec<usize>,
    values: Vec<SplitValue>,
    /// Moves between lanes, with their numbers of lanes and results: each is made once.
    moves: Vec<(Op, usize, Operand)>,
}

impl LaneSplitter<'_> {
    fn split_operation(&mut self, op: Op, is_angle: bool) -> Result<SplitValue, String> {
        let mut lanes = 1;
        op.visit_operands(|operand| lanes = lanes.max(self.lane_count(operand)));
        match op {
            Op::Lane(k, a) => Ok(SplitValue { lanes: 1, pieces: vec![self.lane(a, k)?] }),
            Op::Sum(n, a) => Ok(SplitValue { lanes: 1, pieces: vec![self.sum(n, a)?] }),
            Op::Join(n, a, b) => {
                let fills_widest_registers =
                    |operand| self.lane_count(operand) == n && n.is_multiple_of(WIDEST);
                if fills_widest_registers(a) && fills_widest_registers(b) {
                    let count = n / WIDEST;
                    let pieces = [a, b].into_iter().flat_map(|o| (0..count).map(move |k| (o, k)));
                    let pieces = pieces.map(|(o, k)| self.piece(o, n, k)).collect::<Result<_, _>>()?;
                    return Ok(SplitValue { lanes: 2 * n, pieces });
                }
                let all = [a, b].into_iter().flat_map(|o| (0..n).map(move |k| (o, k)));
                let all = all.map(|(o, k)| self.lane(o, k)).collect::<Result<Vec<_>, _>>()?;
                Ok(self.join_scalars_as_lanes(&all))
            }
            op if needs_function_call(&op) && !is_angle && lanes > 1 => {
                let mut all = Vec::with_capacity(lanes);
                for k in 0..lanes {
                    let op = self.operation_with_operands(op, |own, operand| own.lane(operand, k))?;
                    all.push(self.push(op, 1));
                }
                Ok(self.join_scalars_as_lanes(&all))
            }
            op => {
                let mut pieces = Vec::with_capacity(lanes.div_ceil(WIDEST));
                for k in 0..lanes.div_ceil(WIDEST) {
                    let op = self.operation_with_operands(op, |own, operand| own.piece(operand, lanes, k))?;
                    pieces.push(self.push(op, width_of_piece(lanes, k)));
                }
                Ok(SplitValue { lanes, pieces })
            }
        }
    }

    /// Returns an operation with other operands.
    fn operation_with_operands(
        &mut self,
        op: Op,
        mut operand: impl FnMut(&mut Self, Operand) -> Result<Operand, String>,
    ) -> Result<Op, String> {
        let mut failure = None;
        let op = op.map_operands(|o| {
            operand(self, o).unwrap_or_else(|error| {
                failure = Some(error);
                o
            })
        });
        failure.map_or(Ok(op), Err)
    }

    fn push(&mut self, op: Op, width: usize) -> Operand {
        self.program.instructions.push(op);
        self.widths.push(width);
        Operand::Value(self.widths.len() - 1)
    }

    /// Returns the result of a move between lanes, which is appended if it does not exist.
    fn find_or_append_move(&mut self, op: Op, width: usize) -> Operand {
        let is_same_operation = |known: &Op| {
            *known == op && bits_of_operation_constants(known) == bits_of_operation_constants(&op)
        };
        let known =
            self.moves.iter().rev().find(|(known, lanes, _)| *lanes == width && is_same_operation(known));
        if let Some((.., value)) = known {
            return *value;
        }
        let value = self.push(op, width);
        self.moves.push((op, width, value));
        value
    }

    /// Returns the number of lanes of an operand of the program with lanes.
    fn lane_count(&self, operand: Operand) -> usize {
        match operand {
            Operand::Const(_) | Operand::Symbol(_) => 1,
            Operand::Value(k) => self.values[k].lanes,
            Operand::Tuple(k) => self.from.tuples[k].len(),
            Operand::Gather(k) => self.from.gathers[k].len(),
        }
    }

    /// Returns one lane of an operand; a scalar is the same in all lanes.
    fn lane(&mut self, operand: Operand, k: usize) -> Result<Operand, String> {
        let k = if self.lane_count(operand) == 1 { 0 } else { k };
        match operand {
            Operand::Const(_) | Operand::Symbol(_) => Some(operand),
            Operand::Tuple(t) => self.from.tuples[t].get(k).map(|c| Operand::Const(*c)),
            Operand::Gather(g) => self.from.gathers[g].get(k).map(|symbol| Operand::Symbol(*symbol)),
            Operand::Value(v) => {
                let SplitValue { lanes, pieces } = &self.values[v];
                (k < *lanes).then(|| pieces[k / WIDEST]).map(|piece| self.lane_of_piece(piece, k % WIDEST))
            }
        }
        .ok_or_else(|| "a value has too few lanes".to_string())
    }

    /// Returns a lane of a piece. The first lane is the piece itself.
    fn lane_of_piece(&mut self, piece: Operand, k: usize) -> Operand {
        match (piece, k) {
            (Operand::Tuple(t), k) => Operand::Const(self.program.tuples[t][k]),
            (Operand::Gather(g), k) => Operand::Symbol(self.program.gathers[g][k]),
            (piece, 0) => piece,
            (piece, 1) => self.find_or_append_move(Op::Lane(1, piece), 1),
            (piece, k) => {
                let upper = self.find_or_append_move(Op::Lane(2, piece), 2);
                self.lane_of_piece(upper, k - 2)
            }
        }
    }

    /// Returns piece `k` of an operand in an operation on `lanes` lanes.
    fn piece(&mut self, operand: Operand, lanes: usize, k: usize) -> Result<Operand, String> {
        let (own, width) = (self.lane_count(operand), width_of_piece(lanes, k));
        if own != 1 && own != lanes {
            return Err("operands have different numbers of lanes".to_string());
        }
        let entries = (0..width).map(|lane| (WIDEST * k + lane).min(own - 1));
        match operand {
            Operand::Const(_) | Operand::Symbol(_) if width == 1 => Ok(operand),
            Operand::Const(c) => Ok(self.constant_tuple(vec![c; width])),
            Operand::Tuple(t) => {
                let list: Vec<f64> = entries.map(|lane| self.from.tuples[t][lane]).collect();
                Ok(if width == 1 { Operand::Const(list[0]) } else { self.constant_tuple(list) })
            }
            Operand::Gather(g) => {
                let list: Vec<Symbol> = entries.map(|lane| self.from.gathers[g][lane]).collect();
                Ok(if width == 1 { Operand::Symbol(list[0]) } else { self.load_inputs_as_lanes(list) })
            }
            Operand::Symbol(_) => Ok(self.find_or_append_move(Op::Lane(0, operand), width)),
            Operand::Value(v) => {
                let pieces = &self.values[v].pieces;
                match own {
                    1 if width > 1 => {
                        let scalar = pieces[0];
                        Ok(self.broadcast_scalar(scalar, width))
                    }
                    1 => Ok(pieces[0]),
                    _ => Ok(pieces[k]),
                }
            }
        }
    }

    /// Returns a scalar in all lanes.
    fn broadcast_scalar(&mut self, scalar: Operand, width: usize) -> Operand {
        match scalar {
            Operand::Const(c) => self.constant_tuple(vec![c; width]),
            scalar => self.find_or_append_move(Op::Lane(0, scalar), width),
        }
    }

    fn constant_tuple(&mut self, list: Vec<f64>) -> Operand {
        let bits_of_constants = |list: &[f64]| list.iter().map(|c| c.to_bits()).collect::<Vec<_>>();
        let known =
            self.program.tuples.iter().position(|known| bits_of_constants(known) == bits_of_constants(&list));
        Operand::Tuple(known.unwrap_or_else(|| {
            self.program.tuples.push(list);
            self.program.tuples.len() - 1
        }))
    }

    /// Returns inputs as lanes: they are read together if they are adjacent, and joined otherwise.
    fn load_inputs_as_lanes(&mut self, list: Vec<Symbol>) -> Operand {
        let places: Vec<_> = list.iter().map(|symbol| self.layout.locate_symbol(*symbol)).collect();
        let is_adjacent_slot_pair = |pair: &[Option<(usize, usize)>]| match (pair[0], pair[1]) {
            (Some((slot, index)), Some((other, next))) => slot == other && next == index + 1,
            _ => false,
        };
        if !places.windows(2).all(is_adjacent_slot_pair) {
            let lanes: Vec<Operand> = list.into_iter().map(Operand::Symbol).collect();
            return self.join_scalars_in_piece(&lanes);
        }
        let known = self.program.gathers.iter().position(|known| *known == list);
        Operand::Gather(known.unwrap_or_else(|| {
            self.program.gathers.push(list);
            self.program.gathers.len() - 1
        }))
    }

    /// Returns one, two or four scalars as lanes of one value.
    fn join_scalars_in_piece(&mut self, lanes: &[Operand]) -> Operand {
        match *lanes {
            [a, ref others @ ..] if others.iter().all(|other| is_same_operand(*other, a)) => {
                match others.len() {
                    0 => a,
                    count => self.broadcast_scalar(a, count + 1),
                }
            }
            [a, b] => self.find_or_append_move(Op::Join(1, a, b), 2),
            [a, b, c, d] => {
                let (first, last) =
                    (self.join_scalars_in_piece(&[a, b]), self.join_scalars_in_piece(&[c, d]));
                self.find_or_append_move(Op::Join(2, first, last), WIDEST)
            }
            _ => lanes.first().copied().unwrap_or(Operand::Const(0.0)),
        }
    }

    /// Returns scalars as lanes of a split value.
    fn join_scalars_as_lanes(&mut self, all: &[Operand]) -> SplitValue {
        let lanes = all.len();
        let pieces = (0..lanes.div_ceil(WIDEST)).map(|k| {
            let width = width_of_piece(lanes, k);
            let list: Vec<Operand> = (0..width).map(|lane| all[(WIDEST * k + lane).min(lanes - 1)]).collect();
            self.join_scalars_in_piece(&list)
        });
        SplitValue { lanes, pieces: pieces.collect() }
    }

    /// Returns the sum of the first `n` lanes, in the order of the runtime: the upper half is added to the
    /// lower half until one lane is left.
    fn sum(&mut self, n: usize, a: Operand) -> Result<Operand, String> {
        let lanes = self.lane_count(a);
        let mut piece = match (n, n == lanes) {
            (8, true) => {
                let (first, last) = (self.piece(a, n, 0)?, self.piece(a, n, 1)?);
                self.push(Op::Add(first, last), WIDEST)
            }
            (2 | 4, true) => self.piece(a, n, 0)?,
            _ => {
                let all = (0..n).map(|k| self.lane(a, k)).collect::<Result<_, _>>()?;
                return Ok(self.add_scalar_sum_instructions(all));
            }
        };
        if n >= WIDEST {
            let upper = self.find_or_append_move(Op::Lane(2, piece), 2);
            piece = self.push(Op::Add(piece, upper), 2);
        }
        let last = self.lane_of_piece(piece, 1);
        Ok(self.push(Op::Add(piece, last), 1))
    }

    fn add_scalar_sum_instructions(&mut self, mut lanes: Vec<Operand>) -> Operand {
        while lanes.len() > 1 {
            let half = lanes.len().div_ceil(2);
            for (k, upper) in lanes.split_off(half).into_iter().enumerate() {
                lanes[k] = self.push(Op::Add(lanes[k], upper), 1);
            }
        }
        lanes.first().copied().unwrap_or(Operand::Const(0.0))
    }
}
