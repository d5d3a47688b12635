//! Frames along curves and towards points, curvature and torsion, gradients of fields, cables around bodies,
//! and elements on lengths.

use linkwork::prelude::*;
use std::f64::consts::PI;
use support::random::Random;

/// Bead that slides on a helical wire, with its closed-form equation.
#[mechanism(gravity = -9.81 * z)]
struct BeadOnHelicalWire {
    a: f64,
    b: f64,
    s: Coordinate,
    #[define(a * cos(s) * x + a * sin(s) * y + b * s * z)]
    wire: Vector,
    #[frame(ground, frenet(wire, s))]
    moving: Frame,
    #[particle(mass = 0.2, at = wire)]
    bead: Particle,
    #[output(curvature(wire, s))]
    bend: Scalar,
    #[output(torsion(wire, s))]
    twist: Scalar,
    #[output(a(bead / ground / ground), resolved_in = moving)]
    acceleration: Vector,
    #[output(v(bead / ground / ground), resolved_in = moving)]
    velocity: Vector,
    #[output(omega(moving / ground), resolved_in = moving)]
    turning: Vector,
}

/// A helix with the radius `a` and the pitch `b` per radian has the curvature `a / (a² + b²)` and the torsion
/// `b / (a² + b²)`. The acceleration is `v̇` along the tangent and `κ v²` along the normal; the frame rotates
/// with `v (τ T + κ B)` (Frenet and Serret).
#[test]
fn helix_has_constant_curvature_and_torsion() {
    let (m, mut random) = (BeadOnHelicalWire { a: 0.5, b: 0.2 }, Random::new(4));
    let sum = 0.5 * 0.5 + 0.2 * 0.2;
    for _ in 0..4 {
        let (q, v, a): (SVector<f64, 1>, _, _) =
            (random.random_vector(3.0), random.random_vector::<1>(2.0), random.random_vector::<1>(2.0));
        assert!((m.bend(&q) - 0.5 / sum).abs() < 1e-13);
        assert!((m.twist(&q) - 0.2 / sum).abs() < 1e-13);
        let speed = sum.sqrt() * v[0];
        assert!((m.velocity(&q, &v) - SVector::from([speed, 0.0, 0.0])).amax() < 1e-13);
        let expected = SVector::from([sum.sqrt() * a[0], 0.5 / sum * speed * speed, 0.0]);
        assert!((m.acceleration(&q, &v, &a) - expected).amax() < 1e-12);
        let turning = SVector::from([0.2 / sum * speed, 0.0, 0.5 / sum * speed]);
        assert!((m.turning(&q, &v) - turning).amax() < 1e-12);
    }
}

/// Point on the twisted cubic `(s, s², s³)` on a table that rotates with its own angle, and an ellipse as a
/// function of another coordinate.
#[mechanism]
struct PointOnTwistedCubic {
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    table: Body,
    #[joint(ground -> table, about = z)]
    spindle: Pin,
    s: Coordinate,
    e: Coordinate,
    #[define(s * table.x + s * s * table.y + s * s * s * table.z)]
    cubic: Vector,
    #[particle(mass = 1, at = cubic)]
    bead: Particle,
    #[particle(mass = 1, at = 3 * cos(e) * x + 2 * sin(e) * y)]
    planet: Particle,
    #[output(curvature(cubic, s))]
    bend: Scalar,
    #[output(torsion(cubic, s))]
    twist: Scalar,
    #[output(curvature(r(planet / ground), e))]
    ellipse: Scalar,
    #[output(torsion(r(planet / ground), e))]
    flat: Scalar,
}

/// The twisted cubic has `κ² = 4 (9 s⁴ + 9 s² + 1) / (9 s⁴ + 4 s² + 1)³`, `τ = 3 / (9 s⁴ + 9 s² + 1)`; an
/// ellipse has `κ = a b / (a² sin² e + b² cos² e)^(3/2)` (any table of differential geometry).
#[test]
fn curvature_of_cubics_and_ellipses_has_closed_forms() {
    for (s, e) in [(0.3_f64, 0.4_f64), (-0.8, 2.0), (1.2, -1.0)] {
        let q = [0.7, s, e].into();
        let (a, b) = (9.0 * s.powi(4) + 9.0 * s * s + 1.0, 9.0 * s.powi(4) + 4.0 * s * s + 1.0);
        assert!((PointOnTwistedCubic {}.bend(&q) - 2.0 * a.sqrt() / b.powf(1.5)).abs() < 1e-13);
        assert!((PointOnTwistedCubic {}.twist(&q) - 3.0 / a).abs() < 1e-13);
        let square = 9.0 * e.sin().powi(2) + 4.0 * e.cos().powi(2);
        assert!((PointOnTwistedCubic {}.ellipse(&q) - 6.0 / square.powf(1.5)).abs() < 1e-13);
        assert!(PointOnTwistedCubic {}.flat(&q).abs() < 1e-13);
    }
}

/// Particle in distance, azimuth and elevation, with the local frames of these coordinates.
#[mechanism]
struct ParticleInRadarCoordinates {
    range: Coordinate,
    azimuth: Coordinate,
    elevation: Coordinate,
    #[define(range * cos(elevation) * (cos(azimuth) * x + sin(azimuth) * y) + range * sin(elevation) * z)]
    place: Vector,
    #[particle(mass = 1, at = place)]
    target: Particle,
    #[frame(ground, spherical(r(target / ground)))]
    beam: Frame,
    #[frame(ground, cylindrical(r(target / ground)))]
    bearing: Frame,
    #[output(a(target / ground / ground), resolved_in = beam)]
    by_beam: Vector,
    #[output(a(target / ground / ground), resolved_in = bearing)]
    by_bearing: Vector,
    #[output(r(target / ground), resolved_in = beam)]
    along: Vector,
}

/// Components of an acceleration in spherical and cylindrical coordinates have the textbook expressions.
#[test]
fn spherical_and_cylindrical_accelerations_have_textbook_terms() {
    let mut random = Random::new(9);
    for _ in 0..5 {
        let q: SVector<f64, 3> = random.random_vector::<3>(1.0) + SVector::from([3.0, 0.0, 0.0]);
        let (v, a): (SVector<f64, 3>, SVector<f64, 3>) =
            (random.random_vector(2.0), random.random_vector(2.0));
        let ([r, _, e], [dr, daz, de], [ddr, ddaz, dde]): ([f64; 3], [f64; 3], [f64; 3]) =
            (q.into(), v.into(), a.into());
        let (s, c) = (f64::sin(e), f64::cos(e));
        assert!((ParticleInRadarCoordinates {}.along(&q) - SVector::from([r, 0.0, 0.0])).amax() < 1e-13);
        let expected = SVector::from([
            ddr - r * de * de - r * daz * daz * c * c,
            r * ddaz * c + 2.0 * dr * daz * c - 2.0 * r * daz * de * s,
            r * dde + 2.0 * dr * de + r * daz * daz * s * c,
        ]);
        assert!((ParticleInRadarCoordinates {}.by_beam(&q, &v, &a) - expected).amax() < 1e-11);
        let (rho, drho) = (r * c, dr * c - r * de * s);
        let ddrho = ddr * c - 2.0 * dr * de * s - r * dde * s - r * de * de * c;
        let ddz = ddr * s + 2.0 * dr * de * c + r * dde * c - r * de * de * s;
        let expected = SVector::from([ddrho - rho * daz * daz, rho * ddaz + 2.0 * drho * daz, ddz]);
        assert!((ParticleInRadarCoordinates {}.by_bearing(&q, &v, &a) - expected).amax() < 1e-11);
    }
}

/// Particle in a field, given by its energy and by a force that is the gradient of the same field.
#[mechanism]
struct ParticleInField {
    mu: f64,
    k: f64,
    #[particle(mass = 2)]
    probe: Particle,
    #[joint(ground -> probe, along = (x, y, z))]
    free: Stage,
    #[define(-mu / norm(r(probe / ground)) + k * dot(r(probe / ground), x) * dot(r(probe / ground), y))]
    field: Scalar,
    #[acts(on = probe, value = -gradient(field / probe))]
    pull: Force,
    #[output(gradient(field / probe))]
    slope: Vector,
    #[output(field)]
    height: Scalar,
}

#[test]
fn force_of_a_field_is_its_gradient() {
    let (m, mut random) = (ParticleInField { mu: 3.0, k: 0.5 }, Random::new(2));
    for _ in 0..4 {
        let q: SVector<f64, 3> = random.random_vector(2.0);
        let r = q.norm();
        let expected = q * (3.0 / (r * r * r)) + SVector::from([q[1], q[0], 0.0]) * 0.5;
        assert!((m.slope(&q) - expected).amax() < 1e-12);
        assert!((m.height_jacobian(&q).transpose() - expected).amax() < 1e-12);
        let a = m.forward_dynamics(&q, &SVector::zeros(), &SVector::zeros());
        assert!((a + expected / 2.0).amax() < 1e-12);
    }
}

/// Two particles with a cable between them, around a drum and around a ball.
#[mechanism(derivatives)]
struct Cables {
    radius: f64,
    #[particle(mass = 1)]
    first: Particle,
    #[particle(mass = 1)]
    second: Particle,
    #[joint(ground -> first, along = (x, y, z))]
    one: Stage,
    #[joint(ground -> second, along = (x, y, z))]
    two: Stage,
    #[output(cable(first / second, ground.at(0.1 * x).cylinder(radius, z)))]
    drum: Scalar,
    #[output(cable(second / first, ground.at(0.1 * x).cylinder(radius, -z)))]
    back: Scalar,
    #[output(cable(first / second, ground.sphere(radius)))]
    ball: Scalar,
    #[output(norm(r(first / second)))]
    straight: Scalar,
    #[acts(on = cable(first / second, ground.sphere(radius)))]
    pull: Force,
}

/// Returns the length of the shortest path of two straight lines and a helix, by search over the points of
/// contact with the cylinder that are visible from the ends.
fn shortest_path_length_around_cylinder(a: [f64; 3], b: [f64; 3], radius: f64) -> f64 {
    let length_of_path = |[alpha, beta, za, zb]: [f64; 4]| {
        let point_at_angle_and_height = |angle: f64, z: f64| [radius * angle.cos(), radius * angle.sin(), z];
        let distance_of_points =
            |p: [f64; 3], q: [f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
        distance_of_points(a, point_at_angle_and_height(alpha, za))
            + (radius * (beta - alpha)).hypot(zb - za)
            + distance_of_points(point_at_angle_and_height(beta, zb), b)
    };
    let (from, to) = (a[1].atan2(a[0]), b[1].atan2(b[0]));
    let to = if to < from { to + 2.0 * PI } else { to };
    let [first, last] = [a, b].map(|p| (radius / p[0].hypot(p[1])).acos());
    let mut best = [from, to, a[2], b[2]];
    let mut step = 0.3;
    while step > 1e-5 {
        let tried = (0..8).map(|k| {
            let mut next = best;
            next[k / 2] += if k % 2 == 0 { step } else { -step };
            [next[0].min(from + first), next[1].max(to - last), next[2], next[3]]
        });
        let next = tried.min_by(|p, q| length_of_path(*p).total_cmp(&length_of_path(*q))).unwrap();
        if length_of_path(next) < length_of_path(best) { best = next } else { step /= 2.0 }
    }
    length_of_path(best)
}

#[test]
fn cables_wrap_along_the_shortest_path() {
    let m = Cables { radius: 0.5 };
    let ball_configuration =
        |a: [f64; 3], b: [f64; 3]| SVector::from([a[0] + 0.1, a[1], a[2], b[0] + 0.1, b[1], b[2]]);
    // The cable passes the far side from below to above, level and rising, with more than half a turn of
    // contact.
    for (a, b) in [
        ([0.2, -0.9, 0.0], [-0.1, 1.2, 0.0]),
        ([0.2, -0.9, 0.3], [-0.1, 1.2, 1.1]),
        ([0.1, 0.8, 0.0], [0.9, -0.6, -0.7]),
    ] {
        let q = ball_configuration(a, b);
        let found = m.drum(&q);
        assert!(
            (found - shortest_path_length_around_cylinder(a, b, 0.5)).abs() < 1e-7,
            "{found} {}",
            shortest_path_length_around_cylinder(a, b, 0.5)
        );
        assert!((m.back(&q) - found).abs() < 1e-14);
        assert!(found > m.straight(&q));
    }
    // Half a turn of a level cable with ends that hang straight down: two weights over a pulley.
    let q = ball_configuration([0.5, -2.0, 0.0], [-0.5, -3.0, 0.0]);
    assert!((m.drum(&q) - (2.0 + 3.0 + 0.5 * PI)).abs() < 1e-14);
    // A cable without contact with the drum is straight; a cable without contact with the ball is straight,
    // too.
    let free = ball_configuration([0.7, -1.0, 0.2], [0.9, 1.0, 0.4]);
    assert!((m.drum(&free) - m.straight(&free)).abs() < 1e-14);
    let q = SVector::from([1.0, 0.0, 0.0, 0.0, 0.8, 0.6]);
    assert!((m.ball(&q) - m.straight(&q)).abs() < 1e-14);
    let q = SVector::from([1.0, 0.0, 0.0, -0.8, 0.0, 0.6]);
    let angle = (-0.8_f64).acos() - 2.0 * 0.5_f64.acos();
    assert!((m.ball(&q) - (2.0 * 0.75_f64.sqrt() + 0.5 * angle)).abs() < 1e-14);
}

/// Checks that derivatives of a cable's length equal finite differences, with and without contact with the
/// surface, and that the cable force has the directions of these derivatives.
#[test]
fn cable_lengths_have_exact_derivatives() {
    let (m, h) = (Cables { radius: 0.5 }, 1e-5);
    for q in [
        SVector::from([0.3, -0.9, 0.3, 0.0, 1.2, 1.1]),
        SVector::from([0.8, -1.0, 0.2, 1.0, 1.0, 0.4]),
        SVector::from([1.0, 0.1, 0.0, -0.8, 0.3, 0.6]),
    ] {
        let central_differences = |f: fn(&Cables, &SVector<f64, 6>) -> f64| {
            SVector::<f64, 6>::from_fn(|k, _| {
                let mut step = SVector::zeros();
                step[k] = h;
                (f(&m, &(q + step)) - f(&m, &(q - step))) / (2.0 * h)
            })
        };
        let (drum, ball) = (m.drum_jacobian(&q).transpose(), m.ball_jacobian(&q).transpose());
        assert!((drum - central_differences(Cables::drum)).amax() < 1e-9);
        assert!((ball - central_differences(Cables::ball)).amax() < 1e-9);
        // A taut cable exerts one force on both ends along its own directions, which are unit vectors.
        assert!((drum.fixed_rows::<3>(0).norm() - 1.0).abs() < 1e-12);
        let forces = m.generalized_forces(&q, &[2.0].into());
        assert!((forces - ball * 2.0).amax() < 1e-14);
        assert!((m.drum_derivatives(&q).by_q.transpose() - drum).amax() < 1e-14);
    }
}

/// Lever with a cable drum around its pin, and a weight that hangs from a rope over two pegs.
#[mechanism(gravity = -9.81 * y)]
struct LeverWithDrumAndRope {
    drum: f64,
    stiffness: f64,
    slack: f64,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    lever: Body,
    #[joint(ground -> lever, about = z)]
    pin: Pin,
    #[particle(mass = 3)]
    weight: Particle,
    #[joint(ground -> weight, along = (x, y))]
    hangs: Stage,
    #[acts(on = cable(lever.at(x) / ground.at(-2 * y), ground.cylinder(drum, -z)))]
    winch: Force,
    #[define(norm(r(weight / ground.at(-2 * x))) + norm(r(weight / ground.at(2 * x))))]
    rope: Scalar,
    #[acts(on = rope, stiffness = stiffness, free_length = slack)]
    elastic: Spring,
    #[acts(on = rope, damping = 2)]
    loss: Dashpot,
    #[acts(on = norm(r(weight / ground.at(-2 * x))), value = -7)]
    balloon: Force,
    #[output(power(loss))]
    lost: Scalar,
    #[output(rate(rope))]
    speed: Scalar,
}

#[test]
fn elements_act_on_any_length_expression() {
    let m = LeverWithDrumAndRope { drum: 0.25, stiffness: 40.0, slack: 5.0 };
    // The lever arm of a cable wound on the drum is the drum's radius, for any angle. Without contact, it is
    // the lever arm of the straight line.
    for angle in [1.4, 1.9, 2.3] {
        let q = [angle, 0.3, -1.0].into();
        let torque = m.generalized_forces(&q, &[-10.0].into())[0];
        assert!((torque.abs() - 2.5).abs() < 1e-13, "{torque}");
    }
    let q = [-0.5, 0.3, -1.0].into();
    let (tip, foot) = ([0.5_f64.cos(), -0.5_f64.sin()], [0.0, -2.0]);
    let line = [foot[0] - tip[0], foot[1] - tip[1]];
    let arm = (tip[0] * line[1] - tip[1] * line[0]) / line[0].hypot(line[1]);
    assert!(arm.abs() > 0.25);
    assert!((m.generalized_forces(&q, &[-10.0].into())[0] - 10.0 * arm).abs() < 1e-13);
    // The weight is midway below the pegs: each of the two parts of the rope pulls with its tension at an
    // angle to the vertical.
    let y: f64 = 2.0;
    let q = [0.0, 0.0, -y].into();
    let length = y.hypot(2.0);
    let energy = 0.5 * 40.0 * (2.0 * length - 5.0_f64).powi(2) - 3.0 * 9.81 * y;
    assert!((m.potential_energy(&q) - energy).abs() < 1e-12);
    let bias = m.bias_forces(&q, &SVector::zeros());
    let tension = 40.0 * (2.0 * length - 5.0);
    let holds = 3.0 * 9.81 - 2.0 * tension * y / length;
    // The balloon pulls along one part of the rope towards its peg with 7 N.
    assert!((bias[2] - (holds - 7.0 * y / length)).abs() < 1e-12);
    assert!((bias[1] - 7.0 * 2.0 / length).abs() < 1e-12);
    let v = [0.0, 0.4, -1.0].into();
    let rate = 2.0 * y / length;
    assert!((m.speed(&q, &v) - rate).abs() < 1e-14);
    assert!((m.lost(&q, &v) + 2.0 * rate * rate).abs() < 1e-13);
    assert!((m.dissipated_power(&q, &v) - 2.0 * rate * rate).abs() < 1e-13);
}
