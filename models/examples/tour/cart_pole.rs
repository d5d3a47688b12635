//! Cart-pole: swing-up by energy shaping, then stabilisation by a linear–quadratic regulator.

use crate::report::{
    Picture, Section, Table, UpperBoundCheck, declaration_of_mechanism, format_number, pairs_of_curve,
};
use crate::scene::{Part, Scene, Tone, View, corners_of_box, faces_of_box, point_in_ground};
use linkwork::nalgebra::IsometryMatrix3;
use linkwork::prelude::*;
use linkwork_design::matrices::Cost;
use linkwork_design::mechanism::linear_system;
use linkwork_models::CartPole;
use std::f64::consts::{PI, TAU};

const CART_POLE: CartPole = CartPole { cart_mass: 1.0, pole_mass: 0.3, pole_length: 1.0, rail_damping: 0.5 };
/// Maximum force of the motor, N.
const STRENGTH: f64 = 15.0;
/// Period of the digital controller, s.
const PERIOD: f64 = 0.005;
/// Time interval of a disturbance on the cart, s. The constant below is its force, N.
const SHOVE: std::ops::Range<f64> = 8.0..8.1;
const SHOVING: f64 = 18.0;
const DURATION: f64 = 12.0;
/// Frames per second of the animation.
const RATE: f64 = 50.0;

type CartPoleVector = SVector<f64, 2>;

/// Controller that swings the pole up, and switches to the regulator near the upright position.
struct SwingUpController {
    gains: SMatrix<f64, 1, 4>,
    /// Time of the last switch to the regulator, s.
    caught: Option<f64>,
}

pub fn run_cart_pole_tour() -> Result<Section, Box<dyn std::error::Error>> {
    let upright_system =
        linear_system(&CART_POLE, &CartPoleVector::zeros(), &CartPoleVector::zeros(), &SVector::zeros())?;
    // Riccati's equation for inputs that are constant over a period.
    let best = upright_system.lqr_held(&Cost::diagonal(&[20.0, 10.0, 1.0, 1.0], &[0.05]), PERIOD)?;
    let gains = SMatrix::<f64, 1, 4>::from_iterator(best.gain.iter().copied());
    let mut controller = SwingUpController { gains, caught: None };
    let mut forces = Vec::new();
    let run = simulate(&CART_POLE)
        .from([0.0, PI - 0.05], [0.0, 0.0])
        .control_every(PERIOD, |t, q, v| {
            let push = controller.force_on_cart(t, q, v).clamp(-STRENGTH, STRENGTH);
            forces.push([t, push]);
            [push + if SHOVE.contains(&t) { SHOVING } else { 0.0 }].into()
        })
        .duration(DURATION)
        .sample_every(1.0 / RATE);
    let samples: Vec<_> = run.collect::<Result<_, _>>()?;
    let caught = controller.caught.unwrap_or(f64::NAN);

    let largest_magnitude_since = |from: f64, f: &dyn Fn(&CartPoleVector) -> f64| {
        samples.iter().filter(|s| s.t >= from).map(|s| f(&s.q).abs()).fold(0.0, f64::max)
    };
    let strongest = forces.iter().map(|f| f[1].abs()).fold(0.0, f64::max);
    let table = Table {
        head: Vec::new(),
        rows: vec![
            vec!["gains for x, θ and their rates".into(), gains_text(&gains)],
            vec!["caught upright after".into(), format!("{caught:.2} s")],
            vec!["strongest push".into(), format!("{strongest:.1} N")],
            vec!["track used".into(), format!("±{:.2} m", largest_magnitude_since(0.0, &|q| q[0]))],
            vec![
                format!("tilt after a shove of {SHOVING} N for {:.1} s", SHOVE.end - SHOVE.start),
                format!(
                    "{:.1}°",
                    largest_magnitude_since(SHOVE.start, &|q| angle_from_upright(q[1])).to_degrees()
                ),
            ],
        ],
    };
    let checks = vec![
        UpperBoundCheck::new("caught upright, s", caught, SHOVE.start - 1.0),
        UpperBoundCheck::new("track used, m", largest_magnitude_since(0.0, &|q| q[0]), 1.0),
        UpperBoundCheck::new(
            "tilt at the end, rad",
            largest_magnitude_since(DURATION - 0.5, &|q| angle_from_upright(q[1])),
            5e-3,
        ),
        UpperBoundCheck::new(
            "cart's distance from the middle at the end, m",
            largest_magnitude_since(DURATION - 0.5, &|q| q[0]),
            0.02,
        ),
    ];
    // The upright position is a multiple of a full turn; the reached one is drawn as zero.
    let turns = samples.last().map_or(0.0, |s| (s.q[1] / TAU).round() * TAU);
    let pictures = vec![
        Picture::over_time("Cart and pole", "position, m; angle, rad", |chart| {
            let cart = chart.curve("cart x, m", samples.iter().map(|s| (s.t, s.q[0])));
            let both = cart.curve("pole θ from upright, rad", samples.iter().map(|s| (s.t, s.q[1] - turns)));
            both.instant(caught, "caught").instant(SHOVE.start, "shove")
        })?,
        Picture::over_time("Force of the motor on the cart", "force, N", |chart| {
            chart.curve("", pairs_of_curve(&forces)).instant(caught, "caught").instant(SHOVE.start, "shove")
        })?,
    ];
    Ok(Section {
        title: "A cart-pole swings itself up".into(),
        text: format!(
            "It hangs down; a digital controller at {:.0} Hz pumps energy into the pole, catches it upright \
             with a \
             linear–quadratic regulator (Riccati's equation on the linearised generated equations) and holds \
                 it against a shove.",
            1.0 / PERIOD
        ),
        declaration: declaration_of_mechanism(include_str!("../../src/cart_pole.rs"), "CartPole"),
        equations: CartPole::EQUATIONS,
        tables: vec![table],
        checks,
        scenes: vec![scene_of_samples(&samples, caught)],
        pictures,
    })
}

impl SwingUpController {
    fn force_on_cart(&mut self, t: f64, q: &CartPoleVector, v: &CartPoleVector) -> f64 {
        let x = SVector::from([q[0], angle_from_upright(q[1]), v[0], v[1]]);
        let hold = -(self.gains * x)[0];
        // Switch to the regulator as soon as the motor is strong enough; switch back only if the pole falls.
        let holding = self.caught.is_some() && x[1].abs() < 1.0;
        if holding || (x[1].abs() < 0.4 && hold.abs() < STRENGTH) {
            self.caught.get_or_insert(t);
            return hold;
        }
        self.caught = None;
        self.swing_up_force(q, v)
    }

    /// Returns the force of Åström and Furuta's energy shaping, *Automatica* 36 (2000). The pole's energy `E`
    /// relative to the cart is controlled to that of the upright position; `Ė` is proportional to the cart's
    /// acceleration.
    fn swing_up_force(&self, q: &CartPoleVector, v: &CartPoleVector) -> f64 {
        let turning = CartPoleVector::new(0.0, v[1]);
        let top = CART_POLE.potential_energy(&CartPoleVector::zeros());
        let energy = CART_POLE.kinetic_energy(q, &turning) + CART_POLE.potential_energy(q) - top;
        let acceleration = -3.0 * energy * v[1] * q[1].cos() - 14.0 * q[0] - 4.0 * v[0];
        // Force that gives the cart this acceleration while the pole rotates freely: two rows of M v̇ + h =
        // τ.
        let (m, h) = (CART_POLE.mass_matrix(q), CART_POLE.bias_forces(q, v));
        let turn = -(h[1] + m[(1, 0)] * acceleration) / m[(1, 1)];
        m[(0, 0)] * acceleration + m[(0, 1)] * turn + h[0]
    }
}

/// Returns the angle of the pole from the upright position, between −π and π.
fn angle_from_upright(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

fn gains_text(gains: &SMatrix<f64, 1, 4>) -> String {
    gains.iter().map(|k| format_number(*k).replace('-', "−")).collect::<Vec<_>>().join(", ")
}

fn scene_of_samples(samples: &[Sample<f64, 2, 2, 1>], caught: f64) -> Scene {
    // The mechanism's y axis points up, that of the animation is z.
    let to_z_up = |body: &IsometryMatrix3<f64>, at| {
        let [x, y, z] = point_in_ground(body, at);
        [x, -z, y]
    };
    let points_of_sample = |s: &Sample<f64, 2, 2, 1>| {
        let cart = CART_POLE.frame_placement(frame!(CartPole, "cart"), &s.q);
        let pole = CART_POLE.frame_placement(frame!(CartPole, "pole"), &s.q);
        let mut points = vec![to_z_up(&pole, [0.0; 3]), to_z_up(&pole, [0.0, CART_POLE.pole_length, 0.0])];
        points
            .extend(corners_of_box(&cart, [0.0, -0.04, 0.0], [0.16, 0.07, 0.1]).map(|[x, y, z]| [x, -z, y]));
        // The force is an arrow that ends at the cart.
        let side = -0.17 * s.u[0].signum();
        points.push(to_z_up(&cart, [side - 0.03 * s.u[0], -0.04, 0.0]));
        points.push(to_z_up(&cart, [side, -0.04, 0.0]));
        points.extend([[-1.2, 0.0, -0.127], [1.2, 0.0, -0.127]]);
        points
    };
    let mut parts = vec![
        Part::Rod(12, 13, 0.014, Tone::Dark),
        Part::Rod(0, 1, 0.022, Tone::Accent),
        Part::Ball(0, 0.035, Tone::Dark),
        Part::Arrow(10, 11, Tone::Second),
    ];
    parts.extend(faces_of_box(2, Tone::Body));
    let sample_index_at_time = |t: f64| (t * RATE) as usize;
    Scene {
        title: "Swing-up, catch, shove",
        rate: RATE,
        speed: 1.0,
        parts,
        frames: samples.iter().map(points_of_sample).collect(),
        still: 4.6,
        captions: vec![
            (0, "pumping energy".into()),
            (sample_index_at_time(caught), "caught: regulator holds".into()),
            (sample_index_at_time(SHOVE.start), format!("shoved with {SHOVING} N")),
            (sample_index_at_time(SHOVE.end) + 20, "regulator holds".into()),
        ],
        guides: Vec::new(),
        trail: Some((1, 40)),
        view: View {
            target: [0.0, 0.0, 0.0],
            size: [4.4, 2.4],
            yaw: 0.0,
            pitch: 6.0,
            turning: 0.0,
            floor: None,
        },
    }
}
