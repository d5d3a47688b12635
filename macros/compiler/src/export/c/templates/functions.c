//// lw_signum
/* Returns one with the sign of a number, also for zeros. */
static inline double lw_signum(double x) {
    return x != x ? x : copysign(1.0, x);
}
//// lw_atmosphere
/* Returns temperature (K), pressure (Pa) and temperature gradient (K/m) of the standard atmosphere (ISO 2533:1975,
 * U.S. Standard Atmosphere 1976) at a geopotential height (m). */
static void lw_atmosphere(double h, double *temperature, double *pressure, double *rate) {
    static const double base[8] = {0.0, 11000.0, 20000.0, 32000.0, 47000.0, 51000.0, 71000.0, 84852.0};
    static const double lapse[8] = {-6.5e-3, 0.0, 1.0e-3, 2.8e-3, 0.0, -2.8e-3, -2.0e-3, 0.0};
    const double fall = 9.80665 / 287.05287;
    double t = 288.15, p = 101325.0;
    for (int k = 0; k < 8; ++k) {
        const double end = k < 7 ? base[k + 1] : HUGE_VAL;
        const double depth = fmin(h, end) - base[k];
        const double next = t + depth * lapse[k];
        p *= lapse[k] == 0.0 ? exp(-fall * depth / t) : pow(next / t, -fall / lapse[k]);
        t = next;
        if (h < end || k == 7) {
            *temperature = t;
            *pressure = p;
            *rate = lapse[k];
            return;
        }
    }
}
//// lw_isa_temperature
static double lw_isa_temperature(double h) {
    double temperature, pressure, rate;
    lw_atmosphere(h, &temperature, &pressure, &rate);
    return temperature;
}
//// lw_isa_lapse_rate
static double lw_isa_lapse_rate(double h) {
    double temperature, pressure, rate;
    lw_atmosphere(h, &temperature, &pressure, &rate);
    return rate;
}
//// lw_isa_pressure
static double lw_isa_pressure(double h) {
    double temperature, pressure, rate;
    lw_atmosphere(h, &temperature, &pressure, &rate);
    return pressure;
}
//// lw_weights_around
/* Computes the weights of the four points around the cell of an axis that contains x, for a derivative of the given order. Returns
 * the index of the cell. */
static int lw_weights_around(const double *points, int count, double x, int order, int smooth, int extrapolated,
    double weights[4]) {
    const double low = points[0], high = points[count - 1];
    const double inner = x < low ? low : (x > high ? high : x);
    int cell = 0, last = count - 2;
    while (cell < last) {
        const int middle = cell + (last - cell + 1) / 2;
        if (inner >= points[middle]) {
            cell = middle;
        } else {
            last = middle - 1;
        }
    }
    const double h = points[cell + 1] - points[cell];
    const double s = (inner - points[cell]) / h;
    double slope[4] = {0.0, -1.0 / h, 1.0 / h, 0.0};
    if (smooth) {
        const double b = cell > 0 ? points[cell] - points[cell - 1] : 0.0;
        const double a = cell + 2 < count ? points[cell + 2] - points[cell + 1] : 0.0;
        /* Slopes at both ends, times the width of the cell, from parabolas through three points (Bessel's tangents). */
        double first[4] = {0.0, -1.0, 1.0, 0.0}, second[4] = {0.0, -1.0, 1.0, 0.0};
        if (b > 0.0) {
            first[0] = -h * h / (b * (b + h));
            first[1] = (h - b) / b;
            first[2] = b / (b + h);
        } else if (a > 0.0) {
            first[1] = -(2.0 * h + a) / (h + a);
            first[2] = (h + a) / a;
            first[3] = -h * h / (a * (h + a));
        }
        if (a > 0.0) {
            second[1] = -a / (h + a);
            second[2] = (a - h) / a;
            second[3] = h * h / (a * (h + a));
        } else if (b > 0.0) {
            second[0] = h * h / (b * (h + b));
            second[1] = -(h + b) / b;
            second[2] = (2.0 * h + b) / (h + b);
        }
        /* Hermite polynomials of the value at the end and of both slopes, for each order of differentiation. */
        const double end[4] = {3.0 * s * s - 2.0 * s * s * s, 6.0 * (s - s * s), 6.0 - 12.0 * s, -12.0};
        const double m0[4] = {s * s * s - 2.0 * s * s + s, 3.0 * s * s - 4.0 * s + 1.0, 6.0 * s - 4.0, 6.0};
        const double m1[4] = {s * s * s - s * s, 3.0 * s * s - 2.0 * s, 6.0 * s - 2.0, 6.0};
        double scale = 1.0;
        for (int k = 0; k < order; ++k) {
            scale /= h;
        }
        for (int k = 0; k < 4; ++k) {
            const double value = k == 1 ? (order == 0 ? 1.0 - end[0] : -end[order]) : (k == 2 ? end[order] : 0.0);
            weights[k] = scale * (value + m0[order] * first[k] + m1[order] * second[k]);
            slope[k] = ((k == 1 ? -end[1] : (k == 2 ? end[1] : 0.0)) + m0[1] * first[k] + m1[1] * second[k]) / h;
        }
    } else {
        for (int k = 0; k < 4; ++k) {
            weights[k] = order == 1 ? slope[k] : 0.0;
        }
        if (order == 0) {
            weights[1] = 1.0 - s;
            weights[2] = s;
        }
    }
    const int within = x >= low && x <= high;
    for (int k = 0; k < 4; ++k) {
        if (order == 0 && extrapolated) {
            weights[k] += (x - inner) * slope[k];
        } else if (order > 1 || (order == 1 && !extrapolated)) {
            weights[k] = x != x ? x : (within ? weights[k] : 0.0);
        }
    }
    return cell;
}
//// lw_tabulated
/* Returns the derivative of a table with respect to its variables, with the given orders. */
static double lw_tabulated(const @PREFIX@_table *table, int variables, const double *x, const int *orders) {
    double weights[3][4] = {{0.0, 1.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}};
    int cells[3] = {0, 0, 0}, counts[3] = {1, 1, 1};
    for (int k = 0; k < variables; ++k) {
        counts[k] = table->points[k];
        cells[k] = lw_weights_around(table->axes[k], counts[k], x[k], orders[k], table->smooth, table->extrapolated,
            weights[k]);
    }
    double sum = 0.0;
    for (int a = 0; a < 4; ++a) {
        const int i = cells[0] + a - 1;
        for (int b = 0; b < 4 && i >= 0 && i < counts[0]; ++b) {
            const int j = cells[1] + b - 1;
            for (int c = 0; c < 4 && j >= 0 && j < counts[1]; ++c) {
                const int k = cells[2] + c - 1;
                if (k >= 0 && k < counts[2]) {
                    sum += weights[0][a] * weights[1][b] * weights[2][c]
                        * table->values[(i * counts[1] + j) * counts[2] + k];
                }
            }
        }
    }
    return sum;
}
//// lw_tabulated_1
static inline double lw_tabulated_1(const @PREFIX@_table *table, double x, int order) {
    return lw_tabulated(table, 1, &x, &order);
}
//// lw_tabulated_2
static inline double lw_tabulated_2(const @PREFIX@_table *table, double x, double y, int by_x, int by_y) {
    const double at[2] = {x, y};
    const int orders[2] = {by_x, by_y};
    return lw_tabulated(table, 2, at, orders);
}
//// lw_tabulated_3
static inline double lw_tabulated_3(const @PREFIX@_table *table, double x, double y, double z, int by_x, int by_y, int by_z) {
    const double at[3] = {x, y, z};
    const int orders[3] = {by_x, by_y, by_z};
    return lw_tabulated(table, 3, at, orders);
}
