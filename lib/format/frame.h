// SPDX-License-Identifier: MIT
// World coordinates to grid coordinates and back, as a world file's frame has it.
#ifndef ENF_FORMAT_FRAME_H
#define ENF_FORMAT_FRAME_H

#include "enfilade/format.h"

/// The world's point in the turned axes: itself where the world was not turned.
void enf_view_turn(const enf_file_view *view, const double world[3], double turned[3]);

/// Grid steps, not rounded.
void enf_view_to_grid(const enf_file_view *view, const double world[3], double grid[3]);
void enf_view_to_world(const enf_file_view *view, const double grid[3], double world[3]);

/// The same for directions: no step, so lengths stay.
void enf_view_direction_to_world(const enf_file_view *view, const double grid[3], double world[3]);

#endif
