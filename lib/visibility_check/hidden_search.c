// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility_check/hidden_search.h"

#include "base/array.h"

#include <math.h>
#include <string.h>

enum {
    FEW_PIECES = 4, ///< for a pair of triangles, where a certificate would have done but for rounding
    PIECE_LIMIT = 3000,
    MANY_CORNERS = 64 ///< of a portal; with more, the same is left out
};

/// A program with a margin below this (columns have length 1) is worth a try at a certificate.
static const double margin_least = 1e-10;
/// Weights below this are rounding.
static const double weight_least = 1e-9;
/// New edges passed by this need no program.
static const double pass_least = 1e-9;

// ---------------------------------------------------------------------------------------------- edges

static void find_middle(const hidden_search *search, int32_t source, double middle[3], double *size) {
    const enf_portal_graph *graph = search->graph;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int32_t k = graph->cell_portal[source]; k < graph->cell_portal[source + 1]; k++) {
        int32_t opening = graph->cell_portals[k] >> 1;
        for (int32_t c = graph->opening_corner[opening]; c < graph->opening_corner[opening + 1]; c++)
            for (int i = 0; i < 3; i++) {
                low[i] = fmin(low[i], graph->corners[c][i]);
                high[i] = fmax(high[i], graph->corners[c][i]);
            }
    }
    *size = 0;
    for (int i = 0; i < 3; i++) {
        middle[i] = low[i] / 2 + high[i] / 2;
        *size = fmax(*size, high[i] - low[i]);
    }
}

static void make_edge(const double a[3], const double b[3], const double middle[3], double scale,
                      double column[ENF_LINE_ROWS]) {
    double p[3], q[3], length = 0;
    for (int i = 0; i < 3; i++) {
        p[i] = (a[i] - middle[i]) * scale;
        q[i] = (b[i] - middle[i]) * scale;
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        column[i] = q[i] - p[i];
        column[3 + i] = p[j] * (q[k] - p[k]) - p[k] * (q[j] - p[j]);
    }
    for (int r = 0; r < 6; r++) length += column[r] * column[r];
    length = sqrt(length);
    for (int r = 0; r < 6; r++) column[r] /= length;
    column[6] = 1;
}

void hidden_search_edges(hidden_search *search, int32_t source) {
    const enf_portal_graph *graph = search->graph;
    double middle[3], size;
    find_middle(search, source, middle, &size);
    double scale = size > 0 ? 0.25 / size : 1;
    for (int32_t c = 0; c < graph->opening_corner[graph->opening_count]; c++)
        make_edge(graph->corners[c], graph->corners[search->proof.corner_next[c]], middle, scale,
                  search->edge[c]);
}

// ---------------------------------------------------------------------------------------------- program

/// The directed portal that an edge, as in hidden_proof.h, belongs to.
static int32_t corner_portal(const hidden_search *search, int32_t edge) {
    return 2 * search->corner_opening[edge >> 1] + (edge & 1);
}

/// Columns of the portal's edges from `first` on; against the winding for the second of the twins.
static int32_t add_columns(hidden_search *search, int32_t first, int32_t portal) {
    const int32_t *offset = search->graph->opening_corner;
    int32_t begin = offset[portal >> 1], end = offset[(portal >> 1) + 1];
    int32_t count = first + end - begin;
    if (!enf_array_reserve(search->columns, search->column_capacity, (size_t)count) ||
        !enf_array_reserve(search->column_edge, search->column_edge_capacity, (size_t)count)) {
        search->failed = true;
        return first;
    }
    double sign = portal & 1 ? -1 : 1;
    for (int32_t c = begin; c < end; c++) {
        double *column = search->columns[first + c - begin];
        for (int r = 0; r < 6; r++) column[r] = sign * search->edge[c][r];
        column[6] = 1;
        search->column_edge[first + c - begin] = 2 * c + (portal & 1);
    }
    return count;
}

static bool point_passes(const hidden_search *search, const double *x, int32_t first, int32_t end) {
    for (int32_t k = first; k < end; k++) {
        const double *e = search->columns[k];
        if (!(x[0] * e[0] + x[1] * e[1] + x[2] * e[2] + x[3] * e[3] + x[4] * e[4] + x[5] * e[5] > pass_least))
            return false;
    }
    return true;
}

/// Is it certain that the edges of the basis leave no line?
static bool certificate_holds(hidden_search *search, const enf_line_basis *basis, double least) {
    int32_t edges[ENF_PROOF_EDGES];
    int count = 0;
    for (int i = 0; i < ENF_LINE_ROWS; i++)
        if (basis->column[i] >= 0 && basis->weight[i] >= least)
            edges[count++] = search->column_edge[basis->column[i]];
    return enf_hidden_proof_ask(&search->proof, edges, count);
}

/// Rounded corners make coplanar portals not quite coplanar, and their certificates not quite true. It is
/// certain then that no line goes through some earlier portal and afterwards through this one?
static bool portals_exclude(hidden_search *search, const hidden_frame *frame) {
    const int32_t *offset = search->graph->opening_corner;
    int32_t portal = frame->portal, own = offset[(portal >> 1) + 1] - offset[portal >> 1];
    const int32_t *edges = search->column_edge;
    for (int32_t at = 0; at + own < frame->column_count;) {
        int32_t earlier = corner_portal(search, edges[at]);
        int32_t count = offset[(earlier >> 1) + 1] - offset[earlier >> 1];
        int8_t *answer = enf_hidden_proof_of_portals(&search->proof, earlier, portal);
        if (*answer == 0) {
            int32_t both[2 * MANY_CORNERS];
            if (count > MANY_CORNERS || own > MANY_CORNERS) return false;
            memcpy(both, edges + at, (size_t)count * sizeof *both);
            memcpy(both + count, edges + frame->column_count - own, (size_t)own * sizeof *both);
            search->pieces.limit = FEW_PIECES;
            bool hidden = enf_hidden_pieces_ask(&search->pieces, earlier >> 1, portal >> 1, both,
                                                search->proof.corner_next, count + own) == ENF_PIECES_HIDDEN;
            *answer = hidden ? 1 : -1;
        }
        if (*answer > 0) return true;
        at += count;
    }
    return false;
}

static bool few_pieces_exclude(hidden_search *search, const hidden_frame *frame) {
    search->pieces.limit = FEW_PIECES;
    search->report->asked_early++;
    return enf_hidden_pieces_ask(&search->pieces, corner_portal(search, search->column_edge[0]) >> 1,
                                 frame->portal >> 1, search->column_edge, search->proof.corner_next,
                                 frame->column_count) == ENF_PIECES_HIDDEN;
}

bool hidden_search_program(hidden_search *search, hidden_frame *frame, int32_t portal) {
    int32_t first = frame->column_count;
    frame->portal = portal;
    frame->column_count = add_columns(search, first, portal);
    if (search->failed) return false;
    if (first == 0)
        enf_line_basis_begin(&frame->basis, search->columns[0]);
    else if (frame->basis.margin > margin_least &&
             point_passes(search, frame->basis.point, first, frame->column_count))
        return true;
    search->report->programs++;
    enf_line_basis_solve(&frame->basis, (const double(*)[ENF_LINE_ROWS])search->columns, frame->column_count,
                         margin_least);
    if (frame->basis.margin > margin_least) return true;
    if (certificate_holds(search, &frame->basis, weight_least)) return false;
    return !portals_exclude(search, frame) && !few_pieces_exclude(search, frame);
}

/// For neighbours: a line through the middle of the only portal, square to it.
static void make_straight_line(const hidden_search *search, int32_t portal, double from[3], double to[3]) {
    const enf_portal_graph *graph = search->graph;
    int32_t first = graph->opening_corner[portal >> 1], end = graph->opening_corner[(portal >> 1) + 1];
    double normal[3] = {0}, sign = portal & 1 ? -1 : 1;
    memset(from, 0, 3 * sizeof *from);
    for (int32_t c = first; c < end; c++) {
        const double *o = graph->corners[first], *a = graph->corners[c];
        const double *b = graph->corners[search->proof.corner_next[c]];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            from[i] += a[i] / (end - first);
            normal[i] += (a[j] - o[j]) * (b[k] - o[k]) - (a[k] - o[k]) * (b[j] - o[j]);
        }
    }
    for (int i = 0; i < 3; i++) to[i] = from[i] + sign * normal[i];
}

bool hidden_search_pieces(hidden_search *search, const hidden_frame *frame, enf_hidden_pair *pair) {
    enf_hidden_pieces *work = &search->pieces;
    work->limit = search->options->piece_limit ? search->options->piece_limit : PIECE_LIMIT;
    search->report->asked++;
    enf_pieces_answer answer = hidden_search_in_order(search, frame);
    bool neighbours = frame == search->stack;
    if (neighbours) make_straight_line(search, frame->portal, work->from, work->to);
    pair->cell[0] = enf_portal_from(search->graph, search->stack[0].portal);
    pair->cell[1] = enf_portal_to(search->graph, frame->portal);
    if (neighbours || answer == ENF_PIECES_SEEN) {
        enf_witness line = {.cell = {pair->cell[0], pair->cell[1]}};
        memcpy(line.from, work->from, sizeof line.from);
        memcpy(line.to, work->to, sizeof line.to);
        pair->verified = enf_witness_check(&search->witness, &line).fault == ENF_WITNESS_HOLDS;
        pair->seen = pair->verified || answer == ENF_PIECES_SEEN;
        memcpy(pair->from, line.from, sizeof pair->from);
        memcpy(pair->to, line.to, sizeof pair->to);
    }
    return answer == ENF_PIECES_HIDDEN;
}
