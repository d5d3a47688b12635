//// @PREFIX@_casadi_position_@POINT@ : @T_INPUT@q:@NQ@ -> position:3
    casadi_real placement[12];
    @PREFIX@_frame_placement(@SELF@@UPPER@_FRAME_@FRAME@, @T@q, placement);
    lw_block(3, 1, 3, placement + 9, 3, r0);
#if EXACT
//// jac_@PREFIX@_casadi_position_@POINT@ : q:@N@ out_position:3:0 -> jac_position_q:3:@N@ + 6 * @N@
    @PREFIX@_frame_jacobian(@SELF@@UPPER@_FRAME_@FRAME@, q, extra);
    lw_block(3, @N@, 6, extra, 3, r0);
#endif
