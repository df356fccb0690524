// SPDX-License-Identifier: GPL-3.0-or-later
// A test world while it is made: shared points, triangles by group, spawns. Internal to the gen*.c files.
#ifndef ENF_BUILD_GEN_WORLD_H
#define ENF_BUILD_GEN_WORLD_H

#include <stdio.h>

#include "enfilade/base.h"

/// What the settings said; see gen.h.
typedef struct enf_gen_options {
    int64_t floors, rooms, detail;
    uint64_t seed;
    double noise;
    double scale[3], rotate[3], translate[3];
} enf_gen_options;

typedef struct enf_gen_world {
    double (*points)[3]; ///< all different
    size_t point_count, point_capacity;
    int32_t *slots; ///< hash table from coordinates to point index, or -1
    size_t slot_count;
    int32_t (*triangles)[3];
    int32_t *triangle_group; ///< as many as triangles
    size_t triangle_count, triangle_capacity, triangle_group_capacity;
    char (*groups)[48];
    size_t group_count, group_capacity;
    double (*spawns)[3];
    size_t spawn_count, spawn_capacity;
    bool failed; ///< out of memory (or of 31 bits): everything after does nothing
} enf_gen_world;

void enf_gen_world_free(enf_gen_world *world);

/// The index of the point with exactly these coordinates, made if new. 0 after a failure.
int32_t enf_gen_point(enf_gen_world *world, double x, double y, double z);

/// Starts a new group for the triangles to come; returns its number.
int32_t enf_gen_group(enf_gen_world *world, const char *format, ...) ENF_PRINTF(2, 3);

void enf_gen_spawn(enf_gen_world *world, double x, double y, double z);

/// Corners counter-clockwise seen from the front. Triangles go into the newest group.
void enf_gen_triangle(enf_gen_world *world, int32_t a, int32_t b, int32_t c);
void enf_gen_triangle_in(enf_gen_world *world, int32_t group, int32_t a, int32_t b, int32_t c);
void enf_gen_quad(enf_gen_world *world, int32_t a, int32_t b, int32_t c, int32_t d);

/// A simple polygon of at most 64 corners, flat across `axis` (0 x, 1 y, 2 z), cut into triangles that use
/// every corner (also those on a straight side). Corners counter-clockwise seen from the front, which is the
/// side that `facing` (+1 or -1) names along the axis.
void enf_gen_polygon(enf_gen_world *world, int axis, int facing, const int32_t *corners, size_t count);

/// A closed box, fronts outward.
void enf_gen_box(enf_gen_world *world, const double low[3], const double high[3]);

/// Walls between two rings of `count` points, fronts inward: ring `a` is counter-clockwise seen from ring
/// `b`.
void enf_gen_tube(enf_gen_world *world, const int32_t *a, const int32_t *b, size_t count);

/// A corner of a plan: its points in the floor and in the ceiling.
typedef struct enf_gen_post {
    int32_t floor, ceiling;
} enf_gen_post;

enf_gen_post enf_gen_plan_post(enf_gen_world *world, double x, double y, double low, double high);

/// Walls along a row of corners, the air on its left.
void enf_gen_plan_walls(enf_gen_world *world, const enf_gen_post *posts, int count);

/// Floor and ceiling over at most 64 corners, counter-clockwise seen from above.
void enf_gen_plan_floor(enf_gen_world *world, const enf_gen_post *posts, int count);

/// splitmix64 (Steele, Lea, Flood 2014): next number of the stream, and one in [-1, 1).
uint64_t enf_gen_random(uint64_t *state);
double enf_gen_random_unit(uint64_t *state);

/// Sine and cosine of an angle in degrees from +, -, * and / alone: the same bits with every C library,
/// and exact at multiples of 90.
void enf_gen_sine_cosine(double degrees, double *sine, double *cosine);

/// The matrix that turns about x, then y, then z.
void enf_gen_rotation(const double degrees[3], double matrix[3][3]);
void enf_gen_rotate(double matrix[3][3], const double in[3], double out[3]);

/// To the nearest thousandth: short numbers in the file, and no trace of round-off.
double enf_gen_round(double value);

/// The worlds. Failures are left in world->failed.
void enf_gen_four_rooms(enf_gen_world *world, const enf_gen_options *options);
void enf_gen_four_rooms_tessellated(enf_gen_world *world, const enf_gen_options *options);
void enf_gen_four_rooms_distorted(enf_gen_world *world, const enf_gen_options *options);
void enf_gen_cavern(enf_gen_world *world, const enf_gen_options *options);
void enf_gen_caverns(enf_gen_world *world, const enf_gen_options *options);
void enf_gen_furnished(enf_gen_world *world, const enf_gen_options *options);
void enf_gen_office(enf_gen_world *world, const enf_gen_options *options);
void enf_gen_post_world(enf_gen_world *world, const enf_gen_options *options);

/// Puts scale, noise, rotation and translation into effect.
void enf_gen_transform(enf_gen_world *world, const enf_gen_options *options);

/// The whole file. False when `out` reports an error.
bool enf_gen_print(const enf_gen_world *world, const char *name, const char *const *settings,
                   size_t setting_count, FILE *out);

#endif
