// SPDX-License-Identifier: GPL-3.0-or-later
// An office block of any size. Space is cut into boxes by planes across each axis; some boxes are air, and
// every rectangle between air and not-air is written, so that nothing can leak and every edge is shared. The
// time is proportional to what is written. Stairs are closed solids that reach a little into floor and wall.
#include <stdlib.h>

#include "base/array.h"
#include "build/gen_world.h"

enum {
    FLOOR_LAYERS = 4, // slab, below the sills, up to the lintels, up to the ceiling
    COLUMN_CELLS = 4, // a room's three and the wall after it, along x
    BLOCK_CELLS = 10, // room 3, wall, corridor, wall, room 3, wall, along y
    FIRST_COLUMN = 6, // after wall, stairs, landing, wall, cross corridor, wall
    STEPS = 10,
    SOLID = -1
};

static const double layer_height[FLOOR_LAYERS] = {0.4, 0.9, 1.2, 0.7};
static const double wall_width = 0.2, room_widths[3] = {1.2, 1.2, 1.6}, room_depths[3] = {1.2, 2.8, 1.2};
static const double corridor_width = 2.0, stairs_width = 1.4;
static const double stairs_overlap = 0.1, stairs_foot = 0.05, stairs_thickness = 0.25;
static const double eye_height = 1.6;

typedef struct office {
    int64_t floors, rooms, columns, blocks, detail;
    int64_t count[3];  ///< cells along each axis
    double *planes[3]; ///< count + 1 each
    int32_t *group;    ///< of each cell, or SOLID
    int32_t glass;     ///< the group of window panes
} office;

static size_t cell_index(const office *office, int64_t x, int64_t y, int64_t z) {
    return (size_t)((z * office->count[1] + y) * office->count[0] + x);
}

// Makes the cells in [low, high] (both inclusive) air of a group.
static void carve(office *office, int32_t group, const int64_t low[3], const int64_t high[3]) {
    for (int64_t z = low[2]; z <= high[2]; z++)
        for (int64_t y = low[1]; y <= high[1]; y++)
            for (int64_t x = low[0]; x <= high[0]; x++) office->group[cell_index(office, x, y, z)] = group;
}

#define CARVE(office, group, x0, x1, y0, y1, z0, z1) \
    carve(office, group, (const int64_t[3]){x0, y0, z0}, (const int64_t[3]){x1, y1, z1})

// The cells' widths become planes, kept to thousandths.
static void add_planes(double *planes, int64_t *at, const double *widths, int count) {
    for (int i = 0; i < count; i++, ++*at) planes[*at + 1] = enf_gen_round(planes[*at] + widths[i]);
}

static void make_planes(office *office) {
    const double wall = wall_width, *depths = room_depths;
    const double start[6] = {wall, stairs_width, stairs_width, wall, corridor_width, wall};
    const double column[4] = {room_widths[0], room_widths[1], room_widths[2], wall};
    const double block[10] = {depths[0], depths[1], depths[2], wall,      corridor_width,
                              wall,      depths[0], depths[1], depths[2], wall};
    int64_t at = 0;
    office->planes[0][0] = office->planes[1][0] = 0.0;
    office->planes[2][0] = -layer_height[0];
    add_planes(office->planes[0], &at, start, 6);
    for (int64_t c = 0; c < office->columns; c++) add_planes(office->planes[0], &at, column, 4);
    at = 0;
    add_planes(office->planes[1], &at, &wall, 1);
    for (int64_t b = 0; b < office->blocks; b++) add_planes(office->planes[1], &at, block, 10);
    at = 0;
    for (int64_t f = 0; f < office->floors; f++) add_planes(office->planes[2], &at, layer_height, 4);
    add_planes(office->planes[2], &at, layer_height, 1);
}

static bool make_office(office *office, const enf_gen_options *options) {
    *office = (struct office){.floors = options->floors, .rooms = options->rooms, .detail = options->detail};
    office->blocks = 1; // about as wide as deep
    while ((office->blocks + 1) * (office->blocks + 1) * 6 <= office->rooms) office->blocks++;
    office->columns = (office->rooms + 2 * office->blocks - 1) / (2 * office->blocks);
    office->count[0] = FIRST_COLUMN + COLUMN_CELLS * office->columns;
    office->count[1] = 1 + BLOCK_CELLS * office->blocks;
    office->count[2] = 1 + FLOOR_LAYERS * office->floors;
    size_t cells = (size_t)(office->count[0] * office->count[1] * office->count[2]);
    office->group = enf_array_new(cells, sizeof *office->group);
    if (!office->group) return false;
    for (size_t i = 0; i < cells; i++) office->group[i] = SOLID;
    for (int a = 0; a < 3; a++) {
        office->planes[a] = enf_array_new((size_t)office->count[a] + 1, sizeof(double));
        if (!office->planes[a]) return false;
    }
    make_planes(office);
    return true;
}

static void free_office(office *office) {
    for (int a = 0; a < 3; a++) free(office->planes[a]);
    free(office->group);
}

static double middle(const office *office, int axis, int64_t cell) {
    return enf_gen_round((office->planes[axis][cell] + office->planes[axis][cell + 1]) / 2);
}

// One room with its door to the corridor, a pane where it stands at the front or back of the building, and
// an open window to its right-hand neighbour here and there.
static void carve_room(office *office, enf_gen_world *world, int64_t floor, int64_t number) {
    int64_t column = number % office->columns, row = number / office->columns;
    int64_t x = FIRST_COLUMN + COLUMN_CELLS * column, z = 1 + FLOOR_LAYERS * floor;
    int64_t y = 1 + BLOCK_CELLS * (row / 2) + (row % 2 ? 6 : 0), door = row % 2 ? y - 1 : y + 3;
    int32_t group = enf_gen_group(world, "floor-%d-room-%d", (int)floor + 1, (int)number + 1);
    CARVE(office, group, x, x + 2, y, y + 2, z, z + 2);
    CARVE(office, group, x + 1, x + 1, door, door, z, z + 1);
    if (row == 0) CARVE(office, group, x + 1, x + 1, 0, 0, z + 1, z + 1);
    if (row == 2 * office->blocks - 1) CARVE(office, group, x + 1, x + 1, y + 3, y + 3, z + 1, z + 1);
    if (column + 1 < office->columns && number + 1 < office->rooms && (column + row + floor) % 3 == 0)
        CARVE(office, group, x + 3, x + 3, y + 1, y + 1, z + 1, z + 1);
    enf_gen_spawn(world, middle(office, 0, x + 1), middle(office, 1, y + 1),
                  enf_gen_round(office->planes[2][z] + eye_height));
}

static void carve_floor(office *office, enf_gen_world *world, int64_t floor) {
    const int64_t z = 1 + FLOOR_LAYERS * floor, across = office->count[0] - 2, deep = office->count[1] - 2;
    int name = (int)floor + 1;
    int32_t stairwell = enf_gen_group(world, "floor-%d-stairwell", name);
    CARVE(office, stairwell, 1, 2, 1, 3, z, z + 2);
    CARVE(office, stairwell, 3, 3, 3, 3, z, z + 1);
    if (floor > 0) CARVE(office, stairwell, 1, 1, 2, 2, z - 1, z - 1);
    CARVE(office, enf_gen_group(world, "floor-%d-cross-corridor", name), 4, 4, 1, deep, z, z + 2);
    for (int64_t b = 0; b < office->blocks; b++) {
        int64_t y = 1 + BLOCK_CELLS * b + 4;
        int32_t corridor = enf_gen_group(world, "floor-%d-corridor-%d", name, (int)b + 1);
        CARVE(office, corridor, 5, across, y, y, z, z + 2);
    }
    for (int64_t r = 0; r < office->rooms; r++) carve_room(office, world, floor, r);
}

// A point on the face of a cell, at shares i and j of `detail` along the two other axes.
static int32_t face_point(const office *office, enf_gen_world *world, int axis, int64_t plane,
                          const int64_t cell[3], int64_t i, int64_t j) {
    double point[3];
    point[axis] = office->planes[axis][plane];
    const int64_t share[2] = {i, j};
    for (int k = 0; k < 2; k++) {
        int other = (axis + 1 + k) % 3;
        const double *planes = office->planes[other] + cell[other];
        point[other] = share[k] == office->detail
                           ? planes[1]
                           : planes[0] + (planes[1] - planes[0]) * (double)share[k] / (double)office->detail;
    }
    return enf_gen_point(world, point[0], point[1], point[2]);
}

// The face of a cell at its low (0) or high (1) end of an axis; the front faces the cell.
static void add_face(const office *office, enf_gen_world *world, const int64_t cell[3], int axis, int high,
                     int32_t group) {
    int64_t plane = cell[axis] + high;
    for (int64_t j = 0; j < office->detail; j++)
        for (int64_t i = 0; i < office->detail && !world->failed; i++) {
            int32_t a = face_point(office, world, axis, plane, cell, i, j);
            int32_t b = face_point(office, world, axis, plane, cell, i + 1, j);
            int32_t c = face_point(office, world, axis, plane, cell, i + 1, j + 1);
            int32_t d = face_point(office, world, axis, plane, cell, i, j + 1);
            enf_gen_triangle_in(world, group, a, high ? c : b, high ? b : c);
            enf_gen_triangle_in(world, group, a, high ? d : c, high ? c : d);
        }
}

static void add_cell(const office *office, enf_gen_world *world, const int64_t cell[3]) {
    int32_t group = office->group[cell_index(office, cell[0], cell[1], cell[2])];
    if (group == SOLID) return;
    for (int axis = 0; axis < 3; axis++)
        for (int high = 0; high < 2; high++) {
            int64_t next[3] = {cell[0], cell[1], cell[2]};
            next[axis] += high ? 1 : -1;
            bool outside = next[axis] < 0 || next[axis] >= office->count[axis];
            if (outside)
                add_face(office, world, cell, axis, high, office->glass);
            else if (office->group[cell_index(office, next[0], next[1], next[2])] == SOLID)
                add_face(office, world, cell, axis, high, group);
        }
}

/// The stairs' side view: point `k` of the line that the inner corners of the steps stand on, and below it.
typedef struct flight {
    double x[2], y[STEPS], inner[STEPS], under[STEPS];
} flight;

static flight make_flight(const office *office, int64_t floor) {
    flight flight;
    const double base = office->planes[2][1 + FLOOR_LAYERS * floor],
                 rise = office->planes[2][FLOOR_LAYERS + 1] / STEPS;
    const double start = office->planes[1][2] - stairs_foot, end = office->planes[1][3];
    flight.x[0] = enf_gen_round(office->planes[0][1] - stairs_overlap);
    flight.x[1] = enf_gen_round(office->planes[0][2] - stairs_overlap);
    for (int k = 0; k < STEPS; k++) {
        flight.y[k] = enf_gen_round(start + (end - start) * k / (STEPS - 1));
        flight.inner[k] = enf_gen_round(base + rise * k);
        flight.under[k] = enf_gen_round(base + rise * k - stairs_thickness);
    }
    flight.inner[0] = enf_gen_round(base - stairs_overlap);
    flight.y[STEPS - 1] = enf_gen_round(end + stairs_overlap);
    return flight;
}

// From floor `floor` to the next. The first step rises out of the floor, the last tread ends in the next
// slab.
static void add_stairs(const office *office, enf_gen_world *world, int64_t floor) {
    const flight flight = make_flight(office, floor);
    enf_gen_group(world, "stairs-%d", (int)floor + 1);
    int32_t under[2][2], inner[2][2], top[2][2]; // [step's near or far end][low or high x]
    for (int k = 0; k < STEPS; k++) {
        int end = k & 1, last = !end;
        for (int side = 0; side < 2; side++) {
            double x = flight.x[side];
            under[end][side] = enf_gen_point(world, x, flight.y[k], flight.under[k]);
            inner[end][side] = enf_gen_point(world, x, flight.y[k], flight.inner[k]);
            if (k > 0) top[last][side] = enf_gen_point(world, x, flight.y[k - 1], flight.inner[k]);
        }
        if (k == 0) {
            enf_gen_quad(world, under[0][0], under[0][1], inner[0][1], inner[0][0]);
            continue;
        }
        enf_gen_quad(world, inner[last][0], inner[last][1], top[last][1], top[last][0]);
        enf_gen_quad(world, top[last][0], top[last][1], inner[end][1], inner[end][0]);
        enf_gen_quad(world, under[last][0], under[end][0], under[end][1], under[last][1]);
        const int32_t high[5] = {under[last][1], under[end][1], inner[end][1], top[last][1], inner[last][1]};
        const int32_t low[5] = {inner[last][0], top[last][0], inner[end][0], under[end][0], under[last][0]};
        enf_gen_polygon(world, 0, 1, high, 5);
        enf_gen_polygon(world, 0, -1, low, 5);
    }
    int end = (STEPS - 1) & 1;
    enf_gen_quad(world, under[end][1], under[end][0], inner[end][0], inner[end][1]);
}

void enf_gen_office(enf_gen_world *world, const enf_gen_options *options) {
    office office;
    if (!make_office(&office, options)) {
        world->failed = true;
        free_office(&office);
        return;
    }
    for (int64_t f = 0; f < office.floors && !world->failed; f++) carve_floor(&office, world, f);
    office.glass = enf_gen_group(world, "glass");
    int64_t cell[3];
    for (cell[2] = 0; cell[2] < office.count[2]; cell[2]++)
        for (cell[1] = 0; cell[1] < office.count[1] && !world->failed; cell[1]++)
            for (cell[0] = 0; cell[0] < office.count[0]; cell[0]++) add_cell(&office, world, cell);
    for (int64_t f = 0; f + 1 < office.floors && !world->failed; f++) add_stairs(&office, world, f);
    free_office(&office);
}
