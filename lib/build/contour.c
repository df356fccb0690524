// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/contour.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

void enf_contour_free(enf_contour *contour) {
    free(contour->slots);
    free(contour->filled);
    *contour = (enf_contour){0};
}

bool enf_contour_start(enf_contour *contour, size_t edges) {
    size_t slots = 16;
    while (slots < 2 * edges) slots *= 2;
    if (slots > contour->slot_capacity) {
        free(contour->slots);
        contour->slots = enf_array_zeroed(slots, sizeof *contour->slots);
        contour->slot_capacity = contour->slots ? slots : 0;
        contour->stamp = 0;
    }
    if (!contour->slots || !enf_array_reserve(contour->filled, contour->filled_capacity, edges)) return false;
    contour->mask = slots - 1;
    contour->filled_count = 0;
    if (++contour->stamp == 0) { // after 2^32 contours
        memset(contour->slots, 0, contour->slot_capacity * sizeof *contour->slots);
        contour->stamp = 1;
    }
    return true;
}

static size_t home_of(const enf_contour *contour, int32_t from, int32_t to) {
    uint64_t key = (uint64_t)(uint32_t)from << 32 | (uint32_t)to;
    return (size_t)(key * 0x9e3779b97f4a7c15u >> 32) & contour->mask;
}

void enf_contour_run(enf_contour *contour, int32_t a, int32_t b, int32_t times) {
    int32_t from = a < b ? a : b, to = a < b ? b : a;
    size_t at = home_of(contour, from, to);
    enf_contour_slot *slot = &contour->slots[at];
    while (slot->stamp == contour->stamp && (slot->from != from || slot->to != to)) {
        at = (at + 1) & contour->mask;
        slot = &contour->slots[at];
    }
    if (slot->stamp != contour->stamp) {
        *slot = (enf_contour_slot){from, to, 0, contour->stamp};
        contour->filled[contour->filled_count++] = (uint32_t)at;
    }
    slot->times += a < b ? times : -times;
}
