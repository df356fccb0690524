// SPDX-License-Identifier: GPL-3.0-or-later
// Split: convex fine cells that tile their tetrahedra, and polygons that lie on their faces.
#include "build/check_rows.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

// ---------------------------------------------------------------------------------------------- cells

/// A cell while it is looked at: its corners, each once.
typedef struct corner_list {
    int32_t *places;
    size_t count, capacity;
} corner_list;

static int compare_numbers(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

static bool gather_corners(enf_checker *checker, corner_list *list, int32_t cell) {
    const enf_file_view *view = checker->view;
    list->count = 0;
    int64_t first = view->face_offset[view->fine_face[cell]],
            end = view->face_offset[view->fine_face[cell + 1]];
    if (!enf_array_reserve(list->places, list->capacity, (size_t)(end - first)))
        return enf_check_no_memory(checker);
    for (int64_t c = first; c < end; c++)
        list->places[list->count++] = checker->exact.place[view->face_corners[c].vertex];
    qsort(list->places, list->count, sizeof *list->places, compare_numbers);
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++) {
        if (i == 0 || list->places[i] != list->places[i - 1]) list->places[kept++] = list->places[i];
    }
    list->count = kept;
    return true;
}

/// All corners on the cell's side of the face's plane, and one of them off it.
static bool face_bounds_cell(enf_checker *checker, const corner_list *list, int32_t cell, int32_t face) {
    const enf_file_view *view = checker->view;
    int inner = view->face_side[face] ? 1 : -1;
    bool volume = false;
    int32_t plane = view->facet_plane[view->face_facet[face]];
    for (size_t i = 0; i < list->count; i++) {
        int side = enf_check_side(&checker->exact, list->places[i], plane);
        if (side == -inner)
            return enf_check_break(checker, "fine cell %d is not convex: vertex %d lies outside its face %d",
                                   (int)cell, (int)list->places[i], (int)face);
        volume = volume || side == inner;
    }
    return volume || enf_check_break(checker, "fine cell %d has no volume", (int)cell);
}

static bool check_cell(enf_checker *checker, corner_list *list, int32_t cell) {
    const enf_file_view *view = checker->view;
    int32_t first = view->fine_face[cell], end = view->fine_face[cell + 1];
    if (end - first < 4) return enf_check_break(checker, "fine cell %d has fewer than four faces", (int)cell);
    if (!gather_corners(checker, list, cell)) return false;
    enf_check_chain_empty(&checker->chain);
    for (int32_t f = first; f < end; f++) {
        enf_check_loop loop = enf_check_face(checker, f);
        const char *fault = enf_check_loop_fault(&checker->exact, &loop);
        if (fault) return enf_check_break(checker, "face %d of fine cell %d %s", (int)f, (int)cell, fault);
        if (!face_bounds_cell(checker, list, cell, f)) return false;
        for (int32_t g = first; g < f; g++) {
            int32_t other = view->facet_plane[view->face_facet[g]];
            if (checker->exact.plane_class[loop.plane] == checker->exact.plane_class[other])
                return enf_check_break(checker, "faces %d and %d of fine cell %d lie in one plane", (int)g,
                                       (int)f, (int)cell);
        }
        enf_check_chain_add_loop(&checker->chain, &checker->exact, &loop, view->face_side[f] ? -1 : 1);
    }
    if (checker->chain.failed) return enf_check_no_memory(checker);
    enf_check_chain_reduce(&checker->chain);
    if (checker->chain.count == 0) return true;
    return enf_check_break(checker, "fine cell %d is not closed: the edge of vertices %d and %d has one face",
                           (int)cell, (int)checker->chain.edges[0].low, (int)checker->chain.edges[0].high);
}

static void check_cells(enf_checker *checker) {
    enf_check_begin(checker, "split: cells", "every fine cell is closed and convex and has a volume");
    corner_list list = {0};
    for (int32_t c = 0; c < checker->view->fine_count && check_cell(checker, &list, c); c++)
        checker->row->tested++;
    free(list.places);
}

// ---------------------------------------------------------------------------------------------- tiling

/// Which of its tetrahedron's faces a fine cell's face lies on, or -1.
static int tetrahedron_side(enf_checker *checker, int32_t t, int32_t face) {
    const enf_file_view *view = checker->view;
    int32_t plane = view->facet_plane[view->face_facet[face]];
    int off = -1;
    for (int k = 0; k < 4; k++) {
        if (enf_check_side(&checker->exact, view->tetrahedra[t][k], plane) == 0) continue;
        if (off >= 0) return -1;
        off = k;
    }
    return off;
}

/// A tetrahedron's face as a loop, turning as its cells' faces do: counter-clockwise seen from outside.
static void add_tetrahedron_face(enf_checker *checker, int32_t t, int k, int32_t times) {
    static const int outside[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    const int32_t *corner = checker->view->tetrahedra[t];
    for (int i = 0; i < 3; i++) {
        enf_check_chain_add(&checker->chain, &checker->exact, corner[outside[k][i]],
                            corner[outside[k][(i + 1) % 3]], times);
    }
}

static bool find_facets(enf_checker *checker, int32_t t) {
    const enf_file_view *view = checker->view;
    for (int32_t i = checker->cell_first[t]; i < checker->cell_first[t + 1]; i++) {
        int32_t cell = checker->tetrahedron_cells[i];
        for (int32_t f = view->fine_face[cell]; f < view->fine_face[cell + 1]; f++) {
            int32_t facet = view->face_facet[f];
            if (checker->facet_node[facet] >= 0) continue;
            int k = tetrahedron_side(checker, t, f);
            if (k < 0)
                return enf_check_break(checker,
                                       "face %d of fine cell %d lies neither on a cut nor on tetrahedron %d",
                                       (int)f, (int)cell, (int)t);
            int32_t *known = &checker->tetrahedron_facet[t][k];
            if (*known < 0) *known = facet;
            if (*known != facet)
                return enf_check_break(checker, "face %d of tetrahedron %d has two facets, %d and %d", k,
                                       (int)t, (int)*known, (int)facet);
        }
    }
    return true;
}

/// The cells' faces on each face of the tetrahedron tile it.
static bool tetrahedron_is_tiled(enf_checker *checker, int32_t t) {
    const enf_file_view *view = checker->view;
    if (!find_facets(checker, t)) return false;
    for (int k = 0; k < 4; k++) {
        int32_t facet = checker->tetrahedron_facet[t][k], next = view->tetrahedron_next[t][k];
        if (facet < 0)
            return enf_check_break(checker, "no fine cell touches face %d of tetrahedron %d", k, (int)t);
        if (view->facet_hull[facet] != (next < 0))
            return enf_check_break(checker, "facet %d is marked wrongly as to the hull", (int)facet);
        enf_check_chain_empty(&checker->chain);
        for (int32_t i = checker->facet_first[facet]; i < checker->facet_first[facet + 1]; i++) {
            int32_t face = checker->facet_faces[i], owner = view->fine_tetrahedron[checker->face_cell[face]];
            if (owner != t && (owner != next || next < 0))
                return enf_check_break(checker, "facet %d of tetrahedron %d has a face of tetrahedron %d",
                                       (int)facet, (int)t, (int)owner);
            if (owner != t) continue;
            enf_check_loop loop = enf_check_face(checker, face);
            enf_check_chain_add_loop(&checker->chain, &checker->exact, &loop, view->face_side[face] ? -1 : 1);
        }
        add_tetrahedron_face(checker, t, k, -1);
        int sign, axis = enf_check_axis(&checker->exact, view->facet_plane[facet], &sign);
        if (checker->chain.failed) return enf_check_no_memory(checker);
        if (!enf_check_chain_vanishes(&checker->chain, &checker->exact, axis))
            return enf_check_break(checker, "the fine cells do not tile face %d of tetrahedron %d", k,
                                   (int)t);
    }
    return true;
}

/// Both sides of a cut are tiled by the same area.
static bool cut_is_matched(enf_checker *checker, int32_t node) {
    const enf_file_view *view = checker->view;
    int32_t facet = view->node_facet[node];
    if (checker->exact.plane_class[view->facet_plane[facet]] !=
        checker->exact.plane_class[view->node_plane[node]])
        return enf_check_break(checker, "facet %d is not on the plane of the cut that made it", (int)facet);
    int32_t count[2] = {0, 0}, tetrahedron = -1;
    enf_check_chain_empty(&checker->chain);
    for (int32_t i = checker->facet_first[facet]; i < checker->facet_first[facet + 1]; i++) {
        int32_t face = checker->facet_faces[i], owner = view->fine_tetrahedron[checker->face_cell[face]];
        if (tetrahedron >= 0 && owner != tetrahedron)
            return enf_check_break(checker, "cut facet %d has faces in tetrahedra %d and %d", (int)facet,
                                   (int)tetrahedron, (int)owner);
        tetrahedron = owner;
        count[view->face_side[face]]++;
        enf_check_loop loop = enf_check_face(checker, face);
        enf_check_chain_add_loop(&checker->chain, &checker->exact, &loop, view->face_side[face] ? -1 : 1);
    }
    if (checker->chain.failed) return enf_check_no_memory(checker);
    int sign, axis = enf_check_axis(&checker->exact, view->facet_plane[facet], &sign);
    bool same = enf_check_chain_vanishes(&checker->chain, &checker->exact, axis);
    if (count[0] == 0 || count[1] == 0 || !same || view->facet_hull[facet])
        return enf_check_break(checker, "the two sides of cut facet %d differ", (int)facet);
    return true;
}

static void check_tiling(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(
        checker, "split: tiling",
        "fine cells tile their tetrahedron's faces, and both sides of every cut: their volumes add up to it");
    for (int32_t n = 0; n < view->node_count && enf_check_holds(checker); n++) {
        int32_t facet = view->node_facet[n];
        if (facet < 0 || checker->facet_node[facet] != n) {
            enf_check_break(checker, "cut %d has no facet of its own", (int)n);
        } else {
            cut_is_matched(checker, n);
        }
        checker->row->tested++;
    }
    for (int32_t t = 0; t < view->tetrahedron_count && enf_check_holds(checker); t++, checker->row->tested++)
        tetrahedron_is_tiled(checker, t);
    for (int32_t t = 0; t < view->tetrahedron_count && enf_check_holds(checker); t++) {
        for (int k = 0; k < 4; k++) {
            int32_t next = view->tetrahedron_next[t][k], facet = checker->tetrahedron_facet[t][k];
            bool shared = next < 0;
            for (int j = 0; j < 4 && !shared; j++)
                shared = checker->tetrahedron_facet[next][j] == facet && view->tetrahedron_next[next][j] == t;
            if (!shared)
                enf_check_break(checker, "tetrahedra %d and %d do not share facet %d", (int)t, (int)next,
                                (int)facet);
        }
    }
}

// ---------------------------------------------------------------------------------------------- the trees of
// cuts

/// Walks up from a leaf: the cell lies on the right side of every cut above it.
static bool leaf_is_right(enf_checker *checker, const int32_t *parent, int32_t cell, int32_t from) {
    const enf_file_view *view = checker->view;
    int64_t first = view->face_offset[view->fine_face[cell]],
            end = view->face_offset[view->fine_face[cell + 1]];
    int32_t child = -1 - cell;
    for (int32_t node = from; node >= 0; child = node, node = parent[node]) {
        int wrong = view->node_child[node][0] == child ? 1 : -1;
        for (int64_t c = first; c < end; c++) {
            if (enf_check_side(&checker->exact, view->face_corners[c].vertex, view->node_plane[node]) ==
                wrong)
                return enf_check_break(checker, "fine cell %d lies on the wrong side of cut %d", (int)cell,
                                       (int)node);
        }
    }
    return true;
}

typedef struct tree_walk {
    int32_t *parent; ///< per node; -1: a root
    int32_t *stack;
    uint8_t *met; ///< per fine cell
} tree_walk;

static bool walk_tree(enf_checker *checker, tree_walk *walk, int32_t t) {
    const enf_file_view *view = checker->view;
    size_t depth = 0;
    int32_t root = view->tetrahedron_root[t];
    if (root >= 0) walk->parent[root] = -1;
    walk->stack[depth++] = root;
    while (depth > 0) {
        int32_t here = walk->stack[--depth];
        if (here >= 0) {
            for (int k = 0; k < 2; k++) {
                int32_t child = view->node_child[here][k];
                if (child >= 0) {
                    walk->parent[child] = here;
                    walk->stack[depth++] = child;
                    continue;
                }
                if (!leaf_is_right(checker, walk->parent, -1 - child, here)) return false;
                if (walk->met[-1 - child]++ || view->fine_tetrahedron[-1 - child] != t)
                    return enf_check_break(checker, "fine cell %d hangs in two trees, or in the wrong one",
                                           (int)(-1 - child));
            }
        } else if (walk->met[-1 - here]++ || view->fine_tetrahedron[-1 - here] != t) {
            return enf_check_break(checker, "fine cell %d hangs in two trees, or in the wrong one",
                                   (int)(-1 - here));
        }
    }
    return true;
}

static void check_trees(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "split: trees",
                    "the tree of cuts of each tetrahedron leads to its fine cells, each on its side");
    tree_walk walk = {.parent = enf_array_new((size_t)view->node_count, sizeof(int32_t)),
                      .stack = enf_array_new((size_t)view->node_count + 1, sizeof(int32_t)),
                      .met = enf_array_zeroed((size_t)view->fine_count, 1)};
    bool good = (walk.parent && walk.stack && walk.met) || enf_check_no_memory(checker);
    for (int32_t t = 0; good && t < view->tetrahedron_count; t++) good = walk_tree(checker, &walk, t);
    for (int32_t c = 0; good && c < view->fine_count; c++, checker->row->tested++) {
        if (!walk.met[c]) good = enf_check_break(checker, "fine cell %d hangs in no tree", (int)c);
    }
    free(walk.parent);
    free(walk.stack);
    free(walk.met);
}

void enf_check_split(enf_checker *checker) {
    check_cells(checker);
    if (!checker->row->held) return;
    check_tiling(checker);
    check_trees(checker);
}
