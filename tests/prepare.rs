//! A prepared mechanism has the functions of the mechanism itself, without the operations that depend on
//! parameters alone.

use linkwork::integrate::Error;
use linkwork::simulate::Sample;
use linkwork::{Real, at, mechanism, simulate};
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::{compile, parse_source_and_import};
use std::path::Path;
use support::compare::{assert_close, assert_same_dynamics};
use support::mechanisms::BeadOnRotatingHoop;
use support::random::Random;

const TOLERANCE: f64 = 1e-11;

/// Arm with a tool, a spring and friction, whose geometry, masses and elements are parameters.
#[mechanism(gravity = -g * z, prepare, derivatives, centroidal)]
struct Arm<T> {
    g: T,
    m: T,
    l: T,
    tilt: T,
    stiffness: T,
    damping: T,
    dry: T,
    #[body(mass = m, com = l / 2 * x + l / 9 * y, inertia = rod(m, l, x))]
    upper: Body,
    #[body(
        mass = m / 2, com = [l / 3, -l / 7, l / 11], inertia = cuboid(m / 2, l, l / 4, l / 5).rotated(z(tilt))
    )]
    lower: Body,
    #[body(mass = m / 3, com = l / 6 * z, inertia = disk(m / 3, l / 4, z))]
    hand: Body,
    #[particle(mass = m / 5, at = hand.at(l / 3 * x))]
    tool: Particle,
    #[joint(ground.rotated(x(tilt)) -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(l * x + l / 8 * y).rotated(y(tilt)) -> lower, along = x, about = y)]
    elbow: Slot,
    #[joint(lower.at(l / 2 * x) -> hand)]
    wrist: Ball,
    #[acts(on = shoulder, stiffness = stiffness, free_angle = tilt)]
    spring: Spring,
    #[acts(between = (ground, tool), stiffness = stiffness / (l * l), free_length = l / 2)]
    rope: Spring,
    #[acts(on = elbow.slide, damping = damping)]
    dashpot: Dashpot,
    #[acts(on = elbow.turn, coulomb = dry, viscous = damping * l * l)]
    friction: Friction,
    #[acts(on = elbow.turn)]
    motor: Torque,
    #[acts(on = hand.at(l * y), along = x)]
    jet: Force,
    #[output(v(tool / ground / upper), resolved_in = upper)]
    speed: Vector,
}

fn arm_with_parameters<T: Real>() -> Arm<T> {
    let convert_number = |x: f64| linkwork::nalgebra::convert::<f64, T>(x);
    Arm {
        g: convert_number(9.7),
        m: convert_number(1.3),
        l: convert_number(0.6),
        tilt: convert_number(0.4),
        stiffness: convert_number(30.0),
        damping: convert_number(0.7),
        dry: convert_number(0.2),
    }
}

#[test]
fn prepared_mechanism_equals_the_mechanism() {
    let arm = arm_with_parameters::<f64>();
    let prepared: PreparedArm<f64> = arm.prepare();
    assert_same_dynamics(&prepared, &arm, 20, TOLERANCE);
    assert_eq!(PreparedArm::<f64>::VELOCITIES, Arm::<f64>::VELOCITIES);
    let mut random = Random::new(5);
    for _ in 0..10 {
        let q = random.random_configuration(&arm);
        let [v, a] = [random.random_vector(2.0), random.random_vector(2.0)];
        let u = random.random_vector(3.0);
        macro_rules! same {
            ($($function:ident($($argument:expr),*)$(.$part:tt)?;)*) => {$(
                assert_close(
                    stringify!($function),
                    prepared.$function($($argument),*)$(.$part)?.as_slice(),
                    arm.$function($($argument),*)$(.$part)?.as_slice(),
                    TOLERANCE,
                );
            )*};
        }
        same! {
            generalized_forces(&q, &u);
            center_of_mass(&q);
            momentum(&q, &v);
            speed(&q, &v);
            speed_jacobian(&q, &v);
            mass_matrix_inverse(&q);
            coriolis_matrix(&q, &v);
            inverse_dynamics_derivatives(&q, &v, &a).0;
            inverse_dynamics_derivatives(&q, &v, &a).1;
            forward_dynamics_derivatives(&q, &v, &a).0;
            linearize(&q, &v, &u).0;
            linearize(&q, &v, &u).1;
            centroidal_momentum_matrix(&q);
            centroidal_momentum_bias(&q, &v);
        }
        let powers_and_total_mass = |m: [f64; 4]| m;
        assert_close(
            "powers",
            &powers_and_total_mass([
                prepared.dissipated_power(&q, &v),
                prepared.control_power(&q, &v, &u),
                prepared.disturbance_power(&q, &v),
                prepared.total_mass(),
            ]),
            &powers_and_total_mass([
                arm.dissipated_power(&q, &v),
                arm.control_power(&q, &v, &u),
                arm.disturbance_power(&q, &v),
                arm.total_mass(),
            ]),
            TOLERANCE,
        );
    }
}

#[test]
fn prepared_single_precision_equals_the_mechanism() {
    let (single, double) = (arm_with_parameters::<f32>().prepare(), arm_with_parameters::<f64>());
    let q = double.neutral();
    let mass = single.mass_matrix(&q.cast::<f32>()).cast::<f64>();
    assert_close("mass matrix", mass.as_slice(), double.mass_matrix(&q).as_slice(), 1e-6);
}

/// Panda arm from a file, with a load and a spring stiffness as parameters.
#[mechanism(urdf = "../models/urdf/panda.urdf", prepare)]
#[derive(Clone, Copy)]
struct LoadedPanda {
    load: f64,
    stiffness: f64,
    #[particle(mass = load, at = panda_hand.at(0.1 * z))]
    held: Particle,
    #[acts(on = panda_joint4, stiffness = stiffness)]
    balancer: Spring,
}

#[test]
fn prepared_loaded_robot_equals_the_robot() {
    let arm = LoadedPanda { load: 1.7, stiffness: 12.0 };
    assert_same_dynamics(&arm.prepare(), &arm, 20, TOLERANCE);
    // Prepared values do not follow later changes of the parameters.
    let heavier = LoadedPanda { load: 2.0, ..arm };
    assert_ne!(heavier.prepare(), arm.prepare());
    assert_same_dynamics(&heavier.prepare(), &heavier, 5, TOLERANCE);
}

#[test]
fn prepared_driven_mechanism_equals_the_mechanism() {
    let hoop = BeadOnRotatingHoop { g: 9.81, m: 0.1, radius: 0.3, spin: 8.0 };
    let prepared = hoop.prepare();
    for t in [0.0, 0.4] {
        assert_same_dynamics(&at(&prepared, t), &at(&hoop, t), 5, TOLERANCE);
    }
    let final_coordinate = |run: Result<Sample<f64, 1, 1, 0>, Error>| run.expect("it arrives").q[0];
    let one = simulate(&prepared).from([0.5], [0.0]).duration(1.0).finish();
    let other = simulate(&hoop).from([0.5], [0.0]).duration(1.0).finish();
    assert!((final_coordinate(one) - final_coordinate(other)).abs() < 1e-9);
}

/// Four-bar linkage with precomputed values, and with derivatives, centroidal momentum, regressor,
/// sensitivities, the packed mass matrix and functions of several states.
#[mechanism(
    gravity = -g * y,
    prepare,
    derivatives,
    centroidal,
    regressor,
    sensitivities,
    packed,
    batch
)]
struct FourBars {
    g: f64,
    m: f64,
    l: f64,
    #[body(mass = m, com = l / 2 * x, inertia = rod(m, l, x))]
    crank: Body,
    #[body(mass = 2 * m, com = l * x, inertia = rod(2 * m, 2 * l, x))]
    coupler: Body,
    #[body(mass = 2 * m, com = l * x, inertia = rod(2 * m, 2 * l, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    drive: Pin,
    #[joint(crank.at(l * x) -> coupler, about = z)]
    knee: Pin,
    #[joint(ground.at(2 * l * x) -> rocker, about = z)]
    pivot: Pin,
    #[joint(coupler.at(2 * l * x) -> rocker.at(2 * l * x), about = z)]
    closing: Pin,
}

#[test]
fn prepared_closed_loop_equals_the_loop() {
    let bars = FourBars { g: 9.81, m: 0.7, l: 0.4 };
    let prepared = bars.prepare();
    // With the crank upright, the loop is a kite: its other corner is as far from the crank's end as from the
    // pivot.
    let corner = (1.0_f64 + 4.0).sqrt() / 2.0;
    let (axis, half) = ((1.0_f64).atan2(-2.0), (corner / 2.0).acos());
    let (knee, pivot) = (axis + std::f64::consts::PI + half, axis - half);
    let q = [std::f64::consts::FRAC_PI_2, knee - std::f64::consts::FRAC_PI_2, pivot].into();
    assert_close("loop", bars.constraint_residuals(&q).as_slice(), &[0.0, 0.0], 1e-12);
    let (v, tau) = ([0.0; 3].into(), [0.3, 0.0, 0.0].into());
    let (one, other) = (prepared.forward_dynamics(&q, &v, &tau), bars.forward_dynamics(&q, &v, &tau));
    assert_close("accelerations", one.as_slice(), other.as_slice(), TOLERANCE);
    let rates = bars.constraint_jacobian(&q) * other + bars.constraint_bias(&q, &v);
    assert_close("the loop stays closed", rates.as_slice(), &[0.0, 0.0], TOLERANCE);
    // The regressor accounts for the forces of inertia and weight that the motion needs in addition to the
    // constraint forces of the loop.
    let needed = bars.inverse_dynamics(&q, &v, &other);
    let rigid = bars.joint_torque_regressor(&q, &v, &other) * bars.standard_parameters();
    assert_close("regressor", rigid.as_slice(), needed.as_slice(), TOLERANCE);
    let by_mass = bars.inverse_dynamics_by_parameters(&q, &v, &other).column(1) * bars.m;
    assert_close(
        "all forces are in proportion to the mass",
        by_mass.as_slice(),
        needed.as_slice(),
        TOLERANCE,
    );
}

// ---- Remaining operations --------------------------------------------------------------------------------

const MAIN: [&str; 4] = ["inverse_dynamics", "bias_forces", "mass_matrix", "forward_dynamics"];

/// Returns the numbers of operations of the main functions, first as generated, then with prepared
/// parameters.
fn main_and_prepared_counts(arguments: &str, item: &str) -> ([usize; 4], Option<[usize; 4]>) {
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let (mut cx, graph) = (Diagnostics::new(), Graph::new());
    let source = parse_source_and_import(parse_tokens(arguments), parse_tokens(item), Path::new(""), &mut cx);
    let Some((_, output)) = source.and_then(|s| compile(&s, &graph, &mut cx)) else {
        panic!("{}", cx.full_message_texts().join("\n"));
    };
    let main_operation_counts = |functions: &[linkwork_compiler::derive::Function]| {
        MAIN.map(|name| {
            functions.iter().find(|f| f.name == name).map_or(0, |f| f.program.counts.total_operations())
        })
    };
    (
        main_operation_counts(&output.functions),
        output.prepared.map(|prepared| main_operation_counts(&prepared.functions)),
    )
}

/// Returns the source of a 6R arm with the geometry of the PUMA 560 (Armstrong, Khatib and Burdick 1986)
/// whose bodies have no symmetry. The arguments choose whether lengths and inertial parameters are parameters
/// or numbers.
fn puma_source(lengths: bool, parameters: bool) -> String {
    let [a2, a3, d3, d4] = match lengths {
        true => ["a2", "a3", "d3", "d4"],
        false => ["0.4318", "0.0203", "0.15005", "0.4318"],
    };
    let places = [
        "ground",
        "b0.rotated(x(-pi / 2))",
        &format!("b1.at({a2} * x + {d3} * z)"),
        &format!("b2.at({a3} * x - {d4} * y).rotated(x(-pi / 2))"),
        "b3.rotated(x(pi / 2))",
        "b4.rotated(x(-pi / 2))",
    ];
    let mut fields = String::from(if lengths { "a2: f64, a3: f64, d3: f64, d4: f64, " } else { "" });
    for (k, place) in places.iter().enumerate() {
        let names = ["m", "cx", "cy", "cz", "xx", "yy", "zz", "xy", "xz", "yz"];
        let numbers = [3.1, 0.11, -0.07, 0.05, 0.31, 0.37, 0.29, 0.011, -0.013, 0.017];
        let [m, x, y, z, xx, yy, zz, xy, xz, yz] = std::array::from_fn(|i| match parameters {
            true => format!("{}{k}", names[i]),
            false => format!("{}", numbers[i] * (1.0 + 0.03 * (k * (i + 2) % 7) as f64)),
        });
        if parameters {
            names.iter().for_each(|name| fields += &format!("{name}{k}: f64, "));
        }
        fields += &format!(
            "#[body(mass = {m}, com = [{x}, {y}, {z}],
                inertia = [[{xx}, {xy}, {xz}], [{xy}, {yy}, {yz}], [{xz}, {yz}, {zz}]])] b{k}: Body,
             #[joint({place} -> b{k}, about = z)] j{k}: Pin,"
        );
    }
    format!("pub struct Puma {{ {fields} }}")
}

/// Returns the source of a chain of `n` rods along x whose joints have these axes in turn. Lengths and masses
/// are numbers or parameters.
fn chain_source(n: usize, axes: &[&str], parameters: bool) -> String {
    let mut fields = String::new();
    for k in 0..n {
        let number_or_parameter_name =
            |name: &str, x: f64| if parameters { format!("{name}{k}") } else { format!("{x}") };
        let (m, l) = (
            number_or_parameter_name("m", 2.0 + 0.1 * k as f64),
            number_or_parameter_name("l", 0.5 - 0.01 * k as f64),
        );
        let before = match parameters {
            true => format!("l{}", k.max(1) - 1),
            false => format!("{}", 0.5 - 0.01 * (k as f64 - 1.0)),
        };
        if parameters {
            fields += &format!("m{k}: f64, l{k}: f64, ");
        }
        let parent = if k == 0 { "ground".to_string() } else { format!("b{}.at({before} * x)", k - 1) };
        fields += &format!(
            "#[body(mass = {m}, com = {l} / 2 * x, inertia = cylinder({m}, 0.05, {l}, x))] b{k}: Body,
             #[joint({parent} -> b{k}, about = {})] j{k}: Pin,",
            axes[k % axes.len()]
        );
    }
    format!("pub struct Chain {{ {fields} }}")
}

/// Checks that prepared functions need at most ten per cent more operations than a mechanism with constants,
/// and exactly the stated counts. Where rods are along an axis, two lengths merge into one.
#[test]
fn prepared_parameters_add_few_operations() {
    for (name, numbers, parameters, expected) in [
        ("puma, masses", puma_source(false, false), puma_source(false, true), [470, 412, 245, 799]),
        ("puma, lengths too", puma_source(false, false), puma_source(true, true), [470, 412, 245, 799]),
        (
            "chain of 4",
            chain_source(4, &["z", "y"], false),
            chain_source(4, &["z", "y"], true),
            [177, 157, 70, 278],
        ),
        (
            "chain of 8",
            chain_source(8, &["z", "y"], false),
            chain_source(8, &["z", "y"], true),
            [473, 449, 422, 1186],
        ),
        (
            "chain about three axes",
            chain_source(8, &["z", "y", "x"], false),
            chain_source(8, &["z", "y", "x"], true),
            [423, 399, 378, 1092],
        ),
    ] {
        let (numbers, _) = main_and_prepared_counts("gravity = -9.81 * z", &numbers);
        let (whole, prepared) = main_and_prepared_counts("gravity = -9.81 * z, prepare", &parameters);
        let prepared = prepared.expect("it was asked for");
        for k in 0..4 {
            let (with, without) = (prepared[k] as f64, numbers[k] as f64);
            assert!(with <= 1.1 * without, "{name}: {}: {with} operations, {without} with numbers", MAIN[k]);
            assert!(prepared[k] < whole[k], "{name}: {}", MAIN[k]);
        }
        assert_eq!(prepared, expected, "{name}: {MAIN:?}");
    }
}
