// SPDX-License-Identifier: MIT
// Streaming: which cells' geometry will be wanted soon, and telling the system so. A world file is mapped,
// not read: what is drawn comes from disk when it is first touched. To have it there before it is seen, ask
// for the cells that a viewer may see within the next seconds and advise the system of them, and of those
// that are not wanted any more.
//
// The guess: the viewer keeps its speed but may turn, which takes time. It can see what the visible set (PVS)
// of each cell holds that it may have come to by then; T. A. Funkhouser, C. H. Sequin, S. J. Teller,
// "Management of large amounts of data in interactive building walkthroughs", 1992.
#ifndef ENFILADE_PREFETCH_H
#define ENFILADE_PREFETCH_H

#include "enfilade/run.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Scratch memory of one thread.
typedef struct enf_prefetch enf_prefetch;

/// The world must stay open as long as it lives. Takes 45 bytes for each cell. ENF_NO_RESOURCES without
/// memory.
ENF_API enf_status enf_prefetch_create(enf_prefetch **prefetch, const enf_world *world, enf_error *error);

/// Null is fine.
ENF_API void enf_prefetch_free(enf_prefetch *prefetch);

/// A cell whose geometry is wanted.
typedef struct enf_wanted {
    int32_t cell;
    double seconds; ///< from now until it may be seen, as far as can be guessed; 0: it may be seen already
} enf_wanted;

/// Lists the cells that a viewer at `point` in `cell` may see within `seconds`, the most urgent first;
/// equally urgent ones by the distance of their box, then by number. `velocity`: world units per second; the
/// time to get to a portal is what the straight way takes at this speed if it lies ahead, twice that if it
/// lies abreast, four times if it lies behind. A viewer that stands still stays. Doors count as open, and
/// portals lead where they were compiled to.
///
/// Without a visible set, a cell is taken to see itself and its neighbours.
///
/// At most `capacity` cells are written to `out`, which may be null if that is 0. Returns how many there are;
/// 0 for a cell that the world does not have, or numbers that are not finite. Takes no memory.
ENF_API int32_t enf_prefetch_list(enf_prefetch *prefetch, int32_t cell, const double point[3],
                                  const double velocity[3], double seconds, enf_wanted *out,
                                  int32_t capacity);

/// Tells the system that a cell's triangles, with their points, normals and texture coordinates, will be
/// needed soon, or not any more. Changes nothing but where they lie: whoever touches them later gets them all
/// the same. Pages that other cells share go, too. Does nothing for a world that was opened in memory or
/// whose triangles are not loaded, and for a cell that the world does not have. Reads the cell's triangles,
/// so it may wait for the disk: call it in a thread that may. Any number of threads may call it.
ENF_API void enf_world_advise_cell(const enf_world *world, int32_t cell, bool needed);

#ifdef __cplusplus
}
#endif
#endif
