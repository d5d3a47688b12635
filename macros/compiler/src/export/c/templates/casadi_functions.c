#if EXACT_FORWARD
//// jac_@PREFIX@_casadi_forward_dynamics : q:@N@ v:@N@ tau:@N@ out_result:@N@:0 -> jac_result_q:@N@:@N@ jac_result_v:@N@:@N@ jac_result_tau:@N@:@N@
    @PREFIX@_forward_dynamics_derivatives(@SELF@q, v, tau, r0, r1, r2);
#endif
#if EXACT_INVERSE
//// jac_@PREFIX@_casadi_inverse_dynamics : q:@N@ v:@N@ a:@N@ out_result:@N@:0 -> jac_result_q:@N@:@N@ jac_result_v:@N@:@N@ jac_result_a:@N@:@N@
    @PREFIX@_inverse_dynamics_derivatives(@SELF@q, v, a, r0, r1);
    @PREFIX@_mass_matrix(@SELF@q, r2);
#endif
#if STATES
//// @PREFIX@_expl_ode_fun : x:@X@ u:@M@ p:@FREE@ -> f:@X@
    casadi_real force[@N@ + 1];
    lw_input_forces(@SELF@x, u, force);
    lw_block(@N@, 1, @N@, x + @N@, @N@, r0);
    @PREFIX@_forward_dynamics(@SELF@x, x + @N@, force, r0 + @N@);
//// @PREFIX@_expl_vde_forw : x:@X@ sx:@X@:@X@ su:@X@:@M@ u:@M@ p:@FREE@ -> f:@X@ sx_rate:@X@:@X@ su_rate:@X@:@M@ + @X@ * (@X@ + @M@)
    casadi_real *by_state = extra, *by_input = extra + @X@ * @X@, force[@N@ + 1];
    lw_input_forces(@SELF@x, u, force);
    lw_block(@N@, 1, @N@, x + @N@, @N@, r0);
    @PREFIX@_forward_dynamics(@SELF@x, x + @N@, force, r0 + @N@);
    @PREFIX@_linearize(@SELF@x, x + @N@, u, by_state, by_input);
    lw_product(@X@, @X@, @X@, by_state, sx, r1);
    lw_product(@X@, @X@, @M@, by_state, su, r2);
    for (int k = 0; k < @X@ * @M@; ++k) {
        r2[k] += by_input[k];
    }
//// @PREFIX@_expl_vde_adj : x:@X@ lambda:@X@ u:@M@ p:@FREE@ -> adjoint:@X@+@M@ + @X@ * (@X@ + @M@)
    casadi_real *by_state = extra, *by_input = extra + @X@ * @X@;
    @PREFIX@_linearize(@SELF@x, x + @N@, u, by_state, by_input);
    for (int k = 0; k < @X@ + @M@; ++k) {
        const casadi_real *column = k < @X@ ? by_state + k * @X@ : by_input + (k - @X@) * @X@;
        r0[k] = 0.0;
        for (int i = 0; i < @X@; ++i) {
            r0[k] += column[i] * lambda[i];
        }
    }
//// @PREFIX@_dyn_disc_phi_fun : x:@X@ u:@M@ p:@FREE@+1 -> phi:@X@
    @PREFIX@_rk4_step(@SELF@x, x + @N@, u, p[0], r0, r0 + @N@);
//// @PREFIX@_dyn_disc_phi_fun_jac : x:@X@ u:@M@ p:@FREE@+1 -> phi:@X@ jac_ut_xt:@M@+@X@:@X@ + @X@ * (@X@ + @M@ + 1)
    casadi_real *by_state = extra, *by_input = by_state + @X@ * @X@, *by_h = by_input + @X@ * @M@;
    @PREFIX@_rk4_transition(@SELF@x, x + @N@, u, p[0], r0, r0 + @N@, by_state, by_input, by_h);
    for (int i = 0; i < @X@; ++i) {
        for (int k = 0; k < @M@ + @X@; ++k) {
            r1[i * (@M@ + @X@) + k] = k < @M@ ? by_input[k * @X@ + i] : by_state[(k - @M@) * @X@ + i];
        }
    }
#endif
