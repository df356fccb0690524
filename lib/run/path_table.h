// SPDX-License-Identifier: MIT
// Lengths between all gates (portals next to a junction), and what follows from them without a search.
#ifndef ENF_RUN_PATH_TABLE_H
#define ENF_RUN_PATH_TABLE_H

#include "run/path_landmarks.h"

/// The bytes of a table.
uint64_t enf_path_table_size(const enf_paths *paths);

/// Fills the table. False without memory.
bool enf_path_table_make(enf_paths *paths);

/// The length from the point of a portal, passed, to a goal; ENF_PATH_NEVER: no way.
int64_t enf_path_table_rest(const enf_paths *paths, int32_t portal, const enf_path_goal *goal);

#endif
