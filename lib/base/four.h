// SPDX-License-Identifier: MIT
// Four doubles at a time, as GNU vectors: the compiler makes of them what the machine has. Sums and products
// are rounded as those of single doubles are, so results do not depend on it.
#ifndef ENF_BASE_FOUR_H
#define ENF_BASE_FOUR_H

#include <stdint.h>

/// Functions marked so are compiled for wider registers, too; which one runs is found out at the start. (The
/// thread sanitizer is not ready by then.)
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GLIBC__) && defined(__GNUC__) && \
    !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define ENF_WIDE_TOO __attribute__((target_clones("avx2", "default")))
#else
#define ENF_WIDE_TOO
#endif

/// For what such functions call, as clones are made of them alone.
#define ENF_PART_OF_WIDE static inline __attribute__((always_inline))

// How vectors are passed does not matter: all that takes them is inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

typedef double enf_four __attribute__((vector_size(32)));
typedef int64_t enf_four_mask __attribute__((vector_size(32))); ///< -1: yes, 0: no, as comparisons make them
typedef double enf_four_anywhere __attribute__((vector_size(32), aligned(8), may_alias));

enum { ENF_FOUR = 4 };

ENF_PART_OF_WIDE enf_four enf_four_load(const double *from) {
    return *(const enf_four_anywhere *)from;
}

ENF_PART_OF_WIDE void enf_four_store(double *to, enf_four four) {
    *(enf_four_anywhere *)to = four;
}

ENF_PART_OF_WIDE enf_four enf_four_all(double value) {
    return (enf_four){value, value, value, value};
}

ENF_PART_OF_WIDE enf_four enf_four_choose(enf_four_mask which, enf_four yes, enf_four no) {
    return (enf_four)((which & (enf_four_mask)yes) | (~which & (enf_four_mask)no));
}

ENF_PART_OF_WIDE enf_four enf_four_abs(enf_four four) {
    return (enf_four)((enf_four_mask)four & INT64_MAX);
}

/// Of numbers that are no NaN.
ENF_PART_OF_WIDE enf_four enf_four_max(enf_four a, enf_four b) {
    enf_four max;
    for (int lane = 0; lane < ENF_FOUR; lane++) max[lane] = a[lane] > b[lane] ? a[lane] : b[lane];
    return max;
}

ENF_PART_OF_WIDE enf_four enf_four_min(enf_four a, enf_four b) {
    enf_four min;
    for (int lane = 0; lane < ENF_FOUR; lane++) min[lane] = a[lane] < b[lane] ? a[lane] : b[lane];
    return min;
}

/// The first three columns of four rows.
ENF_PART_OF_WIDE void enf_four_turn(const enf_four rows[4], enf_four columns[3]) {
#if defined(__clang__)
    const enf_four low = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6),
                   high = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7),
                   next_low = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6),
                   next_high = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
    columns[0] = __builtin_shufflevector(low, next_low, 0, 1, 4, 5);
    columns[1] = __builtin_shufflevector(high, next_high, 0, 1, 4, 5);
    columns[2] = __builtin_shufflevector(low, next_low, 2, 3, 6, 7);
#else
    const enf_four low = __builtin_shuffle(rows[0], rows[1], (enf_four_mask){0, 4, 2, 6}),
                   high = __builtin_shuffle(rows[0], rows[1], (enf_four_mask){1, 5, 3, 7}),
                   next_low = __builtin_shuffle(rows[2], rows[3], (enf_four_mask){0, 4, 2, 6}),
                   next_high = __builtin_shuffle(rows[2], rows[3], (enf_four_mask){1, 5, 3, 7});
    columns[0] = __builtin_shuffle(low, next_low, (enf_four_mask){0, 1, 4, 5});
    columns[1] = __builtin_shuffle(high, next_high, (enf_four_mask){0, 1, 4, 5});
    columns[2] = __builtin_shuffle(low, next_low, (enf_four_mask){2, 3, 6, 7});
#endif
}

/// Bits 0 to 3.
ENF_PART_OF_WIDE unsigned enf_four_bits(enf_four_mask mask) {
    const enf_four_mask bits = mask & (enf_four_mask){1, 2, 4, 8};
#if defined(__clang__)
    const enf_four_mask pairs = bits | __builtin_shufflevector(bits, bits, 2, 3, 0, 1);
#else
    const enf_four_mask pairs = bits | __builtin_shuffle(bits, (enf_four_mask){2, 3, 0, 1});
#endif
    return (unsigned)(pairs[0] | pairs[1]);
}

#endif
