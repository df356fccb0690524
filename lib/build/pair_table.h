// SPDX-License-Identifier: GPL-3.0-or-later
// A hash table from an unordered pair of numbers to a number: open addressing, linear probing, deletion by
// shifting back (Knuth, The Art of Computer Programming 3, 6.4, algorithm R). It is looked up, never walked.
//
// It has pages: pairs whose larger numbers are close are close in memory. Numbers along a curve through space
// are looked up place by place, and a page of them stays near the processor.
#ifndef ENF_BUILD_PAIR_TABLE_H
#define ENF_BUILD_PAIR_TABLE_H

#include "enfilade/base.h"

typedef struct enf_pair_page {
    struct enf_pair_slot {
        uint32_t low, high; ///< the smaller number and the larger one
        int32_t value;      ///< -1: the slot is empty
    } * slots;              ///< null as long as the page is empty
    uint32_t slot_count;
    uint32_t count;    ///< slots that are not empty
    uint32_t expected; ///< the first slots are made for so many
} enf_pair_page;

typedef struct enf_pair_table {
    enf_pair_page *pages;
    int32_t page_count;
} enf_pair_table;

/// An empty table for numbers 0..numbers-1. Returns false when there is no memory.
bool enf_pair_table_create(enf_pair_table *table, int32_t numbers);
void enf_pair_table_free(enf_pair_table *table);

/// Tells that (a, b) = (b, a) will be put in. Nothing depends on it but that pages need not grow later.
void enf_pair_table_expect(enf_pair_table *table, int32_t a, int32_t b);

/// The value of (a, b), or -1.
int32_t enf_pair_table_find(const enf_pair_table *table, int32_t a, int32_t b);

/// Sets it, to 0 or more. False, with the table as it was, when there is no memory.
bool enf_pair_table_put(enf_pair_table *table, int32_t a, int32_t b, int32_t value);

/// Takes a pair out; nothing happens when it is not in.
void enf_pair_table_remove(enf_pair_table *table, int32_t a, int32_t b);

#endif
