// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/coplanar.h"

#include "base/array.h"

#include <math.h>
#include <string.h>

/// Does the portal's opening lie in the other's plane, well within what windows stand for?
static bool is_in_plane(const enf_shapes *shapes, int32_t portal, int32_t other) {
    const double(*corners)[3] = enf_shape_corners(shapes, portal >> 1);
    for (int32_t i = 0; i < shapes->shapes[portal >> 1].count; i++)
        if (!(fabs(enf_shape_height(shapes, other, corners[i])) <= shapes->tolerance / 4)) return false;
    return true;
}

static bool have_same_follows(const enf_follows *follows, int32_t portal, int32_t other) {
    const int32_t *one = &follows->first[portal], *two = &follows->first[other];
    return one[1] - one[0] == two[1] - two[0] &&
           memcmp(follows->portals + one[0], follows->portals + two[0],
                  (size_t)(one[1] - one[0]) * sizeof *follows->portals) == 0;
}

static bool are_coplanar(const enf_shapes *shapes, const enf_follows *follows, int32_t portal,
                         int32_t other) {
    const enf_shape *one = &shapes->shapes[portal >> 1], *two = &shapes->shapes[other >> 1];
    return (portal & 1) == (other & 1) && memcmp(one->axes, two->axes, sizeof one->axes) == 0 &&
           is_in_plane(shapes, portal, other) && is_in_plane(shapes, other, portal) &&
           have_same_follows(follows, portal, other);
}

int32_t *enf_coplanar_make(const enf_shapes *shapes, const enf_follows *follows) {
    const enf_portal_graph *graph = shapes->graph;
    int32_t *next = enf_array_new(2 * (size_t)graph->opening_count, sizeof *next);
    for (int32_t cell = 0; next && cell < graph->cell_count; cell++)
        for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++) {
            const int32_t portal = graph->cell_portals[k] ^ 1;
            next[portal] = portal;
            for (int32_t i = graph->cell_portal[cell]; i < k && next[portal] == portal; i++) {
                const int32_t other = graph->cell_portals[i] ^ 1;
                if (!are_coplanar(shapes, follows, portal, other)) continue;
                next[portal] = next[other];
                next[other] = portal;
            }
        }
    return next;
}
