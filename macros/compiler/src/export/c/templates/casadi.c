
#ifndef casadi_real
#define casadi_real double
#endif
#ifndef casadi_int
#define casadi_int long long int
#endif

/* Functions with which CasADi queries a function's signature. */
#define EXTERNAL(NAME, INPUTS, OUTPUTS, WORK) \
    casadi_int NAME##_n_in(void) { \
        return INPUTS; \
    } \
    casadi_int NAME##_n_out(void) { \
        return OUTPUTS; \
    } \
    const char *NAME##_name_in(casadi_int i) { \
        return i >= 0 && i < INPUTS ? NAME##_names_in[i] : 0; \
    } \
    const char *NAME##_name_out(casadi_int i) { \
        return i >= 0 && i < OUTPUTS ? NAME##_names_out[i] : 0; \
    } \
    const casadi_int *NAME##_sparsity_in(casadi_int i) { \
        return i >= 0 && i < INPUTS ? NAME##_shapes_in[i] : 0; \
    } \
    const casadi_int *NAME##_sparsity_out(casadi_int i) { \
        return i >= 0 && i < OUTPUTS ? NAME##_shapes_out[i] : 0; \
    } \
    int NAME##_work(casadi_int *sz_arg, casadi_int *sz_res, casadi_int *sz_iw, casadi_int *sz_w) { \
        if (sz_arg) { \
            *sz_arg = INPUTS; \
        } \
        if (sz_res) { \
            *sz_res = OUTPUTS; \
        } \
        if (sz_iw) { \
            *sz_iw = 0; \
        } \
        if (sz_w) { \
            *sz_w = WORK; \
        } \
        return 0; \
    }

/* Copies a block between matrices with different distances between columns. */
static void lw_block(int rows, int columns, int from_stride, const casadi_real *from, int stride, casadi_real *to) {
    for (int j = 0; j < columns; ++j) {
        for (int i = 0; i < rows; ++i) {
            to[j * stride + i] = from[j * from_stride + i];
        }
    }
}

