/* Functions of model exchange and of co-simulation. */

LW_EXPORT fmi3Status LW_FMI(fmi3UpdateDiscreteStates)(fmi3Instance instance, fmi3Boolean *need_update,
    fmi3Boolean *terminates, fmi3Boolean *nominals_changed, fmi3Boolean *values_changed, fmi3Boolean *has_next,
    fmi3Float64 *next) {
    static const char function[] = "fmi3UpdateDiscreteStates";
    LW_BEGIN(LW_EVENT, function)
    LW_REQUIRE(need_update && terminates && nominals_changed && values_changed && has_next && next, function,
        "an argument is NULL")
    const lw_state before = s->state;
    const char *problem = lw_make_consistent(&s->state, 1e-9);
    s->is_current = false;
    if (problem) {
        s->state = before;
        return lw_fail(s, fmi3Error, function, problem);
    }
    *need_update = false;
    *terminates = false;
    *nominals_changed = false;
    *values_changed = memcmp(before.states, s->state.states, sizeof before.states) != 0;
    *has_next = false;
    *next = 0.0;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3EnterContinuousTimeMode)(fmi3Instance instance) {
    LW_BEGIN(LW_EVENT, "fmi3EnterContinuousTimeMode")
    LW_REQUIRE(!s->is_co_simulation, "fmi3EnterContinuousTimeMode", "the instance is for co-simulation")
    s->state.mode = LW_CONTINUOUS;
    s->is_current = false;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3CompletedIntegratorStep)(fmi3Instance instance, fmi3Boolean is_final,
    fmi3Boolean *enter_events, fmi3Boolean *terminates) {
    static const char function[] = "fmi3CompletedIntegratorStep";
    LW_BEGIN(LW_CONTINUOUS, function)
    LW_REQUIRE(enter_events && terminates, function, "an argument is NULL")
    (void)is_final;
    double violation = 0.0;
    bool has_event = false;
    for (int k = 0; k < LW_BALLS; ++k) {
        const double *q = s->state.states + lw_balls[k][0];
        const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        violation = fmax(violation, fabs(square - 1.0));
    }
#if LW_ROWS > 0
    lw_point p;
    lw_rows r;
    lw_point_at(&s->state, &p);
    if (lw_rows_at(&p, &r)) {
        violation = fmax(violation, lw_violation(&s->state, &r));
    }
#endif
#if LW_CONTACTS > 0
    if (lw_update(s, function, fmi3Error) != fmi3OK) {
        return fmi3Error;
    }
    has_event = lw_has_event(&s->state, &s->values);
#endif
    *enter_events = has_event || violation > LW_VIOLATION;
    *terminates = false;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3SetTime)(fmi3Instance instance, fmi3Float64 time) {
    LW_BEGIN(LW_CONTINUOUS | LW_EVENT, "fmi3SetTime")
    LW_REQUIRE(isfinite(time), "fmi3SetTime", "the time is not finite")
    s->is_current = s->is_current && time == s->state.time;
    s->state.time = time;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3SetContinuousStates)(fmi3Instance instance, const fmi3Float64 states[],
    size_t count) {
    static const char function[] = "fmi3SetContinuousStates";
    LW_BEGIN(LW_CONTINUOUS, function)
    LW_REQUIRE(count == LW_STATES && (states || !count), function, "NULL, or another number of states")
    for (int k = 0; k < LW_STATES; ++k) {
        if (!isfinite(states[k])) {
            return lw_fail_of(s, function, LW_FIRST_STATE + k, "is set to a value that is not finite");
        }
    }
    memcpy(s->state.states, states, LW_STATES * sizeof(double));
    s->is_current = false;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3GetContinuousStates)(fmi3Instance instance, fmi3Float64 states[], size_t count) {
    static const char function[] = "fmi3GetContinuousStates";
    LW_BEGIN(LW_ANY & ~LW_INSTANTIATED, function)
    LW_REQUIRE(count == LW_STATES && (states || !count), function, "NULL, or another number of states")
    memcpy(states, s->state.states, LW_STATES * sizeof(double));
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3GetContinuousStateDerivatives)(fmi3Instance instance, fmi3Float64 rates[],
    size_t count) {
    static const char function[] = "fmi3GetContinuousStateDerivatives";
    LW_BEGIN(LW_ANY & ~LW_INSTANTIATED, function)
    LW_REQUIRE(count == LW_STATES && (rates || !count), function, "NULL, or another number of states")
    /* The integrator of the importer may try a shorter step. */
    const fmi3Status status = lw_update(s, function, fmi3Discard);
    if (status == fmi3OK) {
        memcpy(rates, s->values.rates, LW_STATES * sizeof(double));
    }
    return status;
}

LW_EXPORT fmi3Status LW_FMI(fmi3GetEventIndicators)(fmi3Instance instance, fmi3Float64 indicators[], size_t count) {
    static const char function[] = "fmi3GetEventIndicators";
    LW_BEGIN(LW_ANY & ~LW_INSTANTIATED, function)
    LW_REQUIRE(count == LW_CONTACTS && (indicators || !count), function, "NULL, or another number of indicators")
    const fmi3Status status = lw_update(s, function, fmi3Discard);
    if (status == fmi3OK && count > 0) {
        memcpy(indicators, s->values.indicators, LW_CONTACTS * sizeof(double));
    }
    return status;
}

LW_EXPORT fmi3Status LW_FMI(fmi3GetNominalsOfContinuousStates)(fmi3Instance instance, fmi3Float64 nominals[],
    size_t count) {
    static const char function[] = "fmi3GetNominalsOfContinuousStates";
    LW_BEGIN(LW_ANY & ~LW_INSTANTIATED, function)
    LW_REQUIRE(count == LW_STATES && (nominals || !count), function, "NULL, or another number of states")
    for (size_t k = 0; k < count; ++k) {
        nominals[k] = 1.0;
    }
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3GetNumberOfEventIndicators)(fmi3Instance instance, size_t *count) {
    LW_BEGIN(LW_ANY, "fmi3GetNumberOfEventIndicators")
    LW_REQUIRE(count, "fmi3GetNumberOfEventIndicators", "the pointer to the number is NULL")
    *count = LW_CONTACTS;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3GetNumberOfContinuousStates)(fmi3Instance instance, size_t *count) {
    LW_BEGIN(LW_ANY, "fmi3GetNumberOfContinuousStates")
    LW_REQUIRE(count, "fmi3GetNumberOfContinuousStates", "the pointer to the number is NULL")
    *count = LW_STATES;
    return fmi3OK;
}

LW_EXPORT fmi3Status LW_FMI(fmi3DoStep)(fmi3Instance instance, fmi3Float64 now, fmi3Float64 step,
    fmi3Boolean is_final, fmi3Boolean *needs_events, fmi3Boolean *terminates, fmi3Boolean *returns_early,
    fmi3Float64 *last_time) {
    static const char function[] = "fmi3DoStep";
    LW_BEGIN(LW_STEPPING, function)
    LW_REQUIRE(needs_events && terminates && returns_early && last_time, function, "an argument is NULL")
    (void)is_final;
    const double rounding = 1e-9 * fmax(1.0, fabs(s->state.time));
    LW_REQUIRE(fabs(now - s->state.time) <= rounding, function,
        "the communication point is not the time at which the last step ended")
    LW_REQUIRE(step > 0.0 && isfinite(step), function, "the communication step is not positive")
    LW_REQUIRE(!s->has_stop || now + step <= s->stop + rounding, function, "the step ends after the stop time")
    lw_state next = s->state;
    /* The inputs may have changed since the contacts were determined. */
    const char *problem = lw_make_consistent(&next, 1e-12);
    problem = problem ? problem : lw_integrate_to(&next, now + step, s->tolerance);
    *needs_events = false;
    *terminates = false;
    *returns_early = false;
    *last_time = s->state.time;
    LW_REQUIRE(!problem, function, problem)
    s->state = next;
    s->is_current = false;
    *last_time = s->state.time;
    return fmi3OK;
}
