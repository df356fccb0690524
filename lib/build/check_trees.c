// SPDX-License-Identifier: GPL-3.0-or-later
// Split, how points find their cells: the part of its tetrahedron that a leaf of the tree of cuts stands for
// lies in the cell that the leaf names. (Then each cell is all of its parts, for both tile the hull. A part
// may be empty, or flat: tetrahedra can share a tree, and a cut need not pass through all of them.)
//
// Most leaves need no arithmetic: if every facet of the cell lies in a plane that bounds the leaf's part,
// which has the cell on the same side, then the part lies in the cell. For the others the corners of the part
// are worked out, cut by cut, and compared with the cell's planes.
//
// Corners and edges by double description (T. Motzkin et al., 1953): each corner knows the bounds it lies on,
// and two corners with two bounds in common end an edge. A pair too many does no harm: it adds a point of the
// part.
#include "build/check_rows.h"

#include "base/array.h"

#include <stdlib.h>

__extension__ typedef unsigned __int128 bits;

enum { CROWDED = 128 }; ///< instead of a bit: there is none free

/// A half-space: a plane and the side of it that is meant.
typedef struct bound {
    int32_t plane_class;
    int8_t inner;
} bound;

typedef struct corner {
    int32_t vertex;
    bits tight; ///< bounds it lies on
} corner;

/// A part of a tetrahedron: behind or in front of the cut above it.
typedef struct part {
    int32_t child; ///< node or leaf
    int32_t depth; ///< cuts above it
    bound last;    ///< the cut just above it
    int dimension; ///< 3, or less if cuts only touch it
    bool any_pair; ///< any two corners may end an edge: they do not know all their bounds
    size_t count;  ///< corners, the last ones on the stack
} part;

typedef struct walker {
    enf_checker *checker;
    int32_t *leaves; ///< per fine cell
    bound *bounds;   ///< four faces, then the cuts above the part being looked at
    part *parts;     ///< that wait, with their corners
    corner *corners;
    int8_t *sides; ///< of the part being cut
    size_t bound_capacity, part_count, part_capacity, corner_count, corner_capacity, side_capacity;
} walker;

// ---------------------------------------------------------------------------------------------- leaves

static bool is_bound(const walker *w, int32_t depth, bound wanted) {
    for (int32_t i = 0; i < 4 + depth; i++) {
        if (w->bounds[i].plane_class == wanted.plane_class && w->bounds[i].inner == wanted.inner) return true;
    }
    return false;
}

/// The half-space of a facet of a fine cell, which holds the cell.
static bound facet_bound(const enf_checker *checker, int32_t facet, int32_t cell) {
    int32_t plane = checker->view->facet_plane[facet];
    int8_t sign = checker->exact.plane_sign[plane];
    return (bound){checker->exact.plane_class[plane],
                   (int8_t)(enf_check_facet_side(checker, facet, cell) ? sign : -sign)};
}

/// Is the leaf's part in the cell because of the bounds alone?
static bool leaf_is_plain(const walker *w, const part *leaf) {
    const enf_file_view *view = w->checker->view;
    int32_t cell = -1 - leaf->child;
    for (int32_t i = view->fine_facet[cell]; i < view->fine_facet[cell + 1]; i++) {
        if (!is_bound(w, leaf->depth, facet_bound(w->checker, view->fine_facets[i], cell))) return false;
    }
    return true;
}

static bool leaf_is_inside(walker *w, const part *leaf, int32_t t) {
    const enf_file_view *view = w->checker->view;
    int32_t cell = -1 - leaf->child;
    const corner *corners = w->corners + w->corner_count;
    for (int32_t i = view->fine_facet[cell]; i < view->fine_facet[cell + 1]; i++) {
        bound held = facet_bound(w->checker, view->fine_facets[i], cell);
        if (is_bound(w, leaf->depth, held)) continue;
        for (size_t k = 0; k < leaf->count; k++) {
            int side = enf_check_side_of_class(&w->checker->exact, corners[k].vertex, held.plane_class);
            if (side == -held.inner)
                return enf_check_break(w->checker, "a leaf of tetrahedron %d reaches out of its fine cell %d",
                                       (int)t, (int)cell);
        }
    }
    return true;
}

// ---------------------------------------------------------------------------------------------- parts

/// Bounds that the part has a side on, and those that all of it lies on.
static bits bounds_in_use(const part *whole, const corner *corners, bits *all) {
    bits once = 0, twice = 0, thrice = 0;
    *all = ~(bits)0;
    for (size_t i = 0; i < whole->count; i++) {
        thrice |= twice & corners[i].tight;
        twice |= once & corners[i].tight;
        once |= corners[i].tight;
        *all &= corners[i].tight;
    }
    return (whole->dimension == 3 ? thrice : twice) | *all;
}

static bool find_sides(walker *w, const corner *corners, size_t count, int32_t plane, size_t met[3]) {
    if (!enf_array_reserve(w->sides, w->side_capacity, count)) return enf_check_no_memory(w->checker);
    for (size_t i = 0; i < count; i++) {
        w->sides[i] = (int8_t)enf_check_side(&w->checker->exact, corners[i].vertex, plane);
        met[w->sides[i] + 1]++;
    }
    return true;
}

/// Gives a free bit to a cut that has corners on both sides: CROWDED if there is none.
static int take_bit(const walker *w, corner *corners, size_t count, bits used) {
    int bit = 0;
    while (bit < CROWDED && used >> bit & 1) bit++;
    for (size_t i = 0; i < count && bit < CROWDED; i++) {
        corners[i].tight &= ~((bits)1 << bit);
        if (w->sides[i] == 0) corners[i].tight |= (bits)1 << bit;
    }
    return bit;
}

/// An edge of a body lies on two bounds, one of a flat part on one more than all of the part, and a line is
/// one.
static bool is_edge(const part *whole, const corner *a, const corner *b, bits all) {
    bits common = a->tight & b->tight;
    if (whole->dimension == 3) return whole->any_pair || (common & (common - 1)) != 0;
    return whole->any_pair || whole->dimension == 1 || (common & ~all) != 0;
}

static bool push_corner(walker *w, corner made) {
    if (!enf_array_reserve(w->corners, w->corner_capacity, w->corner_count + 1))
        return enf_check_no_memory(w->checker);
    w->corners[w->corner_count++] = made;
    return true;
}

/// Appends the places where the edges of the part, whose corners begin at `first`, cross the cut.
static bool cross_edges(walker *w, part *whole, size_t first, int32_t plane_class) {
    bits all, used = bounds_in_use(whole, w->corners + first, &all);
    int bit = take_bit(w, w->corners + first, whole->count, used);
    whole->any_pair = whole->any_pair || bit == CROWDED;
    for (size_t i = 0; i < whole->count; i++) {
        for (size_t k = 0; k < whole->count && w->sides[i] < 0; k++) {
            corner a = w->corners[first + i], b = w->corners[first + k];
            if (w->sides[k] <= 0 || !is_edge(whole, &a, &b, all)) continue;
            corner made = {enf_check_cross_edge(&w->checker->exact, a.vertex, b.vertex, plane_class),
                           a.tight & b.tight};
            if (bit < CROWDED) made.tight |= (bits)1 << bit;
            if (made.vertex < 0) return enf_check_no_memory(w->checker);
            if (!push_corner(w, made)) return false;
        }
    }
    return true;
}

static bool push_part(walker *w, part made) {
    if (!enf_array_reserve(w->parts, w->part_capacity, w->part_count + 1))
        return enf_check_no_memory(w->checker);
    w->parts[w->part_count++] = made;
    return true;
}

static bound cut_bound(const enf_checker *checker, int32_t node, int side) {
    int32_t plane = checker->view->node_plane[node];
    int8_t sign = checker->exact.plane_sign[plane];
    return (bound){checker->exact.plane_class[plane], (int8_t)(side ? sign : -sign)};
}

/// What is left of a part on one side of a cut. Of a cut that only touches it, the touching side is a face,
/// an edge or a corner.
static void measure_half(const part *whole, const size_t met[3], int side, part *half) {
    bool touches = met[side ? 2 : 0] == 0 && met[side ? 0 : 2] > 0;
    half->dimension = whole->dimension;
    if (touches) half->dimension = met[1] > 2 ? 2 : (int)met[1] - 1;
    half->any_pair = whole->any_pair;
}

/// Replaces the corners of a part, just above the stack, by those of its two sides.
static bool cut_corners(walker *w, part *whole, part half[2]) {
    int32_t plane = w->checker->view->node_plane[whole->child];
    size_t first = w->corner_count, count = whole->count, met[3] = {0, 0, 0};
    if (!find_sides(w, w->corners + first, count, plane, met)) return false;
    w->corner_count += count;
    if (met[0] > 0 && met[2] > 0 && !cross_edges(w, whole, first, w->checker->exact.plane_class[plane]))
        return false;
    for (int side = 0; side < 2; side++) measure_half(whole, met, side, &half[side]);
    size_t crossings = w->corner_count - first - count;
    for (int side = 0; side < 2; side++) { // behind the whole and the crossings, then moved down over them
        size_t start = w->corner_count;
        for (size_t i = 0; i < count; i++) {
            if (w->sides[i] != (side ? -1 : 1) && !push_corner(w, w->corners[first + i])) return false;
        }
        for (size_t i = 0; i < crossings; i++) {
            if (!push_corner(w, w->corners[first + count + i])) return false;
        }
        half[side].count = w->corner_count - start;
    }
    size_t moved = half[0].count + half[1].count;
    for (size_t i = 0; i < moved; i++) w->corners[first + i] = w->corners[first + count + crossings + i];
    w->corner_count = first + moved;
    return true;
}

// ---------------------------------------------------------------------------------------------- trees

/// The four faces as bounds, and the corners if they are needed.
static bool start_tree(walker *w, int32_t t, bool with_corners) {
    static const int inside[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
    enf_checker *checker = w->checker;
    const int32_t *at = checker->view->tetrahedra[t];
    if (!enf_array_reserve(w->bounds, w->bound_capacity, 5)) return enf_check_no_memory(checker);
    w->part_count = w->corner_count = 0;
    for (int k = 0; k < 4; k++) {
        const int32_t points[3] = {at[inside[k][0]], at[inside[k][1]], at[inside[k][2]]};
        w->bounds[k].plane_class = enf_check_class_through(&checker->exact, points, &w->bounds[k].inner);
        if (w->bounds[k].inner == 0) return enf_check_no_memory(checker);
        if (with_corners && !push_corner(w, (corner){at[k], 15u & ~(1u << k)})) return false;
    }
    return push_part(
        w,
        (part){.child = checker->view->tetrahedron_root[t], .dimension = 3, .count = with_corners ? 4 : 0});
}

static bool push_halves(walker *w, part *whole, bool with_corners) {
    part half[2];
    for (int side = 0; side < 2; side++) {
        half[side] = (part){.child = w->checker->view->node_child[whole->child][side],
                            .depth = whole->depth + 1,
                            .last = cut_bound(w->checker, whole->child, side)};
    }
    if (with_corners && !cut_corners(w, whole, half)) return false;
    for (int side = 0; side < 2; side++) {
        if ((half[side].count > 0 || !with_corners) && !push_part(w, half[side])) return false;
    }
    return true;
}

/// Visits the leaves. Without corners: *plain tells whether all were plain.
static bool walk_tree(walker *w, int32_t t, bool with_corners, bool *plain) {
    if (!start_tree(w, t, with_corners)) return false;
    *plain = true;
    while (w->part_count > 0 && *plain) {
        part here = w->parts[--w->part_count];
        w->corner_count -= here.count;
        if (here.depth > 0) {
            if (!enf_array_reserve(w->bounds, w->bound_capacity, 4 + (size_t)here.depth))
                return enf_check_no_memory(w->checker);
            w->bounds[3 + here.depth] = here.last;
        }
        if (here.child >= 0) {
            if (!push_halves(w, &here, with_corners)) return false;
        } else if (with_corners) {
            if (!leaf_is_inside(w, &here, t)) return false;
        } else {
            *plain = leaf_is_plain(w, &here);
        }
    }
    return true;
}

static bool count_leaves(walker *w) {
    const enf_file_view *view = w->checker->view;
    for (int32_t t = 0; t < view->tetrahedron_count; t++) {
        if (view->tetrahedron_root[t] < 0) w->leaves[-1 - view->tetrahedron_root[t]]++;
    }
    for (int32_t n = 0; n < view->node_count; n++) {
        for (int side = 0; side < 2; side++) {
            if (view->node_child[n][side] < 0) w->leaves[-1 - view->node_child[n][side]]++;
        }
    }
    for (int32_t c = 0; c < view->fine_count; c++) {
        if (w->leaves[c] == 0) return enf_check_break(w->checker, "fine cell %d hangs in no tree", (int)c);
    }
    return true;
}

void enf_check_trees(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(
        checker, "split: trees",
        "every leaf of a tetrahedron's tree of cuts lies in the fine cell that it names, every fine "
        "cell has a leaf");
    walker w = {.checker = checker, .leaves = enf_array_zeroed((size_t)view->fine_count, sizeof(int32_t))};
    bool good = w.leaves ? count_leaves(&w) : enf_check_no_memory(checker), plain;
    for (int32_t t = 0; good && t < view->tetrahedron_count; t++, checker->row->tested++) {
        good = walk_tree(&w, t, false, &plain);
        if (good && !plain) good = walk_tree(&w, t, true, &plain);
        enf_check_drop_crossings(&checker->exact);
    }
    free(w.leaves);
    free(w.bounds);
    free(w.parts);
    free(w.corners);
    free(w.sides);
}
