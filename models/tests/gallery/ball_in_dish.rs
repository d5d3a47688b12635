use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork_models::BallInDish;

const B: BallInDish = BallInDish { g: 9.81, mass: 0.2, radius: 0.03, curvature: 0.25 };

/// Returns a state with the ball touching a point of the dish, without rotation. The velocity of the centre
/// is given along the dish's two tangents there, and the spin about the normal.
fn state_of_ball_on_dish(u: f64, w: f64, along: [f64; 2], spin: f64) -> (SVector<f64, 9>, SVector<f64, 8>) {
    let (first, second) = (Vector3::new(1.0, 0.0, u / B.curvature), Vector3::new(0.0, 1.0, w / B.curvature));
    let normal = first.cross(&second).normalize();
    let foot = Vector3::new(u, w, (u * u + w * w) / (2.0 * B.curvature));
    let center = foot + normal * B.radius;
    let velocity = first * along[0] + second * along[1];
    let turning = normal * spin + normal.cross(&velocity) / B.radius;
    let q = [u, w, center.x, center.y, center.z, 0.0, 0.0, 0.0, 1.0];
    let v = [0.0, 0.0, velocity.x, velocity.y, velocity.z, turning.x, turning.y, turning.z].into();
    // The rates of u and w follow from the constraints.
    (q.into(), B.project_velocity(&q.into(), &v).expect("regular"))
}

#[test]
fn ball_circles_at_constant_height_in_dish() -> Result<(), Error> {
    assert_eq!((BallInDish::NC, BallInDish::NH, BallInDish::NP, BallInDish::NS), (5, 3, 5, 3));
    let u = 0.2;
    let slope = Vector3::new(1.0, 0.0, u / B.curvature).normalize();
    let (s, c) = (slope.x, slope.z);
    let rho = u - B.radius * c;
    for spin in [0.0, 40.0, -70.0] {
        let (square, linear) = (1.4 * rho * s, 0.4 * B.radius * spin * c);
        let rate = (-linear + (linear * linear + 4.0 * square * B.g * c).sqrt()) / (2.0 * square);
        let (q, v) = state_of_ball_on_dish(u, 0.0, [0.0, rate * rho], spin);
        assert!(B.constraint_residuals(&q).amax() < 1e-16);
        assert_number_close(v[1], rate * u, 1e-13);
        let (_, lambda) = B.constrained_dynamics(&q, &v, &SVector::zeros());
        let constraint_index =
            |name| BallInDish::CONSTRAINTS.iter().position(|c| *c == name).expect("it is one");
        let normal = B.mass * (rate * rate * rho * c + B.g * s);
        assert_number_close(lambda[constraint_index("contact.normal")], normal, 1e-12);
        for name in ["contact.foot_first", "contact.foot_second"] {
            assert_number_close(lambda[constraint_index(name)], 0.0, 1e-12);
        }
        let time = 1.0;
        let end = simulate(&B).from(q, v).method(precise_integrator()).duration(time).finish()?;
        let (sine, cosine) = (rate * time).sin_cos();
        let expected = [u * cosine, u * sine, rho * cosine, rho * sine, q[4]].into();
        assert_matrix_close(end.q.fixed_rows::<5>(0).into_owned(), expected, 1e-8);
    }
    Ok(())
}

/// Checks that accelerations satisfy Newton's and Euler's equations without the contact force. With the
/// centre on the parallel surface, `v = (r ω) × n` and the weight, `(7/5) a` along the tangents equals the
/// terms of gravity and of the normal's rotation.
#[test]
fn ball_in_dish_satisfies_newton_and_euler() {
    for (u, w, along, spin) in [(0.1, 0.15, [0.3, -0.2], 20.0), (-0.2, 0.05, [-0.5, 0.9], -35.0)] {
        let (q, v) = state_of_ball_on_dish(u, w, along, spin);
        let a = B.forward_dynamics(&q, &v, &SVector::zeros());
        let (velocity, turning) = (Vector3::new(v[2], v[3], v[4]), Vector3::new(v[5], v[6], v[7]));
        let linear = Vector3::new(a[2], a[3], a[4]) + turning.cross(&velocity);
        // The normal and its rate, from the surface's second derivatives.
        let size = (1.0 + (u * u + w * w) / (B.curvature * B.curvature)).sqrt();
        let upward = Vector3::new(-u, -w, B.curvature) / B.curvature;
        let normal = upward / size;
        let turned = Vector3::new(-v[0], -v[1], 0.0) / B.curvature;
        let turned = (turned - normal * normal.dot(&turned)) / size;
        let tangent = Matrix3::identity() - normal * normal.transpose();
        let expected = normal.cross(&turned) * (0.4 * B.radius * spin) - tangent * Vector3::z() * B.g;
        assert_matrix_close(tangent * linear * 1.4, expected, 1e-11);
        // Along the normal the geometry determines the acceleration: n · v is constantly zero.
        assert_number_close(normal.dot(&linear), -turned.dot(&velocity), 1e-12);
        // Spin about the normal: no moment acts about it.
        let spun = Vector3::new(a[5], a[6], a[7]).dot(&normal);
        assert_number_close(spun, 0.0, 1e-10);
    }
}

#[test]
fn ball_in_dish_conserves_energy() -> Result<(), Error> {
    let (q, v) = state_of_ball_on_dish(0.2, -0.1, [0.4, 0.7], 30.0);
    let total_energy = |q: &_, v: &_| B.kinetic_energy(q, v) + B.potential_energy(q);
    let run = simulate(&B).from(q, v).method(precise_integrator()).duration(3.0).sample_every(0.25);
    let (mut lowest, mut highest) = (q[4], q[4]);
    for sample in run {
        let Sample { q: now, v: then, .. } = sample?;
        assert_number_close(total_energy(&now, &then), total_energy(&q, &v), 1e-10);
        assert!(B.constraint_residuals(&now).amax() < 1e-13);
        let turn = UnitQuaternion::from_quaternion([now[5], now[6], now[7], now[8]].into());
        assert!((turn.norm() - 1.0).abs() < 1e-12);
        (lowest, highest) = (lowest.min(now[4]), highest.max(now[4]));
    }
    assert!(highest - lowest > 0.01, "it went from {lowest} to {highest} only");
    Ok(())
}
