//! Bodies that fall on each other and on the ground: a step always exists, and takes no energy in.

use super::boxes::random_rotation;
use super::laws::Random;
use linkwork::nalgebra::UnitQuaternion;
use linkwork::prelude::*;
use linkwork::simulate::Overlaps;

/// Two bricks on the ground, `ratio` times as heavy as each other.
#[mechanism(gravity = -9.81 * z)]
struct Bricks {
    mass: f64,
    ratio: f64,
    a: f64,
    b: f64,
    c: f64,
    friction: f64,
    restitution: f64,
    #[body(mass = mass, inertia = cuboid(mass, a, b, c))]
    one: Body,
    #[body(mass = mass * ratio, inertia = cuboid(mass * ratio, a, b, c))]
    other: Body,
    #[joint(ground -> one)]
    one_pose: Free,
    #[joint(ground -> other)]
    other_pose: Free,
    #[contact(one.cuboid(a, b, c), ground.plane(z), friction = friction, restitution = restitution)]
    one_floor: Contact,
    #[contact(other.cuboid(a, b, c), ground.plane(z), friction = friction, restitution = restitution)]
    other_floor: Contact,
    #[contact(one.cuboid(a, b, c), other.cuboid(a, b, c), friction = friction, restitution = restitution)]
    touch: Contact,
}

impl Bricks {
    /// Returns the configuration of both bricks from the positions of their centres and their orientations.
    fn configuration_of_bricks(&self, poses: [([f64; 3], UnitQuaternion<f64>); 2]) -> SVector<f64, 14> {
        let mut q = self.neutral();
        for (k, (place, turn)) in poses.into_iter().enumerate() {
            q.fixed_rows_mut::<3>(7 * k).copy_from_slice(&place);
            q.fixed_rows_mut::<4>(7 * k + 3).copy_from(&turn.coords);
        }
        q
    }

    /// Advances by so many steps, and checks each: finite, without more energy than `gain` from step to step.
    /// Returns the end and the largest violation of the contact conditions.
    fn check_steps(
        &self,
        start: (SVector<f64, 14>, SVector<f64, 12>),
        method: TimeStepping<f64>,
        (h, steps, gain): (f64, u32, f64),
    ) -> (SVector<f64, 14>, f64) {
        let total_energy = |q: &_, v: &_| self.kinetic_energy(q, v) + self.potential_energy(q);
        let run = simulate(self).from(start.0, start.1).overlaps(Overlaps::Part).method(method);
        let (mut before, mut end, mut worst) = (f64::INFINITY, start.0, 0.0_f64);
        for sample in run.duration(h * f64::from(steps)) {
            let sample = sample.expect("a step exists");
            let now = total_energy(&sample.q, &sample.v);
            assert!(now <= before + gain, "{} at {} s in steps of {h}", now - before, sample.t);
            (before, end, worst) = (now, sample.q, worst.max(sample.violation));
        }
        assert!(end.iter().all(|x| x.is_finite()));
        (end, worst)
    }
}

/// Checks random scenes of two bricks: in the air, stacked, or one falling against the other. The environment
/// variable `LINKWORK_SCENES` is the number of scenes.
#[test]
fn random_scenes_of_two_bricks_complete() {
    let count = std::env::var("LINKWORK_SCENES").ok().and_then(|count| count.parse().ok()).unwrap_or(12);
    for seed in 0..count {
        let mut random = Random(seed);
        (0..3).for_each(|_| _ = random.next());
        let mut random_brick_edge = || 0.06 + 0.04 * random.next();
        let [a, b, c] = [random_brick_edge(), random_brick_edge(), random_brick_edge()];
        let m = Bricks {
            mass: 0.5,
            ratio: 100.0_f64.powf(random.next()),
            a,
            b,
            c,
            friction: random.random_choice([0.0, 0.1, 0.3, 0.5, 1.0, 2.0]),
            restitution: random.random_choice([0.0, 0.0, 0.3, 1.0]),
        };
        let far = (a * a + b * b + c * c).sqrt() / 2.0;
        let level = UnitQuaternion::identity();
        let mut v = SVector::zeros();
        let poses = match seed % 3 {
            0 => {
                v = random.random_vector(2.0);
                [
                    ([0.0, 0.0, far], random_rotation(&mut random)),
                    ([0.3 * far, 0.0, 3.1 * far], random_rotation(&mut random)),
                ]
            }
            1 => [([0.0, 0.0, c / 2.0], level), ([0.3 * a, 0.2 * b, 1.5 * c], level)],
            _ => {
                let spin = 3.0 + random.next();
                (v[0], v[4]) = (spin * c / 2.0, spin);
                [([0.0, 0.0, c / 2.0], level), ([a + 0.5 * c, 0.0, c / 2.0], level)]
            }
        };
        let h = 5e-3 * 10.0_f64.powf(0.7 * random.next() - 0.7);
        let step = TimeStepping::step(h);
        let step = match seed / 3 % 3 {
            0 => step,
            1 => step.midpoint(),
            _ => step.leapfrog(),
        };
        let weight = m.mass * (1.0 + m.ratio);
        m.check_steps((m.configuration_of_bricks(poses), v), step, (h, 60, 100.0 * weight * h * h));
    }
}

/// Checks that a thin brick which falls against another one knocks it over.
#[test]
fn falling_brick_knocks_over_another() {
    let m = Bricks { mass: 0.02, ratio: 1.0, a: 0.008, b: 0.025, c: 0.05, friction: 0.3, restitution: 0.0 };
    let level = UnitQuaternion::identity();
    for h in [2e-3, 1e-3] {
        let steps = if h > 1.5e-3 { 350 } else { 700 };
        let poses = [([0.0, 0.0, 0.025], level), ([0.025, 0.0, 0.025], level)];
        let mut v = SVector::zeros();
        (v[0], v[4]) = (0.075, 3.0);
        let (end, _) =
            m.check_steps((m.configuration_of_bricks(poses), v), TimeStepping::step(h), (h, steps, 1e-6));
        // Neither stands, and the second one lies.
        assert!(end[2] < 0.024 && end[9] < 0.013, "{end}");
    }
}
