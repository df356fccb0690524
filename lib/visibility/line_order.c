// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/line_order.h"

#include "visibility/decimal.h"

#include <math.h>

typedef mpq_t point[3];

/// A triangle of a winding's fan.
typedef struct triangle {
    const double *corner[3];
} triangle;

/// Exact numbers, made when they are needed.
typedef struct numbers {
    point from, to, along, at, u, v;
    mpq_t a, b, sum, before, after;
} numbers;

static void each_number(numbers *n, void (*act)(mpq_ptr)) {
    mpq_ptr const single[5] = {n->a, n->b, n->sum, n->before, n->after};
    for (int i = 0; i < 5; i++) act(single[i]);
    for (int i = 0; i < 3; i++) {
        act(n->from[i]);
        act(n->to[i]);
        act(n->along[i]);
        act(n->at[i]);
        act(n->u[i]);
        act(n->v[i]);
    }
}

static void set_line(numbers *n, const enf_line *line, const char *decimals) {
    int digits;
    for (int i = 0; i < 6; i++) {
        mpq_ptr number = i < 3 ? n->from[i] : n->to[i - 3];
        if (decimals)
            enf_decimal_read(number, &decimals, &digits);
        else
            mpq_set_d(number, i < 3 ? line->from[i] : line->to[i - 3]);
    }
    for (int i = 0; i < 3; i++) mpq_sub(n->along[i], n->to[i], n->from[i]);
}

/// out = to - from
static void set_way(numbers *n, point out, const double from[3], const double to[3]) {
    for (int i = 0; i < 3; i++) {
        mpq_set_d(out[i], to[i]);
        mpq_set_d(n->a, from[i]);
        mpq_sub(out[i], out[i], n->a);
    }
}

/// sum = (u x v) . w
static void set_volume(numbers *n, point w) {
    mpq_set_ui(n->sum, 0, 1);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpq_mul(n->a, n->u[j], n->v[k]);
        mpq_mul(n->b, n->u[k], n->v[j]);
        mpq_sub(n->a, n->a, n->b);
        mpq_mul(n->a, n->a, w[i]);
        mpq_add(n->sum, n->sum, n->a);
    }
}

/// On which side does the line pass the way from one corner to another? 1: as portal 2k wants it.
static int side_of(numbers *n, const double a[3], const double b[3]) {
    for (int i = 0; i < 3; i++) {
        mpq_set_d(n->u[i], a[i]);
        mpq_set_d(n->v[i], b[i]);
        mpq_sub(n->u[i], n->u[i], n->from[i]);
        mpq_sub(n->v[i], n->v[i], n->from[i]);
    }
    set_volume(n, n->along);
    return mpq_sgn(n->sum);
}

/// sum = how high the point is above the triangle's plane, in units of no meaning.
static void set_height(numbers *n, const triangle *triangle, point at) {
    const double *origin = triangle->corner[0];
    set_way(n, n->u, origin, triangle->corner[1]);
    set_way(n, n->v, origin, triangle->corner[2]);
    for (int i = 0; i < 3; i++) {
        mpq_set_d(n->a, origin[i]);
        mpq_sub(n->at[i], at[i], n->a);
    }
    set_volume(n, n->at);
}

/// share = where the line comes to the triangle's plane, as a share of the way from -> to; false if nowhere.
static bool set_share(numbers *n, const triangle *triangle, mpq_t share) {
    set_height(n, triangle, n->from);
    mpq_set(share, n->sum);
    set_height(n, triangle, n->to);
    mpq_sub(n->sum, share, n->sum);
    if (mpq_sgn(n->sum) == 0) return false;
    mpq_div(share, share, n->sum);
    return true;
}

/// share = where the line goes through one of a portal's triangles; false if it does not.
static bool find_share(numbers *n, const enf_portal_graph *graph, int32_t portal, mpq_t share) {
    const int32_t first = graph->opening_corner[portal >> 1], end = graph->opening_corner[(portal >> 1) + 1];
    const double(*corners)[3] = (const double(*)[3])graph->corners;
    const int wanted = portal & 1 ? -1 : 1;
    for (int32_t i = first + 1; i + 1 < end; i++) {
        const triangle triangle = {{corners[first], corners[i], corners[i + 1]}};
        if (side_of(n, corners[first], corners[i]) * wanted >= 0 &&
            side_of(n, corners[i + 1], corners[first]) * wanted >= 0 && set_share(n, &triangle, share))
            return true;
    }
    return false;
}

static bool comes_after(const enf_portal_graph *graph, const enf_line *line, const char *decimals,
                        int32_t before, int32_t after) {
    numbers n;
    each_number(&n, mpq_init);
    set_line(&n, line, decimals);
    bool good = find_share(&n, graph, before, n.before) && find_share(&n, graph, after, n.after) &&
                mpq_cmp(n.before, n.after) < 0;
    each_number(&n, mpq_clear);
    return good;
}

/// A place on the line as doubles tell it: how far along, and by how much that may be off.
typedef struct place {
    double at, error; ///< world units; the error is infinite for a line that hardly rises
} place;

/// Doubles are not asked about lines that rise by less than this, of their length.
static const double steep = 0x1p-20;

/// The line goes through the portal within the shapes' tolerance of its plane; so far off are heights, too,
/// of points that are not too far outside of the world.
static place find_place_quickly(const enf_shapes *shapes, int32_t portal, const enf_line *line,
                                double length) {
    double start = enf_shape_height(shapes, portal, line->from);
    double rise = enf_shape_height(shapes, portal, line->to) - start;
    if (!(rise > length * steep)) return (place){.error = HUGE_VAL};
    double at = -start / rise * length;
    return (place){at, shapes->tolerance * (length + fabs(at)) / rise};
}

/// Its length in world units; infinite if it ends too far outside of the world.
static double measure(const enf_shapes *shapes, const enf_line *line) {
    double square = 0, reach = 0;
    for (int i = 0; i < 3; i++) {
        double way = line->to[i] - line->from[i];
        reach = fmax(reach, fmax(fabs(line->from[i]), fabs(line->to[i])));
        square += way * way;
    }
    return reach < 4 * shapes->extent ? sqrt(square) : HUGE_VAL;
}

static bool is_surely_ahead(place before, place after) {
    return after.at - before.at > before.error + after.error;
}

bool enf_line_surely_in_order(const enf_shapes *shapes, const enf_line *line, int32_t before, int32_t after) {
    double length = measure(shapes, line);
    return is_surely_ahead(find_place_quickly(shapes, before, line, length),
                           find_place_quickly(shapes, after, line, length));
}

int32_t enf_line_disorder(const enf_shapes *shapes, const enf_line *line, const char *decimals,
                          const int32_t *sequence, int32_t count) {
    double length = decimals ? HUGE_VAL : measure(shapes, line);
    place before = {0};
    for (int32_t i = 0; i < count; i++) {
        place here = find_place_quickly(shapes, sequence[i], line, length);
        if (i > 0 && !is_surely_ahead(before, here) &&
            !comes_after(shapes->graph, line, decimals, sequence[i - 1], sequence[i]))
            return i;
        before = here;
    }
    return 0;
}
