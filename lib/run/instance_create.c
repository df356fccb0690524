// SPDX-License-Identifier: MIT
// Instances, and the transforms of their portals.
#include "run/instance_parts.h"

#include "base/options.h"
#include "run/affine.h"
#include "run/open.h"
#include "run/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enf_status enf_instance_create(enf_instance **out, const enf_world *world,
                               const enf_instance_options *options, enf_error *error) {
    *out = NULL;
    enf_instance_options chosen; // has no members yet
    enf_status status = enf_options_take(&chosen, sizeof chosen, options, "enf_instance_options", error);
    if (!status) status = enf_world_need(world, ENF_LOAD_CELLS, error);
    if (status) return status;
    const enf_file_view *view = enf_world_file(world);
    enf_instance *instance = calloc(1, sizeof *instance);
    enf_instance_door *doors = calloc((size_t)view->portal_count / 2 + 1, sizeof *doors);
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

enf_status enf_instance_check_portal(const enf_instance *instance, int32_t portal, enf_error *error) {
    if (portal >= 0 && portal < instance->view->portal_count) return ENF_OK;
    return enf_fail(error, ENF_BAD_USAGE, "portal %ld: the world has portals 0 to %ld", (long)portal,
                    (long)instance->view->portal_count - 1);
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
    enf_instance_transform *transform = instance->transforms[portal];
    if (used != transform->used) enf_changed_add(&instance->changed, portal / 2, used ? 1 : -1);
    transform->used = used;
    note_transform(instance, portal, used);
}

/// Memory for a transform of a portal, and for the lists.
static bool reserve_transform(enf_instance *instance, int32_t portal) {
    size_t count = (size_t)instance->view->portal_count;
    if (!instance->transforms) instance->transforms = calloc(count, sizeof(enf_instance_transform *));
    if (!instance->moving) instance->moving = malloc(count * sizeof *instance->moving);
    if (!instance->transforms || !instance->moving) return false;
    enf_instance_transform **place = &instance->transforms[portal];
    if (!*place) *place = calloc(1, sizeof **place);
    return *place != NULL;
}

enf_status enf_instance_set_transform(enf_instance *instance, int32_t portal, int32_t to,
                                      const double matrix[12], enf_error *error) {
    enf_status status = enf_instance_check_portal(instance, portal, error);
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
    enf_instance_transform *place = instance->transforms[portal];
    place->to = to;
    memcpy(place->matrix, matrix, sizeof place->matrix);
    set_used(instance, portal, true);
    return ENF_OK;
}

bool enf_instance_get_transform(const enf_instance *instance, int32_t portal, int32_t *to,
                                double matrix[12]) {
    if (portal < 0 || portal >= instance->view->portal_count || !instance->transforms) return false;
    const enf_instance_transform *transform = instance->transforms[portal];
    if (!transform || !transform->used) return false;
    *to = transform->to;
    memcpy(matrix, transform->matrix, sizeof transform->matrix);
    return true;
}
