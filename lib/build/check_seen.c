// SPDX-License-Identifier: GPL-3.0-or-later
// What is seen: the polygons whose front each fine cell has on its facets, and the triangles each cell lists
// for drawing.
#include "build/check_rows.h"

#include "base/array.h"

#include <stdlib.h>

// ---------------------------------------------------------------------------------------------- fine cells

/// Marks the polygons whose front covers some area of the facet, on the side of the cell.
static void mark_seen(enf_checker *checker, int32_t facet, int32_t cell, int32_t *mark, int32_t *count) {
    const enf_file_view *view = checker->view;
    for (int32_t c = view->facet_cover[facet]; c < view->facet_cover[facet + 1]; c++) {
        int32_t *at = &mark[view->cover_polygon[c]];
        if (view->cover_side[c] != enf_check_facet_side(checker, facet, cell) || *at == cell + 1) continue;
        *at = cell + 1;
        ++*count;
    }
}

static bool check_cell(enf_checker *checker, int32_t cell, int32_t *mark) {
    const enf_file_view *view = checker->view;
    int32_t count = 0;
    for (int32_t i = view->fine_facet[cell]; i < view->fine_facet[cell + 1]; i++)
        mark_seen(checker, view->fine_facets[i], cell, mark, &count);
    int64_t first = view->seen_offset[cell], end = view->seen_offset[cell + 1];
    for (int64_t i = first; i < end; i++) {
        if (mark[view->seen[i]] != cell + 1 || (i > first && view->seen[i] <= view->seen[i - 1]))
            return enf_check_break(
                checker, "fine cell %d lists polygon %d, which it does not see or lists out of order",
                (int)cell, (int)view->seen[i]);
    }
    return end - first == count || enf_check_break(checker, "fine cell %d sees %d polygons, but lists %d",
                                                   (int)cell, (int)count, (int)(end - first));
}

void enf_check_seen(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "connect: seen",
                    "every fine cell lists the polygons whose front lies on its facets, no others");
    int32_t *mark = enf_array_zeroed((size_t)view->mesh_polygon_count, sizeof *mark);
    if (!mark) enf_check_no_memory(checker);
    for (int32_t c = 0; mark && c < view->fine_count && check_cell(checker, c, mark); c++)
        checker->row->tested++;
    free(mark);
}

// ---------------------------------------------------------------------------------------------- cells

typedef struct drawing {
    int32_t *first, *fine; ///< the fine cells of each cell
    int32_t *triangles;    ///< how many triangles each clean polygon has
    int32_t *mark;         ///< per clean polygon: the last cell + 1 that sees it
} drawing;

static bool make_drawing(enf_checker *checker, drawing *d) {
    const enf_file_view *view = checker->view;
    d->first = enf_array_zeroed((size_t)view->cell_count + 2, sizeof *d->first);
    d->fine = enf_array_new((size_t)view->fine_count, sizeof *d->fine);
    d->triangles = enf_array_zeroed((size_t)view->mesh_polygon_count, sizeof *d->triangles);
    d->mark = enf_array_zeroed((size_t)view->mesh_polygon_count, sizeof *d->mark);
    if (!d->first || !d->fine || !d->triangles || !d->mark) return enf_check_no_memory(checker);
    for (int32_t c = 0; c < view->fine_count; c++) {
        if (view->fine_cell[c] >= 0) d->first[view->fine_cell[c] + 2]++;
    }
    for (int32_t i = 0; i < view->cell_count; i++) d->first[i + 2] += d->first[i + 1];
    for (int32_t c = 0; c < view->fine_count; c++) {
        if (view->fine_cell[c] >= 0) d->fine[d->first[view->fine_cell[c] + 1]++] = c;
    }
    for (int32_t t = 0; t < view->triangle_count; t++) {
        if (view->triangles[t].mesh_polygon >= 0) d->triangles[view->triangles[t].mesh_polygon]++;
    }
    return true;
}

/// Marks what a fine cell sees as seen by a cell; returns how many triangles that adds.
static int64_t mark_drawn(const enf_file_view *view, drawing *d, int32_t cell, int32_t fine) {
    int64_t added = 0;
    for (int64_t k = view->seen_offset[fine]; k < view->seen_offset[fine + 1]; k++) {
        if (d->mark[view->seen[k]] == cell + 1) continue;
        d->mark[view->seen[k]] = cell + 1;
        added += d->triangles[view->seen[k]];
    }
    return added;
}

static bool is_sealed(const enf_file_view *view, int32_t facet) {
    for (int32_t p = view->facet_piece[facet]; p < view->facet_piece[facet + 1]; p++)
        if (view->piece_cover[p] == -2) return true;
    return false;
}

/// Detail objects may be listed besides: they are only near.
static bool check_drawn_cell(enf_checker *checker, drawing *d, int32_t cell) {
    const enf_file_view *view = checker->view;
    int64_t wanted = 0, listed = 0, first = view->cells[cell].triangle_first,
            end = first + view->cells[cell].triangle_count;
    for (int32_t i = d->first[cell]; i < d->first[cell + 1]; i++) {
        const int32_t fine = d->fine[i];
        wanted += mark_drawn(view, d, cell, fine);
        for (int32_t k = view->fine_facet[fine]; k < view->fine_facet[fine + 1]; k++) {
            const int32_t *sides = view->facet_fine[view->fine_facets[k]], other = sides[sides[0] == fine];
            if (other >= 0 && is_sealed(view, view->fine_facets[k]))
                wanted += mark_drawn(view, d, cell, other);
        }
    }
    for (int64_t i = first; i < end; i++) {
        int32_t polygon = view->triangles[view->cell_triangles[i]].mesh_polygon;
        if ((polygon >= 0 && d->mark[polygon] != cell + 1) ||
            (i > first && view->cell_triangles[i] <= view->cell_triangles[i - 1]))
            return enf_check_break(checker,
                                   "cell %d lists triangle %d, which it does not see or lists out of order",
                                   (int)cell, (int)view->cell_triangles[i]);
        listed += polygon >= 0;
    }
    return listed == wanted || enf_check_break(checker, "cell %d sees %lld triangles, but lists %lld",
                                               (int)cell, (long long)wanted, (long long)listed);
}

void enf_check_drawn(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(
        checker, "decimate: triangles",
        "every cell lists the triangles whose front its fine cells see, and those behind their seals");
    if (!view->has_geometry) {
        checker->row->skipped = true;
        return;
    }
    drawing d = {0};
    bool good = make_drawing(checker, &d);
    for (int32_t i = 0; good && i < view->cell_count; i++, checker->row->tested++)
        good = check_drawn_cell(checker, &d, i);
    free(d.first);
    free(d.fine);
    free(d.triangles);
    free(d.mark);
}
