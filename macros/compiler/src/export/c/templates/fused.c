/* Products with sums: one instruction where the processor has it, which not every compiler says by the standard's macro. */
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

/* gcc puts the entries of results that stand side by side into vector registers one by one, which takes longer than to store them. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")
#endif
