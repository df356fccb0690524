// SPDX-License-Identifier: GPL-3.0-or-later
// Spheres and boxes through portals, against a flood that measures every portal in another way, in long
// double: nearest points of triangles for spheres, separating axes for boxes. What a slightly smaller shape
// must reach is in the answer, and what a slightly larger one does not is not.
#include "run_worlds.h"

#include "enfilade/query.h"
#include "run/instance.h"
#include "run/shape.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "shared_data.h"

enum { CLIP_MAX = 64, BRUTE_MAX = 400 };

typedef long double real;

static real dot(const real a[3], const real b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(const real a[3], const real b[3], real out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

static void cross(const real a[3], const real b[3], real out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static real to_segment(const real p[3], const real a[3], const real b[3]) {
    real ab[3], ap[3], off[3];
    subtract(b, a, ab);
    subtract(p, a, ap);
    real length = dot(ab, ab), share = length > 0 ? dot(ap, ab) / length : 0;
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    for (int i = 0; i < 3; i++) off[i] = ap[i] - share * ab[i];
    return sqrtl(dot(off, off));
}

/// By barycentric coordinates of the foot.
static real to_triangle(const real p[3], const real a[3], const real b[3], const real c[3]) {
    real ab[3], ac[3], ap[3], normal[3];
    subtract(b, a, ab);
    subtract(c, a, ac);
    subtract(p, a, ap);
    cross(ab, ac, normal);
    real least = fminl(to_segment(p, a, b), fminl(to_segment(p, b, c), to_segment(p, c, a)));
    real square = dot(normal, normal), part[3];
    if (square == 0) return least;
    cross(ap, ac, part);
    real u = dot(part, normal) / square;
    cross(ab, ap, part);
    real v = dot(part, normal) / square;
    return u >= 0 && v >= 0 && u + v <= 1 ? fabsl(dot(ap, normal)) / sqrtl(square) : least;
}

/// How far apart a box and a triangle are along the best of the separating axes; negative: they overlap.
static real box_gap(const enf_shape *box, const real corner[3][3]) {
    real edges[3][3], axes[13][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, gap = -INFINITY;
    for (int k = 0; k < 3; k++) subtract(corner[(k + 1) % 3], corner[k], edges[k]);
    cross(edges[0], edges[1], axes[3]);
    for (int k = 0; k < 9; k++) cross(axes[k % 3], edges[k / 3], axes[4 + k]);
    for (int k = 0; k < 13; k++) {
        real length = sqrtl(dot(axes[k], axes[k])), reach = 0, low = INFINITY, high = -INFINITY, centre = 0;
        if (length < 1e-9L) continue;
        for (int a = 0; a < 3; a++) {
            reach += fabsl(axes[k][a]) * box->half[a];
            centre += axes[k][a] * box->centre[a];
        }
        for (int i = 0; i < 3; i++) {
            low = fminl(low, dot(axes[k], corner[i]));
            high = fmaxl(high, dot(axes[k], corner[i]));
        }
        gap = fmaxl(gap, fmaxl(low - centre - reach, centre - reach - high) / length);
    }
    return gap;
}

/// Of a shape to a convex polygon; 0 or less: they meet.
static real gap_between(const enf_shape *shape, real (*corner)[3], int count) {
    real least = INFINITY, centre[3];
    for (int a = 0; a < 3; a++) centre[a] = shape->centre[a];
    for (int k = 1; k + 1 < count; k++) {
        real triangle[3][3];
        memcpy(triangle[0], corner[0], sizeof triangle[0]);
        memcpy(triangle[1], corner[k], sizeof triangle[0]);
        memcpy(triangle[2], corner[k + 1], sizeof triangle[0]);
        real gap = shape->kind == ENF_SHAPE_BOX
                       ? box_gap(shape, (const real(*)[3])triangle)
                       : to_triangle(centre, triangle[0], triangle[1], triangle[2]) - shape->radius;
        least = fminl(least, gap);
    }
    return least;
}

static int clip(real (*corner)[3], int count, const double plane[4]) {
    real kept[CLIP_MAX][3];
    int kept_count = 0;
    for (int i = 0; i < count; i++) {
        const real *from = corner[i], *to = corner[(i + 1) % count];
        real here = plane[3], there = plane[3];
        for (int a = 0; a < 3; a++) {
            here += plane[a] * from[a];
            there += plane[a] * to[a];
        }
        if (here >= 0) memcpy(kept[kept_count++], from, sizeof kept[0]);
        if ((here < 0) == (there < 0)) continue;
        for (int a = 0; a < 3; a++) kept[kept_count][a] = from[a] + here / (here - there) * (to[a] - from[a]);
        kept_count++;
    }
    memcpy(corner, kept, sizeof kept);
    return kept_count;
}

static real gap_to_portal(const enf_file_view *view, const enf_passage *passage, int32_t number,
                          const enf_shape *shape) {
    const enf_file_portal *portal = &view->portals[number];
    real least = INFINITY;
    for (int32_t i = 0; i < portal->polygon_count; i++) {
        const enf_file_portal_polygon *polygon = &view->portal_polygons[portal->polygon_first + i];
        real corner[CLIP_MAX][3];
        int count = polygon->vertex_count;
        assert_true(count < CLIP_MAX);
        for (int k = 0; k < count; k++)
            for (int a = 0; a < 3; a++) corner[k][a] = view->portal_vertices[polygon->vertex_first + k][a];
        if (passage->cut) count = clip(corner, count, passage->plane);
        least = fminl(least, gap_between(shape, corner, count));
    }
    return least;
}

/// The cells reached from `start` if gaps up to `most` count as none.
static void flood(const enf_file_view *view, const enf_instance *instance, int32_t start,
                  const enf_shape *shape, double most, bool *reached) {
    memset(reached, 0, (size_t)view->cell_count);
    reached[start] = true;
    for (bool grew = true; grew;) {
        grew = false;
        for (int32_t i = 0; i < view->portal_count; i++) {
            enf_passage passage = enf_instance_passage(instance, view, i);
            if (passage.to < 0 || !reached[view->portals[i].from] || reached[passage.to]) continue;
            if (gap_to_portal(view, &passage, i, shape) > most) continue;
            grew = reached[passage.to] = true;
        }
    }
}

static double size_of(const run_world *w) {
    return fmax(w->box_max[0] - w->box_min[0],
                fmax(w->box_max[1] - w->box_min[1], w->box_max[2] - w->box_min[2]));
}

static enf_shape random_shape(const run_world *w, uint64_t *seed) {
    enf_shape shape = {.kind = run_random(seed) % 2 ? ENF_SHAPE_BOX : ENF_SHAPE_SPHERE};
    double size = size_of(w) * pow(run_random_share(seed), 3) / 2;
    for (int a = 0; a < 3; a++)
        shape.centre[a] = w->box_min[a] + run_random_share(seed) * (w->box_max[a] - w->box_min[a]);
    if (shape.kind == ENF_SHAPE_SPHERE) shape.radius = size;
    for (int a = 0; a < 3 && shape.kind == ENF_SHAPE_BOX; a++) shape.half[a] = size * run_random_share(seed);
    return shape;
}

static void random_doors(const run_world *w, enf_instance *instance, uint64_t *seed) {
    const enf_file_view *view = enf_world_file(w->world);
    for (int32_t i = 0; i < view->portal_count; i += 2) {
        enf_door door = {.state = ENF_DOOR_OPEN};
        uint64_t choice = run_random(seed) % 6;
        if (choice == 0) door.state = ENF_DOOR_CLOSED;
        if (choice == 1) {
            door.state = ENF_DOOR_PARTLY;
            for (int a = 0; a < 3; a++) {
                door.plane[a] = run_random_share(seed) - 0.5;
                double off = view->portals[i].radius * (run_random_share(seed) - 0.5);
                door.plane[3] -= door.plane[a] * (view->portals[i].centre[a] + off);
            }
        }
        assert_int_equal(enf_instance_set_door(instance, i, &door, NULL), ENF_OK);
    }
}

typedef struct scratch {
    enf_query *query;
    enf_reached *cells;
    bool *least, *most;
    int64_t reached, skipped;
} scratch;

static scratch make_scratch(const run_world *w) {
    size_t count = (size_t)enf_world_file(w->world)->cell_count;
    scratch s = {
        .cells = calloc(count, sizeof *s.cells), .least = calloc(count, 1), .most = calloc(count, 1)};
    assert_true(s.cells && s.least && s.most);
    assert_int_equal(enf_query_create(&s.query, w->world, NULL, NULL), ENF_OK);
    return s;
}

static void free_scratch(scratch *s) {
    enf_query_free(s->query);
    free(s->cells);
    free(s->least);
    free(s->most);
}

/// One answer against the floods with a slightly smaller and a slightly larger shape.
static void check_cells(scratch *s, const run_world *w, const enf_instance *instance,
                        const enf_shape *shape) {
    const enf_file_view *view = enf_world_file(w->world);
    double margin = 1e-9 * size_of(w);
    int32_t start = enf_world_locate(w->world, shape->centre, -1).cell;
    enf_reach reach;
    assert_int_equal(enf_query_cells(s->query, instance, -1, shape, s->cells, view->cell_count, &reach, NULL),
                     ENF_OK);
    assert_true(reach.complete);
    assert_int_equal(reach.count == 0, start < 0);
    assert_int_equal(reach.images, start >= 0);
    if (start < 0) return;
    assert_int_equal(s->cells[0].cell, start);
    assert_int_equal(s->cells[0].portal, -1);
    flood(view, instance, start, shape, -margin, s->least);
    flood(view, instance, start, shape, margin, s->most);
    for (int32_t i = 0; i < reach.count; i++) {
        int32_t cell = s->cells[i].cell;
        assert_int_equal(s->cells[i].image, 0);
        if (i > 0) assert_int_equal(view->portals[s->cells[i].portal].to, cell);
        if (!s->most[cell]) fail_msg("cell %d is not reached, or twice", cell);
        s->most[cell] = false;
    }
    for (int32_t i = 0; i < view->cell_count; i++) {
        s->skipped += s->most[i];
        if (s->least[i] && s->most[i]) fail_msg("cell %d is missing", i);
    }
    s->reached += reach.count;
}

static void check_triangles(scratch *s, const run_world *w, const enf_shape *shape) {
    const enf_file_view *view = enf_world_file(w->world);
    double margin = 1e-9 * size_of(w);
    enf_reach reach;
    enf_touched *touched = calloc((size_t)view->triangle_count + 1, sizeof *touched);
    int *listed = calloc((size_t)view->triangle_count + 1, sizeof *listed);
    assert_true(touched && listed);
    enf_query_cells(s->query, NULL, -1, shape, s->cells, view->cell_count, &reach, NULL);
    int64_t count = enf_query_triangles(s->query, touched, view->triangle_count);
    assert_true(count <= view->triangle_count);
    assert_int_equal(enf_query_triangles(s->query, NULL, 0), count);
    for (int64_t i = 0; i < count; i++) assert_int_equal(++listed[touched[i].triangle], 1);
    for (int32_t i = 0; i < reach.count; i++) {
        const enf_file_cell *cell = &view->cells[s->cells[i].cell];
        for (int32_t k = 0; k < cell->triangle_count; k++) {
            int32_t triangle = view->cell_triangles[cell->triangle_first + k];
            real corner[3][3];
            for (int n = 0; n < 9; n++)
                corner[n / 3][n % 3] = view->render_points[view->triangles[triangle].point[n / 3]][n % 3];
            real gap = gap_between(shape, corner, 3);
            if (gap < -margin && !(listed[triangle] & 1)) fail_msg("triangle %d is missing", triangle);
            if (gap > margin && listed[triangle] & 1) fail_msg("triangle %d is %Lg away", triangle, gap);
            listed[triangle] |= 2;
        }
    }
    for (int32_t i = 0; i < view->triangle_count; i++)
        if (listed[i] == 1) fail_msg("triangle %d is of no cell", i);
    free(touched);
    free(listed);
}

static void check_world(const run_world *w, uint64_t *seed, int rounds) {
    scratch s = make_scratch(w);
    enf_instance *instance;
    assert_int_equal(enf_instance_create(&instance, w->world, NULL, NULL), ENF_OK);
    for (int i = 0; i < rounds; i++) {
        enf_shape shape = random_shape(w, seed);
        if (i % 16 == 0) random_doors(w, instance, seed);
        check_cells(&s, w, i % 2 ? instance : NULL, &shape);
        if (i % 4 == 0) check_triangles(&s, w, &shape);
    }
    enf_instance_free(instance);
    free_scratch(&s);
}

static void random_worlds(void **state) {
    (void)state;
    uint64_t seed = 20261126;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int i = 0; i < 6; i++) {
        run_world w = run_world_grid(4 + i % 2 * 2, i >= 3, run_random(&seed));
        check_world(&w, &seed, 250);
        run_world_free(&w);
    }
}

/// A sphere that touches a portal with its surface meets it, however the distance was rounded.
static void touching_is_meeting(void **state) {
    (void)state;
    uint64_t seed = 7;
    print_message("seed %llu\n", (unsigned long long)seed);
    int touched = 0;
    for (int i = 0; i < 4; i++) {
        run_world w = run_world_grid(4, i % 2, run_random(&seed));
        const enf_file_view *view = enf_world_file(w.world);
        scratch s = make_scratch(&w);
        for (int n = 0; n < 2000; n++) {
            enf_shape shape = random_shape(&w, &seed);
            shape.kind = ENF_SHAPE_SPHERE;
            shape.radius = 0;
            int32_t start = enf_world_locate(w.world, shape.centre, -1).cell;
            if (start < 0 || view->cells[start].portal_count == 0) continue;
            int32_t pick = (int32_t)(run_random(&seed) % (uint64_t)view->cells[start].portal_count);
            int32_t portal = view->cell_portals[view->cells[start].portal_first + pick];
            enf_passage open = {0};
            shape.radius = (double)gap_to_portal(view, &open, portal, &shape);
            enf_reach reach;
            enf_query_cells(s.query, NULL, start, &shape, s.cells, view->cell_count, &reach, NULL);
            bool found = false;
            for (int32_t k = 0; k < reach.count; k++)
                found = found || s.cells[k].cell == view->portals[portal].to;
            assert_true(found);
            touched++;
        }
        free_scratch(&s);
        run_world_free(&w);
    }
    assert_true(touched > 1000);
}

typedef struct entry {
    int32_t cell;
    real matrix[12];
} entry;

static enf_shape moved(const enf_shape *shape, const real m[12]) {
    enf_shape out = *shape;
    for (int a = 0; a < 3; a++)
        out.centre[a] = (double)(m[4 * a] * shape->centre[0] + m[4 * a + 1] * shape->centre[1] +
                                 m[4 * a + 2] * shape->centre[2] + m[4 * a + 3]);
    return out;
}

static real apart(const enf_shape *a, const enf_shape *b) {
    real off[3];
    for (int i = 0; i < 3; i++) off[i] = (real)a->centre[i] - b->centre[i];
    return sqrtl(dot(off, off));
}

/// All cells and images that a sphere reaches by transforms that keep lengths. -1: too many.
static int flood_images(const enf_file_view *view, const enf_instance *instance, int32_t start,
                        const enf_shape *shape, double most, entry *entries) {
    int count = 1;
    entries[0] = (entry){start, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    for (int i = 0; i < count; i++) {
        enf_shape image = moved(shape, entries[i].matrix);
        for (int32_t p = 0; p < view->portal_count; p++) {
            enf_passage passage = enf_instance_passage(instance, view, p);
            if (view->portals[p].from != entries[i].cell || passage.to < 0) continue;
            if (gap_to_portal(view, &passage, p, &image) > most) continue;
            entry next = entries[i];
            next.cell = passage.to;
            for (int k = 0; passage.matrix && k < 12; k++) {
                const double *row = passage.matrix + k / 4 * 4;
                const real *m = entries[i].matrix;
                next.matrix[k] = row[0] * m[k % 4] + row[1] * m[4 + k % 4] + row[2] * m[8 + k % 4] +
                                 (k % 4 == 3 ? row[3] : 0);
            }
            enf_shape there = moved(shape, next.matrix);
            bool known = false;
            for (int k = 0; k < count && !known; k++) {
                enf_shape other = moved(shape, entries[k].matrix);
                known = entries[k].cell == next.cell && apart(&other, &there) < 1e-9;
            }
            if (known) continue;
            if (count == BRUTE_MAX) return -1;
            entries[count++] = next;
        }
    }
    return count;
}

static bool is_in(const entry *entries, int count, const enf_shape *shape, int32_t cell,
                  const enf_shape *image) {
    for (int k = 0; k < count; k++) {
        enf_shape other = moved(shape, entries[k].matrix);
        if (entries[k].cell == cell && apart(&other, image) < 1e-7) return true;
    }
    return false;
}

/// Turns a quarter about z, perhaps mirrors, and moves.
static void random_motion(double matrix[12], const run_world *w, uint64_t *seed) {
    static const double quarter[4][4] = {{1, 0, 0, 1}, {0, -1, 1, 0}, {-1, 0, 0, -1}, {0, 1, -1, 0}};
    const double *q = quarter[run_random(seed) % 4];
    memset(matrix, 0, 12 * sizeof *matrix);
    matrix[0] = q[0], matrix[1] = q[1], matrix[4] = q[2], matrix[5] = q[3];
    matrix[10] = run_random(seed) % 2 ? 1 : -1;
    for (int a = 0; a < 3; a++) matrix[4 * a + 3] = (run_random_share(seed) - 0.5) * size_of(w) / 2;
}

static int check_images(const run_world *w, const enf_instance *instance, const enf_shape *shape) {
    const enf_file_view *view = enf_world_file(w->world);
    entry *least = calloc(BRUTE_MAX, sizeof *least), *most = calloc(BRUTE_MAX, sizeof *most);
    enf_reached *out = calloc(BRUTE_MAX, sizeof *out);
    assert_true(least && most && out);
    int32_t start = enf_world_locate(w->world, shape->centre, -1).cell;
    int least_count = start < 0 ? -1 : flood_images(view, instance, start, shape, -1e-8, least);
    int most_count = start < 0 ? -1 : flood_images(view, instance, start, shape, 1e-8, most);
    int images = 0;
    if (least_count > 0 && most_count > 0) {
        enf_query *query;
        enf_reach reach;
        enf_query_options options = {.size = sizeof options, .images_max = 1000, .cells_max = 1000};
        assert_int_equal(enf_query_create(&query, w->world, &options, NULL), ENF_OK);
        enf_query_cells(query, instance, start, shape, out, BRUTE_MAX, &reach, NULL);
        assert_true(reach.complete && reach.count <= most_count && reach.count >= least_count);
        for (int32_t i = 0; i < reach.count; i++) {
            enf_image image = enf_query_image(query, out[i].image);
            assert_true(fabs(image.shape.radius - shape->radius) < 1e-7);
            assert_true(is_in(most, most_count, shape, out[i].cell, &image.shape));
        }
        for (int k = 0; k < least_count; k++) {
            enf_shape there = moved(shape, least[k].matrix);
            bool found = false;
            for (int32_t i = 0; i < reach.count && !found; i++) {
                enf_image image = enf_query_image(query, out[i].image);
                found = out[i].cell == least[k].cell && apart(&image.shape, &there) < 1e-7;
            }
            assert_true(found);
        }
        images = reach.images;
        enf_query_free(query);
    }
    free(least);
    free(most);
    free(out);
    return images;
}

static void spheres_go_on_as_images(void **state) {
    (void)state;
    uint64_t seed = 99;
    print_message("seed %llu\n", (unsigned long long)seed);
    int images = 0;
    for (int i = 0; i < 6; i++) {
        run_world w = run_world_grid(4, i % 2, run_random(&seed));
        const enf_file_view *view = enf_world_file(w.world);
        enf_instance *instance;
        assert_int_equal(enf_instance_create(&instance, w.world, NULL, NULL), ENF_OK);
        for (int k = 0; k < 8; k++) {
            double matrix[12];
            random_motion(matrix, &w, &seed);
            int32_t portal = (int32_t)(run_random(&seed) % (uint64_t)view->portal_count);
            int32_t to = (int32_t)(run_random(&seed) % (uint64_t)view->cell_count);
            assert_int_equal(enf_instance_set_transform(instance, portal, to, matrix, NULL), ENF_OK);
        }
        for (int n = 0; n < 100; n++) {
            enf_shape shape = random_shape(&w, &seed);
            shape.kind = ENF_SHAPE_SPHERE;
            shape.radius = run_random_share(&seed) * size_of(&w) / 6;
            int found = check_images(&w, instance, &shape);
            images += found > 1 ? found : 0;
        }
        enf_instance_free(instance);
        run_world_free(&w);
    }
    print_message("%d images\n", images);
    assert_true(images > 100);
}

/// A portal that leads back to its own cell and enlarges.
static void endless_images_end_and_are_reported(void **state) {
    (void)state;
    run_world w = run_world_grid(4, false, 3);
    const enf_file_view *view = enf_world_file(w.world);
    enf_instance *instance;
    const double larger[12] = {1.5, 0, 0, 0.1, 0, 1.5, 0, 0, 0, 0, 1.5, 0};
    enf_shape shape = {.kind = ENF_SHAPE_SPHERE, .radius = 50};
    memcpy(shape.centre, view->portals[0].centre, sizeof shape.centre);
    assert_int_equal(enf_instance_create(&instance, w.world, NULL, NULL), ENF_OK);
    for (int32_t i = 0; i < view->portal_count; i++)
        enf_instance_set_transform(instance, i, view->portals[i].from, larger, NULL);
    for (int box = 0; box < 2; box++) {
        enf_query *query;
        enf_reach reach;
        enf_query_options options = {.size = sizeof options, .images_max = 7};
        assert_int_equal(enf_query_create(&query, w.world, &options, NULL), ENF_OK);
        for (int a = 0; a < 3; a++) shape.half[a] = 50;
        shape.kind = box ? ENF_SHAPE_BOX : ENF_SHAPE_SPHERE;
        enf_reached out[3];
        assert_int_equal(
            enf_query_cells(query, instance, view->portals[0].from, &shape, out, 3, &reach, NULL), ENF_OK);
        assert_true(!reach.complete && reach.images == 7 && reach.count == 7);
        assert_int_equal(enf_query_image(query, 7).shape.radius, 0);
        assert_true(enf_query_image(query, 1).matrix[0] == 1.5);
        assert_true(box || enf_query_image(query, 1).shape.radius >= 75);
        int64_t count = enf_query_triangles(query, NULL, 0);
        enf_touched *touched = calloc((size_t)count + 1, sizeof *touched);
        assert_int_equal(enf_query_triangles(query, touched, count), count);
        for (int64_t i = 1; i < count; i++) assert_true(touched[i].image >= touched[i - 1].image);
        free(touched);
        enf_query_free(query);
    }
    enf_instance_free(instance);
    run_world_free(&w);
}

static void nonsense_is_refused(void **state) {
    (void)state;
    run_world w = run_world_grid(4, false, 1);
    int32_t cells = enf_world_file(w.world)->cell_count;
    enf_query *query;
    enf_reach reach;
    enf_query_options options = {.size = sizeof options, .cells_max = -1};
    assert_int_equal(enf_query_create(&query, w.world, &options, NULL), ENF_BAD_USAGE);
    assert_null(query);
    assert_int_equal(enf_query_create(&query, w.world, NULL, NULL), ENF_OK);
    const enf_shape shapes[] = {{.radius = -1},
                                {.radius = NAN},
                                {.centre = {0, INFINITY, 0}},
                                {.kind = ENF_SHAPE_BOX, .half = {1, -1, 1}},
                                {.kind = (enf_shape_kind)5}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        assert_int_equal(enf_query_cells(query, NULL, 0, &shapes[i], NULL, 0, &reach, NULL), ENF_BAD_USAGE);
        assert_int_equal(reach.count, 0);
    }
    enf_shape point = {.radius = 0};
    assert_int_equal(enf_query_cells(query, NULL, cells, &point, NULL, 0, &reach, NULL), ENF_BAD_USAGE);
    assert_int_equal(enf_query_cells(query, NULL, -2, &point, NULL, 0, &reach, NULL), ENF_BAD_USAGE);
    assert_int_equal(enf_query_triangles(query, NULL, 0), 0);
    enf_query_free(query);
    run_world_free(&w);
}

/// Portals whose numbers are finite and make no sense.
static void hostile_portals_end(void **state) {
    (void)state;
    uint64_t seed = 4711;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 60; round++) {
        run_world w = run_world_grid(4, false, 5);
        run_world_scramble(&w, &seed);
        const enf_file_view *view = enf_world_file(w.world);
        scratch s = make_scratch(&w);
        enf_instance *instance;
        assert_int_equal(enf_instance_create(&instance, w.world, NULL, NULL), ENF_OK);
        random_doors(&w, instance, &seed);
        double matrix[12] = {1e200, 0, 0, 1e300, 0, 1, 0, 0, 0, 0, 1e-100, 0};
        assert_int_equal(enf_instance_set_transform(instance, 0, 0, matrix, NULL), ENF_OK);
        for (int i = 0; i < 100; i++) {
            enf_shape shape = random_shape(&w, &seed);
            if (i % 8 == 0) shape.radius = shape.half[0] = fabs(run_nasty(&seed));
            if (i % 9 == 0) shape.centre[1] = run_nasty(&seed);
            enf_reach reach;
            int32_t start = (int32_t)(run_random(&seed) % (uint64_t)view->cell_count);
            assert_int_equal(
                enf_query_cells(s.query, instance, start, &shape, s.cells, view->cell_count, &reach, NULL),
                ENF_OK);
            assert_true(reach.count >= 1 && reach.images >= 1);
            assert_true(enf_query_triangles(s.query, NULL, 0) <=
                        (int64_t)view->triangle_count * reach.images);
        }
        enf_instance_free(instance);
        free_scratch(&s);
        run_world_free(&w);
    }
}

#ifdef ENFILADE_CLI
/// Triangles are found by the tree of walls, where that is loaded, or by looking at all that the cells list:
/// the same ones in the same order.
static void check_ways(const run_world *w, uint64_t *seed, int rounds) {
    const enf_open_options lazily = {.size = sizeof lazily, .mode = ENF_OPEN_LAZY};
    const enf_file_view *view = enf_world_file(w->world);
    enf_world *worlds[2] = {w->world};
    enf_query *queries[2];
    enf_touched *touched[2];
    int64_t sum = 0;
    assert_int_equal(enf_world_open_memory(&worlds[1], w->bytes, w->size, &lazily, NULL), ENF_OK);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(enf_query_create(&queries[i], worlds[i], NULL, NULL), ENF_OK);
        touched[i] = calloc((size_t)view->triangle_count + 1, sizeof **touched);
        assert_non_null(touched[i]);
    }
    assert_non_null(enf_world_file(worlds[0])->wall_nodes);
    assert_null(enf_world_file(worlds[1])->wall_nodes);
    for (int n = 0; n < rounds; n++) {
        enf_shape shape = random_shape(w, seed);
        int32_t corner = view->triangles[run_random(seed) % (uint64_t)view->triangle_count].point[n % 3];
        for (int a = 0; a < 3; a++) {
            double away = shape.radius + shape.half[a];
            shape.centre[a] = view->render_points[corner][a] + away * (2 * run_random_share(seed) - 1);
        }
        int64_t count[2];
        for (int i = 0; i < 2; i++) {
            enf_reach reach;
            assert_int_equal(enf_query_cells(queries[i], NULL, -1, &shape, NULL, 0, &reach, NULL), ENF_OK);
            count[i] = enf_query_triangles(queries[i], touched[i], view->triangle_count);
        }
        assert_int_equal(count[0], count[1]);
        for (int64_t k = 0; k < count[0]; k++)
            assert_int_equal(touched[0][k].triangle, touched[1][k].triangle);
        sum += count[0];
    }
    assert_true(sum > rounds);
    for (int i = 0; i < 2; i++) {
        enf_query_free(queries[i]);
        free(touched[i]);
    }
    enf_world_close(worlds[1]);
}

static void compiled_worlds(void **state) {
    (void)state;
    uint64_t seed = 11;
    print_message("seed %llu\n", (unsigned long long)seed);
    static const char *const models[] = {"four-rooms-distorted", "office", "cavern"};
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        char path[512];
        snprintf(path, sizeof path, ENFILADE_MODELS_DIR "/%s.obj", models[i]);
        run_world w = run_world_compile(path);
        check_world(&w, &seed, 100);
        check_ways(&w, &seed, 2000);
        run_world_free(&w);
    }
}

static void a_level(void **state) {
    (void)state;
    uint64_t seed = 12;
    char path[512];
    snprintf(path, sizeof path, "%s/quake/obj/end.obj.gz", shared_data());
    run_world w = run_world_compile(path);
    check_world(&w, &seed, 60);
    check_ways(&w, &seed, 2000);
    run_world_free(&w);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_worlds),           cmocka_unit_test(touching_is_meeting),
        cmocka_unit_test(spheres_go_on_as_images), cmocka_unit_test(endless_images_end_and_are_reported),
        cmocka_unit_test(nonsense_is_refused),     cmocka_unit_test(hostile_portals_end),
#ifdef ENFILADE_CLI
        cmocka_unit_test(compiled_worlds),         cmocka_unit_test(a_level),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
