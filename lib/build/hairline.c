// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/hairline.h"

#include "base/array.h"
#include "base/sets.h"
#include "build/loop.h"

#include <math.h>
#include <stdlib.h>

static double length(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static bool is_thin(const enf_complex *complex, int32_t cell, double thin) {
    enf_body_size body = {.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    enf_complex_measure_cell(complex, cell, &body);
    return enf_body_is_hairline(&body, thin);
}

/// A way out of a set of thin cells.
typedef struct door {
    int32_t piece; ///< or -1
    double area;
} door;

static void offer(door *best, int32_t piece, double area) {
    if (best->piece < 0 || area > best->area) *best = (door){piece, area};
}

/// Every set of thin cells joins the set beyond its largest open piece. Returns how many sets were joined.
static int32_t join_round(const enf_complex *complex, const bool *cell_kept, int32_t *parent, bool *thick,
                          door *doors) {
    for (int32_t c = 0; c < complex->cell_count; c++) doors[c].piece = -1;
    for (int pass = 0, joined = 0; pass < 2; pass++) {
        for (int32_t p = 0; p < complex->pieces.count; p++) {
            const int32_t *cell = enf_complex_piece_cells(complex, p);
            if (complex->piece_cover[p] != ENF_PIECE_OPEN || cell[0] < 0 || cell[1] < 0) continue;
            if (!cell_kept[cell[0]] || !cell_kept[cell[1]]) continue;
            int32_t a = enf_sets_find(parent, cell[0]), b = enf_sets_find(parent, cell[1]);
            if (a == b) continue;
            if (pass == 0 && !(thick[a] && thick[b])) {
                double area[3];
                enf_complex_piece_area(complex, p, area);
                if (!thick[a]) offer(&doors[a], p, length(area));
                if (!thick[b]) offer(&doors[b], p, length(area));
            } else if (pass == 1 &&
                       ((!thick[a] && doors[a].piece == p) || (!thick[b] && doors[b].piece == p))) {
                bool both = thick[a] || thick[b];
                enf_sets_unite(parent, a, b);
                thick[a < b ? a : b] = both;
                if (doors[a].piece == p) doors[a].piece = -1;
                if (doors[b].piece == p) doors[b].piece = -1;
                joined++;
            }
        }
        if (pass == 1) return joined;
    }
    return 0;
}

bool enf_complex_number_nodes(const enf_complex *complex, const bool *cell_kept, double thin,
                              int32_t *node_of, int32_t *node_count, int32_t *joined) {
    size_t cells = (size_t)complex->cell_count;
    int32_t *parent = enf_array_new(cells, sizeof *parent);
    bool *thick = enf_array_new(cells, sizeof *thick);
    door *doors = enf_array_new(cells, sizeof *doors);
    bool good = parent && thick && doors;
    *joined = 0;
    if (good) {
        int32_t thin_count = 0;
        for (int32_t c = 0; c < complex->cell_count; c++) {
            parent[c] = c;
            thick[c] = !cell_kept[c] || !is_thin(complex, c, thin);
            thin_count += !thick[c];
        }
        for (int32_t round = 1; thin_count > 0 && round > 0; *joined += round) {
            round = join_round(complex, cell_kept, parent, thick, doors);
        }
        *node_count = 0;
        for (int32_t c = 0; c < complex->cell_count; c++) {
            int32_t root = enf_sets_find(parent, c);
            node_of[c] = !cell_kept[c] ? -1 : root == c ? (*node_count)++ : node_of[root];
        }
    }
    free(parent);
    free(thick);
    free(doors);
    return good;
}
