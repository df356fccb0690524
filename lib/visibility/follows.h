// SPDX-License-Identifier: GPL-3.0-or-later
// Which portals can come right after each on a sight line.
#ifndef ENF_VISIBILITY_FOLLOWS_H
#define ENF_VISIBILITY_FOLLOWS_H

#include "visibility/portal_graph.h"

typedef struct enf_follows {
    int32_t *first; ///< portals + 1 offsets into portals
    int32_t *portals;
} enf_follows;

/// Asks about each portal and each that leads out of the cell behind it, in the order of cell_portals. False
/// without memory; free it in any case.
bool enf_follows_make(enf_follows *follows, const enf_portal_graph *graph,
                      bool (*can)(const void *user, int32_t portal, int32_t next), const void *user);
void enf_follows_free(enf_follows *follows);

#endif
