// SPDX-License-Identifier: MIT
// Doors are written behind a version number that is odd meanwhile (a sequence lock): a reader that sees it
// odd, or changed, reads again. Who reads a new number of the data sees the version change that came before
// it, because the data are released and acquired one by one: H.-J. Boehm, "Can seqlocks get along with
// programming language memory models?", MSPC 2012. (Fences would do, too, but thread sanitizers do not know
// them.)
#include "run/instance.h"

#include "base/options.h"
#include "run/affine.h"
#include "run/changed.h"
#include "run/open.h"
#include "run/vector.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

typedef struct door {
    _Atomic uint32_t version, state;
    _Atomic double plane[4];
} door;

typedef struct transform {
    int32_t to;
    bool used;
    double matrix[12];
} transform;

struct enf_instance {
    const enf_file_view *view;
    door *doors;            ///< per pair of portals
    transform **transforms; ///< per portal; null: never had one. Null if none ever had
    _Atomic bool touched;   ///< some door was set
    int32_t *moving;        ///< the portals with a transform, ascending
    int32_t moving_count;
    _Atomic int32_t shut; ///< doors closed
    enf_changed changed;  ///< doors that are not open, and transforms
};

enf_status enf_instance_create(enf_instance **out, const enf_world *world,
                               const enf_instance_options *options, enf_error *error) {
    *out = NULL;
    enf_instance_options chosen; // has no members yet
    enf_status status = enf_options_take(&chosen, sizeof chosen, options, "enf_instance_options", error);
    if (!status) status = enf_world_need(world, ENF_LOAD_CELLS, error);
    if (status) return status;
    const enf_file_view *view = enf_world_file(world);
    enf_instance *instance = calloc(1, sizeof *instance);
    door *doors = calloc((size_t)view->portal_count / 2 + 1, sizeof *doors);
    if (!instance || !doors || !enf_changed_make(&instance->changed, view)) {
        if (instance) enf_changed_free(&instance->changed);
        free(instance);
        free(doors);
        return enf_fail_memory(error, "an instance");
    }
    instance->view = view;
    instance->doors = doors;
    *out = instance;
    return ENF_OK;
}

void enf_instance_free(enf_instance *instance) {
    if (!instance) return;
    for (int32_t i = 0; instance->transforms && i < instance->view->portal_count; i++)
        free(instance->transforms[i]);
    free(instance->transforms);
    free(instance->moving);
    free(instance->doors);
    enf_changed_free(&instance->changed);
    free(instance);
}

static enf_status check_portal(const enf_instance *instance, int32_t portal, enf_error *error) {
    if (portal >= 0 && portal < instance->view->portal_count) return ENF_OK;
    return enf_fail(error, ENF_BAD_USAGE, "portal %ld: the world has portals 0 to %ld", (long)portal,
                    (long)instance->view->portal_count - 1);
}

enf_status enf_instance_set_door(enf_instance *instance, int32_t portal, const enf_door *set,
                                 enf_error *error) {
    enf_status status = check_portal(instance, portal, error);
    if (status) return status;
    const double *plane = set->plane;
    bool partly = set->state == ENF_DOOR_PARTLY;
    if ((unsigned)set->state > ENF_DOOR_PARTLY)
        return enf_fail(error, ENF_BAD_USAGE, "a door's state is open, closed or partly open");
    if (partly && (!enf_are_finite(plane, 4) || (plane[0] == 0 && plane[1] == 0 && plane[2] == 0)))
        return enf_fail(error, ENF_BAD_USAGE, "a door that is partly open needs a plane with a direction");
    door *door = &instance->doors[portal / 2];
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

static enf_door read_door(const door *door) {
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
    if (check_portal(instance, portal, NULL)) return (enf_door){0};
    return read_door(&instance->doors[portal / 2]);
}

/// Takes a portal into the list of those that transform, or out of it.
static void note_transform(enf_instance *instance, int32_t portal, bool used) {
    int32_t at = 0, *list = instance->moving;
    while (at < instance->moving_count && list[at] < portal) at++;
    bool listed = at < instance->moving_count && list[at] == portal;
    size_t behind = (size_t)(instance->moving_count - at);
    if (used && !listed) {
        memmove(list + at + 1, list + at, behind * sizeof *list);
        list[at] = portal;
        instance->moving_count++;
    } else if (!used && listed) {
        memmove(list + at, list + at + 1, (behind - 1) * sizeof *list);
        instance->moving_count--;
    }
}

static void set_used(enf_instance *instance, int32_t portal, bool used) {
    transform *transform = instance->transforms[portal];
    if (used != transform->used) enf_changed_add(&instance->changed, portal / 2, used ? 1 : -1);
    transform->used = used;
    note_transform(instance, portal, used);
}

/// Memory for a transform of a portal, and for the lists.
static bool reserve_transform(enf_instance *instance, int32_t portal) {
    size_t count = (size_t)instance->view->portal_count;
    if (!instance->transforms) instance->transforms = calloc(count, sizeof(transform *));
    if (!instance->moving) instance->moving = malloc(count * sizeof *instance->moving);
    if (!instance->transforms || !instance->moving) return false;
    transform **place = &instance->transforms[portal];
    if (!*place) *place = calloc(1, sizeof **place);
    return *place != NULL;
}

enf_status enf_instance_set_transform(enf_instance *instance, int32_t portal, int32_t to,
                                      const double matrix[12], enf_error *error) {
    enf_status status = check_portal(instance, portal, error);
    if (status) return status;
    if (!matrix) {
        if (instance->transforms && instance->transforms[portal]) {
            set_used(instance, portal, false);
        }
        return ENF_OK;
    }
    if (to < 0 || to >= instance->view->cell_count)
        return enf_fail(error, ENF_BAD_USAGE, "cell %ld: the world has cells 0 to %ld", (long)to,
                        (long)instance->view->cell_count - 1);
    double volume = enf_are_finite(matrix, 12) ? enf_affine_determinant(matrix) : 0;
    if (volume == 0 || !isfinite(volume))
        return enf_fail(error, ENF_BAD_USAGE, "a transform must be finite and have an inverse");
    if (!reserve_transform(instance, portal)) return enf_fail_memory(error, "a transform");
    transform *place = instance->transforms[portal];
    place->to = to;
    memcpy(place->matrix, matrix, sizeof place->matrix);
    set_used(instance, portal, true);
    return ENF_OK;
}

bool enf_instance_get_transform(const enf_instance *instance, int32_t portal, int32_t *to,
                                double matrix[12]) {
    if (portal < 0 || portal >= instance->view->portal_count || !instance->transforms) return false;
    const transform *transform = instance->transforms[portal];
    if (!transform || !transform->used) return false;
    *to = transform->to;
    memcpy(matrix, transform->matrix, sizeof transform->matrix);
    return true;
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
    const transform *transform = instance->transforms ? instance->transforms[portal] : NULL;
    if (transform && transform->used) {
        passage.to = transform->to;
        passage.matrix = transform->matrix;
    }
    const door *door = &instance->doors[portal / 2];
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
