//! Compares linear equations with finite differences of Lagrange's equations, and tests their printed form.

use super::super::linear::{self, LinearisedEquations};
use super::*;

/// Calls `f` with the linear equations of every equilibrium of a struct, as polynomials, plain text and
/// LaTeX.
fn call_for_each_linearisation(
    gravity: &str,
    item: &str,
    f: impl for<'g> Fn(&Model<'g>, &LinearisedEquations, &str, &str),
) {
    call_with_parsed_model(gravity, item, |model| {
        let joints = crate::kinematics::joints_of_model(&model);
        let mass = crba::mass_matrix(&model, &joints);
        assert!(!model.equilibria.is_empty());
        for at in &model.equilibria {
            let mut cx = Diagnostics::new();
            let found = linear::derive_linear_equations(&model, &joints, &mass, at, &mut cx);
            let found = found.unwrap_or_else(|| panic!("{:?}", cx.full_message_texts()));
            let written = linear::format_linear_equations(&model, at, &found);
            assert_eq!(latex::latex_errors(&written.latex), [""; 0], "{}", written.latex);
            f(&model, &found, &written.plain, &written.latex);
        }
    });
}

/// Compares the rows of the linear equations with finite differences of force balances, constraints and rates
/// of states.
fn check_linear_rows(model: &Model<'_>, found: &LinearisedEquations) {
    let (nv, nu) = (model.nv(), model.nu());
    let at = &model.equilibria[0];
    let states = at.states.len();
    let joints = crate::kinematics::joints_of_model(model);
    let lagrange = lagrange::derive(model, &joints);
    let test_number_of_parameter = |s: Symbol| 0.4 + 1.3 * f64::from(s.0 % 7);
    let value_at_test_parameters = |k: &Expr<'_>| crate::expr::eval::eval_one(*k, &test_number_of_parameter);
    let (q, u): (Vec<f64>, Vec<f64>) = (
        at.configuration.iter().map(value_at_test_parameters).collect(),
        at.inputs.iter().map(value_at_test_parameters).collect(),
    );
    // Lagrange's equations of this reference have no multipliers: their forces, and their geometric
    // stiffness, are omitted.
    let right = right_sides(model, &joints);
    let mut balance: Vec<Expr<'_>> = lagrange.bias.iter().zip(&right).map(|(a, b)| *a - *b).collect();
    balance.extend(model.constraints.iter().map(|c| c.residual.unwrap_or(c.rate)));
    balance.extend(at.states.iter().map(|state| -state.rate));
    let force_balance_values = |q: &[f64], v: &[f64], u: &[f64], x: f64| {
        eval(&balance, &|s| match Quantity::from_symbol(s) {
            Quantity::Configuration(k) => q[k],
            Quantity::Velocity(k) => v[k],
            Quantity::Input(k) => u[k],
            Quantity::Given(..) | Quantity::Time => 0.0,
            Quantity::Parameter(k) if at.states.first().is_some_and(|s| s.parameter == k) => x,
            _ => test_number_of_parameter(s),
        })
    };
    let h = 1e-4;
    let central_difference = |f: &dyn Fn(f64) -> Vec<f64>| -> Vec<f64> {
        let ((a, b), (c, d)) = ((f(h), f(-h)), (f(2.0 * h), f(-2.0 * h)));
        (0..a.len()).map(|k| (8.0 * (a[k] - b[k]) - (c[k] - d[k])) / (12.0 * h)).collect()
    };
    let list_with_changed_entry = |list: &[f64], k: usize, by: f64| {
        let mut list = list.to_vec();
        list[k] += by;
        list
    };
    let still = vec![0.0; nv];
    let coefficients_of_quantity = |what: Quantity, sides: &[Polynomial]| -> Vec<f64> {
        let symbol_value_for_unit_quantity = |s: Symbol| match Quantity::from_symbol(s) {
            Quantity::Parameter(_) => test_number_of_parameter(s),
            _ => f64::from(u8::from(s == what.symbol())),
        };
        sides.iter().map(|p| found.ring.evaluate_polynomial(p, &symbol_value_for_unit_quantity)).collect()
    };
    for k in 0..nv {
        // All coordinates are plain here.
        let by_q = central_difference(&|d| {
            force_balance_values(&list_with_changed_entry(&q, k, d), &still, &u, 0.0)
        });
        assert_close_lists(
            &coefficients_of_quantity(linear::deviation_symbol(k), &found.motion),
            &by_q,
            "stiffness",
        );
        let by_v = central_difference(&|d| {
            force_balance_values(&q, &list_with_changed_entry(&still, k, d), &u, 0.0)
        });
        assert_close_lists(&coefficients_of_quantity(Quantity::Velocity(k), &found.motion), &by_v, "damping");
    }
    for k in 0..nu {
        let by_u: Vec<f64> = central_difference(&|d| {
            force_balance_values(&q, &still, &list_with_changed_entry(&u, k, d), 0.0)
        })
        .iter()
        .map(|x| -x)
        .collect();
        assert_close_lists(&coefficients_of_quantity(Quantity::Input(k), &found.forces), &by_u, "inputs");
    }
    if states > 0 {
        let by_x = central_difference(&|d| force_balance_values(&q, &still, &u, d));
        assert_close_lists(
            &coefficients_of_quantity(linear::deviation_symbol(nv), &found.motion),
            &by_x,
            "states",
        );
    }
}

fn assert_close_lists(a: &[f64], b: &[f64], what: &str) {
    let size = b.iter().fold(1.0_f64, |size, b| size.max(b.abs()));
    assert!(
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-8 * size),
        "{what}: {a:?} instead of {b:?}"
    );
}

const PENDULUM: &str = "struct P { g: f64, m: f64, l: f64, c: f64,
    #[body(mass = m, com = -l * y, inertia = diagonal(0, 0, 0))] bob: Body,
    #[joint(ground -> bob, about = z)] hinge: Pin,
    #[acts(on = hinge, damping = c)] drag: Dashpot,
    #[acts(on = hinge)] motor: Torque, EQUILIBRIUM }";

const LAG: &str = "struct Lag { m: f64, k: f64, lag: f64, gain: f64,
    #[particle(mass = m)] car: Particle, #[joint(ground -> car, along = x)] rail: Sleeve,
    #[acts(on = rail, damping = 3 * k)] drag: Dashpot,
    #[state(rate = (-power - gain * rail) / lag)] power: State,
    #[acts(on = rail, value = 2 * power)] engine: Force,
    #[equilibrium] still: Equilibrium }";

#[test]
fn pendulum_linearises_to_its_natural_frequency() {
    let pendulum_with_equilibrium = |equilibrium: &str| PENDULUM.replace("EQUILIBRIUM", equilibrium);
    let assert_lines_contained = |equilibrium: &str, lines: &'static [&'static str]| {
        call_for_each_linearisation(
            "-g * y",
            &pendulum_with_equilibrium(equilibrium),
            |model, found, plain, _| {
                check_linear_rows(model, found);
                for line in lines {
                    assert!(plain.contains(line), "{line} in {plain}");
                }
            },
        );
    };
    assert_lines_contained(
        "#[equilibrium] down: Equilibrium",
        &[
            "m l² hinge'' + c hinge' + g m l hinge = motor\n",
            "Asymptotically stable where\n    g l > 0\n    c > 0\n",
        ],
    );
    assert_lines_contained(
        "#[equilibrium(hinge = pi)] up: Equilibrium",
        &[
            "m l² hinge'' + c hinge' - g m l hinge = motor\n",
            "    -g l > 0\n",
            "up: hinge = pi; other values are zero.\n",
        ],
    );
    // At a right angle gravity has no stiffness.
    assert_lines_contained(
        "#[equilibrium(hinge = pi / 2, motor = m * g * l)] held: Equilibrium",
        &["m l² hinge'' + c hinge' = motor\n", "One root is s = 0"],
    );
    assert_lines_contained(
        "#[equilibrium(hinge = pi / 3, motor = m * g * l * sin(pi / 3))] held: Equilibrium",
        &["+ 1/2 g m l hinge = motor\n"],
    );
}

#[test]
fn linear_equations_are_derivatives_of_the_dynamics() {
    for (gravity, item) in [("-7 * y", DOUBLE_PENDULUM), ("-7 * y", CART_POLE), ("-7 * z", SPHERICAL)] {
        let item = item.trim_end().trim_end_matches('}').to_string() + "#[equilibrium] rest: Equilibrium }";
        call_for_each_linearisation(gravity, &item.replace(" g: f64,", " _g: f64,"), |model, found, _, _| {
            check_linear_rows(model, found);
        });
    }
    call_for_each_linearisation("-9.81 * z", LAG, |model, found, plain, _| {
        check_linear_rows(model, found);
        assert!(plain.contains("power' + (gain rail + power)/lag = 0\n"), "{plain}");
    });
}

/// A particle on a circular wire at its lowest point: the only stiffness is the geometric stiffness of the
/// multiplier.
#[test]
fn particle_on_a_wire_has_geometric_stiffness() {
    let item = "struct Wire { m: f64, g: f64, l: f64,
        #[particle(mass = m)] p: Particle,
        #[joint(ground -> p, along = (x, y))] place: Stage,
        #[constraint(place.x * place.x + place.y * place.y = l * l)] wire: Holonomic,
        #[equilibrium(place.y = -l)] low: Equilibrium,
        #[equilibrium(place.y = l)] high: Equilibrium }";
    call_for_each_linearisation("-g * y", item, |_, _, plain, _| {
        let low = plain.starts_with("low");
        let expected: &[&str] = match low {
            true => &[
                "m place.x'' + m g place.x/l = 0\n",
                "-2 l place.y = 0\n",
                "    omega = sqrt(g/l)\n",
                "    g > 0\n",
                "lambda1 = ",
            ],
            false => &["m place.x'' - m g place.x/l = 0\n", "    -g > 0\n"],
        };
        for line in expected {
            assert!(plain.contains(line), "{line} in {plain}");
        }
    });
}

/// Small rotations of a pendulum on a ball joint about body axes. One of them has no restoring moment.
#[test]
fn orientation_deviations_are_small_rotations() {
    let item = "struct Tip { m: f64, g: f64, l: f64, a: f64, c: f64,
        #[body(mass = m, com = -l * z, inertia = diagonal(a, a, c))] bob: Body,
        #[joint(ground -> bob)] tip: Ball,
        #[equilibrium] down: Equilibrium }";
    call_for_each_linearisation("-g * z", item, |_, _, plain, latex| {
        for line in [
            "(m l² + a) tip.rx'' + m g l tip.rx = 0\n",
            "c tip.rz'' = 0\n",
            "    g l (m l² + a) > 0\n",
            "2 roots are s = 0",
        ] {
            assert!(plain.contains(line), "{line} in {plain}");
        }
        assert!(latex.contains("\\ddot{r}_{\\mathrm{tip},x}"), "{latex}");
    });
}

/// A bead on a spinning hoop is at rest relative to the hoop, though it moves in space.
#[test]
fn bead_on_a_spinning_hoop_is_in_relative_equilibrium() {
    let item = "struct Bead { g: f64, m: f64, radius: f64, spin: f64,
        theta: Coordinate,
        #[frame(ground, z(spin * t))] hoop: Frame,
        #[particle(mass = m, at = radius * (sin(theta) * hoop.x - cos(theta) * hoop.z))] bead: Particle,
        #[equilibrium] bottom: Equilibrium,
        #[equilibrium(theta = acos(g / (spin * spin * radius)))] side: Equilibrium }";
    call_for_each_linearisation("-g * z", item, |_, _, plain, _| {
        let expected = match plain.starts_with("bottom") {
            true => ["omega = sqrt(g/radius - spin²)\n", "    g - radius spin² > 0\n"],
            false => ["side: theta = acos(g/(radius spin²));", "    -g² + radius² spin⁴ > 0\n"],
        };
        for line in expected {
            assert!(plain.contains(line), "{line} in {plain}");
        }
    });
}

/// A skate between springs: the edge constrains the lateral velocity, but not the lateral position.
#[test]
fn skate_edge_leaves_the_lateral_position_free() {
    let item = "struct Skate { m: f64, k: f64, c: f64,
        #[body(mass = m, inertia = diagonal(1, 1, 2))] skate: Body,
        #[joint(ground -> skate, about = z)] pose: Planar,
        #[energy(k / 2 * pose.x * pose.x)] spring: Potential,
        #[energy(c / 2 * pose.angle * pose.angle)] coil: Potential,
        #[constraint(rate(pose.x) * sin(pose.angle) - rate(pose.y) * cos(pose.angle) = 0)] edge: Nonholonomic,
        #[equilibrium] rest: Equilibrium }";
    call_for_each_linearisation("0 * x", item, |_, _, plain, _| {
        for line in [
            "m pose.x'' + k pose.x = 0\n",
            "m pose.y'' = -lambda1\n",
            "2 pose.angle'' + c pose.angle = 0\n",
            "-pose.y' = 0\n",
            "One root is s = 0",
            "lambda1 is the multiplier of the constraint edge.",
        ] {
            assert!(plain.contains(line), "{line} in {plain}");
        }
    });
}

/// Three oscillators of unit mass with states of first order: the characteristic polynomial is
/// `(k + s²)³ (s + 1/b)`, of degree 7; with a second state its degree is 8, more than a printed power has.
#[test]
fn polynomials_of_high_degree_are_printed_completely() {
    let oscillators = ["x", "y", "z"].map(|axis| {
        format!(
            "#[particle(mass = 1)] p{axis}: Particle, #[joint(ground -> p{axis}, along = {axis})] r{axis}: Sleeve,
            #[acts(on = r{axis}, stiffness = k)] s{axis}: Spring,"
        )
    });
    for (states, degree) in [(1, Some(7)), (2, None)] {
        let states: String =
            (0..states).map(|n| format!("#[state(rate = -f{n} / b)] f{n}: State,")).collect();
        let item = format!(
            "struct Three {{ k: f64, b: f64, {} {states} #[equilibrium] rest: Equilibrium }}",
            oscillators.concat()
        );
        call_for_each_linearisation("0 * x", &item, |_, found, plain, _| {
            let found = found.stability.as_ref().map(|stability| stability.coefficients.len() - 1);
            assert_eq!(found, degree, "{plain}");
            assert_eq!(plain.contains("s⁷"), degree.is_some(), "{plain}");
        });
    }
}
