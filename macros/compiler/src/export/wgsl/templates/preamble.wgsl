struct Sizes {
    states: u32,
    first: u32, /* of the states that this dispatch computes */
    parameter_entry: u32, /* distance between parameters: 1, or the number of states */
    parameter_state: u32, /* 0 if all states share the parameters, else 1 */
}
@group(0) @binding(0) var<uniform> sizes: Sizes;
@group(0) @binding(1) var<storage, read> parameters: array<f32>;
@group(0) @binding(2) var<storage, read> arguments: array<f32>;
@group(0) @binding(3) var<storage, read_write> results: array<f32>;

fn lw_mul_add(a: f32, b: f32, c: f32) -> f32 { return fma(a, b, c); }
fn lw_mul_sub(a: f32, b: f32, c: f32) -> f32 { return fma(a, b, -c); }
fn lw_neg_mul_add(a: f32, b: f32, c: f32) -> f32 { return fma(-a, b, c); }

/* Sine and cosine to single precision for angles up to 1e4 rad: reduction by multiples of pi/2 (Cody and Waite 1980), polynomials of
 * Cephes (Moshier 1992). The functions of WGSL have an absolute error of up to 2^-11. */
fn lw_sin_cos(x: f32) -> vec2<f32> {
    let quarters = round(x * 0.63661977f);
    var r = fma(quarters, -1.5703125f, x);
    r = fma(quarters, -4.837513e-4f, r);
    r = fma(quarters, -7.54979e-8f, r);
    let z = r * r;
    let s = fma(fma(fma(-1.9515296e-4f, z, 8.3321609e-3f), z, -0.16666655f) * z, r, r);
    let c = fma(fma(fma(2.4433157e-5f, z, -1.3887316e-3f), z, 4.1666646e-2f), z * z, fma(-0.5f, z, 1.0f));
    let quadrant = i32(quarters) & 3;
    let is_odd = (quadrant & 1) == 1;
    let sine = select(s, c, is_odd);
    let cosine = select(c, s, is_odd);
    return vec2<f32>(select(sine, -sine, quadrant >= 2), select(cosine, -cosine, quadrant == 1 || quadrant == 2));
}
fn lw_sin(x: f32) -> f32 { return lw_sin_cos(x).x; }
fn lw_cos(x: f32) -> f32 { return lw_sin_cos(x).y; }

/* Powers, also of negative numbers with whole exponents. */
fn lw_pow(a: f32, b: f32) -> f32 {
    let magnitude = pow(abs(a), b);
    let is_odd = fract(abs(b) * 0.5f) == 0.5f;
    return select(magnitude, -magnitude, a < 0.0f && is_odd);
}

/* One with the sign of a number, also of zeros. */
fn lw_signum(x: f32) -> f32 {
    return select(1.0f, -1.0f, (bitcast<u32>(x) >> 31u) == 1u);
}
