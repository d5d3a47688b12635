//! Interpolation tables of a robot, as functions of C.

use crate::{Failure, LwRobot, raw, run_guarded, value_or_fallback};
use linkwork::TableError;
use linkwork_jit::AnyTable;
use std::ffi::c_int;

/// Bits of the options of a table, as the header has them.
const SMOOTH: c_int = 1;
const EXTRAPOLATED: c_int = 2;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_variables(robot: *const LwRobot, table: usize) -> usize {
    value_or_fallback(0, || {
        // SAFETY: a robot of this library, as the header says.
        let robot = &unsafe { raw::shared(robot) }?.robot;
        Ok(robot.tables().get(table).ok_or(Failure::Index(table))?.1)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn lw_set_table(
    robot: *mut LwRobot,
    table: usize,
    axes: *const *const f64,
    lengths: *const usize,
    values: *const f64,
    options: c_int,
) -> c_int {
    run_guarded(|| {
        // SAFETY: a robot of this library that nothing else uses now, as the header says.
        let robot = &mut unsafe { raw::mutable_reference_from_pointer(robot) }?.robot;
        let (name, variables) = robot.tables().get(table).cloned().ok_or(Failure::Index(table))?;
        // SAFETY: pointers to the axes, and their lengths, one for each variable, as the header says.
        let (axes, lengths) = unsafe { (raw::array(axes, variables)?, raw::array(lengths, variables)?) };
        let count = lengths.iter().try_fold(1_usize, |product, length| product.checked_mul(*length));
        let count = count.ok_or(Failure::Table(TableError::Size { expected: usize::MAX, found: 0 }))?;
        let lists: Result<Vec<&[f64]>, Failure> =
            // SAFETY: arrays of these lengths, as the header says.
            axes.iter().zip(lengths).map(|(axis, length)| unsafe { raw::array(*axis, *length) }).collect();
        // SAFETY: one value for each point of the grid, as the header says.
        let values = unsafe { raw::array(values, count) }?;
        let found = AnyTable::from_grid(&lists?, values).map_err(Failure::Table)?;
        let found = if options & SMOOTH != 0 { found.smooth() } else { found };
        let found = if options & EXTRAPOLATED != 0 { found.extrapolated() } else { found };
        Ok(robot.set_table(&name, found)?)
    })
}
