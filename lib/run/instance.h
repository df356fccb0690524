// SPDX-License-Identifier: MIT
#ifndef ENF_RUN_INSTANCE_H
#define ENF_RUN_INSTANCE_H

#include "enfilade/instance.h"

/// Where a portal leads at the moment.
typedef struct enf_passage {
    int32_t to;           ///< cell; -1: closed
    bool cut;             ///< passable on the positive side of `plane` only
    double plane[4];      ///< world, before the transform
    const double *matrix; ///< 3 x 4, or null
} enf_passage;

/// The passage of a portal; without an instance all portals are open. The portal must be the world's.
enf_passage enf_instance_passage(const enf_instance *instance, const enf_file_view *view, int32_t portal);

/// True if a door was ever touched, or a portal given a transform: then portals must be looked at.
/// Null: false.
bool enf_instance_is_changed(const enf_instance *instance);

/// The same of one pair of portals; false: it is as it was compiled.
bool enf_instance_pair_is_changed(const enf_instance *instance, int32_t portal);

/// How many changes there are below each node of the tree of portals, if it has `node_count` nodes. Null:
/// that is not known.
const _Atomic int32_t *enf_instance_changed_below(const enf_instance *instance, int32_t node_count);

/// The passage of a portal, but a door that is closed does not hide where the portal leads.
enf_passage enf_instance_lead(const enf_instance *instance, const enf_file_view *view, int32_t portal,
                              bool *is_shut);

/// Is any door closed? Null: none.
bool enf_instance_has_shut(const enf_instance *instance);

/// The portals that transform, ascending. Null: none.
int32_t enf_instance_transforms(const enf_instance *instance, const int32_t **portals);

#endif
