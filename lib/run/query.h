// SPDX-License-Identifier: MIT
// The flood through portals that queries and moving objects share, and its scratch memory.
#ifndef ENF_RUN_QUERY_H
#define ENF_RUN_QUERY_H

#include "enfilade/query.h"
#include "run/query_near.h"

struct enf_passage;

/// A cell reached, in the order in which the flood found it.
typedef struct enf_flooded {
    int32_t cell, portal, image;
    int32_t next; ///< another one of the same cell, or -1
} enf_flooded;

struct enf_query {
    const enf_file_view *view;
    const enf_world *world;
    double world_size; ///< the largest coordinate of the world
    uint32_t mark;     ///< of the latest use; what a cell has from an earlier one is void
    uint32_t *seen;    ///< per cell: mark
    int32_t *first;    ///< per cell: the number that goes with the mark; of a flood: the latest in `flooded`
    int32_t flooded_max, flooded_count;
    enf_flooded *flooded;
    int32_t images_max, image_count;
    enf_image *images;
    bool complete;
    uint32_t triangle_mark;
    uint32_t *triangle_seen; ///< per triangle; null: skipped
    enf_near_index near_index;
};

/// Voids what all cells have.
void enf_query_begin(enf_query *query);

/// True if the cell has been marked since the last begin.
static inline bool enf_query_has(const enf_query *query, int32_t cell) {
    return query->seen[cell] == query->mark;
}

static inline void enf_query_mark(enf_query *query, int32_t cell, int32_t number) {
    query->seen[cell] = query->mark;
    query->first[cell] = number;
}

/// Fills flooded, images and complete, from a cell or -1. The shape must be valid.
void enf_query_flood(enf_query *query, const enf_instance *instance, int32_t start, const enf_shape *shape);

/// Does a shape whose centre is on the side that the portal leads from reach into it?
bool enf_query_enters(const enf_query *query, const enf_shape *shape, int32_t portal,
                      const struct enf_passage *passage);

/// A distance that still counts as none where the shape is.
double enf_query_slack(const enf_query *query, const enf_shape *shape);

#endif
