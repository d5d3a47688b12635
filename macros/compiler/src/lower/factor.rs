//! Common factors of a sum are taken out: `a b + a c` is `a (b + c)`, with a multiplication less. As many instructions as
//! before are left where products are fused into sums.

use super::{Op, Operand, Program};

/// Longest sum that is looked at.
const MOST: usize = 64;

/// A term of a sum.
#[derive(Clone, Copy)]
struct Term {
    /// The value, or the product that it is, if nothing else uses it.
    value: Result<(Operand, Operand), Operand>,
    negative: bool,
}

impl Program {
    /// The same program with common factors of the terms of its sums taken out.
    pub(super) fn factored(self) -> Program {
        // The sum that each addition is a part of.
        let inner = self.inner_additions();
        let mut out = Program { tuples: self.tuples.clone(), ..Program::default() };
        let mut values: Vec<Operand> = Vec::with_capacity(self.instructions.len());
        let mut changed = false;
        for (k, op) in self.instructions.iter().enumerate() {
            let sum = if inner[k] { None } else { self.terms_of(k) };
            let value = match sum.and_then(|terms| grouped(&terms)) {
                Some(groups) => {
                    changed = true;
                    out.add_groups(&groups, &|o| o.among(&values))
                }
                None => out.push(op.mapped(|o| o.among(&values))),
            };
            values.push(value);
        }
        if !changed {
            return self;
        }
        out.outputs = self.outputs.iter().map(|o| o.among(&values)).collect();
        out.gathers = self.gathers;
        out.sweep();
        out
    }

    fn push(&mut self, op: Op) -> Operand {
        self.instructions.push(op);
        Operand::Value(self.instructions.len() - 1)
    }

    /// Additions whose only use is another one.
    fn inner_additions(&self) -> Vec<bool> {
        let mut inner = vec![false; self.instructions.len()];
        for op in &self.instructions {
            if let Op::Add(a, b) | Op::Sub(a, b) = *op {
                for o in [a, b] {
                    if let Operand::Value(k) = o {
                        inner[k] = self.is_lone_addition(k);
                    }
                }
            }
        }
        inner
    }

    fn is_lone_addition(&self, k: usize) -> bool {
        self.uses[k] == 1 && matches!(self.instructions[k], Op::Add(..) | Op::Sub(..))
    }

    /// The terms of the sum that ends with instruction `k`, from left to right.
    fn terms_of(&self, k: usize) -> Option<Vec<Term>> {
        let mut terms = Vec::new();
        let mut todo = match self.instructions[k] {
            Op::Add(a, b) => vec![(b, false), (a, false)],
            Op::Sub(a, b) => vec![(b, true), (a, false)],
            _ => return None,
        };
        while let Some((o, negative)) = todo.pop() {
            if terms.len() + todo.len() > MOST {
                return None;
            }
            let Operand::Value(k) = o else {
                terms.push(Term { value: Err(o), negative });
                continue;
            };
            match self.instructions[k] {
                Op::Add(a, b) if self.uses[k] == 1 => todo.extend([(b, negative), (a, negative)]),
                Op::Sub(a, b) if self.uses[k] == 1 => todo.extend([(b, !negative), (a, negative)]),
                Op::Mul(a, b) if self.uses[k] == 1 => terms.push(Term { value: Ok((a, b)), negative }),
                _ => terms.push(Term { value: Err(o), negative }),
            }
        }
        Some(terms)
    }

    /// The sum of products of a factor and a sum each, or of a value.
    fn add_groups(&mut self, groups: &[Group], at: &dyn Fn(Operand) -> Operand) -> Operand {
        let mut sum: Option<(Operand, bool)> = None;
        for group in groups {
            let mut value = self.sum_of(&group.others, at);
            if let Some(factor) = group.factor {
                value = (self.push(Op::Mul(at(factor), value.0)), value.1);
            }
            sum = Some(sum.map_or(value, |sum| self.sum_of_two(sum, value)));
        }
        match sum {
            Some((value, true)) => self.push(Op::Neg(value)),
            Some((value, false)) => value,
            None => Operand::Const(0.0),
        }
    }

    /// A sum and whether it is meant negative.
    fn sum_of(&mut self, terms: &[(Operand, bool)], at: &dyn Fn(Operand) -> Operand) -> (Operand, bool) {
        let known: f64 = terms.iter().map(|t| signed_constant(*t).unwrap_or(0.0)).sum();
        let is_known = terms.iter().any(|t| signed_constant(*t).is_some());
        let constant = is_known.then_some((Operand::Const(known), false));
        let rest = terms.iter().filter(|t| signed_constant(**t).is_none());
        let mut all = rest.map(|(o, negative)| (at(*o), *negative)).chain(constant);
        let first = all.next().unwrap_or((Operand::Const(0.0), false));
        all.fold(first, |sum, term| self.sum_of_two(sum, term))
    }

    fn sum_of_two(&mut self, a: (Operand, bool), b: (Operand, bool)) -> (Operand, bool) {
        match (a.1, b.1) {
            (false, false) | (true, true) => (self.push(Op::Add(a.0, b.0)), a.1),
            (false, true) => (self.push(Op::Sub(a.0, b.0)), false),
            (true, false) => (self.push(Op::Sub(b.0, a.0)), false),
        }
    }
}

/// A factor, if there is one, and what it multiplies, with signs.
struct Group {
    factor: Option<Operand>,
    others: Vec<(Operand, bool)>,
}

/// The terms of a sum by common factors. `None` if there are none.
fn grouped(terms: &[Term]) -> Option<Vec<Group>> {
    let mut open: Vec<Term> = terms.to_vec();
    let mut groups = Vec::new();
    let mut saved = false;
    while !open.is_empty() {
        let factor = most_common_factor(&open);
        let Some(factor) = factor else {
            // What has nothing in common stays as it is, a product with its own factor.
            let single = |t: Term| match t.value {
                Ok((a, b)) => Group { factor: Some(a), others: vec![(b, t.negative)] },
                Err(o) => Group { factor: None, others: vec![(o, t.negative)] },
            };
            groups.extend(open.drain(..).map(single));
            break;
        };
        saved = true;
        let mut others = Vec::new();
        open.retain(|t| match t.value.ok().and_then(|product| cofactor(product, factor)) {
            Some((other, opposite)) => {
                others.push((other, t.negative != opposite));
                false
            }
            None => true,
        });
        groups.push(Group { factor: Some(factor), others });
    }
    // What is there first comes first.
    groups.sort_by_key(|g| g.others.iter().map(|(o, _)| o.number()).max());
    saved.then_some(groups)
}

/// The factor that two terms or more have, that of most terms.
fn most_common_factor(terms: &[Term]) -> Option<Operand> {
    let mut best: Option<(usize, Operand)> = None;
    for term in terms {
        let Ok((a, b)) = term.value else { continue };
        for factor in [a, b] {
            let has = |t: &&Term| t.value.is_ok_and(|product| cofactor(product, factor).is_some());
            let count = terms.iter().filter(has).count();
            if count > best.map_or(1, |(most, _)| most) {
                best = Some((count, factor));
            }
        }
    }
    best.map(|(_, factor)| factor)
}

/// The other factor of a product, and whether the product has the opposite sign.
fn cofactor((a, b): (Operand, Operand), factor: Operand) -> Option<(Operand, bool)> {
    let opposite = |x: Operand| match (x, factor) {
        (Operand::Const(x), Operand::Const(f)) if x == -f => Some(true),
        (x, f) if x == f => Some(false),
        _ => None,
    };
    opposite(a).map(|o| (b, o)).or_else(|| opposite(b).map(|o| (a, o)))
}

fn signed_constant((o, negative): (Operand, bool)) -> Option<f64> {
    match o {
        Operand::Const(c) => Some(if negative { -c } else { c }),
        _ => None,
    }
}
