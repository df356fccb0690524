// SPDX-License-Identifier: GPL-3.0-or-later
// Decimate: collapse the lightest portal again and again, until the stop rule says so.
#include "build/decimate.h"

#include "base/array.h"
#include "base/sets.h"
#include "build/portal_heap.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Collapses between two calls of `progress`.
#define PROGRESS_STEP 1000

/// Steps of the weight in which the blocks take turns.
enum { STEPS = 4 };

/// Where a weight is given, the part of it up to which they do: what is left is collapsed in strict order.
#define UNORDERED_PART 0.75

static const char *const heuristic_names[ENF_HEURISTIC_COUNT] = {"aspect", "aspect-scaled"};

int enf_heuristic_find(const char *name) {
    for (int i = 0; i < ENF_HEURISTIC_COUNT; ++i)
        if (strcmp(name, heuristic_names[i]) == 0) return i;
    return -1;
}

const char *enf_heuristic_name(enf_heuristic heuristic) {
    return (int)heuristic >= 0 && heuristic < ENF_HEURISTIC_COUNT ? heuristic_names[heuristic] : "?";
}

enf_status enf_stop_parse(const char *text, enf_stop *stop, enf_error *error) {
    *stop = (enf_stop){.rule = ENF_STOP_AUTO};
    if (strcmp(text, "auto") == 0) return ENF_OK;
    char *end = NULL;
    errno = 0;
    if (strncmp(text, "weight=", 7) == 0) {
        stop->rule = ENF_STOP_WEIGHT;
        stop->weight = strtod(text + 7, &end);
        if (end != text + 7 && *end == 0 && stop->weight >= 0) return ENF_OK;
        return enf_fail(error, ENF_BAD_USAGE, "stop rule '%s': the weight must be a number, 0 or more", text);
    }
    if (strncmp(text, "cells=", 6) == 0) {
        stop->rule = ENF_STOP_CELLS;
        stop->cells = strtoll(text + 6, &end, 10);
        if (end != text + 6 && *end == 0 && errno == 0 && stop->cells >= 1) return ENF_OK;
        return enf_fail(error, ENF_BAD_USAGE,
                        "stop rule '%s': the number of cells must be a whole number, 1 or more", text);
    }
    return enf_fail(error, ENF_BAD_USAGE, "unknown stop rule '%s'; use auto, weight=W or cells=N", text);
}

void enf_decimation_free(enf_decimation *decimation) {
    free(decimation->cell_of);
    free(decimation->collapses);
    *decimation = (enf_decimation){0};
}

/// Fills cell_of by doing the collapses again on numbers alone.
static void number_cells(enf_decimation *out, int32_t graph_cells) {
    int32_t *cell_of = out->cell_of;
    enf_sets_start(cell_of, graph_cells);
    for (size_t i = 0; i < out->collapse_count; ++i)
        enf_sets_unite(cell_of, out->collapses[i].kept, out->collapses[i].gone);
    for (int32_t cell = 0; cell < graph_cells; ++cell) cell_of[cell] = enf_sets_find(cell_of, cell);
    out->cell_count = 0;
    for (int32_t cell = 0; cell < graph_cells; ++cell)
        cell_of[cell] = cell_of[cell] == cell ? out->cell_count++ : cell_of[cell_of[cell]];
}

static bool is_done(const enf_stop *stop, int64_t cells, double weight) {
    switch (stop->rule) {
    case ENF_STOP_WEIGHT:
        return weight >= stop->weight;
    case ENF_STOP_CELLS:
        return cells <= stop->cells;
    case ENF_STOP_AUTO:
        break;
    }
    return false;
}

/// The thesis (4.3.1) saw the aspect, a ratio that has no scale, jump from 2 to 5 where rooms begin, and
/// proposes a threshold of 3 to 4. With `aspect` the automatic stop looks for the largest jump to a value of
/// at least the first from one of at most the second; there is nothing to look for once that is passed.
static const double jump_over = 3, jump_from = 5;

/// Other weights have a scale: with them it looks for the largest jump in the last collapses, this part of
/// all.
enum { TAIL_PART = 16 };

/// The automatic stop: how many of the collapses to do. Weights rise and fall, so the jumps are those of the
/// highest weight so far; the cut is before the collapse with the largest one, the first if there are
/// several.
static size_t choose_cut(const enf_collapse *collapses, size_t count, enf_heuristic heuristic) {
    size_t cut = count, tail = count - count / TAIL_PART;
    double highest = 0, largest = 1;
    for (size_t i = 0; i < count; ++i) {
        double weight = collapses[i].weight;
        if (!(weight > highest)) continue;
        bool wanted = i >= tail && highest > 0;
        if (heuristic == ENF_HEURISTIC_ASPECT)
            wanted = weight >= jump_over && highest > 0 && highest <= jump_from;
        if (wanted && weight / highest > largest) {
            largest = weight / highest;
            cut = i;
        }
        highest = weight;
    }
    return cut;
}

typedef struct task {
    enf_portal_heap portals;
    int32_t cell_count; ///< of the graph
    const enf_stop *stop;
    double scale; ///< weights in graph units times this are those in world units
    bool (*progress)(void *user, double fraction);
    void *user;
} task;

/// Collapses one portal and writes it down.
static enf_status collapse(task *task, int32_t portal, double weight, enf_decimation *out, enf_error *error) {
    enf_collapse *done = &out->collapses[out->collapse_count++];
    done->weight = weight;
    if (!enf_portal_heap_collapse(&task->portals, portal, &done->kept, &done->gone))
        return enf_fail_memory(error, "the surface of a cell");
    if (task->progress && out->collapse_count % PROGRESS_STEP == 0 &&
        !task->progress(task->user, (double)out->collapse_count / (double)task->cell_count))
        return enf_fail(error, ENF_NO_RESOURCES, "decimate: cancelled");
    return ENF_OK;
}

/// Collapses what is lighter than `limit` in a block, the lightest first.
static enf_status collapse_block(task *task, int32_t block, double limit, enf_decimation *out,
                                 enf_error *error) {
    for (;;) {
        int32_t portal;
        double weight;
        enf_status status = enf_portal_heap_top(&task->portals, block, &portal, &weight, error);
        if (status != ENF_OK || portal < 0) return status;
        weight *= task->scale;
        if (weight >= limit) return ENF_OK;
        status = collapse(task, portal, weight, out, error);
        if (status != ENF_OK) return status;
    }
}

/// A large world block by block, in steps of the weight: the order within a step can't matter much, and a
/// block stays near the processor while all of it is collapsed.
static enf_status collapse_blocks(task *task, double limit, enf_decimation *out, enf_error *error) {
    for (int step = 1; step <= STEPS; ++step)
        for (int32_t block = 0; block < task->portals.heap.block_count; ++block) {
            enf_status status = collapse_block(task, block, limit * step / STEPS, out, error);
            if (status != ENF_OK) return status;
        }
    if (!enf_block_heap_divide(&task->portals.heap, ENF_ONE_BLOCK_BITS))
        return enf_fail_memory(error, "the portals");
    return ENF_OK;
}

static enf_status collapse_all(task *task, enf_decimation *out, enf_error *error) {
    for (;;) {
        int32_t portal;
        enf_status status = enf_portal_heap_top(&task->portals, 0, &portal, &out->next_weight, error);
        if (status != ENF_OK || portal < 0) return status;
        out->next_weight *= task->scale;
        int64_t cells = task->cell_count - (int64_t)out->collapse_count;
        if (is_done(task->stop, cells, out->next_weight)) return ENF_OK;
        status = collapse(task, portal, out->next_weight, out, error);
        if (status != ENF_OK) return status;
        if (task->stop->rule == ENF_STOP_AUTO && task->portals.heuristic == ENF_HEURISTIC_ASPECT &&
            out->next_weight > jump_from)
            return ENF_OK;
    }
}

/// Up to which weight the order of collapses doesn't decide where they stop; 0: it always does.
static double unordered_limit(const enf_stop *stop, enf_heuristic heuristic) {
    switch (stop->rule) {
    case ENF_STOP_WEIGHT:
        return stop->weight * UNORDERED_PART;
    case ENF_STOP_AUTO:
        return heuristic == ENF_HEURISTIC_ASPECT ? jump_over : 0;
    case ENF_STOP_CELLS:
        break;
    }
    return 0;
}

enf_status enf_graph_decimate(enf_graph *graph, enf_heuristic heuristic, const enf_stop *stop, double unit,
                              bool (*progress)(void *user, double fraction), void *user, enf_decimation *out,
                              enf_error *error) {
    *out = (enf_decimation){0};
    if ((int)heuristic < 0 || heuristic >= ENF_HEURISTIC_COUNT || !(unit > 0)) {
        enf_graph_free(graph);
        return enf_fail(error, ENF_BAD_USAGE, "decimate: heuristic %d, unit %g", (int)heuristic, unit);
    }
    task task = {.cell_count = graph->cell_count,
                 .stop = stop,
                 .scale = heuristic == ENF_HEURISTIC_ASPECT_SCALED ? 1 / unit : 1,
                 .progress = progress,
                 .user = user};
    const double limit = unordered_limit(stop, heuristic);
    enf_status status = enf_portal_heap_create(&task.portals, graph, heuristic, limit > 0, error);
    if (status != ENF_OK) return status;
    out->cell_of = enf_array_new((size_t)task.cell_count, sizeof *out->cell_of);
    out->collapses = enf_array_new((size_t)task.cell_count, sizeof *out->collapses);
    if (!out->cell_of || !out->collapses) status = enf_fail_memory(error, "the list of collapses");
    if (status == ENF_OK && task.portals.heap.block_count > 1)
        status = collapse_blocks(&task, limit, out, error);
    if (status == ENF_OK) status = collapse_all(&task, out, error);
    if (status == ENF_OK && stop->rule == ENF_STOP_AUTO) {
        size_t cut = choose_cut(out->collapses, out->collapse_count, heuristic);
        if (cut < out->collapse_count) out->next_weight = out->collapses[cut].weight;
        out->collapse_count = cut;
    }
    out->evaluations = task.portals.evaluations;
    enf_portal_heap_free(&task.portals);
    if (status == ENF_OK)
        number_cells(out, task.cell_count);
    else
        enf_decimation_free(out);
    return status;
}
