// SPDX-License-Identifier: MIT
#include "base/array.h"

#include <stdint.h>
#include <stdlib.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

enum { HUGE_PAGE = 2 << 20, LARGE = 16 << 20 }; ///< bytes

/// Asks for large pages where an array is so large that looking up small ones takes time. Where the system
/// has none, nothing happens.
static void *prefer_huge_pages(void *data, size_t bytes) {
#ifdef MADV_HUGEPAGE
    if (!data || bytes < LARGE) return data;
    size_t before = (HUGE_PAGE - (uintptr_t)data % HUGE_PAGE) % HUGE_PAGE; // of the first whole page
    madvise((char *)data + before, (bytes - before) / HUGE_PAGE * HUGE_PAGE, MADV_HUGEPAGE);
#else
    (void)bytes;
#endif
    return data;
}

bool enf_array_reserve_bytes(void **data, size_t *capacity, size_t wanted, size_t element) {
    if (wanted <= *capacity) return true;
    size_t grown = *capacity + *capacity / 2 + 16;
    if (grown < wanted) grown = wanted;
    if (grown > SIZE_MAX / element) return false;
    void *moved = prefer_huge_pages(realloc(*data, grown * element), grown * element);
    if (!moved) return false;
    *data = moved;
    *capacity = grown;
    return true;
}

void enf_array_trim_bytes(void **data, size_t bytes) {
    void *trimmed = realloc(*data, bytes > 0 ? bytes : 1);
    if (trimmed) *data = trimmed;
}

void *enf_array_new(size_t count, size_t size) {
    if (count == 0) count = 1;
    return count > SIZE_MAX / size ? NULL : prefer_huge_pages(malloc(count * size), count * size);
}

void *enf_array_zeroed(size_t count, size_t size) {
    return prefer_huge_pages(calloc(count ? count : 1, size), count * size);
}
