use super::*;
use crate::rotation::*;
use core::f64::consts::{PI, TAU};
use nalgebra::Unit;

/// Rotation angles from zero to π, also just below π.
const ANGLES: [f64; 19] = [
    0.0,
    1e-300,
    1e-200,
    1e-20,
    1e-12,
    1e-8,
    3e-8,
    1e-4,
    0.1,
    1.0,
    1.5,
    2.0,
    2.1,
    3.0,
    PI - 1e-4,
    PI - 1e-8,
    PI - 1e-12,
    PI - 1e-15,
    PI,
];

#[test]
fn exponential_equals_rodrigues_formula() {
    let mut random = RandomNumbers(21);
    for angle in ANGLES.into_iter().chain([4.0, TAU, 7.0, 100.0]) {
        for _ in 0..20 {
            let axis = Unit::new_normalize(random.random_axis());
            let rotation = rodrigues(&axis, angle);
            let vector = RotationVector(axis.into_inner() * angle);
            let bound = 1e-15 * (1.0 + angle / 8.0);
            assert_error_below_bound(
                largest_entry_difference(rotation.matrix(), vector.rotation().matrix()),
                bound,
                angle,
            );
            assert_error_below_bound(
                largest_entry_difference(
                    rotation.matrix(),
                    vector.quaternion().to_rotation_matrix().matrix(),
                ),
                bound,
                angle,
            );
            assert_error_below_bound(orthogonality_error(&vector.rotation()), 1.5e-15, angle);
            let v = random.random_vector();
            assert_error_below_bound(
                largest_entry_difference(&rotate_about(&axis, angle, &v), &(rotation * v)),
                1e-15,
                angle,
            );
            assert_error_below_bound((vector.angle() - angle).abs(), 4e-16 * angle, angle);
        }
    }
}

#[test]
fn logarithm_inverts_the_exponential() {
    let mut random = RandomNumbers(22);
    for angle in ANGLES {
        for _ in 0..50 {
            let axis = random.random_axis();
            let vector = RotationVector(axis * angle);
            let bound = 4e-15 * angle.min(0.75);
            for found in [
                RotationVector::from_rotation(&vector.rotation()),
                RotationVector::from_quaternion(&vector.quaternion()),
                RotationVector::from_quaternion(&antipode(&vector.quaternion())),
            ] {
                // To rounding, both signs of a rotation by π are valid.
                let same = largest_entry_difference(&found.0, &vector.0);
                let other = if PI - angle < 1e-14 {
                    largest_entry_difference(&found.0, &-vector.0)
                } else {
                    f64::INFINITY
                };
                assert_error_below_bound(same.min(other), bound, angle);
                assert!(found.angle() <= PI + 1e-15);
            }
        }
    }
}

#[test]
fn eigenaxis_is_found_for_all_angles() {
    let mut random = RandomNumbers(23);
    for angle in ANGLES.into_iter().filter(|angle| *angle > 0.0) {
        for _ in 0..50 {
            let axis = Unit::new_normalize(random.random_axis());
            let (found, turn) = eigenaxis(&rodrigues(&axis, angle)).unwrap();
            assert_error_below_bound((turn - angle).abs(), 2e-15 * angle.min(1.0), angle);
            let sign = if PI - angle < 1e-14 { found.dot(&axis).signum() } else { 1.0 };
            assert_error_below_bound(
                largest_entry_difference(&(found.into_inner() * sign), &axis),
                1.5e-15,
                angle,
            );
        }
    }
    assert_eq!(eigenaxis(&Rotation3::<f64>::identity()), None);
    let (from, turn) = (random.random_rotation(), RotationVector(random.random_axis() * 1e-9));
    assert_error_below_bound((angle_between(&from, &(from * turn.rotation())) - 1e-9).abs(), 1e-15, turn);
}

#[test]
fn half_turns_about_all_axes_are_found() {
    for x in [-1.0, 0.0, 1.0] {
        for y in [-1.0, 0.0, 1.0] {
            for z in [-1.0, 0.0, 1.0] {
                let Some(axis) = Unit::try_new(Vector3::new(x, y, z), 0.5) else { continue };
                let n = axis.into_inner();
                let half_turn =
                    Rotation3::from_matrix_unchecked(n * n.transpose() * 2.0 - Matrix3::identity());
                let found = RotationVector::from_rotation(&half_turn);
                assert_error_below_bound((found.angle() - PI).abs(), 5e-16, n);
                assert_error_below_bound(
                    largest_entry_difference(found.rotation().matrix(), half_turn.matrix()),
                    1e-15,
                    n,
                );
                assert_error_below_bound((Mrp::from_rotation(&half_turn).0.norm() - 1.0).abs(), 3e-16, n);
            }
        }
    }
    let half_turn = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.6, 0.0, 0.8));
    assert_eq!(Gibbs::from_quaternion(&half_turn), Err(Singular::HalfTurn));
    assert_eq!(
        Gibbs::from_rotation(&Rotation3::from_matrix_unchecked(Matrix3::from_diagonal(&Vector3::new(
            1.0, -1.0, -1.0
        )))),
        Err(Singular::HalfTurn)
    );
}

#[test]
fn all_parameters_represent_the_same_rotation() {
    let mut random = RandomNumbers(24);
    let turns = ANGLES.into_iter().flat_map(|angle| [(); 20].map(|()| angle));
    for angle in turns {
        let vector = RotationVector(random.random_axis() * angle);
        let rotation = vector.rotation();
        let sigma = Mrp::from(vector);
        assert!(sigma.0.norm() <= 1.0 + 1e-15);
        let mut found = std::vec![
            rotation,
            quaternion_of_rotation(&rotation).to_rotation_matrix(),
            sigma.rotation(),
            Mrp::from_rotation(&rotation).rotation(),
            RotationVector::from(sigma).rotation(),
        ];
        if let Ok(g) = Gibbs::try_from(vector) {
            found.extend([g.rotation(), Mrp::from(g).rotation(), RotationVector::from(g).rotation()]);
            found.extend(
                [Gibbs::try_from(sigma), Gibbs::try_from(rotation)].iter().flatten().map(Gibbs::rotation),
            );
            // tan θ/2 = 2 tan(θ/4) / (1 − tan² θ/4), ill-conditioned near θ = π.
            if angle < 3.1 {
                let doubled = sigma.0 * (2.0 / (1.0 - sigma.0.norm_squared()));
                assert_error_below_bound(
                    largest_entry_difference(&doubled, &g.0),
                    1e-15 * (1.0 + g.0.norm_squared()),
                    angle,
                );
            }
        }
        if let Ok(shadow) = sigma.shadow() {
            found.push(shadow.rotation());
            let opposite = antipode(&sigma.quaternion());
            assert_error_below_bound(
                largest_entry_difference(&shadow.quaternion().coords, &opposite.coords),
                5e-16,
                angle,
            );
            assert_error_below_bound(
                largest_entry_difference(&shadow.switched().0, &sigma.0)
                    .min(largest_entry_difference(&shadow.switched().0, &shadow.0)),
                5e-16,
                angle,
            );
        }
        if let Ok(shadow) = vector.shadow() {
            found.push(shadow.rotation());
            assert_error_below_bound((shadow.angle() - (TAU - angle)).abs(), 2e-15, angle);
        }
        for other in found {
            assert_error_below_bound(
                largest_entry_difference(other.matrix(), rotation.matrix()),
                3e-15,
                angle,
            );
            assert_error_below_bound(orthogonality_error(&other), 2e-15, angle);
        }
    }
}

#[test]
fn shadow_of_zero_vector_is_an_error() {
    assert_eq!(Mrp(Vector3::<f64>::zeros()).shadow(), Err(Singular::FullTurn));
    assert_eq!(RotationVector(Vector3::<f64>::zeros()).shadow(), Err(Singular::FullTurn));
    let huge = Vector3::new(0.0, 1e300, 0.0);
    assert_error_below_bound(
        largest_entry_difference(Mrp(huge).rotation().matrix(), &Matrix3::identity()),
        1e-15,
        huge,
    );
    assert_error_below_bound(
        largest_entry_difference(&Mrp(huge).switched().0, &Vector3::zeros()),
        1e-299,
        huge,
    );
    let half_turn = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, -1.0));
    assert_error_below_bound(
        largest_entry_difference(Gibbs(huge).rotation().matrix(), &half_turn),
        1e-15,
        huge,
    );
}

#[test]
fn cayley_transform_is_matrix_quotient() {
    let mut random = RandomNumbers(25);
    for _ in 0..100 {
        let skew = random.random_vector().cross_matrix() * 2.0;
        let quotient = (Matrix3::identity() + skew) * (Matrix3::identity() - skew).try_inverse().unwrap();
        let rotation = cayley(&skew);
        assert_error_below_bound(largest_entry_difference(rotation.matrix(), &quotient), 3e-15, skew);
        assert_error_below_bound(
            largest_entry_difference(&inverse_cayley(&rotation).unwrap(), &skew),
            4e-14,
            skew,
        );
        // The second-order transform is that of the modified Rodrigues vector (Tsiotras, Junkins and Schaub,
        // 1997).
        assert_error_below_bound(
            largest_entry_difference(Mrp(axial(&skew)).rotation().matrix(), &(quotient * quotient)),
            6e-15,
            skew,
        );
    }
}

#[test]
fn vector_composition_matches_rotations() {
    let mut random = RandomNumbers(26);
    for _ in 0..500 {
        let (p, q) = (random.random_quaternion(), random.random_quaternion());
        let product = (p * q).to_rotation_matrix();
        let (a, b) = (Mrp::from_quaternion(&p), Mrp::from_quaternion(&q));
        for (a, b) in [(a, b), (a.shadow().unwrap(), b), (a.shadow().unwrap(), b.shadow().unwrap())] {
            let composed = a.compose(&b);
            assert!(composed.0.norm() <= 1.0 + 1e-15);
            assert_error_below_bound(
                largest_entry_difference(composed.rotation().matrix(), product.matrix()),
                3e-15,
                (p, q),
            );
        }
        let (g, h) = (Gibbs::from_quaternion(&p).unwrap(), Gibbs::from_quaternion(&q).unwrap());
        let composed = g.compose(&h).unwrap();
        let bound = 2e-15 * (1.0 + g.0.norm() + h.0.norm());
        assert_error_below_bound(
            largest_entry_difference(composed.rotation().matrix(), product.matrix()),
            bound,
            (p, q),
        );
        assert_error_below_bound(
            largest_entry_difference(&a.compose(&a.inverse()).0, &Vector3::zeros()),
            2e-16,
            p,
        );
        assert_error_below_bound(
            largest_entry_difference(&g.compose(&g.inverse()).unwrap().0, &Vector3::zeros()),
            2e-16,
            p,
        );
    }
    // Two rotations by π/2 about one axis: infinite for the Gibbs vector, on the unit sphere for the other;
    // two rotations by π: the identity.
    let quarter = Gibbs(Vector3::new(1.0, 0.0, 0.0));
    assert_eq!(quarter.compose(&quarter), Err(Singular::HalfTurn));
    let half = Mrp(Vector3::new(0.0, 1.0, 0.0));
    assert_eq!(half.compose(&half), Mrp(Vector3::zeros()));
    assert_eq!(half.compose(&half.inverse()), Mrp(Vector3::zeros()));
}
