// SPDX-License-Identifier: GPL-3.0-or-later
// Floor plans of a world: how many storeys it has, and what a horizontal cut through each one meets. For
// looking at: everything here is floating point and decides nothing about the world.
#ifndef ENF_BUILD_PLAN_H
#define ENF_BUILD_PLAN_H

#include "enfilade/format.h"

enum { ENF_STOREYS_MAX = 12 };
enum { ENF_PLAN_WALL = -1, ENF_PLAN_FLOOR = -2 };

/// Where a cut meets a fine cell: a convex polygon, counter-clockwise on the page (y up).
typedef struct enf_plan_area {
    int32_t cell, corner_first, corner_count;
} enf_plan_area;

typedef struct enf_plan_line {
    double from[2], to[2];
    int32_t portal; ///< the even portal that the cut meets here; ENF_PLAN_WALL; ENF_PLAN_FLOOR: the rim of a
                    ///< floor (or table, or step) below the cut
} enf_plan_line;

typedef struct enf_storey {
    double height; ///< of the cut, along the up axis
    int32_t area_count;
    enf_plan_area *areas; ///< ascending cells
    double (*corners)[2];
    int32_t line_count;
    enf_plan_line *lines;
    size_t area_capacity, corner_count, corner_capacity, line_capacity;
} enf_storey;

typedef struct enf_plan {
    int right, ahead, up;   ///< world axes
    double ahead_sign;      ///< page x = world[right], page y = ahead_sign * world[ahead]
    double low[2], high[2]; ///< page box of all cells
    int storey_count;
    enf_storey storeys[ENF_STOREYS_MAX]; ///< from the lowest to the highest
} enf_plan;

void enf_plan_free(enf_plan *plan);

/// `up`: 0, 1 or 2. ENF_BAD_INPUT if the file lacks the exact part. Free the plan in any case.
enf_status enf_plan_make(enf_plan *plan, const enf_file_view *view, int up, enf_error *error);

/// A world point on the page; returns its height.
double enf_plan_project(const enf_plan *plan, const double world[3], double page[2]);

/// Heights of the cuts, ascending, at most ENF_STOREYS_MAX. Every floor that a kept cell sees wants a cut
/// between it and what is above it; the next cut is always the one that serves the largest area of floor not
/// yet served. Returns how many, at least 1; 0 without memory.
int enf_storeys_find(const enf_plan *plan, const enf_file_view *view, double heights[ENF_STOREYS_MAX]);

/// Adds the rims of the floors below each storey's cut, down to the cut below. False without memory.
bool enf_storeys_outline(enf_plan *plan, const enf_file_view *view);

/// Adds a line to a storey. False without memory.
bool enf_plan_add_line(enf_storey *storey, const double from[2], const double to[2], int32_t portal);

/// Grid to world.
void enf_plan_grid_to_world(const enf_file_view *view, const double grid[3], double world[3]);

#endif
