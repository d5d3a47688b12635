//! The straight-line body of a generated function. Values with one use are written where they are used; the others are
//! bound, in blocks of bounded length, since rustc's debug information needs stack for every binding of a block.

use super::angles::{Calls, WIDTH};
use super::pieces::{Outputs, Piece, Statement, storage};
use super::scalar::ScalarSpelling;
use super::signature::{Signature, filled, given};
use super::{matrices, stores};
use crate::catalogue::{Argument, Called, Shape};
use crate::derive::Function;
use crate::expr::{Lookup, Symbol};
use crate::lower::{Angle, Angles, Op, Operand, Program};
use crate::mechanism::Quantity;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Most bindings of a block.
const BLOCK: usize = 200;
/// Longest expression that is not bound.
const LINE: usize = 72;

/// For which builds a body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// For those that are optimised, and where there is no other body, for all.
    Optimised,
    /// For those with debug assertions. Without optimisation a call takes longer than what it computes, and every value
    /// that is passed takes stack of its own: numbers alone, and operators instead of calls.
    Debug,
}

struct Writer<'a> {
    build: Build,
    program: &'a Program,
    /// By value: how many lanes it has, one for none.
    lanes: Vec<usize>,
    scalar: &'a ScalarSpelling,
    /// Those of the function, and what it calls.
    arguments: Vec<Argument>,
    statements: Vec<Statement>,
    /// By value: its text if it is not bound.
    pieces: Vec<Option<Piece>>,
    /// How many statements end with the angles, and the arguments that these need.
    head: usize,
    early: Vec<Argument>,
    /// Operations of `Ops` that are named before all statements, each for so many lanes; none if they are not to be named.
    named: Option<BTreeSet<(&'static str, usize)>>,
}

/// Writes everything between the braces. The arithmetic `Ops` is a parameter of the function, or else that of the target.
pub fn write_body(out: &mut String, f: &Function, s: &Signature<'_>, is_parameter: bool, build: Build) {
    if let Some(count) = filled(f) {
        out.push_str(&matrices::called(f, count, s));
        return;
    }
    // Several states fill the lanes by themselves.
    let in_lanes = f.program.simd.as_deref().filter(|_| build == Build::Optimised && !s.scalar.is_in_lanes());
    let program = in_lanes.unwrap_or(&f.program);
    let mut w = Writer {
        build,
        program,
        lanes: program.lanes(),
        scalar: s.scalar,
        arguments: f.arguments.iter().copied().chain(Called::ALL.map(Argument::Called)).collect(),
        statements: Vec::new(),
        pieces: vec![None; program.instructions.len()],
        head: 0,
        early: Vec::new(),
        named: is_parameter.then(BTreeSet::new),
    };
    w.write_instructions();
    let outputs: Vec<Piece> = program.outputs.iter().map(|o| w.output(*o)).collect();
    let mut helpers: Vec<&str> = s.scalar.helpers().collect();
    if !is_parameter {
        helpers.extend(["Arithmetic", "Compiled as Ops"]);
    }
    let is_empty = program.instructions.is_empty() && program.outputs.is_empty() && !f.shape.calls();
    if !helpers.is_empty() && (!is_empty || s.scalar.is_in_lanes()) {
        let _ = writeln!(out, "use ::linkwork::__private::{{{}}};", helpers.join(", "));
    }
    w.write_named(out);
    // What the angles do not need is read when they are done: it would wait in memory, not in registers.
    let head = if w.head <= BLOCK { w.head } else { 0 };
    let (early, late): (Vec<Argument>, Vec<Argument>) =
        w.arguments.iter().partition(|a| head == 0 || **a == Argument::T || w.early.contains(a));
    write_inputs(out, &early, s, &w);
    w.statements[..head].iter().for_each(|statement| write_let(out, statement));
    write_inputs(out, &late, s, &w);
    let rest = w.statements.split_off(head);
    let is_zero = |k: usize| program.outputs.get(k).is_none_or(|o| *o == Operand::Const(0.0));
    let results = Outputs { pieces: &outputs, is_zero: &is_zero };
    if !given(f).is_empty() {
        let (statements, left) = stores::with_stores(f, program, rest, &results);
        write_statements(out, &statements, &left);
        out.push_str(&matrices::finish(f, s, &results));
        return;
    }
    write_statements(out, &rest, &outputs);
    write_result(out, f, &results, s);
}

impl Writer<'_> {
    fn write_instructions(&mut self) {
        let angles = Angles::find(self.program);
        for k in 0..self.program.instructions.len() {
            if angles.before[k] {
                self.write_instruction(k);
            }
        }
        self.write_angles(&angles);
        if !angles.list.is_empty() {
            self.head = self.statements.len();
            self.early = self.arguments_of(&angles);
        }
        for k in 0..self.program.instructions.len() {
            if !angles.before[k] && !angles.covered[k] {
                self.write_instruction(k);
            }
        }
    }

    fn write_instruction(&mut self, k: usize) {
        let piece = self.instruction(self.program.instructions[k], self.lanes[k]);
        if self.program.uses[k] == 1 && piece.text.len() <= LINE {
            self.pieces[k] = Some(piece);
        } else {
            self.bind(k, piece);
        }
    }

    fn bind(&mut self, k: usize, piece: Piece) {
        self.statements.push(Statement {
            names: vec![k],
            pattern: format!("t{k}"),
            text: piece.text,
            needs: piece.needs,
        });
    }

    /// The arguments that angles depend on.
    fn arguments_of(&self, angles: &Angles) -> Vec<Argument> {
        let mut symbols = Vec::new();
        let mut note = |o: Operand| match o {
            Operand::Symbol(s) => symbols.push(s),
            Operand::Gather(k) => symbols.extend(&self.program.gathers[k]),
            _ => {}
        };
        angles.list.iter().for_each(|angle| note(angle.angle));
        for (op, before) in self.program.instructions.iter().zip(&angles.before) {
            if *before {
                op.operands(&mut note);
            }
        }
        let is_needed = |a: &Argument| symbols.iter().any(|s| a.index(Quantity::of(*s)).is_some());
        self.arguments.iter().copied().filter(is_needed).collect()
    }

    /// The sines and cosines of all angles.
    fn write_angles(&mut self, angles: &Angles) {
        // Sums of angles become vectors by name: in an array they would go through memory, one by one.
        let is_sum = |angle: &Angle| {
            let (mut inputs, mut todo) = (0, vec![angle.angle]);
            while let Some(o) = todo.pop().filter(|_| inputs < 2) {
                match o {
                    Operand::Value(k) => self.program.instructions[k].operands(|o| todo.push(o)),
                    Operand::Symbol(_) | Operand::Gather(_) => inputs += 1,
                    Operand::Const(_) | Operand::Tuple(_) => {}
                }
            }
            inputs > 1
        };
        let of_state = !self.scalar.is_in_lanes();
        let in_vectors = !self.program.gathers.is_empty() || (of_state && angles.list.iter().any(is_sum));
        let mut calls = Calls::new(in_vectors, of_state);
        let mut needs = Vec::new();
        for angle in angles.widest_first(self.program, |o| self.width(o)) {
            let texts = self.angle(angle.angle, &mut needs);
            calls.add(angle, texts, self.width(angle.angle) == WIDTH);
        }
        if calls.names.is_empty() {
            return;
        }
        let (names, text) = calls.text(&self.constant(0.0));
        let list: Vec<String> = names.iter().map(|k| format!("t{k}")).collect();
        self.statements.push(Statement { pattern: format!("({},)", list.join(", ")), names, text, needs });
    }

    /// The texts of an angle's lanes; of four the text of all together.
    fn angle(&mut self, angle: Operand, needs: &mut Vec<usize>) -> Vec<String> {
        let lanes = self.width(angle);
        if let Operand::Gather(g) = angle
            && lanes != WIDTH
        {
            return self.program.gathers[g].iter().map(|s| self.symbol(*s)).collect();
        }
        if let Operand::Value(k) = angle
            && !(lanes == 1 || lanes == WIDTH)
            && let Some(piece) = self.pieces[k].take()
        {
            self.bind(k, piece);
        }
        let piece = self.operand(angle);
        needs.extend(piece.needs);
        match lanes {
            1 | WIDTH => vec![piece.text],
            _ => (0..lanes).map(|k| format!("{}.lane::<{k}>()", piece.text)).collect(),
        }
    }

    /// The text of a value from those of its lanes.
    fn in_lanes(&mut self, lanes: &[String]) -> String {
        match lanes {
            [one] => one.clone(),
            _ => format!("Ops::lanes([{}])", lanes.join(", ")),
        }
    }

    fn gathered(&self, gather: &[Symbol]) -> String {
        let symbols: Vec<String> = gather.iter().map(|s| self.symbol(*s)).collect();
        format!("Ops::lanes([{}])", symbols.join(", "))
    }

    fn width(&self, o: Operand) -> usize {
        match o {
            Operand::Const(_) | Operand::Symbol(_) => 1,
            Operand::Value(k) => self.lanes[k],
            Operand::Tuple(k) => self.program.tuples[k].len(),
            Operand::Gather(k) => self.program.gathers[k].len(),
        }
    }

    /// An operand of an operation on so many lanes.
    fn widened(&mut self, o: Operand, lanes: usize) -> Piece {
        let own = self.width(o);
        let piece = self.operand(o);
        if own == lanes {
            return piece;
        }
        let text = match self.name("splat", lanes) {
            Some(splat) => format!("{splat}({})", piece.text),
            None => format!("Ops::splat::<_, {lanes}>({})", piece.text),
        };
        Piece { text, needs: piece.needs, level: 3 }
    }

    fn operand(&mut self, o: Operand) -> Piece {
        let plain = |text| Piece { text, needs: Vec::new(), level: 3 };
        match o {
            Operand::Const(c) => plain(self.constant(c)),
            Operand::Symbol(s) => plain(self.symbol(s)),
            Operand::Tuple(k) => {
                let tuple: Vec<String> =
                    self.program.tuples[k].iter().map(|c| self.scalar.constant(*c)).collect();
                plain(self.in_lanes(&tuple))
            }
            Operand::Gather(k) => {
                let gather = &self.program.gathers[k];
                let is_input = |a: &Argument| gather.iter().any(|s| a.index(Quantity::of(*s)).is_some());
                // Parameters of the lanes are no arguments.
                plain(match self.arguments.iter().any(is_input) {
                    true => format!("lanes{k}"),
                    false => self.gathered(gather),
                })
            }
            Operand::Value(k) => self.pieces[k].take().unwrap_or_else(|| Piece {
                text: format!("t{k}"),
                needs: vec![k],
                level: 3,
            }),
        }
    }

    /// A result: of several states no longer as a vector, but as lanes.
    fn output(&mut self, o: Operand) -> Piece {
        let piece = self.operand(o);
        match self.scalar.is_in_lanes() {
            true => Piece { text: format!("{}.lanes()", wrap(&piece, 3)), level: 3, ..piece },
            false => piece,
        }
    }

    fn constant(&mut self, c: f64) -> String {
        let text = self.scalar.constant(c);
        if c < 0.0 { format!("({text})") } else { text }
    }

    fn symbol(&self, s: Symbol) -> String {
        let quantity = Quantity::of(s);
        if quantity == Quantity::Time {
            return if self.scalar.is_in_lanes() { "time" } else { "t" }.to_string();
        }
        match quantity {
            Quantity::Parameter(k) => return self.scalar.value(k),
            Quantity::Prepared(k) => return self.scalar.spread(format!("self.numbers[{k}]")),
            _ => {}
        }
        self.arguments
            .iter()
            .find_map(|a| a.index(quantity).map(|k| format!("{}{k}", a.name())))
            .unwrap_or_else(|| "missing".to_string())
    }

    /// The text of an instruction whose result has so many lanes.
    fn instruction(&mut self, op: Op, lanes: usize) -> Piece {
        match op {
            Op::Neg(a) => {
                let a = self.operand(a);
                let text = format!("-{}", wrap(&a, 3));
                Piece { text, needs: a.needs, level: 2 }
            }
            Op::Add(a, b) => self.infix([a, b], "+", lanes, (1, 2)),
            Op::Sub(a, b) => self.infix([a, b], "-", lanes, (1, 2)),
            Op::Mul(a, b) => self.infix([a, b], "*", lanes, (2, 3)),
            Op::Div(a, b) => self.infix([a, b], "/", lanes, (2, 3)),
            Op::MulAdd(a, b, c) if self.build == Build::Debug => self.product_and([a, b], "+", c),
            Op::MulSub(a, b, c) if self.build == Build::Debug => self.product_and([a, b], "-", c),
            Op::NegMulAdd(a, b, c) if self.build == Build::Debug => self.less_product(c, [a, b]),
            Op::MulAdd(a, b, c) => self.fused("mul_add", [a, b, c], lanes),
            Op::MulSub(a, b, c) => self.fused("mul_sub", [a, b, c], lanes),
            Op::NegMulAdd(a, b, c) => self.fused("neg_mul_add", [a, b, c], lanes),
            Op::Call(f, a) => self.call(f.name(), &[a], lanes),
            Op::Atan2(a, b) => self.call("atan2", &[a, b], lanes),
            Op::Pow(a, b) => self.call("powf", &[a, b], lanes),
            Op::Extreme(f, a, b) => self.call(f.name(), &[a, b], lanes),
            Op::Table(lookup, a, b, c) => self.lookup(lookup, [a, b, c], lanes),
            Op::Sum(n, a) if n == self.width(a) => self.suffix(a, ".sum()"),
            Op::Sum(n, a) => self.suffix(a, &format!(".first::<{n}>().sum()")),
            Op::Lane(k, a) => self.suffix(a, &format!(".lane::<{k}>()")),
            Op::Join(n, a, b) => {
                let (a, b) = (self.widened(a, n), self.widened(b, n));
                let text = match n {
                    1 => format!("Ops::lanes([{}, {}])", a.text, b.text),
                    _ => format!("Ops::join::<_, {n}, {}>({}, {})", 2 * n, a.text, b.text),
                };
                Piece { text, needs: [a.needs, b.needs].concat(), level: 3 }
            }
        }
    }

    fn suffix(&mut self, a: Operand, suffix: &str) -> Piece {
        let a = self.operand(a);
        Piece { text: format!("{}{suffix}", wrap(&a, 3)), needs: a.needs, level: 3 }
    }

    fn infix(&mut self, [a, b]: [Operand; 2], op: &str, lanes: usize, (level, right): (u8, u8)) -> Piece {
        let (a, b) = (self.widened(a, lanes), self.widened(b, lanes));
        let text = format!("{} {op} {}", wrap(&a, level), wrap(&b, right));
        let mut needs = a.needs;
        needs.extend(b.needs);
        Piece { text, needs, level }
    }

    /// `a * b + c` or `a * b - c`.
    fn product_and(&mut self, product: [Operand; 2], op: &str, c: Operand) -> Piece {
        let product = self.infix(product, "*", 1, (2, 3));
        let c = self.operand(c);
        let text = format!("{} {op} {}", product.text, wrap(&c, 2));
        Piece { text, needs: [product.needs, c.needs].concat(), level: 1 }
    }

    /// `c - a * b`.
    fn less_product(&mut self, c: Operand, product: [Operand; 2]) -> Piece {
        let c = self.operand(c);
        let product = self.infix(product, "*", 1, (2, 3));
        let text = format!("{} - {}", wrap(&c, 1), product.text);
        Piece { text, needs: [c.needs, product.needs].concat(), level: 1 }
    }

    /// A call of an operation that large bodies name.
    fn fused(&mut self, function: &'static str, arguments: [Operand; 3], lanes: usize) -> Piece {
        let name = self.name(function, lanes).unwrap_or_else(|| format!("Ops::{function}"));
        self.call_by(&name, &arguments, lanes)
    }

    /// The name of an operation on so many lanes, if it gets one.
    fn name(&mut self, function: &'static str, lanes: usize) -> Option<String> {
        self.named.as_mut()?.insert((function, lanes));
        Some(if lanes == 1 { function.to_string() } else { format!("{function}{lanes}") })
    }

    /// The operations that are called over and over, each as a value: rustc finds out once, not at every call, what they
    /// are generic over and whether that has what they ask for.
    fn write_named(&self, out: &mut String) {
        let one = self.scalar.one();
        for (function, lanes) in self.named.iter().flatten() {
            let (name, width) = match (lanes, self.scalar.is_in_lanes()) {
                (1, false) => (function.to_string(), None),
                (1, true) => (function.to_string(), Some("LANES".to_string())),
                _ => (format!("{function}{lanes}"), Some(lanes.to_string())),
            };
            let types = match width {
                Some(width) if *function == "splat" => format!("{one}, {width}"),
                Some(width) => format!("::linkwork::__private::Vector<Ops, {one}, {width}>"),
                None => one.to_string(),
            };
            let _ = writeln!(out, "let {name} = Ops::{function}::<{types}>;");
        }
    }

    fn call(&mut self, function: &str, arguments: &[Operand], lanes: usize) -> Piece {
        self.call_by(&format!("Ops::{function}"), arguments, lanes)
    }

    /// The value of a table, or one of its derivatives.
    fn lookup(&mut self, lookup: Lookup, x: [Operand; 3], lanes: usize) -> Piece {
        let (field, orders) = (self.scalar.table(lookup.table()).to_string(), lookup.orders());
        let list = self.call_by("", x.get(..lookup.variables()).unwrap_or_default(), lanes);
        let inner = list.text.strip_prefix('(').and_then(|text| text.strip_suffix(')')).unwrap_or_default();
        Piece { text: format!("Ops::tabulated(&self.{field}, [{inner}], {orders:?})"), ..list }
    }

    fn call_by(&mut self, function: &str, arguments: &[Operand], lanes: usize) -> Piece {
        let mut needs = Vec::new();
        let mut list = Vec::new();
        for argument in arguments {
            let piece = self.widened(*argument, lanes);
            needs.extend(piece.needs);
            list.push(piece.text);
        }
        Piece { text: format!("{function}({})", list.join(", ")), needs, level: 3 }
    }
}

fn wrap(piece: &Piece, level: u8) -> String {
    if piece.level < level { format!("({})", piece.text) } else { piece.text.clone() }
}

/// The numbers of arguments and of what is called, and those of them that are lanes.
fn write_inputs(out: &mut String, arguments: &[Argument], s: &Signature<'_>, w: &Writer<'_>) {
    let in_lanes = s.scalar.is_in_lanes();
    let used = w.program.symbols();
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
                format!("self.{}{}({}q, v)", f.function(), s.suffix(), if s.time { "t, " } else { "" })
            }
            _ => argument.name().to_string(),
        };
        let Some(list) = pattern(*argument, n, &used) else { continue };
        let _ = match (given, in_lanes) {
            (true, false) => writeln!(out, "let [{list}] = *{name};"),
            (true, true) => writeln!(out, "let [{list}] = *Ops::each({name});"),
            (false, false) => writeln!(out, "let [[{list}]] = {name}.data.0;"),
            (false, true) => writeln!(out, "let [{list}] = *Ops::each(&{name}.data.0[0]);"),
        };
        for (k, gather) in w.program.gathers.iter().enumerate() {
            if gather.iter().any(|s| argument.index(Quantity::of(*s)).is_some()) {
                let _ = writeln!(out, "let lanes{k} = {};", w.gathered(gather));
            }
        }
    }
}

/// The elements of an argument's array that a program uses, by name, between those that it does not: rustc takes long over
/// variables that nothing reads. `None` if it uses none.
fn pattern(argument: Argument, n: usize, used: &BTreeSet<Symbol>) -> Option<String> {
    let mut list = Vec::new();
    for k in used.iter().filter_map(|s| argument.index(Quantity::of(*s))).filter(|k| *k < n) {
        let length = list.len().max(k + 1);
        list.resize(length, "_".to_string());
        list[k] = format!("{}{k}", argument.name());
    }
    if list.is_empty() {
        return None;
    }
    if list.len() < n {
        list.push("..".to_string());
    }
    Some(list.join(", "))
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
    if statement.pattern.is_empty() {
        let _ = writeln!(out, "{}", statement.text);
        return;
    }
    let _ = writeln!(out, "let {} = {};", statement.pattern, statement.text);
}

fn write_result(out: &mut String, f: &Function, outputs: &Outputs<'_>, s: &Signature<'_>) {
    match f.shape {
        Shape::Scalar => out.push_str(outputs.pieces.first().map_or("", |p| p.text.as_str())),
        Shape::Array(_) => out.push_str(&outputs.list(0..outputs.pieces.len())),
        Shape::Vector(n) => {
            let _ = writeln!(out, "{}", storage(&format!("[{}]", outputs.list(0..n)), "SVector"));
        }
        Shape::Square(n) => {
            let _ = writeln!(out, "{}", outputs.matrix(0, n, n));
        }
        Shape::Matrix(rows, columns) => {
            let _ = writeln!(out, "{}", outputs.matrix(0, rows, columns));
        }
        Shape::Record(record) => out.push_str(&outputs.record(record)),
        Shape::Symmetric(_) => {}
        Shape::Inverse(_)
        | Shape::Pair(_)
        | Shape::Hessian(_)
        | Shape::Jacobians(..)
        | Shape::InputHessian(..)
        | Shape::Forward(_)
        | Shape::Linear(..)
        | Shape::Accelerated(_)
        | Shape::CalledForward(_)
        | Shape::CalledLinear(..) => out.push_str(&matrices::compose(f, s, outputs)),
    }
}
