#if BALLS
/* First velocity of each ball joint. */
static const int lw_ball_joints[@BALLS@] = {@BALL_JOINTS@};

#endif
#if FREES
/* First velocity of each free joint. */
static const int lw_free_joints[@FREES@] = {@FREE_JOINTS@};

#endif
@integrate_derivatives_of_joints@ {
#if OWN
    (void)(self);
#endif
    (void)(dv);
    for (int k = 0; k < @N@ * @N@; ++k) {
        by_q[k] = k % (@N@ + 1) == 0 ? 1.0 : 0.0;
        by_dv[k] = k % (@N@ + 1) == 0 ? 1.0 : 0.0;
    }
#if BALLS
    for (int j = 0; j < @BALLS@; ++j) {
        double a[9], b[9];
        const int at = lw_ball_joints[j];
        lw_ball_integrate_derivatives(dv + at, a, b);
        lw_put_block(3, at, a, by_q);
        lw_put_block(3, at, b, by_dv);
    }
#endif
#if FREES
    for (int j = 0; j < @FREES@; ++j) {
        double a[36], b[36];
        const int at = lw_free_joints[j];
        lw_free_integrate_derivatives(dv + at, a, b);
        lw_put_block(6, at, a, by_q);
        lw_put_block(6, at, b, by_dv);
    }
#endif
}

@tangent_rate_derivatives_of_joints@ {
#if OWN
    (void)(self);
#endif
    (void)(dv);
    (void)(v);
    for (int k = 0; k < @N@ * @N@; ++k) {
        by_dv[k] = k % (@N@ + 1) == 0 ? 0.0 : 0.0;
        by_v[k] = k % (@N@ + 1) == 0 ? 1.0 : 0.0;
    }
#if BALLS
    for (int j = 0; j < @BALLS@; ++j) {
        double a[9], b[9];
        const int at = lw_ball_joints[j];
        lw_ball_tangent_rate_derivatives(dv + at, v + at, a, b);
        lw_put_block(3, at, a, by_dv);
        lw_put_block(3, at, b, by_v);
    }
#endif
#if FREES
    for (int j = 0; j < @FREES@; ++j) {
        double a[36], b[36];
        const int at = lw_free_joints[j];
        lw_free_tangent_rate_derivatives(dv + at, v + at, a, b);
        lw_put_block(6, at, a, by_dv);
        lw_put_block(6, at, b, by_v);
    }
#endif
}

