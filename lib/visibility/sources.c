// SPDX-License-Identifier: GPL-3.0-or-later
// The widest owners come first. Each joins the source, of those with bodies in one of its cells, together
// with which it is least wide, or is one by itself. Width is the mean over some directions: how many of the
// lines in space meet a convex body grows with its mean width. As those that join are less wide than those
// that are there, what holds for them holds for all.
#include "visibility/sources.h"

#include "base/array.h"
#include "visibility/window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// No source is wider than each of its owners by more than this part. (Found by trying, on levels: 0.5 takes
/// a tenth to a seventh more time, and has a pair in a hundred fewer.)
static const double growth_most = 0.7;

enum {
    WAYS = 13,        ///< that widths are measured along
    SOURCES_MOST = 64 ///< with bodies in a cell, that owners are tried with: the widest
};

/// Along the edges of a cube, the diagonals of its sides, and its own.
static const double ways[WAYS][3] = {
    {1, 0, 0},
    {0, 1, 0},
    {0, 0, 1},
    {M_SQRT1_2, M_SQRT1_2, 0},
    {M_SQRT1_2, -M_SQRT1_2, 0},
    {M_SQRT1_2, 0, M_SQRT1_2},
    {M_SQRT1_2, 0, -M_SQRT1_2},
    {0, M_SQRT1_2, M_SQRT1_2},
    {0, M_SQRT1_2, -M_SQRT1_2},
    {0.57735026918962576, 0.57735026918962576, 0.57735026918962576},
    {0.57735026918962576, 0.57735026918962576, -0.57735026918962576},
    {0.57735026918962576, -0.57735026918962576, 0.57735026918962576},
    {0.57735026918962576, -0.57735026918962576, -0.57735026918962576},
};

/// From where to where something reaches, along each way.
typedef struct extent {
    double low[WAYS], high[WAYS];
} extent;

/// An owner with bodies.
typedef struct candidate {
    double width;
    int32_t owner;
} candidate;

typedef struct maker {
    const enf_bodies *bodies;
    enf_sources *sources;
    extent *extents;       ///< per owner
    candidate *candidates; ///< the widest first
    int32_t candidate_count;
    extent *reached;       ///< per source
    double *width;         ///< of it
    int32_t *source_of;    ///< per owner
    int32_t *listed;       ///< the sources with bodies in each cell, from the place of its first body
    int32_t *listed_count; ///< per cell
} maker;

// ---------------------------------------------------------------------------------------------- widths

static inline double lower(double a, double b) {
    return a < b ? a : b;
}

static inline double higher(double a, double b) {
    return a > b ? a : b;
}

static void measure(const enf_bodies *bodies, int32_t owner, extent *extent) {
    for (int k = 0; k < WAYS; k++) {
        extent->low[k] = HUGE_VAL;
        extent->high[k] = -HUGE_VAL;
    }
    for (int32_t i = bodies->whole_first[owner]; i < bodies->whole_first[owner + 1]; i++)
        for (int k = 0; k < WAYS; k++) {
            const double at = enf_dot(ways[k], bodies->wholes[i]);
            extent->low[k] = lower(extent->low[k], at);
            extent->high[k] = higher(extent->high[k], at);
        }
}

static void extend(extent *extent, const struct extent *by) {
    for (int k = 0; k < WAYS; k++) {
        extent->low[k] = lower(extent->low[k], by->low[k]);
        extent->high[k] = higher(extent->high[k], by->high[k]);
    }
}

/// The sum of the widths of both together.
static double find_width(const extent *one, const extent *other) {
    double width = 0;
    for (int k = 0; k < WAYS; k++)
        width += higher(one->high[k], other->high[k]) - lower(one->low[k], other->low[k]);
    return width;
}

static int compare_candidates(const void *a, const void *b) {
    const candidate *one = a, *other = b;
    if (one->width != other->width) return one->width > other->width ? -1 : 1;
    return (one->owner > other->owner) - (one->owner < other->owner);
}

static void list_candidates(maker *maker) {
    const enf_bodies *bodies = maker->bodies;
    for (int32_t owner = 0; owner < bodies->owner_count; owner++) {
        if (bodies->owner_first[owner] == bodies->owner_first[owner + 1]) continue;
        extent *own = &maker->extents[owner];
        measure(bodies, owner, own);
        maker->candidates[maker->candidate_count++] = (candidate){find_width(own, own), owner};
    }
    qsort(maker->candidates, (size_t)maker->candidate_count, sizeof *maker->candidates, compare_candidates);
}

// ---------------------------------------------------------------------------------------------- joining

/// The source to join, or -1.
static int32_t choose_source(const maker *maker, const candidate *candidate) {
    const enf_bodies *bodies = maker->bodies;
    const int32_t owner = candidate->owner;
    double least = (1 + growth_most) * candidate->width;
    int32_t chosen = -1;
    for (int32_t k = bodies->owner_first[owner]; k < bodies->owner_first[owner + 1]; k++) {
        const int32_t cell = bodies->cells[k], *listed = maker->listed + bodies->cell_first[cell];
        for (int32_t i = 0; i < maker->listed_count[cell] && i < SOURCES_MOST; i++) {
            if (maker->width[listed[i]] >= least) continue;
            const double width = find_width(&maker->reached[listed[i]], &maker->extents[owner]);
            if (width >= least) continue;
            least = width;
            chosen = listed[i];
        }
    }
    return chosen;
}

/// Lists the source in the cells of an owner that has joined it.
static void list_source(maker *maker, int32_t source, int32_t owner) {
    const enf_bodies *bodies = maker->bodies;
    for (int32_t k = bodies->owner_first[owner]; k < bodies->owner_first[owner + 1]; k++) {
        const int32_t cell = bodies->cells[k];
        int32_t *listed = maker->listed + bodies->cell_first[cell], *count = &maker->listed_count[cell],
                i = 0;
        while (i < *count && listed[i] != source) i++;
        if (i == *count) listed[(*count)++] = source;
    }
}

static void join(maker *maker) {
    for (int32_t i = 0; i < maker->candidate_count; i++) {
        const int32_t owner = maker->candidates[i].owner;
        int32_t source = choose_source(maker, &maker->candidates[i]);
        if (source < 0) {
            source = maker->sources->count++;
            maker->reached[source] = maker->extents[owner];
        }
        extent *reached = &maker->reached[source];
        extend(reached, &maker->extents[owner]);
        maker->width[source] = find_width(reached, reached);
        maker->source_of[owner] = source;
        list_source(maker, source, owner);
    }
}

// ---------------------------------------------------------------------------------------------- the result

/// The owners of each source, the widest first.
static bool put_owners(const maker *maker) {
    enf_sources *sources = maker->sources;
    const int32_t count = maker->candidate_count;
    int32_t *first = sources->owner_first = enf_array_zeroed((size_t)sources->count + 2, sizeof *first);
    sources->owners = enf_array_new((size_t)count, sizeof *sources->owners);
    if (!first || !sources->owners) return false;
    for (int32_t i = 0; i < count; i++) first[maker->source_of[maker->candidates[i].owner] + 2]++;
    for (int32_t s = 0; s < sources->count; s++) first[s + 2] += first[s + 1];
    for (int32_t i = 0; i < count; i++) {
        const int32_t owner = maker->candidates[i].owner;
        sources->owners[first[maker->source_of[owner] + 1]++] = owner; // in the end the next source's
    }
    return true;
}

static int compare_cells(const void *a, const void *b) {
    const int32_t one = *(const int32_t *)a, other = *(const int32_t *)b;
    return (one > other) - (one < other);
}

/// Sorts cells, and leaves each once. Returns how many.
static int32_t sort_cells(int32_t *cells, int32_t count) {
    int32_t made = 0;
    qsort(cells, (size_t)count, sizeof *cells, compare_cells);
    for (int32_t i = 0; i < count; i++)
        if (i == 0 || cells[i] != cells[i - 1]) cells[made++] = cells[i];
    return made;
}

/// What the owners of a source have, after what the sources before it have.
static void gather(enf_sources *sources, const enf_bodies *bodies, int32_t source) {
    const int32_t first = sources->cell_first[source];
    int32_t cells = first, corners = sources->corner_first[source];
    for (int32_t i = sources->owner_first[source]; i < sources->owner_first[source + 1]; i++) {
        const int32_t *own = bodies->owner_first + sources->owners[i],
                      *whole = bodies->whole_first + sources->owners[i];
        memcpy(sources->cells + cells, bodies->cells + own[0], (size_t)(own[1] - own[0]) * sizeof *own);
        memcpy(sources->corners + corners, bodies->wholes + whole[0],
               (size_t)(whole[1] - whole[0]) * sizeof *bodies->wholes);
        cells += own[1] - own[0];
        corners += whole[1] - whole[0];
    }
    sources->cell_first[source + 1] = first + sort_cells(sources->cells + first, cells - first);
    sources->corner_first[source + 1] = corners;
}

static bool put_cells(enf_sources *sources, const enf_bodies *bodies) {
    const size_t places = (size_t)sources->count + 1;
    sources->cell_first = enf_array_zeroed(places, sizeof *sources->cell_first);
    sources->corner_first = enf_array_zeroed(places, sizeof *sources->corner_first);
    sources->cells = enf_array_new((size_t)bodies->count, sizeof *sources->cells);
    sources->corners =
        enf_array_new((size_t)bodies->whole_first[bodies->owner_count], sizeof *sources->corners);
    if (!sources->cell_first || !sources->corner_first || !sources->cells || !sources->corners) return false;
    for (int32_t s = 0; s < sources->count; s++) gather(sources, bodies, s);
    return true;
}

static bool start(maker *maker) {
    const size_t owners = (size_t)maker->bodies->owner_count, cells = (size_t)maker->bodies->cell_count;
    maker->extents = enf_array_new(owners, sizeof *maker->extents);
    maker->candidates = enf_array_new(owners, sizeof *maker->candidates);
    maker->reached = enf_array_new(owners, sizeof *maker->reached);
    maker->width = enf_array_new(owners, sizeof *maker->width);
    maker->source_of = enf_array_new(owners, sizeof *maker->source_of);
    maker->listed = enf_array_new((size_t)maker->bodies->count, sizeof *maker->listed);
    maker->listed_count = enf_array_zeroed(cells, sizeof *maker->listed_count);
    return maker->extents && maker->candidates && maker->reached && maker->width && maker->source_of &&
           maker->listed && maker->listed_count;
}

bool enf_sources_make(enf_sources *sources, const enf_bodies *bodies) {
    *sources = (enf_sources){0};
    maker maker = {.bodies = bodies, .sources = sources};
    bool good = start(&maker);
    if (good) {
        list_candidates(&maker);
        join(&maker);
        good = put_owners(&maker) && put_cells(sources, bodies);
    }
    free(maker.extents);
    free(maker.candidates);
    free(maker.reached);
    free(maker.width);
    free(maker.source_of);
    free(maker.listed);
    free(maker.listed_count);
    return good;
}

void enf_sources_free(enf_sources *sources) {
    free(sources->owner_first);
    free(sources->owners);
    free(sources->cell_first);
    free(sources->cells);
    free(sources->corner_first);
    free(sources->corners);
    *sources = (enf_sources){0};
}
