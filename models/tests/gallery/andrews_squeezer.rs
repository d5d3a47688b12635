use crate::testing::precise_integrator;
use linkwork::prelude::*;
use linkwork_models::AndrewsSqueezer;

/// Reference angles of the mechanism at t = 0.03 s, recomputed with an extrapolation method in 160-bit
/// arithmetic; the published digits are accurate to 1e-10.
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
    let (q, zero) = (SVector::from(AndrewsSqueezer::START), SVector::zeros());
    assert!(squeezer.constraint_residuals(&q).amax() < 1e-15);
    let (a, _) = squeezer.constrained_dynamics(&q, &zero, &zero);
    assert!((a[0] - 14_222.443_919_954_138).abs() < 1e-7, "{a}");
    assert!((a[1] + 10_666.832_939_965_585).abs() < 1e-7, "{a}");
    assert!(a.rows(2, 5).amax() < 1e-7, "{a}");
}

#[test]
fn andrews_squeezer_ends_where_published() -> Result<(), Error> {
    let squeezer = AndrewsSqueezer {};
    let end = simulate(&squeezer)
        .from(AndrewsSqueezer::START, [0.0; 7])
        .method(precise_integrator())
        .duration(0.03)
        .finish()?;
    for (found, expected) in end.q.iter().zip(END) {
        assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
    }
    assert!(squeezer.constraint_residuals(&end.q).amax() < 1e-14);
    Ok(())
}
