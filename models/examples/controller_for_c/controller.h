/* Controller of a cart on a rail that balances two poles in series. State: position of the cart, m; angle of the lower pole and
   angle between both, rad, counter-clockwise; and their rates. No pointer may be null; no pointer is stored. */
#ifndef CONTROLLER_H
#define CONTROLLER_H

#include <stdbool.h>

struct gains {
    double q[3];
    double v[3];
};

/* Computes the gains of a controller that is called every `period` seconds; returns false if none exist. */
bool cart_design(double period, struct gains *gains);

/* Returns the force on the cart for a state, N. */
double cart_push(const struct gains *gains, const double q[3], const double v[3]);

/* Simulates one period with a constant force; returns false if the state after it is not finite. */
bool cart_step(double period, double push, double q[3], double v[3]);

#endif
