//! Generated functions and integrators never allocate memory on the heap.
#![expect(unsafe_code, reason = "a global allocator is unsafe to implement")]

use linkwork::batch::{Rollout, unwatched};
use linkwork::integrate::{EventDriven, ImplicitMidpoint, Rk4, Rosenbrock, SemiImplicitEuler, TimeStepping};
use linkwork::nalgebra::SVector;
use linkwork::simulate::Crossing;
use linkwork::{Batch, Constrained, Mechanism, contact, discrete, frame, mechanism, simulate};
use linkwork_models::{Bicycle, BricardLinkage, FourBar};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;
use support::mechanisms::*;
use support::random::Random;
use support::robots::*;

/// Allocator of the system that counts the calls of each thread.
struct CountingAllocator;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

fn count_heap_call() {
    // During the destruction of a thread the counter no longer exists.
    let _ = COUNT.try_with(|count| count.set(count.get() + 1));
}

// SAFETY: every call is passed to the system's allocator unchanged.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count_heap_call();
        // SAFETY: the caller guarantees the conditions of the allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count_heap_call();
        // SAFETY: the caller guarantees the conditions of the allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Returns the number of heap allocations and deallocations while `f` runs.
fn heap_calls<T>(f: impl FnOnce() -> T) -> usize {
    let before = COUNT.get();
    black_box(f());
    COUNT.get() - before
}

#[test]
fn heap_allocations_are_detected() {
    assert_eq!(heap_calls(|| drop(black_box(vec![1]))), 2);
    assert_eq!(heap_calls(|| black_box([1])), 0);
}

/// Checks that no function of the trait `Mechanism` and no integrator allocates memory.
fn check_all_functions<M, const NQ: usize, const NV: usize, const NU: usize>(m: &M)
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let mut random = Random::new(11);
    let q = &random.random_configuration(m);
    let [v, a, dv] = [1.0, 1.0, 0.1].map(|bound| random.random_vector(bound));
    let (v, a, dv): (&SVector<f64, NV>, &SVector<f64, NV>, &SVector<f64, NV>) = (&v, &a, &dv);
    let u = &random.random_vector(1.0);

    assert_eq!(heap_calls(|| m.neutral()), 0, "neutral");
    assert_eq!(heap_calls(|| m.integrate(q, dv)), 0, "integrate");
    assert_eq!(heap_calls(|| m.tangent_rate(dv, v)), 0, "tangent_rate");
    assert_eq!(heap_calls(|| m.mass_matrix(0.0, q)), 0, "mass_matrix");
    assert_eq!(heap_calls(|| m.bias_forces(0.0, q, v)), 0, "bias_forces");
    assert_eq!(heap_calls(|| m.inverse_dynamics(0.0, q, v, a)), 0, "inverse_dynamics");
    assert_eq!(heap_calls(|| m.forward_dynamics(0.0, q, v, a)), 0, "forward_dynamics");
    assert_eq!(heap_calls(|| m.generalized_forces(0.0, q, v, u)), 0, "generalized_forces");
    assert_eq!(heap_calls(|| m.kinetic_energy(0.0, q, v)), 0, "kinetic_energy");
    assert_eq!(heap_calls(|| m.potential_energy(0.0, q)), 0, "potential_energy");
    assert_eq!(heap_calls(|| m.generalized_momentum(0.0, q, v)), 0, "generalized_momentum");
    assert_eq!(heap_calls(|| m.momentum_rate(0.0, q, v)), 0, "momentum_rate");
    assert_eq!(heap_calls(|| m.difference(q, &m.integrate(q, dv))), 0, "difference");

    let simulate_briefly = || simulate(m).from(*q, *v).duration(0.01);
    assert_eq!(heap_calls(|| simulate_briefly().finish()), 0, "DormandPrince");
    assert_eq!(heap_calls(|| simulate_briefly().method(Rk4::step(2e-3)).finish()), 0, "Rk4");
    assert_eq!(
        heap_calls(|| simulate_briefly().method(ImplicitMidpoint::step(2e-3)).finish()),
        0,
        "ImplicitMidpoint"
    );
    assert_eq!(
        heap_calls(|| simulate_briefly().method(SemiImplicitEuler::step(2e-3)).finish()),
        0,
        "SemiImplicitEuler"
    );
    assert_eq!(heap_calls(|| simulate_briefly().method(Rosenbrock::step(2e-3)).finish()), 0, "Rosenbrock");
    let simulate_with_control = || {
        simulate_briefly()
            .control_every(5e-3, |_, _, _| *u)
            .sample_every(3e-3)
            .event(Crossing::Either, |t, _, _| t - 4e-3)
    };
    assert_eq!(heap_calls(|| simulate_with_control().count()), 0, "control, samples and events");
}

/// Checks that kinematic functions outside the trait `Mechanism` allocate no memory.
macro_rules! check_kinematics {
    ($mechanism:expr, $type:ident, $frame:literal) => {
        let m = $mechanism;
        let frame = frame!($type, $frame);
        let q = &Random::new(12).random_configuration(&m);
        let (v, a) = (&Random::new(13).random_vector(1.0), &Random::new(14).random_vector(1.0));
        let u = &Random::new(15).random_vector(1.0);
        assert_eq!(heap_calls(|| m.dissipated_power(q, v)), 0, "dissipated_power");
        assert_eq!(heap_calls(|| m.control_power(q, v, u)), 0, "control_power");
        assert_eq!(heap_calls(|| m.disturbance_power(q, v)), 0, "disturbance_power");
        assert_eq!(heap_calls(|| m.center_of_mass(q)), 0, "center_of_mass");
        assert_eq!(heap_calls(|| m.total_mass()), 0, "total_mass");
        assert_eq!(heap_calls(|| m.momentum(q, v)), 0, "momentum");
        assert_eq!(heap_calls(|| m.frame_placements(q)), 0, "frame_placements");
        assert_eq!(heap_calls(|| m.frame_placement(frame, q)), 0, "frame_placement");
        assert_eq!(heap_calls(|| m.frame_velocity(frame, q, v)), 0, "frame_velocity");
        assert_eq!(heap_calls(|| m.frame_acceleration(frame, q, v, a)), 0, "frame_acceleration");
        assert_eq!(heap_calls(|| m.frame_jacobian(frame, q)), 0, "frame_jacobian");
    };
}

#[test]
fn generated_functions_do_not_allocate() {
    check_all_functions(&CartPole);
    check_all_functions(&Kinova);
    check_all_functions(&Panda);
    check_all_functions(&PandaMimic);
    check_all_functions(&Solo12);
    check_all_functions(&Humanoid);
    check_all_functions(&sample_coordinate_force_mechanism());
    check_all_functions(&Spacecraft {});
    check_all_functions(&OnScrew {});
    check_all_functions(&OnUniversal {});
    check_all_functions(&OnPlanar {});
    check_all_functions(&OnFree {});
    check_kinematics!(Panda, Panda, "panda_hand_tcp");
    check_kinematics!(Solo12, Solo12, "HR_FOOT");
    check_kinematics!(Humanoid, Humanoid, "r_wrist");
    check_kinematics!(sample_coordinate_force_mechanism(), CoordinateForceMechanism, "tip");
    check_kinematics!(Spacecraft {}, Spacecraft, "weight");
}

/// Panda robot arm with generated derivatives of the dynamics.
#[mechanism(urdf = "../models/urdf/panda.urdf", mimic = independent, derivatives)]
struct PandaWithDerivatives;

#[test]
fn derivatives_do_not_allocate() {
    let m = PandaWithDerivatives;
    let q = &Random::new(15).random_configuration(&m);
    let (v, a, u) = (
        &Random::new(16).random_vector(1.0),
        &Random::new(17).random_vector(1.0),
        &Random::new(18).random_vector(1.0),
    );
    assert_eq!(heap_calls(|| m.inverse_dynamics_derivatives(q, v, a)), 0, "inverse_dynamics_derivatives");
    assert_eq!(heap_calls(|| m.forward_dynamics_derivatives(q, v, a)), 0, "forward_dynamics_derivatives");
    assert_eq!(heap_calls(|| m.mass_matrix_inverse(q)), 0, "mass_matrix_inverse");
    assert_eq!(heap_calls(|| m.coriolis_matrix(q, v)), 0, "coriolis_matrix");
    assert_eq!(heap_calls(|| m.linearize(q, v, u)), 0, "linearize");
}

/// Solo12 quadruped robot with generated functions of several states.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, batch)]
struct Solo12InLanes;

#[test]
fn batches_do_not_allocate() {
    const COUNT: usize = 13;
    let (m, mut random) = (Solo12InLanes, Random::new(19));
    let mut q = [0.0; 19 * COUNT];
    for k in 0..COUNT {
        let state = random.random_configuration(&m);
        (0..19).for_each(|i| q[i * COUNT + k] = state[i]);
    }
    let mut v = [0.1; 18 * COUNT];
    let (mut tau, lanes) = ([0.0; 18 * COUNT], m.lanes::<8>());
    let evaluate_inverse_dynamics_of_arrays =
        || lanes.inverse_dynamics_all(0.0, &q, &v, &v, &mut tau).is_ok();
    assert_eq!(heap_calls(evaluate_inverse_dynamics_of_arrays), 0, "inverse_dynamics_all");
    let rollout = Rollout::new(Rk4::step(1e-3), 3);
    let zero_inputs = |_, _, _: &_, _: &_| SVector::zeros();
    let run_rollout = || assert_eq!(lanes.roll_out(&rollout, &mut q, &mut v, zero_inputs, unwatched), Ok(()));
    assert_eq!(heap_calls(run_rollout), 0, "roll_out");
}

/// Arm with parameters and all other options of generated functions.
#[mechanism(gravity = -g * z, prepare, centroidal, regressor, sensitivities, packed)]
struct Arm {
    g: f64,
    m: f64,
    l: f64,
    #[body(mass = m, com = l / 2 * x, inertia = cuboid(m, l, l / 4, l / 5))]
    upper: Body,
    #[body(mass = m, com = l / 2 * x, inertia = cuboid(m, l, l / 4, l / 5))]
    lower: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(l * x).rotated(x(pi / 2)) -> lower, about = z)]
    elbow: Pin,
}

#[test]
fn optional_functions_do_not_allocate() {
    let m = Arm { g: 9.81, m: 0.7, l: 0.4 };
    assert_eq!(heap_calls(|| m.prepare()), 0, "prepare");
    check_all_functions(&m.prepare());
    let q = &Random::new(20).random_configuration(&m);
    let (v, a) = (&Random::new(21).random_vector(1.0), &Random::new(22).random_vector(1.0));
    let standard = m.standard_parameters();
    assert_eq!(heap_calls(|| m.standard_parameters()), 0, "standard_parameters");
    assert_eq!(heap_calls(|| m.base_parameters(&standard)), 0, "base_parameters");
    assert_eq!(heap_calls(|| m.joint_torque_regressor(q, v, a)), 0, "joint_torque_regressor");
    assert_eq!(heap_calls(|| m.base_regressor(q, v, a)), 0, "base_regressor");
    assert_eq!(heap_calls(|| m.centroidal_momentum_matrix(q)), 0, "centroidal_momentum_matrix");
    assert_eq!(heap_calls(|| m.centroidal_momentum_bias(q, v)), 0, "centroidal_momentum_bias");
    assert_eq!(heap_calls(|| m.inverse_dynamics_by_parameters(q, v, a)), 0, "inverse_dynamics_by_parameters");
    assert_eq!(heap_calls(|| m.forward_dynamics_by_parameters(q, v, a)), 0, "forward_dynamics_by_parameters");
    assert_eq!(heap_calls(|| m.mass_matrix_packed(q)), 0, "mass_matrix_packed");
    let mut kept = Default::default();
    assert_eq!(heap_calls(|| m.mass_matrix_into(q, &mut kept)), 0, "mass_matrix_into");
}

/// Checks that no function of the trait `Constrained` allocates memory, at a state that satisfies the
/// constraints.
fn check_constrained<M, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>(
    m: &M,
    near: &SVector<f64, NQ>,
) where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64> + Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let mut random = Random::new(20);
    let (any, tau): (SVector<f64, NV>, SVector<f64, NV>) =
        (random.random_vector(1.0), random.random_vector(1.0));
    assert_eq!(heap_calls(|| m.assemble(0.0, near, &[0])), 0, "assemble");
    let q = &m.assemble(0.0, near, &[]).expect("a configuration is near");
    assert_eq!(heap_calls(|| m.project_velocity(0.0, q, &any)), 0, "project_velocity");
    assert_eq!(heap_calls(|| m.complete_velocity(0.0, q, &any, &[0])), 0, "complete_velocity");
    let v = &m.project_velocity(0.0, q, &any).expect("a velocity is near");
    assert_eq!(heap_calls(|| m.constraint_residuals(0.0, q)), 0, "constraint_residuals");
    assert_eq!(heap_calls(|| m.constraint_rates(0.0, q, v)), 0, "constraint_rates");
    assert_eq!(heap_calls(|| m.constraint_jacobian(0.0, q)), 0, "constraint_jacobian");
    assert_eq!(heap_calls(|| m.constraint_bias(0.0, q, v)), 0, "constraint_bias");
    assert_eq!(heap_calls(|| m.constrained_dynamics(0.0, q, v, &tau)), 0, "constrained_dynamics");
    assert_eq!(heap_calls(|| m.project_state(0.0, near, v)), 0, "project_state");
    let simulate_briefly = || assert!(simulate(m).from(*q, *v).duration(0.01).finish().is_ok());
    assert_eq!(heap_calls(simulate_briefly), 0, "simulate");
}

/// Constrained mechanisms: a loop, a loop with a redundant condition, and two rolling wheels.
#[test]
fn constrained_mechanisms_do_not_allocate() {
    let four_bar = FourBar { g: 9.81, density: 0.8, a: 0.3, b: 0.9, c: 0.7, d: 0.8 };
    check_constrained(&four_bar, &[0.7, 0.2, 1.8].into());
    let ring = BricardLinkage { g: 9.81, mass: 1.0, length: 1.0 };
    check_constrained(&ring, &[0.3, -0.23, 0.3, -0.23, 0.3].into());
    let bicycle = Bicycle::BENCHMARK;
    check_constrained(&bicycle, &bicycle.neutral());
    let (q, v) = (bicycle.neutral(), SVector::zeros());
    let linearize_bicycle = || assert!(bicycle.linearize(&q, &v, &SVector::zeros(), &[3, 7]).is_ok());
    assert_eq!(heap_calls(linearize_bicycle), 0, "linearize");
}

/// Box that falls on its face and slides.
#[mechanism(gravity = -9.81 * z, derivatives, sensitivities)]
struct Crate {
    friction: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    hull: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[contact(hull.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = friction, restitution = 0.2)]
    floor: Contact,
}

#[test]
fn contacts_do_not_allocate() {
    let m = Crate { friction: 0.3 };
    let (q, v) = ([0.0, 0.0, 0.055, 0.0, 0.0, 0.0, 1.0], [1.0, 0.0, -0.5, 0.0, 0.0, 0.0]);
    let simulate_contacts = || simulate(&m).from(q, v).duration(0.1);
    let (at, rates) = (SVector::from(q), SVector::from(v));
    assert_eq!(
        heap_calls(|| simulate_contacts().method(TimeStepping::step(1e-3)).finish().unwrap()),
        0,
        "time stepping"
    );
    assert_eq!(
        heap_calls(|| simulate_contacts().method(EventDriven::new()).finish().unwrap()),
        0,
        "event by event"
    );
    let (u, step) = (SVector::zeros(), TimeStepping::step(0.02));
    let transition_at_state = || discrete::transition(&m, &step, 0.0, &at, &rates, &u).unwrap();
    assert!(transition_at_state().v[2].abs() < 0.2 && heap_calls(transition_at_state) == 0, "transition");
    let evaluate_step_parameter_derivatives =
        || discrete::by_parameters(&m, &step, 0.0, &at, &rates, &u).is_ok();
    assert!(
        evaluate_step_parameter_derivatives() && heap_calls(evaluate_step_parameter_derivatives) == 0,
        "by_parameters"
    );
    assert_eq!(heap_calls(|| contact::impact(&m, 0.0, &at, &rates)), 0, "impact");
    assert_eq!(heap_calls(|| contact::forces(&m, 0.0, &at, &rates, &SVector::zeros(), 1e-3)), 0, "forces");
}
