// SPDX-License-Identifier: MIT
#ifndef ENF_RUN_TAKE_H
#define ENF_RUN_TAKE_H

#include <stdint.h>
#include <stdlib.h>

/// Zeroed memory for at least one element more than `count`, so that none at all is no special case. Null
/// without memory.
static inline void *enf_take(size_t count, size_t size) {
    return count >= PTRDIFF_MAX / size ? NULL : calloc(count + 1, size);
}

#endif
