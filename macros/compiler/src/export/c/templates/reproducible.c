/* Every operation is rounded by itself, so that results have the same bits on every machine. */
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || defined(_M_FP_FAST)
#error "results are reproducible only without -ffast-math and similar options"
#endif
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error "results are reproducible only without excess precision: compile for SSE2 (-msse2 -mfpmath=sse)"
#endif
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=off", "no-tree-slp-vectorize")
#elif defined(_MSC_VER)
#pragma fp_contract(off)
#else
#pragma STDC FP_CONTRACT OFF
#endif
#undef FP_FAST_FMA
#define lw_mul_add(a, b, c) ((a) * (b) + (c))
#define lw_mul_sub(a, b, c) ((a) * (b) - (c))
#define lw_neg_mul_add(a, b, c) ((c) - (a) * (b))

