// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/read_prt.h"

#include "base/array.h"
#include "visibility/winding.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LARGEST_COORDINATE 1e100 ///< products of three stay finite
#define LARGEST_COUNT (1 << 30)

enum {
    PORTAL_BYTES = 16,     ///< no portal is shorter
    LEAF_BYTES = 2,        ///< nor is a leaf's number and what follows it
    LONE_CELLS_MAX = 65536 ///< so many cells of a PRT1 may be without a portal: Quake's limit of leafs
};

typedef struct reader {
    enf_portal_graph *graph;
    enf_source *source;
    bool has_groups, has_map; ///< PRT2, PRT1-AM
    int64_t cells, portals, leafs;
    int64_t line; ///< where the portal at hand begins
} reader;

/// True if something is left in the file.
static bool skip_space(enf_source *source) {
    while (!enf_source_more(source))
        if (!enf_source_next_line(source)) return false;
    return true;
}

static enf_status fail_missing(const reader *r, enf_error *error, const char *what) {
    if (!skip_space(r->source))
        return enf_fail(error, ENF_BAD_INPUT,
                        "%s:%" PRId64 ": the file ends where %s should stand; is it truncated?",
                        r->source->name, r->source->line, what);
    return enf_fail(error, ENF_BAD_INPUT, "%s:%" PRId64 ": %s should stand here; make the file again",
                    r->source->name, r->source->line, what);
}

static bool take_whole(enf_source *source, int64_t *value) {
    return skip_space(source) && enf_source_whole(source, value) && enf_source_word_ends(source);
}

/// A decimal number, maybe infinite.
static bool take_number(enf_source *source, double *value) {
    if (!skip_space(source)) return false;
    const char *end = source->at + strspn(source->at, "0123456789+-.eE");
    return end > source->at && enf_source_number(source, value) && source->at == end;
}

static bool take_bracket(enf_source *source, char bracket) {
    if (!skip_space(source) || *source->at != bracket) return false;
    source->at++;
    return true;
}

static enf_status read_magic(reader *r, enf_error *error) {
    size_t length;
    const char *word = enf_source_word(r->source, &length);
    r->has_groups = enf_word_is(word, length, "PRT2");
    r->has_map = enf_word_is(word, length, "PRT1-AM");
    if ((r->has_groups || r->has_map || enf_word_is(word, length, "PRT1")) && !enf_source_more(r->source))
        return ENF_OK;
    return enf_source_fail(r->source, error,
                           "this is no portal file: its first line should be PRT1, PRT2 or PRT1-AM");
}

static enf_status read_count(reader *r, int64_t *count, const char *what, int64_t least, enf_error *error) {
    char words[64];
    snprintf(words, sizeof words, "the number of %s", what);
    if (!take_whole(r->source, count)) return fail_missing(r, error, words);
    if (*count >= least && *count <= LARGEST_COUNT) return ENF_OK;
    return enf_fail(error, ENF_BAD_INPUT,
                    "%s:%" PRId64 ": %" PRId64 " is no number of %s; it is %" PRId64 " to %d",
                    r->source->name, r->source->line, *count, what, least, LARGEST_COUNT);
}

/// Nothing is allocated that the file has no bytes for.
static enf_status check_counts(const reader *r, enf_error *error) {
    int64_t size = (int64_t)r->source->size;
    const char *wrong = NULL;
    if (r->portals > size / PORTAL_BYTES)
        wrong = "the header announces more portals than the file can hold; is it truncated?";
    else if (r->leafs > size / LEAF_BYTES)
        wrong = "the header announces more leafs than the file can hold; is it truncated?";
    else if ((r->has_groups || r->has_map) && r->cells > r->leafs)
        wrong = "the header announces more clusters than leafs; each has one or more, make the file again";
    else if (r->cells > 2 * r->portals + LONE_CELLS_MAX)
        wrong = "the header announces far more leafs than portals; is it truncated?";
    return wrong ? enf_source_fail(r->source, error, wrong) : ENF_OK;
}

static enf_status read_header(reader *r, enf_error *error) {
    enf_status status = read_magic(r, error);
    if (!status && r->has_groups) status = read_count(r, &r->leafs, "leafs", 1, error);
    if (!status)
        status = read_count(r, &r->cells, r->has_groups || r->has_map ? "clusters" : "leafs", 1, error);
    if (!status) status = read_count(r, &r->portals, "portals", 0, error);
    if (!status && r->has_map) status = read_count(r, &r->leafs, "leafs", 1, error);
    if (!status) status = check_counts(r, error);
    r->graph->cell_count = status ? 0 : (int32_t)r->cells;
    return status;
}

static enf_status read_cell(reader *r, int32_t *cell, enf_error *error) {
    int64_t number;
    const char *what = r->has_groups || r->has_map ? "cluster" : "leaf";
    char words[64];
    snprintf(words, sizeof words, "the number of a %s", what);
    if (!take_whole(r->source, &number)) return fail_missing(r, error, words);
    if (number < 0 || number >= r->cells)
        return enf_fail(error, ENF_BAD_INPUT,
                        "%s:%" PRId64 ": there is no %s %" PRId64 "; they are numbered 0 to %" PRId64,
                        r->source->name, r->source->line, what, number, r->cells - 1);
    *cell = (int32_t)number;
    return ENF_OK;
}

static enf_status read_corner(reader *r, double corner[3], enf_error *error) {
    if (!take_bracket(r->source, '(')) return fail_missing(r, error, "the ( of a corner");
    for (int a = 0; a < 3; a++) {
        if (!take_number(r->source, &corner[a])) return fail_missing(r, error, "a coordinate");
        if (!(fabs(corner[a]) <= LARGEST_COORDINATE))
            return enf_source_fail(r->source, error,
                                   "this coordinate is beyond 1e100; make the world smaller");
    }
    if (!take_bracket(r->source, ')')) return fail_missing(r, error, "the ) after three coordinates");
    return ENF_OK;
}

static enf_status check_winding(const reader *r, const double (*corners)[3], int32_t count,
                                enf_error *error) {
    int32_t corner = 0;
    const char *wrong = "";
    switch (count < 3 ? ENF_WINDING_NO_AREA : enf_winding_judge(corners, count, &corner)) {
    case ENF_WINDING_FINE:
        return ENF_OK;
    case ENF_WINDING_NO_AREA:
        return enf_fail(error, ENF_BAD_INPUT,
                        "%s:%" PRId64 ": this portal has no area; remove it, or write it with more digits",
                        r->source->name, r->line);
    case ENF_WINDING_NOT_PLANAR:
        wrong = "is not flat";
        break;
    case ENF_WINDING_NOT_CONVEX:
        wrong = "is not convex";
        break;
    }
    return enf_fail(error, ENF_BAD_INPUT,
                    "%s:%" PRId64
                    ": this portal %s, by more than %.3g, at (%g %g %g); split it, or write it with more "
                    "digits",
                    r->source->name, r->line, wrong, enf_winding_tolerance(corners, count),
                    corners[corner][0], corners[corner][1], corners[corner][2]);
}

static enf_status read_winding(reader *r, int64_t count, const int32_t cells[2], enf_error *error) {
    double corners[ENF_WINDING_CORNERS_MAX][3];
    for (int64_t i = 0; i < count; i++) {
        enf_status status = read_corner(r, corners[i], error);
        if (status) return status;
    }
    int32_t kept = enf_winding_drop_doubles(corners, (int32_t)count);
    enf_status status = check_winding(r, (const double(*)[3])corners, kept, error);
    if (status) return status;
    if (!enf_portal_graph_add(r->graph, cells[0], cells[1], (const double(*)[3])corners, kept))
        return enf_fail_memory(error, "the portals");
    return ENF_OK;
}

static enf_status read_portal(reader *r, enf_error *error) {
    int64_t count;
    int32_t cells[2];
    bool given = take_whole(r->source, &count);
    r->line = r->source->line;
    if (!given) return fail_missing(r, error, "a portal's number of corners");
    if (count < 3 || count > ENF_WINDING_CORNERS_MAX)
        return enf_fail(error, ENF_BAD_INPUT,
                        "%s:%" PRId64 ": a portal has 3 to %d corners, not %" PRId64 "; split it",
                        r->source->name, r->line, ENF_WINDING_CORNERS_MAX, count);
    for (int i = 0; i < 2; i++) {
        enf_status status = read_cell(r, &cells[i], error);
        if (status) return status;
    }
    if (cells[0] == cells[1])
        return enf_source_fail(r->source, error, "this portal leads from a cell into itself; remove it");
    return read_winding(r, count, cells, error);
}

static enf_status prepare_leafs(reader *r, enf_error *error) {
    r->graph->leaf_cell = enf_array_new((size_t)r->leafs, sizeof *r->graph->leaf_cell);
    if (!r->graph->leaf_cell) return enf_fail_memory(error, "the leafs");
    r->graph->leaf_count = (int32_t)r->leafs;
    for (int64_t i = 0; i < r->leafs; i++) r->graph->leaf_cell[i] = -1;
    return ENF_OK;
}

/// The leafs of one cluster, and -1.
static enf_status read_group(reader *r, int32_t cell, enf_error *error) {
    for (int64_t leaf, count = 0;; count++) {
        if (!take_whole(r->source, &leaf)) return fail_missing(r, error, "a leaf of a cluster, or -1");
        if (leaf == -1 && count > 0) return ENF_OK;
        if (leaf == -1)
            return enf_fail(error, ENF_BAD_INPUT,
                            "%s:%" PRId64 ": cluster %" PRId32 " has no leafs; make the file again",
                            r->source->name, r->source->line, cell);
        if (leaf < 0 || leaf >= r->leafs)
            return enf_fail(error, ENF_BAD_INPUT,
                            "%s:%" PRId64 ": there is no leaf %" PRId64 "; they are numbered 0 to %" PRId64,
                            r->source->name, r->source->line, leaf, r->leafs - 1);
        if (r->graph->leaf_cell[leaf] >= 0)
            return enf_fail(error, ENF_BAD_INPUT,
                            "%s:%" PRId64 ": leaf %" PRId64 " is in cluster %" PRId32
                            " already; make the file again",
                            r->source->name, r->source->line, leaf, r->graph->leaf_cell[leaf]);
        r->graph->leaf_cell[leaf] = cell;
    }
}

/// PRT2: every leaf is in one group.
static enf_status read_groups(reader *r, enf_error *error) {
    enf_status status = prepare_leafs(r, error);
    for (int32_t cell = 0; !status && cell < r->graph->cell_count; cell++)
        status = read_group(r, cell, error);
    for (int32_t leaf = 0; !status && leaf < r->graph->leaf_count; leaf++)
        if (r->graph->leaf_cell[leaf] < 0)
            status = enf_fail(error, ENF_BAD_INPUT,
                              "%s:%" PRId64 ": leaf %" PRId32 " is in no cluster; make the file again",
                              r->source->name, r->source->line, leaf);
    return status;
}

/// PRT1-AM: every cluster has a leaf.
static enf_status read_map(reader *r, enf_error *error) {
    enf_status status = prepare_leafs(r, error);
    bool *filled = enf_array_zeroed((size_t)r->cells, sizeof *filled);
    if (!status && !filled) status = enf_fail_memory(error, "the clusters");
    for (int32_t leaf = 0; !status && leaf < r->graph->leaf_count; leaf++) {
        status = read_cell(r, &r->graph->leaf_cell[leaf], error);
        if (!status) filled[r->graph->leaf_cell[leaf]] = true;
    }
    for (int32_t cell = 0; !status && cell < r->graph->cell_count; cell++)
        if (!filled[cell])
            status = enf_fail(error, ENF_BAD_INPUT,
                              "%s:%" PRId64 ": cluster %" PRId32 " has no leafs; make the file again",
                              r->source->name, r->source->line, cell);
    free(filled);
    return status;
}

static enf_status read_all(reader *r, enf_error *error) {
    enf_status status = read_header(r, error);
    for (int64_t i = 0; !status && i < r->portals; i++) status = read_portal(r, error);
    if (!status && r->has_groups) status = read_groups(r, error);
    if (!status && r->has_map) status = read_map(r, error);
    if (!status && skip_space(r->source))
        status = enf_source_fail(
            r->source, error, "something stands after the end of the graph; does the header count too few?");
    return status;
}

enf_status enf_read_prt(enf_portal_graph *graph, enf_source *source, enf_error *error) {
    reader r = {.graph = graph, .source = source};
    *graph = (enf_portal_graph){0};
    source->brackets = true;
    enf_status status = read_all(&r, error);
    if (!status) status = enf_portal_graph_finish(graph, error);
    if (status) enf_portal_graph_free(graph);
    return status;
}

enf_status enf_portal_graph_read(enf_portal_graph *graph, const char *path, enf_error *error) {
    enf_source source;
    *graph = (enf_portal_graph){0};
    enf_status status = enf_source_open(&source, path, error);
    if (!status) status = enf_read_prt(graph, &source, error);
    enf_source_close(&source);
    return status;
}
