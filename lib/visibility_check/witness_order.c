// SPDX-License-Identifier: GPL-3.0-or-later
// The point at which a line goes through a triangle has, as barycentric coordinates, the sides on which the
// line passes the three edges: that of each corner is the opposite edge's.
#include "visibility_check/witness_order.h"

#include <math.h>

typedef struct order {
    mpq_t *from, way[3], arm[3][3], side[3], sum, product;
} order;

static void order_init(order *order, mpq_t from[3], mpq_t to[3]) {
    order->from = from;
    mpq_inits(order->sum, order->product, NULL);
    for (int i = 0; i < 3; i++) {
        mpq_inits(order->way[i], order->side[i], NULL);
        for (int k = 0; k < 3; k++) mpq_init(order->arm[k][i]);
        mpq_sub(order->way[i], to[i], from[i]);
    }
}

static void order_clear(order *order) {
    mpq_clears(order->sum, order->product, NULL);
    for (int i = 0; i < 3; i++) {
        mpq_clears(order->way[i], order->side[i], NULL);
        for (int k = 0; k < 3; k++) mpq_clear(order->arm[k][i]);
    }
}

/// arm = the way from the line's first point to a corner
static void set_arm(order *order, int k, const double corner[3]) {
    for (int i = 0; i < 3; i++) {
        mpq_set_d(order->arm[k][i], corner[i]);
        mpq_sub(order->arm[k][i], order->arm[k][i], order->from[i]);
    }
}

/// out = determinant of a, b, c
static void set_determinant(order *order, mpq_t out, mpq_t a[3], mpq_t b[3], mpq_t c[3]) {
    mpq_set_ui(out, 0, 1);
    for (int i = 0; i < 3; i++)
        for (int back = 0; back < 2; back++) {
            mpq_mul(order->product, a[i], b[(i + 1 + back) % 3]);
            mpq_mul(order->product, order->product, c[(i + 2 - back) % 3]);
            (back ? mpq_sub : mpq_add)(out, out, order->product);
        }
}

/// side[k] = on which side the line passes the edge opposite corner k, turned as the portal is; sum: of all.
static void set_sides(order *order, bool turned) {
    mpq_set_ui(order->sum, 0, 1);
    for (int k = 0; k < 3; k++) {
        mpq_t *a = order->arm[(k + 1) % 3], *b = order->arm[(k + 2) % 3];
        set_determinant(order, order->side[k], order->way, turned ? b : a, turned ? a : b);
        mpq_add(order->sum, order->sum, order->side[k]);
    }
}

/// The triangle's corners, weighed with the sides: how far along is that?
static void set_along(order *order, mpq_t along) {
    mpq_set_ui(along, 0, 1);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            mpq_mul(order->product, order->side[k], order->arm[k][i]);
            mpq_mul(order->product, order->product, order->way[i]);
            mpq_add(along, along, order->product);
        }
    mpq_div(along, along, order->sum);
}

/// along = how far along the line the portal is, times the square of the way from -> to.
static bool find_place(order *order, const enf_portal_graph *graph, int32_t portal, mpq_t along) {
    int32_t first = graph->opening_corner[portal >> 1], end = graph->opening_corner[(portal >> 1) + 1];
    set_arm(order, 0, graph->corners[first]);
    for (int32_t c = first + 1; c + 1 < end; c++) {
        set_arm(order, 1, graph->corners[c]);
        set_arm(order, 2, graph->corners[c + 1]);
        set_sides(order, portal & 1);
        bool inside = mpq_sgn(order->sum) > 0;
        for (int k = 0; k < 3; k++) inside = inside && mpq_sgn(order->side[k]) >= 0;
        if (!inside) continue;
        set_along(order, along);
        return true;
    }
    return false;
}

bool enf_witness_in_order(const enf_portal_graph *graph, mpq_t from[3], mpq_t to[3], int32_t first,
                          int32_t second) {
    order order;
    mpq_t one, two;
    order_init(&order, from, to);
    mpq_inits(one, two, NULL);
    bool good = find_place(&order, graph, first, one) && find_place(&order, graph, second, two) &&
                mpq_cmp(one, two) < 0;
    mpq_clears(one, two, NULL);
    order_clear(&order);
    return good;
}

// ---------------------------------------------------------------------------------------------- doubles

/// What is computed from corners and ends is off by less than this, of the sum of its terms' sizes.
static const double rounding = 1e-14;

/// A share of the way from -> to, and by how much it may be off.
typedef struct share {
    double at, error;
} share;

/// Where the line comes to the portal: as far from the plane through the first corner as corners are, at
/// most.
static share find_share(const enf_portal_graph *graph, int32_t portal, const double from[3],
                        const double to[3]) {
    int32_t first = graph->opening_corner[portal >> 1], end = graph->opening_corner[(portal >> 1) + 1];
    const double *origin = graph->corners[first];
    double normal[3] = {0}, size = 0, reach = 0, height = 0, fall = 0, bend = 0;
    for (int32_t c = first + 1; c + 1 < end; c++)
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            const double *a = graph->corners[c], *b = graph->corners[c + 1];
            double left = (a[j] - origin[j]) * (b[k] - origin[k]);
            double right = (a[k] - origin[k]) * (b[j] - origin[j]);
            normal[i] += left - right;
            size += fabs(left) + fabs(right);
        }
    for (int i = 0; i < 3; i++) {
        height += normal[i] * (from[i] - origin[i]);
        fall += normal[i] * (from[i] - to[i]);
        reach += fabs(from[i] - origin[i]) + fabs(from[i] - to[i]);
    }
    for (int32_t c = first + 1; c < end; c++) {
        double high = 0;
        for (int i = 0; i < 3; i++) high += normal[i] * (graph->corners[c][i] - origin[i]);
        bend = fmax(bend, fabs(high));
        for (int i = 0; i < 3; i++) reach = fmax(reach, fabs(graph->corners[c][i] - origin[i]));
    }
    double at = height / fall, off = bend + rounding * size * reach;
    return (share){at, 2 * off * (1 + fabs(at)) / fabs(fall)};
}

bool enf_witness_surely_in_order(const enf_portal_graph *graph, const double from[3], const double to[3],
                                 int32_t first, int32_t second) {
    share before = find_share(graph, first, from, to), after = find_share(graph, second, from, to);
    return after.at - before.at > before.error + after.error; // not so if something is no number
}
