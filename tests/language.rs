//! Semantics of the language, by values that can be worked out by hand: names, expressions, solids, particles
//! on joints and scalar types.

use linkwork::nalgebra::{Rotation3, SVector, Vector3};
use linkwork::{Mechanism, Real, frame, mechanism};
use linkwork_models::SliderCrank;
use support::compare::assert_close;

const TOLERANCE: f64 = 1e-14;

/// Parameters with names that generated code could use itself, and keywords of Rust.
#[mechanism(gravity = -g * y)]
struct ReservedParameterNames {
    q: f64,
    v: f64,
    a: f64,
    u: f64,
    tau: f64,
    g: f64,
    r#type: f64,
    self_: f64,
    #[body(mass = q, com = v * x + a * y, inertia = diagonal(tau, tau, u + tau))]
    r#in: Body,
    #[body(mass = r#type, com = self_ * x)]
    f64x: Body,
    #[joint(ground -> r#in, about = z)]
    r#fn: Pin,
    #[joint(r#in.at(x) -> f64x, about = z)]
    loop_: Pin,
    #[acts(on = r#fn)]
    r#match: Torque,
}

#[test]
fn field_names_of_all_kinds_compile() {
    let m = ReservedParameterNames {
        q: 2.0,
        v: 0.3,
        a: 0.4,
        u: 0.1,
        tau: 0.05,
        g: 9.81,
        r#type: 3.0,
        self_: 0.5,
    };
    assert_eq!(ReservedParameterNames::CONFIGURATION, ["fn", "loop_"]);
    assert_eq!(ReservedParameterNames::INPUTS, ["match"]);
    assert_eq!(ReservedParameterNames::FRAMES, ["in", "f64x"]);
    let q = SVector::from([0.0, 0.0]);
    let inertia = 0.15 + 2.0 * 0.25 + 3.0 * 1.5 * 1.5;
    assert_close("inertia", &[m.mass_matrix(&q)[0]], &[inertia], TOLERANCE);
    let end = m.frame_placement(frame!(ReservedParameterNames, "f64x"), &q).translation.vector;
    assert_close("end", end.as_slice(), &[1.0, 0.0, 0.0], TOLERANCE);
}

/// Particle that is itself the end of a joint.
#[mechanism(gravity = -9.81 * z)]
struct Projectile {
    m: f64,
    #[particle(mass = m)]
    ball: Particle,
    #[joint(ground -> ball, along = (x, y, z))]
    flight: Stage,
}

#[test]
fn particle_may_be_the_child_of_a_joint() {
    let ball = Projectile { m: 2.0 };
    let a = ball.forward_dynamics(&Vector3::zeros(), &Vector3::x(), &Vector3::new(0.0, 4.0, 0.0));
    assert_close("acceleration", a.as_slice(), &[0.0, 2.0, -9.81], TOLERANCE);
    let place = ball.frame_placement(frame!(Projectile, "ball"), &Vector3::new(1.0, 2.0, 3.0));
    assert_close("place", place.translation.vector.as_slice(), &[1.0, 2.0, 3.0], TOLERANCE);
}

/// Generic parameter with bounds, a where clause and a default.
#[mechanism(gravity = -9.81 * y)]
struct Generic<Number: Real = f64>
where
    Number: PartialOrd,
{
    length: Number,
    #[body(mass = 1, com = length * y)]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    pin: Pin,
}

fn inertia_at_neutral<M, T, const NU: usize>(m: &M) -> T
where
    T: Real,
    M: Mechanism<1, 1, NU, Scalar = T>,
{
    m.mass_matrix(T::zero(), &m.neutral())[0]
}

#[test]
fn mechanisms_are_generic_over_scalars() {
    assert_eq!(inertia_at_neutral(&Generic { length: 0.5_f32 }), 0.25_f32);
    assert_eq!(inertia_at_neutral(&Generic { length: 0.5 }), 0.25);
    let end = Generic { length: 0.5 }.frame_placement(frame!(Generic<f64>, "rod"), &SVector::from([0.0]));
    assert_eq!(end.translation.vector, Vector3::zeros());
}

/// Mechanism declared by expressions with functions, operator precedence, several parameters of one dimension
/// and nested solids.
#[mechanism(gravity = [0, -9.81, 0])]
struct PlateOfExpressions {
    l: f64,
    w: f64,
    angle: f64,
    m: f64,
    #[body(
        mass = 2 * m - m / 2,
        com = (l + w) / 2 * (cos(angle) * x + sin(angle) * y) - -(w * z),
        inertia = rod(m, l, x).rotated(z(angle)) + cuboid(m / 2, l, sqrt(l * w), w)
    )]
    plate: Body,
    #[joint(ground.at(-l * x) -> plate.at(l * x), along = y)]
    rail: Sleeve,
}

#[test]
fn expressions_have_their_documented_values() {
    let (l, w, angle, m) = (0.7_f64, 0.2_f64, 0.4_f64, 1.1_f64);
    let plate = PlateOfExpressions { l, w, angle, m };
    let q = SVector::from([0.3]);
    assert_close("mass", &[plate.total_mass()], &[1.5 * m], TOLERANCE);
    let r = (l + w) / 2.0;
    let center = [r * angle.cos() - 2.0 * l, r * angle.sin() + 0.3, w];
    assert_close("centre of mass", plate.center_of_mass(&q).as_slice(), &center, TOLERANCE);
    let turning = plate.momentum(&q, &SVector::from([2.0]));
    assert_close("momentum", turning.as_slice(), &[0.0, 3.0 * m, 0.0, 0.0, 0.0, 0.0], TOLERANCE);
}

/// Plate on a ball joint, which makes all components of its inertia visible in the mass matrix.
#[mechanism]
struct PlateWithSumOfSolids {
    l: f64,
    w: f64,
    angle: f64,
    m: f64,
    #[body(mass = m, inertia = rod(m, l, x).rotated(z(angle)) + cuboid(m / 2, l, sqrt(l * w), w))]
    plate: Body,
    #[joint(ground -> plate)]
    bearing: Ball,
}

#[test]
fn solid_inertias_add_and_rotate() {
    let (l, w, angle, m) = (0.7_f64, 0.2_f64, 0.4_f64, 1.1_f64);
    let body = PlateWithSumOfSolids { l, w, angle, m };
    let rod = m * l * l / 12.0;
    let (sin, cos) = angle.sin_cos();
    let block = m / 24.0;
    let expected = [
        rod * sin * sin + block * (l * w + w * w),
        -rod * sin * cos,
        rod * cos * cos + block * (l * l + w * w),
        rod + block * (l * l + l * w),
    ];
    let inertia = body.mass_matrix(&body.neutral());
    let actual = [inertia[(0, 0)], inertia[(0, 1)], inertia[(1, 1)], inertia[(2, 2)]];
    assert_close("inertia", &actual, &expected, TOLERANCE);
}

/// Checks that an expression which a user's macro passes on is one operand, even without written parentheses.
#[test]
fn macro_expressions_remain_one_operand() {
    macro_rules! pendulum {
        ($name:ident, $length:expr) => {
            #[mechanism(gravity = -9.81 * y)]
            struct $name {
                #[body(mass = 1, com = -2 * $length * y)]
                rod: Body,
                #[joint(ground -> rod, about = z)]
                pin: Pin,
            }
        };
    }
    pendulum!(Rod, 0.25 + 0.5);
    assert_eq!(Rod {}.mass_matrix(&Rod {}.neutral())[0], 1.5 * 1.5);
}

/// Structure without degrees of freedom: all its functions have empty arguments and results.
#[mechanism]
struct StructureWithoutFreedom {
    #[body(mass = 1)]
    beam: Body,
    #[joint(ground.at(2 * y) -> beam)]
    wall: Weld,
}

#[test]
fn structure_without_joints_compiles() {
    assert_eq!(
        (StructureWithoutFreedom::NQ, StructureWithoutFreedom::NV, StructureWithoutFreedom::NU),
        (0, 0, 0)
    );
    let q = StructureWithoutFreedom {}.neutral();
    assert_eq!(StructureWithoutFreedom {}.potential_energy(&q), 0.0);
    let beam = StructureWithoutFreedom {}
        .frame_placement(frame!(StructureWithoutFreedom, "beam"), &q)
        .translation
        .vector;
    assert_eq!(beam, Vector3::new(0.0, 2.0, 0.0));
    assert_eq!(StructureWithoutFreedom {}.forward_dynamics(&q, &q, &q), q);
}

/// Checks a slider-crank whose loop is closed by a joint. With the crank at a right angle, the position of
/// the piston follows from Pythagoras's theorem, and its velocity equals that of the crank's end. Coordinates
/// and constraint rows have names.
#[test]
fn joint_closing_a_loop_forms_a_slider_crank() {
    let engine = SliderCrank { g: 9.81, r: 0.3, l: 0.5, m_crank: 1.0, m_rod: 0.8, m_piston: 0.4 };
    assert_eq!(SliderCrank::CONFIGURATION, ["main", "big_end", "cylinder"]);
    assert_eq!(SliderCrank::CONSTRAINTS, ["small_end.x", "small_end.y"]);
    let up = std::f64::consts::FRAC_PI_2;
    let q = engine.assemble(&[up, -2.0, 0.5].into(), &[0]).expect("the rod is long enough");
    assert_close("place", q.as_slice(), &[up, -up - 0.6_f64.asin(), 0.4], TOLERANCE);
    let v = engine.project_velocity(&q, &[2.0, 0.0, 0.0].into()).expect("no dead centre");
    // The rod moves without rotation.
    assert_close("rates", &[v[1] / v[0], v[2] / v[0]], &[-1.0, -0.3], TOLERANCE);
}

/// Disk with a rolling pair on a free body.
#[mechanism(gravity = -g * z)]
struct RollingDisk {
    g: f64,
    m: f64,
    radius: f64,

    #[body(mass = m, inertia = disk(m, radius, y))]
    disk: Body,
    #[joint(ground -> disk)]
    pose: Free,
    #[constraint(rolls(disk.circle(radius, y), ground.plane(z)))]
    contact: Rolling,
}

/// Checks a rolling disk in the axes that lean but do not roll, in which the disk rotates by `spin` about y:
/// `u̇₁ = (4 g sin q₂ + 6 r u₂ u₃ − r u₃² tan q₂) / (5 r)`, `u̇₂ = −⅔ u₁ u₃`, `u̇₃ = (−2 u₂ + u₃ tan q₂) u₁`
/// (Neimark and Fufaev, *Dynamics of Nonholonomic Systems*, 1972, ch. II).
#[test]
fn rolling_disk_has_textbook_accelerations() {
    let (g, radius, lean) = (9.81, 0.4, 0.35_f64);
    let disk = RollingDisk { g, m: 2.0, radius };
    assert_eq!(RollingDisk::CONSTRAINTS, ["contact.normal", "contact.x", "contact.y"]);
    assert_eq!((RollingDisk::NH, RollingDisk::NP, RollingDisk::NS), (1, 5, 3));
    let (s, c) = (lean / 2.0).sin_cos();
    let q = SVector::from([0.0, 0.0, radius * lean.cos(), s, 0.0, 0.0, c]);
    let u = [0.7, -3.0, 1.3];
    // The velocity of the centre makes the contact point instantaneously at rest.
    let v = SVector::from([radius * u[1], -radius * u[0], 0.0, u[0], u[1], u[2]]);
    assert_close("touches", disk.constraint_residuals(&q).as_slice(), &[0.0], TOLERANCE);
    assert_close("rolls", disk.constraint_rates(&q, &v).as_slice(), &[0.0; 3], TOLERANCE);
    let tan = lean.tan();
    let spin = u[1] - u[2] * tan;
    let bend = 4.0 * g * lean.sin() + 6.0 * radius * u[1] * u[2] - radius * u[2] * u[2] * tan;
    let expected = [
        bend / (5.0 * radius) - spin * u[2],
        -2.0 * u[0] * u[2] / 3.0,
        (-2.0 * u[1] + u[2] * tan) * u[0] + spin * u[0],
    ];
    let a = disk.forward_dynamics(&q, &v, &SVector::zeros());
    assert_close("acceleration", &a.as_slice()[3..], &expected, 1e-12);
}

/// Cart with outputs and a one-sided spring whose laws contain the minimum or maximum of two expressions.
#[mechanism(derivatives)]
struct MinimumMaximumCart {
    k: f64,
    l: f64,
    #[body(mass = 2)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = rail, energy = k / 2 * pow(min(stretch, 0), 2))]
    buffer: Spring,
    #[output(min(k / l, 1))]
    least: Scalar,
    #[output(max(k / l, rail))]
    most: Scalar,
}

/// Minimum and maximum of numbers with very different magnitudes lose no digits.
#[test]
fn minimum_and_maximum_are_exact() {
    for (k, expected) in [(1e17, 1.0), (1e-20, 1e-20), (f64::INFINITY, 1.0), (-1e300, -1e300), (0.3, 0.3)] {
        let m = MinimumMaximumCart { k, l: 1.0 };
        assert_eq!(m.least(&[0.0].into()), expected);
        assert_eq!(m.most(&[-1e-9].into()), if k < 0.0 { -1e-9 } else { k });
        assert_eq!(m.most(&[1e18].into()), if k == f64::INFINITY { k } else { 1e18 });
    }
    let m = MinimumMaximumCart { k: 50.0, l: 1.0 };
    for (x, force, slope) in [(-0.1, 5.0, -50.0), (0.1, 0.0, 0.0)] {
        let (q, zero) = ([x].into(), [0.0].into());
        assert_eq!(m.bias_forces(&q, &zero)[0], -force);
        let (by_q, _, _) = m.forward_dynamics_derivatives(&q, &zero, &zero);
        assert_eq!(by_q[0], slope / 2.0);
    }
    assert!(MinimumMaximumCart::EQUATIONS.contains("min(rail, 0)"), "{}", MinimumMaximumCart::EQUATIONS);
}

/// Carriage with a buffer that it reaches after a gap, a saturating valve, and a law that is undefined on the
/// other branch.
#[mechanism(derivatives)]
struct CarriageWithPiecewiseLaws {
    gap: f64,
    k: f64,
    least: f64,
    most: f64,
    #[body(mass = 2)]
    carriage: Body,
    #[joint(ground -> carriage, along = x)]
    rail: Sleeve,
    #[acts(on = rail, force = if stretch > gap { k * (stretch - gap) } else { 0 })]
    buffer: Spring,
    #[acts(on = rail, value = if rail < 0 { 40 * pow(-rail, 1.5) } else { 0 })]
    hertz: Force,
    #[define(2 * rate(rail))]
    opening: Scalar,
    #[acts(on = rail, value = -valve)]
    oil: Force,
    #[output(if opening <= least { least } else if opening < most { opening } else { most })]
    saturated: Scalar,
    #[define(if 0.1 < rate(rail) { 0.3 + (rate(rail) - 0.1) } else { 3 * rate(rail) })]
    valve: Scalar,
    #[output(rate(slope))]
    speeding: Scalar,
    #[define(if rail < gap { pow(rail, 2) } else { 2 * gap * rail - pow(gap, 2) })]
    slope: Scalar,
}

#[test]
fn pieces_of_piecewise_functions_hold_in_their_intervals() {
    let m = CarriageWithPiecewiseLaws { gap: 0.5, k: 80.0, least: -0.4, most: 0.6 };
    let spring_force = |x: f64, v: f64| -m.bias_forces(&[x].into(), &[v].into())[0];
    let valve_force = |v: f64| if v > 0.1 { 0.2 + v } else { 3.0 * v };
    for x in [-0.7_f64, -0.01, 0.2, 0.49, 0.51, 1.4] {
        for v in [-2.0, -0.1, 0.05, 0.2, 3.0] {
            let buffer = if x > 0.5 { 80.0 * (x - 0.5) } else { 0.0 };
            let hertz = if x < 0.0 { 40.0 * (-x).powf(1.5) } else { 0.0 };
            assert_close("force", &[spring_force(x, v)], &[hertz - buffer - valve_force(v)], 1e-13);
            assert_eq!(m.saturated(&[x].into(), &[v].into()), (2.0 * v).clamp(-0.4, 0.6));
            let speeding = if x < 0.5 { 2.0 * x * v } else { v };
            assert_close("rate", &[m.speeding(&[x].into(), &[v].into())], &[speeding], 1e-14);
            let (by_q, by_v, _) = m.forward_dynamics_derivatives(&[x].into(), &[v].into(), &[0.0].into());
            let stiffness = if x > 0.5 {
                -80.0
            } else if x < 0.0 {
                -60.0 * (-x).sqrt()
            } else {
                0.0
            };
            assert_close("by q", &[2.0 * by_q[0]], &[stiffness], 1e-13);
            assert_close("by v", &[2.0 * by_v[0]], &[if v > 0.1 { -1.0 } else { -3.0 }], 1e-13);
        }
        // The energy of the buffer is the integral of its force from zero deflection.
        let energy = if x > 0.5 { 40.0 * (x - 0.5) * (x - 0.5) } else { 0.0 };
        assert_close("energy", &[m.potential_energy(&[x].into())], &[energy], 1e-13);
    }
}

/// Airframe with vectors whose components are in its stability and wind axes.
#[mechanism]
struct AirframeWithWindAxes {
    #[body(mass = 2, inertia = diagonal(1, 1, 1))]
    airframe: Body,
    #[joint(ground -> airframe)]
    flight: Free,
    #[define(v(airframe / ground / ground))]
    velocity: Vector,
    #[define(angle_of_attack(airframe, velocity))]
    alpha: Scalar,
    #[define(sideslip(airframe, velocity))]
    beta: Scalar,
    #[output(wind_axes(airframe, velocity, [2, 3, 5]), resolved_in = airframe)]
    in_wind: Vector,
    #[output(stability_axes(airframe, velocity, [2, 3, 5]), resolved_in = airframe)]
    in_stability: Vector,
    #[output(wind_axes(airframe, velocity, [1, 0, 0]))]
    along: Vector,
    #[output(alpha)]
    attack: Scalar,
    #[output(beta)]
    slip: Scalar,
    #[acts(on = airframe, value = wind_axes(airframe, velocity, [-4, 0.5, -7]))]
    air: Force,
}

/// Stability and wind axes follow from the rotations of Etkin and Reid, *Dynamics of Flight* (1996), appendix
/// A.7: by the sideslip about z, then by the angle of attack about y.
#[test]
fn stability_and_wind_axes_rotate_by_their_angles() {
    let (m, mut random) = (AirframeWithWindAxes {}, support::random::Random::new(5));
    for _ in 0..10 {
        let q = random.random_configuration(&m);
        let v: SVector<f64, 6> = random.random_vector(30.0);
        let (alpha, beta) = (m.attack(&q, &v), m.slip(&q, &v));
        let about_y = Rotation3::from_axis_angle(&Vector3::y_axis(), -alpha);
        let both = about_y * Rotation3::from_axis_angle(&Vector3::z_axis(), beta);
        let parts = Vector3::new(2.0, 3.0, 5.0);
        assert_close("wind", m.in_wind(&q, &v).as_slice(), (both * parts).as_slice(), 1e-12);
        assert_close("stability", m.in_stability(&q, &v).as_slice(), (about_y * parts).as_slice(), 1e-12);
        let linear = v.fixed_rows::<3>(0).into_owned();
        assert_close("forward", (both * Vector3::x()).as_slice(), linear.normalize().as_slice(), 1e-12);
        // Drag is the only component of the force that does work.
        let still: SVector<f64, 6> = SVector::from([v[0], v[1], v[2], 0.0, 0.0, 0.0]);
        let force = -m.bias_forces(&q, &still);
        assert_close("power", &[force.dot(&still)], &[-4.0 * linear.norm()], 1e-12);
    }
}

/// Two free bodies with an input force between points of them, and a force that depends on the distance of
/// their origins.
#[mechanism(derivatives)]
struct BodiesWithForceBetween {
    #[body(mass = 2, inertia = diagonal(0.1, 0.2, 0.3))]
    first: Body,
    #[body(mass = 3, inertia = diagonal(0.3, 0.1, 0.2))]
    second: Body,
    #[joint(ground -> first)]
    pose: Free,
    #[joint(ground -> second)]
    other: Free,
    #[acts(between = (first.at(0.3 * x), second.at(0.2 * y - 0.1 * z)))]
    piston: Force,
    #[acts(between = (first, second), value = 4 * norm(r(second / first)))]
    drive: Force,
    #[output(norm(r(second.at(0.2 * y - 0.1 * z) / first.at(0.3 * x))))]
    length: Scalar,
    #[output(norm(r(second / first)))]
    distance: Scalar,
}

#[mechanism]
struct PistonBetweenBodies {
    #[body(mass = 2)]
    left: Body,
    #[body(mass = 3)]
    right: Body,
    #[joint(ground -> left, along = x)]
    rail: Sleeve,
    #[joint(ground -> right, along = x)]
    other: Sleeve,
    #[acts(between = (left, right))]
    piston: Force,
}

/// A force between two points pushes them apart, does work only on their distance, and changes no momentum.
#[test]
fn forces_between_points_repel_them() {
    let (m, mut random) = (BodiesWithForceBetween {}, support::random::Random::new(3));
    assert_eq!(BodiesWithForceBetween::INPUTS, ["piston"]);
    for _ in 0..10 {
        let q = random.random_configuration(&m);
        let v: SVector<f64, 12> = random.random_vector(2.0);
        let u = [7.0].into();
        let derivative_along_motion = |f: &dyn Fn(&SVector<f64, 14>) -> f64| {
            (f(&m.integrate(&q, &(v * 1e-5))) - f(&m.integrate(&q, &(v * -1e-5)))) / 2e-5
        };
        let tau = m.generalized_forces(&q, &u);
        assert_close("input", &[tau.dot(&v)], &[7.0 * derivative_along_motion(&|q| m.length(q))], 1e-8);
        let still = SVector::zeros();
        let drive = -m.bias_forces(&q, &still);
        assert_close(
            "value",
            &[drive.dot(&v)],
            &[4.0 * m.distance(&q) * derivative_along_motion(&|q| m.distance(q))],
            1e-8,
        );
        let a = m.forward_dynamics(&q, &still, &tau);
        let rate = m.momentum(&q, &a);
        assert!(rate.amax() < 1e-12, "{rate}");
    }
    // The result is independent of which cart is in front.
    let m = PistonBetweenBodies {};
    for side in [1.0, -1.0] {
        let tau = m.generalized_forces(&[0.0, 2.0 * side].into(), &[5.0].into());
        assert_eq!(tau, SVector::from([-5.0 * side, 5.0 * side]));
    }
}
