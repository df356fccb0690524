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

enum { CORNERS_MAX = 64, PLACES_MAX = 256 };

/// A wide open piece of a gap cell.
typedef struct port {
    int32_t cell, piece;
} port;

typedef struct outline {
    int count;
    double at[CORNERS_MAX][2];
} outline;

// ---- which cells

/// Volumes and surfaces of cells, from one walk over the facets; cones with their tips at a corner of the
/// cell.
typedef struct sizes {
    double *volume, *surface;
    int32_t *tip; ///< a vertex; -1: none yet
} sizes;

static void add_facet(const enf_complex *complex, sizes *s, int32_t facet) {
    const double(*at)[3] = (const double(*)[3])complex->vertex_position;
    const enf_corner *corners = complex->facets.corners + complex->facets.offset[facet];
    int64_t count = complex->facets.offset[facet + 1] - complex->facets.offset[facet];
    double area[3];
    enf_loop_area(corners, count, at, area);
    double size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
    for (int side = 0; side < 2; side++) {
        int32_t cell = complex->facet_cell[facet][side];
        if (cell < 0) continue;
        if (s->tip[cell] < 0) s->tip[cell] = corners[0].vertex;
        const double *tip = at[s->tip[cell]], *corner = at[corners[0].vertex];
        double height = 0;
        for (int k = 0; k < 3; k++) height += area[k] * (corner[k] - tip[k]) / 3;
        s->volume[cell] += side == 0 ? height : -height;
        s->surface[cell] += size;
    }
}

#define ROUNDING_ROOM 1.001   ///< these sums and those of enf_complex_measure_cell differ by less
#define WORLD_DIAGONAL 0x1p55 ///< grid steps, and more: coordinates are below 2^53

/// May the cell be thinner than `crack`, as far as its volume and surface tell? A needle may be as long as
/// the world. Cells that may be are measured properly: enf_body_is_hairline decides.
static bool may_be_thin(double volume, double surface, double crack) {
    return 2 * volume <= ROUNDING_ROOM * crack * surface || surface <= crack * WORLD_DIAGONAL;
}

static bool find_thin(const enf_complex *complex, double crack, const uint8_t *wall, bool *gap) {
    size_t cells = (size_t)complex->cell_count;
    sizes s = {enf_array_zeroed(cells, sizeof *s.volume), enf_array_zeroed(cells, sizeof *s.surface),
               enf_array_new(cells, sizeof *s.tip)};
    bool good = s.volume && s.surface && s.tip;
    if (good) {
        memset(s.tip, 0xff, cells * sizeof *s.tip);
        for (int32_t f = 0; f < complex->facet_count; f++) {
            const int32_t *cell = complex->facet_cell[f];
            if ((cell[0] >= 0 && wall[cell[0]]) || (cell[1] >= 0 && wall[cell[1]])) add_facet(complex, &s, f);
        }
        for (int32_t c = 0; c < complex->cell_count; c++) {
            enf_body_size body = {.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                  .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
            if (!wall[c] || !may_be_thin(s.volume[c], s.surface[c], crack)) continue;
            enf_complex_measure_cell(complex, c, &body);
            gap[c] = enf_body_is_hairline(&body, crack);
        }
    }
    free(s.volume);
    free(s.surface);
    free(s.tip);
    return good;
}

/// Is a tetrahedron too thick for a gap, whatever rounding does? With edges up to `longest`, its surface is
/// at most 1.74 longest^2 and at least six times its volume / longest, so volume alone tells that it is
/// neither flat nor a needle.
static bool is_thick(const double *points, const int32_t corner[4], double crack) {
    const double *origin = points + 3 * (size_t)corner[0];
    double edge[3][3], largest = 0; // squared
    for (int i = 0; i < 3; i++) {
        const double *p = points + 3 * (size_t)corner[i + 1];
        for (int k = 0; k < 3; k++) edge[i][k] = p[k] - origin[k];
        double square = edge[i][0] * edge[i][0] + edge[i][1] * edge[i][1] + edge[i][2] * edge[i][2];
        largest = square > largest ? square : largest;
    }
    const double *u = edge[0], *v = edge[1], *w = edge[2];
    double six_volumes = w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
                         w[2] * (u[0] * v[1] - u[1] * v[0]);
    double square = 4 * largest; // of the longest edge, at most
    return six_volumes > square * (6 * crack + 1e-13 * sqrt(square));
}

/// Most cells are one whole tetrahedron, and most of these are no gaps.
static void leave_out_thick(const enf_complex *complex, double crack, uint8_t *wall) {
    for (int32_t t = 0; t < complex->tetrahedron_count; t++) {
        int32_t cell = -1 - complex->tetrahedron_root[t];
        if (cell < 0 || !wall[cell]) continue;
        if (complex->cell_facet[cell + 1] - complex->cell_facet[cell] != 4) continue; // was joined to others
        if (is_thick(complex->points, complex->tetrahedra[t], crack)) wall[cell] = 0;
    }
}

bool enf_gaps_find(const enf_complex *complex, double crack, bool *gap) {
    uint8_t *wall = enf_array_zeroed((size_t)complex->cell_count, sizeof *wall);
    bool good = wall != NULL;
    for (int32_t p = 0; good && p < complex->pieces.count; p++) {
        const int32_t *cell = enf_complex_piece_cells(complex, p);
        for (int side = 0; side < 2; side++)
            if (complex->piece_cover[p] != ENF_PIECE_OPEN && cell[side] >= 0) wall[cell[side]] = 1;
    }
    if (good) leave_out_thick(complex, crack, wall);
    good = good && find_thin(complex, crack, wall, gap);
    free(wall);
    return good;
}

// ---- what lies above what

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Two directions of length 1 in the plane of the cell's largest face.
static void choose_axes(const enf_complex *complex, int32_t cell, double axes[2][3]) {
    const enf_loops *facets = &complex->facets;
    double normal[3] = {0, 0, 1}, most = 0;
    for (int32_t i = complex->cell_facet[cell]; i < complex->cell_facet[cell + 1]; i++) {
        int32_t f = complex->cell_facets[i];
        double area[3];
        enf_loop_area(facets->corners + facets->offset[f], facets->offset[f + 1] - facets->offset[f],
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
    int32_t corner_count;
    const enf_corner *corners = enf_complex_piece(complex, piece, &corner_count);
    out->count = 0;
    double area = 0;
    for (int32_t k = 0; k < corner_count && out->count < CORNERS_MAX / 2; k++) {
        const double *p = complex->vertex_position[corners[k].vertex];
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

static void copy_outline(outline *to, const outline *from) {
    to->count = from->count;
    memcpy(to->at, from->at, (size_t)from->count * sizeof *from->at);
}

/// Keeps what lies left of the line from a to b.
static void clip(outline *shape, const double a[2], const double b[2]) {
    outline kept; // only what is counted is set
    kept.count = 0;
    for (int i = 0; i < shape->count; i++) {
        const double *p = shape->at[i], *q = shape->at[(i + 1) % shape->count];
        double side = cross(a, b, p), next = cross(a, b, q);
        if (side >= 0 && kept.count < CORNERS_MAX) memcpy(kept.at[kept.count++], p, sizeof kept.at[0]);
        if ((side < 0) == (next < 0) || kept.count == CORNERS_MAX) continue;
        double t = side / (side - next);
        for (int k = 0; k < 2; k++) kept.at[kept.count][k] = p[k] + t * (q[k] - p[k]);
        kept.count++;
    }
    copy_outline(shape, &kept);
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

/// What is looked through: all ports, by cell.
typedef struct layer {
    const enf_complex *complex;
    const bool *gap;
    const port *ports;
    size_t count;
    double crack;
} layer;

/// A place on the way through a layer, straight along its thin direction: into a cell, through what is open
/// of all pieces so far.
typedef struct place {
    int32_t cell, through;
    outline open;
} place;

static void put_place(place *to, int32_t cell, int32_t through, const outline *open) {
    to->cell = cell;
    to->through = through;
    copy_outline(&to->open, open);
}

static size_t first_port(const layer *l, int32_t cell) {
    size_t low = 0, high = l->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (l->ports[middle].cell < cell)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/// Unites the thick cell before `start` with those that a straight way leads to. What takes more than the
/// most steps stays closed.
static void look_through(const layer *l, port start, place stack[PLACES_MAX], int32_t *parent) {
    const enf_complex *complex = l->complex;
    int32_t corner_count;
    const double *origin =
        complex->vertex_position[enf_complex_piece(complex, start.piece, &corner_count)[0].vertex];
    double axes[2][3];
    int waiting = 1, outside = complex->cell_count;
    const int32_t *cell = enf_complex_piece_cells(complex, start.piece);
    int32_t from = cell[0] == start.cell ? cell[1] : cell[0];
    choose_axes(complex, start.cell, axes);
    stack[0].cell = start.cell;
    stack[0].through = start.piece;
    project(complex, start.piece, origin, axes, &stack[0].open);
    for (int steps = 0; waiting > 0 && steps < PLACES_MAX; steps++) {
        place here;
        const place *next = &stack[--waiting];
        put_place(&here, next->cell, next->through, &next->open);
        for (size_t k = first_port(l, here.cell); k < l->count && l->ports[k].cell == here.cell; k++) {
            int32_t piece = l->ports[k].piece;
            if (piece == here.through) continue;
            outline shape, both;
            copy_outline(&both, &here.open);
            project(complex, piece, origin, axes, &shape);
            for (int e = 0; e < shape.count && both.count > 0; e++)
                clip(&both, shape.at[e], shape.at[(e + 1) % shape.count]);
            if (outline_width(&both) < l->crack) continue;
            cell = enf_complex_piece_cells(complex, piece);
            int32_t to = cell[0] == here.cell ? cell[1] : cell[0];
            if (to < 0 || !l->gap[to])
                enf_sets_unite(parent, from < 0 ? outside : from, to < 0 ? outside : to);
            else if (waiting < PLACES_MAX)
                put_place(&stack[waiting++], to, piece, &both);
        }
    }
}

static int compare_ports(const void *left, const void *right) {
    const port *a = left, *b = right;
    if (a->cell != b->cell) return a->cell < b->cell ? -1 : 1;
    return (a->piece > b->piece) - (a->piece < b->piece);
}

bool enf_gaps_join(const enf_complex *complex, double crack, const bool *gap, const int32_t *pieces,
                   size_t piece_count, int32_t *parent) {
    port *ports = NULL;
    size_t count = 0, capacity = 0;
    place *stack = enf_array_new(PLACES_MAX, sizeof *stack);
    bool good = stack != NULL;
    for (size_t i = 0; i < piece_count && good; i++) {
        const int32_t *cell = enf_complex_piece_cells(complex, pieces[i]);
        if (enf_complex_piece_width(complex, pieces[i]) < crack) continue;
        for (int side = 0; side < 2 && good; side++) {
            if (cell[side] < 0 || !gap[cell[side]]) continue;
            good = enf_array_reserve(ports, capacity, count + 1);
            if (good) ports[count++] = (port){cell[side], pieces[i]};
        }
    }
    if (good && count) qsort(ports, count, sizeof *ports, compare_ports);
    layer l = {complex, gap, ports, count, crack};
    for (size_t k = 0; k < count && good; k++) {
        const int32_t *cell = enf_complex_piece_cells(complex, ports[k].piece);
        int32_t before = cell[0] == ports[k].cell ? cell[1] : cell[0];
        if (before < 0 || !gap[before]) look_through(&l, ports[k], stack, parent);
    }
    free(ports);
    free(stack);
    return good;
}
