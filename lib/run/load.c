// SPDX-License-Identifier: MIT
// Loading a world's parts. A view that shows more is made on the side and then put in the place of the latest
// one in a single step. Two threads that load at the same time may check the same part twice, and whoever
// comes second starts from what the first has shown.
#include "run/open.h"

#include "format/read.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <sys/mman.h>

struct enf_world {
    _Atomic(enf_shown *) shown; ///< the latest
    enf_file_view placed;       ///< all parts, checked or not
    bool skip_checksums;
    void *mapping; ///< null: the bytes are the caller's
    size_t mapping_size;
};

static enf_shown *make_shown(const enf_file_view *placed, uint32_t loads, enf_shown *before) {
    enf_shown *shown = malloc(sizeof *shown);
    if (!shown) return NULL;
    enf_file_show(&shown->view, placed, loads);
    shown->loads = loads;
    shown->before = before;
    return shown;
}

enf_status enf_world_show(enf_world **out, const void *bytes, size_t size, uint32_t loads,
                          bool skip_checksums, enf_error *error) {
    enf_world *world = calloc(1, sizeof *world);
    if (!world) return enf_fail_memory(error, "opening a world");
    world->skip_checksums = skip_checksums;
    enf_status status = enf_file_place(&world->placed, bytes, size, error);
    if (!status) status = enf_file_check(&world->placed, loads, skip_checksums, error);
    enf_shown *shown = status ? NULL : make_shown(&world->placed, loads, NULL);
    if (!status && !shown) status = enf_fail_memory(error, "opening a world");
    if (status) {
        free(world);
        return status;
    }
    atomic_init(&world->shown, shown);
    *out = world;
    return ENF_OK;
}

void enf_world_set_mapping(enf_world *world, void *mapping, size_t size) {
    world->mapping = mapping;
    world->mapping_size = size;
}

bool enf_world_is_mapped(const enf_world *world) {
    return world->mapping != NULL;
}

void enf_world_close(enf_world *world) {
    if (!world) return;
    if (world->mapping) munmap(world->mapping, world->mapping_size);
    for (enf_shown *shown = atomic_load_explicit(&world->shown, memory_order_acquire), *before; shown;
         shown = before) {
        before = shown->before;
        free(shown);
    }
    free(world);
}

static const enf_shown *latest(const enf_world *world) {
    return atomic_load_explicit(&world->shown, memory_order_acquire);
}

const enf_file_view *enf_world_file(const enf_world *world) {
    return &latest(world)->view;
}

uint32_t enf_world_loaded(const enf_world *world) {
    return latest(world)->loads;
}

/// Puts a view that shows `checked` as well in the place of the latest one.
static enf_status show_more(enf_world *world, uint32_t checked, enf_error *error) {
    enf_shown *shown = atomic_load_explicit(&world->shown, memory_order_acquire), *more;
    do {
        if ((checked & ~shown->loads) == 0) return ENF_OK;
        more = make_shown(&world->placed, shown->loads | checked, shown);
        if (!more) return enf_fail_memory(error, "loading a part of a world");
        if (atomic_compare_exchange_strong_explicit(&world->shown, &shown, more, memory_order_acq_rel,
                                                    memory_order_acquire))
            return ENF_OK;
        free(more);
    } while (true);
}

enf_status enf_world_load(enf_world *world, uint32_t loads, enf_error *error) {
    if (loads & ~(uint32_t)ENF_LOAD_ALL)
        return enf_fail(error, ENF_BAD_USAGE, "there is no part %#lx of a world", (unsigned long)loads);
    uint32_t missing = enf_load_with_needs(loads) & ~latest(world)->loads;
    if (missing == 0) return ENF_OK;
    enf_status status = enf_file_check(&world->placed, missing, world->skip_checksums, error);
    return status ? status : show_more(world, missing, error);
}

enf_status enf_world_need(const enf_world *world, uint32_t loads, enf_error *error) {
    // Worlds are never const themselves. NOLINTNEXTLINE(performance-no-int-to-ptr)
    return enf_world_load((enf_world *)(uintptr_t)world, loads, error);
}

bool enf_world_has(const enf_world *world, enf_load load) {
    const enf_file_view *placed = &world->placed;
    switch (load) {
    case ENF_LOAD_SIGHT:
        return placed->sight != NULL;
    case ENF_LOAD_SEEN:
        return placed->pvs != NULL;
    case ENF_LOAD_DRAW:
        return placed->has_geometry;
    case ENF_LOAD_EXACT:
        return placed->has_exact;
    default:
        return true;
    }
}
