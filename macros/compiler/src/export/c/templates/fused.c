/* Fused multiply-add, if the processor supports it. Some compilers do not define the standard's macro for it. */
#if defined(__FMA__) && !defined(FP_FAST_FMA)
#define FP_FAST_FMA
#endif
#ifdef FP_FAST_FMA
#define lw_mul_add(a, b, c) fma(a, b, c)
#define lw_mul_sub(a, b, c) fma(a, b, -(c))
#define lw_neg_mul_add(a, b, c) fma(-(a), b, c)
#else
#define lw_mul_add(a, b, c) ((a) * (b) + (c))
#define lw_mul_sub(a, b, c) ((a) * (b) - (c))
#define lw_neg_mul_add(a, b, c) ((c) - (a) * (b))
#endif

/* gcc collects adjacent results in vector registers entry by entry, which takes longer than storing them individually. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")
#endif
