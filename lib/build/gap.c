// SPDX-License-Identifier: GPL-3.0-or-later
// A thin cell is looked at along its thin direction, the normal of its largest face: two pieces of its faces
// are projected, one is clipped by the other (I. E. Sutherland and G. W. Hodgman, "Reentrant polygon
// clipping", 1974), and what is left has a width like any opening.
#include "build/gap.h"

#include "base/array.h"
#include "base/sets.h"
#include "build/loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS_MAX = 64 };

/// A wide open piece of a gap cell.
typedef struct port {
    int32_t cell, piece;
} port;

typedef struct outline {
    int count;
    double at[CORNERS_MAX][2];
} outline;

// ---- which cells

static void piece_cells(const enf_complex *complex, const int32_t *face_cell, int32_t piece,
                        int32_t cell[2]) {
    for (int side = 0; side < 2; side++) {
        int32_t face = complex->piece_face[piece][side];
        cell[side] = face < 0 ? -1 : face_cell[face];
    }
}

static void find_gaps(const enf_complex *complex, const int32_t *face_cell, double crack, bool *gap) {
    int32_t cell[2];
    for (int32_t p = 0; p < complex->pieces.count; p++) {
        if (complex->piece_cover[p] == ENF_PIECE_OPEN) continue;
        piece_cells(complex, face_cell, p, cell);
        for (int side = 0; side < 2; side++)
            if (cell[side] >= 0) gap[cell[side]] = true;
    }
    for (int32_t c = 0; c < complex->cell_count; c++) {
        enf_body_size body = {.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
                              .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
        if (!gap[c]) continue;
        enf_complex_measure_cell(complex, c, &body);
        gap[c] = enf_body_is_hairline(&body, crack);
    }
}

// ---- what lies above what

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Two directions of length 1 in the plane of the cell's largest face.
static void choose_axes(const enf_complex *complex, int32_t cell, double axes[2][3]) {
    const enf_loops *faces = &complex->faces;
    double normal[3] = {0, 0, 1}, most = 0;
    for (int32_t f = complex->cell_face[cell]; f < complex->cell_face[cell + 1]; f++) {
        double area[3];
        enf_loop_area(faces->corners + faces->offset[f], faces->offset[f + 1] - faces->offset[f],
                      (const double(*)[3])complex->vertex_position, area);
        if (dot(area, area) <= most) continue;
        most = dot(area, area);
        memcpy(normal, area, sizeof area);
    }
    int least = 0;
    for (int a = 1; a < 3; a++)
        if (fabs(normal[a]) < fabs(normal[least])) least = a;
    int b = (least + 1) % 3, c = (least + 2) % 3;
    double length = sqrt(normal[b] * normal[b] + normal[c] * normal[c]), size = sqrt(dot(normal, normal));
    axes[0][least] = 0;
    axes[0][b] = -normal[c] / length;
    axes[0][c] = normal[b] / length;
    for (int a = 0; a < 3; a++)
        axes[1][a] =
            (normal[(a + 1) % 3] * axes[0][(a + 2) % 3] - normal[(a + 2) % 3] * axes[0][(a + 1) % 3]) / size;
}

static double cross(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// The piece's outline, counter-clockwise, from `origin`. Corners beyond the most are left out: it shrinks.
static void project(const enf_complex *complex, int32_t piece, const double origin[3], double axes[2][3],
                    outline *out) {
    const enf_loops *pieces = &complex->pieces;
    out->count = 0;
    double area = 0;
    for (int64_t k = pieces->offset[piece]; k < pieces->offset[piece + 1] && out->count < CORNERS_MAX / 2;
         k++) {
        const double *p = complex->vertex_position[pieces->corners[k].vertex];
        double d[3] = {p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
        for (int a = 0; a < 2; a++) out->at[out->count][a] = dot(d, axes[a]);
        out->count++;
    }
    for (int k = 1; k + 1 < out->count; k++) area += cross(out->at[0], out->at[k], out->at[k + 1]);
    for (int i = 0, k = out->count - 1; area < 0 && i < k; i++, k--) {
        double swap[2] = {out->at[i][0], out->at[i][1]};
        memcpy(out->at[i], out->at[k], sizeof swap);
        memcpy(out->at[k], swap, sizeof swap);
    }
}

/// Keeps what lies left of the line from a to b.
static void clip(outline *shape, const double a[2], const double b[2]) {
    outline kept = {.count = 0};
    for (int i = 0; i < shape->count; i++) {
        const double *p = shape->at[i], *q = shape->at[(i + 1) % shape->count];
        double side = cross(a, b, p), next = cross(a, b, q);
        if (side >= 0 && kept.count < CORNERS_MAX) memcpy(kept.at[kept.count++], p, sizeof kept.at[0]);
        if ((side < 0) == (next < 0) || kept.count == CORNERS_MAX) continue;
        double t = side / (side - next);
        for (int k = 0; k < 2; k++) kept.at[kept.count][k] = p[k] + t * (q[k] - p[k]);
        kept.count++;
    }
    *shape = kept;
}

/// Of the narrowest strip that holds the outline; it has an edge on its side.
static double outline_width(const outline *shape) {
    double width = HUGE_VAL;
    for (int i = 0; i < shape->count; i++) {
        const double *p = shape->at[i], *q = shape->at[(i + 1) % shape->count];
        double length = hypot(q[0] - p[0], q[1] - p[1]), farthest = 0;
        if (length == 0) continue;
        for (int k = 0; k < shape->count; k++)
            farthest = fmax(farthest, fabs(cross(p, q, shape->at[k])) / length);
        width = fmin(width, farthest);
    }
    return width == HUGE_VAL ? 0 : width;
}

// ---- joining

/// The ports of one cell.
static void join_ports(const enf_complex *complex, const port *ports, size_t count, double crack,
                       int32_t *parent) {
    int32_t first_piece = complex->cell_count + 1;
    const enf_loops *pieces = &complex->pieces;
    const double *origin = complex->vertex_position[pieces->corners[pieces->offset[ports[0].piece]].vertex];
    double axes[2][3];
    choose_axes(complex, ports[0].cell, axes);
    for (size_t i = 0; i < count; i++) {
        outline one;
        project(complex, ports[i].piece, origin, axes, &one);
        for (size_t k = 0; k < i; k++) {
            outline other, both = one;
            project(complex, ports[k].piece, origin, axes, &other);
            for (int e = 0; e < other.count && both.count > 0; e++)
                clip(&both, other.at[e], other.at[(e + 1) % other.count]);
            if (outline_width(&both) < crack) continue;
            enf_sets_unite(parent, first_piece + ports[i].piece, first_piece + ports[k].piece);
        }
    }
}

static int compare_ports(const void *left, const void *right) {
    const port *a = left, *b = right;
    if (a->cell != b->cell) return a->cell < b->cell ? -1 : 1;
    return (a->piece > b->piece) - (a->piece < b->piece);
}

bool enf_gaps_join(const enf_complex *complex, const int32_t *face_cell, double crack, bool *gap,
                   int32_t *parent) {
    int32_t outside = complex->cell_count, cell[2];
    port *ports = NULL;
    size_t count = 0, capacity = 0;
    find_gaps(complex, face_cell, crack, gap);
    for (int32_t p = 0; p < complex->pieces.count; p++) {
        if (complex->piece_cover[p] != ENF_PIECE_OPEN || enf_complex_piece_width(complex, p) < crack)
            continue;
        piece_cells(complex, face_cell, p, cell);
        for (int side = 0; side < 2; side++) {
            if (cell[side] < 0 || !gap[cell[side]]) {
                enf_sets_unite(parent, cell[side] < 0 ? outside : cell[side], outside + 1 + p);
                continue;
            }
            if (!enf_array_reserve(ports, capacity, count + 1)) {
                free(ports);
                return false;
            }
            ports[count++] = (port){cell[side], p};
        }
    }
    if (count) qsort(ports, count, sizeof *ports, compare_ports);
    for (size_t first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && ports[end].cell == ports[first].cell;) end++;
        join_ports(complex, ports + first, end - first, crack, parent);
    }
    free(ports);
    return true;
}
