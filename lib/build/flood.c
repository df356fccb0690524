// SPDX-License-Identifier: GPL-3.0-or-later
// Most polygons of a finely drawn world are facets of the triangulation already, or tiled by a few: these are
// looked up. Others are flooded: the tetrahedra that a polygon's inside meets are connected through facets,
// so a walk from one of its edges that enters every neighbour it may meet finds them all, in time
// proportional to what it finds. Polygons go plane by plane, so that a point is held against each plane once.
#include "build/flood.h"

#include "base/array.h"
#include "base/exact.h"
#include "base/fetch.h"
#include "build/polygon_lines.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK = 512 }; ///< polygons a job

typedef struct found {
    int32_t tetrahedron;
    enf_candidate candidate;
} found;

/// A tetrahedron as the walk sees it, together in memory.
typedef struct place {
    int32_t corner[4];
    int32_t next[4]; ///< the tetrahedron beyond the facet opposite each corner, or -1
} place;

typedef struct flood_block {
    found *found;
    size_t count, capacity;
    enf_hit *hits;
    size_t hit_count, hit_capacity;
} flood_block;

typedef struct flooder {
    enf_geometry geometry; ///< for its counters
    enf_polygon_lines lines;
    int32_t rank, plane, plane_mark;
    enf_plane_filter filter;
    int32_t *stamp; ///< per tetrahedron: the last polygon + 1 that looked at it
    int32_t *stack;
    size_t stack_capacity;
    bool failed;
} flooder;

typedef struct flood {
    const enf_arrangement *arrangement;
    const int32_t *order; ///< polygons by plane
    place *places;        ///< per tetrahedron
    flood_block *blocks;
    int32_t block_count;
    flooder *flooders;
    enf_candidates *sorted; ///< what the blocks have found, by tetrahedron
    int32_t *hit_first;     ///< the arrangement's, while hits are sorted by facet
    enf_hit *hits;
} flood;

void enf_candidates_free(enf_candidates *candidates) {
    free(candidates->offset);
    free(candidates->candidates);
    free(candidates->order);
    memset(candidates, 0, sizeof *candidates);
}

static void add_hit(flooder *w, flood_block *block, int32_t facet, uint32_t lines) {
    if (!enf_array_reserve(block->hits, block->hit_capacity, block->hit_count + 1)) {
        w->failed = true;
        return;
    }
    block->hits[block->hit_count++] = (enf_hit){w->lines.polygon, facet, lines};
}

static void add_found(flooder *w, flood_block *block, int32_t t, uint32_t lines) {
    if (!enf_array_reserve(block->found, block->capacity, block->count + 1)) {
        w->failed = true;
        return;
    }
    block->found[block->count++] = (found){t, {w->rank, lines}};
}

// ---------------------------------------------------------------------------------------------- contacts

typedef enum contact {
    APART,   ///< the polygon's inside stays away
    TOUCHES, ///< it may meet the tetrahedron's boundary, not its inside
    COVERS,  ///< it may cover a facet
    ACROSS,  ///< it may go through
} contact;

/// A tetrahedron's corners held against the polygon; a bit each.
typedef struct stance {
    unsigned behind, front; ///< of its plane
    uint32_t inside[4];     ///< of its lines, strictly; see enf_line_sides
    uint32_t outside[4];
} stance;

static int side_of_plane(flooder *w, int32_t point) {
    int32_t *known = &w->lines.known[point].plane_sign; // plane_mark * 4 + sign + 1
    if (*known >> 2 == w->plane_mark) return (*known & 3) - 1;
    int sign = enf_geometry_side_by(&w->geometry, point, w->plane, &w->filter);
    *known = w->plane_mark * 4 + sign + 1;
    return sign;
}

/// Does the part of a face that is in the polygon's plane have something inside each of the polygon's lines?
/// The face has these corners: three of them, or all four for the whole tetrahedron.
static inline bool reaches(const flooder *w, const stance *at, unsigned corners) {
    unsigned behind = at->behind & corners, front = at->front & corners;
    if (behind == corners || front == corners) return false;
    unsigned in_plane = behind && front ? corners : corners & ~(behind | front);
    uint32_t inside = 0;
    for (int k = 0; k < 4; k++) inside |= at->inside[k] & -(uint32_t)(in_plane >> k & 1);
    return inside == w->lines.wanted;
}

/// How the polygon's inside meets a tetrahedron.
static contact meets(flooder *w, const int32_t corner[4], stance *at) {
    at->behind = at->front = 0;
    for (int k = 0; k < 4; k++) {
        int sign = side_of_plane(w, corner[k]);
        at->behind |= (unsigned)(sign < 0) << k;
        at->front |= (unsigned)(sign > 0) << k;
    }
    if (at->behind == 15 || at->front == 15) return APART;
    for (int k = 0; k < 4; k++) {
        const enf_line_sides *sides = enf_polygon_lines_at(&w->lines, &w->geometry, corner[k]);
        at->inside[k] = sides->inside;
        at->outside[k] = sides->outside;
    }
    if (!reaches(w, at, 15)) return APART;
    unsigned off = at->behind | at->front;
    return at->behind && at->front ? ACROSS : (off & (off - 1)) == 0 ? COVERS : TOUCHES;
}

/// The side of the facet opposite corner k on which a point lies: +1 outside of the tetrahedron.
static int side_of_facet(const flooder *w, const int32_t corner[4], int k, int32_t point) {
    static const int outside[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}; // the back is inside
    int32_t a = corner[outside[k][0]], b = corner[outside[k][1]], c = corner[outside[k][2]];
    if (point == a || point == b || point == c) return 0;
    const double *points = w->geometry.points;
    return enf_points_orient(points + 3 * (size_t)a, points + 3 * (size_t)b, points + 3 * (size_t)c,
                             points + 3 * (size_t)point);
}

/// Is a facet of the tetrahedron between it and the polygon, whose plane goes through it? Facets that stay on
/// one side of the plane do not bound what is between.
static bool facet_separates(const flooder *w, const int32_t corner[4], const stance *at) {
    for (int k = 0; k < 4; k++) {
        unsigned others = 15u & ~(1u << k);
        if ((at->behind & others) == others || (at->front & others) == others) continue;
        bool apart = true;
        for (int32_t i = 0; i < w->lines.count && apart; i++)
            apart = side_of_facet(w, corner, k, w->lines.corners[i]) >= 0;
        if (apart) return true;
    }
    return false;
}

// ---------------------------------------------------------------------------------------------- one polygon

/// How the polygon's inside meets a tetrahedron, which is taken down where that matters later.
static contact visit(flooder *w, flood_block *block, const enf_tet_mesh *tets, int32_t t, const place *here,
                     stance *at) {
    const int32_t *corner = here->corner;
    enf_fetch(tets->facets[t]);
    contact how = meets(w, corner, at);
    if (how == ACROSS) {
        uint32_t near = at->outside[0] | at->outside[1] | at->outside[2] | at->outside[3];
        if (near && facet_separates(w, corner, at)) return APART;
        add_found(w, block, t, near);
    } else if (how == COVERS) {
        int opposite = __builtin_ctz(at->behind | at->front);
        uint32_t near = 0;
        for (int k = 0; k < 4; k++) near |= k == opposite ? 0 : at->outside[k];
        // The tetrahedron on the other side is visited, too.
        if (here->next[opposite] < t) add_hit(w, block, tets->facets[t][opposite], near);
    }
    return how;
}

enum { WALK_MAX = 1000 }; ///< steps; Delaunay tetrahedra cannot lead round in circles, others might

/// A tetrahedron at the polygon's first corner that its first edge enters or touches there: while the edge's
/// end is beyond a facet at the corner, go through it. -1 if that does not end.
static int32_t walk_to_edge(const flooder *w, const enf_tet_mesh *tets, const place *places) {
    const int32_t from = w->lines.corners[0], to = w->lines.corners[1];
    int32_t t = tets->point_tetrahedron[from], before = -1;
    for (int step = 0; step < WALK_MAX; step++) {
        const place *here = &places[t];
        int k = 0;
        for (; k < 4; k++) {
            if (here->corner[k] == from || here->next[k] < 0 || here->next[k] == before) continue;
            if (side_of_facet(w, here->corner, k, to) > 0) break;
        }
        if (k == 4) return t;
        before = t;
        t = here->next[k];
    }
    return -1;
}

/// Makes room on the stack for a tetrahedron and its neighbours.
static bool reserve_stack(flooder *w, size_t depth) {
    if (!enf_array_reserve(w->stack, w->stack_capacity, depth + 4)) w->failed = true;
    return !w->failed;
}

/// Puts all tetrahedra on the stack in which the polygon may begin: those around its first edge, near its
/// first corner. Returns their number.
static size_t begin_polygon(flooder *w, const enf_tet_mesh *tets, const place *places) {
    const int32_t mark = w->lines.polygon + 1, from = w->lines.corners[0], to = w->lines.corners[1];
    int32_t first = walk_to_edge(w, tets, places);
    bool lost = first < 0; // then those around the corner
    size_t count = 0;
    if (!reserve_stack(w, count)) return 0;
    w->stack[count++] = lost ? tets->point_tetrahedron[from] : first;
    w->stamp[w->stack[0]] = mark;
    for (size_t i = 0; i < count && reserve_stack(w, count); i++) {
        const place *here = &places[w->stack[i]];
        for (int k = 0; k < 4; k++) {
            int32_t next = here->next[k];
            if (here->corner[k] == from || next < 0 || w->stamp[next] == mark) continue;
            if (!lost && side_of_facet(w, here->corner, k, to) != 0) continue;
            w->stamp[next] = mark;
            w->stack[count++] = next;
        }
    }
    return count;
}

/// Visits all tetrahedra that the polygon may meet.
static void flood_polygon(flooder *w, flood_block *block, const enf_tet_mesh *tets, const place *places) {
    const int32_t mark = w->lines.polygon + 1;
    size_t depth = begin_polygon(w, tets, places);
    while (depth > 0 && !w->failed) {
        int32_t t = w->stack[--depth];
        stance at = {0};
        const place *here = &places[t];
        if (visit(w, block, tets, t, here, &at) == APART) continue;
        if (!reserve_stack(w, depth)) return;
        for (int k = 0; k < 4; k++) {
            int32_t next = here->next[k];
            if (next < 0 || w->stamp[next] == mark || !reaches(w, &at, 15u & ~(1u << k))) continue;
            w->stamp[next] = mark;
            w->stack[depth++] = next;
        }
    }
}

static void take_polygon(flooder *w, flood_block *block, const flood *all, int32_t polygon) {
    const enf_arrangement *arrangement = all->arrangement;
    int32_t facets[ENF_TILING_CORNERS_MAX], plane = arrangement->polygon_plane[polygon];
    enf_polygon_lines_take(&w->lines, arrangement, polygon, 0);
    int tiling = enf_tet_mesh_tiling(&arrangement->tets, w->lines.corners, w->lines.count, facets);
    for (int i = 0; i < tiling; i++) add_hit(w, block, facets[i], 0); // it crosses nothing
    if (tiling) return;
    enf_polygon_lines_take(&w->lines, arrangement, polygon, UINT32_MAX);
    if (plane != w->plane) {
        w->plane = plane;
        w->plane_mark++;
        enf_plane_filter room;
        w->filter = *enf_geometry_filter(&w->geometry, plane, &room);
    }
    flood_polygon(w, block, &arrangement->tets, all->places);
}

// ---------------------------------------------------------------------------------------------- all of them

enum { FETCH_STEPS = 3, FETCH_AHEAD = 8 }; ///< so many polygons pass between two steps

/// Polygons come in the order of their planes; where they and their facets lie follows none.
static void fetch_polygons(const flood *all, size_t rank, size_t end) {
    const enf_mesh *mesh = all->arrangement->mesh;
    for (int step = 0; step < FETCH_STEPS; step++) {
        const size_t ahead = rank + (size_t)((FETCH_STEPS - step) * FETCH_AHEAD);
        if (ahead >= end) continue;
        const int32_t polygon = all->order[ahead];
        const int32_t *corners = mesh->corners + mesh->polygon_corner[polygon];
        const int64_t last = mesh->polygon_corner[polygon + 1] - mesh->polygon_corner[polygon] - 1;
        enf_tet_mesh_fetch_facet(&all->arrangement->tets, corners[0], corners[1], corners[last], step);
    }
}

static void flood_job(void *user, int32_t index, int thread) {
    flood *all = user;
    flooder *w = &all->flooders[thread];
    size_t end = ((size_t)index + 1) * BLOCK;
    if (end > all->arrangement->mesh->polygon_count) end = all->arrangement->mesh->polygon_count;
    flood_block block = {0}; // here: threads that write close to each other wait for each other
    for (size_t i = (size_t)index * BLOCK; i < end && !w->failed; i++) {
        fetch_polygons(all, i, end);
        take_polygon(w, &block, all, all->order[w->rank = (int32_t)i]);
    }
    all->blocks[index] = block;
}

/// Polygons sorted by plane (free() it), or null without memory.
static int32_t *sort_by_plane(const enf_arrangement *arrangement) {
    size_t count = arrangement->mesh->polygon_count;
    int32_t first = arrangement->tets.facet_count;
    size_t planes = (size_t)(arrangement->edge_plane_first - first);
    int32_t *order = enf_array_new(count, sizeof *order), *next = enf_array_zeroed(planes + 1, sizeof *next);
    if (!order || !next) {
        free(order);
        free(next);
        return NULL;
    }
    for (size_t p = 0; p < count; p++) next[arrangement->polygon_plane[p] - first + 1]++;
    for (size_t i = 0; i < planes; i++) next[i + 1] += next[i];
    for (size_t p = 0; p < count; p++) order[next[arrangement->polygon_plane[p] - first]++] = (int32_t)p;
    free(next);
    return order;
}

enum { PLACES = 1 << 14 }; ///< tetrahedra a job

static void make_places(void *user, int32_t block, int thread) {
    (void)thread;
    flood *all = user;
    const enf_tet_mesh *tets = &all->arrangement->tets;
    int32_t begin = block * PLACES, left = tets->count - begin, end = begin + (left < PLACES ? left : PLACES);
    for (int32_t t = begin; t < end; t++) {
        place *here = &all->places[t];
        memcpy(here->corner, tets->corners[t], sizeof here->corner);
        for (int k = 0; k < 4; k++) {
            const int32_t *sides = tets->facet_sides[tets->facets[t][k]];
            here->next[k] = sides[0] == t ? sides[1] : sides[0];
        }
    }
}

enum { SHARES = 8 }; ///< in which what was found is sorted

/// Puts what a share's tetrahedra have in order: that of the blocks.
static void sort_candidates(const flood *all, int32_t begin, int32_t end) {
    int32_t *first = all->sorted->offset, before = 0;
    memset(first + begin, 0, (size_t)(end - begin) * sizeof *first);
    for (int32_t b = 0; b < all->block_count; b++) {
        const flood_block *block = &all->blocks[b];
        for (size_t i = 0; i < block->count; i++) {
            int32_t t = block->found[i].tetrahedron;
            before += t < begin;
            if (t >= begin && t < end) first[t]++;
        }
    }
    for (int32_t t = begin; t < end; t++)
        first[t] = before += first[t]; // the end of its own; from there back
    for (int32_t b = all->block_count; b-- > 0;) {
        const flood_block *block = &all->blocks[b];
        for (size_t i = block->count; i-- > 0;) {
            int32_t t = block->found[i].tetrahedron;
            if (t >= begin && t < end) all->sorted->candidates[--first[t]] = block->found[i].candidate;
        }
    }
}

/// The same for facets and hits.
static void sort_hits(const flood *all, int32_t begin, int32_t end) {
    int32_t *first = all->hit_first, before = 0;
    memset(first + begin, 0, (size_t)(end - begin) * sizeof *first);
    for (int32_t b = 0; b < all->block_count; b++) {
        const flood_block *block = &all->blocks[b];
        for (size_t i = 0; i < block->hit_count; i++) {
            int32_t facet = block->hits[i].source;
            before += facet < begin;
            if (facet >= begin && facet < end) first[facet]++;
        }
    }
    for (int32_t f = begin; f < end; f++) first[f] = before += first[f];
    for (int32_t b = all->block_count; b-- > 0;) {
        const flood_block *block = &all->blocks[b];
        for (size_t i = block->hit_count; i-- > 0;) {
            int32_t facet = block->hits[i].source;
            if (facet >= begin && facet < end) all->hits[--first[facet]] = block->hits[i];
        }
    }
}

static int32_t share_begin(int32_t count, int32_t share) {
    return (int32_t)((int64_t)count * share / SHARES);
}

/// One share of the tetrahedra, and one of the facets.
static void sort_share(void *user, int32_t share, int thread) {
    (void)thread;
    const flood *all = user;
    const enf_tet_mesh *tets = &all->arrangement->tets;
    sort_hits(all, share_begin(tets->facet_count, share), share_begin(tets->facet_count, share + 1));
    sort_candidates(all, share_begin(tets->count, share), share_begin(tets->count, share + 1));
}

/// Candidates by tetrahedron and hits by facet. False without memory.
static bool sort_found(flood *all, enf_arrangement *arrangement, int threads) {
    const enf_crew crew = {.threads = threads};
    enf_candidates *candidates = all->sorted;
    size_t tets = (size_t)arrangement->tets.count, facets = (size_t)arrangement->tets.facet_count;
    size_t total = 0, hits = 0;
    for (int32_t b = 0; b < all->block_count; b++) {
        total += all->blocks[b].count;
        hits += all->blocks[b].hit_count;
    }
    if (total > INT32_MAX || hits > INT32_MAX) return false;
    candidates->offset = enf_array_new(tets + 1, sizeof *candidates->offset);
    candidates->candidates = enf_array_new(total, sizeof *candidates->candidates);
    all->hit_first = arrangement->hit_first = enf_array_new(facets + 1, sizeof *arrangement->hit_first);
    all->hits = arrangement->hits = enf_array_new(hits, sizeof *arrangement->hits);
    if (!candidates->offset || !candidates->candidates || !all->hit_first || !all->hits) return false;
    candidates->offset[tets] = (int32_t)total;
    all->hit_first[facets] = (int32_t)hits;
    enf_parallel_for(&crew, SHARES, sort_share, all);
    return true;
}

static bool start_flooder(flooder *w, const enf_arrangement *arrangement) {
    size_t points = arrangement->mesh->point_count;
    w->geometry = arrangement->geometry;
    memset(w->geometry.decided, 0, sizeof w->geometry.decided);
    w->plane = -1;
    w->stamp = enf_array_zeroed((size_t)arrangement->tets.count, sizeof *w->stamp);
    return w->stamp && enf_polygon_lines_reserve(&w->lines, points);
}

static void end_flooder(flooder *w, enf_arrangement *arrangement) {
    for (int i = 0; i < ENF_TIERS; i++) arrangement->geometry.decided[i] += w->geometry.decided[i];
    free(w->stamp);
    free(w->stack);
    enf_polygon_lines_free(&w->lines);
}

bool enf_candidates_find(enf_candidates *candidates, enf_arrangement *arrangement, const enf_crew *crew,
                         bool *stopped) {
    memset(candidates, 0, sizeof *candidates);
    *stopped = false;
    int threads = crew->threads;
    int32_t block_count = (int32_t)((arrangement->mesh->polygon_count + BLOCK - 1) / BLOCK);
    const int32_t *order = candidates->order = sort_by_plane(arrangement);
    flood all = {.arrangement = arrangement,
                 .order = order,
                 .block_count = block_count,
                 .sorted = candidates,
                 .places = enf_array_new((size_t)arrangement->tets.count, sizeof *all.places),
                 .blocks = enf_array_zeroed((size_t)block_count, sizeof *all.blocks),
                 .flooders = enf_array_zeroed((size_t)threads, sizeof *all.flooders)};
    bool good = order && all.places && all.blocks && all.flooders;
    for (int w = 0; good && w < threads; w++) good = start_flooder(&all.flooders[w], arrangement);
    if (good) {
        const enf_crew unwatched = {.threads = threads};
        enf_parallel_for(&unwatched, arrangement->tets.count / PLACES + 1, make_places, &all);
        *stopped = !enf_parallel_for(crew, block_count, flood_job, &all);
        for (int w = 0; w < threads; w++) good = good && !all.flooders[w].failed;
        good = good && !*stopped && sort_found(&all, arrangement, threads);
    }
    for (int w = 0; all.flooders && w < threads; w++) end_flooder(&all.flooders[w], arrangement);
    for (int32_t b = 0; all.blocks && b < block_count; b++) {
        free(all.blocks[b].found);
        free(all.blocks[b].hits);
    }
    free(all.blocks);
    free(all.flooders);
    free(all.places);
    return good;
}
