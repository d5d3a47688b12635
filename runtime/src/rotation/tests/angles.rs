use super::table::{ANGLES, RATES, TABLE};
use super::*;
use crate::rotation::*;
use core::f64::consts::{FRAC_PI_2, PI};
use std::string::ToString;

/// Offsets of the middle Euler angle from a singularity, rad, at which conversions are tested.
const OFFSETS: [f64; 14] =
    [0.0, 1e-300, 1e-17, 1e-16, 4e-16, 8e-16, 1e-15, 3e-15, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-3];

#[test]
fn euler_sequences_match_reference_table() {
    for row in &TABLE {
        let (sequence, name) = (row.sequence, row.name);
        assert_eq!(sequence.to_string(), name);
        let [m0, m1, m2] = row.matrix.map(nalgebra::RowVector3::from);
        let matrix = Matrix3::from_rows(&[m0, m1, m2]);
        let rotation = sequence.rotation(ANGLES);
        assert_error_below_bound(largest_entry_difference(rotation.matrix(), &matrix), 3e-16, name);

        let [w, x, y, z] = row.quaternion;
        let quaternion = shorter(&sequence.quaternion(ANGLES));
        let expected = Quaternion::new(w, x, y, z);
        assert_error_below_bound(largest_entry_difference(&quaternion.coords, &expected.coords), 3e-16, name);
        assert_error_below_bound(
            largest_entry_difference(&quaternion_of_rotation(&rotation).coords, &expected.coords),
            3e-16,
            name,
        );
        assert_error_below_bound(
            largest_entry_difference(quaternion.to_rotation_matrix().matrix(), &matrix),
            1e-15,
            name,
        );

        let vector = Vector3::from(row.rotation_vector);
        assert_error_below_bound(
            largest_entry_difference(&RotationVector::from_rotation(&rotation).0, &vector),
            1e-15,
            name,
        );
        assert_error_below_bound(
            largest_entry_difference(&RotationVector::from_quaternion(&quaternion).0, &vector),
            1e-15,
            name,
        );
        assert_error_below_bound(
            largest_entry_difference(RotationVector(vector).rotation().matrix(), &matrix),
            1e-15,
            name,
        );

        let (body, space) = (Vector3::from(row.omega_body), Vector3::from(row.omega_space));
        assert_error_below_bound(
            largest_entry_difference(&sequence.omega_body(ANGLES, RATES), &body),
            5e-16,
            name,
        );
        assert_error_below_bound(
            largest_entry_difference(&sequence.omega_space(ANGLES, RATES), &space),
            5e-16,
            name,
        );
        for found in [sequence.rates_from_body(ANGLES, &body), sequence.rates_from_space(ANGLES, &space)] {
            assert_error_below_bound(largest_euler_angle_difference(found.unwrap(), RATES), 1e-15, name);
        }

        let found = sequence.angles(&rotation);
        assert!(!found.singular);
        // The symmetric sequences have the negative middle angle in their second solution.
        let angles = if sequence.is_symmetric() { sequence.other_angles(found.angles) } else { found.angles };
        assert_error_below_bound(largest_euler_angle_difference(angles, ANGLES), 1e-15, name);
    }
}

#[test]
fn table_lists_every_euler_sequence() {
    for (sequence, row) in EulerSequence::ALL.iter().zip(&TABLE) {
        assert_eq!(*sequence, row.sequence);
        assert_eq!(EulerSequence::new(sequence.fixed_in(), sequence.axes()), Some(*sequence));
    }
    assert_eq!(EulerSequence::new(FixedIn::Body, [Axis::X, Axis::X, Axis::Y]), None);
    assert_eq!(EulerSequence::new(FixedIn::Space, [Axis::X, Axis::Y, Axis::Y]), None);
}

#[test]
fn sequence_is_product_of_axis_rotations() {
    let mut random = RandomNumbers(1);
    for sequence in EulerSequence::ALL {
        for _ in 0..50 {
            let [a, b, c] = random.random_numbers().map(|x: f64| 4.0 * x);
            let [i, j, k] = sequence.axes();
            let (a_turn, b_turn, c_turn) = (i.rotation(a), j.rotation(b), k.rotation(c));
            let product = match sequence.fixed_in() {
                FixedIn::Body => a_turn * b_turn * c_turn,
                FixedIn::Space => c_turn * b_turn * a_turn,
            };
            let rotation = sequence.rotation([a, b, c]);
            assert_error_below_bound(
                largest_entry_difference(rotation.matrix(), product.matrix()),
                4e-16,
                sequence,
            );
            let quaternion = sequence.quaternion([a, b, c]);
            assert_error_below_bound(
                largest_entry_difference(quaternion.to_rotation_matrix().matrix(), product.matrix()),
                1e-15,
                sequence,
            );
            assert_error_below_bound((quaternion.norm() - 1.0).abs(), 5e-16, sequence);
        }
    }
}

#[test]
fn euler_angles_reproduce_random_rotations() {
    let mut random = RandomNumbers(2);
    for sequence in EulerSequence::ALL {
        for _ in 0..500 {
            let rotation = random.random_rotation();
            let found = sequence.angles(&rotation);
            let [a, b, c] = found.angles;
            assert!(!found.singular && a.abs() <= PI && c.abs() <= PI);
            let range = if sequence.is_symmetric() { 0.0..=PI } else { -FRAC_PI_2..=FRAC_PI_2 };
            assert!(range.contains(&b), "{sequence} {b}");
            assert_error_below_bound(
                largest_entry_difference(sequence.rotation(found.angles).matrix(), rotation.matrix()),
                1.5e-15,
                sequence,
            );
            let other = sequence.other_angles(found.angles);
            assert!(other.iter().all(|t| t.abs() <= PI));
            assert_error_below_bound(
                largest_entry_difference(sequence.rotation(other).matrix(), rotation.matrix()),
                2e-15,
                sequence,
            );
            assert_error_below_bound(
                largest_euler_angle_difference(sequence.other_angles(other), found.angles),
                1e-15,
                sequence,
            );
        }
    }
}

/// Returns middle angles close to a singularity of the sequence.
fn nearly_singular_angles(sequence: EulerSequence) -> impl Iterator<Item = f64> {
    let ends = if sequence.is_symmetric() { [0.0, PI] } else { [-FRAC_PI_2, FRAC_PI_2] };
    let [low, high] = ends;
    OFFSETS.into_iter().flat_map(move |offset| [low + offset, high - offset])
}

#[test]
fn angles_near_gimbal_lock_reproduce_rotation() {
    let mut random = RandomNumbers(3);
    for sequence in EulerSequence::ALL {
        for middle in nearly_singular_angles(sequence) {
            for _ in 0..20 {
                let [a, c] = random.random_numbers().map(|x: f64| PI * x);
                let rotation = sequence.rotation([a, middle, c]);
                let found = sequence.angles(&rotation);
                let back = sequence.rotation(found.angles);
                assert_error_below_bound(
                    largest_entry_difference(back.matrix(), rotation.matrix()),
                    2.5e-15,
                    (sequence, middle, a, c, found),
                );

                let sine = if sequence.is_symmetric() { middle.sin() } else { middle.cos() };
                let [_, b, third] = found.angles;
                assert_error_below_bound((b - middle).abs(), 1.5e-15, (sequence, middle));
                assert_eq!(found.singular, sine.abs() <= 4.0 * f64::EPSILON, "{sequence} {middle}");
                if found.singular {
                    assert_eq!(third, 0.0);
                } else {
                    let off = [found.angles[0] - a, third - c].map(|x| x.sin().abs().max(1.0 - x.cos()));
                    assert_error_below_bound(off[0].max(off[1]) * sine, 1e-15, (sequence, middle));
                }
            }
        }
    }
}

#[test]
fn noisy_rotations_at_gimbal_lock_convert_back() {
    let mut random = RandomNumbers(4);
    for sequence in EulerSequence::ALL {
        for middle in nearly_singular_angles(sequence) {
            let rotation = sequence.rotation([0.7, middle, -0.4]);
            let turn = random.random_rotation();
            let noisy = turn.inverse() * (turn * rotation);
            let found = sequence.angles(&noisy);
            assert_error_below_bound(
                largest_entry_difference(sequence.rotation(found.angles).matrix(), noisy.matrix()),
                4e-15,
                (sequence, middle),
            );
        }
    }
}

#[test]
fn gimbal_lock_uses_first_angle_alone() {
    let found = EulerSequence::BODY_ZYX.angles(&EulerSequence::BODY_ZYX.rotation([0.3, FRAC_PI_2, 1.0]));
    assert!(found.singular);
    assert_error_below_bound(
        largest_euler_angle_difference(found.angles, [-0.7, FRAC_PI_2, 0.0]),
        3e-16,
        found,
    );
    let found = EulerSequence::SPACE_ZXZ.angles(&EulerSequence::SPACE_ZXZ.rotation([0.3, 0.0, 1.0]));
    assert!(found.singular);
    assert_error_below_bound(largest_euler_angle_difference(found.angles, [1.3, 0.0, 0.0]), 3e-16, found);
    for sequence in EulerSequence::ALL {
        let found = sequence.angles(&Rotation3::<f64>::identity());
        assert_eq!(found, Angles { angles: [0.0; 3], singular: sequence.is_symmetric() });
    }
}

#[test]
fn single_precision_angles_convert_back() {
    let mut random = RandomNumbers(5);
    for sequence in EulerSequence::ALL {
        let singular = if sequence.is_symmetric() { 0.0 } else { FRAC_PI_2 };
        for offset in [0.0, 1e-8, 1e-6, 1e-3, 1.0] {
            let [a, c] = random.random_numbers::<2>();
            let angles = [a, singular - offset, c].map(convert_number::<f32>);
            let rotation = sequence.rotation(angles);
            let back = sequence.rotation(sequence.angles(&rotation).angles);
            assert!((back.matrix() - rotation.matrix()).amax() < 1.2e-6, "{sequence} {offset}");
        }
    }
}
