//! Checks of central gravity that acts on points and on extended bodies.

use super::EXACT;
use linkwork::nalgebra::{Matrix3, SVector, Vector1, Vector2, Vector3, Vector6};
use linkwork::{frame, mechanism};
use linkwork_models::TwoBodies;
use std::f64::consts::PI;
use support::compare::assert_close;
use support::random::Random;
use support::simulate::state_after_duration;
use support::table::Record;

#[mechanism]
struct Kepler {
    #[particle(mass = 2)]
    planet: Particle,
    #[joint(ground -> planet, along = (x, y))]
    path: Stage,
    #[acts(between = (ground, planet), mu = 1)]
    sun: Gravity,
}

#[mechanism]
struct KeplerPolar {
    reach: Coordinate,
    anomaly: Coordinate,
    #[frame(ground, z(anomaly))]
    radial: Frame,
    #[particle(mass = 2, at = reach * radial.x)]
    planet: Particle,
    #[acts(between = (ground, planet), mu = 1)]
    sun: Gravity,
}

#[test]
fn kepler_orbit_has_its_period_and_shape() {
    let rows = Record::load("problems/kepler.json").rows_with_key::<5>("trajectory");
    let [_, x, y, vx, vy] = rows[0];
    for [t, x1, y1, vx1, vy1] in &rows[1..] {
        let (q, v) = state_after_duration(&Kepler {}, &Vector2::new(x, y), &Vector2::new(vx, vy), *t);
        assert_close(format!("at {t}"), &[q[0], q[1], v[0], v[1]], &[*x1, *y1, *vx1, *vy1], 1e-9);
        let (q, v) =
            state_after_duration(&KeplerPolar {}, &Vector2::new(x, 0.0), &Vector2::new(0.0, vy / x), *t);
        let (sin, cos) = q[1].sin_cos();
        let polar = [q[0] * cos, q[0] * sin, v[0] * cos - q[0] * v[1] * sin, v[0] * sin + q[0] * v[1] * cos];
        assert_close(format!("polar at {t}"), &polar, &[*x1, *y1, *vx1, *vy1], 1e-9);
    }
}

/// The period of the relative motion is `2 π √(a³ / (G (m₁ + m₂)))`, for any motion of the centre of mass.
#[test]
fn two_bodies_have_the_keplerian_period() {
    let (constant, m1, m2) = (0.8, 3.0, 1.2);
    let bodies = TwoBodies { constant, m1, m2 };
    let total = constant * (m1 + m2);
    let speed = Vector3::new(0.2, 1.3, -0.4_f64);
    let apart = Vector3::new(1.1, 0.1, 0.3_f64);
    let axis = 1.0 / (2.0 / apart.norm() - speed.norm_squared() / total);
    let period = 2.0 * PI * (axis.powi(3) / total).sqrt();
    let drift = Vector3::new(0.3, -0.2, 0.1);
    let q = Vector6::from_iterator([0.0; 3].into_iter().chain(apart.iter().copied()));
    let second = drift + speed;
    let v = Vector6::from_iterator(drift.iter().chain(second.iter()).copied());
    let (q, v) = state_after_duration(&bodies, &q, &v, period);
    assert_close(
        "distance",
        (q.fixed_rows::<3>(3) - q.fixed_rows::<3>(0)).as_slice(),
        apart.as_slice(),
        1e-9,
    );
    assert_close("speed", (v.fixed_rows::<3>(3) - v.fixed_rows::<3>(0)).as_slice(), speed.as_slice(), 1e-9);
}

/// Declares particles, and the pairs of them that attract each other.
macro_rules! attracting {
    ($name:ident: $($x:ident $y:ident $body:ident $mass:literal,)* ; $($pair:ident $a:ident $b:ident,)*) => {
        #[mechanism]
        struct $name {
            $($x: Coordinate,)*
            $($y: Coordinate,)*
            $(#[particle(mass = $mass, at = $x * x + $y * y)] $body: Particle,)*
            $(#[acts(between = ($a, $b), constant = 1)] $pair: Gravity,)*
        }
    };
}
attracting! {
    Pleiades:
    x1 y1 p1 1, x2 y2 p2 2, x3 y3 p3 3, x4 y4 p4 4, x5 y5 p5 5, x6 y6 p6 6, x7 y7 p7 7,;
    g12 p1 p2, g13 p1 p3, g14 p1 p4, g15 p1 p5, g16 p1 p6, g17 p1 p7,
    g23 p2 p3, g24 p2 p4, g25 p2 p5, g26 p2 p6, g27 p2 p7,
    g34 p3 p4, g35 p3 p5, g36 p3 p6, g37 p3 p7,
    g45 p4 p5, g46 p4 p6, g47 p4 p7,
    g56 p5 p6, g57 p5 p7,
    g67 p6 p7,
}

#[test]
fn pleiades_problem_agrees_with_the_reference() {
    let rows = Record::load("problems/pleiades.json").rows_with_key::<29>("trajectory");
    let (mut q, mut v) =
        (SVector::<f64, 14>::from_row_slice(&rows[0][1..15]), SVector::from_row_slice(&rows[0][15..]));
    for pair in rows.windows(2) {
        (q, v) = state_after_duration(&Pleiades {}, &q, &v, pair[1][0] - pair[0][0]);
        assert_close(format!("places at {}", pair[1][0]), q.as_slice(), &pair[1][1..15], 1e-8);
        assert_close(format!("rates at {}", pair[1][0]), v.as_slice(), &pair[1][15..], 1e-8);
    }
}

/// Pitch motion of a satellite on a circular orbit, about the normal of the orbit.
#[mechanism]
struct Satellite {
    n: f64,
    radius: f64,
    a: f64,
    b: f64,
    c: f64,
    #[frame(ground, z(n * t))]
    orbit: Frame,
    #[point(at = radius * orbit.x)]
    place: Point,
    #[body(mass = 1, inertia = diagonal(a, b, c))]
    satellite: Body,
    #[joint(place -> satellite, about = z)]
    attitude: Pin,
    #[acts(between = (ground, satellite), mu = n * n * pow(radius, 3))]
    earth: Gravity,
}

/// The gravity-gradient torque is `−(3/2) n² (B − A) sin 2θ` with the pitch θ from the local vertical, so
/// that small librations have the squared frequency `3 n² (B − A) / C` (Hughes, *Spacecraft Attitude
/// Dynamics*, ch. 9).
#[test]
fn gravity_gradient_torque_of_a_satellite_has_the_closed_form() {
    let (n, radius, a, b, c) = (0.9, 50.0, 1.0, 1.7, 2.2);
    let satellite = Satellite { n, radius, a, b, c };
    for (t, pitch) in [(0.0, 0.3), (0.7, -0.8), (2.0, 1e-4)] {
        let q = Vector1::new(n * t + pitch);
        let torque = 1.5 * n * n * (b - a) * (2.0 * pitch).sin();
        assert_close("mass", satellite.mass_matrix(t, &q).as_slice(), &[c], EXACT);
        assert_close("bias", satellite.bias_forces(t, &q, &Vector1::new(0.4)).as_slice(), &[torque], 1e-11);
    }
    let small = 1e-5;
    let libration = (3.0 * n * n * (b - a) / c).sqrt();
    let end = 2.3;
    let (q, _) = state_after_duration(&satellite, &Vector1::new(small), &Vector1::new(n), end);
    assert_close("libration", &[(q[0] - n * end) / small], &[(libration * end).cos()], 1e-6);
}

/// Satellite with the potential of MacCullagh's formula, in any position and orientation.
#[mechanism]
struct FreeSatellite {
    #[body(mass = 2, inertia = [[0.5, 0.02, -0.01], [0.02, 0.7, 0.03], [-0.01, 0.03, 0.9]])]
    satellite: Body,
    #[joint(ground -> satellite)]
    flight: Free,
    #[acts(between = (ground, satellite), mu = 3)]
    earth: Gravity,
}

/// The satellite and a free planet attract each other; the planet is a sphere.
#[mechanism]
struct PlanetAndSatellite {
    #[body(mass = 1.5, inertia = sphere(1.5, 0.3))]
    planet: Body,
    #[body(mass = 2, inertia = [[0.5, 0.02, -0.01], [0.02, 0.7, 0.03], [-0.01, 0.03, 0.9]])]
    satellite: Body,
    #[joint(ground -> planet, along = (x, y, z))]
    drift: Stage,
    #[joint(ground -> satellite)]
    flight: Free,
    #[acts(between = (planet, satellite), constant = 2)]
    mutual: Gravity,
}

/// A sphere has no gravity-gradient torque, so that the potential is that of the satellite near a centre with
/// `mu = G M`.
#[test]
fn gravity_gradient_between_bodies_has_the_closed_form() {
    let (both, alone) = (PlanetAndSatellite {}, FreeSatellite {});
    let mut random = Random::new(6);
    let q = random.random_configuration(&both);
    let mut seen = alone.neutral();
    seen.copy_from(&q.fixed_rows::<7>(3));
    for k in 0..3 {
        seen[k] -= q[k];
    }
    assert_close("potential", &[both.potential_energy(&q)], &[alone.potential_energy(&seen)], EXACT);
    let bias = both.bias_forces(&q, &SVector::zeros());
    let expected = alone.bias_forces(&seen, &Vector6::zeros());
    assert_close("forces", bias.fixed_rows::<6>(3).as_slice(), expected.as_slice(), EXACT);
}

#[test]
fn gravity_gradient_of_a_free_body_has_the_closed_form() {
    let body = FreeSatellite {};
    let mut random = Random::new(5);
    let q = random.random_configuration(&body);
    let pose = body.frame_placement(frame!(FreeSatellite, "satellite"), &q);
    let r = pose.rotation.inverse() * pose.translation.vector;
    let (d, n) = (r.norm(), r.normalize());
    let inertia = Matrix3::new(0.5, 0.02, -0.01, 0.02, 0.7, 0.03, -0.01, 0.03, 0.9);
    let potential =
        -3.0 * 2.0 / d - 3.0 * (inertia.trace() - 3.0 * n.dot(&(inertia * n))) / (2.0 * d.powi(3));
    assert_close("potential", &[body.potential_energy(&q)], &[potential], EXACT);
    let bias = body.bias_forces(&q, &Vector6::zeros());
    let torque = n.cross(&(inertia * n)) * (3.0 * 3.0 / d.powi(3));
    assert_close("torque", (-bias.fixed_rows::<3>(3)).as_slice(), torque.as_slice(), EXACT);
}
