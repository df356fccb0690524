// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers that are the same everywhere: splitmix64, of which any 64 bits are a state.
#ifndef ENF_CLI_RANDOM_H
#define ENF_CLI_RANDOM_H

#include <stdint.h>

static inline uint64_t cli_random(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/// From 0 on, less than 1.
static inline double cli_random_share(uint64_t *state) {
    return (double)(cli_random(state) >> 11) * 0x1p-53;
}

#endif
