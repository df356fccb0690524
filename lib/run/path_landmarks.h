// SPDX-License-Identifier: MIT
// Landmarks: gates that are far from each other, with the lengths from each to all gates. The difference of
// two places' lengths from a landmark is a bound for the way between them that knows about walls, which the
// straight length does not: A. V. Goldberg and C. Harrelson, "Computing the shortest path: A* search meets
// graph theory", SODA 2005.
#ifndef ENF_RUN_PATH_LANDMARKS_H
#define ENF_RUN_PATH_LANDMARKS_H

#include "run/path_graph.h"

enum { ENF_PATH_LANDMARKS_MAX = 16 };

/// Fills paths->component, and chooses landmarks in the largest component. False without memory.
bool enf_path_landmarks_make(enf_paths *paths, int32_t count);

/// The end of a path.
typedef struct enf_path_goal {
    int32_t cell;
    bool has_point;
    double point[3]; ///< units
} enf_path_goal;

/// From the point of a portal that leads into the goal's cell to its end.
static inline int64_t enf_path_last_step(const enf_paths *paths, int32_t portal, const enf_path_goal *goal) {
    return goal->has_point ? enf_path_step(paths, enf_path_place(paths, portal), goal->point) : 0;
}

/// Lengths from each landmark to a goal; without a point, to the nearest and the farthest portal of its cell.
typedef struct enf_path_ranges {
    int32_t count;
    int64_t low[ENF_PATH_LANDMARKS_MAX], high[ENF_PATH_LANDMARKS_MAX];
} enf_path_ranges;

/// None if the goal is out of the landmarks' reach.
void enf_path_landmarks_look(const enf_paths *paths, const enf_path_goal *goal, enf_path_ranges *ranges);

/// No way from a gate to the goal is shorter.
static inline int64_t enf_path_landmarks_bound(const enf_paths *paths, int32_t gate,
                                               const enf_path_ranges *ranges) {
    const int64_t *row = paths->landmarks + (size_t)gate * (size_t)paths->landmark_count;
    int64_t bound = 0;
    for (int32_t k = 0; k < ranges->count; k++) {
        if (row[k] == ENF_PATH_NEVER) continue; // in a file without meaning, of some landmarks only
        int64_t one = row[k] - ranges->high[k], other = ranges->low[k] - row[k];
        if (one > bound) bound = one;
        if (other > bound) bound = other;
    }
    return bound;
}

#endif
