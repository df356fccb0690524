// SPDX-License-Identifier: MIT
#include "enfilade/path.h"

#include "base/array.h"
#include "run/path_finder.h"
#include "run/path_pull.h"
#include "run/vector.h"

#include <stdlib.h>
#include <string.h>

enum { SWEEPS = 200, LANDMARKS = 4, SOUND_STEPS = 4096, SOUND_STEPS_MOST = 1 << 28 };
#define TABLE_BYTES (UINT64_C(4) << 20)
#define TOLERANCE 1e-5

enf_status enf_paths_create(enf_paths **out, const enf_world *world, const enf_paths_options *options,
                            enf_error *error) {
    *out = NULL;
    enf_paths_options chosen = options ? *options : (enf_paths_options){0};
    enf_paths *paths = calloc(1, sizeof *paths);
    if (!paths) return enf_fail_memory(error, "paths");
    if (chosen.landmarks < 0 || chosen.landmarks > ENF_PATH_LANDMARKS_MAX) {
        free(paths);
        return enf_fail(error, ENF_BAD_USAGE, "%ld landmarks: 1 to %d are possible", (long)chosen.landmarks,
                        ENF_PATH_LANDMARKS_MAX);
    }
    paths->world = world;
    paths->view = enf_world_file(world);
    bool good = enf_path_graph_make(paths, !chosen.skip_contraction);
    uint64_t most = chosen.table_bytes_max ? chosen.table_bytes_max : TABLE_BYTES;
    int32_t landmarks = chosen.skip_landmarks ? 0 : chosen.landmarks ? chosen.landmarks : LANDMARKS;
    good = good && enf_path_landmarks_make(paths, landmarks);
    if (good && !chosen.skip_table && enf_path_table_size(paths) <= most) good = enf_path_table_make(paths);
    if (!good) {
        enf_paths_free(paths);
        return enf_fail_memory(error, "paths");
    }
    *out = paths;
    return ENF_OK;
}

void enf_paths_free(enf_paths *paths) {
    if (!paths) return;
    enf_path_graph_free(paths);
    free(paths);
}

void enf_paths_get_info(const enf_paths *paths, enf_paths_info *info) {
    *info = (enf_paths_info){.cells = paths->view->cell_count,
                             .junctions = paths->junction_count,
                             .portals = paths->view->portal_count / 2,
                             .gates = paths->gate_count,
                             .has_table = paths->table != NULL,
                             .table_bytes = enf_path_table_size(paths),
                             .precision = 2 / paths->unit};
}

enf_status enf_path_finder_create(enf_path_finder **out, const enf_paths *paths,
                                  const enf_path_finder_options *options, enf_error *error) {
    *out = NULL;
    int32_t steps = options && options->sound_steps_max ? options->sound_steps_max : SOUND_STEPS;
    if (steps < 0 || steps > SOUND_STEPS_MOST)
        return enf_fail(error, ENF_BAD_USAGE, "%ld steps for sounds: 1 to %ld are possible", (long)steps,
                        (long)SOUND_STEPS_MOST);
    enf_path_finder *finder = calloc(1, sizeof *finder);
    if (!finder) return enf_fail_memory(error, "finding paths");
    finder->paths = paths;
    finder->trace_max = steps;
    bool good = enf_path_search_make(&finder->search, paths);
    good = enf_path_heap_make(&finder->open, steps) && good;
    finder->traces = enf_array_new((size_t)steps, sizeof *finder->traces);
    int32_t portals = paths->view->portal_count < steps ? paths->view->portal_count : steps;
    finder->points = enf_array_new(2 * (size_t)portals + 2, sizeof *finder->points);
    finder->cell_stamp = enf_array_zeroed((size_t)paths->view->cell_count, sizeof *finder->cell_stamp);
    if (!good || !finder->traces || !finder->points || !finder->cell_stamp) {
        enf_path_finder_free(finder);
        return enf_fail_memory(error, "finding paths");
    }
    *out = finder;
    return ENF_OK;
}

void enf_path_finder_free(enf_path_finder *finder) {
    if (!finder) return;
    enf_path_search_free(&finder->search);
    enf_path_heap_free(&finder->open);
    free(finder->traces);
    free(finder->points);
    free(finder->cell_stamp);
    free(finder);
}

enf_status enf_path_find_cell(const enf_paths *paths, int32_t given, const double *point, int32_t *cell,
                              enf_error *error) {
    if (given < -1 || given >= paths->view->cell_count)
        return enf_fail(error, ENF_BAD_USAGE, "cell %ld: the world has cells 0 to %ld", (long)given,
                        (long)paths->view->cell_count - 1);
    if (point && !(isfinite(point[0]) && isfinite(point[1]) && isfinite(point[2])))
        return enf_fail(error, ENF_BAD_USAGE, "a point is not finite");
    if (given < 0 && !point) return enf_fail(error, ENF_BAD_USAGE, "neither a cell nor a point is given");
    *cell = given >= 0 ? given : enf_world_locate(paths->world, point, -1).cell;
    return ENF_OK;
}

enf_status enf_path_find_goal(const enf_paths *paths, int32_t given, const double *point, enf_path_goal *goal,
                              enf_error *error) {
    *goal = (enf_path_goal){.has_point = point != NULL};
    if (point) enf_path_to_units(paths, point, goal->point);
    return enf_path_find_cell(paths, given, point, &goal->cell, error);
}

// ---------------------------------------------------------------------------------------------- by the table

/// The next portal on a path of a length, from a place in a cell; -1: none fits. `came`: the portal passed
/// last, or -1. *rest: what is left behind the portal.
static int32_t next_by_table(const enf_paths *paths, int32_t cell, int32_t came, const double *place,
                             const enf_path_goal *goal, int64_t length, int64_t *rest) {
    int32_t count, best = -1;
    const int32_t *exits = enf_path_exits(paths, cell, &count);
    for (int32_t i = 0; i < count; i++) {
        if (came >= 0 && exits[i] == (came ^ 1)) continue;
        int64_t step = place ? enf_path_step(paths, place, enf_path_place(paths, exits[i])) : 0;
        if (step >= length) continue;
        int64_t behind = enf_path_table_rest(paths, exits[i], goal);
        if (behind == ENF_PATH_NEVER || step + behind != length || (best >= 0 && best < exits[i])) continue;
        best = exits[i];
        *rest = behind;
    }
    return best;
}

/// The shortest length between ends in different cells.
static int64_t length_by_table(const enf_paths *paths, const enf_path_goal *start, const enf_path_goal *goal,
                               int32_t *first) {
    int64_t best = ENF_PATH_NEVER;
    int32_t count;
    const int32_t *exits = enf_path_exits(paths, start->cell, &count);
    for (int32_t i = 0; i < count; i++) {
        int64_t rest = enf_path_table_rest(paths, exits[i], goal);
        if (rest == ENF_PATH_NEVER) continue;
        rest += enf_path_last_step(paths, exits[i], start);
        if (rest < best || (rest == best && exits[i] < *first)) *first = exits[i];
        if (rest < best) best = rest;
    }
    return best;
}

/// Follows the table; returns the number of portals; -1: the table led nowhere, or to a closed door.
static int32_t follow_table(const enf_path_finder *finder, const enf_instance *instance,
                            const enf_path_goal *start, const enf_path_goal *goal, int64_t length) {
    const enf_paths *paths = finder->paths;
    bool asks_doors = enf_instance_has_shut(instance);
    int32_t cell = start->cell, count = 0, portal = -1;
    const double *place = start->has_point ? start->point : NULL;
    while (cell != goal->cell) {
        if (count == paths->view->portal_count) return -1;
        if (portal >= 0 && !paths->is_junction[cell]) {
            int32_t next = enf_path_after(paths, portal);
            length -= enf_path_step(paths, place, enf_path_place(paths, next));
            portal = next;
        } else {
            portal = next_by_table(paths, cell, portal, place, goal, length, &length);
        }
        if (portal < 0) return -1;
        if (asks_doors && enf_instance_passage(instance, paths->view, portal).to < 0) return -1;
        finder->search.route[count++] = portal;
        place = enf_path_place(paths, portal);
        cell = paths->view->portals[portal].to;
    }
    return count;
}

// ---------------------------------------------------------------------------------------------- a query

static double to_world(const enf_paths *paths, int64_t length) {
    return (double)length / paths->unit;
}

/// Finds the portals of a path between different cells; they are in the search's route unless the number is
/// -1. False: there is no way.
static bool find_route(enf_path_finder *finder, const enf_instance *instance, const enf_path_goal *start,
                       const enf_path_goal *goal, bool wants_portals, enf_path *path) {
    const enf_paths *paths = finder->paths;
    const int32_t *transforms;
    int64_t length = ENF_PATH_NEVER;
    path->portal_count = -1;
    bool plain = enf_instance_transforms(instance, &transforms) == 0;
    if (plain && paths->component[start->cell] != paths->component[goal->cell]) return false;
    if (paths->table && plain) {
        length = length_by_table(paths, start, goal, &path->first);
        if (length == ENF_PATH_NEVER) return false;
        if (wants_portals || enf_instance_has_shut(instance))
            path->portal_count = follow_table(finder, instance, start, goal, length);
        else
            return path->length = to_world(paths, length), true;
    }
    if (path->portal_count < 0)
        path->portal_count = enf_path_search_run(&finder->search, instance, start, goal, &length);
    if (path->portal_count == 0) return false;
    path->first = finder->search.route[0];
    path->length = to_world(paths, length);
    return true;
}

static void write_line(const enf_path_finder *finder, const enf_instance *instance,
                       const enf_path_query *query, enf_path *path) {
    enf_path_line line = {finder->paths,
                          instance,
                          finder->search.route,
                          path->portal_count,
                          query->points,
                          query->tolerance > 0 ? query->tolerance : TOLERANCE,
                          query->sweeps_max > 0 ? query->sweeps_max : SWEEPS};
    path->point_count = enf_path_line_size(&line);
    if (path->point_count > query->point_capacity) return;
    path->sweeps = enf_path_line_pull(&line, query->from, query->to);
    path->line_length = enf_path_line_length(&line);
}

enf_status enf_path_find(enf_path_finder *finder, const enf_instance *instance, const enf_path_query *query,
                         enf_path *path, enf_error *error) {
    const enf_paths *paths = finder->paths;
    enf_path_goal start, goal;
    *path = (enf_path){.first = -1};
    enf_status status = enf_path_find_goal(paths, query->from_cell, query->from, &start, error);
    if (!status) status = enf_path_find_goal(paths, query->to_cell, query->to, &goal, error);
    if (status) return status;
    if (query->points && !(query->from && query->to))
        return enf_fail(error, ENF_BAD_USAGE, "a line needs a point at both ends");
    if (start.cell < 0 || goal.cell < 0) return ENF_OK;
    if (start.cell != goal.cell) {
        path->is_found = find_route(finder, instance, &start, &goal, query->portals || query->points, path);
        if (!path->is_found) *path = (enf_path){.first = -1};
        if (!path->is_found) return ENF_OK;
    } else {
        path->is_found = true;
        if (query->from && query->to) path->length = enf_distance(query->from, query->to);
    }
    for (int32_t i = 0; query->portals && i < path->portal_count && i < query->portal_capacity; i++)
        query->portals[i] = finder->search.route[i];
    if (query->points) write_line(finder, instance, query, path);
    return ENF_OK;
}
