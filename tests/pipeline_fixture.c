// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline_fixture.h"

#include "base/array.h"
#include "base/hash.h"
#include "build/check.h"
#include "build/gen.h"
#include "build/write.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enf_build_options pipeline_options(void) {
    return (enf_build_options){.clean = {.weld = -1, .plane_tolerance = -1}, .threads = 1};
}

void pipeline_read_model(enf_soup *soup, const char *name) {
    char path[1024];
    enf_error error = {0};
    snprintf(path, sizeof path, "%s/%s.obj", ENFILADE_MODELS_DIR, name);
    memset(soup, 0, sizeof *soup);
    if (enf_soup_read(soup, path, &error) != ENF_OK) fail_msg("%s", error.text);
}

void pipeline_generate(enf_soup *soup, const char *name, const char *const *settings, size_t count) {
    char path[] = "/tmp/enfilade-XXXXXX.obj";
    enf_error error = {0};
    int descriptor = mkstemps(path, 4);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    assert_non_null(file);
    enf_status status = enf_gen_write(name, settings, count, file, &error);
    fclose(file);
    memset(soup, 0, sizeof *soup);
    if (status == ENF_OK) status = enf_soup_read(soup, path, &error);
    unlink(path);
    if (status != ENF_OK) fail_msg("%s", error.text);
}

const char *pipeline_shared(const char *name) {
    static char path[1024];
    const char *folder = getenv("ENFILADE_SHARED");
#ifdef ENFILADE_SHARED_DIR
    if (!folder) folder = ENFILADE_SHARED_DIR;
#endif
    if (folder) {
        snprintf(path, sizeof path, "%s/%s", folder, name);
        if (access(path, R_OK) == 0) return path;
    }
    print_message("%s is not here; set ENFILADE_SHARED to the folder that has it\n", name);
    return NULL;
}

void pipeline_visit_levels(void (*visit)(const char *path, const char *name)) {
    const char *shared = pipeline_shared("quake/obj");
    if (!shared) skip();
    char folder[1024], path[2048];
    snprintf(folder, sizeof folder, "%s", shared);
    struct dirent **entries;
    int count = scandir(folder, &entries, NULL, alphasort);
    assert_true(count >= 0);
    for (int i = 0; i < count; i++) {
        if (strstr(entries[i]->d_name, ".obj.gz")) {
            snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
            visit(path, entries[i]->d_name);
        }
        free(entries[i]);
    }
    free(entries);
}

static uint64_t next_random(uint64_t *seed) { // splitmix64
    uint64_t z = *seed += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return z ^ z >> 31;
}

static int32_t *shuffled(size_t count, uint64_t *seed) {
    int32_t *order = enf_array_new(count, sizeof *order);
    assert_non_null(order);
    for (size_t i = 0; i < count; i++) {
        size_t k = next_random(seed) % (i + 1);
        order[i] = order[k];
        order[k] = (int32_t)i;
    }
    return order;
}

void pipeline_shuffle(const enf_soup *from, enf_soup *to, uint64_t seed) {
    memset(to, 0, sizeof *to);
    int32_t *points = shuffled(from->point_count, &seed), *polygons = shuffled(from->polygon_count, &seed);
    int32_t *place = enf_array_new(from->point_count, sizeof *place);
    assert_non_null(place);
    assert_true(enf_array_reserve(to->points, to->point_capacity, 3 * from->point_count));
    assert_true(enf_array_reserve(to->spawns, to->spawn_capacity, 3 * from->spawn_count));
    for (size_t i = 0; i < from->point_count; i++) {
        place[points[i]] = (int32_t)i;
        memcpy(to->points + 3 * i, from->points + 3 * (size_t)points[i], 3 * sizeof(double));
    }
    to->point_count = from->point_count;
    if (from->spawn_count) memcpy(to->spawns, from->spawns, 3 * from->spawn_count * sizeof(double));
    to->spawn_count = from->spawn_count;
    for (size_t i = 0; i < from->polygon_count; i++) {
        int64_t begin = from->polygon_corner[polygons[i]],
                count = from->polygon_corner[polygons[i] + 1] - begin;
        int32_t *corners = enf_array_new((size_t)count, sizeof *corners);
        assert_non_null(corners);
        int64_t first = (int64_t)(next_random(&seed) % (uint64_t)count);
        for (int64_t k = 0; k < count; k++)
            corners[k] = place[from->corner_point[begin + (first + k) % count]];
        assert_true(enf_soup_add_polygon(to, (size_t)count, corners, NULL, NULL, -1, 0, 0, -1));
        free(corners);
    }
    free(points);
    free(polygons);
    free(place);
}

static void move_vectors(double *vectors, size_t count, const int axis[3], const int sign[3], double scale) {
    for (size_t i = 0; i < count; i++) {
        double old[3];
        memcpy(old, vectors + 3 * i, sizeof old);
        for (int k = 0; k < 3; k++) vectors[3 * i + (size_t)k] = sign[k] * scale * old[axis[k]];
    }
}

void pipeline_move(enf_soup *soup, const int axis[3], const int sign[3], double scale) {
    move_vectors(soup->points, soup->point_count, axis, sign, scale);
    move_vectors(soup->spawns, soup->spawn_count, axis, sign, scale);
    bool odd = (axis[1] == (axis[0] + 1) % 3) == (sign[0] * sign[1] * sign[2] < 0);
    if (!odd) return;
    for (size_t p = 0; p < soup->polygon_count; p++) {
        int64_t low = soup->polygon_corner[p], high = soup->polygon_corner[p + 1] - 1;
        for (; low < high; low++, high--) {
            int32_t swap = soup->corner_point[low];
            soup->corner_point[low] = soup->corner_point[high];
            soup->corner_point[high] = swap;
        }
    }
}

void pipeline_build(enf_build *build, const enf_build_options *options) {
    enf_error error = {0};
    if (enf_build_run(build, options, &error) != ENF_OK) fail_msg("%s", error.text);
}

void pipeline_check(const enf_build *build) {
    enf_build_image image;
    enf_check_report report;
    enf_error error = {0};
    if (enf_build_image_make(&image, build, NULL, &error) != ENF_OK) fail_msg("%s", error.text);
    enf_status status = enf_world_check(&image.view, &report, &error);
    enf_build_image_free(&image);
    if (status != ENF_OK) fail_msg("%s", error.text);
}

#define HASH(array, count) hash = enf_hash64((array), (size_t)(count) * sizeof *(array), hash)

uint64_t pipeline_fingerprint(const enf_build *build) {
    const enf_mesh *mesh = &build->mesh;
    const enf_complex *c = &build->complex;
    const enf_portals *portals = &build->portals;
    uint64_t hash = 0;
    HASH(mesh->points, 3 * mesh->point_count);
    HASH(mesh->corners, mesh->polygon_corner[mesh->polygon_count]);
    HASH(c->planes, c->plane_count);
    HASH(c->vertex_planes, c->vertex_count);
    HASH(c->vertex_position, c->vertex_count);
    HASH(c->tetrahedra, c->tetrahedron_count);
    HASH(c->tetrahedron_root, c->tetrahedron_count);
    HASH(c->node_child, c->node_count);
    HASH(c->cell_facet, c->cell_count + 1);
    HASH(c->cell_facets, c->cell_facet[c->cell_count]);
    HASH(c->facets.corners, c->facets.corner_count);
    HASH(c->facet_cell, c->facet_count);
    HASH(c->covers.corners, c->covers.corner_count);
    HASH(c->pieces.corners, c->pieces.corner_count);
    HASH(c->piece_facet, c->pieces.count);
    HASH(c->piece_cover, c->pieces.count);
    HASH(c->cover_polygon, c->covers.count);
    HASH(c->seen, c->seen_offset[c->cell_count]);
    HASH(build->regions.cell_region, c->cell_count);
    HASH(build->regions.kind, build->regions.region_count);
    HASH(build->cell_of, c->cell_count);
    HASH(portals->opening_cell, portals->opening_count);
    HASH(portals->polygons.corners, portals->polygons.corner_count);
    return hash;
}

static int compare_volumes(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double *pipeline_region_volumes(const enf_build *build, size_t *count) {
    const enf_regions *regions = &build->regions;
    double step = build->mesh.frame.step,
           *volumes = enf_array_new((size_t)regions->region_count, sizeof *volumes);
    assert_non_null(volumes);
    *count = 0;
    for (int32_t r = 0; r < regions->region_count; r++) {
        if (!regions->hairline[r]) volumes[(*count)++] = regions->volume[r] * step * step * step;
    }
    qsort(volumes, *count, sizeof *volumes, compare_volumes);
    return volumes;
}
