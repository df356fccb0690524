// SPDX-License-Identifier: GPL-3.0-or-later
// The split of the thesis (4.2.1) done exactly: each polygon cuts the cells that it really enters, and only
// those, by its plane; what is left of a tetrahedron is a small BSP tree (Fuchs, Kedem and Naylor 1980).
//
// A tetrahedron's tree of cuts leads each polygon to the cells that it may enter; whether the polygon's
// inside meets a cell's is decided in the plane, by the separating axis theorem for two convex polygons:
// flood.c has asked for the tetrahedron's facets, the tree for the cuts, and here it is the polygon's own
// lines.
#include "build/split.h"

#include "base/array.h"
#include "build/flood.h"
#include "build/parts.h"
#include "build/settle.h"
#include "build/still.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/// On which sides of a plane a polygon's corners lie: 1 some behind, 2 some in front.
typedef struct polygon_sides {
    int32_t polygon, plane, sides;
} polygon_sides;

enum { SIDES_KNOWN = 1024 }; ///< the last ones: two polygons meet in many cells, one after the other

/// What all threads share.
typedef struct splitting {
    enf_arrangement *arrangement;
    enf_candidates candidates;
    enf_parts parts;
    enf_yield *yields;      ///< per part
    uint8_t *reflex;        ///< see enf_joiner_start
    struct cutter *cutters; ///< per thread
    const enf_crew *crew;
    atomic_int cells_done; ///< for the watch
    atomic_bool stopped;
} splitting;

/// One thread's tools; they serve one part after the other.
typedef struct cutter {
    splitting *all;
    const enf_arrangement *arrangement;
    enf_tet_part part; ///< at hand
    enf_subdivision space;
    enf_settler settler;
    enf_polygon_lines lines;
    enf_hit *hits; ///< on the cuts of the cell at hand
    size_t hit_count, hit_capacity;
    int32_t *refs; ///< of the tree: nodes and cells
    enf_candidate *candidates;
    size_t candidate_capacity;
    size_t ref_capacity;
    int32_t *next; ///< per cell that was a tetrahedron: the next one of those that were joined to one cell
    size_t next_capacity;
    polygon_sides *known; ///< by a hash of polygon and plane
    bool watched;         ///< is the caller's own thread
    bool failed;          ///< out of memory
} cutter;

static void add_hit(cutter *c, int32_t source) {
    if (!enf_array_reserve(c->hits, c->hit_capacity, c->hit_count + 1)) {
        c->failed = true;
        return;
    }
    c->hits[c->hit_count++] = (enf_hit){c->lines.polygon, source, c->lines.wanted};
}

// ---------------------------------------------------------------------------------------------- one cell

/// The vertex where a cut edge meets the plane; false without memory.
static bool cut_vertex(cutter *c, size_t i, int32_t *vertex) {
    *vertex = enf_subdivision_cut_vertex(&c->space, i);
    if (*vertex < 0) c->failed = true;
    return *vertex >= 0;
}

/// The same as below for one line of a polygon with very many.
static bool line_lets_in(cutter *c, int32_t line) {
    enf_subdivision *space = &c->space;
    int32_t plane = c->lines.first_plane + line, vertex;
    for (size_t i = 0; i < space->cut_edge_count; i++) {
        if (!cut_vertex(c, i, &vertex)) return false;
        if (enf_geometry_side(&space->geometry, vertex, plane) < 0) return true;
    }
    for (size_t i = 0; i < space->touching_count; i++) {
        if (enf_geometry_side(&space->geometry, space->touching[i], plane) < 0) return true;
    }
    return false;
}

/// Does the polygon's inside meet the part of its plane that is in the cell, as far as the polygon's edges
/// tell? It does not if a line has no corner of that part strictly inside.
static bool lines_let_in(cutter *c) {
    enf_subdivision *space = &c->space;
    enf_geometry *geometry = &space->geometry;
    uint32_t wanted = c->lines.wanted, sure = 0, maybe = 0;
    size_t vertices =
        (size_t)geometry->point_count + (size_t)geometry->crossing_count + space->cut_edge_count;
    if (!enf_polygon_lines_reserve(&c->lines, vertices)) {
        c->failed = true;
        return false;
    }
    for (size_t i = 0; i < space->touching_count; i++)
        sure |= enf_polygon_lines_at(&c->lines, geometry, space->touching[i])->inside;
    for (size_t i = 0; i < space->cut_edge_count && wanted & ~sure; i++) {
        uint32_t from = enf_polygon_lines_at(&c->lines, geometry, space->cut_edges[i].from)->inside,
                 to = enf_polygon_lines_at(&c->lines, geometry, space->cut_edges[i].to)->inside;
        sure |= from & to;
        maybe |= from | to;
    }
    if (wanted & ~(sure | maybe)) return false;
    for (size_t i = 0; i < space->cut_edge_count && wanted & ~sure; i++) {
        const enf_cut_edge *cut = &space->cut_edges[i];
        int32_t vertex;
        if (!(wanted & ~sure & (c->lines.known[cut->from].inside | c->lines.known[cut->to].inside))) continue;
        if (!cut_vertex(c, i, &vertex)) return false;
        sure |= enf_polygon_lines_at(&c->lines, geometry, vertex)->inside;
    }
    if (wanted & ~sure) return false;
    for (int32_t i = ENF_LINES_FEW; i < c->lines.count; i++) {
        if (!line_lets_in(c, i)) return false;
    }
    return true;
}

static void leave_cell(cutter *c) {
    for (size_t i = 0; i < c->space.cut_edge_count; i++) {
        int32_t vertex = c->space.cut_edges[i].vertex;
        if (vertex >= 0 && (size_t)vertex < c->lines.known_capacity)
            enf_polygon_lines_forget(&c->lines, vertex);
    }
    enf_subdivision_leave(&c->space);
}

static void cut_cell(cutter *c, int32_t cell) {
    int crosses = enf_subdivision_crosses(&c->space, cell);
    if (crosses < 0) c->failed = true;
    if (crosses <= 0) return;
    bool near = c->lines.wanted || c->lines.count > ENF_LINES_FEW;
    if (near && !lines_let_in(c)) {
        leave_cell(c);
        return;
    }
    int32_t node = enf_subdivision_cut(&c->space, cell);
    if (node < 0) {
        c->failed = true;
    } else {
        add_hit(c, -1 - node);
    }
}

// ---------------------------------------------------------------------------------------------- one
// tetrahedron

static int corner_sides(cutter *c, int32_t plane) {
    uint32_t hash = (uint32_t)c->lines.polygon * UINT32_C(0x9E3779B1) + (uint32_t)plane;
    polygon_sides *known = &c->known[(hash ^ hash >> 16) % SIDES_KNOWN];
    if (known->polygon == c->lines.polygon && known->plane == plane) return known->sides;
    int sides = 0;
    for (int32_t i = 0; i < c->lines.count && sides != 3; i++) {
        int side = enf_geometry_side(&c->space.geometry, c->lines.corners[i], plane);
        sides |= side < 0 ? 1 : side > 0 ? 2 : 0;
    }
    *known = (polygon_sides){c->lines.polygon, plane, sides};
    return sides;
}

/// Down the tree of cuts to the cells that the polygon may enter.
static void cut_tetrahedron(cutter *c, int32_t t) {
    enf_subdivision *space = &c->space;
    size_t depth = 0;
    if (!enf_array_reserve(c->refs, c->ref_capacity, 1)) c->failed = true;
    if (!c->failed) c->refs[depth++] = space->tetrahedron_root[t];
    while (depth > 0 && !c->failed) {
        int32_t ref = c->refs[--depth];
        if (ref < 0) {
            cut_cell(c, -1 - ref);
            continue;
        }
        int32_t plane = space->node_plane[ref];
        int sides = plane == space->plane ? 0 : corner_sides(c, plane);
        if (sides == 0) add_hit(c, -1 - ref);
        if (!enf_array_reserve(c->refs, c->ref_capacity, depth + 2)) {
            c->failed = true;
            return;
        }
        for (int k = 1; k >= 0; k--) {
            if (sides & (1 << k)) c->refs[depth++] = space->node_child[ref][k];
        }
    }
}

// ---------------------------------------------------------------------------------------------- one part

/// Tetrahedra are joined first where that makes a convex cell: a polygon then cuts one cell, not several.
static void join_tetrahedra(cutter *c) {
    enf_subdivision *space = &c->space;
    const int32_t *first = c->arrangement->hit_first; // facets that polygons lie on stay
    const uint8_t *reflex = c->settler.joiner.reflex; // none of these is cut: each has all its edges
    size_t count = space->facet_count;
    for (size_t f = 0; f < count; f++) {
        enf_share *facet = &space->facets[f];
        facet->cover = facet->first >= 0 && first[facet->source] < first[facet->source + 1] ? 0 : -1;
    }
    for (size_t f = count; f-- > 0;) {
        const enf_share *facet = &space->facets[f];
        if (facet->first >= 0 && facet->cell[0] >= 0 && facet->cell[1] >= 0 && !reflex[facet->source])
            enf_joiner_try(&c->settler.joiner, space, (int32_t)f);
    }
    for (size_t f = 0; f < count; f++) space->facets[f].cover = -1; // the polygons come when all is cut
}

static int compare_ranks(const void *a, const void *b) {
    const enf_candidate *x = a, *y = b;
    return (x->rank > y->rank) - (x->rank < y->rank);
}

enum { INSERT_MAX = 48 }; ///< candidates that are sorted by insertion: a few runs that are in order already

static void sort_candidates(enf_candidate *candidates, size_t count) {
    if (count > INSERT_MAX) {
        qsort(candidates, count, sizeof *candidates, compare_ranks);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        enf_candidate one = candidates[i];
        size_t k = i;
        for (; k > 0 && candidates[k - 1].rank > one.rank; k--) candidates[k] = candidates[k - 1];
        candidates[k] = one;
    }
}

/// The candidates of the tetrahedra in a cell, each once.
static size_t gather(cutter *c, int32_t cell) {
    const enf_candidates *all = &c->all->candidates;
    size_t count = 0, kept = 0, members = 0;
    for (int32_t m = cell; m >= 0; m = c->next[m]) {
        int32_t t = c->part.tetrahedra[m];
        size_t more = (size_t)(all->offset[t + 1] - all->offset[t]);
        if (!enf_array_reserve(c->candidates, c->candidate_capacity, count + more)) {
            c->failed = true;
            return 0;
        }
        memcpy(c->candidates + count, all->candidates + all->offset[t], more * sizeof *c->candidates);
        count += more;
        members++;
    }
    if (members == 1) return count;
    sort_candidates(c->candidates, count);
    for (size_t i = 0, end; i < count; i = end) {
        enf_candidate one = c->candidates[i];
        for (end = i + 1; end < count && c->candidates[end].rank == one.rank; end++)
            one.lines |= c->candidates[end].lines;
        if (end - i < members) one.lines = UINT32_MAX; // see narrow_lines
        c->candidates[kept++] = one;
    }
    return kept;
}

/// The tetrahedra of each cell as lists, from the one that gave the cell its number. False without memory.
static bool list_members(cutter *c) {
    int32_t count = c->part.tetrahedron_count;
    if (!enf_array_reserve(c->next, c->next_capacity, (size_t)count)) return false;
    for (int32_t m = 0; m < count; m++) c->next[m] = -1;
    for (int32_t m = count - 1; m >= 0; m--) {
        int32_t into = enf_joiner_find(&c->settler.joiner, m);
        if (into == m) continue;
        c->next[m] = c->next[into];
        c->next[into] = m;
    }
    return true;
}

enum {
    WEIGHED_MAX = 24
}; ///< candidates that are put in order by what they split; more stay in that of planes

/// Puts first the polygons whose planes split the fewest of the others; equals stay as they are.
static void weigh_candidates(cutter *c, size_t count) {
    const enf_arrangement *arrangement = c->arrangement;
    const int32_t *order = c->all->candidates.order;
    int splits[WEIGHED_MAX];
    if (count < 3 || count > WEIGHED_MAX) return; // of two that cross, either order makes four cells of one
    for (size_t i = 0; i < count; i++) {
        int32_t plane = arrangement->polygon_plane[order[c->candidates[i].rank]];
        splits[i] = 0;
        for (size_t k = 0; k < count; k++) {
            int32_t other = order[c->candidates[k].rank];
            if (arrangement->polygon_plane[other] == plane) continue;
            enf_polygon_lines_take(&c->lines, arrangement, other, 0);
            splits[i] += corner_sides(c, plane) == 3;
        }
    }
    for (size_t i = 1; i < count; i++) {
        enf_candidate one = c->candidates[i];
        int split = splits[i];
        size_t k = i;
        for (; k > 0 && splits[k - 1] > split; k--) {
            c->candidates[k] = c->candidates[k - 1];
            splits[k] = splits[k - 1];
        }
        c->candidates[k] = one;
        splits[k] = split;
    }
}

/// Where the polygon stays out of some tetrahedra of the cell, nothing is known of its lines there: wants
/// only those that have a corner of the cell outside.
static void narrow_lines(cutter *c, int32_t cell) {
    uint32_t outside = 0;
    for (int32_t m = cell; m >= 0 && outside != c->lines.wanted; m = c->next[m]) {
        for (int k = 0; k < 4; k++) {
            int32_t point = c->arrangement->tets.corners[c->part.tetrahedra[m]][k];
            outside |= enf_polygon_lines_at(&c->lines, &c->space.geometry, point)->outside;
        }
    }
    c->lines.wanted = outside;
}

/// Cuts one cell by all its candidates, and settles what came of it.
static void cut_by_all(cutter *c, size_t count, int32_t cell) {
    enf_subdivision *space = &c->space;
    enf_cut_cell cut = {
        .cell = cell, .first_cell = (int32_t)space->cell_count, .first_node = (int32_t)space->node_count};
    space->plane = -1;
    space->joined = c->next[cell] >= 0;
    c->hit_count = 0;
    weigh_candidates(c, count);
    for (size_t i = 0; i < count && !c->failed; i++) {
        int32_t polygon = c->all->candidates.order[c->candidates[i].rank];
        int32_t plane = c->arrangement->polygon_plane[polygon];
        if (plane != space->plane) enf_subdivision_take_plane(space, plane);
        enf_polygon_lines_take(&c->lines, c->arrangement, polygon, c->candidates[i].lines);
        if (c->candidates[i].lines == UINT32_MAX) narrow_lines(c, cell);
        cut_tetrahedron(c, cell);
    }
    cut.hits = c->hits;
    cut.hit_count = c->hit_count;
    if (!c->failed && !enf_settler_settle(&c->settler, &cut)) c->failed = true;
}

enum { WATCH_EVERY = 64 }; ///< cells

/// Tells the watch how far all threads are, before the next cells. False if it says stop.
static bool go_on(cutter *c) {
    splitting *all = c->all;
    const enf_crew *crew = all->crew;
    int done = atomic_fetch_add(&all->cells_done, WATCH_EVERY);
    if (c->watched && crew->watch) {
        double share = (double)done / (1.0 + all->parts.tetrahedron_first[all->parts.count]);
        if (!crew->watch(crew->user, share < 1 ? share : 1)) atomic_store(&all->stopped, true);
    }
    return !atomic_load(&all->stopped);
}

/// All cells of the part in turn.
static void cut_cells(cutter *c) {
    int32_t count = c->part.tetrahedron_count;
    for (int32_t m = 0; m < count && !c->failed; m++) {
        if (m % WATCH_EVERY == 0 && !go_on(c)) return;
        if (enf_joiner_find(&c->settler.joiner, m) != m) continue; // went into another
        size_t polygons = gather(c, m);
        if (!c->failed) cut_by_all(c, polygons, m);
    }
    for (int32_t m = 0; m < count && !c->failed; m++) {
        for (int32_t k = c->next[m]; k >= 0 && c->space.tetrahedron_root[m] >= 0; k = c->next[k])
            c->space.tetrahedron_root[k] = c->space.tetrahedron_root[m];
    }
}

/// What the joiner knows, and the subdivision's trees and vertices, become the part's.
static bool finish_part(cutter *c, enf_yield *yield) {
    enf_joiner *joiner = &c->settler.joiner;
    for (size_t cell = 0; cell < c->space.cell_count; cell++) enf_joiner_find(joiner, (int32_t)cell);
    int32_t *into = joiner->into;
    joiner->into = NULL;
    joiner->capacity = 0;
    yield->complex.cells_joined = joiner->count;
    enf_subdivision_forget_facets(&c->space); // what the yield takes needs room
    return enf_yield_finish(yield, &c->space, into);
}

static void cut_part(void *user, int32_t index, int thread) {
    splitting *all = user;
    cutter *c = &all->cutters[thread];
    enf_yield *yield = &all->yields[index];
    c->part = enf_parts_at(&all->parts, index);
    bool good = !c->failed &&
                enf_subdivision_start(&c->space, &all->arrangement->geometry, &all->arrangement->tets,
                                      &c->part, all->parts.cuts[index]) &&
                enf_polygon_lines_reserve(&c->lines, all->arrangement->mesh->point_count) &&
                enf_settler_start(&c->settler, all->arrangement, &c->space, yield, &c->lines, all->reflex) &&
                enf_settler_settle_still(&c->settler);
    if (good) {
        if (c->settler.join) join_tetrahedra(c);
        good = list_members(c);
    }
    if (good) cut_cells(c);
    if (!good || c->failed || (!atomic_load(&all->stopped) && !finish_part(c, yield))) c->failed = true;
}

// ---------------------------------------------------------------------------------------------- all of them

#define FLOOD_SHARE 0.3 ///< of the stage's time, about: only the progress bar sees it

/// The watch sees one stage where there are two.
typedef struct half_watch {
    const enf_crew *crew;
    double begun, share;
} half_watch;

static bool watch_half(void *user, double fraction) {
    const half_watch *half = user;
    return !half->crew->watch || half->crew->watch(half->crew->user, half->begun + half->share * fraction);
}

static bool start_cutter(cutter *c, splitting *all, bool watched) {
    c->all = all;
    c->arrangement = all->arrangement;
    c->watched = watched;
    c->known =
        enf_array_zeroed(SIDES_KNOWN, sizeof *c->known); // no polygon lies in plane 0: that is a facet's
    return c->known;
}

static void free_cutter(cutter *c) {
    enf_settler_free(&c->settler);
    enf_subdivision_free(&c->space);
    enf_polygon_lines_free(&c->lines);
    free(c->known);
    free(c->refs);
    free(c->candidates);
    free(c->hits);
    free(c->next);
}

/// All parts, on all threads. False without memory or when stopped.
static bool cut_parts(splitting *all) {
    int32_t count = all->parts.count;
    int threads = all->crew->threads < count ? all->crew->threads : count;
    all->cutters = enf_array_zeroed((size_t)threads, sizeof *all->cutters);
    all->reflex = enf_array_zeroed((size_t)all->arrangement->tets.facet_count, sizeof *all->reflex);
    bool good = all->cutters && all->reflex;
    for (int i = 0; good && i < threads; i++) good = start_cutter(&all->cutters[i], all, i == 0);
    if (good) {
        enf_crew unwatched = {.threads = threads}; // the cutters ask the watch themselves
        enf_parallel_for(&unwatched, count, cut_part, all);
        for (int i = 0; i < threads; i++) good = good && !all->cutters[i].failed;
    }
    for (int i = 0; all->cutters && i < threads; i++) free_cutter(&all->cutters[i]);
    free(all->cutters);
    free(all->reflex);
    return good && !atomic_load(&all->stopped);
}

/// The stage's second half, when the candidates are known.
static bool split_parts(splitting *all, enf_complex *complex) {
    if (!enf_parts_make(&all->parts, all->arrangement, &all->candidates, all->crew->threads)) return false;
    all->yields = enf_array_zeroed((size_t)all->parts.count, sizeof *all->yields);
    bool good =
        all->yields && enf_still_emit(&all->yields[0], all->arrangement, &all->parts, all->crew->threads);
    good = good && cut_parts(all);
    enf_candidates_free(&all->candidates);
    good = good && enf_yields_gather(all->yields, &all->parts, all->crew, all->arrangement, complex);
    for (int32_t i = 0; all->yields && i < all->parts.count; i++) enf_yield_free(&all->yields[i]);
    free(all->yields);
    return good;
}

enf_status enf_complex_split(enf_complex *complex, enf_arrangement *arrangement, const enf_crew *crew,
                             enf_error *error) {
    memset(complex, 0, sizeof *complex);
    splitting all = {.arrangement = arrangement};
    half_watch half = {.crew = crew, .share = FLOOD_SHARE};
    const enf_crew watched = {.threads = crew->threads, .watch = watch_half, .user = &half};
    all.crew = &watched;
    bool stopped, good = enf_candidates_find(&all.candidates, arrangement, &watched, &stopped);
    enf_tet_mesh_unlist(&arrangement->tets);
    half = (half_watch){.crew = crew, .begun = FLOOD_SHARE, .share = 1 - FLOOD_SHARE};
    good = good && split_parts(&all, complex);
    stopped = stopped || atomic_load(&all.stopped);
    enf_candidates_free(&all.candidates);
    enf_parts_free(&all.parts);
    if (stopped) return enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    return good ? ENF_OK : enf_fail_memory(error, "the fine cells");
}
