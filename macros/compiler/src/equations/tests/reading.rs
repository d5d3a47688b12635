//! The printed linear equations, read back: against accelerations of Lagrange's equations, eigenvalues, and closed forms.

use super::*;
use num_complex::Complex;
use std::f64::consts::PI;

/// Values by name.
type Values<'a> = &'a dyn Fn(&str) -> f64;

/// A reader of printed sums: `1/2 m l² cos(theta)/(a + b)`.
struct Reader<'a> {
    rest: &'a str,
    values: Values<'a>,
}

fn value(text: &str, values: Values<'_>) -> f64 {
    let mut reader = Reader { rest: text, values };
    let found = reader.sum();
    assert_eq!(reader.rest, "", "{text}");
    found
}

impl Reader<'_> {
    fn take(&mut self, text: &str) -> bool {
        let rest = self.rest.strip_prefix(text);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn sum(&mut self) -> f64 {
        let mut sum = if self.take("-") { -self.product() } else { self.product() };
        loop {
            if self.take(" + ") {
                sum += self.product();
            } else if self.take(" - ") {
                sum -= self.product();
            } else {
                return sum;
            }
        }
    }

    fn product(&mut self) -> f64 {
        let mut product = self.factor();
        loop {
            let goes_on = !self.rest.starts_with(" + ") && !self.rest.starts_with(" - ");
            if self.take("/") {
                product /= self.factor();
            } else if goes_on && self.take(" ") {
                product *= self.factor();
            } else {
                return product;
            }
        }
    }

    fn factor(&mut self) -> f64 {
        if self.take("(") {
            let sum = self.sum();
            assert!(self.take(")"), "{}", self.rest);
            return sum.powi(self.power());
        }
        let is_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '\'');
        let powers = ['²', '³', '⁴', '⁵', '⁶', '⁷'];
        let end = self.rest.find(|c| !is_name(c) || powers.contains(&c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        let power = self.power();
        if self.take("(") {
            let argument = self.sum();
            assert!(self.take(")"), "{}", self.rest);
            let found = match word {
                "sqrt" => argument.sqrt(),
                "acos" => argument.acos(),
                "sin" => argument.sin(),
                "cos" => argument.cos(),
                other => panic!("the function {other}"),
            };
            return found.powi(power);
        }
        let found = if word == "pi" { PI } else { word.parse().unwrap_or_else(|_| (self.values)(word)) };
        found.powi(power)
    }

    fn power(&mut self) -> i32 {
        let powers = [("²", 2), ("³", 3), ("⁴", 4), ("⁵", 5), ("⁶", 6), ("⁷", 7)];
        powers.into_iter().find(|(sign, _)| self.take(sign)).map_or(1, |(_, power)| power)
    }
}

/// A printed text, taken apart.
#[derive(Default)]
struct Text {
    equations: Vec<(String, String)>,
    polynomial: String,
    frequency: String,
    verdict: String,
    conditions: Vec<String>,
}

impl Text {
    fn of(text: &str) -> Text {
        // Lines that go on are indented.
        let mut lines: Vec<String> = Vec::new();
        for line in text.lines() {
            let ends = lines.last().is_some_and(|last| last.contains(" = ") || last.ends_with("> 0"));
            match (line.strip_prefix("    "), lines.last_mut()) {
                (Some(more), Some(last))
                    if !last.is_empty()
                        && !last.ends_with("where")
                        && !last.ends_with("of")
                        && !last.ends_with(':')
                        && !last.ends_with(')')
                        && !(ends && last.ends_with(" 0") && last.starts_with(' ')) =>
                {
                    *last += &format!(" {}", more.trim_start());
                }
                _ => lines.push(line.to_string()),
            }
        }
        let mut found = Text::default();
        let mut after = false;
        for line in &lines {
            after |= line.starts_with("Motions");
            if let Some(condition) = line.strip_suffix(" > 0") {
                found.conditions.push(condition.trim_start().to_string());
            } else if let Some(polynomial) =
                line.strip_prefix("    ").and_then(|line| line.strip_suffix(" = 0"))
            {
                found.polynomial = polynomial.to_string();
            } else if let Some(frequency) = line.strip_prefix("    omega = ") {
                found.frequency = frequency.to_string();
            } else if line.contains("table") || line.contains("too long") {
                found.verdict.clone_from(line);
            } else if let Some((left, right)) =
                line.split_once(" = ").filter(|_| !after && !line.contains("; what is"))
            {
                found.equations.push((left.to_string(), right.to_string()));
            }
        }
        found
    }

    /// Coefficients of a name in all equations, of the left sides or of the right ones.
    fn column(&self, name: &str, right: bool, parameters: Values<'_>) -> Vec<f64> {
        let one = |word: &str| match word {
            _ if word == name => 1.0,
            _ if self.is_moving(word) => 0.0,
            _ => parameters(word),
        };
        self.equations.iter().map(|(a, b)| value(if right { b } else { a }, &one)).collect()
    }

    /// Names that are no parameters.
    fn is_moving(&self, word: &str) -> bool {
        [
            "lambda", "motor", "push", "thrust", "rail", "hinge", "shoulder", "elbow", "pose", "one", "two",
            "three", "theta", "power",
        ]
        .iter()
        .any(|name| word.starts_with(name))
    }

    /// Whether all conditions hold.
    fn holds(&self, parameters: Values<'_>) -> bool {
        self.conditions.iter().all(|condition| value(condition, parameters) > 0.0)
    }

    /// The coefficients of the characteristic polynomial by power, from its values.
    fn coefficients(&self, parameters: Values<'_>) -> Vec<f64> {
        let at = |s: f64| value(&self.polynomial, &|word| if word == "s" { s } else { parameters(word) });
        let degree =
            ["⁶", "⁵", "⁴", "³", "²"].iter().position(|p| self.polynomial.contains(&format!("s{p}")));
        let n = degree.map_or(1, |k| 6 - k);
        // Newton's differences at whole points, multiplied out.
        let points: Vec<f64> = (0..=n).map(|k| k as f64 - n as f64 / 2.0).collect();
        let mut table: Vec<f64> = points.iter().map(|s| at(*s)).collect();
        for order in 1..=n {
            for k in (order..=n).rev() {
                table[k] = (table[k] - table[k - 1]) / (points[k] - points[k - order]);
            }
        }
        let mut sum = vec![0.0; n + 1];
        for k in (0..=n).rev() {
            for power in (1..=n).rev() {
                sum[power] = sum[power - 1] - points[k] * sum[power];
            }
            sum[0] = table[k] - points[k] * sum[0];
        }
        sum
    }

    fn roots(&self, parameters: Values<'_>) -> Vec<Complex<f64>> {
        roots(&self.coefficients(parameters))
    }
}

/// The roots of a polynomial, by the iteration of Weierstrass, Durand and Kerner.
fn roots(c: &[f64]) -> Vec<Complex<f64>> {
    let n = c.len() - 1;
    let monic: Vec<f64> = c.iter().map(|x| x / c[n]).collect();
    let size = 1.0 + monic[..n].iter().map(|x| x.abs()).fold(0.0, f64::max).powf(0.5);
    let start = |k: usize| Complex::from_polar(size, 0.4 + 2.0 * PI * k as f64 / n as f64);
    let mut found: Vec<Complex<f64>> = (0..n).map(start).collect();
    for _ in 0..500 {
        for k in 0..n {
            let x = found[k];
            let value = monic.iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * x + c);
            let others: Complex<f64> = (0..n).filter(|j| *j != k).map(|j| x - found[j]).product();
            found[k] -= value / others;
        }
    }
    found
}

/// The eigenvalues of a matrix, from its characteristic polynomial by the method of Faddeev and Leverrier.
fn eigenvalues(a: &[Vec<f64>]) -> Vec<Complex<f64>> {
    let n = a.len();
    let mut c = vec![0.0; n + 1];
    c[n] = 1.0;
    let mut m = vec![vec![0.0; n]; n];
    for k in 1..=n {
        m = (0..n)
            .map(|i| {
                let entry = |j: usize| (0..n).map(|l| a[i][l] * m[l][j]).sum::<f64>();
                (0..n).map(|j| entry(j) + if i == j { c[n - k + 1] } else { 0.0 }).collect()
            })
            .collect();
        let trace: f64 = (0..n).map(|i| (0..n).map(|l| a[i][l] * m[l][i]).sum::<f64>()).sum();
        c[n - k] = -trace / k as f64;
    }
    roots(&c)
}

/// The roots of one list, each near one of another.
#[track_caller]
fn assert_same_roots(a: &[Complex<f64>], b: &[Complex<f64>], tolerance: f64) {
    assert_eq!(a.len(), b.len(), "{a:?} {b:?}");
    let mut left = b.to_vec();
    for root in a {
        let distance = |z: &Complex<f64>| (z - root).norm();
        let nearest = (0..left.len()).min_by(|x, y| distance(&left[*x]).total_cmp(&distance(&left[*y])));
        let nearest = left.remove(nearest.expect("as many"));
        assert!(distance(&nearest) < tolerance * (1.0 + root.norm()), "{a:?}\n{b:?}");
    }
}

/// A mechanism in numbers: accelerations of Lagrange's equations.
struct Numbers<'g> {
    nv: usize,
    forces: crate::expr::eval::Tape<'g>,
    quaternion: bool,
}

impl<'g> Numbers<'g> {
    fn of(model: &Model<'g>) -> Numbers<'g> {
        let joints = crate::kinematics::joints(model);
        let lagrange = lagrange::derive(model, &joints);
        let inputs = forces::generalized_forces(model, &joints);
        let mut all = lagrange.mass_matrix.concat();
        all.extend(inputs.iter().zip(&lagrange.bias).map(|(tau, bias)| *tau - *bias));
        let quaternion = model.nq() > model.nv();
        Numbers { nv: model.nv(), forces: crate::expr::eval::Tape::of(&all), quaternion }
    }

    fn accelerations(&self, q: &[f64], v: &[f64], u: &[f64], parameters: &[f64]) -> Vec<f64> {
        let values = self.forces.values(&|s| match Quantity::of(s) {
            Quantity::Parameter(k) => parameters[k],
            Quantity::Configuration(k) => q[k],
            Quantity::Velocity(k) => v[k],
            Quantity::Input(k) => u[k],
            _ => 0.0,
        });
        let (mass, force) = values.split_at(self.nv * self.nv);
        let mut rows: Vec<Vec<f64>> =
            (0..self.nv).map(|i| [&mass[i * self.nv..][..self.nv], &force[i..=i]].concat()).collect();
        // Symmetric and positive definite: pivots along the diagonal.
        for k in 0..self.nv {
            let own: Vec<f64> = rows[k].iter().map(|x| x / rows[k][k]).collect();
            for (i, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
                let (_, factor) = (i, row[k]);
                row.iter_mut().zip(&own).for_each(|(x, own)| *x -= factor * own);
            }
            rows[k] = own;
        }
        rows.iter().map(|row| row[self.nv]).collect()
    }

    /// The matrix of `ξ̇ = v`, `v̇ = a` about a state at rest, by differences; orientations are along the axes there.
    fn linear(&self, q: &[f64], u: &[f64], parameters: &[f64]) -> Vec<Vec<f64>> {
        let n = self.nv;
        let at = |k: usize, h: f64| {
            let (mut q, mut v) = (q.to_vec(), vec![0.0; n]);
            match (k < n, self.quaternion && k >= 3) {
                (true, true) => (q[k], q[6]) = ((h / 2.0).sin(), (h / 2.0).cos()),
                (true, false) => q[k] += h,
                (false, _) => v[k - n] = h,
            }
            self.accelerations(&q, &v, u, parameters)
        };
        let h = 1e-3;
        let slope = |k: usize| -> Vec<f64> {
            let ((a, b), (c, d)) = ((at(k, h), at(k, -h)), (at(k, 2.0 * h), at(k, -2.0 * h)));
            (0..n).map(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h)).collect()
        };
        let columns: Vec<Vec<f64>> = (0..2 * n).map(slope).collect();
        let upper = (0..n).map(|i| (0..2 * n).map(|k| f64::from(u8::from(k == n + i))).collect());
        upper.chain((0..n).map(|i| columns.iter().map(|column| column[i]).collect())).collect()
    }
}

/// The printed rows, solved for accelerations, against differences.
#[track_caller]
fn check_rows_of(text: &Text, names: &[&str], a: &[Vec<f64>], parameters: Values<'_>) {
    let n = names.len();
    let column = |name: &str, mark: &str| text.column(&format!("{name}{mark}"), false, parameters);
    let mass: Vec<Vec<f64>> = names.iter().map(|name| column(name, "''")).collect();
    for (k, mark) in (0..2 * n).map(|k| (k, if k < n { "" } else { "'" })) {
        let force = column(names[k % n], mark);
        // The inertia of the accelerations by differences, and the force: nothing is left.
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

/// What is written of all equilibria, with the mechanism in numbers.
fn read<R>(gravity: &str, item: &str, f: impl for<'g> FnOnce(Numbers<'g>, Vec<Text>) -> R) -> R {
    with_model(gravity, item, |model| {
        let joints = crate::kinematics::joints(&model);
        let mass = crba::mass_matrix(&model, &joints);
        let text = |at| {
            let mut cx = Diagnostics::new();
            let found = super::super::linear::linear(&model, &joints, &mass, at, &mut cx);
            let found = found.unwrap_or_else(|| panic!("{:?}", cx.messages()));
            Text::of(&super::super::linear::written_linear(&model, at, &found).plain)
        };
        let texts = model.equilibria.iter().map(text).collect();
        f(Numbers::of(&model), texts)
    })
}

/// Values of parameters by their names.
fn named<'a>(names: &'a [&str], values: &'a [f64]) -> impl Fn(&str) -> f64 + 'a {
    move |word| {
        let k = names.iter().position(|name| *name == word);
        values[k.unwrap_or_else(|| panic!("the name {word}"))]
    }
}

/// Random numbers in a range.
fn random(seed: u64, low: f64, high: f64) -> impl FnMut() -> f64 {
    let mut random = Random(2 * seed + 1);
    // The first numbers of a small seed are small.
    (0..20).for_each(|_| _ = random.below(2));
    move || low + (high - low) * random.below(100_000) as f64 / 100_000.0
}

fn largest(roots: &[Complex<f64>]) -> f64 {
    roots.iter().map(|z| z.re).fold(f64::MIN, f64::max)
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
fn rows_are_those_of_lagranges_equations() {
    let names = ["cart_mass", "pole_mass", "length", "stiffness", "damping"];
    let mut next = random(3, 0.3, 2.3);
    read("-9.81 * y", BALANCE, |numbers, texts| {
        for _ in 0..20 {
            let values: Vec<f64> = (0..5).map(|_| next()).collect();
            let parameters = named(&names, &values);
            for (text, angle) in texts.iter().zip([0.0, PI / 3.0]) {
                let torque = values[3] * angle - 9.81 * values[1] * values[2] / 2.0 * angle.sin();
                let a = numbers.linear(&[0.0, angle], &[0.0, torque], &values);
                check_rows_of(text, &["rail", "hinge"], &a, &parameters);
                let of_input = |name: &str| text.column(name, true, &parameters);
                assert_eq!([of_input("push"), of_input("motor")], [[1.0, 0.0], [0.0, 1.0]]);
                assert_same_roots(&text.roots(&parameters), &eigenvalues(&a), 1e-4);
            }
        }
    });
}

/// A craft that hovers: a thrust along its own axis holds it.
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
fn small_rotations_are_those_of_lagranges_equations() {
    let (names, values) = (["m", "a", "c", "arm", "drag"], [1.3, 0.2, 0.35, 0.1, 0.4]);
    let joints = ["pose.dx", "pose.dy", "pose.dz", "pose.rx", "pose.ry", "pose.rz"];
    read("-9.81 * z", CRAFT, |numbers, texts| {
        let a = numbers.linear(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &[9.81 * 1.3, 0.0], &values);
        check_rows_of(&texts[0], &joints, &a, &named(&names, &values));
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

/// The conditions of Liénard and Chipart against eigenvalues.
#[test]
fn conditions_of_three_masses_are_those_of_eigenvalues() {
    let names = ["k1", "k2", "k3", "d"];
    let mut next = random(5, -0.6, 2.2);
    read("0 * x", ROW, |numbers, texts| {
        let text = &texts[0];
        assert_eq!(text.verdict, "Asymptotically stable where");
        let (mut stable, mut unstable) = (0, 0);
        for _ in 0..400 {
            let values: Vec<f64> = (0..4).map(|_| next()).collect();
            let largest = largest(&eigenvalues(&numbers.linear(&[0.0; 3], &[], &values)));
            if largest.abs() > 1e-5 {
                assert_eq!(text.holds(&named(&names, &values)), largest < 0.0, "{values:?} {largest}");
                *(if largest < 0.0 { &mut stable } else { &mut unstable }) += 1;
            }
        }
        assert!(stable > 50 && unstable > 50, "{stable} {unstable}");
    });
}

/// Ziegler's column: two links on spring hinges, with a force that follows the last (Ziegler, *Ing.-Arch.* 20, 1952).
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

/// Without damping it flutters at `p l / k = 7/2 − √2`, the closed form of the literature.
#[test]
fn a_follower_force_makes_a_column_flutter() {
    let names = ["m", "l", "k", "p"];
    let mut next = random(9, 0.5, 2.5);
    read("0 * x", ZIEGLER, |numbers, texts| {
        let text = &texts[0];
        assert_eq!(text.verdict, "Stable, all deviations oscillate, where");
        for _ in 0..150 {
            let [m, l, k] = [next(), next(), next()];
            for (part, stable) in [(0.2, true), (0.999, true), (1.001, false), (1.4, false)] {
                let values = [m, l, k, part * (3.5 - 2.0_f64.sqrt()) * k / l];
                let parameters = named(&names, &values);
                assert_eq!(text.holds(&parameters), stable, "{part} {values:?}");
                let exact = eigenvalues(&numbers.linear(&[0.0; 2], &[], &values));
                assert_same_roots(&text.roots(&parameters), &exact, 1e-3);
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

/// Where it stays and how fast it oscillates there is in every textbook: `ω² = Ω² − g²/(R² Ω²)` at the side, `g/R − Ω²` below.
#[test]
fn a_bead_oscillates_about_both_equilibria() {
    let names = ["g", "m", "radius", "spin"];
    read("-g * z", HOOP, |numbers, texts| {
        for values in
            [[9.81, 0.7, 0.5, 6.0], [1.6, 0.7, 0.8, 2.1], [9.81, 0.7, 0.5, 4.0], [2.0, 0.3, 1.0, 1.0]]
        {
            let [g, _, radius, spin] = values;
            let parameters = named(&names, &values);
            let above = spin * spin * radius > g;
            assert_eq!([texts[0].holds(&parameters), texts[1].holds(&parameters)], [!above, above]);
            let [below, side] = [g / radius - spin * spin, spin * spin - (g / (radius * spin)).powi(2)];
            let square = |text: &Text| value(&text.frequency, &parameters).powi(2);
            let (found, expected) =
                if above { (square(&texts[1]), side) } else { (square(&texts[0]), below) };
            assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
            let angle = if above { (g / (spin * spin * radius)).acos() } else { 0.0 };
            let roots = eigenvalues(&numbers.linear(&[angle], &[], &values));
            assert_same_roots(&texts[usize::from(above)].roots(&parameters), &roots, 1e-6);
        }
    });
}

/// A carriage on a spring whose motor answers late to what it is told.
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

/// `lag m s³ + (m + lag c) s² + (c + lag k) s + k + gain`: Routh's condition of a cubic.
#[test]
fn a_lag_makes_control_unstable() {
    let names = ["m", "c", "k", "lag", "gain"];
    let mut next = random(12, 0.1, 2.1);
    read("0 * x", LATE, |_, texts| {
        let (mut stable, mut unstable) = (0, 0);
        for _ in 0..200 {
            let values = [next(), 0.3 * next(), next(), next(), next()];
            let [m, c, k, lag, gain] = values;
            let parameters = named(&names, &values);
            let cubic = [k + gain, c + lag * k, m + lag * c, lag * m];
            let expected = cubic[2] * cubic[1] > cubic[3] * cubic[0];
            assert_eq!(texts[0].holds(&parameters), expected, "{values:?}");
            *(if expected { &mut stable } else { &mut unstable }) += 1;
            assert_same_roots(&texts[0].roots(&parameters), &roots(&cubic), 1e-6);
        }
        assert!(stable > 20 && unstable > 20, "{stable} {unstable}");
    });
}

/// A ladder that slides on a wall and on the floor: two constraints, one degree of freedom.
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

/// Hanging below the floor it is a pendulum: `ω² = 3 g / (2 l)` by energy, `T = m l² θ̇² / 6`, `U = −m g l cos θ / 2`.
#[test]
fn a_constrained_ladder_is_a_pendulum() {
    read("-9.81 * y", LADDER, |_, texts| {
        for values in [[1.0, 2.0], [0.4, 0.7]] {
            let parameters = named(&["m", "l"], &values);
            let square = value(&texts[0].frequency, &parameters).powi(2);
            assert!((square - 1.5 * 9.81 / values[1]).abs() < 1e-12 * square, "{square}");
            let roots = texts[0].roots(&parameters);
            assert_eq!(roots.len(), 2);
            assert!(roots.iter().all(|z| (z * z + square).norm() < 1e-9 * square), "{roots:?}");
        }
    });
}
