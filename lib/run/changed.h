// SPDX-License-Identifier: MIT
// Where in the tree of portals the ones are that are not as they were compiled, so that a walk along a line
// of sight can leave out all the rest.
#ifndef ENF_RUN_CHANGED_H
#define ENF_RUN_CHANGED_H

#include "enfilade/format.h"

#include <stdatomic.h>

typedef struct enf_changed {
    int32_t node_count;     ///< of the tree; 0: the world has none, or it was not loaded
    _Atomic int32_t *below; ///< per node: changes to the portals below it, counted once for every polygon
    int32_t *parent;        ///< per node; -1: the root
    int32_t *pair_first;    ///< per pair of portals, and one more: range in `nodes`
    int32_t *nodes;         ///< that a pair's polygons are children of
} enf_changed;

/// Nothing is changed. False without memory; free it then, too.
bool enf_changed_make(enf_changed *changed, const enf_file_view *view);

void enf_changed_free(enf_changed *changed);

/// One change more to a pair (+1), or one less (-1). Takes a time that the depth of the tree bounds.
void enf_changed_add(enf_changed *changed, int32_t pair, int32_t change);

#endif
