// SPDX-License-Identifier: GPL-3.0-or-later
// What a ray hits first among the triangles of a world: a caster that knows nothing of cells and portals, to
// judge what does.
#ifndef ENF_CLI_FIRST_HIT_H
#define ENF_CLI_FIRST_HIT_H

#include "enfilade/run.h"

typedef struct first_hit_node {
    double min[3], max[3];
    int32_t first, count; ///< of triangles; count 0: an inner node, `first` is the second child
} first_hit_node;

typedef struct first_hit_scene {
    const enf_file_view *view;
    int32_t node_count;
    first_hit_node *nodes;
    int32_t *triangles;
    double seam; ///< how much larger triangles are taken to be, in lengths of their edges
} first_hit_scene;

typedef struct first_hit {
    double t;         ///< in lengths of the direction
    int32_t triangle; ///< -1: none
    bool front;
} first_hit;

enf_status first_hit_create(first_hit_scene *scene, const enf_file_view *view, enf_error *error);
void first_hit_free(first_hit_scene *scene);

/// The nearest hit beyond `least`.
first_hit first_hit_cast(const first_hit_scene *scene, const double origin[3], const double direction[3],
                         double least);

/// All triangles hit between two distances, up to `capacity`; returns how many were written.
int first_hit_collect(const first_hit_scene *scene, const double origin[3], const double direction[3],
                      double least, double most, int32_t *triangles, int capacity);

#endif
