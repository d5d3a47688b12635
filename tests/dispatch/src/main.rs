//! Functions that choose their instructions at run time agree with those that do not, to rounding; several states at once
//! do what single states do; and there is no `unsafe` in generated code.
#![forbid(unsafe_code)]

/// The same mechanisms, compiled in two ways.
macro_rules! mechanisms {
    ($name:ident: $($option:tt)*) => {
        mod $name {
            use linkwork::prelude::*;

            /// Numbers alone.
            #[mechanism(urdf = "../../models/urdf/panda.urdf", batch, $($option)*)]
            pub struct Panda;

            /// Limbs in lanes.
            #[mechanism(urdf = "../../models/urdf/solo12.urdf", base = free, batch, $($option)*)]
            pub struct Solo12;

            /// Parameters of any type, and what is computed of them.
            #[mechanism(gravity = -g * y, batch, prepare, $($option)*)]
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
        }
    };
}

mechanisms!(detected: processor = detect);
mechanisms!(targeted: processor = target);

use linkwork::prelude::*;

/// Numbers in [-2, 2], and an angle beyond the range in which sines are evaluated several at a time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let unit = (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
        if self.0.is_multiple_of(97) { 2e5 * unit } else { 4.0 * unit - 2.0 }
    }

    fn vector<const N: usize>(&mut self) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.next())
    }
}

/// Largest difference relative to the largest number.
fn difference<const R: usize, const C: usize>(a: &SMatrix<f64, R, C>, b: &SMatrix<f64, R, C>) -> f64 {
    (a - b).amax() / (1.0 + b.amax())
}

/// True where this program chooses.
fn chooses() -> bool {
    #[cfg(all(target_arch = "x86_64", not(target_feature = "fma")))]
    return std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
    #[cfg(not(all(target_arch = "x86_64", not(target_feature = "fma"))))]
    return false;
}

/// Compares two mechanisms; `bits` says that lanes hold the bits of single states.
fn compare<A, B, const NQ: usize, const NV: usize, const NU: usize>(a: &A, b: &B, bits: bool)
where
    A: Mechanism<NQ, NV, NU, Scalar = f64> + Batch<NQ, NV, NU, Scalar = f64>,
    B: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let mut numbers = Numbers(1);
    let mut differ = false;
    for _ in 0..64 {
        let states: [_; 4] = std::array::from_fn(|_| {
            let q = Mechanism::integrate(a, &Mechanism::neutral(a), &numbers.vector());
            (q, numbers.vector::<NV>(), numbers.vector::<NV>())
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
                Mechanism::mass_matrix(a, q),
                Mechanism::inverse_dynamics(a, q, v, x),
                Mechanism::forward_dynamics(a, q, v, x),
            );
            let expected = (b.mass_matrix(q), b.inverse_dynamics(q, v, x), b.forward_dynamics(q, v, x));
            assert!(difference(&found.0, &expected.0) < 1e-13, "mass matrix");
            assert!(difference(&found.1, &expected.1) < 1e-12, "inverse dynamics");
            assert!(difference(&found.2, &expected.2) < 1e-9, "forward dynamics");
            differ |= found != expected;
            let lane = (mass.map(|m| m.0[k]), tau.map(|m| m.0[k]), motion.map(|m| m.0[k]));
            assert!(difference(&lane.0, &found.0) < 1e-13, "mass matrix in lanes");
            assert!(difference(&lane.1, &found.1) < 1e-12, "inverse dynamics in lanes");
            assert!(difference(&lane.2, &found.2) < 1e-9, "forward dynamics in lanes");
            assert!(!bits || lane == found, "lanes hold the bits of single states");
        }
    }
    // Rounding shows which instructions ran.
    assert_eq!(differ, chooses(), "the choice");
}

fn main() {
    compare(&detected::Panda, &targeted::Panda, true);
    compare(&detected::Solo12, &targeted::Solo12, false);
    let (g, m, l) = (9.81, 1.3, 0.7);
    let (one, other) = (detected::Machine { g, m, l }, targeted::Machine { g, m, l });
    compare(&one, &other, true);
    compare(&one.prepare(), &other.prepare(), true);
}
