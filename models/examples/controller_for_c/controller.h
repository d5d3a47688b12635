/* A cart on a rail that keeps two poles upright, one on the other. State: place of the cart, m; lean of the lower pole and
   angle between both, rad, counter-clockwise; and their rates. No pointer may be null; none is kept. */
#ifndef CONTROLLER_H
#define CONTROLLER_H

#include <stdbool.h>

struct gains {
    double q[3];
    double v[3];
};

/* Gains for a controller that is called every `period` seconds; false if there are none. */
bool cart_design(double period, struct gains *gains);

/* The push on the cart for a state, N. */
double cart_push(const struct gains *gains, const double q[3], const double v[3]);

/* Moves the state on by a period under a push: a simulation. False if it is not finite then. */
bool cart_step(double period, double push, double q[3], double v[3]);

#endif
