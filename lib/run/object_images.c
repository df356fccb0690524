// SPDX-License-Identifier: MIT
// Portals that transform are few, and so are the objects that reach into one: each of those floods from the
// cell that the portal leads to.
#include "run/object_images.h"

#include "run/affine.h"
#include "run/instance.h"
#include "run/objects.h"
#include "run/query.h"
#include "run/shape.h"
#include "run/view_space.h"

/// Once for each space in which a cell that the flood has reached is listed.
static void put_image(enf_seen_list *list, const enf_visible *visible, const enf_query *query,
                      enf_object_seen seen) {
    bool has_space[ENF_VIEW_SPACES] = {false};
    for (seen.entry = 0; seen.entry < visible->entry_count; seen.entry++) {
        const enf_view_entry *entry = &visible->entries[seen.entry];
        if (has_space[entry->space] || !enf_query_has(query, entry->cell)) continue;
        has_space[entry->space] = true;
        seen.space = entry->space;
        enf_seen_add(list, &seen);
    }
}

/// A reflection that leads back: nothing passes it.
static bool is_mirror(const enf_passage *passage, int32_t from) {
    return passage->to == from && enf_affine_determinant(passage->matrix) < 0;
}

/// The objects of a list that reach into a portal. (An image too large for doubles is left out.)
static void put_images(enf_seen_list *list, const enf_objects *objects, int32_t of_list, enf_query *query,
                       const enf_visible *visible, int32_t portal, const enf_passage *passage) {
    for (int32_t link = objects->lists[of_list].first; link >= 0; link = objects->links[link].behind) {
        const int32_t object = objects->links[link].object;
        const enf_object_slot *slot = &objects->slots[object];
        if (!enf_query_enters(query, &slot->shape, portal, passage)) continue;
        const enf_shape image = enf_shape_image(&slot->shape, passage->matrix);
        if (!enf_shape_is_valid(&image)) continue;
        enf_query_flood(query, NULL, passage->to, &image);
        put_image(list, visible, query,
                  (enf_object_seen){.object = {(uint32_t)object + 1, slot->generation}, .portal = portal});
    }
}

void enf_object_images_add(enf_seen_list *list, const enf_objects *objects, enf_query *query,
                           const enf_instance *instance, const enf_visible *visible) {
    const int32_t *portals, everywhere = enf_objects_list(objects, ENF_LIST_EVERYWHERE);
    const int32_t count = enf_instance_transforms(instance, &portals);
    for (int32_t i = 0; i < count; i++) {
        const int32_t from = query->view->portals[portals[i]].from;
        const enf_passage passage = enf_instance_passage(instance, query->view, portals[i]);
        if (passage.to < 0 || is_mirror(&passage, from)) continue;
        put_images(list, objects, from, query, visible, portals[i], &passage);
        put_images(list, objects, everywhere, query, visible, portals[i], &passage);
    }
}
