// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds for the tests of decimation: lattices of cubes, and boxes cut by random planes. Include after
// cmocka.h.
#ifndef ENF_TESTS_DECIMATE_WORLDS_H
#define ENF_TESTS_DECIMATE_WORLDS_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "build/graph.h"

enum { MOST_CORNERS = 40, MOST_PIECES = 8000 };

static inline uint64_t next_random(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static inline double random_unit(uint64_t *state) {
    return (double)(next_random(state) >> 11) * 0x1p-53;
}

// ---- Worlds ----

typedef struct flat {
    int32_t cell[2];
    bool open;
    int count;
    double corners[MOST_CORNERS][3];
} flat;

typedef struct world {
    int32_t cell_count;
    int count;
    flat *pieces;
} world;

static inline world world_new(void) {
    world w = {.pieces = calloc(MOST_PIECES, sizeof(flat))};
    assert_non_null(w.pieces);
    return w;
}

static inline void add_piece(world *w, const flat *piece) {
    assert_true(w->count < MOST_PIECES);
    w->pieces[w->count++] = *piece;
}

/// The faces of the lattice cube at (x, y, z): `axis` and its two successors, the front in positive
/// direction.
static inline flat lattice_face(int axis, const int at[3], double size) {
    static const int steps[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    flat face = {.count = 4};
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k) {
            int step = k == (axis + 1) % 3 ? steps[i][0] : k == (axis + 2) % 3 ? steps[i][1] : 0;
            face.corners[i][k] = (at[k] + step) * size;
        }
    return face;
}

/// `cell_at` tells the cell of each lattice place, -1 for rock; its size is size[0] * size[1] * size[2], x
/// fastest.
static inline world lattice_world(const int size[3], const int32_t *cell_at, double unit, int closed_of_100,
                                  uint64_t *seed) {
    world w = world_new();
    for (int axis = 0; axis < 3; ++axis)
        for (int z = 0; z <= size[2]; ++z)
            for (int y = 0; y <= size[1]; ++y)
                for (int x = 0; x <= size[0]; ++x) {
                    int at[3] = {x, y, z}, cells[2];
                    bool outside = false;
                    for (int k = 0; k < 3; ++k) outside = outside || (k != axis && at[k] == size[k]);
                    if (outside) continue;
                    for (int s = 0; s < 2; ++s) {
                        int p[3] = {x, y, z};
                        p[axis] += s - 1;
                        bool in = p[axis] >= 0 && p[axis] < size[axis];
                        cells[s] = in ? cell_at[(p[2] * size[1] + p[1]) * size[0] + p[0]] : -1;
                        if (cells[s] >= w.cell_count) w.cell_count = cells[s] + 1;
                    }
                    if (cells[0] == cells[1]) continue;
                    flat face = lattice_face(axis, at, unit);
                    face.cell[0] = cells[0];
                    face.cell[1] = cells[1];
                    face.open =
                        cells[0] >= 0 && cells[1] >= 0 && (int)(next_random(seed) % 100) >= closed_of_100;
                    add_piece(&w, &face);
                }
    return w;
}

static inline double height_over(const double plane[4], const double p[3]) {
    return plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] - plane[3];
}

static inline flat clip(const flat *piece, const double plane[4], double sign) {
    flat out = *piece;
    out.count = 0;
    for (int i = 0; i < piece->count; ++i) {
        const double *p = piece->corners[i], *q = piece->corners[(i + 1) % piece->count];
        double a = sign * height_over(plane, p), b = sign * height_over(plane, q);
        assert_true(out.count + 2 < MOST_CORNERS);
        if (a >= 0) memcpy(out.corners[out.count++], p, sizeof out.corners[0]);
        if ((a > 0 && b < 0) || (a < 0 && b > 0)) {
            // The same edge gives the same point from both sides.
            if (memcmp(p, q, sizeof out.corners[0]) > 0) {
                const double *swap = p;
                p = q;
                q = swap;
                double other = a;
                a = b;
                b = other;
            }
            for (int k = 0; k < 3; ++k) out.corners[out.count][k] = p[k] + (q[k] - p[k]) * (a / (a - b));
            ++out.count;
        }
    }
    return out;
}

static inline void area_vector(const flat *piece, double sum[3]) {
    sum[0] = sum[1] = sum[2] = 0;
    for (int i = 0; i < piece->count; ++i) {
        const double *p = piece->corners[i], *q = piece->corners[(i + 1) % piece->count];
        for (int k = 0; k < 3; ++k)
            sum[k] += (p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3]) / 2;
    }
}

/// A plane polygon far larger than the world; its front is the positive side of the plane.
static inline flat large_square(const double plane[4]) {
    int k = fabs(plane[0]) < 0.6 ? 0 : 1;
    double u[3] = {0, 0, 0}, v[3], length = 0;
    u[k] = 1;
    for (int i = 0; i < 3; ++i) u[i] -= plane[k] * plane[i];
    for (int i = 0; i < 3; ++i) length += u[i] * u[i];
    for (int i = 0; i < 3; ++i) u[i] /= sqrt(length);
    for (int i = 0; i < 3; ++i)
        v[i] = plane[(i + 1) % 3] * u[(i + 2) % 3] - plane[(i + 2) % 3] * u[(i + 1) % 3];
    static const int signs[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    flat square = {.count = 4};
    for (int c = 0; c < 4; ++c)
        for (int i = 0; i < 3; ++i)
            square.corners[c][i] = plane[i] * plane[3] + 8 * (signs[c][0] * u[i] + signs[c][1] * v[i]);
    return square;
}

/// Cuts a cell by a plane; the part above it becomes a new cell.
static inline void cut_cell(world *w, int32_t cell, const double plane[4], bool open) {
    int32_t added = w->cell_count++;
    flat cap = large_square(plane);
    for (int i = 0, count = w->count; i < count; ++i) {
        flat *piece = &w->pieces[i];
        for (int s = 0; s < 2; ++s) {
            if (piece->cell[s] != cell) continue;
            double sum[3], length;
            area_vector(piece, sum);
            length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) * (s ? -1 : 1);
            double side[4] = {sum[0] / length, sum[1] / length, sum[2] / length, 0};
            side[3] = height_over(side, piece->corners[0]);
            cap = clip(&cap, side, -1);
            flat above = clip(piece, plane, 1), below = clip(piece, plane, -1);
            if (above.count < 3) continue;
            above.cell[s] = added;
            if (below.count < 3) {
                *piece = above;
            } else {
                *piece = below;
                add_piece(w, &above);
            }
            break;
        }
    }
    cap.cell[0] = cell;
    cap.cell[1] = added;
    cap.open = open;
    if (cap.count >= 3) add_piece(w, &cap);
}

/// A box cut by random planes: convex cells in general position, with T-junctions; some cells rock, some
/// pieces closed.
static inline world cut_world(int cells, uint64_t *seed) {
    static const int size[3] = {1, 1, 1};
    static const int32_t one = 0;
    world w = lattice_world(size, &one, 1, 0, seed);
    while (w.cell_count < cells) {
        int32_t cell = (int32_t)(next_random(seed) % (uint64_t)w.cell_count);
        double centre[3] = {0, 0, 0}, plane[4], length;
        int count = 0;
        for (int i = 0; i < w.count; ++i) {
            if (w.pieces[i].cell[0] != cell && w.pieces[i].cell[1] != cell) continue;
            for (int c = 0; c < w.pieces[i].count; ++c, ++count)
                for (int k = 0; k < 3; ++k) centre[k] += w.pieces[i].corners[c][k];
        }
        for (int k = 0; k < 3; ++k) plane[k] = random_unit(seed) - 0.5;
        length = sqrt(plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2]);
        for (int k = 0; k < 3; ++k) {
            plane[k] /= length;
            centre[k] /= count;
        }
        plane[3] = 0;
        plane[3] = height_over(plane, centre);
        cut_cell(&w, cell, plane, next_random(seed) % 8 != 0);
    }
    for (int i = 0; i < w.count; ++i)
        for (int s = 0; s < 2; ++s)
            if (w.pieces[i].cell[s] % 11 == 10) {
                w.pieces[i].cell[s] = -1;
                w.pieces[i].open = false;
            }
    return w;
}

typedef double vertex[3];

/// The corners of all pieces, one after the other. Free them when the graph is not needed any more.
static inline vertex *vertices_of(const world *w) {
    size_t corners = 0, at = 0;
    for (int i = 0; i < w->count; ++i) corners += (size_t)w->pieces[i].count;
    vertex *vertices = malloc(corners * sizeof *vertices + 1);
    assert_non_null(vertices);
    for (int i = 0; i < w->count; ++i) {
        const flat *piece = &w->pieces[i];
        memcpy(vertices[at], piece->corners, (size_t)piece->count * sizeof piece->corners[0]);
        at += (size_t)piece->count;
    }
    return vertices;
}

static inline enf_graph graph_of(const world *w, const vertex *vertices) {
    size_t count = (size_t)w->count, corners = 0;
    for (int i = 0; i < w->count; ++i) corners += (size_t)w->pieces[i].count;
    enf_graph graph = {
        .cell_count = w->cell_count, .piece_count = w->count, .vertices = vertices, .scale = 1};
    graph.piece_cell = malloc(count * sizeof *graph.piece_cell + 1);
    graph.piece_open = malloc(count * sizeof *graph.piece_open + 1);
    graph.piece_corner = malloc((count + 1) * sizeof *graph.piece_corner);
    graph.corners = malloc(corners * sizeof *graph.corners + 1);
    assert_true(graph.piece_cell && graph.piece_open && graph.piece_corner && graph.corners);
    int64_t at = 0;
    for (int i = 0; i < w->count; ++i) {
        const flat *piece = &w->pieces[i];
        memcpy(graph.piece_cell[i], piece->cell, sizeof piece->cell);
        graph.piece_open[i] = piece->open;
        graph.piece_corner[i] = at;
        for (int k = 0; k < piece->count; ++k, ++at) graph.corners[at] = (int32_t)at;
    }
    graph.piece_corner[count] = at;
    return graph;
}

/// Another order of the pieces, other first corners, some pieces seen from the other side.
static inline void shuffle(world *w, uint64_t *seed) {
    for (int i = 0; i < w->count; ++i) {
        int j = i + (int)(next_random(seed) % (uint64_t)(w->count - i));
        flat piece = w->pieces[j];
        w->pieces[j] = w->pieces[i];
        bool turned = next_random(seed) % 2;
        int start = (int)(next_random(seed) % (uint64_t)piece.count);
        flat *out = &w->pieces[i];
        *out = piece;
        for (int c = 0; c < piece.count; ++c) {
            int from = turned ? start + piece.count - c : start + c;
            memcpy(out->corners[c], piece.corners[from % piece.count], sizeof piece.corners[0]);
        }
        if (!turned) continue;
        out->cell[0] = piece.cell[1];
        out->cell[1] = piece.cell[0];
    }
}

#endif
