//! Time stepping under lasting contact: order 2 and conservation laws, on mechanisms with closed forms.

use linkwork::prelude::*;

type Stepping = TimeStepping<f64>;

/// A bob in a smooth bowl of radius 1 m: a spherical pendulum.
#[mechanism(gravity = -9.81 * z)]
pub struct Bowl {
    #[particle(mass = 1)]
    bob: Particle,
    #[joint(ground -> bob, along = (x, y, z))]
    place: Stage,
    #[contact(bob, ground.bowl(1.0))]
    bowl: Contact,
}

/// A bead between two walls of a smooth tube that rotates freely about the vertical.
#[mechanism]
pub struct Tube {
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

/// A hoop, or a wheel with its centre of mass off its axle, on an inclined floor.
#[mechanism(gravity = 9.81 * sin(slope) * x - 9.81 * cos(slope) * y)]
pub struct Hoop {
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

/// A ball with its centre of mass off its centre.
#[mechanism(gravity = -9.81 * z)]
pub struct Ball {
    pub offset: f64,
    pub friction: f64,
    #[body(mass = 1, com = offset * x, inertia = diagonal(0.004, 0.005, 0.006))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.1), ground.plane(z), friction = friction)]
    floor: Contact,
}

/// A disk that rolls on its edge: Euler's disk.
#[mechanism(gravity = -9.81 * z)]
pub struct Disk {
    #[body(mass = 0.4, inertia = disk(0.4, 0.0375, y))]
    disk: Body,
    #[joint(ground -> disk)]
    pose: Free,
    #[contact(disk.circle(0.0375, y), ground.plane(z), friction = 10)]
    floor: Contact,
}

/// A pole that stands on its foot.
#[mechanism(gravity = -9.81 * y)]
pub struct Pole {
    #[body(mass = 2, com = 0.5 * x, inertia = rod(2, 1, x))]
    pole: Body,
    #[joint(ground -> pole, about = z)]
    pose: Planar,
    #[contact(pole.at(0), ground.plane(y), friction = 5)]
    foot: Contact,
}

/// A block on an inclined plane, pushed along and across it.
#[mechanism(gravity = 9.81 * sin(slope) * x - 9.81 * cos(slope) * z)]
pub struct Slope {
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

/// A ball that bounces.
#[mechanism(gravity = -9.81 * z)]
pub struct Bouncing {
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

/// Relative error of the energy, and error of the angular momentum, of a bob in a bowl.
fn bowl(method: Stepping) -> f64 {
    let (m, a) = (Bowl {}, 0.8_f64);
    let (q, v) = ([a.sin(), 0.0, -a.cos()].into(), [0.0, 0.5, 0.0].into());
    let s = end!(&m, q, v, method, 2.0);
    let energy = energy!(m, &s.q, &s.v) - energy!(m, &q, &v);
    let momentum = s.q[0] * s.v[1] - s.q[1] * s.v[0] - 0.5 * a.sin();
    let off = s.q.norm() - 1.0;
    energy.abs() + momentum.abs() + off.abs()
}

/// Energy and angular momentum of a bead that slides out of a tube.
fn tube(method: Stepping) -> f64 {
    let m = Tube {};
    let (q, v) = ([0.0, 0.1, 0.0].into(), [3.0, 0.2, 0.3].into());
    let s = end!(&m, q, v, method, 1.0);
    let spin = |q: &SVector<f64, 3>, v: &SVector<f64, 3>| 0.3 * v[0] + 0.5 * (q[1] * v[2] - q[2] * v[1]);
    let across = s.q[2] * s.q[0].cos() - s.q[1] * s.q[0].sin();
    (m.kinetic_energy(&s.q, &s.v) - m.kinetic_energy(&q, &v)).abs() + (spin(&s.q, &s.v) - spin(&q, &v)).abs() + across.abs()
}

/// Distance that a hoop rolls down a slope: half of that of a block without friction.
fn hoop(method: Stepping) -> f64 {
    let m = Hoop { slope: 0.3, offset: 0.0, friction: 0.5 };
    let s = end!(&m, [0.0, 0.1, 0.0], [0.0; 3], method, 1.0);
    (s.q[0] - 0.25 * 9.81 * 0.3_f64.sin()).abs() + (s.q[2] * 0.1 + s.q[0]).abs()
}

/// Energy of an unbalanced wheel that rolls without slip, and how far it has slipped.
fn wheel(method: Stepping) -> f64 {
    let m = Hoop { slope: 0.0, offset: 0.05, friction: 5.0 };
    let (q, v) = ([0.0, 0.1, 0.0].into(), [-0.3, 0.0, 3.0].into());
    let s = end!(&m, q, v, method, 2.0);
    (energy!(m, &s.q, &s.v) - energy!(m, &q, &v)).abs() + (s.q[0] + 0.1 * s.q[2]).abs()
}

/// Energy of an unbalanced ball that rolls.
fn ball(method: Stepping) -> f64 {
    let m = Ball { offset: 0.03, friction: 5.0 };
    let (q, v) = ([0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0].into(), [0.5, 0.0, 0.0, 0.0, 5.0, 1.0].into());
    let s = end!(&m, q, v, method, 1.0);
    (energy!(m, &s.q, &s.v) - energy!(m, &q, &v)).abs()
}

/// Energy of Euler's disk, and how far its centre moves, which rests in the steady motion with `Ω² = 4 g / (r sin α)`.
fn disk(method: Stepping) -> f64 {
    let (m, r) = (Disk {}, 0.0375_f64);
    // The axis of the disk leans by `alpha` from the vertical; the circle turns about a horizontal diameter of the disk.
    let alpha = 30.0_f64.to_radians();
    let lean = std::f64::consts::FRAC_PI_2 - alpha;
    let (s, c) = (lean / 2.0).sin_cos();
    let q = [0.0, 0.0, r * alpha.sin(), s, 0.0, 0.0, c].into();
    let spin = (4.0 * 9.81 / (r * alpha.sin())).sqrt() * alpha.sin();
    // The instantaneous axis is the diameter through the point of contact.
    let v = [0.0, 0.0, 0.0, 0.0, 0.0, spin].into();
    assert!(m.contact_rates(&q, &v).amax() < 1e-12 && m.contact_gaps(&q)[0].abs() < 1e-12);
    let e = energy!(m, &q, &v);
    let s = end!(&m, q, v, method, 0.5);
    (energy!(m, &s.q, &s.v) / e - 1.0).abs() + (s.q[0].hypot(s.q[1]) + (s.q[2] - q[2]).abs()) / r
}

/// Angular velocity of a pole that falls on its foot, and how far the foot moves.
fn pole(method: Stepping) -> f64 {
    let m = Pole {};
    let start = 1.2_f64;
    let s = end!(&m, [0.0, 0.0, start], [0.0; 3], method, 0.35);
    let spin = -(3.0 * 9.81 * (start.sin() - s.q[2].sin())).sqrt();
    (s.v[2] - spin).abs() + s.q[0].abs() + s.q[1].abs()
}

/// Speed of a ball that spins on a smooth floor.
fn spinning(method: Stepping) -> f64 {
    let m = Ball { offset: 0.0, friction: 0.0 };
    let q = [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0];
    let s = end!(&m, q, [1.0, 0.0, 0.0, 0.0, 0.0, 20.0], method, 1.0);
    (s.v.fixed_rows::<3>(0).norm() - 1.0).abs() + (s.q[0] - 1.0).abs() + s.q[1].abs() + (s.q[2] - 0.1).abs()
}

/// How far a block moves that sticks on a slope under a load that grows.
fn ramp(method: Stepping) -> f64 {
    let m = Slope { slope: 0.1, friction: 0.6 };
    let run = simulate(&m).from([0.0; 3], [0.0; 3]).inputs(|t, _, _| [-2.0 * t, 1.5 * t].into());
    let s = run.method(method).duration(1.5).finish().unwrap();
    s.q.norm() + s.v.norm()
}

/// Velocity and place of a block that slides down a slope along a straight line.
fn slides(method: Stepping) -> f64 {
    let m = Slope { slope: 0.5, friction: 0.3 };
    let s = end!(&m, [0.0; 3], [0.4, 0.0, 0.0], method, 1.0);
    let a = 9.81 * (0.5_f64.sin() - 0.3 * 0.5_f64.cos());
    (s.v[0] - 0.4 - a).abs() + (s.q[0] - 0.4 - 0.5 * a).abs() + s.v[2].abs()
}

/// Sum of speed and velocity down a slope of a block that crosses it with the friction `μ = tan α`: a constant.
fn crosses(method: Stepping) -> f64 {
    let m = Slope { slope: 0.3, friction: 0.3_f64.tan() };
    let s = end!(&m, [0.0; 3], [0.1, 1.0, 0.0], method, 0.6);
    let sum = |v: &SVector<f64, 3>| v.norm() + v[0];
    (sum(&s.v) - sum(&[0.1, 1.0, 0.0].into())).abs()
}
