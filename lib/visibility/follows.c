// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/follows.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

/// How many portals there are behind all portals: each cell's, as often as it has some.
static size_t count_behind(const enf_portal_graph *graph) {
    size_t count = 0;
    for (int32_t c = 0; c < graph->cell_count; c++) {
        const size_t portals = (size_t)(graph->cell_portal[c + 1] - graph->cell_portal[c]);
        count += portals * portals;
    }
    return count;
}

bool enf_follows_make(enf_follows *follows, const enf_portal_graph *graph,
                      bool (*can)(const void *user, int32_t portal, int32_t next), const void *user) {
    const int32_t portals = 2 * graph->opening_count;
    const size_t most = count_behind(graph);
    int32_t count = 0;
    *follows = (enf_follows){0};
    if (most > INT32_MAX) return false;
    follows->first = enf_array_new((size_t)portals + 1, sizeof *follows->first);
    follows->portals = enf_array_new(most, sizeof *follows->portals);
    if (!follows->first || !follows->portals) return false;
    for (int32_t p = 0; p < portals; p++) {
        const int32_t *behind = &graph->cell_portal[enf_portal_to(graph, p)];
        follows->first[p] = count;
        for (int32_t k = behind[0]; k < behind[1]; k++)
            if (can(user, p, graph->cell_portals[k])) follows->portals[count++] = graph->cell_portals[k];
    }
    follows->first[portals] = count;
    return true;
}

void enf_follows_free(enf_follows *follows) {
    free(follows->first);
    free(follows->portals);
    memset(follows, 0, sizeof *follows);
}
