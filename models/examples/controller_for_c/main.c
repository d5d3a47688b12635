/* Balances two poles for six seconds, and prints the final state. Returns zero if both are upright. */
#include "controller.h"
#include <stdio.h>

int main(void) {
    const double period = 0.005;
    struct gains gains;
    double q[3] = {0.0, 0.1, 0.0}, v[3] = {0.0, 0.0, 0.0};
    if (cart_design(-period, &gains) || !cart_design(period, &gains)) {
        return 1;
    }
    printf("  t, s   cart, m   lean, rad   bend, rad   push, N\n");
    for (int step = 0; step <= 1200; step++) {
        double push = cart_push(&gains, q, v);
        if (step % 100 == 0) {
            printf("%6.2f %9.4f %11.4f %11.4f %9.3f\n", period * step, q[0], q[1], q[2], push);
        }
        if (!cart_step(period, push, q, v)) {
            return 2;
        }
    }
    for (int i = 0; i < 3; i++) {
        if (q[i] > 1e-3 || q[i] < -1e-3 || v[i] > 1e-3 || v[i] < -1e-3) {
            return 3;
        }
    }
    return 0;
}
