//! Batched functions of several states return, in each lane, the same bits as the function of a single state.

use linkwork::Mechanism;
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::prelude::*;
use std::any::type_name;
use support::random::Random;

#[mechanism(urdf = "../models/urdf/ur5.urdf", batch)]
struct Ur5;

#[mechanism(urdf = "../models/urdf/kinova.urdf", batch)]
struct Kinova;

#[mechanism(urdf = "../models/urdf/panda.urdf", batch, derivatives, centroidal, regressor)]
struct Panda;

#[mechanism(urdf = "../models/urdf/panda.urdf", scalar = f32, batch)]
struct SinglePanda;

#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, batch)]
struct Solo12;

#[mechanism(urdf = "../models/urdf/simple_humanoid.urdf", base = free, batch)]
struct Humanoid;

/// Mechanism with every kind of coordinate chart, generic over its scalar type, with force laws that use many
/// functions, and an output.
#[mechanism(gravity = -g * y, derivatives, batch)]
struct MechanismOfAllCharts<T> {
    g: T,
    m: T,
    l: T,
    k: T,
    #[body(mass = m, com = 0.3 * l * x, inertia = cuboid(m, l, 2 * l, 3 * l))]
    hull: Body,
    #[body(mass = 0.4 * m, com = 0.1 * y + 0.2 * z, inertia = cylinder(m, 0.3 * l, l, x))]
    ball: Body,
    #[body(mass = 0.3 * m, com = 0.05 * x, inertia = sphere(m, 0.2))]
    weight: Body,
    #[body(mass = 0.2 * m, inertia = cuboid(m, 0.2, 0.3, 0.1))]
    rotor: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[joint(hull.at(l * x).rotated(z(0.4)) -> ball.at(0.1 * z))]
    socket: Ball,
    #[joint(hull.at(-l * y) -> weight, about = (x, y))]
    cross: Universal,
    #[joint(weight.at(l * z) -> rotor, about = z, pitch = 0.02)]
    thread: Screw,
    #[acts(
        between = (ground, weight.at(0.1 * x)),
        energy = k * (exp(stretch / l) + sqrt(stretch * stretch / (l * l) + 1))
    )]
    rope: Spring,
    #[acts(on = thread, coulomb = 0.3)]
    rubbing: Friction,
    #[acts(on = cross.first, energy = k * (ln(2 + cos(stretch)) + atan(stretch)))]
    cam: Spring,
    #[acts(on = rotor.at(0.2 * x), along = y)]
    push: Force,
    #[output(r(rotor / ball), resolved_in = hull)]
    offset: Vector,
}

/// Chain with enough velocities that its derivatives are composed from results of other generated functions.
#[mechanism(gravity = -9.81 * z, derivatives, packed, batch)]
struct Tail {
    #[body(mass = 3, com = 0.1 * x, inertia = cuboid(3, 0.4, 0.3, 0.2))]
    trunk: Body,
    #[body(mass = 1, com = 0.2 * x, inertia = cylinder(1, 0.1, 0.4, x))]
    middle: Body,
    #[body(mass = 0.5, com = 0.1 * x, inertia = cylinder(0.5, 0.1, 0.3, x))]
    tip: Body,
    #[joint(ground -> trunk)]
    pose: Free,
    #[joint(trunk.at(0.3 * x) -> middle)]
    first: Ball,
    #[joint(middle.at(0.4 * x) -> tip)]
    second: Ball,
}

/// Bead on a hoop that is driven as a function of time.
#[mechanism(gravity = -9.81 * z, batch)]
struct BeadOnRotatingHoop {
    radius: f64,
    spin: f64,
    theta: Coordinate,
    #[frame(ground, z(spin * t + 0.2 * sin(3 * t)))]
    hoop: Frame,
    #[particle(mass = 0.3, at = radius * (sin(theta) * hoop.x - cos(theta) * hoop.z))]
    bead: Particle,
    #[acts(on = theta)]
    motor: Torque,
}

/// Four-bar linkage with prepared values of its parameters. The closed loop is singular where all bars are on
/// one line.
#[mechanism(gravity = -g * y, batch, prepare, derivatives, centroidal)]
struct FourBar {
    g: f64,
    l: f64,
    #[body(mass = 1, com = l / 2 * x, inertia = rod(1, l, x))]
    crank: Body,
    #[body(mass = 2, com = l * x, inertia = rod(2, 2 * l, x))]
    coupler: Body,
    #[body(mass = 1, com = l / 2 * x, inertia = rod(1, l, x))]
    rocker: Body,
    #[joint(ground -> crank, about = z)]
    first: Pin,
    #[joint(crank.at(l * x) -> coupler, about = z)]
    second: Pin,
    #[joint(ground.at(2 * l * x) -> rocker, about = z)]
    third: Pin,
    #[joint(rocker.at(l * x) -> coupler.at(2 * l * x), about = z)]
    closing: Pin,
}

fn sample_mechanism_of_all_charts() -> MechanismOfAllCharts<f64> {
    MechanismOfAllCharts { g: 9.7, m: 1.3, l: 0.4, k: 20.0 }
}

/// Whether two numbers have the same bits; all NaNs count as equal.
fn has_same_bits<T: Real>(a: T, b: T) -> bool {
    a == b && a.is_sign_negative() == b.is_sign_negative() || (is_nan(a) && is_nan(b))
}

fn is_nan<T: Real>(x: T) -> bool {
    x.partial_cmp(&x).is_none()
}

fn assert_lanes_equal_states<T: Real, const R: usize, const C: usize, const L: usize>(
    what: &str,
    wide: &SMatrix<Lanes<T, L>, R, C>,
    one: impl Fn(usize) -> SMatrix<T, R, C>,
) {
    assert_lanes_near_states(what, 0.0, wide, one);
}

/// Checks that each lane equals the result of its state up to `rounding`, relative to the largest entry. With
/// `rounding = 0` the bits must be equal.
fn assert_lanes_near_states<T: Real, const R: usize, const C: usize, const L: usize>(
    what: &str,
    rounding: f64,
    wide: &SMatrix<Lanes<T, L>, R, C>,
    one: impl Fn(usize) -> SMatrix<T, R, C>,
) {
    for k in 0..L {
        let one = one(k);
        let bound = linkwork::nalgebra::convert::<f64, T>(rounding) * (T::one() + one.amax());
        for (found, expected) in wide.iter().zip(one.iter()) {
            let (found, expected) = (found[k], *expected);
            let near = rounding > 0.0 && (found - expected).abs() <= bound;
            assert!(
                near || has_same_bits(found, expected),
                "{what}, lane {k} of {L}: {found}, not {expected}"
            );
        }
    }
}

fn scalar_as_matrix<T: Real>(x: T) -> SMatrix<T, 1, 1> {
    SMatrix::from_element(x)
}

/// `L` states of a mechanism, stored both as SIMD lanes and one by one.
struct LanesAndSingleStates<T, const N: usize, const L: usize> {
    wide: SVector<Lanes<T, L>, N>,
    each: [SVector<T, N>; L],
}

impl<T: Real, const N: usize, const L: usize> LanesAndSingleStates<T, N, L> {
    fn new(each: [SVector<T, N>; L]) -> Self {
        Self { wide: SVector::from_fn(|i, _| Lanes::from_fn(|k| each[k][i])), each }
    }

    fn random_states(random: &mut Random, bound: f64) -> Self {
        Self::new(core::array::from_fn(|_| random.random_vector::<N>(bound).map(linkwork::nalgebra::convert)))
    }

    /// Returns random displacements of a configuration with magnitudes from 0 to 3.
    fn random_displacements(random: &mut Random) -> Self {
        let sizes = [2.0, 1e-9, 0.1, 1e-3, 0.5, 3.0, 0.0, 1e-6];
        Self::new(core::array::from_fn(|k| {
            (random.random_vector::<N>(1.0) * sizes[k % 8]).map(linkwork::nalgebra::convert)
        }))
    }
}

/// Checks all functions of the trait on lanes against single states. `columns` and `limbs` are the tolerances
/// where the single-state program itself uses SIMD lanes over columns of the mass matrix or over limbs, and
/// sums in another order.
fn check_all_functions<M, const NQ: usize, const NV: usize, const NU: usize, const L: usize>(
    m: &M,
    [columns, limbs]: [f64; 2],
) where
    M: Batch<NQ, NV, NU>,
{
    let wide = m.lanes::<L>();
    let mut random = Random::new(17);
    for _ in 0..20 {
        let t: LanesAndSingleStates<M::Scalar, 1, L> = LanesAndSingleStates::random_states(&mut random, 2.0);
        let dv: LanesAndSingleStates<M::Scalar, NV, L> =
            LanesAndSingleStates::random_displacements(&mut random);
        let q0 = m.integrate(
            &m.neutral(),
            &LanesAndSingleStates::<M::Scalar, NV, 1>::random_states(&mut random, 2.0).each[0],
        );
        let q: LanesAndSingleStates<M::Scalar, NQ, L> =
            LanesAndSingleStates::new(core::array::from_fn(|k| m.integrate(&q0, &dv.each[k])));
        let v: LanesAndSingleStates<M::Scalar, NV, L> = LanesAndSingleStates::random_states(&mut random, 2.0);
        let a: LanesAndSingleStates<M::Scalar, NV, L> = LanesAndSingleStates::random_states(&mut random, 5.0);
        let u: LanesAndSingleStates<M::Scalar, NU, L> = LanesAndSingleStates::random_states(&mut random, 5.0);
        let single_state = |k: usize| (t.each[k][0], &q.each[k], &v.each[k]);
        let (t0, q0, v0) = (t.wide[0], &q.wide, &v.wide);
        let start = q.each[0].map(Lanes::splat);
        assert_lanes_equal_states("integrate", &wide.integrate(q0, &dv.wide), |k| {
            m.integrate(&q.each[k], &dv.each[k])
        });
        assert_lanes_equal_states("difference", &wide.difference(&start, q0), |k| {
            m.difference(&q.each[0], &q.each[k])
        });
        assert_lanes_equal_states("tangent_rate", &wide.tangent_rate(&dv.wide, v0), |k| {
            m.tangent_rate(&dv.each[k], &v.each[k])
        });
        assert_lanes_near_states("mass_matrix", columns, &wide.mass_matrix(t0, q0), |k| {
            m.mass_matrix(single_state(k).0, single_state(k).1)
        });
        assert_lanes_near_states("bias_forces", limbs, &wide.bias_forces(t0, q0, v0), |k| {
            m.bias_forces(single_state(k).0, single_state(k).1, single_state(k).2)
        });
        assert_lanes_near_states(
            "inverse_dynamics",
            limbs,
            &wide.inverse_dynamics(t0, q0, v0, &a.wide),
            |k| m.inverse_dynamics(single_state(k).0, single_state(k).1, single_state(k).2, &a.each[k]),
        );
        assert_lanes_near_states(
            "forward_dynamics",
            limbs,
            &wide.forward_dynamics(t0, q0, v0, &a.wide),
            |k| m.forward_dynamics(single_state(k).0, single_state(k).1, single_state(k).2, &a.each[k]),
        );
        assert_lanes_equal_states("generalized_forces", &wide.generalized_forces(t0, q0, v0, &u.wide), |k| {
            m.generalized_forces(single_state(k).0, single_state(k).1, single_state(k).2, &u.each[k])
        });
        assert_lanes_equal_states(
            "kinetic_energy",
            &scalar_as_matrix(wide.kinetic_energy(t0, q0, v0)),
            |k| scalar_as_matrix(m.kinetic_energy(single_state(k).0, single_state(k).1, single_state(k).2)),
        );
        assert_lanes_equal_states(
            "potential_energy",
            &scalar_as_matrix(wide.potential_energy(t0, q0)),
            |k| scalar_as_matrix(m.potential_energy(single_state(k).0, single_state(k).1)),
        );
        assert_lanes_equal_states("generalized_momentum", &wide.generalized_momentum(t0, q0, v0), |k| {
            m.generalized_momentum(single_state(k).0, single_state(k).1, single_state(k).2)
        });
        assert_lanes_equal_states("momentum_rate", &wide.momentum_rate(t0, q0, v0), |k| {
            m.momentum_rate(single_state(k).0, single_state(k).1, single_state(k).2)
        });
    }
    assert_lanes_equal_states(type_name::<M>(), &wide.neutral(), |_| m.neutral());
}

/// Tolerances of zero: lanes and single states must have equal bits.
const SAME: [f64; 2] = [0.0; 2];
/// Tolerance where columns of the mass matrix are lanes, which changes the order of sums.
const COLUMNS: [f64; 2] = [1e-13, 0.0];
/// Tolerance where identical limbs are lanes, which changes the order of sums.
const LIMBS: [f64; 2] = [1e-10; 2];

#[test]
fn batched_robots_equal_single_states() {
    check_all_functions::<_, 6, 6, 6, 1>(&Ur5, COLUMNS);
    check_all_functions::<_, 6, 6, 6, 3>(&Ur5, COLUMNS);
    check_all_functions::<_, 6, 6, 6, 4>(&Ur5, COLUMNS);
    check_all_functions::<_, 6, 6, 6, 8>(&Ur5, COLUMNS);
    check_all_functions::<_, 6, 6, 6, 16>(&Ur5, COLUMNS);
    check_all_functions::<_, _, _, _, 8>(&Kinova, COLUMNS);
    check_all_functions::<_, _, _, _, 8>(&Panda, COLUMNS);
    check_all_functions::<_, _, _, _, 2>(&Solo12, LIMBS);
    check_all_functions::<_, _, _, _, 4>(&Solo12, LIMBS);
    check_all_functions::<_, _, _, _, 8>(&Solo12, LIMBS);
    check_all_functions::<_, _, _, _, 4>(&Humanoid, LIMBS);
    check_all_functions::<_, _, _, _, 8>(&Humanoid, LIMBS);
}

#[test]
fn batched_single_precision_equals_single_states() {
    check_all_functions::<_, _, _, _, 8>(&SinglePanda, [1e-6, 0.0]);
    check_all_functions::<_, _, _, _, 16>(&SinglePanda, [1e-6, 0.0]);
}

#[test]
fn batched_configurations_of_every_kind_equal_single_states() {
    check_all_functions::<_, _, _, _, 4>(&sample_mechanism_of_all_charts(), SAME);
    check_all_functions::<_, _, _, _, 8>(&sample_mechanism_of_all_charts(), SAME);
    let single: MechanismOfAllCharts<f32> = MechanismOfAllCharts { g: 9.7, m: 1.3, l: 0.4, k: 20.0 };
    check_all_functions::<_, _, _, _, 8>(&single, SAME);
}

#[test]
fn batched_driven_mechanisms_equal_single_states() {
    check_all_functions::<_, _, _, _, 4>(&BeadOnRotatingHoop { radius: 0.4, spin: 5.0 }, SAME);
    check_all_functions::<_, _, _, _, 8>(&BeadOnRotatingHoop { radius: 0.4, spin: 5.0 }, SAME);
}

#[test]
fn batched_loops_equal_single_states() {
    let linkage = FourBar { g: 9.7, l: 0.4 };
    check_all_functions::<_, _, _, _, 4>(&linkage, SAME);
    check_all_functions::<_, _, _, _, 8>(&linkage, SAME);
    check_all_functions::<_, _, _, _, 8>(&linkage.prepare(), SAME);
    // One lane has dependent constraints, the other lanes have independent ones.
    let q: LanesAndSingleStates<f64, 3, 4> =
        LanesAndSingleStates::new([0.3, 0.0, -0.5, 1.1].map(|a| SVector::from([a, -a, a])));
    let [v, tau]: [LanesAndSingleStates<f64, 3, 4>; 2] =
        [(); 2].map(|()| LanesAndSingleStates::random_states(&mut Random::new(31), 1.0));
    assert_lanes_equal_states(
        "forward_dynamics",
        &linkage.forward_dynamics_lanes(&q.wide, &v.wide, &tau.wide),
        |k| linkage.forward_dynamics(&q.each[k], &v.each[k], &tau.each[k]),
    );
}

#[test]
fn large_angles_do_not_affect_neighbouring_lanes() {
    let q: LanesAndSingleStates<f64, 6, 8> = LanesAndSingleStates::new(core::array::from_fn(|k| {
        SVector::from_fn(|i, _| [0.3, 1e6, -2.0][(k + i) % 3])
    }));
    let found = Ur5.mass_matrix_lanes(&q.wide);
    assert_lanes_near_states("mass_matrix", COLUMNS[0], &found, |k| Ur5.mass_matrix(&q.each[k]));
}

#[test]
fn batched_optional_functions_equal_single_states() {
    let mut random = Random::new(23);
    let q: LanesAndSingleStates<f64, 8, 4> = LanesAndSingleStates::random_states(&mut random, 2.0);
    let [v, a]: [LanesAndSingleStates<f64, 8, 4>; 2] =
        [(); 2].map(|()| LanesAndSingleStates::random_states(&mut random, 2.0));
    let u: LanesAndSingleStates<f64, 8, 4> = LanesAndSingleStates::random_states(&mut random, 2.0);
    let (by_q, by_v) = Panda.inverse_dynamics_derivatives_lanes(&q.wide, &v.wide, &a.wide);
    let derivatives_of_state =
        |k: usize| Panda.inverse_dynamics_derivatives(&q.each[k], &v.each[k], &a.each[k]);
    assert_lanes_near_states("∂τ/∂q", 1e-12, &by_q, |k| derivatives_of_state(k).0);
    assert_lanes_near_states("∂τ/∂v", 1e-12, &by_v, |k| derivatives_of_state(k).1);
    let (state, input) = Panda.linearize_lanes(&q.wide, &v.wide, &u.wide);
    let linear_model_of_state = |k: usize| Panda.linearize(&q.each[k], &v.each[k], &u.each[k]);
    assert_lanes_equal_states("A", &state, |k| linear_model_of_state(k).0);
    assert_lanes_equal_states("B", &input, |k| linear_model_of_state(k).1);
    assert_lanes_equal_states("M⁻¹", &Panda.mass_matrix_inverse_lanes(&q.wide), |k| {
        Panda.mass_matrix_inverse(&q.each[k])
    });
    assert_lanes_equal_states("momentum matrix", &Panda.centroidal_momentum_matrix_lanes(&q.wide), |k| {
        Panda.centroidal_momentum_matrix(&q.each[k])
    });
    assert_lanes_equal_states("centre of mass", &Panda.center_of_mass_lanes(&q.wide), |k| {
        Panda.center_of_mass(&q.each[k])
    });
}

#[test]
fn batched_functions_of_large_mechanisms_call_each_other() {
    let (m, mut random) = (sample_mechanism_of_all_charts(), Random::new(29));
    let dv: LanesAndSingleStates<f64, 12, 4> = LanesAndSingleStates::random_states(&mut random, 2.0);
    let q: LanesAndSingleStates<f64, 14, 4> =
        LanesAndSingleStates::new(core::array::from_fn(|k| m.integrate(&m.neutral(), &dv.each[k])));
    let [v, tau]: [LanesAndSingleStates<f64, 12, 4>; 2] =
        [(); 2].map(|()| LanesAndSingleStates::random_states(&mut random, 2.0));
    let u: LanesAndSingleStates<f64, 1, 4> = LanesAndSingleStates::random_states(&mut random, 2.0);
    let (by_q, _, inverse) = m.forward_dynamics_derivatives_lanes(&q.wide, &v.wide, &tau.wide);
    let derivatives_of_state =
        |k: usize| m.forward_dynamics_derivatives(&q.each[k], &v.each[k], &tau.each[k]);
    assert_lanes_equal_states("∂v̇/∂q", &by_q, |k| derivatives_of_state(k).0);
    assert_lanes_equal_states("M⁻¹", &inverse, |k| derivatives_of_state(k).2);
    let (state, _) = m.linearize_lanes(&q.wide, &v.wide, &u.wide);
    assert_lanes_equal_states("A", &state, |k| m.linearize(&q.each[k], &v.each[k], &u.each[k]).0);
    assert_lanes_equal_states("offset", &m.offset_lanes(&q.wide), |k| m.offset(&q.each[k]));
    assert_lanes_equal_states("Jacobian", &m.offset_jacobian_lanes(&q.wide), |k| {
        m.offset_jacobian(&q.each[k])
    });
}

#[test]
fn batched_composed_derivatives_are_written_to_matrices() {
    let mut random = Random::new(37);
    let dv: LanesAndSingleStates<f64, 12, 4> = LanesAndSingleStates::random_states(&mut random, 2.0);
    let q: LanesAndSingleStates<f64, 15, 4> =
        LanesAndSingleStates::new(dv.each.map(|dv| Tail.integrate(&Tail.neutral(), &dv)));
    let [v, tau]: [LanesAndSingleStates<f64, 12, 4>; 2] =
        [(); 2].map(|()| LanesAndSingleStates::random_states(&mut random, 2.0));
    let mut into = [SMatrix::zeros(); 3];
    let [by_q, by_v, inverse] = &mut into;
    let a = Tail.forward_dynamics_derivatives_into_lanes(&q.wide, &v.wide, &tau.wide, by_q, by_v, inverse);
    assert_lanes_near_states("v̇", 1e-11, &a, |k| {
        Tail.forward_dynamics(&q.each[k], &v.each[k], &tau.each[k])
    });
    let derivatives_of_state =
        |k: usize| Tail.forward_dynamics_derivatives(&q.each[k], &v.each[k], &tau.each[k]);
    assert_lanes_near_states("∂v̇/∂q", 1e-11, &into[0], |k| derivatives_of_state(k).0);
    assert_lanes_near_states("∂v̇/∂v", 1e-11, &into[1], |k| derivatives_of_state(k).1);
    assert_lanes_near_states("M⁻¹", 1e-11, &into[2], |k| derivatives_of_state(k).2);
}

#[test]
fn lanewise_adapter_implements_the_mechanism_trait() {
    fn total_energy<M: Mechanism<NQ, NV, NU>, const NQ: usize, const NV: usize, const NU: usize>(
        m: &M,
        v: M::Scalar,
    ) -> M::Scalar {
        let t = v - v;
        m.kinetic_energy(t, &m.neutral(), &SVector::repeat(v)) + m.potential_energy(t, &m.neutral())
    }
    let found = total_energy(&at(&Ur5.lanes::<4>(), Lanes::splat(0.0)), Lanes([0.0, 1.0, 2.0, 3.0]));
    for k in 0..4 {
        assert!(has_same_bits(found[k], total_energy(&Ur5, k as f64)));
    }
}
