//! Restitution as a ratio of impulses (Poisson): impacts in which it differs from restitution as a ratio of
//! velocities (Newton), and conditions that both satisfy.

use super::laws::Random;
use linkwork::contact::{self, Contacts};
use linkwork::prelude::*;

/// Declares a planar rod that collides with the floor at one end, with the given restitution.
macro_rules! rod {
    ($name:ident, $e:expr) => {
        #[mechanism(gravity = -gravity * y)]
        struct $name {
            gravity: f64,
            friction: f64,
            e: f64,
            #[body(mass = 3, inertia = rod(3, 2, x))]
            rod: Body,
            #[joint(ground -> rod, about = z)]
            pose: Planar,
            #[contact(rod.at(-x), ground.plane(y), friction = friction, restitution = $e)]
            end: Contact,
        }
    };
}
rod!(Impulses, poisson(e));
rod!(Velocities, e);

/// Returns the normal and slip velocities of the end after an impact of a rod that does not rotate, and the
/// loss of kinetic energy. The argument `rates` holds the velocities of the end before the impact.
fn velocities_and_loss_after_rod_impact<M>(m: &M, angle: f64, [gap, slip]: [f64; 2]) -> ([f64; 2], f64)
where
    M: Contacts<3, 3, 0, 1, 2, Scalar = f64>,
{
    let q = SVector::from([0.0, angle.sin(), angle]);
    let jacobian = m.contact_jacobian(0.0, &q);
    // The rod does not rotate, so that its end moves with the velocity of its centre.
    let moves = jacobian.fixed_columns::<2>(0).into_owned();
    let v = moves.try_inverse().unwrap() * SVector::from([gap, slip]);
    let found = contact::impact(m, 0.0, &q, &[v[0], v[1], 0.0].into()).unwrap();
    let rates = m.contact_rates(0.0, &q, &found.v);
    let taken = m.kinetic_energy(0.0, &q, &[v[0], v[1], 0.0].into()) - m.kinetic_energy(0.0, &q, &found.v);
    ([rates[0], rates[1]], taken)
}

/// Oblique impact of a rod whose slip stops during compression (Wang and Mason, *Two-dimensional rigid-body
/// collisions with friction*, J. Appl. Mech. 59, 1992: sticking in the phase of compression). With
/// `W = G M⁻¹ Gᵀ`, all contact velocities are zero at the end of compression, so its impulses are `−W⁻¹ u`.
/// Restitution sticks, too, so that the end leaves with `−e (uₙ − Wₙₜ uₜ / Wₜₜ)` by Poisson's law and with
/// `−e uₙ` by Newton's. For a rod of mass `m` and length `2 l` at an angle `θ`, `m Wₙₙ = 1 + 3 cos² θ`,
/// `m Wₜₜ = 1 + 3 sin² θ` and `m |Wₙₜ| = 3 sin θ cos θ`.
#[test]
fn poisson_rebound_of_an_oblique_rod_exceeds_newtons() {
    let (friction, e, gravity) = (2.0, 0.6, 0.0);
    let (poisson, newton) = (Impulses { gravity, friction, e }, Velocities { gravity, friction, e });
    for angle in [0.6, 0.8, 1.0_f64] {
        let q = SVector::from([0.0, angle.sin(), angle]);
        let jacobian = poisson.contact_jacobian(&q);
        let w = jacobian * poisson.mass_matrix(&q).try_inverse().unwrap() * jacobian.transpose();
        let (sine, cosine) = angle.sin_cos();
        let [nn, tt, nt] = [1.0 + 3.0 * cosine * cosine, 1.0 + 3.0 * sine * sine, 3.0 * sine * cosine];
        assert!((w[(0, 0)] * 3.0 - nn).abs() < 1e-12 && (w[(1, 1)] * 3.0 - tt).abs() < 1e-12);
        assert!((w[(0, 1)].abs() * 3.0 - nt).abs() < 1e-12);
        let share = nt / tt * w[(0, 1)].signum();
        for slip in [-0.4, -0.1, 0.0, 0.1, 0.4] {
            // Impulses of compression, with the tangential one inside the friction cone.
            let pressed = (tt + nt * w[(0, 1)].signum() * slip) / (nn * tt - nt * nt);
            let along = (-nt * w[(0, 1)].signum() - nn * slip) / (nn * tt - nt * nt);
            assert!(along.abs() < friction * pressed && share.abs() < friction);
            let (found, taken) = velocities_and_loss_after_rod_impact(&poisson, angle, [-1.0, slip]);
            let wanted = e * (1.0 + share * slip);
            assert!((found[0] - wanted).abs() < 1e-12 && found[1].abs() < 1e-12, "{found:?} {wanted}");
            assert!(taken > 0.0);
            let (found, _) = velocities_and_loss_after_rod_impact(&newton, angle, [-1.0, slip]);
            assert!((found[0] - e).abs() < 1e-12 && found[1].abs() < 1e-12, "{found:?}");
        }
    }
}

/// Poisson's and Newton's laws agree while the slip continues: the end leaves with `−e uₙ`, and the slip is
/// reduced by `μ` times the impulse.
#[test]
fn poisson_and_newton_restitution_agree_during_slip() {
    let (friction, e, gravity) = (0.1, 0.6, 0.0);
    for angle in [0.6, 0.8, 1.0] {
        for slip in [-3.0, 3.0] {
            let (poisson, _) =
                velocities_and_loss_after_rod_impact(&Impulses { gravity, friction, e }, angle, [-1.0, slip]);
            let (newton, _) = velocities_and_loss_after_rod_impact(
                &Velocities { gravity, friction, e },
                angle,
                [-1.0, slip],
            );
            assert!((poisson[0] - e).abs() < 1e-12, "{poisson:?}");
            assert!(
                (poisson[1] - newton[1]).abs() < 1e-12 && poisson[1] * slip > 0.0,
                "{poisson:?} {newton:?}"
            );
        }
    }
}

/// Time stepping through the oblique impact converges to the velocity of the impact as the steps get shorter.
#[test]
fn time_steps_converge_to_the_poisson_impact() {
    let m = Impulses { gravity: 9.81, friction: 1.0, e: 0.6 };
    let angle: f64 = 0.8;
    let (sine, cosine) = angle.sin_cos();
    let q = SVector::from([0.0, sine + 1e-3, angle]);
    let v = SVector::from([0.3, -1.0, 0.0]);
    let located = simulate(&m).from(q, v).method(EventDriven::new()).duration(0.02).finish().unwrap();
    // The rod falls by a millimetre before the impact, and collides with this velocity.
    let speed = (1.0 + 2.0 * 9.81 * 1e-3_f64).sqrt();
    let struck = (speed - 1.0) / 9.81;
    let gap = m.contact_rates(&located.q, &located.v)[0];
    let (tt, nt) = (1.0 + 3.0 * sine * sine, 3.0 * sine * cosine);
    let slip = m.contact_rates(&q, &v)[1];
    let sign = {
        let jacobian = m.contact_jacobian(&q);
        (jacobian * m.mass_matrix(&q).try_inverse().unwrap() * jacobian.transpose())[(0, 1)].signum()
    };
    let leaves = 0.6 * (speed + sign * nt / tt * slip);
    // After the impact the end moves on a curve.
    assert!((gap - leaves).abs() < 0.6, "{gap} {leaves}");
    let early = simulate(&m).from(q, v).method(EventDriven::new()).duration(struck + 1e-7).finish().unwrap();
    let found = m.contact_rates(&early.q, &early.v)[0];
    assert!((found - leaves).abs() < 1e-4, "{found} {leaves}");
    let mut before = f64::INFINITY;
    for h in [1e-3, 1e-4, 1e-5] {
        let end = simulate(&m).from(q, v).method(TimeStepping::step(h)).duration(0.02).finish().unwrap();
        let apart = (end.v - located.v).amax();
        assert!(apart < 40.0 * h && apart < before, "{h}: {apart}");
        before = apart;
    }
}

/// Ball that bounces with Poisson's restitution. It comes to rest at the same time as with Newton's
/// restitution, with both methods of simulating contacts, and stays at rest, since without compression no
/// impulse lifts it.
#[mechanism(gravity = -9.81 * z)]
struct Ball {
    #[body(mass = 0.5, inertia = sphere(0.5, 0.1))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.1), ground.plane(z), friction = 0.3, restitution = poisson(0.5))]
    floor: Contact,
}

#[test]
fn ball_bounces_and_rests_with_poisson_restitution() {
    let m = Ball {};
    let mut q = m.neutral();
    q[2] = 0.6;
    // √(2 h / g) (1 + e) / (1 − e).
    let rests = (1.0 / 9.81_f64).sqrt() * 3.0;
    let located = simulate(&m).from(q, [0.0; 6]).method(EventDriven::new());
    let apex = located.clone().duration((1.0 / 9.81_f64).sqrt() * 1.5).finish().unwrap();
    assert!((apex.q[2] - 0.1 - 0.125).abs() < 1e-10 && apex.v[2].abs() < 1e-10, "{}", apex.q);
    let end = located.duration(rests + 0.5).finish().unwrap();
    assert!((end.q[2] - 0.1).abs() < 1e-12 && end.v.amax() < 1e-12, "{}", end.v);
    let steps = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(1e-3)).duration(rests + 0.5);
    let mut highest = 0.0_f64;
    for sample in steps {
        let sample = sample.unwrap();
        if sample.t > rests + 0.1 {
            highest = highest.max((sample.q[2] - 0.1).abs());
        }
    }
    assert!(highest < 1e-9, "{highest}");
}

/// Block that collides with a floor and a wall with Poisson's restitution.
#[mechanism(gravity = -9.81 * z)]
struct Block {
    friction: f64,
    restitution: f64,
    #[body(mass = 2, com = 0.02 * x, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(
        block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = friction, restitution = poisson(restitution)
    )]
    floor: Contact,
    #[contact(
        block.cuboid(0.3, 0.2, 0.1), ground.at(-0.15 * x).plane(x), friction = friction,
        restitution = restitution
    )]
    wall: Contact,
}

#[mechanism(gravity = -9.81 * y)]
struct DoublePendulumAboveFloor {
    friction: f64,
    restitution: f64,
    #[body(mass = 1, com = 0.25 * x, inertia = rod(1, 0.5, x))]
    first: Body,
    #[body(mass = 1, com = 0.25 * x, inertia = rod(1, 0.5, x))]
    second: Body,
    #[joint(ground.at(height * y) -> first, about = z)]
    upper: Pin,
    #[joint(first.at(0.5 * x) -> second, about = z)]
    lower: Pin,
    height: f64,
    #[contact(second.at(0.5 * x), ground.plane(y), friction = friction, restitution = poisson(restitution))]
    tip: Contact,
}

/// Checks the conditions on an impact that both laws of restitution share.
fn check_impact_conditions<M, const NQ: usize, const NV: usize, const NK: usize, const NR: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
) where
    M: Contacts<NQ, NV, 0, NK, NR, Scalar = f64>,
{
    let found = contact::impact(m, 0.0, q, v).unwrap();
    let (before, after) = (m.contact_rates(0.0, q, v), m.contact_rates(0.0, q, &found.v));
    let speed = before.amax().max(after.amax());
    let energy = m.kinetic_energy(0.0, q, v);
    let grown = m.kinetic_energy(0.0, q, &found.v) - energy;
    assert!(grown < 1e-12 * energy, "energy grows by {grown} of {energy}");
    let push =
        m.mass_matrix(0.0, q) * (found.v - v) - m.contact_jacobian(0.0, q).transpose() * found.impulses;
    assert!(push.amax() <= 1e-11 * (found.impulses.amax() + 1e-3), "{push}");
    let (gaps, laws) = (m.contact_gaps(0.0, q), m.contact_laws());
    for (k, rows) in M::CONTACT_ROWS.iter().enumerate().filter(|(k, _)| gaps[*k] < 1e-8) {
        let normal = found.impulses[rows.first];
        let along = found.impulses.rows(rows.first + 1, rows.count - 1).norm();
        assert!(normal >= 0.0 && after[rows.first] >= -5e-8 * speed, "{k}: {normal} {}", after[rows.first]);
        assert!(along <= laws[k].friction * normal * (1.0 + 1e-9) + 1e-11 * found.impulses.amax(), "{k}");
    }
}

/// Energy never grows, normal impulses are nonnegative, friction stays in its cone, and surfaces do not
/// approach. The cases have many simultaneous contacts, contacts with Newton's law at the same time, and
/// impacts in which Newton's law alone would add energy.
#[test]
fn poisson_impacts_satisfy_contact_conditions() {
    let mut random = Random(31);
    for _ in 0..300 {
        let friction = random.random_choice([0.0, 0.05, 0.3, 0.8, 2.0]);
        let m = Block { friction, restitution: random.random_choice([0.2, 0.6, 1.0]) };
        let mut q = m.neutral();
        q[2] = 0.05;
        if random.next() > 0.3 {
            q[0] = 1.0;
        }
        check_impact_conditions(&m, &q, &random.random_vector(3.0));
    }
    for _ in 0..2000 {
        let (a, b) = (random.next() * 3.0, random.next() * 3.0);
        let height = -(0.5 * a.sin() + 0.5 * (a + b).sin());
        let friction = random.random_choice([0.0, 0.3, 0.7, 3.0]);
        let m =
            DoublePendulumAboveFloor { friction, restitution: random.random_choice([0.5, 0.9, 1.0]), height };
        check_impact_conditions(&m, &[a, b].into(), &random.random_vector(3.0));
    }
}

/// Slider-crank whose slide collides with a stop, with Poisson's restitution.
#[mechanism]
struct SliderCrankWithStop {
    e: f64,
    #[body(mass = 1, com = 0.05 * x, inertia = rod(1, 0.1, x))]
    crank: Body,
    #[joint(ground -> crank, about = z)]
    shaft: Pin,
    #[body(mass = 1, com = 0.15 * x, inertia = rod(1, 0.3, x))]
    rod: Body,
    #[joint(crank.at(0.1 * x) -> rod, about = z)]
    wrist: Pin,
    #[body(mass = 2, inertia = cuboid(2, 0.1, 0.1, 0.1))]
    slide: Body,
    #[joint(ground -> slide, along = x)]
    way: Sleeve,
    #[joint(rod.at(0.3 * x) -> slide, about = z)]
    bolt: Pin,
    #[limit(on = way, to = 0.37, restitution = poisson(e))]
    stop: Limit,
}

/// Checks an impact in a closed loop with Poisson's restitution: the slide leaves with the fraction `e` of
/// its speed, the energy decreases by the fraction `1 − e²`, and velocities satisfy the constraints.
#[test]
fn poisson_impacts_keep_loops_closed() {
    let m = SliderCrankWithStop { e: 0.7 };
    let cosine: f64 = (0.37 * 0.37 + 0.01 - 0.09) / (2.0 * 0.37 * 0.1);
    let angle = cosine.acos();
    let lean = -(angle.sin() / 3.0).asin();
    let q = SVector::from([angle, lean - angle, 0.1 * cosine + 0.3 * lean.cos()]);
    let v = m.project_velocity(&q, &[0.0, 0.0, 1.0].into()).unwrap();
    let found = contact::impact(&m, 0.0, &q, &v).unwrap();
    assert!((m.constraint_jacobian(&q) * found.v).amax() < 1e-12);
    assert!((found.v[2] + 0.7 * v[2]).abs() < 1e-12 && v[2] > 0.1, "{}", found.v);
    let energy = m.kinetic_energy(&q, &v);
    assert!((m.kinetic_energy(&q, &found.v) - 0.49 * energy).abs() < 1e-12 * energy);
}
