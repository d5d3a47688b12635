/* A function of one to three variables by its values on a grid. Between the points it is linear in each variable, or
 * smooth: cubic along each axis, with slopes of the parabolas through three points. Beyond the grid it keeps the value
 * of the edge, or is extrapolated in straight lines. Points increase strictly, two on each axis or more. */
typedef struct @PREFIX@_table {
    const double *axes[3]; /* the points of each axis; variables that it does not have need none */
    int points[3]; /* how many there are */
    const double *values; /* in the order of the points, those along the last axis side by side */
    int smooth; /* 1 for continuous slopes, else 0 */
    int extrapolated; /* 1 to go on in straight lines, else 0 */
} @PREFIX@_table;

