// SPDX-License-Identifier: MIT
// What of objects comes out of portals that transform.
#ifndef ENF_RUN_OBJECT_IMAGES_H
#define ENF_RUN_OBJECT_IMAGES_H

#include "enfilade/objects.h"

/// A list of what a view shows, as far as it fits.
typedef struct enf_seen_list {
    enf_object_seen *out;
    int32_t count, capacity;
} enf_seen_list;

static inline void enf_seen_add(enf_seen_list *list, const enf_object_seen *seen) {
    if (list->count < list->capacity) list->out[list->count] = *seen;
    if (list->count < INT32_MAX) list->count++;
}

/// Appends the images in the view's cells, portal by portal.
void enf_object_images_add(enf_seen_list *list, const enf_objects *objects, enf_query *query,
                           const enf_instance *instance, const enf_visible *visible);

#endif
