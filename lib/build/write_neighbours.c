// SPDX-License-Identifier: GPL-3.0-or-later
// The neighbours of each tetrahedron, for walks. Faces are listed by their smallest corner; the two with the
// same three corners are in one short list, and find each other there in a hash table that stays in the
// cache.
#include "build/write_parts.h"

#include "base/array.h"
#include "base/hash.h"

#include <stdlib.h>

/// A face that waits for the one from the other side.
typedef struct waiting_face {
    uint64_t key; ///< its two larger corners
    int32_t face; ///< 4 * tetrahedron + the opposite corner; -1: the slot is free
} waiting_face;

/// The lists: faces[first[p]..first[p + 1] - 1] have p for their smallest corner.
typedef struct face_lists {
    int32_t *first, *faces;
} face_lists;

static void sort_two(int32_t *a, int32_t *b) {
    int32_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
    *a = low;
    *b = high;
}

/// The corners of a face, ascending.
static void take_face(const enf_file_view *view, int32_t face, int32_t corner[3]) {
    const int32_t *corners = view->tetrahedra[face / 4];
    for (int k = 0; k < 3; k++) corner[k] = corners[(face + 1 + k) % 4];
    sort_two(&corner[0], &corner[1]);
    sort_two(&corner[1], &corner[2]);
    sort_two(&corner[0], &corner[1]);
}

/// For each face of a tetrahedron its smallest corner.
static void find_smallest(const int32_t corners[4], int32_t smallest[4]) {
    int32_t left = corners[0] < corners[1] ? corners[0] : corners[1];
    int32_t right = corners[2] < corners[3] ? corners[2] : corners[3];
    for (int k = 0; k < 2; k++) {
        smallest[k] = corners[1 - k] < right ? corners[1 - k] : right;
        smallest[2 + k] = corners[3 - k] < left ? corners[3 - k] : left;
    }
}

/// All faces: count, prefix sum, fill. False without memory; the lists are to be freed in any case.
static bool list_faces(const enf_file_view *view, face_lists *lists) {
    int32_t smallest[4];
    lists->first = enf_array_zeroed((size_t)view->point_count + 2, sizeof *lists->first);
    lists->faces = enf_array_new(4 * (size_t)view->tetrahedron_count, sizeof *lists->faces);
    if (!lists->first || !lists->faces) return false;
    int32_t *place = lists->first + 1; // shifted by one while filling
    for (int32_t i = 0; i < view->tetrahedron_count; i++) {
        find_smallest(view->tetrahedra[i], smallest);
        for (int k = 0; k < 4; k++) place[smallest[k] + 1]++;
    }
    for (int32_t p = 0; p < view->point_count; p++) place[p + 1] += place[p];
    for (int32_t i = 0; i < view->tetrahedron_count; i++) {
        find_smallest(view->tetrahedra[i], smallest);
        for (int k = 0; k < 4; k++) lists->faces[place[smallest[k]]++] = 4 * i + k;
    }
    return true;
}

/// Pairs the faces of one list; `slots` has mask + 1 entries, more than the list.
static void pair_faces(const enf_file_view *view, const int32_t *faces, size_t count, waiting_face *slots,
                       size_t mask, int32_t (*next)[4]) {
    for (size_t i = 0; i <= mask; i++) slots[i].face = -1;
    for (size_t i = 0; i < count; i++) {
        int32_t corner[3], face = faces[i];
        take_face(view, face, corner);
        uint64_t key = (uint64_t)corner[2] << 32 | (uint32_t)corner[1];
        size_t at = (size_t)enf_hash_mix(key) & mask;
        while (slots[at].face >= 0 && slots[at].key != key) at = (at + 1) & mask;
        int32_t other = slots[at].face;
        if (other < 0) {
            slots[at] = (waiting_face){key, face};
        } else {
            next[face / 4][face % 4] = other / 4;
            next[other / 4][other % 4] = face / 4;
        }
    }
}

static bool pair_all(const enf_file_view *view, const face_lists *lists, int32_t (*next)[4]) {
    waiting_face *slots = NULL;
    size_t capacity = 0;
    bool good = true;
    for (int32_t p = 0; good && p < view->point_count; p++) {
        size_t count = (size_t)(lists->first[p + 1] - lists->first[p]), size = 1;
        if (count == 0) continue;
        while (size < 2 * count) size *= 2;
        good = enf_array_reserve(slots, capacity, size);
        if (good) pair_faces(view, lists->faces + lists->first[p], count, slots, size - 1, next);
    }
    free(slots);
    return good;
}

enf_status enf_build_image_neighbours(enf_build_image *image, enf_error *error) {
    enf_file_view *view = &image->view;
    size_t count = (size_t)view->tetrahedron_count;
    if (count > INT32_MAX / 4) return enf_fail(error, ENF_NO_RESOURCES, "too many tetrahedra for one file");
    int32_t(*next)[4] = enf_build_image_new(image, count, sizeof *next);
    face_lists lists = {0};
    bool good = next && list_faces(view, &lists);
    for (size_t i = 0; good && i < count; i++) next[i][0] = next[i][1] = next[i][2] = next[i][3] = -1;
    good = good && pair_all(view, &lists, next);
    free(lists.first);
    free(lists.faces);
    if (!good) return enf_fail_memory(error, "the neighbours of tetrahedra");
    view->tetrahedron_next = (void *)next;
    return ENF_OK;
}
