//! The mass matrix without its zeros is the mass matrix.

use linkwork::lanes::f64x4;
use linkwork::mechanism;
use linkwork::nalgebra::{SMatrix, SVector};
use support::compare::assert_close;
use support::random::Random;

/// A quadruped: legs do not act on one another.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free, packed)]
struct Quadruped;

/// An arm, of which every joint acts on every other, with a gripper.
#[mechanism(urdf = "../models/urdf/panda.urdf", packed)]
struct Panda;

/// So many results that they cannot wait in registers: neighbours are stored together as they become known.
#[mechanism(urdf = "../models/urdf/simple_humanoid.urdf", base = free, packed)]
struct Humanoid;

/// The same with several columns side by side.
#[mechanism(urdf = "../models/urdf/g1.urdf", base = free, packed)]
struct G1;

/// Two arms on one cart, with everything else that can be asked for.
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

/// Not a number that a mass matrix has.
const UNTOUCHED: f64 = -1e30;

macro_rules! check {
    ($robot:ident, $at:expr) => {{
        let robot = $at;
        let mut random = Random::new(41);
        assert!($robot::MASS_MATRIX_ENTRIES.is_sorted_by_key(|(i, j)| (j, i)));
        for _ in 0..5 {
            let q = random.configuration(&robot);
            let mut full = SMatrix::<f64, { $robot::NV }, { $robot::NV }>::zeros();
            for ((i, j), entry) in $robot::MASS_MATRIX_ENTRIES.into_iter().zip(&robot.mass_matrix_packed(&q))
            {
                assert!(i >= j, "the lower triangle");
                (full[(i, j)], full[(j, i)]) = (*entry, *entry);
            }
            assert_close("mass matrix", full.as_slice(), robot.mass_matrix(&q).as_slice(), 1e-14);
            // What is always zero is not touched, whatever stands there.
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
fn packed_is_whole() {
    // The base with itself: a mass that is the same in all directions, a skew first moment, an inertia. Each
    // joint with the base: turning a hip about x pushes nothing along x. In each leg each joint with those
    // above it.
    assert_eq!(check!(Quadruped, Quadruped), (21 - 3 - 3) + (12 * 6 - 4) + 4 * 6);
    // Fingers of equal mass that move against each other push nothing.
    assert_eq!(check!(Panda, Panda), 7 * 8 / 2 + 1);
    assert_eq!(check!(TwoArms, TwoArms { m: 1.2, l: 0.5 }), 5);
    // Legs do not act on one another, nor on what the torso carries.
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
