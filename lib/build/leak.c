// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/leak.h"

#include "base/array.h"
#include "base/sets.h"

#include <stdlib.h>
#include <string.h>

typedef struct opening {
    double width;
    int32_t piece;
} opening;

static int compare_openings(const void *a, const void *b) {
    const opening *x = a, *y = b;
    if (x->width != y->width) return x->width > y->width ? -1 : 1;
    return (x->piece > y->piece) - (x->piece < y->piece);
}

static int32_t side_cell(const enf_complex *complex, int32_t piece, int side) {
    int32_t cell = enf_complex_piece_cells(complex, piece)[side];
    return cell < 0 ? complex->cell_count : cell; // the last number stands for the outside
}

/// Opens the widest pieces of the start's region first until the start is joined to the outside. Marks the
/// pieces opened; *last is the narrowest of them. False without memory.
static bool open_widest(const enf_complex *complex, const int32_t *cell_region, int32_t start, bool *opened,
                        opening *last) {
    opening *openings = enf_array_new((size_t)complex->pieces.count, sizeof *openings);
    int32_t *parent = enf_array_new((size_t)complex->cell_count + 1, sizeof *parent);
    if (openings && parent) {
        size_t count = 0;
        for (int32_t p = 0; p < complex->pieces.count; p++) {
            if (complex->piece_cover[p] != ENF_PIECE_OPEN) continue;
            int32_t cell = side_cell(complex, p, side_cell(complex, p, 0) == complex->cell_count);
            if (cell_region[cell] != cell_region[start]) continue; // leads from elsewhere to elsewhere
            openings[count++] = (opening){enf_complex_piece_width(complex, p), p};
        }
        qsort(openings, count, sizeof *openings, compare_openings);
        enf_sets_start(parent, complex->cell_count + 1);
        for (size_t i = 0;
             i < count && enf_sets_find(parent, start) != enf_sets_find(parent, complex->cell_count); i++) {
            int32_t p = openings[i].piece;
            opened[p] = true;
            *last = openings[i];
            enf_sets_unite(parent, side_cell(complex, p, 0), side_cell(complex, p, 1));
        }
    }
    bool good = openings && parent;
    free(openings);
    free(parent);
    return good;
}

typedef struct search {
    bool *opened;   ///< pieces that the path may use
    int64_t *first; ///< open pieces of each cell: offsets, cells + 1
    int32_t *pieces;
    int32_t *from; ///< piece through which a cell was reached; -1: not yet, -2: the start
    int32_t *queue;
} search;

static bool list_open_pieces(search *search, const enf_complex *complex) {
    size_t cells = (size_t)complex->cell_count;
    search->first = enf_array_zeroed(cells + 2, sizeof *search->first);
    search->from = enf_array_new(cells, sizeof *search->from);
    search->queue = enf_array_new(cells, sizeof *search->queue);
    search->pieces = enf_array_new(2 * (size_t)complex->pieces.count, sizeof *search->pieces);
    if (!search->first || !search->from || !search->queue || !search->pieces) return false;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t p = 0; p < complex->pieces.count; p++) {
            if (!search->opened[p]) continue;
            for (int side = 0; side < 2; side++) {
                int32_t cell = enf_complex_piece_cells(complex, p)[side];
                if (cell < 0) continue;
                if (pass == 0) {
                    search->first[cell + 2]++;
                } else {
                    search->pieces[search->first[cell + 1]++] = p;
                }
            }
        }
        for (size_t c = 0; pass == 0 && c < cells; c++) search->first[c + 2] += search->first[c + 1];
    }
    for (size_t c = 0; c < cells; c++) search->from[c] = -1;
    return true;
}

/// The cell on the other side of a piece; -1: outside the hull.
static int32_t beyond(const enf_complex *complex, int32_t piece, int32_t cell) {
    const int32_t *cells = enf_complex_piece_cells(complex, piece);
    return cells[cells[0] == cell ? 1 : 0];
}

/// Fewest cells first. Returns the hull piece through which the outside is reached; *last is the cell before
/// it.
static int32_t search_outside(search *search, const enf_complex *complex, int32_t start, int32_t *last) {
    size_t head = 0, tail = 0;
    search->queue[tail++] = start;
    search->from[start] = -2;
    while (head < tail) {
        int32_t cell = search->queue[head++];
        for (int64_t i = search->first[cell]; i < search->first[cell + 1]; i++) {
            int32_t p = search->pieces[i];
            int32_t next = beyond(complex, p, cell);
            if (next < 0) {
                *last = cell;
                return p;
            }
            if (search->from[next] != -1) continue;
            search->from[next] = p;
            search->queue[tail++] = next;
        }
    }
    return -1;
}

static bool write_path(enf_regions *regions, const enf_complex *complex, const enf_mesh *mesh,
                       const search *search, int32_t exit, int32_t last) {
    int32_t count = 2;
    for (int32_t c = last; search->from[c] != -2; count++) c = beyond(complex, search->from[c], c);
    regions->leak_points = enf_array_new((size_t)count, sizeof *regions->leak_points);
    if (!regions->leak_points) return false;
    regions->leak_point_count = count;
    enf_complex_piece_centre(complex, exit, regions->leak_points[count - 1]);
    int32_t at = count - 2;
    for (int32_t c = last; search->from[c] != -2; at--) {
        enf_complex_piece_centre(complex, search->from[c], regions->leak_points[at]);
        c = beyond(complex, search->from[c], c);
    }
    memcpy(regions->leak_points[0], mesh->spawns + 3 * (size_t)regions->leak_spawn,
           sizeof *regions->leak_points);
    return true;
}

bool enf_regions_trace_leak(enf_regions *regions, const enf_complex *complex, const enf_mesh *mesh) {
    for (int32_t s = 0; s < regions->spawn_count && !regions->leak; s++) {
        int32_t cell = regions->spawn_cell[s];
        if (cell < 0 || !regions->touches_outside[regions->cell_region[cell]]) continue;
        regions->leak = true;
        regions->leak_spawn = s;
    }
    if (!regions->leak) return true;
    int32_t start = regions->spawn_cell[regions->leak_spawn], last = -1;
    opening neck = {0};
    search search = {.opened = enf_array_zeroed((size_t)complex->pieces.count, sizeof *search.opened)};
    bool good = search.opened && open_widest(complex, regions->cell_region, start, search.opened, &neck) &&
                list_open_pieces(&search, complex);
    if (good) {
        regions->leak_width = neck.width;
        enf_complex_piece_centre(complex, neck.piece, regions->leak_neck);
        int32_t exit = search_outside(&search, complex, start, &last);
        good = exit < 0 || write_path(regions, complex, mesh, &search, exit, last);
    }
    free(search.opened);
    free(search.first);
    free(search.pieces);
    free(search.from);
    free(search.queue);
    return good;
}
