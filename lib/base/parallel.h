// SPDX-License-Identifier: MIT
// Independent jobs on a few threads. Results must go to per-job places, so that their order does not depend
// on who ran what.
#ifndef ENF_BASE_PARALLEL_H
#define ENF_BASE_PARALLEL_H

#include <stdint.h>

/// Calls job(user, i, thread) once for each i in 0..count-1, on up to `threads` threads (thread numbers
/// 0..threads-1; the caller's own is 0). Falls back to fewer threads where the system refuses them. Returns
/// when all are done.
void enf_parallel_for(int threads, int32_t count, void (*job)(void *user, int32_t index, int thread),
                      void *user);

#endif
