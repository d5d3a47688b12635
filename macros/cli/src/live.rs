//! `linkwork view --live`: motions that a page simulates.

use crate::Stop;
use crate::motion::MotionStart;
use linkwork_compiler::expr::Expr;
use linkwork_compiler::lower::lower;
use linkwork_jit::WebStart;
use linkwork_view::{Figure, Motion};

/// Returns the motion of a mechanism that the page simulates from its start on.
///
/// # Errors
///
/// The mechanism cannot be assembled, or pages cannot simulate it.
pub fn live_motion(start: &MotionStart<'_, '_>, figure: Figure) -> Result<Motion, Stop> {
    if let Some(why) = start.reason_without_motion() {
        return Err(Stop::Failure(format!("`{}` cannot be simulated: {why}", start.model.name)));
    }
    let robot = &start.robot;
    let (q, v) = start.initial_state()?;
    let numbers: Vec<Expr<'_>> =
        start.model.drawing.iter().flat_map(|piece| piece.numbers.iter().copied()).collect();
    let state = WebStart { q: &q, v: &v, x: &start.x, u: &start.u };
    let (data, module) = robot.web_data(&lower(&numbers), state)?;
    let placements = start.frame_placements(0.0, &q, &start.x)?;
    let terrain_height_at =
        |number: usize, place: [f64; 2]| robot.terrain_heights(place)?.get(number).copied();
    let motion = Motion::from_placements("", figure, vec![0.0], vec![placements])?.terrain(terrain_height_at);
    Ok(motion.simulated(data, module))
}
