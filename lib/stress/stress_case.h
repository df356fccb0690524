// SPDX-License-Identifier: GPL-3.0-or-later
// A soup made to break things, with what is known of it: the closed convex solids that it was made of. The
// material that families (stress_family.h) and hard soups (stress_hard.h) are made with. Only +, -, *, / are
// used, so a seed gives the same soup on every machine.
#ifndef ENF_BUILD_STRESS_CASE_H
#define ENF_BUILD_STRESS_CASE_H

#include "build/soup.h"

/// What is known about rock and air.
typedef enum enf_stress_truth {
    ENF_STRESS_UNKNOWN, ///< nothing: polygons without an inside
    ENF_STRESS_SOLIDS,  ///< the soup is closed convex solids that face outwards: rock is their union
    ENF_STRESS_SHELLS,  ///< closed surfaces; rooms face inwards: air is where the winding number is negative
} enf_stress_truth;

typedef struct enf_stress_case {
    enf_soup soup;
    enf_stress_truth truth;
    int32_t (*planes)[3]; ///< soup points: three corners of each face of a solid, counter-clockwise from its
                          ///< front
    size_t plane_count, plane_capacity;
    size_t *solid_plane; ///< first plane of each solid
    size_t solid_count, solid_capacity;
    double weld;    ///< to be compiled with; < 0: the default
    uint64_t state; ///< of the random numbers
    bool failed;    ///< out of memory: everything after does nothing
} enf_stress_case;

void enf_stress_case_free(enf_stress_case *made);

/// Random numbers: evenly in [low, high); a whole number in [0, count); mantissa in [1, 10) times 10^e for a
/// whole e in [low, high).
double enf_stress_uniform(enf_stress_case *made, double low, double high);
int enf_stress_whole(enf_stress_case *made, int count);
double enf_stress_magnitude(enf_stress_case *made, int low, int high);
double enf_stress_power_of_ten(int exponent);

/// A polygon of at most 16 corners with points of its own.
void enf_stress_add_polygon(enf_stress_case *made, int count, const double (*corners)[3]);

/// How the faces of a solid are made.
typedef enum enf_stress_faces {
    ENF_STRESS_WHOLE,  ///< convex polygons
    ENF_STRESS_CUT,    ///< triangles
    ENF_STRESS_STRIPS, ///< strips that meet other faces in T-junctions
} enf_stress_faces;

/// A solid of eight corners; bit a of a corner's number says whether it is at the high end of axis a. The
/// faces share their points, but for the T-junctions of strips.
void enf_stress_add_hexahedron(enf_stress_case *made, const double corners[8][3], enf_stress_faces faces);
void enf_stress_add_box(enf_stress_case *made, const double low[3], const double high[3],
                        enf_stress_faces faces);

/// A solid of four corners, positively oriented or not.
void enf_stress_add_tetrahedron(enf_stress_case *made, const double corners[4][3]);

/// Moves the points from number `first` on: turned about x, then y, then z (degrees), then scaled, then
/// moved.
typedef struct enf_stress_motion {
    double turn[3], scale, move[3];
} enf_stress_motion;
void enf_stress_move(enf_stress_case *made, size_t first, const enf_stress_motion *motion);

/// Any turn about all axes: from even ones, those by right angles, and those by next to nothing.
void enf_stress_choose_turn(enf_stress_case *made, double turn[3]);

/// Gives every corner of every polygon a point of its own, moved by at most `length` along each axis.
void enf_stress_tear(enf_stress_case *made, double length);

/// The bounding box of the finite points of at most 1e100. False if there is none.
bool enf_stress_bounds(const enf_stress_case *made, double low[3], double high[3]);

#endif
