// SPDX-License-Identifier: MIT
// The filter of enf_points_side_of_sphere, inline: the Delaunay triangulation asks it more than anything
// else.
#ifndef ENF_BASE_SPHERE_H
#define ENF_BASE_SPHERE_H

#include <stdbool.h>

/// What the filter leaves open: see enf_points_side_of_sphere.
int enf_corners_side_of_sphere_exactly(const double *const corner[4], const double point[3]);

/// Shewchuk's bound A for insphere: (16 + 224u)u times the exact sum of magnitudes.
#define ENF_SPHERE_ERROR (17 * 0x1p-53)

/// Is the determinant so large that its sign is sure? No lift is above `largest`, so no coordinate is above
/// its root: the sum of magnitudes is at most 4 * 6 * largest^2.5. Squares spare the root.
static inline bool enf_sphere_is_sure(double determinant, double largest) {
    const double square = largest * largest, factor = 24 * ENF_SPHERE_ERROR;
    return determinant * determinant > factor * factor * (square * square * largest);
}

/// Two numbers that are worked on at once.
typedef double enf_pair __attribute__((vector_size(16)));

/// A number for each of the four corners.
typedef struct enf_four {
    enf_pair low, high;
} enf_four;

/// A coordinate of the corners, as seen from the point.
static inline enf_four enf_four_take(const double *const corner[4], const double point[3], int axis) {
    const enf_pair origin = {point[axis], point[axis]};
    return (enf_four){(enf_pair){corner[0][axis], corner[1][axis]} - origin,
                      (enf_pair){corner[2][axis], corner[3][axis]} - origin};
}

/// Those of the next corners.
static inline enf_four enf_four_next(enf_four a) {
    return (enf_four){{a.low[1], a.high[0]}, {a.high[1], a.low[0]}};
}

/// The filter: rows a, b, c, d, expanded along the last column. *largest receives the largest lift.
static inline double enf_sphere_determinant(const double *const corner[4], const double point[3],
                                            double *largest) {
    const enf_four x = enf_four_take(corner, point, 0), y = enf_four_take(corner, point, 1),
                   z = enf_four_take(corner, point, 2), x1 = enf_four_next(x), y1 = enf_four_next(y),
                   z1 = enf_four_next(z);
    const enf_four lift = {x.low * x.low + y.low * y.low + z.low * z.low,
                           x.high * x.high + y.high * y.high + z.high * z.high};
    const enf_four near = {x.low * y1.low - x1.low * y.low, x.high * y1.high - x1.high * y.high},
                   near1 = enf_four_next(near);
    const enf_pair across = x.low * y.high - x.high * y.low;                          // of a and c, b and d
    const enf_four volume = {z.low * near1.low - z1.low * across + z.high * near.low, // abc, bcd, cda, dab
                             z.high * near1.high + z1.high * across + z.low * near.high};
    const enf_four other = enf_four_next(volume);
    const enf_pair low = lift.low * other.low, high = lift.high * other.high;
    const double even = lift.low[0] > lift.high[0] ? lift.low[0] : lift.high[0],
                 odd = lift.low[1] > lift.high[1] ? lift.low[1] : lift.high[1];
    *largest = even > odd ? even : odd;
    return (low[0] - low[1]) + (high[0] - high[1]);
}

/// enf_points_side_of_sphere for corners in a row.
static inline int enf_corners_side_of_sphere(const double *const corner[4], const double point[3]) {
    double largest, determinant = enf_sphere_determinant(corner, point, &largest);
    if (enf_sphere_is_sure(determinant, largest)) return determinant > 0 ? 1 : -1;
    return enf_corners_side_of_sphere_exactly(corner, point);
}

#endif
