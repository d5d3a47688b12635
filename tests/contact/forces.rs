//! Contact forces in a state, and outputs that refer to them.

use super::laws::Random;
use linkwork::contact::{self, Touch};
use linkwork::nalgebra::Vector3;
use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * cos(tilt) * z + 9.81 * sin(tilt) * x)]
struct Ball {
    tilt: f64,
    friction: f64,
    #[body(mass = 0.1, inertia = sphere(0.1, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.05), ground.plane(z), friction = friction)]
    touch: Contact,
    #[output(contact_force(touch))]
    force: Vector,
    #[output(dot(contact_force(touch), ground.z))]
    press: Scalar,
}

fn resting_configuration() -> SVector<f64, 7> {
    [0.0, 0.0, 0.05, 0.0, 0.0, 0.0, 1.0].into()
}

/// Sphere on a slope of 15°, with the parameters of Drake's test of a rolling sphere.
#[test]
fn friction_holds_a_rolling_sphere() {
    let m = Ball { tilt: 15.0_f64.to_radians(), friction: 0.5 };
    let force = m.force(&resting_configuration(), &SVector::zeros()).unwrap();
    assert!((force - Vector3::new(-0.072_543_280_927_306_54, 0.0, 0.1 * 9.81 * m.tilt.cos())).amax() < 1e-9);
    assert_eq!(m.press(&resting_configuration(), &SVector::zeros()).unwrap(), force[2]);
    // No force acts in the air.
    let mut q = resting_configuration();
    q[2] += 1e-6;
    assert_eq!(m.force(&q, &SVector::zeros()).unwrap(), Vector3::zeros());
}

/// Friction opposes the slip velocity, at any speed.
#[test]
fn friction_opposes_a_sliding_sphere() {
    let m = Ball { tilt: 0.0, friction: 0.2 };
    for speed in [1e-4, 1.0, 30.0] {
        let v = [0.6 * speed, -0.8 * speed, 0.0, 0.0, 0.0, 0.0].into();
        let force = m.force(&resting_configuration(), &v).unwrap();
        let weight = 0.1 * 9.81;
        assert!((force - Vector3::new(-0.12, 0.16, 1.0) * weight).amax() < 1e-9, "{force}");
    }
}

#[mechanism(gravity = -9.81 * z)]
struct LoadOnTable {
    #[body(mass = 3, inertia = cuboid(3, 1, 0.6, 0.1))]
    top: Body,
    #[joint(ground -> top)]
    pose: Free,
    #[body(mass = 2, inertia = cuboid(2, 0.2, 0.2, 0.1))]
    load: Body,
    #[joint(top -> load)]
    place: Free,
    #[contact(ground.plane(z), top.cuboid(1, 0.6, 0.1), friction = 0.4)]
    floor: Contact,
    #[contact(load.cuboid(0.2, 0.2, 0.1), top.at(0.05 * z).plane(z), friction = 0.4)]
    stack: Contact,
    #[output(contact_force(floor), resolved_in = top)]
    below: Vector,
    #[output(contact_force(stack))]
    between: Vector,
}

/// The output is the total force of the second surface on the first over all points, for either order of the
/// surfaces.
#[test]
fn contact_force_outputs_act_on_the_first_surface() {
    let m = LoadOnTable {};
    let q: [f64; 14] = core::array::from_fn(|k| {
        if k == 2 {
            0.05
        } else if k == 9 {
            0.1
        } else {
            f64::from(k == 6 || k == 13)
        }
    });
    let (below, between) =
        (m.below(&q.into(), &SVector::zeros()).unwrap(), m.between(&q.into(), &SVector::zeros()).unwrap());
    assert!((below - Vector3::new(0.0, 0.0, -5.0 * 9.81)).amax() < 1e-7, "{below}");
    assert!((between - Vector3::new(0.0, 0.0, 2.0 * 9.81)).amax() < 1e-7, "{between}");
    let all = contact::acting(&m, 0.0, &q.into(), &SVector::zeros(), &SVector::zeros()).unwrap();
    assert!(all.iter().all(|force| force.abs() < 5.0 * 9.81));
}

#[mechanism(gravity = -9.81 * z)]
struct SliderCrankWithStop {
    #[body(mass = 0.5, inertia = rod(0.5, 0.04, x))]
    crank: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[body(mass = 0.3, inertia = rod(0.3, 0.13, x))]
    rod: Body,
    #[joint(crank.at(0.04 * x) -> rod, about = z)]
    big_end: Pin,
    #[body(mass = 0.5, inertia = 0)]
    piston: Body,
    #[joint(ground -> piston, along = x)]
    bore: Sleeve,
    #[joint(rod.at(0.13 * x) -> piston, about = z)]
    small_end: Pin,
    #[contact(piston, ground.at(0.165 * x).plane(-x))]
    stop: Contact,
    #[acts(on = main)]
    motor: Torque,
    #[output(dot(contact_force(stop), ground.x))]
    load: Scalar,
}

/// Through a closed loop, virtual work of the motor equals virtual work of the force at the stop.
#[test]
fn motor_presses_a_piston_onto_its_stop() {
    let m = SliderCrankWithStop {};
    // Angle of the crank with the piston at its stop.
    let angle = ((0.04_f64.powi(2) + 0.165_f64.powi(2) - 0.13_f64.powi(2)) / (2.0 * 0.04 * 0.165)).acos();
    let guess = m.neutral();
    let mut guess = guess;
    guess[0] = -angle;
    let start = m.assemble(&guess, &[0]).unwrap();
    assert!(m.contact_gaps(&start)[0].abs() < 1e-9);
    let load = m.load(&start, &SVector::zeros(), &[1.5].into()).unwrap();
    // Virtual work: derivative of the piston's position with respect to the crank's angle.
    let piston_position =
        |angle: f64| 0.04 * angle.cos() + (0.13_f64.powi(2) - (0.04 * angle.sin()).powi(2)).sqrt();
    let slope = (piston_position(-angle + 1e-6) - piston_position(-angle - 1e-6)) / 2e-6;
    assert!((load + 1.5 / slope).abs() < 1e-5 * load.abs(), "{load} {slope}");
}

/// Checks forces for prescribed contact modes: they satisfy the equations of motion, also in a closed loop
/// and with slip. At rest they equal the forces of the complementarity conditions.
#[test]
fn prescribed_closed_contacts_remain_closed() {
    let m = LoadOnTable {};
    let mut q = m.neutral();
    (q[2], q[9]) = (0.05, 0.1);
    let mut tau = SVector::<f64, 12>::from_fn(|k, _| f64::from(k as u32 % 5) - 2.0);
    tau[2] = -1.0;
    tau[8] = -3.0;
    for (kind, speed) in [(Touch::Sticks, 0.0), (Touch::Slips, 0.3)] {
        let mut v = SVector::<f64, 12>::zeros();
        v[6] = speed;
        let touches: [Touch; 16] = core::array::from_fn(|k| match k {
            0..4 => Touch::Sticks,
            8..12 => kind,
            _ => Touch::Open,
        });
        let found = contact::forward_dynamics(&m, 0.0, &q, &v, &tau, &touches).unwrap();
        let (g, b) = (m.contact_jacobian(&q), m.contact_bias(&q, &v));
        let left = m.mass_matrix(&q) * found.a + m.bias_forces(&q, &v) - tau - g.transpose() * found.forces;
        assert!(left.amax() < 1e-9, "{left}");
        let (rates, slip) = (g * found.a + b, m.contact_rates(&q, &v));
        for (k, touch) in touches.iter().enumerate() {
            let contact::Rows { first, .. } = LoadOnTable::CONTACT_ROWS[k];
            let force = found.forces.fixed_rows::<3>(first);
            match touch {
                Touch::Open => assert_eq!(force.norm(), 0.0),
                Touch::Sticks => assert!(rates.fixed_rows::<3>(first).amax() < 1e-8, "{rates}"),
                Touch::Slips => {
                    let along = slip.fixed_rows::<2>(first + 1).normalize();
                    let friction = force.fixed_rows::<2>(1) + along * (0.4 * force[0]);
                    assert!(rates[first].abs() < 1e-8 && friction.amax() < 1e-8, "{friction}");
                }
            }
        }
    }
    // For a system at rest, the prescribed modes give the acting forces.
    let touches: [Touch; 16] = core::array::from_fn(|k| if k % 8 < 4 { Touch::Sticks } else { Touch::Open });
    let still = SVector::zeros();
    let found = contact::forward_dynamics(&m, 0.0, &q, &still, &SVector::zeros(), &touches).unwrap();
    let acting = contact::acting(&m, 0.0, &q, &still, &SVector::zeros()).unwrap();
    let push = m.contact_jacobian(&q).transpose() * (found.forces - acting);
    assert!(found.a.amax() < 1e-9 && push.amax() < 1e-6, "{push}");
}

/// Heavy particle on a light one, which lies on the floor: contacts with a large mass ratio.
#[mechanism(gravity = -9.81 * z)]
struct HeavyOnLightParticle {
    mass: f64,
    #[particle(mass = 1e-4)]
    sheet: Particle,
    #[joint(ground -> sheet, along = z)]
    low: Sleeve,
    #[particle(mass = mass)]
    anvil: Particle,
    #[joint(ground -> anvil, along = z)]
    high: Sleeve,
    #[contact(sheet, ground.plane(z))]
    floor: Contact,
    #[contact(anvil, sheet.plane(z))]
    face: Contact,
}

/// Forces are resolved for any mass ratio, in both orders of contacts that matter for the elimination.
#[test]
fn heavy_bodies_rest_on_light_ones() {
    for mass in [1.0, 1e2, 1e3, 1e4, 1e5] {
        let m = HeavyOnLightParticle { mass };
        let (q, none) = (SVector::zeros(), SVector::zeros());
        for touches in [[Touch::Sticks; 2], [Touch::Slips; 2]] {
            let held = contact::forward_dynamics(&m, 0.0, &q, &none, &none, &touches).unwrap();
            assert!((held.forces[1] / (mass * 9.81) - 1.0).abs() < 1e-6, "{mass}: {}", held.forces);
            assert!((held.forces[0] / ((mass + 1e-4) * 9.81) - 1.0).abs() < 1e-6, "{mass}: {}", held.forces);
            // Bound of the rounding error of the light particle's weight under the heavy one.
            assert!(held.a.amax() < 1e-15 * mass * 9.81 / 1e-4 + 1e-9, "{mass}: {}", held.a);
        }
        let run = simulate(&m).from([0.0; 2], [0.0; 2]).method(TimeStepping::step(1e-3)).duration(1.0);
        assert!(run.finish().unwrap().q.amax() < 1e-8);
    }
}

/// A stop with a prescribed closed mode contradicts a constraint that accelerates the same hinge.
#[test]
fn contradictory_contact_modes_are_errors() {
    #[mechanism]
    struct HingedArmAndCart {
        #[body(mass = 1, inertia = rod(1, 1, x))]
        arm: Body,
        #[joint(ground -> arm, about = z)]
        hinge: Pin,
        #[body(mass = 1, inertia = 0)]
        cart: Body,
        #[joint(ground -> cart, along = z)]
        rail: Sleeve,
        #[constraint(rate(hinge) - 2 * t)]
        driven: Nonholonomic,
        #[limit(on = hinge, from = 0, restitution = 0)]
        stop: Limit,
    }
    let held = contact::forward_dynamics(
        &HingedArmAndCart {},
        0.0,
        &SVector::zeros(),
        &SVector::zeros(),
        &SVector::zeros(),
        &[Touch::Sticks],
    );
    assert_eq!(held.unwrap_err(), ConstraintError::Contact { constraint: "stop.from" });
}

/// Rod of 1 m and 1 kg whose end slides, with the rod falling against the slip.
#[mechanism(gravity = -9.81 * y)]
struct Rod {
    friction: f64,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    pose: Planar,
    #[contact(rod.at(0), ground.plane(y), friction = friction)]
    tip: Contact,
    #[output(contact_force(tip))]
    force: Vector,
}

/// The normal acceleration of the end of a rod at the angle `θ` that slides with friction `μ` in the
/// direction `s` is `a + p N` with `p m = 1 + 3 cos θ (cos θ + s μ sin θ)`. For `p < 0 < −a` no finite force
/// prevents penetration of the floor (Painlevé); for `p > 0` the force is `−a / p`.
#[test]
fn painleve_paradox_is_reported_as_error() {
    let mut random = Random(3);
    let mut jammed = 0;
    for _ in 0..1000 {
        let (angle, friction) = (0.8 + 0.6 * random.next(), 1.5 + 1.5 * random.next());
        let slip = random.next();
        let m = Rod { friction };
        let (sine, cosine) = angle.sin_cos();
        let (q, v) = ([0.0, 0.0, angle].into(), [slip, 0.0, 0.0].into());
        // Friction is −s μ N along x: its moment about the centre moves the end up or down.
        let answer = 1.0 + 3.0 * cosine * (cosine + slip.signum() * friction * sine);
        let found = m.force(&q, &v);
        if answer < -1e-3 {
            jammed += 1;
            assert!(matches!(found, Err(ConstraintError::Contact { constraint: "tip" })), "{found:?}");
            assert!(contact::acting(&m, 0.0, &q, &v, &SVector::zeros()).is_err());
        } else if answer > 1e-2 && slip.abs() > 1e-3 {
            let press = 9.81 / answer;
            let force = found.unwrap();
            let expected = Vector3::new(-slip.signum() * friction * press, press, 0.0);
            assert!((force - expected).amax() < 1e-6 * (1.0 + press), "{force} {expected}");
        }
    }
    assert!(jammed > 50, "{jammed}");
}
