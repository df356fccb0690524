// SPDX-License-Identifier: GPL-3.0-or-later
// A stage under way in this process: the cells that wait for a thread, the threads, and where results go.
#ifndef ENF_VISIBILITY_SHOP_H
#define ENF_VISIBILITY_SHOP_H

#include "visibility/work.h"

#include <pthread.h>

enum { ENF_SHOP_THREADS_MAX = 64 };

/// What became of a cell that a thread took.
typedef enum enf_outcome {
    ENF_OUTCOME_NONE, ///< it was too late to begin
    ENF_OUTCOME_LATE, ///< a result, but not all of it
    ENF_OUTCOME_DONE,
    ENF_OUTCOME_COUNT
} enf_outcome;

typedef struct enf_shop {
    const enf_work *work;
    enf_workplace *place;
    bool leads; ///< alone, or rank 0
    pthread_t threads[ENF_SHOP_THREADS_MAX];
    int thread_count;
    int numbered; ///< threads that have a number

    pthread_mutex_t lock; ///< for all that follows
    pthread_cond_t more;  ///< cells came, or none will
    pthread_cond_t idle;  ///< no cells wait and no thread is busy, or something failed
    int32_t *queue;       ///< cells; nobody has taken those from next on
    int32_t next, count;
    int32_t busy; ///< cells that threads are at
    bool closed;  ///< no more cells will come
    bool stopped; ///< cells are taken, but not begun
    bool *begun;  ///< per cell: there is a result
    int64_t cost_done, cost_all;
    enf_bytes outbox; ///< of who does not lead: results to be sent
    enf_status status;
    enf_error error;
} enf_shop;

/// No cells yet. False without memory. Free it in any case, after its threads have ended.
bool enf_shop_make(enf_shop *shop, const enf_work *work, enf_workplace *place, bool *begun);
void enf_shop_free(enf_shop *shop);

/// Starts the threads. Where the system refuses all of them and no more cells will come, the caller's does
/// it.
void enf_shop_start(enf_shop *shop);

/// Lets threads end once there are no cells left, and waits for them.
void enf_shop_end(enf_shop *shop);

/// Waits until it is idle, at most so long; true if it is. The lock is held.
bool enf_shop_wait(enf_shop *shop, double seconds);

/// Notes an outcome; `result` is the encoded one, if it is wanted. The lock is held.
void enf_shop_note(enf_shop *shop, int32_t cell, enf_outcome outcome, const enf_bytes *result);

/// Notes a failure, and stops. The lock is held. The first failure counts.
void enf_shop_fail(enf_shop *shop, const enf_error *error);

/// Tells the crew's watch how far things are; stops when it says so. The lock is held, but not meanwhile.
void enf_shop_watch(enf_shop *shop);

#endif
