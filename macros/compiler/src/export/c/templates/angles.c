/* Returns sine and cosine, without branches for angles up to 1e5 rad: argument reduction by multiples of pi/2 (Cody and Waite),
 * polynomials of fdlibm (Sun Microsystems 1993). The reduction requires exactly rounded operations. Compilers that reorder sums,
 * or use excess precision, use the library functions instead. */
#if defined(__FAST_MATH__) || !defined(FLT_EVAL_METHOD) || FLT_EVAL_METHOD != 0 || defined(PLAIN_ANGLES)
static inline void lw_sin_cos(double x, double *s, double *c) {
    *s = sin(x);
    *c = cos(x);
}
#else
#define ROUND 6755399441055744.0
static inline void lw_small_sin_cos(double x, double *s, double *c) {
    const double shifted = lw_mul_add(x, 0.63661977236758134308, ROUND);
    const double quarters = shifted - ROUND;
#ifdef FP_FAST_FMA
    const double first = lw_neg_mul_add(quarters, 1.57079632679489661923, x);
    const double r = lw_neg_mul_add(quarters, 6.123233995707727e-17, first);
    const double rest = lw_neg_mul_add(quarters, 6.123233995707727e-17, first - r);
    const double low = lw_neg_mul_add(quarters, 2.9038559739793605e-28, rest);
#else
    const double first = x - quarters * 1.5707963267341256;
    const double second = quarters * 6.077100506303966e-11;
    const double r = first - second;
    const double low = ((first - r) - second) - quarters * 2.0222662487959506e-21;
#endif
    const double z = r * r;
    const double square = z * z;
    const double fourth = square * square;
    const double sine_low = lw_mul_add(-1.98412698298579493134e-4, z, 8.33333333332248946124e-3);
    const double sine_high = lw_mul_add(-2.50507602534068634195e-8, z, 2.75573137070700676789e-6);
    const double sine_part = lw_mul_add(fourth, 1.58969099521155010221e-10, lw_mul_add(sine_high, square, sine_low));
    const double sine = lw_mul_add(z, sine_part, -1.66666666666666324348e-1);
    const double cosine_low = lw_mul_add(-1.38888888888741095749e-3, z, 4.16666666666666019037e-2);
    const double cosine_high = lw_mul_add(-2.75573143513906633035e-7, z, 2.48015872894767294178e-5);
    const double cosine_last = lw_mul_add(-1.13596475577881948265e-11, z, 2.08757232129817482790e-9);
    const double cosine = lw_mul_add(fourth, cosine_last, lw_mul_add(cosine_high, square, cosine_low));
#ifdef FP_FAST_FMA
    const double sin_r = r + lw_mul_add(r * z, sine, low);
    const double fallen = lw_mul_sub(r, lw_mul_add(z, cosine, -0.5), low);
    const double cos_r = lw_mul_add(r, fallen, 1.0);
#else
    const double half = 0.5 * z;
    const double sin_r = r + (r * z * sine + (low - low * half));
    const double most = 1.0 - half;
    const double lost = (1.0 - most) - half;
    const double cos_r = most + (square * cosine + (lost - r * low));
#endif
    /* In odd quadrants, sine and cosine are exchanged; bits of the quadrant determine their signs. */
    uint64_t quadrant, s_bits, c_bits;
    memcpy(&quadrant, &shifted, sizeof quadrant);
    memcpy(&s_bits, &sin_r, sizeof s_bits);
    memcpy(&c_bits, &cos_r, sizeof c_bits);
    const uint64_t exchange = (s_bits ^ c_bits) & (0 - (quadrant & 1));
    s_bits ^= exchange ^ ((quadrant >> 1) << 63);
    c_bits ^= exchange ^ (((quadrant + 1) >> 1) << 63);
    memcpy(s, &s_bits, sizeof s_bits);
    memcpy(c, &c_bits, sizeof c_bits);
}

static inline void lw_sin_cos(double x, double *s, double *c) {
    if (fabs(x) > 1e5) {
        *s = sin(x);
        *c = cos(x);
    } else {
        lw_small_sin_cos(x, s, c);
    }
}
#endif
