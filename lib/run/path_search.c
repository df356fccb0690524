// SPDX-License-Identifier: MIT
// A* on chains: P. E. Hart, N. J. Nilsson, B. Raphael, "A formal basis for the heuristic determination of
// minimum cost paths", IEEE Transactions on Systems Science and Cybernetics 4 (1968). A node is a chain, its
// cost that of the chain's first portal. The bound is the straight length, or what landmarks say if that is
// more (path_landmarks.h). The search goes from the goal back to the start, so that of equally
// short paths the one whose first portal has the lowest number wins, then the second, and so on.
//
// Portals that transform have a direction and make the straight length no bound: with such, the search goes
// forward, portal by portal, without a bound.
#include "run/path_search.h"

#include "base/array.h"
#include "run/vector.h"

#include <stdlib.h>
#include <string.h>

enum { FROM_START = -1 }; // via: from the start; below: the start lies in a chain, portal -2 - via came first

bool enf_path_search_make(enf_path_search *search, const enf_paths *paths) {
    size_t count = (size_t)paths->view->portal_count;
    *search = (enf_path_search){.paths = paths};
    bool good = enf_path_heap_make(&search->heap, paths->view->portal_count);
    search->cost = enf_array_new(count, sizeof *search->cost);
    search->via = enf_array_new(count, sizeof *search->via);
    search->stamp = enf_array_zeroed(count, sizeof *search->stamp);
    search->route = enf_array_new(count, sizeof *search->route);
    return good && search->cost && search->via && search->stamp && search->route;
}

void enf_path_search_free(enf_path_search *search) {
    enf_path_heap_free(&search->heap);
    free(search->cost);
    free(search->via);
    free(search->stamp);
    free(search->route);
}

void enf_path_search_begin(enf_path_search *search) {
    search->heap.count = 0;
    if (++search->now != 0) return;
    memset(search->stamp, 0, (size_t)search->paths->view->portal_count * sizeof *search->stamp);
    search->now = 1;
}

bool enf_path_search_reach(enf_path_search *search, int32_t portal, int64_t cost, int64_t key) {
    if (!enf_path_is_reached(search, portal))
        enf_path_heap_add(&search->heap, portal, key);
    else if (cost >= search->cost[portal])
        return false;
    else if (search->heap.slot[portal] < 0)
        enf_path_heap_add(&search->heap, portal, key);
    else
        enf_path_heap_sink(&search->heap, portal, key);
    search->stamp[portal] = search->now;
    search->cost[portal] = cost;
    return true;
}

// ---------------------------------------------------------------------------------------------- one search

typedef struct run {
    enf_path_search *search;
    const enf_paths *paths;
    const enf_instance *instance;
    const enf_path_goal *start, *goal; ///< in the direction of the search
    bool contracts, backward, asks_doors;
    double box[2][3]; ///< of the goal's point, or the portals that lead there; units
    enf_path_ranges ranges;
    int64_t best; ///< of whole paths
    int32_t best_last, best_begin, best_via;
} run;

/// No way from the portal's point to the goal is shorter.
static int64_t bound(const run *r, int32_t portal) {
    if (!r->contracts) return 0;
    const double *place = enf_path_place(r->paths, portal);
    double nearest[3];
    for (int a = 0; a < 3; a++) nearest[a] = fmin(fmax(place[a], r->box[0][a]), r->box[1][a]);
    int64_t straight = enf_path_straight(r->paths, place, nearest);
    int64_t other = enf_path_landmarks_bound(r->paths, r->paths->gate[portal / 2], &r->ranges);
    return straight > other ? straight : other;
}

static bool is_open(const run *r, int32_t portal) {
    return !r->asks_doors || enf_instance_passage(r->instance, r->paths->view, portal).to >= 0;
}

/// Are all portals of a chain open, from one to another?
static bool is_chain_open(const run *r, int32_t from, int32_t to) {
    if (!r->asks_doors) return true;
    while (from != to && is_open(r, from)) from = enf_path_after(r->paths, from);
    return is_open(r, from);
}

static int32_t tail_of(const run *r, int32_t portal) {
    return r->contracts ? r->paths->tail[portal] : portal;
}

/// By which of two equally short ways a path goes on.
static int32_t rank_of(const run *r, int32_t via) {
    if (via == FROM_START) return -1;
    int32_t portal = tail_of(r, via < FROM_START ? -2 - via : via);
    return r->backward ? portal ^ 1 : portal;
}

static void reach(run *r, int32_t portal, int64_t cost, int32_t via) {
    enf_path_search *s = r->search;
    if (enf_path_is_reached(s, portal) && cost == s->cost[portal]) {
        if (rank_of(r, via) < rank_of(r, s->via[portal])) s->via[portal] = via;
    } else if (!enf_path_is_reached(s, portal) || cost < s->cost[portal]) {
        int64_t key = cost + bound(r, portal);
        if (key <= r->best && enf_path_search_reach(s, portal, cost, key)) s->via[portal] = via;
    }
}

/// A whole path: it ends with portal `last`, and its part from `begin` on runs along one chain.
static void finish(run *r, int32_t last, int32_t begin, int32_t via, int64_t cost) {
    int32_t flip = r->backward, better = (last ^ flip) < (r->best_last ^ flip);
    if (cost > r->best || (cost == r->best && !better)) return;
    r->best = cost;
    r->best_last = last;
    r->best_begin = begin;
    r->best_via = via;
}

/// The goal may lie in the middle of a chain.
static void look_for_goal(run *r, int32_t begin, int32_t via, int64_t cost) {
    const enf_paths *paths = r->paths;
    int32_t count;
    const int32_t *exits = enf_path_exits(paths, r->goal->cell, &count);
    if (paths->is_junction[r->goal->cell]) return;
    for (int32_t i = 0; i < count; i++) {
        int32_t last = exits[i] ^ 1;
        int64_t part = paths->offset[last] - paths->offset[begin];
        if (paths->head[last] == paths->head[begin] && part >= 0 && is_chain_open(r, begin, last))
            finish(r, last, begin, via, cost + part + enf_path_last_step(paths, last, r->goal));
    }
}

/// Goes on from the point of a portal along its chain and through the cell at its end.
static void expand(run *r, int32_t begin, int32_t via, int64_t cost) {
    const enf_paths *paths = r->paths;
    if (r->contracts) look_for_goal(r, begin, via, cost);
    int32_t tail = tail_of(r, begin), count;
    if (!is_chain_open(r, begin, tail)) return;
    enf_passage passage = enf_instance_passage(r->instance, paths->view, tail);
    if (passage.to < 0) return; // it was closed meanwhile
    if (r->contracts) cost += paths->offset[tail] - paths->offset[begin];
    double place[3];
    enf_path_come_out(paths, tail, passage.matrix, place);
    if (passage.to == r->goal->cell) {
        finish(r, tail, begin, via,
               cost + (r->goal->has_point ? enf_path_step(paths, place, r->goal->point) : 0));
        return;
    }
    const int32_t *exits = enf_path_exits(paths, passage.to, &count);
    for (int32_t i = 0; i < count; i++)
        if (!r->contracts || exits[i] != (tail ^ 1)) // a twin may transform
            reach(r, exits[i], cost + enf_path_step(paths, place, enf_path_place(paths, exits[i])),
                  via == FROM_START && begin != paths->head[begin] ? -2 - begin : begin);
}

static void leave_start(run *r) {
    const enf_path_goal *start = r->start;
    int32_t count;
    const int32_t *exits = enf_path_exits(r->paths, start->cell, &count);
    for (int32_t i = 0; i < count; i++) {
        int64_t cost = enf_path_last_step(r->paths, exits[i], start);
        if (!r->contracts || r->paths->is_junction[start->cell])
            reach(r, exits[i], cost, FROM_START);
        else
            expand(r, exits[i], FROM_START, cost);
    }
}

static void set_box(run *r) {
    const enf_path_goal *goal = r->goal;
    int32_t count;
    const int32_t *exits = enf_path_exits(r->paths, goal->cell, &count);
    for (int a = 0; a < 3; a++) {
        r->box[0][a] = goal->has_point ? goal->point[a] : INFINITY;
        r->box[1][a] = goal->has_point ? goal->point[a] : -INFINITY;
        for (int32_t i = 0; !goal->has_point && i < count; i++) {
            r->box[0][a] = fmin(r->box[0][a], enf_path_place(r->paths, exits[i])[a]);
            r->box[1][a] = fmax(r->box[1][a], enf_path_place(r->paths, exits[i])[a]);
        }
    }
}

/// Writes portals from the last one back to where a chain was entered.
static int32_t write_chain(const run *r, int32_t last, int32_t begin, int32_t count) {
    int32_t most = r->paths->view->portal_count;
    for (int32_t at = last; count < most; at = enf_path_before(r->paths, at)) {
        r->search->route[count++] = at;
        if (at == begin) break;
    }
    return count;
}

/// Writes the best path from its end to its start.
static int32_t write_route(const run *r) {
    int32_t begin = r->best_begin, count = write_chain(r, r->best_last, begin, 0);
    int32_t via = r->best_via == FROM_START ? FROM_START : r->search->via[begin]; // a tie may have come later
    while (via != FROM_START) {
        begin = via < FROM_START ? -2 - via : via;
        count = write_chain(r, tail_of(r, begin), begin, count);
        via = via < FROM_START ? FROM_START : r->search->via[begin];
    }
    return count;
}

static void turn_round(int32_t *route, int32_t count) {
    for (int32_t i = 0; i < count / 2; i++) {
        int32_t kept = route[i];
        route[i] = route[count - 1 - i];
        route[count - 1 - i] = kept;
    }
}

int32_t enf_path_search_run(enf_path_search *search, const enf_instance *instance, const enf_path_goal *start,
                            const enf_path_goal *goal, int64_t *length) {
    const int32_t *transforms;
    bool plain = enf_instance_transforms(instance, &transforms) == 0;
    run r = {search,
             search->paths,
             instance,
             plain ? goal : start,
             plain ? start : goal,
             .contracts = plain,
             .backward = plain,
             .asks_doors = enf_instance_has_shut(instance),
             .best = ENF_PATH_NEVER,
             .best_last = -1};
    enf_path_search_begin(search);
    set_box(&r);
    enf_path_landmarks_look(r.paths, r.goal, &r.ranges);
    leave_start(&r);
    while (search->heap.count > 0 && search->heap.entries[0].key <= r.best) {
        int32_t portal = enf_path_heap_pop(&search->heap).node;
        expand(&r, portal, search->via[portal], search->cost[portal]);
    }
    *length = r.best;
    if (r.best == ENF_PATH_NEVER) return 0;
    int32_t count = write_route(&r);
    if (!plain) turn_round(search->route, count);
    for (int32_t i = 0; plain && i < count; i++) search->route[i] ^= 1;
    return count;
}
