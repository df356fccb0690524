// SPDX-License-Identifier: MIT
// Adding, moving and removing objects. A move floods from the new cell of the centre and compares what it
// finds with the object's links: the cells that are in both keep theirs, so that nothing is done in the
// common case.
#include "run/objects.h"

#include "run/query.h"
#include "run/shape.h"

#include <string.h>

int32_t enf_objects_find(const enf_objects *objects, enf_object object) {
    if (object.slot == 0 || object.slot > (uint32_t)objects->objects_max) return -1;
    const enf_object_slot *slot = &objects->slots[object.slot - 1];
    return slot->used && slot->generation == object.generation ? (int32_t)(object.slot - 1) : -1;
}

static void count_outside(enf_objects *objects, int32_t list, int change) {
    if (list >= objects->cell_count) objects->outside_count[list - objects->cell_count] += change;
}

/// Puts a link at the end of a list.
static void enter_list(enf_objects *objects, int32_t number, int32_t list) {
    enf_link *link = &objects->links[number];
    enf_list *to = &objects->lists[list];
    link->list = list;
    link->before = to->last;
    link->behind = -1;
    *(to->last < 0 ? &to->first : &objects->links[to->last].behind) = number;
    to->last = number;
    count_outside(objects, list, 1);
}

static void leave_list(enf_objects *objects, int32_t number) {
    enf_link *link = &objects->links[number];
    enf_list *from = &objects->lists[link->list];
    *(link->before < 0 ? &from->first : &objects->links[link->before].behind) = link->behind;
    *(link->behind < 0 ? &from->last : &objects->links[link->behind].before) = link->before;
    count_outside(objects, link->list, -1);
    link->list = -1;
}

/// Puts the object into one more list. False if there is no link left.
static bool add_link(enf_objects *objects, int32_t object, int32_t list) {
    enf_object_slot *slot = &objects->slots[object];
    int32_t number = object;
    if (slot->link_count > 0) {
        number = objects->free_link;
        if (number < 0) return false;
        objects->free_link = objects->links[number].behind;
        objects->link_count++;
        objects->links[slot->last_link].next = number;
    }
    objects->links[number].object = object;
    objects->links[number].next = -1;
    enter_list(objects, number, list);
    slot->last_link = number;
    slot->link_count++;
    return true;
}

static void give_back(enf_objects *objects, int32_t number) {
    objects->links[number].object = -1;
    objects->links[number].behind = objects->free_link;
    objects->free_link = number;
    objects->link_count--;
}

/// Takes the list, and the place in it, of another link of the same object, which is not in use then.
static void take_over(enf_objects *objects, int32_t number, int32_t other) {
    enf_link *link = &objects->links[number], *from = &objects->links[other];
    enf_list *list = &objects->lists[from->list];
    link->list = from->list;
    link->before = from->before;
    link->behind = from->behind;
    *(link->before < 0 ? &list->first : &objects->links[link->before].behind) = number;
    *(link->behind < 0 ? &list->last : &objects->links[link->behind].before) = number;
    from->list = -1;
}

/// Leaves the lists for which `stays` is not true, and keeps the order of the others.
static void drop_links(enf_objects *objects, int32_t object,
                       bool (*stays)(const enf_objects *, int32_t list)) {
    enf_object_slot *slot = &objects->slots[object];
    int32_t kept = -1, next;
    slot->link_count = 0;
    for (int32_t i = object; i >= 0; i = next) {
        next = objects->links[i].next;
        if (!stays(objects, objects->links[i].list)) {
            leave_list(objects, i);
            if (i != object) give_back(objects, i);
            continue;
        }
        if (kept < 0 && i != object) {
            take_over(objects, object, i);
            give_back(objects, i);
            kept = object;
        } else {
            if (kept >= 0) objects->links[kept].next = i;
            kept = i;
        }
        slot->link_count++;
    }
    slot->last_link = kept < 0 ? object : kept;
    objects->links[slot->last_link].next = -1;
}

static bool stays_nowhere(const enf_objects *objects, int32_t list) {
    (void)objects;
    (void)list;
    return false;
}

/// The flood has reached the list's cell.
static bool stays_where_reached(const enf_objects *objects, int32_t list) {
    return list < objects->cell_count && enf_query_has(objects->query, list);
}

/// True if the object is in the cells that the flood has reached and in no others.
static bool is_linked_alike(const enf_objects *objects, int32_t object) {
    const enf_object_slot *slot = &objects->slots[object];
    if (slot->link_count != objects->query->flooded_count) return false;
    for (int32_t i = object; i >= 0; i = objects->links[i].next)
        if (!stays_where_reached(objects, objects->links[i].list)) return false;
    return true;
}

/// Puts the object into one list behind the cells alone.
static void put_outside(enf_objects *objects, int32_t object, int32_t cell) {
    int32_t list = enf_objects_list(objects, cell);
    if (objects->slots[object].link_count == 1 && objects->links[object].list == list) return;
    if (objects->slots[object].link_count > 0) drop_links(objects, object, stays_nowhere);
    add_link(objects, object, list);
}

/// Makes the links of an object what the flood says.
static void relink(enf_objects *objects, int32_t object) {
    enf_query *query = objects->query;
    bool linked = objects->slots[object].link_count > 0;
    if (linked && is_linked_alike(objects, object)) return;
    if (query->flooded_count - 1 > objects->links_max) {
        put_outside(objects, object, ENF_LIST_EVERYWHERE);
        return;
    }
    if (linked) drop_links(objects, object, stays_where_reached);
    for (int32_t i = object; objects->slots[object].link_count > 0 && i >= 0; i = objects->links[i].next)
        query->first[objects->links[i].list] = -1; // has its link
    for (int32_t i = 0; i < query->flooded_count; i++) {
        int32_t cell = query->flooded[i].cell;
        if (query->first[cell] < 0 || add_link(objects, object, cell)) continue;
        put_outside(objects, object, ENF_LIST_EVERYWHERE);
        return;
    }
}

static void place(enf_objects *objects, int32_t object, const enf_shape *shape, int32_t hint) {
    enf_object_slot *slot = &objects->slots[object];
    enf_place place = enf_world_locate(objects->world, shape->centre, hint);
    slot->shape = *shape;
    slot->cell = place.cell;
    if (place.tetrahedron >= 0) slot->tetrahedron = place.tetrahedron;
    enf_query_flood(objects->query, NULL, place.cell, &slot->shape);
    if (place.cell < 0)
        put_outside(objects, object, ENF_LIST_NOWHERE);
    else
        relink(objects, object);
}

static enf_status find(const enf_objects *objects, enf_object object, int32_t *number, enf_error *error) {
    *number = enf_objects_find(objects, object);
    if (*number >= 0) return ENF_OK;
    return enf_fail(error, ENF_BAD_USAGE, "object %lu, generation %lu: there is none, or it was removed",
                    (unsigned long)object.slot, (unsigned long)object.generation);
}

enf_status enf_objects_add(enf_objects *objects, const enf_shape *given, uint64_t user,
                           const enf_object *near, enf_object *object, enf_error *error) {
    *object = (enf_object){0, 0};
    enf_shape shape;
    enf_status status = enf_shape_take(&shape, given, error);
    if (status) return status;
    int32_t number = objects->free_slot, close_by = near ? enf_objects_find(objects, *near) : -1;
    if (number < 0)
        return enf_fail(error, ENF_NO_RESOURCES, "there are %ld objects already; create room for more",
                        (long)objects->objects_max);
    enf_object_slot *slot = &objects->slots[number];
    objects->free_slot = slot->next_free;
    objects->object_count++;
    slot->used = true;
    slot->user = user;
    slot->tetrahedron = -1;
    slot->link_count = 0;
    place(objects, number, &shape, close_by >= 0 ? objects->slots[close_by].tetrahedron : -1);
    *object = (enf_object){(uint32_t)number + 1, slot->generation};
    return ENF_OK;
}

enf_status enf_objects_move(enf_objects *objects, enf_object object, const enf_shape *given,
                            enf_error *error) {
    int32_t number;
    enf_shape shape;
    enf_status status = find(objects, object, &number, error);
    if (!status) status = enf_shape_take(&shape, given, error);
    if (!status) place(objects, number, &shape, objects->slots[number].tetrahedron);
    return status;
}

enf_status enf_objects_remove(enf_objects *objects, enf_object object, enf_error *error) {
    int32_t number;
    enf_status status = find(objects, object, &number, error);
    if (status) return status;
    enf_object_slot *slot = &objects->slots[number];
    drop_links(objects, number, stays_nowhere);
    slot->used = false;
    slot->generation++;
    slot->next_free = objects->free_slot;
    objects->free_slot = number;
    objects->object_count--;
    return ENF_OK;
}
