// SPDX-License-Identifier: MIT
#ifndef ENF_RUN_OPEN_H
#define ENF_RUN_OPEN_H

#include "enfilade/run.h"

/// True if the file is mapped: its pages may be dropped, for they come back. Not so with a caller's memory.
bool enf_world_is_mapped(const enf_world *world);

#endif
