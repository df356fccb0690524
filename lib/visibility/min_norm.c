// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/min_norm.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/// None of these decides anything: what comes out is checked elsewhere.
static const double next_to_zero = 1e-20; ///< |x|^2
static const double pivot_least = 1e-14;  ///< of the squares of the triangle's diagonal
enum { ROUNDS = 200 };

typedef struct corral {
    enf_min_norm *found;
    double vector[ENF_HULL_MAX][ENF_PLUECKER];
    double product[ENF_HULL_MAX][ENF_HULL_MAX]; ///< <vector, vector> + 1
} corral;

static double dot(const double a[ENF_PLUECKER], const double b[ENF_PLUECKER]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

int32_t enf_min_norm_least(const double *vectors, int32_t count, int32_t stride, const double x[ENF_PLUECKER],
                           double *products) {
    const double *e0 = vectors, *e1 = e0 + stride, *e2 = e1 + stride, *e3 = e2 + stride, *e4 = e3 + stride,
                 *e5 = e4 + stride;
    const double x0 = x[0], x1 = x[1], x2 = x[2], x3 = x[3], x4 = x[4], x5 = x[5];
    for (int32_t k = 0; k < count; k++)
        products[k] = x0 * e0[k] + x1 * e1[k] + x2 * e2[k] + x3 * e3[k] + x4 * e4[k] + x5 * e5[k];
    int32_t least = 0;
    for (int32_t k = 1; k < count; k++) least = products[k] < products[least] ? k : least;
    return least;
}

static void corral_add(corral *c, const double *vectors, int32_t stride, int32_t k) {
    const int n = c->found->size++;
    c->found->member[n] = k;
    c->found->weight[n] = 0;
    for (int i = 0; i < ENF_PLUECKER; i++) c->vector[n][i] = vectors[(size_t)i * (size_t)stride + (size_t)k];
    for (int i = 0; i <= n; i++) c->product[n][i] = c->product[i][n] = dot(c->vector[n], c->vector[i]) + 1;
}

static void corral_remove(corral *c, int at) {
    const int last = --c->found->size;
    c->found->member[at] = c->found->member[last];
    c->found->weight[at] = c->found->weight[last];
    memcpy(c->vector[at], c->vector[last], sizeof c->vector[at]);
    memcpy(c->product[at], c->product[last], sizeof c->product[at]);
    for (int i = 0; i < last; i++) c->product[i][at] = c->product[at][i];
    c->product[at][at] = dot(c->vector[at], c->vector[at]) + 1;
}

static void corral_point(corral *c) {
    memset(c->found->x, 0, sizeof c->found->x);
    for (int n = 0; n < c->found->size; n++) {
        for (int i = 0; i < ENF_PLUECKER; i++) c->found->x[i] += c->found->weight[n] * c->vector[n][i];
    }
}

/// The weights, of either sign, of the shortest vector in the members' affine hull: product * weight is the
/// same in all rows. By Cholesky's triangle; false if the members are as good as dependent.
static bool affine_weights(const corral *c, double weight[ENF_HULL_MAX]) {
    double triangle[ENF_HULL_MAX][ENF_HULL_MAX], inverse[ENF_HULL_MAX], sum = 0;
    const int n = c->found->size;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double rest = c->product[i][j];
            for (int k = 0; k < j; k++) rest -= triangle[i][k] * triangle[j][k];
            if (j < i) {
                triangle[i][j] = rest * inverse[j];
            } else {
                if (!(rest > pivot_least)) return false;
                inverse[i] = 1 / sqrt(rest);
            }
        }
    }
    for (int i = 0; i < n; i++) {
        double rest = 1;
        for (int k = 0; k < i; k++) rest -= triangle[i][k] * weight[k];
        weight[i] = rest * inverse[i];
    }
    for (int i = n - 1; i >= 0; i--) {
        double rest = weight[i];
        for (int k = i + 1; k < n; k++) rest -= triangle[k][i] * weight[k];
        weight[i] = rest * inverse[i];
        sum += weight[i];
    }
    for (int i = 0; i < n; i++) weight[i] /= sum;
    return true;
}

/// Goes from the weights towards the wanted ones until the first of those that shrink below 0 is 0; returns
/// its index, -1 if the wanted ones are reached.
static int walk(double *weight, const double *wanted, int n) {
    double step = 1;
    int first = -1;
    for (int i = 0; i < n; i++) {
        if (wanted[i] > 0 || !(weight[i] - wanted[i] > 0)) continue;
        double until = weight[i] / (weight[i] - wanted[i]);
        if (first >= 0 && until >= step) continue;
        step = until;
        first = i;
    }
    for (int i = 0; i < n; i++) weight[i] += step * (wanted[i] - weight[i]);
    return first;
}

/// Makes x the shortest vector of its members' hull, and leaves out members that it does not need.
static bool settle(corral *c) {
    double wanted[ENF_HULL_MAX];
    for (;;) {
        if (!affine_weights(c, wanted)) return false;
        int out = -1;
        for (int i = 0; i < c->found->size; i++) {
            if (!(wanted[i] > 0)) out = i;
        }
        if (out >= 0) out = walk(c->found->weight, wanted, c->found->size);
        if (out < 0) {
            memcpy(c->found->weight, wanted, sizeof(double) * (size_t)c->found->size);
            corral_point(c);
            return true;
        }
        corral_remove(c, out);
    }
}

static bool is_member(const enf_min_norm *found, int32_t k) {
    for (int i = 0; i < found->size; i++) {
        if (found->member[i] == k) return true;
    }
    return false;
}

/// Is the start itself such an x?
static bool start_does(const double *start, const double *products, int32_t least, double margin,
                       enf_min_norm *found) {
    if (!(products[least] > margin * sqrt(dot(start, start)))) return false;
    memcpy(found->x, start, sizeof found->x);
    return true;
}

enf_min_norm_answer enf_min_norm_find(const double *vectors, int32_t count, int32_t stride,
                                      const double *start, double margin, double share, double *products,
                                      enf_min_norm *found) {
    corral c = {.found = found};
    int32_t least = start ? enf_min_norm_least(vectors, count, stride, start, products) : 0;
    found->size = 0;
    if (start && share <= 0 && start_does(start, products, least, margin, found))
        return ENF_MIN_NORM_POSITIVE;
    corral_add(&c, vectors, stride, least);
    found->weight[0] = 1;
    corral_point(&c);
    for (int round = 0; round < ROUNDS; round++) {
        const double square = dot(found->x, found->x);
        if (square < next_to_zero) return ENF_MIN_NORM_ZERO;
        least = enf_min_norm_least(vectors, count, stride, found->x, products);
        if (products[least] > margin * sqrt(square) && products[least] > share * square)
            return ENF_MIN_NORM_POSITIVE;
        if (is_member(found, least) || found->size == ENF_HULL_MAX) break;
        corral_add(&c, vectors, stride, least);
        if (!settle(&c) || !is_member(found, least)) break;
    }
    return ENF_MIN_NORM_STUCK;
}
