//! Free-body diagrams: the sum of all forces on a body is the rate of its momentum, and their moment is the
//! rate of its angular momentum, both by differences along the motion.

use linkwork::free_body::{Diagram, Origin};
use linkwork::nalgebra::Vector3;
use linkwork::prelude::*;
use support::compare::assert_close;
use support::random::Random;
use support::slider_crank;

mod contacts;
mod places;

/// Error of differences of order two over 2e-4 s.
const DIFFERENCE: f64 = 2e-6;

/// Momentum, angular momentum about the ground's origin, and centre of mass of a body at an instant.
type BodyMomentumState = [SVector<f64, 3>; 3];

/// Compares the sums of the diagram with the rates of the momenta, of which `seen` gives the values at a
/// time.
fn check_free_body_diagram_sums<const N: usize>(
    diagram: &Diagram<f64, N>,
    seen: impl Fn(f64) -> BodyMomentumState,
) {
    let h = 1e-4;
    let (before, now, after) = (seen(-h), seen(0.0), seen(h));
    let momentum_rate = |k: usize| (after[k] - before[k]) / (2.0 * h);
    let size = 1.0 + diagram.actions.iter().map(|action| action.force.norm()).sum::<f64>();
    let force = (diagram.force() - momentum_rate(0)) / size;
    assert!(
        force.norm() < DIFFERENCE,
        "{}: {:?} is not {:?}",
        diagram.body,
        diagram.force(),
        momentum_rate(0)
    );
    let torque = diagram.torque_about(&-now[2]);
    assert!(
        (torque - momentum_rate(1)).norm() / size < DIFFERENCE,
        "{}: {torque:?} is not {:?}",
        diagram.body,
        momentum_rate(1)
    );
}

/// Checks the diagram of an output against the outputs of the body's momenta and centre of mass.
macro_rules! check {
    ($m:expr, $state:expr, $u:expr, $body:ident, $momentum:ident, $angular:ident, $center:ident) => {{
        let (q, v, a) = $state;
        let momenta_after = |h: f64| {
            let (q, v) = ($m.integrate(&q, &(v * h + a * (0.5 * h * h))), v + a * h);
            [$m.$momentum(&q, &v), $m.$angular(&q, &v), $m.$center(&q)]
        };
        check_free_body_diagram_sums(&$m.$body(&q, &v, $u), momenta_after)
    }};
}

/// Three bodies in space with every kind of force element.
#[mechanism(gravity = -9.81 * z)]
struct Arm {
    stiffness: f64,
    #[body(mass = 3, com = 0.2 * x + 0.1 * y, inertia = diagonal(0.2, 0.3, 0.4))]
    first: Body,
    #[body(mass = 2, com = 0.3 * z, inertia = diagonal(0.1, 0.12, 0.15))]
    second: Body,
    #[particle(mass = 0.5, at = second.at(0.4 * x - 0.2 * y))]
    weight: Particle,
    #[body(mass = 1, com = 0.1 * y, inertia = diagonal(0.03, 0.02, 0.025))]
    third: Body,
    #[body(mass = 1.5, com = -0.2 * x, inertia = diagonal(0.05, 0.04, 0.03))]
    free: Body,
    #[point(on = second, at = 0.5 * z)]
    tip: Point,
    #[joint(ground.at(0.3 * y) -> first, about = x)]
    base: Pin,
    #[joint(first.at(0.4 * x).rotated(z(0.5)) -> second.at(0.1 * y))]
    shoulder: Ball,
    #[joint(tip -> third.at(-0.1 * z), about = (x, y))]
    wrist: Universal,
    #[joint(ground -> free)]
    flight: Free,
    #[acts(on = base, stiffness = 12)]
    twist: Spring,
    #[acts(on = wrist.first)]
    motor: Torque,
    #[acts(between = (ground.at(x), second.at(0.3 * x)), stiffness = stiffness, free_length = 0.4)]
    stay: Spring,
    #[acts(between = (first.at(0.2 * z), third.at(0.1 * x)), damping = 4)]
    damper: Dashpot,
    #[acts(between = (second.at(0.2 * y), free.at(0.3 * z)))]
    cylinder: Force,
    #[acts(between = (tip, free), strength = 3)]
    attraction: Attraction,
    #[acts(between = (second, free.at(0.1 * x)), inertance = 0.7)]
    inerter: Inerter,
    #[acts(on = second.at(0.2 * x), along = y + 0.5 * ground.x)]
    jet: Force,
    #[acts(on = second, about = first.z)]
    wheel: Torque,
    #[acts(on = third.at(0.2 * y), value = -0.8 * v(third.at(0.2 * y) / ground / ground))]
    drag: Force,
    #[energy(2.5 * dot(r(second / free), r(second / free)))]
    field: Potential,
    #[dissipation(0.4 * dot(omega(second / third), omega(second / third)))]
    grease: Rayleigh,

    #[output(second)]
    on_second: FreeBody,
    #[output(momentum((second, weight)))]
    p_second: Vector,
    #[output(angular_momentum((second, weight) / ground))]
    h_second: Vector,
    #[output(center_of_mass((second, weight) / ground))]
    c_second: Vector,
    #[output(first)]
    on_first: FreeBody,
    #[output(momentum(first))]
    p_first: Vector,
    #[output(angular_momentum(first / ground))]
    h_first: Vector,
    #[output(center_of_mass(first / ground))]
    c_first: Vector,
    #[output(third)]
    on_third: FreeBody,
    #[output(third, resolved_in = second)]
    on_third_there: FreeBody,
    #[output(momentum(third))]
    p_third: Vector,
    #[output(angular_momentum(third / ground))]
    h_third: Vector,
    #[output(center_of_mass(third / ground))]
    c_third: Vector,
    #[output(free)]
    on_free: FreeBody,
    #[output(momentum(free))]
    p_free: Vector,
    #[output(angular_momentum(free / ground))]
    h_free: Vector,
    #[output(center_of_mass(free / ground))]
    c_free: Vector,
}

#[test]
fn free_body_forces_equal_momentum_rates() {
    let m = Arm { stiffness: 60.0 };
    let mut random = Random::new(23);
    for _ in 0..4 {
        let q = m.integrate(&m.neutral(), &random.random_vector(1.0));
        let v = random.random_vector(2.0);
        let u = random.random_vector(5.0);
        let a = m.forward_dynamics(&q, &v, &m.generalized_forces(&q, &u));
        check!(m, (q, v, a), &u, on_second, p_second, h_second, c_second);
        check!(m, (q, v, a), &u, on_first, p_first, h_first, c_first);
        check!(m, (q, v, a), &u, on_third, p_third, h_third, c_third);
        check!(m, (q, v, a), &u, on_free, p_free, h_free, c_free);
        // A change of axes changes only components.
        let (here, there) = (m.on_third(&q, &v, &u), m.on_third_there(&q, &v, &u));
        assert_close("a force", &[there.force().norm()], &[here.force().norm()], 1e-12);
        assert_close("a torque", &[there.torque().norm()], &[here.torque().norm()], 1e-12);
    }
}

#[test]
fn free_body_actions_equal_their_force_laws() {
    let m = Arm { stiffness: 60.0 };
    let q = m.neutral();
    let (v, u) = (SVector::zeros(), SVector::from_fn(|k, _| 1.0 + k as f64));
    let on_second = m.on_second(&q, &v, &u);
    let names: Vec<&str> = on_second.actions.iter().map(|action| action.name).collect();
    let expected = [
        "gravity",
        "stay",
        "cylinder",
        "attraction",
        "inerter",
        "jet",
        "wheel",
        "field",
        "grease",
        "shoulder",
        "wrist",
    ];
    assert_eq!(names, expected);
    let action_by_name = |name: &str| on_second.get(name).copied().unwrap_or_else(|| panic!("no {name}"));
    assert!((action_by_name("gravity").force - Vector3::new(0.0, 0.0, -2.5 * 9.81)).norm() < 1e-12);
    assert_eq!(
        (action_by_name("gravity").point, action_by_name("jet").origin),
        (Vector3::zeros(), Origin::Input)
    );
    // Forces at points have no torque about them, and torques have no force.
    for name in ["stay", "cylinder", "attraction", "inerter", "jet"] {
        assert_eq!(action_by_name(name).torque, Vector3::zeros(), "{name}");
    }
    assert!(
        action_by_name("wheel").force.norm() < 1e-14
            && (action_by_name("wheel").torque.norm() - 4.0).abs() < 1e-12
    );
    // The origin of the second body is at (0.4, 0.3, 0) + R (0, −0.1, 0), with R of half a radian about z.
    let (s, c) = 0.5_f64.sin_cos();
    let rotated_vector = |x: f64, y: f64, z: f64| Vector3::new(c * x - s * y, s * x + c * y, z);
    let end = Vector3::new(0.4, 0.3, 0.0) + rotated_vector(0.3, -0.1, 0.0);
    let apart = Vector3::new(1.0, 0.0, 0.0) - end;
    let pull = apart * (60.0 * (apart.norm() - 0.4) / apart.norm());
    assert!((action_by_name("stay").force - pull).norm() < 1e-12);
    assert!((action_by_name("stay").point + m.c_second(&q) - end).norm() < 1e-14);
    // Forces between two bodies are opposite and have a common line of action.
    let on_free = m.on_free(&q, &v, &u);
    for name in ["cylinder", "attraction", "inerter", "field"] {
        let other = on_free.get(name).unwrap_or_else(|| panic!("no {name}"));
        assert!((action_by_name(name).force + other.force).norm() < 1e-10, "{name}");
        let torque_about = |a: &linkwork::free_body::Action<f64>, c: SVector<f64, 3>| a.torque_about(&-c);
        let sum = torque_about(&action_by_name(name), m.c_second(&q)) + torque_about(other, m.c_free(&q));
        assert!(sum.norm() < 1e-10, "{name}");
    }
    assert!(on_free.get("flight").is_none());
}

slider_crank! {
    /// Slider-crank, and a rolling disk that carries a pendulum.
    #[mechanism(gravity = -9.81 * y)]
    struct SliderCrankAndRollingDisk {
        slope: f64,
        #[acts(on = main)]
        motor: Torque,
        #[acts(between = (ground.at(0.5 * y), rod.at(0.2 * x)), stiffness = 40, free_length = 0.3)]
        coil: Spring,
        #[output(rod)]
        on_rod: FreeBody,
        #[output(momentum(rod))]
        p_rod: Vector,
        #[output(angular_momentum(rod / ground))]
        h_rod: Vector,
        #[output(center_of_mass(rod / ground))]
        c_rod: Vector,
        #[output(piston)]
        on_piston: FreeBody,

        #[body(mass = 0.8, inertia = disk(0.8, 0.15, z))]
        disk: Body,
        #[joint(ground -> disk, about = z)]
        pose: Planar,
        #[constraint(rolls(disk.circle(0.15, z), ground.plane(sin(slope) * x + cos(slope) * y)))]
        ground_contact: Rolling,
        #[body(mass = 0.4, com = -0.3 * y, inertia = rod(0.4, 0.6, y))]
        bob: Body,
        #[joint(disk.at(0.05 * x) -> bob, about = z)]
        hook: Pin,
        #[output(disk)]
        on_disk: FreeBody,
        #[output(momentum(disk))]
        p_disk: Vector,
        #[output(angular_momentum(disk / ground))]
        h_disk: Vector,
        #[output(center_of_mass(disk / ground))]
        c_disk: Vector,
    }
}

#[test]
fn constraint_and_loop_forces_act_on_their_bodies() {
    let m = SliderCrankAndRollingDisk { slope: 0.3 };
    let (s, c) = 0.3_f64.sin_cos();
    for crank in [0.3_f64, 1.2, -1.0] {
        let guess = SVector::from([crank, -2.0 * crank.sin(), 0.6, 0.15 * s, 0.15 * c, 0.4, 0.7]);
        let q = m.assemble(&guess, &[0, 5, 6]).expect("the rod is long enough");
        let v = m
            .project_velocity(&q, &SVector::from([5.0, 0.0, 0.0, -0.6 * c, 0.6 * s, 4.0, 1.0]))
            .expect("three degrees of freedom");
        let u = SVector::from([3.0]);
        let (a, _) = m.constrained_dynamics(&q, &v, &m.generalized_forces(&q, &u));
        check!(m, (q, v, a), &u, on_rod, p_rod, h_rod, c_rod);
        check!(m, (q, v, a), &u, on_disk, p_disk, h_disk, c_disk);
        let on_disk = m.on_disk(&q, &v, &u);
        let names: Vec<&str> = on_disk.actions.iter().map(|action| action.name).collect();
        assert_eq!(names, ["gravity", "pose", "hook", "ground_contact"]);
        // The plane's force acts at the contact point, a radius below the centre, with no torque about it.
        let below = Vector3::new(-0.15 * s, -0.15 * c, 0.0);
        let plane = on_disk.actions[3];
        assert!((plane.point - below).norm() < 1e-9 && plane.torque == Vector3::zeros());
        assert!(plane.force.dot(&below) < 0.0);
        // The closing joint acts on both of its bodies.
        let (rod, piston) = (m.on_rod(&q, &v, &u), m.on_piston(&q, &v, &u));
        let actions_on_rod_and_piston =
            |name| (rod.get(name).expect("it closes"), piston.get(name).expect("it closes"));
        let (on_rod, on_piston) = actions_on_rod_and_piston("small_end");
        assert!((on_rod.force + on_piston.force).norm() < 1e-9 && on_rod.origin == Origin::Joint);
        assert!(on_rod.torque.norm() < 1e-9 && on_piston.torque.norm() < 1e-9);
    }
}

/// Disk that slips down an incline with dry friction, under a force that depends on time.
#[mechanism(gravity = -9.81 * y)]
struct DrivenSlippingDisk {
    #[body(mass = 0.8, inertia = disk(0.8, 0.15, z))]
    disk: Body,
    #[joint(ground -> disk, about = z)]
    pose: Planar,
    #[constraint(
        slips(disk.circle(0.15, z), ground.plane(unit(0.2 * x + y))),
        friction = 0.3,
        speed = 0.01
    )]
    contact: Slipping,
    #[acts(on = disk.at(0.1 * y), value = sin(3 * t) * ground.x)]
    shake: Force,
    #[output(disk)]
    on_disk: FreeBody,
    #[output(momentum(disk))]
    p: Vector,
    #[output(angular_momentum(disk / ground))]
    h: Vector,
}

#[test]
fn friction_acts_at_the_point_of_the_normal_force() {
    let m = DrivenSlippingDisk {};
    let size = 1.04_f64.sqrt();
    let q = SVector::from([0.15 * 0.2 / size, 0.15 / size, 0.3]);
    let v = SVector::from([0.5 / size, -0.1 / size, 2.0]);
    for t in [0.3, 1.0] {
        let tau = SVector::zeros();
        let (a, normal) = m.constrained_dynamics(t, &q, &v, &tau);
        let diagram = m.on_disk(t, &q, &v);
        check_free_body_diagram_sums(&diagram, |h| {
            let (q, v) = (m.integrate(&q, &(v * h + a * (0.5 * h * h))), v + a * h);
            [m.p(t + h, &q, &v), m.h(t + h, &q, &v), SVector::from([q[0], q[1], 0.0])]
        });
        let contact = diagram.get("contact").expect("it touches");
        let n = Vector3::new(0.2, 1.0, 0.0) / size;
        assert!((contact.force.dot(&n) - normal[0].abs()).abs() < 1e-9);
        let along = contact.force - n * contact.force.dot(&n);
        assert!((along.norm() - 0.3 * normal[0].abs()).abs() < 0.01 * normal[0].abs());
    }
}
