// MuJoCo with the interface of src/peers/library.rs.
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    mjModel *model;
    mjData *data;
    // MuJoCo's joints in Linkwork's order.
    int *joints;
    int count;
    // Positions and velocities in MuJoCo's form, one state after another.
    double *states;
    size_t length;
} Robot;

// Rotates the linear velocity of a free joint between the body's axes and those of the world.
static void turn(double *v, const double *quaternion, int back) {
    double q[4];
    memcpy(q, quaternion, sizeof q);
    if (back)
        for (int k = 1; k < 4; ++k) q[k] = -q[k];
    double out[3];
    mju_rotVecQuat(out, v, q);
    memcpy(v, out, sizeof out);
}

static int is_free(const Robot *r, int k) { return r->model->jnt_type[r->joints[k]] == mjJNT_FREE; }

static void take(const Robot *r, const double *row, int nq, double *to) {
    const mjModel *m = r->model;
    const double *q = row, *v = row + nq;
    for (int k = 0; k < r->count; ++k) {
        double *at = to + m->jnt_qposadr[r->joints[k]], *rate = to + m->nq + m->jnt_dofadr[r->joints[k]];
        if (!is_free(r, k)) {
            *at = *q++, *rate = *v++;
            continue;
        }
        memcpy(at, q, 3 * sizeof *q);
        at[3] = q[6], at[4] = q[3], at[5] = q[4], at[6] = q[5];
        memcpy(rate, v, 6 * sizeof *v);
        turn(rate, at + 3, 0);
        q += 7, v += 6;
    }
}

Robot *peer_open(const char *folder, const double *states, size_t length, size_t count) {
    char path[4096], error[1000], name[100];
    snprintf(path, sizeof path, "%s/mujoco.xml", folder);
    mjModel *m = mj_loadXML(path, NULL, error, sizeof error);
    if (!m) {
        if (!strstr(error, "open")) fprintf(stderr, "MuJoCo: %s\n", error);
        return NULL;
    }
    Robot *r = calloc(1, sizeof *r);
    *r = (Robot){m, mj_makeData(m), calloc(m->njnt, sizeof(int)), 0, NULL, m->nq + m->nv};
    snprintf(path, sizeof path, "%s/order", folder);
    FILE *order = fopen(path, "r");
    while (order && r->count < m->njnt && fscanf(order, "%99s", name) == 1)
        r->joints[r->count++] = mj_name2id(m, mjOBJ_JOINT, name);
    if (order) fclose(order);
    snprintf(path, sizeof path, "%s/torques", folder);
    FILE *torques = fopen(path, "r");
    for (double torque; torques && fscanf(torques, "%99s %lf", name, &torque) == 2;)
        r->data->qfrc_applied[m->jnt_dofadr[mj_name2id(m, mjOBJ_JOINT, name)]] = torque;
    if (torques) fclose(torques);
    r->states = calloc(count * r->length, sizeof(double));
    for (size_t k = 0; k < count; ++k) take(r, states + k * (length / count), m->nq, r->states + k * r->length);
    return r;
}

static void place(Robot *r, size_t k) {
    const double *row = r->states + k * r->length;
    memcpy(r->data->qpos, row, r->model->nq * sizeof *row);
    memcpy(r->data->qvel, row + r->model->nq, r->model->nv * sizeof *row);
}

static void accelerations(Robot *r, size_t k) {
    place(r, k);
    mj_forward(r->model, r->data);
}

// Simulates a hundred steps by MuJoCo's own method.
static void motion(Robot *r, size_t k) {
    place(r, k);
    for (int step = 0; step < 100; ++step) mj_step(r->model, r->data);
}

typedef void (*Step)(Robot *, size_t);

Step peer_step_fn(Robot *r, size_t function, size_t variant) {
    (void)r;
    if (variant) return NULL;
    return function == 5 ? accelerations : function == 6 ? motion : NULL;
}

void peer_result(Robot *r, size_t function, size_t state, double *out) {
    (void)function, (void)state;
    const mjModel *m = r->model;
    for (int k = 0; k < r->count; ++k) {
        const double *a = r->data->qacc + m->jnt_dofadr[r->joints[k]];
        if (!is_free(r, k)) {
            *out++ = *a;
            continue;
        }
        const int v = m->jnt_dofadr[r->joints[k]], q = m->jnt_qposadr[r->joints[k]];
        double linear[3], own[3], w[3], cross[3];
        memcpy(linear, a, sizeof linear);
        memcpy(own, r->data->qvel + v, sizeof own);
        memcpy(w, r->data->qvel + v + 3, sizeof w);
        turn(linear, r->data->qpos + q + 3, 1);
        turn(own, r->data->qpos + q + 3, 1);
        mju_cross(cross, w, own);
        for (int i = 0; i < 3; ++i) *out++ = linear[i] - cross[i];
        for (int i = 3; i < 6; ++i) *out++ = a[i];
    }
}
