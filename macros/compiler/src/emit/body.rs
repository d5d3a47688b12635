//! Straight-line body of a generated function. A value with one use is written inline; other values are bound
//! to names. Blocks have bounded length, because rustc's debug information needs stack for every binding of a
//! block.

use super::angles::{SineCosineCalls, WIDTH};
use super::instruction::{BodyWriter, BuildKind};
use super::pieces::{ExpressionPiece, OutputTexts, Statement, storage_constructor};
use super::signature::{SignatureContext, result_matrix_names, variant_matrix_argument_count};
use super::statements::{BLOCK, write_body_statement, write_statements};
use super::{block_loops, matrices, stores};
use crate::catalogue::{Argument, CalledFunction, Shape};
use crate::derive::Function;
use crate::expr::Symbol;
use crate::lower::{Angle, Angles, Operand};
use crate::mechanism::Quantity;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Maximum length of an expression that is written inline, in characters.
const LINE: usize = 72;

/// Writes the function body without its braces. If `is_parameter` is true, the arithmetic `Ops` is a type
/// parameter of the function; otherwise `Ops` is the arithmetic of the compilation target.
pub fn write_body(
    out: &mut String,
    f: &Function,
    s: &SignatureContext<'_>,
    is_parameter: bool,
    build: BuildKind,
) {
    if let Some(count) = variant_matrix_argument_count(f) {
        out.push_str(&matrices::body_calling_matrix_argument_variant(f, count, s));
        return;
    }
    // Functions of several states already fill the lanes.
    let single = build == BuildKind::Optimised && !s.scalar.uses_batch_lanes();
    let in_lanes = f.program.simd.as_deref().filter(|_| single);
    let loops = f.loops.as_deref().filter(|_| single);
    let program = loops.map(|loops| &loops.program).or(in_lanes).unwrap_or(&f.program);
    let mut w = BodyWriter {
        build,
        program,
        lanes: program.lane_counts(),
        scalar: s.scalar,
        arguments: f.arguments.iter().copied().chain(CalledFunction::ALL.map(Argument::Called)).collect(),
        statements: Vec::new(),
        pieces: vec![None; program.instructions.len()],
        head: 0,
        early: Vec::new(),
        named: is_parameter.then(BTreeSet::new),
    };
    w.write_instructions();
    let outputs: Vec<ExpressionPiece> = program.outputs.iter().map(|o| w.output_text(*o)).collect();
    let mut helpers: Vec<&str> = s.scalar.runtime_functions_called_by_constants().collect();
    if !is_parameter {
        helpers.extend(["Arithmetic", "Compiled as Ops"]);
    }
    let is_empty =
        program.instructions.is_empty() && program.outputs.is_empty() && !f.shape.is_assembled_from_calls();
    if !helpers.is_empty() && (!is_empty || s.scalar.uses_batch_lanes()) {
        let _ = writeln!(out, "use ::linkwork::__private::{{{}}};", helpers.join(", "));
    }
    w.write_named_operations(out);
    // Arguments on which no angle depends are read after the sines and cosines: before them, they would be
    // spilled to memory.
    let head = if w.head <= BLOCK { w.head } else { 0 };
    let (early, late): (Vec<Argument>, Vec<Argument>) =
        w.arguments.iter().partition(|a| head == 0 || **a == Argument::T || w.early.contains(a));
    write_input_bindings(out, &early, s, &w);
    w.statements[..head].iter().for_each(|statement| write_body_statement(out, statement));
    write_input_bindings(out, &late, s, &w);
    let rest = w.statements.split_off(head);
    if let Some(loops) = loops {
        let zero = s.scalar.constant_expression(0.0);
        out.push_str(&block_loops::link_array_declaration(loops, &outputs, &zero));
        let rest = block_loops::insert_link_store_statements(loops, rest, &outputs);
        write_statements(out, &rest, block_loops::outputs_in_loop_call(loops, &outputs));
        out.push_str(&block_loops::call_of_loops(f, loops, s, &outputs));
        return;
    }
    let is_zero_output = |k: usize| program.outputs.get(k).is_none_or(|o| *o == Operand::Const(0.0));
    let results = OutputTexts { pieces: &outputs, is_zero: &is_zero_output };
    if !result_matrix_names(f).is_empty() {
        let (statements, left) = stores::insert_result_stores(f, program, rest, &results);
        write_statements(out, &statements, &left);
        out.push_str(&matrices::matrix_function_epilogue(f, s, &results));
        return;
    }
    write_statements(out, &rest, &outputs);
    write_result(out, f, &results, s);
}

impl BodyWriter<'_> {
    fn write_instructions(&mut self) {
        let angles = Angles::find_angles(self.program);
        for k in 0..self.program.instructions.len() {
            if angles.before[k] {
                self.write_instruction(k);
            }
        }
        self.write_sines_and_cosines(&angles);
        if !angles.list.is_empty() {
            self.head = self.statements.len();
            self.early = self.arguments_determining_angles(&angles);
        }
        for k in 0..self.program.instructions.len() {
            if !angles.before[k] && !angles.covered[k] {
                self.write_instruction(k);
            }
        }
    }

    fn write_instruction(&mut self, k: usize) {
        let piece = self.instruction_text(self.program.instructions[k], self.lanes[k]);
        if self.program.uses[k] == 1 && piece.text.len() <= LINE {
            self.pieces[k] = Some(piece);
        } else {
            self.bind_value(k, piece);
        }
    }

    fn bind_value(&mut self, k: usize, piece: ExpressionPiece) {
        self.statements.push(Statement {
            names: vec![k],
            pattern: format!("t{k}"),
            text: piece.text,
            needs: piece.needs,
        });
    }

    /// Returns the arguments of the function on which the angles depend.
    fn arguments_determining_angles(&self, angles: &Angles) -> Vec<Argument> {
        let mut symbols = Vec::new();
        let mut collect_input_symbols = |o: Operand| match o {
            Operand::Symbol(s) => symbols.push(s),
            Operand::Gather(k) => symbols.extend(&self.program.gathers[k]),
            _ => {}
        };
        angles.list.iter().for_each(|angle| collect_input_symbols(angle.angle));
        for (op, before) in self.program.instructions.iter().zip(&angles.before) {
            if *before {
                op.visit_operands(&mut collect_input_symbols);
            }
        }
        let is_argument_used =
            |a: &Argument| symbols.iter().any(|s| a.index_of_quantity(Quantity::from_symbol(*s)).is_some());
        self.arguments.iter().copied().filter(is_argument_used).collect()
    }

    /// Writes the statement that computes the sines and cosines of all angles known from the start.
    fn write_sines_and_cosines(&mut self, angles: &Angles) {
        // Sums of angles are combined to vectors from named values: in an array they would be stored to
        // memory individually.
        let is_angle_sum = |angle: &Angle| {
            let (mut inputs, mut todo) = (0, vec![angle.angle]);
            while let Some(o) = todo.pop().filter(|_| inputs < 2) {
                match o {
                    Operand::Value(k) => self.program.instructions[k].visit_operands(|o| todo.push(o)),
                    Operand::Symbol(_) | Operand::Gather(_) => inputs += 1,
                    Operand::Const(_) | Operand::Tuple(_) => {}
                }
            }
            inputs > 1
        };
        let of_state = !self.scalar.uses_batch_lanes();
        let in_vectors =
            !self.program.gathers.is_empty() || (of_state && angles.list.iter().any(is_angle_sum));
        let mut calls = SineCosineCalls::new(in_vectors, of_state);
        let mut needs = Vec::new();
        for angle in angles.angles_by_descending_width(self.program, |o| self.lane_count(o)) {
            let texts = self.texts_of_angle_lanes(angle.angle, &mut needs);
            calls.add_angle(angle, texts, self.lane_count(angle.angle) == WIDTH);
        }
        if calls.names.is_empty() {
            return;
        }
        let (names, text) = calls.value_numbers_and_tuple_text(&self.constant_text(0.0));
        let list: Vec<String> = names.iter().map(|k| format!("t{k}")).collect();
        self.statements.push(Statement { pattern: format!("({},)", list.join(", ")), names, text, needs });
    }

    /// Returns the texts of the lanes of an angle; of an angle with four lanes, the text of the vector.
    fn texts_of_angle_lanes(&mut self, angle: Operand, needs: &mut Vec<usize>) -> Vec<String> {
        let lanes = self.lane_count(angle);
        if let Operand::Gather(g) = angle
            && lanes != WIDTH
        {
            return self.program.gathers[g].iter().map(|s| self.input_symbol_text(*s)).collect();
        }
        if let Operand::Value(k) = angle
            && !(lanes == 1 || lanes == WIDTH)
            && let Some(piece) = self.pieces[k].take()
        {
            self.bind_value(k, piece);
        }
        let piece = self.operand_text(angle);
        needs.extend(piece.needs);
        match lanes {
            1 | WIDTH => vec![piece.text],
            _ => (0..lanes).map(|k| format!("{}.lane::<{k}>()", piece.text)).collect(),
        }
    }
}

/// Writes the bindings of the used entries of arguments and of results of called functions, and of their
/// gathers.
fn write_input_bindings(
    out: &mut String,
    arguments: &[Argument],
    s: &SignatureContext<'_>,
    w: &BodyWriter<'_>,
) {
    let in_lanes = s.scalar.uses_batch_lanes();
    let used = w.program.used_symbols();
    for argument in arguments {
        let (n, given) = match argument {
            Argument::T => {
                out.push_str(if in_lanes { "let time = Ops::lanes(t.0);\n" } else { "" });
                continue;
            }
            Argument::Q => (s.nq, false),
            Argument::V | Argument::A | Argument::Tau => (s.nv, false),
            Argument::U => (s.nu, false),
            Argument::Standard(n) | Argument::Factors(n) | Argument::Momenta(n) => (*n, false),
            Argument::Given(_, _, n) => (*n, true),
            Argument::Into(..) => continue,
            Argument::Called(_) => (usize::MAX, false),
        };
        let name = match argument {
            Argument::Called(f) => {
                let arguments = s.with_time_argument(f.arguments());
                let names: Vec<&str> = arguments.iter().map(|a| a.argument_name()).collect();
                format!("self.{}{}({})", f.function_name(), s.lane_function_suffix(), names.join(", "))
            }
            _ => argument.argument_name().to_string(),
        };
        let Some(list) = argument_pattern(*argument, n, &used) else { continue };
        let _ = match (given, in_lanes) {
            (true, false) => writeln!(out, "let [{list}] = *{name};"),
            (true, true) => writeln!(out, "let [{list}] = *Ops::each({name});"),
            (false, false) => writeln!(out, "let [[{list}]] = {name}.data.0;"),
            (false, true) => writeln!(out, "let [{list}] = *Ops::each(&{name}.data.0[0]);"),
        };
        for (k, gather) in w.program.gathers.iter().enumerate() {
            if gather.iter().any(|s| argument.index_of_quantity(Quantity::from_symbol(*s)).is_some()) {
                let _ = writeln!(out, "let lanes{k} = {};", w.gathered_vector(gather));
            }
        }
    }
}

/// Returns the array pattern that binds the entries of an argument that a program uses, or `None` if it uses
/// none. Unused entries are not bound, because rustc takes long for unused variables.
fn argument_pattern(argument: Argument, n: usize, used: &BTreeSet<Symbol>) -> Option<String> {
    let mut list = Vec::new();
    for k in
        used.iter().filter_map(|s| argument.index_of_quantity(Quantity::from_symbol(*s))).filter(|k| *k < n)
    {
        let length = list.len().max(k + 1);
        list.resize(length, "_".to_string());
        list[k] = format!("{}{k}", argument.argument_name());
    }
    if list.is_empty() {
        return None;
    }
    if list.len() < n {
        list.push("..".to_string());
    }
    Some(list.join(", "))
}

fn write_result(out: &mut String, f: &Function, outputs: &OutputTexts<'_>, s: &SignatureContext<'_>) {
    match f.shape {
        Shape::Scalar => outputs.pieces.iter().for_each(|piece| out.push_str(&piece.text)),
        Shape::Array(_) => out.push_str(&outputs.array_of_outputs(0..outputs.pieces.len())),
        Shape::Vector(n) => {
            let _ = writeln!(
                out,
                "{}",
                storage_constructor(&format!("[{}]", outputs.array_of_outputs(0..n)), "SVector")
            );
        }
        Shape::Square(n) => {
            let _ = writeln!(out, "{}", outputs.output_matrix_constructor_text(0, n, n));
        }
        Shape::Matrix(rows, columns) => {
            let _ = writeln!(out, "{}", outputs.output_matrix_constructor_text(0, rows, columns));
        }
        Shape::Record(record) => out.push_str(&outputs.record_of_outputs(record)),
        Shape::Symmetric(_) => {}
        Shape::Inverse(_)
        | Shape::Pair(_)
        | Shape::Hessian(_)
        | Shape::Jacobians(..)
        | Shape::InputPowerHessian(..)
        | Shape::Forward(_)
        | Shape::Linear(..)
        | Shape::Accelerated(_)
        | Shape::ForwardDerivativesByCalls(_)
        | Shape::CalledLinear(..) => out.push_str(&matrices::result_expression_text(f, s, outputs)),
    }
}
