// SPDX-License-Identifier: MIT
// What changes in a world while it runs: doors, and portals that lead elsewhere. The world itself stays as it
// was opened; any number of instances may share one.
//
// Who may do what when: queries that take a const enf_instance may run on any number of threads. Doors may be
// set meanwhile, by one thread at a time: each query sees a door before or after the change, never half of
// it. All other changes need the instance alone: no query and no other change at the same time.
#ifndef ENFILADE_INSTANCE_H
#define ENFILADE_INSTANCE_H

#include "enfilade/run.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct enf_instance enf_instance;

/// Options of an instance; null or all zero but `size` is the default.
typedef struct enf_instance_options {
    size_t size; ///< sizeof(enf_instance_options)
} enf_instance_options;

/// All doors open, no portal transforms. The world must stay open as long as the instance lives. All memory
/// is taken here. ENF_NO_RESOURCES without it. Lines of sight find the doors on their way fastest if
/// ENF_LOAD_SIGHT was loaded before.
ENF_API enf_status enf_instance_create(enf_instance **instance, const enf_world *world,
                                       const enf_instance_options *options, enf_error *error);

/// Null is fine.
ENF_API void enf_instance_free(enf_instance *instance);

typedef enum enf_door_state {
    ENF_DOOR_OPEN = 0,
    ENF_DOOR_CLOSED,
    ENF_DOOR_PARTLY ///< open on the positive side of `plane`
} enf_door_state;

/// A door hangs in a portal and its twin.
typedef struct enf_door {
    enf_door_state state;
    double plane[4]; ///< a, b, c, d of a x + b y + c z + d >= 0, world; of a door that is partly open
} enf_door;

/// In a time that the depth of the tree of portals bounds (a node has up to four children), for each of the
/// portal's polygons. ENF_BAD_USAGE for a portal that the world does not have, or a plane that is not finite
/// or has no direction.
ENF_API enf_status enf_instance_set_door(enf_instance *instance, int32_t portal, const enf_door *door,
                                         enf_error *error);

/// Open for a portal that the world does not have.
ENF_API enf_door enf_instance_get_door(const enf_instance *instance, int32_t portal);

/// Lets what passes a portal come out elsewhere: a point x before it arrives at matrix * x, in cell `to`. The
/// matrix is affine: row by row, 3 x 4. A mirror is a reflection that leads back to the portal's own cell.
/// The twin is not touched. Null: the portal leads where it did again. Takes no memory once the portal has
/// had one. ENF_BAD_USAGE for a portal or a cell that the world does not have, or a matrix that is not finite
/// or cannot be inverted; ENF_NO_RESOURCES without memory.
ENF_API enf_status enf_instance_set_transform(enf_instance *instance, int32_t portal, int32_t to,
                                              const double matrix[12], enf_error *error);

/// Where what passes a portal comes out: its cell, and the matrix. False, with both as they were, if the
/// portal does not transform, or the world does not have it.
ENF_API bool enf_instance_get_transform(const enf_instance *instance, int32_t portal, int32_t *to,
                                        double matrix[12]);

#ifdef __cplusplus
}
#endif
#endif
