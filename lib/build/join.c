// SPDX-License-Identifier: GPL-3.0-or-later
// A closed surface that is convex at every edge is convex (H. Tietze 1928, S. Nakajima 1928); two convex
// cells that share facets can only fail to be so at the edges around these. The same test decides flips of
// tetrahedra.
#include "build/join.h"

#include "base/array.h"
#include "base/exact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Cells are joined where the opening between them is at least this share of either's shadow on it: a
/// narrower one may be a door, and decimation weighs those. A half would leave about 8 % more cells on real
/// levels.
#define OPENING_MIN 0.25

static int32_t apex(const enf_tet_mesh *tets, int32_t t, int32_t facet) {
    return tets->corners[t][enf_tetrahedron_place(tets->facets[t], facet)]; // both have four numbers
}

/// For each facet between two tetrahedra of the part: a bit for each of its three edges at which the two
/// together are not convex. Joining more to them does not mend that: no part of the facet at that edge need
/// be tried.
static void find_reflex(const enf_subdivision *s, const enf_tet_mesh *tets, uint8_t *reflex) {
    const double *points = s->geometry.points;
    for (size_t i = 0; i < s->facet_count; i++) {
        if (s->facets[i].cell[0] < 0 || s->facets[i].cell[1] < 0) continue;
        int32_t f = s->facets[i].source;
        const double *p = points + 3 * (size_t)apex(tets, tets->facet_sides[f][0], f),
                     *q = points + 3 * (size_t)apex(tets, tets->facet_sides[f][1], f);
        for (int k = 0; k < 3; k++) {
            const double *a = points + 3 * (size_t)tets->facet_corners[f][k],
                         *b = points + 3 * (size_t)tets->facet_corners[f][(k + 1) % 3];
            if (enf_points_orient(a, b, p, q) < 0) reflex[f] |= (uint8_t)(1 << k);
        }
    }
}

/// Has the facet a part of an edge of its tetrahedra at which they are not convex? Such an edge lies on
/// another facet of the tetrahedron that the facet's halves were made from (see add_tetrahedron_facet).
static bool is_hopeless(const enf_subdivision *s, const enf_joiner *joiner, int32_t f) {
    const enf_tet_mesh *tets = joiner->tets;
    int32_t source = s->facets[f].source, first = s->facets[f].first, h = first, reflex_plane[3], count = 0;
    if (source < 0 || !joiner->reflex[source]) return false;
    int32_t t =
        tets->facet_sides[source][0] >= 0 ? tets->facet_sides[source][0] : tets->facet_sides[source][1];
    for (int i = 0; i < 3; i++) {
        if (!(joiner->reflex[source] >> i & 1)) continue;
        int opposite = enf_tetrahedron_place(tets->corners[t], tets->facet_corners[source][(i + 2) % 3]);
        reflex_plane[count++] = tets->facets[t][opposite];
    }
    do {
        for (int i = 0; i < count; i++) {
            if (s->halves[h].edge_plane == reflex_plane[i]) return true;
        }
        h = s->halves[h].next;
    } while (h != first);
    return false;
}

/// The facets at an edge that belong to one of two cells and not to both: a half of each, or -1.
static void find_beside(const enf_subdivision *s, int32_t edge, const int32_t cell[2], int32_t beside[2]) {
    beside[0] = beside[1] = -1;
    for (int32_t h = s->edge_half[edge]; h > 0; h = s->halves[h].radial) {
        const enf_share *facet = &s->facets[s->halves[h].facet];
        bool first = (facet->cell[0] == cell[0]) | (facet->cell[1] == cell[0]),
             second = (facet->cell[0] == cell[1]) | (facet->cell[1] == cell[1]);
        if (first != second) beside[second] = h;
    }
}

/// Does the facet of half `b` lie on the inner side of (or in) the plane of half `a`'s, which bounds `cell`?
static bool folds_in(enf_subdivision *s, int32_t a, int32_t b, int32_t cell) {
    int32_t facet = s->halves[a].facet, plane = enf_subdivision_plane(s, facet);
    if (plane == enf_subdivision_plane(s, s->halves[b].facet)) return true;
    int32_t line = s->halves[b].edge_plane, at = s->halves[b].next;
    while (s->halves[at].edge_plane == line) at = s->halves[at].next;
    int side = enf_geometry_side(&s->geometry, s->halves[s->halves[at].next].vertex, plane);
    return side == 0 || (side < 0) == (s->facets[facet].cell[0] == cell);
}

/// Is the union of the two cells of facet f convex at its edges? Edges to another facet between the same two
/// are inside the wall.
static bool convex_around(enf_subdivision *s, int32_t f) {
    int32_t cell[2] = {s->facets[f].cell[0], s->facets[f].cell[1]}, beside[2];
    int32_t first = s->facets[f].first, h = first;
    do {
        find_beside(s, s->halves[h].edge, cell, beside);
        if (beside[0] >= 0 && !folds_in(s, beside[0], beside[1], cell[0])) return false;
        h = s->halves[h].next;
    } while (h != first);
    return true;
}

/// All facets between the two cells: open, and the union convex around them?
static bool may_join(enf_subdivision *s, int32_t f) {
    int32_t behind = s->facets[f].cell[0], front = s->facets[f].cell[1];
    if (!convex_around(s, f)) return false;
    for (int32_t g = s->cell_facet[front], next; g >= 0; g = next) {
        const enf_share *facet = &s->facets[g];
        int side = facet->cell[1] == front;
        next = facet->next[side];
        if (facet->cell[1 - side] != behind || g == f) continue;
        if (facet->cover >= 0 || !convex_around(s, g)) return false;
    }
    return true;
}

/// `front` goes into `behind`; the facets between them go.
static void join_cells(enf_subdivision *s, int32_t behind, int32_t front) {
    int32_t kept = -1;
    for (int k = 0; k < 2; k++) {
        int32_t cell = k == 0 ? behind : front, other = k == 0 ? front : behind;
        for (int32_t g = s->cell_facet[cell], next; g >= 0; g = next) {
            enf_share *facet = &s->facets[g];
            int side = facet->cell[1] == cell;
            next = facet->next[side];
            if (facet->cell[1 - side] == other) {
                if (k == 1) enf_subdivision_remove(s, g);
                continue;
            }
            facet->cell[side] = behind;
            facet->next[side] = kept;
            kept = g;
        }
    }
    s->cell_facet[behind] = kept;
    s->cell_facet[front] = -1;
}

// ---------------------------------------------------------------------------------------------- doors

/// Twice the facet's area vector, from rounded coordinates.
static void facet_area(const enf_subdivision *s, int32_t f, double area[3]) {
    int32_t first = s->facets[f].first, h = s->halves[first].next;
    double origin[3], from[3], to[3];
    enf_geometry_near(&s->geometry, s->halves[first].vertex, origin);
    enf_geometry_near(&s->geometry, s->halves[h].vertex, from);
    area[0] = area[1] = area[2] = 0;
    for (h = s->halves[h].next; h != first; h = s->halves[h].next) {
        enf_geometry_near(&s->geometry, s->halves[h].vertex, to);
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            area[k] +=
                (from[l] - origin[l]) * (to[m] - origin[m]) - (from[m] - origin[m]) * (to[l] - origin[l]);
        }
        memcpy(from, to, sizeof from);
    }
}

/// Is the area of the cell's shadow along a direction more than this? Each line through a convex cell meets
/// its surface twice.
static bool shadow_exceeds(const enf_subdivision *s, int32_t cell, const double direction[3], double area) {
    double sum = 0;
    for (int32_t f = s->cell_facet[cell], next; f >= 0 && sum <= 2 * area; f = next) {
        double part[3];
        next = s->facets[f].next[s->facets[f].cell[1] == cell];
        facet_area(s, f, part);
        sum += fabs(part[0] * direction[0] + part[1] * direction[1] + part[2] * direction[2]);
    }
    return sum > 2 * area;
}

/// Is the way from one cell to the other narrower than one of them? Then it may be a door, and is not for us
/// to close: decimation weighs that (the thesis 4.1.4, whose weight `aspect` this is).
static bool is_door(const enf_subdivision *s, int32_t f) {
    double direction[3], opening = 0;
    int32_t behind = s->facets[f].cell[0], front = s->facets[f].cell[1];
    facet_area(s, f, direction);
    for (int32_t g = s->cell_facet[front], next; g >= 0; g = next) {
        const enf_share *facet = &s->facets[g];
        double area[3];
        int side = facet->cell[1] == front;
        next = facet->next[side];
        if (facet->cell[1 - side] != behind) continue;
        if (g == f) {
            memcpy(area, direction, sizeof area);
        } else {
            facet_area(s, g, area);
        }
        opening += fabs(area[0] * direction[0] + area[1] * direction[1] + area[2] * direction[2]);
    }
    return shadow_exceeds(s, behind, direction, opening / OPENING_MIN) ||
           shadow_exceeds(s, front, direction, opening / OPENING_MIN);
}

bool enf_joiner_try(enf_joiner *joiner, enf_subdivision *s, int32_t f) {
    int32_t behind = s->facets[f].cell[0], front = s->facets[f].cell[1];
    if (s->facets[f].cover >= 0 || behind < 0 || front < 0) return false;
    if (is_hopeless(s, joiner, f) || !may_join(s, f) || is_door(s, f)) return false;
    joiner->into[front] = behind;
    join_cells(s, behind, front);
    joiner->count++;
    return true;
}

int32_t enf_joiner_find(enf_joiner *joiner, int32_t cell) {
    int32_t root = cell;
    while (joiner->into[root] != root) root = joiner->into[root];
    for (int32_t next; cell != root; cell = next) {
        next = joiner->into[cell];
        joiner->into[cell] = root;
    }
    return root;
}

bool enf_joiner_reserve(enf_joiner *joiner, size_t cell_count) {
    if (!enf_array_reserve(joiner->into, joiner->capacity, cell_count)) return false;
    for (; joiner->known < cell_count; joiner->known++) joiner->into[joiner->known] = (int32_t)joiner->known;
    return true;
}

bool enf_joiner_start(enf_joiner *joiner, const enf_subdivision *subdivision, const enf_tet_mesh *tets,
                      uint8_t *reflex) {
    joiner->tets = tets;
    joiner->reflex = reflex;
    joiner->known = 0;
    joiner->count = 0;
    find_reflex(subdivision, tets, reflex);
    return enf_joiner_reserve(joiner, subdivision->cell_count);
}

void enf_joiner_free(enf_joiner *joiner) {
    free(joiner->into);
    memset(joiner, 0, sizeof *joiner);
}
