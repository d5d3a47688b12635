use super::*;
use crate::rotation::*;

#[test]
fn rotation_is_its_own_nearest_rotation() {
    let mut random = RandomNumbers(31);
    for _ in 0..500 {
        let rotation = random.random_rotation();
        for scale in [1e-300, 1e-3, 1.0, 7.0, 1e300] {
            let found = nearest_rotation(&(rotation.matrix() * scale)).unwrap();
            assert_error_below_bound(
                largest_entry_difference(found.matrix(), rotation.matrix()),
                2e-15,
                scale,
            );
            assert_error_below_bound(orthogonality_error(&found), 2e-15, scale);
        }
    }
}

#[test]
fn nearest_rotation_minimises_distance() {
    let mut random = RandomNumbers(32);
    for noise in [1e-12, 1e-6, 1e-2, 0.3, 2.0] {
        for _ in 0..100 {
            let rotation = random.random_rotation();
            let matrix = rotation.matrix() + Matrix3::from_fn(|_, _| noise * random.random_number());
            let found = nearest_rotation(&matrix).unwrap();
            assert_error_below_bound(orthogonality_error(&found), 2e-15, noise);
            assert_error_below_bound((found.matrix().determinant() - 1.0).abs(), 2e-15, noise);
            // Rᵀ M is symmetric at every stationary point.
            assert_error_below_bound(axial(&(found.inverse() * matrix)).norm(), 3e-15 * (1.0 + noise), noise);
            let squared_distance = |r: &Rotation3<f64>| (r.matrix() - matrix).norm_squared();
            let least = squared_distance(&found) * (1.0 - 1e-12);
            assert!(least <= squared_distance(&rotation));
            for _ in 0..20 {
                let near = found * RotationVector(random.random_vector() * 0.3).rotation();
                assert!(
                    least <= squared_distance(&near) && least <= squared_distance(&random.random_rotation())
                );
            }
        }
    }
}

#[test]
fn nearest_rotation_removes_symmetric_noise() {
    let mut random = RandomNumbers(33);
    let rotation = random.random_rotation();
    let noise = Matrix3::from_fn(|_, _| 1e-8 * random.random_number());
    let found = nearest_rotation(&(rotation.matrix() + rotation.matrix() * noise)).unwrap();
    let moved = RotationVector::from_rotation(&(rotation.inverse() * found));
    assert_error_below_bound(largest_entry_difference(&moved.0, &axial(&noise)), 2e-15, noise);
}

#[test]
fn nearest_rotation_requires_rank_two() {
    let mut random = RandomNumbers(34);
    let (r, s) = (random.random_rotation(), random.random_rotation());
    let matrix_with_singular_values =
        |values: [f64; 3]| r.matrix() * Matrix3::from_diagonal(&values.into()) * s.matrix();
    let best = r * s;
    for values in [[3.0, 2.0, 0.0], [3.0, 2.0, 1.0], [3.0, 2.0, -1.0], [1.0, 1e-3, 0.0], [1.0, 1.0, -0.9]] {
        let found = nearest_rotation(&matrix_with_singular_values(values)).unwrap();
        assert_error_below_bound(
            largest_entry_difference(found.matrix(), best.matrix()),
            3e-15 * values[0] / (values[1] + values[2]),
            values,
        );
    }
    for values in [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, -1.0], [-1.0; 3], [f64::NAN, 1.0, 1.0]] {
        assert_eq!(nearest_rotation(&matrix_with_singular_values(values)), None, "{values:?}");
    }
    assert_eq!(nearest_rotation(&Matrix3::from_element(f64::INFINITY)), None);
    let single = nearest_rotation(&(r.matrix() * 3.0).cast::<f32>()).unwrap();
    assert!((single.matrix() - r.matrix().cast::<f32>()).amax() < 1e-6);
}
