//// jac_@PREFIX@_casadi_@METHOD@_step : q:@N@ v:@N@ u:@M@ h:1 out_next_q:@N@:0 out_next_v:@N@:0 -> jac_next_q_q:@N@:@N@ jac_next_q_v:@N@:@N@ jac_next_q_u:@N@:@M@ jac_next_q_h:@N@:1 jac_next_v_q:@N@:@N@ jac_next_v_v:@N@:@N@ jac_next_v_u:@N@:@M@ jac_next_v_h:@N@:1 + @X@ * (@X@ + @M@ + 2)
    casadi_real *next = extra, *by_state = next + @X@, *by_input = by_state + @X@ * @X@, *by_h = by_input + @X@ * @M@;
    @PREFIX@_@METHOD@_transition(@SELF@q, v, u, h[0], next, next + @N@, by_state, by_input, by_h);
    lw_block(@N@, @N@, @X@, by_state, @N@, r0);
    lw_block(@N@, @N@, @X@, by_state + @X@ * @N@, @N@, r1);
    lw_block(@N@, @M@, @X@, by_input, @N@, r2);
    lw_block(@N@, 1, @X@, by_h, @N@, r3);
    lw_block(@N@, @N@, @X@, by_state + @N@, @N@, r4);
    lw_block(@N@, @N@, @X@, by_state + @X@ * @N@ + @N@, @N@, r5);
    lw_block(@N@, @M@, @X@, by_input + @N@, @N@, r6);
    lw_block(@N@, 1, @X@, by_h + @N@, @N@, r7);
