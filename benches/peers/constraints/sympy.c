// Follows the generated functions of a mechanism: solution for the multipliers, and the interface of src/peers/library.rs.
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { N = NV + NC };

typedef struct {
    const double *states;
    size_t length;
    double a[NV];
} Robot;

// Gaussian elimination with partial pivoting of [[M, -J'], [J, 0]].
static void by_elimination(const double *q, const double *u, double *a) {
    double mass[NV * NV], force[NV], jacobian[NC * NV], bias[NC], m[N][N + 1];
    equations(q, u, mass, force, jacobian, bias);
    for (int i = 0; i < NV; ++i) {
        for (int j = 0; j < NV; ++j) m[i][j] = mass[i * NV + j];
        for (int k = 0; k < NC; ++k) m[i][NV + k] = -jacobian[k * NV + i];
        m[i][N] = force[i];
    }
    for (int k = 0; k < NC; ++k) {
        for (int j = 0; j < NV; ++j) m[NV + k][j] = jacobian[k * NV + j];
        for (int j = NV; j < N; ++j) m[NV + k][j] = 0;
        m[NV + k][N] = -bias[k];
    }
    for (int p = 0; p < N; ++p) {
        int best = p;
        for (int i = p + 1; i < N; ++i)
            if (fabs(m[i][p]) > fabs(m[best][p])) best = i;
        if (best != p)
            for (int j = p; j <= N; ++j) {
                const double x = m[p][j];
                m[p][j] = m[best][j];
                m[best][j] = x;
            }
        const double inverse = 1 / m[p][p];
        for (int i = p + 1; i < N; ++i) {
            const double factor = m[i][p] * inverse;
            for (int j = p + 1; j <= N; ++j) m[i][j] -= factor * m[p][j];
        }
    }
    for (int i = N - 1; i >= 0; --i) {
        double x = m[i][N];
        for (int j = i + 1; j < N; ++j) x -= m[i][j] * m[j][N];
        m[i][N] = x / m[i][i];
    }
    for (int i = 0; i < NV; ++i) a[i] = m[i][N];
}

// Cholesky factorisation A = L L' in place, lower triangle.
static inline void factor(int n, double *a) {
    for (int j = 0; j < n; ++j) {
        double d = a[j * n + j];
        for (int k = 0; k < j; ++k) d -= a[j * n + k] * a[j * n + k];
        const double inverse = 1 / (a[j * n + j] = sqrt(d));
        for (int i = j + 1; i < n; ++i) {
            double x = a[i * n + j];
            for (int k = 0; k < j; ++k) x -= a[i * n + k] * a[j * n + k];
            a[i * n + j] = x * inverse;
        }
    }
}

// x = L⁻¹ x
static inline void forward(int n, const double *l, double *x) {
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < i; ++k) x[i] -= l[i * n + k] * x[k];
        x[i] /= l[i * n + i];
    }
}

// x = L'⁻¹ x
static inline void backward(int n, const double *l, double *x) {
    for (int i = n - 1; i >= 0; --i) {
        for (int k = i + 1; k < n; ++k) x[i] -= l[k * n + i] * x[k];
        x[i] /= l[i * n + i];
    }
}

// Cholesky factorisations of M and of J M⁻¹ J'.
static void by_complement(const double *q, const double *u, double *a) {
    double mass[NV * NV], force[NV], jacobian[NC * NV], bias[NC], s[NC * NC], lambda[NC];
    equations(q, u, mass, force, jacobian, bias);
    factor(NV, mass);
    forward(NV, mass, force);
    for (int k = 0; k < NC; ++k) {
        double *row = jacobian + k * NV;
        forward(NV, mass, row);
        lambda[k] = -bias[k];
        for (int i = 0; i < NV; ++i) lambda[k] -= row[i] * force[i];
        for (int j = 0; j <= k; ++j) {
            double x = 0;
            for (int i = 0; i < NV; ++i) x += row[i] * jacobian[j * NV + i];
            s[k * NC + j] = x;
        }
    }
    factor(NC, s);
    forward(NC, s, lambda);
    backward(NC, s, lambda);
    for (int k = 0; k < NC; ++k)
        for (int i = 0; i < NV; ++i) force[i] += jacobian[k * NV + i] * lambda[k];
    backward(NV, mass, force);
    memcpy(a, force, sizeof(double) * NV);
}

typedef void (*Solver)(const double *, const double *, double *);

static inline void evaluate(Robot *r, size_t k, Solver solve) {
    const double *q = r->states + k * r->length;
    solve(q, q + NQ, r->a);
}

// Simulates a hundred steps of the classical Runge-Kutta method, without projections.
static inline void motion(Robot *r, size_t k, Solver solve) {
    enum { ALL = NQ + NV };
    const double h = STEP, part[] = {0, h / 2, h / 2, h}, weight[] = {h / 6, h / 3, h / 3, h / 6};
    double x[ALL], at[ALL], next[ALL], rate[ALL];
    memcpy(x, r->states + k * r->length, sizeof x);
    for (int step = 0; step < 100; ++step) {
        memcpy(next, x, sizeof x);
        for (int s = 0; s < 4; ++s) {
            for (int i = 0; i < ALL; ++i) at[i] = s ? x[i] + part[s] * rate[i] : x[i];
            kinematics(at, at + NQ, rate);
            solve(at, at + NQ, rate + NQ);
            for (int i = 0; i < ALL; ++i) next[i] += weight[s] * rate[i];
        }
        memcpy(x, next, sizeof x);
    }
    memcpy(r->a, x + NQ, sizeof r->a);
}

static void elimination(Robot *r, size_t k) { evaluate(r, k, by_elimination); }
static void complement(Robot *r, size_t k) { evaluate(r, k, by_complement); }
static void motion_by_elimination(Robot *r, size_t k) { motion(r, k, by_elimination); }
static void motion_by_complement(Robot *r, size_t k) { motion(r, k, by_complement); }

typedef void (*Step)(Robot *, size_t);

Robot *peer_open(const char *folder, const double *states, size_t length, size_t count) {
    (void)folder;
    Robot *r = malloc(sizeof *r);
    *r = (Robot){states, length / count, {0}};
    return r;
}

Step peer_step_fn(Robot *r, size_t function, size_t variant) {
    (void)r;
    static const Step accelerations[] = {elimination, complement}, motions[] = {motion_by_elimination, motion_by_complement};
    if (variant >= 2) return NULL;
    return function == 5 ? accelerations[variant] : function == 6 ? motions[variant] : NULL;
}

void peer_result(Robot *r, size_t function, size_t state, double *out) {
    (void)function, (void)state;
    memcpy(out, r->a, sizeof r->a);
}
