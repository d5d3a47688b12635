//! The packed mass matrix, without structural zeros, equals the mass matrix.

use linkwork::lanes::f64x4;
use linkwork::mechanism;
use linkwork::nalgebra::{SMatrix, SVector};
use support::compare::assert_close;
use support::random::Random;

/// Quadruped Solo12, in whose mass matrix the legs are not coupled to each other.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, packed)]
struct Quadruped;

/// Arm with a gripper, in which every joint is coupled to every other.
#[mechanism(urdf = "../models/urdf/panda.urdf", packed)]
struct Panda;

/// Humanoid with more results than registers, so that neighbouring entries are stored together as soon as
/// they are computed.
#[mechanism(urdf = "../models/urdf/simple_humanoid.urdf", base = free, packed)]
struct Humanoid;

/// Humanoid with several columns of the mass matrix in SIMD lanes.
#[mechanism(urdf = "../models/urdf/g1.urdf", base = free, packed)]
struct G1;

/// Two arms on one cart, with all other options for generated functions enabled together with `packed`.
#[mechanism(
    gravity = -9.81 * y,
    packed,
    prepare,
    derivatives,
    centroidal,
    regressor,
    sensitivities,
    batch
)]
struct TwoArms {
    m: f64,
    l: f64,
    #[body(mass = 2 * m)]
    cart: Body,
    #[body(mass = m, com = l / 2 * x, inertia = rod(m, l, x))]
    left: Body,
    #[body(mass = m, com = -l / 2 * x, inertia = rod(m, l, x))]
    right: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> left, about = z)]
    one: Pin,
    #[joint(cart -> right, about = z)]
    other: Pin,
}

/// Number that is no entry of a mass matrix: it marks entries that are not written.
const UNTOUCHED: f64 = -1e30;

macro_rules! check {
    ($robot:ident, $at:expr) => {{
        let robot = $at;
        let mut random = Random::new(41);
        assert!($robot::MASS_MATRIX_ENTRIES.is_sorted_by_key(|(i, j)| (j, i)));
        for _ in 0..5 {
            let q = random.random_configuration(&robot);
            let mut full = SMatrix::<f64, { $robot::NV }, { $robot::NV }>::zeros();
            for ((i, j), entry) in $robot::MASS_MATRIX_ENTRIES.into_iter().zip(&robot.mass_matrix_packed(&q))
            {
                assert!(i >= j, "the lower triangle");
                (full[(i, j)], full[(j, i)]) = (*entry, *entry);
            }
            assert_close("mass matrix", full.as_slice(), robot.mass_matrix(&q).as_slice(), 1e-14);
            // Entries that are always zero keep the caller's value.
            let mut kept = SMatrix::from_element(UNTOUCHED);
            robot.mass_matrix_into(&q, &mut kept);
            for (i, j) in (0..$robot::NV).flat_map(|i| (0..$robot::NV).map(move |j| (i, j))) {
                let is_written = $robot::MASS_MATRIX_ENTRIES.contains(&(i.max(j), i.min(j)));
                let expected = if is_written { full[(i, j)] } else { UNTOUCHED };
                assert_eq!(kept[(i, j)], expected, "entry {i}, {j}");
            }
        }
        $robot::MASS_MATRIX_ENTRIES.len()
    }};
}

#[test]
fn packed_mass_matrix_equals_the_full_matrix() {
    // The base with itself has a mass that is the same in all directions, a skew-symmetric first moment and
    // an inertia. Each joint is coupled to the base; the rotation of a hip about x causes no force along x.
    // In each leg, each joint is coupled to the joints above it.
    assert_eq!(check!(Quadruped, Quadruped), (21 - 3 - 3) + (12 * 6 - 4) + 4 * 6);
    // Two fingers of equal mass that move in opposite directions cause no net force.
    assert_eq!(check!(Panda, Panda), 7 * 8 / 2 + 1);
    assert_eq!(check!(TwoArms, TwoArms { m: 1.2, l: 0.5 }), 5);
    // Legs are coupled neither to each other nor to the bodies on the torso.
    assert!(check!(Humanoid, Humanoid) < 35 * 36 / 2);
    assert!(check!(G1, G1) < 35 * 36 / 2);
    let arms = TwoArms { m: 1.2, l: 0.5 };
    let q = SVector::from([0.1, 0.2, 0.3]);
    let (one, other) = (arms.prepare().mass_matrix_packed(&q), arms.mass_matrix_packed(&q));
    assert_close("prepared", one.as_slice(), other.as_slice(), 1e-15);
    let (mut one, mut several) = (SMatrix::zeros(), SMatrix::zeros());
    arms.prepare().mass_matrix_into(&q, &mut one);
    assert_close("prepared", one.as_slice(), arms.mass_matrix(&q).as_slice(), 1e-15);
    arms.mass_matrix_into_lanes::<4>(&q.map(f64x4::splat), &mut several);
    arms.mass_matrix_into(&q, &mut one);
    assert_eq!(several, one.map(f64x4::splat));
    assert_eq!(TwoArms::MASS_MATRIX_ENTRIES, [(0, 0), (1, 0), (2, 0), (1, 1), (2, 2)]);
}
