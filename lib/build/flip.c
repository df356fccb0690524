// SPDX-License-Identifier: GPL-3.0-or-later
// B. Joe, "Three-dimensional triangulations from local transformations" (1989). Which diagonal of a
// quadrangle the Delaunay triangulation has is chance where its corners lie on a circle, or nearly so, as
// those of surfaces of revolution do; and where they lie in a plane but for rounding, a polygon with the
// other diagonal cuts all tetrahedra there into slivers. An edge of a polygon that lies in the two tetrahedra
// beside a facet is made an edge of them:
//
//   4-4  if the four tetrahedra around an edge of the facet, which it passes closely, can be laid around it
//   2-3  or else by putting three tetrahedra around it in the place of the two
//
// Where the other diagonal crosses it exactly, the polygon lies in the planes of facets and cuts nothing.
#include "build/flip.h"

#include "base/array.h"
#include "base/exact.h"

#include <stdlib.h>
#include <string.h>

enum { WALK_MAX = 1000 };           ///< steps
enum { INVOLVED = 4, FACETS = 16 }; ///< tetrahedra of a flip, and their facets, at most

/// The polygons' edges by their lower end; those of two polygons come twice, and the first counts.
typedef struct edge_list {
    uint32_t *begin; ///< per point, and one more
    int32_t *high;   ///< the other end
    bool *done;      ///< it is one of the tetrahedra's, or goes along one
} edge_list;

typedef struct flipper {
    enf_tet_mesh *tets;
    const double *points;
    edge_list wanted;
    size_t corner_capacity, facet_capacity, facet_corner_capacity, side_capacity;
    int32_t *turned; ///< facets that have been given other corners
    size_t turned_count, turned_capacity;
    int32_t flips;
} flipper;

/// Where an edge that begins at a corner of a tetrahedron goes through the facet opposite.
typedef struct passage {
    int32_t t;
    int first; ///< the corner
} passage;

static int32_t beyond(const enf_tet_mesh *tets, int32_t t, int k) {
    const int32_t *sides = tets->facet_sides[tets->facets[t][k]];
    return sides[0] == t ? sides[1] : sides[0];
}

static int place_of(const int32_t corner[4], int32_t point) {
    unsigned places = (unsigned)(corner[0] == point) | (unsigned)(corner[1] == point) << 1 |
                      (unsigned)(corner[2] == point) << 2 | (unsigned)(corner[3] == point) << 3 | 1u << 4;
    return __builtin_ctz(places);
}

/// The orientation of a tetrahedron with another point at one corner.
static int turn_with(const flipper *f, const int32_t corner[4], int k, int32_t point) {
    const double *at[4];
    for (int i = 0; i < 4; i++) at[i] = f->points + 3 * (size_t)(i == k ? point : corner[i]);
    return enf_points_orient(at[0], at[1], at[2], at[3]);
}

/// Walks around the first point to the tetrahedron that the edge enters. False if it enters none: it is there
/// already, or leads along an edge or a facet.
static bool find_passage(const flipper *f, int32_t from, int32_t to, passage *at) {
    const enf_tet_mesh *tets = f->tets;
    int32_t t = tets->point_tetrahedron[from], before = -1;
    for (int step = 0; step < WALK_MAX; step++) {
        const int32_t *corner = tets->corners[t];
        int32_t next = -1;
        int first = place_of(corner, from);
        bool inside = true;
        if (place_of(corner, to) < 4) return false;
        for (int k = 0; k < 4 && next < 0; k++) {
            int32_t other = k == first ? -1 : beyond(tets, t, k);
            if (k == first || (other >= 0 && other == before)) continue; // it came from there
            int side = turn_with(f, corner, k, to);
            inside &= side > 0;
            if (side < 0) next = other;
        }
        if (next < 0) {
            *at = (passage){t, first};
            return inside;
        }
        before = t;
        t = next;
    }
    return false;
}

// ---------------------------------------------------------------------------------------------- wanted edges

static bool list_edges(edge_list *list, const enf_mesh *mesh) {
    uint32_t *begin = list->begin = enf_array_zeroed(mesh->point_count + 2, sizeof *begin);
    size_t corners = (size_t)mesh->polygon_corner[mesh->polygon_count];
    list->high = enf_array_new(corners, sizeof *list->high);
    list->done = enf_array_zeroed(corners, sizeof *list->done);
    if (!list->begin || !list->high || !list->done) return false;
    for (int pass = 0; pass < 2; pass++) { // count, and fill
        for (size_t p = 0; p < mesh->polygon_count; p++) {
            int64_t first = mesh->polygon_corner[p], end = mesh->polygon_corner[p + 1];
            for (int64_t c = first, before = end - 1; c < end; before = c++) {
                int32_t a = mesh->corners[before], b = mesh->corners[c], low = a < b ? a : b;
                if (pass == 0) begin[low + 2]++;
                if (pass == 1) list->high[begin[low + 1]++] = a < b ? b : a;
            }
        }
        for (size_t i = 1; pass == 0 && i <= mesh->point_count; i++) begin[i + 1] += begin[i];
    }
    return true;
}

static void free_edges(edge_list *list) {
    free(list->begin);
    free(list->high);
    free(list->done);
}

/// The number of a polygon's edge, or -1.
static int64_t find_edge(const edge_list *list, int32_t a, int32_t b) {
    int32_t low = a < b ? a : b, high = a < b ? b : a;
    for (uint32_t i = list->begin[low]; i < list->begin[low + 1]; i++) {
        if (list->high[i] == high) return i;
    }
    return -1;
}

static bool is_wanted(const flipper *f, int32_t a, int32_t b) {
    return find_edge(&f->wanted, a, b) >= 0;
}

// ---------------------------------------------------------------------------------------------- replacing

/// Tetrahedra, and what takes their place.
typedef struct patch {
    int32_t old[INVOLVED], corners[INVOLVED][4];
    int old_count, count;
} patch;

/// Facets of a flip, by their corners.
typedef struct facet_list {
    int32_t facet[FACETS];
    int count;
} facet_list;

/// A tetrahedron with another point at one corner, which must leave it positively oriented.
static void put_new(const flipper *f, patch *p, int32_t t, int32_t replaced, int32_t point) {
    int32_t *corner = p->corners[p->count++];
    memcpy(corner, f->tets->corners[t], sizeof p->corners[0]);
    corner[place_of(corner, replaced)] = point;
}

static bool is_old(const patch *p, int32_t t) {
    bool old = false;
    for (int i = 0; i < p->old_count; i++) old |= p->old[i] == t;
    return old;
}

/// Facets of the old tetrahedra: those around the patch, and those that go, each once.
static void list_facets(const flipper *f, const patch *p, facet_list *around, facet_list *within) {
    const enf_tet_mesh *tets = f->tets;
    around->count = within->count = 0;
    for (int i = 0; i < p->old_count; i++) {
        for (int k = 0; k < 4; k++) {
            int32_t facet = tets->facets[p->old[i]][k];
            const int32_t *sides = tets->facet_sides[facet];
            if (!is_old(p, sides[0]) | !is_old(p, sides[1])) {
                around->facet[around->count++] = facet;
            } else if (sides[0] == p->old[i]) {
                within->facet[within->count++] = facet;
            }
        }
    }
}

/// The facet with these corners among those around the patch and the new ones, or -1.
static int32_t find_facet(const flipper *f, const facet_list *known, const int32_t face[3]) {
    for (int i = 0; i < known->count; i++) {
        const int32_t *corner = f->tets->facet_corners[known->facet[i]];
        if (((corner[0] ^ face[0]) | (corner[1] ^ face[1]) | (corner[2] ^ face[2])) == 0)
            return known->facet[i];
    }
    return -1;
}

static bool reserve(flipper *f) {
    enf_tet_mesh *tets = f->tets;
    size_t count = (size_t)tets->count + INVOLVED, facets = (size_t)tets->facet_count + FACETS;
    return enf_array_reserve(tets->corners, f->corner_capacity, count) &&
           enf_array_reserve(tets->facets, f->facet_capacity, count) &&
           enf_array_reserve(tets->facet_corners, f->facet_corner_capacity, facets) &&
           enf_array_reserve(tets->facet_sides, f->side_capacity, facets) &&
           enf_array_reserve(f->turned, f->turned_capacity, f->turned_count + FACETS);
}

/// Puts the new tetrahedra in the place of the old ones; numbers of the latter, and of facets that go, are
/// used again. False without memory.
static bool replace(flipper *f, const patch *p) {
    enf_tet_mesh *tets = f->tets;
    facet_list known, within;
    if (!reserve(f)) return false;
    list_facets(f, p, &known, &within);
    for (int i = 0; i < p->count; i++) {
        int32_t t = i < p->old_count ? p->old[i] : tets->count++;
        memcpy(tets->corners[t], p->corners[i], sizeof *tets->corners);
        for (int k = 0; k < 4; k++) {
            int32_t face[3];
            int side = enf_tetrahedron_face(p->corners[i], k, face);
            int32_t facet = find_facet(f, &known, face);
            if (facet < 0) {
                facet = within.count > 0 ? within.facet[--within.count] : tets->facet_count++;
                memcpy(tets->facet_corners[facet], face, sizeof face);
                known.facet[known.count++] = f->turned[f->turned_count++] = facet;
            }
            tets->facet_sides[facet][side] = t;
            tets->facets[t][k] = facet;
            tets->point_tetrahedron[p->corners[i][k]] = t;
        }
    }
    f->flips++;
    return true;
}

// ---------------------------------------------------------------------------------------------- flips

/// The corner of t, and of the one beyond its facet k, that is not the other's.
static int32_t apex_beyond(const enf_tet_mesh *tets, int32_t t, int k, int32_t *other) {
    *other = beyond(tets, t, k);
    if (*other < 0) return -1;
    for (int i = 0; i < 4; i++) {
        if (tets->facets[*other][i] == tets->facets[t][k]) return tets->corners[*other][i];
    }
    return -1;
}

/// Lays the four tetrahedra around an edge, the one opposite corners `first` and `third` of t, around the
/// edge to `to` instead, which is a corner of the one beyond corner `first`. *done is false if that cannot
/// be. False without memory.
static bool flip_edge(flipper *f, const passage *at, int third, int32_t to, bool *done) {
    const enf_tet_mesh *tets = f->tets;
    const int32_t *corner = tets->corners[at->t];
    int32_t upper, lower[2], ends[2];
    int count = 0;
    *done = false;
    for (int k = 0; k < 4; k++) {
        if (k != at->first && k != third) ends[count++] = corner[k];
    }
    if (is_wanted(f, ends[0], ends[1])) return true;
    apex_beyond(tets, at->t, at->first, &upper);
    int32_t apex = apex_beyond(tets, at->t, third, &lower[0]);
    if (apex < 0 ||
        apex != apex_beyond(tets, upper, place_of(tets->corners[upper], corner[third]), &lower[1]))
        return true;
    const int32_t *below = tets->corners[lower[0]];
    for (int i = 0; i < 2; i++) {
        if (turn_with(f, below, place_of(below, ends[i]), to) <= 0) return true;
    }
    patch p = {.old = {at->t, upper, lower[0], lower[1]}, .old_count = 4};
    for (int i = 0; i < 2; i++) {
        put_new(f, &p, at->t, ends[i], to);
        put_new(f, &p, lower[0], ends[i], to);
    }
    *done = true;
    return replace(f, &p);
}

/// Has the facet opposite the corner a polygon's edge on each side? Then it may be a polygon.
static bool is_wanted_facet(flipper *f, const int32_t corner[4], int opposite) {
    int32_t a = corner[(opposite + 1) & 3], b = corner[(opposite + 2) & 3], c = corner[(opposite + 3) & 3];
    return is_wanted(f, a, b) && is_wanted(f, b, c) && is_wanted(f, c, a);
}

/// Three tetrahedra around the new edge in place of the two that it goes through. False without memory.
static bool flip_facet(flipper *f, const passage *at, int32_t to) {
    const int32_t *corner = f->tets->corners[at->t];
    int32_t upper;
    if (is_wanted_facet(f, corner, at->first)) return true;
    apex_beyond(f->tets, at->t, at->first, &upper);
    patch p = {.old = {at->t, upper}, .old_count = 2};
    for (int k = 0; k < 4; k++) {
        if (k != at->first) put_new(f, &p, at->t, corner[k], to);
    }
    return replace(f, &p);
}

/// Is the way from the first corner to a point beyond the facet opposite inside the facet?
static bool goes_through(const flipper *f, const passage *at, int32_t to) {
    const int32_t *corner = f->tets->corners[at->t];
    for (int k = 0; k < 4; k++) {
        if (k != at->first && turn_with(f, corner, k, to) <= 0) return false;
    }
    return true;
}

/// Is the point a corner of a tetrahedron beside this one?
static bool is_beside(const enf_tet_mesh *tets, int32_t t, int32_t point) {
    for (int k = 0; k < 4; k++) {
        int32_t other = beyond(tets, t, k);
        if (other >= 0 && place_of(tets->corners[other], point) < 4) return true;
    }
    return false;
}

/// Flips the two tetrahedra of a passage to have an edge from one apex to the other. False without memory.
static bool flip_at(flipper *f, const passage *at, int32_t to) {
    bool done = false, good = true;
    for (int k = 0; k < 4 && good && !done; k++) {
        if (k != at->first) good = flip_edge(f, at, k, to, &done);
    }
    return good && !done ? flip_facet(f, at, to) : good;
}

/// Makes an edge of the polygons one of the tetrahedra, if one flip can, or one after another: *there. False
/// without memory.
static bool flip_to(flipper *f, int32_t from, int32_t to, bool *there) {
    const enf_tet_mesh *tets = f->tets;
    passage at;
    int32_t upper, before = -1;
    while (f->flips != before) {
        if (!find_passage(f, from, to, &at)) {
            *there = true;
            return true;
        }
        int32_t apex = apex_beyond(tets, at.t, at.first, &upper), flips = f->flips;
        if (apex == to) {
            bool good = flip_at(f, &at, to);
            *there = f->flips != flips;
            return good;
        }
        if (before >= 0 || apex < 0 || !is_beside(tets, upper, to) || !goes_through(f, &at, apex)) break;
        before = flips;
        if (!flip_at(f, &at, apex)) return false;
    }
    *there = false;
    return true;
}

// ---------------------------------------------------------------------------------------------- all polygons

static bool is_tiled(const flipper *f, const int32_t *corner, int64_t count) {
    int32_t facets[ENF_TILING_CORNERS_MAX];
    return enf_tet_mesh_tiling(f->tets, corner, count, facets) > 0;
}

/// Looks through the polygons: those that facets tile have their edges (returned true in `tiled`).
static void mark_tiled(flipper *f, const enf_mesh *mesh, bool *tiled) {
    for (size_t p = 0; p < mesh->polygon_count; p++) {
        int64_t begin = mesh->polygon_corner[p], end = mesh->polygon_corner[p + 1];
        tiled[p] = is_tiled(f, mesh->corners + begin, end - begin);
        for (int64_t c = begin, before = end - 1; tiled[p] && c < end; before = c++)
            f->wanted.done[find_edge(&f->wanted, mesh->corners[before], mesh->corners[c])] = true;
    }
}

static bool flip_all(flipper *f, const enf_mesh *mesh, const bool *tiled) {
    for (size_t p = 0; p < mesh->polygon_count; p++) {
        int64_t begin = mesh->polygon_corner[p], end = mesh->polygon_corner[p + 1];
        for (int64_t c = begin, before = end - 1; !tiled[p] && c < end; before = c++) {
            bool *done = &f->wanted.done[find_edge(&f->wanted, mesh->corners[before], mesh->corners[c])];
            if (!*done && !flip_to(f, mesh->corners[before], mesh->corners[c], done)) return false;
        }
    }
    return true;
}

enf_status enf_tet_mesh_flip(enf_tet_mesh *tets, const enf_mesh *mesh, int32_t *flips, enf_error *error) {
    flipper f = {.tets = tets,
                 .points = mesh->points,
                 .corner_capacity = (size_t)tets->count,
                 .facet_capacity = (size_t)tets->count,
                 .facet_corner_capacity = (size_t)tets->facet_count,
                 .side_capacity = (size_t)tets->facet_count};
    bool *tiled = enf_array_new(mesh->polygon_count, sizeof *tiled);
    bool good = tiled && list_edges(&f.wanted, mesh);
    if (good) {
        mark_tiled(&f, mesh, tiled);
        good = flip_all(&f, mesh, tiled);
    }
    enf_array_trim(tets->corners, tets->count);
    enf_array_trim(tets->facets, tets->count);
    enf_array_trim(tets->facet_corners, tets->facet_count);
    enf_array_trim(tets->facet_sides, tets->facet_count);
    free_edges(&f.wanted);
    free(tiled);
    *flips = f.flips;
    good = good && enf_tet_mesh_list(tets, f.turned, f.turned_count);
    free(f.turned);
    if (good) return ENF_OK;
    enf_tet_mesh_free(tets);
    return enf_fail_memory(error, "the tetrahedra's faces");
}
