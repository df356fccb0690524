// SPDX-License-Identifier: GPL-3.0-or-later
// The soup container: parallel growing arrays, and names looked up by open hashing.
#include "build/soup.h"

#include "base/array.h"
#include "base/hash.h"

#include <stdlib.h>
#include <string.h>

const char *enf_reject_name(enf_reject reason) {
    static const char *const names[ENF_REJECT_COUNT] = {
        [ENF_REJECT_NOT_FINITE] = "not-finite",   [ENF_REJECT_TOO_LARGE] = "too-large",
        [ENF_REJECT_INDEX_RANGE] = "index-range", [ENF_REJECT_TOO_FEW_CORNERS] = "too-few-corners",
        [ENF_REJECT_NO_AREA] = "no-area",         [ENF_REJECT_DUPLICATE] = "duplicate",
        [ENF_REJECT_EXCLUDED] = "excluded",       [ENF_REJECT_SYNTAX] = "syntax",
        [ENF_REJECT_TOO_COMPLEX] = "too-complex",
    };
    return (unsigned)reason < ENF_REJECT_COUNT ? names[reason] : "unknown";
}

static void free_names(char **names, size_t count) {
    for (size_t i = 0; i < count; i++) free(names[i]);
    free(names);
}

void enf_soup_free(enf_soup *soup) {
    if (!soup) return;
    void *const arrays[] = {soup->points,         soup->normals,          soup->texcoords,
                            soup->polygon_corner, soup->polygon_line,     soup->polygon_file,
                            soup->polygon_group,  soup->polygon_material, soup->corner_point,
                            soup->corner_normal,  soup->corner_texcoord,  soup->group_slots,
                            soup->material_slots, soup->spawns,           soup->rejected};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
    free_names(soup->groups, soup->group_count);
    free_names(soup->materials, soup->material_count);
    free_names(soup->files, soup->file_count);
    *soup = (enf_soup){0};
}

bool enf_soup_reject(enf_soup *soup, enf_reject reason, int32_t file, int64_t line, int32_t polygon) {
    if (!enf_array_reserve(soup->rejected, soup->rejected_capacity, soup->rejected_count + 1)) return false;
    soup->rejected[soup->rejected_count++] =
        (enf_rejected){.reason = reason, .file = file, .line = line, .polygon = polygon};
    return true;
}

/// Appends `width` doubles as element number *count.
static bool add_tuple(double **data, size_t *count, size_t *capacity, const double *values, size_t width) {
    if (*count >= INT32_MAX) return false;
    if (!enf_array_reserve(*data, *capacity, (*count + 1) * width)) return false;
    memcpy(*data + *count * width, values, width * sizeof *values);
    ++*count;
    return true;
}

bool enf_soup_add_point(enf_soup *soup, double x, double y, double z) {
    return add_tuple(&soup->points, &soup->point_count, &soup->point_capacity, (double[3]){x, y, z}, 3);
}

bool enf_soup_add_normal(enf_soup *soup, double x, double y, double z) {
    return add_tuple(&soup->normals, &soup->normal_count, &soup->normal_capacity, (double[3]){x, y, z}, 3);
}

bool enf_soup_add_texcoord(enf_soup *soup, double u, double v) {
    return add_tuple(&soup->texcoords, &soup->texcoord_count, &soup->texcoord_capacity, (double[2]){u, v}, 2);
}

bool enf_soup_add_spawn(enf_soup *soup, double x, double y, double z) {
    return add_tuple(&soup->spawns, &soup->spawn_count, &soup->spawn_capacity, (double[3]){x, y, z}, 3);
}

/// What the corners of a polygon have joins what those before have. Most worlds have none of it: the list
/// begins, with -1 for all before, when the first corner has it.
static bool add_attributes(int32_t **list, size_t *capacity, size_t before, const int32_t *added,
                           size_t count) {
    bool any = *list;
    for (size_t i = 0; added && i < count && !any; i++) any = added[i] != -1;
    if (!any) return true;
    const bool begins = !*list;
    if (!enf_array_reserve(*list, *capacity, before + count)) return false;
    if (begins) memset(*list, 0xff, before * sizeof **list);
    for (size_t i = 0; i < count; i++) (*list)[before + i] = added ? added[i] : -1;
    return true;
}

static bool reserve_polygon(enf_soup *soup, size_t corners) {
    size_t polygons = soup->polygon_count + 1;
    return enf_array_reserve(soup->polygon_corner, soup->polygon_offset_capacity, polygons + 1) &&
           enf_array_reserve(soup->polygon_line, soup->polygon_line_capacity, polygons) &&
           enf_array_reserve(soup->polygon_file, soup->polygon_file_capacity, polygons) &&
           enf_array_reserve(soup->polygon_group, soup->polygon_group_capacity, polygons) &&
           enf_array_reserve(soup->polygon_material, soup->polygon_material_capacity, polygons) &&
           enf_array_reserve(soup->corner_point, soup->corner_point_capacity, corners);
}

bool enf_soup_add_polygon(enf_soup *soup, size_t corner_count, const int32_t *points, const int32_t *normals,
                          const int32_t *texcoords, int32_t file, int64_t line, int32_t group,
                          int32_t material) {
    if (soup->polygon_count >= INT32_MAX) return false;
    const size_t first = soup->corner_count;
    if (!reserve_polygon(soup, first + corner_count) ||
        !add_attributes(&soup->corner_normal, &soup->corner_normal_capacity, first, normals, corner_count) ||
        !add_attributes(&soup->corner_texcoord, &soup->corner_texcoord_capacity, first, texcoords,
                        corner_count))
        return false;
    if (soup->polygon_count == 0) soup->polygon_corner[0] = 0;
    size_t polygon = soup->polygon_count++;
    for (size_t i = 0; i < corner_count; i++) soup->corner_point[first + i] = points[i];
    soup->corner_count += corner_count;
    soup->polygon_corner[polygon + 1] = (int64_t)soup->corner_count;
    soup->polygon_line[polygon] = line;
    soup->polygon_file[polygon] = file;
    soup->polygon_group[polygon] = group;
    soup->polygon_material[polygon] = material;
    return true;
}

/// A list of names with its hash table, as it lies in the soup.
typedef struct name_list {
    char ***names;
    size_t *count, *capacity;
    int32_t **slots;
    size_t *slot_count;
} name_list;

static size_t name_slot(const name_list *list, const char *name) {
    size_t mask = *list->slot_count - 1, slot = enf_hash64(name, strlen(name), 0) & mask;
    while ((*list->slots)[slot] >= 0 && strcmp((*list->names)[(*list->slots)[slot]], name) != 0)
        slot = (slot + 1) & mask;
    return slot;
}

static bool grow_slots(const name_list *list) {
    size_t wanted = *list->slot_count ? *list->slot_count * 2 : 16;
    int32_t *slots = enf_array_new(wanted, sizeof *slots);
    if (!slots) return false;
    memset(slots, -1, wanted * sizeof *slots);
    free(*list->slots);
    *list->slots = slots;
    *list->slot_count = wanted;
    for (size_t i = 0; i < *list->count; i++) slots[name_slot(list, (*list->names)[i])] = (int32_t)i;
    return true;
}

static int32_t find_or_add(const name_list *list, const char *name) {
    if ((*list->count + 1) * 2 > *list->slot_count && !grow_slots(list)) return -1;
    size_t slot = name_slot(list, name);
    if ((*list->slots)[slot] >= 0) return (*list->slots)[slot];
    if (*list->count >= INT32_MAX || !enf_array_reserve(*list->names, *list->capacity, *list->count + 1))
        return -1;
    char *copy = strdup(name);
    if (!copy) return -1;
    (*list->slots)[slot] = (int32_t)*list->count;
    (*list->names)[*list->count] = copy;
    return (int32_t)(*list->count)++;
}

int32_t enf_soup_group(enf_soup *soup, const char *name) {
    name_list list = {&soup->groups, &soup->group_count, &soup->group_capacity, &soup->group_slots,
                      &soup->group_slot_count};
    if (soup->group_count == 0 && *name && find_or_add(&list, "") < 0) return -1;
    return find_or_add(&list, name);
}

int32_t enf_soup_material(enf_soup *soup, const char *name) {
    name_list list = {&soup->materials, &soup->material_count, &soup->material_capacity,
                      &soup->material_slots, &soup->material_slot_count};
    return find_or_add(&list, name);
}
