// SPDX-License-Identifier: MIT
// Cells in the order in which the viewer may enter them, by a heap (E. W. Dijkstra, 1959, where the length of
// a way is the latest portal on it: no portal can be passed before the viewer could be there, and none before
// those that lie ahead of it). Each moment adds what is seen from the cells that are entered then and has not
// been listed yet.
#include "enfilade/prefetch.h"

#include "format/pvs_row.h"
#include "run/take.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// A cell with two numbers to order it by, then its own.
typedef struct ranked {
    double key;
    int32_t cell, reserved;
} ranked;

struct enf_prefetch {
    const enf_file_view *view;
    double *entered; ///< per cell: seconds; infinite: not yet
    uint8_t *listed; ///< per cell
    ranked *heap;    ///< cells to be entered; the least comes first. At most one for each cell
    int32_t *place;  ///< per cell: in the heap; -1: not there
    ranked *fresh;   ///< what one cell has added
    int32_t heap_count, fresh_count;
};

enf_status enf_prefetch_create(enf_prefetch **out, const enf_world *world, enf_error *error) {
    *out = NULL;
    enf_prefetch *prefetch = calloc(1, sizeof *prefetch);
    if (!prefetch) return enf_fail_memory(error, "a prefetch list");
    prefetch->view = enf_world_file(world);
    size_t cells = (size_t)prefetch->view->cell_count;
    prefetch->entered = enf_take(cells, sizeof *prefetch->entered);
    prefetch->listed = enf_take(cells, sizeof *prefetch->listed);
    prefetch->heap = enf_take(cells, sizeof *prefetch->heap);
    prefetch->place = enf_take(cells, sizeof *prefetch->place);
    prefetch->fresh = enf_take(cells, sizeof *prefetch->fresh);
    if (!prefetch->entered || !prefetch->listed || !prefetch->heap || !prefetch->place || !prefetch->fresh) {
        enf_prefetch_free(prefetch);
        return enf_fail_memory(error, "a prefetch list");
    }
    *out = prefetch;
    return ENF_OK;
}

void enf_prefetch_free(enf_prefetch *prefetch) {
    if (!prefetch) return;
    free(prefetch->entered);
    free(prefetch->listed);
    free(prefetch->heap);
    free(prefetch->place);
    free(prefetch->fresh);
    free(prefetch);
}

static bool is_before(ranked a, ranked b) {
    return a.key < b.key || (a.key == b.key && a.cell < b.cell);
}

static void set_heap(enf_prefetch *prefetch, int32_t at, ranked item) {
    prefetch->heap[at] = item;
    prefetch->place[item.cell] = at;
}

/// Puts an item at a free place of the heap, or above it.
static void rise(enf_prefetch *prefetch, int32_t at, ranked item) {
    while (at > 0 && is_before(item, prefetch->heap[(at - 1) / 2])) {
        set_heap(prefetch, at, prefetch->heap[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    set_heap(prefetch, at, item);
}

/// Puts an item at a free place of a heap, or below it. `place` may be null.
static void sink(ranked *heap, int32_t count, int32_t at, ranked item, int32_t *place) {
    for (;;) {
        int64_t child = 2 * (int64_t)at + 1;
        if (child >= count) break;
        if (child + 1 < count && is_before(heap[child + 1], heap[child])) child++;
        if (!is_before(heap[child], item)) break;
        heap[at] = heap[child];
        if (place) place[heap[at].cell] = at;
        at = (int32_t)child;
    }
    heap[at] = item;
    if (place) place[item.cell] = at;
}

static ranked pop(enf_prefetch *prefetch) {
    ranked top = prefetch->heap[0], last = prefetch->heap[--prefetch->heap_count];
    if (prefetch->heap_count > 0) sink(prefetch->heap, prefetch->heap_count, 0, last, prefetch->place);
    prefetch->place[top.cell] = -1;
    return top;
}

static void enter_by(enf_prefetch *prefetch, int32_t cell, double seconds) {
    if (!(seconds < prefetch->entered[cell])) return;
    prefetch->entered[cell] = seconds;
    int32_t at = prefetch->place[cell];
    rise(prefetch, at < 0 ? prefetch->heap_count++ : at, (ranked){seconds, cell, 0});
}

/// Seconds to a portal's bounding sphere; infinite for who stands still.
static double seconds_to(const enf_file_portal *portal, const double point[3], const double velocity[3]) {
    double square = 0, speed = 0, along = 0;
    for (int a = 0; a < 3; a++) {
        double off = portal->centre[a] - point[a];
        square += off * off;
        speed += velocity[a] * velocity[a];
        along += velocity[a] * off;
    }
    speed = sqrt(speed);
    double centre = sqrt(square), distance = fmax(0, centre - portal->radius);
    if (distance == 0) return 0;
    if (!(speed > 0)) return INFINITY;
    double ahead = along / (speed * centre); // cosine
    double slower = ahead >= 0 ? 2 - ahead : 2 - 2 * ahead;
    return distance / speed * slower;
}

static double distance_to_box(const enf_file_cell *cell, const double point[3]) {
    double square = 0;
    for (int a = 0; a < 3; a++) {
        double off = fmax(0, fmax(cell->box_min[a] - point[a], point[a] - cell->box_max[a]));
        square += off * off;
    }
    return sqrt(square);
}

static void list(enf_prefetch *prefetch, int32_t cell, const double point[3]) {
    if (prefetch->listed[cell]) return;
    prefetch->listed[cell] = 1;
    prefetch->fresh[prefetch->fresh_count++] =
        (ranked){distance_to_box(&prefetch->view->cells[cell], point), cell, 0};
}

/// What the cell's row of the visible set holds.
static void list_row(enf_prefetch *prefetch, int32_t cell, const double point[3]) {
    const enf_file_view *view = prefetch->view;
    int64_t byte = 0, bytes = (int64_t)enf_pvs_row_bytes(view->cell_count);
    for (int64_t at = view->pvs_offset[cell], end = view->pvs_offset[cell + 1]; at < end && byte < bytes;
         at++) {
        unsigned bits = view->pvs_rows[at];
        if (bits == 0) {
            if (++at < end) byte += view->pvs_rows[at];
            continue;
        }
        for (int32_t k = 0; k < 8 && 8 * byte + k < view->cell_count; k++)
            if (bits >> k & 1) list(prefetch, (int32_t)(8 * byte + k), point);
        byte++;
    }
}

static void list_neighbours(enf_prefetch *prefetch, int32_t cell, const double point[3]) {
    const enf_file_view *view = prefetch->view;
    list(prefetch, cell, point);
    for (int32_t i = 0; i < view->cells[cell].portal_count; i++)
        list(prefetch, view->portals[view->cell_portals[view->cells[cell].portal_first + i]].to, point);
}

/// Adds what is seen from a cell, and where one may go from there.
static void enter(enf_prefetch *prefetch, ranked from, const double point[3], const double velocity[3],
                  double seconds) {
    const enf_file_view *view = prefetch->view;
    const enf_file_cell *cell = &view->cells[from.cell];
    if (view->pvs)
        list_row(prefetch, from.cell, point);
    else
        list_neighbours(prefetch, from.cell, point);
    for (int32_t i = 0; i < cell->portal_count; i++) {
        const enf_file_portal *portal = &view->portals[view->cell_portals[cell->portal_first + i]];
        double when = fmax(from.key, seconds_to(portal, point, velocity));
        if (when <= seconds) enter_by(prefetch, portal->to, when);
    }
}

/// By heap, in place: qsort may take memory.
static void sort_fresh(enf_prefetch *prefetch) {
    ranked *items = prefetch->fresh;
    int32_t count = prefetch->fresh_count;
    for (int32_t i = count / 2; i-- > 0;) sink(items, count, i, items[i], NULL);
    for (int32_t left = count; left > 1;) { // the least goes to the end
        ranked least = items[0], last = items[--left];
        sink(items, left, 0, last, NULL);
        items[left] = least;
    }
}

static bool are_finite(const double point[3], const double velocity[3], double seconds) {
    bool finite = isfinite(seconds) && seconds >= 0;
    for (int a = 0; a < 3; a++) finite = finite && isfinite(point[a]) && isfinite(velocity[a]);
    return finite;
}

int32_t enf_prefetch_list(enf_prefetch *prefetch, int32_t cell, const double point[3],
                          const double velocity[3], double seconds, enf_wanted *out, int32_t capacity) {
    const enf_file_view *view = prefetch->view;
    int32_t count = 0;
    if (cell < 0 || cell >= view->cell_count || !are_finite(point, velocity, seconds)) return 0;
    memset(prefetch->listed, 0, (size_t)view->cell_count);
    for (int32_t i = 0; i < view->cell_count; i++) {
        prefetch->entered[i] = INFINITY;
        prefetch->place[i] = -1;
    }
    prefetch->heap_count = 0;
    enter_by(prefetch, cell, 0);
    while (prefetch->heap_count > 0) {
        double when = prefetch->heap[0].key;
        prefetch->fresh_count = 0;
        while (prefetch->heap_count > 0 && prefetch->heap[0].key == when)
            enter(prefetch, pop(prefetch), point, velocity, seconds);
        sort_fresh(prefetch);
        for (int32_t i = prefetch->fresh_count; i-- > 0; count++)
            if (count < capacity) out[count] = (enf_wanted){prefetch->fresh[i].cell, when};
    }
    return count;
}
