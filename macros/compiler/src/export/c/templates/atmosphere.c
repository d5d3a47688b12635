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
