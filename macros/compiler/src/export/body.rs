//! The straight-line body of a function. Values with a single use are inlined, all others are local
//! constants. All arguments are read before the first result is written, so that results may overwrite
//! arguments.

use super::pieces::{CExpression, Statement};
use super::tokens::c_numeric_literal;
use crate::catalogue::Argument;
use crate::expr::{Extreme, Function as Elementary, Lookup, Symbol};
use crate::lower::{Angle, Angles, Op, Operand, Program};
use crate::mechanism::Quantity;
use std::fmt::Write;

/// Maximum length of an expression that is inlined, in characters.
const LINE: usize = 72;
/// Number of angles whose sines and cosines are evaluated together.
const TOGETHER: usize = 4;

/// Map from the index of an output to its assignment target; `None` for outputs that are not stored.
pub type OutputTargets<'a> = &'a dyn Fn(usize) -> Option<String>;

/// Names that the body of a C function may use.
pub struct CBodyScope<'a> {
    /// Arguments of the function, and results of the functions that it calls first.
    pub arguments: &'a [Argument],
    /// Names of the members of the C parameter struct.
    pub parameters: &'a [String],
    /// Members of the C parameter struct that are tables.
    pub tables: &'a [String],
    /// Whether values are read and computed right before their first use, for processors that keep all values
    /// in registers.
    pub is_late: bool,
}

/// Name in place of a value that does not exist. Code that contains it is refused.
pub const MISSING: &str = "lw_missing";

struct CBodyWriter<'a> {
    program: &'a Program,
    scope: &'a CBodyScope<'a>,
    statements: Vec<Statement>,
    /// Expression of each instruction that is inlined; `None` for the other instructions.
    pieces: Vec<Option<CExpression>>,
    /// Arguments and parameters that are already local constants, if each is read before its first use.
    read: Vec<Symbol>,
}

/// Writes a program: input values, statements, and assignments of the results. Returns the expression of the
/// first result, for functions that return it.
pub fn write_program(
    out: &mut String,
    program: &Program,
    scope: &CBodyScope<'_>,
    places: OutputTargets<'_>,
) -> String {
    let pieces = vec![None; program.instructions.len()];
    let mut w = CBodyWriter { program, scope, statements: Vec::new(), pieces, read: Vec::new() };
    if scope.is_late {
        w.write_instructions_with_late_inputs();
    } else {
        write_input_bindings(out, program, scope);
        w.write_instructions();
    }
    let outputs: Vec<CExpression> = program.outputs.iter().map(|o| w.operand_expression(*o)).collect();
    write_statements(out, &w.statements, &outputs, places);
    outputs.into_iter().next().unwrap_or_default().text
}

/// Writes local constants for the arguments and parameters that the program uses.
fn write_input_bindings(out: &mut String, program: &Program, scope: &CBodyScope<'_>) {
    for symbol in program.used_symbols() {
        out.push_str(&argument_constant_definition(symbol, scope));
    }
}

/// Returns the definition of the local constant of an argument or parameter.
fn argument_constant_definition(symbol: Symbol, scope: &CBodyScope<'_>) -> String {
    let quantity = Quantity::from_symbol(symbol);
    match (quantity, local_constant_name(quantity, scope)) {
        (Quantity::Time, _) => String::new(),
        (Quantity::Parameter(k), Some(name)) => {
            format!("    const double {name} = self->{};\n", scope.parameters[k])
        }
        (_, Some(name)) => {
            let found = scope
                .arguments
                .iter()
                .find_map(|a| a.index_of_quantity(quantity).map(|k| (a.argument_name(), k)));
            found.map_or(String::new(), |(argument, k)| {
                format!("    const double {name} = {argument}[{k}];\n")
            })
        }
        _ => String::new(),
    }
}

/// Returns the name of the local constant of a quantity; `None` for a quantity that the scope does not have.
fn local_constant_name(quantity: Quantity, scope: &CBodyScope<'_>) -> Option<String> {
    match quantity {
        Quantity::Time => Some("t".to_string()),
        Quantity::Parameter(k) => scope.parameters.get(k).map(|name| format!("p_{name}")),
        _ => scope
            .arguments
            .iter()
            .find_map(|a| a.index_of_quantity(quantity).map(|k| format!("{}{k}", a.argument_name()))),
    }
}

impl CBodyWriter<'_> {
    fn write_instructions(&mut self) {
        let angles = Angles::find_angles(self.program);
        for k in (0..self.program.instructions.len()).filter(|k| angles.before[*k]) {
            self.write_instruction(k);
        }
        self.write_sines_and_cosines(&angles);
        for k in 0..self.program.instructions.len() {
            if !angles.before[k] && !angles.covered[k] {
                self.write_instruction(k);
            }
        }
    }

    /// Writes all instructions, with arguments, parameters, sines and cosines right before their first use.
    fn write_instructions_with_late_inputs(&mut self) {
        let angles = Angles::find_angles(self.program);
        let mut is_written = vec![false; self.program.instructions.len()];
        for k in 0..self.program.instructions.len() {
            self.program.instructions[k].visit_operands(|o| self.add_input_read_statement(o));
            if !angles.covered[k] {
                self.write_instruction(k);
            } else if !is_written[k] {
                let is_sine_or_cosine_value = |a: &&Angle| a.sine == Some(k) || a.cosine == Some(k);
                let Some(angle) = angles.list.iter().find(is_sine_or_cosine_value) else { continue };
                let text = self.operand_expression(angle.angle).text;
                let mut text = format!(
                    "    double sine{k}, cosine{k};\n    lw_sin_cos({text}, &sine{k}, &cosine{k});\n"
                );
                let mut names = Vec::new();
                for (value, name) in [(angle.sine, "sine"), (angle.cosine, "cosine")] {
                    let Some(value) = value else { continue };
                    let _ = writeln!(text, "    const double t{value} = {name}{k};");
                    is_written[value] = true;
                    names.push(value);
                }
                self.statements.push(Statement { names, text });
            }
        }
        self.program.outputs.clone().into_iter().for_each(|o| self.add_input_read_statement(o));
    }

    /// Adds the statement that reads an argument or parameter, if the operand is one that has not been read
    /// yet.
    fn add_input_read_statement(&mut self, operand: Operand) {
        if let Operand::Symbol(symbol) = operand
            && !self.read.contains(&symbol)
        {
            self.read.push(symbol);
            let text = argument_constant_definition(symbol, self.scope);
            self.statements.push(Statement { names: self.reading_statement_index(symbol), text });
        }
    }

    /// Returns the index of the statement that reads an argument or parameter, after those of the
    /// instructions.
    fn reading_statement_index(&self, symbol: Symbol) -> Vec<usize> {
        let at = self.read.iter().position(|known| *known == symbol);
        at.map(|at| self.program.instructions.len() + at).into_iter().collect()
    }

    fn write_instruction(&mut self, k: usize) {
        let piece = self.instruction_expression(self.program.instructions[k]);
        if self.program.uses[k] == 1 && piece.text.len() <= LINE {
            self.pieces[k] = Some(piece);
        } else {
            let text = format!("    const double t{k} = {};\n", piece.text);
            self.statements.push(Statement { names: vec![k], text });
        }
    }

    /// Writes the evaluation of the sines and cosines of all angles that depend only on inputs, four at a
    /// time.
    fn write_sines_and_cosines(&mut self, angles: &Angles) {
        let count = angles.list.len();
        if count == 0 {
            return;
        }
        let list = angles.angles_by_descending_width(self.program, |_| 1);
        let padded = if count > 2 { count.next_multiple_of(TOGETHER) } else { count };
        let mut texts: Vec<String> =
            list.iter().map(|angle| self.operand_expression(angle.angle).text).collect();
        texts.resize(padded, "0.0".to_string());
        let mut text = format!("    double sine[{padded}], cosine[{padded}];\n");
        if count > 2 {
            let _ = writeln!(text, "    const double angle[{padded}] = {{{}}};", texts.join(", "));
            for first in (0..padded).step_by(TOGETHER) {
                let at = if first == 0 { String::new() } else { format!(" + {first}") };
                let _ = writeln!(text, "    lw_sin_cos_4(angle{at}, sine{at}, cosine{at});");
            }
        } else {
            for (k, angle) in texts.iter().enumerate() {
                let _ = writeln!(text, "    lw_sin_cos({angle}, &sine[{k}], &cosine[{k}]);");
            }
        }
        let mut names = Vec::new();
        for (at, angle) in list.iter().enumerate() {
            for (value, array) in [(angle.sine, "sine"), (angle.cosine, "cosine")] {
                let Some(k) = value else { continue };
                let _ = writeln!(text, "    const double t{k} = {array}[{at}];");
                names.push(k);
            }
        }
        self.statements.push(Statement { names, text });
    }

    fn operand_expression(&mut self, o: Operand) -> CExpression {
        match o {
            Operand::Const(c) if c.is_sign_negative() => {
                CExpression { level: 2, ..CExpression::from_atomic_text(c_numeric_literal(c)) }
            }
            Operand::Const(c) => CExpression::from_atomic_text(c_numeric_literal(c)),
            Operand::Symbol(s) => match local_constant_name(Quantity::from_symbol(s), self.scope) {
                Some(name) => CExpression {
                    needs: self.reading_statement_index(s),
                    ..CExpression::from_atomic_text(name)
                },
                None => CExpression::from_atomic_text(MISSING.to_string()),
            },
            // Programs without lanes contain neither tuples nor gathers.
            Operand::Tuple(_) | Operand::Gather(_) => CExpression::from_atomic_text(MISSING.to_string()),
            Operand::Value(k) => self.pieces[k].take().unwrap_or_else(|| CExpression {
                text: format!("t{k}"),
                needs: vec![k],
                level: 3,
            }),
        }
    }

    fn instruction_expression(&mut self, op: Op) -> CExpression {
        match op {
            Op::Neg(a) => {
                let a = self.operand_expression(a);
                CExpression { text: format!("-{}", a.text_at_precedence(3)), level: 2, needs: a.needs }
            }
            Op::Add(a, b) => self.infix_operation([a, b], "+", (1, 2)),
            Op::Sub(a, b) => self.infix_operation([a, b], "-", (1, 2)),
            Op::Mul(a, b) => self.infix_operation([a, b], "*", (2, 3)),
            Op::Div(a, b) => self.infix_operation([a, b], "/", (2, 3)),
            Op::MulAdd(a, b, c) => self.call_expression("lw_mul_add", &[a, b, c]),
            Op::MulSub(a, b, c) => self.call_expression("lw_mul_sub", &[a, b, c]),
            Op::NegMulAdd(a, b, c) => self.call_expression("lw_neg_mul_add", &[a, b, c]),
            Op::Call(f, a) => self.call_expression(&elementary_function_name(f), &[a]),
            Op::Atan2(a, b) => self.call_expression("atan2", &[a, b]),
            Op::Pow(a, b) => self.call_expression("pow", &[a, b]),
            Op::Extreme(Extreme::Min, a, b) => self.call_expression("fmin", &[a, b]),
            Op::Extreme(Extreme::Max, a, b) => self.call_expression("fmax", &[a, b]),
            Op::Table(lookup, a, b, c) => self.table_lookup_expression(lookup, [a, b, c]),
            // Rejected by `check`.
            Op::Sum(..) | Op::Lane(..) | Op::Join(..) => CExpression::from_atomic_text(MISSING.to_string()),
        }
    }

    fn table_lookup_expression(&mut self, lookup: Lookup, x: [Operand; 3]) -> CExpression {
        let count = lookup.variable_count();
        let pieces: Vec<CExpression> = x.iter().take(count).map(|o| self.operand_expression(*o)).collect();
        let x: Vec<&str> = pieces.iter().map(|piece| piece.text.as_str()).collect();
        let orders: Vec<String> = lookup.derivative_orders().iter().map(ToString::to_string).collect();
        let Some(table) = self.scope.tables.get(lookup.table_index()) else {
            return CExpression::from_atomic_text(MISSING.to_string());
        };
        let text = format!("lw_tabulated_{count}(&self->{table}, {}, {})", x.join(", "), orders.join(", "));
        CExpression { text, needs: pieces.into_iter().flat_map(|piece| piece.needs).collect(), level: 3 }
    }

    fn infix_operation(&mut self, [a, b]: [Operand; 2], sign: &str, (level, right): (u8, u8)) -> CExpression {
        let (a, b) = (self.operand_expression(a), self.operand_expression(b));
        let text = format!("{} {sign} {}", a.text_at_precedence(level), b.text_at_precedence(right));
        CExpression { text, needs: [a.needs, b.needs].concat(), level }
    }

    fn call_expression(&mut self, function: &str, arguments: &[Operand]) -> CExpression {
        let pieces: Vec<CExpression> = arguments.iter().map(|o| self.operand_expression(*o)).collect();
        let list: Vec<&str> = pieces.iter().map(|piece| piece.text.as_str()).collect();
        let text = format!("{function}({})", list.join(", "));
        CExpression { text, needs: pieces.into_iter().flat_map(|piece| piece.needs).collect(), level: 3 }
    }
}

/// Returns the name of an elementary function in C.
fn elementary_function_name(f: Elementary) -> String {
    match f {
        Elementary::Ln => "log".to_string(),
        Elementary::Abs => "fabs".to_string(),
        Elementary::Signum
        | Elementary::IsaTemperature
        | Elementary::IsaLapseRate
        | Elementary::IsaPressure => {
            format!("lw_{}", f.function_name())
        }
        other => other.function_name().to_string(),
    }
}

/// Writes the statements. Each result is assigned right after the last statement that it depends on.
fn write_statements(
    out: &mut String,
    statements: &[Statement],
    outputs: &[CExpression],
    places: OutputTargets<'_>,
) {
    let size = statements.iter().flat_map(|s| &s.names).max().map_or(0, |m| m + 1);
    let mut bound_by = vec![0; size];
    for (k, statement) in statements.iter().enumerate() {
        statement.names.iter().for_each(|name| bound_by[*name] = k + 1);
    }
    let mut ready: Vec<String> = vec![String::new(); statements.len() + 1];
    for (k, piece) in outputs.iter().enumerate() {
        let Some(place) = places(k) else { continue };
        let after = piece.needs.iter().filter_map(|need| bound_by.get(*need)).max().copied().unwrap_or(0);
        let _ = writeln!(ready[after], "    {place} = {};", piece.text);
    }
    out.push_str(&ready[0]);
    for (statement, ready) in statements.iter().zip(&ready[1..]) {
        out.push_str(&statement.text);
        out.push_str(ready);
    }
}
