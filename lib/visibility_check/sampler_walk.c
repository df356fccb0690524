// SPDX-License-Identifier: GPL-3.0-or-later
// Walking a line through the cells: six multiplications and additions for an edge.
#include "visibility_check/sampler_parts.h"

#include "base/array.h"

#include <float.h>
#include <math.h>

enum { WALK_LEAST = 64 };

/// Direction and moment of a line.
typedef struct walk_line {
    double d[3], m[3];
} walk_line;

static walk_line make_line(const enf_sampler *sampler, const enf_sampler_line *line, double sign) {
    walk_line out;
    double p[3];
    for (int i = 0; i < 3; i++) {
        p[i] = line->point[0][i] - sampler->middle[i];
        out.d[i] = sign * (line->point[1][i] - line->point[0][i]);
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out.m[i] = p[j] * out.d[k] - p[k] * out.d[j];
    }
    return out;
}

static bool passes(const enf_sampler *sampler, const walk_line *line, int32_t portal) {
    const double *n = sampler->normal[portal >> 1];
    double sign = portal & 1 ? -1 : 1;
    if (sign * (n[0] * line->d[0] + n[1] * line->d[1] + n[2] * line->d[2]) <= 0) return false;
    const int32_t *offset = sampler->graph->opening_corner;
    for (int32_t c = offset[portal >> 1]; c < offset[(portal >> 1) + 1]; c++) {
        const double *e = sampler->edge[c];
        double side = line->d[0] * e[0] + line->d[1] * e[1] + line->d[2] * e[2] + line->m[0] * e[3] +
                      line->m[1] * e[4] + line->m[2] * e[5];
        if (!(sign * side > 0)) return false;
    }
    return true;
}

/// The least distance to the lines of a portal's edges, squared.
static double clearance(const enf_sampler *sampler, const walk_line *line, int32_t portal) {
    const int32_t *offset = sampler->graph->opening_corner;
    double least = DBL_MAX;
    for (int32_t c = offset[portal >> 1]; c < offset[(portal >> 1) + 1]; c++) {
        const double *e = sampler->edge[c], *d = line->d;
        double side = d[0] * e[0] + d[1] * e[1] + d[2] * e[2] + line->m[0] * e[3] + line->m[1] * e[4] +
                      line->m[2] * e[5];
        double x = d[1] * e[5] - d[2] * e[4], y = d[2] * e[3] - d[0] * e[5], z = d[0] * e[4] - d[1] * e[3];
        double square = x * x + y * y + z * z;
        if (side * side < least * square) least = side * side / square;
    }
    return least;
}

/// Room for `count` cells on either side of the first.
static bool reserve_walk(enf_sampler *sampler) {
    size_t count = 2 * (size_t)sampler->graph->cell_count + WALK_LEAST;
    if (sampler->walk_cell) return true;
    sampler->walk_cell = enf_array_new(count, sizeof *sampler->walk_cell);
    sampler->walk_portal = enf_array_new(count, sizeof *sampler->walk_portal);
    sampler->walk_clearance = enf_array_new(count, sizeof *sampler->walk_clearance);
    sampler->failed = !sampler->walk_cell || !sampler->walk_portal || !sampler->walk_clearance;
    return !sampler->failed;
}

/// From the cell at `at` on, to higher places (step 1) or, against the line, to lower ones (step -1). Returns
/// the last place. walk_portal[p] leads from place p to p + 1.
static int32_t walk(enf_sampler *sampler, const walk_line *line, int32_t at, int step) {
    const enf_portal_graph *graph = sampler->graph;
    int32_t came = -1, cell = sampler->walk_cell[at];
    for (int32_t left = graph->cell_count; left > 0; left--) {
        int32_t found = -1;
        for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1] && found < 0; k++) {
            int32_t portal = graph->cell_portals[k];
            if (portal != (came ^ 1) && passes(sampler, line, portal)) found = portal;
        }
        if (found < 0) break;
        int32_t place = step > 0 ? at : at - 1;
        sampler->walk_portal[place] = step > 0 ? found : found ^ 1;
        sampler->walk_clearance[place] = clearance(sampler, line, found);
        sampler->crossings++;
        at += step;
        cell = sampler->walk_cell[at] = enf_portal_to(graph, found);
        came = found;
    }
    return at;
}

// ---------------------------------------------------------------------------------------------- pairs

static bool queue_pair(enf_sampler *sampler, int32_t from, int32_t to) {
    if (!enf_array_reserve(sampler->queue, sampler->queue_capacity, sampler->queue_count + 1)) return false;
    sampler->queue[sampler->queue_count][0] = from;
    sampler->queue[sampler->queue_count++][1] = to;
    return true;
}

/// The line's number, once a pair wants to keep it.
static int32_t keep_line(enf_sampler *sampler, const enf_sampler_line *line, int32_t *kept) {
    if (*kept >= 0) return *kept;
    if (!enf_array_reserve(sampler->lines, sampler->line_capacity, sampler->line_count + 1)) {
        sampler->failed = true;
        return -1;
    }
    sampler->lines[sampler->line_count] = *line;
    return *kept = (int32_t)sampler->line_count++;
}

static void note_pair(enf_sampler *sampler, const enf_sampler_line *line, int32_t i, int32_t j,
                      double squared, int32_t *kept) {
    if (i == j) return;
    size_t pair = enf_sampler_pair(i, j);
    bool is_new = sampler->pair_line[pair] < 0;
    float best = sampler->pair_clearance[pair];
    // A line that is only a little better is not worth the memory.
    if (!is_new && squared <= 2.25 * (double)best * (double)best) return;
    int32_t number = keep_line(sampler, line, kept);
    if (number < 0) return;
    sampler->pair_line[pair] = number;
    sampler->pair_clearance[pair] = (float)sqrt(squared);
    if (!is_new) return;
    sampler->pair_count++;
    if (!queue_pair(sampler, i, j) || !queue_pair(sampler, j, i)) sampler->failed = true;
}

int32_t enf_sampler_walk(enf_sampler *sampler, const enf_sampler_line *line) {
    if (!reserve_walk(sampler)) return -1;
    int32_t middle = sampler->graph->cell_count + WALK_LEAST / 2;
    walk_line along = make_line(sampler, line, 1), against = make_line(sampler, line, -1);
    sampler->walk_cell[middle] = line->cell;
    sampler->walk_last = walk(sampler, &along, middle, 1);
    sampler->walk_first = walk(sampler, &against, middle, -1);
    sampler->rays++;
    return middle;
}

void enf_sampler_throw(enf_sampler *sampler, const enf_sampler_line *line) {
    int32_t kept = -1;
    if (enf_sampler_walk(sampler, line) < 0) return;
    int32_t first = sampler->walk_first, last = sampler->walk_last;
    for (int32_t a = first; a < last; a++) {
        double least = DBL_MAX;
        for (int32_t b = a + 1; b <= last; b++) {
            least = fmin(least, sampler->walk_clearance[b - 1]);
            note_pair(sampler, line, sampler->walk_cell[a], sampler->walk_cell[b], least, &kept);
        }
    }
}
