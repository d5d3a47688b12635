//! Force elements with their force laws, their behaviour at coincident points, and their power balance.

use super::{EXACT, MOTION};
use linkwork::nalgebra::{Vector1, Vector2, Vector3, Vector6};
use linkwork::{frame, mechanism, simulate};
use linkwork_models::TwoBodies;
use std::f64::consts::PI;
use support::compare::{assert_close, assert_same_dynamics};
use support::random::Random;
use support::simulate::state_after_duration;
use support::with_common_fields;

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
fn mass_with_inerter_has_the_closed_form_motion() {
    let (q, _) = state_after_duration(&MassInerter {}, &Vector1::new(1.0), &Vector1::zeros(), 1.0);
    assert_close("displacement", q.as_slice(), &[-0.2234232688843427], 1e-12);
}

/// Moving-coil loudspeaker. The electric charge through its coil is a coordinate without a body, whose
/// inertia is the inductance.
#[mechanism(derivatives)]
struct Loudspeaker {
    mass: f64,
    stiffness: f64,
    damping: f64,
    inductance: f64,
    resistance: f64,
    coupling: f64,
    #[body(mass = mass)]
    cone: Body,
    charge: Coordinate,
    #[joint(ground -> cone, along = x)]
    travel: Sleeve,
    #[acts(on = travel, stiffness = stiffness)]
    surround: Spring,
    #[acts(on = travel, damping = damping)]
    air: Dashpot,
    #[acts(on = charge, inertance = inductance)]
    coil: Inerter,
    #[acts(on = charge, damping = resistance)]
    wire: Dashpot,
    #[acts(on = travel, value = coupling * rate(charge))]
    push: Force,
    #[acts(on = charge, value = -coupling * rate(travel))]
    induced: Force,
    #[acts(on = charge)]
    voltage: Force,
}

#[test]
fn inductance_is_the_inertia_of_the_charge() {
    let (m, k, c, l, r, bl) = (0.02, 900.0, 1.3, 0.5e-3, 6.0, 7.0);
    let (mass, stiffness, damping) = (m, k, c);
    let speaker = Loudspeaker { mass, stiffness, damping, inductance: l, resistance: r, coupling: bl };
    let order = Loudspeaker::VELOCITIES.map(|name| usize::from(name == "travel"));
    let charge_and_travel_in_order =
        |charge: f64, travel: f64| Vector2::from(order.map(|is_travel| [charge, travel][is_travel]));
    let (q, v, u) =
        (charge_and_travel_in_order(0.1, 2e-3), charge_and_travel_in_order(0.4, 0.3), Vector1::new(5.0));
    // L q̈ = u − R q̇ − B ẋ, m ẍ = B q̇ − c ẋ − k x.
    let expected =
        charge_and_travel_in_order((5.0 - r * 0.4 - bl * 0.3) / l, (bl * 0.4 - c * 0.3 - k * 2e-3) / m);
    let found = speaker.forward_dynamics(&q, &v, &speaker.generalized_forces(&q, &u));
    assert_close("accelerations", found.as_slice(), expected.as_slice(), EXACT);
    assert_close(
        "mass",
        speaker.mass_matrix(&q).diagonal().as_slice(),
        charge_and_travel_in_order(l, m).as_slice(),
        EXACT,
    );
    let inverse = speaker.mass_matrix_inverse(&q);
    assert_close(
        "its inverse",
        inverse.diagonal().as_slice(),
        charge_and_travel_in_order(1.0 / l, 1.0 / m).as_slice(),
        EXACT,
    );
    let (by_q, by_v, _) = speaker.forward_dynamics_derivatives(&q, &v, &Vector2::zeros());
    let (charge, travel) = (usize::from(order[0] != 0), usize::from(order[0] == 0));
    assert_close("stiffness", &[by_q[(travel, travel)], by_q[(charge, charge)]], &[-k / m, 0.0], EXACT);
    let rates = [[charge, charge], [charge, travel], [travel, charge], [travel, travel]];
    let expected = [-r / l, -bl / l, bl / m, -c / m];
    assert_close("resistances", &rates.map(|[i, j]| by_v[(i, j)]), &expected, EXACT);
}

/// Declares two bodies with a given force law of the springs: between two of their points, on a length, and
/// on an angle.
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
struct SpringsWithLinearForceLaw {
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
struct SpringsWithStiffness {
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
fn springs_by_force_and_by_energy_agree() {
    let (k, c, stiff, hard) = (20.0, 300.0, 5.0, 2.0);
    let (force, energy) = (DuffingByForce { k, c, stiff, hard }, DuffingByEnergy { k, c, stiff, hard });
    assert_same_dynamics(&force, &energy, 4, 1e-12);
    assert_same_dynamics(&SpringsWithLinearForceLaw { k }, &SpringsWithStiffness { k }, 4, 1e-12);
}

/// Cart between buffers that act beyond a gap.
#[mechanism]
struct CartBetweenBuffers {
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
fn elastic_buffers_act_only_beyond_their_gap() {
    let (k, gap) = (1000.0, 0.5);
    let cart = CartBetweenBuffers { k, gap };
    let force_at_position = |x: f64| cart.bias_forces(&Vector1::new(x), &Vector1::zeros())[0];
    let cases = [(0.3, 0.0), (-0.4, 0.0), (0.5, 0.0), (-0.5, 0.0), (0.7, 200.0), (-0.6, -100.0)];
    for (x, expected) in cases {
        assert_close(format!("at {x}"), &[force_at_position(x)], &[expected], 1e-12);
    }
    // One period: across the gap and back, with half an oscillation in each buffer.
    let period = 4.0 * gap / 2.0 + 2.0 * PI / k.sqrt();
    let (q, v) = state_after_duration(&cart, &Vector1::zeros(), &Vector1::new(2.0), period);
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
fn friction_laws_have_their_closed_forms() {
    let (m, f) = (2.0, 3.0);
    let block = SlidingBlock { m, f };
    let (q, v) = state_after_duration(&block, &Vector1::zeros(), &Vector1::new(4.0), 2.0);
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
fn projectile_with_linear_drag_has_the_closed_form() {
    let (m, c, t) = (0.4, 0.3, 1.7);
    let ball = DraggedProjectile { m, c };
    let (q, v) = state_after_duration(&ball, &Vector2::zeros(), &Vector2::new(7.0, 9.0), t);
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

with_common_fields! {
    {
        m: f64,
        g: f64,
        k: f64,
        #[body(inertia = diagonal(0.1, 0.1, 0.1))]
        rod: Body,
        #[particle(mass = m, at = rod.at(-0.6 * y))]
        bob: Particle,
        #[joint(ground -> rod, about = z)]
        pin: Pin,
    }

    /// Pendulum whose weight is a potential, with a spring as a potential, too.
    #[mechanism]
    struct PendulumByPotential {
        #[energy(m * g * dot(r(bob / ground), y) + k / 2 * pow(pin - 0.3, 2))]
        weight: Potential,
    }

    #[mechanism(gravity = -g * y)]
    struct PendulumByGravity {
        #[acts(on = pin, stiffness = k, free_angle = 0.3)]
        spring: Spring,
    }
}

#[test]
fn potential_energy_replaces_gravity() {
    let (m, g, k) = (0.8, 9.81, 4.0);
    assert_same_dynamics(&PendulumByPotential { m, g, k }, &PendulumByGravity { m, g, k }, 4, 1e-13);
}

/// Electric charges of the same sign in a magnetic field.
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
fn charged_particles_have_coulomb_and_lorentz_forces() {
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

    // Without charge on the other particle, the motion is a circle with the cyclotron period 2 π m / (q B).
    let start = Vector6::new(0.0, 0.0, 0.0, 1e8, 0.0, 0.0);
    let turning = Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let (q, v) = state_after_duration(&charges, &start, &turning, 2.0 * PI * 0.5 / 0.6);
    assert_close("circle", &[q[0], q[1], v[0], v[1]], &[0.0, 0.0, 1.0, 0.0], 1e-9);
}

/// Springs and dashpots to a point that the particle can reach.
#[mechanism]
struct ParticleAtSpringAnchor {
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

/// Elements between coincident points have no direction and exert no force there; an element of zero free
/// length has the limit zero.
#[test]
fn coincident_points_exert_no_force() {
    for l in [0.0, 0.3] {
        let meeting = ParticleAtSpringAnchor { l };
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

/// Gravity between coincident particles has no limit: the forces are not finite, and an integrator reports
/// it.
#[test]
fn gravity_of_coincident_particles_is_not_finite() {
    let bodies = TwoBodies { constant: 1.0, m1: 1.0, m2: 1.0 };
    let q = Vector6::zeros();
    assert_eq!(bodies.potential_energy(&q), f64::NEG_INFINITY);
    assert!(bodies.bias_forces(&q, &Vector6::zeros()).iter().any(|f| !f.is_finite()));
    assert!(simulate(&bodies).from(q, Vector6::zeros()).duration(1.0).finish().is_err());
}

/// Mechanism with force elements of every class: conservative, dissipative, control, disturbance, inertial.
#[mechanism(gravity = -9.81 * y)]
struct MechanismOfAllForceClasses {
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

/// Checks the power balance `d(T + U)/dt = control + disturbance − dissipated`, with the left side by central
/// differences along the motion.
#[test]
fn power_balance_holds_along_motion() {
    let m = MechanismOfAllForceClasses { wind: 0.8 };
    let mut random = Random::new(3);
    for _ in 0..20 {
        let (q, v, u): (Vector2<f64>, Vector2<f64>, Vector2<f64>) =
            (random.random_vector(1.0), random.random_vector(2.0), random.random_vector(3.0));
        let a = m.forward_dynamics(&q, &v, &m.generalized_forces(&q, &u));
        let total_energy_after_taylor_step = |h: f64| {
            let (q, v) = (q + v * h + a * (h * h / 2.0), v + a * h);
            m.kinetic_energy(&q, &v) + m.potential_energy(&q)
        };
        let h = 1e-4;
        // Differences of fourth order.
        let rate = (8.0 * (total_energy_after_taylor_step(h) - total_energy_after_taylor_step(-h))
            - (total_energy_after_taylor_step(2.0 * h) - total_energy_after_taylor_step(-2.0 * h)))
            / (12.0 * h);
        let power = m.control_power(&q, &v, &u) + m.disturbance_power(&q, &v) - m.dissipated_power(&q, &v);
        assert_close("power", &[rate], &[power], 1e-8);
        assert!(m.dissipated_power(&q, &v) > 0.0, "what dissipates takes energy out");
        let gust = m.frame_velocity(frame!(MechanismOfAllForceClasses, "tip"), &q, &v)[0] * 0.8;
        assert_close("disturbance", &[m.disturbance_power(&q, &v)], &[gust], EXACT);
    }
}
