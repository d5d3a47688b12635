//! Form of the derivatives of inverse dynamics with loops over blocks of links.

use super::output::BlockLoopDerivatives;
use crate::expr::Expr;
use crate::kinematics::Joint;
use crate::lower::{Operand, Program, lower};
use crate::machine::{BLOCK_COLUMN_COST, BLOCK_COST};
use crate::mechanics::derivatives::blocks::link_blocks;
use crate::mechanics::{acceleration_symbols, velocity_symbols};
use crate::mechanism::{LinkBlock, Model};

/// Returns the form with loops if the loops support the mechanism and cost less than `program`, whose outputs
/// are the derivatives.
pub(super) fn cheaper_block_loops<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    program: &Program,
) -> Option<BlockLoopDerivatives> {
    let best = program.simd.as_deref().unwrap_or(program).estimated_cost();
    let (v, a) = (velocity_symbols(model), acceleration_symbols(model));
    let found = link_blocks(model, joints, &v, &a)?;
    let cost = cost_of_loops(&found.blocks);
    if cost >= best {
        return None;
    }
    let passive: Vec<Expr<'g>> = found.passive.iter().map(|(_, _, _, entry)| *entry).collect();
    let quantities = lower(&[found.quantities, passive].concat());
    if cost + quantities.estimated_cost() >= best {
        return None;
    }
    Some(BlockLoopDerivatives {
        zeros: zeros_on_paths(&found.blocks, program, model.nv()),
        program: quantities,
        free: found.free,
        passive: found.passive.iter().map(|(by_v, i, j, _)| (*by_v, *i, *j)).collect(),
        blocks: found.blocks,
    })
}

/// Returns the estimated cost of the loops, in tenths of an instruction.
fn cost_of_loops(blocks: &[LinkBlock]) -> usize {
    let column_cost = |block: &LinkBlock| {
        block.count * (block.ancestors.len() + 2 + block.descendants.len()) * BLOCK_COLUMN_COST
    };
    blocks.iter().map(|block| BLOCK_COST + column_cost(block)).sum()
}

/// Returns column and row of the entries of each derivative that are always zero, although one link of the
/// two is an ancestor of the other.
fn zeros_on_paths(blocks: &[LinkBlock], program: &Program, nv: usize) -> [Vec<(usize, usize)>; 2] {
    [0, 1].map(|matrix| {
        let mut zeros = Vec::new();
        for (b, block) in blocks.iter().enumerate() {
            let path = block.ancestors.iter().copied().chain([b]).chain(block.descendants.iter().copied());
            let rows: Vec<usize> =
                path.flat_map(|k| blocks[k].first..blocks[k].first + blocks[k].count).collect();
            for column in block.first..block.first + block.count {
                let is_zero_entry = |row: &&usize| {
                    let output = program.outputs.get(matrix * nv * nv + column * nv + **row);
                    output == Some(&Operand::Const(0.0))
                };
                zeros.extend(rows.iter().filter(is_zero_entry).map(|row| (column, *row)));
            }
        }
        zeros
    })
}
