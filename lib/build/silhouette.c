// SPDX-License-Identifier: GPL-3.0-or-later
// The exact area of a silhouette, by a plane sweep over slabs (Bentley and Ottmann, 1979, without their
// tree).
//
// Between two neighbouring edge ends (a slab) every active edge runs from the left to the right border.
// Sorted by height, the edges fall into blocks: within a block edges cross, blocks don't. A block of one edge
// is a term of the sum right away; a larger one is cut at its crossings. The covered height at x is the sum
// over the edges of -y for one that opens the covered part, +y for one that closes it.
//
// A large figure is cut into horizontal bands first, each with a sweep of its own, so that few edges are
// active at a time. What lies below a band acts on it only through the winding number along its lower border.
#include "build/silhouette.h"

#include <math.h>
#include <stdlib.h>

#include "base/array.h"

/// Only the time depends on these: edges in a block that is halved, how often, and bands per square root of
/// the edges; moves of a sort by insertion before qsort takes over.
enum { LARGE_BLOCK = 24, MOST_HALVINGS = 12, BAND_DIVISOR = 2, MOVES_PER_ELEMENT = 16 };

typedef struct enf_slab_edge {
    double left, right; ///< height at the borders of the slab
    const enf_contour_edge *edge;
} slab_edge;

typedef struct enf_slab_height {
    double height; ///< halfway between two crossings
    const slab_edge *edge;
} enf_slab_height;

void enf_silhouette_free(enf_silhouette *work) {
    free(work->edges);
    free(work->parts);
    free(work->turns);
    free(work->events);
    free(work->active);
    free(work->crossings);
    free(work->order);
    free(work->lowest);
    *work = (enf_silhouette){0};
}

void enf_silhouette_clear(enf_silhouette *work) {
    work->edge_count = 0;
}

bool enf_silhouette_add(enf_silhouette *work, const double a[2], const double b[2], int32_t times) {
    if (!enf_array_reserve(work->edges, work->edge_capacity, work->edge_count + 1)) return false;
    enf_contour_edge *edge = &work->edges[work->edge_count++];
    if (a[0] <= b[0])
        *edge = (enf_contour_edge){a[0], a[1], b[0], b[1], times};
    else
        *edge = (enf_contour_edge){b[0], b[1], a[0], a[1], -times};
    return true;
}

static int compare_doubles(double a, double b) {
    return (a > b) - (a < b);
}

static int compare_edges(const void *first, const void *second) {
    const enf_contour_edge *a = first, *b = second;
    int order = compare_doubles(a->x0, b->x0);
    if (!order) order = compare_doubles(a->y0, b->y0);
    if (!order) order = compare_doubles(a->x1, b->x1);
    if (!order) order = compare_doubles(a->y1, b->y1);
    return order ? order : (a->rise > b->rise) - (a->rise < b->rise);
}

static int compare_events(const void *first, const void *second) {
    return compare_doubles(*(const double *)first, *(const double *)second);
}

static int compare_turns(const void *first, const void *second) {
    const enf_border_turn *a = first, *b = second;
    int order = compare_doubles(a->x, b->x);
    return order ? order : (a->change > b->change) - (a->change < b->change);
}

/// Sorts by insertion: most lists are short, or nearly sorted. What takes too many moves goes to qsort; equal
/// elements are equal to the last bit, so the result is the same.
#define DEFINE_SORT(name, type, is_less, compare)                                               \
    static void name(type *list, size_t count) {                                                \
        size_t moves = 0, allowed = MOVES_PER_ELEMENT * count;                                  \
        for (size_t i = 1; i < count && moves <= allowed; ++i) {                                \
            if (!is_less(&list[i], &list[i - 1])) continue;                                     \
            type moved = list[i];                                                               \
            size_t j = i;                                                                       \
            for (; j > 0 && is_less(&moved, &list[j - 1]); --j, ++moves) list[j] = list[j - 1]; \
            list[j] = moved;                                                                    \
        }                                                                                       \
        if (moves > allowed) qsort(list, count, sizeof *list, compare);                         \
    }

static inline bool edge_less(const enf_contour_edge *a, const enf_contour_edge *b) {
    return a->x0 != b->x0 ? a->x0 < b->x0 : compare_edges(a, b) < 0;
}

static inline bool event_less(const double *a, const double *b) {
    return *a < *b;
}

static inline bool turn_less(const enf_border_turn *a, const enf_border_turn *b) {
    return a->x != b->x ? a->x < b->x : a->change < b->change;
}

DEFINE_SORT(sort_contour, enf_contour_edge, edge_less, compare_edges)
DEFINE_SORT(sort_events, double, event_less, compare_events)
DEFINE_SORT(sort_turns, enf_border_turn, turn_less, compare_turns)

/// Sorts the edges, drops those with an end that is no number, and finds how high the figure reaches.
static void prepare(enf_silhouette *work, double *low, double *high) {
    size_t kept = 0;
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t i = 0; i < work->edge_count; ++i) {
        const enf_contour_edge *edge = &work->edges[i];
        if (edge->rise == 0 || !isfinite(edge->x0) || !isfinite(edge->x1) || !isfinite(edge->y0) ||
            !isfinite(edge->y1))
            continue;
        *low = fmin(*low, fmin(edge->y0, edge->y1));
        *high = fmax(*high, fmax(edge->y0, edge->y1));
        work->edges[kept++] = *edge;
    }
    work->edge_count = kept;
    sort_contour(work->edges, kept);
}

/// Where an edge crosses the height y.
static double crossing_at(const enf_contour_edge *edge, double y) {
    double x = edge->x0 + (edge->x1 - edge->x0) * ((y - edge->y0) / (edge->y1 - edge->y0));
    return fmin(fmax(x, edge->x0), edge->x1);
}

/// Collects the parts of the edges within the band, the turns of the winding number along its lower border,
/// and the borders of all slabs.
static bool fill_band(enf_silhouette *work, double low, double high, size_t *event_count) {
    if (!enf_array_reserve(work->parts, work->part_capacity, work->edge_count) ||
        !enf_array_reserve(work->turns, work->turn_capacity, work->edge_count) ||
        !enf_array_reserve(work->events, work->event_capacity, 3 * work->edge_count))
        return false;
    size_t events = 0;
    work->part_count = work->turn_count = 0;
    for (size_t i = 0; i < work->edge_count; ++i) {
        enf_contour_edge part = work->edges[i];
        const enf_contour_edge *edge = &work->edges[i];
        if ((edge->y0 < low && edge->y1 < low) || (edge->y0 > high && edge->y1 > high)) continue;
        if ((edge->y0 < low) != (edge->y1 < low)) {
            double x = crossing_at(edge, low);
            work->turns[work->turn_count++] =
                (enf_border_turn){x, edge->y1 > edge->y0 ? -edge->rise : edge->rise};
            work->events[events++] = x;
            if (edge->y0 < low) part.x0 = x, part.y0 = low;
            if (edge->y1 < low) part.x1 = x, part.y1 = low;
        }
        if ((edge->y0 > high) != (edge->y1 > high)) {
            double x = crossing_at(edge, high);
            if (edge->y0 > high) part.x0 = x, part.y0 = high;
            if (edge->y1 > high) part.x1 = x, part.y1 = high;
        }
        if (!(part.x0 < part.x1)) continue;
        work->parts[work->part_count++] = part;
        work->events[events++] = part.x0;
        work->events[events++] = part.x1;
    }
    *event_count = 0;
    if (events == 0) return true;
    sort_contour(work->parts, work->part_count);
    sort_turns(work->turns, work->turn_count);
    sort_events(work->events, events);
    for (size_t i = 0; i < events; ++i)
        if (*event_count == 0 || work->events[i] != work->events[*event_count - 1])
            work->events[(*event_count)++] = work->events[i];
    return true;
}

static double height_at(const enf_contour_edge *edge, double x) {
    if (x >= edge->x1) return edge->y1;
    if (x <= edge->x0) return edge->y0;
    return edge->y0 + (edge->y1 - edge->y0) * ((x - edge->x0) / (edge->x1 - edge->x0));
}

static bool lower(const slab_edge *a, const slab_edge *b) {
    return a->left != b->left ? a->left < b->left : a->right < b->right;
}

/// Insertion sort: from slab to slab the order changes little.
static void sort_edges(slab_edge *edges, size_t count) {
    for (size_t i = 1; i < count; ++i) {
        if (!lower(&edges[i], &edges[i - 1])) continue;
        slab_edge moved = edges[i];
        size_t j = i;
        for (; j > 0 && lower(&moved, &edges[j - 1]); --j) edges[j] = edges[j - 1];
        edges[j] = moved;
    }
}

static void sort_heights(enf_slab_height *heights, size_t count) {
    for (size_t i = 1; i < count; ++i) {
        enf_slab_height moved = heights[i];
        size_t j = i;
        for (; j > 0 && moved.height < heights[j - 1].height; --j) heights[j] = heights[j - 1];
        heights[j] = moved;
    }
}

/// The factor of the edge's height in the covered height, with the winding number brought up to date.
static int factor_of(const slab_edge *edge, int64_t *winding) {
    bool below = *winding > 0;
    *winding += edge->edge->rise;
    return (int)below - (int)(*winding > 0);
}

static bool collect_crossings(enf_silhouette *work, const slab_edge *block, size_t count,
                              size_t *crossing_count) {
    size_t found = 0;
    for (size_t i = 0; i < count; ++i)
        for (size_t j = i + 1; j < count; ++j) {
            double before = block[j].left - block[i].left, after = block[i].right - block[j].right;
            if (!(after > 0)) continue;
            double at = before / (before + after);
            if (!(at > 0 && at < 1)) continue;
            if (!enf_array_reserve(work->crossings, work->crossing_capacity, found + 2)) return false;
            work->crossings[found++] = at;
        }
    if (!enf_array_reserve(work->crossings, work->crossing_capacity, found + 1)) return false;
    work->crossings[found++] = 1;
    sort_events(work->crossings, found);
    *crossing_count = found;
    return true;
}

/// Adds the mean covered height of a block whose edges cross within the slab.
static bool add_block(enf_silhouette *work, const slab_edge *block, size_t count, int64_t *winding,
                      double *mean) {
    size_t crossing_count;
    if (!collect_crossings(work, block, count, &crossing_count)) return false;
    if (!enf_array_reserve(work->order, work->order_capacity, count)) return false;
    enf_slab_height *order = work->order;
    for (size_t i = 0; i < count; ++i) order[i].edge = &block[i];
    double from = 0;
    int64_t after = *winding;
    for (size_t c = 0; c < crossing_count; ++c) {
        double to = work->crossings[c], middle = (from + to) / 2;
        if (!(to > from)) continue;
        for (size_t i = 0; i < count; ++i)
            order[i].height = order[i].edge->left + (order[i].edge->right - order[i].edge->left) * middle;
        sort_heights(order, count);
        after = *winding;
        double height = 0;
        for (size_t i = 0; i < count; ++i) height += factor_of(order[i].edge, &after) * order[i].height;
        *mean += height * (to - from);
        from = to;
    }
    *winding = after;
    return true;
}

/// Where the block that begins with an active edge ends: no edge from there on gets below one of the block.
static size_t block_end(const enf_silhouette *work, size_t begin, size_t count) {
    double highest = work->active[begin].right;
    size_t end = begin + 1;
    for (; end < count && highest > work->lowest[end]; ++end)
        highest = fmax(highest, work->active[end].right);
    return end;
}

/// Adds the mean covered height of the slab; `winding` is the winding number at its lower border.
static bool add_slab(enf_silhouette *work, size_t count, int64_t winding, const double band[2],
                     double *mean) {
    const slab_edge *active = work->active;
    if (winding > 0) *mean -= band[0];
    for (size_t begin = 0, end; begin < count; begin = end) {
        end = block_end(work, begin, count);
        if (end == begin + 1) {
            int factor = factor_of(&active[begin], &winding);
            *mean += factor * ((active[begin].left + active[begin].right) / 2);
        } else if (!add_block(work, active + begin, end - begin, &winding, mean)) {
            return false;
        }
    }
    if (winding > 0) *mean += band[1];
    return true;
}

/// At the left border of a slab: ended edges leave, others go on at the height that they had reached, new
/// ones come in.
static bool enter_slab(enf_silhouette *work, double from, size_t *count, size_t *next) {
    size_t kept = 0;
    for (size_t i = 0; i < *count; ++i)
        if (work->active[i].edge->x1 > from) {
            work->active[kept] = work->active[i];
            work->active[kept].left = work->active[kept].right;
            ++kept;
        }
    for (; *next < work->part_count && work->parts[*next].x0 <= from; ++*next) {
        if (!enf_array_reserve(work->active, work->active_capacity, kept + 1)) return false;
        const enf_contour_edge *edge = &work->parts[*next];
        work->active[kept++] = (slab_edge){.left = edge->y0, .edge = edge};
    }
    *count = kept;
    return enf_array_reserve(work->lowest, work->lowest_capacity, kept + 1);
}

/// Lets the active edges run up to `to`, sorts them, and returns the size of the largest block.
static size_t run_edges(enf_silhouette *work, double to, size_t count) {
    for (size_t i = 0; i < count; ++i) work->active[i].right = height_at(work->active[i].edge, to);
    sort_edges(work->active, count);
    work->lowest[count] = INFINITY;
    for (size_t i = count; i-- > 0;) work->lowest[i] = fmin(work->active[i].right, work->lowest[i + 1]);
    size_t largest = 0;
    for (size_t begin = 0, end; begin < count; begin = end) {
        end = block_end(work, begin, count);
        if (end - begin > largest) largest = end - begin;
    }
    return largest;
}

/// Adds the covered area of a band.
static bool add_band(enf_silhouette *work, const double band[2], double *area) {
    size_t event_count, count = 0, next = 0, turn = 0;
    int64_t winding = 0;
    if (!fill_band(work, band[0], band[1], &event_count)) return false;
    for (size_t i = 0; i + 1 < event_count; ++i) {
        double from = work->events[i];
        for (; turn < work->turn_count && work->turns[turn].x <= from; ++turn)
            winding += work->turns[turn].change;
        while (from < work->events[i + 1]) {
            double to = work->events[i + 1], mean = 0;
            if (!enter_slab(work, from, &count, &next)) return false;
            // A block costs the cube of its size: halve the slab until no block is large.
            for (int halvings = 0; run_edges(work, to, count) > LARGE_BLOCK && halvings < MOST_HALVINGS;
                 ++halvings) {
                double middle = from + (to - from) / 2;
                if (!(from < middle && middle < to)) break;
                to = middle;
            }
            if (!add_slab(work, count, winding, band, &mean)) return false;
            *area += mean * (to - from);
            from = to;
        }
    }
    return true;
}

bool enf_silhouette_area(enf_silhouette *work, double *area) {
    *area = 0;
    double low, high;
    prepare(work, &low, &high);
    if (work->edge_count == 0) return true;
    int bands = 1 + (int)(sqrt((double)work->edge_count) / BAND_DIVISOR);
    for (int i = 0; i < bands; ++i) {
        double band[2] = {low + (high - low) * ((double)i / bands),
                          low + (high - low) * ((double)(i + 1) / bands)};
        if (i == bands - 1) band[1] = high;
        if (!add_band(work, band, area)) return false;
    }
    work->edge_count = 0;
    return true;
}
