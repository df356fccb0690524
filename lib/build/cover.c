// SPDX-License-Identifier: GPL-3.0-or-later
// Where polygons of a closed world meet, their planes have cut the cells, so most facets lie wholly inside or
// wholly outside of a polygon: that takes the sides of their corners only. The others are clipped, in the
// plane.
#include "build/cover.h"

#include "base/array.h"
#include "build/polygon_lines.h"

#include <stdlib.h>
#include <string.h>

typedef struct finder {
    const enf_arrangement *arrangement;
    const enf_subdivision *space;
    enf_pool *pool;
    enf_polygon_lines lines;
    enf_covers *covers;
    int32_t *first; ///< per source, offsets into `facets`
    int32_t *facets;
} finder;

void enf_covers_free(enf_covers *covers) {
    free(covers->covers);
    free(covers->covered);
    enf_loops_free(&covers->loops);
    memset(covers, 0, sizeof *covers);
}

enf_loop enf_facet_loop(const enf_subdivision *space, int32_t facet, enf_pool *pool) {
    enf_loop loop = {enf_subdivision_plane(space, facet), (int32_t)pool->corner_count, 0};
    int32_t first = space->facets[facet].first, h = first;
    do {
        const enf_half *half = &space->halves[h], *next = &space->halves[half->next];
        if (next->edge_plane != half->edge_plane) { // a true corner at the end of this half
            if (!enf_array_reserve(pool->corners, pool->corner_capacity, pool->corner_count + 1)) {
                pool->failed = true;
                return loop;
            }
            pool->corners[pool->corner_count++] = (enf_corner){next->vertex, next->edge_plane};
            loop.count++;
        }
        h = half->next;
    } while (h != first);
    return loop;
}

static int32_t source_index(const finder *f, int32_t source) {
    return source >= 0 ? source : f->arrangement->tets.facet_count + (-1 - source);
}

/// Facets by source.
static bool sort_facets(finder *f) {
    const enf_subdivision *space = f->space;
    size_t sources = (size_t)f->arrangement->tets.facet_count + space->node_count;
    int32_t *next = f->first = enf_array_zeroed(sources + 2, sizeof *next);
    f->facets = enf_array_new(space->facet_count, sizeof *f->facets);
    if (!next || !f->facets) return false;
    for (size_t i = 0; i < space->facet_count; i++) next[source_index(f, space->facets[i].source) + 2]++;
    for (size_t i = 0; i < sources; i++) next[i + 2] += next[i + 1];
    for (size_t i = 0; i < space->facet_count; i++)
        f->facets[next[source_index(f, space->facets[i].source) + 1]++] = (int32_t)i;
    return true;
}

typedef enum overlap { NONE, PART, WHOLE } overlap;

/// The same for one line of a polygon with very many.
static overlap line_overlap(finder *f, int32_t first, int32_t line) {
    bool inside = false, outside = false;
    int32_t h = first;
    do {
        int side =
            enf_geometry_side(&f->pool->geometry, f->space->halves[h].vertex, f->lines.first_plane + line);
        inside |= side < 0;
        outside |= side > 0;
        h = f->space->halves[h].next;
    } while (h != first);
    return !inside ? NONE : outside ? PART : WHOLE;
}

/// What the polygon's lines say of a facet in its plane: PART may still turn out to be nothing.
static overlap facet_overlap(finder *f, int32_t facet) {
    const enf_half *halves = f->space->halves;
    int32_t first = f->space->facets[facet].first, h = first;
    uint32_t inside = 0, outside = 0;
    overlap result = WHOLE;
    if (f->lines.wanted) {
        do {
            const enf_line_sides *sides =
                enf_polygon_lines_at(&f->lines, &f->pool->geometry, halves[h].vertex);
            inside |= sides->inside;
            outside |= sides->outside;
            h = halves[h].next;
        } while (h != first);
        if (inside != f->lines.wanted) return NONE;
        if (outside) result = PART;
    }
    for (int32_t i = ENF_LINES_FEW; i < f->lines.count; i++) {
        overlap line = line_overlap(f, first, i);
        if (line == NONE) return NONE;
        if (line == PART) result = PART;
    }
    return result;
}

static bool add_cover(finder *f, int32_t facet, int32_t loop) {
    enf_covers *covers = f->covers;
    if (!enf_array_reserve(covers->covers, covers->capacity, covers->count + 1)) return false;
    const enf_arrangement *arrangement = f->arrangement;
    int32_t polygon = f->lines.polygon, plane = enf_subdivision_plane(f->space, facet);
    int32_t own = arrangement->polygon_plane[polygon];
    bool opposite = own != plane && !enf_geometry_same_way(&f->pool->geometry, own, plane);
    covers->covered[facet] = 1;
    covers->covers[covers->count++] =
        (enf_cover){facet, polygon, loop, opposite == arrangement->polygon_flipped[polygon]};
    return true;
}

static bool cover_facet(finder *f, int32_t facet) {
    switch (facet_overlap(f, facet)) {
    case NONE:
        return true;
    case WHOLE:
        return add_cover(f, facet, -1);
    case PART:
        break;
    }
    enf_pool *pool = f->pool;
    pool->corner_count = 0;
    int32_t crossings = pool->geometry.crossing_count;
    enf_loop loop = enf_facet_loop(f->space, facet, pool);
    for (int32_t i = 0; i < f->lines.count && !pool->failed; i++) {
        if (!enf_pool_keep(pool, &loop, f->lines.first_plane + i, -1)) {
            pool->geometry.crossing_count = crossings;
            return !pool->failed;
        }
    }
    return !pool->failed && enf_loops_append(&f->covers->loops, pool->corners + loop.first, loop.count) &&
           add_cover(f, facet, f->covers->loops.count - 1);
}

enum { WATCH_EVERY = 2048 };

static bool cover_hits(finder *f, const enf_crew *crew, bool *stopped) {
    const enf_arrangement *arrangement = f->arrangement;
    for (size_t i = 0; i < arrangement->hit_count; i++) {
        if (i % WATCH_EVERY == 0 && crew->watch &&
            !crew->watch(crew->user, (double)i / (double)arrangement->hit_count)) {
            *stopped = true;
            return false;
        }
        const enf_hit *hit = &arrangement->hits[i];
        if (i == 0 || hit->polygon != hit[-1].polygon || hit->lines != hit[-1].lines)
            enf_polygon_lines_take(&f->lines, arrangement, hit->polygon, hit->lines);
        int32_t source = source_index(f, hit->source);
        for (int32_t k = f->first[source]; k < f->first[source + 1]; k++) {
            if (!cover_facet(f, f->facets[k])) return false;
        }
    }
    return true;
}

bool enf_covers_find(enf_covers *covers, const enf_arrangement *arrangement, const enf_crew *crew,
                     enf_pool *pool, bool *stopped) {
    memset(covers, 0, sizeof *covers);
    *stopped = false;
    const enf_subdivision *space = &arrangement->subdivision;
    finder f = {.arrangement = arrangement, .space = space, .pool = pool, .covers = covers};
    covers->covered = enf_array_zeroed(space->facet_count, sizeof *covers->covered);
    size_t vertices = (size_t)pool->geometry.point_count + (size_t)pool->geometry.crossing_count;
    bool good = covers->covered && sort_facets(&f) && enf_polygon_lines_reserve(&f.lines, vertices) &&
                cover_hits(&f, crew, stopped);
    free(f.first);
    free(f.facets);
    enf_polygon_lines_free(&f.lines);
    return good;
}
