// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility_check/witness_order.h"

/// Scratch, and the latest share of the way at which the line comes to a portal, or the earliest.
typedef struct order {
    mpq_t u[3], v[3], w[3], a, b, share, best;
} order;

static void each_number(order *order, void (*act)(mpq_ptr)) {
    for (int i = 0; i < 3; i++) {
        act(order->u[i]);
        act(order->v[i]);
        act(order->w[i]);
    }
    act(order->a);
    act(order->b);
    act(order->share);
    act(order->best);
}

/// difference = to - from, as exact as it gets
static void set_way(mpq_t difference[3], const double from[3], const double to[3], mpq_t scratch) {
    for (int i = 0; i < 3; i++) {
        mpq_set_d(difference[i], to[i]);
        mpq_set_d(scratch, from[i]);
        mpq_sub(difference[i], difference[i], scratch);
    }
}

/// The height of a point above the plane of u and v through the origin, times the length of u x v. Spoils b.
static void set_height(order *order, mpq_t height, mpq_t point[3], const double origin[3]) {
    for (int i = 0; i < 3; i++) {
        mpq_set_d(order->b, origin[i]);
        mpq_sub(order->w[i], point[i], order->b);
    }
    mpq_set_ui(height, 0, 1);
    for (int i = 0; i < 3; i++)
        for (int sign = 0; sign < 2; sign++) {
            int j = (i + 1 + sign) % 3, k = (i + 2 - sign) % 3;
            mpq_mul(order->b, order->u[j], order->v[k]);
            mpq_mul(order->b, order->b, order->w[i]);
            (sign ? mpq_sub : mpq_add)(height, height, order->b);
        }
}

/// best = where the line comes to the portal's planes, as a share of the way from -> to: the latest, or the
/// earliest. False if it is parallel to all.
static bool find_share(order *order, const enf_portal_graph *graph, mpq_t from[3], mpq_t to[3],
                       int32_t portal, bool latest) {
    int32_t first = graph->opening_corner[portal >> 1], end = graph->opening_corner[(portal >> 1) + 1];
    const double *origin = graph->corners[first];
    bool found = false;
    for (int32_t i = first + 1; i + 1 < end; i++) {
        set_way(order->u, origin, graph->corners[i], order->b);
        set_way(order->v, origin, graph->corners[i + 1], order->b);
        set_height(order, order->a, from, origin);
        set_height(order, order->share, to, origin);
        mpq_sub(order->share, order->a, order->share);
        if (mpq_sgn(order->share) == 0) continue;
        mpq_div(order->share, order->a, order->share);
        int sign = found ? mpq_cmp(order->share, order->best) : 0;
        if (!found || (latest ? sign > 0 : sign < 0)) mpq_set(order->best, order->share);
        found = true;
    }
    return found;
}

bool enf_witness_in_order(const enf_portal_graph *graph, mpq_t from[3], mpq_t to[3], int32_t first,
                          int32_t second) {
    order order;
    mpq_t earliest;
    mpq_init(earliest);
    each_number(&order, mpq_init);
    bool good = find_share(&order, graph, from, to, first, false);
    mpq_set(earliest, order.best);
    good = good && find_share(&order, graph, from, to, second, true) && mpq_cmp(order.best, earliest) > 0;
    each_number(&order, mpq_clear);
    mpq_clear(earliest);
    return good;
}
