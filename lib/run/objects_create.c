// SPDX-License-Identifier: MIT
// Moving objects: their memory.
#include "run/objects.h"

#include "base/options.h"
#include "run/open.h"
#include "run/query.h"
#include "run/take.h"

#include <stdlib.h>

enum { OBJECTS_DEFAULT = 1024, LINKS_PER_OBJECT = 3 };

/// All slots and links free, all lists empty.
static void clear(enf_objects *objects) {
    for (int32_t i = 0; i < objects->objects_max; i++) {
        objects->slots[i].next_free = i + 1 < objects->objects_max ? i + 1 : -1;
        objects->links[i] = (enf_link){i, -1, -1, -1, -1, 0};
    }
    for (int32_t i = objects->objects_max; i < objects->objects_max + objects->links_max; i++)
        objects->links[i] = (enf_link){-1, -1, -1, i + 1, -1, 0};
    objects->free_slot = objects->objects_max > 0 ? 0 : -1;
    objects->free_link = -1;
    if (objects->links_max > 0) {
        objects->free_link = objects->objects_max;
        objects->links[objects->objects_max + objects->links_max - 1].behind = -1;
    }
    for (int32_t i = 0; i < objects->cell_count + 2; i++) objects->lists[i] = (enf_list){-1, -1};
}

static enf_status take_memory(enf_objects *objects, const enf_world *world, enf_error *error) {
    size_t links = (size_t)objects->objects_max + (size_t)objects->links_max;
    objects->slots = enf_take((size_t)objects->objects_max, sizeof *objects->slots);
    objects->links = enf_take(links, sizeof *objects->links);
    objects->lists = enf_take((size_t)objects->cell_count + 2, sizeof *objects->lists);
    if (!objects->slots || !objects->links || !objects->lists)
        return enf_fail_memory(error, "moving objects");
    enf_query_options options = {.size = sizeof options, .skip_triangles = true, .images_max = 1};
    return enf_query_create(&objects->query, world, &options, error);
}

enf_status enf_objects_create(enf_objects **out, const enf_world *world, const enf_objects_options *given,
                              enf_error *error) {
    *out = NULL;
    enf_objects_options options;
    enf_status status = enf_options_take(&options, sizeof options, given, "enf_objects_options", error);
    if (!status) status = enf_world_need(world, ENF_LOAD_CELLS | ENF_LOAD_LOCATION, error);
    if (status) return status;
    int32_t objects_max = options.objects_max ? options.objects_max : OBJECTS_DEFAULT;
    int32_t links_default = objects_max / 2 <= INT32_MAX / 8 ? objects_max * LINKS_PER_OBJECT : 0;
    int32_t links_max = options.links_max ? options.links_max : links_default;
    if (objects_max < 0 || links_max < 0 || links_max > INT32_MAX - objects_max)
        return enf_fail(error, ENF_BAD_USAGE,
                        "%ld moving objects with %ld links; give numbers from 0 to a thousand million",
                        (long)objects_max, (long)links_max);
    enf_objects *objects = calloc(1, sizeof *objects);
    if (!objects) return enf_fail_memory(error, "moving objects");
    objects->world = world;
    objects->cell_count = enf_world_file(world)->cell_count;
    objects->objects_max = objects_max;
    objects->links_max = links_max;
    status = objects->cell_count > INT32_MAX - 2
                 ? enf_fail(error, ENF_BAD_USAGE, "the world has too many cells for moving objects")
                 : take_memory(objects, world, error);
    if (status) {
        enf_objects_free(objects);
        return status;
    }
    clear(objects);
    *out = objects;
    return ENF_OK;
}

void enf_objects_free(enf_objects *objects) {
    if (!objects) return;
    free(objects->slots);
    free(objects->links);
    free(objects->lists);
    enf_query_free(objects->query);
    free(objects);
}
