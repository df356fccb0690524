// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/sight.h"

#include "base/array.h"
#include "visibility/line_order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Products of unit vectors with moments: their errors are about 30 times 2^-53 of the largest coordinate.
static const double relative_clearance = 0x1p-40;

static void make_edge(const double a[3], const double b[3], double edge[6]) {
    double way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double length = sqrt(enf_dot(way, way));
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        edge[axis] = (a[u] * way[v] - a[v] * way[u]) / length;
        edge[3 + axis] = way[axis] / length;
    }
}

bool enf_sight_make(enf_sight *sight, const enf_shapes *shapes) {
    const enf_portal_graph *graph = shapes->graph;
    size_t corners = (size_t)graph->opening_corner[graph->opening_count];
    *sight = (enf_sight){.shapes = shapes, .clearance = shapes->extent / 4 * relative_clearance};
    sight->first = enf_array_new((size_t)graph->opening_count + 1, sizeof *sight->first);
    sight->edges = enf_array_new(corners, sizeof *sight->edges);
    sight->cell_is_convex = enf_array_new((size_t)graph->cell_count, sizeof *sight->cell_is_convex);
    if (!sight->first || !sight->edges || !sight->cell_is_convex) return false;
    for (int32_t c = 0; c < graph->cell_count; c++)
        sight->cell_is_convex[c] = enf_portal_graph_is_convex(graph, c);
    sight->first[0] = 0;
    for (int32_t k = 0; k < graph->opening_count; k++) {
        int32_t begin = graph->opening_corner[k], end = graph->opening_corner[k + 1], made = sight->first[k];
        for (int32_t i = begin; i < end; i++) {
            const double *a = graph->corners[i], *b = graph->corners[i + 1 < end ? i + 1 : begin];
            if (memcmp(a, b, sizeof *graph->corners) == 0) continue; // no edge
            make_edge(a, b, sight->edges[made++]);
        }
        sight->first[k + 1] = made;
    }
    return true;
}

void enf_sight_free(enf_sight *sight) {
    free(sight->first);
    free(sight->edges);
    free(sight->cell_is_convex);
    memset(sight, 0, sizeof *sight);
}

static bool passes(const enf_sight *sight, const double line[6], int32_t portal) {
    double sign = portal & 1 ? -1 : 1;
    int32_t begin = sight->first[portal >> 1], end = sight->first[(portal >> 1) + 1];
    for (int32_t i = begin; i < end; i++) {
        double product = 0;
        for (int k = 0; k < 6; k++) product += line[k] * sight->edges[i][k];
        if (!(sign * product > sight->clearance)) return false;
    }
    return end > begin;
}

/// The portal by which the line leaves the cell that `portal` leads into; -1 if that is not sure.
static int32_t find_exit(const enf_sight *sight, const double line[6], int32_t portal) {
    const enf_portal_graph *graph = sight->shapes->graph;
    int32_t cell = enf_portal_to(graph, portal);
    if (!sight->cell_is_convex[cell]) return -1;
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++) {
        int32_t next = graph->cell_portals[k];
        double towards = enf_dot(sight->shapes->shapes[next >> 1].normal, line);
        if (next & 1 ? towards >= 0 : towards <= 0) continue;
        if (next >> 1 != portal >> 1 && passes(sight, line, next)) return next;
    }
    return -1;
}

int32_t enf_sight_walk(const enf_sight *sight, const enf_line *line, int32_t portal, int32_t *passed,
                       int32_t most) {
    double along[6];
    double way[3] = {line->to[0] - line->from[0], line->to[1] - line->from[1], line->to[2] - line->from[2]};
    double length = sqrt(enf_dot(way, way));
    if (!(length > 0)) return -1;
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        along[axis] = way[axis] / length;
        along[3 + axis] = (line->from[u] * way[v] - line->from[v] * way[u]) / length;
    }
    if (!passes(sight, along, portal)) return -1;
    int32_t count = 0;
    while (count < most) {
        int32_t next = find_exit(sight, along, portal);
        if (next < 0) break;
        if (!sight->trusts_order && !enf_line_surely_in_order(sight->shapes, line, portal, next)) break;
        passed[count++] = portal = next;
    }
    return count;
}
