// SPDX-License-Identifier: GPL-3.0-or-later
// T. J. Dekker, "A floating-point technique for extending the available precision" (1971). Sums are his
// simpler ones, whose error is at most 2^-104 of |a| + |b|; products are off by at most 2^-102 of themselves.
#include "build/doubled_plane.h"

#include <math.h>

/// Below: how far a determinant can be off, as a part of 6 * size^4 * reach, which bounds the sum of its
/// terms' sizes. Each term passes through no more than three products of pairs, ten sums, and coefficients
/// that are off by less than 2^-100: together less than 2^-97.
#define ROUNDING 0x1p-97
#define UNSURE (6 * ROUNDING)

#define WHOLE_MAX 0x1p53

/// Products take one instruction on processors that have a fused multiply-add; elsewhere the library's fma
/// gives the very same numbers.
#if defined __x86_64__ && defined __gnu_linux__ && defined __GNUC__ && !defined __clang__ && \
    !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__ && !defined __FMA__
#define FUSED __attribute__((target_clones("default", "fma")))
#define ENCLOSED static inline __attribute__((always_inline)) // in both versions
#else
#define FUSED
#define ENCLOSED static inline
#endif

static inline enf_doubled quick_sum(double a, double b) { // |a| >= |b|
    double sum = a + b;
    return (enf_doubled){sum, b - (sum - a)};
}

static inline enf_doubled add(enf_doubled a, enf_doubled b) {
    double sum = a.high + b.high, part = sum - a.high;
    double error = (a.high - (sum - part)) + (b.high - part);
    return quick_sum(sum, error + (a.low + b.low));
}

static inline enf_doubled negative(enf_doubled a) {
    return (enf_doubled){-a.high, -a.low};
}

static inline enf_doubled subtract(enf_doubled a, enf_doubled b) {
    return add(a, negative(b));
}

/// Exact.
static inline enf_doubled multiply_doubles(double a, double b) {
    double product = a * b;
    return (enf_doubled){product, fma(a, b, -product)};
}

static inline enf_doubled multiply(enf_doubled a, enf_doubled b) {
    enf_doubled product = multiply_doubles(a.high, b.high);
    return quick_sum(product.high, product.low + (a.high * b.low + a.low * b.high));
}

static inline enf_doubled multiply_by(enf_doubled a, double b) {
    enf_doubled product = multiply_doubles(a.high, b);
    return quick_sum(product.high, product.low + a.low * b);
}

FUSED bool enf_doubled_plane_set(enf_doubled_plane *plane, const double p[3], const double u[3],
                                 const double v[3], const double origin[3]) {
    double away[3], size = 0, reach = 0;
    bool fits = true;
    for (int i = 0; i < 3; i++) {
        away[i] = origin[i] - p[i];
        fits &= fabs(u[i]) < WHOLE_MAX && fabs(v[i]) < WHOLE_MAX && fabs(away[i]) < WHOLE_MAX;
        reach += fabs(away[i]);
    }
    if (!fits) return false;
    plane->offset = (enf_doubled){0, 0};
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        enf_doubled one = multiply_doubles(u[j], v[k]), two = multiply_doubles(u[k], v[j]);
        double both = fabs(one.high) + fabs(two.high);
        size = both > size ? both : size;
        plane->normal[i] = subtract(one, two);
        plane->offset = add(plane->offset, multiply_by(plane->normal[i], away[i]));
    }
    plane->size = size;
    plane->reach = reach;
    return true;
}

ENCLOSED enf_doubled minor(const enf_doubled_plane *a, const enf_doubled_plane *b, int i) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    return subtract(multiply(a->normal[j], b->normal[k]), multiply(a->normal[k], b->normal[j]));
}

/// As seen from the origin, which lies in the first plane: at = offset_b * c x a + offset_c * a x b,
/// weight = c . (a x b).
FUSED void enf_doubled_planes_meet(const enf_doubled_plane plane[3], enf_doubled_meeting *meeting) {
    const enf_doubled_plane *a = &plane[0], *b = &plane[1], *c = &plane[2];
    enf_doubled weight = {0, 0};
    for (int i = 0; i < 3; i++) {
        enf_doubled from_b = minor(c, a, i), from_c = minor(a, b, i);
        meeting->at[i] = add(multiply(b->offset, from_b), multiply(c->offset, from_c));
        weight = add(weight, multiply(c->normal[i], from_c));
    }
    meeting->weight = weight;
    meeting->size = a->size * b->size * c->size;
    meeting->reach = b->reach + c->reach;
}

int enf_doubled_meeting_weight_sign(const enf_doubled_meeting *meeting) {
    if (!(fabs(meeting->weight.high) > 2 * UNSURE * meeting->size)) return 0;
    return meeting->weight.high > 0 ? 1 : -1;
}

FUSED bool enf_doubled_meeting_point(const enf_doubled_meeting *meeting, const double origin[3],
                                     double point[3]) {
    const enf_doubled *at = meeting->at, weight = meeting->weight;
    double farthest = 0;
    if (enf_doubled_meeting_weight_sign(meeting) == 0) return false;
    for (int i = 0; i < 3; i++) {
        double quotient = at[i].high / weight.high;
        enf_doubled rest = subtract(at[i], multiply_by(weight, quotient));
        enf_doubled place =
            add((enf_doubled){origin[i], 0}, (enf_doubled){-quotient, -rest.high / weight.high});
        point[i] = place.high; // one rounding: the same for other planes through the point
        farthest = fabs(quotient) > farthest ? fabs(quotient) : farthest;
    }
    // What `at` can be off, and the weight: the latter may be half of what it seems.
    double off = ROUNDING * meeting->size * (2 * meeting->reach + 6 * (farthest + 1));
    return 2 * off < 0.25 * fabs(weight.high);
}

FUSED int enf_doubled_meeting_sign(const enf_doubled_meeting *meeting, const enf_doubled_plane *plane) {
    enf_doubled value = multiply(plane->offset, meeting->weight);
    for (int i = 0; i < 3; i++) value = subtract(value, multiply(plane->normal[i], meeting->at[i]));
    double terms = meeting->size * plane->size * (meeting->reach + plane->reach);
    if (fabs(value.high) > UNSURE * terms) return value.high > 0 ? 1 : -1;
    return 0;
}
