//! Reference sines and cosines in double-double precision.

/// Number of twice the precision, as the sum of two numbers.
pub type DoubleDouble = (f64, f64);

/// Returns sine and cosine in double-double precision: Taylor series of a sixteenth of the angle reduced
/// modulo π/2, doubled four times.
pub fn sin_cos(x: f64) -> [DoubleDouble; 2] {
    // π / 2 in four parts; the products of the first three with integers below 2²⁰ are exact.
    const PARTS: [f64; 4] = [
        1.570_796_326_734_125_6,
        6.077_100_506_303_966e-11,
        2.022_266_248_711_166_5e-21,
        8.478_427_660_368_899e-32,
    ];
    let quarters = (x * core::f64::consts::FRAC_2_PI).round();
    let mut r = (x, 0.0);
    for part in PARTS {
        r = add(r, (-quarters * part, 0.0));
    }
    let r = (r.0 / 16.0, r.1 / 16.0);
    let square = multiply(r, r);
    // 1 - cos r = r²/2! - r⁴/4! + …, which loses no digits in doubling; sin r = r - r³/3! + ….
    let (mut sine, mut versine) = (r, (square.0 / 2.0, square.1 / 2.0));
    let (mut odd, mut even) = (sine, versine);
    for k in (2..28).step_by(2) {
        let k = f64::from(k);
        odd = divide_by_double(multiply(odd, (-square.0, -square.1)), k * (k + 1.0));
        even = divide_by_double(multiply(even, (-square.0, -square.1)), (k + 1.0) * (k + 2.0));
        sine = add(sine, odd);
        versine = add(versine, even);
    }
    for _ in 0..4 {
        // sin 2r = 2 sin r cos r; 1 - cos 2r = 2 sin² r.
        let twice = (2.0 * sine.0, 2.0 * sine.1);
        let cosine = add((1.0, 0.0), (-versine.0, -versine.1));
        (sine, versine) = (multiply(twice, cosine), multiply(twice, sine));
    }
    let cosine = add((1.0, 0.0), (-versine.0, -versine.1));
    let negated_double_double = |x: DoubleDouble| (-x.0, -x.1);
    match quarters.rem_euclid(4.0) as u8 {
        0 => [sine, cosine],
        1 => [cosine, negated_double_double(sine)],
        2 => [negated_double_double(sine), negated_double_double(cosine)],
        _ => [negated_double_double(cosine), sine],
    }
}

/// Returns the error of a double-precision number against a double-double reference, in units in the last
/// place.
pub fn error_in_ulps(found: f64, exact: DoubleDouble) -> f64 {
    let magnitude = exact.0.abs();
    let unit = f64::from_bits(magnitude.to_bits() + 1) - magnitude;
    ((found - exact.0) - exact.1).abs() / unit
}

/// Returns the sum of two double-double numbers, with Knuth's error-free transformation of their leading
/// parts.
fn add(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let sum = a.0 + b.0;
    let of_b = sum - a.0;
    let lost = (a.0 - (sum - of_b)) + (b.0 - of_b);
    normalised_double_double(sum, lost + (a.1 + b.1))
}

fn multiply(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let product = a.0 * b.0;
    normalised_double_double(product, a.0.mul_add(b.0, -product) + (a.0 * b.1 + a.1 * b.0))
}

fn divide_by_double(a: DoubleDouble, by: f64) -> DoubleDouble {
    let quotient = a.0 / by;
    normalised_double_double(quotient, ((-quotient).mul_add(by, a.0) + a.1) / by)
}

fn normalised_double_double(large: f64, small: f64) -> DoubleDouble {
    let sum = large + small;
    (sum, small - (sum - large))
}
