//! Tests of contacts with terrain whose height is an expression or a table.

use linkwork::prelude::*;

#[mechanism(gravity = -g * z)]
struct BallOnHills {
    g: f64,
    radius: f64,
    height: f64,
    length: f64,
    #[body(mass = 1, inertia = sphere(1, radius))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(
        ball.sphere(radius), ground.terrain(height * cos(u / length) * sin(w / length)), friction = 0.5
    )]
    hills: Contact,
}

/// Returns the minimum distance of a point from the hills by a numerical search.
fn searched_distance_to_hills(m: &BallOnHills, [x, y, z]: [f64; 3]) -> f64 {
    let squared_distance_to_hill = |u: f64, w: f64| {
        let height = m.height * (u / m.length).cos() * (w / m.length).sin();
        (u - x).powi(2) + (w - y).powi(2) + (height - z).powi(2)
    };
    let (mut best, mut size) = ([x, y], 0.2);
    while size > 1e-10 {
        let search_grid_point = |k: i32| {
            [best[0] + size * f64::from(k % 9 - 4) / 4.0, best[1] + size * f64::from(k / 9 - 4) / 4.0]
        };
        let least = (0..81).map(search_grid_point).min_by(|a, b| {
            squared_distance_to_hill(a[0], a[1]).total_cmp(&squared_distance_to_hill(b[0], b[1]))
        });
        best = least.unwrap();
        size *= 0.6;
    }
    squared_distance_to_hill(best[0], best[1]).sqrt()
}

/// Near the ground the distance of a ball is the global minimum; far above the ground it is at least a
/// fraction of the height.
#[test]
fn distances_from_hills_are_global_minima() {
    let m = BallOnHills { g: 9.81, radius: 0.1, height: 0.15, length: 0.4 };
    for k in 0..200 {
        let (x, y) = ((f64::from(k) * 0.37).sin(), (f64::from(k) * 0.73).cos());
        let ground = m.height * (x / m.length).cos() * (y / m.length).sin();
        let gap_at_height = |z: f64| m.contact_gaps(&[x, y, z, 0.0, 0.0, 0.0, 1.0].into())[0];
        for above in [0.095, 0.1, 0.11] {
            let found = searched_distance_to_hills(&m, [x, y, ground + above]) - m.radius;
            assert!(
                (gap_at_height(ground + above) - found).abs() < 1e-7,
                "{x} {y} {above}: {} {found}",
                gap_at_height(ground + above)
            );
        }
        for above in [0.3, 1.0, 10.0] {
            assert!(gap_at_height(ground + above) > above / 3.0 - m.radius, "{x} {y} {above}");
        }
    }
}

#[mechanism(gravity = -g * z)]
struct BallInHollow {
    g: f64,
    radius: f64,
    curvature: f64,
    friction: f64,
    #[body(mass = 2, inertia = sphere(2, radius))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(
        ball.sphere(radius), ground.terrain(curvature / 2 * (pow(u, 2) + pow(w, 2))), friction = friction
    )]
    hollow: Contact,
}

/// Checks that a ball at the bottom of a hollow swings as a pendulum. Its length is the difference of the
/// radii, times 7/5 if the ball rolls.
#[test]
fn ball_in_a_hollow_swings_as_a_pendulum() {
    for (friction, share) in [(0.0, 1.0), (0.5, 1.4)] {
        let m = BallInHollow { g: 9.81, radius: 0.05, curvature: 1.25, friction };
        let length = 1.0 / m.curvature - m.radius;
        let quarter = core::f64::consts::FRAC_PI_2 * (length * share / m.g).sqrt();
        let start = [1e-3, 0.0, 0.05 + 0.625e-6 * (1.0 + m.radius * m.curvature), 0.0, 0.0, 0.0, 1.0];
        let run = simulate(&m).from(start, [0.0; 6]).method(TimeStepping::step(1e-3)).duration(quarter);
        let end = run.finish().unwrap();
        // The ball passes the bottom with the speed of a harmonic oscillation.
        assert!(end.q[0].abs() < 5e-6, "{friction}: {}", end.q[0]);
        let speed = end.v.fixed_rows::<3>(0).norm();
        assert!((speed - 1e-3 * (m.g / (length * share)).sqrt()).abs() < 1e-5, "{friction}: {speed}");
    }
}

#[mechanism(gravity = -9.81 * z)]
struct BoxOnSteps {
    heights: Table<2>,
    #[body(mass = 2, inertia = cuboid(2, 0.2, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.2, 0.2, 0.1), ground.terrain(heights(u, w)), friction = 0.6)]
    field: Contact,
}

/// A box that falls on a height field comes to rest on at least three corners.
#[test]
fn box_rests_on_a_height_field() -> Result<(), Box<dyn core::error::Error>> {
    const AXIS: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
    static HEIGHTS: [f64; 25] = {
        let mut heights = [0.0; 25];
        let mut k = 0;
        while k < 25 {
            heights[k] = 0.03 * ((k * 7 % 5) as f64);
            k += 1;
        }
        heights
    };
    for heights in [Table::new([&AXIS, &AXIS], &HEIGHTS)?, Table::new([&AXIS, &AXIS], &HEIGHTS)?.smooth()] {
        let m = BoxOnSteps { heights };
        let run = simulate(&m).from([0.1, -0.2, 0.4, 0.0, 0.0, 0.0, 1.0], [0.1, 0.0, 0.0, 0.3, 0.2, 0.0]);
        let end = run.method(TimeStepping::step(1e-3)).duration(4.0).finish()?;
        assert!(end.v.norm() < 1e-6, "{}", end.v);
        let gaps = m.contact_gaps(&end.q);
        assert!(gaps.min() > -1e-6 && gaps.iter().filter(|gap| gap.abs() < 1e-6).count() >= 3, "{gaps}");
    }
    Ok(())
}
