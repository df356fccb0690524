// SPDX-License-Identifier: MIT
// The portals on a straight way: which are passed, and which ends it.
#ifndef ENF_RUN_WAY_H
#define ENF_RUN_WAY_H

#include "run/instance.h"
#include "run/segment.h"

typedef struct enf_way {
    const enf_file_view *view;
    const enf_instance *instance; ///< or null
    double from[3], to[3];        ///< world
    enf_segment segment;          ///< the same
    bool transforms_stop;         ///< what transforms is as good as closed
} enf_way;

/// The portals passed, as far as there is room for them.
typedef struct enf_passed {
    int32_t *portals; ///< or null
    int32_t capacity, count;
} enf_passed;

typedef enum enf_way_outcome {
    ENF_WAY_FREE, ///< nothing stopped it
    ENF_WAY_SHUT, ///< a portal that is closed there
    ENF_WAY_LED   ///< a portal that leads elsewhere; it is among those passed
} enf_way_outcome;

typedef struct enf_way_end {
    enf_way_outcome outcome;
    double share;        ///< where, of the segment
    int32_t portal;      ///< -1: none
    enf_passage passage; ///< of a portal that leads elsewhere
} enf_way_end;

#define ENF_WAY_WHOLE 2.0 ///< beyond all shares of a segment

/// Sets the ends. False if one is beyond the fine grid, or not finite.
bool enf_way_set(enf_way *way, const double from[3], const double to[3]);

typedef enum enf_way_look {
    ENF_WAY_CLEAR,   ///< the same as without an instance
    ENF_WAY_STOPPED, ///< by a portal between its ends
    ENF_WAY_UNCLEAR  ///< an end lies on a portal that is not as it was compiled, or one leads elsewhere
} enf_way_look;

/// What the portals that are not as they were compiled mean for the way, without the chain of cells. *portal:
/// the first that stops it, or -1.
enf_way_look enf_way_look_ahead(const enf_way *way, int32_t *portal);

/// Passes from *cell on, up to a share of the segment. A portal that is shut ends the way wherever it lies
/// between its ends. One that an end lies on, or that leads elsewhere, does so only as part of the chain of
/// cells: an end is on one side of a door, and twins lie in the same place.
/// *cell: the last one before the end. `goal`: the cell of the end if that is known, or -1.
enf_way_end enf_way_pass(const enf_way *way, double end, int32_t *cell, int32_t goal, enf_passed *passed);

/// The point at a share of the way.
void enf_way_point(const enf_way *way, double share, double point[3]);

/// In words: ENF_BAD_INPUT if the file has no sight part, ENF_BAD_USAGE if it is not loaded.
enf_status enf_fail_sight(const enf_world *world, enf_error *error);

#endif
