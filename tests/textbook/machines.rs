//! Tests of complete machines against closed-form solutions.

use super::{EXACT, MOTION};
use linkwork::nalgebra::{Matrix2, Matrix3, Rotation3, Vector1, Vector2, Vector3, Vector6};
use linkwork::{Mechanism, at, frame, mechanism};
use linkwork_models::{BeadOnSpinningHoop, DoublePendulum, Gyroscope, TunedSuspension};
use support::compare::assert_close;
use support::random::Random;
use support::robots::PandaMimic;
use support::simulate::state_after_duration;

#[test]
fn double_pendulum_has_the_textbook_equations() {
    let (g, m1, m2, l1, l2) = (9.81, 1.3, 0.7, 0.9, 1.1);
    let pendulum = DoublePendulum { g, m1, m2, l1, l2 };
    let (q, v) = (Vector2::new(0.4, -1.3_f64), Vector2::new(1.5, -0.8));
    let (sin, cos) = q[1].sin_cos();
    let couple = m2 * l1 * l2 / 2.0;
    let far = m2 * l2 * l2 / 3.0;
    let mass = Matrix2::new(
        m1 * l1 * l1 / 3.0 + m2 * l1 * l1 + far + 2.0 * couple * cos,
        far + couple * cos,
        0.0,
        far,
    );
    assert_close("mass", pendulum.mass_matrix(&q).upper_triangle().as_slice(), mass.as_slice(), EXACT);
    let weight = m2 * g * l2 / 2.0 * (q[0] + q[1]).sin();
    let bias = [
        -couple * sin * (2.0 * v[0] * v[1] + v[1] * v[1]) + (m1 / 2.0 + m2) * g * l1 * q[0].sin() + weight,
        couple * sin * v[0] * v[0] + weight,
    ];
    assert_close("bias", pendulum.bias_forces(&q, &v).as_slice(), &bias, EXACT);
}

/// Beyond `Ω² = g / R` the bead leaves the bottom of the hoop (Goldstein, *Classical Mechanics*, ch. 2).
#[test]
fn bead_on_spinning_hoop_leaves_the_bottom() {
    let (g, m, radius, spin) = (9.81, 2.0, 0.5, 6.0);
    let hoop = BeadOnSpinningHoop { g, mass: m, radius, spin };
    for t in [0.0, 0.3] {
        let (q, v) = (Vector1::new(0.4_f64), Vector1::new(0.7));
        let (sin, cos) = q[0].sin_cos();
        let expected = m * radius * sin * (g - radius * spin * spin * cos);
        assert_close("mass", hoop.mass_matrix(t, &q).as_slice(), &[m * radius * radius], EXACT);
        assert_close("bias", hoop.bias_forces(t, &q, &v).as_slice(), &[expected], EXACT);
        let energy = m * radius * radius * (v[0] * v[0] + (spin * sin).powi(2)) / 2.0;
        assert_close("energy", &[hoop.kinetic_energy(t, &q, &v)], &[energy], EXACT);
        let place = at(&hoop, t);
        assert_close("at", place.bias_forces(0.0, &q, &v).as_slice(), &[expected], EXACT);
        let bead = hoop.frame_placement(frame!(BeadOnSpinningHoop, "bead"), t, &q).translation.vector;
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), spin * t) * Vector3::new(sin, 0.0, -cos);
        assert_close("place", bead.as_slice(), (turned * radius).as_slice(), EXACT);
    }
    let rest = Vector1::new((g / (radius * spin * spin)).acos());
    let (q, v) = state_after_duration(&hoop, &rest, &Vector1::zeros(), 2.0);
    assert_close("relative equilibrium", &[q[0], v[0]], &[rest[0], 0.0], MOTION);
}

#[test]
fn tuned_suspension_has_the_matrices_derived_by_hand() {
    let cart = TunedSuspension { m1: 2.0, m2: 1.0, k1: 100.0, k2: 40.0, damping: 0.3, inertance: 0.5 };
    let origin = Vector2::zeros();
    // The carts coincide at the origin, which is no singularity.
    assert_eq!(cart.bias_forces(&origin, &origin), origin);
    let mass = cart.mass_matrix(&origin);
    assert_close("mass", mass.as_slice(), &[2.5, -0.5, -0.5, 1.5], EXACT);
    let stiffness_column = |k: usize| cart.bias_forces(&Vector2::ith(k, 1.0), &origin);
    let stiffness = Matrix2::from_columns(&[stiffness_column(0), stiffness_column(1)]);
    assert_close("stiffness", stiffness.as_slice(), &[140.0, -40.0, -40.0, 40.0], EXACT);
    let damping = cart.bias_forces(&origin, &Vector2::new(1.0, 3.0));
    assert_close("damping", damping.as_slice(), &[-0.6, 0.6], EXACT);
    let square = mass.try_inverse().expect("regular") * stiffness;
    let half = square.trace() / 2.0;
    let root = (half * half - square.determinant()).sqrt();
    let modes = [(half - root).sqrt(), (half + root).sqrt()];
    assert_close("modes", &modes, &[4.472135954999579, 7.559289460184545], EXACT);
}

#[test]
fn gyroscope_has_the_textbook_mass_matrix() {
    let (axial, transverse) = (2.0, 3.0);
    let gyroscope = Gyroscope { g: 9.81, mass: 1.0, offset: 0.0, axial, transverse };
    let (q, v) = (Vector3::new(0.1, 0.6_f64, 0.3), Vector3::new(1.0, 2.0, 3.0));
    let (sin, cos) = q[1].sin_cos();
    let jacobian = Matrix3::new(0.0, 1.0, 0.0, sin, 0.0, 0.0, cos, 0.0, 1.0);
    assert_close("rate", gyroscope.rotor_rate(&q, &v).as_slice(), (jacobian * v).as_slice(), EXACT);
    assert_close("Jacobian", gyroscope.rotor_rate_jacobian(&q, &v).as_slice(), jacobian.as_slice(), EXACT);
    let inertia = Matrix3::from_diagonal(&Vector3::new(transverse, transverse, axial));
    let mass = jacobian.transpose() * inertia * jacobian;
    assert_close("mass", gyroscope.mass_matrix(&q).as_slice(), mass.as_slice(), EXACT);
}

/// Checks a gyroscope in gimbal lock, with the axes of precession and spin in line. The mass matrix is
/// singular and the acceleration is not finite instead of wrong; all other functions are correct.
#[test]
fn gyroscope_in_gimbal_lock_has_a_singular_mass_matrix() {
    let gyroscope = Gyroscope { g: 9.81, mass: 1.0, offset: 0.0, axial: 2.0, transverse: 3.0 };
    let (q, v) = (Vector3::new(0.1, 0.0, 0.3), Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(gyroscope.mass_matrix(&q).determinant(), 0.0);
    assert_close("rate", gyroscope.rotor_rate(&q, &v).as_slice(), &[2.0, 0.0, 4.0], EXACT);
    let bias = gyroscope.bias_forces(&q, &v);
    assert_close("bias", bias.as_slice(), &[0.0, 0.0, 0.0], EXACT);
    let acceleration = gyroscope.forward_dynamics(&q, &v, &Vector3::new(1.0, 0.0, 0.0));
    assert!(acceleration.iter().any(|a| !a.is_finite()));
}

#[mechanism(gravity = 9.81 * z)]
struct Aircraft {
    m: f64,
    ixx: f64,
    iyy: f64,
    izz: f64,
    ixz: f64,
    rho: f64,
    area: f64,
    chord: f64,
    cl0: f64,
    cl_alpha: f64,
    cm_elevator: f64,

    elevator: Input,
    #[body(mass = m, inertia = [[ixx, 0, ixz], [0, iyy, 0], [ixz, 0, izz]])]
    airframe: Body,
    #[joint(ground -> airframe)]
    flight: Free,
    #[define(v(airframe / ground / ground))]
    velocity: Vector,
    #[define(atan2(dot(velocity, airframe.z), dot(velocity, airframe.x)))]
    alpha: Scalar,
    #[define(rho / 2 * dot(velocity, velocity))]
    pressure: Scalar,
    #[acts(
        on = airframe,
        value = pressure * area * (cl0 + cl_alpha * alpha) * (sin(alpha) * airframe.x - cos(alpha) * airframe.z)
    )]
    lift: Force,
    #[acts(on = airframe, value = pressure * area * chord * cm_elevator * elevator * airframe.y)]
    pitch: Torque,
    #[output(alpha)]
    angle_of_attack: Scalar,
}

#[test]
fn aircraft_has_the_textbook_equations() {
    let (m, rho, area, chord) = (600.0, 1.2, 12.0, 1.3);
    let plane = Aircraft {
        m,
        ixx: 900.0,
        iyy: 1300.0,
        izz: 2000.0,
        ixz: 50.0,
        rho,
        area,
        chord,
        cl0: 0.2,
        cl_alpha: 5.0,
        cm_elevator: -1.1,
    };
    let (u, w) = (40.0_f64, 2.0_f64);
    let (q, v) = (plane.neutral(), Vector6::new(u, 0.0, w, 0.0, 0.0, 0.0));
    let alpha = w.atan2(u);
    let pressure = rho / 2.0 * (u * u + w * w);
    let lift = pressure * area * (0.2 + 5.0 * alpha);
    let (sin, cos) = alpha.sin_cos();
    assert_close("angle of attack", &[plane.angle_of_attack(&q, &v)], &[alpha], EXACT);
    let square = u * u + w * w;
    let jacobian = [-w / square, 0.0, u / square, 0.0, 0.0, 0.0];
    assert_close("its Jacobian", plane.angle_of_attack_jacobian(&q, &v).as_slice(), &jacobian, EXACT);
    let bias = [-lift * sin, 0.0, lift * cos - m * 9.81, 0.0, 0.0, 0.0];
    assert_close("bias", plane.bias_forces(&q, &v).as_slice(), &bias, EXACT);
    let pitch = pressure * area * chord * -1.1 * 0.1;
    let forces = plane.generalized_forces(&q, &v, &Vector1::new(0.1));
    assert_close("forces", forces.as_slice(), &[0.0, 0.0, 0.0, 0.0, pitch, 0.0], EXACT);
}

#[mechanism(urdf = "../models/urdf/panda.urdf")]
struct PandaWithTool {
    tool_mass: f64,
    stiffness: f64,

    #[particle(mass = tool_mass, at = panda_link8.at(0.1 * z))]
    tool: Particle,
    #[acts(on = panda_joint4, stiffness = stiffness)]
    balancer: Spring,
}

#[test]
fn tool_adds_its_inertia_and_spring_to_the_arm() {
    let (tool_mass, stiffness) = (0.7, 30.0);
    let (arm, held) = (PandaMimic, PandaWithTool { tool_mass, stiffness });
    let mut random = Random::new(7);
    let (q, v) = (random.random_configuration(&arm), random.random_vector(1.0));
    let tool = frame!(PandaWithTool, "tool");
    let jacobian = held.frame_jacobian(tool, &q);
    let linear = jacobian.fixed_rows::<3>(0).into_owned();
    let height = held.frame_placement(tool, &q).translation.z;
    let mass = arm.mass_matrix(&q) + linear.transpose() * linear * tool_mass;
    assert_close("mass matrix", held.mass_matrix(&q).as_slice(), mass.as_slice(), EXACT);
    let energy = arm.potential_energy(&q) + tool_mass * 9.81 * height + stiffness * q[3] * q[3] / 2.0;
    assert_close("potential energy", &[held.potential_energy(&q)], &[energy], EXACT);
    let moving = held.frame_velocity(tool, &q, &v);
    let kinetic = arm.kinetic_energy(&q, &v) + tool_mass / 2.0 * moving.fixed_rows::<3>(0).norm_squared();
    assert_close("kinetic energy", &[held.kinetic_energy(&q, &v)], &[kinetic], EXACT);
    assert_close("mass", &[held.total_mass()], &[arm.total_mass() + tool_mass], EXACT);
}
