// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/complex.h"

#include "base/array.h"
#include "build/loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void enf_complex_free(enf_complex *complex) {
    void *arrays[] = {complex->planes,      complex->vertex_planes,    complex->vertex_position,
                      complex->tetrahedra,  complex->tetrahedron_root, complex->node_plane,
                      complex->node_child,  complex->cell_facet,       complex->cell_facets,
                      complex->facet_plane, complex->facet_cell,       complex->facet_cover,
                      complex->facet_piece, complex->cover_polygon,    complex->cover_side,
                      complex->piece_facet, complex->piece_cover,      complex->seen_offset,
                      complex->seen};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
    enf_loops_free(&complex->facets);
    enf_loops_free(&complex->covers);
    enf_loops_free(&complex->pieces);
    memset(complex, 0, sizeof *complex);
}

static const enf_corner *own_or_facet(const enf_complex *complex, const enf_loops *loops, int32_t loop,
                                      int32_t facet, int32_t *count) {
    const enf_loops *from = loops;
    if (loops->offset[loop] == loops->offset[loop + 1]) {
        from = &complex->facets;
        loop = facet;
    }
    *count = from->offset[loop + 1] - from->offset[loop];
    return from->corners + from->offset[loop];
}

const enf_corner *enf_complex_cover(const enf_complex *complex, int32_t cover, int32_t facet,
                                    int32_t *count) {
    return own_or_facet(complex, &complex->covers, cover, facet, count);
}

const enf_corner *enf_complex_piece(const enf_complex *complex, int32_t piece, int32_t *count) {
    return own_or_facet(complex, &complex->pieces, piece, complex->piece_facet[piece], count);
}

double enf_complex_cell_volume(const enf_complex *complex, int32_t cell) {
    const enf_loops *facets = &complex->facets;
    const double(*at)[3] = (const double(*)[3])complex->vertex_position;
    const double *origin = NULL;
    double volume = 0;
    for (int32_t i = complex->cell_facet[cell]; i < complex->cell_facet[cell + 1]; i++) {
        int32_t f = complex->cell_facets[i];
        const double *corner = at[facets->corners[facets->offset[f]].vertex];
        double area[3], height = 0;
        if (!origin) origin = corner;
        enf_loop_area(facets->corners + facets->offset[f], facets->offset[f + 1] - facets->offset[f], at,
                      area);
        for (int k = 0; k < 3; k++) height += area[k] * (corner[k] - origin[k]);
        volume += complex->facet_cell[f][0] == cell ? height : -height;
    }
    return volume / 3;
}

bool enf_body_is_hairline(const enf_body_size *body, double thin) {
    double square = 0;
    for (int k = 0; k < 3; k++) square += (body->high[k] - body->low[k]) * (body->high[k] - body->low[k]);
    return thin > 0 && (2 * body->volume <= thin * body->surface || body->surface <= thin * sqrt(square));
}

void enf_complex_measure_cell(const enf_complex *complex, int32_t cell, enf_body_size *body) {
    const enf_loops *facets = &complex->facets;
    body->volume += enf_complex_cell_volume(complex, cell);
    for (int32_t i = complex->cell_facet[cell]; i < complex->cell_facet[cell + 1]; i++) {
        int32_t f = complex->cell_facets[i];
        int64_t begin = facets->offset[f], end = facets->offset[f + 1];
        double area[3];
        enf_loop_area(facets->corners + begin, end - begin, (const double(*)[3])complex->vertex_position,
                      area);
        body->surface += sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
        for (int64_t c = begin; c < end; c++) {
            const double *at = complex->vertex_position[facets->corners[c].vertex];
            for (int k = 0; k < 3; k++) {
                body->low[k] = at[k] < body->low[k] ? at[k] : body->low[k];
                body->high[k] = at[k] > body->high[k] ? at[k] : body->high[k];
            }
        }
    }
}

void enf_complex_piece_area(const enf_complex *complex, int32_t piece, double area[3]) {
    int32_t count;
    const enf_corner *corners = enf_complex_piece(complex, piece, &count);
    enf_loop_area(corners, count, (const double(*)[3])complex->vertex_position, area);
}

void enf_complex_piece_centre(const enf_complex *complex, int32_t piece, double centre[3]) {
    int32_t count;
    const enf_corner *corners = enf_complex_piece(complex, piece, &count);
    centre[0] = centre[1] = centre[2] = 0;
    for (int32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) centre[k] += complex->vertex_position[corners[i].vertex][k] / count;
    }
}

double enf_complex_piece_width(const enf_complex *complex, int32_t piece) {
    int32_t count;
    const enf_corner *corners = enf_complex_piece(complex, piece, &count);
    double width = HUGE_VAL;
    for (int32_t i = 0; i < count; i++) { // the narrowest strip has an edge on its side
        const double *p = complex->vertex_position[corners[i].vertex];
        const double *q = complex->vertex_position[corners[(i + 1) % count].vertex];
        double u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]), farthest = 0;
        if (length == 0) continue; // shorter than a grid step
        for (int32_t k = 2; k < count; k++) {
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
