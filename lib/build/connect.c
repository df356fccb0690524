// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/connect.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

// ---------------------------------------------------------------------------------------------- numbers

/// Numbers the cells that are left without gaps, in the old order: into[c] becomes the number.
static void number_cells(int32_t *into, size_t count) {
    int32_t next = 0; // a cell that went into another may have the lower number: first those that stay
    for (size_t c = 0; c < count; c++) {
        if (into[c] == (int32_t)c) into[c] = -1 - next++;
    }
    for (size_t c = 0; c < count; c++) {
        if (into[c] >= 0) into[c] = into[into[c]];
    }
    for (size_t c = 0; c < count; c++) into[c] = -1 - into[c];
}

static void renumber_cells(enf_complex *complex, enf_arrangement *arrangement) {
    const int32_t *number = arrangement->cell_into;
    number_cells(arrangement->cell_into, (size_t)complex->cell_count + (size_t)complex->cells_joined);
    for (int32_t f = 0; f < complex->facet_count; f++) {
        for (int side = 0; side < 2; side++) {
            int32_t *cell = &complex->facet_cell[f][side];
            if (*cell >= 0) *cell = number[*cell];
        }
    }
    for (int32_t t = 0; t < complex->tetrahedron_count; t++) {
        int32_t *root = &complex->tetrahedron_root[t];
        if (*root < 0) *root = -1 - number[-1 - *root];
    }
    for (int32_t n = 0; n < complex->node_count; n++) {
        for (int k = 0; k < 2; k++) {
            int32_t *child = &complex->node_child[n][k];
            if (*child < 0) *child = -1 - number[-1 - *child];
        }
    }
    free(arrangement->cell_into);
    arrangement->cell_into = NULL;
}

bool enf_complex_list_facets(enf_complex *complex) {
    size_t cells = (size_t)complex->cell_count;
    int32_t *next = complex->cell_facet = enf_array_zeroed(cells + 2, sizeof *next);
    complex->cell_facets = enf_array_new(2 * (size_t)complex->facet_count, sizeof *complex->cell_facets);
    if (!next || !complex->cell_facets) return false;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t f = 0; f < complex->facet_count; f++) {
            for (int side = 0; side < 2; side++) {
                int32_t cell = complex->facet_cell[f][side];
                if (cell < 0) continue;
                if (pass == 0) {
                    next[cell + 2]++;
                } else {
                    complex->cell_facets[next[cell + 1]++] = f;
                }
            }
        }
        for (size_t i = 0; pass == 0 && i < cells; i++) next[i + 2] += next[i + 1];
    }
    return true;
}

void enf_complex_unlist_facets(enf_complex *complex) {
    free(complex->cell_facet);
    free(complex->cell_facets);
    complex->cell_facet = complex->cell_facets = NULL;
}

// ---------------------------------------------------------------------------------------------- sights

static int compare_numbers(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

enum { INSERT_MAX = 32 }; ///< numbers that are sorted by insertion: most cells see a handful

static void sort_numbers(int32_t *numbers, int64_t count) {
    if (count > INSERT_MAX) {
        qsort(numbers, (size_t)count, sizeof *numbers, compare_numbers);
        return;
    }
    for (int64_t i = 1; i < count; i++) {
        int32_t one = numbers[i];
        int64_t k = i;
        for (; k > 0 && numbers[k - 1] > one; k--) numbers[k] = numbers[k - 1];
        numbers[k] = one;
    }
}

bool enf_complex_list_seen(enf_complex *complex) {
    size_t cells = (size_t)complex->cell_count;
    int32_t *next = complex->seen_offset = enf_array_zeroed(cells + 2, sizeof *next);
    complex->seen = enf_array_new((size_t)complex->covers.count, sizeof *complex->seen);
    if (!next || !complex->seen) return false;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t f = 0; f < complex->facet_count; f++) {
            for (int32_t i = complex->facet_cover[f]; i < complex->facet_cover[f + 1]; i++) {
                int32_t cell = complex->facet_cell[f][complex->cover_side[i]];
                if (cell < 0) continue;
                if (pass == 0) {
                    next[cell + 2]++;
                } else {
                    complex->seen[next[cell + 1]++] = complex->cover_polygon[i];
                }
            }
        }
        for (size_t i = 0; pass == 0 && i < cells; i++) next[i + 2] += next[i + 1];
    }
    int32_t kept = 0, begin = 0;
    for (size_t cell = 0; cell < cells; cell++) {
        int32_t end = next[cell + 1];
        sort_numbers(complex->seen + begin, end - begin);
        next[cell] = kept;
        for (int32_t i = begin; i < end; i++) {
            if (i == begin || complex->seen[i] != complex->seen[i - 1])
                complex->seen[kept++] = complex->seen[i];
        }
        begin = end;
    }
    next[cells] = kept;
    return true;
}

// ---------------------------------------------------------------------------------------------- all together

/// What the arrangement does not need any more, or (the planes) needs as long as they are here.
static void take_arrangement(enf_complex *complex, enf_arrangement *arrangement) {
    complex->points = arrangement->geometry.points;
    complex->point_count = arrangement->geometry.point_count;
    complex->planes = arrangement->geometry.planes;
    complex->plane_count = arrangement->geometry.plane_count;
    arrangement->geometry.planes = NULL;
    complex->tetrahedra = arrangement->tets.corners;
    arrangement->tets.corners = NULL;
}

enf_status enf_complex_connect(enf_complex *complex, enf_arrangement *arrangement, const enf_crew *crew,
                               enf_error *error) {
    (void)crew;
    renumber_cells(complex, arrangement);
    bool good = enf_complex_list_facets(complex);
    take_arrangement(complex, arrangement);
    for (int i = 0; i < ENF_TIERS; i++) complex->predicates[i] += arrangement->geometry.decided[i];
    return good ? ENF_OK : enf_fail_memory(error, "the fine complex");
}
