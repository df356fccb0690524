// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds that are a plan given a height: walls, floors and ceilings from rows of corners.
#include "build/gen_world.h"

enum { PLAN_CORNERS_MAX = 64 };

enf_gen_post enf_gen_plan_post(enf_gen_world *world, double x, double y, double low, double high) {
    return (enf_gen_post){enf_gen_point(world, x, y, low), enf_gen_point(world, x, y, high)};
}

void enf_gen_plan_walls(enf_gen_world *world, const enf_gen_post *posts, int count) {
    for (int i = 0; i + 1 < count; i++)
        enf_gen_quad(world, posts[i + 1].floor, posts[i].floor, posts[i].ceiling, posts[i + 1].ceiling);
}

void enf_gen_plan_floor(enf_gen_world *world, const enf_gen_post *posts, int count) {
    int32_t floor[PLAN_CORNERS_MAX], ceiling[PLAN_CORNERS_MAX];
    if (count > PLAN_CORNERS_MAX) {
        world->failed = true;
        return;
    }
    for (int i = 0; i < count; i++) {
        floor[i] = posts[i].floor;
        ceiling[count - 1 - i] = posts[i].ceiling;
    }
    enf_gen_polygon(world, 2, 1, floor, (size_t)count);
    enf_gen_polygon(world, 2, -1, ceiling, (size_t)count);
}
