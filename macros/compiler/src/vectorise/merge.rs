//! Merging of the expressions of several limbs into the SIMD lanes of one expression. The result is correct
//! for any pairing of operands: every lane has the value of its own expression. Expressions come from users,
//! so depth and steps are bounded; an expression that exceeds the bounds is not merged.

use crate::expr::replace::substitute_symbols;
use crate::expr::{Expr, Function, Graph, Id, Node, Symbol};
use crate::kinematics::symbols_in;
use crate::mechanism::Quantity;
use std::collections::{BTreeMap, BTreeSet};

/// Depth to which operands are compared when the operands of commutative operations are paired across lanes.
const DEPTH: u8 = 8;

/// Maximum nesting of operations. Each level takes stack, of which compiler plug-ins have little.
const MAX_DEPTH: usize = 64;

/// Maximum number of steps per mechanism, of about 0.1 µs each in an unoptimised build.
const STEPS: usize = 2_000_000;

/// Merges corresponding expressions of identical limbs into SIMD lanes, and remembers the results.
pub struct LaneMerger<'g> {
    graph: &'g Graph,
    known: BTreeMap<Vec<Id>, Option<Id>>,
    /// Results of merging expressions with signs; the flag is true for minus.
    signed: BTreeMap<Vec<(Id, bool)>, Option<Id>>,
    /// Symbols that correspond to each other in different limbs, one list per quantity with one symbol per
    /// lane.
    partners: Vec<Vec<Symbol>>,
    /// Nesting depth of the expression that is being merged.
    depth: usize,
    /// Number of steps that merging may still take before it is abandoned.
    steps: usize,
}

impl<'g> LaneMerger<'g> {
    /// Creates a merger for the expressions of a graph.
    pub fn new(graph: &'g Graph) -> LaneMerger<'g> {
        LaneMerger {
            graph,
            known: BTreeMap::new(),
            signed: BTreeMap::new(),
            partners: Vec::new(),
            depth: 0,
            steps: STEPS,
        }
    }

    /// Declares that symbols of different limbs correspond to each other, one symbol per lane.
    pub fn pair_symbols(&mut self, lanes: Vec<Symbol>) {
        self.partners.push(lanes);
    }

    /// Returns a filler for lane `to` when only lane `from` has this term: the coefficient there is zero. The
    /// filler has the symbols of lane `to`, so that they are gathered once. The expression itself is the
    /// filler if it has symbols of other lanes too, or may be infinite, since zero times infinity is not
    /// zero.
    fn filler_for_missing_term(&self, e: Expr<'g>, from: usize, to: usize) -> Expr<'g> {
        let lane_partners_of_symbol = |s: Symbol| self.partners.iter().find(|list| list.contains(&s));
        let is_symbol_of_lane =
            |s: &Symbol| lane_partners_of_symbol(*s).is_none_or(|list| list.get(from) == Some(s));
        if !symbols_in(&[e]).iter().all(is_symbol_of_lane) || !is_always_finite(e) {
            return e;
        }
        substitute_symbols(e, &|s| lane_partners_of_symbol(s)?.get(to).map(|s| self.graph.symbol(*s)))
    }

    /// Subtracts steps from the remaining work of merging; returns `None` when too few remain.
    fn spend_steps(&mut self, steps: usize) -> Option<()> {
        self.steps = self.steps.checked_sub(steps)?;
        Some(())
    }

    /// Builds an expression at the next nesting depth; returns `None` if the maximum depth is exceeded.
    fn build_within_depth_limit(
        &mut self,
        make: impl FnOnce(&mut Self) -> Option<Expr<'g>>,
    ) -> Option<Expr<'g>> {
        if self.depth == MAX_DEPTH {
            return None;
        }
        self.depth += 1;
        let made = make(self);
        self.depth -= 1;
        made
    }

    /// Returns the expression with these lanes, or the common expression if all lanes are equal. Returns
    /// `None` if the lanes have different structures.
    pub fn merge_lanes(&mut self, lanes: &[Expr<'g>]) -> Option<Expr<'g>> {
        let first = *lanes.first()?;
        if lanes.iter().all(|e| *e == first) {
            return Some(first);
        }
        if let Some(values) = lanes.iter().map(|e| e.constant_value()).collect::<Option<Vec<_>>>() {
            return Some(self.graph.lanes_from_constants(&values));
        }
        let ids: Vec<Id> = lanes.iter().map(|e| e.id()).collect();
        if let Some(known) = self.known.get(&ids) {
            return known.map(|id| self.graph.expr(id));
        }
        self.spend_steps(ids.len())?;
        let found = self.build_within_depth_limit(|merge| merge.merge_uncached_lanes(lanes));
        self.known.insert(ids, found.map(Expr::id));
        found
    }

    fn merge_uncached_lanes(&mut self, lanes: &[Expr<'g>]) -> Option<Expr<'g>> {
        // Offsets and factors that differ between lanes become lane constants.
        let mut parts: Vec<(f64, f64, Expr<'g>)> = lanes.iter().map(|e| split_affine(*e)).collect();
        let moving = lanes.iter().position(|e| e.constant_value().is_none())?;
        for lane in 0..parts.len() {
            if lanes[lane].constant_value().is_some() {
                // The lane is constant: its factor is zero.
                parts[lane].2 = self.filler_for_missing_term(parts[moving].2, moving, lane);
            }
        }
        if parts.iter().any(|(offset, factor, _)| (*offset, *factor) != (0.0, 1.0)) {
            return self.merge_affine_lanes(&parts);
        }
        let expression_of_id = |id: Id| self.graph.expr(id);
        match lanes.first()?.node() {
            Node::Symbol(_) => {
                let symbol_of_expression = |e: &Expr<'g>| match e.node() {
                    Node::Symbol(s) => Some(s),
                    _ => None,
                };
                let symbols: Option<Vec<_>> = lanes.iter().map(symbol_of_expression).collect();
                Some(self.graph.lane_input_of_symbols(&symbols?))
            }
            Node::Call(f, _) => {
                let argument_of_call = |e: &Expr<'g>| match e.node() {
                    Node::Call(g, a) if g == f => Some(expression_of_id(a)),
                    _ => None,
                };
                let arguments: Option<Vec<_>> = lanes.iter().map(argument_of_call).collect();
                Some(self.merge_lanes(&arguments?)?.apply_function(f))
            }
            Node::Add(..) | Node::Sub(..) => {
                let (a, b) =
                    self.pair_operands(lanes.iter().map(|e| terms_of_sum(*e)).collect::<Option<Vec<_>>>()?)?;
                Some(self.merge_lanes(&a)? + self.merge_lanes(&b)?)
            }
            Node::Mul(..) => {
                let (a, b) = self.pair_operands(
                    lanes.iter().map(|e| factors_of_product(*e)).collect::<Option<Vec<_>>>()?,
                )?;
                Some(self.merge_lanes(&a)? * self.merge_lanes(&b)?)
            }
            Node::Div(..) => {
                let numerator_and_denominator = |e: &Expr<'g>| match e.node() {
                    Node::Div(a, b) => Some((expression_of_id(a), expression_of_id(b))),
                    _ => None,
                };
                let (a, b): (Vec<_>, Vec<_>) = lanes
                    .iter()
                    .map(numerator_and_denominator)
                    .collect::<Option<Vec<_>>>()?
                    .into_iter()
                    .unzip();
                Some(self.merge_lanes(&a)? / self.merge_lanes(&b)?)
            }
            _ => None,
        }
    }

    /// Merges lanes of the form `offset + factor × rest`.
    fn merge_affine_lanes(&mut self, parts: &[(f64, f64, Expr<'g>)]) -> Option<Expr<'g>> {
        let offsets: Vec<f64> = parts.iter().map(|part| part.0).collect();
        let factors: Vec<f64> = parts.iter().map(|part| part.1).collect();
        let rests: Vec<Expr<'g>> = parts.iter().map(|part| part.2).collect();
        let scaled = match factors.iter().all(|c| c.abs() == 1.0) {
            true => self.merge_signed_lanes(&rests, &factors)?,
            false => self.graph.lanes_from_constants(&factors) * self.merge_lanes(&rests)?,
        };
        Some(self.graph.lanes_from_constants(&offsets) + scaled)
    }

    /// Merges expressions with signs. Signs that differ between lanes are absorbed by constants of the
    /// expressions, if possible.
    fn merge_signed_lanes(&mut self, lanes: &[Expr<'g>], signs: &[f64]) -> Option<Expr<'g>> {
        let sign = *signs.first()?;
        if signs.iter().all(|s| *s == sign) {
            let all = self.merge_lanes(lanes)?;
            return Some(if sign < 0.0 { -all } else { all });
        }
        let key: Vec<(Id, bool)> = lanes.iter().zip(signs).map(|(e, sign)| (e.id(), *sign < 0.0)).collect();
        if let Some(known) = self.signed.get(&key) {
            return known.map(|id| self.graph.expr(id));
        }
        self.spend_steps(key.len())?;
        let found = self.build_within_depth_limit(|merge| merge.merge_uncached_signed_lanes(lanes, signs));
        self.signed.insert(key, found.map(Expr::id));
        found
    }

    fn merge_uncached_signed_lanes(&mut self, lanes: &[Expr<'g>], signs: &[f64]) -> Option<Expr<'g>> {
        let first = *lanes.first()?;
        let mut parts: Vec<(f64, f64, Expr<'g>)> = lanes.iter().map(|e| split_affine(*e)).collect();
        if parts.iter().any(|(offset, factor, _)| (*offset, *factor) != (0.0, 1.0)) {
            for (part, sign) in parts.iter_mut().zip(signs) {
                (part.0, part.1) = (part.0 * sign, part.1 * sign);
            }
            return self.merge_affine_lanes(&parts);
        }
        if can_absorb_sign(first, DEPTH) {
            let operands_of_all_lanes = |of: fn(Expr<'g>) -> Option<(Expr<'g>, Expr<'g>)>| {
                lanes.iter().map(|e| of(*e)).collect::<Option<Vec<_>>>()
            };
            if let Some(operands) = operands_of_all_lanes(terms_of_sum) {
                let (a, b) = self.pair_operands(operands)?;
                return Some(self.merge_signed_lanes(&a, signs)? + self.merge_signed_lanes(&b, signs)?);
            }
            if let Some(operands) = operands_of_all_lanes(factors_of_product) {
                let (a, b) = self.pair_operands(operands)?;
                return match can_absorb_sign(*a.first()?, DEPTH) {
                    true => Some(self.merge_signed_lanes(&a, signs)? * self.merge_lanes(&b)?),
                    false => Some(self.merge_lanes(&a)? * self.merge_signed_lanes(&b, signs)?),
                };
            }
        }
        Some(self.graph.lanes_from_constants(signs) * self.merge_lanes(lanes)?)
    }

    /// Returns the first and the second operands of a commutative operation in all lanes. Operands are
    /// exchanged in lanes where that pairs similar expressions.
    fn pair_operands(
        &mut self,
        mut operands: Vec<(Expr<'g>, Expr<'g>)>,
    ) -> Option<(Vec<Expr<'g>>, Vec<Expr<'g>>)> {
        let (a, b) = *operands.first()?;
        for (x, y) in &mut operands {
            let in_order =
                self.has_similar_structure(a, *x, DEPTH)? && self.has_similar_structure(b, *y, DEPTH)?;
            if !in_order
                && self.has_similar_structure(a, *y, DEPTH)?
                && self.has_similar_structure(b, *x, DEPTH)?
            {
                std::mem::swap(x, y);
            }
        }
        Some(operands.into_iter().unzip())
    }

    /// Returns true if two expressions are similar down to a depth: the same operations up to the order of
    /// operands, signs, constant factors and constant summands, and symbols of the same kind. A constant is
    /// similar to any expression. Returns `None` when no steps remain.
    fn has_similar_structure(&mut self, a: Expr<'g>, b: Expr<'g>, depth: u8) -> Option<bool> {
        self.spend_steps(1)?;
        let ((.., a), (.., b)) = (split_affine(a), split_affine(b));
        if a == b || depth == 0 || a.constant_value().is_some() || b.constant_value().is_some() {
            return Some(true);
        }
        let mut same =
            |x: Id, y: Id| self.has_similar_structure(a.graph().expr(x), a.graph().expr(y), depth - 1);
        Some(match (a.node(), b.node()) {
            (Node::Symbol(s), Node::Symbol(t)) => {
                std::mem::discriminant(&Quantity::from_symbol(s))
                    == std::mem::discriminant(&Quantity::from_symbol(t))
            }
            (Node::Neg(x), Node::Neg(y)) => same(x, y)?,
            (Node::Call(f, x), Node::Call(g, y)) => f == g && same(x, y)?,
            (Node::Add(x, y) | Node::Sub(x, y), Node::Add(u, v) | Node::Sub(u, v))
            | (Node::Mul(x, y), Node::Mul(u, v)) => {
                (same(x, u)? && same(y, v)?) || (same(x, v)? && same(y, u)?)
            }
            (Node::Div(x, y), Node::Div(u, v)) => same(x, u)? && same(y, v)?,
            _ => false,
        })
    }
}

/// Returns the two terms of a sum or difference; `None` for other expressions.
fn terms_of_sum(e: Expr<'_>) -> Option<(Expr<'_>, Expr<'_>)> {
    let expression_of_id = |id: Id| e.graph().expr(id);
    match e.node() {
        Node::Add(a, b) => Some((expression_of_id(a), expression_of_id(b))),
        Node::Sub(a, b) => Some((expression_of_id(a), -expression_of_id(b))),
        _ => None,
    }
}

/// Returns the two factors if the expression is a product.
fn factors_of_product(e: Expr<'_>) -> Option<(Expr<'_>, Expr<'_>)> {
    let expression_of_id = |id: Id| e.graph().expr(id);
    match e.node() {
        Node::Mul(a, b) => Some((expression_of_id(a), expression_of_id(b))),
        _ => None,
    }
}

/// Returns true if constants of an expression can absorb a sign, down to a depth.
fn can_absorb_sign(e: Expr<'_>, depth: u8) -> bool {
    let (offset, factor, rest) = split_affine(e);
    if offset != 0.0 || factor.abs() != 1.0 || e.constant_value().is_some() {
        return true;
    }
    let Some(depth) = depth.checked_sub(1) else { return false };
    match (terms_of_sum(rest), factors_of_product(rest)) {
        (Some((a, b)), _) => can_absorb_sign(a, depth) && can_absorb_sign(b, depth),
        (_, Some((a, b))) => can_absorb_sign(a, depth) || can_absorb_sign(b, depth),
        _ => false,
    }
}

/// Splits an expression into constants and a remainder, `offset + factor × remainder`.
fn split_affine(e: Expr<'_>) -> (f64, f64, Expr<'_>) {
    let expression_of_id = |id: Id| e.graph().expr(id);
    let (mut offset, mut factor, mut rest) = (0.0, 1.0, e);
    loop {
        let constant_value = |id: Id| expression_of_id(id).constant_value();
        match rest.node() {
            Node::Const(c) => return (offset + factor * c, 0.0, rest),
            Node::Neg(a) => (factor, rest) = (-factor, expression_of_id(a)),
            Node::Mul(a, b) => match constant_value(a) {
                Some(c) => (factor, rest) = (factor * c, expression_of_id(b)),
                None => return (offset, factor, rest),
            },
            Node::Add(a, b) | Node::Sub(a, b) => {
                let sign = if matches!(rest.node(), Node::Sub(..)) { -1.0 } else { 1.0 };
                (offset, factor, rest) = match (constant_value(a), constant_value(b)) {
                    (Some(c), _) => (offset + factor * c, factor * sign, expression_of_id(b)),
                    (_, Some(c)) => (offset + factor * sign * c, factor, expression_of_id(a)),
                    _ => return (offset, factor, rest),
                };
            }
            _ => return (offset, factor, rest),
        }
    }
}

/// Returns true if an expression is finite for finite symbols, overflow aside.
fn is_always_finite(e: Expr<'_>) -> bool {
    let graph = e.graph();
    let (mut todo, mut seen) = (vec![e.id()], BTreeSet::new());
    while let Some(id) = todo.pop() {
        let node = graph.node(id);
        match node {
            Node::Const(_)
            | Node::Symbol(_)
            | Node::Neg(_)
            | Node::Add(..)
            | Node::Sub(..)
            | Node::Mul(..)
            | Node::Call(Function::Sin | Function::Cos, _) => {}
            _ => return false,
        }
        if seen.insert(id) {
            node.visit_operands(|a| todo.push(a));
        }
    }
    true
}
