// SPDX-License-Identifier: MIT
// Reading the lists of objects.
#include "run/objects.h"

#include "run/object_images.h"
#include "run/query.h"
#include "run/shape.h"

#include <math.h>
#include <string.h>

static enf_object handle_of(const enf_objects *objects, int32_t object) {
    return (enf_object){(uint32_t)object + 1, objects->slots[object].generation};
}

bool enf_objects_get(const enf_objects *objects, enf_object object, enf_object_info *info) {
    int32_t number = enf_objects_find(objects, object);
    *info = (enf_object_info){.cell = 0};
    if (number < 0) return false;
    const enf_object_slot *slot = &objects->slots[number];
    int32_t list = objects->links[number].list;
    info->shape = slot->shape;
    info->user = slot->user;
    info->cell = slot->cell;
    info->cell_count = list < objects->cell_count ? slot->link_count : 0;
    info->everywhere = list == enf_objects_list(objects, ENF_LIST_EVERYWHERE);
    return true;
}

int32_t enf_objects_cells(const enf_objects *objects, enf_object object, int32_t *out, int32_t capacity) {
    int32_t number = enf_objects_find(objects, object), count = 0;
    if (number < 0 || objects->links[number].list >= objects->cell_count) return 0;
    for (int32_t i = number; i >= 0; i = objects->links[i].next) {
        if (count < capacity) out[count] = objects->links[i].list;
        count++;
    }
    return count;
}

int32_t enf_objects_of_cell(const enf_objects *objects, int32_t cell, enf_object *out, int32_t capacity) {
    int32_t list = enf_objects_list(objects, cell), count = 0;
    for (int32_t i = list < 0 ? -1 : objects->lists[list].first; i >= 0; i = objects->links[i].behind) {
        if (count < capacity) out[count] = handle_of(objects, objects->links[i].object);
        count++;
    }
    return count;
}

/// True if no cell of the object comes earlier in the caller's list.
static bool is_first(const enf_objects *objects, const enf_query *query, int32_t object, int32_t position) {
    for (int32_t i = object; i >= 0; i = objects->links[i].next) {
        int32_t cell = objects->links[i].list;
        if (cell < objects->cell_count && enf_query_has(query, cell) && query->first[cell] < position)
            return false;
    }
    return true;
}

/// Cells whose objects are listed, and the list. An enf_object_seen begins with the enf_object that it is
/// about, so either is written.
typedef struct listing {
    const enf_objects *objects;
    enf_query *query;
    const int32_t *cells; ///< null: those of the entries, in one space
    const enf_view_entry *entries;
    int32_t cell_count, space;
    char *out;
    size_t size; ///< of an element of `out`
    int32_t count, capacity;
} listing;

/// ENF_LIST_EVERYWHERE, which waits until the end, if it is none.
static int32_t cell_at(const listing *l, int32_t position) {
    if (l->cells) return l->cells[position];
    const enf_view_entry *entry = &l->entries[position];
    return entry->space == l->space ? entry->cell : ENF_LIST_EVERYWHERE;
}

/// The objects of a list that were in none before.
static void put_list(listing *l, int32_t list, int32_t position) {
    for (int32_t i = l->objects->lists[list].first; i >= 0; i = l->objects->links[i].behind) {
        int32_t object = l->objects->links[i].object;
        if (!is_first(l->objects, l->query, object, position)) continue;
        enf_object_seen seen = {handle_of(l->objects, object), position, l->space, -1};
        if (l->count < l->capacity) memcpy(l->out + (size_t)l->count * l->size, &seen, l->size);
        if (l->count < INT32_MAX) l->count++;
    }
}

/// The objects of all cells; if there is a cell, or if the caller gave them, of ENF_LIST_EVERYWHERE, too.
static void put_cells(listing *l) {
    enf_query *query = l->query;
    bool has_nowhere = false, has_any = l->cells != NULL;
    enf_query_begin(query);
    query->flooded_count = query->image_count = 0;
    for (int32_t k = 0; k < l->cell_count; k++) {
        int32_t cell = cell_at(l, k), list = enf_objects_list(l->objects, cell);
        if (list < 0 || cell == ENF_LIST_EVERYWHERE) continue;
        if (cell < 0 ? has_nowhere : enf_query_has(query, cell)) continue;
        has_any = true;
        if (cell < 0)
            has_nowhere = true;
        else
            enf_query_mark(query, cell, k);
        put_list(l, list, k);
    }
    if (has_any) put_list(l, enf_objects_list(l->objects, ENF_LIST_EVERYWHERE), -1);
}

int32_t enf_objects_in_cells(const enf_objects *objects, enf_query *query, const int32_t *cells,
                             int32_t cell_count, enf_object *out, int32_t capacity) {
    static const int32_t none[1];
    listing l = {.objects = objects,
                 .query = query,
                 .cells = cell_count > 0 ? cells : none,
                 .cell_count = cell_count,
                 .out = (char *)out,
                 .size = sizeof *out,
                 .capacity = capacity};
    put_cells(&l);
    return l.count;
}

int32_t enf_objects_in_view(const enf_objects *objects, enf_query *query, const enf_instance *instance,
                            const enf_visible *visible, enf_object_seen *out, int32_t capacity) {
    listing l = {.objects = objects,
                 .query = query,
                 .entries = visible->entries,
                 .cell_count = visible->entry_count,
                 .out = (char *)out,
                 .size = sizeof *out,
                 .capacity = capacity};
    for (; l.space < visible->space_count; l.space++) put_cells(&l);
    enf_seen_list list = {out, l.count, capacity};
    enf_object_images_add(&list, objects, query, instance, visible);
    return list.count;
}

bool enf_objects_meets(const enf_objects *objects, enf_object object, const double (*planes)[4],
                       int32_t plane_count) {
    int32_t number = enf_objects_find(objects, object);
    if (number < 0) return false;
    const enf_shape *shape = &objects->slots[number].shape;
    for (int32_t i = 0; i < plane_count; i++) {
        const double *p = planes[i], *c = shape->centre, *h = shape->half;
        double height = p[0] * c[0] + p[1] * c[1] + p[2] * c[2] + p[3];
        double size = fabs(p[0] * c[0]) + fabs(p[1] * c[1]) + fabs(p[2] * c[2]) + fabs(p[3]);
        double reach = shape->kind == ENF_SHAPE_BOX
                           ? fabs(p[0]) * h[0] + fabs(p[1]) * h[1] + fabs(p[2]) * h[2]
                           : sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) * shape->radius;
        if (height + reach < -(size + reach) * 0x1p-40) return false;
    }
    return true;
}

enf_objects_use enf_objects_get_use(const enf_objects *objects) {
    return (enf_objects_use){objects->object_count, objects->objects_max,      objects->link_count,
                             objects->links_max,    objects->outside_count[0], objects->outside_count[1]};
}
