// SPDX-License-Identifier: GPL-3.0-or-later
// Points, each once.
#ifndef ENF_VISIBILITY_DISTINCT_H
#define ENF_VISIBILITY_DISTINCT_H

#include <stdint.h>

/// Scratch memory, for any number of calls. All zero at first; free `slots`.
typedef struct enf_distinct {
    int32_t *slots;
    uint32_t slot_count; ///< a power of two, or 0
} enf_distinct;

/// Drops the points that have the same bits as one before them; the others stay in their order. Returns how
/// many are left, or -1 without memory.
int32_t enf_distinct_keep(enf_distinct *distinct, double (*points)[3], int32_t count);

#endif
