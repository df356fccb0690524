// SPDX-License-Identifier: MIT
// The triangles near a shape, by the tree of walls that lines of sight use. In cells of many triangles that
// is faster than to look at each.
#ifndef ENF_RUN_QUERY_NEAR_H
#define ENF_RUN_QUERY_NEAR_H

#include "enfilade/query.h"

#define ENF_NEAR_MAX 256
#define ENF_LOOSE_MAX 64

/// What the tree knows.
typedef struct enf_near_index {
    bool is_complete; ///< all triangles of cells are in the tree, or loose
    int32_t loose_count;
    int32_t loose[ENF_LOOSE_MAX]; ///< triangles of cells that are not in the tree
} enf_near_index;

/// `marks`: zeros, one per triangle; left as zeros.
void enf_near_prepare(enf_near_index *index, const enf_file_view *view, uint32_t *marks);

/// Of a query about one shape.
typedef struct enf_near {
    bool is_known; ///< false: the tree does not help
    int32_t count;
    int32_t list[ENF_NEAR_MAX]; ///< ascending; one may be named twice
} enf_near;

/// All triangles of cells whose boxes come as near to the shape as the slack, and others that come near.
void enf_near_find(enf_near *near, const enf_near_index *index, const enf_file_view *view,
                   const enf_shape *shape, double slack);

/// Does a triangle's box come as near to the shape's as the slack?
bool enf_near_has_box(const enf_file_view *view, const enf_shape *shape, int32_t triangle, double slack);

#endif
