// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of stabbing share. Vectors act on x = (direction, moment) as e = (moment, direction), so
// that both are met by the plain inner product in R^6.
#ifndef ENF_VISIBILITY_STAB_PARTS_H
#define ENF_VISIBILITY_STAB_PARTS_H

#include "visibility/min_norm.h"
#include "visibility/stab.h"
#include "visibility/stab_quadric.h"

/// A side that is no edge of a portal. Two corners: the line has to pass the way from the first to the second
/// like an edge. Six: two triangles whose planes it rises through; it has to come to the first one before the
/// second, which is on which side it passes the line that the planes have in common.
typedef struct enf_stab_side {
    const double *corner[6];
    int count;
    int32_t place; ///< whose order it is for: the second portal's place in the sequence
} enf_stab_side;

struct enf_stabber {
    const enf_pluecker *pluecker;
    enf_stab_counts counts;

    // The sequence at hand.
    const int32_t *sequence;
    int32_t count;
    double origin[3]; ///< a corner: coordinates below are as seen from it
    double scale;     ///< a power of two: times it, no coordinate is above 1
    bool rough;       ///< the doubles below say nothing
    int unit;         ///< all corners are multiples of 2^unit

    enf_stab_side *sides; ///< to be passed as well as the edges; with them, nothing is left to doubles
    int32_t side_count;
    size_t side_capacity;

    int32_t edge_count, capacity; ///< edges, then sides
    int32_t *sources;             ///< 2 * edge of the openings, + 1 if turned round; of side k, -1 - k
    double *vectors;              ///< in columns, capacity apart, with room for one more than edge_count
    double *products;
    enf_min_norm hull;

    // Whole numbers: (a - origin) x (b - a) and b - a in units.
    enf_whole_vector *whole; ///< whole_count of them are initialised; valid if whole_ready
    int32_t whole_count;
    bool whole_ready;
    int32_t *order;
    enf_whole_vector point; ///< a solution of the whole-number program
    bool point_is_whole;    ///< the solution is `point`, not hull.x
    enf_quadric quadric;
    bool has_meeting; ///< `point` and the quadric's witness, in the closed cone, have a line between them
    char *long_line;
};

/// Each computed vector, about as long as 1, is off by less than 2^-48: a few roundings of coordinates
/// below 1. Inner products with x are off by less than ENF_STAB_MARGIN * |x|, their own roundings included.
#define ENF_STAB_ERROR 0x1p-48
#define ENF_STAB_MARGIN 0x1p-47

// ---- stab_edges.c
/// Collects the edges of the sequence; false without memory.
bool enf_stabber_take(enf_stabber *stabber, const int32_t *sequence, int32_t count);
/// Edge vector k in whole numbers, into six initialised numbers. A side's may be any multiple > 0 of it.
void enf_stabber_whole_edge(const enf_stabber *stabber, int32_t k, mpz_t *vector);
/// All of them, into stabber->whole; false without memory.
bool enf_stabber_whole_edges(enf_stabber *stabber);

// ---- stab_sides.c
/// The vector of a side in whole numbers, into six initialised numbers: 0 if triangles lie in one plane, or
/// in none.
void enf_stabber_whole_side(const enf_stabber *stabber, const enf_stab_side *side, mpz_t *vector);

/// stabber->order: the members of the hull, then the tightest edges at hull.x first. False without memory.
bool enf_stabber_order(enf_stabber *stabber);

// ---- stab_certificate.c
/// Do the members of the hull hold 0, whatever was rounded? False if doubles cannot tell.
bool enf_stabber_zero_by_double(const enf_stabber *stabber);
/// The members of the hull that are needed: what weighs next to nothing is there by rounding. Returns how
/// many.
int enf_stabber_members(const enf_stabber *stabber, int32_t members[ENF_HULL_MAX]);
/// Does a combination of the members with weights >= 0 give 0? Exact, but false as well if there are two
/// such.
bool enf_stabber_zero_by_whole(const enf_stabber *stabber, const int32_t *members, int count);

// ---- stab_small.c
/// The same in 64 bits; false as well if these are too few.
bool enf_stabber_zero_by_small(const enf_stabber *stabber, const int32_t *members, int count);

// ---- stab_program.c
/// Exactly: is 0 in the hull of all edges? If not, stabber->point is a strict solution. Edges are looked at
/// in stabber->order.
bool enf_stabber_program(enf_stabber *stabber);

// ---- stab_line.c
/// The line of x (which need not lie on the quadric: next to it), or false if there is none worth trying.
bool enf_stabber_line(const enf_stabber *stabber, const double x[ENF_PLUECKER], enf_line *line);
/// x of the line.
void enf_stabber_coordinates(const enf_stabber *stabber, const enf_line *line, double x[ENF_PLUECKER]);
/// A line that may pass: from the first portal's middle to the last one's.
enf_line enf_stabber_guess(const enf_stabber *stabber);
/// Searches from the strict solution hull.x for a line that passes all portals.
bool enf_stabber_search(enf_stabber *stabber, enf_line *line);
/// Does it pass all portals, and all sides? Exact.
bool enf_stabber_passes(const enf_stabber *stabber, const enf_line *line);

// ---- stab_cone.c
/// Exactly, from the strict solution: does the open cone meet the quadric? Leaves in hull.x something next to
/// where it does; has_meeting, unless that was not decided.
enf_status enf_stabber_quadric(enf_stabber *stabber, bool *meets, enf_error *error);

// ---- stab_long.c
/// Does it pass all edges and sides? Exact; the whole vectors must be there.
bool enf_stabber_passes_wholly(const enf_stabber *stabber, const enf_line *line);

// ---- stab_refine.c
/// From the meeting of cone and quadric to the line of *stab: between doubles, or else a long one.
enf_status enf_stabber_refine(enf_stabber *stabber, enf_stab *stab, enf_error *error);

#endif
