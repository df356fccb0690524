// SPDX-License-Identifier: GPL-3.0-or-later
// The file itself: checksums, numbers that make sense, rounded coordinates, and the structures for point
// location.
#include "build/check_rows.h"

#include "base/array.h"
#include "base/hash.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void check_checksums(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "file: checksums", "every section's bytes are those that were written");
    if (!view->bytes) {
        checker->row->skipped = true; // a world that is not in a file yet
        return;
    }
    for (uint32_t s = 0; s < view->header->section_count; s++, checker->row->tested++) {
        const enf_file_section *section = &view->sections[s];
        if (enf_hash64(view->bytes + section->offset, section->size, 0) == section->checksum) continue;
        enf_check_break(checker, "section %.8s is damaged", section->tag);
        return;
    }
}

void enf_check_numbers(enf_checker *checker) {
    check_checksums(checker);
    enf_check_begin(checker, "file: numbers",
                    "points are whole and different, planes and crossings are defined");
    int32_t which = 0;
    switch (enf_check_exact_make(&checker->exact, checker->view, &which)) {
    case ENF_CHECK_FAULT_NONE:
        checker->row->tested = (uint64_t)checker->view->vertex_count + (uint64_t)checker->view->plane_count;
        break;
    case ENF_CHECK_FAULT_MEMORY:
        enf_check_no_memory(checker);
        break;
    case ENF_CHECK_FAULT_POINT:
        enf_check_break(checker, "point %d has no whole coordinates, or those of the point before it",
                        (int)which);
        break;
    case ENF_CHECK_FAULT_PLANE:
        enf_check_break(checker, "plane %d goes through points on one line", (int)which);
        break;
    case ENF_CHECK_FAULT_VERTEX:
        enf_check_break(checker, "vertex %d is not where three planes cross", (int)which);
        break;
    }
}

static void check_positions(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "file: positions",
                    "rounded vertices are within 0.5 + 2^-50 |x| grid steps of the exact ones");
    for (int32_t v = 0; v < view->vertex_count; v++, checker->row->tested++) {
        const double *at = view->vertex_position[v];
        bool good = v < view->point_count ? memcmp(at, view->points[v], sizeof view->points[v]) == 0
                                          : enf_check_position_near(&checker->exact, v, at);
        if (good) continue;
        enf_check_break(checker, "the rounded position of vertex %d is not that of the exact one", (int)v);
        return;
    }
}

static bool box_holds(const enf_file_box *outer, const enf_file_box *inner) {
    for (int a = 0; a < 3; a++) {
        if (inner->min[a] < outer->min[a] || inner->max[a] > outer->max[a]) return false;
    }
    return true;
}

static bool box_holds_tetrahedron(const enf_file_view *view, const enf_file_box *box, int32_t tetrahedron) {
    for (int i = 0; i < 4; i++) {
        const double *p = view->points[view->tetrahedra[tetrahedron][i]];
        for (int a = 0; a < 3; a++) {
            if (p[a] < box->min[a] || p[a] > box->max[a]) return false;
        }
    }
    return true;
}

/// Every tetrahedron is in one leaf, which holds it, and every box lies in those around it.
static bool check_box_tree(enf_checker *checker, int32_t *around, uint8_t *met) {
    const enf_file_view *view = checker->view;
    int32_t depth = 0;
    for (int32_t b = 0; b < view->box_count; b++, checker->row->tested++) {
        const enf_file_box *box = &view->boxes[b];
        while (depth > 0 && view->boxes[around[depth - 1]].next <= b) depth--;
        if (depth > 0 && (!box_holds(&view->boxes[around[depth - 1]], box) ||
                          box->next > view->boxes[around[depth - 1]].next))
            return enf_check_break(checker, "box %d reaches out of the box around it", (int)b);
        if (box->tetrahedron < 0) {
            around[depth++] = b;
            continue;
        }
        for (int32_t t = box->tetrahedron; t < enf_file_box_end(box, view->tetrahedron_count); t++) {
            if (met[t]++ || !box_holds_tetrahedron(view, box, t))
                return enf_check_break(checker, "box %d does not hold tetrahedron %d, or is not the only one",
                                       (int)b, (int)t);
        }
    }
    for (int32_t t = 0; t < view->tetrahedron_count; t++) {
        if (!met[t]) return enf_check_break(checker, "no box holds tetrahedron %d", (int)t);
    }
    return true;
}

static void check_location(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "file: location",
                    "every tetrahedron is in one leaf, and every box in those around it");
    int32_t *around = enf_array_new((size_t)view->box_count, sizeof *around);
    uint8_t *met = enf_array_zeroed((size_t)view->tetrahedron_count, 1);
    if (!around || !met) {
        enf_check_no_memory(checker);
    } else {
        check_box_tree(checker, around, met);
    }
    free(around);
    free(met);
}

void enf_check_file(enf_checker *checker) {
    check_positions(checker);
    check_location(checker);
    enf_check_sight(checker);
}
