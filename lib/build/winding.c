// SPDX-License-Identifier: GPL-3.0-or-later
// Going from the front of a polygon to its back enters one more solid. For closed solids, however they
// overlap, all polygons agree, and the winding number of a region is the number of solids that hold it (rooms
// drawn as shells that face inwards count -1). Real soups have holes and flipped polygons, so each pair of
// regions is joined by the difference that most area votes for, pairs with the most area first (a maximum
// spanning tree); a vote that contradicts the tree marks both its regions as ambiguous.
#include "build/winding.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// "Winding of `low` minus winding of `high` is `difference`", with the area that says so.
typedef struct vote {
    int32_t low, high, difference;
    double area;
} vote;

static int compare_claims(const void *a, const void *b) {
    const vote *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    if (x->high != y->high) return x->high < y->high ? -1 : 1;
    return (x->difference > y->difference) - (x->difference < y->difference);
}

static int compare_areas(const void *a, const void *b) {
    const vote *x = a, *y = b;
    if (x->area != y->area) return x->area > y->area ? -1 : 1;
    return compare_claims(a, b);
}

/// Is the point inside the convex loop, seen along the plane's longest axis?
static bool holds(const enf_complex *complex, const enf_corner *corners, int32_t count, const double point[3],
                  int axis) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    bool left = true, right = true;
    for (int32_t i = 0; i < count; i++) {
        const double *p = complex->vertex_position[corners[i].vertex];
        const double *q = complex->vertex_position[corners[i + 1 < count ? i + 1 : 0].vertex];
        double turn = (q[u] - p[u]) * (point[v] - p[v]) - (q[v] - p[v]) * (point[u] - p[u]);
        left &= turn >= 0;
        right &= turn <= 0;
    }
    return left || right;
}

/// Solids entered when going from the facet's front to its back through the middle of a piece.
static int32_t solids_behind(const enf_complex *complex, const enf_mesh *mesh, int32_t facet, int32_t piece,
                             const double area[3]) {
    int32_t count = 0, corner_count;
    double centre[3];
    int axis = fabs(area[0]) > fabs(area[1]) ? (fabs(area[0]) > fabs(area[2]) ? 0 : 2)
                                             : (fabs(area[1]) > fabs(area[2]) ? 1 : 2);
    enf_complex_piece_centre(complex, piece, centre);
    for (int32_t c = complex->facet_cover[facet]; c < complex->facet_cover[facet + 1]; c++) {
        const enf_corner *corners = enf_complex_cover(complex, c, facet, &corner_count);
        if (c != complex->piece_cover[piece] && !holds(complex, corners, corner_count, centre, axis))
            continue;
        int32_t copies = mesh->polygon_copies[complex->cover_polygon[c]];
        count += complex->cover_side[c] == 1 ? copies : -copies;
    }
    return count;
}

/// One vote per occluded piece; votes for the same claim are added up. The outside is region number
/// region_count.
static bool collect_votes(const enf_complex *complex, const enf_mesh *mesh, const int32_t *cell_region,
                          int32_t region_count, vote **votes, size_t *vote_count) {
    size_t count = 0, capacity = 0;
    *votes = NULL;
    for (int32_t facet = 0; facet < complex->facet_count; facet++) {
        for (int32_t p = complex->facet_piece[facet]; p < complex->facet_piece[facet + 1]; p++) {
            int32_t side[2];
            for (int k = 0; k < 2; k++) {
                int32_t cell = complex->facet_cell[facet][k];
                side[k] = cell < 0 ? region_count : cell_region[cell];
            }
            if (complex->piece_cover[p] == ENF_PIECE_SEALED) continue; // no polygon, no vote
            bool open = complex->piece_cover[p] == ENF_PIECE_OPEN;
            if (side[0] == side[1] || (open && side[0] != region_count && side[1] != region_count)) continue;
            double area[3];
            enf_complex_piece_area(complex, p, area);
            int32_t entered = open ? 0 : solids_behind(complex, mesh, facet, p, area);
            if (!enf_array_reserve(*votes, capacity, count + 1)) return false;
            bool ordered = side[0] < side[1];
            (*votes)[count++] =
                (vote){ordered ? side[0] : side[1], ordered ? side[1] : side[0], ordered ? entered : -entered,
                       sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2])};
        }
    }
    if (count) qsort(*votes, count, sizeof **votes, compare_claims);
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        if (kept > 0 && compare_claims(&(*votes)[kept - 1], &(*votes)[i]) == 0) {
            (*votes)[kept - 1].area += (*votes)[i].area;
        } else {
            (*votes)[kept++] = (*votes)[i];
        }
    }
    if (kept) qsort(*votes, kept, sizeof **votes, compare_areas);
    *vote_count = kept;
    return true;
}

/// Union-find whose links carry differences: winding of a region minus winding of its root.
static int32_t find_root(int32_t *parent, int32_t *difference, int32_t region) {
    int32_t root = region, sum = 0;
    while (parent[root] != root) {
        sum += difference[root];
        root = parent[root];
    }
    while (parent[region] != root && region != root) { // compress the path
        int32_t next = parent[region], step = difference[region];
        parent[region] = root;
        difference[region] = sum;
        sum -= step;
        region = next;
    }
    return root;
}

bool enf_complex_wind(const enf_complex *complex, const enf_mesh *mesh, const int32_t *cell_region,
                      int32_t region_count, int32_t *winding, bool *ambiguous) {
    vote *votes;
    size_t vote_count;
    size_t nodes = (size_t)region_count + 1;
    int32_t *parent = enf_array_new(nodes, sizeof *parent),
            *difference = enf_array_zeroed(nodes, sizeof *difference);
    bool good =
        collect_votes(complex, mesh, cell_region, region_count, &votes, &vote_count) && parent && difference;
    for (int32_t r = 0; good && r <= region_count; r++) parent[r] = r;
    memset(ambiguous, 0, (size_t)region_count * sizeof *ambiguous);
    for (size_t i = 0; good && i < vote_count; i++) {
        const vote *v = &votes[i];
        int32_t low = find_root(parent, difference, v->low), high = find_root(parent, difference, v->high);
        int32_t claimed = v->difference + difference[v->high] - difference[v->low]; // of the roots
        if (low != high) {
            parent[low] = high;
            difference[low] = claimed;
        } else if (claimed != 0) {
            ambiguous[v->low] = true;
            if (v->high < region_count) ambiguous[v->high] = true;
        }
    }
    if (good) {
        find_root(parent, difference, region_count);
        int32_t outside = difference[region_count];
        for (int32_t r = 0; r < region_count; r++) {
            find_root(parent, difference, r);
            winding[r] = difference[r] - outside;
        }
    }
    free(votes);
    free(parent);
    free(difference);
    return good;
}
