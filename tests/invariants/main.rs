//! Checks of properties that hold for every mechanism, independent of its equations.

mod joints;

use linkwork::integrate::{DormandPrince, Rk4};
use linkwork::nalgebra::{SMatrix, SVector, Vector3};
use linkwork::{Mechanism, Real, frame, mechanism, simulate};
use support::compare::assert_close;
use support::mechanisms::*;
use support::random::Random;
use support::robots::*;

/// Returns the derivative at zero by central differences of fourth order; for motions of unit magnitude the
/// error is about 1e-11.
fn matrix_rate_at_zero<const R: usize, const C: usize>(
    f: impl Fn(f64) -> SMatrix<f64, R, C>,
) -> SMatrix<f64, R, C> {
    let h = 1e-3;
    ((f(h) - f(-h)) * 8.0 - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
}

/// Returns the derivative of a scalar function at zero by central differences of fourth order.
fn derivative_at_zero(f: impl Fn(f64) -> f64) -> f64 {
    matrix_rate_at_zero(|s| SMatrix::<f64, 1, 1>::new(f(s)))[0]
}

/// Tolerance of rates against finite differences.
const RATE: f64 = 1e-8;
/// Tolerance of identities between generated functions, which hold up to rounding.
const IDENTITY: f64 = 1e-11;

/// Checks consequences of the trait alone. `dissipation` is the power that dashpots dissipate at velocity
/// `v`.
fn check_mechanism_trait_identities<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    dissipation: impl Fn(&SVector<f64, NV>) -> f64,
) where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let mut random = Random::new(3);
    for _ in 0..4 {
        let q = random.random_configuration(m);
        let (v, tau) = (random.random_vector(1.0), random.random_vector(1.0));
        check_equation_of_motion(m, &q, &v, &tau);
        check_power_balance(m, &q, &v, &tau, dissipation(&v));
        check_configuration_manifold(m, &q, &v, &random.random_vector(1.0));
    }
}

fn check_equation_of_motion<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    tau: &SVector<f64, NV>,
) where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let mass_matrix = m.mass_matrix(0.0, q);
    assert_eq!(mass_matrix, mass_matrix.transpose(), "both triangles of the mass matrix");
    assert!(mass_matrix.cholesky().is_some(), "the mass matrix is positive definite");
    let momentum = m.generalized_momentum(0.0, q, v);
    assert_close("p = M v", momentum.as_slice(), (mass_matrix * v).as_slice(), IDENTITY);
    let kinetic = m.kinetic_energy(0.0, q, v);
    assert_close("T = ½ vᵀ M v", &[kinetic], &[v.dot(&momentum) / 2.0], IDENTITY);
    let forces = mass_matrix * tau + m.bias_forces(0.0, q, v);
    assert_close("τ = M a + h", m.inverse_dynamics(0.0, q, v, tau).as_slice(), forces.as_slice(), IDENTITY);
    let acceleration = m.forward_dynamics(0.0, q, v, tau);
    let back = m.inverse_dynamics(0.0, q, v, &acceleration);
    assert_close("inverse of forward dynamics", back.as_slice(), tau.as_slice(), 1e-9);

    let momentum_at =
        |s: f64| m.generalized_momentum(0.0, &m.integrate(q, &(v * s)), &(v + acceleration * s));
    let expected = m.momentum_rate(0.0, q, v) + tau;
    assert_close("ṗ", expected.as_slice(), matrix_rate_at_zero(momentum_at).as_slice(), RATE);
}

fn check_power_balance<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    tau: &SVector<f64, NV>,
    dissipation: f64,
) where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let gradient = SVector::<f64, NV>::from_fn(|i, _| {
        let mut direction = SVector::<f64, NV>::zeros();
        direction[i] = 1.0;
        derivative_at_zero(|s| m.potential_energy(0.0, &m.integrate(q, &(direction * s))))
    });
    let still = m.bias_forces(0.0, q, &SVector::zeros());
    assert_close("h(q, 0) = ∂U/∂q", still.as_slice(), gradient.as_slice(), RATE);

    let acceleration = m.forward_dynamics(0.0, q, v, tau);
    let power = derivative_at_zero(|s| {
        let q = m.integrate(q, &(v * s));
        m.kinetic_energy(0.0, &q, &(v + acceleration * s)) + m.potential_energy(0.0, &q)
    });
    assert_close("d(T + U)/dt", &[power], &[v.dot(tau) - dissipation], RATE);
}

fn check_configuration_manifold<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    dv: &SVector<f64, NV>,
) where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    assert_close("q ⊕ 0", m.integrate(q, &SVector::zeros()).as_slice(), q.as_slice(), 1e-15);
    let (once, twice) = (m.integrate(q, &(v * 0.7)), m.integrate(&m.integrate(q, &(v * 0.4)), &(v * 0.3)));
    assert_close("motion with constant velocity", twice.as_slice(), once.as_slice(), 1e-14);

    let moved = m.integrate(q, dv);
    let rate_of_dv = m.tangent_rate(dv, v);
    let through_dv = matrix_rate_at_zero(|s| m.integrate(q, &(dv + rate_of_dv * s)));
    let directly = matrix_rate_at_zero(|s| m.integrate(&moved, &(v * s)));
    assert_close("tangent rate", through_dv.as_slice(), directly.as_slice(), RATE);
    assert_close("difference", m.difference(q, &moved).as_slice(), dv.as_slice(), 1e-13);
}

/// Checks that the velocity-dependent bias forces are quadratic in the velocity if there are no dashpots.
fn check_bias_quadratic_in_velocity<M, const NQ: usize, const NV: usize, const NU: usize>(m: &M)
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    check_mechanism_trait_identities(m, |_| 0.0);
    let mut random = Random::new(4);
    let q = random.random_configuration(m);
    let v = random.random_vector(1.0);
    let still = m.bias_forces(0.0, &q, &SVector::zeros());
    let (single, double) = (m.bias_forces(0.0, &q, &v) - still, m.bias_forces(0.0, &q, &(v * 2.0)) - still);
    assert_close("h(q, 2 v)", double.as_slice(), (single * 4.0).as_slice(), IDENTITY);
}

macro_rules! undamped {
    ($($test:ident: $mechanism:expr,)*) => {
        $(
            #[test]
            fn $test() {
                check_bias_quadratic_in_velocity(&$mechanism);
            }
        )*
    };
}

undamped! {
    cart_pole_file: CartPole,
    double_pendulum_file: DoublePendulum,
    ur5: Ur5,
    kinova: Kinova,
    panda: Panda,
    panda_mimic: PandaMimic,
    panda_arm: PandaArm,
    solo12: Solo12,
    humanoid: Humanoid,
    pin: OnPin {},
    slanted_pin: OnSlantedPin {},
    sleeve: OnSleeve {},
    screw: OnScrew {},
    screw_with_lead: OnScrewWithLead {},
    collar: OnCollar {},
    slot: OnSlot {},
    universal: OnUniversal {},
    ball: OnBall {},
    planar: OnPlanar {},
    stage: OnStage {},
    stage3: OnStage3 {},
    free: OnFree {},
    weld: OnWeld {},
    spacecraft: Spacecraft {},
}

/// Dashpots dissipate the power `c v²`.
#[test]
fn dashpots_dissipate_quadratic_power() {
    let m = sample_coordinate_force_mechanism();
    check_mechanism_trait_identities(&m, |v| {
        m.shoulder_damping * v[0] * v[0] + m.slide_damping * v[1] * v[1] + m.turn_damping * v[2] * v[2]
    });
}

// ---- Frames and the mechanism as a
// whole -----------------------------------------------------------------------------------------------------

/// Checks the kinematics of a frame, and of centre of mass and momentum, by finite differences: velocity is
/// the rate of placement, acceleration that of velocity.
macro_rules! check_kinematics {
    ($mechanism:expr, $type:ident, $frame:literal) => {
        let m = $mechanism;
        let frame = frame!($type, $frame);
        let mut random = Random::new(5);
        for _ in 0..4 {
            let q = random.random_configuration(&m);
            let (v, a) = (random.random_vector(1.0), random.random_vector(1.0));
            let state_after = |s: f64| (m.integrate(&q, &(v * s)), v + a * s);
            let (velocity, turning) = {
                let velocity = m.frame_velocity(frame, &q, &v);
                (velocity.fixed_rows::<3>(0).into_owned(), velocity.fixed_rows::<3>(3).into_owned())
            };

            let through_jacobian = m.frame_jacobian(frame, &q) * v;
            assert_close(
                "J v",
                through_jacobian.as_slice(),
                m.frame_velocity(frame, &q, &v).as_slice(),
                IDENTITY,
            );
            let moving =
                matrix_rate_at_zero(|s| m.frame_placement(frame, &state_after(s).0).translation.vector);
            assert_close("velocity", velocity.as_slice(), moving.as_slice(), RATE);
            let rotation = m.frame_placement(frame, &q).rotation.into_inner();
            let rotating =
                matrix_rate_at_zero(|s| m.frame_placement(frame, &state_after(s).0).rotation.into_inner());
            let expected = turning.cross_matrix() * rotation;
            assert_close("angular velocity", expected.as_slice(), rotating.as_slice(), RATE);
            let accelerating =
                matrix_rate_at_zero(|s| m.frame_velocity(frame, &state_after(s).0, &state_after(s).1));
            let acceleration = m.frame_acceleration(frame, &q, &v, &a);
            assert_close("acceleration", acceleration.as_slice(), accelerating.as_slice(), RATE);

            let momentum = m.momentum(&q, &v);
            let drift = matrix_rate_at_zero(|s| m.center_of_mass(&state_after(s).0)) * m.total_mass();
            assert_close("momentum", &momentum.as_slice()[..3], drift.as_slice(), RATE);
        }
    };
}

#[test]
fn frame_velocities_are_rates_of_placements() {
    check_kinematics!(Panda, Panda, "panda_hand_tcp");
    check_kinematics!(Solo12, Solo12, "HR_FOOT");
    check_kinematics!(OnScrew {}, OnScrew, "carried");
    check_kinematics!(OnSlot {}, OnSlot, "carried");
    check_kinematics!(OnBall {}, OnBall, "carried");
    check_kinematics!(OnPlanar {}, OnPlanar, "carried");
    check_kinematics!(OnFree {}, OnFree, "carried");
    check_kinematics!(OnWeld {}, OnWeld, "carried");
    check_kinematics!(sample_coordinate_force_mechanism(), CoordinateForceMechanism, "tip");
}

/// Motors do not change the momentum of a robot in the air: it changes only by the robot's weight.
#[test]
fn motors_preserve_the_momentum_of_flying_robots() {
    let mut random = Random::new(6);
    for _ in 0..4 {
        let q = random.random_configuration(&Solo12);
        let (v, u) = (random.random_vector(1.0), random.random_vector(1.0));
        let a = Solo12.forward_dynamics(&q, &v, &Solo12.generalized_forces(&q, &u));
        let rate = matrix_rate_at_zero(|s| Solo12.momentum(&Solo12.integrate(&q, &(v * s)), &(v + a * s)));
        let expected = [0.0, 0.0, -9.81 * Solo12.total_mass(), 0.0, 0.0, 0.0];
        assert_close("force and torque from outside", rate.as_slice(), &expected, RATE);
    }
}

// ----
// Inputs ----------------------------------------------------------------------------------------------------

/// Checks that the power of each input is its force times the velocity of the point on which it acts.
#[test]
fn input_power_is_force_times_point_velocity() {
    let m = sample_coordinate_force_mechanism();
    assert_eq!(
        CoordinateForceMechanism::INPUTS,
        ["motor", "drive", "spin", "thrust", "lift", "wheel", "gust"]
    );
    assert_eq!(CoordinateForceMechanism::VELOCITIES, ["shoulder", "track.slide", "track.turn"]);
    let mut random = Random::new(7);
    for _ in 0..10 {
        let q = random.random_configuration(&m);
        let (v, u): (_, SVector<f64, 7>) = (random.random_vector(1.0), random.random_vector(1.0));
        let tip = m.frame_velocity(frame!(CoordinateForceMechanism, "tip"), &q, &v);
        let carriage = m.frame_placement(frame!(CoordinateForceMechanism, "carriage"), &q).rotation;
        let (velocity, turning) =
            (Vector3::new(tip[0], tip[1], tip[2]), Vector3::new(tip[3], tip[4], tip[5]));
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let powers = [
            v[0],
            v[1],
            v[2],
            velocity.dot(&(carriage * x)),
            velocity.dot(&y),
            turning.dot(&(carriage * z)),
            turning.dot(&(z * 0.6 - x * 0.8)),
        ];
        for (i, power) in powers.iter().enumerate() {
            let mut one = SVector::zeros();
            one[i] = u[i];
            let done = v.dot(&m.generalized_forces(&q, &one));
            assert_close(CoordinateForceMechanism::INPUTS[i], &[done], &[power * u[i]], IDENTITY);
        }
        let all: f64 = powers.iter().zip(&u).map(|(p, u)| p * u).sum();
        assert_close("all inputs", &[v.dot(&m.generalized_forces(&q, &u))], &[all], IDENTITY);
    }
}

// ----
// Motion ----------------------------------------------------------------------------------------------------

/// Without external forces, a mechanism conserves its momentum and its energy, and its centre of mass moves
/// uniformly.
#[test]
fn spacecraft_conserves_momentum_and_energy() {
    let m = Spacecraft {};
    let mut random = Random::new(17);
    let q = random.random_configuration(&m);
    let v = random.random_vector(1.0);
    let total_energy = |q: &_, v: &_| m.kinetic_energy(q, v) + m.potential_energy(q);
    let (momentum, start) = (m.momentum(&q, &v), total_energy(&q, &v));
    let method = DormandPrince::new().tolerance(1e-13, 1e-13);
    for sample in simulate(&m).from(q, v).duration(5.0).sample_every(0.5).method(method) {
        let sample = sample.expect("the integrator goes on");
        let now = m.momentum(&sample.q, &sample.v);
        assert_close("momentum", now.as_slice(), momentum.as_slice(), 1e-10);
        assert_close("energy", &[total_energy(&sample.q, &sample.v)], &[start], 1e-10);
        let expected = m.center_of_mass(&q) + momentum.fixed_rows::<3>(0) / m.total_mass() * sample.t;
        assert_close("centre of mass", m.center_of_mass(&sample.q).as_slice(), expected.as_slice(), 1e-10);
    }
}

/// Along a driven and damped motion, the energy changes by the work of the inputs minus the energy that the
/// dashpots dissipate.
#[test]
fn workshop_energy_changes_by_work_minus_dissipation() {
    let m = sample_coordinate_force_mechanism();
    let input_at_time = |t: f64| SVector::<f64, 7>::from_fn(|i, _| (t * (1.0 + i as f64) + i as f64).sin());
    let input_power_minus_dissipation = |t: f64, q: &_, v: &SVector<f64, 3>| {
        v.dot(&m.generalized_forces(q, &input_at_time(t)))
            - (m.shoulder_damping * v[0] * v[0]
                + m.slide_damping * v[1] * v[1]
                + m.turn_damping * v[2] * v[2])
    };
    let run = simulate(&m)
        .from([0.2, 0.1, -0.3], [1.0, 0.0, 2.0])
        .inputs(|t, _, _| input_at_time(t))
        .duration(2.0)
        .sample_every(1e-3)
        .method(Rk4::step(1e-3));
    let samples: Vec<_> = run.map(|sample| sample.expect("the integrator goes on")).collect();
    assert_eq!(samples.len(), 2001);
    let total_energy =
        |k: usize| m.kinetic_energy(&samples[k].q, &samples[k].v) + m.potential_energy(&samples[k].q);
    // Integration by Simpson's rule.
    let simpson_weight = |k: usize| [1.0, 4.0, 2.0][if k == 0 || k == 2000 { 0 } else { 2 - k % 2 }];
    let work: f64 = samples
        .iter()
        .enumerate()
        .map(|(k, s)| simpson_weight(k) * input_power_minus_dissipation(s.t, &s.q, &s.v))
        .sum::<f64>()
        / 3e3;
    assert_close("energy", &[total_energy(2000) - total_energy(0)], &[work], 1e-9);
}

// ----
// Scalars ---------------------------------------------------------------------------------------------------

/// Robot that is generic over the scalar type.
#[mechanism(gravity = -g * y)]
struct GenericScalarRobot<T> {
    g: T,
    m: T,
    l: T,
    k: T,
    c: T,
    #[body(mass = m, com = l / 2 * x, inertia = rod(m, l, x))]
    arm: Body,
    #[body(mass = m / 2, inertia = sphere(m / 2, l / 4))]
    head: Body,
    #[joint(ground -> arm, about = z)]
    shoulder: Pin,
    #[joint(arm.at(l * x) -> head)]
    neck: Ball,
    #[acts(on = shoulder, stiffness = k)]
    spring: Spring,
    #[acts(on = shoulder, damping = c)]
    dashpot: Dashpot,
    #[acts(on = head.at(l / 4 * y), along = ground.x)]
    push: Force,
}

fn sample_robot<T: Real>() -> GenericScalarRobot<T> {
    let [g, m, l, k, c] = [9.81, 1.3, 0.7, 5.0, 0.2].map(linkwork::nalgebra::convert);
    GenericScalarRobot { g, m, l, k, c }
}

#[test]
fn dynamics_agree_for_all_scalar_types() {
    let (single, double) = (sample_robot::<f32>(), sample_robot::<f64>());
    check_mechanism_trait_identities(&double, |v| 0.2 * v[0] * v[0]);
    let mut random = Random::new(10);
    for _ in 0..10 {
        let q = random.random_configuration(&double);
        let [v, a] = [random.random_vector::<4>(2.0), random.random_vector::<4>(2.0)];
        let (q32, v32, a32) = (q.cast::<f32>(), v.cast::<f32>(), a.cast::<f32>());
        let assert_close_in_single = |what: &str, a: &[f32], b: &[f64]| {
            assert_close(what, &a.iter().copied().map(f64::from).collect::<Vec<_>>(), b, 2e-5);
        };
        assert_close_in_single(
            "mass matrix",
            single.mass_matrix(&q32).as_slice(),
            double.mass_matrix(&q).as_slice(),
        );
        let forces = single.inverse_dynamics(&q32, &v32, &a32);
        assert_close_in_single(
            "inverse dynamics",
            forces.as_slice(),
            double.inverse_dynamics(&q, &v, &a).as_slice(),
        );
        let acceleration = single.forward_dynamics(&q32, &v32, &a32);
        assert_close_in_single(
            "forward dynamics",
            acceleration.as_slice(),
            double.forward_dynamics(&q, &v, &a).as_slice(),
        );
        let push = single.generalized_forces(&q32, &SVector::from([2.0]));
        assert_close_in_single(
            "inputs",
            push.as_slice(),
            double.generalized_forces(&q, &SVector::from([2.0])).as_slice(),
        );
        let moved = single.integrate(&q32, &v32);
        assert_close_in_single("integrate", moved.as_slice(), double.integrate(&q, &v).as_slice());
    }
}

/// Light planar arm with a heavy load. Two of the three pivots of its mass matrix are small relative to the
/// first one.
#[mechanism]
struct ArmWithHeavyLoad {
    load: f64,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    upper: Body,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    middle: Body,
    #[body(mass = 1 + load, com = x, inertia = rod(1, 1, x))]
    lower: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(x) -> middle, about = z)]
    elbow: Pin,
    #[joint(middle.at(x) -> lower, about = z)]
    wrist: Pin,
}

/// Accelerations satisfy the equations of motion to rounding of the largest terms, for any load. The error of
/// an elimination with successive pivots is that of a matrix with a perturbation of the magnitude of rounding
/// (Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, th. 10.4).
#[test]
fn heavy_loads_on_light_arms_lose_no_accuracy() {
    let (v, tau) = (Vector3::zeros(), Vector3::new(0.3, -0.2, 0.7));
    for load in [1.0, 1e2, 1e4, 1e6, 1e8] {
        let m = ArmWithHeavyLoad { load };
        for bend in [0.0, 1e-4, 1e-2, 1.0] {
            let q = Vector3::new(0.4, bend, -bend / 2.0);
            let a = m.forward_dynamics(&q, &v, &tau);
            let (mass, found) = (m.mass_matrix(&q), m.inverse_dynamics(&q, &v, &a));
            let terms = mass.abs() * a.abs() + tau.abs();
            let off = (found - tau).abs().component_div(&terms).amax();
            assert!(off < 1e-14, "load {load}, bend {bend}: {off:e} of the terms");
        }
    }
}
