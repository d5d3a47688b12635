//! Simplification by trigonometric identities: `sin² + cos² = 1`, and the conversion between products of
//! sines and cosines and the sines and cosines of sums and differences of angles. Each step merges two terms
//! into one. The steps start from three forms of the sum: unchanged, with squares of cosines replaced by
//! squares of sines, and as a Fourier sum. The shortest result is used.

use super::polynomial::{ANGLES, Atom, Monomial, Polynomial, Ring, Term, Wave};

#[cfg(test)]
mod tests;

/// Maximum number of terms that are simplified together.
const MAX_TERMS: usize = 40;
/// Maximum degree of a product that is converted to a Fourier sum.
const DEGREE: u32 = 6;
/// Relative difference below which coefficients count as equal.
const ROUNDING: f64 = 1e-11;

/// A coefficient times a sorted product of sines and cosines.
#[derive(Clone, Debug, PartialEq)]
struct SineCosineProduct {
    waves: Vec<Wave>,
    coefficient: f64,
}

/// Returns the shortest form found of a polynomial. `None` if the limits of the ring are exceeded.
pub fn simplify_trigonometry(ring: &mut Ring, p: &Polynomial) -> Option<Polynomial> {
    let mask = ring.mask_of_selected_atoms(|atom, _| matches!(atom, Atom::Wave(_)));
    let mut terms = p.terms.clone();
    terms.sort_by_key(|t| t.monomial.clear_mask(mask));
    let mut out = Vec::with_capacity(terms.len());
    for group in terms.chunk_by(|a, b| a.monomial.clear_mask(mask) == b.monomial.clear_mask(mask)) {
        if group.len() == 1 || group.len() > MAX_TERMS {
            out.extend_from_slice(group);
            continue;
        }
        for product in shortest_trigonometric_products(ring, group, mask)? {
            let mut monomial = group[0].monomial.clear_mask(mask);
            for wave in product.waves {
                monomial = monomial.checked_product(ring.intern_atom_as_monomial(Atom::Wave(wave))?)?;
            }
            out.push(Term { monomial, coefficient: product.coefficient });
        }
    }
    Some(Polynomial::sum_of_terms(out))
}

fn shortest_trigonometric_products(
    ring: &mut Ring,
    terms: &[Term],
    mask: Monomial,
) -> Option<Vec<SineCosineProduct>> {
    let products: Vec<SineCosineProduct> =
        terms.iter().map(|t| split_term_into_waves(ring, t, mask)).collect();
    let degree = terms.iter().map(|t| t.monomial.restrict_to_mask(mask).degree()).max();
    let mut best = merge_product_pairs(ring, products.clone())?;
    if degree <= Some(DEGREE) {
        let sum = fourier_sum(ring, &products)?;
        let sum = merge_product_pairs(ring, sum)?.into_iter().map(unfold_double_angle).collect();
        let sines = replace_cosine_squares(ring, products)?;
        let sines = merge_product_pairs(ring, sines)?;
        best = [sum, sines]
            .into_iter()
            .fold(best, |a, b| if sum_complexity(&b) < sum_complexity(&a) { b } else { a });
    }
    Some(best)
}

/// Replaces `cos²` by `1 − sin²` in a sum of products.
fn replace_cosine_squares(
    ring: &mut Ring,
    mut products: Vec<SineCosineProduct>,
) -> Option<Vec<SineCosineProduct>> {
    let mut sum = Vec::new();
    while let Some(mut product) = products.pop() {
        ring.spend_steps(1 + sum.len())?;
        let waves = &product.waves;
        match (1..waves.len()).find(|k| waves[*k].cosine && waves[*k] == waves[k - 1]) {
            None => add_product_to_sum(&mut sum, product),
            Some(k) => {
                let mut squared = product.clone();
                product.waves.drain(k - 1..=k);
                squared.waves[k - 1..=k].iter_mut().for_each(|w| w.cosine = false);
                squared.waves.sort_unstable();
                squared.coefficient = -squared.coefficient;
                products.extend([product, squared]);
            }
        }
    }
    sum.retain(|p| p.coefficient != 0.0);
    Some(sum)
}

fn split_term_into_waves(ring: &Ring, term: &Term, mask: Monomial) -> SineCosineProduct {
    let mut waves = Vec::new();
    for (atom, power) in term.monomial.restrict_to_mask(mask).atoms_with_powers() {
        if let Atom::Wave(wave) = &ring.atoms[atom] {
            waves.extend((0..power).map(|_| *wave));
        }
    }
    waves.sort_unstable();
    SineCosineProduct { waves, coefficient: term.coefficient }
}

/// Returns the length of a sum: number of terms, number of multiple angles, number of sines and cosines. Sums
/// are compared in this order.
fn sum_complexity(products: &[SineCosineProduct]) -> (usize, usize, usize) {
    let waves_of_products = || products.iter().flat_map(|p| &p.waves);
    let multiples = waves_of_products().filter(|w| w.angle.iter().any(|n| n.abs() > 1)).count();
    (products.len(), multiples, waves_of_products().count())
}

/// Merges pairs of products until no two of them can be merged.
fn merge_product_pairs(
    ring: &mut Ring,
    mut products: Vec<SineCosineProduct>,
) -> Option<Vec<SineCosineProduct>> {
    'again: loop {
        for j in 1..products.len() {
            for i in 0..j {
                ring.spend_steps(1)?;
                let Some(both) = sum_as_single_product(&products[i], &products[j]) else { continue };
                products.remove(j);
                products.remove(i);
                if both.coefficient != 0.0 {
                    products.push(both);
                }
                continue 'again;
            }
        }
        return Some(products);
    }
}

/// Returns the sum of two products if the sum is a single product.
fn sum_as_single_product(a: &SineCosineProduct, b: &SineCosineProduct) -> Option<SineCosineProduct> {
    let ratio = b.coefficient / a.coefficient;
    if a.waves == b.waves {
        let coefficient = if is_close(ratio, -1.0) { 0.0 } else { a.coefficient + b.coefficient };
        return Some(SineCosineProduct { waves: a.waves.clone(), coefficient });
    }
    if ![1.0, -1.0, -2.0, -0.5].iter().any(|r| is_close(ratio, *r)) {
        return None;
    }
    let (mut common, x, y) = split_common_waves(&a.waves, &b.waves)?;
    let (sum, coefficient) = match apply_sum_rule(&x, &y, ratio) {
        Some((sum, factor)) => (sum, factor * a.coefficient),
        None => {
            let (sum, factor) = apply_sum_rule(&y, &x, 1.0 / ratio)?;
            (sum, factor * b.coefficient)
        }
    };
    common.extend(sum);
    common.sort_unstable();
    Some(SineCosineProduct { waves: common, coefficient })
}

fn is_close(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * b.abs()
}

/// Splits two products into their common waves and the remaining waves of each. `None` if more than two waves
/// of either remain.
fn split_common_waves(a: &[Wave], b: &[Wave]) -> Option<(Vec<Wave>, Vec<Wave>, Vec<Wave>)> {
    let (mut common, mut x, mut y) = (Vec::new(), Vec::new(), b.to_vec());
    for wave in a {
        match y.iter().position(|w| w == wave) {
            Some(k) => common.push(y.remove(k)),
            None => x.push(*wave),
        }
    }
    (x.len() <= 2 && y.len() <= 2).then_some((common, x, y))
}

/// Returns `x + ratio y` as a product of waves and a factor, if a rule covers it.
fn apply_sum_rule(x: &[Wave], y: &[Wave], ratio: f64) -> Option<(Vec<Wave>, f64)> {
    let has_coefficient_ratio = |r: f64| is_close(ratio, r);
    match (x, y) {
        ([], [a, b]) if a == b && has_coefficient_ratio(-1.0) => {
            Some((vec![Wave { cosine: !a.cosine, ..*a }; 2], 1.0))
        }
        ([], [a, b]) if a == b && has_coefficient_ratio(-2.0) => {
            let sign = if a.cosine { -1.0 } else { 1.0 };
            Some(normalised_wave(true, signed_sum_of_wave_angles(a, b, 1), sign))
        }
        ([], [a]) if a.cosine => {
            apply_sum_to_product_rule(&Wave { angle: [0; ANGLES], cosine: true }, a, ratio)
        }
        ([a], [b]) if a.cosine == b.cosine => apply_sum_to_product_rule(a, b, ratio),
        ([a, b], [c, d]) => apply_angle_addition_rule([a, b], [c, d], ratio),
        _ => None,
    }
}

/// Applies `cos a cos b ± sin a sin b = cos(a ∓ b)` or `sin a cos b ± cos a sin b = sin(a ± b)`.
fn apply_angle_addition_rule([a, b]: [&Wave; 2], [c, d]: [&Wave; 2], ratio: f64) -> Option<(Vec<Wave>, f64)> {
    let sign = [1, -1].into_iter().find(|s| is_close(ratio, f64::from(*s)))?;
    let (first, second) = if a.angle == c.angle { (c, d) } else { (d, c) };
    let are_sine_and_cosine_of_same_angle = |a: &Wave, b: &Wave| a.angle == b.angle && a.cosine != b.cosine;
    if !are_sine_and_cosine_of_same_angle(a, first) || !are_sine_and_cosine_of_same_angle(b, second) {
        return None;
    }
    match (a.cosine, b.cosine) {
        (true, true) => Some(normalised_wave(true, signed_sum_of_wave_angles(a, b, -sign), 1.0)),
        (false, true) => Some(normalised_wave(false, signed_sum_of_wave_angles(a, b, sign), 1.0)),
        (true, false) => Some(normalised_wave(false, signed_sum_of_wave_angles(b, a, sign), 1.0)),
        // With two sines first, `combined` applies the rule with the products exchanged.
        (false, false) => None,
    }
}

/// Applies `cos a + cos b = 2 cos((a+b)/2) cos((a−b)/2)` or the corresponding rules for differences and
/// sines. `None` if the half angles are not integer multiples.
fn apply_sum_to_product_rule(a: &Wave, b: &Wave, ratio: f64) -> Option<(Vec<Wave>, f64)> {
    let sign = [1, -1].into_iter().find(|s| is_close(ratio, f64::from(*s)))?;
    let (up, down) = (signed_sum_of_wave_angles(a, b, 1), signed_sum_of_wave_angles(a, b, -1));
    if up.iter().any(|n| n % 2 != 0) {
        return None;
    }
    let halved_angle_multiples = |angle: [i8; ANGLES]| angle.map(|n| n / 2);
    let ((first, up), (second, down), factor) = match (a.cosine, sign) {
        (true, 1) => ((true, up), (true, down), 2.0),
        (true, _) => ((false, up), (false, down), -2.0),
        (false, 1) => ((false, up), (true, down), 2.0),
        (false, _) => ((true, up), (false, down), 2.0),
    };
    let (mut waves, f) = normalised_wave(first, halved_angle_multiples(up), factor);
    let (more, f) = normalised_wave(second, halved_angle_multiples(down), f);
    waves.extend(more);
    waves.sort_unstable();
    Some((waves, f))
}

/// Replaces `sin 2a` by `2 sin a cos a`, which can be combined with `sin² a` and `cos² a`.
fn unfold_double_angle(mut product: SineCosineProduct) -> SineCosineProduct {
    let is_sine_of_even_angle = |w: &Wave| !w.cosine && w.angle.iter().all(|n| n % 2 == 0);
    while let Some(k) = product.waves.iter().position(is_sine_of_even_angle) {
        let angle = product.waves.remove(k).angle.map(|n| n / 2);
        product.waves.extend([Wave { angle, cosine: false }, Wave { angle, cosine: true }]);
        product.coefficient *= 2.0;
    }
    product
}

/// Returns the sum or difference of the angles of two waves.
fn signed_sum_of_wave_angles(a: &Wave, b: &Wave, sign: i8) -> [i8; ANGLES] {
    std::array::from_fn(|k| a.angle[k].saturating_add(sign * b.angle[k]))
}

/// Returns a wave with a factor, with the sign of the angle normalised so that its first multiple is
/// positive. A zero angle gives no wave, with the factor for the cosine and zero for the sine.
fn normalised_wave(cosine: bool, angle: [i8; ANGLES], factor: f64) -> (Vec<Wave>, f64) {
    match angle.iter().find(|n| **n != 0) {
        None => (Vec::new(), if cosine { factor } else { 0.0 }),
        Some(n) if *n > 0 => (vec![Wave { angle, cosine }], factor),
        Some(_) => (vec![Wave { angle: angle.map(|n| -n), cosine }], if cosine { factor } else { -factor }),
    }
}

/// Converts a sum of products to a Fourier sum, in which each product has at most one wave.
fn fourier_sum(ring: &mut Ring, products: &[SineCosineProduct]) -> Option<Vec<SineCosineProduct>> {
    let mut sum: Vec<SineCosineProduct> = Vec::new();
    for product in products {
        let mut parts = vec![SineCosineProduct { waves: Vec::new(), coefficient: product.coefficient }];
        for wave in &product.waves {
            parts = parts.iter().flat_map(|p| multiply_by_sine_or_cosine(p, wave)).collect();
        }
        ring.spend_steps(parts.len())?;
        for part in parts {
            add_product_to_sum(&mut sum, part);
        }
        ring.spend_steps(sum.len())?;
    }
    sum.retain(|p| p.coefficient != 0.0);
    Some(sum)
}

fn add_product_to_sum(sum: &mut Vec<SineCosineProduct>, part: SineCosineProduct) {
    match sum.iter_mut().find(|p| p.waves == part.waves) {
        Some(p) if is_close(p.coefficient, -part.coefficient) => p.coefficient = 0.0,
        Some(p) => p.coefficient += part.coefficient,
        None => sum.push(part),
    }
}

/// Multiplies a product of at most one wave by another wave: returns half the waves of the sum and the
/// difference of their angles.
fn multiply_by_sine_or_cosine(p: &SineCosineProduct, b: &Wave) -> Vec<SineCosineProduct> {
    let Some(a) = p.waves.first() else {
        return vec![SineCosineProduct { waves: vec![*b], coefficient: p.coefficient }];
    };
    let (up, down) = (signed_sum_of_wave_angles(a, b, 1), signed_sum_of_wave_angles(a, b, -1));
    let half = p.coefficient * 0.5;
    let parts = match (a.cosine, b.cosine) {
        (true, true) => [normalised_wave(true, up, half), normalised_wave(true, down, half)],
        (false, false) => [normalised_wave(true, up, -half), normalised_wave(true, down, half)],
        (false, true) => [normalised_wave(false, up, half), normalised_wave(false, down, half)],
        (true, false) => [normalised_wave(false, up, half), normalised_wave(false, down, -half)],
    };
    let product_with_coefficient = |(waves, coefficient)| SineCosineProduct { waves, coefficient };
    parts.into_iter().map(product_with_coefficient).filter(|p| p.coefficient != 0.0).collect()
}
