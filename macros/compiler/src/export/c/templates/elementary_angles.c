//// lw_bits
/* Elementary functions with the same bits on every machine: those of FreeBSD's msun, as in the Rust crate libm.
 * Copyright (C) 1993, 2004 by Sun Microsystems, Inc. All rights reserved. Permission to use, copy, modify, and distribute this
 * software is freely granted, provided that this notice is preserved. */
static inline uint64_t lw_bits(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double lw_number(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}
//// lw_high
/* The upper half of the bits of a number. */
static inline uint32_t lw_high(double x) {
    return (uint32_t)(lw_bits(x) >> 32);
}
//// lw_upper
/* A number without the lower half of its bits. */
static inline double lw_upper(double x) {
    return lw_number(lw_bits(x) & 0xffffffff00000000u);
}
//// lw_scaled
/* Returns x 2^n. */
static double lw_scaled(double x, int n) {
    if (n > 1023) {
        x *= 0x1p1023;
        n -= 1023;
        if (n > 1023) {
            x *= 0x1p1023;
            n = n - 1023 > 1023 ? 1023 : n - 1023;
        }
    } else if (n < -1022) {
        x *= 0x1p-1022 * 0x1p53;
        n += 1022 - 53;
        if (n < -1022) {
            x *= 0x1p-1022 * 0x1p53;
            n = n + 1022 - 53 < -1022 ? -1022 : n + 1022 - 53;
        }
    }
    return x * lw_number((uint64_t)(1023 + n) << 52);
}
//// lw_reduced_large
/* 2/pi in digits of 24 bits. */
static const int32_t lw_digits[66] = {
    0xA2F983, 0x6E4E44, 0x1529FC, 0x2757D1, 0xF534DD, 0xC0DB62, 0x95993C, 0x439041, 0xFE5163, 0xABDEBB, 0xC561B7,
    0x246E3A, 0x424DD2, 0xE00649, 0x2EEA09, 0xD1921C, 0xFE1DEB, 0x1CB129, 0xA73EE8, 0x8235F5, 0x2EBB44, 0x84E99C,
    0x7026B4, 0x5F7E41, 0x3991D6, 0x398353, 0x39F49C, 0x845F8B, 0xBDF928, 0x3B1FF8, 0x97FFDE, 0x05980F, 0xEF2F11,
    0x8B5A0A, 0x6D1F6D, 0x367ECF, 0x27CB09, 0xB74F46, 0x3F669E, 0x5FEA2D, 0x7527BA, 0xC7EBE5, 0xF17B3D, 0x0739F7,
    0x8A5292, 0xEA6BFB, 0x5FB11F, 0x8D5D08, 0x560330, 0x46FC7B, 0x6BABF0, 0xCFBC20, 0x9AF436, 0x1DA9E3, 0x91615E,
    0xE61B08, 0x659985, 0x5F14A0, 0x68408D, 0xFFD880, 0x4D7327, 0x310606, 0x1556CA, 0x73A8C9, 0x60E27B, 0xC08C6B};

/* Returns digit i of the product of 2/pi and the digits of x, before carries. */
static double lw_product_digit(const double *x, int jx, int jv, int i) {
    double sum = 0.0;
    for (int j = 0; j <= jx; ++j) {
        const int at = jv + i - j;
        sum += x[j] * (at < 0 ? 0.0 : (double)lw_digits[at]);
    }
    return sum;
}

/* Replaces a fraction in digits of 24 bits by its difference from one. Returns whether the fraction was nonzero. */
static int lw_complement(int32_t *digits, int count, int q0) {
    int carry = 0;
    for (int i = 0; i < count; ++i) {
        if (carry) {
            digits[i] = 0xffffff - digits[i];
        } else if (digits[i] != 0) {
            carry = 1;
            digits[i] = 0x1000000 - digits[i];
        }
    }
    if (q0 == 1) {
        digits[count - 1] &= 0x7fffff;
    } else if (q0 == 2) {
        digits[count - 1] &= 0x3fffff;
    }
    return carry;
}

/* Multiplies a fraction in digits of 24 bits, the last of which has the exponent q0, by pi/2. */
static void lw_multiply_by_right_angle(const int32_t *digits, int count, int q0, double sign, double y[2]) {
    static const double parts[5] = {1.57079625129699707031e+00, 7.54978941586159635335e-08, 5.39030252995776476554e-15,
        3.28200341580791294123e-22, 1.27065575308067607349e-29};
    double q[20] = {0.0}, terms[20] = {0.0}, sum = 0.0, scale = lw_scaled(1.0, q0);
    for (int i = count - 1; i >= 0; --i) {
        q[i] = scale * (double)digits[i];
        scale *= 0x1p-24;
    }
    for (int i = count - 1; i >= 0; --i) {
        double term = 0.0;
        for (int k = 0; k <= 4 && k <= count - 1 - i; ++k) {
            term += parts[k] * q[i + k];
        }
        terms[count - 1 - i] = term;
    }
    for (int i = count - 1; i >= 0; --i) {
        sum += terms[i];
    }
    y[0] = sign * sum;
    sum = terms[0] - sum;
    for (int i = 1; i < count; ++i) {
        sum += terms[i];
    }
    y[1] = sign * sum;
}

/* Reduces a large angle, given as up to three integers of 24 bits, by multiples of pi/2 (Payne and Hanek). */
static int lw_reduced_large(const double *x, int count, int exponent, double y[2]) {
    const int jk = 4, jx = count - 1, jv = exponent < 27 ? 0 : (exponent - 3) / 24;
    double q[20] = {0.0}, z;
    int32_t digits[20] = {0};
    int q0 = exponent - 24 * (jv + 1), jz = jk, n, half;
    for (int i = 0; i <= jk; ++i) {
        q[i] = lw_product_digit(x, jx, jv, i);
    }
    for (;;) {
        z = q[jz];
        for (int i = 0, j = jz; j > 0; ++i, --j) {
            const double carried = (double)(int32_t)(0x1p-24 * z);
            digits[i] = (int32_t)(z - 0x1p24 * carried);
            z = q[j - 1] + carried;
        }
        z = lw_scaled(z, q0);
        z -= 8.0 * floor(z * 0.125);
        n = (int)z;
        z -= (double)n;
        half = 0;
        if (q0 > 0) {
            const int32_t whole = digits[jz - 1] >> (24 - q0);
            n += whole;
            digits[jz - 1] -= whole << (24 - q0);
            half = digits[jz - 1] >> (23 - q0);
        } else if (q0 == 0) {
            half = digits[jz - 1] >> 23;
        } else if (z >= 0.5) {
            half = 2;
        }
        if (half > 0) {
            n += 1;
            const int carry = lw_complement(digits, jz, q0);
            if (half == 2) {
                z = 1.0 - z;
                if (carry) {
                    z -= lw_scaled(1.0, q0);
                }
            }
        }
        int32_t rest = 0;
        for (int i = jz - 1; i >= jk; --i) {
            rest |= digits[i];
        }
        if (z != 0.0 || rest != 0) {
            break;
        }
        int more = 1;
        while (digits[jk - more] == 0) {
            ++more;
        }
        for (int i = jz + 1; i <= jz + more; ++i) {
            q[i] = lw_product_digit(x, jx, jv, i);
        }
        jz += more;
    }
    if (z == 0.0) {
        do {
            --jz;
            q0 -= 24;
        } while (digits[jz] == 0);
    } else {
        z = lw_scaled(z, -q0);
        if (z >= 0x1p24) {
            const double carried = (double)(int32_t)(0x1p-24 * z);
            digits[jz] = (int32_t)(z - 0x1p24 * carried);
            ++jz;
            q0 += 24;
            z = carried;
        }
        digits[jz] = (int32_t)z;
    }
    lw_multiply_by_right_angle(digits, jz + 1, q0, half == 0 ? 1.0 : -1.0, y);
    return n & 7;
}
//// lw_reduced
/* Returns the quadrant of an angle beyond pi/4, and the rest as the sum of two numbers. */
static int lw_reduced(double x, double y[2]) {
    const double first = 1.57079632673412561417e+00, first_rest = 6.07710050650619224932e-11;
    const uint32_t ix = lw_high(x) & 0x7fffffff;
    const double sign = lw_bits(x) >> 63 ? -1.0 : 1.0;
    if (ix <= 0x401c463b && (ix & 0xfffff) != 0x921fb && ix != 0x4012d97c) {
        const double n = ix <= 0x4002d97c ? 1.0 : (ix <= 0x400f6a7a ? 2.0 : (ix <= 0x4015fdbc ? 3.0 : 4.0));
        const double z = x - sign * (n * first);
        y[0] = z - sign * (n * first_rest);
        y[1] = (z - y[0]) - sign * (n * first_rest);
        return (int)(sign * n);
    }
    if (ix < 0x413921fb) {
        const double n = (x * 6.36619772367581382433e-01 + 0x1.8p52) - 0x1.8p52;
        const int ex = (int)(ix >> 20);
        double r = x - n * first, w = n * first_rest;
        y[0] = r - w;
        if (ex - (int)(lw_high(y[0]) >> 20 & 0x7ff) > 16) {
            double t = r;
            w = n * 6.07710050630396597660e-11;
            r = t - w;
            w = n * 2.02226624879595063154e-21 - ((t - r) - w);
            y[0] = r - w;
            if (ex - (int)(lw_high(y[0]) >> 20 & 0x7ff) > 49) {
                t = r;
                w = n * 2.02226624871116645580e-21;
                r = t - w;
                w = n * 8.47842766036889956997e-32 - ((t - r) - w);
                y[0] = r - w;
            }
        }
        y[1] = (r - y[0]) - w;
        return (int)n;
    }
    if (ix >= 0x7ff00000) {
        y[0] = y[1] = x - x;
        return 0;
    }
    double z = lw_number((lw_bits(x) & 0x000fffffffffffffu) | (uint64_t)(0x3ff + 23) << 52), digits[3];
    for (int i = 0; i < 2; ++i) {
        digits[i] = (double)(int32_t)z;
        z = (z - digits[i]) * 0x1p24;
    }
    digits[2] = z;
    int count = 3;
    while (count > 1 && digits[count - 1] == 0.0) {
        --count;
    }
    const int n = lw_reduced_large(digits, count, (int)(ix >> 20) - (0x3ff + 23), y);
    if (sign < 0.0) {
        y[0] = -y[0];
        y[1] = -y[1];
        return -n;
    }
    return n;
}
//// lw_kernel_sin
/* Sine of x + y between -pi/4 and pi/4. */
static double lw_kernel_sin(double x, double y, int has_rest) {
    const double z = x * x;
    const double w = z * z;
    const double r = 8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * 2.75573137070700676789e-06)
        + z * w * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10);
    const double v = z * x, s1 = -1.66666666666666324348e-01;
    return has_rest ? x - ((z * (0.5 * y - v * r) - y) - v * s1) : x + v * (s1 + z * r);
}
//// lw_kernel_cos
/* Cosine of x + y between -pi/4 and pi/4. */
static double lw_kernel_cos(double x, double y) {
    const double z = x * x;
    const double w = z * z;
    const double r = z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * 2.48015872894767294178e-05))
        + w * w * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11));
    const double half = 0.5 * z;
    const double most = 1.0 - half;
    return most + (((1.0 - most) - half) + (z * r - x * y));
}
//// lw_sin
static double lw_sin(double x) {
    const uint32_t ix = lw_high(x) & 0x7fffffff;
    double y[2];
    if (ix <= 0x3fe921fb) {
        return ix < 0x3e500000 ? x : lw_kernel_sin(x, 0.0, 0);
    }
    if (ix >= 0x7ff00000) {
        return x - x;
    }
    const int n = lw_reduced(x, y) & 3;
    const double value = n & 1 ? lw_kernel_cos(y[0], y[1]) : lw_kernel_sin(y[0], y[1], 1);
    return n & 2 ? -value : value;
}
//// lw_cos
static double lw_cos(double x) {
    const uint32_t ix = lw_high(x) & 0x7fffffff;
    double y[2];
    if (ix <= 0x3fe921fb) {
        return ix < 0x3e46a09e ? 1.0 : lw_kernel_cos(x, 0.0);
    }
    if (ix >= 0x7ff00000) {
        return x - x;
    }
    const int n = lw_reduced(x, y) & 3;
    const double value = n & 1 ? lw_kernel_sin(y[0], y[1], 1) : lw_kernel_cos(y[0], y[1]);
    return n == 1 || n == 2 ? -value : value;
}
//// lw_tan
static double lw_kernel_tan(double x, double y, int odd) {
    static const double c[13] = {3.33333333333334091986e-01, 1.33333333333201242699e-01, 5.39682539762260521377e-02,
        2.18694882948595424599e-02, 8.86323982359930005737e-03, 3.59207910759131235356e-03, 1.45620945432529025516e-03,
        5.88041240820264096874e-04, 2.46463134818469906812e-04, 7.81794442939557092300e-05, 7.14072491382608190305e-05,
        -1.85586374855275456654e-05, 2.59073051863633712884e-05};
    const uint32_t hx = lw_high(x);
    const int big = (hx & 0x7fffffff) >= 0x3fe59428;
    if (big) {
        if (hx >> 31) {
            x = -x;
            y = -y;
        }
        x = (7.85398163397448278999e-01 - x) + (3.06161699786838301793e-17 - y);
        y = 0.0;
    }
    const double z = x * x;
    double w = z * z;
    double r = c[1] + w * (c[3] + w * (c[5] + w * (c[7] + w * (c[9] + w * c[11]))));
    double v = z * (c[2] + w * (c[4] + w * (c[6] + w * (c[8] + w * (c[10] + w * c[12])))));
    const double s = z * x;
    r = y + z * (s * (r + v) + y) + s * c[0];
    w = x + r;
    if (big) {
        const double sign = 1.0 - 2.0 * (double)odd;
        v = sign - 2.0 * (x + (r - w * w / (w + sign)));
        return hx >> 31 ? -v : v;
    }
    if (!odd) {
        return w;
    }
    const double w0 = lw_upper(w);
    v = r - (w0 - x);
    const double a = -1.0 / w;
    const double a0 = lw_upper(a);
    return a0 + a * (1.0 + a0 * w0 + a0 * v);
}

static double lw_tan(double x) {
    const uint32_t ix = lw_high(x) & 0x7fffffff;
    double y[2];
    if (ix <= 0x3fe921fb) {
        return ix < 0x3e400000 ? x : lw_kernel_tan(x, 0.0, 0);
    }
    if (ix >= 0x7ff00000) {
        return x - x;
    }
    const int n = lw_reduced(x, y);
    return lw_kernel_tan(y[0], y[1], n & 1);
}
//// lw_kernel_asin
/* Remainder of the arc sine of the square root of z, beyond its first term. */
static double lw_kernel_asin(double z) {
    const double p = z * (1.66666666666666657415e-01 + z * (-3.25565818622400915405e-01 + z * (2.01212532134862925881e-01
        + z * (-4.00555345006794114027e-02 + z * (7.91534994289814532176e-04 + z * 3.47933107596021167570e-05)))));
    const double q = 1.0 + z * (-2.40339491173441421878e+00 + z * (2.02094576023350569471e+00
        + z * (-6.88283971605453293030e-01 + z * 7.70381505559019352791e-02)));
    return p / q;
}
//// lw_asin
static double lw_asin(double x) {
    const double right = 1.57079632679489655800e+00, rest = 6.12323399573676603587e-17;
    const uint32_t hx = lw_high(x), ix = hx & 0x7fffffff;
    if (ix >= 0x3ff00000) {
        return fabs(x) == 1.0 ? x * right + 0x1p-120 : (x - x) / (x - x);
    }
    if (ix < 0x3fe00000) {
        return ix < 0x3e500000 && ix >= 0x00100000 ? x : x + x * lw_kernel_asin(x * x);
    }
    const double z = (1.0 - fabs(x)) * 0.5;
    const double s = sqrt(z), r = lw_kernel_asin(z);
    double angle;
    if (ix >= 0x3fef3333) {
        angle = right - (2.0 * (s + s * r) - rest);
    } else {
        const double f = lw_upper(s);
        const double c = (z - f * f) / (s + f);
        angle = 0.5 * right - (2.0 * s * r - (rest - 2.0 * c) - (0.5 * right - 2.0 * f));
    }
    return hx >> 31 ? -angle : angle;
}
//// lw_acos
static double lw_acos(double x) {
    const double right = 1.57079632679489655800e+00, rest = 6.12323399573676603587e-17;
    const uint32_t hx = lw_high(x), ix = hx & 0x7fffffff;
    if (ix >= 0x3ff00000) {
        return x == 1.0 ? 0.0 : (x == -1.0 ? 2.0 * right + 0x1p-120 : (x - x) / (x - x));
    }
    if (ix < 0x3fe00000) {
        return ix <= 0x3c600000 ? right + 0x1p-120 : right - (x - (rest - x * lw_kernel_asin(x * x)));
    }
    if (hx >> 31) {
        const double z = (1.0 + x) * 0.5;
        const double s = sqrt(z);
        const double w = lw_kernel_asin(z) * s - rest;
        return 2.0 * (right - (s + w));
    }
    const double z = (1.0 - x) * 0.5;
    const double s = sqrt(z);
    const double f = lw_upper(s);
    const double c = (z - f * f) / (s + f);
    const double w = lw_kernel_asin(z) * s + c;
    return 2.0 * (f + w);
}
//// lw_atan
static double lw_atan(double x) {
    static const double high[4] = {4.63647609000806093515e-01, 7.85398163397448278999e-01, 9.82793723247329054082e-01,
        1.57079632679489655800e+00};
    static const double low[4] = {2.26987774529616870924e-17, 3.06161699786838301793e-17, 1.39033110312309984516e-17,
        6.12323399573676603587e-17};
    static const double c[11] = {3.33333333333329318027e-01, -1.99999999998764832476e-01, 1.42857142725034663711e-01,
        -1.11111104054623557880e-01, 9.09088713343650656196e-02, -7.69187620504482999495e-02, 6.66107313738753120669e-02,
        -5.83357013379057348645e-02, 4.97687799461593236017e-02, -3.65315727442169155270e-02, 1.62858201153657823623e-02};
    const uint32_t hx = lw_high(x), ix = hx & 0x7fffffff;
    int id = -1;
    if (ix >= 0x44100000) {
        return x != x ? x : (hx >> 31 ? -high[3] : high[3]);
    }
    if (ix < 0x3fdc0000) {
        if (ix < 0x3e400000) {
            return x;
        }
    } else {
        x = fabs(x);
        if (ix < 0x3fe60000) {
            id = 0;
            x = (2.0 * x - 1.0) / (2.0 + x);
        } else if (ix < 0x3ff30000) {
            id = 1;
            x = (x - 1.0) / (x + 1.0);
        } else if (ix < 0x40038000) {
            id = 2;
            x = (x - 1.5) / (1.0 + 1.5 * x);
        } else {
            id = 3;
            x = -1.0 / x;
        }
    }
    const double z = x * x;
    const double w = z * z;
    const double s1 = z * (c[0] + w * (c[2] + w * (c[4] + w * (c[6] + w * (c[8] + w * c[10])))));
    const double s2 = w * (c[1] + w * (c[3] + w * (c[5] + w * (c[7] + w * c[9]))));
    if (id < 0) {
        return x - x * (s1 + s2);
    }
    const double angle = high[id] - (x * (s1 + s2) - low[id] - x);
    return hx >> 31 ? -angle : angle;
}
//// lw_atan2
static double lw_atan2(double y, double x) {
    const double half = 3.1415926535897931160E+00, rest = 1.2246467991473531772E-16;
    if (x != x || y != y) {
        return x + y;
    }
    if (x == 1.0) {
        return lw_atan(y);
    }
    const uint32_t ix = lw_high(x) & 0x7fffffff, iy = lw_high(y) & 0x7fffffff;
    const int below = (int)(lw_bits(y) >> 63), behind = (int)(lw_bits(x) >> 63);
    double angle;
    if (y == 0.0) {
        angle = behind ? half : 0.0;
    } else if (x == 0.0) {
        angle = half / 2.0;
    } else if (ix == 0x7ff00000) {
        angle = iy == 0x7ff00000 ? (behind ? 3.0 * half / 4.0 : half / 4.0) : (behind ? half : 0.0);
    } else if (ix + (64 << 20) < iy || iy == 0x7ff00000) {
        angle = half / 2.0;
    } else {
        angle = behind && iy + (64 << 20) < ix ? 0.0 : lw_atan(fabs(y / x));
        angle = behind ? half - (angle - rest) : angle;
    }
    return below ? -angle : angle;
}
