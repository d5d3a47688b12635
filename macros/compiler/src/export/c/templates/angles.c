//// lw_sin_cos
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
//// lw_sin_cos_4
/* Four sines and cosines at a time, which compilers vectorise. With AVX2 and FMA, intrinsics replace this loop, so that angles and
 * results stay in registers; the operations are those of `lw_small_sin_cos`. */
#if defined(ROUND) && defined(FP_FAST_FMA) && defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#define ALL(x) _mm256_set1_pd(x)
#define MUL(a, b) _mm256_mul_pd(a, b)
#define MUL_ADD(a, b, c) _mm256_fmadd_pd(a, b, c)
#define MUL_SUB(a, b, c) _mm256_fmsub_pd(a, b, c)
#define NEG_MUL_ADD(a, b, c) _mm256_fnmadd_pd(a, b, c)
#define BITS(a) _mm256_castpd_si256(a)
#define NUMBERS(a) _mm256_castsi256_pd(a)
#ifdef __GNUC__
#define INLINED __attribute__((always_inline))
#else
#define INLINED
#endif
static void lw_large_sin_cos_4(const double x[4], double s[4], double c[4]) {
    for (int k = 0; k < 4; ++k) {
        lw_sin_cos(x[k], &s[k], &c[k]);
    }
}
INLINED static inline void lw_sin_cos_4(const double x[4], double s[4], double c[4]) {
    const __m256d angles = _mm256_set_pd(x[3], x[2], x[1], x[0]);
    const __m256d sizes = _mm256_andnot_pd(ALL(-0.0), angles);
    if (_mm256_movemask_pd(_mm256_cmp_pd(sizes, ALL(1e5), _CMP_LE_OQ)) != 15) {
        lw_large_sin_cos_4(x, s, c);
        return;
    }
    const __m256d shifted = MUL_ADD(angles, ALL(0.63661977236758134308), ALL(ROUND));
    const __m256d quarters = _mm256_sub_pd(shifted, ALL(ROUND));
    const __m256d first = NEG_MUL_ADD(quarters, ALL(1.57079632679489661923), angles);
    const __m256d r = NEG_MUL_ADD(quarters, ALL(6.123233995707727e-17), first);
    const __m256d rest = NEG_MUL_ADD(quarters, ALL(6.123233995707727e-17), _mm256_sub_pd(first, r));
    const __m256d low = NEG_MUL_ADD(quarters, ALL(2.9038559739793605e-28), rest);
    const __m256d z = MUL(r, r);
    const __m256d square = MUL(z, z);
    const __m256d fourth = MUL(square, square);
    const __m256d sine_low = MUL_ADD(ALL(-1.98412698298579493134e-4), z, ALL(8.33333333332248946124e-3));
    const __m256d sine_high = MUL_ADD(ALL(-2.50507602534068634195e-8), z, ALL(2.75573137070700676789e-6));
    const __m256d sine_part = MUL_ADD(fourth, ALL(1.58969099521155010221e-10), MUL_ADD(sine_high, square, sine_low));
    const __m256d sine = MUL_ADD(z, sine_part, ALL(-1.66666666666666324348e-1));
    const __m256d cosine_low = MUL_ADD(ALL(-1.38888888888741095749e-3), z, ALL(4.16666666666666019037e-2));
    const __m256d cosine_high = MUL_ADD(ALL(-2.75573143513906633035e-7), z, ALL(2.48015872894767294178e-5));
    const __m256d cosine_last = MUL_ADD(ALL(-1.13596475577881948265e-11), z, ALL(2.08757232129817482790e-9));
    const __m256d cosine = MUL_ADD(fourth, cosine_last, MUL_ADD(cosine_high, square, cosine_low));
    const __m256d sin_r = _mm256_add_pd(r, MUL_ADD(MUL(r, z), sine, low));
    const __m256d fallen = MUL_SUB(r, MUL_ADD(z, cosine, ALL(-0.5)), low);
    const __m256d cos_r = MUL_ADD(r, fallen, ALL(1.0));
    const __m256i one = _mm256_set1_epi64x(1);
    const __m256i quadrant = BITS(shifted);
    const __m256i next = _mm256_add_epi64(quadrant, one);
    const __m256i odd = _mm256_sub_epi64(_mm256_setzero_si256(), _mm256_and_si256(quadrant, one));
    const __m256i exchange = _mm256_and_si256(_mm256_xor_si256(BITS(sin_r), BITS(cos_r)), odd);
    const __m256i s_sign = _mm256_slli_epi64(_mm256_srli_epi64(quadrant, 1), 63);
    const __m256i c_sign = _mm256_slli_epi64(_mm256_srli_epi64(next, 1), 63);
    _mm256_storeu_pd(s, NUMBERS(_mm256_xor_si256(_mm256_xor_si256(BITS(sin_r), exchange), s_sign)));
    _mm256_storeu_pd(c, NUMBERS(_mm256_xor_si256(_mm256_xor_si256(BITS(cos_r), exchange), c_sign)));
}
#undef INLINED
#undef ALL
#undef MUL
#undef MUL_ADD
#undef MUL_SUB
#undef NEG_MUL_ADD
#undef BITS
#undef NUMBERS
#else
static inline void lw_sin_cos_4(const double x[4], double s[4], double c[4]) {
#ifdef ROUND
    double sines[4], cosines[4];
    int large = 0;
    for (int k = 0; k < 4; ++k) {
        large |= !(fabs(x[k]) <= 1e5);
    }
    if (!large) {
        for (int k = 0; k < 4; ++k) {
            lw_small_sin_cos(x[k], &sines[k], &cosines[k]);
        }
        for (int k = 0; k < 4; ++k) {
            s[k] = sines[k];
            c[k] = cosines[k];
        }
        return;
    }
#endif
    for (int k = 0; k < 4; ++k) {
        lw_sin_cos(x[k], &s[k], &c[k]);
    }
}
#endif
