// SPDX-License-Identifier: MIT
// What a traversal still has to look at, nearest first, and through which regions each cell was seen. A cell
// in a space is a place; each of its regions is a visit, which waits in the queue or has been looked at.
//
// A region that lies in one that the place has is done with. Otherwise it becomes a visit of its own, or
// joins one that waits, if the hull of the two is hardly larger than they are; when a place has regions_max
// visits it joins one of them in any case, which then waits again. After a few such times the visit becomes
// the whole screen, in which everything lies: so a place is looked at at most regions_max + 1 + growths_max
// times.
#ifndef ENF_RUN_VIEW_QUEUE_H
#define ENF_RUN_VIEW_QUEUE_H

#include "run/view_region.h"

typedef struct enf_view_visit {
    enf_view_region region;
    double nearest;
    int32_t place;
    int32_t next;   ///< visit of the same place; -1: last
    int32_t parent; ///< visit it was found from; -1: none
    int32_t portal; ///< by which; -1: none
    int32_t depth;
    int32_t waiting; ///< position in the queue; -1: looked at
    int32_t entry;   ///< in the order of being looked at first; -1: not yet
} enf_view_visit;

typedef struct enf_view_place {
    int32_t cell, space;
    int32_t first; ///< visit
    int32_t visit_count, growths;
    int32_t entry; ///< -1: not looked at yet
    bool is_whole; ///< the first visit has the whole screen
} enf_view_place;

typedef struct enf_view_slot {
    uint32_t run;
    int32_t place;
} enf_view_slot;

typedef struct enf_view_queue {
    int32_t capacity; ///< of visits, and of places
    int32_t edges_max, regions_max;
    bool rectangles;
    int32_t visit_count, place_count, waiting_count;
    enf_view_visit *visits;
    enf_view_place *places;
    int32_t *waiting;     ///< a binary heap of visits
    enf_view_slot *slots; ///< from cell and space to the place: a hash table
    uint32_t slot_mask, run;
    double (*corners)[2]; ///< edges_max for each visit
    enf_view_line *lines;
} enf_view_queue;

/// A region on its way to a cell.
typedef struct enf_view_arrival {
    enf_view_region *region;      ///< lines are drawn when they are needed
    const enf_view_region *outer; ///< which it was clipped to; or null
    double nearest;
    int32_t cell, space, parent, portal, depth;
} enf_view_arrival;

/// False without memory; what there is must be freed all the same.
bool enf_queue_create(enf_view_queue *queue, const enf_view_options *options);
void enf_queue_free(enf_view_queue *queue);

/// Forgets everything, in constant time.
void enf_queue_clear(enf_view_queue *queue);

/// False if there is no room for another place.
bool enf_queue_add(enf_view_queue *queue, const enf_view_arrival *arrival, enf_visible *visible);

/// The nearest visit that waits; -1: none.
int32_t enf_queue_take(enf_view_queue *queue);

/// The hull of two regions as corners; returns their number.
int32_t enf_view_hull(const enf_view_region *a, const enf_view_region *b, double (*corners)[2]);

#endif
