// SPDX-License-Identifier: MIT
// Independent jobs on a few threads. Results must go to per-job places, so that their order does not depend
// on who ran what.
#ifndef ENF_BASE_PARALLEL_H
#define ENF_BASE_PARALLEL_H

#include <stdbool.h>
#include <stdint.h>

/// Who works, and who watches: `watch` (may be null) is called now and then, on the caller's own thread, with
/// the share of the jobs that are dealt out; when it returns false the jobs not yet begun are dropped.
typedef struct enf_crew {
    int threads; ///< 1 or more
    bool (*watch)(void *user, double fraction);
    void *user;
} enf_crew;

/// Calls job(user, i, thread) once for each i in 0..count-1, on up to crew->threads threads (thread numbers
/// from 0; the caller's own is 0, and takes job 0). Falls back to fewer threads where the system refuses
/// them. Returns when all are done; false if the watch stopped them.
bool enf_parallel_for(const enf_crew *crew, int32_t count, void (*job)(void *user, int32_t index, int thread),
                      void *user);

#endif
