// SPDX-License-Identifier: MIT
// Growing arrays: a pointer, a count and a capacity that the owner keeps as three plain fields.
#ifndef ENF_BASE_ARRAY_H
#define ENF_BASE_ARRAY_H

#include <stdbool.h>
#include <stddef.h>

/// Makes room for at least `wanted` elements of `element` bytes at *data. Returns false, with the array as it
/// was, when there is no memory. Growth is by half, so n appends cost O(n).
bool enf_array_reserve_bytes(void **data, size_t *capacity, size_t wanted, size_t element);

/// enf_array_reserve(data, capacity, wanted): `data` is a typed pointer lvalue, `capacity` a size_t lvalue.
#define enf_array_reserve(data, capacity, wanted) \
    ((size_t)(wanted) <= (capacity) ||            \
     enf_array_reserve_bytes((void **)&(data), &(capacity), (size_t)(wanted), sizeof *(data)))

/// Gives back the memory behind the first `count` elements of `data`, a typed pointer lvalue that is not
/// null.
#define enf_array_trim(data, count) enf_array_trim_bytes((void **)&(data), (size_t)(count) * sizeof *(data))
void enf_array_trim_bytes(void **data, size_t bytes);

/// malloc for `count` elements of `size` bytes that fails instead of overflowing; never returns null for 0.
void *enf_array_new(size_t count, size_t size);

/// The same, zeroed.
void *enf_array_zeroed(size_t count, size_t size);

#endif
