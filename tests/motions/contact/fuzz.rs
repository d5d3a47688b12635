//! Checks of contacts at random states, including pathological ones. Results are finite and satisfy the
//! contact conditions, or are errors.

use super::laws::{DoublePendulumAboveFloor, Pile, Random};
use linkwork::contact::{self, Contacts};
use linkwork::prelude::*;
use linkwork::simulate::Overlaps;

/// Block with the same floor and the same wall declared twice: the distribution of forces over contacts is
/// not unique.
#[mechanism(gravity = -9.81 * z)]
struct BlockWithDoubledContacts {
    friction: f64,
    restitution: f64,
    #[body(mass = 2, com = 0.02 * x, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = friction, restitution = restitution)]
    floor: Contact,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = friction, restitution = restitution)]
    same: Contact,
    #[contact(
        block.cuboid(0.3, 0.2, 0.1), ground.at(-0.15 * x).plane(x), friction = friction,
        restitution = restitution
    )]
    wall: Contact,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.at(-0.15 * x).plane(x))]
    smooth: Contact,
}

/// Pendulum between stops at the same angle, so that it cannot move, or nearly at the same angle.
#[mechanism(gravity = -9.81 * y)]
struct PendulumBetweenStops {
    gap: f64,
    restitution: f64,
    #[body(mass = 1, com = 0.25 * x, inertia = rod(1, 0.5, x))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    hinge: Pin,
    #[limit(on = hinge, from = -gap, to = gap, restitution = restitution)]
    stops: Limit,
}

/// Ball on a floor that is declared twice, and at a wall, all with torsional or rolling friction.
#[mechanism(gravity = -9.81 * z)]
struct TorsionalFrictionBall {
    friction: f64,
    moment: f64,
    restitution: f64,
    #[body(mass = 0.5, com = 0.01 * x, inertia = sphere(0.5, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(
        ball.sphere(0.05), ground.plane(z), friction = friction, torsional = moment, rolling = moment, restitution = restitution
    )]
    floor: Contact,
    #[contact(ball.sphere(0.05), ground.plane(z), friction = friction, torsional = moment)]
    same: Contact,
    #[contact(ball.sphere(0.05), ground.at(-0.05 * x).plane(x), friction = friction, rolling = moment)]
    wall: Contact,
}

/// Checks an impact in a state, and half a dozen steps from it. Returns the number of errors.
fn check_impact_and_steps<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    m: &M,
    q: SVector<f64, NQ>,
    v: SVector<f64, NV>,
) -> usize
where
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = f64>,
{
    let mut errors = 0;
    let energy = m.kinetic_energy(0.0, &q, &v);
    match contact::impact(m, 0.0, &q, &v) {
        Ok(found) => {
            let after = m.kinetic_energy(0.0, &q, &found.v);
            assert!(after <= energy * (1.0 + 1e-9), "{energy} {after}");
            assert!(found.impulses.iter().all(|impulse| impulse.is_finite()));
        }
        Err(ConstraintError::Contact { .. }) => errors += 1,
        Err(other) => panic!("{other}"),
    }
    let run =
        simulate(m).from(q, v).overlaps(Overlaps::Keep).method(TimeStepping::step(2e-3)).duration(0.012);
    for sample in run {
        match sample {
            Ok(sample) => {
                assert!(sample.q.iter().chain(&sample.v).all(|x| x.is_finite()));
                let (first, gaps) = (m.contact_gaps(0.0, &q).min(), m.contact_gaps(0.0, &sample.q));
                let speed = m.contact_rates(0.0, &q, &v).amax()
                    + m.contact_rates(0.0, &sample.q, &sample.v).amax()
                    + 1.0;
                // For deeply penetrating bodies the path of separation is not specified.
                let reached = first.min(0.0) - 2e-3 * speed;
                assert!(first < -5e-3 || gaps.min() >= reached, "{} {first} {speed}", gaps.min());
            }
            Err(_) => errors += 1,
        }
    }
    errors
}

/// Returns random coefficients: friction from zero to a million, and restitution in its range, including both
/// ends.
fn random_contact_coefficients(random: &mut Random) -> (f64, f64) {
    let friction = if random.next() > 0.7 { 0.0 } else { 10.0_f64.powf(1.5 + 4.5 * random.next()) };
    (friction, random.random_choice([0.0, 0.0, 1.0, 1.0, 0.5, 1e-9]))
}

/// Checks `count` random states of each mechanism. Returns the number of errors.
pub fn check_random_states(seed: u64, count: usize) -> usize {
    let (mut random, mut errors) = (Random(seed), 0);
    for _ in 0..count {
        let (friction, restitution) = random_contact_coefficients(&mut random);
        let m = BlockWithDoubledContacts { friction, restitution };
        let mut q = m.neutral();
        q[2] = 0.05 + random.random_choice([0.0, 0.0, -1e-3, 1e-9, 0.1]);
        q[0] = random.random_choice([0.0, 1.0, -1e-12]);
        if random.next() > 0.5 {
            let size = random.random_choice([1e-12, 1e-6, 0.1, 3.0]);
            let mut turn = random.random_vector(size);
            (turn[0], turn[1], turn[2]) = (0.0, 0.0, 0.0);
            q = m.integrate(&q, &turn);
        }
        let speed = random.random_choice([0.0, 1e-12, 1.0, 10.0]);
        errors += check_impact_and_steps(&m, q, random.random_vector(speed));

        let m = Pile { friction, restitution };
        let mut q = m.neutral();
        (q[0], q[2], q[7], q[9], q[16]) = (-0.1, 0.1, 0.1, 0.1, 0.1 + 0.03_f64.sqrt());
        q[16] += random.random_choice([0.0, 1e-9, -1e-6]);
        let speed = random.random_choice([0.0, 1e-9, 2.0]);
        errors += check_impact_and_steps(&m, q, random.random_vector(speed));

        let m = TorsionalFrictionBall {
            friction,
            moment: random.random_choice([0.0, 1e-3, 0.05, 1e6]),
            restitution,
        };
        let turn = SVector::from([0.0, 0.0, 0.0, random.next(), 3.0 * random.next(), random.next()]);
        let mut q = m.integrate(&m.neutral(), &turn);
        (q[0], q[2]) = (
            random.random_choice([0.0, 0.0, 1.0, -1e-9]),
            0.05 + random.random_choice([0.0, 0.0, -1e-6, 0.01]),
        );
        let speed = random.random_choice([0.0, 1e-9, 2.0, 50.0]);
        errors += check_impact_and_steps(&m, q, random.random_vector(speed));

        let (a, b) = (random.next() * 3.0, random.next() * 3.0);
        let m = DoublePendulumAboveFloor {
            friction,
            restitution,
            height: -(0.5 * a.sin() + 0.5 * (a + b).sin()),
        };
        errors += check_impact_and_steps(&m, [a, b].into(), random.random_vector(3.0));

        let m = PendulumBetweenStops { gap: random.random_choice([1e-300, 1e-12, 1e-6, 0.3]), restitution };
        errors += check_impact_and_steps(&m, [random.next() * m.gap].into(), random.random_vector(5.0));
    }
    errors
}

/// Block in a corner of surfaces that are declared twice, with a friction of 54 254. It rotates about two of
/// sixteen points; neither gradient methods nor a gradual increase of friction find this solution.
#[test]
fn block_rotates_about_two_of_many_contact_points() {
    let m = BlockWithDoubledContacts { friction: 54254.21780149019, restitution: 1.0 };
    let q = [-1e-12, 0.0, 0.05, -1.2038604637858707e-13, 3.528791029535654e-13, 2.2409312509628288e-13, 1.0]
        .into();
    let v = [
        -3.436024926795618e-13,
        -2.980942872602148e-13,
        5.526987384038264e-13,
        -1.786750767074432e-13,
        -6.316209121722274e-13,
        3.9121351162862305e-13,
    ]
    .into();
    super::laws::check_impact_conditions(&m, &q, &v);
}

/// Checks that the removal of overlaps does not create others: a heavy ball that falls between two others
/// pushes a light one away. Regression test: the light one was pushed 14 mm through the floor. No overlap
/// exceeds the motion of a ball in one step.
#[test]
fn overlap_removal_creates_no_other_overlaps() {
    let m = Pile { friction: 24.6, restitution: 0.0 };
    let mut q = m.neutral();
    (q[0], q[2], q[7], q[9], q[16]) = (-0.1, 0.1, 0.1, 0.1, 0.1 + 0.03_f64.sqrt());
    let v = SVector::from([
        0.41, -0.22, 0.54, 0.65, -1.64, -0.95, -1.8, -1.21, 1.71, 0.71, -0.51, -0.04, -1.47, 1.95, -1.73,
        -1.47, 1.9, -1.28,
    ]);
    let speed = m.contact_rates(&q, &v).amax();
    for h in [2e-3, 1e-3, 5e-4] {
        let run = simulate(&m).from(q, v).method(TimeStepping::step(h)).duration(0.012);
        for sample in run {
            let deepest = m.contact_gaps(&sample.expect("they move on").q).min();
            assert!(deepest > -speed * h, "steps of {h}: {deepest}");
        }
    }
}

/// Checks that at most one random state in ten thousand returns an error. `LINKWORK_ORACLE` is the number of
/// blocks of a hundred states of each of five mechanisms, or their range: `20`, or `20..40`; 2000 blocks are
/// a million states.
#[test]
fn random_contact_states_rarely_fail() {
    let asked = std::env::var("LINKWORK_ORACLE").unwrap_or_default();
    let range = asked.split_once("..").and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
    let (from, to) = range.unwrap_or((0, asked.parse().unwrap_or(1)));
    let errors: usize = (from..to).map(|block: u64| check_random_states(7 + block, 100)).sum();
    assert!(errors as u64 <= (to - from) / 20, "{errors}");
}
