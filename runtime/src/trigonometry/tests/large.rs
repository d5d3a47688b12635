//! Tests of angles beyond the range of the fast argument reduction, whose sines and cosines are those of the
//! library.

use super::super::LARGEST;
use super::{A, exact};
use crate::arithmetic::Arithmetic;
use exact::DoubleDouble;

/// Significand and exponent of an angle, and its sine and cosine in double-double precision.
type ReferenceAngle = (u64, i32, DoubleDouble, DoubleDouble);

/// Reference values computed with mpmath 1.3 at 4000 bits. The first angle is the double nearest to a nonzero
/// multiple of π/2 (Muller, *Elementary Functions*, 2016, § 11.3.2). The next two are those with the largest
/// error of glibc among about six thousand angles near such multiples. Nine more are near such multiples,
/// found by continued fractions, and nine are random.
#[rustfmt::skip]
const TABLE: [ReferenceAngle; 21] = [
    (6381956970095103, 797, (1.0, -1.098476220074687e-37), (-4.687165924254628e-19, 4.3720557429382733e-36)),
    (6366906923947931, 194, (-1.0, 1.1503612641618572e-35), (-4.796584752012325e-18, -1.8828539326789174e-34)),
    (5850965514341686, 526, (-4.970732575237069e-18, -2.2807892121852253e-34), (-1.0, 1.2354091167261475e-35)),
    (7295746205504726, -30, (2.01525464535881e-16, 2.372771977037605e-33), (1.0, -2.0306256428201316e-32)),
    (4615509997160240, -10, (-1.2008978913516655e-16, 4.707862669641096e-33), (1.0, -7.210778727264382e-33)),
    (6134899525417045, 0, (9.495905770584396e-17, -3.873995565755314e-33), (-1.0, 4.508611320190901e-33)),
    (8331967718141344, 60, (3.3400013514246855e-15, -9.88810737972528e-32), (1.0, -5.577804513759363e-30)),
    (5937733265427538, 200, (-2.0713650370974848e-16, -4.290722524742125e-34), (-1.0, 2.1452765584549323e-32)),
    (4935212370298612, 420, (-4.539702829341049e-16, 4.413816367154225e-32), (1.0, -1.0304450889363563e-31)),
    (8438258240500718, 640, (6.430699961034675e-17, 5.745721208955687e-34), (1.0, -2.067695099442569e-33)),
    (8879625129797515, 850, (1.0, -5.274953564753797e-33), (-1.027127408333922e-16, -1.6901849462107895e-33)),
    (6221301883130153, 971, (-2.586287505210448e-17, 4.736608381311561e-35), (1.0, -3.3444415298038417e-34)),
    (5865537642229268, -34, (-0.3535279083434908, 1.549845152114137e-17), (-0.935423977681926, -1.8220306001091847e-17)),
    (5417980576564598, -35, (0.9206136889458603, 1.6538092660984737e-18), (0.3904746287859108, -2.6807130517783212e-17)),
    (7452798501515186, -20, (-0.9437446657971984, -2.2727107107815427e-17), (-0.33067507583628714, -1.12346197405807e-17)),
    (4746613899418833, 1, (-0.33629953845248617, 1.6516643781837636e-17), (-0.9417550745478597, -3.187430904117778e-17)),
    (8167191318467412, 100, (-0.9554551180531535, -5.3622694056345756e-17), (-0.295136438594143, -1.1476356815836428e-18)),
    (5179215136434947, 333, (0.599761678006533, 4.283986139643907e-17), (0.800178686041304, -4.2602950293882596e-17)),
    (5630191467393721, 600, (-0.9790855346294564, -1.441718870118954e-17), (-0.2034490498364433, -8.343062744647892e-18)),
    (8776663960853100, 900, (-0.999999823437107, -5.2736088867112136e-17), (-0.0005942438511804558, -3.736343921609234e-20)),
    (8214401761668508, 971, (0.5327566202180898, -3.3877758635437754e-18), (-0.8462685056256071, 5.490448570408638e-17)),
];

#[test]
fn libm_sines_are_accurate_to_one_ulp() {
    for (significand, exponent, sine, cosine) in TABLE {
        let x = significand as f64 * 2.0_f64.powi(exponent);
        let (s, c) = libm::sincos(x);
        assert!(
            exact::error_in_ulps(s, sine) <= 1.0 && exact::error_in_ulps(c, cosine) <= 1.0,
            "of {x:e}: {s:e}, {c:e}"
        );
    }
}

#[test]
fn large_angles_match_the_library() {
    for (significand, exponent, sine, cosine) in TABLE {
        let x = significand as f64 * 2.0_f64.powi(exponent);
        assert!(x > LARGEST);
        for (x, sign) in [(x, 1.0), (-x, -1.0)] {
            let (s, c) = A::sin_cos(x);
            let ([s4, ..], [c4, ..]) = A::sin_cos_all([x, 0.1, 2.0, -x]);
            assert_eq!((s, c), (s4, c4), "small neighbours change nothing");
            for (found, exact) in [(s, (sign * sine.0, sign * sine.1)), (c, cosine)] {
                let off = ((found - exact.0) - exact.1).abs();
                let unit = off / exact::error_in_ulps(found, exact);
                // The accuracy of glibc's reduction (the C library of Linux) is limited to this: 1e5 units in
                // the last place at the worst angles.
                let lost = if cfg!(feature = "std") { 2e-28 } else { 0.0 };
                assert!(off == 0.0 || off <= unit + lost, "of {x:e}: {found:e} is {off:e} off");
            }
        }
    }
}
