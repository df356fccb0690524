// SPDX-License-Identifier: MIT
#include "format/frame.h"

void enf_view_turn(const enf_file_view *view, const double world[3], double turned[3]) {
    double at[3] = {world[0], world[1], world[2]};
    for (int a = 0; a < 3; a++) {
        turned[a] = at[a];
        if (!view->turn) continue;
        const double *row = view->turn->rows[a];
        turned[a] = row[0] * at[0] + row[1] * at[1] + row[2] * at[2];
    }
}

void enf_view_to_grid(const enf_file_view *view, const double world[3], double grid[3]) {
    const enf_file_frame *frame = view->frame;
    double turned[3] = {world[0], world[1], world[2]};
    if (view->turn) enf_view_turn(view, world, turned);
    grid[0] = frame->sign[0] * turned[frame->axis[0]] / frame->step;
    grid[1] = frame->sign[1] * turned[frame->axis[1]] / frame->step;
    grid[2] = frame->sign[2] * turned[frame->axis[2]] / frame->step;
}

void enf_view_direction_to_world(const enf_file_view *view, const double grid[3], double world[3]) {
    const enf_file_frame *frame = view->frame;
    double turned[3];
    for (int a = 0; a < 3; a++) turned[frame->axis[a]] = frame->sign[a] * grid[a];
    for (int a = 0; a < 3; a++) {
        world[a] = turned[a];
        if (!view->turn) continue;
        const double(*rows)[3] = view->turn->rows;
        world[a] = rows[0][a] * turned[0] + rows[1][a] * turned[1] + rows[2][a] * turned[2];
    }
}

void enf_view_to_world(const enf_file_view *view, const double grid[3], double world[3]) {
    enf_view_direction_to_world(view, grid, world);
    for (int a = 0; a < 3; a++) world[a] *= view->frame->step;
}
