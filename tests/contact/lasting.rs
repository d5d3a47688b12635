//! Time stepping with lasting contact has order 2 and satisfies conservation laws, on mechanisms with
//! closed-form solutions.

use super::laws::Random;
use linkwork::integrate::EventDriven;
use linkwork::prelude::*;

type TimeSteppingMethod = TimeStepping<f64>;

/// Bob in a smooth bowl of radius 1 m: a spherical pendulum.
#[mechanism(gravity = -9.81 * z)]
pub struct BobInBowl {
    #[particle(mass = 1)]
    bob: Particle,
    #[joint(ground -> bob, along = (x, y, z))]
    place: Stage,
    #[contact(bob, ground.bowl(1.0))]
    bowl: Contact,
}

/// Bead between two walls of a smooth tube that rotates freely about the vertical.
#[mechanism]
pub struct BeadBetweenTubeWalls {
    #[body(mass = 1, inertia = diagonal(0.3, 0.3, 0.3))]
    tube: Body,
    #[joint(ground -> tube, about = z)]
    axle: Pin,
    #[particle(mass = 0.5)]
    bead: Particle,
    #[joint(ground -> bead, along = (x, y))]
    place: Stage,
    #[contact(bead, tube.plane(y))]
    near: Contact,
    #[contact(bead, tube.plane(-y))]
    far: Contact,
}

/// Hoop, or wheel with its centre of mass off its axle, on an inclined floor.
#[mechanism(gravity = 9.81 * sin(slope) * x - 9.81 * cos(slope) * y)]
pub struct WheelOnIncline {
    pub slope: f64,
    pub offset: f64,
    pub friction: f64,
    #[body(mass = 1, com = offset * x, inertia = diagonal(0.01, 0.01, 0.01))]
    hoop: Body,
    #[joint(ground -> hoop, about = z)]
    pose: Planar,
    #[contact(hoop.sphere(0.1), ground.plane(y), friction = friction)]
    floor: Contact,
}

/// Ball whose centre of mass is off its geometric centre.
#[mechanism(gravity = -9.81 * z)]
pub struct UnbalancedBall {
    pub offset: f64,
    pub friction: f64,
    #[body(mass = 1, com = offset * x, inertia = diagonal(0.004, 0.005, 0.006))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.1), ground.plane(z), friction = friction)]
    floor: Contact,
}

/// Disk that rolls on its edge: Euler's disk.
#[mechanism(gravity = -9.81 * z)]
pub struct EulerDisk {
    #[body(mass = 0.4, inertia = disk(0.4, 0.0375, y))]
    disk: Body,
    #[joint(ground -> disk)]
    pose: Free,
    #[contact(disk.circle(0.0375, y), ground.plane(z), friction = 10)]
    floor: Contact,
}

/// Pole that stands upright on its foot, a contact point with friction.
#[mechanism(gravity = -9.81 * y)]
pub struct Pole {
    #[body(mass = 2, com = 0.5 * x, inertia = rod(2, 1, x))]
    pole: Body,
    #[joint(ground -> pole, about = z)]
    pose: Planar,
    #[contact(pole.at(0), ground.plane(y), friction = 5)]
    foot: Contact,
}

/// Block on an inclined plane, with input forces along and across the slope.
#[mechanism(gravity = 9.81 * sin(slope) * x - 9.81 * cos(slope) * z)]
pub struct BlockOnSlope {
    pub slope: f64,
    pub friction: f64,
    #[particle(mass = 1)]
    block: Particle,
    #[joint(ground -> block, along = (x, y, z))]
    place: Stage,
    #[contact(block, ground.plane(z), friction = friction)]
    foot: Contact,
    #[acts(on = block, along = x)]
    push: Force,
    #[acts(on = block, along = y)]
    aside: Force,
}

/// Box on an inclined plane, whose weight four corners share.
#[mechanism(gravity = 9.81 * sin(slope) * x - 9.81 * cos(slope) * z)]
pub struct SlidingBox {
    pub slope: f64,
    pub friction: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = friction)]
    floor: Contact,
}

/// Ball that bounces on the floor.
#[mechanism(gravity = -9.81 * z)]
pub struct VerticallyBouncingBall {
    #[particle(mass = 0.1)]
    ball: Particle,
    #[joint(ground -> ball, along = z)]
    height: Sleeve,
    #[contact(ball, ground.plane(z), restitution = 0.7)]
    bounce: Contact,
}

macro_rules! end {
    ($m:expr, $q:expr, $v:expr, $method:expr, $duration:expr) => {
        simulate($m).from($q, $v).method($method).duration($duration).finish().unwrap()
    };
}

macro_rules! energy {
    ($m:expr, $q:expr, $v:expr) => {
        $m.kinetic_energy($q, $v) + $m.potential_energy($q)
    };
}

/// Returns the sum of the errors of energy, angular momentum and radius of a bob in a bowl.
fn conservation_error_in_bowl(method: TimeSteppingMethod) -> f64 {
    let (m, a) = (BobInBowl {}, 0.8_f64);
    let (q, v) = ([a.sin(), 0.0, -a.cos()].into(), [0.0, 0.5, 0.0].into());
    let s = end!(&m, q, v, method, 2.0);
    let energy = energy!(m, &s.q, &s.v) - energy!(m, &q, &v);
    let momentum = s.q[0] * s.v[1] - s.q[1] * s.v[0] - 0.5 * a.sin();
    let off = s.q.norm() - 1.0;
    energy.abs() + momentum.abs() + off.abs()
}

/// Returns the sum of the errors of energy, angular momentum and lateral position of a bead that slides out
/// of a tube.
fn tube_bead_total_error(method: TimeSteppingMethod) -> f64 {
    let m = BeadBetweenTubeWalls {};
    let (q, v) = ([0.0, 0.1, 0.0].into(), [3.0, 0.2, 0.3].into());
    let s = end!(&m, q, v, method, 1.0);
    let angular_momentum =
        |q: &SVector<f64, 3>, v: &SVector<f64, 3>| 0.3 * v[0] + 0.5 * (q[1] * v[2] - q[2] * v[1]);
    let across = s.q[2] * s.q[0].cos() - s.q[1] * s.q[0].sin();
    (m.kinetic_energy(&s.q, &s.v) - m.kinetic_energy(&q, &v)).abs()
        + (angular_momentum(&s.q, &s.v) - angular_momentum(&q, &v)).abs()
        + across.abs()
}

/// Returns the sum of the slip of a hoop that rolls down a slope, and of the error of its distance, which is
/// half of that of a block without friction.
fn hoop_rolling_distance_error(method: TimeSteppingMethod) -> f64 {
    let m = WheelOnIncline { slope: 0.3, offset: 0.0, friction: 0.5 };
    let s = end!(&m, [0.0, 0.1, 0.0], [0.0; 3], method, 1.0);
    (s.q[0] - 0.25 * 9.81 * 0.3_f64.sin()).abs() + (s.q[2] * 0.1 + s.q[0]).abs()
}

/// Returns the sum of the energy error of an unbalanced wheel that rolls without slip, and of the distance
/// that it has slipped.
fn wheel_energy_and_slip_errors(method: TimeSteppingMethod) -> f64 {
    let m = WheelOnIncline { slope: 0.0, offset: 0.05, friction: 5.0 };
    let (q, v) = ([0.0, 0.1, 0.0].into(), [-0.3, 0.0, 3.0].into());
    let s = end!(&m, q, v, method, 2.0);
    (energy!(m, &s.q, &s.v) - energy!(m, &q, &v)).abs() + (s.q[0] + 0.1 * s.q[2]).abs()
}

/// Returns the energy error of an unbalanced rolling ball.
fn energy_error_of_rolling_ball(method: TimeSteppingMethod) -> f64 {
    let m = UnbalancedBall { offset: 0.03, friction: 5.0 };
    let (q, v) = ([0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0].into(), [0.5, 0.0, 0.0, 0.0, 5.0, 1.0].into());
    let s = end!(&m, q, v, method, 1.0);
    (energy!(m, &s.q, &s.v) - energy!(m, &q, &v)).abs()
}

/// Returns the sum of the relative energy error of Euler's disk, and of the displacement of its centre in
/// radii. The centre is at rest in the steady motion with `Ω² = 4 g / (r sin α)`.
fn euler_disk_energy_and_drift_errors(method: TimeSteppingMethod) -> f64 {
    let (m, r) = (EulerDisk {}, 0.0375_f64);
    // The disk's axis leans by `alpha` from the vertical; the circle rotates about a horizontal diameter of
    // the disk.
    let alpha = 30.0_f64.to_radians();
    let lean = std::f64::consts::FRAC_PI_2 - alpha;
    let (s, c) = (lean / 2.0).sin_cos();
    let q = [0.0, 0.0, r * alpha.sin(), s, 0.0, 0.0, c].into();
    let spin = (4.0 * 9.81 / (r * alpha.sin())).sqrt() * alpha.sin();
    // The instantaneous axis is the diameter through the contact point.
    let v = [0.0, 0.0, 0.0, 0.0, 0.0, spin].into();
    assert!(m.contact_rates(&q, &v).amax() < 1e-12 && m.contact_gaps(&q)[0].abs() < 1e-12);
    let e = energy!(m, &q, &v);
    let s = end!(&m, q, v, method, 0.5);
    (energy!(m, &s.q, &s.v) / e - 1.0).abs() + (s.q[0].hypot(s.q[1]) + (s.q[2] - q[2]).abs()) / r
}

/// Returns the sum of the error of the angular velocity of a pole that falls on its foot, and of the
/// displacement of the foot.
fn falling_pole_total_error(method: TimeSteppingMethod) -> f64 {
    let m = Pole {};
    let start = 1.2_f64;
    let s = end!(&m, [0.0, 0.0, start], [0.0; 3], method, 0.35);
    let spin = -(3.0 * 9.81 * (start.sin() - s.q[2].sin())).sqrt();
    (s.v[2] - spin).abs() + s.q[0].abs() + s.q[1].abs()
}

/// Returns the sum of the errors of speed and position of a ball that spins on a smooth floor, after a
/// second.
fn error_of_spinning_ball(method: TimeSteppingMethod, [x, y, z]: [f64; 3]) -> f64 {
    let m = UnbalancedBall { offset: 0.0, friction: 0.0 };
    let q = [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0];
    let s = end!(&m, q, [1.0, 0.0, 0.0, x, y, z], method, 1.0);
    (s.v.fixed_rows::<3>(0).norm() - 1.0).abs() + (s.q[0] - 1.0).abs() + s.q[1].abs() + (s.q[2] - 0.1).abs()
}

/// Returns the sum of the displacement and the speed of a block that sticks on a slope under a growing load;
/// exactly, both are zero.
fn creep_on_ramp(method: TimeSteppingMethod) -> f64 {
    let m = BlockOnSlope { slope: 0.1, friction: 0.6 };
    let run = simulate(&m).from([0.0; 3], [0.0; 3]).inputs(|t, _, _| [-2.0 * t, 1.5 * t].into());
    let s = run.method(method).duration(1.5).finish().unwrap();
    s.q.norm() + s.v.norm()
}

/// Returns the sum of the errors of velocity and position of a block that slides down a slope along a
/// straight line.
fn error_of_sliding_block(method: TimeSteppingMethod) -> f64 {
    let m = BlockOnSlope { slope: 0.5, friction: 0.3 };
    let s = end!(&m, [0.0; 3], [0.4, 0.0, 0.0], method, 1.0);
    let a = 9.81 * (0.5_f64.sin() - 0.3 * 0.5_f64.cos());
    (s.v[0] - 0.4 - a).abs() + (s.q[0] - 0.4 - 0.5 * a).abs() + s.v[2].abs()
}

/// Returns the change of a constant of motion: the sum of the speed and of the downhill velocity of a block
/// that crosses a slope with friction `μ = tan α`.
fn invariant_error_of_crossing_block(method: TimeSteppingMethod) -> f64 {
    let m = BlockOnSlope { slope: 0.3, friction: 0.3_f64.tan() };
    let s = end!(&m, [0.0; 3], [0.1, 1.0, 0.0], method, 0.6);
    let speed_plus_downhill_velocity = |v: &SVector<f64, 3>| v.norm() + v[0];
    (speed_plus_downhill_velocity(&s.v) - speed_plus_downhill_velocity(&[0.1, 1.0, 0.0].into())).abs()
}

/// Returns the change of the same constant for a box, whose edges are not parallel to its path, and its
/// rotation: friction has no moment about the normal if all corners slide in the same direction.
fn invariant_error_of_crossing_box(method: TimeSteppingMethod) -> f64 {
    let m = SlidingBox { slope: 0.3, friction: 0.3_f64.tan() };
    let (s, c) = 0.4_f64.sin_cos();
    let q: SVector<f64, 7> = [0.0, 0.0, 0.05, 0.0, 0.0, s, c].into();
    // The velocity is in the axes of the box, which is turned by 0.8 rad.
    let (sine, cosine) = 0.8_f64.sin_cos();
    let v: SVector<f64, 6> = [0.1 * cosine + sine, cosine - 0.1 * sine, 0.0, 0.0, 0.0, 0.0].into();
    let end = end!(&m, q, v, method, 0.6);
    let downhill = end.v[0] * cosine - end.v[1] * sine;
    let conserved_sum = end.v.fixed_rows::<3>(0).norm() + downhill;
    (conserved_sum - 1.01_f64.sqrt() - 0.1).abs() + (end.q.fixed_rows::<4>(3) - q.fixed_rows::<4>(3)).norm()
}

/// Checks that halving the step twice divides the error by 3.4 to 5 each time, for both kinds of steps.
fn check_order(name: &str, h: f64, largest: f64, error: fn(TimeSteppingMethod) -> f64) {
    for midpoint in [false, true] {
        let errors = [h, h / 2.0, h / 4.0].map(|h| {
            let method = TimeStepping::step(h);
            error(if midpoint { method.midpoint() } else { method })
        });
        for k in 1..3 {
            let ratio = errors[k - 1] / errors[k];
            assert!((3.4..5.0).contains(&ratio), "{name}, midpoint {midpoint}: {errors:?}");
        }
        assert!(errors[0] < largest, "{name}, midpoint {midpoint}: {errors:?}");
    }
}

#[test]
fn lasting_contacts_are_integrated_with_order_two() {
    check_order("bob in a bowl", 4e-3, 2e-4, conservation_error_in_bowl);
    check_order("bead in a tube", 4e-3, 4e-5, tube_bead_total_error);
    check_order("wheel", 4e-3, 2e-4, wheel_energy_and_slip_errors);
    check_order("pole", 4e-3, 1e-4, falling_pole_total_error);
    check_order("Euler's disk", 4e-4, 5e-4, euler_disk_energy_and_drift_errors);
    check_order("block across a slope", 4e-3, 1e-4, invariant_error_of_crossing_block);
    check_order("box across a slope", 4e-3, 2e-4, invariant_error_of_crossing_box);
}

/// The energy of an unbalanced rolling ball changes by the fraction `8e-6` in a second with steps of 2 ms,
/// and by less with shorter steps.
#[test]
fn unbalanced_rolling_ball_conserves_energy() {
    for (h, largest) in [(2e-3, 8e-6), (1e-3, 1e-6), (5e-4, 2.5e-7)] {
        assert!(energy_error_of_rolling_ball(TimeStepping::step(h)) < largest);
        assert!(energy_error_of_rolling_ball(TimeStepping::step(h).midpoint()) < largest);
    }
}

/// Checks that time stepping is exact for motions with constant accelerations: a sliding block and a rolling
/// hoop.
#[test]
fn constant_accelerations_in_contact_are_integrated_exactly() {
    for method in [TimeStepping::step(1e-2), TimeStepping::step(1e-2).midpoint()] {
        assert!(
            error_of_sliding_block(method) < 1e-12 && hoop_rolling_distance_error(method) < 1e-12,
            "{} {}",
            error_of_sliding_block(method),
            hoop_rolling_distance_error(method)
        );
    }
}

/// A sticking block does not move under a growing, oscillating or jumping load.
#[test]
fn sticking_contacts_do_not_creep() {
    for method in [TimeStepping::step(1e-3), TimeStepping::step(1e-3).midpoint()] {
        assert!(creep_on_ramp(method) < 1e-14, "{}", creep_on_ramp(method));
        let m = BlockOnSlope { slope: 0.1, friction: 0.6 };
        let applied_load = |t: f64, _: &_, _: &_| {
            let jump = if (t * 7.0).fract() < 0.5 { 1.0 } else { -1.0 };
            SVector::from([1.5 * (40.0 * t).sin() - jump, 2.0 * (25.0 * t).cos()])
        };
        let run = simulate(&m).from([0.0; 3], [0.0; 3]).inputs(applied_load).method(method);
        let s = run.duration(2.0).finish().unwrap();
        assert!(s.q.norm() < 1e-13 && s.v.norm() < 1e-13, "{} {}", s.q, s.v);
    }
}

/// Checks that a ball which moves and spins on a smooth level floor keeps its velocity, because no horizontal
/// force acts on it. Steps through the midpoint are exact; steps with four stages have at least order 2.
#[test]
fn spinning_ball_keeps_its_velocity_on_a_smooth_floor() {
    for spin in [[0.0, 20.0, 0.0], [0.0, 0.0, 20.0], [12.0, -9.0, 7.0]] {
        let method = TimeStepping::step(1e-3);
        for (method, largest) in [(method, 2e-6), (method.midpoint(), 1e-12), (method.leapfrog(), 1e-12)] {
            let error = error_of_spinning_ball(method, spin);
            assert!(error < largest, "{spin:?}: {error:e}");
        }
        let [coarse, fine] = [4e-3, 2e-3].map(|h| error_of_spinning_ball(TimeStepping::step(h), spin));
        assert!(coarse > 3.4 * fine, "{spin:?}: {coarse:e} {fine:e}");
    }
}

/// The apices of a bouncing ball follow from the coefficient of restitution. The error has order 1, since
/// impacts are not located.
#[test]
fn bounces_are_integrated_with_order_one() {
    let fall = (2.0 / 9.81_f64).sqrt();
    for h in [4e-3, 2e-3, 1e-3, 5e-4] {
        for method in [TimeStepping::step(h), TimeStepping::step(h).midpoint()] {
            let s = end!(&VerticallyBouncingBall {}, [1.0], [0.0], method, 1.7 * fall);
            assert!((s.q[0] - 0.49).abs() < 2.0 * h, "{h}: {}", s.q[0]);
        }
    }
}

/// Random bobs in a bowl, rolling balls and blocks on slopes: the error against [`EventDriven`] with tight
/// tolerances decreases on average with the square of the step.
#[test]
fn random_contact_motions_have_order_two() {
    let mut random = Random(11);
    let count = 15;
    let mut sums = [[0.0_f64; 2]; 3];
    for _ in 0..count {
        let angle = 0.3 + 0.4 * (random.next() + 1.0);
        let q: SVector<f64, 3> = [angle.sin(), 0.0, -angle.cos()].into();
        let v: SVector<f64, 3> = [0.0, random.next(), 0.0].into();
        add_errors_of_both_steps(&mut sums[0], &BobInBowl {}, q, v, 0.5);
        let m = UnbalancedBall { offset: 0.02 * random.next(), friction: 5.0 };
        let (vx, vy) = (random.next(), random.next());
        let q: SVector<f64, 7> = [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0].into();
        let v: SVector<f64, 6> = [vx, vy, 0.0, -10.0 * vy, 10.0 * vx, 2.0 * random.next()].into();
        add_errors_of_both_steps(&mut sums[1], &m, q, v, 0.5);
        let m = BlockOnSlope { slope: 0.4 + 0.2 * random.next(), friction: 0.3 + 0.2 * random.next() };
        let v: SVector<f64, 3> = [0.5 + random.next(), 1.5 + 0.5 * random.next(), 0.0].into();
        add_errors_of_both_steps(&mut sums[2], &m, SVector::zeros(), v, 0.2);
    }
    for (k, [coarse, fine]) in sums.into_iter().enumerate() {
        assert!((3.2..5.0).contains(&(coarse / fine)), "{k}: {coarse} {fine}");
    }
}

/// Adds the errors with steps of 2 ms and of 1 ms to `sums`.
fn add_errors_of_both_steps<M, const NQ: usize, const NV: usize, const NU: usize>(
    sums: &mut [f64; 2],
    m: &M,
    q: SVector<f64, NQ>,
    v: SVector<f64, NV>,
    duration: f64,
) where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let run = simulate(m).from(q, v).duration(duration);
    let exact = run.clone().method(EventDriven::new().tolerance(1e-12, 1e-12)).finish().unwrap();
    for (sum, h) in sums.iter_mut().zip([2e-3, 1e-3]) {
        let s = run.clone().method(TimeStepping::step(h)).finish().unwrap();
        *sum += m.difference(&exact.q, &s.q).norm() + (exact.v - s.v).norm();
    }
}
