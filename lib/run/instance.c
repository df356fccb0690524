// SPDX-License-Identifier: MIT
// Doors are written behind a version number that is odd meanwhile (a sequence lock): a reader that sees it
// odd, or changed, reads again. Who reads a new number of the data sees the version change that came before
// it, because the data are released and acquired one by one: H.-J. Boehm, "Can seqlocks get along with
// programming language memory models?", MSPC 2012. (Fences would do, too, but thread sanitizers do not know
// them.)
#include "run/instance_parts.h"
#include "run/vector.h"

#include <string.h>

enf_status enf_instance_set_door(enf_instance *instance, int32_t portal, const enf_door *set,
                                 enf_error *error) {
    enf_status status = enf_instance_check_portal(instance, portal, error);
    if (status) return status;
    const double *plane = set->plane;
    bool partly = set->state == ENF_DOOR_PARTLY;
    if ((unsigned)set->state > ENF_DOOR_PARTLY)
        return enf_fail(error, ENF_BAD_USAGE, "a door's state is open, closed or partly open");
    if (partly && (!enf_are_finite(plane, 4) || (plane[0] == 0 && plane[1] == 0 && plane[2] == 0)))
        return enf_fail(error, ENF_BAD_USAGE, "a door that is partly open needs a plane with a direction");
    enf_instance_door *door = &instance->doors[portal / 2];
    atomic_store_explicit(&instance->touched, true, memory_order_release);
    const uint32_t before = atomic_load_explicit(&door->state, memory_order_relaxed);
    int shuts = (set->state == ENF_DOOR_CLOSED) - (before == ENF_DOOR_CLOSED);
    int change = (set->state != ENF_DOOR_OPEN) - (before != ENF_DOOR_OPEN);
    if (shuts > 0) atomic_fetch_add_explicit(&instance->shut, 1, memory_order_release);
    if (change > 0) enf_changed_add(&instance->changed, portal / 2, change);
    uint32_t version = atomic_load_explicit(&door->version, memory_order_relaxed);
    atomic_store_explicit(&door->version, version + 1, memory_order_relaxed);
    atomic_store_explicit(&door->state, (uint32_t)set->state, memory_order_release);
    for (int i = 0; i < 4; i++)
        atomic_store_explicit(&door->plane[i], partly ? plane[i] : 0, memory_order_release);
    atomic_store_explicit(&door->version, version + 2, memory_order_release);
    if (shuts < 0) atomic_fetch_sub_explicit(&instance->shut, 1, memory_order_release);
    if (change < 0) enf_changed_add(&instance->changed, portal / 2, change);
    return ENF_OK;
}

static enf_door read_door(const enf_instance_door *door) {
    enf_door read = {0};
    for (;;) {
        uint32_t version = atomic_load_explicit(&door->version, memory_order_acquire);
        read.state = (enf_door_state)atomic_load_explicit(&door->state, memory_order_acquire);
        for (int i = 0; i < 4; i++)
            read.plane[i] = atomic_load_explicit(&door->plane[i], memory_order_acquire);
        uint32_t after = atomic_load_explicit(&door->version, memory_order_relaxed);
        if (version % 2 == 0 && version == after) return read;
    }
}

enf_door enf_instance_get_door(const enf_instance *instance, int32_t portal) {
    if (enf_instance_check_portal(instance, portal, NULL)) return (enf_door){0};
    return read_door(&instance->doors[portal / 2]);
}

bool enf_instance_is_changed(const enf_instance *instance) {
    return instance &&
           (instance->transforms || atomic_load_explicit(&instance->touched, memory_order_acquire));
}

const _Atomic int32_t *enf_instance_changed_below(const enf_instance *instance, int32_t node_count) {
    return instance->changed.node_count == node_count ? instance->changed.below : NULL;
}

bool enf_instance_pair_is_changed(const enf_instance *instance, int32_t portal) {
    int32_t pair = portal / 2;
    if (atomic_load_explicit(&instance->doors[pair].version, memory_order_relaxed) != 0 &&
        read_door(&instance->doors[pair]).state != ENF_DOOR_OPEN)
        return true;
    for (int32_t i = 2 * pair; instance->transforms && i < 2 * pair + 2; i++)
        if (instance->transforms[i] && instance->transforms[i]->used) return true;
    return false;
}

enf_passage enf_instance_lead(const enf_instance *instance, const enf_file_view *view, int32_t portal,
                              bool *is_shut) {
    enf_passage passage = {.to = view->portals[portal].to};
    *is_shut = false;
    if (!instance) return passage;
    const enf_instance_transform *transform = instance->transforms ? instance->transforms[portal] : NULL;
    if (transform && transform->used) {
        passage.to = transform->to;
        passage.matrix = transform->matrix;
    }
    const enf_instance_door *door = &instance->doors[portal / 2];
    if (atomic_load_explicit(&door->version, memory_order_relaxed) == 0) return passage; // never touched
    enf_door now = read_door(door);
    *is_shut = now.state == ENF_DOOR_CLOSED;
    passage.cut = now.state == ENF_DOOR_PARTLY;
    memcpy(passage.plane, now.plane, sizeof passage.plane);
    return passage;
}

enf_passage enf_instance_passage(const enf_instance *instance, const enf_file_view *view, int32_t portal) {
    bool is_shut;
    enf_passage passage = enf_instance_lead(instance, view, portal, &is_shut);
    if (is_shut) passage.to = -1;
    return passage;
}

bool enf_instance_has_shut(const enf_instance *instance) {
    return instance && atomic_load_explicit(&instance->shut, memory_order_acquire) > 0;
}

int32_t enf_instance_transforms(const enf_instance *instance, const int32_t **portals) {
    *portals = instance ? instance->moving : NULL;
    return instance ? instance->moving_count : 0;
}
