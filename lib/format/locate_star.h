// SPDX-License-Identifier: MIT
// A few tetrahedra, each once.
#ifndef ENF_FORMAT_LOCATE_STAR_H
#define ENF_FORMAT_LOCATE_STAR_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { ENF_STAR_MAX = 256, ENF_STAR_PLACES = 512 };

/// In the order in which they were added, and in a table with open addresses.
typedef struct enf_star {
    int count;
    int32_t list[ENF_STAR_MAX];
    int32_t places[ENF_STAR_PLACES]; ///< -1: free
} enf_star;

static inline void enf_star_begin(enf_star *star) {
    star->count = 0;
    memset(star->places, -1, sizeof star->places);
}

/// False if there is no room.
static inline bool enf_star_add(enf_star *star, int32_t tetrahedron) {
    uint32_t place = (uint32_t)tetrahedron * UINT32_C(2654435761) >> 23; // Knuth, TAOCP 3, 6.4
    while (star->places[place] >= 0) {
        if (star->places[place] == tetrahedron) return true;
        place = (place + 1) % ENF_STAR_PLACES;
    }
    if (star->count == ENF_STAR_MAX) return false;
    star->places[place] = tetrahedron;
    star->list[star->count++] = tetrahedron;
    return true;
}

#endif
