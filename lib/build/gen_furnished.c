// SPDX-License-Identifier: GPL-3.0-or-later
// The furnished room of the thesis (4.3.5): one wall finely tessellated and perturbed, a table and two
// chairs, made of closed boxes that stand on the floor; a doorway leads to a small second room.
#include "build/gen_world.h"

enum { ALONG = 12, UP = 6 }; // rectangles of the perturbed wall

static const double main_size[3] = {6.0, 5.0, 2.8};
static const double side_low[3] = {6.2, 1.2, 0.0}, side_high[3] = {8.8, 4.2, 2.4};
static const double door_low = 2.0, door_high = 2.9, door_top = 2.0; // y, y, z
static const double perturbation = 0.12;                             // along y, at most
static const uint64_t perturbation_seed = 1;

typedef int32_t wall_points[UP + 1][ALONG + 1];

static void make_wall_points(enf_gen_world *world, wall_points points) {
    uint64_t state = perturbation_seed;
    for (int k = 0; k <= UP; k++)
        for (int i = 0; i <= ALONG; i++) {
            bool rim = i == 0 || i == ALONG || k == 0 || k == UP;
            double shift = rim ? 0.0 : perturbation * enf_gen_random_unit(&state);
            points[k][i] =
                enf_gen_point(world, enf_gen_round(main_size[0] * i / ALONG),
                              enf_gen_round(main_size[1] + shift), enf_gen_round(main_size[2] * k / UP));
        }
}

static void add_doorway(enf_gen_world *world, int32_t rings[2][4]) {
    for (int end = 0; end < 2; end++)
        for (int i = 0; i < 4; i++)
            rings[end][i] = enf_gen_point(world, end ? side_low[0] : main_size[0],
                                          i == 1 || i == 2 ? door_high : door_low, i >= 2 ? door_top : 0.0);
    enf_gen_group(world, "doorway");
    enf_gen_tube(world, rings[0], rings[1], 4);
}

static void add_main_room(enf_gen_world *world, wall_points wall, const int32_t door[4]) {
    const double *size = main_size;
    int32_t a = enf_gen_point(world, 0, 0, 0), b = enf_gen_point(world, size[0], 0, 0);
    int32_t up_a = enf_gen_point(world, 0, 0, size[2]), up_b = enf_gen_point(world, size[0], 0, size[2]);
    int32_t ring[ALONG + UP + 12];
    size_t count;
    enf_gen_group(world, "room-1");
    enf_gen_quad(world, b, a, up_a, up_b);

    count = 0; // floor
    ring[count++] = a, ring[count++] = b, ring[count++] = door[0], ring[count++] = door[1];
    for (int i = ALONG; i >= 0; i--) ring[count++] = wall[0][i];
    enf_gen_polygon(world, 2, 1, ring, count);

    count = 0; // ceiling
    ring[count++] = up_b, ring[count++] = up_a;
    for (int i = 0; i <= ALONG; i++) ring[count++] = wall[UP][i];
    enf_gen_polygon(world, 2, -1, ring, count);

    count = 0; // west
    ring[count++] = up_a, ring[count++] = a;
    for (int k = 0; k <= UP; k++) ring[count++] = wall[k][0];
    enf_gen_polygon(world, 0, 1, ring, count);

    count = 0; // east, around the doorway
    ring[count++] = door[1], ring[count++] = door[2], ring[count++] = door[3], ring[count++] = door[0];
    ring[count++] = b, ring[count++] = up_b;
    for (int k = UP; k >= 0; k--) ring[count++] = wall[k][ALONG];
    enf_gen_polygon(world, 0, -1, ring, count);

    enf_gen_group(world, "perturbed-wall");
    for (int k = 0; k < UP; k++)
        for (int i = 0; i < ALONG; i++)
            enf_gen_quad(world, wall[k][i], wall[k][i + 1], wall[k + 1][i + 1], wall[k + 1][i]);
}

static void add_side_room(enf_gen_world *world, const int32_t door[4]) {
    int32_t p[8];
    for (int i = 0; i < 8; i++)
        p[i] = enf_gen_point(world, i & 1 ? side_high[0] : side_low[0], i & 2 ? side_high[1] : side_low[1],
                             i & 4 ? side_high[2] : side_low[2]);
    const int32_t floor[6] = {p[0], p[1], p[3], p[2], door[1], door[0]};
    const int32_t west[8] = {p[0], door[0], door[3], door[2], door[1], p[2], p[6], p[4]};
    enf_gen_group(world, "room-2");
    enf_gen_polygon(world, 2, 1, floor, 6);
    enf_gen_polygon(world, 0, 1, west, 8);
    enf_gen_quad(world, p[4], p[6], p[7], p[5]); // ceiling
    enf_gen_quad(world, p[1], p[0], p[4], p[5]); // south
    enf_gen_quad(world, p[2], p[3], p[7], p[6]); // north
    enf_gen_quad(world, p[3], p[1], p[5], p[7]); // east
}

static void box(enf_gen_world *world, double x, double y, double z, double size_x, double size_y,
                double size_z) {
    const double low[3] = {enf_gen_round(x), enf_gen_round(y), enf_gen_round(z)};
    const double high[3] = {enf_gen_round(x + size_x), enf_gen_round(y + size_y), enf_gen_round(z + size_z)};
    enf_gen_box(world, low, high);
}

// A board on four legs, which stand `inset` inside its edges.
static void board_on_legs(enf_gen_world *world, double x, double y, double size_x, double size_y,
                          double under, double leg, double inset) {
    box(world, x, y, under, size_x, size_y, 0.04);
    for (int i = 0; i < 4; i++)
        box(world, i & 1 ? x + size_x - inset - leg : x + inset, i & 2 ? y + size_y - inset - leg : y + inset,
            0, leg, leg, under);
}

static void add_chair(enf_gen_world *world, int number, double x, double y, bool back_north) {
    enf_gen_group(world, "chair-%d", number);
    board_on_legs(world, x, y, 0.44, 0.44, 0.42, 0.04, 0.02);
    box(world, x, back_north ? y + 0.40 : y, 0.46, 0.44, 0.04, 0.46);
}

void enf_gen_furnished(enf_gen_world *world, const enf_gen_options *options) {
    (void)options;
    wall_points wall;
    int32_t door[2][4];
    make_wall_points(world, wall);
    add_doorway(world, door);
    add_main_room(world, wall, door[0]);
    add_side_room(world, door[1]);
    enf_gen_group(world, "table");
    board_on_legs(world, 2.2, 1.9, 1.6, 0.9, 0.72, 0.07, 0.05);
    add_chair(world, 1, 2.7, 1.35, false);
    add_chair(world, 2, 2.9, 2.93, true);
    enf_gen_spawn(world, 5.1, 0.9, 1.6);
    enf_gen_spawn(world, 7.6, 2.6, 1.3);
}
