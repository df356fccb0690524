// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility_check/facing_cells.h"

#include "base/array.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Of the largest coordinate: what lies behind by less may be rounding and counts as in front.
static const double facing_margin = 0x1p-30;

typedef struct flood {
    const enf_portal_graph *graph;
    double (*plane)[4]; ///< of each opening: unit normal, distance
    double margin;
    int32_t *queue; ///< cells
    uint64_t *row;
} flood;

static void make_plane(flood *flood, int32_t opening) {
    const enf_portal_graph *graph = flood->graph;
    int32_t first = graph->opening_corner[opening], end = graph->opening_corner[opening + 1];
    double *plane = flood->plane[opening], length = 0;
    const double *origin = graph->corners[first];
    memset(plane, 0, sizeof *flood->plane);
    for (int32_t c = first + 1; c + 1 < end; c++)
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            const double *a = graph->corners[c], *b = graph->corners[c + 1];
            plane[i] += (a[j] - origin[j]) * (b[k] - origin[k]) - (a[k] - origin[k]) * (b[j] - origin[j]);
        }
    for (int i = 0; i < 3; i++) length += plane[i] * plane[i];
    length = sqrt(length);
    for (int i = 0; i < 3; i++) {
        plane[i] /= length;
        plane[3] -= plane[i] * origin[i];
    }
}

/// Has the opening a corner that is not surely behind the directed portal's plane (or, for sign -1, in front
/// of it)? Numbers that went wrong say yes.
static bool reaches(const flood *flood, int32_t portal, int32_t opening, int sign) {
    const double *plane = flood->plane[portal >> 1];
    const enf_portal_graph *graph = flood->graph;
    double direction = portal & 1 ? -sign : sign;
    for (int32_t c = graph->opening_corner[opening]; c < graph->opening_corner[opening + 1]; c++) {
        const double *p = graph->corners[c];
        double above = plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] + plane[3];
        if (!(direction * above < -flood->margin)) return true;
    }
    return false;
}

static bool has(const uint64_t *row, int32_t cell) {
    return row[cell >> 6] >> (cell & 63) & 1;
}

static void flood_from(flood *flood, int32_t portal) {
    const enf_portal_graph *graph = flood->graph;
    int32_t read = 0, write = 0, start = enf_portal_to(graph, portal);
    flood->row[start >> 6] |= UINT64_C(1) << (start & 63);
    flood->queue[write++] = start;
    while (read < write) {
        int32_t cell = flood->queue[read++];
        for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++) {
            int32_t next = graph->cell_portals[k], to = enf_portal_to(graph, next);
            if (has(flood->row, to) || next == (portal ^ 1)) continue;
            if (!reaches(flood, portal, next >> 1, 1) || !reaches(flood, next, portal >> 1, -1)) continue;
            flood->row[to >> 6] |= UINT64_C(1) << (to & 63);
            flood->queue[write++] = to;
        }
    }
}

bool enf_facing_cells_make(enf_facing_cells *facing, const enf_portal_graph *graph) {
    *facing = (enf_facing_cells){.portal_count = 2 * graph->opening_count,
                                 .row_words = ((size_t)graph->cell_count + 63) / 64};
    flood flood = {.graph = graph};
    flood.plane = enf_array_new((size_t)graph->opening_count, sizeof *flood.plane);
    flood.queue = enf_array_new((size_t)graph->cell_count, sizeof *flood.queue);
    facing->rows = enf_array_zeroed((size_t)facing->portal_count, facing->row_words * sizeof *facing->rows);
    bool made = flood.plane && flood.queue && facing->rows;
    int32_t corners = graph->opening_count ? graph->opening_corner[graph->opening_count] : 0;
    for (int32_t c = 0; made && c < corners; c++)
        for (int i = 0; i < 3; i++) flood.margin = fmax(flood.margin, fabs(graph->corners[c][i]));
    flood.margin *= facing_margin;
    for (int32_t k = 0; made && k < graph->opening_count; k++) make_plane(&flood, k);
    for (int32_t p = 0; made && p < facing->portal_count; p++) {
        flood.row = facing->rows + (size_t)p * facing->row_words;
        flood_from(&flood, p);
    }
    free(flood.plane);
    free(flood.queue);
    if (!made) enf_facing_cells_free(facing);
    return made;
}

void enf_facing_cells_free(enf_facing_cells *facing) {
    free(facing->rows);
    memset(facing, 0, sizeof *facing);
}
