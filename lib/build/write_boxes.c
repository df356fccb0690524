// SPDX-License-Identifier: GPL-3.0-or-later
// A hierarchy of boxes around the tetrahedra for point location, halved at the median of the longest side (J.
// Goldsmith, J. Salmon, "Automatic creation of object hierarchies for ray tracing", 1987, is the origin of
// such trees) and laid out depth first, so that a walk needs no stack.
//
// The tetrahedra are sorted along each axis once, and the three orders are kept through all halvings (as J.
// L. Bentley presorts for k-d trees): the ends of a stretch then give its sides, its middle the median, and a
// halving is one pass without a comparison.
#include "build/write_parts.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DIGIT_BITS = 11, DIGIT_COUNT = 6, DIGIT_VALUES = 1 << DIGIT_BITS }; ///< of 64-bit keys

typedef struct orders {
    int32_t count;
    double (*middles)[3]; ///< twice the middle of each tetrahedron's box
    int32_t *order[3];    ///< stretch by stretch the same tetrahedra, by middles, then by number
    int32_t *spare;       ///< as long; also while sorting
    uint8_t *is_later;    ///< per tetrahedron: 1 if it goes to the second half of its stretch
} orders;

static double smaller(double a, double b) {
    return a < b ? a : b;
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

/// With room for a caller's rounding.
static void tetrahedron_box(const enf_file_view *view, int32_t tetrahedron, double low[3], double high[3]) {
    const int32_t *corners = view->tetrahedra[tetrahedron];
    const double *p = view->points[corners[0]], *q = view->points[corners[1]], *r = view->points[corners[2]],
                 *s = view->points[corners[3]];
    for (int a = 0; a < 3; a++) {
        low[a] = smaller(smaller(p[a], q[a]), smaller(r[a], s[a])) - view->frame->locate_rounding;
        high[a] = larger(larger(p[a], q[a]), larger(r[a], s[a])) + view->frame->locate_rounding;
    }
}

// --- Sorting
// -----------------------------------------------------------------------------------------------------

/// A whole number in the order of the doubles.
static uint64_t sort_key(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

/// Keys with the tetrahedra that they belong to.
typedef struct sort_list {
    uint64_t *keys;
    int32_t *items;
} sort_list;

/// One pass of a radix sort (Knuth, The Art of Computer Programming 3, 5.2.5). False if all digits are the
/// same, and nothing was moved.
static bool sort_digit(const sort_list *from, sort_list *to, int32_t count, int shift) {
    int32_t place[DIGIT_VALUES] = {0}, sum = 0;
    for (int32_t i = 0; i < count; i++) place[from->keys[i] >> shift & (DIGIT_VALUES - 1)]++;
    if (place[from->keys[0] >> shift & (DIGIT_VALUES - 1)] == count) return false;
    for (int32_t d = 0; d < DIGIT_VALUES; d++) {
        int32_t many = place[d];
        place[d] = sum;
        sum += many;
    }
    for (int32_t i = 0; i < count; i++) {
        int32_t at = place[from->keys[i] >> shift & (DIGIT_VALUES - 1)]++;
        to->keys[at] = from->keys[i];
        to->items[at] = from->items[i];
    }
    return true;
}

/// Sorts the tetrahedra along an axis; the keys are working memory for twice as many.
static void sort_axis(orders *orders, int axis, uint64_t *keys) {
    int32_t count = orders->count, *order = orders->order[axis];
    sort_list lists[2] = {{keys, order}, {keys + count, orders->spare}};
    for (int32_t i = 0; i < count; i++) {
        keys[i] = sort_key(orders->middles[i][axis]);
        order[i] = i;
    }
    int now = 0;
    for (int d = 0; d < DIGIT_COUNT; d++)
        if (sort_digit(&lists[now], &lists[1 - now], count, d * DIGIT_BITS)) now = 1 - now;
    if (lists[now].items != order) memcpy(order, lists[now].items, (size_t)count * sizeof *order);
}

static bool make_orders(orders *orders, const enf_file_view *view) {
    size_t count = (size_t)view->tetrahedron_count;
    orders->count = view->tetrahedron_count;
    orders->middles = enf_array_new(count, sizeof *orders->middles);
    orders->spare = enf_array_new(count, sizeof *orders->spare);
    bool good = orders->middles && orders->spare;
    for (int a = 0; a < 3; a++)
        good = (orders->order[a] = enf_array_new(count, sizeof **orders->order)) != NULL && good;
    uint64_t *keys = enf_array_new(2 * count, sizeof *keys);
    good = good && keys;
    for (int32_t i = 0; good && i < orders->count; i++) {
        double low[3], high[3];
        tetrahedron_box(view, i, low, high);
        for (int a = 0; a < 3; a++) orders->middles[i][a] = low[a] + high[a];
    }
    for (int a = 0; good && a < 3; a++) sort_axis(orders, a, keys);
    free(keys);
    return good && (orders->is_later = enf_array_new(count, sizeof *orders->is_later)) != NULL;
}

static void free_orders(orders *orders) {
    free(orders->middles);
    for (int a = 0; a < 3; a++) free(orders->order[a]);
    free(orders->spare);
    free(orders->is_later);
}

// --- Halving
// -----------------------------------------------------------------------------------------------------

static int longest_axis(const orders *orders, int32_t first, int32_t count) {
    int axis = 0;
    double longest = -1;
    for (int a = 0; a < 3; a++) {
        const int32_t *order = orders->order[a] + first;
        double side = orders->middles[order[count - 1]][a] - orders->middles[order[0]][a];
        if (side > longest) {
            longest = side;
            axis = a;
        }
    }
    return axis;
}

/// Moves the later ones of a stretch behind the others, both in the order that they have.
static void part(const orders *orders, int32_t *stretch, int32_t count) {
    int32_t stay = 0, go = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t item = stretch[i], later = orders->is_later[item];
        stretch[stay] = item;
        orders->spare[go] = item;
        stay += 1 - later;
        go += later;
    }
    memcpy(stretch + stay, orders->spare, (size_t)go * sizeof *stretch);
}

/// Afterwards each order has the `half` first along the axis before the rest.
static void halve(const orders *orders, int32_t first, int32_t count, int32_t half, int axis) {
    const int32_t *along = orders->order[axis] + first;
    for (int32_t i = 0; i < half; i++) orders->is_later[along[i]] = 0;
    for (int32_t i = half; i < count; i++) orders->is_later[along[i]] = 1;
    part(orders, orders->order[(axis + 1) % 3] + first, count);
    part(orders, orders->order[(axis + 2) % 3] + first, count);
}

// --- The boxes
// ---------------------------------------------------------------------------------------------------

static float round_down(double value) {
    float rounded = (float)value;
    return (double)rounded > value ? nextafterf(rounded, -INFINITY) : rounded;
}

static float round_up(double value) {
    float rounded = (float)value;
    return (double)rounded < value ? nextafterf(rounded, INFINITY) : rounded;
}

static void fill_leaf(enf_file_box *box, const enf_file_view *view, int32_t tetrahedron) {
    double low[3], high[3];
    tetrahedron_box(view, tetrahedron, low, high);
    box->tetrahedron = tetrahedron;
    for (int a = 0; a < 3; a++) {
        box->min[a] = round_down(low[a]);
        box->max[a] = round_up(high[a]);
    }
}

/// A subtree of n leaves takes 2n - 1 nodes, so every place is known beforehand.
static void lay_out(enf_file_box *boxes, const enf_file_view *view, const orders *orders) {
    struct {
        int32_t node, first, count;
    } waiting[64]; // halves: at most one waits per level, 31 levels
    int depth = 0;
    waiting[depth].node = waiting[depth].first = 0;
    waiting[depth++].count = orders->count;
    while (depth > 0) {
        depth--;
        int32_t node = waiting[depth].node, first = waiting[depth].first, many = waiting[depth].count;
        boxes[node].next = node + 2 * many - 1;
        boxes[node].tetrahedron = -1;
        if (many == 1) {
            fill_leaf(&boxes[node], view, orders->order[0][first]);
            continue;
        }
        int32_t half = many / 2;
        halve(orders, first, many, half, longest_axis(orders, first, many));
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
    int32_t box_count = 2 * view->tetrahedron_count - 1;
    orders orders = {0};
    enf_file_box *boxes = enf_build_image_new(image, (size_t)box_count, sizeof *boxes);
    bool good = boxes && make_orders(&orders, view);
    if (good) lay_out(boxes, view, &orders);
    free_orders(&orders);
    if (!good) return enf_fail_memory(error, "the boxes for point location");
    close_inner_boxes(boxes, box_count);
    view->boxes = boxes;
    view->box_count = box_count;
    return ENF_OK;
}
