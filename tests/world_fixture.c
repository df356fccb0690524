// SPDX-License-Identifier: GPL-3.0-or-later
#include "world_fixture.h"

#include "base/hash.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void *take(fixture *f, size_t count, size_t size) {
    void *memory = calloc(count + 1, size);
    if (!memory || f->memory_count == FIXTURE_ALLOCATIONS) abort();
    f->memory[f->memory_count++] = memory;
    return memory;
}

static int32_t point_at(const fixture *f, int x, int y, int z) {
    return (int32_t)((x * (f->side + 1) + y) * (f->side + 1) + z);
}

static void make_points(fixture *f) {
    int32_t count = (f->side + 1) * (f->side + 1) * (f->side + 1);
    double *points = take(f, (size_t)count * 3, sizeof *points), *at = points;
    for (int x = 0; x <= f->side; x++) {
        for (int y = 0; y <= f->side; y++) {
            for (int z = 0; z <= f->side; z++) {
                *at++ = x * FIXTURE_SPACING;
                *at++ = y * FIXTURE_SPACING;
                *at++ = z * FIXTURE_SPACING;
            }
        }
    }
    f->build.mesh.points = points;
    f->build.mesh.point_count = (size_t)count;
    enf_complex *complex = &f->build.complex;
    complex->points = points;
    complex->point_count = complex->vertex_count = count;
    complex->vertex_planes = take(f, (size_t)count, sizeof *complex->vertex_planes);
    memset(complex->vertex_planes, 0xff, (size_t)count * sizeof *complex->vertex_planes);
    complex->vertex_position = take(f, (size_t)count, sizeof *complex->vertex_position);
    memcpy(complex->vertex_position, points, (size_t)count * 3 * sizeof *points);
}

/// Kuhn's subdivision: one tetrahedron for each order of the axes.
static void make_tetrahedra(fixture *f) {
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    enf_complex *complex = &f->build.complex;
    int n = f->side;
    complex->tetrahedra = take(f, (size_t)(6 * n * n * n), sizeof *complex->tetrahedra);
    for (int cube = 0; cube < n * n * n; cube++) {
        for (int order = 0; order < 6; order++) {
            int at[3] = {cube / (n * n), cube / n % n, cube % n};
            int32_t *corners = complex->tetrahedra[complex->tetrahedron_count++];
            for (int k = 0; k < 4; k++) {
                corners[k] = point_at(f, at[0], at[1], at[2]);
                if (k < 3) at[orders[order][k]]++;
            }
            if (order < 3) continue;
            int32_t swap = corners[1];
            corners[1] = corners[2];
            corners[2] = swap;
        }
    }
}

typedef struct key {
    int32_t corner[3], face;
} key;

static int compare_keys(const void *a, const void *b) {
    const key *p = a, *q = b;
    for (int k = 0; k < 3; k++) {
        if (p->corner[k] != q->corner[k]) return p->corner[k] < q->corner[k] ? -1 : 1;
    }
    return (p->face > q->face) - (p->face < q->face);
}

static double side_of(const double *p, const double *q, const double *r, const double *s) {
    double u[3], v[3], w[3];
    for (int a = 0; a < 3; a++) {
        u[a] = q[a] - p[a];
        v[a] = r[a] - p[a];
        w[a] = s[a] - p[a];
    }
    return w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
           w[2] * (u[0] * v[1] - u[1] * v[0]);
}

static void add_corner(enf_loops *loops, int32_t vertex, int32_t edge_plane) {
    loops->corners[loops->corner_count++] = (enf_corner){vertex, edge_plane};
    loops->offset[loops->count] = (int32_t)loops->corner_count;
}

static void new_loops(fixture *f, enf_loops *loops, int32_t most) {
    loops->offset = take(f, (size_t)most + 1, sizeof *loops->offset);
    loops->corners = take(f, (size_t)most * 3, sizeof *loops->corners);
}

static void add_loop(enf_loops *loops, const int32_t corner[3], int32_t plane) {
    loops->count++;
    for (int k = 0; k < 3; k++) add_corner(loops, corner[k], plane);
}

/// Facets with their planes, each one piece.
static void make_facets(fixture *f) {
    enf_complex *c = &f->build.complex;
    int32_t count = 4 * c->tetrahedron_count;
    key *keys = take(f, (size_t)count, sizeof *keys);
    for (int32_t i = 0; i < count; i++) {
        int32_t *corner = keys[i].corner;
        for (int k = 0, n = 0; k < 4; k++) {
            if (k != i % 4) corner[n++] = c->tetrahedra[i / 4][k];
        }
        for (int k = 0; k < 3; k++) { // ascending, by three exchanges
            int32_t *pair = corner + (k + 1) % 2, swap = pair[0];
            if (swap <= pair[1]) continue;
            pair[0] = pair[1];
            pair[1] = swap;
        }
        keys[i].face = i;
    }
    qsort(keys, (size_t)count, sizeof *keys, compare_keys);

    c->planes = take(f, (size_t)count + 1, sizeof *c->planes);
    c->facet_plane = take(f, (size_t)count, sizeof *c->facet_plane);
    c->facet_cell = take(f, (size_t)count, sizeof *c->facet_cell);
    c->piece_facet = take(f, (size_t)count, sizeof *c->piece_facet);
    new_loops(f, &c->facets, count);
    new_loops(f, &c->pieces, count);
    for (int32_t i = 0; i < count; i++) {
        bool is_new = i == 0 || memcmp(keys[i].corner, keys[i - 1].corner, sizeof keys[i].corner) != 0;
        if (is_new) {
            memcpy(c->planes[c->plane_count++], keys[i].corner, sizeof keys[i].corner);
            c->facet_plane[c->facet_count] = c->facet_count;
            c->facet_cell[c->facet_count][0] = c->facet_cell[c->facet_count][1] = -1;
            c->piece_facet[c->facet_count] = c->facet_count;
            c->facet_count++;
            c->pieces.count++; // without corners: the whole facet
            add_loop(&c->facets, keys[i].corner, 0);
        }
        int32_t face = keys[i].face;
        const double *p = c->points;
        double side = side_of(p + 3 * keys[i].corner[0], p + 3 * keys[i].corner[1], p + 3 * keys[i].corner[2],
                              p + 3 * c->tetrahedra[face / 4][face % 4]);
        c->facet_cell[c->facet_count - 1][side > 0] = face / 4;
    }
}

static bool facet_lies_at(const fixture *f, int32_t facet, int axis) {
    const int32_t *corner = f->build.complex.planes[facet];
    for (int k = 0; k < 3; k++) {
        if (f->build.complex.points[3 * corner[k] + axis] != f->side / 2 * FIXTURE_SPACING) return false;
    }
    return true;
}

/// The wall at half of x, and the screen at half of z if there is one.
static bool facet_is_wall(const fixture *f, int32_t facet) {
    const int32_t *corner = f->build.complex.planes[facet];
    double half = f->side / 2 * FIXTURE_SPACING;
    if (facet_lies_at(f, facet, 0)) return true;
    if (!f->has_screen || !facet_lies_at(f, facet, 2)) return false;
    for (int k = 0; k < 3; k++) {
        const double *point = &f->build.complex.points[3 * (size_t)corner[k]];
        if (point[0] > half || point[1] > half) return false;
    }
    return true;
}

/// A triangle of input and a cover on every facet that is wall.
static void make_wall(fixture *f) {
    enf_complex *c = &f->build.complex;
    enf_mesh *mesh = &f->build.mesh;
    size_t most = (size_t)c->facet_count;
    c->facet_cover = take(f, most + 1, sizeof *c->facet_cover);
    c->facet_piece = take(f, most + 1, sizeof *c->facet_piece);
    c->piece_cover = take(f, most, sizeof *c->piece_cover);
    c->cover_polygon = take(f, most, sizeof *c->cover_polygon);
    c->cover_side = take(f, most, sizeof *c->cover_side);
    new_loops(f, &c->covers, c->facet_count);
    mesh->polygon_corner = take(f, most + 1, sizeof *mesh->polygon_corner);
    mesh->corners = take(f, 3 * most, sizeof *mesh->corners);
    mesh->polygon_source = take(f, most, sizeof *mesh->polygon_source);
    mesh->polygon_plane = take(f, most, sizeof *mesh->polygon_plane);
    for (int32_t facet = 0; facet < c->facet_count; facet++) {
        c->piece_cover[facet] = -1;
        if (facet_is_wall(f, facet)) {
            int32_t polygon = (int32_t)mesh->polygon_count++;
            const int32_t *corner = c->planes[facet];
            c->piece_cover[facet] = c->covers.count;
            c->cover_polygon[c->covers.count] = polygon;
            c->cover_side[c->covers.count] = 1;
            if (polygon % 2) {
                c->covers.offset[++c->covers.count] = (int32_t)c->covers.corner_count; // the whole facet
            } else {
                add_loop(&c->covers, corner, 0);
            }
            mesh->polygon_source[polygon] = polygon;
            for (int k = 0; k < 3; k++)
                mesh->corners[3 * polygon + k] = mesh->polygon_plane[polygon][k] = corner[k];
            mesh->polygon_corner[polygon + 1] = 3 * (polygon + 1);
        }
        c->facet_cover[facet + 1] = c->covers.count;
        c->facet_piece[facet + 1] = facet + 1;
    }
}

/// The fine cells: the tetrahedra, and behind a plane through an edge of one of them another one.
static void make_fine_cells(fixture *f) {
    enf_complex *c = &f->build.complex;
    int32_t count = c->tetrahedron_count + 1;
    c->cell_count = count;
    c->cell_facet = take(f, (size_t)count + 1, sizeof *c->cell_facet);
    c->cell_facets = take(f, 4 * (size_t)count, sizeof *c->cell_facets);
    c->tetrahedron_root = take(f, (size_t)count, sizeof *c->tetrahedron_root);
    c->seen_offset = take(f, (size_t)count + 1, sizeof *c->seen_offset);
    c->seen = take(f, (size_t)count, sizeof *c->seen);
    f->cut = 0; // corners (0,0,0) (1,0,0) (1,1,0) (1,1,1); cut by the plane through the first two and (2,2,1)
    c->node_count = 1;
    c->node_plane = take(f, 1, sizeof *c->node_plane);
    c->node_child = take(f, 1, sizeof *c->node_child);
    int32_t plane = c->plane_count++;
    c->planes[plane][0] = c->tetrahedra[0][0];
    c->planes[plane][1] = c->tetrahedra[0][1];
    c->planes[plane][2] = point_at(f, 2, 2, 1);
    c->node_plane[0] = plane;
    c->node_child[0][0] = -1 - 0;
    c->node_child[0][1] = -1 - (count - 1);
    for (int32_t i = 0; i < count; i++) {
        if (i < count - 1) c->tetrahedron_root[i] = i == f->cut ? 0 : -1 - i;
        c->cell_facet[i + 1] = c->cell_facet[i];
        c->seen_offset[i + 1] = c->seen_offset[i];
        for (int32_t facet = 0; facet < c->facet_count; facet++) {
            int32_t cover = c->piece_cover[facet], side = c->facet_cell[facet][0] == i ? 0 : 1;
            if (c->facet_cell[facet][side] != i) continue;
            c->cell_facets[c->cell_facet[i + 1]++] = facet;
            if (cover >= 0 && c->cover_side[cover] == side)
                c->seen[c->seen_offset[i + 1]++] = c->cover_polygon[cover];
        }
    }
}

int32_t fixture_tetrahedron_of(const fixture *f, int32_t fine) {
    return fine == f->build.complex.tetrahedron_count ? f->cut : fine;
}

static void make_regions(fixture *f) {
    enf_complex *c = &f->build.complex;
    enf_regions *regions = &f->build.regions;
    double half = f->side / 2 * FIXTURE_SPACING, whole = f->side * FIXTURE_SPACING;
    regions->region_count = 2;
    regions->cell_region = take(f, (size_t)c->cell_count, sizeof *regions->cell_region);
    regions->kind = take(f, 2, sizeof *regions->kind);
    regions->kept = take(f, 2, sizeof *regions->kept);
    regions->touches_outside = take(f, 2, sizeof *regions->touches_outside);
    regions->winding = take(f, 2, sizeof *regions->winding);
    regions->ambiguous = take(f, 2, sizeof *regions->ambiguous);
    regions->volume = take(f, 2, sizeof *regions->volume);
    regions->front_area = take(f, 2, sizeof *regions->front_area);
    regions->back_area = take(f, 2, sizeof *regions->back_area);
    regions->kind[1] = ENF_KIND_ROCK;
    regions->kept[0] = true;
    regions->volume[0] = regions->volume[1] = half * whole * whole;
    f->build.cell_count = 2;
    f->build.cell_of = take(f, (size_t)c->cell_count, sizeof *f->build.cell_of);
    for (int32_t i = 0; i < c->cell_count; i++) {
        double middle[3] = {0, 0, 0};
        for (int k = 0; k < 4; k++) {
            for (int a = 0; a < 3; a++)
                middle[a] += c->points[3 * c->tetrahedra[fixture_tetrahedron_of(f, i)][k] + a] / 4;
        }
        regions->cell_region[i] = middle[0] > half;
        f->build.cell_of[i] = middle[0] > half ? -1 : middle[1] > half;
    }
    f->build.mesh.spawns = take(f, 9, sizeof(double));
    regions->spawn_count = 3;
    f->build.mesh.spawn_count = 3;
    regions->spawn_cell = take(f, 3, sizeof *regions->spawn_cell);
    regions->spawn_cell[0] = regions->spawn_cell[1] = 0;
    regions->spawn_cell[2] = -1;
    for (int a = 0; a < 3; a++) {
        f->build.mesh.spawns[a] = FIXTURE_SPACING * (0.9 - 0.3 * a); // inside the first tetrahedron
        f->build.mesh.spawns[6 + a] = -5;
    }
}

static void make_portal(fixture *f) {
    enf_complex *c = &f->build.complex;
    enf_portals *portals = &f->build.portals;
    size_t most = (size_t)c->facet_count;
    portals->opening_count = 1;
    portals->opening_cell = take(f, 1, sizeof *portals->opening_cell);
    portals->opening_cell[0][1] = 1;
    portals->opening_polygon = take(f, 2, sizeof *portals->opening_polygon);
    portals->opening_centre = take(f, 1, sizeof *portals->opening_centre);
    portals->opening_radius = take(f, 1, sizeof *portals->opening_radius);
    portals->opening_radius[0] = f->side * FIXTURE_SPACING;
    portals->opening_centre[0][1] = f->side / 2 * FIXTURE_SPACING;
    portals->polygon_plane = take(f, most, sizeof *portals->polygon_plane);
    portals->polygon_side = take(f, most, sizeof *portals->polygon_side);
    portals->polygon_area = take(f, most, sizeof *portals->polygon_area);
    new_loops(f, &portals->polygons, c->facet_count);
    for (int32_t facet = 0; facet < c->facet_count; facet++) {
        const int32_t *cell = c->facet_cell[facet];
        if (!facet_lies_at(f, facet, 1) || cell[0] < 0 || cell[1] < 0) continue;
        int32_t behind = f->build.cell_of[cell[0]], front = f->build.cell_of[cell[1]];
        if (behind < 0 || front < 0) continue;
        portals->polygon_side[portals->polygons.count] = front > behind;
        portals->polygon_plane[portals->polygons.count] = facet;
        portals->polygon_area[portals->polygons.count] = FIXTURE_SPACING * FIXTURE_SPACING / 2.0;
        add_loop(&portals->polygons, c->planes[facet], 0);
    }
    portals->opening_polygon[1] = portals->polygons.count;
}

/// The soup that would have led to the mesh, and a detail quadrangle in the air.
static void make_soup(fixture *f) {
    enf_soup *soup = &f->build.soup;
    enf_mesh *mesh = &f->build.mesh;
    size_t count = mesh->polygon_count + 1, corners = 3 * mesh->polygon_count + 4;
    soup->points = take(f, 3 * mesh->point_count, sizeof *soup->points);
    soup->point_count = mesh->point_count;
    for (size_t i = 0; i < mesh->point_count; i++)
        enf_frame_to_world(&mesh->frame, mesh->points + 3 * i, soup->points + 3 * i);
    soup->polygon_count = count;
    soup->polygon_corner = take(f, count + 1, sizeof *soup->polygon_corner);
    soup->polygon_group = take(f, count, sizeof *soup->polygon_group);
    soup->polygon_material = take(f, count, sizeof *soup->polygon_material);
    soup->corner_point = take(f, corners, sizeof *soup->corner_point);
    soup->corner_normal = take(f, corners, sizeof *soup->corner_normal);
    soup->corner_texcoord = take(f, corners, sizeof *soup->corner_texcoord);
    soup->corner_count = corners;
    const int32_t quad[4] = {point_at(f, 0, 0, 1), point_at(f, 1, 0, 1), point_at(f, 1, 1, 1),
                             point_at(f, 0, 1, 1)};
    for (size_t i = 0; i < corners; i++) {
        size_t polygon = i / 3 < count - 1 ? i / 3 : count - 1, k = i - 3 * polygon;
        bool mirrored = mesh->frame.handedness < 0;
        soup->corner_point[i] =
            polygon == count - 1 ? quad[k] : mesh->corners[3 * polygon + (mirrored ? 2 - k : k)];
        soup->corner_normal[i] = soup->corner_texcoord[i] = -1;
        soup->polygon_corner[polygon + 1] = (int64_t)i + 1;
    }
    soup->polygon_material[0] = -1;
    soup->groups = take(f, 1, sizeof *soup->groups);
    soup->groups[0] = take(f, 1, 1);
    soup->group_count = 1;
    soup->materials = take(f, 1, sizeof *soup->materials);
    soup->materials[0] = strcpy(take(f, 6, 1), "stone");
    soup->material_count = 1;
    mesh->details = take(f, 1, sizeof *mesh->details);
    mesh->details[0] = (int32_t)count - 1;
    mesh->detail_count = 1;
}

static void make(fixture *f, int side, const enf_frame *frame, bool has_screen) {
    memset(f, 0, sizeof *f);
    f->has_screen = has_screen;
    f->side = side;
    f->build.mesh.frame = frame ? *frame : (enf_frame){0.25, {0, 1, 2}, {1, 1, 1}, 1, false, {{0}}};
    make_points(f);
    make_tetrahedra(f);
    make_facets(f);
    make_wall(f);
    make_fine_cells(f);
    make_regions(f);
    make_portal(f);
    make_soup(f);
}

void fixture_make(fixture *f, int side, const enf_frame *frame) {
    make(f, side, frame, false);
}

void fixture_make_with_screen(fixture *f, int side, const enf_frame *frame) {
    make(f, side, frame, true);
}

void fixture_free(fixture *f) {
    for (int i = 0; i < f->memory_count; i++) free(f->memory[i]);
    memset(f, 0, sizeof *f);
}

unsigned char *fixture_read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END) != 0) abort();
    *size = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = malloc(*size + 1);
    if (!bytes || fread(bytes, 1, *size, file) != *size) abort();
    fclose(file);
    return bytes;
}

unsigned char *fixture_save(const fixture *f, size_t *size) {
    char path[] = "fixture-XXXXXX";
    int file = mkstemp(path);
    enf_error error = {0};
    if (file < 0 || enf_build_write(&f->build, "{\"stop\":\"auto\"}", path, &error)) {
        fprintf(stderr, "%s\n", error.text);
        abort();
    }
    close(file);
    unsigned char *bytes = fixture_read_file(path, size);
    remove(path);
    return bytes;
}

void fixture_fix_checksums(unsigned char *file) {
    enf_file_header *header = (void *)file;
    enf_file_section *sections = (void *)(file + header->table_offset);
    for (uint32_t i = 0; i < header->section_count; i++)
        sections[i].checksum = enf_hash64(file + sections[i].offset, sections[i].size, 0);
    header->table_checksum = enf_hash64(sections, header->section_count * sizeof *sections, 0);
    header->header_checksum = enf_hash64(header, offsetof(enf_file_header, header_checksum), 0);
}

int fixture_set_up(void **state) {
    fixture_saved *s = calloc(1, sizeof *s);
    if (!s) return -1;
    fixture_make(&s->fixture, 2, NULL);
    s->bytes = fixture_save(&s->fixture, &s->size);
    *state = s;
    return 0;
}

int fixture_tear_down(void **state) {
    fixture_saved *s = *state;
    fixture_free(&s->fixture);
    free(s->bytes);
    free(s);
    return 0;
}
