// SPDX-License-Identifier: GPL-3.0-or-later
// Where the lines come from.
#include "visibility_check/sampler.h"

#include "base/array.h"
#include "base/timer.h"
#include "visibility_check/sampler_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    RAYS_A_ROUND = 256,
    LEADS_A_ROUND = 512, ///< pairs whose lines are led on, while there are any
    HOPS = 10,
};

double enf_sampler_random(enf_sampler *sampler) {
    uint64_t z = sampler->random += 0x9e3779b97f4a7c15U; // SplitMix64
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9U;
    z = (z ^ z >> 27) * 0x94d049bb133111ebU;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

int32_t enf_sampler_choose(enf_sampler *sampler, int32_t count) {
    return (int32_t)(enf_sampler_random(sampler) * count);
}

// ---------------------------------------------------------------------------------------------- lines

static void point_inside(enf_sampler *sampler, int32_t opening, double point[3]) {
    const enf_portal_graph *graph = sampler->graph;
    int32_t first = graph->opening_corner[opening], count = graph->opening_corner[opening + 1] - first;
    int32_t second = first + 1 + enf_sampler_choose(sampler, count - 2);
    double root = sqrt(enf_sampler_random(sampler)), share = enf_sampler_random(sampler);
    double weight[3] = {1 - root, root * (1 - share), root * share};
    for (int i = 0; i < 3; i++)
        point[i] = weight[0] * graph->corners[first][i] + weight[1] * graph->corners[second][i] +
                   weight[2] * graph->corners[second + 1][i];
}

/// A corner, or a point of an edge, moved inwards by a random share of any order of magnitude.
static void point_at_rim(enf_sampler *sampler, int32_t opening, double point[3]) {
    const enf_portal_graph *graph = sampler->graph;
    int32_t first = graph->opening_corner[opening], count = graph->opening_corner[opening + 1] - first;
    int32_t corner = first + enf_sampler_choose(sampler, count);
    double along = enf_sampler_random(sampler) < 0.5 ? 0 : enf_sampler_random(sampler);
    double inwards = pow(10, -5 * enf_sampler_random(sampler)), inside[3];
    point_inside(sampler, opening, inside);
    for (int i = 0; i < 3; i++) {
        double rim = graph->corners[corner][i] +
                     along * (graph->corners[sampler->corner_next[corner]][i] - graph->corners[corner][i]);
        point[i] = rim + inwards * (inside[i] - rim);
    }
}

static void any_line(enf_sampler *sampler, enf_sampler_line *line) {
    int32_t opening = enf_sampler_choose(sampler, sampler->graph->opening_count);
    double z = 2 * enf_sampler_random(sampler) - 1, turn = 6.283185307179586 * enf_sampler_random(sampler);
    double flat = sqrt(fmax(0, 1 - z * z)), direction[3] = {flat * cos(turn), flat * sin(turn), z};
    point_inside(sampler, opening, line->point[0]);
    for (int i = 0; i < 3; i++) line->point[1][i] = line->point[0][i] + direction[i] * sampler->size * 0x1p-4;
    line->cell = sampler->graph->opening_cell[opening][0];
}

/// Through two portals a few cells apart.
static void line_through_two(enf_sampler *sampler, enf_sampler_line *line) {
    const enf_portal_graph *graph = sampler->graph;
    int32_t first = enf_sampler_choose(sampler, graph->opening_count), portal = 2 * first;
    for (int32_t hops = 1 + enf_sampler_choose(sampler, HOPS); hops > 0; hops--) {
        int32_t cell = enf_portal_to(graph, portal), begin = graph->cell_portal[cell];
        portal =
            graph->cell_portals[begin + enf_sampler_choose(sampler, graph->cell_portal[cell + 1] - begin)];
    }
    point_inside(sampler, first, line->point[0]);
    point_inside(sampler, portal >> 1, line->point[1]);
    line->cell = graph->opening_cell[first][0];
}

/// Near one that found something.
static void line_near_line(enf_sampler *sampler, enf_sampler_line *line) {
    *line = sampler->lines[enf_sampler_choose(sampler, (int32_t)sampler->line_count)];
    double reach = sampler->size * pow(10, -2 - 5 * enf_sampler_random(sampler));
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++)
            line->point[e][i] += reach * (enf_sampler_random(sampler) - enf_sampler_random(sampler));
}

/// Through the rims of two portals on the way of a line that found something.
static void line_at_rims(enf_sampler *sampler, enf_sampler_line *line) {
    *line = sampler->lines[enf_sampler_choose(sampler, (int32_t)sampler->line_count)];
    if (enf_sampler_walk(sampler, line) < 0 || sampler->walk_last <= sampler->walk_first) return;
    int32_t count = sampler->walk_last - sampler->walk_first;
    for (int e = 0; e < 2; e++) {
        int32_t place = sampler->walk_first + enf_sampler_choose(sampler, count);
        point_at_rim(sampler, sampler->walk_portal[place] >> 1, line->point[e]);
        if (e == 0) line->cell = sampler->walk_cell[place];
    }
}

static void next_line(enf_sampler *sampler, enf_sampler_line *line) {
    int32_t kind = enf_sampler_choose(sampler, sampler->line_count > 0 ? 4 : 2);
    if (kind == 0) any_line(sampler, line);
    if (kind == 1) line_through_two(sampler, line);
    if (kind == 2) line_near_line(sampler, line);
    if (kind == 3) line_at_rims(sampler, line);
}

// ---------------------------------------------------------------------------------------------- run

/// Leads the line of the last walk on, from one of its cells through another, even where another line was led
/// on before: it takes another way.
static void lead_walk_on(enf_sampler *sampler, const enf_sampler_line *line) {
    int32_t count = sampler->walk_last - sampler->walk_first + 1;
    int32_t from = sampler->walk_cell[sampler->walk_first + enf_sampler_choose(sampler, count)];
    int32_t to = sampler->walk_cell[sampler->walk_first + enf_sampler_choose(sampler, count)];
    if (from != to) enf_sampler_lead_on(sampler, line, from, to, true);
}

static void lead_queue_on(enf_sampler *sampler) {
    for (int k = 0; k < LEADS_A_ROUND && sampler->queue_count > 0 && !sampler->failed; k++) {
        int32_t at = enf_sampler_choose(sampler, (int32_t)sampler->queue_count);
        int32_t from = sampler->queue[at][0], to = sampler->queue[at][1];
        memcpy(sampler->queue[at], sampler->queue[--sampler->queue_count], sizeof *sampler->queue);
        enf_sampler_line line = sampler->lines[sampler->pair_line[enf_sampler_pair(from, to)]];
        enf_sampler_lead_on(sampler, &line, from, to, false);
    }
}

enf_status enf_sampler_run(enf_sampler *sampler, double seconds, uint64_t rays, enf_error *error) {
    double start = enf_timer_cpu();
    uint64_t first = sampler->rays;
    if (sampler->graph->opening_count == 0) return ENF_OK;
    while (!sampler->failed && (seconds <= 0 || enf_timer_cpu() - start < seconds) &&
           (rays == 0 || sampler->rays - first < rays)) {
        for (int k = 0; k < RAYS_A_ROUND && !sampler->failed; k++) {
            enf_sampler_line line = {.cell = 0};
            next_line(sampler, &line);
            enf_sampler_throw(sampler, &line);
            if (!sampler->failed) lead_walk_on(sampler, &line);
        }
        lead_queue_on(sampler);
    }
    return sampler->failed ? enf_fail_memory(error, "the sampler") : ENF_OK;
}

bool enf_sampler_witness(const enf_sampler *sampler, int32_t i, int32_t j, enf_witness *witness) {
    int32_t number = sampler->pair_line[enf_sampler_pair(i, j)];
    if (number < 0) return false;
    *witness = (enf_witness){.cell = {i, j}};
    memcpy(witness->from, sampler->lines[number].point[0], sizeof witness->from);
    memcpy(witness->to, sampler->lines[number].point[1], sizeof witness->to);
    return true;
}

// ---------------------------------------------------------------------------------------------- make

static void find_size(enf_sampler *sampler) {
    const enf_portal_graph *graph = sampler->graph;
    for (int i = 0; i < 3; i++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t c = 0; c < graph->opening_corner[graph->opening_count]; c++) {
            low = fmin(low, graph->corners[c][i]);
            high = fmax(high, graph->corners[c][i]);
        }
        sampler->middle[i] = low / 2 + high / 2;
        sampler->size = fmax(sampler->size, high - low);
    }
}

static void make_opening(enf_sampler *sampler, int32_t opening) {
    const enf_portal_graph *graph = sampler->graph;
    int32_t first = graph->opening_corner[opening], end = graph->opening_corner[opening + 1];
    double *normal = sampler->normal[opening];
    memset(normal, 0, sizeof *sampler->normal);
    for (int32_t c = first; c < end; c++) {
        int32_t next = sampler->corner_next[c] = c + 1 < end ? c + 1 : first;
        double p[3], d[3];
        for (int i = 0; i < 3; i++) {
            p[i] = graph->corners[c][i] - sampler->middle[i];
            d[i] = graph->corners[next][i] - graph->corners[c][i];
        }
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            sampler->edge[c][i] = p[j] * d[k] - p[k] * d[j];
            sampler->edge[c][3 + i] = d[i];
            normal[i] += sampler->edge[c][i];
        }
    }
}

enf_status enf_sampler_make(enf_sampler *sampler, const enf_portal_graph *graph, uint64_t seed,
                            enf_error *error) {
    size_t cells = (size_t)graph->cell_count, openings = (size_t)graph->opening_count;
    size_t corners = openings ? (size_t)graph->opening_corner[openings] : 0;
    size_t pairs = cells ? cells * (cells - 1) / 2 : 0;
    *sampler = (enf_sampler){.graph = graph, .random = seed, .tried_words = (2 * openings + 63) / 64};
    sampler->edge = enf_array_new(corners, sizeof *sampler->edge);
    sampler->normal = enf_array_new(openings, sizeof *sampler->normal);
    sampler->corner_next = enf_array_new(corners, sizeof *sampler->corner_next);
    sampler->sequence = enf_array_new(cells, sizeof *sampler->sequence);
    sampler->tried = enf_array_zeroed(cells, sampler->tried_words * sizeof *sampler->tried);
    sampler->pair_line = enf_array_new(pairs, sizeof *sampler->pair_line);
    sampler->pair_clearance = enf_array_zeroed(pairs, sizeof *sampler->pair_clearance);
    if (!sampler->edge || !sampler->normal || !sampler->corner_next || !sampler->sequence ||
        !sampler->tried || !sampler->pair_line || !sampler->pair_clearance) {
        enf_sampler_free(sampler);
        return enf_fail_memory(error, "the sampler");
    }
    for (size_t k = 0; k < pairs; k++) sampler->pair_line[k] = -1;
    if (openings) find_size(sampler);
    for (int32_t k = 0; k < graph->opening_count; k++) make_opening(sampler, k);
    return ENF_OK;
}

void enf_sampler_free(enf_sampler *sampler) {
    free(sampler->edge);
    free(sampler->normal);
    free(sampler->corner_next);
    free(sampler->sequence);
    free(sampler->tried);
    free(sampler->pair_line);
    free(sampler->pair_clearance);
    free(sampler->lines);
    free(sampler->walk_cell);
    free(sampler->walk_portal);
    free(sampler->walk_clearance);
    free(sampler->queue);
    free(sampler->columns);
    memset(sampler, 0, sizeof *sampler);
}
