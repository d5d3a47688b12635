/* Impacts and changes of contacts, and the integrator of co-simulation: the method of Dormand and Prince of order 5
 * with adaptive steps. */

/* Largest number of steps within a communication step. */
#define LW_MAX_STEPS 1000000
/* Largest number of events at one time. */
#define LW_MAX_EVENTS 64

#if LW_CONTACTS > 0

/* Returns true if a contact penetrates and approaches, or a closed contact pulls. */
static inline bool lw_has_event(const lw_state *s, const lw_values *values) {
    lw_point p;
    lw_rows r;
    lw_point_at(s, &p);
    if (!lw_rows_at(&p, &r)) {
        return false;
    }
    for (int i = 0; i < LW_CONTACTS; ++i) {
        const int row = LW_CONSTRAINTS + i;
        const bool is_event = s->closed[i]
            ? values->indicators[i] < 0.0
            : r.residuals[row] < -LW_OVERLAP && r.velocities[row] < -LW_SLOW;
        if (is_event) {
            return true;
        }
    }
    return false;
}

/* Removes overlaps, applies the impulses of impacts by Newton's coefficients of restitution, and determines the closed
 * contacts. */
static inline const char *lw_treat_contacts(lw_state *s) {
    lw_point p;
    lw_rows r;
    int kinds[LW_ROWS];
    double laws[3 * LW_CONTACTS], c[LW_ROWS], x[LW_ROWS], a[LW_NV];
    bool is_near[LW_CONTACTS], overlaps[LW_ROWS];
    lw_point_at(s, &p);
    if (!lw_rows_at(&p, &r)) {
        return "the mass matrix is not positive definite";
    }
    lw_select(s, overlaps);
    for (int i = LW_CONSTRAINTS; i < LW_ROWS; ++i) {
        overlaps[i] = overlaps[i] || r.residuals[i] < 0.0;
    }
    const char *problem = lw_project(s, overlaps, false);
    if (problem) {
        return problem;
    }
    lw_point_at(s, &p);
    if (!lw_rows_at(&p, &r)) {
        return "the mass matrix is not positive definite";
    }
    lw_contact_laws(&p.own, laws);
    for (int i = 0; i < LW_CONSTRAINTS; ++i) {
        kinds[i] = LW_BILATERAL;
        c[i] = r.velocities[i];
    }
    for (int i = 0; i < LW_CONTACTS; ++i) {
        const int row = LW_CONSTRAINTS + i;
        const double rebound = laws[3 * i + 1] * fmax(-r.velocities[row], 0.0);
        is_near[i] = r.residuals[row] < LW_NEAR || s->closed[i];
        kinds[row] = is_near[i] ? LW_UNILATERAL : LW_ABSENT;
        c[row] = r.velocities[row] - (rebound > LW_REBOUND ? rebound : 0.0);
    }
    if (!lw_solve_complementary(r.matrix, c, kinds, x)) {
        return "the impulses of an impact cannot be determined";
    }
    lw_add_responses(&r, x, s->states + LW_NQ);
    lw_point_at(s, &p);
    if (!lw_rows_at(&p, &r)) {
        return "the mass matrix is not positive definite";
    }
    lw_free_accelerations(&p, &r, 0.0, a, c);
    for (int i = 0; i < LW_CONTACTS; ++i) {
        const int row = LW_CONSTRAINTS + i;
        kinds[row] = is_near[i] && r.velocities[row] < LW_SLOW ? LW_UNILATERAL : LW_ABSENT;
    }
    if (!lw_solve_complementary(r.matrix, c, kinds, x)) {
        return "the forces of contacts cannot be determined";
    }
    for (int i = 0; i < LW_CONTACTS; ++i) {
        s->closed[i] = x[LW_CONSTRAINTS + i] > 0.0;
    }
    return NULL;
}

#endif

/* Makes a state consistent with constraints, contacts and quaternions. States that satisfy the constraints to
 * `tolerance` do not change. Returns NULL, or why it cannot be done. */
static inline const char *lw_make_consistent(lw_state *s, double tolerance) {
    if (!lw_normalise_all(s->states)) {
        return "a quaternion is zero";
    }
#if LW_ROWS > 0
    lw_point p;
    lw_rows r;
    lw_point_at(s, &p);
    if (!lw_rows_at(&p, &r)) {
        return "the mass matrix is not positive definite";
    }
    bool selected[LW_ROWS];
    lw_select(s, selected);
    const char *problem = lw_violation(s, &r) > tolerance ? lw_project(s, selected, true) : NULL;
#if LW_CONTACTS > 0
    problem = problem ? problem : lw_treat_contacts(s);
#endif
    return problem;
#else
    (void)(tolerance);
    return NULL;
#endif
}

/* One step from `s`, of h seconds, to `next`. Writes the error in units of the tolerance. */
static inline const char *lw_try_step(const lw_state *s, const lw_values *first, double h, double tolerance,
    lw_state *next, double *error) {
    static const double nodes[6] = {0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0};
    static const double parts[6][6] = {{0.2},
        {3.0 / 40.0, 9.0 / 40.0},
        {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
        {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
        {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
        {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0}};
    static const double difference[7] = {71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0,
        22.0 / 525.0, -1.0 / 40.0};
    double rates[7][LW_AT_LEAST_ONE(LW_STATES)];
    lw_values values;
    memcpy(rates[0], first->rates, sizeof rates[0]);
    *next = *s;
    for (int stage = 0; stage < 6; ++stage) {
        next->time = s->time + nodes[stage] * h;
        for (int k = 0; k < LW_STATES; ++k) {
            double sum = 0.0;
            for (int i = 0; i <= stage; ++i) {
                sum += parts[stage][i] * rates[i][k];
            }
            next->states[k] = s->states[k] + h * sum;
        }
        const char *problem = lw_evaluate(next, 0.0, &values);
        if (problem) {
            return problem;
        }
        memcpy(rates[stage + 1], values.rates, sizeof values.rates);
    }
    *error = 0.0;
    for (int k = 0; k < LW_STATES; ++k) {
        double sum = 0.0;
        for (int i = 0; i < 7; ++i) {
            sum += difference[i] * rates[i][k];
        }
        const double scale = 1.0 + fmax(fabs(s->states[k]), fabs(next->states[k]));
        *error = fmax(*error, fabs(h * sum) / (tolerance * scale));
    }
    lw_normalise_all(next->states);
#if LW_ROWS > 0
    lw_point p;
    lw_rows r;
    lw_point_at(next, &p);
    bool selected[LW_ROWS];
    lw_select(next, selected);
    if (lw_rows_at(&p, &r) && lw_violation(next, &r) > 1e-13) {
        return lw_project(next, selected, true);
    }
#endif
    return NULL;
}

/* Integrates to the time `end`. Returns NULL, or why it cannot be done. */
static inline const char *lw_integrate_to(lw_state *s, double end, double tolerance) {
    const double shortest = 1e-14 * fmax(1.0, fabs(end));
    int events = 0;
    lw_values values, at_end;
    lw_state next;
    for (int count = 0; end - s->time > shortest; ++count) {
        const char *problem = lw_evaluate(s, 0.0, &values);
        double h = fmin(s->step, end - s->time), error = 0.0;
        if (problem || count > LW_MAX_STEPS) {
            return problem ? problem : "a communication step needs too many steps of the integrator";
        }
        for (;;) {
            problem = lw_try_step(s, &values, h, tolerance, &next, &error);
            if (!problem && error <= 1.0) {
                break;
            }
            h *= problem || !isfinite(error) ? 0.25 : fmax(0.2, 0.9 * pow(error, -0.2));
            s->step = h;
            if (h < shortest) {
                return problem ? problem : "the step of the integrator becomes too short";
            }
        }
        const bool is_whole = h >= 0.999 * s->step;
        const double factor = error > 1e-10 ? fmin(5.0, 0.9 * pow(error, -0.2)) : 5.0;
        next.step = is_whole || h * factor > s->step ? fmin(h * factor, 1e3) : s->step;
        next.time = h < end - s->time ? s->time + h : end;
#if LW_CONTACTS > 0
        problem = lw_evaluate(&next, 0.0, &at_end);
        if (problem) {
            return problem;
        }
        if (lw_has_event(&next, &at_end)) {
            /* The event is located between `low`, before it, and `high`, after it. */
            double low = 0.0, high = h;
            lw_state after = next;
            while (high - low > shortest) {
                const double middle = 0.5 * (low + high);
                problem = lw_try_step(s, &values, middle, tolerance, &next, &error);
                next.time = s->time + middle;
                problem = problem ? problem : lw_evaluate(&next, 0.0, &at_end);
                if (problem) {
                    return problem;
                }
                if (lw_has_event(&next, &at_end)) {
                    high = middle;
                    after = next;
                } else {
                    low = middle;
                }
            }
            next = after;
            events = high > shortest ? 0 : events + 1;
            problem = events < LW_MAX_EVENTS ? lw_treat_contacts(&next) : "contacts open and close without end";
            if (problem) {
                return problem;
            }
        }
#else
        (void)(at_end);
        (void)(events);
#endif
        *s = next;
    }
    s->time = end;
    return NULL;
}
