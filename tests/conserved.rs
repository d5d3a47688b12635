//! Quantities that are conserved along motions, and Hamilton's equations against the other formulations.

use linkwork::nalgebra::SVector;
use linkwork::prelude::*;
use support::compare::assert_close_relative_to_largest;
use support::random::Random;

/// Lagrange's top: a symmetric rigid body with one fixed point under gravity.
#[mechanism(gravity = -9.81 * z, conserved, hamilton)]
struct Top {
    height: f64,
    #[body(mass = 2, com = height * z, inertia = diagonal(0.3, 0.3, 0.2))]
    top: Body,
    #[joint(ground -> top)]
    tip: Ball,
}

/// Rigid body that moves freely in space, without forces.
#[mechanism(conserved, hamilton)]
struct FreeRigidBody {
    #[body(mass = 2, com = 0.1 * x + 0.2 * y, inertia = diagonal(0.3, 0.4, 0.5))]
    stone: Body,
    #[joint(ground -> stone)]
    flight: Free,
}

/// Two carts on a rail with a spring between them, and a pendulum on the second.
#[mechanism(gravity = -9.81 * y, conserved, hamilton)]
struct CoupledCartsWithPendulum {
    mass: f64,
    #[body(mass = mass)]
    first: Body,
    #[body(mass = 2 * mass)]
    second: Body,
    #[body(mass = 0.3, com = -0.5 * y, inertia = rod(0.3, 1, y))]
    pole: Body,
    #[joint(ground -> first, along = x)]
    rail: Sleeve,
    #[joint(first -> second, along = x)]
    apart: Sleeve,
    #[joint(second -> pole, about = z)]
    hinge: Pin,
    #[acts(on = apart, stiffness = 30, free_length = 0.5)]
    spring: Spring,
    #[acts(on = hinge)]
    motor: Torque,
}

/// Cart on a rail with a pendulum, whose hinge has viscous friction, so that energy is not conserved.
#[mechanism(gravity = -9.81 * y, conserved, hamilton)]
struct CartWithFrictionalPendulum {
    #[body(mass = 1)]
    first: Body,
    #[body(mass = 0.3, com = -0.5 * y, inertia = rod(0.3, 1, y))]
    pole: Body,
    #[joint(ground -> first, along = x)]
    rail: Sleeve,
    #[joint(first -> pole, about = z)]
    hinge: Pin,
    #[acts(on = hinge, damping = 1e-3)]
    grease: Dashpot,
}

/// Bead on a hoop that rotates at a constant rate.
#[mechanism(gravity = -9.81 * z, conserved, hamilton)]
struct BeadOnRotatingHoop {
    spin: f64,
    theta: Coordinate,
    #[frame(ground, z(spin * t))]
    hoop: Frame,
    #[particle(mass = 0.2, at = 0.5 * (sin(theta) * hoop.x - cos(theta) * hoop.z))]
    bead: Particle,
}

/// Pendulum whose pivot moves sinusoidally in time, so that energy is not conserved.
#[mechanism(gravity = -9.81 * y, conserved, hamilton)]
struct PendulumWithMovingPivot {
    theta: Coordinate,
    #[particle(mass = 0.2, at = (0.3 * sin(3 * t) + sin(theta)) * x - cos(theta) * y)]
    bob: Particle,
}

/// Planet and sun as two particles that attract each other.
#[mechanism(conserved, hamilton)]
struct Planets {
    pull: f64,
    #[particle(mass = 3)]
    sun: Particle,
    #[particle(mass = 1)]
    planet: Particle,
    #[joint(ground -> sun, along = (x, y, z))]
    first: Stage,
    #[joint(ground -> planet, along = (x, y, z))]
    second: Stage,
    #[energy(-pull / norm(r(planet / sun)))]
    gravity: Potential,
}

/// Charged particle in crossed electric and magnetic fields.
#[mechanism(conserved)]
struct Charge {
    electric: f64,
    #[particle(mass = 0.5)]
    ion: Particle,
    #[joint(ground -> ion, along = (x, y, z))]
    flight: Stage,
    #[acts(on = ion, value = electric * ground.y + cross(v(ion / ground / ground), 0.7 * ground.z))]
    lorentz: Force,
}

/// Four-bar linkage, whose loop is closed by a constraint.
#[mechanism(gravity = -9.81 * y, conserved)]
struct FourBar {
    #[body(mass = 1, com = 0.1 * x, inertia = rod(1, 0.2, x))]
    crank: Body,
    #[body(mass = 1, com = 0.3 * x, inertia = rod(1, 0.6, x))]
    coupler: Body,
    #[body(mass = 1, com = 0.25 * x, inertia = rod(1, 0.5, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    input: Pin,
    #[joint(crank.at(0.2 * x) -> coupler, about = z)]
    joint: Pin,
    #[joint(ground.at(0.55 * x) -> rocker, about = z)]
    output: Pin,
    #[joint(coupler.at(0.6 * x) -> rocker.at(0.5 * x), about = z)]
    last: Pin,
}

/// Three links on a floating base that form a closed triangle with a slider.
#[mechanism(conserved)]
struct FloatingTriangle {
    #[body(mass = 3, inertia = diagonal(1, 1, 1))]
    hull: Body,
    #[body(mass = 1, com = 0.1 * x, inertia = rod(1, 0.2, x))]
    crank: Body,
    #[body(mass = 1, com = 0.3 * x, inertia = rod(1, 0.6, x))]
    rod: Body,
    #[body(mass = 0.5)]
    piston: Body,
    #[joint(ground -> hull, along = (x, y))]
    place: Stage,
    #[joint(hull -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(0.2 * x) -> rod, about = z)]
    big_end: Pin,
    #[joint(hull -> piston, along = x)]
    cylinder: Sleeve,
    #[joint(rod.at(0.6 * x) -> piston, about = z)]
    small_end: Pin,
}

/// Disk that rolls on a plane without slipping.
#[mechanism(gravity = -9.81 * z, conserved)]
struct RollingDisk {
    #[body(mass = 0.5, inertia = disk(0.5, 0.2, y))]
    disk: Body,
    #[joint(ground -> disk)]
    pose: Free,
    #[constraint(rolls(disk.circle(0.2, y), ground.plane(z)))]
    contact: Rolling,
}

/// Ball that slides on a plane with friction.
#[mechanism(gravity = -9.81 * z, conserved)]
struct BallSlidingOnPlane {
    #[body(mass = 1, inertia = sphere(1, 1))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[constraint(slips(ball.sphere(1), ground.plane(z)), friction = 0.2)]
    lane: Slipping,
}

#[test]
fn conserved_quantities_are_listed() {
    let [axis, about] = ["angular momentum along", ", about the ground's origin"];
    assert_eq!(Top::CONSERVED, ["energy", "momentum of tip.wz", &format!("{axis} z{about}")]);
    let center = ", about the centre of mass";
    let six =
        ["linear momentum along x", "linear momentum along y", "linear momentum along z"].map(String::from);
    let three = ["x", "y", "z"].map(|k| format!("{axis} {k}{center}"));
    let all: Vec<String> =
        ["energy".to_string()].into_iter().chain(six.clone()).chain(three.clone()).collect();
    assert_eq!(FreeRigidBody::CONSERVED[..7], all);
    assert_eq!(CoupledCartsWithPendulum::CONSERVED, ["energy", "momentum of rail"]);
    assert_eq!(CartWithFrictionalPendulum::CONSERVED, ["momentum of rail"]);
    assert_eq!(BeadOnRotatingHoop::CONSERVED, ["Jacobi's integral"]);
    assert_eq!(PendulumWithMovingPivot::CONSERVED, [""; 0]);
    assert_eq!(Planets::CONSERVED[..7], all);
    assert_eq!(Charge::CONSERVED, ["momentum of flight.z"]);
    assert_eq!(FourBar::CONSERVED, ["energy"]);
    assert_eq!(FloatingTriangle::CONSERVED, ["energy", "momentum of place.x", "momentum of place.y"]);
    assert_eq!(RollingDisk::CONSERVED[0], "energy");
    assert_eq!(BallSlidingOnPlane::CONSERVED, [""; 0]);
}

/// Checks that all conserved quantities of the mechanism are constant along a motion.
macro_rules! stays {
    ($mechanism:expr, $q:expr, $v:expr, |$m:ident, $t:ident, $at:ident, $rate:ident| $kept:expr) => {{
        let $m = $mechanism;
        let run = simulate(&$m)
            .from($q, $v)
            .method(DormandPrince::new().tolerance(1e-12, 1e-12))
            .duration(3.0)
            .sample_every(0.1);
        let mut first = None;
        for sample in run {
            let sample = sample.unwrap();
            let ($t, $at, $rate) = (sample.t, sample.q, sample.v);
            let _ = $t;
            let kept = $kept;
            let first = *first.get_or_insert(kept);
            assert!((kept - first).amax() < 3e-9 * (1.0 + first.amax()), "{kept} {first} at {}", sample.t);
        }
    }};
}

#[test]
fn conserved_quantities_are_constant_along_motions() {
    let mut random = Random::new(7);
    let top = Top { height: 0.2 };
    stays!(&top, random.random_configuration(&top), random.random_vector(4.0), |m, t, q, v| m
        .conserved(&q, &v));
    stays!(
        FreeRigidBody {},
        random.random_configuration(&FreeRigidBody {}),
        random.random_vector(2.0),
        |m, t, q, v| m.conserved(&q, &v)
    );
    stays!(CoupledCartsWithPendulum { mass: 1.3 }, [0.1, 0.7, 0.9], [0.4, -1.0, 2.0], |m, t, q, v| m
        .conserved(&q, &v));
    stays!(CartWithFrictionalPendulum {}, [0.1, 0.7], [0.4, 2.0], |m, t, q, v| m.conserved(&q, &v));
    stays!(BeadOnRotatingHoop { spin: 5.0 }, [0.4], [1.0], |m, t, q, v| m.conserved(t, &q, &v));
    let (q, v) = ([0.0, 0.0, 0.0, 1.0, 0.2, 0.1], [0.1, -0.3, 0.2, 0.2, 1.2, 0.5]);
    stays!(Planets { pull: 4.0 }, q, v, |m, t, q, v| m.conserved(&q, &v));
    stays!(Charge { electric: 2.0 }, [0.0; 3], [1.0, 2.0, 3.0], |m, t, q, v| m.conserved(&q, &v));
    let q = FourBar {}.assemble(&[1.0, -0.5, 1.5].into(), &[0]).unwrap();
    let v = FourBar {}.complete_velocity(&q, &[3.0, 0.0, 0.0].into(), &[0]).unwrap();
    stays!(FourBar {}, q, v, |m, t, q, v| m.conserved(&q, &v));
    let q = FloatingTriangle {}.assemble(&[0.0, 0.0, 1.0, -1.3, 0.6].into(), &[2]).unwrap();
    let v =
        FloatingTriangle {}.complete_velocity(&q, &[0.3, -0.2, 3.0, 0.0, 0.0].into(), &[0, 1, 2]).unwrap();
    stays!(FloatingTriangle {}, q, v, |m, t, q, v| m.conserved(&q, &v));
    let q = RollingDisk {}.assemble(&[0.0, 0.0, 0.2, 0.1, 0.0, 0.0, 0.995].into(), &[]).unwrap();
    let v = RollingDisk {}.project_velocity(&q, &[1.0, 0.0, 0.0, 0.2, 5.0, 0.3].into()).unwrap();
    stays!(RollingDisk {}, q, v, |m, t, q, v| m.conserved(&q, &v));
}

/// Checks `v = ∂H/∂p`, the energy, and that `ṗ` agrees with `momentum_rate`.
macro_rules! canonical {
    ($m:expr, $q:expr, $v:expr, $tau:expr, $energy:expr $(, $t:expr)?) => {{
        let (m, q, v, tau) = ($m, $q, $v, $tau);
        let p = m.generalized_momentum($($t,)? &q, &v);
        assert_close_relative_to_largest(
            "velocity", m.canonical_velocity($($t,)? &q, &p).as_slice(), v.as_slice(), 1e-11,
        );
        let rate = m.momentum_rate($($t,)? &q, &v) + tau;
        assert_close_relative_to_largest(
            "rate", m.canonical_momentum_rate($($t,)? &q, &p, &tau).as_slice(), rate.as_slice(), 1e-11,
        );
        let h = m.hamiltonian($($t,)? &q, &p);
        assert_close_relative_to_largest("energy", &[h], &[$energy(&p)], 1e-11);
        for k in 0..v.len() {
            let mut step = p * 0.0;
            step[k] = 1e-4;
            let slope = (m.hamiltonian($($t,)? &q, &(p + step)) - m.hamiltonian($($t,)? &q, &(p - step))) / 2e-4;
            assert_close_relative_to_largest("∂H/∂p", &[slope], &[v[k]], 1e-8);
        }
    }};
}

#[test]
fn hamiltons_equations_agree_with_the_dynamics() {
    let mut random = Random::new(3);
    for _ in 0..5 {
        let top = Top { height: 0.3 };
        let (q, v): (SVector<f64, 4>, SVector<f64, 3>) =
            (random.random_configuration(&top), random.random_vector(2.0));
        canonical!(&top, q, v, random.random_vector(3.0), |_| top.kinetic_energy(&q, &v)
            + top.potential_energy(&q));
        let stone = FreeRigidBody {};
        let (q, v): (SVector<f64, 7>, SVector<f64, 6>) =
            (random.random_configuration(&stone), random.random_vector(2.0));
        canonical!(&stone, q, v, random.random_vector(3.0), |_| stone.kinetic_energy(&q, &v));
        let carts = CoupledCartsWithPendulum { mass: 1.1 };
        let (q, v): (SVector<f64, 3>, SVector<f64, 3>) =
            (random.random_configuration(&carts), random.random_vector(2.0));
        canonical!(&carts, q, v, random.random_vector(3.0), |_| carts.kinetic_energy(&q, &v)
            + carts.potential_energy(&q));
        let greased = CartWithFrictionalPendulum {};
        let (q, v): (SVector<f64, 2>, SVector<f64, 2>) =
            (random.random_configuration(&greased), random.random_vector(2.0));
        canonical!(&greased, q, v, random.random_vector(3.0), |_| greased.kinetic_energy(&q, &v)
            + greased.potential_energy(&q));
        let (hoop, t) = (BeadOnRotatingHoop { spin: 4.0 }, random.uniform_number(2.0));
        let (q, v): (SVector<f64, 1>, SVector<f64, 1>) =
            (random.random_vector(2.0), random.random_vector(2.0));
        let hamiltonian =
            |p: &SVector<f64, 1>| p.dot(&v) - hoop.kinetic_energy(t, &q, &v) + hoop.potential_energy(t, &q);
        canonical!(&hoop, q, v, random.random_vector(3.0), hamiltonian, t);
        let swung = PendulumWithMovingPivot {};
        let hamiltonian =
            |p: &SVector<f64, 1>| p.dot(&v) - swung.kinetic_energy(t, &q, &v) + swung.potential_energy(t, &q);
        canonical!(&swung, q, v, random.random_vector(3.0), hamiltonian, t);
    }
}

/// `ṗ = −∂H/∂q` for coordinates that are their own rates, without dissipation.
#[test]
fn momentum_rate_is_negative_gradient_of_the_hamiltonian() {
    let mut random = Random::new(5);
    let carts = CoupledCartsWithPendulum { mass: 0.8 };
    for _ in 0..5 {
        let (q, p): (SVector<f64, 3>, SVector<f64, 3>) =
            (random.random_vector(1.0), random.random_vector(2.0));
        let rate = carts.canonical_momentum_rate(&q, &p, &SVector::zeros());
        for k in 0..3 {
            let mut step = SVector::<f64, 3>::zeros();
            step[k] = 1e-4;
            let slope = (carts.hamiltonian(&(q + step), &p) - carts.hamiltonian(&(q - step), &p)) / 2e-4;
            assert_close_relative_to_largest("−∂H/∂q", &[-slope], &[rate[k]], 1e-7);
        }
    }
}
