// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/flow.h"

#include "base/array.h"
#include "base/timer.h"
#include "visibility/separator.h"

#include <stdlib.h>
#include <string.h>

enum { STEPS_A_LOOK = 1024 };

/// A portal of the sequence.
typedef struct level {
    int32_t portal;
    int32_t next; ///< which portal of the cell behind it to try next, in cell_portals
    bool ready;   ///< the separators are there
    enf_window window;
    enf_separators separators; ///< between the source and this window
} level;

struct enf_flow {
    enf_flow_options options;
    enf_stabber *stabber;
    size_t words;     ///< in a row of portals
    uint64_t *wanted; ///< portals into the cells that are asked for
    uint64_t *masks;  ///< per level, a row: what all portals of the sequence may see
    level *levels;
    int32_t *sequence;
    size_t mask_capacity, level_capacity, sequence_capacity;
    uint64_t *targets;  ///< the caller's
    uint64_t *doubtful; ///< a row of cells: whether a line in order goes there was not decided
    int32_t cell;
    size_t low, high; ///< the words that hold wanted bits, or bits of the source's row
    enf_window from;
    int64_t nodes;
    int32_t steps; ///< since the clock was looked at
    bool late;
};

static bool make_room(enf_flow *flow, int32_t depth) {
    size_t levels = (size_t)depth + 2;
    return enf_array_reserve(flow->levels, flow->level_capacity, levels) &&
           enf_array_reserve(flow->sequence, flow->sequence_capacity, levels) &&
           enf_array_reserve(flow->masks, flow->mask_capacity, levels * flow->words);
}

static size_t cell_words(const enf_flow *flow) {
    return ((size_t)flow->options.shapes->graph->cell_count + 63) / 64;
}

enf_flow *enf_flow_new(const enf_flow_options *options) {
    enf_flow *flow = calloc(1, sizeof *flow);
    if (!flow) return NULL;
    flow->options = *options;
    flow->words = options->beams->row_words;
    flow->wanted = enf_array_zeroed(flow->words, sizeof *flow->wanted);
    flow->stabber = enf_stabber_new(options->pluecker);
    flow->doubtful = enf_array_zeroed(cell_words(flow), sizeof *flow->doubtful);
    if (flow->wanted && flow->doubtful && flow->stabber && make_room(flow, 16)) return flow;
    enf_flow_free(flow);
    return NULL;
}

void enf_flow_free(enf_flow *flow) {
    if (!flow) return;
    enf_stabber_free(flow->stabber);
    free(flow->wanted);
    free(flow->doubtful);
    free(flow->masks);
    free(flow->levels);
    free(flow->sequence);
    free(flow);
}

int64_t enf_flow_nodes(const enf_flow *flow) {
    return flow->nodes;
}

const enf_stab_counts *enf_flow_stabs(const enf_flow *flow) {
    return enf_stabber_counts(flow->stabber);
}

// ---------------------------------------------------------------------------------------------- masks

/// Marks the portals into target cells that the source may see; false if there are none.
static bool find_wanted(enf_flow *flow, const uint64_t *row) {
    const enf_portal_graph *graph = flow->options.shapes->graph;
    bool found = false;
    memset(flow->wanted, 0, flow->words * sizeof *flow->wanted);
    flow->low = flow->words, flow->high = 0;
    for (int32_t q = -1; (q = enf_bit_next(row, flow->words, q + 1)) >= 0;) {
        size_t word = (size_t)q >> 6;
        if (flow->low > word) flow->low = word;
        flow->high = word + 1;
        if (!enf_bit_get(flow->targets, enf_portal_to(graph, q))) continue;
        enf_bit_set(flow->wanted, q);
        found = true;
    }
    return found;
}

/// No more portals into this cell.
static void drop_wanted(enf_flow *flow, int32_t cell) {
    const enf_portal_graph *graph = flow->options.shapes->graph;
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++)
        enf_bit_clear(flow->wanted, graph->cell_portals[k] ^ 1);
}

static uint64_t *mask_of(const enf_flow *flow, int32_t depth) {
    return flow->masks + (size_t)depth * flow->words;
}

/// What is left to be seen if the sequence goes on through this portal? False if nothing.
static bool narrow_mask(const enf_flow *flow, int32_t depth, int32_t portal) {
    const uint64_t *mask = mask_of(flow, depth), *row = enf_bits_row(flow->options.beams, portal);
    uint64_t *narrowed = mask_of(flow, depth + 1), left = 0;
    for (size_t w = flow->low; w < flow->high; w++) {
        narrowed[w] = mask[w] & row[w];
        left |= narrowed[w] & flow->wanted[w];
    }
    return left != 0;
}

static bool is_left(const enf_flow *flow, int32_t depth) {
    const uint64_t *mask = mask_of(flow, depth);
    uint64_t left = 0;
    for (size_t w = flow->low; w < flow->high; w++) left |= mask[w] & flow->wanted[w];
    return left != 0;
}

// ---------------------------------------------------------------------------------------------- sequences

static enf_status ask(enf_flow *flow, int32_t count, const enf_line *hint, enf_stab *stab, enf_error *error) {
    if (flow->options.exact)
        return enf_stab_in_order(flow->stabber, flow->options.shapes, flow->sequence, count, hint, stab,
                                 error);
    return enf_stab_lp(flow->stabber, flow->sequence, count, hint, stab, error);
}

/// Decides the sequence that ends at the level; it leads into a target. *passes: something stabs it.
static enf_status decide(enf_flow *flow, int32_t depth, bool *passes, enf_error *error) {
    enf_line hint;
    enf_stab stab;
    for (int32_t i = 0; i <= depth; i++) flow->sequence[i] = flow->levels[i].portal;
    enf_window_middle(&flow->from, hint.from);
    if (depth > 0) enf_window_middle(&flow->levels[depth].window, hint.to);
    enf_status status = ask(flow, depth + 1, depth > 0 ? &hint : NULL, &stab, error);
    if (status) return status;
    *passes = stab.answer != ENF_STAB_HIDDEN;
    if (!*passes) return ENF_OK;
    int32_t cell = enf_portal_to(flow->options.shapes->graph, flow->levels[depth].portal);
    if (flow->options.exact && stab.answer == ENF_STAB_OPEN) { // another sequence may tell
        enf_bit_set(flow->doubtful, cell);
        return ENF_OK;
    }
    enf_bit_clear(flow->targets, cell);
    drop_wanted(flow, cell);
    flow->options.seen(flow->options.user, flow->cell, cell, &stab, depth + 1);
    return ENF_OK;
}

/// Tries to go on from a level to a portal of the cell behind it. *deeper: the next level is ready.
static enf_status step(enf_flow *flow, int32_t depth, int32_t portal, bool *deeper, enf_error *error) {
    const enf_shapes *shapes = flow->options.shapes;
    level *level = &flow->levels[depth], *next = level + 1;
    *deeper = false;
    if (!enf_bit_get(mask_of(flow, depth), portal)) return ENF_OK;
    bool left = narrow_mask(flow, depth, portal), is_target = enf_bit_get(flow->wanted, portal);
    if (!left && !is_target) return ENF_OK;
    if (!level->ready)
        enf_separators_find(&level->separators, shapes, &flow->from, flow->levels[0].portal, &level->window,
                            level->portal);
    level->ready = true;
    if (enf_separators_pass(&level->separators, shapes, portal, &next->window) == ENF_REMAINS_NOTHING)
        return ENF_OK;
    flow->nodes++;
    next->portal = portal;
    next->next = shapes->graph->cell_portal[enf_portal_to(shapes->graph, portal)];
    next->ready = false;
    *deeper = left;
    if (!is_target) return ENF_OK;
    enf_status status = decide(flow, depth + 1, deeper, error);
    *deeper = *deeper && is_left(flow, depth + 1);
    return status;
}

/// Looks at the clock now and then.
static bool is_late(enf_flow *flow) {
    if (++flow->steps < STEPS_A_LOOK) return flow->late;
    flow->steps = 0;
    return flow->late = enf_timer_now() > flow->options.deadline;
}

/// A portal is never twice in a sequence: it is not in its own row.
static enf_status search(enf_flow *flow, int32_t source, enf_error *error) {
    const enf_portal_graph *graph = flow->options.shapes->graph;
    const uint64_t *row = enf_bits_row(flow->options.beams, source);
    level *first = &flow->levels[0];
    first->portal = source;
    enf_shape_window(flow->options.shapes, source, &flow->from);
    if (enf_bit_get(flow->targets, enf_portal_to(graph, source))) {
        bool passes;
        enf_status status = decide(flow, 0, &passes, error);
        if (status) return status;
    }
    if (!find_wanted(flow, row)) return ENF_OK;
    memcpy(mask_of(flow, 0), row, flow->words * sizeof *row);
    first->next = graph->cell_portal[enf_portal_to(graph, source)];
    first->ready = true;
    enf_separators_begin(&first->separators, flow->options.shapes, source);
    for (int32_t depth = 0; depth >= 0 && !is_late(flow);) {
        level *level = &flow->levels[depth];
        if (level->next == graph->cell_portal[enf_portal_to(graph, level->portal) + 1]) {
            depth--;
            continue;
        }
        if (!make_room(flow, depth + 1)) return enf_fail_memory(error, "a portal sequence");
        level = &flow->levels[depth];
        bool deeper;
        enf_status status = step(flow, depth, graph->cell_portals[level->next++], &deeper, error);
        if (status) return status;
        depth += deeper;
    }
    return ENF_OK;
}

/// What was not decided counts as seen, without a line: nothing may be missed.
static void see_doubtful(enf_flow *flow) {
    const enf_stab no_line = {.answer = ENF_STAB_VISIBLE};
    for (int32_t c = -1; (c = enf_bit_next(flow->doubtful, cell_words(flow), c + 1)) >= 0;) {
        enf_bit_clear(flow->doubtful, c);
        if (!enf_bit_get(flow->targets, c)) continue;
        enf_bit_clear(flow->targets, c);
        flow->options.seen(flow->options.user, flow->cell, c, &no_line, 0);
    }
}

enf_status enf_flow_settle(enf_flow *flow, int32_t cell, uint64_t *targets, bool *late, enf_error *error) {
    const enf_portal_graph *graph = flow->options.shapes->graph;
    flow->targets = targets;
    flow->cell = cell;
    flow->late = false;
    enf_status status = ENF_OK;
    for (int32_t k = graph->cell_portal[cell]; !status && !flow->late && k < graph->cell_portal[cell + 1];
         k++)
        status = search(flow, graph->cell_portals[k], error);
    see_doubtful(flow);
    *late = flow->late;
    return status;
}
