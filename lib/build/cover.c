// SPDX-License-Identifier: GPL-3.0-or-later
// Where polygons of a closed world meet, their planes have cut the cells, so most facets lie wholly inside or
// wholly outside of a polygon: that takes the sides of their corners only. The others are clipped, in the
// plane.
#include "build/cover.h"

#include "base/array.h"

typedef enum overlap { NONE, PART, WHOLE } overlap;

/// What one line of a polygon with very many says of a facet.
static overlap line_overlap(enf_settler *s, int32_t first, int32_t line) {
    bool inside = false, outside = false;
    int32_t h = first;
    do {
        int side =
            enf_geometry_side(&s->space->geometry, s->space->halves[h].vertex, s->lines->first_plane + line);
        inside |= side < 0;
        outside |= side > 0;
        h = s->space->halves[h].next;
    } while (h != first);
    return !inside ? NONE : outside ? PART : WHOLE;
}

/// What the polygon's lines say of a facet in its plane: PART may still turn out to be nothing.
static overlap facet_overlap(enf_settler *s, int32_t facet) {
    const enf_half *halves = s->space->halves;
    int32_t first = s->space->facets[facet].first, h = first;
    uint32_t inside = 0, outside = 0;
    overlap result = WHOLE;
    if (s->lines->wanted) {
        do {
            const enf_line_sides *sides =
                enf_polygon_lines_at(s->lines, &s->space->geometry, halves[h].vertex);
            inside |= sides->inside;
            outside |= sides->outside;
            h = halves[h].next;
        } while (h != first);
        if (inside != s->lines->wanted) return NONE;
        if (outside) result = PART;
    }
    for (int32_t i = ENF_LINES_FEW; i < s->lines->count; i++) {
        overlap line = line_overlap(s, first, i);
        if (line == NONE) return NONE;
        if (line == PART) result = PART;
    }
    return result;
}

static bool add_cover(enf_settler *s, int32_t facet, int32_t loop) {
    const enf_arrangement *arrangement = s->arrangement;
    int32_t added = s->free_cover, polygon = s->lines->polygon;
    if (added >= 0) {
        s->free_cover = s->covers[added].next;
    } else {
        if (!enf_array_reserve(s->covers, s->cover_capacity, s->cover_count + 1)) return false;
        added = (int32_t)s->cover_count++;
    }
    int32_t plane = enf_subdivision_plane(s->space, facet), own = arrangement->polygon_plane[polygon];
    bool opposite = own != plane && !enf_geometry_same_way(&s->space->geometry, own, plane);
    s->covers[added] = (enf_cover){polygon, loop, opposite == arrangement->polygon_flipped[polygon], -1};
    int32_t *link = &s->space->facets[facet].cover;
    while (*link >= 0) link = &s->covers[*link].next;
    *link = added;
    return true;
}

/// The part of the facet inside the polygon's lines; *some is false if there is none.
static bool clip_facet(enf_settler *s, int32_t facet, bool *some) {
    enf_pool *pool = &s->pool;
    int32_t crossings = pool->geometry.crossing_count;
    pool->corner_count = 0;
    enf_loop loop = enf_facet_loop(s->space, facet, pool);
    *some = true;
    for (int32_t i = 0; i < s->lines->count && *some && !pool->failed; i++)
        *some = enf_pool_keep(pool, &loop, s->lines->first_plane + i, -1);
    if (!*some) pool->geometry.crossing_count = crossings;
    return !pool->failed && (!*some || enf_loops_append(&s->loops, pool->corners + loop.first, loop.count));
}

bool enf_cover_facet(enf_settler *s, int32_t facet) {
    switch (facet_overlap(s, facet)) {
    case NONE:
        return true;
    case WHOLE:
        return add_cover(s, facet, -1);
    case PART:
        break;
    }
    bool some, good;
    s->pool.geometry = s->space->geometry;
    good = clip_facet(s, facet, &some);
    s->space->geometry = s->pool.geometry;
    return good && (!some || add_cover(s, facet, s->loops.count - 1));
}
