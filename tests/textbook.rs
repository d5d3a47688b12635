//! Problems of the textbooks in the words that they are stated in: the mechanisms of the language's own page, and
//! others with free coordinates, moving frames, laws, potentials and outputs, each against its closed form. Those that the
//! gallery of ready-made mechanisms has are taken from there.

#![allow(missing_docs, reason = "the mechanisms stand here as they stand on the page")]

use linkwork::nalgebra::{Matrix2, Matrix3, Rotation3, SMatrix, SVector, Vector1, Vector2, Vector3, Vector6};
use linkwork::{Mechanism, at, frame, mechanism, simulate};
use linkwork_models::{BeadOnSpinningHoop, DoublePendulum, KapitzaPendulum, TwoBodies};
use std::f64::consts::{FRAC_PI_2, PI};
use support::compare::{assert_close, assert_same_dynamics};
use support::random::Random;
use support::robots::PandaMimic;
use support::simulate::{advance, advance_from};
use support::table::Record;

/// Identities.
const EXACT: f64 = 1e-13;
/// Motions.
const MOTION: f64 = 1e-10;

// ---- The mechanisms of the language's page -----------------------------------------------------------------------

#[test]
fn double_pendulum() {
    let (g, m1, m2, l1, l2) = (9.81, 1.3, 0.7, 0.9, 1.1);
    let pendulum = DoublePendulum { g, m1, m2, l1, l2 };
    let (q, v) = (Vector2::new(0.4, -1.3_f64), Vector2::new(1.5, -0.8));
    let (sin, cos) = q[1].sin_cos();
    let couple = m2 * l1 * l2 / 2.0;
    let far = m2 * l2 * l2 / 3.0;
    let mass = Matrix2::new(
        m1 * l1 * l1 / 3.0 + m2 * l1 * l1 + far + 2.0 * couple * cos,
        far + couple * cos,
        0.0,
        far,
    );
    assert_close("mass", pendulum.mass_matrix(&q).upper_triangle().as_slice(), mass.as_slice(), EXACT);
    let weight = m2 * g * l2 / 2.0 * (q[0] + q[1]).sin();
    let bias = [
        -couple * sin * (2.0 * v[0] * v[1] + v[1] * v[1]) + (m1 / 2.0 + m2) * g * l1 * q[0].sin() + weight,
        couple * sin * v[0] * v[0] + weight,
    ];
    assert_close("bias", pendulum.bias_forces(&q, &v).as_slice(), &bias, EXACT);
}

/// Goldstein, *Classical Mechanics*, ch. 2: beyond `g / (R Ω²)` the bead leaves the bottom.
#[test]
fn bead_on_spinning_hoop() {
    let (g, m, radius, spin) = (9.81, 2.0, 0.5, 6.0);
    let hoop = BeadOnSpinningHoop { g, mass: m, radius, spin };
    for t in [0.0, 0.3] {
        let (q, v) = (Vector1::new(0.4_f64), Vector1::new(0.7));
        let (sin, cos) = q[0].sin_cos();
        let expected = m * radius * sin * (g - radius * spin * spin * cos);
        assert_close("mass", hoop.mass_matrix(t, &q).as_slice(), &[m * radius * radius], EXACT);
        assert_close("bias", hoop.bias_forces(t, &q, &v).as_slice(), &[expected], EXACT);
        let energy = m * radius * radius * (v[0] * v[0] + (spin * sin).powi(2)) / 2.0;
        assert_close("energy", &[hoop.kinetic_energy(t, &q, &v)], &[energy], EXACT);
        let place = at(&hoop, t);
        assert_close("at", place.bias_forces(&q, &v).as_slice(), &[expected], EXACT);
        let bead = hoop.frame_placement(frame!(BeadOnSpinningHoop, "bead"), t, &q).translation.vector;
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), spin * t) * Vector3::new(sin, 0.0, -cos);
        assert_close("place", bead.as_slice(), (turned * radius).as_slice(), EXACT);
    }
    let rest = Vector1::new((g / (radius * spin * spin)).acos());
    let (q, v) = advance(&hoop, &rest, &Vector1::zeros(), 2.0);
    assert_close("relative equilibrium", &[q[0], v[0]], &[rest[0], 0.0], MOTION);
}

#[mechanism]
pub struct TunedSuspension {
    pub m1: f64,
    pub m2: f64,
    pub k1: f64,
    pub k2: f64,
    pub c: f64,
    pub b: f64,

    #[body(mass = m1)]
    first: Body,
    #[body(mass = m2)]
    second: Body,
    #[joint(ground -> first, along = x)]
    rail: Sleeve,
    #[joint(ground -> second, along = x)]
    rail2: Sleeve,
    #[acts(between = (ground, first), stiffness = k1, free_length = 0)]
    anchor: Spring,
    #[acts(between = (first, second), stiffness = k2, free_length = 0)]
    coil: Spring,
    #[acts(between = (first, second), damping = c)]
    damper: Dashpot,
    #[acts(between = (first, second), inertance = b)]
    inerter: Inerter,
}

#[test]
fn tuned_suspension() {
    let cart = TunedSuspension { m1: 2.0, m2: 1.0, k1: 100.0, k2: 40.0, c: 0.3, b: 0.5 };
    let origin = Vector2::zeros();
    // The carts meet at the origin: nothing special happens there.
    assert_eq!(cart.bias_forces(&origin, &origin), origin);
    let mass = cart.mass_matrix(&origin);
    assert_close("mass", mass.as_slice(), &[2.5, -0.5, -0.5, 1.5], EXACT);
    let column = |k: usize| cart.bias_forces(&Vector2::ith(k, 1.0), &origin);
    let stiffness = Matrix2::from_columns(&[column(0), column(1)]);
    assert_close("stiffness", stiffness.as_slice(), &[140.0, -40.0, -40.0, 40.0], EXACT);
    let damping = cart.bias_forces(&origin, &Vector2::new(1.0, 3.0));
    assert_close("damping", damping.as_slice(), &[-0.6, 0.6], EXACT);
    let square = mass.try_inverse().expect("regular") * stiffness;
    let half = square.trace() / 2.0;
    let root = (half * half - square.determinant()).sqrt();
    let modes = [(half - root).sqrt(), (half + root).sqrt()];
    assert_close("modes", &modes, &[4.472135954999579, 7.559289460184545], EXACT);
}

#[mechanism(gravity = -9.81 * z)]
pub struct Gyroscope {
    pub mass: f64,
    pub axial: f64,
    pub transverse: f64,

    #[body(mass = 0, inertia = 0)]
    outer: Body,
    #[body(mass = 0, inertia = 0)]
    inner: Body,
    #[body(mass = mass, inertia = diagonal(transverse, transverse, axial))]
    rotor: Body,
    #[joint(ground -> outer, about = z)]
    precession: Pin,
    #[joint(outer -> inner, about = x)]
    nutation: Pin,
    #[joint(inner -> rotor, about = z)]
    spin: Pin,
    #[output(omega(rotor / ground), resolved_in = inner)]
    body_rate: Vector,
}

#[test]
fn gyroscope() {
    let (axial, transverse) = (2.0, 3.0);
    let gyroscope = Gyroscope { mass: 1.0, axial, transverse };
    let (q, v) = (Vector3::new(0.1, 0.6_f64, 0.3), Vector3::new(1.0, 2.0, 3.0));
    let (sin, cos) = q[1].sin_cos();
    let jacobian = Matrix3::new(0.0, 1.0, 0.0, sin, 0.0, 0.0, cos, 0.0, 1.0);
    assert_close("rate", gyroscope.body_rate(&q, &v).as_slice(), (jacobian * v).as_slice(), EXACT);
    assert_close("Jacobian", gyroscope.body_rate_jacobian(&q, &v).as_slice(), jacobian.as_slice(), EXACT);
    let inertia = Matrix3::from_diagonal(&Vector3::new(transverse, transverse, axial));
    let mass = jacobian.transpose() * inertia * jacobian;
    assert_close("mass", gyroscope.mass_matrix(&q).as_slice(), mass.as_slice(), EXACT);
}

/// Gimbal lock: with the axes of precession and spin in line, the mass matrix is singular, everything else is still
/// right, and the acceleration is not a wrong number but none.
#[test]
fn gimbal_lock() {
    let gyroscope = Gyroscope { mass: 1.0, axial: 2.0, transverse: 3.0 };
    let (q, v) = (Vector3::new(0.1, 0.0, 0.3), Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(gyroscope.mass_matrix(&q).determinant(), 0.0);
    assert_close("rate", gyroscope.body_rate(&q, &v).as_slice(), &[2.0, 0.0, 4.0], EXACT);
    let bias = gyroscope.bias_forces(&q, &v);
    assert_close("bias", bias.as_slice(), &[0.0, 0.0, 0.0], EXACT);
    let acceleration = gyroscope.forward_dynamics(&q, &v, &Vector3::new(1.0, 0.0, 0.0));
    assert!(acceleration.iter().any(|a| !a.is_finite()));
}

#[mechanism(gravity = 9.81 * z)]
pub struct Aircraft {
    pub m: f64,
    pub ixx: f64,
    pub iyy: f64,
    pub izz: f64,
    pub ixz: f64,
    pub rho: f64,
    pub area: f64,
    pub chord: f64,
    pub cl0: f64,
    pub cl_alpha: f64,
    pub cm_elevator: f64,

    elevator: Input,
    #[body(mass = m, inertia = [[ixx, 0, ixz], [0, iyy, 0], [ixz, 0, izz]])]
    airframe: Body,
    #[joint(ground -> airframe)]
    flight: Free,
    #[define(v(airframe / ground / ground))]
    velocity: Vector,
    #[define(atan2(dot(velocity, airframe.z), dot(velocity, airframe.x)))]
    alpha: Scalar,
    #[define(rho / 2 * dot(velocity, velocity))]
    pressure: Scalar,
    #[acts(
        on = airframe,
        value = pressure * area * (cl0 + cl_alpha * alpha) * (sin(alpha) * airframe.x - cos(alpha) * airframe.z)
    )]
    lift: Force,
    #[acts(on = airframe, value = pressure * area * chord * cm_elevator * elevator * airframe.y)]
    pitch: Torque,
    #[output(alpha)]
    angle_of_attack: Scalar,
}

#[test]
fn aircraft() {
    let (m, rho, area, chord) = (600.0, 1.2, 12.0, 1.3);
    let plane = Aircraft {
        m,
        ixx: 900.0,
        iyy: 1300.0,
        izz: 2000.0,
        ixz: 50.0,
        rho,
        area,
        chord,
        cl0: 0.2,
        cl_alpha: 5.0,
        cm_elevator: -1.1,
    };
    let (u, w) = (40.0_f64, 2.0_f64);
    let (q, v) = (plane.neutral(), Vector6::new(u, 0.0, w, 0.0, 0.0, 0.0));
    let alpha = w.atan2(u);
    let pressure = rho / 2.0 * (u * u + w * w);
    let lift = pressure * area * (0.2 + 5.0 * alpha);
    let (sin, cos) = alpha.sin_cos();
    assert_close("angle of attack", &[plane.angle_of_attack(&q, &v)], &[alpha], EXACT);
    let square = u * u + w * w;
    let jacobian = [-w / square, 0.0, u / square, 0.0, 0.0, 0.0];
    assert_close("its Jacobian", plane.angle_of_attack_jacobian(&q, &v).as_slice(), &jacobian, EXACT);
    let bias = [-lift * sin, 0.0, lift * cos - m * 9.81, 0.0, 0.0, 0.0];
    assert_close("bias", plane.bias_forces(&q, &v).as_slice(), &bias, EXACT);
    let pitch = pressure * area * chord * -1.1 * 0.1;
    let forces = plane.generalized_forces(&q, &v, &Vector1::new(0.1));
    assert_close("forces", forces.as_slice(), &[0.0, 0.0, 0.0, 0.0, pitch, 0.0], EXACT);
}

#[mechanism(urdf = "../models/urdf/panda.urdf")]
pub struct PandaWithTool {
    pub tool_mass: f64,
    pub stiffness: f64,

    #[particle(mass = tool_mass, at = panda_link8.at(0.1 * z))]
    tool: Particle,
    #[acts(on = panda_joint4, stiffness = stiffness)]
    balancer: Spring,
}

#[test]
fn panda_with_tool() {
    let (tool_mass, stiffness) = (0.7, 30.0);
    let (arm, held) = (PandaMimic, PandaWithTool { tool_mass, stiffness });
    let mut random = Random::new(7);
    let (q, v) = (random.configuration(&arm), random.vector(1.0));
    let tool = frame!(PandaWithTool, "tool");
    let jacobian = held.frame_jacobian(tool, &q);
    let linear = jacobian.fixed_rows::<3>(0).into_owned();
    let height = held.frame_placement(tool, &q).translation.z;
    let mass = arm.mass_matrix(&q) + linear.transpose() * linear * tool_mass;
    assert_close("mass matrix", held.mass_matrix(&q).as_slice(), mass.as_slice(), EXACT);
    let energy = arm.potential_energy(&q) + tool_mass * 9.81 * height + stiffness * q[3] * q[3] / 2.0;
    assert_close("potential energy", &[held.potential_energy(&q)], &[energy], EXACT);
    let moving = held.frame_velocity(tool, &q, &v);
    let kinetic = arm.kinetic_energy(&q, &v) + tool_mass / 2.0 * moving.fixed_rows::<3>(0).norm_squared();
    assert_close("kinetic energy", &[held.kinetic_energy(&q, &v)], &[kinetic], EXACT);
    assert_close("mass", &[held.total_mass()], &[arm.total_mass() + tool_mass], EXACT);
}

// ---- Particles in coordinates of one's own -----------------------------------------------------------------------

#[mechanism(gravity = -g * y)]
struct ElasticPendulum {
    g: f64,
    m: f64,
    k: f64,
    l: f64,
    theta: Coordinate,
    reach: Coordinate,
    #[particle(mass = m, at = reach * (sin(theta) * x - cos(theta) * y))]
    bob: Particle,
    #[acts(between = (ground, bob), stiffness = k, free_length = l)]
    spring: Spring,
}

/// `r̈ = r θ̇² + g cos θ − (k / m) (r − l)`, `θ̈ = −(g sin θ + 2 ṙ θ̇) / r`.
#[test]
fn elastic_pendulum() {
    let (g, m, k, l) = (9.81, 0.8, 60.0, 0.7);
    let pendulum = ElasticPendulum { g, m, k, l };
    let (q, v) = (Vector2::new(0.5, 0.9), Vector2::new(1.2, -0.4));
    let acceleration = pendulum.forward_dynamics(&q, &v, &Vector2::zeros());
    let expected = [
        -(g * q[0].sin() + 2.0 * v[1] * v[0]) / q[1],
        q[1] * v[0] * v[0] + g * q[0].cos() - k / m * (q[1] - l),
    ];
    assert_close("acceleration", acceleration.as_slice(), &expected, EXACT);
}

#[mechanism(gravity = -g * y)]
struct BeadOnParabola {
    g: f64,
    m: f64,
    p: f64,
    s: Coordinate,
    #[particle(mass = m, at = s * x + s * s / (2 * p) * y)]
    bead: Particle,
}

#[mechanism(gravity = -g * z)]
struct BeadOnHelix {
    g: f64,
    m: f64,
    radius: f64,
    rise: f64,
    turn: Coordinate,
    #[particle(mass = m, at = radius * (cos(turn) * x + sin(turn) * y) + rise * turn * z)]
    bead: Particle,
}

#[test]
fn beads_on_wires() {
    let (g, m, p) = (9.81, 0.4, 0.6);
    let wire = BeadOnParabola { g, m, p };
    let (s, v) = (0.7, 1.3);
    let (at, moving) = (Vector1::new(s), Vector1::new(v));
    assert_close("mass", wire.mass_matrix(&at).as_slice(), &[m * (1.0 + s * s / (p * p))], EXACT);
    let bias = m * s * v * v / (p * p) + m * g * s / p;
    assert_close("bias", wire.bias_forces(&at, &moving).as_slice(), &[bias], EXACT);

    let (radius, rise) = (0.3, 0.2);
    let spring = BeadOnHelix { g, m, radius, rise };
    let inertia = m * (radius * radius + rise * rise);
    assert_close("mass", spring.mass_matrix(&at).as_slice(), &[inertia], EXACT);
    assert_close("bias", spring.bias_forces(&at, &moving).as_slice(), &[m * g * rise], EXACT);
}

#[mechanism(gravity = -9.81 * z)]
struct SphericalByUniversal {
    #[body]
    rod: Body,
    #[particle(mass = 0.5, at = rod.at(-0.8 * z))]
    bob: Particle,
    #[joint(ground -> rod, about = (x, y))]
    gimbal: Universal,
    #[output(r(bob / ground))]
    place: Vector,
}

#[mechanism(gravity = -9.81 * z)]
struct SphericalByAngles {
    theta: Coordinate,
    phi: Coordinate,
    #[particle(mass = 0.5, at = 0.8 * (sin(theta) * cos(phi) * x + sin(theta) * sin(phi) * y - cos(theta) * z))]
    bob: Particle,
    #[output(r(bob / ground))]
    place: Vector,
}

#[test]
fn spherical_pendulum_in_two_charts() {
    let (one, other) = (SphericalByUniversal {}, SphericalByAngles {});
    let (q, v) = (Vector2::new(0.7, 0.4), Vector2::new(-0.5, 1.1));
    let (place, moving) = (one.place(&q), one.place_jacobian(&q) * v);
    let angles = Vector2::new((-place.z / 0.8).acos(), place.y.atan2(place.x));
    let jacobian = other.place_jacobian(&angles);
    let rates = Vector2::from_fn(|k, _| jacobian.column(k).dot(&moving) / jacobian.column(k).norm_squared());
    assert_close("velocity", (jacobian * rates).as_slice(), moving.as_slice(), EXACT);
    let energy = |t: f64, u: f64| t + u;
    assert_close(
        "energy",
        &[energy(one.kinetic_energy(&q, &v), one.potential_energy(&q))],
        &[energy(other.kinetic_energy(&angles, &rates), other.potential_energy(&angles))],
        EXACT,
    );
    let (end, _) = advance(&one, &q, &v, 5.0);
    let (end_angles, _) = advance(&other, &angles, &rates, 5.0);
    assert_close("place", one.place(&end).as_slice(), other.place(&end_angles).as_slice(), MOTION);
}

/// In angles from the vertical, the lower particle placed from the upper one.
#[mechanism(gravity = -9.81 * y)]
struct TwoParticles {
    first: Coordinate,
    second: Coordinate,
    #[particle(mass = 1, at = sin(first) * x - cos(first) * y)]
    upper: Particle,
    #[particle(mass = 1, at = upper.at(sin(second) * x - cos(second) * y))]
    lower: Particle,
}

#[mechanism(gravity = -9.81 * y)]
struct TwoPins {
    #[body]
    upper_rod: Body,
    #[body]
    lower_rod: Body,
    #[particle(mass = 1, at = upper_rod.at(-1 * y))]
    upper: Particle,
    #[particle(mass = 1, at = lower_rod.at(-1 * y))]
    lower: Particle,
    #[joint(ground -> upper_rod, about = z)]
    shoulder: Pin,
    #[joint(upper_rod.at(-1 * y) -> lower_rod, about = z)]
    elbow: Pin,
}

#[test]
fn double_pendulum_in_absolute_and_relative_angles() {
    let (absolute, relative) = (TwoParticles {}, TwoPins {});
    let to_relative = |a: &Vector2<f64>| Vector2::new(a[0], a[1] - a[0]);
    let (q, v) = (Vector2::new(0.8, -0.5), Vector2::new(0.3, 1.7));
    let (p, w) = (to_relative(&q), to_relative(&v));
    let energies = [absolute.kinetic_energy(&q, &v), absolute.potential_energy(&q)];
    assert_close(
        "energies",
        &energies,
        &[relative.kinetic_energy(&p, &w), relative.potential_energy(&p)],
        EXACT,
    );
    let (end, rates) = advance(&absolute, &q, &v, 3.0);
    let (end_relative, rates_relative) = advance(&relative, &p, &w, 3.0);
    assert_close("angles", to_relative(&end).as_slice(), end_relative.as_slice(), MOTION);
    assert_close("rates", to_relative(&rates).as_slice(), rates_relative.as_slice(), MOTION);

    let rows = Record::load("problems/pendulums.json").rows::<5>("double");
    let [_, a1, a2, r1, r2] = rows[0];
    let [t, expected @ ..] = rows[1];
    let (q, v) = advance(&absolute, &Vector2::new(a1, a2), &Vector2::new(r1, r2), t);
    assert_close("reference", &[q[0], q[1], v[0], v[1]], &expected, 1e-11);
}

// ---- Driven in time ----------------------------------------------------------------------------------------------

/// Landau and Lifshitz, *Mechanics*, §§ 5 and 30: `m l² θ̈ + m l (g + ÿ) sin θ = 0`; the upper equilibrium is stable if
/// `a² γ² > 2 g l`.
#[test]
fn kapitza_pendulum() {
    let (g, m, l, amplitude, speed) = (9.81, 0.3, 0.5, 0.04, 160.0);
    let pendulum = KapitzaPendulum { g, mass: m, length: l, amplitude, frequency: speed };
    let (q, v) = (Vector1::new(0.9_f64), Vector1::new(2.0));
    for t in [0.0, 0.013, 0.05] {
        let pivot = -amplitude * speed * speed * (speed * t).cos();
        let bias = m * l * (g + pivot) * q[0].sin();
        assert_close("mass", pendulum.mass_matrix(t, &q).as_slice(), &[m * l * l], EXACT);
        assert_close("bias", pendulum.bias_forces(t, &q, &v).as_slice(), &[bias], EXACT);
        let point = pendulum.frame_placement(frame!(KapitzaPendulum, "pivot"), t, &q).translation.vector;
        assert_close("pivot", point.as_slice(), &[0.0, amplitude * (speed * t).cos(), 0.0], EXACT);
    }
    let swings = simulate(&pendulum).from([PI - 0.2], [0.0]).duration(2.0).sample_every(0.01);
    for sample in swings {
        let sample = sample.expect("the integrator arrives");
        assert!((sample.q[0] - PI).abs() < 0.4, "the pendulum stays up: {} at {} s", sample.q[0], sample.t);
    }
    let still = KapitzaPendulum { amplitude: 0.0, ..pendulum };
    let end = simulate(&still).from([PI - 0.2], [0.0]).until(|_, q, _| q[0]).duration(2.0).finish();
    assert!(end.expect("the integrator arrives").t < 2.0, "without it the pendulum falls");
}

#[mechanism(gravity = -g * y)]
struct PendulumOnCrank {
    g: f64,
    m: f64,
    l: f64,
    radius: f64,
    speed: f64,
    #[frame(ground, z(speed * t))]
    crank: Frame,
    #[point(at = radius * crank.x)]
    pivot: Point,
    #[body]
    rod: Body,
    #[particle(mass = m, at = rod.at(-l * y))]
    bob: Particle,
    #[joint(pivot -> rod, about = z)]
    pin: Pin,
}

/// Landau and Lifshitz, *Mechanics*, § 5, problem 3 a. The pivot has the axes of the ground from which it is placed, so
/// the angle is that from the vertical although the crank turns.
#[test]
fn pendulum_on_crank() {
    let (g, m, l, radius, speed) = (9.81, 0.3, 0.5, 0.2, 3.0);
    let crank = PendulumOnCrank { g, m, l, radius, speed };
    let (q, v) = (Vector1::new(0.9_f64), Vector1::new(2.0));
    for t in [0.0, 0.4, 1.3] {
        let bias = m * l * (g * q[0].sin() - radius * speed * speed * (q[0] - speed * t).cos());
        assert_close("mass", crank.mass_matrix(t, &q).as_slice(), &[m * l * l], EXACT);
        assert_close("bias", crank.bias_forces(t, &q, &v).as_slice(), &[bias], EXACT);
        let (sin, cos) = (speed * t).sin_cos();
        let velocity = Vector2::new(
            -radius * speed * sin + l * v[0] * q[0].cos(),
            radius * speed * cos + l * v[0] * q[0].sin(),
        );
        assert_close(
            "energy",
            &[crank.kinetic_energy(t, &q, &v)],
            &[m / 2.0 * velocity.norm_squared()],
            EXACT,
        );
    }
}

#[mechanism]
struct Turntable {
    m: f64,
    k: f64,
    spin: f64,
    east: Coordinate,
    north: Coordinate,
    #[frame(ground, z(spin * t))]
    table: Frame,
    #[particle(mass = m, at = east * table.x + north * table.y)]
    bob: Particle,
    #[acts(between = (ground, bob), stiffness = k)]
    spring: Spring,
    #[output(v(bob / ground / table), resolved_in = table)]
    seen: Vector,
    #[output(a(bob / ground / table), resolved_in = table)]
    seen_acceleration: Vector,
    #[output(a(bob / ground / ground), resolved_in = table)]
    acceleration: Vector,
    #[output(v(bob / ground / ground), resolved_in = table)]
    velocity: Vector,
}

/// In the rotating frame Coriolis and centrifugal forces appear; seen from the ground the plane of the oscillation stays,
/// as Foucault's does.
#[test]
fn foucault_pendulum_at_the_pole() {
    let (m, k, spin) = (1.4, 20.0, 0.7);
    let table = Turntable { m, k, spin };
    let (t, q, v) = (0.6, Vector2::new(0.4, -0.3), Vector2::new(1.1, 0.5));
    let a = Vector2::new(-0.8, 2.0);
    let up = Vector3::z() * spin;
    let three = |v: &Vector2<f64>| Vector3::new(v[0], v[1], 0.0);
    assert_close("v seen", table.seen(t, &q, &v).as_slice(), three(&v).as_slice(), EXACT);
    let seen = table.seen_acceleration(t, &q, &v, &a);
    assert_close("a seen", seen.as_slice(), three(&a).as_slice(), EXACT);
    let whole = three(&a) + up.cross(&three(&v)) * 2.0 + up.cross(&up.cross(&three(&q)));
    assert_close("a", table.acceleration(t, &q, &v, &a).as_slice(), whole.as_slice(), EXACT);
    let velocity = three(&v) + up.cross(&three(&q));
    assert_close("v", table.velocity(t, &q, &v).as_slice(), velocity.as_slice(), EXACT);
    let bias = (up.cross(&three(&v)) * 2.0 + up.cross(&up.cross(&three(&q)))) * m + three(&q) * k;
    assert_close("bias", table.bias_forces(t, &q, &v).as_slice(), &[bias.x, bias.y], EXACT);

    // Released at rest relative to the ground, it goes on swinging along one line there.
    let (q0, v0) = (Vector2::new(0.5, 0.0), Vector2::new(0.0, -spin * 0.5));
    let end = 7.0;
    let (q, _) = advance(&table, &q0, &v0, end);
    let swing = 0.5 * ((k / m).sqrt() * end).cos();
    let (sin, cos) = (spin * end).sin_cos();
    assert_close("plane", q.as_slice(), &[swing * cos, -swing * sin], MOTION);
}

#[mechanism]
struct ForcedOscillator {
    m: f64,
    k: f64,
    f: f64,
    speed: f64,
    #[body(mass = m)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = rail, stiffness = k)]
    spring: Spring,
    #[acts(on = rail, value = f * cos(speed * t))]
    drive: Force,
}

#[test]
fn forced_oscillator() {
    let (m, k, f, speed) = (2.0, 18.0, 3.0, 2.0);
    let cart = ForcedOscillator { m, k, f, speed };
    let amplitude = f / (k - m * speed * speed);
    let (q, v) = advance(&cart, &Vector1::new(amplitude), &Vector1::zeros(), 4.0);
    let expected = [amplitude * (speed * 4.0).cos(), -amplitude * speed * (speed * 4.0).sin()];
    assert_close("steady state", &[q[0], v[0]], &expected, MOTION);
    // A run may start at any time.
    let (later, _) = advance_from(
        &cart,
        1.5,
        &Vector1::new(amplitude * (speed * 1.5).cos()),
        &Vector1::new(-amplitude * speed * (speed * 1.5).sin()),
        2.5,
    );
    assert_close("from another time", &[later[0]], &expected[..1], MOTION);
}

// ---- Elements ----------------------------------------------------------------------------------------------------

#[mechanism]
struct MassInerter {
    #[body(mass = 2)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = rail, stiffness = 50)]
    spring: Spring,
    #[acts(on = rail, damping = 3)]
    damper: Dashpot,
    #[acts(on = rail, inertance = 0.5)]
    inerter: Inerter,
}

#[test]
fn mass_with_inerter() {
    let (q, _) = advance(&MassInerter {}, &Vector1::new(1.0), &Vector1::zeros(), 1.0);
    assert_close("displacement", q.as_slice(), &[-0.2234232688843427], 1e-12);
}

/// Writes the same two bodies with another law for the springs: between two of their points, on a length, on an angle.
macro_rules! duffing {
    ($name:ident: [$($law:tt)*], [$($turning:tt)*]) => {
        #[mechanism(gravity = -9.81 * y)]
        struct $name {
            k: f64,
            c: f64,
            stiff: f64,
            hard: f64,
            #[body(mass = 1.2, com = 0.1 * x, inertia = diagonal(0.1, 0.2, 0.3))]
            arm: Body,
            #[body(mass = 0.7)]
            slider: Body,
            #[joint(ground -> arm, about = z)]
            pin: Pin,
            #[joint(ground.at(0.2 * y) -> slider, along = x)]
            rail: Sleeve,
            #[acts(between = (arm.at(0.5 * x), slider), free_length = 0.3, $($law)*)]
            across: Spring,
            #[acts(on = rail, free_length = 0.1, $($law)*)]
            stop: Spring,
            #[acts(on = pin, free_angle = 0.2, $($turning)*)]
            twist: Spring,
        }
    };
}
duffing!(
    DuffingByForce:
    [force = k * stretch + c * pow(stretch, 3)],
    [force = stiff * stretch + hard * pow(stretch, 3)]
);
duffing!(
    DuffingByEnergy:
    [energy = k / 2 * pow(stretch, 2) + c / 4 * pow(stretch, 4)],
    [energy = stiff / 2 * pow(stretch, 2) + hard / 4 * pow(stretch, 4)]
);

#[mechanism]
struct LinearByForce {
    k: f64,
    #[body(mass = 0.7)]
    slider: Body,
    #[joint(ground.at(0.2 * y) -> slider, along = x)]
    rail: Sleeve,
    #[acts(between = (ground, slider), force = k * stretch, free_length = 0.3)]
    across: Spring,
    #[acts(on = rail, force = k * stretch, free_length = 0.1)]
    stop: Spring,
}

#[mechanism]
struct LinearByStiffness {
    k: f64,
    #[body(mass = 0.7)]
    slider: Body,
    #[joint(ground.at(0.2 * y) -> slider, along = x)]
    rail: Sleeve,
    #[acts(between = (ground, slider), stiffness = k, free_length = 0.3)]
    across: Spring,
    #[acts(on = rail, stiffness = k, free_length = 0.1)]
    stop: Spring,
}

#[test]
fn springs_by_force_and_by_energy() {
    let (k, c, stiff, hard) = (20.0, 300.0, 5.0, 2.0);
    let (force, energy) = (DuffingByForce { k, c, stiff, hard }, DuffingByEnergy { k, c, stiff, hard });
    assert_same_dynamics(&force, &energy, 4, 1e-12);
    assert_same_dynamics(&LinearByForce { k }, &LinearByStiffness { k }, 4, 1e-12);
}

/// A cart between buffers that begin to act at a distance.
#[mechanism]
struct Buffers {
    k: f64,
    gap: f64,
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = rail, energy = k / 2 * pow(max(stretch - gap, 0), 2))]
    right: Spring,
    #[acts(on = rail, energy = k / 2 * pow(min(stretch + gap, 0), 2))]
    left: Spring,
}

#[test]
fn stops() {
    let (k, gap) = (1000.0, 0.5);
    let cart = Buffers { k, gap };
    let force = |x: f64| cart.bias_forces(&Vector1::new(x), &Vector1::zeros())[0];
    let cases = [(0.3, 0.0), (-0.4, 0.0), (0.5, 0.0), (-0.5, 0.0), (0.7, 200.0), (-0.6, -100.0)];
    for (x, expected) in cases {
        assert_close(format!("at {x}"), &[force(x)], &[expected], 1e-12);
    }
    // Across and back, half an oscillation in each buffer.
    let period = 4.0 * gap / 2.0 + 2.0 * PI / k.sqrt();
    let (q, v) = advance(&cart, &Vector1::zeros(), &Vector1::new(2.0), period);
    assert_close("after a period", &[q[0], v[0]], &[0.0, 2.0], 1e-9);
}

#[mechanism]
struct SlidingBlock {
    m: f64,
    f: f64,
    #[body(mass = m)]
    block: Body,
    #[joint(ground -> block, along = x)]
    floor: Sleeve,
    #[acts(on = floor, coulomb = f, speed = 1e-4)]
    friction: Friction,
}

#[mechanism]
struct StickingBlock {
    #[body(mass = 1)]
    block: Body,
    #[joint(ground -> block, along = x)]
    floor: Sleeve,
    #[acts(on = floor, coulomb = 2, stiction = 3, stribeck_speed = 0.1, viscous = 0.7, speed = 0.01)]
    friction: Friction,
}

#[test]
fn friction() {
    let (m, f) = (2.0, 3.0);
    let block = SlidingBlock { m, f };
    let (q, v) = advance(&block, &Vector1::zeros(), &Vector1::new(4.0), 2.0);
    assert_close("sliding", &[q[0], v[0]], &[8.0 - f / m * 2.0, 4.0 - f / m * 2.0], MOTION);
    let end = simulate(&block).from([0.0], [4.0]).duration(4.0).finish().expect("the integrator arrives");
    assert_close("stopped", &[end.q[0]], &[16.0 * m / (2.0 * f)], 1e-6);

    for v in [-0.5, -0.05, 0.0, 0.001, 0.2, 3.0_f64] {
        let force = (2.0 + (-(v / 0.1).powi(2)).exp()) * (v / 0.01).tanh() + 0.7 * v;
        let actual = StickingBlock {}.bias_forces(&Vector1::zeros(), &Vector1::new(v));
        assert_close(format!("at {v} m/s"), actual.as_slice(), &[force], EXACT);
    }
}

#[mechanism(gravity = -9.81 * y)]
struct DraggedProjectile {
    m: f64,
    c: f64,
    #[particle(mass = m)]
    ball: Particle,
    #[joint(ground -> ball, along = (x, y))]
    flight: Stage,
    #[define(v(ball / ground / ground))]
    velocity: Vector,
    #[dissipation(c / 2 * dot(velocity, velocity))]
    drag: Rayleigh,
}

#[test]
fn projectile_with_linear_drag() {
    let (m, c, t) = (0.4, 0.3, 1.7);
    let ball = DraggedProjectile { m, c };
    let (q, v) = advance(&ball, &Vector2::zeros(), &Vector2::new(7.0, 9.0), t);
    let (time, terminal) = (m / c, 9.81 * m / c);
    let decay = (-t / time).exp();
    let expected = [
        7.0 * time * (1.0 - decay),
        (9.0 + terminal) * time * (1.0 - decay) - terminal * t,
        7.0 * decay,
        (9.0 + terminal) * decay - terminal,
    ];
    assert_close("flight", &[q[0], q[1], v[0], v[1]], &expected, MOTION);
}

/// A pendulum whose weight is a potential, and a spring written as one.
#[mechanism]
struct PendulumByPotential {
    m: f64,
    g: f64,
    k: f64,
    #[body(inertia = diagonal(0.1, 0.1, 0.1))]
    rod: Body,
    #[particle(mass = m, at = rod.at(-0.6 * y))]
    bob: Particle,
    #[joint(ground -> rod, about = z)]
    pin: Pin,
    #[energy(m * g * dot(r(bob / ground), y) + k / 2 * pow(pin - 0.3, 2))]
    weight: Potential,
}

#[mechanism(gravity = -g * y)]
struct PendulumByGravity {
    m: f64,
    g: f64,
    k: f64,
    #[body(inertia = diagonal(0.1, 0.1, 0.1))]
    rod: Body,
    #[particle(mass = m, at = rod.at(-0.6 * y))]
    bob: Particle,
    #[joint(ground -> rod, about = z)]
    pin: Pin,
    #[acts(on = pin, stiffness = k, free_angle = 0.3)]
    spring: Spring,
}

#[test]
fn potential() {
    let (m, g, k) = (0.8, 9.81, 4.0);
    assert_same_dynamics(&PendulumByPotential { m, g, k }, &PendulumByGravity { m, g, k }, 4, 1e-13);
}

/// Charges of one sign in a magnetic field.
#[mechanism]
struct Charges {
    field: f64,
    charge: f64,
    #[particle(mass = 0.5)]
    first: Particle,
    #[particle(mass = 0.7)]
    second: Particle,
    #[joint(ground -> first, along = (x, y, z))]
    one: Stage,
    #[joint(ground -> second, along = (x, y, z))]
    other: Stage,
    #[acts(between = (first, second), strength = -charge * charge)]
    repulsion: Attraction,
    #[acts(on = first, value = charge * cross(v(first / ground / ground), field * z))]
    magnetic: Force,
}

#[test]
fn charged_particles() {
    let charges = Charges { field: 2.0, charge: 0.3 };
    let q = Vector6::new(0.1_f64, 0.2, 0.3, 1.1, -0.6, 0.9);
    let v = Vector6::new(1.0, 2.0, 3.0, 0.0, 0.0, 0.0);
    let apart = q.fixed_rows::<3>(0) - q.fixed_rows::<3>(3);
    let repulsion = apart * (0.09 / apart.norm().powi(3));
    let magnetic = Vector3::new(1.0, 2.0, 3.0).cross(&Vector3::new(0.0, 0.0, 2.0)) * 0.3;
    let a = charges.forward_dynamics(&q, &v, &Vector6::zeros());
    assert_close("first", a.fixed_rows::<3>(0).as_slice(), ((repulsion + magnetic) / 0.5).as_slice(), EXACT);
    assert_close("second", a.fixed_rows::<3>(3).as_slice(), (-repulsion / 0.7).as_slice(), EXACT);
    assert_close("energy", &[charges.potential_energy(&q)], &[0.09 / apart.norm()], EXACT);

    // Without charge on the other, a circle with the cyclotron's period: 2 π m / (q B).
    let start = Vector6::new(0.0, 0.0, 0.0, 1e8, 0.0, 0.0);
    let turning = Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let (q, v) = advance(&charges, &start, &turning, 2.0 * PI * 0.5 / 0.6);
    assert_close("circle", &[q[0], q[1], v[0], v[1]], &[0.0, 0.0, 1.0, 0.0], 1e-9);
}

// ---- Central gravity ---------------------------------------------------------------------------------------------

#[mechanism]
struct Kepler {
    #[particle(mass = 2)]
    planet: Particle,
    #[joint(ground -> planet, along = (x, y))]
    path: Stage,
    #[acts(between = (ground, planet), mu = 1)]
    sun: Gravity,
}

#[mechanism]
struct KeplerPolar {
    reach: Coordinate,
    anomaly: Coordinate,
    #[frame(ground, z(anomaly))]
    radial: Frame,
    #[particle(mass = 2, at = reach * radial.x)]
    planet: Particle,
    #[acts(between = (ground, planet), mu = 1)]
    sun: Gravity,
}

#[test]
fn kepler_orbit() {
    let rows = Record::load("problems/kepler.json").rows::<5>("trajectory");
    let [_, x, y, vx, vy] = rows[0];
    for [t, x1, y1, vx1, vy1] in &rows[1..] {
        let (q, v) = advance(&Kepler {}, &Vector2::new(x, y), &Vector2::new(vx, vy), *t);
        assert_close(format!("at {t}"), &[q[0], q[1], v[0], v[1]], &[*x1, *y1, *vx1, *vy1], 1e-9);
        let (q, v) = advance(&KeplerPolar {}, &Vector2::new(x, 0.0), &Vector2::new(0.0, vy / x), *t);
        let (sin, cos) = q[1].sin_cos();
        let polar = [q[0] * cos, q[0] * sin, v[0] * cos - q[0] * v[1] * sin, v[0] * sin + q[0] * v[1] * cos];
        assert_close(format!("polar at {t}"), &polar, &[*x1, *y1, *vx1, *vy1], 1e-9);
    }
}

/// Period `2 π √(a³ / (G (m₁ + m₂)))` of the relative motion, whatever the centre of mass does.
#[test]
fn two_bodies() {
    let (constant, m1, m2) = (0.8, 3.0, 1.2);
    let bodies = TwoBodies { constant, m1, m2 };
    let total = constant * (m1 + m2);
    let speed = Vector3::new(0.2, 1.3, -0.4_f64);
    let apart = Vector3::new(1.1, 0.1, 0.3_f64);
    let axis = 1.0 / (2.0 / apart.norm() - speed.norm_squared() / total);
    let period = 2.0 * PI * (axis.powi(3) / total).sqrt();
    let drift = Vector3::new(0.3, -0.2, 0.1);
    let q = Vector6::from_iterator([0.0; 3].into_iter().chain(apart.iter().copied()));
    let second = drift + speed;
    let v = Vector6::from_iterator(drift.iter().chain(second.iter()).copied());
    let (q, v) = advance(&bodies, &q, &v, period);
    assert_close(
        "distance",
        (q.fixed_rows::<3>(3) - q.fixed_rows::<3>(0)).as_slice(),
        apart.as_slice(),
        1e-9,
    );
    assert_close("speed", (v.fixed_rows::<3>(3) - v.fixed_rows::<3>(0)).as_slice(), speed.as_slice(), 1e-9);
}

/// The particles and the pairs of them that attract each other.
macro_rules! attracting {
    ($name:ident: $($x:ident $y:ident $body:ident $mass:literal,)* ; $($pair:ident $a:ident $b:ident,)*) => {
        #[mechanism]
        struct $name {
            $($x: Coordinate,)*
            $($y: Coordinate,)*
            $(#[particle(mass = $mass, at = $x * x + $y * y)] $body: Particle,)*
            $(#[acts(between = ($a, $b), constant = 1)] $pair: Gravity,)*
        }
    };
}
attracting! {
    Pleiades:
    x1 y1 p1 1, x2 y2 p2 2, x3 y3 p3 3, x4 y4 p4 4, x5 y5 p5 5, x6 y6 p6 6, x7 y7 p7 7,;
    g12 p1 p2, g13 p1 p3, g14 p1 p4, g15 p1 p5, g16 p1 p6, g17 p1 p7,
    g23 p2 p3, g24 p2 p4, g25 p2 p5, g26 p2 p6, g27 p2 p7,
    g34 p3 p4, g35 p3 p5, g36 p3 p6, g37 p3 p7,
    g45 p4 p5, g46 p4 p6, g47 p4 p7,
    g56 p5 p6, g57 p5 p7,
    g67 p6 p7,
}

#[test]
fn pleiades() {
    let rows = Record::load("problems/pleiades.json").rows::<29>("trajectory");
    let (mut q, mut v) =
        (SVector::<f64, 14>::from_row_slice(&rows[0][1..15]), SVector::from_row_slice(&rows[0][15..]));
    for pair in rows.windows(2) {
        (q, v) = advance(&Pleiades {}, &q, &v, pair[1][0] - pair[0][0]);
        assert_close(format!("places at {}", pair[1][0]), q.as_slice(), &pair[1][1..15], 1e-8);
        assert_close(format!("rates at {}", pair[1][0]), v.as_slice(), &pair[1][15..], 1e-8);
    }
}

/// Pitch of a satellite on a circular orbit, about the normal of the orbit.
#[mechanism]
struct Satellite {
    n: f64,
    radius: f64,
    a: f64,
    b: f64,
    c: f64,
    #[frame(ground, z(n * t))]
    orbit: Frame,
    #[point(at = radius * orbit.x)]
    place: Point,
    #[body(mass = 1, inertia = diagonal(a, b, c))]
    satellite: Body,
    #[joint(place -> satellite, about = z)]
    attitude: Pin,
    #[acts(between = (ground, satellite), mu = n * n * pow(radius, 3))]
    earth: Gravity,
}

/// Torque `−(3/2) n² (B − A) sin 2θ` with the pitch θ from the local vertical, and so small librations with
/// `3 n² (B − A) / C` (Hughes, *Spacecraft Attitude Dynamics*, ch. 9).
#[test]
fn gravity_gradient_libration() {
    let (n, radius, a, b, c) = (0.9, 50.0, 1.0, 1.7, 2.2);
    let satellite = Satellite { n, radius, a, b, c };
    for (t, pitch) in [(0.0, 0.3), (0.7, -0.8), (2.0, 1e-4)] {
        let q = Vector1::new(n * t + pitch);
        let torque = 1.5 * n * n * (b - a) * (2.0 * pitch).sin();
        assert_close("mass", satellite.mass_matrix(t, &q).as_slice(), &[c], EXACT);
        assert_close("bias", satellite.bias_forces(t, &q, &Vector1::new(0.4)).as_slice(), &[torque], 1e-11);
    }
    let small = 1e-5;
    let libration = (3.0 * n * n * (b - a) / c).sqrt();
    let end = 2.3;
    let (q, _) = advance(&satellite, &Vector1::new(small), &Vector1::new(n), end);
    assert_close("libration", &[(q[0] - n * end) / small], &[(libration * end).cos()], 1e-6);
}

/// The potential of MacCullagh's formula, with the body anywhere and turned anyhow.
#[mechanism]
struct FreeSatellite {
    #[body(mass = 2, inertia = [[0.5, 0.02, -0.01], [0.02, 0.7, 0.03], [-0.01, 0.03, 0.9]])]
    satellite: Body,
    #[joint(ground -> satellite)]
    flight: Free,
    #[acts(between = (ground, satellite), mu = 3)]
    earth: Gravity,
}

/// The same body and a planet that is free too: each feels the other, and the planet is a sphere.
#[mechanism]
struct PlanetAndSatellite {
    #[body(mass = 1.5, inertia = sphere(1.5, 0.3))]
    planet: Body,
    #[body(mass = 2, inertia = [[0.5, 0.02, -0.01], [0.02, 0.7, 0.03], [-0.01, 0.03, 0.9]])]
    satellite: Body,
    #[joint(ground -> planet, along = (x, y, z))]
    drift: Stage,
    #[joint(ground -> satellite)]
    flight: Free,
    #[acts(between = (planet, satellite), constant = 2)]
    mutual: Gravity,
}

/// A sphere's inertia has no gradient, so the potential is that of the satellite near a centre with `mu = G M`.
#[test]
fn gravity_gradient_between_bodies() {
    let (both, alone) = (PlanetAndSatellite {}, FreeSatellite {});
    let mut random = Random::new(6);
    let q = random.configuration(&both);
    let mut seen = alone.neutral();
    seen.copy_from(&q.fixed_rows::<7>(3));
    for k in 0..3 {
        seen[k] -= q[k];
    }
    assert_close("potential", &[both.potential_energy(&q)], &[alone.potential_energy(&seen)], EXACT);
    let bias = both.bias_forces(&q, &SVector::zeros());
    let expected = alone.bias_forces(&seen, &Vector6::zeros());
    assert_close("forces", bias.fixed_rows::<6>(3).as_slice(), expected.as_slice(), EXACT);
}

#[test]
fn gravity_gradient_of_a_free_body() {
    let body = FreeSatellite {};
    let mut random = Random::new(5);
    let q = random.configuration(&body);
    let pose = body.frame_placement(frame!(FreeSatellite, "satellite"), &q);
    let r = pose.rotation.inverse() * pose.translation.vector;
    let (d, n) = (r.norm(), r.normalize());
    let inertia = Matrix3::new(0.5, 0.02, -0.01, 0.02, 0.7, 0.03, -0.01, 0.03, 0.9);
    let potential =
        -3.0 * 2.0 / d - 3.0 * (inertia.trace() - 3.0 * n.dot(&(inertia * n))) / (2.0 * d.powi(3));
    assert_close("potential", &[body.potential_energy(&q)], &[potential], EXACT);
    let bias = body.bias_forces(&q, &Vector6::zeros());
    let torque = n.cross(&(inertia * n)) * (3.0 * 3.0 / d.powi(3));
    assert_close("torque", (-bias.fixed_rows::<3>(3)).as_slice(), torque.as_slice(), EXACT);
}

// ---- Where points meet -------------------------------------------------------------------------------------------

/// Springs and dashpots to a point that the particle can reach.
#[mechanism]
struct Meeting {
    l: f64,
    #[particle(mass = 2)]
    ball: Particle,
    #[joint(ground -> ball, along = (x, y))]
    table: Stage,
    #[acts(between = (ground, ball), stiffness = 30, free_length = l)]
    spring: Spring,
    #[acts(between = (ground, ball), force = 4 * stretch + pow(stretch, 3), free_length = l)]
    hard: Spring,
    #[acts(between = (ground, ball), damping = 3)]
    damper: Dashpot,
    #[acts(between = (ground, ball), inertance = 0.5)]
    inerter: Inerter,
}

/// A distance of zero has no direction, and what acts along it does nothing there; one with the free length zero has the
/// limit zero.
#[test]
fn points_that_coincide() {
    for l in [0.0, 0.3] {
        let meeting = Meeting { l };
        let origin = Vector2::zeros();
        let v = Vector2::new(1.0, 2.0);
        assert_close("bias", meeting.bias_forces(&origin, &v).as_slice(), &[0.0, 0.0], EXACT);
        assert_close("mass", meeting.mass_matrix(&origin).as_slice(), &[2.0, 0.0, 0.0, 2.0], EXACT);
        let energy = 15.0 * l * l + 2.0 * l * l + l.powi(4) / 4.0;
        assert_close("energy", &[meeting.potential_energy(&origin)], &[energy], EXACT);
        for small in [1e-12, 1e-6] {
            let (q, s) = (Vector2::new(small * 0.6, small * 0.8), small - l);
            let force = 34.0 * s + s.powi(3) + 3.0 * (0.6 * v[0] + 0.8 * v[1]);
            let bias = meeting.bias_forces(&q, &Vector2::zeros());
            let still = force - 3.0 * (0.6 * v[0] + 0.8 * v[1]);
            assert_close("near", bias.as_slice(), &[0.6 * still, 0.8 * still], 1e-9);
        }
    }
}

/// Gravity between particles at one place has no limit: the forces are not finite, and an integrator says so.
#[test]
fn particles_that_coincide() {
    let bodies = TwoBodies { constant: 1.0, m1: 1.0, m2: 1.0 };
    let q = Vector6::zeros();
    assert_eq!(bodies.potential_energy(&q), f64::NEG_INFINITY);
    assert!(bodies.bias_forces(&q, &Vector6::zeros()).iter().any(|f| !f.is_finite()));
    assert!(simulate(&bodies).from(q, Vector6::zeros()).duration(1.0).finish().is_err());
}

// ---- Orientations ------------------------------------------------------------------------------------------------

/// A body in a frame turned three times, with the names of the axes; checked against the table of sequences.
macro_rules! sequences {
    ($($name:ident $label:literal $one:ident $two:ident $three:ident,)*) => {
        $(
            #[mechanism]
            struct $name {
                first: Coordinate,
                second: Coordinate,
                third: Coordinate,
                #[frame(ground, $one(first), $two(second), $three(third))]
                turned: Frame,
                #[body(mass = 1, inertia = diagonal(1, 2, 2.5), frame = turned)]
                body: Body,
                #[output(omega(turned / ground), resolved_in = turned)]
                rate: Vector,
                #[output(alpha(body / ground / ground), resolved_in = turned)]
                acceleration: Vector,
                #[output(turned.x)]
                x_axis: Vector,
                #[output(turned.y)]
                y_axis: Vector,
                #[output(turned.z)]
                z_axis: Vector,
            }
        )*

        #[test]
        fn euler_angles() {
            let table = Record::load("problems/euler_sequences.json");
            let (q, v): (Vector3<f64>, Vector3<f64>) = (table.vector("angles"), table.vector("rates"));
            let records = table.records("sequences");
            $(
                let body = $name {};
                let record = records.iter().find(|r| r.string("name") == $label).expect("in the table");
                let matrix: SMatrix<f64, 3, 3> = record.matrix("matrix");
                let omega: Vector3<f64> = record.vector("omega");
                let axes = Matrix3::from_columns(&[body.x_axis(&q), body.y_axis(&q), body.z_axis(&q)]);
                assert_close(concat!("axes ", $label), axes.as_slice(), matrix.as_slice(), 1e-14);
                assert_close(concat!("rate ", $label), body.rate(&q, &v).as_slice(), omega.as_slice(), 1e-14);
                let inertia = Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 2.5));
                let energy = omega.dot(&(inertia * omega)) / 2.0;
                assert_close(concat!("energy ", $label), &[body.kinetic_energy(&q, &v)], &[energy], EXACT);
                // Euler's equations hold for the generalized forces: p = Jᵀ (I α + ω × I ω).
                let a = Vector3::new(0.7, -0.4, 0.2);
                let alpha = body.acceleration(&q, &v, &a);
                let moment = inertia * alpha + omega.cross(&(inertia * omega));
                let forces = body.rate_jacobian(&q, &v).transpose() * moment;
                let actual = body.inverse_dynamics(&q, &v, &a);
                assert_close(concat!("forces ", $label), actual.as_slice(), forces.as_slice(), EXACT);
            )*
            assert_eq!(records.len(), [$($label),*].len());
        }
    };
}
sequences! {
    FrameXyx "xyx" x y x,
    FrameXyz "xyz" x y z,
    FrameXzx "xzx" x z x,
    FrameXzy "xzy" x z y,
    FrameYxy "yxy" y x y,
    FrameYxz "yxz" y x z,
    FrameYzx "yzx" y z x,
    FrameYzy "yzy" y z y,
    FrameZxy "zxy" z x y,
    FrameZxz "zxz" z x z,
    FrameZyx "zyx" z y x,
    FrameZyz "zyz" z y z,
}

/// The heavy top in Euler's angles by a frame, with its tip fixed, against the same top on a ball joint.
#[mechanism(gravity = -9.81 * z)]
struct TopByFrame {
    psi: Coordinate,
    theta: Coordinate,
    phi: Coordinate,
    #[frame(ground, z(psi), x(theta), z(phi))]
    turned: Frame,
    #[body(mass = 0.6, com = 0.2 * z, inertia = diagonal(0.02, 0.02, 0.01), frame = turned)]
    top: Body,
    #[output(r(top.at(0.2 * z) / ground))]
    center: Vector,
    #[output(omega(top / ground), resolved_in = top)]
    rate: Vector,
}

#[mechanism(gravity = -9.81 * z)]
struct TopByBall {
    #[body(mass = 0.6, com = 0.2 * z, inertia = diagonal(0.02, 0.02, 0.01))]
    top: Body,
    #[joint(ground -> top)]
    tip: Ball,
    #[output(r(top.at(0.2 * z) / ground))]
    center: Vector,
}

#[test]
fn heavy_top_in_two_charts() {
    let (one, other) = (TopByFrame {}, TopByBall {});
    let (q, v) = (Vector3::new(0.2, 0.7, -0.1), Vector3::new(0.5, -0.3, 40.0));
    let turn = |axis, angle| linkwork::nalgebra::UnitQuaternion::from_axis_angle(&axis, angle);
    let pose = turn(Vector3::z_axis(), q[0]) * turn(Vector3::x_axis(), q[1]) * turn(Vector3::z_axis(), q[2]);
    let rate = one.rate(&q, &v);
    let energies = [one.kinetic_energy(&q, &v), one.potential_energy(&q)];
    let quaternion = SVector::from(pose.into_inner().coords);
    let expected = [other.kinetic_energy(&quaternion, &rate), other.potential_energy(&quaternion)];
    assert_close("energies", &energies, &expected, EXACT);
    let (end, _) = advance(&one, &q, &v, 1.0);
    let (end_of_other, _) = advance(&other, &quaternion, &rate, 1.0);
    assert_close("centre", one.center(&end).as_slice(), other.center(&end_of_other).as_slice(), MOTION);
}

// ---- Words for vectors -------------------------------------------------------------------------------------------

#[mechanism]
struct Words {
    #[body(mass = 1, inertia = diagonal(1, 1, 1))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    pin: Pin,
    #[define(2 * arm.x + 3 * z)]
    arrow: Vector,
    #[output(angle(x, arm.x))]
    apart: Scalar,
    #[output(angle(x, arm.x, z))]
    directed: Scalar,
    #[output(project(arrow, x + z))]
    shadow: Vector,
    #[output(norm(arrow))]
    size: Scalar,
    #[output(unit(arrow), resolved_in = arm)]
    direction: Vector,
    #[output(rate(pin) * pin + dot(cross(arm.x, arm.y), z))]
    mixed: Scalar,
    #[output(min(pin, 1) + max(pin, 1))]
    sum: Scalar,
}

#[test]
fn words_for_vectors() {
    let words = Words {};
    for angle in [-1.2, 0.4, FRAC_PI_2, 2.0_f64] {
        let (q, v) = (Vector1::new(angle), Vector1::new(0.7));
        assert_close("angle", &[words.apart(&q), words.directed(&q)], &[angle.abs(), angle], EXACT);
        let along = (2.0 * angle.cos() + 3.0) / 2.0;
        assert_close("project", words.shadow(&q).as_slice(), &[along, 0.0, along], EXACT);
        let size = 13.0_f64.sqrt();
        assert_close("norm", &[words.size(&q)], &[size], EXACT);
        assert_close("unit", words.direction(&q).as_slice(), &[2.0 / size, 0.0, 3.0 / size], EXACT);
        assert_close(
            "mixed",
            &[words.mixed(&q, &v), words.sum(&q)],
            &[0.7 * angle + 1.0, angle + 1.0],
            EXACT,
        );
        let slope = words.shadow_jacobian(&q);
        assert_close("Jacobian", slope.as_slice(), &[-angle.sin(), 0.0, -angle.sin()], EXACT);
    }
}

// ---- The power balance ---------------------------------------------------------------------------------------------

/// Something of every class: conservative, dissipative, control, disturbance, inertial.
#[mechanism(gravity = -9.81 * y)]
struct Workbench {
    wind: f64,
    #[body(mass = 2, com = 0.2 * x, inertia = rod(2, 0.4, x))]
    arm: Body,
    #[particle(mass = 0.5, at = arm.at(0.4 * x))]
    tip: Particle,
    #[body(mass = 1)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> arm, about = z)]
    hinge: Pin,
    #[acts(on = hinge, stiffness = 3, free_angle = 0.2)]
    coil: Spring,
    #[acts(between = (ground.at(y), tip), energy = 5 * pow(stretch, 4), free_length = 0.3)]
    band: Spring,
    #[acts(on = rail, damping = 0.7)]
    dashpot: Dashpot,
    #[acts(between = (ground.at(y), tip), force = 0.3 * speed + 0.1 * pow(speed, 3))]
    damper: Dashpot,
    #[acts(on = hinge, coulomb = 0.2, stiction = 0.3, stribeck_speed = 0.5, viscous = 0.1, speed = 0.2)]
    dry: Friction,
    #[dissipation(0.05 * rate(hinge) * rate(hinge))]
    oil: Rayleigh,
    #[acts(between = (ground.at(-x), tip), inertance = 0.4)]
    inerter: Inerter,
    #[acts(on = tip, value = wind * ground.x)]
    gust: Force,
    #[acts(on = hinge)]
    motor: Torque,
    #[acts(on = cart, along = x)]
    push: Force,
}

/// `d(T + U)/dt = control + disturbance − dissipated`, the left side by central differences along the motion.
#[test]
fn power_balance() {
    let m = Workbench { wind: 0.8 };
    let mut random = Random::new(3);
    for _ in 0..20 {
        let (q, v, u): (Vector2<f64>, Vector2<f64>, Vector2<f64>) =
            (random.vector(1.0), random.vector(2.0), random.vector(3.0));
        let a = m.forward_dynamics(&q, &v, &m.generalized_forces(&q, &u));
        let energy = |h: f64| {
            let (q, v) = (q + v * h + a * (h * h / 2.0), v + a * h);
            m.kinetic_energy(&q, &v) + m.potential_energy(&q)
        };
        let h = 1e-4;
        // Fourth order.
        let rate = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h))) / (12.0 * h);
        let power = m.control_power(&q, &v, &u) + m.disturbance_power(&q, &v) - m.dissipated_power(&q, &v);
        assert_close("power", &[rate], &[power], 1e-8);
        assert!(m.dissipated_power(&q, &v) > 0.0, "what dissipates takes energy out");
        let gust = m.frame_velocity(frame!(Workbench, "tip"), &q, &v)[0] * 0.8;
        assert_close("disturbance", &[m.disturbance_power(&q, &v)], &[gust], EXACT);
    }
}

// ---- Prescribed motion ---------------------------------------------------------------------------------------------

/// A pendulum on a base that is shaken up and down, whatever the pendulum does, and tilted by a quaternion for good.
#[mechanism(gravity = -g * y)]
struct ShakenBase {
    g: f64,
    m: f64,
    l: f64,
    amplitude: f64,
    speed: f64,
    #[frame(ground, quaternion(0, 0, 0.6, 0.8))]
    tilted: Frame,
    #[body(massive, at = amplitude * cos(speed * t) * y, frame = tilted)]
    base: Body,
    #[body]
    rod: Body,
    #[particle(mass = m, at = rod.at(-l * y))]
    bob: Particle,
    #[joint(base -> rod, about = z)]
    pin: Pin,
}

/// As gravity that changes with the base's acceleration (Landau and Lifshitz, *Mechanics*, § 5, problem 3 c).
#[test]
fn massive_base() {
    let (g, m, l, amplitude, speed) = (9.81, 0.3, 0.5, 0.02, 30.0);
    let base = ShakenBase { g, m, l, amplitude, speed };
    let tilt = 2.0 * 0.6_f64.atan2(0.8);
    for (t, angle) in [(0.0, 0.4), (0.013, -1.1), (0.2, 2.0)] {
        let (q, v) = (Vector1::new(angle), Vector1::new(1.3));
        let lift = -amplitude * speed * speed * (speed * t).cos();
        let bias = m * l * (g + lift) * (angle + tilt).sin();
        assert_close("mass", base.mass_matrix(t, &q).as_slice(), &[m * l * l], EXACT);
        assert_close("bias", base.bias_forces(t, &q, &v).as_slice(), &[bias], EXACT);
    }
}
