/* Definitions that do not depend on the mechanism. Compiled as C++ instead of CUDA, kernels are functions of the processor that
 * compute one state at a time. */
#ifndef LW_KERNELS
#define LW_KERNELS
#ifdef __CUDACC__
#define LW_DEVICE static __device__ __forceinline__
#define LW_TABLE static __constant__
#define LW_UNROLL _Pragma("unroll")
#ifndef LW_THREADS
#define LW_THREADS 128 /* threads per block */
#endif
#ifndef LW_BLOCKS
#define LW_BLOCKS 1 /* blocks that a multiprocessor holds at least: more of them leave fewer registers to a thread */
#endif
#define LW_KERNEL extern "C" __global__ void __launch_bounds__(LW_THREADS, LW_BLOCKS)
#define LW_STATE ((long long)blockIdx.x * LW_THREADS + threadIdx.x)
#else
#include <float.h>
#include <math.h>
#define LW_DEVICE static inline
#define LW_TABLE static
#define LW_UNROLL
#define LW_KERNEL static inline void
static long long lw_state = 0;
#define LW_STATE lw_state
#endif
#ifndef LW_RESTRICT
#define LW_RESTRICT __restrict__
#endif
#ifdef __CUDACC_RTC__
#define HUGE_VAL __longlong_as_double(0x7ff0000000000000ll)
#define HUGE_VALF __int_as_float(0x7f800000)
#define DBL_EPSILON 2.220446049250313e-16
#define FLT_EPSILON 1.1920929e-7f
#endif

#if defined(__CUDACC__) || defined(FP_FAST_FMA)
LW_DEVICE double lw_mul_add(double a, double b, double c) { return fma(a, b, c); }
LW_DEVICE float lw_mul_add(float a, float b, float c) { return fmaf(a, b, c); }
#else
LW_DEVICE double lw_mul_add(double a, double b, double c) { return a * b + c; }
LW_DEVICE float lw_mul_add(float a, float b, float c) { return a * b + c; }
#endif
template <class T> LW_DEVICE T lw_mul_sub(T a, T b, T c) { return lw_mul_add(a, b, -c); }
template <class T> LW_DEVICE T lw_neg_mul_add(T a, T b, T c) { return lw_mul_add(-a, b, c); }

#ifdef __CUDACC__
LW_DEVICE void lw_sin_cos(double x, double *s, double *c) { sincos(x, s, c); }
LW_DEVICE void lw_sin_cos(float x, float *s, float *c) { sincosf(x, s, c); }
#else
LW_DEVICE void lw_sin_cos(double x, double *s, double *c) { *s = sin(x), *c = cos(x); }
LW_DEVICE void lw_sin_cos(float x, float *s, float *c) { *s = sinf(x), *c = cosf(x); }
#endif
template <class T> LW_DEVICE void lw_sin_cos_4(const T *x, T *s, T *c) {
    LW_UNROLL for (int k = 0; k < 4; ++k) {
        lw_sin_cos(x[k], s + k, c + k);
    }
}

/* The entries of one state. */
template <class T> struct lw_entries {
    T *at;
    long long step;
#ifdef __CUDACC__
    __device__ __forceinline__
#endif
    T &operator[](int k) const { return at[k * step]; }
#ifdef __CUDACC__
    __device__ __forceinline__
#endif
    lw_entries operator+(int k) const { return lw_entries{at + k * step, step}; }
};
template <class T> LW_DEVICE lw_entries<T> lw_entries_of(T *at, long long step, long long state) {
    return lw_entries<T>{at + state, step};
}

/* A result that is always zero. */
struct lw_zero {
#ifdef __CUDACC__
    __device__ __forceinline__
#endif
    operator float() const { return 0.0f; }
};

/* Receives the entries of a matrix, and sums the products of a row vector with its columns instead of storing them. */
template <class T> struct lw_term {
    T weight, *sum;
#ifdef __CUDACC__
    __device__ __forceinline__
#endif
    void operator=(T x) const { *sum = lw_mul_add(weight, x, *sum); }
#ifdef __CUDACC__
    __device__ __forceinline__
#endif
    void operator=(lw_zero) const {}
};
template <class T, int ROWS> struct lw_products {
    const T *weights;
    T *sums;
#ifdef __CUDACC__
    __device__ __forceinline__
#endif
    lw_term<T> operator[](int k) const { return lw_term<T>{weights[k % ROWS], sums + k / ROWS}; }
};
#endif
