// SPDX-License-Identifier: GPL-3.0-or-later
// A line passes an edge on the side that the sign of a determinant of their four points says. The filter is
// J. R. Shewchuk's, "Adaptive precision floating-point arithmetic and fast robust geometric predicates"
// (1997), first stage; the exact tier is whole numbers, as doubles have a common unit.
#include "visibility/line.h"

#include "visibility/exact_double.h"

#include <math.h>
#include <string.h>

/// Below this, times the size of the line's direction, products of two could have lost bits to underflow.
#define TINY 0x1p-900

static void subtract(const double a[3], const double b[3], double difference[3]) {
    for (int i = 0; i < 3; i++) difference[i] = a[i] - b[i];
}

static bool same_point(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; // -0 is 0
}

/// Sign of det(along, a - from, b - from), or 0 if doubles cannot tell.
static int side_quickly(const double along[3], const double a[3], const double b[3]) {
    double sum = 0, magnitude = 0, reach = 1;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double one = a[j] * b[k], two = a[k] * b[j];
        sum += along[i] * (one - two);
        magnitude += fabs(along[i]) * (fabs(one) + fabs(two));
        reach += fabs(along[i]);
    }
    // As in base/exact.c: 8 roundings and a little. NaN and infinity fail the comparison.
    if (!(fabs(sum) > 10 * 0x1p-53 * magnitude) || !(fabs(sum) > TINY * reach) || isinf(magnitude)) return 0;
    return sum > 0 ? 1 : -1;
}

int enf_line_passes_quickly(const enf_line *line, const enf_portal_graph *graph, int32_t portal) {
    const int32_t first = graph->opening_corner[portal >> 1], end = graph->opening_corner[(portal >> 1) + 1];
    const int wanted = portal & 1 ? -1 : 1;
    double along[3], a[3], b[3];
    int edges = 0, unsure = 0;
    subtract(line->to, line->from, along);
    subtract(graph->corners[end - 1], line->from, a);
    for (int32_t i = first, before = end - 1; i < end; before = i++) {
        subtract(graph->corners[i], line->from, b);
        int side = side_quickly(along, a, b);
        if (side == -wanted) return -1;
        if (side == wanted)
            edges++;
        else if (!same_point(graph->corners[i], graph->corners[before]))
            unsure++;
        memcpy(a, b, sizeof a);
    }
    return edges > 0 && unsure == 0;
}

/// Sign of det(to - from, a - from, b - from).
static int side_exactly(const enf_line *line, const double a[3], const double b[3]) {
    const double *const points[4] = {line->from, line->to, a, b};
    mpz_t number[4][3], sum, term;
    int unit = ENF_NO_UNIT;
    for (int i = 0; i < 4; i++) unit = enf_point_unit(points[i], unit);
    for (int i = 0; i < 12; i++) {
        mpz_init(number[i / 3][i % 3]);
        enf_double_to_whole(number[i / 3][i % 3], points[i / 3][i % 3], unit);
        if (i >= 3) mpz_sub(number[i / 3][i % 3], number[i / 3][i % 3], number[0][i % 3]);
    }
    mpz_inits(sum, term, NULL);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpz_mul(term, number[2][j], number[3][k]);
        mpz_submul(term, number[2][k], number[3][j]);
        mpz_addmul(sum, number[1][i], term);
    }
    int sign = mpz_sgn(sum);
    mpz_clears(sum, term, NULL);
    for (int i = 0; i < 12; i++) mpz_clear(number[i / 3][i % 3]);
    return sign;
}

int enf_line_side(const enf_line *line, const double a[3], const double b[3]) {
    double along[3], to_a[3], to_b[3];
    subtract(line->to, line->from, along);
    subtract(a, line->from, to_a);
    subtract(b, line->from, to_b);
    int side = side_quickly(along, to_a, to_b);
    return side ? side : side_exactly(line, a, b);
}

static bool passes_exactly(const enf_line *line, const enf_portal_graph *graph, int32_t portal) {
    const int32_t first = graph->opening_corner[portal >> 1], end = graph->opening_corner[(portal >> 1) + 1];
    int edges = 0;
    for (int32_t i = first, before = end - 1; i < end; before = i++) {
        const double *a = graph->corners[before], *b = graph->corners[i];
        if (same_point(a, b)) continue;
        if (side_exactly(line, a, b) != (portal & 1 ? -1 : 1)) return false;
        edges++;
    }
    return edges > 0;
}

bool enf_line_passes(const enf_line *line, const enf_portal_graph *graph, int32_t portal) {
    int sign = enf_line_passes_quickly(line, graph, portal);
    return sign ? sign > 0 : passes_exactly(line, graph, portal);
}
