// SPDX-License-Identifier: GPL-3.0-or-later
// A hierarchy of boxes around the tetrahedra, for point location where no walk helps. Tetrahedra stand along
// a space-filling curve (tet_order.h), so those with neighbouring numbers are near each other, and a
// hierarchy is made of them by halving ranges of numbers (as C. Lauterbach et al., "Fast BVH construction on
// GPUs", 2009, do along Morton's curve): nothing is sorted. It is laid out depth first, so that a walk needs
// no stack.
#include "build/write_parts.h"

#include <math.h>

enum { LEAF = ENF_FILE_BOX_TETRAHEDRA, LEVELS_MAX = 32 };

static double smaller(double a, double b) {
    return a < b ? a : b;
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

static float round_down(double value) {
    float rounded = (float)value;
    return (double)rounded > value ? nextafterf(rounded, -INFINITY) : rounded;
}

static float round_up(double value) {
    float rounded = (float)value;
    return (double)rounded < value ? nextafterf(rounded, INFINITY) : rounded;
}

/// Around the leaf's tetrahedra, with room for a caller's rounding.
static void fill_leaf(enf_file_box *box, const enf_file_view *view) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    const int32_t end = enf_file_box_end(box, view->tetrahedron_count);
    for (int32_t t = box->tetrahedron; t < end; t++) {
        for (int i = 0; i < 4; i++) {
            const double *p = view->points[view->tetrahedra[t][i]];
            for (int a = 0; a < 3; a++) {
                low[a] = smaller(low[a], p[a]);
                high[a] = larger(high[a], p[a]);
            }
        }
    }
    for (int a = 0; a < 3; a++) {
        box->min[a] = round_down(low[a] - view->frame->locate_rounding);
        box->max[a] = round_up(high[a] + view->frame->locate_rounding);
    }
}

/// A subtree of n leaves takes 2n - 1 nodes, so every place is known beforehand.
static void lay_out(enf_file_box *boxes, const enf_file_view *view, int32_t leafs) {
    struct {
        int32_t node, first, count;
    } waiting[LEVELS_MAX]; // halves: at most one waits per level
    int depth = 0;
    waiting[depth].node = waiting[depth].first = 0;
    waiting[depth++].count = leafs;
    while (depth > 0) {
        depth--;
        int32_t node = waiting[depth].node, first = waiting[depth].first, many = waiting[depth].count;
        boxes[node].next = node + 2 * many - 1;
        boxes[node].tetrahedron = many == 1 ? first * LEAF : -1;
        if (many == 1) {
            fill_leaf(&boxes[node], view);
            continue;
        }
        int32_t half = many / 2;
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
            boxes[i].min[a] = left->min[a] < right->min[a] ? left->min[a] : right->min[a];
            boxes[i].max[a] = left->max[a] > right->max[a] ? left->max[a] : right->max[a];
        }
    }
}

enf_status enf_build_image_boxes(enf_build_image *image, enf_error *error) {
    enf_file_view *view = &image->view;
    if (view->tetrahedron_count == 0) return ENF_OK;
    int32_t leafs = (view->tetrahedron_count - 1) / LEAF + 1, box_count = 2 * leafs - 1;
    enf_file_box *boxes = enf_build_image_new(image, (size_t)box_count, sizeof *boxes);
    if (!boxes) return enf_fail_memory(error, "the boxes for point location");
    lay_out(boxes, view, leafs);
    close_inner_boxes(boxes, box_count);
    view->boxes = boxes;
    view->box_count = box_count;
    return ENF_OK;
}
