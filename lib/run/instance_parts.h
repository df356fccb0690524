// SPDX-License-Identifier: MIT
// What an instance is made of.
#ifndef ENF_RUN_INSTANCE_PARTS_H
#define ENF_RUN_INSTANCE_PARTS_H

#include "run/changed.h"
#include "run/instance.h"

#include <stdatomic.h>

typedef struct enf_instance_door {
    _Atomic uint32_t version, state;
    _Atomic double plane[4];
} enf_instance_door;

typedef struct enf_instance_transform {
    int32_t to;
    bool used;
    double matrix[12];
} enf_instance_transform;

struct enf_instance {
    const enf_file_view *view;
    enf_instance_door *doors;            ///< per pair of portals
    enf_instance_transform **transforms; ///< per portal; null: never had one. Null if none ever had
    _Atomic bool touched;                ///< some door was set
    int32_t *moving;                     ///< the portals with a transform, ascending
    int32_t moving_count;
    _Atomic int32_t shut; ///< doors closed
    enf_changed changed;  ///< doors that are not open, and transforms
};

/// ENF_BAD_USAGE for a portal that the world does not have.
enf_status enf_instance_check_portal(const enf_instance *instance, int32_t portal, enf_error *error);

#endif
