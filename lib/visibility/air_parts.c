// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/air_parts.h"

#include "base/array.h"
#include "visibility/air_pieces.h"
#include "visibility/distinct.h"

#include <stdlib.h>
#include <string.h>

// ---------------------------------------------------------------------------------------------- order

/// Moves pieces into the order of one of their numbers, below `limit`; those with the same one stay in the
/// order that they are in. `first` has limit + 1 places.
static void order_by(const enf_air_piece *from, enf_air_piece *to, int32_t count, bool by_leaf, int32_t limit,
                     int32_t *first) {
    memset(first, 0, ((size_t)limit + 1) * sizeof *first);
    for (int32_t i = 0; i < count; i++) first[1 + (by_leaf ? from[i].leaf : from[i].cell)]++;
    for (int32_t k = 0; k < limit; k++) first[k + 1] += first[k];
    for (int32_t i = 0; i < count; i++) to[first[by_leaf ? from[i].leaf : from[i].cell]++] = from[i];
}

/// Leaf by leaf, and there cell by cell. False without memory.
static bool order(enf_air_pieces *all, int32_t leaf_count, int32_t cell_count) {
    const size_t limit = (size_t)(leaf_count > cell_count ? leaf_count : cell_count);
    enf_air_piece *scratch = enf_array_new((size_t)all->count, sizeof *scratch);
    int32_t *first = enf_array_new(limit + 1, sizeof *first);
    const bool good = scratch && first;
    if (good) {
        order_by(all->items, scratch, all->count, false, cell_count, first);
        order_by(scratch, all->items, all->count, true, leaf_count, first);
    }
    free(scratch);
    free(first);
    return good;
}

/// Drops the thin pieces of leafs that have no others: those are rock.
static void drop_thin(enf_air_pieces *all) {
    int32_t kept = 0;
    for (int32_t i = 0, end; i < all->count; i = end) {
        bool is_air = false;
        for (end = i; end < all->count && all->items[end].leaf == all->items[i].leaf; end++)
            is_air = is_air || !all->items[end].is_thin;
        for (int32_t k = i; is_air && k < end; k++) all->items[kept++] = all->items[k];
    }
    all->count = kept;
}

// ---------------------------------------------------------------------------------------------- parts

/// Parts on their way: the pieces of a cell in a leaf are one, and follow each other.
typedef struct joiner {
    const enf_air_pieces *all;
    enf_air_parts *air;
    int32_t *piece_first; ///< per part and one more: its first piece
} joiner;

static bool start(joiner *joiner, size_t leafs, size_t cells) {
    enf_bodies *parts = &joiner->air->bodies;
    const size_t pieces = (size_t)joiner->all->count;
    parts->owner_count = (int32_t)cells;
    parts->cell_first = enf_array_new(leafs + 1, sizeof *parts->cell_first);
    parts->owner = enf_array_new(pieces, sizeof *parts->owner);
    parts->corner_first = enf_array_new(pieces + 1, sizeof *parts->corner_first);
    joiner->air->leaf_of = enf_array_new(leafs, sizeof *joiner->air->leaf_of);
    joiner->piece_first = enf_array_new(pieces + 1, sizeof *joiner->piece_first);
    return joiner->air->leaf_of && parts->cell_first && parts->owner && parts->corner_first &&
           joiner->piece_first;
}

/// Numbers the leafs that are air, and lists the parts in them, with room for all corners of their pieces.
/// False if these can't be numbered.
static bool list_parts(joiner *joiner, int32_t leaf_count) {
    const enf_air_pieces *all = joiner->all;
    enf_air_parts *air = joiner->air;
    enf_bodies *parts = &air->bodies;
    int64_t corners = 0;
    for (int32_t leaf = 0, i = 0; leaf < leaf_count; leaf++) {
        const bool is_air = i < all->count && all->items[i].leaf == leaf;
        air->leaf_of[leaf] = is_air ? parts->cell_count++ : -1;
        if (is_air) parts->cell_first[air->leaf_of[leaf]] = parts->count;
        for (int32_t last = -1; i < all->count && all->items[i].leaf == leaf; i++) {
            const enf_air_piece *piece = &all->items[i];
            if (piece->cell != last) {
                parts->owner[parts->count] = last = piece->cell;
                parts->corner_first[parts->count] = (int32_t)corners;
                joiner->piece_first[parts->count++] = i;
            }
            corners += piece->count;
            if (corners > INT32_MAX) return false;
        }
    }
    parts->cell_first[parts->cell_count] = parts->count;
    parts->corner_first[parts->count] = (int32_t)corners;
    joiner->piece_first[parts->count] = all->count;
    return true;
}

static void fill_part(const void *user, int32_t part, double (*corners)[3]) {
    const joiner *joiner = user;
    for (int32_t i = joiner->piece_first[part]; i < joiner->piece_first[part + 1]; i++) {
        const enf_air_piece *piece = &joiner->all->items[i];
        memcpy(corners, enf_air_piece_corners(joiner->all, piece), (size_t)piece->count * sizeof *corners);
        corners += piece->count;
    }
}

/// Copies the corners, each once a part.
static bool fill_corners(const joiner *joiner, int threads) {
    enf_bodies *parts = &joiner->air->bodies;
    parts->corners = enf_array_new((size_t)parts->corner_first[parts->count], sizeof *parts->corners);
    return parts->corners && enf_distinct_keep_runs(&(enf_distinct_runs){.points = parts->corners,
                                                                         .first = parts->corner_first,
                                                                         .count = parts->count,
                                                                         .fill = fill_part,
                                                                         .user = joiner},
                                                    threads);
}

static bool list_lost(enf_air_parts *air) {
    const enf_bodies *parts = &air->bodies;
    air->lost = enf_array_new((size_t)parts->owner_count, sizeof *air->lost);
    bool *found = enf_array_zeroed((size_t)parts->owner_count, sizeof *found);
    const bool good = air->lost && found;
    for (int32_t i = 0; good && i < parts->count; i++) found[parts->owner[i]] = true;
    for (int32_t cell = 0; good && cell < parts->owner_count; cell++)
        if (!found[cell]) air->lost[air->lost_count++] = cell;
    free(found);
    return good;
}

static bool join_pieces(enf_air_parts *air, const enf_air_pieces *all, int32_t leaf_count, int32_t cell_count,
                        int threads) {
    joiner joiner = {.all = all, .air = air};
    const bool good = start(&joiner, (size_t)leaf_count, (size_t)cell_count) &&
                      list_parts(&joiner, leaf_count) && fill_corners(&joiner, threads) && list_lost(air);
    free(joiner.piece_first);
    return good;
}

enf_status enf_air_parts_make(enf_air_parts *air, const enf_air_tree *tree, const enf_file_view *view,
                              int threads, enf_error *error) {
    enf_air_pieces all;
    *air = (enf_air_parts){0};
    bool good =
        enf_air_pieces_make(&all, tree, view, threads) && order(&all, tree->leaf_count, view->cell_count);
    if (good) {
        drop_thin(&all);
        good = join_pieces(air, &all, tree->leaf_count, view->cell_count, threads);
    }
    enf_air_pieces_free(&all);
    good = good && enf_bodies_finish(&air->bodies, threads);
    return good ? ENF_OK : enf_fail_memory(error, "the parts of cells");
}

void enf_air_parts_free(enf_air_parts *air) {
    enf_bodies_free(&air->bodies);
    free(air->leaf_of);
    free(air->lost);
    *air = (enf_air_parts){0};
}
