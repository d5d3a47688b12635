//! Constraints between vectors of a plane: the component normal to the plane is satisfied identically and
//! adds no row.

use linkwork::prelude::*;

/// Two carts on a table with equal velocities.
#[mechanism]
struct Convoy {
    #[body(mass = 1)]
    first: Body,
    #[body(mass = 3)]
    second: Body,
    #[joint(ground -> first, along = (x, y))]
    one: Stage,
    #[joint(ground -> second, along = (x, y))]
    two: Stage,
    #[constraint(v(first / ground / ground) = v(second / ground / ground))]
    alike: Nonholonomic,
}

/// Two carts on a table with a constant offset between them.
#[mechanism]
struct CartsWithConstantOffset {
    gap: f64,
    #[body(mass = 1)]
    first: Body,
    #[body(mass = 3)]
    second: Body,
    #[joint(ground -> first, along = (x, y))]
    one: Stage,
    #[joint(ground.at(0.3 * z) -> second, along = (x, y))]
    two: Stage,
    #[constraint(r(second / first) = gap * x + 0.3 * z)]
    coupling: Holonomic,
}

#[test]
fn equal_planar_velocities_are_two_constraints() {
    assert_eq!((Convoy::NC, Convoy::NH), (2, 0));
    assert_eq!(Convoy::CONSTRAINTS, ["alike.x", "alike.y"]);
    let a = Convoy {}.forward_dynamics(&SVector::zeros(), &SVector::zeros(), &[4.0, 8.0, 0.0, 0.0].into());
    // Newton's second law for both carts together.
    assert!((a - SVector::from([1.0, 2.0, 1.0, 2.0])).amax() < 1e-12, "{a}");
}

#[test]
fn planar_point_difference_is_two_constraints() {
    assert_eq!((CartsWithConstantOffset::NC, CartsWithConstantOffset::NH), (2, 2));
    assert_eq!(CartsWithConstantOffset::CONSTRAINTS, ["coupling.x", "coupling.y"]);
    let pair = CartsWithConstantOffset { gap: 0.5 };
    let q = pair.assemble(&SVector::zeros(), &[0, 1]).expect("the second cart is moved");
    assert!((q - SVector::from([0.0, 0.0, 0.5, 0.0])).amax() < 1e-12, "{q}");
    let a = pair.forward_dynamics(&q, &SVector::zeros(), &[4.0, 8.0, 0.0, 0.0].into());
    assert!((a - SVector::from([1.0, 2.0, 1.0, 2.0])).amax() < 1e-12, "{a}");
}
