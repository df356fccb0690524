// SPDX-License-Identifier: MIT
// Reading the lists of objects.
#include "run/objects.h"

#include "run/query.h"
#include "run/shape.h"

#include <math.h>

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

int32_t enf_objects_in_cells(const enf_objects *objects, enf_query *query, const int32_t *cells,
                             int32_t cell_count, enf_object *out, int32_t capacity) {
    int32_t count = 0, nowhere = -1;
    enf_query_begin(query);
    query->flooded_count = query->image_count = 0;
    for (int32_t k = 0; k < cell_count; k++) {
        if (cells[k] == ENF_LIST_NOWHERE && nowhere < 0) nowhere = k;
        if (cells[k] < 0 || cells[k] >= objects->cell_count || enf_query_has(query, cells[k])) continue;
        enf_query_mark(query, cells[k], k);
    }
    for (int32_t k = 0; k < cell_count; k++) {
        int32_t list = cells[k] == ENF_LIST_EVERYWHERE ? -1 : enf_objects_list(objects, cells[k]);
        if (list < 0 || (cells[k] == ENF_LIST_NOWHERE ? nowhere : query->first[cells[k]]) != k) continue;
        for (int32_t i = objects->lists[list].first; i >= 0; i = objects->links[i].behind) {
            int32_t object = objects->links[i].object;
            if (!is_first(objects, query, object, k)) continue;
            if (count < capacity) out[count] = handle_of(objects, object);
            count++;
        }
    }
    int32_t room = count < capacity ? capacity - count : 0;
    return count + enf_objects_of_cell(objects, ENF_LIST_EVERYWHERE, room > 0 ? out + count : NULL, room);
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
