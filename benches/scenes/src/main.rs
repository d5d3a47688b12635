//! Random scenes of up to ten bodies that fall on each other, and times of their steps.
//!
//! ```sh
//! cargo run --release -- 100          # a hundred scenes of each family, and the fixed scenes of mujoco_scenes.py
//! cargo run --release -- 100 5000     # those with seeds from 5000 on
//! cargo run --release -- 100 0 Boxes3 # one family
//! python mujoco_scenes.py                    # the fixed scenes in MuJoCo
//! ```
//!
//! A row has the number of runs, of runs that ended with an error and of those with NaN; microseconds of a
//! step in time of the thread; the largest growth of the energy in a step as a part of the energy at the
//! start; the deepest penetration as a part of the smallest size; steps that violate the contact conditions
//! by more than 1e-6 m/s, and the largest violation.

use linkwork::contact::Contacts;
use linkwork::prelude::*;
use linkwork::simulate::Overlaps;
use rustix::time::{ClockId, clock_gettime};

/// Declares a mechanism of boxes on the ground and on each other. The contact pairs are listed by the
/// difference of the boxes' indices; each box has `exp(grade)` times the mass of the previous one, and
/// `exp(taper)` times its lengths.
macro_rules! boxes {
    ($name:ident, $n:tt, $($d:tt $field:ident $count:tt),*) => {
        #[mechanism(gravity = -9.81 * z)]
        struct $name {
            mass: f64,
            grade: f64,
            a: f64,
            b: f64,
            c: f64,
            taper: f64,
            mu: f64,
            e: f64,
            #[body(
                mass = mass * exp(grade * i),
                inertia = cuboid(mass * exp(grade * i), a * exp(taper * i), b * exp(taper * i), c * exp(taper * i))
            )]
            block: [Body; $n],
            #[joint(ground -> block[i])]
            pose: [Free; $n],
            #[contact(
                block[i].cuboid(a * exp(taper * i), b * exp(taper * i), c * exp(taper * i)),
                ground.plane(z),
                friction = mu,
                restitution = e
            )]
            floor: [Contact; $n],
            $(#[contact(
                block[i].cuboid(a * exp(taper * i), b * exp(taper * i), c * exp(taper * i)),
                block[i + $d].cuboid(a * exp(taper * (i + $d)), b * exp(taper * (i + $d)), c * exp(taper * (i + $d))),
                friction = mu,
                restitution = e
            )]
            $field: [Contact; $count],)*
        }
    };
}
boxes!(Boxes2, 2, 1 one 1);
boxes!(Boxes3, 3, 1 one 2, 2 two 1);
boxes!(Dominoes, 5, 1 one 4);

/// Six balls in contact with the ground and with each other.
#[mechanism(gravity = -9.81 * z)]
struct Balls {
    mass: f64,
    grade: f64,
    r: f64,
    taper: f64,
    mu: f64,
    e: f64,
    #[body(mass = mass * exp(grade * i), inertia = sphere(mass * exp(grade * i), r * exp(taper * i)))]
    ball: [Body; 6],
    #[joint(ground -> ball[i])]
    pose: [Free; 6],
    #[contact(ball[i].sphere(r * exp(taper * i)), ground.plane(z), friction = mu, restitution = e)]
    floor: [Contact; 6],
    #[contact(
        ball[i].sphere(r * exp(taper * i)), ball[i + 1].sphere(r * exp(taper * (i + 1))), friction = mu,
        restitution = e
    )]
    one: [Contact; 5],
    #[contact(
        ball[i].sphere(r * exp(taper * i)), ball[i + 2].sphere(r * exp(taper * (i + 2))), friction = mu,
        restitution = e
    )]
    two: [Contact; 4],
    #[contact(
        ball[i].sphere(r * exp(taper * i)), ball[i + 3].sphere(r * exp(taper * (i + 3))), friction = mu,
        restitution = e
    )]
    three: [Contact; 3],
    #[contact(
        ball[i].sphere(r * exp(taper * i)), ball[i + 4].sphere(r * exp(taper * (i + 4))), friction = mu,
        restitution = e
    )]
    four: [Contact; 2],
    #[contact(
        ball[i].sphere(r * exp(taper * i)), ball[i + 5].sphere(r * exp(taper * (i + 5))), friction = mu,
        restitution = e
    )]
    five: [Contact; 1],
}

/// Capsules in contact with the ground and with each other.
#[mechanism(gravity = -9.81 * z)]
struct Capsules4 {
    mass: f64,
    pub grade: f64,
    pub r: f64,
    pub l: f64,
    pub mu: f64,
    pub e: f64,
    #[body(mass = mass * exp(grade * i), inertia = capsule(mass * exp(grade * i), r, l, x))]
    log: [Body; 4],
    #[joint(ground -> log[i])]
    pose: [Free; 4],
    #[contact(log[i].capsule(r, l, x), ground.plane(z), friction = mu, restitution = e)]
    floor: [Contact; 4],
    #[contact(log[i].capsule(r, l, x), log[i + 1].capsule(r, l, x), friction = mu, restitution = e)]
    one: [Contact; 3],
    #[contact(log[i].capsule(r, l, x), log[i + 2].capsule(r, l, x), friction = mu, restitution = e)]
    two: [Contact; 2],
    #[contact(log[i].capsule(r, l, x), log[i + 3].capsule(r, l, x), friction = mu, restitution = e)]
    three: [Contact; 1],
}

/// A box, a capsule, a cylinder and two balls on the ground and on each other.
#[mechanism(gravity = -9.81 * z)]
struct MixedShapesScene {
    mass: f64,
    pub grade: f64,
    pub s: f64,
    pub mu: f64,
    pub e: f64,
    #[body(mass = mass, inertia = cuboid(mass, 2 * s, 1.5 * s, s))]
    brick: Body,
    #[body(mass = mass * exp(grade), inertia = capsule(mass * exp(grade), s / 2, 2 * s, x))]
    log: Body,
    #[body(mass = mass * exp(2 * grade), inertia = cylinder(mass * exp(2 * grade), s, 1.5 * s, z))]
    can: Body,
    #[body(mass = mass * exp(3 * grade), inertia = sphere(mass * exp(3 * grade), s))]
    ball: Body,
    #[body(mass = mass * exp(4 * grade), inertia = sphere(mass * exp(4 * grade), s / 2))]
    pea: Body,
    #[joint(ground -> brick)]
    brick_pose: Free,
    #[joint(ground -> log)]
    log_pose: Free,
    #[joint(ground -> can)]
    can_pose: Free,
    #[joint(ground -> ball)]
    ball_pose: Free,
    #[joint(ground -> pea)]
    pea_pose: Free,
    #[contact(brick.cuboid(2 * s, 1.5 * s, s), ground.plane(z), friction = mu, restitution = e)]
    k0: Contact,
    #[contact(log.capsule(s / 2, 2 * s, x), ground.plane(z), friction = mu, restitution = e)]
    k1: Contact,
    #[contact(can.cylinder(s, 1.5 * s, z), ground.plane(z), friction = mu, restitution = e)]
    k2: Contact,
    #[contact(ball.sphere(s), ground.plane(z), friction = mu, restitution = e)]
    k3: Contact,
    #[contact(pea.sphere(s / 2), ground.plane(z), friction = mu, restitution = e)]
    k4: Contact,
    #[contact(log.capsule(s / 2, 2 * s, x), brick.cuboid(2 * s, 1.5 * s, s), friction = mu, restitution = e)]
    k5: Contact,
    #[contact(ball.sphere(s), brick.cuboid(2 * s, 1.5 * s, s), friction = mu, restitution = e)]
    k6: Contact,
    #[contact(pea.sphere(s / 2), brick.cuboid(2 * s, 1.5 * s, s), friction = mu, restitution = e)]
    k7: Contact,
    #[contact(ball.sphere(s), log.capsule(s / 2, 2 * s, x), friction = mu, restitution = e)]
    k8: Contact,
    #[contact(pea.sphere(s / 2), log.capsule(s / 2, 2 * s, x), friction = mu, restitution = e)]
    k9: Contact,
    #[contact(ball.sphere(s), can.cylinder(s, 1.5 * s, z), friction = mu, restitution = e)]
    k10: Contact,
    #[contact(pea.sphere(s / 2), can.cylinder(s, 1.5 * s, z), friction = mu, restitution = e)]
    k11: Contact,
    #[contact(ball.sphere(s), pea.sphere(s / 2), friction = mu, restitution = e)]
    k12: Contact,
}

/// Tower of ten boxes, each with the corners of its base on the top of the box below.
#[mechanism(gravity = -9.81 * z)]
struct Tower {
    #[body(mass = 1, inertia = cuboid(1, 0.2, 0.2, 0.1))]
    block: [Body; 10],
    #[joint(ground -> block[i])]
    pose: [Free; 10],
    #[contact(block[0].cuboid(0.2, 0.2, 0.1), ground.plane(z), friction = 0.6)]
    base: Contact,
    #[contact(block[i + 1].cuboid(0.2, 0.2, 0.1), block[i].at(0.05 * z).plane(z), friction = 0.6)]
    seat: [Contact; 9],
}

/// Generator of reproducible random numbers.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let x = self.0 ^ (self.0 >> 33);
        let x = x.wrapping_mul(0xff51afd7ed558ccd);
        (x >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn uniform_between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.next()
    }
    fn random_list_element<T: Copy>(&mut self, list: &[T]) -> T {
        list[(self.next() * list.len() as f64) as usize % list.len()]
    }
}

/// Processor time of this thread, µs.
fn thread_time() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 * 1e6 + time.tv_nsec as f64 * 1e-3
}

/// Statistics of all runs of one family of scenes.
#[derive(Default)]
struct SceneTally {
    runs: usize,
    errors: usize,
    nans: usize,
    times: Vec<f64>,
    gain: f64,
    depth: f64,
    relaxed: usize,
    violation: f64,
}

/// A scene: its name and seed, the smallest size of its bodies, how it is stepped and for how long.
struct Scene<'a> {
    name: &'a str,
    seed: u64,
    size: f64,
    method: TimeStepping<f64>,
    h: f64,
    duration: f64,
}

/// Simulates a scene and adds its statistics to the tally of its family.
fn run_scene<M, const NQ: usize, const NV: usize, const NK: usize, const NR: usize>(
    scene: &Scene<'_>,
    m: &M,
    (q, v): (SVector<f64, NQ>, SVector<f64, NV>),
    tally: &mut SceneTally,
) where
    M: Contacts<NQ, NV, 0, NK, NR, Scalar = f64>,
{
    let total_energy =
        |q: &SVector<f64, NQ>, v: &SVector<f64, NV>| m.kinetic_energy(0.0, q, v) + m.potential_energy(0.0, q);
    let (first, mut before) = (total_energy(&q, &v).abs().max(1e-12), f64::INFINITY);
    let run = simulate(m).from(q, v).overlaps(Overlaps::Part).method(scene.method);
    let mut samples = run.sample_every(scene.h).duration(scene.duration).into_iter();
    tally.runs += 1;
    loop {
        let start = thread_time();
        let Some(sample) = samples.next() else { return };
        let time = thread_time() - start;
        let sample = match sample {
            Ok(sample) => sample,
            Err(error) => {
                tally.errors += 1;
                println!("{} {}: {error}", scene.name, scene.seed);
                return;
            }
        };
        tally.times.push(time);
        if sample.q.iter().chain(&sample.v).any(|x| !x.is_finite()) {
            tally.nans += 1;
            return;
        }
        let energy = total_energy(&sample.q, &sample.v);
        tally.gain = tally.gain.max((energy - before) / first);
        before = energy;
        tally.depth = tally.depth.max(-m.contact_gaps(0.0, &sample.q).min() / scene.size);
        tally.relaxed += usize::from(sample.violation > 1e-6);
        tally.violation = tally.violation.max(sample.violation);
    }
}

/// Prints the row of a family of scenes in the table.
fn print_tally_row(name: &str, mut tally: SceneTally) {
    let times = &mut tally.times;
    times.sort_by(f64::total_cmp);
    let quantile_of_times =
        |part: f64| times.get((times.len() as f64 * part) as usize).copied().unwrap_or(0.0);
    let mean = times.iter().sum::<f64>() / times.len() as f64;
    println!(
        "{name:10} runs {} errors {} NaN {} | steps {} mean {mean:.1} median {:.1} p99.9 {:.1} | gain {:.1e} \
         depth {:.1e} | relaxed {} by {:.1e}",
        tally.runs,
        tally.errors,
        tally.nans,
        times.len(),
        quantile_of_times(0.5),
        quantile_of_times(0.999),
        tally.gain,
        tally.depth,
        tally.relaxed,
        tally.violation
    );
}

/// Sets the pose of body `k`: its position and its quaternion.
fn set_body_pose<const NQ: usize>(q: &mut SVector<f64, NQ>, k: usize, at: [f64; 3], turn: [f64; 4]) {
    for i in 0..3 {
        q[7 * k + i] = at[i];
    }
    let n = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
    for i in 0..4 {
        q[7 * k + 3 + i] = turn[i] / n;
    }
}

/// A start of bodies with these halves of their lengths: in the air, stacked, in a row, or leaning.
fn random_initial_state<const NQ: usize, const NV: usize>(
    r: &mut Random,
    n: usize,
    half: impl Fn(usize) -> [f64; 3],
) -> (SVector<f64, NQ>, SVector<f64, NV>) {
    let (mut q, mut v) = (SVector::<f64, NQ>::zeros(), SVector::<f64, NV>::zeros());
    let kind = r.random_list_element(&[0, 1, 2, 3]);
    let mut z = 0.0;
    let mut x = 0.0;
    for k in 0..n {
        let h = half(k);
        let far = h.iter().map(|x| x * x).sum::<f64>().sqrt();
        match kind {
            0 => {
                // in the air
                z += far;
                let turn = [
                    r.uniform_between(-1.0, 1.0),
                    r.uniform_between(-1.0, 1.0),
                    r.uniform_between(-1.0, 1.0),
                    r.uniform_between(-1.0, 1.0),
                ];
                set_body_pose(
                    &mut q,
                    k,
                    [r.uniform_between(-0.5, 0.5) * far, r.uniform_between(-0.5, 0.5) * far, z],
                    turn,
                );
                z += far;
                for i in 0..6 {
                    v[6 * k + i] = r.uniform_between(-1.0, 1.0) * if i < 3 { 1.0 } else { 5.0 };
                }
            }
            1 => {
                // stacked
                z += h[2];
                let yaw = r.uniform_between(-0.5, 0.5) * r.random_list_element(&[0.0, 1.0]);
                set_body_pose(
                    &mut q,
                    k,
                    [r.uniform_between(-0.3, 0.3) * h[0], r.uniform_between(-0.3, 0.3) * h[1], z],
                    [0.0, 0.0, yaw, 1.0],
                );
                z += h[2];
            }
            2 => {
                // a row, the first falls
                x += h[0] * 1.01;
                set_body_pose(&mut q, k, [x, 0.0, h[2]], [0.0, 0.0, 0.0, 1.0]);
                x += h[0] + h[2] * r.uniform_between(0.1, 1.0);
                if k == 0 {
                    let w = r.uniform_between(1.0, 5.0) * (0.05 / h[2]).sqrt();
                    v[4] = w;
                    v[0] = w * h[2];
                }
            }
            _ => {
                // leaning, thrown
                x += h[0] + h[2];
                let lean = r.uniform_between(-0.3, 0.3);
                set_body_pose(
                    &mut q,
                    k,
                    [x, r.uniform_between(-0.2, 0.2) * h[1], far * 1.01],
                    [0.0, lean, 0.0, 1.0],
                );
                x += h[0] + h[2];
                v[6 * k] = r.uniform_between(-2.0, 2.0);
                v[6 * k + 4] = r.uniform_between(-10.0, 10.0);
            }
        }
    }
    (q, v)
}

/// Starts of the fixed scenes, which `mujoco_scenes.py` has as well.
fn fixed_scene_state<const NQ: usize, const NV: usize>(n: usize) -> (SVector<f64, NQ>, SVector<f64, NV>) {
    let (mut q, mut v) = (SVector::zeros(), SVector::zeros());
    (0..n).for_each(|k| set_body_pose(&mut q, k, [0.025 * k as f64, 0.0, 0.025], [0.0, 0.0, 0.0, 1.0]));
    (v[4], v[0]) = (3.0, 3.0 * 0.025);
    (q, v)
}

/// Measures the steps of the scenes with fixed initial states.
fn measure_fixed_scenes() {
    let methods = [
        ("4 evaluations", TimeStepping::step(1e-3)),
        ("2", TimeStepping::step(1e-3).midpoint()),
        ("1", TimeStepping::step(1e-3).leapfrog()),
    ];
    for (text, method) in methods {
        let build_fixed_scene =
            |name, size, duration| Scene { name, seed: 0, size, method, h: 1e-3, duration };
        println!("evaluations of the dynamics in a step: {text}");
        let (mass, grade, taper, e) = (0.02, 0.0, 0.0, 0.0);
        let (a, b, c, mu) = (0.008, 0.025, 0.05, 0.3);
        let mut tally = SceneTally::default();
        run_scene(
            &build_fixed_scene("bricks", a, 1.0),
            &Boxes2 { mass, grade, a, b, c, taper, mu, e },
            fixed_scene_state(2),
            &mut tally,
        );
        print_tally_row("bricks", tally);
        let mut tally = SceneTally::default();
        run_scene(
            &build_fixed_scene("dominoes", a, 1.0),
            &Dominoes { mass, grade, a, b, c, taper, mu, e },
            fixed_scene_state(5),
            &mut tally,
        );
        print_tally_row("dominoes", tally);
        let m = Boxes3 { mass: 1.0, grade, a: 0.3, b: 0.2, c: 0.1, taper, mu: 0.5, e };
        let (mut q, mut v) = (SVector::zeros(), SVector::zeros());
        for k in 0..3 {
            let s = k as f64;
            set_body_pose(&mut q, k, [0.05 * s, 0.03 * s, 0.3 + 0.35 * s], [0.3 + 0.1 * s, 0.2, 0.1, 1.0]);
            v[6 * k + 3] = 1.0 + s;
        }
        let mut tally = SceneTally::default();
        run_scene(&build_fixed_scene("tumbling", 0.1, 1.5), &m, (q, v), &mut tally);
        print_tally_row("tumbling", tally);
        let mut q = Tower {}.neutral();
        for k in 0..10 {
            (q[7 * k], q[7 * k + 2]) = (0.02 * ((k % 3) as f64 - 1.0), 0.05 + 0.1 * k as f64);
        }
        let mut tally = SceneTally::default();
        run_scene(&build_fixed_scene("tower", 0.1, 0.2), &Tower {}, (q, SVector::zeros()), &mut tally);
        print_tally_row("tower", tally);
    }
}

/// Runs random scenes of all families, or of the family with this name.
fn run_random_scenes(count: u64, first: u64, which: &str) {
    macro_rules! family {
        ($name:ident, $n:tt, $nq:tt, $nv:tt, |$random:ident, $mu:ident, $e:ident, $grade:ident| $scene:expr) => {
            if which.is_empty() || which == stringify!($name) {
                let mut tally = SceneTally::default();
                for seed in first..first + count {
                    let mut random = Random(seed.wrapping_mul(7919).wrapping_add(13));
                    (0..5).for_each(|_| _ = random.next());
                    let $random = &mut random;
                    let $mu = $random.random_list_element(&[0.0, 0.1, 0.3, 0.5, 0.8, 1.0, 2.0]);
                    let $e = if $random.next() < 0.6 { 0.0 } else { $random.next() };
                    let h = 10f64.powf($random.uniform_between(-4.0, -2.3));
                    let step = TimeStepping::step(h);
                    let method = $random.random_list_element(&[step, step.midpoint(), step.leapfrog()]);
                    // Masses up to 10⁴ times as large as others.
                    let grade = $random.uniform_between(-1.0, 1.0) * 1e4_f64.ln() / ($n as f64 - 1.0);
                    let $grade = $random.random_list_element(&[0.0, grade]);
                    let (m, half, size): (_, Box<dyn Fn(usize) -> [f64; 3]>, f64) = $scene;
                    let begin = random_initial_state::<$nq, $nv>($random, $n, half);
                    let scene = Scene { name: stringify!($name), seed, size, method, h, duration: 150.0 * h };
                    run_scene(&scene, &m, begin, &mut tally);
                }
                print_tally_row(stringify!($name), tally);
            }
        };
    }
    macro_rules! blocks {
        ($name:ident, $random:ident, $mu:ident, $e:ident, $grade:ident) => {{
            let mut length = || $random.uniform_between(0.02, 0.1);
            let (a, b, c) = (length(), length(), length());
            let taper = $random.uniform_between(-0.3, 0.3);
            let taper = $random.random_list_element(&[0.0, taper]);
            let mass = $random.uniform_between(0.05, 2.0);
            let m = $name { mass, grade: $grade, a, b, c, taper, mu: $mu, e: $e };
            (m, Box::new(move |k: usize| [a, b, c].map(|x| x / 2.0 * (taper * k as f64).exp())), a.min(b).min(c))
        }};
    }
    family!(Boxes2, 2, 14, 12, |random, mu, e, grade| blocks!(Boxes2, random, mu, e, grade));
    family!(Boxes3, 3, 21, 18, |random, mu, e, grade| blocks!(Boxes3, random, mu, e, grade));
    family!(Dominoes, 5, 35, 30, |random, mu, e, grade| blocks!(Dominoes, random, mu, e, grade));
    family!(Balls, 6, 42, 36, |random, mu, e, grade| {
        let (r, taper) = (random.uniform_between(0.02, 0.1), random.uniform_between(-0.2, 0.2));
        let m = Balls { mass: 0.3, grade, r, taper, mu, e };
        (m, Box::new(move |k: usize| [r * (taper * k as f64).exp(); 3]), r)
    });
    family!(Capsules4, 4, 28, 24, |random, mu, e, grade| {
        let (r, l) = (random.uniform_between(0.02, 0.05), random.uniform_between(0.05, 0.2));
        (Capsules4 { mass: 0.3, grade, r, l, mu, e }, Box::new(move |_: usize| [r + l / 2.0, r, r]), r)
    });
    family!(MixedShapesScene, 5, 35, 30, |random, mu, e, grade| {
        let s = random.uniform_between(0.02, 0.1);
        let half_lengths_of_body = move |k: usize| match k {
            0 => [s, 0.75 * s, 0.5 * s],
            1 => [1.5 * s, s / 2.0, s / 2.0],
            2 => [s, s, 0.75 * s],
            3 => [s; 3],
            _ => [s / 2.0; 3],
        };
        (MixedShapesScene { mass: 0.3, grade, s, mu, e }, Box::new(half_lengths_of_body), s)
    });
}

/// Runs the fixed or random scenes that the arguments of the command ask for.
fn run_requested_scenes() {
    let mut arguments = std::env::args().skip(1);
    let count = arguments.next().and_then(|x| x.parse().ok()).unwrap_or(20);
    let first = arguments.next().and_then(|x| x.parse().ok()).unwrap_or(0);
    let which = arguments.next().unwrap_or_default();
    if which.is_empty() {
        measure_fixed_scenes();
    }
    run_random_scenes(count, first, &which);
}

fn main() {
    // The matrices of a step are on the stack.
    let thread =
        std::thread::Builder::new().stack_size(256 << 20).spawn(run_requested_scenes).expect("a thread");
    thread.join().expect("the scenes are run");
}
