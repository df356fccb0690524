// SPDX-License-Identifier: MIT
// Sound through portals: which ways a sound takes from its source to a listener, how long they are, where
// they seem to come from, and what portals leave of it.
//
// The model is that of R. Foale and P. Vamplew, "Portal-based sound propagation for first-person computer
// games", 4th Australasian Conference on Interactive Entertainment, 2007: sound goes straight inside a cell
// and bends at portals; the listener hears it from the portal that it comes in by. Walls let nothing through,
// and nothing is reflected. The ways are searched on the graph of path.h, from middle to middle of portals,
// then each is pulled tight like the line of a path; lengths and directions are those of the pulled line.
//
// Each portal multiplies the sound by a factor of the caller's. To weigh factors against lengths, the caller
// says how far sound goes until it has faded by a factor of e (2.7; 8.7 dB): the *cost* of a way is its
// length plus that length times -ln(all factors). So the sound that is left is exp(-cost / fade_length), and
// the way with the least cost is the loudest.
//
// Threads and memory: as for paths (path.h); the finder is the same.
#ifndef ENFILADE_SOUND_H
#define ENFILADE_SOUND_H

#include "enfilade/path.h"

#ifdef __cplusplus
extern "C" {
#endif

/// The factor of a portal; one with its twin has one factor. Values above 1 count as 1; 0, less and what is
/// no number: nothing passes. Called several times a query; must give the same answer each time.
typedef double enf_sound_factor(void *user, int32_t portal);

/// All zero but `size`, the cells, the points and `range` is the default.
typedef struct enf_sound_query {
    size_t size;                        ///< sizeof(enf_sound_query)
    int32_t source_cell, listener_cell; ///< -1: the cell of the point, which is then searched for
    double source[3], listener[3];      ///< world
    double range;          ///< the most that a way may cost before it is pulled, world units; may be infinite
    double fade_length;    ///< world units; 0: factors are told but cost nothing
    const double *factors; ///< per pair of portals (portal / 2), or null
    enf_sound_factor *factor; ///< asked if there are no `factors`; null: 1
    void *user;               ///< for `factor`
    double door_factor;       ///< a closed door multiplies by this, too; 0: nothing passes
    int32_t *portals;         ///< room for the portals of all ways, or null
    int32_t portal_capacity;
} enf_sound_query;

/// A way that sound takes.
typedef struct enf_sound_path {
    double length;        ///< of the pulled line, world units
    double factor;        ///< of all portals and closed doors together
    double cost;          ///< length - fade_length * ln(factor)
    double direction[3];  ///< where it seems to come from, for the listener: 1 long; 0 if it is where the
                          ///< listener is
    double point[3];      ///< where it comes into the listener's cell; in the same cell: the source
    int32_t portal;       ///< by which it comes in; -1: in the same cell
    int32_t portal_count; ///< portals passed
    int32_t portal_first; ///< in the query's `portals`, from the source on; -1: they did not fit
} enf_sound_path;

typedef struct enf_sound {
    int32_t count;    ///< ways written
    bool is_complete; ///< false: the finder's sound_steps_max ended the search; there may be other ways
} enf_sound;

/// Finds the `capacity` best ways of sound within the range, none of which passes a cell twice, and writes
/// them by rising cost. They are the best before they are pulled (exactly: the search goes back from the
/// listener, by the costs of a search from the source, so it meets ways in their order). Doors that are
/// partly open let all sound through; portals that transform lead on in their target cell, at no cost of
/// their own.
///
/// ENF_BAD_USAGE: a cell that the world does not have, a point that is not finite, a range or fade length
/// that is negative or no number. Nothing is heard from or in no cell.
ENF_API enf_status enf_sound_find(enf_path_finder *finder, const enf_instance *instance,
                                  const enf_sound_query *query, enf_sound_path *out, int32_t capacity,
                                  enf_sound *sound, enf_error *error);

#ifdef __cplusplus
}
#endif
#endif
