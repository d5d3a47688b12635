//! Checks motions by equal steps with closed forms, and that hostile settings of motions are errors.

use linkwork_jit::{Error, Robot, declare};

const CART: &str = "#[mechanism]
    struct Cart {
        #[body(mass = 2)]
        cart: Body,
        #[joint(ground -> cart, along = x)]
        rail: Sleeve,
        #[acts(on = rail)]
        push: Force,
    }";
const BEAD: &str = "#[mechanism(gravity = -9.81 * y)]
    struct Bead {
        #[particle(mass = 3)]
        bead: Particle,
        #[joint(ground -> bead, along = (x, y))]
        plane: Stage,
        #[constraint(plane.x * plane.x + plane.y * plane.y = 1)]
        wire: Holonomic,
    }";
const BALL: &str = "#[mechanism(gravity = -9.81 * z)]
    struct Ball {
        #[particle(mass = 1)]
        ball: Particle,
        #[joint(ground -> ball, along = z)]
        height: Sleeve,
        #[contact(ball, ground.plane(z), restitution = 0)]
        floor: Contact,
    }";

/// Under forces that are constant in each step, the motion is a parabola in each step.
#[test]
fn inputs_are_constant_during_steps() -> Result<(), Error> {
    let cart = declare(CART)?;
    for (steps, h, start) in [(1, 0.1, 0.0), (7, 0.3, -2.0), (1000, 1e-3, 0.1), (333, 1.0 / 3.0, 1e3)] {
        let inputs: Vec<f64> = (0..steps).map(|k| f64::from(k * k % 11) - 5.0).collect();
        let rows = inputs.len() + 1;
        let (mut q, mut v) = (vec![f64::NAN; rows], vec![f64::NAN; rows]);
        (q[0], v[0]) = (0.5, -1.0);
        cart.roll_out(start, h, &inputs, [&mut q, &mut v])?;
        let (mut place, mut velocity) = (0.5, -1.0);
        for (k, u) in inputs.iter().enumerate() {
            place += h * velocity + 0.5 * h * h * u / 2.0;
            velocity += h * u / 2.0;
            let scale = 1.0_f64.max(f64::abs(place));
            assert!((q[k + 1] - place).abs() < 1e-10 * scale, "step {k} of {steps}: {}", q[k + 1]);
            assert!((v[k + 1] - velocity).abs() < 1e-10 * scale, "step {k} of {steps}: {}", v[k + 1]);
        }
    }
    Ok(())
}

/// A bead on a circle is a pendulum: it stays on the circle, and its energy is constant.
#[test]
fn constraints_hold_after_each_step() -> Result<(), Error> {
    let bead = declare(BEAD)?;
    const ROWS: usize = 401;
    let (mut q, mut v) = (vec![0.0; 2 * ROWS], vec![0.0; 2 * ROWS]);
    (q[0], q[1]) = (0.8, -0.6);
    bead.roll_out(0.0, 5e-3, &[], [&mut q, &mut v])?;
    let mut farthest = 0.0_f64;
    for (q, v) in q.chunks(2).zip(v.chunks(2)) {
        assert!((q[0].hypot(q[1]) - 1.0).abs() < 1e-10 && (q[0] * v[0] + q[1] * v[1]).abs() < 1e-10);
        let energy = 0.5 * (v[0] * v[0] + v[1] * v[1]) + 9.81 * q[1];
        assert!((energy + 9.81 * 0.6).abs() < 1e-6, "{energy}");
        farthest = farthest.max(-q[0]);
    }
    assert!((farthest - 0.8).abs() < 1e-3, "it swings to the other side: {farthest}");
    Ok(())
}

#[test]
fn a_ball_comes_to_rest() -> Result<(), Error> {
    let ball = declare(BALL)?;
    let (mut q, mut v) = (vec![0.2; 1001], vec![0.0; 1001]);
    ball.roll_out(0.0, 1e-3, &[], [&mut q, &mut v])?;
    assert!(q.iter().all(|q| *q > -1e-3) && (q[150] - (0.2 - 0.5 * 9.81 * 0.15 * 0.15)).abs() < 1e-3);
    assert!(q[1000].abs() < 1e-9 && v[1000].abs() < 1e-9);
    Ok(())
}

fn assert_value_error(result: Result<(), Error>, words: &str) {
    match result {
        Err(Error::Value(message)) => assert!(message.contains(words), "{message}"),
        other => panic!("{other:?} instead of a value that is refused: {words}"),
    }
}

#[test]
fn wrong_settings_are_errors() -> Result<(), Error> {
    let cart = declare(CART)?;
    let roll_out = |start: f64, h: f64, inputs: &[f64], sizes: [usize; 2]| {
        let [mut q, mut v] = sizes.map(|n| vec![0.0; n]);
        cart.roll_out(start, h, inputs, [&mut q, &mut v])
    };
    for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_value_error(roll_out(0.0, h, &[], [3, 3]), "step");
    }
    assert_value_error(roll_out(f64::NAN, 0.1, &[], [3, 3]), "time");
    for (inputs, sizes) in [(&[1.0][..], [3, 3]), (&[], [2, 3]), (&[], [0, 0]), (&[1.0; 4], [3, 3])] {
        assert!(matches!(roll_out(0.0, 0.1, inputs, sizes), Err(Error::Length { .. })), "{sizes:?}");
    }
    let simulate = |robot: &Robot, start: f64, duration: f64, every: f64| {
        robot.simulate().start_at(start).duration(duration).sample_every(every).run().map(|_| ())
    };
    assert_value_error(simulate(&cart, 0.0, 1e9, 1e-9), "samples are too many");
    assert_value_error(simulate(&cart, 0.0, 1e300, 1e-300), "samples are too many");
    assert_value_error(simulate(&cart, f64::NAN, 1.0, 0.1), "the time at the start");
    assert_value_error(simulate(&cart, 0.0, f64::INFINITY, 0.1), "the duration");
    Ok(())
}
