// SPDX-License-Identifier: MIT
// Where a segment passes the common edge of several portals it meets all of them at once, and rounding tells
// nothing about their order. So a chain is searched for, depth first, in the order of the crossings; nearly
// always the first try is right.
#include "run/crossings.h"

#include "run/walk.h"

/// Crossings nearer together than this may come in any order.
static const double together = 1e-9;

enum { STEPS_MAX = 4 * ENF_CROSSINGS_MAX };

/// Keeps the list in order; the farthest falls off its end.
static void insert(enf_crossings *crossings, enf_crossing crossing) {
    enf_crossing *list = crossings->list;
    if (crossings->count == ENF_CROSSINGS_MAX) {
        double last = list[--crossings->count].share;
        crossings->end = last < crossings->end ? last : crossings->end;
        if (crossing.share >= last) return;
    }
    int32_t at = crossings->count++;
    for (; at > 0 && list[at - 1].share > crossing.share; at--) list[at] = list[at - 1];
    list[at] = crossing;
}

/// Where crossings fell off the list's end, those that belong together with them go, too.
static void end_between(enf_crossings *crossings) {
    int32_t count = crossings->count;
    while (count > 0 && crossings->list[count - 1].share > crossings->end - together) count--;
    if (count == 0) return; // too many to tell apart
    crossings->count = count;
    crossings->end = crossings->list[count - 1].share + together / 2;
}

void enf_crossings_find(enf_crossings *crossings, const enf_file_view *view, const enf_segment *segment,
                        double begin, double end) {
    crossings->count = 0;
    crossings->end = end;
    enf_walk walk;
    enf_walk_begin(&walk, view, segment, view->portal_nodes, view->portal_node_count);
    enf_walk_shorten(&walk, end);
    int32_t number;
    while ((number = enf_walk_next(&walk)) >= 0) {
        const enf_file_barrier *barrier = &view->barriers[number];
        enf_meeting meeting;
        if (barrier->kind != ENF_FILE_BARRIER_PORTAL) continue;
        if (!enf_segment_meets(view, segment, barrier, &meeting)) continue;
        if (meeting.share < begin || meeting.share >= crossings->end) continue;
        insert(crossings,
               (enf_crossing){meeting.share, barrier->index + !meeting.from_front, meeting.touches});
        enf_walk_shorten(&walk, crossings->end);
    }
    if (crossings->end < end) end_between(crossings);
}

typedef struct search {
    const enf_crossings *crossings;
    const enf_file_view *view;
    bool used[ENF_CROSSINGS_MAX];
    double slack;
} search;

/// The first crossing from `first` on that leads out of the cell, not before a share; -1: none.
static int32_t next_link(const search *search, int32_t first, int32_t cell, double share) {
    const enf_crossing *list = search->crossings->list;
    for (int32_t i = first; i < search->crossings->count; i++) {
        if (search->used[i] || list[i].share < share - search->slack) continue;
        if (search->view->portals[list[i].portal].from == cell) return i;
    }
    return -1;
}

static bool find_with(search *search, enf_chain *chain, int32_t start, int32_t goal) {
    const enf_crossing *list = search->crossings->list;
    int32_t first = 0;
    chain->count = 0;
    chain->cell = start;
    for (int32_t i = 0; i < search->crossings->count; i++) search->used[i] = false;
    for (int step = 0; step < STEPS_MAX; step++) {
        double share = chain->count ? list[chain->links[chain->count - 1]].share : 0;
        int32_t link = next_link(search, first, chain->cell, share);
        if (link >= 0) {
            search->used[link] = true;
            chain->links[chain->count++] = link;
            chain->cell = search->view->portals[list[link].portal].to;
            first = 0;
            continue;
        }
        if (goal < 0 || chain->cell == goal) return true;
        if (chain->count == 0) return false;
        link = chain->links[--chain->count]; // the next one instead
        search->used[link] = false;
        chain->cell = search->view->portals[list[link].portal].from;
        first = link + 1;
    }
    return false;
}

bool enf_chain_find(enf_chain *chain, const enf_crossings *crossings, const enf_file_view *view, int32_t cell,
                    int32_t goal) {
    search search = {.crossings = crossings, .view = view, .slack = together};
    if (find_with(&search, chain, cell, goal)) return true;
    search.slack = 2; // planes that the segment grazes: no order at all
    if (find_with(&search, chain, cell, goal)) return true;
    search.slack = together;
    return find_with(&search, chain, cell, -1) && goal < 0;
}
