// SPDX-License-Identifier: GPL-3.0-or-later
// Paths against Floyd's algorithm over all directed portals, whatever the doors and transforms: lengths, and
// portals that add up. With and without contraction and table the answers are the same. Lines against dynamic
// programming over ever finer samples of the portals.
#include "run_worlds.h"

#include "enfilade/path.h"
#include "run/instance.h"
#include "run/portal_shape.h"
#include "run/vector.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#ifdef ENFILADE_CLI
#include "build/gen.h"
#include "shared_data.h"
#include <unistd.h>
#endif

enum { KINDS = 4, FEW = 300 };

/// A world, and paths of four kinds: bit 0: without a table, bit 1: without contraction.
typedef struct bench {
    run_world opened;
    const enf_file_view *view;
    enf_instance *instance;
    enf_paths *paths[KINDS];
    enf_path_finder *finder[KINDS];
    int32_t *portals[KINDS];
    double (*middle)[3]; ///< per pair
    double *table;       ///< Floyd's, per pair of directed portals
    double size;
} bench;

static void make_bench(bench *b, run_world opened) {
    *b = (bench){.opened = opened, .view = enf_world_file(opened.world)};
    assert_int_equal(enf_instance_create(&b->instance, opened.world, NULL, NULL), ENF_OK);
    for (int k = 0; k < KINDS; k++) {
        enf_paths_options options = {.size = sizeof options, .table_bytes_max = (uint64_t)1 << 30};
        options.skip_table = k & 1;
        options.skip_contraction = k & 2;
        options.landmarks = k;
        options.skip_landmarks = k == 3;
        assert_int_equal(enf_paths_create(&b->paths[k], opened.world, &options, NULL), ENF_OK);
        assert_int_equal(enf_path_finder_create(&b->finder[k], b->paths[k], NULL, NULL), ENF_OK);
        b->portals[k] = calloc((size_t)b->view->portal_count + 1, sizeof(int32_t));
    }
    b->middle = calloc((size_t)b->view->portal_count / 2 + 1, sizeof *b->middle);
    for (int32_t i = 0; i < b->view->portal_count / 2; i++)
        enf_portal_middle(b->view, 2 * i, 1, b->middle[i]);
    b->size = enf_distance(opened.box_min, opened.box_max);
}

static void free_bench(bench *b) {
    for (int k = 0; k < KINDS; k++) {
        enf_path_finder_free(b->finder[k]);
        enf_paths_free(b->paths[k]);
        free(b->portals[k]);
    }
    enf_instance_free(b->instance);
    free(b->middle);
    free(b->table);
    run_world_free(&b->opened);
}

static void come_out(const bench *b, const enf_instance *instance, int32_t portal, double out[3]) {
    const double *m = enf_instance_passage(instance, b->view, portal).matrix, *at = b->middle[portal / 2];
    for (int a = 0; a < 3; a++) out[a] = m ? enf_dot(m + 4 * a, at) + m[4 * a + 3] : at[a];
}

/// Lengths from the entrance of one directed portal to that of another, by R. W. Floyd.
static void fill_table(bench *b, const enf_instance *instance) {
    size_t n = (size_t)b->view->portal_count;
    if (!b->table) b->table = malloc((n * n + 1) * sizeof *b->table);
    assert_non_null(b->table);
    for (size_t i = 0; i < n; i++) {
        enf_passage passage = enf_instance_passage(instance, b->view, (int32_t)i);
        double out[3];
        come_out(b, instance, (int32_t)i, out);
        for (size_t k = 0; k < n; k++) {
            bool leads = passage.to == b->view->portals[k].from;
            b->table[i * n + k] = i == k ? 0 : leads ? enf_distance(out, b->middle[k / 2]) : INFINITY;
        }
    }
    for (size_t m = 0; m < n; m++)
        for (size_t i = 0; i < n; i++)
            for (size_t k = 0; k < n && b->table[i * n + m] < INFINITY; k++)
                b->table[i * n + k] = fmin(b->table[i * n + k], b->table[i * n + m] + b->table[m * n + k]);
}

static double length_by_floyd(const bench *b, const enf_instance *instance, const enf_path_query *query) {
    const enf_file_cell *start = &b->view->cells[query->from_cell];
    double best = INFINITY, out[3];
    if (query->from_cell == query->to_cell)
        return query->from && query->to ? enf_distance(query->from, query->to) : 0;
    for (int32_t i = 0; i < start->portal_count; i++) {
        int32_t first = b->view->cell_portals[start->portal_first + i];
        for (int32_t last = 0; last < b->view->portal_count; last++) {
            if (enf_instance_passage(instance, b->view, last).to != query->to_cell) continue;
            double length = b->table[(size_t)first * (size_t)b->view->portal_count + (size_t)last];
            come_out(b, instance, last, out);
            if (query->from) length += enf_distance(query->from, b->middle[first / 2]);
            if (query->to) length += enf_distance(out, query->to);
            best = fmin(best, length);
        }
    }
    return best;
}

/// The portals lead from cell to cell, are open, and their steps add up.
static void check_portals(const bench *b, const enf_instance *instance, const enf_path_query *query,
                          const enf_path *path, double tolerance) {
    double length = 0, at[3];
    int32_t cell = query->from_cell;
    if (query->from) memcpy(at, query->from, sizeof at);
    for (int32_t i = 0; i < path->portal_count; i++) {
        int32_t portal = query->portals[i];
        assert_int_equal(b->view->portals[portal].from, cell);
        if (i > 0 || query->from) length += enf_distance(at, b->middle[portal / 2]);
        come_out(b, instance, portal, at);
        cell = enf_instance_passage(instance, b->view, portal).to;
    }
    if (query->to) length += enf_distance(at, query->to);
    assert_int_equal(cell, query->to_cell);
    assert_true(fabs(length - path->length) <= tolerance);
    assert_int_equal(path->first, path->portal_count > 0 ? query->portals[0] : -1);
}

static void check_query(bench *b, const enf_instance *instance, enf_path_query *query) {
    double expected = length_by_floyd(b, instance, query);
    enf_path path[KINDS], brief;
    for (int k = 0; k < KINDS; k++) {
        enf_paths_info info;
        enf_paths_get_info(b->paths[k], &info);
        double tolerance = info.precision * (b->view->portal_count + 4) + 1e-12 * b->size;
        query->portals = b->portals[k];
        query->portal_capacity = b->view->portal_count;
        assert_int_equal(enf_path_find(b->finder[k], instance, query, &path[k], NULL), ENF_OK);
        assert_int_equal(path[k].is_found, expected < INFINITY);
        if (!path[k].is_found) continue;
        if (!(fabs(path[k].length - expected) <= tolerance))
            fail_msg("kind %d, cells %d to %d: %.17g, not %.17g", k, query->from_cell, query->to_cell,
                     path[k].length, expected);
        if (query->from_cell != query->to_cell) check_portals(b, instance, query, &path[k], tolerance);
        assert_int_equal(path[k].portal_count, path[0].portal_count);
        assert_true(path[k].length == path[0].length);
        assert_memory_equal(b->portals[k], b->portals[0], (size_t)path[0].portal_count * sizeof(int32_t));
        query->portals = NULL;
        assert_int_equal(enf_path_find(b->finder[k], instance, query, &brief, NULL), ENF_OK);
        assert_true(brief.first == path[0].first && brief.length == path[0].length);
    }
}

static int32_t random_below(uint64_t *seed, int32_t count) {
    return (int32_t)(run_random(seed) % (uint64_t)count);
}

static void random_point(const bench *b, uint64_t *seed, double point[3]) {
    for (int a = 0; a < 3; a++)
        point[a] =
            b->opened.box_min[a] + run_random_share(seed) * (b->opened.box_max[a] - b->opened.box_min[a]);
}

static void check_queries(bench *b, const enf_instance *instance, int count, uint64_t *seed) {
    for (int n = 0; n < count; n++) {
        double from[3], to[3];
        random_point(b, seed, from);
        random_point(b, seed, to);
        enf_path_query query = {.size = sizeof query,
                                .from_cell = random_below(seed, b->view->cell_count),
                                .to_cell = random_below(seed, b->view->cell_count),
                                .from = n % 3 ? from : NULL,
                                .to = n % 2 ? to : NULL};
        check_query(b, instance, &query);
    }
}

static void set_doors(bench *b, int one_in, uint64_t *seed) {
    for (int32_t i = 0; i < b->view->portal_count; i += 2) {
        enf_door door = {.state = run_random(seed) % (uint64_t)one_in ? ENF_DOOR_OPEN : ENF_DOOR_CLOSED};
        assert_int_equal(enf_instance_set_door(b->instance, i, &door, NULL), ENF_OK);
    }
}

static void set_transform(bench *b, int32_t portal, uint64_t *seed) {
    double matrix[12] = {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0};
    for (int a = 0; a < 3; a++) matrix[4 * a + 3] = (run_random_share(seed) - 0.5) * b->size;
    assert_int_equal(enf_instance_set_transform(b->instance, portal, random_below(seed, b->view->cell_count),
                                                matrix, NULL),
                     ENF_OK);
}

static void check_all(bench *b, int count, uint64_t *seed) {
    int32_t transformed[3];
    if (b->view->portal_count == 0) return;
    fill_table(b, NULL);
    check_queries(b, NULL, count, seed);
    for (int one_in = 2; one_in < 20; one_in *= 3) {
        set_doors(b, one_in, seed);
        fill_table(b, b->instance);
        check_queries(b, b->instance, count, seed);
    }
    for (int i = 0; i < 3; i++) {
        transformed[i] = random_below(seed, b->view->portal_count);
        set_transform(b, transformed[i], seed);
    }
    set_doors(b, 9, seed);
    fill_table(b, b->instance);
    check_queries(b, b->instance, count, seed);
    for (int i = 0; i < 3; i++) enf_instance_set_transform(b->instance, transformed[i], 0, NULL, NULL);
    set_doors(b, 1000000000, seed);
    fill_table(b, b->instance);
    check_queries(b, b->instance, count / 2, seed);
}

static uint64_t begin(uint64_t seed) {
    print_message("seed %llu\n", (unsigned long long)seed);
    return seed;
}

static void grids_agree_with_floyd(void **state) {
    (void)state;
    uint64_t seed = begin(1);
    for (int n = 0; n < 11; n++) {
        bench b;
        make_bench(&b, run_world_grid(n < 4 ? 2 : n < 9 ? 4 : 6, n % 2, run_random(&seed)));
        check_all(&b, 60, &seed);
        free_bench(&b);
    }
}

// ---------------------------------------------------------------------------------------------- lines

enum { SAMPLES = 64, ROUNDS = 28 };

/// How much longer than by samples a line may be, as a share. Through portals that are not convex a pulled
/// line is only the best of its neighbours: 0.9 % was the worst seen.
#define CONVEX_SLACK 1e-4
#define LOCAL_SLACK 2e-2

/// Samples of a portal about a point: on rings up to a radius, moved onto the portal.
static int take_samples(const bench *b, int32_t portal, const double about[3], double radius,
                        double (*samples)[3]) {
    const double *normal = b->view->portal_polygons[b->view->portals[portal].polygon_first].plane;
    double side[2][3], helper[3] = {0, 0, 0};
    helper[fabs(normal[0]) < 0.6 ? 0 : 1] = 1;
    enf_cross(normal, helper, side[0]);
    enf_cross(normal, side[0], side[1]);
    int count = 0;
    memcpy(samples[count++], about, sizeof *samples);
    for (int ring = 1; ring <= 4; ring++) {
        for (int k = 0; k < 12; k++) {
            double angle = (k + 0.5 * ring) * acos(-1) / 6, at[3];
            for (int a = 0; a < 3; a++)
                at[a] = about[a] + radius * ring / 4 * (cos(angle) * side[0][a] + sin(angle) * side[1][a]);
            if (enf_portal_nearest(b->view, portal, at, samples[count])) count++;
        }
    }
    return count;
}

/// The length of the shortest line through samples, which become finer about it.
static double length_by_samples(const bench *b, const enf_path_query *query, const enf_path *path) {
    int32_t n = path->portal_count;
    double(*best)[3] = calloc((size_t)n, sizeof *best), length = INFINITY;
    double(*samples)[SAMPLES][3] = calloc((size_t)n, sizeof *samples);
    double(*cost)[SAMPLES] = calloc((size_t)n, sizeof *cost);
    int(*from)[SAMPLES] = calloc((size_t)n, sizeof *from), *count = calloc((size_t)n, sizeof *count);
    double scale = 1;
    for (int32_t i = 0; i < n; i++) memcpy(best[i], b->middle[query->portals[i] / 2], sizeof *best);
    for (int round = 0; round < ROUNDS; round++, scale *= 0.7) {
        for (int32_t i = 0; i < n; i++) {
            int32_t portal = query->portals[i];
            count[i] =
                take_samples(b, portal, best[i], 2 * scale * b->view->portals[portal].radius, samples[i]);
            for (int k = 0; k < count[i]; k++) {
                cost[i][k] = i > 0 ? INFINITY : enf_distance(query->from, samples[i][k]);
                for (int m = 0; i > 0 && m < count[i - 1]; m++) {
                    double way = cost[i - 1][m] + enf_distance(samples[i - 1][m], samples[i][k]);
                    if (way < cost[i][k]) cost[i][k] = way, from[i][k] = m;
                }
            }
        }
        int end = 0;
        length = INFINITY;
        for (int k = 0; k < count[n - 1]; k++) {
            double way = cost[n - 1][k] + enf_distance(samples[n - 1][k], query->to);
            if (way < length) length = way, end = k;
        }
        for (int32_t i = n - 1; i >= 0; end = from[i--][end]) memcpy(best[i], samples[i][end], sizeof *best);
    }
    free(best);
    free(samples);
    free(cost);
    free(from);
    free(count);
    return length;
}

/// How far a point is from a portal, by triangles of its polygons sampled in no way: distance to the plane
/// and over the edges.
static double away_from_portal(const bench *b, int32_t portal, const double point[3]) {
    const enf_file_portal *p = &b->view->portals[portal];
    double least = INFINITY;
    for (int32_t i = 0; i < p->polygon_count; i++) {
        const enf_file_portal_polygon *polygon = &b->view->portal_polygons[p->polygon_first + i];
        double away = fabs(enf_dot(polygon->plane, point) + polygon->plane[3]);
        for (int32_t k = 0; k < polygon->vertex_count; k++) {
            const double *v = b->view->portal_vertices[polygon->vertex_first + k];
            const double *next =
                b->view->portal_vertices[polygon->vertex_first + (k + 1) % polygon->vertex_count];
            double edge[3], arm[3], across[3];
            enf_subtract(next, v, edge);
            enf_subtract(point, v, arm);
            enf_cross(arm, edge, across);
            away = fmax(away, enf_dot(across, polygon->plane) / sqrt(enf_dot(edge, edge)));
        }
        least = fmin(least, away);
    }
    return least;
}

/// Next to the middle of a portal.
static int32_t point_in_cell(const bench *b, uint64_t *seed, double point[3]) {
    const enf_file_portal *portal = &b->view->portals[random_below(seed, b->view->portal_count)];
    const enf_file_portal_polygon *polygon = &b->view->portal_polygons[portal->polygon_first];
    for (int a = 0; a < 3; a++)
        point[a] = b->view->portal_vertices[polygon->vertex_first][a] / 2 +
                   b->view->portal_vertices[polygon->vertex_first + polygon->vertex_count / 2][a] / 2 +
                   run_random_share(seed) * portal->radius * polygon->plane[a];
    return portal->from;
}

static bool is_convex(const bench *b, const int32_t *portals, int32_t count) {
    for (int32_t i = 0; i < count; i++)
        if (b->view->portals[portals[i]].polygon_count != 1) return false;
    return true;
}

/// Each point is in its portal, the numbers add up, and the line is not much longer than one by samples. The
/// length is convex if the portals are; if they are not, relaxation may stop next to another corner than the
/// samples do.
static void check_line(const bench *b, const enf_path_query *query, const enf_path *path) {
    double(*points)[3] = query->points, sum = 0, tolerance = 1e-9 * b->size;
    assert_int_equal(path->point_count, path->portal_count + 2);
    for (int32_t i = 0; i <= path->portal_count; i++) sum += enf_distance(points[i], points[i + 1]);
    assert_memory_equal(points[0], query->from, sizeof *points);
    assert_memory_equal(points[path->portal_count + 1], query->to, sizeof *points);
    for (int32_t i = 0; i < path->portal_count; i++)
        assert_true(away_from_portal(b, query->portals[i], points[i + 1]) <= tolerance);
    assert_true(fabs(sum - path->line_length) <= tolerance);
    assert_true(path->line_length <= path->length + tolerance);
    double reference = length_by_samples(b, query, path);
    double slack = is_convex(b, query->portals, path->portal_count) ? CONVEX_SLACK : LOCAL_SLACK;
    if (!(path->line_length <= reference * (1 + slack)))
        fail_msg("%d portals: %.17g long, by samples %.17g", path->portal_count, path->line_length,
                 reference);
}

static void check_lines(bench *b, int count, uint64_t *seed) {
    double(*points)[3] = calloc((size_t)b->view->portal_count + 2, sizeof *points);
    int checked = 0;
    for (int n = 0; n < count && b->view->portal_count > 0; n++) {
        double from[3], to[3];
        enf_path path;
        enf_path_query query = {.size = sizeof query,
                                .from = from,
                                .to = to,
                                .portals = b->portals[0],
                                .portal_capacity = b->view->portal_count,
                                .points = points,
                                .point_capacity = b->view->portal_count + 2};
        query.from_cell = point_in_cell(b, seed, from);
        query.to_cell = point_in_cell(b, seed, to);
        assert_int_equal(enf_path_find(b->finder[n % KINDS], NULL, &query, &path, NULL), ENF_OK);
        if (!path.is_found || path.portal_count < 1) continue;
        check_line(b, &query, &path);
        checked++;
    }
    assert_true(checked > 0 || b->view->portal_count == 0);
    free(points);
}

static void grid_lines_are_short(void **state) {
    (void)state;
    uint64_t seed = begin(2);
    for (int n = 0; n < 16; n++) {
        bench b;
        make_bench(&b, run_world_grid(n < 4 ? 4 : 6, n % 2, run_random(&seed)));
        check_lines(&b, 40, &seed);
        free_bench(&b);
    }
}

/// Every point is in its portal, and comes out where the portal leads.
static int check_transformed(const bench *b, const enf_path_query *query, const enf_path *path) {
    double(*points)[3] = query->points, sum = 0, tolerance = 1e-9 * b->size;
    int32_t at = 0, seen = 0;
    for (int32_t i = 0; i <= path->portal_count; i++) {
        sum += enf_distance(points[at], points[at + 1]);
        at++;
        if (i == path->portal_count) break;
        const double *m = enf_instance_passage(b->instance, b->view, query->portals[i]).matrix;
        assert_true(away_from_portal(b, query->portals[i], points[at]) <= tolerance);
        for (int a = 0; m && a < 3; a++)
            assert_true(fabs(enf_dot(m + 4 * a, points[at]) + m[4 * a + 3] - points[at + 1][a]) <= tolerance);
        at += m != NULL;
        seen += m != NULL;
    }
    assert_int_equal(at + 1, path->point_count);
    assert_true(fabs(sum - path->line_length) <= tolerance);
    assert_true(path->line_length <= path->length * (1 + 1e-6));
    return seen;
}

/// Where all portals lead to where they did, but by a transform, lines are as short as without, but for
/// points that stick together at an edge.
static void lines_pass_transforms(void **state) {
    (void)state;
    static const double same[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    uint64_t seed = begin(5);
    int seen = 0;
    for (int n = 0; n < 80; n++) {
        bench b;
        make_bench(&b, run_world_grid(4, n % 2, run_random(&seed)));
        int32_t portals = b.view->portal_count;
        double(*points)[3] = calloc(2 * (size_t)portals + 2, sizeof *points), from[3], to[3];
        enf_path path, plain;
        enf_path_query query = {.size = sizeof query, .from = from, .to = to, .points = points};
        query.portals = b.portals[0];
        query.portal_capacity = portals;
        query.point_capacity = 2 * portals + 2;
        for (int32_t i = 0; i < portals && n % 4; i += 3) set_transform(&b, i, &seed);
        for (int32_t i = 0; i < portals && n % 4 == 0; i++)
            enf_instance_set_transform(b.instance, i, b.view->portals[i].to, same, NULL);
        query.from_cell = point_in_cell(&b, &seed, from);
        query.to_cell = point_in_cell(&b, &seed, to);
        assert_int_equal(enf_path_find(b.finder[0], NULL, &query, &plain, NULL), ENF_OK);
        assert_int_equal(enf_path_find(b.finder[0], b.instance, &query, &path, NULL), ENF_OK);
        if (path.is_found) seen += check_transformed(&b, &query, &path);
        if (n % 4 == 0 && plain.is_found)
            assert_true(fabs(path.line_length - plain.line_length) <= 5e-3 * plain.line_length);
        free(points);
        free_bench(&b);
    }
    assert_true(seen > 30);
}

// ---------------------------------------------------------------------------------------------- near cells

/// Cells within a distance by relaxing all portals until nothing changes (R. Bellman, L. R. Ford).
static void check_near(bench *b, const enf_instance *instance, double share, int32_t capacity,
                       uint64_t *seed) {
    int32_t portals = b->view->portal_count, cells = b->view->cell_count, count, expected = 1;
    double *cost = malloc((size_t)portals * sizeof *cost), *near = malloc((size_t)cells * sizeof *near);
    enf_near_cell *list = calloc((size_t)cells, sizeof *list);
    double from[3], out[3], distance = share * b->size;
    int32_t start = point_in_cell(b, seed, from);
    for (int32_t i = 0; i < cells; i++) near[i] = i == start ? 0 : INFINITY;
    for (int32_t i = 0; i < portals; i++)
        cost[i] = b->view->portals[i].from == start ? enf_distance(from, b->middle[i / 2]) : INFINITY;
    for (bool changed = true; changed;) {
        changed = false;
        for (int32_t i = 0; i < portals; i++) {
            int32_t to = enf_instance_passage(instance, b->view, i).to;
            come_out(b, instance, i, out);
            for (int32_t k = 0; k < portals; k++) {
                double length = cost[i] + enf_distance(out, b->middle[k / 2]);
                if (b->view->portals[k].from != to || length >= cost[k]) continue;
                cost[k] = length;
                changed = true;
            }
            if (to >= 0 && cost[i] <= distance) near[to] = fmin(near[to], cost[i]);
        }
    }
    for (int32_t i = 0; i < cells; i++) expected += i != start && near[i] < INFINITY;
    assert_int_equal(
        enf_path_near(b->finder[0], instance, start, from, distance, list, capacity, &count, NULL), ENF_OK);
    if (expected <= capacity)
        assert_int_equal(count, expected);
    else
        assert_true(count > capacity);
    assert_true(list[0].cell == start && list[0].portal == -1 && list[0].distance == 0);
    for (int32_t i = 0; i < count && i < capacity; i++) {
        assert_true(fabs(list[i].distance - near[list[i].cell]) <= 1e-6 * b->size);
        if (i > 0) assert_true(list[i - 1].distance <= list[i].distance);
        for (int32_t k = 0; k < i; k++) assert_true(list[k].cell != list[i].cell);
    }
    free(cost);
    free(near);
    free(list);
}

static void near_cells_agree_with_bellman(void **state) {
    (void)state;
    uint64_t seed = begin(3);
    for (int n = 0; n < 20; n++) {
        bench b;
        make_bench(&b, run_world_grid(4, n % 2, run_random(&seed)));
        check_near(&b, NULL, 0.5, b.view->cell_count, &seed);
        check_near(&b, NULL, 10, 5, &seed);
        set_doors(&b, 4, &seed);
        check_near(&b, b.instance, 2, b.view->cell_count, &seed);
        for (int k = 0; k < 3; k++) set_transform(&b, random_below(&seed, b.view->portal_count), &seed);
        check_near(&b, b.instance, 0.7, b.view->cell_count, &seed);
        free_bench(&b);
    }
}

// ---------------------------------------------------------------------------------------------- nonsense

static void nonsense_in_files_ends(void **state) {
    (void)state;
    uint64_t seed = begin(4);
    for (int n = 0; n < 60; n++) {
        run_world opened = run_world_grid(4, n % 2, run_random(&seed));
        run_world_scramble(&opened, &seed);
        bench b;
        make_bench(&b, opened);
        double(*points)[3] = calloc((size_t)b.view->portal_count + 2, sizeof *points), from[3], to[3];
        enf_near_cell list[8];
        for (int k = 0; k < 24; k++) {
            enf_path_query query = {.size = sizeof query, .from = from, .to = to, .points = points};
            enf_path path, other;
            int32_t count;
            for (int a = 0; a < 3; a++) from[a] = run_nasty(&seed), to[a] = run_nasty(&seed);
            query.from_cell = random_below(&seed, b.view->cell_count);
            query.to_cell = random_below(&seed, b.view->cell_count);
            query.portals = b.portals[0];
            query.portal_capacity = query.point_capacity = b.view->portal_count + 2;
            assert_int_equal(enf_path_find(b.finder[0], NULL, &query, &path, NULL), ENF_OK);
            for (int32_t i = 0; i < path.point_count; i++)
                for (int a = 0; a < 3; a++) assert_true(isfinite(points[i][a]));
            assert_int_equal(enf_path_find(b.finder[3], NULL, &query, &other, NULL), ENF_OK);
            assert_true(path.is_found == other.is_found && path.length == other.length);
            assert_int_equal(path.first, other.first);
            assert_int_equal(
                enf_path_near(b.finder[0], NULL, query.to_cell, from, fabs(to[0]), list, 8, &count, NULL),
                ENF_OK);
        }
        free(points);
        free_bench(&b);
    }
}

/// Portals that some cells do not list can be passed one way only: there are gates that some landmarks reach
/// and others do not. For sanitizers.
static void lists_without_meaning_end(void **state) {
    (void)state;
    uint64_t seed = begin(12);
    const enf_paths_options options = {.size = sizeof options, .skip_table = true};
    for (int n = 0; n < 200; n++) {
        run_world opened = run_world_grid(n % 2 ? 2 : 4, n % 3, run_random(&seed));
        run_world_scramble_lists(&opened, &seed);
        const int32_t cells = enf_world_file(opened.world)->cell_count;
        enf_paths *paths;
        enf_path_finder *finder;
        assert_int_equal(enf_paths_create(&paths, opened.world, &options, NULL), ENF_OK);
        assert_int_equal(enf_path_finder_create(&finder, paths, NULL, NULL), ENF_OK);
        for (int k = 0; k < 60; k++) {
            double from[3], to[3];
            enf_path_query query = {.size = sizeof query, .from = from, .to = to};
            enf_path path;
            for (int a = 0; a < 3; a++) {
                from[a] = 10 * run_random_share(&seed);
                to[a] = run_random_share(&seed);
            }
            query.from_cell = random_below(&seed, cells);
            query.to_cell = random_below(&seed, cells);
            assert_int_equal(enf_path_find(finder, NULL, &query, &path, NULL), ENF_OK);
            assert_true(path.length >= 0 && isfinite(path.length));
        }
        enf_path_finder_free(finder);
        enf_paths_free(paths);
        run_world_free(&opened);
    }
}

static void wrong_calls_are_refused(void **state) {
    (void)state;
    bench b;
    make_bench(&b, run_world_grid(4, false, 7));
    double point[3] = {0.1, 0.1, 0.1}, bad[3] = {0, NAN, 0}, points[2][3], far[3] = {1e9, 0, 0};
    enf_path_query query = {.size = sizeof query, .from_cell = b.view->cell_count};
    enf_path path;
    enf_near_cell list[2];
    int32_t count;
    assert_int_equal(enf_path_find(b.finder[0], NULL, &query, &path, NULL), ENF_BAD_USAGE);
    query.from_cell = -1;
    assert_int_equal(enf_path_find(b.finder[0], NULL, &query, &path, NULL), ENF_BAD_USAGE);
    query.from = bad;
    assert_int_equal(enf_path_find(b.finder[0], NULL, &query, &path, NULL), ENF_BAD_USAGE);
    query.from = point;
    query.points = points;
    assert_int_equal(enf_path_find(b.finder[0], NULL, &query, &path, NULL), ENF_BAD_USAGE);
    query.points = NULL;
    assert_int_equal(enf_path_find(b.finder[0], NULL, &query, &path, NULL), ENF_OK);
    query.from = far;
    assert_int_equal(enf_path_find(b.finder[0], NULL, &query, &path, NULL), ENF_OK);
    assert_true(!path.is_found && path.first == -1);
    assert_int_equal(enf_path_near(b.finder[0], NULL, 0, bad, 1, list, 2, &count, NULL), ENF_BAD_USAGE);
    assert_int_equal(enf_path_near(b.finder[0], NULL, 0, NULL, 1, list, 2, &count, NULL), ENF_BAD_USAGE);
    assert_int_equal(enf_path_near(b.finder[0], NULL, 0, point, NAN, list, 2, &count, NULL), ENF_BAD_USAGE);
    assert_int_equal(enf_path_near(b.finder[0], NULL, 0, point, 1, NULL, 0, &count, NULL), ENF_OK);
    assert_int_equal(count, 1);
    enf_path_finder *finder;
    enf_path_finder_options options = {sizeof options, -1};
    assert_int_equal(enf_path_finder_create(&finder, b.paths[0], &options, NULL), ENF_BAD_USAGE);
    assert_null(finder);
    enf_path_finder_free(NULL);
    enf_paths_free(NULL);
    free_bench(&b);
}

// ---------------------------------------------------------------------------------------------- worlds

#ifdef ENFILADE_CLI
static run_world generate(const char *name) {
    char path[] = "path-XXXXXX.obj";
    int file = mkstemps(path, 4);
    FILE *out = file < 0 ? NULL : fdopen(file, "w");
    assert_non_null(out);
    assert_int_equal(enf_gen_write(name, NULL, 0, out, NULL), ENF_OK);
    fclose(out);
    run_world world = run_world_compile(path);
    remove(path);
    return world;
}

static void compiled_worlds_agree_with_floyd(void **state) {
    (void)state;
    uint64_t seed = begin(6);
    static const char *const names[] = {"office", "cavern"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        bench b;
        make_bench(&b, generate(names[i]));
        enf_paths_info info;
        enf_paths_get_info(b.paths[0], &info);
        print_message("%s: %d cells, %d junctions, %d portals, %d gates\n", names[i], info.cells,
                      info.junctions, info.portals, info.gates);
        if (b.view->portal_count <= 2 * FEW) check_all(&b, 200, &seed);
        check_lines(&b, 12, &seed);
        free_bench(&b);
    }
}

static void a_level_agrees_with_all_kinds(void **state) {
    (void)state;
    char path[1024];
    uint64_t seed = begin(7);
    snprintf(path, sizeof path, "%s/quake/obj/dm1.obj.gz", shared_data());
    bench b;
    make_bench(&b, run_world_compile(path));
    for (int n = 0; n < 1000; n++) {
        enf_path brief[KINDS];
        double from[3], to[3];
        enf_path_query query = {.size = sizeof query, .from = from, .to = to};
        query.from_cell = point_in_cell(&b, &seed, from);
        query.to_cell = point_in_cell(&b, &seed, to);
        if (n == 500) set_doors(&b, 20, &seed);
        for (int k = 0; k < KINDS; k++) {
            assert_int_equal(enf_path_find(b.finder[k], b.instance, &query, &brief[k], NULL), ENF_OK);
            assert_true(brief[k].length == brief[0].length && brief[k].first == brief[0].first);
        }
    }
    set_doors(&b, 1000000000, &seed);
    check_lines(&b, 12, &seed);
    free_bench(&b);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grids_agree_with_floyd),
        cmocka_unit_test(grid_lines_are_short),
        cmocka_unit_test(lines_pass_transforms),
        cmocka_unit_test(near_cells_agree_with_bellman),
        cmocka_unit_test(nonsense_in_files_ends),
        cmocka_unit_test(lists_without_meaning_end),
        cmocka_unit_test(wrong_calls_are_refused),
#ifdef ENFILADE_CLI
        cmocka_unit_test(compiled_worlds_agree_with_floyd),
        cmocka_unit_test(a_level_agrees_with_all_kinds),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
