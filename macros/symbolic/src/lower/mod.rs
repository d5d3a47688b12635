//! Lowering of expressions to a straight-line program that computes only the values that the outputs need,
//! each before its first use, with operations counted. Knows no mechanics.

use crate::expr::{Expr, Graph, Id, Node, Symbol};
use std::time::Instant;

mod angles;
mod chain;
mod factor;
mod fuse;
mod hoist;
mod lanes;
mod live;
mod negations;
pub mod pipeline;
mod program;
mod reassociate;
mod registers;
mod scalars;
mod schedule;
mod share_subsums;
mod terms;
mod text;
mod times;

pub use angles::{Angle, Angles};
pub use hoist::{node_of_hoisted_symbol, replace_hoisted_symbols};
pub use program::{Op, Operand, OperationCounts, Program};

/// Drafts a program of the outputs. Products and sums are separate instructions until [`pipeline::FINISH`] or
/// [`pipeline::PART`] fuses them.
pub fn lower(outputs: &[Expr<'_>]) -> Program {
    draft_with_hoisted_arguments(outputs, &|_| false)
}

/// Drafts a program of the outputs that takes values which depend on `known` symbols alone as arguments, see
/// the module `hoist`.
pub fn draft_with_hoisted_arguments(outputs: &[Expr<'_>], known: &dyn Fn(Symbol) -> bool) -> Program {
    let start = Instant::now();
    let program = select_instructions(outputs, known);
    pipeline::report_to_observer(pipeline::SELECT, &program, start.elapsed());
    let mut program = program.run_passes(pipeline::DRAFT);
    program.counts = program.count_operations();
    program
}

/// Translates expressions to instructions, one for each node.
fn select_instructions(outputs: &[Expr<'_>], known: &dyn Fn(Symbol) -> bool) -> Program {
    let Some(first) = outputs.first() else {
        return Program::default();
    };
    let graph = first.graph();
    // Position of each node in the order, counted from one. Only the entries of needed nodes are written, so
    // that a small function does not pay for a large graph.
    let mut places = graph.borrow_zeroed_node_table();
    let order = collect_needed_nodes(outputs, &mut places);
    let index_of_node = |id: Id| places[id as usize] as usize - 1;
    let nodes = nodes_of_ids(graph, &order);
    let hoisted = hoist::hoisting_flags_of_nodes(&nodes, index_of_node, known);
    let mut uses = vec![0_u32; order.len()];
    for (node, _) in nodes.iter().zip(&hoisted).filter(|(_, hoisted)| !**hoisted) {
        node.visit_operands(|a| uses[index_of_node(a)] += 1);
    }
    for output in outputs {
        uses[index_of_node(output.id())] += 1;
    }
    let mut program = Program::default();
    let mut values: Vec<Operand> = Vec::with_capacity(order.len());
    let mut lanes = lanes::ValueLaneCounts::default();
    for (k, node) in nodes.iter().enumerate() {
        let operand_of_node = |a: Id| values[index_of_node(a)];
        if hoisted[k] {
            values.push(match *node {
                Node::Neg(a) => hoist::negate_constant_or_hoisted(operand_of_node(a)),
                _ => hoist::operand_of_hoisted_node(order[k]),
            });
            continue;
        }
        if let Some(leaf) = lanes.operand_of_leaf_node(graph, *node, &mut program, &operand_of_node) {
            values.push(leaf);
            continue;
        }
        let op = match *node {
            Node::Const(_) | Node::Symbol(_) | Node::Tuple(_) | Node::Gather(_) => continue,
            Node::Sum(n, a) => lanes.lane_sum_operation(n.into(), operand_of_node(a)),
            Node::Lane(k, a) => Op::Lane(k.into(), operand_of_node(a)),
            Node::Join(n, a, b) => Op::Join(n.into(), operand_of_node(a), operand_of_node(b)),
            Node::Neg(a) => match nodes[index_of_node(a)] {
                // −(a − b) is b − a if nothing else uses a − b.
                Node::Sub(x, y) if uses[index_of_node(a)] == 1 => {
                    Op::Sub(operand_of_node(y), operand_of_node(x))
                }
                _ => Op::Neg(operand_of_node(a)),
            },
            Node::Add(a, b) => Op::Add(operand_of_node(a), operand_of_node(b)),
            Node::Sub(a, b) => Op::Sub(operand_of_node(a), operand_of_node(b)),
            Node::Mul(a, b) => Op::Mul(operand_of_node(a), operand_of_node(b)),
            Node::Div(a, b) => Op::Div(operand_of_node(a), operand_of_node(b)),
            Node::Call(f, a) => Op::Call(f, operand_of_node(a)),
            Node::Atan2(a, b) => Op::Atan2(operand_of_node(a), operand_of_node(b)),
            Node::Pow(a, b) => Op::Pow(operand_of_node(a), operand_of_node(b)),
            Node::Extreme(f, a, b) => Op::Extreme(f, operand_of_node(a), operand_of_node(b)),
            Node::Table(lookup, a, b, c) => {
                Op::Table(lookup, operand_of_node(a), operand_of_node(b), operand_of_node(c))
            }
        };
        values.push(Operand::Value(program.instructions.len()));
        lanes.record_lane_count(&op);
        program.instructions.push(op);
    }
    program.outputs = outputs.iter().map(|o| values[index_of_node(o.id())]).collect();
    for id in &order {
        places[*id as usize] = 0;
    }
    program.remove_unused_instructions();
    program
}

/// Returns the number of operations of the outputs, without negations and elementary functions: that of a
/// program before its sums are factored, within a few hundredths. Cheaper than drafting the program.
pub fn operation_count(outputs: &[Expr<'_>], known: &dyn Fn(Symbol) -> bool) -> usize {
    let Some(first) = outputs.first() else { return 0 };
    let graph = first.graph();
    let mut places = graph.borrow_zeroed_node_table();
    let order = collect_needed_nodes(outputs, &mut places);
    let nodes = nodes_of_ids(graph, &order);
    let hoisted = hoist::hoisting_flags_of_nodes(&nodes, |id| places[id as usize] as usize - 1, known);
    for id in &order {
        places[*id as usize] = 0;
    }
    let is_counted_operation = |node: &Node| {
        matches!(node, Node::Add(..) | Node::Sub(..) | Node::Mul(..) | Node::Div(..) | Node::Sum(..))
    };
    nodes.iter().zip(hoisted).filter(|(node, hoisted)| !hoisted && is_counted_operation(node)).count()
}

/// Returns the expression nodes with these indices.
fn nodes_of_ids(graph: &Graph, ids: &[Id]) -> Vec<Node> {
    let nodes = graph.nodes();
    ids.iter().map(|id| nodes[*id as usize]).collect()
}

/// Returns the ids of all nodes that the outputs need, operands first, and writes the position of each node,
/// counted from one, to the table.
fn collect_needed_nodes(outputs: &[Expr<'_>], places: &mut [u32]) -> Vec<Id> {
    let Some(first) = outputs.first() else {
        return Vec::new();
    };
    let nodes = first.graph().nodes();
    let mut todo: Vec<Id> = Vec::new();
    // Nodes are created in the order of the algorithm, operands before operations: a bit set keeps this
    // order.
    let last = outputs.iter().map(|o| o.id()).max().unwrap_or(0);
    let mut bits = vec![0_u64; last as usize / 64 + 1];
    let mut push_unvisited_node = |id: Id, todo: &mut Vec<Id>| {
        let word = &mut bits[id as usize / 64];
        let bit = 1 << (id % 64);
        if *word & bit == 0 {
            *word |= bit;
            todo.push(id);
        }
    };
    for output in outputs {
        push_unvisited_node(output.id(), &mut todo);
    }
    while let Some(id) = todo.pop() {
        nodes[id as usize].visit_operands(|a| push_unvisited_node(a, &mut todo));
    }
    let mut order: Vec<Id> = Vec::new();
    for (k, &word) in bits.iter().enumerate() {
        let mut rest = word;
        while rest != 0 {
            let id = k as Id * 64 + rest.trailing_zeros();
            order.push(id);
            places[id as usize] = order.len() as u32;
            rest &= rest - 1;
        }
    }
    order
}
