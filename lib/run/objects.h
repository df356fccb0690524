// SPDX-License-Identifier: MIT
// Objects, and the links between them and the lists that they are in.
#ifndef ENF_RUN_OBJECTS_H
#define ENF_RUN_OBJECTS_H

#include "enfilade/objects.h"

/// An object is in a list. Every object is in one at least, and link i is that of object i, so it always has
/// one; further links come from a pool.
typedef struct enf_link {
    int32_t object;
    int32_t list;           ///< a cell, or one of the two behind the cells; -1: not in use
    int32_t before, behind; ///< in the list, or -1; `behind` also leads through the pool
    int32_t next;           ///< of the same object, or -1
    int32_t reserved;
} enf_link;

typedef struct enf_object_slot {
    uint32_t generation;
    bool used;
    int32_t next_free;
    enf_shape shape;
    uint64_t user;
    int32_t cell, tetrahedron; ///< where the centre is
    int32_t last_link;         ///< the first one is the object's own
    int32_t link_count;
} enf_object_slot;

typedef struct enf_list {
    int32_t first, last;
} enf_list;

struct enf_objects {
    const enf_world *world;
    int32_t cell_count;
    enf_query *query; ///< for changes only
    int32_t objects_max, object_count, free_slot;
    enf_object_slot *slots;
    int32_t links_max, link_count, free_link; ///< of the pool
    enf_link *links;                          ///< objects_max, then links_max
    enf_list *lists;                          ///< cells, then nowhere, then everywhere
    int32_t outside_count[2];                 ///< objects in these two
};

/// The number of a list, or -1 if there is none.
static inline int32_t enf_objects_list(const enf_objects *objects, int32_t cell) {
    if (cell == ENF_LIST_NOWHERE || cell == ENF_LIST_EVERYWHERE) return objects->cell_count - 1 - cell;
    return cell >= 0 && cell < objects->cell_count ? cell : -1;
}

/// The number of an object, or -1 for a handle of none.
int32_t enf_objects_find(const enf_objects *objects, enf_object object);

#endif
