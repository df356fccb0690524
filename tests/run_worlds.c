// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_worlds.h"

#include "build/write.h"
#include "format/frame.h"
#include "format/pvs_row.h"
#include "format/save.h"
#include "format/sections.h"
#include "world_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CORNERS_MAX = 8 };

typedef struct opening {
    int32_t cell[2]; ///< ascending
    int32_t key;     ///< openings of equal cells and key are one portal
    int32_t order;
    double corner[CORNERS_MAX][3]; ///< grid; counter-clockwise seen from cell[0]
    int count;
} opening;

typedef struct maker {
    fixture fixture;
    enf_build_image image;
    int side;
    uint64_t seed;
    int32_t cube_count;
    int32_t *cell_of; ///< per cube; -1: not air
    opening *openings;
    int32_t opening_count;
    enf_file_cell *cells;
    enf_file_portal *portals;
    enf_file_portal_polygon *polygons;
    double (*vertices)[3];
    int32_t *cell_portals, *cell_triangles, *fine_cell;
    enf_file_pvs pvs;
    int64_t *pvs_offset;
    uint8_t *pvs_rows;
} maker;

uint64_t run_random(uint64_t *seed) {
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

double run_random_share(uint64_t *seed) {
    return (double)(run_random(seed) >> 11) * 0x1p-53;
}

static void *take(size_t count, size_t size) {
    void *memory = calloc(count + 1, size);
    if (!memory) abort();
    return memory;
}

static int32_t cube_at(const maker *m, const int at[3]) {
    return (int32_t)((at[0] * m->side + at[1]) * m->side + at[2]);
}

/// Calls visit for every pair of cubes of air that share a face, lower one first.
static void visit_faces(maker *m,
                        void (*visit)(maker *m, const int at[3], int axis, int32_t low, int32_t high)) {
    for (int32_t cube = 0; cube < m->cube_count; cube++) {
        int n = m->side, at[3] = {cube / (n * n), cube / n % n, cube % n};
        for (int axis = 0; axis < 3; axis++) {
            int next[3] = {at[0], at[1], at[2]};
            if (++next[axis] < n && m->cell_of[cube] >= 0 && m->cell_of[cube_at(m, next)] >= 0)
                visit(m, at, axis, cube, cube_at(m, next));
        }
    }
}

static void join_cells(maker *m, const int at[3], int axis, int32_t low, int32_t high) {
    int32_t from = m->cell_of[high], to = m->cell_of[low];
    (void)at;
    (void)axis;
    if (from == to || run_random(&m->seed) % 5) return;
    for (int32_t i = 0; i < m->cube_count; i++)
        if (m->cell_of[i] == from) m->cell_of[i] = to;
}

static int32_t number_cells(maker *m) {
    int32_t *number = take((size_t)m->cube_count, sizeof *number), count = 0;
    for (int32_t i = 0; i < m->cube_count; i++) {
        if (m->cell_of[i] < 0) continue;
        int32_t *cell = &number[m->cell_of[i]];
        if (!*cell) *cell = ++count;
        m->cell_of[i] = *cell - 1;
    }
    free(number);
    return count;
}

/// A random convex polygon in the face at the upper end of `axis`.
static void add_opening(maker *m, const int at[3], int axis, int32_t low, int32_t high) {
    if (m->cell_of[low] == m->cell_of[high] || run_random(&m->seed) % 4 == 0) return;
    opening *o = &m->openings[m->opening_count];
    bool swap = m->cell_of[low] > m->cell_of[high], whole = run_random(&m->seed) % 3 == 0;
    o->cell[swap] = m->cell_of[low];
    o->cell[!swap] = m->cell_of[high];
    o->key = run_random(&m->seed) % 2 ? 0 : m->opening_count + 1;
    o->order = m->opening_count++;
    o->count = whole ? 4 : 3 + (int)(run_random(&m->seed) % (CORNERS_MAX - 2));
    double radius = 0.1 + 0.35 * run_random_share(&m->seed), phase = 7 * run_random_share(&m->seed);
    for (int k = 0; k < o->count; k++) {
        double angle = phase + (swap ? 2 : -2) * acos(-1) * k / o->count; // clockwise about the axis, or not
        double s = 0.5 + radius * cos(angle), t = 0.5 + radius * sin(angle);
        int corner = swap ? k : 3 - k;
        if (whole) s = corner == 1 || corner == 2, t = corner >= 2;
        o->corner[k][axis] = (at[axis] + 1) * FIXTURE_SPACING;
        o->corner[k][(axis + 1) % 3] = (at[(axis + 1) % 3] + s) * FIXTURE_SPACING;
        o->corner[k][(axis + 2) % 3] = (at[(axis + 2) % 3] + t) * FIXTURE_SPACING;
    }
}

static int compare_openings(const void *a, const void *b) {
    const opening *p = a, *q = b;
    const int32_t *x = &p->cell[0], *y = &q->cell[0];
    if (x[0] != y[0]) return x[0] < y[0] ? -1 : 1;
    if (x[1] != y[1]) return x[1] < y[1] ? -1 : 1;
    if (p->key != q->key) return p->key < q->key ? -1 : 1;
    return p->order < q->order ? -1 : 1;
}

static void add_polygon(maker *m, const opening *o, bool back) {
    enf_file_view *view = &m->image.view;
    enf_file_portal_polygon *polygon = &m->polygons[view->portal_polygon_count++];
    double(*corner)[3] = m->vertices + view->portal_vertex_count, length = 0;
    *polygon = (enf_file_portal_polygon){.vertex_first = view->portal_vertex_count, .vertex_count = o->count};
    view->portal_vertex_count += o->count;
    for (int k = 0; k < o->count; k++)
        enf_view_to_world(view, o->corner[back ? o->count - 1 - k : k], corner[k]);
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        polygon->plane[a] = (corner[1][b] - corner[0][b]) * (corner[2][c] - corner[0][c]) -
                            (corner[1][c] - corner[0][c]) * (corner[2][b] - corner[0][b]);
        length += polygon->plane[a] * polygon->plane[a];
    }
    for (int a = 0; a < 3; a++) {
        polygon->plane[a] /= sqrt(length);
        polygon->plane[3] -= polygon->plane[a] * corner[0][a];
    }
}

static void make_sphere(maker *m, enf_file_portal *portal, int32_t first) {
    int32_t end = m->image.view.portal_vertex_count;
    for (int a = 0; a < 3; a++) {
        portal->centre[a] = 0;
        for (int32_t k = first; k < end; k++) portal->centre[a] += m->vertices[k][a] / (end - first);
    }
    for (int32_t k = first; k < end; k++) {
        const double *v = m->vertices[k], *c = portal->centre;
        double x = v[0] - c[0], y = v[1] - c[1], z = v[2] - c[2];
        portal->radius = fmax(portal->radius, sqrt(x * x + y * y + z * z) * (1 + 0x1p-40));
    }
}

static void make_portals(maker *m) {
    enf_file_view *view = &m->image.view;
    size_t most = 2 * (size_t)m->opening_count;
    m->portals = take(most, sizeof *m->portals);
    m->polygons = take(most, sizeof *m->polygons);
    m->vertices = take(most * CORNERS_MAX, sizeof *m->vertices);
    m->cell_portals = take(most, sizeof *m->cell_portals);
    view->portal_count = view->portal_polygon_count = view->portal_vertex_count = view->cell_portal_count = 0;
    qsort(m->openings, (size_t)m->opening_count, sizeof *m->openings, compare_openings);
    for (int32_t i = 0, end; i < m->opening_count; i = end) {
        const opening *o = &m->openings[i];
        for (end = i + 1; end < m->opening_count; end++)
            if (memcmp(m->openings[end].cell, o->cell, sizeof o->cell) || m->openings[end].key != o->key)
                break;
        for (int back = 0; back < 2; back++) {
            enf_file_portal *portal = &m->portals[view->portal_count++];
            int32_t vertex = view->portal_vertex_count;
            *portal =
                (enf_file_portal){.from = o->cell[back], .to = o->cell[!back], .polygon_count = end - i};
            portal->polygon_first = view->portal_polygon_count;
            for (int32_t k = i; k < end; k++) add_polygon(m, &m->openings[k], back);
            make_sphere(m, portal, vertex);
        }
    }
    view->portals = m->portals;
    view->portal_polygons = m->polygons;
    view->portal_vertices = (const double(*)[3])m->vertices;
    view->cell_portals = m->cell_portals;
}

static void grow_box(enf_file_cell *cell, const double point[3]) {
    for (int a = 0; a < 3; a++) {
        cell->box_min[a] = fmin(cell->box_min[a], point[a]);
        cell->box_max[a] = fmax(cell->box_max[a], point[a]);
    }
}

static bool box_meets(const enf_file_cell *cell, const enf_file_view *view,
                      const enf_file_triangle *triangle) {
    bool meets = true;
    for (int a = 0; a < 3; a++) {
        double low = INFINITY, high = -INFINITY;
        for (int k = 0; k < 3; k++) {
            low = fmin(low, view->render_points[triangle->point[k]][a]);
            high = fmax(high, view->render_points[triangle->point[k]][a]);
        }
        meets = meets && low <= cell->box_max[a] && high >= cell->box_min[a];
    }
    return meets;
}

static void make_cells(maker *m, int32_t count) {
    enf_file_view *view = &m->image.view;
    m->cells = take((size_t)count, sizeof *m->cells);
    for (int32_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) m->cells[i].box_min[a] = INFINITY, m->cells[i].box_max[a] = -INFINITY;
    for (int32_t cube = 0; cube < m->cube_count; cube++) {
        int n = m->side, at[3] = {cube / (n * n), cube / n % n, cube % n};
        for (int k = 0; k < 8 && m->cell_of[cube] >= 0; k++) {
            double grid[3], point[3];
            for (int a = 0; a < 3; a++) grid[a] = (at[a] + (k >> a & 1)) * FIXTURE_SPACING;
            enf_view_to_world(view, grid, point);
            grow_box(&m->cells[m->cell_of[cube]], point);
        }
    }
    m->cell_triangles = take((size_t)count * (size_t)view->triangle_count, sizeof *m->cell_triangles);
    view->cell_triangle_count = 0;
    for (int32_t i = 0; i < count; i++) {
        enf_file_cell *cell = &m->cells[i];
        cell->portal_first = view->cell_portal_count;
        for (int32_t k = 0; k < view->portal_count; k++)
            if (m->portals[k].from == i) m->cell_portals[view->cell_portal_count++] = k;
        cell->portal_count = view->cell_portal_count - cell->portal_first;
        cell->triangle_first = view->cell_triangle_count;
        for (int32_t k = 0; k < view->triangle_count; k++)
            if (box_meets(cell, view, &view->triangles[k]))
                m->cell_triangles[view->cell_triangle_count++] = k;
        cell->triangle_count = (int32_t)(view->cell_triangle_count - cell->triangle_first);
    }
    view->cell_count = count;
    view->cells = m->cells;
    view->cell_triangles = m->cell_triangles;
    m->fine_cell = take((size_t)view->fine_count, sizeof *m->fine_cell);
    for (int32_t i = 0; i < view->fine_count; i++)
        m->fine_cell[i] = m->cell_of[fixture_tetrahedron_of(&m->fixture, i) / 6];
    view->fine_cell = m->fine_cell;
}

static void make_pvs(maker *m) {
    enf_file_view *view = &m->image.view;
    size_t cells = (size_t)view->cell_count, bytes = enf_pvs_row_bytes(view->cell_count);
    uint8_t *row = take(bytes, 1), *near = take(cells, 1);
    m->pvs_offset = take(cells + 1, sizeof *m->pvs_offset);
    m->pvs_rows = take(2 * bytes * cells, 1);
    for (int32_t i = 0; i < view->cell_count; i++) {
        memset(row, 0, bytes);
        memset(near, 0, cells);
        near[i] = 1;
        for (int step = 1; step < 3; step++)
            for (int32_t k = 0; k < view->portal_count; k++)
                if (near[m->portals[k].from] == step && !near[m->portals[k].to])
                    near[m->portals[k].to] = (uint8_t)(step + 1);
        for (size_t k = 0; k < cells; k++) {
            m->pvs.pairs += near[k] != 0;
            if (near[k]) row[k / 8] |= (uint8_t)(1u << k % 8);
        }
        m->pvs_offset[i + 1] =
            m->pvs_offset[i] + (int64_t)enf_pvs_row_encode(row, bytes, m->pvs_rows + m->pvs_offset[i]);
    }
    view->pvs = &m->pvs;
    view->pvs_offset = m->pvs_offset;
    view->pvs_byte_count = m->pvs_offset[cells];
    view->pvs_rows = m->pvs_rows;
    free(row);
    free(near);
}

/// Drops what knows the fixture's own cells and portals: the exact complex and the barriers of sight.
static void drop_fixture(enf_file_view *view) {
    for (int i = 0; i < enf_section_spec_count; i++)
        if (enf_section_specs[i].part == ENF_PART_EXACT || enf_section_specs[i].part == ENF_PART_SIGHT)
            enf_view_set_array(view, &enf_section_specs[i], NULL);
    view->barrier_count = view->barrier_vertex_count = 0;
    view->wall_node_count = view->portal_node_count = 0;
    view->has_exact = false;
    enf_file_spawn *spawns = (enf_file_spawn *)(uintptr_t)view->spawns;
    for (int32_t i = 0; i < view->spawn_count; i++) spawns[i].cell = -1;
}

/// Opens the bytes, which the world then owns.
static run_world open_bytes(unsigned char *bytes, size_t size) {
    run_world opened = {.bytes = bytes, .size = size};
    enf_error error;
    if (enf_world_open_memory(&opened.world, bytes, size, NULL, &error)) {
        fprintf(stderr, "%s\n", error.text);
        abort();
    }
    const enf_file_view *view = enf_world_file(opened.world);
    for (int a = 0; a < 3; a++) {
        opened.box_min[a] = INFINITY;
        opened.box_max[a] = -INFINITY;
        for (int32_t i = 0; i < view->cell_count; i++) {
            opened.box_min[a] = fmin(opened.box_min[a], view->cells[i].box_min[a]);
            opened.box_max[a] = fmax(opened.box_max[a], view->cells[i].box_max[a]);
        }
    }
    return opened;
}

/// Opens the file and removes it.
static run_world open_world(const char *path) {
    size_t size;
    unsigned char *bytes = fixture_read_file(path, &size);
    remove(path);
    return open_bytes(bytes, size);
}

run_world run_world_whole(int side) {
    fixture fixture;
    size_t size;
    fixture_make(&fixture, side, NULL);
    unsigned char *bytes = fixture_save(&fixture, &size);
    fixture_free(&fixture);
    return open_bytes(bytes, size);
}

static void name_file(char path[]) {
    int file = mkstemp(path);
    if (file < 0) abort();
    close(file);
}

run_world run_world_grid(int side, bool turned, uint64_t seed) {
    maker m = {.side = side, .seed = seed, .cube_count = side * side * side};
    const enf_frame frame = {0.25, {0, 1, 2}, {1, 1, 1},
                             1,    turned,    {{0.6, 0, -0.8}, {0, 1, 0}, {0.8, 0, 0.6}}};
    fixture_make(&m.fixture, side, &frame);
    if (enf_build_image_make(&m.image, &m.fixture.build, "{}", NULL)) abort();
    m.cell_of = take((size_t)m.cube_count, sizeof *m.cell_of);
    for (int32_t i = 0; i < m.cube_count; i++) m.cell_of[i] = i < m.cube_count / 2 ? i : -1;
    visit_faces(&m, join_cells);
    int32_t count = number_cells(&m);
    m.openings = take(3 * (size_t)m.cube_count, sizeof *m.openings);
    visit_faces(&m, add_opening);
    drop_fixture(&m.image.view);
    make_portals(&m);
    make_cells(&m, count);
    make_pvs(&m);
    char path[] = "grid-XXXXXX";
    name_file(path);
    if (enf_view_save(&m.image.view, path, NULL)) abort();
    run_world grid = open_world(path);
    void *taken[] = {m.cell_of,      m.openings,       m.cells,     m.portals,    m.polygons, m.vertices,
                     m.cell_portals, m.cell_triangles, m.fine_cell, m.pvs_offset, m.pvs_rows};
    for (size_t i = 0; i < sizeof taken / sizeof *taken; i++) free(taken[i]);
    enf_build_image_free(&m.image);
    fixture_free(&m.fixture);
    return grid;
}

double run_nasty(uint64_t *seed) {
    static const double nasty[] = {0,      -0.0,     1,         -1,    1e-310,   1e300,
                                   -1e300, 0x1p1000, -0x1p1000, 1e150, 0x1p-1000};
    return nasty[run_random(seed) % (sizeof nasty / sizeof *nasty)];
}

static void scramble(const void *array, size_t count, uint64_t *seed) {
    double *numbers = (double *)(uintptr_t)array;
    for (size_t i = 0; i < count; i++)
        if (run_random(seed) % 4 == 0) numbers[i] = run_nasty(seed);
}

static void open_again(run_world *world) {
    enf_open_options options = {.size = sizeof options, .skip_checksums = true};
    enf_error error;
    enf_world_close(world->world);
    if (!enf_world_open_memory(&world->world, world->bytes, world->size, &options, &error)) return;
    fprintf(stderr, "%s\n", error.text);
    abort();
}

void run_world_scramble_lists(run_world *world, uint64_t *seed) {
    const enf_file_view *view = enf_world_file(world->world);
    for (int32_t i = 0; i < view->cell_count; i++) {
        const enf_file_cell *cell = &view->cells[i];
        int32_t *list = (int32_t *)(uintptr_t)view->cell_portals + cell->portal_first;
        if (cell->portal_count < 2 || run_random(seed) % 4) continue;
        uint64_t to = run_random(seed) % (uint64_t)cell->portal_count;
        list[to] = list[run_random(seed) % (uint64_t)cell->portal_count];
    }
    open_again(world);
}

void run_world_scramble(run_world *world, uint64_t *seed) {
    const enf_file_view *view = enf_world_file(world->world);
    scramble(view->portal_vertices, 3 * (size_t)view->portal_vertex_count, seed);
    scramble(view->render_points, 3 * (size_t)view->render_point_count, seed);
    for (int32_t i = 0; i < view->portal_polygon_count; i++)
        if (run_random(seed) % 2) scramble(view->portal_polygons[i].plane, 4, seed);
    for (int32_t i = 0; i < view->portal_count; i++) {
        enf_file_portal *portal = (enf_file_portal *)(uintptr_t)&view->portals[i];
        if (run_random(seed) % 4 == 0) portal->radius = fabs(run_nasty(seed));
        if (run_random(seed) % 4 == 0) portal->centre[run_random(seed) % 3] = run_nasty(seed);
    }
    open_again(world);
}

void run_world_free(run_world *opened) {
    enf_world_close(opened->world);
    free(opened->bytes);
}

#ifdef ENFILADE_CLI
run_world run_world_compile(const char *from) {
    enf_build build = {0};
    enf_error error = {0};
    enf_build_options options = {.clean = {.weld = -1, .plane_tolerance = -1}, .threads = 1};
    char path[] = "compiled-XXXXXX";
    name_file(path);
    enf_status status = enf_soup_read(&build.soup, from, &error);
    if (!status) status = enf_build_run(&build, &options, &error);
    if (!status) status = enf_build_write(&build, "{}", path, &error);
    if (status) {
        fprintf(stderr, "%s: %s\n", from, error.text);
        abort();
    }
    enf_build_free(&build);
    return open_world(path);
}
#endif
