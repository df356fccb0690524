// SPDX-License-Identifier: GPL-3.0-or-later
// A binary tree first, split where the surface area heuristic says (I. Wald, "On fast construction of
// SAH-based bounding volume hierarchies", 2007), then two levels and more of it folded into nodes of four
// children, which are tested at once (M. Ernst, G. Greiner, "Multi bounding volume hierarchies", 2008).
#include "build/barrier_tree.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BIN_COUNT = 16, DEPTH_OF_HALVES = 40, WAITING_MAX = 128, WIDTH = 4 };

_Static_assert(DEPTH_OF_HALVES + 32 < ENF_FILE_BARRIER_DEPTH_MAX, "the binary tree is not too deep either");

typedef struct box {
    float min[3], max[3];
} box;

/// Of the binary tree: a range of the boxes; `right` is 0 for a single one. The left child comes next.
typedef struct branch {
    box around;
    int32_t first, count, right;
} branch;

typedef struct bin {
    box around;
    int32_t count;
} bin;

static box empty_box(void) {
    const float most = 0x1p120f;
    return (box){{most, most, most}, {-most, -most, -most}};
}

static void grow(box *around, const float min[3], const float max[3]) {
    for (int a = 0; a < 3; a++) {
        around->min[a] = min[a] < around->min[a] ? min[a] : around->min[a];
        around->max[a] = max[a] > around->max[a] ? max[a] : around->max[a];
    }
}

/// Half the surface.
static double area(const box *around) {
    double x = (double)around->max[0] - (double)around->min[0],
           y = (double)around->max[1] - (double)around->min[1],
           z = (double)around->max[2] - (double)around->min[2];
    return x * y + y * z + z * x;
}

static double middle(const enf_barrier_box *item, int axis) {
    return (double)item->min[axis] + (double)item->max[axis]; // twice
}

typedef struct cut {
    int axis, bin; ///< the last bin that goes left; axis -1: none
    double low, scale, cost;
} cut;

static int bin_of(const enf_barrier_box *item, const cut *cut) {
    int bin = (int)((middle(item, cut->axis) - cut->low) * cut->scale);
    return bin < BIN_COUNT - 1 ? bin : BIN_COUNT - 1;
}

/// Tries all borders between bins along an axis.
static void try_axis(const enf_barrier_box *items, int32_t count, int axis, cut *best) {
    double low = INFINITY, high = -INFINITY;
    for (int32_t i = 0; i < count; i++) {
        low = fmin(low, middle(&items[i], axis));
        high = fmax(high, middle(&items[i], axis));
    }
    if (!(high > low)) return;
    cut cut = {axis, 0, low, BIN_COUNT / (high - low), 0};
    bin bins[BIN_COUNT];
    for (int i = 0; i < BIN_COUNT; i++) bins[i] = (bin){empty_box(), 0};
    for (int32_t i = 0; i < count; i++) {
        bin *into = &bins[bin_of(&items[i], &cut)];
        grow(&into->around, items[i].min, items[i].max);
        into->count++;
    }
    double left_cost[BIN_COUNT];
    bin left = {empty_box(), 0}, right = {empty_box(), 0};
    for (int i = 0; i < BIN_COUNT - 1; i++) {
        grow(&left.around, bins[i].around.min, bins[i].around.max);
        left.count += bins[i].count;
        left_cost[i] = left.count ? left.count * area(&left.around) : INFINITY;
    }
    for (int i = BIN_COUNT - 2; i >= 0; i--) {
        grow(&right.around, bins[i + 1].around.min, bins[i + 1].around.max);
        right.count += bins[i + 1].count;
        cut.cost = left_cost[i] + (right.count ? right.count * area(&right.around) : INFINITY);
        cut.bin = i;
        if (cut.cost < best->cost) *best = cut;
    }
}

/// Moves what goes left to the front, all in the order that they have. Returns how many.
static int32_t part(enf_barrier_box *items, int32_t count, const cut *cut, enf_barrier_box *spare) {
    int32_t stay = 0, go = 0;
    for (int32_t i = 0; i < count; i++) {
        if (bin_of(&items[i], cut) <= cut->bin)
            items[stay++] = items[i];
        else
            spare[go++] = items[i];
    }
    memcpy(items + stay, spare, (size_t)go * sizeof *items);
    return stay;
}

static int32_t divide(enf_barrier_box *items, int32_t count, int depth, enf_barrier_box *spare) {
    cut best = {.axis = -1, .cost = INFINITY};
    for (int axis = 0; axis < 3 && depth < DEPTH_OF_HALVES; axis++) try_axis(items, count, axis, &best);
    return best.axis >= 0 ? part(items, count, &best, spare) : count / 2;
}

/// Depth first. False if it got too deep for its stack, which cannot be.
static bool make_branches(branch *branches, enf_barrier_box *items, int32_t count, enf_barrier_box *spare) {
    struct {
        int32_t first, count, parent;
        int depth;
    } waiting[WAITING_MAX];
    int waits = 0;
    int32_t made = 0;
    waiting[waits].first = 0;
    waiting[waits].count = count;
    waiting[waits].parent = -1;
    waiting[waits++].depth = 0;
    while (waits > 0) {
        waits--;
        int32_t first = waiting[waits].first, many = waiting[waits].count, parent = waiting[waits].parent;
        int depth = waiting[waits].depth;
        branch *at = &branches[made];
        if (parent >= 0) branches[parent].right = made;
        *at = (branch){empty_box(), first, many, 0};
        for (int32_t i = first; i < first + many; i++) grow(&at->around, items[i].min, items[i].max);
        int32_t here = made++;
        if (many == 1) continue;
        if (waits + 2 > WAITING_MAX) return false;
        int32_t left = divide(items + first, many, depth, spare);
        waiting[waits].first = first + left;
        waiting[waits].count = many - left;
        waiting[waits].parent = here;
        waiting[waits++].depth = depth + 1;
        waiting[waits].first = first;
        waiting[waits].count = left;
        waiting[waits].parent = -1;
        waiting[waits++].depth = depth + 1;
    }
    return true;
}

/// Up to four branches below one: opens the largest until there are four.
static int gather(const branch *branches, int32_t top, int32_t found[WIDTH]) {
    int count = 1;
    found[0] = top;
    while (count < WIDTH) {
        int open = -1;
        double largest = -1;
        for (int k = 0; k < count; k++) {
            const branch *at = &branches[found[k]];
            if (at->count == 1 || area(&at->around) <= largest) continue;
            largest = area(&at->around);
            open = k;
        }
        if (open < 0) break;
        int32_t inner = found[open];
        memmove(&found[open + 2], &found[open + 1], (size_t)(count - open - 1) * sizeof *found);
        found[open] = inner + 1;
        found[open + 1] = branches[inner].right;
        count++;
    }
    return count;
}

static void set_child(enf_file_barrier_node *node, int k, const box *around, int32_t child) {
    for (int a = 0; a < 3; a++) {
        node->bound[a][0][k] = around->min[a];
        node->bound[a][1][k] = around->max[a];
    }
    node->child[k] = child;
}

/// Breadth first: tops[n] is the branch that node n stands for.
static int32_t fold(enf_file_barrier_node *nodes, const branch *branches, int32_t *tops, int32_t first) {
    const box nothing = empty_box();
    int32_t made = 1;
    tops[0] = 0;
    for (int32_t n = 0; n < made; n++) {
        int32_t found[WIDTH];
        int count = gather(branches, tops[n], found);
        for (int k = 0; k < WIDTH; k++) {
            if (k >= count) {
                set_child(&nodes[n], k, &nothing, -1);
                continue;
            }
            const branch *at = &branches[found[k]];
            bool leaf = at->count == 1;
            set_child(&nodes[n], k, &at->around, leaf ? -2 - (first + at->first) : made);
            if (!leaf) tops[made++] = found[k];
        }
    }
    return made;
}

bool enf_barrier_tree_make(enf_barrier_tree *tree, enf_barrier_box *boxes, int32_t count, int32_t first) {
    *tree = (enf_barrier_tree){NULL, 0};
    if (count == 0) return true;
    branch *branches = enf_array_new(2 * (size_t)count, sizeof *branches);
    enf_barrier_box *spare = enf_array_new((size_t)count, sizeof *spare);
    int32_t *tops = enf_array_new((size_t)count, sizeof *tops);
    enf_file_barrier_node *nodes = enf_array_new((size_t)count, sizeof *nodes);
    bool good = branches && spare && tops && nodes && make_branches(branches, boxes, count, spare);
    if (good) {
        tree->node_count = fold(nodes, branches, tops, first);
        tree->nodes = nodes;
    } else {
        free(nodes);
    }
    free(branches);
    free(spare);
    free(tops);
    return good;
}
