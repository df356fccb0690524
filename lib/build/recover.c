// SPDX-License-Identifier: GPL-3.0-or-later
// Turn first (turn.c), then flatten (flatten.c). The default tolerance is more than what single precision
// takes from a world around its origin: a coordinate is off by 2^-24 of itself, after a rotation by as much
// of the point's distance from the origin, and a third of the tolerance's square goes to each of three
// coordinates.
#include "build/recover.h"

#include "build/flatten.h"
#include "build/turn.h"

#include <math.h>
#include <string.h>

#define DEFAULT_WELD 1e-9 ///< of the diagonal of the bounding box
#define DEFAULT_PLANE_TOLERANCE 2e-7

/// The diagonal is taken in units of a power of two, so that no world is too large or too small.
void enf_tolerances_choose(enf_mesh *mesh, const enf_clean_options *options, const double *points,
                           size_t count) {
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, largest = 0, sum = 0;
    for (int a = 0; a < 3 && count; a++) {
        low[a] = high[a] = points[a];
        for (size_t i = 1; i < count; i++) {
            low[a] = fmin(low[a], points[3 * i + (size_t)a]);
            high[a] = fmax(high[a], points[3 * i + (size_t)a]);
        }
        largest = fmax(largest, high[a] - low[a]);
    }
    double unit = largest > 0 ? enf_power_of_two_above(largest) : 1;
    for (int a = 0; a < 3; a++) sum += (high[a] - low[a]) / unit * ((high[a] - low[a]) / unit);
    double diagonal = sqrt(sum) * unit;
    mesh->weld = options->weld < 0 ? DEFAULT_WELD * diagonal : options->weld;
    mesh->plane_tolerance =
        options->plane_tolerance < 0 ? DEFAULT_PLANE_TOLERANCE * diagonal : options->plane_tolerance;
}

const char *enf_turn_outcome_name(enf_turn_outcome outcome) {
    static const char *const names[] = {
        [ENF_TURN_OFF] = "off",   [ENF_TURN_ROUND] = "round", [ENF_TURN_ALIGNED] = "aligned",
        [ENF_TURN_NONE] = "none", [ENF_TURN_FOUND] = "found",
    };
    return names[outcome];
}

/// The frame of the points as they are now; see enf_turn.frame.
static void choose_frame(enf_frame *frame, const enf_turn *turn, const double *points, size_t count,
                         const enf_frame_rings *rings) {
    *frame = turn->frame;
    if (!turn->is_framed || turn->outcome == ENF_TURN_FOUND) enf_frame_choose(frame, points, count, rings);
    frame->is_turned = turn->outcome == ENF_TURN_FOUND;
    memcpy(frame->turn, turn->rows, sizeof turn->rows);
}

/// Along the canonical axes, because clusters depend on where they begin.
static enf_status flatten(enf_mesh *mesh, double *points, size_t count, const enf_frame_rings *rings,
                          double reach, enf_error *error) {
    enf_frame frame = mesh->frame;
    enf_flattening flattening;
    frame.step = 1;
    frame.is_turned = false;
    for (size_t i = 0; i < count; i++) enf_frame_to_grid(&frame, &points[3 * i], &points[3 * i]);
    enf_status status = enf_flatten(points, count, rings, reach, mesh->frame.is_turned, &flattening, error);
    for (size_t i = 0; i < count; i++) enf_frame_to_world(&frame, &points[3 * i], &points[3 * i]);
    mesh->flattened = flattening.moved;
    mesh->lattices = 0;
    for (int a = 0; a < 3; a++) mesh->lattices += flattening.lattice[a] > 0;
    return status;
}

enf_status enf_planes_recover(enf_mesh *mesh, double *points, size_t count, const enf_frame_rings *rings,
                              bool *changed, enf_error *error) {
    double reach = mesh->plane_tolerance / sqrt(3); // of one coordinate
    enf_turn turn;
    enf_status status = enf_turn_find(&turn, points, count, rings, reach, error);
    if (status != ENF_OK) return status;
    mesh->turn_outcome = turn.outcome;
    mesh->aligned = turn.aligned;
    choose_frame(&mesh->frame, &turn, points, count, rings);
    if (reach > 0) status = flatten(mesh, points, count, rings, reach, error);
    *changed = mesh->frame.is_turned || mesh->flattened;
    return status;
}
