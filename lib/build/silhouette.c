// SPDX-License-Identifier: GPL-3.0-or-later
// The exact area of a silhouette, by a plane sweep over slabs (Bentley and Ottmann, 1979, without their
// tree).
//
// Between two neighbouring edge ends (a slab) every active edge runs from the left to the right border.
// Sorted by height, the edges fall into blocks: within a block edges cross, blocks don't. A block of one edge
// is a term of the sum right away; a larger one is cut at its crossings. The covered height at x is the sum
// over the edges of -y for one that opens the covered part, +y for one that closes it.
//
// A large figure is cut into horizontal bands first, each with a list of its edges and a sweep of its own, so
// that few edges are active at a time. What lies below a band acts on it only through the winding number
// along its lower border.
#include "build/silhouette.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

/// Only the time depends on these: edges in a block that is halved, how often, bands per square root of the
/// edges, and edges that need no bands; moves of a sort by insertion before qsort takes over.
enum { LARGE_BLOCK = 4, MOST_HALVINGS = 12, BAND_DIVISOR = 4, FEW_EDGES = 128, MOVES_PER_ELEMENT = 16 };

typedef struct enf_slab_edge {
    double left, right; ///< height at the borders of the slab
    double slope;
    const enf_contour_edge *edge;
} slab_edge;

typedef struct enf_slab_height {
    double height; ///< halfway between two crossings
    const slab_edge *edge;
} enf_slab_height;

void enf_silhouette_free(enf_silhouette *work) {
    free(work->edges);
    free(work->borders);
    free(work->bucket_first);
    free(work->ordered);
    free(work->band_first);
    free(work->band_edges);
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

static inline double smaller_of(double a, double b) {
    return a < b ? a : b;
}

static inline double larger_of(double a, double b) {
    return a > b ? a : b;
}

/// Drops edges with an end that is no number, and finds how high the figure reaches.
static void prepare(enf_silhouette *work, double *low, double *high) {
    size_t kept = 0;
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t i = 0; i < work->edge_count; ++i) {
        const enf_contour_edge *edge = &work->edges[i];
        if (edge->rise == 0 || !isfinite(edge->x0) || !isfinite(edge->x1) || !isfinite(edge->y0) ||
            !isfinite(edge->y1))
            continue;
        *low = smaller_of(*low, smaller_of(edge->y0, edge->y1));
        *high = larger_of(*high, larger_of(edge->y0, edge->y1));
        work->edges[kept++] = *edge;
    }
    work->edge_count = kept;
}

/// Allocates the bands and sets their borders.
static bool make_borders(enf_silhouette *work, double low, double high) {
    size_t count =
        work->edge_count <= FEW_EDGES ? 1 : 1 + (size_t)(sqrt((double)work->edge_count) / BAND_DIVISOR);
    if (!enf_array_reserve(work->borders, work->border_capacity, count + 1) ||
        !enf_array_reserve(work->band_first, work->band_capacity, count + 2))
        return false;
    for (size_t i = 0; i < count; ++i) work->borders[i] = low + (high - low) * ((double)i / (double)count);
    work->borders[count] = high;
    work->band_count = count;
    return true;
}

/// The lowest and the highest of the bands that an edge touches.
static void find_bands(const enf_silhouette *work, const enf_contour_edge *edge, size_t band[2]) {
    const double *borders = work->borders;
    size_t last = work->band_count - 1;
    double low = smaller_of(edge->y0, edge->y1), high = larger_of(edge->y0, edge->y1);
    double bottom = borders[0], height = borders[last + 1] - bottom;
    double guess = height > 0 ? (low - bottom) / height * (double)work->band_count : 0;
    size_t at = guess >= 0 ? (size_t)smaller_of(guess, (double)last) : 0;
    while (at > 0 && borders[at] >= low) --at;
    while (at < last && borders[at + 1] < low) ++at;
    band[0] = at;
    while (at < last && borders[at + 1] <= high) ++at;
    band[1] = at;
}

/// Puts the edges nearly into the order of their left ends, by as many buckets as there are edges.
static bool order_edges(enf_silhouette *work) {
    size_t count = work->edge_count;
    const enf_contour_edge *edges = work->edges;
    if (!enf_array_reserve(work->bucket_first, work->bucket_capacity, count + 2) ||
        !enf_array_reserve(work->ordered, work->ordered_capacity, count))
        return false;
    double left = INFINITY, right = -INFINITY;
    for (size_t i = 0; i < count; ++i) {
        left = smaller_of(left, edges[i].x0);
        right = larger_of(right, edges[i].x0);
    }
    double scale = right > left ? (double)(count - 1) / (right - left) : 0;
    if (!isfinite(scale)) scale = 0;
    uint32_t *first = work->bucket_first + 1; // shifted by one while filling
    memset(work->bucket_first, 0, (count + 2) * sizeof *work->bucket_first);
    for (size_t i = 0; i < count; ++i) ++first[(size_t)((edges[i].x0 - left) * scale) + 1];
    for (size_t i = 0; i < count; ++i) first[i + 1] += first[i];
    for (size_t i = 0; i < count; ++i)
        work->ordered[first[(size_t)((edges[i].x0 - left) * scale)]++] = (uint32_t)i;
    return true;
}

/// Lists the edges of each band, nearly in the order of their left ends: count, prefix sum, fill.
static bool list_edges(enf_silhouette *work) {
    size_t *first = work->band_first + 1, band[2]; // shifted by one while filling
    memset(work->band_first, 0, (work->band_count + 2) * sizeof *work->band_first);
    for (size_t i = 0; i < work->edge_count; ++i) {
        find_bands(work, &work->edges[i], band);
        for (size_t b = band[0]; b <= band[1]; ++b) ++first[b + 1];
    }
    for (size_t b = 0; b < work->band_count; ++b) first[b + 1] += first[b];
    if (!enf_array_reserve(work->band_edges, work->listed_capacity, first[work->band_count])) return false;
    for (size_t i = 0; i < work->edge_count; ++i) {
        find_bands(work, &work->edges[work->ordered[i]], band);
        for (size_t b = band[0]; b <= band[1]; ++b) work->band_edges[first[b]++] = work->ordered[i];
    }
    return true;
}

/// Where an edge crosses the height y.
static double crossing_at(const enf_contour_edge *edge, double y) {
    double x = edge->x0 + (edge->x1 - edge->x0) * ((y - edge->y0) / (edge->y1 - edge->y0));
    return smaller_of(larger_of(x, edge->x0), edge->x1);
}

/// Adds the part of an edge within a band.
static void add_part(enf_silhouette *work, const enf_contour_edge *edge, double low, double high) {
    enf_contour_edge part = *edge;
    if ((edge->y0 < low && edge->y1 < low) || (edge->y0 > high && edge->y1 > high)) return;
    if ((edge->y0 < low) != (edge->y1 < low)) {
        double x = crossing_at(edge, low);
        work->turns[work->turn_count++] =
            (enf_border_turn){x, edge->y1 > edge->y0 ? -edge->rise : edge->rise};
        if (edge->y0 < low) part.x0 = x, part.y0 = low;
        if (edge->y1 < low) part.x1 = x, part.y1 = low;
    }
    if ((edge->y0 > high) != (edge->y1 > high)) {
        double x = crossing_at(edge, high);
        if (edge->y0 > high) part.x0 = x, part.y0 = high;
        if (edge->y1 > high) part.x1 = x, part.y1 = high;
    }
    if (part.x0 < part.x1) work->parts[work->part_count++] = part;
}

/// The ends of the parts and the turns, ascending, each once. In the order of their left ends the right ends
/// are nearly sorted.
static size_t list_events(enf_silhouette *work) {
    size_t events = 0, kept = 0;
    for (size_t i = 0; i < work->part_count; ++i) {
        work->events[events++] = work->parts[i].x0;
        work->events[events++] = work->parts[i].x1;
    }
    for (size_t i = 0; i < work->turn_count; ++i) work->events[events++] = work->turns[i].x;
    sort_events(work->events, events);
    for (size_t i = 0; i < events; ++i)
        if (kept == 0 || work->events[i] != work->events[kept - 1]) work->events[kept++] = work->events[i];
    return kept;
}

/// Collects the parts of the edges within the band, the turns of the winding number along its lower border,
/// and the borders of all slabs. An only band has no list: all edges are its parts.
static bool fill_band(enf_silhouette *work, size_t band, size_t *event_count) {
    bool is_only = work->band_count == 1;
    const uint32_t *listed = is_only ? NULL : work->band_edges + work->band_first[band];
    size_t count = is_only ? work->edge_count : work->band_first[band + 1] - work->band_first[band];
    if (!enf_array_reserve(work->parts, work->part_capacity, count) ||
        !enf_array_reserve(work->turns, work->turn_capacity, count) ||
        !enf_array_reserve(work->events, work->event_capacity, 3 * count))
        return false;
    work->part_count = work->turn_count = 0;
    for (size_t i = 0; i < count; ++i)
        add_part(work, &work->edges[is_only ? i : listed[i]], work->borders[band], work->borders[band + 1]);
    sort_contour(work->parts, work->part_count);
    sort_turns(work->turns, work->turn_count);
    *event_count = list_events(work);
    return true;
}

static inline double height_at(const slab_edge *active, double x) {
    const enf_contour_edge *edge = active->edge;
    return x >= edge->x1 ? edge->y1 : edge->y0 + active->slope * (x - edge->x0);
}

static inline bool lower(const slab_edge *a, const slab_edge *b) {
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
static inline int factor_of(const slab_edge *edge, int64_t *winding) {
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
        highest = larger_of(highest, work->active[end].right);
    return end;
}

/// Adds the mean covered height of the slab; `winding` is the winding number at its lower border.
static bool add_slab(enf_silhouette *work, size_t count, int64_t winding, const double band[2],
                     bool is_crossed, double *mean) {
    const slab_edge *active = work->active;
    if (winding > 0) *mean -= band[0];
    for (size_t begin = 0, end; begin < count; begin = end) {
        end = is_crossed ? block_end(work, begin, count) : begin + 1;
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
        work->active[kept++] = (slab_edge){
            .left = edge->y0, .slope = (edge->y1 - edge->y0) / (edge->x1 - edge->x0), .edge = edge};
    }
    *count = kept;
    return enf_array_reserve(work->lowest, work->lowest_capacity, kept + 1);
}

/// Finds the blocks of the sorted edges, and returns the size of the largest one.
static size_t find_blocks(enf_silhouette *work, size_t count) {
    size_t largest = 0;
    work->lowest[count] = INFINITY;
    for (size_t i = count; i-- > 0;) work->lowest[i] = smaller_of(work->active[i].right, work->lowest[i + 1]);
    for (size_t begin = 0, end; begin < count; begin = end) {
        end = block_end(work, begin, count);
        if (end - begin > largest) largest = end - begin;
    }
    return largest;
}

/// Lets the active edges run up to `to`, sorts them, and returns the size of the largest block, 1 when no
/// edges cross.
static size_t run_edges(enf_silhouette *work, double to, size_t count) {
    slab_edge *active = work->active;
    for (size_t i = 0; i < count; ++i) active[i].right = height_at(&active[i], to);
    sort_edges(active, count);
    for (size_t i = 0; i + 1 < count; ++i)
        if (active[i].right > active[i + 1].right) return find_blocks(work, count);
    return 1;
}

/// Adds the covered area of a band.
static bool add_band(enf_silhouette *work, size_t band, double *area) {
    size_t event_count, count = 0, next = 0, turn = 0;
    int64_t winding = 0;
    if (!fill_band(work, band, &event_count)) return false;
    for (size_t i = 0; i + 1 < event_count; ++i) {
        double from = work->events[i];
        for (; turn < work->turn_count && work->turns[turn].x <= from; ++turn)
            winding += work->turns[turn].change;
        while (from < work->events[i + 1]) {
            double to = work->events[i + 1], mean = 0;
            if (!enter_slab(work, from, &count, &next)) return false;
            size_t largest = run_edges(work, to, count);
            // A block costs the cube of its size: halve the slab until no block is large.
            for (int halvings = 0; largest > LARGE_BLOCK && halvings < MOST_HALVINGS; ++halvings) {
                double middle = from + (to - from) / 2;
                if (!(from < middle && middle < to)) break;
                to = middle;
                largest = run_edges(work, to, count);
            }
            if (!add_slab(work, count, winding, &work->borders[band], largest > 1, &mean)) return false;
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
    if (!make_borders(work, low, high)) return false;
    if (work->band_count > 1 && (!order_edges(work) || !list_edges(work))) return false;
    for (size_t band = 0; band < work->band_count; ++band)
        if (!add_band(work, band, area)) return false;
    work->edge_count = 0;
    return true;
}
