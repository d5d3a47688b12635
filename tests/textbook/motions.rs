//! Characteristic points of motions, momenta of several bodies, rates of vectors, and points of a body given
//! in other axes.

use linkwork::prelude::*;
use support::random::Random;
use support::with_common_fields;

/// Ladder that slides down a wall: its ends are on the floor and on the wall.
#[mechanism(gravity = -9.81 * y)]
struct Ladder {
    l: f64,
    theta: Coordinate,
    #[frame(ground, z(-theta))]
    along: Frame,
    #[body(mass = 7, com = l / 2 * x, inertia = rod(7, l, x), at = l * sin(theta) * y, frame = along)]
    ladder: Body,
    #[output(r(ladder / ground) + instant_center(ladder / ground))]
    rests: Vector,
    #[output(r(ladder / ground) + acceleration_center(ladder / ground))]
    unmoved: Vector,
    #[output(r(ladder / ground) + screw_axis(ladder / ground))]
    axis: Vector,
}

/// The instantaneous centre of velocity is the intersection of the normals of wall and floor. At the instant
/// of release it is also the centre of acceleration, whose acceleration is zero in any state.
#[test]
fn ladder_rotates_about_its_instantaneous_centre() {
    let (m, mut random) = (Ladder { l: 3.0 }, Random::new(8));
    for _ in 0..5 {
        let (q, v, a): (SVector<f64, 1>, _, _) =
            (random.random_vector(1.0), random.random_vector(2.0), random.random_vector(3.0));
        let corner = SVector::from([m.l * q[0].cos(), m.l * q[0].sin(), 0.0]);
        assert!((m.rests(&q, &v) - corner).amax() < 1e-12);
        assert!((m.axis(&q, &v) - corner).amax() < 1e-12);
        assert!((m.unmoved(&q, &[0.0].into(), &a) - corner).amax() < 1e-12);
        let frame = frame!(Ladder, "ladder");
        let (twist, rates) = (m.frame_velocity(frame, &q, &v), m.frame_acceleration(frame, &q, &v, &a));
        let linear_and_angular =
            |t: &SVector<f64, 6>| (t.fixed_rows::<3>(0).into_owned(), t.fixed_rows::<3>(3).into_owned());
        let ((_, w), (linear, angular)) = (linear_and_angular(&twist), linear_and_angular(&rates));
        let p = m.unmoved(&q, &v, &a) - m.frame_placement(frame, &q).translation.vector;
        assert!((linear + angular.cross(&p) + w.cross(&w.cross(&p))).amax() < 1e-10);
    }
}

/// Wheel that rolls along a straight line.
#[mechanism]
struct Wheel {
    radius: f64,
    turned: Coordinate,
    #[frame(ground, z(-turned))]
    spokes: Frame,
    #[body(mass = 1, inertia = disk(1, radius, z), at = radius * turned * x + radius * y, frame = spokes)]
    wheel: Body,
    #[output(r(wheel / ground) + instant_center(wheel / ground))]
    rests: Vector,
    #[output(acceleration_center(wheel / ground))]
    unmoved: Vector,
}

#[test]
fn wheel_rotates_about_its_contact_point() {
    let (m, q, v) = (Wheel { radius: 0.3 }, [2.0].into(), [5.0].into());
    assert!((m.rests(&q, &v) - SVector::from([0.6, 0.0, 0.0])).amax() < 1e-14);
    assert!(m.unmoved(&q, &v, &[0.0].into()).amax() < 1e-14);
}

/// Two rotations about skew axes, at a distance along z.
#[mechanism]
struct RotationsAboutSkewAxes {
    d: f64,
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    first: Body,
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    second: Body,
    #[joint(ground -> first, about = x)]
    low: Pin,
    #[joint(first.at(d * z) -> second, about = y)]
    high: Pin,
    #[output(r(second / ground) + screw_axis(second / ground))]
    axis: Vector,
    #[output(screw_pitch(second / ground))]
    pitch: Scalar,
    #[output(screw_pitch(second / first))]
    of_pin: Scalar,
}

/// The screw axis of two rotations is on Plücker's conoid: at the height `d w₂² / (w₁² + w₂²)`, with the
/// pitch `−d w₁ w₂ / (w₁² + w₂²)` (Ball, *A Treatise on the Theory of Screws*, 1900, § 13).
#[test]
fn two_rotations_form_a_screw_of_the_cylindroid() {
    let (m, q) = (RotationsAboutSkewAxes { d: 0.4 }, SVector::zeros());
    for (w1, w2) in [(1.0, 2.0), (-3.0, 0.5), (0.7, -0.7)] {
        let (v, square) = ([w1, w2].into(), w1 * w1 + w2 * w2);
        assert!((m.axis(&q, &v) - SVector::from([0.0, 0.0, 0.4 * w2 * w2 / square])).amax() < 1e-14);
        assert!((m.pitch(&q, &v) + 0.4 * w1 * w2 / square).abs() < 1e-14);
        assert_eq!(m.of_pin(&q), 0.0);
    }
}

/// Nut on a screw whose axis does not pass through the origin.
#[mechanism]
struct Nut {
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    nut: Body,
    #[joint(ground.at(0.5 * x) -> nut.at(-0.2 * y), about = z, pitch = 0.03)]
    thread: Screw,
    #[output(screw_pitch(nut / ground))]
    pitch: Scalar,
    #[output(r(nut / ground) + screw_axis(nut / ground))]
    axis: Vector,
}

#[test]
fn nut_motion_has_the_screw_axis_and_pitch_of_its_thread() {
    let (q, v) = ([0.8].into(), [3.0].into());
    assert!((Nut {}.pitch(&q, &v) - 0.03).abs() < 1e-16);
    assert!((Nut {}.axis(&q, &v) - SVector::from([0.5, 0.0, 0.03 * 0.8])).amax() < 1e-15);
}

/// Bat that moves freely in its plane, hit at its centre of percussion with respect to the grip.
#[mechanism]
struct Bat {
    l: f64,
    #[body(mass = 2, com = l / 2 * x, inertia = rod(2, l, x))]
    bat: Body,
    #[joint(ground -> bat, about = z)]
    plane: Planar,
    #[point(on = bat, at = 2 * l / 3 * x)]
    sweet: Point,
    #[acts(on = bat.at(2 * l / 3 * x), along = y)]
    blow: Force,
    #[output(center_of_percussion(bat / bat, ground.z), resolved_in = bat)]
    found: Vector,
    #[output(center_of_percussion(bat / bat.at(0.1 * x), z), resolved_in = bat)]
    further: Vector,
}

/// The centre of percussion of a rod with respect to its end is at two thirds of the length: an impulse there
/// leaves the end at rest.
#[test]
fn impulse_at_the_centre_of_percussion_leaves_the_grip_at_rest() {
    let (m, q, v) = (Bat { l: 0.9 }, [0.3, 0.1, 0.7].into(), SVector::zeros());
    assert!((m.found(&q) - SVector::from([0.6, 0.0, 0.0])).amax() < 1e-15);
    let sweet = m.frame_placement(frame!(Bat, "sweet"), &q) * linkwork::nalgebra::Point3::origin();
    let grip = m.frame_placement(frame!(Bat, "bat"), &q);
    assert!((grip.rotation * m.found(&q) + grip.translation.vector - sweet.coords).amax() < 1e-15);
    let a = m.forward_dynamics(&q, &v, &m.generalized_forces(&q, &[10.0].into()));
    let rate = m.frame_acceleration(frame!(Bat, "bat"), &q, &v, &a);
    assert!(rate.fixed_rows::<3>(0).amax() < 1e-13 && rate[5] > 1.0);
    // With respect to another point it is at I + m d² over m d.
    let d: f64 = 0.45 - 0.1;
    assert!((m.further(&q)[0] - (0.9_f64.powi(2) / 12.0 + d * d) / d).abs() < 1e-14);
}

/// Carrier with an arm, a bead, and a torque on the carrier.
#[mechanism(derivatives)]
struct CarrierWithArmAndBead {
    mass: f64,
    #[body(mass = 3, com = 0.1 * x - 0.2 * y, inertia = [[0.3, 0.02, 0], [0.02, 0.4, 0.01], [0, 0.01, 0.5]])]
    hull: Body,
    #[body(mass = mass, com = 0.2 * z, inertia = diagonal(0.1, 0.2, gyration * mass))]
    arm: Body,
    #[define(0.15)]
    gyration: Scalar,
    #[joint(ground -> hull)]
    flight: Free,
    #[joint(hull.at(0.3 * x) -> arm, about = y)]
    axle: Pin,
    #[particle(mass = 0.5, at = arm.at(0.1 * x + 0.2 * y))]
    bead: Particle,
    #[acts(on = hull, about = hull.z)]
    jet: Torque,
    #[define(angular_momentum((hull, arm, bead) / ground))]
    whole: Vector,
    #[define(momentum((hull, arm, bead)))]
    linear: Vector,
    #[output(whole)]
    angular: Vector,
    #[output(rate(whole / ground))]
    torque: Vector,
    #[output(rate(whole / arm) + cross(omega(arm / ground), whole))]
    transported: Vector,
    #[output(rate(linear / ground))]
    force: Vector,
    #[output(center_of_mass((hull, arm, bead) / ground))]
    center: Vector,
    #[output(center_of_mass((arm, bead) / hull), resolved_in = hull)]
    part: Vector,
    #[output(kinetic_energy((hull, arm, bead)))]
    energy: Scalar,
    #[output(moment_of_inertia((hull, arm) / bead, arm.x, hull.z))]
    product: Scalar,
    #[output(moment_of_inertia(hull / bead, arm.x, hull.z) + moment_of_inertia(arm / bead, arm.x, hull.z))]
    parts: Scalar,
}

/// Checks Euler's laws for several bodies: momenta add up to those of the whole, and change only by external
/// forces and torques. In a rotating frame, the rate of a vector is smaller by `ω × h` (transport theorem).
#[test]
fn eulers_laws_hold_for_a_set_of_bodies() {
    let (m, mut random) = (CarrierWithArmAndBead { mass: 1.7 }, Random::new(3));
    for _ in 0..5 {
        let (q, v): (SVector<f64, 8>, SVector<f64, 7>) =
            (random.random_configuration(&m), random.random_vector(2.0));
        let u = random.random_vector(1.0);
        let whole = m.momentum(&q, &v);
        let (linear, spin) = (whole.fixed_rows::<3>(0).into_owned(), whole.fixed_rows::<3>(3).into_owned());
        assert!((m.center(&q) - m.center_of_mass(&q)).amax() < 1e-14);
        assert!((m.angular(&q, &v) - spin - m.center_of_mass(&q).cross(&linear)).amax() < 1e-12);
        assert!((m.energy(&q, &v) - m.kinetic_energy(&q, &v)).abs() < 1e-12);
        assert!((m.product(&q) - m.parts(&q)).abs() < 1e-13);
        let a = m.forward_dynamics(&q, &v, &m.generalized_forces(&q, &u));
        let hull = m.frame_placement(frame!(CarrierWithArmAndBead, "hull"), &q);
        let torque = hull.rotation * linkwork::nalgebra::Vector3::z() * u[0];
        assert!((m.torque(&q, &v, &a) - torque).amax() < 1e-11);
        assert!((m.transported(&q, &v, &a) - torque).amax() < 1e-11);
        assert!(m.force(&q, &v, &a).amax() < 1e-11);
        let (arm, bead) = (frame!(CarrierWithArmAndBead, "arm"), frame!(CarrierWithArmAndBead, "bead"));
        let arm = m.frame_placement(arm, &q) * linkwork::nalgebra::Point3::new(0.0, 0.0, 0.2);
        let bead = m.frame_placement(bead, &q).translation.vector;
        let both = (arm.coords * 1.7 + bead * 0.5) / 2.2 - hull.translation.vector;
        assert!((m.part(&q) - hull.rotation.inverse() * both).amax() < 1e-14);
    }
}

with_common_fields! {
    {
        radius: f64,
        #[body]
        hub: Body,
        #[body]
        fork: Body,
        #[body(mass = 2, inertia = disk(2, radius, y))]
        wheel: Body,
        #[joint(ground -> hub, along = (x, y, z))]
        place: Stage,
        #[joint(hub -> fork, about = (z, x))]
        lean: Universal,
        #[joint(fork -> wheel, about = y)]
        spin: Pin,
    }

    /// Wheel on three axes that rolls by a rolling pair of surfaces.
    #[mechanism(gravity = -9.81 * z)]
    struct RollingWheel {
        #[constraint(rolls(wheel.circle(radius, y), ground.plane(z)))]
        contact: Rolling,
    }

    /// The wheel of [`RollingWheel`] with its lowest point given in the axes of the fork: this point is on
    /// the ground, and at rest.
    #[mechanism(gravity = -9.81 * z)]
    struct WheelByPointConstraints {
        #[constraint(dot(r(wheel.at(-radius * fork.z) / ground), z))]
        height: Holonomic,
        #[constraint(dot(v(wheel.at(-radius * fork.z) / ground / ground), x))]
        forth: Nonholonomic,
        #[constraint(dot(v(wheel.at(-radius * fork.z) / ground / ground), y))]
        across: Nonholonomic,
        #[acts(on = wheel.at(-radius * fork.z), along = fork.x)]
        rubs: Force,
        #[acts(on = wheel.at(-radius * fork.z), value = 3 * fork.x)]
        pushes: Force,
        #[output(v(wheel.at(-radius * fork.z) / ground / ground))]
        slides: Vector,
        #[output(dot(v(wheel.at(-radius * fork.z) / ground / ground), fork.x))]
        forward: Scalar,
    }
}

#[test]
fn wheel_rolls_on_a_point_in_fork_axes() {
    let (pair, written, mut random) =
        (RollingWheel { radius: 0.4 }, WheelByPointConstraints { radius: 0.4 }, Random::new(21));
    for _ in 0..4 {
        let mut q: SVector<f64, 6> = random.random_vector(0.8);
        q[2] = 0.4 * q[4].cos();
        let mut v: SVector<f64, 6> = random.random_vector(2.0);
        v.fixed_rows_mut::<3>(0).fill(0.0);
        let slides = written.slides(&q, &v);
        v.fixed_rows_mut::<3>(0).copy_from(&-slides);
        assert!(written.slides(&q, &v).amax() < 1e-14);
        let tau = random.random_vector(1.0);
        // A force at a point at rest does no work and does not change the motion.
        let a = written.forward_dynamics(&q, &v, &tau);
        let expected = pair.forward_dynamics(&q, &v, &tau);
        assert!((a - expected).amax() < 1e-9 * (1.0 + expected.amax()), "{a} {expected}");
        // If the point slides, the generalized forces have the power of a force at that point of the wheel.
        let any: SVector<f64, 6> = random.random_vector(2.0);
        let power = written.generalized_forces(&q, &[2.0].into()).dot(&any);
        assert!((power - 2.0 * written.forward(&q, &any)).abs() < 1e-13);
        assert!((written.disturbance_power(&q, &any) - 3.0 * written.forward(&q, &any)).abs() < 1e-13);
    }
}

/// Two pendulums: the inertia of one is given about its pivot, that of the other about a point other than its
/// centre of mass.
#[mechanism(gravity = -9.81 * y)]
struct PendulumsWithShiftedInertia {
    j: f64,
    #[body(mass = 2, com = 0.1 * x - 0.5 * y, inertia = [[j, 0.1, 0], [0.1, 0.3, 0], [0, 0, j]], about = 0)]
    rod: Body,
    #[body(mass = 2, com = 0.1 * x, inertia = diagonal(0.3, 0.1, 0.3), about = 0.1 * x - 0.3 * y)]
    other: Body,
    #[joint(ground -> rod, about = z)]
    hinge: Pin,
    #[joint(ground -> other, about = z)]
    second: Pin,
}

#[test]
fn inertia_about_another_point_is_moved_to_the_centre_of_mass() {
    let m = PendulumsWithShiftedInertia { j: 0.7 };
    let mass = m.mass_matrix(&[0.3, 0.2].into());
    // The moment of inertia about the pivot is the given value.
    assert!((mass[(0, 0)] - 0.7).abs() < 1e-15);
    // 0.3 − 2 · 0.3² about the centre of mass, and 2 · 0.1² more about the pivot.
    assert!((mass[(1, 1)] - (0.3 - 0.18 + 0.02)).abs() < 1e-15);
}

/// Motor that drives a flywheel with drag, with the work of each as a state.
#[mechanism]
struct Flywheel {
    #[body(mass = 1, inertia = diagonal(0.3, 0.3, 0.5))]
    wheel: Body,
    #[joint(ground -> wheel, about = z)]
    axle: Pin,
    #[acts(on = axle)]
    motor: Torque,
    #[acts(on = axle, damping = 0.3)]
    drag: Dashpot,
    #[state(rate = power(motor))]
    work: State,
    #[state(rate = -power(drag))]
    lost: State,
}

/// Checks work as a first-order state, which integrates the power of a force.
#[test]
fn work_state_integrates_the_power_of_a_force() {
    let m = Flywheel { work: 0.0, lost: 0.0 };
    let whole = m.extended();
    let run = simulate(&whole).from([0.2], [1.0, 0.0, 0.0]).inputs(|t, _, _| [2.0 * t].into());
    let end = run.method(DormandPrince::new().tolerance(1e-11, 1e-11)).duration(3.0).finish().unwrap();
    let gained = 0.25 * (end.v[0] * end.v[0] - 1.0);
    assert!((end.v[1] - end.v[2] - gained).abs() < 1e-8, "{} {} {gained}", end.v[1], end.v[2]);
    // 0.5 ω′ = 2 t − 0.3 ω has the solution ω = a t + b + c exp(−k t) with k = 0.6; the work is the integral
    // of 2 t ω.
    let (k, a) = (0.6_f64, 2.0 / 0.3);
    let (b, e) = (-a / k, (-3.0 * k).exp());
    let c = 1.0 - b;
    let work = 2.0 * (a * 9.0 + b * 4.5 + c * (1.0 - e * (1.0 + 3.0 * k)) / (k * k));
    assert!((end.v[1] - work).abs() < 1e-7, "{} {work}", end.v[1]);
}

/// Ball that slides and rotates on a lane, pulled by a force.
#[mechanism(gravity = -9.81 * z)]
struct BallSlidingOnLane {
    mu: f64,
    #[body(mass = 2, inertia = sphere(2, 0.1))]
    ball: Body,
    #[joint(ground.at(0.1 * z) -> ball, along = (x, y, z))]
    place: Stage,
    #[constraint(slips(ball.sphere(0.1), ground.plane(z)), friction = mu, speed = 0.02)]
    lane: Slipping,
    #[acts(on = ball, along = ground.z)]
    presses: Force,
    #[acts(on = place.x, damping = 3)]
    air: Dashpot,
    #[output(power(lane))]
    rubbed: Scalar,
    #[output(power(air) + power(lane))]
    lost: Scalar,
    #[output(power(lane) + 0 * dot(reaction_force(place), x))]
    beside: Scalar,
}

/// Friction dissipates `μ N s² / √(s² + s₀²)` at the slip velocity `s`, for any normal force, and completes
/// the power balance.
#[test]
fn slipping_contact_friction_dissipates_closed_form_power() {
    let m = BallSlidingOnLane { mu: 0.3 };
    let (q, v, u) = (SVector::zeros(), [0.8, -0.6, 0.0].into(), SVector::from([-5.0]));
    let normal = 2.0 * 9.81 + 5.0;
    let expected = -0.3 * normal / 1.0_f64.hypot(0.02);
    assert!((m.rubbed(&q, &v, &u) - expected).abs() < 1e-12, "{} {expected}", m.rubbed(&q, &v, &u));
    assert!((m.lost(&q, &v, &u) - expected + 3.0 * 0.64).abs() < 1e-12);
    assert!((m.beside(&q, &v, &u) - expected).abs() < 1e-12);
    let a = m.forward_dynamics(&q, &v, &m.generalized_forces(&q, &u));
    let gained = 2.0 * a.dot(&v);
    assert!((gained - m.lost(&q, &v, &u)).abs() < 1e-12);
}
