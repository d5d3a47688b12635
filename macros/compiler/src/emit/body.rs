//! The straight-line body of a generated function. Values with one use are written where they are used; the others are
//! bound, in blocks of bounded length, since rustc's debug information needs stack for every binding of a block.

use super::function::{Argument, Function, Shape, Signature};
use super::matrices;
use super::scalar::ScalarSpelling;
use crate::expr::{Function as Elementary, Symbol};
use crate::lower::{Op, Operand, Program};
use crate::model::Quantity;
use std::fmt::Write;

/// Most bindings of a block.
const BLOCK: usize = 200;
/// Longest expression that is not bound.
const LINE: usize = 72;

/// Sine and cosine of one angle: the instructions that compute them.
struct Angle {
    angle: Operand,
    sine: Option<usize>,
    cosine: Option<usize>,
}

/// The angles that can be evaluated together at the start: arithmetic of the arguments.
struct Angles {
    list: Vec<Angle>,
    /// By instruction: it is one of their sines or cosines.
    covered: Vec<bool>,
    /// By instruction: an angle needs it.
    before: Vec<bool>,
}

impl Angles {
    fn find(program: &Program) -> Angles {
        let n = program.instructions.len();
        let mut angles = Angles { list: Vec::new(), covered: vec![false; n], before: vec![false; n] };
        let mut plain = vec![false; n];
        for (k, op) in program.instructions.iter().enumerate() {
            let mut all = true;
            op.operands(|o| all &= !matches!(o, Operand::Value(j) if !plain[j]));
            plain[k] = all && !matches!(op, Op::Call(..) | Op::Atan2(..) | Op::Pow(..));
            if let Op::Call(f @ (Elementary::Sin | Elementary::Cos), angle) = *op
                && all
            {
                angles.covered[k] = true;
                angles.add(f, angle, k);
            }
        }
        for angle in &angles.list {
            if let Operand::Value(j) = angle.angle {
                angles.before[j] = true;
            }
        }
        for k in (0..n).rev().filter(|k| plain[*k]) {
            if angles.before[k] {
                program.instructions[k].operands(|o| {
                    if let Operand::Value(j) = o {
                        angles.before[j] = true;
                    }
                });
            }
        }
        angles
    }

    fn add(&mut self, f: Elementary, angle: Operand, k: usize) {
        let known = self.list.iter().position(|a| a.angle == angle);
        let at = known.unwrap_or_else(|| {
            self.list.push(Angle { angle, sine: None, cosine: None });
            self.list.len() - 1
        });
        match f {
            Elementary::Sin => self.list[at].sine = Some(k),
            _ => self.list[at].cosine = Some(k),
        }
    }
}

/// A binding, or an output without a name.
struct Statement {
    /// Values that the left side binds.
    names: Vec<usize>,
    /// Left side.
    pattern: String,
    /// Right side.
    text: String,
    /// Values that the right side names.
    needs: Vec<usize>,
}

/// Text of a value that is not bound.
#[derive(Clone, Default)]
struct Piece {
    text: String,
    needs: Vec<usize>,
    /// 1 for a sum, 2 for a product, 3 for what needs no parentheses.
    level: u8,
}

struct Writer<'a> {
    program: &'a Program,
    scalar: &'a ScalarSpelling,
    arguments: &'a [Argument],
    statements: Vec<Statement>,
    /// By value: its text if it is not bound.
    pieces: Vec<Option<Piece>>,
    /// Functions of the runtime that are called.
    helpers: Vec<&'static str>,
}

/// Writes everything between the braces.
pub fn write_body(out: &mut String, f: &Function, s: &Signature<'_>) {
    let mut w = Writer {
        program: &f.program,
        scalar: s.scalar,
        arguments: &f.arguments,
        statements: Vec::new(),
        pieces: vec![None; f.program.instructions.len()],
        helpers: Vec::new(),
    };
    w.write_instructions();
    let outputs: Vec<Piece> = f.program.outputs.iter().map(|o| w.operand(*o)).collect();
    for helper in s.scalar.helpers() {
        w.helper(helper);
    }
    write_prelude(out, f, s, &w);
    write_statements(out, &w.statements, &outputs);
    write_result(out, f.shape, &outputs, s);
}

impl Writer<'_> {
    fn helper(&mut self, name: &'static str) -> &'static str {
        if !self.helpers.contains(&name) {
            self.helpers.push(name);
        }
        name
    }

    fn write_instructions(&mut self) {
        let angles = Angles::find(self.program);
        for k in 0..self.program.instructions.len() {
            if angles.before[k] {
                self.write_instruction(k);
            }
        }
        self.write_angles(&angles);
        for k in 0..self.program.instructions.len() {
            if !angles.before[k] && !angles.covered[k] {
                self.write_instruction(k);
            }
        }
    }

    fn write_instruction(&mut self, k: usize) {
        let piece = self.instruction(self.program.instructions[k]);
        if self.program.uses[k] == 1 && piece.text.len() <= LINE {
            self.pieces[k] = Some(piece);
        } else {
            self.statements.push(Statement {
                names: vec![k],
                pattern: format!("t{k}"),
                text: piece.text,
                needs: piece.needs,
            });
        }
    }

    /// One call for the sines and cosines of all angles, padded to the width of vector registers.
    fn write_angles(&mut self, angles: &Angles) {
        let name = |k: &Option<usize>| k.map_or("_".to_string(), |k| format!("t{k}"));
        let mut needs = Vec::new();
        let mut arguments = Vec::new();
        for angle in &angles.list {
            let piece = self.operand(angle.angle);
            needs.extend(piece.needs);
            arguments.push(piece.text);
        }
        let mut sines: Vec<String> = angles.list.iter().map(|a| name(&a.sine)).collect();
        let mut cosines: Vec<String> = angles.list.iter().map(|a| name(&a.cosine)).collect();
        let names = angles.list.iter().flat_map(|a| [a.sine, a.cosine]).flatten().collect();
        let (pattern, text) = match arguments.as_slice() {
            [] => return,
            [one] => {
                let helper = self.helper("sin_cos");
                (format!("({}, {})", sines[0], cosines[0]), format!("{helper}({one})"))
            }
            _ => {
                // Lanes fill the registers by themselves.
                let width = match arguments.len() {
                    _ if self.scalar.is_in_lanes() => 1,
                    0..=4 => 4,
                    _ => 8,
                };
                while arguments.len() % width != 0 {
                    arguments.push(self.constant(0.0));
                    sines.push("_".to_string());
                    cosines.push("_".to_string());
                }
                let helper = self.helper("sin_cos_all");
                let pattern = format!("([{}], [{}])", sines.join(", "), cosines.join(", "));
                (pattern, format!("{helper}([{}])", arguments.join(", ")))
            }
        };
        self.statements.push(Statement { names, pattern, text, needs });
    }

    fn operand(&mut self, o: Operand) -> Piece {
        let plain = |text| Piece { text, needs: Vec::new(), level: 3 };
        match o {
            Operand::Const(c) => plain(self.constant(c)),
            Operand::Symbol(s) => plain(self.symbol(s)),
            Operand::Value(k) => self.pieces[k].take().unwrap_or_else(|| Piece {
                text: format!("t{k}"),
                needs: vec![k],
                level: 3,
            }),
        }
    }

    fn constant(&mut self, c: f64) -> String {
        let text = self.scalar.constant(c);
        if c < 0.0 { format!("({text})") } else { text }
    }

    fn symbol(&self, s: Symbol) -> String {
        let quantity = Quantity::of(s);
        if quantity == Quantity::Time {
            return "t".to_string();
        }
        match quantity {
            Quantity::Parameter(k) => return self.scalar.value(k),
            Quantity::Prepared(k) => return self.scalar.spread(format!("c{k}")),
            _ => {}
        }
        self.arguments
            .iter()
            .find_map(|a| a.index(quantity).map(|k| format!("{}{k}", a.name())))
            .unwrap_or_else(|| "missing".to_string())
    }

    fn instruction(&mut self, op: Op) -> Piece {
        match op {
            Op::Neg(a) => {
                let a = self.operand(a);
                let text = format!("-{}", wrap(&a, 3));
                Piece { text, needs: a.needs, level: 2 }
            }
            Op::Add(a, b) => self.infix(a, "+", b, 1, 2),
            Op::Sub(a, b) => self.infix(a, "-", b, 1, 2),
            Op::Mul(a, b) => self.infix(a, "*", b, 2, 3),
            Op::Div(a, b) => self.infix(a, "/", b, 2, 3),
            Op::MulAdd(a, b, c) => self.call("mul_add", &[a, b, c]),
            Op::MulSub(a, b, c) => self.call("mul_sub", &[a, b, c]),
            Op::NegMulAdd(a, b, c) => self.call("neg_mul_add", &[a, b, c]),
            Op::Call(f, a) => self.call(f.name(), &[a]),
            Op::Atan2(a, b) => self.call("atan2", &[a, b]),
            Op::Pow(a, b) => self.call("powf", &[a, b]),
        }
    }

    fn infix(&mut self, a: Operand, op: &str, b: Operand, level: u8, right: u8) -> Piece {
        let (a, b) = (self.operand(a), self.operand(b));
        let text = format!("{} {op} {}", wrap(&a, level), wrap(&b, right));
        let mut needs = a.needs;
        needs.extend(b.needs);
        Piece { text, needs, level }
    }

    fn call(&mut self, helper: &'static str, arguments: &[Operand]) -> Piece {
        let helper = self.helper(helper);
        let mut needs = Vec::new();
        let mut list = Vec::new();
        for argument in arguments {
            let piece = self.operand(*argument);
            needs.extend(piece.needs);
            list.push(piece.text);
        }
        Piece { text: format!("{helper}({})", list.join(", ")), needs, level: 3 }
    }
}

fn wrap(piece: &Piece, level: u8) -> String {
    if piece.level < level { format!("({})", piece.text) } else { piece.text.clone() }
}

/// The numbers that were computed before, as far as the program names them.
fn write_prepared_numbers(out: &mut String, program: &Program, count: usize) {
    let mut named = vec![false; count];
    let mut name = |o: Operand| {
        if let Operand::Symbol(s) = o
            && let Quantity::Prepared(k) = Quantity::of(s)
        {
            named[k] = true;
        }
    };
    program.instructions.iter().for_each(|op| op.operands(&mut name));
    program.outputs.iter().for_each(|o| name(*o));
    if named.contains(&true) {
        let list: Vec<String> = named
            .iter()
            .enumerate()
            .map(|(k, named)| if *named { format!("c{k}") } else { "_".into() })
            .collect();
        let _ = writeln!(out, "let [{}] = self.numbers;", list.join(", "));
    }
}

/// Imports and the numbers of the arguments.
fn write_prelude(out: &mut String, f: &Function, s: &Signature<'_>, w: &Writer<'_>) {
    if !w.helpers.is_empty() {
        let _ = writeln!(out, "use ::linkwork::__private::{{{}}};", w.helpers.join(", "));
    }
    write_prepared_numbers(out, &f.program, s.prepared);
    for argument in &f.arguments {
        let (n, given) = match argument {
            Argument::T => continue,
            Argument::Q => (s.nq, false),
            Argument::V | Argument::A | Argument::Tau => (s.nv, false),
            Argument::U => (s.nu, false),
            Argument::Standard(n) => (*n, false),
            Argument::Given(_, _, n) => (*n, true),
        };
        if n == 0 {
            continue;
        }
        let name = argument.name();
        let list: Vec<String> = (0..n).map(|k| format!("{name}{k}")).collect();
        let list = list.join(", ");
        let _ = if given {
            writeln!(out, "let [{list}] = *{name};")
        } else {
            writeln!(out, "let [[{list}]] = {name}.data.0;")
        };
    }
}

fn write_statements(out: &mut String, statements: &[Statement], outputs: &[Piece]) {
    if statements.len() <= BLOCK {
        for statement in statements {
            write_let(out, statement);
        }
        return;
    }
    // The last block that needs each value decides whether it leaves its own.
    let blocks: Vec<&[Statement]> = statements.chunks(BLOCK).collect();
    let size = statements.iter().flat_map(|s| &s.names).max().map_or(0, |m| m + 1);
    let mut last_need = vec![0; size];
    for (b, block) in blocks.iter().enumerate() {
        for need in block.iter().flat_map(|s| &s.needs) {
            last_need[*need] = b;
        }
    }
    for need in outputs.iter().flat_map(|p| &p.needs) {
        last_need[*need] = blocks.len();
    }
    for (b, block) in blocks.iter().enumerate() {
        let leaving: Vec<String> = block
            .iter()
            .flat_map(|s| &s.names)
            .filter(|k| last_need[**k] > b)
            .map(|k| format!("t{k}"))
            .collect();
        let tuple = match leaving.as_slice() {
            [one] => format!("({one},)"),
            many => format!("({})", many.join(", ")),
        };
        let _ = writeln!(out, "let {tuple} = {{");
        for statement in *block {
            write_let(out, statement);
        }
        let _ = writeln!(out, "{tuple}\n}};");
    }
}

fn write_let(out: &mut String, statement: &Statement) {
    let _ = writeln!(out, "let {} = {};", statement.pattern, statement.text);
}

fn write_result(out: &mut String, shape: Shape, outputs: &[Piece], s: &Signature<'_>) {
    let list = |pieces: &[Piece]| {
        let texts: Vec<&str> = pieces.iter().map(|p| p.text.as_str()).collect();
        format!("[{}]", texts.join(", "))
    };
    let storage = |columns: String, matrix: &str| {
        format!(
            "::linkwork::nalgebra::{matrix}::from_array_storage(::linkwork::nalgebra::ArrayStorage({columns}))\n"
        )
    };
    let matrix = |pieces: &[Piece], rows: usize| {
        let columns: Vec<String> = pieces.chunks(rows.max(1)).map(list).collect();
        storage(format!("[{}]", columns.join(", ")), "SMatrix")
    };
    match shape {
        Shape::Scalar => out.push_str(&outputs.first().map_or(String::new(), |p| p.text.clone())),
        Shape::Array(_) => out.push_str(&list(outputs)),
        Shape::Vector(_) => out.push_str(&storage(format!("[{}]", list(outputs)), "SVector")),
        Shape::Square(n) | Shape::Matrix(n, _) => out.push_str(&matrix(outputs, n)),
        Shape::Pair(_)
        | Shape::Forward(_)
        | Shape::Linear(..)
        | Shape::CalledForward(_)
        | Shape::CalledLinear(..) => {
            let part = |first: usize, rows: usize, columns: usize| {
                matrix(&outputs[first..first + rows * columns], rows)
            };
            out.push_str(&matrices::compose(shape, s, part));
        }
    }
}
