//! Tests of sliding contact constraints with dry friction.

use linkwork::integrate::DormandPrince;
use linkwork::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use linkwork::prelude::*;
use support::random::Random;

/// Disk on an incline that can slide and roll in a vertical plane.
#[mechanism(gravity = -9.81 * y)]
struct DiskOnIncline {
    slope: f64,
    mu: f64,

    #[body(mass = 0.8, inertia = disk(0.8, 0.15, z))]
    disk: Body,
    #[joint(ground -> disk, about = z)]
    pose: Planar,
    #[constraint(
        slips(disk.circle(0.15, z), ground.plane(sin(slope) * x + cos(slope) * y)),
        friction = mu,
        speed = 0.001
    )]
    contact: Slipping,
}

impl DiskOnIncline {
    /// Returns a state with this velocity of the centre along the incline, m/s, and this angular velocity,
    /// rad/s.
    fn disk_state(&self, velocity: f64, turning: f64) -> (SVector<f64, 3>, SVector<f64, 3>) {
        let (s, c) = self.slope.sin_cos();
        ([0.15 * s, 0.15 * c, 0.0].into(), [velocity * c, -velocity * s, turning].into())
    }
}

/// Checks a disk on inclines. On steep ones it slides with the accelerations `g (sin θ − μ cos θ)` and
/// `2 μ g cos θ / R`; on gentle ones it rolls with `⅔ g sin θ`, while the smoothed friction lets it creep at
/// a constant velocity.
#[test]
fn disk_slides_or_rolls_down_by_closed_form() -> Result<(), Error> {
    let (mu, v0) = (0.3_f64, 1e-3_f64);
    // The disk slides if tan θ > 3 μ.
    for slope in [0.3, 0.6, 0.9, 1.2] {
        let disk = DiskOnIncline { slope, mu };
        let (s, c) = slope.sin_cos();
        let share = s / c / (3.0 * mu);
        let acceleration_down_slope = |a: &SVector<f64, 3>| a[0] * c - a[1] * s;
        let (q, v) = match share < 1.0 {
            true => disk.disk_state(1.0, -(1.0 - v0 * share / (1.0 - share * share).sqrt()) / 0.15),
            false => disk.disk_state(20.0, -10.0 / 0.15),
        };
        let (a, normal) = disk.constrained_dynamics(&q, &v, &SVector::zeros());
        let found = [normal[0], acceleration_down_slope(&a), a[2]];
        let part = if share < 1.0 { share } else { 10.0 / 10.0_f64.hypot(v0) };
        let expected = [0.8 * 9.81 * c, 9.81 * (s - mu * part * c), -2.0 * mu * part * 9.81 * c / 0.15];
        for (f, e) in found.iter().zip(expected) {
            assert!((f - e).abs() < 1e-11, "at {slope}: {found:?}, not {expected:?}");
        }
        if share < 1.0 {
            assert!((acceleration_down_slope(&a) - 2.0 / 3.0 * 9.81 * s).abs() < 1e-11);
        }
        // From rest, the motion approaches the same steady acceleration.
        let (q, v) = disk.disk_state(0.0, 0.0);
        let method = DormandPrince::new().tolerance(1e-9, 1e-9);
        let end = simulate(&disk).from(q, v).method(method).duration(0.5).finish()?;
        let steady = if share < 1.0 { 2.0 / 3.0 * s } else { s - mu * c };
        assert!(
            (acceleration_down_slope(&end.v) - 9.81 * steady * 0.5).abs() < 2e-3,
            "{} at {slope}",
            acceleration_down_slope(&end.v)
        );
    }
    Ok(())
}

/// Coin that slips on a table: it dissipates the power `μ N |s|² / √(|s|² + v₀²)`.
#[mechanism(gravity = -9.81 * z, derivatives, batch)]
struct SlippingCoin {
    mu: f64,
    v0: f64,

    #[body(mass = 0.02, inertia = disk(0.02, 0.012, z))]
    coin: Body,
    #[joint(ground -> coin)]
    pose: Free,
    #[acts(on = coin, along = ground.z)]
    lift: Force,
    #[constraint(slips(coin.circle(0.012, z), ground.plane(z)), friction = mu, speed = v0)]
    rim: Slipping,
}

const COIN: SlippingCoin = SlippingCoin { mu: 0.25, v0: 0.02 };

/// Returns a state with the tilted coin on its rim, and a random velocity.
fn random_coin_state(random: &mut Random) -> (SVector<f64, 7>, SVector<f64, 6>) {
    let axis = Vector3::new(random.uniform_number(1.0), random.uniform_number(1.0), 0.3);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.9)
        * UnitQuaternion::from_scaled_axis(axis * 0.5);
    let near = [0.1, 0.2, 0.01, turn.i, turn.j, turn.k, turn.w].into();
    let q = COIN.project_configuration(&near).expect("the table is near");
    let mut v: SVector<f64, 6> = random.random_vector(0.3);
    v.fixed_rows_mut::<3>(3).scale_mut(30.0);
    (q, COIN.project_velocity(&q, &v).expect("regular"))
}

/// Returns the slip velocity in ground axes, from the geometry of a disk.
fn slip_velocity(q: &SVector<f64, 7>, v: &SVector<f64, 6>) -> Vector3<f64> {
    let turn = UnitQuaternion::from_quaternion([q[3], q[4], q[5], q[6]].into());
    let (axis, up) = (turn * Vector3::z(), Vector3::z());
    let lowest = -(up - axis * axis.z).normalize() * 0.012;
    turn * Vector3::new(v[0], v[1], v[2]) + (turn * Vector3::new(v[3], v[4], v[5])).cross(&lowest)
}

#[test]
fn slipping_friction_dissipates_energy() {
    let mut random = Random::new(5);
    for _ in 0..20 {
        let (q, v) = random_coin_state(&mut random);
        let s = slip_velocity(&q, &v);
        assert!(s.z.abs() < 1e-14);
        let (a, normal) = COIN.constrained_dynamics(&q, &v, &SVector::zeros());
        // The power of all forces other than inertia and gravity.
        let power = v.dot(&COIN.inverse_dynamics(&q, &v, &a));
        let expected = -COIN.mu * normal[0].abs() * s.norm_squared() / s.norm().hypot(COIN.v0);
        assert!((power - expected).abs() < 1e-13 + 1e-11 * expected.abs(), "{power}, not {expected}");
        // Friction is along the slip velocity.
        let held = COIN.inverse_dynamics(&q, &v, &a);
        let turn = UnitQuaternion::from_quaternion([q[3], q[4], q[5], q[6]].into());
        let force = turn * Vector3::new(held[0], held[1], held[2]);
        let friction = -s * (COIN.mu * normal[0].abs() / s.norm().hypot(COIN.v0));
        assert!((force - friction - Vector3::z() * normal[0]).norm() < 1e-12);
    }
}

/// Lifted by more than its weight, the coin is pulled onto the table by the constraint. Friction with a
/// tensile normal force also opposes the slip.
#[test]
fn friction_with_tensile_normal_force_opposes_slip() {
    let mut random = Random::new(6);
    let mut pulled = 0;
    for _ in 0..20 {
        let (q, v) = random_coin_state(&mut random);
        let s = slip_velocity(&q, &v);
        let tau = COIN.generalized_forces(&q, &[4.0].into());
        let (a, normal) = COIN.try_constrained_dynamics(&q, &v, &tau).expect("it does not jam");
        pulled += usize::from(normal[0] < 0.0);
        let power = v.dot(&(COIN.inverse_dynamics(&q, &v, &a) - tau));
        let expected = -COIN.mu * normal[0].abs() * s.norm_squared() / s.norm().hypot(COIN.v0);
        assert!((power - expected).abs() < 1e-11 * expected.abs().max(1.0), "{power}, not {expected}");
    }
    assert_eq!(pulled, 20);
}

/// Derivatives agree with differences, for compressive and tensile normal forces.
#[test]
fn slipping_derivatives_agree_with_finite_differences() {
    let mut random = Random::new(7);
    for lift in [0.0, 4.0] {
        let (q, v) = random_coin_state(&mut random);
        let tau = COIN.generalized_forces(&q, &[lift].into());
        let (by_q, by_v, by_tau) = COIN.forward_dynamics_derivatives(&q, &v, &tau);
        let scale = by_q.amax().max(by_v.amax());
        for k in 0..6 {
            let unit_direction_times =
                |h: f64| SVector::<f64, 6>::from_fn(|i, _| if i == k { h } else { 0.0 });
            let five_point_derivative = |f: &dyn Fn(f64) -> SVector<f64, 6>, h: f64| {
                ((f(h) - f(-h)) * 8.0 - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
            };
            let found = five_point_derivative(
                &|h| COIN.forward_dynamics(&COIN.integrate(&q, &unit_direction_times(h)), &v, &tau),
                1e-4,
            );
            assert!((found - by_q.column(k)).amax() < 1e-6 * scale, "∂v̇/∂q {k}: {found} {}", by_q.column(k));
            let found = five_point_derivative(
                &|h| COIN.forward_dynamics(&q, &(v + unit_direction_times(h)), &tau),
                1e-4,
            );
            assert!((found - by_v.column(k)).amax() < 1e-6 * scale, "∂v̇/∂v {k}: {found} {}", by_v.column(k));
            let found = five_point_derivative(
                &|h| COIN.forward_dynamics(&q, &v, &(tau + unit_direction_times(h))),
                1e-4,
            );
            assert!((found - by_tau.column(k)).amax() < 1e-8 * by_tau.amax(), "∂v̇/∂τ {k}");
        }
    }
}

/// Checks that SIMD lanes equal single states bit by bit, for lanes with compressive and with tensile normal
/// forces.
#[test]
fn slipping_lanes_equal_single_states() {
    let mut random = Random::new(8);
    let states: Vec<_> = (0..4).map(|_| random_coin_state(&mut random)).collect();
    let q: SVector<f64x4, 7> = SVector::from_fn(|i, _| Lanes::from_fn(|k| states[k].0[i]));
    let v: SVector<f64x4, 6> = SVector::from_fn(|i, _| Lanes::from_fn(|k| states[k].1[i]));
    for lifted in [0..0, 2..3, 0..4] {
        let forces_of_state = |k: usize| {
            let lift = if lifted.contains(&k) { 4.0 } else { 0.0 };
            COIN.generalized_forces(&states[k].0, &[lift].into())
        };
        let tau: SVector<f64x4, 6> = SVector::from_fn(|i, _| Lanes::from_fn(|k| forces_of_state(k)[i]));
        let a = COIN.forward_dynamics_lanes(&q, &v, &tau);
        for (k, (q, v)) in states.iter().enumerate() {
            assert_eq!(a.map(|x| x[k]), COIN.forward_dynamics(q, v, &forces_of_state(k)));
        }
    }
}

/// Ladder on a rough floor against a rough wall, with the normal force at the wall as an output.
#[mechanism(gravity = -9.81 * y)]
struct Ladder {
    #[body(mass = 10, inertia = rod(10, 4, x))]
    ladder: Body,
    #[joint(ground -> ladder, about = z)]
    pose: Planar,
    #[constraint(slips(ladder.at(-2 * x).sphere(0.05), ground.plane(y)), friction = 0.2, speed = 0.0001)]
    floor: Slipping,
    #[constraint(slips(ladder.at(2 * x).sphere(0.05), ground.plane(-x)), friction = 0.3, speed = 0.0001)]
    wall: Slipping,
}

/// Three equations, derived by hand from the free body and the kinematics, determine the two normal forces
/// and the angular acceleration.
#[test]
fn sliding_ladder_satisfies_newtons_equations() {
    let (angle, rate) = (1.0_f64, -0.8);
    let (s, c) = angle.sin_cos();
    let q = SVector::from([-2.0 * c - 0.05, 2.0 * s + 0.05, angle]);
    let v = SVector::from([2.0 * s * rate, 2.0 * c * rate, rate]);
    assert!(
        Ladder {}.constraint_residuals(&q).amax() < 1e-15
            && Ladder {}.constraint_rates(&q, &v).amax() < 1e-15
    );
    let (a, forces) = Ladder {}.try_constrained_dynamics(&q, &v, &SVector::zeros()).expect("it slides");
    // Slip velocities of the balls at the ends: away from the wall on the floor, downwards at the wall. The
    // rotation of the balls contributes.
    let regularized_direction = |s: f64| s / s.hypot(1e-4);
    let (on_floor, on_wall) = (
        regularized_direction(4.0 * s * rate + 0.05 * rate),
        regularized_direction(4.0 * c * rate + 0.05 * rate),
    );
    let (mu, nu, inertia) = (0.2 * on_floor, 0.3 * on_wall, 10.0 * 16.0 / 12.0);
    // m ẍ = −N₂ − μ N₁, m ÿ = N₁ − ν N₂ − m g, and the moments about the centre; ẍ and ÿ are functions of the
    // angle.
    let floor = [-2.0 * c - mu * (2.0 * s + 0.05), -mu, 1.0];
    let wall = [2.0 * s - nu * (2.0 * c + 0.05), -1.0, -nu];
    let m = Matrix3::new(
        -inertia,
        floor[0],
        wall[0],
        -10.0 * 2.0 * s,
        floor[1],
        wall[1],
        -10.0 * 2.0 * c,
        floor[2],
        wall[2],
    );
    let centrifugal = [10.0 * 2.0 * c * rate * rate, 10.0 * (9.81 - 2.0 * s * rate * rate)];
    let x = m.lu().solve(&Vector3::new(0.0, centrifugal[0], centrifugal[1])).expect("regular");
    assert!((a[2] - x[0]).abs() < 1e-11, "{a} {x}");
    assert!((forces - SVector::from([x[1], x[2]])).amax() < 1e-10, "{forces} {x}");
    assert!(forces.iter().all(|f| *f > 0.0));
}

/// Arm whose end drags over a table, with the reaction of its hinge as an output.
#[mechanism(gravity = -9.81 * y)]
struct DraggingArm {
    #[body(mass = 2, inertia = disk(2, 0.1, z))]
    cart: Body,
    #[body(mass = 0.5, com = 0.2 * x, inertia = rod(0.5, 0.4, x))]
    arm: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> arm, about = z)]
    hinge: Pin,
    #[constraint(slips(arm.at(0.4 * x).sphere(0.02), ground.at(-0.2 * y).plane(y)), friction = 0.5)]
    tip: Slipping,
    #[acts(on = rail)]
    push: Force,
    #[output(reaction_force(hinge))]
    carried: Vector,
    #[point(on = arm, at = 0.2 * x)]
    middle: Point,
    #[output(a(middle / ground / ground))]
    acceleration: Vector,
}

/// Checks that the reaction at an arm's joint satisfies Newton's second law including the friction at its
/// tip.
#[test]
fn joint_reactions_include_friction() {
    let guess = SVector::from([0.3, -0.5]);
    let q = DraggingArm {}.assemble(&guess, &[0]).expect("it reaches the table");
    let v = DraggingArm {}.project_velocity(&q, &[0.6, 0.0].into()).expect("regular");
    let u = SVector::from([3.0]);
    let tau = DraggingArm {}.generalized_forces(&q, &u);
    let (a, normal) = DraggingArm {}.constrained_dynamics(&q, &v, &tau);
    let friction = -0.5 * normal[0] * 0.6 / 0.6_f64.hypot(0.01);
    let hinge = DraggingArm {}.carried(&q, &v, &u);
    let moved = DraggingArm {}.acceleration(&q, &v, &a) * 0.5;
    let missing = moved - hinge - Vector3::new(friction, normal[0] - 0.5 * 9.81, 0.0);
    assert!(missing.amax() < 1e-12, "{missing}");
    assert!(normal[0] > 0.1);
}
