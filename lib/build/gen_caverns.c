// SPDX-License-Identifier: GPL-3.0-or-later
// Caverns of any size: storeys of rooms on a bent grid, a passage between any two neighbours that flares into
// both, shafts here and there from one storey to the next. Space is a field, negative in the air: flattened
// domes for rooms, cones for passages and shafts, cut off by a floor, all roughened by smooth noise. Its
// surface is taken by marching tetrahedra (A. Doi, A. Koide, "An efficient method of triangulating
// equi-valued surfaces by using tetrahedral cells", 1991) on a lattice whose cubes are cut into six alike (H.
// W. Kuhn): closed, and since every triangle stays in its tetrahedron, none meets another but in a corner or
// an edge. `detail` divides the lattice. Only + - * / and roots decide, so the bytes are the same everywhere.
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "build/gen_world.h"

enum {
    CUBES_ACROSS = 9, // of the lattice, at detail 1: along x and y, for each room
    CUBES_UP = 6,     // for each storey
    SHAFT_EVERY = 5,  // rooms; the first one always has one
};

/// Lengths in world units. The parts of a room stay away from the sides of its place in the grid, except
/// passages and shafts, which both rooms know.
static const double cube_size = 1.5; // at detail 1
static const double radius_least = 3.7, radius_range = 1.0, height_least = 2.6, height_range = 0.6;
static const double shift = 0.55;                             // of a room from the middle of its place
static const double passage_radius = 1.4, shaft_radius = 1.4; // half way
static const double flare = 1.0;                              // wider at the ends
static const double floor_depth = 1.6, shaft_foot = 1.0;      // below, above the middle of a room
static const double bump = 0.4, bump_length = 2.4;            // of the noise: too gentle for islands
static const double edge_end = 0.1; // share of a lattice edge next to its ends where no point comes

/// The rotation of gen_cavern.c, from the quaternion 10 + i - j + k: times 103.
static const double tilt[3][3] = {{99, -22, -18}, {18, 99, -22}, {22, 18, 99}};
static const double tilt_length = 103.0, step_of_points = 1e-6;

typedef struct room {
    double middle[3], sine, cosine; ///< the longer radius points this way
    double radius[3];               ///< along, across, up
    bool has_shaft;                 ///< to the room above
} room;

typedef struct caverns {
    int64_t floors, rooms, columns, rows, detail;
    uint64_t seed;
    double step;      ///< of the lattice
    int64_t count[3]; ///< cubes along each axis
    room *list;       ///< floors * rooms
    double *layer[2]; ///< the field in the lattice points below and above the cubes at hand
} caverns;

// ---------------------------------------------------------------------------------------------- the rooms

static double random_share(uint64_t *state) {
    return (enf_gen_random_unit(state) + 1) / 2;
}

static void make_room(caverns *caverns, int64_t floor, int64_t number) {
    room *room = &caverns->list[floor * caverns->rooms + number];
    uint64_t state = caverns->seed * 1000003 + (uint64_t)(floor * caverns->rooms + number);
    const int64_t place[3] = {number % caverns->columns, number / caverns->columns, floor};
    const int cubes[3] = {CUBES_ACROSS, CUBES_ACROSS, CUBES_UP};
    for (int a = 0; a < 3; a++) room->middle[a] = ((double)place[a] + 0.5) * cubes[a] * cube_size;
    for (int a = 0; a < 2; a++) {
        room->middle[a] += shift * enf_gen_random_unit(&state);
        room->radius[a] = radius_least + radius_range * random_share(&state);
    }
    room->radius[2] = height_least + height_range * random_share(&state);
    enf_gen_sine_cosine(180 * random_share(&state), &room->sine, &room->cosine);
    room->has_shaft = floor + 1 < caverns->floors && (number + floor) % SHAFT_EVERY == 0;
    if (floor + 1 < caverns->floors && number == 0) room->has_shaft = true;
}

static bool make_caverns(caverns *caverns, const enf_gen_options *options) {
    *caverns = (struct caverns){.floors = options->floors, .rooms = options->rooms, .columns = 1};
    caverns->detail = options->detail;
    caverns->seed = options->seed;
    while (caverns->columns * caverns->columns < caverns->rooms) caverns->columns++;
    caverns->rows = (caverns->rooms + caverns->columns - 1) / caverns->columns;
    caverns->step = cube_size / (double)caverns->detail;
    caverns->count[0] = CUBES_ACROSS * caverns->detail * caverns->columns;
    caverns->count[1] = CUBES_ACROSS * caverns->detail * caverns->rows;
    caverns->count[2] = CUBES_UP * caverns->detail * caverns->floors;
    size_t points = (size_t)((caverns->count[0] + 1) * (caverns->count[1] + 1));
    caverns->list = enf_array_new((size_t)(caverns->floors * caverns->rooms), sizeof *caverns->list);
    for (int k = 0; k < 2; k++) caverns->layer[k] = enf_array_new(points, sizeof(double));
    if (!caverns->list || !caverns->layer[0] || !caverns->layer[1]) return false;
    for (int64_t f = 0; f < caverns->floors; f++)
        for (int64_t r = 0; r < caverns->rooms; r++) make_room(caverns, f, r);
    return true;
}

static void free_caverns(caverns *caverns) {
    free(caverns->list);
    free(caverns->layer[0]);
    free(caverns->layer[1]);
}

/// The room whose place in the grid holds a point, or null.
static const room *room_at(const caverns *caverns, const double at[3]) {
    const double across = CUBES_ACROSS * cube_size, up = CUBES_UP * cube_size;
    int64_t column = (int64_t)(at[0] / across), row = (int64_t)(at[1] / across),
            floor = (int64_t)(at[2] / up);
    if (column >= caverns->columns) column = caverns->columns - 1;
    if (floor >= caverns->floors) floor = caverns->floors - 1;
    int64_t number = row * caverns->columns + column;
    return number < caverns->rooms ? &caverns->list[floor * caverns->rooms + number] : NULL;
}

// ---------------------------------------------------------------------------------------------- the field

/// A random number in [-1, 1) for each point with whole coordinates.
static double lattice_noise(uint64_t seed, const int64_t at[3]) {
    uint64_t state = seed;
    for (int a = 0; a < 3; a++) {
        state ^= (uint64_t)at[a];
        state = enf_gen_random(&state);
    }
    return enf_gen_random_unit(&state);
}

/// Smooth noise in [-1, 1): between whole coordinates blended by 3t^2 - 2t^3 (K. Perlin, "An image
/// synthesizer", 1985).
static double noise(uint64_t seed, const double at[3]) {
    int64_t low[3];
    double share[3], sum = 0;
    for (int a = 0; a < 3; a++) {
        double whole = floor(at[a]), t = at[a] - whole;
        low[a] = (int64_t)whole;
        share[a] = t * t * (3 - 2 * t);
    }
    for (int corner = 0; corner < 8; corner++) {
        int64_t point[3];
        double weight = 1;
        for (int a = 0; a < 3; a++) {
            int high = corner >> a & 1;
            point[a] = low[a] + high;
            weight *= high ? share[a] : 1 - share[a];
        }
        sum += weight * lattice_noise(seed, point);
    }
    return sum;
}

/// A dome about a room's middle; roughly the distance from its surface.
static double room_field(const room *room, const double at[3]) {
    double x = at[0] - room->middle[0], y = at[1] - room->middle[1], z = at[2] - room->middle[2];
    double along = (x * room->cosine + y * room->sine) / room->radius[0];
    double across = (y * room->cosine - x * room->sine) / room->radius[1];
    double up = z / room->radius[2];
    return (sqrt(along * along + across * across + up * up) - 1) * room->radius[2];
}

/// A way from one point to another, narrowest half way.
static double way_field(const double from[3], const double to[3], double radius, const double at[3]) {
    double along = 0, length = 0, distance = 0;
    for (int a = 0; a < 3; a++) {
        along += (at[a] - from[a]) * (to[a] - from[a]);
        length += (to[a] - from[a]) * (to[a] - from[a]);
    }
    double t = along / length;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int a = 0; a < 3; a++) {
        double d = at[a] - (from[a] + t * (to[a] - from[a]));
        distance += d * d;
    }
    return sqrt(distance) - (radius + flare * (2 * t - 1) * (2 * t - 1));
}

static double passage_field(const room *from, const room *to, const double at[3]) {
    return way_field(from->middle, to->middle, passage_radius, at);
}

static double shaft_field(const room *below, const room *above, const double at[3]) {
    const double foot[3] = {below->middle[0], below->middle[1], below->middle[2] + shaft_foot};
    return way_field(foot, above->middle, shaft_radius, at);
}

/// The room that holds the point, its passages and shafts.
static double field_at(const caverns *caverns, const double at[3]) {
    const room *room = room_at(caverns, at);
    if (!room) return 1;
    int64_t number = (room - caverns->list) % caverns->rooms, columns = caverns->columns;
    double field = room_field(room, at);
    if (number % columns > 0) field = fmin(field, passage_field(room - 1, room, at));
    if (number % columns + 1 < columns && number + 1 < caverns->rooms)
        field = fmin(field, passage_field(room, room + 1, at));
    if (number >= columns) field = fmin(field, passage_field(room - columns, room, at));
    if (number + columns < caverns->rooms) field = fmin(field, passage_field(room, room + columns, at));
    field = fmax(field, room->middle[2] - floor_depth - at[2]);
    if (room->has_shaft) field = fmin(field, shaft_field(room, room + caverns->rooms, at));
    if (room - caverns->list >= caverns->rooms && (room - caverns->rooms)->has_shaft)
        field = fmin(field, shaft_field(room - caverns->rooms, room, at));
    if (fabs(field) > 2 * bump) return field; // far from where noise could change the sign
    const double scaled[3] = {at[0] / bump_length, at[1] / bump_length, at[2] / bump_length};
    return field + bump * noise(caverns->seed, scaled);
}

static void fill_layer(const caverns *caverns, int64_t z, double *layer) {
    for (int64_t y = 0; y <= caverns->count[1]; y++)
        for (int64_t x = 0; x <= caverns->count[0]; x++) {
            const double at[3] = {(double)x * caverns->step, (double)y * caverns->step,
                                  (double)z * caverns->step};
            *layer++ = field_at(caverns, at);
        }
}

// ------------------------------------------------------------------------------------- marching tetrahedra

/// A cube of the lattice. Corner number: bit a is set at the high end of axis a.
typedef struct cube {
    const caverns *caverns;
    enf_gen_world *world;
    int32_t group;
    double low[3], field[8];
} cube;

static void tilt_point(const double point[3], double out[3]) {
    enf_gen_rotate((double(*)[3])tilt, point, out);
    for (int a = 0; a < 3; a++) out[a] = floor(out[a] / tilt_length / step_of_points + 0.5) * step_of_points;
}

/// Where the surface meets the edge between two corners. The lower one comes first, so that all cubes at the
/// edge get the same point.
static int32_t edge_point(const cube *cube, int a, int b) {
    int low = a < b ? a : b, high = a < b ? b : a;
    double t = cube->field[low] / (cube->field[low] - cube->field[high]), point[3];
    t = t < edge_end ? edge_end : t > 1 - edge_end ? 1 - edge_end : t;
    for (int axis = 0; axis < 3; axis++) {
        double share = (low >> axis & 1) + t * ((high >> axis & 1) - (low >> axis & 1));
        point[axis] = cube->low[axis] + share * cube->caverns->step;
    }
    tilt_point(point, point);
    return enf_gen_point(cube->world, point[0], point[1], point[2]);
}

/// The front is on the side of a corner.
static void add_triangle(const cube *cube, const int32_t points[3], int corner) {
    if (cube->world->failed) return;
    double plain[3], toward[3], e[2][3], normal[3], side = 0;
    for (int a = 0; a < 3; a++) plain[a] = cube->low[a] + (corner >> a & 1) * cube->caverns->step;
    tilt_point(plain, toward);
    const double *p = cube->world->points[points[0]];
    for (int k = 0; k < 2; k++)
        for (int a = 0; a < 3; a++) e[k][a] = cube->world->points[points[k + 1]][a] - p[a];
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        normal[a] = e[0][b] * e[1][c] - e[0][c] * e[1][b];
        side += normal[a] * (toward[a] - p[a]);
    }
    enf_gen_triangle_in(cube->world, cube->group, points[0], points[side > 0 ? 1 : 2],
                        points[side > 0 ? 2 : 1]);
}

/// The surface in a tetrahedron: a triangle around its one corner in the air or in the rock, or a strip
/// between two and two.
static void add_tetrahedron(const cube *cube, const int corners[4]) {
    int air[4], rock[4], airs = 0, rocks = 0;
    for (int k = 0; k < 4; k++) {
        if (cube->field[corners[k]] < 0)
            air[airs++] = corners[k];
        else
            rock[rocks++] = corners[k];
    }
    if (airs == 0 || rocks == 0) return;
    if (airs == 2) {
        const int32_t ring[4] = {edge_point(cube, air[0], rock[0]), edge_point(cube, air[0], rock[1]),
                                 edge_point(cube, air[1], rock[1]), edge_point(cube, air[1], rock[0])};
        add_triangle(cube, (const int32_t[3]){ring[0], ring[1], ring[2]}, air[0]);
        add_triangle(cube, (const int32_t[3]){ring[0], ring[2], ring[3]}, air[0]);
        return;
    }
    int32_t points[3];
    for (int k = 0; k < 3; k++)
        points[k] = airs == 1 ? edge_point(cube, air[0], rock[k]) : edge_point(cube, air[k], rock[0]);
    add_triangle(cube, points, air[0]);
}

static void add_cube(const cube *cube) {
    static const int orders[6][2] = {{1, 2}, {1, 4}, {2, 1}, {2, 4}, {4, 1}, {4, 2}};
    int airs = 0;
    for (int k = 0; k < 8; k++) airs += cube->field[k] < 0;
    if (airs == 0 || airs == 8) return;
    for (int k = 0; k < 6; k++) // along one axis, then another, then the third
        add_tetrahedron(cube, (const int[4]){0, orders[k][0], orders[k][0] + orders[k][1], 7});
}

static void add_layer(const caverns *caverns, enf_gen_world *world, int64_t z) {
    const int64_t row = caverns->count[0] + 1;
    for (int64_t y = 0; y < caverns->count[1]; y++)
        for (int64_t x = 0; x < caverns->count[0] && !world->failed; x++) {
            cube cube = {.caverns = caverns, .world = world};
            const int64_t place[3] = {x, y, z};
            for (int a = 0; a < 3; a++) cube.low[a] = (double)place[a] * caverns->step;
            const room *room = room_at(caverns, cube.low);
            if (!room) continue;
            cube.group = (int32_t)(room - caverns->list);
            for (int k = 0; k < 8; k++)
                cube.field[k] = caverns->layer[k >> 2][(y + (k >> 1 & 1)) * row + x + (k & 1)];
            add_cube(&cube);
        }
}

void enf_gen_caverns(enf_gen_world *world, const enf_gen_options *options) {
    caverns caverns;
    if (!make_caverns(&caverns, options)) world->failed = true;
    for (int64_t i = 0; i < caverns.floors * caverns.rooms && !world->failed; i++) {
        double at[3];
        enf_gen_group(world, "floor-%d-room-%d", (int)(i / caverns.rooms) + 1, (int)(i % caverns.rooms) + 1);
        tilt_point(caverns.list[i].middle, at);
        enf_gen_spawn(world, at[0], at[1], at[2]);
    }
    if (!world->failed) fill_layer(&caverns, 0, caverns.layer[0]);
    for (int64_t z = 0; z < caverns.count[2] && !world->failed; z++) {
        fill_layer(&caverns, z + 1, caverns.layer[1]);
        add_layer(&caverns, world, z);
        double *done = caverns.layer[0];
        caverns.layer[0] = caverns.layer[1];
        caverns.layer[1] = done;
    }
    free_caverns(&caverns);
}
