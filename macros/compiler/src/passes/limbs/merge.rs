//! Expressions of several limbs as the lanes of one. What is made is right for any pairing of operands: every lane has
//! the value of its own expression.

use crate::expr::replace::replace;
use crate::expr::{Expr, Graph, Id, Node, Symbol};
use crate::model::Quantity;
use std::collections::BTreeMap;

/// How deep operands are compared to find out which go together.
const DEPTH: u8 = 8;

/// Makes lanes of expressions; what was made once is kept.
pub struct Merge<'g> {
    graph: &'g Graph,
    known: BTreeMap<Vec<Id>, Option<Id>>,
    /// With signs, true for minus.
    signed: BTreeMap<Vec<(Id, bool)>, Option<Id>>,
    /// Symbols that are the lanes of one.
    partners: Vec<Vec<Symbol>>,
}

impl<'g> Merge<'g> {
    /// For the expressions of a graph.
    pub fn new(graph: &'g Graph) -> Merge<'g> {
        Merge { graph, known: BTreeMap::new(), signed: BTreeMap::new(), partners: Vec::new() }
    }

    /// Says which symbols are the lanes of one.
    pub fn pair_symbols(&mut self, lanes: Vec<Symbol>) {
        self.partners.push(lanes);
    }

    /// An expression of one lane with the symbols of another, as far as they are known.
    fn in_lane(&self, e: Expr<'g>, lane: usize) -> Expr<'g> {
        replace(e, &|s| {
            let partners = self.partners.iter().find(|list| list.contains(&s))?;
            partners.get(lane).map(|s| self.graph.symbol(*s))
        })
    }

    /// The expression with these lanes; what is the same in all lanes has none. `None` if they are built differently.
    pub fn lanes(&mut self, lanes: &[Expr<'g>]) -> Option<Expr<'g>> {
        let first = *lanes.first()?;
        if lanes.iter().all(|e| *e == first) {
            return Some(first);
        }
        if let Some(values) = lanes.iter().map(|e| e.value()).collect::<Option<Vec<_>>>() {
            return Some(self.graph.lane_constants(&values));
        }
        let ids: Vec<Id> = lanes.iter().map(|e| e.id()).collect();
        if let Some(known) = self.known.get(&ids) {
            return known.map(|id| self.graph.expr(id));
        }
        let found = self.build(lanes);
        self.known.insert(ids, found.map(Expr::id));
        found
    }

    fn build(&mut self, lanes: &[Expr<'g>]) -> Option<Expr<'g>> {
        // Offsets and factors that differ, or are missing in some lanes, are constants of the lanes.
        let mut parts: Vec<(f64, f64, Expr<'g>)> = lanes.iter().map(|e| affine(*e)).collect();
        let moving = lanes.iter().position(|e| e.value().is_none())?;
        for lane in 0..parts.len() {
            if lanes[lane].value().is_some() {
                // Nothing there moves, so that nothing of what takes its place counts.
                parts[lane].2 = self.in_lane(parts[moving].2, lane);
            }
        }
        if parts.iter().any(|(offset, factor, _)| (*offset, *factor) != (0.0, 1.0)) {
            return self.affine(&parts);
        }
        let at = |id: Id| self.graph.expr(id);
        match lanes.first()?.node() {
            Node::Symbol(_) => {
                let symbol = |e: &Expr<'g>| match e.node() {
                    Node::Symbol(s) => Some(s),
                    _ => None,
                };
                let symbols: Option<Vec<_>> = lanes.iter().map(symbol).collect();
                Some(self.graph.lane_symbols(&symbols?))
            }
            Node::Call(f, _) => {
                let argument = |e: &Expr<'g>| match e.node() {
                    Node::Call(g, a) if g == f => Some(at(a)),
                    _ => None,
                };
                let arguments: Option<Vec<_>> = lanes.iter().map(argument).collect();
                Some(self.lanes(&arguments?)?.call(f))
            }
            Node::Add(..) | Node::Sub(..) => {
                let (a, b) = paired(lanes.iter().map(|e| terms(*e)).collect::<Option<Vec<_>>>()?, true)?;
                Some(self.lanes(&a)? + self.lanes(&b)?)
            }
            Node::Mul(..) => {
                let (a, b) = paired(lanes.iter().map(|e| factors(*e)).collect::<Option<Vec<_>>>()?, true)?;
                Some(self.lanes(&a)? * self.lanes(&b)?)
            }
            Node::Div(..) => {
                let parts = |e: &Expr<'g>| match e.node() {
                    Node::Div(a, b) => Some((at(a), at(b))),
                    _ => None,
                };
                let (a, b) = paired(lanes.iter().map(parts).collect::<Option<Vec<_>>>()?, false)?;
                Some(self.lanes(&a)? / self.lanes(&b)?)
            }
            _ => None,
        }
    }

    /// Offsets, factors and rests as lanes.
    fn affine(&mut self, parts: &[(f64, f64, Expr<'g>)]) -> Option<Expr<'g>> {
        let offsets: Vec<f64> = parts.iter().map(|part| part.0).collect();
        let factors: Vec<f64> = parts.iter().map(|part| part.1).collect();
        let rests: Vec<Expr<'g>> = parts.iter().map(|part| part.2).collect();
        let scaled = match factors.iter().all(|c| c.abs() == 1.0) {
            true => self.signed(&rests, &factors)?,
            false => self.graph.lane_constants(&factors) * self.lanes(&rests)?,
        };
        Some(self.graph.lane_constants(&offsets) + scaled)
    }

    /// Expressions with signs. Where these differ the constants of the expressions take them, if there are enough.
    fn signed(&mut self, lanes: &[Expr<'g>], signs: &[f64]) -> Option<Expr<'g>> {
        let sign = *signs.first()?;
        if signs.iter().all(|s| *s == sign) {
            let all = self.lanes(lanes)?;
            return Some(if sign < 0.0 { -all } else { all });
        }
        let key: Vec<(Id, bool)> = lanes.iter().zip(signs).map(|(e, sign)| (e.id(), *sign < 0.0)).collect();
        if let Some(known) = self.signed.get(&key) {
            return known.map(|id| self.graph.expr(id));
        }
        let found = self.build_signed(lanes, signs);
        self.signed.insert(key, found.map(Expr::id));
        found
    }

    fn build_signed(&mut self, lanes: &[Expr<'g>], signs: &[f64]) -> Option<Expr<'g>> {
        let first = *lanes.first()?;
        let mut parts: Vec<(f64, f64, Expr<'g>)> = lanes.iter().map(|e| affine(*e)).collect();
        if parts.iter().any(|(offset, factor, _)| (*offset, *factor) != (0.0, 1.0)) {
            for (part, sign) in parts.iter_mut().zip(signs) {
                (part.0, part.1) = (part.0 * sign, part.1 * sign);
            }
            return self.affine(&parts);
        }
        if absorbs(first, DEPTH) {
            let all = |of: fn(Expr<'g>) -> Option<(Expr<'g>, Expr<'g>)>| {
                lanes.iter().map(|e| of(*e)).collect::<Option<Vec<_>>>().and_then(|all| paired(all, true))
            };
            if let Some((a, b)) = all(terms) {
                return Some(self.signed(&a, signs)? + self.signed(&b, signs)?);
            }
            if let Some((a, b)) = all(factors) {
                return match absorbs(*a.first()?, DEPTH) {
                    true => Some(self.signed(&a, signs)? * self.lanes(&b)?),
                    false => Some(self.lanes(&a)? * self.signed(&b, signs)?),
                };
            }
        }
        Some(self.graph.lane_constants(signs) * self.lanes(lanes)?)
    }
}

/// First and second operands of all lanes, those of a commutative operation exchanged where that brings like to like.
fn paired<'g>(
    mut operands: Vec<(Expr<'g>, Expr<'g>)>,
    commutative: bool,
) -> Option<(Vec<Expr<'g>>, Vec<Expr<'g>>)> {
    let (a, b) = *operands.first()?;
    for (x, y) in operands.iter_mut().filter(|_| commutative) {
        let straight = alike(a, *x, DEPTH) && alike(b, *y, DEPTH);
        if !straight && alike(a, *y, DEPTH) && alike(b, *x, DEPTH) {
            std::mem::swap(x, y);
        }
    }
    Some(operands.into_iter().unzip())
}

/// The terms of a sum or difference.
fn terms(e: Expr<'_>) -> Option<(Expr<'_>, Expr<'_>)> {
    let at = |id: Id| e.graph().expr(id);
    match e.node() {
        Node::Add(a, b) => Some((at(a), at(b))),
        Node::Sub(a, b) => Some((at(a), -at(b))),
        _ => None,
    }
}

/// The factors of a product.
fn factors(e: Expr<'_>) -> Option<(Expr<'_>, Expr<'_>)> {
    let at = |id: Id| e.graph().expr(id);
    match e.node() {
        Node::Mul(a, b) => Some((at(a), at(b))),
        _ => None,
    }
}

/// True if another sign costs nothing: constants take it. Looks so deep.
fn absorbs(e: Expr<'_>, depth: u8) -> bool {
    let (offset, factor, rest) = affine(e);
    if offset != 0.0 || factor.abs() != 1.0 || e.value().is_some() {
        return true;
    }
    let Some(depth) = depth.checked_sub(1) else { return false };
    match (terms(rest), factors(rest)) {
        (Some((a, b)), _) => absorbs(a, depth) && absorbs(b, depth),
        (_, Some((a, b))) => absorbs(a, depth) || absorbs(b, depth),
        _ => false,
    }
}

/// Offset, factor and rest: an expression as `offset + factor × rest`.
fn affine(e: Expr<'_>) -> (f64, f64, Expr<'_>) {
    let at = |id: Id| e.graph().expr(id);
    let scaled = |c: f64, id: Id| {
        let (offset, factor, rest) = affine(at(id));
        (c * offset, c * factor, rest)
    };
    let shifted = |c: f64, sign: f64, id: Id| {
        let (offset, factor, rest) = scaled(sign, id);
        (c + offset, factor, rest)
    };
    match e.node() {
        Node::Const(c) => (c, 0.0, e),
        Node::Neg(a) => scaled(-1.0, a),
        Node::Mul(a, b) => at(a).value().map_or((0.0, 1.0, e), |c| scaled(c, b)),
        Node::Add(a, b) | Node::Sub(a, b) => {
            let sign = if matches!(e.node(), Node::Sub(..)) { -1.0 } else { 1.0 };
            match (at(a).value(), at(b).value()) {
                (Some(c), _) => shifted(c, sign, b),
                (_, Some(c)) => shifted(sign * c, 1.0, a),
                _ => (0.0, 1.0, e),
            }
        }
        _ => (0.0, 1.0, e),
    }
}

/// True if two expressions are built alike, as far as one looks.
fn alike(a: Expr<'_>, b: Expr<'_>, depth: u8) -> bool {
    let ((.., a), (.., b)) = (affine(a), affine(b));
    if a == b || depth == 0 || a.value().is_some() || b.value().is_some() {
        return true;
    }
    let at = |id: Id| a.graph().expr(id);
    let same = |x: Id, y: Id| alike(at(x), at(y), depth - 1);
    match (a.node(), b.node()) {
        (Node::Symbol(s), Node::Symbol(t)) => {
            std::mem::discriminant(&Quantity::of(s)) == std::mem::discriminant(&Quantity::of(t))
        }
        (Node::Neg(x), Node::Neg(y)) => same(x, y),
        (Node::Call(f, x), Node::Call(g, y)) => f == g && same(x, y),
        (Node::Add(x, y) | Node::Sub(x, y), Node::Add(u, v) | Node::Sub(u, v))
        | (Node::Mul(x, y), Node::Mul(u, v)) => (same(x, u) && same(y, v)) || (same(x, v) && same(y, u)),
        (Node::Div(x, y), Node::Div(u, v)) => same(x, u) && same(y, v),
        _ => false,
    }
}
