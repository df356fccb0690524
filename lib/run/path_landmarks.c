// SPDX-License-Identifier: MIT
#include "run/path_landmarks.h"

#include "base/array.h"
#include "run/path_spread.h"

#include <stdlib.h>

/// Numbers the connected parts of the world by their lowest cell: pointers to lower cells of the same part,
/// shortened on the way (B. A. Galler and M. J. Fisher, Communications of the ACM 7, 1964).
static int32_t lowest(int32_t *component, int32_t cell) {
    while (component[cell] != cell) {
        component[cell] = component[component[cell]];
        cell = component[cell];
    }
    return cell;
}

static void find_components(enf_paths *paths) {
    const enf_file_view *view = paths->view;
    for (int32_t i = 0; i < view->cell_count; i++) paths->component[i] = i;
    for (int32_t i = 0; i < view->portal_count; i += 2) {
        int32_t a = lowest(paths->component, view->portals[i].from);
        int32_t b = lowest(paths->component, view->portals[i].to);
        paths->component[a > b ? a : b] = a > b ? b : a;
    }
    for (int32_t i = 0; i < view->cell_count; i++) paths->component[i] = lowest(paths->component, i);
}

static int32_t component_of(const enf_paths *paths, int32_t gate) {
    return paths->component[paths->view->portals[2 * paths->gate_pair[gate]].from];
}

/// A gate of the component with the most gates; -1: there are no gates.
static int32_t find_first(const enf_paths *paths) {
    int32_t *count = enf_array_zeroed((size_t)paths->view->cell_count, sizeof *count), best = -1, most = 0;
    for (int32_t i = 0; count && i < paths->gate_count; i++) {
        if (++count[component_of(paths, i)] <= most) continue;
        most = count[component_of(paths, i)];
        best = i;
    }
    free(count);
    return best;
}

/// The gate farthest from all landmarks so far.
static int32_t find_farthest(const enf_paths *paths, const int64_t *nearest) {
    int32_t best = -1;
    for (int32_t i = 0; i < paths->gate_count; i++)
        if (nearest[i] < ENF_PATH_NEVER && (best < 0 || nearest[i] > nearest[best])) best = i;
    return best;
}

/// The first landmark is the farthest gate from anywhere, and each other the farthest from those before.
static void choose(enf_paths *paths, enf_path_spread *spread, int64_t *nearest, int32_t first) {
    enf_path_spread_run(spread, first);
    for (int32_t i = 0; i < paths->gate_count; i++) nearest[i] = spread->cost[i];
    for (int32_t k = 0; k < paths->landmark_count; k++) {
        enf_path_spread_run(spread, find_farthest(paths, nearest));
        for (int32_t i = 0; i < paths->gate_count; i++) {
            int64_t cost = spread->cost[i];
            paths->landmarks[(size_t)i * (size_t)paths->landmark_count + (size_t)k] = cost;
            if (k == 0 || cost < nearest[i]) nearest[i] = cost;
        }
    }
}

bool enf_path_landmarks_make(enf_paths *paths, int32_t count) {
    size_t gates = (size_t)paths->gate_count;
    paths->component = enf_array_new((size_t)paths->view->cell_count, sizeof *paths->component);
    if (!paths->component) return false;
    find_components(paths);
    int32_t first = find_first(paths);
    if (first < 0 || count == 0) return true;
    paths->landmark_count = count;
    paths->landmarks = enf_array_new(gates * (size_t)count, sizeof *paths->landmarks);
    int64_t *nearest = enf_array_new(gates, sizeof *nearest);
    enf_path_spread spread;
    bool good = enf_path_spread_make(&spread, paths) && paths->landmarks && nearest;
    if (good) choose(paths, &spread, nearest, first);
    enf_path_spread_free(&spread);
    free(nearest);
    return good;
}

/// From a landmark to a portal's point, which may lie within a chain.
static int64_t length_to(const enf_paths *paths, int32_t landmark, int32_t portal) {
    int32_t gate = paths->gate[portal / 2], head = paths->head[portal], tail = paths->tail[portal];
    const int64_t *row = paths->landmarks + landmark;
    size_t count = (size_t)paths->landmark_count;
    if (gate >= 0) return row[(size_t)gate * count];
    if (paths->gate[head / 2] < 0 || paths->gate[tail / 2] < 0) return ENF_PATH_NEVER;
    int64_t one = row[(size_t)paths->gate[head / 2] * count],
            other = row[(size_t)paths->gate[tail / 2] * count];
    if (one < ENF_PATH_NEVER) one += paths->offset[portal];
    if (other < ENF_PATH_NEVER) other += paths->offset[tail] - paths->offset[portal];
    return one < other ? one : other;
}

void enf_path_landmarks_look(const enf_paths *paths, const enf_path_goal *goal, enf_path_ranges *ranges) {
    int32_t count;
    const int32_t *exits = enf_path_exits(paths, goal->cell, &count);
    ranges->count = count > 0 ? paths->landmark_count : 0;
    for (int32_t k = 0; k < ranges->count; k++) {
        ranges->low[k] = ENF_PATH_NEVER;
        ranges->high[k] = 0;
        for (int32_t i = 0; i < count; i++) {
            int64_t length = length_to(paths, k, exits[i]);
            if (length == ENF_PATH_NEVER) {
                ranges->count = 0;
                return;
            }
            length += enf_path_last_step(paths, exits[i], goal);
            if (length < ranges->low[k]) ranges->low[k] = length;
            if (length > ranges->high[k]) ranges->high[k] = length;
        }
        if (goal->has_point) ranges->high[k] = ranges->low[k];
    }
}
