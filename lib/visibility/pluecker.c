// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/pluecker.h"

#include "base/array.h"
#include "visibility/exact_double.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Coordinates and lengths between these can be multiplied a few times without leaving the range of doubles.
#define LARGE 0x1p200
#define SMALL 0x1p-200

static int64_t common_divisor(int64_t a, int64_t b) {
    while (b) {
        const int64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a < 0 ? -a : a;
}

/// The direction in whole numbers without common divisor, if these are small.
static void set_small(enf_pluecker_edge *edge) {
    const int unit = enf_point_unit(edge->to, enf_point_unit(edge->from, ENF_NO_UNIT));
    int64_t along[3], divisor = 0;
    edge->unit = enf_point_unit(edge->from, ENF_NO_UNIT);
    if (unit < -1000 || unit > 1000) return;
    for (int i = 0; i < 3; i++) {
        const double from = ldexp(edge->from[i], -unit), to = ldexp(edge->to[i], -unit);
        if (!(fabs(from) < 0x1p61 && fabs(to) < 0x1p61)) return;
        along[i] = (int64_t)to - (int64_t)from;
        divisor = common_divisor(divisor, along[i]);
    }
    for (int i = 0; divisor && i < 3; i++) {
        if (along[i] / divisor > 1 << 24 || along[i] / divisor < -(1 << 24)) return;
        edge->small[i] = (int32_t)(along[i] / divisor);
    }
    edge->is_small = divisor != 0;
}

static bool edge_make(enf_pluecker_edge *edge, const double from[3], const double to[3]) {
    double square = 0;
    memcpy(edge->from, from, sizeof edge->from);
    memcpy(edge->to, to, sizeof edge->to);
    for (int i = 0; i < 3; i++) {
        edge->along[i] = to[i] - from[i];
        square += edge->along[i] * edge->along[i];
    }
    set_small(edge);
    const double length = sqrt(square);
    if (!(length > SMALL && length < LARGE)) return false;
    for (int i = 0; i < 3; i++) edge->along[i] /= length;
    return true;
}

static bool same_point(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/// Box, middle and unit of the corners.
static void measure(enf_pluecker_opening *opening, const double (*corners)[3], int32_t count) {
    opening->unit = ENF_NO_UNIT;
    for (int i = 0; i < 3; i++) opening->low[i] = opening->high[i] = corners[0][i];
    for (int32_t k = 0; k < count; k++) {
        opening->unit = enf_point_unit(corners[k], opening->unit);
        for (int i = 0; i < 3; i++) {
            opening->low[i] = fmin(opening->low[i], corners[k][i]);
            opening->high[i] = fmax(opening->high[i], corners[k][i]);
            opening->middle[i] += corners[k][i] / count;
            opening->rough |= !(fabs(corners[k][i]) < LARGE);
        }
    }
}

/// Newell's: the sum of what the edges span with the middle.
static void add_to_normal(double normal[3], const double middle[3], const double a[3], const double b[3]) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] += (a[j] - middle[j]) * (b[k] - middle[k]) - (a[k] - middle[k]) * (b[j] - middle[j]);
    }
}

static void make_unit(double normal[3]) {
    const double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int i = 0; i < 3; i++) normal[i] = length > SMALL && length < LARGE ? normal[i] / length : 0;
}

/// Appends the opening's edges; returns how many.
static int32_t opening_make(enf_pluecker_opening *opening, enf_pluecker_edge *edges,
                            const double (*corners)[3], int32_t count) {
    int32_t made = 0;
    measure(opening, corners, count);
    for (int32_t k = 0, before = count - 1; k < count; before = k++) {
        if (same_point(corners[before], corners[k])) continue;
        opening->rough |= !edge_make(&edges[made++], corners[before], corners[k]);
        add_to_normal(opening->normal, opening->middle, corners[before], corners[k]);
    }
    make_unit(opening->normal);
    if (made > 0) return made;
    edge_make(edges, corners[0], corners[0]);
    opening->rough = true;
    return 1;
}

bool enf_pluecker_make(enf_pluecker *pluecker, const enf_portal_graph *graph) {
    const int32_t openings = graph->opening_count, corners = openings ? graph->opening_corner[openings] : 0;
    *pluecker = (enf_pluecker){.graph = graph,
                               .opening_edge = enf_array_zeroed((size_t)openings + 1, sizeof(int32_t)),
                               .edges = enf_array_zeroed((size_t)corners, sizeof(enf_pluecker_edge)),
                               .openings = enf_array_zeroed((size_t)openings, sizeof(enf_pluecker_opening))};
    if (!pluecker->opening_edge || !pluecker->edges || !pluecker->openings) return false;
    for (int32_t k = 0; k < openings; k++) {
        const int32_t first = graph->opening_corner[k], edge = pluecker->opening_edge[k];
        const double(*corner)[3] = (const double(*)[3])(graph->corners + first);
        pluecker->opening_edge[k + 1] = edge + opening_make(&pluecker->openings[k], pluecker->edges + edge,
                                                            corner, graph->opening_corner[k + 1] - first);
    }
    return true;
}

void enf_pluecker_free(enf_pluecker *pluecker) {
    free(pluecker->opening_edge);
    free(pluecker->edges);
    free(pluecker->openings);
    *pluecker = (enf_pluecker){0};
}
