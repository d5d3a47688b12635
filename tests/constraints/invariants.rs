//! Properties that hold in every state of every constrained mechanism.

use linkwork::prelude::*;
use linkwork_models::*;
use support::random::Random;

/// Checks that accelerations and multipliers satisfy the constraints and the equations of motion, and that
/// projections satisfy the constraints.
fn check_constrained_dynamics<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    guess: &SVector<f64, NQ>,
) where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64> + Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let mut random = Random::new(41);
    for _ in 0..5 {
        let near = Mechanism::integrate(m, guess, &random.random_vector(0.05));
        let q = m.assemble(0.0, &near, &[]).expect("a configuration is near");
        assert!(m.constraint_residuals(0.0, &q).amax() < 1e-13);
        let v = m.project_velocity(0.0, &q, &random.random_vector(1.0)).expect("a velocity is near");
        assert!(m.constraint_rates(0.0, &q, &v).amax() < 1e-12);
        let again = m.project_velocity(0.0, &q, &v).expect("it is one already");
        assert!((again - v).amax() < 1e-11 * v.amax().max(1.0));
        check_completed_velocities(m, &q, &v, &mut random);

        let tau = random.random_vector(1.0);
        let (a, lambda) = m.constrained_dynamics(0.0, &q, &v, &tau);
        let j = m.constraint_jacobian(0.0, &q);
        let scale = a.amax().max(1.0);
        assert!((j * a + m.constraint_bias(0.0, &q, &v)).amax() < 1e-9 * scale);
        let missing = Mechanism::inverse_dynamics(m, 0.0, &q, &v, &a) - tau - j.transpose() * lambda;
        assert!(missing.amax() < 1e-9 * scale.max(lambda.amax()), "{missing}");
        // The constraints do no work: the power of the forces is the rate of the energy.
        let (before, after) = (energy_after(m, &q, &v, &a, -1e-5), energy_after(m, &q, &v, &a, 1e-5));
        let power = (after - before) / 2e-5;
        let energy = after.abs().max(1.0);
        assert!((power - tau.dot(&v)).abs() < 1e-5 * energy * scale, "{power} for {}", tau.dot(&v));
        check_constraint_rates_by_differences(m, &q, &v);
    }
}

/// Checks that completed velocities preserve the fixed components and satisfy the constraints, with the
/// minimum of kinetic energy in the change.
fn check_completed_velocities<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    random: &mut Random,
) where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64> + Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let wanted = random.random_vector(1.0);
    let all = m.complete_velocity(0.0, q, &wanted, &[]).expect("a velocity is near");
    let nearest = m.project_velocity(0.0, q, &wanted).expect("a velocity is near");
    assert!((all - nearest).amax() < 1e-9 * nearest.amax().max(1.0), "{all} for {nearest}");
    // Components of a velocity that satisfies the constraints never contradict them.
    let mut random_velocity_index = || ((random.uniform_number(1.0) + 1.0) / 2.0 * NV as f64) as usize;
    let pair = [random_velocity_index(), random_velocity_index()];
    for held in [&pair[..1], &pair[..]] {
        let mut start = wanted;
        held.iter().for_each(|k| start[*k] = v[*k]);
        let found = m.complete_velocity(0.0, q, &start, held).expect("they agree");
        assert!(held.iter().all(|k| found[*k] == v[*k]), "{held:?}");
        let size = found.amax().max(1.0);
        assert!(m.constraint_rates(0.0, q, &found).amax() < 1e-10 * size);
        // The change is orthogonal, in the metric of the mass matrix, to all admissible variations.
        let change = Mechanism::mass_matrix(m, 0.0, q) * (found - start);
        let mut other = random.random_vector(1.0);
        held.iter().for_each(|k| other[*k] = v[*k]);
        if held.len() > 1 {
            // Two fixed components may nearly depend on each other; the velocities that they determine are
            // then large.
            continue;
        }
        let besides = m.complete_velocity(0.0, q, &other, held).expect("they agree") - found;
        assert!(change.dot(&besides).abs() < 1e-8 * size * size, "{held:?}: {}", change.dot(&besides));
    }
    let outside = Err(ConstraintError::Held { index: NV, velocities: NV });
    assert_eq!(m.complete_velocity(0.0, q, v, &[0, NV]), outside);
    assert_eq!(m.assemble(0.0, q, &[0, NV]), outside.map(|_: SVector<f64, NV>| *q));
}

/// Returns the energy of a mechanism after a short time `h` along its motion.
fn energy_after<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    a: &SVector<f64, NV>,
    h: f64,
) -> f64
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let (q, v) = (m.integrate(q, &(v * h + a * (h * h / 2.0))), v + a * h);
    m.kinetic_energy(0.0, &q, &v) + m.potential_energy(0.0, &q)
}

/// Checks by finite differences that constraint velocities are the rates of the constraint residuals, and
/// that biases follow from the rates of the constraint velocities.
fn check_constraint_rates_by_differences<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
) where
    M: Constrained<NQ, NV, NU, NH, NC, Scalar = f64> + Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let h = 1e-5;
    let (before, after) = (Mechanism::integrate(m, q, &(v * -h)), Mechanism::integrate(m, q, &(v * h)));
    let residuals = (m.constraint_residuals(0.0, &after) - m.constraint_residuals(0.0, &before)) / (2.0 * h);
    let rates = m.constraint_rates(0.0, q, v);
    let biases = (m.constraint_rates(0.0, &after, v) - m.constraint_rates(0.0, &before, v)) / (2.0 * h);
    let bias = m.constraint_bias(0.0, q, v);
    let scale = v.norm_squared().max(1.0);
    for k in 0..NC {
        if k < NH {
            assert!((residuals[k] - rates[k]).abs() < 1e-7 * scale, "{}", M::CONSTRAINTS[k]);
        }
        assert!((biases[k] - bias[k]).abs() < 1e-6 * scale * scale, "{}", M::CONSTRAINTS[k]);
    }
}

#[test]
fn linkages_satisfy_constrained_dynamics() {
    let four_bar = FourBar { g: 9.81, density: 0.8, a: 0.3, b: 0.9, c: 0.7, d: 0.8 };
    check_constrained_dynamics(&four_bar, &[0.7, 0.2, 1.8].into());
    let crank = SliderCrank { g: 9.81, r: 0.04, l: 0.13, m_crank: 0.9, m_rod: 0.5, m_piston: 0.35 };
    check_constrained_dynamics(&crank, &[0.8, -1.0, 0.15].into());
    check_constrained_dynamics(
        &BricardLinkage { g: 9.81, mass: 1.0, length: 1.0 },
        &[0.3, -0.23, 0.3, -0.23, 0.3].into(),
    );
    check_constrained_dynamics(
        &TwoWindows { g: 9.81, mass: 1.0, length: 1.0 },
        &[0.4, -0.4, 0.4, -0.4, 0.4].into(),
    );
}

#[test]
fn platform_satisfies_constrained_dynamics() {
    let platform = StewartPlatform {
        g: 9.81,
        base_radius: 0.8,
        platform_radius: 0.5,
        platform_mass: 3.0,
        across: 0.15,
        axial: 0.25,
        leg_mass: 2.0,
        leg: 0.6,
    };
    let mut guess = platform.neutral();
    guess[2] = 0.9;
    for leg in 0..6 {
        guess[9 + 3 * leg] = 1.0;
    }
    check_constrained_dynamics(&platform, &guess);
}

#[test]
fn rolling_bodies_satisfy_constrained_dynamics() {
    let disk = RollingDisk { g: 9.81, m: 2.0, radius: 0.4 };
    check_constrained_dynamics(&disk, &[0.0, 0.0, 0.4, 0.5, 0.3, 0.7].into());
    let bowl = BallInBowl { g: 9.81, mass: 0.3, radius: 0.05, bowl: 0.45 };
    check_constrained_dynamics(&bowl, &[0.2, 0.1, -0.33, 0.5, 0.5, -0.5, 0.5].into());
    let tube = BallInTube { g: 9.81, mass: 0.3, radius: 0.05, tube: 0.45 };
    check_constrained_dynamics(&tube, &[0.2, -0.35, 0.1, 0.5, 0.5, -0.5, 0.5].into());
    let funnel = BallInFunnel { g: 9.81, mass: 0.3, radius: 0.05, half_angle: 0.6 };
    check_constrained_dynamics(&funnel, &[0.2, -0.35, 0.7, 0.5, 0.5, -0.5, 0.5].into());
    let dish = BallInDish { g: 9.81, mass: 0.3, radius: 0.05, curvature: 0.4 };
    check_constrained_dynamics(&dish, &[0.2, -0.1, 0.2, -0.1, 0.1, 0.5, 0.5, -0.5, 0.5].into());
    let cone = RollingCone { g: 9.81, mass: 0.3, height: 0.2, half_angle: 0.4, slope: 0.2 };
    check_constrained_dynamics(&cone, &[0.1, 0.2, -0.02, 0.0, (1.0_f64 - 0.49).sqrt(), 0.0, 0.7].into());
    check_constrained_dynamics(
        &Rattleback::BENCHMARK,
        &[0.0, 0.0, 0.02, 0.1, 0.1, 0.0, 0.98_f64.sqrt()].into(),
    );
    let mut upright = Bicycle::BENCHMARK.neutral();
    upright[3] = 0.1;
    upright[6] = (1.0_f64 - 0.01).sqrt();
    check_constrained_dynamics(&Bicycle::BENCHMARK, &upright);
}

/// States that violate the constraints are rejected, and an assembly that fails reports the constraint.
#[test]
fn states_violating_constraints_are_errors() {
    let squeezer = AndrewsSqueezer {};
    let mut q = SVector::from(AndrewsSqueezer::START);
    q[2] += 0.01;
    let run = simulate(&squeezer).from(q, [0.0; 7]).duration(0.001).finish();
    assert!(matches!(run, Err(Error::OffConstraints { .. } | Error::Constraint { .. })), "{run:?}");
    // The error states the coordinate with the largest correction, and its value.
    let bar = FourBar { g: 9.81, density: 1.0, a: 1.0, b: 2.0, c: 2.5, d: 3.0 };
    let closed = bar.assemble(&[0.8, 0.0, 2.0].into(), &[0]).expect("it is close");
    let open = closed + SVector::from([0.0, 0.01, 0.0]);
    let Err(error) = simulate(&bar).from(open, [0.0; 3]).duration(0.001).finish() else {
        panic!("it is open")
    };
    assert!(
        matches!(error, Error::OffConstraints { by, .. } if by.abs() > 1e-3 && by.abs() < 0.02),
        "{error:?}"
    );
    assert!(error.to_string().contains("violates the constraints, which change `"), "{error}");
    let Err(error) = simulate(&bar).from(closed, [1.0, 0.0, 0.0]).duration(0.001).finish() else {
        panic!("it would break")
    };
    assert!(matches!(error, Error::OffConstraints { by, .. } if by.abs() > 0.1), "{error:?}");
    // The linkage is assembled from there; the fixed crank does not move.
    let found = squeezer.assemble(&q, &[0]).expect("it is close");
    assert!((found[0] - q[0]).abs() < 1e-15 && squeezer.constraint_residuals(&found).amax() < 1e-14);
    // With only one free angle it cannot be assembled.
    let held = squeezer.assemble(&q, &[0, 1, 2, 3, 4, 5]);
    assert!(
        matches!(held, Err(ConstraintError::Configuration { constraint, .. }) if constraint.starts_with('e')),
        "{held:?}"
    );
    let lost = squeezer.assemble(&SVector::repeat(f64::NAN), &[]);
    assert_eq!(lost, Err(ConstraintError::NotFinite));
}

/// A four-bar linkage is assembled from any guess of its free coordinates if a solution exists.
#[test]
fn linkages_are_assembled_from_distant_guesses() {
    let linkage = FourBar { g: 9.81, density: 1.0, a: 0.2, b: 0.6, c: 0.5, d: 0.6 };
    for (i, j) in (0..8).flat_map(|i| (0..8).map(move |j| (i, j))) {
        let multiple_of_eighth_turn = |k: i32| f64::from(k) * std::f64::consts::FRAC_PI_4;
        let guess = SVector::from([0.6, multiple_of_eighth_turn(i), multiple_of_eighth_turn(j)]);
        let q = linkage.assemble(&guess, &[0]).expect("it closes at this angle of the crank");
        assert!(q[0] == 0.6 && linkage.constraint_residuals(&q).amax() < 1e-12, "{guess:?}: {q:?}");
    }
}

/// Bob on a circle with plane coordinates, for any scalar type.
#[mechanism(gravity = -9.81 * y)]
struct BobOnCircle<T: Real> {
    length: T,
    #[body(mass = 1)]
    bob: Body,
    #[joint(ground -> bob, along = (x, y))]
    place: Stage,
    #[constraint(norm(r(bob / ground)) = length)]
    rod: Holonomic,
}

/// Constraints must be satisfied to half of the digits, so that a wrong configuration is an error in single
/// precision, too.
#[test]
fn constraint_tolerance_suits_single_precision() {
    fn check_scalar_type<T: Real>(tolerance: T) {
        let one = T::one();
        let held = BobOnCircle { length: one };
        let near = SVector::from([one / (one + one), one]);
        let found = held.assemble(&near, &[]).expect("the circle is near");
        assert!((found.norm() - one).abs() < tolerance);
        // The fixed coordinate lies outside the circle.
        let beside = SVector::from([one + one + one, one]);
        let lost = held.assemble(&beside, &[0]);
        assert!(matches!(lost, Err(ConstraintError::Configuration { .. })), "{lost:?}");
        // The assembly moves only the free coordinate.
        let found = held.assemble(&SVector::from([T::zero(), one + one]), &[0]).expect("it is above");
        assert!((found[1] - one).abs() < tolerance && found[0] == T::zero());
    }
    check_scalar_type::<f64>(1e-14);
    check_scalar_type::<f32>(1e-6);
}

/// A completed velocity preserves the rate of the crank. At the dead centre the velocity of the piston cannot
/// be prescribed, that of the crank can.
#[test]
fn velocities_are_completed_from_prescribed_ones() {
    let engine = SliderCrank { g: 9.81, r: 0.04, l: 0.13, m_crank: 0.9, m_rod: 0.5, m_piston: 0.35 };
    let q = engine.assemble(&[0.8, -1.0, 0.1].into(), &[0]).expect("the crank goes round");
    let v = engine.complete_velocity(&q, &[100.0, 0.0, 0.0].into(), &[0]).expect("no dead centre");
    // Norton, Design of Machinery (2004), § 6.7: the rod rotates at ω₃ = −ω₂ (r cos θ) / (l cos φ).
    let turn = q[0] + q[1];
    let rod = -100.0 * 0.04 * q[0].cos() / (0.13 * turn.cos());
    let piston = -100.0 * 0.04 * q[0].sin() - rod * 0.13 * turn.sin();
    assert!(v[0] == 100.0 && (v[1] - (rod - 100.0)).abs() < 1e-12 && (v[2] - piston).abs() < 1e-13, "{v}");
    let both = engine.complete_velocity(&q, &[100.0, 0.0, piston + 0.1].into(), &[0, 2]);
    assert!(matches!(both, Err(ConstraintError::Velocity { .. })), "{both:?}");

    let dead = engine.assemble(&[0.0, 0.0, 0.17].into(), &[0]).expect("it is in line");
    let turned = engine.complete_velocity(&dead, &[100.0, 0.0, 0.0].into(), &[0]).expect("the piston rests");
    assert!((turned - SVector::from([100.0, -100.0 - 4.0 / 0.13, 0.0])).amax() < 1e-11, "{turned}");
    let pushed = engine.complete_velocity(&dead, &[0.0, 0.0, 1.0].into(), &[2]);
    assert!(matches!(pushed, Err(ConstraintError::Velocity { rate, .. }) if rate > 0.01), "{pushed:?}");
}
