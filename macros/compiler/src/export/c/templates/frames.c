#if LINKS
static const int lw_parent_of[@LINKS@] = {@PARENTS@};
static const int lw_link_of[@FRAMES@] = {@CARRIERS@};
static const int lw_first_column[@LINKS@ + 1] = {@FIRST_COLUMNS@};
static const int lw_column_of[] = {@COLUMNS_OF_LINKS@};

/* The links from the ground to a frame, the last one first. */
static int lw_path_to(int frame, int *path) {
    int count = 0;
    for (int link = lw_link_of[frame]; link >= 0; link = lw_parent_of[link]) {
        path[count++] = link;
    }
    return count;
}

static void lw_copy(int n, const double *from, double *to) {
    for (int i = 0; i < n; ++i) {
        to[i] = from[i];
    }
}

@link_placement@@link_twist@@link_acceleration@@link_columns@
#endif
@placement_on_link@@twist_on_link@@acceleration_on_link@/* Rotation matrices are stored by rows in p. */
@frame_placement@ {
@UNUSED@    (void)(q);
    if (frame < 0 || frame >= @FRAMES@) {
        return 1;
    }
    double p[12] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0}, placed[12];
#if LINKS
    int path[@LINKS@];
    for (int k = lw_path_to(frame, path) - 1; k >= 0; --k) {
        double next[12];
        lw_link_placement(path[k], @OWN@@T@q, p, next);
        lw_copy(12, next, p);
    }
#endif
    lw_placement_on_link(frame, @OWN@p, placed);
    for (int k = 0; k < 9; ++k) {
        result[k] = placed[3 * (k % 3) + k / 3];
    }
    for (int k = 9; k < 12; ++k) {
        result[k] = placed[k];
    }
    return 0;
}

@frame_velocity@ {
@UNUSED@    (void)(q);
    (void)(v);
    if (frame < 0 || frame >= @FRAMES@) {
        return 1;
    }
    /* Placement, then twist. */
    double p[18] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
#if LINKS
#if SPEEDS
    double rates[@NV@];
    @PREFIX@_rates_of_speeds(@OWN@q, v, rates);
#endif
    int path[@LINKS@];
    for (int k = lw_path_to(frame, path) - 1; k >= 0; --k) {
        double next[12];
        lw_link_placement(path[k], @OWN@@T@q, p, next);
        lw_copy(12, next, p);
        lw_link_twist(path[k], @OWN@@T@q, @RATES@, p + 12, next);
        lw_copy(6, next, p + 12);
    }
#endif
    lw_twist_on_link(frame, @OWN@p, result);
    return 0;
}

@frame_acceleration@ {
@UNUSED@    (void)(q);
    (void)(v);
    (void)(a);
    if (frame < 0 || frame >= @FRAMES@) {
        return 1;
    }
    /* Placement, then twist, then acceleration. */
    double p[24] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
#if LINKS
#if SPEEDS
    double rates[@NV@], changes[@NV@];
    @PREFIX@_rates_of_speeds(@OWN@q, v, rates);
    @PREFIX@_rate_accelerations(@OWN@q, v, a, changes);
#endif
    int path[@LINKS@];
    for (int k = lw_path_to(frame, path) - 1; k >= 0; --k) {
        double next[12];
        lw_link_placement(path[k], @OWN@@T@q, p, next);
        lw_copy(12, next, p);
        lw_link_acceleration(path[k], @OWN@@T@q, @RATES@, @CHANGES@, p + 12, next + 6);
        lw_link_twist(path[k], @OWN@@T@q, @RATES@, p + 12, next);
        lw_copy(12, next, p + 12);
    }
#endif
    lw_acceleration_on_link(frame, @OWN@p, result);
    return 0;
}

@frame_jacobian@ {
@UNUSED@    (void)(q);
    if (frame < 0 || frame >= @FRAMES@) {
        return 1;
    }
    for (int k = 0; k < 6 * @N@; ++k) {
        result[k] = 0.0;
    }
#if LINKS
    double p[12] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};
    double placements[12 * @LINKS@], placement[12];
    int path[@LINKS@];
    const int count = lw_path_to(frame, path);
    for (int k = count - 1; k >= 0; --k) {
        double next[12];
        lw_link_placement(path[k], @OWN@@T@q, p, next);
        lw_copy(12, next, p);
        lw_copy(12, next, placements + 12 * k);
    }
    lw_placement_on_link(frame, @OWN@p, placement);
    /* Coordinates of joints that follow one another share a column. */
    for (int k = 0; k < count; ++k) {
        const int first = lw_first_column[path[k]], end = lw_first_column[path[k] + 1];
        double columns[6 * @MOST_COLUMNS@] = {0.0};
        lw_link_columns(path[k], @OWN@@T@q, placements + 12 * k, placement + 9, columns);
        for (int c = first; c < end; ++c) {
            for (int i = 0; i < 6; ++i) {
                result[6 * lw_column_of[c] + i] += columns[6 * (c - first) + i];
            }
        }
    }
#if SPEEDS
    /* The Jacobian with respect to the generalized speeds. */
    double joints[6 * @NV@], z[@NV@ * @NV@];
    @PREFIX@_rate_matrix(@OWN@q, z);
    for (int k = 0; k < 6 * @N@; ++k) {
        joints[k] = result[k];
    }
    for (int j = 0; j < @N@; ++j) {
        for (int i = 0; i < 6; ++i) {
            double sum = 0.0;
            for (int k = 0; k < @N@; ++k) {
                sum += joints[6 * k + i] * z[j * @N@ + k];
            }
            result[6 * j + i] = sum;
        }
    }
#endif
#endif
    return 0;
}
