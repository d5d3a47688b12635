//! Two legs walk down a gentle slope without motors: the simplest walking model, with its published gait.
//!
//! The model has a heavy hip and light feet. Between two touchdowns it is a double pendulum that stands on
//! one foot ([`contact::hold`]). At touchdown the other foot sticks, the first one lifts off
//! ([`contact::land`]), and the legs exchange their roles. A step dissipates the energy that the slope
//! supplies. A gait is a fixed point of the map from one step to the next, and this one is stable. As in the
//! source, the swinging foot passes through the ground on its way forward, since the legs have no knees.
//!
//! Source: Garcia, Chatterjee, Ruina and Coleman, *The simplest walking model: stability, complexity, and
//! scaling*, Journal of Biomechanical Engineering 120 (1998). Units: leg length for lengths, √(l/g) for
//! times.
//!
//! ```text
//! cargo run --release --example passive_walker -p linkwork-models
//! ```

use linkwork::contact::{self, Touch};
use linkwork::prelude::*;

/// Walker: hip on two legs; `x` points down the slope, `y` is normal to it.
#[mechanism(gravity = sin(slope) * x - cos(slope) * y)]
struct CompassWalker {
    /// Angle of the slope, rad.
    #[unit(rad)]
    slope: f64,
    /// Mass of a foot, relative to the mass of the hip.
    #[unit(kg)]
    foot: f64,
    #[body(mass = 1)]
    hip: Body,
    #[body(mass = foot, com = -y)]
    left: Body,
    #[body(mass = foot, com = -y)]
    right: Body,
    #[joint(ground -> hip, along = (x, y))]
    place: Stage,
    #[joint(hip -> left, about = z)]
    left_leg: Pin,
    #[joint(hip -> right, about = z)]
    right_leg: Pin,
    #[contact(left.at(-y), ground.plane(y), friction = 1)]
    left_foot: Contact,
    #[contact(right.at(-y), ground.plane(y), friction = 1)]
    right_foot: Contact,
}

/// State of a gait just after a touchdown, with both feet on the ground: the angle of the stance leg from the
/// slope's normal, and its rate.
type GaitState = [f64; 2];

/// Published fixed point of the walking step for the slope 0.009.
const PUBLISHED: GaitState = [0.200310900544287, -0.199832473004977];

/// Returns the state with this gait and the left leg at the origin.
fn walker_state_of_gait([angle, rate]: GaitState) -> (SVector<f64, 4>, SVector<f64, 4>) {
    let (sin, cos) = angle.sin_cos();
    let q = [-sin, cos, angle, -angle].into();
    (q, [-cos * rate, -sin * rate, rate, rate * (2.0 * angle).cos()].into())
}

/// Simulates one step on the left leg. Returns the gait after the touchdown of the right foot, the duration,
/// the distance of the hip, and the energy that the touchdown dissipates.
fn simulate_step(
    walker: &CompassWalker,
    gait: GaitState,
) -> Result<(GaitState, f64, f64, f64), Box<dyn std::error::Error>> {
    let (q, v) = walker_state_of_gait(gait);
    let stance = contact::hold(walker, [Touch::Sticks, Touch::Open]);
    // Both feet are also on the ground in mid-swing, when the sum of the angles rises through zero: that
    // crossing is ignored.
    let run = simulate(&stance).from(q, v).method(DormandPrince8::new().tolerance(1e-13, 1e-13));
    let strikes = run.until_crossing(Crossing::Falling, |_t, q, _v| q[2] + q[3]).duration(20.0);
    let end = strikes.finish()?;
    if end.q[2] >= 0.0 || end.t >= 20.0 {
        return Err("it falls".into());
    }
    let after = contact::land(walker, 0.0, &end.q, &end.v, &[Touch::Open, Touch::Sticks])?;
    let lost = walker.kinetic_energy(&end.q, &end.v) - walker.kinetic_energy(&end.q, &after.v);
    Ok(([end.q[3], after.v[3]], end.t, end.q[0] - q[0], lost))
}

/// Prints the gait of the walker, and the decay of a disturbance.
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let walker = CompassWalker { slope: 0.009, foot: 1e-7 };
    let (next, time, way, lost) = simulate_step(&walker, PUBLISHED)?;
    println!("a step: {time:.4} √(l/g), {way:.4} l");
    // The published gait, for massless feet, is reproduced.
    for (found, published) in next.iter().zip(PUBLISHED) {
        assert!((found - published).abs() < 1e-6, "{found}");
    }
    // The slope supplies the energy that the touchdown dissipates.
    let given = way * walker.slope.sin();
    assert!((lost - given).abs() < 1e-6, "{lost} {given}");

    // The gait recovers from a disturbance.
    let mut gait = [PUBLISHED[0] * 1.003, PUBLISHED[1] * 0.998];
    for count in 1..=60 {
        gait = simulate_step(&walker, gait)?.0;
        if count % 15 == 0 {
            println!("after {count} steps off by {:.1e}", (gait[0] - PUBLISHED[0]).abs());
        }
    }
    assert!((gait[0] - PUBLISHED[0]).abs() < 1e-6 && (gait[1] - PUBLISHED[1]).abs() < 1e-6);

    // On level ground the walker falls before the other foot touches down.
    let level = CompassWalker { slope: 0.0, ..walker };
    assert!(simulate_step(&level, PUBLISHED).is_err());
    Ok(())
}

#[test]
fn walker_has_the_published_gait() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
