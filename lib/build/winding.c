// SPDX-License-Identifier: GPL-3.0-or-later
// Going from the front of a polygon to its back enters one more solid. For closed solids, however they
// overlap, all polygons agree, and the winding number of a region is the number of solids that hold it (rooms
// drawn as shells that face inwards count -1). Real soups have holes and flipped polygons, so each pair of
// regions is joined by the difference that most area votes for, pairs with the most area first (a maximum
// spanning tree); a vote that contradicts the tree marks both its regions as ambiguous.
#include "build/winding.h"

#include "base/array.h"
#include "base/hash.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void enf_votes_free(enf_votes *votes) {
    free(votes->votes);
    free(votes->slots);
    memset(votes, 0, sizeof *votes);
}

static bool same_claim(const enf_vote *a, const enf_vote *b) {
    return a->low == b->low && a->high == b->high && a->difference == b->difference;
}

/// Where the claim is in the table, or where it would be.
static size_t slot_of(const enf_votes *votes, const enf_vote *vote) {
    size_t mask = votes->slot_count - 1;
    uint64_t hash = enf_hash_mix((uint64_t)(uint32_t)vote->low << 32 | (uint32_t)vote->high);
    size_t slot = enf_hash_mix(hash + (uint32_t)vote->difference) & mask;
    for (int32_t at; (at = votes->slots[slot]) >= 0; slot = (slot + 1) & mask)
        if (same_claim(&votes->votes[at], vote)) break;
    return slot;
}

static bool grow_slots(enf_votes *votes) {
    size_t wanted = votes->slot_count ? 2 * votes->slot_count : 256;
    int32_t *slots = enf_array_new(wanted, sizeof *slots);
    if (!slots) return false;
    memset(slots, -1, wanted * sizeof *slots);
    free(votes->slots);
    votes->slots = slots;
    votes->slot_count = wanted;
    for (size_t i = 0; i < votes->count; i++) slots[slot_of(votes, &votes->votes[i])] = (int32_t)i;
    return true;
}

bool enf_votes_add(enf_votes *votes, int32_t behind, int32_t in_front, int32_t entered, double area) {
    bool ordered = behind < in_front;
    enf_vote vote = {ordered ? behind : in_front, ordered ? in_front : behind, ordered ? entered : -entered,
                     area};
    if (2 * (votes->count + 1) > votes->slot_count && !grow_slots(votes)) return false;
    size_t slot = slot_of(votes, &vote);
    if (votes->slots[slot] >= 0) {
        votes->votes[votes->slots[slot]].area += area;
        return true;
    }
    if (!enf_array_reserve(votes->votes, votes->capacity, votes->count + 1)) return false;
    votes->slots[slot] = (int32_t)votes->count;
    votes->votes[votes->count++] = vote;
    return true;
}

static int compare_votes(const void *a, const void *b) {
    const enf_vote *x = a, *y = b;
    if (x->area != y->area) return x->area > y->area ? -1 : 1;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    if (x->high != y->high) return x->high < y->high ? -1 : 1;
    return (x->difference > y->difference) - (x->difference < y->difference);
}

#define ROUNDED 4 ///< grid steps: more than rounding moves the ends of an edge, and the point, together

/// Is the point inside the convex loop, seen along the plane's longest axis? What rounding may hide counts as
/// inside: an edge of less than a step may point anywhere, and says nothing.
static bool holds(const enf_complex *complex, const enf_corner *corners, int32_t count, const double point[3],
                  int axis) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    bool left = true, right = true;
    for (int32_t i = 0; i < count; i++) {
        const double *p = complex->vertex_position[corners[i].vertex];
        const double *q = complex->vertex_position[corners[i + 1 < count ? i + 1 : 0].vertex];
        double edge[2] = {q[u] - p[u], q[v] - p[v]}, away[2] = {point[u] - p[u], point[v] - p[v]};
        double turn = edge[0] * away[1] - edge[1] * away[0];
        double slack = ROUNDED * (fabs(edge[0]) + fabs(edge[1]) + fabs(away[0]) + fabs(away[1]));
        left &= turn >= -slack;
        right &= turn <= slack;
    }
    return left || right;
}

/// A point inside the piece that lies on no line of symmetry: other polygons often end on one (two triangles
/// that halve a rectangle the other way meet in the middle of these), and all must say the same.
static void skew_point(const enf_complex *complex, int32_t piece, double point[3]) {
    int32_t count;
    const enf_corner *corners = enf_complex_piece(complex, piece, &count);
    double sum = 0;
    point[0] = point[1] = point[2] = 0;
    for (int32_t i = 0; i < count; i++) {
        double golden = 0.6180339887498949 * (i + 1), weight = 1 + golden - floor(golden);
        sum += weight;
        for (int k = 0; k < 3; k++) point[k] += weight * complex->vertex_position[corners[i].vertex][k];
    }
    for (int k = 0; k < 3; k++) point[k] /= sum;
}

int32_t enf_complex_solids_behind(const enf_complex *complex, const enf_mesh *mesh, int32_t facet,
                                  int32_t piece, const double area[3]) {
    int32_t count = 0, first = complex->facet_cover[facet], end = complex->facet_cover[facet + 1];
    double inside[3];
    int axis = fabs(area[0]) > fabs(area[1]) ? (fabs(area[0]) > fabs(area[2]) ? 0 : 2)
                                             : (fabs(area[1]) > fabs(area[2]) ? 1 : 2);
    if (end - first > 1) skew_point(complex, piece, inside);
    for (int32_t c = first; c < end; c++) {
        int32_t corner_count;
        const enf_corner *corners = enf_complex_cover(complex, c, facet, &corner_count);
        if (c != complex->piece_cover[piece] && !holds(complex, corners, corner_count, inside, axis))
            continue;
        int32_t copies = mesh->polygon_copies[complex->cover_polygon[c]];
        count += complex->cover_side[c] == 1 ? copies : -copies;
    }
    return count;
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

bool enf_votes_settle(enf_votes *votes, int32_t region_count, int32_t *winding, bool *ambiguous) {
    size_t nodes = (size_t)region_count + 1;
    int32_t *parent = enf_array_new(nodes, sizeof *parent),
            *difference = enf_array_zeroed(nodes, sizeof *difference);
    bool good = parent && difference;
    if (good && votes->count) qsort(votes->votes, votes->count, sizeof *votes->votes, compare_votes);
    for (int32_t r = 0; good && r <= region_count; r++) parent[r] = r;
    memset(ambiguous, 0, (size_t)region_count * sizeof *ambiguous);
    for (size_t i = 0; good && i < votes->count; i++) {
        const enf_vote *v = &votes->votes[i];
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
    free(parent);
    free(difference);
    return good;
}
