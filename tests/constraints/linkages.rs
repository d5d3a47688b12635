//! Linkages whose joints close loops.

use linkwork::prelude::*;

/// Andrews' squeezing mechanism: seven bodies, three loops, one degree of freedom. Hairer and Wanner, *Solving Ordinary
/// Differential Equations II* (1996), § VI.9; the parameters are those of the Test Set for IVP Solvers (Mazzia and
/// Magherini, problem `andrews`). Angles β, Θ, γ, Φ, δ, Ω, ε.
#[mechanism]
struct AndrewsSqueezer {
    #[body(mass = 0.04325, com = 92e-5 * x, inertia = diagonal(1.097e-6, 1.097e-6, 2.194e-6))]
    k1: Body,
    #[body(mass = 0.00365, com = -115e-4 * x, inertia = diagonal(2.205e-7, 2.205e-7, 4.410e-7))]
    k2: Body,
    #[body(mass = 0.02373, com = 1043e-5 * x - 1874e-5 * y, inertia = diagonal(2.6275e-6, 2.6275e-6, 5.255e-6))]
    k3: Body,
    #[body(mass = 0.00706, com = -(2e-2 - 1421e-5) * y, inertia = diagonal(2.8335e-7, 2.8335e-7, 5.667e-7))]
    k4: Body,
    #[body(mass = 0.07050, com = 2308e-5 * x + 916e-5 * y, inertia = diagonal(5.845e-6, 5.845e-6, 1.169e-5))]
    k5: Body,
    #[body(mass = 0.00706, com = (2e-2 - 1421e-5) * x, inertia = diagonal(2.8335e-7, 2.8335e-7, 5.667e-7))]
    k6: Body,
    #[body(mass = 0.05498, com = -449e-5 * x - 1228e-5 * y, inertia = diagonal(9.56e-6, 9.56e-6, 1.912e-5))]
    k7: Body,

    #[joint(ground -> k1, about = z)]
    beta: Pin,
    #[joint(k1.at(7e-3 * x) -> k2, about = z)]
    theta: Pin,
    #[joint(ground.at(-0.03635 * x + 0.03273 * y) -> k3, about = z)]
    gamma: Pin,
    #[joint(k5.at(4e-2 * x) -> k4, about = z)]
    phi: Pin,
    #[joint(ground.at(-0.06934 * x - 0.00227 * y) -> k5, about = z)]
    delta: Pin,
    #[joint(k7.at(-4e-2 * y) -> k6, about = z)]
    omega_: Pin,
    #[joint(ground.at(-0.06934 * x - 0.00227 * y) -> k7, about = z)]
    epsilon: Pin,
    #[joint(k2.at(-28e-3 * x) -> k3.at(-35e-3 * y), about = z)]
    e3: Pin,
    #[joint(k2.at(-28e-3 * x) -> k4.at(-2e-2 * y), about = z)]
    e4: Pin,
    #[joint(k2.at(-28e-3 * x) -> k6.at(2e-2 * x), about = z)]
    e6: Pin,

    #[acts(on = beta, value = 0.033)]
    motor: Torque,
    #[acts(between = (ground.at(0.014 * x + 0.072 * y), k3.at(2e-2 * x - 18e-3 * y)), stiffness = 4530, free_length = 7785e-5)]
    spring: Spring,
}

const START: [f64; 7] = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_38,
    0.222_668_390_165_885_88,
    0.487_364_979_543_842_55,
    -0.222_668_390_165_885_88,
    1.230_547_444_549_821_2,
];

/// At t = 0.03 s, recomputed with an extrapolation method in 160-bit arithmetic; the published digits are good to 1e-10.
const END: [f64; 7] = [
    15.810_771_195_153_707,
    -15.756_371_058_411_84,
    0.040_822_240_119_645_8,
    -0.534_730_116_342_079_6,
    0.524_409_965_879_954_1,
    0.534_730_116_342_079_6,
    1.048_080_741_041_938,
];

#[test]
fn andrews_squeezer_starts_with_the_published_accelerations() {
    let squeezer = AndrewsSqueezer {};
    assert_eq!(AndrewsSqueezer::NC, 6);
    let (q, zero) = (SVector::from(START), SVector::zeros());
    assert!(squeezer.constraint_residuals(&q).amax() < 1e-15);
    let (a, _) = squeezer.constrained_dynamics(&q, &zero, &zero);
    assert!((a[0] - 14_222.443_919_954_138).abs() < 1e-7, "{a}");
    assert!((a[1] + 10_666.832_939_965_585).abs() < 1e-7, "{a}");
    assert!(a.rows(2, 5).amax() < 1e-7, "{a}");
}

#[test]
fn andrews_squeezer_ends_where_published() -> Result<(), Error> {
    let squeezer = AndrewsSqueezer {};
    let method = DormandPrince::new().tolerance(1e-12, 1e-12);
    let end = simulate(&squeezer).from(START, [0.0; 7]).method(method).duration(0.03).finish()?;
    for (found, expected) in end.q.iter().zip(END) {
        assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
    }
    assert!(squeezer.constraint_residuals(&end.q).amax() < 1e-14);
    Ok(())
}

/// Half of a car's axis on a bumpy road: two masses on springs, a massless bar between them, and a condition that is
/// driven in time. Test Set for IVP Solvers (Mazzia and Magherini), problem `caraxis`.
#[mechanism(gravity = -1 * y)]
struct CarAxis {
    xl: Coordinate,
    yl: Coordinate,
    xr: Coordinate,
    yr: Coordinate,
    #[particle(mass = 5e-4, at = xl * x + yl * y)]
    left: Particle,
    #[particle(mass = 5e-4, at = xr * x + yr * y)]
    right: Particle,
    #[define(0.1 * sin(10 * t))]
    bump: Scalar,
    #[point(at = sqrt(1 - bump * bump) * x + bump * y)]
    wheel: Point,
    #[acts(between = (ground, left), stiffness = 1, free_length = 0.5)]
    left_spring: Spring,
    #[acts(between = (wheel, right), stiffness = 1, free_length = 0.5)]
    right_spring: Spring,
    #[constraint(dot(r(wheel / ground), r(left / ground)) = 0)]
    upright: Holonomic,
    #[constraint(norm(r(right / left)) = 1)]
    bar: Holonomic,
}

/// At t = 3 s, recomputed at 160 and at 230 bits; the published digits are good to 2e-13 and 5e-12.
#[test]
fn car_axis_ends_where_published() -> Result<(), Error> {
    let method = DormandPrince::new().tolerance(1e-12, 1e-12);
    let start = ([0.0, 0.5, 1.0, 0.5], [-0.5, 0.0, -0.5, 0.0]);
    let end = simulate(&CarAxis {}).from(start.0, start.1).method(method).duration(3.0).finish()?;
    let q =
        [0.049_345_578_427_524_09, 0.496_989_460_230_008_1, 1.041_742_524_885_426_1, 0.373_911_027_265_365_8];
    let v = [
        -0.077_058_368_403_592_08,
        0.007_446_866_592_068_416,
        0.017_556_815_753_541_737,
        0.770_341_043_779_601_1,
    ];
    for k in 0..4 {
        assert!((end.q[k] - q[k]).abs() < 1e-9, "{} for {}", end.q[k], q[k]);
        assert!((end.v[k] - v[k]).abs() < 1e-8, "{} for {}", end.v[k], v[k]);
    }
    let (_, lambda) = CarAxis {}.constrained_dynamics(3.0, &end.q, &end.v, &SVector::zeros());
    assert!((lambda[0].abs() - 0.004_736_890_853_327).abs() < 1e-5);
    Ok(())
}

/// Two windows of the mechanism with N windows: rods of 1 m and 1 kg, all verticals upright at the start. IFToMM library
/// of computational benchmark problems, A02.
#[mechanism(gravity = -9.81 * y)]
struct TwoWindows {
    #[body(mass = 1, com = 0.5 * y, inertia = rod(1, 1, y))]
    left: Body,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    first: Body,
    #[body(mass = 1, com = 0.5 * y, inertia = rod(1, 1, y))]
    middle: Body,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    second: Body,
    #[body(mass = 1, com = 0.5 * y, inertia = rod(1, 1, y))]
    right: Body,
    #[joint(ground -> left, about = z)]
    b0: Pin,
    #[joint(left.at(y) -> first, about = z)]
    t0: Pin,
    #[joint(ground.at(x) -> middle, about = z)]
    b1: Pin,
    #[joint(middle.at(y) -> second, about = z)]
    t1: Pin,
    #[joint(ground.at(2 * x) -> right, about = z)]
    b2: Pin,
    #[joint(first.at(x) -> middle.at(y), about = z)]
    close1: Pin,
    #[joint(second.at(x) -> right.at(y), about = z)]
    close2: Pin,
}

/// Where all links are on one line the constraints lose rank and other motions branch off, twice in each turn. The
/// motion on the parallelogram's branch is that of a pendulum: `(N + (N + 1)/3) θ̈ = (N + (N + 1)/2) g sin θ`.
#[test]
fn windows_go_through_their_singular_positions() -> Result<(), Error> {
    let windows = TwoWindows {};
    assert_eq!((TwoWindows::NV, TwoWindows::NC), (5, 4));
    let method = DormandPrince::new().tolerance(1e-11, 1e-11);
    // Angles are counted against the clock; the couplers keep their direction.
    let run = simulate(&windows)
        .from([0.0; 5], [-1.0, 1.0, -1.0, 1.0, -1.0])
        .method(method)
        .duration(10.0)
        .finish()?;
    let top = (-run.q[0].sin(), run.q[0].cos());
    assert!((top.0 - 0.328_458_111_540_815).abs() < 1e-6, "{top:?}");
    assert!((top.1 - 0.944_518_538_078_601).abs() < 1e-6, "{top:?}");
    assert!(windows.constraint_residuals(&run.q).amax() < 1e-10);
    Ok(())
}

/// States that do not fulfil the constraints are refused, and what cannot be assembled says why.
#[test]
fn states_off_the_constraints_are_errors() {
    let squeezer = AndrewsSqueezer {};
    let mut q = SVector::from(START);
    q[2] += 0.01;
    let run = simulate(&squeezer).from(q, [0.0; 7]).duration(0.001).finish();
    assert!(matches!(run, Err(Error::OffConstraints { .. } | Error::Constraint { .. })), "{run:?}");
    // From there it is assembled, the crank where it is.
    let found = squeezer.assemble(&q, &[0]).expect("it is close");
    assert!((found[0] - q[0]).abs() < 1e-15 && squeezer.constraint_residuals(&found).amax() < 1e-14);
    // With all angles but one held it cannot be.
    let held = squeezer.assemble(&q, &[0, 1, 2, 3, 4, 5]);
    assert!(
        matches!(held, Err(ConstraintError::Configuration { constraint, .. }) if constraint.starts_with('e')),
        "{held:?}"
    );
    let lost = squeezer.assemble(&SVector::repeat(f64::NAN), &[]);
    assert_eq!(lost, Err(ConstraintError::NotFinite));
}
