// SPDX-License-Identifier: GPL-3.0-or-later
// A hash table from an unordered pair of numbers to a number: open addressing, linear probing, deletion by
// shifting back (Knuth, The Art of Computer Programming 3, 6.4, algorithm R). It is looked up, never walked.
#ifndef ENF_BUILD_PAIR_TABLE_H
#define ENF_BUILD_PAIR_TABLE_H

#include "enfilade/base.h"

typedef struct enf_pair_table {
    size_t mask; ///< slots - 1; the number of slots is a power of two
    struct enf_pair_slot {
        uint32_t low, high; ///< the smaller number and the larger one
        int32_t value;      ///< -1: the slot is empty
    } * slots;
} enf_pair_table;

/// Room for `capacity` entries at any one time. Returns false when there is no memory.
bool enf_pair_table_create(enf_pair_table *table, size_t capacity);

/// Makes room for so many entries. False, with the table as it was, when there is no memory.
bool enf_pair_table_reserve(enf_pair_table *table, size_t capacity);
void enf_pair_table_free(enf_pair_table *table);

/// Where the value of (a, b) = (b, a) is kept; it reads -1 when the pair is new. The caller stores a value >=
/// 0 there before the next call, except that a -1 may be left at -1.
int32_t *enf_pair_table_at(enf_pair_table *table, int32_t a, int32_t b);

/// Takes a pair out; nothing happens when it is not in.
void enf_pair_table_remove(enf_pair_table *table, int32_t a, int32_t b);

#endif
