// SPDX-License-Identifier: MIT
// Streaming: which cells' geometry will be wanted soon, and having just that in memory. A world file is
// mapped, not read: what is drawn comes from disk when it is first touched, and stays. To have it there
// before it is seen, ask for the cells that a viewer may see within the next seconds and load them; and drop
// those that are not wanted any more.
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

/// Which cells' geometry is loaded. Belongs to one thread at a time.
typedef struct enf_stream enf_stream;

/// Drops the geometry of all cells. If the triangles of a world were not loaded yet, they are checked first,
/// all of them once. The world must stay open as long as the stream lives, and should have no other. Takes a
/// byte for each cell and 4 for each page of the file. ENF_NO_RESOURCES without memory.
ENF_API enf_status enf_stream_create(enf_stream **stream, const enf_world *world, enf_error *error);

/// Null is fine. Drops nothing.
ENF_API void enf_stream_free(enf_stream *stream);

/// Tells the system to read a cell's triangles, with their points, normals and texture coordinates, from disk
/// ahead of their use. False if nothing was to do: the cell is loaded already, or the world does not have it.
ENF_API bool enf_stream_load(enf_stream *stream, int32_t cell);

/// Gives the memory of a cell's geometry back, but for pages (of 4 KiB, mostly) that a loaded cell uses, too.
/// They are no longer the process's; what the system keeps of the file while it has room is its own. False
/// as above.
///
/// Neither changes what is read: whoever touches geometry that is not loaded gets it all the same, and waits
/// for the disk. Both read the cell's triangles, so they may wait themselves: call them in a thread that may.
/// Of a world that was opened in memory nothing is dropped, as nothing would bring it back.
ENF_API bool enf_stream_drop(enf_stream *stream, int32_t cell);

#ifdef __cplusplus
}
#endif
#endif
