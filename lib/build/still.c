// SPDX-License-Identifier: GPL-3.0-or-later
// Most facets of a finely drawn world are of this kind. Where each will stand is known beforehand (count,
// prefix sum, fill), so threads fill in blocks of them at the same time.
#include "build/still.h"

#include "base/array.h"
#include "base/fetch.h"
#include "build/subdivision.h"

#include <stdlib.h>

enum { BLOCK = 1 << 14 }; ///< facets a job

/// Where a block of the tetrahedra's facets begins in the complex.
typedef struct place {
    int32_t facet, cover;
    int32_t others; ///< hits on facets that are in parts, but for the first on each
} place;

typedef struct still {
    const enf_arrangement *arrangement;
    const uint8_t *marked;
    enf_complex *complex;
    place *places; ///< per block, and one more
} still;

static int32_t block_end(const still *all, int32_t block) {
    int32_t begin = block * BLOCK, left = all->arrangement->tets.facet_count - begin;
    return begin + (left < BLOCK ? left : BLOCK);
}

static void count_block(void *user, int32_t block, int thread) {
    (void)thread;
    still *all = user;
    const int32_t *hit_first = all->arrangement->hit_first;
    place count = {0}; // here: threads that write close to each other wait for each other
    for (int32_t f = block * BLOCK; f < block_end(all, block); f++) {
        int32_t hits = hit_first[f + 1] - hit_first[f];
        if (all->marked[f]) {
            count.others += hits > 1 ? hits - 1 : 0;
        } else {
            count.facet++;
            count.cover += hits;
        }
    }
    all->places[block + 1] = count;
}

/// The polygons on a facet, from this cover on. Returns the cover after them.
static int32_t fill_covers(const still *all, int32_t source, int32_t cover) {
    const enf_arrangement *arrangement = all->arrangement;
    enf_complex *complex = all->complex;
    for (int32_t i = arrangement->hit_first[source]; i < arrangement->hit_first[source + 1]; i++, cover++) {
        int32_t polygon = arrangement->hits[i].polygon, own = arrangement->polygon_plane[polygon];
        bool opposite = !enf_geometry_same_way(&arrangement->geometry, own, source);
        complex->cover_polygon[cover] = polygon;
        complex->cover_side[cover] = opposite == arrangement->polygon_flipped[polygon];
        complex->covers.offset[cover] = 0;
    }
    return cover;
}

/// Facet number `added`, which has this piece and the covers from `cover` on. Returns the cover after them.
static int32_t fill_facet(const still *all, int32_t source, int32_t added, int32_t cover) {
    enf_complex *complex = all->complex;
    int32_t corner[3], edge_plane[3];
    enf_subdivision_triangle(&all->arrangement->tets, source, corner, edge_plane);
    for (int i = 0; i < 3; i++) {
        complex->facets.corners[3 * (size_t)added + (size_t)i] =
            (enf_corner){corner[(i + 1) % 3], edge_plane[(i + 1) % 3]};
    }
    complex->facets.offset[added] = 3 * added;
    complex->facet_plane[added] = source;
    for (int side = 0; side < 2; side++)
        complex->facet_cell[added][side] = all->arrangement->tets.facet_sides[source][side];
    int32_t after = fill_covers(all, source, cover);
    complex->facet_cover[added] = cover;
    complex->facet_piece[added] = added;
    complex->pieces.offset[added] = 0;
    complex->piece_facet[added] = added;
    complex->piece_cover[added] = cover < after ? cover : ENF_PIECE_OPEN;
    return after;
}

enum { AHEAD = 16 }; ///< facets

/// What fill_facet will read.
static void fetch_facet(const enf_tet_mesh *tets, int32_t facet) {
    const int32_t *sides = tets->facet_sides[facet], t = sides[0] >= 0 ? sides[0] : sides[1];
    enf_fetch(tets->corners[t]);
    enf_fetch(tets->facets[t]);
}

static void fill_block(void *user, int32_t block, int thread) {
    (void)thread;
    still *all = user;
    place at = all->places[block];
    const int32_t end = block_end(all, block);
    for (int32_t f = block * BLOCK; f < end; f++) {
        if (f + AHEAD < end) fetch_facet(&all->arrangement->tets, f + AHEAD);
        if (!all->marked[f]) at.cover = fill_facet(all, f, at.facet++, at.cover);
    }
}

/// From numbers per block to places.
static void add_up(place *places, int32_t blocks) {
    for (int32_t b = 0; b < blocks; b++) {
        places[b + 1].facet += places[b].facet;
        places[b + 1].cover += places[b].cover;
        places[b + 1].others += places[b].others;
    }
}

/// Counts, and the ends of offsets.
static void set_counts(enf_yield *yield, place end) {
    enf_complex *complex = &yield->complex;
    yield->still_count = complex->facet_count = complex->facets.count = complex->pieces.count = end.facet;
    complex->facets.corner_count = 3 * (size_t)end.facet;
    complex->covers.count = end.cover;
    complex->facets.offset[end.facet] = 3 * end.facet;
    complex->covers.offset[end.cover] = complex->pieces.offset[end.facet] = 0;
    complex->facet_cover[end.facet] = end.cover;
    complex->facet_piece[end.facet] = end.facet;
}

/// The parts' own facets follow: of each that is in a part there will be at least one, and cuts make more. As
/// many as are usual: arrays that grow are copied, and what nothing is written to takes memory all the same
/// where pages are large. For one that may cut, up to 1.6 facets, 6.3 corners and 1.2 covers were seen; for
/// each polygon that shares a facet with others a piece, unless most are cuts.
static bool reserve(enf_yield *yield, const enf_parts *parts, const enf_arrangement *arrangement, place end) {
    size_t own = (size_t)parts->facet_first[parts->count], cuts = 0;
    for (int32_t i = 0; i < parts->count; i++) cuts += parts->cuts[i];
    size_t facets = (size_t)end.facet + own, made = cuts + cuts * 3 / 4;
    size_t others = (size_t)end.others > made ? (size_t)end.others : 0;
    size_t hits = (size_t)arrangement->hit_first[arrangement->tets.facet_count];
    return enf_yield_reserve(yield, facets + made, 3 * facets + 6 * cuts + cuts / 2, hits + cuts + cuts / 5,
                             facets + made + others);
}

bool enf_still_emit(enf_yield *yield, const enf_arrangement *arrangement, const enf_parts *parts,
                    int threads) {
    const enf_crew crew = {.threads = threads};
    int32_t facets = arrangement->tets.facet_count, blocks = facets / BLOCK + 1;
    still all = {.arrangement = arrangement, .marked = parts->marked, .complex = &yield->complex};
    all.places = enf_array_zeroed((size_t)blocks + 1, sizeof *all.places);
    if (!all.places) return false;
    enf_parallel_for(&crew, blocks, count_block, &all);
    add_up(all.places, blocks);
    place end = all.places[blocks];
    bool good = reserve(yield, parts, arrangement, end);
    if (good) {
        enf_parallel_for(&crew, blocks, fill_block, &all);
        set_counts(yield, end);
    }
    free(all.places);
    return good;
}
