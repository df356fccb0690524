// SPDX-License-Identifier: GPL-3.0-or-later
// The checker's own numbers: planes and vertices of a world as whole numbers in lowest terms (GMP), so that
// the same plane or place always is the same number, however it was named.
#ifndef ENF_BUILD_CHECK_EXACT_H
#define ENF_BUILD_CHECK_EXACT_H

#include <gmp.h>

#include "enfilade/format.h"

/// Four whole numbers in the arena: limbs one after the other; a negative size is a negative number.
typedef struct enf_check_tuple {
    int64_t first;
    int16_t size[4];
} enf_check_tuple;

/// Tuples found by value: numbers in slots, -1 empty.
typedef struct enf_check_table {
    int32_t *slots;
    size_t mask;
} enf_check_table;

/// Coordinates are in units: grid steps divided by the largest power of two that divides them all.
typedef struct enf_check_exact {
    const enf_file_view *view;
    double unit; ///< grid steps

    int32_t *plane_class; ///< per plane: the geometric plane; equal for planes that coincide
    int8_t *plane_sign;   ///< +1 or -1: it faces as the class does, or the other way
    enf_check_table class_table;
    int32_t class_count;
    enf_check_tuple *classes; ///< a, b, c, d: a x + b y + c z + d
    double (*class_near)[4];  ///< the same rounded (2^-52 relative)
    bool *class_whole;        ///< the rounded ones are exact

    int32_t *place;             ///< per vertex: the smallest number of the vertices at the same point
    enf_check_tuple *vertices;  ///< x, y, z, w with w > 0
    double (*near)[3];          ///< x / w and so on, rounded (2^-50 relative)
    bool *vertex_whole;         ///< the rounded ones are exact
    int32_t (*vertex_class)[3]; ///< classes of its planes; -1 for points
    int32_t vertex_count;       ///< the world's, and those that enf_check_cross_edge added

    mp_limb_t *limbs;
    size_t limb_count, limb_capacity;
    size_t world_limbs; ///< without those of vertices that were added
    size_t class_capacity, class_near_capacity, class_whole_capacity;
    size_t vertex_capacity, near_capacity, vertex_whole_capacity, vertex_class_capacity;
    mpz_t term[12]; ///< scratch
} enf_check_exact;

/// What makes a world's numbers useless.
typedef enum enf_check_fault {
    ENF_CHECK_FAULT_NONE,
    ENF_CHECK_FAULT_MEMORY,
    ENF_CHECK_FAULT_POINT, ///< *which is a point that is not whole, or equal to the one before it
    ENF_CHECK_FAULT_PLANE, ///< *which is a plane whose points do not span it
    ENF_CHECK_FAULT_VERTEX ///< *which is a vertex whose planes do not cross in one point, or one without
                           ///< planes
} enf_check_fault;

enf_check_fault enf_check_exact_make(enf_check_exact *exact, const enf_file_view *view, int32_t *which);
void enf_check_exact_free(enf_check_exact *exact);

/// On which side of the plane of the class is the vertex? -1, 0, +1.
int enf_check_side_of_class(enf_check_exact *exact, int32_t vertex, int32_t plane_class);
int enf_check_side(enf_check_exact *exact, int32_t vertex, int32_t plane);

/// The class of the plane through three points of the world, or -1 if no plane of the world is there; *sign:
/// it faces as the class does (+1) or the other way, seen from where the points turn counter-clockwise; 0
/// without memory.
int32_t enf_check_class_through(enf_check_exact *exact, const int32_t points[3], int8_t *sign);

/// A vertex of the checker's own: where the edge between two vertices on different sides of the plane meets
/// it. It has no place, so only its sides of planes may be asked for. -1 without memory.
int32_t enf_check_cross_edge(enf_check_exact *exact, int32_t from, int32_t to, int32_t plane_class);

/// Drops all such vertices.
void enf_check_drop_crossings(enf_check_exact *exact);

/// Do three vertices turn counter-clockwise (+1), seen along `axis` from its positive end?
int enf_check_turn(enf_check_exact *exact, int axis, int32_t a, int32_t b, int32_t c);

/// Sign of det(b - a, c - a, d - a) for four points.
int enf_check_orient(enf_check_exact *exact, int32_t a, int32_t b, int32_t c, int32_t d);

/// The axis along which the plane's normal is longest (nearly), and the normal's sign there.
int enf_check_axis(const enf_check_exact *exact, int32_t plane, int *sign);

/// Is `position` (grid steps) within 0.5 + 2^-50 |x| grid steps of the vertex, along every axis?
bool enf_check_position_near(enf_check_exact *exact, int32_t vertex, const double position[3]);

/// Side of a point given in grid steps, any doubles.
int enf_check_side_of_place(enf_check_exact *exact, const double grid[3], int32_t plane);

/// The sign of component `axis` of the normal of three points.
int enf_check_normal_sign(const enf_check_exact *exact, const int32_t points[3], int axis);

#endif
