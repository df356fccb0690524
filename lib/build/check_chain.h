// SPDX-License-Identifier: GPL-3.0-or-later
// Areas of one plane compared by their outlines. The directed edges of some loops make a chain; if the chains
// of two sets of convex loops, all turning the same way, cancel each other along every line, then the two
// sets cover every point of the plane equally often (the winding number of a point depends on the chain
// only). So "these pieces tile that face, without gap or overlap" is decided by matching edges, exactly, and
// most edges match as they are.
#ifndef ENF_BUILD_CHECK_CHAIN_H
#define ENF_BUILD_CHECK_CHAIN_H

#include "build/check_exact.h"

/// A loop of the world, of one of its arrays of loops.
typedef struct enf_check_loop {
    const enf_file_corner *corners;
    int32_t count;
    int32_t plane;
} enf_check_loop;

typedef struct enf_check_edge {
    int32_t low, high; ///< places, low < high
    int32_t turns;     ///< how often it runs from low to high, less how often back
} enf_check_edge;

enum { ENF_CHECK_ANYWHERE = -1 };

typedef struct enf_check_chain {
    enf_check_edge *edges;
    size_t count, capacity;
    bool failed; ///< no memory
} enf_check_chain;

void enf_check_chain_free(enf_check_chain *chain);
void enf_check_chain_empty(enf_check_chain *chain);

/// Adds an edge between two vertices, `times` times (negative: the other way).
void enf_check_chain_add(enf_check_chain *chain, const enf_check_exact *exact, int32_t from, int32_t to,
                         int32_t times);

/// Adds a loop's edges.
void enf_check_chain_add_loop(enf_check_chain *chain, const enf_check_exact *exact,
                              const enf_check_loop *loop, int32_t times);

/// Merges equal edges and drops those that cancel.
void enf_check_chain_reduce(enf_check_chain *chain);

/// Does the chain cancel along every line? Its vertices lie in a plane that is not parallel to `axis`, or
/// anywhere if `axis` is ENF_CHECK_ANYWHERE. Empties the chain; *left (may be null) receives an edge of a
/// line along which it does not cancel.
bool enf_check_chain_vanishes(enf_check_chain *chain, enf_check_exact *exact, int axis, enf_check_edge *left);

/// What is wrong with a loop, or null: it has three corners or more, all on its plane, it is strictly convex
/// and turns counter-clockwise seen from its plane's front, and the edge planes hold their edges and are not
/// its plane.
const char *enf_check_loop_fault(enf_check_exact *exact, const enf_check_loop *loop);

/// Do two loops have the same corners at the same places, in the same order up to where they begin?
bool enf_check_same_loop(const enf_check_exact *exact, const enf_check_loop *a, const enf_check_loop *b);

/// Is `vertex`, on the loop's plane, inside the loop or on its outline?
bool enf_check_loop_holds(enf_check_exact *exact, const enf_check_loop *loop, int32_t vertex);

/// Do two convex loops of one plane, facing the same way, share no area?
bool enf_check_loops_apart(enf_check_exact *exact, const enf_check_loop *a, const enf_check_loop *b);

#endif
