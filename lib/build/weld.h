// SPDX-License-Identifier: GPL-3.0-or-later
// Making near points one.
#ifndef ENF_BUILD_WELD_H
#define ENF_BUILD_WELD_H

#include "enfilade/base.h"

/// A point on its way through clean.
typedef struct enf_site {
    double at[3];
    int32_t id; ///< whatever the owner counts by
} enf_site;

/// Sorts by coordinates (lexicographically), then by id.
void enf_sites_sort(enf_site *sites, size_t count);

/// Groups equal neighbours in sorted `sites`: group_of[site.id] = 0, 1, ... in the order of the coordinates,
/// and the first site of group g moves to sites[g]. Returns the number of groups.
size_t enf_sites_unite(enf_site *sites, size_t count, int32_t *group_of);

/// Greedy welding. `sites` is sorted, whole numbers, all different. In that order each site joins the first
/// earlier representative within `distance` (grid steps, >= 0) or becomes one: joined_to[i] = its position.
/// The result depends on the set of points only, and no point moves by more than `distance`.
enf_status enf_sites_weld(const enf_site *sites, size_t count, double distance, int32_t *joined_to,
                          enf_error *error);

#endif
