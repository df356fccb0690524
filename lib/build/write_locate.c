// SPDX-License-Identifier: GPL-3.0-or-later
// What point location needs: the neighbours of each tetrahedron, for walks, and a hierarchy of boxes around
// them, halved at the median of the longest side (J. Goldsmith, J. Salmon, "Automatic creation of object
// hierarchies for ray tracing", 1987, is the origin of such trees) and laid out depth first, so that a walk
// needs no stack.
#include "build/write_parts.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>

/// A face of a tetrahedron, less its smallest corner.
typedef struct face_key {
    int32_t corner[2]; ///< the others, ascending
    int32_t face;      ///< 4 * tetrahedron + the opposite corner
} face_key;

/// The corners of a face, ascending.
static void take_face(const enf_file_view *view, int32_t face, int32_t corner[3]) {
    const int32_t *corners = view->tetrahedra[face / 4];
    for (int k = 0, n = 0; k < 4; k++) {
        if (k == face % 4) continue;
        int i = n++;
        for (; i > 0 && corner[i - 1] > corners[k]; i--) corner[i] = corner[i - 1];
        corner[i] = corners[k];
    }
}

static int compare_keys(const void *a, const void *b) {
    const face_key *p = a, *q = b;
    for (int k = 0; k < 2; k++) {
        if (p->corner[k] != q->corner[k]) return p->corner[k] < q->corner[k] ? -1 : 1;
    }
    return (p->face > q->face) - (p->face < q->face);
}

/// All faces in lists by their smallest corner: *first (a place per point and one more) and *faces, both to
/// be freed. False without memory.
static bool list_faces(const enf_file_view *view, int32_t **first, int32_t **faces) {
    int32_t count = 4 * view->tetrahedron_count, corner[3];
    *first = enf_array_zeroed((size_t)view->point_count + 2, sizeof **first);
    *faces = enf_array_new((size_t)count, sizeof **faces);
    if (!*first || !*faces) return false;
    int32_t *place = *first + 1; // shifted by one while filling
    for (int32_t i = 0; i < count; i++) {
        take_face(view, i, corner);
        place[corner[0] + 1]++;
    }
    for (int32_t p = 0; p < view->point_count; p++) place[p + 1] += place[p];
    for (int32_t i = 0; i < count; i++) {
        take_face(view, i, corner);
        (*faces)[place[corner[0]]++] = i;
    }
    return true;
}

/// Pairs the faces of one list.
static void pair_faces(const enf_file_view *view, const int32_t *faces, size_t count, face_key *keys,
                       int32_t (*next)[4]) {
    for (size_t i = 0; i < count; i++) {
        int32_t corner[3];
        take_face(view, faces[i], corner);
        keys[i] = (face_key){{corner[1], corner[2]}, faces[i]};
    }
    qsort(keys, count, sizeof *keys, compare_keys);
    for (size_t i = 1; i < count; i++) {
        const face_key *p = &keys[i - 1], *q = &keys[i];
        if (p->corner[0] != q->corner[0] || p->corner[1] != q->corner[1]) continue;
        next[p->face / 4][p->face % 4] = q->face / 4;
        next[q->face / 4][q->face % 4] = p->face / 4;
    }
}

/// Pairs the faces with the same three corners.
static enf_status make_neighbours(enf_image *image, enf_error *error) {
    enf_file_view *view = &image->view;
    size_t count = (size_t)view->tetrahedron_count, capacity = 0;
    if (count > INT32_MAX / 4) return enf_fail(error, ENF_NO_RESOURCES, "too many tetrahedra for one file");
    int32_t(*next)[4] = enf_image_new(image, count, sizeof *next);
    int32_t *first = NULL, *faces = NULL;
    face_key *keys = NULL;
    bool good = next && list_faces(view, &first, &faces);
    for (size_t i = 0; good && i < count; i++) next[i][0] = next[i][1] = next[i][2] = next[i][3] = -1;
    for (int32_t p = 0; good && p < view->point_count; p++) {
        size_t many = (size_t)(first[p + 1] - first[p]);
        good = enf_array_reserve(keys, capacity, many);
        if (good && many > 1) pair_faces(view, faces + first[p], many, keys, next);
    }
    free(first);
    free(faces);
    free(keys);
    if (!good) return enf_fail_memory(error, "the neighbours of tetrahedra");
    view->tetrahedron_next = (void *)next;
    return ENF_OK;
}

/// A tetrahedron's box, and what it is sorted by.
typedef struct item {
    double low[3], high[3];
    int32_t tetrahedron;
} item;

static double middle(const item *at, int axis) {
    return at->low[axis] + at->high[axis];
}

static bool comes_before(const item *a, const item *b, int axis) {
    double u = middle(a, axis), v = middle(b, axis);
    return u < v || (u == v && a->tetrahedron < b->tetrahedron);
}

static void swap_items(item *a, item *b) {
    item keep = *a;
    *a = *b;
    *b = keep;
}

/// Hoare's selection: afterwards the `half` first items come before the rest. All items differ, so the result
/// as two sets does not depend on the pivots.
static void select_half(item *items, int32_t count, int32_t half, int axis) {
    int32_t low = 0, high = count - 1;
    while (low < high) {
        item pivot = items[low + (high - low) / 2];
        int32_t i = low, k = high;
        while (i <= k) {
            while (comes_before(&items[i], &pivot, axis)) i++;
            while (comes_before(&pivot, &items[k], axis)) k--;
            if (i <= k) swap_items(&items[i++], &items[k--]);
        }
        if (half <= k)
            high = k;
        else if (half >= i)
            low = i;
        else
            return;
    }
}

static int longest_axis(const item *items, int32_t count) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int32_t i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], middle(&items[i], a));
            high[a] = fmax(high[a], middle(&items[i], a));
        }
    }
    int axis = 0;
    for (int a = 1; a < 3; a++) {
        if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
    }
    return axis;
}

static float round_down(double value) {
    float rounded = (float)value;
    return (double)rounded > value ? nextafterf(rounded, -INFINITY) : rounded;
}

static float round_up(double value) {
    float rounded = (float)value;
    return (double)rounded < value ? nextafterf(rounded, INFINITY) : rounded;
}

/// A subtree of n leaves takes 2n - 1 nodes, so every place is known beforehand.
static void lay_out(enf_file_box *boxes, item *items, int32_t count) {
    struct {
        int32_t node, first, count;
    } waiting[64]; // halves: at most one waits per level, 31 levels
    int depth = 0;
    waiting[depth].node = waiting[depth].first = 0;
    waiting[depth++].count = count;
    while (depth > 0) {
        depth--;
        int32_t node = waiting[depth].node, first = waiting[depth].first, many = waiting[depth].count;
        enf_file_box *box = &boxes[node];
        box->next = node + 2 * many - 1;
        box->tetrahedron = -1;
        if (many == 1) {
            box->tetrahedron = items[first].tetrahedron;
            for (int a = 0; a < 3; a++) {
                box->min[a] = round_down(items[first].low[a]);
                box->max[a] = round_up(items[first].high[a]);
            }
            continue;
        }
        int32_t half = many / 2;
        select_half(items + first, many, half, longest_axis(items + first, many));
        waiting[depth].node = node + 2 * half;
        waiting[depth].first = first + half;
        waiting[depth++].count = many - half;
        waiting[depth].node = node + 1;
        waiting[depth].first = first;
        waiting[depth++].count = half;
    }
}

static void close_inner_boxes(enf_file_box *boxes, int32_t count) {
    for (int32_t i = count - 1; i >= 0; i--) {
        if (boxes[i].tetrahedron >= 0) continue;
        const enf_file_box *left = &boxes[i + 1], *right = &boxes[left->next];
        for (int a = 0; a < 3; a++) {
            boxes[i].min[a] = fminf(left->min[a], right->min[a]);
            boxes[i].max[a] = fmaxf(left->max[a], right->max[a]);
        }
    }
}

static enf_status make_boxes(enf_image *image, enf_error *error) {
    enf_file_view *view = &image->view;
    int32_t count = view->tetrahedron_count;
    if (count == 0) return ENF_OK;
    item *items = enf_array_new((size_t)count, sizeof *items);
    enf_file_box *boxes = enf_image_new(image, 2 * (size_t)count - 1, sizeof *boxes);
    if (!items || !boxes) {
        free(items);
        return enf_fail_memory(error, "the boxes for point location");
    }
    for (int32_t i = 0; i < count; i++) {
        items[i].tetrahedron = i;
        for (int a = 0; a < 3; a++) {
            double low = INFINITY, high = -INFINITY;
            for (int k = 0; k < 4; k++) {
                low = fmin(low, view->points[view->tetrahedra[i][k]][a]);
                high = fmax(high, view->points[view->tetrahedra[i][k]][a]);
            }
            items[i].low[a] = low - view->frame->locate_rounding;
            items[i].high[a] = high + view->frame->locate_rounding;
        }
    }
    lay_out(boxes, items, count);
    free(items);
    close_inner_boxes(boxes, 2 * count - 1);
    view->boxes = boxes;
    view->box_count = 2 * count - 1;
    return ENF_OK;
}

enf_status enf_image_locate(enf_image *image, enf_error *error) {
    enf_status status = make_neighbours(image, error);
    return status ? status : make_boxes(image, error);
}
