// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/complex.h"

#include "base/array.h"
#include "build/loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void enf_complex_free(enf_complex *complex) {
    void *arrays[] = {
        complex->planes,           complex->vertex_planes, complex->vertex_position, complex->tetrahedra,
        complex->tetrahedron_root, complex->node_plane,    complex->node_child,      complex->node_facet,
        complex->cell_tetrahedron, complex->cell_face,     complex->face_facet,      complex->face_side,
        complex->facet_plane,      complex->facet_hull,    complex->facet_cover,     complex->facet_piece,
        complex->cover_polygon,    complex->cover_side,    complex->piece_face,      complex->piece_cover,
        complex->seen_offset,      complex->seen};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
    enf_loops_free(&complex->faces);
    enf_loops_free(&complex->covers);
    enf_loops_free(&complex->pieces);
    memset(complex, 0, sizeof *complex);
}

int32_t *enf_complex_face_cells(const enf_complex *complex) {
    int32_t *cells = enf_array_new((size_t)complex->faces.count, sizeof *cells);
    if (!cells) return NULL;
    for (int32_t c = 0; c < complex->cell_count; c++) {
        for (int32_t f = complex->cell_face[c]; f < complex->cell_face[c + 1]; f++) cells[f] = c;
    }
    return cells;
}

double enf_complex_cell_volume(const enf_complex *complex, int32_t cell) {
    const enf_loops *faces = &complex->faces;
    const double(*at)[3] = (const double(*)[3])complex->vertex_position;
    int32_t first = complex->cell_face[cell];
    const double *origin = at[faces->corners[faces->offset[first]].vertex];
    double volume = 0;
    for (int32_t f = first; f < complex->cell_face[cell + 1]; f++) {
        double area[3], height = 0;
        enf_loop_area(faces->corners + faces->offset[f], faces->offset[f + 1] - faces->offset[f], at, area);
        const double *corner = at[faces->corners[faces->offset[f]].vertex];
        for (int k = 0; k < 3; k++) height += area[k] * (corner[k] - origin[k]);
        volume += complex->face_side[f] == 0 ? height : -height;
    }
    return volume / 3;
}

bool enf_body_is_hairline(const enf_body_size *body, double thin) {
    double square = 0;
    for (int k = 0; k < 3; k++) square += (body->high[k] - body->low[k]) * (body->high[k] - body->low[k]);
    return thin > 0 && (2 * body->volume <= thin * body->surface || body->surface <= thin * sqrt(square));
}

void enf_complex_measure_cell(const enf_complex *complex, int32_t cell, enf_body_size *body) {
    const enf_loops *faces = &complex->faces;
    body->volume += enf_complex_cell_volume(complex, cell);
    for (int32_t f = complex->cell_face[cell]; f < complex->cell_face[cell + 1]; f++) {
        int64_t begin = faces->offset[f], end = faces->offset[f + 1];
        double area[3];
        enf_loop_area(faces->corners + begin, end - begin, (const double(*)[3])complex->vertex_position,
                      area);
        body->surface += sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
        for (int64_t c = begin; c < end; c++) {
            const double *at = complex->vertex_position[faces->corners[c].vertex];
            for (int k = 0; k < 3; k++) {
                body->low[k] = fmin(body->low[k], at[k]);
                body->high[k] = fmax(body->high[k], at[k]);
            }
        }
    }
}

void enf_complex_piece_area(const enf_complex *complex, int32_t piece, double area[3]) {
    const enf_loops *pieces = &complex->pieces;
    enf_loop_area(pieces->corners + pieces->offset[piece], pieces->offset[piece + 1] - pieces->offset[piece],
                  (const double(*)[3])complex->vertex_position, area);
}

void enf_complex_loop_centre(const enf_complex *complex, const enf_loops *loops, int32_t loop,
                             double centre[3]) {
    double count = (double)(loops->offset[loop + 1] - loops->offset[loop]);
    centre[0] = centre[1] = centre[2] = 0;
    for (int64_t i = loops->offset[loop]; i < loops->offset[loop + 1]; i++) {
        for (int k = 0; k < 3; k++)
            centre[k] += complex->vertex_position[loops->corners[i].vertex][k] / count;
    }
}

double enf_complex_piece_width(const enf_complex *complex, int32_t piece) {
    const enf_loops *pieces = &complex->pieces;
    const enf_corner *corners = pieces->corners + pieces->offset[piece];
    int64_t count = pieces->offset[piece + 1] - pieces->offset[piece];
    double width = HUGE_VAL;
    for (int64_t i = 0; i < count; i++) { // the narrowest strip has an edge on its side
        const double *p = complex->vertex_position[corners[i].vertex];
        const double *q = complex->vertex_position[corners[(i + 1) % count].vertex];
        double u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]), farthest = 0;
        if (length == 0) continue; // shorter than a grid step
        for (int64_t k = 2; k < count; k++) {
            const double *r = complex->vertex_position[corners[(i + k) % count].vertex];
            double v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]}, square = 0;
            for (int a = 0; a < 3; a++) {
                int b = (a + 1) % 3, c = (a + 2) % 3;
                double part = u[b] * v[c] - u[c] * v[b];
                square += part * part;
            }
            farthest = fmax(farthest, sqrt(square) / length);
        }
        width = fmin(width, farthest);
    }
    return width == HUGE_VAL ? 0 : width;
}
