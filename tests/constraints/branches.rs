//! Random closed chains in singular positions and driven through them, against the few coordinates that their branches have:
//! masses over twelve powers of ten, springs of up to a million N·m/rad, and planes that are tilted at random.

use linkwork::integrate::Method;
use linkwork::prelude::*;
use std::f64::consts::PI;
use support::random::Random;

/// A four-bar linkage of rods along `$along` in the plane across `$about`, with springs on its pins.
macro_rules! four_bar {
    ($name:ident, $about:expr, $along:expr, $gravity:expr) => {
        #[mechanism(gravity = down * $gravity + aside * $along)]
        #[derive(Clone, Copy, Debug)]
        struct $name {
            down: f64,
            aside: f64,
            base: f64,
            l1: f64,
            l2: f64,
            l3: f64,
            m1: f64,
            m2: f64,
            m3: f64,
            k1: f64,
            k2: f64,
            k3: f64,
            free: f64,
            #[body(mass = m1, com = l1 / 2 * $along, inertia = rod(m1, l1, $along))]
            crank: Body,
            #[body(mass = m2, com = l2 / 2 * $along, inertia = rod(m2, l2, $along))]
            coupler: Body,
            #[body(mass = m3, com = l3 / 2 * $along, inertia = rod(m3, l3, $along))]
            rocker: Body,
            #[joint(ground -> crank, about = $about)]
            first: Pin,
            #[joint(crank.at(l1 * $along) -> coupler, about = $about)]
            second: Pin,
            #[joint(ground.at(base * $along) -> rocker, about = $about)]
            third: Pin,
            #[joint(rocker.at(l3 * $along) -> coupler.at(l2 * $along), about = $about)]
            closing: Pin,
            #[acts(on = first, stiffness = k1, free_angle = free)]
            s1: Spring,
            #[acts(on = second, stiffness = k2, free_angle = 0)]
            s2: Spring,
            #[acts(on = third, stiffness = k3, free_angle = free / 2)]
            s3: Spring,
        }

        impl $name {
            fn random(random: &mut Random, style: &Style, lengths: [f64; 4]) -> Self {
                let [base, l1, l2, l3] = lengths;
                let (mut mass, angle) = (|| style.mass(random), 2.0);
                let [m1, m2, m3] = [mass(), mass(), mass()];
                let mut stiffness = || style.stiffness(random);
                let [k1, k2, k3] = [stiffness(), stiffness(), stiffness()];
                let turn = random.uniform(PI);
                let (aside, down) = (9.81 * turn.sin(), 9.81 * turn.cos());
                let free = random.uniform(angle);
                Self { down, aside, base, l1, l2, l3, m1, m2, m3, k1, k2, k3, free }
            }
        }
    };
}

four_bar!(FourBar, z, x, y);
four_bar!(Tilted, unit(x + 2 * y + 2 * z), (2 * x + y - 2 * z) / 3, (2 * x - 2 * y + z) / 3);

/// A window that stands on another, of posts of equal length each.
#[mechanism(gravity = down * y + aside * x)]
#[derive(Clone, Copy, Debug)]
struct Stacked {
    down: f64,
    aside: f64,
    low: f64,
    high: f64,
    width: f64,
    shelf: f64,
    m1: f64,
    m2: f64,
    m3: f64,
    m4: f64,
    m5: f64,
    m6: f64,
    k1: f64,
    k2: f64,
    k3: f64,
    k4: f64,
    #[body(mass = m1, com = low / 2 * x, inertia = rod(m1, low, x))]
    left: Body,
    #[body(mass = m2, com = width / 2 * x, inertia = rod(m2, width, x))]
    beam: Body,
    #[body(mass = m3, com = low / 2 * x, inertia = rod(m3, low, x))]
    right: Body,
    #[body(mass = m4, com = high / 2 * x, inertia = rod(m4, high, x))]
    post: Body,
    #[body(mass = m5, com = shelf / 2 * x, inertia = rod(m5, shelf, x))]
    top: Body,
    #[body(mass = m6, com = high / 2 * x, inertia = rod(m6, high, x))]
    prop: Body,
    #[joint(ground -> left, about = z)]
    first: Pin,
    #[joint(left.at(low * x) -> beam, about = z)]
    second: Pin,
    #[joint(ground.at(width * x) -> right, about = z)]
    third: Pin,
    #[joint(right.at(low * x) -> beam.at(width * x), about = z)]
    close: Pin,
    #[joint(beam.at(width / 4 * x) -> post, about = z)]
    fourth: Pin,
    #[joint(post.at(high * x) -> top, about = z)]
    fifth: Pin,
    #[joint(beam.at((width / 4 + shelf) * x) -> prop, about = z)]
    sixth: Pin,
    #[joint(prop.at(high * x) -> top.at(shelf * x), about = z)]
    shut: Pin,
    #[acts(on = first, stiffness = k1, free_angle = 0.3)]
    s1: Spring,
    #[acts(on = second, stiffness = k2, free_angle = 0)]
    s2: Spring,
    #[acts(on = fourth, stiffness = k3, free_angle = 0)]
    s3: Spring,
    #[acts(on = fifth, stiffness = k4, free_angle = -0.2)]
    s4: Spring,
}

/// Three windows in a row.
#[mechanism(gravity = down * y + aside * x)]
#[derive(Clone, Copy, Debug)]
struct Row {
    down: f64,
    aside: f64,
    post: f64,
    w1: f64,
    w2: f64,
    w3: f64,
    m1: f64,
    m2: f64,
    m3: f64,
    m4: f64,
    k1: f64,
    k2: f64,
    k3: f64,
    #[body(mass = m1, com = post / 2 * x, inertia = rod(m1, post, x))]
    p0: Body,
    #[body(mass = m2, com = w1 / 2 * x, inertia = rod(m2, w1, x))]
    b1: Body,
    #[body(mass = m3, com = post / 2 * x, inertia = rod(m3, post, x))]
    p1: Body,
    #[body(mass = m4, com = w2 / 2 * x, inertia = rod(m4, w2, x))]
    b2: Body,
    #[body(mass = m1, com = post / 2 * x, inertia = rod(m1, post, x))]
    p2: Body,
    #[body(mass = m2, com = w3 / 2 * x, inertia = rod(m2, w3, x))]
    b3: Body,
    #[body(mass = m3, com = post / 2 * x, inertia = rod(m3, post, x))]
    p3: Body,
    #[joint(ground -> p0, about = z)]
    first: Pin,
    #[joint(p0.at(post * x) -> b1, about = z)]
    second: Pin,
    #[joint(ground.at(w1 * x) -> p1, about = z)]
    third: Pin,
    #[joint(p1.at(post * x) -> b2, about = z)]
    fourth: Pin,
    #[joint(ground.at((w1 + w2) * x) -> p2, about = z)]
    fifth: Pin,
    #[joint(p2.at(post * x) -> b3, about = z)]
    sixth: Pin,
    #[joint(ground.at((w1 + w2 + w3) * x) -> p3, about = z)]
    seventh: Pin,
    #[joint(b1.at(w1 * x) -> p1.at(post * x), about = z)]
    close1: Pin,
    #[joint(b2.at(w2 * x) -> p2.at(post * x), about = z)]
    close2: Pin,
    #[joint(b3.at(w3 * x) -> p3.at(post * x), about = z)]
    close3: Pin,
    #[acts(on = second, stiffness = k1, free_angle = 0.5)]
    s1: Spring,
    #[acts(on = fifth, stiffness = k2, free_angle = 0)]
    s2: Spring,
    #[acts(on = sixth, stiffness = k3, free_angle = 0)]
    s3: Spring,
}

/// How masses and springs are spread, in powers of ten.
struct Style {
    masses: f64,
    springs: f64,
}

impl Style {
    fn mass(&self, random: &mut Random) -> f64 {
        10_f64.powf(random.uniform(self.masses))
    }

    /// One spring in three is none.
    fn stiffness(&self, random: &mut Random) -> f64 {
        if random.uniform(1.0) < -0.33 { 0.0 } else { 10_f64.powf(random.uniform(self.springs)) }
    }
}

/// A number with its first and second derivative.
#[derive(Clone, Copy)]
struct Jet([f64; 3]);

impl Jet {
    /// A function of it with these derivatives.
    fn map(self, f: [f64; 3]) -> Jet {
        let [_, d, dd] = self.0;
        Jet([f[0], f[1] * d, f[2] * d * d + f[1] * dd])
    }

    fn sin(self) -> Jet {
        let (s, c) = self.0[0].sin_cos();
        self.map([s, c, -s])
    }

    fn cos(self) -> Jet {
        let (s, c) = self.0[0].sin_cos();
        self.map([c, -s, -c])
    }

    fn times(self, o: Jet) -> Jet {
        let ([a, b, c], [d, e, f]) = (self.0, o.0);
        Jet([a * d, b * d + a * e, c * d + 2.0 * b * e + a * f])
    }

    fn plus(self, o: Jet) -> Jet {
        Jet(core::array::from_fn(|k| self.0[k] + o.0[k]))
    }

    fn scaled(self, by: f64) -> Jet {
        Jet(self.0.map(|x| x * by))
    }

    fn add(self, x: f64) -> Jet {
        self.plus(Jet([x, 0.0, 0.0]))
    }

    fn root(self) -> Jet {
        let x = self.0[0].sqrt();
        self.map([x, 0.5 / x, -0.25 / (x * x * x)])
    }

    fn inverse(self) -> Jet {
        let x = 1.0 / self.0[0];
        self.map([x, -x * x, 2.0 * x * x * x])
    }

    fn atan2(y: Jet, x: Jet) -> Jet {
        // The derivative is (x y' − y x') / (x² + y²), in jets of one order less.
        let ([y0, y1, y2], [x0, x1, x2]) = (y.0, x.0);
        let square = x0 * x0 + y0 * y0;
        let first = (x0 * y1 - y0 * x1) / square;
        let second = (x0 * y2 - y0 * x2) / square - first * 2.0 * (x0 * x1 + y0 * y1) / square;
        Jet([y0.atan2(x0), first, second])
    }
}

/// Angles of coupler, against the crank, and rocker of a four-bar linkage that is flat where its crank is at `π`
/// (`l1 + base = l2 + l3`) or at zero (`±(l1 − base) = l2 − l3`), over the angle of the crank.
///
/// With the distance `D` between the crank's tip and the rocker's foot, the height of the triangle of coupler and rocker over
/// it is a root of `((l2 + l3)² − D²)(D² − (l2 − l3)²)`. One of the factors is a square: `4 base l1 cos²(θ/2)` or
/// `4 base l1 sin²(θ/2)`, and the branch goes on where its root changes sign.
fn flat_branch([base, l1, l2, l3]: [f64; 4], at_pi: bool, theta: f64, side: f64) -> [Jet; 3] {
    let theta = Jet([theta, 1.0, 0.0]);
    let (c, s) = (theta.cos(), theta.sin());
    // From the crank's tip to the rocker's foot.
    let (dx, dy) = (c.scaled(-l1).add(base), s.scaled(-l1));
    let square = dx.times(dx).plus(dy.times(dy));
    let half = theta.scaled(0.5);
    let width = 2.0 * (base * l1).sqrt();
    let (near, far) = (square.add(-(l2 - l3) * (l2 - l3)), square.scaled(-1.0).add((l2 + l3) * (l2 + l3)));
    let height = match at_pi {
        true => half.cos().scaled(width).times(near.root()),
        false => half.sin().scaled(width).times(far.root()),
    };
    // Twice D times the triangle's foot and height.
    let (along, across) = (square.add(l2 * l2 - l3 * l3), height.scaled(side));
    let over = square.scaled(2.0).inverse();
    let tip = |a: Jet, b: Jet, c: Jet, d: Jet| a.times(b).plus(c.times(d)).times(over);
    let (px, py) = (tip(along, dx, across.scaled(-1.0), dy), tip(along, dy, across, dx));
    let coupler = Jet::atan2(py, px);
    let rocker = Jet::atan2(py.plus(dy.scaled(-1.0)), px.plus(dx.scaled(-1.0)));
    [theta, coupler.plus(theta.scaled(-1.0)), rocker]
}

/// A branch at a point: where it is, how all coordinates change with `N` of them, and second derivatives along the motion.
struct Branch<const NV: usize, const N: usize> {
    q: SVector<f64, NV>,
    by: SMatrix<f64, NV, N>,
    bend: SVector<f64, NV>,
    rate: SVector<f64, N>,
}

impl<const NV: usize, const N: usize> Branch<NV, N> {
    fn velocity(&self) -> SVector<f64, NV> {
        self.by * self.rate
    }

    /// The acceleration on the branch by Lagrange's equations for its own coordinates, and what to expect of rounding.
    fn acceleration<M>(&self, m: &M) -> (SVector<f64, NV>, f64)
    where
        M: Mechanism<NV, NV, 0, Scalar = f64>,
    {
        let (v, mass) = (self.velocity(), m.mass_matrix(&self.q));
        let bias = m.bias_forces(&self.q, &v);
        let own = self.by.transpose() * mass * self.by;
        let force = bias + mass * self.bend;
        let solve = |f: SVector<f64, N>| {
            // One or two coordinates.
            let mut x = SVector::<f64, N>::zeros();
            if N == 1 {
                x[0] = f[0] / own[(0, 0)];
            } else {
                let det = own[(0, 0)] * own[(1, 1)] - own[(0, 1)] * own[(1, 0)];
                x[0] = (f[0] * own[(1, 1)] - f[1] * own[(0, 1)]) / det;
                x[1] = (f[1] * own[(0, 0)] - f[0] * own[(1, 0)]) / det;
            }
            x
        };
        let a = self.by * solve(-(self.by.transpose() * force)) + self.bend;
        // What single forces would do, by how much their bodies move, which is known to a part of 1e-11 m or rad, not better.
        let moved = |k: usize| {
            let by = self.by.row(k).map(|by| by.signum() * by.abs().max(1e-2)).transpose();
            (self.by * solve(by * bias[k])).amax()
        };
        let most = (0..NV).map(moved).fold(0.0, f64::max);
        // Light bodies with stiff springs would do much if nothing held them: what holds them rounds as that does.
        let free = mass.cholesky().map_or(0.0, |mass| mass.solve(&bias).amax());
        (a, most + free * 1e-3)
    }
}

/// How far the acceleration is off, in shares of what to expect. Others are branches of machines whose lengths differ by parts
/// of 1e-11: what they make of the acceleration is what is lost where lengths and places are not known better.
fn off<M, const NV: usize, const N: usize>(m: &M, branch: &Branch<NV, N>, others: &[Branch<NV, N>]) -> f64
where
    M: Mechanism<NV, NV, 0, Scalar = f64>,
{
    let v = branch.velocity();
    let found = m.forward_dynamics(&branch.q, &v, &SVector::zeros());
    let (want, most) = branch.acceleration(m);
    let by_lengths = others.iter().map(|other| (other.acceleration(m).0 - want).amax());
    let by_lengths = by_lengths.filter(|change| change.is_finite()).fold(0.0, f64::max);
    let expected = 1e-6 * (want.amax() + v.norm_squared()) + 1e-9 * most + 0.1 * by_lengths;
    let off = (found - want).amax() / expected;
    if off.is_nan() { f64::INFINITY } else { off }
}

/// Which seeds of each kind are looked at: as many as usual, or as the variable `LINKWORK_ORACLE` says, `20000` or `400..405`.
fn cases(usual: u64) -> std::ops::Range<u64> {
    let asked = std::env::var("LINKWORK_ORACLE").unwrap_or_default();
    let (from, to) = asked.split_once("..").unwrap_or(("0", &asked));
    from.parse().unwrap_or(0)..to.parse().unwrap_or(usual)
}

const STYLES: [Style; 4] = [
    Style { masses: 0.5, springs: 1.0 },
    Style { masses: 0.5, springs: 6.0 },
    Style { masses: 3.0, springs: 3.0 },
    Style { masses: 6.0, springs: 6.0 },
];

/// Far from a flat position, near, in it but for rounding, or exactly there; and a rate, one in eight at rest.
fn approach(random: &mut Random, flat: f64) -> (f64, f64) {
    let distance = 10_f64.powf(-8.0 - random.uniform(8.0)) * random.uniform(1.0).signum();
    let distance = if random.uniform(1.0) > 0.9 { 0.0 } else { distance };
    let rate = 10_f64.powf(random.uniform(1.5)) * random.uniform(1.0).signum();
    // At rest in a flat position nothing tells the branches from each other.
    let still = random.uniform(1.0) > 0.75 && distance.abs() > 1e-6;
    (flat + distance, if still { 0.0 } else { rate })
}

/// Lengths of a linkage that is flat at `π` or at zero, which of the two, and the angle.
fn flat_lengths(random: &mut Random) -> ([f64; 4], bool, f64) {
    let mut length = || 1.0 + random.uniform(0.7);
    let (base, l1, l2) = (length(), length(), length());
    let (outer, inner) = (base + l1 - l2, l2 - (l1 - base).abs());
    // In a kite that is folded the coupler turns alone, or coupler and crank, and the others stand still.
    if random.uniform(1.0) > 0.5 {
        return ([base, l1, l1, base], true, PI);
    }
    if random.uniform(1.0) > 0.0 && outer > 0.3 {
        ([base, l1, l2, outer], true, PI)
    } else if inner > 0.3 {
        ([base, l1, l2, inner], false, 0.0)
    } else {
        ([base, l1, l1, base], true, PI)
    }
}

fn parallelogram(angle: f64, rate: f64) -> Branch<3, 1> {
    let by = SVector::from([1.0, -1.0, 1.0]);
    Branch { q: by * angle, by, bend: SVector::zeros(), rate: [rate].into() }
}

fn flat(lengths: [f64; 4], at_pi: bool, side: f64, angle: f64, rate: f64) -> Branch<3, 1> {
    let jets = flat_branch(lengths, at_pi, angle, side);
    let part = |k: usize| SVector::<f64, 3>::from_fn(|i, _| jets[i].0[k]);
    Branch { q: part(0), by: part(1), bend: part(2) * rate * rate, rate: [rate].into() }
}

/// The lengths with one of the first three longer by a part of 1e-11, and the last so that the linkage is flat all the same.
fn nearly([base, l1, l2, l3]: [f64; 4], at_pi: bool, which: usize) -> [f64; 4] {
    let mut lengths = [base, l1, l2, l3];
    lengths[which] *= 1.0 + 1e-11;
    let of = |[base, l1, l2, _]: [f64; 4]| if at_pi { base + l1 - l2 } else { l2 - (l1 - base).abs() };
    lengths[3] = l3 + (of(lengths) - of([base, l1, l2, l3]));
    lengths
}

/// Seeds of later cases that were hard: a kite with a heavy body at rest, windows of which one turns much faster, and a linkage
/// whose lengths differ by 7e-5 from those of a kite that folds: 1e-11 of them is 2e-4 of its acceleration.
const HARD: [u64; 5] = [4_647, 4_958, 17_407, 66_896, 862_310];

/// Accelerations everywhere on the branches, in all styles.
fn check(kind: &str, usual: u64, case: impl Fn(&mut Random, &Style) -> (f64, String)) {
    for seed in cases(usual).chain(HARD) {
        let mut random = Random::new(seed);
        let style = &STYLES[seed as usize % 4];
        let (off, what) = case(&mut random, style);
        // Of the lightest bodies fewer digits are left, and where another coordinate is much faster than the one that leads out.
        let most = if style.masses > 3.0 || kind == "stack" { 1e2 } else { 1e1 };
        assert!(off < most, "{kind}, seed {seed}: off by {off} times what is expected, {what}");
    }
}

#[test]
fn parallelograms_accelerate_as_pendulums() {
    check("parallelogram", 4000, |random, style| {
        let (base, l1) = (1.0 + random.uniform(0.7), 1.0 + random.uniform(0.7));
        let flat = if random.uniform(1.0) > 0.0 { PI } else { 0.0 };
        let (angle, rate) = approach(random, flat);
        let branch = parallelogram(angle, rate);
        let tilted = Tilted::random(random, style, [base, l1, base, l1]);
        let plain = FourBar::random(random, style, [base, l1, base, l1]);
        let most = off(&tilted, &branch, &[]).max(off(&plain, &branch, &[]));
        (most, format!("at {:e} from {flat}, {rate} rad/s, {plain:?} {tilted:?}", angle - flat))
    });
}

#[test]
fn flat_linkages_accelerate_along_their_branch() {
    check("four-bar", 4000, |random, style| {
        let (lengths, at_pi, angle) = flat_lengths(random);
        let side = random.uniform(1.0).signum();
        let mut approach = || {
            let (theta, rate) = approach(random, angle);
            (theta, rate, flat(lengths, at_pi, side, theta, rate))
        };
        // A crank that is longer than the others together allow does not reach every angle.
        let (theta, rate, branch) = std::iter::repeat_with(&mut approach)
            .find(|(.., branch)| branch.q.iter().chain(&branch.bend).all(|x| x.is_finite()))
            .expect("the flat position itself is reached");
        let tilted = Tilted::random(random, style, lengths);
        let plain = FourBar::random(random, style, lengths);
        let others: Vec<Branch<3, 1>> =
            (0..3).map(|k| flat(nearly(lengths, at_pi, k), at_pi, side, theta, rate)).collect();
        let most = off(&tilted, &branch, &others).max(off(&plain, &branch, &others));
        (most, format!("at {:e} from {angle}, {rate} rad/s, {plain:?} {tilted:?}", theta - angle))
    });
}

#[test]
fn windows_accelerate_as_pendulums() {
    check("row", 2000, |random, style| {
        let flat = if random.uniform(1.0) > 0.0 { PI } else { 0.0 };
        let (angle, rate) = approach(random, flat);
        let by = SVector::from([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0]);
        let branch = Branch { q: by * angle, by, bend: SVector::zeros(), rate: [rate].into() };
        let mut length = || 1.0 + random.uniform(0.7);
        let (post, w1, w2, w3) = (length(), length(), length(), length());
        let turn = random.uniform(PI);
        let [m1, m2, m3, m4] = core::array::from_fn(|_| style.mass(random));
        let [k1, k2, k3] = core::array::from_fn(|_| style.stiffness(random));
        let (aside, down) = (9.81 * turn.sin(), 9.81 * turn.cos());
        let row = Row { down, aside, post, w1, w2, w3, m1, m2, m3, m4, k1, k2, k3 };
        (off(&row, &branch, &[]), format!("at {:e} from {flat}, {rate} rad/s, {row:?}", angle - flat))
    });
}

fn stacked(random: &mut Random, style: &Style) -> Stacked {
    let mut length = || 1.0 + random.uniform(0.7);
    let (low, high, width, shelf) = (length(), length(), length(), length());
    let turn = random.uniform(PI);
    let [m1, m2, m3, m4, m5, m6] = core::array::from_fn(|_| style.mass(random));
    let [k1, k2, k3, k4] = core::array::from_fn(|_| style.stiffness(random));
    let (aside, down) = (9.81 * turn.sin(), 9.81 * turn.cos());
    Stacked { down, aside, low, high, width, shelf, m1, m2, m3, m4, m5, m6, k1, k2, k3, k4 }
}

fn stack(angles: [f64; 2], rates: [f64; 2]) -> Branch<6, 2> {
    let by = SMatrix::<f64, 6, 2>::new(1.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0, 1.0);
    Branch { q: by * SVector::from(angles), by, bend: SVector::zeros(), rate: rates.into() }
}

/// One of the windows is flat, or both are.
#[test]
fn stacked_windows_accelerate_as_two_pendulums() {
    check("stack", 2000, |random, style| {
        // Posts in line with each other move heavy bodies alike: two coordinates are as good as one then.
        let style = &Style { masses: style.masses.min(1.0), springs: style.springs };
        let (low, first) = approach(random, 0.0);
        let (near, second) = approach(random, PI);
        let high = if random.uniform(1.0) > 0.0 { near } else { random.uniform(1.0) };
        let moving = |rate: f64, other: f64| if rate == 0.0 { other } else { rate };
        let (first, second) = (moving(first, 0.4), moving(second, -0.7));
        let stacked = stacked(random, style);
        let off = off(&stacked, &stack([low, high], [first, second]), &[]);
        (
            off,
            format!("at {low:e} and {high:e} = π + {:e}, {first} and {second} rad/s, {stacked:?}", high - PI),
        )
    });
}

/// What every method makes of a motion that leads through flat positions: how far it is off at its end, beside another method
/// with short steps on the same machine with its own coordinates, where there is one.
fn gain<M, S, const NV: usize>(
    m: &M,
    (q, v): (SVector<f64, NV>, SVector<f64, NV>),
    end: f64,
    method: S,
) -> Result<f64, Error>
where
    M: Mechanism<NV, NV, 0, Scalar = f64>,
    S: Method<f64>,
{
    let energy = |q: &_, v: &_| m.kinetic_energy(q, v) + m.potential_energy(q);
    let start = energy(&q, &v);
    let end = simulate(m).from(q, v).method(method).duration(end).finish()?;
    Ok((energy(&end.q, &end.v) - start).abs())
}

/// Motions that go through flat positions at random places of their steps keep their energy.
#[test]
fn random_linkages_keep_their_energy_through_flat_positions() {
    for seed in cases(60) {
        let mut random = Random::new(1000 + seed);
        let style = Style { masses: 0.3 + (seed % 3) as f64, springs: 2.0 + 2.0 * (seed % 3) as f64 };
        let (lengths, at_pi, angle) = flat_lengths(&mut random);
        let side = random.uniform(1.0).signum();
        let m = FourBar::random(&mut random, &style, lengths);
        let rate = 6.0 + random.uniform(3.0);
        let branch = flat(lengths, at_pi, side, angle - 0.3 - random.uniform(0.1), rate);
        let state = (branch.q, branch.velocity());
        let end = 0.1;
        // Steps that resolve the fastest turn and the stiffest swing on the way.
        let (mut fast, mut stiff) = (rate, 0.0_f64);
        let mut whole = 0.0_f64;
        // Adaptive steps see what is faster than a grid of samples.
        for sample in simulate(&m).from(state.0, state.1).duration(end) {
            let Sample { q, v, .. } = sample.unwrap_or_else(|e| panic!("seed {seed}: {e} with {m:?}"));
            let swing = m.k1 * v[0] * v[0] + m.k2 * v[1] * v[1] + m.k3 * v[2] * v[2];
            let kinetic = m.kinetic_energy(&q, &v);
            whole = whole.max(kinetic);
            fast = fast.max(v.amax());
            stiff = stiff.max(swing / (2.0 * kinetic));
        }
        let h = 2e-3_f64.min(0.02 / fast).min(0.05 / stiff.sqrt());
        let end = end.min(2000.0 * h);
        let check = |name: &str, found: Result<f64, Error>, most: f64| {
            let share = found.map(|gain| gain / whole);
            assert!(
                share.is_ok_and(|share| share < most),
                "seed {seed}, {name}, {h} s: {share:?} of {whole} J, {rate} rad/s, {m:?}"
            );
        };
        check("Runge–Kutta", gain(&m, state, end, Rk4::step(h)), 1e-3);
        check("Dormand–Prince", gain(&m, state, end, DormandPrince::new()), 1e-4);
        check("midpoint", gain(&m, state, end, ImplicitMidpoint::step(h)), 1e-2);
        check("Euler", gain(&m, state, end, SemiImplicitEuler::step(h)), 0.2);
    }
}
