// SPDX-License-Identifier: MIT
// An open world. What has been checked is shown by views that never change: loading more makes another view,
// and the older ones stay until the world is closed, so readers need no lock.
#ifndef ENF_RUN_OPEN_H
#define ENF_RUN_OPEN_H

#include "enfilade/run.h"

/// A view of some parts.
typedef struct enf_shown {
    enf_file_view view;
    uint32_t loads;           ///< enf_load
    struct enf_shown *before; ///< the view that this one took the place of
} enf_shown;

/// Shows what is always loaded of a file, and `loads`, once it has been checked.
enf_status enf_world_show(enf_world **world, const void *bytes, size_t size, uint32_t loads,
                          bool skip_checksums, enf_error *error);

/// Tells a world that its bytes are a mapping, to be unmapped by enf_world_close.
void enf_world_set_mapping(enf_world *world, void *mapping, size_t size);

/// True if the file is mapped: its pages may be dropped, for they come back. Not so with a caller's memory.
bool enf_world_is_mapped(const enf_world *world);

/// enf_world_load, for what is made from a world and needs parts of it.
enf_status enf_world_need(const enf_world *world, uint32_t loads, enf_error *error);

/// Does the file have a part, loaded or not?
bool enf_world_has(const enf_world *world, enf_load load);

#endif
