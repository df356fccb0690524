// SPDX-License-Identifier: MIT
// Memory that will be read soon.
#ifndef ENF_BASE_FETCH_H
#define ENF_BASE_FETCH_H

/// Begins to bring what is there near the processor, where the compiler can say so. For places that follow no
/// order, some steps before they are read.
static inline void enf_fetch(const void *at) {
#ifdef __GNUC__
    __builtin_prefetch(at);
#else
    (void)at;
#endif
}

#endif
