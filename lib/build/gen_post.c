// SPDX-License-Identifier: GPL-3.0-or-later
// A square post with four rooms around it. Fins of the outer wall reach for the post's corners and leave a
// doorway at each: past the post, every room sees only slivers of its neighbours.
#include "build/gen_world.h"

static const double height = 3.0;
static const double half_post = 1.0;
static const double fin[4][2] = {
    {4.5, 4.1}, {2.0, 1.7}, {1.7, 2.0}, {4.1, 4.5}}; // counter-clockwise, north-east

// A corner of the plan, turned by quarters of a circle.
static enf_gen_post corner(enf_gen_world *world, double x, double y, int quarters) {
    static const int cosines[4] = {1, 0, -1, 0}, sines[4] = {0, 1, 0, -1};
    int c = cosines[quarters & 3], s = sines[quarters & 3];
    return enf_gen_plan_post(world, c * x - s * y, s * x + c * y, 0, height);
}

static enf_gen_post fin_corner(enf_gen_world *world, int number, int quarters) {
    return corner(world, fin[number][0], fin[number][1], quarters);
}

void enf_gen_post_world(enf_gen_world *world, const enf_gen_options *options) {
    (void)options;
    for (int q = 0; q < 4; q++) {
        enf_gen_group(world, "room-%d", q + 1);
        const enf_gen_post room[6] = {
            corner(world, half_post, half_post, q + 3),
            fin_corner(world, 2, q + 3),
            fin_corner(world, 3, q + 3),
            fin_corner(world, 0, q),
            fin_corner(world, 1, q),
            corner(world, half_post, half_post, q),
        };
        enf_gen_plan_floor(world, room, 6);
        enf_gen_plan_walls(world, room + 1, 4);
        const double middle = (half_post + fin[0][0]) / 2;
        static const int away[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
        enf_gen_spawn(world, middle * away[q][0], middle * away[q][1], height / 2);
    }
    for (int q = 0; q < 4; q++) {
        enf_gen_group(world, "doorway-%d", q + 1);
        const enf_gen_post door[3] = {corner(world, half_post, half_post, q), fin_corner(world, 1, q),
                                      fin_corner(world, 2, q)};
        enf_gen_plan_floor(world, door, 3);
        enf_gen_plan_walls(world, door + 1, 2);
    }
    enf_gen_group(world, "post");
    for (int q = 0; q < 4; q++) {
        const enf_gen_post side[2] = {corner(world, half_post, half_post, q),
                                      corner(world, half_post, half_post, q + 3)};
        enf_gen_plan_walls(world, side, 2);
    }
}
