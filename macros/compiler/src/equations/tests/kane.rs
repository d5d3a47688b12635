//! Reads Kane's equations in independent velocities back and compares them with the accelerations of
//! Lagrange's equations with multipliers.

use super::super::kane::{format_kane_equations, kane_equations};
use super::*;
use crate::mechanics::speeds::SpeedTransformation;

/// Chaplygin's sleigh: a knife edge at the origin of a sled whose centre of mass is ahead of it.
const SLEIGH: &str = "struct Sleigh { m: f64, a: f64, j: f64,
    #[body(mass = m, com = a * x, inertia = diagonal(1, 1, j))] sled: Body,
    #[joint(ground -> sled, about = z)] pose: Planar,
    #[constraint(dot(v(sled / ground / ground), sled.y) = 0)] blade: Nonholonomic,
    #[acts(on = sled, along = x)] push: Force, #[acts(on = sled, about = z)] steer: Torque }";

/// Declaration of Chaplygin's sleigh in generalized speeds along and across its blade.
const SLEIGH_IN_SPEEDS: &str = "struct Sleigh { m: f64, a: f64, j: f64,
    #[body(mass = m, com = a * x, inertia = diagonal(1, 1, j))] sled: Body,
    #[joint(ground -> sled, about = z)] pose: Planar,
    #[speed(rate(pose.x) * cos(pose.angle) + rate(pose.y) * sin(pose.angle))] along: Speed,
    #[speed(rate(pose.y) * cos(pose.angle) - rate(pose.x) * sin(pose.angle))] across: Speed,
    #[constraint(dot(v(sled / ground / ground), sled.y) = 0)] blade: Nonholonomic,
    #[acts(on = sled, along = x)] push: Force, #[acts(on = sled, about = z)] steer: Torque }";

/// An upright rolling disk in coordinates of position, heading and roll.
const WHEEL: &str = "struct Wheel { m: f64, r: f64,
    px: Coordinate, py: Coordinate, heading: Coordinate, roll: Coordinate,
    #[frame(ground, z(heading))] fork: Frame,
    #[frame(fork, y(roll))] turned: Frame,
    #[body(mass = m, inertia = disk(m, r, y), at = px * ground.x + py * ground.y + r * ground.z, frame = turned)] wheel: Body,
    #[constraint(rate(px) = r * rate(roll) * cos(heading))] first: Nonholonomic,
    #[constraint(rate(py) = r * rate(roll) * sin(heading))] second: Nonholonomic,
    #[acts(on = roll)] drive: Torque, #[acts(on = heading)] steer: Torque }";

/// Declaration of a ball that rolls on a plane.
const ROLLING: &str = "struct Ball { m: f64, r: f64,
    #[body(mass = m, inertia = sphere(m, r))] ball: Body,
    #[joint(ground -> ball)] pose: Free,
    #[constraint(rolls(ball.sphere(r), ground.plane(z)))] contact: Rolling }";

/// A rolling and leaning disk in angles of heading, lean and roll.
const DISK: &str = "struct Disk { m: f64, r: f64,
    px: Coordinate, py: Coordinate, heading: Coordinate, lean: Coordinate, roll: Coordinate,
    #[frame(ground, z(heading))] fork: Frame,
    #[frame(fork, x(lean))] leaning: Frame,
    #[frame(leaning, y(roll))] turned: Frame,
    #[body(mass = m, inertia = disk(m, r, y), at = px * ground.x + py * ground.y + r * leaning.z, frame = turned)] wheel: Body,
    #[constraint(rate(px) = r * rate(roll) * cos(heading))] first: Nonholonomic,
    #[constraint(rate(py) = r * rate(roll) * sin(heading))] second: Nonholonomic }";

/// Declaration of a slide coupled to another slide by a constraint that is driven in time.
const CAM: &str = "struct Cam { m: f64, l: f64, w: f64,
    #[particle(mass = m)] one: Particle, #[particle(mass = 2 * m)] two: Particle,
    #[joint(ground -> one, along = x)] first: Sleeve, #[joint(ground -> two, along = y)] second: Sleeve,
    #[constraint(rate(second) = rate(first) * (2 + sin(first)) + l * w * cos(w * t))] follow: Nonholonomic,
    #[acts(on = first)] push: Force }";

/// Solves a small linear system by elimination with pivoting.
fn solve_linear_system(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).expect("a row");
        rows.swap(k, pivot);
        let own: Vec<f64> = rows[k].iter().map(|x| x / rows[k][k]).collect();
        for (i, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let (_, factor) = (i, row[k]);
            row.iter_mut().zip(&own).for_each(|(x, own)| *x -= factor * own);
        }
        rows[k] = own;
    }
    rows.iter().map(|row| row[n]).collect()
}

/// Checks the equations of the printed text at random states, with accelerations from Lagrange's equations
/// with multipliers. Returns the text.
pub(super) fn check_printed_equations(model: &Model<'_>) -> String {
    let joints = crate::kinematics::joints_of_model(model);
    let speeds = SpeedTransformation::new(model);
    let native = speeds.as_ref().map_or(model, |s| &s.native);
    let named = speeds.as_ref().map_or(model, |s| &s.model);
    let found = kane_equations(native, &joints, speeds.as_ref())
        .unwrap_or_else(|_| panic!("{} is short", model.name));
    let text = format_kane_equations(named, &found).plain;
    let lagrange = lagrange::derive(native, &joints);
    let (nv, nc) = (native.nv(), native.constraints.len());
    let rows = constraints::jacobian(native);
    let mut all =
        [lagrange.mass_matrix.concat(), lagrange.bias, forces::generalized_forces_of_inputs(native, &joints)]
            .concat();
    all.extend(rows.concat());
    all.extend(constraints::constraint_biases(native));
    all.extend(constraints::constraint_velocities(native));
    for seed in 1..8 {
        let at = random_symbol_values(native, seed);
        // Velocities that satisfy the constraints: the projection of random ones.
        let rates = eval(&[rows.concat(), constraints::constraint_velocities(native)].concat(), &at);
        let (j, rate) = rates.split_at(nv * nc);
        let gram = (0..nc).map(|i| {
            let product_of_jacobian_rows =
                |k: usize| (0..nv).map(|c| j[i * nv + c] * j[k * nv + c]).sum::<f64>();
            (0..nc).map(product_of_jacobian_rows).chain([rate[i]]).collect()
        });
        let shares = solve_linear_system(gram.collect());
        let v: Vec<f64> = (0..nv)
            .map(|c| {
                let own = at(Quantity::Velocity(c).symbol());
                own - (0..nc).map(|i| shares[i] * j[i * nv + c]).sum::<f64>()
            })
            .collect();
        let symbol_value_with_velocities = |s: Symbol| match Quantity::from_symbol(s) {
            Quantity::Velocity(k) => v[k],
            _ => at(s),
        };
        let values = eval(&all, &symbol_value_with_velocities);
        let (mass, rest) = values.split_at(nv * nv);
        let (bias, rest) = rest.split_at(nv);
        let (tau, rest) = rest.split_at(nv);
        let (j, rest) = rest.split_at(nv * nc);
        let (drift, left) = rest.split_at(nc);
        assert!(left.iter().all(|x| x.abs() < 1e-12), "{left:?}");
        let mut system: Vec<Vec<f64>> = (0..nv)
            .map(|i| {
                let multipliers = (0..nc).map(|k| -j[k * nv + i]);
                mass[i * nv..][..nv].iter().copied().chain(multipliers).chain([tau[i] - bias[i]]).collect()
            })
            .collect();
        system.extend((0..nc).map(|k| {
            j[k * nv..][..nv].iter().copied().chain(vec![0.0; nc]).chain([-drift[k]]).collect::<Vec<f64>>()
        }));
        let a = solve_linear_system(system)[..nv].to_vec();
        // Conversion to generalized speeds, if any.
        let (v, a) = match &speeds {
            None => (v, a),
            Some(speeds) => {
                let velocity_to_speed_matrix: Vec<Expr<'_>> = speeds.velocity_to_speed_matrix().concat();
                let y = eval(&velocity_to_speed_matrix, &symbol_value_with_velocities);
                let w: Vec<f64> = (0..nv).map(|i| (0..nv).map(|k| y[i * nv + k] * v[k]).sum()).collect();
                let symbol_value_with_speeds = |s: Symbol| match Quantity::from_symbol(s) {
                    Quantity::Velocity(k) => w[k],
                    _ => at(s),
                };
                let still = speeds.without_accelerations(&speeds.accelerations);
                let change = eval(&still, &symbol_value_with_speeds);
                let rates = (0..nv).map(|i| (0..nv).map(|k| y[i * nv + k] * (a[k] - change[k])).sum());
                let rates: Vec<f64> = rates.collect();
                (w, rates)
            }
        };
        let symbol_value_at_acceleration = |s: Symbol| match Quantity::from_symbol(s) {
            Quantity::Velocity(k) => v[k],
            Quantity::Acceleration(k) => a[k],
            _ => at(s),
        };
        for (motion, force) in found.motion.iter().zip(&found.forces) {
            let sides =
                [motion, force].map(|p| found.ring.evaluate_polynomial(p, &symbol_value_at_acceleration));
            let size = motion.terms.iter().map(|t| Polynomial { terms: vec![*t] });
            let size = size
                .map(|p| found.ring.evaluate_polynomial(&p, &symbol_value_at_acceleration).abs())
                .fold(1.0, f64::max);
            assert!((sides[0] - sides[1]).abs() <= 1e-10 * size, "{sides:?}, state {seed}: {text}");
        }
        let by_name = value_lookup_by_name(named, &symbol_value_at_acceleration);
        let lines = sides_of_equations(&text);
        assert!(lines.len() >= nv, "{text}");
        for (left, right) in &lines {
            // Rates of coordinates that speeds replace have no reference value here.
            if speeds.is_some() && left.ends_with('\'') && !left.contains(' ') {
                continue;
            }
            let line = format!("{left} = {right}");
            let (left, right) = (evaluate_text(left, &by_name), evaluate_text(right, &by_name));
            // Holonomic constraints are printed as residuals, which are not zero since the states are random.
            let residuals = eval(&constraints::residuals(native), &at);
            if residuals.iter().any(|x| (x - left).abs() < 1e-12 && right == 0.0) {
                continue;
            }
            let near = (left - right).abs() <= 1e-9 * (1.0 + left.abs());
            assert!(near, "{line}: {left} is not {right}, state {seed}");
        }
    }
    assert!(!text.contains("lambda"), "{text}");
    text
}

#[test]
fn printed_kane_equations_equal_the_dynamics() {
    for (gravity, item) in [
        ("-9.81 * y", SLEIGH),
        ("-9.81 * z", SLEIGH_IN_SPEEDS),
        ("-9.81 * z", WHEEL),
        ("-9.81 * z", DISK),
        ("-9.81 * z", ROLLING),
        ("-9.81 * y", CAM),
    ] {
        call_with_parsed_model(gravity, item, |model| {
            let text = check_printed_equations(&model);
            assert!(text.len() < 2500, "{text}");
        });
    }
}

/// The equations of the sleigh in the form of textbooks: m v' = m a ω² + push, (J + m a²) ω' = −m a v ω +
/// steer.
#[test]
fn sleigh_prints_textbook_equations_in_its_own_speeds() {
    let text = call_with_parsed_model("-9.81 * z", SLEIGH_IN_SPEEDS, |model| check_printed_equations(&model));
    let expected = "\
pose.x' = cos(pose.angle) along
pose.y' = sin(pose.angle) along
across = 0

m (along' - a pose.angle'²) = push
(m a² + j) pose.angle'' + m a along pose.angle' = steer

along and pose.angle' are the independent velocities; from them the others follow by blade.";
    assert!(text.starts_with(expected), "{text}");
}

/// Upright rolling: 3/2 m r² roll'' = drive, 1/4 m r² heading'' = steer.
#[test]
fn upright_wheel_prints_textbook_equations() {
    let text = call_with_parsed_model("-9.81 * z", WHEEL, |model| check_printed_equations(&model));
    assert!(text.contains("\n3/2 m r² roll'' = drive\n"), "{text}");
    assert!(text.contains("\n1/4 m r² heading'' = steer\n"), "{text}");
}
