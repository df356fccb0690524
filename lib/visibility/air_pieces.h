// SPDX-License-Identifier: GPL-3.0-or-later
// The fine cells of a world, cut along the tree of its air.
#ifndef ENF_VISIBILITY_AIR_PIECES_H
#define ENF_VISIBILITY_AIR_PIECES_H

#include "visibility/air_tree.h"

/// What a fine cell leaves of itself in a leaf: a convex body.
typedef struct enf_air_piece {
    int32_t leaf, cell;
    int32_t share;        ///< whose corners
    int32_t first, count; ///< corners
    bool is_thin;         ///< lies within the tolerance of a plane on the way: it does not say what is air
} enf_air_piece;

/// Fine cells are cut in so many shares, however many threads there are.
enum { ENF_AIR_SHARES = 64 };

typedef struct enf_air_pieces {
    enf_air_piece *items; ///< in the order of their fine cells
    int32_t count;
    size_t capacity;
    double (*corners[ENF_AIR_SHARES])[3]; ///< world
} enf_air_pieces;

/// Cuts the fine cells of kept regions along the tree, on some threads: what comes out is the same for any
/// number. Needs the exact part of the file. *all is overwritten; free it in any case. False without memory.
bool enf_air_pieces_make(enf_air_pieces *all, const enf_air_tree *tree, const enf_file_view *view,
                         int threads);
void enf_air_pieces_free(enf_air_pieces *all);

static inline const double (*enf_air_piece_corners(const enf_air_pieces *all,
                                                   const enf_air_piece *piece))[3] {
    return (const double(*)[3])(all->corners[piece->share] + piece->first);
}

#endif
