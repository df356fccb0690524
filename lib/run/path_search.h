// SPDX-License-Identifier: MIT
// Searches on the graph of paths.
#ifndef ENF_RUN_PATH_SEARCH_H
#define ENF_RUN_PATH_SEARCH_H

#include "run/instance.h"
#include "run/path_graph.h"
#include "run/path_heap.h"
#include "run/path_table.h"

/// Scratch memory; costs are those of the latest search.
typedef struct enf_path_search {
    const enf_paths *paths;
    enf_path_heap heap;
    int64_t *cost;   ///< per portal: up to its point
    int32_t *via;    ///< per portal: by which portal it was reached (see path_search.c)
    uint32_t *stamp; ///< per portal: the search that reached it
    uint32_t now;
    int32_t *route; ///< room for a path
} enf_path_search;

bool enf_path_search_make(enf_path_search *search, const enf_paths *paths);
void enf_path_search_free(enf_path_search *search);

/// Forgets the costs.
void enf_path_search_begin(enf_path_search *search);

/// Was a portal reached?
static inline bool enf_path_is_reached(const enf_path_search *search, int32_t portal) {
    return search->stamp[portal] == search->now;
}

/// Takes a cost for a portal if it is less than what is known; the key is what the heap sorts by. True: it
/// was.
bool enf_path_search_reach(enf_path_search *search, int32_t portal, int64_t cost, int64_t key);

/// The shortest path between ends in different cells. Writes its portals to search->route and returns how
/// many they are; 0: there is no way. *length in units.
int32_t enf_path_search_run(enf_path_search *search, const enf_instance *instance, const enf_path_goal *start,
                            const enf_path_goal *goal, int64_t *length);

#endif
