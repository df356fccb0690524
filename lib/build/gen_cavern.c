// SPDX-License-Identifier: GPL-3.0-or-later
// The cavern of the thesis (4.3.4): six irregular rooms on a bent 2 x 3 grid, and seven passages between
// neighbours that flare into them. Like the thesis' model it is a plan given a height, so that the Delaunay
// cells are three to each triangle of the plan; then all of it is tilted, so that no face is axis-aligned.
// The plan stands on a grid and the tilt is a rotation by whole numbers (from the quaternion 10 + i - j + k):
// no rounding takes part, floor and ceiling stay exactly flat.
#include <math.h>

#include "build/gen_world.h"

enum {
    ROOM_COUNT = 6,
    PASSAGE_COUNT = 7,
    MOUTHS_MAX = 3,  // of a room
    ARC_MAX = 24,    // points of a room's wall from one mouth to the next
    SIDE_POINTS = 5, // of a passage's side, between its ends
    HEIGHT = 160,    // in grid steps, like everything in the plan
};

static const double steps_per_unit = 40.0; // of the plan
static const double unit_of_tilt =
    4096.0; // the tilt stretches by 103, so a plan unit becomes 1.006 world units
static const double tilt[3][3] = {{99, -22, -18}, {18, 99, -22}, {22, 18, 99}};
static const double mouth_half = 21.0;        // degrees of a room's rim
static const double degrees_per_point = 13.5; // of the rim
static const double dent = 0.05;              // of the radius
static const double narrowing[SIDE_POINTS] = {0.55, 0.36, 0.14, 0.36, 0.55};
static const uint64_t dent_seed = 922;

typedef struct room {
    double x, y, radius;
    double stretch, axis; ///< the rim is stretched by this share along a direction (degrees)
    int mouth_count;
    struct {
        int passage;
        double degrees;
    } mouths[MOUTHS_MAX]; ///< counter-clockwise
} room;

static const room rooms[ROOM_COUNT] = {
    {0.0, 0.0, 5.6, 0.10, 40, 2, {{0, 7}, {4, 95}}},
    {16.0, 2.0, 5.3, 0.08, 100, 3, {{5, 94}, {0, 187}, {1, 349}}},
    {32.0, -1.0, 5.7, 0.12, 140, 2, {{6, 94}, {1, 169}}},
    {-1.5, 16.0, 5.4, 0.09, 120, 2, {{2, 5}, {4, 275}}},
    {15.0, 17.5, 5.6, 0.07, 20, 3, {{2, 185}, {5, 274}, {3, 351}}},
    {31.0, 15.0, 5.2, 0.11, 60, 2, {{3, 171}, {6, 274}}},
};

/// Both ends of a passage: the corners of the mouth, clockwise one first.
typedef struct passage {
    enf_gen_post ends[2][2];
    int end_count;
} passage;

static enf_gen_post add_post(enf_gen_world *world, double x, double y) {
    return enf_gen_plan_post(world, floor(x * steps_per_unit + 0.5), floor(y * steps_per_unit + 0.5), 0,
                             HEIGHT);
}

// A point of the rim, dented at random.
static enf_gen_post rim_post(enf_gen_world *world, const room *room, double degrees, uint64_t *state) {
    double sine, cosine, ignored, bulge;
    enf_gen_sine_cosine(degrees, &sine, &cosine);
    enf_gen_sine_cosine(2 * (degrees - room->axis), &ignored, &bulge);
    double radius = room->radius * (1 + room->stretch * bulge + dent * enf_gen_random_unit(state));
    return add_post(world, room->x + radius * cosine, room->y + radius * sine);
}

static void add_room(enf_gen_world *world, const room *room, passage passages[PASSAGE_COUNT],
                     uint64_t *state) {
    enf_gen_post posts[MOUTHS_MAX * ARC_MAX];
    int count = 0;
    for (int m = 0; m < room->mouth_count; m++) {
        int next = (m + 1) % room->mouth_count;
        double from = room->mouths[m].degrees + mouth_half, to = room->mouths[next].degrees - mouth_half;
        if (next == 0) to += 360;
        int stretches = (int)((to - from) / degrees_per_point + 0.5), first = count;
        for (int i = 0; i <= stretches && i < ARC_MAX; i++)
            posts[count++] = rim_post(world, room, from + (to - from) * i / stretches, state);
        enf_gen_plan_walls(world, posts + first, count - first);
        passage *left = &passages[room->mouths[m].passage], *right = &passages[room->mouths[next].passage];
        left->ends[left->end_count][1] = posts[first];
        right->ends[right->end_count][0] = posts[count - 1];
    }
    for (int m = 0; m < room->mouth_count; m++) passages[room->mouths[m].passage].end_count++;
    enf_gen_plan_floor(world, posts, count);
}

// The posts between the two ends of a passage's side, given its other side, which is its mirror image.
static enf_gen_post side_post(enf_gen_world *world, const enf_gen_post side[2], const enf_gen_post other[2],
                              int i) {
    double t = (i + 1) / (SIDE_POINTS + 1.0), at[2];
    for (int a = 0; a < 2; a++) {
        double from = world->points[side[0].floor][a], from_other = world->points[other[0].floor][a];
        double to = world->points[side[1].floor][a], to_other = world->points[other[1].floor][a];
        double middle = ((1 - t) * (from + from_other) + t * (to + to_other)) / 2;
        double half = ((1 - t) * (from - from_other) + t * (to - to_other)) / 2;
        at[a] = (middle + narrowing[i] * half) / steps_per_unit;
    }
    return add_post(world, at[0], at[1]);
}

static void add_passage(enf_gen_world *world, const passage *passage) {
    enum { COUNT = SIDE_POINTS + 2 };
    enf_gen_post posts[2 * COUNT];
    const enf_gen_post right[2] = {passage->ends[0][0], passage->ends[1][1]};
    const enf_gen_post left[2] = {passage->ends[0][1], passage->ends[1][0]};
    posts[0] = right[0], posts[COUNT - 1] = right[1];
    posts[COUNT] = left[1], posts[2 * COUNT - 1] = left[0];
    for (int i = 0; i < SIDE_POINTS; i++) {
        posts[1 + i] = side_post(world, right, left, i);
        posts[2 * COUNT - 2 - i] = side_post(world, left, right, i);
    }
    enf_gen_plan_walls(world, posts, COUNT);
    enf_gen_plan_walls(world, posts + COUNT, COUNT);
    enf_gen_plan_floor(world, posts, 2 * COUNT);
}

static void tilt_point(double point[3]) {
    enf_gen_rotate((double(*)[3])tilt, point, point);
    for (int a = 0; a < 3; a++) point[a] /= unit_of_tilt;
}

void enf_gen_cavern(enf_gen_world *world, const enf_gen_options *options) {
    (void)options;
    passage passages[PASSAGE_COUNT] = {0};
    uint64_t state = dent_seed;
    for (int r = 0; r < ROOM_COUNT && !world->failed; r++) {
        enf_gen_group(world, "room-%d", r + 1);
        add_room(world, &rooms[r], passages, &state);
        enf_gen_spawn(world, rooms[r].x * steps_per_unit, rooms[r].y * steps_per_unit, HEIGHT / 2.0);
    }
    for (int p = 0; p < PASSAGE_COUNT && !world->failed; p++) {
        enf_gen_group(world, "passage-%d", p + 1);
        add_passage(world, &passages[p]);
    }
    for (size_t i = 0; i < world->point_count; i++) tilt_point(world->points[i]);
    for (size_t i = 0; i < world->spawn_count; i++) tilt_point(world->spawns[i]);
}
