//// lw_exp
static double lw_exp(double x) {
    const uint32_t hx = lw_high(x) & 0x7fffffff;
    const int sign = (int)(lw_bits(x) >> 63);
    double high = x, low = 0.0;
    int k = 0;
    if (hx >= 0x4086232b) {
        if (x != x) {
            return x;
        }
        if (x > 709.782712893383973096) {
            return x * 0x1p1023;
        }
        if (x < -745.13321910194110842) {
            return 0.0;
        }
    }
    if (hx > 0x3fd62e42) {
        k = hx >= 0x3ff0a2b2 ? (int)(1.44269504088896338700e+00 * x + (sign ? -0.5 : 0.5)) : 1 - sign - sign;
        high = x - (double)k * 6.93147180369123816490e-01;
        low = (double)k * 1.90821492927058770002e-10;
        x = high - low;
    } else if (hx <= 0x3e300000) {
        return 1.0 + x;
    }
    const double square = x * x;
    const double c = x - square * (1.66666666666666019037e-01 + square * (-2.77777777770155933842e-03
        + square * (6.61375632143793436117e-05 + square * (-1.65339022054652515390e-06 + square * 4.13813679705723846039e-08))));
    const double y = 1.0 + (x * c / (2.0 - c) - low + high);
    return k == 0 ? y : lw_scaled(y, k);
}
//// lw_expm1
static double lw_expm1(double x) {
    const double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
    const uint32_t hx = lw_high(x) & 0x7fffffff;
    const int sign = (int)(lw_bits(x) >> 63);
    double high, low, c = 0.0, y;
    int k = 0;
    if (hx >= 0x4043687a) {
        if (x != x) {
            return x;
        }
        if (sign) {
            return -1.0;
        }
        if (x > 7.09782712893383973096e+02) {
            return x * 0x1p1023;
        }
    }
    if (hx > 0x3fd62e42) {
        if (hx < 0x3ff0a2b2) {
            k = sign ? -1 : 1;
        } else {
            k = (int)(1.44269504088896338700e+00 * x + (sign ? -0.5 : 0.5));
        }
        high = x - (double)k * ln2_high;
        low = (double)k * ln2_low;
        x = high - low;
        c = (high - x) - low;
    } else if (hx < 0x3c900000) {
        return x;
    }
    const double half = 0.5 * x;
    const double square = x * half;
    const double r = 1.0 + square * (-3.33333333333331316428e-02 + square * (1.58730158725481460165e-03
        + square * (-7.93650757867487942473e-05 + square * (4.00821782732936239552e-06 + square * -2.01099218183624371326e-07))));
    const double t = 3.0 - r * half;
    double e = square * ((r - t) / (6.0 - x * t));
    if (k == 0) {
        return x - (x * e - square);
    }
    e = x * (e - c) - c;
    e -= square;
    if (k == -1) {
        return 0.5 * (x - e) - 0.5;
    }
    if (k == 1) {
        return x < -0.25 ? -2.0 * (e - (x + 0.5)) : 1.0 + 2.0 * (x - e);
    }
    const double power = lw_number((uint64_t)(0x3ff + k) << 52);
    if (k < 0 || k > 56) {
        y = x - e + 1.0;
        y = k == 1024 ? y * 2.0 * 0x1p1023 : y * power;
        return y - 1.0;
    }
    const double inverse = lw_number((uint64_t)(0x3ff - k) << 52);
    return (k < 20 ? x - e + (1.0 - inverse) : x - (e + inverse) + 1.0) * power;
}
//// lw_sinh
static double lw_sinh(double x) {
    const double size = fabs(x), half = lw_bits(x) >> 63 ? -0.5 : 0.5;
    const uint32_t w = lw_high(size);
    if (w < 0x40862e42) {
        const double t = lw_expm1(size);
        if (w < 0x3ff00000) {
            return w < 0x3ff00000 - (26 << 20) ? x : half * (2.0 * t - t * t / (t + 1.0));
        }
        return half * (t + t / (t + 1.0));
    }
    const double scale = 0x1p1021;
    return 2.0 * half * (lw_exp(size - lw_number(0x40962066151add8bu)) * scale * scale);
}
//// lw_cosh
static double lw_cosh(double x) {
    x = fabs(x);
    const uint32_t w = lw_high(x);
    if (w < 0x3fe62e42) {
        if (w < 0x3ff00000 - (26 << 20)) {
            return 1.0;
        }
        const double t = lw_expm1(x);
        return 1.0 + t * t / (2.0 * (1.0 + t));
    }
    const double scale = 0x1p1021;
    if (w < 0x40862e42) {
        const double t = lw_exp(x);
        return 0.5 * (t + 1.0 / t);
    }
    return lw_exp(x - lw_number(0x40962066151add8bu)) * scale * scale;
}
//// lw_tanh
static double lw_tanh(double x) {
    const double size = fabs(x);
    const uint32_t w = lw_high(size);
    double t = size;
    if (w > 0x3fe193ea) {
        t = w > 0x40340000 ? 1.0 - 0.0 / size : 1.0 - 2.0 / (lw_expm1(2.0 * size) + 2.0);
    } else if (w > 0x3fd058ae) {
        t = lw_expm1(2.0 * size);
        t = t / (t + 2.0);
    } else if (w >= 0x00100000) {
        t = lw_expm1(-2.0 * size);
        t = -t / (t + 2.0);
    }
    return lw_bits(x) >> 63 ? -t : t;
}
//// lw_log
static double lw_log(double x) {
    uint32_t hx = lw_high(x);
    int k = 0;
    if (hx < 0x00100000 || hx >> 31) {
        if (x == 0.0) {
            return -1.0 / (x * x);
        }
        if (hx >> 31) {
            return (x - x) / (x - x);
        }
        k -= 54;
        x *= 0x1p54;
        hx = lw_high(x);
    } else if (hx >= 0x7ff00000) {
        return x;
    } else if (x == 1.0) {
        return 0.0;
    }
    hx += 0x3ff00000 - 0x3fe6a09e;
    k += (int)(hx >> 20) - 0x3ff;
    hx = (hx & 0x000fffff) + 0x3fe6a09e;
    x = lw_number((uint64_t)hx << 32 | (lw_bits(x) & 0xffffffffu));
    const double f = x - 1.0;
    const double half = 0.5 * f * f;
    const double s = f / (2.0 + f);
    const double z = s * s;
    const double w = z * z;
    const double t1 = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const double t2 = z * (6.666666666666735130e-01 + w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01
        + w * 1.479819860511658591e-01)));
    const double r = t2 + t1, n = (double)k;
    return s * (half + r) + n * 1.90821492927058770002e-10 - half + f + n * 6.93147180369123816490e-01;
}
//// lw_pow
/* Returns the power of a positive number other than 1, for a finite exponent of at most 2^31: 2^(y log2(x)). */
static double lw_kernel_pow(double y, double sign, double t1, double t2) {
    const double huge = 1.0e300, tiny = 1.0e-300;
    const double y1 = lw_upper(y);
    const double p_low = (y - y1) * t1 + y * t2;
    double p_high = y1 * t1;
    double z = p_low + p_high;
    const int32_t j = (int32_t)lw_high(z);
    if (j >= 0x40900000) {
        if (z > 1024.0 || p_low + 8.0085662595372944372e-017 > z - p_high) {
            return sign * huge * huge;
        }
    } else if ((j & 0x7fffffff) >= 0x4090cc00) {
        if (z < -1075.0 || p_low <= z - p_high) {
            return sign * tiny * tiny;
        }
    }
    const int32_t i = j & 0x7fffffff;
    int32_t n = 0, k = (i >> 20) - 0x3ff;
    if (i > 0x3fe00000) {
        n = j + (0x00100000 >> (k + 1));
        k = ((n & 0x7fffffff) >> 20) - 0x3ff;
        const double t = lw_number((uint64_t)((uint32_t)n & ~(0x000fffffu >> k)) << 32);
        n = ((n & 0x000fffff) | 0x00100000) >> (20 - k);
        n = j < 0 ? -n : n;
        p_high -= t;
    }
    const double t = lw_upper(p_low + p_high);
    const double u = t * 6.93147182464599609375e-01;
    const double v = (p_low - (t - p_high)) * 6.93147180559945286227e-01 + t * -1.90465429995776804525e-09;
    z = u + v;
    const double w = v - (z - u);
    const double s = z * z;
    const double r = z - s * (1.66666666666666019037e-01 + s * (-2.77777777770155933842e-03 + s * (6.61375632143793436117e-05
        + s * (-1.65339022054652515390e-06 + s * 4.13813679705723846039e-08))));
    z = 1.0 - ((z * r) / (r - 2.0) - (w + z * w) - z);
    const int64_t high = (int64_t)lw_high(z) + (int64_t)n * 0x00100000;
    if (high < 0x00100000) {
        return sign * lw_scaled(z, n);
    }
    return sign * lw_number((uint64_t)high << 32 | (lw_bits(z) & 0xffffffffu));
}

static double lw_pow(double x, double y) {
    const double huge = 1.0e300, tiny = 1.0e-300;
    const double size = fabs(x), exponent = fabs(y);
    const int negative = (int)(lw_bits(x) >> 63), falls = (int)(lw_bits(y) >> 63);
    if (y == 0.0 || x == 1.0) {
        return 1.0;
    }
    if (x != x || y != y) {
        return x + y;
    }
    /* One for odd integers, two for even ones. */
    const int even = exponent >= 0x1p53 || floor(exponent / 2.0) * 2.0 == exponent;
    const int whole = even ? 2 : (floor(exponent) == exponent ? 1 : 0);
    if (exponent == HUGE_VAL) {
        return size == 1.0 ? 1.0 : ((size > 1.0) == !falls ? exponent : 0.0);
    }
    if (exponent == 1.0) {
        return falls ? 1.0 / x : x;
    }
    if (y == 2.0) {
        return x * x;
    }
    if (y == 0.5 && !negative) {
        return sqrt(x);
    }
    if (size == HUGE_VAL || size == 0.0 || size == 1.0) {
        const double z = falls ? 1.0 / size : size;
        if (negative && size == 1.0 && whole == 0) {
            return (z - z) / (z - z);
        }
        return negative && whole == 1 ? -z : z;
    }
    if (negative && whole == 0) {
        return (x - x) / (x - x);
    }
    const double sign = negative && whole == 1 ? -1.0 : 1.0;
    const uint32_t iy = lw_high(exponent);
    uint32_t ix = lw_high(size);
    if (iy > 0x41e00000) {
        if (iy > 0x43f00000) {
            return (ix <= 0x3fefffff) == falls ? huge * huge : tiny * tiny;
        }
        if (ix < 0x3fefffff || ix > 0x3ff00000) {
            return (ix < 0x3fefffff) == falls ? sign * huge * huge : sign * tiny * tiny;
        }
        const double t = size - 1.0;
        const double w = (t * t) * (0.5 - t * (0.3333333333333333333333 - t * 0.25));
        const double u = 1.44269502162933349609e+00 * t;
        const double v = t * 1.92596299112661746887e-08 - w * 1.44269504088896338700e+00;
        const double t1 = lw_upper(u + v);
        return lw_kernel_pow(y, sign, t1, v - (t1 - u));
    }
    double ax = size;
    int n = 0, k = 0;
    if (ix < 0x00100000) {
        ax *= 0x1p53;
        n -= 53;
        ix = lw_high(ax);
    }
    n += (int)(ix >> 20) - 0x3ff;
    const uint32_t j = ix & 0x000fffff;
    ix = j | 0x3ff00000;
    if (j > 0x3988e && j < 0xbb67a) {
        k = 1;
    } else if (j >= 0xbb67a) {
        n += 1;
        ix -= 0x00100000;
    }
    ax = lw_number((uint64_t)ix << 32 | (lw_bits(ax) & 0xffffffffu));
    const double base = k ? 1.5 : 1.0, high = k ? 5.84962487220764160156e-01 : 0.0, low = k ? 1.35003920212974897128e-08 : 0.0;
    double u = ax - base, v = 1.0 / (ax + base);
    const double ss = u * v;
    const double s_high = lw_upper(ss);
    double t_high = lw_number((uint64_t)((ix >> 1 | 0x20000000) + 0x00080000 + ((uint32_t)k << 18)) << 32);
    double t_low = ax - (t_high - base);
    const double s_low = v * ((u - s_high * t_high) - s_high * t_low);
    double s2 = ss * ss;
    double r = s2 * s2 * (5.99999999999994648725e-01 + s2 * (4.28571428578550184252e-01 + s2 * (3.33333329818377432918e-01
        + s2 * (2.72728123808534006489e-01 + s2 * (2.30660745775561754067e-01 + s2 * 2.06975017800338417784e-01)))));
    r += s_low * (s_high + ss);
    s2 = s_high * s_high;
    t_high = lw_upper(3.0 + s2 + r);
    t_low = r - ((t_high - 3.0) - s2);
    u = s_high * t_high;
    v = s_low * t_high + t_low * ss;
    const double p_high = lw_upper(u + v);
    const double p_low = v - (p_high - u);
    const double z_high = 9.61796700954437255859e-01 * p_high;
    const double z_low = -7.02846165095275826516e-09 * p_high + p_low * 9.61796693925975554329e-01 + low;
    const double t = (double)n;
    const double t1 = lw_upper(((z_high + z_low) + high) + t);
    return lw_kernel_pow(y, sign, t1, z_low - (((t1 - t) - high) - z_high));
}
//// lw_fmin
/* Minimum and maximum of numbers; a zero has the sign plus. */
static inline double lw_fmin(double x, double y) {
    return (x < y || y != y ? x : y) + 0.0;
}
//// lw_fmax
static inline double lw_fmax(double x, double y) {
    return (x > y || y != y ? x : y) + 0.0;
}
