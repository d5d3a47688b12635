//! Reads the printed linear equations back and compares them with accelerations of Lagrange's equations,
//! eigenvalues, and closed forms.

use super::*;
use num_complex::Complex;
use std::f64::consts::PI;

mod numbers;
pub(super) mod text;

use numbers::{NumericalMechanism, assert_same_roots, eigenvalues, polynomial_roots};
use text::{NameValues, ParsedEquations, evaluate_text};

/// Compares the printed linear rows with accelerations by finite differences.
#[track_caller]
fn check_printed_linear_rows(
    text: &ParsedEquations,
    names: &[&str],
    a: &[Vec<f64>],
    parameters: NameValues<'_>,
) {
    let n = names.len();
    let coefficient_column =
        |name: &str, mark: &str| text.coefficient_column(&format!("{name}{mark}"), false, parameters);
    let mass: Vec<Vec<f64>> = names.iter().map(|name| coefficient_column(name, "''")).collect();
    for (k, mark) in (0..2 * n).map(|k| (k, if k < n { "" } else { "'" })) {
        let force = coefficient_column(names[k % n], mark);
        // The products of inertia and accelerations by finite differences balance the forces.
        let size = force.iter().chain(&[1.0]).map(|x| x.abs()).fold(0.0, f64::max);
        for i in 0..n {
            let inertia: f64 = (0..n).map(|j| mass[j][i] * a[n + j][k]).sum();
            assert!(
                (inertia + force[i]).abs() < 1e-8 * size,
                "{} {mark} {i}: {inertia} {}",
                names[k % n],
                force[i]
            );
        }
    }
}

/// Calls `f` with the printed linear equations of all equilibria, and with a numerical model of the
/// mechanism.
fn call_with_linear_equations<R>(
    gravity: &str,
    item: &str,
    f: impl for<'g> FnOnce(NumericalMechanism<'g>, Vec<ParsedEquations>) -> R,
) -> R {
    call_with_parsed_model(gravity, item, |model| {
        let joints = crate::kinematics::joints_of_model(&model);
        let mass = crba::mass_matrix(&model, &joints);
        let equations_about_equilibrium = |at| {
            let mut cx = Diagnostics::new();
            let found = super::super::linear::derive_linear_equations(&model, &joints, &mass, at, &mut cx);
            let found = found.unwrap_or_else(|| panic!("{:?}", cx.full_message_texts()));
            ParsedEquations::parse(&super::super::linear::format_linear_equations(&model, at, &found).plain)
        };
        let texts = model.equilibria.iter().map(equations_about_equilibrium).collect();
        f(NumericalMechanism::new(&model), texts)
    })
}

/// Returns a function from parameter names to values.
fn value_lookup_by_name<'a>(names: &'a [&str], values: &'a [f64]) -> impl Fn(&str) -> f64 + 'a {
    move |word| {
        let k = names.iter().position(|name| *name == word);
        values[k.unwrap_or_else(|| panic!("the name {word}"))]
    }
}

/// Returns a generator of random numbers in a range.
fn random_generator(seed: u64, low: f64, high: f64) -> impl FnMut() -> f64 {
    let mut random = Random(2 * seed + 1);
    // The first numbers of a small seed are small.
    (0..20).for_each(|_| _ = random.random_number_below(2));
    move || low + (high - low) * random.random_number_below(100_000) as f64 / 100_000.0
}

fn largest_real_part(polynomial_roots: &[Complex<f64>]) -> f64 {
    polynomial_roots.iter().map(|z| z.re).fold(f64::MIN, f64::max)
}

const BALANCE: &str = "struct CartPole {
    cart_mass: f64,
    pole_mass: f64,
    length: f64,
    stiffness: f64,
    damping: f64,
    #[body(mass = cart_mass)]
    cart: Body,
    #[body(mass = pole_mass, com = length / 2 * y, inertia = rod(pole_mass, length, y))]
    pole: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    hinge: Pin,
    #[acts(on = rail, damping = damping)]
    drag: Dashpot,
    #[acts(on = hinge, stiffness = stiffness)]
    coil: Spring,
    #[acts(on = cart, along = x)]
    push: Force,
    #[acts(on = hinge)]
    motor: Torque,
    #[equilibrium]
    upright: Equilibrium,
    #[equilibrium(hinge = pi / 3, motor = stiffness * pi / 3 - 9.81 * pole_mass * length / 2 * sin(pi / 3))]
    leaning: Equilibrium,
}";

#[test]
fn linear_equations_linearise_lagranges_equations() {
    let names = ["cart_mass", "pole_mass", "length", "stiffness", "damping"];
    let mut next = random_generator(3, 0.3, 2.3);
    call_with_linear_equations("-9.81 * y", BALANCE, |numbers, texts| {
        for _ in 0..20 {
            let values: Vec<f64> = (0..5).map(|_| next()).collect();
            let parameters = value_lookup_by_name(&names, &values);
            for (text, angle) in texts.iter().zip([0.0, PI / 3.0]) {
                let torque = values[3] * angle - 9.81 * values[1] * values[2] / 2.0 * angle.sin();
                let a = numbers.linear_system_matrix(&[0.0, angle], &[0.0, torque], &values);
                check_printed_linear_rows(text, &["rail", "hinge"], &a, &parameters);
                let column_of_input = |name: &str| text.coefficient_column(name, true, &parameters);
                assert_eq!([column_of_input("push"), column_of_input("motor")], [[1.0, 0.0], [0.0, 1.0]]);
                assert_same_roots(&text.characteristic_roots(&parameters), &eigenvalues(&a), 1e-4);
            }
        }
    });
}

/// A hovering craft: a thrust along its own axis supports it.
const CRAFT: &str = "struct Craft {
    m: f64,
    a: f64,
    c: f64,
    arm: f64,
    drag: f64,
    #[body(mass = m, inertia = diagonal(a, a, c))]
    hull: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[acts(on = hull, along = hull.z)]
    thrust: Force,
    #[acts(on = hull, about = hull.y)]
    motor: Torque,
    #[acts(on = hull.at(arm * z), value = -drag * v(hull / ground / ground))]
    air: Force,
    #[equilibrium(thrust = 9.81 * m)]
    hovering: Equilibrium,
}";

#[test]
fn small_rotations_linearise_lagranges_equations() {
    let (names, values) = (["m", "a", "c", "arm", "drag"], [1.3, 0.2, 0.35, 0.1, 0.4]);
    let joints = ["pose.dx", "pose.dy", "pose.dz", "pose.rx", "pose.ry", "pose.rz"];
    call_with_linear_equations("-9.81 * z", CRAFT, |numbers, texts| {
        let a =
            numbers.linear_system_matrix(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &[9.81 * 1.3, 0.0], &values);
        check_printed_linear_rows(&texts[0], &joints, &a, &value_lookup_by_name(&names, &values));
    });
}

/// Three masses in a row between springs, the last of them damped.
const ROW: &str = "struct Row {
    k1: f64,
    k2: f64,
    k3: f64,
    d: f64,
    #[particle(mass = 1)]
    a: Particle,
    #[particle(mass = 2)]
    b: Particle,
    #[particle(mass = 1)]
    c: Particle,
    #[joint(ground -> a, along = x)]
    one: Sleeve,
    #[joint(ground -> b, along = x)]
    two: Sleeve,
    #[joint(ground -> c, along = x)]
    three: Sleeve,
    #[acts(on = one, stiffness = k1)]
    wall: Spring,
    #[energy(k2 / 2 * pow(two - one, 2) + k3 / 2 * pow(three - two, 2))]
    springs: Potential,
    #[acts(on = three, damping = d)]
    damper: Dashpot,
    #[equilibrium]
    rest: Equilibrium,
}";

/// Compares the conditions of Liénard and Chipart with eigenvalues.
#[test]
fn stability_conditions_of_three_masses_agree_with_eigenvalues() {
    let names = ["k1", "k2", "k3", "d"];
    let mut next = random_generator(5, -0.6, 2.2);
    call_with_linear_equations("0 * x", ROW, |numbers, texts| {
        let text = &texts[0];
        assert_eq!(text.verdict, "Asymptotically stable where");
        let (mut stable, mut unstable) = (0, 0);
        for _ in 0..400 {
            let values: Vec<f64> = (0..4).map(|_| next()).collect();
            let largest =
                largest_real_part(&eigenvalues(&numbers.linear_system_matrix(&[0.0; 3], &[], &values)));
            if largest.abs() > 1e-5 {
                assert_eq!(
                    text.satisfies_conditions(&value_lookup_by_name(&names, &values)),
                    largest < 0.0,
                    "{values:?} {largest}"
                );
                *(if largest < 0.0 { &mut stable } else { &mut unstable }) += 1;
            }
        }
        assert!(stable > 50 && unstable > 50, "{stable} {unstable}");
    });
}

/// Ziegler's column: two links on spring hinges, with a follower force along the last link (Ziegler,
/// *Ing.-Arch.* 20, 1952).
const ZIEGLER: &str = "struct Ziegler {
    m: f64,
    l: f64,
    k: f64,
    p: f64,
    #[body]
    lower: Body,
    #[body]
    upper: Body,
    #[particle(mass = 2 * m, at = lower.at(l * y))]
    middle: Particle,
    #[particle(mass = m, at = upper.at(l * y))]
    top: Particle,
    #[joint(ground -> lower, about = z)]
    shoulder: Pin,
    #[joint(lower.at(l * y) -> upper, about = z)]
    elbow: Pin,
    #[acts(on = shoulder, stiffness = k)]
    first: Spring,
    #[acts(on = elbow, stiffness = k)]
    second: Spring,
    #[acts(on = upper.at(l * y), value = -p * upper.y)]
    follower: Force,
    #[equilibrium]
    straight: Equilibrium,
}";

/// Without damping the column flutters from `p l / k = 7/2 − √2`, the closed form of the literature.
#[test]
fn follower_force_makes_a_column_flutter() {
    let names = ["m", "l", "k", "p"];
    let mut next = random_generator(9, 0.5, 2.5);
    call_with_linear_equations("0 * x", ZIEGLER, |numbers, texts| {
        let text = &texts[0];
        assert_eq!(text.verdict, "Stable, all deviations oscillate, where");
        for _ in 0..150 {
            let [m, l, k] = [next(), next(), next()];
            for (part, stable) in [(0.2, true), (0.999, true), (1.001, false), (1.4, false)] {
                let values = [m, l, k, part * (3.5 - 2.0_f64.sqrt()) * k / l];
                let parameters = value_lookup_by_name(&names, &values);
                assert_eq!(text.satisfies_conditions(&parameters), stable, "{part} {values:?}");
                let exact = eigenvalues(&numbers.linear_system_matrix(&[0.0; 2], &[], &values));
                assert_same_roots(&text.characteristic_roots(&parameters), &exact, 1e-3);
            }
        }
    });
}

/// A bead on a hoop that spins about the vertical.
const HOOP: &str = "struct Hoop {
    g: f64,
    m: f64,
    radius: f64,
    spin: f64,
    theta: Coordinate,
    #[frame(ground, z(spin * t))]
    hoop: Frame,
    #[particle(mass = m, at = radius * (sin(theta) * hoop.x - cos(theta) * hoop.z))]
    bead: Particle,
    #[equilibrium]
    bottom: Equilibrium,
    #[equilibrium(theta = acos(g / (spin * spin * radius)))]
    side: Equilibrium,
}";

/// Checks the textbook frequencies of a bead on a spinning hoop: `ω² = Ω² − g²/(R² Ω²)` about the equilibrium
/// at the side, `g/R − Ω²` about the one at the bottom.
#[test]
fn bead_on_a_hoop_has_textbook_frequencies() {
    let names = ["g", "m", "radius", "spin"];
    call_with_linear_equations("-g * z", HOOP, |numbers, texts| {
        for values in
            [[9.81, 0.7, 0.5, 6.0], [1.6, 0.7, 0.8, 2.1], [9.81, 0.7, 0.5, 4.0], [2.0, 0.3, 1.0, 1.0]]
        {
            let [g, _, radius, spin] = values;
            let parameters = value_lookup_by_name(&names, &values);
            let above = spin * spin * radius > g;
            assert_eq!(
                [texts[0].satisfies_conditions(&parameters), texts[1].satisfies_conditions(&parameters)],
                [!above, above]
            );
            let [below, side] = [g / radius - spin * spin, spin * spin - (g / (radius * spin)).powi(2)];
            let squared_frequency =
                |text: &ParsedEquations| evaluate_text(&text.frequency, &parameters).powi(2);
            let (found, expected) = if above {
                (squared_frequency(&texts[1]), side)
            } else {
                (squared_frequency(&texts[0]), below)
            };
            assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
            let angle = if above { (g / (spin * spin * radius)).acos() } else { 0.0 };
            let polynomial_roots = eigenvalues(&numbers.linear_system_matrix(&[angle], &[], &values));
            assert_same_roots(
                &texts[usize::from(above)].characteristic_roots(&parameters),
                &polynomial_roots,
                1e-6,
            );
        }
    });
}

/// A carriage on a spring with a motor that follows its command with a first-order lag.
const LATE: &str = "struct Late {
    m: f64,
    c: f64,
    k: f64,
    lag: f64,
    gain: f64,
    #[body(mass = m, inertia = sphere(m, 1))]
    carriage: Body,
    #[joint(ground -> carriage, along = x)]
    rail: Sleeve,
    #[acts(on = rail, stiffness = k)]
    spring: Spring,
    #[acts(on = rail, damping = c)]
    damper: Dashpot,
    #[state(rate = (-power - gain * rail) / lag)]
    power: State,
    #[acts(on = rail, value = power)]
    motor: Force,
    #[equilibrium]
    rest: Equilibrium,
}";

/// Routh's condition of the cubic `lag m s³ + (m + lag c) s² + (c + lag k) s + k + gain`.
#[test]
fn actuator_lag_destabilises_control() {
    let names = ["m", "c", "k", "lag", "gain"];
    let mut next = random_generator(12, 0.1, 2.1);
    call_with_linear_equations("0 * x", LATE, |_, texts| {
        let (mut stable, mut unstable) = (0, 0);
        for _ in 0..200 {
            let values = [next(), 0.3 * next(), next(), next(), next()];
            let [m, c, k, lag, gain] = values;
            let parameters = value_lookup_by_name(&names, &values);
            let cubic = [k + gain, c + lag * k, m + lag * c, lag * m];
            let expected = cubic[2] * cubic[1] > cubic[3] * cubic[0];
            assert_eq!(texts[0].satisfies_conditions(&parameters), expected, "{values:?}");
            *(if expected { &mut stable } else { &mut unstable }) += 1;
            assert_same_roots(&texts[0].characteristic_roots(&parameters), &polynomial_roots(&cubic), 1e-6);
        }
        assert!(stable > 20 && unstable > 20, "{stable} {unstable}");
    });
}

/// Declaration of a ladder that slides on a wall and on the floor: two constraints, one degree of freedom.
const LADDER: &str = "struct Ladder {
    m: f64,
    l: f64,
    #[body(mass = m, inertia = rod(m, l, x))]
    ladder: Body,
    #[joint(ground -> ladder, about = z)]
    pose: Planar,
    #[constraint(pose.x = l / 2 * cos(pose.angle))]
    wall: Holonomic,
    #[constraint(pose.y = -l / 2 * sin(pose.angle))]
    floor: Holonomic,
    #[equilibrium(pose.angle = pi / 2, pose.y = -l / 2)]
    hanging: Equilibrium,
}";

/// A ladder that hangs below the floor is a pendulum with `ω² = 3 g / (2 l)` by energy, `T = m l² θ̇² / 6`,
/// `U = −m g l cos θ / 2`.
#[test]
fn constrained_ladder_oscillates_like_a_pendulum() {
    call_with_linear_equations("-9.81 * y", LADDER, |_, texts| {
        for values in [[1.0, 2.0], [0.4, 0.7]] {
            let parameters = value_lookup_by_name(&["m", "l"], &values);
            let square = evaluate_text(&texts[0].frequency, &parameters).powi(2);
            assert!((square - 1.5 * 9.81 / values[1]).abs() < 1e-12 * square, "{square}");
            let polynomial_roots = texts[0].characteristic_roots(&parameters);
            assert_eq!(polynomial_roots.len(), 2);
            assert!(
                polynomial_roots.iter().all(|z| (z * z + square).norm() < 1e-9 * square),
                "{polynomial_roots:?}"
            );
        }
    });
}
