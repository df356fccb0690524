// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/line_order.h"

#include "visibility/decimal.h"

#include <math.h>

typedef mpq_t point[3];

/// Exact numbers, made when they are needed.
typedef struct numbers {
    point from, to, crossing, u, v;
    mpq_t a, b, c;
} numbers;

static void each_number(numbers *numbers, void (*act)(mpq_ptr)) {
    mpq_ptr const single[3] = {numbers->a, numbers->b, numbers->c};
    for (int i = 0; i < 3; i++) {
        act(numbers->from[i]);
        act(numbers->to[i]);
        act(numbers->crossing[i]);
        act(numbers->u[i]);
        act(numbers->v[i]);
        act(single[i]);
    }
}

static void set_line(numbers *numbers, const enf_line *line, const char *decimals) {
    int digits;
    for (int i = 0; i < 6; i++) {
        mpq_ptr number = i < 3 ? numbers->from[i] : numbers->to[i - 3];
        if (decimals)
            enf_decimal_read(number, &decimals, &digits);
        else
            mpq_set_d(number, i < 3 ? line->from[i] : line->to[i - 3]);
    }
}

/// c = how high the point is above the plane through three corners, times the size of the triangle.
static void set_height(numbers *numbers, point at, const double a[3], const double b[3], const double c[3]) {
    for (int i = 0; i < 3; i++) {
        mpq_set_d(numbers->a, a[i]);
        mpq_set_d(numbers->u[i], b[i]);
        mpq_sub(numbers->u[i], numbers->u[i], numbers->a);
        mpq_set_d(numbers->v[i], c[i]);
        mpq_sub(numbers->v[i], numbers->v[i], numbers->a);
    }
    mpq_set_ui(numbers->c, 0, 1);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpq_mul(numbers->a, numbers->u[j], numbers->v[k]);
        mpq_mul(numbers->b, numbers->u[k], numbers->v[j]);
        mpq_sub(numbers->a, numbers->a, numbers->b);
        mpq_set_d(numbers->b, a[i]);
        mpq_sub(numbers->b, at[i], numbers->b);
        mpq_mul(numbers->a, numbers->a, numbers->b);
        mpq_add(numbers->c, numbers->c, numbers->a);
    }
}

/// Where the line crosses the plane; false if nowhere.
static bool set_crossing(numbers *numbers, const double a[3], const double b[3], const double c[3]) {
    mpq_t start;
    mpq_init(start);
    set_height(numbers, numbers->from, a, b, c);
    mpq_set(start, numbers->c);
    set_height(numbers, numbers->to, a, b, c);
    mpq_sub(numbers->c, start, numbers->c);
    bool crosses = mpq_sgn(numbers->c) != 0;
    if (crosses) mpq_div(start, start, numbers->c);
    for (int i = 0; i < 3 && crosses; i++) {
        mpq_sub(numbers->a, numbers->to[i], numbers->from[i]);
        mpq_mul(numbers->a, numbers->a, start);
        mpq_add(numbers->crossing[i], numbers->from[i], numbers->a);
    }
    mpq_clear(start);
    return crosses;
}

/// Is the crossing beyond one of the portal's planes?
static bool is_beyond(numbers *numbers, const enf_portal_graph *graph, int32_t portal) {
    int32_t first = graph->opening_corner[portal >> 1], end = graph->opening_corner[(portal >> 1) + 1];
    for (int32_t i = first + 1; i + 1 < end; i++) {
        set_height(numbers, numbers->crossing, graph->corners[first], graph->corners[i],
                   graph->corners[i + 1]);
        if (mpq_sgn(numbers->c) * (portal & 1 ? -1 : 1) > 0) return true;
    }
    return false;
}

static bool comes_after(numbers *numbers, const enf_portal_graph *graph, int32_t before, int32_t after) {
    int32_t first = graph->opening_corner[after >> 1], end = graph->opening_corner[(after >> 1) + 1];
    for (int32_t i = first + 1; i + 1 < end; i++)
        if (set_crossing(numbers, graph->corners[first], graph->corners[i], graph->corners[i + 1]) &&
            is_beyond(numbers, graph, before))
            return true;
    return false;
}

static bool comes_after_exactly(const enf_portal_graph *graph, const enf_line *line, const char *decimals,
                                int32_t before, int32_t after) {
    numbers numbers;
    each_number(&numbers, mpq_init);
    set_line(&numbers, line, decimals);
    bool good = comes_after(&numbers, graph, before, after);
    each_number(&numbers, mpq_clear);
    return good;
}

/// Doubles can tell if the line rises through both planes by more than this, of its length, and the crossings
/// are this far apart, of the size of the world.
static const double steep = 0x1p-20, apart = 0x1p-16;

bool enf_line_is_in_order(const enf_shapes *shapes, const enf_line *line, const char *decimals,
                          const int32_t *sequence, int32_t count) {
    double way[3] = {line->to[0] - line->from[0], line->to[1] - line->from[1], line->to[2] - line->from[2]};
    double length = sqrt(enf_dot(way, way)), before = 0;
    bool was_steep = false;
    for (int32_t i = 0; i < count; i++) {
        double start = enf_shape_height(shapes, sequence[i], line->from);
        double rise = enf_shape_height(shapes, sequence[i], line->to) - start, at = -start / rise * length;
        bool is_steep = !decimals && rise > length * steep;
        bool is_sure = is_steep && was_steep && at - before > shapes->extent * apart;
        if (i > 0 && !is_sure &&
            !comes_after_exactly(shapes->graph, line, decimals, sequence[i - 1], sequence[i]))
            return false;
        before = at;
        was_steep = is_steep;
    }
    return true;
}
