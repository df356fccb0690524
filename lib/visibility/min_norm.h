// SPDX-License-Identifier: GPL-3.0-or-later
// The shortest vector in the convex hull of vectors in R^6: P. Wolfe, "Finding the nearest point in a
// polytope", Mathematical Programming 11 (1976). By Gordan's theorem either some x has <x, e> > 0 for all
// vectors e, and the shortest vector is one such, or 0 is in the hull.
#ifndef ENF_VISIBILITY_MIN_NORM_H
#define ENF_VISIBILITY_MIN_NORM_H

#include <stdint.h>

enum { ENF_PLUECKER = 6, ENF_HULL_MAX = 7 };

typedef enum enf_min_norm_answer {
    ENF_MIN_NORM_POSITIVE, ///< <x, e> > margin * |x| for all vectors
    ENF_MIN_NORM_ZERO,     ///< x is next to 0
    ENF_MIN_NORM_STUCK,    ///< doubles did not get any further
} enf_min_norm_answer;

/// x = sum of weight[i] * vector[member[i]], weights positive with sum 1; the members affinely independent.
typedef struct enf_min_norm {
    double x[ENF_PLUECKER];
    int size;
    int32_t member[ENF_HULL_MAX];
    double weight[ENF_HULL_MAX];
} enf_min_norm;

/// Vectors in columns: coordinate i of vector k is vectors[i * stride + k]; none is much longer than 1.
/// `start` may be null: a direction that is thought to have large <start, e>. Ends as soon as all <x, e>
/// exceed margin * |x| and share * |x|^2; a share of 1 would be the shortest vector itself. `products` is
/// room for count doubles.
enf_min_norm_answer enf_min_norm_find(const double *vectors, int32_t count, int32_t stride,
                                      const double *start, double margin, double share, double *products,
                                      enf_min_norm *found);

/// products[k] = <x, vector k>; returns the index of the least, the first of equals.
int32_t enf_min_norm_least(const double *vectors, int32_t count, int32_t stride, const double x[ENF_PLUECKER],
                           double *products);

#endif
