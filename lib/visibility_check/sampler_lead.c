// SPDX-License-Identifier: GPL-3.0-or-later
// A pair of cells that see each other often has a neighbour pair that does so through a slit which no random
// line hits. The linear program over the portals on the way and one more finds such a slit at once. Its point
// need not be a line: a few steps lead from it to one (the quadric of lines replaced by its tangent plane,
// again a linear program, each time from the line found before).
#include "visibility_check/sampler_parts.h"

#include "base/array.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { STEPS = 6, HALVINGS = 5 };

/// A program with a margin below this (columns have length 1) leaves no line that doubles could hold.
static const double margin_least = 1e-10;

typedef struct lead {
    enf_sampler *sampler;
    double middle[3], scale; ///< of the coordinates that the columns are in
    int32_t sequence_count;
    int32_t column_count;
} lead;

// ---------------------------------------------------------------------------------------------- columns

static void add_column(const lead *lead, int32_t corner, double sign, double column[ENF_LINE_ROWS]) {
    const enf_sampler *sampler = lead->sampler;
    const double *a = sampler->graph->corners[corner];
    const double *b = sampler->graph->corners[sampler->corner_next[corner]];
    double p[3], d[3], length = 0;
    for (int i = 0; i < 3; i++) {
        p[i] = (a[i] - lead->middle[i]) * lead->scale;
        d[i] = (b[i] - a[i]) * lead->scale * sign;
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        column[i] = p[j] * d[k] - p[k] * d[j];
        column[3 + i] = d[i];
    }
    for (int r = 0; r < 6; r++) length += column[r] * column[r];
    length = sqrt(length);
    for (int r = 0; r < 6; r++) column[r] /= length;
    column[6] = 1;
}

/// Two columns more than those of the portal are made room for. False without memory.
static bool add_portal(lead *lead, int32_t portal) {
    enf_sampler *sampler = lead->sampler;
    const int32_t *offset = sampler->graph->opening_corner;
    int32_t begin = offset[portal >> 1], end = offset[(portal >> 1) + 1];
    size_t wanted = (size_t)(lead->column_count + end - begin) + 2;
    if (!enf_array_reserve(sampler->columns, sampler->column_capacity, wanted)) {
        sampler->failed = true;
        return false;
    }
    for (int32_t c = begin; c < end; c++)
        add_column(lead, c, portal & 1 ? -1 : 1, sampler->columns[lead->column_count++]);
    return true;
}

static bool begin(lead *lead) {
    const enf_sampler *sampler = lead->sampler;
    const int32_t *offset = sampler->graph->opening_corner, *portals = sampler->sequence;
    int32_t half = portals[lead->sequence_count / 2] >> 1, first = portals[0] >> 1;
    double reach = 0;
    memcpy(lead->middle, sampler->graph->corners[offset[half]], sizeof lead->middle);
    for (int i = 0; i < 3; i++)
        reach = fmax(reach, fabs(sampler->graph->corners[offset[first]][i] - lead->middle[i]));
    lead->scale = 1 / fmax(reach, sampler->size / 64);
    for (int32_t k = 0; k < lead->sequence_count; k++)
        if (!add_portal(lead, portals[k])) return false;
    return true;
}

// ---------------------------------------------------------------------------------------------- lines

static double least_side(const lead *lead, const double x[6]) {
    double least = DBL_MAX;
    for (int32_t k = 0; k < lead->column_count; k++) {
        const double *e = lead->sampler->columns[k];
        least =
            fmin(least, x[0] * e[0] + x[1] * e[1] + x[2] * e[2] + x[3] * e[3] + x[4] * e[4] + x[5] * e[5]);
    }
    return least;
}

/// To a line near the point: direction kept, moment made square to it. Length 1. False if there is none.
static bool make_line(double x[6]) {
    double square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2], length = 0;
    if (!(square > 1e-20)) return false;
    double share = (x[0] * x[3] + x[1] * x[4] + x[2] * x[5]) / square;
    for (int i = 0; i < 3; i++) x[3 + i] -= share * x[i];
    for (int r = 0; r < 6; r++) length += x[r] * x[r];
    length = sqrt(length);
    for (int r = 0; r < 6; r++) x[r] /= length;
    return true;
}

/// The best point of the tangent plane of lines at x.
static bool solve_tangent(const lead *lead, const enf_line_basis *start, const double x[6], double best[6]) {
    double(*columns)[ENF_LINE_ROWS] = lead->sampler->columns;
    enf_line_basis basis = *start;
    for (int s = 0; s < 2; s++) {
        double *column = columns[lead->column_count + s];
        for (int r = 0; r < 6; r++) column[r] = (s ? -1 : 1) * x[(r + 3) % 6];
        column[6] = 0;
    }
    lead->sampler->programs++;
    enf_line_basis_solve(&basis, (const double(*)[ENF_LINE_ROWS])columns, lead->column_count + 2,
                         margin_least);
    memcpy(best, basis.point, sizeof basis.point);
    return basis.margin > margin_least;
}

/// From x towards `best`, as far as it does good. False if it does none.
static bool improve(const lead *lead, double x[6], double *side, const double best[6]) {
    double length = 0, chosen[6];
    bool better = false;
    for (int r = 0; r < 6; r++) length += best[r] * best[r];
    length = sqrt(length);
    for (int h = 0; h < HALVINGS; h++) {
        double share = ldexp(1, -h), at[6];
        for (int r = 0; r < 6; r++) at[r] = x[r] + share * (best[r] / length - x[r]);
        if (!make_line(at)) continue;
        double here = least_side(lead, at);
        if (here <= *side) continue;
        *side = here;
        memcpy(chosen, at, sizeof chosen);
        better = true;
    }
    if (better) memcpy(x, chosen, sizeof chosen);
    return better;
}

static bool find_line(const lead *lead, const enf_line_basis *basis, double x[6]) {
    memcpy(x, basis->point, sizeof basis->point);
    if (!make_line(x)) return false;
    double side = least_side(lead, x), best[6];
    for (int step = 0; step < STEPS; step++) {
        double before = side;
        if (!solve_tangent(lead, basis, x, best) || !improve(lead, x, &side, best)) break;
        if (side > 0 && side < 1.1 * before) break;
    }
    return side > 0;
}

/// A line of the columns' coordinates as two points of the graph's, near the first and the last portal.
static enf_sampler_line read_line(const lead *lead, const double x[6], int32_t last) {
    const enf_portal_graph *graph = lead->sampler->graph;
    int32_t ends[2] = {lead->sampler->sequence[0] >> 1, last >> 1};
    double square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2], along[2];
    enf_sampler_line line;
    for (int e = 0; e < 2; e++) {
        const double *corner = graph->corners[graph->opening_corner[ends[e]]];
        along[e] = 0;
        for (int i = 0; i < 3; i++) along[e] += (corner[i] - lead->middle[i]) * lead->scale * x[i] / square;
    }
    if (along[0] == along[1]) along[1] += 1;
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            double foot = (x[j] * x[3 + k] - x[k] * x[3 + j]) / square;
            line.point[e][i] = lead->middle[i] + (foot + along[e] * x[i]) / lead->scale;
        }
    line.cell = enf_portal_from(graph, lead->sampler->sequence[0]);
    return line;
}

// ---------------------------------------------------------------------------------------------- lead on

/// The portals from one cell to another along the line; how many, 0 if it does not go through both.
static int32_t take_sequence(enf_sampler *sampler, const enf_sampler_line *line, int32_t from, int32_t to) {
    int32_t a = -1, b = -1, count = 0;
    if (enf_sampler_walk(sampler, line) < 0) return 0;
    for (int32_t at = sampler->walk_first; at <= sampler->walk_last; at++) {
        if (sampler->walk_cell[at] == from) a = at;
        if (sampler->walk_cell[at] == to) b = at;
    }
    if (a < 0 || b < 0) return 0;
    for (int32_t at = a; at < b && count < sampler->graph->cell_count; at++)
        sampler->sequence[count++] = sampler->walk_portal[at];
    for (int32_t at = a; at > b && count < sampler->graph->cell_count; at--)
        sampler->sequence[count++] = sampler->walk_portal[at - 1] ^ 1;
    return count;
}

static bool is_worth(enf_sampler *sampler, int32_t from, int32_t portal, bool again) {
    int32_t cell = enf_portal_to(sampler->graph, portal);
    uint64_t *tried = sampler->tried + (size_t)from * sampler->tried_words + (portal >> 6);
    uint64_t bit = UINT64_C(1) << (portal & 63);
    if (cell == from || sampler->pair_line[enf_sampler_pair(from, cell)] >= 0) return false;
    if ((*tried & bit) && !again) return false;
    *tried |= bit;
    return true;
}

void enf_sampler_lead_on(enf_sampler *sampler, const enf_sampler_line *line, int32_t from, int32_t to,
                         bool again) {
    const enf_portal_graph *graph = sampler->graph;
    lead lead = {.sampler = sampler};
    enf_line_basis start;
    for (int32_t k = graph->cell_portal[to]; k < graph->cell_portal[to + 1]; k++) {
        int32_t portal = graph->cell_portals[k];
        if (!is_worth(sampler, from, portal, again)) continue;
        if (lead.sequence_count == 0) {
            lead.sequence_count = take_sequence(sampler, line, from, to);
            if (lead.sequence_count == 0 || !begin(&lead)) return;
            enf_line_basis_begin(&start, sampler->columns[0]);
            enf_line_basis_solve(&start, (const double(*)[ENF_LINE_ROWS])sampler->columns, lead.column_count,
                                 0);
        }
        if (portal == (sampler->sequence[lead.sequence_count - 1] ^ 1)) continue;
        enf_line_basis basis = start;
        int32_t count = lead.column_count;
        double x[6];
        if (!add_portal(&lead, portal)) return;
        sampler->programs++;
        sampler->led_on++;
        enf_line_basis_solve(&basis, (const double(*)[ENF_LINE_ROWS])sampler->columns, lead.column_count,
                             margin_least);
        if (basis.margin > margin_least && find_line(&lead, &basis, x)) {
            enf_sampler_line found = read_line(&lead, x, portal);
            enf_sampler_throw(sampler, &found);
        }
        lead.column_count = count;
    }
}
