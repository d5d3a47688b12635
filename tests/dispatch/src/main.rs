//! Checks that functions which select SIMD instructions at run time agree to rounding with functions that do
//! not, and bit by bit with the feature `reproducible`. Batched functions agree with those of single states,
//! and generated code contains no `unsafe`.
#![forbid(unsafe_code)]

/// Declares the same mechanisms for each of two compile options.
macro_rules! mechanisms {
    ($name:ident: $($option:tt)*) => {
        mod $name {
            use linkwork::prelude::*;

            /// Panda arm, whose inertial values are constants.
            #[mechanism(urdf = "../../models/urdf/panda.urdf", batch, derivatives, $($option)*)]
            pub struct Panda;

            /// Quadruped whose identical limbs are evaluated as SIMD lanes.
            #[mechanism(urdf = "../../models/urdf/solo12.urdf", base = free, batch, derivatives, $($option)*)]
            pub struct Solo12;

            /// Mechanism with parameters of any scalar type, and prepared values.
            #[mechanism(gravity = -g * y, batch, prepare, derivatives, $($option)*)]
            pub struct Machine<T> {
                pub g: T,
                pub m: T,
                pub l: T,
                #[body(mass = m, com = 0.3 * l * x, inertia = cuboid(m, l, 2 * l, 3 * l))]
                hull: Body,
                #[body(mass = 0.4 * m, com = 0.1 * y + 0.2 * z, inertia = cylinder(m, 0.3 * l, l, x))]
                ball: Body,
                #[body(mass = 0.3 * m, com = 0.05 * x, inertia = sphere(m, 0.2))]
                weight: Body,
                #[joint(ground -> hull)]
                pose: Free,
                #[joint(hull.at(l * x).rotated(z(0.4)) -> ball.at(0.1 * z))]
                socket: Ball,
                #[joint(hull.at(-l * y) -> weight, about = (x, y))]
                cross: Universal,
                #[acts(on = cross.first, coulomb = 0.3)]
                rubbing: Friction,
            }

            /// Chain with enough velocities that its derivatives are composed from results of other generated
            /// functions.
            #[mechanism(gravity = -9.81 * y, derivatives, $($option)*)]
            pub struct Chain {
                #[body(mass = 1.0, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                one: Body,
                #[joint(ground -> one, about = z)]
                pin_one: Pin,
                #[body(mass = 0.95, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                two: Body,
                #[joint(one.at(0.03 * x) -> two, about = y)]
                pin_two: Pin,
                #[body(mass = 0.9, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                three: Body,
                #[joint(two.at(0.03 * x) -> three, about = x)]
                pin_three: Pin,
                #[body(mass = 0.85, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                four: Body,
                #[joint(three.at(0.03 * x) -> four, about = z)]
                pin_four: Pin,
                #[body(mass = 0.8, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                five: Body,
                #[joint(four.at(0.03 * x) -> five, about = y)]
                pin_five: Pin,
                #[body(mass = 0.75, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                six: Body,
                #[joint(five.at(0.03 * x) -> six, about = x)]
                pin_six: Pin,
                #[body(mass = 0.7, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                seven: Body,
                #[joint(six.at(0.03 * x) -> seven, about = z)]
                pin_seven: Pin,
                #[body(mass = 0.65, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                eight: Body,
                #[joint(seven.at(0.03 * x) -> eight, about = y)]
                pin_eight: Pin,
                #[body(mass = 0.6, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                nine: Body,
                #[joint(eight.at(0.03 * x) -> nine, about = x)]
                pin_nine: Pin,
                #[body(mass = 0.55, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                ten: Body,
                #[joint(nine.at(0.03 * x) -> ten, about = z)]
                pin_ten: Pin,
                #[body(mass = 0.5, com = 0.01 * x, inertia = diagonal(1, 1.1, 1.2))]
                eleven: Body,
                #[joint(ten.at(0.03 * x) -> eleven, about = y)]
                pin_eleven: Pin,
                #[acts(on = pin_one)]
                motor: Torque,
            }
        }
    };
}

#[cfg(not(feature = "reproducible"))]
mechanisms!(detected: processor = detect);
#[cfg(not(feature = "reproducible"))]
mechanisms!(targeted: processor = target);
#[cfg(feature = "reproducible")]
mechanisms!(detected: processor = detect, arithmetic = reproducible);
#[cfg(feature = "reproducible")]
mechanisms!(targeted: processor = target, arithmetic = reproducible);

use linkwork::prelude::*;

/// Pseudo-random numbers in [-2, 2], and occasionally an angle beyond the range of the vectorised sine.
struct RandomNumbers(u64);

impl RandomNumbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let unit = (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
        if self.0.is_multiple_of(97) { 2e5 * unit } else { 4.0 * unit - 2.0 }
    }

    fn random_vector<const N: usize>(&mut self) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.next())
    }

    /// Returns a vector without the large values: lengths of that magnitude would leave hardly a digit of the
    /// inverse of a mass matrix.
    fn moderate_random_vector<const N: usize>(&mut self) -> SVector<f64, N> {
        self.random_vector::<N>().map(|x| x.clamp(-2.0, 2.0))
    }
}

/// Returns the largest difference of two matrices, relative to the largest entry.
fn relative_difference<const R: usize, const C: usize>(
    a: &SMatrix<f64, R, C>,
    b: &SMatrix<f64, R, C>,
) -> f64 {
    (a - b).amax() / (1.0 + b.amax())
}

/// Whether the compiled feature makes results the same bits with all processor instructions.
const REPRODUCIBLE: bool = cfg!(feature = "reproducible");

/// Whether this program selects instructions at run time that give other bits.
fn selects_instructions_at_run_time() -> bool {
    #[cfg(all(target_arch = "x86_64", not(target_feature = "fma")))]
    return !REPRODUCIBLE && std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
    #[cfg(not(all(target_arch = "x86_64", not(target_feature = "fma"))))]
    return false;
}

/// Compares two mechanisms. With `bits`, lanes must have the same bits as single states in the dynamics, too.
fn compare_mechanisms<A, B, const NQ: usize, const NV: usize, const NU: usize>(a: &A, b: &B, bits: bool)
where
    A: Mechanism<NQ, NV, NU, Scalar = f64> + Batch<NQ, NV, NU, Scalar = f64>,
    B: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let mut numbers = RandomNumbers(1);
    let mut differ = false;
    for _ in 0..64 {
        let states: [_; 4] = std::array::from_fn(|_| {
            let q = Mechanism::integrate(a, &Mechanism::neutral(a), &numbers.random_vector());
            (q, numbers.random_vector::<NV>(), numbers.random_vector::<NV>())
        });
        let q = SVector::from_fn(|i, _| Lanes(states.map(|s| s.0[i])));
        let v = SVector::from_fn(|i, _| Lanes(states.map(|s| s.1[i])));
        let x = SVector::from_fn(|i, _| Lanes(states.map(|s| s.2[i])));
        let t = Lanes::splat(0.0);
        let (mass, tau, motion) = (
            a.mass_matrix_lanes(t, &q),
            a.inverse_dynamics_lanes(t, &q, &v, &x),
            a.forward_dynamics_lanes(t, &q, &v, &x),
        );
        for (k, (q, v, x)) in states.iter().enumerate() {
            let found = (
                Mechanism::mass_matrix(a, 0.0, q),
                Mechanism::inverse_dynamics(a, 0.0, q, v, x),
                Mechanism::forward_dynamics(a, 0.0, q, v, x),
            );
            let expected =
                (b.mass_matrix(0.0, q), b.inverse_dynamics(0.0, q, v, x), b.forward_dynamics(0.0, q, v, x));
            assert!(relative_difference(&found.0, &expected.0) < 1e-13, "mass matrix");
            assert!(relative_difference(&found.1, &expected.1) < 1e-12, "inverse dynamics");
            assert!(relative_difference(&found.2, &expected.2) < 1e-9, "forward dynamics");
            differ |= found != expected;
            let lane = (mass.map(|m| m.0[k]), tau.map(|m| m.0[k]), motion.map(|m| m.0[k]));
            assert!(relative_difference(&lane.0, &found.0) < 1e-13, "mass matrix in lanes");
            assert!(relative_difference(&lane.1, &found.1) < 1e-12, "inverse dynamics in lanes");
            assert!(relative_difference(&lane.2, &found.2) < 1e-9, "forward dynamics in lanes");
            let same = lane.1 == found.1 && lane.2 == found.2;
            assert!(!(bits || REPRODUCIBLE) || same, "lanes hold the bits of single states");
        }
    }
    // Rounding errors show which instructions were executed.
    assert_eq!(differ, selects_instructions_at_run_time(), "the choice");
}

/// Compares the derivatives of the same mechanism with and without the compile option, at random states.
macro_rules! compare_derivatives {
    ($a:expr, $b:expr) => {{
        let (a, b) = ($a, $b);
        let (one, other) = (&a, &b);
        let mut numbers = RandomNumbers(2);
        for _ in 0..64 {
            let q = one.integrate(&one.neutral(), &numbers.moderate_random_vector());
            let (v, x, u) = (
                numbers.moderate_random_vector(),
                numbers.moderate_random_vector(),
                numbers.moderate_random_vector(),
            );
            let most = if REPRODUCIBLE { 0.0 } else { 1e-9 };
            let assert_small_differences =
                |(a, b): (f64, f64)| assert!(a <= most && b <= most, "derivatives: {a:e}, {b:e}");
            let found = one.inverse_dynamics_derivatives(&q, &v, &x);
            let expected = other.inverse_dynamics_derivatives(&q, &v, &x);
            assert_small_differences((
                relative_difference(&found.0, &expected.0),
                relative_difference(&found.1, &expected.1),
            ));
            let found = one.forward_dynamics_derivatives(&q, &v, &x);
            let expected = other.forward_dynamics_derivatives(&q, &v, &x);
            assert_small_differences((
                relative_difference(&found.0, &expected.0),
                relative_difference(&found.1, &expected.1),
            ));
            let inverses = (one.mass_matrix_inverse(&q), other.mass_matrix_inverse(&q));
            assert_small_differences((
                relative_difference(&found.2, &expected.2),
                relative_difference(&inverses.0, &inverses.1),
            ));
            assert!(relative_difference(&inverses.1, &expected.2) < 1e-9, "the inverse of the mass matrix");
            let (found, expected) = (one.linearize(&q, &v, &u), other.linearize(&q, &v, &u));
            assert_small_differences((
                relative_difference(&found.0, &expected.0),
                relative_difference(&found.1, &expected.1),
            ));
        }
    }};
}

fn main() {
    compare_mechanisms(&detected::Panda, &targeted::Panda, true);
    compare_mechanisms(&detected::Solo12, &targeted::Solo12, false);
    let (g, m, l) = (9.81, 1.3, 0.7);
    let (one, other) = (detected::Machine { g, m, l }, targeted::Machine { g, m, l });
    compare_mechanisms(&one, &other, true);
    compare_mechanisms(&one.prepare(), &other.prepare(), true);
    compare_derivatives!(detected::Panda, targeted::Panda);
    compare_derivatives!(detected::Solo12, targeted::Solo12);
    compare_derivatives!(one, other);
    compare_derivatives!(detected::Chain, targeted::Chain);
}
