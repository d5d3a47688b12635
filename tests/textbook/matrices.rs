//! Physical matrices: projectors, rotations, cross products and inertias as expressions and outputs.

use linkwork::nalgebra::{Matrix3, Rotation3, Vector3};
use linkwork::prelude::*;
use linkwork::rotation::{reciprocal, unvectorized, vectorized, wedge};
use support::random::Random;

/// Carrier in space with a wheel on a skew axle.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct CarrierWithSkewWheel {
    mass: f64,
    #[body(mass = 3, com = 0.1 * x - 0.2 * y, inertia = [[0.3, 0.02, 0], [0.02, 0.4, 0.01], [0, 0.01, 0.5]])]
    hull: Body,
    #[body(mass = mass, com = 0.2 * z, inertia = diagonal(0.1, 0.2, gyration * mass))]
    wheel: Body,
    #[define(0.15)]
    gyration: Scalar,
    #[joint(ground -> hull)]
    flight: Free,
    #[joint(hull.at(0.3 * x).rotated(y(0.4)) -> wheel, about = z)]
    axle: Pin,
    #[frame(wheel, x(0.3))]
    askew: Frame,
    #[point(on = wheel, at = 0.2 * z)]
    middle: Point,
    #[define(rotation(wheel / hull))]
    turned: Matrix,
    #[define(inertia(wheel / middle))]
    central: Matrix,
    #[output(turned, resolved_in = hull)]
    relative: Matrix,
    #[output(rate(turned / hull), resolved_in = hull)]
    relative_rate: Matrix,
    #[output(skew(omega(wheel / hull)) * turned, resolved_in = hull)]
    poisson: Matrix,
    #[output(rotation(askew / ground) * transpose(rotation(askew / ground)) - identity())]
    nothing: Matrix,
    #[output(rotation(askew / ground))]
    orientation: Matrix,
    #[output(central, resolved_in = wheel)]
    moments: Matrix,
    #[output(rate(central / ground), resolved_in = hull)]
    moments_rate: Matrix,
    #[output(
        skew(omega(wheel / ground)) * central - central * skew(omega(wheel / ground)), resolved_in = hull
    )]
    turning: Matrix,
    #[output(inertia((hull, wheel) / ground) * z)]
    column: Vector,
    #[output(central * omega(wheel / ground), resolved_in = hull)]
    spin: Vector,
    #[output(angular_momentum(wheel / middle), resolved_in = hull)]
    angular: Vector,
    #[output(projector(askew.y) * r(wheel / ground) - project(r(wheel / ground), askew.y))]
    along: Vector,
    #[output((identity() - projector(askew.y)) * r(wheel / ground), resolved_in = askew)]
    across: Vector,
    #[output(r(wheel / ground), resolved_in = askew)]
    place: Vector,
    #[output(trace(2 * turned / 4 + outer(hull.x, hull.y) - -skew(hull.z)))]
    cosine: Scalar,
    #[output([[1, 2, 0], [0, 1, 0], [0, 0, 3]] * x + transpose([[1, 2, 0], [0, 1, 0], [0, 0, 3]]) * x)]
    rows: Vector,
}

#[test]
fn matrix_expressions_equal_vector_expressions() {
    let (m, mut random) = (CarrierWithSkewWheel { mass: 1.7 }, Random::new(31));
    for _ in 0..4 {
        let (q, v): (SVector<f64, 8>, SVector<f64, 7>) =
            (random.random_configuration(&m), random.random_vector(2.0));
        let hull = m.frame_placement(frame!(CarrierWithSkewWheel, "hull"), &q).rotation;
        let wheel = m.frame_placement(frame!(CarrierWithSkewWheel, "wheel"), &q).rotation;
        // A rotation has the same components in both of its frames.
        assert!((m.relative(&q) - (hull.inverse() * wheel).matrix()).amax() < 1e-14);
        let askew = wheel * Rotation3::from_axis_angle(&Vector3::x_axis(), 0.3);
        assert!((m.orientation(&q) - askew.matrix()).amax() < 1e-14);
        assert!(m.nothing(&q).amax() < 1e-14);
        // Poisson's equation, also checked by differences along the motion.
        let h = 1e-6;
        let difference =
            (m.relative(&m.integrate(&q, &(v * h))) - m.relative(&m.integrate(&q, &(v * -h)))) / (2.0 * h);
        assert!((m.relative_rate(&q, &v) - m.poisson(&q, &v)).amax() < 1e-13);
        assert!((m.relative_rate(&q, &v) - difference).amax() < 1e-8);
        // An inertia is constant in its body's frame; in another frame its rate is Ω J − J Ω.
        assert!((m.moments(&q) - Matrix3::from_diagonal(&Vector3::new(0.1, 0.2, 0.255))).amax() < 1e-14);
        assert!((m.moments_rate(&q, &v) - m.turning(&q, &v)).amax() < 1e-12);
        assert!(m.moments_rate(&q, &v).amax() > 1e-3);
        assert!((m.spin(&q, &v) - m.angular(&q, &v)).amax() < 1e-13);
        // Projectors along and across an axis.
        assert!(m.along(&q).amax() < 1e-13);
        let place = m.place(&q);
        assert!((m.across(&q) - SVector::from([place[0], 0.0, place[2]])).amax() < 1e-13);
        // The trace of the rotation between the frames is 2 cos θ + 1, with their angle θ.
        let angle = (hull.inverse() * wheel).angle();
        assert!((m.cosine(&q) - (2.0 * angle.cos() + 1.0) / 2.0).abs() < 1e-13);
        assert!((m.rows(&q) - SVector::from([2.0, 2.0, 0.0])).amax() < 1e-15);
        // The moment of inertia of all bodies about z is twice their energy of unit rotation about it.
        let z = Vector3::z();
        let energy_of_rotation = |w: Vector3<f64>| {
            let at = m.frame_placement(frame!(CarrierWithSkewWheel, "hull"), &q);
            let (w, v) = (hull.inverse() * w, hull.inverse() * w.cross(&at.translation.vector));
            m.kinetic_energy(&q, &SVector::from([v.x, v.y, v.z, w.x, w.y, w.z, 0.0]))
        };
        assert!((m.column(&q)[2] - 2.0 * energy_of_rotation(z)).abs() < 1e-12);
    }
}

/// Free body whose velocity has components along three of its directions that are not perpendicular, with
/// reciprocal vectors as expressions.
#[mechanism]
struct BodyWithObliqueAxes {
    #[body(mass = 1, inertia = sphere(1, 1))]
    body: Body,
    #[joint(ground -> body)]
    flight: Free,
    #[define(body.x + 0.5 * body.y)]
    first: Vector,
    #[define(body.y - 0.3 * body.z)]
    second: Vector,
    #[define(body.z + 0.2 * body.x + 0.4 * body.y)]
    third: Vector,
    #[define(dot(first, cross(second, third)))]
    volume: Scalar,
    #[define(v(body / ground / ground))]
    velocity: Vector,
    #[output(dot(velocity, cross(second, third)) / volume)]
    along_first: Scalar,
    #[output(dot(velocity, cross(third, first)) / volume)]
    along_second: Scalar,
    #[output(dot(velocity, cross(first, second)) / volume)]
    along_third: Scalar,
}

#[test]
fn outputs_may_have_oblique_components() {
    let frame = Matrix3::new(1.0, 0.0, 0.2, 0.5, 1.0, 0.4, 0.0, -0.3, 1.0);
    let dual = reciprocal(&frame).unwrap();
    let (m, mut random) = (BodyWithObliqueAxes {}, Random::new(11));
    for _ in 0..5 {
        let (q, v): (SVector<f64, 7>, SVector<f64, 6>) =
            (random.random_configuration(&m), random.random_vector(2.0));
        let found = Vector3::new(m.along_first(&q, &v), m.along_second(&q, &v), m.along_third(&q, &v));
        // Velocities of free joints are in body axes.
        let linear = Vector3::new(v[0], v[1], v[2]);
        assert!((found - dual.transpose() * linear).amax() < 1e-13, "{found}");
        assert!((frame * found - linear).amax() < 1e-13, "{found}");
    }
}

/// Components along vectors that are not perpendicular follow from `g₁ = f₂ × f₃ / (f₁ · f₂ × f₃)` and so on,
/// and from Cramer's rule.
#[test]
fn oblique_components_follow_from_reciprocal_vectors() {
    let mut random = Random::new(6);
    for _ in 0..5 {
        let f = [0, 1, 2].map(|_| random.random_vector::<3>(2.0));
        let volume = f[0].dot(&f[1].cross(&f[2]));
        let g = reciprocal(&Matrix3::from_columns(&f)).unwrap();
        let scale = 1.0 + g.amax();
        for k in 0..3 {
            let (next, last) = (f[(k + 1) % 3], f[(k + 2) % 3]);
            assert!((g.column(k) - next.cross(&last) / volume).amax() < 1e-12 * scale);
            let v: Vector3<f64> = random.random_vector(1.0);
            let cramer = v.dot(&next.cross(&last)) / volume;
            assert!((g.column(k).dot(&v) - cramer).abs() < 1e-12 * scale);
        }
    }
}

/// `A X + X B = C` is `(1 ⊗ A + Bᵀ ⊗ 1) vec X = vec C`; a wedge product is the matrix of the cross product,
/// `(a ∧ b) v = (a × b) × v`.
#[test]
fn kronecker_products_solve_sylvesters_equation() {
    let mut random = Random::new(7);
    let mut matrix = || Matrix3::from_columns(&[0, 1, 2].map(|_| random.random_vector::<3>(1.0)));
    let (one, shift) = (Matrix3::<f64>::identity(), Matrix3::identity() * 4.0);
    for _ in 0..5 {
        let (a, b, c) = (matrix() + shift, matrix() + shift, matrix());
        let system = one.kronecker(&a) + b.transpose().kronecker(&one);
        let x = unvectorized(&system.lu().solve(&vectorized(&c)).unwrap());
        assert!((a * x + x * b - c).amax() < 1e-13);
        let [p, q, v] = [0, 1, 2].map(|k| c.column(k).into_owned());
        assert!((wedge(&p, &q) * v - p.cross(&q).cross(&v)).amax() < 1e-14);
    }
}
