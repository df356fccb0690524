// SPDX-License-Identifier: MIT
#include "base/array.h"

#include <stdint.h>
#include <stdlib.h>

bool enf_array_reserve_bytes(void **data, size_t *capacity, size_t wanted, size_t element) {
    if (wanted <= *capacity) return true;
    size_t grown = *capacity + *capacity / 2 + 16;
    if (grown < wanted) grown = wanted;
    if (grown > SIZE_MAX / element) return false;
    void *moved = realloc(*data, grown * element);
    if (!moved) return false;
    *data = moved;
    *capacity = grown;
    return true;
}

void *enf_array_new(size_t count, size_t size) {
    if (count == 0) count = 1;
    return count > SIZE_MAX / size ? NULL : malloc(count * size);
}

void *enf_array_zeroed(size_t count, size_t size) {
    return calloc(count ? count : 1, size);
}
