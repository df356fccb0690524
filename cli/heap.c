// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/heap.h"

#include "base/array.h"
#include "base/memory.h"

#include <stdlib.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define OTHER_HEAP // these bring their own
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define OTHER_HEAP
#endif
#endif

#if defined(__GLIBC__) && !defined(OTHER_HEAP)
#include <malloc.h>

#define SPACE ((uint64_t)2 << 30) ///< bytes set apart

/// Larger arrays, bytes, are maps of their own where the heap would have to grow for them; so many at most.
enum { MAPPED = 2 << 20, MOST_MAPS = 1 << 16 };

enum { THREADS = 64 }; ///< with a heap of their own, at most

enum { NEVER = -1 }; ///< as a size: the largest

enum { SMALLEST_PAGE = 4096, LEFT = 1 << 20 }; ///< bytes; of the space, for what is there already

/// How much space is set apart.
static size_t count_space(void) {
    const char *limiter;
    uint64_t part = enf_memory_limit(&limiter) / 4;
    return (size_t)(part < SPACE ? part : SPACE);
}

void cli_heap_prepare(void) {
    size_t bytes = count_space();
    mallopt(M_ARENA_MAX, 1);          // for all threads
    mallopt(M_TRIM_THRESHOLD, NEVER); // that would give the space back
    mallopt(M_MMAP_MAX, 0);           // from the heap, whatever its size
    free(enf_array_new(bytes, 1));    // which asks for large pages
    mallopt(M_MMAP_MAX, MOST_MAPS);
    mallopt(M_MMAP_THRESHOLD, MAPPED);
}

void cli_heap_divide(void) {
    mallopt(M_ARENA_MAX, THREADS);
}

void cli_heap_touch(uint64_t bytes) {
    size_t space = count_space() - LEFT, touched = bytes < space ? (size_t)bytes : space;
    volatile char *data = enf_array_new(touched, 1);
    for (size_t i = 0; data && i < touched; i += SMALLEST_PAGE) data[i] = 1;
    free((void *)data);
}

void cli_heap_trim(void) {
    malloc_trim(0);
}
#else
void cli_heap_prepare(void) {}
void cli_heap_divide(void) {}
void cli_heap_touch(uint64_t bytes) {
    (void)bytes;
}
void cli_heap_trim(void) {}
#endif
