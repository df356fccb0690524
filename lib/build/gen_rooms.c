// SPDX-License-Identifier: GPL-3.0-or-later
// The four-room worlds of the thesis (4.3.1 - 4.3.3): four rooms in a ring whose walls do not line up, joined
// by four short corridors as high as the rooms. The plan is a 4 x 4 grid per room; the fewest triangles use
// its outline, the tessellated world all of it.
#include "build/gen_world.h"

enum { ROOM_COUNT = 4, BREAKS = 5, LEVELS = 2, PLAIN_POINTS = 16 };

static const double level[LEVELS] = {0.0, 3.5};

/// A room in plan. It has one door in a wall across x, from y[door_y] to y[door_y + 1], and one across y,
/// alike.
typedef struct room {
    double x[BREAKS], y[BREAKS];
    int door_x, door_y;
    bool east, north; ///< which of the two walls the doors are in; else west, south
} room;

static const room rooms[ROOM_COUNT] = {
    {{0.5, 2.2, 4.0, 4.9, 7.7}, {-0.7, 1.3, 3.4, 4.3, 7.3}, 2, 2, true, true},
    {{8.4, 10.8, 13.2, 14.1, 17.2}, {-0.9, 1.2, 3.4, 4.3, 6.1}, 2, 2, false, true},
    {{10.5, 13.2, 14.1, 15.7, 17.3}, {7.3, 9.2, 11.2, 12.1, 14.7}, 1, 2, false, false},
    {{1.6, 4.0, 4.9, 7.3, 9.7}, {8.7, 11.2, 12.1, 13.8, 15.5}, 1, 1, true, false},
};

/// From the east or north door of one room to the west or south door of another.
typedef struct corridor {
    int from, to;
    bool along_y;
} corridor;

static const corridor corridors[] = {{0, 1, false}, {1, 2, true}, {3, 2, false}, {0, 3, true}};

enum { CORRIDOR_COUNT = sizeof corridors / sizeof *corridors };

static int32_t grid_point(enf_gen_world *world, const room *room, int i, int j, int up) {
    return enf_gen_point(world, room->x[i], room->y[j], level[up]);
}

// The grid's rim, counter-clockwise from above: 16 points, of which number k and k + 1 bound a stretch of
// wall.
static void rim(int k, int *i, int *j) {
    const int side = BREAKS - 1, along = k % side;
    switch (k / side % 4) {
    case 0:
        *i = along, *j = 0;
        break;
    case 1:
        *i = side, *j = along;
        break;
    case 2:
        *i = side - along, *j = side;
        break;
    default:
        *i = 0, *j = side - along;
        break;
    }
}

// Is the stretch of the rim that begins at number k a door?
static bool is_door(const room *room, int k) {
    const int side = BREAKS - 1, along = k % side;
    switch (k / side % 4) {
    case 0:
        return !room->north && along == room->door_x;
    case 1:
        return room->east && along == room->door_y;
    case 2:
        return room->north && side - 1 - along == room->door_x;
    default:
        return !room->east && side - 1 - along == room->door_y;
    }
}

static bool is_corner(int k) {
    return k % (BREAKS - 1) == 0;
}

// One stretch of wall from rim point k to rim point `end`; its front faces the room.
static void wall(enf_gen_world *world, const room *room, int k, int end) {
    int i, j, next_i, next_j;
    rim(k, &i, &j);
    rim(end, &next_i, &next_j);
    enf_gen_quad(world, grid_point(world, room, next_i, next_j, 0), grid_point(world, room, i, j, 0),
                 grid_point(world, room, i, j, 1), grid_point(world, room, next_i, next_j, 1));
}

static void add_spawns(enf_gen_world *world) {
    for (int r = 0; r < ROOM_COUNT; r++)
        enf_gen_spawn(world, enf_gen_round((rooms[r].x[0] + rooms[r].x[BREAKS - 1]) / 2),
                      enf_gen_round((rooms[r].y[0] + rooms[r].y[BREAKS - 1]) / 2), (level[0] + level[1]) / 2);
}

// Four faces between the east (north) door of one room and the west (south) door of the other.
static void add_corridors(enf_gen_world *world) {
    for (int c = 0; c < CORRIDOR_COUNT; c++) {
        const corridor *way = &corridors[c];
        int32_t rings[2][4];
        for (int end = 0; end < 2; end++) {
            const room *at = &rooms[end ? way->to : way->from];
            for (int k = 0; k < 4; k++) { // counter-clockwise about the corridor's direction
                int second = k == 1 || k == 2, up = k >= 2;
                if (way->along_y)
                    rings[end][k] = grid_point(world, at, at->door_x + 1 - second, end ? 0 : BREAKS - 1, up);
                else
                    rings[end][k] = grid_point(world, at, end ? 0 : BREAKS - 1, at->door_y + second, up);
            }
        }
        enf_gen_group(world, "corridor-%d", c + 1);
        enf_gen_tube(world, rings[0], rings[1], 4);
    }
}

static void plain_room(enf_gen_world *world, const room *room) {
    int32_t floor[BREAKS * 4], ceiling[BREAKS * 4];
    size_t count = 0;
    for (int k = 0; k < 4 * (BREAKS - 1); k++)
        if (is_corner(k) || is_door(room, k) || is_door(room, k - 1)) {
            int i, j;
            rim(k, &i, &j);
            floor[count++] = grid_point(world, room, i, j, 0);
        }
    for (size_t n = 0; n < count; n++) {
        const double *point = world->points[floor[n]];
        ceiling[count - 1 - n] = enf_gen_point(world, point[0], point[1], level[1]);
    }
    enf_gen_polygon(world, 2, 1, floor, count);
    enf_gen_polygon(world, 2, -1, ceiling, count);
    for (int k = 0, end; k < 4 * (BREAKS - 1); k = end) {
        end = k + 1;
        if (is_door(room, k)) continue;
        while (!is_corner(end) && !is_door(room, end)) end++;
        wall(world, room, k, end);
    }
}

void enf_gen_four_rooms(enf_gen_world *world, const enf_gen_options *options) {
    (void)options;
    add_spawns(world);
    for (int r = 0; r < ROOM_COUNT && !world->failed; r++) {
        enf_gen_group(world, "room-%d", r + 1);
        plain_room(world, &rooms[r]);
    }
    add_corridors(world);
}

void enf_gen_four_rooms_tessellated(enf_gen_world *world, const enf_gen_options *options) {
    (void)options;
    add_spawns(world);
    for (int r = 0; r < ROOM_COUNT; r++) {
        enf_gen_group(world, "room-%d", r + 1);
        for (int up = 0; up < LEVELS; up++)
            for (int j = 0; j + 1 < BREAKS; j++)
                for (int i = 0; i + 1 < BREAKS; i++) {
                    int32_t a = grid_point(world, &rooms[r], i, j, up);
                    int32_t b = grid_point(world, &rooms[r], i + 1, j, up);
                    int32_t c = grid_point(world, &rooms[r], i + 1, j + 1, up);
                    int32_t d = grid_point(world, &rooms[r], i, j + 1, up);
                    enf_gen_quad(world, a, up ? d : b, c, up ? b : d);
                }
        for (int k = 0; k < 4 * (BREAKS - 1); k++)
            if (!is_door(&rooms[r], k)) wall(world, &rooms[r], k, k + 1);
    }
    add_corridors(world);
}

/// How the distorted world turns each room about its middle, and how far it pulls its corners.
typedef struct distortion {
    double degrees[3];
    double pull[8][3]; ///< by corner: bit 0 east, bit 1 north, bit 2 up
} distortion;

static const double shrink = 0.76; // about their middles, so that they stay apart
static const distortion distortions[ROOM_COUNT] = {
    {{3.2, 4.8, -3.5}, {[5] = {0.1, 0, 0.4}, [6] = {0, 0.6, -0.3}}},
    {{-3.8, -4.8, -2.7}, {[1] = {-0.7, 0.4, 0.7}, [6] = {-0.9, -0.7, -0.6}}},
    {{-4.7, 3.3, -4.3}, {[3] = {0, -0.5, 0.6}, [4] = {0.4, -0.1, 0}}},
    {{-2.8, -2.7, 4.2}, {[2] = {0.6, 0.9, 0.4}}},
};

static void distort(const room *box, const distortion *how, double point[3]) {
    const double low[3] = {box->x[0], box->y[0], level[0]};
    const double high[3] = {box->x[BREAKS - 1], box->y[BREAKS - 1], level[1]};
    double matrix[3][3], offset[3], share[3];
    for (int a = 0; a < 3; a++) {
        share[a] = (point[a] - low[a]) / (high[a] - low[a]);
        offset[a] = (point[a] - (low[a] + high[a]) / 2) * shrink;
    }
    for (int i = 0; i < 8; i++) {
        double weight = (i & 1 ? share[0] : 1 - share[0]) * (i & 2 ? share[1] : 1 - share[1]) *
                        (i & 4 ? share[2] : 1 - share[2]);
        for (int a = 0; a < 3; a++) offset[a] += weight * how->pull[i][a];
    }
    enf_gen_rotation(how->degrees, matrix);
    enf_gen_rotate(matrix, offset, offset);
    for (int a = 0; a < 3; a++) point[a] = enf_gen_round((low[a] + high[a]) / 2 + offset[a]);
}

void enf_gen_four_rooms_distorted(enf_gen_world *world, const enf_gen_options *options) {
    enf_gen_four_rooms(world, options);
    for (size_t i = 0; i < world->point_count && !world->failed; i++) { // the points stand room by room
        size_t r = i / PLAIN_POINTS;
        distort(&rooms[r], &distortions[r], world->points[i]);
    }
}
